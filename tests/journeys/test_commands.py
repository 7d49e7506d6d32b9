"""A user pipes a command into `head`, pipes numbers in, or runs one that is not installed."""

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


@pytest.mark.parametrize(
    ("command", "unbuffered"),
    [
        ("orientation_workbench explain '1 0 0 0' '0 1 0 0'", ""),
        ("orientation_workbench explain '1 0 0 0' '0 1 0 0'", "1"),
        ("orientation_workbench.command explain --help", ""),
        ("orientation_workbench --version", "1"),
        ("coursework grade --help", "1"),
        ("coursework --version", ""),
    ],
)
def test_a_reader_that_has_seen_enough_gets_no_traceback(command, unbuffered):
    assert run(f'("$PYTHON" -m {command} | true) 2>&1', PYTHONUNBUFFERED=unbuffered) == ""


@pytest.mark.parametrize(
    "numbers, command, words",
    [
        ("echo 1 0 0 0", "explain - '1 0 0 0'", "the same orientation"),
        (
            "seq -f '%g 1 2 3 4 5 6' 50",
            "recording --quick -",
            "which columns come from which sensor",
        ),
        # A terminal without the sign for degrees.
        (
            "export PYTHONIOENCODING=ascii; (echo t_s,gx_dps,gy_dps,gz_dps,ax_g,ay_g,az_g; awk "
            """'BEGIN { OFS = ","; for (k = 0; k < 300; k++) """
            """print k / 100, sin(k), sin(2 * k), sin(3 * k), 0, 0, 1 + sin(5 * k) / 500 }')""",
            "recording --quick -",
            r"unit of the gyroscope: \xb0/s according to its heading",
        ),
    ],
)
def test_a_dash_stands_for_what_another_command_prints(numbers, command, words):
    assert words in run(f'{numbers} | "$PYTHON" -m orientation_workbench {command}')


def test_a_student_who_asks_for_an_author_s_command_is_told_what_to_install(tmp_path):
    package = tmp_path / "coursework"
    shutil.copytree(
        SOURCES[0] / "coursework", package, ignore=shutil.ignore_patterns("authoring", "grading")
    )
    output = run(
        f'cd {tmp_path} && "$PYTHON" -m coursework new first-course; "$PYTHON" -m coursework update'
    )
    assert "invalid choice: 'new'" in output and "\nusage: coursework update [-h]" in output
    assert "install coursework-tools\nas well as coursework-checks" in output


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
