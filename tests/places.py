"""The paths of the book and its built site, and the tests' limits of waiting."""

import os
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parent.parent
HTML = REPOSITORY / "_build" / "html"
# Set where a missing browser must be an error (.ci/run sets it).
BROWSER_REQUIRED = os.environ.get("BOOK_BROWSER_REQUIRED") == "1"
PATIENCE = 180_000  # milliseconds, for a busy machine; nothing waits longer than it must


def html_pages():
    """Return the addresses of all pages of the built site, relative to its root.

    Notebooks in ``lite`` and the server's error page are left out.
    """
    paths = [path.relative_to(HTML) for path in HTML.rglob("*.html")]
    if not paths:
        raise FileNotFoundError(
            f"these tests look at the built book, which {HTML} does not hold: make book"
        )
    return sorted(str(path) for path in paths if path.parts[0] not in ("lite", "404.html"))


def every_day(cases, *chosen):
    """Return cases for a test of which only the chosen ones run by default.

    The others are much like them; `--every-case` runs them all.
    """
    if lost := set(chosen) - set(cases):
        raise ValueError(f"not among the cases: {lost}")
    return [
        case if case in chosen else pytest.param(case, marks=pytest.mark.further) for case in cases
    ]
