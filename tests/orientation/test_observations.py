"""Orientation from observed directions, against SciPy and Monte Carlo."""

import numpy as np
import pytest
from orientations import random_dcms, random_unit_vectors, rotation_error
from scipy.spatial.transform import Rotation

from orientation import (
    dcm_from_directions,
    dcm_from_rotation_vector,
    dcm_from_two_directions,
    directions_covariance,
    rotation_vector_from_dcm,
)


def seen(dcm, directions):
    """Return directions of N along the body: the matrix times each direction."""
    return np.einsum("...ij,kj->...ki", dcm, directions)


def test_two_directions_give_the_orientation_back():
    dcms = random_dcms(500, 1)
    reference = random_unit_vectors(2, 3)
    assert rotation_error(dcm_from_two_directions(seen(dcms, reference), reference), dcms) < 1e-14
    assert rotation_error(dcm_from_directions(seen(dcms, reference), reference), dcms) < 1e-14


def test_the_first_of_two_directions_is_met_exactly():
    reference = np.array([[0, 0, 1.0], [1, 0, 0.4]])
    for dcm, wrong in zip(random_dcms(50, 2), random_unit_vectors(50, 4), strict=True):
        observed = seen(dcm, reference)
        observed[1] += 0.2 * wrong
        fitted = dcm_from_two_directions(observed, reference)
        assert np.allclose(fitted @ reference[0], observed[0], atol=1e-14)


@pytest.mark.parametrize("count", [2, 3, 8])
def test_many_directions_fit_as_scipy_fits_them(count):
    source = np.random.default_rng(count)
    for dcm in random_dcms(40, count):
        reference = random_unit_vectors(count, source.integers(10**6))
        deviations = source.uniform(0.001, 0.1, count)
        observed = seen(dcm, reference) + deviations[:, None] * source.normal(size=(count, 3))
        observed /= np.linalg.norm(observed, axis=1, keepdims=True)
        fitted = dcm_from_directions(observed, reference, deviations)
        scipy = Rotation.align_vectors(observed, reference, weights=deviations**-2.0)[0].as_matrix()
        assert rotation_error(fitted, scipy) < 1e-7


def test_batches_are_single_ones_together():
    dcms, reference = random_dcms(20, 5), random_unit_vectors(4, 6)
    observed = seen(dcms, reference) + 0.05 * np.random.default_rng(7).normal(size=(20, 4, 3))
    together = dcm_from_directions(observed, reference)
    assert np.allclose(
        together, [dcm_from_directions(measured, reference) for measured in observed], atol=1e-14
    )


def test_covariance_is_what_many_noisy_measurements_show():
    """Compare the promised covariance with that of 10,000 noisy sightings, within 5 per cent."""
    source = np.random.default_rng(11)
    dcm = dcm_from_rotation_vector((0.4, -0.9, 1.3))
    reference = np.array([[1, 0, 0], [0.9, 0.3, 0.2], [0.7, -0.5, 0.5]])
    reference /= np.linalg.norm(reference, axis=1, keepdims=True)
    deviations = np.array([0.002, 0.004, 0.003])
    exact = seen(dcm, reference)
    noisy = exact + deviations[:, None] * source.normal(size=(10_000, 3, 3))
    errors = rotation_vector_from_dcm(
        dcm @ dcm_from_directions(noisy, reference, deviations).swapaxes(-1, -2)
    )
    promised = directions_covariance(exact, deviations)
    scale = np.sqrt(np.outer(np.diag(promised), np.diag(promised)))
    assert np.abs(np.cov(errors.T) / scale - promised / scale).max() < 0.05


PARALLEL, NOTHING, GOOD = [[1, 0, 0], [2, 0, 0]], [[1, 0, 0], [0, 0, 0]], np.eye(3)[:2]


@pytest.mark.parametrize(
    "function, arguments, words",
    [
        (dcm_from_two_directions, (PARALLEL, GOOD), "the two observed directions are parallel"),
        (dcm_from_two_directions, (GOOD, PARALLEL), "the two reference directions are parallel"),
        (dcm_from_two_directions, (NOTHING, GOOD), "observed has .* length zero"),
        (dcm_from_two_directions, (GOOD, NOTHING), "reference has .* length zero"),
        (dcm_from_directions, (NOTHING, GOOD), "observed has .* length zero"),
        (dcm_from_directions, (GOOD, NOTHING), "reference has .* length zero"),
        (dcm_from_directions, 2 * ([[1, 0, 0], [-1, 0, 0]],), "one line"),
        (dcm_from_directions, (np.diag([1, 1, -1]), np.eye(3)), "left-handed"),
        (dcm_from_directions, (np.eye(3), np.eye(3), [0.1, 0, 0.1]), "positive"),
        (directions_covariance, ([[1, 0, 0], [1, 0, 0]], [0.1, 0.1]), "one line"),
        (dcm_from_directions, (np.eye(3), GOOD), "the same number of directions"),
        (dcm_from_directions, 2 * (np.eye(3)[0],), "the same number of directions"),
        (dcm_from_directions, 2 * (np.eye(2),), "the same number of directions"),
    ],
)
def test_what_does_not_fix_an_orientation_is_refused(function, arguments, words):
    with pytest.raises(ValueError, match=words):
        function(*arguments)


@pytest.mark.parametrize(
    ("function", "accepted", "refused"),
    [
        (lambda pair: dcm_from_two_directions(pair, pair), 1e-5, 5e-7),
        (lambda pair: dcm_from_directions(pair, pair), 1e-2, 1e-3),
        (lambda pair: dcm_from_directions(pair, pair, [100, 100]), 1e-2, 1e-3),
        (lambda pair: directions_covariance(pair, [0.1, 0.1]), 1e-5, 5e-7),
    ],
)
def test_how_near_two_directions_may_be_does_not_depend_on_lengths_or_units(
    function, accepted, refused
):
    def pair(angle):
        return np.array([[0, 0, 1], [0, np.sin(angle), np.cos(angle)]])

    for lengths in ([[1.0], [1.0]], [[1e-3], [1e4]]):
        assert np.allclose(function(lengths * pair(accepted)), function(pair(accepted)), 1e-4, 1e-9)
        for near in (lengths * pair(refused), [lengths * pair(2), lengths * pair(refused)]):
            with pytest.raises(ValueError, match="parallel|one line"):
                function(np.array(near))
