"""The chain of turns and the quaternion with its double: in Python, and in the browser by keys, touch and mouse."""

import json
import math
import re

import numpy as np
import pytest
from bs4 import BeautifulSoup
from orientations import random_unit_vectors, rotation_error
from scipy.spatial.transform import Rotation
from test_site import SIDEWAYS, violations
from traitlets import TraitError

from orientation import angular_velocity_matrix, dcm_from_body_fixed, dcm_from_space_fixed
from orientation.moving import MotionFigure, QuaternionFigure, SuccessiveFigure, bundle

WIDE, NARROW = {"width": 1300, "height": 900}, {"width": 380, "height": 760}
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
    assert rotation_error(SuccessiveFigure(turns=turns).dcm, dcm_from_body_fixed(angles, "zxy")) < 1e-14
    assert rotation_error(SuccessiveFigure(turns=turns, fixed="space").dcm, dcm_from_space_fixed(angles, "zxy")) < 1e-14


def test_chain_compared_with_the_exchanged_one():
    figure = SuccessiveFigure(turns=RIGHT_ANGLES, compare="1 and 2 exchanged")
    assert np.allclose(figure.dcm, [[0, 1, 0], [0, 0, 1], [1, 0, 0]])
    assert rotation_error(figure.other, SuccessiveFigure(turns=RIGHT_ANGLES[::-1]).dcm) < 1e-15
    # Each is a third of a turn about a corner of the cube; so is the turn between them.
    assert math.degrees(figure.angle_between) == pytest.approx(120)
    figure.compare = "body and space fixed"
    assert rotation_error(figure.other, SuccessiveFigure(turns=RIGHT_ANGLES, fixed="space").dcm) < 1e-15
    figure.compare = "nothing"
    assert figure.other is None and figure.angle_between is None


@pytest.mark.parametrize(
    "attributes, message",
    [
        ({"turns": ()}, "one to four pairs"),
        ({"turns": [("z", 0.1)] * 5}, "one to four pairs"),
        ({"turns": [("w", 0.1)]}, "the axis 'w'"),
        ({"turns": [("z", 90)]}, "radians, not degrees"),
        ({"turns": [("z", math.nan)]}, "turns: "),
        ({"turns": [("z", 0.1)], "compare": "1 and 2 exchanged"}, "the chain has only 1 turn"),
        ({"share": 1.5}, "share is 1.5"),
        ({"share": -0.5}, "share is -0.5"),
    ],
)
def test_chain_refuses(attributes, message):
    with pytest.raises(TraitError, match=re.escape(message)):
        SuccessiveFigure(**attributes)


@pytest.mark.parametrize(
    "attributes, message",
    [
        ({"angle": 360}, "radians, not degrees"),
        ({"angle": -0.5}, "from 0 to 4 pi"),
        ({"axis": (0, 0, 0)}, "points nowhere"),
        ({"first": (0, 100, 0)}, "radians, not degrees"),
        ({"unit_vector": "w"}, "unit_vector"),
        ({"share": 2.0}, "share is 2.0"),
    ],
)
def test_quaternion_refuses(attributes, message):
    with pytest.raises(TraitError, match=re.escape(message)):
        QuaternionFigure(**attributes)


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


@pytest.mark.parametrize("figure", [SuccessiveFigure(**FOUR_TURNS) for FOUR_TURNS in CHAINS] + [
    QuaternionFigure(), QuaternionFigure(angle=11.0), *(QuaternionFigure(view="way", **ends) for ends in ENDS)])
def test_still_has_the_state_and_stands_for_the_figure(figure):
    soup = BeautifulSoup(figure.still(), "html.parser")
    assert json.loads(soup.figure["data-state"]) == json.loads(json.dumps(figure.state()))
    assert soup.figure["data-figure"] == figure.kind
    alt = soup.svg["aria-label"]
    assert len(alt) > 150
    if isinstance(figure, SuccessiveFigure):
        assert numbers_in(alt)[:9] == pytest.approx(figure.dcm.ravel().tolist(), abs=0.005001)
    elif figure.view == "double":
        assert numbers_in(alt)[-4:] == pytest.approx(figure.quaternion.tolist(), abs=0.000501)
    else:
        assert numbers_in(alt)[-3:] == pytest.approx(np.linalg.norm(figure.blend(figure.share), axis=1), abs=0.005001)
    left, top, right, bottom = figure.sheet
    assert soup.svg["viewbox"] == f"{left} {top} {right - left} {bottom - top}"


