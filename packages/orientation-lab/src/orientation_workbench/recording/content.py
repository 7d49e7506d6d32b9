"""What a recording's columns are, by their behaviour; headings are only evidence."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .table import RecordingError, Table, number_of, read_tables

if TYPE_CHECKING:
    from .table import Array, Source

#: Patterns in a heading that indicate a sensor.
HEADINGS = {
    "quaternion": r"quat|^q[0-3wxyz]?$|orientation|attitude|rotation.?vector|\bq\b",
    "angles": r"roll|pitch|yaw|euler|heading|azimuth|\balpha\b|\bbeta\b|\bgamma\b|\bphi\b|\btheta\b"
    r"|\bpsi\b|\bangle\b",
    "gravity": r"grav",
    "linear acceleration": r"^lin|user|without.?g",
    "magnetometer": r"mag(?!nitude)|field|compass|^[mbh]$",
    "gyroscope": r"gyr|angular|ang.?vel|omega|rotation.?rate|^rate|rot.?rate|^w\b|^g$|^wib",
    "accelerometer": r"acc|force|^g ?f$|^a\b|^fib|^f$",
    "something else": r"motor|servo|command|setpoint|debug|velocity|position|covar|stamp|seq|reset"
    r"|gps|^axis [pid]|bias|^b [aw]\b",
}
#: Units that indicate a sensor if the heading does not.
UNITS = {
    "gyroscope": r"rad ?/ ?s|rad s\^-1|deg ?/ ?s|°/s|dps",
    "accelerometer": r"m/s|m s\^-2|^m?g$",
    "magnetometer": r"[uµμn]t$|gauss|^m?ga?$",
}
COUNTS = r"counter|packet|index|sample(?!.*time)|frame|count$|^id$|iteration|tick"
RATE = r"(?:rate|frequency)[\W_]*([\d.]+)\s*hz"
TIME = r"time|stamp|second|^t$|^sec|^ms$|^us$|clock|counter|packet|sample|index|frame"
#: The kinds of columns that the bench can use.
PLAYED = ("accelerometer", "magnetometer", "gyroscope", "quaternion", "angles")
UNITS_OF_TIME = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "μs": 1e-6, "ns": 1e-9}
#: The magnitudes of gravity and of the Earth's field, which keep their direction, in common units.
GRAVITY = {"g": 1.0, "m/s²": 9.80665, "mg": 1000.0, "cm/s²": 980.665}
FIELD = {
    "µT": (20, 70),
    "gauss": (0.2, 0.7),
    "mG": (200, 700),
    "nT": (20e3, 70e3),
    "multiples of its length": (0.7, 1.5),
}
DEGREES = {"rad/s": 1.0, "°/s": np.pi / 180, "mrad/s": 1e-3, "m°/s": np.pi / 180e3}
#: The sensors; the first one present gives the others its clock.
SENSORS = ("gyroscope", "accelerometer", "magnetometer")


class Group(NamedTuple):
    """Columns that belong together: three of a vector or of angles, four of a quaternion.

    Attributes
    ----------
    kind : str
        What the columns are taken to be.
    called : str
        What the headings call them, or an empty string.
    names : list of str
        The headings.
    time : array of shape ``(n,)``
    values : array of shape ``(n, 3)`` or ``(n, 4)``
    """

    kind: str
    called: str
    names: list[str]
    time: Array
    values: Array


class Content(NamedTuple):
    """What a recording contains.

    Attributes
    ----------
    groups : dict
        A `Group` by its kind: gyroscope, accelerometer, magnetometer, quaternion, angles.
    clock : str
        The heading and unit of the time used, or a note that there is none.
    counted : bool
        Whether time only counts samples, so that the rate is unknown.
    remarks : list of str
    unused : list of str
        Headings of unused columns.
    temperature : pair of arrays of shape ``(n,)``
        Times and values of the first column called temperature; a single zero each if there is
        none.
    """

    groups: dict[str, Group]
    clock: str
    counted: bool
    remarks: list[str]
    unused: list[str]
    temperature: tuple[Array, Array]


def read_content(
    source: Source, name: str | None = None, rate: float | None = None, columns: str = ""
) -> Content:
    """Read a recording and find out what its columns are.

    Parameters
    ----------
    source : path, list of paths, bytes or str
        As `table.read_tables` takes it. All its tables share one clock.
    name : str, optional
    rate : float, optional
        Samples per second, if the file only counts its samples.
    columns : str
        The meaning of the columns, if the file does not give it, such as
        ``'time=1 gyroscope=2-4:deg/s accelerometer=5-7:g'``; columns count from 1.

    Returns
    -------
    Content

    Raises
    ------
    RecordingError
        If the file cannot be read, or contains no sensor.
    """
    if rate is not None and not 0 < rate < np.inf:
        raise RecordingError(
            f"the rate is {rate:g}, not a positive, finite number of samples per second"
        )
    tables = [_told(table, columns) for table in read_tables(source, name)]
    by_table: list[tuple[str, list[Group]]] = []
    clocks: list[tuple[str, bool]] = []
    unused: list[str] = []
    remarks: list[str] = []
    warmth: tuple[Array, Array] | None = None
    for table in tables:
        remarks += [
            f"{table.name}: {remark}" if len(tables) > 1 else remark for remark in table.remarks
        ]
        column, time, clock, counted = _time(table)
        clocks.append((clock, counted))
        found, left = _groups(table, column, time)
        by_table.append((f" of {table.name}" * (len(tables) > 1), found))
        unused += left
        warm = [k for k, name in enumerate(table.columns) if "temp" in name.lower()]
        if warm and warmth is None and np.isfinite(table.values[:, warm[0]]).all():
            warmth = time, table.values[:, warm[0]]
    groups = [group for _, found in by_table for group in found]
    chosen = _roles(groups)
    remarks += [
        f"{', '.join(group.names)} never change in {len(group.values)} rows"
        for group in groups
        if group.called in SENSORS and not np.ptp(group.values, axis=0).any()
    ]
    remarks += _with_gravity(chosen, groups)
    if not set(SENSORS) & set(chosen):
        raise RecordingError(_question(tables, chosen))
    played = {id(group.time) for group in chosen.values()}
    unused += [
        ", ".join(group.names) + of_table
        for of_table, found in by_table
        for group in found
        if id(group.time) not in played
    ]
    kinds = {kind: group._replace(kind=kind) for kind, group in chosen.items()}
    first = next(kinds[kind] for kind in SENSORS if kind in kinds)
    clock, counted, said = next(
        (*clock, re.search(RATE, table.head, re.IGNORECASE))
        for table, clock in zip(tables, clocks, strict=True)
        if set(first.names) <= set(table.columns)
    )
    if counted and said and not rate:
        rate = float(said[1])
        clock += f", at {rate:g} per second according to the lines above the numbers"
    # The samples of the first sensor serve as the clock.
    if counted:
        ticks = first.time
        kinds = {
            kind: group._replace(
                time=np.interp(group.time, ticks, np.arange(len(ticks))) / (rate or 1.0)
            )
            for kind, group in kinds.items()
        }
    start = min(group.time[0] for group in kinds.values())
    kinds = {kind: group._replace(time=group.time - start) for kind, group in kinds.items()}
    times, values = warmth or (np.zeros(1), np.zeros(1))
    temperature = times / (rate or 1.0 if counted else 1.0) - start, values
    return Content(kinds, clock, counted and not rate, remarks, unused, temperature)


#: An entry of the reader's description of the columns.
_TOLD = re.compile(r"(\w+)=(\d+)(?:-(\d+))?(?::(\S+))?")
#: The units that an entry may give; for other columns a unit makes no difference.
_UNITS_TOLD = {
    "time": r"[munµμ]?s",
    "gyroscope": r"m?(?:(?:rad|deg|°)/s|dps)",
    "accelerometer": r"m?g|c?m/s(?:²|\^?2)",
}
#: The kinds that an entry may name.
_NAMED = ("time", *SENSORS, "gravity", "linear", "quaternion", "angles")


def _told(table: Table, columns: str) -> Table:
    """Return a table with the headings that the reader gave."""
    names = list(table.columns)
    for entry in columns.split():
        told = _TOLD.fullmatch(entry)
        if told and told[1] not in _NAMED:
            raise RecordingError(
                f"{told[1]!r} is not a kind of column: choose from {', '.join(_NAMED)}"
            )
        first, last = (int(told[2]), int(told[3] or told[2])) if told else (0, 0)
        if not told or not 1 <= first <= last <= len(names):
            raise RecordingError(
                f"{entry!r} does not describe columns from 1 to {len(names)}: write an entry such "
                "as gyroscope=2-4 or gyroscope=2-4:rad/s"
            )
        if told[4] and not re.fullmatch(_UNITS_TOLD.get(told[1], ".*"), told[4], re.IGNORECASE):
            raise RecordingError(
                f"{told[4]!r} is not a unit of the {told[1]}: write s or ms for a time, rad/s or "
                "deg/s for a gyroscope, m/s² or g for an accelerometer"
            )
        axes = {
            1: [""],
            2: [" secs", " nsecs"],
            3: ["_x", "_y", "_z"],
            4: ["_w", "_x", "_y", "_z"],
        }.get(last - first + 1)
        if axes is None:
            raise RecordingError(
                f"{entry!r} has {last - first + 1} columns, but a time has one or two, a vector "
                "three and a quaternion four"
            )
        for column, axis in zip(range(first - 1, last), axes, strict=True):
            names[column] = told[1] + axis + (f" ({told[4]})" if told[4] else "")
    return table._replace(columns=names) if columns else table


def _question(tables: Sequence[Table], chosen: Mapping[str, Group]) -> str:
    """Ask about a file that names no sensor, showing its first rows."""
    table = tables[0]
    rows = [" ".join(f"{value:.6g}" for value in row[:16]) for row in table.values[:3]]
    shown = "\n".join(f"    {row}" for row in [" ".join(table.columns[:16]), *rows])
    trajectory = (
        "It contains orientations, like a trajectory, but not the sensor's values from which they "
        "were computed. "
        if "quaternion" in chosen
        else ""
    )
    return (
        f"this file does not say which columns come from which sensor. {trajectory}Its headings "
        f"and first rows are\n{shown}\nName the columns, counted from 1, for example: --columns "
        "'time=1 gyroscope=2-4:rad/s accelerometer=5-7'"
    )


def _unit(heading: str) -> str:
    """Return the unit in a heading's brackets, or after its last underscore."""
    brackets = re.search(r"[(\[]([^)\]]*)[)\]]", heading)
    return (brackets[1] if brackets else heading.rpartition("_")[2]).strip().lower()


