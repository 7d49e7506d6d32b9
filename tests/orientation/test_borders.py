"""The border to SciPy: one transpose, in one place. (The border to SymPy is
Frames.reference_frames.)
"""

import numpy as np
import pytest
import sympy as sm
from orientations import random_dcms, rotation_error
from scipy.spatial.transform import Rotation

import orientation
from orientation import (
    SEQUENCES,
    SymbolsNotPossible,
    dcm_from_body_fixed,
    dcm_from_scipy_rotation,
    dcm_from_space_fixed,
    scipy_rotation_from_dcm,
    simple_dcm,
)


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_euler_angles_keep_their_meaning_across_the_border(sequence):
    angles = np.random.default_rng(1).uniform(-3, 3, (200, 3))
    body, space = (
        Rotation.from_euler(sequence.upper(), angles),
        Rotation.from_euler(sequence, angles),
    )
    assert (
        rotation_error(dcm_from_scipy_rotation(body), dcm_from_body_fixed(angles, sequence)) < 1e-14
    )
    assert (
        rotation_error(dcm_from_scipy_rotation(space), dcm_from_space_fixed(angles, sequence))
        < 1e-14
    )
    there = scipy_rotation_from_dcm(dcm_from_body_fixed(angles, sequence))
    assert (there * body.inv()).magnitude().max() < 1e-14


@pytest.mark.parametrize("shape", [(), (1,), (7,), (0,), (2, 3), (2, 1, 3)])
def test_there_and_back(shape):
    count = int(np.prod(shape, dtype=int))
    dcms = random_dcms(max(count, 1), 4)[:count].reshape(*shape, 3, 3)
    rotation = scipy_rotation_from_dcm(dcms)
    assert isinstance(rotation, Rotation)
    back = dcm_from_scipy_rotation(rotation)
    assert back.shape == dcms.shape
    np.testing.assert_allclose(back, dcms, atol=1e-14)
    np.testing.assert_allclose(rotation.as_matrix(), dcms.swapaxes(-1, -2), atol=1e-14)


@pytest.mark.parametrize(
    "function, argument, error, words",
    [
        (
            scipy_rotation_from_dcm,
            simple_dcm("z", sm.Symbol("theta")),
            SymbolsNotPossible,
            "dcm holds cos",
        ),
        (scipy_rotation_from_dcm, -np.eye(3), ValueError, "left-handed"),
        *(
            (dcm_from_scipy_rotation, wrong, TypeError, f"must be a SciPy Rotation, not {kind}")
            for wrong, kind in ((np.eye(3), "ndarray"), ("zxy", "str"), (None, "NoneType"))
        ),
    ],
)
def test_what_does_not_cross(function, argument, error, words):
    with pytest.raises(error, match=words):
        function(argument)


def test_exact_numbers_cross():
    np.testing.assert_allclose(
        scipy_rotation_from_dcm(simple_dcm("z", sm.pi / 6)).as_rotvec(), (0, 0, np.pi / 6)
    )


def test_frames_are_oriented_by_a_scipy_rotation():
    rotation = Rotation.from_euler("ZXY", (0.1, 0.2, 0.3))
    frames = orientation.Frames().orient_scipy_rotation("A", "N", rotation)
    np.testing.assert_allclose(
        frames.dcm("A", "N"), orientation.dcm_from_body_fixed((0.1, 0.2, 0.3), "zxy"), atol=1e-14
    )
    assert "SciPy rotation" in str(frames.equation("A", "N"))
