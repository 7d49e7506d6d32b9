"""The chain of turns and the quaternion with its double: in Python, and in
the browser by keys, touch and mouse.
"""

import math
import re

import numpy as np
import pytest
from bs4 import BeautifulSoup
from figure_pages import (  # noqa: F401
    NARROW,
    WIDE,
    drag_with_a_finger,
    front_end,
    middle,
    numbers,
    open_figure,
    settle,
    words,
)
from orientations import random_unit_vectors, rotation_error
from scipy.spatial.transform import Rotation

from orientation import angular_velocity_matrix, dcm_from_body_fixed, dcm_from_space_fixed
from orientation_figures.moving import MotionFigure, QuaternionFigure, SuccessiveFigure

RIGHT_ANGLES = (("z", math.pi / 2), ("x", math.pi / 2))
FOUR = (("z", 0.5), ("x", -0.6), ("y", 2.7), ("z", -1.9))
CHAINS = [
    {},
    {"turns": RIGHT_ANGLES, "compare": "1 and 2 exchanged"},
    {"turns": FOUR, "compare": "2 and 3 exchanged"},
    {"turns": FOUR, "fixed": "space", "compare": "body and space fixed"},
    {"turns": (("y", math.pi),), "fixed": "space"},
]
ENDS = [
    {},
    {"first": (0.3, 1.2, -0.4), "second": (-0.9, -0.2, 2.0), "share": 0.7, "unit_vector": "z"},
    {"first": (0.3, math.pi / 2, -0.4), "second": (1.3, 0.2, 0.5), "share": 0.25},
    {"first": (0, 0, 0), "second": (3.1, 0, 0), "share": 0.4, "unit_vector": "x"},
]


# In Python.


def numbers_in(text):
    return [float(number) for number in re.findall(r"-?\d+\.\d+", text)]


@pytest.mark.parametrize("seed", range(4))
def test_chain_is_the_products_of_the_module(seed):
    angles = np.random.default_rng(seed).uniform(-3, 3, 3)
    turns = list(zip("zxy", angles))
    assert (
        rotation_error(SuccessiveFigure(turns=turns).dcm, dcm_from_body_fixed(angles, "zxy"))
        < 1e-14
    )
    assert (
        rotation_error(
            SuccessiveFigure(turns=turns, fixed="space").dcm, dcm_from_space_fixed(angles, "zxy")
        )
        < 1e-14
    )


def test_chain_compared_with_the_exchanged_one():
    figure = SuccessiveFigure(turns=RIGHT_ANGLES, compare="1 and 2 exchanged")
    assert np.allclose(figure.dcm, [[0, 1, 0], [0, 0, 1], [1, 0, 0]])
    assert rotation_error(figure.other, SuccessiveFigure(turns=RIGHT_ANGLES[::-1]).dcm) < 1e-15
    # Each is a third of a turn about a corner of the cube; so is the turn between them.
    assert math.degrees(figure.angle_between) == pytest.approx(120)
    figure.compare = "body and space fixed"
    assert (
        rotation_error(figure.other, SuccessiveFigure(turns=RIGHT_ANGLES, fixed="space").dcm)
        < 1e-15
    )
    figure.compare = "nothing"
    assert figure.other is None and figure.angle_between is None


@pytest.mark.parametrize("axis", random_unit_vectors(3, 8))
def test_one_turn_leads_to_the_other_quaternion(axis):
    figure = QuaternionFigure(axis=axis, angle=0.8)
    start, dcm = figure.quaternion, figure.dcm
    figure.angle += 2 * math.pi
    assert np.allclose(figure.quaternion, -start, atol=1e-14)
    assert rotation_error(figure.dcm, dcm) < 1e-14
    assert np.allclose(figure.dcm, Rotation.from_rotvec(0.8 * axis).as_matrix().T, atol=1e-14)


