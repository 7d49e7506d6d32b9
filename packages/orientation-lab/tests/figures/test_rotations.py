"""The essay's world: its mathematics against the book's own, its stills,
and the page as a reader meets it.
"""

import base64
import json
import re
from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from test_site import violations

from notebook_pages.paths import HTML
from orientation import (
    SEQUENCES,
    axis_angle_from_dcm,
    body_fixed_from_dcm,
    dcm_from_axis_angle,
    dcm_from_body_fixed,
    dcm_from_quaternion,
    dcm_rate,
    interpolate_quaternions,
    nearest_dcm,
    quaternion_from_dcm,
)
from orientation_figures.moving import bundle
from orientation_figures.rotations import Stop, painter, scenes
from tools import rotations as written_down


def unit_vector(vector):
    return np.array(vector) / np.linalg.norm(vector)


STILLS = {still["id"]: still for still in scenes()["stills"]}
FROM, TO = np.radians((-80, 60, -30)), np.radians((100, 65, 40))
# The line of stop 12, and that of the second pair of mirrors there.
FOUR, SECOND = map(unit_vector, ((0.48, 0.39, 0.79), (-0.6, 0.3, 0.75)))


def fragment_of(place, content):
    """The fragment of an address, as ``js/address.js`` writes it."""
    data = base64.urlsafe_b64encode(json.dumps(content).encode()).decode()
    return f"#{place}=1.{data.rstrip('=')}"


@cache
def tried():
    """What the page's scripts make of two moments of each stop."""
    return json.loads(written_down.written("--tried"))


def test_what_is_written_down_is_what_the_page_shows():
    fresh = json.loads(written_down.written())
    stored = scenes()
    assert [still["id"] for still in fresh["stills"]] == list(STILLS)
    for fresh_still, stored_still in zip(fresh["stills"], stored["stills"]):
        assert len(fresh_still["items"]) == len(stored_still["items"]), (
            f"{fresh_still['id']}: run `python -m tools.rotations`"
        )
        for shape, known in zip(fresh_still["items"], stored_still["items"]):
            assert shape[0] == known[0] and shape[5] == known[5]
            for k in (1, 2, 3, 4, 6):
                assert np.allclose(shape[k], known[k], atol=2e-3), fresh_still["id"]


@pytest.mark.parametrize("number", range(32))
def test_every_frame_of_every_stop_is_that_of_the_book(number):
    """The arrows of all four frames, at two moments of each stop, from the state alone."""
    case = tried()["tried"][number]
    state, frames = case["state"], {name: np.array(rows) for name, rows in case["frames"].items()}
    psi, theta, phi = state["angles"]
    assert frames["A"] == pytest.approx(np.eye(3))
    for rows in frames.values():
        assert rows @ rows.T == pytest.approx(np.eye(3), abs=1e-9) and np.linalg.det(
            rows
        ) == pytest.approx(1)
    D = frames["D"]
    # However it came about, the machine can hold the camera so: its three joints fit.
    for inner, outer, axis in (("B", "A", 2), ("C", "B", 0), ("D", "C", 1)):
        assert frames[inner][axis] == pytest.approx(frames[outer][axis], abs=1e-9)
    stop = case["id"]
    if stop == "one-turn":
        start = dcm_from_body_fixed(state["start"], "zxy")
        axis, angle = axis_angle_from_dcm(start)
        expected = dcm_from_axis_angle(axis, angle * (1 - state["part"]))
    elif stop == "four-numbers":
        axis = FOUR / np.linalg.norm(FOUR)
        half = state["whole"] / 2
        expected = dcm_from_quaternion(np.array((np.cos(half), *np.sin(half) * axis)))
    elif stop == "not-home":
        expected = dcm_from_axis_angle(np.array((0.0, 1, 0)), state["turn"])
    elif stop == "between-poses":
        ends = [quaternion_from_dcm(dcm_from_body_fixed(pose, "zxy")) for pose in (FROM, TO)]
        ends[1] = ends[1] * np.sign(ends[0] @ ends[1])
        expected = dcm_from_quaternion(interpolate_quaternions(*ends, state["part"]))
    elif stop == "it-moves":
        return  # what is thrown is tried below
    else:
        expected = dcm_from_body_fixed((psi, theta, phi), "zxy")
    assert D == pytest.approx(expected, abs=1e-9)


