"""What of our packages a notebook uses: the files whose change may change what its cells give.

A notebook is followed from what its cells import through every import in those modules, also those
inside functions, to the files that lie beside them (scripts, style sheets), and to the sealed
questions that it asks. What is not reached, such as the grader, does not make a chapter run again.
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

#: The package that ``coursework`` finds through its entry point, which no import shows.
PLUGIN = REGISTERED.get("plugin", "")
SEALED = PACKAGES.get(PLUGIN, REPOSITORY) / "sealed"
#: The versions of everything else that is imported.
PINS = REPOSITORY / "constraints.txt"
_PARSING = threading.Lock()


def parse(code: str) -> ast.Module:
    """The syntax tree of some code, from any thread: Python 3.11 fails
    when two threads make trees at once.
    """
    with _PARSING:
        return ast.parse(code)


def statements(tree: ast.AST) -> Iterator[ast.AST]:
    """The statements of a tree, and those within them: an expression,
    which most of a tree is, holds none.
    """
    for inner in ast.iter_child_nodes(tree):
        if isinstance(inner, (ast.stmt, ast.excepthandler, ast.match_case)):
            yield inner
            yield from statements(inner)


def file_of(module: str) -> Path | None:
    """The file of one of our modules, or ``None`` if there is none of this name."""
    package, *inner = module.split(".")
    if package not in PACKAGES:
        return None
    place = PACKAGES[package].joinpath(*inner)
    return next(
        (path for path in (place / "__init__.py", place.with_suffix(".py")) if path.is_file()), None
    )


def names_imported(code: str, module: str = "") -> set[str]:
    """All that ``code`` may import, by full names; ``module`` is where
    it stands, for relative imports.
    """
    found: set[str] = set()
    file = file_of(module)
    for node in statements(parse(code)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                is_package = file is not None and file.name == "__init__.py"
                above = module.split(".")
                above = above[: len(above) - node.level + is_package]
                base = ".".join([*above, *filter(None, [node.module])])
            found |= {base, *(f"{base}.{alias.name}" for alias in node.names)}
    return found


def modules_imported(code: str, module: str = "") -> set[str]:
    """The names of our modules that ``code`` imports; ``module`` as in :func:`names_imported`."""
    found = names_imported(code, module)
    ours = {name for name in found if file_of(name)}
    # Importing a.b imports a first.
    return ours | {
        name.rsplit(".", depth)[0] for name in ours for depth in range(1, name.count(".") + 1)
    }


@cache
def _imported_by(module: str) -> frozenset[str]:
    file = file_of(module)
    return frozenset(modules_imported(file.read_text("utf8"), module) if file else ())


def modules_used(code: str) -> set[str]:
    """The names of all our modules that running ``code`` may lead to."""
    found: set[str] = set()
    waiting = list(modules_imported(code))
    while waiting:
        module = waiting.pop()
        if module not in found:
            found.add(module)
            waiting += _imported_by(module)
            if module == "coursework":
                waiting.append(PLUGIN)
    return found


def files_used(code: str) -> list[Path]:
    """The files of this repository that running ``code`` may read, in their order."""
    modules = modules_used(code)
    files = {file for module in modules if (file := file_of(module))} | (
        {PINS} if PINS.is_file() else set()
    )
    for folder in {path.parent for path in files if path != PINS} - {SEALED.parent}:
        files |= beside(folder)
    files -= set(SEALED.glob("*"))
    if "coursework" in modules:
        files |= {
            path for path in SEALED.glob("*.json") if re.search(rf"\b{re.escape(path.stem)}/", code)
        }
    return sorted(files)


@cache
def beside(folder: Path) -> frozenset[Path]:
    """The files of a package that are no modules, those in its folders among them."""
    return frozenset(
        path
        for path in folder.rglob("*")
        if path.is_file() and path.suffix not in (".py", ".pyc") and package_of(path) == folder
    )


def package_of(path: Path) -> Path:
    """The folder of the package that a file belongs to."""
    return next(folder for folder in path.parents if (folder / "__init__.py").is_file())


#: A new version alone does not change the result of a cell.
VERSION = re.compile(rb"^__version__ = .*$", re.MULTILINE)


@cache
def _digest(path: Path) -> bytes:
    return hashlib.sha256(VERSION.sub(b"", Path(path).read_bytes())).digest()


def fingerprint_of_used(notebook: "NotebookNode") -> str:
    """A text that changes when anything changes that the cells of
    ``notebook`` use, themselves not among it.
    """
    code = "\n".join(code_of(notebook))
    parts = [f"{path.relative_to(REPOSITORY)} {_digest(path).hex()}" for path in files_used(code)]
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()[:16]


def notebook_of(path: str | Path) -> "NotebookNode":
    """A notebook of the book as it stands in its file: whoever shows it looks whether it is one."""
    from nbformat import v4

    notebook: NotebookNode = v4.reads(Path(path).read_text("utf8"))
    return notebook


def code_of(notebook: "NotebookNode") -> list[str]:
    """The code of each cell that is Python; what cannot be read as Python is
    left for the run to complain of.
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
