"""A book of three pages, built in one command: all that a page
has, and nothing of any other book.
"""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest
from bs4 import BeautifulSoup

HERE = Path(__file__).parent
#: Where the set-up of this working copy has put what it fetches.
FETCHED = Path(os.environ.get("NOTEBOOK_PAGES_FETCHED", HERE.parents[2]))
PAGES = ("index", "levers", "triangles")


def build(book):
    """Build the book in a folder, and return that of its site."""
    environment = os.environ | {
        "NOTEBOOK_PAGES_FETCHED": str(FETCHED),
        "NO_COLOR": "1",
        "SOURCE_DATE_EPOCH": "1800000000",
    }
    done = subprocess.run(
        [sys.executable, "-m", "notebook_pages.build"],
        cwd=book,
        env=environment,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    return book / "_build" / "html"


@pytest.mark.parametrize(
    ("name", "text", "reason"),
    [
        ("_config.yml", None, "Run this in the folder of the book"),
        ("_config.yml", "title: Signals\nauthor: Ana\n", "extra_extensions: [notebook_pages]"),
        ("_toc.yml", "format: jb-book\nroot: intro\nchapters: []\n", "write `root: index`"),
        ("levers.ipynb", "<<<<<<< HEAD\n{}", "levers.ipynb is not a notebook"),
    ],
)
def test_a_book_that_cannot_be_built_says_why(tmp_path, name, text, reason):
    book = shutil.copytree(HERE / "small-book", tmp_path / "book")
    (book / name).write_text(text) if text else (book / name).unlink()
    with pytest.raises(AssertionError) as refused:
        build(book)
    assert reason in str(refused.value) and "Traceback" not in str(refused.value)


@pytest.fixture(scope="module")
def built(tmp_path_factory, take_compiled_wheels):
    """The folder of the site."""
    book = tmp_path_factory.mktemp("books") / "small"
    shutil.copytree(HERE / "small-book", book)
    take_compiled_wheels(book)
    return build(book)


def page(site, name):
    return BeautifulSoup((site / f"{name}.html").read_text("utf8"), "html.parser")


@pytest.mark.parametrize("name", PAGES)
def test_a_page_comes_out_and_asks_nobody_else(built, name):
    built_page = page(built, name)
    assert built_page.find("h1") and not built_page.select(
        "script[src*='//'], link[rel=stylesheet][href*='//']"
    )
    assert "orientation" not in built_page.get_text().lower()


def test_mathematics_is_set_when_the_book_is_built(built):
    built_page = page(built, "levers")
    assert built_page.select(".katex math") and not built_page.select("script[type^='math/tex']")
    assert "(1.1)" in built_page.get_text()


def test_cells_were_run_and_can_be_run_in_the_page(built):
    assert "60" in [
        output.get_text().strip() for output in page(built, "levers").select(".cell_output")
    ]
    lock = json.loads((built / "runtime" / "pyodide-lock.json").read_text("utf8"))
    assert lock["first"] == "sympy" and set(lock["packages"]["sympy"]["depends"]) == {"mpmath"}
    assert (built / lock["packages"]["sympy"]["file_name"]).exists() or (
        built / "runtime" / lock["packages"]["sympy"]["file_name"]
    ).exists()


def test_a_prediction_waits_for_the_reader(built):
    assert page(built, "levers").select("#predict-lever")


@pytest.mark.parametrize(
    "typed, read",
    [
        ("45°", True),
        ("45 degrees", True),
        (" 90/2 ", True),
        ("45,0", True),
        ("45 rad", False),
        ("about 45", False),
        ("1/0", False),
    ],
)
def test_a_number_is_read_as_one_writes_it(built, browser, typed, read):
    page = browser.new_page()
    page.goto((built / "triangles.html").as_uri())
    box = page.locator("#predict-halves")
    box.locator(".number input").press_sequentially(f"{typed}\n")
    assert ("First type a number" in box.get_by_role("status").inner_text()) != read
    page.close()


def test_every_page_with_code_can_be_taken_away(built):
    notebook = nbformat.read(built / "take-away" / "triangles.ipynb", as_version=4)
    assert [
        cell.source.splitlines()[-1] for cell in notebook.cells if cell.cell_type == "code"
    ] == [
        "sm.pi - alpha - beta",
        "sm.pi - alpha - beta - (sm.pi - beta - alpha)",
    ]
    compile((built / "take-away" / "triangles.py").read_text("utf8"), "triangles.py", "exec")
    assert not list((built / "take-away").glob("*.whl"))


def test_the_notebook_interface_opens_it(built):
    assert (built / "lite" / "notebooks" / "index.html").is_file()
    assert (built / "lite" / "files" / "triangles.ipynb").is_file()


@pytest.mark.long
def test_a_book_that_was_touched_is_as_if_it_had_been_built_anew(tmp_path, take_compiled_wheels):
    """What a build keeps of the one before, page by page, is what it would make again."""
    book = tmp_path / "small"
    shutil.copytree(HERE / "small-book", book)
    take_compiled_wheels(book)

    def files():
        return {path: path.read_bytes() for path in build(book).rglob("*") if path.is_file()}

    before = files()
    notebook = nbformat.read(book / "levers.ipynb", as_version=4)
    notebook.cells[0].source += "\n\nOne more sentence, with $x^2$ and ~~a line through it~~."
    nbformat.write(notebook, book / "levers.ipynb")
    touched = files()
    for path in (book / "_build").iterdir():
        if path.name != "runtime":  # what was compiled
            shutil.rmtree(path) if path.is_dir() else path.unlink()
    anew = files()
    assert touched.keys() == anew.keys()
    assert not [path for path in anew if touched[path] != anew[path]]
    assert [path for path in anew if path.suffix == ".html" and before.get(path) != anew[path]]
