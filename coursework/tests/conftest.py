"""What the tests of coursework share: a plug-in of their own, and a browser where they are run by themselves."""

import os
import sys
from pathlib import Path

import pytest

# A plug-in is found by what its distribution says of itself, here and in the processes that tests start.
PLUGIN = str(Path(__file__).parent / "plugin")
sys.path.append(PLUGIN)
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [os.environ.get("PYTHONPATH"), PLUGIN]))


class Browser:
    """Headless Chromium; skipped with a reason where there is none."""

    @pytest.fixture(scope="session")
    def browser(self):
        import shutil

        from playwright.sync_api import sync_playwright

        names = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
        found = next(filter(None, map(shutil.which, names)), None)
        if found is None:
            pytest.skip("there is no Chromium here")
        with sync_playwright() as playwright:
            chromium = playwright.chromium.launch(executable_path=found, args=["--no-sandbox"])
            yield chromium
            chromium.close()


def pytest_configure(config):
    # Where these are tests of a larger project, that has a browser for all.
    if config.rootpath == Path(__file__).parents[1]:
        config.pluginmanager.register(Browser())
