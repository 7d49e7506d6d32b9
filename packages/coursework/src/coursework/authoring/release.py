"""Release: from notebooks with solutions to students' exercises and sealed questions.

We run the cells of each source, so that the right answers are those that the solutions compute, and
make two files: the exercise notebook with blanks, and the sealed questions. The same sources give
the same bytes. `coursework.authoring.packing` makes the archive that students download.
"""

from __future__ import annotations

import contextlib
import copy
import hashlib
import json
import platform
import re
import shutil
import tempfile
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from importlib import metadata
from pathlib import Path
from typing import Any, NamedTuple

import nbformat
from nbformat import NotebookNode

from ..checking import fields, sealing
from ..checking.evaluate import MP
from ..checking.identity import PLACEHOLDER
from ..checking.question import FORMAT
from ..checking.questions import NOTEBOOK, beside, salt_of_all
from ..checking.reading import canonical, read
from ..checking.variants import image
from .author import AuthoredQuestion, AuthorError, Pages, solution_code
from .closed import Asked, asked_in
from .course import Course
from .selftest import secrets_of, told_openly, try_question
from .source import (
    CHAPTERS,
    Source,
    answered_in,
    checked_names,
    digest_of_code,
    files_of,
    names_asked,
    notebooks_in,
    posed,
    processes_for,
    read_source,
)
from .variation import drawn_in

#: A question without variants has a multiple of this many lockers.
TOGETHER = 8
#: The line that asks students for their ID, and its replacement in a course without a roster.
ASKS_WHO = re.compile(r"""^student\((?:''|"")\).*$""", re.M)
LEFT_OPEN = f"# student({PLACEHOLDER!r})  # if your course gave you one"
METADATA = {
    "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
    # Without the exporter, nbconvert writes a script as a text file, and leaves out our words.
    "language_info": {"name": "python", "nbconvert_exporter": "python"},
}


class AboutAnswer(NamedTuple):
    """An answer to compare variants by, and the names under which other students find it."""

    answer: str
    names: list[str]

    @classmethod
    def from_json(cls, content: object, where: str) -> AboutAnswer:
        answer, names = fields.a_list(content, where)
        return cls(fields.text(answer, where), list(fields.many(fields.text)(names, where)))


class Made(NamedTuple):
    """The results of releasing a notebook.

    Attributes
    ----------
    name : str
    variants : int
        The number of variants.
    pages : dict of Pages
        The pages that its variants share, by question.
    code : str
        The code of the worked solutions.
    answers : dict of AboutAnswer
        The answers, by question with variants.
    after : dict of list of str
        The questions that each gives hints for.
    asked : dict of Asked
        What is to be counted of each question.
    """

    name: str
    variants: int
    pages: dict[str, Pages]
    code: str
    answers: dict[str, AboutAnswer]
    after: dict[str, list[str]]
    asked: dict[str, Asked]


# --- the exercise notebook ----------------------------------------------------------------------


def shows_variants(cells: Sequence[NotebookNode], number: int) -> bool:
    """Check whether a cell is the text of a question with variants, which the cell before shows."""
    return (
        number > 0
        and cells[number].cell_type == "markdown"
        and drawn_in(cells[number - 1].source) is not None
    )


def exercise_notebook(source: Source, roster: bool = False) -> NotebookNode:
    """Return the students' notebook, without solutions, hidden tests or the code of figures.

    It asks for the student's ID if the course has a ``roster``.
    """
    checked = checked_names(source.notebook)
    owners = {variable: name for name, variable in checked.items()}
    cells = []
    for number, cell in enumerate(source.notebook.cells):
        cell = copy.deepcopy(cell)
        cell.metadata = {}
        if shows_variants(source.notebook.cells, number):
            continue
        elif number in source.figures:
            figure = source.figures[number]
            cells.append(nbformat.v4.new_markdown_cell(image(figure.picture(), figure.alt)))
        elif cell.cell_type != "code":
            cells.append(cell)
        else:
            blanks = answered_in(cell.source, owners)
            text = posed(cell.source, owners)
            code = nbformat.v4.new_code_cell(text if roster else ASKS_WHO.sub(LEFT_OPEN, text))
            graded = [
                source.questions[name]
                for name, variable in checked.items()
                if re.search(rf"check\(\s*['\"]{re.escape(name)}['\"]", code.source)
            ]
            if blanks:
                answered = _identifier(owners[blanks[0]])
                code.metadata["nbgrader"] = _nbgrader(code, answered, solution=True)
            elif graded:
                points = sum(question.worth for question in graded)
                checked_first = f"check-{_identifier(graded[0].name)}"
                code.metadata["nbgrader"] = _nbgrader(code, checked_first, points=points)
            cells.append(code)
    for number, cell in enumerate(cells):
        cell["id"] = f"cell-{number}"
    made: NotebookNode = nbformat.v4.new_notebook(cells=cells, metadata=METADATA)
    return made


