"""Recordings of a simulated inertial sensor, honest or with one fault of a known kind.

A hand takes the device from pose to pose in movements of minimum jerk, about an elbow or a
shoulder, and lays it down or holds it, with a hand's wobble and tremor. The sensors are those of
cheap parts: noise, a bias that walks, errors of scale and alignment, whole counts, clocks that
jitter, and the rates at which such parts really sample. No part of the bench is imported.
"""

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

#: Metres per second squared.
GRAVITY = 9.81
RATES = (50, 59.5, 100, 104, 119, 128)
#: Steps of the true motion in one sample, so that a delay can be a part of a sample.
FINE = 4

KINDS = (
    "gyroscope saturated",
    "gyroscope late",
    "gyroscope offset",
    "gyroscope drifts",
    "gyroscope drifts with temperature",
    "gyroscope scale of an axis",
    "gyroscope scale",
    "gyroscope axis reversed",
    "gyroscope axes exchanged",
    "gyroscope unit",
    "accelerometer saturated",
    "accelerometer offset",
    "accelerometer scale of an axis",
    "accelerometer axis reversed",
    "accelerometer axes exchanged",
    "accelerometer unit",
    "magnetometer late",
    "magnetometer hard iron",
    "magnetometer soft iron",
    "magnetometer axis reversed",
    "magnetometer axes exchanged",
    "magnetic disturbance",
    "samples lost",
)


def eased(share):
    """The way covered by a movement of minimum jerk after this share of its time."""
    share = np.clip(share, 0, 1)
    return share**3 * (10 - 15 * share + 6 * share**2)


def wander(random, steps, step, slowest):
    """Smooth noise of unit size, shape (steps, 3), that changes within about `slowest` seconds."""
    noise = gaussian_filter1d(random.normal(size=(steps, 3)), slowest / step, axis=0)
    return noise / noise.std()


def movement(random, step, brisk):
    """Times, orientations (body to world) and accelerations (m/s^2, in the world), in fine steps.

    A brisk movement also shakes the device.
    """
    laid, stops = random.random() < 2 / 3, random.integers(9, 15)
    start, starts = 0.0, []
    for stop in range(stops):
        rest = random.uniform(3, 5) if stop == 0 else random.uniform(1.2, 3.5)
        way = random.uniform(0.5, 0.9) if brisk else random.uniform(0.7, 1.6)
        starts.append((start + rest, way))
        start += rest + way
    times = np.arange(0, start + random.uniform(2, 4), step)
    pose, place = Rotation.random(rng=random), np.zeros(3)
    orientations = np.tile(pose.as_quat(), (len(times), 1))
    places, moving = np.zeros((len(times), 3)), np.zeros(len(times))
    for begin, way in starts:
        axis = random.normal(size=3)
        turn = axis / np.linalg.norm(axis) * np.radians(random.uniform(50, 170))
        reach = random.uniform(-0.3, 0.3, 3)
        if brisk:
            reach = 1.5 * reach
        after = times >= begin
        share = eased((times[after] - begin) / way)[:, None]
        orientations[after] = (pose * Rotation.from_rotvec(share * turn)).as_quat()
        places[after] = place + share * reach
        pose, place = pose * Rotation.from_rotvec(turn), place + reach
        moving += np.exp(-(((times - begin - way / 2) / way) ** 4))
    held = np.clip(moving, 0, 1)[:, None] if laid else np.ones((len(times), 1))
    held = held * np.clip((times - 2) / 0.5, 0, 1)[:, None]
    wobble = np.radians(1.5) * wander(random, len(times), step, 0.35)
    tremor = np.radians(0.08) * wander(random, len(times), step, 0.03)
    orientations = Rotation.from_quat(orientations) * Rotation.from_rotvec(held * (wobble + tremor))
    arm = random.normal(size=3)
    arm *= random.uniform(0.05, 0.4) / np.linalg.norm(arm)
    places = places + orientations.apply(arm) + held * 0.01 * wander(random, len(times), step, 0.3)
    if brisk:
        shaken = np.clip(moving, 0, 1)[:, None] * wander(random, len(times), step, 0.05)
        places = places + 0.03 * shaken
    accelerations = np.gradient(np.gradient(places, step, axis=0), step, axis=0)
    return times, orientations, gaussian_filter1d(accelerations, 0.004 / step, axis=0)


