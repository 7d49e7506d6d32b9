"""Rodrigues parameters, distances, means and random orientations.

They are compared with SciPy, pytransform3d and formulas.
"""

import numpy as np
import pytest
import sympy as sm
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from orientation import (
    SymbolsNotPossible,
    angle_between,
    check_dcm,
    dcm_from_modified_rodrigues,
    dcm_from_quaternion,
    dcm_from_rodrigues,
    dcm_from_rotation_vector,
    dcm_from_scipy_rotation,
    mean_orientation,
    modified_rodrigues_from_dcm,
    quaternion_from_dcm,
    random_orientations,
    rodrigues_from_dcm,
    rotation_vector_from_dcm,
    same_orientation,
    scipy_rotation_from_dcm,
    shadow_of_modified_rodrigues,
    simple_dcm,
)

DCMS = random_orientations(300, 3)


# ---- Rodrigues parameters ------------------------------------------------------------------------


def test_rodrigues_parameters_are_the_tangent_of_half_the_angle():
    vectors = rotation_vector_from_dcm(DCMS)
    angles = np.linalg.norm(vectors, axis=1)[:, None]
    assert np.allclose(rodrigues_from_dcm(DCMS), np.tan(angles / 2) * vectors / angles, rtol=1e-9)
    assert np.allclose(
        modified_rodrigues_from_dcm(DCMS), np.tan(angles / 4) * vectors / angles, rtol=1e-12
    )


def test_modified_rodrigues_parameters_agree_with_scipy():
    # Only SciPy's matrix is transposed: its parameters of A in N are ours.
    assert np.allclose(
        scipy_rotation_from_dcm(DCMS).as_mrp(), modified_rodrigues_from_dcm(DCMS), atol=1e-13
    )
    vectors = np.random.default_rng(4).normal(size=(200, 3))
    theirs = dcm_from_scipy_rotation(Rotation.from_mrp(vectors))
    assert abs(dcm_from_modified_rodrigues(vectors) - theirs).max() < 1e-13


def test_the_shadow_is_the_same_orientation_the_other_way_round():
    sigma = modified_rodrigues_from_dcm(DCMS)
    shadow = shadow_of_modified_rodrigues(sigma)
    assert (np.linalg.norm(sigma, axis=1) <= 1).all() and (
        np.linalg.norm(shadow, axis=1) >= 1
    ).all()
    assert abs(dcm_from_modified_rodrigues(shadow) - DCMS).max() < 1e-13
    assert np.allclose(shadow_of_modified_rodrigues(shadow), sigma, rtol=1e-12)
    with pytest.raises(ValueError, match="infinitely long"):
        shadow_of_modified_rodrigues((0, 0, 0))


def test_half_a_turn_has_no_rodrigues_parameters_but_modified_ones():
    half = np.diag([-1.0, -1, 1])
    with pytest.raises(ValueError, match="half a turn"):
        rodrigues_from_dcm(half)
    with pytest.raises(ValueError, match="not orthogonal"):
        rodrigues_from_dcm(2 * half)
    with pytest.raises(ValueError, match=r"dcm \(item \[1\]\) is a rotation through half a turn"):
        rodrigues_from_dcm([np.eye(3), half])
    assert (modified_rodrigues_from_dcm(half) == [0, 0, 1]).all()


def test_rodrigues_parameters_of_symbols_are_rational():
    x, y, z = g = sm.symbols("g_x:z")
    ours = dcm_from_rodrigues(g)
    cross = sm.Matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    cayley = (sm.eye(3) - cross) * (sm.eye(3) + cross).inv()
    assert (ours - cayley).applyfunc(sm.simplify) == sm.zeros(3, 3)
    assert all(entry.is_rational_function(*g) for entry in (*ours, *dcm_from_modified_rodrigues(g)))
    assert same_orientation(
        dcm_from_modified_rodrigues(g), dcm_from_modified_rodrigues(shadow_of_modified_rodrigues(g))
    )
    with pytest.raises(SymbolsNotPossible):
        modified_rodrigues_from_dcm(simple_dcm("x", sm.Symbol("theta")))


# ---- distances -----------------------------------------------------------------------------------


def test_angle_between_agrees_with_scipy_and_keeps_its_digits():
    theirs = (
        scipy_rotation_from_dcm(DCMS[1:]).inv() * scipy_rotation_from_dcm(DCMS[:-1])
    ).magnitude()
    assert np.allclose(angle_between(DCMS[1:], DCMS[:-1]), theirs, atol=1e-13)
    for angle in (1e-12, 1e-7, np.pi - 1e-7, np.pi):
        turned = dcm_from_rotation_vector(angle * np.array([0.6, 0, 0.8])) @ DCMS[0]
        assert abs(angle_between(DCMS[0], turned) - angle) < 1e-14 + 1e-9 * min(angle, 1e-6)
    with pytest.raises(ValueError, match="second"):
        angle_between(np.eye(3), np.diag([1, 1, -1.0]))


# ---- means ---------------------------------------------------------------------------------------


def spread(scale, count=20, seed=6):
    turns = np.random.default_rng(seed).normal(scale=scale, size=(count, 3))
    return dcm_from_rotation_vector(turns) @ DCMS[7]


