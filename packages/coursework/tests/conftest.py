"""What the tests of coursework share: a plug-in of their own, a process that has loaded what
students' code imports, and a browser where they are run by themselves.
"""

import contextlib
import os
import sys
from pathlib import Path

import pytest

# A plug-in is found by what its distribution says of itself, here and
# in the processes that tests start.
PLUGIN = str(Path(__file__).parent / "plugin")
sys.path.append(PLUGIN)
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [os.environ.get("PYTHONPATH"), PLUGIN]))


def pytest_configure(config):
    # Where these are tests of a larger project, that has a browser for all.
    if config.rootpath == Path(__file__).resolve().parents[1]:
        config.pluginmanager.import_plugin("own_browser")


@pytest.fixture(scope="session")
def lent_sandboxes(tmp_path_factory):
    """Two sandboxes for all tests, each with the file that says whether it is in use."""
    if not sys.platform.startswith("linux"):
        yield []
        return
    from coursework.grading.execution.sandbox import Sandbox

    places = [tmp_path_factory.mktemp("lent") / "in-use" for _ in range(2)]
    with contextlib.ExitStack() as stack:
        yield [(stack.enter_context(Sandbox()), place) for place in places]


@pytest.fixture(scope="module")
def libraries_are_loaded_once(lent_sandboxes):
    """Whoever grades a class loads SymPy for it, which takes seconds; here two processes have, for
    all tests. One that dies, or whose user does, is not lent again.

    Not for tests of the sandbox itself, or of how it is started.
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
                # Processes that grade side by side take one each.
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
            if self.place:  # it is another process that ends it
                self.place = self.control = self.process = self.errors = self.base = None
            super().close()

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(sandbox, "Sandbox", Lent)
        yield
