"""The pictures: their geometry is the module's, they say in words what
they show, and they come out the same.
"""

import json
import re
import sys
from itertools import combinations
from xml.etree import ElementTree

import numpy as np
import pytest

from orientation import dcm_from_axis_angle, dcm_from_body_fixed, random_orientations, simple_dcm
from orientation_figures import drawing as drawings
from orientation_figures.animation import Animation, one_after_another
from orientation_figures.drawing import (
    IN_SPACE,
    Drawing,
    looking_down,
    path_data,
    typeset,
    view_from,
)
from orientation_figures.objects import draw_book, draw_eye, plane_drawing, turning_frames_animation
from orientation_figures.style import DARK, EITHER, LIGHT, STROKES
from orientation_figures.words import BARB, HEADS

ALT = "A triad of unit vectors, drawn for a test: x to the left, y to the right, z up."
GIMBAL_ANGLES = np.radians((35, 25, 25))
AXIS, ANGLE = np.array([0.36, -0.48, 0.8]), 2.1


def gimbal_frames(angles):
    """Triads of the four frames that three turns lead through, one above the other."""
    A = np.eye(3)
    B = simple_dcm("z", angles[0]) @ A
    C = simple_dcm("x", angles[1]) @ B
    D = simple_dcm("y", angles[2]) @ C
    drawing = Drawing(ALT, view_from(np.radians(92), np.radians(24)), 112)
    for row, (letter, frame) in enumerate(zip("DCBA", (D, C, B, A))):
        drawing.triad(
            letter, frame, 2.55 * drawing.view[0] + (1 - 1.2 * row) * drawing.view[1], 0.46
        )
    return drawing


def gimbal_animation(angles=GIMBAL_ANGLES):
    return Animation(
        lambda progress: gimbal_frames(one_after_another(angles, progress)),
        frames=5,
        steps=[
            ("B, C and D turn about the z axis through psi", angles[0]),
            ("C and D turn about the x axis of B through theta", angles[1]),
            ("D turns about the y axis of C through phi", angles[2]),
        ],
    )


def samples():
    """One of each kind of figure."""
    every = (
        Drawing(ALT)
        .triad("N", np.eye(3))
        .triad("A", dcm_from_axis_angle(AXIS, ANGLE), (0, 1, 0), 0.5)
    )
    every.arc((1, 0, 0), (0, 1, 1), label=r"$\theta$").right_angle((1, 0, 0), (0, 0, 1)).circle(
        (1, 2, 3)
    )
    every.box(np.eye(3), (1, 2, 3)).cylinder((0, 0, 0), (1, 1, 0), 0.2).area(np.eye(3)).dot(
        (0, 0, 1)
    )
    every.line(np.eye(3), "B", "tube").node((2, 2, 0), "Z").arrow((1, 1, 1), label="$v$", bow=20)
    draw_book(draw_eye(every, (0, 0, 2)), np.eye(3)).note(r"words and $\frac{\theta}{2}$")
    return {
        "every": every,
        "plane": plane_drawing("y", 0.5, components=True),
        "against": plane_drawing("-y", 0.5),
        "gimbal": gimbal_frames(GIMBAL_ANGLES),
        "moving": gimbal_animation(),
        "turning": turning_frames_animation(),
    }


SAMPLES = samples()


def svg_of(figure):
    """The SVG element of a figure, parsed as XML: so it is well formed."""
    return ElementTree.fromstring(re.search(r"<svg.*</svg>", figure._repr_html_(), re.DOTALL)[0])


def arrows(drawing, letter):
    """From each arrow of a frame: the vector on the sheet from its tail to its tip, in pixels."""
    tails = [place[0] for kind, _, place, _ in drawing.marks if kind == f"axis {letter}"]
    tips = [
        place[0]
        for kind, shape, place, _ in drawing.marks
        if kind == f"head {letter}" and shape == "MLLLZ"
    ]
    return np.array(tips[: len(tails)]) - tails


