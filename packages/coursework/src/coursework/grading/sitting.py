"""Sittings: each student answers a few questions on paper, in personal variants.

A sitting is an assignment of the term. Its answers are on paper, so a person marks all of them, and
a marker's ticks become decisions in the journal like all others.
"""

from __future__ import annotations

import functools
import json
import re
import shutil
import string
import subprocess
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple, TextIO

from markupsafe import Markup

from ..authoring.author import to_page
from ..checking.catalogue import message_of_all
from ..checking.plain import Plain, Value, parts_of
from ..checking.reading import read
from ..checking.reply import plain_text
from ..checking.variants import text_of
from ..checking.writing import LONGEST, answer_as_tex, answer_as_text
from .assignments import Course
from .grade import Desk, at_desk
from .judging.contract import Contract
from .judging.journal import case_id
from .judging.laboratory import Agree
from .judging.term import FILE, Assignment, BadTerm, notebooks_of
from .record import Answer, Record
from .reporting import pages
from .reporting.templates_of_pages import page
from .store import file_name, naming, write
from .submissions.roster import Roster, cells_in
from .tables import number, table

FOLDER, TICKS = "sittings", "ticks.csv"
#: Browsers that can print a page without opening a window.
BROWSERS = (
    "chromium-headless-shell",
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
)
#: The most boxes that markers can read while marking.
MOST_BOXES = 8
#: A row of a formula with more symbols than this is wider than half a page.
WIDE = 32


class Box(NamedTuple):
    """A box that a marker may tick: its letter, share of the points, and description."""

    letter: str
    share: float
    says: str


class Asked(NamedTuple):
    """A question of a sitting in one variant, as it is printed."""

    title: str
    worth: float
    text: Markup
    right: Markup
    decimals: str
    wide: bool
    boxes: list[Box]


def sitting(
    out: str | Path,
    name: str,
    questions: Sequence[str],
    *,
    paper: str = "a4",
    roster: str | None = None,
    solutions: str | Path | None = None,
    show: TextIO | None = None,
    agree: Agree = lambda laboratory: True,
) -> list[Path]:
    """Print a sitting for everybody in the course.

    Return three files: one for students, one for markers, and the table of ticks.

    Raises
    ------
    ValueError
        There is no roster, no such question, or one that nobody can answer on paper.
    """
    with at_desk(out, show, agree) as (desk, closing):
        people = Roster(roster) if roster else desk.term.roster
        if people is None:
            raise ValueError("Who is in the course? Set a roster in term.toml, or use --roster.")
        is_new = _has_entered(desk, name, tuple(questions))
        course = Course(solutions, desk.term, [name])
        desk.ask(course, [name], closing)
        for question, (contract, *_) in desk.questions[name].items():
            if contract.plain is None:
                raise ValueError(
                    f"{question} asks for a function, which nobody can answer on paper."
                )
        if is_new:
            path = desk.store.folder / FILE
            with naming(path), path.open("a", encoding="utf8") as file:
                file.write(f"\n[assignments.{json.dumps(name)}]\nquestions = {list(questions)}\n")
            desk.tell(f"We added the sitting to {path}. In that file, set how much it counts.")
        settled = (desk.marked(_on_paper(desk, person, name, people)) for person in people.people)
        desk.settle(settled, "printed again")
        desk.report(course)
        records = (desk.store.read(person, name) for person in people.people)
        return _printed(desk, name, list(filter(None, records)), paper)


def _has_entered(desk: Desk, name: str, questions: tuple[str, ...]) -> bool:
    """Add a new sitting to the term unless it has it, and return whether it is new."""
    path, about = desk.store.folder / FILE, desk.term.assignments.get(name)
    if not path.exists():
        raise BadTerm(f"{path} does not exist. Create it with `coursework term new`.")
    if about and (not about.questions or questions not in ((), about.questions)):
        asks = f"asks {', '.join(about.questions)}" if about.questions else "is not a sitting"
        raise BadTerm(f"{name} {asks} in {path}. Change it there, or use another name.")
    if about is None:
        desk.term = replace(
            desk.term,
            assignments={
                **desk.term.assignments,
                name: Assignment(notebooks_of(name, questions), questions=questions),
            },
        )
        if not questions:
            raise BadTerm(f"{name} is not in {path} yet. Give its questions with --questions.")
    return about is None


def _on_paper(desk: Desk, student: str, name: str, people: Roster) -> Record:
    """Return the record of a student's sheet, which keeps the variants of an earlier print."""
    record = desk.store.read(student, name) or Record(student, name)
    # Name the student, so that no two students' answers count as equal.
    answers = dict.fromkeys(desk.questions[name], Answer("on paper", why=student))
    identity, reply = people.identity(student), f"{file_name(student)}-"
    return replace(record, key=name, identity=identity, reply=reply, answers=answers)


def boxes_of(contract: Contract) -> list[Box]:
    """Return boxes for the right answer, mistakes that earn credit or are expected, and others."""
    shares: dict[str, tuple[float, bool]] = {}
    for fingerprint in contract.known:
        locker = contract.locker(fingerprint)
        for answer in locker.answers if locker else ():
            for note, _ in answer.notes[:1]:
                says = message_of_all(contract.question, answer.notes)
                shares[says] = contract.credit.get(note, 0), note == "authored"
    ranked = sorted(shares, key=shares.__getitem__, reverse=True)[:MOST_BOXES]
    said = [(1, "The right answer."), *((shares[says][0], says) for says in ranked)]
    said.append((0, "Something else, or no answer."))
    return [Box(letter, *box) for letter, box in zip(string.ascii_uppercase, said)]


