"""One formula for symbols, numbers and batches.

Every conversion of this package is written once, as a formula that takes scalar components and
returns scalar components. This file finds out what it was given (SymPy expressions, plain numbers,
or arrays that hold a batch), hands the components to the formula with the matching ``sin``, ``cos``
and friends, and shapes the results.

SymPy objects are recognised without importing SymPy. One orientation in numbers is computed with Python's
own floats, which is faster than with arrays, and needs NumPy for the result only: where there is none, as in
a browser, the result is a :class:`~orientation._plain_arrays.PlainArray`. Batches need NumPy.
"""

import functools
import math
import numbers
from collections.abc import Callable, Sequence
from types import SimpleNamespace
from typing import Any, NamedTuple

from ._plain_arrays import PlainArray

#: Largest departure from orthogonality, or from unit length, that still counts as rounding.
TOLERANCE = 1e-9

#: Items of a batch that are worked on together, so that their components stay in the cache.
BLOCK = 8192


class SymbolsNotPossible(TypeError):
    """A conversion that must compare sizes to choose its branch was given symbols."""


class WrongShape(ValueError):
    """Something has a shape that a function cannot take."""


class Guard(NamedTuple):
    """What a formula asks of numbers before it is applied to them.

    Attributes
    ----------
    size : int
        How many components it looks at, from the first.
    excess : callable
        ``excess(functions, *components)`` is at most :data:`TOLERANCE` for valid input.
    explain : callable
        ``explain(components, where)`` raises the error that says what is wrong.
    """

    size: int
    excess: Callable[..., Any]
    explain: Callable[[list[float], str], None]


def is_symbolic(value):
    """Tell whether a value is a SymPy object, or a sequence or object array that holds one."""
    if isinstance(value, (list, tuple)):
        return any(is_symbolic(entry) for entry in value)
    if isinstance(value, (PlainArray, float)):
        return False
    if getattr(value, "dtype", None) == object:  # noqa: E721 (not the type of something: a kind of array)
        return is_symbolic(value.tolist())
    return hasattr(value, "free_symbols")


def evaluate(formula, shape, *arguments, guard=None, symbols=True):
    """Apply a formula to its arguments, whatever kind they are of.

    Parameters
    ----------
    formula : callable
        ``formula(functions, *components)`` returns the components of the result.
    shape : tuple
        Shape of one result.
    arguments : tuples ``(name, value, shape)``
        What the caller was given, and the shape of one item of it.
    guard : Guard, optional
    symbols : bool
        False for a formula that needs numbers, to choose its branch by their sizes.
    """
    components = []
    for _, value, item in arguments:
        entries = _at_a_glance(value, item)
        if entries is None:
            break
        components += entries
    else:
        return _evaluate_numbers(formula, shape, components, guard)
    if symbols and any(is_symbolic(value) for _, value, _ in arguments):
        return _evaluate_symbols(formula, shape, arguments, guard)
    single = [one_item(value, item, name) for name, value, item in arguments]
    if None not in single:
        return _evaluate_numbers(formula, shape, [entry for entries in single for entry in entries], guard)
    arrays = [number_array(value, item, name) for name, value, item in arguments]
    return _evaluate_batch(formula, shape, arrays, arguments, guard)


def _at_a_glance(value, item):
    """The floats of one item as a list, where a look is enough to be sure that they are right; else None."""
    kind = type(value)
    if kind is float or kind is int:
        entries = None if item else [value]
    elif kind is tuple or kind is list:
        if len(item) == 2 and len(value) == item[0] and all(type(row) is list and len(row) == item[1] for row in value):
            value = [entry for row in value for entry in row]
        elif len(item) != 1 or len(value) != item[0]:
            return None
        entries = value if _PLAIN.issuperset(map(type, value)) else None
    elif kind is PlainArray and value.shape == item:
        entries = value.entries()
    elif kind.__name__ == "ndarray" and value.shape == item and value.dtype.char == "d":
        entries = value.ravel().tolist()
    else:
        entries = None
    try:
        # The difference is not zero where a number is infinite or missing, or the sum is too large.
        return entries if entries and (total := math.fsum(entries)) - total == 0 else None
    except (OverflowError, ValueError):
        return None


_PLAIN = {float, int}


def one_item(value, item, name):
    """The floats of one item of the given shape as a list; None for what needs NumPy: a batch, or another shape."""
    entries = _at_a_glance(value, item)
    if entries is not None:
        return list(map(float, entries))
    if getattr(value, "ndim", len(item)) != len(item):
        return None
    if isinstance(value, (list, tuple)) and len(value) != sum(item[:1]):
        return None
    try:
        entries = number_tuples(value, item, name)
    except WrongShape:
        return None  # a batch, or a mistake, which number_array explains
    return [entry for row in entries for entry in row] if len(item) == 2 else list(entries) if item else [entries]


