"""The page of licences names every third-party work that the site serves."""

import re
import sysconfig
from collections import defaultdict
from importlib import metadata
from pathlib import Path

from bs4 import BeautifulSoup
from places import HTML

from notebook_pages.packing import PROJECTS
from notebook_pages.paths import NODE_MODULES

SERVED = {".js", ".mjs", ".css", ".woff2", ".wasm", ".svg", ".png", ".whl"}
OURS = {"notebook-pages", *(project.name for project in PROJECTS)}


def owners():
    """Return the names of the works that each file belongs to, by the file's size and path."""
    files = defaultdict(list)
    for package in [*NODE_MODULES.glob("[a-z]*"), *NODE_MODULES.glob("@*/*")]:
        for path in package.rglob("*"):
            if path.suffix in SERVED and path.is_file():
                files[path.stat().st_size].append(
                    (path, package.relative_to(NODE_MODULES).as_posix())
                )
    for distribution in metadata.distributions(path=[sysconfig.get_path("purelib")]):
        for file in distribution.files or ():
            path = Path(str(distribution.locate_file(file)))
            if path.suffix in SERVED and path.is_file():
                files[path.stat().st_size].append((path, distribution.name))
    return files


def test_every_file_that_is_served_as_others_made_it_is_covered():
    page = BeautifulSoup((HTML / "licences.html").read_text("utf8"), "lxml")
    works = [
        re.match(r"(\S+) (\S+): (.+)", summary.text).groups()
        for summary in page.select(".bd-article > details > summary")
    ]
    named = {name.lower().replace("_", "-") for name, _, _ in works}
    assert all(licence.strip() for _, _, licence in works)
    files, missing = owners(), {}
    for path in HTML.rglob("*"):
        if path.suffix not in SERVED or not path.is_file() or path.stat().st_size < 200:
            continue
        # A file that is identical in several works is covered by any of them.
        holders = {
            name
            for candidate, name in files[path.stat().st_size]
            if candidate.read_bytes() == path.read_bytes()
        }
        if path.is_relative_to(HTML / "lite" / "build"):
            # JupyterLite contains this folder, packed, with the licences of its parts.
            holders.add("jupyterlite-core")
        if holders and not {name.lower().replace("_", "-") for name in holders} & (named | OURS):
            missing[str(path.relative_to(HTML))] = holders
    assert missing == {}
    wheels = {path.name.split("-")[0].replace("_", "-").lower() for path in HTML.rglob("*.whl")}
    # The stand-in for NumPy is ours; jupyterlite-pyodide-kernel contains the others.
    assert wheels <= named | OURS | {
        "plain-numpy",
        "piplite",
        "pyodide-kernel",
        "widgetsnbextension",
        "ipykernel",
    }


def test_each_page_leads_to_the_licences():
    front = BeautifulSoup((HTML / "index.html").read_text("utf8"), "lxml")
    inner = BeautifulSoup(next((HTML / "chapters").glob("*.html")).read_text("utf8"), "lxml")
    assert front.select_one('.colophon a[href="licences.html"]')
    assert inner.select_one('.colophon a[href="../licences.html"]')
