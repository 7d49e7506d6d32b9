"""Each package stays within its line in the table of CONTRIBUTING.md."""

import ast
import re
import subprocess
from collections import Counter
from functools import cache

import pytest
from places import REPOSITORY

#: A folder of CONTRIBUTING's table, and the numbers in its line: statements, those of tests, and
#: lines of JavaScript.
ROW = re.compile(r"^\| `([^`]+)` \| ([\d,]+) \| ([\d,]+) \| ([\d,]+) \|", re.M)
ROWS = ROW.findall((REPOSITORY / "CONTRIBUTING.md").read_text("utf8"))
ALLOWED = {
    folder: tuple(int(number.replace(",", "")) for number in numbers) for folder, *numbers in ROWS
}


def statements(text):
    """Count the statements of a module, without docstrings and comments."""
    nodes = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.stmt)]
    return sum(
        not (isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)) for node in nodes
    )


@cache
def counted():
    """Return the content of each folder of the table."""
    named = subprocess.check_output(["git", "ls-files", "-z"], cwd=REPOSITORY, text=True).split(
        "\0"
    )
    counts = {folder: Counter() for folder in ALLOWED}
    for name in filter(None, named):
        folder = next((folder for folder in ALLOWED if name.startswith(folder + "/")), None)
        if folder is None or not (REPOSITORY / name).is_file():
            continue
        if name.endswith(".py"):
            parts = name.split("/")
            tests = {"tests", "examples"} & set(parts) or parts[-1].startswith(
                ("test_", "conftest")
            )
            counts[folder]["tests" if tests else "statements"] += statements(
                (REPOSITORY / name).read_text("utf8")
            )
        elif name.endswith((".js", ".mjs")):
            counts[folder]["lines"] += (REPOSITORY / name).read_text("utf8").count("\n")
    return counts


@pytest.mark.parametrize("folder", ALLOWED)
def test_a_package_keeps_to_its_budget(folder):
    held = tuple(counted()[folder][kind] for kind in ("statements", "tests", "lines"))
    assert all(number <= most for number, most in zip(held, ALLOWED[folder])), (
        f"{folder} holds {held} (statements, statements of tests, lines of JavaScript), where "
        f"CONTRIBUTING.md allows {ALLOWED[folder]}: take something out, or raise the line there, "
        "say why in it, and lower another"
    )


def test_every_package_has_one_budget():
    packages = {f"packages/{path.name}" for path in (REPOSITORY / "packages").iterdir()}
    assert sorted(packages | {"src/orientation", "tests", "tools"}) == sorted(
        folder for folder, *_ in ROWS
    )
