"""A sample class for trying out grading: right, mistaken, unfinished, broken and hostile notebooks.

Run it with ``python packages/coursework/samples/sample_class.py FOLDER STUDENTS NOTEBOOK ...``. The
file ``expected.json`` beside the notebooks describes their contents, to compare with the results of
grading. The students are fictitious, and the same seed makes the same class.
"""

from __future__ import annotations

import ast
import contextlib
import copy
import io
import json
import os
import random
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from coursework.authoring.course import course_around, find_course
from coursework.authoring.release import KERNEL, exercise_notebook, shows_variants
from coursework.authoring.source import CHAPTERS, answered_in, checked_names, read_source, solved
from coursework.authoring.variation import drawn_in
from coursework.checking.question import Variant
from coursework.checking.variants import numbers_of_variants

if TYPE_CHECKING:
    from nbformat import NotebookNode

    from coursework.authoring.author import AuthoredQuestion
    from coursework.grading.judging.contract import Asked

#: Cells that try to get marks, or to escape. None knows an answer, so none earns anything, and none
#: does damage if it succeeds, since somebody may use this class where students' code is not
#: isolated.
HOSTILE = {
    "replaces the check": "import coursework\ncoursework.check = check = lambda *answers: "
    "'Correct'",
    "leaves": "import os\nos._exit(0)",
    "kills itself": "import os, signal\nos.kill(os.getpid(), signal.SIGKILL)",
    "equals everything": "class Right:\n    def __eq__(self, other):\n        return True\n    def "
    "__hash__(self):\n        return 0\n"
    "sm.Expr.__eq__ = Right.__eq__",
    "changes json": "import json\njson.dumps = json.JSONEncoder.encode = lambda *a, **k: "
    '\'{"outcome": '
    '"correct"}\'',
    "reads and writes files": "for place in ('/etc/passwd', '../grades.csv'):\n    try:\n        "
    "print(open(place).read())\n"
    "    except OSError:\n        pass\ntry:\n    open('/tmp/forged', 'w').write('x')\n"
    "except OSError:\n    pass",
    "calls home": "import socket\ntry:\n    socket.create_connection(('192.0.2.1', 80), 1)\n"
    "except OSError:\n"
    "    pass",
    "forks": "import os\n"
    "for number in range(50):\n"
    "    try:\n"
    "        if os.fork() == 0:\n"
    "            os._exit(0)\n"
    "    except OSError:\n"
    "        pass",
    "fills the memory": "try:\n    much = [bytearray(1 << 26) for number in range(40)]\n"
    "except MemoryError:\n"
    "    pass",
    "writes much": "for number in range(200_000):\n    print('x' * 100)",
    "a name that is code": 'theta = sm.Symbol(\'__import__("os").system("touch /tmp/forged")\')',
    "a script": "_ = check('<script>alert(1)</script>', '<img src=x onerror=alert(1)>')",
    "walks the frames": "import sys\n"
    "frame = sys._getframe()\n"
    "while frame:\n"
    "    frame.f_globals['check'] = frame.f_globals.get('check')\n"
    "    frame = frame.f_back",
    "never ends": "while True:\n    pass",
}


class Part(NamedTuple):
    """A cell in which questions are answered."""

    cell: int
    questions: list[str]


class Written(NamedTuple):
    """An answer as code, with the expected outcome and note."""

    code: str
    expected: tuple[str, str]


