"""The figures of the first chapters: hands, challenges, a tree of frames and the
belt, in Python and in the browser.
"""

import math

import numpy as np
import pytest
from figure_pages import (  # noqa: F401
    drag,
    drawing,
    front_end,
    middle,
    numbers,
    open_figure,
    settle,
    type_number,
    words,
)
from orientations import rotation_error
from scipy.spatial.transform import Rotation

from orientation import dcm_from_body_fixed
from orientation_figures.moving import BeltFigure, ChallengeFigure, GraphFigure, HandsFigure
from orientation_figures.moving.pictures.belt import belt

FULL = 2 * math.pi


# In Python.


@pytest.mark.parametrize("seed", range(3))
def test_the_turn_that_remains_is_that_of_scipy(seed):
    random = np.random.default_rng(seed)
    rotations, turns = (list(zip("zxy", random.uniform(-3, 3, 3))) for _ in range(2))

    def end(chain):
        # A chain about the box's own axes is an intrinsic sequence, and SciPy's
        # matrices are transposes of ours.
        return Rotation.from_euler(
            "".join(axis for axis, _ in chain).upper(), [angle for _, angle in chain]
        )

    match = ChallengeFigure(task="match", given=rotations, turns=turns)
    assert match.remaining == pytest.approx(
        (end(rotations).inv() * end(turns)).magnitude(), abs=1e-12
    )
    ghost = ChallengeFigure(task="ghost", given=rotations, turns=turns)
    assert ghost.remaining == match.remaining
    undo = ChallengeFigure(task="undo", given=rotations, turns=turns)
    assert undo.remaining == pytest.approx((end(rotations) * end(turns)).magnitude(), abs=1e-12)
    back = [(axis, -angle) for axis, angle in reversed(rotations)]
    assert ChallengeFigure(task="undo", given=rotations, turns=back).remaining < 1e-12
    assert ChallengeFigure(task="undo", given=rotations, turns=back[::-1]).remaining > 0.1


@pytest.mark.parametrize("seed", range(3))
def test_a_mirror_image_is_left_handed_however_it_is_turned(seed):
    quaternion = np.random.default_rng(seed).normal(size=4)
    for image, hand in (("mirror", -1), ("copy", 1)):
        rows = np.array(HandsFigure(image=image, quaternion=quaternion).rows)
        assert np.dot(np.cross(rows[0], rows[1]), rows[2]) == pytest.approx(hand)
        assert rows @ rows.T == pytest.approx(np.eye(3))


@pytest.mark.parametrize("passed", [0, 0.2, 0.7, 1])
@pytest.mark.parametrize("angle", [0.8, FULL, 2 * FULL])
def test_the_belt_is_a_path_of_unit_quaternions_with_its_ends_held(angle, passed):
    figure = BeltFigure(angle=angle, passed=passed)
    path = np.array([figure.quaternion_at(share) for share in np.linspace(0, 1, 400)])
    assert np.linalg.norm(path, axis=1) == pytest.approx(1)
    assert np.abs(np.diff(path, axis=0)).max() < 0.06, "the path jumps"
    assert path[0] == pytest.approx([1, 0, 0, 0])
    assert path[-1] == pytest.approx([math.cos(angle / 2), 0, math.sin(angle / 2), 0], abs=1e-12)


def test_two_full_turns_come_out_of_the_belt_and_one_does_not():
    flat = [1, 0, 0, 0]
    assert all(
        BeltFigure(angle=2 * FULL, passed=1).quaternion_at(s) == pytest.approx(flat)
        for s in (0.3, 0.5, 0.8)
    )
    reversed_, first = (
        BeltFigure(angle=FULL, passed=passed).quaternion_at(0.5) for passed in (1, 0)
    )
    assert reversed_ == pytest.approx([0, 0, -1, 0]) and first == pytest.approx([0, 0, 1, 0])
    # The way there: every belt between the first and the last is near the one before.
    middles = [
        BeltFigure(angle=2 * FULL, passed=part).quaternion_at(0.5) for part in np.linspace(0, 1, 60)
    ]
    assert np.abs(np.diff(middles, axis=0)).max() < 0.1


