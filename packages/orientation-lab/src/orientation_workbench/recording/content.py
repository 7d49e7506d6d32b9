"""What a recording's columns are, by the names that known loggers give them.

If a file has other names or none, `read_content` raises a question, which the reader answers.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .table import RecordingError, Table, number_of, read_tables

if TYPE_CHECKING:
    from .table import Array, Source

#: What loggers call a sensor's columns, at the end of a heading or, if the headings are only x, y
#: and z, of the table's name. The first name that fits counts.
NAMES = {
    "quaternion": r"quat\w*|orientation|attitude|q",
    "gravity": r"grav\w*",
    "linear acceleration": r"(?:user|free|lin|lineare?)(?: acc\w*| ?beschl\w*)?",
    "magnetometer": r"mag\w*|(?:magnetic )?field|[mbh]",
    "gyroscope": r"gyr\w*|angular (?:velocity|rate)|(?:rotation )?rate|omega|[gw]"
    r"|drehrate|winkelg\w*|gy",
    "accelerometer": r"(?:total )?acc\w*|ac|beschl\w*|(?:specific )?force|[af]",
}
#: The names of rotations about z, y and x, or in phones about z, x and y.
ANGLES = (
    ("yaw", "pitch", "roll"),
    ("heading", "pitch", "roll"),
    ("azimuth", "pitch", "roll"),
    ("alpha", "beta", "gamma"),
    ("psi", "theta", "phi"),
)
#: The units in brackets that only one sensor has, for headings in other languages.
UNITS = {
    "gyroscope": r"(?:rad|deg|°)(?: ?/ ?s| s)|dps",
    "accelerometer": r"m ?/ ?\(?s(?:\^?2|²)|m s\^?-2",
    "magnetometer": r"[uµμ]t$|gauss",
}
#: Words of a heading that do not name its sensor, and words that are units unless they come first.
BESIDE = "cal uncal raw ln wr adc smooth element axis value".split()
UNIT_WORDS = "m s s2 ms2 mps2 rad deg dps per sec g mg ga ut micro t".split()
CLOCK = r"\btime|\bzeit|stamp|elapsed|clock|epoch|\bt$|\bsec"
COUNTER = r"counter|packet|number|index|frame|iteration|tick|\bsample\b(?! time)|\bcount$|\bid$"
RATE = r"(?:rate|frequency)[\W_]*(\d+(?:\.\d+)?)\s*hz"
#: The kinds of columns that the bench can use.
PLAYED = ("accelerometer", "magnetometer", "gyroscope", "quaternion", "angles", "temperature")
UNITS_OF_TIME = {
    "s": 1.0,
    "ms": 1e-3,
    "us": 1e-6,
    "µs": 1e-6,
    "μs": 1e-6,
    "ns": 1e-9,
    # An Arduino's functions, after which its columns are often named.
    "millis": 1e-3,
    "micros": 1e-6,
}
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


class Clock(NamedTuple):
    """The times of a table.

    Attributes
    ----------
    column : int or None
        The place of the column.
    time : array of shape ``(n,)``
        Seconds, or the numbers of the samples.
    words : str
        The heading and the unit, or a note that there is no time.
    counted : bool
        Whether time only counts samples.
    rate : float or None
        Samples per second, if the lines above the numbers state it.
    """

    column: int | None
    time: Array
    words: str
    counted: bool
    rate: float | None


class Group(NamedTuple):
    """Columns that belong together: three of a vector or of angles, four of a quaternion.

    Attributes
    ----------
    kind : str
        A key of ``NAMES``, angles or temperature.
    names : list of str
        The headings.
    time : array of shape ``(n,)``
    values : array of shape ``(n, 1)``, ``(n, 3)`` or ``(n, 4)``
    clock : Clock
    table : Table
    """

    kind: str
    names: list[str]
    time: Array
    values: Array
    clock: Clock
    table: Table


class Content(NamedTuple):
    """What a recording contains.

    Attributes
    ----------
    groups : dict
        A `Group` by its kind, one of ``PLAYED``.
    clock : str
        The heading and unit of the time used, or a note that there is none.
    counted : bool
        Whether time only counts samples, so that the rate is unknown.
    remarks : list of str
    unused : list of str
        Headings of unused columns.
    """

    groups: dict[str, Group]
    clock: str
    counted: bool
    remarks: list[str]
    unused: list[str]


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
        If the file cannot be read, no column has the name of a sensor, or several files have the
        same sensor.
    """
    if rate is not None and not 0 < rate < np.inf:
        raise RecordingError(
            f"the rate is {rate:g}, not a positive, finite number of samples per second"
        )
    tables = [_told(table, columns) for table in read_tables(source, name)]
    groups: list[Group] = []
    unused: list[str] = []
    remarks: list[str] = []
    several = len(tables) > 1
    for table in tables:
        remarks += [remark + f" of {table.name}" * several for remark in table.remarks]
        of_this_table, left = _groups(table)
        groups += of_this_table
        unused += left
    _refuse_several(groups)
    chosen, more = _chosen(groups)
    remarks += more
    sensors = [chosen[kind] for kind in SENSORS if kind in chosen]
    if not sensors:
        raise RecordingError(_question(tables[0], bool({"quaternion", "angles"} & chosen.keys())))
    unused += [
        ", ".join(group.names) + f" of {group.table.name}" * several
        for group in groups
        if not any(group.time is each.time for each in chosen.values())
    ]
    clock, ticks = sensors[0].clock, sensors[0].time
    words = clock.words
    if clock.counted and clock.rate and not rate:
        rate = clock.rate
        words += f", at {rate:g} per second according to the lines above the numbers"
    if clock.counted:
        # The samples of the first sensor serve as the clock.
        chosen = {
            kind: group._replace(
                time=np.interp(group.time, ticks, np.arange(len(ticks))) / (rate or 1.0)
            )
            for kind, group in chosen.items()
        }
    start = min(group.time[0] for group in chosen.values())
    chosen = {kind: group._replace(time=group.time - start) for kind, group in chosen.items()}
    return Content(chosen, words, clock.counted and not rate, remarks, unused)


