"""Conversions of numbers, against SciPy and pytransform3d.

Each library is given the same orientations as float arrays in the form that it documents, and must
return the same ones in that form, which is checked before anything is timed. So matrices are
transposed for SciPy and pytransform3d beforehand, outside of the time. SciPy always goes through a
``Rotation``; it has no axis with an angle, so a rotation vector is made of the two, and split
again, within the time. At N = 1 one item is converted by one call, with the functions for one item.
Where pytransform3d has no function for batches there is no time.
"""

import numpy as np
import pytransform3d.batch_rotations as batch
import pytransform3d.rotations as single
from scipy.spatial.transform import Rotation

import orientation

from .timing import seconds_per_call

SIZES = {1: 25, 1000: 15, 1_000_000: 5}  # and how many rounds


def rows():
    """Yield ``(what, N, seconds by contestant)``."""
    for size, rounds in SIZES.items():
        for what, contestants in _conversions(size).items():
            _demand_same_results(what, contestants)
            functions = {name: pair and pair[0] for name, pair in contestants.items()}
            yield what, size, seconds_per_call(functions, rounds)


def _demand_same_results(what, contestants):
    results = {}
    for name, pair in contestants.items():
        if pair:
            function, dcm_of = pair
            results[name] = dcm_of(function())
            if abs(results[name] - results["orientation"]).max() > 1e-6:
                raise AssertionError(f"{what}: {name} does not return what orientation returns")


