"""The integration of a body that tumbles without torque, in three descriptions of its orientation."""

from functools import lru_cache

import numpy as np

from orientation.angular_velocity import angular_velocity_matrix, dcm_rate, quaternion_rate
from orientation.axis_angle import axis_angle_from_dcm
from orientation.direction_cosines import nearest_dcm
from orientation.euler_angles import dcm_from_body_fixed
from orientation.quaternions import dcm_from_quaternion

SPIN = 4.0  # rad/s
FINER = 10  # the reference takes so many steps for one
LARGEST = 1e6  # numbers beyond this end a run


# The results are kept: an unchanged figure draws the same run again and again.
@lru_cache(maxsize=8)
def run(moments, axis, disturbance, method, step, restored, count):
    """Return the arrays of so many steps, as :meth:`MotionFigure.run` gives them."""
    start = np.where([axis == other for other in "xyz"], SPIN, disturbance)
    rows = [(start, np.eye(3), np.eye(4)[0], np.zeros(3))]

    def rates(omega, matrix, quaternion, angles):
        return (
            np.array(_angular_acceleration(omega, moments)),
            dcm_rate(matrix, omega),
            quaternion_rate(quaternion, omega),
            np.linalg.solve(angular_velocity_matrix(angles, "zxy"), omega),
        )

    for _ in range(count):
        with np.errstate(all="ignore"):
            omega, matrix, quaternion, angles = _step(rates, rows[-1], step, method)
        largest = max(abs(omega).max(), abs(matrix).max(), abs(quaternion).max())
        if not largest < LARGEST or not np.isfinite(angles).all():
            break
        if restored:
            matrix, quaternion = nearest_dcm(matrix).dcm, quaternion / np.linalg.norm(quaternion)
        rows.append((omega, matrix, quaternion, angles))
    names = "angular_velocity", "matrix", "quaternion", "angles"
    return {
        "time": step * np.arange(len(rows)),
        "reference": _reference(start, moments, step / FINER, FINER * (len(rows) - 1))[::FINER],
        **{name: np.array(column) for name, column in zip(names, zip(*rows))},
    }


def _angular_acceleration(omega, moments):
    """Return the change of the angular velocity along the principal axes, without torque."""
    (x, y, z), (a, b, c) = omega, moments
    return -(y * (c * z) - z * (b * y)) / a, -(z * (a * x) - x * (c * z)) / b, -(x * (b * y) - y * (a * x)) / c


def _reference(start, moments, step, count):
    """Return the unit quaternions of so many Runge-Kutta steps from the identity, shape ``(count + 1, 4)``.

    The rate is linear in the quaternion: once the angular velocity is known, each step is a 4 by 4 matrix,
    and those of all steps are found together, which is ten times as fast as one after the other.
    """

    def beyond(length, slope):
        return [value + length * change for value, change in zip(omega, slope)]

    omega, stages = start.tolist(), []
    for _ in range(count):
        first = _angular_acceleration(omega, moments)
        second = _angular_acceleration(middle := beyond(step / 2, first), moments)
        third = _angular_acceleration(again := beyond(step / 2, second), moments)
        fourth = _angular_acceleration(end := beyond(step, third), moments)
        stages.append((omega, middle, again, end))
        omega = beyond(step / 6, [a + 2 * b + 2 * c + d for a, b, c, d in zip(first, second, third, fourth)])
    quaternions = [np.eye(4)[0]]
    if count:
        # The fixed quaternions 1, i, j, k, and in front of them an axis for the steps.
        units, (first, second, third, fourth) = np.eye(4), np.array(stages).transpose(1, 0, 2)[:, :, None]
        a = quaternion_rate(units, first)
        b = quaternion_rate(units + step / 2 * a, second)
        c = quaternion_rate(units + step / 2 * b, third)
        d = quaternion_rate(units + step * c, fourth)
        for matrix in units + step / 6 * (a + 2 * b + 2 * c + d):
            quaternion = quaternions[-1] @ matrix
            quaternions.append(quaternion / np.sqrt(quaternion @ quaternion))
    return np.array(quaternions)


def _step(rates, state, step, method):
    """Return the ``state``, a tuple of arrays, one step later."""

    def beyond(length, slopes):
        return tuple(value + length * slope for value, slope in zip(state, slopes))

    first = rates(*state)
    if method == "Euler":
        return beyond(step, first)
    second = rates(*beyond(step / 2, first))
    third = rates(*beyond(step / 2, second))
    fourth = rates(*beyond(step, third))
    return beyond(step / 6, [a + 2 * b + 2 * c + d for a, b, c, d in zip(first, second, third, fourth)])


# What the numbers of a run say.


def matrices(run, description, which):
    """Return the direction cosine matrices of a description; that of a quaternion is |q|^2 times orthogonal."""
    values = run[description][which]
    if description == "matrix":
        return values
    if description == "angles":
        return dcm_from_body_fixed(values, "zxy")
    lengths = np.linalg.norm(values, axis=-1, keepdims=True)
    return dcm_from_quaternion(values / lengths) * lengths[..., None] ** 2


def fault_of(dcms):
    """Return the largest entry by which each matrix times its transpose differs from the identity."""
    return abs(dcms @ dcms.swapaxes(-1, -2) - np.eye(3)).max(axis=(-2, -1))


def error_of(dcms, references):
    """Return the angle between the nearest valid orientation and the reference, in radians."""
    return axis_angle_from_dcm(nearest_dcm(dcms @ dcm_from_quaternion(references).swapaxes(-1, -2)).dcm)[1]


def momentum(run, moments):
    """Return the direction of the angular momentum along N."""
    # At the start A is N, and the components along both are the same.
    momentum = moments * run["angular_velocity"][0]
    return momentum / np.linalg.norm(momentum)


def flips(run, moments, axis):
    """Return how often the axis has turned over against the angular momentum."""
    row = dcm_from_quaternion(run["reference"])[:, "xyz".index(axis)]
    return int((np.diff(np.sign(row @ momentum(run, moments))) != 0).sum())
