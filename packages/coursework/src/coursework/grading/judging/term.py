"""A whole course: due dates, extensions, what lateness costs, what is
dropped, and what it all comes to.

The rules stand in one file that people read, such as::

    name = "Autumn 2026"
    time-zone = "Europe/Amsterdam"

    [late]
    grace-minutes = 15      # what is this late is on time
    a-day = 0.1             # each day that has begun costs this share of the points earned
    most = 0.5              # and all days together no more than this
    nothing-after-days = 7  # what is later than this earns nothing
    marked = 0.1            # what a system marks as late, and does not say when it came

    [assignments.simple-orientations]
    due = 2026-10-05T23:59:00
    weight = 2

    [assignments.unit-quaternions]
    due = 2026-10-12T23:59:00
    times = "worksheet.csv" # who handed in when, where the names of the files do not say

    [[drop]]
    lowest = 1
    of = ["simple-orientations", "unit-quaternions"]

    [extensions.jdoe]
    unit-quaternions = 2026-10-15T23:59:00  # or "excused"

A time costs points only where a system said it: that of a file on a disk is nobody's. The records
stay as they are; everything here follows from them and from that file.
"""

import datetime
import json
import math
import tomllib
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple, TypeVar
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

from ...checking.fields import text
from ..record import Record
from ..store import Store, write
from ..submissions.intake import as_time
from ..submissions.roster import Roster

Some = TypeVar("Some")
EXCUSED = "excused"
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


class BadRules(ValueError):
    """The rules of a course cannot be understood; the message says which."""


class Times(NamedTuple):
    """Who handed in when, as a system's table says."""

    roster: Roster
    times: Mapping[str, datetime.datetime]


class Assignment(NamedTuple):
    """What the rules say of an assignment."""

    due: datetime.datetime | None
    weight: float
    times: Times | None


class Rules(NamedTuple):
    """What the file says.

    Attributes
    ----------
    name : str
    zone : ZoneInfo
    grace : timedelta
    a_day, most : float
        Shares of the points earned.
    nothing_after : timedelta or None
    marked : float or None
        The share that is lost by what a system marked as late without saying when it came.
    assignments : dict of str to Assignment
    drop : list of (int, list of str)
    extensions : dict of (student, assignment) to datetime or ``"excused"``
    """

    name: str
    zone: ZoneInfo
    grace: datetime.timedelta
    a_day: float
    most: float
    nothing_after: datetime.timedelta | None
    assignments: Mapping[str, Assignment]
    drop: Sequence[tuple[int, Sequence[str]]]
    extensions: Mapping[tuple[str, str], datetime.datetime | str]
    marked: float | None = None

    @property
    def late_costs(self) -> bool:
        """Whether lateness costs anything."""
        return bool(self.a_day) or self.nothing_after is not None

    def penalty(self, late: datetime.timedelta) -> float:
        """The share of the earned points that a delay costs.

        >>> from datetime import timedelta
        >>> rules = Rules("", None, timedelta(minutes=15), 0.1, 0.5, timedelta(days=7), {}, [], {})
        >>> late = [timedelta(hours=hours) for hours in (-1, 0.2, 1, 25, 167, 169)]
        >>> [round(rules.penalty(delay), 2) for delay in late]
        [0.0, 0.0, 0.1, 0.2, 0.5, 1.0]
        """
        if late <= self.grace:
            return 0.0
        if self.nothing_after is not None and late > self.nothing_after:
            return 1.0
        return min(self.most, self.a_day * math.ceil(late / DAY))


