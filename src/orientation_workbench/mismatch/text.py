"""What a reader pastes: text in any brackets, or arrays, read as poses. Nothing is repaired; what was read is said."""

import math
import re
from typing import NamedTuple

import numpy as np

from .table import COUNTS

NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?=[fFlL]?(?![\w.]))")
_KEY = re.compile(r"""["']?([A-Za-z_]\w*)["']?\s*[:=]\s*(?=[-+.\d])""")
_LEFT_OUT = re.compile(
    r"""["']?\b(position|translation|header|stamp|location|covariance)\b["']?\s*[:=]\s*(\{[^}]*\}|\[[^\]]*\])?""",
    re.IGNORECASE,
)
_DECLARATION = re.compile(r"^[^=\n]*\w\s*(\[\d*\]\s*)+=", re.MULTILINE)
_NOT_A_NUMBER = re.compile(r"(?<![A-Za-z])[-+]?(nan|inf(?:inity)?)(?![A-Za-z])", re.IGNORECASE)
_NAMES_OF_ANGLES = {"yaw": 0, "heading": 0, "psi": 0, "pitch": 1, "theta": 1, "roll": 2, "bank": 2, "phi": 2}
WIDTHS = (3, 4, 7, 8, 9, 12, 16)

#: How far the length of a quaternion, or of a row, may be from 1 besides rounding: more is another mistake.
SLACK = 1e-4


class Poses(NamedTuple):
    """Numbers of one side: what kinds they may be, an array ``(poses, count)``, and how far each may be off."""

    kinds: tuple[str, ...]
    numbers: np.ndarray
    half: float
    large: bool
    declared: dict


def read_poses(given, name: str, kind: str | None = None, noise: float = 0.0) -> Poses:
    """Read one side.

    Parameters
    ----------
    given : str, or array
        One pose a line, or matrices of three or four lines; ``name: number`` as ROS and YAML print it; arrays of
        shape ``(3,)``, ``(4,)``, ``(9,)``, ``(3, 3)``, ``(4, 4)`` or a stack of them.
    name : str
        What the side is called in a message.
    kind : str, optional
        A key of :data:`~orientation_workbench.mismatch.table.COUNTS`, where it is known.
    noise : float
        Radians.

    Raises
    ------
    ValueError
        With what was read, and what is missing.
    """
    if kind is not None and kind not in COUNTS:
        raise ValueError(f"{kind!r} is no kind of numbers: it is one of {', '.join(COUNTS)}")
    declared = {}
    if isinstance(given, str):
        rows, half, declared = _rows_of_text(given, name)
    else:
        rows, half = _rows_of_array(given, name), 0.0
    numbers = _poses(rows, name, kind)
    if not np.isfinite(numbers).all():
        raise ValueError(f"the {name} side holds a number that is not finite")
    kinds = _kinds(numbers, kind, half + noise, name)
    large = bool((np.abs(numbers) > math.tau + 0.01).any())
    return Poses(kinds, numbers, half, large, declared)


def _rows_of_array(given, name):
    try:
        array = np.asarray(given, float)
    except (TypeError, ValueError) as error:
        raise ValueError(f"the {name} side is neither text nor an array of numbers: {error}") from None
    if array.ndim == 0:
        raise ValueError(f"the {name} side is the one number {array}; a pose takes at least three")
    return array.reshape(-1, array.shape[-1]).tolist()


def _rows_of_text(text, name):
    text = text.replace("\u2212", "-").replace("\u2013", "-")
    text = re.sub(r"(#|//|%).*", "", text)
    text = _without_places(_DECLARATION.sub(" ", text))
    if found := _NOT_A_NUMBER.search(text):
        raise ValueError(f"the {name} side holds {found.group().strip()!r}, which is no number")
    if not NUMBER.search(text):
        shown = text.strip()[:40]
        raise ValueError(
            f"the {name} side holds no numbers: {shown!r}" if shown else f"the {name} side is empty: paste its numbers"
        )
    declared = {"unit": "degrees"} if re.search(r"\u00b0|\bdeg(rees)?\b", text, re.IGNORECASE) else {}
    half = _half(NUMBER.findall(text))
    labelled = _labelled(text)
    if labelled:
        rows, more = labelled
        return rows, half, declared | more
    rows = []
    for line in re.split(r"[\n;]", text):
        for piece in re.split(r"\]\s*,?\s*\[|\)\s*,?\s*\(|\}\s*,?\s*\{", line):
            if found := NUMBER.findall(piece):
                rows.append([float(number) for number in found])
    return rows, half, declared


def _without_places(text):
    """The text without what says where or when: of a key that stands alone, also the lines set in below it."""
    kept, below = [], None
    for line in text.splitlines():
        inset = len(line) - len(line.lstrip())
        if below is not None and line.strip() and inset > below:
            continue
        below = inset if (found := _LEFT_OUT.search(line)) and not line[found.end() :].strip() else None
        kept.append(_LEFT_OUT.sub(" ", line))
    return "\n".join(kept)


