"""The term: the people in the course, the due dates, and the rules for everybody.

It is a file for people to read, ``term.toml`` in the folder of marks, which ``coursework term new``
writes with every choice explained. Lateness costs points only if a system gives the time; the time
of a file on a disk proves nothing.
"""

import datetime
import json
import math
import os
import re
import tomllib
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple, TypeVar
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

from ..reading import from_table
from ..record import Mark, Record
from ..store import write
from ..submissions.intake import Notebook, as_time
from ..submissions.roster import Roster
from ..tables import number_of, reason_of
from .journal import Part
from .laboratory import Policies

FILE = "term.toml"
Some = TypeVar("Some")
EXCUSED = "excused"
#: The state of an assignment for a student whose only file cannot be graded, until a person has
#: looked.
DAMAGED = "damaged"
#: Rules for which of several attempts counts. An empty attempt never counts if another has an
#: answer.
IN_TIME, LAST = "newest in time", "last"
#: The names of columns with the time of submission in systems' tables.
TIMES = (
    "last modified (submission)",
    "timestamp",
    "handed in",
    "submitted at",
    "submission date",
    "submission time",
)
DAY = datetime.timedelta(days=1)
#: The marks of a student's sittings, by assignment and question.
Sat = Mapping[str, Mapping[str, Mark | Part]]
#: The new due date, `EXCUSED`, or the factor by which all time is longer.
Extension = datetime.datetime | str | float


class BadTerm(ValueError):
    """An error for a term's file that cannot be understood; the message gives the line."""


class Times(NamedTuple):
    """The times at which people handed in, from a system's table."""

    roster: Roster
    times: Mapping[str, datetime.datetime]


#: The upper bound of a share.
SHARE = {"most": 1}


@dataclass(frozen=True)
class Assignment:
    """The rules for one assignment.

    Attributes
    ----------
    notebooks : tuple of str
        The notebooks of the assignment.
    opens, due : datetime or None
    weight : float
    column : str
        The column of the system's gradebook, or the beginning of its name.
    times : Times or None
    questions : tuple of str
        The questions of a sitting, which students answer on paper.
    homework_cap, homework_factor : float or None
        The limit to homework on the same questions once the sitting is marked: at most the share
        earned in the sitting plus this share of the points, or this share of what the homework
        earned.
    """

    notebooks: tuple[str, ...] = ()
    opens: datetime.datetime | None = None
    due: datetime.datetime | None = None
    weight: float = 1
    column: str = ""
    times: Times | None = None
    questions: tuple[str, ...] = ()
    homework_cap: float | None = field(default=None, metadata=SHARE)
    homework_factor: float | None = field(default=None, metadata=SHARE)

    @property
    def says(self) -> str:
        """A sentence about what a sitting does to homework on the same questions."""
        if self.homework_cap is not None:
            return (
                "Homework on these questions counts for at most the share that a student earns "
                f"here, plus {100 * self.homework_cap:g} % of the points."
            )
        if self.homework_factor is not None:
            return (
                "Once this is marked, homework on these questions counts for "
                f"{100 * self.homework_factor:g} % of its points."
            )
        return "Homework on these questions counts in full alongside it." if self.questions else ""

    def most(self, mark: Mark | Part, seen: Mark | Part) -> float:
        """Return the most points that homework on a question counts for, by the sitting's mark."""
        if seen.outcome != "decided" or not seen.worth:
            return mark.points
        if self.homework_cap is not None:
            return mark.worth * (seen.points / seen.worth + self.homework_cap)
        return mark.points * (1 if self.homework_factor is None else self.homework_factor)


