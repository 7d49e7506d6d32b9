"""Offer every page that is a notebook as a notebook and as a script.

Both contain the page's prose in plain Markdown, with the book's numbers and names of equations,
figures and exercises, and the code of the chapter. Outputs are left out, because the reader's own
run makes new ones. The packages that the code imports are offered beside them.
"""

import shutil
from pathlib import Path

import jupytext
import nbformat

from .markdown import MarkdownWriter
from .packing import PROJECTS, write_zip
from .paths import LICENCES_SAID, REGISTERED, REPOSITORY, named, pages

FOLDER = "take-away"
ARCHIVE = "exercises.zip"
#: Extra files such as measurements, which come with the notebooks that import their package.
DATA = REGISTERED.get("data", {})
EXERCISES = REPOSITORY / "exercises"
#: Metadata of our notebooks.
METADATA = {
    "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
    # Without the exporter, nbconvert writes a script as a text file, and leaves out our words.
    "language_info": {"name": "python", "nbconvert_exporter": "python"},
}
NO_METADATA = {"notebook_metadata_filter": "-all", "cell_metadata_filter": "-all"}


def notebook_pages():
    """Return the names of the pages that are notebooks."""
    return [page for page in pages() if Path(f"{page}.ipynb").is_file()]


def notebook_address(page):
    """Return the path in the site of the notebook of a page."""
    return f"{FOLDER}/{page if page.startswith('exercises/') else page.rsplit('/', 1)[-1]}.ipynb"


def is_notebook(app, pagename, doctree):
    return doctree is not None and str(app.env.doc2path(pagename)).endswith(".ipynb")


def first_words(title):
    """Return the beginning of `introduction`, which identifies it."""
    return f"> This is a page of *{title}*."


def packages_archive():
    """Return the name of the zip of all packages that the notebooks import, or an empty string.

    Its version is that of the newest of them. A book without packages has no zip.
    """
    if not PROJECTS:
        return ""
    stated, _, moment = PROJECTS[-1].version().partition(".dev")
    newest = max([moment, *(project.version().partition(".dev")[2] for project in PROJECTS)])
    return f"{PROJECTS[-1].name}-{stated}{f'.dev{newest}' if newest else ''}.zip"


def introduction(title):
    """Return the note below the title of a page's notebook, as a paragraph of one line."""
    if not PROJECTS:
        return f"{first_words(title)} {LICENCES_SAID}".rstrip()
    return (
        f"{first_words(title)} To run it, install the packages that it imports: download "
        f"`{packages_archive()}` from the page's menu, unpack it, and in its folder `packages` run "
        "`python -m pip install -r requirements.txt`. "
        f"{LICENCES_SAID}"
    ).rstrip()


def make_notebook(app, docname, doctree):
    source = nbformat.read(app.env.doc2path(docname), as_version=4)
    cells, next_source = [], 0

    def add_code(stop):
        """Add the code cells up to ``stop``, including those that the page hides."""
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
    note = introduction(app.config.html_title)
    title, _, rest = cells[0].source.partition("\n\n")
    cells[0].source = "\n\n".join(filter(None, [title, note, rest]))
    for position, cell in enumerate(cells):
        # Do not use random IDs, so that builds are equal.
        cell["id"] = f"cell-{position}"
    return nbformat.v4.new_notebook(cells=cells, metadata=METADATA)


def write_page(app, pagename, templatename, context, doctree):
    context["downloads"] = []
    if not is_notebook(app, pagename, doctree):
        return
    downloads = exercise_downloads if pagename.startswith("exercises/") else chapter_downloads
    context["downloads"] = downloads(app, pagename, doctree)
    source = Path(app.env.doc2path(pagename)).read_text("utf8")
    for name, data in DATA.items():
        if data["package"] in source:
            context["downloads"].append(
                {"path": f"{FOLDER}/{name}.zip", "text": data["text"], "note": data["note"]}
            )


