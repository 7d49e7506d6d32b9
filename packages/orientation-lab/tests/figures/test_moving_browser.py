"""The moving figures as a reader meets them: by mouse, by keys alone,
by touch, in both themes, from disk.
"""

import gzip
import json

import numpy as np
import pytest
from figure_pages import (  # noqa: F401
    KINDS,
    NARROW,
    THEMES,
    WIDE,
    drag_with_a_finger,
    drawing,
    front_end,
    numbers,
    open_figure,
    settle,
    type_number,
    words,
)
from test_site import SIDEWAYS, violations

import orientation as module
from orientation_figures import moving
from orientation_figures.moving import bundle

# bytes of our own JavaScript for all figures together, compressed; a page loads those it shows
HEAVIEST = 80_000
SMALLEST_TARGET = 24  # pixels
MOST_WRITTEN = 300  # attributes, texts and elements that one picture of a drag may change


def test_every_figure_is_tested():
    assert {"triad", "gimbal", "nine_numbers"} <= set(KINDS)
    modules = {path.stem for path in (bundle.FOLDER / "js").glob("*.js")} | {*bundle.DESCRIBED}
    # The explorer needs Python for its algebra: tests/test_explorer.py and test_live.py. A formula
    # that is taken away is no drawing: test_take_away.py.
    own = {own for names in bundle.OWN.values() for own in names}
    assert modules == {*KINDS, *bundle.SHARED, *own, "explorer", "formula"}


def test_weight(front_end):
    """All figures together; the workbench has a page of its own, where
    it is alone with what all share.
    """
    kinds = [kind for kind in KINDS if kind != "workbench"]
    weights = {
        name: len(gzip.compress((front_end / f"{name}.js").read_bytes(), 6))
        for name in ("shared", *KINDS)
    }
    assert sum(weights[name] for name in ("shared", *kinds)) < HEAVIEST, weights
    assert weights["shared"] + weights["workbench"] < HEAVIEST, weights


# Each shape by its colour and the box that it fills. Labels are pictures of letters, without a
# class; what is there for the hand or tells the hand's place alone, and the lines behind a graph,
# stand in one of the pictures only.
SHAPES = """(box) => {
  for (const still of document.querySelectorAll('.still')) still.style.display = 'block';
  return [...document.querySelectorAll(box)].map((sheet) =>
    [...sheet.querySelectorAll('path[class]:not(.faint, .paper)')]
      .map((shape) => [[...shape.classList].find((name) => /^([A-Z]|ink|muted|accent)$/.test(name)), shape])
      .filter(([colour]) => colour)
      .map(([colour, shape]) => {
        const { x, y, width, height } = shape.getBBox();
        return [colour, [x, y, x + width, y + height]];
      }));
}"""


def without_twin(shapes, others):
    """The shapes that have no other of their colour in the same place."""
    return [
        (colour, place)
        for colour, place in shapes
        if not any(
            colour == twin_colour and place == pytest.approx(twin, abs=0.16)
            for twin_colour, twin in others
        )
    ]


# How many pictures are asked for in twenty frames.
ASKED = """async () => {
  const frame = window.requestAnimationFrame;
  let asked = 0;
  window.requestAnimationFrame = (work) => { asked += 1; return frame(work); };
  for (let k = 0; k < 20; k += 1) await new Promise((done) => frame(done));
  window.requestAnimationFrame = frame;
  return asked;
}"""


@pytest.mark.sampled(3)
@pytest.mark.parametrize("theme", THEMES)
@pytest.mark.parametrize("viewport", [WIDE, NARROW], ids=["wide", "narrow"])
@pytest.mark.parametrize("kind", KINDS)
def test_figure_on_the_page(open_figure, kind, viewport, theme):
    page = open_figure(kind, theme, viewport)
    assert page.evaluate("window.shift") < 0.001, "the page moves when the figure wakes"
    assert page.evaluate(SIDEWAYS) <= 0
    assert violations(page) == []
    boxes = ("still", "live .sheet")
    views = [
        page.get_attribute(f".moving .{box}{' svg' if box == 'still' else ''}", "viewBox")
        for box in boxes
    ]
    assert views[0] == views[1], "still and figure differ in size"
    assert not page.is_visible(".moving .still")
    # Once it is drawn, a figure asks for no further picture.
    assert page.evaluate(ASKED) == 0
    page.emulate_media(media="print")
    assert page.locator(".still svg").first.is_visible() and not page.is_visible(".live")
    page.emulate_media(media="screen")
    # The still comes from Python, the figure from the browser: every shape lies where its twin
    # does. What stands beside the first picture grows with time in the page, and is whole on paper.
    (still, *_), (live, *_) = (page.evaluate(SHAPES, box) for box in (".still svg", ".live .sheet"))
    assert still
    assert without_twin(still, live) == []
    assert without_twin(live, still) == []


