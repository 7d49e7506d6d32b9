"""The torque-free integration of a tumbling body, in three descriptions of its orientation."""

from functools import lru_cache

import numpy as np

from orientation.angular_velocity import angular_velocity_matrix, dcm_rate, quaternion_rate
from orientation.axis_angle import axis_angle_from_dcm, quaternion_from_axis_angle
from orientation.direction_cosines import nearest_dcm
from orientation.euler_angles import dcm_from_body_fixed
from orientation.quaternions import dcm_from_quaternion, multiply_quaternions
from orientation.rotation_vector import dcm_from_rotation_vector

# In radians per second.
SPIN = 4.0
# Steps of the reference for each step of a description.
FINER = 10
# A run ends at numbers beyond this.
LARGEST = 1e4


# The points of a step at which the fourth-order exponential step evaluates the rate.
GAUSS = 0.5 - 3**0.5 / 6, 0.5 + 3**0.5 / 6


# Cache the results, because an unchanged figure draws the same run again and again.
@lru_cache(maxsize=8)
def run(moments, axis, disturbance, method, step, restored, count):
    """Return the arrays of so many steps, as in `MotionFigure.run`.

    The angular velocity is computed once, in steps ten times finer, and is the same for every
    description, so that they differ only by their own errors.
    """
    start = np.where([axis == letter for letter in "xyz"], SPIN, disturbance)
    omegas, reference = _reference(start, moments, step / FINER, FINER * count)
    rows = [(np.eye(3), np.eye(4)[0], np.zeros(3))]
    for k in range(count):
        with np.errstate(all="ignore"):
            matrix, quaternion, angles = _step(rows[-1], step, method, moments, omegas[FINER * k :])
        largest = max(abs(matrix).max(), abs(quaternion).max())
        if not largest < LARGEST or not np.isfinite(angles).all():
            break
        if restored:
            matrix, quaternion = nearest_dcm(matrix).dcm, quaternion / np.linalg.norm(quaternion)
        rows.append((matrix, quaternion, angles))
    names = "matrix", "quaternion", "angles"
    return {
        "time": step * np.arange(len(rows)),
        "angular_velocity": np.array(omegas[::FINER][: len(rows)]),
        "reference": reference[::FINER][: len(rows)],
        **{name: np.array(column) for name, column in zip(names, zip(*rows))},
    }


def angular_acceleration(omega, moments):
    """Return the torque-free angular acceleration along the principal axes."""
    (x, y, z), (a, b, c) = omega, moments
    return (
        -(y * (c * z) - z * (b * y)) / a,
        -(z * (a * x) - x * (c * z)) / b,
        -(x * (b * y) - y * (a * x)) / c,
    )


def _turned_on(omega, moments, step):
    """Return the angular velocities of one Runge-Kutta step: at its four stages, and at its end."""

    def beyond(length, slope):
        return [value + length * change for value, change in zip(omega, slope)]

    first = angular_acceleration(omega, moments)
    second = angular_acceleration(middle := beyond(step / 2, first), moments)
    third = angular_acceleration(again := beyond(step / 2, second), moments)
    fourth = angular_acceleration(end := beyond(step, third), moments)
    last = beyond(
        step / 6, [a + 2 * b + 2 * c + d for a, b, c, d in zip(first, second, third, fourth)]
    )
    return (omega, middle, again, end), last