class _Exercise:
    """The notebook that students hand in, and how to answer in it."""

    def __init__(self, stems: Iterable[str], folder: Path) -> None:
        import nbformat

        self.edition = getattr(course_around(folder), "edition", "")
        paths = [Path(folder) / f"{stem}.ipynb" for stem in stems]
        sources = [read_source(path, edition=self.edition) for path in paths]
        self.questions = {
            name: [question] for source in sources for name, question in source.questions.items()
        }
        for path, source in zip(paths, sources, strict=True):
            for number in range(1, max((rule.count for rule in source.rules.values()), default=1)):
                for name, question in read_source(path, number, self.edition).questions.items():
                    self.questions[name].append(question)
        self.rules = {name: rule for source in sources for name, rule in source.rules.items()}
        self.cells: list[NotebookNode] = []
        self.parts: list[Part] = []
        self.solved: dict[int, str] = {}
        for source in sources:
            notebook = exercise_notebook(source)
            checked = checked_names(source.notebook)
            owners = {variable: name for name, variable in checked.items()}
            originals = source.notebook.cells
            handed_out = [
                cell
                for number, cell in enumerate(originals)
                if not shows_variants(originals, number)
            ]
            made: set[str] = set()
            for cell, original in zip(notebook.cells, handed_out, strict=True):
                cell = copy.deepcopy(cell)
                if cell.cell_type == "code":
                    if "### BEGIN VARIANTS" in original.source:
                        made = _names_made(original.source) | self._not_given(original.source)
                    answered = [
                        owners[variable] for variable in answered_in(original.source, owners)
                    ]
                    if answered:
                        self.parts.append(Part(len(self.cells), list(dict.fromkeys(answered))))
                        answer = solved(original.source)
                        if not made & _names_in(answer):
                            self.solved[len(self.cells)] = answer
                self.cells.append(cell)
        for number, cell in enumerate(self.cells):
            cell["id"] = f"cell-{number}"
        self.metadata = nbformat.v4.new_notebook(
            metadata={"kernelspec": KERNEL, "language_info": {"name": "python"}}
        )

    def _not_given(self, source: str) -> set[str]:
        """Return what a cell draws for solutions, but a sealed question does not give."""
        drawn = drawn_in(source)
        if drawn is None:
            return set()
        variable, name = drawn
        variants = [question.public.given for question in self.questions[name]]
        return {
            f"{variable}.{pool}"
            for pool in self.rules[name].pools
            if not all(pool in given for given in variants)
        }

    def variant(self, name: str, identity: str) -> int:
        """Return the number of a student's variant of a question."""
        variants = self.questions[name]
        return numbers_of_variants(
            identity, name, variants[0].public.variant or Variant(), len(variants)
        )[0]

    def notebook(self, cells: list[NotebookNode]) -> NotebookNode:
        made: NotebookNode = copy.deepcopy(self.metadata)
        made.cells = cells
        return made


def _names_in(source: str) -> set[str]:
    """Return the names that code uses, with those of attributes as ``name.attribute``."""
    return {
        ast.unparse(node)
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.Name | ast.Attribute)
    }


def _names_made(source: str) -> set[str]:
    """Return what a cell creates that students do not get; they do get what is drawn for them."""
    made: set[str] = set()
    for node in ast.parse(source).body:
        if isinstance(node, ast.FunctionDef):
            made.add(node.name)
        elif isinstance(node, ast.Assign) and "draw" not in _names_in(ast.unparse(node.value)):
            made |= set().union(*(_names_in(ast.unparse(target)) for target in node.targets))
    return made


def code_of(answer: Any) -> str | None:
    """Return Python code for an answer, or ``None`` if a student would not write it."""
    import sympy

    if hasattr(answer, "tolist") and not isinstance(answer, sympy.MatrixBase):
        answer = answer.tolist()
    if isinstance(answer, (str, bool, int, float)):
        return repr(answer)
    if isinstance(answer, (list, tuple)):
        codes = [code_of(part) for part in answer]
        parts = [code for code in codes if code is not None]
        return f"[{', '.join(parts)}]" if len(parts) == len(codes) else None
    if isinstance(answer, sympy.MatrixBase):
        rows = code_of(answer.tolist())
        return rows and f"sm.Matrix({rows})"
    if isinstance(answer, sympy.Expr) and not answer.atoms(sympy.Derivative):
        return f"sm.sympify({sympy.srepr(answer)!r})"
    return None


# --- one answer ---------------------------------------------------------------------------------