@pytest.mark.parametrize("weights", (None, np.arange(1.0, 21)))
def test_mean_by_entries_is_the_mean_of_the_quaternions_and_scipys(weights):
    dcms = spread(0.4)
    ours = mean_orientation(dcms, weights)
    q = quaternion_from_dcm(dcms)
    share = np.ones(20) if weights is None else weights
    vector = np.linalg.eigh(np.einsum("k,ki,kj->ij", share, q, q))[1][:, -1]
    assert abs(dcm_from_quaternion(vector) - ours).max() < 1e-13
    assert (
        abs(dcm_from_scipy_rotation(scipy_rotation_from_dcm(dcms).mean(weights)) - ours).max()
        < 1e-12
    )


@pytest.mark.parametrize("metric", ("entries", "angle"))
def test_nothing_near_the_mean_is_better(metric):
    dcms, weights = spread(0.5), np.linspace(1, 3, 20)

    def cost(candidate):
        if metric == "angle":
            return weights @ angle_between(dcms, candidate) ** 2
        return weights @ np.linalg.norm(dcms - candidate, axis=(1, 2)) ** 2

    mean = mean_orientation(dcms, weights, metric)
    check_dcm(mean)
    turns = np.random.default_rng(1).normal(scale=0.01, size=(300, 3))
    assert min(cost(turn @ mean) for turn in dcm_from_rotation_vector(turns)) > cost(mean)


def test_three_headings_have_no_mean_and_it_is_told_by_metric():
    three = simple_dcm("z", np.radians([0, 120, 240]))
    with pytest.raises(ValueError, match="no unique mean by their entries"):
        mean_orientation(three)
    with pytest.raises(
        ValueError, match="no unique mean by angle.*two equally good means are 120 degrees apart"
    ):
        mean_orientation(three, metric="angle")
    # By angle 0 is better than 60: 28,800 against 39,600 square degrees.
    costs = [
        sum(np.degrees(angle_between(three, simple_dcm("z", np.radians(a)))) ** 2) for a in (0, 60)
    ]
    assert np.allclose(costs, [28_800, 39_600])
    # Weights break the tie, whichever is listed first.
    for order in ([0, 1, 2], [2, 0, 1]):
        mean = mean_orientation(three[order], np.array([1, 1, 1.2])[order], "angle")
        assert angle_between(mean, three[2]) < np.radians(20)


def test_two_headings_half_a_turn_apart_have_no_mean():
    for metric in ("entries", "angle"):
        with pytest.raises(ValueError, match="no unique mean"):
            mean_orientation(simple_dcm("z", [0, np.pi]), metric=metric)
    # A tenth of the weight moves the mean by a tenth of the angle, to either side.
    with pytest.raises(
        ValueError, match="no unique mean by angle.*two equally good means are 36 degrees apart"
    ):
        mean_orientation(simple_dcm("z", [0, np.pi]), [9, 1], "angle")


def test_a_mean_does_not_depend_on_the_order_nor_on_one_far_away():
    dcms = np.concatenate([spread(0.2), [dcm_from_rotation_vector((0, 3.0, 0)) @ DCMS[7]]])
    means = [mean_orientation(some, metric="angle") for some in (dcms, dcms[::-1])]
    assert angle_between(*means) < 1e-9


@pytest.mark.parametrize(
    "arguments, words",
    [
        ({"dcms": DCMS[:3], "weights": [1, 2]}, "one for each"),
        ({"dcms": DCMS[:3], "weights": [1, -1, 1]}, "must not be negative"),
        ({"dcms": DCMS[:3], "weights": [0, 0, 0]}, "must not be negative or all zero"),
        ({"dcms": DCMS, "metric": "chordal"}, "metric must be .* not 'chordal'"),
        ({"dcms": np.eye(3)}, r"\(n, 3, 3\)"),
        ({"dcms": np.stack([np.eye(3), 2 * np.eye(3)])}, "item"),
    ],
)
def test_means_refuse_what_they_cannot_read(arguments, words):
    with pytest.raises(ValueError, match=words):
        mean_orientation(**arguments)


# ---- chance --------------------------------------------------------------------------------------


def test_random_orientations_are_uniform():
    """Check the density of the angle, (1 - cos)/pi, the unit vectors, and the mean matrix."""
    dcms = random_orientations(20_000, 9)
    check_dcm(dcms)
    angles = np.sort(angle_between(dcms, np.eye(3)))
    distribution = (angles - np.sin(angles)) / np.pi
    assert abs(distribution - np.linspace(0, 1, 20_000)).max() < 1.63 / np.sqrt(20_000), (
        "Kolmogorov-Smirnov, 1 per cent"
    )
    assert abs(dcms.mean(axis=0)).max() < 4 / np.sqrt(3 * 20_000)
    assert (random_orientations(5, 1) == random_orientations(5, 1)).all()
    assert random_orientations(0, 1).shape == (0, 3, 3)


# ---- means of far orientations -------------------------------------------------------------------


def cost(vector, dcms, weights):
    return weights @ angle_between(dcms, dcm_from_rotation_vector(vector)) ** 2


@pytest.mark.parametrize("seed", [16, 43])
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
