"""Read pasted text, in any brackets, or arrays as poses. Nothing is silently repaired."""

import math
import re
from typing import NamedTuple

import numpy as np

from .spelling import SPELLING, YAW_PITCH_ROLL
from .table import COUNTS


def _pattern(text):
    return re.compile(text, re.IGNORECASE | re.MULTILINE | re.ASCII)


#: The patterns by name, and the lists of pairs of a pattern and its meaning or replacement.
_PATTERNS = {name: _pattern(text) for name, text in SPELLING.items() if isinstance(text, str)}
_PAIRS = {
    name: [(_pattern(text), more) for text, more in entries]
    for name, entries in SPELLING.items()
    if isinstance(entries, tuple)
}
_VALUE_OF_NO_TURN = _pattern(SPELLING["not turns"] + SPELLING["value"])
NUMBER = _PATTERNS["number"]


def _replaced(text, entries):
    for pattern, replacement in entries:
        text = pattern.sub(re.sub(r"\$(\d)", r"\\\1", replacement), text)
    return text


#: Names that label numbers, in the order in which they are tried, and what they imply.
_NAMES = (
    (dict(zip("wxyz", range(4))), {"order": "wxyz"}),
    (
        {"yaw": 0, "heading": 0, "psi": 0, "pitch": 1, "theta": 1, "roll": 2, "bank": 2, "phi": 2},
        YAW_PITCH_ROLL,
    ),
    ({"y": 0, "p": 1, "r": 2}, YAW_PITCH_ROLL),
    (dict(zip("xyz", range(3))), {}),
)

#: How far the length of a quaternion or row may be from 1 besides rounding; more is an error.
SLACK = 1e-4
#: A quaternion's length may be this far from 1; then we normalise it and say so.
NORMALISED = 1e-3


class Poses(NamedTuple):
    """One side's numbers: their possible kinds, an array ``(poses, count)``, and their error."""

    kinds: tuple[str, ...]
    numbers: np.ndarray
    half: float
    large: bool
    declared: dict


def read_poses(given, name: str, kind: str | None = None, noise: float = 0.0) -> Poses:
    """Read the numbers of one side.

    Parameters
    ----------
    given : str, or array
        One pose per line, or matrices of three or four lines; ``name: number`` as ROS and YAML
        print it; arrays of shape ``(3,)``, ``(4,)``, ``(9,)``, ``(3, 3)``, ``(4, 4)`` or a stack of
        them.
    name : str
        The name of the side in messages.
    kind : str, optional
        A key of `orientation_workbench.mismatch.table.COUNTS`, if known.
    noise : float
        Tolerance in radians.

    Raises
    ------
    ValueError
        If the numbers cannot be read; the message says what was read and what is missing.
    """
    if kind is not None and kind not in COUNTS:
        raise ValueError(
            f"{kind!r} is not a kind of description: choose one of {', '.join(COUNTS)}"
        )
    if isinstance(given, str):
        rows, half, declared = _rows_of_text(given, name)
    else:
        rows, half, declared = _rows_of_array(given, name), 0.0, {}
    numbers = _poses(rows, name, kind, half)
    if not np.isfinite(numbers).all():
        raise ValueError(f"the {name} side contains a number that is not finite")
    kinds = _kinds(numbers, kind, half + noise, name)
    large = bool((np.abs(numbers) > math.tau + 0.01).any())
    return Poses(kinds, numbers, half, large, declared)


def _rows_of_array(given, name):
    try:
        array = np.asarray(given, float)
    except (TypeError, ValueError) as error:
        raise ValueError(
            f"the {name} side is neither text nor an array of numbers: {error}"
        ) from None
    if array.ndim == 0:
        raise ValueError(
            f"the {name} side is a single number, {array}; a pose takes at least three"
        )
    return array.reshape(-1, array.shape[-1]).tolist()


