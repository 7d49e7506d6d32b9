"""Three questions of the book for another system: a matrix with a picture, a word, many words."""

import pytest
from test_bank import FORMATS, judged_as_here

from coursework.authoring.course import find_course

EXPORTED = [
    "simple-orientations/crank",
    "euler-angles/which-sequence",
    "measured-matrices/eight-tables",
]


@pytest.mark.parametrize("format", FORMATS)
def test_the_books_variants_are_judged_elsewhere_as_they_are_here(format, tmp_path):
    assert judged_as_here(find_course(), format, EXPORTED, tmp_path) == []
