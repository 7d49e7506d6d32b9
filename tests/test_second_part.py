"""What was once wrong in the chapters from gimbal lock on, and must not come back."""

import re
from functools import cache

import nbformat
import numpy as np
import pytest
from conftest import REPOSITORY

from orientation import angle_between, dcm_from_body_fixed, nearest_dcm


@cache
def cells(name):
    return nbformat.read(REPOSITORY / "chapters" / f"{name}.ipynb", as_version=4).cells


def printed(name, word):
    """What the cell whose code holds the word has printed."""
    [cell] = [cell for cell in cells(name) if cell.cell_type == "code" and word in cell.source]
    return "".join(output.get("text", "") for output in cell.outputs)


def test_with_one_angular_velocity_the_descriptions_differ():
    """By the numbers of a second computation; one crude angular velocity for all had made them look alike."""
    text = printed("orientation-in-motion", "'Euler angles': euler(angle_rates")
    found = {
        name.strip(): float(wrong) for name, wrong in re.findall(r"^(.*) wrong by ([\d.]+) rad", text, re.MULTILINE)
    }
    assert found == pytest.approx({"matrix": 0.0143, "quaternion": 0.0036, "Euler angles": 0.101}, rel=0.05)


def test_restoring_is_shown_to_leave_the_error_as_it_is():
    text = printed("orientation-in-motion", "('left alone', lambda state: state)")
    alone, restored = (float(number) for number in re.findall(r"wrong by ([\d.e-]+) rad", text))
    assert restored == pytest.approx(alone, rel=1e-4)


def test_three_headings_cost_what_the_text_says():
    text = printed("exponential-and-averages", "by_angle_cost[60]")
    headings = np.radians([0.0, 120, 240])
    for candidate, cost in ((0.0, 28800), (60.0, 39600)):
        away = (np.degrees(headings) - candidate + 180) % 360 - 180
        assert (away**2).sum() == cost and f"{cost}.0" in text


def test_signed_zeros_are_shown_and_no_longer_denied():
    assert np.arctan2(0.0, -0.0) == np.pi and "180.0" in printed("back-from-a-matrix", "for zero in (0.0, -0.0)")
    text = "".join(cell.source for cell in cells("back-from-a-matrix"))
    assert "by definition" not in text


def test_half_way_the_restored_blend_is_slerps_middle():
    first, last = np.eye(3), dcm_from_body_fixed((1.7, 1.4, 0.7), "zxy")
    middle = nearest_dcm((first + last) / 2).dcm
    assert angle_between(middle, first) == pytest.approx(angle_between(first, last) / 2, abs=1e-12)
    text = "".join(cell.source for cell in cells("quaternions-in-full"))
    assert "worse still" not in text and "it *is* slerp's midpoint" in text


def test_no_speed_is_clipped():
    """The limits of the figure leave room for both curves."""
    [cell] = [cell for cell in cells("quaternions-in-full") if "Speed of turning, in degrees" in cell.source]
    assert re.search(r"ylim=\(0, None\)", cell.source)


def test_what_is_called_measured_could_have_been_measured():
    code = (REPOSITORY / "src/orientation_figures/moving/js/nine_numbers.js").read_text("utf8")
    [rows] = re.findall(r"\['Measured', (\[\[.*?\]\])\]", code)
    rows = np.array(eval(rows))
    assert abs(np.linalg.norm(rows, axis=1) - 1).max() < 0.02 and nearest_dcm(rows).distance < 0.03
    [cell] = [cell for cell in cells("measured-matrices") if cell.source.startswith("import numpy as np\n\nmeasured")]
    names = {}
    exec(cell.source, names)
    assert (names["measured"] == rows).all()


def test_the_racket_is_a_real_one_and_the_aircraft_flies_straight():
    motion = "".join(cell.source for cell in cells("orientation-in-motion"))
    assert "1.21, 16.38 and 17.48" in motion and "brody1985" in motion
    cases = "".join(cell.source for cell in cells("cases-from-practice"))
    assert "no sideslip" in cases and "straight up or straight down" in cases
