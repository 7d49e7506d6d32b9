"""``python -m notebook_pages.notebooks [paths]``: run every notebook and store it with its outputs.

This is how notebooks are committed: run with a clean kernel from the first cell to the last, and
without anything that differs from one machine or day to another.
"""

import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError

from .moving import WIDGET
from .take_away import METADATA
from .used import MADE_WITH, fingerprint_of_run

PLACES = ("*.ipynb", "chapters/*.ipynb", "appendix/*.ipynb")
KEPT_IN_CELLS = ("tags", "mystnb")


def all_notebooks(book):
    """Return the paths of the book's notebooks, in the folder ``book``."""
    return sorted(path for place in PLACES for path in book.glob(place))


def normalise(notebook):
    """Keep only the metadata that the book uses, and name the cells by their position."""
    notebook.metadata = nbformat.from_dict(
        {key: value for key, value in notebook.metadata.items() if key == MADE_WITH} | METADATA
    )
    notebook.nbformat, notebook.nbformat_minor = 4, 5
    for position, cell in enumerate(notebook.cells):
        cell["id"] = f"cell-{position}"
        cell.metadata = {key: cell.metadata[key] for key in KEPT_IN_CELLS if key in cell.metadata}
        for output in cell.get("outputs", []):
            # This output refers to a model in a kernel that no longer exists.
            output.get("data", {}).pop(WIDGET, None)
        cell.source = "\n".join(line.rstrip() for line in cell.source.strip().splitlines())
    return notebook


def run(path):
    """Run the notebook at ``path`` and store it; return a message if something went wrong."""
    notebook = nbformat.read(path, as_version=4)
    notebook.cells = [cell for cell in notebook.cells if cell.source.strip()]
    normalise(notebook)
    client = NotebookClient(
        notebook,
        timeout=120,
        resources={"metadata": {"path": path.parent}},
        record_timing=False,
        coalesce_streams=True,
    )
    try:
        client.execute()
    except CellExecutionError as error:
        return f"{path}: {error}"
    normalise(notebook).metadata[MADE_WITH] = fingerprint_of_run(notebook)
    nbformat.validate(notebook)
    nbformat.write(notebook, path)
    print(f"ran {path}", flush=True)
    return None


def main():
    paths = [Path(name) for name in sys.argv[1:]] or all_notebooks(Path())
    if missing := [str(path) for path in paths if not path.is_file()]:
        sys.exit(
            f"There is no notebook {', '.join(missing)}. Give its path relative to the folder of "
            "the book."
        )
    # Each notebook has its own kernel.
    with ThreadPoolExecutor(max_workers=2) as pool:
        sys.exit("\n".join(filter(None, pool.map(run, paths))) or 0)


if __name__ == "__main__":
    main()