def _labelled(text):
    """Numbers that come with their names, ``w: 1, x: 0, ...`` or ``roll = ...``; None if they do not."""
    pairs = [(match.group(1).lower(), NUMBER.match(text, match.end())) for match in _KEY.finditer(text)]
    pairs = [(key.removeprefix("q").lstrip("_"), float(found.group())) for key, found in pairs if found]
    keys = [key for key, _ in pairs]
    for names, order, more in (
        ("wxyz", "wxyz", {}),
        (("yaw", "pitch", "roll"), None, {"sequence": "zyx"}),
        ("xyz", "xyz", {}),
    ):
        if order:
            kept = [(key, value) for key, value in pairs if key in names]
            place = order.index
        else:
            kept = [(key, value) for key, value in pairs if key in _NAMES_OF_ANGLES]
            place = _NAMES_OF_ANGLES.get
        size = len(names)
        if not kept or len(kept) % size or (len(names) == 3 and order and "w" in keys):
            continue
        rows = []
        for start in range(0, len(kept), size):
            row = [None] * size
            for key, value in kept[start : start + size]:
                row[place(key)] = value
            if None in row:
                break
            rows.append(row)
        else:
            return rows, more
    return None


def _half(found):
    """Half a unit of the last digit printed: of the numbers that are not small, the one with the most digits."""
    sizes = [abs(float(number)) for number in found]
    largest = max(sizes)
    decimals = 0
    for number, size in zip(found, sizes):
        mantissa, _, power = number.lower().partition("e")
        if size >= 0.1 * largest:
            decimals = max(decimals, len(mantissa.partition(".")[2]) - int(power or 0))
    return 0.5 * 10.0**-decimals if decimals > 0 else 0.0


def _poses(rows, name, kind):
    """Rows of numbers as one array of poses, each of 3, 4 or 9 numbers."""
    widths = {len(row) for row in rows}
    total = sum(map(len, rows))
    width = widths.pop() if len(widths) == 1 else None
    if width == 3 and kind in (None, "matrix") and len(rows) % 3 == 0 and (kind or _orthogonal(rows, 3)):
        return np.array(rows, float).reshape(-1, 9)
    if width == 4 and kind in (None, "matrix"):
        if len(rows) % 4 == 0 and all(row == [0, 0, 0, 1] for row in rows[3::4]):
            return np.array(rows, float).reshape(-1, 4, 4)[:, :3, :3].reshape(-1, 9)
        if len(rows) % 3 == 0 and _orthogonal([row[:3] for row in rows], 3):
            return np.array(rows, float).reshape(-1, 3, 4)[:, :, :3].reshape(-1, 9)
    if width in WIDTHS and not (width in (3, 4) and kind == "matrix"):
        return np.array([_one(row, name) for row in rows])
    flat = [number for row in rows for number in row]
    if total in WIDTHS:
        return np.array([_one(flat, name)])
    for size in (9, 16):
        if total % size == 0:
            return np.array([_one(flat[k : k + size], name) for k in range(0, total, size)])
    where = "one line" if len(rows) == 1 else f"{len(rows)} lines"
    raise ValueError(
        f"the {name} side holds {total} number{'s' * (total != 1)} in {where}: a pose takes 3 (angles, or a rotation "
        f"vector), 4 (a quaternion, or an axis and its angle), 9 (a matrix) or 16 (a matrix with a translation)"
    )


def _one(row, name):
    """One pose without its place, if it has one."""
    count = len(row)
    if count in (3, 4, 9):
        return row
    if count == 16:
        matrix = np.array(row).reshape(4, 4)
        if row[12:] != [0, 0, 0, 1] and [row[3], row[7], row[11], row[15]] == [0, 0, 0, 1]:
            matrix = matrix.T
            # Columns are printed one after another; what was printed is what is read.
            return matrix[:3, :3].T.ravel().tolist()
        return matrix[:3, :3].ravel().tolist()
    if count == 12:
        return np.array(row).reshape(3, 4)[:, :3].ravel().tolist()
    for part in (row[-4:], row[:4]):  # a place, or a time and a place, before or behind a quaternion
        if abs(math.hypot(*part) - 1) < 0.01:
            return part
    raise ValueError(
        f"the {name} side holds {count} numbers in a row, as of a place and a quaternion, but no four of them that "
        f"stand together make length 1: the last four make {math.hypot(*row[-4:]):.4g}"
    )


def _orthogonal(rows, size):
    """Whether each block of rows might be a matrix: its rows of length 1, and at right angles."""
    array = np.array(rows, float).reshape(-1, size, size)
    return bool((np.abs(array @ np.swapaxes(array, 1, 2) - np.eye(size)).max(axis=(1, 2)) < 0.1).all())


def _kinds(numbers, kind, doubt, name):
    count = numbers.shape[1]
    if kind is not None:
        if COUNTS[kind] != count:
            raise ValueError(f"the {name} side holds {count} numbers a pose; a {kind} takes {COUNTS[kind]}")
        kinds = (kind,)
    elif count == 4:
        kinds = ("quaternion",) if _all_unit(numbers, doubt) else ("axis and angle",)
    else:
        kinds = ("matrix",) if count == 9 else ("Euler angles", "rotation vector")
    if kinds == ("matrix",):
        _demand_orthogonal(numbers, doubt, name)
    elif kinds == ("quaternion",) and not _all_unit(numbers, max(doubt, 0.01)):
        worst = max(np.linalg.norm(numbers, axis=1), key=lambda size: abs(size - 1))
        raise ValueError(f"a quaternion of the {name} side has length {worst:.6g}, not 1")
    elif kinds == ("axis and angle",):
        if not any(_all_unit(axes, doubt) for axes in (numbers[:, :3], numbers[:, 1:])):
            size = np.linalg.norm(numbers[0])
            raise ValueError(
                f"the four numbers of the {name} side are neither a quaternion (their length is {size:.6g}, not 1) nor "
                f"an axis and its angle (neither the first three nor the last three make length 1)"
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
            else f"rows {row + 1} and {other + 1} have the product {products[row, other]:.6g}, not 0"
        )
        raise ValueError(f"matrix {which} of the {name} side is no rotation: {what}")
