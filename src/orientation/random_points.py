"""Evaluate expressions at random values of their symbols, which is faster than algebra."""

from __future__ import annotations

import math
import random
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, TypeAlias, overload

from .numbers_and_symbols import is_symbolic

if TYPE_CHECKING:
    from typing_extensions import TypeIs

    from ._types import Array, Column, Entry, Expression

#: The symbols that share a name, such as theta and theta(t).
Names: TypeAlias = "dict[str, set[Expression]]"
#: A value for each name.
Point: TypeAlias = dict[str, float]

#: Each symbol gets a random value in one of these quarter turns. They cover all four quadrants,
#: both signs, and two values beyond half a turn, so that the root of a square is not mistaken for
#: the cosine of the angle or of half the angle.
QUARTERS = (-3, -1, 0, 2)


def _is_expression(entry: Column) -> TypeIs[Expression]:
    return is_symbolic(entry)


def unknowns(components: Iterable[Column]) -> Names:
    """Return the symbols and functions of time in the components, grouped by name."""
    names: Names = {}
    for expression in filter(_is_expression, components):
        import sympy
        from sympy.core.function import AppliedUndef

        functions = expression.atoms(AppliedUndef)
        # The time inside theta(t) is not an unknown of its own unless it also occurs outside.
        rest = expression.xreplace({function: sympy.Dummy() for function in functions})
        for atom in functions | (rest.free_symbols & expression.free_symbols):
            names.setdefault(atom.name, set()).add(atom)
    return dict(sorted(names.items()))


def points_for(names: Iterable[str]) -> list[Point]:
    """Return values for every name: a dictionary for each point, the same ones on every call."""
    if not names:
        return [{}]
    source = random.Random(20)
    points: list[Point] = [{} for _ in QUARTERS]
    for name in names:
        for point, quarter in zip(points, source.sample(QUARTERS, len(QUARTERS))):
            point[name] = (quarter + source.uniform(0.1, 0.9)) * math.pi / 2
    return points


@overload
def put_in(components: Sequence[Entry], names: Names, point: Point) -> list[complex]: ...
@overload
def put_in(
    components: Sequence[Column], names: Names, point: Point
) -> Sequence[complex | Array]: ...
def put_in(components: Sequence[Column], names: Names, point: Point) -> Sequence[complex | Array]:
    """Return the components as numbers, with the values of one point for their symbols."""
    values: dict[Expression, Expression] = {}
    if names:
        import sympy

        values = {atom: sympy.Float(point[name]) for name, atoms in names.items() for atom in atoms}
    return [
        complex(entry.xreplace(values).evalf()) if _is_expression(entry) else entry
        for entry in components
    ]


@overload
def at_random_points(*components: Sequence[Entry]) -> Iterator[tuple[list[complex], ...]]: ...
@overload
def at_random_points(
    *components: Sequence[Column],
) -> Iterator[tuple[Sequence[complex | Array], ...]]: ...
def at_random_points(
    *components: Sequence[Column],
) -> Iterator[tuple[Sequence[complex | Array], ...]]:
    """Iterate over the random points; each gives a tuple of lists of components as numbers."""
    names = unknowns([entry for entries in components for entry in entries])
    for point in points_for(names):
        yield tuple(put_in(entries, names, point) for entries in components)