def test_still_keeps_within_its_sheet():
    for figure in [*(SuccessiveFigure(**chain) for chain in CHAINS), QuaternionFigure(), QuaternionFigure(view="way")]:
        inside = np.array(figure.drawing().bounds()) * (-1, -1, 1, 1)
        assert (inside <= np.array(figure.sheet) * (-1, -1, 1, 1)).all(), (figure.state(), inside)


@pytest.mark.parametrize("kind", ["successive", "quaternion"])
def test_weight(kind):
    import gzip

    assert len(gzip.compress(bundle.script(kind).encode())) < 8_000


# In the browser.

PAGE = """<!doctype html><html lang="en" data-theme="{theme}"><head><meta charset="utf-8"><title>A figure</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<style>:root {{ --pst-color-background: {paper}; }} body {{ margin: 0 auto; padding: 0 16px; max-width: 700px;
background: {paper}; color: {ink}; }} {style}</style></head>
<body><main><h1>A figure</h1>{still}<p id="after">The text goes on.</p></main>
<script>{shared}</script><script>{script}</script></body></html>"""


@pytest.fixture
def opened(browser, tmp_path):
    """``opened(figure, ...)``: a page from disk on which the figure is alive; it may say and fetch nothing."""
    contexts, faults = [], []

    def run(figure, theme="light", viewport=WIDE, **options):
        paper, ink = {"light": ("#ffffff", "#1d2125"), "dark": ("#121212", "#eceff2")}[theme]
        page_file = tmp_path / "page.html"
        page_file.write_text(
            PAGE.format(theme=theme, paper=paper, ink=ink, style=bundle.style(), still=figure.still(),
                        shared=bundle.shared_script(), script=bundle.script(figure.kind)), "utf8")
        context = browser.new_context(viewport=viewport, color_scheme=theme, **options)
        contexts.append(context)
        page = context.new_page()
        page.on("console", lambda message: message.type == "error" and faults.append(message.text))
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.on("request", lambda request: request.url.startswith("file:") or faults.append(request.url))
        page.goto(page_file.as_uri())
        page.wait_for_selector("figure[data-ready]")
        frames(page)
        return page

    yield run
    for context in contexts:
        context.close()
    assert faults == []


def frames(page):
    page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


def table(page, name):
    """The numbers of one table, by its spoken name."""
    frames(page)
    texts = page.eval_on_selector_all(
        f'[role="group"][aria-label="{name}"] button.number', "all => all.map(b => b.lastChild.textContent)")
    assert texts, name
    return [float(re.sub(r"[^\d.-]", "", text.replace("\u2212", "-"))) for text in texts]


def matrix(page, name="Direction cosine matrix of the end"):
    return np.reshape(table(page, name), (3, 3))


def words(page):
    frames(page)
    return page.inner_text(".stage:not([hidden]) .words")


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


def finger(page, start, end):
    """Drag with one finger."""
    client = page.context.new_cdp_session(page)
    points = np.linspace(start, end, 12)
    for kind, point in [("touchStart", points[0]), *(("touchMove", point) for point in points), ("touchEnd", None)]:
        places = [] if point is None else [{"x": float(point[0]), "y": float(point[1])}]
        client.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": places})
    frames(page)


def middle(page, selector):
    box = page.locator(selector).bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


@pytest.mark.parametrize("chain", CHAINS)
def test_chain_shows_the_numbers_of_the_module(opened, chain):
    figure = SuccessiveFigure(**chain)
    page = opened(figure)
    assert np.abs(matrix(page) - figure.dcm).max() < 5.01e-4
    if figure.compare != "nothing":
        assert f"{math.degrees(figure.angle_between):.1f}°" in words(page)
    # Each factor, in the order of the product, and the product of what is shown.
    shown = page.eval_on_selector_all(
        ".factor:not([hidden])",
        "all => all.sort((a, b) => a.style.order - b.style.order)"
        ".map(f => [...f.querySelectorAll('.small-matrix span')].map(s => s.textContent.replace('\u2212', '-')))")
    product = np.linalg.multi_dot([np.eye(3), *(np.reshape([float(e) for e in one], (3, 3)) for one in shown)])
    assert len(shown) == len(figure.turns)
    assert np.abs(product - figure.dcm).max() < 0.03