@pytest.mark.sampled(1)
@pytest.mark.parametrize("kind", KINDS)
def test_nothing_moves_while_the_script_is_on_its_way(open_figure, kind):
    """The still stands where the drawing will stand, in the room that the figure will need."""
    for viewport in (WIDE, NARROW):
        asleep = open_figure(kind, viewport=viewport, java_script_enabled=True)
        box = asleep.locator(".sheet").first.bounding_box()
        after = asleep.locator("#after").bounding_box()
        asleep.evaluate(
            "() => { document.querySelector('.live').remove(); delete "
            "document.querySelector('.moving').dataset.ready; }"
        )
        still = asleep.locator(".still svg").first.bounding_box()
        assert [still[side] for side in ("x", "y", "width", "height")] == pytest.approx(
            [box[side] for side in ("x", "y", "width", "height")], abs=1
        )
        # Fonts differ between pages: what is kept free is right to a line of text.
        assert asleep.locator("#after").bounding_box()["y"] == pytest.approx(after["y"], abs=60)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("kind", KINDS)
def test_without_scripts_there_is_the_still(open_figure, kind):
    page = open_figure(kind, java_script_enabled=False)
    assert page.locator(".still svg").first.is_visible()
    assert len(page.locator(".still svg").first.get_attribute("aria-label").split()) > 10


def test_all_figures_on_one_page(open_figure):
    page = open_figure(KINDS)
    assert page.locator(".moving[data-ready]").count() == len(KINDS)
    assert violations(page) == []
    ids = page.eval_on_selector_all("[id]", "all => all.map(one => one.id)")
    assert len(ids) == len(set(ids))


# What a control must do when it is used by keys: something on the page changes.
FOCUSED = """() => {
  const now = document.activeElement;
  const box = now.getBoundingClientRect(), style = getComputedStyle(now), label = now.labels?.[0] ?? now;
  const formulas = [...label.querySelectorAll('[aria-label]')].map((one) => one.getAttribute('aria-label'));
  return { tag: now.tagName, type: now.type ?? '', 
    name: now.getAttribute('aria-label') ?? [label.textContent, ...formulas].join(' '),
           outlined: style.outlineStyle !== 'none' && parseFloat(style.outlineWidth) > 0,
           seen: box.width > 0 && box.height > 0, inside: Boolean(now.closest('.live')),
           value: now.getAttribute('aria-valuetext') };
}"""