# Geometry.


@pytest.mark.parametrize("axis", "xyz")
def test_a_positive_angle_is_seen_counterclockwise(axis):
    view = looking_down(axis)
    assert np.linalg.det(view) == pytest.approx(1)
    drawing = Drawing(ALT, view)
    second = view[0] @ simple_dcm(axis, 0.3)  # what points to the right, turned
    across, down = drawing.on_sheet(second)
    assert np.arctan2(-down, across) == pytest.approx(0.3)


def test_views_are_frames_and_keep_z_upright():
    for azimuth, elevation in ((0.4, 0.2), (-2, 1.1), (3, -0.7)):
        view = view_from(azimuth, elevation)
        np.testing.assert_allclose(view @ view.T, np.eye(3), atol=1e-15)
        assert np.linalg.det(view) == pytest.approx(1)
        assert view[0] @ (0, 0, 1) == pytest.approx(0) and view[1] @ (0, 0, 1) > 0
        towards = np.cos(elevation) * np.array(
            [np.cos(azimuth), np.sin(azimuth), np.tan(elevation)]
        )
        np.testing.assert_allclose(view[2], towards, atol=1e-15)


def test_a_triad_shows_the_rows_of_its_matrix():
    dcm = dcm_from_body_fixed((0.7, -0.4, 1.2), "zxy")
    drawing = Drawing(ALT, scale=100).triad("A", dcm, (0.3, 1, -2), 0.8)
    expected = 80 * dcm @ IN_SPACE[:2].T * (1, -1)
    np.testing.assert_allclose(arrows(drawing, "A"), expected, atol=1e-9)


def test_an_arc_sweeps_as_the_module_turns():
    dcm = dcm_from_axis_angle(AXIS, ANGLE)
    for n, a in zip(np.eye(3), dcm):
        drawing = Drawing(ALT).turn(AXIS, ANGLE, n, radius=1)
        (_, commands, curve, _), (_, _, head, _) = drawing.marks
        np.testing.assert_allclose(head[0], drawing.on_sheet(a), atol=1e-9)
        np.testing.assert_allclose(curve[0], drawing.on_sheet(n), atol=1e-9)
        # Between the ends, the curve keeps to the true arc.
        dense = drawing.on_sheet(
            [dcm_from_axis_angle(AXIS, part).T @ n for part in np.linspace(0, ANGLE, 2000)]
        )
        for k in range(1, len(curve), 3):
            middle = np.array([1, 3, 3, 1]) / 8 @ curve[k - 1 : k + 3]
            assert np.linalg.norm(dense - middle, axis=1).min() < 0.1
        assert commands == "MCCCC"


def test_an_arc_between_two_directions_ends_on_the_second():
    drawing = Drawing(ALT).arc((1, 0, 0), (0.2, 0.9, -0.4), radius=1)
    end = np.array((0.2, 0.9, -0.4)) / np.linalg.norm((0.2, 0.9, -0.4))
    np.testing.assert_allclose(drawing.marks[1][2][0], drawing.on_sheet(end), atol=1e-9)


@pytest.mark.parametrize(
    "axis, name",
    [(sign + axis, name) for sign in ("", "-") for axis in "xyz" for name in ("theta", "phi")],
)
def test_plane_figures_turn_the_second_frame_the_way_they_say(axis, name):
    drawing = plane_drawing(axis, 0.4, "C", "D", name, components=True)
    direction = np.eye(3)["xyz".index(axis[-1])] * (-1 if axis[0] == "-" else 1)
    np.testing.assert_allclose(drawing.view[2], direction)
    assert np.linalg.det(drawing.view) == pytest.approx(1)
    turned = [
        row for row, letter in zip(dcm_from_axis_angle(direction, 0.4), "xyz") if letter != axis[-1]
    ]
    np.testing.assert_allclose(arrows(drawing, "D")[:2], drawing.on_sheet(turned), atol=1e-9)
    assert f"through {name}" in drawing.alt and "counterclockwise" in drawing.alt


