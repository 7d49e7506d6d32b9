"""Candidates for an answer that are built from what a student holds: a question's
own data, and the course's functions.

Nothing here knows a question. A value has a sort: a number, a vector, a unit vector, a matrix, a
rotation. It begins with the numbers of the text, of the variant and of the open code; each step
applies a public function of the course's packages, or an operation of vectors and matrices, to
values of the sorts that it takes, which is found by trying. Every value has a price: that of what
it is made of, and that of the step. The cheap ones come first, and none comes twice. Whoever sets a
question gives what is needed: values that use all of the data come before others.
"""

import ast
import functools
import importlib
import inspect
import itertools
import math
import operator
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..checking.plugins import packages, plugins

Values: TypeAlias = NDArray[np.float64]
#: What the data that a value uses is called: a number whose bits stand for it, or one for each.
Uses: TypeAlias = "int | NDArray[np.int64]"
Shape: TypeAlias = tuple[int, ...]
#: The shape of a value, and whether it is a rotation or a unit vector.
Sort: TypeAlias = tuple[Shape, bool]
#: Values of one sort and price, and what each uses.
Priced: TypeAlias = tuple[list[Values], list[int]]
#: The same as arrays.
Arrays: TypeAlias = tuple[Values, NDArray[np.int64]]
Work: TypeAlias = Callable[..., Any]

#: Values that one step may give at one price, values in all, and
#: calls that a function needs for them.
MOST_OF_A_STEP, MOST, MOST_CALLS = 1_500, 100_000, 60
#: Calls of functions, in all.
MOST_CALLS_IN_ALL = 25_000
#: Values of one sort and price that a step is applied to: where it takes one, two or three.
TAKEN = {1: 4000, 2: 400, 3: 40}
#: The dearest values that are made.
DEAREST = 12
#: The dearest values of each dimension that are made where the answer is of another shape.
DEAREST_PART = (3, 5, 5, 1)
#: Single values after which a function that has refused each of them is left alone.
FEW = 3
#: As many numbers of a text all matter.
FEW_NUMBERS = 8
#: What a function costs whose words the text does not name.
UNNAMED = 3
#: Degrees, as texts write them.
DEGREES = re.compile(r"degree|°|\\circ")
NUMBER = r"-?\d+(?:\.\d+)?"
TUPLE = re.compile(rf"[\[(]\s*({NUMBER}(?:\s*,\s*{NUMBER})+)\s*[\])]")
FRACTION = re.compile(rf"\\[td]?frac\{{({NUMBER})\}}\{{({NUMBER})\}}|({NUMBER})\s*/\s*(\d+)")
#: A vector as a sum of unit vectors.
TERM = rf"([+-]?)\s*(?:{FRACTION.pattern}|({NUMBER}))?\s*\\hat\{{\w+\}}_([xyz])"
SUM = re.compile(rf"{TERM}(?:\s*{re.sub(r'[(](?![?])', '(?:', TERM)})+")
#: A matrix, and a table, as they stand in a text.
MATRIX = re.compile(r"\\begin\{[bp]?matrix\}(.*?)\\end|\\begin\{array\}\{[clr|]*\}(.*?)\\end", re.S)
ROWS = re.compile(r"(?:^\|.*\|[ ]*\n?){2,}", re.M)
#: Three axes in words: those of the text are tried first.
AXES = re.compile(r"\b([xyz])[-–, ]*([xyz])[-–, ]*([xyz])\b")
#: Numbers that stand in no text.
CONSTANTS = (0, 1, 2, np.pi, 3, np.sqrt(2), np.sqrt(3), 4, 60, 90, 180, 360, 1000, 9.81)


class Symbols(Protocol):
    """The symbols of a question, and the values of each at its points."""

    @property
    def points(self) -> Sequence[object]: ...

    @property
    def symbols(self) -> Sequence[str]: ...

    @property
    def values(self) -> Mapping[str, Values]: ...


class Step(NamedTuple):
    """A function of the course with its words chosen, or an operation; how many
    values it takes, and what it costs.
    """

    name: str
    work: Work
    arity: int
    shapes: tuple[int, ...] = ()
    price: int = 1


