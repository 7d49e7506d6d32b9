"""From the notebooks with the solutions to everything that a student receives.

A source is a notebook as nbgrader's users know it: ``### BEGIN SOLUTION`` and ``### BEGIN HIDDEN TESTS`` mark
what students do not get. Its cells are run, so that the right answers are what the solutions compute, and
three things are made of it: the exercise notebook with blanks, the file of sealed questions, and, for all
notebooks together, the archive that students download. The same sources give the same bytes.
"""

import ast
import base64
import concurrent.futures
import contextlib
import copy
import hashlib
import html
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import textwrap
import zipfile
from pathlib import Path
from typing import NamedTuple

import coursework

from ..checking.questions import FORMAT
from . import author

REPOSITORY = Path(__file__).resolve().parents[3]
SOURCES = REPOSITORY / "tests" / "solutions"
EXERCISES = REPOSITORY / "exercises"
SEALED = Path(__file__).resolve().parents[1] / "checking" / "sealed"
ARCHIVE = REPOSITORY / "_build" / "exercises.zip"
#: The source whose questions stand inside the chapters: only its sealed file is made.
CHAPTERS = "chapters"

SOLUTION = re.compile(r"^[ \t]*### BEGIN SOLUTION\n(.*?)^[ \t]*### END SOLUTION[ \t]*\n?", re.M | re.S)
HIDDEN = re.compile(r"^[ \t]*### BEGIN HIDDEN TESTS\n.*?^[ \t]*### END HIDDEN TESTS[ \t]*\n?", re.M | re.S)
KERNEL = {"name": "python3", "display_name": "Python 3", "language": "python"}


class Source(NamedTuple):
    """A notebook with solutions, after its cells were run."""

    name: str
    notebook: dict
    questions: dict
    figures: dict


def read_source(path):
    """Run a notebook with solutions and give its questions.

    Raises
    ------
    AuthorError
        A question has no check, a check has no question, or a cell fails.
    """
    import nbformat

    path = Path(path)
    notebook = nbformat.read(path, as_version=4)
    answers, questions, figures = {}, {}, {}

    def record_check(name, answer):
        answers[name] = answer

    def record_question(name, **about):
        if name not in answers:
            raise author.AuthorError(f"{name}: the question stands before its check.")
        if name in questions:
            raise author.AuthorError(f"{name}: there are two questions of this name.")
        if name.partition("/")[0] != path.stem:
            raise author.AuthorError(f"{name}: a question of this notebook is named '{path.stem}/...'.")
        questions[name] = author.question(name, about.pop("kind"), answers[name], **about)

    namespace = {"__name__": "__main__", "question": record_question}
    with _replaced(coursework, "check", record_check):
        for number, cell in enumerate(notebook.cells):
            if cell.cell_type != "code":
                continue
            try:
                value = _run(cell.source, namespace, f"{path.name}, cell {number}")
            except author.AuthorError:
                raise
            except Exception as error:
                raise author.AuthorError(f"{path.name}, cell {number}: {type(error).__name__}: {error}") from error
            if "figure" in cell.metadata.get("tags", []):
                figures[number] = value
    unasked = sorted(set(answers) - set(questions))
    if unasked:
        raise author.AuthorError(f"{path.name}: checks without a question: {', '.join(unasked)}.")
    variables = _checked_names(notebook)
    if len(set(variables.values())) < len(variables):
        raise author.AuthorError(f"{path.name}: two questions have an answer of the same name.")
    for name, question in questions.items():
        question.variable = variables[name]
    return Source(path.stem, notebook, questions, figures)


def read_sources(folder=SOURCES):
    """Give the questions of all sources, by name."""
    return {
        name: question
        for path in sorted(Path(folder).glob("*.ipynb"))
        for name, question in read_source(path).questions.items()
    }


@contextlib.contextmanager
def _replaced(module, name, value):
    before = getattr(module, name)
    setattr(module, name, value)
    try:
        yield
    finally:
        setattr(module, name, before)


def _run(source, namespace, where):
    """Run a cell and give the value of its last line, as a notebook shows it."""
    tree = ast.parse(source, where)
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, where, "exec"), namespace)
    if last is not None:
        return eval(compile(ast.Expression(last.value), where, "eval"), namespace)
    return None


def _checked_names(notebook):
    """The name of the answer of each question, from the calls of ``check``."""
    found = {}
    for cell in notebook.cells:
        if cell.cell_type == "code":
            for node in ast.walk(ast.parse(cell.source)):
                if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "check":
                    name, answer = node.args
                    if not isinstance(answer, ast.Name):
                        raise author.AuthorError(f"{ast.unparse(node)}: the answer of a check is a plain name.")
                    found[name.value] = answer.id
    return found


# --- the exercise notebook ----------------------------------------------------------------------


def exercise_notebook(source):
    """The notebook that students get: no solution, no hidden test, and no code of a figure."""
    import nbformat

    checked = _checked_names(source.notebook)
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
            blanks = [name for region in SOLUTION.findall(cell.source) for name in _bound(region, owners)]
            code = nbformat.v4.new_code_cell(
                HIDDEN.sub("", SOLUTION.sub(lambda region: blank(region[1], owners), cell.source)).rstrip()
            )
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


