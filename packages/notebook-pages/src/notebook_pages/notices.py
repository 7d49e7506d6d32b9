"""The page ``licences.html``: third-party works in the site, with their licences.

The names, versions and texts come from the works themselves: npm packages, wheels for browsers, and
the Python distributions whose styles and scripts are copied into the site.
"""

import email
import json
import zipfile
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path
from typing import NamedTuple

from .set_up import FETCHED, LOCK, NODE_MODULES, WHEELS

#: Distributions whose files Sphinx and JupyterLite copy into the site.
COPIED = (
    "Sphinx",
    "sphinx-book-theme",
    "pydata-sphinx-theme",
    "sphinx-copybutton",
    "sphinx-design",
    "sphinx-exercise",
    "sphinx-togglebutton",
    "myst-nb",
    "jupyterlite-core",
    "jupyterlite-pyodide-kernel",
    "anywidget",
    "jupyterlab_widgets",
)
TEXTS = ("license", "licence", "copying", "notice")


class Work(NamedTuple):
    """A third-party work: its name, its licence, where its source is, and the licence's text."""

    name: str
    version: str
    licence: str
    source: str
    text: str


def is_text_of_licence(name: str) -> bool:
    return Path(name).name.lower().startswith(TEXTS)


def of_npm() -> Iterator[Work]:
    """Iterate over the npm packages in the site; those marked ``dev`` only build it."""
    for place, entry in json.loads(LOCK.read_text("utf8"))["packages"].items():
        if not place or entry.get("dev") or entry.get("optional"):
            continue
        folder = NODE_MODULES.parent / place
        about = json.loads((folder / "package.json").read_text("utf8"))
        repository = about.get("repository", "")
        source = repository if isinstance(repository, str) else repository.get("url", "")
        texts = [path for path in sorted(folder.iterdir()) if is_text_of_licence(path.name)]
        yield Work(
            about["name"],
            about["version"],
            about["license"],
            source.removeprefix("git+").removesuffix(".git"),
            "\n\n".join(path.read_text("utf8") for path in texts),
        )


def of_metadata(about: email.message.Message, texts: list[str]) -> Work:
    """Return a work from the metadata of a Python distribution."""
    addresses = dict(line.split(", ", 1) for line in about.get_all("Project-URL", []))
    classifiers = [
        line.rpartition(" :: ")[2]
        for line in about.get_all("Classifier", [])
        if line.startswith("License ::")
    ]
    stated = about.get("License-Expression") or ", ".join(classifiers) or about.get("License", "")
    sources = [address for name, address in addresses.items() if "ource" in name or "epo" in name]
    return Work(
        about["Name"],
        about["Version"],
        stated.strip().partition("\n")[0],
        [*sources, *addresses.values(), about.get("Home-page", "")][0],
        "\n\n".join(texts),
    )


def of_wheels() -> Iterator[Work]:
    for wheels in WHEELS:
        for path in sorted((FETCHED / ".venv" / "runtime" / wheels.parent.name).glob("*.whl")):
            with zipfile.ZipFile(path) as wheel:
                inside = [name for name in wheel.namelist() if ".dist-info/" in name]
                (about,) = (name for name in inside if name.endswith("/METADATA"))
                texts = [
                    wheel.read(name).decode("utf8") for name in inside if is_text_of_licence(name)
                ]
                yield of_metadata(email.message_from_bytes(wheel.read(about)), texts)


def of_distributions() -> Iterator[Work]:
    for name in COPIED:
        distribution = metadata.distribution(name)
        texts = [
            Path(str(distribution.locate_file(file))).read_text("utf8")
            for file in distribution.files or ()
            if is_text_of_licence(file.name) and file.suffix != ".py"
        ]
        yield of_metadata(distribution.metadata, texts)


def works() -> list[Work]:
    """Return the third-party works in the site, by name."""
    by_name = {work.name: work for work in (*of_npm(), *of_wheels(), *of_distributions())}
    return sorted(by_name.values(), key=lambda work: work.name.lower().lstrip("@"))


def add_page(app):
    yield (
        "licences",
        {"title": "Licences of third-party works", "works": works()},
        "licences.html",
    )


def setup(app):
    app.connect("html-collect-pages", add_page)
