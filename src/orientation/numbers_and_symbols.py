"""One formula for symbols, numbers and batches.

Every conversion of this package is written once, as a formula that takes scalar components and
returns scalar components. This module determines the kind of the arguments (SymPy expressions,
plain numbers, or arrays of a batch), passes the components to the formula with the matching
``sin``, ``cos`` and so on, and shapes the results.

SymPy objects are recognised without importing SymPy. A single orientation in numbers is computed
with Python's own floats, which is faster than with arrays and needs NumPy only for the result.
"""

from __future__ import annotations

import functools
import math
import numbers
import operator
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple, TypeAlias, TypeGuard, TypeVar, overload

if TYPE_CHECKING:
    from ._types import (
        Array,
        Excess,
        Explain,
        Expression,
        Formula,
        Functions,
        Matrix,
        NumberFormula,
        NumberFunctions,
        Scalars,
        Symbols,
        Truth,
        Values,
    )

#: An argument of a function: its name, its value, and the shape of one item of it.
Argument: TypeAlias = "tuple[str, Values, tuple[int, ...]]"
Given = TypeVar("Given")
#: One number, or numbers in tuples of any depth.
Nested: TypeAlias = "float | tuple[Nested, ...]"

# The largest deviation from orthogonality, or from unit length, that counts as rounding.
TOLERANCE = 1e-9
# The types that are narrower than a float, narrowest first, with the distance from 1 to the next
# number, and the largest deviation of their numbers in units of it.
PRECISIONS = {"float16": 2.0**-10, "float32": 2.0**-23}
ROUNDINGS = 32
# The largest fault of a covariance that counts as rounding, as in one that was printed with three
# digits, in units of the standard deviations.
COVARIANCE_SLACK = 1e-3

#: Number of items of a batch to work on together. Their components then stay in the cache, and the
#: memory they free is too small to be returned to the system and fetched again.
BLOCK = 4096


class SymbolsNotPossible(TypeError):
    """Symbols were passed to a conversion that must compare sizes to choose its branch."""


class WrongShape(ValueError):
    """An argument has a shape that a function cannot use."""


class Guard(NamedTuple):
    """The condition that numbers must satisfy before a formula is applied to them.

    Attributes
    ----------
    excess : callable
        ``excess(functions, *components)`` is at most `TOLERANCE` for valid input.
    explain : callable
        ``explain(components, where)`` raises the error that explains the fault.
    size : int, optional
        The number of components that it inspects, from the first; by default all.
    """

    excess: Excess
    explain: Explain
    size: int | None = None


def is_symbolic(value: object) -> TypeGuard[Symbols]:
    """Return whether a value is a SymPy object, or a sequence or object array that contains one."""
    if isinstance(value, (list, tuple)):
        return any(is_symbolic(entry) for entry in value)
    if isinstance(value, float):
        return False
    if hasattr(value, "dtype") and hasattr(value, "tolist") and value.dtype == object:
        return is_symbolic(value.tolist())
    return hasattr(value, "free_symbols")


class Variable:
    """A placeholder for the value with respect to which a conversion is differentiated."""

    def slopes_of(
        self,
        formula: NumberFormula,
        shape: tuple[int, ...],
        arguments: Sequence[Argument],
        guard: Guard | None,
    ) -> Array:
        """Return the derivatives of the formula's results, of shape ``(count, ..., *shape)``."""
        raise NotImplementedError


def evaluate(
    formula: Formula, shape: tuple[int, ...], *arguments: Argument, guard: Guard | None = None
) -> Array | Matrix:
    """Apply a formula to its arguments, of whatever kind.

    Parameters
    ----------
    formula : callable
        ``formula(functions, *components)`` returns the components of the result.
    shape : tuple
        Shape of one result.
    arguments : tuples ``(name, value, shape)``
        The caller's arguments, with the shape of one item of each.
    guard : Guard, optional
    """
    result = _evaluate_at_a_glance(formula, shape, arguments, guard)
    if result is not None:
        return result
    if any(is_symbolic(value) for _, value, _ in arguments):
        return _evaluate_symbols(formula, shape, arguments, guard)
    return _evaluate_what_is_read(formula, shape, arguments, guard)


