"""Which names of a notebook a cell was to set that failed.

After a cell has failed, each name that it was to set still has its value from before. A check of
that value would call right what no longer stands in the notebook, and the grader, who runs the
notebook from top to bottom, would disagree.
"""

import re
import sys
from typing import Any

#: What a line of code sets: a function, or names on the left of an equals sign. It is
#: read by its words, since a cell may have failed because it is no Python.
SETS = re.compile(r"^\s*(?:def\s+(\w+)|([\w\s,()]+?)(?::[^=\n]+)?\s*[-+*/@]?=(?!=))", re.M)
_failed: set[str] = set()
_running = [""]


def names_set_by(code: str) -> set[str]:
    """The names that a cell sets, as far as its lines begin with them.

    >>> sorted(names_set_by('a, b = 1, 2\\ndef area(side):\\n    return side**2\\nc =\\na == b'))
    ['a', 'area', 'b', 'c']
    """
    return {name for sets in SETS.findall(code) for name in re.findall(r"\w+", " ".join(sets))}


def begins(info: Any) -> None:
    """Note that a cell begins: it may call a check of what it has just set."""
    _running[0] = info.raw_cell or ""
    _failed.difference_update(names_set_by(_running[0]))


def ends(result: Any) -> None:
    """Note which names a cell has not set, or only on the way to an error."""
    if not result.success:
        _failed.update(names_set_by(_running[0]))


def outdated() -> list[str]:
    """The names in the running cell whose own cell failed when it last ran."""
    return sorted(_failed.intersection(re.findall(r"\w+", _running[0])))


def watch() -> None:
    """Follow the cells of the kernel in which this runs, if it is one."""
    shell: Any = sys.modules["IPython"].get_ipython() if "IPython" in sys.modules else None
    if hasattr(shell, "events"):
        shell.events.register("pre_run_cell", begins)
        shell.events.register("post_run_cell", ends)
