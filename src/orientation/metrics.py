"""Distances between orientations, their mean, and random orientations."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from .direction_cosines import dcm_array, dcm_excess, explain_dcm, nearest_dcm
from .numbers_and_symbols import NUMBERS, TOLERANCE, Guard, evaluate_numbers, number_array
from .quaternions import dcm_from_quaternion, quaternion_components_from_dcm
from .rotation_vector import dcm_from_rotation_vector, rotation_vector_from_dcm

if TYPE_CHECKING:
    import numpy

    from ._types import Array, Number, NumberFunctions, Scalars, Values

METRICS = ("entries", "angle")
# Start the search for the mean by angle from this many orientations if they are spread too far for
# one start to suffice.
STARTS = 100
# Accept the mean after this many steps. A few are enough unless orientations are half a turn apart.
MOST_STEPS = 200


def angle_between(first: Values, second: Values) -> Scalars:
    r"""Return the angle of the single rotation that leads from one orientation to another.

    For ${}^A\mathbf{C}^N$ and ${}^B\mathbf{C}^N$ it is the angle of ${}^B\mathbf{C}^A$, the length
    of the shortest way between them. It keeps its digits near 0 and near $\pi$.

    Parameters
    ----------
    first, second : arrays of shape ``(3, 3)`` or ``(..., 3, 3)``
        Direction cosine matrices with respect to one frame. Numbers only.

    Returns
    -------
    float, or array of shape ``(...)``
        From 0 to $\pi$, radians.

    Raises
    ------
    ValueError
        If one of them is not a direction cosine matrix, or the batches have incompatible shapes.

    Examples
    --------
    >>> from orientation import angle_between, simple_dcm
    >>> round(angle_between(simple_dcm('x', 0.5), simple_dcm('x', -0.3)), 12)
    0.8

    Notes
    -----
    Source: Huynh (2009).
    """

    def excess(f: NumberFunctions[Number], *entries: Number) -> Number:
        return f.largest(dcm_excess(f, *entries[:9]), dcm_excess(f, *entries[9:]))

    def explain(entries: Sequence[float], where: str) -> None:
        for name, nine in (("first", entries[:9]), ("second", entries[9:])):
            if not dcm_excess(NUMBERS, *nine) <= TOLERANCE:
                explain_dcm(nine, where, name)

    def formula(f: NumberFunctions[Number], *entries: Number) -> Sequence[Number]:
        rows, others = [[entries[k + 3 * i : k + 3 * i + 3] for i in range(3)] for k in (0, 9)]
        product = [a * d + b * e + c * g for a, b, c in others for d, e, g in rows]
        scalar, x, y, z = quaternion_components_from_dcm(f, *product)
        return (2 * f.atan2(f.norm(x, y, z), scalar),)

    return evaluate_numbers(
        formula,
        (),
        ("first", first, (3, 3)),
        ("second", second, (3, 3)),
        guard=Guard(excess, explain),
    )


def mean_orientation(dcms: Values, weights: Values | None = None, metric: str = "entries") -> Array:
    r"""Return the orientation whose squared distances from the given ones have the smallest sum.

    By ``entries`` the distance is the Frobenius norm of the difference of the matrices: the mean is
    the direction cosine matrix nearest to their average. The mean of the quaternions, the
    eigenvector of the largest eigenvalue of $\sum_k w_k\,q_k q_k^T$, is the same orientation. By
    ``angle`` it is the angle of the rotation between them, and the mean is found by repeatedly
    averaging rotation vectors from the current estimate.

    Parameters
    ----------
    dcms : array of shape ``(n, 3, 3)``
        Direction cosine matrices with respect to one frame. Numbers only.
    weights : array of shape ``(n,)``, optional
        Not negative, and not all zero. All are equal by default.
    metric : {'entries', 'angle'}

    Returns
    -------
    array of shape ``(3, 3)``

    Raises
    ------
    ValueError
        If the mean by that metric is not unique, because the orientations are spread too far. By
        angle it is unique if all are closer to it than a quarter turn; otherwise the search starts
        from up to 100 of them and 16 random ones, and the error reports equally good means.

    Examples
    --------
    >>> from orientation import mean_orientation, same_orientation, simple_dcm
    >>> mean = mean_orientation(simple_dcm('z', [0.1, 0.2, 0.6]), metric='angle')
    >>> same_orientation(mean, simple_dcm('z', 0.3))
    True

    Notes
    -----
    Source: Moakher (2002), Markley et al. (2007).
    """
    if metric not in METRICS:
        raise ValueError(f"metric must be 'entries' or 'angle', not {metric!r}")
    dcms = dcm_array(dcms, "dcms")
    if dcms.ndim != 3 or not len(dcms):
        raise ValueError(f"dcms must have shape (n, 3, 3) with at least one item, not {dcms.shape}")
    shares = _shares(weights, len(dcms))
    average = (shares @ dcms.reshape(-1, 9)).reshape(3, 3)
    if metric == "entries":
        try:
            return nearest_dcm(average).dcm
        except ValueError:
            raise ValueError(
                "these orientations have no unique mean by their entries: several direction cosine "
                "matrices are equally near to their average. "
                "They are spread too evenly"
            ) from None
    return _mean_by_angle(dcms, shares, average)


def _shares(weights: Values | None, count: int) -> Array:
    import numpy

    if weights is None:
        return numpy.full(count, 1 / count)
    weights = number_array(weights, (), "weights")
    if weights.shape != (count,):
        raise ValueError(
            f"weights must have shape ({count},), one for each orientation, not {weights.shape}"
        )
    if weights.min() < 0 or weights.sum() == 0:
        raise ValueError(
            f"weights must not be negative or all zero; these are from {weights.min():g} to "
            f"{weights.max():g}"
        )
    shares: Array = weights / weights.sum()
    return shares


def _mean_by_angle(dcms: Array, weights: Array, average: Array) -> Array:
    import numpy

    def settled(guess: Array) -> tuple[Array, Array]:
        for _ in range(MOST_STEPS):
            step = weights @ rotation_vector_from_dcm(dcms @ guess.T)
            guess = dcm_from_rotation_vector(step) @ guess
            if numpy.linalg.norm(step) < 1e-14:
                break
        # Hundreds of products may have accumulated rounding errors.
        guess = nearest_dcm(guess).dcm
        return guess, numpy.asarray(angle_between(dcms, guess))

    begun = []
    try:
        guess, angles = settled(nearest_dcm(average).dcm)
        if angles[weights > 0].max() < numpy.pi / 2:
            # By the theorem this is the only mean.
            return guess
        begun = [(guess, angles)]
    except ValueError:
        # There is no single place to begin.
        pass
    # Start from random orientations too: between orientations that are half a turn apart, rounding
    # would choose the way.
    starts = [*dcms[:: -(-len(dcms) // STARTS)], *random_orientations(16, 0)]
    candidates = [(weights @ angles**2, guess) for guess, angles in [*begun, *map(settled, starts)]]
    least = min(cost for cost, _ in candidates)
    best = [guess for cost, guess in candidates if cost <= least + 1e-9]
    apart = max(angle_between(best[0], guess) for guess in best)
    if apart > 1e-6:
        raise ValueError(
            "these orientations have no unique mean by angle: two equally "
            f"good means are {numpy.degrees(apart):.4g} degrees apart. "
            "They are spread too evenly"
        )
    return best[0]


def random_orientations(count: int, random: numpy.random.Generator | int | None = None) -> Array:
    r"""Return random orientations, uniformly distributed.

    Four normally distributed numbers, divided by their length, are a point on the sphere of unit
    quaternions that is equally likely everywhere, and so is the orientation. Evenly distributed
    Euler angles are not.

    Parameters
    ----------
    count : int
    random : numpy.random.Generator or int, optional
        A random generator or its seed, so that results can be reproduced.

    Returns
    -------
    array of shape ``(count, 3, 3)``

    Examples
    --------
    >>> from orientation import random_orientations
    >>> random_orientations(1000, 1).shape
    (1000, 3, 3)

    Notes
    -----
    Source: Shoemake (1992).
    """
    import numpy

    four = numpy.random.default_rng(random).normal(size=(count, 4))
    unit: Array = four / numpy.linalg.norm(four, axis=1, keepdims=True)
    return dcm_from_quaternion(unit)
