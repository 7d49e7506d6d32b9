"""What the cases from practice print, against formulas for small errors."""

import json
import re

import numpy as np
from conftest import REPOSITORY


def printed(words):
    """What the cell that prints these words has printed."""
    notebook = json.loads((REPOSITORY / "chapters" / "cases-from-practice.ipynb").read_text("utf8"))
    texts = ["".join(out.get("text", "")) for cell in notebook["cells"] for out in cell.get("outputs", [])]
    return next(text for text in texts if words in text)


def test_the_phone_is_as_wrong_as_its_noise_says():
    # Across the level field of 20 microtesla, and up as far as it is wrong, times the tangent of the dip.
    heading = np.degrees(np.hypot(0.5 / 20, 0.03 / 9.81 * 44 / 20))
    told = float(re.search(r"heading: ([\d.]+)", printed("of which the heading"))[1])
    assert abs(told / heading - 1) < 0.05, "one draw stands for many, or the noise is another"


def test_an_unturned_reading_of_the_other_maker_is_half_a_turn_wrong():
    found = re.search(r"wrong by ([\d.]+) to ([\d.]+) degrees", printed("to 180.0 degrees"))
    assert found and float(found[1]) > 175 and float(found[2]) <= 180


def test_the_stars_say_least_about_the_line_of_sight():
    one, many = re.findall(r"\[([^\]]+)\]", printed("rms over 2000"))
    x, y, z = map(float, many.split())
    # Seven stars, each 10 arcseconds across: 10/sqrt(7) about the sides, and more by their distance about the middle.
    assert abs(x * np.sqrt(7) / 10 - 1) < 0.15 and abs(y * np.sqrt(7) / 10 - 1) < 0.15
    assert 30 < z < 45 and len(one.split()) == 3
