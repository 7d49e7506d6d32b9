"""A small course for the tests of grading: notebooks with solutions, and students."""

import copy
import io
import json

import nbformat
from trial_course import notebook

from coursework.grading.execution.sandbox import Limits
from coursework.grading.grade import grade
from coursework.grading.judging.journal import Journal
from coursework.grading.judging.laboratory import settle
from coursework.grading.running import Running

#: These limits stop endless code soon, and cost nobody an answer on a busy machine.
LIMITS = Limits(
    cell_seconds=2,
    cell_wall_seconds=60,
    answer_seconds=1,
    answer_wall_seconds=60,
    grace_seconds=0.5,
)


def grade_quietly(submissions, out, solutions, scheduler=None, show=None, **more):
    """Grade within these limits, without output, or with all output in ``show``."""
    return grade(
        submissions,
        out,
        solutions=solutions,
        running=Running(limits=LIMITS, scheduler=scheduler),
        show=show or io.StringIO(),
        **more,
    )


def contents(folder):
    """Return every file that depends only on the submissions."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name not in ("run.log", "lock", "journal.jsonl")
    }


SOURCES = {
    "turns": [
        ("markdown", "# Exercises: turns"),
        (
            "code",
            "import sympy as sm\n"
            "\n"
            "from coursework import check\n"
            "\n"
            "theta, alpha, beta = sm.symbols('theta, alpha, beta')",
        ),
        (
            "code",
            "### BEGIN SOLUTION\n"
            "A_C_N = sm.Matrix([[1, 0, 0], [0, sm.cos(theta), sm.sin(theta)], [0, -sm.sin(theta), "
            "sm.cos(theta)]])\n"
            "### END SOLUTION",
        ),
        (
            "code",
            "check('turns/about-x', A_C_N)\n"
            "### BEGIN HIDDEN TESTS\n"
            "question('turns/about-x', kind='rotation matrix', frames=('A', 'N'), symbols='theta', "
            "turns=[('x', theta)], worth=2, credit={'transposed': 0.5})\n"
            "### END HIDDEN TESTS",
        ),
        ("code", "### BEGIN SOLUTION\nsine = sm.sin(alpha + beta)\n### END SOLUTION"),
        (
            "code",
            "check('turns/sum', sine)\n"
            "### BEGIN HIDDEN TESTS\n"
            "question('turns/sum', kind='expression', symbols='alpha beta', worth=1)\n"
            "### END HIDDEN TESTS",
        ),
        ("code", "### BEGIN SOLUTION\ndef doubled(x):\n    return 2*x\n### END SOLUTION"),
        (
            "code",
            "check('turns/doubled', doubled)\n"
            "### BEGIN HIDDEN TESTS\n"
            "question('turns/doubled', kind='function', calls=[[1.5], [-2.0]], "
            "result='expression', worth=3)\n"
            "### END HIDDEN TESTS",
        ),
    ],
    "axes": [
        ("code", "import sympy as sm\n\nfrom coursework import check\n\nq = sm.symbols('q')"),
        ("code", "### BEGIN SOLUTION\nangle = sm.pi/6\n### END SOLUTION"),
        (
            "code",
            "check('axes/angle', angle)\n"
            "### BEGIN HIDDEN TESTS\n"
            "question('axes/angle', kind='expression', quantity='angle', worth=1)\n"
            "### END HIDDEN TESTS",
        ),
        ("code", "### BEGIN SOLUTION\nlength = sm.sqrt(3)*q\n### END SOLUTION"),
        (
            "code",
            "check('axes/length', length)\n"
            "### BEGIN HIDDEN TESTS\n"
            "question('axes/length', kind='expression', symbols='q', worth=1)\n"
            "### END HIDDEN TESTS",
        ),
    ],
}
RIGHT = {
    "turns/about-x": "A_C_N = sm.Matrix([[1, 0, 0], [0, sm.cos(theta), sm.sin(theta)], [0, "
    "-sm.sin(theta), sm.cos(theta)]])",
    "turns/sum": "sine = sm.sin(alpha)*sm.cos(beta) + sm.cos(alpha)*sm.sin(beta)",
    "turns/doubled": "doubled = lambda x: x + x",
    "axes/angle": "angle = 0.523599",
    "axes/length": "length = sm.sqrt(3*q**2)*sm.sign(q)",
}
SETUP = {"turns": SOURCES["turns"][1][1], "axes": SOURCES["axes"][0][1]}


def write_sources(folder, changes=()):
    """Write the notebooks with solutions; ``changes`` are pairs of texts to replace."""
    folder.mkdir(exist_ok=True)
    for name, cells in SOURCES.items():
        changed = copy.deepcopy(cells)
        for before, after in changes:
            changed = [(kind, source.replace(before, after)) for kind, source in changed]
        nbformat.write(notebook(changed), folder / f"{name}.ipynb")
    return folder


def variable(name):
    return {
        "turns/about-x": "A_C_N",
        "turns/sum": "sine",
        "turns/doubled": "doubled",
        "axes/angle": "angle",
        "axes/length": "length",
    }[name]


def handed_in(assignment="turns", also=(), **answers):
    """Return a student's notebook, right but for the answers given by the end of their name.

    ``also`` are cells at the end.
    """
    cells = [SETUP[assignment]]
    for name, right in RIGHT.items():
        if name.startswith(f"{assignment}/"):
            cells.append(answers.get(name.partition("/")[2].replace("-", "_"), right))
            cells.append(f"check('{name}', {variable(name)})")
    return notebook([*cells, *also])


def put(folder, student, made, name="turns.ipynb"):
    (folder / student).mkdir(parents=True, exist_ok=True)
    path = folder / student / name
    path.write_text(made if isinstance(made, str) else nbformat.writes(made), "utf8")
    return path


def give(store, *records):
    """Give the marks of records that nobody graded."""
    settle(store, Journal(store.folder), records, lambda laboratory: True, "given by a test")


def write_term(out, roster=None, assignments=None, text=""):
    """Write the term in a folder of marks, with its roster and assignments."""
    folder = getattr(out, "folder", out)
    folder.mkdir(parents=True, exist_ok=True)
    lines = ['time-zone = "UTC"', *([f"roster = {json.dumps(str(roster))}"] if roster else [])]
    for name, notebooks in (assignments or {name: [name] for name in SOURCES}).items():
        lines += [f"[assignments.{name}]", f"notebooks = {json.dumps(list(notebooks))}"]
    (folder / "term.toml").write_text("\n".join([*lines, text]) + "\n")