def crooked(random, scale, degrees):
    """A matrix near the identity: errors of scale and of alignment, shape (3, 3)."""
    return (
        np.eye(3)
        + np.diag(scale * random.normal(size=3))
        + (np.radians(degrees) * random.normal(size=(3, 3)) * (1 - np.eye(3)))
    )


def simulate(kind, seed):
    """A table as text, and what was planted: `kind` is one of KINDS, or None for an honest one."""
    random = np.random.default_rng([seed, *(kind or "honest").encode()])
    rate = random.choice(RATES)
    step = 1 / rate / FINE
    times, orientations, accelerations = movement(
        random, step, kind in ("gyroscope saturated", "accelerometer saturated")
    )
    dip, strength = np.radians(random.uniform(45, 72)), random.uniform(38, 58)
    north = random.uniform(0, 2 * np.pi)
    field = strength * np.array(
        [np.cos(dip) * np.cos(north), np.cos(dip) * np.sin(north), -np.sin(dip)]
    )
    fields = np.tile(field, (len(times), 1))
    axis, other = random.permutation(3)[:2]
    planted = {"axis": "xyz"[axis], "other": "xyz"[other]}
    if kind == "magnetic disturbance":
        begin = random.uniform(0.3, 0.6) * times[-1]
        edges = 1 / (1 + np.exp((np.abs(times - begin - 5) - 5) / 0.4))
        fields += (
            edges[:, None] * random.uniform(20, 45) * Rotation.random(rng=random).apply([1, 0, 0])
        )
    inverse = orientations.inv()
    rates = (inverse[:-1] * orientations[1:]).as_rotvec() / step
    true = {
        "gyroscope": np.degrees(np.vstack([rates, rates[-1]])),
        "accelerometer": inverse.apply(accelerations + [0, 0, GRAVITY]),
        "magnetometer": inverse.apply(fields),
    }
    late = {}
    if kind == "gyroscope late":
        late = {"gyroscope": random.uniform(0.04, 0.08)}
    if kind == "magnetometer late":
        late = {"magnetometer": random.uniform(0.15, 0.25)}
    # Each sample of a part with a digital filter is a mean over its interval.
    samples = np.arange(2 * FINE, len(times) - FINE, FINE)
    read = {}
    for name, values in true.items():
        behind = round(late.get(name, 0) / step)
        smooth = gaussian_filter1d(values, FINE / 2, axis=0)
        read[name] = smooth[np.maximum(samples - behind, 0)]
    clock = times[samples] - times[samples[0]]
    count = len(samples)

    read["gyroscope"] = read["gyroscope"] @ crooked(random, 0.004, 0.25).T
    read["accelerometer"] = read["accelerometer"] @ crooked(random, 0.003, 0.25).T
    read["magnetometer"] = read["magnetometer"] @ crooked(random, 0.01, 0.4).T
    drift = np.cumsum(random.normal(size=(count, 3)), axis=0) * 0.003 / np.sqrt(rate)
    planted["bias of the gyroscope"] = 0.12 * random.normal(size=3)
    planted["accelerometer"] = 0.05 * random.normal(size=3)
    read["gyroscope"] += planted["bias of the gyroscope"] + drift
    read["accelerometer"] += planted["accelerometer"]
    read["magnetometer"] += 0.5 * random.normal(size=3)
    warmth = 24 + random.uniform(8, 14) * (1 - np.exp(-clock / random.uniform(25, 50)))
    swap = np.arange(3)
    swap[[axis, other]] = swap[[other, axis]]

    sensor = (kind or "").split(" ")[0]
    if kind == "gyroscope offset":
        planted["size"] = random.choice([-1, 1]) * random.uniform(1.5, 6)
        read[sensor][:, axis] += planted["size"]
    elif kind == "gyroscope drifts":
        planted["size"] = random.choice([-1, 1]) * random.uniform(1.5, 4)
        read[sensor][:, axis] += planted["size"] * (clock / clock[-1]) ** random.uniform(0.7, 1.5)
    elif kind == "gyroscope drifts with temperature":
        planted["size"] = random.choice([-1, 1]) * random.uniform(0.15, 0.35)
        read[sensor][:, axis] += planted["size"] * (warmth - 25)
    elif kind == "gyroscope scale":
        # Two sensitivities of data sheets that are easily taken for each other.
        planted["size"] = random.choice([131 / 114.3, 114.3 / 131, 2, 0.5])
        read[sensor] *= planted["size"]
        planted["bias of the gyroscope"] *= planted["size"]  # as the file has it
    elif kind in ("gyroscope scale of an axis", "accelerometer scale of an axis"):
        planted["size"] = 1 + random.choice([-1, 1]) * random.uniform(0.06, 0.15)
        read[sensor][:, axis] *= planted["size"]
    elif kind == "accelerometer offset":
        planted["size"] = random.choice([-1, 1]) * random.uniform(0.5, 1.5)
        read[sensor][:, axis] += planted["size"]
    elif kind == "magnetometer hard iron":
        planted["size"] = random.uniform(12, 50)
        read[sensor] += planted["size"] * Rotation.random(rng=random).apply([1, 0, 0])
    elif kind == "magnetometer soft iron":
        turned = Rotation.random(rng=random).as_matrix()
        read[sensor] = read[sensor] @ turned.T @ np.diag([1.3, 1, 0.8]) @ turned
    elif kind and kind.endswith("axis reversed"):
        read[sensor][:, axis] *= -1
    elif kind and kind.endswith("axes exchanged"):
        read[sensor] = read[sensor][:, swap]

    noise = {
        "gyroscope": random.uniform(0.004, 0.012) * np.sqrt(rate),
        "accelerometer": random.uniform(100e-6, 250e-6) * GRAVITY * np.sqrt(rate),
        "magnetometer": random.uniform(0.2, 0.6),
    }
    full = {
        "gyroscope": 250.0 if kind == "gyroscope saturated" else 2000.0,
        "accelerometer": (2 if kind == "accelerometer saturated" else 8) * GRAVITY,
        "magnetometer": 4912.0,
    }
    for name, values in read.items():
        values = values + noise[name] * random.normal(size=values.shape)
        least = 0.15 if name == "magnetometer" else full[name] / 32768
        read[name] = np.clip(np.round(values / least), -32768, 32767) * least
    if kind == "gyroscope unit":
        read[sensor] = np.radians(read[sensor])
    if kind == "accelerometer unit":
        read[sensor] = read[sensor] / GRAVITY

    stamps = clock + random.uniform(0, 0.06) / rate * random.normal(size=count)
    if kind == "samples lost":
        here = np.ones(count, bool)
        for begin in random.uniform(0.1, 0.9, random.integers(10, 18)) * count:
            here[int(begin) : int(begin + random.uniform(0.08, 0.4) * rate)] = False
        read = {name: values[here] for name, values in read.items()}
        stamps, warmth, planted["size"] = np.arange(here.sum()) / rate, warmth[here], (~here).sum()
    headings = ["time [s]"]
    headings += [f"gyr_{name} [deg/s]" for name in "xyz"]
    headings += [f"acc_{name} [m/s^2]" for name in "xyz"]
    headings += [f"mag_{name} [uT]" for name in "xyz"]
    columns = [stamps, *(column for values in read.values() for column in values.T)]
    if kind == "gyroscope drifts with temperature":
        headings.append("temperature [degC]")
        columns.append(warmth)
    rows = [",".join(headings)]
    rows += [",".join(f"{value:.5f}" for value in row) for row in np.transpose(columns)]
    return "\n".join(rows) + "\n", planted
