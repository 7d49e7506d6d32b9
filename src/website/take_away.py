"""Every page that is a notebook can be taken away as a notebook and as a script.

Both hold the page's prose in plain Markdown, with the numbers and names that
the book gives to equations, figures and exercises, and the code as it stands
in the chapter. Outputs are left out: the reader's own run makes them, and
they cannot be old. The package that the code imports lies beside them.
"""

import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

import jupytext
import nbformat

from .markdown import MarkdownWriter
from .paths import REPOSITORY

FOLDER = "take-away"
PACKAGES = ("orientation", "coursework")
KERNEL = {"name": "python3", "display_name": "Python 3", "language": "python"}
NO_METADATA = {"notebook_metadata_filter": "-all", "cell_metadata_filter": "-all"}


def introduction(config, wheel):
    return (
        f"> This is a page of *{config.html_title}*. To run it, install the package that it "
        f"imports: download `{wheel}` from the page's menu and run "
        f"`python -m pip install {wheel}`. Text: CC BY 4.0. Code: BSD-3-Clause."
    )


def make_notebook(app, docname, doctree):
    source = nbformat.read(app.env.doc2path(docname), as_version=4)
    cells, next_source = [], 0

    def add_code(stop):
        """Add the code cells up to ``stop``, those that the page hides among them."""
        nonlocal next_source
        for cell in source.cells[next_source:stop]:
            if cell.cell_type == "code":
                code = nbformat.v4.new_code_cell(cell.source)
                if "hide-input" in cell.metadata.get("tags", []):
                    code.metadata["jupyter"] = {"source_hidden": True}
                cells.append(code)
        next_source = max(next_source, stop)

    for is_cell, piece in MarkdownWriter(app.env, docname).page(doctree):
        if is_cell:
            add_code(piece["cell_index"] + 1)
        elif cells and cells[-1].cell_type == "markdown":
            cells[-1].source += "\n\n" + piece
        else:
            cells.append(nbformat.v4.new_markdown_cell(piece))
    add_code(len(source.cells))
    note = introduction(app.config, wheel_name())
    title, _, rest = cells[0].source.partition("\n\n")
    cells[0].source = "\n\n".join(filter(None, [title, note, rest]))
    for position, cell in enumerate(cells):
        cell["id"] = f"cell-{position}"  # not random, so that builds are the same
    return nbformat.v4.new_notebook(cells=cells, metadata={"kernelspec": KERNEL})


def wheel_name():
    project = tomllib.loads((REPOSITORY / "pyproject.toml").read_text("utf8"))["project"]
    return f"{project['name'].replace('-', '_')}-{project['version']}-py3-none-any.whl"


def write_page(app, pagename, templatename, context, doctree):
    context["downloads"] = []
    if doctree is None or not str(app.env.doc2path(pagename)).endswith(".ipynb"):
        return
    notebook = make_notebook(app, pagename, doctree)
    target = Path(app.outdir) / FOLDER / pagename.rsplit("/", 1)[-1]
    target.parent.mkdir(exist_ok=True)
    nbformat.write(notebook, target.with_suffix(".ipynb"))
    notebook.metadata = {"jupytext": NO_METADATA}
    target.with_suffix(".py").write_text(jupytext.writes(notebook, fmt="py:percent"), "utf8")
    context["downloads"] = [
        {"path": f"{FOLDER}/{target.name}.ipynb", "text": "Notebook", "note": "for Jupyter, with the prose"},
        {"path": f"{FOLDER}/{target.name}.py", "text": "Python script", "note": "the prose as comments"},
        {
            "path": f"{FOLDER}/{wheel_name()}",
            "text": "Package",
            "note": "what the code imports: pip install it",
        },
    ]


def build_wheel(app, exception):
    """Build our packages into the site, as one wheel, from a copy: setuptools leaves files behind."""
    wheel = Path(app.outdir) / FOLDER / wheel_name()
    if exception or app.builder.format != "html":
        return
    sources = [REPOSITORY / name for name in ("pyproject.toml", "README.md", "LICENSE", "LICENSE-CODE")]
    packages = [REPOSITORY / "src" / name for name in PACKAGES]
    files = [path for package in packages for path in package.rglob("*") if "__pycache__" not in path.parts]
    newest = max(path.stat().st_mtime for path in [*sources, *files])
    if wheel.exists() and wheel.stat().st_mtime > newest:
        return
    with tempfile.TemporaryDirectory() as copy:
        for path in sources:
            shutil.copy(path, copy)
        for package in packages:
            shutil.copytree(
                package, Path(copy, "src", package.name), ignore=shutil.ignore_patterns("__pycache__")
            )
        subprocess.run(
            [sys.executable, "-m", "pip", "wheel", "--quiet", "--disable-pip-version-check",
             "--no-deps", "--no-build-isolation", "--wheel-dir", wheel.parent, copy],
            check=True,
        )  # fmt: skip


def setup(app):
    app.connect("html-page-context", write_page)
    app.connect("build-finished", build_wheel)
