"""The errors of the orientation filter are as large as its covariance says."""

import numpy as np
import pytest
from orientations import random_dcms

from orientation import (
    MultiplicativeKalmanFilter,
    dcm_from_rotation_vector,
    rotation_vector_from_dcm,
    smooth,
)

GYROSCOPE_NOISE, BIAS_NOISE, STEP = 0.01, 0.002, 0.02
REFERENCES = {"up": ((0, 0, 1.0), 0.03), "north": ((0.6, 0, -0.8), 0.08)}


def flight(runs, seconds, seed):
    """Simulate true orientations and biases of many flights, and their instruments, by steps."""
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
    """Return a filter whose first error is as large as its covariance says."""
    source = np.random.default_rng(seed)
    covariance = np.diag([0.2**2] * 3 + [0.05**2] * 3)
    wrong = dcm_from_rotation_vector(0.2 * source.normal(size=(len(dcm), 3)))
    return MultiplicativeKalmanFilter(wrong @ dcm, covariance, GYROSCOPE_NOISE, BIAS_NOISE)


def normalised_errors(estimate, dcm, bias):
    """Return the squares of the errors, each normalised by its covariance."""
    turned = rotation_vector_from_dcm(dcm @ estimate.dcm.swapaxes(-1, -2))
    error = np.concatenate([turned, bias - estimate.bias], axis=-1)
    return np.einsum("ni,nij,nj->n", error, np.linalg.inv(estimate.covariance), error)


def follow(runs=200, seconds=20, seed=1):
    squares, estimate = [], None
    for number, (dcm, bias, measured, directions) in enumerate(flight(runs, seconds, seed)):
        if estimate is None:
            # The flight's first step is taken from the truth: the filter starts beside it.
            estimate = first_estimate(dcm, seed + 1)
            continue
        estimate.turn(measured, STEP)
        for name, direction in directions.items():
            reference, deviation = REFERENCES[name]
            estimate.observe(direction, np.broadcast_to(reference, direction.shape), deviation)
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


def kalman_filters(shape, source):
    """Return a filter with a bias, of a batch of any shape, with different values everywhere."""
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
    """Return the derivative of a vector by small rotations of the body."""
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
        # Use the inverses of the covariances, another way than the gain.
        after = np.linalg.inv(np.linalg.inv(P[k]) + information @ H)
        difference = seen - dcm[k] @ known
        change = after @ information @ difference
        S = H @ P[k] @ H.T + deviation[k] ** 2 * eye
        reset = np.eye(6)
        reset[:3, :3] = by_differences(
            # The error that remains after a correction, if the whole error was a little larger.
            lambda turn: rotation_vector_from_dcm(
                dcm_from_rotation_vector(change[:3] + rotation_vector_from_dcm(turn))
                @ dcm_from_rotation_vector(-change[:3])
            )
        )
        reached = estimate.covariance[k]
        for computed, right in (
            (innovation.difference[k], difference),
            (innovation.covariance[k], S),
            (innovation.normalised_square[k], difference @ np.linalg.inv(S) @ difference),
            (estimate.dcm[k], dcm_from_rotation_vector(change[:3]) @ dcm[k]),
            (estimate.bias[k], bias[k] + change[3:]),
        ):
            np.testing.assert_allclose(computed, right, rtol=1e-8, atol=1e-9)
        # The filter resets to second order in the correction.
        third_order = np.linalg.norm(change[:3]) ** 3 * np.abs(after).max()
        assert np.abs(reached - reset @ after @ reset.T).max() < third_order
        assert np.abs(reached - after).max() > 0


def test_a_filter_keeps_its_own_numbers_and_refuses_what_is_no_orientation():
    covariance = np.eye(6)
    estimate = MultiplicativeKalmanFilter(random_dcms(3, 1), covariance, 0.1, 0.1)
    assert estimate.bias.shape == (3, 3) and not estimate.bias.any()
    estimate.covariance[0] = 7
    assert (covariance == np.eye(6)).all() and (estimate.covariance[1] == np.eye(6)).all()
    with pytest.raises(ValueError, match="dcm is not orthogonal"):
        MultiplicativeKalmanFilter(2 * np.eye(3), covariance, 0.1, 0.1)
    with pytest.raises(ValueError, match="observed has a direction of length zero"):
        estimate.observe(np.zeros((3, 3)), (0, 0, 1.0), 0.1)


