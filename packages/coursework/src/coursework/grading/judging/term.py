"""The term: who is in the course, what is due when, and which rules hold for all.

It stands in one file that people read, ``term.toml`` in the folder of marks;
``coursework term new`` writes it with every choice explained. A time costs points only where a
system said it: that of a file on a disk is nobody's.
"""

import datetime
import json
import math
import os
import re
import tomllib
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple, TypeVar
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

from ..record import Record
from ..submissions.intake import Notebook, as_time
from ..submissions.roster import Roster
from .laboratory import Policies

FILE = "term.toml"
Some = TypeVar("Some")
EXCUSED = "excused"
#: Which of several attempts counts; never one that answers nothing where another answers something.
IN_TIME, BEST, LAST = "newest in time", "best", "last"
#: What tables of systems call the time at which something was handed in.
TIMES = (
    "last modified (submission)",
    "timestamp",
    "handed in",
    "submitted at",
    "submission date",
    "submission time",
)
DAY = datetime.timedelta(days=1)


class BadTerm(ValueError):
    """The file of the term cannot be understood; the message says which line."""


class Times(NamedTuple):
    """Who handed in when, as a system's table says."""

    roster: Roster
    times: Mapping[str, datetime.datetime]


@dataclass(frozen=True)
class Assignment:
    """What the term says of an assignment.

    Attributes
    ----------
    notebooks : tuple of str
        Of which it consists.
    opens, due : datetime or None
    weight : float
    column : str
        Of the system's gradebook, or how its name begins.
    times : Times or None
    """

    notebooks: tuple[str, ...] = ()
    opens: datetime.datetime | None = None
    due: datetime.datetime | None = None
    weight: float = 1
    column: str = ""
    times: Times | None = None


@dataclass(frozen=True)
class Term:
    """What the file says; without one nothing is due, and nobody is known.

    Attributes
    ----------
    name : str
    zone : tzinfo
    roster : Roster or None
    attempts : str
    grace : timedelta
    a_day, most : float
        Shares of the points earned.
    nothing_after : timedelta or None
    marked : float or None
        The share that is lost by what a system marked as late without saying when it came.
    assignments : dict of str to Assignment
    drop : list of (int, list of str)
    groups : dict of str to tuple of str
        The members of each.
    longer : dict of str to float
        By how much the time of a student is longer.
    extensions : dict of (student, assignment) to datetime or ``"excused"``
    policies : Policies
    """

    name: str = "The course"
    zone: datetime.tzinfo = datetime.UTC
    roster: Roster | None = None
    attempts: str = IN_TIME
    grace: datetime.timedelta = datetime.timedelta()
    a_day: float = 0
    most: float = 1
    nothing_after: datetime.timedelta | None = None
    marked: float | None = None
    assignments: Mapping[str, Assignment] = field(default_factory=dict)
    drop: Sequence[tuple[int, Sequence[str]]] = ()
    groups: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    longer: Mapping[str, float] = field(default_factory=dict)
    extensions: Mapping[tuple[str, str], datetime.datetime | str] = field(default_factory=dict)
    policies: Policies = Policies()

    @property
    def late_costs(self) -> bool:
        """Whether lateness costs anything."""
        return bool(self.a_day) or self.nothing_after is not None

    def penalty(self, late: datetime.timedelta) -> float:
        """The share of the earned points that a delay costs.

        >>> from datetime import timedelta
        >>> term = Term(grace=timedelta(minutes=15), a_day=0.1, most=0.5,
        ...             nothing_after=timedelta(days=7))
        >>> late = [timedelta(hours=hours) for hours in (-1, 0.2, 1, 25, 167, 169)]
        >>> [round(term.penalty(delay), 2) for delay in late]
        [0.0, 0.0, 0.1, 0.2, 0.5, 1.0]
        """
        if late <= self.grace:
            return 0.0
        if self.nothing_after is not None and late > self.nothing_after:
            return 1.0
        return min(self.most, self.a_day * math.ceil(late / DAY))

    def group_of(self, student: str) -> str:
        """The group that a student works in, or the student."""
        return next((name for name, members in self.groups.items() if student in members), student)

    def members(self, name: str) -> tuple[str, ...]:
        """The students of a group, or the one student."""
        return self.groups.get(name, (name,))

    def due(self, student: str, name: str) -> datetime.datetime | None:
        """When an assignment is due for a student, or for the
        member of a group who has most time.
        """
        about = self.assignments.get(name, Assignment())
        dues = []
        for member in self.members(student):
            extension = self.extensions.get((member, name))
            longer = self.longer.get(member, 1)
            if isinstance(extension, datetime.datetime):
                dues.append(extension)
            elif about.due is not None:
                # Adding nothing would choose the first of an hour that a clock shows twice.
                more = (about.due - about.opens) * (longer - 1) if about.opens else None
                dues.append(about.due + more if more else about.due)
        return max(dues, default=None)

    def is_excused(self, student: str, name: str) -> bool:
        return self.extensions.get((student, name)) == EXCUSED

    def is_late(self, student: str, name: str, notebook: Notebook) -> bool:
        """Whether a system says of an attempt that it came late."""
        due = self.due(student, name)
        if notebook.handed_in and due:
            when = in_zone(datetime.datetime.fromisoformat(notebook.handed_in), self.zone, False)
            return delay(when, due, self.zone) > self.grace
        return notebook.late

    def demand_people(self, path: Path, students: Collection[str]) -> None:
        """Refuse what is for nobody, such as an extension for a misspelt name.

        Raises
        ------
        BadTerm
        """
        file = _File(path)
        groups = [member for members in self.groups.values() for member in members]
        for where, names in (
            ("extensions", [*dict(self.extensions), *((name, "") for name in self.longer)]),
            ("groups", [(name, "") for name in groups]),
        ):
            for student, _ in names:
                if student not in students:
                    raise file.bad(
                        f"{where}.{student}" if where == "extensions" else student,
                        f"{where} name {student!r}, and nobody in the course is called so.",
                    )


