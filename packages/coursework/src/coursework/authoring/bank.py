"""The questions of a course for another system, each variant with its answers and solution.

`coursework.authoring.exporting` writes them.
"""

from __future__ import annotations

import contextlib
import io
import re
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from ..checking.catalogue import message_of_all
from ..checking.evaluate import MP
from ..checking.kinds import Number, one_sign
from ..checking.plain import Plain, Value, parts_of, size_of
from ..checking.plugins import kinds
from ..checking.reading import read, tolerances
from ..checking.variants import text_of
from . import exporting
from .author import AuthoredQuestion, AuthorError
from .course import Course
from .exporting import Item, Wrong
from .source import (
    CHAPTERS,
    answered_in,
    checked_names,
    names_asked,
    notebooks_in,
    posed,
    processes_for,
    read_source,
    texts_of_questions,
)
from .variation import drawn_in

if TYPE_CHECKING:
    from nbformat import NotebookNode

OPPOSITES = "an answer and its opposite are right, but Moodle marks each number separately"
#: Pictures, and the line in which students write their answer.
PICTURE = re.compile(r"!\[([^\]]*)\]\([^)]*\)|<img[^>]*alt=\"([^\"]*)\"[^>]*>")
BLANK = re.compile(r"^.*# your answer\n?", re.M)
#: The note of an answer with one wrong entry, whatever its value, so it has no values of its own.
ONE_WRONG = "one wrong"


class NotExported(ValueError):
    """An error for a question that no other system can judge; the message gives the reason."""


def item_of(question: AuthoredQuestion, above: str, notebook: NotebookNode) -> Item:
    """Return one variant of a question, below the text that its notebook has ``above`` it.

    Raises
    ------
    NotExported
    """
    public, kind = question.public, kinds()[question.public.kind]
    for applies, reason in (
        (kind.by_a_person, "a person marks its answers"),
        (public.kind == "function", "its answer is a function"),
        (public.symbols, f"its answer is a formula in {', '.join(public.symbols)}"),
        (public.kind == "measurement", "its answer is a number with a unit"),
        (kind.unique not in (None, one_sign), f"many answers of the kind {public.kind} are right"),
    ):
        if applies:
            raise NotExported(reason)
    known = {str(entry.plain): entry for entry in question.entries.values()}
    values = {text: _values(question, entry.plain) for text, entry in known.items()}
    right = [values[text] for text, entry in known.items() if entry.outcome == "correct"]
    if public.either_sign:
        right.append(tuple(_number(question, -float(value)) for value in right[0]))
    wrong = [
        Wrong(
            values[text],
            note,
            question.credit.get(note, 0),
            message_of_all(public, entry.notes[:2]),
        )
        for text, entry in known.items()
        for note, _ in entry.notes[:1]
        if note != ONE_WRONG
    ]
    absolute, relative = map(float, tolerances(public))
    options = public.options or (("True", "False") if public.kind == "truth values" else ())
    figures = "\n\n".join(picture[0] for picture in PICTURE.finditer(above))
    variant = public.variant
    return Item(
        question.name,
        question.number,
        question.worth,
        (f"{figures}\n\n{text_of(variant)}" if variant else above) + _given(question, notebook),
        question.solution,
        _columns(question.plain["value"], len(right[0])),
        options,
        # Further digits of a tolerance mean nothing, and students would see its rounding.
        ()
        if kind.text
        else tuple(float(f"{absolute + relative * abs(float(n)):.3g}") for n in right[0]),
        tuple(right),
        wrong,
    )


def _given(question: AuthoredQuestion, notebook: NotebookNode) -> str:
    """Return the contents of the answer's cell as students get it, with its numbers."""
    owners = {variable: name for name, variable in checked_names(notebook).items()}
    drawn, code = "", ""
    for cell in notebook.cells:
        if cell.cell_type != "code":
            continue
        variable, name = drawn_in(cell.source) or ("", "")
        drawn = variable if name == question.name else drawn
        if question.variable in answered_in(cell.source, owners):
            code = BLANK.sub("", posed(cell.source, owners)).strip()
    numbers = [
        f"{drawn}.{name} = {value!r}"
        for name, value in question.public.given.items()
        if re.search(rf"\b{drawn}\.{name}\b", code)
    ]
    return "\n".join(["\n\n```python", *numbers, code, "```"]) if code else ""


def _values(question: AuthoredQuestion, plain: Plain) -> tuple[str, ...]:
    value = plain["value"]
    if kinds()[question.public.kind].text:
        return tuple(str(part[1]) for part in (parts_of(value) if value[0] == "list" else [value]))
    return tuple(_number(question, number) for number in read(question.public, plain).numbers[0])


