"""What each part of the suite costs: processor time by file, so that growth is seen.

Every run ends with its dearest parts. ``make times`` runs everything and writes the table of
``tests/TIMES.md``, to be committed. There the unit is what it takes to start Python and import
SymPy on the same machine, so that two tables can be compared although they come from two machines.
Processor time, unlike the clock's, changes little with what else runs.
"""

import resource
import subprocess
import sys
from collections import Counter
from pathlib import Path

import psutil
import pytest

TABLE = Path(__file__).with_name("TIMES.md")
HEAD = """# What the tests cost

Written by `make times`. The unit is the processor time that starting Python and importing SymPy
takes on the same machine, so that tables of different machines can be compared. `make test` leaves
out what is marked as long, and of what has many alike cases runs a few; `make test-all`, as every
night, runs everything.

| part | `make test` | `make test-all` | share of everything |
| --- | ---: | ---: | ---: |
"""


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


def unit():
    """The least of a few times that Python with SymPy takes."""
    times = []
    for _ in range(5):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([sys.executable, "-c", "import sympy"], check=True)
        times.append(of_usage(resource.getrusage(resource.RUSAGE_CHILDREN)) - of_usage(before))
    return min(times)


class Times:
    """Gathers the times where the tests run, and tells them where they are reported."""

    def __init__(self, config):
        self.config = config
        self.spent = Counter()  # by file, and whether long
        self.part, self.start = None, 0

    def begin(self, part):
        """Charge what was spent since the last change to the part that was running."""
        if part != self.part:
            now = processor_seconds()
            self.spent[self.part or ("starting and collecting", False)] += max(0, now - self.start)
            self.part, self.start = part, now

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_protocol(self, item):
        self.begin((item.nodeid.partition("::")[0], item.get_closest_marker("long") is not None))

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
            self.config.workeroutput["times"] = [
                [*part, spent] for part, spent in self.spent.items()
            ]

    @pytest.hookimpl(optionalhook=True)
    def pytest_testnodedown(self, node):
        for name, long, spent in getattr(node, "workeroutput", {}).get("times", []):
            self.spent[name, long] += spent

    def pytest_terminal_summary(self, terminalreporter):
        files = Counter()
        for (name, _), spent in self.spent.items():
            files[name] += spent
        terminalreporter.write_sep(
            "=", f"processor seconds: {sum(files.values()):.0f}; the dearest parts"
        )
        for name, spent in files.most_common(10):
            terminalreporter.write_line(f"{spent:6.1f}  {name}")
        if self.config.getoption("--write-times"):
            TABLE.write_text(self.table(files), "utf8")

    def table(self, files):
        one = unit()
        everything = sum(files.values())
        usual = {name: self.spent[name, False] / one for name in files}
        rows = [
            f"| {name} | {usual[name]:.0f} | {spent / one:.0f} | {spent / everything:.0%} |\n"
            for name, spent in files.most_common()
            if spent >= one
        ]
        total = f"| **together** | **{sum(usual.values()):.0f}** | **{everything / one:.0f}** | |\n"
        return HEAD + total + "".join(rows)