@pytest.mark.sampled(1)
@pytest.mark.parametrize("kind", KINDS)
def test_keys_alone(open_figure, kind):
    """Tab reaches every control in turn, each shows the focus and has a
    name, and each does what it says.
    """
    page = open_figure(kind)
    stops, tags = [], set()
    for _ in range(60):
        page.keyboard.press("Tab")
        stop = page.evaluate(FOCUSED)
        if not stop["inside"]:
            break
        assert stop["name"].strip() and stop["outlined"] and stop["seen"], stop
        stops.append(stop["name"])
        tags.add(stop["type"] or stop["tag"])
        settle(page)  # what leaves the focus is drawn as it was
        before = drawing(page)
        if stop["type"] == "range":
            assert stop["name"] in stop["value"] and any(
                digit in stop["value"] for digit in "0123456789"
            )
            for key in ("ArrowLeft", "ArrowRight"):  # a recording begins at its first moment
                page.keyboard.press(key)
                settle(page)
                if page.evaluate(FOCUSED)["value"] != stop["value"]:
                    break
            else:
                pytest.fail(f"no key moves {stop['name']}")
        elif stop["tag"] == "svg":
            # A view is turned back by Home; where the keys turn a frame instead, by the opposite key.
            for key, opposite in (("ArrowUp", "ArrowDown"), ("ArrowLeft", "ArrowRight")):
                page.keyboard.press(key)
                settle(page)
                assert drawing(page) != before
                page.keyboard.press("Home" if "Home" in stop["name"] else opposite)
                settle(page)
                assert drawing(page) == before
        elif stop["type"] == "select-one":
            page.keyboard.press("ArrowDown")
            settle(page)
            page.keyboard.press("ArrowUp")
            settle(page)
    else:
        pytest.fail("the focus is caught in the figure")
    # One stop for each group of radio buttons, and for each table of numbers.
    controls = page.eval_on_selector_all(
        ".live :is(input:not([type=radio]:not(:checked)), select:not(:disabled), textarea, "
        "[role=application], a[href], button:not([tabindex='-1'], :disabled))",
        "all => all.filter(one => one.checkVisibility({ visibilityProperty: true })).length",
    )
    assert len(stops) == controls and "svg" in {tag.lower() for tag in tags}


@pytest.mark.sampled(1)
@pytest.mark.parametrize("colours", ["none", "active"])
@pytest.mark.parametrize("kind", KINDS)
def test_targets_are_large_enough_for_a_finger(open_figure, kind, colours):
    """Of each control the box itself, without the words beside it; also in colours
    that the reader's system forces.
    """
    page = open_figure(kind, viewport=NARROW, forced_colors=colours)
    boxes = page.eval_on_selector_all(
        ".live :is(button, input, select, .grip)",
        """all => all.map(one => [one.outerHTML.slice(0, 90), one.getBoundingClientRect()])
              .filter(([, box]) => box.width).map(([html, box]) => [html, box.width, box.height])""",
    )
    assert boxes
    assert [box for box in boxes if min(box[1:]) < SMALLEST_TARGET] == []


@pytest.mark.sampled(1)
@pytest.mark.parametrize("kind", KINDS)
def test_touch(open_figure, kind):
    """A finger turns the view sideways, and up and down it still scrolls the page."""
    page = open_figure(kind, viewport=NARROW, has_touch=True, is_mobile=True)
    page.evaluate("document.querySelector('#after').style.height = '2000px'")
    box = page.locator(".sheet").first.bounding_box()
    corner = box["x"] + 12, box["y"] + box["height"] - 12
    before = drawing(page)
    drag_with_a_finger(page, corner, (corner[0] + 60, corner[1]))
    assert drawing(page) != before
    assert page.evaluate("scrollY") == 0
    drag_with_a_finger(page, corner, (corner[0], corner[1] - 150))
    page.wait_for_function("scrollY > 50")


# Where a part is held: the middle of a spot, or a corner of a line,
# which always is the same point of it.
HOLD = """([part, corner]) => {
  const grip = document.querySelector(`.sheet [data-part="${part}"]`), matrix = grip.getScreenCTM();
  const [x, y] = corner === null ? [grip.cx.baseVal.value, grip.cy.baseVal.value]
    : grip.getAttribute('d').match(/-?[0-9.]+/g).map(Number).slice(2 * corner, 2 * corner + 2);
  const place = new DOMPoint(x, y).matrixTransform(matrix);
  grip.parentNode.append(grip);   // another grip may lie over it
  return [place.x, place.y];
}"""
DRAGS = [
    ("triad", "1", None, (10, 45)),
    ("triad", "axis", None, (-20, 50)),
    ("gimbal", "B", 4, (10, 50)),
    ("gimbal", "C", 12, (15, -45)),
    ("gimbal", "D", None, (10, 35)),
    ("nine_numbers", "0", None, (-10, 45)),
    ("quaternion", "q", None, (10, 45)),
    ("successive", "2", None, (-40, 50)),
]