class Pool:
    """Values by sort and price, each once, with what data they use; each at
    all points: shape (points, ...).

    ``data`` counts what a question gives; what a value uses of it is a
    number whose bits stand for these.
    """

    def __init__(self, points: int, wanted: Sequence[Shape] = ()) -> None:
        self.points, self.wanted = points, wanted
        self.sorts: dict[Sort, dict[int, Priced]] = {}
        self.seen: set[tuple[Shape, bytes]] = set()
        self.data = self.calls = 0

    def of_new_data(self) -> int:
        """The bit of one more thing that the question gives."""
        self.data += 1
        return 1 << (self.data - 1)

    def add(self, values: Values, price: int, uses: Uses = 0) -> None:
        """Add an array of values, shape (values, points, ...); what they use
        is one number, or one for each.
        """
        values = np.asarray(values, dtype=float)
        if values.ndim < 2 or values.ndim > 5 or values.shape[1] != self.points or not values.size:
            return
        shape = values.shape[2:]
        dearest = DEAREST_PART[len(shape)] if shape not in self.wanted else price
        if math.prod(shape) > 48 or price > dearest:
            return
        flat = values.reshape(len(values), -1)
        good = np.asarray(np.isfinite(flat).all(axis=1))
        good[good] = np.abs(flat[good]).max(axis=1) < 1e9
        used = np.broadcast_to(uses, len(values))[good].tolist()
        values, flat = values[good], np.round(flat[good], 8) + 0.0
        special, size, packed = _special(values).tolist(), flat[:1].nbytes, flat.tobytes()
        for place in range(len(values)):
            known = shape, packed[place * size : (place + 1) * size]
            if known not in self.seen:
                self.seen.add(known)
                at_price = self.sorts.setdefault((shape, special[place]), {}).setdefault(
                    price, ([], [])
                )
                at_price[0].append(values[place])
                at_price[1].append(used[place])

    def add_whole(self, values: Values, price: int, uses: Uses = 0) -> None:
        """Add values like :meth:`add`, and the rows and entries that they are made of."""
        self.add(values, price, uses)
        if values.ndim > 2 and values.size:
            rows = np.moveaxis(values[:, :, :12], 2, 1)
            uses = np.repeat(np.broadcast_to(uses, len(values)), rows.shape[1])
            self.add_whole(rows.reshape(-1, *rows.shape[2:]), price + (values.ndim == 4), uses)

    def of_shape(
        self,
        shape: Shape,
        only_special: bool = False,
        price: int | None = None,
        whole: bool | None = None,
    ) -> list[Values]:
        """All values of a shape, the cheap ones first, or those of one
        price: shape (values, points, ...).

        With ``whole`` those that use all of the data, or those that do not.
        """
        found = [
            (cost, values, uses)
            for (one_shape, special), by_price in self.sorts.items()
            if one_shape == shape and special >= only_special
            for cost, (values, uses) in by_price.items()
            if price in (None, cost)
        ]
        everything = (1 << self.data) - 1
        return [
            value
            for _, values, uses in sorted(found, key=lambda one: one[0])
            for value, used in zip(values, uses, strict=True)
            if whole in (None, used == everything)
        ]


def _special(values: Values) -> NDArray[np.bool_]:
    """Which values are rotations, or unit vectors, at each point."""
    shape = values.shape[2:]
    special = np.zeros(len(values), dtype=bool)
    if shape == (3, 3):
        off = np.abs(values @ np.swapaxes(values, -1, -2) - np.eye(3)).max(axis=(1, 2, 3))
        special[off < 1e-9] = np.linalg.det(values[off < 1e-9]).min(axis=1) > 0
    elif shape in ((3,), (4,)):
        special = np.abs((values**2).sum(-1) - 1).max(axis=1) < 1e-9
    return special


#: What is made of all rows of a list, and of all of its entries.
OF_ROWS = tuple(functools.partial(work, axis=0) for work in (np.sum, np.mean, np.max, np.min)) + (
    operator.itemgetter(0),
    operator.itemgetter(-1),
)
OF_ENTRIES = (np.sum, np.mean, np.max, np.min, np.median, np.prod, np.std, len, *OF_ROWS[-2:])


