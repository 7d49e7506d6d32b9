"""Jacobians and covariances of every conversion, against differences and identities."""

import numpy as np
import pytest
import sympy as sm
from orientations import random_dcms

import orientation as o

ANGLES = np.array([0.4, 1.1, -0.7])
VECTOR = np.array([0.3, -1.1, 0.6])
QUATERNION = np.array([0.5, -0.1, 0.7, 0.5])
FROM_DCM = [
    *((o.body_fixed_from_dcm, (sequence,)) for sequence in o.SEQUENCES),
    *((o.space_fixed_from_dcm, (sequence,)) for sequence in ("xyz", "zxz")),
    (o.rotation_vector_from_dcm, ()),
    (o.quaternion_from_dcm, ()),
    (o.rodrigues_from_dcm, ()),
    (o.modified_rodrigues_from_dcm, ()),
    (o.axis_angle_from_dcm, ()),
]
TO_DCM = [
    *((o.dcm_from_body_fixed, ANGLES, (sequence,)) for sequence in o.SEQUENCES),
    *((o.dcm_from_space_fixed, ANGLES, (sequence,)) for sequence in ("xyz", "zxz")),
    (o.dcm_from_rotation_vector, VECTOR, ()),
    (o.dcm_from_rodrigues, VECTOR, ()),
    (o.dcm_from_modified_rodrigues, VECTOR, ()),
    # The other argument is constant.
    (lambda axis: o.dcm_from_axis_angle(axis, 0.3), VECTOR, ()),
    (lambda rate: o.rotation_vector_rate(VECTOR, rate), ANGLES, ()),
]


def ids(case):
    return " ".join([case[0].__name__, *case[-1]])


def turned(dcm, turn, along):
    small = o.dcm_from_rotation_vector(turn)
    return small @ dcm if along == "target" else dcm @ small


def difference(conversion, value, further, along, step=1e-6):
    """Compute the Jacobian by central differences of the public functions."""
    columns = []
    is_dcm = np.shape(value) == (3, 3)
    for change in np.eye(3 if is_dcm else np.size(value)) * step:
        first, second = (
            conversion(
                turned(value, sign * change, along) if is_dcm else value + sign * change, *further
            )
            for sign in (1, -1)
        )
        if isinstance(first, tuple):
            first, second = np.append(*first), np.append(*second)
        if np.shape(first) == (3, 3):
            relative = first @ second.T if along == "target" else second.T @ first
            columns.append(o.rotation_vector_from_dcm(relative) / (2 * step))
        else:
            columns.append((first - second) / (2 * step))
    return np.stack(columns, axis=-1)


@pytest.mark.parametrize("along", ["target", "source"])
@pytest.mark.parametrize("case", FROM_DCM, ids=ids)
def test_of_what_a_matrix_gives(case, along):
    conversion, further = case
    dcms = random_dcms(5, seed=3)
    batch = o.jacobian(conversion, dcms, *further, along=along)
    for dcm, derivative in zip(dcms, batch):
        expected = difference(conversion, dcm, further, along)
        scale = max(1, np.abs(expected).max())
        assert np.abs(derivative - expected).max() < 1e-7 * scale**2
        np.testing.assert_array_equal(
            derivative, o.jacobian(conversion, dcm, *further, along=along)
        )


@pytest.mark.parametrize("along", ["target", "source"])
@pytest.mark.parametrize("case", TO_DCM, ids=ids)
def test_of_what_gives_a_matrix(case, along):
    conversion, value, further = case
    derivative = o.jacobian(conversion, value, *further, along=along)
    np.testing.assert_allclose(derivative, difference(conversion, value, further, along), atol=1e-8)


def test_a_quaternion_gives_twice_its_vector_part():
    derivative = o.jacobian(o.dcm_from_quaternion, QUATERNION)
    back = o.jacobian(o.quaternion_from_dcm, o.dcm_from_quaternion(QUATERNION))
    np.testing.assert_allclose(derivative @ back, np.eye(3), atol=1e-14)
    np.testing.assert_allclose(derivative @ derivative.T, 4 * np.eye(3), atol=1e-14)


