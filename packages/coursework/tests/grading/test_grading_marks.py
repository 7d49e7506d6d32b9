"""Verdicts from plain data: like the student's check, and nothing earned or lost by chance."""

import contextlib
import json
import random
from dataclasses import replace

import pytest
import sympy as sm
from grading_class import write_sources

from coursework.authoring import author
from coursework.authoring.release import read_source
from coursework.checking.evaluate import MOST_WORK, TooLarge, values
from coursework.checking.mistakes import MESSAGES
from coursework.checking.plain import MOST_NODES, NotPlain, to_plain
from coursework.checking.points import points
from coursework.checking.questions import compare, judge
from coursework.grading.judging import marking, secret
from coursework.grading.judging.contract import Asked
from coursework.grading.judging.marking import CUT_SHORT, mark, questions_of
from coursework.grading.record import Answer, Mark
from coursework.grading.reporting import reports


@pytest.fixture(scope="module")
def solutions(tmp_path_factory):
    return write_sources(tmp_path_factory.mktemp("course") / "solutions")


@pytest.fixture(scope="module")
def questions(solutions):
    return {
        name: Asked(first)
        for path in sorted(solutions.glob("*.ipynb"))
        for name, (first,) in questions_of(path, b"secret").items()
    }


def given(answer, calls=None):
    return Answer("recorded", to_plain(answer, calls), source="check", cell=1)


def given_function(question, function):
    """Return the sandbox's result for a function: its results in the check and the secret calls."""
    said = given(function, question.contract.question.calls)
    place = question.contract.secret
    with contextlib.suppress(NotPlain):
        return replace(
            said, secret={"plain": to_plain(function, place.calls), "calls": place.digest}
        )
    return said


theta, alpha, beta, q = sm.symbols("theta alpha beta q")
A_C_N = sm.Matrix(
    [[1, 0, 0], [0, sm.cos(theta), sm.sin(theta)], [0, -sm.sin(theta), sm.cos(theta)]]
)


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
    marked = mark(name, questions[name], given(answer))
    assert (marked.outcome, marked.note, marked.points) == (outcome, note, points)
    assert marked.worth == questions[name].contract.worth
    assert (outcome == "correct") == (not marked.messages)


def test_functions_are_judged_by_what_they_return(questions):
    name = "turns/doubled"
    question = questions[name]
    assert mark(name, question, given_function(question, lambda x: 2 * x)).points == 3
    assert mark(name, question, given_function(question, lambda x: x / 2)).outcome == "wrong"
    assert mark(name, question, given_function(question, lambda x: 1 / 0)).note == "raised an error"
    assert mark(name, question, given_function(question, lambda x: None)).outcome == "not attempted"


def marks_of(questions, name, answer):
    marked = mark(name, questions[name], answer)
    return marked.outcome, marked.note, marked.points


def test_an_answer_that_is_right_only_where_the_check_looks_earns_nothing(questions):
    """The check's points follow from the question, so students can fit a polynomial to them."""
    public = questions["turns/sum"].contract.question
    places = points(public)
    rows = sm.Matrix(
        [
            [sm.Float(point["alpha"], 40) ** power for power in range(len(places))]
            for point in places
        ]
    )
    right = sm.Matrix([sm.sin(sm.Float(point["alpha"] + point["beta"], 40)) for point in places])
    polynomial = sum(part * alpha**power for power, part in enumerate(rows.LUsolve(right)))
    plain = to_plain(sm.expand(polynomial))
    assert (
        compare("turns/sum", public, plain, questions["turns/sum"].contract.locker).outcome
        == "correct"
    )
    forged = "wrong", "right only where it is checked", 0
    assert marks_of(questions, "turns/sum", given(sm.expand(polynomial))) == forged
    # A share of the points for a known mistake cannot be forged either.
    assert marks_of(questions, "turns/about-x", given(A_C_N.T)) == ("wrong", "transposed", 1)
    place = points(questions["turns/about-x"].contract.question)
    x = sm.Symbol("theta")
    through = [
        sm.interpolate(
            [(sm.Float(p["theta"], 40), sm.cos(sm.Float(p["theta"], 40))) for p in place], x
        )
    ]
    through.append(
        sm.interpolate(
            [(sm.Float(p["theta"], 40), sm.sin(sm.Float(p["theta"], 40))) for p in place], x
        )
    )
    turned = sm.Matrix([[1, 0, 0], [0, through[0], -through[1]], [0, through[1], through[0]]])
    assert marks_of(questions, "turns/about-x", given(turned)) == forged