@pytest.mark.sampled(2)
@pytest.mark.parametrize("touch", [False, True], ids=["mouse", "touch"])
@pytest.mark.parametrize("kind, part, corner, way", DRAGS)
def test_parts_follow_the_pointer(open_figure, kind, part, corner, way, touch):
    page = open_figure(kind, viewport=NARROW, has_touch=touch, is_mobile=touch)
    page.evaluate("document.querySelector('#after').style.height = '2000px'")
    start = page.evaluate(HOLD, [part, corner])
    end = start[0] + way[0], start[1] + way[1]
    before = page.locator(".live").inner_text()
    if touch:
        drag_with_a_finger(page, start, end)
    else:
        page.mouse.move(*start)
        page.mouse.down()
        page.mouse.move(*end, steps=6)
        page.mouse.up()
        settle(page)
    assert page.evaluate("scrollY") == 0, "the page has moved instead"
    assert page.locator(".live").inner_text() != before
    if corner is not None:
        return
    reached = page.evaluate(HOLD, [part, corner])
    if part == "axis" or kind == "nine_numbers":
        assert reached == pytest.approx(end, abs=3), "it is not where the pointer is"
    else:
        assert np.dot(np.subtract(reached, start), way) > 100, "it went another way"


@pytest.mark.sampled(1)
@pytest.mark.parametrize("part, name", [("B", "psi"), ("C", "theta")])
def test_an_arm_stays_under_the_pointer(open_figure, part, name):
    """Places of one point of an arm, from the slider; held there, the
    arm follows the pointer along them.
    """
    page, places = open_figure("gimbal"), []
    for angle in (40, 20, 0, -20, 20):
        type_number(page, f"{name} in degrees", angle)
        places.append(page.evaluate(HOLD, [part, 8]))
    assert places[1] == pytest.approx(places[-1])
    page.mouse.move(*places[1])
    page.mouse.down()
    for angle, place in ((0, places[2]), (-20, places[3]), (40, places[0])):
        page.mouse.move(*place, steps=10)
        settle(page)
        assert float(page.get_by_label(f"{name} in degrees").input_value()) == pytest.approx(
            angle, abs=2
        )
    page.mouse.up()


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    "axis, angle", [((0, 0, 1), 30), ((1, 2, -2), -125), ((-3, 0.5, 1), 180), ((0, 1, 0), 0)]
)
def test_numbers_of_the_triad_are_those_of_the_module(open_figure, axis, angle):
    page = open_figure("triad")
    for name, value in zip("xyz", axis):
        type_number(page, f"{name} component of the axis", value)
    type_number(page, "theta in degrees", angle)
    radians = np.radians(angle)
    dcm = module.dcm_from_axis_angle(axis, radians)
    assert numbers(page, "Direction cosine matrix of A with respect to N") == pytest.approx(
        dcm, abs=6e-4
    )
    quaternion = module.quaternion_from_axis_angle(axis, radians)
    assert numbers(page, "Quaternion, scalar first") == pytest.approx(quaternion, abs=6e-4)
    unit = np.divide(axis, np.linalg.norm(axis))
    assert numbers(page, "Axis and angle") == pytest.approx([*unit, angle], abs=6e-4)
    for sequence in module.SEQUENCES:
        page.get_by_label("Sequence of the Euler angles").select_option(sequence)
        settle(page)
        shown = np.radians(numbers(page, "Euler angles"))
        assert module.dcm_from_body_fixed(shown, sequence) == pytest.approx(dcm, abs=4e-3)


def test_every_number_of_the_triad_says_what_it_means(open_figure):
    page = open_figure("triad")
    plain, meanings = drawing(page), set()
    cells = page.locator(".live button.number")
    assert cells.count() == 9 + 3 + 4 + 4
    for k in range(cells.count()):
        cells.nth(k).hover()
        meanings.add(words(page))
        assert drawing(page) != plain and page.locator(".sheet .faded").count() > 5
    assert len(meanings) == cells.count()
    page.mouse.move(1, 1)
    settle(page)
    assert drawing(page) == plain
    # By the arrow keys, and read aloud.
    page.locator(
        '[aria-label="Direction cosine matrix of A with respect to N"] button'
    ).first.focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowDown")
    assert page.evaluate("document.activeElement.dataset.at") == "1,1"
    page.wait_for_function(
        "document.querySelector('[role=status]').textContent.includes('a y · n y = cos')"
    )
    page.keyboard.press("Escape")
    settle(page)
    assert page.locator(".sheet .faded").count() == 0


