"""What the tests of pages share, where they are run by themselves: a small book to be in, and a browser."""

import os
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[1]


def pytest_configure(config):
    # Where these are tests of a larger project, that has a book, and a browser for all.
    if config.rootpath == PROJECT:
        os.environ.setdefault("NOTEBOOK_PAGES_FETCHED", str(PROJECT.parent))
        config.pluginmanager.import_plugin("own_browser")


def pytest_collection(session):
    # Programs for pages are in the folder of a book.
    if session.config.rootpath == PROJECT:
        os.chdir(PROJECT / "tests" / "small-book")
