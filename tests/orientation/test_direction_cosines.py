"""Simple orientations against their definition, validity, and the nearest valid matrix."""

import numpy as np
import pytest
import sympy as sm
from orientations import random_dcms, rotation_error, unit_vectors_after_turn

from orientation import check_dcm, nearest_dcm, simple_dcm

theta = sm.Symbol("theta")
c, s = sm.cos(theta), sm.sin(theta)

BY_HAND = {
    "x": sm.Matrix([[1, 0, 0], [0, c, s], [0, -s, c]]),
    "y": sm.Matrix([[c, 0, -s], [0, 1, 0], [s, 0, c]]),
    "z": sm.Matrix([[c, s, 0], [-s, c, 0], [0, 0, 1]]),
}


@pytest.mark.parametrize("axis", "xyz")
def test_simple_orientation_is_the_matrix_derived_by_hand(axis):
    assert simple_dcm(axis, theta) == BY_HAND[axis]


@pytest.mark.parametrize("angle", [0, 0.0, -0.0, np.zeros(3), 1e22, -1e22])
def test_no_negative_zero_and_any_size_of_angle(angle):
    dcm = simple_dcm("y", angle)
    assert not np.signbit(dcm[dcm == 0]).any()
    check_dcm(dcm)


# --- validity ------------------------------------------------------------------------------------


def test_valid_matrices_pass():
    check_dcm(random_dcms(1000, 1))
    check_dcm(np.eye(3, dtype=int))
    check_dcm(BY_HAND["x"] * BY_HAND["z"])
    check_dcm(
        sm.ImmutableMatrix(
            [
                [sm.Rational(3, 5), sm.Rational(4, 5), 0],
                [sm.Rational(-4, 5), sm.Rational(3, 5), 0],
                [0, 0, 1],
            ]
        )
    )
    check_dcm(np.zeros((0, 3, 3)))


@pytest.mark.parametrize("row", range(3))
@pytest.mark.parametrize("column", range(3))
@pytest.mark.parametrize("change", [3e-9, -3e-9])
def test_any_one_wrong_entry_is_found(row, column, change):
    for dcm in random_dcms(20, 2):
        dcm[row, column] += change / min(1, abs(dcm[row, column]))
        with pytest.raises(ValueError, match="not orthogonal: row"):
            check_dcm(dcm)


def test_triads_that_are_skewed_or_shrunk_in_one_plane_are_found():
    # The third row is the cross product of the first two, so only these two can show the fault.
    for first, second, _ in random_dcms(20, 9):
        for x, y in (
            (0.9 * first, second),
            (1.1 * first, second),
            (first, 0.9 * second),
            (first, 1.1 * second),
            (first, np.cos(0.1) * second + np.sin(0.1) * first),
            (first, np.cos(0.1) * second - np.sin(0.1) * first),
        ):
            with pytest.raises(ValueError, match="dcm is not orthogonal: row"):
                check_dcm([x, y, np.cross(x, y)])


@pytest.mark.parametrize(
    "factor, message",
    [
        (3, "row x has length 3, not 1. The whole matrix is 3 times an orthogonal one"),
        (1.001, "row x has length 1.001, not 1. The whole matrix is 1.001 times an orthogonal one"),
        (0.999, "row . has length 0.999, not 1. The whole matrix is 0.999 times an orthogonal one"),
        (1 + 1e-7, "row x has length 1.0000001, not 1. Were its entries rounded"),
        (1 - 1e-9, "row . has length 0.999999999, not 1. Were its entries rounded"),
        (np.array([[1.02], [1], [1]]), "row x has length 1.02, not 1. Were its entries rounded"),
        (np.array([[1], [0.98], [1]]), "row y has length 0.98, not 1. Were its entries rounded"),
        (np.array([[1], [1], [1.2]]), "row z has length 1.2, not 1. An entry or a sign is wrong"),
        (np.array([[1], [0.8], [1]]), "row y has length 0.8, not 1. An entry or a sign is wrong"),
    ],
)
def test_likely_causes(factor, message):
    for dcm in (np.eye(3), random_dcms(1, 10)[0]):
        with pytest.raises(ValueError, match=message):
            check_dcm(factor * dcm)