@pytest.mark.parametrize("ends", ENDS)
def test_three_ways_between_two_orientations(ends):
    figure = QuaternionFigure(view="way", **ends)
    first, second = (dcm_from_body_fixed(angles, "zxy") for angles in (figure.first, figure.second))
    for share, end in ((0, first), (1, second)):
        for dcm in figure.ways(share):
            assert rotation_error(dcm, end) < 1e-14
    whole = Rotation.from_matrix(second @ first.T).magnitude()
    rates = np.subtract(figure.second, figure.first) / 4
    for share in (0.0, 0.3, 0.5, 0.9, 1.0):
        slerp, euler, _ = figure.speeds(share)
        assert slerp == pytest.approx(whole / 4, rel=1e-6)
        angles = np.array(figure.first) + share * 4 * rates
        expected = np.linalg.norm(angular_velocity_matrix(angles, "zxy") @ rates)
        assert euler == pytest.approx(expected, rel=1e-3)
        # The repaired matrix goes about the same axis as slerp: it is somewhere on the same way.
        slerped, _, repaired = figure.ways(share)
        moved = [Rotation.from_matrix(dcm @ first.T).as_rotvec() for dcm in (slerped, repaired)]
        assert np.allclose(np.cross(*moved), 0, atol=1e-7)
    assert (np.linalg.norm(figure.blend(0.5), axis=1) <= 1 + 1e-12).all()


def test_half_a_turn_has_no_shorter_way():
    figure = QuaternionFigure(view="way", first=(0, 0, 0), second=(math.pi, 0, 0))
    slerp, euler, repaired = figure.ways(0.5)
    assert slerp is None and repaired is None
    assert np.allclose(euler, dcm_from_body_fixed((math.pi / 2, 0.0, 0.0), "zxy"))
    assert "not defined" in figure.drawing().alt


@pytest.mark.parametrize(
    "figure",
    [SuccessiveFigure(**FOUR_TURNS) for FOUR_TURNS in CHAINS]
    + [
        QuaternionFigure(),
        QuaternionFigure(angle=11.0),
        *(QuaternionFigure(view="way", **ends) for ends in ENDS),
    ],
)
def test_still_tells_the_state_in_words(figure):
    soup = BeautifulSoup(figure.still(), "html.parser")
    alt = soup.svg["aria-label"]
    assert len(alt) > 150
    if isinstance(figure, SuccessiveFigure):
        assert numbers_in(alt)[:9] == pytest.approx(figure.dcm.ravel().tolist(), abs=0.005001)
    elif figure.view == "double":
        assert numbers_in(alt)[-4:] == pytest.approx(figure.quaternion.tolist(), abs=0.000501)
    else:
        assert numbers_in(alt)[-3:] == pytest.approx(
            np.linalg.norm(figure.blend(figure.share), axis=1), abs=0.005001
        )
    left, top, right, bottom = figure.sheet
    assert soup.svg["viewbox"] == f"{left} {top} {right - left} {bottom - top}"


def test_still_keeps_within_its_sheet():
    for figure in [
        *(SuccessiveFigure(**chain) for chain in CHAINS),
        QuaternionFigure(),
        QuaternionFigure(view="way"),
    ]:
        inside = np.array(figure.drawing().bounds()) * (-1, -1, 1, 1)
        assert (inside <= np.array(figure.sheet) * (-1, -1, 1, 1)).all(), (figure.state(), inside)


# In the browser.


def matrix(page, name="Direction cosine matrix of the end"):
    return numbers(page, name)


# A control's own label, or its text with the formulas as they are spoken.
NAME = """() => document.activeElement.getAttribute('aria-label') ?? [...document.activeElement.childNodes].map(
  (part) => part.getAttribute?.('aria-label') ?? part.textContent).join('')"""


def tab_to(page, name):
    """Come to a control by the Tab key alone."""
    for _ in range(80):
        page.keyboard.press("Tab")
        if page.evaluate(NAME) == name:
            return
    pytest.fail(f"the Tab key does not come to {name!r}")


