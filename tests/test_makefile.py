"""The commands of the Makefile, without the programs: what is set up, how often and when."""

import os
import re
import shutil
import subprocess
import sys
import time

import pytest
from places import REPOSITORY

# A replacement of Python that records when it began and ended.
RECORDER = """#!/bin/sh
echo "begin $*" >> "$LOG"
mkdir -p .venv/runtime
sleep 0.1
echo "end $*" >> "$LOG"
"""


@pytest.fixture
def make(tmp_path):
    """``make(*arguments)``: run the Makefile in a folder of its own.

    Returns each started program as a line of text.
    """
    for name in ("Makefile", "constraints.txt", "pyproject.toml"):
        shutil.copy(REPOSITORY / name, tmp_path)
    for name in (
        "packages/notebook-pages/src/notebook_pages/package-lock.json",
        "packages/notebook-pages/src/notebook_pages/live/wheels.txt",
        "packages/notebook-pages/src/notebook_pages/lite/wheels.txt",
        "packages/notebook-pages/src/notebook_pages/ipython_kernel_config.py",
    ):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(REPOSITORY / name, tmp_path / name)
    programs = tmp_path / ".venv" / "bin"
    programs.mkdir(parents=True)
    (tmp_path / "node_modules").mkdir()
    (programs / "python").write_text(RECORDER)
    (programs / "python").chmod(0o755)

    def run(*arguments):
        log = tmp_path / "log"
        log.write_text("")
        environment = {**os.environ, "LOG": str(log), "MAKEFLAGS": ""}
        done = subprocess.run(
            ["make", *arguments], cwd=tmp_path, env=environment, capture_output=True, text=True
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return log.read_text().splitlines()

    return run


def installs(lines):
    return [
        line
        for line in lines
        if line.startswith("begin") and " install " in line and "--editable" in line
    ]


def test_nothing_is_installed_beside_something_else(make):
    lines = make("-j4", "test")
    assert len(lines) > 8
    assert [line.split()[0] for line in lines] == ["begin", "end"] * (len(lines) // 2)


@pytest.mark.parametrize("version", ["(3, 10, 13)", "(3, 16, 0)"])
def test_a_python_that_is_too_old_or_too_new_hears_it_in_one_sentence(tmp_path, version):
    for name in ("Makefile", "constraints.txt", "pyproject.toml"):
        shutil.copy(REPOSITORY / name, tmp_path)
    unsuitable = tmp_path / "python"
    unsuitable.write_text(
        f"#!/bin/sh\nexec {sys.executable} -c "
        f"'import sys; sys.version_info = {version}; exec(sys.argv[1])' \"$2\"\n"
    )
    unsuitable.chmod(0o755)
    # When make runs these tests, the inner make would use another name for itself.
    own = {name: value for name, value in os.environ.items() if not name.startswith("MAKE")}
    done = subprocess.run(
        ["make", "book", f"PYTHON={unsuitable}"],
        cwd=tmp_path,
        env=own,
        capture_output=True,
        text=True,
    )
    first, *others = done.stderr.splitlines()
    assert first.startswith("The book needs Python 3.11 to 3.15; this is ")
    assert len(others) == 1 and others[0].startswith("make: ***")


def test_what_the_tests_installed_is_not_installed_again(make):
    assert len(installs(make("test"))) == 1
    time.sleep(1.1)
    for command in ("book", "take-away", "check", "release", "new-question", "new-chapter"):
        assert not installs(lines := make(command, "NAME=belt-trick", 'TITLE=Dirac\'s "spin"'))
    # The shell leaves the title as the author wrote it.
    assert any('chapter belt-trick Dirac\'s "spin"' in line for line in lines)


def test_what_the_book_installed_is_not_enough_for_the_tests(make):
    assert len(installs(make("book"))) == 1
    assert len(installs(make("test"))) == 1


def test_one_notebook_is_released_and_tried_alone(make):
    lines = [
        line
        for line in make("release", "ONLY=belt-trick chapters")
        if line.startswith("begin -m coursework")
    ]
    assert [line.removeprefix("begin -m coursework ") for line in lines] == [
        "release belt-trick chapters",
        "selftest belt-trick chapters",
    ]


def test_a_check_builds_nothing(make):
    assert not any("notebook_pages.build" in line for line in make("check"))


def test_every_command_is_among_those_that_are_listed():
    """`make programs` and `make setup` were once missing."""
    text = (REPOSITORY / "Makefile").read_text("utf8")
    (commands,) = re.findall(r"^\.PHONY: help (.*)$", text, re.M)
    assert set(re.findall(r'@echo "make ([a-z-]+)', text)) == set(commands.split())


def test_nothing_is_deleted_out_of_packages():
    """pip would no longer know what it has installed."""
    rule = (
        (REPOSITORY / "Makefile")
        .read_text("utf8")
        .partition("$(VENV)/ready-%:")[2]
        .partition("\n\n")[0]
    )
    assert "$(PIP)" in rule and not re.search(r"\brm\b|-delete|unlink", rule)
