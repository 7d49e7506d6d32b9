"""Export of marks to the gradebook that an instructor exported, to nbgrader and to Gradescope.

We fill a gradebook in place. Only the cells of one column change, and every other byte, with the
order, quotation marks and line ends, stays as the system wrote it, so that the system accepts it.
Nothing that a student wrote gets into it.
"""

import datetime
import functools
import getpass
import json
import math
import re
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

from ...authoring.packing import zipped
from ...checking.reply import plain_text
from ...checking.writing import readable
from ..judging.journal import Exported, Given, Journal, with_decisions
from ..judging.term import DAMAGED, EXCUSED, Result, Term, result_of, term_of, unknown_times
from ..record import Identity, Record
from ..store import Store, feedback_of, file_name, write
from ..submissions.intake import refused_of
from ..submissions.languages import LANGUAGES, in_english
from ..submissions.roster import encoding_of, local_parts, turned
from ..tables import in_a_line, number, number_of, reason_of, table

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


class CannotExport(ValueError):
    """An error for marks that cannot be exported; the message says what is missing."""


class Marks:
    """The marks that were given, as the journal has them, by the rules of the term.

    Lateness has its cost, students who are excused have no points, and members of a group have
    those of the group.

    Parameters
    ----------
    store : Store
    assignment : str, optional
        Needed if there is more than one.
    term : Term, optional
        By default, the term in the folder.
    as_of : datetime, optional
        The time for which to take the marks and due dates. What was handed in is that of the
        records.

    Attributes
    ----------
    records : list of Record
    given : dict
        The marks that were given last, by student and assignment.
    students : dict
        The records of each student.
    missing : list of str
        Students who handed in nothing for the one assignment, although it was due.
    behind : int
        The number of records with decisions that are not in the marks yet.
    """

    def __init__(
        self,
        store: Store,
        assignment: str | None = None,
        term: Term | None = None,
        as_of: datetime.datetime | None = None,
    ) -> None:
        self.store = store
        self.term = term = term or term_of(store.folder)
        self.journal = Journal(store.folder)
        self.standing, now = self.journal.standing(as_of), self.journal.standing()
        self.given = self.standing.given
        self.behind = 0
        self.records: list[Record] = []
        for record in store.all():
            key = record.student, record.assignment
            if assignment in (None, record.assignment) and key in self.given:
                marks = {
                    name: (mark.points, mark.outcome)
                    for name, mark in with_decisions(record, now).marks.items()
                }
                self.behind += marks != {
                    name: (part.points, part.outcome) for name, part in now.given[key].marks.items()
                }
                self.records.append(record)
        if not self.records:
            named = f" of {assignment!r}" if assignment else ""
            raise CannotExport(
                f"There are no marks{named} in {store.folder}"
                + (f" as of {as_of:%Y-%m-%d %H:%M}." if as_of else ".")
            )
        for student, graded in self.given:
            place = store.place(student, graded)
            # A student who was renamed has a record that was set aside.
            aside = store.folder / "put-aside" / place.relative_to(store.records)
            if not place.exists() and not aside.exists():
                raise CannotExport(
                    f"{student}'s record for {graded} is missing from {store.records}, although it "
                    "has been graded. Grade again first."
                )
        self.assignments = sorted({record.assignment for record in self.records})
        self.students: dict[str, list[Record]] = {}
        for record in self.records:
            for member in term.members(record.student):
                if store.owner(member, record.assignment, record.student) == record.student:
                    self.students.setdefault(member, []).append(record)
        people = set(term.roster.people) if term.roster else set()
        worth = {record.assignment: record.worth for record in self.records}
        refused = {file.student for file in refused_of(store)}
        self.results: dict[tuple[str, str], Result] = {}
        moment = as_of or datetime.datetime.now(datetime.UTC)
        for student in sorted(people | set(self.students)):
            own = {record.assignment: record for record in self.students.get(student, ())}
            sat = {
                name: self.given[student, name].marks
                for name in term.sittings
                if (student, name) in self.given
            }
            for name in self.assignments:
                self.results[student, name] = result_of(
                    student, name, own.get(name), term, worth, moment, sat, refused
                )
        self.unknown = unknown_times(self.results.values(), term)

    @property
    def assignment(self) -> str:
        """The one assignment, since marks of several are not added up for a column.

        Raises
        ------
        CannotExport
        """
        if len(self.assignments) > 1:
            raise CannotExport(
                f"There are marks for {', '.join(self.assignments)}. Choose one with --assignment."
            )
        return self.assignments[0]

    @functools.cached_property
    def missing(self) -> list[str]:
        about = self.term.assignments.get(self.assignment)
        return [
            student
            for (student, _), result in self.results.items()
            if result.state == "missing" and about and about.due
        ]

    def in_state(self, state: str) -> list[str]:
        """Return the students whose result for the one assignment is in a state."""
        return [student for (student, _), result in self.results.items() if result.state == state]

    def mark(self, student: str) -> Given:
        """Return the student's mark for the one assignment."""
        return self.given[self.students[student][0].student, self.assignment]

    def points(self, student: str) -> float:
        result = self.results[student, self.assignment]
        return (self.mark(student).points - result.held_back) * (1 - result.penalty)

    def appeals(self, student: str) -> list[str]:
        """Return the questions for which a student has an open appeal."""
        return [
            question
            for (whose, assignment, question), appeals in self.standing.appeals.items()
            if (whose, assignment)
            in [(record.student, record.assignment) for record in self.students[student]]
            and any(appeal.is_open for appeal in appeals)
        ]

    def identity(self, student: str) -> Identity:
        record = self.students[student][0] if student in self.students else None
        own = record.identity if record and record.student == student else Identity()
        if self.term.roster and student in self.term.roster.people:
            known = self.term.roster.identity(student)
            return Identity({**own.called, **known.called}, known.own)
        return own


