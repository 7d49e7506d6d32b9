"""Euler angles: all twelve sequences, body fixed and space fixed, in both directions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, TypeAlias, overload

from .direction_cosines import AXES, DCM_GUARD
from .numbers_and_symbols import evaluate, evaluate_numbers

if TYPE_CHECKING:
    from ._types import (
        Array,
        AxisSequence,
        Component,
        Formula,
        Functions,
        Matrix,
        Number,
        NumberFormula,
        NumberFunctions,
        Numbers,
        Scalars,
        Values,
    )

# The positions of the three axes of a sequence, where the third is the axis that a proper sequence
# leaves out; and 1 if they follow each other as x, y, z do, or else -1.
Layout: TypeAlias = tuple[int, int, int, int]

#: Sequences whose first and last axes are the same.
PROPER_EULER: tuple[AxisSequence, ...] = ("zxz", "xyx", "yzy", "zyz", "xzx", "yxy")

#: Sequences about three different axes.
TAIT_BRYAN: tuple[AxisSequence, ...] = ("xyz", "yzx", "zxy", "xzy", "zyx", "yxz")

#: The twelve sequences of axes that reach every orientation.
SEQUENCES = PROPER_EULER + TAIT_BRYAN


_LAYOUTS: dict[str, Layout] = {
    sequence: (first, second, 3 - first - second, 1 if (second - first) % 3 == 1 else -1)
    for sequence in SEQUENCES
    for first, second in [map(AXES.index, sequence[:2])]
}


def layout_of(sequence: str) -> Layout:
    if isinstance(sequence, str) and sequence in _LAYOUTS:
        return _LAYOUTS[sequence]
    if isinstance(sequence, str) and sequence.lower() in _LAYOUTS:
        cause = (
            f"write {sequence.lower()!r}: sequences are lower case and body fixed; for rotations "
            "about the axes of the fixed frame, use the functions named space_fixed"
        )
    elif isinstance(sequence, str) and len(sequence) == 3 and not set(sequence) - set(AXES):
        cause = (
            "two successive rotations about one axis are a single rotation, so this sequence "
            "cannot describe every orientation"
        )
    else:
        cause = f"the twelve sequences are {', '.join(SEQUENCES)} (3-2-1 is zyx)"
    raise ValueError(f"{sequence!r} is not a sequence of Euler angles: {cause}")


@overload
def dcm_from_body_fixed(angles: Numbers, sequence: AxisSequence) -> Array: ...
@overload
def dcm_from_body_fixed(angles: Values, sequence: AxisSequence) -> Matrix: ...
def dcm_from_body_fixed(angles: Values, sequence: AxisSequence) -> Array | Matrix:
    r"""Direction cosine matrix of three rotations, each about an axis of the rotated frame.

    For the sequence z-x-y, with angles $\psi, \theta, \varphi$,

    $$
    {}^D\mathbf{C}^A = \mathbf{C}_y(\varphi)\,\mathbf{C}_x(\theta)\,\mathbf{C}_z(\psi).
    $$

    Parameters
    ----------
    angles : SymPy expressions or floats ``(psi, theta, phi)``, or array of shape ``(..., 3)``
        Angles in radians, in the order of the rotations.
    sequence : str
        One of `SEQUENCES`, such as ``'zxy'``.

    Returns
    -------
    SymPy matrix, array of shape ``(3, 3)`` or stack of shape ``(..., 3, 3)``
        The matrix of the rotated frame with respect to the first frame.

    Raises
    ------
    ValueError
        If the sequence is not one of the twelve, a shape is wrong or an angle is not finite.

    Examples
    --------
    >>> import sympy as sm
    >>> from orientation import dcm_from_body_fixed
    >>> psi, theta, phi = sm.symbols('psi, theta, varphi')
    >>> dcm_from_body_fixed((psi, theta, phi), 'zxy')[1, 2]
    sin(theta)
    >>> dcm_from_body_fixed([[0.1, 0.2, 0.3], [0.0, 0.5, 1.0]], 'zxy').shape
    (2, 3, 3)

    Notes
    -----
    The three rotations are multiplied out once, for axes in cyclic order; the other order only
    changes the sign of the angles. Source: Shuster (1993), Diebel (2006).
    In the book: equation (6.4).
    """
    return evaluate(body_fixed_formula(sequence), (3, 3), ("angles", angles, (3,)))


def body_fixed_formula(sequence: str) -> Formula:
    """Formula of `dcm_from_body_fixed`, for the components of the angles."""
    i, j, k, sign = layout_of(sequence)
    proper = sequence[0] == sequence[2]

    def formula(
        f: Functions[Component], psi: Component, theta: Component, phi: Component
    ) -> list[Component | float]:
        s1, s2, s3 = sign * f.sin(psi), sign * f.sin(theta), sign * f.sin(phi)
        c1, c2, c3 = f.cos(psi), f.cos(theta), f.cos(phi)
        entries: list[Component | float] = [0] * 9
        if proper:
            entries[3 * i + i], entries[3 * i + j], entries[3 * i + k] = c2, s1 * s2, -c1 * s2
            entries[3 * j + i] = s2 * s3
            entries[3 * j + j] = c1 * c3 - s1 * c2 * s3
            entries[3 * j + k] = s1 * c3 + c1 * c2 * s3
            entries[3 * k + i] = s2 * c3
            entries[3 * k + j] = -c1 * s3 - s1 * c2 * c3
            entries[3 * k + k] = c1 * c2 * c3 - s1 * s3
        else:
            entries[3 * i + i] = c2 * c3
            entries[3 * i + j] = c1 * s3 + s1 * s2 * c3
            entries[3 * i + k] = s1 * s3 - c1 * s2 * c3
            entries[3 * j + i] = -c2 * s3
            entries[3 * j + j] = c1 * c3 - s1 * s2 * s3
            entries[3 * j + k] = s1 * c3 + c1 * s2 * s3
            entries[3 * k + i], entries[3 * k + j], entries[3 * k + k] = s2, -s1 * c2, c1 * c2
        return entries

    return formula


def body_fixed_from_dcm(dcm: Values, sequence: AxisSequence) -> Array:
    r"""Body fixed angles of a direction cosine matrix, for any of the twelve sequences.

    The first angle comes from the row (or column) that the third rotation does not change. Undoing
    the first rotation leaves two simple ones, which give the other two angles. Each step is an
    ``atan2``, so no threshold is needed: at gimbal lock the split between the first and the last
    angle is arbitrary (the first is 0 when the matrix is exactly locked), and the orientation is
    still right to rounding.

    Parameters
    ----------
    dcm : array of shape ``(3, 3)`` or ``(..., 3, 3)``
        ${}^D\mathbf{C}^A$. Numbers only.
    sequence : str
        One of `SEQUENCES`.

    Returns
    -------
    array of shape ``(3,)`` or ``(..., 3)``
        Radians. The first and the last lie in $[-\pi, \pi]$; the middle one in $[-\pi/2, \pi/2]$
        for three different axes, and in $[0, \pi]$ otherwise.

    Raises
    ------
    ValueError
        If the matrix or the sequence is not valid.
    SymbolsNotPossible
        If the matrix holds symbols.

    Examples
    --------
    >>> from orientation import body_fixed_from_dcm, dcm_from_body_fixed
    >>> body_fixed_from_dcm(dcm_from_body_fixed((0.1, 0.2, 0.3), 'zxy'), 'zxy').round(12).tolist()
    [0.1, 0.2, 0.3]

    Notes
    -----
    In the book: equations (10.1) and (10.2).
    """
    i, j, k, sign = layout_of(sequence)
    proper = sequence[0] == sequence[2]

    def formula(f: NumberFunctions[Number], *entries: Number) -> Sequence[Number]:
        def c(row: int, column: int) -> Number:
            return entries[3 * row + column]

        # Adding zero turns -0 into 0: atan2(0, -0) would be pi.
        if proper:
            psi = f.atan2(sign * c(i, j) + 0.0, 0.0 - sign * c(i, k))
        else:
            psi = f.atan2(0.0 - c(k, j), c(k, k) + 0.0)
        sine, cosine = f.sin(psi), f.cos(psi)
        # Undo the first rotation. This is column j of the matrix of the last two.
        jj = c(j, j) * cosine + c(j, k) * sine
        if proper:
            # The sine has the sign of the order. Its magnitude keeps the middle angle in [0, pi].
            theta = sign * f.atan2(abs(c(i, j) * sine - c(i, k) * cosine), c(i, i))
            phi = f.atan2(-c(k, j) * cosine - c(k, k) * sine, jj)
        else:
            theta = f.atan2(c(k, i), c(k, k) * cosine - c(k, j) * sine)
            phi = f.atan2(c(i, j) * cosine + c(i, k) * sine, jj)
        return sign * psi, sign * theta, sign * phi

    return evaluate_numbers(formula, (3,), ("dcm", dcm, (3, 3)), guard=DCM_GUARD)


@overload
def dcm_from_space_fixed(angles: Numbers, sequence: AxisSequence) -> Array: ...
@overload
def dcm_from_space_fixed(angles: Values, sequence: AxisSequence) -> Matrix: ...
def dcm_from_space_fixed(angles: Values, sequence: AxisSequence) -> Array | Matrix:
    r"""Direction cosine matrix of three rotations about the axes of the fixed frame.

    Rotations about fixed axes multiply the matrices in the other order: for the sequence z-x-y,

    $$
    {}^D\mathbf{C}^A = \mathbf{C}_z(\psi)\,\mathbf{C}_x(\theta)\,\mathbf{C}_y(\varphi),
    $$

    which is the body fixed sequence y-x-z with the angles in reverse.

    Parameters, results and errors are those of `dcm_from_body_fixed`.

    Examples
    --------
    >>> from orientation import dcm_from_body_fixed, dcm_from_space_fixed, same_orientation
    >>> same_orientation(dcm_from_space_fixed((0.1, 0.2, 0.3), 'zxy'),
    ...                  dcm_from_body_fixed((0.3, 0.2, 0.1), 'yxz'))
    True
    """
    layout_of(sequence)
    turned = body_fixed_formula(sequence[::-1])

    def formula(
        f: Functions[Component], psi: Component, theta: Component, phi: Component
    ) -> Sequence[Component | float]:
        return turned(f, phi, theta, psi)

    return evaluate(formula, (3, 3), ("angles", angles, (3,)))


def space_fixed_from_dcm(dcm: Values, sequence: AxisSequence) -> Array:
    """Space fixed angles of a direction cosine matrix: see `body_fixed_from_dcm`.

    Examples
    --------
    >>> from orientation import dcm_from_space_fixed, space_fixed_from_dcm
    >>> space_fixed_from_dcm(dcm_from_space_fixed((0.1, 0.2, 0.3), 'xyz'), 'xyz').round(12).tolist()
    [0.1, 0.2, 0.3]
    """
    layout_of(sequence)
    # The reverse of a sequence is another of the twelve.
    return body_fixed_from_dcm(dcm, sequence[::-1])[..., ::-1]  # type: ignore[arg-type]


def gimbal_lock_margin(angles: Values, sequence: AxisSequence) -> Scalars:
    r"""How far three Euler angles are from gimbal lock, in radians.

    Lock is where the first and the last axes are parallel: at $\theta = \pm\pi/2$ for three
    different axes, at $\theta = 0$ or $\pi$ for a sequence that returns to its first axis. The
    margin is the angle between the two axes, from 0 (locked) to $\pi/2$.

    Parameters
    ----------
    angles : floats ``(psi, theta, phi)`` or array of shape ``(..., 3)``
    sequence : str
        One of `SEQUENCES`.

    Returns
    -------
    float or array of shape ``(...)``

    Examples
    --------
    >>> import math
    >>> from orientation import gimbal_lock_margin
    >>> gimbal_lock_margin((0.3, math.pi / 2 - 0.01, 0.1), 'zxy').__round__(12)
    0.01
    """
    return evaluate_numbers(lock_margin_formula(sequence), (), ("angles", angles, (3,)))


def lock_margin_formula(sequence: str) -> NumberFormula:
    """Formula of `gimbal_lock_margin`, for the components of the angles."""
    layout_of(sequence)
    proper = sequence[0] == sequence[2]

    def formula(
        f: NumberFunctions[Number], psi: Number, theta: Number, phi: Number
    ) -> Sequence[Number]:
        sine, cosine = abs(f.sin(theta)), abs(f.cos(theta))
        return [f.atan2(sine, cosine) if proper else f.atan2(cosine, sine)]

    return formula
