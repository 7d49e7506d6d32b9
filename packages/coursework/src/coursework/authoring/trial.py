"""The author's preview of a question: its text, and everything that
a student may hear about an answer.
"""

import html
import re
from pathlib import Path

from ..checking.reply import mathml, to_html
from ..checking.variants import image
from ..checking.variants import text_of as whole_text
from .author import AuthoredQuestion, AuthorError, to_page
from .course import Course
from .release import shows_variants
from .selftest import try_question, write_page
from .source import Source, answered_in, read_source


def trial(course: Course, name: str, page: str | Path) -> str | Path:
    """Write a page on one question, or on all questions of a notebook.

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
    path = course.sources / f"{notebook}.ipynb"
    if not path.is_file():
        raise AuthorError(f"There is no {path.name} in {course.sources}.")
    source = read_source(path)
    chosen = [question for key, question in source.questions.items() if name in (notebook, key)]
    if not chosen:
        raise AuthorError(
            f"There is no question {name!r}; {path.name} has {', '.join(source.questions)}."
        )
    texts = "".join(
        f"<section><h2>{html.escape(question.name)}</h2>{_under(to_page(_text(source, question)))}"
        "<details><summary>The worked "
        f"solution</summary>{to_page(question.solution) or '<p>None.</p>'}</details>"
        f"{_hints(question)}{_rubric(question)}</section>"
        for question in chosen
    )
    findings = [try_question(question) for question in chosen]
    Path(page).parent.mkdir(parents=True, exist_ok=True)
    Path(page).write_text(_with_mathematics(write_page(findings, None, texts)), "utf8")
    return page


def _under(text: str) -> str:
    """A text whose headings stand below that of its section."""
    return re.sub(r"(</?)h[12]>", r"\1h3>", text)


def _with_mathematics(page: str) -> str:
    """The page with its formulas as browsers show them."""
    return re.sub(r"(\${1,2})([^$<]+)\1", lambda found: mathml(html.unescape(found[2])), page)


def _text(source: Source, question: AuthoredQuestion) -> str:
    """All that stands above a question as students meet it: the
    heading, the text and the pictures.
    """
    return "\n\n".join(
        [
            *_above(source, question),
            *([whole_text(question.public.variant)] if question.public.variant else []),
        ]
    )


def _above(source: Source, question: AuthoredQuestion) -> list[str]:
    """The Markdown and the figures between the question before and
    the cell that its answer stands in.
    """
    cells = source.notebook.cells
    above: list[str] = []
    owners = {known.variable or "": name for name, known in source.questions.items()}
    for number, cell in enumerate(cells):
        if cell.cell_type == "markdown":
            if not shows_variants(cells, number):
                heading = cell.source.lstrip().startswith("#")
                above = [cell.source] if heading else [*above, cell.source]
        elif number in source.figures:
            above.append(image(source.figures[number].picture(), source.figures[number].alt))
        elif question.variable in answered_in(cell.source, owners):
            return above
        elif answered_in(cell.source, owners):
            above = []
    return above


def _rubric(question: AuthoredQuestion) -> str:
    worths = question.rubric if isinstance(question.rubric, dict) else {}
    shares = {line: f" ({worth:g} of {question.worth})" for line, worth in worths.items()}
    lines = "".join(f"<li>{to_html(line)}{shares.get(line, '')}</li>" for line in question.rubric)
    return f"<h3>What a person looks for</h3><ul>{lines}</ul>" if lines else ""


def _hints(question: AuthoredQuestion) -> str:
    lines = [
        f"<li><b>{html.escape(note)}</b>: {to_html(step)}</li>"
        for note, steps in question.hints.items()
        for step in steps
    ]
    return f"<h3>Hints</h3><ul>{''.join(lines)}</ul>" if lines else ""
