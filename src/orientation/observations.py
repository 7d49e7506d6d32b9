"""Orientation from observed directions: two vectors, or many with weights.

The components of a direction along a frame $N$ are known (up, north, a star); those along a body
$B$ are measured. Two directions that are not parallel determine ${}^B\\mathbf{C}^N$; to more than
two, the orientation is fitted.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from .direction_cosines import nearest_by_scales
from .numbers_and_symbols import number_array

if TYPE_CHECKING:
    from ._types import Array, Numbers, Values

#: Two directions count as one if the sine of the angle between them is below this.
PARALLEL = 1e-6
#: A singular value below this fraction of the largest is rounding.
ROUNDING = 1e-13


def dcm_from_two_directions(observed: Values, reference: Values) -> Array:
    r"""Direction cosine matrix that two observed directions fix: the TRIAD method.

    The first direction counts as exact, and the second determines only the rotation about the
    first. Each pair gives a right-handed triad, $\hat{t}_1 = \hat{u}_1$, $\hat{t}_2 \parallel
    \hat{u}_1 \times \hat{u}_2$, $\hat{t}_3 = \hat{t}_1 \times \hat{t}_2$; with the triads as rows
    of $\mathbf{T}_B$ (observed) and $\mathbf{T}_N$ (reference),

    $$
    {}^B\mathbf{C}^N = \mathbf{T}_B^T\,\mathbf{T}_N .
    $$

    Parameters
    ----------
    observed : array of shape ``(2, 3)`` or ``(..., 2, 3)``
        The two directions along $B$, of any length.
    reference : array of shape ``(2, 3)`` or ``(..., 2, 3)``
        The same two directions along $N$, in the same order.

    Returns
    -------
    array of shape ``(3, 3)`` or ``(..., 3, 3)``
        ${}^B\mathbf{C}^N$.

    Raises
    ------
    ValueError
        If a direction is zero, or two directions that should differ are parallel.

    Examples
    --------
    >>> from orientation import dcm_from_two_directions, same_orientation, simple_dcm
    >>> B_C_N = simple_dcm('y', 0.4)
    >>> up_and_north = [[0, 0, 1], [1, 0, 0]]
    >>> same_orientation(dcm_from_two_directions(up_and_north @ B_C_N.T, up_and_north), B_C_N)
    True

    Notes
    -----
    Source: Black (1964); Shuster and Oh (1981).
    In the book: equation (18.6).
    """
    body, fixed = (
        _triad(number_array(pair, (2, 3), name), name)
        for pair, name in ((observed, "observed"), (reference, "reference"))
    )
    return body.swapaxes(-1, -2) @ fixed


def _triad(pair: Array, name: str) -> Array:
    import numpy

    first, second = (unit_directions(pair[..., k, :], name) for k in (0, 1))
    across = numpy.cross(first, second)
    sine = numpy.linalg.norm(across, axis=-1, keepdims=True)
    if not numpy.all(sine > PARALLEL):
        raise ValueError(
            f"the two {name} directions are parallel or opposite (the sine of the angle between "
            f"them is {sine.min():.1e}), so they do not determine the rotation around them. Take "
            "a second direction well away from the first."
        )
    across = across / sine
    return numpy.stack([first, across, numpy.cross(first, across)], axis=-2)


def unit_directions(directions: Array, name: str) -> Array:
    """Return directions of any length at unit length."""
    import numpy

    length = numpy.linalg.norm(directions, axis=-1, keepdims=True)
    if not numpy.all(length > 0):
        raise ValueError(
            f"{name} has a direction of length zero. Was a missing measurement stored as 0?"
        )
    units: Array = directions / length
    return units


def dcm_from_directions(
    observed: Numbers, reference: Numbers, deviations: Values | None = None
) -> Array:
    r"""Direction cosine matrix that fits many observed directions best: Wahba's problem.

    Finds the ${}^B\mathbf{C}^N$ with the least

    $$
    \tfrac12 \sum_k \frac{1}{\sigma_k^2}\,\bigl|\hat{b}_k - {}^B\mathbf{C}^N\,\hat{n}_k\bigr|^2 ,
    $$

    by the singular value decomposition of $\sum_k \hat{b}_k \hat{n}_k^T / \sigma_k^2 =
    \mathbf{U}\mathbf{S}\mathbf{V}^T$: it is $\mathbf{U}\,\mathrm{diag}(1, 1,
    \det\mathbf{U}\mathbf{V}^T)\, \mathbf{V}^T$, the direction cosine matrix nearest to that sum, as
    in `nearest_dcm`.

    Parameters
    ----------
    observed : array of shape ``(count, 3)`` or ``(..., count, 3)``
        Directions $\hat{b}_k$ along $B$, of any length.
    reference : array of shape ``(count, 3)`` or ``(..., count, 3)``
        The same directions $\hat{n}_k$ along $N$.
    deviations : array of shape ``(count,)``, optional
        Standard deviation $\sigma_k$ of each direction in radians, perpendicular to it. If they are
        omitted, all directions have the same weight.

    Returns
    -------
    array of shape ``(3, 3)`` or ``(..., 3, 3)``
        ${}^B\mathbf{C}^N$.

    Raises
    ------
    ValueError
        If shapes do not fit, a deviation is not positive, or the directions lie along one line.

    Examples
    --------
    >>> import numpy as np
    >>> from orientation import dcm_from_body_fixed, dcm_from_directions, same_orientation
    >>> B_C_N = dcm_from_body_fixed((0.3, -1.1, 2.0), 'zxy')
    >>> stars = np.array([[1, 0, 0], [0.8, 0.6, 0], [0.7, 0.1, 0.7]])
    >>> same_orientation(dcm_from_directions(stars @ B_C_N.T, stars), B_C_N)
    True

    Notes
    -----
    Source: Wahba (1965); Markley (1988).
    In the book: equation (18.7).
    """
    import numpy

    observed, reference, weights = _weighted(observed, reference, deviations)
    fitted, scales, gap = nearest_by_scales((weights * observed).swapaxes(-1, -2) @ reference)
    # How far the worst-determined of the three rotations would have to be wrong before another
    # orientation fits as well, as a fraction of what these weights allow. Beside a star tracker, a
    # magnetometer has a millionth of the weight, but it still determines the rotation about the
    # star.
    margin = gap / max(weights.sum() - weights.max(), sys.float_info.min)
    if not numpy.all((margin > PARALLEL) & (gap > ROUNDING * scales[..., 0])):
        raise ValueError(
            f"the directions do not determine an orientation (margin {numpy.min(margin):.1e}): "
            "they lie along one line, or observed and reference are mirror images of each other. "
            "Is one of the two frames left-handed?"
        )
    return fitted


def directions_covariance(observed: Numbers, deviations: Values) -> Array:
    r"""Covariance of the error of an orientation that was fitted to directions.

    The error is the small rotation vector $\boldsymbol\delta$ from the estimated body to the true
    one, along $B$, with ${}^B\mathbf{C}^N = \exp(-[\boldsymbol\delta]_\times)\,{}^{\hat
    B}\mathbf{C}^N$. Each direction determines the rotations about axes perpendicular to it, but not
    the rotation about itself:

    $$
    \mathbf{P}^{-1} = \sum_k \frac{1}{\sigma_k^2}\left(\mathbf{I} - \hat{b}_k \hat{b}_k^T\right)
    .
    $$

    Parameters
    ----------
    observed : array of shape ``(count, 3)`` or ``(..., count, 3)``
        Directions along $B$, of any length.
    deviations : array of shape ``(count,)``
        Standard deviation of each in radians, in every direction perpendicular to it.

    Returns
    -------
    array of shape ``(3, 3)`` or ``(..., 3, 3)``
        Square radians.

    Raises
    ------
    ValueError
        If shapes do not fit, a deviation is not positive, or the directions lie along one line.

    Examples
    --------
    >>> from orientation import directions_covariance
    >>> directions_covariance([[1, 0, 0], [0, 1, 0]], [0.01, 0.01]).round(6).tolist()
    [[0.0001, 0.0, 0.0], [0.0, 0.0001, 0.0], [0.0, 0.0, 5e-05]]

    Notes
    -----
    Source: Shuster and Oh (1981).
    In the book: equation (18.8).
    """
    import numpy

    units, _, weights = _weighted(observed, observed, deviations)
    information = weights.sum() * numpy.eye(3) - (weights * units).swapaxes(-1, -2) @ units
    if not numpy.all(numpy.linalg.eigvalsh(information)[..., 0] > PARALLEL**2 * numpy.sum(weights)):
        raise ValueError(
            "the directions lie along one line, so they do not determine the rotation around it"
        )
    covariance: Array = numpy.linalg.inv(information)
    return covariance


def _weighted(
    observed: Numbers, reference: Numbers, deviations: Values | None
) -> tuple[Array, Array, Array]:
    import numpy

    observed, reference = (
        number_array(observed, (), "observed"),
        number_array(reference, (), "reference"),
    )
    if observed.ndim < 2 or observed.shape[-1] != 3 or observed.shape[-2:] != reference.shape[-2:]:
        raise ValueError(
            "observed and reference must have the same number of directions, with three "
            f"components each; their shapes are {observed.shape} and {reference.shape}"
        )
    if deviations is None:
        deviations = numpy.ones(observed.shape[-2])
    deviations = number_array(deviations, (observed.shape[-2],), "deviations")
    if not numpy.all(deviations > 0):
        raise ValueError(
            "a standard deviation must be a positive number of radians; one of these is "
            f"{deviations.min():g}"
        )
    spread: Array = deviations[:, None] ** -2.0
    return unit_directions(observed, "observed"), unit_directions(reference, "reference"), spread