def _time(table: Table) -> tuple[int | None, Array, str, bool]:
    """Return the column of time, the seconds, a description, and whether it only counts."""
    candidates: list[tuple[float, int]] = []
    # Whole seconds with the fraction of each in another column.
    for k, column in enumerate(table.columns):
        rest = [
            c
            for c, other in enumerate(table.columns)
            if re.search(r"n(?:ano)?secs?$", other.lower()) and c != k
        ]
        if (
            rest
            and re.search(r"(?<!n)(?<!nano)secs?$", column.lower())
            and 0 <= table.values[:, rest[0]].max() < 1.0001e9
        ):
            time = table.values[:, k] - table.values[0, k] + 1e-9 * table.values[:, rest[0]]
            return k, time, f"{column} with {table.columns[rest[0]]}, in s", False
    for k, column in enumerate(table.columns):
        values = table.values[:, k]
        called = re.search(TIME, column.lower()) or _unit(column) in UNITS_OF_TIME
        if not called or _called(column.lower()) in PLAYED or np.isnan(values).any():
            continue
        steps = np.diff(values)
        middle = np.median(steps)
        if middle > 0 and np.mean(steps >= 0) > 0.97:
            even = np.mean(np.abs(steps - middle) < 0.5 * middle)
            precise = "elapsed" in column.lower() or _unit(column) in UNITS_OF_TIME
            counts = bool(re.search(COUNTS, column.lower()))
            candidates.append((float(precise + 0.5 * even - counts - 0.01 * k), k))
    if not candidates:
        steps = np.diff(table.values, axis=0).T
        words = "no column gives each row's time" + "".join(
            f" ({column} runs backwards {number_of((of_one < 0).sum(), 'time')})"
            if (of_one < 0).any()
            else f" ({column} repeats the row before {number_of((of_one == 0).sum(), 'time')}; "
            "was it rounded?)"
            for column, of_one in zip(table.columns, steps, strict=True)
            if re.search(TIME, column.lower()) and (of_one <= 0).any()
        )
        return None, np.arange(len(table.values), dtype=float), words, True
    k = max(candidates)[1]
    column, values = table.columns[k], table.values[:, k]
    step = np.median(np.diff(values)[np.diff(values) > 0])
    if re.search(COUNTS, column.lower()) or (step == 1 and _unit(column) != "ms"):
        return k, values, f"{column}, which only counts samples", True
    named = UNITS_OF_TIME.get(_unit(column))
    by_size = next((scale for scale in (1.0, 1e-3, 1e-6, 1e-9) if 2e-4 < step * scale <= 0.5), None)
    scale = named if named and 1e-5 < step * named < 5 else _by_rate(table, step) or by_size
    if scale is None:
        raise RecordingError(
            f"{table.name}: column {column} looks like a time, but its steps of {step:g} do not "
            f"fit any unit. Give the unit, such as --columns time={k + 1}:ms"
        )
    units = [unit for unit, size in UNITS_OF_TIME.items() if size == scale]
    words = f"{column}, in {units[0] if units else f'{scale:g} s'}"
    if named and named != scale:
        words += f" (its heading says {_unit(column)})"
    return k, values * scale, words, False