@overload
def evaluate_numbers(
    formula: NumberFormula, shape: tuple[()], *arguments: Argument, guard: Guard | None = None
) -> Scalars: ...
@overload
def evaluate_numbers(
    formula: NumberFormula,
    shape: tuple[int] | tuple[int, int],
    *arguments: Argument,
    guard: Guard | None = None,
) -> Array: ...
def evaluate_numbers(
    formula: NumberFormula, shape: tuple[int, ...], *arguments: Argument, guard: Guard | None = None
) -> Scalars:
    """Apply a formula for numbers, which chooses its branch by size; see `evaluate`."""
    result = _evaluate_at_a_glance(formula, shape, arguments, guard)
    if result is not None:
        return result
    return _evaluate_what_is_read(formula, shape, arguments, guard)


def _evaluate_at_a_glance(
    formula: NumberFormula,
    shape: tuple[int, ...],
    arguments: Sequence[Argument],
    guard: Guard | None,
) -> Scalars | None:
    """Return the result if a quick check of the arguments suffices, else None."""
    components: list[float] = []
    for _, value, item in arguments:
        entries = _at_a_glance(value, item)
        if entries is None:
            break
        components += entries
    else:
        return _evaluate_item(formula, shape, components, guard)
    for name, value, item in arguments:
        if not _is_batch(value, item):
            return None
        _demand_finite_array(value, name)
    return _evaluate_batch(formula, shape, arguments, guard)


def _at_a_glance(value: object, item: tuple[int, ...]) -> Sequence[float] | None:
    """Return the floats of one item if a quick check shows that they are valid, else None."""
    entries: Sequence[float] | None = None
    if type(value) is float or type(value) is int:
        entries = None if item else [value]
    elif type(value) is tuple or type(value) is list:
        if (
            len(item) == 2
            and len(value) == item[0]
            and all(type(row) is list and len(row) == item[1] for row in value)
        ):
            value = [entry for row in value for entry in row]
        elif len(item) != 1 or len(value) != item[0]:
            return None
        entries = value if _PLAIN.issuperset(map(type, value)) else None
    elif _is_array(value) and value.shape == item and value.dtype.char == "d":
        entries = value.ravel().tolist()
    try:
        # The difference is not zero if a number is infinite or missing, or if the sum overflows.
        return entries if entries and (total := math.fsum(entries)) - total == 0 else None
    except (OverflowError, ValueError):
        return None


def _is_array(value: object) -> TypeGuard[Array]:
    return type(value).__name__ == "ndarray"


_PLAIN = {float, int}


def one_item(value: object, item: tuple[int, ...], name: str) -> list[float] | None:
    """Return the floats of one item of the given shape as a list; None for any other shape."""
    entries = _at_a_glance(value, item)
    if entries is not None:
        return list(map(float, entries))
    if getattr(value, "ndim", len(item)) != len(item):
        return None
    if isinstance(value, (list, tuple)) and len(value) != sum(item[:1]):
        return None
    try:
        return as_list(number_tuples(value, item, name))
    except WrongShape:
        # This is a batch, or a mistake that number_array explains.
        return None


def as_list(value: Nested) -> list[float]:
    """Return the numbers of nested tuples in one list."""
    return (
        [entry for part in value for entry in as_list(part)]
        if isinstance(value, tuple)
        else [value]
    )


def _evaluate_what_is_read(
    formula: NumberFormula,
    shape: tuple[int, ...],
    arguments: Sequence[Argument],
    guard: Guard | None,
) -> Scalars:
    for _, value, _ in arguments:
        if isinstance(value, Variable):
            return value.slopes_of(formula, shape, arguments, guard)
    single = [one_item(value, item, name) for name, value, item in arguments]
    items = [entries for entries in single if entries is not None]
    kind = narrow_type(_guarded(arguments, guard)) if guard else None
    tolerance = tolerance_of(kind)
    result: Scalars
    if len(items) == len(single):
        entries = [entry for entries in items for entry in entries]
        result = _evaluate_item(formula, shape, entries, guard, tolerance)
    else:
        read = [(name, number_array(value, item, name), item) for name, value, item in arguments]
        result = _evaluate_batch(formula, shape, read, guard, tolerance)
    # A value that is valid to only a few digits keeps its narrower type, which shows that.
    return result.astype(kind) if kind and hasattr(result, "astype") else result


def _guarded(arguments: Sequence[Argument], guard: Guard) -> Iterator[object]:
    """Iterate over the guarded arguments.

    Other arguments are taken as exact, however few digits they have.
    """
    size = 0
    for _, value, item in arguments:
        if guard.size is None or size < guard.size:
            yield value
        size += math.prod(item)