def read_rules(path: str | Path) -> Rules:
    """Read the rules of a course.

    Raises
    ------
    BadRules
        Something in it is misspelt, or is no time, share or name of what it should be.
    """
    path = Path(path)
    try:
        said: dict[str, object] = tomllib.loads(path.read_text("utf8"))
    except (OSError, ValueError) as error:
        raise BadRules(f"{path}: {error}") from None
    _demand(path, "", said, {"name", "time-zone", "late", "assignments", "drop", "extensions"})
    if "time-zone" not in said:
        raise BadRules(f"{path}: time-zone is missing, such as time-zone = 'Europe/Amsterdam'.")
    try:
        zone = ZoneInfo(str(said["time-zone"]))
    except (ZoneInfoNotFoundError, ValueError):
        raise BadRules(f"{path}: there is no time zone {said['time-zone']!r}.") from None
    late = _table(path, "late", said.get("late", {}))
    _demand(path, "late", late, {"grace-minutes", "a-day", "most", "nothing-after-days", "marked"})
    shares = {
        name: _number(path, f"late.{name}", late.get(name, default), 1)
        for name, default in LATE.items()
    }
    nothing_after = late.get("nothing-after-days")
    assignments = {}
    for name, about in _table(path, "assignments", said.get("assignments", {})).items():
        where = f"assignments.{name}"
        rules = _table(path, where, about)
        _demand(path, where, rules, {"due", "weight", "times"})
        due = _moment(path, f"{where}.due", rules["due"], zone) if "due" in rules else None
        weight = _number(path, f"{where}.weight", rules.get("weight", 1))
        file = (
            _of(str, "the name of a table", path, f"{where}.times", rules["times"])
            if "times" in rules
            else ""
        )
        assignments[name] = Assignment(
            due, weight, _times(path.parent / file, zone) if file else None
        )
    if not assignments:
        raise BadRules(f"{path}: it names no assignment, such as [assignments.unit-quaternions].")
    drop = []
    for rule in _of(list, "a list of tables", path, "drop", said.get("drop", [])):
        about_drop = _table(path, "drop", rule)
        _demand(path, "drop", about_drop, {"lowest", "of"})
        of = _of(
            list, "a list of assignments", path, "drop.of", about_drop.get("of", list(assignments))
        )
        _known(path, "drop.of", of, assignments)
        lowest = about_drop.get("lowest", 1)
        if type(lowest) is not int or not 0 <= lowest < len(of):
            raise BadRules(
                f"{path}: drop.lowest is a whole number below {len(of)}, and this is {lowest!r}."
            )
        drop.append((lowest, of))
    if len({name for _, of in drop for name in of}) < sum(len(of) for _, of in drop):
        raise BadRules(f"{path}: an assignment is in two rules of what is dropped.")
    extensions: dict[tuple[str, str], datetime.datetime | str] = {}
    for student, until in _table(path, "extensions", said.get("extensions", {})).items():
        where = f"extensions.{student}"
        own = _table(path, where, until)
        _known(path, where, own, assignments)
        for name, when in own.items():
            extensions[student, name] = (
                EXCUSED if when == EXCUSED else _moment(path, f"{where}.{name}", when, zone)
            )
    return Rules(
        str(said.get("name", path.stem)),
        zone,
        datetime.timedelta(
            minutes=_number(path, "late.grace-minutes", late.get("grace-minutes", 0))
        ),
        shares["a-day"],
        shares["most"],
        None
        if nothing_after is None
        else datetime.timedelta(days=_number(path, "late.nothing-after-days", nothing_after)),
        assignments,
        drop,
        extensions,
        _number(path, "late.marked", late["marked"], 1) if "marked" in late else None,
    )


LATE = {"a-day": 0, "most": 1}
#: Where it is kept which file the rules of the term are in.
KEPT = "rules.json"


def keep_rules(store: Store, path: str | Path) -> None:
    """Keep where the rules of the term are: marks are not handed on without them unsaid."""
    write(store.folder / KEPT, json.dumps(str(path)))


def rules_of(store: Store) -> str | None:
    """The file with the rules by which the term was put together last; ``None`` if it was not."""
    return store.said(KEPT, text)


def _of(kind: type[Some], what: str, path: Path, where: str, value: object) -> Some:
    if not isinstance(value, kind):
        raise BadRules(f"{path}: {where} is {what}, and this is {value!r}.")
    return value


def _table(path: Path, where: str, value: object) -> dict[str, object]:
    return _of(dict, "a table", path, where, value)


def _demand(path: Path, where: str, table: Mapping[str, object], names: Collection[str]) -> None:
    for name in table:
        if name not in names:
            there = f" in {where}" if where else ""
            raise BadRules(
                f"{path}: what is {name!r}{there}? There are {', '.join(sorted(names))}."
            )


def _known(
    path: Path, where: str, names: Iterable[str], assignments: Mapping[str, Assignment]
) -> None:
    for name in names:
        if name not in assignments:
            raise BadRules(
                f"{path}: {where}: there is no assignment {name!r}; there are "
                f"{', '.join(assignments)}."
            )


def _number(path: Path, where: str, value: object, most: float = math.inf) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0 <= value <= most:
        upper = f" to {most}" if most < math.inf else " upwards"
        raise BadRules(f"{path}: {where} is a number from 0{upper}, and this is {value!r}.")
    return value


def _moment(path: Path, where: str, value: object, zone: ZoneInfo) -> datetime.datetime:
    if not isinstance(value, datetime.datetime):
        raise BadRules(
            f"{path}: {where} is a date with a time, such as 2026-10-05T23:59:00, and this is "
            f"{value.isoformat() if isinstance(value, datetime.date) else repr(value)}."
        )
    return in_zone(value, zone)


