"""Comparison of a gyroscope with vectors that stay fixed while the instrument rotates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import permutations, product
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from orientation import (
    dcm_from_quaternion,
    dcm_from_rotation_vector,
    rotation_vector_from_dcm,
)

if TYPE_CHECKING:
    from .table import Array

#: The 48 matrices that exchange axes and change signs, with the proper rotations first.
ASSIGNMENTS = np.array(
    [
        np.diag(signs) @ np.eye(3)[list(order)]
        for order in permutations(range(3))
        for signs in product((1, -1), repeat=3)
    ]
)
ASSIGNMENTS = ASSIGNMENTS[np.argsort(-np.linalg.det(ASSIGNMENTS), kind="stable")].round()
PROPER = ASSIGNMENTS[:24]
#: The index of the opposite of each proper one.
OPPOSITE = np.array(
    [24 + int(np.abs(ASSIGNMENTS[24:] + proper).sum(axis=(1, 2)).argmin()) for proper in PROPER]
)


def written(assignment: Array, letters: str = "xyz") -> str:
    """Return an assignment in words: what the new x, y and z are.

    >>> written(np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1]]))
    'y, -x, z'
    """
    return ", ".join(
        ("-" if row.sum() < 0 else "") + letters[int(np.abs(row).argmax())]
        for row in np.asarray(assignment)
    )


def turned(rates: Array, steps: Array) -> Array:
    """Return the direction cosine matrices of each moment relative to the first, by a gyroscope.

    Parameters
    ----------
    rates : array of shape ``(..., n, 3)``
        Radians per second along the body's axes at each sample; a step uses the mean of its two
        ends.
    steps : array of shape ``(n,)``
        Seconds before each sample; the first is not used.

    Returns
    -------
    array of shape ``(..., n, 3, 3)``
        The body at each moment relative to the body at the first, ``B_k_C_B_0``.
    """
    vectors = (rates[..., 1:, :] + rates[..., :-1, :]) / 2 * steps[1:, None]
    count = rates.shape[-2]
    # Multiply within runs of this length, all runs at once, and then chain the runs.
    size = int(np.ceil(np.sqrt(count)))
    padding = [(0, 0)] * (rates.ndim - 2) + [(1, size * size - count), (0, 0)]
    dcms = dcm_from_rotation_vector(np.pad(vectors, padding)).reshape(
        *rates.shape[:-2], size, size, 3, 3
    )
    for k in range(1, size):
        dcms[..., k, :, :] = dcms[..., k, :, :] @ dcms[..., k - 1, :, :]
    for k in range(1, size):
        dcms[..., k, :, :, :] = dcms[..., k, :, :, :] @ dcms[..., k - 1, -1:, :, :]
    return dcms.reshape(*rates.shape[:-2], size * size, 3, 3)[..., :count, :, :]


def steps_of(time: Array) -> Array:
    """Return the seconds before each sample."""
    return np.diff(time, prepend=time[0])


# --- stillness ------------------------------------------------------------------------------------


class Stretch(NamedTuple):
    """A stretch of time in which an instrument hardly moves.

    Attributes
    ----------
    first, last : int
        First sample and one past the last.
    still : bool
        Whether the gyroscope's noise is white; otherwise something alive holds the instrument.
    deviation : float
        Standard deviation of the angular velocity, root mean square over the axes, radians per
        second.
    """

    first: int
    last: int
    still: bool
    deviation: float


#: In radians per second: a hand trembles more than the first, and an instrument that it holds still
#: moves less than the second.
TREMBLE, QUIET = np.radians(0.15), np.radians(4.0)


def autocorrelation(rates: Array, lags: int = 5) -> float:
    """Return the root mean square correlation of neighbours, corrected for that of white noise."""
    count = len(rates)
    rates = rates - rates.mean(axis=0)
    power = (rates**2).sum(axis=0)
    if (power == 0).any():
        return 0.0
    squares = [
        ((rates[lag:] * rates[:-lag]).sum(axis=0) / power) ** 2 for lag in range(1, lags + 1)
    ]
    return float(np.sqrt(max(0.0, np.mean(squares) - 1 / count)))


def lasting(values: Array, most: float = 0.999) -> float:
    """Return the factor by which correlation between neighbours inflates the error of a mean.

    The correlation is limited to ``most``.
    """
    if values.std() == 0:
        return 1.0
    alike = min(max(np.corrcoef(values[1:], values[:-1])[0, 1], 0.0), most)
    return float(np.sqrt((1 + alike) / (1 - alike)))


def stretches(time: Array, rates: Array, seconds: float = 0.5) -> list[Stretch]:
    """Find where an instrument hardly moves, and whether it is at rest or held.

    Parameters
    ----------
    time : array of shape ``(n,)``
    rates : array of shape ``(n, 3)``
        Radians per second.

    Returns
    -------
    list of Stretch
    """
    size = max(12, round(seconds / np.median(np.diff(time))))
    count = len(time) // size
    if count < 1:
        return []
    blocks = rates[: count * size].reshape(count, size, 3)
    spread = np.sqrt(blocks.var(axis=1, ddof=1).mean(axis=1))
    calm = spread < min(QUIET, max(6 * np.percentile(spread, 5), np.radians(0.3)))
    # A bias may drift, so calm blocks are compared closely only with equally calm ones within ten
    # seconds, and loosely with all. In a hand, a mean that differs is motion.
    means, places = blocks.mean(axis=1), np.flatnonzero(calm)
    near = round(10 / seconds)
    for k in places:
        alike = places[(np.abs(places - k) <= near) & (spread[places] <= 2 * spread[k])]
        usual = max(3 * spread[k], np.radians(1.0))
        calm[k] &= np.linalg.norm(means[k] - np.median(means[alike], axis=0)) < usual
        calm[k] &= np.linalg.norm(means[k] - np.median(means[places], axis=0)) < QUIET
    # A stretch ends where the instrument gets restless, and also where it gets much less calm.
    runs: list[list[int]] = []
    for k in np.flatnonzero(calm):
        if not runs or k > runs[-1][-1] + 1 or spread[k] > 1.8 * spread[runs[-1]].min():
            runs.append([])
        runs[-1].append(int(k))
    calm_stretches = []
    for run in runs:
        first, last = run[0] * size, (run[-1] + 1) * size
        deviation = float(np.sqrt(rates[first:last].var(axis=0, ddof=1).mean()))
        lies = bool(autocorrelation(rates[first:last]) < 0.2 or deviation < TREMBLE)
        calm_stretches.append(Stretch(first, last, lies, deviation))
    # The noise at rest is the same everywhere, but a jolt in the middle of it may also look white.
    calmest = min((stretch.deviation for stretch in calm_stretches if stretch.still), default=0.0)
    usual = max(3 * calmest, TREMBLE)
    return [each._replace(still=each.still and each.deviation < usual) for each in calm_stretches]


# --- axes, signs, unit and scale of a gyroscope ---------------------------------------------------


#: How many matrices to hold in memory at a time, which takes some 100 MB in all.
MOST_AT_ONCE = 200_000


class Fit(NamedTuple):
    """How well each assignment of axes explains the measurements.

    Attributes
    ----------
    shares : array of shape ``(48,)``
        The unexplained fraction of the changes of a vector, for each assignment in ``ASSIGNMENTS``.
    scale : float
        The factor for the gyroscope's values in the best one.
    """

    shares: Array
    scale: float

    @property
    def best(self) -> Array:
        """The assignment that leaves the least unexplained."""
        return ASSIGNMENTS[self.shares.argmin()]

    @property
    def margin(self) -> float:
        """The ratio of the second smallest unexplained fraction to the smallest."""
        first, second = np.sort(self.shares)[:2]
        return float(second / max(first, 1e-9))


def pieces(
    time: Array, rates: Array, longest: float = 40.0, seconds: float = 0.5
) -> tuple[list[slice[int, int, None]], int]:
    """Return the runs of blocks with the most rotation, as slices, and the size of a block."""
    step = np.median(np.diff(time))
    size = max(2, round(seconds / step))
    run = 8 * size
    starts = np.arange(0, max(1, len(time) - run + 1), run)
    turning = [np.linalg.norm(rates[start : start + run], axis=1).sum() for start in starts]
    chosen = starts[np.argsort(turning)[::-1][: max(2, round(longest / step / run))]]
    return [slice(start, start + run) for start in np.sort(chosen)], size


def fit_axes(
    time: Array,
    rates: Array,
    vectors: Array,
    scales: Array,
    seconds: float = 0.5,
    longest: float = 40.0,
) -> Fit:
    """Try all 48 assignments of a gyroscope's axes to those of a vector that stays fixed.

    While the instrument rotates, a fixed vector (gravity, the Earth's field) rotates the opposite
    way relative to it. Carried back by the gyroscope, its means over short blocks must agree with
    those of the next block.

    Parameters
    ----------
    time : array of shape ``(n,)``
    rates : array of shape ``(n, 3)``
        As the gyroscope gives them.
    vectors : array of shape ``(n, 3)``
        At the same times.
    scales : array of shape ``(m,)``
        Factors to try for the rates.
    seconds : float
        Length of a block.
    longest : float
        How many seconds to use; those with the most rotation are chosen.

    Returns
    -------
    Fit
    """
    parts, size = pieces(time, rates, longest, seconds)
    signed = np.concatenate([scales, -np.asarray(scales)])[:, None, None]
    left, moved = np.zeros((len(signed), 24)), 0.0
    for part in parts:
        step = steps_of(time[part])
        count = len(step) // size
        if count < 2:
            continue
        those = vectors[part][: count * size].reshape(count, size, 3)
        moved += (np.diff(those.mean(axis=1), axis=0) ** 2).sum()
        for some in np.array_split(
            np.arange(len(signed)), 1 + len(signed) * len(step) // MOST_AT_ONCE
        ):
            dcms = turned(signed[some] * rates[part], step)[:, : count * size].reshape(
                -1, count, size, 9
            )
            # The mean over a block of D^T P v is linear in P.
            change = (
                np.diff(dcms.swapaxes(-1, -2) @ those, axis=1).reshape(-1, 3, 3, 3).swapaxes(1, 2)
            )
            differences = change.reshape(-1, 9) @ PROPER.swapaxes(-1, -2).reshape(24, 9).T / size
            left[some] += (differences**2).reshape(len(some), -1, 24).sum(axis=1)
    # With these assignments the gyroscope's axes are those of the vector: G, and -G for
    # reflections.
    shares = np.empty((len(scales), 48))
    shares[:, :24], shares[:, OPPOSITE] = np.split(np.sqrt(left / max(moved, 1e-300)), 2)
    best = np.unravel_index(shares.argmin(), shares.shape)[0]
    return Fit(shares[best], float(scales[best]))


def carried(time: Array, rates: Array, poses: Sequence[Stretch]) -> Array:
    """Return rotations between the middles of poses, of shape ``(..., m - 1, 3, 3)``."""
    rotations = []
    for pose, other in zip(poses, poses[1:], strict=False):
        part = slice((pose.first + pose.last) // 2, (other.first + other.last) // 2 + 1)
        rotations.append(turned(rates[..., part, :], steps_of(time[part]))[..., -1, :, :])
    return np.stack(rotations, axis=-3)


class ScaleFit(NamedTuple):
    """Scales and bias of a gyroscope.

    The true angular velocity is ``scales * (rates - bias - drift * course)``.

    Attributes
    ----------
    scales, spreads : arrays of shape ``(3,)``
        The scale of each axis, and their standard deviations.
    bias, bias_spreads : arrays of shape ``(3,)``
        In radians per second, and their standard deviations, which are zero if the bias was given.
    drift, drift_spreads : arrays of shape ``(3,)``
        In radians per second for each unit of the course; zeros if no course was given.
    left : float
        The remaining error of gravity's direction, in radians.
    left_alike : float
        The same with one scale for all axes.
    """

    scales: Array
    spreads: Array
    bias: Array
    bias_spreads: Array
    drift: Array
    drift_spreads: Array
    left: float
    left_alike: float

    @property
    def common(self) -> tuple[float, float]:
        """One scale for all axes, and its standard deviation."""
        weights = 1 / self.spreads**2
        return float(self.scales @ weights / weights.sum()), float(weights.sum() ** -0.5)


def fit_scales(
    time: Array,
    rates: Array,
    forces: Array,
    poses: Sequence[Stretch],
    bias: Array | None = None,
    course: Array | None = None,
) -> ScaleFit | None:
    """Fit scales and bias so that rotations carry gravity from one pose to the next.

    Parameters
    ----------
    time : array of shape ``(n,)``
    rates, forces : arrays of shape ``(n, 3)``
        Along the same axes, with the rates in radians per second.
    poses : list of Stretch
    bias : array of shape ``(3,)``, optional
        In radians per second, if it is known.
    course : array of shape ``(n,)``, optional
        What a drifting bias is proportional to, such as time; zero where the bias is ``bias``.

    Returns
    -------
    ScaleFit or None
        None if the poses do not suffice.
    """
    if len(poses) < 3:
        return None
    ups = np.array([forces[pose.first : pose.last].mean(axis=0) for pose in poses])
    ups = ups / np.linalg.norm(ups, axis=1, keepdims=True)
    if (np.linalg.norm(np.cross(ups[1:], ups[:-1]), axis=1) > 0.2).sum() < 2:
        return None
    free = np.flatnonzero(np.repeat([True, bias is None, course is not None], 3))
    course = np.zeros((len(time), 1)) if course is None else course[:, None]

    def residuals(parameters: Array) -> Array:
        """Return the errors of gravity for scales, biases and drifts of shape ``(..., 9)``."""
        scales, biases, drifts = np.split(parameters[..., None, :], 3, axis=-1)
        turns = carried(time, scales * (rates - biases - drifts * course), poses)
        off = ups[1:] - (turns @ ups[:-1, :, None])[..., 0]
        return off.reshape(*off.shape[:-2], -1)

    # With several rotations many scales nearly fit, so we refine the best one of a grid.
    tried = np.repeat(np.geomspace(0.4, 2.5, 47)[:, None], 9, axis=1)
    tried[:, 3:] = np.concatenate([np.zeros(3) if bias is None else bias, np.zeros(3)])
    start = parameters = tried[int(np.abs(residuals(tried)).sum(axis=-1).argmin())]
    # The scales of one sensor are similar, and its bias and drift at most a few degrees per second.
    usual = np.repeat([0.3 * start[0], np.radians(1.0), np.radians(2.0)], 3)
    prior = np.diag(usual[free] ** -2.0)
    spreads = np.zeros(9)
    for _ in range(8):
        at, *moved = residuals(parameters + 1e-5 * np.eye(10, 9, -1)[[0, *(free + 1)]])
        slopes = (np.array(moved) - at).T / 1e-5
        noise = max(np.sqrt(np.median(at**2)) * 1.5, 0.003)
        # An outlier counts less.
        weights = 1 / np.maximum(noise, np.abs(at)) / noise
        information = (slopes * weights[:, None]).T @ slopes + prior
        pull = (slopes * weights[:, None]).T @ -at - prior @ (parameters - start)[free]
        change = np.zeros(9)
        change[free] = np.linalg.solve(information, pull)
        parameters = parameters + change
        if np.abs(change).max() < 1e-6:
            break
    freedom = max(1.0, len(at) * 2 / 3 - len(free))
    excess = max(1.0, (at**2 * weights).sum() / freedom)
    spreads[free] = np.sqrt(np.diag(np.linalg.inv(information)) * excess)
    alike = np.concatenate([np.repeat(np.median(parameters[:3]), 3), parameters[3:]])
    each = zip(np.split(parameters, 3), np.split(spreads, 3), strict=True)
    return ScaleFit(*(part for pair in each for part in pair), _rms(at), _rms(residuals(alike)))


def _rms(off: Array) -> float:
    """Return the root mean square length of vectors whose components are in one row."""
    return float(np.sqrt((off**2).mean() * 3))


# --- the convention of an orientation -------------------------------------------------------------


class Reading(NamedTuple):
    """One way to read four numbers, or three angles, as an orientation.

    Attributes
    ----------
    disagreement : float
        Between the rotations of the orientation and of the gyroscope, relative to the latter.
    order : str
        ``scalar first`` or ``scalar last``; for angles the sequence, as in
        ``zyx (yaw, pitch, roll)``.
    conjugate : bool
        Whether the values are the inverse of the book's: the ground relative to the body.
    mounting : array of shape ``(3, 3)``
        The orientation's body frame relative to the axes of the gyroscope.
    """

    disagreement: float
    order: str
    conjugate: bool
    mounting: Array


def dcm_of_quaternions(values: Array, order: str) -> Array:
    """Return ``B_C_N`` of quaternions, read as in the book, with their scalar first or last."""
    values = values / np.linalg.norm(values, axis=1, keepdims=True)
    return dcm_from_quaternion(values if order == "scalar first" else np.roll(values, 1, axis=1))


def readings(
    time: Array, rates: Array, orientation_time: Array, candidates: Mapping[str, Array]
) -> list[Reading]:
    """Read an orientation in every possible way, and compare its rotations with the gyroscope's.

    Parameters
    ----------
    time : array of shape ``(n,)``
    rates : array of shape ``(n, 3)``
        The gyroscope's angular velocities, in radians per second.
    orientation_time : array of shape ``(m,)``
    candidates : dict
        Arrays of shape ``(m, 3, 3)`` by the name of the order.

    Returns
    -------
    list of Reading
        The best one first. If several fit equally well, those that change least come first.
    """
    steps = steps_of(time)
    vectors = np.concatenate([np.zeros((1, 3)), (rates[1:] + rates[:-1]) / 2 * steps[1:, None]])
    path = np.cumsum(vectors, axis=0)
    inside = (orientation_time >= time[0] - 1e-9) & (orientation_time <= time[-1] + 1e-9)
    # An orientation may be printed at any interval, so we compare rotations over a twentieth of a
    # second or more.
    stride = max(1, round(0.05 / np.median(np.diff(orientation_time))))
    places = np.flatnonzero(inside)[::stride]
    at = np.stack(
        [np.interp(orientation_time[places], time, path[:, k]) for k in range(3)], axis=-1
    )
    measured = np.diff(at, axis=0)
    use = np.linalg.norm(measured, axis=1) < 1.0
    if len(places) < 10 or np.sqrt((measured[use] ** 2).sum()) < 0.05:
        return []
    whole = (measured[use] ** 2).sum()
    fits = []
    for name, dcms in candidates.items():
        dcms = dcms[places]
        for conjugate in (False, True):
            # B_C_N, or its transpose, whose rotations are relative to the other frame.
            forth, back = dcms[1:], dcms[:-1].swapaxes(-1, -2)
            turn = forth.swapaxes(-1, -2) @ dcms[:-1] if conjugate else forth @ back
            turn = rotation_vector_from_dcm(turn)[use]
            products = turn.T @ measured[use]
            squares = (turn**2).sum() + whole - 2 * np.einsum("kij,ij->k", ASSIGNMENTS, products)
            fits += [
                Reading(float(np.sqrt(max(0.0, square) / whole)), name, conjugate, mounting)
                for square, mounting in zip(squares, ASSIGNMENTS, strict=True)
            ]

    def plain(reading: Reading) -> tuple[float, bool, float]:
        return (
            round(reading.disagreement, 3),
            np.linalg.det(reading.mounting) < 0,
            np.abs(reading.mounting - np.eye(3)).sum(),
        )

    return sorted(fits, key=plain)