@pytest.mark.parametrize("angle", [0.0, 1.9, 2 * math.pi, 8.5, 4 * math.pi])
def test_double_shows_the_numbers_of_the_module(opened, angle):
    figure = QuaternionFigure(angle=angle)
    page = opened(figure)
    shown = np.reshape(table(page, "q and minus q, scalar first"), (2, 4))
    assert np.abs(shown - [figure.quaternion, -figure.quaternion]).max() < 5.01e-4
    assert np.abs(matrix(page, "Direction cosine matrix of A with respect to N") - figure.dcm).max() < 5.01e-4


@pytest.mark.parametrize("ends", ENDS)
def test_ways_show_the_numbers_of_the_module(opened, ends):
    figure = QuaternionFigure(view="way", **ends)
    page = opened(figure)
    shown = np.reshape(table(page, "The three ways"), (3, 2))
    start = dcm_from_body_fixed(figure.first, "zxy")
    turned = [Rotation.from_matrix(dcm @ start.T).magnitude() for dcm in figure.ways(figure.share)]
    assert shown[:, 0] == pytest.approx(np.degrees(turned), abs=0.0501)
    assert shown[:, 1] == pytest.approx(np.degrees(figure.speeds(figure.share)), abs=0.0501)
    lengths = np.linalg.norm(figure.blend(figure.share), axis=1)
    assert table(page, "Lengths of the rows of the blended matrix") == pytest.approx(lengths, abs=5.01e-4)


def test_half_a_turn_is_said(opened):
    page = opened(QuaternionFigure(view="way", first=(0, 0, 0), second=(math.pi, 0, 0)))
    assert "half a turn apart" in words(page)


def test_chain_by_keys_alone(opened):
    page = opened(SuccessiveFigure(turns=RIGHT_ANGLES))
    tab_to(page, "Turn 1, to frame A")
    for _ in range(10):
        page.keyboard.press("ArrowLeft")
    expected = SuccessiveFigure(turns=(("z", math.radians(80)), RIGHT_ANGLES[1]))
    assert np.abs(matrix(page) - expected.dcm).max() < 5.01e-4
    assert page.evaluate("document.activeElement.getAttribute('aria-valuetext')") == "Turn 1, to frame A, 80 degrees"
    tab_to(page, "Exchange turns 1 and 2")
    page.keyboard.press("Enter")
    expected.turns = expected.turns[::-1]
    expected.compare = "1 and 2 exchanged"
    assert np.abs(matrix(page) - expected.dcm).max() < 5.01e-4
    assert f"{math.degrees(expected.angle_between):.1f}°" in words(page)
    tab_to(page, "Add a turn")
    page.keyboard.press("Space")
    frames(page)
    assert page.locator(".factor:visible").count() == 3
    tab_to(page, "Remove the last")
    page.keyboard.press("Space")
    page.keyboard.press("Space")
    frames(page)
    assert page.locator(".factor:visible").count() == 1
    assert page.eval_on_selector('select[aria-label="Compare with"]', "list => list.value") == "nothing"
    # What is said aloud follows the text.
    page.wait_for_timeout(800)
    assert "body fixed" in page.inner_text('[role="status"]')


def test_chain_body_and_space_fixed(opened):
    page = opened(SuccessiveFigure(turns=FOUR))
    page.select_option('select[aria-label="Turns about"]', "space")
    assert np.abs(matrix(page) - SuccessiveFigure(turns=FOUR, fixed="space").dcm).max() < 5.01e-4
    page.select_option('select[aria-label="Axis of turn 2"]', "y")
    changed = (FOUR[0], ("y", FOUR[1][1]), *FOUR[2:])
    assert np.abs(matrix(page) - SuccessiveFigure(turns=changed, fixed="space").dcm).max() < 5.01e-4


