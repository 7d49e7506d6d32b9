"""Unit quaternions, scalar first: to and from direction cosine matrices, and their product."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, overload

from .direction_cosines import DCM_GUARD
from .numbers_and_symbols import NUMBERS, TOLERANCE, Guard, evaluate, evaluate_numbers

if TYPE_CHECKING:
    from ._types import (
        Array,
        Component,
        Functions,
        Matrix,
        Number,
        NumberFunctions,
        Numbers,
        Values,
    )


def _length_excess(
    f: NumberFunctions[Number], scalar: Number, x: Number, y: Number, z: Number
) -> Number:
    # The rows of the matrix have the length |q|^2, so a quaternion that passes here gives a matrix
    # that passes as well.
    square = scalar * scalar + x * x + y * y + z * z
    return abs(square * square - 1)


def _explain_length(components: Sequence[float], where: str, name: str = "quaternion") -> None:
    length = sum(entry * entry for entry in components) ** 0.5
    if length == 0:
        cause = "the zero quaternion describes no orientation"
    elif abs(length - 1) < 0.001:
        cause = (
            "were its components rounded when an instrument or a program printed them? "
            "Then divide by the length: q / numpy.linalg.norm(q, axis=-1, keepdims=True)"
        )
    elif abs(length - 1) < 0.05:
        cause = (
            "were its components rounded, or integrated without being normalised? Then divide by "
            "the length"
        )
    else:
        cause = (
            "is the angle halved in both the cosine and the sine, and is the axis a "
            "unit vector? Divide by the length only if you know why it is not 1"
        )
    raise ValueError(f"{name}{where} has length {length:.12g}, not 1: {cause}")


def demand_unit_length(entries: Sequence[complex], name: str, tolerance: float) -> None:
    """Raise the error of four numbers that are not a unit quaternion."""
    real = [entry.real for entry in entries]
    if not _length_excess(NUMBERS, *real) <= tolerance:
        _explain_length(real, "", name)


QUATERNION_GUARD = Guard(_length_excess, _explain_length, 4)


@overload
def dcm_from_quaternion(quaternion: Numbers) -> Array: ...
@overload
def dcm_from_quaternion(quaternion: Values) -> Matrix: ...
def dcm_from_quaternion(quaternion: Values) -> Array | Matrix:
    r"""Direction cosine matrix of a unit quaternion.

    $$
    {}^A\mathbf{C}^N = \begin{bmatrix}
    q_0^2 + q_i^2 - q_j^2 - q_k^2 & 2(q_i q_j + q_0 q_k) & 2(q_i q_k - q_0 q_j) \\
    2(q_i q_j - q_0 q_k) & q_0^2 - q_i^2 + q_j^2 - q_k^2 & 2(q_j q_k + q_0 q_i) \\
    2(q_i q_k + q_0 q_j) & 2(q_j q_k - q_0 q_i) & q_0^2 - q_i^2 - q_j^2 + q_k^2
    \end{bmatrix}
    $$

    Parameters
    ----------
    quaternion : SymPy expressions, floats or array of shape ``(4,)`` or ``(..., 4)``
        Scalar first. Symbols are taken to be of unit length.

    Returns
    -------
    SymPy matrix, array of shape ``(3, 3)`` or stack of shape ``(..., 3, 3)``

    Raises
    ------
    ValueError
        If numbers are not of unit length to ``1e-9`` (``4e-6`` in single precision): the matrix
        would be $|q|^2$ times an orthogonal one. Also if a shape is wrong or a number is not
        finite.

    Examples
    --------
    >>> from orientation import dcm_from_quaternion
    >>> dcm_from_quaternion((0.6, 0, 0, 0.8)).round(12).tolist()
    [[-0.28, 0.96, 0.0], [-0.96, -0.28, 0.0], [0.0, 0.0, 1.0]]

    Notes
    -----
    Source: Shuster (1993), Moore (2022).
    In the book: equation (12.2).
    """

    return evaluate(
        dcm_components_from_quaternion,
        (3, 3),
        ("quaternion", quaternion, (4,)),
        guard=QUATERNION_GUARD,
    )


def dcm_components_from_quaternion(
    f: Functions[Component], scalar: Component, x: Component, y: Component, z: Component
) -> Sequence[Component]:
    """Formula of `dcm_from_quaternion`, shared with the Rodrigues parameters."""
    ss, xx, yy, zz = scalar**2, x**2, y**2, z**2
    first, second = ss + xx, ss - xx
    # Doubling is exact. Each of these products is part of two entries.
    x2, y2, s2 = 2 * x, 2 * y, 2 * scalar
    xy, xz, yz, sx, sy, sz = x2 * y, x2 * z, y2 * z, s2 * x, s2 * y, s2 * z
    return (
        first - yy - zz,
        xy + sz,
        xz - sy,
        xy - sz,
        second + yy - zz,
        yz + sx,
        xz + sy,
        yz - sx,
        second - yy + zz,
    )


def quaternion_components_from_dcm(
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
) -> tuple[Number, Number, Number, Number]:
    """Formula of `quaternion_from_dcm`, shared with the axis and angle."""
    # Each row is four times the quaternion times one of its own components. The longest row loses
    # no digits.
    above, below = 1 + xx, 1 - xx
    scores = [above + yy + zz, above - yy - zz, below + yy - zz, below - yy + zz]
    si, sj, sk, ij, ik, jk = yz - zy, zx - xz, xy - yx, xy + yx, xz + zx, yz + zy
    scalar, x, y, z = f.pick(
        scores,
        [
            (scores[0], si, sj, sk),
            (si, scores[1], ij, ik),
            (sj, ij, scores[2], jk),
            (sk, ik, jk, scores[3]),
        ],
    )
    share = f.where(scalar < 0, -1.0, 1.0) / f.norm(scalar, x, y, z)
    return share * scalar, share * x, share * y, share * z


def quaternion_from_dcm(dcm: Values) -> Array:
    r"""Unit quaternion of a direction cosine matrix, without loss near half a turn.

    Four rows of sums and differences of the entries are each the quaternion times one of its own
    components; the one belonging to the largest component is used, and brought to unit length.

    Parameters
    ----------
    dcm : array of shape ``(3, 3)`` or ``(..., 3, 3)``
        ${}^A\mathbf{C}^N$. Numbers only.

    Returns
    -------
    array of shape ``(4,)`` or ``(..., 4)``
        Scalar first. Of $q$ and $-q$, which are the same orientation, the one with $q_0 \geq 0$; at
        $q_0 = 0$, the one whose largest component is positive.

    Raises
    ------
    ValueError
        If the matrix is not a direction cosine matrix.
    SymbolsNotPossible
        If the matrix holds symbols.

    Examples
    --------
    >>> from orientation import quaternion_from_dcm
    >>> quaternion_from_dcm([[1, 0, 0], [0, -1, 0], [0, 0, -1]]).tolist()
    [0.0, 1.0, 0.0, 0.0]

    Notes
    -----
    Source: Shepperd (1978), Markley (2008).
    In the book: equation (10.4).
    """
    return evaluate_numbers(
        quaternion_components_from_dcm, (4,), ("dcm", dcm, (3, 3)), guard=DCM_GUARD
    )


@overload
def multiply_quaternions(first: Numbers, second: Numbers) -> Array: ...
@overload
def multiply_quaternions(first: Values, second: Values) -> Matrix: ...
def multiply_quaternions(first: Values, second: Values) -> Array | Matrix:
    r"""Hamilton product of two quaternions.

    With $i^2 = j^2 = k^2 = ijk = -1$. If ``first`` rotates $N$ to $A$ and ``second`` rotates $A$ to
    $B$, their product rotates $N$ to $B$: quaternions are written in the order of the rotations,
    and matrices in the opposite order, ${}^B\mathbf{C}^N = {}^B\mathbf{C}^A\,{}^A\mathbf{C}^N$.

    Parameters
    ----------
    first, second : SymPy expressions, floats or arrays of shape ``(4,)`` or ``(..., 4)``
        Scalar first, of any length.

    Returns
    -------
    SymPy column of four, array of shape ``(4,)`` or ``(..., 4)``

    Examples
    --------
    >>> from orientation import multiply_quaternions
    >>> multiply_quaternions((0, 1, 0, 0), (0, 0, 1, 0)).tolist()  # i j = k
    [0.0, 0.0, 0.0, 1.0]

    Notes
    -----
    Source: Hamilton (1844).
    In the book: equation (12.1).
    """
    return evaluate(product_components, (4,), ("first", first, (4,)), ("second", second, (4,)))


def product_components(
    f: Functions[Component],
    a: Component,
    b: Component,
    c: Component,
    d: Component,
    e: Component,
    g: Component,
    h: Component,
    k: Component,
) -> Sequence[Component]:
    """Formula of `multiply_quaternions`."""
    return (
        a * e - b * g - c * h - d * k,
        a * g + b * e + c * k - d * h,
        a * h - b * k + c * e + d * g,
        a * k + b * h - c * g + d * e,
    )


def interpolate_quaternions(first: Values, second: Values, share: Values) -> Array:
    r"""Unit quaternion part of the way from one orientation to another, at constant speed (slerp).

    With the angle $\Omega$ between $q_1$ and $q_2$, taken the shorter way round,

    $$
    q(s) = \frac{\sin((1 - s)\,\Omega)\,q_1 + \sin(s\,\Omega)\,q_2}{\sin\Omega} .
    $$

    Parameters
    ----------
    first, second : floats or arrays of shape ``(4,)`` or ``(..., 4)``
        Unit quaternions, scalar first. Numbers only: which way is shorter depends on them.
    share : float or array of shape ``(...)``
        0 gives the first orientation, 1 the second.

    Returns
    -------
    array of shape ``(4,)`` or ``(..., 4)``
        At 1 it is ``second`` or its negative, which is the same orientation.

    Raises
    ------
    ValueError
        If a quaternion is not of unit length, or the two are half a turn apart, where both ways
        round are equally long.
    SymbolsNotPossible
        If symbols are given.

    Examples
    --------
    >>> from orientation import interpolate_quaternions
    >>> interpolate_quaternions((1, 0, 0, 0), (0.6, 0.8, 0, 0), 0.5).round(12).tolist()
    [0.894427191, 0.4472135955, 0.0, 0.0]

    Notes
    -----
    Source: Shoemake (1985).
    In the book: equation (12.3).
    """

    def excess(f: NumberFunctions[Number], *components: Number) -> Number:
        return f.largest(
            _length_excess(f, *components[:4]),
            _length_excess(f, *components[4:]),
            f.where(abs(_dot(components[:4], components[4:])) > 1e-12, 0, 1),
        )

    def explain(components: Sequence[float], where: str) -> None:
        for name, part in (("first", components[:4]), ("second", components[4:])):
            if _length_excess(NUMBERS, *part) > TOLERANCE:
                _explain_length(part, where, name)
        raise ValueError(
            f"the orientations{where} are half a turn apart, so the two rotations "
            "between them are equally long. Interpolate through a third orientation"
        )

    def formula(
        f: NumberFunctions[Number],
        a: Number,
        b: Number,
        c: Number,
        d: Number,
        e: Number,
        g: Number,
        h: Number,
        k: Number,
        share: Number,
    ) -> Sequence[Number]:
        sign = f.where(_dot((a, b, c, d), (e, g, h, k)) < 0, -1.0, 1.0)
        e, g, h, k = sign * e, sign * g, sign * h, sign * k
        # Half the sum and half the difference give the angle without the loss of an inverse cosine.
        angle = 2 * f.atan2(f.norm(e - a, g - b, h - c, k - d), f.norm(e + a, g + b, h + c, k + d))
        sine = f.sin(angle)
        small = sine < 1e-8
        safe = f.where(small, 1.0, sine)
        near = f.where(small, 1 - share, f.sin((1 - share) * angle) / safe)
        far = f.where(small, share, f.sin(share * angle) / safe)
        return near * a + far * e, near * b + far * g, near * c + far * h, near * d + far * k

    return evaluate_numbers(
        formula,
        (4,),
        ("first", first, (4,)),
        ("second", second, (4,)),
        ("share", share, ()),
        guard=Guard(excess, explain, 8),
    )


def _dot(first: Sequence[Number], second: Sequence[Number]) -> Number:
    (a, b, c, d), (e, g, h, k) = first, second
    return a * e + b * g + c * h + d * k
