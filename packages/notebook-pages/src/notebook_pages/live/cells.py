"""Determine which cells of the book run in the page, by running them as the page does.

Every notebook is run once, from top to bottom, by the page's own Python program
(``python/session.py``), which can import only the standard library, SymPy and our own packages.
Plain Python replaces NumPy where it can (``python/plain_numpy.py``). A cell that then fails, or
gives another result than the stored one, needs more: the package that it failed to import, or one
that an earlier cell failed to import and from which it takes a name.
"""

import ast
import json
import re
import shutil
import subprocess
import symtable
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path

from ..execution import STORED
from ..moves import moves
from ..paths import PACKAGES, REPOSITORY, fingerprint
from ..used import fingerprint_of_used, names_imported, notebook_of, parse

PYTHON = Path(__file__).parent / "python"
PRETTY = Path(find_spec("IPython").submodule_search_locations[0], "lib", "pretty.py")
RESULTS = REPOSITORY / "_build" / "runtime"
# MyST-NB's tags for cells whose code is not shown.
HIDDEN = {"remove-cell", "remove-input", "remove_cell", "remove_input"}
ALONE = """
import asyncio, json, sys
from importlib import metadata

sys.path.insert(0, sys.argv[1])
import session


class OnlyThese(dict):
    def __contains__(self, name):
        return name not in sys.stdlib_module_names and name not in self.allowed

    def __getitem__(self, name):
        return f"No module named {name!r}"


messages = []
shell = session.start(lambda text: messages.append(json.loads(text)))
OnlyThese.allowed = {"sympy", "mpmath", "IPython", "session", "plain_numpy", "__main__"}
OnlyThese.allowed.update(sys.argv[2:])
shell.lack({} if "everything" in sys.argv else OnlyThese())
# Nor is anything installed in the page that others bring for it by an entry point.
every = metadata.entry_points
metadata.entry_points = lambda **wanted: metadata.EntryPoints(
    [one for one in every(**wanted) if one.module.partition(".")[0] in OnlyThese.allowed]
)
told = []
for number, code in enumerate(json.load(sys.stdin)):
    outcome = json.loads(asyncio.run(shell.run(code, f"cell {number + 1}")))
    told.append({"outcome": outcome, "messages": messages[:]})
    messages.clear()
json.dump(told, sys.__stdout__)
"""


def write_python(folder):
    """Write the files that the page's Python starts from: ours, and IPython's printer of values."""
    shutil.copytree(
        PYTHON, folder, ignore=shutil.ignore_patterns("__pycache__"), dirs_exist_ok=True
    )
    (folder / "IPython" / "lib").mkdir(exist_ok=True)
    (folder / "IPython" / "lib" / "__init__.py").touch()
    shutil.copyfile(PRETTY, folder / "IPython" / "lib" / "pretty.py")


def run_alone(codes, *more):
    """Run the cells of a page one after another and return what they display.

    NumPy is missing, unless ``more`` is ``"everything"``.
    """
    with tempfile.TemporaryDirectory() as folder:
        write_python(Path(folder, "python"))
        done = subprocess.run(
            [sys.executable, "-c", ALONE, "python", *PACKAGES, *more],
            cwd=folder, input=json.dumps(codes), capture_output=True, text=True, check=True,
        )  # fmt: skip
    return json.loads(done.stdout)


def outputs_of_messages(messages):
    """Return what a cell displayed as a comparable list: printed text, and each value's form."""
    outputs = []
    for message in messages:
        if message["type"] == "stream" and outputs and outputs[-1][0] == message["name"]:
            outputs[-1] = (message["name"], outputs[-1][1] + message["text"])
        elif message["type"] == "stream":
            outputs.append((message["name"], message["text"]))
        elif message["type"] == "clear":
            outputs.clear()
        else:
            outputs.append(shown_form(message["data"]))
    return outputs


def stored_outputs(cell):
    """Return the same list for the outputs that a notebook stores."""
    return [
        (output.name, output.text) if output.output_type == "stream" else shown_form(output.data)
        for output in cell.outputs
    ]


def shown_form(data):
    """Return the form that a page shows and its text, without parts that differ between runs."""
    form = next(
        form
        for form in ("text/html", "image/svg+xml", "text/markdown", "text/latex", "text/plain")
        if form in data
    )
    return form, re.sub(r"0x[0-9a-f]+", "0x...", data[form])


def alike(outputs, stored):
    """Check whether two lists of outputs are equal up to rounding in the last digits of numbers."""
    return [form for form, _ in outputs] == [form for form, _ in stored] and not any(
        move.too_far
        for (_, now), (_, before) in zip(outputs, stored)
        for move in moves(before, now)
    )


def names_bound(code):
    """Return the names that a cell assigns at its top level."""
    symbols = symtable.symtable(code, "cell", "exec").get_symbols()
    return {symbol.get_name() for symbol in symbols if symbol.is_assigned() or symbol.is_imported()}


def imports_numpy(code):
    """Check whether a cell imports NumPy itself."""
    return any(name.partition(".")[0] == "numpy" for name in names_imported(code))


