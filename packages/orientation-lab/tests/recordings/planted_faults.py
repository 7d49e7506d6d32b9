"""Recordings of an instrument in a hand, with at most one fault planted: physics and noise only.

An instrument is carried from pose to pose and laid down, and waved about at the end. Rotations are
SciPy's, from the body to a world whose axes point east, north and up.
"""

import io

import numpy as np
from scipy.spatial.transform import Rotation, RotationSpline

RATE = 100.0
GRAVITY = np.array([0.0, 0.0, -9.81])
HEADINGS = (
    "time [s],gyr_x [deg/s],gyr_y [deg/s],gyr_z [deg/s],acc_x [m/s^2],acc_y [m/s^2],acc_z [m/s^2],"
    "mag_x [uT],mag_y [uT],mag_z [uT],temperature [degC]"
)


def hand(rng):
    """Return rotations from the body, angular velocities in the body and accelerations (n, 3)."""
    rotations, velocities, accelerations = [], [], []
    pose = Rotation.random(random_state=rng)

    def lie(seconds):
        length = int(seconds * RATE)
        rotations.append(np.tile(pose.as_quat(), (length, 1)))
        velocities.append(np.zeros((length, 3)))
        accelerations.append(np.zeros((length, 3)))

    lie(rng.uniform(4.0, 7.0))
    for _ in range(rng.integers(9, 15)):
        seconds = rng.uniform(0.9, 1.8)
        axis = rng.normal(size=3)
        turn = axis / np.linalg.norm(axis) * np.radians(rng.uniform(50.0, 150.0))
        way = rng.normal(0.0, 0.12, 3)
        part = np.arange(int(seconds * RATE)) / (seconds * RATE)
        share = part**3 * (10 - 15 * part + 6 * part**2)
        speed = 30 * part**2 * (1 - part) ** 2 / seconds
        push = (60 * part - 180 * part**2 + 120 * part**3) / seconds**2
        rotations.append((pose * Rotation.from_rotvec(np.outer(share, turn))).as_quat())
        velocities.append(np.outer(speed, turn))
        accelerations.append(np.outer(push, way))
        pose = pose * Rotation.from_rotvec(turn)
        lie(rng.uniform(1.5, 3.0))
    # The waving begins and ends at rest: the spline's first and last poses are repeated.
    steps = int(rng.integers(20, 36))
    poses = [pose, pose]
    for _ in range(steps):
        poses.append(poses[-1] * Rotation.from_rotvec(rng.normal(0.0, 0.6, 3)))
    poses.append(poses[-1])
    knots = 0.5 * np.arange(len(poses))
    spline = RotationSpline(knots, Rotation.concatenate(poses))
    times = np.arange(0.0, knots[-1], 1 / RATE)
    rotations.append(spline(times).as_quat())
    velocities.append(spline(times, 1))
    waves = rng.uniform(0.4, 1.6, (4, 1, 3)) * 2 * np.pi
    phases = rng.uniform(0.0, 2 * np.pi, (4, 1, 3))
    swing = (0.4 * np.sin(waves * times[:, None] + phases)).sum(axis=0)
    accelerations.append(swing * np.clip(np.minimum(times, times[-1] - times), 0, 1)[:, None])
    pose = poses[-1]
    lie(rng.uniform(2.0, 4.0))
    return (
        Rotation.from_quat(np.concatenate(rotations)),
        np.concatenate(velocities),
        np.concatenate(accelerations),
    )