class _File:
    """The file, and where in it something stands."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.text = path.read_text("utf8") if path.exists() else ""

    def bad(self, where: str, said: str) -> BadTerm:
        """An error on what stands at a place, such as ``late.a-day``."""
        section, _, key = where.rpartition(".")
        now, number = "", 0
        for line_number, line in enumerate(self.text.splitlines(), 1):
            if found := re.match(r"\s*\[+\s*([^]]*?)\s*\]", line):
                now = found[1].replace('"', "").replace(" ", "")
                if now == where:
                    number = number or line_number
            elif now == section and re.match(rf"\s*[\"']?{re.escape(key)}[\"']?\s*=", line):
                number = line_number
            elif not number and f'"{where}"' in line:
                number = line_number
        return BadTerm(f"{self.path}{f', line {number}' if number else ''}: {said}")

    def of(self, kind: type[Some], what: str, where: str, value: object) -> Some:
        if not isinstance(value, kind) or isinstance(value, bool):
            raise self.bad(where, f"{where} is {what}, and this is {value!r}.")
        return value

    def table(self, where: str, value: object, names: Collection[str] = ()) -> dict[str, object]:
        """A table; one that has no other ``names``, if any are given."""
        table = self.of(dict, "a table", where, value)
        for name in table:
            if names and name not in names:
                there = f" in {where}" if where else ""
                place = f"{where}.{name}".strip(".")
                known = ", ".join(sorted(names))
                raise self.bad(place, f"what is {name!r}{there}? There are {known}.")
        return table

    def texts(self, where: str, value: object, known: Collection[str] = ()) -> tuple[str, ...]:
        """A list of names, which are ``known`` where these are given."""
        listed = self.of(list, "a list", where, value)
        names = tuple(self.of(str, "a name", where, name) for name in listed)
        for name in names:
            if known and name not in known:
                there = ", ".join(known)
                raise self.bad(where, f"{where}: there is no {name!r}; there are {there}.")
        return names

    def number(self, where: str, value: object, most: float = math.inf) -> float:
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0 <= value <= most:
            upper = f" to {most}" if most < math.inf else " upwards"
            raise self.bad(where, f"{where} is a number from 0{upper}, and this is {value!r}.")
        return value

    def moment(self, where: str, value: object, zone: datetime.tzinfo) -> datetime.datetime:
        if not isinstance(value, datetime.datetime):
            shown = value.isoformat() if isinstance(value, datetime.date) else repr(value)
            raise self.bad(
                where,
                f"{where} is a date with a time, such as 2026-10-05T23:59:00, and this is {shown}.",
            )
        return in_zone(value, zone)


def term_of(folder: str | Path) -> Term:
    """The term of a folder of marks; an empty one if it has no file.

    Raises
    ------
    BadTerm
    """
    path = Path(folder, FILE)
    return read_term(path) if path.exists() else Term()


NEW = """\
# The term: who is in the course, what is due when, and the rules that hold for all. Every command
# reads this file. A line that begins with # says nothing; take the sign away to choose.