def names_taken(code):
    """Return the names that a cell may take from earlier ones, which it does not import."""
    tree = parse(code)
    imported = {
        alias.asname or alias.name.partition(".")[0]
        for node in tree.body
        if isinstance(node, (ast.Import, ast.ImportFrom))
        for alias in node.names
    }
    return {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)} - imported


def needs_of_names(names, codes, kinds):
    """Return the needs of the cells, of ``codes`` and ``kinds``, that last assigned ``names``."""
    needs = set()
    for code, kind in zip(reversed(codes), reversed(kinds)):
        bound = names_bound(code)
        if names & bound:
            needs |= set(kind["needs"])
        names = names - bound
    return needs


def classify(cells):
    """Determine each code cell's needs beyond SymPy, whether a run may skip it, and its name.

    Also determine whether it imports ``numpy`` itself, which plain Python may replace in the page
    and which a notebook's kernel then fetches.

    A run skips a cell that only draws a figure, needs more for it, and gives names only to other
    such cells, because its picture is already there. A result that differs from the stored one
    without such a reason is an error.
    """
    codes = [cell.source for cell in cells]
    kinds = []
    for position, (cell, report) in enumerate(zip(cells, run_alone(codes))):
        outcome = report["outcome"]
        # A cell that never ran has no stored result to compare with, so accept its result here.
        known = cell.execution_count is not None
        same = outcome["status"] == "ok" and (
            not known or alike(outputs_of_messages(report["messages"]), stored_outputs(cell))
        )
        needs = set()
        if not same:
            needs = needs_of_names(names_taken(cell.source), codes[:position], kinds)
            if outcome["status"] == "missing":
                needs.add(outcome["package"])
            if outcome.get("plain"):
                # The result of plain Python differs from the book's in the last digit.
                needs.add("numpy")
            if not needs and known:
                raise RuntimeError(
                    f"in the page, cell {position + 1} gives a result that differs from the stored "
                    "one (if the stored one is out of date, run `make "
                    f"notebooks`):\n{cell.source}\n{outcome.get('traceback', report['messages'])}"
                )
        tags = cell.metadata.get("tags", [])
        kinds.append(
            {
                "needs": sorted(needs), "figure": "hide-input" in tags,
                "shown": not HIDDEN & set(tags), "code": cell.source,
                "name": cell.metadata.get("nbgrader", {}).get("grade_id"),
                "numpy": imports_numpy(cell.source),
            }
        )  # fmt: skip
    # The names that the cells below use, without the cells that are skipped.
    used_below = set()
    for code, kind in zip(reversed(codes), reversed(kinds)):
        kind["skip"] = bool(kind["figure"] and kind["needs"] and not names_bound(code) & used_below)
        if not kind["skip"]:
            used_below = (used_below - names_bound(code)) | names_taken(code)
    return kinds


def kept_name(path, notebook):
    """Return the file name for the kinds of a notebook's cells: a hash of all they depend on.

    The prose of the notebook does not matter.
    """
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    seen = [
        [cell.source, cell.outputs, cell.metadata.get("tags", []), cell.execution_count is None]
        for cell in cells
    ]
    program = fingerprint(Path(__file__), PYTHON)
    inputs = json.dumps([program, fingerprint_of_used(notebook), seen], sort_keys=True)
    return f"cells-{path.stem}-{sha256(inputs.encode()).hexdigest()[:12]}.json"


def kinds_of(path):
    """Return the kinds of the code cells of a notebook, from the cache if they are there."""
    notebook = notebook_of(path)
    cache_file = RESULTS / path.parent.name / kept_name(path, notebook)
    if not cache_file.exists():
        try:
            kinds = classify([cell for cell in notebook.cells if cell.cell_type == "code"])
        except RuntimeError as error:
            raise RuntimeError(f"{path}: {error}") from None
        for outdated in cache_file.parent.glob(f"cells-{path.stem}-????????????.json"):
            outdated.unlink()
        cache_file.parent.mkdir(parents=True, exist_ok=True)
        cache_file.write_text(json.dumps(kinds), "utf8")
    return json.loads(cache_file.read_text("utf8"))


@cache
def kinds_of_cells():
    """Return the kinds of the code cells of every notebook, by the names of the pages."""
    from ..notebooks import all_notebooks

    paths = [*all_notebooks(REPOSITORY), *sorted(REPOSITORY.glob(f"{STORED}*.ipynb"))]
    with ThreadPoolExecutor(max_workers=2) as pool:
        kinds = list(pool.map(kinds_of, paths))
    return dict(
        zip(
            [str(path.relative_to(REPOSITORY).with_suffix("")) for path in paths],
            kinds,
            strict=True,
        )
    )


def on_the_page(kinds):
    """Return the kinds of the cells that a page shows.

    Each runs the code of the hidden cells above it first. What hidden cells need, the next cell
    needs, and it is not skipped, since others may take names from them.
    """
    shown, code, needs = [], [], set()
    for kind in kinds:
        if not kind["shown"]:
            code.append(kind["code"])
            needs |= set(kind["needs"])
            continue
        merged = {"needs": sorted({*kind["needs"], *needs}), "skip": kind["skip"] and not code}
        shown.append({**kind, **merged, "before": "\n".join(code)})
        code, needs = [], set()
    return shown