# --- where it begins ------------------------------------------------------------------------------


def beginning(
    at: Symbols, given: Mapping[str, object], text: str, code: str, wanted: Sequence[Shape]
) -> Pool:
    """The pool of what a student holds: symbols, the numbers of a variant,
    of the text and of the open code.
    """
    pool, in_degrees = Pool(len(at.points), wanted), DEGREES.search(text)

    def add(value: Any, price: int = 1, uses: int | None = None) -> None:
        if isinstance(value, (str, bool)) or value is None or value is Ellipsis:
            return
        try:
            value = np.asarray(value, dtype=float)
        except (TypeError, ValueError):
            for part in value if isinstance(value, (list, tuple)) else ():
                add(part, price, uses)
            return
        uses = pool.of_new_data() if uses is None else uses
        value = np.broadcast_to(value, (pool.points, *value.shape))
        pool.add_whole(value[None], price, uses)
        if in_degrees:
            pool.add_whole(np.radians(value)[None], price, uses)
        if value.ndim == 3 and value.shape[1] % 2 == 0:
            # Rows that belong together: every other one, or half of them.
            half = value.shape[1] // 2
            for rows in (slice(0, None, 2), slice(1, None, 2), slice(half), slice(half, None)):
                pool.add(value[None, :, rows], price, uses)
        if value.ndim > 1:
            with np.errstate(all="ignore"):
                pool.add_whole(_unit(value)[None], price, uses)

    for name in at.symbols:
        pool.add(at.values[name][None], 1, pool.of_new_data())
    for value in given.values():
        add(value)
    has_data = pool.data > 0
    for table in _tables_in(text):
        add(table, uses=0 if has_data else None)
    for value in _literals(code):
        add(value, uses=0 if has_data else None)
    for found in TUPLE.finditer(text):
        add([float(part) for part in found[1].split(",")], uses=0)
    for found in SUM.finditer(text):
        components = [0.0, 0.0, 0.0]
        for sign, above, below, over, under, whole, axis in re.findall(TERM, found[0]):
            size = float(above or over or whole or 1) / (
                float(below or under) if above or over else 1
            )
            components["xyz".index(axis)] += -size if sign == "-" else size
        add(components, uses=0)
    for above, below, over, under in FRACTION.findall(text):
        add(float(above or over) / (float(below or under) or 1), uses=0)
    written = list(dict.fromkeys(re.findall(NUMBER, text)))
    for number in written:
        add(float(number), 1 if len(written) <= FEW_NUMBERS else 2, uses=0)
    for value in pool.of_shape(())[:30]:
        pool.add(np.radians(value)[None], 2)
    _add_constants(pool)
    # What stands as separate numbers may be meant as one triple, of angles or of
    # components, most likely in order.
    values, bits = pool.sorts.get(((), False), {}).get(1, ([], []))
    numbers, used = np.array(values[:8]), np.array(bits[:8])
    for size in (3, 4):
        for start in range(len(numbers) - size + 1):
            uses = np.bitwise_or.reduce(used[start : start + size])
            pool.add(np.moveaxis(numbers[start : start + size], 0, -1)[None], 2, uses)
        orders = list(itertools.permutations(range(len(numbers[:6])), size))
        if orders:
            pool.add(
                np.moveaxis(numbers[orders], 1, -1), 5, np.bitwise_or.reduce(used[orders], axis=1)
            )
    # A turn through one of them about one axis is written with noughts.
    for value, uses in zip(numbers, used, strict=True):
        pool.add(np.eye(3)[:, None, :] * value[None, :, None], 2, uses)
    return pool


def _tables_in(text: str) -> Iterator[list[list[float | None]]]:
    """The numbers of the matrices and tables of a text, as far as they are numbers."""
    for found in MATRIX.finditer(text):
        yield [
            [_number(entry) for entry in row.split("&")]
            for row in (found[1] or found[2]).replace("\n", " ").split("\\\\")
            if row.strip()
        ]
    for found in ROWS.finditer(text):
        rows = [
            [_number(entry) for entry in row.strip(" |").split("|")]
            for row in found[0].strip().splitlines()
        ]
        rows = [[entry for entry in row if entry is not None] for row in rows]
        yield [row for row in rows if row]