def _conversions(size):
    source = np.random.default_rng(1)
    angles = source.uniform(-1.5, 1.5, (size, 3))
    axis = source.normal(size=(size, 3))
    axis /= np.linalg.norm(axis, axis=1, keepdims=True)
    angle = source.uniform(0.1, 3, size)
    if size == 1:
        angles, axis, angle = angles[0], axis[0], float(angle[0])
    vector = axis * np.expand_dims(angle, -1)
    both = np.concatenate([axis, np.expand_dims(angle, -1)], axis=-1)
    quaternion = orientation.quaternion_from_axis_angle(axis, angle)
    other = orientation.quaternion_from_axis_angle(np.roll(axis, 1, axis=-1), angle)
    dcm = orientation.dcm_from_axis_angle(axis, angle)
    matrix = np.ascontiguousarray(dcm.swapaxes(-1, -2))
    one = size == 1

    def itself(result):
        return result

    def transposed(result):
        return result.swapaxes(-1, -2)

    def from_angles(result):
        return orientation.dcm_from_body_fixed(result, "zxy")

    def from_pair(result):
        return orientation.dcm_from_axis_angle(*result)

    def from_both(result):
        return orientation.dcm_from_axis_angle(result[..., :3], result[..., 3])

    def split(rotation_vector):
        length = np.linalg.norm(rotation_vector, axis=-1)
        return rotation_vector / np.expand_dims(length, -1), length

    return {
        "Euler angles zxy to matrix": {
            "orientation": (lambda: orientation.dcm_from_body_fixed(angles, "zxy"), itself),
            "SciPy": (lambda: Rotation.from_euler("ZXY", angles).as_matrix(), transposed),
            "pytransform3d": (
                (lambda: single.active_matrix_from_intrinsic_euler_zxy(angles), transposed)
                if one
                else (
                    lambda: batch.active_matrices_from_intrinsic_euler_angles(2, 0, 1, angles),
                    transposed,
                )
            ),
        },
        "matrix to Euler angles zxy": {
            "orientation": (lambda: orientation.body_fixed_from_dcm(dcm, "zxy"), from_angles),
            "SciPy": (lambda: Rotation.from_matrix(matrix).as_euler("ZXY"), from_angles),
            "pytransform3d": (
                (lambda: single.intrinsic_euler_zxy_from_active_matrix(matrix), from_angles)
                if one
                else None
            ),
        },
        "axis and angle to matrix": {
            "orientation": (lambda: orientation.dcm_from_axis_angle(axis, angle), itself),
            "SciPy": (
                lambda: Rotation.from_rotvec(axis * np.expand_dims(angle, -1)).as_matrix(),
                transposed,
            ),
            "pytransform3d": (
                (lambda: single.matrix_from_axis_angle(both), transposed)
                if one
                else (
                    lambda: batch.matrices_from_compact_axis_angles(axes=axis, angles=angle),
                    transposed,
                )
            ),
        },
        "matrix to axis and angle": {
            "orientation": (lambda: orientation.axis_angle_from_dcm(dcm), from_pair),
            "SciPy": (lambda: split(Rotation.from_matrix(matrix).as_rotvec()), from_pair),
            "pytransform3d": (
                (lambda: single.axis_angle_from_matrix(matrix), from_both)
                if one
                else (lambda: batch.axis_angles_from_matrices(matrix), from_both)
            ),
        },
        "rotation vector to matrix": {
            "orientation": (lambda: orientation.dcm_from_rotation_vector(vector), itself),
            "SciPy": (lambda: Rotation.from_rotvec(vector).as_matrix(), transposed),
            "pytransform3d": (
                (lambda: single.matrix_from_compact_axis_angle(vector), transposed)
                if one
                else (lambda: batch.matrices_from_compact_axis_angles(vector), transposed)
            ),
        },
        "matrix to rotation vector": {
            "orientation": (
                lambda: orientation.rotation_vector_from_dcm(dcm),
                orientation.dcm_from_rotation_vector,
            ),
            "SciPy": (
                lambda: Rotation.from_matrix(matrix).as_rotvec(),
                orientation.dcm_from_rotation_vector,
            ),
            "pytransform3d": (
                (
                    lambda: single.compact_axis_angle_from_matrix(matrix),
                    orientation.dcm_from_rotation_vector,
                )
                if one
                else None
            ),
        },
        "quaternion to matrix": {
            "orientation": (lambda: orientation.dcm_from_quaternion(quaternion), itself),
            "SciPy": (
                lambda: Rotation.from_quat(quaternion, scalar_first=True).as_matrix(),
                transposed,
            ),
            "pytransform3d": (
                (lambda: single.matrix_from_quaternion(quaternion), transposed)
                if one
                else (lambda: batch.matrices_from_quaternions(quaternion), transposed)
            ),
        },
        "matrix to quaternion": {
            "orientation": (
                lambda: orientation.quaternion_from_dcm(dcm),
                orientation.dcm_from_quaternion,
            ),
            "SciPy": (
                lambda: Rotation.from_matrix(matrix).as_quat(scalar_first=True),
                orientation.dcm_from_quaternion,
            ),
            "pytransform3d": (
                (lambda: single.quaternion_from_matrix(matrix), orientation.dcm_from_quaternion)
                if one
                else (
                    lambda: batch.quaternions_from_matrices(matrix),
                    orientation.dcm_from_quaternion,
                )
            ),
        },
        "axis and angle to quaternion": {
            "orientation": (
                lambda: orientation.quaternion_from_axis_angle(axis, angle),
                orientation.dcm_from_quaternion,
            ),
            "SciPy": (
                lambda: Rotation.from_rotvec(axis * np.expand_dims(angle, -1)).as_quat(
                    scalar_first=True
                ),
                orientation.dcm_from_quaternion,
            ),
            "pytransform3d": (
                (lambda: single.quaternion_from_axis_angle(both), orientation.dcm_from_quaternion)
                if one
                else None
            ),
        },
        "product of quaternions": {
            "orientation": (
                lambda: orientation.multiply_quaternions(quaternion, other),
                orientation.dcm_from_quaternion,
            ),
            "SciPy": (
                lambda: (
                    Rotation.from_quat(quaternion, scalar_first=True)
                    * Rotation.from_quat(other, scalar_first=True)
                ).as_quat(scalar_first=True),
                orientation.dcm_from_quaternion,
            ),
            "pytransform3d": (
                (
                    lambda: single.concatenate_quaternions(quaternion, other),
                    orientation.dcm_from_quaternion,
                )
                if one
                else (
                    lambda: batch.batch_concatenate_quaternions(quaternion, other),
                    orientation.dcm_from_quaternion,
                )
            ),
        },
    }
