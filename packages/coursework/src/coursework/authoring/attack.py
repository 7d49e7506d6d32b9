"""An attack on the seal of a question, with what a student has: its public part and its lockers.

What can be checked without a server can be tried without one; how often one must try is found here
by trying. Candidates come in an order in which somebody would try them who knows the subject and
wants no work: turns about the axes through the symbols, in every order and sign; special angles and
the numbers of the question's text; monomials of sines and cosines and their sums; small fractions
and roots; all words. A candidate that opens the locker of a mistake is looked at closer, since its
message tells what to change: every candidate that differs from it in one choice is tried next. (So
do those who climb by the replies.)

Each distinct candidate costs one slow hash. The author knows the fingerprints, so here none is
hashed, and the number of hashes is counted exactly all the same: :func:`really_attack` spends them,
to prove the count.

"Not found" means not found within the budget by these candidates. Somebody may have a better idea:
the count is an upper bound of what an attacker needs where an answer is found, and no proof of
strength where it is not.
"""

import importlib.util
import itertools
import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..checking import sealing
from ..checking.kinds import PARTS, sign_limit
from ..checking.plugins import kinds, plugins
from ..checking.points import points
from ..checking.question import Question, Sealed
from ..checking.reading import EXACT, EXACT_WIDTH, FAR, NEAR, calls_for, tolerances
from ..checking.reading import offsets as offsets_of
from ..checking.units import unit
from . import typed

if TYPE_CHECKING:
    from .author import AuthoredQuestion

#: Choices, one row for each candidate.
Choices: TypeAlias = NDArray[np.int64]
#: The numbers of candidates, a row for each as they are read of an answer.
Numbers: TypeAlias = NDArray[np.float64]
#: These, or for an answer in words the word of each candidate, ``None`` where it is none.
Candidates: TypeAlias = "Numbers | list[str | None]"
#: The cells of a candidate as bytes, or its word.
Key: TypeAlias = bytes | str
#: What a fingerprint opens: 1 the right answer, 2 a mistake, 0 nothing.
Open: TypeAlias = Callable[[str], int]

#: What parts the words of a question from the open code of its cell.
CODE = "\n\n```python\n"
#: To be raised when the attack gets better: what an older one has measured is measured again then.
VERSION = 2
#: Slow hashes that the attack on one question may need; a question
#: beyond it counts as not guessable.
BUDGET = 2**16
#: Candidates that are worked out together, and those that are tried
#: before another idea has its turn.
CHUNK, PORTION = 8192, 256
#: Answers that are orientations: of what is built only that is tried which is one.
ROTATIONS = ("direction cosine matrix", "quaternion", "Euler angles", "axis and angle")
#: Of so many values each part of an answer is taken, again and again while there are more; numbers
#: that a vector is put together of one by one.
PARTS_TRIED, MOST_PARTS = (6, 12, 24, 40, 150), 5


class Found(NamedTuple):
    """What came of an attack.

    ``tries`` is the number of slow hashes up to and with the one that opened the right answer, or,
    where it was not found, the number of all candidates; ``way`` is the generator that found it, or
    empty.
    """

    tries: int
    way: str

    def __str__(self) -> str:
        if not self.tries:
            return "there is nothing to try a guess on"
        if self.way:
            return f"found after {self.tries} slow hashes ({self.way})"
        return f"not found within {self.tries} slow hashes"


class Family(NamedTuple):
    """Candidates that are made by some choices: how many there are of each, and what they give.

    ``evaluate`` takes choices, one row for each candidate, and gives its
    numbers as they are read of an answer.
    """

    name: str
    sizes: tuple[int, ...]
    evaluate: Callable[[Choices], Candidates]
    by_shells: bool = False
    near: Callable[[Sequence[int]], Numbers] | None = (
        None  # the numbers of what is beside a choice, where no choices are beside it
    )

    def orders(self) -> Iterator[Choices]:
        """All choices, some thousand rows at a time."""
        if self.by_shells:
            yield from _shells(self.sizes)
            return
        count = math.prod(self.sizes)
        for start in range(0, min(count, 16 * BUDGET), CHUNK):
            rows = np.arange(start, min(count, start + CHUNK))
            columns = []
            for size in reversed(self.sizes):
                columns.append(rows % size)
                rows = rows // size
            yield np.stack(columns[::-1], axis=1)

    def beside(self, choice: Sequence[int]) -> Choices:
        """All choices that differ from one in a single place."""
        rows = []
        for place, size in enumerate(self.sizes):
            for other in range(min(size, 200)):
                if other != choice[place]:
                    rows.append([*choice[:place], other, *choice[place + 1 :]])
        return np.array(rows, dtype=int).reshape(-1, len(self.sizes))


