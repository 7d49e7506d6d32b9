"""Plots: words that stand for them, the page's colours, and the same bytes every time."""

import re
from xml.dom import minidom

import matplotlib
import numpy as np
import pytest

from orientation_figures.plot import SETTINGS, Plot, _short_path
from orientation_figures.style import LIGHT

ALT = "A line that rises from the origin to the point one, one, and a flat dashed line below it."


def example(alt=ALT, rows=1):
    with Plot(alt, rows=rows) as plot:
        axes = plot.axes if rows == 1 else plot.axes[0]
        axes.plot([0, 1], [0, 1], color=plot.colours["A"], label="rising & more")
        axes.plot([0, 1], [0, 0], "--", color=plot.colours["D"])
        axes.set_xlabel(r"time $t$ (s)")
        axes.legend()
    return plot._repr_html_()


def test_a_text_that_stands_for_the_plot_is_demanded():
    with pytest.raises(ValueError, match="has only 5 characters"):
        Plot("short")


def test_the_svg_is_well_formed_and_speaks():
    html = example("A line with an angle < 90 degrees & a second one that lies flat below it.")
    svg = minidom.parseString(re.search(r"<svg.*</svg>", html, re.DOTALL)[0]).documentElement
    assert svg.getAttribute("role") == "img"
    assert svg.getAttribute("aria-label").startswith("A line with an angle < 90 degrees & a second")


def test_a_plot_leaves_the_other_figures_of_a_page_alone():
    for rule in re.findall(
        r"([^{}<>]+)\{", "".join(re.findall(r"<style[^>]*>(.*?)</style>", example(), re.DOTALL))
    ):
        assert all(".orientation-figure" in selector for selector in rule.split(",")), rule


def test_colours_are_the_page_s_and_follow_its_theme():
    svg = re.search(r"<svg.*</svg>", example(), re.DOTALL)[0]
    for name in ("A", "D", "ink", "muted"):
        assert f"var(--{name})" in svg
    assert not re.findall(r"#[0-9a-f]{6}", svg), "a colour that does not follow the theme"
    assert len(set(LIGHT.values())) == len(LIGHT)


def test_the_same_plot_has_the_same_bytes_and_two_plots_share_no_id():
    assert example() == example()
    ids = [set(re.findall(r' id="([^"]+)"', example(alt))) for alt in (ALT, ALT + " Again.")]
    assert ids[0] and not ids[0] & ids[1]
    used = re.findall(r'(?:href="#|url\(#)([^")]+)', example())
    assert used and set(used) <= ids[0]


def test_words_are_11_pixels_high_on_a_telephone():
    """A telephone of 380 pixels leaves 348 for a figure."""
    for width in (400, 560, 640):
        set_wide = float(
            re.search(r'viewBox="0 0 ([\d.]+)', Plot(ALT, width=width)._repr_html_())[1]
        )
        assert SETTINGS["font.size"] * 348 / set_wide >= 11


def test_matplotlib_is_left_as_it_was():
    before = dict(matplotlib.rcParams)
    example(rows=2)
    assert dict(matplotlib.rcParams) == before


def points(path):
    """The points of a path with steps or places of any kind, one
    list for each line that it draws.
    """
    lines, here = [], np.zeros(2)
    for letter, numbers in re.findall(r"([A-Za-z])([^A-Za-z]*)", path):
        if letter in "zZ":
            here = lines[-1][0]
            continue
        values = np.array(
            [float(number) for number in re.findall(r"-?(?:\d+\.?\d*|\.\d+)", numbers)]
        )
        size = {"M": 2, "L": 2, "Q": 4, "C": 6}[letter.upper()]
        for group in values.reshape(-1, size // 2, 2):
            group = group + here if letter.islower() else group
            here = group[-1]
            if letter in "Mm":
                lines.append([here])
            else:
                lines[-1].extend(group)
    return lines


def test_short_paths_lead_along_the_same_points():
    random = np.random.default_rng(2)
    for count, tolerance in ((5, 0.0051), (400, 0.051)):
        way = np.cumsum(random.normal(scale=3, size=(count, 2)), axis=0)
        path = (
            "M 0 0 \n"
            + "".join(f"L {x:.6f} {y:.6f} \n" for x, y in way)
            + "z\nM 5 5 \nQ 6 6 7 4.123456 \n"
        )
        short = _short_path(path)
        assert len(short) < 0.7 * len(path)
        for point, expected in zip(points(short), points(path), strict=True):
            assert np.abs(np.array(point) - expected).max() <= tolerance


def test_steps_along_one_axis_become_one_and_turning_back_does_not():
    assert _short_path("M 1 1 \nL 2 1 \nL 4 1 \nL 3 1 \nL 3 5 \nL 3 9 \n") == "M1 1l3 0-1 0 0 8"
    # A point twice, as at the ends of a band: the step up to it had been lost,
    # and every band was drawn too low.
    assert _short_path("M 1 1 \nL 1 6 \nL 1 6 \nL 4 4 \nL 1 1 \nz\n") == "M1 1l0 5 3-2-3-3z"


def test_nothing_is_kept_that_nothing_needs():
    html = example(rows=2)
    ids = re.findall(r' id="([^"]+)"', html)
    assert all(f"#{name})" in html or f'"#{name}"' in html for name in ids)
    assert (
        "<g>" not in html
        and "metadata" not in html
        and not re.search(r"\d\.\d{4,}", html.replace("0.015625", ""))
    )
