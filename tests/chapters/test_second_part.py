"""Former mistakes in the chapters from gimbal lock on."""

import re
from functools import cache

import nbformat
import numpy as np
import pytest
from places import REPOSITORY
from scipy.spatial.transform import Rotation

from orientation import (
    angle_between,
    nearest_dcm,
)


@cache
def cells(name):
    return nbformat.read(REPOSITORY / "chapters" / f"{name}.ipynb", as_version=4).cells


def printed(name, word):
    """Return the output of the cell whose code contains the word."""
    [cell] = [cell for cell in cells(name) if cell.cell_type == "code" and word in cell.source]
    return "".join(output.get("text", "") for output in cell.outputs)


def test_with_one_angular_velocity_the_descriptions_differ():
    """Compare with a second computation: a crude angular velocity for all made them look alike."""
    text = printed("orientation-in-motion", "'Euler angles': euler(angle_rates")
    errors = {
        name.strip(): float(wrong)
        for name, wrong in re.findall(r"^(.*) wrong by ([\d.]+) rad", text, re.MULTILINE)
    }
    assert errors == pytest.approx(
        {"matrix": 0.0143, "quaternion": 0.0036, "Euler angles": 0.101}, rel=0.05
    )


def test_over_a_whole_flight_a_matrix_and_a_quaternion_are_nearly_alike_and_lock_is_not_the_cause():
    """Compare the errors with the tangents of the steps of Euler's method, and with throws."""
    for angle in (0.02, 0.05, 0.1):
        tangent = nearest_dcm(np.eye(3) - angle * np.cross(np.eye(3), [0, 0, 1.0])).dcm
        assert angle_between(tangent, np.eye(3)) == pytest.approx(np.arctan(angle), rel=1e-9)
        lost = angle - np.arctan(angle), angle - 2 * np.arctan(angle / 2)
        assert lost[0] / lost[1] == pytest.approx(4, rel=0.01)
    text = printed("orientation-in-motion", "spins = random.normal")
    worst = [float(number) for number in re.findall(r"largest +([\d.]+)", text)]
    assert len(worst) == 2 and 1 < worst[1] < 1.15 < worst[0] < 2
    text = printed("orientation-in-motion", "for sequence in ('zxy', 'yzx')")
    quaternion, zxy, yzx = (float(number) for number in re.findall(r"([\d.]+) \(nine in ten", text))
    away = float(re.search(r"more than 30 degrees from lock: ([\d.]+)", text)[1])
    assert away > 3 * quaternion and zxy > 3 * yzx
    lines = printed("orientation-in-motion", "def errors_from").splitlines()[1:]
    ends_in_y, *others, y_first = (
        re.findall(r"[\d.]+", line.partition("from")[2]) for line in lines
    )
    assert float(ends_in_y[1]) < 0.5 * float(min(low for low, _ in others)) < float(y_first[0])


def test_coning_is_what_the_chapter_says_and_increments_in_pairs_mend_it():
    text = printed("orientation-in-motion", "def in_pairs(totals):")
    errors = [float(number) for number in re.findall(r"drift of ([\d.]+) degrees", text)]
    assert errors == pytest.approx([0.996, 0.177, 0.045], abs=5e-4)
    [remedied] = [
        cell.source
        for cell in cells("orientation-in-motion")
        if "def in_pairs(totals):" in cell.source
    ]
    names = {"np": np}
    exec(re.search(r"def in_pairs.*?\n\n\n", remedied, re.DOTALL)[0], names)
    # Compare an angular velocity that is linear in time with many small rotations.
    random = np.random.default_rng(9)
    for first, slope in random.normal(size=(10, 2, 3)):
        wrong = {"sum": [], "pair": []}
        for h in (0.1, 0.05):
            times = np.linspace(0, 2 * h, 2001)
            rates = first + slope * (times[:-1, None] + times[1] / 2)
            truth = Rotation.identity()
            for turn in Rotation.from_rotvec(rates * times[1]):
                truth = truth * turn
            ends = np.array([0, h, 2 * h])[:, None]
            totals = np.diff(first * ends + slope * ends**2 / 2, axis=0)
            for name, turn in (("sum", totals.sum(axis=0)), ("pair", names["in_pairs"](totals)[0])):
                wrong[name].append((truth.inv() * Rotation.from_rotvec(turn)).magnitude())
        assert np.log2(wrong["sum"][0] / wrong["sum"][1]) == pytest.approx(3, abs=0.3)
        assert np.log2(wrong["pair"][0] / wrong["pair"][1]) > 3.7