@pytest.mark.sampled(1)
@pytest.mark.parametrize("chain", CHAINS)
def test_chain_shows_the_numbers_of_the_module(open_figure, chain):
    figure = SuccessiveFigure(**chain)
    page = open_figure(figure)
    assert np.abs(matrix(page) - figure.dcm).max() < 5.01e-4
    if figure.compare != "nothing":
        assert f"{math.degrees(figure.angle_between):.1f}°" in words(page)
    # Each factor, in the order of the product, and the product of what is shown.
    shown = page.eval_on_selector_all(
        ".factor:not([hidden])",
        "all => all.sort((a, b) => a.style.order - b.style.order)"
        ".map(f => [...f.querySelectorAll('.small-matrix span')].map(s => "
        "s.textContent.replace('\u2212', '-')))",
    )
    product = np.linalg.multi_dot(
        [np.eye(3), *(np.reshape([float(e) for e in entries], (3, 3)) for entries in shown)]
    )
    assert len(shown) == len(figure.turns)
    assert np.abs(product - figure.dcm).max() < 0.03


@pytest.mark.sampled(1)
@pytest.mark.parametrize("angle", [0.0, 1.9, 2 * math.pi, 8.5, 4 * math.pi])
def test_double_shows_the_numbers_of_the_module(open_figure, angle):
    figure = QuaternionFigure(angle=angle)
    page = open_figure(figure)
    shown = numbers(page, "q and minus q, scalar first")
    assert np.abs(shown - [figure.quaternion, -figure.quaternion]).max() < 5.01e-4
    assert (
        np.abs(matrix(page, "Direction cosine matrix of A with respect to N") - figure.dcm).max()
        < 5.01e-4
    )


@pytest.mark.sampled(1)
@pytest.mark.parametrize("ends", ENDS)
def test_ways_show_the_numbers_of_the_module(open_figure, ends):
    figure = QuaternionFigure(view="way", **ends)
    page = open_figure(figure)
    shown = numbers(page, "The three ways")
    start = dcm_from_body_fixed(figure.first, "zxy")
    turned = [Rotation.from_matrix(dcm @ start.T).magnitude() for dcm in figure.ways(figure.share)]
    assert shown[:, 0] == pytest.approx(np.degrees(turned), abs=0.0501)
    assert shown[:, 1] == pytest.approx(np.degrees(figure.speeds(figure.share)), abs=0.0501)
    lengths = np.linalg.norm(figure.blend(figure.share), axis=1)
    assert numbers(page, "Lengths of the rows of the blended matrix") == pytest.approx(
        lengths, abs=5.01e-4
    )
    # The slowest and the fastest of the way by Euler angles are said, and the table shows no other.
    match = re.search(r"at ([\d.]+) to ([\d.]+) °/s", words(page))
    shares = np.linspace(0, 1, 401)
    speeds = np.degrees([figure.speeds(share)[1] for share in shares])
    for word, place in ((match[1], speeds.argmin()), (match[2], speeds.argmax())):
        page.evaluate(
            "share => { const { model } = document.querySelector('.moving'); model.move({ "
            "...model.moved, share }); }",
            float(shares[place]),
        )
        shown = numbers(page, "The three ways")
        assert shown[1, 1] == pytest.approx(float(word), abs=0.0501), place


def test_half_a_turn_is_said(open_figure):
    page = open_figure(QuaternionFigure(view="way", first=(0, 0, 0), second=(math.pi, 0, 0)))
    assert "half a turn apart" in words(page)