def _evaluate_symbols(formula, shape, arguments, guard):
    import sympy

    components = [entry for name, value, item in arguments for entry in symbol_components(value, item, name)]
    if guard:
        _guard_exact_numbers(components, guard)
    result = [sympy.sympify(entry) for entry in formula(_symbol_functions(), *components)]
    if shape == ():
        return result[0]
    return sympy.Matrix(*(shape if len(shape) == 2 else (*shape, 1)), result)


def _guard_exact_numbers(components, guard):
    try:
        numbers = [float(entry) for entry in components[: guard.size]]
    except TypeError:
        return  # symbols: whether they are valid depends on what will be put in for them
    if not guard.excess(NUMBERS, *numbers) <= TOLERANCE:
        guard.explain(numbers, "")


def _evaluate_numbers(formula, shape, components, guard):
    if guard:
        looked_at = components[: guard.size]
        if not guard.excess(NUMBERS, *looked_at) <= TOLERANCE:
            guard.explain([float(entry) for entry in looked_at], "")
    result = formula(NUMBERS, *components)
    if not shape:
        return result[0]
    result = [entry + 0.0 for entry in result]  # adding zero turns -0 into 0, which would look like a wrong sign
    try:
        from numpy import array
    except ModuleNotFoundError:
        return PlainArray.of(result, shape)
    return array(result).reshape(shape) if len(shape) > 1 else array(result)


def _evaluate_batch(formula, shape, arrays, arguments, guard):
    import numpy

    shapes = [array.shape[: array.ndim - len(item)] for array, (_, _, item) in zip(arrays, arguments)]
    if len(set(shapes)) == 1:
        batch = shapes[0]
    else:
        try:
            batch = numpy.broadcast_shapes(*shapes)
        except ValueError:
            described = " and ".join(f"{name} {array.shape}" for array, (name, _, _) in zip(arrays, arguments))
            raise ValueError(f"the batches do not fit each other: {described}") from None
        arrays = [numpy.broadcast_to(array, batch + item) for array, (_, _, item) in zip(arrays, arguments)]
    flat = [array.reshape(math.prod(batch), math.prod(item)) for array, (_, _, item) in zip(arrays, arguments)]
    result = numpy.empty((math.prod(batch), math.prod(shape)))
    functions = _array_functions()
    for start in range(0, len(result), BLOCK):
        components = [column for array in flat for column in numpy.ascontiguousarray(array[start : start + BLOCK].T)]
        if guard:
            with numpy.errstate(over="ignore", invalid="ignore"):  # told below, as an error
                size = guard.excess(functions, *components[: guard.size])
            if not (size <= TOLERANCE).all():
                worst = int(numpy.argmax(size))
                index = [int(k) for k in numpy.unravel_index(start + worst, batch)]
                guard.explain([float(column[worst]) for column in components[: guard.size]], f" (item {index})")
        block = result[start : start + BLOCK]
        rows = numpy.empty(block.shape[::-1])  # written one after another, and turned around at once
        for row, values in zip(rows, formula(functions, *components)):
            row[:] = values
        numpy.add(rows.T, 0.0, out=block)
    return result.reshape(batch + shape)