@dataclass(frozen=True)
class Late:
    """The cost of lateness.

    Attributes
    ----------
    grace_minutes : float
    a_day, most : float
        Shares of the points earned.
    nothing_after_days : float or None
    marked : float or None
        The share lost by work that a system marked as late without giving a time.
    """

    grace_minutes: float = 0
    a_day: float = field(default=0, metadata=SHARE)
    most: float = field(default=1, metadata=SHARE)
    nothing_after_days: float | None = None
    marked: float | None = field(default=None, metadata=SHARE)

    @property
    def grace(self) -> datetime.timedelta:
        return datetime.timedelta(minutes=self.grace_minutes)

    @property
    def costs(self) -> bool:
        """Whether lateness costs anything."""
        return bool(self.a_day) or self.nothing_after_days is not None

    def penalty(self, late: datetime.timedelta) -> float:
        """Return the share of the earned points that a delay costs.

        >>> from datetime import timedelta
        >>> rules = Late(grace_minutes=15, a_day=0.1, most=0.5, nothing_after_days=7)
        >>> late = [timedelta(hours=hours) for hours in (-1, 0.2, 1, 25, 167, 169)]
        >>> [round(rules.penalty(delay), 2) for delay in late]
        [0.0, 0.0, 0.1, 0.2, 0.5, 1.0]
        """
        if late <= self.grace:
            return 0.0
        if self.nothing_after_days is not None and late > self.nothing_after_days * DAY:
            return 1.0
        return min(self.most, self.a_day * math.ceil(late / DAY))


@dataclass(frozen=True)
class Drop:
    """A rule by which the lowest marks of some assignments, or of all, do not count."""

    lowest: int = 1
    of: tuple[str, ...] = ()


@dataclass(frozen=True)
class Term:
    """The contents of the file, key by key. Without a file, nothing is due and nobody is known.

    Attributes
    ----------
    name : str
    time_zone : tzinfo
    roster : Roster or None
    attempts : str
    late : Late
    assignments : mapping of str to Assignment
    drop : tuple of Drop
    groups : mapping of str to tuple of str
        The members of each group.
    extensions : mapping of str to mapping
        For each student, the due date by assignment, or ``"excused"``; under ``time``, the factor
        by which all time is longer.
    regrading : Policies
    gradebook : mapping of str to str
        The columns of the system's gradebook, by their names in English.
    """

    name: str = "The course"
    time_zone: datetime.tzinfo = datetime.UTC
    roster: Roster | None = None
    attempts: str = IN_TIME
    late: Late = Late()
    assignments: Mapping[str, Assignment] = field(default_factory=dict)
    drop: tuple[Drop, ...] = ()
    groups: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    extensions: Mapping[str, Mapping[str, datetime.datetime | str | float]] = field(
        default_factory=dict
    )
    regrading: Policies = Policies()
    gradebook: Mapping[str, str] = field(default_factory=dict)

    def group_of(self, student: str, assignment: str = "") -> str:
        """Return a student's group, or the student, who works alone in a sitting."""
        if assignment in self.sittings:
            return student
        return next((name for name, members in self.groups.items() if student in members), student)

    @property
    def sittings(self) -> list[str]:
        """The assignments that students answer on paper."""
        return [name for name, about in self.assignments.items() if about.questions]

    def held_back(self, assignment: str, marks: Mapping[str, Mark | Part], sat: Sat) -> float:
        """Return the points that do not count because of the marks of the student's sittings."""
        lost = 0.0
        for question, mark in marks.items() if assignment not in self.sittings else ():
            shown = [(name, seen[question]) for name, seen in sat.items() if question in seen]
            most = [self.assignments[name].most(mark, seen) for name, seen in shown]
            lost += mark.points - min([mark.points, *most])
        return round(lost, 4)

    def members(self, name: str) -> tuple[str, ...]:
        """Return the members of a group, or the one student."""
        return self.groups.get(name, (name,))

    def due(self, student: str, name: str) -> datetime.datetime | None:
        """Return the due date of a student, or of the group's member who has most time."""
        about = self.assignments.get(name, Assignment())
        dues = []
        for member in self.members(student):
            own = self.extensions.get(member, {})
            extension, longer = own.get(name), own.get("time")
            if isinstance(extension, datetime.datetime):
                dues.append(extension)
            elif about.due is not None:
                due = about.due
                if about.opens is not None and isinstance(longer, (int, float)):
                    more = (due - about.opens) * (longer - 1)
                    # Adding zero would choose the earlier time in an hour that clocks show twice.
                    due = due + more if more else due
                dues.append(due)
        return max(dues, default=None)

    def is_excused(self, student: str, name: str) -> bool:
        return self.extensions.get(student, {}).get(name) == EXCUSED

    def is_late(self, student: str, name: str, notebook: Notebook) -> bool:
        """Check whether an attempt was late, by the system's time or its mark."""
        due = self.due(student, name)
        if notebook.handed_in and due:
            when = in_zone(
                datetime.datetime.fromisoformat(notebook.handed_in), self.time_zone, False
            )
            return delay(when, due, self.time_zone) > self.late.grace
        return notebook.late

    def demand_people(self, path: Path, students: Collection[str]) -> None:
        """Reject an entry for somebody unknown, such as an extension for a misspelt name.

        Raises
        ------
        BadTerm
        """
        named = [("extensions", f"extensions.{student}", student) for student in self.extensions]
        named += [
            ("groups", member, member) for members in self.groups.values() for member in members
        ]
        for where, place, student in named:
            if student not in students:
                said = f"{where} name {student!r}, but nobody in the course has that ID."
                raise _File(path).bad(place, said)


