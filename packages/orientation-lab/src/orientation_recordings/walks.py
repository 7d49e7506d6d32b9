"""Simulated walks with a phone in the hand, past a parked car, with the true orientations."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from orientation import dcm_from_body_fixed, dcms_after_turns, random_orientations

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

STEP = 0.04
#: In seconds. The phone is on a table until somebody picks it up, and later passes the car.
TAKEN, CAR = 8.0, (28.0, 33.0)
#: The parameters that may differ from walk to walk, besides the noise and the gyroscope's bias.
EVERYTHING = frozenset({"step", "look", "pose", "side"})
#: In microtesla, along x (north), y (west) and z (up), in central Europe.
FIELD = np.array([20.0, 0, -44])
#: Per sample, in radians per second, multiples of gravity and microtesla.
NOISE = np.radians(0.2), 0.05 / 9.80665, 0.5
#: For the gyroscope's constant bias, in radians per second.
BIAS = np.radians(0.5)
_USUAL_POSE = dcm_from_body_fixed(np.radians([70, 20, -35]), "zxy")


class Walks(NamedTuple):
    """What phones measure on walks, and their true orientations.

    Attributes
    ----------
    time : array of shape ``(n,)``
        Seconds.
    angular_velocity : array of shape ``(count, n, 3)``
        Along the phone's axes, in radians per second.
    specific_force : array of shape ``(count, n, 3)``
        Along the phone's axes, in multiples of gravity.
    magnetic_field : array of shape ``(count, n, 3)``
        Along the phone's axes, in microtesla.
    dcms : array of shape ``(count, n, 3, 3)``
        ``P_C_E``, the phone relative to a ground with x north, y west and z up.
    bias : array of shape ``(count, 3)``
        The gyroscope's bias, in radians per second.
    """

    time: Array
    angular_velocity: Array
    specific_force: Array
    magnetic_field: Array
    dcms: Array
    bias: Array


def walks(
    count: int,
    random: np.random.Generator | int,
    varied: Collection[str] = EVERYTHING,
    steel: float = 10.0,
    gradual: bool = False,
) -> Walks:
    """Simulate walks: eight seconds on a table, then steps, and a car from 28 to 33 s.

    Parameters
    ----------
    count : int
    random : numpy.random.Generator or int
    varied : collection of str, optional
        What differs from walk to walk: the phase of the first step ("step"), when the owner looks
        around ("look"), how the phone is held ("pose"), on which side the car is ("side").
    steel : float, optional
        The horizontal field that the car adds, in microtesla; 0 for no car.
    gradual : bool, optional
        Whether the steel's field rises and falls gradually on the way past, not at once.

    Returns
    -------
    Walks
    """
    random = np.random.default_rng(random)
    time = np.arange(0, 45, STEP)
    going = np.clip(time - TAKEN, 0, 1)[:, None]
    inside = (time > CAR[0]) & (time < CAR[1])
    near = np.sin(np.pi * (time - CAR[0]) / (CAR[1] - CAR[0])) ** 2 if gradual else 1.0
    by_the_car = np.where(inside, near, 0.0)
    reports = []
    for _ in range(count):
        foot, look, side = (
            random.uniform(0, 2 * np.pi) if name in varied else usual
            for name, usual in (("step", 0), ("look", 0), ("side", np.pi / 2))
        )
        pose = random_orientations(1, random)[0] if "pose" in varied else _USUAL_POSE
        paces = 2 * np.pi * 1.9 * time + foot
        swing = [
            25 * np.sin(paces),
            12 * np.sin(paces / 2),
            20 * np.sin(2 * np.pi * 0.07 * time + look),
        ]
        rates = going * np.radians(np.column_stack(swing))
        pushes = [np.sin(paces + 1), 0.7 * np.sin(paces / 2), 2.5 * np.sin(paces)]
        force = [0, 0, 1] + going * np.column_stack(pushes) / 9.80665
        field = FIELD + steel * np.outer(by_the_car, [np.cos(side), np.sin(side), 0])
        dcms = dcms_after_turns(pose, (rates[1:] + rates[:-1]) / 2 * STEP)
        bias = random.normal(scale=BIAS, size=3)
        exact = rates + bias, *(np.einsum("nij,nj->ni", dcms, vector) for vector in (force, field))
        noisy = (
            values + random.normal(scale=scale, size=rates.shape)
            for values, scale in zip(exact, NOISE)
        )
        reports.append((*noisy, dcms, bias))
    return Walks(time, *(np.array(each) for each in zip(*reports)))
