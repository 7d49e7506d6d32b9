"""Every formula of the book in words, as its PDF says it."""

import re

import pytest
from bs4 import BeautifulSoup
from places import HTML

from notebook_pages.paths import pages
from notebook_pages.spoken import spoken


@pytest.mark.sampled(2)
@pytest.mark.parametrize("page", pages())
def test_every_formula_of_the_page_can_be_said(page):
    """In words: no sign, and nothing of TeX."""
    for math in dict.fromkeys(
        re.findall(r"<math\b.*?</math>", (HTML / f"{page}.html").read_text("utf8"), re.DOTALL)
    ):
        said = spoken(BeautifulSoup(math, "lxml").math)
        assert re.fullmatch(r"[A-Za-z0-9 ,.;:\u00a0'’-]+", said), f"{said!r} from {math}"
        assert not re.search(r"[,;] ?[,;]|  ", said), said