def as_formula(plain: Plain | None) -> tuple[Markup, bool]:
    """Return an answer as a typeset formula, and whether it needs the full width of the page."""
    value: Value = plain["value"] if plain else ["blank"]
    parts = parts_of(value) if value[0] == "list" else []
    if plain and parts and all(part[0] == "expression" for part in parts):
        # Use one formula for each entry, so that lines can break between them.
        entries = [as_formula({"value": part, "nodes": plain["nodes"]}) for part in parts]
        return Markup("({})").format(Markup(", ").join(formula for formula, _ in entries)), any(
            wide for _, wide in entries
        )
    if plain is None or not (tex := answer_as_tex(plain)):
        texts = [str(part[1]) for part in parts or [value] if part[0] == "text"]
        text = ", ".join(texts) or answer_as_text(plain, LONGEST)
        return Markup("<strong>{}</strong>").format(text), False
    # Estimate the width: the letters of a function, one character for any other command, no braces.
    shown = re.sub(r"\\(?:left|right|(?:begin|end)\{\w+\})|[{}^_&\s]", "", tex)
    rows = re.sub(r"\\(?!sin|cos|tan|\\)[A-Za-z]+", "x", shown).split(r"\\")
    return Markup(pages.formula(tex, LONGEST)), max(map(len, rows)) > WIDE


def _asked(contract: Contract, figures: str) -> Asked:
    variant = contract.variant
    # Add values that only a cell of the notebook shows, since no text contains them.
    only_in_cells = (
        f"`{name} = {value}`"
        for name, value in variant.given.items()
        if isinstance(value, list) and name not in variant.shown and not variant.picture
    )
    text = "\n\n".join([figures, text_of(variant), *only_in_cells])
    right, wide = as_formula(contract.plain)
    return Asked(
        contract.title,
        contract.worth,
        Markup(to_page(text, functools.partial(pages.formula, longest=LONGEST))),
        right,
        _decimals(contract),
        wide,
        boxes_of(contract),
    )


def _decimals(contract: Contract) -> str:
    """Return an answer's numbers in decimals, as students write them; empty for words."""
    question = contract.question
    if contract.plain is None or question.symbols or question.kind == "measurement":
        return ""
    numbers = read(question, contract.plain).numbers
    return ", ".join(number(float(entry)) for entries in numbers[:1] for entry in entries)


def _printed(desk: Desk, name: str, records: Sequence[Record], paper: str) -> list[Path]:
    folder = desk.store.folder / FOLDER / file_name(name)
    asked: dict[str, Asked] = {}
    for record in records:
        for question, mark in record.marks.items():
            contract = desk.contracts.of(mark.version)
            if mark.version not in asked and contract:
                asked[mark.version] = _asked(contract, desk.questions[name][question][0].text)
    people = [
        (record, [asked[mark.version] for mark in record.marks.values()]) for record in records
    ]
    made = []
    for template in ("sheets", "markers"):
        path = folder / f"{template}.html"
        write(
            path,
            page(f"{template}.html", name=name, people=people, paper=paper),
            private=True,
        )
        made.append(_as_pdf(path))
    write(folder / TICKS, _table_of_ticks(folder / TICKS, people), private=True)
    if made[0].suffix == ".html":
        desk.tell(
            "Neither Chromium nor Chrome is installed here. Print the pages from your browser."
        )
    return [*made, folder / TICKS]


def _as_pdf(path: Path) -> Path:
    """Print a page as a PDF; without a browser, leave the page itself."""
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    if browser is None:
        return path
    made = path.with_suffix(".pdf")
    command = [browser, "--headless", "--no-sandbox", "--no-pdf-header-footer"]
    command += [f"--print-to-pdf={made}", path.resolve().as_uri()]
    subprocess.run(command, check=True, capture_output=True)
    path.unlink()
    return made


def _table_of_ticks(path: Path, people: Sequence[tuple[Record, list[Asked]]]) -> str:
    """Return a table with a line for each answer and its boxes, keeping earlier ticks."""
    ticked: dict[str, list[str]] = {}
    if path.exists():
        header, lines = cells_in(path)
        columns = [header.index(column) for column in ("tick", "credit", "comment")]
        ticked = {cells[0].lstrip("#"): [cells[column] for column in columns] for _, cells in lines}

    def rows() -> Iterator[list[object]]:
        for record, asked in people:
            for (question, mark), about in zip(record.marks.items(), asked):
                line = case_id(record, question)
                says = [f"{number(box.share)}: {plain_text(box.says)}" for box in about.boxes]
                yield [
                    f"#{line}",
                    f"#{mark.version}",
                    record.student,
                    question,
                    *ticked.get(line, ["", "", ""]),
                    mark.worth,
                    *says,
                ]

    letters = string.ascii_uppercase[: MOST_BOXES + 2]
    header = ["id", "version", "student", "question", "tick", "credit", "comment", "worth"]
    return table([*header, *letters], rows())