#: An entry of the reader's description of the columns.
_TOLD = re.compile(r"(\w+)=(\d+)(?:-(\d+))?(?::(\S+))?")
#: The units that an entry may give; for other columns a unit makes no difference.
_UNITS_TOLD = {
    "time": r"[munµμ]?s",
    "gyroscope": r"m?(?:(?:rad|deg|°)/s|dps)",
    "accelerometer": r"m?g|c?m/s(?:²|\^?2)",
}
#: The kinds that an entry may name.
_NAMED = ("time", *SENSORS, "gravity", "linear", "quaternion", "yaw", "pitch", "roll")


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
    return table._replace(columns=names)


def _question(table: Table, trajectory: bool) -> str:
    """Ask about a file in which no sensor has a known name, showing its first rows."""
    rows = [" ".join(f"{value:.6g}" for value in row[:16]) for row in table.values[:3]]
    shown = "\n".join(f"    {row}" for row in [" ".join(table.columns[:16]), *rows])
    return (
        "this file does not say which columns come from which sensor. "
        + (
            "It contains orientations, like a trajectory, but not the sensor's values from which "
            "they were computed. "
        )
        * trajectory
        + f"Its headings and first rows are\n{shown}\nName the columns, counted from 1, for "
        "example: --columns 'time=1 gyroscope=2-4:rad/s accelerometer=5-7'"
    )