def number_array(value, item, name):
    """Return a float array of shape ``(..., *item)``, or raise an error that explains.

    SymPy matrices of plain numbers are numbers here; a symbol among them raises
    :class:`SymbolsNotPossible`.
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
            f"{name} is a sequence of {len(value)} arrays, which can be read in two ways: "
            f"join separate components with numpy.stack(..., axis=-1), "
            f"or a list of items with numpy.stack(...)"
        )
    value = _unmasked(value)
    try:
        array = numpy.asarray(value)
        if array.dtype == object and all(
            isinstance(entry, numbers.Real) and not isinstance(entry, bool) for entry in array.flat
        ):
            array = array.astype(float)  # fractions, integers of any size
        if array.dtype.kind not in "iuf":
            raise ValueError
    except (ValueError, OverflowError):
        raise _not_numbers(name, value) from None
    array = array.astype(float, copy=False)
    if array.ndim < len(item) or array.shape[array.ndim - len(item) :] != item:
        raise WrongShape(_shape_message(name, array.shape, item))
    finite = numpy.isfinite(array)
    if not finite.all():
        index = tuple(int(k) for k in numpy.argwhere(~finite)[0])
        raise _not_finite(name, index, array[index])
    return array


def number_tuples(value, shape, name):
    """Return a float, or nested tuples of floats of exactly this shape, or raise an error that explains.

    What :func:`number_array` takes, without batches, and without NumPy; True and False are no numbers here.
    """
    result = _tuples(value, name, value)
    found = _shape(result)
    if found is None:
        raise _not_numbers(name, value)
    if found != shape:
        raise WrongShape(f"{name} has shape {found}, where {shape or 'one number'} was expected")
    _demand_finite(result, name)
    return result


def _tuples(value, name, whole):
    if hasattr(value, "free_symbols"):
        value = _floats(_listed(value), name)
    elif hasattr(value, "tolist"):  # an array, or a number of NumPy
        value = _unmasked(value).tolist()
    if isinstance(value, Sequence) and not isinstance(value, (str, bytes)):
        return tuple(_tuples(entry, name, whole) for entry in value)
    if not isinstance(value, numbers.Real) or isinstance(value, bool):
        raise _not_numbers(name, whole)
    try:
        return float(value)
    except OverflowError:
        raise _not_numbers(name, whole) from None


def _shape(value):
    """Return the shape of nested tuples, None if they are ragged."""
    if not isinstance(value, tuple):
        return ()
    shapes = set(map(_shape, value)) or {()}
    if len(shapes) > 1 or None in shapes:
        return None
    return (len(value), *shapes.pop())


def _demand_finite(value, name, index=()):
    if isinstance(value, tuple):
        for k, entry in enumerate(value):
            _demand_finite(entry, name, (*index, k))
    elif not math.isfinite(value):
        raise _not_finite(name, index, value)


def _unmasked(value):
    # A masked array: what is masked is missing.
    return value.astype(float).filled(math.nan) if hasattr(value, "filled") else value


def _not_numbers(name, value):
    return TypeError(f"{name} must hold real numbers or SymPy expressions in a regular shape, not {value!r}")


def _not_finite(name, index, value):
    where = f"[{', '.join(map(str, index))}]" if index else ""
    return ValueError(f"{name}{where} is {value}: a number is missing or a division by zero happened before")


def _floats(value, name):
    """Nested lists of floats from SymPy objects without symbols."""
    if isinstance(value, list):
        return [_floats(entry, name) for entry in value]
    try:
        return float(value)
    except TypeError:
        raise SymbolsNotPossible(
            f"{name} holds {value}, and this conversion needs numbers: which branch it takes depends "
            f"on their sizes and signs. Put numbers in first, with .subs(...)"
        ) from None


def _listed(value):
    """Nested lists of the entries, whatever holds them; a column or a row becomes one list."""
    if hasattr(value, "tolist"):
        shape = getattr(value, "shape", ())
        flat = len(shape) == 2 and 1 in shape
        value = value.tolist()
        if flat:
            value = [entry for row in value for entry in row]
    if isinstance(value, (list, tuple)) or type(value).__name__ == "Tuple":
        return [_listed(entry) for entry in value]
    return value


def symbol_components(value, item, name):
    """Return the SymPy components of one item of the given shape."""
    import sympy

    if hasattr(value, "to_matrix"):
        raise TypeError(
            f"{name} is the vector {value}: give its components along one frame, which its method to_matrix finds"
        )
    nested = _listed(value)
    if isinstance(nested, list):
        lengths = {len(row) if isinstance(row, list) else 0 for row in nested}
        shape = (len(nested),) if lengths == {0} else (len(nested), *sorted(lengths))
        value = [entry for row in nested for entry in (row if isinstance(row, list) else [row])]
    else:
        shape, value = (), [nested]
    if shape != item:
        raise WrongShape(_shape_message(name, shape, item) + " (SymPy expressions come one item at a time)")
    try:
        components = [sympy.sympify(entry, strict=True) for entry in value]
    except sympy.SympifyError as error:
        raise TypeError(f"{name} holds {error.expr!r}, which is neither a number nor a SymPy expression") from None
    for position, entry in enumerate(components):
        if not isinstance(entry, sympy.Expr):
            raise TypeError(f"{name} holds {entry}, which is neither a number nor a SymPy expression")
        if entry.has(sympy.nan, sympy.zoo, sympy.oo, -sympy.oo):
            raise ValueError(f"{name} holds {entry} (entry {position}): a division by zero happened before")
    return components


def _shape_message(name, shape, item):
    if item == ():
        return f"{name} has shape {shape}, where one number was expected"
    return f"{name} has shape {shape}, where {item} or (..., {', '.join(map(str, item))}) was expected"


# --- the functions that a formula may use, for each kind ----------------------------------------


def _pick_number(scores, rows):
    return rows[scores.index(max(scores))]


NUMBERS = SimpleNamespace(
    sin=math.sin,
    cos=math.cos,
    atan2=math.atan2,
    norm=math.hypot,
    pick=_pick_number,
    where=lambda condition, yes, no: yes if condition else no,
    largest=max,
)


@functools.cache
def _array_functions():
    import numpy

    def pick(scores, rows):
        best = numpy.argmax(scores, axis=0)
        return [numpy.choose(best, entries) for entries in zip(*rows)]

    return SimpleNamespace(
        sin=numpy.sin,
        cos=numpy.cos,
        atan2=numpy.arctan2,
        pick=pick,
        where=numpy.where,
        norm=lambda *components: numpy.sqrt(functools.reduce(numpy.add, map(numpy.square, components))),
        largest=lambda *sizes: functools.reduce(numpy.maximum, sizes),
    )


@functools.cache
def _symbol_functions():
    import sympy

    return SimpleNamespace(
        sin=sympy.sin,
        cos=sympy.cos,
        # Symbols take the general branch; an exact number may decide for the special one.
        where=lambda condition, yes, no: no if condition == False else yes,  # noqa: E712
        norm=lambda *components: sympy.sqrt(sum(entry**2 for entry in components)),
    )
