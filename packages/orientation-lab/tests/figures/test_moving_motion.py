"""The tumbling racket: the integration in Python and in the browser's
language, and the figure in a browser.
"""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from bs4 import BeautifulSoup
from figure_pages import NARROW, drawing, front_end, open_figure, settle, type_number, words  # noqa: F401
from scipy.integrate import solve_ivp

from orientation import (
    angular_velocity_matrix,
    axis_angle_from_dcm,
    body_fixed_from_dcm,
    dcm_from_body_fixed,
    dcm_from_quaternion,
    dcm_from_rotation_vector,
    dcm_rate,
    gimbal_lock_margin,
    multiply_quaternions,
    nearest_dcm,
    quaternion_from_dcm,
    quaternion_rate,
    turns_from_angular_velocity,
)
from orientation_figures.moving import MotionFigure, bundle
from orientation_figures.moving.motion import MOMENTS
from orientation_figures.moving.tumbling import SPIN

NODE = Path(sys.executable).with_name("node")
SETTINGS = ("moments", "axis", "disturbance", "method", "step", "restored")
RUNS = [
    dict(zip(SETTINGS, values))
    for values in (
        (MOMENTS["racket"], "y", 0.01, "Euler", 0.01, False),
        (MOMENTS["racket"], "y", 0.01, "Euler", 0.01, True),
        (MOMENTS["racket"], "y", 0.2, "Runge-Kutta", 0.02, False),
        (MOMENTS["racket"], "y", 0.2, "Runge-Kutta", 0.05, True),
        (MOMENTS["book"], "x", 0.1, "Runge-Kutta", 0.02, False),
        (MOMENTS["book"], "z", 0.3, "Euler", 0.02, True),
        ((5.0, 3.0, 7.5), "z", 0.3, "Runge-Kutta", 0.02, False),
        (MOMENTS["racket"], "y", 0.2, "exponential", 0.05, False),
        (MOMENTS["book"], "y", 0.1, "exponential", 0.02, True),
    )
]
AGREE = 1e-12
FEW_SECONDS = 4.0


# ---- the same integration, written once more from the module's functions -------------------------


def integrated(moments, axis, disturbance, method, step, restored, seconds):
    """Each description at every step, by the textbook's formulas, with the
    angular velocity that SciPy finds.
    """
    moments = np.array(moments)
    start = np.array([SPIN if axis == letter else disturbance for letter in "xyz"])
    solution = solve_ivp(
        lambda t, omega: -np.cross(omega, moments * omega) / moments,
        (0, seconds),
        start,
        "DOP853",
        rtol=1e-13,
        atol=1e-14,
        dense_output=True,
    )

    def angular_velocity(t):
        return solution.sol(t).T

    def rates(state, t):
        matrix, quaternion, angles = state[:9].reshape(3, 3), state[9:13], state[13:]
        omega = angular_velocity(t)
        return np.concatenate(
            [
                dcm_rate(matrix, omega).ravel(),
                quaternion_rate(quaternion, omega),
                np.linalg.solve(angular_velocity_matrix(angles, "zxy"), omega),
            ]
        )

    state = np.concatenate([np.eye(3).ravel(), [1, 0, 0, 0], np.zeros(3)])
    states = [state]
    times = step * np.arange(round(seconds / step) + 1)
    turns = turns_from_angular_velocity(angular_velocity, times)
    for t, turn in zip(times, turns):
        a = rates(state, t)
        if method == "Euler":
            later = state + step * a
        else:
            b = rates(state + step / 2 * a, t + step / 2)
            c = rates(state + step / 2 * b, t + step / 2)
            d = rates(state + step * c, t + step)
            later = state + step / 6 * (a + 2 * b + 2 * c + d)
        if method == "exponential":
            small = dcm_from_rotation_vector(turn)
            later[:9] = (small @ state[:9].reshape(3, 3)).ravel()
            later[9:13] = multiply_quaternions(state[9:13], quaternion_from_dcm(small))
        state = later
        if restored:
            state[:9] = nearest_dcm(state[:9].reshape(3, 3)).dcm.ravel()
            state[9:13] /= np.linalg.norm(state[9:13])
        states.append(state)
    states = np.array(states)
    return {
        "angular_velocity": angular_velocity(times),
        "matrix": states[:, :9].reshape(-1, 3, 3),
        "quaternion": states[:, 9:13],
        "angles": states[:, 13:],
    }


