"""The author's preview of a question: its text, and everything that a student may be told."""

import html
import re
from pathlib import Path

from markupsafe import Markup

from ..checking.reply import mathml
from ..checking.variants import text_of
from .author import AuthoredQuestion, AuthorError, to_page
from .course import Course
from .selftest import try_question, write_page
from .source import notebooks_in, read_source, texts_of_questions


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
    questions = [(question, _shown(heads[question.name], question)) for question in chosen]
    variants = [] if name == notebook else _variants(path, chosen[0])
    content = write_page(
        [try_question(question) for question in chosen],
        questions=questions,
        variants=[(variant, _shown("", variant)) for variant in variants],
    )
    Path(page).parent.mkdir(parents=True, exist_ok=True)
    Path(page).write_text(_with_mathematics(content), "utf8")
    return page


def _variants(path: Path, question: AuthoredQuestion) -> list[AuthoredQuestion]:
    """Return all variants of a question; none if everybody has the same."""
    if not question.public.variant:
        return []
    return [
        read_source(path, number, only=[question.name], pictures=True).questions[question.name]
        for number in range(question.public.variants)
    ]


def _shown(above: str, question: AuthoredQuestion) -> Markup:
    """Return the text of a question as students see it, its headings below that of its section."""
    variant = question.public.variant
    text = above.replace(variant.text, "") + "\n\n" + text_of(variant) if variant else above
    return Markup(re.sub(r"(</?)h[12]>", r"\1h3>", to_page(text)))


def _with_mathematics(page: str) -> str:
    """Return the page with its formulas as MathML."""
    return re.sub(r"(\${1,2})([^$<]+)\1", lambda match: mathml(html.unescape(match[2])), page)
