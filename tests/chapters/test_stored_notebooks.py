"""Every notebook is stored as `make notebooks` stores it, and gives what it stores."""

from textwrap import dedent

import nbformat
import pytest
from nbval.plugin import coalesce_streams
from places import HTML, REPOSITORY

from notebook_pages.execution import run_of
from notebook_pages.moves import moves_of_outputs
from notebook_pages.notebooks import all_notebooks, normalise


@pytest.mark.parametrize("path", all_notebooks(REPOSITORY), ids=lambda path: path.stem)
def test_notebook_is_stored_as_make_notebooks_stores_it(path):
    """Run in order, every cell, with normal metadata: else nbval would compare nothing."""
    notebook = nbformat.read(path, as_version=4)
    counts = [cell.execution_count for cell in notebook.cells if cell.cell_type == "code"]
    assert counts == list(range(1, len(counts) + 1)), "run `make notebooks`"
    stored = dedent(path.read_text("utf8"))
    assert nbformat.writes(normalise(notebook)) == stored.rstrip("\n"), "run `make notebooks`"


def of_code(notebook):
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


@pytest.mark.parametrize("path", all_notebooks(REPOSITORY), ids=lambda path: path.stem)
def test_what_the_build_has_run_gave_what_the_notebook_stores(path):
    """The build runs every cell, in the order of the notebook; at night nbval runs them once more."""
    notebook = nbformat.read(path, as_version=4)
    run = run_of(notebook, path, HTML.with_name("jupyter_cache"))
    assert run is not None, "the book is not built from what is here now: run `make book`"
    for number, (stored, now) in enumerate(zip(of_code(notebook), of_code(run), strict=True)):
        moves = moves_of_outputs(*(coalesce_streams(cell.outputs) for cell in (stored, now)))
        assert moves is not None, f"cell {number} gives other kinds of output, or more, or less"
        assert [str(move) for move in moves if move.too_far] == [], f"cell {number}"