def _number(text: str) -> float | None:
    """The number that an entry is, or ``None``: a fraction is a number, too."""
    text = text.replace("$", "").replace(" ", "")
    found = FRACTION.fullmatch(text.lstrip("-"))
    if found:
        above, below, over, under = found.groups()
        return (-1 if text.startswith("-") else 1) * float(above or over) / float(below or under)
    return float(text) if re.fullmatch(NUMBER, text) else None


def of_arguments(calls: Sequence[Sequence[Any]], wanted: Sequence[Shape]) -> Pool:
    """The pool of the arguments that a function is called with, where
    they have one shape in all calls.
    """
    pool = Pool(len(calls), wanted)
    for column in zip(*calls, strict=False):
        uses = pool.of_new_data()
        try:
            given = [np.asarray(argument, dtype=float) for argument in column]
            if len({argument.shape[1:] for argument in given}) == 1 and given[0].ndim:
                # Lists of several lengths have in common what is made of all of their entries.
                for work in OF_ENTRIES if given[0].ndim == 1 else ():
                    pool.add(np.array([work(list_) for list_ in given], dtype=float)[None], 2, uses)
                for work in OF_ROWS if given[0].ndim > 1 else ():
                    pool.add(np.array([work(rows) for rows in given])[None], 2, uses)
            pool.add_whole(np.array(given, dtype=float)[None], 1, uses)
        except (TypeError, ValueError, IndexError):
            continue
    _add_constants(pool)
    return pool


def _add_constants(pool: Pool) -> None:
    for place, number in enumerate(CONSTANTS):
        pool.add(np.full((1, pool.points), number), 2 if place < 4 else 4)
    for size in (3, 4):
        for place in range(size):
            pool.add(np.broadcast_to(np.eye(size)[place], (1, pool.points, size)), 2)
    pool.add(np.broadcast_to(np.eye(3), (1, pool.points, 3, 3)), 3)


def _literals(code: str) -> Iterator[object]:
    """Numbers and lists of numbers that stand in code, as whole as they stand."""
    try:
        waiting: list[ast.AST] = [ast.parse(code)]
    except SyntaxError:
        return
    while waiting:
        node = waiting.pop()
        try:
            yield ast.literal_eval(node)
        except (ValueError, TypeError, SyntaxError, MemoryError, RecursionError):
            waiting += ast.iter_child_nodes(node)


# --- steps ----------------------------------------------------------------------------------------


def _unit(v: Values) -> Values:
    unit: Values = v / np.linalg.norm(v, axis=-1, keepdims=True)
    return unit


def _dot(v: Values, w: Values) -> Values:
    product: Values = (v * w).sum(-1)
    return product


def _turn_round(m: Values) -> Values:
    return np.swapaxes(m, -1, -2)


def _angle(v: Values, w: Values) -> Values:
    return np.arccos(np.clip(_dot(_unit(v), _unit(w)), -1, 1))


def _vee(m: Values) -> Values:
    """What of a matrix changes its sign with the transpose, as a vector."""
    return (
        np.stack(
            [m[..., 2, 1] - m[..., 1, 2], m[..., 0, 2] - m[..., 2, 0], m[..., 1, 0] - m[..., 0, 1]],
            -1,
        )
        / 2
    )


def _inverse(m: Values) -> Values:
    """The inverse; not a number where there is none, so that the others
    of a batch are found all the same.
    """
    singular = np.abs(np.linalg.det(m)) < 1e-12
    return np.where(
        singular[..., None, None],
        np.nan,
        np.linalg.inv(np.where(singular[..., None, None], np.eye(3), m)),
    )


def _crossed(v: Values) -> Values:
    x, y, z = np.moveaxis(v, -1, 0)
    o = 0 * x
    return np.stack(
        [np.stack([o, -z, y], -1), np.stack([z, o, -x], -1), np.stack([-y, x, o], -1)], -2
    )


def _outer(v: Values, w: Values) -> Values:
    return v[..., :, None] * w[..., None, :]


