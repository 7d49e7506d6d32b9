"""Hands marks on: into the gradebook that the teacher exported, or as
nbgrader and Gradescope want them.

A gradebook is filled in place: only the cells of one column change, and every other byte, with its
order, quotation marks and line ends, stays as the system wrote it, so that the system takes it
back. Nothing that a student wrote gets into it.
"""

import datetime
import json
import math
import os
import re
import secrets
import zipfile
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from ...checking.fields import by_name, many, text
from ...checking.reply import plain_text
from ..judging.ledger import Ledger, appeals_open, with_decisions
from ..judging.term import EXCUSED, Result, Rules, results_of, say_what_marked_costs
from ..record import Identity, Record
from ..store import REFUSED, Store, as_text, file_name, write
from ..submissions.intake import Refused
from ..submissions.languages import LANGUAGES, in_english
from ..submissions.roster import local_parts
from ..tables import in_a_line, number, readable, table

NBGRADER = (
    "assignment",
    "duedate",
    "timestamp",
    "student_id",
    "last_name",
    "first_name",
    "email",
    "raw_score",
    "late_submission_penalty",
    "score",
    "max_score",
)
POSSIBLE = "points possible"


class CannotExport(ValueError):
    """Marks cannot be handed on; the message says what is missing."""


class Marks:
    """The points of each student, over one assignment or all, with all
    decisions, and by the rules of the term.

    Parameters
    ----------
    store : Store
    assignment : str, optional
    rules : Rules, optional
        Of the term: then lateness costs what they say, and who is excused has no points.
    as_of : datetime, optional
        By what people had decided then, and what was due; what was handed in and judged is that of
        the records.

    Attributes
    ----------
    records : list of dict
    students : dict
        The records of each student.
    """

    def __init__(
        self,
        store: Store,
        assignment: str | None = None,
        rules: Rules | None = None,
        as_of: datetime.datetime | None = None,
    ) -> None:
        self.store, self.rules = store, rules
        standing = Ledger(store.folder).standing(as_of)
        self.behind = 0
        self.records: list[Record] = []
        for record in store.all():
            if assignment in (None, record.assignment):
                decided = with_decisions(record, standing)
                self.behind += decided != record
                self.records.append(decided)
        if not self.records:
            named = f" of {assignment!r}" if assignment else ""
            raise CannotExport(f"There are no records{named} in {store.folder}.")
        self.assignments = sorted({record.assignment for record in self.records})
        self.students: dict[str, list[Record]] = {}
        for record in self.records:
            self.students.setdefault(record.student, []).append(record)
        worth = {record.assignment: record.worth for record in self.records}
        self.worth = sum(worth.values())
        self.results = (
            self._results(rules, worth, as_of or datetime.datetime.now(datetime.UTC))
            if rules
            else {}
        )

    def _results(
        self, rules: Rules, worth: Mapping[str, float], now: datetime.datetime
    ) -> dict[tuple[str, str], Result]:
        """What the rules make of each record, by student and assignment."""
        unknown = [name for name in self.assignments if name not in rules.assignments]
        if unknown:
            raise CannotExport(f"The rules say nothing of {', '.join(unknown)}.")
        found: dict[tuple[str, str], Result] = {}
        marked: list[str] = []
        for student, records in self.students.items():
            own = {record.assignment: record for record in records}
            for result in results_of(student, own, rules, worth, now)[0]:
                if result.assignment in own:
                    found[student, result.assignment] = result
                    if result.late and result.handed_in is None:
                        marked.append(result.assignment)
        if marked and rules.marked is None and rules.late_costs:
            raise CannotExport(say_what_marked_costs(marked))
        return found

    def penalty(self, record: Record) -> float:
        """The share of the points of a record that its lateness costs."""
        found = self.results.get((record.student, record.assignment))
        return found.penalty if found else 0.0

    def excused(self, student: str) -> bool:
        """Whether the rules excuse a student from what is handed on here, or from a part of it."""
        return any(
            self.results[student, record.assignment].state == EXCUSED
            for record in self.students[student]
            if self.results
        )

    def points(self, student: str) -> float:
        return sum(record.points * (1 - self.penalty(record)) for record in self.students[student])

    def undecided(self, student: str) -> int:
        return sum(record.undecided for record in self.students[student])

    def appeals(self, student: str) -> list[str]:
        """The questions of a student against whose marks an appeal is open."""
        return [name for record in self.students[student] for name in appeals_open(record)]

    def identity(self, student: str) -> Identity:
        return self.students[student][0].identity


# --- a table whose every byte is kept -----------------------------------------------------------


