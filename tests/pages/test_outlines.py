"""The outlines of letters in the book's plots, each of which is once on a page."""

import re

from notebook_pages import page
from orientation_figures.plot import Plot


def test_letters_are_drawn_once_and_a_blank_not_at_all():
    with Plot(alt="Empty axes with two words above them and the same two below.") as plot:
        plot.axes.set(title="two words", xlabel="two words")
    alone = plot._repr_html_()
    blank = re.search(r'<path (?![^>]*\bd=)[^>]*\bid="', alone)
    assert blank, "Matplotlib draws blanks no more: share_outlines need not know them"
    body = page.share_outlines(alone + alone)
    outlines = re.findall(r'<path id="(o\d+)"([^>]*)/>', body)
    assert all(re.search(r'\bd="[^"]', outline) for _, outline in outlines)
    assert len({outline for _, outline in outlines}) == len(outlines)
    links = re.findall(r'<use [^>]*href="#([^"]*)"', body)
    assert set(links) == {name for name, _ in outlines} and links.count(links[0]) >= 2
