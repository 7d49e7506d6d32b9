"""The values at which the symbols of a question are compared.

They depend on the question's own salt, so the author's machine and every student's use the same.
"""

import functools
import hashlib
import json
import math
from collections.abc import Callable
from typing import Any

from .evaluate import MP
from .question import Question

# Enough points that each angle is in all four quadrants, and that no two signs of sines and cosines
# always agree.
POINTS = 5
# The default range of an angle: in all four quadrants, so that no root is taken for the cosine it
# equals in the first one, and within a half turn, where half-angle forms hold.
ANGLES = (-3.0, 3.0)
# Letters that have two forms in SymPy and one in handwriting.
TWINS = {"phi": "varphi", "varphi": "phi", "epsilon": "varepsilon", "varepsilon": "epsilon"}
# Spellings of a derivative with respect to time, ``theta'``, as a symbol.
RATES = ("{}dot", "{}_dot", "dot_{}", "d{}", r"\dot{{{}}}", r"\dot{{\{}}}")
# Tries to place the points well; within one quadrant there is nothing to choose.
MOST_TRIES = 200


def spellings(name: str) -> list[str]:
    """Return the other spellings of a symbol's name."""
    if name.endswith("'"):
        letter = name.rstrip("'")
        order = name[len(letter) :]
        letters = [letter, *spellings(letter)]
        rates = (
            [rate.format(spelling) for spelling in letters for rate in RATES]
            if order == "'"
            else []
        )
        return [*(f"{spelling}{order}" for spelling in letters[1:]), *rates]
    return [TWINS[name]] if name in TWINS else []


def points(question: Question) -> list[dict[str, Any]]:
    """Return the points of a question: dictionaries from the names of its symbols to numbers."""
    if not question.symbols:
        return [{}]
    asked = json.dumps([question.salt, sorted(question.symbols.items()), question.unit])
    return [dict(point) for point in _points(asked)]


@functools.lru_cache(256)
def _points(asked: str) -> list[dict[str, Any]]:
    salt, symbols, unit = json.loads(asked)
    placed = _placed(salt, [limits for _, limits in symbols])
    placed_points = []
    for row in placed:
        point = {name: value for (name, _), value in zip(symbols, row)}
        for group in unit:
            length = MP.sqrt(sum(point[name] ** 2 for name in group))
            point.update({name: point[name] / length for name in group})
        for name in list(point):
            for spelling in spellings(name):
                point.setdefault(spelling, point[name])
        placed_points.append(point)
    return placed_points


def _placed(salt: str, ranges: list[tuple[float, float]]) -> list[tuple[Any, ...]]:
    """Return rows of values, one for each point.

    No two signs of sines and cosines agree at all of them.
    """
    best: list[list[Any]] = []
    most = -1
    for attempt in range(MOST_TRIES):
        columns = [
            _column(f"{salt} {attempt} {order}", *limits) for order, limits in enumerate(ranges)
        ]
        signs = [
            _signs(function, column) for column in columns for function in (math.sin, math.cos)
        ]
        changing = [sign for sign in signs if len(set(sign)) > 1]
        different = len(set(changing))
        if different > most:
            best, most = columns, different
        if different == len(changing):
            break
    return list(zip(*best))


def _signs(function: Callable[[Any], float], column: list[Any]) -> tuple[bool, ...]:
    signs = [function(value) >= 0 for value in column]
    # A sign and its opposite count as one: the product of the two never changes.
    return tuple(sign == signs[0] for sign in signs)


def _column(seed: str, low: float, high: float) -> list[Any]:
    """Return one value for each point, in every quadrant that the range overlaps."""
    first, last = MP.mpf(low), MP.mpf(high)
    quarter = MP.pi / 2
    inner = range(int(MP.floor(first / quarter)) + 1, int(MP.ceil(last / quarter)))
    edges = [first, *(number * quarter for number in inner), last]
    parts = list(zip(edges, edges[1:]))
    parts.sort(key=lambda part: _share(f"{seed} part {MP.nstr(part[0], 8)}"))
    kinds: dict[int, tuple[Any, Any]] = {}
    for part in parts:
        kinds.setdefault(int(MP.floor((part[0] + part[1]) / 2 / quarter)) % 4, part)
    chosen = [*kinds.values(), *parts, *parts, *parts, *parts, *parts][:POINTS]
    chosen = sorted(enumerate(chosen), key=lambda place: _share(f"{seed} place {place[0]}"))
    return [
        # Avoid the edges of a part: there a form may be undefined, or two different ones nearly
        # agree.
        start + (MP.mpf("0.06") + MP.mpf("0.88") * _share(f"{seed} value {number}")) * (end - start)
        for number, (start, end) in chosen
    ]


def _share(seed: str) -> Any:
    return int.from_bytes(hashlib.sha256(seed.encode()).digest()[:12]) / MP.mpf(2) ** 96