def _rows_of_text(text, name):
    for pattern, words in _PAIRS["cut out"]:
        if pattern.search(text):
            raise ValueError(f"the {name} side is {words}")
    if columns := _columns(_decimal_points(text)):
        return columns
    text = _replaced(text, _PAIRS["cleaning"])
    parts = [more for pattern, more in _PAIRS["orders of parts"] if pattern.search(text)]
    bare = _PATTERNS["comment"].sub("", text)
    # If only the comments contain numbers, the comments are what was meant.
    if NUMBER.search(bare):
        text = bare
    text = _without_places(_decimal_points(text))
    for which, words in (
        ("not a number", ", which is not a number"),
        ("arithmetic", ": work it out and paste the result"),
    ):
        if match := _PATTERNS[which].search(text):
            raise ValueError(f"the {name} side contains '{match.group().strip()}'{words}")
    text = _sums(text)
    if not NUMBER.search(text):
        shown = " ".join(text.split())[:40]
        raise ValueError(
            f"the {name} side contains no numbers: '{shown}'"
            if shown
            else f"the {name} side is empty: paste its numbers"
        )
    declared = _unit_in(text)
    if labelled := _labelled(text):
        rows, half, more = labelled
        return rows, half, declared | more
    half = _half(NUMBER.findall(text))
    rows = [
        list(map(float, numbers))
        for group in _PATTERNS["innermost"].findall(text)
        if (numbers := NUMBER.findall(group))
    ]
    whole = sum(map(len, rows)) == len(NUMBER.findall(text))
    if not whole or {len(row) for row in rows} not in ({3}, {4}, {9}, {12}, {16}):
        rows = _rows_of_lines(text)
    if all(len(row) == 3 for row in rows):
        declared |= next(
            (more for pattern, more in _PAIRS["orders of angles"] if pattern.search(text)), {}
        )
    if len(parts) == 1 and all(len(row) == 4 for row in rows):
        declared |= parts[0]
    return rows, half, declared


def _unit_in(text):
    """Return the unit of angles that a text names, as a declaration."""
    return next(
        ({"unit": unit} for unit in ("degrees", "radians") if _PATTERNS[unit].search(text)), {}
    )


def _fields(line):
    """Return the fields of a line of a table, split at separators or else at spaces."""
    line = line.strip().strip("|")
    parted = (
        _PATTERNS["parting"].split(line.strip())
        if _PATTERNS["parting"].search(line)
        else line.split()
    )
    fields = [_PATTERNS["around a field"].sub("", field) for field in parted]
    return fields[:-1] if fields and not fields[-1] else fields


def _columns(text):
    """Return rows, half a unit and declarations of a table with column names, or None without."""
    text = _replaced(text, _PAIRS["cleaning"][:4])
    lines = text.split("\n")
    for place, line in enumerate(lines):
        names = (
            []
            if NUMBER.search(line)
            else [field.lower() for field in _fields(_PATTERNS["around a field"].sub("", line))]
        )
        if len(names) < 3:
            continue
        table = [
            _fields(below) for below in lines[place + 1 :] if not _PATTERNS["no row"].search(below)
        ]
        if (
            not table
            or any(len(row) != len(names) for row in table)
            or not (columns := _named_columns(names))
        ):
            continue
        which, more = columns
        kept = [[row[column] for column in which] for row in table]
        if all(_PATTERNS["whole number"].search(field) for row in kept for field in row):
            half = _half([field for row in kept for field in row])
            return (
                [list(map(float, row)) for row in kept],
                half,
                more | _unit_in(line.replace("_", " ")),
            )
    return None


def _named_columns(names):
    """Return the columns that hold an orientation, in order, and what their names declare."""
    bare = [_PATTERNS["unit of a column"].sub("", name) for name in names]
    entries = [
        (match[1], match[2], column)
        for column, name in enumerate(bare)
        if (match := _PATTERNS["entry of a matrix"].search(name))
    ]
    if len(entries) == 9:
        return [column for *_, column in sorted(entries)], {}
    for own in (
        [bool(_PATTERNS["of a quaternion"].search(name)) for name in bare],
        [True] * len(bare),
    ):
        keys = [
            re.sub(r"^(.*[_.])?q?_*", "", name) if mine else "" for name, mine in zip(bare, own)
        ]
        for place, more in _NAMES[:2]:
            which = [[column for column, key in enumerate(keys) if place.get(key) == each]
                     for each in range(max(place.values()) + 1)]  # fmt: skip
            if all(len(columns) == 1 for columns in which):
                # Keep the order of the columns, so that messages about the numbers match the
                # reader's.
                order = sorted(range(len(which)), key=lambda each: which[each])
                name, letters = ("order", "wxyz") if "order" in more else ("places", "123")
                return [which[each][0] for each in order], more | {
                    name: "".join(letters[each] for each in order)
                }
    return None


def _rows_of_lines(text):
    # Semicolons with one number between them separate columns, as in a spreadsheet's file.
    if ";" in text and all(len(NUMBER.findall(piece)) < 2 for piece in re.split("[\n;]", text)):
        text = text.replace(";", " ")
    pieces = re.split(r"[\n;]|\]\s*,?\s*\[|\)\s*,?\s*\(|\}\s*,?\s*\{", text)
    return [list(map(float, numbers)) for piece in pieces if (numbers := NUMBER.findall(piece))]