def _forms(question: AuthoredQuestion) -> Iterator[Any]:
    """Iterate over the right answer in its author's form and others."""
    import sympy

    answer = question.answer
    yield answer
    if isinstance(answer, (sympy.MatrixBase, sympy.Expr)):
        each = (
            answer.applyfunc
            if isinstance(answer, sympy.MatrixBase)
            else lambda change: change(answer)
        )
        if answer.free_symbols:
            yield each(lambda entry: entry.rewrite(sympy.exp))
            yield each(sympy.expand)
        elif question.public.tolerance is not None:
            yield each(lambda entry: sympy.N(entry, 9))
        if isinstance(answer, sympy.MatrixBase) and 1 not in answer.shape:
            yield answer.tolist()


def _slip(question: AuthoredQuestion) -> Any:
    """Return a wrong answer that no catalogue knows, the same each time."""
    import sympy

    answer = question.answer
    if hasattr(answer, "tolist") and not isinstance(answer, sympy.MatrixBase):
        answer = answer.tolist()
    if isinstance(answer, sympy.MatrixBase):
        changed = sympy.Matrix(answer)
        changed[0] = changed[0] / 3 + sympy.Rational(1, 7)
        return changed
    if isinstance(answer, (sympy.Expr, int, float)) and not isinstance(answer, bool):
        return answer / 3 + sympy.Rational(1, 7)
    if isinstance(answer, (list, tuple)) and answer and isinstance(answer[0], str):
        options = question.public.options or answer
        return [
            next(option for option in options if option != answer[0])
            if len(set(options)) > 1
            else answer[0],
            *answer[1:],
        ]
    if isinstance(answer, (list, tuple)) and answer and isinstance(answer[0], bool):
        return [not answer[0], *answer[1:]]
    return None


class _Answers:
    """Code for right and wrong answers to every question, with their expected outcomes."""

    def __init__(self, exercise: _Exercise, dice: random.Random) -> None:
        from coursework.grading.judging.contract import Asked
        from coursework.grading.judging.marking import contract_of

        self.right: dict[tuple[str, int], list[Written]] = {}
        self.wrong: dict[tuple[str, int], list[Written]] = {}
        for name, variants in exercise.questions.items():
            known = [
                contract_of(question, b"any secret: the class is the same with all")
                for question in variants
            ]
            order = dice.random()
            for number, question in enumerate(variants):
                judged = Asked(known[number], siblings=(*known[:number], *known[number + 1 :]))
                self.right[name, number] = self._with_code(question, judged, _forms(question))
                mistaken = list(
                    {
                        (mistake.note, str(mistake.details)): mistake.answer
                        for mistake in reversed(question.mistakes)
                    }.values()
                )
                # Make some mistakes more frequent in a class, even where its members' numbers
                # differ.
                random.Random(order).shuffle(mistaken)
                self.wrong[name, number] = self._with_code(
                    question, judged, [*mistaken[:6], _slip(question)]
                )

    def _with_code(
        self,
        question: AuthoredQuestion,
        judged: Asked,
        answers: Iterable[Any],
    ) -> list[Written]:
        from coursework.grading.judging.marking import mark
        from coursework.grading.record import Answer

        written: list[Written] = []
        for answer in answers:
            code = code_of(answer) if not callable(answer) else None
            if code is not None:
                given = Answer("recorded", question.to_plain(answer))
                expected = mark(question.name, judged, given)
                outcome = expected.outcome, expected.note
                written.append(Written(f"{question.variable} = {code}", outcome))
        return written


# --- one notebook -------------------------------------------------------------------------------