def narrow_type(values: Iterable[object]) -> str | None:
    """Return the narrowest type, of NumPy or another library, that is narrower than a float."""
    names = [str(getattr(value, "dtype", "")).rpartition(".")[2] for value in values]
    return next((kind for kind in PRECISIONS if kind in names), None)


def tolerance_of(kind: str | None) -> float:
    """Return what counts as rounding in numbers of a `narrow_type`, or in floats."""
    return ROUNDINGS * PRECISIONS[kind] if kind else TOLERANCE


def _evaluate_symbols(
    formula: Formula, shape: tuple[int, ...], arguments: Sequence[Argument], guard: Guard | None
) -> Matrix:
    import sympy

    components = [
        entry for name, value, item in arguments for entry in symbol_components(value, item, name)
    ]
    if guard:
        _guard_exact_numbers(components, guard)
    result = [sympy.sympify(entry) for entry in formula(_symbol_functions(), *components)]
    if shape == ():
        return result[0]
    return sympy.Matrix(*(shape if len(shape) == 2 else (*shape, 1)), result)


def _guard_exact_numbers(components: Sequence[Expression], guard: Guard) -> None:
    try:
        numbers = [float(entry) for entry in components[: guard.size]]
    except TypeError:
        # Whether symbols are valid depends on the values to be substituted for them.
        return
    if not guard.excess(NUMBERS, *numbers) <= TOLERANCE:
        guard.explain(numbers, "")


def _evaluate_item(
    formula: NumberFormula,
    shape: tuple[int, ...],
    components: Sequence[float],
    guard: Guard | None,
    tolerance: float = TOLERANCE,
) -> Scalars:
    if guard:
        looked_at = components[: guard.size]
        if not guard.excess(NUMBERS, *looked_at) <= tolerance:
            guard.explain([float(entry) for entry in looked_at], "")
    result = formula(NUMBERS, *components)
    if not shape:
        return result[0]
    # Adding zero turns -0 into 0, which would look like a wrong sign.
    result = [entry + 0.0 for entry in result]
    from numpy import array

    return array(result).reshape(shape) if len(shape) > 1 else array(result)


def columns_of(arguments: Sequence[Argument]) -> tuple[tuple[int, ...], list[Array]]:
    """Return the shape of the common batch of some arrays, and the items of each as rows.

    Raises
    ------
    ValueError
        If the batches have incompatible shapes.
    """
    arrays: list[Array] = [value for _, value, _ in arguments]  # type: ignore[misc]
    shapes = [
        array.shape[: array.ndim - len(item)] for array, (_, _, item) in zip(arrays, arguments)
    ]
    batch = shapes[0]
    if shapes.count(batch) < len(shapes):
        import numpy

        try:
            batch = numpy.broadcast_shapes(*shapes)
        except ValueError:
            described = " and ".join(
                f"{name} {array.shape}" for array, (name, _, _) in zip(arrays, arguments)
            )
            raise ValueError(f"the batches have incompatible shapes: {described}") from None
        arrays = [
            numpy.broadcast_to(array, batch + item)
            for array, (_, _, item) in zip(arrays, arguments)
        ]
    size = math.prod(batch)
    return batch, [
        array.reshape(size, math.prod(item)) for array, (_, _, item) in zip(arrays, arguments)
    ]


def _is_batch(value: object, item: tuple[int, ...]) -> TypeGuard[Array]:
    """Return whether a quick check shows that these are the floats of several items."""
    return (
        _is_array(value)
        and value.dtype.char == "d"
        and value.ndim > len(item)
        and value.shape[value.ndim - len(item) :] == item
    )


def _evaluate_batch(
    formula: NumberFormula,
    shape: tuple[int, ...],
    arguments: Sequence[Argument],
    guard: Guard | None,
    tolerance: float = TOLERANCE,
) -> Array:
    import numpy

    batch, flat = columns_of(arguments)
    count, width = math.prod(batch), math.prod(shape)
    result = numpy.empty((count, width))
    for start in range(0, count, BLOCK):
        components = [column for array in flat for column in array[start : start + BLOCK].T.copy()]
        if guard:
            demand(guard, components, batch, start, tolerance)
        block = result[start : start + BLOCK]
        columns = [
            values if isinstance(values, numpy.ndarray) else numpy.full(len(block), values)
            for values in formula(array_functions(), *components)
        ]
        # Adding zero turns -0 into 0, which would look like a wrong sign.
        numpy.add(numpy.concatenate(columns).reshape(width, -1).T, 0.0, out=block)
    return result.reshape(batch + shape)