def test_arrows_along_the_line_of_sight_are_circles():
    towards, away = (Drawing(ALT, looking_down("z")).arrow((0, 0, z), colour="A") for z in (1, -1))
    assert [kind for kind, *_ in towards.marks] == ["paper A", "head A"]
    assert [shape for _, shape, *_ in away.marks] == ["MCCCCZ", "MLML"]


def test_bodies_show_the_faces_that_look_at_the_reader():
    faces = Drawing(ALT).box(np.eye(3), (1, 1, 1)).marks
    seen = [np.ptp(place, axis=0).max() > 0 for _, _, place, _ in faces]
    assert seen == [True, False] * 3  # the camera stands where x, y and z are positive
    caps = Drawing(ALT).cylinder((0, 0, 0), (0, 0, 1), 0.3).marks[-2:]
    assert [np.ptp(place, axis=0).max() > 0 for _, _, place, _ in caps] == [False, True]


def test_light_comes_from_the_upper_left_wherever_the_reader_stands():
    for view in random_orientations(20, 3):
        drawing = Drawing(ALT, view)
        right, up, toward = view
        shades = [drawing.shade(side) for side in (up - right, up, toward, -up, right - up)]
        assert shades == sorted(shades) and shades[0] == 10 and shades[-1] == 80
        # The bright stripe of a cylinder that lies across the picture is above its dark one.
        _, bright, dark, *_ = drawing.cylinder(-right, right, 0.3).marks
        assert bright[0] < dark[0] and bright[2][:, 1].mean() < 0 < dark[2][:, 1].mean()


def test_a_body_that_turns_can_be_animated():
    def turned_box(progress):
        return Drawing(ALT).box(simple_dcm("z", progress), (1, 0.8, 0.3))

    assert "shade-" in Animation(turned_box, [("It turns", 1.0)])._repr_html_()


def test_a_cylinder_touches_its_ends():
    drawing = Drawing(ALT, scale=100).cylinder((0, 0, 0), (0.3, 1, 0.5), 0.2)
    rims = [drawing.on_sheet(end) for end in ((0, 0, 0), (0.3, 1, 0.5))]
    body = drawing.marks[0][2]
    for point in body:
        assert min(np.linalg.norm(point - rim) for rim in rims) < 20 * np.sqrt(2)
    assert max(np.linalg.norm(point - rims[0]) for point in body[[0, -1]]) > 20


# Words, colours and strokes.


@pytest.mark.parametrize(
    "draw, words",
    [
        (lambda: Drawing(""), "alt has only 0 characters"),
        (lambda: Drawing(" " * 60), "alt has only 0 characters"),
        (lambda: Drawing("A triad."), "alt has only 8 characters"),
        (lambda: Drawing("x" * 39), "alt has only 39 characters"),
        (lambda: Drawing(ALT, view=(1, 2)), r"view has shape \(2,\)"),
        (lambda: Drawing(ALT).label((0, 0, 0), "  ")._repr_html_(), "no visible characters"),
        (
            lambda: Animation(
                lambda progress: Drawing(ALT, looking_down("z")).triad(
                    "A", simple_dcm("x", progress)
                ),
                [("A turns", 1.0)],
            ),
            "has different marks from the one at 0",
        ),
    ],
)
def test_what_cannot_be_drawn_is_refused(draw, words):
    with pytest.raises(ValueError, match=words):
        draw()


@pytest.mark.parametrize("name", SAMPLES)
def test_the_words_are_in_the_picture(name):
    figure = SAMPLES[name]
    drawing = figure.drawings[figure.still] if isinstance(figure, Animation) else figure
    svg = svg_of(figure)
    assert svg.get("role") == "img" and svg.get("aria-label") == drawing.alt
    assert drawing.alt in repr(figure) and "0x" not in repr(figure)


