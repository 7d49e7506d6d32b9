"""Find the names that a failed cell was supposed to set.

After a cell has failed, each name that it was supposed to set still has its former value. A check
of that value would approve an answer that is no longer in the notebook, and the grader, who runs
the notebook from top to bottom, would disagree.
"""

import re
import sys

# The names that a line of code sets: a function, or names on the left of an equals sign. It is
# parsed as text, since a cell may have failed because it is not valid Python.
SETS = re.compile(r"^\s*(?:def\s+(\w+)|([\w\s,()]+?)(?::[^=\n]+)?\s*[-+*/@]?=(?!=))", re.M)
_failed: set[str] = set()
_running = [""]


def names_set_by(code: str) -> set[str]:
    """Return the names that a cell sets, as far as its lines begin with them.

    >>> sorted(names_set_by('a, b = 1, 2\\ndef area(side):\\n    return side**2\\nc =\\na == b'))
    ['a', 'area', 'b', 'c']
    """
    return {name for sets in SETS.findall(code) for name in re.findall(r"\w+", " ".join(sets))}


def begins(info: object) -> None:
    """Record that a cell begins: it may call a check of a value that it has just set."""
    _running[0] = getattr(info, "raw_cell", None) or ""
    _failed.difference_update(names_set_by(_running[0]))


def ends(result: object) -> None:
    """Record the names that a cell has not set, or only before an error."""
    if not getattr(result, "success", True):
        _failed.update(names_set_by(_running[0]))


def outdated() -> list[str]:
    """Return the names in the running cell whose own cell failed when it last ran."""
    return sorted(_failed.intersection(re.findall(r"\w+", _running[0])))


def watch() -> None:
    """Follow the cells of the kernel in which this runs, if there is one."""
    # Without a kernel there may be no IPython, or only a replacement.
    get_shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)
    shell = get_shell()
    if events := getattr(shell, "events", None):
        events.register("pre_run_cell", begins)
        events.register("post_run_cell", ends)
