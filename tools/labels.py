"""Typeset the labels of drawings and store them, so that a page draws them without Matplotlib.

Run ``python -m tools.labels`` when a drawing has a new label. It runs the notebooks with drawings.
"""

import json
from concurrent.futures import ThreadPoolExecutor

import nbformat

from notebook_pages.live.cells import run_alone
from notebook_pages.notebooks import all_notebooks
from notebook_pages.paths import REPOSITORY
from orientation_figures.drawing import LABELS, labels_to_keep

COMMAND = "python -m tools.labels"
RECORD = """
from orientation_figures import drawing as _drawing
_plain, _texts = _drawing.typeset, set()
_drawing.typeset = lambda text: (_texts.add(text), _plain(text))[1]
"""
TELL = "print(__import__('json').dumps(sorted(_texts)))"


def texts_of(path):
    """Return the texts in the drawings of a notebook, by running it."""
    cells = [
        cell.source for cell in nbformat.read(path, as_version=4).cells if cell.cell_type == "code"
    ]
    reports = run_alone([RECORD, *cells, TELL], "everything")
    return json.loads(
        "".join(
            message["text"] for message in reports[-1]["messages"] if message["type"] == "stream"
        )
    )


def main():
    with ThreadPoolExecutor(max_workers=2) as pool:
        texts = {
            text
            for texts_of_notebook in pool.map(texts_of, all_notebooks(REPOSITORY))
            for text in texts_of_notebook
        }
    LABELS.write_text(json.dumps(labels_to_keep(texts), separators=(",", ":")) + "\n", "utf8")
    print(f"{len(texts)} labels, {LABELS.stat().st_size:,} bytes")


if __name__ == "__main__":
    main()