def test_a_second_camera_gains_what_the_prediction_keys():
    """Add up the information of the directions: the sum of (I - s s^T) over the variances."""
    from orientation_recordings import bright_stars

    names, directions, magnitudes = bright_stars()
    rows = [
        names.index(name)
        for name in "Betelgeuse Rigel Bellatrix Alnilam Alnitak Mintaka Saiph".split()
    ]
    stars, weights = directions[rows], 10 ** (-0.4 * magnitudes[rows])
    sight = stars.sum(axis=0) / np.linalg.norm(stars.sum(axis=0))
    across = np.cross([0, 0, 1], sight) / np.linalg.norm(np.cross([0, 0, 1], sight))

    def information(stars):
        return sum(
            weight * (np.eye(3) - np.outer(star, star)) for star, weight in zip(stars, weights)
        )

    turned = Rotation.from_rotvec(np.pi / 2 * across).apply(stars)
    alone, both = (
        np.linalg.inv(known)
        for known in (information(stars), information(stars) + information(turned))
    )
    gain = np.sqrt((sight @ alone @ sight) / (sight @ both @ sight))
    assert 6.5 < gain < 7.7
    assert (
        ":answer: C\n"
        in (text := "".join(cell.source for cell in cells("cases-from-practice"))).split(
            "predict-second-camera"
        )[1][:20]
    )
    assert "About seven times" in text


def test_what_is_called_measured_could_have_been_measured():
    code = (
        REPOSITORY / "packages/orientation-lab/src/orientation_figures/moving/js/nine_numbers.js"
    ).read_text("utf8")
    [rows] = re.findall(r"\['Measured', (\[\[.*?\]\])\]", code)
    rows = np.array(eval(rows))
    assert abs(np.linalg.norm(rows, axis=1) - 1).max() < 0.02 and nearest_dcm(rows).distance < 0.03
    [cell] = [
        cell for cell in cells("measured-matrices") if "\nmeasured = np.array(" in cell.source
    ]
    names = {}
    exec(cell.source, names)
    assert (names["measured"] == rows).all()


def prose(name):
    """Return the text of a chapter, with its lines joined."""
    return " ".join(
        "\n".join(cell.source for cell in cells(name) if cell.cell_type == "markdown").split()
    )


def test_the_part_across_the_axis_carries_its_own_label():
    """The label is beside the middle of its arrow, and far from the arrow of v."""
    [cell] = [cell for cell in cells("axis-and-angle") if "def rodrigues():" in cell.source]
    names = {}
    exec(cell.source, names)
    drawing = names["rodrigues"]()
    vector, axis = np.array([0.95, -0.35, 0.8]), np.array([0, 0, 1.0])
    foot = (vector @ axis) * axis

    def distance(place, start, end):
        start, end = drawing.on_sheet([start, end])
        share = np.clip((place - start) @ (end - start) / ((end - start) @ (end - start)), 0, 1)
        return np.linalg.norm(start + share * (end - start) - place)

    [place] = [
        place for _, shape, place, _ in drawing.marks if r"\mathbf{v}_\perp" in str(shape[0])
    ]
    across, along = distance(place, foot, vector), distance(place, np.zeros(3), vector)
    assert across < 25 and along > 1.3 * across, (across, along)


def test_both_makers_signs_are_told_and_a_bias_of_ten_microtesla_costs_sixteen_degrees():
    text = prose("cases-from-practice")
    assert "$+9.81$ along $\\hat{p}_z$" in text and "$-1$ along $\\hat{p}_z$" in text
    # A constant field, across the level part of the Earth's, along each axis of the phone in turn.
    truth = Rotation.from_euler("ZXY", (70, 20, -35), degrees=True)
    north_up = np.array([20.0, 0, -44])
    printed_errors = re.findall(
        r"heading off by (-?\d+) degrees",
        printed("cases-from-practice", "biased = orientation_of_phone"),
    )
    for number, bias in zip(printed_errors, np.eye(3)[:2] * 10, strict=True):
        x, y, _ = north_up + truth.apply(bias)
        assert (
            abs(abs(int(number)) - abs(np.degrees(np.arctan2(y, x)))) < 0.51
            and abs(int(number)) == 16
        )
