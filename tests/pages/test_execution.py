"""Which notebooks are run again after a change, and which are not."""

import contextlib
import json
import subprocess
import sys

import nbformat
import pytest
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook, new_output
from places import REPOSITORY

from notebook_pages import execution, used
from notebook_pages.live import cells
from orientation_figures import moving

# jupyter-cache leaves its database open, which Python reports since 3.13.
pytestmark = pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")

PACKAGE = {
    "orientation/__init__.py": "from .a import f\n",
    "orientation/a.py": "def f():\n    from . import late\n",
    "orientation/late.py": "",
    "orientation_figures/__init__.py": "",
    "orientation_figures/drawing.py": "import orientation\n",
    "orientation_figures/moving/__init__.py": "",
    "orientation_figures/moving/js/triad.js": "",
    "coursework/__init__.py": "from .checking.check import check\n",
    "coursework/checking/__init__.py": "",
    "coursework/checking/check.py": "import sympy\nfrom ..checking import plain\n",
    "coursework/checking/plain.py": "",
    "orientation_course/__init__.py": "from . import kinds\n",
    "orientation_course/kinds.py": "",
    "orientation_course/sealed/chapters.json": "{}",
    "orientation_course/sealed/motion.json": "{}",
    "coursework/grading/grade.py": "",
}


@pytest.fixture
def packages(tmp_path, monkeypatch):
    """Write small packages of the same names; return a function that changes one of their files."""
    sources = tmp_path / "src"

    def write(name, text):
        path = sources / name if name != "constraints.txt" else tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        used._imported_by.cache_clear()
        used._digest.cache_clear()

    for name, text in {**PACKAGE, "constraints.txt": "sympy==1.14.0\n"}.items():
        write(name, text)
    monkeypatch.setattr(used, "REPOSITORY", tmp_path)
    monkeypatch.setattr(
        used,
        "PACKAGES",
        {name.partition("/")[0]: sources / name.partition("/")[0] for name in PACKAGE},
    )
    monkeypatch.setattr(used, "SEALED", sources / "orientation_course" / "sealed")
    monkeypatch.setattr(used, "PINS", tmp_path / "constraints.txt")
    yield write
    used._imported_by.cache_clear()
    used._digest.cache_clear()


def notebook(*codes, words="# A chapter"):
    return new_notebook(cells=[new_markdown_cell(words), *map(new_code_cell, codes)])


# Code that is not Python is left to the run.
FIGURES = notebook("from orientation_figures.drawing import Drawing", "1 +")
CHECKS = notebook("from coursework import check", "check('chapters/a', 1)")


@pytest.mark.parametrize(
    ("name", "figures", "checks"),
    [
        ("orientation/a.py", True, False),
        ("orientation/late.py", True, False),
        ("orientation_figures/drawing.py", True, False),
        ("orientation_figures/moving/js/triad.js", False, False),
        ("coursework/checking/plain.py", False, True),
        ("orientation_course/kinds.py", False, True),
        ("orientation_course/sealed/chapters.json", False, True),
        ("orientation_course/sealed/motion.json", False, False),
        ("coursework/grading/grade.py", False, False),
        ("constraints.txt", True, True),
    ],
)
def test_a_notebook_depends_on_what_it_uses_and_on_nothing_else(packages, name, figures, checks):
    before = [used.fingerprint_of_used(chapter) for chapter in (FIGURES, CHECKS)]
    packages(name, "# mended")
    after = [used.fingerprint_of_used(chapter) for chapter in (FIGURES, CHECKS)]
    assert [old != new for old, new in zip(before, after, strict=True)] == [figures, checks]


def test_a_new_version_by_itself_runs_nothing(packages):
    packages(
        "orientation/__init__.py", PACKAGE["orientation/__init__.py"] + '__version__ = "1.1.0"\n'
    )
    before = used.fingerprint_of_used(FIGURES)
    packages(
        "orientation/__init__.py", PACKAGE["orientation/__init__.py"] + '__version__ = "1.2.0"\n'
    )
    assert used.fingerprint_of_used(FIGURES) == before
    packages(
        "orientation/__init__.py",
        PACKAGE["orientation/__init__.py"] + '__version__ = "1.2.0"\nanswer = 1\n',
    )
    assert used.fingerprint_of_used(FIGURES) != before


def test_the_real_packages_are_followed():
    files = {
        str(path.relative_to(REPOSITORY))
        for path in used.files_used("from orientation_figures.moving import *")
    }
    assert (
        "packages/orientation-lab/src/orientation_figures/moving/js/triad.js" in files
        and "src/orientation/frames.py" in files
    )
    files = {
        str(path.relative_to(REPOSITORY))
        for path in used.files_used("from coursework import check")
    }
    assert "packages/coursework/src/coursework/checking/kinds.py" in files
    assert not any("grading" in name or "authoring" in name for name in files)