@pytest.mark.sampled(3)
@pytest.mark.parametrize("settings", RUNS, ids=str)
def test_the_figure_integrates_as_the_formulas_say(settings):
    ours = MotionFigure(**settings, time=FEW_SECONDS).run()
    for name, expected in integrated(**settings, seconds=FEW_SECONDS).items():
        assert ours[name].shape == expected.shape
        # The figure finds the angular velocity in steps of a tenth. Angles go through
        # gimbal lock, where errors grow.
        most = 1e-3 if name == "angles" else 2e-6
        assert abs(ours[name] - expected).max() < most, name


def test_the_reference_agrees_with_scipy():
    figure = MotionFigure(moments=MOMENTS["book"], disturbance=0.2, step=0.01, time=6.0)
    moments = np.array(MOMENTS["book"])

    def rate(_, state):
        omega, q = state[:3], state[3:]
        return np.concatenate(
            [-np.cross(omega, moments * omega) / moments, quaternion_rate(q, omega)]
        )

    start = np.concatenate([figure.run()["angular_velocity"][0], [1, 0, 0, 0]])
    truth = solve_ivp(rate, (0, 6), start, "DOP853", rtol=1e-12, atol=1e-13).y[3:, -1]
    assert abs(figure.run()["reference"][-1] - truth).max() < 1e-8


def test_the_racket_flips_about_its_middle_axis_only():
    # What the chapter's program finds: flips after 3.3, 8.5, 13.7 and 18.9 s.
    counts = [
        MotionFigure(method="Runge-Kutta", step=0.04, time=t).flips
        for t in (3.2, 3.4, 8.4, 8.6, 13.6, 13.8, 18.8, 19)
    ]
    assert counts == [0, 1, 1, 2, 2, 3, 3, 4]
    for axis in "xz":
        figure = MotionFigure(axis=axis, step=0.05, time=20, method="Runge-Kutta")
        assert figure.flips == 0 and "does not flip" in repr(figure)


def test_a_run_ends_where_its_numbers_have_no_meaning():
    figure = MotionFigure(step=0.1, disturbance=0.5, axis="x", time=20)
    run = figure.run()
    assert 1 < run["time"][-1] < 19 and len({len(column) for column in run.values()}) == 1
    assert np.isfinite(figure.dcm).all() and abs(figure.dcm).max() <= 1e4
    assert "<svg" in figure.still()


# ---- the widget ----------------------------------------------------------------------------------


@pytest.mark.parametrize("time", (0, 6))
@pytest.mark.parametrize("body, moments", [*MOMENTS.items(), ("block", (5, 3, 8))])
def test_the_still_shows_and_tells(body, moments, time):
    figure = MotionFigure(moments=moments, time=time)
    pictures = BeautifulSoup(figure.still(), "html.parser").find_all("svg", role="img")
    assert [svg["viewbox"] for svg in pictures] == ["-180 -150 360 300", "-180 0 360 356"]
    drawn, plotted = (svg["aria-label"] for svg in pictures)
    assert body in drawn and f"after {time}.0 seconds" in drawn and "not restored" in drawn
    lengths = np.linalg.norm(figure.dcm, axis=1)
    assert ", ".join(f"{length:.2f}" for length in lengths) in drawn
    margins = np.degrees(
        gimbal_lock_margin(
            body_fixed_from_dcm(dcm_from_quaternion(figure.run()["reference"]), "zxy"), "zxy"
        )
    )
    assert f"never less than {margins.min():.0f} degrees" in plotted
    assert figure.still() == MotionFigure(moments=moments, time=time).still()


# ---- the browser's language ----------------------------------------------------------------------


@pytest.fixture(scope="module")
def node(tmp_path_factory):
    """``node(code, data)``: what the code returns of the data, with
    everything of the figure in scope.
    """
    module = "".join(map(bundle.body, bundle.SHARED)) + bundle.whole("motion")

    def run(code, data):
        script = tmp_path_factory.mktemp("node") / "motion.mjs"
        script.write_text(
            "import { readFileSync } from 'node:fs';\n"
            + module
            + "\nconst data = JSON.parse(readFileSync(0));\n"
            f"console.log(JSON.stringify({code}));\n",
            "utf8",
        )
        done = subprocess.run(
            [NODE, script], input=json.dumps(data), capture_output=True, text=True
        )
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    return run


TRAJECTORY = """(({ settings, count }) => {
  const run = new Run(settings);
  while (run.last < count && !run.ended) run.next();
  return { states: run.states, references: run.references, flips: run.flips, ended: Boolean(run.ended),
    faults: Object.keys(DESCRIPTIONS).map((name) => run.states.map((_, k) => run.faultAt(k, name))),
    errors: Object.keys(DESCRIPTIONS).map((name) => run.states.map((_, k) => run.errorAt(k, name))),
    margins: run.states.map((_, k) => run.marginAt(k)) };
})(data)"""