def test_number_lights_up(opened):
    page = opened(SuccessiveFigure())
    before = words(page)
    page.locator("button.number").nth(5).hover()
    assert "Row y, column z" in words(page)
    assert page.locator("path.shadow").count() == 1
    page.mouse.move(2, 2)
    assert words(page) == before


def test_quaternion_by_keys_alone(opened):
    page = opened(QuaternionFigure(axis=(0, 0, 1), angle=math.radians(350)), reduced_motion="reduce")
    tab_to(page, "theta")
    for _ in range(10):
        page.keyboard.press("ArrowRight")
    assert np.reshape(table(page, "q and minus q, scalar first"), (2, 4))[:, 0] == pytest.approx([-1, 1])
    assert "After one full turn" in words(page)
    tab_to(page, "Turn once round")
    page.keyboard.press("Enter")
    assert np.reshape(table(page, "q and minus q, scalar first"), (2, 4))[:, 0] == pytest.approx([1, -1])
    page.keyboard.press("Shift+Tab")
    page.evaluate("document.activeElement.blur(); window.getSelection().removeAllRanges()")
    tab_to(page, "From A to B")
    page.keyboard.press("Enter")
    tab_to(page, "psi")
    page.keyboard.press("ArrowRight")
    expected = QuaternionFigure(view="way")
    expected.second = (math.radians(91), *expected.second[1:])
    shown = np.reshape(table(page, "The three ways"), (3, 2))
    assert shown[:, 1] == pytest.approx(np.degrees(expected.speeds(expected.share)), abs=0.0501)


def test_arrow_keys_turn_the_view(opened):
    for figure in (SuccessiveFigure(), QuaternionFigure()):
        page = opened(figure)
        page.locator(".sheet").first.focus()
        before = page.locator(".marks").first.inner_html()
        page.keyboard.press("ArrowLeft")
        frames(page)
        assert page.locator(".marks").first.inner_html() != before
        page.keyboard.press("Home")
        frames(page)
        assert page.locator(".marks").first.inner_html() == before