def _shells(sizes: Sequence[int]) -> Iterator[Choices]:
    """All choices, those first in which every choice is among the first few."""
    for largest in range(max(sizes)):
        limited = [min(size, largest + 1) for size in sizes]
        if math.prod(limited) > 4 * BUDGET:
            return
        rows = np.stack(np.meshgrid(*(np.arange(size) for size in limited), indexing="ij"), axis=-1)
        rows = rows.reshape(-1, len(sizes))
        yield rows[rows.max(axis=1) == largest]


# --- the attack ---------------------------------------------------------------------------------


def attack(question: "AuthoredQuestion", text: str = "", budget: int = BUDGET) -> Found:
    """Attack a :class:`coursework.authoring.author.AuthoredQuestion` and
    count the slow hashes that it takes.

    Parameters
    ----------
    question : AuthoredQuestion
    text : str
        What the student is asked, in words: its numbers are tried.
    budget : int
    """
    right = {known for known, entry in question.entries.items() if entry.outcome == "correct"}
    mistaken = set(question.entries) - right
    return _attack(
        question.public,
        text,
        budget,
        lambda known: 1 if known in right else 2 if known in mistaken else 0,
    )


def really_attack(sealed: Sealed, text: str = "", budget: int = 100) -> Found:
    """The same attack with the slow hash on what a student has;
    only ``budget`` hashes are spent.
    """

    def open_(known: str) -> int:
        locker = sealing.open_locker(sealed.lockers, sealing.slow_key(sealed.question.salt, known))
        return 0 if locker is None else 1 if locker[0] == 0 else 2

    return _attack(sealed.question, text, budget, open_)


def _attack(public: Question, text: str, budget: int, open_: Open) -> Found:
    """Try candidates until one is right. ``open_`` says of a fingerprint:
    1 right, 2 a mistake, 0 neither.
    """
    tried: set[Key] = set()
    for family, choices in _in_turns(public, text) if budget else ():
        with np.errstate(all="ignore"):
            known = _keys_of(public, family.evaluate(choices))
        for choice, key in zip(choices.tolist(), known, strict=True):
            for way, opened in _and_beside(public, family, choice, key, open_, tried):
                if opened == 1:
                    return Found(len(tried), way)
                if len(tried) >= budget:
                    return Found(len(tried), "")
    return Found(len(tried), "")


