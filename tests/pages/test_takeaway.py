"""Downloads for readers: notebooks and scripts that run, with the prose, without solutions."""

import os
import re
import subprocess
import sys
import venv
import zipfile
from copy import deepcopy
from functools import cache
from importlib.metadata import distribution
from pathlib import Path
from types import SimpleNamespace

import jupytext
import nbformat
import pytest
from docutils import nodes
from jupyter_client import AsyncKernelManager
from nbclient import NotebookClient
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from places import HTML, REPOSITORY

from notebook_pages.markdown import MarkdownWriter
from notebook_pages.notebooks import all_notebooks
from notebook_pages.paths import PACKAGES

FOLDER = HTML / "take-away"
SOURCES = {path.stem: path for path in all_notebooks(REPOSITORY)}
CHAPTERS = [name for name, path in SOURCES.items() if path.parent.name == "chapters"]
SOLUTIONS = SOURCES["solutions"]
# Markup of MyST that plain Markdown lacks.
MYST = re.compile(r"\{[a-z:-]+\}`|^ *(```+|:::+) *\{|^\([\w-]+\)=$|\$\$ *\([\w-]+\)", re.MULTILINE)


@pytest.fixture(scope="module", autouse=True)
def built():
    if not FOLDER.is_dir():
        pytest.fail("the book is not built: run `make book`")


def wheels():
    files = sorted(FOLDER.glob("*.whl"))
    assert len(files) == 3
    return files


@cache
def notebook(name):
    return nbformat.read(FOLDER / f"{name}.ipynb", as_version=4)


def script(name):
    return (FOLDER / f"{name}.py").read_text("utf8")


def prose(nb):
    return "\n\n".join(cell.source for cell in nb.cells if cell.cell_type == "markdown")


def words(text):
    """Return the text on one line, without the marks of quotations and comments, in plain quotes."""
    text = re.sub(r"^(# ?)?(> ?)*", "", text, flags=re.MULTILINE)
    return re.sub(r"\s+", " ", text.translate(str.maketrans("\u2018\u2019\u201c\u201d", "''\"\"")))


def needed_by(names):
    """Return the distributions ``names`` and all their dependencies in this environment."""
    distributions, waiting = {}, list(names)
    while waiting:
        name = canonicalize_name(waiting.pop())
        if name not in distributions:
            distributions[name] = distribution(name)
            for requirement in map(Requirement, distributions[name].requires or []):
                if requirement.marker is None or requirement.marker.evaluate({"extra": ""}):
                    waiting.append(requirement.name)
    return distributions


def requirements(wheel):
    """Return a wheel's requirements."""
    with zipfile.ZipFile(wheel) as box:
        (about,) = [name for name in box.namelist() if name.endswith(".dist-info/METADATA")]
        lines = box.read(about).decode().splitlines()
    requires = [
        Requirement(line.partition(": ")[2]) for line in lines if line.startswith("Requires-Dist: ")
    ]
    return [requirement.name for requirement in requires if requirement.marker is None]


@pytest.fixture(scope="module")
def readers_python(tmp_path_factory):
    """Python with the wheels beside the downloads, what they require, and Jupyter's kernel.

    Packages that pip would fetch are linked from here, which takes no time.
    ``test_everything_runs_where_pip_installed_the_wheels`` shows that pip gives the same result.
    """
    folder = tmp_path_factory.mktemp("reader")
    venv.create(folder, symlinks=True)
    site = next(folder.glob("lib/python*/site-packages"))
    for wheel in wheels():
        zipfile.ZipFile(wheel).extractall(site)
    ours = {canonicalize_name(wheel.name.partition("-")[0]) for wheel in wheels()}
    asked = {canonicalize_name(name) for wheel in wheels() for name in requirements(wheel)} - ours
    for package in needed_by([*asked, "ipykernel"]).values():
        for top in {file.parts[0] for file in package.files} - {"..", "__pycache__"}:
            if not (site / top).exists():
                (site / top).symlink_to(package.locate_file(top))
    return folder / "bin" / "python"


@pytest.fixture
def readers_variables(tmp_path):
    """The environment of a reader's Python, without this repository."""
    variables = {
        name: value
        for name, value in os.environ.items()
        if name not in ("PYTHONPATH", "IPYTHONDIR")
    }
    return variables | {"MPLBACKEND": "agg", "IPYTHONDIR": str(tmp_path / "ipython")}


def run_script(python, name, folder, variables):
    path = FOLDER / f"{name}.py"
    done = subprocess.run(
        [python, path], cwd=folder, env=variables, capture_output=True, text=True, timeout=1200
    )
    assert done.returncode == 0, done.stderr


def run_notebook(python, name, folder, variables):
    class Kernel(AsyncKernelManager):
        def format_kernel_cmd(self, extra_arguments=None):
            return [str(python), *super().format_kernel_cmd(extra_arguments)[1:]]

    client = NotebookClient(
        deepcopy(notebook(name)),  # running it adds outputs
        timeout=600,
        kernel_name="python3",
        kernel_manager_class=Kernel,
        resources={"metadata": {"path": folder}},
    )
    client.execute(env=variables)


def plain_sentences(name):
    """Iterate over the prose lines without markup, which must appear word for word."""
    for line in prose(nbformat.read(SOURCES[name], as_version=4)).splitlines():
        if len(line) > 40 and not re.search(r"[{}$\[\]*_`#|<>:=~\\]", line):
            yield line.strip().removeprefix("- ")