def _bound(region, owners):
    """The answers that a solution binds, in order."""
    names = []
    for node in ast.parse(_outdent(region)).body:
        if isinstance(node, (ast.FunctionDef,)):
            names.append(node.name)
        elif isinstance(node, ast.Assign):
            names += [target.id for target in node.targets if isinstance(target, ast.Name)]
    return [name for name in names if name in owners]


def blank(region, owners):
    """What stands in place of a solution."""
    functions = {node.name: node for node in ast.parse(_outdent(region)).body if isinstance(node, ast.FunctionDef)}
    lines = []
    for name in dict.fromkeys(_bound(region, owners)):
        if name not in functions:
            lines.append(f"{name} = ...  # your answer\n")
            continue
        function = functions[name]
        lines.append(f"def {name}({ast.unparse(function.args)}):\n")
        if ast.get_docstring(function):
            lines.append(f'    """{ast.get_docstring(function)}"""\n')
        lines.append("    ...  # your code\n")
    return "".join(lines)


def _outdent(region):
    return textwrap.dedent(region)


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
    from orientation_figures.drawing import STYLE

    inner = drawing.svg()
    view = re.search(r'viewBox="(\S+) (\S+) (\S+) (\S+)"', inner)
    left, top, width, height = view.groups()
    picture = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{left} {top} {width} {height}" width="{width}" '
        f'height="{height}" color="#1d2125"><style>{html.escape(STYLE, quote=False)}</style>'
        f'<rect x="{left}" y="{top}" width="{width}" height="{height}" fill="#fff"/>'
        f'<g class="orientation-figure">{inner.replace("<svg ", f"<svg x={chr(34)}{left}{chr(34)} y={chr(34)}{top}{chr(34)} width={chr(34)}{width}{chr(34)} height={chr(34)}{height}{chr(34)} ", 1)}</g></svg>'
    )
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
    paths = sorted(Path(sources).glob("*.ipynb"))
    if not paths:
        raise author.AuthorError(f"There is no notebook in {sources}.")
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


README = """Exercises of Orientation of Reference Frames

1. Install Python 3.11 or newer, then in this folder:

       python -m pip install {wheel} jupyterlab

2. Start it and open a notebook:

       jupyter lab

Answer in place of the dots and run the check below each question. It says whether the answer is right or which
convention was mixed up. Your progress is kept in the folder .coursework beside the notebooks and nowhere else.

When there is a newer archive, do not unpack it over your work. Run

       python -m coursework update exercises.zip

in this folder: it adds what is new and leaves every notebook that you have changed as it is.
"""


def archive(target=ARCHIVE, exercises=EXERCISES):
    """Make the archive for students: the notebooks, the package, and how to start. The same each time."""
    target = Path(target)
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        wheel = build_wheel(folder)
        files = {"README.txt": README.format(wheel=wheel.name).encode("utf8"), wheel.name: wheel.read_bytes()}
        files.update({path.name: path.read_bytes() for path in sorted(Path(exercises).glob("*.ipynb"))})
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as box:
        for name in sorted(files):
            entry = zipfile.ZipInfo(f"exercises/{name}", (2026, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o644 << 16
            box.writestr(entry, files[name])
    return target


def build_wheel(folder):
    """Build the package for students, from a copy: setuptools leaves files behind."""
    with tempfile.TemporaryDirectory() as place:
        for name in ("pyproject.toml", "README.md", "LICENSE", "LICENSE-CODE"):
            shutil.copy(REPOSITORY / name, place)
        for package in ("orientation", "coursework"):
            shutil.copytree(
                REPOSITORY / "src" / package, Path(place, "src", package), ignore=shutil.ignore_patterns("__pycache__")
            )
        subprocess.run(
            [
                sys.executable,
                "-m",
                "pip",
                "wheel",
                "--quiet",
                "--disable-pip-version-check",
                "--no-deps",
                "--no-build-isolation",
                "--wheel-dir",
                folder,
                place,
            ],
            check=True,
            env={**os.environ, "SOURCE_DATE_EPOCH": "1767225600"},
        )
    return next(Path(folder).glob("*.whl"))


def update(archive_file, folder="."):
    """Unpack a newer archive beside a student's work. What the student changed is never touched.

    Returns
    -------
    list of str
        A line for each file: added, the same, or put beside under a new name.
    """
    said = []
    with zipfile.ZipFile(archive_file) as box:
        for entry in sorted(box.namelist()):
            name = Path(entry).name
            if not name or entry.endswith("/"):
                continue
            data, place = box.read(entry), Path(folder, name)
            if not place.exists():
                place.write_bytes(data)
                said.append(f"added       {name}")
            elif place.read_bytes() == data:
                said.append(f"the same    {name}")
            else:
                number = 1
                while (beside := place.with_name(f"{place.stem}-new-{number}{place.suffix}")).exists():
                    if beside.read_bytes() == data:
                        break
                    number += 1
                beside.write_bytes(data)
                said.append(f"kept yours  {name}; the new one is {beside.name}")
    return said