def _wrapped(turn: float) -> Work:
    return lambda v: np.remainder(v + turn / 2, turn) - turn / 2


def _other_way(half: float, proper: bool) -> Work:
    """The other triple of angles of the same orientation."""
    return lambda v: np.stack(
        [v[..., 0] + half, -v[..., 1] if proper else half - v[..., 1], v[..., 2] + half], -1
    )


def _entry(*place: int | slice) -> Work:
    return lambda v: v[(..., *place)]


def _without_sign(place: int, size: int) -> Work:
    signs = np.where(np.arange(size) == place, -1, 1)
    return lambda v: v * signs if v.shape[-1] == size else 1 / 0


WRAPS = (
    _wrapped(2 * np.pi), _wrapped(360), _other_way(np.pi, True), _other_way(np.pi, False),
    _other_way(180, True), _other_way(180, False),
)  # fmt: skip


def _quotient(p: Values, q: Values) -> Values:
    """The quaternion from q to p, and from p to q."""
    p = np.concatenate([p[..., :1], -p[..., 1:]], -1)
    scalar = p[..., :1] * q[..., :1] - _dot(p[..., 1:], q[..., 1:])[..., None]
    vector = p[..., :1] * q[..., 1:] + q[..., :1] * p[..., 1:] + np.cross(p[..., 1:], q[..., 1:])
    return np.concatenate([scalar, vector], -1)


def _steps(price: int, shapes: tuple[int, ...], *works: Work) -> tuple[Step, ...]:
    return tuple(Step("", work, len(shapes), shapes, price) for work in works)


#: Numbers are shape 0 here, vectors 1, matrices 2.
NUMBERS_ALONE = (
    np.negative, np.degrees, np.sin, np.cos, lambda x: x / 2, np.tan, np.sqrt, np.square,
    np.reciprocal, np.radians, np.arccos, np.arcsin, np.arctan, lambda x: 2 * x,
    lambda x: np.pi - x, lambda x: np.pi / 2 - x, lambda x: 1 - x, lambda x: np.exp(-x),
    lambda x: np.sqrt(1 - x * x), lambda x: x**3, np.abs,
)  # fmt: skip
OPERATIONS = (
    *_steps(1, (0,), *NUMBERS_ALONE[:4]),
    *_steps(2, (0,), *NUMBERS_ALONE[4:]),
    *_steps(1, (1,), np.negative, _unit, np.degrees, lambda v: np.linalg.norm(v, axis=-1)),
    *_steps(2, (1,), *WRAPS),
    *_steps(
        2, (1,), lambda v: np.roll(v, 1, -1), lambda v: np.roll(v, -1, -1), lambda v: v[..., ::-1],
        np.radians, lambda v: np.concatenate([v[..., :1], -v[..., 1:]], -1), lambda v: v / 2,
        lambda v: v.sum(-1), _crossed, np.diff, np.arccos, np.arcsin, np.sin, np.cos, np.square,
        np.abs, *(_entry(place) for place in range(4)),
        *(_without_sign(place, 3) for place in range(3)),
    ),
    *_steps(1, (2,), _turn_round, _inverse, _vee),
    *_steps(
        2, (2,), np.negative, np.linalg.det, lambda m: np.trace(m, axis1=-2, axis2=-1), _unit,
        lambda m: m.mean(-2), lambda m: np.linalg.svd(m, compute_uv=False), lambda m: m.sum(-2),
        lambda m: np.linalg.norm(m, axis=-1), lambda m: _turn_round(m)[..., ::-1, :],
        lambda m: np.diagonal(m, axis1=-2, axis2=-1), lambda m: np.linalg.norm(m, axis=(-2, -1)),
        lambda m: (np.trace(m, axis1=-2, axis2=-1) - 1) / 2, lambda m: np.linalg.eigvalsh(m),
        lambda m: np.linalg.eigh(m)[1][..., -1], lambda m: m - np.eye(3), lambda m: m + np.eye(3),
        lambda m: m * np.sign(np.diagonal(m, axis1=-2, axis2=-1))[..., None],
        *(_entry(row, slice(None)) for row in range(3)),
        *(_entry(slice(None), column) for column in range(3)),
    ),
    *_steps(3, (2,), *(_entry(row, column) for row in range(3) for column in range(3))),
    *_steps(1, (0, 0), np.multiply, np.divide, np.add, np.subtract),
    *_steps(
        2, (0, 0), np.arctan2, np.hypot, lambda x, y: np.sqrt(x * x - y * y),
        lambda x, y: x * np.sin(y), lambda x, y: x * np.cos(y), lambda x, y: x * np.tan(y),
        lambda x, y: np.arccos(x / y),
    ),
    *_steps(1, (1, 1), np.cross, _dot, _angle, np.add, np.subtract, _quotient, _outer),
    *_steps(
        1, (1, 1), lambda v, w: np.stack(np.broadcast_arrays(v, w), -2),
        lambda v, w: np.cross(v, np.cross(w, v)), lambda v, w: _unit(np.cross(v, w)),
        lambda v, w: _unit(v + w),
    ),
    *_steps(
        2, (1, 1), np.multiply, lambda v, w: (v + w) / 2,
        lambda v, w: v - _dot(v, _unit(w))[..., None] * _unit(w),
    ),
    *_steps(1, (0, 1), lambda x, v: x[..., None] * v, lambda x, v: v / x[..., None]),
    *_steps(1, (0, 2), lambda x, m: x[..., None, None] * m, lambda x, m: m / x[..., None, None]),
    *_steps(
        1, (2, 1), lambda m, v: np.einsum("...ij,...j->...i", m, v),
        lambda m, v: np.einsum("...ji,...j->...i", m, v),
        lambda m, v: np.einsum("...ij,...j->...i", _inverse(m), v),
    ),
    *_steps(1, (2, 2), np.matmul, lambda m, n: m @ _turn_round(n), lambda m, n: _turn_round(m) @ n),
    *_steps(1, (2, 2), np.add, np.subtract),
    *_steps(1, (1, 1, 1), lambda v, w, u: np.stack(np.broadcast_arrays(v, w, u), -2)),
    *_steps(1, (2, 2, 2), lambda m, n, k: m + n + k, lambda m, n, k: m @ n @ k),
    *_steps(
        2, (0, 0, 0), lambda x, y, z: np.stack(np.broadcast_arrays(x, y, z), -1),
        lambda x, y, z: x * y / z, lambda x, y, z: x + y + z,
    ),
)  # fmt: skip