def test_a_table_of_what_a_function_returned_is_no_function(questions):
    question = questions["turns/doubled"]
    table = {call[0]: 2 * call[0] for call in question.contract.question.calls}
    for otherwise in (0.0, 1e300, "?", None):
        forged = given_function(question, lambda x, otherwise=otherwise: table.get(x, otherwise))
        assert marks_of(questions, "turns/doubled", forged) == (
            "wrong",
            "right only where it is checked",
            0,
        )
    refusing = replace(
        given_function(question, lambda x: 2 * x), secret={"unreadable": "It raised."}
    )
    assert marks_of(questions, "turns/doubled", refusing)[1] == "right only where it is checked"
    # Uncalled functions, whatever the reason, wait for a person, and so do calls with other
    # secrets.
    for said in (
        {},
        {"unreadable": CUT_SHORT[0]},
        {**given_function(question, lambda x: 2 * x).secret, "calls": "x"},
    ):
        answer = replace(given_function(question, lambda x: 2 * x), secret=said)
        assert marks_of(questions, "turns/doubled", answer) == ("undecided", "not called", 0)


def test_the_secret_is_made_once_and_decides_the_points(tmp_path, solutions):
    first = secret.secret_beside(tmp_path)
    assert len(first) == 32 and secret.secret_beside(tmp_path) == first
    assert (tmp_path / secret.FILE).stat().st_mode & 0o077 == 0
    (tmp_path / "other").mkdir()
    assert secret.secret_beside(tmp_path / "other") != first
    with pytest.raises(ValueError, match="It belongs beside the solutions"):
        secret.secret_beside(tmp_path / "nowhere")
    questions, same, other = (
        questions_of(solutions / "turns.ipynb", known) for known in (b"one", b"one", b"other")
    )
    assert questions == same
    for (first,), (second,) in zip(questions.values(), other.values(), strict=True):
        assert first.secret != second.secret and first.version != second.version
        assert first.secret.salt != first.question.salt


def test_secret_calls_are_like_the_authors(questions):
    dice = random.Random(5)
    unit, triad = (
        [[0.6, 0.8, 0.0], [0.0, 0.0, 1.0]],
        [[[1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 0], [0, 0, 1], [1, 0, 0]]],
    )
    for _ in range(50):
        assert -2 <= secret._another([1.5, -2.0], dice) <= 1.5
        assert secret._another([3, 7], dice) in range(3, 8) and secret._another([2, 2], dice) == 2
        assert secret._another(["zxy", "xyz"], dice) in ("zxy", "xyz")
        assert abs(sm.Matrix(secret._another(unit, dice)).norm() - 1) < 1e-9
        turned = sm.Matrix(secret._another(triad, dice))
        assert (turned * turned.T - sm.eye(3)).norm() < 1e-9 and abs(turned.det() - 1) < 1e-9
        turns = secret._another(
            [[], [[[0, 0, 2], 0.5]], [[[1, -2, 2], 2.5], [[-3, 0, 4], 1.5]]], dice
        )
        assert 1 <= len(turns) <= 2 and all(
            len(axis) == 3 and 0.5 <= angle <= 2.5 for axis, angle in turns
        )
        times = secret._another([[0.0, 0.1, 0.3], [0.0, 0.5, 0.6]], dice)
        assert times == sorted(times) and times[0] == 0


def of_words(sequence):
    return len(sequence) + sequence.count("x")


def of_pairs(pairs):
    return sum(first * second for first, second in pairs)


@pytest.mark.parametrize(
    "function, calls, others",
    [
        (of_pairs, [[[]], [[[0.5, 1.0]]], [[[2.0, 3.0], [4.0, 0.5]]]], True),
        (of_pairs, [[[[1, 2]]], [[[3, 5], [4, 7]]]], True),
        (of_words, [["zxy"], ["xyzzy"]], False),  # Only the author knows another.
    ],
)
def test_secret_calls_are_others_than_those_of_the_check(function, calls, others):
    """If only the author's words can be arguments, a function can be no more than their table."""
    question = author.question("trial/one", "function", function, calls=calls, result="expression")
    for number in range(10):
        made = secret.secret_of(question, b"secret %d" % number).calls
        assert any(call not in calls for call in made) == others


@pytest.fixture
def judged(monkeypatch):
    """The names of the questions judged during a test, with nothing remembered from before."""
    judged, whole = [], marking.judge
    monkeypatch.setattr(marking, "_marked", {})
    monkeypatch.setattr(
        marking, "judge", lambda name, *rest: judged.append(name) or whole(name, *rest)
    )
    return judged


def test_equal_answers_are_judged_once_and_are_no_less_apart(questions, judged):
    first, again = (
        mark("turns/about-x", questions["turns/about-x"], given(A_C_N)) for _ in range(2)
    )
    assert first == again and judged == ["turns/about-x"]
    changed = Asked(replace(questions["turns/about-x"].contract, version="another", worth=7))
    assert mark("turns/about-x", changed, given(A_C_N)).points == 7
    assert mark("turns/about-x", questions["turns/about-x"], given(A_C_N.T)).outcome == "wrong"


