"""What one door takes, all take: an answer on a laptop, on a page, in
JupyterLite and before the grader.
"""

import ast
import inspect
import re
from functools import cache

import doors
import nbformat
import pytest
from places import REPOSITORY

import orientation
from coursework.authoring import variation
from coursework.authoring.course import find_course
from coursework.authoring.source import HIDDEN
from coursework.checking.points import spellings
from coursework.checking.questions import notebook_questions
from coursework.checking.variants import Given
from coursework.grading.execution.sandbox import Limits, run_notebooks
from coursework.grading.judging.contract import Asked
from coursework.grading.judging.marking import asked_of_sandbox, mark, questions_of
from coursework.grading.record import Answer

SOURCES = sorted(find_course().sources.glob("*.ipynb"))
LIMITS = Limits(
    cell_seconds=120, cell_wall_seconds=400, notebook_seconds=600, notebook_wall_seconds=900
)
#: Stands before a notebook with solutions, some of which look at parameters that students do not
#: get: gives those of variant 0, with no package of ours, since the grader shows none of them to a
#: notebook.
DRAW = "\n".join(
    [
        "import hashlib, html, random, re",
        "from collections.abc import Callable, Mapping",
        "from dataclasses import dataclass",
        "from typing import Any, NamedTuple",
        "Json = Pool = object",
        "class AuthorError(ValueError): pass",
        f"MOST_ATTEMPTS = {variation.MOST_ATTEMPTS}",
        inspect.getsource(variation.Rule),
        inspect.getsource(Given),
        "def draw(name, count=16, where=None, picture=None, **pools):",
        "    return Given('', Rule(name, count, pools, where, picture).parameters(0, ''))",
    ]
)
#: Not an answer, or not there without SciPy.
NO_ANSWERS = {"check_dcm", "diagnose", "dcm_from_scipy_rotation", "scipy_rotation_from_dcm"}
NO_ANSWERS |= {"jacobian", "propagate_covariance", "smooth"}


def cells_of(path):
    """The code of a notebook with solutions, without what its author says of the questions."""
    cells = nbformat.read(path, as_version=4).cells
    codes = [HIDDEN.sub("", cell.source) for cell in cells if cell.cell_type == "code"]
    return [DRAW, *codes]


#: What becomes of the author's own solution: right; taken down, in an exam; or put
#: before a person, who alone can say.
RIGHT = {"correct", "recorded", "undecided"}


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.stem)
@pytest.mark.sampled(2)
def test_every_authors_solution_is_right_through_every_door(path):
    """Where a cell needs the real NumPy, it says so, and the answer is right
    with it, whatever was made before.
    """
    here, *others = (doors.through(door, [cells_of(path)])[0][0] for door in doors.DOORS)
    assert here and {outcome for outcome, _ in here.values()} <= RIGHT
    assert others == [here] * len(others)


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.stem)
@pytest.mark.sampled(1)
def test_every_authors_solution_is_right_before_the_grader(path):
    questions = {name: first for name, (first, *_) in questions_of(path, b"a secret").items()}
    job = {
        "id": path.stem,
        "cells": [{"source": cell} for cell in cells_of(path)],
        "questions": asked_of_sandbox(questions),
    }
    [result] = run_notebooks([job], workers=1, limits=LIMITS)
    for name, answer in result["answers"].items():
        if "secret" in answer:
            answer["secret"]["calls"] = questions[name].secret.digest
    for name, about in questions.items():
        by_a_person = about.question.kind == "free text"
        verdict = mark(name, Asked(about), Answer.from_json(result["answers"][name]))
        assert verdict.outcome == ("undecided" if by_a_person else "correct"), (name, verdict)


@cache
def plain_results(door):
    cells = [["from orientation import *", f"tell({call!r}, {call})"] for call in doors.RESULTS]
    return {
        call: result[call]
        for call, (result, _) in zip(doors.RESULTS, doors.through(door, cells), strict=True)
    }


def numbers_of(plain):
    return [float(node[1]) for node in plain["nodes"]], plain["value"]


def test_every_public_function_is_among_the_results():
    called = {word for call in doors.RESULTS for word in re.findall(r"\w+", call)}
    assert {name for name in orientation.__all__ if name[0].islower()} <= called | NO_ANSWERS


@pytest.mark.parametrize(
    "door", ["page", pytest.param("notebook interface", marks=pytest.mark.long)]
)
def test_the_result_of_every_public_function_is_read_alike(door):
    there, here = plain_results(door), plain_results("laptop")
    for call in doors.RESULTS:
        numbers, value = numbers_of(here[call])
        assert there[call]["value"] == value, call
        assert numbers_of(there[call])[0] == pytest.approx(numbers, abs=1e-12), call


PAGES = [
    path
    for folder in ("chapters", "exercises")
    for path in sorted((REPOSITORY / folder).glob("*.ipynb"))
]


@pytest.mark.parametrize("path", PAGES, ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_the_symbols_of_a_question_are_defined_where_its_answer_is_typed(path):
    """Whoever writes ``sm.sin(beta)`` meets no NameError."""
    named, modules = set(), set()
    for cell in nbformat.read(path, as_version=4).cells:
        if cell.cell_type != "code":
            continue
        tree = ast.parse(cell.source)
        for node in ast.walk(tree):
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
                named.add(node.id)
            elif isinstance(node, ast.Constant) and isinstance(node.value, str):
                named |= set(re.findall(r"\w+", node.value))  # the name that SymPy is given
            elif isinstance(node, (ast.Import, ast.ImportFrom)):
                modules |= {alias.name for alias in node.names}
        for name in re.findall(r"check\(['\"]([^'\"]+)", cell.source):
            symbols = {
                symbol.rstrip("'")
                for symbol in notebook_questions(name.partition("/")[0])[name].question.symbols
            }
            missing = {symbol for symbol in symbols if not {symbol, *spellings(symbol)} & named}
            assert not missing, f"{name}: {missing}"
            assert not symbols or "sympy" in modules, name