def _by_rate(table: Table, step: float) -> float | None:
    """Return the power of ten of a second that gives a clock the rate stated above the numbers."""
    said = re.search(RATE, table.head, re.IGNORECASE)
    if not said or not float(said[1]):
        return None
    power = -np.log10(float(said[1]) * step)
    return float(10.0 ** round(power)) if abs(power - round(power)) < 0.05 else None


def _parts(heading: str) -> tuple[str, str]:
    """Split a heading, without its unit, into its subject and the letter of its axis."""
    # The prefix of a robot's log, and the suffixes of a drone's and a phone's.
    heading = re.sub(r"^field\.|(?<=[WXYZ])(?::[A-Z]|Mps2|RadPerSec|MicroT)$", "", heading)
    text = re.sub(r"[(\[](?![0-3wxyzWXYZ][)\]]).*?[)\]]", "", heading).strip().lower()
    text = re.sub(
        r"(?<=[a-z])(?=\[)|[\[\]|:. _/-]+", " ", re.sub(r"(?<=[a-z])(?=[A-Z])", " ", text)
    ).strip()
    words = [word for word in text.split() if word not in ("cal", "uncal", "raw")] or text.split()
    if not words:
        return "", ""
    for place in (-1, 0):
        if re.fullmatch(r"[wxyz]", words[place]):
            rest = words[:-1] if place else words[1:]
            return " ".join(rest), words[place]
    if re.fullmatch(r"\d", words[-1]):
        return " ".join(words[:-1]), words[-1]
    if re.fullmatch(r"[wxyz] (?:element|axis|value)", text):
        return "", text[0]
    found = re.fullmatch(r"(.*[a-z0-9])([wxyz]|(?<=q)[0-3])", words[-1])
    if found:
        return " ".join([*words[:-1], found[1]]), found[2]
    return text, ""