def as_runs(answer):
    states = np.array(answer["states"])
    return {
        "angular_velocity": np.array(answer["references"])[:, :3],
        "quaternion": states[:, :4],
        "matrix": states[:, 4:13].reshape(-1, 3, 3),
        "angles": states[:, 13:],
        "reference": np.array(answer["references"])[:, 3:],
    }


@pytest.mark.sampled(3)
@pytest.mark.parametrize("settings", RUNS, ids=str)
def test_trajectories_agree_to_twelve_digits(node, settings):
    answer = node(
        TRAJECTORY, {"settings": settings, "count": round(FEW_SECONDS / settings["step"])}
    )
    theirs = as_runs(answer)
    figure = MotionFigure(**settings, time=FEW_SECONDS)
    expected = figure.run()
    expected.pop("time")
    for name, values in expected.items():
        assert theirs[name].shape == values.shape
        # About x the angles of zxy go through gimbal lock, where every rounding grows.
        most = 1e-9 if name == "angles" and settings["axis"] == "x" else AGREE
        assert abs(theirs[name] - values).max() < most, name
    assert len(answer["flips"]) == figure.flips


def test_faults_errors_and_margins_agree(node):
    settings = dict(zip(SETTINGS, (MOMENTS["racket"], "y", 0.2, "Euler", 0.02, False)))
    answer = node(TRAJECTORY, {"settings": settings, "count": 150})
    run = MotionFigure(**settings, time=3.0).run()
    truth = dcm_from_quaternion(run["reference"])
    lengths = np.linalg.norm(run["quaternion"], axis=1)
    matrices = (
        run["matrix"],
        dcm_from_quaternion(run["quaternion"] / lengths[:, None]) * lengths[:, None, None] ** 2,
        dcm_from_body_fixed(run["angles"], "zxy"),
    )
    for k, matrix in enumerate(matrices):
        fault = abs(matrix @ matrix.swapaxes(1, 2) - np.eye(3)).max(axis=(1, 2))
        error = axis_angle_from_dcm(nearest_dcm(matrix @ truth.swapaxes(1, 2)).dcm)[1]
        assert abs(np.array(answer["faults"][k]) - fault).max() < 1e-11
        assert abs(np.array(answer["errors"][k]) - error).max() < 1e-11
    margins = np.degrees(gimbal_lock_margin(body_fixed_from_dcm(truth, "zxy"), "zxy"))
    assert abs(np.array(answer["margins"]) - margins).max() < 1e-9


def test_both_end_a_hopeless_run_at_the_same_step(node):
    settings = dict(zip(SETTINGS, (MOMENTS["racket"], "y", 0.5, "Euler", 0.1, False)))
    answer = node(TRAJECTORY, {"settings": settings, "count": 200})
    assert answer["ended"]
    assert len(answer["states"]) == len(MotionFigure(**settings, time=20).run()["time"])


# ---- in a browser --------------------------------------------------------------------------------


def time_of(page):
    return float(page.locator(".player input[type=range]").input_value())


def set_time(page, seconds):
    page.get_by_label("Time in seconds").fill(str(seconds))
    settle(page)


def curves(page):
    return page.eval_on_selector_all(
        ".plot .axis", "(paths) => paths.map((path) => path.getAttribute('d'))"
    )


def table(page):
    return page.eval_on_selector_all(
        ".runs tbody tr", "(rows) => rows.map((row) => row.innerText.trim().split(/\\s*\\t\\s*/))"
    )


def test_a_hopeless_step_says_so(open_figure):
    page = open_figure("motion")
    page.get_by_label("Step in milliseconds").fill("100")
    page.get_by_label("Disturbance in radians per second").fill("0.5")
    page.get_by_label("Time in seconds").fill("20")
    page.wait_for_function("document.querySelector('.words').textContent.includes('smaller steps')")
    assert time_of(page) < 19


@pytest.mark.parametrize(
    "moments, texts",
    [
        ((5, 3, 7), ["middle moment", "smallest moment", "largest moment"]),
        ((5, 5, 7), ["equal to another", "equal to another", "largest moment"]),
    ],
)
def test_the_axes_are_told_apart_by_their_moments(open_figure, moments, texts):
    page = open_figure(MotionFigure(moments=moments, axis="x"))
    options = page.get_by_label("Spin about", exact=True).locator("option").all_text_contents()
    assert options == [f"{axis} ({text})" for axis, text in zip("xyz", texts)]


