"""What the tests of pages share, where they are run by themselves: a
small book to be in, and a browser.
"""

import os
import shutil
from pathlib import Path

import pytest

PROJECT = Path(__file__).resolve().parents[1]


def pytest_configure(config):
    # Where these are tests of a larger project, that has a book, and a browser for all.
    if config.rootpath == PROJECT:
        places = [Path(os.environ.get("NOTEBOOK_PAGES_FETCHED", PROJECT)), PROJECT.parent]
        fetched = next(
            (place for place in places if (place / "node_modules" / "katex").is_dir()), None
        )
        if fetched is None:
            raise pytest.UsageError(
                f"The tools for pages are not in {places[0]}: run `python -m "
                "notebook_pages.set_up` in this folder."
            )
        os.environ["NOTEBOOK_PAGES_FETCHED"] = str(fetched)
        config.pluginmanager.import_plugin("own_browser")


def pytest_collection(session):
    # Programs for pages are in the folder of a book.
    if session.config.rootpath == PROJECT:
        os.chdir(PROJECT / "tests" / "small-book")


@pytest.fixture(scope="session")
def take_compiled_wheels():
    """``take_compiled_wheels(folder)``: a book there finds the wheels that the
    book around it has byte-compiled.

    That takes some twenty seconds for each book, and gives the same bytes. By
    themselves, these tests compile them.
    """

    def take(folder):
        from notebook_pages import paths

        for wheel in (paths.FETCHED / "_build" / "runtime").glob("*/*.whl"):
            place = folder / "_build" / "runtime" / wheel.parent.name
            place.mkdir(parents=True)
            shutil.copy(wheel, place)

    return take
