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


# Two sandboxes for all tests, each with the file that shows whether it is in use.
LENT = []


@pytest.fixture(scope="session")
def lent_sandboxes(tmp_path_factory):
    if sys.platform.startswith("linux"):
        from coursework.grading.execution.sandbox import Sandbox

        LENT.extend((Sandbox(), tmp_path_factory.mktemp("lent") / "in-use") for _ in range(2))
    yield LENT
    for sandbox, _ in LENT:
        sandbox.close()


@pytest.fixture(autouse=True)
def lost_sandboxes_are_replaced():
    """Otherwise each later test would start a sandbox in place of one that died in use."""
    yield
    for number, (lost, place) in enumerate(LENT):
        if place.exists():
            lost.close()
            place.unlink()
            LENT[number] = type(lost)(), place


@pytest.fixture(scope="module")
def libraries_are_loaded_once(lent_sandboxes):
    """Lend each test a sandbox that has loaded SymPy, which takes seconds.

    A sandbox that dies, or whose user does, is not lent again. Tests of the sandbox itself, or of
    how it starts, do not get one.
    """
    if not LENT:
        yield
        return
    from coursework.grading.execution import isolation, sandbox

    class Lent(sandbox.Sandbox):
        place = None

        def __init__(self, limits=None, **options):
            for lent, place in LENT:
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