# --- a table that keeps every byte --------------------------------------------------------------


class Field(NamedTuple):
    """A cell: its contents, and how they are written."""

    says: str
    written: str


class Gradebook:
    """A learning management system's table, in which single cells can be changed."""

    def __init__(self, path: Path, names: Mapping[str, str] | None = None) -> None:
        data = path.read_bytes()
        self.encoding, self.mark = encoding_of(path, data)
        # Every byte returns, even one that the encoding lacks.
        text = data[len(self.mark) :].decode(self.encoding, "surrogateescape")
        self.delimiter = max(",;\t", key=text.split("\n", 1)[0].count)
        self.lines = _split(text, self.delimiter)
        if len(self.lines) < 2:
            raise CannotExport(f"The gradebook {path} has no students.")
        self.header = [field.says.strip() for field in self.lines[0][0]]
        known, self.no = in_english(self.header)
        self.ours = known | {
            theirs.casefold(): ours.casefold() for ours, theirs in (names or {}).items()
        }
        there = {name.casefold() for name in self.header}
        unknown = [theirs for theirs in (names or {}).values() if theirs.casefold() not in there]
        if unknown:
            raise CannotExport(
                f"There is no column {unknown[0]!r}. The columns are "
                f"{', '.join(map(repr, self.header))}."
            )

    def column(self, *names: str) -> int | None:
        """Return the index of the first column with one of these names, or ``None``."""
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
        return self.mark + text.encode(self.encoding, "surrogateescape")


def _split(text: str, delimiter: str) -> list[tuple[list[Field], str]]:
    """Split a table into lines of fields, each with its line end."""
    pattern = re.compile(
        r'("(?:[^"]|"")*"[^%s\r\n]*|[^%s\r\n]*)(%s|\r\n|\n|\r|$)' % ((re.escape(delimiter),) * 3)
    )
    lines: list[tuple[list[Field], str]] = []
    fields: list[Field] = []
    place = 0
    while place < len(text) and (match := pattern.match(text, place)):
        written, end = match.groups()
        says = (
            written[1 : written.rindex('"')].replace('""', '"')
            if written.startswith('"') and len(written) > 1
            else written
        )
        fields.append(Field(says, written))
        place = match.end()
        if end != delimiter:
            lines.append((fields, end))
            fields = []
        elif place == len(text):
            fields.append(Field("", ""))
    if fields:
        lines.append((fields, ""))
    return lines


# --- the systems --------------------------------------------------------------------------------


def place_of_filled(path: str | Path, filled: str | Path | None = None) -> Path:
    path = Path(path)
    return Path(filled) if filled else path.with_name(f"{path.stem}-filled{path.suffix}")


