"""The book's questions as the grader takes them, and the class of the instructors' page."""

import pytest

from coursework.authoring.course import find_course
from coursework.authoring.release import read_source

SOURCES = find_course().sources


NAMES = [path.stem for path in sorted(SOURCES.glob("*.ipynb")) if path.stem != "chapters"]


# Two variants of one notebook; with --every-case all of all.
@pytest.mark.parametrize(
    ("name", "last"),
    [
        ("simple-orientations", 2),
        *(pytest.param(name, None, marks=pytest.mark.further) for name in NAMES),
    ],
)
def test_what_is_marked_does_not_depend_on_the_cells_that_were_left_out(name, last):
    path = SOURCES / f"{name}.ipynb"
    rules = read_source(path).rules
    for number in range(1, max((rule.count for rule in rules.values()), default=1))[:last]:
        having = [question for question, rule in rules.items() if number < rule.count]
        whole, part = (
            read_source(path, number).questions,
            read_source(path, number, only=having).questions,
        )
        assert list(whole) == list(part)
        for full, partial in zip(whole.values(), part.values(), strict=True):
            without_pictures = [
                {**question.public.as_json(), "picture": None} for question in (full, partial)
            ]
            assert without_pictures[0] == without_pictures[1]
            assert (full.plain, full.entries, full.near, full.credit) == (
                partial.plain,
                partial.entries,
                partial.near,
                partial.credit,
            )
