"""The site of a course: its exercises as pages whose cells run and whose answers are checked there.

The package that makes courses offers its files (notebooks, wheels, the archive for students) by the
entry point ``coursework.pages`` and knows nothing about pages; this module knows nothing about
questions. It writes a book for these files in a workshop folder and builds it.
"""

import json
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import nbformat

# The source of this package, if this is a working copy.
WORKING_COPY = Path(__file__).resolve().parents[4]
SETTINGS = Path(__file__).with_name("course.yml")
# The format of the parts: see ``parts_of`` in ``coursework.authoring.publish``.
FORMAT = 1
INDEX = """# {title}

{links}

Each page checks your answers: replace the dots with your answer and run the cell. Your answers stay
in your browser. To work on your own machine, download
<a href="take-away/exercises.zip">all exercises</a>; their `README.txt` explains how to begin.

<!-- whole-book -->
"""


def publish(parts, workshop, site):
    """Make the folder ``site``.

    Raises
    ------
    ValueError
        The parts have another format.
    RuntimeError
        The pages could not be made; the printed messages say why.
    """
    if parts["format"] != FORMAT:
        raise ValueError(
            f"the parts of the course have format {parts['format']}, but these pages need format "
            f"{FORMAT}. Install coursework and notebook-pages from the same edition"
        )
    named = os.environ.get("NOTEBOOK_PAGES_FETCHED")
    places = [Path(named).resolve()] if named else [Path.cwd(), WORKING_COPY]
    fetched = next((place for place in places if (place / "node_modules" / "katex").is_dir()), None)
    if fetched is None:
        raise RuntimeError(
            f"KaTeX, the typefaces and Python for browsers are not in {places[0]}. Run `python -m "
            "notebook_pages.set_up` in that folder to download them."
        )
    workshop, site = Path(workshop).resolve(), Path(site).resolve()
    write_book(parts, workshop)
    environment = os.environ | {
        "NOTEBOOK_PAGES_FETCHED": str(fetched),
        "PYTHONPATH": os.pathsep.join(
            filter(None, [str(workshop / "packages"), os.environ.get("PYTHONPATH")])
        ),
    }
    done = subprocess.run(
        [sys.executable, "-m", "notebook_pages.build"], cwd=workshop, env=environment
    )
    if done.returncode:
        raise RuntimeError("The pages of the course could not be built: see above.")
    if site.exists():
        shutil.rmtree(site)
    shutil.copytree(workshop / "_build" / "html", site)


def write_book(parts, workshop):
    """Write the sources of the site, and keep what an earlier build left for the next one."""
    workshop.mkdir(parents=True, exist_ok=True)
    for outdated in ("exercises", "packages", "wheels"):
        shutil.rmtree(workshop / outdated, ignore_errors=True)
    for made in ("exercises", "packages", "wheels"):
        (workshop / made).mkdir()
    shutil.copy(parts["archive"], workshop / "exercises.zip")
    links = []
    for notebook in parts["notebooks"]:
        shutil.copy(notebook, workshop / "exercises")
        links.append(f"- [{title_of(notebook)}](exercises/{notebook.name})")
    tables = [_wheel_table(Path(wheel), workshop) for wheel in parts["wheels"]]
    quoted = json.dumps(parts["title"])
    (workshop / "pyproject.toml").write_text(
        f"[tool.notebook-pages]\nname = {json.dumps(_name(parts['title']))}\n"
        f"plugin = {json.dumps(parts['plugin'])}\n"
        'exercises = "exercises.zip"\n' + "".join(tables),
        "utf8",
    )
    (workshop / "_config.yml").write_text(
        SETTINGS.read_text("utf8").format(title=quoted, author='""'), "utf8"
    )
    chapters = "".join(
        f"      - file: exercises/{notebook.stem}\n" for notebook in parts["notebooks"]
    )
    (workshop / "_toc.yml").write_text(
        f"format: jb-book\nroot: index\nparts:\n  - caption: Exercises\n    chapters:\n{chapters}",
        "utf8",
    )
    (workshop / "index.md").write_text(
        INDEX.format(title=parts["title"], links="\n".join(links)), "utf8"
    )


def _wheel_table(wheel, workshop):
    """Return the book's settings for a wheel.

    Its packages are unpacked in the workshop, where the build tries the cells.
    """
    shutil.copy(wheel, workshop / "wheels")
    with zipfile.ZipFile(wheel) as box:
        box.extractall(workshop / "packages")
        tops = {name.partition("/")[0] for name in box.namelist()}
    packages = [
        f"packages/{top}" for top in sorted(tops) if not top.endswith((".dist-info", ".data"))
    ]
    return (
        f'\n[[tool.notebook-pages.wheels]]\nfile = "wheels/{wheel.name}"\n'
        f"packages = {json.dumps(packages)}\n"
    )


def _name(title):
    return (
        "-".join("".join(letter if letter.isalnum() else " " for letter in title.lower()).split())
        or "course"
    )


def title_of(notebook):
    """Return the heading of a notebook, or its name if it has none."""
    for cell in nbformat.read(notebook, as_version=4).cells:
        if cell.cell_type == "markdown" and cell.source.startswith("# "):
            return cell.source.splitlines()[0].removeprefix("# ").strip()
    return notebook.stem