class _File:
    """The file, with the positions of its entries."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.text = path.read_text("utf-8-sig") if path.exists() else ""
        #: The time zone of the times in it.
        self.zone: datetime.tzinfo = datetime.UTC

    def bad(self, where: str, said: str) -> BadTerm:
        """Return an error about the entry at a place such as ``late.a-day``."""
        section, _, key = where.rpartition(".")
        now, number = "", 0
        for line_number, line in enumerate(self.text.splitlines(), 1):
            if match := re.match(r"\s*\[+\s*([^]]*?)\s*\]", line):
                now = match[1].replace('"', "").replace(" ", "")
                if now == where:
                    number = number or line_number
            elif now == section and re.match(rf"\s*[\"']?{re.escape(key)}[\"']?\s*=", line):
                number = line_number
            elif not number and f'"{where}"' in line:
                number = line_number
        return BadTerm(f"{self.path}{f', line {number}' if number else ''}: {said}")

    def leaf(self, kind: object, where: str, value: object, most: float) -> object:
        """Return a value of the term that is neither a table nor a list."""
        if kind in (str, Roster):
            return self.of(str, "a string", where, value)
        if kind is float:
            return self.number(where, value, most)
        if kind is datetime.datetime:
            return self.moment(where, value)
        if kind is datetime.tzinfo:
            return self.zone
        if kind is Times:
            return _times(self.path.parent / self.of(str, "a string", where, value), self.zone)
        return value

    def unknown(self, where: str, name: str, known: Iterable[str]) -> BadTerm:
        there = f" in {where}" if where else ""
        return self.bad(
            f"{where}.{name}".strip("."),
            f"unknown key {name!r}{there}. The keys are {', '.join(sorted(known))}.",
        )

    def of(self, kind: type[Some], what: str, where: str, value: object) -> Some:
        if not isinstance(value, kind) or isinstance(value, bool):
            raise self.bad(where, f"{where} must be {what}, not {value!r}.")
        return value

    def number(self, where: str, value: object, most: float = math.inf) -> float:
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0 <= value <= most:
            upper = f" to {most}" if most < math.inf else " upwards"
            raise self.bad(where, f"{where} must be a number from 0{upper}, not {value!r}.")
        return value

    def moment(self, where: str, value: object) -> datetime.datetime:
        if not isinstance(value, datetime.datetime):
            shown = value.isoformat() if isinstance(value, datetime.date) else repr(value)
            raise self.bad(
                where,
                f"{where} must be a date with a time, such as 2026-10-05T23:59:00, not {shown}.",
            )
        return in_zone(value, self.zone)


def term_of(folder: str | Path) -> Term:
    """Return the term of a folder of marks; an empty one if it has no file.

    Raises
    ------
    BadTerm
    """
    path = Path(folder, FILE)
    return read_term(path) if path.exists() else Term()


NEW = """\
# The term: who is in the course, what is due when, and the rules for everybody. Every command reads
# this file. A line that begins with # is a suggestion: remove the # to use it.

