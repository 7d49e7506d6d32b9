"""Three questions of the book in another house: a matrix with a picture, a word, and many words."""

import pytest
from test_bank import HOUSES, judged_as_here

from coursework.authoring.course import find_course

CARRIED = [
    "simple-orientations/crank",
    "euler-angles/which-sequence",
    "measured-matrices/eight-tables",
]


@pytest.mark.parametrize("house", HOUSES)
def test_the_books_variants_are_judged_elsewhere_as_they_are_here(house, tmp_path):
    assert judged_as_here(find_course(), house, CARRIED, tmp_path) == []
