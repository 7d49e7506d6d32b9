"""An engineer or a packager installs the repository's projects from an sdist and a wheel."""

import os
import re
import shutil
import subprocess
import sys
import tarfile
import zipfile

import pytest
from packaging.metadata import Metadata
from places import REPOSITORY

PROJECTS = (".", "packages/coursework", "packages/notebook-pages", "packages/orientation-lab")
BUILD = "import sys; from setuptools import build_meta as made; made.build_{}(sys.argv[1])"


def run(*command, **options):
    done = subprocess.run(
        [sys.executable, *map(str, command)], capture_output=True, text=True, **options
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module", params=PROJECTS)
def project(request, tmp_path_factory):
    """The name of a project, its unpacked sdist, and the wheel built from that sdist alone."""
    place = tmp_path_factory.mktemp("project")
    # Use a copy, since setuptools leaves folders behind where it builds.
    copy = place / "copy"
    tracked = subprocess.check_output(
        ["git", "ls-files", "-z", request.param], cwd=REPOSITORY, text=True
    ).split("\0")
    others = tuple(f"{name}/" for name in ("chapters", "exercises", "appendix", "packages"))
    for name in filter(None, tracked):
        if request.param != "." or not name.startswith(others):
            target = copy / name
            target.parent.mkdir(parents=True, exist_ok=True)
            os.link(REPOSITORY / name, target)
    run("-c", BUILD.format("sdist"), place, cwd=copy / request.param)
    (archive,) = place.glob("*.tar.gz")
    with tarfile.open(archive) as box:
        box.extractall(place / "unpacked", filter="data")
    (unpacked,) = (place / "unpacked").iterdir()
    run("-c", BUILD.format("wheel"), place, cwd=unpacked)
    (wheel,) = place.glob("*.whl")
    return request.param, unpacked, wheel


def test_a_wheel_from_the_sdist_is_whole_and_says_what_it_is(project):
    name, unpacked, wheel = project
    with zipfile.ZipFile(wheel) as box:
        names = box.namelist()
        (about,) = (entry for entry in names if entry.endswith(".dist-info/METADATA"))
        metadata = Metadata.from_email(box.read(about), validate=True)
    assert any("/licenses/" in entry for entry in names), "the wheel holds no licence"
    assert metadata.description and metadata.license_expression and metadata.classifiers
    in_sdist = {
        path.relative_to(unpacked / "src").as_posix()
        for path in unpacked.rglob("*.py")
        if path.is_relative_to(unpacked / "src")
    }
    modules = {entry for entry in names if entry.endswith(".py")}
    assert modules and modules <= in_sdist
    if name == ".":
        assert {entry.split("/")[0] for entry in modules} == {"orientation"}


def test_the_licence_names_every_folder_and_none_that_is_not_there():
    words = re.sub(r"https?://\S+", "", (REPOSITORY / "LICENSE").read_text("utf8"))
    named = set(re.findall(r"(?<!\S)\(?(?:everything in )?([\w./-]+)/(?=[\s,)])", words))
    tracked = subprocess.check_output(["git", "ls-files"], cwd=REPOSITORY, text=True).split()
    assert {name.split("/")[0] for name in tracked if "/" in name} <= named
    assert all((REPOSITORY / name).is_dir() for name in named)


def test_pytest_in_a_fresh_clone_says_what_to_run(tmp_path):
    """It once ended in a traceback of conftest.py."""
    for name in ("conftest.py", "pyproject.toml"):
        os.link(REPOSITORY / name, tmp_path / name)
    (tmp_path / "nbval.py").write_text("raise ModuleNotFoundError(name='nbval')")
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-p", "no:nbval", "--nbval", "chapters"],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(tmp_path)},
    )
    assert "package nbval is not there. `make test` sets up everything" in done.stdout + done.stderr
    assert "Traceback" not in done.stdout + done.stderr


@pytest.mark.parametrize("project", ["."], indirect=True)
def test_the_module_from_the_sdist_passes_its_tests(project, tmp_path):
    _, unpacked, wheel = project
    shutil.unpack_archive(wheel, tmp_path / "installed", "zip")
    output = run(
        *("-m", "pytest", "-q", "-p", "no:xdist", "-p", "no:cacheprovider"),
        *("tests/orientation/test_frames.py", "tests/orientation/test_borders.py"),
        cwd=unpacked,
        env={**os.environ, "PYTHONPATH": str(tmp_path / "installed")},
    )
    assert " passed" in output and "failed" not in output