name = {name}
time-zone = {zone}  # of the times below

# Who is in the course: your own table with a column "student", or the gradebook that your system
# exports. Without a roster, the names of the folders are the students.
{roster}

# Which of several attempts counts: "newest in time" (a late one only if none came in time) or
# "last". A blank attempt never counts if another contains an answer.
attempts = "newest in time"

[late]
# grace-minutes = 15      # this many minutes late cost nothing
# a-day = 0.1             # share of the points deducted for each day, or part of a day
# most = 0.5              # the largest share that lateness can cost
# nothing-after-days = 7  # work later than this earns no points
# marked = 0.1            # share deducted if a system says only that work was late, not by how much
{assignments}
# A sitting: questions that students answer on paper; `coursework sitting` writes and prints one.
# [assignments.quiz]
# questions = ["{first}/question"]
# homework-cap = 0.25    # homework on these earns at most the share earned here plus this; or else:
# homework-factor = 0.5  # homework on these earns this share of its points once this is marked

# The lowest of these marks does not count for the course:
# [[drop]]
# lowest = 1
# of = [{names}]

# A group hands in once, under its own name or a member's:
# [groups]
# team-1 = ["ada", "ben"]

# More time, for one assignment or for all of them, or "excused":
# [extensions.ada]
# {first} = 2026-10-15T23:59:00
# time = 1.5              # half as much time again, from opens to due

# Which marks a corrected question may change; see `coursework regrade --dry-run`:
[regrading]
# never-lower = ["{first}/question"]            # no student loses points
# full-credit = ["{first}/question@taken-out"]  # students whose variant was removed; without @, all
# void = ["{first}/question"]                   # counts for nobody

# The columns of the gradebook, if coursework does not know its language:
# [gradebook]
# identifier = "Tunniste"
# grade = "Arvosana"
"""
NEW_ASSIGNMENT = """
[assignments.{name}]
# opens = 2026-09-28T08:00:00
# due = 2026-10-05T23:59:00
# weight = 1              # in the total of the course
# column = "{title}"      # in the gradebook that your system exports: its name, or how it begins
# times = "worksheet.csv" # when each student handed in, if the file names do not show it
# notebooks = ["{plain}"] # if the assignment has other or several notebooks
"""


def new_term(folder: str | Path, sources: Path, roster: str | None) -> str:
    """Write a term's file for the notebooks with solutions, and return a message about it.

    Raises
    ------
    BadTerm
        There is a file already.
    """
    # Only this function needs the authoring tools.
    from ...authoring.course import course_around
    from ...authoring.source import CHAPTERS

    path = Path(folder, FILE)
    if path.exists():
        raise BadTerm(f"{path} already exists.")
    names = [source.stem for source in sorted(sources.glob("*.ipynb")) if source.stem != CHAPTERS]
    if not names:
        raise BadTerm(f"There is no notebook with solutions in {sources}.")
    course = course_around(sources)
    _, _, zone = os.path.realpath("/etc/localtime").partition("zoneinfo/")
    place = _quoted(os.path.relpath(roster, folder)) if roster else ""
    assignments = "".join(
        NEW_ASSIGNMENT.format(
            name=name if re.fullmatch(r"[\w-]+", name, re.A) else _quoted(name),
            plain=name,
            title=name.replace("-", " ").capitalize(),
        )
        for name in names
    )
    text = NEW.format(
        name=_quoted(course.title if course else Path(folder).resolve().parent.name),
        zone=_quoted(zone or "UTC"),
        roster=f"roster = {place}" if roster else '# roster = "gradebook.csv"',
        assignments=assignments,
        names=", ".join(map(_quoted, names)),
        first=names[0],
    )
    # Read the roster first, so that a bad one does not leave a term that nobody can use.
    people = list(Roster(roster).people) if roster else []
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    write(path, text)
    read_term(path)
    return f"We wrote {path}. Read it, and make your choices." + (
        f" The roster has {number_of(len(people), 'student')}, with IDs such as {people[0]!r}."
        if people
        else ""
    )


def _quoted(text: str) -> str:
    """Return text as a string of TOML, which JSON's strings are, too."""
    return json.dumps(text, ensure_ascii=False)


