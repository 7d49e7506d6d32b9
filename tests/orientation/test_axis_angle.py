"""Axis and angle, in both directions, from 0 to pi."""

import numpy as np
import pytest
import sympy as sm
import sympy.physics.mechanics as me
from orientations import (
    COORDINATE_AXES,
    random_unit_vectors,
    rotation_error,
)
from scipy.spatial.transform import Rotation

from orientation import (
    axis_angle_from_dcm,
    check_dcm,
    dcm_from_axis_angle,
    dcm_from_quaternion,
    quaternion_from_axis_angle,
    same_orientation,
)
from orientation.axis_angle import axis_angle_components
from orientation.numbers_and_symbols import NUMBERS

theta = sm.Symbol("theta")
SMALL = [0, 1e-300, 1e-16, 1e-12, 1e-8, 1e-7, 1e-4, 1e-2, 0.1]
ANGLES = SMALL + [1.0, np.pi / 2, 2.0] + [np.pi - small for small in reversed(SMALL)]
AXES = np.array(
    [*COORDINATE_AXES, *random_unit_vectors(50, 1), *(random_unit_vectors(10, 2) * [1, 1, 1e-9])]
)
UNIT_AXES = AXES / np.linalg.norm(AXES, axis=1, keepdims=True)


def test_symbols_agree_with_reference_frames():
    N, A = me.ReferenceFrame("N"), me.ReferenceFrame("A")
    A.orient_axis(N, N.x + 2 * N.y - 2 * N.z, theta)
    ours = dcm_from_axis_angle((1, 2, -2), theta)
    assert sm.simplify(ours - A.dcm(N)) == sm.zeros(3)


def test_numbers_agree_with_scipy():
    angles = np.random.default_rng(3).uniform(-10, 10, len(AXES))
    scipy = Rotation.from_rotvec(UNIT_AXES * angles[:, None])
    assert (
        rotation_error(dcm_from_axis_angle(AXES, angles), scipy.as_matrix().swapaxes(1, 2)) < 1e-14
    )
    ours, theirs = quaternion_from_axis_angle(AXES, angles), scipy.as_quat(scalar_first=True)
    sign = np.sign((ours * theirs).sum(axis=1, keepdims=True))
    np.testing.assert_allclose(ours, sign * theirs, atol=5e-15)


@pytest.mark.parametrize("scale", [1e-149, 1e-100, 1e-9, 3.7, 1e9, 1e100, 1e149])
def test_length_of_the_axis_does_not_matter(scale):
    for axis in AXES[:10]:
        assert (
            rotation_error(dcm_from_axis_angle(scale * axis, 1.1), dcm_from_axis_angle(axis, 1.1))
            < 1e-15
        )
        np.testing.assert_allclose(
            quaternion_from_axis_angle(scale * axis, 1.1),
            quaternion_from_axis_angle(axis, 1.1),
            atol=1e-15,
        )
    assert (
        rotation_error(dcm_from_axis_angle(scale * AXES, 1.1), dcm_from_axis_angle(AXES, 1.1))
        < 1e-15
    )


@pytest.mark.parametrize("angle", ANGLES)
def test_there_and_back_from_0_to_pi(angle):
    dcms = dcm_from_axis_angle(AXES, angle)
    check_dcm(dcms)
    axes, angles = axis_angle_from_dcm(dcms)
    assert rotation_error(dcm_from_axis_angle(axes, angles), dcms) < 1e-14
    assert abs(angles - angle).max() < 1e-14
    np.testing.assert_allclose(np.linalg.norm(axes, axis=1), 1, atol=5e-16)
    # The allowed error of the axis depends on its effect.
    same = np.minimum(
        np.linalg.norm(axes - UNIT_AXES, axis=1),
        np.linalg.norm(axes + UNIT_AXES, axis=1) if angle > np.pi - 1e-15 else np.inf,
    )
    assert (same * np.sin(angle / 2)).max() < 1e-14
    for dcm in dcms[: min(8, len(UNIT_AXES))]:
        single_axis, single_angle = axis_angle_from_dcm(dcm)
        assert isinstance(single_angle, float) and single_axis.shape == (3,)
        assert rotation_error(dcm_from_axis_angle(single_axis, single_angle), dcm) < 1e-14


def test_exact_half_turns_and_rest():
    for axis in np.eye(3):
        axis_found, angle = axis_angle_from_dcm(2 * np.outer(axis, axis) - np.eye(3))
        assert angle == np.pi and (axis_found == axis).all()
    for rest in (np.eye(3), np.where(np.eye(3) == 1, 1, -0.0), np.eye(3, dtype=int)):
        axis_found, angle = axis_angle_from_dcm(rest)
        assert angle == 0 and axis_found.tolist() == [1, 0, 0]


def test_both_quaternions_of_an_orientation_have_one_axis_and_angle():
    """Anyone who has components uses the formula, with either sign."""
    for quaternion in [*random_unit_vectors(20, 7, size=4), np.array([1.0, 0, 0, 0])]:
        for sign in (1, -1):
            *axis, angle = axis_angle_components(NUMBERS, *sign * quaternion)
            assert np.linalg.norm(axis) == pytest.approx(1) and 0 <= angle <= np.pi
            assert (
                rotation_error(dcm_from_axis_angle(axis, angle), dcm_from_quaternion(quaternion))
                < 1e-14
            )


@pytest.mark.parametrize(
    ("size", "words"), [(1e-155, "too short"), (1e-160, "too short"), (1e152, "too long")]
)
def test_an_axis_whose_square_loses_digits_is_refused(size, words):
    """Its square is still a number, or infinite, and would give a matrix that is no rotation."""
    axis = size * np.array([0.6, 0, 0.8])
    for axes in (axis.tolist(), np.stack([axis] * 3)):
        with pytest.raises(ValueError, match=words):
            dcm_from_axis_angle(axes, 0.3)
    assert same_orientation(
        dcm_from_axis_angle(axis / size * 1e100, 0.3), dcm_from_axis_angle((0.6, 0, 0.8), 0.3)
    )