def chapter_downloads(app, pagename, doctree):
    notebook = make_notebook(app, pagename, doctree)
    target = Path(app.outdir) / FOLDER / pagename.rsplit("/", 1)[-1]
    target.parent.mkdir(exist_ok=True)
    nbformat.write(notebook, target.with_suffix(".ipynb"))
    notebook.metadata = {"jupytext": NO_METADATA}
    target.with_suffix(".py").write_text(jupytext.writes(notebook, fmt="py:percent"), "utf8")
    packages = {
        "path": f"{FOLDER}/{packages_archive()}",
        "text": "Packages",
        "note": "the packages that the code imports, and how to install them",
    }
    return [
        {
            "path": notebook_address(pagename),
            "text": "Notebook",
            "note": "for Jupyter, with the prose",
        },
        {
            "path": f"{FOLDER}/{target.name}.py",
            "text": "Python script",
            "note": "the prose as comments",
        },
        *([packages] if PROJECTS else []),
    ]


def exercise_downloads(app, pagename, doctree):
    """Offer an exercise as released, since graders recognise its cells by their metadata."""
    target = Path(app.outdir) / FOLDER / f"{pagename}.ipynb"
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(app.env.doc2path(pagename), target)
    return [
        {
            "path": notebook_address(pagename),
            "text": "Notebook",
            "note": "to answer in Jupyter and hand in",
        },
        {
            "path": f"{FOLDER}/{ARCHIVE}",
            "text": "All exercises",
            "note": "with the package and how to start",
        },
    ]


def pack_exercises(app, exception):
    """Put the archive of all exercises into the site if its content has changed."""
    if exception or app.builder.format != "html" or "exercises" not in REGISTERED:
        return
    archive = Path(app.outdir) / FOLDER / ARCHIVE
    sources = [path for project in PROJECTS for path in project.sources()]
    newest = max(path.stat().st_mtime for path in [*sources, *EXERCISES.glob("*.ipynb")])
    if not archive.exists() or archive.stat().st_mtime < newest:
        if (ready := REPOSITORY / REGISTERED["exercises"]).suffix == ".zip":
            shutil.copyfile(ready, archive)
        else:
            named(REGISTERED["exercises"])(REPOSITORY, archive)


def pack_data(app, exception):
    """Put data into the site as it is in its package, with its licences."""
    if exception or app.builder.format != "html":
        return
    for name, data in DATA.items():
        files = {
            f"{name}/{path.name}": path.read_bytes()
            for path in (REPOSITORY / data["folder"]).iterdir()
        }
        write_zip(Path(app.outdir) / FOLDER / f"{name}.zip", files)


def build_wheels(app, exception):
    """Build our packages into the site, as wheels and all in one zip, named by their versions."""
    if exception or app.builder.format != "html" or not PROJECTS:
        return
    folder = Path(app.outdir) / FOLDER
    wheels = {folder / project.wheel_name(): project for project in PROJECTS}
    archive = folder / packages_archive()
    for outdated in [*folder.glob("*.whl"), *folder.glob(f"{PROJECTS[-1].name}-*.zip")]:
        if outdated not in (*wheels, archive):
            outdated.unlink()
    for wheel, project in wheels.items():
        if not wheel.exists():
            project.build_wheel(folder)
    if not archive.exists():
        files = {f"packages/{wheel.name}": wheel.read_bytes() for wheel in wheels}
        files["packages/requirements.txt"] = "".join(
            f"./{wheel.name}\n" for wheel in wheels
        ).encode()
        write_zip(archive, files)


def note_packages(app, config):
    """Write every page that names the packages again when their version changes."""
    config.take_away_packages = packages_archive()


def setup(app):
    app.add_config_value("take_away_packages", "", "html", str)
    app.connect("config-inited", note_packages)
    app.connect("html-page-context", write_page)
    app.connect("build-finished", build_wheels)
    app.connect("build-finished", pack_exercises)
    app.connect("build-finished", pack_data)