def _in_turns(public: Question, text: str) -> Iterator[tuple[Family, Choices]]:
    """Candidates from what the subject suggests, and from what the
    question gives, some of each in turn.
    """
    words = text.partition(CODE)[0]
    streams = [_portions(families(public, words))]
    if not kinds()[public.kind_of_values].text and public.kind != "free text":
        pool, steps = _beginning(public, text), typed.priced(typed.public_functions(), words)
        values = _portions(_of_values(public, pool, (*steps, *typed.OPERATIONS)))
        turns = _portions(
            _of_values(public, _beginning(public, text), (*steps, *typed.TURNS), typed.MOST // 2)
        )
        streams += [values, turns, values, _portions(_of_parts(public, pool))]
    while streams:
        for stream in list(streams):
            portion = next(stream, None)
            if portion is None:
                streams.remove(stream)
            else:
                yield portion


def _portions(found: Iterable[Family]) -> Iterator[tuple[Family, Choices]]:
    for family in found:
        for choices in family.orders():
            for start in range(0, len(choices), PORTION):
                yield family, choices[start : start + PORTION]


def _and_beside(
    public: Question,
    family: Family,
    choice: Sequence[int],
    known: Key | None,
    open_: Open,
    tried: set[Key],
) -> Iterator[tuple[str, int]]:
    """Try one candidate, and where it is a mistake all beside it."""
    if known is None or known in tried:
        return
    tried.add(known)
    opened = open_(_text_of(known))
    yield family.name, opened
    if opened != 2:
        return
    with np.errstate(all="ignore"):
        beside = family.near(choice) if family.near else family.evaluate(family.beside(choice))
        others = _keys_of(public, beside)
    for other in others:
        if other is not None and other not in tried:
            tried.add(other)
            yield f"{family.name}, then by the reply", open_(_text_of(other))


def _beginning(public: Question, text: str) -> typed.Pool:
    """What a student holds, as :mod:`coursework.authoring.typed` begins with it."""
    words, _, code = text.partition(CODE)
    if public.kind == "function":
        return typed.of_arguments(calls_for(public) or [], [shape_of(public)])
    return typed.beginning(At(public, words), public.given, words, code, [shape_of(public)])


def shape_of(public: Question) -> tuple[int, ...]:
    """The shape of an answer at one point, or for one call."""
    values, size = public.kind_of_values, size_of(public)
    if values in ("expression", "measurement"):
        return ()
    return public.shape if public.shape else {1: (), 9: (3, 3)}.get(size, (size,))


def _of_values(
    public: Question, pool: typed.Pool, steps: Sequence[typed.Step], most: int = typed.MOST
) -> Iterator[Family]:
    """Candidates that some steps lead to from what is given: at each price those
    first that use all that is given.
    """
    left_out: list[Family] = []
    with np.errstate(all="ignore"):
        for price in typed.by_price(pool, steps, most):
            yield from _tables(public, pool, price, True)
            yield from left_out
            left_out = list(_tables(public, pool, price, False))
        yield from left_out


def _of_table(public: Question, table: Numbers, shape: tuple[int, ...] | None) -> Family:
    """A family of candidates that stand in a table, a row for each; ``shape``
    is that of an answer at one point.
    """

    def near(choice: Sequence[int], shape: tuple[int, ...] = shape or ()) -> Numbers:
        values = typed.near(table[choice[0]].reshape(-1, *shape))
        return one_sign(public, values.reshape(len(values), -1), math.prod(shape))

    return Family(
        "built from what is given",
        (len(table),),
        lambda choices: table[choices[:, 0]],
        near=None if shape is None else near,
    )


def _tables(public: Question, pool: typed.Pool, price: int, whole: bool) -> Iterator[Family]:
    """The values of a pool that have a price as candidates: those that use
    all that is given, or the others.
    """
    values, shape = public.kind_of_values, shape_of(public)
    special = values in ROTATIONS or bool(public.unit_vector)
    found = np.array(pool.of_shape(shape, special, price, whole))
    if len(found) and values == "measurement":
        yield _of_table(public, _with_units(public, found), None)
    elif len(found):
        yield _of_table(
            public, one_sign(public, found.reshape(len(found), -1), math.prod(shape)), shape
        )


def _of_parts(public: Question, pool: typed.Pool) -> Iterator[Family]:
    """Answers that are put together of what a pool has by then: a list of its
    parts, a matrix of rows or of columns.
    """
    shape = shape_of(public)
    if public.kind_of_values not in ("vector", "matrix") or len(shape) not in (1, 2):
        return
    cuts = [(axis, sizes) for axis in range(len(shape)) for sizes in _compositions(shape[axis])]
    for most in PARTS_TRIED:
        for axis, sizes in cuts:
            others = [
                shape[:axis] + ((size,) if size > 1 else ()) + shape[axis + 1 :] for size in sizes
            ]
            pools = [pool.of_shape(other)[:most] for other in others]
            if not all(pools) or math.prod(map(len, pools)) > 4 * BUDGET:
                continue
            parts = [
                np.array(values).reshape(
                    len(values), pool.points, *shape[:axis], size, *shape[axis + 1 :]
                )
                for values, size in zip(pools, sizes, strict=True)
            ]
            places = np.indices([len(part) for part in parts]).reshape(len(parts), -1)
            places = places[:, np.argsort(places.sum(axis=0), kind="stable")]
            whole = np.concatenate(
                [part[place] for part, place in zip(parts, places, strict=True)], axis=2 + axis
            )
            yield _of_table(
                public, one_sign(public, whole.reshape(len(whole), -1), math.prod(shape)), shape
            )


def _compositions(size: int) -> list[tuple[int, ...]]:
    """All ways to make a size of at least two parts, those of few parts first:
    as large ones, or numbers alone.
    """
    found: list[tuple[int, ...]] = [
        sizes
        for count in (2, 3)
        for sizes in itertools.product(range(1, size), repeat=count)
        if sum(sizes) == size
    ]
    return found + [(1,) * size] * (3 < size <= MOST_PARTS)


def _with_units(public: Question, numbers: Numbers) -> Numbers:
    absolute = max(float(tolerances(public)[0]), float(NEAR))
    found = [unit(text) for text in UNITS]
    rows = []
    for value in numbers[:3000]:
        for one in found:
            far = np.broadcast_to(
                np.array(one.exponents) * FAR * absolute, (len(value), len(one.exponents))
            )
            rows.append(
                np.concatenate(
                    [(value * float(one.size) / float(public.scale or 1))[:, None], far], axis=1
                ).ravel()
            )
    return np.array(rows)


# --- fingerprints, many at a time ---------------------------------------------------------------


def fingerprints_of(public: Question, numbers: Candidates) -> list[str | None]:
    """The fingerprints of many candidates: texts, with ``None`` where a candidate is not finite.

    As :func:`coursework.checking.reading.fingerprint`, in double
    precision; a test compares the two.
    """
    return [None if key is None else _text_of(key) for key in _keys_of(public, numbers)]


def _keys_of(public: Question, numbers: Candidates) -> Sequence[Key | None]:
    """The cells of each candidate as bytes, from which its fingerprint is
    written only where it is a new one.
    """
    if isinstance(numbers, list):
        return numbers
    absolute, relative = (float(part) for part in tolerances(public))
    count = numbers.shape[1]
    width = EXACT_WIDTH if public.tolerance is None else 3 * count
    scale = numbers / absolute
    if relative:
        scale = np.sign(numbers) * np.log1p(relative * np.abs(numbers) / absolute) / relative
    offsets = np.array([float(offset) for offset in offsets_of(public.salt, count)])
    cells = np.floor(scale / width + offsets)
    finite = np.isfinite(cells).all(axis=1).tolist()
    packed = np.where(np.isfinite(cells), cells, 0).astype(np.int64).tobytes()
    return [
        packed[8 * count * row : 8 * count * (row + 1)] if good else None
        for row, good in enumerate(finite)
    ]


def _text_of(key: Key) -> str:
    return (
        key if isinstance(key, str) else " ".join(map(str, np.frombuffer(key, np.int64).tolist()))
    )


def one_sign(public: Question, numbers: Numbers, size: int) -> Numbers:
    """Of two opposites the one that is taken, as in :mod:`coursework.checking.kinds`."""
    if not public.either_sign:
        return numbers
    limit = float(sign_limit(public))
    groups = numbers.reshape(len(numbers), -1, size)
    large = np.abs(groups) > limit
    first = np.argmax(large, axis=2)[..., None]
    leading = np.take_along_axis(groups, first, axis=2)
    return np.where((leading < 0) & large.any(axis=2, keepdims=True), -groups, groups).reshape(
        numbers.shape
    )


# --- what is tried for each kind ----------------------------------------------------------------


def families(public: Question, text: str = "") -> Iterator[Family]:
    """The generators of candidates for a question, in the order in which they are tried."""
    kind = public.kind
    at = At(public, text)
    for plugin in plugins():
        if importlib.util.find_spec(f"{plugin.__name__}.attack"):
            yield from importlib.import_module(f"{plugin.__name__}.attack").families(public, at)
    if kind in WORDS:
        yield from WORDS[kind](public)
    elif kind == "function":
        yield from _of_functions(public)
    elif kind == "measurement":
        yield from _of_measurements(public, at)
    elif kind in ("expression", "vector", "matrix"):
        yield from of_pools(public, at, size_of(public))


class At:
    """The points of a question as doubles, and the angles and numbers that suggest themselves."""

    def __init__(self, public: Question, text: str = "") -> None:
        self.points = points(public)
        self.symbols = list(public.symbols)
        self.values = {
            name: np.array([float(point[name]) for point in self.points]) for name in self.symbols
        }
        self.angular = [name for name, (low, high) in public.symbols.items() if low < 0 < high]
        self.given = sorted(
            {float(found) for found in re.findall(r"\d+(?:\.\d+)?", text)}, key=lambda x: (x, x)
        )[:24]
        self.ones = np.ones(len(self.points))

    def constants(self, step: int) -> Numbers:
        """Special angles, and those of the text, which is in degrees
        or in radians; one row for each.
        """
        degrees = [*self.given, *range(step, 360, step)]
        angles = [sign * math.radians(angle) for angle in degrees for sign in (1, -1) if angle]
        angles += [sign * angle for angle in self.given for sign in (1, -1) if 0 < angle < 7]
        return np.array(list(dict.fromkeys(angles)))[:, None] * self.ones


WORDS: Mapping[str, Callable[[Question], list[Family]]] = {
    "choice": lambda public: [
        of_words("all options", [public.options], lambda word: word[0].lower())
    ],
    "truth values": lambda public: [of_words("all lists", ["TF"] * (public.length or 0), "".join)],
    "words": lambda public: [
        of_words(
            "all lists",
            [public.options] * (public.length or 0),
            lambda word: PARTS["words"].join(word).lower(),
        )
    ],
    "order": lambda public: [
        of_words(
            "all orders",
            [public.options] * len(public.options),
            lambda word: PARTS["order"].join(word).lower(),
            lambda word: len(set(word)) == len(word),
        )
    ],
}


def of_words(
    name: str,
    options: Sequence[Sequence[str]],
    write: Callable[[Sequence[str]], str],
    allowed: Callable[[Sequence[str]], bool] = lambda word: True,
) -> Family:
    def evaluate(choices: Choices) -> list[str | None]:
        words = (
            [part[place] for part, place in zip(options, row, strict=True)]
            for row in choices.tolist()
        )
        return [write(word) if allowed(word) else None for word in words]

    return Family(name, tuple(map(len, options)), evaluate)


# Numbers with their units: what suggests itself for numbers, in units that are often asked for.

UNITS = (
    "N m", "N", "m", "m/s", "m/s^2", "kg", "s", "J", "W", "Pa", "rad/s", "1", "kN", "kN m", "N/m",
    "mm", "kPa", "MPa", "Hz", "rad", "deg", "m^2", "m^3", "kg/m^3", "kg m^2", "N s", "K", "A", "V",
    "km/h", "kJ", "kW", "cm", "h",
)  # fmt: skip


def _of_measurements(public: Question, at: At) -> Iterator[Family]:
    absolute = max(float(tolerances(public)[0]), float(NEAR))
    found = [unit(text) for text in UNITS]
    sizes = np.array([float(one.size) for one in found]) / float(public.scale or 1)
    far = np.array([one.exponents for one in found]) * FAR * absolute
    pool = _monomials(at) if at.symbols else _numbers(public, at)

    def beside_units(values: Numbers, units: Choices) -> Numbers:
        scaled = (values * sizes[units][:, None])[..., None]
        exponents = np.broadcast_to(far[units][:, None, :], (*values.shape, far.shape[1]))
        return np.concatenate([scaled, exponents], axis=2).reshape(len(values), -1)

    def evaluate(choices: Choices) -> Numbers:
        return beside_units(pool[choices[:, 0]], choices[:, 1])

    yield Family("one small formula, in usual units", (len(pool), len(UNITS)), evaluate)
    if not at.symbols:
        sweep = _sweep(public)
        yield Family(
            "every value in turn, in usual units",
            (*sweep.sizes, len(UNITS)),
            lambda choices: beside_units(
                np.asarray(sweep.evaluate(choices[:, :2])) / sizes[choices[:, 2]][:, None],
                choices[:, 2],
            ),
        )


# Formulas: monomials of what is given, and what is made of two of them.


def of_pools(public: Question, at: At, size: int) -> Iterator[Family]:
    pool = _monomials(at) if at.symbols else _numbers(public, at)

    def evaluate(choices: Choices) -> Numbers:
        return one_sign(public, np.moveaxis(pool[choices], 1, 2).reshape(len(choices), -1), size)

    if size > 1:
        if not at.symbols and public.unit_vector:
            yield _directions(public)
        yield Family(
            "small formulas for every component", (len(pool),) * size, evaluate, by_shells=True
        )
        return
    yield Family("one small formula", (len(pool),), evaluate)
    if not at.symbols:
        yield _sweep(public)
        return
    functions = (np.arctan, np.arccos, np.arcsin, np.sqrt, np.square, np.sin, np.cos, np.tan)
    operations = (np.add, np.subtract, np.divide, np.arctan2, np.multiply)

    def of_one(choices: Choices) -> Numbers:
        values = np.stack([function(pool) for function in functions])
        chosen: Numbers = values[choices[:, 0], choices[:, 1]]
        return (1 - 2 * choices[:, 2, None]) * chosen

    def of_two(choices: Choices) -> Numbers:
        values = np.zeros((len(choices), len(at.ones)))
        for number, operation in enumerate(operations):
            rows = choices[:, 2] == number
            values[rows] = operation(pool[choices[rows, 0]], pool[choices[rows, 1]])
        return values

    def of_three(choices: Choices) -> Numbers:
        return (
            pool[choices[:, 0]]
            + (1 - 2 * (choices[:, 3, None] % 2)) * pool[choices[:, 1]]
            + (1 - 2 * (choices[:, 3, None] // 2)) * pool[choices[:, 2]]
        )

    yield Family("a function of a small formula", (len(functions), len(pool), 2), of_one)
    yield Family(
        "two small formulas together",
        (len(pool), len(pool), len(operations)),
        of_two,
        by_shells=True,
    )
    yield Family(
        "three small formulas together",
        (len(pool), len(pool), len(pool), 4),
        of_three,
        by_shells=True,
    )


def _monomials(at: At) -> Numbers:
    """Small formulas of the symbols, one row each: products of up to
    three sines, cosines and symbols.
    """
    atoms = []
    for name in at.symbols:
        values = at.values[name]
        if name in at.angular:
            atoms += [np.sin(values), np.cos(values)]
        atoms.append(values)
    halves = [function(at.values[name] / 2) for name in at.angular for function in (np.sin, np.cos)]
    powers = [values**2 for values in atoms]
    found = [0 * at.ones, at.ones]
    found += atoms
    for degree in (2, 3):
        if len(atoms) <= 12 or degree == 2:
            found += [np.prod(part, axis=0) for part in itertools.combinations(atoms, degree)]
    found += halves + powers
    signed = []
    for values in found:
        signed += [values, -values]
    signed += [
        factor * values for factor in (2, 0.5, -2, -0.5) for values in found[1 : 2 + 3 * len(atoms)]
    ]
    return np.array(signed)


def _numbers(public: Question, at: At) -> Numbers:
    """Small numbers: those of the text, special sines, fractions, multiples of pi."""
    found = [0, 1, *at.given]
    found += [math.sin(math.radians(angle)) for angle in (30, 45, 60)]
    found += [math.radians(angle) for angle in (30, 45, 60, 90, 120, 135, 150, 180, *at.given)]
    found += [
        function(math.radians(angle)) for angle in at.given for function in (math.sin, math.cos)
    ]
    found += [a / b for b in range(1, 13) for a in range(1, 13)]
    found += [math.sqrt(a / b) for b in range(1, 7) for a in range(1, 13)]
    found += [a * b for a, b in itertools.combinations(at.given, 2)]
    found += [math.radians(angle) for angle in range(5, 360, 5)]
    values = list(dict.fromkeys(sign * number for number in found for sign in (1, -1)))
    return np.array(values)[:, None] * at.ones


def _sweep(public: Question) -> Family:
    """Every value of one number, from zero outwards: a cell at a time."""
    absolute, _ = (float(part) for part in tolerances(public))
    step = 3 * absolute if public.tolerance is not None else float(EXACT) * EXACT_WIDTH

    def evaluate(choices: Choices) -> Numbers:
        return np.asarray((choices[:, :1] + 0.5) * (1 - 2 * choices[:, 1:]) * step, float)

    return Family("every value in turn", (BUDGET, 2), evaluate)


def _directions(public: Question) -> Family:
    whole = [
        axis
        for axis in itertools.product(range(-9, 10), repeat=3)
        if any(axis) and math.gcd(*axis) == 1
    ]
    whole.sort(key=lambda axis: (sum(map(abs, axis)), axis))
    units = np.array([np.array(axis) / np.linalg.norm(axis) for axis in whole])
    return Family(
        "directions of small whole numbers",
        (len(units),),
        lambda choices: one_sign(public, units[choices[:, 0]], 3),
    )


# Functions: what the library gives, and small formulas of the arguments.


def _of_functions(public: Question) -> Iterator[Family]:
    size = size_of(public)
    pool = _features(calls_for(public) or [])
    if not len(pool):
        return

    def evaluate(choices: Choices) -> Numbers:
        numbers = np.moveaxis(pool[choices], 1, 2).reshape(len(choices), -1)
        return one_sign(public, numbers, size)

    def of_two(choices: Choices) -> Numbers:
        first, second = pool[choices[:, 0]], pool[choices[:, 1]]
        values = [
            first + second,
            first - second,
            first / second,
            np.arctan2(first, second),
            np.arccos(first * second),
        ]
        return np.stack(values, axis=1)[np.arange(len(choices)), choices[:, 2]]

    yield Family("small formulas of the arguments", (len(pool),) * size, evaluate, by_shells=True)
    if size == 1:
        yield Family(
            "two small formulas together", (len(pool), len(pool), 5), of_two, by_shells=True
        )


def size_of(public: Question) -> int:
    """How many numbers an answer is compared by, at one point or for one call."""
    values = public.kind_of_values
    if values == "expression":
        return 1
    if values in ("vector", "matrix"):
        return (public.length or 3) if values == "vector" else math.prod(public.shape or (3, 3))
    for plugin in plugins():
        size: int | None = getattr(plugin, "SIZES", {}).get(values)
        if size:
            return size
    return 1


def _numbers_in(argument: Any) -> list[float]:
    """All numbers of an argument of a call, in order; what else stands in it, the
    name of an axis say, is left out.
    """
    if isinstance(argument, (list, tuple, np.ndarray)):
        return [number for part in argument for number in _numbers_in(part)]
    return [float(argument)] if isinstance(argument, (int, float, np.number)) else []


def _features(calls: Sequence[Sequence[Any]]) -> Numbers:
    """Small formulas of the arguments of each call, one row each."""
    flat = [[part for argument in call for part in _numbers_in(argument)] for call in calls]
    shortest = min(map(len, flat))
    if not shortest:
        return np.array([])
    entries = np.array([row[:shortest] for row in flat]).T
    with np.errstate(all="ignore"):
        found = [0 * entries[0], *entries, np.ones(len(calls))]
        found += [
            function(values)
            for values in entries
            for function in (np.sin, np.cos, np.arcsin, np.arccos, np.sqrt)
        ]
        found += [
            entries[a] * entries[b]
            for a, b in itertools.combinations_with_replacement(range(len(entries)), 2)
        ]
        found += [
            np.arctan2(entries[a], entries[b])
            for a, b in itertools.permutations(range(len(entries)), 2)
        ]
        for operation in (np.add, np.subtract, np.multiply, np.divide, np.arctan2, np.hypot):
            found += [
                operation(first, second) for first, second in itertools.permutations(found[:60], 2)
            ]
    found = [values for values in found if np.isfinite(values).all()]
    return np.array([sign * values for values in found for sign in (1, -1)])
