"""Notebooks for all tests, and a course of one notebook for the tests of authoring."""

from pathlib import Path

import nbformat

from coursework.authoring.course import Course

PROJECT = Path(__file__).resolve().parents[1]
# If this project is part of a book, the book pins the versions of everything installed.
_PINS = PROJECT.parent / "constraints.txt"
PINNED = {"PIP_CONSTRAINT": str(_PINS)} if _PINS.is_file() else {}


def made_in(folder, sources=None, exercises=None, sealed=None):
    """Return a course in a folder, or with some of its folders elsewhere."""
    places = {"sources": sources, "exercises": exercises, "sealed": sealed}
    return Course(
        folder,
        "Trial",
        archive=folder / "exercises.zip",
        **{name: given or folder / name for name, given in places.items()},
    )


def notebook(cells):
    """Return a notebook of cells, each a source of code or a kind, a source and tags."""
    made = nbformat.v4.new_notebook()
    for number, cell in enumerate(cells):
        kind, source, *tags = ("code", cell) if isinstance(cell, str) else cell
        new = nbformat.v4.new_code_cell if kind == "code" else nbformat.v4.new_markdown_cell
        made.cells.append(new(source, id=f"cell-{number}", metadata={"tags": tags}))
    return made


def write_source(folder, *cells, name="trial"):
    folder.mkdir(exist_ok=True)
    nbformat.write(notebook(cells), folder / f"{name}.ipynb")
    return folder / f"{name}.ipynb"


SETUP = 'import sympy as sm\nfrom coursework import check\ntheta = sm.symbols("theta")'
SOLUTION = (
    "### BEGIN SOLUTION\n"
    "working = sm.sin(theta)\n"
    "A_C_N = sm.Matrix([[1, 0, 0], [0, sm.cos(theta), working], [0, -working, sm.cos(theta)]])\n"
    "### END SOLUTION"
)
HIDDEN = (
    "### BEGIN HIDDEN TESTS\n"
    "question('trial/about-x', kind='rotation matrix', frames=('A', 'N'), symbols='theta', "
    "turns=[('x', theta)], worth=2, solution='The shared axis is the first one, which does not "
    "move.')\n"
    "### END HIDDEN TESTS"
)
FUNCTION = (
    '### BEGIN SOLUTION\ndef doubled(number):\n    """Return twice the number."""\n'
    '    "a quoted remark"\n'
    "    return 2*number\n### END SOLUTION"
)
HIDDEN_FUNCTION = (
    "### BEGIN HIDDEN TESTS\nquestion('trial/doubled', kind='function', result='expression', "
    "calls=[[0.5], [0.75]])\n### END HIDDEN TESTS"
)
CELLS = [
    ("markdown", "# Exercises"),
    ("code", SETUP),
    ("code", SOLUTION),
    ("code", f"check('trial/about-x', A_C_N)\n{HIDDEN}"),
    ("code", FUNCTION),
    ("code", f"check('trial/doubled', doubled)\n{HIDDEN_FUNCTION}"),
]
