"""From the notebooks with the solutions to the exercises that students get, and the questions sealed for them.

The cells of each source are run, so that the right answers are what the solutions compute, and two things are
made of it: the exercise notebook with blanks, and the file of sealed questions. The same sources give the same
bytes. :mod:`coursework.authoring.packing` makes the archive that students download.
"""

import base64
import concurrent.futures
import copy
import hashlib
import html
import json
import os
import re
import tempfile
from pathlib import Path

from ..checking.questions import FORMAT
from .source import CHAPTERS, REPOSITORY, SOURCES, answered_in, checked_names, notebooks_in, posed, read_source

EXERCISES = REPOSITORY / "exercises"
SEALED = REPOSITORY / "src" / "orientation_course" / "sealed"

KERNEL = {"name": "python3", "display_name": "Python 3", "language": "python"}


# --- the exercise notebook ----------------------------------------------------------------------


def exercise_notebook(source):
    """The notebook that students get: no solution, no hidden test, and no code of a figure."""
    import nbformat

    checked = checked_names(source.notebook)
    owners = {variable: name for name, variable in checked.items()}
    cells = []
    for number, cell in enumerate(source.notebook.cells):
        cell = copy.deepcopy(cell)
        cell.metadata = {}
        if number in source.figures:
            cells.append(nbformat.v4.new_markdown_cell(_image(source.figures[number])))
        elif cell.cell_type == "markdown":
            cells.append(nbformat.v4.new_markdown_cell(cell.source))
        else:
            blanks = answered_in(cell.source, owners)
            code = nbformat.v4.new_code_cell(posed(cell.source, owners))
            graded = [
                source.questions[name]
                for name, variable in checked.items()
                if re.search(rf"check\(\s*['\"]{re.escape(name)}['\"]", code.source)
            ]
            if blanks:
                code.metadata["nbgrader"] = _nbgrader(code, _identifier(owners[blanks[0]]), solution=True)
            elif graded:
                code.metadata["nbgrader"] = _nbgrader(
                    code, f"check-{_identifier(graded[0].name)}", points=sum(question.worth for question in graded)
                )
            cells.append(code)
    for number, cell in enumerate(cells):
        cell["id"] = f"cell-{number}"
    return nbformat.v4.new_notebook(cells=cells, metadata={"kernelspec": KERNEL, "language_info": {"name": "python"}})


def _identifier(name):
    return name.replace("/", "-")


def _nbgrader(cell, identifier, solution=False, points=None):
    """Metadata of nbgrader's schema 3, as its own release step writes it."""
    about = {
        "schema_version": 3,
        "grade": points is not None,
        "grade_id": identifier,
        "locked": points is not None,
        "solution": solution,
        "task": False,
        "cell_type": cell.cell_type,
    }
    if points is not None:
        about["points"] = points
    about["checksum"] = _checksum(cell, about)
    return about


def _checksum(cell, about):
    # As nbgrader.utils.compute_checksum; a test compares the two.
    parts = [
        cell.source,
        cell.cell_type,
        *(str(about[key]) for key in ("grade", "solution", "locked")),
        about["grade_id"],
    ]
    if about["grade"]:
        parts.append(str(float(about["points"])))
    digest = hashlib.md5()
    for part in parts:
        digest.update(part.encode("utf8"))
    return digest.hexdigest()


def _image(drawing):
    """A figure as Markdown: its picture, on white paper of its own, and its text for those who do not see it."""
    picture = drawing.picture()
    width = re.search(r'width="(\S+)"', picture)[1]
    data = base64.b64encode(picture.encode("utf8")).decode("ascii")
    # As HTML: Markdown readers that are careful refuse this kind of address in an image of their own.
    return f'<p><img alt="{html.escape(drawing.alt)}" width="{width}" src="data:image/svg+xml;base64,{data}"></p>'


def run_notebook(notebook, folder):
    """Run an exercise notebook, blanks and all, and keep what it shows."""
    from nbclient import NotebookClient

    client = NotebookClient(notebook, timeout=120, kernel_name="python3", resources={"metadata": {"path": str(folder)}})
    client.execute()
    for cell in notebook.cells:
        cell.metadata.pop("execution", None)
    notebook.metadata = {"kernelspec": KERNEL, "language_info": {"name": "python"}}


# --- all of it ----------------------------------------------------------------------------------


def sealed_file(source):
    """The text of the file with the sealed questions of a notebook."""
    questions = {
        name: {"answer": question.variable, **question.sealed()} for name, question in source.questions.items()
    }
    return json.dumps({"format": FORMAT, "questions": questions}, indent=0, sort_keys=True, ensure_ascii=False) + "\n"


def _release_one(path, exercises, sealed):
    import nbformat

    source = read_source(path)
    Path(sealed, f"{source.name}.json").write_text(sealed_file(source), "utf8")
    if source.name != CHAPTERS:
        nbformat.write(exercise_notebook(source), Path(exercises, f"{source.name}.ipynb"))
    return source.name


def _run_one(path):
    import nbformat

    notebook = nbformat.read(path, as_version=4)
    with tempfile.TemporaryDirectory() as folder:
        run_notebook(notebook, folder)
    nbformat.write(notebook, path)


def release(sources=SOURCES, exercises=EXERCISES, sealed=SEALED, run=True):
    """Make the exercise notebooks and the sealed questions.

    Parameters
    ----------
    sources, exercises, sealed : path
    run : bool
        Whether to run the exercise notebooks, so that they show what an untouched notebook shows. They are
        run with the sealed questions of the installed package.
    """
    paths = notebooks_in(sources)
    for folder in (exercises, sealed):
        Path(folder).mkdir(parents=True, exist_ok=True)
    with concurrent.futures.ProcessPoolExecutor(os.cpu_count()) as pool:
        names = list(pool.map(_release_one, paths, [exercises] * len(paths), [sealed] * len(paths)))
        for folder, suffix in ((exercises, ".ipynb"), (sealed, ".json")):
            for path in Path(folder).glob(f"*{suffix}"):
                if path.stem not in names:
                    path.unlink()  # its source is gone
        if run:
            list(pool.map(_run_one, sorted(Path(exercises).glob("*.ipynb"))))
    return names


def differences(first, second, pattern):
    """Names of the files of two folders that are not the same in both."""
    names = {path.name for folder in (first, second) for path in Path(folder).glob(pattern)}
    return sorted(
        name
        for name in names
        if not (Path(first, name).is_file() and Path(second, name).is_file())
        or Path(first, name).read_bytes() != Path(second, name).read_bytes()
    )