def test_labels_are_set_once_each_and_glyphs_shared():
    svg = svg_of(Drawing(ALT).triad("A", np.eye(3)))
    words = [part for part in svg.iter() if (part.get("class") or "").startswith("text")]
    glyphs = [part for part in svg.iter() if part.get("id")]
    uses = [part for part in svg.iter() if part.tag.endswith("use")]
    assert len(words) == 3 and len(uses) == 9 and len(glyphs) == 5  # a, hat, x, y, z


def test_every_letter_that_is_used_is_in_the_font(caplog):
    for figure in SAMPLES.values():
        for drawing in getattr(figure, "drawings", [figure]):
            for _, shape, *_ in drawing.marks:
                if not isinstance(shape, str):
                    typeset.__wrapped__(shape[0])
    assert "does not have a glyph" not in caplog.text


def luminance(colour):
    parts = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255
    return np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4) @ (
        0.2126,
        0.7152,
        0.0722,
    )


#: Drawings as exercises show them, on light pages and in JupyterLab's dark theme, where their ground
#: was a white box. White is in bodies alone.
PICTURES = [SAMPLES[name].picture() for name in ("every", "plane", "gimbal")]


@pytest.mark.parametrize(
    "colours, page, least",
    [
        (LIGHT.values(), "#ffffff", 4.5),
        (DARK.values(), "#121212", 4.5),
        *(
            (re.findall(r"#[0-9a-f]{6}", "".join(PICTURES)), page, 4)
            for page in ("#ffffff", "#15181d")
        ),
    ],
)
def test_colours_stand_out_from_the_page(colours, page, least):
    for colour in colours:
        lighter, darker = sorted((luminance(colour), luminance(page)), reverse=True)
        assert (lighter + 0.05) / (darker + 0.05) >= least, colour
    assert set(LIGHT) == set(DARK) == set(EITHER) == set(STROKES)
    assert "<rect" not in "".join(PICTURES)


def test_frames_differ_without_colour():
    looks = {name: (*STROKES[name], HEADS.get(name, BARB)) for name in "NABCDEFZ"}
    for first, second in combinations(looks, 2):
        assert looks[first] != looks[second], (first, second)


# What comes out.


def test_ids_resolve_and_no_two_figures_share_one_and_sizes_are_small():
    ids = []
    for figure in SAMPLES.values():
        svg, html = svg_of(figure), figure._repr_html_()
        own = [part.get("id") for part in svg.iter() if part.get("id")]
        assert {part.get("href")[1:] for part in svg.iter() if part.get("href")} == set(own)
        assert len(html) < (62_000 if isinstance(figure, Animation) else 25_000)
        ids += own
    assert len(ids) == len(set(ids))


@pytest.mark.parametrize("name", ["plane", "against", "gimbal", "moving", "turning"])
def test_labels_can_be_read_on_a_telephone(name):
    width = float(svg_of(SAMPLES[name]).get("viewBox").split()[2])
    figure = SAMPLES[name]
    for drawing in getattr(figure, "drawings", [figure]):
        sizes = [shape[1] for _, shape, *_ in drawing.marks if not isinstance(shape, str)]
        assert min(sizes) * min(1, 340 / width) >= 11


@pytest.mark.parametrize("name", SAMPLES)
def test_nothing_leaves_the_sheet(name):
    figure = SAMPLES[name]
    left, top, width, height = map(float, svg_of(figure).get("viewBox").split())
    for drawing in getattr(figure, "drawings", [figure]):
        bounds = drawing.bounds()
        assert (
            left < bounds[0]
            and top < bounds[1]
            and bounds[2] < left + width
            and bounds[3] < top + height
        )


# Motion.


