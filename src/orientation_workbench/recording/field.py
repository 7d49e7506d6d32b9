"""A magnetometer's offset, shape and axes: the field must stay where it is while the gyroscope says it turns."""

from typing import NamedTuple

import numpy as np

from .motion import pieces, steps_of, turned


class FieldFit(NamedTuple):
    """What makes a magnetometer see one field, however it is turned: ``shape @ (measured - offset)``.

    Attributes
    ----------
    shape : array of shape ``(3, 3)``
        Of determinant 1; the axes of the gyroscope from those of the magnetometer, and what soft iron did.
    offset : array of shape ``(3,)``
        Of hard iron, in the magnetometer's unit.
    strength : float
        Length of the field that is left, in that unit.
    uncertainty : float
        Standard deviation of a direction that is computed with it, radians.
    fields : array of shape ``(k, 3)``
        The field in each run, along the axes at its beginning.
    axes : array of shape ``(3, 3)``
        The turn nearest to ``shape``.
    stretch : float
        Longest over shortest axis of the rest.
    """

    shape: np.ndarray
    offset: np.ndarray
    strength: float
    uncertainty: float
    fields: np.ndarray
    axes: np.ndarray
    stretch: float


def fit_field(time, rates, field, seconds=0.25):
    """Fit offset and shape of a magnetometer.

    Parameters
    ----------
    time : array of shape ``(n,)``
    rates : array of shape ``(n, 3)``
        Of the gyroscope, radians per second, its bias removed.
    field : array of shape ``(n, 3)``

    Returns
    -------
    FieldFit or None
        None where the turns do not decide, or nothing is better for the correction.

    Notes
    -----
    Carried back by the gyroscope to the beginning of a run of some seconds, the corrected field is one vector:
    ``D.T @ (A m - c) = f``. That is linear in ``A``, ``c`` and the field ``f`` of each run.
    """
    parts, size = pieces(time, rates, longest=80.0, seconds=seconds)
    outer, plain, runs = [], [], []
    for number, part in enumerate(parts):
        count = len(time[part]) // size
        if count < 4:
            continue
        dcms = turned(rates[part], steps_of(time[part]))[: count * size]
        those = field[part][: count * size]
        blocks = dcms.reshape(count, size, 3, 3)
        outer.append(np.einsum("bnji,bnk->bijk", blocks, those.reshape(count, size, 3)) / size)
        plain.append(blocks.mean(axis=1).swapaxes(-1, -2))
        runs += [number] * count
    if len(runs) < 12:
        return None
    scale = np.median(np.linalg.norm(field - np.median(field, axis=0), axis=1)) or 1.0
    a = np.concatenate(outer).reshape(-1, 9) / scale
    c = -np.concatenate(plain).reshape(-1, 3)
    runs = np.repeat(runs, 3)
    axis = np.tile(np.arange(3), len(runs) // 3)
    both = np.concatenate([a, c], axis=1)
    for run in np.unique(runs):  # the field of a run is what is left of its mean
        for k in range(3):
            rows = (runs == run) & (axis == k)
            both[rows] -= both[rows].mean(axis=0)
    weights = np.ones(len(both))
    for _ in range(4):
        weighted = both * weights[:, None]
        # Of all A of one size, the one that leaves least; c follows from it.
        onto, *_ = np.linalg.lstsq(weighted[:, 9:], weighted[:, :9], rcond=None)
        rest = weighted[:, :9] - weighted[:, 9:] @ onto
        _, sizes, ways = np.linalg.svd(rest, full_matrices=False)
        solution = ways[-1]
        left = (both[:, :9] - both[:, 9:] @ onto) @ solution
        weights = 1 / np.maximum(1.0, np.abs(left) / (2.5 * np.median(np.abs(left)) + 1e-12)) ** 0.5
    shape = solution.reshape(3, 3)
    noise = sizes[-1] / np.sqrt(max(1, len(rest) - 12))
    size_of_shape = abs(np.linalg.det(shape)) ** (1 / 3)
    if size_of_shape < 0.05 or sizes[-1] > 0.4 * sizes[-2]:  # another shape fits nearly as well
        return None
    shape = shape / size_of_shape
    offset = -onto @ solution / size_of_shape
    if np.linalg.det(shape) < 0:  # a field and its opposite fit alike: taken is what needs no mirror
        shape, offset = -shape, -offset
    left_side, stretches, right_side = np.linalg.svd(shape)
    axes = left_side @ right_side
    centre = np.linalg.solve(shape, offset) * scale
    means = np.concatenate(outer) / scale
    carried = np.einsum("bijk,jk->bi", means, shape) - np.concatenate(plain) @ offset
    fields = np.array([carried[runs[::3] == run].mean(axis=0) for run in np.unique(runs)]) * scale
    strength = float(np.median(np.linalg.norm(fields, axis=1)))
    # The way in which A is known least, and the noise of a block, give how far a direction can be off.
    spread_a = noise / max(sizes[-2], 1e-12) * np.sqrt(3)
    spread_c = noise / max(np.linalg.svd(both[:, 9:], compute_uv=False)[-1], 1e-12)
    uncertainty = (spread_a + spread_c * scale / max(strength, 1e-12) / size_of_shape) if strength else np.inf
    lengths, before = (np.linalg.norm(values, axis=1) for values in ((field - centre) @ shape.T, field))
    if stretches[0] > 3 * stretches[-1] or lengths.std() / lengths.mean() > before.std() / before.mean() + 0.02:
        return None  # a correction that makes things worse is none
    return FieldFit(shape, centre, strength, float(uncertainty), fields, axes, float(stretches[0] / stretches[-1]))
