"""Recordings of an instrument that is turned from pose to pose, with the truth,
and with one thing wrong if wanted.
"""

import numpy as np
from scipy.spatial.transform import Rotation

GRAVITY = 9.80665
NAMES = ["time (s)"] + [f"{kind}_{axis}" for kind in ("gyr", "acc", "mag") for axis in "xyz"]
QUATERNION = ["qw", "qx", "qy", "qz"]


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def simulate(seed, rate=100, poses=7, dip=60.0, strength=48.0):
    """Arrays of what an honest instrument says: gyroscope in rad/s,
    acceleration in m/s², field in microtesla.
    """
    random = np.random.default_rng(seed)
    step = 1 / rate
    rates, accelerations = [], []
    for number in range(poses):
        rest = round(random.uniform(1.2, 2.5) * rate)
        rates.append(np.zeros((rest, 3)))
        accelerations.append(np.zeros((rest, 3)))
        if number < poses - 1:
            seconds = random.uniform(1.2, 2.5)
            share = (np.arange(round(seconds * rate)) + 0.5) / (seconds * rate)
            bell = 30 * share**2 * (1 - share) ** 2 / seconds
            way = unit(random.normal(size=3)) * np.radians(random.uniform(50, 170))
            wobble = np.sin(2 * np.pi * np.outer(share, [1, 1.5, 2]))
            wobble = wobble * random.normal(scale=0.3, size=3) * (4 * share * (1 - share))[:, None]
            rates.append(bell[:, None] * way + wobble)
            pushes = np.sin(
                2 * np.pi * np.outer(share, random.uniform(1, 3, 3)) + random.uniform(0, 6, 3)
            )
            accelerations.append(
                0.6 * random.normal(size=3) * pushes * (4 * share * (1 - share))[:, None]
            )
    rates, accelerations = np.concatenate(rates), np.concatenate(accelerations)
    count = len(rates)
    turns = Rotation.from_rotvec((rates[1:] + rates[:-1]) / 2 * step)
    # SciPy's rotations turn components of the body into the ground's.
    ground = [Rotation.random(random_state=seed)]
    for turn in turns:
        ground.append(ground[-1] * turn)
    ground = Rotation.concatenate(ground)
    field = strength * np.array([np.cos(np.radians(dip)), 0, -np.sin(np.radians(dip))])
    bias = np.radians(random.normal(scale=0.05, size=3))
    slow = np.cumsum(random.normal(size=(count, 3)), axis=0) / np.sqrt(count)
    return {
        "time": np.arange(count) * step,
        "gyroscope": rates + bias + np.radians(0.07) * random.normal(size=(count, 3)),
        "accelerometer": ground.inv().apply([0, 0, GRAVITY] + accelerations)
        + 0.02 * random.normal(size=(count, 3)),
        "magnetometer": ground.inv().apply(field) + 0.3 * random.normal(size=(count, 3)),
        # As scikit-kinematics and SciPy have them, the ground from the
        # body, here with the scalar first.
        "quaternion": np.roll(
            (ground * Rotation.from_rotvec(np.radians(0.3) * slow)).as_quat(), 1, axis=1
        ),
        "truth": ground,
    }


def as_text(recording, names=None, quaternion=False, digits=6):
    """A CSV of a recording."""
    columns = [
        recording["time"][:, None],
        *(recording[kind] for kind in ("gyroscope", "accelerometer", "magnetometer")),
    ]
    if quaternion:
        columns.append(recording["quaternion"])
    names = list(names or NAMES + QUATERNION * quaternion)
    rows = np.concatenate(columns, axis=1)
    lines = [",".join(f"{value:.{digits}f}" for value in row) for row in rows]
    return "\n".join([",".join(names), *lines]) + "\n"