def _words(heading: str) -> str:
    """Return the words of a heading in lower case, without a unit in brackets.

    >>> _words('Shimmer_Gyro_X [deg/s]'), _words('gyroADC[0]'), _words('AccelXMps2')
    ('shimmer gyro x', 'gyro adc 0', 'accel x mps2')
    """
    # The power of a unit, such as ^2, is not the number of an axis.
    bare = re.sub(r"[(\[](?![0-4wxyz][)\]]).*?[)\]]|\^-?\d", "", heading)
    return " ".join(
        re.findall(
            r"[a-z0-9]+", re.sub(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", " ", bare).lower()
        )
    )


def _in_brackets(heading: str) -> str:
    """Return what a heading has in brackets, which is usually a unit, in lower case."""
    brackets = re.search(r"[(\[]([^)\]]*)[)\]]", heading)
    return brackets[1].lower() if brackets else ""


def _unit_of_time(heading: str) -> float | None:
    """Return the unit in a heading's brackets, or its last word, in seconds."""
    last = "" if re.search(r"/ ?s\b", heading) else _words(heading).split(" ")[-1]
    return UNITS_OF_TIME.get(_in_brackets(heading) or last)


def _clock(table: Table) -> Clock:
    """Find the times: those with a unit first, numbers of samples last."""
    columns, values = table.columns, table.values
    texts = [_words(column) for column in columns]
    # Whole seconds, with the fraction of each in another column.
    whole, rest = (
        [k for k, text in enumerate(texts) if re.search(pattern, text)]
        for pattern in (r"\bsecs?$", r"\bn(?:ano)?secs?$")
    )
    if whole and rest:
        time = values[:, whole[0]] - values[0, whole[0]] + 1e-9 * values[:, rest[0]]
        words = f"{columns[whole[0]]} with {columns[rest[0]]}, in s"
        return Clock(whole[0], time, words, False, None)
    counts = [bool(re.search(COUNTER, text)) for text in texts]
    units = [_unit_of_time(column) for column in columns]
    named = [
        k
        for k, text in enumerate(texts)
        if re.search(CLOCK, text) or counts[k] or units[k]
        if not np.isnan(values[:, k]).any()
    ]
    steps = np.diff(values, axis=0)
    rising = [k for k in named if np.median(steps[:, k]) > 0 and np.mean(steps[:, k] >= 0) > 0.97]
    said = re.search(RATE, table.head, re.IGNORECASE)
    rate = float(said[1]) or None if said else None
    if not rising:
        words = "no column gives each row's time" + "".join(
            f" ({columns[k]} runs backwards {number_of((steps[:, k] < 0).sum(), 'time')})"
            if (steps[:, k] < 0).any()
            else f" ({columns[k]} has the same value as in the row above "
            f"{number_of((steps[:, k] == 0).sum(), 'time')}; was it rounded?)"
            for k in named
            if (steps[:, k] <= 0).any()
        )
        return Clock(None, np.arange(len(values), dtype=float), words, True, rate)
    k = min(
        rising, key=lambda k: (counts[k], not (units[k] or "elapsed" in texts[k]), rising.index(k))
    )
    step = float(np.median(steps[:, k][steps[:, k] > 0]))
    if counts[k] or (step == 1 and not units[k]):
        return Clock(k, values[:, k], f"{columns[k]}, which only counts samples", True, rate)
    named_unit = units[k]
    # No instrument's steps have a size outside these limits, whatever the heading says.
    scale = named_unit if named_unit and 1e-5 < step * named_unit < 5 else None
    power = np.log10(rate * step) if rate else 0.5
    if not scale and abs(power - np.round(power)) < 0.05:
        scale = float(10.0 ** -np.round(power))
    elif not scale:
        scale = next((size for size in (1.0, 1e-3, 1e-6, 1e-9) if 2e-4 < step * size <= 0.5), None)
    if scale is None:
        raise RecordingError(
            f"{table.name}: column {columns[k]} looks like a time, but its steps of {step:g} do "
            f"not fit any unit. Give the unit, such as --columns time={k + 1}:ms"
        )
    said_units = {size: unit for unit, size in reversed(UNITS_OF_TIME.items())}
    words = f"{columns[k]}, in {said_units.get(scale, f'{scale:g} s')}"
    if named_unit and named_unit != scale:
        words += f" (its heading says {said_units[named_unit]})"
    # A counter of 32 bits, such as an Arduino's microseconds after 72 minutes, starts again at 0.
    wraps = np.append(0, steps[:, k] < -(2.0**31)) * (values[:, k].max() < 2.0**32)
    if wraps.any():
        words += f", which passes 2³² and starts again at 0 ({number_of(wraps.sum(), 'time')})"
    return Clock(k, (values[:, k] + 2.0**32 * wraps.cumsum()) * scale, words, False, rate)


def _stem_and_axis(heading: str) -> tuple[str, str]:
    """Split a heading into what it names and the letter or number of its axis.

    >>> _stem_and_axis('gyroADC[0]'), _stem_and_axis('qw'), _stem_and_axis('X [mg]')
    (('gyro', '0'), ('q', 'w'), ('', 'x'))
    """
    words = [
        word
        for k, word in enumerate(_words(heading).split())
        if word not in BESIDE and not (k and word in UNIT_WORDS)
    ]
    for place in (-1, 0):
        if words and re.fullmatch(r"[wxyz0-4]|q[0-3]", words[place]):
            return " ".join(words[1:] if place == 0 else words[:-1]), words[place][-1]
    text = " ".join(words)
    if turn := re.fullmatch(r"(.*\b)?(roll|pitch|yaw) ?(?:rate|speed)", text):
        return (turn[1] or "") + "rate", {"roll": "x", "pitch": "y", "yaw": "z"}[turn[2]]
    joined = re.fullmatch(r"(.*[a-z])([wxyz]|(?<=q)[0-3])", text)
    return (joined[1], joined[2]) if joined else (text, "")


def _kind(stem: str, heading: str, table: str) -> str:
    """Return the kind of sensor of a heading, or an empty string.

    Its stem ends with the name. Without a stem, the name is a word of the table's. Otherwise the
    unit may tell.

    >>> _kind('shimmer gyro', '', ''), _kind('', 'X [mg]', 'ACC_today'), _kind('', 'X [dps]', '')
    ('gyroscope', 'accelerometer', 'gyroscope')
    """
    text = stem or " ".join(word for word in _words(table).split() if len(word) > 2)
    where = "$" if stem else r"\b"
    kinds = [kind for kind, name in NAMES.items() if re.search(rf"\b(?:{name}){where}", text)]
    kinds += [kind for kind, unit in UNITS.items() if re.search(unit, _in_brackets(heading))]
    return (kinds or [""])[0]


def _groups(table: Table) -> tuple[list[Group], list[str]]:
    """Return the columns that belong together, and the headings of the others."""
    clock = _clock(table)
    groups: list[Group] = []
    taken = {clock.column}

    def add(kind: str, columns: Sequence[int]) -> None:
        # Some loggers write zeros until their filter has begun.
        rows = np.isfinite(table.values[:, columns]).all(axis=1)
        rows &= kind != "quaternion" or table.values[:, columns].any(axis=1)
        if rows.sum() > 8:
            names, values = [table.columns[k] for k in columns], table.values[rows][:, columns]
            groups.append(Group(kind, names, clock.time[rows], values, clock, table))
            taken.update(columns)

    stems: dict[str, dict[str, int]] = {}
    for k, heading in enumerate(table.columns):
        stem, axis = _stem_and_axis(heading)
        if axis and k != clock.column:
            stems.setdefault(stem, {}).setdefault(axis, k)
    for stem, axes in stems.items():
        kind = _kind(stem, table.columns[next(iter(axes.values()))], table.name)
        order = "".join(axes)
        if len(axes) == 4 and (kind == "quaternion" or not stem):
            # Some write z before y before x.
            scalar_at_end = order in ("wxyz", "xyzw") or order.isdigit()
            add("quaternion", [axes[axis] for axis in (order if scalar_at_end else "wxyz")])
        elif kind and kind != "quaternion" and (three := sorted(set(axes) - {"w"}))[2:]:
            add(kind, [axes[axis] for axis in three[:3]])
    for names in ANGLES:
        # The commanded angle may be beside the measured one, which has the shorter name.
        having = [
            sorted(
                (k for k, heading in enumerate(table.columns) if k not in taken
                 and re.search(rf"\b{name}\b(?! (?:rate|speed))", _words(heading))),
                key=lambda k: len(table.columns[k]),
            )
            for name in names
        ]  # fmt: skip
        if all(having):
            add("angles", [columns[0] for columns in having])
            break
    for k, name in enumerate(table.columns):
        if re.search(r"temp(?:erat\w*)?\d*\b", _words(name)):
            add("temperature", [k])
            break
    unused = [name for k, name in enumerate(table.columns) if k not in taken]
    for stem, axes in stems.items():
        three = sorted(set(axes) - {"w"})[:3]
        like_angles = re.search(r"\b(?:euler|angles?|rpy|attitude|orientation)$", stem)
        if like_angles and len(three) == 3 and taken.isdisjoint(axes.values()):
            told = zip(("roll", "pitch", "yaw"), (axes[axis] for axis in three), strict=True)
            said = " ".join(f"{name}={k + 1}" for name, k in told)
            last = unused.index(table.columns[max(axes.values())])
            unused[last] += f" (if these are angles, name them: --columns '{said}')"
            break
    return groups, unused


def _refuse_several(groups: Sequence[Group]) -> None:
    """Refuse the files of several recordings, which have the same sensor in more than one file."""
    # Without the sensor's name in the headings, tables with different names may be of one
    # recording: phones write a sensor's raw values, too.
    sensors = [
        (group.kind, not _stem_and_axis(group.names[0])[0] and group.table.name, group.table.file)
        for group in groups
        if group.kind in SENSORS
    ]
    for sensor in sensors:
        if len(files := {other[2] for other in sensors if other[:2] == sensor[:2]}) > 1:
            raise RecordingError(
                f"these files are several recordings, since each has its own {sensor[0]}: "
                f"{', '.join(sorted(files))}. Give one of them (unpack an archive first), or only "
                "the files of one recording"
            )


def _chosen(groups: Sequence[Group]) -> tuple[dict[str, Group], list[str]]:
    """Return the first group of each kind that varies, and remarks.

    An accelerometer measures gravity, too. Phones may give gravity and the rest apart.
    """
    chosen: dict[str, Group] = {}
    varying = [group for group in groups if np.ptp(group.values, axis=0).any()]
    for group in varying:
        chosen.setdefault(group.kind, group)
    remarks = [
        f"{', '.join(group.names)} never change in {len(group.values)} rows"
        for group in groups
        if group.kind in SENSORS and not np.ptp(group.values, axis=0).any()
    ]
    felt = [group for group in varying if group.kind in ("accelerometer", "linear acceleration")]
    whole = [group for group in felt if points_one_way(group.values)]
    if whole:
        chosen["accelerometer"] = whole[0]
    elif felt and "gravity" in chosen:
        pushed, gravity = felt[0], chosen["gravity"]
        values = pushed.values + np.stack(
            [np.interp(pushed.time, gravity.time, column) for column in gravity.values.T], axis=-1
        )
        chosen["accelerometer"] = pushed._replace(values=values)
        remarks.append(
            f"{', '.join(pushed.names)} does not contain gravity; {', '.join(gravity.names)} was "
            "added to it"
        )
    return {kind: chosen[kind]._replace(kind=kind) for kind in PLAYED if kind in chosen}, remarks


def points_one_way(values: Array) -> bool:
    """Check for a nearly constant length, which gravity has."""
    low, middle, high = np.percentile(np.linalg.norm(values, axis=1), (10, 50, 95))
    return bool(middle > 0 and low / middle > 0.6 and high / middle < 2.2)


def unit_of_gravity(values: Array) -> tuple[str, float, float]:
    """Return the unit that fits gravity's length, its number per g, and the relative error."""
    middle = float(np.median(np.linalg.norm(values, axis=1)))
    unit = min(GRAVITY, key=lambda unit: abs(np.log(middle / GRAVITY[unit])))
    if abs(np.log(middle / GRAVITY[unit])) < 0.2:
        return unit, GRAVITY[unit], middle / GRAVITY[unit] - 1
    return f"counts, {middle:.4g} to one g", middle, 0.0


def unit_of_field(length: float) -> str:
    """Return the unit in which vectors of this length fit the Earth's field."""
    return next(
        (unit for unit, (low, high) in FIELD.items() if low <= length <= high), "an unknown unit"
    )


def unit_of_rates(names: Sequence[str]) -> str:
    """Return the unit of angular velocity that headings name, or an empty string."""
    text = " ".join(names).lower()
    marks = {"mrad/s": "mrad", "rad/s": "rad", "m°/s": "mdps|mdeg", "°/s": "deg|°|dps"}
    return next((unit for unit, pattern in marks.items() if re.search(pattern, text)), "")


def unit_in_brackets(heading: str) -> str:
    """Return the unit of acceleration in a heading's brackets, if it is a known one."""
    unit = _in_brackets(heading).strip().replace("^2", "²").replace("s2", "s²")
    return unit if unit in GRAVITY else ""
