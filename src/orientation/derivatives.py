"""Derivatives of conversions, and with them covariances, from the one formula of each.

A formula takes scalar components and returns scalar components. Given numbers with their slopes
(dual numbers), it also returns the slopes of the result, for one item and for batches; for symbols,
SymPy differentiates it.

An orientation has three ways to change, but a direction cosine matrix has nine entries. So a matrix
is represented here by the small rotation $\\boldsymbol\\delta$ that changes it,

$$
{}^A\\mathbf{C}^N(\\boldsymbol\\delta)
= \\exp(-[\\boldsymbol\\delta]_\\times)\\,{}^A\\mathbf{C}^N ,
$$

with components along $A$, as everywhere in this package, or along $N$ on request.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

from .direction_cosines import DCM_GUARD
from .numbers_and_symbols import (
    Argument,
    Guard,
    Variable,
    array_functions,
    columns_of,
    covariance_array,
    demand,
    is_symbolic,
    item_in_words,
    number_array,
    symbol_components,
)

if TYPE_CHECKING:
    from ._types import Array, Conversion, Matrix, NumberFormula, Numbers, Symbols, Truth, Values

#: Above this standard deviation a first-order covariance means little, because the result is no
#: longer linear over such a range.
LARGE = 0.5

#: A larger slope is the effect of a singularity and of rounding.
STEEP = 1e10

#: Components of $-[\hat e_k]_\times$, the derivative of a rotation about axis k at zero.
TURNS = (
    ((0, 0, 0), (0, 0, 1), (0, -1, 0)),
    ((0, 0, -1), (0, 0, 0), (1, 0, 0)),
    ((0, 1, 0), (-1, 0, 0), (0, 0, 0)),
)

Along = Literal["target", "source"]


class Dual:
    """A batch of numbers with their slopes, of shape ``(count, ...)``: one for each variable."""

    __slots__ = ("value", "slopes")
    # With this attribute NumPy leaves operations with an array to the methods below.
    __array_ufunc__ = None

    def __init__(self, value: Array, slopes: Array) -> None:
        self.value, self.slopes = value, slopes

    def __add__(self, other: Dual | Array | float) -> Dual:
        if isinstance(other, Dual):
            return Dual(self.value + other.value, self.slopes + other.slopes)
        return Dual(self.value + other, self.slopes)

    __radd__ = __add__

    def __neg__(self) -> Dual:
        return Dual(-self.value, -self.slopes)

    def __sub__(self, other: Dual | Array | float) -> Dual:
        return self + -other

    def __rsub__(self, other: Array | float) -> Dual:
        return -self + other

    def __mul__(self, other: Dual | Array | float) -> Dual:
        if isinstance(other, Dual):
            slopes = self.slopes * other.value + self.value * other.slopes
            return Dual(self.value * other.value, slopes)
        return Dual(self.value * other, self.slopes * other)

    __rmul__ = __mul__

    def __truediv__(self, other: Dual | Array | float) -> Dual:
        if not isinstance(other, Dual):
            return self * (1 / other)
        share = self.value / other.value
        return Dual(share, (self.slopes - share * other.slopes) / other.value)

    def __rtruediv__(self, other: Array | float) -> Dual:
        return Dual(0 * self.value + other, 0 * self.slopes) / self

    def __pow__(self, power: int) -> Dual:
        return Dual(self.value**power, power * self.value ** (power - 1) * self.slopes)

    def __abs__(self) -> Dual:
        import numpy

        return self * numpy.where(self.value < 0, -1.0, 1.0)

    def __lt__(self, other: float) -> Truth:
        return self.value < other

    def __gt__(self, other: float) -> Truth:
        return self.value > other


def parts(entry: Dual | Array | float) -> tuple[Array | float, Array | float]:
    """Return the value and the slopes of a component, which may be constant."""
    return (entry.value, entry.slopes) if isinstance(entry, Dual) else (entry, 0.0)


class DualFunctions:
    """The functions that formulas use, for numbers with slopes."""

    def __init__(self) -> None:
        self.plain = array_functions()

    def sin(self, angle: Dual) -> Dual:
        return Dual(self.plain.sin(angle.value), self.plain.cos(angle.value) * angle.slopes)

    def cos(self, angle: Dual) -> Dual:
        return Dual(self.plain.cos(angle.value), -self.plain.sin(angle.value) * angle.slopes)

    def atan2(self, sine: Dual, cosine: Dual) -> Dual:
        square = sine.value**2 + cosine.value**2
        slopes = (cosine.value * sine.slopes - sine.value * cosine.slopes) / square
        return Dual(self.plain.atan2(sine.value, cosine.value), slopes)

    def norm(self, *components: Dual | float) -> Dual:
        values, slopes = zip(*map(parts, components))
        length = self.plain.norm(*values)
        # The length has no slope at zero. There formulas use only results that do not depend on it.
        safe = self.plain.where(length > 0, length, 1.0)
        return Dual(length, sum(value / safe * by for value, by in zip(values, slopes)))

    def where(self, condition: Truth, yes: Dual | float, no: Dual | float) -> Dual | Array:
        where = self.plain.where
        if not isinstance(yes, Dual) and not isinstance(no, Dual):
            return where(condition, yes, no)
        (value, slopes), (alternative, alternative_slopes) = parts(yes), parts(no)
        return Dual(
            where(condition, value, alternative), where(condition, slopes, alternative_slopes)
        )

    def pick(self, scores: Sequence[Dual], rows: Sequence[Sequence[Dual]]) -> Sequence[Dual]:
        import numpy

        best = numpy.argmax([score.value for score in scores], axis=0)
        return [
            Dual(
                numpy.choose(best, [entry.value for entry in entries]),
                numpy.choose(best, [entry.slopes for entry in entries]),
            )
            for entries in zip(*rows)
        ]


class _Numbers(Variable):
    """Numbers with respect to which a conversion is differentiated."""

    def __init__(self, given: Values, along: Along) -> None:
        self.given, self.along = given, along

    def slopes_of(
        self,
        formula: NumberFormula,
        shape: tuple[int, ...],
        arguments: Sequence[Argument],
        guard: Guard | None,
    ) -> Array:
        import numpy

        batch, flat = columns_of(
            [
                (
                    name,
                    number_array(value.given if isinstance(value, _Numbers) else value, item, name),
                    item,
                )
                for name, value, item in arguments
            ]
        )
        columns = [column for rows in flat for column in rows.T]
        if guard:
            demand(guard, columns, batch)
        components = [
            entry
            for (_, value, item), rows in zip(arguments, flat)
            for entry in (
                self._with_slopes(rows, item)
                if isinstance(value, _Numbers)
                else [Dual(column, numpy.zeros((1, len(column)))) for column in rows.T]
            )
        ]
        count = max(len(entry.slopes) for entry in components)
        with numpy.errstate(divide="ignore", invalid="ignore"):
            # No type can express that a formula works with anything that has these operations.
            result = map(parts, formula(DualFunctions(), *components))  # type: ignore[arg-type]
            unit_slopes = numpy.ones((count, len(columns[0])))
            values, slopes = zip(
                *((value * unit_slopes[0], by * unit_slopes) for value, by in result)
            )
            if shape == (3, 3):
                demand(DCM_GUARD, values, batch)
                slopes = tuple(self._turns(values, slopes))
                shape = (3,)
        derivative = numpy.stack(slopes, axis=-1)
        steep = ~(numpy.abs(derivative) < STEEP).all(axis=(0, -1))
        if steep.any():
            raise ValueError(
                f"the conversion has no derivative at {arguments[0][0]}"
                f"{item_in_words(int(numpy.argmax(steep)), batch)}: a small change in "
                "the input makes a large one in the result, as with Euler angles at gimbal lock"
            )
        return derivative.reshape(count, *batch, *shape)

    def _with_slopes(self, rows: Array, item: tuple[int, ...]) -> list[Dual]:
        """Return the components of items as variables, three small rotations for a matrix."""
        import numpy

        slopes = numpy.eye(rows.shape[1])[:, None]
        if item == (3, 3):
            matrices, turns = rows.reshape(-1, 3, 3), numpy.array(TURNS, dtype=float)[:, None]
            turned = turns @ matrices if self.along == "target" else matrices @ turns
            slopes = turned.reshape(3, -1, 9)
        return [Dual(column, slopes[..., k]) for k, column in enumerate(rows.T)]

    def _turns(self, values: Sequence[Array], slopes: Sequence[Array]) -> list[Array]:
        """Return the small rotations that change a matrix at these slopes of its entries."""
        import numpy

        matrix = numpy.stack(values, axis=-1).reshape(-1, 3, 3)
        rates = numpy.stack(slopes, axis=-1).reshape(len(slopes[0]), -1, 3, 3)
        back = matrix.swapaxes(-1, -2)
        # Either way this is -[delta] x, with the components along the chosen frame.
        skew = rates @ back if self.along == "target" else back @ rates
        return [skew[..., 1, 2], skew[..., 2, 0], skew[..., 0, 1]]


def jacobian(
    conversion: Conversion, value: Values, *further: object, along: Along = "target"
) -> Array | Matrix:
    r"""Derivative of the result of a conversion with respect to its input.

    A direction cosine matrix, given or returned, counts as the three components of a small
    rotation: ${}^A\mathbf{C}^N$ becomes $\exp(-[\boldsymbol\delta]_\times)\,{}^A\mathbf{C}^N$.

    Parameters
    ----------
    conversion : callable
        A conversion of this package, such as `body_fixed_from_dcm`, or a function of one argument
        that calls one.
    value : SymPy expressions, floats or array of shape ``(*item)`` or ``(..., *item)``
        The first argument of the conversion, the input with respect to which to differentiate.
    *further
        Its other arguments, which are constant.
    along : {'target', 'source'}
        The frame for the components of a small rotation: $A$ or $N$ of ${}^A\mathbf{C}^N$.

    Returns
    -------
    SymPy matrix, array of shape ``(m, n)`` or ``(..., m, n)``
        With ``m`` components of the result and ``n`` of ``value``. An axis and an angle count as
        four, the angle last.

    Raises
    ------
    ValueError
        If the conversion has no derivative there, as for Euler angles at gimbal lock, or it returns
        a matrix that is not a direction cosine matrix.

    Examples
    --------
    A small rotation about the last axis of the sequence changes only the last angle:

    >>> from orientation import body_fixed_from_dcm, dcm_from_body_fixed, jacobian
    >>> D_C_A = dcm_from_body_fixed((0.1, 0.2, 0.3), 'zxy')
    >>> (jacobian(body_fixed_from_dcm, D_C_A, 'zxy')[:, 1].round(12) + 0.0).tolist()
    [0.0, 0.0, 1.0]

    Notes
    -----
    The formula of the conversion is evaluated with numbers that carry their slopes. Source:
    Griewank and Walther (2008), chapter 3.
    """
    if along not in ("target", "source"):
        raise ValueError(f"along must be 'target' or 'source', not {along!r}")
    if is_symbolic(value):
        return _jacobian_of_symbols(conversion, value, further, along)
    import numpy

    result = conversion(_Numbers(value, along), *further)
    parts = result if isinstance(result, tuple) else (result,)
    # Axis and angle are two results: the angle has one axis of the array less.
    most = max(part.ndim for part in parts)
    joined = numpy.concatenate(
        [part if part.ndim == most else part[..., None] for part in parts], axis=-1
    )
    derivative: Array = numpy.moveaxis(joined, 0, -1)
    return derivative


def propagate_covariance(
    conversion: Conversion,
    value: Numbers,
    covariance: Numbers,
    *further: object,
    along: Along = "target",
) -> Array:
    r"""Covariance of the result of a conversion, to first order.

    $$
    \mathbf{P}_y = \mathbf{J}\,\mathbf{P}_x\,\mathbf{J}^T
    $$

    with the `jacobian` of the conversion. The covariance of a direction cosine matrix is that of
    the small rotation $\boldsymbol\delta$, in square radians.

    Parameters
    ----------
    conversion, value, further, along
        As for `jacobian`. ROS states the covariance of small rotations about fixed axes: those of
        $N$, ``along='source'``.
    covariance : array of shape ``(n, n)`` or ``(..., n, n)``

    Returns
    -------
    array of shape ``(m, m)`` or ``(..., m, m)``

    Warns
    -----
    UserWarning
        If a standard deviation exceeds half a radian, where first order means little. Close to
        gimbal lock, the first and the last angle spread that far.

    Raises
    ------
    ValueError
        As `jacobian`, and if the shapes do not fit or the matrix cannot be a covariance.

    Examples
    --------
    >>> import numpy as np
    >>> from orientation import body_fixed_from_dcm, dcm_from_body_fixed, propagate_covariance
    >>> D_C_A = dcm_from_body_fixed((0.1, 1.0, 0.3), 'zxy')
    >>> spread = propagate_covariance(body_fixed_from_dcm, D_C_A, 1e-4 * np.eye(3), 'zxy')
    >>> np.sqrt(np.diag(spread)).round(4).tolist()
    [0.0185, 0.01, 0.0185]
    """
    import numpy

    derivative = jacobian(conversion, value, *further, along=along)
    input_covariance = covariance_array(covariance, derivative.shape[-1])
    result: Array = derivative @ input_covariance @ derivative.swapaxes(-1, -2)
    largest = float(numpy.sqrt(numpy.max(numpy.diagonal(result, axis1=-2, axis2=-1), initial=0)))
    if largest > LARGE:
        warnings.warn(
            f"a standard deviation comes out as {largest:.3g}, which is too large for a "
            "first-order covariance. Near gimbal lock, use the covariance of the small rotation "
            "instead of that of the angles",
            stacklevel=2,
        )
    return result


def _jacobian_of_symbols(
    conversion: Conversion, value: Symbols, further: Sequence[object], along: Along
) -> Matrix:
    import sympy

    column = sympy.Matrix([value]) if isinstance(value, sympy.Expr) else sympy.Matrix(value)
    entries = symbol_components(list(column), (len(column),), "value")
    stand_ins = [sympy.Dummy(f"x{k}") for k in range(len(entries))]
    result = conversion(stand_ins[0] if isinstance(value, sympy.Expr) else stand_ins, *further)
    back = dict(zip(stand_ins, entries))
    if result.shape != (3, 3):
        return result.jacobian(stand_ins).xreplace(back)
    turns = []
    for stand_in in stand_ins:
        rate = result.diff(stand_in)
        skew = rate * result.T if along == "target" else result.T * rate
        turns.append([skew[1, 2], skew[2, 0], skew[0, 1]])
    return sympy.Matrix(turns).T.xreplace(back)