#: With these and the functions alone one gets further before there are too many values.
TURNS = (
    *_steps(1, (1,), np.negative),
    *_steps(1, (2,), _turn_round),
    *_steps(1, (1, 1), _quotient),
    *_steps(1, (2, 2), np.matmul),
    *_steps(1, (2, 1), lambda m, v: np.einsum("...ij,...j->...i", m, v)),
    *_steps(2, (1,), np.degrees),
    *_steps(2, (0, 1), lambda x, v: v / x[..., None]),
)


@functools.cache
def public_functions() -> list[Step]:
    """The public functions of the course's packages, once for each
    choice of the words that they need.
    """
    words: dict[str, Sequence[str]] = {}
    steps: list[Step] = []
    for plugin in plugins():
        words |= getattr(plugin, "WORDS", {})
    for package in packages():
        module = importlib.import_module(package)
        for name in getattr(module, "__all__", ()):
            if inspect.isfunction(getattr(module, name)):
                steps += _steps_of(name, getattr(module, name), words)
    return steps


def _steps_of(name: str, function: Work, words: Mapping[str, Sequence[str]]) -> Iterator[Step]:
    needed = [
        one for one in inspect.signature(function).parameters.values() if one.default is one.empty
    ]
    spoken = [one.name for one in needed if one.name in words]
    arity = len(needed) - len(spoken)
    if not 1 <= arity <= 3 or any(one.kind is not one.POSITIONAL_OR_KEYWORD for one in needed):
        return
    for chosen in itertools.product(*(words[one] for one in spoken)):
        said = dict(zip(spoken, chosen, strict=True))

        def work(*values: Values, said: Mapping[str, str] = said) -> Any:
            left = iter(values)
            return function(*(said[one.name] if one.name in said else next(left) for one in needed))

        yield Step(" ".join([name, *chosen]), work, arity)


