"""Plots: words that stand for them, the page's colours, and the same bytes every time."""

import re
from xml.dom import minidom

import matplotlib
import pytest

from orientation_figures.plot import Plot
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
    with pytest.raises(ValueError, match="has 5 characters"):
        Plot("short")


def test_the_svg_is_well_formed_and_speaks():
    html = example("A line with an angle < 90 degrees & a second one that lies flat below it.")
    svg = minidom.parseString(re.search(r"<svg.*</svg>", html, re.DOTALL)[0]).documentElement
    assert svg.getAttribute("role") == "img"
    assert svg.getAttribute("aria-label").startswith("A line with an angle < 90 degrees & a second")


def test_a_plot_leaves_the_other_figures_of_a_page_alone():
    for rule in re.findall(r"([^{}<>]+)\{", "".join(re.findall(r"<style[^>]*>(.*?)</style>", example(), re.DOTALL))):
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


def test_matplotlib_is_left_as_it_was():
    before = dict(matplotlib.rcParams)
    example(rows=2)
    assert dict(matplotlib.rcParams) == before