def test_the_belt_does_not_stretch():
    frames, places = map(np.array, belt(2 * FULL, 0.4))
    steps = np.diff(places, axis=0)
    assert np.linalg.norm(steps, axis=1) == pytest.approx(3 / 72, rel=0.02)
    along = steps / np.linalg.norm(steps, axis=1, keepdims=True)
    assert np.abs(np.sum(along * frames[:-1, 0], axis=1)).max() < 0.1, "its width stays across it"


TREE = [
    ("A", "N", "z", 0.7),
    ("B", "N", "x", -0.4),
    ("C", "B", "y", 1.1),
    ("D", "B", "z", 2.0),
    ("E", "D", "x", -0.9),
]


# In the browser.


def test_the_matrix_over_a_path_is_that_of_sympy(open_figure):
    import sympy.physics.mechanics as me

    frames = {name: me.ReferenceFrame(name) for name in "NABCDE"}
    for frame, reference, axis, angle in TREE:
        frames[frame].orient_axis(frames[reference], getattr(frames[reference], axis), angle)
    page = open_figure(GraphFigure(edges=TREE))
    for target, source in ("EA", "AE", "CD", "NC", "DN", "BB"):
        expected = np.array(frames[target].dcm(frames[source])).astype(float)
        assert (
            rotation_error(GraphFigure(edges=TREE, target=target, source=source).dcm, expected)
            < 1e-12
        )
        page.get_by_label("Matrix of").select_option(target)
        page.get_by_label("with respect to").select_option(source)
        shown = numbers(page, "Direction cosine matrix over the path")
        assert shown == pytest.approx(expected, abs=6e-4)


def test_frames_are_added_turned_and_removed_by_keys(open_figure):
    page = open_figure(GraphFigure(edges=TREE[:2], target="B", source="A"))
    assert "B C A = B C N N C A" in words(page) and "transposed: N C A" in words(page)
    page.get_by_role("button", name="add a frame with reference frame A").press("Enter")
    type_number(page, "Angle of the frame in degrees", 90)
    page.get_by_label("about", exact=True).select_option("x")
    page.get_by_label("Matrix of").select_option("C")
    name = "Direction cosine matrix over the path"
    assert numbers(page, name) == pytest.approx(np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]))
    assert page.get_by_role("button", name="add a frame with reference frame C").is_visible()
    assert not page.get_by_role("button", name="add a frame with reference frame D").is_visible()
    page.get_by_role("button", name="Remove the last").press("Enter")
    settle(page)
    assert page.get_by_label("Matrix of").input_value() == "N", (
        "a matrix of a frame that is gone is not asked for"
    )
    assert numbers(page, name)[0, 1] == pytest.approx(-math.sin(0.7), abs=6e-4)


def test_a_matrix_is_matched_by_keys(open_figure):
    page = open_figure(
        ChallengeFigure(task="match", given=[("z", math.pi / 2), ("x", math.pi / 3)])
    )
    assert numbers(page, "Matrix of the goal") == pytest.approx(
        dcm_from_body_fixed((math.pi / 2, math.pi / 3, 0), "zxy"), abs=6e-4
    )
    for axis, degrees in (("z", 90), ("x", 45)):
        page.get_by_role("button", name=f"turn the box about a {axis}").press("Enter")
        type_number(page, "Angle of the last turn in degrees", degrees)
    assert page.get_by_role("meter").get_attribute("aria-valuenow") == "15"
    assert "Now:" in words(page)
    before = drawing(page)
    page.get_by_role("button", name="Show the goal").press("Enter")
    settle(page)
    assert drawing(page) != before
    type_number(page, "Angle of the last turn in degrees", 60)
    assert words(page).startswith("Solved in 2 turns: 90° about a z")
    assert numbers(page, "Matrix of the box") == pytest.approx(numbers(page, "Matrix of the goal"))
    page.get_by_role("button", name="New challenge").press("Enter")
    settle(page)
    assert "where does each arrow" in words(page)


def test_turns_are_undone_from_the_last(open_figure):
    page = open_figure(
        ChallengeFigure(task="undo", given=[("z", math.pi / 2), ("x", -math.pi / 3)])
    )
    for axis, degrees in (("x", 60), ("z", -90)):
        page.get_by_role("button", name=f"turn the box about a {axis}").click()
        type_number(page, "Angle of the last turn in degrees", degrees)
    assert words(page).startswith("Solved in 2 turns")
    page.get_by_role("button", name="Take back").click()
    assert words(page).count("1 turn so far") == 1


