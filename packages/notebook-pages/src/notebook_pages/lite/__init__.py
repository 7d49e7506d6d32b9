"""JupyterLite: the notebooks of the book in the reader's browser, in the site's folder ``lite``.

It shares the interpreter and the wheels of the folder ``runtime`` (see `notebook_pages.live`),
and adds the packages that a notebook's kernel needs. A lock file of its own lists them all, so that
a plain ``import`` works.
"""

import json
import os
import re
import shutil
import subprocess
import sys
import zipfile
from array import array
from collections import Counter
from hashlib import sha256
from operator import itemgetter
from pathlib import Path

import nbformat
import yaml

from ..live import runtime, scripts
from ..live.cells import PYTHON, kinds_of_cells
from ..paths import BUILD, LICENCES_SAID, YAML, fingerprint, moment_of_sources
from ..take_away import first_words, is_notebook, notebook_address, notebook_pages
from ..used import notebook_of

HERE = Path(__file__).parent
FOLDER = "lite"
LOCK = "lite-lock.json"
FETCHED = runtime.FETCHED_FOR_NOTEBOOKS
WORKSHOP = BUILD / FOLDER
APPS = ("notebooks", "tree", "edit")  # one notebook, the list of all of them, a text file
# The parts of the interface that are not JupyterLite's own: the kernel, sliders, and the moving
# figures.
EXTENSIONS = (
    "@jupyterlite/pyodide-kernel-extension",
    "@jupyter-widgets/jupyterlab-manager",
    "anywidget",
)
LABEXTENSIONS = Path(sys.prefix) / "share" / "jupyter" / "labextensions"
KERNEL_WHEELS = LABEXTENSIONS / EXTENSIONS[0] / "static" / "pypi"
KERNEL = ("ipykernel", "piplite", "pyodide_kernel")
# IPython runs this first.
STARTUP = "stand_in.ipy"
NOTE = (
    "> This page of *{title}* runs in your browser. Your changes stay in this browser, on this "
    "machine. "
    "*File > Download* gives you the notebook." + (f" {LICENCES_SAID}" if LICENCES_SAID else "")
)
NUMERICAL = (
    "*From here on, cells of this page compute or draw with NumPy and Matplotlib. "
    "The next cell fetches them from {place}.*",
    "import matplotlib\nimport numpy",
)
PLACES = {
    "official": "`cdn.jsdelivr.net`, where the Pyodide project serves them",
    "folder": "the server of these pages",
}


def wheels_of_kernel():
    return [
        *sorted(FETCHED.glob("*.whl")),
        *(wheel for name in KERNEL for wheel in KERNEL_WHEELS.glob(f"{name}-*.whl")),
    ]


def wheel_of_stand_in():
    """Return a wheel of NumPy's stand-in for notebooks, and of the line that installs it."""
    path, about = BUILD / "plain_numpy-1-py3-none-any.whl", "plain_numpy-1.dist-info"
    with zipfile.ZipFile(path, "w") as wheel:
        for name, text in (
            ("plain_numpy.py", (PYTHON / "plain_numpy.py").read_text("utf8")),
            (STARTUP, "%load_ext plain_numpy\n"),
            (f"{about}/METADATA", "Metadata-Version: 2.1\nName: plain-numpy\nVersion: 1\n"),
            (f"{about}/WHEEL", "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n"),
            (f"{about}/RECORD", ""),
        ):
            wheel.writestr(zipfile.ZipInfo(name), text)
    return path


def write_lock(site):
    """Put the wheels of the kernel beside the others and list all; return the names to load."""
    target = site / runtime.FOLDER
    lock = json.loads((target / runtime.LOCK).read_text("utf8"))
    wheels = [*wheels_of_kernel(), wheel_of_stand_in()]
    added = runtime.own_packages(runtime.compile_wheels(wheels), target)
    packages = lock["packages"] | added
    (target / LOCK).write_text(
        json.dumps({"info": lock["info"], "packages": packages}, indent=1), "utf8"
    )
    return sorted({*added, *runtime.with_dependencies([runtime.DISTRIBUTION], packages)})


def fingerprint_of_code(text):
    """Return the short hash of a cell's code that the scripts of the page compute too.

    Its counterpart is ``fingerprint`` in live/js/store.js.
    """
    a, b, word = 0xDEADBEEF, 0x41C6CE57, 0xFFFFFFFF
    for unit in array("H", text.encode("utf-16-le")):
        a = (a ^ unit) * 2654435761 & word
        b = (b ^ unit) * 1597334677 & word
    a = ((a ^ a >> 16) * 2246822507 ^ (b ^ b >> 13) * 3266489909) & word
    b = ((b ^ b >> 16) * 2246822507 ^ (a ^ a >> 13) * 3266489909) & word
    number, digits = (b & 0x1FFFFF) << 32 | a, ""
    while number:
        number, digit = divmod(number, 36)
        digits = "0123456789abcdefghijklmnopqrstuvwxyz"[digit] + digits
    return digits or "0"


