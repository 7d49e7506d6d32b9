"""How notebooks are stored: run in order, by numbers that other processors repeat, without mere
rounding.
"""

import re
from textwrap import dedent

import nbformat
import pytest
from places import REPOSITORY
from stored_outputs import compare_outputs

from notebook_pages.moves import FREE, moves
from notebook_pages.notebooks import all_notebooks, normalise

NOTEBOOKS = [*all_notebooks(REPOSITORY), *sorted(REPOSITORY.glob("exercises/*.ipynb"))]


@pytest.mark.parametrize(
    ("stored", "now", "far"),
    [
        ("off by 0.1", "off by 0.10000000000001700", False),
        ("off by 0.1", "off by 0.1000000000002", True),
        ("[2.0e+06]", "[2.00000000000001e+06]", False),
        ("1e-16 rad", "3e-16 rad", False),
        ("3 turns", "4 turns", True),
        ("3 turns", "3.0 turns", True),
        ("A_1 at 0.5", "A_2 at 0.5", True),
        ("wrong by 1e-09", "wrong by 2e-09", True),
        ("same", "other", True),
        (
            '<p style="x:0.1"><path class="a" d="M10.1-3L4 5"/>',
            '<p style="x:0.1"><path class="a" d="M10.2-3L4 5"/>',
            False,
        ),
        (
            '<p style="x:0.1"><path class="a" d="M10.1-3L4 5"/>',
            '<p style="x:0.2"><path class="a" d="M10.1-3L4 5"/>',
            True,
        ),
        ('<path d="M10.1-3L4 5"/>', '<path d="M10.1-3.3L4 5"/>', True),
        ('<path d="M10.1-0.1L4 5"/>', '<path d="M10.1 0L4 5"/>', False),
        ('<path d="M10.1-3L4 5"/>', '<path d="M10.1-3L4 5L4 6"/>', True),
        ('<path d="M10.1-3L4 5"/>', '<path d="M10.1-3C4 5"/>', True),
        ('<path id="g0123456789-0"/>', '<path id="g012345678a-0"/>', False),
        ('<g clip-path="url(#p01234567-0)"/>', '<g clip-path="url(#p0123456a-0)"/>', False),
    ],
)
def test_numbers_may_move_by_their_last_digits(stored, now, far):
    assert any(move.too_far for move in moves(stored, now)) == far
    assert moves(stored, stored) == []


def test_a_move_says_how_far_and_what_is_allowed():
    (move,) = moves("0.25", "0.250000000000017")
    assert "1.7e-14" in str(move) and "allowed 1e-13" in str(move)


class Cell:
    """The attributes of a cell that nbval's comparison uses."""

    class parent:
        skip_compare = ("metadata", "execution_count")

    class colors:
        OKBLUE = FAIL = ENDC = ""

    class ihook:
        @staticmethod
        def pytest_assertrepr_compare(**about):
            return []

    config = None

    def sanitize(self, text):
        return text

    def format_output_compare(self, key, left, right):
        pass


@pytest.mark.parametrize(
    ("now", "same"),
    [("0.5 and 2e-16", True), ("0.50001 and 2e-16", False), ("0.5 and 2e-16 and more", False)],
)
def test_stored_outputs_are_compared_by_number(now, same):
    def outputs(text):
        return [
            nbformat.v4.new_output("stream", name="stdout", text=text),
            nbformat.v4.new_output("display_data", {"text/plain": text}),
        ]

    assert compare_outputs(Cell(), outputs(now), outputs("0.5 and 1e-16")) == same


def printed(notebook):
    """The place of each output of a notebook, and its text."""
    for number, cell in enumerate(notebook.cells):
        for output in cell.get("outputs", []):
            data = output.get("data", {})
            for text in (
                output.get("text", ""),
                data.get("text/plain", ""),
                data.get("text/latex", ""),
            ):
                yield number, text


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_no_cell_prints_rounding(path):
    """Another processor rounds otherwise, so numbers that small are printed as a bound.

    The cell asserts the bound.
    """
    for number, text in printed(nbformat.read(path, as_version=4)):
        for number_in_text in FREE.finditer(text):
            bound = re.search(r"(less than|below|under) (about )?$", text[: number_in_text.start()])
            assert bound or not 0 < abs(float(number_in_text[0])) < 1e-12, (
                f"cell {number} prints {number_in_text[0]}: {text}"
            )


@pytest.mark.parametrize("path", all_notebooks(REPOSITORY), ids=lambda path: path.stem)
def test_notebook_is_stored_as_make_notebooks_stores_it(path):
    """Every cell was run in order, with normal metadata; otherwise nbval would compare nothing."""
    notebook = nbformat.read(path, as_version=4)
    counts = [cell.execution_count for cell in notebook.cells if cell.cell_type == "code"]
    assert counts == list(range(1, len(counts) + 1)), "run `make notebooks`"
    stored = dedent(path.read_text("utf8"))
    assert nbformat.writes(normalise(notebook)) == stored.rstrip("\n"), "run `make notebooks`"
