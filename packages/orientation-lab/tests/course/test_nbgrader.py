"""The released notebooks in nbgrader's own tools."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest

from coursework.authoring import release
from coursework.authoring.course import find_course

COURSE = find_course(Path(__file__).parent)
ASSIGNMENT = "simple-orientations"


@pytest.fixture(autouse=True, scope="module")
def nbgrader_utils():
    return pytest.importorskip("nbgrader.utils")


def test_the_checksums_are_nbgraders(nbgrader_utils):
    for path in COURSE.exercises.glob("*.ipynb"):
        for cell in nbformat.read(path, as_version=4).cells:
            about = cell.metadata.get("nbgrader")
            if about:
                assert about["checksum"] == nbgrader_utils.compute_checksum(cell)


def test_the_metadata_is_of_schema_3():
    from nbgrader.nbgraderformat.v3 import MetadataValidatorV3

    for path in COURSE.exercises.glob("*.ipynb"):
        notebook = nbformat.read(path, as_version=4)
        for cell in notebook.cells:
            if "nbgrader" in cell.metadata:
                MetadataValidatorV3().validate_cell(cell)
        points = [
            cell.metadata.nbgrader.points
            for cell in notebook.cells
            if cell.metadata.get("nbgrader", {}).get("grade")
        ]
        assert len(points) >= 4 and all(points)


def run(*command, folder):
    # nbgrader calls a tool of its own by name, so the folder of the tools is on the path.
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = {
        **os.environ,
        "PATH": path,
        "JUPYTER_CONFIG_DIR": str(folder),
        "JUPYTER_DATA_DIR": str(folder / "data"),
        "IPYTHONDIR": str(folder / "ipython"),
        "HOME": str(folder),
    }
    done = subprocess.run(
        [sys.executable, "-m", "nbgrader", *command],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr


@pytest.mark.long
@pytest.mark.skipif(
    not any(COURSE.sources.glob("*.ipynb")),
    reason="the solutions are kept elsewhere and are not here",
)
def test_nbgrader_grades_a_submission_by_our_checks(tmp_path):
    """One question right, one wrong, the rest untouched: the points are those of the right one."""
    from nbgrader.api import Gradebook

    source = release.read_source(COURSE.sources / f"{ASSIGNMENT}.ipynb")
    names = list(source.questions)
    answers = {cell.source for cell in source.notebook.cells}
    notebook = nbformat.read(COURSE.exercises / f"{ASSIGNMENT}.ipynb", as_version=4)
    right, wrong = (source.questions[name].variable for name in names[:2])
    for cell in notebook.cells:
        if cell.source.startswith(f"{right} = ..."):
            solved = next(
                text for text in answers if "BEGIN SOLUTION" in text and f"{right} =" in text
            )
            cell.source = solved
        elif cell.source.startswith(f"{wrong} = ..."):
            cell.source = f"{wrong} = sm.eye(3)"
    for folder, content in (("source", None), ("submitted/someone", notebook)):
        place = tmp_path / folder / ASSIGNMENT
        place.mkdir(parents=True)
        shutil.copy(COURSE.exercises / f"{ASSIGNMENT}.ipynb", place)
        if content:
            nbformat.write(content, place / f"{ASSIGNMENT}.ipynb")
    (tmp_path / "nbgrader_config.py").write_text(
        "c = get_config()\nc.CourseDirectory.course_id = 'trial'\n"
    )
    run("generate_assignment", ASSIGNMENT, "--force", folder=tmp_path)
    run("autograde", ASSIGNMENT, "--force", folder=tmp_path)
    with Gradebook(f"sqlite:///{tmp_path}/gradebook.db") as book:
        submission = book.find_submission(ASSIGNMENT, "someone")
        assert submission.score == source.questions[names[0]].worth
        assert submission.max_score == sum(question.worth for question in source.questions.values())
