"""Code that runs in the page, with no server: Python itself comes with the site.

The site's folder ``runtime`` holds, and nothing else anywhere loads:

- ``pyodide/``: the interpreter, as npm brings it (``pyodide.mjs`` and what it loads);
- ``wheels/<hash>/*.whl``: SymPy, mpmath and our own packages, byte-compiled;
- ``pyodide-lock.json``: the packages that a plain ``import`` finds, each with its hash. The file names of
  wheels in it are relative to the lock file. NumPy and Matplotlib are listed as ``numpy_in_the_page`` says.

Whatever else is to run Python in a browser (a notebook interface, say) needs only the address of
``pyodide/pyodide.mjs`` and that of ``pyodide-lock.json``.
"""

from pathlib import Path

from . import runtime


def write_runtime(app, exception):
    if not exception and app.builder.format == "html":
        runtime.write(Path(app.outdir), app.config.numpy_in_the_page)


def setup(app):
    app.add_config_value("numpy_in_the_page", "official", "html", (str, bool))
    app.connect("build-finished", write_runtime, priority=900)  # after take_away.py has built the wheel
