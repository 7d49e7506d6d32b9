"""What each part of the suite costs: processor time by file, so that growth is seen.

Every run ends with its dearest parts. Processor time, unlike the clock's,
changes little with what else runs.
"""

import resource
from collections import Counter

import psutil
import pytest


def of_usage(usage):
    return usage.ru_utime + usage.ru_stime


# What each process of Chromium was last seen to have spent. Nobody waits for these when a page is
# closed, so the system adds them to nobody's account.
BROWSERS = {}


def processor_seconds():
    """The processor time of this process, of all that it started, and of all that those started."""
    spent = of_usage(resource.getrusage(resource.RUSAGE_SELF)) + of_usage(
        resource.getrusage(resource.RUSAGE_CHILDREN)
    )
    for process in psutil.Process().children(recursive=True):
        try:
            times = process.cpu_times()
            if process.name().startswith("chrom"):
                BROWSERS[process.pid, process.create_time()] = sum(times[:2])
            else:
                spent += sum(times[:4])
        except psutil.Error:
            continue  # it has ended, and is counted by the one who waited for it
    return spent + sum(BROWSERS.values())


class Times:
    """Gathers the times where the tests run, and tells them where they are reported."""

    def __init__(self, config):
        self.config = config
        self.spent = Counter()  # by file
        self.part, self.start = None, 0

    def begin(self, part):
        """Charge what was spent since the last change to the part that was running."""
        if part != self.part:
            now = processor_seconds()
            self.spent[self.part or "starting and collecting"] += max(0, now - self.start)
            self.part, self.start = part, now

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_protocol(self, item):
        self.begin(item.nodeid.partition("::")[0])

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_teardown(self, item, nextitem):
        if nextitem is None:
            self.begin(None)  # when the browser ends, all that it has spent is told once more
        elif "browser" in getattr(item, "fixturenames", ()):
            processor_seconds()  # before the pages are closed

    @pytest.hookimpl(tryfirst=True)
    def pytest_sessionfinish(self):
        if self.part:
            self.begin(None)
        if hasattr(self.config, "workeroutput"):
            self.config.workeroutput["times"] = dict(self.spent)

    @pytest.hookimpl(optionalhook=True)
    def pytest_testnodedown(self, node):
        self.spent.update(getattr(node, "workeroutput", {}).get("times", {}))

    def pytest_terminal_summary(self, terminalreporter):
        spent = sum(self.spent.values())
        terminalreporter.write_sep("=", f"processor seconds: {spent:.0f}; the dearest parts")
        for name, spent in self.spent.most_common(10):
            terminalreporter.write_line(f"{spent:6.1f}  {name}")
