"""Rates, rotation vectors and interpolation, against SymPy, SciPy and differences."""

import mpmath
import numpy as np
import pytest
import sympy as sm
import sympy.physics.mechanics as me
from orientations import random_unit_vectors
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation, Slerp

from orientation import (
    SEQUENCES,
    SymbolsNotPossible,
    angular_velocity_from_dcm_rate,
    angular_velocity_matrix,
    dcm_from_body_fixed,
    dcm_from_quaternion,
    dcm_from_rotation_vector,
    dcm_from_scipy_rotation,
    dcm_rate,
    dcms_after_turns,
    interpolate_quaternions,
    quaternion_from_dcm,
    quaternion_rate,
    rotation_vector_from_dcm,
    rotation_vector_rate,
    same_orientation,
    simple_dcm,
    turns_from_angular_velocity,
)


@pytest.fixture
def random():
    """Give each test the same random numbers, whatever ran before."""
    return np.random.default_rng(11)


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_angular_velocity_matrix_agrees_with_sympy(sequence, random):
    psi, theta, phi = me.dynamicsymbols("psi, theta, varphi")
    A, D = me.ReferenceFrame("A"), me.ReferenceFrame("D")
    D.orient_body_fixed(A, (psi, theta, phi), sequence)
    rates = sm.Matrix([psi, theta, phi]).diff(me.dynamicsymbols._t)
    by_sympy = D.ang_vel_in(A).to_matrix(D).jacobian(rates)
    ours = angular_velocity_matrix((psi, theta, phi), sequence)
    for values in random.uniform(-3, 3, (4, 3)):
        numbers = dict(zip((psi, theta, phi), values))
        expected = np.array(by_sympy.subs(numbers), dtype=float)
        assert np.allclose(np.array(ours.subs(numbers), dtype=float), expected, atol=1e-13)
        assert np.allclose(angular_velocity_matrix(values, sequence), expected, atol=1e-13)


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_all_rates_belong_to_one_motion(sequence, random):
    """Use central differences of the matrix and the quaternion, with constant angle rates."""
    step = 1e-5
    for angles, rates in zip(random.uniform(-3, 3, (10, 3)), random.uniform(-2, 2, (10, 3))):
        omega = angular_velocity_matrix(angles, sequence) @ rates
        before, now, after = (
            dcm_from_body_fixed(angles + s * step * rates, sequence) for s in (-1, 0, 1)
        )
        assert np.allclose(dcm_rate(now, omega), (after - before) / (2 * step), atol=1e-8)
        q = quaternion_from_dcm(now)
        ahead, behind = (np.sign(p @ q) * p for p in map(quaternion_from_dcm, (after, before)))
        assert np.allclose(quaternion_rate(q, omega), (ahead - behind) / (2 * step), atol=1e-8)


@pytest.mark.parametrize("scale", [1, 1e-3, 1e-7, 1e-12, 1e-200])
def test_exponential_against_scipy_and_back(scale, random):
    axes = random.normal(size=(500, 3))
    vectors = (
        scale
        * np.pi
        * random.uniform(0, 1, (500, 1))
        * axes
        / np.linalg.norm(axes, axis=1)[:, None]
    )
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
    for first, second in zip(
        random_unit_vectors(40, 1, size=4), random_unit_vectors(40, 2, size=4)
    ):
        both = Rotation.from_quat([first, second], scalar_first=True)
        expected = dcm_from_scipy_rotation(Slerp([0, 1], both)(shares))
        ours = dcm_from_quaternion(interpolate_quaternions(first, second, shares))
        assert abs(ours - expected).max() < 1e-13


def test_slerp_between_nearly_and_exactly_equal_orientations():
    q = random_unit_vectors(1, 1, size=4)[0]
    for end in (q, -q):
        assert same_orientation(interpolate_quaternions(q, end, 0.3), q)
    near = q + 1e-10 * np.array([-q[1], q[0], -q[3], q[2]])
    assert abs(interpolate_quaternions(q, near, 0.5) - (q + near) / 2).max() < 1e-15


def test_angular_velocity_undoes_the_rate_of_the_matrix(random):
    dcms = dcm_from_quaternion(random_unit_vectors(50, 1, size=4))
    omegas = random.normal(size=(50, 3))
    assert np.allclose(
        angular_velocity_from_dcm_rate(dcms, dcm_rate(dcms, omegas)), omegas, atol=1e-14
    )
    # The symmetric part of the product is no rotation, so the skew part is used.
    stretch = np.diag([0.1, 0.2, 0.3]) @ dcms[0]
    assert np.allclose(
        angular_velocity_from_dcm_rate(dcms[0], dcm_rate(dcms[0], omegas[0]) + stretch), omegas[0]
    )
    with pytest.raises(ValueError, match="not orthogonal"):
        angular_velocity_from_dcm_rate(2 * np.eye(3), np.zeros((3, 3)))