name = {name}
time-zone = {zone}  # in which the times below are meant

# Who is in the course: your own table with a column student, or the gradebook that your system
# exports. Without one, students are called as their folders are.
{roster}

# Which of several attempts counts: "newest in time" (a late one only if none came in time), "last",
# or "best" (all are graded; the one with the most points, lateness included). One that answers
# nothing never counts where another answers something.
attempts = "newest in time"

[late]
# grace-minutes = 15      # what is this late is on time
# a-day = 0.1             # each day that has begun costs this share of the points earned
# most = 0.5              # and all days together no more than this
# nothing-after-days = 7  # what is later than this earns nothing
# marked = 0.1            # what a system marks as late without saying when it came
{assignments}
# The lowest of these does not count for the course:
# [[drop]]
# lowest = 1
# of = [{names}]

# One hand-in for several, whose folder is called by the group or by one of them:
# [groups]
# team-1 = ["ada", "ben"]

# More time, for one assignment or for all; or "excused":
# [extensions.ada]
# {first} = 2026-10-15T23:59:00
# time = 1.5              # half as much again, of the time from opens until due

# What a mended question may do to marks that were given; see `coursework regrade --dry-run`:
[regrading]
# never-lower = ["{first}/question"]            # nobody loses by it
# full-credit = ["{first}/question@taken-out"]  # all who had a variant that is gone; without @, all
# void = ["{first}/question"]                   # it counts for nobody
"""
NEW_ASSIGNMENT = """
[assignments.{name}]
# opens = 2026-09-28T08:00:00
# due = 2026-10-05T23:59:00
# weight = 1              # in the total of the course
# column = "{title}"      # of the gradebook that your system exports, or how its name begins
# times = "worksheet.csv" # who handed in when, where the names of the files do not say
# notebooks = ["{plain}"] # if it consists of others, or of several
"""


def new_term(folder: str | Path, sources: Path, roster: str | None, dry_run: bool = False) -> str:
    """Write the file of a term for the notebooks with solutions that there are; say so.

    Raises
    ------
    BadTerm
        There is one already.
    """
    path = Path(folder, FILE)
    if path.exists():
        raise BadTerm(f"{path} is there already.")
    names = [source.stem for source in sorted(sources.glob("*.ipynb"))]
    if not names:
        raise BadTerm(f"There is no notebook with solutions in {sources}.")
    place = os.path.relpath(roster, folder) if roster else ""
    _, _, zone = os.path.realpath("/etc/localtime").partition("zoneinfo/")
    text = NEW.format(
        name=json.dumps(Path(folder).resolve().parent.name),
        zone=json.dumps(zone or "UTC"),
        roster=f"roster = {json.dumps(place)}" if roster else '# roster = "gradebook.csv"',
        assignments="".join(
            NEW_ASSIGNMENT.format(
                name=name if re.fullmatch(r"[\w-]+", name, re.A) else json.dumps(name),
                plain=name,
                title=name.replace("-", " ").capitalize(),
            )
            for name in names
        ),
        names=", ".join(map(json.dumps, names)),
        first=names[0],
    )
    if not dry_run:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        path.write_text(text, "utf8")
        read_term(path)
    return text if dry_run else f"{path}: read it, and choose."


KEYS = {
    "": {"name", "time-zone", "roster", "attempts", "late", "assignments", "drop", "groups",
         "extensions", "regrading"},
    "late": {"grace-minutes", "a-day", "most", "nothing-after-days", "marked"},
    "assignment": {"notebooks", "opens", "due", "weight", "column", "times"},
    "regrading": {"never-lower", "full-credit", "void"},
}  # fmt: skip


def read_term(path: str | Path) -> Term:
    """Read the file of a term.

    Raises
    ------
    BadTerm, BadRoster
        Something in it is misspelt, or is no time, share or name of what it should be.
    """
    path = Path(path)
    try:
        text = path.read_text("utf8")
        said: dict[str, object] = tomllib.loads(text)
    except (OSError, ValueError) as error:
        raise BadTerm(f"{path}: {error}") from None
    file = _File(path)
    file.table("", said, KEYS[""])
    if "time-zone" not in said:
        raise file.bad("", "time-zone is missing, such as time-zone = 'Europe/Amsterdam'.")
    try:
        zone = ZoneInfo(str(said["time-zone"]))
    except (ZoneInfoNotFoundError, ValueError):
        raise file.bad("time-zone", f"there is no time zone {said['time-zone']!r}.") from None
    assignments = {
        name: _assignment(file, f"assignments.{name}", about, zone)
        for name, about in file.table("assignments", said.get("assignments", {})).items()
    }
    if not assignments:
        raise file.bad("assignments", "it names no assignment, such as [assignments.hw1].")
    attempts = said.get("attempts", IN_TIME)
    if attempts not in (IN_TIME, BEST, LAST):
        known = f"{IN_TIME!r}, {BEST!r} or {LAST!r}"
        raise file.bad("attempts", f"attempts are {known}, not {attempts!r}.")
    late = file.table("late", said.get("late", {}), KEYS["late"])

    def share(name: str, default: float, most: float = 1) -> float:
        return file.number(f"late.{name}", late.get(name, default), most)

    days = "nothing-after-days"
    longer, extensions = _extensions(file, said, assignments, zone)
    regrading = file.table("regrading", said.get("regrading", {}), KEYS["regrading"])
    groups = _groups(file, said)
    roster = file.of(str, "the name of a table", "roster", said.get("roster", ""))
    return Term(
        name=str(said.get("name", path.parent.name)),
        zone=zone,
        roster=Roster(path.parent / roster, groups) if roster else None,
        attempts=attempts,
        grace=datetime.timedelta(minutes=share("grace-minutes", 0, math.inf)),
        a_day=share("a-day", 0),
        most=share("most", 1),
        nothing_after=datetime.timedelta(days=share(days, 0, math.inf)) if days in late else None,
        marked=share("marked", 0) if "marked" in late else None,
        assignments=assignments,
        drop=_drop(file, said, list(assignments)),
        groups=groups,
        longer=longer,
        extensions=extensions,
        policies=Policies(
            **{
                name.replace("-", "_"): file.texts(f"regrading.{name}", questions)
                for name, questions in regrading.items()
            }
        ),
    )


def _assignment(file: _File, where: str, about: object, zone: datetime.tzinfo) -> Assignment:
    rules = file.table(where, about, KEYS["assignment"])

    def text(name: str) -> str:
        return file.of(str, "a text", f"{where}.{name}", rules.get(name, ""))

    moments = {
        name: file.moment(f"{where}.{name}", rules[name], zone)
        for name in ("opens", "due")
        if name in rules
    }
    if len(moments) == 2 and moments["opens"] >= moments["due"]:
        raise file.bad(f"{where}.opens", f"{where} is due before it opens.")
    return Assignment(
        notebooks=file.texts(f"{where}.notebooks", rules.get("notebooks", []))
        or (where.partition(".")[2],),
        **moments,
        weight=file.number(f"{where}.weight", rules.get("weight", 1)),
        column=text("column"),
        times=_times(file.path.parent / text("times"), zone) if "times" in rules else None,
    )


def _drop(
    file: _File, said: Mapping[str, object], assignments: Sequence[str]
) -> list[tuple[int, Sequence[str]]]:
    drop: list[tuple[int, Sequence[str]]] = []
    for rule in file.of(list, "a list of tables", "drop", said.get("drop", [])):
        about = file.table("drop", rule, {"lowest", "of"})
        of = file.texts("drop.of", about.get("of", list(assignments)), assignments)
        lowest = about.get("lowest", 1)
        if type(lowest) is not int or not 0 <= lowest < len(of):
            raise file.bad(
                "drop.lowest",
                f"drop.lowest is a whole number below {len(of)}, and this is {lowest!r}.",
            )
        drop.append((lowest, of))
    if len({name for _, of in drop for name in of}) < sum(len(of) for _, of in drop):
        raise file.bad("drop", "an assignment is in two rules of what is dropped.")
    return drop


def _groups(file: _File, said: Mapping[str, object]) -> dict[str, tuple[str, ...]]:
    groups = {
        name: file.texts(f"groups.{name}", members)
        for name, members in file.table("groups", said.get("groups", {})).items()
    }
    for name, members in groups.items():
        for member in members:
            both = [other for other, those in groups.items() if member in those]
            if len(both) > 1 or member in groups:
                raise file.bad(f"groups.{name}", f"{member!r} is in {' and in '.join(both)}.")
    return groups


def _extensions(
    file: _File,
    said: Mapping[str, object],
    assignments: Mapping[str, Assignment],
    zone: datetime.tzinfo,
) -> tuple[dict[str, float], dict[tuple[str, str], datetime.datetime | str]]:
    longer: dict[str, float] = {}
    found: dict[tuple[str, str], datetime.datetime | str] = {}
    for student, until in file.table("extensions", said.get("extensions", {})).items():
        where = f"extensions.{student}"
        for name, when in file.table(where, until, {"time", *assignments}).items():
            if name == "time":
                longer[student] = file.number(f"{where}.time", when)
                without = [name for name, one in assignments.items() if one.due and not one.opens]
                if longer[student] < 1 or without:
                    raise file.bad(
                        f"{where}.time",
                        f"time = 1.5 is half as much again, from when an assignment opens until it "
                        f"is due: {', '.join(without) or 'this'} has no such time.",
                    )
            else:
                found[student, name] = (
                    EXCUSED if when == EXCUSED else file.moment(f"{where}.{name}", when, zone)
                )
    return longer, found


def in_zone(
    moment: datetime.datetime, zone: datetime.tzinfo, later: bool = True
) -> datetime.datetime:
    """A moment with its time zone; of an hour that a clock shows twice, or leaves
    out, the later or the earlier one.
    """
    if moment.tzinfo:
        return moment
    both = [moment.replace(tzinfo=zone, fold=fold) for fold in (0, 1)]
    return (max if later else min)(both, key=lambda one: one.astimezone(datetime.UTC))


def delay(
    handed_in: datetime.datetime, due: datetime.datetime, zone: datetime.tzinfo
) -> datetime.timedelta:
    """How late something was handed in.

    By the time that went by, and by the clocks of the course where these show less: in a night in
    which they are set back, a day is as long as any other, so that it is the same whether a system
    says its time in UTC or not.

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
    found: dict[str, datetime.datetime] = {}
    roster = Roster(path)
    for student, person in roster.people.items():
        row = person.row
        column = next((name for name in TIMES if name in row), None)
        if column is None:
            raise BadTerm(
                f"{path}: no column says when something was handed in; it may be called "
                f"{', '.join(TIMES)}."
            )
        if row[column] in ("", "-"):
            continue
        when = as_time(row[column])
        if when is None:
            raise BadTerm(
                f"{path}: {student!r}: {row[column]!r} is no time that can be read. "
                "Write such as 2026-10-06 20:01, or download the table with your system in "
                "English."
            )
        found[student] = in_zone(datetime.datetime.fromisoformat(when), zone, later=False)
    return Times(roster, found)


