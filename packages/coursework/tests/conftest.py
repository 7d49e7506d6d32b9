"""What the tests of coursework share: a plug-in of their own, a process that has loaded what
students' code imports, and a browser where they are run by themselves.
"""

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
def warm_parent():
    """The sandbox that those of all tests are copied from; made when the first is wanted."""
    kept = []
    yield kept
    for sandbox in kept:
        sandbox.close()


@pytest.fixture(scope="module")
def libraries_are_loaded_once(warm_parent):
    """Whoever grades a class loads SymPy for it, which takes a second; here one
    process has, for those of all tests.

    Not for tests of the sandbox itself, or of how it is started.
    """
    if not sys.platform.startswith("linux"):
        yield
        return
    from coursework.grading.execution import sandbox

    class Copied(sandbox.Sandbox):
        def __init__(self, limits=None, *, like=None, **options):
            if not any(options.values()):
                if not warm_parent:
                    warm_parent.append(by_itself())
                like = warm_parent[0]
            super().__init__(limits, like=like, **options)

    by_itself = sandbox.Sandbox
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(sandbox, "Sandbox", Copied)
        yield
