"""Find the names whose value is no longer in the notebook.

After a cell has failed, each name that it was supposed to set still has its former value. So has a
name that a cell set before the student changed the cell. A check of that value would approve an
answer that is no longer in the notebook, and the grader, who runs the notebook from top to bottom,
would disagree.
"""

import re
import sys

from .points import spellings

# The names that a line of code sets: what follows a keyword, or names on the left of an equals
# sign. It is parsed as text, since a cell may have failed because it is not valid Python.
SETS = re.compile(
    r"\b(?:def|class|for|as|import)\s+(\w+)|(\w+)\s*:=|"
    r"(?:^|;)(?![^=\n]*\w\()((?:[\w \t)]|[,(]\n?)+?)(?::[^=\n]+)?\s*[-+*/@]?=(?!=)",
    re.M,
)
# Functions of ours, which are no answers: they remain right when a cell no longer imports them.
OURS = {"check", "hint", "progress", "student", "variant", "worked_solution"}
# What a check says in place of a verdict.
STOPPED = (
    "The cell that sets `{0}` stopped before its end when it last ran, so `{0}` may still have "
    "an earlier value. We checked nothing. Fix that cell, run it, and then run this check "
    "again."
)
CHANGED = (
    "The cell that set `{0}` no longer sets it, so `{0}` still has an earlier value. We checked "
    "nothing. Set `{0}` in that cell, run it, and then run this check again."
)
# What to add to errors whose words name neither the slip nor its remedy, by a pattern of these
# words and, on the lines below them, the cell's code. The last pattern needs no error: Python
# accepts `student = 'jdoe'`, which leaves the student with the numbers that earn nothing.
ADVICE = {
    r"\A.*(could_extract_minus_sign|FunctionClass)": (
        "A function of SymPy stands where an expression is needed: perhaps its parentheses are "
        "missing, as in `sm.cos*2`. Or has a cell run `from sympy import *`? It replaces the "
        "symbols `beta`, `gamma` and `zeta` by functions. Then remove that line, run the cell that "
        "creates the symbols, and run this cell again.\n"
    ),
    r"\A.*(Cannot convert expression to float|ufunc does not support .* type (?!Function))": (
        "Functions of `math` and NumPy take numbers only. For an expression with symbols, use "
        "those of SymPy, such as `sm.cos`, or substitute numbers for its symbols first.\n"
    ),
    r"^invalid (non-printable )?character": (
        "You have probably pasted this character. It may look like one of Python's, but is another "
        "one. Type it on the keyboard instead: `-`, `*`, a space, straight quotation marks.\n"
    ),
    r"(?sm)^name '(\w+)' is not defined.*\bstudent\(\s*\1\b"
    r"|^(leading zeros|invalid (syntax|decimal)).*\bstudent\(\s*\w|^\s*student\s*=\s*['\"]": (
        "Give your ID in parentheses and quotation marks, as in `student('jdoe')`. Then run this "
        "cell again.\n"
    ),
    r"(?sm)^'(str|bool|NoneType|Reply|Given)' object is not callable.*"
    r"\b(check|hint|student|variant)\(": (
        "A cell has set the name of this function to a value. Run the cell that imports the "
        "function again, and then this one. Use a different name for a value of your own.\n"
    ),
    # The error of an assertion has no words of its own.
    r"(?s)\A\n.*\bassert\s+check\(": (
        "The check did not pass. To see its reply, write `check(...)` without `assert` on the last "
        "line of the cell.\n"
    ),
}
# The message about each name whose value is an earlier one, and the cell that last set each name.
_outdated: dict[str, str] = {}
_setters: dict[str, str] = {}
_running = [""]


def names_set_by(code: str) -> set[str]:
    """Return the names that a cell sets, as far as its lines begin with them.

    >>> sorted(names_set_by('a, b = 1, 2\\ndef area(side):\\n    return side**2\\nc =\\na == b'))
    ['a', 'area', 'b', 'c']
    >>> sorted(names_set_by('from math import e, pi\\nangle = pi\\n# axis = 2\\nprint(e, end="")'))
    ['angle', 'e']
    """
    return {name for sets in SETS.findall(code) for name in re.findall(r"\w+", " ".join(sets))}


def begins(info: object) -> None:
    """Record that a cell begins: it may call a check of a value that it has just set."""
    _running[0] = getattr(info, "raw_cell", None) or ""
    names = names_set_by(_running[0])
    for name in names:
        _outdated.pop(name, None)
    # Not every program that runs notebooks says which cell it is.
    if cell := getattr(info, "cell_id", None):
        left = {name for name, setter in _setters.items() if setter == cell} - names
        _outdated.update(dict.fromkeys(left, CHANGED))
        _setters.update(dict.fromkeys(names, cell))


def ends(result: object) -> None:
    """Record the names that a cell has not set, or only before an error; add advice to errors."""
    # The cell that imports coursework had begun before there was anybody to record it.
    code = getattr(getattr(result, "info", None), "raw_cell", None) or _running[0]
    error = None
    if not getattr(result, "success", True):
        _outdated.update(dict.fromkeys(names_set_by(_running[0]), STOPPED))
        error = getattr(sys, "last_value", None)
    # JupyterLite shows an empty output even where nothing is printed.
    if advice := [text for words, text in ADVICE.items() if re.search(words, f"{error}\n{code}")]:
        print(*advice, end="")
    if type(error) is NameError and re.search(rf"(?s)\bcheck\(.*\b{error.name}\b", code):
        remedy = (
            f"No cell that you have run sets `{error.name}`. If it is spelled right, run the cell "
            "that sets it"
        )
        if _outdated.get(str(error.name)) == STOPPED:
            remedy = f"The cell that sets `{error.name}` stopped with an error. Correct and run it"
        print(f"{remedy}, and then run this check again.")


def outdated() -> list[str]:
    """Return what there is to say of names in the running cell whose value is an earlier one."""
    names = _outdated.keys() & set(re.findall(r"\w+", _running[0])) - OURS
    return [_outdated[name].format(name) for name in sorted(names)]


def overwritten(symbols: set[str]) -> list[str]:
    """Return what there is to say of symbols whose names now have a value without any symbol."""
    return [
        f"`{name}` is not a symbol now: a cell has set it to another value. Use a different name "
        "there, and run the cell that creates the symbols again."
        for name, value in vars(sys.modules["__main__"]).items()
        if symbols & {name, *spellings(name)} and not getattr(value, "free_symbols", None)
    ]


def watch() -> None:
    """Follow the cells of the kernel in which this runs, if there is one."""
    # Without a kernel there may be no IPython, or only a replacement.
    get_shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)
    if events := getattr(get_shell(), "events", None):
        events.register("pre_run_cell", begins)
        events.register("post_run_cell", ends)
