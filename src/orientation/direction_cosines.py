"""Direction cosine matrices: simple orientations, validity, and the nearest valid matrix."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple, overload

from .numbers_and_symbols import (
    NUMBERS,
    TOLERANCE,
    Guard,
    evaluate,
    evaluate_numbers,
    is_symbolic,
    item_in_words,
    narrow_type,
    number_array,
    symbol_components,
)
from .random_points import at_random_points

if TYPE_CHECKING:
    import numpy

    from ._types import (
        Array,
        Axis,
        Component,
        Functions,
        Matrix,
        Number,
        NumberFunctions,
        Numbers,
        Values,
    )

AXES: tuple[Axis, ...] = ("x", "y", "z")


@overload
def simple_dcm(axis: Axis, angle: Numbers) -> Array: ...
@overload
def simple_dcm(axis: Axis, angle: Values) -> Matrix: ...
def simple_dcm(axis: Axis, angle: Values) -> Array | Matrix:
    r"""Direction cosine matrix of a simple orientation.

    $A$ is rotated with respect to $N$ through ``angle`` about a unit vector that both share. About
    $z$,

    $$
    {}^A\mathbf{C}^N = \begin{bmatrix} \cos\theta & \sin\theta & 0 \\
    -\sin\theta & \cos\theta & 0 \\ 0 & 0 & 1 \end{bmatrix}.
    $$

    Parameters
    ----------
    axis : {'x', 'y', 'z'}
        The shared unit vector.
    angle : SymPy expression, float or array of shape ``(...)``
        Angle in radians, positive by the right-hand rule.

    Returns
    -------
    SymPy matrix, array of shape ``(3, 3)`` or stack of shape ``(..., 3, 3)``
        ${}^A\mathbf{C}^N$.

    Raises
    ------
    ValueError
        If ``axis`` is not one of the three letters, or an angle is not finite.

    Examples
    --------
    >>> import sympy as sm
    >>> from orientation import simple_dcm
    >>> simple_dcm('z', sm.Symbol('theta'))
    Matrix([
    [ cos(theta), sin(theta), 0],
    [-sin(theta), cos(theta), 0],
    [          0,          0, 1]])
    >>> simple_dcm('x', 0.0).shape
    (3, 3)

    Notes
    -----
    Source: Moore (2022), section "Simple orientations".
    In the book: equation (2.2).
    """
    if not isinstance(axis, str) or axis not in AXES:
        raise ValueError(
            f"axis must be 'x', 'y' or 'z', not {axis!r}; for another direction use "
            "dcm_from_axis_angle, and for -y rotate about y through the negative angle"
        )
    first = AXES.index(axis)
    second, third = (first + 1) % 3, (first + 2) % 3

    def formula(f: Functions[Component], angle: Component) -> list[Component | float]:
        sine, cosine = f.sin(angle), f.cos(angle)
        entries: list[Component | float] = [0] * 9
        entries[4 * first] = 1
        entries[4 * second] = entries[4 * third] = cosine
        entries[3 * second + third], entries[3 * third + second] = sine, -sine
        return entries

    return evaluate(formula, (3, 3), ("angle", angle, ()))


def check_dcm(dcm: Values) -> None:
    r"""Say what is wrong with a matrix that should be a direction cosine matrix.

    A direction cosine matrix has rows of unit length that are perpendicular to each other,
    $\mathbf{C}\mathbf{C}^T = \mathbf{I}$, and $\det\mathbf{C} = +1$. For a valid matrix it returns
    nothing. It never repairs a matrix; `nearest_dcm` does.

    Parameters
    ----------
    dcm : SymPy matrix, or array of shape ``(3, 3)`` or ``(..., 3, 3)``
        ${}^A\mathbf{C}^N$. A symbolic matrix is tested at random values of its symbols.

    Raises
    ------
    ValueError
        With the worst entry and its likely cause, if a shape is wrong, an entry is not finite, the
        matrix is not orthogonal to ``1e-9`` (``4e-6`` in single precision), or it is left-handed.

    Examples
    --------
    >>> from orientation import check_dcm, simple_dcm
    >>> check_dcm(simple_dcm('y', 0.3))
    >>> check_dcm([[1, 0, 0], [0, 1, 0], [0, 0, -1]])  # doctest: +ELLIPSIS
    Traceback (most recent call last):
        ...
    ValueError: dcm is orthogonal but left-handed: its determinant is -1, not +1. One row or ...

    Notes
    -----
    In the book: equation (3.6).
    """
    if is_symbolic(dcm):
        entries = symbol_components(dcm, (3, 3), "dcm")
        unknown = any(entry.free_symbols for entry in entries)
        for (values,) in at_random_points(entries):
            demand_dcm(values, " at random values of its symbols" if unknown else "")
    else:
        evaluate_numbers(_as_they_are, (3, 3), ("dcm", dcm, (3, 3)), guard=DCM_GUARD)


def _as_they_are(f: Functions[Component], *entries: Component) -> Sequence[Component]:
    return entries


def dcm_array(value: Values, name: str) -> Array:
    """Return direction cosine matrices as floats, or raise an error.

    What was valid in single precision becomes valid to the digits of a float.
    """
    array = number_array(value, (3, 3), name)
    check_dcm(value)
    return nearest_dcm(array).dcm if narrow_type([value]) else array


def demand_dcm(
    entries: Sequence[complex], where: str = "", name: str = "dcm", tolerance: float = TOLERANCE
) -> None:
    """Raise the error of `check_dcm` for nine numbers, under the caller's name for them."""
    imaginary = max(abs(entry.imag) for entry in entries)
    if imaginary > tolerance:
        raise ValueError(
            f"{name}{where} is not real: an entry has an imaginary part of {imaginary:.3g}"
        )
    real = [entry.real for entry in entries]
    if not dcm_excess(NUMBERS, *real) <= tolerance:
        explain_dcm(real, where, name)