def read_term(path: str | Path) -> Term:
    """Read the file of a term.

    Raises
    ------
    BadTerm, BadRoster
        An entry is misspelt, or not the time, share or name that it should be.
    """
    path = Path(path)
    try:
        said: dict[str, object] = tomllib.loads(path.read_text("utf-8-sig"))
    except (OSError, ValueError) as error:
        advice = "Write a date as 2026-10-05T23:59:00, and put text in quotation marks."
        if isinstance(error, FileNotFoundError):
            advice = "Create it with `coursework term new`."
        elif isinstance(error, UnicodeDecodeError):
            advice = "Save the file as UTF-8."
        elif re.search("hex value|escape", str(error)):
            advice = "Write / in paths, not a backslash."
        elif re.search("overwrite|declare", str(error)):
            advice = "Write each table and each entry only once."
        elif "end of a table declaration" in str(error):
            advice = "Put a name with a space in quotation marks: [assignments.'Week 1']."
        raise BadTerm(f"{path}: {reason_of(error)}. {advice}") from None
    file = _File(path)
    if zone := said.get("time-zone"):
        try:
            file.zone = ZoneInfo(str(zone))
        except (ZoneInfoNotFoundError, ValueError):
            raise file.bad(
                "time-zone", f"there is no time zone {zone!r}. Write one like 'Europe/Amsterdam'."
            ) from None
    term: Term = from_table(file, Term, "", {"name": path.parent.name} | said)
    if "time-zone" not in said:
        raise file.bad("", "add the time zone, such as time-zone = 'Europe/Amsterdam'.")
    if not term.assignments:
        raise file.bad(
            "assignments", "it has no assignments. Add a table such as [assignments.hw1]."
        )
    if term.attempts not in (IN_TIME, LAST):
        raise file.bad(
            "attempts", f"attempts must be {IN_TIME!r} or {LAST!r}, not {term.attempts!r}."
        )
    _demand_order(file, term)
    _demand_one_rule(file, term)
    _demand_droppable(file, term)
    _demand_members(file, term)
    extensions = {
        student: _extended(file, f"extensions.{student}", until, term)
        for student, until in term.extensions.items()
    }
    assignments = {
        name: replace(about, notebooks=about.notebooks or notebooks_of(name, about.questions))
        for name, about in term.assignments.items()
    }
    drop = tuple(replace(rule, of=rule.of or tuple(assignments)) for rule in term.drop)
    roster = Roster(path.parent / str(term.roster), term.groups) if term.roster else None
    if roster:
        term.demand_people(path, roster.people)
    return replace(term, assignments=assignments, drop=drop, extensions=extensions, roster=roster)


def notebooks_of(name: str, questions: Iterable[str]) -> tuple[str, ...]:
    """Return the notebooks of an assignment: those of a sitting's questions, or the namesake.

    >>> notebooks_of("quiz", ["levers/see-saw", "levers/plain"]), notebooks_of("levers", ())
    (('levers',), ('levers',))
    """
    return tuple(dict.fromkeys(question.partition("/")[0] for question in questions)) or (name,)


def _demand_order(file: _File, term: Term) -> None:
    for name, about in term.assignments.items():
        if about.opens and about.due and about.opens >= about.due:
            where = f"assignments.{name}"
            raise file.bad(f"{where}.opens", f"{where} is due before it opens.")


