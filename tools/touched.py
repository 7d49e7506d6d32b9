"""Print which tests cover the files that have changed: ``make quick`` runs them.

The map of the software in CONTRIBUTING.md says which tests belong to which folder.
"""

import re
import subprocess
import sys
from pathlib import Path

ROW = re.compile(r"^\| (`[^|]*/[^|]*) \|[^|]*\| (`[^|]*) \|$", re.M)


def tests_by_folder():
    """Return the folders of the map, each with the places of its tests."""
    rows = ROW.findall(Path("CONTRIBUTING.md").read_text("utf8"))
    code = re.compile("`([^`]+)`")
    return {folder: code.findall(tests) for cell, tests in rows for folder in code.findall(cell)}


def tests_of(path, by_folder):
    """Return the places of the tests of a changed file; a notebook is also a test itself."""
    if Path(path).name.startswith("test_"):
        return [path]
    tests = next((tests for folder, tests in by_folder.items() if path.startswith(folder)), [])
    return [path, *tests] if path.startswith(("chapters/", "exercises/")) else tests


def main(base):
    changed = ["git", "diff", "--name-only", "--diff-filter=d", "--merge-base", base]
    new = ["git", "ls-files", "--others", "--exclude-standard"]
    paths = [subprocess.check_output(command, text=True).splitlines() for command in (changed, new)]
    tests = {"tests/test_style.py": None, "tests/test_budget.py": None}
    by_folder = tests_by_folder()
    for path in sum(paths, []):
        tests |= dict.fromkeys(tests_of(path, by_folder))
    print(*tests)


if __name__ == "__main__":
    main(*sys.argv[1:])