def dcm_excess(
    f: NumberFunctions[Number],
    xx: Number,
    xy: Number,
    xz: Number,
    yx: Number,
    yy: Number,
    yz: Number,
    zx: Number,
    zy: Number,
    zz: Number,
) -> Number:
    """Return the largest departure from orthonormal rows.

    The third row is also compared with the cross product of the first two.
    """
    return f.largest(
        abs(xx * xx + xy * xy + xz * xz - 1),
        abs(yx * yx + yy * yy + yz * yz - 1),
        abs(xx * yx + xy * yy + xz * yz),
        abs(xy * yz - xz * yy - zx),
        abs(xz * yx - xx * yz - zy),
        abs(xx * yy - xy * yx - zz),
    )


def explain_dcm(entries: Sequence[float], where: str, name: str = "dcm") -> None:
    """Raise the error that explains why nine numbers are not a direction cosine matrix."""
    rows = {"x": entries[:3], "y": entries[3:6], "z": entries[6:]}
    names = list(rows)
    # This order gives the same rounding in every Python and in the page. Since Python 3.12 sum()
    # rounds differently.
    products = {
        (p, q): rows[p][0] * rows[q][0] + rows[p][1] * rows[q][1] + rows[p][2] * rows[q][2]
        for k, p in enumerate(names)
        for q in names[k:]
    }
    faults = {pair: value - (pair[0] == pair[1]) for pair, value in products.items()}
    (p, q), worst = max(faults.items(), key=lambda item: abs(item[1]))
    (a, b, c), (d, e, g), (h, k, m) = rows.values()
    determinant = a * (e * m - g * k) - b * (d * m - g * h) + c * (d * k - e * h)
    if abs(worst) <= TOLERANCE and determinant < 0:
        raise ValueError(
            f"{name}{where} is orthogonal but left-handed: its determinant is {determinant:.6g}, "
            "not +1. "
            "One row or column has the wrong sign, or two are swapped"
        )
    if p == q:
        fault = f"row {p} has length {products[p, q] ** 0.5:.12g}, not 1"
    else:
        fault = f"rows {p} and {q} have dot product {products[p, q]:.6g}, not 0"
    squares = [products[name, name] for name in names]
    # A scale that is closer to 1 than this cannot be distinguished from rounding.
    scaled = (
        abs(worst) > 1e-5
        and max(squares) - min(squares) <= 1e-6 * max(squares)
        and all(abs(value) <= 1e-6 * max(squares) for (p, q), value in products.items() if p != q)
    )
    if max(map(abs, entries)) == 0:
        cause = "Every entry is zero"
    elif scaled:
        cause = (
            f"The whole matrix is {max(squares) ** 0.5:.8g} times an orthogonal one, as if "
            f"from a quaternion that does not have unit length"
        )
    elif abs(worst) < 0.1:
        cause = "Were its entries rounded or measured? nearest_dcm finds the nearest valid matrix"
    else:
        cause = "An entry or a sign is wrong, or the rows are not unit vectors of one triad"
    raise ValueError(f"{name}{where} is not orthogonal: {fault}. {cause}")