def _demand_one_rule(file: _File, term: Term) -> None:
    for name, about in term.assignments.items():
        rules = [about.homework_cap, about.homework_factor]
        if rules.count(None) == 0 or rules.count(None) == 1 and not about.questions:
            why = "is not a sitting" if not about.questions else "has both: choose one"
            raise file.bad(
                f"assignments.{name}.homework-cap",
                f"homework-cap and homework-factor are rules for a sitting, but {name} {why}.",
            )


def _demand_droppable(file: _File, term: Term) -> None:
    dropped: list[str] = []
    for rule in term.drop:
        of = rule.of or tuple(term.assignments)
        if strangers := [name for name in of if name not in term.assignments]:
            raise file.bad(
                "drop.of",
                f"drop.of: there is no assignment {strangers[0]!r}; choose from "
                f"{', '.join(term.assignments)}.",
            )
        if type(rule.lowest) is not int or not 0 <= rule.lowest < len(of):
            raise file.bad(
                "drop.lowest",
                f"drop.lowest must be a whole number below {len(of)}, not {rule.lowest!r}.",
            )
        dropped += of
    if len(set(dropped)) < len(dropped):
        raise file.bad("drop", "an assignment occurs in two [[drop]] rules.")


def _demand_members(file: _File, term: Term) -> None:
    for name, members in term.groups.items():
        for member in members:
            both = [other for other, those in term.groups.items() if member in those]
            if len(both) > 1 or member in term.groups:
                raise file.bad(f"groups.{name}", f"{member!r} is in {' and in '.join(both)}.")


def _extended(file: _File, where: str, until: object, term: Term) -> dict[str, Extension]:
    """Read a student's table of extensions."""
    table = file.of(dict, "a table", where, until)
    without = [name for name, about in term.assignments.items() if about.due and not about.opens]
    for name, when in table.items():
        place = f"{where}.{name}"
        if name == "time":
            if file.number(place, when) < 1 or without:
                raise file.bad(
                    place,
                    "time = 1.5 gives half as much time again between opening and due date, "
                    + (
                        f"but {without[0]} has no opening date."
                        if without
                        else "and time must be at least 1."
                    ),
                )
        elif name not in term.assignments:
            raise file.unknown(where, name, ["time", *term.assignments])
        elif when != EXCUSED:
            table[name] = file.moment(place, when)
    return table


def in_zone(
    moment: datetime.datetime, zone: datetime.tzinfo, later: bool = True
) -> datetime.datetime:
    """Return a moment with its time zone.

    If clocks show the hour twice or skip it, ``later`` chooses between the two readings.
    """
    if moment.tzinfo:
        return moment
    return (max if later else min)(
        [moment.replace(tzinfo=zone, fold=fold) for fold in (0, 1)],
        key=lambda reading: reading.astimezone(datetime.UTC),
    )


def delay(
    handed_in: datetime.datetime, due: datetime.datetime, zone: datetime.tzinfo
) -> datetime.timedelta:
    """Return how late something was handed in.

    This is the smaller of the elapsed time and the difference between the course's clocks. A day
    thus counts as one day even in the night in which clocks are set back, and the result is the
    same whether or not a system gives its time in UTC.

    >>> amsterdam = ZoneInfo("Europe/Amsterdam")
    >>> due = datetime.datetime(2026, 10, 24, 23, 59, tzinfo=amsterdam)
    >>> print(delay(datetime.datetime(2026, 10, 25, 22, 59, tzinfo=datetime.UTC), due, amsterdam))
    1 day, 0:00:00
    """
    by_time = handed_in.astimezone(datetime.UTC) - due.astimezone(datetime.UTC)
    by_clock = handed_in.astimezone(zone).replace(tzinfo=None) - due.astimezone(zone).replace(
        tzinfo=None
    )
    return min(by_time, by_clock)