def _decimal_points(text):
    """Replace decimal commas by points if two or more numbers have one and none a point.

    A pose has at least three numbers, so if a line would keep just two, its commas separate.

    >>> _decimal_points("0,9239 0 0 0,3827"), _decimal_points("1,0, 0,0")
    ('0.9239 0 0 0.3827', '1,0, 0,0')
    """
    with_comma = re.findall(r"\d+(?:,\d+)+", text)
    pair = r"(?=.*\d,\d)[^A-Za-z\d]*\d[\d,]*\s[\s,]*[-+]?\d[\d,]*[^A-Za-z\d]*"
    if (
        re.search(r"\d\.|\.\d", text)
        or len(with_comma) < 2
        or any(number.count(",") > 1 for number in with_comma)
        or any(re.fullmatch(pair, line) for line in text.split("\n"))
    ):
        return text
    return re.sub(r"(?<=\d),(?=\d)", ".", text)


def _sums(text):
    """Replace i, j and k by names if quaternions are written as sums."""
    if not _PATTERNS["sum"].search(text):
        return text
    text = _replaced(text, _PAIRS["signs of a sum"])
    text = _PATTERNS["part of a sum"].sub(
        lambda part: f" {'xyz'['ijk'.index(part[2].lower())]}={part[1]} ", text
    )
    return _PATTERNS["scalar of a sum"].sub(r" w=\1 ", text)


def _without_places(text):
    """Remove positions and times; below a key without a value, also the indented lines."""
    kept, below = [], None
    for line in _VALUE_OF_NO_TURN.sub(" ", text).split("\n"):
        inset = len(line) - len(line.lstrip())
        if below is not None and line.strip() and inset > below:
            continue
        below = (
            inset
            if (match := _PATTERNS["not turns"].search(line)) and not line[match.end() :].strip()
            else None
        )
        kept.append(_PATTERNS["not turns"].sub(" ", line))
    return "\n".join(kept)


