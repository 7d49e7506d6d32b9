"""The effect of each typical mistake on an answer, and its name in a locker."""

import pytest
import sympy as sm
from sympy.physics.mechanics import ReferenceFrame, dynamicsymbols

from coursework.checking import catalogue
from coursework.checking.catalogue import by_short_name, message, mistakes
from coursework.checking.mistakes import NUMBERS, as_matrix, short_name
from coursework.checking.question import Question

x, y = sm.symbols("x y")
q = dynamicsymbols("q")
t = dynamicsymbols._t
FACTORS = {
    "2": (2, "twice"),
    "one half": (sm.Rational(1, 2), "half"),
    "3": (3, "three times"),
    "one third": (sm.Rational(1, 3), "a third of"),
    "4": (4, "four times"),
    "one quarter": (sm.Rational(1, 4), "a quarter of"),
}


def factors(answer):
    return [("factor", {"factor": name}, factor * answer) for name, (factor, _) in FACTORS.items()]


def symbols(answer):
    """Return the mistakes in the symbols of an answer that contains x and y."""
    return [
        *(
            ("sign of a symbol", {"symbol": str(symbol)}, answer.subs(symbol, -symbol))
            for symbol in (x, y)
        ),
        (
            "symbols interchanged",
            {"first": "x", "second": "y"},
            answer.subs({x: y, y: x}, simultaneous=True),
        ),
    ]


def plain(answer):
    """Return the mistakes that any number can have."""
    return [("opposite", {}, -answer), ("half", {}, answer / 2), ("double", {}, 2 * answer)]


RATIO, HALF = 3 * x / (y + 2), sm.Rational(1, 2)
MATRIX = sm.Matrix([[x, 2], [3, y]])
ROWS = sm.Matrix([[x, 2, y]])
VECTOR, TURNED = sm.Matrix([x, y]), (MATRIX, [5, 7])
EXPRESSION, ANGLE = Question("expression"), Question("expression", quantity="angle")
LENGTH = Question("expression", quantity="length")
DEGREES = Question("expression", quantity="angle in degrees")
WORDS = Question("words", options=("a", "b", "c"))
POWERS = (3, -3, 6, -6, 2, -2)


@pytest.mark.parametrize(
    ("question", "answer", "turned", "expected"),
    [
        (
            EXPRESSION,
            RATIO,
            None,
            [*plain(RATIO), ("reciprocal", {}, 1 / RATIO), *factors(RATIO), *symbols(RATIO)],
        ),
        (EXPRESSION, 0, None, [*plain(0), *factors(0)]),
        (LENGTH, 3, None, [*plain(3), ("reciprocal", {}, sm.Rational(1, 3))]),
        (
            ANGLE,
            HALF,
            None,
            [
                *plain(HALF),
                ("in degrees", {}, 90 / sm.pi),
                ("supplement", {}, sm.pi - HALF),
                ("complement", {}, sm.pi / 2 - HALF),
            ],
        ),
        (
            DEGREES,
            30,
            None,
            [
                *plain(30),
                ("in radians", {}, sm.pi / 6),
                ("supplement", {}, 150),
                ("complement", {}, 60),
            ],
        ),
        (
            EXPRESSION,
            2 * q + t,
            None,
            [
                *plain(2 * q + t),
                ("reciprocal", {}, 1 / (2 * q + t)),
                *factors(2 * q + t),
                ("sign of a symbol", {"symbol": "q"}, t - 2 * q),
            ],
        ),
        (
            Question("matrix", shape=(2, 2)),
            MATRIX,
            None,
            [
                ("transposed", {}, sm.Matrix([[x, 3], [2, y]])),
                ("opposite", {}, -MATRIX),
                *factors(MATRIX),
                *symbols(MATRIX),
            ],
        ),
        (
            Question("matrix", shape=(1, 3)),
            ROWS.tolist(),
            None,
            [("opposite", {}, -ROWS), *factors(ROWS), *symbols(ROWS)],
        ),
        (
            Question("vector", length=2),
            [x, y],
            TURNED,
            [
                ("opposite", {}, -VECTOR),
                ("turned the wrong way", {}, sm.Matrix([5 * x + 21, 10 + 7 * y])),
                ("not turned", {}, sm.Matrix([5, 7])),
                *factors(VECTOR),
                *symbols(VECTOR),
            ],
        ),
        (
            Question("vector", length=2, unit_vector=True),
            VECTOR,
            None,
            [("opposite", {}, -VECTOR), *symbols(VECTOR)],
        ),
        (Question("vector"), ReferenceFrame("A").x, None, []),
        (
            Question("measurement"),
            (RATIO, "N"),
            None,
            [
                (note, details, (changed, "N"))
                for note, details, changed in (
                    *plain(RATIO),
                    *factors(RATIO),
                    *symbols(RATIO),
                    *(
                        ("power of ten", {"power": power}, RATIO * sm.Integer(10) ** power)
                        for power in POWERS
                    ),
                )
            ],
        ),
        (
            WORDS,
            ("a", "b", "c"),
            None,
            [
                ("one wrong", {"number": 3}, [*"abc"[:place], choice, *"abc"[place + 1 :]])
                for place, right in enumerate("abc")
                for choice in "abc"
                if choice != right
            ],
        ),
        (
            Question("truth values", length=3),
            [True, False, False],
            None,
            [
                ("one wrong", {"number": 3}, [False, False, False]),
                ("one wrong", {"number": 3}, [True, True, False]),
                ("one wrong", {"number": 3}, [True, False, True]),
            ],
        ),
        (WORDS, ["a", "b"], None, []),
        (WORDS, ["a"] * len(NUMBERS), None, []),
        (Question("order"), ["a", "b", "c"], None, [("turned round", {}, ["c", "b", "a"])]),
        (
            Question("order"),
            ("a", "b", "c", "d"),
            None,
            [("turned round", {}, [*"dcba"])]
            + [("two interchanged", {}, [*order]) for order in ("bacd", "acbd", "abdc")],
        ),
        (Question("choice"), "a", None, []),
    ],
)  # fmt: skip
def test_what_the_mistakes_of_a_kind_lead_to(question, answer, turned, expected):
    outcomes = [
        (mistake.note, mistake.details, mistake.answer)
        for mistake in mistakes(question, answer, (), turned)
    ]

    def is_one(left, right):
        return left[:2] == right[:2] and _same(left[2], right[2])

    assert len(outcomes) == len(expected)
    assert all(
        any(is_one(outcome, expected_outcome) for expected_outcome in expected)
        for outcome in outcomes
    )
    assert all(
        any(is_one(outcome, expected_outcome) for outcome in outcomes)
        for expected_outcome in expected
    )
    for note, details, _ in outcomes:
        assert by_short_name(_with_symbols(question))[short_name(note, details)] == (note, details)
        message_text = message(question, note, details)
        assert all(_word(*detail) in message_text for detail in details.items())