def _times(path: Path, zone: datetime.tzinfo) -> Times:
    """Read a system's table."""
    times: dict[str, datetime.datetime] = {}
    roster = Roster(path)
    for student, person in roster.people.items():
        row = person.row
        column = next((name for name in TIMES if name in row), None)
        if column is None:
            raise BadTerm(
                f"{path}: no column gives the time of submission. It can be called "
                f"{', '.join(TIMES)}."
            )
        if row[column] in ("", "-"):
            continue
        when = as_time(row[column])
        if when is None:
            raise BadTerm(
                f"{path}: {student!r}: {row[column]!r} is not a time that we can read. Write it "
                "like 2026-10-06 20:01, or set your system to English and download the table "
                "again."
            )
        times[student] = in_zone(datetime.datetime.fromisoformat(when), zone, later=False)
    return Times(roster, times)


# --- the results --------------------------------------------------------------------------------


@dataclass(frozen=True)
class Result:
    """The result of one assignment for one student.

    Attributes
    ----------
    assignment : str
    state : str
        ``counted``, ``dropped``, ``excused``, ``missing`` (counted as zero), ``damaged`` (left out
        until a person has looked) or ``not due``.
    points, worth : float
        As graded.
    due, handed_in : datetime or None
    late : bool
        Whether it was late, or the system said so without giving a time.
    penalty : float
        The share of the points that lateness cost.
    undecided : int
        The number of answers that wait for a person.
    held_back : float
        The points that do not count, since the student did worse on the same questions in a
        sitting.
    """

    assignment: str
    state: str
    points: float
    worth: float
    due: datetime.datetime | None
    handed_in: datetime.datetime | None
    late: bool
    penalty: float
    undecided: int
    held_back: float = 0

    @property
    def counts(self) -> float:
        """The points that count."""
        return (self.points - self.held_back) * (1 - self.penalty)

    @property
    def share(self) -> float:
        return self.counts / self.worth if self.worth else 0.0


def results_of(
    student: str,
    records: Mapping[str, Record],
    term: Term,
    worth: Mapping[str, float],
    now: datetime.datetime,
    refused: Collection[str] = (),
) -> tuple[list[Result], float | None]:
    """Return a student's results in all assignments of the term, and the total share.

    Parameters
    ----------
    student : str
    records : dict
        The student's records, by assignment.
    term : Term
    worth : dict
        The points of each assignment, for those that were not handed in.
    now : datetime
        Missing work that is due after this does not count yet.
    refused : collection of str
        The students, or groups, who handed in files that cannot be graded.

    Returns
    -------
    results : list of Result
    total : float or None
        From 0 to 1; ``None`` as long as nothing counts.
    """
    sat = {name: records[name].marks for name in term.sittings if name in records}
    results = [
        result_of(student, name, records.get(name), term, worth, now, sat, refused)
        for name in term.assignments
    ]
    dropped = _dropped(results, term)
    results = [
        replace(result, state="dropped") if result.assignment in dropped else result
        for result in results
    ]
    return results, _mean(
        [result for result in results if result.state in ("counted", "missing")], term
    )


def result_of(
    student: str,
    name: str,
    record: Record | None,
    term: Term,
    worth: Mapping[str, float],
    now: datetime.datetime,
    sat: Sat | None = None,
    refused: Collection[str] = (),
) -> Result:
    """Return a student's result in one assignment, given the marks of the student's sittings.

    A student in ``refused`` without a record handed in only files that cannot be graded. We do not
    know which assignment the file was for, so every missing one stays open.
    """
    # A member of a group may have worked alone.
    group = record.student if record else term.group_of(student, name)
    due = term.due(group, name)
    state, points, late, penalty, when = "counted", 0.0, False, 0.0, None
    if record is None:
        state = "missing"
        if name not in worth or (due is not None and now <= due):
            state = "not due"
        if name in worth and not {student, group}.isdisjoint(refused):
            state = DAMAGED
    else:
        points = record.points
        about = term.assignments.get(name, Assignment())
        when = _handed_in(student, record, about, term.time_zone)
        if when is None:
            extended = any(
                name in term.extensions.get(member, {}) for member in term.members(group)
            )
            late = record.late and not extended
            penalty = (term.late.marked or 0.0) if late else 0.0
        elif due is not None:
            delayed = delay(when, due, term.time_zone)
            penalty, late = term.late.penalty(delayed), delayed > term.late.grace
        else:
            late = record.late
    if term.is_excused(student, name):
        state, late, penalty = EXCUSED, False, 0.0
    full = record.worth if record else worth.get(name, 0)
    held_back = term.held_back(name, record.marks, sat or {}) if record else 0.0
    return Result(
        name,
        state,
        points,
        full,
        due,
        when,
        late,
        penalty,
        (record.undecided if record else 0),
        held_back,
    )