@pytest.mark.sampled(1)
@pytest.mark.parametrize("sequence", module.SEQUENCES)
def test_gimbal_shows_the_matrix_of_the_module_and_its_lock(open_figure, sequence):
    page = open_figure("gimbal", reduced_motion="reduce")  # so that the buttons jump to the end
    page.get_by_label("Sequence").select_option(sequence)
    for angles in ((30, 40, -70), (-160, 90, 25), (10, 0, 100)):
        for name, angle in zip(("psi", "theta", "phi"), angles):
            type_number(page, f"{name} in degrees", angle)
        dcm = module.dcm_from_body_fixed(np.radians(angles), sequence)
        assert numbers(page, "Direction cosine matrix of D with respect to A") == pytest.approx(
            dcm, abs=6e-4
        )
        margin = np.degrees(module.gimbal_lock_margin(np.radians(angles), sequence))
        assert float(page.get_attribute("[role=meter]", "aria-valuenow")) == pytest.approx(
            margin, abs=0.06
        )
    # At lock two sliders do the same.
    matrix = "Direction cosine matrix of D with respect to A"
    type_number(page, "theta in degrees", -50)
    assert "three ways" in words(page)
    assert page.locator(".slider.same").count() == 0
    page.get_by_role("button", name="To gimbal lock").click()
    settle(page)
    assert words(page).startswith("Gimbal lock")
    assert page.locator(".slider.same").count() == 2
    locked, before = numbers(page, matrix), drawing(page)
    page.get_by_role("button", name="Trade").click()
    settle(page)
    assert drawing(page) != before, "the rings did not move"
    assert numbers(page, matrix) == pytest.approx(locked, abs=2e-3), "the camera moved"


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "example", ["Valid", "One decimal", "Measured", "Skewed", "1.2 times", "Left-handed"]
)
def test_nine_numbers_says_what_the_module_says(open_figure, example):
    page = open_figure("nine_numbers")
    page.get_by_role("button", name=example).click()
    settle(page)
    matrix = page.locator(".entries input").evaluate_all("all => all.map(one => Number(one.value))")
    matrix = np.reshape(matrix, (3, 3))
    message = moving.NineNumbersFigure(matrix=matrix).check()
    assert words(page).startswith(message or "A direction cosine matrix")
    fails = page.locator(".checks .fails").count()
    assert (fails == 0) == (example == "Valid")
    take = page.get_by_role("button", name="Take the nearest")
    if example in ("Valid", "Left-handed"):
        assert take.is_disabled()
        return
    nearest = module.nearest_dcm(matrix)
    assert numbers(page, "Nearest direction cosine matrix") == pytest.approx(nearest.dcm, abs=6e-5)
    assert f"{nearest.distance:.4f}" in page.locator(".live").inner_text()
    page.emulate_media(reduced_motion="reduce")
    take.click()
    settle(page)
    assert words(page).startswith("A direction cosine matrix")
    assert page.locator(".checks .fails").count() == 0


def test_after_enter_a_field_shows_what_the_figure_uses(open_figure):
    """What is being typed is left alone until then."""
    numbers_page, simple = open_figure("nine_numbers"), open_figure("simple")
    entry = numbers_page.get_by_label("row x, column y")
    for field, typed, used in (
        (simple.get_by_label("theta in degrees"), "", "35"),
        (simple.get_by_label("theta in degrees"), "270", "-90"),
        (entry, "99", "10"),
    ):
        field.fill(typed)
        assert field.get_attribute("aria-invalid") == "true"
        field.press("Enter")
        assert (field.input_value(), field.get_attribute("aria-invalid")) == (used, "false")
    # The two ends of a slider are one orientation, but not one place.
    for key, end, said in (("End", "180", " 180° about"), ("Home", "-180", " \u2212180° about")):
        simple.get_by_role("slider").press(key)
        assert said in words(simple) and simple.get_by_role("slider").input_value() == end
    simple.get_by_label("theta in degrees").fill("1")
    settle(simple)
    assert simple.get_by_role("slider").get_attribute("aria-valuetext") == "theta, 1 degree"
    entry.fill("")
    assert entry.get_attribute("aria-invalid") == "true"
    entry.type("-0.25")
    settle(numbers_page)
    assert entry.input_value() == "-0.25" and entry.get_attribute("aria-invalid") == "false"