@pytest.mark.long
def test_a_run_side_by_side_says_nothing_and_leaves_out_what_is_stored(tmp_path):
    """A notebook whose code changed after `make notebooks` is run."""
    program = """
import sys
from types import SimpleNamespace
from jupyter_cache import get_cache
from notebook_pages.execution import run_side_by_side
folder, *paths = sys.argv[1:]
config = SimpleNamespace(
    execution_mode="cache", execution_cache_path=folder, execution_timeout=60
)
run_side_by_side(None, SimpleNamespace(mystnb_config=config, doc2path=str), paths)
cache = get_cache(folder)
runs = [cache.get_cache_bundle(record.pk).nb.cells[0] for record in cache.list_cache_records()]
print(sorted(f"{run.source} is {run.outputs[0].data['text/plain']}" for run in runs))
"""
    about = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}
    paths = [tmp_path / f"{number}.ipynb" for number in range(5)]
    for path, code, ran in zip(
        paths,
        ("1 + 1", "2 + 2", "1 + 1", "3 + 3", "4 + 4"),
        ("", "", "", "3 + 3", "3 + 3"),
        strict=True,
    ):
        made_with = used.fingerprint_of_run(new_notebook(cells=[new_code_cell(ran)]))
        book = new_notebook(
            cells=[code_cell(code, text="stored")], metadata=about | {used.MADE_WITH: made_with}
        )
        nbformat.write(book, path)
    done = subprocess.run(
        [sys.executable, "-c", program, tmp_path / "cache", *paths], capture_output=True, text=True
    )
    assert (done.returncode, done.stderr, done.stdout) == (
        0,
        "",
        "['1 + 1 is 2', '2 + 2 is 4', '3 + 3 is stored', '4 + 4 is 8']\n",
    )


def test_old_runs_are_thrown_away(packages, tmp_path):
    """This includes runs of code that may come back, and those of a book that was moved."""
    from jupyter_cache import get_cache

    page, folder = tmp_path / "page.ipynb", tmp_path / "cache"

    def look(code, words):
        nbformat.write(notebook(code, words=words), page)
        return execution.throw_away_old_runs([str(page)], folder)

    def run():
        get_cache(folder).cache_notebook_file(page, check_validity=False, overwrite=True)

    def is_kept():
        with contextlib.suppress(KeyError):
            return get_cache(folder).match_cache_file(page)

    assert look("from orientation import f", "One") == {str(page)}
    run()
    assert look("from orientation import f", "A changed sentence") == set() and is_kept()
    assert look("from orientation import f\nf()", "Other code") == set() and not is_kept()
    run()
    packages("orientation/a.py", "def f(): return 1")
    assert look("from orientation import f\nf()", "Other code") == {str(page)} and not is_kept()
    assert look("from orientation import f", "First code") == set() and not is_kept()
    run()
    page = page.rename(tmp_path / "in another place.ipynb")
    assert look("from orientation import f", "First code") == {str(page)} and not is_kept()


def code_cell(code, *tags, text=None, ran=True):
    return new_code_cell(
        code,
        outputs=(
            [new_output("execute_result", {"text/plain": text}, execution_count=1)] if text else []
        ),
        execution_count=1 if ran else None,
        metadata={"tags": list(tags)},
    )


def test_cells_that_a_page_hides_run_before_the_next_one(monkeypatch):
    """Otherwise each cell below them would have the kind, and the edits, of another."""
    kinds = cells.classify([
        code_cell("hidden = 3", "remove-cell"),
        code_cell("hidden", text="3"),
        code_cell("import numpy\nlength = numpy.size([1, 2])", "remove-input"),
        code_cell("hidden + length", "hide-input", text="5"),
        code_cell("hidden * 2", text="6"),
    ])  # fmt: skip
    shown = cells.on_the_page(kinds)
    assert [kind["code"] for kind in shown] == ["hidden", "hidden + length", "hidden * 2"]
    assert [kind["before"] for kind in shown] == [
        "hidden = 3",
        "import numpy\nlength = numpy.size([1, 2])",
        "",
    ]
    assert [kind["needs"] for kind in shown] == [[], ["numpy"], []]
    assert not shown[1]["skip"]


def test_a_chapter_that_was_never_run_can_be_seen():
    (kind,) = cells.classify([code_cell("6 * 7", ran=False)])
    assert kind["needs"] == []
    with pytest.raises(RuntimeError, match="gives a result that differs from the stored one"):
        cells.classify([code_cell("6 * 7", text="41")])


def test_whoever_names_a_figure_needs_anywidget_and_what_comes_with_it():
    """A page has anywidget; anything else it would report as a download."""
    names = [code_cell(f"moving.{name}", ran=False) for name in moving.__all__]
    first, *kinds = cells.classify([code_cell("from orientation_figures import moving"), *names])
    assert first["needs"] == []
    assert [kind["needs"] for kind in kinds] == [["anywidget"]] * len(kinds)


def test_kinds_are_kept_while_only_the_prose_changes(tmp_path, monkeypatch):
    monkeypatch.setattr(cells, "RESULTS", tmp_path / "kept")
    page = tmp_path / "page.ipynb"
    ran = []
    monkeypatch.setattr(
        cells, "classify", lambda cells: ran.append(1) or [{"needs": []} for _ in cells]
    )
    for words, code in (("One", "1"), ("Two", "1"), ("Two", "2"), ("Three", "2")):
        nbformat.write(notebook(code, words=words), page)
        assert cells.kinds_of(page) == [{"needs": []}]
    assert len(ran) == 2
    assert len([json.loads(path.read_text()) for path in (tmp_path / "kept").rglob("*.json")]) == 1


def test_code_is_parsed_from_several_threads():
    """Python 3.11 raises a SystemError if two threads make syntax trees at the same time."""
    from concurrent.futures import ThreadPoolExecutor

    from notebook_pages.used import parse

    code = "x = " + " + ".join(f"f({number}, [{number}, (a, b)])" for number in range(60))
    with ThreadPoolExecutor(4) as pool:
        assert len(list(pool.map(parse, [code] * 400))) == 400