def _reference(start, moments, step, count):
    """Return the angular velocities and unit quaternions of so many Runge-Kutta steps.

    The integration starts from the identity. The rate is linear in the quaternion: once the angular
    velocity is known, each step is a 4 by 4 matrix, and those of all steps are computed together,
    which is ten times as fast as one after the other.
    """
    omegas, stages = [start.tolist()], []
    for _ in range(count):
        stage, last = _turned_on(omegas[-1], moments, step)
        stages.append(stage)
        omegas.append(last)
    quaternions = [np.eye(4)[0]]
    if count:
        # The fixed quaternions 1, i, j, k, and in front of them an axis for the steps.
        units, (first, second, third, fourth) = (
            np.eye(4),
            np.array(stages).transpose(1, 0, 2)[:, :, None],
        )
        a = quaternion_rate(units, first)
        b = quaternion_rate(units + step / 2 * a, second)
        c = quaternion_rate(units + step / 2 * b, third)
        d = quaternion_rate(units + step * c, fourth)
        for matrix in units + step / 6 * (a + 2 * b + 2 * c + d):
            quaternion = quaternions[-1] @ matrix
            quaternions.append(quaternion / np.sqrt(quaternion @ quaternion))
    return omegas, np.array(quaternions)


def _rates(state, omega):
    matrix, quaternion, angles = state
    rates = np.linalg.solve(angular_velocity_matrix(angles, "zxy"), omega)
    return dcm_rate(matrix, omega), quaternion_rate(quaternion, omega), rates


def _step(state, step, method, moments, omegas):
    """Return matrix, quaternion and angles one step later.

    ``omegas`` are those of the finer steps from here.
    """

    def beyond(length, slopes):
        return tuple(value + length * slope for value, slope in zip(state, slopes))

    first = _rates(state, omegas[0])
    if method == "Euler":
        return beyond(step, first)
    second = _rates(beyond(step / 2, first), omegas[FINER // 2])
    third = _rates(beyond(step / 2, second), omegas[FINER // 2])
    fourth = _rates(beyond(step, third), omegas[FINER])
    matrix, quaternion, angles = beyond(
        step / 6, [a + 2 * b + 2 * c + d for a, b, c, d in zip(first, second, third, fourth)]
    )
    # Euler angles have no such step.
    if method == "exponential":
        turn = _turn(step, moments, omegas)
        matrix = dcm_from_rotation_vector(turn) @ state[0]
        quaternion = multiply_quaternions(
            state[1],
            quaternion_from_axis_angle(turn, np.sqrt(turn @ turn)) if turn.any() else np.eye(4)[0],
        )
    return matrix, quaternion, angles


def _turn(step, moments, omegas):
    """Return the rotation vector of a step of the fourth order (Magnus)."""
    at_first, at_second = (
        np.array(
            _turned_on(
                omegas[int(FINER * point)], moments, step * (point - int(FINER * point) / FINER)
            )[1]
        )
        for point in GAUSS
    )
    return step / 2 * (at_first + at_second) + 3**0.5 / 12 * step**2 * np.cross(at_first, at_second)


# Functions of the numbers of a run.


def matrices(run, description, which):
    """Return the direction cosine matrices of a description.

    That of a quaternion is orthogonal up to the factor |q|^2.
    """
    values = run[description][which]
    if description == "matrix":
        return values
    if description == "angles":
        return dcm_from_body_fixed(values, "zxy")
    lengths = np.linalg.norm(values, axis=-1, keepdims=True)
    return dcm_from_quaternion(values / lengths) * lengths[..., None] ** 2


def fault_of(dcms):
    """Return the largest entry of each matrix times its transpose, minus the identity."""
    return abs(dcms @ dcms.swapaxes(-1, -2) - np.eye(3)).max(axis=(-2, -1))


def error_of(dcms, references):
    """Return the angle between the nearest valid orientation and the reference, in radians."""
    return axis_angle_from_dcm(
        nearest_dcm(dcms @ dcm_from_quaternion(references).swapaxes(-1, -2)).dcm
    )[1]


def momentum(run, moments):
    """Return the direction of the angular momentum along N."""
    # At the start A is N, and the components along both are the same.
    momentum = moments * run["angular_velocity"][0]
    return momentum / np.linalg.norm(momentum)


def flips(run, moments, axis):
    """Return how often the axis has flipped with respect to the angular momentum."""
    row = dcm_from_quaternion(run["reference"])[:, "xyz".index(axis)]
    return int((np.diff(np.sign(row @ momentum(run, moments))) != 0).sum())
