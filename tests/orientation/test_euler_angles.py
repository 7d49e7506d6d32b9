"""All twelve sequences, in both directions, at and near gimbal lock."""

import numpy as np
import pytest
import sympy as sm
import sympy.physics.mechanics as me
from orientations import angles_near, lock_angles, random_dcms, rotation_error
from scipy.spatial.transform import Rotation

from orientation import (
    PROPER_EULER,
    SEQUENCES,
    TAIT_BRYAN,
    SymbolsNotPossible,
    body_fixed_from_dcm,
    dcm_from_body_fixed,
    dcm_from_space_fixed,
    gimbal_lock_margin,
    simple_dcm,
    space_fixed_from_dcm,
)

psi, theta, phi = SYMBOLS = sm.symbols("psi, theta, varphi")
all_sequences = pytest.mark.parametrize("sequence", SEQUENCES)


def test_the_twelve_sequences():
    allowed = {a + b + c for a in "xyz" for b in "xyz" for c in "xyz" if a != b != c}
    assert set(SEQUENCES) == allowed and len(SEQUENCES) == 12
    assert set(PROPER_EULER) == {sequence for sequence in allowed if sequence[0] == sequence[2]}
    assert set(TAIT_BRYAN) == allowed - set(PROPER_EULER)


# --- from angles to a matrix ----------------------------------------------------------------------


def test_zxy_is_the_matrix_derived_by_hand():
    c1, s1, c2, s2, c3, s3 = (f(x) for x in SYMBOLS for f in (sm.cos, sm.sin))
    by_hand = sm.Matrix(
        [
            [c1 * c3 - s1 * s2 * s3, s1 * c3 + c1 * s2 * s3, -c2 * s3],
            [-s1 * c2, c1 * c2, s2],
            [c1 * s3 + s1 * s2 * c3, s1 * s3 - c1 * s2 * c3, c2 * c3],
        ]
    )
    assert (dcm_from_body_fixed(SYMBOLS, "zxy") - by_hand).expand() == sm.zeros(3)


@all_sequences
def test_body_fixed_is_the_product_of_simple_orientations(sequence):
    first, second, third = (simple_dcm(axis, angle) for axis, angle in zip(sequence, SYMBOLS))
    assert (dcm_from_body_fixed(SYMBOLS, sequence) - third * second * first).expand() == sm.zeros(3)
    assert (dcm_from_space_fixed(SYMBOLS, sequence) - first * second * third).expand() == sm.zeros(
        3
    )


@all_sequences
def test_symbols_agree_with_reference_frames(sequence):
    A, D, S = (me.ReferenceFrame(name) for name in "ADS")
    D.orient_body_fixed(A, SYMBOLS, sequence)
    S.orient_space_fixed(A, SYMBOLS, sequence)
    assert (dcm_from_body_fixed(SYMBOLS, sequence) - D.dcm(A)).expand() == sm.zeros(3)
    assert (dcm_from_space_fixed(SYMBOLS, sequence) - S.dcm(A)).expand() == sm.zeros(3)


@all_sequences
def test_numbers_agree_with_scipy(sequence):
    angles = np.random.default_rng(1).uniform(-10, 10, (1000, 3))
    scipy_body = Rotation.from_euler(sequence.upper(), angles).as_matrix().swapaxes(1, 2)
    scipy_space = Rotation.from_euler(sequence, angles).as_matrix().swapaxes(1, 2)
    assert rotation_error(dcm_from_body_fixed(angles, sequence), scipy_body) < 1e-14
    assert rotation_error(dcm_from_space_fixed(angles, sequence), scipy_space) < 1e-14


# --- and back -------------------------------------------------------------------------------------


def demand_way_back(dcms, sequence, largest=1e-14):
    angles = body_fixed_from_dcm(dcms, sequence)
    first, middle, last = np.moveaxis(angles, -1, 0)
    low, high = (0, np.pi) if sequence[0] == sequence[2] else (-np.pi / 2, np.pi / 2)
    assert (abs(first) <= np.pi).all() and (abs(last) <= np.pi).all()
    assert (low <= middle).all() and (middle <= high).all()
    assert rotation_error(dcm_from_body_fixed(angles, sequence), dcms) < largest
    space = space_fixed_from_dcm(dcms, sequence)
    assert rotation_error(dcm_from_space_fixed(space, sequence), dcms) < largest
    return angles


@all_sequences
def test_way_back_from_anywhere(sequence):
    demand_way_back(random_dcms(5000, 10), sequence)