class _Student:
    """A student who works through the exercise and hands it in."""

    def __init__(
        self, exercise: _Exercise, answers: _Answers, dice: random.Random, identity: str
    ) -> None:
        self.exercise, self.answers, self.dice, self.identity = exercise, answers, dice, identity
        self.cells = copy.deepcopy(exercise.cells)
        for cell in self.cells:
            cell.source = re.sub(
                r"^(# )?student\('(your ID)?'\)",
                lambda found: f"student({identity!r})",
                cell.source,
                flags=re.M,
            )
        self.expected = {name: ["not attempted", ""] for name in exercise.questions}
        self.did: list[str] = []
        skill = dice.betavariate(4, 1.6)
        for part in exercise.parts:
            self.answer(part, skill)

    def answer(self, part: Part, skill: float) -> None:
        chance = self.dice.random()
        first = part.questions[0], self.exercise.variant(part.questions[0], self.identity)
        if chance > 0.94 and len(part.questions) == 1:
            # Leave the question open.
            return
        if chance < skill or len(part.questions) > 1 or not self.answers.wrong[first]:
            self.solve(part)
            return
        name = part.questions[0]
        options = self.answers.wrong[first]
        code, outcome = self.dice.choices(options, [2.0**-order for order in range(len(options))])[
            0
        ]
        self.put(part, code, {name: list(outcome)})

    def solve(self, part: Part) -> None:
        name = part.questions[0]
        forms = self.answers.right[name, self.exercise.variant(name, self.identity)]
        # The author's own way may use names that draw variants, which students do not get.
        share = 0.4 if len(self.exercise.questions[name]) == 1 else 1
        if len(part.questions) == 1 and forms and self.dice.random() < share:
            code, outcome = self.dice.choice(forms)
            self.put(part, code, {name: list(outcome)})
        elif part.cell in self.exercise.solved:
            self.cells[part.cell].source = self.exercise.solved[part.cell]
            self.expected.update({name: ["correct", ""] for name in part.questions})

    def put(self, part: Part, code: str, outcomes: Mapping[str, list[str]]) -> None:
        variable = self.exercise.questions[part.questions[0]][0].variable
        lines = self.cells[part.cell].source.split("\n")
        blank = next(
            (
                order
                for order, line in enumerate(lines)
                if line.startswith((f"{variable} = ...", f"def {variable}("))
            ),
            None,
        )
        if blank is None:
            self.solve(part)
            return
        self.cells[part.cell].source = "\n".join(
            [*lines[:blank], code, *(line for line in lines[blank + 1 :] if "..." not in line)]
        )
        self.expected.update(outcomes)

    # -- alterations of notebooks

    def lose_metadata(self) -> None:
        for cell in self.cells:
            cell.metadata.pop("nbgrader", None)

    def run_out_of_order(self) -> None:
        """Move the first code cell to the end, although it ran first."""
        first = next(order for order, cell in enumerate(self.cells) if cell.cell_type == "code")
        moved = self.cells.pop(first)
        self.cells.append(moved)
        moved.execution_count = 1
        for count, cell in enumerate(
            (cell for cell in self.cells[:-1] if cell.cell_type == "code"), 2
        ):
            cell.execution_count = count

    def break_a_cell(self) -> None:
        part = self.dice.choice([part for part in self.exercise.parts if len(part.questions) == 1])
        self.cells[part.cell].source += "\nprint((unfinished"
        self.expected[part.questions[0]] = ["not attempted", "missing"]

    def check_twice(self) -> None:
        """Copy a cell and its check to the end. The last answer counts, and it is the same."""
        part = self.dice.choice(self.exercise.parts)
        self.cells += copy.deepcopy(self.cells[part.cell : part.cell + 2])

    def join_cells(self) -> None:
        """Put an answer and its check into one cell."""
        for part in sorted(self.exercise.parts, reverse=True):
            if part.cell + 1 < len(self.cells) and "check(" in self.cells[part.cell + 1].source:
                self.cells[part.cell].source += "\n" + self.cells.pop(part.cell + 1).source

    def add_cell(self, source: str) -> None:
        import nbformat

        place = self.dice.choice([part.cell for part in self.exercise.parts])
        cell = nbformat.v4.new_code_cell(source)
        cell["id"] = "cell-added"
        self.cells.insert(place, cell)

    def notebook(self) -> str:
        import nbformat

        for number, cell in enumerate(self.cells):
            cell["id"] = f"cell-{number}"
        return str(nbformat.writes(self.exercise.notebook(self.cells)))