def honest(rng):
    """Return a recording as a good small instrument gives it: a dictionary of columns."""
    attitude, velocity, acceleration = hand(rng)
    count = len(velocity)
    dip, strength = np.radians(rng.uniform(50.0, 70.0)), rng.uniform(42.0, 55.0)
    field = strength * np.array([0.0, np.cos(dip), -np.sin(dip)])

    def near_one():
        return np.eye(3) + np.diag(rng.normal(0.0, 0.003, 3)) + rng.normal(0.0, 0.001, (3, 3))

    gyroscope = np.degrees(velocity) @ near_one() + rng.normal(0.0, 0.04, 3)
    accelerometer = attitude.inv().apply(acceleration - GRAVITY) @ near_one()
    magnetometer = attitude.inv().apply(field) @ near_one() + rng.normal(0.0, 0.3, 3)
    return {
        "time": np.arange(count) / RATE,
        "gyroscope": gyroscope + rng.normal(0.0, 0.08, (count, 3)),
        "accelerometer": accelerometer
        + rng.normal(0.0, 0.02, 3)
        + rng.normal(0.0, 0.02, (count, 3)),
        "magnetometer": magnetometer + rng.normal(0.0, 0.3, (count, 3)),
        "temperature": 24 + rng.normal(0.0, 0.02, count),
    }


def late(values, seconds):
    """Return values (n, 3) that stand seconds behind: the first of them is repeated."""
    delay = round(seconds * RATE)
    return np.concatenate([np.tile(values[:1], (delay, 1)), values[:-delay]])


def scaled(values, axis, factor):
    """Return values (n, 3) with one axis multiplied."""
    values = values.copy()
    values[:, axis] *= factor
    return values


def some_axis(rng):
    """Return an axis, and a sign."""
    return int(rng.integers(3)), rng.choice([-1.0, 1.0])


def exchanged(values, rng):
    """Return values (n, 3) whose axes are renamed as in another mounting: a proper rotation."""
    turns = [
        matrix
        for matrix in Rotation.create_group("O").as_matrix().round()
        if np.trace(matrix) < 0.5 and np.abs(np.diag(matrix)).sum() < 2
    ]
    return values @ turns[rng.integers(len(turns))]


