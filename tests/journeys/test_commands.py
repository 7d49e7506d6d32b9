"""A user pipes a command into `head`, or runs one that is not installed."""

import os
import shutil
import subprocess
import sys

import pytest
from places import REPOSITORY

SOURCES = [REPOSITORY / f"packages/{name}/src" for name in ("coursework", "orientation-lab")]


def run(script, **environment):
    done = subprocess.run(
        ["sh", "-c", script],
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHON": sys.executable, **environment},
    )
    return done.stdout + done.stderr


@pytest.mark.parametrize("unbuffered", ["", "1"])
@pytest.mark.parametrize(
    "command",
    [
        "orientation_workbench.command explain '0.1 0.2 0.3' '0.1 0.2 -0.3'",
        "orientation_workbench.command explain --help",
        "coursework grade --help",
    ],
)
def test_a_reader_that_has_seen_enough_gets_no_traceback(command, unbuffered):
    call = command if command.startswith("coursework") else None
    module, _, rest = command.partition(" ")
    program = call and f"-m {call}" or f"-c 'from {module} import main; main()' {rest}"
    output = run(f'("$PYTHON" {program} | true) 2>&1', PYTHONUNBUFFERED=unbuffered)
    assert output == ""


def test_a_student_who_asks_for_an_author_s_command_is_told_what_to_install(tmp_path):
    package = tmp_path / "coursework"
    shutil.copytree(
        SOURCES[0] / "coursework", package, ignore=shutil.ignore_patterns("authoring", "grading")
    )
    output = run(f'cd {tmp_path} && "$PYTHON" -m coursework new first-course')
    assert "invalid choice: 'new'" in output
    assert "install coursework-tools\nbeside coursework-checks" in output


def test_an_author_without_the_extra_is_told_which(tmp_path):
    (tmp_path / "nbformat.py").write_text("raise ModuleNotFoundError(name='nbformat')")
    output = run(
        f'cd {tmp_path} && "$PYTHON" -m coursework new first-course',
        PYTHONPATH=os.pathsep.join([str(tmp_path), str(SOURCES[0])]),
    )
    assert output.splitlines() == [
        "coursework new needs nbformat, which is not installed here. Install coursework-tools, or "
        "in a working copy: python -m pip install --editable '.[tools]'"
    ]
