"""The printed results of the practical cases, against formulas for small errors, and the stored
answers of the convention card, which ``python -m tools.programs`` asks for again.
"""

import ast
import json
import re

import numpy as np
from places import REPOSITORY
from scipy.spatial.transform import Rotation

from orientation import dcm_from_body_fixed
from orientation_recordings import bright_stars


def printed(words):
    """Return the output of the cell that prints these words."""
    notebook = json.loads((REPOSITORY / "chapters" / "cases-from-practice.ipynb").read_text("utf8"))
    texts = [
        "".join(out.get("text", ""))
        for cell in notebook["cells"]
        for out in cell.get("outputs", [])
    ]
    return next(text for text in texts if words in text)


def test_the_phone_is_as_wrong_as_its_noise_says():
    # The horizontal error across the level field of 20 microtesla, and the error of up times the
    # tangent of the dip.
    heading = np.degrees(np.hypot(0.5 / 20, 0.03 / 9.81 * 44 / 20))
    printed_heading = float(re.search(r"heading: ([\d.]+)", printed("of which the heading"))[1])
    assert abs(printed_heading / heading - 1) < 0.05, (
        "one draw stands for many, or the noise is another"
    )


def test_an_unturned_reading_of_the_other_maker_is_half_a_turn_wrong():
    match = re.search(r"wrong by ([\d.]+) to ([\d.]+) degrees", printed("to 180.0 degrees"))
    assert match and float(match[1]) > 175 and float(match[2]) <= 180


def numbers(text):
    return np.array([float(number) for number in re.findall(r"-?\d+\.?\d*", text)])


def test_the_stars_say_what_another_program_finds():
    names, directions, magnitudes = bright_stars()
    rows = [
        names.index(name)
        for name in "Betelgeuse Rigel Bellatrix Alnilam Alnitak Mintaka Saiph".split()
    ]
    stars, deviations = (
        directions[rows],
        np.radians(15 / 3600) * 10 ** (0.2 * (magnitudes[rows] - 2)),
    )
    out = stars.sum(axis=0) / np.linalg.norm(stars.sum(axis=0))
    east = np.cross([0, 0, 1], out) / np.linalg.norm(np.cross([0, 0, 1], out))
    seen = stars @ np.array([east, np.cross(out, east), out]).T
    random, errors = np.random.default_rng(3), []
    for _ in range(400):
        noisy = seen + deviations[:, None] * random.normal(size=seen.shape)
        errors.append(Rotation.align_vectors(noisy, seen, weights=deviations**-2.0)[0].as_rotvec())
    arcseconds = np.degrees(np.sqrt(np.mean(np.square(errors), axis=0))) * 3600
    single, many, predicted, unweighted = (
        numbers(line.partition(":")[2]) for line in printed("rms over 2000").splitlines()
    )
    # An rms over 400 is uncertain by 3.5 per cent, one over 2000 by 1.6: three times that.
    assert (
        np.abs(arcseconds / predicted - 1).max() < 0.11
        and np.abs(many / predicted - 1).max() < 0.06
    )
    assert (unweighted > 1.1 * many).all() and np.abs(single[2]) < 4 * many[2]


def test_a_second_camera_sees_what_the_first_does_not():
    first, second, both, runs = (numbers(line[8:]) for line in printed("S and T:").splitlines()[:4])
    assert (both < first).all() and (both < second).all() and 4 < first[2] / both[2] < 5
    assert np.abs(runs / both - 1).max() < 0.06


def test_a_wrist_near_straight_must_hurry():
    for line in printed("degrees from straight").splitlines():
        miss, fastest, _, printed_speed = numbers(line)
        assert (
            abs(fastest * np.sin(np.radians(miss)) / 60 - 1) < 0.02
            and abs(printed_speed - fastest) <= 2
        )


def test_an_axis_that_is_marked_wrong_makes_an_adduction():
    # SciPy rotates the marked frame by 5 degrees about y from the true one; its matrices are
    # active.
    for line in printed("5 sin:").splitlines():
        bend, *report, _, printed_adduction = numbers(line)
        true = Rotation.from_euler("z", -bend, degrees=True)
        seen = (Rotation.from_euler("y", -5, degrees=True) * true).as_euler("ZXY", degrees=True) * (
            -1,
            1,
            1,
        )
        assert (
            np.abs(seen - report).max() < 0.06
            and abs(printed_adduction - 5 * np.sin(np.radians(bend))) < 0.06
        )


def test_two_sensors_nod_with_each_step_and_turn_with_the_steel():
    """Steel across the level field of 20 microtesla rotates it by the angle with tangent 1/2."""
    lines = printed("past a car").splitlines()
    rows = [numbers(line.partition("degrees rms")[0])[-1:].tolist() for line in lines]
    [walking], [no_car], [before], [beside] = rows
    low, high = numbers(lines[1].partition("from ")[2].partition("ten from")[2])
    least, most = numbers(lines[3].partition("ten from")[2])
    assert max(abs(walking - no_car), abs(walking - before)) < 0.5 and 7 < walking < 10
    assert 7 < low < high < 10
    assert 0.5 * low < least < beside < most < np.hypot(np.degrees(np.arctan(0.5)), walking) + 6


def test_skin_that_tips_a_plate_does_more_harm_than_balls_that_slip_each_for_itself():
    lines = {
        line[:20].strip(): numbers(line[20:]) for line in printed("plate tilts").splitlines()[1:]
    }
    alone, together = lines["skin, independent"], lines["skin, plate tilts"]
    assert (together[::3] > 1.4 * alone[::3]).all()


def test_the_attitude_of_an_aircraft_for_a_robot():
    """East, north, up and forwards, left, up, by SciPy.

    Its rotations convert components along the body to components along the ground.
    """
    text = json.loads((REPOSITORY / "chapters" / "convention-card.ipynb").read_text("utf8"))
    outputs = [
        "".join(out.get("text", "")) for cell in text["cells"] for out in cell.get("outputs", [])
    ]
    printed_lines = next(text for text in outputs if "south-west" in text).splitlines()
    swap = Rotation.from_matrix([[0, 1, 0], [1, 0, 0], [0, 0, -1]])
    for line, angles in zip(printed_lines, ((90, 0, 0), (225, 10, 25)), strict=True):
        aviation = Rotation.from_euler("ZYX", angles, degrees=True)
        robot = swap * aviation * Rotation.from_matrix(np.diag([1, -1, -1]))
        assert (
            np.abs(robot.as_euler("ZYX", degrees=True) - numbers(line.partition(":")[2])).max()
            < 1e-6
        )


# --- the convention card --------------------------------------------------------------------------


def stored():
    """The table of the card: library, line of code, answer."""
    notebook = json.loads((REPOSITORY / "chapters" / "convention-card.ipynb").read_text("utf8"))
    source = next(
        "".join(cell["source"])
        for cell in notebook["cells"]
        if "ASKED = [" in "".join(cell["source"])
    )
    assigned = next(node for node in ast.parse(source).body if isinstance(node, ast.Assign))
    return ast.literal_eval(assigned.value)


def test_the_stored_answers_are_of_the_orientation_that_the_card_is_about():
    D_C_A = dcm_from_body_fixed((0.4, 0.7, -0.3), "zxy")
    for _, _, answer in stored():
        if len(answer) == 3:
            assert np.allclose(np.transpose(answer), D_C_A, atol=6e-5)
        else:
            assert sorted(np.round(answer, 4)) == [0, 0, 0.2588, 0.9659]
