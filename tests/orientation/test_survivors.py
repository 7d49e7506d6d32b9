"""Changes of the mathematics that no other test had noticed. `make mutants` looks for more."""

import mpmath
import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from orientation import (
    angle_between,
    dcm_from_axis_angle,
    dcm_from_rotation_vector,
    interpolate_quaternions,
    mean_orientation,
    random_orientations,
    rotation_vector_from_dcm,
    same_orientation,
)

# ---- between two orientations ------------------------------------------------------------------


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


# ---- very small turns --------------------------------------------------------------------------


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


# ---- the mean of far orientations --------------------------------------------------------------


def cost(vector, dcms, weights):
    return weights @ angle_between(dcms, dcm_from_rotation_vector(vector)) ** 2


@pytest.mark.parametrize("seed", [16, 21, 41, 43])
def test_the_mean_of_far_orientations_is_the_best_of_all(seed):
    """Beyond a quarter turn, averaging from the first guess need not lead to the best mean."""
    dcms, weights = random_orientations(4, seed), np.full(4, 0.25)
    mean = mean_orientation(dcms, metric="angle")
    starts = Rotation.random(12, random_state=seed).as_rotvec()
    best = min(minimize(cost, start, (dcms, weights), method="Nelder-Mead").fun for start in starts)
    assert weights @ angle_between(dcms, mean) ** 2 <= best + 1e-6


def test_a_mean_of_far_orientations_leaves_nothing_to_chance(monkeypatch):
    seeds, generator = [], np.random.default_rng
    monkeypatch.setattr(
        np.random, "default_rng", lambda seed: generator(seeds.append(seed) or seed)
    )
    mean_orientation(random_orientations(4, 16), metric="angle")
    assert seeds and None not in seeds


@pytest.mark.parametrize("metric", ["entries", "angle"])
def test_only_the_shares_of_weights_count_and_a_share_of_none_leaves_one_out(metric):
    dcms = random_orientations(5, 3)
    near = dcms[0] @ dcm_from_rotation_vector(0.3 * np.eye(5, 3))
    dcms, weights = np.concatenate([near, -np.diag([1, 1, -1]) @ near[:1]]), np.arange(1.0, 7)
    weights[5] = 0
    right = mean_orientation(near, weights[:5], metric=metric)
    assert same_orientation(
        mean_orientation(near, metric=metric), mean_orientation(near, np.full(5, 7), metric=metric)
    )
    for scale in (1e-3, 1, 1e3):
        assert same_orientation(mean_orientation(dcms, scale * weights, metric=metric), right)


@pytest.mark.parametrize(
    ("size", "words"), [(1e-155, "too short"), (1e-160, "too short"), (1e152, "too long")]
)
def test_an_axis_whose_square_loses_digits_is_refused(size, words):
    """Its square is still a number, or infinite, and would give a matrix that is no rotation."""
    axis = size * np.array([0.6, 0, 0.8])
    for axes in (axis.tolist(), np.stack([axis] * 3)):
        with pytest.raises(ValueError, match=words):
            dcm_from_axis_angle(axes, 0.3)
    assert same_orientation(
        dcm_from_axis_angle(axis / size * 1e100, 0.3), dcm_from_axis_angle((0.6, 0, 0.8), 0.3)
    )
