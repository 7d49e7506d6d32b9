"""The files of our packages that a notebook uses, whose changes may change its results.

Starting from the imports of its cells, this follows every import in those modules, including those
inside functions, to the files beside them (scripts, style sheets) and to the sealed questions that
the notebook asks. Files that it does not reach, such as the grader, do not make a chapter run
again.
"""

import ast
import hashlib
import re
import threading
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from .paths import PACKAGES, REGISTERED, REPOSITORY

if TYPE_CHECKING:
    from nbformat import NotebookNode

# The package that ``coursework`` finds through its entry point, which no import shows.
PLUGIN = REGISTERED.get("plugin", "")
SEALED = PACKAGES.get(PLUGIN, REPOSITORY) / "sealed"
# The versions of everything else that is imported.
PINS = REPOSITORY / "constraints.txt"
#: In a notebook's metadata: what its stored outputs come from, see `fingerprint_of_run`.
MADE_WITH = "made_with"
_PARSING = threading.Lock()


def parse(code: str) -> ast.Module:
    """Return the syntax tree of some code, one thread at a time.

    Python 3.11 fails when two threads make trees at once.
    """
    with _PARSING:
        return ast.parse(code)


def statements(tree: ast.AST) -> Iterator[ast.AST]:
    """Iterate over the statements of a tree and those within them.

    Expressions, which are most of a tree, contain none.
    """
    for inner in ast.iter_child_nodes(tree):
        if isinstance(inner, (ast.stmt, ast.excepthandler, ast.match_case)):
            yield inner
            yield from statements(inner)


def file_of(module: str) -> Path | None:
    """Return the file of one of our modules, or ``None`` if there is none of this name."""
    package, *inner = module.split(".")
    if package not in PACKAGES:
        return None
    place = PACKAGES[package].joinpath(*inner)
    return next(
        (path for path in (place / "__init__.py", place.with_suffix(".py")) if path.is_file()), None
    )


def names_imported(code: str, module: str = "") -> set[str]:
    """Return everything that ``code`` may import, by full names.

    ``module`` is the module of the code, for relative imports.
    """
    names: set[str] = set()
    file = file_of(module)
    for node in statements(parse(code)):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                is_package = file is not None and file.name == "__init__.py"
                above = module.split(".")
                above = above[: len(above) - node.level + is_package]
                base = ".".join([*above, *filter(None, [node.module])])
            names |= {base, *(f"{base}.{alias.name}" for alias in node.names)}
    return names


def modules_imported(code: str, module: str = "") -> set[str]:
    """Return the names of our modules that ``code`` imports, as `names_imported` does."""
    names = names_imported(code, module)
    ours = {name for name in names if file_of(name)}
    # Importing a.b imports a first.
    return ours | {
        name.rsplit(".", depth)[0] for name in ours for depth in range(1, name.count(".") + 1)
    }


@cache
def _imported_by(module: str) -> frozenset[str]:
    file = file_of(module)
    return frozenset(modules_imported(file.read_text("utf8"), module) if file else ())


def modules_used(code: str) -> set[str]:
    """Return the names of all our modules that running ``code`` may import."""
    modules: set[str] = set()
    waiting = list(modules_imported(code))
    while waiting:
        module = waiting.pop()
        if module not in modules:
            modules.add(module)
            waiting += _imported_by(module)
            if module == "coursework":
                waiting.append(PLUGIN)
    return modules


def files_used(code: str) -> list[Path]:
    """Return the files of this repository that running ``code`` may read, in order."""
    modules = modules_used(code)
    files = {file for module in modules if (file := file_of(module))} | (
        {PINS} if PINS.is_file() else set()
    )
    files.update(*map(beside, {path.parent for path in files if path != PINS} - {SEALED.parent}))
    files -= set(SEALED.glob("*"))
    if "coursework" in modules:
        files |= {
            path for path in SEALED.glob("*.json") if re.search(rf"\b{re.escape(path.stem)}/", code)
        }
    return sorted(files)


@cache
def beside(folder: Path) -> frozenset[Path]:
    """Return the files of a package that are not modules, including those in its folders."""
    return frozenset(
        path
        for path in folder.rglob("*")
        if path.is_file() and path.suffix not in (".py", ".pyc") and package_of(path) == folder
    )


def package_of(path: Path) -> Path:
    """Return the folder of the package that a file belongs to."""
    return next(folder for folder in path.parents if (folder / "__init__.py").is_file())


# A new version alone does not change the result of a cell.
VERSION = re.compile(rb"^__version__ = .*$", re.MULTILINE)


@cache
def _digest(path: Path) -> bytes:
    return hashlib.sha256(VERSION.sub(b"", Path(path).read_bytes())).digest()


def fingerprint_of_used(notebook: "NotebookNode") -> str:
    """Return a text that changes when anything that the cells of ``notebook`` use changes.

    The cells themselves are not included.
    """
    files = files_used("\n".join(code_of(notebook)))
    parts = (f"{path.relative_to(REPOSITORY)} {_digest(path).hex()}" for path in files)
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()[:16]


def fingerprint_of_run(notebook: "NotebookNode") -> str:
    """Return a text that changes when the cells of ``notebook``, or anything they use, change."""
    code = [cell.source for cell in notebook.cells if cell.cell_type == "code"]
    return hashlib.sha256("\0".join([fingerprint_of_used(notebook), *code]).encode()).hexdigest()


def notebook_of(path: str | Path) -> "NotebookNode":
    """Return a notebook of the book as stored; callers must check that the file is one."""
    from nbformat import v4

    notebook: NotebookNode = v4.reads(Path(path).read_text("utf8"))
    return notebook


def code_of(notebook: "NotebookNode") -> list[str]:
    """Return the code of each cell that is Python.

    Code that does not parse is left for the run to report.
    """
    codes = []
    for cell in notebook.cells:
        if cell.cell_type == "code":
            try:
                parse(cell.source)
            except SyntaxError:
                continue
            codes.append(cell.source)
    return codes
