"""Rates, rotation vectors and interpolation, against SymPy, SciPy and differences."""

import numpy as np
import pytest
import sympy as sm
import sympy.physics.mechanics as me
from scipy.spatial.transform import Rotation, Slerp

from orientation import (
    SEQUENCES,
    SymbolsNotPossible,
    angular_velocity_matrix,
    dcm_from_body_fixed,
    dcm_from_quaternion,
    dcm_from_rotation_vector,
    dcm_from_scipy_rotation,
    dcm_rate,
    gimbal_lock_margin,
    interpolate_quaternions,
    quaternion_from_dcm,
    quaternion_rate,
    rotation_vector_from_dcm,
    same_orientation,
    simple_dcm,
)

RANDOM = np.random.default_rng(11)


def random_quaternions(count):
    quaternions = RANDOM.normal(size=(count, 4))
    return quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True)


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_angular_velocity_matrix_agrees_with_sympy(sequence):
    psi, theta, phi = me.dynamicsymbols("psi, theta, varphi")
    A, D = me.ReferenceFrame("A"), me.ReferenceFrame("D")
    D.orient_body_fixed(A, (psi, theta, phi), sequence)
    rates = sm.Matrix([psi, theta, phi]).diff(me.dynamicsymbols._t)
    by_sympy = D.ang_vel_in(A).to_matrix(D).jacobian(rates)
    ours = angular_velocity_matrix((psi, theta, phi), sequence)
    for values in RANDOM.uniform(-3, 3, (4, 3)):
        numbers = dict(zip((psi, theta, phi), values))
        expected = np.array(by_sympy.subs(numbers), dtype=float)
        assert np.allclose(np.array(ours.subs(numbers), dtype=float), expected, atol=1e-13)
        assert np.allclose(angular_velocity_matrix(values, sequence), expected, atol=1e-13)


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_determinant_is_the_sine_of_the_lock_margin(sequence):
    angles = RANDOM.uniform(-np.pi, np.pi, (200, 3))
    determinants = np.linalg.det(angular_velocity_matrix(angles, sequence))
    assert np.allclose(abs(determinants), np.sin(gimbal_lock_margin(angles, sequence)), atol=1e-12)


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_all_rates_belong_to_one_motion(sequence):
    """Central differences of the matrix and of the quaternion, moving with constant angle rates."""
    step = 1e-5
    for angles, rates in zip(RANDOM.uniform(-3, 3, (10, 3)), RANDOM.uniform(-2, 2, (10, 3))):
        omega = angular_velocity_matrix(angles, sequence) @ rates
        before, now, after = (dcm_from_body_fixed(angles + s * step * rates, sequence) for s in (-1, 0, 1))
        assert np.allclose(dcm_rate(now, omega), (after - before) / (2 * step), atol=1e-8)
        q = quaternion_from_dcm(now)
        ahead, behind = (np.sign(p @ q) * p for p in map(quaternion_from_dcm, (after, before)))
        assert np.allclose(quaternion_rate(q, omega), (ahead - behind) / (2 * step), atol=1e-8)


def test_rates_of_symbols_and_batches():
    q = sm.symbols("q_0, q_i, q_j, q_k")
    omega = sm.symbols("omega_x, omega_y, omega_z")
    rate = quaternion_rate(q, omega)
    assert sm.expand(2 * sum(a * b for a, b in zip(q, rate))) == 0  # the length stays
    assert quaternion_rate(random_quaternions(7), (1.0, 0, 0)).shape == (7, 4)
    assert dcm_rate(np.eye(3), np.zeros((5, 3))).shape == (5, 3, 3)


@pytest.mark.parametrize("scale", [1, 1e-3, 1e-7, 1e-12, 1e-200])
def test_exponential_against_scipy_and_back(scale):
    axes = RANDOM.normal(size=(500, 3))
    vectors = scale * np.pi * RANDOM.uniform(0, 1, (500, 1)) * axes / np.linalg.norm(axes, axis=1)[:, None]
    dcm = dcm_from_rotation_vector(vectors)
    assert abs(dcm - dcm_from_scipy_rotation(Rotation.from_rotvec(vectors))).max() < 1e-14
    assert np.allclose(rotation_vector_from_dcm(dcm), vectors, rtol=1e-9, atol=1e-15)


def test_exponential_of_nothing_and_of_symbols():
    assert (dcm_from_rotation_vector((0.0, 0.0, 0.0)) == np.eye(3)).all()
    assert dcm_from_rotation_vector(sm.Matrix([0, 0, 0])) == sm.eye(3)
    assert (rotation_vector_from_dcm(np.eye(3)) == 0).all()
    theta = sm.Symbol("theta")
    assert same_orientation(dcm_from_rotation_vector((theta, 0, 0)), simple_dcm("x", theta))
    assert abs(dcm_from_rotation_vector((0, 0, np.pi)) - np.diag([-1, -1, 1])).max() < 1e-15
    with pytest.raises(SymbolsNotPossible):
        rotation_vector_from_dcm(simple_dcm("x", theta))


def test_slerp_agrees_with_scipy():
    shares = np.linspace(0, 1, 9)
    for first, second in zip(random_quaternions(40), random_quaternions(40)):
        both = Rotation.from_quat([first, second], scalar_first=True)
        expected = dcm_from_scipy_rotation(Slerp([0, 1], both)(shares))
        ours = dcm_from_quaternion(interpolate_quaternions(first, second, shares))
        assert abs(ours - expected).max() < 1e-13


def test_slerp_between_nearly_and_exactly_equal_orientations():
    q = random_quaternions(1)[0]
    for other in (q, -q):
        assert same_orientation(interpolate_quaternions(q, other, 0.3), q)
    near = q + 1e-10 * np.array([-q[1], q[0], -q[3], q[2]])
    assert abs(interpolate_quaternions(q, near, 0.5) - (q + near) / 2).max() < 1e-15


def test_slerp_refuses_what_has_no_answer():
    with pytest.raises(ValueError, match="half a turn apart"):
        interpolate_quaternions((1, 0, 0, 0), (0, 0, 1, 0), 0.5)
    with pytest.raises(ValueError, match="second has length 2"):
        interpolate_quaternions((1, 0, 0, 0), (2, 0, 0, 0), 0.5)
    with pytest.raises(SymbolsNotPossible):
        interpolate_quaternions(sm.symbols("a:4"), (1, 0, 0, 0), 0.5)
