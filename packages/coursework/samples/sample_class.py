"""A sample class for trying out grading: right, mistaken, unfinished, broken and hostile notebooks.

Run it with ``python packages/coursework/samples/sample_class.py FOLDER STUDENTS NOTEBOOK ...``. The
file ``expected.json`` beside the notebooks describes their contents, to compare with the results of
grading. The students are fictitious, and the same seed makes the same class.
"""

from __future__ import annotations

import contextlib
import copy
import io
import json
import random
import re
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import nbformat
import sympy

from coursework.authoring.course import course_around, find_course
from coursework.authoring.forms import equivalent_forms
from coursework.authoring.release import exercise_notebook
from coursework.authoring.source import (
    CHAPTERS,
    SOLUTION,
    blank,
    bound,
    checked_names,
    read_source,
)
from coursework.authoring.variation import drawn_in
from coursework.checking.plain import NotPlain
from coursework.checking.question import Variant
from coursework.checking.variants import numbers_of_variants

if TYPE_CHECKING:
    from nbformat import NotebookNode

    from coursework.authoring.author import AuthoredQuestion

#: Cells that try to get marks, or to escape. None knows an answer, so none earns anything, and none
#: does damage if it succeeds, since somebody may use this class where students' code is not
#: isolated.
HOSTILE = {
    "replaces the check": "import coursework\n"
    "coursework.check = check = lambda *answers: 'Correct'",
    "leaves": "import os\nos._exit(0)",
    "reads and writes files": "import pathlib\n"
    "print(pathlib.Path('/etc/passwd').read_text())\n"
    "pathlib.Path('/tmp/forged').write_text('x')",
    "calls home": "import socket\nsocket.create_connection(('192.0.2.1', 80), 1)",
    "fills the memory": "much = [bytearray(1 << 26) for number in range(40)]",
    "a script": "_ = check('<script>alert(1)</script>', '<img src=x onerror=alert(1)>')",
    "never ends": "while True:\n    pass",
}
#: Files that cannot be graded, made from a notebook.
BROKEN = {
    "half a file": lambda data: data[: len(data) // 2],
    "two entries of one name": lambda data: data.replace(b"{", b'{"cells": [], ', 1),
    "empty": lambda data: b"",
    "no notebook": lambda data: b"PK\x03\x04 a text in another format",
}


class Written(NamedTuple):
    """An answer as code, with the expected outcome and note."""

    blank: str
    code: str
    expected: tuple[str, str]


class Asked(NamedTuple):
    """A variant of a question, with right and wrong answers to it."""

    question: AuthoredQuestion
    right: list[Written]
    wrong: list[Written]


def code_of(answer: Any) -> str:
    """Return Python code for an answer.

    Raises
    ------
    TypeError
        A student would not write it.
    """
    if isinstance(answer, sympy.MatrixBase):
        return f"sm.Matrix({code_of(answer.tolist())})"
    if isinstance(answer, sympy.Expr) and not answer.atoms(sympy.Derivative):
        return f"sm.sympify({sympy.srepr(answer)!r})"
    if isinstance(answer, (list, tuple)):
        return f"[{', '.join(map(code_of, answer))}]"
    if isinstance(answer, (str, bool, int, float)):
        return repr(answer)
    raise TypeError


def written(question: AuthoredQuestion, answers: Iterable[Any]) -> list[Written]:
    """Return those answers that a student would write, with what the check says to them."""
    writable = []
    for answer in answers:
        with contextlib.suppress(TypeError, NotPlain):
            code = f"{question.variable} = {code_of(answer)}"
            reply = question.reply_to(question.to_plain(answer))
            line = f"{question.variable} = ...  # your answer"
            writable.append(Written(line, code, (reply.outcome, reply.note)))
    return writable


def asked_of(question: AuthoredQuestion) -> Asked:
    """Return a variant of a question, with right answers and, first, the most frequent mistakes."""
    forms = [answer for _, answer in equivalent_forms(question.public, question.answer)]
    mistakes = {
        (mistake.note, str(mistake.details)): mistake.answer
        for mistake in reversed(question.mistakes)
    }
    # The same mistakes are frequent in a class, even where its members' numbers differ.
    wrong = list(mistakes.values())
    random.Random(question.name).shuffle(wrong)
    if isinstance(question.answer, (sympy.Expr, sympy.MatrixBase)):
        # No catalogue knows this mistake.
        wrong.insert(4, 2 * question.answer / 7)
    return Asked(question, written(question, forms), written(question, wrong[:6]))


def exercise(path: Path, edition: str) -> tuple[list[NotebookNode], dict[str, list[Asked]]]:
    """Return the cells that students get, and the questions by name, each in all its variants."""
    source = read_source(path, edition=edition)
    asked = {name: [asked_of(question)] for name, question in source.questions.items()}
    for number in range(1, max((rule.count for rule in source.rules.values()), default=1)):
        for name, question in read_source(path, number, edition).questions.items():
            asked[name].append(asked_of(question))
    owners = {variable: name for name, variable in checked_names(source.notebook).items()}
    drawn = filter(None, (drawn_in(cell.source) for cell in source.notebook.cells))
    variables = {name: variable for variable, name in drawn}
    for region in (
        solution for cell in source.notebook.cells for solution in SOLUTION.findall(cell.source)
    ):
        for name in [owners[variable] for variable in bound(region, owners)]:
            # A function is answered as its author does, unless that uses what students do not get.
            used = set(re.findall(rf"\b{variables.get(name)}\.(\w+)", region))
            for variant in asked[name]:
                if not variant.right and used <= set(variant.question.public.given):
                    empty = blank(region, owners).rstrip()
                    variant.right.append(Written(empty, region.rstrip(), ("correct", "")))
    return exercise_notebook(source, roster=True).cells, asked


def handed_in(
    cells: Sequence[NotebookNode],
    asked: Mapping[str, Sequence[Asked]],
    student: str,
    dice: random.Random,
) -> tuple[list[NotebookNode], dict[str, tuple[str, str]]]:
    """Return a student's cells, and the expected outcome and note of each question."""
    skill, expected = dice.betavariate(4, 1.6), {}
    text = "\0".join(cell.source for cell in cells)
    text = re.sub(r"^student\(''\)", f"student({student!r})", text, flags=re.M)
    for name, variants in asked.items():
        variant = variants[0].question.public.variant or Variant()
        own = variants[numbers_of_variants(student, name, variant, len(variants))[0]]
        chance, expected[name] = dice.random(), ("not attempted", "")
        answers = own.right if chance < skill or not own.wrong else own.wrong
        if answers and chance < 0.94:
            # Each answer is half as frequent as the one before it.
            chances = [2.0**-order for order in range(len(answers))]
            (answer,) = dice.choices(answers, chances)
            text = text.replace(answer.blank, answer.code)
            expected[name] = answer.expected
    made = copy.deepcopy(list(cells))
    for cell, source in zip(made, text.split("\0"), strict=True):
        cell.source = source
    return made, expected


def make_class(
    out: str | Path,
    students: int = 200,
    seed: int = 1,
    notebooks: Sequence[str] = (),
    solutions: str | Path | None = None,
) -> Path:
    """Write a class to a folder, and return the location of its submissions.

    Parameters
    ----------
    out : path
    students : int
    seed : int
    notebooks : list of str
        The exercises that make up the submitted notebook; by default, the first of all.
    solutions : path, optional
    """
    folder, out = Path(solutions or find_course().sources), Path(out)
    known = sorted(path.stem for path in folder.glob("*.ipynb") if path.stem != CHAPTERS)
    stems, dice = list(notebooks) or known[:1], random.Random(f"class {seed}")
    cells, asked = list[Any](), dict[str, list[Asked]]()
    # What a solution prints is for its author.
    with contextlib.redirect_stdout(io.StringIO()):
        for stem in stems:
            edition = getattr(course_around(folder), "edition", "")
            more, questions = exercise(folder / f"{stem}.ipynb", edition)
            cells, asked = cells + more, asked | questions
    names = [f"student-{number + 1:03}" for number in range(students)]
    chosen = dice.sample(names, min(students // 8 or 1, len(HOSTILE) + len(BROKEN)))
    deeds = dict(zip(chosen, [*HOSTILE, *BROKEN]))
    about = {}
    for student in names:
        made, expected = handed_in(cells, asked, student, dice)
        did = deeds.get(student, "")
        if did in HOSTILE:
            place = dice.randrange(len(made) // 2, len(made))
            made.insert(place, nbformat.v4.new_code_cell(HOSTILE[did]))
        elif not did and dice.random() < 0.1:
            did = "without metadata"
            for cell in made:
                cell.metadata = {}
        for number, cell in enumerate(made):
            cell["id"] = f"cell-{number}"
        data = nbformat.writes(nbformat.v4.new_notebook(cells=made)).encode("utf8")
        place_of_file = out / "submissions" / student / f"{'-and-'.join(stems)}.ipynb"
        place_of_file.parent.mkdir(parents=True, exist_ok=True)
        place_of_file.write_bytes(BROKEN[did](data) if did in BROKEN else data)
        about[student] = {"did": did, "questions": expected}
    (out / "expected.json").write_text(json.dumps(about, indent=1) + "\n", "utf8")
    worth = sum(variants[0].question.worth for variants in asked.values())
    (out / "gradebook.csv").write_text(gradebook(names, worth), "utf8", newline="")
    return out / "submissions"


def gradebook(students: Sequence[str], worth: float) -> str:
    """Return a Canvas gradebook, with one more student, who handed in nothing."""
    lines = [
        "Student,ID,SIS User ID,SIS Login ID,Section,Exercises (4711),Final Score",
        f"    Points Possible,,,,,{worth},(read only)",
    ]
    for number, student in enumerate([*students, f"student-{len(students) + 1:03}"], 100_001):
        first, last = student.title().split("-")
        lines.append(f'"{last}, {first}",{number},S{number},{student},Section 1,,')
    return "\r\n".join([*lines, ""])


if __name__ == "__main__":
    out, number, *named = sys.argv[1:]
    print(f"{number} students in {make_class(out, int(number), notebooks=named)}")
