"""Check whether a build would make the same site again, so that there is nothing to do.

The sources are compared by their names, sizes and times, together with the installed packages and
the environment. For the site it suffices that all files are there, because nothing else writes into
it.
"""

import hashlib
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from .paths import BUILD, HTML, REPOSITORY

STAMP = BUILD / "built-from"
# Folders that no page depends on, besides those whose names begin with a dot.
NO_SOURCES = ("_build", "node_modules", "__pycache__", "tests")
# The set-up changes these files when it has installed something.
SET_UP = (".venv/ready-book", ".venv/runtime/ready", "node_modules/ready")


def sources(folder: Path) -> Iterator[Path]:
    """Iterate over all files that a book in a folder may be made from."""
    for place, folders, files in os.walk(folder):
        folders[:] = [name for name in folders if name[0] != "." and name not in NO_SOURCES]
        yield from (Path(place, name) for name in files)


def fingerprint(facts: list[str]) -> str:
    return hashlib.sha256("\n".join(sorted(facts)).encode("utf8", "surrogateescape")).hexdigest()


def of_sources() -> str:
    """Return a text that changes with the sources and the installed packages."""
    roots = dict.fromkeys((Path.cwd(), REPOSITORY))
    files = [path for root in roots for path in sources(root)]
    files += [path for root in roots for name in SET_UP if (path := root / name).is_file()]
    settings = [
        f"{name}={value}"
        for name, value in os.environ.items()
        if name.startswith(("BOOK_", "SOURCE_DATE_"))
    ]
    # The version of the students' package depends on the commit.
    commit = subprocess.run(
        ["git", "-C", REPOSITORY, "rev-parse", "HEAD"], capture_output=True, text=True
    )
    return fingerprint(
        [
            *(f"{path} {(about := path.stat()).st_size} {about.st_mtime_ns}" for path in files),
            *settings,
            sys.version,
            commit.stdout,
        ]
    )


def of_site() -> str:
    """Return a text that changes when a file of the site is missing."""
    return fingerprint(
        [f"{path} {path.stat().st_size}" for path in HTML.rglob("*") if path.is_file()]
    )


def is_unchanged(made_from: str) -> bool:
    """Check whether the sources and the site are those that `note` recorded last."""
    return STAMP.is_file() and STAMP.read_text("utf8") == made_from + of_site()


def note(made_from: str) -> None:
    """Record the sources of the complete site, as they were when the build began.

    Files saved during the build belong to the next one.
    """
    STAMP.write_text(made_from + of_site(), "utf8")
