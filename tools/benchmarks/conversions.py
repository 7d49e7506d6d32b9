"""Compare conversions of numbers with nine other libraries, and the errors of all of them.

Each library gets the same orientations as arrays in its own form, made beforehand, and is called in
the fastest way that it documents, without checks of its input where they can be omitted. At N = 1
one item is converted, with the function for one item if there is one. Errors are the largest
differences from our formulas in extended precision, in units of the last place of 1. Libraries that
are not installed are left out: ``peers.txt`` lists them.
"""

import math
from contextlib import suppress
from importlib import import_module
from types import SimpleNamespace

import numpy as np

import orientation
from orientation.numbers_and_symbols import Variable, array_functions

from .timing import seconds_per_call

#: Sizes, and the number of rounds for each.
SIZES = {1: 25, 10: 25, 100: 25, 1000: 15, 10_000: 9, 1_000_000: 3}
PEERS = {
    "SciPy": ("scipy.spatial.transform",),
    "numpy-quaternion": ("quaternion",),
    "quaternionic": ("quaternionic",),
    "rowan": ("rowan",),
    "pytransform3d": ("pytransform3d.rotations", "pytransform3d.batch_rotations"),
    "transforms3d": ("transforms3d",),
    "spatialmath": ("spatialmath.base",),
    "ahrs": ("ahrs",),
    "pyquaternion": ("pyquaternion",),
}


class _Exact(Variable):
    """Numbers that a conversion computes with in extended precision."""

    def __init__(self, value):
        self.value = value

    def slopes_of(self, formula, shape, arguments, guard):
        components = []
        for _, value, item in arguments:
            components += list(
                np.asarray(value.value, np.longdouble).reshape(-1, math.prod(item)).T
            )
        columns = np.broadcast_arrays(*formula(array_functions(), *components))
        return np.stack(columns, axis=-1).reshape(-1, *shape)


def rows():
    """Yield ``(task, N, seconds by contestant, errors by contestant)``."""
    for size, rounds in SIZES.items():
        for task, (convert, arguments, contestants) in _conversions(size).items():
            functions, errors = {"orientation": lambda: convert(*arguments)}, {}
            exact = convert(*map(_Exact, arguments))
            for name, call in {"orientation": functions["orientation"], **contestants}.items():
                # Leave out a library that is not installed or lacks the function.
                with suppress(AttributeError):
                    errors[name] = _error(call(), exact, task, name)
                    functions[name] = call
            yield task, size, seconds_per_call(functions, rounds), errors


def limits():
    """Yield ``(task, seconds for a million items)``, a lower limit for any such library."""
    quaternions, angles = np.ones((1_000_000, 4)), np.linspace(0, 3, 1_000_000)
    for task, function in {
        "reading a quaternion and writing a matrix": lambda: np.repeat(quaternions, 3, axis=1),
        "sine and cosine of one angle, by NumPy": lambda: (np.sin(angles), np.cos(angles)),
    }.items():
        yield task, seconds_per_call({"": function}, 3)[""]


def _error(result, exact, task, name):
    result = np.asarray(getattr(result, "ndarray", result))
    if result.dtype.kind == "V":  # of numpy-quaternion
        result = np.atleast_1d(result).view(float)
    result = result.reshape(exact.shape)
    if task.endswith("to matrix") and name != "orientation":
        result = result.swapaxes(-1, -2)
    if task.endswith(("quaternion", "quaternions")):
        result = np.roll(result, 1, axis=-1) if name == "SciPy" else result
        result = result * np.sign((result * exact).sum(axis=-1, keepdims=True))
    if task.endswith("to rotation vector"):
        # The rotation in the opposite direction is the same orientation.
        length = np.linalg.norm(result, axis=-1, keepdims=True)
        result = np.where(length > np.pi, result * (1 - 2 * np.pi / length), result)
    error = float(abs(result - exact).max() / np.finfo(float).eps)
    if error > 1e9:
        raise AssertionError(f"{task}: {name} does not return what orientation returns")
    return error


