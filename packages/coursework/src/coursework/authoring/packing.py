"""Pack the notebooks, the sealed questions and the package of checks for students to download."""

import base64
import hashlib
import io
import re
import shutil
import subprocess
import tempfile
import zipfile
from collections.abc import Collection, Iterable, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from pkgutil import resolve_name

import coursework

from ..checking.update import MANIFEST, manifest
from .author import AuthorError
from .course import Course, find_course

#: The time of every file in an archive, so that the same contents give the same bytes.
TIME = (2026, 1, 1, 0, 0, 0)
#: The files of coursework in each distribution, its dependencies and its summary. Students get
#: neither the author's tools nor the grader.
DISTRIBUTIONS = {
    "coursework-checks": (
        ("*.py", "py.typed", "checking/*.py"),
        ("sympy<2,>=1.14",),
        "Self-checking exercises in notebooks that contain no answers: what a student needs",
    ),
    "coursework-tools": (
        ("authoring/**/*", "grading/**/*"),
        (
            "coursework-checks=={version}",
            "ipykernel",
            "ipython",
            "jinja2",
            "latex2mathml",
            "markdown-it-py",
            "markupsafe",
            "matplotlib",  # for students' plots
            "mdit-py-plugins",
            "nbclient",
            "nbformat",
            "numpy",
            "packaging",
            "pillow",
            "pyyaml",  # for Gradescope's table of submissions
            "tornado",  # for the page to mark in
        ),
        "Self-checking exercises in notebooks that contain no answers: what authors and "
        "instructors need",
    ),
}
README = """Exercises of {title}

1. Install Python 3.11 or newer. Then, once, in this folder, on Linux or macOS:

       python3 -m venv environment
       source environment/bin/activate
       python -m pip install -r requirements.txt

   and on Windows:

       py -m venv environment
       environment\\Scripts\\activate
       python -m pip install -r requirements.txt

   These lines install the package that came with the exercises. Do not run "pip install
   coursework": the project of that name on the index belongs to somebody else.

   The folder "environment" contains Python and the packages that the exercises need, separate
   from your system's Python. If somebody gave you a folder "wheels" for use without a network,
   the last line is

       python -m pip install --no-index --find-links wheels -r requirements.txt

2. Start Jupyter and open a notebook. On another day, begin with the second line above:

       jupyter lab

Replace the dots with your answer and run the check below each question. It tells you whether
the answer is right, or what you mixed up. Your progress is kept in the folder .coursework
beside the notebooks and nowhere else.

Python forgets everything when you open a notebook again or restart its kernel. Then first run
the cells above, with Run > Run All Above Selected Cell. Otherwise Python says, for example,
"name 'check' is not defined".

When there is a newer archive, do not unpack it over your work. Run

       python -m coursework update exercises.zip

in this folder. It adds the new files, replaces the old package and tells you how to install the
new one. It replaces the notebooks that you have not changed, and keeps those that you have.
"""
ABOUT = """Metadata-Version: 2.1
Name: {name}
Version: {version}
Summary: {summary}
License: BSD-3-Clause
Requires-Python: >=3.11
"""


WHEEL = """Wheel-Version: 1.0
Generator: coursework
Root-Is-Purelib: true
Tag: py3-none-any
"""
VERSION = re.compile(r'^__version__ = "(.*)"$', re.M)


def own_wheels(course: Course, folder: str | Path) -> list[Path]:
    """Return the wheels for students that the function in course.toml builds."""
    try:
        build = resolve_name(course.package)
        if not callable(build):
            raise ValueError("it is not a function")
    except (ImportError, AttributeError, ValueError) as error:
        raise AuthorError(
            f"course.toml says package = {course.package!r}, but we cannot use it: {error}. Write "
            "MODULE:FUNCTION, and install the package that contains the module here."
        ) from None
    wheels = list(build(folder) or ())
    if not wheels:
        raise AuthorError(
            f"{course.package} in course.toml returned no wheels for students. It has to return "
            "the paths of those that it builds. Perhaps it ends without `return`."
        )
    return wheels


def archive(course: Course, target: str | Path | None = None) -> Path:
    """Make the archive for students. The same contents give the same bytes.

    Parameters
    ----------
    course : Course
    target : path, optional
        Another path than the course's.
    """
    target = Path(target or course.archive)
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        wheels = (
            own_wheels(course, folder) if course.package else [wheel("coursework-checks", folder)]
        )
        packages = {path.name: path.read_bytes() for path in wheels}
    files = {
        "README.txt": README.format(title=course.title).encode("utf8"),
        # The manifest lists the digest of each file.
        "requirements.txt": "".join(
            f"{requirement}\n"
            for requirement in [*(f"./{name}" for name in packages), "jupyterlab", "latex2mathml"]
        ).encode(),
        **packages,
    }
    files |= {path.name: path.read_bytes() for path in course.exercises.glob("*.ipynb")}
    if not course.package:
        files |= {
            f"sealed/{path.relative_to(course.sealed).as_posix()}": path.read_bytes()
            for place in (course.sealed, course.sealed / "variants")
            for path in place.glob("*.json")
        }
    files[MANIFEST] = manifest(files, course.title).encode()
    write_zip(target, {f"exercises/{name}": content for name, content in files.items()})
    return target


def archive_of(folder: str | Path, target: str | Path) -> Path:
    """Make the archive for the course in a folder, for code that builds a course's pages."""
    return archive(find_course(folder), target)