def demand(
    guard: Guard,
    components: Sequence[Array],
    batch: tuple[int, ...],
    start: int = 0,
    tolerance: float = TOLERANCE,
) -> None:
    """Raise the error of the worst item of a batch if its columns are not valid for a formula."""
    import numpy

    # The error below reports this.
    with numpy.errstate(over="ignore", invalid="ignore"):
        size = guard.excess(array_functions(), *components[: guard.size])
    if numpy.count_nonzero(size <= tolerance) < len(size):
        worst = int(numpy.argmax(size))
        guard.explain(
            [float(column[worst]) for column in components[: guard.size]],
            item_in_words(start + worst, batch),
        )


def item_in_words(place: int, batch: tuple[int, ...]) -> str:
    """Return which item of a batch is meant, or nothing if there is only one."""
    import numpy

    return f" (item {[int(k) for k in numpy.unravel_index(place, batch)]})" if batch else ""


def number_array(value: object, item: tuple[int, ...], name: str) -> Array:
    """Return a float array of shape ``(..., *item)``, or raise an error that explains the fault.

    SymPy matrices of plain numbers are numbers here; a symbol among them raises
    `SymbolsNotPossible`.
    """
    import numpy

    if is_symbolic(value):
        value = _floats(_listed(value), name)
    elif (
        len(item) == 1
        and isinstance(value, (list, tuple))
        and len(value) == item[0]
        and all(getattr(entry, "ndim", 0) for entry in value)
    ):
        raise ValueError(
            f"{name} is a sequence of {len(value)} arrays, which can be read in two ways. Join "
            "separate components with numpy.stack(..., axis=-1), or a list of items with "
            "numpy.stack(...)"
        )
    value = _unmasked(value)
    try:
        array = numpy.asarray(value)
        if array.dtype == object and all(
            isinstance(entry, numbers.Real) and not isinstance(entry, bool) for entry in array.flat
        ):
            # These are fractions, or integers of any size.
            array = array.astype(float)
        if array.dtype.kind not in "iuf":
            raise ValueError
    except (ValueError, OverflowError):
        raise _not_numbers(name, value) from None
    array = array.astype(float, copy=False)
    if array.ndim < len(item) or array.shape[array.ndim - len(item) :] != item:
        raise WrongShape(_shape_message(name, array.shape, item))
    _demand_finite_array(array, name)
    return array


def covariance_array(value: object, size: int) -> Array:
    """Return a covariance, or a batch of them, or raise an error if it cannot be one.

    Each entry is compared with the deviations of its row and its column, which may have different
    units.
    """
    import numpy

    array = number_array(value, (size, size), "covariance")
    variances = numpy.abs(numpy.diagonal(array, axis1=-2, axis2=-1))
    # Beside a variance of zero, every entry but zero is too large.
    deviations = numpy.sqrt(numpy.maximum(variances, 1e-200))
    allowed = COVARIANCE_SLACK * deviations[..., None] * deviations[..., None, :]
    difference = array - array.swapaxes(-1, -2)
    if numpy.any(difference > allowed):
        raise ValueError(
            f"covariance is not symmetric: two entries that must be equal differ by "
            f"{difference.max():.3g}. Is only one half of it filled in, or were its rows and "
            "columns put into different orders?"
        )
    if numpy.any(numpy.linalg.eigvalsh(array / allowed) < -1):
        raise ValueError(
            f"covariance has the eigenvalue {numpy.linalg.eigvalsh(array).min():.3g}, but no "
            "variance is negative. Is an entry outside its diagonal too large, as if it had "
            "another unit, or does -1 stand for an unknown variance, as in ROS?"
        )
    return array


def _demand_finite_array(array: Array, name: str) -> None:
    import numpy

    finite = numpy.isfinite(array)
    if numpy.count_nonzero(finite) < array.size:
        index = tuple(int(k) for k in numpy.argwhere(~finite)[0])
        raise _not_finite(name, index, array[index])


