"""Whether a built site is what a build would make again: then there is nothing to do.

The sources are told by their names, sizes and times; so is what is installed, and what the
environment says. Of the site it is enough that all files are there: nobody else writes into it.
"""

import hashlib
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from .paths import BUILD, HTML, REPOSITORY

STAMP = BUILD / "built-from"
#: Folders that no page depends on, besides those whose names begin with a dot.
NO_SOURCES = ("_build", "node_modules", "__pycache__", "tests")
#: The set-up changes these when it has set up something else.
SET_UP = (".venv/ready-book", ".venv/runtime/ready", "node_modules/ready")


def sources(folder: Path) -> Iterator[Path]:
    """All files that a book in a folder may be made from."""
    for place, folders, files in os.walk(folder):
        folders[:] = [name for name in folders if name[0] != "." and name not in NO_SOURCES]
        yield from (Path(place, name) for name in files)


def fingerprint(said: list[str]) -> str:
    return hashlib.sha256("\n".join(sorted(said)).encode("utf8", "surrogateescape")).hexdigest()


def of_sources() -> str:
    """A text that changes with the sources, and with what is installed."""
    roots = dict.fromkeys((Path.cwd(), REPOSITORY))
    files = [path for root in roots for path in sources(root)]
    files += [path for root in roots for name in SET_UP if (path := root / name).is_file()]
    said = [
        f"{path} {about.st_size} {about.st_mtime_ns}" for path in files for about in (path.stat(),)
    ]
    said += [
        f"{name}={value}"
        for name, value in os.environ.items()
        if name.startswith(("BOOK_", "SOURCE_DATE_"))
    ]
    commit = subprocess.run(
        ["git", "-C", REPOSITORY, "rev-parse", "HEAD"], capture_output=True, text=True
    )
    # The version of the students' package depends on the commit.
    said += [sys.version, commit.stdout]
    return fingerprint(said)


def of_site() -> str:
    """A text that changes when a file of the site has gone."""
    return fingerprint(
        [f"{path} {path.stat().st_size}" for path in HTML.rglob("*") if path.is_file()]
    )


def is_unchanged(made_from: str) -> bool:
    """Whether these sources, and the site, are those that :func:`note` was told of last."""
    return STAMP.is_file() and STAMP.read_text("utf8") == made_from + of_site()


def note(made_from: str) -> None:
    """Write down what the site was made from, now that it is whole: the sources as they were when
    the build began. What is saved meanwhile is for the next one.
    """
    STAMP.write_text(made_from + of_site(), "utf8")
