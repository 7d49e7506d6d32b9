"""Decide whether two orientations are the same, and name the mix-up if they are not.

Every decision is made numerically, at random values of the symbols: an algebraic simplification can
take seconds, or never finish. Like the conversions, this works on components, so symbols need no
NumPy.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple, TypeAlias, TypeGuard

from .direction_cosines import demand_dcm
from .euler_angles import SEQUENCES, body_fixed_formula
from .mixups import CONJUGATE, REVERSED, SCALAR_LAST, TRANSPOSE, wrong_sign
from .numbers_and_symbols import (
    NUMBERS,
    TOLERANCE,
    WrongShape,
    as_list,
    is_symbolic,
    narrow_type,
    number_array,
    number_tuples,
    one_item,
    symbol_components,
    tolerance_of,
)
from .quaternions import demand_unit_length, product_components
from .random_points import Names, Point, at_random_points, points_for, put_in, unknowns

if TYPE_CHECKING:
    from ._types import Array, Column, Entry, Values


#: The components of an answer at each point.
Answers: TypeAlias = Sequence[Sequence[complex]]
#: The name of a mix-up, and the answer that it would give at each point.
Mixup: TypeAlias = tuple[str, Iterable[Sequence[complex]]]
#: The three angles at each point, and the sequence, or None if the answer need not come from Euler
#: angles.
Turned: TypeAlias = tuple[Sequence[Sequence[float]], str] | tuple[None, None]
Match: TypeAlias = Callable[[Sequence[complex], Sequence[complex]], bool]


def _read(value: Values, name: str) -> Sequence[Column]:
    """Return the components of a matrix or quaternion.

    They are SymPy expressions, floats, or the columns of a batch.
    """
    if not is_symbolic(value):
        for item in ((3, 3), (4,)):
            if entries := one_item(value, item, name):
                return entries
    for item in ((3, 3), (4,)):
        try:
            if is_symbolic(value):
                return symbol_components(value, item, name)
            array = number_array(value, item, name)
        except WrongShape:
            continue
        flat = array.reshape(*array.shape[: array.ndim - len(item)], math.prod(item))
        return [flat[..., k] for k in range(math.prod(item))]
    raise ValueError(
        f"{name} must be a direction cosine matrix, of shape (3, 3), or a quaternion, of shape (4,)"
    )


def _read_both(
    first: Values, second: Values, name: str, name_of_second: str
) -> tuple[Sequence[Column], Sequence[Column]]:
    first_components, second_components = _read(first, name), _read(second, name_of_second)
    if len(first_components) != len(second_components):
        kinds = {9: "a direction cosine matrix", 4: "a quaternion"}
        raise ValueError(
            f"{name} is {kinds[len(first_components)]} and {name_of_second} is "
            f"{kinds[len(second_components)]}; convert one of them"
        )
    return first_components, second_components


def _is_one(entries: Sequence[Column]) -> TypeGuard[Sequence[Entry]]:
    return not getattr(entries[0], "ndim", 0)


def _match(
    first: Sequence[complex], second: Sequence[complex], tolerance: float = TOLERANCE
) -> bool:
    """Check whether numbers are equal; quaternions may differ by sign."""
    if len(first) == 4:
        sign = 1 if sum((a * b.conjugate()).real for a, b in zip(first, second)) >= 0 else -1
        second = [sign * entry for entry in second]
    return all(abs(a - b) <= tolerance for a, b in zip(first, second))


def _columns_match(
    first: Sequence[complex | Array], second: Sequence[complex | Array], tolerance: float
) -> bool:
    """Check whether the columns of two batches are equal; quaternions may differ by sign."""
    import numpy

    firsts, seconds = (list(map(numpy.asarray, entries)) for entries in (first, second))
    if len(firsts) == 4:
        sign = numpy.where(
            sum((a * b.conjugate()).real for a, b in zip(firsts, seconds)) >= 0, 1, -1
        )
        seconds = [sign * entry for entry in seconds]
    return all((abs(a - b) <= tolerance).all() for a, b in zip(firsts, seconds))


def same_orientation(first: Values, second: Values, tolerance: float | None = None) -> bool:
    """Check whether two direction cosine matrices, or two quaternions, are the same orientation.

    Symbols are compared by name, so that ``theta`` with and without assumptions, or as a function
    of time, are one angle. The two quaternions $q$ and $-q$ are the same orientation.

    Parameters
    ----------
    first, second : SymPy matrices or arrays
        Both of shape ``(..., 3, 3)``, or both ``(4,)`` or ``(..., 4)``.
    tolerance : float, optional
        Largest difference between two entries that counts as rounding: ``1e-9``, or ``4e-6`` if one
        is in single precision.

    Returns
    -------
    bool

    Raises
    ------
    ValueError
        If one is a matrix and the other a quaternion, the shapes are those of neither, two batches
        differ in shape, or a number is not finite.

    Examples
    --------
    >>> import sympy as sm
    >>> from orientation import same_orientation, simple_dcm
    >>> a, b = sm.symbols('a, b')
    >>> same_orientation(simple_dcm('z', a) * simple_dcm('z', b), simple_dcm('z', a + b))
    True
    """
    first_components, second_components = _read_both(first, second, "first", "second")
    tolerance = tolerance_of(narrow_type((first, second))) if tolerance is None else tolerance
    if _is_one(first_components) and _is_one(second_components):
        return all(
            _match(first, second, tolerance)
            for first, second in at_random_points(first_components, second_components)
        )
    shapes = [getattr(entries[0], "shape", ()) for entries in (first_components, second_components)]
    if () not in shapes and shapes[0] != shapes[1]:
        raise ValueError(f"cannot compare batches of shapes {shapes[0]} and {shapes[1]}")
    return all(
        _columns_match(first, second, tolerance)
        for first, second in at_random_points(first_components, second_components)
    )


class Diagnosis(NamedTuple):
    """Result of `diagnose`: whether the answer is right, and all mix-ups that explain it."""

    same: bool
    causes: tuple[str, ...]

    def __str__(self) -> str:
        if self.same:
            return "The same orientation."
        if not self.causes:
            return "Not the same orientation, and it is none of the usual mix-ups."
        if len(self.causes) == 1:
            return f"Not the same orientation: {self.causes[0]}."
        return (
            "Not the same orientation. These mix-ups are mathematically the same here: "
            + "; or ".join(self.causes)
            + "."
        )


def diagnose(
    given: Values,
    expected: Values,
    angles: Values | None = None,
    sequence: str | None = None,
    tolerance: float | None = None,
) -> Diagnosis:
    """Check whether an orientation is the expected one, and find the mix-up if it is not.

    A mix-up is named only if it reproduces the given answer at every random value of the symbols.
    If several do, they are mathematically the same for this answer, and all of them are named.

    Parameters
    ----------
    given, expected : direction cosine matrices or quaternions
        Of shape ``(3, 3)`` or ``(4,)``; symbols or numbers.
    angles, sequence : optional
        The Euler angles and the body fixed sequence of ``expected``. For a symbolic matrix of up to
        three angles they are recognised without being given.
    tolerance : float, optional
        Largest difference between two entries that counts as rounding, by default as for
        `same_orientation`. Numbers from a file need more than the rounding of a computation: half a
        unit of their last printed digit, and what follows from it.

    Returns
    -------
    Diagnosis
        ``same``, and ``causes``: a tuple of sentences. As a string, one message.

    Raises
    ------
    ValueError
        As for `same_orientation`; for a batch; and if ``angles`` and ``sequence`` are not both
        given, or do not make ``expected``.

    Examples
    --------
    >>> import sympy as sm
    >>> from orientation import diagnose, dcm_from_body_fixed, dcm_from_space_fixed
    >>> angles = sm.symbols('psi, theta, varphi')
    >>> expected = dcm_from_body_fixed(angles, 'zxy')
    >>> print(diagnose(expected.T, expected))
    Not the same orientation: it is the transpose, which is the inverse orientation.
    >>> diagnose(dcm_from_space_fixed(angles, 'zxy'), expected).causes
    ('the matrices are multiplied in reverse order, which gives space fixed rotations',)
    """
    answer, truth = _read_both(given, expected, "given", "expected")
    tolerance = tolerance_of(narrow_type((given, expected))) if tolerance is None else tolerance
    if not (_is_one(answer) and _is_one(truth)):
        raise ValueError("diagnose takes one answer at a time, not a batch")
    if (angles is None) != (sequence is None):
        raise ValueError("give both angles and sequence, or neither")
    turns: Sequence[Entry] | None = None
    if angles is not None:
        turns = (
            symbol_components(angles, (3,), "angles")
            if is_symbolic(angles)
            else as_list(number_tuples(angles, (3,), "angles"))
        )
    names = unknowns([*answer, *truth, *(turns or ())])
    points = points_for(names)
    answers, truths = (
        [put_in(entries, names, point) for point in points] for entries in (answer, truth)
    )
    match = functools.partial(_match, tolerance=tolerance)
    turned, sequence = _turns(truth, truths, names, points, turns, sequence, match)
    if all(map(match, answers, truths)):
        return Diagnosis(True, ())
    mixups = itertools.chain(
        _transpositions(truths) if len(answer) == 9 else _quaternion_mixups(truths),
        _substitutions(truth, names, points),
        _sequence_mixups(turned, sequence, given=turns is not None, symbols=bool(names)),
    )
    causes = [cause for cause, values in mixups if all(map(match, answers, values))]
    # Report the fault of a matrix that is not orthogonal. Symbols may have to obey a condition, as
    # the four of a quaternion do, and random values violate it, so report nothing for them. Entries
    # that are off by the tolerance make lengths and products off by about four times as much.
    fault = None if causes else _fault(answers, 4 * tolerance)
    if fault and not _fault(truths, 4 * tolerance):
        causes = [fault]
    return Diagnosis(False, tuple(dict.fromkeys(causes)))


def _fault(values: Iterable[Sequence[complex]], tolerance: float) -> str | None:
    """Return the fault of numbers that should be an orientation at every point, or None."""
    for entries in values:
        try:
            if len(entries) == 9:
                demand_dcm(entries, name="it", tolerance=tolerance)
            else:
                demand_unit_length(entries, name="it", tolerance=tolerance)
        except ValueError as error:
            return str(error)
    return None


def _transpositions(truths: Answers) -> Iterator[Mixup]:
    yield (
        f"it is {TRANSPOSE}",
        [
            [entries[3 * column + row] for row in range(3) for column in range(3)]
            for entries in truths
        ],
    )


def _substitutions(
    expected: Sequence[Entry], names: Names, points: Sequence[Point]
) -> Iterator[Mixup]:
    """Iterate over mix-ups of the angles' signs, order and units in a symbolic answer."""
    own = list(unknowns(expected))

    def with_changes(change: Callable[[Point], Point]) -> Iterable[Sequence[complex]]:
        return (put_in(expected, names, {**point, **change(point)}) for point in points)

    for name in own:
        yield f"{name} has the wrong sign", with_changes(lambda p: {name: -p[name]})
    for first, second in itertools.combinations(own, 2):
        yield (
            f"{first} and {second} are swapped",
            with_changes(lambda p: {first: p[second], second: p[first]}),
        )
    for group in dict.fromkeys([tuple(own), *((name,) for name in own)]):
        those = f"{', '.join(group)} {'was' if len(group) == 1 else 'were'}"
        yield (
            f"{those} given in degrees where radians are expected",
            with_changes(lambda p: {name: math.degrees(p[name]) for name in group}),
        )
        yield (
            f"{those} converted from degrees to radians once too often",
            with_changes(lambda p: {name: math.radians(p[name]) for name in group}),
        )