def stamp(notebook):
    """Store in the notebook a hash of each code cell, by the name that the page gives the cell.

    A copy that a reader keeps can then be distinguished from a newer edition, and its answers from
    the book's code.
    """
    seen, cells = Counter(), {}
    for cell in notebook.cells:
        if cell.cell_type == "code":
            print_ = fingerprint_of_code(cell.source.rstrip())
            name = cell.metadata.get("nbgrader", {}).get("grade_id") or f"{print_}-{seen[print_]}"
            seen[print_] += not cell.metadata.get("nbgrader", {}).get("grade_id")
            cells[cell.id] = [name, print_]
    notebook.metadata["book"] = {"cells": cells}
    return notebook


def announce_numpy(notebook, kinds, place):
    """Fetch NumPy in a cell of its own, which says so, above the first cell that uses it.

    The kernel fetches the packages that a cell imports. Some cells use NumPy only through our own
    package, and plain Python cannot replace it in all of them.
    """
    codes = [position for position, cell in enumerate(notebook.cells) if cell.cell_type == "code"]
    for position, kind in zip(codes, kinds, strict=True):
        if kind["numpy"] or set(kind["needs"]) & set(runtime.NUMERICAL):
            words, code = NUMERICAL
            notebook.cells[position:position] = [
                nbformat.v4.new_markdown_cell(words.format(place=place), id="numpy-why"),
                nbformat.v4.new_code_cell(code, id="numpy"),
            ]
            return


def notebook_for(site, page, settings):
    """Return the notebook of a page: exercises as released, other pages as they are downloaded."""
    notebook = stamp(notebook_of(site / notebook_address(page)))
    if page.startswith("exercises/"):
        return written(notebook)
    first = notebook.cells[0]
    notes = [
        line
        for line in first.source.splitlines()
        if line.startswith(first_words(settings["title"]))
    ]
    if len(notes) != 1:
        raise RuntimeError(
            f"the notebook of {page} does not contain the expected sentence on how to run it"
        )
    first.source = first.source.replace(notes[0], NOTE.format(title=settings["title"]))
    setting = runtime.numpy_setting(
        settings["sphinx"].get("config", {}).get("numpy_in_the_page", "official")
    )
    if setting not in (False, "off"):
        announce_numpy(notebook, kinds_of_cells()[page], PLACES.get(setting, PLACES["folder"]))
    return written(notebook)


def written(notebook):
    """Return the notebook as JSON, with each text as one string.

    The interface joins the lines of cells but not those of outputs, and its table of contents fails
    on lists.
    """
    return nbformat.v4.writes(notebook, split_lines=False)


def write_workshop(site, settings, names):
    """Write the sources of the interface: the notebooks, and the settings."""
    shutil.rmtree(WORKSHOP, ignore_errors=True)
    for page in notebook_pages():
        path = WORKSHOP / "files" / f"{page}.ipynb"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(notebook_for(site, page, settings), "utf8")
    lock = sha256((site / runtime.FOLDER / LOCK).read_bytes()).hexdigest()[:12]
    version = runtime.official_lock()["info"]["python"].rpartition(".")[0]
    # JupyterLite takes an address as relative to its own folder only if it begins with "./".
    kernel = {
        # The kernel recognises a module by the end of its address, and servers by the name of the
        # file.
        "pyodideUrl": f"./../{runtime.FOLDER}/{runtime.pyodide_folder()}/pyodide.js?as=.mjs",
        "disablePyPIFallback": True,
        # The name is the same in every version of the book, so a suffix distinguishes them.
        "loadPyodideOptions": {
            "lockFileURL": f"../{runtime.FOLDER}/{LOCK}?{lock}",
            "packages": names,
            "env": {"PYTHONSTARTUP": f"/lib/python{version}/site-packages/{STARTUP}"},
        },
    }
    page = {
        "appName": settings["title"],
        "appUrl": f"./{APPS[1]}",
        "faviconUrl": "./../_static/favicon.svg",
        "litePluginSettings": {f"{EXTENSIONS[0]}:kernel": kernel},
    }
    build = {
        "apps": APPS,
        "contents": ["files"],
        "ignore_sys_prefix": ["federated_extensions"],
        "federated_extensions": [str(LABEXTENSIONS / name) for name in EXTENSIONS],
        "no_sourcemaps": True,
        "no_unused_shared_packages": True,
    }
    for name, content in (
        ("jupyter-lite.json", {"jupyter-lite-schema-version": 0, "jupyter-config-data": page}),
        ("jupyter_lite_config.json", {"LiteBuildConfig": build}),
        ("overrides.json", {"@jupyterlab/apputils-extension:themes": {"adaptive-theme": True}}),
    ):
        (WORKSHOP / name).write_text(json.dumps(content, indent=1), "utf8")


