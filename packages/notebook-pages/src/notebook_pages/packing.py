"""The packages that readers and students install: a wheel for each project that the book names.

They hold no grader and no author's tools. The version of each follows from its sources, so that pip
installs a newer one over an older one, and says that nothing is to be done where nothing has
changed.
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

from .paths import REGISTERED, REPOSITORY

#: Every file in an archive has this time, so that equal contents give equal bytes.
TIME = (2026, 1, 1, 0, 0, 0)
#: Further sources of a wheel, if a project has them.
ABOUT = ("pyproject.toml", "README.md", "LICENSE", "LICENSE-CODE")
#: The file in which a project states its version: its ``pyproject.toml``, or else the first of its
#: packages.
STATED = re.compile(r'^(__version__|version) = "(?P<version>.*)"$', re.M)


class Project:
    """A project whose wheel is built for readers.

    Parameters
    ----------
    folder, packages, left_out : str, sequences of str
        Its folder, the packages that the wheel holds, and parts of those that readers do not get;
        from the root of the repository.
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
        """What ``pyproject.toml`` says of it."""
        said = tomllib.loads((self.repository / self.folder / "pyproject.toml").read_text("utf8"))
        about: dict[str, object] = said["project"]
        return about

    @property
    def name(self) -> str:
        return str(self.about["name"])

    def sources(self) -> list[Path]:
        """The files that the wheel is made of."""
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
        """The version of the wheel: as the sources state it, or ``1.1.0.dev20261122093000``.

        pip replaces an installed package only by one of another version. So the stated version is
        for the sources of its tag alone. Before the tag, the version is the stated one still in
        development, with the time in UTC when the sources were last changed: committed or, where
        something is not committed or there is no repository, written. Sources changed after the
        tag are in development of the next version, so that versions only ever rise.
        """
        file = self._stating(self.repository)
        found = STATED.search(file.read_text("utf8"))
        if found is None:
            raise RuntimeError(f"{file} must state the version")
        stated = found["version"]
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
        # If a file is gone, the date of its folder tells when.
        written = [(path if path.exists() else path.parent).stat().st_mtime for path in changed]
        latest = datetime.fromtimestamp(max([int(committed or 0), *written]), UTC)
        return f"{stated}.dev{latest:%Y%m%d%H%M%S}"

    def _git(self, *arguments: str) -> str:
        """What git says of the sources, or nothing where there is no git, or
        no repository that it would read.
        """
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
        """The file that states the version."""
        file = "pyproject.toml" if "version" in self.about else None
        return (
            Path(repository, self.folder, file)
            if file
            else Path(repository, self.packages[0], "__init__.py")
        )

    def wheel_name(self) -> str:
        """The name of the wheel's file."""
        return f"{self.name.replace('-', '_')}-{self.version()}-py3-none-any.whl"

    def build_wheel(self, folder: str | Path) -> Path:
        """Build the wheel, from a copy: setuptools leaves files
        behind, and here the version is set.
        """
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
    """A project of which there is only the wheel; the same is asked of it as of a
    :class:`Project`.
    """

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


def write_zip(target: Path, files: Mapping[str, str | bytes]) -> None:
    """Write contents by name into a zip, always the same way."""
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as box:
        for name in sorted(files):
            entry = zipfile.ZipInfo(name, TIME)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o644 << 16
            box.writestr(entry, files[name])


#: The wheels that the book names, its own project last.
PROJECTS = [
    Ready(one["file"], one["packages"])
    if "file" in one
    else Project(one["project"], one["packages"], one.get("leave-out", ()))
    for one in REGISTERED.get("wheels", ())
]


def build_wheels(folder: str | Path) -> list[Path]:
    """Build the wheels for students; give their files."""
    return [project.build_wheel(folder) for project in PROJECTS]
