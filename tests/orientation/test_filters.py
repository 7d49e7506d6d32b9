"""The filter of an orientation tells the truth about itself: its errors
are as large as its covariance says.
"""

import numpy as np
import pytest
from orientations import random_dcms

from orientation import (
    MultiplicativeKalmanFilter,
    dcm_from_rotation_vector,
    rotation_vector_from_dcm,
)

GYROSCOPE_NOISE, BIAS_NOISE, STEP = 0.01, 0.002, 0.02
REFERENCES = {"up": ((0, 0, 1.0), 0.03), "north": ((0.6, 0, -0.8), 0.08)}


def flight(runs, seconds, seed):
    """True orientations and biases of many flights, and what
    their instruments say, step by step.
    """
    source = np.random.default_rng(seed)
    dcm = random_dcms(runs, seed)
    bias = 0.05 * source.normal(size=(runs, 3))
    phases = source.uniform(0, 2 * np.pi, (runs, 3))
    for number in range(round(seconds / STEP)):
        rate = np.sin(phases + np.array([0.7, 1.1, 0.4]) * number * STEP)
        bias = bias + BIAS_NOISE * np.sqrt(STEP) * source.normal(size=(runs, 3))
        dcm = dcm_from_rotation_vector(rate * STEP) @ dcm
        measured = rate + bias + GYROSCOPE_NOISE / np.sqrt(STEP) * source.normal(size=(runs, 3))
        directions = {}
        if number % 5 == 4:
            for name, (reference, deviation) in REFERENCES.items():
                directions[name] = dcm @ np.array(reference) + deviation * source.normal(
                    size=(runs, 3)
                )
        yield dcm, bias, measured, directions


def first_estimate(dcm, seed):
    """A filter that starts wrong by as much as it believes."""
    source = np.random.default_rng(seed)
    covariance = np.diag([0.2**2] * 3 + [0.05**2] * 3)
    wrong = dcm_from_rotation_vector(0.2 * source.normal(size=(len(dcm), 3)))
    return MultiplicativeKalmanFilter(wrong @ dcm, covariance, GYROSCOPE_NOISE, BIAS_NOISE)


def normalised_errors(estimate, dcm, bias):
    """The squares of the errors, each measured by the covariance that belongs to it."""
    turned = rotation_vector_from_dcm(dcm @ estimate.dcm.swapaxes(-1, -2))
    error = np.concatenate([turned, bias - estimate.bias], axis=-1)
    return np.einsum("ni,nij,nj->n", error, np.linalg.inv(estimate.covariance), error)


def follow(runs=200, seconds=20, seed=1, claimed=1.0):
    squares, estimate = [], None
    for number, (dcm, bias, measured, directions) in enumerate(flight(runs, seconds, seed)):
        if estimate is None:
            # The flight's first step is taken from the truth: the filter starts beside it.
            estimate = first_estimate(dcm, seed + 1)
            continue
        estimate.turn(measured, STEP)
        for name, direction in directions.items():
            reference, deviation = REFERENCES[name]
            estimate.observe(
                direction, np.broadcast_to(reference, direction.shape), claimed * deviation
            )
        if number % 100 == 99:
            squares.append(normalised_errors(estimate, dcm, bias))
    return np.array(squares), estimate


def test_errors_are_as_large_as_the_filter_says():
    from scipy.stats import chi2  # every process collects this file, and one runs it

    squares, _ = follow()
    low, high = chi2.ppf([1e-5, 1 - 1e-5], 6 * squares.shape[1]) / squares.shape[1]
    means = squares.mean(axis=1)
    assert np.all((low < means) & (means < high)), (
        f"means {means} outside {low:.2f} to {high:.2f}, 6 expected"
    )


def test_a_filter_that_claims_too_much_is_found_out():
    """The same test fails for a filter that believes its instruments to be
    three times as good as they are.
    """
    squares, _ = follow(claimed=1 / 3)
    assert squares.mean() > 9


def test_the_bias_is_found_and_matrices_stay_orthogonal():
    _, estimate = follow(runs=20, seconds=40, seed=3)
    assert np.sqrt(estimate.covariance[:, 3, 3]).max() < 0.02
    assert np.abs(estimate.dcm @ estimate.dcm.swapaxes(-1, -2) - np.eye(3)).max() < 1e-12


