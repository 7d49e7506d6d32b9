"""Report the processor time of each part of the suite, so that growth is noticed.

Every run ends with its most expensive parts. Processor time, unlike elapsed time, depends little on
other programs.
"""

import resource
from collections import Counter

import psutil
import pytest


def of_usage(usage):
    return usage.ru_utime + usage.ru_stime


# The last known processor time of each process of Chromium. Nobody waits for these when a page is
# closed, so the system adds them to no other process.
BROWSERS = {}


def processor_seconds():
    """Return the processor time of this process and all its descendants."""
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
            continue  # it has ended, and is counted by the process that waited for it
    return spent + sum(BROWSERS.values())


class Times:
    """Collect the times where the tests run, and show them where they are reported."""

    def __init__(self, config):
        self.config = config
        self.spent = Counter()  # by file
        self.part, self.start = None, 0

    def begin(self, part):
        """Attribute the time since the last change to the part that was running."""
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
            self.begin(None)  # when the browser ends, all its time is reported once more
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
