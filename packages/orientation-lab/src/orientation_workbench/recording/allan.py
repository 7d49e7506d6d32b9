"""Noise and bias of a gyroscope at rest, from its Allan deviation."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from .table import Array


class StillNoise(NamedTuple):
    """The noise of each axis according to the Allan deviation, NaN where it cannot tell.

    Attributes
    ----------
    angle_random_walk : array of shape ``(k,)``
        From the part with slope -1/2, the value at one second, in the rates' unit times the square
        root of a second.
    bias_instability : array of shape ``(k,)``
        The lowest point, in the rates' unit; NaN if the deviation still falls at its end.
    time : array of shape ``(k,)``
        The averaging time of that lowest point, in seconds.
    """

    angle_random_walk: Array
    bias_instability: Array
    time: Array


def allan_deviation(rates: Array, step: float) -> tuple[Array, Array]:
    """Return the Allan deviation of an instrument at rest, from all stretches of each length.

    ``sigma(tau)**2`` is half the mean square of the difference between the means of neighbouring
    stretches (El-Sheimy, Hou and Niu 2008; in the book equation (19.1)).

    Parameters
    ----------
    rates : array of shape ``(n, k)``
    step : float
        Seconds between samples.

    Returns
    -------
    times of shape ``(m,)`` in seconds, deviations of shape ``(m, k)`` in the unit of the rates
        Up to a ninth of the recording; there are too few longer stretches.

    Examples
    --------
    >>> times, deviations = allan_deviation(np.random.default_rng(1).normal(size=(4000, 1)), 0.01)
    >>> noise_of(times, deviations).angle_random_walk.round(2)
    array([0.1])
    """
    path = np.concatenate(
        [np.zeros((1, rates.shape[1])), np.cumsum(rates - rates.mean(axis=0), axis=0)]
    )
    sizes = np.unique(np.geomspace(1, max(1, (len(path) - 1) // 9), 30).astype(int))
    deviations = []
    for size in sizes:
        change = path[2 * size :] - 2 * path[size:-size] + path[: -2 * size]
        deviations.append(np.sqrt((change**2).mean(axis=0) / 2) / size)
    return sizes * step, np.array(deviations)


def noise_of(times: Array, deviations: Array) -> StillNoise:
    """Read angle random walk and bias instability off an Allan deviation.

    Parameters
    ----------
    times : array of shape ``(m,)``
    deviations : array of shape ``(m, k)``
        As `allan_deviation` returns them.

    Returns
    -------
    StillNoise
    """
    walks, lowest, where = [], [], []
    for values in deviations.T:
        bottom = int(values.argmin())
        if len(times) < 6 or values.min() <= 0:
            walks.append(np.nan)
        else:
            slopes = np.gradient(np.log(values), np.log(times))
            turned = int(np.argmax(slopes > -0.25)) if (slopes > -0.25).any() else len(times)
            falling = slice(0, max(3, turned // 2))
            # A different slope has a different cause: a hand, an engine, rounding.
            white = abs(np.median(slopes[falling]) + 0.5) < 0.15
            walks.append(
                np.exp(np.mean(np.log(values * np.sqrt(times))[falling])) if white else np.nan
            )
        # By chance the last points may lie a little above the one before.
        told = bottom < len(times) - 2 and values[-1] > 1.1 * values[bottom]
        lowest.append(values[bottom] if told else np.nan)
        where.append(times[bottom] if told else np.nan)
    return StillNoise(np.array(walks), np.array(lowest), np.array(where))