class System(NamedTuple):
    """The layout of a system's gradebook, with the English names of columns.

    Attributes
    ----------
    name : str
    has : tuple of tuples of str
        Alternatives, one of which is, or begins, the name of a column.
    number, own, names : tuple of str
        The columns of the system's ID of a student, of the course's own ID, and of the parts of the
        full name.
    column : str
        A pattern for the lower-case name of a column of marks.
    out_of : str
        A pattern for the maximum grade in that name.
    """

    name: str
    has: tuple[tuple[str, ...], ...]
    number: tuple[str, ...]
    own: tuple[str, ...]
    names: tuple[str, ...]
    column: str
    out_of: str = "$^"


SYSTEMS = (
    System(
        "Moodle",
        (("identifier",), ("grade",)),
        ("identifier",),
        # In a university's own table, whose columns term.toml names, it is the student's ID.
        ("id number", "username", "email address", "identifier"),
        ("full name",),
        "grade$",
    ),
    System(
        "Brightspace",
        (("orgdefinedid", "end-of-line indicator"),),
        (),
        ("orgdefinedid", "username"),
        ("first name", "last name"),
        ".*(points grade|maxpoints:)",
        r"maxpoints:\s*([\d.,]+)",
    ),
    System(
        "Blackboard",
        (("username",), ("last name",), ("availability", "last access")),
        (),
        ("username", "student id"),
        ("first name", "last name"),
        r"(?!weighted total|total).*\[total pts:.*\|\d+$",
        r"total pts:\s*(?:up to )?([\d.,]+)",
    ),
    # Canvas gives the name in one column or, on request, in two, and puts an assignment's ID after
    # its name.
    System(
        "Canvas",
        (("student", "lastname"), ("id",)),
        ("id",),
        ("sis login id", "sis user id", "integration id"),
        (),
        r".*\(\d+\)$",
    ),
)


def columns(
    path: str | Path, store: Store, assignment: str | None
) -> list[tuple[str | None, str | None]]:
    """Return the assignments that a gradebook has columns for, by the term, each with its column.

    Raises
    ------
    CannotExport
        Columns of several assignments have the same name.
    """
    term = term_of(store.folder)
    about = term.assignments
    if assignment:
        return [(assignment, about[assignment].column if assignment in about else None)]
    header = [name.casefold() for name in _read(path, term.gradebook).header]
    graded = {name for _, name in Journal(store.folder).standing().given}
    named = [
        (name, assigned.column)
        for name, assigned in about.items()
        if name in graded and assigned.column
    ]
    there = [
        (name, column)
        for name, column in named
        if any(title.startswith(column.casefold()) for title in header)
    ]
    if len({column for _, column in there}) < len(there):
        several = ", ".join(name for name, column in there)
        raise CannotExport(
            f"{several} have columns of the same name. Choose one with --assignment."
        )
    # If the system has renamed the column, filling it reports that. We never guess another.
    return [*(there or named[:1])] or [(None, None)]


def _read(path: str | Path, names: Mapping[str, str]) -> Gradebook:
    try:
        return Gradebook(Path(path), names)
    except (OSError, UnicodeDecodeError) as error:
        raise CannotExport(f"We cannot read {path}: {reason_of(error)}.") from None


#: The headings of the lists of students in the messages, in this order.
HEADINGS = {
    "changed": "Changed since our last export",
    "nothing": "In the gradebook, but handed in nothing",
    "damaged": "In the gradebook, but we graded none of their files",
    "strangers": "Handed in, but not in the gradebook",
    "missing": "Handed in nothing by the due date: 0",
    "several": "Not filled in, because the name is ambiguous",
    "waiting": "Not filled in until you decide, in `coursework review`",
    "appeals": "Filled in, but may change because of an open appeal",
    "closed": "Not filled in, because the system allows no change",
    "excused": "Not filled in, because excused in term.toml",
    "replaced": "A manually entered mark, overridden as you asked",
    "by hand": "Not filled in, because the mark there is not one that we exported",
}


