"""Recordings of real instruments: five small boxes with gyroscopes, in hands and on a walking leg.

The files in ``data/`` are excerpts from the recordings that come with *scikit-kinematics* 0.10.4 by
Thomas Haslwanter (BSD licence; its text is in ``data/LICENSE.txt``): the x-IMU's packets 115 to
6354 (of its matrices one second, 2845 to 3234), the rows 37328 to 39007 of the leg, all rows of the
others, without the columns that the book does not use. Every digit is the instrument's. The
functions here return them with times in seconds, angular velocities in radians per second and
specific forces in multiples of standard gravity; quaternions and angles stay as they were printed.

The directions of bright stars, as measured by the satellite Hipparcos (ESA 1997), are from the
table that comes with *PyEphem* 4.2.1 by Brandon Rhodes (MIT licence; its text is in
``data/LICENSE-stars.txt``), with each star once, under its official name.
"""

from __future__ import annotations

from importlib import resources
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

Array: TypeAlias = "NDArray[np.float64]"

#: Metres per second squared.
STANDARD_GRAVITY = 9.80665
#: Samples per second. For the x-IMU, this follows from the value 9 of its register
#: ``InertialAndMagneticDataRate``, which means 256.
X_IMU_RATE, XSENS_RATE, WALKING_RATE = 256, 50, 120


class Recording(NamedTuple):
    """The measurements of one instrument, with the orientation that it computed itself.

    Attributes
    ----------
    time : array of shape ``(n,)``
        Seconds since the first sample.
    angular_velocity : array of shape ``(n, 3)``
        Of the instrument, along its own axes, in radians per second.
    specific_force : array of shape ``(n, 3)``
        The accelerometer's measurement, along its own axes, in multiples of standard gravity; at
        rest it points up.
    magnetic_field : array of shape ``(n, 3)`` or ``None``
        Along the instrument's axes, in the unit of its output.
    quaternion_time : array of shape ``(m,)``
        Seconds.
    quaternion : array of shape ``(m, 4)``
        The instrument's output, divided by its length; empty if it has none.
    """

    time: Array
    angular_velocity: Array
    specific_force: Array
    magnetic_field: Array | None
    quaternion_time: Array
    quaternion: Array


def table(name: str) -> Array:
    """Return the rows of a file in ``data/`` as an array, without the line of column names."""
    with resources.files(__package__).joinpath("data", f"{name}.csv").open(encoding="utf8") as file:
        return np.loadtxt(file, delimiter=",", skiprows=1)


def x_imu() -> Recording:
    """Return sixteen seconds of an x-IMU in a hand: held, carried about, held again.

    It recorded on its memory card.

    Returns
    -------
    Recording
        256 samples a second; the magnetic field in gauss.
    """
    sensors, quaternion = table("x_imu_sensors"), table("x_imu_quaternion")
    time = np.arange(len(sensors)) / X_IMU_RATE
    return Recording(
        time,
        np.radians(sensors[:, 1:4]),
        sensors[:, 4:7],
        sensors[:, 7:10],
        x_imu_time(quaternion[:, 0]),
        _unit(quaternion[:, 1:]),
    )


def x_imu_time(packets: Array) -> Array:
    """Return the times of packets of the x-IMU: each is that of the last sensor sample before it.

    Parameters
    ----------
    packets : array of shape ``(n,)``
        Packet numbers.

    Returns
    -------
    array of shape ``(n,)``
        Seconds.
    """
    return (np.searchsorted(table("x_imu_sensors")[:, 0], packets) - 1) / X_IMU_RATE


def x_imu_euler_angles() -> Array:
    """Return the angles that the x-IMU printed beside each of its quaternions.

    Returns
    -------
    array of shape ``(m, 3)``
        Its columns *Roll*, *Pitch* and *Yaw*, in degrees.
    """
    return table("x_imu_euler_angles")[:, 1:]