class Field(NamedTuple):
    """A cell: what it says, and how that is written."""

    says: str
    written: str


class Gradebook:
    """A table of a learning management system, of which cells can be changed one at a time."""

    def __init__(self, data: bytes, names: Mapping[str, str] | None = None) -> None:
        self.encoding, self.mark = _encoding(data)
        text = data[len(self.mark) :].decode(self.encoding)
        self.delimiter = max(",;\t", key=text.split("\n", 1)[0].count)
        self.lines = _split(text, self.delimiter)
        if len(self.lines) < 2:
            raise CannotExport("The gradebook has no students.")
        self.header = [field.says.strip() for field in self.lines[0][0]]
        known, self.no = in_english(self.header)
        self.ours = known | {
            theirs.casefold(): ours.casefold() for ours, theirs in (names or {}).items()
        }
        there = {name.casefold() for name in self.header}
        unknown = [theirs for theirs in (names or {}).values() if theirs.casefold() not in there]
        if unknown:
            raise CannotExport(
                f"There is no column {unknown[0]!r}; there are {', '.join(map(repr, self.header))}."
            )

    def column(self, *names: str) -> int | None:
        """The number of the first column that has one of these names; ``None`` if there is none."""
        lower = [self.ours.get(name.casefold(), name.lower()) for name in self.header]
        return next((lower.index(name) for name in names if name in lower), None)

    def says(self, line: int, column: int | None) -> str:
        fields = self.lines[line][0]
        return fields[column].says.strip() if column is not None and column < len(fields) else ""

    def put(self, line: int, column: int, text: str) -> None:
        fields = self.lines[line][0]
        quoted = fields[column].written.startswith('"') or self.delimiter in text
        fields[column] = Field(text, f'"{text}"' if quoted else text)

    def __bytes__(self) -> bytes:
        text = "".join(
            self.delimiter.join(field.written for field in fields) + end
            for fields, end in self.lines
        )
        return self.mark + text.encode(self.encoding)


def _encoding(data: bytes) -> tuple[str, bytes]:
    for mark, encoding in (
        (b"\xef\xbb\xbf", "utf-8"),
        (b"\xff\xfe", "utf-16-le"),
        (b"\xfe\xff", "utf-16-be"),
    ):
        if data.startswith(mark):
            return encoding, mark
    try:
        data.decode("utf-8")
        return "utf-8", b""
    except UnicodeDecodeError:
        return "latin-1", b""  # gives every byte back as it was


def _split(text: str, delimiter: str) -> list[tuple[list[Field], str]]:
    """Lines of fields, and what ends each line."""
    pattern = re.compile(
        r'("(?:[^"]|"")*"[^%s\r\n]*|[^%s\r\n]*)(%s|\r\n|\n|\r|$)' % ((re.escape(delimiter),) * 3)
    )
    lines: list[tuple[list[Field], str]] = []
    fields: list[Field] = []
    place = 0
    while found := pattern.match(text, place) if place < len(text) else None:
        written, end = found.groups()
        says = (
            written[1 : written.rindex('"')].replace('""', '"')
            if written.startswith('"') and len(written) > 1
            else written
        )
        fields.append(Field(says, written))
        place = found.end()
        if end != delimiter:
            lines.append((fields, end))
            fields = []
        elif place == len(text):
            fields.append(Field("", ""))
    if fields:
        lines.append((fields, ""))
    return lines


# --- the systems --------------------------------------------------------------------------------


#: What was written into each column of a gradebook, by student: what stands
#: there of these is ours to change.
WRITTEN = "exported.json"