def test_one_orientation_is_a_batch_of_one():
    single = MultiplicativeKalmanFilter(np.eye(3), 0.01 * np.eye(6), 0.01, 0.001)
    batch = MultiplicativeKalmanFilter(np.eye(3)[None], 0.01 * np.eye(6), 0.01, 0.001)
    for estimate, wrap in ((single, np.array), (batch, lambda value: np.array([value]))):
        estimate.turn(wrap([0.3, -0.2, 1.0]), 0.1)
        estimate.observe(wrap([0.1, 0, 1.0]), wrap([0, 0, 1.0]), 0.05)
    assert np.allclose(single.dcm, batch.dcm[0]) and np.allclose(
        single.covariance, batch.covariance[0]
    )


def kalman_filters(shape, source):
    """A filter with a bias, of a batch of any shape, in which nothing is like anything else."""
    roots = 0.03 * source.normal(size=(*shape, 6, 6))
    estimate = MultiplicativeKalmanFilter(
        random_dcms(max(1, np.prod(shape, dtype=int)), 5).reshape(*shape, 3, 3),
        roots @ roots.swapaxes(-1, -2) + 1e-4 * np.eye(6),
        source.uniform(0.01, 0.1, shape),
        source.uniform(0.01, 0.1, shape),
    )
    estimate.bias = source.normal(size=(*shape, 3))
    return estimate


def by_differences(function):
    """The derivative of a vector by small turns of the body."""
    size = 1e-6
    return np.stack(
        [
            (function(dcm_from_rotation_vector(d)) - function(dcm_from_rotation_vector(-d)))
            / (2 * size)
            for d in size * np.eye(3)
        ],
        axis=-1,
    )


@pytest.mark.parametrize("shape", [(), (1,), (3,), (2, 2)])
def test_each_step_is_kalmans_for_the_model_of_its_docstring(shape):
    source = np.random.default_rng(6)
    estimate, eye = kalman_filters(shape, source), np.eye(3)
    dcm, bias, P = estimate.dcm, estimate.bias, estimate.covariance
    rate, step = source.normal(size=(*shape, 3)), source.uniform(0.1, 0.3, shape)
    estimate.turn(rate, step)
    for k in np.ndindex(shape):
        turned, h = dcm_from_rotation_vector((rate[k] - bias[k]) * step[k]), step[k]
        carried = np.block([[turned, -h * eye], [0 * eye, eye]])
        noise = np.repeat([estimate.gyroscope_noise[k], estimate.bias_noise[k]], 3) ** 2 * h
        np.testing.assert_allclose(estimate.dcm[k], turned @ dcm[k], atol=1e-15)
        np.testing.assert_allclose(
            estimate.covariance[k], carried @ P[k] @ carried.T + np.diag(noise), atol=1e-15
        )
    dcm, P = estimate.dcm, estimate.covariance
    observed, reference = source.normal(size=(2, *shape, 3))
    deviation = source.uniform(0.03, 0.3, shape)
    innovation = estimate.observe(observed, reference, deviation)
    for k in np.ndindex(shape):
        seen, known = (v[k] / np.linalg.norm(v[k]) for v in (observed, reference))
        H = np.hstack([by_differences(lambda turn: turn @ dcm[k] @ known), 0 * eye])
        information = H.T / deviation[k] ** 2
        # By the inverses of the covariances: another way than that of the gain.
        after = np.linalg.inv(np.linalg.inv(P[k]) + information @ H)
        difference = seen - dcm[k] @ known
        change = after @ information @ difference
        S = H @ P[k] @ H.T + deviation[k] ** 2 * eye
        for found, right in (
            (innovation.difference[k], difference),
            (innovation.covariance[k], S),
            (innovation.normalised_square[k], difference @ np.linalg.inv(S) @ difference),
            (estimate.covariance[k], after),
            (estimate.dcm[k], dcm_from_rotation_vector(change[:3]) @ dcm[k]),
            (estimate.bias[k], bias[k] + change[3:]),
        ):
            np.testing.assert_allclose(found, right, rtol=1e-8, atol=1e-9)


def test_a_filter_keeps_its_own_numbers_and_refuses_what_is_no_orientation():
    covariance = np.eye(6)
    estimate = MultiplicativeKalmanFilter(random_dcms(3, 1), covariance, 0.1, 0.1)
    assert estimate.bias.shape == (3, 3) and not estimate.bias.any()
    estimate.covariance[0] = 7
    assert (covariance == np.eye(6)).all() and (estimate.covariance[1] == np.eye(6)).all()
    with pytest.raises(ValueError, match="dcm is not orthogonal"):
        MultiplicativeKalmanFilter(2 * np.eye(3), covariance, 0.1, 0.1)
    with pytest.raises(ValueError, match="observed holds a direction of length zero"):
        estimate.observe(np.zeros((3, 3)), (0, 0, 1.0), 0.1)
