"""Fixtures for the tests of coursework: a plug-in, loaded sandboxes, and a browser."""

import contextlib
import os
import sys
from pathlib import Path

import pytest

# A plug-in is found by its distribution's metadata, both here and in the processes that tests
# start.
PLUGIN = str(Path(__file__).parent / "plugin")
sys.path.append(PLUGIN)
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [os.environ.get("PYTHONPATH"), PLUGIN]))


def pytest_configure(config):
    # A larger project that contains these tests provides a browser for all of its tests.
    if config.rootpath == Path(__file__).resolve().parents[1]:
        config.pluginmanager.import_plugin("own_browser")


@pytest.fixture(scope="session")
def lent_sandboxes(tmp_path_factory):
    """Two sandboxes for all tests, each with the file that shows whether it is in use."""
    if not sys.platform.startswith("linux"):
        yield []
        return
    from coursework.grading.execution.sandbox import Sandbox

    places = [tmp_path_factory.mktemp("lent") / "in-use" for _ in range(2)]
    with contextlib.ExitStack() as stack:
        yield [(stack.enter_context(Sandbox()), place) for place in places]


@pytest.fixture(scope="module")
def libraries_are_loaded_once(lent_sandboxes):
    """Lend each test a sandbox that has loaded SymPy, which takes seconds.

    A sandbox that dies, or whose user does, is not lent again. Tests of the sandbox itself, or of
    how it starts, do not get one.
    """
    if not lent_sandboxes:
        yield
        return
    from coursework.grading.execution import isolation, sandbox

    class Lent(sandbox.Sandbox):
        place = None

        def __init__(self, limits=None, **options):
            for lent, place in lent_sandboxes:
                if any(options.values()) or isolation.lacking(lent.report):
                    break
                # Processes that grade in parallel take one each.
                with contextlib.suppress(FileExistsError):
                    place.touch(exist_ok=False)
                    self.__dict__.update(vars(lent), limits=limits or sandbox.Limits(), place=place)
                    return
            super().__init__(limits, **options)

        def __exit__(self, kind, *error):
            if self.place and kind is None:
                self.place.unlink()
            else:
                super().__exit__(kind, *error)

        def close(self):
            # Another process ends it.
            if self.place:
                self.place = self.control = self.process = self.errors = self.base = None
            super().close()

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(sandbox, "Sandbox", Lent)
        yield
