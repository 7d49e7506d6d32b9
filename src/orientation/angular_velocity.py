"""Orientation in motion: how the angular velocity changes each description.

The angular velocity $\\boldsymbol{\\omega}$ of $A$ in $N$ is given by its components along $A$, as
a gyroscope that is carried by $A$ measures them, in radians per second.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, overload

from .direction_cosines import AXES, DCM_GUARD
from .euler_angles import layout_of
from .numbers_and_symbols import Guard, evaluate

if TYPE_CHECKING:
    from ._types import (
        Array,
        AxisSequence,
        Component,
        Functions,
        Matrix,
        Number,
        NumberFunctions,
        Numbers,
        Values,
    )


@overload
def angular_velocity_matrix(angles: Numbers, sequence: AxisSequence) -> Array: ...
@overload
def angular_velocity_matrix(angles: Values, sequence: AxisSequence) -> Matrix: ...
def angular_velocity_matrix(angles: Values, sequence: AxisSequence) -> Array | Matrix:
    r"""Matrix that converts the rates of body fixed Euler angles to the angular velocity.

    $$
    \boldsymbol{\omega}_D = \mathbf{M}\begin{bmatrix} \dot\psi & \dot\theta & \dot\varphi
    \end{bmatrix}^T
    $$

    Its columns are the axes of the three rotations, with components along the frame $D$ that
    results. At gimbal lock the first and the last column are parallel, the determinant is zero, and
    no rates give an angular velocity in one of the directions.

    Parameters
    ----------
    angles : SymPy expressions or floats ``(psi, theta, phi)``, or array of shape ``(..., 3)``
        Radians.
    sequence : str
        One of `orientation.SEQUENCES`.

    Returns
    -------
    SymPy matrix, array of shape ``(3, 3)`` or stack of shape ``(..., 3, 3)``

    Raises
    ------
    ValueError
        If the sequence is not one of the twelve, a shape is wrong or an angle is not finite.

    Examples
    --------
    >>> import sympy as sm
    >>> from orientation import angular_velocity_matrix
    >>> angular_velocity_matrix(sm.symbols('psi, theta, varphi'), 'zxy')
    Matrix([
    [-sin(varphi)*cos(theta), cos(varphi), 0],
    [             sin(theta),           0, 1],
    [ cos(theta)*cos(varphi), sin(varphi), 0]])

    Notes
    -----
    Source: Kane, Likins and Levinson (1983).
    In the book: equation (9.1).
    """
    i, j, k, sign = layout_of(sequence)
    last = AXES.index(sequence[2])

    def formula(
        f: Functions[Component], psi: Component, theta: Component, phi: Component
    ) -> list[Component | float]:
        s2, c2, s3, c3 = sign * f.sin(theta), f.cos(theta), sign * f.sin(phi), f.cos(phi)
        entries: list[Component | float] = [0] * 9
        entries[3 * last + 2] = 1
        if last == i:
            entries[3 * i], entries[3 * j], entries[3 * k] = c2, s2 * s3, s2 * c3
            entries[3 * j + 1], entries[3 * k + 1] = c3, -s3
        else:
            entries[3 * i], entries[3 * j], entries[3 * k] = c2 * c3, -c2 * s3, s2
            entries[3 * i + 1], entries[3 * j + 1] = s3, c3
        return entries

    return evaluate(formula, (3, 3), ("angles", angles, (3,)))


@overload
def angular_velocity_from_dcm_rate(dcm: Numbers, rate: Numbers) -> Array: ...
@overload
def angular_velocity_from_dcm_rate(dcm: Values, rate: Values) -> Matrix: ...
def angular_velocity_from_dcm_rate(dcm: Values, rate: Values) -> Array | Matrix:
    r"""Angular velocity of a direction cosine matrix that changes.

    This is how the angular velocity is defined: $\dot{\mathbf{C}}\mathbf{C}^T$ is skew-symmetric,
    because $\mathbf{C}\mathbf{C}^T = \mathbf{I}$, and

    $$
    [\boldsymbol{\omega}]_\times =
    -\,\frac{d\,{}^A\mathbf{C}^N}{dt}\left({}^A\mathbf{C}^N\right)^T .
    $$

    Parameters
    ----------
    dcm : SymPy matrix, or array of shape ``(3, 3)`` or ``(..., 3, 3)``
        ${}^A\mathbf{C}^N$.
    rate : SymPy matrix, or array of shape ``(3, 3)`` or ``(..., 3, 3)``
        Its time derivative, per second. If both are measured, the product is not quite
        skew-symmetric, and its skew-symmetric part is used.

    Returns
    -------
    SymPy column of three, array of shape ``(3,)`` or ``(..., 3)``
        Components along $A$, radians per second.

    Raises
    ------
    ValueError
        If a matrix of numbers is not a direction cosine matrix.

    Examples
    --------
    >>> import sympy as sm
    >>> from orientation import angular_velocity_from_dcm_rate, simple_dcm
    >>> t = sm.Symbol('t')
    >>> C = simple_dcm('z', 3*t)
    >>> sm.simplify(angular_velocity_from_dcm_rate(C, C.diff(t))).T
    Matrix([[0, 0, 3]])

    Notes
    -----
    Source: Hughes (1986).
    """

    def formula(f: Functions[Component], *entries: Component) -> Sequence[Component]:
        rows, rates = (
            [entries[k : k + 3] for k in (0, 3, 6)],
            [entries[k : k + 3] for k in (9, 12, 15)],
        )

        def product(i: int, j: int) -> Component:
            (a, b, c), (x, y, z) = rates[i], rows[j]
            return a * x + b * y + c * z

        return [(product(i, j) - product(j, i)) / 2 for i, j in ((1, 2), (2, 0), (0, 1))]

    return evaluate(formula, (3,), ("dcm", dcm, (3, 3)), ("rate", rate, (3, 3)), guard=DCM_GUARD)


@overload
def dcm_rate(dcm: Numbers, angular_velocity: Numbers) -> Array: ...
@overload
def dcm_rate(dcm: Values, angular_velocity: Values) -> Matrix: ...
def dcm_rate(dcm: Values, angular_velocity: Values) -> Array | Matrix:
    r"""Time derivative of a direction cosine matrix.

    $$
    \frac{d}{dt}{}^A\mathbf{C}^N = -[\boldsymbol{\omega}]_\times\,{}^A\mathbf{C}^N
    $$

    Parameters
    ----------
    dcm : SymPy matrix, or array of shape ``(3, 3)`` or ``(..., 3, 3)``
        ${}^A\mathbf{C}^N$. It is not checked: an integration may have let it drift.
    angular_velocity : SymPy expressions, floats or array of shape ``(3,)`` or ``(..., 3)``
        Components along $A$, radians per second.

    Returns
    -------
    SymPy matrix, array of shape ``(3, 3)`` or stack of shape ``(..., 3, 3)``

    Examples
    --------
    >>> from orientation import dcm_rate
    >>> dcm_rate([[1, 0, 0], [0, 1, 0], [0, 0, 1]], (0, 0, 2.0)).tolist()
    [[0.0, 2.0, 0.0], [-2.0, 0.0, 0.0], [0.0, 0.0, 0.0]]

    Notes
    -----
    Source: Hughes (1986).
    In the book: equation (15.3).
    """

    def formula(
        f: Functions[Component],
        xx: Component,
        xy: Component,
        xz: Component,
        yx: Component,
        yy: Component,
        yz: Component,
        zx: Component,
        zy: Component,
        zz: Component,
        x: Component,
        y: Component,
        z: Component,
    ) -> Sequence[Component]:
        return (
            z * yx - y * zx,
            z * yy - y * zy,
            z * yz - y * zz,
            x * zx - z * xx,
            x * zy - z * xy,
            x * zz - z * xz,
            y * xx - x * yx,
            y * xy - x * yy,
            y * xz - x * yz,
        )

    return evaluate(
        formula, (3, 3), ("dcm", dcm, (3, 3)), ("angular_velocity", angular_velocity, (3,))
    )


@overload
def quaternion_rate(quaternion: Numbers, angular_velocity: Numbers) -> Array: ...
@overload
def quaternion_rate(quaternion: Values, angular_velocity: Values) -> Matrix: ...
def quaternion_rate(quaternion: Values, angular_velocity: Values) -> Array | Matrix:
    r"""Time derivative of a quaternion.

    $$
    \dot{q} = \tfrac{1}{2}\,q\,\left(\omega_x i + \omega_y j + \omega_z k\right)
    $$

    Parameters
    ----------
    quaternion : SymPy expressions, floats or array of shape ``(4,)`` or ``(..., 4)``
        Scalar first. It is not checked: an integration may have let its length drift.
    angular_velocity : SymPy expressions, floats or array of shape ``(3,)`` or ``(..., 3)``
        Components along $A$, radians per second.

    Returns
    -------
    SymPy column of four, array of shape ``(4,)`` or ``(..., 4)``

    Examples
    --------
    >>> from orientation import quaternion_rate
    >>> quaternion_rate((1, 0, 0, 0), (0, 0, 2.0)).tolist()
    [0.0, 0.0, 0.0, 1.0]

    Notes
    -----
    Source: Shuster (1993).
    In the book: equation (15.10).
    """

    def formula(
        f: Functions[Component],
        a: Component,
        b: Component,
        c: Component,
        d: Component,
        x: Component,
        y: Component,
        z: Component,
    ) -> Sequence[Component]:
        return (
            (-b * x - c * y - d * z) / 2,
            (a * x + c * z - d * y) / 2,
            (a * y + d * x - b * z) / 2,
            (a * z + b * y - c * x) / 2,
        )

    return evaluate(
        formula,
        (4,),
        ("quaternion", quaternion, (4,)),
        ("angular_velocity", angular_velocity, (3,)),
    )


@overload
def rotation_vector_rate(vector: Numbers, angular_velocity: Numbers) -> Array: ...
@overload
def rotation_vector_rate(vector: Values, angular_velocity: Values) -> Matrix: ...
def rotation_vector_rate(vector: Values, angular_velocity: Values) -> Array | Matrix:
    r"""Time derivative of a rotation vector: Bortz's equation.

    With $\theta = |\mathbf{r}|$,

    $$
    \dot{\mathbf{r}} = \boldsymbol{\omega} + \tfrac{1}{2}\,\mathbf{r}\times\boldsymbol{\omega}
    + \frac{1 - \frac{\theta}{2}\cot\frac{\theta}{2}}{\theta^2}\,
    \mathbf{r}\times(\mathbf{r}\times\boldsymbol{\omega}) .
    $$

    The last factor is $\frac{1}{12}$ at rest and grows without bound towards a whole turn, $\theta
    = 2\pi$, where this description is singular.

    Parameters
    ----------
    vector : SymPy expressions, floats or array of shape ``(3,)`` or ``(..., 3)``
        Rotation vector of $A$ in $N$, radians.
    angular_velocity : SymPy expressions, floats or array of shape ``(3,)`` or ``(..., 3)``
        Components along $A$, radians per second.

    Returns
    -------
    SymPy column of three, array of shape ``(3,)`` or ``(..., 3)``

    Raises
    ------
    ValueError
        If a rotation vector is one or more full turns long, where the rate is not defined.

    Examples
    --------
    >>> from orientation import rotation_vector_rate
    >>> rotation_vector_rate((0.3, 0, 0), (2.0, 0, 0)).tolist()  # about the same axis it just grows
    [2.0, 0.0, 0.0]

    Notes
    -----
    Source: Bortz (1971).
    """

    def excess(f: NumberFunctions[Number], x: Number, y: Number, z: Number) -> Number:
        angle = f.norm(x, y, z)
        return f.where(abs(f.sin(angle / 2)) < 1e-9 * angle, 1, 0)

    def explain(components: Sequence[float], where: str) -> None:
        raise ValueError(
            f"vector{where} is {components}: its length is a whole number of full rotations, where "
            "the rate of a rotation vector is not defined. Subtract a full rotation before the "
            "length reaches it, or use a quaternion"
        )

    def formula(
        f: Functions[Component],
        x: Component,
        y: Component,
        z: Component,
        p: Component,
        q: Component,
        r: Component,
    ) -> Sequence[Component]:
        angle = f.norm(x, y, z)
        turning = angle > 0
        length = f.where(turning, angle, 1.0)
        half = length / 2
        # The difference loses digits at small angles, but it is multiplied by squares of small
        # numbers, so the loss does not matter.
        factor = f.where(turning, (1 - half * f.cos(half) / f.sin(half)) / length / length, 0.0)
        a, b, c = y * r - z * q, z * p - x * r, x * q - y * p
        return (
            p + a / 2 + factor * (y * c - z * b),
            q + b / 2 + factor * (z * a - x * c),
            r + c / 2 + factor * (x * b - y * a),
        )

    return evaluate(
        formula,
        (3,),
        ("vector", vector, (3,)),
        ("angular_velocity", angular_velocity, (3,)),
        guard=Guard(excess, explain, 3),
    )
