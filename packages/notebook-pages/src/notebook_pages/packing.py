"""The packages that readers and students install: a wheel for each project that the book names.

They contain neither the grader nor the author's tools. The version of each depends on its sources,
so that pip replaces an older one and does nothing if nothing has changed.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
import zipfile
from collections.abc import Iterable, Mapping
from datetime import UTC, datetime
from functools import cache, cached_property
from pathlib import Path
from typing import IO

from .paths import REGISTERED, REPOSITORY

# Every file in an archive has this time, so that equal contents give equal bytes.
TIME = (2026, 1, 1, 0, 0, 0)
#: Further sources of a wheel, if a project has them.
ABOUT = ("pyproject.toml", "README.md", "LICENSE", "LICENSE-CODE")
# The file in which a project states its version: its ``pyproject.toml``, or else the first of its
# packages.
STATED = re.compile(r'^(__version__|version) = "(?P<version>.*)"$', re.M)


class Project:
    """A project whose wheel is built for readers.

    Parameters
    ----------
    folder, packages, left_out : str, sequences of str
        Its folder, the packages that the wheel contains, and the parts of them that readers do not
        get, as paths from the root of the repository.
    repository : path, optional
    """

    def __init__(
        self,
        folder: str | Path,
        packages: Iterable[str],
        left_out: Iterable[str] = (),
        repository: str | Path = REPOSITORY,
    ) -> None:
        self.repository, self.folder = Path(repository), Path(folder)
        self.packages, self.left_out = tuple(packages), tuple(left_out)

    @cached_property
    def about(self) -> Mapping[str, object]:
        """The table ``project`` of its ``pyproject.toml``."""
        settings = tomllib.loads(
            (self.repository / self.folder / "pyproject.toml").read_text("utf8")
        )
        about: dict[str, object] = settings["project"]
        return about

    @property
    def name(self) -> str:
        return str(self.about["name"])

    def sources(self) -> list[Path]:
        """Return the files that the wheel is made of."""
        files = [
            path
            for place in self.packages
            for path in Path(self.repository, place).rglob("*")
            if path.is_file()
        ]
        left_out = [self.repository / place for place in self.left_out]
        about = [self.repository / self.folder / name for name in ABOUT]
        return [path for path in about if path.exists()] + sorted(
            path
            for path in files
            if not {"__pycache__", "build"} & set(path.relative_to(self.repository).parts)
            and path not in about
            and not any(path.is_relative_to(place) for place in left_out)
        )

    @cache  # noqa: B019  (there are as many as the book names, and they last)
    def version(self) -> str:
        """Return the version of the wheel: as the sources state it, or ``1.1.0.dev20261122093000``.

        pip replaces an installed package only by one of another version. So only the sources at its
        tag have the stated version. Before the tag, the version is a development release of the
        stated one, with the time in UTC of the last change of the sources: that of the commit or,
        if something is not committed or there is no repository, of the files. Sources changed after
        the tag are a development release of the next version, so that versions only ever increase.
        """
        file = self._stating(self.repository)
        statement = STATED.search(file.read_text("utf8"))
        if statement is None:
            raise RuntimeError(f"{file} must state the version")
        stated = statement["version"]
        tag, committed, changed = (
            f"{self.name}-{stated}",
            self._git("log", "-1", "--format=%ct"),
            self.sources(),
        )
        if committed:
            unknown = self._named("ls-files", "--others", "--exclude-standard")
            if self._git("log", "-1", "--format=%ct", tag):
                if not (unknown or self._named("diff", "--name-only", "--relative", tag)):
                    return stated
                *front, last = stated.split(".")
                stated = ".".join([*front, str(int(last) + 1)])
            changed = unknown + self._named("diff", "--name-only", "--relative", "HEAD")
        # If a file is gone, use the date of its folder.
        written = [(path if path.exists() else path.parent).stat().st_mtime for path in changed]
        latest = datetime.fromtimestamp(max([int(committed or 0), *written]), UTC)
        return f"{stated}.dev{latest:%Y%m%d%H%M%S}"

    def _git(self, *arguments: str) -> str:
        """Return git's output about the sources, or nothing without a readable repository."""
        if not shutil.which("git"):
            return ""
        paths = [*(str(self.folder / name) for name in ABOUT), *self.packages]
        paths += [f":(exclude){place}" for place in self.left_out]
        done = subprocess.run(
            ["git", "-C", self.repository, *arguments, "--", *paths], capture_output=True, text=True
        )
        return done.stdout.strip() if done.returncode == 0 else ""

    def _named(self, *arguments: str) -> list[Path]:
        return [
            Path(self.repository, name) for name in self._git(*arguments, "-z").split("\0") if name
        ]

    def _stating(self, repository: str | Path) -> Path:
        """Return the file that states the version."""
        file = "pyproject.toml" if "version" in self.about else None
        return (
            Path(repository, self.folder, file)
            if file
            else Path(repository, self.packages[0], "__init__.py")
        )

    def wheel_name(self) -> str:
        """Return the file name of the wheel."""
        return f"{self.name.replace('-', '_')}-{self.version()}-py3-none-any.whl"

    def build_wheel(self, folder: str | Path) -> Path:
        """Build the wheel from a copy: setuptools leaves files, and the version is set here."""
        with tempfile.TemporaryDirectory() as place:
            for path in self.sources():
                target = Path(place, path.relative_to(self.repository))
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(path, target)
            stating = self._stating(place)
            text, count = STATED.subn(rf'\1 = "{self.version()}"', stating.read_text("utf8"))
            if count != 1:
                raise RuntimeError(
                    f"{stating.relative_to(place)} must state the version once, not {count} times"
                )
            stating.write_text(text, "utf8")
            command = [
                sys.executable,
                "-m",
                "pip",
                "wheel",
                "--quiet",
                "--disable-pip-version-check",
                "--no-deps",
            ]
            subprocess.run(
                [*command, "--no-build-isolation", "--wheel-dir", folder, Path(place, self.folder)],
                check=True,
                env={
                    **os.environ,
                    "SOURCE_DATE_EPOCH": str(int(datetime(*TIME, tzinfo=UTC).timestamp())),
                },
            )
        return Path(folder, self.wheel_name())


class Ready:
    """A project of which only the wheel exists, with the interface of `Project`."""

    def __init__(self, file: str, packages: Iterable[str]) -> None:
        self.file, self.packages = REPOSITORY / file, tuple(packages)
        distribution, self._version = self.file.name.split("-")[:2]
        self.name = distribution.replace("_", "-")

    def version(self) -> str:
        return self._version

    def sources(self) -> list[Path]:
        return [self.file]

    def wheel_name(self) -> str:
        return self.file.name

    def build_wheel(self, folder: str | Path) -> Path:
        Path(folder).mkdir(parents=True, exist_ok=True)
        return Path(shutil.copy(self.file, folder))


def write_zip(target: Path | IO[bytes], files: Mapping[str, str | bytes]) -> None:
    """Write contents by name into a reproducible zip."""
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as box:
        for name in sorted(files):
            entry = zipfile.ZipInfo(name, TIME)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.create_system, entry.external_attr = 3, 0o644 << 16
            box.writestr(entry, files[name])


# The wheels that the book names, with its own project last.
PROJECTS = [
    Ready(entry["file"], entry["packages"])
    if "file" in entry
    else Project(entry["project"], entry["packages"], entry.get("leave-out", ()))
    for entry in REGISTERED.get("wheels", ())
]


def build_wheels(folder: str | Path) -> list[Path]:
    """Build the wheels for students, and return their files."""
    return [project.build_wheel(folder) for project in PROJECTS]