def _called(text: str, patterns: Mapping[str, str] = HEADINGS) -> str:
    return next((kind for kind, pattern in patterns.items() if re.search(pattern, text)), "")


def _named(stem: str, table: Table, column: int) -> str:
    """Return what the heading of an axis, its unit or the name of its table indicate."""
    unit, name = _called(_unit(table.columns[column]), UNITS), _called(table.name.lower())
    # For gauss or gravity, the name of the table is more reliable.
    if _unit(table.columns[column]) in ("g", "mg"):
        unit, name = name, unit
    # An alpha with axes is an acceleration, since the angle has none.
    return ("accelerometer" if stem == "alpha" else _called(stem)) or unit or name


def _groups(table: Table, time_column: int | None, time: Array) -> tuple[list[Group], list[str]]:
    """Return the columns that belong together, and the headings of the others."""
    groups: list[Group] = []
    taken = {time_column}
    parts = [_parts(column) for column in table.columns]
    usable = [
        k
        for k in range(len(table.columns))
        if k != time_column and np.isfinite(table.values[:, k]).sum() > 8
    ]

    def add(kind: str, columns: Sequence[int], called: str) -> None:
        rows = np.isfinite(table.values[:, columns]).all(axis=1)
        if rows.sum() > 8:
            names = [table.columns[k] for k in columns]
            groups.append(
                Group(
                    kind,
                    called,
                    names,
                    time[rows],
                    table.values[np.ix_(np.flatnonzero(rows), np.array(columns))],
                )
            )
            taken.update(columns)

    rates = [k for k in usable if re.search("roll|pitch|yaw", (name := table.columns[k].lower()))
             and re.search(r"rate|gyr|omega|veloc|rad/s|deg/s|°/s|dps", name)]  # fmt: skip
    around = [
        [k for k in rates if word in table.columns[k].lower()] for word in ("roll", "pitch", "yaw")
    ]
    letters = [
        [k for k in usable if re.fullmatch(rf"{one}\W*(?:[\[(].*)?", table.columns[k].lower())]
        for one in "pqr"
    ]
    for three in (around, letters):
        if all(three):
            add("vector", [places[0] for places in three], "gyroscope")
    usable = [k for k in usable if k not in taken]
    stems: dict[str, list[tuple[str, int]]] = {}
    for k in usable:
        stem, axis = parts[k]
        if axis:
            stems.setdefault(stem, []).append((axis, k))
    for stem, found in stems.items():
        axes = {axis: k for axis, k in found}
        called = _named(stem, table, found[0][1])
        columns = [k for _, k in found]
        if len(found) == 4 and _is_unit(table.values[:, columns]):
            order = "".join(axis for axis, _ in found)
            if set(order) == set("wxyz") and order not in ("wxyz", "xyzw"):
                # Some write z before y before x.
                columns = [axes[axis] for axis in "wxyz"]
            add("quaternion", columns, "quaternion")
        elif {"x", "y", "z"} <= set(axes) and len(found) in (3, 4):
            add("vector", [axes[axis] for axis in "xyz"], called)
        elif len(found) == 3 and len({axis for axis, _ in found}) == 3:
            add("vector", columns, called)
    angles = [k for k in usable if k not in taken and _called(table.columns[k].lower()) == "angles"]
    if len(angles) >= 3:
        known = places_by_name([table.columns[k] for k in angles])
        add("angles", [angles[k] for k in known] if known else angles[:3], "angles")
    return groups, [table.columns[k] for k in range(len(table.columns)) if k not in taken]