# What makes a dragged figure fast is tested here.
MOVES = """async ({ pictures, moves }) => {
  const control = document.querySelector('.live input[type=range], .live input, .live textarea');
  const [low, high] = control.type === 'range' ? [Number(control.min), Number(control.max)] : [-1, 1];
  const frame = window.requestAnimationFrame, picture = () => new Promise((done) => frame(() => frame(done)));
  const counts = [];
  let records = [];
  await picture();
  new MutationObserver((list) => records.push(...list)).observe(
    document.querySelector('.live'), { subtree: true, attributes: true, childList: true, characterData: true });
  for (let k = 0; k < pictures; k += 1) {
    let asked = 0;
    records = [];
    window.requestAnimationFrame = (work) => { asked += 1; return frame(work); };
    for (let n = 0; n < moves; n += 1) {
      const value = low + (high - low) * (0.4 + 0.01 * k + 0.001 * n);
      // A text takes the four numbers of a quaternion, the scalar last.
      control.value = control.type === 'textarea' ? `0, 0, ${Math.sin(value)}, ${Math.cos(value)}` : String(value);
      control.dispatchEvent(new Event('input', { bubbles: true }));
    }
    window.requestAnimationFrame = frame;
    await picture();
    const kept = new Set(records.flatMap((one) => [...one.removedNodes]));
    const made = records.filter((one) => !one.target.matches?.('.words'))   // another sentence may have another formula
      .flatMap((one) => [...one.addedNodes]).filter((node) => !kept.has(node)).length;
    counts.push({ asked, written: records.length, made });
  }
  return counts;
}"""


@pytest.mark.sampled(1)
# That has buttons and no slider.
@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "hands"])
def test_a_drag_draws_one_picture_for_each_frame_and_writes_only_what_changes(open_figure, kind):
    # The slider of a challenge adjusts the last turn.
    page = open_figure(moving.ChallengeFigure(turns=[("z", 0.3)]) if kind == "challenge" else kind)
    counts = page.evaluate(MOVES, {"pictures": 5, "moves": 10})
    # A run that still grows has asked for the next picture by itself.
    assert {count["asked"] for count in counts} <= ({0, 1} if kind == "motion" else {1}), (
        "several pictures for one frame"
    )
    assert 0 < max(count["written"] for count in counts) < MOST_WRITTEN
    assert np.median([count["made"] for count in counts]) == 0, "elements are made anew"


def test_reduced_motion_is_respected(open_figure):
    page = open_figure("gimbal")
    page.evaluate("""() => {
      window.seen = new Set();
      const look = () => {
        seen.add(document.querySelector('.slider input[type=number]').value);
        requestAnimationFrame(look);
      };
      look();
    }""")
    page.get_by_role("button", name="All to zero").click()
    page.wait_for_function("seen.has('0')")
    assert page.evaluate("seen.size") > 2  # It was also seen on its way.
    calm = open_figure("gimbal", reduced_motion="reduce")
    calm.get_by_role("button", name="All to zero").click()
    settle(calm)
    assert calm.get_by_label("psi in degrees").input_value() == "0"


def test_a_figure_starts_from_its_own_state(open_figure):
    """Two figures of one kind on a page do not know of each other."""
    page = open_figure(
        [moving.TriadFigure(angle=0.5), moving.TriadFigure(angle=-1.0, axis=(0, 0, 1))]
    )
    fields = page.get_by_label("theta in degrees")
    assert [float(fields.nth(k).input_value()) for k in range(2)] == pytest.approx(
        np.degrees([0.5, -1.0]), abs=0.01
    )
    fields.nth(0).fill("90")
    settle(page)
    assert float(fields.nth(1).input_value()) == pytest.approx(np.degrees(-1.0), abs=0.01)
    assert json.loads(page.get_attribute(".moving >> nth=1", "data-state"))["angle"] == -1
