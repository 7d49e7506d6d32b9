"""Where things are, and a fingerprint of what the pages are made from."""

import hashlib
from pathlib import Path

WEBSITE = Path(__file__).resolve().parent
REPOSITORY = WEBSITE.parent.parent
NODE_MODULES = REPOSITORY / "node_modules"


def fingerprint(*paths):
    """Twelve hexadecimal digits that change when any file in ``paths`` does."""
    digest = hashlib.sha256()
    for path in paths:
        files = sorted(path.rglob("*")) if path.is_dir() else [path]
        for file in files:
            if file.is_file() and "__pycache__" not in file.parts:
                digest.update(str(file.relative_to(path.parent)).encode())
                digest.update(file.read_bytes())
    return digest.hexdigest()[:12]


def where(node):
    """The place of ``node`` in its source, as a reader of the warning needs it.

    MyST-NB gives the lines of a notebook as 10000 times the cell's number, plus
    the line in the cell, plus one.
    """
    while node is not None and not (node.source and node.line):
        node = node.parent
    if node is None:
        return None
    cell, line = divmod(node.line, 10000)
    if str(node.source).endswith(".ipynb") and cell:
        return f"{node.source}:{max(line - 1, 1)} (cell {cell})"
    return f"{node.source}:{node.line}"