def test_chain_by_keys_alone(open_figure):
    page = open_figure(SuccessiveFigure(turns=RIGHT_ANGLES))
    tab_to(page, "Turn 1, to frame A")
    for _ in range(10):
        page.keyboard.press("ArrowLeft")
    expected = SuccessiveFigure(turns=(("z", math.radians(80)), RIGHT_ANGLES[1]))
    assert np.abs(matrix(page) - expected.dcm).max() < 5.01e-4
    assert (
        page.evaluate("document.activeElement.getAttribute('aria-valuetext')")
        == "Turn 1, to frame A, 80 degrees"
    )
    tab_to(page, "Swap rotations 1 and 2")
    page.keyboard.press("Enter")
    expected.turns = expected.turns[::-1]
    expected.compare = "1 and 2 exchanged"
    assert np.abs(matrix(page) - expected.dcm).max() < 5.01e-4
    assert f"{math.degrees(expected.angle_between):.1f}°" in words(page)
    tab_to(page, "Add a turn")
    page.keyboard.press("Space")
    settle(page)
    assert page.locator(".factor:visible").count() == 3
    tab_to(page, "Remove the last")
    page.keyboard.press("Space")
    page.keyboard.press("Space")
    settle(page)
    assert page.locator(".factor:visible").count() == 1
    assert (
        page.eval_on_selector('select[aria-label="Compare with"]', "list => list.value")
        == "nothing"
    )
    # What is said aloud follows the text.
    page.wait_for_function(
        """document.querySelector('[role="status"]').textContent.includes('body fixed')"""
    )


def test_chain_body_and_space_fixed(open_figure):
    page = open_figure(SuccessiveFigure(turns=FOUR))
    page.select_option('select[aria-label="Turns about"]', "space")
    assert np.abs(matrix(page) - SuccessiveFigure(turns=FOUR, fixed="space").dcm).max() < 5.01e-4
    page.select_option('select[aria-label="Axis of turn 2"]', "y")
    changed = (FOUR[0], ("y", FOUR[1][1]), *FOUR[2:])
    assert np.abs(matrix(page) - SuccessiveFigure(turns=changed, fixed="space").dcm).max() < 5.01e-4


def test_number_lights_up(open_figure):
    page = open_figure(SuccessiveFigure())
    before = words(page)
    page.locator("button.number").nth(5).hover()
    assert "Row y, column z" in words(page)
    assert page.locator("path.shadow").count() == 1
    page.mouse.move(2, 2)
    assert words(page) == before


def test_quaternion_by_keys_alone(open_figure):
    page = open_figure(
        QuaternionFigure(axis=(0, 0, 1), angle=math.radians(350)), reduced_motion="reduce"
    )
    tab_to(page, "theta")
    for _ in range(10):
        page.keyboard.press("ArrowRight")
    assert numbers(page, "q and minus q, scalar first")[:, 0] == pytest.approx([-1, 1])
    assert "After one full turn" in words(page)
    tab_to(page, "Turn once round")
    page.keyboard.press("Enter")
    assert numbers(page, "q and minus q, scalar first")[:, 0] == pytest.approx([1, -1])
    page.keyboard.press("Shift+Tab")
    page.evaluate("document.activeElement.blur(); window.getSelection().removeAllRanges()")
    tab_to(page, "From A to B")
    page.keyboard.press("Enter")
    tab_to(page, "psi")
    page.keyboard.press("ArrowRight")
    expected = QuaternionFigure(view="way")
    expected.second = (math.radians(91), *expected.second[1:])
    shown = numbers(page, "The three ways")
    assert shown[:, 1] == pytest.approx(np.degrees(expected.speeds(expected.share)), abs=0.0501)


# Pictures that come every 50 milliseconds, however fast or slow this machine
# is, and the times that were shown.
STEADY = """() => {
  const field = document.querySelector('.player:not([hidden] *) input[type=number]');
  const ask = window.requestAnimationFrame.bind(window);
  let moment = 1000;
  window.seen = [];
  window.requestAnimationFrame = (work) => ask(() => { moment += 50; work(moment); window.seen.push(field.value); });
}"""


