"""Axis and angle, in both directions, from 0 to pi."""

import numpy as np
import pytest
import sympy as sm
import sympy.physics.mechanics as me
from orientations import (
    COORDINATE_AXES,
    cross_product_matrix,
    random_dcms,
    random_unit_vectors,
    rotation_error,
    unit_vectors_after_turn,
)
from scipy.spatial.transform import Rotation

from orientation import (
    SymbolsNotPossible,
    axis_angle_from_dcm,
    check_dcm,
    dcm_from_axis_angle,
    dcm_from_quaternion,
    quaternion_from_axis_angle,
    simple_dcm,
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


def test_rows_are_the_turned_unit_vectors():
    for axis in AXES[:20]:
        for angle in (-4, -0.3, 1e-5, 0.7, 3.1, 5):
            assert (
                rotation_error(
                    dcm_from_axis_angle(axis, angle), unit_vectors_after_turn(axis, angle)
                )
                < 1e-12
            )


@pytest.mark.parametrize("axis", "xyz")
def test_coordinate_axes_give_simple_orientations(axis):
    unit = sm.eye(3)[:, "xyz".index(axis)]
    assert (dcm_from_axis_angle(unit, theta) - simple_dcm(axis, theta)).expand() == sm.zeros(3)
    assert (dcm_from_axis_angle(-unit, theta) - simple_dcm(axis, -theta)).expand() == sm.zeros(3)


def test_symbols_agree_with_reference_frames():
    N, A = me.ReferenceFrame("N"), me.ReferenceFrame("A")
    A.orient_axis(N, N.x + 2 * N.y - 2 * N.z, theta)
    ours = dcm_from_axis_angle((1, 2, -2), theta)
    assert sm.simplify(ours - A.dcm(N)) == sm.zeros(3)


def test_rodrigues_formula_with_symbols():
    x, y, z = axis = sm.symbols("e_x, e_y, e_z", real=True)
    e = sm.Matrix(axis) / sm.sqrt(x**2 + y**2 + z**2)
    cross = sm.Matrix([[0, -e[2], e[1]], [e[2], 0, -e[0]], [-e[1], e[0], 0]])
    rodrigues = sm.cos(theta) * sm.eye(3) + (1 - sm.cos(theta)) * e * e.T - sm.sin(theta) * cross
    assert sm.simplify(dcm_from_axis_angle(axis, theta) - rodrigues) == sm.zeros(3)


def test_numbers_agree_with_scipy():
    angles = np.random.default_rng(3).uniform(-10, 10, len(AXES))
    scipy = Rotation.from_rotvec(UNIT_AXES * angles[:, None])
    assert (
        rotation_error(dcm_from_axis_angle(AXES, angles), scipy.as_matrix().swapaxes(1, 2)) < 1e-14
    )
    ours, theirs = quaternion_from_axis_angle(AXES, angles), scipy.as_quat(scalar_first=True)
    sign = np.sign((ours * theirs).sum(axis=1, keepdims=True))
    np.testing.assert_allclose(ours, sign * theirs, atol=5e-15)


def test_the_axis_is_left_alone():
    dcms = dcm_from_axis_angle(AXES, np.linspace(0, 6, len(AXES)))
    np.testing.assert_allclose(np.einsum("nij,nj->ni", dcms, UNIT_AXES), UNIT_AXES, atol=1e-15)


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


def test_there_and_back_from_random_matrices_with_noise():
    dcms = random_dcms(5000, 4)
    dcms += np.random.default_rng(5).uniform(-2.3e-16, 2.3e-16, dcms.shape)
    axes, angles = axis_angle_from_dcm(dcms)
    assert rotation_error(dcm_from_axis_angle(axes, angles), dcms) < 1e-14
    assert (0 <= angles).all() and (angles <= np.pi).all()


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


def test_half_angle():
    assert quaternion_from_axis_angle((0, 0, 2), theta) == sm.Matrix(
        [sm.cos(theta / 2), 0, 0, sm.sin(theta / 2)]
    )
    angles = np.random.default_rng(6).uniform(-10, 10, len(AXES))
    assert (
        rotation_error(
            dcm_from_quaternion(quaternion_from_axis_angle(AXES, angles)),
            dcm_from_axis_angle(AXES, angles),
        )
        < 1e-14
    )


def test_matrix_is_the_exponential_of_the_cross_product():
    # The sign of the exponent distinguishes components from vectors.
    from scipy.linalg import expm

    for axis in UNIT_AXES[:20]:
        assert (
            rotation_error(dcm_from_axis_angle(axis, 0.8), expm(-0.8 * cross_product_matrix(axis)))
            < 1e-14
        )


def test_symbols_cannot_be_taken_back():
    with pytest.raises(SymbolsNotPossible, match="dcm holds cos"):
        axis_angle_from_dcm(simple_dcm("z", theta))
