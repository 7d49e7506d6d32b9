"""A filter judged without knowing the truth: by what it expected to see, and by itself run backwards."""

from typing import NamedTuple

import numpy as np

from orientation import MultiplicativeKalmanFilter, dcm_from_two_directions

from .motion import steps_of, to_rotation_vectors, turned

UP = np.array([0.0, 0, 1])


def chi_square_bounds(freedom, share=0.95):
    """Bounds between which the mean of ``freedom`` squares of standard normal numbers lies (Wilson and Hilferty).

    >>> chi_square_bounds(100).round(3).tolist()
    [0.742, 1.296]
    """
    deviations = {0.95: 1.959964, 0.99: 2.575829}[share]
    spread = 2 / (9 * freedom)
    return (1 - spread + np.array([-1, 1]) * deviations * np.sqrt(spread)) ** 3


class Noise(NamedTuple):
    """What a filter is told of its instruments.

    Attributes
    ----------
    gyroscope : float
        Angle random walk, radians per square root of a second.
    bias : float
        Random walk of the bias, radians per second per square root of a second.
    force, field : float
        Standard deviations of the two directions at best, radians.
    """

    gyroscope: float
    bias: float
    force: float
    field: float


class Judgement(NamedTuple):
    """What a filter says of itself, and what the data say of it.

    Attributes
    ----------
    first, last : float
        Seconds between which it was judged.
    claimed : float
        Standard deviation of tilt that it claims, degrees.
    found : float
        Of the tilt, by the filter run forwards and backwards, degrees.
    heading : tuple of two float or None
        The same two of the heading; None without a magnetometer: nothing else sees it.
    squares : dict
        Mean normalised squares of innovations, by sensor, as multiples of what they should be.
    bounds : dict
        Between which 95 of 100 honest ones lie.
    likeness : dict
        Correlation of successive innovations, by sensor.
    held_out : dict
        Degrees (rms) by which each sensor's direction was missed by a filter that did not see it.
    times : array of shape ``(n,)``
        Seconds.
    dcms : array of shape ``(n, 3, 3)``
        ``B_C_N`` of the filter run forwards.
    apart, claims : arrays of shape ``(n,)``
        By how much the two differ in tilt at each time, and by how much they should, degrees.
    """

    first: float
    last: float
    claimed: float
    found: float
    heading: tuple | None
    squares: dict
    bounds: dict
    likeness: dict
    held_out: dict
    times: np.ndarray
    dcms: np.ndarray
    apart: np.ndarray
    claims: np.ndarray


def _start(forces, field):
    up = forces.mean(axis=0)
    if field is None:
        other = np.eye(3)[np.abs(up).argmin()]
    else:
        mean = field.mean(axis=0)
        other = np.cross(up, np.cross(mean, up))
    if np.linalg.norm(np.cross(up, other)) < 1e-3 * np.linalg.norm(up) * np.linalg.norm(other):
        other = np.eye(3)[np.abs(up).argmin()]
    return dcm_from_two_directions([up, other], [[0, 0, 1], [1, 0, 0]])