def test_rows_that_are_not_perpendicular_are_named_with_their_dot_product():
    for share, message in (
        (0.02, "Were its entries rounded"),
        (-0.02, "Were its entries rounded"),
        (0.3, "An entry or a sign is wrong"),
        (-0.3, "An entry or a sign is wrong"),
    ):
        rows = np.eye(3)
        rows[2] = (0, share, np.sqrt(1 - share**2))
        with pytest.raises(
            ValueError, match=f"rows y and z have dot product {share}, not 0. {message}"
        ):
            check_dcm(rows)


def test_every_kind_of_reflection_is_found():
    for dcm in random_dcms(20, 3):
        for mirror in (
            dcm * [1, 1, -1],
            dcm * [[-1], [1], [1]],
            -dcm,
            dcm[[1, 0, 2]],
            dcm[:, [0, 2, 1]],
        ):
            with pytest.raises(
                ValueError, match="orthogonal but left-handed: its determinant is -1, not"
            ):
                check_dcm(mirror)
            with pytest.raises(ValueError, match="not orthogonal: row . has length 1.5"):
                check_dcm(1.5 * mirror)


# --- the nearest valid matrix ---------------------------------------------------------------------


def test_nearest_is_nearer_than_any_other():
    source = np.random.default_rng(5)
    measured = random_dcms(50, 6) + source.normal(scale=0.1, size=(50, 3, 3))
    nearest, distance = nearest_dcm(measured)
    check_dcm(nearest)
    np.testing.assert_allclose(
        distance, np.sqrt(((nearest - measured) ** 2).sum(axis=(1, 2))), rtol=1e-12
    )
    for size in (1e-3, 1e-2, 0.3, 3):
        axes = source.normal(size=(50, 3))
        for sign in (1, -1):
            others = np.array(
                [
                    unit_vectors_after_turn(axis, sign * size, dcm.T).T
                    for axis, dcm in zip(axes, nearest)
                ]
            )
            assert (np.sqrt(((others - measured) ** 2).sum(axis=(1, 2))) > distance).all()


def test_nearest_to_left_handed_numbers_is_right_handed():
    # Two entries of a nearly flat triad measured so badly that the determinant is negative.
    nearest, distance = nearest_dcm(np.diag((1, 0.9, -0.2)))
    np.testing.assert_allclose(nearest, np.eye(3), atol=1e-15)
    assert distance == pytest.approx(np.hypot(0.1, 1.2), rel=1e-14)


def test_valid_matrices_stay_where_they_are():
    dcms = random_dcms(1000, 7)
    nearest, distance = nearest_dcm(dcms)
    assert rotation_error(nearest, dcms) < 3e-15 and distance.max() < 5e-15


def test_a_scaled_matrix_gives_its_orientation():
    dcm = random_dcms(1, 8)[0]
    assert rotation_error(nearest_dcm(1e-6 * dcm).dcm, dcm) < 1e-14
    assert nearest_dcm(1.5 * dcm).distance == pytest.approx(0.5 * np.sqrt(3), rel=1e-12)


@pytest.mark.parametrize(
    "matrix",
    [
        np.diag((1.0, 1.0, -1.0)),
        -np.eye(3),
        np.ones((3, 3)),
        np.diag((1.0, 0.0, 0.0)),
    ],
)
def test_no_unique_nearest_matrix_is_an_error(matrix):
    with pytest.raises(ValueError, match="equally near to matrix: its singular values"):
        nearest_dcm(matrix)
    with pytest.raises(ValueError, match=r"matrix \(item \[1\]\): its singular values"):
        nearest_dcm(np.stack([1e-11 * np.eye(3), matrix]))