def test_what_the_text_says_is_true():
    # Stop 8: no two of the twelve look the same way.
    dcms = [dcm_from_body_fixed(np.radians((35, 50, 65)), sequence) for sequence in SEQUENCES]
    apart = [axis_angle_from_dcm(b @ a.T)[1] for k, a in enumerate(dcms) for b in dcms[:k]]
    assert len(apart) == 66 and min(apart) > np.radians(5)
    # Stop 9: at 90 degrees what the first motor gives, the third takes back.
    locked = [
        dcm_from_body_fixed((psi, np.pi / 2, 0.4 - psi), "zxy") for psi in np.linspace(-3, 3, 7)
    ]
    assert np.ptp(locked, axis=0) == pytest.approx(np.zeros((3, 3)), abs=1e-12)
    # Near it, a star that passes half a degree beside the zenith sends the
    # first motor round nearly half a turn.
    path = np.array([(x, np.radians(0.5), 1) for x in np.linspace(-0.3, 0.3, 101)])
    heading = np.unwrap(np.arctan2(-path[:, 0], path[:, 1]))
    assert np.radians(170) < abs(heading[-1] - heading[0]) < np.pi
    # Stop 7: the second triple.
    first = np.array((0.4, 0.6, 0.1))
    second = first * (1, -1, 1) + np.pi
    assert dcm_from_body_fixed(second, "zxy") == pytest.approx(dcm_from_body_fixed(first, "zxy"))
    # Stop 14: the way in angles turns farther than the one turn.
    poses = [
        dcm_from_body_fixed(FROM + part * (TO - FROM), "zxy") for part in np.linspace(0, 1, 200)
    ]
    way = sum(axis_angle_from_dcm(b @ a.T)[1] for a, b in zip(poses, poses[1:]))
    assert way > 1.5 * axis_angle_from_dcm(poses[-1] @ poses[0].T)[1]


def test_the_mirrors_turn_by_twice_their_angle():
    """The arrows that stop 11 draws, as its shapes have them."""
    items = STILLS["two-mirrors"]["items"]
    tip = {}
    for text, _, _, _, at in STILLS["two-mirrors"]["labels"]:
        tip[text] = np.array(at)
    axis = tip[r"\hat{e}"] / np.linalg.norm(tip[r"\hat{e}"])
    first, last = tip[r"\mathbf{v}"], tip[r"\mathbf{v}''"]
    flat = [arrow - axis * (arrow @ axis) for arrow in (first, last)]
    turn = np.arctan2(axis @ np.cross(*flat), flat[0] @ flat[1])
    panes = [np.reshape(item[1], (-1, 3)) for item in items if item[0] == "ribbon"]
    edges = [pane[2] - pane[0] for pane in panes]
    gap = np.arccos(abs(edges[0] @ edges[1]) / np.prod(np.linalg.norm(edges, axis=1)))
    assert turn == pytest.approx(2 * gap, abs=2e-3)
    assert np.linalg.norm(first) == pytest.approx(np.linalg.norm(last), abs=1e-3)


def test_the_four_numbers_are_those_of_two_mirrors():
    """The arrows of stop 12: their dot product is the cosine, and their cross product is drawn."""
    rods = [item for item in STILLS["four-numbers"]["items"] if item[0] == "rod" and item[1] == [1]]
    way = {
        text: unit_vector(at)
        for text, _, _, _, at in STILLS["four-numbers"]["labels"]
        if text.startswith(r"\hat{u}")
    }
    first, second = way[r"\hat{u}_1"], way[r"\hat{u}_2"]
    (cosine,) = (item for item in rods if item[5] == "ink" and item[4][0] == 0.045)
    bars = [item for item in rods if item[5] == "accent" and item[4][0] == 0.03]
    (sine,) = (item for item in bars if item[3] != [0, 0, 0])
    unit = 1.22
    assert cosine[4][2] / unit == pytest.approx(first @ second, abs=1e-3)
    assert sine[4][2] / unit == pytest.approx(np.linalg.norm(np.cross(first, second)), abs=1e-3)
    vector = np.cross(first, second)
    shadows = [item for item in bars if item[3] == [0, 0, 0]]
    for axis, shadow in zip(np.eye(3), shadows, strict=True):
        assert shadow[4][2] * np.array(shadow[2][2]) / unit == pytest.approx(
            vector @ axis * axis, abs=1e-3
        )
    assert unit_vector(vector) == pytest.approx(FOUR, abs=1e-3)