@all_sequences
def test_way_back_gives_the_angles_themselves_away_from_lock(sequence):
    middle = np.pi / 2 if sequence in PROPER_EULER else 0.0
    angles = angles_near(middle, 2000, 11) * [0.999, 1, 0.999]
    angles[:, 1] += np.random.default_rng(12).uniform(-1.4, 1.4, 2000)
    np.testing.assert_allclose(
        body_fixed_from_dcm(dcm_from_body_fixed(angles, sequence), sequence), angles, atol=2e-14
    )
    np.testing.assert_allclose(
        space_fixed_from_dcm(dcm_from_space_fixed(angles, sequence), sequence), angles, atol=2e-14
    )


@all_sequences
@pytest.mark.parametrize(
    "offset", [0, 1e-16, 1e-15, 1e-14, 1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2, 1e-1]
)
def test_way_back_at_and_near_lock(sequence, offset):
    source = np.random.default_rng(13)
    for lock in lock_angles(sequence):
        dcms = dcm_from_body_fixed(angles_near(lock, 300, 14, offset), sequence)
        demand_way_back(dcms, sequence)
        demand_way_back(dcms + source.uniform(-2.3e-16, 2.3e-16, dcms.shape), sequence)
        # The measured matrix has a larger error; that of the answer must not be much larger.
        demand_way_back(dcms + source.uniform(-1e-10, 1e-10, dcms.shape), sequence, largest=5e-10)


@all_sequences
@pytest.mark.parametrize("zero", [0.0, -0.0])
def test_way_back_at_exact_lock_with_either_zero(sequence, zero):
    quarters = np.arange(-1, 3) * np.pi / 2
    for lock in lock_angles(sequence):
        angles = np.array([(first, lock, last) for first in quarters for last in quarters])
        dcms = dcm_from_body_fixed(angles, sequence).round()
        dcms[dcms == 0] = zero
        recovered = demand_way_back(dcms, sequence, largest=1e-15)
        assert (recovered[:, 0] == 0).all()
        assert recovered[:, 1] == pytest.approx(lock, abs=1e-15)
        one_by_one = [body_fixed_from_dcm(dcm, sequence) for dcm in dcms]
        assert rotation_error(dcm_from_body_fixed(one_by_one, sequence), dcms) < 1e-15
        assert not np.signbit(recovered[recovered == 0]).any()


@all_sequences
def test_way_back_among_the_24_ways_a_cube_fits_its_box(sequence):
    cube = np.unique(
        dcm_from_body_fixed(
            np.stack(np.meshgrid(*3 * [np.arange(4) * np.pi / 2]), -1).reshape(-1, 3), sequence
        ).round()
        + 0.0,
        axis=0,
    )
    assert len(cube) == 24
    first, same = (
        demand_way_back(np.where(cube == 0, zero, cube), sequence, largest=1e-15)[:, 0]
        for zero in (0.0, -0.0)
    )
    assert (first == same).all()


# --- gimbal lock as a quantity --------------------------------------------------------------------


@all_sequences
def test_margin_is_the_angle_between_the_first_and_the_last_axis(sequence):
    angles = np.random.default_rng(15).uniform(-10, 10, (500, 3))
    dcms = dcm_from_body_fixed(angles, sequence)
    # Use both axes along D: the first axis belongs to A, and only the matrix gives it along D.
    first = dcms[:, :, "xyz".index(sequence[0])]
    last = np.eye(3)["xyz".index(sequence[2])]
    between = np.arctan2(np.linalg.norm(np.cross(first, last), axis=1), abs(first @ last))
    np.testing.assert_allclose(gimbal_lock_margin(angles, sequence), between, atol=1e-14)
    assert isinstance(gimbal_lock_margin(angles[0], sequence), float)


@all_sequences
@pytest.mark.parametrize("offset", [0.0, 1e-12, 1e-3, 1.0])
def test_margin_near_lock(sequence, offset):
    for lock in lock_angles(sequence):
        for turn in (0, 2 * np.pi):
            assert gimbal_lock_margin((1, lock + turn + offset, 2), sequence) == pytest.approx(
                offset, abs=2e-15
            )


# --- what needs numbers ---------------------------------------------------------------------------


@pytest.mark.parametrize("function", [body_fixed_from_dcm, space_fixed_from_dcm])
def test_symbols_cannot_be_taken_back(function):
    with pytest.raises(SymbolsNotPossible, match="dcm holds .*psi.* needs numbers"):
        function(dcm_from_body_fixed(SYMBOLS, "zxy"), "zxy")


def test_margin_of_symbols_is_refused():
    with pytest.raises(SymbolsNotPossible, match="angles holds psi"):
        gimbal_lock_margin(SYMBOLS, "zxy")


def test_sympy_numbers_are_numbers_on_the_way_back():
    exact = dcm_from_body_fixed((sm.pi / 6, sm.pi / 4, sm.pi / 3), "zxy")
    assert isinstance(exact, sm.MatrixBase)
    np.testing.assert_allclose(
        body_fixed_from_dcm(exact, "zxy"), np.pi / np.array((6, 4, 3)), atol=1e-15
    )
