"""Unit quaternions, in both directions, and their product."""

import numpy as np
import pytest
import sympy as sm
import sympy.physics.mechanics as me
from orientations import (
    random_dcms,
    random_unit_vectors,
    rotation_error,
)
from scipy.spatial.transform import Rotation

from orientation import (
    dcm_from_quaternion,
    multiply_quaternions,
    quaternion_from_dcm,
)

SYMBOLS = sm.symbols("q_0, q_i, q_j, q_k")
ONE, I, J, K = np.eye(4)


def up_to_sign(quaternions, others):
    quaternions, others = np.atleast_2d(quaternions), np.atleast_2d(others)
    return np.minimum(
        abs(quaternions - others).max(axis=1), abs(quaternions + others).max(axis=1)
    ).max()


# --- to a matrix ----------------------------------------------------------------------------------


def test_symbols_agree_with_reference_frames():
    N, A = me.ReferenceFrame("N"), me.ReferenceFrame("A")
    A.orient_quaternion(N, SYMBOLS)
    assert dcm_from_quaternion(SYMBOLS) == A.dcm(N)


def test_numbers_agree_with_scipy():
    quaternions = random_unit_vectors(2000, 2, size=4)
    scipy = Rotation.from_quat(quaternions, scalar_first=True)
    assert (
        rotation_error(dcm_from_quaternion(quaternions), scipy.as_matrix().swapaxes(1, 2)) < 1e-14
    )
    assert up_to_sign(quaternion_from_dcm(scipy.as_matrix().swapaxes(1, 2)), quaternions) < 5e-15


@pytest.mark.parametrize("digits", (4, 6, 9))
def test_a_printed_quaternion_is_refused_with_what_to_do_and_taken_when_it_is_done(digits):
    """Nine digits are refused, because a tolerance for printed numbers would also admit faults."""
    exact = random_unit_vectors(200, 9, size=4)
    printed = np.array([[float(f"{number:.{digits}f}") for number in row] for row in exact])
    with pytest.raises(
        ValueError, match="rounded when an instrument.*divide by the length: q / numpy.linalg.norm"
    ):
        dcm_from_quaternion(printed)
    restored = printed / np.linalg.norm(printed, axis=-1, keepdims=True)  # as the error says
    assert (
        rotation_error(dcm_from_quaternion(restored), dcm_from_quaternion(exact))
        < 6 * 10.0**-digits
    )


def test_what_is_taken_as_unit_makes_a_matrix_that_is_taken_as_valid():
    quaternions = random_unit_vectors(50, 4, size=4)
    refused = 0
    for stretch in np.linspace(1 - 8e-10, 1 + 8e-10, 41):
        for quaternion in stretch * quaternions:
            try:
                dcm = dcm_from_quaternion(quaternion)
            except ValueError as error:
                refused += 1
                assert " length 1," not in str(error)
                continue
            quaternion_from_dcm(dcm)
    assert 0 < refused < 41 * 50


# --- and back -------------------------------------------------------------------------------------

NEAR_ZERO = [0.0, 1e-300, 1e-17, 1e-16, 1e-12, 1e-8, 1e-4]


@pytest.mark.parametrize("place", range(4))
@pytest.mark.parametrize("value", NEAR_ZERO)
def test_there_and_back_with_any_component_near_zero(place, value):
    quaternions = random_unit_vectors(500, 6, size=4)
    quaternions[:, place] = value * np.where(np.arange(500) % 2, 1, -1)
    quaternions /= np.linalg.norm(quaternions, axis=1, keepdims=True)
    assert up_to_sign(quaternion_from_dcm(dcm_from_quaternion(quaternions)), quaternions) < 5e-15


def test_of_the_two_the_one_with_positive_scalar_part():
    quaternions = quaternion_from_dcm(random_dcms(5000, 8))
    assert (quaternions[:, 0] >= 0).all()
    np.testing.assert_allclose(np.linalg.norm(quaternions, axis=1), 1, atol=4e-16)
    for half_turn in (I, J, K):
        assert (quaternion_from_dcm(dcm_from_quaternion(-half_turn)) == half_turn).all()
    assert not np.signbit(quaternion_from_dcm(np.eye(3))).any()


# --- the product ----------------------------------------------------------------------------------


def test_product_of_symbols_agrees_with_sympy():
    others = sm.symbols("p_0, p_i, p_j, p_k")
    product = sm.Quaternion(*SYMBOLS) * sm.Quaternion(*others)
    assert (multiply_quaternions(SYMBOLS, others) - sm.Matrix(product.args)).expand() == sm.zeros(
        4, 1
    )


def test_quaternions_stand_in_the_order_of_the_turns_and_matrices_in_the_other():
    first, second = random_unit_vectors(500, 11, size=4), random_unit_vectors(500, 12, size=4)
    assert (
        rotation_error(
            dcm_from_quaternion(multiply_quaternions(first, second)),
            dcm_from_quaternion(second) @ dcm_from_quaternion(first),
        )
        < 1e-14
    )


def test_lengths_multiply_and_are_not_restored():
    np.testing.assert_allclose(multiply_quaternions((2, 0, 0, 0), (0, 0, 3, 4)), (0, 0, 6, 8))


# --- errors ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "quaternion, message",
    [
        ((0, 0, 0, 0), "has length 0, not 1: the zero quaternion describes no orientation"),
        ((0.7071, 0.7071, 0, 0), "has length 0.99999.*, not 1: were its components rounded when"),
        ((0.97, 0, 0, 0), "has length 0.97, not 1: were its components rounded, or integrated"),
        ((0, 1.04, 0, 0), "has length 1.04, not 1: were its components rounded, or integrated"),
        ((1.06, 0, 0, 0), "has length 1.06, not 1: is the angle halved"),
        ((1, 1, 0, 0), r"has length 1\.41421.*, not 1: is the angle halved"),
        (np.array([ONE, I, 2 * J]), r"quaternion \(item \[2\]\) has length 2, not 1"),
        ((sm.Rational(1, 2), sm.Rational(1, 2), 0, 0), "has length 0.7071"),
    ],
)
def test_a_quaternion_that_is_not_of_unit_length(quaternion, message):
    with pytest.raises(ValueError, match=message):
        dcm_from_quaternion(quaternion)