def bring_answers_first(target):
    """Have the interface fetch the page's answers before it opens a notebook."""
    page = target / APPS[0] / "index.html"
    before = page.read_text("utf8")
    start = re.compile(r"await import\(\s*'\.\./config-utils\.js")
    script = f"../../{scripts.folder_name()}/notebook.js"
    # If a script did not arrive, fetch it once more under another name. Without it the notebook
    # opens as it is stored here, and receives the page's answers another time. The wait has no
    # limit, because the script may ask the reader a question.
    wait = (
        f"await Promise.race([import('{script}').catch(() => import('{script}?again')), "
        "new Promise((_, giveUp) => setTimeout(giveUp, 10_000, new Error('no answer after ten "
        "seconds')))]).then((first) => first.prepare())"
        ".catch((error) => console.warn(`The answers from the page have not reached this notebook "
        "yet: ${error.message}`));\n"
        # When a notebook is renamed, the interface shows an address of Jupyter's server, which
        # does not exist here. Show one that can be opened again.
        "        const push = history.pushState.bind(history);\n"
        "        history.pushState = (state, title, address) => push(state, title, "
        f"address?.replace(/\\/{APPS[0]}\\/(?!index)/, '/{APPS[0]}/index.html?path='));\n"
        "        "
    )
    after, count = start.subn(lambda match: wait + match[0], before)
    if count != 1:
        raise RuntimeError(
            f"{page} no longer contains the expected start-up code, so answers from the pages "
            "would not reach it"
        )
    page.write_text(after, "utf8")


def bring_notebooks(target):
    """Put the notebooks into the interface, and update its lists.

    This adds a changed chapter without building the interface again.
    """
    moment = f"{moment_of_sources():%Y-%m-%dT%H:%M:%SZ}"
    for source in (WORKSHOP / "files").rglob("*.ipynb"):
        place = target / source.relative_to(WORKSHOP)
        if place.read_bytes() != (content := source.read_bytes()):
            place.write_bytes(content)
    for listing in (target / "api" / "contents").rglob("all.json"):
        folder = json.loads(listing.read_text("utf8"))
        folder["content"].sort(key=itemgetter("path"))
        for entry in (folder, *folder["content"]):
            entry["created"] = entry["last_modified"] = moment
            if entry["type"] != "directory":
                entry["size"] = (target / "files" / entry["path"]).stat().st_size
        listing.write_text(json.dumps(folder, indent=2, sort_keys=True), "utf8")


def write(site):
    """Write the notebook interface into ``site``, a folder with the built pages."""
    settings = yaml.load(Path("_config.yml").read_text("utf8"), YAML)
    write_workshop(site, settings, write_lock(site))
    target = site / FOLDER
    made_from = [
        fingerprint(
            *sorted(WORKSHOP.glob("*.json")), HERE, *(LABEXTENSIONS / name for name in EXTENSIONS)
        ),
        scripts.folder_name(),
        *notebook_pages(),
    ]
    made = target / "made-from.txt"
    if not made.exists() or made.read_text("utf8").split() != made_from:
        build_interface(target)
        made.write_text("\n".join(made_from), "utf8")
    bring_notebooks(target)


def build_interface(target):
    """Build the interface from the workshop, and move it into the site."""
    # The build silently drops local settings if it finds the notes of an older run, so make a new
    # workshop each time. It also dates everything beside its own folder. If that were all pages of
    # the site, the next build would consider them older than their sources.
    apart = WORKSHOP / "site" / FOLDER
    command = [sys.executable, "-m", "jupyterlite_core", "build", "--output-dir", apart.resolve()]
    environment = os.environ | {"SOURCE_DATE_EPOCH": str(int(moment_of_sources().timestamp()))}
    done = subprocess.run(
        command, cwd=WORKSHOP, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
    )
    if done.returncode:
        sys.exit(f"JupyterLite could not be built:\n{done.stdout.decode()}")
    bring_answers_first(apart)
    shutil.rmtree(target, ignore_errors=True)
    shutil.move(apart, target)


def add_link(app, pagename, templatename, context, doctree):
    """Give a page with a notebook the address that opens it."""
    if is_notebook(app, pagename, doctree):
        context["notebook_interface"] = (
            context["pathto"](f"{FOLDER}/{APPS[0]}/index.html", 1) + f"?path={pagename}.ipynb"
        )


def setup(app):
    app.connect("html-page-context", add_link)