def fill(
    path: str | Path,
    marks: Marks,
    column: str | None = None,
    filled: str | Path | None = None,
    overwrite: Collection[str] = (),
    dry_run: bool = False,
) -> list[str]:
    """Fill the gradebook of Canvas, Moodle, Brightspace or Blackboard.

    Parameters
    ----------
    path : path
        The gradebook, as the instructor exported it.
    marks : Marks
    column : str, optional
        The name of the column to fill, or its beginning; needed if several could be meant.
    filled : path, optional
        Where to write the filled gradebook.
    overwrite : collection of str
        Students whose manually entered mark is overwritten. An excuse, such as Canvas's ``EX``,
        never is.
    dry_run : bool
        Return what would be written, and write nothing.

    Returns
    -------
    list of str
        What was done, and which students did not match.

    Raises
    ------
    CannotExport
    """
    target = place_of_filled(path, filled)
    book = _read(path, marks.term.gradebook)
    system = _system(book)
    place = _column(book, system, column)
    out_of, first, comma = _scale(book, system, place)
    students, several = _match(book, system, marks, first)
    header, assignment = book.header[place], marks.assignment
    said = [f"{system.name}: column {header!r}, of {assignment}."]
    worths = sorted({marks.mark(student).worth for student in marks.students})
    if out_of and worths != [out_of]:
        said.append(
            f"The column is out of {number(out_of)} but the questions are worth "
            f"{', '.join(map(number, worths))}, so we scale the points."
        )
    said += marks.unknown
    if marks.behind:
        said.append(
            f"Decisions about {number_of(marks.behind, 'student')} are not in the marks yet. Run "
            f"`coursework regrade {marks.store.folder}`."
        )
    if strangers := sorted(set(overwrite) - set(students.values())):
        raise CannotExport(
            f"You asked to override the mark of {strangers[0]!r}, who is not in this gradebook."
        )
    ours = _written_before(marks, assignment, header)
    listed = {name: list[str]() for name in HEADINGS}
    now_written: dict[str, str] = {}
    for line, student in sorted(students.items()):
        there = book.says(line, place)
        if why_not := _why_not(book, system, marks, line, student):
            listed[why_not].append(f"{student}: {there} stays" if there.strip("-") else student)
            continue
        points = "0" if student in marks.missing else number(_scaled(marks, student, out_of))
        known = there in ("", "-") or any(_is_same(there, mark) for mark in ours.get(student, ()))
        if not known and not _is_same(there, points):
            if student not in overwrite or not _is_number(there):
                listed["by hand"].append(f"{student}: {there}, and graded {points}")
                continue
            listed["replaced"].append(f"{student}: {there} -> {points}")
        elif there not in ("", "-") and not _is_same(there, points):
            listed["changed"].append(f"{student}: {there} -> {points}")
        now_written[student] = points
        book.put(line, place, points.replace(".", ",") if comma else points)
    if dry_run:
        said.append(f"{number_of(len(now_written), 'mark')} would be filled in. We wrote nothing.")
    else:
        # Enter the event first, so that after a crash in between, the next run knows of everything
        # that may have been written.
        event = Exported(
            who=getpass.getuser(),
            assignment=assignment,
            column=header,
            file=str(target),
            marks=now_written,
        )
        marks.journal.append([event])
        write(target, bytes(book), private=True)
        said.append(f"{number_of(len(now_written), 'mark')} filled in: {target}")
    shown = book.column(
        "student", "lastname", "full name", "username", "orgdefinedid", "identifier"
    )
    damaged = {_signs(file.student) for file in refused_of(marks.store) if file.student}
    for line in range(first, len(book.lines)):
        cells = [field.says for field in book.lines[line][0]]
        if line not in students and any(cells):
            # A refused file may be under any name or ID of its student.
            signs = {_signs(cell) for cell in (*cells, turned(book.says(line, shown)))}
            heading = "nothing" if signs.isdisjoint(damaged) else "damaged"
            listed[heading].append(book.says(line, shown))
    listed["strangers"] = sorted(set(marks.students) - set(students.values()) - set(several))
    listed["missing"] = sorted(set(marks.missing) & set(students.values()))
    listed["several"] = several
    listed["appeals"] = [
        f"{student}: {', '.join(open_ones)}"
        for student in marks.students
        if (open_ones := marks.appeals(student))
    ]
    for name, those in listed.items():
        if those:
            said.append(f"{HEADINGS[name]} ({len(those)}):")
            said += [f"  {in_a_line(line, 200)}" for line in those]
    return said


def _written_before(marks: Marks, assignment: str, header: str) -> dict[str, list[str]]:
    """Return the marks that we wrote to a column for each student, which we may change."""
    ours: dict[str, list[str]] = {}
    for event in marks.journal.events:
        if isinstance(event, Exported) and (event.assignment, event.column) == (assignment, header):
            for student, points in event.marks.items():
                ours.setdefault(student, []).append(points)
    return ours