def test_symbols_give_what_numbers_give():
    psi, theta, phi = symbols = sm.symbols("psi, theta, varphi")
    values = dict(zip(symbols, ANGLES))
    for along in ("target", "source"):
        exact = o.jacobian(o.dcm_from_body_fixed, symbols, "zxy", along=along)
        assert exact.free_symbols <= set(symbols)
        np.testing.assert_allclose(
            np.array(exact.subs(values)).astype(float),
            o.jacobian(o.dcm_from_body_fixed, ANGLES, "zxy", along=along),
            atol=1e-14,
        )
    assert o.jacobian(lambda angle: o.simple_dcm("z", angle), psi).applyfunc(sm.simplify) == (
        sm.Matrix([0, 0, 1])
    )


def test_a_single_angle_and_no_turn_at_all():
    assert o.jacobian(lambda angle: o.simple_dcm("y", angle), 0.3).round(15).tolist() == [
        [0.0], [1.0], [0.0]
    ]  # fmt: skip
    np.testing.assert_array_equal(o.jacobian(o.dcm_from_rotation_vector, np.zeros(3)), np.eye(3))
    np.testing.assert_array_equal(o.jacobian(o.rotation_vector_from_dcm, np.eye(3)), np.eye(3))


def test_a_covariance_is_that_of_throws():
    rng = np.random.default_rng(5)
    dcm = o.dcm_from_body_fixed((0.4, 0.9, -0.7), "zyx")
    root = rng.normal(size=(3, 3)) * 0.003
    for along in ("target", "source"):
        small = o.dcm_from_rotation_vector(rng.normal(size=(40_000, 3)) @ root.T)
        thrown = small @ dcm if along == "target" else dcm @ small
        angles = o.body_fixed_from_dcm(thrown, "zyx")
        expected = o.propagate_covariance(
            o.body_fixed_from_dcm, dcm, root @ root.T, "zyx", along=along
        )
        scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
        assert np.abs((np.cov(angles.T) - expected) / scale).max() < 0.03


def test_a_lock_is_refused_and_its_neighbourhood_warned_of():
    locked = o.dcm_from_body_fixed((0.1, np.pi / 2, 0.2), "zxy")
    with pytest.raises(ValueError, match="no derivative at dcm: .*gimbal lock"):
        o.jacobian(o.body_fixed_from_dcm, locked, "zxy")
    with pytest.raises(ValueError, match=r"no derivative at dcm \(item \[1\]\)"):
        o.jacobian(o.body_fixed_from_dcm, [np.eye(3), locked], "zxy")
    near = o.dcm_from_body_fixed((0.1, np.pi / 2 - 0.001, 0.2), "zxy")
    with pytest.warns(UserWarning, match="a standard deviation comes out as 10"):
        o.propagate_covariance(o.body_fixed_from_dcm, near, 1e-4 * np.eye(3), "zxy")


@pytest.mark.parametrize(
    "call, words",
    [
        (
            lambda: o.jacobian(o.quaternion_from_dcm, np.eye(3), along="body"),
            "along must be .* not 'body'",
        ),
        (lambda: o.jacobian(o.quaternion_from_dcm, 2 * np.eye(3)), "2 times an orthogonal one"),
        (lambda: o.jacobian(o.angular_velocity_matrix, ANGLES, "zxz"), "dcm is not orthogonal"),
        (
            lambda: o.propagate_covariance(o.quaternion_from_dcm, np.eye(3), np.eye(4)),
            r"covariance has shape \(4, 4\)",
        ),
        (
            lambda: o.propagate_covariance(o.rotation_vector_from_dcm, np.eye(3), np.tri(3)),
            "not symmetric: .* differ by 1. Is only one half of it filled in",
        ),
        (
            lambda: o.propagate_covariance(o.rotation_vector_from_dcm, np.eye(3), 3 - np.eye(3)),
            "has the eigenvalue -1, but no variance is negative",
        ),
        (
            lambda: o.MultiplicativeKalmanFilter(np.eye(3), np.diag([-1.0, *[1e-4] * 5]), 0, 0),
            "has the eigenvalue -1, .* as in ROS",
        ),
    ],
)
def test_what_does_not_fit_is_said(call, words):
    with pytest.raises(ValueError, match=words):
        call()