def _labelled(text):
    """Return numbers labelled as in ``w: 1, x: 0, ...`` or ``roll = ...``, or None."""
    pairs = [
        (match[1].lower(), NUMBER.match(text, match.end()))
        for match in _PATTERNS["named"].finditer(text)
    ]
    parts = [
        (key, number)
        for key, number in pairs
        if number and _PATTERNS["part of a quaternion"].search(key)
    ]
    pairs = [
        (re.sub(r"^(.*[_.])?q?_*", "", key), number[0]) for key, number in parts or pairs if number
    ]
    for place, more in _NAMES:
        size = max(place.values()) + 1
        kept = [(place[key], value) for key, value in pairs if key in place]
        if (
            not kept
            or len(kept) % size
            or (size == 3 and "x" in place and any(key == "w" for key, _ in pairs))
        ):
            continue
        rows = [[None] * size for _ in range(len(kept) // size)]
        for which, (where, value) in enumerate(kept):
            rows[which // size][where] = float(value)
        if not any(None in row for row in rows):
            return rows, _half([value for _, value in kept]), more
    return None


def _half(numbers):
    """Return half a unit of the last digit of the most precise number that is not small."""
    largest = max(abs(float(number)) for number in numbers)
    large = [number.lower() for number in numbers if abs(float(number)) >= 0.1 * largest]
    decimals = max(
        len(mantissa.partition(".")[2]) - int(power or 0)
        for mantissa, _, power in (number.partition("e") for number in large)
    )
    return 0.5 * 10.0**-decimals if decimals > 0 else 0.0


def _poses(rows, name, kind, half):
    """Arrange rows of numbers as one array of poses, each of 3, 4 or 9 numbers."""
    widths = {len(row) for row in rows}
    total = sum(map(len, rows))
    width = widths.pop() if len(widths) == 1 else None
    if (
        width == 3
        and kind in (None, "matrix")
        and len(rows) % 3 == 0
        and (kind or _orthogonal(rows))
    ):
        return np.array(rows, float).reshape(-1, 9)
    if width == 4 and kind in (None, "matrix"):
        if len(rows) % 4 == 0 and all(row == [0, 0, 0, 1] for row in rows[3::4]):
            return np.array(rows, float).reshape(-1, 4, 4)[:, :3, :3].reshape(-1, 9)
        if len(rows) % 3 == 0 and _orthogonal([row[:3] for row in rows]):
            return np.array(rows, float).reshape(-1, 3, 4)[:, :, :3].reshape(-1, 9)
    if width in (3, 4) and kind != "matrix":
        return np.array(rows)
    if (
        width
        and width > 4
        and kind in (None, "quaternion")
        and (which := _quaternion_among(rows, half)) is not None
    ):
        return np.array(rows)[:, which : which + 4]
    if width in (9, 12, 16):
        return np.array([_nine(row) for row in rows])
    flat = [number for row in rows for number in row]
    for size in (9, 12, 16) if total > 8 else (3, 4):
        if total % size == 0 and (size > 4 or total == size):
            poses = [_nine(flat[k : k + size]) if size > 4 else flat for k in range(0, total, size)]
            if (
                size > 4
                and (total != size or width == 6)
                and not _orthogonal(np.reshape(poses, (-1, 3)))
            ):
                continue
            return np.array(poses)
    if (
        # Twelve numbers in two lines are two poses.
        total > 4
        and total != 12
        and kind in (None, "quaternion")
        and (which := _quaternion_among([flat], half)) is not None
    ):
        return np.array([flat[which : which + 4]])
    where = "one line" if len(rows) == 1 else f"{len(rows)} lines"
    raise ValueError(
        f"the {name} side contains {total} number{'s' * (total != 1)} in {where}: a pose takes 3 "
        "(angles, or a rotation vector), 4 (a quaternion, or an axis and its angle), 9 (a matrix) "
        "or 16 (a matrix with a translation); leave out positions, except beside a quaternion "
        "(four consecutive numbers of length 1)"
    )


def _nine(row):
    """Return the nine entries of a rotation matrix, even from one that includes a position."""
    across = {9: 3, 12: 4, 16: 4}[len(row)]
    return np.array(row).reshape(-1, across)[:3, :3].ravel().tolist()


def _quaternion_among(rows, half):
    """Return where each row has four numbers of length 1: last, first, or at one place only."""
    array = np.array(rows, float)
    width = array.shape[1]
    if width in (9, 12, 16) and _orthogonal(np.reshape([_nine(row) for row in rows], (-1, 3))):
        return None
    lengths = np.sqrt(np.lib.stride_tricks.sliding_window_view(array**2, 4, axis=1).sum(axis=2))
    places = np.flatnonzero((np.abs(lengths - 1) < 10 * SLACK + 2 * half).all(axis=0)).tolist()
    usual = [place for place in (width - 4, 0) if place in places]
    return (usual or places)[0] if usual or len(places) == 1 else None


def _orthogonal(rows):
    """Check that every three rows are nearly a matrix: of length 1 and orthogonal."""
    array = np.array(rows, float).reshape(-1, 3, 3)
    return bool((np.abs(array @ np.swapaxes(array, 1, 2) - np.eye(3)).max(axis=(1, 2)) < 0.1).all())


def _kinds(numbers, kind, doubt, name):
    count = numbers.shape[1]
    if kind is not None:
        if COUNTS[kind] != count:
            raise ValueError(
                f"the {name} side contains {count} numbers per pose; a {kind} takes {COUNTS[kind]}"
            )
        kinds = (kind,)
    elif count == 4:
        unit = _all_unit(numbers, doubt + NORMALISED / 2)
        kinds = ("quaternion",) if unit else ("axis and angle",)
    else:
        kinds = ("matrix",) if count == 9 else ("Euler angles", "rotation vector")
    if kinds == ("matrix",):
        _demand_orthogonal(numbers, doubt, name)
    elif kinds == ("quaternion",) and not _all_unit(numbers, max(doubt, 0.01)):
        worst = max(np.linalg.norm(numbers, axis=1), key=lambda size: abs(size - 1))
        raise ValueError(f"a quaternion on the {name} side has length {worst:.6g}, not 1")
    elif kinds == ("axis and angle",) and not any(
        _all_unit(axes, doubt) for axes in (numbers[:, :3], numbers[:, 1:])
    ):
        size = np.linalg.norm(numbers[0])
        raise ValueError(
            f"the four numbers on the {name} side are neither a quaternion (their length is "
            f"{size:.6g}, not 1) nor an axis and its angle (neither the first three nor the "
            "last three have length 1)"
        )
    return kinds


def _all_unit(vectors, doubt):
    return bool((np.abs(np.linalg.norm(vectors, axis=1) - 1) <= 2 * doubt + SLACK).all())


def _demand_orthogonal(numbers, doubt, name):
    for which, matrix in enumerate(numbers.reshape(-1, 3, 3), start=1):
        products = matrix @ matrix.T
        gap = np.abs(products - np.eye(3))
        if gap.max() <= 6 * doubt + 2 * SLACK:
            continue
        row, other = np.unravel_index(gap.argmax(), gap.shape)
        what = (
            f"row {row + 1} has length {math.sqrt(products[row, row]):.6g}, not 1"
            if row == other
            else f"the dot product of rows {row + 1} and {other + 1} is "
            f"{products[row, other]:.6g}, not 0"
        )
        raise ValueError(f"matrix {which} on the {name} side is not a rotation: {what}")
