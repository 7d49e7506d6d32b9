"""Orientation from sensors, motion and means, against the package ahrs, which
others wrote for the same purposes.

Four of its parts are no judges, as of 0.3.1: its QUEST squares a matrix entry by entry and never
begins Newton's method, its ``sarabandi`` and ``angular_distance`` disagree with SciPy, and its
Mahony filter loses the recording.
"""

import warnings

import numpy as np
import pytest

with warnings.catch_warnings():  # of its docstrings, where it has never been imported before
    warnings.simplefilter("ignore")
    import ahrs
    from ahrs.common.orientation import hughes, itzhack, shepperd, slerp
    from ahrs.filters import TRIAD, AngularRate, Davenport
    from ahrs.utils import metrics

from orientations import random_unit_vectors

from orientation import (
    angle_between,
    dcm_from_directions,
    dcm_from_quaternion,
    dcm_from_rotation_vector,
    dcm_from_two_directions,
    dcms_after_turns,
    interpolate_quaternions,
    mean_orientation,
    quaternion_from_dcm,
    random_orientations,
)

TURNS = random_orientations(30, 3)


def noisy(dcm, directions, seed, size):
    return directions @ dcm.T + size * np.random.default_rng(seed).normal(size=directions.shape)


@pytest.mark.parametrize("seed", range(5))
def test_two_directions_as_its_triad(seed):
    known = random_unit_vectors(2, seed)
    seen = noisy(TURNS[seed], known, seed, 0.05)
    theirs = TRIAD(v1=known[0], v2=known[1]).estimate(*seen)
    assert abs(dcm_from_two_directions(seen, known) - theirs).max() < 1e-14
    # The order counts.
    assert abs(dcm_from_two_directions(seen[::-1], known[::-1]) - theirs).max() > 1e-3


@pytest.mark.parametrize("seed", range(5))
def test_weighted_directions_as_its_davenport(seed):
    weights = np.array([3.0, 1.0])
    judge = Davenport(magnetic_dip=60.0, weights=weights, gravity=9.8)
    known = np.array([judge.g_q, judge.m_q])
    seen = noisy(TURNS[seed], known, seed, 0.05)
    # NumPy returns complex eigenvectors since 2.5, also where all are real.
    theirs = np.real(judge.estimate(*seen))
    theirs = dcm_from_quaternion(theirs / np.linalg.norm(theirs))
    # It takes the lengths as they are, here they are taken off: so they count as weights.
    lengths = np.linalg.norm(known, axis=1) * np.linalg.norm(seen, axis=1)
    ours = dcm_from_directions(seen, known, 1 / np.sqrt(weights * lengths))
    assert angle_between(ours, theirs) < 1e-10
    assert angle_between(dcm_from_directions(seen, known, 1 / np.sqrt(lengths)), theirs) > 1e-6


def test_its_matrices_are_transposes_and_its_quaternions_ours():
    for dcm, quaternion in zip(TURNS, quaternion_from_dcm(TURNS), strict=True):
        assert abs(ahrs.Quaternion(quaternion).to_DCM().T - dcm).max() < 1e-14
        for back in (shepperd, itzhack, hughes):
            found = np.real(back(dcm))
            assert angle_between(dcm_from_quaternion(found / np.linalg.norm(found)), dcm) < 1e-6, (
                back.__name__
            )


def test_a_gyroscope_is_integrated_as_it_does():
    rates, step = np.random.default_rng(4).normal(size=(300, 3)), 0.01
    theirs = AngularRate(
        gyr=rates, frequency=1 / step, method="closed", q0=np.array([1.0, 0, 0, 0])
    ).Q
    ours = dcms_after_turns(np.eye(3), step * rates[1:])  # of the first sample it keeps the start
    assert angle_between(dcm_from_quaternion(theirs), ours).max() < 1e-12


def test_distances_means_and_ways_between():
    first, second = TURNS[:15], TURNS[15:]
    angles = angle_between(first, second)
    q, p = quaternion_from_dcm(first), quaternion_from_dcm(second)
    for k, angle in enumerate(angles):
        assert metrics.chordal(first[k], second[k]) == pytest.approx(
            np.sqrt(8) * np.sin(angle / 2), abs=1e-12
        )
        assert metrics.qdist(q[k], p[k]) == pytest.approx(2 * np.sin(angle / 4), abs=1e-12)
    scattered = (
        dcm_from_rotation_vector(np.random.default_rng(5).normal(scale=0.4, size=(20, 3)))
        @ TURNS[0]
    )
    mean = np.real(ahrs.QuaternionArray(quaternion_from_dcm(scattered)).average())
    assert angle_between(dcm_from_quaternion(mean), mean_orientation(scattered)) < 1e-12
    shares = np.linspace(0, 1, 11)
    theirs = slerp(q[0], p[0], shares)
    theirs = theirs / np.linalg.norm(theirs, axis=1, keepdims=True)
    ours = dcm_from_quaternion(interpolate_quaternions(q[0], p[0], shares))
    assert angle_between(dcm_from_quaternion(theirs), ours).max() < 1e-7