@pytest.mark.sampled(1)
@pytest.mark.parametrize("motion", ["no-preference", "reduce"])
@pytest.mark.parametrize(
    "figure, start, end",
    [
        (SuccessiveFigure(), 0, 6),
        (QuaternionFigure(view="way", share=0.0), 0, 4),
        (MotionFigure(time=17, method="Runge-Kutta"), 17, 20),
    ],
)
def test_play_reaches_the_end(open_figure, figure, start, end, motion):
    page = open_figure(figure, reduced_motion=motion)
    page.evaluate(STEADY)
    page.locator(".player:visible button", has_text="Play").click()
    # The click has made it Pause.
    page.locator(".player:visible button", has_text="Play").wait_for()
    settle(page)
    times = sorted({float(value) for value in page.evaluate("window.seen")})
    assert times[0] == start and times[-1] == end
    steps = np.diff(times)
    # Two pictures of the page may fall between two of the figure.
    assert (
        max(steps) <= 0.55 and min(steps[:-1]) > 0.4 if motion == "reduce" else max(steps) <= 0.15
    )
    if isinstance(figure, SuccessiveFigure):
        assert np.abs(matrix(page) - figure.dcm).max() < 5.01e-4
    if isinstance(figure, QuaternionFigure):
        first, second = (
            dcm_from_body_fixed(angles, "zxy") for angles in (figure.first, figure.second)
        )
        whole = math.degrees(Rotation.from_matrix(second @ first.T).magnitude())
        assert numbers(page, "The three ways")[:, 0] == pytest.approx([whole] * 3, abs=0.0501)


# The time of a picture is when it was due, which may be before the click that asked for it.
EARLY = """() => {
  const field = document.querySelector('.player:not([hidden] *) input[type=number]');
  const ask = window.requestAnimationFrame.bind(window);
  window.seen = new Set();
  window.requestAnimationFrame = (work) => ask((moment) => { work(moment - 400); window.seen.add(field.value); });
}"""


@pytest.mark.sampled(1)
@pytest.mark.parametrize("motion", ["no-preference", "reduce"])
@pytest.mark.parametrize(
    "figure",
    [SuccessiveFigure(share=0.0), QuaternionFigure(view="way", share=0.0), MotionFigure(time=0.0)],
)
def test_play_begins_with_a_picture_that_was_due_before(open_figure, figure, motion):
    page = open_figure(figure, reduced_motion=motion)
    page.evaluate(EARLY)
    page.locator(".player:visible button", has_text="Play").click()
    page.wait_for_function("window.seen.size > 3")
    assert min(float(value) for value in page.evaluate("[...window.seen]")) == 0


def test_no_speed_is_cut_off_in_silence():
    """The scale holds all three ways; what is too fast for any scale
    leaves a gap, and its size is told.
    """
    from orientation_figures.moving.pictures.quaternion import plotted

    slow = np.radians([[30.0] * 4, [40, 50, 60, 70], [100, 170, 110, 20]])
    highest, pieces, beyond = plotted(slow)
    assert highest == 180 and not beyond and [len(runs) for runs in pieces] == [1, 1, 1]
    assert [speed for _, speed in pieces[2][0]] == pytest.approx([100, 170, 110, 20])
    fast = np.radians([[30.0] * 5, [40.0] * 5, [100, 200, 5000, 300, 100]])
    highest, pieces, beyond = plotted(fast)
    assert highest == 720 and beyond == pytest.approx(5000)
    assert [len(run) for run in pieces[2]] == [2, 2] and max(
        s for run in pieces[2] for _, s in run
    ) <= 720
    # Half a turn but a little: blended entries turn over all at once.
    words = repr(QuaternionFigure(view="way", first=(0, 0, 0), second=(3.1, 0.02, 0)))
    assert "cut off at 720 degrees per second (the highest is 871)" in words
    assert "cut off" not in repr(QuaternionFigure(view="way"))