def number_tuples(value: object, shape: tuple[int, ...], name: str) -> Nested:
    """Return a float or nested tuples of floats of exactly this shape, or raise an error.

    It accepts the same values as `number_array`, but no batches, and does not need NumPy. True and
    False are not numbers here.
    """
    result = _tuples(value, name, value)
    shape_found = _shape(result)
    if shape_found is None:
        raise _not_numbers(name, value)
    if shape_found != shape:
        raise WrongShape(
            f"{name} has shape {shape_found}, where {shape or 'one number'} was expected"
        )
    _demand_finite(result, name)
    return result


def _tuples(value: object, name: str, whole: object) -> Nested:
    if hasattr(value, "free_symbols"):
        value = _floats(_listed(value), name)
    elif hasattr(value, "tolist"):
        # An array, or a NumPy number.
        value = _unmasked(value).tolist()
    elif hasattr(value, "__array__"):
        # A table of another library.
        from numpy import asarray

        value = asarray(value).tolist()
    if isinstance(value, Sequence) and not isinstance(value, (str, bytes)):
        return tuple(_tuples(entry, name, whole) for entry in value)
    if not isinstance(value, numbers.Real) or isinstance(value, bool):
        raise _not_numbers(name, whole)
    try:
        return float(value)
    except OverflowError:
        raise _not_numbers(name, whole) from None


def _shape(value: Nested) -> tuple[int, ...] | None:
    """Return the shape of nested tuples, None if they are ragged."""
    if not isinstance(value, tuple):
        return ()
    shapes = set(map(_shape, value)) or {()}
    inner = shapes.pop()
    return None if shapes or inner is None else (len(value), *inner)


def _demand_finite(value: Nested, name: str, index: tuple[int, ...] = ()) -> None:
    if isinstance(value, tuple):
        for k, entry in enumerate(value):
            _demand_finite(entry, name, (*index, k))
    elif not math.isfinite(value):
        raise _not_finite(name, index, value)


def _unmasked(value: Given) -> Given | Array:
    # The masked entries of a masked array are missing.
    if hasattr(value, "filled") and hasattr(value, "astype"):
        filled: Array = value.astype(float).filled(math.nan)
        return filled
    return value


def _not_numbers(name: str, value: object) -> TypeError:
    return TypeError(
        f"{name} must hold real numbers or SymPy expressions in a regular shape, not {value!r}"
        + (
            ". For a rotation of SciPy, use dcm_from_scipy_rotation"
            if hasattr(value, "as_matrix")
            else ". Join numbers and arrays with numpy.stack(numpy.broadcast_arrays(...), axis=-1)"
            if isinstance(value, (list, tuple)) and any(getattr(part, "ndim", 0) for part in value)
            else ""
        )
    )


def _not_finite(name: str, index: tuple[int, ...], value: float) -> ValueError:
    where = f"[{', '.join(map(str, index))}]" if index else ""
    return ValueError(
        f"{name}{where} is {value}: a number is missing, or there was a division by zero"
    )


def _floats(value: object, name: str) -> object:
    """Return nested lists of floats from SymPy objects without symbols."""
    if isinstance(value, list):
        return [_floats(entry, name) for entry in value]
    try:
        return float(value)  # type: ignore[arg-type]  # whether it is one is what is asked
    except TypeError:
        raise SymbolsNotPossible(
            f"{name} holds {value}, and this conversion needs numbers, since it chooses "
            "its formula by their sizes and signs. First substitute numbers, with .subs(...)"
        ) from None


def _listed(value: object) -> object:
    """Return nested lists of the entries of any container; a column or a row becomes one list."""
    if hasattr(value, "tolist"):
        shape = getattr(value, "shape", ())
        rows = value.tolist()
        value = [entry for row in rows for entry in row] if len(shape) == 2 and 1 in shape else rows
    if isinstance(value, (list, tuple)):
        return [_listed(entry) for entry in value]
    if type(value).__name__ == "Tuple" and hasattr(value, "args"):
        return [_listed(entry) for entry in value.args]
    return value


