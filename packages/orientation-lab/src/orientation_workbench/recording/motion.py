"""What a gyroscope, and vectors that stay where they are while the
instrument turns, say of each other.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import permutations, product
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from orientation import dcm_from_rotation_vector

if TYPE_CHECKING:
    from .table import Array

#: The 48 matrices that take axes for each other and change signs;
#: the proper ones, which turn, first.
ASSIGNMENTS = np.array(
    [
        np.diag(signs) @ np.eye(3)[list(order)]
        for order in permutations(range(3))
        for signs in product((1, -1), repeat=3)
    ]
)
ASSIGNMENTS = ASSIGNMENTS[np.argsort(-np.linalg.det(ASSIGNMENTS), kind="stable")].round()
PROPER = ASSIGNMENTS[:24]
#: Where the opposite of each proper one stands.
OPPOSITE = np.array(
    [24 + int(np.abs(ASSIGNMENTS[24:] + one).sum(axis=(1, 2)).argmin()) for one in PROPER]
)


def written(assignment: Array, letters: str = "xyz") -> str:
    """An assignment in words: what the new x, y and z are.

    >>> written(np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1]]))
    'y, -x, z'
    """
    return ", ".join(
        ("-" if row.sum() < 0 else "") + letters[int(np.abs(row).argmax())]
        for row in np.asarray(assignment)
    )


def turned(rates: Array, steps: Array) -> Array:
    """Direction cosine matrices of each moment from the first one, by a gyroscope.

    Parameters
    ----------
    rates : array of shape ``(..., n, 3)``
        Radians per second along the body; each holds for the step before it.
    steps : array of shape ``(n,)``
        Seconds before each sample; the first is not used.

    Returns
    -------
    array of shape ``(..., n, 3, 3)``
        The body at each moment from the body at the first, ``B_k_C_B_0``.
    """
    vectors = (rates[..., 1:, :] + rates[..., :-1, :]) / 2 * steps[1:, None]
    count = rates.shape[-2]
    # Runs of so many: their products side by side, then one after another.
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


def to_rotation_vectors(dcms: Array) -> Array:
    """Rotation vectors of many direction cosine matrices, for turns of less than half a turn."""
    axis = np.stack(
        [
            dcms[..., 1, 2] - dcms[..., 2, 1],
            dcms[..., 2, 0] - dcms[..., 0, 2],
            dcms[..., 0, 1] - dcms[..., 1, 0],
        ],
        axis=-1,
    )
    sine = np.linalg.norm(axis, axis=-1) / 2
    angle = np.arctan2(sine, (np.trace(dcms, axis1=-2, axis2=-1) - 1) / 2)
    return axis / 2 * (angle / np.where(sine > 1e-12, sine, 1.0) + (sine <= 1e-12))[..., None]


def steps_of(time: Array) -> Array:
    """Seconds before each sample."""
    return np.diff(time, prepend=time[0])


# --- stillness ------------------------------------------------------------------------------------


class Stretch(NamedTuple):
    """A stretch of time in which an instrument hardly moves.

    Attributes
    ----------
    first, last : int
        Samples, the last one not within.
    still : bool
        Whether what the gyroscope says is white: else something alive holds it.
    deviation : float
        Of the angular velocity, root mean square over the axes, radians per second.
    """

    first: int
    last: int
    still: bool
    deviation: float


#: Radians per second: a hand trembles more than that, and an instrument that is held
#: still by it moves less than that.
TREMBLE, QUIET = np.radians(0.15), np.radians(4.0)


def autocorrelation(rates: Array, lags: int = 5) -> float:
    """Root mean square correlation of neighbours, less what white noise gives by chance."""
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
    """By how much less the samples of something that lasts tell than as many
    that know nothing of each other; neighbours are taken to be at most so much alike.
    """
    if values.std() == 0:
        return 1.0
    alike = min(max(np.corrcoef(values[1:], values[:-1])[0, 1], 0.0), most)
    return float(np.sqrt((1 + alike) / (1 - alike)))


def stretches(time: Array, rates: Array, seconds: float = 0.5) -> list[Stretch]:
    """Find where an instrument hardly moves, and whether it lies or is held.

    Parameters
    ----------
    time : array of shape ``(n,)``
    rates : array of shape ``(n, 3)``
        Radians per second.

    Returns
    -------
    list of Stretch
    """
    step = np.median(np.diff(time))
    size = max(12, round(seconds / step))
    count = len(time) // size
    if count < 1:
        return []
    blocks = rates[: count * size].reshape(count, size, 3)
    spread = np.sqrt(blocks.var(axis=1, ddof=1).mean(axis=1))
    calm = spread < min(QUIET, max(6 * np.percentile(spread, 5), np.radians(0.3)))
    # A bias may drift: calm blocks are compared with those within ten seconds that are as calm, and
    # less closely with all. Where it is held, a mean is motion.
    means, places = blocks.mean(axis=1), np.flatnonzero(calm)
    near = round(10 / seconds)
    for k in places:
        alike = places[(np.abs(places - k) <= near) & (spread[places] <= 2 * spread[k])]
        usual = max(3 * spread[k], np.radians(1.0))
        calm[k] &= np.linalg.norm(means[k] - np.median(means[alike], axis=0)) < usual
        calm[k] &= np.linalg.norm(means[k] - np.median(means[places], axis=0)) < QUIET
    # A stretch ends where it gets restless, and also where it gets much less calm.
    runs: list[list[int]] = []
    for k in np.flatnonzero(calm):
        if not runs or k > runs[-1][-1] + 1 or spread[k] > 1.8 * spread[runs[-1]].min():
            runs.append([])
        runs[-1].append(int(k))
    found = []
    for run in runs:
        first, last = run[0] * size, (run[-1] + 1) * size
        deviation = float(np.sqrt(rates[first:last].var(axis=0, ddof=1).mean()))
        lies = bool(autocorrelation(rates[first:last]) < 0.2 or deviation < TREMBLE)
        found.append(Stretch(first, last, lies, deviation))
    # Wherever an instrument lies, its noise is the same: a jolt among it may also look white.
    calmest = min((stretch.deviation for stretch in found if stretch.still), default=0.0)
    usual = max(3 * calmest, TREMBLE)
    return [each._replace(still=each.still and each.deviation < usual) for each in found]


# --- axes, signs, unit and scale of a gyroscope ---------------------------------------------------


#: Matrices that are held at one time, some 100 MB with all that is made of them.
MOST_AT_ONCE = 200_000


class Fit(NamedTuple):
    """How well each assignment of axes explains what was measured.

    Attributes
    ----------
    shares : array of shape ``(48,)``
        What is left of the changes of a vector, as a share of them, by the assignments of
        ``ASSIGNMENTS``.
    scale : float
        By which the gyroscope's numbers are multiplied in the best one.
    """

    shares: Array
    scale: float

    @property
    def best(self) -> Array:
        """The assignment that leaves least."""
        return ASSIGNMENTS[self.shares.argmin()]

    @property
    def margin(self) -> float:
        """How many times as much the next one leaves."""
        first, second = np.sort(self.shares)[:2]
        return float(second / max(first, 1e-9))


def pieces(
    time: Array, rates: Array, longest: float = 40.0, seconds: float = 0.5
) -> tuple[list[slice[int, int, None]], int]:
    """Samples, cut into runs of blocks, in which there is most turning: a slice
    for each run, and the block's size.
    """
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
    """Try all 48 assignments of a gyroscope's axes to those of a vector that stays where it is.

    While the instrument turns, a vector that stays (gravity, the Earth's field) turns backwards in
    it. Carried back by the gyroscope, its means over short blocks must agree with those of the next
    block.

    Parameters
    ----------
    time : array of shape ``(n,)``
    rates : array of shape ``(n, 3)``
        As the gyroscope prints them.
    vectors : array of shape ``(n, 3)``
        At the same times.
    scales : array of shape ``(m,)``
        What to multiply the rates by.
    seconds : float
        Length of a block.
    longest : float
        How many seconds to look at: those with most turning.

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
    # The gyroscope's axes, taken so, are those of the vector: G, and -G of the mirror images.
    shares = np.empty((len(scales), 48))
    shares[:, :24], shares[:, OPPOSITE] = np.split(np.sqrt(left / max(moved, 1e-300)), 2)
    best = np.unravel_index(shares.argmin(), shares.shape)[0]
    return Fit(shares[best], float(scales[best]))


def carried(time: Array, rates: Array, poses: Sequence[Stretch]) -> Array:
    """Turns from the middle of each pose to that of the next, by a
    gyroscope; shape ``(..., m - 1, 3, 3)``.
    """
    found = []
    for one, other in zip(poses, poses[1:], strict=False):
        part = slice((one.first + one.last) // 2, (other.first + other.last) // 2 + 1)
        found.append(turned(rates[..., part, :], steps_of(time[part]))[..., -1, :, :])
    return np.stack(found, axis=-3)


class ScaleFit(NamedTuple):
    """Scales and bias of a gyroscope: the true angular velocity is ``scales * (rates - bias -
    drift * course)``.

    Attributes
    ----------
    scales, spreads : arrays of shape ``(3,)``
        Of each axis, and their standard deviations.
    bias, bias_spreads : arrays of shape ``(3,)``
        Radians per second; zeros as its deviations where it was known.
    drift, drift_spreads : arrays of shape ``(3,)``
        Radians per second for each unit of the course; zeros where none was given.
    left : float
        By how much gravity is missed, radians.
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
    """Scales and bias of a gyroscope: turns must carry gravity from one pose to the next.

    Parameters
    ----------
    time : array of shape ``(n,)``
    rates, forces : arrays of shape ``(n, 3)``
        Along the same axes, rates in radians per second.
    poses : list of Stretch
    bias : array of shape ``(3,)``, optional
        Radians per second, where it is known.
    course : array of shape ``(n,)``, optional
        What a bias that drifts is proportional to, such as time: zero where the bias is as above.

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
        """By how much gravity is missed with scales, biases and drifts of shape ``(..., 9)``."""
        scales, biases, drifts = np.split(parameters[..., None, :], 3, axis=-1)
        turns = carried(time, scales * (rates - biases - drifts * course), poses)
        off = ups[1:] - (turns @ ups[:-1, :, None])[..., 0]
        return off.reshape(*off.shape[:-2], -1)

    # Several turns have many scales that nearly fit: the best one of a grid is refined.
    tried = np.repeat(np.geomspace(0.4, 2.5, 47)[:, None], 9, axis=1)
    tried[:, 3:] = np.concatenate([np.zeros(3) if bias is None else bias, np.zeros(3)])
    start = parameters = tried[int(np.abs(residuals(tried)).sum(axis=-1).argmin())]
    # Scales of one part are much alike, and a bias or drift is some degrees per second at most.
    usual = np.repeat([0.3 * start[0], np.radians(1.0), np.radians(2.0)], 3)
    prior = np.diag(usual[free] ** -2.0)
    spreads = np.zeros(9)
    for _ in range(8):
        at, *moved = residuals(parameters + 1e-5 * np.eye(10, 9, -1)[[0, *(free + 1)]])
        slopes = (np.array(moved) - at).T / 1e-5
        noise = max(np.sqrt(np.median(at**2)) * 1.5, 0.003)
        weights = 1 / np.maximum(noise, np.abs(at)) / noise  # a wild transition counts less
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
    """Root mean square length of vectors whose components stand in one row."""
    return float(np.sqrt((off**2).mean() * 3))


# --- the convention of an orientation -------------------------------------------------------------


class Reading(NamedTuple):
    """One way to read four numbers, or three angles, as an orientation.

    Attributes
    ----------
    disagreement : float
        Between the turns of the orientation and those of the gyroscope, as a share of the latter.
    order : str
        ``scalar first`` or ``scalar last``; of angles the sequence, as in ``zyx (yaw, pitch,
        roll)``.
    conjugate : bool
        Whether what stands there is the other way round than in the book: the ground from the body.
    mounting : array of shape ``(3, 3)``
        The body of the orientation from the axes of the gyroscope.
    """

    disagreement: float
    order: str
    conjugate: bool
    mounting: Array


def dcm_of_quaternions(values: Array, order: str) -> Array:
    """``B_C_N`` of quaternions, read in the book's way, with their scalar first or last."""
    values = values / np.linalg.norm(values, axis=1, keepdims=True)
    w, x, y, z = (values if order == "scalar first" else np.roll(values, 1, axis=1)).T
    rows = [
        [w * w + x * x - y * y - z * z, 2 * (x * y + w * z), 2 * (x * z - w * y)],
        [2 * (x * y - w * z), w * w - x * x + y * y - z * z, 2 * (y * z + w * x)],
        [2 * (x * z + w * y), 2 * (y * z - w * x), w * w - x * x - y * y + z * z],
    ]
    return np.moveaxis(np.array(rows), -1, 0)


def readings(
    time: Array, rates: Array, orientation_time: Array, candidates: Mapping[str, Array]
) -> list[Reading]:
    """Read an orientation in every way there is, and compare its turns with those of the gyroscope.

    Parameters
    ----------
    time : array of shape ``(n,)``
    rates : array of shape ``(n, 3)``
        Of the gyroscope, radians per second.
    orientation_time : array of shape ``(m,)``
    candidates : dict
        Arrays of shape ``(m, 3, 3)`` by the name of the order.

    Returns
    -------
    list of Reading
        The best one first. Where several fit as well, those come first that change least.
    """
    steps = steps_of(time)
    vectors = np.concatenate([np.zeros((1, 3)), (rates[1:] + rates[:-1]) / 2 * steps[1:, None]])
    path = np.cumsum(vectors, axis=0)
    inside = (orientation_time >= time[0] - 1e-9) & (orientation_time <= time[-1] + 1e-9)
    # An orientation may be printed for each sample or now and then: a turn over
    # a tenth of a second is compared.
    stride = max(1, round(0.05 / np.median(np.diff(orientation_time))))
    places = np.flatnonzero(inside)[::stride]
    at = np.stack(
        [np.interp(orientation_time[places], time, path[:, k]) for k in range(3)], axis=-1
    )
    measured = np.diff(at, axis=0)
    turns = np.linalg.norm(measured, axis=1)
    use = turns < 1.0
    if len(places) < 10 or np.sqrt((measured[use] ** 2).sum()) < 0.05:
        return []
    whole = (measured[use] ** 2).sum()
    found = []
    for name, dcms in candidates.items():
        dcms = dcms[places]
        for conjugate in (False, True):
            # B_C_N, or its transpose: then the turns are written along the other side.
            forth, back = dcms[1:], dcms[:-1].swapaxes(-1, -2)
            turn = forth.swapaxes(-1, -2) @ dcms[:-1] if conjugate else forth @ back
            turn = to_rotation_vectors(turn)[use]
            products = turn.T @ measured[use]
            squares = (turn**2).sum() + whole - 2 * np.einsum("kij,ij->k", ASSIGNMENTS, products)
            found += [
                Reading(float(np.sqrt(max(0.0, square) / whole)), name, conjugate, mounting)
                for square, mounting in zip(squares, ASSIGNMENTS, strict=True)
            ]

    def plain(reading: Reading) -> tuple[float, bool, float]:
        return (
            round(reading.disagreement, 3),
            np.linalg.det(reading.mounting) < 0,
            np.abs(reading.mounting - np.eye(3)).sum(),
        )

    return sorted(found, key=plain)
