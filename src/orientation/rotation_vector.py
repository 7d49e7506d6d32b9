"""Rotation vectors: the exponential and the logarithm of rotations."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, overload

from .axis_angle import turn_components
from .direction_cosines import DCM_GUARD
from .numbers_and_symbols import evaluate, evaluate_numbers
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
        Values,
    )


@overload
def dcm_from_rotation_vector(vector: Numbers) -> Array: ...
@overload
def dcm_from_rotation_vector(vector: Values) -> Matrix: ...
def dcm_from_rotation_vector(vector: Values) -> Array | Matrix:
    r"""Direction cosine matrix of a rotation vector: the exponential.

    The rotation vector $\mathbf{r} = \theta\,\hat{e}$ points along the axis and is as long as the
    angle. With $\theta = |\mathbf{r}|$,

    $$
    {}^A\mathbf{C}^N = \exp\left(-[\mathbf{r}]_\times\right)
    = \mathbf{I} - \frac{\sin\theta}{\theta}[\mathbf{r}]_\times
    + \frac{1 - \cos\theta}{\theta^2}[\mathbf{r}]_\times^2 .
    $$

    Parameters
    ----------
    vector : SymPy expressions, floats or array of shape ``(3,)`` or ``(..., 3)``
        Radians. The zero vector means no rotation.

    Returns
    -------
    SymPy matrix, array of shape ``(3, 3)`` or stack of shape ``(..., 3, 3)``

    Raises
    ------
    ValueError
        If a shape is wrong or a number is not finite.

    Examples
    --------
    >>> from orientation import dcm_from_rotation_vector, same_orientation, simple_dcm
    >>> same_orientation(dcm_from_rotation_vector((0, 0.3, 0)), simple_dcm('y', 0.3))
    True

    Notes
    -----
    Source: Shuster (1993).
    In the book: equation (14.3).
    """

    def formula(
        f: Functions[Component], x: Component, y: Component, z: Component
    ) -> Sequence[Component]:
        angle = f.norm(x, y, z)
        turning = angle > 0
        # The square of a very small or a very large length loses digits, so divide each component
        # by the length itself.
        length = f.where(turning, angle, 1.0)
        cosine = f.cos(angle)
        return turn_components(
            cosine,
            # In a batch a vector below 1e-162 has the length 0, although its components are not 0.
            f.where(turning, f.sin(angle), 1.0),
            1 - cosine,
            x / length,
            y / length,
            z / length,
        )

    return evaluate(formula, (3, 3), ("vector", vector, (3,)))


def rotation_vector_from_dcm(dcm: Values) -> Array:
    r"""Rotation vector of a direction cosine matrix: the logarithm.

    Parameters
    ----------
    dcm : array of shape ``(3, 3)`` or ``(..., 3, 3)``
        ${}^A\mathbf{C}^N$. Numbers only.

    Returns
    -------
    array of shape ``(3,)`` or ``(..., 3)``
        $\theta\,\hat{e}$ with $\theta$ from 0 to $\pi$, radians.

    Raises
    ------
    ValueError
        If the matrix is not a direction cosine matrix.
    SymbolsNotPossible
        If the matrix holds symbols.

    Examples
    --------
    >>> from orientation import rotation_vector_from_dcm, simple_dcm
    >>> rotation_vector_from_dcm(simple_dcm('z', -0.3)).round(12).tolist()
    [0.0, 0.0, -0.3]
    """

    def formula(f: NumberFunctions[Number], *entries: Number) -> Sequence[Number]:
        scalar, x, y, z = quaternion_components_from_dcm(f, *entries)
        sine = f.norm(x, y, z)
        # Use twice the vector part at rest, and wherever its length is 0 although its components
        # are not.
        share = f.where(sine > 0, 2 * f.atan2(sine, scalar) / f.where(sine > 0, sine, 1.0), 2.0)
        return share * x, share * y, share * z

    return evaluate_numbers(formula, (3,), ("dcm", dcm, (3, 3)), guard=DCM_GUARD)