def places_by_name(names: Iterable[str]) -> tuple[int, ...] | None:
    """Return the places of yaw, pitch and roll, or alpha, beta and gamma, or None if unclear."""
    text = [name.lower() for name in names]
    for words in (
        ("yaw", "pitch", "roll"),
        ("heading", "pitch", "roll"),
        ("azimuth", "pitch", "roll"),
        ("alpha", "beta", "gamma"),
        ("psi", "theta", "phi"),
    ):
        # The commanded angle may be beside the measured one, which has the shorter name.
        having = [[k for k, one in enumerate(text) if word in one] for word in words]
        places = tuple(min(places, key=lambda k: len(text[k])) for places in having if places)
        if len(set(places)) == 3:
            return places
    return None


def _is_unit(values: Array) -> bool:
    """Check that four columns have length 1 in nearly all rows, as a quaternion's have."""
    lengths = np.linalg.norm(values[np.isfinite(values).all(axis=1)], axis=1)
    return len(lengths) > 8 and float(np.mean(np.abs(lengths - 1) < 0.025)) > 0.98


def _with_gravity(chosen: dict[str, Group], groups: Sequence[Group]) -> list[str]:
    """Combine separate columns of acceleration and gravity into an accelerometer's measurement."""
    felt = chosen.get("accelerometer")
    apart = [
        group for group in groups if group.called == "gravity" and points_one_way(group.values)
    ]
    if felt is not None and points_one_way(felt.values) or not apart:
        return []
    moving = ("linear acceleration", "accelerometer")
    felt = felt or next((group for group in groups if group.called in moving), None)
    if felt is None:
        return []
    gravity = np.stack(
        [np.interp(felt.time, apart[0].time, column) for column in apart[0].values.T], axis=-1
    )
    chosen["accelerometer"] = felt._replace(values=felt.values + gravity, called="accelerometer")
    return [
        f"{', '.join(felt.names)} does not contain gravity; {', '.join(apart[0].names)} was added "
        "to it"
    ]


