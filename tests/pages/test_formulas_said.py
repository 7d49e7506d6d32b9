"""Every formula of the book in words, as in its PDF."""

import re

import pytest
from bs4 import BeautifulSoup
from places import HTML

from notebook_pages.paths import pages
from notebook_pages.spoken import spoken


@pytest.mark.sampled(2)
@pytest.mark.parametrize("page", pages())
def test_every_formula_of_the_page_can_be_said(page):
    """The words contain no symbols and no TeX."""
    for math in dict.fromkeys(
        re.findall(r"<math\b.*?</math>", (HTML / f"{page}.html").read_text("utf8"), re.DOTALL)
    ):
        words = spoken(BeautifulSoup(math, "lxml").math)
        assert re.fullmatch(r"[A-Za-z0-9 ,.;:\u00a0'’-]+", words), f"{words!r} from {math}"
        assert not re.search(r"[,;] ?[,;]|  ", words), words