def fill(
    path: str | Path,
    marks: Marks,
    column: str | None = None,
    filled: str | Path | None = None,
    names: Mapping[str, str] | None = None,
    overwrite: Collection[str] = (),
    dry_run: bool = False,
) -> list[str]:
    """Fill the gradebook of Canvas, Moodle or Brightspace.

    Parameters
    ----------
    path : path
        As the teacher exported it.
    marks : Marks
    column : str, optional
        The name of the column to fill, or its beginning; needed where several could be meant.
    filled : path, optional
        Where the filled gradebook goes.
    names : dict, optional
        What columns are called in this gradebook, by their names in English.
    overwrite : collection of str
        Students whose mark by hand is written over. An excuse, such as Canvas's ``EX``, never is.
    dry_run : bool
        Say what would be written, and write nothing.

    Returns
    -------
    list of str
        What was done, and who did not match.

    Raises
    ------
    CannotExport
    """
    path = Path(path)
    try:
        book = Gradebook(path.read_bytes(), names)
    except (OSError, UnicodeDecodeError) as error:
        raise CannotExport(f"{path} cannot be read: {error}.") from None
    system = _system(book)
    place = _column(book, system, column)
    out_of, first, comma = _scale(book, system, place)
    found, several = _match(book, system, marks, first)
    scale = out_of / marks.worth if out_of and marks.worth else 1
    said = [f"{system}: column {book.header[place]!r}."]
    if scale != 1:
        said.append(
            f"The column is out of {number(out_of or 0)} and the questions are worth "
            f"{number(marks.worth)}: "
            "points are scaled."
        )
    header = book.header[place]
    known = marks.store.said(WRITTEN, by_name(by_name(many(text)))) or {}
    ours = known.setdefault(header, {})
    waiting, closed, kept, excused, replaced, changes = (list[str]() for _ in range(6))
    filled_in = 0
    strangers = sorted(set(overwrite) - set(found.values()))
    if strangers:
        raise CannotExport(
            f"To be written over is the mark of {strangers[0]!r}, who is not in this gradebook."
        )
    for line, student in sorted(found.items()):
        if marks.excused(student):
            excused.append(student)
        elif marks.undecided(student):
            waiting.append(student)
        elif (
            system == "Moodle"
            and book.says(line, book.column("grade can be changed")).casefold() == book.no
        ):
            closed.append(student)
        else:
            points = number(round(marks.points(student) * scale, 2))
            there = book.says(line, place)
            before = ours.setdefault(student, ())
            if there not in ("", "-") and not any(
                _is_same(there, one) for one in (points, *before)
            ):
                if student not in overwrite or not _is_number(there):
                    kept.append(f"{student}: {there}, and graded {points}")
                    continue
                replaced.append(f"{student}: {there} -> {points}")
            elif there not in ("", "-") and not _is_same(there, points):
                changes.append(f"{student}: {there} -> {points}")
            if points not in before:
                ours[student] = (*before, points)
            book.put(line, place, points.replace(".", ",") if comma else points)
            filled_in += 1
    if changes:
        said.append(f"Changed since it was written from here last ({len(changes)}):")
        said += [f"  {in_a_line(change, 200)}" for change in changes]
    target = Path(filled) if filled else path.with_name(f"{path.stem}-filled{path.suffix}")
    if dry_run:
        said.append(f"{filled_in} would be filled in: nothing was written.")
    else:
        # First what is ours: of a crash in between, the next run knows more than it
        # wrote, and nothing is overlooked.
        write(marks.store.folder / WRITTEN, as_text(known))
        write(target, bytes(book))
        said.append(f"{filled_in} filled in: {target}")
    without = [
        book.says(line, _shown(book, system))
        for line in range(first, len(book.lines))
        if line not in found and any(field.says for field in book.lines[line][0])
    ]
    unmatched = [
        student
        for student in marks.students
        if student not in found.values() and student not in several
    ]
    damaged, without = _with_damaged(marks.store, without)
    appealing = [
        f"{student}: {', '.join(open_ones)}"
        for student in marks.students
        if (open_ones := marks.appeals(student))
    ]
    for heading, those in (
        ("In the gradebook, and nothing was handed in", without),
        ("In the gradebook, and what they handed in cannot be graded", damaged),
        ("Handed in, and not in the gradebook", unmatched),
        ("Of a name that is there more than once, or that two go by, so not filled in", several),
        ("Not filled in, because a person has still to decide", waiting),
        ("An appeal is open: what is filled in may change", appealing),
        ("Not filled in, because the system allows no change", closed),
        ("Excused by the rules, so not filled in", excused),
        ("A mark by hand, written over as you said", replaced),
        ("Not filled in, because something else stands there than was written from here", kept),
    ):
        if those:
            said.append(f"{heading} ({len(those)}):")
            said += [f"  {in_a_line(name, 200)}" for name in those]
    return said


def _is_same(there: str, text: str) -> bool:
    return _is_number(there) and float(there.replace(",", ".")) == float(text)


def _is_number(there: str) -> bool:
    try:
        return math.isfinite(float(there.replace(",", ".")))
    except ValueError:
        return False


def _with_damaged(store: Store, names: Sequence[str]) -> tuple[list[str], list[str]]:
    """Of those without a record: who handed in only what was refused, and who nothing."""
    refused = store.said(REFUSED, many(Refused.from_json)) or ()
    known = {_signs(one.student) for one in refused if one.student}
    damaged = [name for name in names if _signs(name) in known or _signs(_turned(name)) in known]
    return damaged, [name for name in names if name not in damaged]


def _signs(name: str) -> str:
    return "".join(sign for sign in name.casefold() if sign.isalnum())