def points_one_way(values: Array) -> bool:
    """Check for a nearly constant length, which gravity and the Earth's field have."""
    low, middle, high = np.percentile(np.linalg.norm(values, axis=1), (10, 50, 95))
    return bool(middle > 0 and low / middle > 0.6 and high / middle < 2.2)


def _roles(groups: Sequence[Group]) -> dict[str, Group]:
    """Return the first group of each kind that varies.

    If the supposed gyroscope has a nearly constant length and the supposed accelerometer has not,
    the two are swapped.
    """
    chosen: dict[str, Group] = {}
    for group in groups:
        kind = group.called if group.kind == "vector" else group.kind
        # So-called linear acceleration may include gravity, which its length reveals.
        if kind == "linear acceleration" and points_one_way(group.values):
            kind = "accelerometer"
        if kind in PLAYED and np.ptp(group.values, axis=0).any():
            chosen.setdefault(kind, group._replace(called=kind))
    turning, felt = chosen.get("gyroscope"), chosen.get("accelerometer")
    if turning and felt and points_one_way(turning.values) and not points_one_way(felt.values):
        chosen |= {"gyroscope": felt, "accelerometer": turning}
    return {kind: chosen[kind] for kind in PLAYED if kind in chosen}


def unit_of_gravity(values: Array) -> tuple[str, float, float]:
    """Return the unit that fits gravity's length, its number per g, and the relative error."""
    middle = float(np.median(np.linalg.norm(values, axis=1)))
    unit = min(GRAVITY, key=lambda one: abs(np.log(middle / GRAVITY[one])))
    if abs(np.log(middle / GRAVITY[unit])) < 0.2:
        return unit, GRAVITY[unit], middle / GRAVITY[unit] - 1
    return f"counts, {middle:.4g} to one g", middle, 0.0


def unit_of_field(length: float) -> str:
    """Return the unit in which vectors of this length fit the Earth's field."""
    units = [unit for unit, (low, high) in FIELD.items() if low <= length <= high]
    return units[0] if units else "an unknown unit"


def unit_of_rates(names: Sequence[str]) -> str:
    """Return the unit of angular velocity that headings name, or an empty string."""
    text = " ".join(names).lower()
    marks = {"mrad/s": "mrad", "rad/s": "rad", "m°/s": "mdps|mdeg", "°/s": "deg|°|dps"}
    return next((unit for unit, pattern in marks.items() if re.search(pattern, text)), "")


def unit_in_brackets(heading: str) -> str:
    """Return the unit of acceleration in a heading's brackets, if it is a known one."""
    text = heading.lower().replace("^2", "²").replace("s2", "s²")
    unit = re.search(r"[(\[]\s*(m/s²|m?g|cm/s²)\s*[)\]]", text)
    return unit[1] if unit else ""