#: Every conversion from a direction cosine matrix checks this first.
DCM_GUARD = Guard(dcm_excess, explain_dcm, 9)


class NearestDCM(NamedTuple):
    """Result of `nearest_dcm`: the matrix, and its distance from the given one."""

    dcm: Array
    distance: numpy.float64 | Array


def nearest_dcm(matrix: Values) -> NearestDCM:
    r"""Return the direction cosine matrix nearest to nine numbers, and its distance from them.

    Nearest means smallest Frobenius norm of the difference. With the singular value decomposition
    $\mathbf{M} = \mathbf{U}\boldsymbol{\Sigma}\mathbf{V}^T$ it is $\mathbf{U}\,\mathrm{diag}(1, 1,
    \det(\mathbf{U}\mathbf{V}^T))\,\mathbf{V}^T$.

    Parameters
    ----------
    matrix : array of shape ``(3, 3)`` or ``(..., 3, 3)``
        Measured or rounded entries. Numbers only: for symbols there is no single answer.

    Returns
    -------
    NearestDCM
        ``dcm`` of shape ``(..., 3, 3)`` and ``distance`` of shape ``(...)``.

    Raises
    ------
    ValueError
        If the nearest matrix is not unique, as for a mirror image, or rows that all lie along one
        line.
    SymbolsNotPossible
        If the matrix holds symbols.

    Examples
    --------
    >>> from orientation import nearest_dcm
    >>> nearest = nearest_dcm([[0.8, 0.6, 0], [-0.6, 0.8, 0], [0, 0, 1.01]])
    >>> nearest.dcm[2, 2].item(), round(nearest.distance.item(), 6)
    (1.0, 0.01)

    Notes
    -----
    Source: Kabsch (1978), Umeyama (1991).
    In the book: equation (13.1).
    """
    import numpy

    array = number_array(matrix, (3, 3), "matrix")
    dcm, scales, gap = nearest_by_scales(array)
    excess = gap - TOLERANCE * scales[..., 0]
    if numpy.any(excess <= 0):
        worst = numpy.unravel_index(numpy.argmin(excess), gap.shape)
        where = item_in_words(int(numpy.argmin(excess)), gap.shape)
        if scales[worst][0] == 0:
            raise ValueError(
                f"every entry of matrix{where} is zero, so all orientations are equally near to it"
            )
        raise ValueError(
            f"several direction cosine matrices are equally near to matrix{where}: its singular "
            f"values are {', '.join(f'{scale:z.6f}' for scale in scales[worst])} and its "
            f"determinant is {numpy.linalg.det(array[worst]):z.6f}. "
            "It is a mirror image, or its rows all lie along one line"
        )
    return NearestDCM(dcm, numpy.linalg.norm(dcm - array, axis=(-2, -1)))


def nearest_by_scales(array: Array) -> tuple[Array, Array, Array]:
    """Return the nearest direction cosine matrix, the singular values and their gap.

    The gap is the distance of the singular values from those that allow other, equally near
    matrices.
    """
    import numpy

    left, scales, right = numpy.linalg.svd(array)
    handedness = numpy.sign(numpy.linalg.det(left @ right))
    left[..., :, 2] *= handedness[..., None]
    return left @ right, scales, scales[..., 1] + handedness * scales[..., 2]