def _turned(name: str) -> str:
    last, _, first = name.partition(",")
    return f"{first} {last}"


def _system(book: Gradebook) -> str:
    if book.column("identifier") is not None and book.column("grade") is not None:
        return "Moodle"
    if book.column("orgdefinedid") is not None or book.column("end-of-line indicator") is not None:
        return "Brightspace"
    # Canvas gives the name in one column, or on request in two.
    if book.column("student", "lastname") is not None and book.column("id") is not None:
        return "Canvas"
    raise CannotExport(
        "This is no gradebook of Canvas (columns Student, ID), Moodle (Identifier, Grade) or "
        "Brightspace (OrgDefinedId, End-of-Line Indicator), nor one of Moodle in a language that "
        f"is known here ({', '.join(LANGUAGES)}). "
        "Say which column is which: --name 'identifier=...' "
        "--name 'grade=...'. "
        f"Its columns: {', '.join(book.header)[:300]}"
    )


def _column(book: Gradebook, system: str, column: str | None) -> int:
    if column:
        places = [place for place, name in enumerate(book.header) if name == column] or [
            place
            for place, name in enumerate(book.header)
            if name.lower().startswith(column.lower())
        ]
    elif system == "Moodle":
        places = [place for place in (book.column("grade"),) if place is not None]
    elif system == "Brightspace":
        places = [
            place
            for place, name in enumerate(book.header)
            if "points grade" in name.lower() or "maxpoints:" in name.lower()
        ]
    else:
        # Canvas puts the number of an assignment behind its name.
        places = [place for place, name in enumerate(book.header) if re.search(r"\(\d+\)$", name)]
    if len(places) != 1:
        names = [book.header[place] for place in places] or book.header
        raise CannotExport(
            f"Name the column to fill with --column; there are {', '.join(map(repr, names))}."
        )
    return places[0]


def _scale(book: Gradebook, system: str, place: int) -> tuple[float | None, int, bool]:
    """What the column is out of, the first line of a student, and whether numbers have a comma."""
    first, said = 1, ""
    if system == "Canvas":
        while first < len(book.lines) and (
            book.says(first, 0).lower() == POSSIBLE or not book.says(first, book.column("id"))
        ):
            if book.says(first, 0).lower() == POSSIBLE:
                said = book.says(first, place)
            first += 1
    elif system == "Brightspace":
        found = re.search(r"MaxPoints:\s*([\d.,]+)", book.header[place])
        said = found[1] if found else ""
    else:
        said = book.says(1, book.column("maximum grade"))
    comma = bool(re.fullmatch(r"\d+,\d+", said))  # as the language writes numbers
    try:
        return float(said.replace(",", ".")), first, comma
    except ValueError:
        return None, first, comma


def _shown(book: Gradebook, system: str) -> int | None:
    return {
        "Canvas": 0,
        "Moodle": book.column("full name", "identifier"),
        "Brightspace": book.column("username", "orgdefinedid"),
    }[system]


def _match(
    book: Gradebook, system: str, marks: Marks, first: int
) -> tuple[dict[int, str], list[str]]:
    """The student of each line; and students whom several lines could mean."""
    lines: dict[tuple[str, str], set[int]] = {}
    addresses: dict[int, str] = {}
    for line in range(first, len(book.lines)):
        for key in _keys_of_line(book, system, line):
            lines.setdefault(key, set()).add(line)
        addresses[line] = book.says(line, book.column("email address")).lower()
    for line, own in local_parts(addresses).items():
        lines.setdefault(("own", own), set()).add(line)
    wanting: dict[int, list[str]] = {}
    several: list[str] = []
    for student in marks.students:
        for key in _keys_of_student(system, student, marks.identity(student)):
            candidates = lines.get(key, set())
            if len(candidates) == 1:
                wanting.setdefault(next(iter(candidates)), []).append(student)
                break
            if candidates:
                several.append(student)
                break
    # Who comes first has no better claim: a line that two could mean is filled in for neither.
    several += [
        student for students in wanting.values() if len(students) > 1 for student in students
    ]
    return {line: students[0] for line, students in wanting.items() if len(students) == 1}, several