def test_a_reader_plays_restores_and_changes_the_run(open_figure):
    """What it says is what Python says, and every step of the walk leads back to where it began."""
    page, figure = open_figure("motion"), MotionFigure()
    fault = abs(figure.dcm @ figure.dcm.T - np.eye(3)).max()
    assert f"departs from orthogonality by {float(f'{fault:.2g}'):g}" in words(page)
    assert f"{np.linalg.norm(figure.dcm, axis=1).max():.3g} long" in words(page)
    assert [row[0] for row in table(page)] == ["Matrix", "Quaternion", "Euler angles"]
    assert table(page)[0][1] == f"{float(f'{fault:.2g}'):g}"
    for name, value_text in (
        ("Time", "Time, 6 seconds"),
        ("Step", "Step, 10 milliseconds"),
        ("Disturbance", "Disturbance, 0.01 radians per second"),
        ("Moment of inertia about y", "Moment of inertia about y, 16 gram square metres"),
    ):
        slider = page.locator(f'input[type=range][aria-label="{name}"]')
        assert slider.get_attribute("aria-valuetext") == value_text
    page.wait_for_function(
        "document.querySelector('[role=status]').textContent.startsWith('After 6.0 s')"
    )
    drifted = curves(page)
    page.get_by_label("Restore after every step").check()
    settle(page)
    assert curves(page)[:2] != drifted[:2]
    assert [row[1] for row in table(page)] == ["< 10⁻¹⁵"] * 3
    page.get_by_label("Restore after every step").uncheck()
    settle(page)
    assert curves(page) == drifted
    field = {axis: f"Moment of inertia about {axis} in gram square metres" for axis in "xyz"}
    before = curves(page), drawing(page)
    type_number(page, field["z"], 20)
    shown_words = words(page)
    assert (
        shown_words.startswith("No body has the moments of inertia 1.2, 16, 20")
        and "sum of the others, 17.2" in shown_words
    )
    assert "Still drawn: 1.2, 16, 17" in shown_words and (curves(page), drawing(page)) == before
    assert page.locator(".slider.refused").count() == 3
    assert page.get_by_label(field["z"]).input_value() == "20", "the reader's number is taken away"
    # The way to moments that are possible may lead through some that are not.
    type_number(page, field["x"], 5)
    assert page.locator(".slider.refused").count() == 0 and curves(page) != before[0]
    figure = MotionFigure(moments=(5, 16, 20))
    fault = abs(figure.dcm @ figure.dcm.T - np.eye(3)).max()
    assert table(page)[0][1] == f"{float(f'{fault:.2g}'):g}" and "the block" in words(page)
    type_number(page, field["z"], 0.5)
    page.get_by_role("button", name="a racket").click()
    assert (
        "the racket has flipped once" in words(page)
        and page.locator(".slider.refused").count() == 0
    )
    assert (curves(page), drawing(page)) == before
    page.get_by_role("button", name="Reset").click()
    settle(page)
    assert time_of(page) == 0 and all("L" not in data for data in curves(page))
    page.get_by_role("button", name="Play").click()
    page.wait_for_function("document.querySelector('.player input').value > 1")
    page.get_by_role("button", name="Pause").click()
    page.get_by_role("button", name="Play").wait_for()
    settle(page)
    stopped = time_of(page)
    assert stopped > 1 and all("L" in data for data in curves(page))
    settle(page)
    assert time_of(page) == stopped
    # Back in what has been computed: the curves stay.
    grown = curves(page)
    set_time(page, 0.5)
    assert curves(page) == grown
    page.get_by_role("button", name="Reset").click()
    settle(page)
    assert time_of(page) == 0 and all("L" not in data for data in curves(page))
    box = page.locator(".plot").bounding_box()
    at = lambda second: box["x"] + box["width"] * (52 + 296 * second / 20) / 360
    page.mouse.move(at(2), box["y"] + 60)
    page.mouse.down()
    page.wait_for_function("Math.abs(document.querySelector('.player input').value - 2) < 0.1")
    page.mouse.move(at(5), box["y"] + 200)
    page.mouse.up()
    page.wait_for_function("Math.abs(document.querySelector('.player input').value - 5) < 0.1")
    before = curves(page)
    for change in (
        lambda: page.get_by_label("Method", exact=True).select_option("Runge-Kutta"),
        lambda: page.get_by_label("Step in milliseconds").fill("50"),
        lambda: page.get_by_label("Disturbance in radians per second").fill("0.2"),
        lambda: page.get_by_role("button", name="a book").click(),
        lambda: page.get_by_label("Moment of inertia about x in gram square metres").fill("8"),
        lambda: page.get_by_label("Spin about", exact=True).select_option("z"),
    ):
        change()
        settle(page)
        after = curves(page)
        assert after != before
        before = after
    assert "the block does not flip" in words(page)
    page.get_by_role("radio", name="Euler angles").check()
    page.wait_for_function("document.querySelector('.words').textContent.includes('gimbal lock')")
