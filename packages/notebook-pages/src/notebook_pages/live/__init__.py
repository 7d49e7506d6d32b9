"""Code that runs in the page, with no server: Python itself comes with the site.

The site's folder ``runtime`` holds all of it, and nothing there is loaded before the reader asks
for it:

- ``pyodide-<hash>/``: the interpreter, as npm delivers it (``pyodide.js`` and its files);
- ``wheels/<hash>/*.whl``: SymPy, mpmath and our own packages, byte-compiled;
- ``sealed-<hash>/``: the sealed variants of the book's questions, of which a reader's Python
  fetches its own;
- ``pyodide-lock.json``: the packages that a plain ``import`` finds, each with its hash. The file
  names of wheels in it are relative to the lock file. The same list is in ``lock-<hash>/``, for
  pages of this edition that are still open when the next one is published. NumPy and Matplotlib
  are listed according to ``numpy_in_the_page``;
- ``scripts-<hash>/``: the programs that run the cells of a page (``js``, ``python``).

Any other program that runs Python in a browser (a notebook interface, say) needs only the address
of ``pyodide.js`` and that of ``pyodide-lock.json``.
"""

import json
from pathlib import Path

from docutils import nodes
from sphinx.errors import ExtensionError

from ..take_away import notebook_address
from . import runtime, scripts
from .cells import kinds_of_cells, on_the_page
from .listing import NeedsMore


def write_scripts(app):
    if app.builder.format == "html":
        scripts.write(Path(app.outdir))


def write_runtime(app, exception):
    if not exception and app.builder.format == "html":
        runtime.write(Path(app.outdir), app.config.numpy_in_the_page)


def cells_with_code(doctree):
    """Count the cells of a page that show their code."""
    if doctree is None:
        return 0
    return sum(
        node.get("nb_element") == "cell_code_source" for node in doctree.findall(nodes.container)
    )


def add_live_code(app, pagename, templatename, context, doctree):
    """Give a page with code its buttons, and the build's information about its cells."""
    count = cells_with_code(doctree)
    if not count:
        return
    pathto = context["pathto"]
    kinds = on_the_page(kinds_of_cells()[pagename]) if pagename in kinds_of_cells() else []
    if kinds and len(kinds) != count:
        raise ExtensionError(
            f"{pagename} shows {count} cells with code, but its notebook has {len(kinds)} to run"
        )
    context["live_data"] = json.dumps(
        {
            "page": pagename,
            # finish.py fills in the number of bytes of the download of Python.
            "bytes": 0,
            "runtime": pathto(f"{runtime.FOLDER}/", 1),
            "pyodide": f"{runtime.pyodide_folder()}/",
            "lock": "",  # finish.py fills in where the packages of this edition are listed,
            "variants": "",  # and where its sealed variants are.
            "scripts": pathto(f"{scripts.folder_name()}/", 1),
            "notebook": pathto(notebook_address(pagename), 1),
            "cells": {
                index: shown
                for index, kind in enumerate(kinds)
                if (
                    shown := {
                        key: kind[key] for key in ("needs", "skip", "before", "name") if kind[key]
                    }
                )
            },
        },
        separators=(",", ":"),
    )
    app.add_js_file("live.js", loading_method="defer")


def take_settings(app, config):
    """Let the environment set the source of NumPy.

    Write every page again if its scripts or Pyodide have another version.
    """
    config.numpy_in_the_page = runtime.numpy_setting(config.numpy_in_the_page)
    config.runtime_folders = f"{scripts.folder_name()} {runtime.pyodide_folder()}"


def setup(app):
    app.add_config_value("numpy_in_the_page", "official", "html", (str, bool))
    app.add_config_value("runtime_folders", "", "html", str)
    app.connect("config-inited", take_settings)
    app.add_directive("cells-that-need-more", NeedsMore)
    app.connect("builder-inited", write_scripts)
    app.connect("html-page-context", add_live_code, priority=970)
    # Run after take_away.py has built the wheel.
    app.connect("build-finished", write_runtime, priority=900)