def _with_symbols(question):
    return Question(question.kind, symbols=dict.fromkeys(("x", "y", "q"), (1, 2)))


def _word(name, value):
    return NUMBERS[value] if name == "number" else str(FACTORS.get(value, (0, value))[1])


def _same(left, right):
    if isinstance(left, (list, tuple)):
        return len(left) == len(right) and all(map(_same, left, right))
    if isinstance(left, (str, bool)):
        return left == right
    values = {q: sm.Rational(3, 7), t: 5, x: sm.Rational(2, 3), y: sm.Rational(7, 5)}
    left, right = (sm.Matrix([part]).subs(values).evalf(20) for part in (left, right))
    return left.shape == right.shape and (left - right).norm() < 1e-15


def test_one_of_the_twenty_is_the_most_that_has_a_word():
    assert len(NUMBERS) == 21 and mistakes(WORDS, ["a"] * 20)[0].details == {"number": 20}


def test_a_frame_is_no_matrix_that_mistakes_are_made_of():
    with pytest.raises(TypeError, match="^The right answer is a reference frame"):
        as_matrix(ReferenceFrame("A"))


def test_the_names_in_the_lockers_are_what_they_were():
    """Every sealed file depends on them."""
    assert short_name("sign of a symbol", {"symbol": "beta"}).hex() == "72eac791"
    assert short_name("Größe", {"b": 2, "a": 1}).hex() == "e3398e88"


def test_a_plug_in_is_given_the_turns_and_the_question(monkeypatch):
    question = Question("rotation matrix", frames=("B", "A"))
    named = mistakes(question, sm.eye(3), iter([("x", 30)]))
    assert [mistake.note for mistake in named] == ["transposed", "sine and cosine exchanged"]
    monkeypatch.setitem(catalogue.MESSAGES, "half", lambda question: f"Of {question.kind}.")
    assert message(question, "half", {}) == "Of rotation matrix."


def test_two_mistakes_of_one_name_are_refused(monkeypatch):
    monkeypatch.setattr(catalogue, "short_name", lambda note, details: b"the same")
    catalogue._by_short_name.cache_clear()
    with pytest.raises(RuntimeError, match="have the same short name") as error:
        by_short_name(Question("order"))
    catalogue._by_short_name.cache_clear()
    assert "Note(note='transposed'" in str(error.value) and "'in degrees'" in str(error.value)


def test_a_kind_whose_values_are_those_of_another_has_its_mistakes():
    asked = Question("function", result="measurement", symbols={"x": (1, 2)})
    assert by_short_name(asked) == by_short_name(Question("measurement", symbols={"x": (1, 2)}))
    assert message(asked, "power of ten", {"power": 3}).startswith("This is $10^{3}$ times")
