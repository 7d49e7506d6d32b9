"""The browser that prints the book and opens its pages in the tests.

``python -m website.browser`` succeeds where there is one.
"""

import shutil
import sys
from contextlib import contextmanager

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
FLAGS = (
    "--no-sandbox",  # for containers, where everything runs as root
    # The others keep the browser from talking to its maker.
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
)


def find():
    """The path of Chromium or Chrome on this machine, or ``None``."""
    return next(filter(None, map(shutil.which, NAMES)), None)


@contextmanager
def open_browser():
    """Headless Chromium, driven by Playwright."""
    from playwright.sync_api import sync_playwright

    if find() is None:
        sys.exit(
            "The book is printed by Chromium or Chrome, and neither is on this machine. "
            "Install one (on Debian and Ubuntu: apt install chromium) and run this again."
        )
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=find(), args=list(FLAGS))
        yield chromium
        chromium.close()


if __name__ == "__main__":
    sys.exit(find() is None)