def key_frames(animation, letter, number):
    """The tip of one arrow of a frame at every key frame, read from
    the SVG as the browser reads it.
    """
    heads = [
        part
        for part in svg_of(animation).iter()
        if part.get("class") == f"head {letter}" and part.get("d").count("L") == 3
    ]
    head = heads[number]
    (motion,) = head
    values = motion.get("values").split(";")
    tips = np.array(
        [[float(number) for number in re.findall(r"-?[\d.]+", value)[:2]] for value in values]
    )
    times = np.array([float(time) for time in motion.get("keyTimes").split(";")])
    assert (
        motion.get("begin") == "indefinite"
        and times[0] == 0
        and times[-1] == 1
        and (np.diff(times) > 0).all()
    )
    every = np.linspace(0, 1, len(animation.moments))
    return np.column_stack([np.interp(every, times, tips[:, k]) for k in (0, 1)])


@pytest.mark.parametrize(
    "name, sequence, angles, origins",
    [
        ("moving", "zxy", GIMBAL_ANGLES, lambda view: (2.55 * view[0] + view[1], 0.46, 112)),
        (
            "turning",
            "zxz",
            np.radians((50, 45, 40)),
            lambda view: (2.75 * view[0] - 2.45 * view[1], 1, 92),
        ),
    ],
)
def test_key_frames_are_the_modules_orientations(name, sequence, angles, origins):
    animation = SAMPLES[name]
    view = animation.drawings[0].view
    origin, length, scale = origins(view)
    for number in range(3):
        tips = key_frames(animation, "D", number)
        for moment, tip in zip(animation.moments, tips):
            row = dcm_from_body_fixed(one_after_another(angles, moment), sequence)[number]
            expected = scale * ((origin + length * row) @ view[:2].T) * (1, -1)
            # One decimal of a pixel, and its time's four digits.
            np.testing.assert_allclose(tip, expected, atol=0.08)


def test_the_words_of_the_exercise_are_what_is_seen():
    """In each step the arrows named stay, every other arrow of the frames
    named moves, and nothing else does.
    """
    animation = SAMPLES["turning"]
    sentences = [
        sentence for sentence in animation.drawings[0].alt.split(". ") if "not move" in sentence
    ]
    moments = [
        next(k for k, moment in enumerate(animation.moments) if moment == step) for step in range(4)
    ]
    for step, (words, more) in enumerate(animation.steps):
        before, after = (animation.drawings[moments[k]] for k in (step, step + 1))
        named, axis = re.findall(r"\b[A-D]\b", words), re.search(r"the ([xyz]) arrow", more)[1]
        for letter in "ABCD":
            moved = np.linalg.norm(arrows(after, letter) - arrows(before, letter), axis=1) > 1
            assert list(moved) == [letter in named and axis_drawn != axis for axis_drawn in "xyz"]
        assert more.strip("; ").startswith(f"the {axis} arrow")
        assert (
            re.search(rf"\b{axis} arrow", sentences[step])
            and f"turn{'s' if step == 2 else ''}" in sentences[step]
        )


def test_the_exercise_page_does_not_tell_the_sequence():
    html = SAMPLES["turning"]._repr_html_().lower()
    for sequence in ("zxz", "z-x-z", "z, x, z", "euler"):
        assert sequence not in html


def test_nothing_moves_by_itself():
    for name in ("moving", "turning"):
        svg = svg_of(SAMPLES[name])
        assert "<div hidden><button" in SAMPLES[name]._repr_html_(), "a script shows the controls"
        moving = [part for part in svg.iter() if part.tag.startswith("animate")]
        assert len(moving) > 20 and all(part.get("begin") == "indefinite" for part in moving)
        # Until then the paths stand as in the last drawing.
        paths = [
            part.get("d") for part in svg.iter() if part.tag.endswith("path") and part.get("class")
        ]
        last = [
            path_data(shape, place, 1)
            for kind, shape, place, _ in SAMPLES[name].drawings[-1].marks
            if isinstance(shape, str)
        ]
        assert [data for data in last if data in paths] == paths


