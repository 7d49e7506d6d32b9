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


def _lost(recording, random):
    keep = np.ones(len(recording["time"]), dtype=bool)
    for start in random.choice(len(keep) - 60, 6, replace=False):
        keep[start : start + random.integers(15, 40)] = False
    return {key: value[keep] for key, value in recording.items() if key != "truth"}


def _repeated(recording, random):
    found = dict(recording)
    stuck = np.arange(len(recording["time"]))
    late = random.random(len(stuck)) < 0.3
    late[0] = False
    stuck = np.maximum.accumulate(np.where(late, 0, stuck))
    for kind in ("gyroscope", "accelerometer", "magnetometer", "quaternion"):
        found[kind] = recording[kind][stuck]
    return found


def _assignment(random, without_sign=False):
    """Signed axes that are not the plain ones; ``without_sign``: nor their opposites."""
    while True:
        matrix = np.eye(3)[random.permutation(3)] * random.choice([-1, 1], size=3)[:, None]
        if not np.allclose(matrix, np.eye(3)) and not (
            without_sign and np.allclose(matrix, -np.eye(3))
        ):
            return matrix


def _disturbed(recording, random):
    found = dict(recording)
    time = recording["time"]
    start = random.uniform(0.25, 0.45) * time[-1]
    near = (time > start) & (time < start + 0.35 * time[-1])
    steel = unit(random.normal(size=3)) * random.uniform(25, 40)
    found["magnetometer"] = recording["magnetometer"] + near[:, None] * recording[
        "truth"
    ].inv().apply(steel)
    return found


def _with(kind, change):
    def faulty(recording, random):
        return recording | {kind: change(recording[kind], random)}

    return faulty


def _soft(values, random):
    turn = Rotation.random(random_state=random.integers(1 << 30)).as_matrix()
    return values @ (turn * random.uniform([0.7, 0.95, 1.2], [0.85, 1.05, 1.4])) @ turn.T


#: What can be wrong, and the light that has to be red then.
FAULTS = {
    "gaps": ("gaps", _lost),
    "repeated rows": ("repeated rows", _repeated),
    "unit of the gyroscope": (
        "unit of the gyroscope",
        _with("gyroscope", lambda values, random: np.degrees(values)),
    ),
    "axes of the gyroscope": (
        "axes of the gyroscope",
        _with("gyroscope", lambda values, random: values @ _assignment(random).T),
    ),
    "scale of the gyroscope": (
        "scale of the gyroscope",
        _with(
            "gyroscope",
            lambda values, random: values * random.choice([0.5, 0.7, 0.85, 1.15, 1.3, 1.6, 2.0]),
        ),
    ),
    "bias of the gyroscope": (
        "bias of the gyroscope",
        _with(
            "gyroscope",
            lambda values, random: (
                values + np.radians(unit(random.normal(size=3)) * random.uniform(2, 6))
            ),
        ),
    ),
    "accelerometer": (
        "accelerometer",
        _with(
            "accelerometer",
            lambda values, random: values + unit(random.normal(size=3)) * random.uniform(0.6, 1.5),
        ),
    ),
    "hard iron": (
        "offset of the magnetometer",
        _with(
            "magnetometer",
            lambda values, random: values + unit(random.normal(size=3)) * random.uniform(12, 60),
        ),
    ),
    "soft iron": ("shape of the magnetometer", _with("magnetometer", _soft)),
    "axes of the magnetometer": (
        "axes of the magnetometer",
        _with(
            "magnetometer", lambda values, random: values @ _assignment(random, without_sign=True).T
        ),
    ),
    "disturbed field": ("field", _disturbed),
    "order of the quaternion": (
        "quaternion",
        _with("quaternion", lambda values, random: np.roll(values, -1, axis=1)),
    ),
}


def faulty(kind, seed):
    """The text of a recording with one thing wrong, by the names of ``FAULTS``;
    and the light that belongs to it.
    """
    light, spoil = FAULTS[kind]
    recording = spoil(simulate(seed), np.random.default_rng(seed + 1000))
    names = NAMES + QUATERNION
    if kind == "unit of the gyroscope":
        names = [name + " (rad/s)" if name.startswith("gyr") else name for name in names]
    return as_text(recording, names, quaternion=True), light