def _why_not(book: Gradebook, system: System, marks: Marks, line: int, student: str) -> str:
    """Return why a student's cell is not filled, as the key of a heading, or an empty string."""
    if student in marks.in_state(DAMAGED):
        return "damaged"
    if student in marks.in_state(EXCUSED):
        return "excused"
    if student not in marks.missing and marks.mark(student).undecided:
        return "waiting"
    may_change = book.says(line, book.column("grade can be changed"))
    if system.name == "Moodle" and may_change.casefold() == book.no:
        return "closed"
    return ""


def _scaled(marks: Marks, student: str, out_of: float | None) -> float:
    worth = marks.mark(student).worth
    return round(marks.points(student) * (out_of / worth if out_of and worth else 1), 2)


def _is_same(there: str, text: str) -> bool:
    return _is_number(there) and float(there.replace(",", ".")) == float(text)


def _is_number(there: str) -> bool:
    try:
        return math.isfinite(float(there.replace(",", ".")))
    except ValueError:
        return False


def _signs(name: str) -> str:
    return "".join(sign for sign in name.casefold() if sign.isalnum())


def _system(book: Gradebook) -> System:
    for system in SYSTEMS:
        if all(book.column(*names) is not None for names in system.has):
            return system
    needed = (
        f"{system.name} ({', '.join(' or '.join(names) for names in system.has)})"
        for system in SYSTEMS
    )
    raise CannotExport(
        f"This is not a gradebook from {', '.join(needed)}, nor a Moodle one in a supported "
        f"language ({', '.join(LANGUAGES)}). Map the columns in term.toml: "
        "[gradebook], and below it identifier = '...' and grade = '...'. "
        f"This file has the columns {', '.join(book.header)[:300]}"
    )


def _column(book: Gradebook, system: System, column: str | None) -> int:
    """Return the index of the column to fill, which has the name or else begins with it."""
    if column:
        wanted = column.casefold()
        same = [place for place, name in enumerate(book.header) if name.casefold() == wanted]
        places = same or [
            place for place, name in enumerate(book.header) if name.casefold().startswith(wanted)
        ]
    else:
        places = [
            place
            for place, name in enumerate(book.header)
            if re.match(system.column, book.ours.get(name.casefold(), name.lower()))
        ]
    if len(places) != 1:
        names = [book.header[place] for place in places] or book.header
        what = f"correct column = {column!r} in" if column else "add column = '...' to"
        raise CannotExport(
            f"In term.toml, {what} the assignment's table. The gradebook has the columns "
            f"{', '.join(map(repr, names))}."
        )
    return places[0]


def _scale(book: Gradebook, system: System, place: int) -> tuple[float | None, int, bool]:
    """Return a column's maximum, the first student's line, and whether it has decimal commas."""
    first = 1
    about = re.search(system.out_of, book.header[place].lower())
    said = about[1] if about else book.says(1, book.column("maximum grade"))
    while system.name == "Canvas" and first < len(book.lines):
        if book.says(first, 0).lower() == "points possible":
            said = book.says(first, place)
        elif book.says(first, book.column("id")):
            break
        first += 1
    # A spreadsheet writes "1,000.00" and separates fields by commas, or writes "1.000,00" and
    # separates them by semicolons.
    said = re.sub(r"(?<=\d),(?=\d{3}\b)", "", said) if book.delimiter == "," else said
    comma = bool(re.search(r"\d,\d", said)) or (book.delimiter == ";" and "." not in said)
    try:
        return float(said.replace(".", "").replace(",", ".") if comma else said), first, comma
    except ValueError:
        return None, first, comma


def _match(
    book: Gradebook, system: System, marks: Marks, first: int
) -> tuple[dict[int, str], list[str]]:
    """Return the student of each line, and students whom several lines could mean."""
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
    everybody = {
        student: marks.identity(student)
        for student in (
            *marks.students,
            *marks.missing,
            *marks.in_state(DAMAGED),
            *marks.in_state(EXCUSED),
        )
    }
    # The roster may have come from another assignment, whose participants Moodle numbers otherwise.
    anew = system.name == "Moodle" and not any(
        ("id", identity.called.get("moodle")) in lines for identity in everybody.values()
    )
    for student, identity in everybody.items():
        keys = _keys_of_student(system, student, identity, anew)
        candidates = next((lines[key] for key in keys if key in lines), set[int]())
        if len(candidates) == 1:
            wanting.setdefault(min(candidates), []).append(student)
        elif candidates:
            several.append(student)
    # Being first is no better claim, so we fill a line that two students could mean for neither.
    several += [
        student for students in wanting.values() if len(students) > 1 for student in students
    ]
    return {line: students[0] for line, students in wanting.items() if len(students) == 1}, several