def test_what_a_screen_reader_says_follows_the_angle():
    html = SAMPLES["moving"]._repr_html_()
    words, texts = json.loads(re.search(r"data-texts='([^']*)'", html)[1])
    assert (
        len(words) == 3
        and words[1] == "Step 2 of 3: C and D turn about the x axis of B through theta"
    )
    assert (
        texts[0] == [0, ", 0 degrees"]
        and texts[5] == [0, ", 35 degrees"]
        and texts[-1] == [2, ", 25 degrees"]
    )
    assert len(texts) == len(SAMPLES["moving"].moments)


@pytest.fixture
def moving_page(browser, tmp_path):
    """A page from a file with the same animation twice, and another one."""
    page = browser.new_context().new_page()
    page.errors = []
    page.on("pageerror", lambda error: page.errors.append(str(error)))
    body = "".join(SAMPLES[name]._repr_html_() for name in ("moving", "turning", "moving"))
    (tmp_path / "page.html").write_text(
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>t</title>{body}', "utf8"
    )
    page.goto((tmp_path / "page.html").as_uri())
    yield page
    page.context.close()


TIP = """figure => { const d = getComputedStyle([...figure.querySelectorAll('path')].filter(
    p => p.className.baseVal === 'head D').at(-1)).d; return d.match(/-?[\\d.]+/g).slice(0, 2).map(Number); }"""


def test_keyboard_button_and_slider(moving_page):
    animation = SAMPLES["moving"]
    first, middle, second = moving_page.query_selector_all("figure")
    slider, button = first.query_selector("input"), first.query_selector("button")
    untouched = second.query_selector("input").input_value()
    tips = key_frames(animation, "D", 2)
    assert first.evaluate(TIP) == pytest.approx(list(tips[-1]), abs=0.1)  # still at the end
    slider.focus()
    moving_page.keyboard.press("Home")
    assert first.evaluate(TIP) == pytest.approx(list(tips[0]), abs=0.1)
    for _ in range(8):
        moving_page.keyboard.press("ArrowRight")
    assert first.evaluate(TIP) == pytest.approx(list(tips[8]), abs=0.1)
    assert slider.get_attribute("aria-valuetext").startswith("Step 2 of 3: C and D turn")
    assert (
        first.query_selector("output").inner_text()
        == "Step 2 of 3: C and D turn about the x axis of B through theta"
    )
    button.press("Enter")
    moving_page.wait_for_function('figure => figure.querySelector("input").value > 9', arg=first)
    assert button.inner_text() == "Pause"
    button.press("Enter")
    stopped = slider.input_value()
    moving_page.wait_for_timeout(700)
    assert slider.input_value() == stopped and button.inner_text() == "Play"
    assert second.query_selector("input").input_value() == untouched
    # Played from the end, it starts again.
    middle.query_selector("button").click()
    between = (
        'figure => { const { value, min, max } = figure.querySelector("input"); return +value > '
        "+min && "
        "+value < +max; }"
    )
    moving_page.wait_for_function(between, arg=middle)
    assert moving_page.errors == []


def test_labels_at_hand_are_those_that_matplotlib_sets():
    """``python -m tools.labels`` writes them; a page without Matplotlib draws with them."""
    stored = json.loads(drawings.LABELS.read_text("utf8"))
    assert len(stored["labels"]) > 100
    assert drawings.labels_to_keep(stored["labels"]) == stored


def test_a_drawing_without_matplotlib_is_the_same(monkeypatch):
    def example():
        return Drawing(
            "n x points right, n y up, and an arrow leads to the label of an angle."
        ).triad("N", np.eye(3))

    before = example().svg()
    drawings.typeset.cache_clear()
    monkeypatch.setitem(sys.modules, "matplotlib.font_manager", None)
    assert example().svg() == before
    with pytest.raises(ModuleNotFoundError):
        drawings.typeset("$no such label$")
    drawings.typeset.cache_clear()