def _turns(
    expected: Sequence[Entry],
    truths: Answers,
    names: Names,
    points: Sequence[Point],
    angles: Sequence[Entry] | None,
    sequence: str | None,
    match: Match,
) -> Turned:
    """Return the three angles at each point and the sequence, as given or else recognised."""
    if angles is None or sequence is None:
        return (
            _recognise(truths, list(unknowns(expected)), points, match)
            if len(expected) == 9
            else (None, None)
        )
    values = [[entry.real for entry in put_in(angles, names, point)] for point in points]
    if not all(map(match, truths, _body_fixed(values, sequence))):
        raise ValueError(f"`expected` is not the body fixed {sequence} orientation of these angles")
    return values, sequence


def _body_fixed(values: Iterable[Sequence[float]], sequence: str) -> Iterator[Sequence[float]]:
    formula = body_fixed_formula(sequence)
    return (formula(NUMBERS, *angles) for angles in values)


def _sequence_mixups(
    values: Sequence[Sequence[float]] | None, sequence: str | None, given: bool, symbols: bool
) -> Iterator[Mixup]:
    """Iterate over mix-ups of a sequence of body fixed rotations."""
    if values is None or sequence is None:
        return
    back = [angles[::-1] for angles in values]
    yield (
        "the matrices are multiplied in reverse order, which gives space fixed rotations",
        _body_fixed(back, sequence[::-1]),
    )
    if not given and 0 in values[0]:
        # Two rotations are part of several sequences.
        return
    yield REVERSED, _body_fixed(back, sequence)
    for alternative in SEQUENCES:
        if alternative != sequence:
            yield (
                f"it is the sequence {alternative}, not {sequence}",
                _body_fixed(values, alternative),
            )
    if not symbols:
        for which, signs in (("first", (-1, 1, 1)), ("second", (1, -1, 1)), ("third", (1, 1, -1))):
            yield (
                wrong_sign(which),
                _body_fixed(
                    [[a * b for a, b in zip(angles, signs)] for angles in values], sequence
                ),
            )
        yield (
            "the angles were given in degrees where radians are expected",
            _body_fixed([list(map(math.degrees, angles)) for angles in values], sequence),
        )
        yield (
            "the angles were converted from degrees to radians once too often",
            _body_fixed([list(map(math.radians, angles)) for angles in values], sequence),
        )