@pytest.mark.parametrize("size", [1e-12, 1e-6, 1e-3, 0.05, 1, 3, 4.5, 6.2])
def test_rotation_vector_rate_against_differences(size, random):
    """The matrix of r + h dr/dt must follow the angular velocity, beyond half a turn as well."""
    h = 1e-5
    for _ in range(20):
        vector = random.normal(size=3)
        vector *= size / np.linalg.norm(vector)
        omega = random.normal(size=3)
        rate = rotation_vector_rate(vector, omega)
        h_here = h / max(1, np.linalg.norm(rate))
        ahead, behind = (
            dcm_from_rotation_vector(vector + sign * h_here * rate) for sign in (1, -1)
        )
        assert np.allclose(
            (ahead - behind) / (2 * h_here),
            dcm_rate(dcm_from_rotation_vector(vector), omega),
            atol=2e-9,
        )


def test_rotation_vector_rate_at_rest_of_symbols_and_at_a_whole_turn():
    assert (rotation_vector_rate((0.0, 0, 0), (1.0, 2, 3)) == [1, 2, 3]).all()
    assert rotation_vector_rate(np.zeros((4, 3)), (1.0, 2, 3)).shape == (4, 3)
    symbols = sm.symbols("r_x:z, omega_x:z")
    ours = rotation_vector_rate(symbols[:3], symbols[3:]).subs(
        dict(zip(symbols, (0.1, 0.7, -0.4, 1, 2, 3)))
    )
    assert np.allclose(
        np.array(ours, dtype=float).ravel(), rotation_vector_rate((0.1, 0.7, -0.4), (1, 2, 3))
    )
    near = rotation_vector_rate((0, 0, 2 * np.pi - 1e-4), (1.0, 0, 0))
    assert np.linalg.norm(near) > 1e4, "it grows without bound"
    for turns in (1, 3):
        for axis in ((1, 0, 0), (0.6, 0.8, 0), (0, 0.6, 0.8)):
            whole = 2 * np.pi * turns * np.array(axis)
            rotation_vector_rate(np.outer((0.25, 0.5, 0.75), whole), (1.0, 0, 0))
            with pytest.raises(ValueError, match="^vector is .* a full rotation"):
                rotation_vector_rate(whole, (1.0, 0, 0))
            with pytest.raises(ValueError, match=r"^vector \(item \[1\]\) is .* a full rotation"):
                rotation_vector_rate([whole / 2 / turns, whole], (1.0, 0, 0))


def tumbling(t):
    """An angular velocity that changes its size and its direction."""
    return np.stack([2 * np.sin(3 * t), 1 + np.cos(2 * t), 1.5 * np.sin(t + 1)], axis=-1)


@pytest.fixture(scope="module")
def tumbled():
    """Integrate the nine equations of the matrix with SciPy's integrator of eighth order."""
    solution = solve_ivp(
        lambda t, c: dcm_rate(c.reshape(3, 3), tumbling(t)).ravel(),
        (0, 4),
        np.eye(3).ravel(),
        "DOP853",
        rtol=1e-13,
        atol=1e-14,
    )
    return solution.y[:, -1].reshape(3, 3)


@pytest.mark.parametrize("order", (1, 2, 4))
def test_exponential_steps_have_their_order_and_stay_valid(order, tumbled):
    errors = []
    for count in (100, 200):
        dcms = dcms_after_turns(
            np.eye(3), turns_from_angular_velocity(tumbling, np.linspace(0, 4, count + 1), order)
        )
        assert dcms.shape == (count + 1, 3, 3)
        assert abs(dcms[-1] @ dcms[-1].T - np.eye(3)).max() < 1e-13
        errors.append(np.linalg.norm(dcms[-1] - tumbled))
    assert abs(np.log2(errors[0] / errors[1]) - order) < 0.1
    assert errors[1] < {1: 0.1, 2: 1e-3, 4: 1e-6}[order]


def test_a_constant_angular_velocity_is_integrated_exactly_by_one_step():
    omega = np.array([0.3, -2.0, 1.0])
    for order in (1, 2, 4):
        turns = turns_from_angular_velocity(lambda t: omega, [0, 1.7], order)
        assert np.allclose(turns, [1.7 * omega], atol=1e-15)


