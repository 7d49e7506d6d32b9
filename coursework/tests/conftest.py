"""What the tests of coursework share: a plug-in of their own, and a browser where they are run by themselves."""

import os
import sys
from pathlib import Path

import pytest

# A plug-in is found by what its distribution says of itself, here and in the processes that tests start.
PLUGIN = str(Path(__file__).parent / "plugin")
sys.path.append(PLUGIN)
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [os.environ.get("PYTHONPATH"), PLUGIN]))


@pytest.fixture(scope="session")
def browser():
    """Headless Chromium; skipped with a reason where there is none."""
    import shutil

    from playwright.sync_api import sync_playwright

    names = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
    found = next(filter(None, map(shutil.which, names)), None)
    if found is None:
        reason = "there is no Chromium here"
        pytest.fail(reason) if os.environ.get("BOOK_BROWSER_REQUIRED") == "1" else pytest.skip(reason)
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=found, args=["--no-sandbox"])
        yield chromium
        chromium.close()