HABITS: tuple[tuple[str, float, Callable[[_Student], None]], ...] = (
    ("without metadata", 0.08, _Student.lose_metadata),
    ("out of order", 0.04, _Student.run_out_of_order),
    ("a broken cell", 0.05, _Student.break_a_cell),
    ("checked twice", 0.06, _Student.check_twice),
    ("joined cells", 0.05, _Student.join_cells),
    (
        "prints",
        0.05,
        lambda student: student.add_cell(
            "import warnings\nwarnings.warn('careful')\n"
            "print(A_C_N) if 'A_C_N' in globals() else None"
        ),
    ),
)


def make_class(
    out: str | Path,
    students: int = 200,
    seed: int = 1,
    notebooks: Sequence[str] = (),
    solutions: str | Path | None = None,
) -> Path:
    """Write a class to a folder, and return the location of its submissions.

    Parameters
    ----------
    out : path
    students : int
    seed : int
    notebooks : list of str
        The exercises that make up the submitted notebook; by default, the first of all.
    solutions : path, optional
    """
    folder = Path(solutions or find_course().sources)
    stems = list(notebooks) or [
        sorted(path.stem for path in folder.glob("*.ipynb") if path.stem != CHAPTERS)[0]
    ]
    dice = random.Random(f"class {seed}")
    # What a solution prints is for its author.
    with contextlib.redirect_stdout(io.StringIO()):
        exercise = _Exercise(stems, folder)
    answers = _Answers(exercise, dice)
    out = Path(out)
    out.mkdir(parents=True, exist_ok=True)
    files: dict[str, bytes] = {}
    expected: dict[str, dict[str, object]] = {}
    hostile = dict(
        zip(dice.sample(range(students), min(students // 14 or 1, len(HOSTILE))), HOSTILE)
    )
    left = [number for number in range(students) if number not in hostile]
    broken = dict(
        zip(
            dice.sample(left, min(students // 50, 4)),
            ("half a file", "two entries of one name", "empty", "no notebook"),
        )
    )
    for number in range(students):
        student = f"student-{number + 1:03}"
        work = _Student(exercise, answers, dice, student)
        for name, share, habit in HABITS:
            if dice.random() < share and number not in hostile:
                habit(work)
                work.did.append(name)
                break
        if number in hostile:
            work.add_cell(HOSTILE[hostile[number]])
            work.did.append(f"hostile: {hostile[number]}")
        data = work.notebook().encode("utf8")
        if number in broken:
            data = {
                "half a file": data[: len(data) // 2],
                "two entries of one name": data.replace(b"{", b'{"cells": [], ', 1),
                "empty": b"",
                "no notebook": b"PK\x03\x04 a text in another format",
            }[broken[number]]
            work.did.append(f"refused: {broken[number]}")
        files[student] = data
        expected[student] = {"did": work.did, "questions": work.expected}
    (out / "expected.json").write_text(json.dumps(expected, indent=1) + "\n", "utf8")
    worth = sum(variants[0].worth for variants in exercise.questions.values())
    (out / "gradebook.csv").write_text(_gradebook(list(files), worth), "utf8", newline="")
    return _folders(out, files, "-and-".join(stems))


# --- ways of handing it out ---------------------------------------------------------------------


def _folders(out: Path, files: Mapping[str, bytes], name: str) -> Path:
    place = out / "submissions"
    for student, data in files.items():
        folder = place / student
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"{name}.ipynb").write_bytes(data)
    if "student-001" in files and not (place / "student-000").exists():
        (place / "student-000").mkdir()
        os.symlink("../student-001", place / "student-000" / "copied")
    return place


def _gradebook(students: Sequence[str], worth: float) -> str:
    """Return a Canvas gradebook, with one more student, who handed in nothing."""
    lines = [
        "Student,ID,SIS User ID,SIS Login ID,Section,Exercises (4711),Final Score",
        f"    Points Possible,,,,,{worth},(read only)",
    ]
    for number, student in enumerate([*students, f"student-{len(students) + 1:03}"], 100_001):
        first, last = student.title().split("-")
        lines.append(f'"{last}, {first}",{number},S{number},{student},Section 1,,')
    return "\r\n".join([*lines, ""])


if __name__ == "__main__":
    out, number, *named = sys.argv[1:]
    print(f"{number} students in {make_class(out, int(number), notebooks=named)}")