def _recognise(
    truths: Answers, names: Sequence[str], points: Sequence[Point], match: Match
) -> Turned:
    """Find the sequence and the signed angles that make the expected matrix from its symbols."""
    if not 1 < len(names) <= 3:
        return None, None
    table = [[point[name] for name in names] + [0.0] * (3 - len(names)) for point in points]
    for sequence in SEQUENCES:
        for order in itertools.permutations(range(3)):
            for signs in itertools.product((1, -1), repeat=3):
                values = [[sign * row[place] for sign, place in zip(signs, order)] for row in table]
                if all(map(match, truths, _body_fixed(values, sequence))):
                    return values, sequence
    return None, None


def _quaternion_mixups(truths: Answers) -> Iterator[Mixup]:
    def rearranged(
        rule: Callable[[complex, complex, complex, complex], Sequence[complex]],
    ) -> Answers:
        return [rule(*entries) for entries in truths]

    yield (
        f"{SCALAR_LAST}; in this book it comes first",
        rearranged(lambda a, b, c, d: [b, c, d, a]),
    )
    yield (f"it is {CONJUGATE}", rearranged(lambda a, b, c, d: [a, -b, -c, -d]))
    yield (
        f"it is the conjugate, and {SCALAR_LAST}; in this book it comes first",
        rearranged(lambda a, b, c, d: [-b, -c, -d, a]),
    )
    yield (
        "the angle was not halved: a quaternion holds the cosine and sine of half the angle",
        rearranged(lambda *q: product_components(NUMBERS, *q, *q)),
    )