def priced(steps: Iterable[Step], text: str) -> list[Step]:
    """Steps with their prices: functions whose axes the text does not name are dearer."""
    named = {"".join(found).lower() for found in AXES.findall(text)}
    return [
        step._replace(price=UNNAMED)
        if len(words := step.name.split()[1:]) and len(words[0]) == 3 and words[0] not in named
        else step
        for step in steps
    ]


# --- what is near to a value ----------------------------------------------------------------------


def near(value: Values) -> Values:
    """What differs little from a value: shape (points, ...), and
    (values, points, ...) of the result.

    Tried where a value turns out to be a mistake, since most mistakes are one
    sign, one order or one unit away.
    """
    shape = value.shape[1:]
    whole = [factor * value for factor in (-1, np.pi / 180, 180 / np.pi, 2, 0.5, 1000, 0.001)]
    if shape == (3, 3):
        frames = _frames()
        both = [value, np.swapaxes(value, -1, -2)]
        return np.array(
            [first @ one @ second for one in both for first in frames for second in frames] + whole
        )
    if len(shape) == 1 and shape[0] <= 4:
        orders = list(itertools.permutations(range(shape[0])))
        signs = np.array(list(itertools.product((1, -1), repeat=shape[0])))
        units = [1, np.pi / 180, 180 / np.pi, 2, 0.5]
        turned = [
            value[:, order] * sign * unit for unit in units for order in orders for sign in signs
        ]
        wraps = [work(value) for work in WRAPS] if shape[0] == 3 else []
        return np.array(
            [
                *turned,
                *wraps,
                *(_wrapped(turn)(one) for turn in (2 * np.pi, 360) for one in turned[:48]),
            ]
        )
    if len(shape) == 1:
        turned = [
            value * np.where(np.isin(np.arange(shape[0]), some), -1, 1)
            for some in _some_of(shape[0])
        ]
        swaps = [value[:, order] for order in _swaps(shape[0])]
        return np.array([*turned, *swaps, *whole])
    if shape:
        return np.array(whole)
    shifts = [
        value + one for one in (np.pi, -np.pi, np.pi / 2, -np.pi / 2, 90, -90, 180, -180, 1, -1)
    ]
    return np.array(
        [*whole, *shifts, *(work(value) for work in NUMBERS_ALONE), *(1 - one for one in whole)]
    )


@functools.cache
def _frames() -> list[Values]:
    """The 24 rotations that bring three axes onto three axes, and their mirror images."""
    return [
        np.eye(3)[list(order)] * np.array(sign)[:, None]
        for order in itertools.permutations(range(3))
        for sign in itertools.product((1, -1), repeat=3)
        if round(np.linalg.det(np.eye(3)[list(order)]) * np.prod(sign)) == 1
    ] + [np.diag(sign) for sign in itertools.product((1, -1), repeat=3) if np.prod(sign) == -1]


def _some_of(size: int) -> list[tuple[int, ...]]:
    return [some for count in (1, 2) for some in itertools.combinations(range(size), count)]


def _swaps(size: int) -> Iterator[list[int]]:
    for first, second in itertools.combinations(range(size), 2):
        order = list(range(size))
        order[first], order[second] = second, first
        yield order


def by_price(pool: Pool, steps: Iterable[Step], most: int = MOST) -> Iterator[int]:
    """Make all values of a price from cheaper ones, price by price; yields the
    price, first that of what is given.
    """
    yield from (1, 2)
    refused: set[tuple[Step, tuple[Sort, ...]]] = set()
    made: dict[Sort, dict[int, Arrays]] = {}
    for price in range(2, DEAREST):
        # What costs less than this is there by now.
        for sort, values in pool.sorts.items():
            of_sort = made.setdefault(sort, {})
            for one, (some, uses) in values.items():
                if one < price and one not in of_sort:
                    of_sort[one] = (
                        np.array(some[: max(TAKEN.values())]),
                        np.array(uses[: max(TAKEN.values())]),
                    )
        for step in steps:
            sorts_of = [
                [sort for sort in made if not step.shapes or len(sort[0]) == step.shapes[place]]
                for place in range(step.arity)
            ]
            for sorts in itertools.product(*sorts_of) if price - step.price >= step.arity else ():
                if len(pool.seen) >= most or step.name and pool.calls > MOST_CALLS_IN_ALL:
                    break
                if (step, sorts) in refused:
                    continue
                for prices in _sums(price - step.price, [made[sort] for sort in sorts]):
                    chosen = [made[sort][one] for sort, one in zip(sorts, prices, strict=True)]
                    if not _apply(pool, chosen, step, price):
                        refused.add((step, sorts))
                        break
        yield price
        if len(pool.seen) >= most:
            return


