"""The package that readers and students install.

The package holds no grader and no author's tools. Its version follows from its sources, so that pip installs a
newer one over an older one, and says that nothing is to be done where nothing has changed.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import tomllib
from datetime import UTC, datetime
from functools import cache
from pathlib import Path

from coursework.authoring.packing import TIME, VERSION, dated

from .paths import PACKAGES, REPOSITORY

#: The name of the package for students.
PROJECT = tomllib.loads((REPOSITORY / "pyproject.toml").read_text("utf8"))["project"]["name"]
ABOUT = ("pyproject.toml", "README.md", "LICENSE", "LICENSE-CODE")
#: Parts of those packages that students do not get.
LEFT_OUT = ("src/coursework/authoring", "src/coursework/grading", "src/orientation_course/attack.py")


def wheel_sources(repository=REPOSITORY):
    """The files that the package for students is made of."""
    packages = [repository / "src" / name for name in PACKAGES]
    found = [path for package in packages for path in package.rglob("*") if path.is_file()]
    left_out = [repository / place for place in LEFT_OUT]
    return [repository / name for name in ABOUT] + sorted(
        path
        for path in found
        if "__pycache__" not in path.parts and not any(path.is_relative_to(place) for place in left_out)
    )


@cache
def version(repository=REPOSITORY):
    """The version of the package for students, such as ``1.1.0.post20261122093000``."""
    paths = [*ABOUT, *(f"src/{name}" for name in PACKAGES), *(f":(exclude){place}" for place in LEFT_OUT)]
    stated = VERSION.search(_stamped(repository).read_text("utf8"))[1]
    return dated(stated, f"{PROJECT}-{stated}", repository, paths, wheel_sources(repository))


def _stamped(repository):
    """The file that states the version."""
    return Path(repository, "src", "orientation", "__init__.py")


def wheel_name():
    """The name of the file of the package for students."""
    return f"{PROJECT.replace('-', '_')}-{version()}-py3-none-any.whl"


def build_wheel(folder):
    """Build the package for students, from a copy: setuptools leaves files behind, and here the version is set."""
    with tempfile.TemporaryDirectory() as place:
        for path in wheel_sources():
            target = Path(place, path.relative_to(REPOSITORY))
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(path, target)
        stamped = _stamped(place)
        text, count = VERSION.subn(f'__version__ = "{version()}"', stamped.read_text("utf8"))
        if count != 1:
            raise RuntimeError(f"orientation/__init__.py must set __version__ once; it does {count} times")
        stamped.write_text(text, "utf8")
        command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--disable-pip-version-check", "--no-deps"]
        subprocess.run(
            [*command, "--no-build-isolation", "--wheel-dir", folder, place],
            check=True,
            env={**os.environ, "SOURCE_DATE_EPOCH": str(int(datetime(*TIME, tzinfo=UTC).timestamp()))},
        )
    return Path(folder, wheel_name())
