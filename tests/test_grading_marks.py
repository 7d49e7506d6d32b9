"""Verdicts from plain data: the same as the student's check, nothing earned by default, nothing lost by chance."""

import json

import pytest
import sympy as sm
from grading_class import write_sources

from coursework.authoring.release import read_source
from coursework.checking.evaluate import MOST_WORK, TooLarge, values
from coursework.checking.mistakes import MESSAGES
from coursework.checking.plain import MOST_NODES, NotPlain, read_plain, to_plain
from coursework.checking.questions import judge
from coursework.grading import marking, reports
from coursework.grading.marking import CUT_SHORT, mark, questions_of


@pytest.fixture(scope="module")
def solutions(tmp_path_factory):
    return write_sources(tmp_path_factory.mktemp("course") / "solutions")


@pytest.fixture(scope="module")
def questions(solutions):
    return {name: about for path in sorted(solutions.glob("*.ipynb")) for name, about in questions_of(path).items()}


def given(answer, calls=None):
    return {"outcome": "recorded", "plain": to_plain(answer, calls), "from": "check", "cell": 1}


theta, alpha, beta, q = sm.symbols("theta alpha beta q")
A_C_N = sm.Matrix([[1, 0, 0], [0, sm.cos(theta), sm.sin(theta)], [0, -sm.sin(theta), sm.cos(theta)]])


@pytest.mark.parametrize(
    "name, answer, outcome, note, points",
    [
        ("turns/about-x", A_C_N, "correct", "", 2),
        ("turns/about-x", A_C_N.applyfunc(lambda entry: entry.rewrite(sm.exp)), "correct", "", 2),
        ("turns/about-x", A_C_N.tolist(), "correct", "", 2),
        ("turns/about-x", A_C_N.T, "wrong", "transposed", 1),
        ("turns/about-x", A_C_N.subs(theta, 2 * theta), "wrong", "", 0),
        ("turns/about-x", 2 * A_C_N, "invalid", "not orthogonal", 0),
        ("turns/about-x", A_C_N.subs(theta, alpha), "invalid", "stray symbol", 0),
        ("turns/about-x", [1, 2], "invalid", "shape", 0),
        ("turns/about-x", ..., "not attempted", "", 0),
        ("turns/sum", -sm.sin(alpha + beta), "wrong", "opposite", 0),
        ("turns/sum", sm.gamma(alpha), "undecided", "undecidable", 0),
        ("turns/sum", sm.sin(alpha + beta) * sm.Float("1.0004"), "undecided", "nearly right", 0),
        ("turns/sum", sm.sin(alpha + beta) * sm.Float("1.01"), "wrong", "", 0),
        ("axes/length", sm.Float("1.732") * q, "undecided", "nearly right", 0),
        ("axes/length", sm.sqrt(3) * q, "correct", "", 1),
        ("axes/angle", 0.5236, "correct", "", 1),
        ("axes/angle", 30, "wrong", "in degrees", 0),
    ],
)
def test_outcome_note_and_points(questions, name, answer, outcome, note, points):
    found = mark(name, questions[name], given(answer))
    assert (found["outcome"], found["note"], found["points"]) == (outcome, note, points)
    assert found["worth"] == questions[name]["worth"]
    assert (outcome == "correct") == (not found["messages"])


def test_functions_are_judged_by_what_they_return(questions):
    name, calls = "turns/doubled", [[1.5], [-2.0]]
    assert mark(name, questions[name], given(lambda x: 2 * x, calls))["points"] == 3
    assert mark(name, questions[name], given(lambda x: x / 2, calls))["outcome"] == "wrong"
    assert mark(name, questions[name], given(lambda x: 1 / 0, calls))["note"] == "raised an error"
    assert mark(name, questions[name], given(lambda x: None, calls))["outcome"] == "not attempted"


def test_the_verdict_is_that_of_the_students_own_check(solutions, questions):
    compared = 0
    for path in sorted(solutions.glob("*.ipynb")):
        for name, question in read_source(path).questions.items():
            sealed = question.sealed()
            answers = [question.plain, *(entry.plain for entry in question.entries.values())]
            for plain in answers:
                reply, _ = judge(name, sealed, plain)
                found = mark(name, questions[name], {"outcome": "recorded", "plain": json.loads(json.dumps(plain))})
                assert (found["outcome"], found["note"], found["messages"]) == (
                    reply.outcome,
                    reply.note,
                    reply.messages,
                )
                compared += 1
    assert compared > 20