def test_a_gate_leaves_alone_what_it_rejects_and_says_so():
    batch = np.broadcast_to(np.eye(3), (3, 3, 3))
    gated, open_to_all = (
        MultiplicativeKalmanFilter(batch, 1e-4 * np.eye(6), 0.01, 0.001) for _ in range(2)
    )
    seen = np.array([[0, 0, 1.0], [0, 0.02, 1.0], [0, 0.5, 1.0]])
    innovation = gated.observe(seen, (0, 0, 1.0), 0.01, gate=9.21)
    others = open_to_all.observe(seen, (0, 0, 1.0), 0.01)
    assert innovation.accepted.tolist() == [True, True, False] and others.accepted.all()
    assert (innovation.normalised_square == others.normalised_square).all()
    assert (gated.dcm[2] == np.eye(3)).all() and not gated.bias[2].any()
    np.testing.assert_allclose(gated.covariance[2], 1e-4 * np.eye(6), atol=1e-18)
    assert (gated.dcm[:2] == open_to_all.dcm[:2]).all()
    assert np.abs(open_to_all.dcm[2] - np.eye(3)).max() > 0.1


@pytest.mark.parametrize(("freedom", "gate"), [(2, 9.21034), (3, 11.34487)])
def test_an_honest_filter_rejects_one_in_a_hundred(freedom, gate):
    """Test directions and whole orientations, twenty thousand of each."""
    count, random = 20_000, np.random.default_rng(9)
    P = np.diag([4e-4, 1e-4, 2e-4])
    truth = random_dcms(count, 4)
    wrong = dcm_from_rotation_vector(-random.multivariate_normal(np.zeros(3), P, count))
    whole = np.zeros((6, 6))
    whole[:3, :3], whole[3:, 3:] = P, 1e-6 * np.eye(3)
    estimate = MultiplicativeKalmanFilter(wrong @ truth, whole, 0.01, 0.001)
    if freedom == 2:
        seen = truth @ [0, 0.6, 0.8] + 0.01 * random.normal(size=(count, 3))
        innovation = estimate.observe(seen, (0, 0.6, 0.8), 0.01, gate)
    else:
        noise = random.multivariate_normal(np.zeros(3), 2 * P, count)
        innovation = estimate.observe_dcm(dcm_from_rotation_vector(-noise) @ truth, 2 * P, gate)
    assert abs(innovation.normalised_square.mean() / freedom - 1) < 0.02
    assert 0.007 < 1 - innovation.accepted.mean() < 0.013


def test_a_smoother_is_the_least_squares_of_all_that_was_seen():
    """For small errors about one axis, compare with a single linear problem for all times."""
    random, steps, h, q, s = np.random.default_rng(2), 12, 0.1, 1e-4, 2e-4
    p, b = 1e-3, 1e-3
    estimate = MultiplicativeKalmanFilter(
        np.eye(3), np.diag([1e-12, 1e-12, p**2, 1e-18, 1e-18, b**2]), q, s
    )
    rates, seen = 1e-4 * random.normal(size=steps), 1e-4 * random.normal(size=steps)
    predictions = []
    rows, values = [np.eye(2 * steps + 2)[0] / p, np.eye(2 * steps + 2)[1] / b], [0, 0]
    for k in range(steps):
        predictions.append(estimate.turn((0, 0, rates[k]), h))
        now, later = (
            np.eye(2 * steps + 2)[2 * k : 2 * k + 2],
            np.eye(2 * steps + 2)[2 * k + 2 :][:2],
        )
        # The change of the angle differs from the gyroscope's by the bias.
        rows += [(later[0] - now[0] + h * now[1]) / q / h**0.5, (later[1] - now[1]) / s / h**0.5]
        values += [rates[k] * h / q / h**0.5, 0]
        # Measured along the body: a body rotated by an angle about z sees x at minus that angle.
        estimate.observe((1, -seen[k], 0), (1, 0, 0), 1e-4)
        rows.append(later[0] / 1e-4)
        values.append(seen[k] / 1e-4)
    smoothed = smooth(predictions, estimate.state)
    A = np.array(rows)
    covariance = np.linalg.inv(A.T @ A)
    best = covariance @ A.T @ np.array(values)
    np.testing.assert_allclose(rotation_vector_from_dcm(smoothed.dcm)[:, 2], best[::2], atol=1e-9)
    np.testing.assert_allclose(smoothed.bias[:, 2], best[1::2], atol=1e-8)
    for k, place in ((2, 0), (5, 1)):
        np.testing.assert_allclose(
            smoothed.covariance[:, k, k], np.diag(covariance)[place::2], rtol=1e-3
        )
