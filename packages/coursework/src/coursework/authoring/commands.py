"""The commands of authors: ``coursework new``, ``release``, ``publish``, ``try``, ``ask``,
``selftest`` and ``wheels``.
"""

from __future__ import annotations

import argparse
import shlex
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .course import Course


def add_commands(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add these commands to those of ``coursework``."""
    new = commands.add_parser("new", help="make a small course that works at once")
    new.add_argument(
        "course", metavar="COURSE", help="the folder to make; its name becomes that of the course"
    )
    release = commands.add_parser(
        "release", help="make the exercises, the sealed questions and the archive for students"
    )
    release.add_argument(
        "only", nargs="*", metavar="NOTEBOOK", help="the notebooks to make, by name (default: all)"
    )
    for name, says in (
        ("sources", "folder of the notebooks with solutions"),
        ("exercises", "where the exercise notebooks go"),
        ("sealed", "where the sealed questions go"),
    ):
        release.add_argument(f"--{name}", type=Path, help=f"{says} (default: as course.toml says)")
    release.add_argument(
        "--no-archive", action="store_true", help="do not make the archive for students"
    )
    publish = commands.add_parser(
        "publish", help="make a site: the exercises as pages that check themselves"
    )
    publish.add_argument(
        "--site", type=Path, help="the folder to make (default: site beside the archive)"
    )
    publish.add_argument(
        "--room",
        action="store_true",
        help="also fetch all packages that are needed, for a room without a network",
    )
    trial = commands.add_parser(
        "try", help="show a question as students will meet it, with every reply"
    )
    trial.add_argument(
        "name",
        metavar="NOTEBOOK/QUESTION",
        help="a question, or a notebook for all of its questions",
    )
    ask = commands.add_parser(
        "ask", help="print a notebook's questions as text, for a language model to answer"
    )
    ask.add_argument("notebook", type=Path, metavar="NOTEBOOK.ipynb")
    ask.add_argument("--answers", type=Path, metavar="REPLY", help="its reply, to be read back in")
    ask.add_argument(
        "--to", type=Path, metavar="FILE.ipynb", help="where the answered notebook goes"
    )
    wheels = commands.add_parser(
        "wheels", help="write the packages of coursework, to be installed elsewhere"
    )
    wheels.add_argument("folder", type=Path, metavar="FOLDER", help="where they go")
    selftest = commands.add_parser(
        "selftest", help="try every question as students will, and look for leaks"
    )
    selftest.add_argument(
        "only", nargs="*", metavar="NOTEBOOK", help="the notebooks to try, by name (default: all)"
    )
    selftest.add_argument(
        "--sources",
        type=Path,
        help="folder of the notebooks with solutions (default: as course.toml says)",
    )
    for parser, page in ((trial, "try"), (selftest, "selftest")):
        parser.add_argument(
            "--page", help=f"where the page goes (default: {page}.html beside the archive)"
        )


def _course(
    sources: Path | None = None, exercises: Path | None = None, sealed: Path | None = None
) -> Course:
    from .course import find_course

    course = find_course()
    return course._replace(
        sources=sources.resolve() if sources else course.sources,
        exercises=exercises.resolve() if exercises else course.exercises,
        sealed=sealed.resolve() if sealed else course.sealed,
    )


def new(course: str) -> None:
    from .new import new as make

    print(*make(course), sep="\n")


def release(
    only: Sequence[str],
    no_archive: bool,
    sources: Path | None,
    exercises: Path | None,
    sealed: Path | None,
) -> None:
    from .closed import counted
    from .packing import archive
    from .release import release as make

    course = _course(sources, exercises, sealed)
    names = make(course, only)
    print(f"{len(names)} {'notebook' if len(names) == 1 else 'notebooks'} released.")
    if not no_archive:
        print(f"For students: {archive(course)}")
    print(*counted(course, names), sep="\n")


def publish(site: Path | None, room: bool) -> None:
    from .publish import publish as make

    course = _course()
    page = make(course, site or course.archive.with_name("site"), room)
    print(f"The site: {page}")
    print(f"To look at it: python -m http.server --directory {shlex.quote(str(page.parent))}")


def wheels(folder: Path) -> None:
    from .packing import DISTRIBUTIONS, wheel

    folder.mkdir(parents=True, exist_ok=True)
    print(*(wheel(name, folder) for name in DISTRIBUTIONS), sep="\n")


def _writable(page: str | Path) -> str | Path:
    """The path of a page that is to be written; that it cannot be
    is said before the work is done.
    """
    from .author import AuthorError

    try:
        Path(page).parent.mkdir(parents=True, exist_ok=True)
        new = not Path(page).exists()
        open(page, "a").close()
        if new:
            Path(page).unlink()
    except OSError as error:
        raise AuthorError(
            f"{page} cannot be written ({error.strerror}). Say where the page may go: --page"
        ) from None
    return page


def trial(name: str, page: str | None) -> None:
    from .trial import trial as show

    course = _course()
    print(
        f"The page: {show(course, name, _writable(page or course.archive.with_name('try.html')))}"
    )


def ask(notebook: Path, answers: Path | None, to: Path | None) -> None:
    from .asking import as_text, with_answers
    from .author import AuthorError

    if (answers is None) != (to is None):
        raise AuthorError("to read a reply back in, give both --answers and --to")
    if answers is None or to is None:
        print(as_text(notebook))
        return
    try:
        reply = answers.read_text("utf8")
    except OSError as error:
        raise AuthorError(f"{answers} cannot be read: {error.strerror}") from None
    print(
        f"{to} answers {', '.join(with_answers(notebook, reply, to))}. `coursework grade` marks it."
    )


def selftest(only: Sequence[str], page: str | None, sources: Path | None) -> None:
    from .selftest import selftest as try_all

    course = _course(sources)
    place = _writable(page or course.archive.with_name("selftest.html"))
    faults = try_all(course, place, only)
    print(f"The page: {place}")
    if faults:
        sys.exit("\n".join(faults))
    print("Every question passed.")


def _told(command: str, run: Callable[..., None]) -> Callable[..., None]:
    def told(**options: object) -> None:
        from .author import AuthorError

        try:
            run(**options)
        except AuthorError as error:
            sys.exit(f"coursework {command}: {error}")

    return told


RUNS: dict[str, Callable[..., None]] = {
    "new": new,
    "release": release,
    "publish": publish,
    "try": trial,
    "ask": ask,
    "selftest": selftest,
    "wheels": wheels,
}
COMMANDS = {name: _told(name, run) for name, run in RUNS.items()}