def _identifier(question: str) -> str:
    """Return the name of a question as nbgrader allows it."""
    return question.replace("/", "-")


def _nbgrader(
    cell: NotebookNode, identifier: str, solution: bool = False, points: float | None = None
) -> dict[str, Any]:
    """Return metadata of nbgrader's schema 3, as its own release step writes it."""
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


def _checksum(cell: NotebookNode, about: Mapping[str, Any]) -> str:
    # This follows nbgrader.utils.compute_checksum; a test compares the two.
    parts = [
        cell.source,
        cell.cell_type,
        *(str(about[key]) for key in ("grade", "solution", "locked")),
        about["grade_id"],
    ]
    if about["grade"]:
        parts.append(str(float(about["points"])))
    return hashlib.md5("".join(parts).encode("utf8")).hexdigest()


def run_notebook(notebook: NotebookNode, folder: str | Path) -> None:
    """Run an exercise notebook with its blanks, and keep the outputs."""
    from nbclient import NotebookClient
    from nbclient.exceptions import CellExecutionError

    client = NotebookClient(
        notebook,
        timeout=120,
        kernel_name="python3",
        resources={"metadata": {"path": str(folder)}},
        # Hide the kernel's warning about its own sockets, which are on this machine.
        extra_arguments=["--IPKernelApp.log_level=ERROR"],
    )
    try:
        client.execute()
    except CellExecutionError as error:
        raise AuthorError(
            f"The notebook for students does not run with its blanks empty: {error.ename}: "
            f"{error.evalue.rstrip('.')}. "
            + (
                "Students do not get the files beside your notebook. Put the data or the "
                "functions into a cell, or use them only in solutions and hidden tests. "
                if error.ename in ("FileNotFoundError", "ModuleNotFoundError")
                else "Does a cell outside the solutions use an answer? "
            )
            + error.traceback.partition("\n\n\n")[0]
        ) from None
    for cell in notebook.cells:
        cell.metadata.pop("execution", None)
    notebook.metadata = nbformat.from_dict(METADATA)


# --- the release --------------------------------------------------------------------------------


def sealed_file(
    source: Source,
    first: Mapping[str, dict[str, Any]] | None = None,
    pages: Mapping[str, Pages] | None = None,
) -> str:
    """Return a notebook's sealed file as text; for a variant, the difference from ``first``.

    ``pages`` are those of the first variant, by the name of the question.
    """
    code = solution_code(source.notebook)
    questions = {
        name: question.sealed(code, pages[name] if pages else None).as_json()
        for name, question in source.questions.items()
    }
    if first:
        questions = {name: beside(sealed, first[name]) for name, sealed in questions.items()}
    return _as_text({"format": FORMAT, "questions": questions})


def _as_text(content: Mapping[str, object]) -> str:
    return json.dumps(content, indent=0, sort_keys=True, ensure_ascii=False) + "\n"


def _release_one(path: Path, course: Course) -> Made:
    """Make a notebook and its sealed questions."""
    source = read_source(path, edition=course.edition)
    for name, question in source.questions.items():
        openly = told_openly(question, secrets_of(source)) if question.ladder else []
        for fault in [*question.slips, *openly]:
            raise AuthorError(f"{name}, in {path.name}: {fault}")
    if source.rules and not source.asks_who and source.name != CHAPTERS:
        raise AuthorError(
            f"{path.name}: all students would get the same numbers, since the notebook never calls "
            '`student`. Near the top, add a cell `student("")`, with `from coursework import '
            "check, hint, student, variant` above it."
        )
    (course.sealed / f"{source.name}.json").write_text(sealed_file(source), "utf8")
    if source.name != CHAPTERS:
        nbformat.write(
            exercise_notebook(source, course.roster), course.exercises / f"{source.name}.ipynb"
        )
    with_variants = {name: source.questions[name] for name in source.rules}
    return Made(
        source.name,
        max((rule.count for rule in source.rules.values()), default=1),
        {name: question.pages for name, question in with_variants.items()},
        solution_code(source.notebook),
        {name: _about_answer(question) for name, question in with_variants.items()},
        {
            name: list(question.after)
            for name, question in source.questions.items()
            if question.after
        },
        asked_in(source),
    )


def _about_answer(question: AuthoredQuestion) -> AboutAnswer:
    return AboutAnswer(_answer_of(question), question.names_for_others())


def _answer_of(question: AuthoredQuestion) -> str:
    """Return a short form of an answer, the same whatever points a variant compares it at."""
    public = replace(question.public, salt=question.name)
    reading = read(public, question.plain)
    return reading.text or " ".join(MP.nstr(number, 9) for number in canonical(public, reading))