def test_four_mirrors_become_the_two_of_the_whole_rotation():
    """Stop 12 at its end: mirrors 1 and 4 do what the four did."""
    _, case = (case for case in tried()["tried"] if case["id"] == "four-numbers")
    product = np.eye(3)
    for pane in case["panes"]:
        corners = np.reshape(pane, (-1, 3))
        normal = unit_vector(np.cross(corners[0], corners[len(corners) // 2]))
        product = (np.eye(3) - 2 * np.outer(normal, normal)) @ product
    assert len(case["panes"]) == 2
    # A matrix that rotates vectors is the transpose of the one that converts components.
    whole = dcm_from_axis_angle(FOUR, np.radians(70)) @ dcm_from_axis_angle(SECOND, np.radians(50))
    assert product == pytest.approx(whole.T, abs=1e-6)


def test_the_cable_hangs_on_camera_and_wall_and_after_two_turns_it_is_flat():
    ribbons = [
        np.reshape(item[1], (-1, 2, 3))
        for item in STILLS["not-home"]["items"]
        if item[0] == "ribbon"
    ]
    across = ribbons[0][:, 0] - ribbons[1][:, 1]
    assert np.allclose(across[0], across[-1], atol=1e-2), (
        "after one turn both ends stand as they did"
    )
    assert np.linalg.norm(across - across[0], axis=1).max() > 0.3, "and between them it is twisted"


def test_paper_and_page_see_every_point_at_the_same_place():
    world = scenes()
    paper = painter.Paper(STILLS["which-way"], world)
    for point, (x, y, depth) in tried()["seen"]:
        place, far = paper.place(point)
        assert place == pytest.approx(
            np.array((x, -y)) * world["size"] / 2, abs=0.05
        ) and far == pytest.approx(depth, abs=1e-3)


@pytest.mark.sampled(6)
@pytest.mark.parametrize("name", STILLS)
def test_still(name):
    stop = Stop(name)
    svg = stop.svg()
    assert len(svg) < 60_000 and svg.count("<path") > 20
    assert len(painter.words(stop.still).split()) > 6
    # Labels lie on the sheet, and none on another.
    places = np.array([label[3] for label in stop.still["labels"]])
    assert (np.abs(places) < scenes()["size"] / 2).all()
    for k, place in enumerate(places):
        assert (np.abs(places[:k] - place).max(axis=1) > 7).all()


def moved_by_rounding(value, draw):
    """The same data, each number that is no whole one moved as another processor might round it."""
    if isinstance(value, dict):
        return {key: moved_by_rounding(part, draw) for key, part in value.items()}
    if isinstance(value, list):
        return [moved_by_rounding(part, draw) for part in value]
    return value + 1e-14 * draw.standard_normal() if isinstance(value, float) else value


def test_no_rounding_is_seen():
    """Faces that lie as far off as others, or edge-on, are painted alike by every processor."""
    world, draw = scenes(), np.random.default_rng(1)
    for still in world["stills"][::3]:
        moved = still | {key: moved_by_rounding(still[key], draw) for key in ("view", "items")}
        assert painter.picture(moved, world) == painter.picture(still, world), still["id"]


def test_a_stop_that_there_is_not():
    with pytest.raises(ValueError, match="'loock' is not a stop"):
        Stop("loock")


# ---- the page ------------------------------------------------------------------------------------

PAGE = """<!doctype html><html lang="en" data-theme="light"><head><meta charset="utf-8"><title>The essay</title>
<link rel="icon" href="data:,"><style>{style} body {{ margin: 0; font: 16px sans-serif; }}
main {{ display: grid; grid-template-columns: 200px 1fr; }} section {{ grid-column: 1; min-height: 700px; }}
.world {{ grid-column: 2; grid-row: 1 / span 20; position: sticky; top: 0; height: 380px; align-self: start; }}
</style></head><body><main><h1>The essay</h1>{gimbal}{sections}</main><script src="world.js"></script></body></html>"""


@pytest.fixture(scope="module")
def essay(tmp_path_factory):
    from notebook_pages.moving import built
    from orientation_figures.rotations import Gimbal, style
    from orientation_figures.style import STYLE

    folder = tmp_path_factory.mktemp("essay")
    (folder / "world.js").write_text(built("rotations"), "utf8")
    sections = "".join(
        f'<section id="{name}"><h2>{name}</h2><i data-stop="{name}"></i></section>'
        for name in STILLS
    )
    text = PAGE.format(
        style=STYLE + style() + bundle.built_style("rotations"),
        gimbal=Gimbal("which-way")._repr_html_(),
        sections=sections,
    )
    (folder / "index.html").write_text(text, "utf8")
    return folder / "index.html"


@pytest.fixture
def open_essay(browser, essay):
    contexts, faults = [], []

    def open_page(fragment="", **options):
        # Without motion every picture is the last one: nothing to wait for, where
        # graphics are drawn by the processor.
        context = browser.new_context(
            viewport={"width": 640, "height": 420}, reduced_motion="reduce", **options
        )
        contexts.append(context)
        page = context.new_page()
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.goto(essay.as_uri() + fragment)
        page.locator(".world:is([data-ready], [data-stills])").wait_for()
        if page.locator(".world[data-stills]").count():
            pytest.skip("this browser has no WebGL")
        rest(page)
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert faults == []


def rest(page):
    page.wait_for_function("() => !document.querySelector('.world').world.frame")


def scroll_to(page, name):
    page.evaluate("name => document.getElementById(name).scrollIntoView()", name)
    page.wait_for_function(
        "name => document.querySelector('.world').dataset.state === name", arg=name
    )
    rest(page)


def camera(page):
    return np.array(page.evaluate("document.querySelector('.world').world.picture.frames.D"))


def test_the_text_moves_the_gimbal_and_the_reader_may_take_it(open_essay):
    page = open_essay()
    assert violations(page) == []
    scroll_to(page, "three-are-enough")
    assert not page.evaluate("document.querySelector('.world').world.state.free")
    # The right end of a motor's slider is not its left end.
    motor = page.get_by_role("slider", name="first motor")
    motor.press("End")
    rest(page)
    assert motor.get_attribute("aria-valuetext") == "first motor: 180 degrees"
    page.locator(".world canvas").focus()
    page.keyboard.press("Home")
    rest(page)
    before = camera(page)
    page.keyboard.press("ArrowUp")
    rest(page)
    # Up by five degrees: the line of sight rises, and stays in its upright plane.
    angles = [np.degrees(body_fixed_from_dcm(dcm, "zxy")) for dcm in (before, camera(page))]
    assert angles[1] - angles[0] == pytest.approx((0, 5, 0), abs=0.1)
    page.keyboard.press(".")
    rest(page)
    assert "rolled 25 degrees to the left" in page.locator(".world .look").inner_text().replace(
        "On the star. Now level it: ", ""
    )
    page.wait_for_function("document.querySelector('.world [role=status]').textContent.length > 20")
    # An address opens the gimbal as it was.
    content = page.evaluate("document.querySelector('.world').world.content()")
    reopened = open_essay(fragment_of("rotations", content))
    assert reopened.locator(".world").get_attribute("data-state") == "three-are-enough"
    assert camera(reopened) == pytest.approx(camera(page), abs=1e-3)
    # Even without motion, the scene shows its outcome only when the reader has read on.
    scroll_to(page, "same-numbers")
    assert camera(page) == pytest.approx(np.eye(3))
    # The page hears of the scrolling in its next frame.
    page.evaluate(
        "scrollBy(0, document.getElementById('same-numbers').offsetHeight / 2); "
        "new Promise((drawn) => requestAnimationFrame(() => setTimeout(drawn)))"
    )
    rest(page)
    assert np.degrees(body_fixed_from_dcm(camera(page), "zxy")) == pytest.approx(
        (35, 50, 65), abs=0.2
    )


def test_a_drag_turns_the_front_the_way_the_pointer_goes(open_essay):
    page = open_essay()
    # If a picture takes long, the next one has fewer pixels. It must be on the canvas at once.
    assert page.evaluate("""() => {
      const { world } = document.querySelector('.world'), { canvas } = world, { width } = canvas;
      Object.assign(world, { slow: 9, before: performance.now() - 200 });
      world.state.angles[0] += 0.5;
      world.tick(performance.now());
      const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d');
      copy.drawImage(canvas, 0, 0);
      const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
      return [canvas.width < width, data.some((entry) => entry)];
    }""") == [True, True]
    box = page.locator(".world canvas").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + 0.42 * box["height"]
    view = np.array(page.evaluate("document.querySelector('.world').world.picture.view"))
    before = camera(page) @ view.T  # along right, up and towards the eye
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 60, y, steps=3)
    page.mouse.up()
    rest(page)
    after = camera(page) @ view.T
    lens = after[1] - before[1]
    assert lens[0] > 0.15 and abs(lens[1]) < 0.08, (
        "the lens, which looked at the reader, has gone to the right"
    )


FLICK = """() => {
  const canvas = document.querySelector('.world canvas'), box = canvas.getBoundingClientRect();
  for (let k = 1; k <= 6; k += 1) {
    canvas.dispatchEvent(new PointerEvent('pointermove', { pointerId: 1, pointerType: 'mouse', bubbles: true,
      clientX: box.left + box.width / 2 + 4 * k, clientY: box.top + 0.42 * box.height }));
  }
  canvas.dispatchEvent(new PointerEvent('pointerup', { pointerId: 1, pointerType: 'mouse', bubbles: true }));
}"""


def free_body(dcm, rate, seconds, off=0.0):
    """Where a body ends that is let go at this rate, by Euler's equations; or where
    an instrument in it believes so.
    """
    inertia = np.array((1.1, 0.8, 1.25))

    def change(_, state):
        omega = state[:3]
        turning = dcm_rate(state[3:].reshape(3, 3), omega + off)
        return np.concatenate((-np.cross(omega, inertia * omega) / inertia, turning.ravel()))

    state = np.concatenate((rate, np.ravel(dcm)))
    end = solve_ivp(change, (0, seconds), state, rtol=1e-9, atol=1e-9).y[3:, -1]
    return nearest_dcm(end.reshape(3, 3)).dcm


def test_the_camera_is_thrown_and_the_small_turns_add_up(open_essay):
    page = open_essay()
    scroll_to(page, "it-moves")
    page.locator(".world canvas").hover()
    page.mouse.down()
    page.evaluate(FLICK)
    page.mouse.up()
    rest(page)
    # Without motion its whole flight is over at once.
    content = page.evaluate("document.querySelector('.world').world.content()")
    rate, start = np.array(content["rate"]), dcm_from_body_fixed(content["angles"], "zxy")
    assert 0.5 < np.linalg.norm(rate) < 2.6 and content["time"] == 24
    truth, reported = free_body(start, rate, 24), free_body(start, rate, 24, np.radians(1.5))
    assert axis_angle_from_dcm(camera(page) @ truth.T)[1] < 0.02
    off = np.degrees(axis_angle_from_dcm(reported @ truth.T)[1])
    match = re.search(r"is (\d+) degrees off", page.locator(".look").inner_text())
    assert abs(float(match[1]) - off) < 2
    # Its address opens it as it flies, and the text takes it back.
    reopened = open_essay(fragment_of("rotations", content))
    assert axis_angle_from_dcm(camera(reopened) @ camera(page).T)[1] < 0.02
    scroll_to(reopened, "your-turn")
    assert reopened.evaluate("document.querySelector('.world').world.state.thrown") is None
    # Without a pointer there is a button.
    page.get_by_role("button", name="Set it swinging").press("Enter")
    rest(page)
    assert page.evaluate("document.querySelector('.world').world.content().rate") != content["rate"]


def test_where_scripts_run_the_stills_wait_to_be_printed(browser):
    page, asked = browser.new_page(), []
    page.on("request", lambda request: asked.append(request.url))
    page.goto((HTML / "rotations.html").resolve().as_uri())
    page.locator(".world").hover()
    page.locator(".world:is([data-ready], [data-stills])").wait_for()
    assert "/stills/" not in "".join(asked)
    page.pdf()
    assert "".join(asked).count("/stills/") == len(STILLS)
    page.close()


def test_an_address_that_somebody_has_made_up_is_not_taken(open_essay):
    for content in (
        {"stop": "lock", "angles": ["x", 0, 0]},
        {"stop": "nowhere"},
        {"stop": "lock", "angles": [1e9, 0, 0]},
    ):
        page = open_essay(fragment_of("rotations", content))
        assert not page.evaluate("document.querySelector('.world').world.state.free")


CAPTIONED = """<!doctype html><html lang="en"><head><meta charset="utf-8"><title>A chapter</title><link rel="icon"
href="data:,"><link rel="stylesheet" href="moving.css"><style>a.headerlink {{ visibility: hidden; }}</style></head>
<body><div style="height: 3000px"></div><figure id="figure-vane">{still}<figcaption>A vane.<a class="headerlink"
href="#figure-vane">#</a></figcaption></figure><script src="shared.js"></script><script src="simple.js"></script>
</body></html>"""


def test_the_link_of_a_caption_carries_how_the_figure_stands(browser, tmp_path):
    from notebook_pages.moving import scripts_and_styles
    from orientation_figures.moving import SimpleFigure

    texts, _ = scripts_and_styles(["simple"])
    for name, text in texts.items():
        (tmp_path / name).write_text(text, "utf8")
    (tmp_path / "index.html").write_text(
        CAPTIONED.format(still=SimpleFigure(axis="z", angle=0.5).still()), "utf8"
    )
    page = browser.new_page()
    page.goto((tmp_path / "index.html").as_uri())
    link, angle = page.locator("a.headerlink"), page.locator(".live input[type=number]").first
    assert not link.is_visible()
    angle.fill("40")
    angle.press("Tab")
    link.click()
    address = page.url
    assert address.endswith(link.get_attribute("href")) and "#figure-vane=1." in address
    page.close()
    page = browser.new_page()
    page.goto(address)
    assert float(page.locator(".live input[type=number]").first.input_value()) == 40
    assert page.evaluate("scrollY") > 1000, "the page shows the figure"
    page.close()


PHONE = """angles => {
  for (const [alpha, beta, gamma] of angles) {
    const says = { alpha, beta, gamma, absolute: true };
    window.dispatchEvent(new DeviceOrientationEvent('deviceorientationabsolute', says));
  }
}"""


def test_on_a_telephone_the_gimbal_turns_with_it(open_essay):
    page = open_essay(has_touch=True, is_mobile=True)
    page.evaluate("DeviceOrientationEvent.requestPermission = async () => 'granted'")
    page.get_by_role("button", name="Turn it with this phone").tap()
    page.wait_for_function("document.querySelector('.look').textContent.includes('Waiting')")
    page.evaluate(PHONE, [[70, 15, -10]])
    rest(page)
    assert camera(page) == pytest.approx(
        dcm_from_body_fixed(np.radians((70, 15, -10)), "zxy"), abs=1e-6
    )
    # Upright it is locked; once round, the numbers are back with the other sign.
    page.evaluate(PHONE, [[70, 88, -10]])
    rest(page)
    assert "gimbal lock" in page.locator(".look").inner_text()
    page.evaluate(PHONE, [[(70 + 20 * k) % 360, 15, -10] for k in range(19)])
    rest(page)
    assert "q is now" in page.locator(".look").inner_text()
    assert camera(page) == pytest.approx(
        dcm_from_body_fixed(np.radians((70, 15, -10)), "zxy"), abs=1e-6
    )
