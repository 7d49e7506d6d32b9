"""Axis and angle: Euler's theorem, Rodrigues' formula, and back again from 0 to pi."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, overload

from .direction_cosines import DCM_GUARD
from .numbers_and_symbols import Guard, evaluate, evaluate_numbers
from .quaternions import quaternion_components_from_dcm

if TYPE_CHECKING:
    from ._types import (
        Array,
        Component,
        Functions,
        Matrix,
        Number,
        NumberFunctions,
        Numbers,
        Scalars,
        Values,
    )

#: The shortest axis whose direction can be computed. Its inverse is the longest.
SHORTEST = 1e-150


def _length_missing(f: NumberFunctions[Number], x: Number, y: Number, z: Number) -> Number:
    # This is 1, more than the tolerance, if no direction can be computed: beyond these limits the
    # square of the length loses digits, overflows or vanishes.
    square = x * x + y * y + z * z
    return f.where((square > SHORTEST**2) & (square < SHORTEST**-2), 0, 1)


def _explain_zero(components: Sequence[float], where: str) -> None:
    largest = max(map(abs, components))
    if largest:
        raise ValueError(
            f"axis{where} is {tuple(components)}: too {'long' if largest > 1 else 'short'} to "
            f"compute with; divide it by its largest component"
        )
    raise ValueError(
        f"axis{where} is {tuple(components)}: a zero vector has no direction, so it cannot be an "
        "axis. Did you subtract two equal vectors?"
    )


AXIS_GUARD = Guard(_length_missing, _explain_zero, 3)


@overload
def dcm_from_axis_angle(axis: Numbers, angle: Numbers) -> Array: ...
@overload
def dcm_from_axis_angle(axis: Values, angle: Values) -> Matrix: ...
def dcm_from_axis_angle(axis: Values, angle: Values) -> Array | Matrix:
    r"""Direction cosine matrix of a rotation about one axis.

    $A$ is rotated with respect to $N$ through $\theta$ about the unit vector $\hat{e}$, whose
    components are the same in both frames:

    $$
    {}^A\mathbf{C}^N = \cos\theta\,\mathbf{I} + (1 - \cos\theta)\,\hat{e}\hat{e}^T
    - \sin\theta\,[\hat{e}]_\times.
    $$

    Parameters
    ----------
    axis : SymPy expressions, floats or array of shape ``(3,)`` or ``(..., 3)``
        Direction of the axis; its length does not matter, as long as it is not zero.
    angle : SymPy expression, float or array of shape ``(...)``
        Radians, positive by the right-hand rule.

    Returns
    -------
    SymPy matrix, array of shape ``(3, 3)`` or stack of shape ``(..., 3, 3)``

    Raises
    ------
    ValueError
        If the axis is zero, a shape is wrong or a number is not finite.

    Examples
    --------
    >>> from orientation import dcm_from_axis_angle, same_orientation, simple_dcm
    >>> same_orientation(dcm_from_axis_angle((0, -2, 0), 0.3), simple_dcm('y', -0.3))
    True

    Notes
    -----
    Source: the formula of Rodrigues (1840), transposed to act on components.
    In the book: equation (7.2).
    """
    return evaluate(
        axis_angle_formula, (3, 3), ("axis", axis, (3,)), ("angle", angle, ()), guard=AXIS_GUARD
    )


def axis_angle_formula(
    f: Functions[Component], x: Component, y: Component, z: Component, angle: Component
) -> Sequence[Component]:
    """Formula of `dcm_from_axis_angle`, for the components of the axis and the angle."""
    length = f.norm(x, y, z)
    cosine = f.cos(angle)
    return turn_components(cosine, f.sin(angle) / length, (1 - cosine) / length**2, x, y, z)


def turn_components(
    cosine: Component, first: Component, second: Component, x: Component, y: Component, z: Component
) -> Sequence[Component]:
    r"""Return the components of a rotation about a vector, given its cosine and two factors.

    They are those of $c\,\mathbf{I} + s_2\,\mathbf{v}\mathbf{v}^T - s_1\,[\mathbf{v}]_\times$, row
    by row, where the length of the vector has been divided out of both factors.
    """
    sx, sy, sz, rx, ry = first * x, first * y, first * z, second * x, second * y
    xy, xz, yz = rx * y, rx * z, ry * z
    return (
        cosine + rx * x,
        xy + sz,
        xz - sy,
        xy - sz,
        cosine + ry * y,
        yz + sx,
        xz + sy,
        yz - sx,
        cosine + second * z * z,
    )


@overload
def quaternion_from_axis_angle(axis: Numbers, angle: Numbers) -> Array: ...
@overload
def quaternion_from_axis_angle(axis: Values, angle: Values) -> Matrix: ...
def quaternion_from_axis_angle(axis: Values, angle: Values) -> Array | Matrix:
    r"""Unit quaternion of a rotation about one axis.

    $$
    q_0 = \cos\tfrac{\theta}{2}, \qquad
    \begin{bmatrix} q_i & q_j & q_k \end{bmatrix}^T = \sin\tfrac{\theta}{2}\,\hat{e}.
    $$

    Parameters and errors are those of `dcm_from_axis_angle`.

    Returns
    -------
    SymPy column of four, array of shape ``(4,)`` or ``(..., 4)``
        Scalar first.

    Examples
    --------
    >>> import sympy as sm
    >>> from orientation import quaternion_from_axis_angle
    >>> quaternion_from_axis_angle((1, 0, 0), sm.Symbol('theta')).T
    Matrix([[cos(theta/2), sin(theta/2), 0, 0]])

    Notes
    -----
    Source: Moore (2022), section "Alternatives for representing orientation"; Shuster (1993).
    In the book: equation (8.4).
    """

    def formula(
        f: Functions[Component], x: Component, y: Component, z: Component, angle: Component
    ) -> Sequence[Component]:
        share = f.sin(angle / 2) / f.norm(x, y, z)
        return f.cos(angle / 2), share * x, share * y, share * z

    return evaluate(formula, (4,), ("axis", axis, (3,)), ("angle", angle, ()), guard=AXIS_GUARD)


def axis_angle_components(
    f: NumberFunctions[Number], scalar: Number, x: Number, y: Number, z: Number
) -> Sequence[Number]:
    length = f.norm(x, y, z)
    angle = 2 * f.atan2(length, abs(scalar))
    at_rest = length == 0
    share = f.where(scalar < 0, -1.0, 1.0) / f.where(at_rest, 1.0, length)
    return f.where(at_rest, 1.0, share * x), share * y, share * z, angle


def axis_angle_from_dcm(dcm: Values) -> tuple[Array, Scalars]:
    r"""Axis and angle of a direction cosine matrix.

    The quaternion of the matrix is found first, and $\theta = 2\,\mathrm{atan2}(|\mathbf{q}_v|,
    |q_0|)$: exact to rounding from 0 to $\pi$, where the inverse cosine of the trace loses half the
    digits.

    Parameters
    ----------
    dcm : array of shape ``(3, 3)`` or ``(..., 3, 3)``
        ${}^A\mathbf{C}^N$. Numbers only.

    Returns
    -------
    axis : array of shape ``(3,)`` or ``(..., 3)``
        Unit vector; $\hat{n}_x$ when the frames are aligned and any axis would do.
    angle : float or array of shape ``(...)``
        Radians, from 0 to $\pi$.

    Raises
    ------
    ValueError
        If the matrix is not a direction cosine matrix.
    SymbolsNotPossible
        If the matrix holds symbols.

    Examples
    --------
    >>> from orientation import axis_angle_from_dcm, simple_dcm
    >>> axis, angle = axis_angle_from_dcm(simple_dcm('z', -0.5))
    >>> axis.tolist(), round(angle, 12)
    ([0.0, 0.0, -1.0], 0.5)

    Notes
    -----
    In the book: equation (10.3).
    """

    def formula(f: NumberFunctions[Number], *entries: Number) -> Sequence[Number]:
        return axis_angle_components(f, *quaternion_components_from_dcm(f, *entries))

    combined = evaluate_numbers(formula, (4,), ("dcm", dcm, (3, 3)), guard=DCM_GUARD)
    angle = combined[..., -1]
    return combined[..., :-1], angle if angle.ndim else float(angle)