def _demand_answers(answers: Sequence[Mapping[str, AboutAnswer]]) -> None:
    """Reject variants with one answer, since a classmate's would be right for everybody."""
    for question in answers[0]:
        all_answers = [variant[question].answer for variant in answers if question in variant]
        if len(all_answers) > 1 and len(set(all_answers)) == 1:
            raise AuthorError(
                f"{question}: all of its {len(all_answers)} variants have the same answer, "
                f"{all_answers[0][:60]}. Vary something that the answer depends on, or ask the "
                "question without variants."
            )


def _demand_later(course: Course, after: Mapping[str, Iterable[str]]) -> None:
    """Reject hints for a later question that no notebook asks."""
    for question, later in after.items():
        for name in later:
            file = course.sources / f"{name.partition('/')[0]}.ipynb"
            if not file.is_file() or name not in names_asked(file):
                raise AuthorError(
                    f"{question}: `after` names '{name}', but no notebook asks that question."
                )


def _release_variant(
    path: Path, number: int, pages: Mapping[str, Pages], course: Course
) -> dict[str, AboutAnswer]:
    """Solve, test and seal one variant of a notebook's questions.

    The results are stored beside the archive, under a name that depends on everything they are made
    from: the source with the files beside it, our code, the versions of the packages that compute
    the answers, and the pages of the first variant, which theirs refer to.
    """
    first = (course.sealed / f"{path.stem}.json").read_text("utf8")
    digest = hashlib.sha256(
        "\n".join([course.edition, str(number), digest_of_code(), *_versions(), first]).encode()
    )
    digest.update(b"".join(files_of(path).values()))
    kept = (
        course.archive.parent / "variants" / f"{path.stem}-{number}-{digest.hexdigest()[:16]}.json"
    )
    answers = kept.with_name(f"{kept.stem}-answers.json")
    if not (kept.exists() and answers.exists()):
        source = read_source(path, number, course.edition)
        for name, question in source.questions.items():
            faults = try_question(question, against_sealed=False).faults
            if faults:
                raise AuthorError(
                    f"{name}, variant {number}, {dict(question.public.given)}: {faults[0]}"
                )
        kept.parent.mkdir(parents=True, exist_ok=True)
        for outdated in kept.parent.glob(f"{path.stem}-{number}-*.json"):
            outdated.unlink()
        kept.write_text(sealed_file(source, json.loads(first)["questions"], pages), "utf8")
        answers.write_text(
            json.dumps(
                {name: _about_answer(question) for name, question in source.questions.items()}
            ),
            "utf8",
        )
    target = course.sealed / "variants" / f"{path.stem}-{number}.json"
    target.parent.mkdir(exist_ok=True)
    shutil.copyfile(kept, target)
    return fields.by_name(AboutAnswer.from_json)(
        json.loads(answers.read_text("utf8")), str(answers)
    )


def _versions() -> Iterator[str]:
    """Return the installed versions of the packages that compute the answers."""
    yield platform.python_version()
    for name in ("mpmath", "sympy", "numpy", "scipy", "matplotlib"):
        with contextlib.suppress(metadata.PackageNotFoundError):
            yield f"{name} {metadata.version(name)}"