@pytest.mark.parametrize(
    "function, arguments, error, words",
    [
        (
            interpolate_quaternions,
            ((1, 0, 0, 0), (0, 0, 1, 0), 0.5),
            ValueError,
            "half a turn apart",
        ),
        (
            interpolate_quaternions,
            ((1, 0, 0, 0), (2, 0, 0, 0), 0.5),
            ValueError,
            "second has length 2",
        ),
        (
            interpolate_quaternions,
            (sm.symbols("a:4"), (1, 0, 0, 0), 0.5),
            SymbolsNotPossible,
            "first holds a0",
        ),
        (
            turns_from_angular_velocity,
            (tumbling, [0, 1], 3),
            ValueError,
            "order must be 1, 2 or 4, not 3",
        ),
        (
            turns_from_angular_velocity,
            (lambda t: np.ones((len(t), 1)), [0, 1, 2, 3]),
            (ValueError, TypeError),
            r"shape \(2,\)|shape \(3, 1\)",
        ),
        (
            turns_from_angular_velocity,
            (lambda t: np.ones((5, 3)), [0, 1, 2, 3]),
            (ValueError, TypeError),
            "for 3 times",
        ),
        (
            turns_from_angular_velocity,
            (np.ones((4, 3)), [0, 1, 2, 3]),
            (ValueError, TypeError),
            "must be a function of the times. For the samples of a gyroscope",
        ),
        (
            turns_from_angular_velocity,
            (tumbling, [0]),
            ValueError,
            "^times must have shape .* boundaries of one or more",
        ),
        (
            turns_from_angular_velocity,
            (tumbling, [[0, 1]]),
            ValueError,
            "^times must have shape .* boundaries of one or more",
        ),
        (
            turns_from_angular_velocity,
            (lambda t: [3 * [np.nan]], [0, 1]),
            (ValueError, TypeError),
            r"^angular_velocity\(times\)\[0, 0\] is nan",
        ),
        (
            turns_from_angular_velocity,
            (lambda t: [3 * ["fast"]], [0, 1]),
            (ValueError, TypeError),
            r"^angular_velocity\(times\) must hold real numbers",
        ),
        (
            dcms_after_turns,
            (2 * np.eye(3), np.zeros((1, 3))),
            ValueError,
            "^start is not orthogonal",
        ),
        (
            dcms_after_turns,
            (np.eye(3)[None], np.zeros((1, 3))),
            ValueError,
            r"^start must have shape \(3, 3\), not \(1, 3, 3\)",
        ),
        (
            dcms_after_turns,
            (np.eye(3), (0, 0, 1)),
            ValueError,
            r"^turns must have shape \(n, 3\), not \(3,\)",
        ),
    ],
)
def test_what_has_no_answer_or_cannot_be_read_is_refused(function, arguments, error, words):
    with pytest.raises(error, match=words):
        function(*arguments)


# ---- digits of near orientations and small turns -------------------------------------------------


@pytest.mark.parametrize("exponent", [*range(-16, 1), -310])
def test_slerp_keeps_all_digits_however_near_the_two_are(exponent):
    for mantissa in (1.0, 3.7, 9.9):
        half = mantissa * 10.0**exponent / 10
        interpolated = interpolate_quaternions(
            (1, 0, 0, 0), (float(mpmath.cos(half)), 0, float(mpmath.sin(half)), 0), 0.3
        )
        with mpmath.workdps(40):
            right = float(mpmath.sin(mpmath.mpf("0.3") * half))
        assert interpolated[2] == pytest.approx(right, rel=2e-15 if exponent > -300 else 1e-12)
        assert interpolated[0] == pytest.approx(float(mpmath.cos(0.3 * half)), abs=3e-16)


@pytest.mark.parametrize("scalar", [0.0, 1e-17, -1e-16, 2e-14])
def test_no_way_is_shorter_between_orientations_half_a_turn_apart(scalar):
    with pytest.raises(ValueError, match="half a turn apart"):
        interpolate_quaternions((1, 0, 0, 0), (scalar, 0.6, 0.8, 0), 0.5)


@pytest.mark.parametrize("scalar", [1e-10, -1e-10, 1e-6])
def test_one_way_is_shorter_as_soon_as_they_are_nearer(scalar):
    interpolated = interpolate_quaternions((1, 0, 0, 0), (scalar, 0.6, 0.8, 0), 0.5)
    assert np.allclose(
        interpolated,
        np.array([1, *np.sign(scalar) * np.array([0.6, 0.8, 0])]) / np.sqrt(2),
        atol=1e-5,
    )


@pytest.mark.parametrize("length", [1e-308, 1e-200, 1e-170, 1e-150, 1e-9])
def test_the_square_of_a_small_rotation_vector_may_be_nothing(length):
    """Where the square of its length is 0 in doubles, a vector is not, alone or in a batch."""
    vector = np.array([0.6 * length, 0, 0.8 * length])
    for dcm in (dcm_from_rotation_vector(vector), dcm_from_rotation_vector([vector, vector])[1]):
        assert np.array_equal(np.diag(dcm), [1, 1, 1])
        assert np.allclose([dcm[0, 1], dcm[1, 2]], [0.8 * length, 0.6 * length], rtol=1e-15, atol=0)
        assert dcm[0, 2] == pytest.approx(0.24 * length * length, rel=1e-6)
        for back in (rotation_vector_from_dcm(dcm), rotation_vector_from_dcm([dcm, dcm])[1]):
            assert np.allclose(back, vector, rtol=1e-15, atol=0)