def _keys_of_line(book: Gradebook, system: str, line: int) -> set[tuple[str, str]]:
    def of(*names: str) -> str:
        return book.says(line, book.column(*names)).lower()

    if system == "Canvas":
        given = [
            ("id", of("id")),
            ("own", of("sis login id")),
            ("own", of("sis user id")),
            ("own", of("integration id")),
        ]
    elif system == "Moodle":
        given = [
            # Behind the word for a participant, in whatever language: "Teilnehmer/in9".
            ("id", re.sub(r"\D", "", of("identifier"))),
            ("own", of("id number")),
            ("own", of("username")),
            ("own", of("email address")),
            ("name", of("full name")),
        ]
    else:
        given = [
            ("own", of("orgdefinedid").removeprefix("#")),
            ("own", of("username").removeprefix("#")),
            ("name", " ".join((of("first name") + " " + of("last name")).split())),
        ]
    return {key for key in given if key[1]}


def _keys_of_student(system: str, student: str, identity: Identity) -> Iterator[tuple[str, str]]:
    called = identity.called
    if system.lower() in called and system != "Brightspace":
        yield "id", called[system.lower()]
        return
    for own in identity.own or ():
        yield "own", own.lower()
    if "email" in called:
        yield "own", called["email"].lower()
    if identity == Identity():
        yield "own", student.lower()  # the folder's name is all that is known
    if "name" in called:
        yield "name", called["name"].lower()


def write_feedback(path: str | Path, marks: Marks, store: Store) -> int:
    """Write an archive of the pages of feedback, named so that the system which
    handed the work out takes them back.

    A name begins with what the system wrote of the name of the work. Canvas reads the first two
    numbers between underscores, of the student and of the file, takes no page whose last part
    begins with "link", and looks at no folders. Moodle reads the number of the participant and
    ``assignsubmission_file``, in the first folder that has them. Brightspace knows its own folders.
    Give the number of pages.

    Raises
    ------
    CannotExport
        A page is missing, or two would have one name.
    """
    if marks.behind:
        raise CannotExport(
            f"Decisions on {marks.behind} records are not in the pages yet: coursework regrade "
            f"{store.folder}."
        )
    pages: dict[str, Path] = {}
    for record in marks.records:
        page = (
            store.folder
            / "feedback"
            / file_name(record.student)
            / f"{file_name(record.assignment)}.html"
        )
        if not page.exists() or record.reply is None:
            raise CannotExport(f"There is no feedback for {record.student!r}: grade again.")
        name = f"{record.reply}feedback-{file_name(record.assignment).replace('_', '-')}.html"
        if name in pages:
            raise CannotExport(
                f"Two pages of feedback would be called {name!r}: grade again, with a --roster."
            )
        pages[name] = page
    half = Path(path).with_name(f".half-{secrets.token_hex(8)}")
    try:
        with zipfile.ZipFile(half, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, page in sorted(pages.items()):
                # With a fixed date: the same pages give the same bytes.
                entry = zipfile.ZipInfo(name)
                entry.compress_type = zipfile.ZIP_DEFLATED
                archive.writestr(entry, page.read_bytes())
        os.replace(half, path)
    finally:
        half.unlink(missing_ok=True)
    return len(pages)


def write_nbgrader(path: str | Path, marks: Marks) -> None:
    """Write nbgrader's table of grades."""
    rows = []
    for record in marks.records:
        rows.append(
            (
                record.assignment,
                "",
                "",
                record.student,
                "",
                "",
                "",
                record.points,
                round(record.points * marks.penalty(record), 4),
                round(record.points * (1 - marks.penalty(record)), 4),
                record.worth,
            )
        )
    write(path, table(NBGRADER, rows))


STATUS = {"correct": "passed", "decided": "passed"}


def write_gradescope(path: str | Path, marks: Marks, student: str | None = None) -> None:
    """Write what Gradescope reads of an autograder: the results of one student."""
    if student is None and len(marks.students) != 1:
        raise CannotExport(
            "Gradescope takes one student at a time; name one with --student. There are "
            f"{len(marks.students)}."
        )
    student = student or next(iter(marks.students))
    if student not in marks.students:
        raise CannotExport(f"There are no records of {student!r}.")
    tests: list[dict[str, str | float]] = []
    for record in marks.students[student]:
        for mark in record.marks.values():
            tests.append(
                {
                    "name": readable(mark.title, 200),
                    "number": str(len(tests) + 1),
                    "score": mark.points,
                    "max_score": mark.worth,
                    # Neither one nor the other, where a person has still to decide.
                    **(
                        {}
                        if mark.outcome == "undecided"
                        else {"status": STATUS.get(mark.outcome, "failed")}
                    ),
                    "visibility": "visible",
                    "output_format": "text",
                    "output": readable("\n".join([mark.outcome, *map(plain_text, mark.messages)])),
                }
            )
    write(
        path,
        json.dumps(
            {"score": marks.points(student), "output_format": "text", "tests": tests},
            indent=1,
            ensure_ascii=False,
        )
        + "\n",
    )