def test_the_ghost_is_found_by_its_axes_alone(open_figure):
    page = open_figure(ChallengeFigure(task="ghost", given=[("z", 1.2), ("y", 0.9), ("z", 0.5)]))
    for axis in "zxz":
        page.get_by_role("button", name=f"turn the box about a {axis}").click()
    assert "Not yet" in words(page)
    for _ in range(2):
        page.get_by_role("button", name="Take back").click()
    for axis in "yz":
        page.get_by_role("button", name=f"turn the box about a {axis}").click()
    assert words(page).startswith("Found: z-y-z.")
    assert page.get_by_role("button", name="turn the box about a x").is_disabled()


def test_the_last_turn_follows_a_drag(open_figure):
    page = open_figure(ChallengeFigure(turns=[("z", 0.5)]))
    drag(page, middle(page.locator('[data-part="0"]')), (40, -10))
    settle(page)
    assert page.get_by_label("Angle of the last turn in degrees").input_value() != "28.65"
    assert numbers(page, "Matrix of the box")[2] == pytest.approx([0, 0, 1])


def test_two_arrows_of_the_mirror_image_fit_and_all_of_the_copy(open_figure):
    page = open_figure(HandsFigure(quaternion=(0.8, 0.1, -0.4, 0.3)), reduced_motion="reduce")
    name = "Angles between the arrows of the same name"
    for pair, angles in (
        ("x and y", [0, 0, 180]),
        ("y and z", [180, 0, 0]),
        ("z and x", [0, 180, 0]),
    ):
        page.get_by_role("button", name=f"Fit {pair}").click()
        assert numbers(page, name) == pytest.approx(angles)
        assert words(page).startswith("Two arrows fit")
    assert "of the image: \u22121" in page.inner_text(".readouts")
    page.get_by_role("button", name="Copy").click()
    page.get_by_role("button", name="Fit x and y").click()
    assert numbers(page, name) == pytest.approx([0, 0, 0])
    assert words(page).startswith("All three arrows fit") and "of the image: +1" in page.inner_text(
        ".readouts"
    )
    page.get_by_role("button", name="turn by 15 degrees about n z").press("Enter")
    assert numbers(page, name) == pytest.approx([15, 15, 0])


def test_the_image_turns_under_the_finger(open_figure):
    page = open_figure(HandsFigure(image="copy"))
    drag(page, middle(page.locator('[data-part="image"]')), (60, 0))
    # To the right: about the upright of the screen, which leans from n z by the height of the eye.
    angles = numbers(page, "Angles between the arrows of the same name")
    assert angles[2] < 25 < angles[0]


def test_the_belt_in_the_browser_is_that_of_the_module(open_figure):
    page = open_figure(BeltFigure(angle=0.5), reduced_motion="reduce")
    pass_round = page.get_by_role("button", name="Pass the belt round the plate")
    assert pass_round.is_disabled()
    for turns, passed, flat in ((1, 1, False), (2, 1, True), (2, 0.4, False), (2, 0, False)):
        page.get_by_role("button", name=f"{('One', 'Two')[turns - 1]} full turn").click()
        type_number(page, "Belt passed round the plate in per cent", 100 * passed)
        figure = BeltFigure(angle=turns * FULL, passed=passed)
        expected = [figure.quaternion_at(share) for share in (0, 0.5, 1)]
        before = numbers(page, "Quaternions")
        assert before == pytest.approx(np.array(expected), abs=6e-4)
        assert ("the belt is flat" in words(page)) is flat
    # The belt passes round the plate, and the plate stays.
    pass_round.click()
    after = numbers(page, "Quaternions")
    assert before[1] == pytest.approx([-1, 0, 0, 0]) and after[1] == pytest.approx([1, 0, 0, 0])
    assert before[2] == pytest.approx(after[2])


def test_frames_of_the_still_are_proper():
    frames, _ = belt(FULL, 0.3)
    assert max(rotation_error(frame @ frame.T, np.eye(3)) for frame in frames) < 1e-12