def test_the_wheels_hold_what_students_import_and_no_more(readers_python, readers_variables):
    names = [name for wheel in wheels() for name in zipfile.ZipFile(wheel).namelist()]
    assert len(names) == len(set(names))
    rooms = {
        "/".join(Path(name).parts[:2]) for name in names if Path(name).parts[0] == "coursework"
    }
    assert "coursework/checking" in rooms and not rooms & {
        "coursework/authoring",
        "coursework/grading",
    }
    packages = {Path(name).parts[0] for name in names if ".dist-info" not in name}
    assert packages == set(PACKAGES)
    code = (
        "import orientation, sys; print(orientation.__version__, "
        "orientation.__file__.startswith(sys.prefix))"
    )
    output = subprocess.check_output([readers_python, "-c", code], env=readers_variables, text=True)
    (wheel,) = FOLDER.glob("orientation_of_reference_frames-*.whl")
    assert output.split() == [wheel.name.split("-")[1], "True"]


def test_the_packages_come_in_one_archive_that_says_how(tmp_path):
    (archive,) = FOLDER.glob("orientation-lab-*.zip")
    zipfile.ZipFile(archive).extractall(tmp_path)
    lines = (tmp_path / "packages" / "requirements.txt").read_text().splitlines()
    assert {line.split()[0] for line in lines} == {f"./{wheel.name}" for wheel in wheels()}
    assert all(archive.name in prose(notebook(name)) for name in SOURCES)


def test_students_have_the_command_that_updates_and_no_other(
    readers_python, readers_variables, tmp_path
):
    command = [readers_python, "-m", "coursework"]
    help_run = subprocess.run(
        [*command, "--help"], env=readers_variables, capture_output=True, text=True, check=True
    )
    assert re.findall(r"^    (\w\S*)", help_run.stdout, re.M) == ["update"]
    assert "install coursework-tools" in help_run.stdout
    done = subprocess.run(
        [*command, "update", FOLDER / "exercises.zip"],
        cwd=tmp_path,
        env=readers_variables,
        capture_output=True,
    )
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "euler-angles.ipynb").is_file()


# Each notebook has the code of its script (below), and is run where pip installed the wheels.
@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", SOURCES)
def test_script_runs(name, tmp_path, readers_python, readers_variables):
    run_script(readers_python, name, tmp_path, readers_variables)


@pytest.fixture(scope="module")
def installed_python(tmp_path_factory):
    """Python with the pinned packages that pip installs for the wheels, and Jupyter's kernel."""
    folder = tmp_path_factory.mktemp("installed")
    (archive,) = FOLDER.glob("orientation-lab-*.zip")
    zipfile.ZipFile(archive).extractall(folder)
    venv.create(folder, symlinks=True)
    python = folder / "bin" / "python"
    pip = [
        sys.executable,
        "-m",
        "pip",
        "--python",
        python,
        "install",
        "--quiet",
        "--disable-pip-version-check",
    ]
    command = [
        *pip,
        "--constraint",
        REPOSITORY / "constraints.txt",
        "-r",
        "requirements.txt",
        "ipykernel",
    ]
    subprocess.run(command, check=True, cwd=folder / "packages")
    return python


@pytest.mark.long
@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", SOURCES)
def test_everything_runs_where_pip_installed_the_wheels(
    name, tmp_path, installed_python, readers_variables
):
    run_script(installed_python, name, tmp_path, readers_variables)
    run_notebook(installed_python, name, tmp_path, readers_variables)


@pytest.mark.parametrize("name", SOURCES)
def test_prose_is_inside(name):
    in_notebook, in_script = words(prose(notebook(name))), words(script(name))
    for sentence in plain_sentences(name):
        assert words(sentence) in in_notebook
        assert words(sentence) in in_script


@pytest.mark.parametrize("name", SOURCES)
def test_prose_is_plain_markdown(name):
    text = prose(notebook(name))
    match = MYST.search(text)
    assert match is None, text[max(0, match.start() - 60) : match.end() + 60]
    assert "None" not in re.findall(r"(?:Figure|Exercise|Table) (\S+)", text)


@pytest.mark.parametrize("name", SOURCES)
def test_code_is_that_of_the_chapter(name):
    source = nbformat.read(SOURCES[name], as_version=4)
    downloads = (notebook(name), jupytext.reads(script(name), fmt="py:percent"))
    codes = [[c.source for c in nb.cells if c.cell_type == "code"] for nb in (source, *downloads)]
    assert codes[0] == codes[1] == codes[2]
    assert all(not cell.get("outputs") for cell in notebook(name).cells)


@pytest.mark.parametrize("name", CHAPTERS)
def test_no_solution_is_inside(name):
    """There is none in the download or in the chapter that it was made from."""
    downloads = prose(notebook(name)) + script(name)
    chapter = SOURCES[name].read_text("utf8")
    assert "{solution" not in chapter and "Solution to Exercise" not in downloads
    assert "solution-start" not in chapter
    code = "\n".join(cell.source for cell in notebook(name).cells if cell.cell_type == "code")
    for cell in nbformat.read(SOLUTIONS, as_version=4).cells:
        if cell.cell_type == "code" and "import" not in cell.source:
            assert cell.source not in code


@pytest.mark.parametrize(
    ("address", "written"),
    [
        ("", "More on this: The way back."),
        (
            "https://book.example/b",
            "More on this: [The way back](https://book.example/b/chapters/frames.html#way-back).",
        ),
    ],
)
def test_a_link_to_another_page_leads_to_the_book_where_it_has_an_address(address, written):
    config = SimpleNamespace(numfig_format={}, html_baseurl=address)
    env = SimpleNamespace(toc_fignumbers={}, toc_secnumbers={}, config=config)
    link = nodes.reference("", "The way back", refuri="../chapters/frames.html#way-back")
    paragraph = nodes.paragraph("", "", nodes.Text("More on this: "), link, nodes.Text("."))
    assert MarkdownWriter(env, "appendix/essay").inline(paragraph) == written