# --- what it comes to ---------------------------------------------------------------------------


@dataclass(frozen=True)
class Result:
    """What one assignment comes to for one student.

    Attributes
    ----------
    assignment : str
    state : str
        ``counted``, ``dropped``, ``excused``, ``missing`` (counted as nothing) or ``not due``.
    points, worth : float
        As graded.
    due, handed_in : datetime or None
    late : bool
        Whether it was late, or its system said so without saying when.
    penalty : float
        The share of the points that lateness cost.
    undecided : int
        How many answers wait for a person.
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

    @property
    def counts(self) -> float:
        """The points that count."""
        return self.points * (1 - self.penalty)

    @property
    def share(self) -> float:
        return self.counts / self.worth if self.worth else 0.0


def results_of(
    student: str,
    records: Mapping[str, Record],
    term: Term,
    worth: Mapping[str, float],
    now: datetime.datetime,
) -> tuple[list[Result], float | None]:
    """What each assignment of the term comes to for a student, and the
    share of everything that counts.

    Parameters
    ----------
    student : str
    records : dict
        The student's records, by assignment.
    term : Term
    worth : dict
        What each assignment is worth; for those that were not handed in.
    now : datetime
        What is due later and was not handed in is not counted yet.

    Returns
    -------
    results : list of Result
    total : float or None
        From 0 to 1; ``None`` as long as nothing counts.
    """
    results = [
        result_of(student, name, records.get(name), term, worth, now) for name in term.assignments
    ]
    dropped = _dropped(results, term)
    results = [
        replace(one, state="dropped") if one.assignment in dropped else one for one in results
    ]
    return results, _mean([one for one in results if one.state in ("counted", "missing")], term)


def result_of(
    student: str,
    name: str,
    record: Record | None,
    term: Term,
    worth: Mapping[str, float],
    now: datetime.datetime,
) -> Result:
    """What one assignment comes to for a student."""
    about, group = term.assignments.get(name, Assignment()), term.group_of(student)
    due = term.due(group, name)
    state, points, late, penalty, when = "counted", 0.0, False, 0.0, None
    if record is None:
        state = "not due" if name not in worth or (due is not None and now <= due) else "missing"
    else:
        points, when = record.points, _handed_in(student, record, about, term.zone)
        if when is None:
            extended = any((one, name) in term.extensions for one in term.members(group))
            late = record.late and not extended
            penalty = (term.marked or 0.0) if late else 0.0
        elif due is not None:
            delayed = delay(when, due, term.zone)
            penalty, late = term.penalty(delayed), delayed > term.grace
    if term.is_excused(student, name):
        state, late, penalty = EXCUSED, False, 0.0
    full = record.worth if record else worth.get(name, 0)
    return Result(
        name, state, points, full, due, when, late, penalty, record.undecided if record else 0
    )


def unknown_times(results: Iterable[Result], term: Term) -> list[str]:
    """What a person should know where nobody knows when something was handed in.

    Raises
    ------
    BadTerm
        A system marked work as late, and the term does not say what that costs.
    """
    graded = [one for one in results if one.state not in ("missing", "not due", EXCUSED)]
    unknown = [one.assignment for one in graded if one.due and not one.handed_in]
    marked = [one.assignment for one in graded if one.late and not one.handed_in]
    if marked and term.marked is None and term.late_costs:
        raise BadTerm(
            f"Of {', '.join(sorted(set(marked)))}, {len(marked)} are marked as late by the system, "
            "which does not say when they came. "
            "Say what that costs: marked = 0.1 in [late], or 0; or name a table of times."
        )
    return [
        f"{name}: of {unknown.count(name)} nobody knows when they were handed in, and lateness "
        f'cost nothing. A table of your system says it: times = "worksheet.csv" in '
        f"[assignments.{name}]."
        for name in sorted(set(unknown))
    ]


def _handed_in(
    student: str, record: Record, about: Assignment, zone: datetime.tzinfo
) -> datetime.datetime | None:
    """The latest time that a system says of the notebooks that count."""
    if about.times:
        called = record.identity.called
        keys = [
            (kind, called[kind])
            for kind in ("canvas", "moodle", "brightspace", "email", "name")
            if kind in called
        ]
        keys += [("own", own) for own in (*(record.identity.own or ()), student)]
        found, _ = about.times.roster.find(keys)
        if found is not None and found in about.times.times:
            return about.times.times[found]
    said = [notebook.handed_in for notebook in record.notebooks]
    moments = (
        in_zone(datetime.datetime.fromisoformat(one), zone, later=False) for one in said if one
    )
    return max(moments, key=lambda moment: moment.astimezone(datetime.UTC), default=None)


def _mean(results: Iterable[Result], term: Term) -> float | None:
    weight = sum(term.assignments[one.assignment].weight for one in results)
    return (
        sum(term.assignments[one.assignment].weight * one.share for one in results) / weight
        if weight
        else None
    )


def _dropped(results: Iterable[Result], term: Term) -> set[str]:
    """The assignments whose absence is best for the student.

    With weights these need not be those of the lowest shares: against the mean m that is reached,
    an assignment contributes weight (share - m), and the least of these are left out, until m does
    not change (Dinkelbach 1967).
    """
    counted = {one.assignment: one for one in results if one.state in ("counted", "missing")}

    def mean_without(names: Collection[str]) -> float | None:
        return _mean([one for name, one in counted.items() if name not in names], term)

    left_out: set[str] | None = None
    mean = mean_without(())
    while mean is not None:
        worst: set[str] = set()
        for lowest, of in term.drop:
            mine = sorted(
                (term.assignments[name].weight * (counted[name].share - mean), name)
                for name in of
                if name in counted
            )
            # Of few that count so far, one is always kept.
            worst.update(name for _, name in mine[: min(lowest, max(0, len(mine) - 1))])
        again = mean_without(worst)
        if left_out is not None and (again is None or again <= mean + 1e-12):
            break
        left_out, mean = worst, again
    return left_out or set()