@pytest.mark.parametrize(
    "answer, finished, outcome, note",
    [
        ({"outcome": "missing"}, True, "not attempted", "missing"),
        ({"outcome": "missing"}, False, "undecided", "not reached"),
        (
            {"outcome": "timeout", "error": "It took longer than it may."},
            True,
            "undecided",
            "stopped while it was read",
        ),
        (
            {"outcome": "killed", "error": "The process was ended by SIGKILL."},
            False,
            "undecided",
            "stopped while it was read",
        ),
        ({"outcome": "unreadable", "why": CUT_SHORT[0]}, True, "undecided", "stopped while it was read"),
        ({"outcome": "unreadable", "why": "An answer of type `module` cannot be read."}, True, "invalid", "unreadable"),
        ({"outcome": "recorded", "plain": {"value": ["expression", 5], "nodes": []}}, True, "invalid", "unreadable"),
        (
            {"outcome": "recorded", "plain": {"value": ["blank"], "nodes": [], "points": 3}},
            True,
            "invalid",
            "unreadable",
        ),
        ({"outcome": "recorded", "plain": {"outcome": "correct"}}, True, "invalid", "unreadable"),
        (
            {"outcome": "correct", "plain": {"value": ["blank"], "nodes": []}},
            True,
            "undecided",
            "stopped while it was read",
        ),
    ],
)
def test_nothing_is_earned_without_an_answer(questions, answer, finished, outcome, note):
    found = mark("turns/about-x", questions["turns/about-x"], answer, finished)
    assert (found["outcome"], found["note"], found["points"]) == (outcome, note, 0)


def test_a_fault_of_ours_goes_to_a_person(questions, monkeypatch):
    def fail(*arguments):
        raise ZeroDivisionError

    monkeypatch.setattr(marking, "compare", fail)
    found = mark("turns/about-x", questions["turns/about-x"], given(A_C_N))
    assert (found["outcome"], found["note"], found["points"]) == ("undecided", "not worked out", 0)


def test_the_sandbox_is_told_names_and_calls_and_nothing_else(questions):
    told = marking.asked_of_sandbox(questions)
    assert told["turns/about-x"] == {"variable": "A_C_N", "calls": None}
    assert told["turns/doubled"] == {"variable": "doubled", "calls": {"arguments": [[1.5], [-2.0]], "as": "lists"}}
    alike = {name: questions["axes/angle"] for name in ("first", "second")}
    assert [about["variable"] for about in marking.asked_of_sandbox(alike).values()] == [None, None]


def test_the_work_on_a_hostile_answer_is_bounded():
    complex_one = [["integer", "-2"], ["asin", 0]]
    for nodes in (
        [["symbol", "x"], *(["sin", order] for order in range(59_000))],
        [*complex_one, *(["Pow", 1, 1] for _ in range(59_000))],
        [*complex_one, *(["Add"] + [1] * 1_000 for _ in range(1_000))],
    ):
        assert isinstance(values(nodes, {"x": 1.25})[-1], TooLarge)
    tower = values([["integer", "9"], *(["Pow", order, order] for order in range(2_000))], {})
    assert isinstance(tower[-1], TooLarge)
    huge = values([["float", "1e999999"], ["float", "1e-999999"], ["Mul", 0, 1], ["exp", 1]], {})
    assert isinstance(huge[0], TooLarge) and huge[3] == 1


def test_an_honest_long_answer_is_worked_out(questions):
    # A chain that was multiplied out: thousands of products of sines and cosines.
    expression = sm.expand((sm.sin(alpha) + sm.cos(beta) + sm.sin(beta) + 2) ** 16)
    plain = to_plain(expression)
    assert 1_000 < len(plain["nodes"]) < MOST_NODES < MOST_WORK
    assert not isinstance(values(plain["nodes"], {"alpha": 0.5, "beta": 0.25})[plain["value"][1]], Exception)


@pytest.mark.parametrize(
    "data",
    [
        None,
        [],
        {"value": ["blank"]},
        {"value": ["blank"], "nodes": {}},
        {"value": ["expression", -1], "nodes": [["symbol", "x"]]},
        {"value": ["expression", True], "nodes": [["symbol", "x"]]},
        {"value": ["expression", 0], "nodes": [["sin", 0]]},
        {"value": ["expression", 0], "nodes": [["__import__('os')", 0]]},
        {"value": ["matrix", 10**9, 10**9, []], "nodes": []},
        {"value": ["expression", 0], "nodes": [["integer", "1" * 5_000]]},
        {"value": ["expression", 0], "nodes": [["rational", "1", "0"]]},
    ],
)
def test_damaged_data_is_no_answer(data):
    with pytest.raises(NotPlain):
        read_plain(data)


def test_every_mistake_has_words_for_the_report():
    assert set(MESSAGES) - {"authored"} <= set(reports.DEEDS)
    details = {"turn": 0, "first": 0, "second": 1, "sequence": "xyz", "axis": "x", "symbol": "m"} | {
        "factor": "2",
        "number": 8,
    }
    for note in reports.DEEDS:
        said = reports.deed({"note": note, "details": details, "messages": []})
        assert said and "{" not in said