def in_zone(moment: datetime.datetime, zone: ZoneInfo, later: bool = True) -> datetime.datetime:
    """A moment with its time zone; of an hour that a clock shows twice, or leaves
    out, the later or the earlier one.
    """
    if moment.tzinfo:
        return moment
    both = [moment.replace(tzinfo=zone, fold=fold) for fold in (0, 1)]
    return (max if later else min)(both, key=lambda one: one.astimezone(datetime.UTC))


def delay(
    handed_in: datetime.datetime, due: datetime.datetime, zone: ZoneInfo
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


def _times(path: Path, zone: ZoneInfo) -> Times:
    """Read a system's table."""
    found: dict[str, datetime.datetime] = {}
    roster = Roster(path)
    for student, person in roster.people.items():
        row = person.row
        column = next((name for name in TIMES if name in row), None)
        if column is None:
            raise BadRules(
                f"{path}: no column says when something was handed in; it may be called "
                f"{', '.join(TIMES)}."
            )
        if row[column] in ("", "-"):
            continue
        when = as_time(row[column])
        if when is None:
            raise BadRules(
                f"{path}: {student!r}: {row[column]!r} is no time that can be read. "
                "Write such as 2026-10-06 20:01, or download the table with your system in "
                "English."
            )
        found[student] = in_zone(datetime.datetime.fromisoformat(when), zone, later=False)
    return Times(roster, found)


# --- what it comes to ---------------------------------------------------------------------------


class Result(NamedTuple):
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
    rules: Rules,
    worth: Mapping[str, float],
    now: datetime.datetime,
) -> tuple[list[Result], float | None]:
    """What each assignment of the rules comes to for a student, and the
    share of everything that counts.

    Parameters
    ----------
    student : str
    records : dict
        The student's records, by assignment.
    rules : Rules
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
        _result(student, name, records.get(name), rules, worth, now) for name in rules.assignments
    ]
    dropped = _dropped(results, rules)
    results = [
        one._replace(state="dropped") if one.assignment in dropped else one for one in results
    ]
    return results, _mean([one for one in results if one.state in ("counted", "missing")], rules)


def _result(
    student: str,
    name: str,
    record: Record | None,
    rules: Rules,
    worth: Mapping[str, float],
    now: datetime.datetime,
) -> Result:
    about = rules.assignments[name]
    extension = rules.extensions.get((student, name))
    due = extension if isinstance(extension, datetime.datetime) else about.due
    state, points, late, penalty, when = "counted", 0.0, False, 0.0, None
    if record is None:
        state = "not due" if name not in worth or (due is not None and now <= due) else "missing"
    else:
        points, when = record.points, _handed_in(student, record, about, rules.zone)
        if when is None:
            late = any(notebook.late for notebook in record.notebooks) and extension is None
            penalty = (rules.marked or 0.0) if late else 0.0
        elif due is not None:
            delayed = delay(when, due, rules.zone)
            penalty, late = rules.penalty(delayed), delayed > rules.grace
    if extension == EXCUSED:
        state, late, penalty = EXCUSED, False, 0.0
    full = record.worth if record else worth.get(name, 0)
    return Result(
        name, state, points, full, due, when, late, penalty, record.undecided if record else 0
    )


def say_what_marked_costs(assignments: Sequence[str]) -> str:
    """What is to be decided where a system marked work as late, and
    rules do not say what that costs.
    """
    names = ", ".join(sorted(set(assignments)))
    return (
        f"Of {names}, {len(assignments)} are marked as late by the system, which does not say when "
        "they came, and so far that costs nothing. "
        "Say what it costs: marked = 0.1 in [late], or 0; or name a table of times."
    )


def _handed_in(
    student: str, record: Record, about: Assignment, zone: ZoneInfo
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


def _mean(results: Iterable[Result], rules: Rules) -> float | None:
    weight = sum(rules.assignments[one.assignment].weight for one in results)
    return (
        sum(rules.assignments[one.assignment].weight * one.share for one in results) / weight
        if weight
        else None
    )


def _dropped(results: Iterable[Result], rules: Rules) -> set[str]:
    """The assignments whose absence is best for the student.

    With weights these need not be those of the lowest shares: against the mean m that is reached,
    an assignment contributes weight (share - m), and the least of these are left out, until m does
    not change (Dinkelbach 1967).
    """
    counted = {one.assignment: one for one in results if one.state in ("counted", "missing")}

    def mean_without(names: Collection[str]) -> float | None:
        return _mean([one for name, one in counted.items() if name not in names], rules)

    left_out: set[str] | None = None
    mean = mean_without(())
    while mean is not None:
        worst: set[str] = set()
        for lowest, of in rules.drop:
            mine = sorted(
                (rules.assignments[name].weight * (counted[name].share - mean), name)
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
