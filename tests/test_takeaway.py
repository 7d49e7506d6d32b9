"""What readers take away: notebooks and scripts that run, with the prose, without solutions."""

import ast
import os
import re
import subprocess
import sys
import zipfile
from copy import deepcopy
from functools import cache

import jupytext
import nbformat
import pytest
from conftest import HTML, REPOSITORY
from nbclient import NotebookClient

from website.notebooks import all_notebooks

FOLDER = HTML / "take-away"
SOURCES = {path.stem: path for path in all_notebooks(REPOSITORY)}
CHAPTERS = [name for name, path in SOURCES.items() if path.parent.name == "chapters"]
SOLUTIONS = SOURCES.get("solutions")
# Signs of MyST that plain Markdown does not know.
MYST = re.compile(r"\{[a-z:-]+\}`|^ *(```+|:::+) *\{|^\([\w-]+\)=$|\$\$ *\([\w-]+\)", re.MULTILINE)


@pytest.fixture(scope="module", autouse=True)
def built():
    if not FOLDER.is_dir():
        pytest.fail("the book is not built: run `make book`")


@cache
def notebook(name):
    return nbformat.read(FOLDER / f"{name}.ipynb", as_version=4)


def script(name):
    return (FOLDER / f"{name}.py").read_text("utf8")


def prose(nb):
    return "\n\n".join(cell.source for cell in nb.cells if cell.cell_type == "markdown")


def words(text):
    """The text on one line, without the marks of quotations and comments, in plain quotes."""
    text = re.sub(r"^(# ?)?(> ?)*", "", text, flags=re.MULTILINE)
    return re.sub(r"\s+", " ", text.translate(str.maketrans("\u2018\u2019\u201c\u201d", "''\"\"")))


@pytest.fixture(scope="module")
def environment(tmp_path_factory):
    """Where the package is the one of the wheel that lies beside the downloads."""
    (wheel,) = FOLDER.glob("*.whl")
    installed = tmp_path_factory.mktemp("installed")
    zipfile.ZipFile(wheel).extractall(installed)
    return os.environ | {"PYTHONPATH": str(installed), "MPLBACKEND": "agg"}


def plain_sentences(name):
    """Lines of the chapter's prose that hold no markup, as they must appear word for word."""
    for line in prose(nbformat.read(SOURCES[name], as_version=4)).splitlines():
        if len(line) > 40 and not re.search(r"[{}$\[\]*_`#|<>:=~\\]", line):
            yield line.strip().removeprefix("- ")


def test_every_notebook_is_offered():
    assert SOURCES
    for name in SOURCES:
        assert (FOLDER / f"{name}.ipynb").is_file() and (FOLDER / f"{name}.py").is_file()


def test_the_wheel_holds_the_package_and_no_more(environment):
    (wheel,) = FOLDER.glob("*.whl")
    names = zipfile.ZipFile(wheel).namelist()
    assert {name.split("/")[0] for name in names if "dist-info" not in name} == {"orientation", "coursework"}
    code = "import orientation; print(orientation.__file__)"
    place = subprocess.check_output([sys.executable, "-c", code], env=environment, text=True)
    assert place.startswith(environment["PYTHONPATH"])


# All scripts run, and each notebook has the code of its script: two show that a notebook runs as one.
@pytest.mark.parametrize("name", ["reference-frames", "orientation-with-sympy"])
def test_notebook_runs(name, tmp_path, environment):
    client = NotebookClient(
        deepcopy(notebook(name)),  # running it adds outputs
        timeout=120,
        kernel_name="python3",
        resources={"metadata": {"path": tmp_path}},
    )
    client.execute(env=environment)


@pytest.mark.parametrize("name", SOURCES)
def test_script_runs(name, tmp_path, environment):
    path = FOLDER / f"{name}.py"
    done = subprocess.run(
        [sys.executable, path], cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("name", SOURCES)
def test_prose_is_inside(name):
    in_notebook, in_script = words(prose(notebook(name))), words(script(name))
    for sentence in plain_sentences(name):
        assert words(sentence) in in_notebook
        assert words(sentence) in in_script


@pytest.mark.parametrize("name", SOURCES)
def test_prose_is_plain_markdown(name):
    text = prose(notebook(name))
    found = MYST.search(text)
    assert found is None, text[max(0, found.start() - 60) : found.end() + 60]
    assert "None" not in re.findall(r"(?:Figure|Exercise|Table) (\S+)", text)


@pytest.mark.parametrize("name", SOURCES)
def test_code_is_that_of_the_chapter(name):
    source = nbformat.read(SOURCES[name], as_version=4)
    downloads = (notebook(name), jupytext.reads(script(name), fmt="py:percent"))
    codes = [[c.source for c in nb.cells if c.cell_type == "code"] for nb in (source, *downloads)]
    assert codes[0] == codes[1] == codes[2]
    assert all(not cell.get("outputs") for cell in notebook(name).cells)


@pytest.mark.parametrize("name", SOURCES)
def test_script_is_valid_python(name):
    ast.parse(script(name))


@pytest.mark.parametrize("name", CHAPTERS)
def test_no_solution_is_inside(name):
    """Neither in the download nor in the chapter that it was made from."""
    if SOLUTIONS is None:
        pytest.fail("there are no worked solutions to look for")
    downloads = prose(notebook(name)) + script(name)
    chapter = SOURCES[name].read_text("utf8")
    assert "{solution" not in chapter and "Solution to Exercise" not in downloads
    assert "solution-start" not in chapter
    code = "\n".join(cell.source for cell in notebook(name).cells if cell.cell_type == "code")
    for cell in nbformat.read(SOLUTIONS, as_version=4).cells:
        if cell.cell_type == "code" and "import" not in cell.source:
            assert cell.source not in code
