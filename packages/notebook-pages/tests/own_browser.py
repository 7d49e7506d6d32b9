"""A browser for the tests of pages, where they are run by themselves."""

import pytest


@pytest.fixture(scope="session")
def browser():
    """Headless Chromium; skipped with a reason where there is none."""
    from playwright.sync_api import sync_playwright

    from notebook_pages.browser import FLAGS, MISSING, find

    if find() is None:
        pytest.skip(MISSING)
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=find(), args=list(FLAGS))
        yield chromium
        chromium.close()
