"""Where the book and its built site are, and what its tests wait for."""

import os
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parent.parent
HTML = REPOSITORY / "_build" / "html"
# Set where a missing browser must not pass unnoticed (.ci/run sets it).
BROWSER_REQUIRED = os.environ.get("BOOK_BROWSER_REQUIRED") == "1"
PATIENCE = 180_000  # milliseconds, for a busy machine; nothing waits longer than it must


def html_pages():
    """The addresses of all pages of the built site, relative to its root.

    Notebooks in ``lite`` are none, nor are the figures for other people's pages, nor what a server
    shows where there is no page.
    """
    found = [path.relative_to(HTML) for path in HTML.rglob("*.html")]
    if not found:
        raise FileNotFoundError(
            f"these tests look at the built book, which {HTML} does not hold: make book"
        )
    return sorted(str(path) for path in found if path.parts[0] not in ("lite", "embed", "404.html"))


def every_day(cases, *chosen):
    """Cases for a test of which those that are chosen run; the others are much like them, and
    only `--every-case` runs them.
    """
    if lost := set(chosen) - set(cases):
        raise ValueError(f"not among the cases: {lost}")
    return [
        case if case in chosen else pytest.param(case, marks=pytest.mark.further) for case in cases
    ]
