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


def shift(rng, low, high):
    """Return a push of one axis, of a size between two."""
    axis, sign = some_axis(rng)
    return np.eye(3)[axis] * sign * rng.uniform(low, high)


def stretched(values, rng):
    """Return values (n, 3) with one axis 6 to 15 per cent too long or too short."""
    axis, sign = some_axis(rng)
    return scaled(values, axis, 1 + sign * rng.uniform(0.06, 0.15))


def warming(time, rng):
    """Return a share (n,) that rises from 0 towards 1, as an instrument warms up."""
    return 1 - np.exp(-time / rng.uniform(20.0, 60.0))


def soft(values, rng):
    """Return values (n, 3) that iron near the instrument has stretched along one axis."""
    axis = shift(rng, 1.0, 1.0)
    stretch = np.eye(3) + 0.2 * np.outer(axis, axis) + 0.06 * rng.normal(size=(3, 3))
    return values @ (stretch + stretch.T) / 2


def clipped(values, limit):
    """Return values (n, 3) that stop at a limit."""
    return np.clip(values, -limit, limit)


def passed_by(time, rng):
    """Return what iron adds (n, 3) while the instrument passes it."""
    middle = rng.uniform(0.3, 0.7) * time[-1]
    push = rng.normal(size=3)
    push *= rng.uniform(25.0, 60.0) / np.linalg.norm(push)
    return np.outer(np.exp(-(((time - middle) / rng.uniform(1.5, 4.0)) ** 2)), push)


#: What happens to the numbers of one sensor, given them, the time and a generator; each size is one
#: that happens. A range of less than one g is what a wrong setting of the full scale gives.
CHANGES = {
    "gyroscope saturated": lambda v, t, rng: clipped(v, rng.uniform(0.45, 0.65) * np.abs(v).max()),
    "gyroscope late": lambda v, t, rng: late(v, 0.06),
    "gyroscope bias": lambda v, t, rng: v + shift(rng, 1.0, 4.0),
    "gyroscope drifts": lambda v, t, rng: v + np.outer(warming(t, rng), shift(rng, 2.0, 4.0)),
    "gyroscope scale of an axis": lambda v, t, rng: stretched(v, rng),
    "gyroscope axis reversed": lambda v, t, rng: scaled(v, some_axis(rng)[0], -1.0),
    "gyroscope axes exchanged": lambda v, t, rng: exchanged(v, rng),
    "gyroscope in rad/s": lambda v, t, rng: np.radians(v),
    "gyroscope in counts": lambda v, t, rng: np.round(v * rng.choice([16.4, 32.8, 65.5, 131.0])),
    "accelerometer axis reversed": lambda v, t, rng: scaled(v, some_axis(rng)[0], -1.0),
    "accelerometer negated": lambda v, t, rng: -v,
    "accelerometer axes exchanged": lambda v, t, rng: exchanged(v, rng),
    "accelerometer in g": lambda v, t, rng: v / 9.81,
    "accelerometer bias": lambda v, t, rng: v + shift(rng, 0.5, 1.5),
    "accelerometer scale of an axis": lambda v, t, rng: stretched(v, rng),
    "accelerometer saturated": lambda v, t, rng: clipped(v, rng.uniform(0.75, 0.9) * 9.81),
    "magnetometer late": lambda v, t, rng: late(v, 0.2),
    "magnetometer hard iron": lambda v, t, rng: v + shift(rng, 10.0, 30.0),
    "magnetometer soft iron": lambda v, t, rng: soft(v, rng),
    "magnetometer axis reversed": lambda v, t, rng: scaled(v, some_axis(rng)[0], -1.0),
    "magnetometer disturbed for a while": lambda v, t, rng: v + passed_by(t, rng),
}
KINDS = (*CHANGES, "gyroscope follows temperature", "samples lost")


def plant(kind, recording, rng):
    """Return the recording with one fault."""
    now, time = dict(recording), recording["time"]
    if kind == "gyroscope follows temperature":
        warm = warming(time, rng)
        now["temperature"] = now["temperature"] + 18 * warm
        now["gyroscope"] = now["gyroscope"] + np.outer(warm, shift(rng, 2.0, 4.0))
    elif kind == "samples lost":
        fast = np.flatnonzero(np.linalg.norm(now["gyroscope"], axis=1) > 60)
        keep = np.ones(len(time), bool)
        for start in rng.choice(fast, 4):
            keep[start : start + rng.integers(20, 60)] = False
        now = {name: column[keep] for name, column in now.items()}
        now["time"] = time[: keep.sum()]
    elif kind != "none":
        sensor = kind.split()[0]
        now[sensor] = CHANGES[kind](now[sensor], time, rng)
    return now


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
