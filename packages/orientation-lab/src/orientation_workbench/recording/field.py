"""A magnetometer's offset, shape and axes, from the field's constant length and direction."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .motion import lasting, pieces, steps_of, turned

if TYPE_CHECKING:
    from .table import Array


class FieldFit(NamedTuple):
    """A correction that makes a magnetometer see one constant field.

    The corrected values are ``shape @ (measured - offset)``.

    Attributes
    ----------
    shape : array of shape ``(3, 3)``
        A matrix of determinant 1 that combines the rotation from the magnetometer's to the
        gyroscope's axes with the effect of soft iron.
    offset : array of shape ``(3,)``
        The effect of hard iron, in the magnetometer's unit.
    strength : float
        Length of the corrected field, in that unit.
    uncertainty : float
        Standard deviation of a direction computed with this correction, in radians.
    axes : array of shape ``(3, 3)``
        The rotation nearest to ``shape``.
    stretch : float
        Longest over shortest axis of the remaining factor of ``shape``.
    """

    shape: Array
    offset: Array
    strength: float
    uncertainty: float
    axes: Array
    stretch: float

    def corrected(self, values: Array) -> Array:
        """Return values without the effect of the iron that moves with the instrument."""
        return (values - self.offset) @ self.shape.T


def spread_of_lengths(values: Array) -> float:
    """Return the standard deviation of the lengths of vectors, relative to their mean."""
    lengths = np.linalg.norm(values, axis=1)
    return lengths.std() / lengths.mean()


def fit_ellipsoid(values: Array, most: float = 0.1) -> FieldFit | None:
    """Fit a magnetometer's offset and shape to the lengths alone, without a gyroscope.

    Fit the ten coefficients of the nearest quadric first (in the book equation (18.11)), then the
    lengths themselves by least squares.

    Parameters
    ----------
    values : array of shape ``(n, 3)``
    most : float
        The largest accepted uncertainty, in radians.

    Returns
    -------
    FieldFit or None
        The shape is symmetric, since lengths do not determine a rotation. None if the poses do not
        suffice.

    Examples
    --------
    >>> ways = np.random.default_rng(1).normal(size=(40, 3))
    >>> units = ways / np.linalg.norm(ways, axis=1, keepdims=True)
    >>> fit = fit_ellipsoid(units * [40, 50, 60] + [5, 0, 0])
    >>> fit.offset.round(6) + 0.0, np.diag(fit.shape).round(3)
    (array([5., 0., 0.]), array([1.233, 0.986, 0.822]))
    """
    middle = np.median(values, axis=0)
    scale = np.linalg.norm(values - middle, axis=1).max()
    if len(values) < 12 or scale == 0:
        return None
    x, y, z = scaled = (values - middle).T / scale
    columns = [
        x * x,
        y * y,
        z * z,
        2 * y * z,
        2 * x * z,
        2 * x * y,
        2 * x,
        2 * y,
        2 * z,
        np.ones_like(x),
    ]
    v = np.linalg.svd(np.stack(columns, axis=1), full_matrices=False)[2][-1]
    quadric, linear = np.array([[v[0], v[5], v[4]], [v[5], v[1], v[3]], [v[4], v[3], v[2]]]), v[6:9]
    sizes, axes = np.linalg.eigh(quadric)
    centre = -np.linalg.pinv(quadric) @ linear
    sizes = sizes / (centre @ quadric @ centre - v[9])
    # A hyperboloid fits better, so the poses cover too little.
    if sizes.min() <= 1e-6 * sizes.max():
        return None
    shape = axes * np.sqrt(sizes) @ axes.T
    places = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]
    for _ in range(20):
        away = scaled.T - centre
        lengths = np.linalg.norm(away @ shape, axis=1)
        ways = away @ shape / lengths[:, None]
        slopes = [ways[:, i] * away[:, j] + (i != j) * ways[:, j] * away[:, i] for i, j in places]
        slopes = np.column_stack([*slopes, -ways @ shape])
        change, _, rank, _ = np.linalg.lstsq(slopes, 1 - lengths, rcond=1e-9)
        if rank < 9:
            return None
        for (i, j), part in zip(places, change[:6], strict=True):
            shape[i, j] = shape[j, i] = shape[i, j] + part
        centre = centre + change[6:]
        if np.abs(change).max() < 1e-10:
            break
    # Correlated neighbours count only once.
    noise = (1 - lengths).std() * lasting(1 - lengths, 0.99)
    noise *= np.sqrt(len(values) / (len(values) - 9))
    covariance = noise**2 * np.linalg.inv(slopes.T @ slopes)
    in_shape = np.linalg.eigvalsh(covariance[:6, :6])[-1] / np.linalg.eigvalsh(shape)[0] ** 2
    in_offset = np.linalg.eigvalsh(shape @ covariance[6:, 6:] @ shape)[-1]
    uncertainty = float(np.sqrt(in_shape + in_offset))
    stretches = np.linalg.eigvalsh(shape)
    # Noise bends values that lie in a plane.
    planar = np.linalg.eigvalsh(np.cov(ways.T))[0] < 0.005
    if planar or not uncertainty < most or not 0 < stretches[-1] <= 3 * stretches[0]:
        return None
    size = float(np.linalg.det(shape) ** (1 / 3))
    return FieldFit(
        shape / size,
        middle + scale * centre,
        float(scale / size),
        uncertainty,
        np.eye(3),
        float(stretches[-1] / stretches[0]),
    )


def fit_field(time: Array, rates: Array, field: Array, seconds: float = 0.25) -> FieldFit | None:
    """Fit a magnetometer's offset and shape, using a gyroscope.

    Parameters
    ----------
    time : array of shape ``(n,)``
    rates : array of shape ``(n, 3)``
        The gyroscope's angular velocities in radians per second, without its bias.
    field : array of shape ``(n, 3)``

    Returns
    -------
    FieldFit or None
        None if the rotations do not suffice, or the correction improves nothing.

    Notes
    -----
    Carried back by the gyroscope to the beginning of a run of some seconds, the corrected field is
    one vector: ``D.T @ (A m - c) = f``. This is linear in ``A``, ``c`` and the field ``f`` of each
    run.
    """
    parts, size = pieces(time, rates, longest=80.0, seconds=seconds)
    outer, plain, runs = [], [], []
    for number, part in enumerate(parts):
        count = len(time[part]) // size
        if count < 4:
            continue
        dcms = turned(rates[part], steps_of(time[part]))[: count * size]
        blocks = dcms.reshape(count, size, 3, 3)
        those = field[part][: count * size].reshape(count, size, 3)
        outer.append(np.einsum("bnji,bnk->bijk", blocks, those) / size)
        plain.append(blocks.mean(axis=1).swapaxes(-1, -2))
        runs += [number] * count
    if len(runs) < 12:
        return None
    scale = np.median(np.linalg.norm(field - np.median(field, axis=0), axis=1)) or 1.0
    a = np.concatenate(outer).reshape(-1, 9) / scale
    c = -np.concatenate(plain).reshape(-1, 3)
    runs = np.array(runs)
    both = np.concatenate([a, c], axis=1).reshape(len(runs), 3, 12)
    # Removing the mean of each run eliminates its unknown field.
    for run in np.unique(runs):
        both[runs == run] -= both[runs == run].mean(axis=0)
    both = both.reshape(-1, 12)
    weights = np.ones(len(both))
    for _ in range(4):
        weighted = both * weights[:, None]
        # Minimise over all A of one size; c follows from A.
        onto, *_ = np.linalg.lstsq(weighted[:, 9:], weighted[:, :9], rcond=None)
        rest = weighted[:, :9] - weighted[:, 9:] @ onto
        _, sizes, ways = np.linalg.svd(rest, full_matrices=False)
        solution = ways[-1]
        left = (both[:, :9] - both[:, 9:] @ onto) @ solution
        weights = 1 / np.maximum(1.0, np.abs(left) / (2.5 * np.median(np.abs(left)) + 1e-12)) ** 0.5
    shape = solution.reshape(3, 3)
    noise = sizes[-1] / np.sqrt(max(1, len(rest) - 12))
    size_of_shape = abs(np.linalg.det(shape)) ** (1 / 3)
    # Another shape fits nearly as well.
    if size_of_shape < 0.05 or sizes[-1] > 0.4 * sizes[-2]:
        return None
    shape = shape / size_of_shape
    offset = -onto @ solution / size_of_shape
    # A field and its opposite fit equally well; choose the one without a reflection.
    if np.linalg.det(shape) < 0:
        shape, offset = -shape, -offset
    left_side, stretches, right_side = np.linalg.svd(shape)
    axes = left_side @ right_side
    centre = np.linalg.solve(shape, offset) * scale
    means = np.concatenate(outer) / scale
    carried = np.einsum("bijk,jk->bi", means, shape) - np.concatenate(plain) @ offset
    fields = [carried[runs == run].mean(axis=0) for run in np.unique(runs)]
    strength = float(np.median(np.linalg.norm(fields, axis=1)) * scale)
    # The least certain direction of A and the noise of a block bound the error of a direction.
    spread_a = noise / max(sizes[-2], 1e-12) * np.sqrt(3)
    spread_c = noise / max(np.linalg.svd(both[:, 9:], compute_uv=False)[-1], 1e-12)
    uncertainty = (
        (spread_a + spread_c * scale / max(strength, 1e-12) / size_of_shape) if strength else np.inf
    )
    stretch = float(stretches[0] / stretches[-1])
    fit = FieldFit(shape, centre, strength, float(uncertainty), axes, stretch)
    # A correction that makes things worse is useless.
    return (
        None
        if stretch > 3 or spread_of_lengths(fit.corrected(field)) > spread_of_lengths(field) + 0.02
        else fit
    )


def uneven_lengths(means: Array) -> tuple[str, Array, Array, float]:
    """Find the accelerometer fault that best explains varying lengths of gravity at rest.

    The fault is an offset or a scale, of one axis or of all. Each is tested on poses left out of
    the fit, one after another.

    Parameters
    ----------
    means : array of shape ``(m, 3)``
        Mean readings in the still poses, in multiples of gravity.

    Returns
    -------
    name, offset of shape ``(3,)``, scales of shape ``(3,)``, and the deviation of lengths then
        The corrected values are ``(measured - offset) / scales``.
    """
    axes = np.eye(3, dtype=bool)
    none, every = np.zeros(3, dtype=bool), np.ones(3, dtype=bool)
    faults = {
        **{f"An offset of {axis}": (own, none) for axis, own in zip("xyz", axes, strict=True)},
        **{f"A scale of {axis}": (none, own) for axis, own in zip("xyz", axes, strict=True)},
        "Offsets of several axes": (every, none),
        "Offsets and scales of several axes": (every, every),
    }

    def fitted(poses: Array, offsets: Array, scales: Array) -> tuple[Array, Array]:
        offset, scale = np.zeros(3), np.ones(3)
        for _ in range(4):
            true = (poses - offset) / scale
            slopes = np.concatenate([true[:, offsets], true[:, scales] ** 2], axis=1)
            slopes /= np.linalg.norm(true, axis=1, keepdims=True)
            corrections = np.linalg.lstsq(slopes, np.linalg.norm(true, axis=1) - 1, rcond=1e-6)[0]
            offset[offsets] += corrections[: offsets.sum()] * scale[offsets]
            scale[scales] *= 1 + corrections[offsets.sum() :]
        return offset, scale

    best = ("Nothing", np.zeros(3), np.ones(3), float(np.std(np.linalg.norm(means, axis=1))))
    for name, (offsets, scales) in faults.items():
        if offsets.sum() + scales.sum() > len(means) - 3:
            continue
        lengths = []
        for k, mean in enumerate(means):
            offset, scale = fitted(np.delete(means, k, axis=0), offsets, scales)
            lengths.append(np.linalg.norm((mean - offset) / scale))
        left = float(np.std(lengths))
        # Prefer a fault with few parameters if it explains nearly everything.
        if left < best[3] and (offsets.sum() + scales.sum() == 1 or best[3] > 0.008):
            best = name, *fitted(means, offsets, scales), left
    return best