def _even_out(name: str, code: str, course: Course) -> None:
    """Add empty lockers, so that nearly all variants of a question have equally many.

    The number depends on the answer: on the mistakes that lead to the same one, and on how near the
    edges of their cells the numbers are. Over sixteen variants, that would identify a right formula
    without any slow hash.
    """
    first = course.sealed / f"{name}.json"
    variants = sorted((course.sealed / "variants").glob(f"{name}-*.json"))
    files = [first, *(path for path in variants if path.stem.removeprefix(f"{name}-").isdigit())]
    contents = [json.loads(file.read_text("utf8")) for file in files]
    for question in contents[0]["questions"]:
        ones = [content["questions"].get(question, {}) for content in contents]
        ones = [variant for variant in ones if variant.get("lockers")]
        if not ones:
            # This is an exam's question, or a text that a person reads.
            continue
        counts = sorted(sealing.count_of(variant["lockers"]) for variant in ones)
        # Filling up to the maximum would make every variant's file as large as the largest.
        most = counts[-2] if len(counts) > 2 else -(-counts[-1] // TOGETHER) * TOGETHER
        for variant in ones:
            variant["lockers"] = sealing.filled_up(
                variant["lockers"], most, f"{code} {variant['salt']}"
            )
        # Do the same with the pages that each variant has in addition to those of the first.
        own = [variant for variant in ones[1:] if contents[0]["questions"][question].get("pages")]
        most = max((len(variant.get("pages") or ()) for variant in own), default=0)
        for variant in own if most else ():
            variant["pages"] = sealing.pages_filled_up(
                variant.get("pages") or [], most, f"{code} {variant['salt']}"
            )
    for file, content in zip(files, contents, strict=True):
        file.write_text(_as_text(content), "utf8")


def _add_names_for_others(
    name: str, answers: Sequence[Mapping[str, AboutAnswer]], course: Course
) -> None:
    """Seal all variants' answers with the first one, so that a classmate's answer is recognised."""
    file = course.sealed / f"{name}.json"
    content = json.loads(file.read_text("utf8"))
    for question in answers[0]:
        names = [
            bytes.fromhex(text)
            for variant in answers
            if question in variant
            for text in variant[question].names
        ]
        if names:
            content["questions"][question]["others"] = [
                salt_of_all(question),
                sealing.pack_names(names, TOGETHER),
            ]
    file.write_text(_as_text(content), "utf8")


def _run_one(path: Path, sealed: Path) -> None:
    notebook = nbformat.read(path, as_version=4)
    with tempfile.TemporaryDirectory() as folder:
        # Place the sealed questions beside the notebook, as for a course without a package for
        # them.
        shutil.copytree(sealed, Path(folder, "sealed"))
        run_notebook(notebook, folder)
    nbformat.write(notebook, path)


def release(
    course: Course,
    only: Collection[str] = (),
    run: bool = True,
    variants: Collection[int] | None = None,
) -> list[Made]:
    """Make the exercise notebooks and the sealed questions.

    Parameters
    ----------
    course : Course
    only : sequence of str
        The names of the notebooks to make; all of them if empty.
    run : bool
        Whether to run the exercise notebooks, so that they have the outputs of an untouched
        notebook.
    variants : collection of int, optional
        The variants to make; by default all.

    Returns
    -------
    list of Made
        The notebooks that were made.

    Raises
    ------
    AuthorError
        A question is not well posed, or the folders contain files that these sources do not make.
        We delete no such file.
    """
    _demand_sources(course, {path.stem for path in notebooks_in(course.sources)})
    paths = notebooks_in(course.sources, only)
    if unfit := [path.name for path in paths if not NOTEBOOK.fullmatch(path.stem)]:
        raise AuthorError(
            f"{unfit[0]}: rename this notebook, and its questions in it. A name such as week-2 "
            "consists of at most 60 letters from a to z in lower case, digits and hyphens."
        )
    for folder in (course.exercises, course.sealed):
        folder.mkdir(parents=True, exist_ok=True)
    with processes_for(paths) as pool:
        made = list(pool.map(_release_one, paths, [course] * len(paths)))
        wanted = [
            (path, number, notebook.pages)
            for path, notebook in zip(paths, made, strict=True)
            for number in range(1, notebook.variants)
            if variants is None or number in variants
        ]
        answers = {path: [notebook.answers] for path, notebook in zip(paths, made, strict=True)}
        if wanted:
            solved = pool.map(_release_variant, *zip(*wanted, strict=True), [course] * len(wanted))
            for (path, *_), more in zip(wanted, solved, strict=True):
                answers[path].append(more)
        # A few variants may have the same answer by chance, so compare only if all are made.
        if variants is None:
            for path in paths:
                _demand_answers(answers[path])
        _demand_later(
            course,
            {question: later for notebook in made for question, later in notebook.after.items()},
        )
        for notebook in made:
            for path in (course.sealed / "variants").glob(f"{notebook.name}-*.json"):
                number = path.stem.removeprefix(f"{notebook.name}-")
                if re.fullmatch(r"\d+", number) and int(number) >= notebook.variants:
                    # This notebook made the file when it had more variants.
                    path.unlink()
            _even_out(notebook.name, notebook.code, course)
            _add_names_for_others(
                notebook.name, answers[course.sources / f"{notebook.name}.ipynb"], course
            )
        if run:
            exercises = [
                course.exercises / f"{notebook.name}.ipynb"
                for notebook in made
                if notebook.name != CHAPTERS
            ]
            list(pool.map(_run_one, exercises, [course.sealed] * len(exercises)))
    return made


def _demand_sources(course: Course, known: Collection[str]) -> None:
    """Reject a folder that contains another course's exercises, so that none are lost."""
    others = [
        path
        for folder, suffix in ((course.exercises, ".ipynb"), (course.sealed, ".json"))
        for path in sorted(folder.glob(f"*{suffix}"))
        if path.stem not in known
    ]
    if others:
        raise AuthorError(
            f"No notebook in {course.sources} makes {', '.join(map(str, others))}. We changed "
            "nothing. Delete the files you no longer want, or name other folders."
        )


def differences(first: str | Path, second: str | Path, pattern: str) -> list[str]:
    """Return the names of the files that differ between two folders."""
    names = {path.name for folder in (first, second) for path in Path(folder).glob(pattern)}
    return sorted(
        name
        for name in names
        if not (Path(first, name).is_file() and Path(second, name).is_file())
        or Path(first, name).read_bytes() != Path(second, name).read_bytes()
    )