def _number(question: AuthoredQuestion, number: Number) -> str:
    """Return a number with more digits than the tolerance needs, and no trace of rounding."""
    digits = 3 - int(MP.floor(MP.log10(tolerances(question.public)[0])))
    return f"{round(float(number), digits) + 0.0:.12g}"


def _columns(value: Value, places: int) -> int:
    if value[0] == "matrix":
        return size_of(value)[1]
    rows = parts_of(value) if value[0] == "list" else []
    widths = {len(parts_of(row)) if row[0] == "list" else 0 for row in rows}
    return max(widths.pop(), 1) if len(widths) == 1 and widths != {0} else places


def _exported(
    path: Path, course: Course, names: Collection[str]
) -> tuple[dict[str, list[Item]], dict[str, str]]:
    """Return the items of each question of a notebook, and why others cannot be exported."""
    if path.stem == CHAPTERS:
        return {}, dict.fromkeys(names, "its text is in a chapter")
    items, left = dict[str, list[Item]](), dict[str, str]()
    source = read_source(path, 0, course.edition, names, pictures=True)
    above = texts_of_questions(source.notebook, source.figures)
    number, questions = 0, source.questions
    while questions:
        for name, question in questions.items():
            try:
                item = item_of(question, above[name], source.notebook)
                items.setdefault(name, []).append(item)
            except NotExported as reason:
                left[name] = str(reason)
        number += 1
        having = [name for name in items if number < source.questions[name].public.variants]
        again = having and read_source(path, number, course.edition, having, pictures=True)
        questions = again.questions if again else {}
    return items, left


def _chosen(course: Course, wanted: Collection[str]) -> Iterator[tuple[Path, list[str]]]:
    """Iterate over the notebooks, each with its wanted questions, given by their or its name.

    Raises
    ------
    AuthorError
        No question or notebook has one of the names.
    """
    asked = {path: list(names_asked(path)) for path in notebooks_in(course.sources)}
    known = {*(path.stem for path in asked), *(name for names in asked.values() for name in names)}
    for name in wanted:
        if name not in known:
            raise AuthorError(
                f"There is no question or notebook {name!r}; choose from "
                f"{', '.join(sorted(known))}."
            )
    for path, names in asked.items():
        chosen = [name for name in names if not wanted or {name, path.stem} & {*wanted}]
        if chosen:
            yield path, chosen


def bank(
    course: Course, out: str | Path, format: str, wanted: Collection[str] = ()
) -> tuple[dict[str, list[Item]], list[str]]:
    """Write a course's questions for another system, and return those written and those left out.

    Parameters
    ----------
    course : Course
    out : path
    format : str
        ``'moodle'`` or ``'qti'``.
    wanted : collection of str
        Questions or notebooks; all of them if empty.

    Returns
    -------
    (dict of list of Item, list of str)
        The variants of each question that was written, and a line for each question that was not.

    Raises
    ------
    AuthorError
        The file would reach students, there is no such question, or none can be exported.
    """
    path = Path(out).resolve()
    for folder in (course.exercises, course.sealed, course.archive.parent):
        if path.is_relative_to(folder.resolve()):
            raise AuthorError(
                f"{path} would contain all answers, and students may get the files in {folder}. "
                "Write it somewhere else."
            )
    paths, names = zip(*_chosen(course, wanted))
    # Only the author needs what a solution prints.
    with contextlib.redirect_stdout(io.StringIO()), processes_for(paths) as pool:
        of_notebooks = list(pool.map(_exported, paths, [course] * len(paths), names))
    questions = {name: items for by_name, _ in of_notebooks for name, items in by_name.items()}
    left = {name: reason for _, reasons in of_notebooks for name, reason in reasons.items()}
    if format == "moodle":
        left |= {name: OPPOSITES for name, (item, *_) in questions.items() if len(item.right) > 1}
        questions = {name: items for name, items in questions.items() if name not in left}
    write = exporting.moodle if format == "moodle" else exporting.qti
    lines = [f"{name}: {reason}." for name, reason in left.items()]
    if not questions:
        raise AuthorError(
            "\n".join(["None of these questions can be exported, so no file was written.", *lines])
        )
    path.parent.mkdir(parents=True, exist_ok=True)
    for place, content in (
        (path, write(course.title, questions)),
        (path.with_name(f"{path.stem}-not-exported.txt"), "\n".join([*lines, ""]).encode()),
    ):
        place.touch(mode=0o600)
        place.chmod(0o600)
        place.write_bytes(content)
    return questions, lines