def symbol_components(value: Values, item: tuple[int, ...], name: str) -> list[Expression]:
    """Return the SymPy components of one item of the given shape."""
    import sympy

    if hasattr(value, "to_matrix"):
        raise TypeError(
            f"{name} is the vector {value}; give its components along one frame, using its method "
            "to_matrix"
        )
    nested = _listed(value)
    shape: tuple[int, ...] = ()
    entries: list[object] = [nested]
    if isinstance(nested, list):
        lengths = {len(row) if isinstance(row, list) else 0 for row in nested}
        shape = (len(nested),) if lengths == {0} else (len(nested), *sorted(lengths))
        entries = [entry for row in nested for entry in (row if isinstance(row, list) else [row])]
    if shape != item:
        raise WrongShape(
            _shape_message(name, shape, item) + " (give SymPy expressions one item at a time)"
        )
    try:
        components: list[Expression] = [sympy.sympify(entry, strict=True) for entry in entries]
    except sympy.SympifyError as error:
        raise TypeError(
            f"{name} holds {error.expr!r}, which is neither a number nor a SymPy expression"
        ) from None
    for position, entry in enumerate(components):
        if not isinstance(entry, sympy.Expr):
            raise TypeError(
                f"{name} holds {entry}, which is neither a number nor a SymPy expression"
            )
        if entry.has(sympy.nan, sympy.zoo, sympy.oo, -sympy.oo):
            raise ValueError(
                f"{name} holds {entry} (entry {position}): there was a division by zero"
            )
    return components


def _shape_message(name: str, shape: tuple[int, ...], item: tuple[int, ...]) -> str:
    expected = f"{item} or (..., {', '.join(map(str, item))})" if item else "one number"
    cause = (
        " (put the batch first: numpy.moveaxis(value, -1, 0))"
        if item and shape[: len(item)] == item
        else " (take the rotation out of each pose: value[..., :3, :3])"
        if item == (3, 3) and shape[-2:] in ((3, 4), (4, 4))
        else ""
    )
    return f"{name} has shape {shape}, where {expected} was expected{cause}"


# --- the functions that a formula may use, for each kind ----------------------------------------


class _OneNumber:
    sin = staticmethod(math.sin)
    cos = staticmethod(math.cos)
    atan2 = staticmethod(math.atan2)
    norm = staticmethod(math.hypot)

    @staticmethod
    def where(condition: Truth, yes: float, no: float) -> float:
        return yes if condition else no

    @staticmethod
    def largest(*sizes: float) -> float:
        return max(sizes)

    @staticmethod
    def pick(scores: Sequence[float], rows: Sequence[Sequence[float]]) -> Sequence[float]:
        return rows[scores.index(max(scores))]


NUMBERS: NumberFunctions[float] = _OneNumber()


@functools.cache
def array_functions() -> NumberFunctions[Array]:
    import numpy

    class Columns:
        def __init__(self) -> None:
            self.sin: Callable[[Array], Array] = numpy.sin
            self.cos: Callable[[Array], Array] = numpy.cos
            self.atan2: Callable[[Array, Array], Array] = numpy.arctan2
            self.where: Callable[[Truth, Array | float, Array | float], Array] = numpy.where

        @staticmethod
        def norm(*components: Array | float) -> Array:
            with numpy.errstate(over="ignore"):
                length: Array = numpy.sqrt(
                    functools.reduce(operator.add, (entry * entry for entry in components))
                )
            if numpy.count_nonzero(numpy.isinf(length)):
                # The squares overflow. This way is slower, but gives the same result as for one
                # item.
                length = functools.reduce(numpy.hypot, components, numpy.zeros(()))
            return length

        @staticmethod
        def largest(*sizes: Array) -> Array:
            return functools.reduce(numpy.maximum, sizes)

        @staticmethod
        def pick(scores: Sequence[Array], rows: Sequence[Sequence[Array]], /) -> Sequence[Array]:
            best, picked = scores[0].copy(), [entry.copy() for entry in rows[0]]
            for score, row in zip(scores[1:], rows[1:]):
                better = score > best
                numpy.putmask(best, better, score)
                for entries, others in zip(picked, row):
                    numpy.putmask(entries, better, others)
            return picked

    return Columns()


@functools.cache
def _symbol_functions() -> Functions[Expression]:
    import sympy

    class Expressions:
        sin = staticmethod(sympy.sin)
        cos = staticmethod(sympy.cos)

        @staticmethod
        def where(
            condition: Truth, yes: Expression | float, no: Expression | float, /
        ) -> Expression:
            # Symbols take the general branch. An exact number may take the special one.
            chosen: Expression = sympy.sympify(no if condition == False else yes)  # noqa: E712
            return chosen

        @staticmethod
        def norm(*components: Expression | float) -> Expression:
            root: Expression = sympy.sqrt(sum(entry**2 for entry in components))
            return root

    return Expressions()