def test_chain_by_touch(opened):
    page = opened(SuccessiveFigure(), viewport=NARROW, has_touch=True, is_mobile=True)
    before = matrix(page)
    grip = page.locator(".grip[visibility=visible]").first
    box = grip.bounding_box()
    start = (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    finger(page, start, (start[0] - 40, start[1] + 50))
    assert page.evaluate("scrollY") == 0
    angle = float(page.input_value('input[aria-label="Turn 3, to frame C in degrees"]'))
    assert angle != 40 and not np.allclose(matrix(page), before)
    expected = SuccessiveFigure()
    expected.turns = (*expected.turns[:2], ("y", math.radians(angle)))
    assert np.abs(matrix(page) - expected.dcm).max() < 5.01e-4
    page.locator(".exchange").first.tap()
    assert "exchanged" in words(page)


def test_quaternion_by_touch(opened):
    page = opened(QuaternionFigure(angle=0.5), viewport=NARROW, has_touch=True, is_mobile=True)
    sheet = page.locator(".sheet").first.bounding_box()
    scale = sheet["width"] / 360
    centre = sheet["x"] + (118 + 142) * scale, sheet["y"] + (142 + 130) * scale
    # Half way round the circle is once round for the frame.
    finger(page, middle(page, '.grip[data-part="q"]'), (centre[0], centre[1] - 70 * scale))
    finger(page, middle(page, '.grip[data-part="q"]'), (centre[0] - 70 * scale, centre[1]))
    angle = float(page.input_value('input[aria-label="theta in degrees"]'))
    assert angle == pytest.approx(360, abs=8)
    figure = QuaternionFigure(angle=math.radians(angle))
    assert table(page, "q and minus q, scalar first")[:4] == pytest.approx(figure.quaternion, abs=5.01e-4)
    page.get_by_role("button", name="From A to B").tap()
    assert page.locator(".sheet:visible").count() == 1 and len(table(page, "The three ways")) == 6


EVERY = [SuccessiveFigure, lambda: SuccessiveFigure(turns=FOUR, compare="1 and 2 exchanged", share=0.4),
         QuaternionFigure, lambda: QuaternionFigure(view="way")]


@pytest.mark.parametrize("make", EVERY)
@pytest.mark.parametrize("theme", ["light", "dark"])
def test_accessible_in_both_themes_and_not_wider_than_a_phone(opened, make, theme):
    for viewport in (WIDE, NARROW):
        page = opened(make(), theme, viewport)
        assert page.evaluate(SIDEWAYS) <= 0
        assert violations(page) == []


@pytest.mark.parametrize("make", EVERY[::3])
def test_nothing_moves_unasked(opened, make):
    page = opened(make())
    before = page.inner_html(".live")
    page.wait_for_timeout(700)
    assert re.sub(r'<p class="unseen".*?</p>', "", page.inner_html(".live")) == re.sub(r'<p class="unseen".*?</p>', "", before)


# Pictures that come every 50 milliseconds, however fast or slow this machine is, and the times that were shown.
STEADY = """() => {
  const field = document.querySelector('.player:not([hidden] *) input[type=number]');
  const ask = window.requestAnimationFrame.bind(window);
  let moment = 1000;
  window.seen = [];
  window.requestAnimationFrame = (work) => ask(() => { moment += 50; work(moment); window.seen.push(field.value); });
}"""


@pytest.mark.parametrize("motion", ["no-preference", "reduce"])
@pytest.mark.parametrize("figure", [SuccessiveFigure(), QuaternionFigure(view="way", share=0.0)])
def test_play_reaches_the_end(opened, figure, motion):
    page = opened(figure, reduced_motion=motion)
    page.evaluate(STEADY)
    page.locator(".player:visible button", has_text="Play").click()
    page.locator(".player:visible button", has_text="Play").wait_for()   # the click has made it Pause
    seconds = 6 if isinstance(figure, SuccessiveFigure) else 4
    assert float(page.input_value('.player:visible input[type="number"] >> visible=true')) == seconds
    times = sorted({float(value) for value in page.evaluate("window.seen")})
    assert times[0] == 0 and times[-1] == seconds
    # The first two pictures may have been asked for by others.
    assert max(np.diff(times)) <= (0.55 if motion == "reduce" else 0.15)
    assert motion != "reduce" or min(np.diff(times)) > 0.4
    if isinstance(figure, SuccessiveFigure):
        assert np.abs(matrix(page) - figure.dcm).max() < 5.01e-4
    else:
        first, second = (dcm_from_body_fixed(angles, "zxy") for angles in (figure.first, figure.second))
        whole = math.degrees(Rotation.from_matrix(second @ first.T).magnitude())
        assert np.reshape(table(page, "The three ways"), (3, 2))[:, 0] == pytest.approx([whole] * 3, abs=0.0501)


# The time of a picture is when it was due, which may be before the click that asked for it.
EARLY = """() => {
  const field = document.querySelector('.player:not([hidden] *) input[type=number]');
  const ask = window.requestAnimationFrame.bind(window);
  window.seen = new Set();
  window.requestAnimationFrame = (work) => ask((moment) => { work(moment - 400); window.seen.add(field.value); });
}"""


@pytest.mark.parametrize("motion", ["no-preference", "reduce"])
@pytest.mark.parametrize("figure", [SuccessiveFigure(share=0.0), QuaternionFigure(view="way", share=0.0), MotionFigure(time=0.0)])
def test_play_begins_with_a_picture_that_was_due_before(opened, figure, motion):
    page = opened(figure, reduced_motion=motion)
    page.evaluate(EARLY)
    page.locator(".player:visible button", has_text="Play").click()
    page.wait_for_function("window.seen.size > 3")
    assert min(float(value) for value in page.evaluate("[...window.seen]")) == 0


def test_turn_once_round(opened):
    page = opened(QuaternionFigure(angle=0.0))
    page.get_by_role("button", name="Turn once round").click()
    page.wait_for_function("""() => document.querySelector('input[aria-label="theta in degrees"]').value === '360'""")
    assert table(page, "q and minus q, scalar first")[0] == -1


def test_paper_gets_the_still(opened):
    page = opened(SuccessiveFigure())
    page.emulate_media(media="print")
    assert page.is_visible(".still svg") and not page.is_visible(".live")