def test_the_verdict_is_that_of_the_students_own_check(solutions, questions):
    compared = 0
    for path in sorted(solutions.glob("*.ipynb")):
        for name, question in read_source(path).questions.items():
            sealed = question.sealed()
            answers = [question.plain, *(entry.plain for entry in question.entries.values())]
            for plain in answers:
                reply = judge(name, sealed, plain)
                said = Answer("recorded", json.loads(json.dumps(plain)))
                if question.public.kind == "function" and plain == question.plain:
                    said = given_function(questions[name], question.answer)
                marked = mark(name, questions[name], said)
                assert (marked.outcome, marked.note, marked.messages) == (
                    reply.outcome,
                    reply.note,
                    tuple(reply.messages),
                )
                compared += 1
    assert compared > 20


@pytest.mark.parametrize(
    "answer, finished, outcome, note",
    [
        ({"outcome": "missing"}, True, "not attempted", "missing"),
        ({"outcome": "missing"}, False, "undecided", "not reached"),
        ({"outcome": "missing", "limited": True}, True, "undecided", "lost to a limit"),
        (
            {"outcome": "timeout", "error": "It exceeded the time limit."},
            True,
            "undecided",
            "interrupted while reading",
        ),
        (
            {"outcome": "killed", "error": "The process was killed by SIGKILL."},
            False,
            "undecided",
            "interrupted while reading",
        ),
        (
            {"outcome": "unreadable", "why": CUT_SHORT[0]},
            True,
            "undecided",
            "interrupted while reading",
        ),
        (
            {"outcome": "unreadable", "why": "An answer of type `module` cannot be read."},
            True,
            "invalid",
            "unreadable",
        ),
        (
            {"outcome": "recorded", "plain": {"value": ["expression", 5], "nodes": []}},
            True,
            "invalid",
            "unreadable",
        ),
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
            "interrupted while reading",
        ),
    ],
)
def test_nothing_is_earned_without_an_answer(questions, answer, finished, outcome, note):
    limited = answer.pop("limited", False)
    marked = mark(
        "turns/about-x", questions["turns/about-x"], Answer.from_json(answer), finished, limited
    )
    assert (marked.outcome, marked.note, marked.points) == (outcome, note, 0)


def test_a_fault_of_ours_goes_to_a_person(questions, monkeypatch):
    def fail(*arguments):
        raise ZeroDivisionError

    monkeypatch.setattr(marking, "_marked", {})
    monkeypatch.setattr(marking, "compare", fail)
    marked = mark("turns/about-x", questions["turns/about-x"], given(A_C_N))
    assert (marked.outcome, marked.note, marked.points) == ("undecided", "not worked out", 0)


def test_the_sandbox_is_told_names_and_calls_and_nothing_else(questions):
    questions = {name: asked.contract for name, asked in questions.items()}
    told = marking.asked_of_sandbox(questions)
    assert told["turns/about-x"] == {"variable": "A_C_N", "calls": None, "secret calls": None}
    secretly = {"arguments": list(questions["turns/doubled"].secret.calls), "as": "lists"}
    assert told["turns/doubled"] == {
        "variable": "doubled",
        "calls": {"arguments": [[1.5], [-2.0]], "as": "lists"},
        "secret calls": secretly,
    }
    assert len(secretly["arguments"]) == 3 and secretly["arguments"] != [[1.5], [-2.0]]
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


def test_a_costly_answer_is_not_tried_on_every_variant(questions, judged):
    other = questions["turns/sum"].contract
    # The other variants know answers that the student's own does not.
    question = Asked(replace(other, known={}), siblings=(other,) * 15)
    long = {
        "value": ["expression", 1_500],
        "nodes": [["symbol", "alpha"], *(["sin", order] for order in range(1_500))],
    }
    for plain, times in ((to_plain(sm.sin(alpha - beta)), 16), (long, 1)):
        marked = mark("turns/sum", question, Answer("recorded", plain, source="check", cell=1))
        assert marked.outcome == "wrong" and len(judged) == times
        judged.clear()


def test_an_honest_long_answer_is_worked_out(questions):
    # It is an expanded chain of thousands of products of sines and cosines.
    expression = sm.expand((sm.sin(alpha) + sm.cos(beta) + sm.sin(beta) + 2) ** 16)
    plain = to_plain(expression)
    assert 1_000 < len(plain["nodes"]) < MOST_NODES < MOST_WORK
    assert not isinstance(
        values(plain["nodes"], {"alpha": 0.5, "beta": 0.25})[plain["value"][1]], Exception
    )


def test_every_mistake_has_words_for_the_report():
    assert set(MESSAGES) - {"authored"} <= set(reports.DEEDS)
    details = {
        "turn": 0,
        "first": 0,
        "second": 1,
        "sequence": "xyz",
        "axis": "x",
        "symbol": "m",
    } | {
        "factor": "2",
        "number": 8,
    }
    for note in reports.DEEDS:
        said = reports.deed(Mark("wrong", note, details))
        assert said and "{" not in said
