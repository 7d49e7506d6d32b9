"""The browser that prints the book and opens its pages in the tests.

``python -m notebook_pages.browser`` succeeds if there is one; otherwise it says how to get it.
"""

import shutil
import sys
from contextlib import contextmanager

# The first program is the same engine without windows, which opens a page with a third less work.
NAMES = (
    "chromium-headless-shell", "chromium", "chromium-browser", "google-chrome",
    "google-chrome-stable", "/Applications/Google "
    "Chrome.app/Contents/MacOS/Google Chrome", "/Applications/Chromium.app/Contents/MacOS/Chromium",
)  # fmt: skip
FLAGS = (
    # In containers everything runs as root.
    "--no-sandbox",
    # The other options keep the browser from contacting its maker.
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
)


MISSING = (
    "This machine has neither Chromium nor Chrome. "
    "Without one of them there is no PDF, and the tests that open the pages are skipped. "
    "On Debian: sudo apt install chromium; on Ubuntu: sudo snap install chromium; on a Mac and "
    "elsewhere: https://www.google.com/chrome/."
)


def find():
    """Return the path of Chromium or Chrome on this machine, or ``None``."""
    return next(filter(None, map(shutil.which, NAMES)), None)


@contextmanager
def open_browser():
    """Open headless Chromium, driven by Playwright."""
    from playwright.sync_api import sync_playwright

    if find() is None:
        sys.exit(MISSING)
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=find(), args=list(FLAGS))
        yield chromium
        chromium.close()


if __name__ == "__main__":
    sys.exit(MISSING if find() is None else 0)
