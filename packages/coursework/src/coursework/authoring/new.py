"""``coursework new``: create a small course, ready to use."""

import re
import shlex
from pathlib import Path

from .author import AuthorError
from .course import find_course
from .packing import DISTRIBUTIONS, archive, wheel
from .release import METADATA, release

NOTEBOOK = "first-steps"
CELLS = [
    "# First steps\n"
    "\n"
    "Run the cell below first. "
    "Then replace the dots with your answer and run the check.",
    "import sympy as sm\nfrom coursework import check\n\nb, h, x = sm.symbols('b, h, x')",
    "## Area\n"
    "\n"
    "A triangle has a base of length $b$ and a height of length $h$. "
    "Give its area as `area`.",
    "### BEGIN SOLUTION\narea = b * h / 2\n### END SOLUTION",
    """check('first-steps/area', area)
### BEGIN HIDDEN TESTS
question('first-steps/area', kind='expression', symbols={'b': (0.5, 3), 'h': (0.5, 3)}, worth=1,
         mistakes={'This is the area of the rectangle: the triangle is half of it.': b * h},
         hints={'authored': ['Draw the rectangle with the sides $b$ and $h$ around the triangle.']},
         solution='Two such triangles make a rectangle with the sides $b$ and $h$, '
         'so one of them has the area $bh/2$.')
### END HIDDEN TESTS""",
    "## Slope\n\nGive the derivative of $x^2\\sin(x)$ as `slope`, in any form.",
    "### BEGIN SOLUTION\nslope = sm.diff(x**2 * sm.sin(x), x)\n### END SOLUTION",
    """check('first-steps/slope', slope)
### BEGIN HIDDEN TESTS
question('first-steps/slope', kind='expression', symbols='x', worth=2,
         mistakes={'The product rule has a second term.': 2 * x * sm.sin(x)},
         solution='By the product rule the derivative is $2x\\\\sin(x) + x^2\\\\cos(x)$.')
### END HIDDEN TESTS""",
    "## Mean\n\nWrite a function `mean(numbers)` that returns the arithmetic mean of a list of "
    "numbers.",
    '### BEGIN SOLUTION\ndef mean(numbers):\n    """Return the arithmetic mean."""\n'
    "    return sum(numbers) / len(numbers)\n### END SOLUTION",
    """check('first-steps/mean', mean)
### BEGIN HIDDEN TESTS
question('first-steps/mean', kind='function', result='expression', worth=3,
         calls=[[[2, 4, 9]], [[-1.5]], [[0.25, 3.5]]],
         mistakes={'This is the sum. Divide it by the number of terms.': sum})
### END HIDDEN TESTS""",
]
FILES = {
    "course.toml": 'title = "{title}"\n',
    "requirements.txt": "--find-links wheels\ncoursework-tools\njupyterlab\npytest\n",
    ".gitignore": "build/\n.coursework/\n.ipynb_checkpoints/\n__pycache__/\n",
    "tests/test_course.py": '''"""Test every question, and that what is released is up to date."""

import pytest

from coursework.authoring.course import find_course
from coursework.authoring.release import differences, release
from coursework.authoring.selftest import selftest

COURSE = find_course(__file__.rpartition("tests")[0])
needs_solutions = pytest.mark.skipif(
    not any(COURSE.sources.glob("*.ipynb")), reason="the solutions are not here"
)


@needs_solutions
def test_every_question_is_ready_for_students(tmp_path):
    assert selftest(COURSE, tmp_path / "page.html") == []


@needs_solutions
def test_what_is_released_is_what_the_sources_make(tmp_path):
    made = COURSE._replace(exercises=tmp_path / "exercises", sealed=tmp_path / "sealed")
    release(made)
    for ours, theirs, pattern in (
        (COURSE.exercises, made.exercises, "*.ipynb"),
        (COURSE.sealed, made.sealed, "*.json"),
    ):
        assert differences(ours, theirs, pattern) == [], "run `coursework release`"


def test_there_is_something_for_students():
    notebooks = {{path.stem for path in COURSE.exercises.glob("*.ipynb")}}
    assert notebooks and notebooks <= {{path.stem for path in COURSE.sealed.glob("*.json")}}
''',
    ".github/workflows/test.yml": """name: Test
on: [push, pull_request]
permissions:
  contents: read
jobs:
  test:
    runs-on: ubuntu-latest
    timeout-minutes: 20
    steps:
      - uses: actions/checkout@v4
      - uses: actions/setup-python@v5
        with:
          python-version: "3.12"
      - run: python -m pip install -r requirements.txt
      - run: python -m pytest
""",
    "README.md": """# {title}

Self-checking exercises in notebooks that contain no answers.

| folder | what | who sees it |
|---|---|---|
| `solutions/` | the notebooks with solutions, which you write | you alone |
| `exercises/` | the notebooks with blanks, and the sealed questions; do not edit them | everybody |
| `wheels/` | the packages of coursework that this course was made with | everybody |

    python -m pip install -r requirements.txt
    coursework try first-steps/area      # shows a question with every reply
    coursework release                   # builds exercises/ and build/exercises.zip
    coursework publish                   # builds build/site, if notebook-pages is installed
    coursework selftest                  # tests every question, and looks for leaks
    coursework grade SUBMISSIONS --out MARKS

**Before you publish this folder**: `solutions/` holds every answer. Keep it in a private repository
of its own, as a submodule:

    git rm -r --cached solutions
    git submodule add PRIVATE-ADDRESS solutions

Without the submodule you can do everything except release and grade, and the tests that need the
solutions are skipped.
""",
}


def new(folder: str | Path) -> list[str]:
    """Make a course: sources, exercises, sealed questions, tests, CI and a README.

    Returns
    -------
    list of str
        What was made, and what to do next.

    Raises
    ------
    AuthorError
        Something exists at that path already.
    """
    import nbformat

    folder = Path(folder)
    if folder.exists() and any(folder.iterdir() if folder.is_dir() else [folder]):
        raise AuthorError(f"{folder} already exists; we changed nothing.")
    words = re.sub(r"[-_\s]+", " ", folder.resolve().name).strip().replace('"', "'")
    for name, text in FILES.items():
        place = folder / name
        place.parent.mkdir(parents=True, exist_ok=True)
        # Change only the first letter, since names and German nouns keep their capitals.
        place.write_text(text.format(title=words[:1].upper() + words[1:]), "utf8")
    cells = [
        nbformat.v4.new_markdown_cell(text)
        if text.startswith(("# ", "## "))
        else nbformat.v4.new_code_cell(text)
        for text in CELLS
    ]
    for number, cell in enumerate(cells):
        cell["id"] = f"cell-{number}"
    notebook = nbformat.v4.new_notebook(cells=cells, metadata=METADATA)
    (folder / "solutions").mkdir()
    nbformat.write(notebook, folder / "solutions" / f"{NOTEBOOK}.ipynb")
    (folder / "wheels").mkdir()
    for name in DISTRIBUTIONS:
        wheel(name, folder / "wheels")
    course = find_course(folder)
    release(course)
    archive(course)
    made = sorted(path for path in folder.rglob("*") if path.is_file())
    return [
        *(f"made  {path}" for path in made),
        f"The course is ready. Try it: `cd {shlex.quote(str(folder))}`, then `coursework try "
        f"{NOTEBOOK}/area`.",
        f"Give your students {course.archive}.",
    ]