def in_blocks(time, rates, vectors, seconds=0.05):
    """Fewer and longer steps: each of the same turn, its vectors carried to its end by the gyroscope and averaged.

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
    turns = to_rotation_vectors(at_end[1:] @ at_end[:-1].swapaxes(-1, -2))
    means = turns / np.diff(time[ends])[:, None]
    # A step is turned by the mean of the rates at its two ends: here by the mean over it, which is put at its end.
    means = np.concatenate([means[:1], means])
    found = []
    for values in vectors:
        carried = np.einsum("nji,nj->ni", dcms[: count * size], values[: count * size])
        found.append(np.einsum("nij,nj->ni", at_end, carried.reshape(count, size, 3).mean(axis=1)))
    return time[ends], means, found


def _earth(forces, field):
    """The field along a ground with x to magnetic north and z up, by its usual dip against gravity."""
    sines = (forces * field).sum(axis=1) / np.linalg.norm(forces, axis=1) / np.linalg.norm(field, axis=1)
    sine = float(np.clip(np.median(sines), -0.999, 0.999))
    return np.array([np.sqrt(1 - sine**2), 0, sine])


def judge(time, rates, forces, field, noise, doubt=None, progress=None):
    """Run a filter forwards, backwards and with one sensor held out, and compare.

    Parameters
    ----------
    time : array of shape ``(n,)``
    rates : array of shape ``(n, 3)``
        Radians per second, means over the step before each time.
    forces : array of shape ``(n, 3)``
        In multiples of gravity: at rest up.
    field : array of shape ``(n, 3)`` or None
    noise : Noise
    doubt : array of shape ``(n,)``, optional
        Standard deviation of the direction of each force in radians, where it is larger than at best.
    progress : callable, optional
        Called with the share that is done.

    Returns
    -------
    Judgement
    """
    count, magnetic = len(time), field is not None
    runs = 2 + 2 * magnetic  # forwards, backwards; without the field, without the force
    steps = np.diff(time)
    lead = max(1, min(count // 10, round(0.5 / np.median(steps))))
    starts = [
        _start(forces[:lead], field[:lead] if magnetic else None),
        _start(forces[-lead:], field[-lead:] if magnetic else None),
    ]
    doubt = np.full(count, noise.force) if doubt is None else np.hypot(noise.force, doubt)
    # Where it moves, the first look is off by some degrees of tilt, and where the field dips by more of heading.
    first = np.array(
        [
            np.diag([(0.03 + noise.field * magnetic + min(0.4, 8 * end)) ** 2] * 3 + [np.radians(0.5) ** 2] * 3)
            for end in (doubt[0], doubt[-1], doubt[0], doubt[0])
        ][:runs]
    )
    estimate = MultiplicativeKalmanFilter(
        np.array([starts[0], starts[1], starts[0], starts[0]][:runs]), first, noise.gyroscope, noise.bias
    )
    forwards, backwards = np.arange(count), np.arange(count)[::-1]
    order = np.stack([forwards, backwards, forwards, forwards][:runs])
    sign = np.array([1.0, -1, 1, 1])[:runs]
    blind = 1e4
    no_force = np.array([0, 0, 0, blind])[:runs]
    no_field = np.array([0, 0, blind, 0])[:runs]
    dcms, covariances = np.empty((runs, count, 3, 3)), np.empty((runs, count, 3, 3))
    said = {"accelerometer": [], "magnetometer": []}
    up = np.broadcast_to(UP, (runs, 3))
    earth = np.broadcast_to(_earth(forces, field), (runs, 3)) if magnetic else None
    for k in range(count):
        at = order[:, k]
        if k:
            later = np.maximum(at, order[:, k - 1])  # the same step, forwards and backwards
            step = steps[later - 1]
            # One duration for all: rates are stretched where the way back has another one.
            estimate.turn((sign * step / step[0])[:, None] * rates[later], step[0])
        by_force = estimate.observe(forces[at], up, doubt[at] + no_force)
        if magnetic:
            by_field = estimate.observe(field[at], earth, noise.field + no_field)
            said["magnetometer"].append((by_field.difference[0], by_field.covariance[0]))
        said["accelerometer"].append((by_force.difference[0], by_force.covariance[0]))
        places = np.arange(runs), at
        dcms[places], covariances[places] = estimate.dcm, estimate.covariance[:, :3, :3]
        if progress and k % 500 == 0:
            progress(k / count)
    difference = to_rotation_vectors(dcms[0] @ dcms[1].swapaxes(-1, -2))
    claim = covariances[0] + covariances[1]
    ups = dcms[0] @ UP
    inner = slice(count // 5, max(count // 5 + 1, count - count // 5))
    around = (difference * ups).sum(axis=1)
    tilt = difference - around[:, None] * ups
    claimed_around = np.einsum("ni,nij,nj->n", ups, claim, ups)
    claimed_tilt = np.trace(claim, axis1=1, axis2=2) - claimed_around

    def rms(values):
        return float(np.degrees(np.sqrt(np.mean(values[inner]) / 2)))

    squares, bounds, alike, held_out = {}, {}, {}, {}
    for name in ("accelerometer", "magnetometer"):
        if said[name]:
            differences, claims = (np.array(values)[lead:] for values in zip(*said[name], strict=True))
            one = np.linalg.solve(np.linalg.cholesky(claims), differences[..., None])[..., 0]
            squares[name] = float((one**2).sum(axis=1).mean() / 2)
            bounds[name] = chi_square_bounds(2 * len(one))
            alike[name] = float((one[1:] * one[:-1]).sum() / (one**2).sum())
    if magnetic:
        for name, run, seen in (("magnetometer", 2, field), ("accelerometer", 3, forces)):
            expected = np.einsum("nij,j->ni", dcms[run, inner], UP) if run == 3 else None
            if run == 3:
                found = seen[inner] / np.linalg.norm(seen[inner], axis=1, keepdims=True)
                off = np.linalg.norm(np.cross(found, expected), axis=1)
            else:
                level = np.einsum("nji,nj->ni", dcms[run, inner], seen[inner])
                off = np.arctan2(level[:, 1], level[:, 0])
            held_out[name] = float(np.degrees(np.sqrt((off**2).mean())))
    return Judgement(
        float(time[0]),
        float(time[-1]),
        rms(claimed_tilt),
        rms((tilt**2).sum(axis=1)),
        (rms(claimed_around), rms(around**2)) if magnetic else None,
        squares,
        bounds,
        alike,
        held_out,
        time,
        dcms[0],
        np.degrees(np.linalg.norm(tilt, axis=1)),
        np.degrees(np.sqrt(claimed_tilt)),
    )
