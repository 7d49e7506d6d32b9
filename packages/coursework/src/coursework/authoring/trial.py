"""The author's preview of a question: its text, and everything that a student may be told."""

import html
import re
from pathlib import Path

from ..checking.reply import mathml, to_html
from ..checking.variants import text_of
from .author import AuthoredQuestion, AuthorError, to_page
from .course import Course
from .selftest import try_question, write_page
from .source import notebooks_in, read_source, texts_of_questions

#: All variants of a question side by side, for comparison.
SIDE_BY_SIDE = (
    "<style>.variants{display:grid;gap:1rem;"
    "grid-template-columns:repeat(auto-fill,minmax(min(22rem,100%),1fr))}</style>"
)


def trial(course: Course, name: str, page: str | Path) -> str | Path:
    """Write a page on one question with all of its variants, or on all questions of a notebook.

    Parameters
    ----------
    course : Course
    name : str
        ``'notebook/question'``, or ``'notebook'``.
    page : path

    Raises
    ------
    AuthorError
        There is no such question, or it is not well posed.
    """
    notebook = name.partition("/")[0]
    (path,) = notebooks_in(course.sources, [notebook])
    source = read_source(path)
    chosen = [question for key, question in source.questions.items() if name in (notebook, key)]
    if not chosen:
        raise AuthorError(
            f"There is no question {name!r}; {path.name} has {', '.join(source.questions)}."
        )
    heads = texts_of_questions(source.notebook, source.figures)
    texts = "".join(
        f"<section><h2>{html.escape(question.name)}</h2>{_shown(heads[question.name], question)}"
        f"{_hints(question)}{_rubric(question)}</section>"
        for question in chosen
    )
    findings = [try_question(question) for question in chosen]
    if name != notebook:
        texts += _variants(path, chosen[0])
    Path(page).parent.mkdir(parents=True, exist_ok=True)
    Path(page).write_text(_with_mathematics(write_page(findings, None, texts)), "utf8")
    return page


def _variants(path: Path, question: AuthoredQuestion) -> str:
    """Return all variants, each with its text, answer, mistakes and worked solution."""
    own = (
        read_source(path, number, only=[question.name], pictures=True).questions[question.name]
        for number in range(question.public.variants)
    )
    each = "".join(
        f"<section><h3>Variant {variant.number}</h3>{_shown('', variant)}"
        f"<p>Answer: <code>{html.escape(str(variant.answer))}</code></p><ul>"
        + "".join(
            f"<li>{to_html(str(mistake.details['text']))} "
            f"<code>{html.escape(str(mistake.answer))}</code></li>"
            for mistake in variant.mistakes
            if mistake.note == "authored"
        )
        + "</ul></section>"
        for variant in own
    )
    return f'{SIDE_BY_SIDE}<div class="variants">{each}</div>' if question.public.variant else ""


def _shown(above: str, question: AuthoredQuestion) -> str:
    """Return the text of a question as students see it, with its worked solution folded below."""
    variant = question.public.variant
    text = above.replace(variant.text, "") + "\n\n" + text_of(variant) if variant else above
    return (
        f"{_under(to_page(text))}<details><summary>The worked solution</summary>"
        f"{to_page(question.solution) or '<p>None.</p>'}</details>"
    )


def _under(text: str) -> str:
    """Return a text with its headings below that of its section."""
    return re.sub(r"(</?)h[12]>", r"\1h3>", text)


def _with_mathematics(page: str) -> str:
    """Return the page with its formulas as MathML."""
    return re.sub(r"(\${1,2})([^$<]+)\1", lambda match: mathml(html.unescape(match[2])), page)


def _rubric(question: AuthoredQuestion) -> str:
    worths = question.rubric if isinstance(question.rubric, dict) else {}
    shares = {line: f" ({worth:g} of {question.worth})" for line, worth in worths.items()}
    lines = "".join(f"<li>{to_html(line)}{shares.get(line, '')}</li>" for line in question.rubric)
    return f"<h3>What a grader looks for</h3><ul>{lines}</ul>" if lines else ""


def _hints(question: AuthoredQuestion) -> str:
    lines = [
        f"<li><b>{html.escape(note)}</b>: {to_html(step)}</li>"
        for note, steps in question.hints.items()
        for step in steps
    ]
    return f"<h3>Hints</h3><ul>{''.join(lines)}</ul>" if lines else ""