def _peers():
    for modules in PEERS.values():
        attributes = {}
        with suppress(ImportError):
            for module in modules:
                attributes |= vars(import_module(module))
        yield SimpleNamespace(**attributes)


def _conversions(size):
    single_item = size == 1
    angles = np.random.default_rng(1).uniform(-1.5, 1.5, 3 if single_item else (size, 3))
    dcm = orientation.dcm_from_body_fixed(angles, "zxy")
    matrix = np.ascontiguousarray(dcm.swapaxes(-1, -2))
    axis, angle = orientation.axis_angle_from_dcm(dcm)
    vector = axis * np.expand_dims(angle, -1)
    both = np.concatenate([axis, np.expand_dims(angle, -1)], axis=-1)
    quaternion = orientation.quaternion_from_dcm(dcm)
    second = np.roll(quaternion, 1, axis=-1)
    last, second_last = np.roll(quaternion, -1, axis=-1), np.roll(second, -1, axis=-1)
    scipy, numpy_q, quaternionic, rowan, pt3d, transforms3d, sm, ahrs, pyq = _peers()
    native, other_native, ours, others = (
        getattr(library, function, np.asarray)(value)
        for library, function in ((numpy_q, "as_quat_array"), (quaternionic, "array"))
        for value in (quaternion, second)
    )
    # A function for one item only raises AttributeError for more, as a missing one does.
    single = SimpleNamespace(transforms3d=transforms3d, sm=sm, pyq=pyq) if single_item else None
    return {
        "Euler angles zxy to matrix": (
            lambda angles: orientation.dcm_from_body_fixed(angles, "zxy"),
            (angles,),
            {
                "SciPy": lambda: scipy.Rotation.from_euler("ZXY", angles).as_matrix(),
                "rowan": lambda: rowan.to_matrix(
                    rowan.from_euler(*angles.T, "zxy", "intrinsic"), require_unit=False
                ),
                "pytransform3d": lambda: (
                    pt3d.active_matrix_from_intrinsic_euler_zxy(angles)
                    if single_item
                    else pt3d.active_matrices_from_intrinsic_euler_angles(2, 0, 1, angles)
                ),
                "transforms3d": lambda: single.transforms3d.euler.euler2mat(*angles, "rzxy"),
            },
        ),
        "matrix to Euler angles zxy": (
            lambda dcm: orientation.body_fixed_from_dcm(dcm, "zxy"),
            (dcm,),
            {
                "SciPy": lambda: scipy.Rotation.from_matrix(matrix, assume_valid=True).as_euler(
                    "ZXY"
                ),
                "transforms3d": lambda: single.transforms3d.euler.mat2euler(matrix, "rzxy"),
            },
        ),
        "axis and angle to matrix": (
            orientation.dcm_from_axis_angle,
            (axis, angle),
            {
                "SciPy": lambda: scipy.Rotation.from_rotvec(
                    axis * np.expand_dims(angle, -1)
                ).as_matrix(),
                "numpy-quaternion": lambda: numpy_q.as_rotation_matrix(
                    numpy_q.from_rotation_vector(axis * np.expand_dims(angle, -1))
                ),
                "rowan": lambda: rowan.to_matrix(
                    rowan.from_axis_angle(axis, angle), require_unit=False
                ),
                "pytransform3d": lambda: (
                    pt3d.matrix_from_axis_angle(both)
                    if single_item
                    else pt3d.matrices_from_compact_axis_angles(axes=axis, angles=angle)
                ),
                "transforms3d": lambda: single.transforms3d.axangles.axangle2mat(
                    axis, angle, is_normalized=True
                ),
                "spatialmath": lambda: single.sm.angvec2r(angle, axis),
                "pyquaternion": lambda: (
                    single.pyq.Quaternion(axis=axis, angle=angle).rotation_matrix
                ),
            },
        ),
        "rotation vector to matrix": (
            orientation.dcm_from_rotation_vector,
            (vector,),
            {
                "SciPy": lambda: scipy.Rotation.from_rotvec(vector).as_matrix(),
                "numpy-quaternion": lambda: numpy_q.as_rotation_matrix(
                    numpy_q.from_rotation_vector(vector)
                ),
                "quaternionic": lambda: (
                    quaternionic.array.from_rotation_vector(vector).to_rotation_matrix
                ),
                "pytransform3d": lambda: (
                    pt3d.matrix_from_compact_axis_angle(vector)
                    if single_item
                    else pt3d.matrices_from_compact_axis_angles(vector)
                ),
            },
        ),
        "matrix to rotation vector": (
            orientation.rotation_vector_from_dcm,
            (dcm,),
            {
                "SciPy": lambda: scipy.Rotation.from_matrix(matrix, assume_valid=True).as_rotvec(),
                "numpy-quaternion": lambda: numpy_q.as_rotation_vector(
                    numpy_q.from_rotation_matrix(matrix, nonorthogonal=False)
                ),
                "pytransform3d": lambda: (
                    pt3d.compact_axis_angle_from_matrix(matrix, check=False)
                    if single_item
                    else pt3d.missing
                ),
            },
        ),
        "quaternion to matrix": (
            orientation.dcm_from_quaternion,
            (quaternion,),
            {
                "SciPy": lambda: scipy.Rotation.from_quat(last).as_matrix(),
                "numpy-quaternion": lambda: numpy_q.as_rotation_matrix(native),
                "quaternionic": lambda: ours.to_rotation_matrix,
                "rowan": lambda: rowan.to_matrix(quaternion, require_unit=False),
                "pytransform3d": lambda: (
                    pt3d.matrix_from_quaternion(quaternion)
                    if single_item
                    else pt3d.matrices_from_quaternions(quaternion, normalize_quaternions=False)
                ),
                "transforms3d": lambda: single.transforms3d.quaternions.quat2mat(quaternion),
                "spatialmath": lambda: single.sm.q2r(quaternion),
                "ahrs": lambda: ahrs.QuaternionArray(np.atleast_2d(quaternion)).to_DCM(),
                "pyquaternion": lambda: single.pyq.Quaternion(quaternion).rotation_matrix,
            },
        ),
        "matrix to quaternion": (
            orientation.quaternion_from_dcm,
            (dcm,),
            {
                "SciPy": lambda: scipy.Rotation.from_matrix(matrix, assume_valid=True).as_quat(),
                "numpy-quaternion": lambda: numpy_q.from_rotation_matrix(
                    matrix, nonorthogonal=False
                ),
                "quaternionic": lambda: quaternionic.array.from_rotation_matrix(
                    matrix, nonorthogonal=False
                ),
                "rowan": lambda: rowan.from_matrix(matrix, require_orthogonal=False),
                "pytransform3d": lambda: (
                    pt3d.quaternion_from_matrix(matrix)
                    if single_item
                    else pt3d.quaternions_from_matrices(matrix)
                ),
                "transforms3d": lambda: single.transforms3d.quaternions.mat2quat(matrix),
                "spatialmath": lambda: single.sm.r2q(matrix),
                "pyquaternion": lambda: single.pyq.Quaternion(matrix=matrix).elements,
            },
        ),
        "product of quaternions": (
            orientation.multiply_quaternions,
            (quaternion, second),
            {
                "SciPy": lambda: (
                    scipy.Rotation.from_quat(last) * scipy.Rotation.from_quat(second_last)
                ).as_quat(),
                "numpy-quaternion": lambda: numpy_q.quaternion and native * other_native,
                "quaternionic": lambda: quaternionic.array and ours * others,
                "rowan": lambda: rowan.multiply(quaternion, second),
                "pytransform3d": lambda: (
                    pt3d.concatenate_quaternions(quaternion, second)
                    if single_item
                    else pt3d.batch_concatenate_quaternions(quaternion, second)
                ),
                "transforms3d": lambda: single.transforms3d.quaternions.qmult(quaternion, second),
                "spatialmath": lambda: single.sm.qqmul(quaternion, second),
                "pyquaternion": lambda: (
                    (single.pyq.Quaternion(quaternion) * single.pyq.Quaternion(second)).elements
                ),
            },
        ),
    }
