"""The package ahrs, which others wrote, has our quaternions and the transposes of our matrices."""

import warnings

import numpy as np

with warnings.catch_warnings():  # of its docstrings, where it has never been imported before
    warnings.simplefilter("ignore")
    import ahrs
    from ahrs.common.orientation import hughes, itzhack, shepperd

from orientation import (
    angle_between,
    dcm_from_quaternion,
    quaternion_from_dcm,
    random_orientations,
)

TURNS = random_orientations(30, 3)


def test_its_matrices_are_transposes_and_its_quaternions_ours():
    for dcm, quaternion in zip(TURNS, quaternion_from_dcm(TURNS), strict=True):
        assert abs(ahrs.Quaternion(quaternion).to_DCM().T - dcm).max() < 1e-14
        for back in (shepperd, itzhack, hughes):
            found = np.real(back(dcm))
            assert angle_between(dcm_from_quaternion(found / np.linalg.norm(found)), dcm) < 1e-6, (
                back.__name__
            )