def dated(
    stated: str,
    tag: str,
    folder: str | Path,
    paths: Sequence[str] = (".",),
    files: Sequence[Path] = (),
) -> str:
    """Return the version of a package built from its sources, such as ``1.2.0.dev20261122093000``.

    pip replaces an installed package only by one of another version. So only the sources at the tag
    get the stated version itself. Before the tag, the version is the stated one in development,
    with the time in UTC when the sources were last changed: committed or, if something is not
    committed or there is no repository, written. Sources changed after the tag are in development
    of the next version, so that versions only ever increase.

    Parameters
    ----------
    stated, tag : str
    folder : path
        Usually in the repository.
    paths : sequence of str
        The sources for git, as patterns of paths below the folder.
    files : sequence of Path
        The sources, if there is no repository.
    """

    def git(*arguments: str) -> str:
        """Return git's answer, or an empty string without git or a repository that it can read."""
        if not shutil.which("git"):
            return ""
        done = subprocess.run(
            ["git", "-C", folder, *arguments, "--", *paths], capture_output=True, text=True
        )
        return done.stdout.strip() if done.returncode == 0 else ""

    def named(*arguments: str) -> list[Path]:
        return [Path(folder, name) for name in git(*arguments, "-z").split("\0") if name]

    committed = git("log", "-1", "--format=%ct")
    if committed:
        unknown = named("ls-files", "--others", "--exclude-standard")
        if git("log", "-1", "--format=%ct", tag):
            if not unknown + named("diff", "--name-only", "--relative", tag):
                return stated
            stated = next_version(stated)
        files = unknown + named("diff", "--name-only", "--relative", "HEAD")
    # The folder of a deleted file has the time of the deletion.
    written = [(path if path.exists() else path.parent).stat().st_mtime for path in files]
    latest = datetime.fromtimestamp(max([int(committed or 0), *written]), UTC)
    return f"{stated}.dev{latest:%Y%m%d%H%M%S}"


def next_version(stated: str) -> str:
    """Return the version that follows when only a mistake is corrected.

    >>> next_version("1.0.0")
    '1.0.1'
    """
    *front, last = stated.split(".")
    return ".".join([*front, str(int(last) + 1)])


def _own_version(root: Path) -> str:
    """Return the version of this package, or of the wheel from which it was installed."""
    tracked = (
        shutil.which("git")
        and not subprocess.run(
            ["git", "-C", root, "ls-files", "--error-unmatch", "__init__.py"], capture_output=True
        ).returncode
    )
    stated = coursework.__version__
    return dated(stated, f"coursework-checks-{stated}", root) if tracked else stated


def wheel(name: str, folder: str | Path) -> Path:
    """Build one of `DISTRIBUTIONS` from the installed coursework, and return its file."""
    patterns, needs, summary = DISTRIBUTIONS[name]
    root = Path(coursework.__file__).parent
    version = _own_version(root)
    files = {
        f"coursework/{path.relative_to(root).as_posix()}": path.read_bytes()
        for pattern in patterns
        for path in root.glob(pattern)
        if path.is_file() and "__pycache__" not in path.parts
    }
    if "coursework/__init__.py" in files:
        text = files["coursework/__init__.py"].decode("utf8")
        files["coursework/__init__.py"] = VERSION.sub(f'__version__ = "{version}"', text).encode(
            "utf8"
        )
    command = (
        "[console_scripts]\ncoursework = coursework.__main__:main\n"
        if name == "coursework-checks"
        else ""
    )
    return write_wheel(
        folder,
        name,
        version,
        summary,
        [requirement.format(version=version) for requirement in needs],
        files,
        command,
    )


def write_wheel(
    folder: str | Path,
    name: str,
    version: str,
    summary: str,
    needs: Iterable[str],
    files: Mapping[str, bytes],
    entry_points: str,
) -> Path:
    """Write a wheel of plain files, by their names in it; the same contents give the same bytes."""
    place = f"{name.replace('-', '_')}-{version}"
    about = ABOUT.format(name=name, version=version, summary=summary)
    files = {
        **files,
        f"{place}.dist-info/METADATA": (
            about + "".join(f"Requires-Dist: {requirement}\n" for requirement in needs)
        ).encode(),
        f"{place}.dist-info/WHEEL": WHEEL.encode(),
        f"{place}.dist-info/entry_points.txt": entry_points.encode(),
    }
    lines = [
        f"{name},sha256={_digest(content)},{len(content)}\n"
        for name, content in sorted(files.items())
    ]
    record = f"{place}.dist-info/RECORD"
    files[record] = "".join([*lines, f"{record},,\n"]).encode()
    return write_zip(Path(folder, f"{place}-py3-none-any.whl"), files)


def _digest(content: bytes) -> str:
    return base64.urlsafe_b64encode(hashlib.sha256(content).digest()).decode().rstrip("=")


def write_zip(target: Path, files: Mapping[str, bytes]) -> Path:
    """Write contents by name to a zip file; the same contents give the same bytes."""
    target.write_bytes(zipped(files))
    return target


def zipped(files: Mapping[str, bytes], programs: Collection[str] = ()) -> bytes:
    """Return a zip file of contents by name, some of which are ``programs`` that can be run."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as box:
        for name in sorted(files):
            entry = zipfile.ZipInfo(name, TIME)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o755 if name in programs else 0o644) << 16
            box.writestr(entry, files[name])
    return packed.getvalue()
