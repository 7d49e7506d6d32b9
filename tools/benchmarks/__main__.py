"""Compare the speed of conversions with nine other libraries: ``python -m tools.benchmarks``.

Each library gets the same orientations as arrays in its own form, made beforehand, and is called in
the fastest way that it documents, without checks of its input where they can be omitted. At N = 1
one item is converted, with the function for one item if there is one. Libraries that are not
installed are left out: ``peers.txt`` lists them. The contestants alternate, and the shortest
processor time of each counts.
"""

import time
import timeit
from contextlib import suppress
from importlib import import_module
from types import SimpleNamespace

import numpy as np

import orientation

SIZES = (1, 1000, 1_000_000)
ROUNDS = 5
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


def main():
    print("The time that orientation takes, as a multiple of that of each library.\n")
    print(f"| conversion | N | {' | '.join(PEERS)} |")
    print(f"|---|---|{'---|' * len(PEERS)}")
    for size in SIZES:
        for task, contestants in conversions(size).items():
            seconds = seconds_per_call(contestants)
            ratios = [
                f"{seconds['orientation'] / seconds[name]:.2g}" if name in seconds else ""
                for name in PEERS
            ]
            print(f"| {task} | {size:,} | {' | '.join(ratios)} |", flush=True)


def seconds_per_call(contestants):
    """Return the least processor time of one call of each function that its library has."""
    timers = {}
    for name, call in contestants.items():
        # A library that is not installed, or lacks the function, raises AttributeError.
        with suppress(AttributeError):
            call()
            timers[name] = timeit.Timer(call, timer=time.process_time)
    counts = {name: timer.autorange()[0] for name, timer in timers.items()}
    rounds = [
        {name: timer.timeit(counts[name]) / counts[name] for name, timer in timers.items()}
        for _ in range(ROUNDS)
    ]
    return {name: min(times[name] for times in rounds) for name in timers}


def peers():
    for modules in PEERS.values():
        attributes = {}
        with suppress(ImportError):
            for module in modules:
                attributes |= vars(import_module(module))
        yield SimpleNamespace(**attributes)


def conversions(size):
    """Return what each library does for each conversion of this many items."""
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
    scipy, numpy_q, quaternionic, rowan, pt3d, transforms3d, sm, ahrs, pyq = peers()
    native, other_native, ours, others = (
        getattr(library, function, np.asarray)(value)
        for library, function in ((numpy_q, "as_quat_array"), (quaternionic, "array"))
        for value in (quaternion, second)
    )
    # A function for one item only is treated as missing if there are more.
    single = SimpleNamespace(transforms3d=transforms3d, sm=sm, pyq=pyq) if single_item else None
    return {
        "Euler angles zxy to matrix": {
            "orientation": lambda: orientation.dcm_from_body_fixed(angles, "zxy"),
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
        "matrix to Euler angles zxy": {
            "orientation": lambda: orientation.body_fixed_from_dcm(dcm, "zxy"),
            "SciPy": lambda: scipy.Rotation.from_matrix(matrix, assume_valid=True).as_euler("ZXY"),
            "transforms3d": lambda: single.transforms3d.euler.mat2euler(matrix, "rzxy"),
        },
        "axis and angle to matrix": {
            "orientation": lambda: orientation.dcm_from_axis_angle(axis, angle),
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
            "pyquaternion": lambda: single.pyq.Quaternion(axis=axis, angle=angle).rotation_matrix,
        },
        "rotation vector to matrix": {
            "orientation": lambda: orientation.dcm_from_rotation_vector(vector),
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
        "matrix to rotation vector": {
            "orientation": lambda: orientation.rotation_vector_from_dcm(dcm),
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
        "quaternion to matrix": {
            "orientation": lambda: orientation.dcm_from_quaternion(quaternion),
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
        "matrix to quaternion": {
            "orientation": lambda: orientation.quaternion_from_dcm(dcm),
            "SciPy": lambda: scipy.Rotation.from_matrix(matrix, assume_valid=True).as_quat(),
            "numpy-quaternion": lambda: numpy_q.from_rotation_matrix(matrix, nonorthogonal=False),
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
        "product of quaternions": {
            "orientation": lambda: orientation.multiply_quaternions(quaternion, second),
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
    }


if __name__ == "__main__":
    main()