def _keys_of_line(book: Gradebook, system: System, line: int) -> set[tuple[str, str]]:
    def of(name: str) -> str:
        return book.says(line, book.column(name)).lower().removeprefix("#")

    keys = {("own", of(name)) for name in system.own}
    keys.add(("name", " ".join(" ".join(map(of, system.names)).split())))
    # Drop the word for a participant before the ID, in any language, as in "Teilnehmer/in9".
    keys |= {("id", re.sub(r"\D", "", of(name))) for name in system.number}
    return {key for key in keys if key[1]}


def _keys_of_student(
    system: System, student: str, identity: Identity, numbered_anew: bool
) -> Iterator[tuple[str, str]]:
    called = identity.called
    if system.number and system.name.lower() in called:
        yield "id", called[system.name.lower()]
        if not numbered_anew:
            return
    for own in identity.own or ():
        yield "own", own.lower()
    if "email" in called:
        yield "own", called["email"].lower()
    if identity == Identity():
        # The folder's name is all that we know.
        yield "own", student.lower()
    if "name" in called:
        yield "name", called["name"].lower()


def write_feedback(path: str | Path, marks: Marks, store: Store) -> str:
    """Write an archive of feedback pages, named so that the system that has the work takes it.

    A name begins with the system's part of the name of the work. Canvas reads the first two numbers
    between underscores, of the student and of the file, takes no page whose last part begins with
    "link", and ignores folders. Moodle reads the participant's ID and ``assignsubmission_file`` in
    the first folder that has them. Brightspace recognises its own folders. Return a message with
    the number of pages.

    Raises
    ------
    CannotExport
        A page is missing, or two would have the same name.
    """
    if marks.behind:
        raise CannotExport(
            f"Decisions about {number_of(marks.behind, 'record')} are not in the pages yet. Run "
            f"`coursework regrade {store.folder}`."
        )
    pages: dict[str, bytes] = {}
    for record in marks.records:
        page = store.folder / feedback_of(record.student, record.assignment)
        if not page.exists() or record.reply is None:
            raise CannotExport(f"There is no feedback for {record.student!r}. Grade again.")
        name = f"{record.reply}feedback-{file_name(record.assignment).replace('_', '-')}.html"
        if name in pages:
            raise CannotExport(
                f"Two feedback pages would have the name {name!r}, so one would replace the other. "
                "Grade again with a roster in term.toml."
            )
        pages[name] = page.read_bytes()
    write(path, zipped(pages), private=True)
    return f"{number_of(len(pages), 'page')} of feedback: {path}"


def write_nbgrader(path: str | Path, marks: Marks) -> str:
    """Write nbgrader's table of grades, and return a message about it.

    It has no mark for an answer that waits for a person.
    """
    rows, pending = [], 0
    for (student, assignment), result in sorted(marks.results.items()):
        group = marks.term.group_of(student, assignment)
        given = marks.given.get((marks.store.owner(student, assignment, group), assignment))
        if given and given.undecided:
            pending += 1
        elif given or (result.state == "missing" and result.due):
            raw = given.points - result.held_back if given else 0
            lost, score = (round(raw * part, 4) for part in (result.penalty, 1 - result.penalty))
            rows.append(
                (assignment, "", "", student, "", "", "", raw, lost, score, (given or result).worth)
            )
    write(path, table(NBGRADER, rows), private=True)
    return (
        f"{number_of(len(rows), 'mark')}: {path}. "
        f"Left out until you decide, in `coursework review`: {pending}."
    )


def write_gradescope(path: str | Path, marks: Marks, student: str) -> None:
    """Write a Gradescope autograder's results for one student."""
    # Give no status if a person has still to decide.
    status = {"undecided": {}, "correct": {"status": "passed"}, "decided": {"status": "passed"}}
    tests = [
        {
            "name": readable(mark.title, 200),
            "number": str(order),
            "score": mark.points,
            "max_score": mark.worth,
            **status.get(mark.outcome, {"status": "failed"}),
            "visibility": "visible",
            "output_format": "text",
            "output": readable("\n".join([mark.outcome, *map(plain_text, mark.messages)])),
        }
        for order, mark in enumerate(
            (mark for record in marks.students[student] for mark in record.marks.values()), start=1
        )
    ]
    results = {"score": marks.points(student), "output_format": "text", "tests": tests}
    write(path, json.dumps(results, indent=1, ensure_ascii=False) + "\n")
