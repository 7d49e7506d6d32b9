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
    body_fixed_from_dcm,
    dcm_from_body_fixed,
    dcm_from_space_fixed,
    gimbal_lock_margin,
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
        assert (recovered[:, 0] == 0).all() and recovered[:, 1] == pytest.approx(lock, abs=1e-15)
        one_by_one = [body_fixed_from_dcm(dcm, sequence) for dcm in dcms]
        assert rotation_error(dcm_from_body_fixed(one_by_one, sequence), dcms) < 1e-15
        assert not np.signbit(recovered[recovered == 0]).any()


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


# --- what needs numbers ---------------------------------------------------------------------------


def test_sympy_numbers_are_numbers_on_the_way_back():
    exact = dcm_from_body_fixed((sm.pi / 6, sm.pi / 4, sm.pi / 3), "zxy")
    assert isinstance(exact, sm.MatrixBase)
    np.testing.assert_allclose(
        body_fixed_from_dcm(exact, "zxy"), np.pi / np.array((6, 4, 3)), atol=1e-15
    )