def plant(kind, recording, rng):
    """Return the recording with one fault; each size is one that happens."""
    now = {name: column.copy() for name, column in recording.items()}
    gyroscope, accelerometer = now["gyroscope"], now["accelerometer"]
    magnetometer, time = now["magnetometer"], now["time"]
    axis, sign = some_axis(rng)
    shift = np.zeros(3)
    shift[axis] = sign
    if kind == "gyroscope saturated":
        limit = rng.uniform(0.45, 0.65) * np.abs(gyroscope).max()
        now["gyroscope"] = np.clip(gyroscope, -limit, limit)
    elif kind == "gyroscope late":
        now["gyroscope"] = late(gyroscope, 0.06)
    elif kind == "gyroscope bias":
        now["gyroscope"] = gyroscope + shift * rng.uniform(1.0, 4.0)
    elif kind == "gyroscope drifts":
        warm = 1 - np.exp(-time / rng.uniform(20.0, 60.0))
        now["gyroscope"] = gyroscope + np.outer(warm, shift) * rng.uniform(2.0, 4.0)
    elif kind == "gyroscope follows temperature":
        warm = 1 - np.exp(-time / rng.uniform(20.0, 60.0))
        now["temperature"] = now["temperature"] + 18 * warm
        now["gyroscope"] = gyroscope + np.outer(warm, shift) * rng.uniform(2.0, 4.0)
    elif kind == "gyroscope scale of an axis":
        now["gyroscope"] = scaled(gyroscope, axis, 1 + sign * rng.uniform(0.06, 0.15))
    elif kind == "gyroscope axis reversed":
        now["gyroscope"] = scaled(gyroscope, axis, -1.0)
    elif kind == "gyroscope axes exchanged":
        now["gyroscope"] = exchanged(gyroscope, rng)
    elif kind == "gyroscope in rad/s":
        now["gyroscope"] = np.radians(gyroscope)
    elif kind == "gyroscope in counts":
        now["gyroscope"] = np.round(gyroscope * rng.choice([16.4, 32.8, 65.5, 131.0]))
    elif kind == "accelerometer axis reversed":
        now["accelerometer"] = scaled(accelerometer, axis, -1.0)
    elif kind == "accelerometer negated":
        now["accelerometer"] = -accelerometer
    elif kind == "accelerometer axes exchanged":
        now["accelerometer"] = exchanged(accelerometer, rng)
    elif kind == "accelerometer in g":
        now["accelerometer"] = accelerometer / 9.81
    elif kind == "accelerometer bias":
        now["accelerometer"] = accelerometer + shift * rng.uniform(0.5, 1.5)
    elif kind == "accelerometer scale of an axis":
        now["accelerometer"] = scaled(accelerometer, axis, 1 + sign * rng.uniform(0.06, 0.15))
    elif kind == "accelerometer saturated":
        # A range of one g and a bit is what a wrong setting of full scale gives.
        limit = rng.uniform(0.75, 0.9) * 9.81
        now["accelerometer"] = np.clip(accelerometer, -limit, limit)
    elif kind == "magnetometer late":
        now["magnetometer"] = late(magnetometer, 0.2)
    elif kind == "magnetometer hard iron":
        now["magnetometer"] = magnetometer + shift * rng.uniform(10.0, 30.0)
    elif kind == "magnetometer soft iron":
        stretch = np.eye(3) + 0.2 * np.outer(shift, shift) + 0.06 * rng.normal(size=(3, 3))
        now["magnetometer"] = magnetometer @ (stretch + stretch.T) / 2
    elif kind == "magnetometer axis reversed":
        now["magnetometer"] = scaled(magnetometer, axis, -1.0)
    elif kind == "magnetometer disturbed for a while":
        middle = rng.uniform(0.3, 0.7) * time[-1]
        bump = np.exp(-(((time - middle) / rng.uniform(1.5, 4.0)) ** 2))
        push = rng.normal(size=3)
        push *= rng.uniform(25.0, 60.0) / np.linalg.norm(push)
        now["magnetometer"] = magnetometer + np.outer(bump, push)
    elif kind == "samples lost":
        fast = np.flatnonzero(np.linalg.norm(gyroscope, axis=1) > 60)
        keep = np.ones(len(time), bool)
        for start in rng.choice(fast, 4):
            keep[start : start + rng.integers(20, 60)] = False
        now = {name: column[keep] for name, column in now.items()}
        now["time"] = np.arange(keep.sum()) / RATE
    elif kind != "none":
        raise ValueError(f"no fault is called {kind!r}")
    return now


KINDS = (
    "gyroscope saturated",
    "gyroscope late",
    "gyroscope bias",
    "gyroscope drifts",
    "gyroscope follows temperature",
    "gyroscope scale of an axis",
    "gyroscope axis reversed",
    "gyroscope axes exchanged",
    "gyroscope in rad/s",
    "gyroscope in counts",
    "accelerometer axis reversed",
    "accelerometer negated",
    "accelerometer axes exchanged",
    "accelerometer in g",
    "accelerometer bias",
    "accelerometer scale of an axis",
    "accelerometer saturated",
    "magnetometer late",
    "magnetometer hard iron",
    "magnetometer soft iron",
    "magnetometer axis reversed",
    "magnetometer disturbed for a while",
    "samples lost",
)


def text(recording):
    """Return the recording as the file that a logger writes."""
    columns = [
        recording["time"][:, None],
        recording["gyroscope"],
        recording["accelerometer"],
        recording["magnetometer"],
        recording["temperature"][:, None],
    ]
    page = io.StringIO()
    formats = ["%.4f"] * 7 + ["%.3f"] * 3 + ["%.2f"]
    np.savetxt(page, np.hstack(columns), formats, ",", header=HEADINGS, comments="")
    return page.getvalue()


def sample(kind, seed):
    """Return the file of the seed's instrument with the fault of this kind, ``"none"`` for none."""
    rng = np.random.default_rng([seed, sum(map(ord, kind))])
    return text(plant(kind, honest(rng), rng))
