"""The manual for authors: its examples are questions that pass, and its replies are real."""

import csv
import os
import re
import shlex
import subprocess

import pytest
from trial_course import PINNED, PROJECT, write_source

from coursework.authoring.selftest import _judge, try_question
from coursework.authoring.source import read_source

MANUAL = (PROJECT / "docs" / "manual.md").read_text("utf8")
BLOCK = re.compile(
    r"<!-- (example|reply|the rest of it)(?:: (.*?))? -->\n```(?:python|text)\n(.*?)```", re.S
)
SOLVE = """
import sys, nbformat
from coursework.authoring.source import solved
notebook = nbformat.read(sys.argv[1], as_version=4)
for cell in notebook.cells:
    cell.source = solved(cell.source)
nbformat.write(notebook, sys.argv[2])
"""
SETUP = (
    "import sympy as sm\nfrom coursework import check, variant\n"
    "x, y, F_x, F_y = sm.symbols('x, y, F_x, F_y')"
)
TEXT = re.search(r"```text\n(A child .*?)```", MANUAL, re.S)[1]


def examples():
    """Return each example with its cells, and the replies that follow it."""
    all_examples = []
    for kind, about, text in BLOCK.findall(MANUAL):
        if kind == "example":
            all_examples.append((about, [text], []))
        elif kind == "reply":
            all_examples[-1][2].append((about, text.rstrip("\n")))
        else:
            all_examples[-1][1].extend([TEXT, text])
    return all_examples


@pytest.mark.parametrize(
    "about, cells, replies", [pytest.param(*example, id=example[0]) for example in examples()]
)
def test_an_example_is_a_question_that_passes(tmp_path, about, cells, replies):
    sources = [("code", SETUP), *(("markdown" if text is TEXT else "code", text) for text in cells)]
    (question,) = read_source(write_source(tmp_path, *sources, name="manual")).questions.values()
    assert try_question(question, against_sealed=False).faults == []
    names = {}
    exec(SETUP, names)
    for wrong, said in replies:
        assert repr(_judge(question, eval(wrong, names))) == said


def test_the_manual_has_examples_of_most_kinds_and_names_all():
    assert len(examples()) >= 5 and sum(len(replies) for *_, replies in examples()) >= 4
    from coursework.checking.kinds import KINDS

    for kind in KINDS:
        assert f"`{kind}`" in MANUAL


@pytest.mark.long
def test_every_command_of_the_manual_runs_in_the_order_in_which_it_stands(tmp_path):
    """Go from an empty folder to the marks with only the manual and the two packages."""
    blocks = re.findall(r"```console\n(.*?)```", MANUAL, re.S)
    assert (
        "venv" in blocks[0]
        and "new" in blocks[1]
        and "try" in blocks[2]
        and "grade" in blocks[3]
        and len(blocks) == 7
    )
    blocks[0] = blocks[0].replace("REPOSITORY", shlex.quote(str(PROJECT.parents[1])))
    # Nothing below opens JupyterLab, and installing it would take longer than everything else.
    blocks[0] = blocks[0].removesuffix(" jupyterlab\n")
    (tmp_path / "solve.py").write_text(SOLVE)
    # The manual says to do this before exporting questions.
    (tmp_path / "choice.py").write_text(
        next(cells[0] for about, cells, _ in examples() if about == "a choice").replace(
            "manual/", "first-steps/"
        )
    )
    adding = (
        'python -c "import nbformat; from nbformat.v4 import new_code_cell, new_markdown_cell\n'
        "notebook = nbformat.read('solutions/first-steps.ipynb', 4)\n"
        "choice = new_code_cell(open('../choice.py').read())\n"
        "notebook.cells += [new_markdown_cell('Which unit?'), choice]\n"
        "nbformat.write(notebook, 'solutions/first-steps.ipynb')\"\n"
    )
    handing_in = (
        "mkdir -p handed-in/ada handed-in/ben\n"
        "python ../solve.py solutions/first-steps.ipynb handed-in/ada/first-steps.ipynb\n"
        "cp exercises/first-steps.ipynb handed-in/ben\n"
    )
    script = "\n".join(["set -e", *blocks[:3], handing_in, *blocks[3:-1], adding, blocks[-1]])
    environment = {
        name: value for name, value in os.environ.items() if name != "PYTHONPATH"
    } | PINNED
    done = subprocess.run(
        ["bash", "-c", script], cwd=tmp_path, env=environment, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
    course = tmp_path / "first-course"
    assert (course / "build" / "try.html").is_file() and (
        course / "build" / "exercises.zip"
    ).is_file()
    assert (course / "marks" / "report.html").is_file() and len(
        list((course / "marks" / "feedback").rglob("*.html"))
    ) >= 2
    assert (course / "feedback.zip").is_file() and (
        course / "marks" / "course" / "course.csv"
    ).is_file()
    rows = csv.DictReader((course / "marks" / "grades.csv").read_text("utf-8-sig").splitlines())
    points = {
        row["student"]: float(row["points"]) for row in rows if row["assignment"] == "first-steps"
    }
    assert points["ada"] > 0 == points["ben"]