def x_imu_rotation_matrix() -> tuple[Array, Array]:
    """Return one second of the nine numbers that the x-IMU printed as its rotation matrix.

    Returns
    -------
    tuple of arrays of shape ``(k,)`` and ``(k, 3, 3)``
        Times in seconds, and matrices, row by row as printed.
    """
    rows = table("x_imu_rotation_matrix")
    return x_imu_time(rows[:, 0]), rows[:, 1:].reshape(-1, 3, 3)


def x_imu3() -> Recording:
    """Return ten seconds of an x-IMU3, a later instrument by the same maker, rotated fast by hand.

    Returns
    -------
    Recording
        50 samples a second, without the magnetic field.
    """
    sensors, quaternion = table("x_imu3_sensors"), table("x_imu3_quaternion")
    start = sensors[0, 0]
    return Recording(
        (sensors[:, 0] - start) / 1e6,
        np.radians(sensors[:, 1:4]),
        sensors[:, 4:7],
        None,
        (quaternion[:, 0] - start) / 1e6,
        _unit(quaternion[:, 1:]),
    )


def ngimu() -> Recording:
    """Return ten seconds of an NGIMU, rotated by hand.

    Returns
    -------
    Recording
        50 samples a second; the magnetic field in microtesla.
    """
    sensors, quaternion = table("ngimu_sensors"), table("ngimu_quaternion")
    return Recording(
        sensors[:, 0],
        np.radians(sensors[:, 1:4]),
        sensors[:, 4:7],
        sensors[:, 7:10],
        quaternion[:, 0],
        _unit(quaternion[:, 1:]),
    )


def xsens() -> Recording:
    """Return nineteen seconds of an Xsens instrument.

    Returns
    -------
    Recording
        50 samples a second; the magnetic field in the manufacturer's unit, about 1 for the Earth's.
    """
    rows = table("xsens")
    time = np.arange(len(rows)) / XSENS_RATE
    return Recording(
        time,
        rows[:, 4:7],
        rows[:, 1:4] / STANDARD_GRAVITY,
        rows[:, 7:10],
        time,
        _unit(rows[:, 10:14]),
    )


def walking_leg() -> tuple[Recording, Recording]:
    """Return fourteen seconds of two instruments on a leg: two of standing still, then walking.

    Returns
    -------
    tuple of two `Recording`
        Thigh and shank, 120 samples a second at the same times, without quaternions.
    """
    return _of_the_leg("upper_leg"), _of_the_leg("lower_leg")


def _of_the_leg(name: str) -> Recording:
    rows = table(name)
    time = np.arange(len(rows)) / WALKING_RATE
    force = rows[:, 1:4] / STANDARD_GRAVITY
    return Recording(time, rows[:, 4:7], force, None, np.empty(0), np.empty((0, 4)))


def bright_stars() -> tuple[list[str], Array, Array]:
    """Return the directions of bright stars at the beginning of the year 2000.

    Returns
    -------
    tuple of a list of str, an array of shape ``(n, 3)`` and an array of shape ``(n,)``
        Names; unit vectors along the equatorial frame $N$, $\\hat{n}_z$ to the celestial pole and
        $\\hat{n}_x$ to the vernal equinox (International Celestial Reference System); magnitudes,
        smaller ones for brighter stars.

    Examples
    --------
    >>> from orientation_recordings import bright_stars
    >>> names, directions, magnitudes = bright_stars()
    >>> directions[names.index('Polaris')].round(2).tolist()
    [0.01, 0.01, 1.0]
    """
    with (
        resources.files(__package__)
        .joinpath("data", "bright_stars.csv")
        .open(encoding="utf8") as file
    ):
        rows = [line.split(",") for line in file.read().splitlines()[1:]]
    hours, degrees, magnitudes = np.array([row[1:] for row in rows], dtype=float).T
    ascension, declination = np.radians(15 * hours), np.radians(degrees)
    level = np.cos(declination)
    directions = np.stack(
        [level * np.cos(ascension), level * np.sin(ascension), np.sin(declination)], axis=-1
    )
    return [row[0] for row in rows], directions, magnitudes


def _unit(quaternions: Array) -> Array:
    unit: Array = quaternions / np.linalg.norm(quaternions, axis=-1, keepdims=True)
    return unit
