"""What the tests of coursework share: a plug-in of their own, and a browser where they are run by themselves."""

import os
import sys
from pathlib import Path

# A plug-in is found by what its distribution says of itself, here and in the processes that tests start.
PLUGIN = str(Path(__file__).parent / "plugin")
sys.path.append(PLUGIN)
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [os.environ.get("PYTHONPATH"), PLUGIN]))


def pytest_configure(config):
    # Where these are tests of a larger project, that has a browser for all.
    if config.rootpath == Path(__file__).resolve().parents[1]:
        config.pluginmanager.import_plugin("own_browser")
