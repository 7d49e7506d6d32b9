"""Judging a filter without the truth, by its innovations and by running it backwards."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from orientation import (
    MultiplicativeKalmanFilter,
    dcm_from_two_directions,
    rotation_vector_from_dcm,
)

from .motion import lasting, steps_of, turned

if TYPE_CHECKING:
    from .motion import Stretch
    from .table import Array

UP = np.array([0.0, 0, 1])


def chi_square_bounds(freedom: int, share: float = 0.95) -> Array:
    """Return Wilson-Hilferty bounds for the mean of ``freedom`` squared standard normals.

    >>> chi_square_bounds(100).round(3).tolist()
    [0.742, 1.296]
    """
    deviations = {0.95: 1.959964, 0.99: 2.575829}[share]
    spread = 2 / (9 * freedom)
    return (1 - spread + np.array([-1, 1]) * deviations * np.sqrt(spread)) ** 3


class Noise(NamedTuple):
    """The noise a filter assumes for its instruments.

    Attributes
    ----------
    gyroscope : float
        Angle random walk, radians per square root of a second.
    bias : float
        Random walk of the bias, radians per second per square root of a second.
    force, field : float
        Smallest standard deviations of the two directions, in radians.
    """

    gyroscope: float
    bias: float
    force: float
    field: float


#: The noise we assume for instruments that were never still, which is that of cheap ones.
ASSUMED = Noise(gyroscope=2e-4, bias=1e-4, force=0.01, field=0.02)


class Judgement(NamedTuple):
    """What a filter claims about itself, and what the data show.

    Attributes
    ----------
    claimed : float
        The standard deviation of tilt that it claims, in degrees.
    found : float
        The standard deviation of tilt found by running the filter forwards and backwards, in
        degrees.
    heading : tuple of two float or None
        The same two for the heading; None without a magnetometer, which alone observes it.
    squares : dict
        Mean normalised squared innovations by sensor, relative to their expected values.
    times : array of shape ``(n,)``
        Seconds.
    dcms : array of shape ``(n, 3, 3)``
        ``B_C_N`` from the forward run.
    apart, claims : arrays of shape ``(n,)``
        The difference in tilt between the two runs at each time, and its expected size, in degrees.
    """

    claimed: float
    found: float
    heading: tuple[float, float] | None
    squares: dict[str, float]
    times: Array
    dcms: Array
    apart: Array
    claims: Array


def _start(forces: Array, field: Array | None) -> Array:
    up = forces.mean(axis=0)
    north = np.zeros(3) if field is None else np.cross(up, np.cross(field.mean(axis=0), up))
    if np.linalg.norm(np.cross(up, north)) <= 1e-3 * np.linalg.norm(up) * np.linalg.norm(north):
        north = np.eye(3)[np.abs(up).argmin()]
    return dcm_from_two_directions([up, north], [[0, 0, 1], [1, 0, 0]])


def in_blocks(
    time: Array, rates: Array, vectors: Sequence[Array], seconds: float = 0.05
) -> tuple[Array, Array, Sequence[Array]]:
    """Combine samples into fewer, longer steps with the same rotation.

    The vectors of a step are carried to its end by the gyroscope and averaged.

    Parameters
    ----------
    time : array of shape ``(n,)``
    rates : array of shape ``(n, 3)``
    vectors : list of arrays of shape ``(n, 3)``
    seconds : float

    Returns
    -------
    time of shape ``(m,)``, rates of shape ``(m, 3)``, and a list of vectors of that shape
    """
    size = round(seconds / np.median(np.diff(time)))
    if size < 2:
        return time, rates, vectors
    count = len(time) // size
    ends = np.arange(count) * size + size - 1
    dcms = turned(rates, steps_of(time))
    at_end = dcms[ends]
    turns = rotation_vector_from_dcm(at_end[1:] @ at_end[:-1].swapaxes(-1, -2))
    means = turns / np.diff(time[ends])[:, None]
    averaged = []
    for values in vectors:
        carried = np.einsum("nji,nj->ni", dcms[: count * size], values[: count * size])
        blocks = carried.reshape(count, size, 3).mean(axis=1)
        averaged.append(np.einsum("nij,nj->ni", at_end, blocks))
    # The filter uses the mean of the rates at a step's two ends, so the mean over the step is put
    # at its end.
    return time[ends], np.concatenate([means[:1], means]), averaged


def _earth(forces: Array, field: Array) -> Array:
    """Return the field in a ground frame with x to magnetic north and z up, from its median dip."""
    sizes = np.linalg.norm(forces, axis=1) * np.linalg.norm(field, axis=1)
    sine = float(np.clip(np.median((forces * field).sum(axis=1) / sizes), -0.999, 0.999))
    return np.array([np.sqrt(1 - sine**2), 0, sine])


class FilterInput(NamedTuple):
    """What a filter runs on.

    Attributes
    ----------
    time : array of shape ``(n,)``
    rates : array of shape ``(n, 3)``
        In radians per second, means over the step before each time.
    forces : array of shape ``(n, 3)``
        In multiples of gravity, pointing up at rest.
    field : array of shape ``(n, 3)`` or None
    noise : Noise
    doubt : array of shape ``(n,)``
        How much less certain than at best the direction of each force is, in radians.
    """

    time: Array
    rates: Array
    forces: Array
    field: Array | None
    noise: Noise
    doubt: Array


def filter_inputs(
    time: Array,
    rates: Array,
    forces: Array,
    field: Array | None,
    lying: Sequence[Stretch],
    parts: Sequence[tuple[int, int]] | None = None,
) -> list[FilterInput]:
    """Prepare a recording for a filter, with the noise of its instruments and doubt of each force.

    Parameters
    ----------
    time : array of shape ``(n,)``
    rates, forces : arrays of shape ``(n, 3)``
        In radians per second without the bias, and in multiples of gravity.
    field : array of shape ``(n, 3)`` or None
        In multiples of its usual length.
    lying : list of Stretch
        Stretches of rest, which reveal the noise.
    parts : list of pairs of int, optional
        Ranges of samples to judge the filter on, as first and one past the last.

    Returns
    -------
    list of FilterInput
        In steps of a twentieth of a second, or in the recording's own steps if these are longer.
    """
    step, noise = float(np.median(np.diff(time))), ASSUMED
    if lying:

        def spread(values: Array) -> float:
            quiet = [values[stretch.first : stretch.last] for stretch in lying]
            return float(np.sqrt(np.mean([each.var(axis=0, ddof=1).mean() for each in quiet])))

        # A scale that is wrong by half a per cent causes that error in each rotation.
        turning = 0.005 * float(np.sqrt(np.mean(rates**2)))
        noise = Noise(
            float(np.hypot(spread(rates) * np.sqrt(step), turning)),
            ASSUMED.bias,
            max(spread(forces), 1e-3),
            max(spread(field), 1e-3) if field is not None else ASSUMED.field,
        )
    # In motion, pushes are taken for gravity and last for many samples, so each sample counts less.
    push = np.linalg.norm(forces, axis=1) - 1
    moving = np.ones(len(push), dtype=bool)
    for stretch in lying:
        moving[stretch.first : stretch.last] = False
    usual = np.sqrt(np.mean(push[moving] ** 2)) if moving.any() else 0.0
    doubt = np.where(moving, np.hypot(usual, push) * lasting(push), 0.0)
    # Iron shows in the field's length, and lasts for many samples as well.
    if field is not None:
        uneven = np.linalg.norm(field, axis=1) - 1
        noise = noise._replace(
            field=max(noise.field, float(np.sqrt(np.mean(uneven**2))) * lasting(uneven))
        )
    inputs = []
    for first, last in parts or [(0, len(time))]:
        part = slice(first, last)
        means = (rates[part] + np.concatenate([rates[first : first + 1], rates[part][:-1]])) / 2
        vectors = [values[part] for values in (forces, field) if values is not None]
        at, turning, seen = in_blocks(time[part], rates[part], vectors)
        fewer = np.sqrt(max(1, round((last - first) / len(at))))
        inputs.append(
            FilterInput(
                at,
                means if len(at) == len(means) else turning,
                seen[0],
                None if field is None else seen[1],
                noise._replace(force=noise.force / fewer, field=noise.field / fewer),
                np.interp(at, time[part], doubt[part]) / fewer,
            )
        )
    return inputs


def judge(given: FilterInput, progress: Callable[[float], None] | None = None) -> Judgement:
    """Run a filter forwards and backwards side by side, and compare the results.

    Parameters
    ----------
    given : FilterInput
    progress : callable, optional
        Called with the fraction that is done.

    Returns
    -------
    Judgement
    """
    time, forces, field, noise = given.time, given.forces, given.field, given.noise
    count, steps = len(time), np.diff(time)
    lead = max(1, min(count // 10, round(0.5 / np.median(steps))))
    ends = slice(None, lead), slice(-lead, None)
    starts = [_start(forces[end], None if field is None else field[end]) for end in ends]
    doubt = np.hypot(noise.force, given.doubt)
    # In motion, the first estimate is off by some degrees of tilt; with a magnetometer, we allow
    # for an error of heading as well.
    magnetic = noise.field if field is not None else 0.0
    outset = 0.03 + magnetic + np.minimum(0.4, 8 * doubt[[0, -1]])
    variances = np.stack(
        [outset**2] * 3 + [np.full_like(outset, np.radians(0.5) ** 2)] * 3, axis=-1
    )
    estimate = MultiplicativeKalmanFilter(
        np.array(starts), variances[..., None] * np.eye(6), noise.gyroscope, noise.bias
    )
    order = np.stack([np.arange(count), np.arange(count)[::-1]])
    sign = np.array([[1.0], [-1.0]])
    dcms = np.empty((2, count, 3, 3))
    covariances = np.empty_like(dcms)
    seen: dict[str, list[tuple[Array, Array]]] = {"accelerometer": [], "magnetometer": []}
    up = np.broadcast_to(UP, (2, 3))
    earth = None if field is None else np.broadcast_to(_earth(forces, field), (2, 3))
    for k in range(count):
        at = order[:, k]
        if k:
            # Index the same step forwards and backwards.
            later = np.maximum(at, order[:, k - 1])
            estimate.turn(sign * given.rates[later], steps[later - 1])
        by_force = estimate.observe(forces[at], up, doubt[at])
        if field is not None:
            by_field = estimate.observe(field[at], earth, noise.field)
            seen["magnetometer"].append((by_field.difference[0], by_field.covariance[0]))
        seen["accelerometer"].append((by_force.difference[0], by_force.covariance[0]))
        dcms[[0, 1], at] = estimate.dcm
        covariances[[0, 1], at] = estimate.covariance[..., :3, :3]
        if progress and k % 100 == 0:
            progress(k / count)
    difference = rotation_vector_from_dcm(dcms[0] @ dcms[1].swapaxes(-1, -2))
    claim = covariances[0] + covariances[1]
    ups = dcms[0] @ UP
    inner = slice(count // 5, max(count // 5 + 1, count - count // 5))
    around = (difference * ups).sum(axis=1)
    tilt = difference - around[:, None] * ups
    claimed_around = np.einsum("ni,nij,nj->n", ups, claim, ups)
    claimed_tilt = np.trace(claim, axis1=1, axis2=2) - claimed_around

    def rms(values: Array) -> float:
        return float(np.degrees(np.sqrt(np.mean(values[inner]) / 2)))

    squares: dict[str, float] = {}
    for name, pairs in seen.items():
        if pairs:
            differences, claims = (np.array(part)[lead:] for part in zip(*pairs, strict=True))
            normal = np.linalg.solve(np.linalg.cholesky(claims), differences[..., None])
            squares[name] = float((normal**2).sum(axis=(1, 2)).mean() / 2)
    return Judgement(
        rms(claimed_tilt),
        rms((tilt**2).sum(axis=1)),
        (rms(claimed_around), rms(around**2)) if field is not None else None,
        squares,
        time,
        dcms[0],
        np.degrees(np.linalg.norm(tilt, axis=1)),
        np.degrees(np.sqrt(claimed_tilt)),
    )
