"""The commands of authors: ``new``, ``release``, ``publish``, ``try``, ``bank`` and others."""

from __future__ import annotations

import os
import shlex
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .course import Course


def argument(*names: str, **options: Any) -> tuple[tuple[str, ...], dict[str, Any]]:
    """Return one argument of a command, as argparse takes it."""
    return names, options


def notebook_name(typed: str) -> str:
    """Return the name of a notebook or a question, for which a shell may have completed a path."""
    return Path(typed).stem if typed.endswith(".ipynb") else typed


SOURCES = argument(
    "--sources",
    type=Path,
    help="folder of the notebooks with solutions (default: the one in course.toml)",
)
#: The help and the arguments of each command.
ARGUMENTS = {
    "new": (
        "create a small course, ready to use",
        [
            argument(
                "course", metavar="COURSE", help="the folder to create; its name becomes the title"
            )
        ],
    ),
    "release": (
        "build the exercises, the sealed questions and the archive for students",
        [
            argument(
                "only",
                nargs="*",
                type=notebook_name,
                metavar="NOTEBOOK",
                help="names of the notebooks to release (default: all)",
            ),
            SOURCES,
        ],
    ),
    "publish": (
        "build a site from the exercises, with pages that check answers",
        [
            argument(
                "--site", type=Path, help="folder for the site (default: site, beside the archive)"
            ),
        ],
    ),
    "try": (
        "show a question as students will see it, with every reply",
        [
            argument(
                "name",
                type=notebook_name,
                metavar="NOTEBOOK/QUESTION",
                help="a question, or a notebook to show all of its questions",
            ),
            argument("--page", help="file for the page (default: try.html, beside the archive)"),
        ],
    ),
    "bank": (
        "write the questions WITH ALL ANSWERS for Moodle or another system",
        [
            argument("out", type=Path, metavar="OUT", help="file for the questions"),
            argument(
                "--format",
                choices=("moodle", "qti"),
                required=True,
                help="Moodle XML or a QTI 2.2 package",
            ),
            argument(
                "--questions",
                nargs="*",
                type=notebook_name,
                default=[],
                metavar="NOTEBOOK/QUESTION",
                help="questions or notebooks (default: all)",
            ),
        ],
    ),
    "wheels": (
        "build the packages of coursework, to install elsewhere",
        [argument("folder", type=Path, metavar="FOLDER", help="folder for the packages")],
    ),
    "selftest": (
        "test every question as a student would, and look for leaks",
        [
            argument(
                "only",
                nargs="*",
                type=notebook_name,
                metavar="NOTEBOOK",
                help="names of the notebooks to test (default: all)",
            ),
            SOURCES,
            argument(
                "--page", help="file for the page (default: selftest.html, beside the archive)"
            ),
        ],
    ),
}


def _course(sources: Path | None = None) -> Course:
    from .course import find_course

    course = find_course()
    return course._replace(sources=sources.resolve()) if sources else course


def new(course: str) -> None:
    from .new import new as make

    print(*make(course), sep="\n")


def release(only: Sequence[str], sources: Path | None) -> None:
    from ..checking.kinds import number_of
    from .closed import counted
    from .packing import archive
    from .release import release as make

    course = _course(sources)
    made = make(course, only)
    print(f"{number_of(len(made), 'notebook')} released.")
    print(f"For students: {archive(course)}")
    asked = {name: question for notebook in made for name, question in notebook.asked.items()}
    print(*counted(asked), sep="\n")
    if course.roster:
        print("After the deadline, students can open worked solutions with these codes:")
        print(*(f"  {notebook.name}: {notebook.code}" for notebook in made), sep="\n")


def _writable(page: str | Path) -> str | Path:
    """Return the path of a page if it can be written, so that an error comes before the work."""
    place = Path(page).absolute()
    there = next(path for path in (place, *place.parents) if path.exists())
    # An existing page must be a file, and a new one must be in a folder.
    if there.is_dir() == (there == place) or not os.access(there, os.W_OK):
        raise OSError(f"We cannot write the page {str(page)!r}. Give another path with --page.")
    return page


def publish(site: Path | None) -> None:
    from .publish import publish as make

    course = _course()
    page = make(course, site or course.archive.with_name("site"))
    print(f"The site: {page}")
    print(f"Look at it with: python -m http.server --directory {shlex.quote(str(page.parent))}")


def wheels(folder: Path) -> None:
    from .packing import DISTRIBUTIONS, wheel

    folder.mkdir(parents=True, exist_ok=True)
    print(*(wheel(name, folder) for name in DISTRIBUTIONS), sep="\n")


def trial(name: str, page: str | None) -> None:
    from .trial import trial as show

    course = _course()
    place = _writable(page or course.archive.with_name("try.html"))
    print(f"The page: {show(course, name, place)}")


def bank(out: Path, format: str, questions: Sequence[str]) -> None:
    from .bank import bank as write

    exported, left = write(_course(), out, format, questions)
    for line in left:
        print(line)
    print(
        f"We wrote {len(exported)} of {len(exported) + len(left)} questions to {out}, with "
        f"{sum(map(len, exported.values()))} variants in all."
    )
    print(f"{out} HOLDS ALL ANSWERS AND SOLUTIONS. It is for instructors only: never publish it.")


def selftest(only: Sequence[str], page: str | None, sources: Path | None) -> None:
    from .selftest import selftest as try_all

    course = _course(sources)
    place = _writable(page or course.archive.with_name("selftest.html"))
    faults = try_all(course, place, only)
    print(f"The page: {place}")
    if faults:
        sys.exit("\n".join(faults))
    print("Every question passed.")


COMMANDS: dict[str, Callable[..., None]] = {
    "new": new,
    "release": release,
    "publish": publish,
    "try": trial,
    "bank": bank,
    "selftest": selftest,
    "wheels": wheels,
}