def unknown_times(results: Iterable[Result], term: Term) -> list[str]:
    """Return warnings about work that came in at an unknown time.

    Raises
    ------
    BadTerm
        A system marked work as late, and the term does not say what that costs.
    """
    graded = [
        result for result in results if result.state not in ("missing", DAMAGED, "not due", EXCUSED)
    ]
    unknown = [
        result.assignment
        for result in graded
        if result.due and not (result.handed_in or result.late)
    ]
    marked = [result.assignment for result in graded if result.late and not result.handed_in]
    if marked and term.late.marked is None and term.late.costs:
        raise BadTerm(
            f"Your system marks {number_of(len(marked), 'submission')} of "
            f"{', '.join(sorted(set(marked)))} as late, without a time. Set the cost in [late], "
            "such as marked = 0.1 (or 0), or give a table of times."
        )
    return [
        f"{name}: {number_of(unknown.count(name), 'notebook')} came in at an unknown time, so "
        "lateness cost them nothing. Give a table of times from your system: "
        f'times = "worksheet.csv" in [assignments.{name}].'
        for name in sorted(set(unknown))
    ]


def _handed_in(
    student: str, record: Record, about: Assignment, zone: datetime.tzinfo
) -> datetime.datetime | None:
    """Return the latest time that a system gives for the notebooks that count."""
    if about.times:
        called = record.identity.called
        keys = [
            (kind, called[kind])
            for kind in ("canvas", "moodle", "brightspace", "email", "name")
            if kind in called
        ]
        keys += [("own", own) for own in (*(record.identity.own or ()), student)]
        known_student, _ = about.times.roster.find(keys)
        if known_student is not None and known_student in about.times.times:
            return about.times.times[known_student]
    moments = (
        in_zone(datetime.datetime.fromisoformat(moment), zone, later=False)
        for moment in [notebook.handed_in for notebook in record.notebooks]
        if moment
    )
    return max(moments, key=lambda moment: moment.astimezone(datetime.UTC), default=None)


def _mean(results: Iterable[Result], term: Term) -> float | None:
    # Exercises for practice, which are worth nothing, count for nothing.
    parts = [
        (term.assignments[result.assignment].weight, result.share)
        for result in results
        if result.worth
    ]
    total = sum(weight for weight, _ in parts)
    return sum(weight * share for weight, share in parts) / total if total else None


def _dropped(results: Iterable[Result], term: Term) -> set[str]:
    """Return the assignments whose absence is best for the student.

    With weights, these need not be those with the lowest shares. Relative to the mean m, an
    assignment contributes weight (share - m). We drop the smallest of these contributions and
    repeat until m no longer changes (Dinkelbach 1967).
    """
    counted = {
        result.assignment: result for result in results if result.state in ("counted", "missing")
    }

    def mean_without(names: Collection[str]) -> float | None:
        return _mean([result for name, result in counted.items() if name not in names], term)

    left_out: set[str] | None = None
    mean = mean_without(())
    while mean is not None:
        worst: set[str] = set()
        for rule in term.drop:
            mine = sorted(
                (term.assignments[name].weight * (counted[name].share - mean), name)
                for name in rule.of
                if name in counted
            )
            # If only a few count so far, keep at least one.
            worst.update(name for _, name in mine[: min(rule.lowest, max(0, len(mine) - 1))])
        again = mean_without(worst)
        if left_out is not None and (again is None or again <= mean + 1e-12):
            break
        left_out, mean = worst, again
    return left_out or set()