def _sums(whole: int, allowed: Sequence[Mapping[int, object]]) -> list[tuple[int, ...]]:
    """All lists of numbers that make a sum, each of those that are allowed in its place."""
    if len(allowed) == 1:
        return [(whole,)] if whole in allowed[0] else []
    return [
        (first, *rest)
        for first in allowed[0]
        if first < whole
        for rest in _sums(whole - first, allowed[1:])
    ]


def _apply(pool: Pool, chosen: Sequence[Arrays], step: Step, price: int) -> bool:
    """Apply a step to values of some prices, all at once. Whether it can."""
    lengths = [min(len(values), TAKEN[step.arity]) for values, _ in chosen]
    while np.prod(lengths) > MOST_OF_A_STEP:
        lengths[int(np.argmax(lengths))] //= 2
    # What is made of the first values comes first.
    places = np.indices(lengths).reshape(len(lengths), -1)
    places = places[:, np.argsort(places.sum(axis=0), kind="stable")]
    values = [values[one] for (values, _), one in zip(chosen, places, strict=True)]
    uses = functools.reduce(
        np.bitwise_or, [uses[one] for (_, uses), one in zip(chosen, places, strict=True)]
    )
    if not step.name:
        found = _parts(step.work, values, len(values[0]), pool.points)
        for part in found:
            pool.add(part, price, uses)
        return bool(found)
    by_shape: dict[Shape, list[Arrays]] = {}
    for rows, parts in _called(step.work, values, pool):
        for part in parts:
            by_shape.setdefault(part.shape[2:], []).append((part, uses[rows]))
    for of_shape in by_shape.values():
        together = np.concatenate([part for part, _ in of_shape])
        used = np.concatenate([used for _, used in of_shape])
        pool.add(together, price, used)
        pool.add_whole(together, price + 1, used)
    return bool(by_shape)


def _parts(work: Work, values: Sequence[Values], *begin: int) -> list[Values]:
    """What a step gives for all values at once, each part of it, as far as
    their shapes begin so; or nothing.
    """
    try:
        found = work(*values)
        found = [
            np.asarray(part, dtype=float)
            for part in (found if isinstance(found, tuple) else (found,))
        ]
    except Exception:  # whatever a function says to what it was not made for
        return []
    return [part for part in found if part.shape[: len(begin)] == begin]


def _called(
    function: Work, values: Sequence[Values], pool: Pool
) -> Iterator[tuple[slice, list[Values]]]:
    """What a function of the course gives: rows, and the parts of what it gives for them.

    Most take a batch, which must have more rows than a vector has numbers. It is tried on one
    value, then on more and more at once, and on fewer again where one of them is refused.
    """
    points, first, size = pool.points, 0, 1
    refused = 0.0
    for _ in range(MOST_CALLS):
        pool.calls += 1
        last = min(first + size, len(values[0]))
        count, some = (
            last - first,
            [value[first:last].reshape(-1, *value.shape[2:]) for value in values],
        )
        parts = (
            _parts(function, some, len(some[0]))
            if len(some[0]) > 4 or points > 1 and count == 1
            else []
        )
        if not parts and count == points == 1:
            parts = [part[None] for part in _parts(function, [value[0] for value in some])]
        if parts:
            yield (
                slice(first, last),
                [part.reshape(count, points, *part.shape[1:]) for part in parts],
            )
            first, size, refused = last, 4 * size, -math.inf
        elif count > 1:
            size = max(1, count // 8)
        else:
            first, refused = last, refused + 1
        if first == len(values[0]) or refused == FEW:
            return
