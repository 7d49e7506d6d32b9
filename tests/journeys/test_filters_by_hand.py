"""An engineer and a reader use the filter of chapter 19."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from orientation import MultiplicativeKalmanFilter


def test_an_engineer_writes_the_filter_from_the_page_in_another_style():
    """Write the fourteen lines in another style: active rotations of SciPy, the error of Sola."""
    random = np.random.default_rng(3)
    R, b = Rotation.random(random_state=4), np.zeros(3)
    P = np.diag([0.04] * 3 + [0.0025] * 3)
    estimate = MultiplicativeKalmanFilter(R.as_matrix().T, P, 0.01, 0.002)
    directions = np.array([[0, 0, 1.0], [0.6, 0, -0.8]])

    def cross(v):
        return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])

    def update(P, R, b, nu, H, V):
        S = H @ P @ H.T + V
        square = nu @ np.linalg.solve(S, nu)
        if square > 9.21:
            return P, R, b, square
        K = P @ H.T @ np.linalg.inv(S)
        dx = K @ nu
        P = P - K @ H @ P
        G = np.eye(6)
        G[:3, :3] += cross(dx[:3]) @ cross(dx[:3]) / 6 - cross(dx[:3]) / 2
        return G @ P @ G.T, R * Rotation.from_rotvec(dx[:3]), b + dx[3:], square

    for k in range(120):
        rate, h = random.normal(size=3), 0.02
        turn = Rotation.from_rotvec((rate - b) * h)
        R = R * turn
        F = np.eye(6)
        F[:3, :3], F[:3, 3:] = turn.as_matrix().T, -h * np.eye(3)
        P = F @ P @ F.T + np.diag([0.01**2 * h] * 3 + [0.002**2 * h] * 3)
        estimate.turn(rate, h)
        for n in directions:
            y = R.inv().apply(n) + 0.05 * random.normal(size=3)
            y /= np.linalg.norm(y)
            H = np.hstack([cross(R.inv().apply(n)), np.zeros((3, 3))])
            P, R, b, square = update(P, R, b, y - R.inv().apply(n), H, 0.05**2 * np.eye(3))
            innovation = estimate.observe(y, n, 0.05, gate=9.21)
            assert innovation.normalised_square == pytest.approx(square, rel=1e-6)
        if k % 40 == 39:
            star = R * Rotation.from_rotvec(0.01 * random.normal(size=3))
            nu = (R.inv() * star).as_rotvec()
            V, H = 1e-4 * np.diag([1, 2, 3.0]), np.eye(3, 6)
            P, R, b, _ = update(P, R, b, nu, H, V)
            estimate.observe_dcm(star.as_matrix().T, V, gate=9.21)
    assert np.abs(estimate.dcm - R.as_matrix().T).max() < 1e-9
    assert np.abs(estimate.bias - b).max() < 1e-9
    np.testing.assert_allclose(estimate.covariance, P, rtol=1e-6, atol=1e-12)


def test_a_reader_moves_the_steel_and_the_gate(browser, site):
    """Use the keyboard on the page as it is built."""
    page = browser.new_page(viewport={"width": 1300, "height": 900})
    page.goto(f"{site}/chapters/orientation-filters.html")
    figure = page.locator(".moving[data-figure=gate]")
    figure.scroll_into_view_if_needed()
    slider, gate = figure.get_by_role("slider"), figure.get_by_role("combobox")
    slider.focus()
    stage = figure.locator(".stage").first
    worst = lambda: float(stage.inner_text().partition("the worst is ")[2].partition("°")[0])
    without = worst()
    assert without > 35
    gate.select_option("0.01")
    page.wait_for_function(
        "was => !document.querySelector('.moving[data-figure=gate]')"
        ".innerText.includes(`the worst is ${was}°`)",
        arg=without,
    )
    strong = worst()
    assert strong < 8
    slider.focus()
    for _ in range(4):
        page.keyboard.press("ArrowLeft")
    assert slider.input_value() == "2"
    page.wait_for_function(
        "was => !document.querySelector('.moving[data-figure=gate]')"
        ".innerText.includes(`the worst is ${was}°`)",
        arg=strong,
    )
    assert worst() > strong  # weak steel passes the gate
    page.close()
