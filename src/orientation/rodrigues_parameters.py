"""Rodrigues (Gibbs) parameters and modified Rodrigues parameters: three numbers, by a tangent.

Both are projections of the unit quaternions: a line from the centre of the sphere, or from the
quaternion -1, through the quaternion meets a flat three-dimensional space at the parameters.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, overload

from .direction_cosines import DCM_GUARD, dcm_excess, explain_dcm
from .numbers_and_symbols import NUMBERS, TOLERANCE, Guard, evaluate, evaluate_numbers
from .quaternions import dcm_components_from_quaternion, quaternion_components_from_dcm

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


@overload
def dcm_from_rodrigues(vector: Numbers) -> Array: ...
@overload
def dcm_from_rodrigues(vector: Values) -> Matrix: ...
def dcm_from_rodrigues(vector: Values) -> Array | Matrix:
    r"""Direction cosine matrix of Rodrigues parameters, also called the Gibbs vector.

    $\mathbf{g} = \tan\frac{\theta}{2}\,\hat{e}$, and the matrix is Cayley's transform of its cross
    product:

    $$
    {}^A\mathbf{C}^N
    = \left(\mathbf{I} - [\mathbf{g}]_\times\right)
      \left(\mathbf{I} + [\mathbf{g}]_\times\right)^{-1}
    = \frac{(1 - g^2)\,\mathbf{I} + 2\,\mathbf{g}\mathbf{g}^T - 2\,[\mathbf{g}]_\times}{1 + g^2}
    $$

    Parameters
    ----------
    vector : SymPy expressions, floats or array of shape ``(3,)`` or ``(..., 3)``
        No unit.

    Returns
    -------
    SymPy matrix, array of shape ``(3, 3)`` or stack of shape ``(..., 3, 3)``

    Examples
    --------
    >>> from orientation import dcm_from_rodrigues
    >>> dcm_from_rodrigues((0, 0, 1)).round(12).tolist()  # a quarter turn
    [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]

    Notes
    -----
    Source: Rodrigues (1840), Shuster (1993).
    """

    def formula(
        f: Functions[Component], x: Component, y: Component, z: Component
    ) -> Sequence[Component]:
        length = f.norm(1, x, y, z)
        return dcm_components_from_quaternion(f, 1 / length, x / length, y / length, z / length)

    return evaluate(formula, (3, 3), ("vector", vector, (3,)))


def rodrigues_from_dcm(dcm: Values) -> Array:
    r"""Rodrigues parameters, or Gibbs vector, of a direction cosine matrix.

    Parameters
    ----------
    dcm : array of shape ``(3, 3)`` or ``(..., 3, 3)``
        ${}^A\mathbf{C}^N$. Numbers only.

    Returns
    -------
    array of shape ``(3,)`` or ``(..., 3)``
        $\tan\frac{\theta}{2}\,\hat{e}$.

    Raises
    ------
    ValueError
        If the matrix is not a direction cosine matrix, or is that of half a turn, whose parameters
        are infinite.
    SymbolsNotPossible
        If the matrix holds symbols.

    Examples
    --------
    >>> import math
    >>> from orientation import rodrigues_from_dcm, simple_dcm
    >>> rodrigues_from_dcm(simple_dcm('x', math.pi/3)).round(12).tolist()
    [0.57735026919, 0.0, 0.0]
    """

    def excess(f: NumberFunctions[Number], *entries: Number) -> Number:
        scalar, *_ = quaternion_components_from_dcm(f, *entries)
        return f.largest(dcm_excess(f, *entries), f.where(scalar > 1e-12, 0, 1))

    def explain(entries: Sequence[float], where: str) -> None:
        if dcm_excess(NUMBERS, *entries) > TOLERANCE:
            explain_dcm(entries, where)
        raise ValueError(
            f"dcm{where} is a rotation through half a turn, where the Rodrigues parameters, which "
            "contain the tangent of half the angle, are infinite. Use modified Rodrigues "
            "parameters, a quaternion or a rotation vector"
        )

    def formula(f: NumberFunctions[Number], *entries: Number) -> Sequence[Number]:
        scalar, x, y, z = quaternion_components_from_dcm(f, *entries)
        return x / scalar, y / scalar, z / scalar

    return evaluate_numbers(formula, (3,), ("dcm", dcm, (3, 3)), guard=Guard(excess, explain))


@overload
def dcm_from_modified_rodrigues(vector: Numbers) -> Array: ...
@overload
def dcm_from_modified_rodrigues(vector: Values) -> Matrix: ...
def dcm_from_modified_rodrigues(vector: Values) -> Array | Matrix:
    r"""Direction cosine matrix of modified Rodrigues parameters.

    With $\boldsymbol{\sigma} = \tan\frac{\theta}{4}\,\hat{e}$,

    $$
    {}^A\mathbf{C}^N = \mathbf{I} + \frac{8\,[\boldsymbol{\sigma}]_\times^2
    - 4\,(1 - \sigma^2)\,[\boldsymbol{\sigma}]_\times}{(1 + \sigma^2)^2} .
    $$

    Parameters
    ----------
    vector : SymPy expressions, floats or array of shape ``(3,)`` or ``(..., 3)``
        No unit. A vector and its shadow give the same matrix.

    Returns
    -------
    SymPy matrix, array of shape ``(3, 3)`` or stack of shape ``(..., 3, 3)``

    Examples
    --------
    >>> import math
    >>> from orientation import dcm_from_modified_rodrigues, same_orientation, simple_dcm
    >>> same_orientation(dcm_from_modified_rodrigues((0, math.tan(0.3/4), 0)), simple_dcm('y', 0.3))
    True

    Notes
    -----
    Source: Schaub and Junkins (1996).
    """

    def formula(
        f: Functions[Component], x: Component, y: Component, z: Component
    ) -> Sequence[Component]:
        # Beyond this length, whose square overflows, no digit of the matrix would be right.
        ordinary = f.norm(x, y, z) < 1e150
        x, y, z = f.where(ordinary, x, 0), f.where(ordinary, y, 0), f.where(ordinary, z, 0)
        square = x**2 + y**2 + z**2
        whole = 1 + square
        return dcm_components_from_quaternion(
            f, (1 - square) / whole, 2 * x / whole, 2 * y / whole, 2 * z / whole
        )

    return evaluate(formula, (3, 3), ("vector", vector, (3,)))


def modified_rodrigues_from_dcm(dcm: Values) -> Array:
    r"""Modified Rodrigues parameters of a direction cosine matrix.

    Parameters
    ----------
    dcm : array of shape ``(3, 3)`` or ``(..., 3, 3)``
        ${}^A\mathbf{C}^N$. Numbers only.

    Returns
    -------
    array of shape ``(3,)`` or ``(..., 3)``
        $\tan\frac{\theta}{4}\,\hat{e}$ with $\theta$ from 0 to $\pi$: of the vector and its shadow,
        the one that is no longer than 1.

    Raises
    ------
    ValueError
        If the matrix is not a direction cosine matrix.
    SymbolsNotPossible
        If the matrix holds symbols.

    Examples
    --------
    >>> from orientation import modified_rodrigues_from_dcm
    >>> modified_rodrigues_from_dcm([[-1, 0, 0], [0, -1, 0], [0, 0, 1]]).tolist()  # half a turn
    [0.0, 0.0, 1.0]
    """

    def formula(f: NumberFunctions[Number], *entries: Number) -> Sequence[Number]:
        scalar, x, y, z = quaternion_components_from_dcm(f, *entries)
        return x / (1 + scalar), y / (1 + scalar), z / (1 + scalar)

    return evaluate_numbers(formula, (3,), ("dcm", dcm, (3, 3)), guard=DCM_GUARD)


@overload
def shadow_of_modified_rodrigues(vector: Numbers) -> Array: ...
@overload
def shadow_of_modified_rodrigues(vector: Values) -> Matrix: ...
def shadow_of_modified_rodrigues(vector: Values) -> Array | Matrix:
    r"""The other modified Rodrigues parameters of the same orientation: the shadow.

    $$
    \boldsymbol{\sigma}' = -\,\frac{\boldsymbol{\sigma}}{\sigma^2}
    $$

    It belongs to the quaternion $-q$, the rotation the other way round. Switch to it whenever
    $\sigma$ becomes longer than 1, to avoid the singularity at a full turn.

    Parameters
    ----------
    vector : SymPy expressions, floats or array of shape ``(3,)`` or ``(..., 3)``
        Not zero, since the shadow of the zero vector is infinitely far away.

    Returns
    -------
    SymPy column of three, array of shape ``(3,)`` or ``(..., 3)``

    Raises
    ------
    ValueError
        If a vector is zero, or so short that its shadow overflows.

    Examples
    --------
    >>> from orientation import shadow_of_modified_rodrigues
    >>> shadow_of_modified_rodrigues((0, 0, 0.5)).tolist()
    [0.0, 0.0, -2.0]
    """

    def excess(f: NumberFunctions[Number], x: Number, y: Number, z: Number) -> Number:
        return f.where(x * x + y * y + z * z > 1e-300, 0, 1)

    def explain(components: Sequence[float], where: str) -> None:
        raise ValueError(
            f"vector{where} is {components}, which describes no rotation, so its shadow "
            "would be infinitely long"
        )

    def formula(
        f: Functions[Component], x: Component, y: Component, z: Component
    ) -> Sequence[Component]:
        length = f.norm(x, y, z)
        return -x / length / length, -y / length / length, -z / length / length

    return evaluate(formula, (3,), ("vector", vector, (3,)), guard=Guard(excess, explain))
