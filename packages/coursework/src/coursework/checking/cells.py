"""Which names of a notebook a cell was to set that failed.

After a cell has failed, each name that it was to set still has its value from before. A check of
that value would call right what no longer stands in the notebook, and the grader, who runs the
notebook from top to bottom, would disagree.
"""

import re
import sys

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


def begins(info: object) -> None:
    """Note that a cell begins: it may call a check of what it has just set."""
    _running[0] = getattr(info, "raw_cell", None) or ""
    _failed.difference_update(names_set_by(_running[0]))


def ends(result: object) -> None:
    """Note which names a cell has not set, or only on the way to an error."""
    if not getattr(result, "success", True):
        _failed.update(names_set_by(_running[0]))


def outdated() -> list[str]:
    """The names in the running cell whose own cell failed when it last ran."""
    return sorted(_failed.intersection(re.findall(r"\w+", _running[0])))


def watch() -> None:
    """Follow the cells of the kernel in which this runs, if it is one."""
    # Without a kernel there may be no IPython, or only something in its place.
    get_shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)
    if events := getattr(get_shell(), "events", None):
        events.register("pre_run_cell", begins)
        events.register("post_run_cell", ends)
