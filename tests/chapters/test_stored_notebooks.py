"""Every notebook is stored as `make notebooks` stores it."""

from textwrap import dedent

import nbformat
import pytest
from places import REPOSITORY

from notebook_pages.notebooks import all_notebooks, normalise


@pytest.mark.parametrize("path", all_notebooks(REPOSITORY), ids=lambda path: path.stem)
def test_notebook_is_stored_as_make_notebooks_stores_it(path):
    """Every cell was run in order, with normal metadata; otherwise nbval would compare nothing."""
    notebook = nbformat.read(path, as_version=4)
    counts = [cell.execution_count for cell in notebook.cells if cell.cell_type == "code"]
    assert counts == list(range(1, len(counts) + 1)), "run `make notebooks`"
    stored = dedent(path.read_text("utf8"))
    assert nbformat.writes(normalise(notebook)) == stored.rstrip("\n"), "run `make notebooks`"
