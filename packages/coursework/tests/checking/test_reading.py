"""Reading answers of any form, and the messages about the wrong ones.

The messages are compared verbatim, since each word depends on the question and the answer.
"""

import itertools
import random

import pytest
import sympy as sm
from sympy.physics import units
from sympy.physics.mechanics import ReferenceFrame

from coursework.checking import kinds, reading
from coursework.checking.evaluate import MP
from coursework.checking.kinds import KINDS, Blank, Fault, Undecidable
from coursework.checking.plain import to_plain
from coursework.checking.question import Question
from coursework.checking.reading import EXACT, NEAR, Reading, read

x = sm.Symbol("x")
N, A, B = map(ReferenceFrame, "NAB")
A.orient_axis(N, 0, N.z)
SIGNS = ("-i", "1", "+x", "none", "- 2 -", "B")
EXPRESSION = Question("expression")
VECTOR, PLANE = Question("vector"), Question("vector", length=2)
IN_A = Question("vector", frames=("A",))
MATRIX, SQUARE = Question("matrix", shape=(2, 3)), Question("matrix")
MEASUREMENT = Question("measurement")
CHOICE = Question("choice", options=SIGNS)
WORDS = Question("words", options=SIGNS, length=2)
LOUD = Question("words", options=("yes", "no"), length=2)
TRUTHS = Question("truth values", length=3)
ORDER = Question("order", options=("a", "b", "c"))
TEXT = Question("free text")
FUNCTION = Question("function", result="expression", calls=([1], [2]))


def plain(value, *nodes):
    return {"value": value, "nodes": list(nodes)}


ONE, TWO = ["integer", "1"], ["integer", "2"]
MINUS, NAME = ["integer", "-1"], ["symbol", "i"]


def returned(*results, worked=True):
    return plain(["function", list(results), worked], ONE, TWO, ["symbol", "w"])


FIRST, SECOND, STRAY = ["expression", 0], ["expression", 1], ["expression", 2]


@pytest.mark.parametrize(
    ("question", "answer", "numbers"),
    [
        (EXPRESSION, 7, [7]),
        (EXPRESSION, [[7]], [7]),
        (EXPRESSION, sm.Matrix([[7]]), [7]),
        (EXPRESSION, plain(["list", [FIRST, ["text", "1"]]], ONE), [1]),
        (VECTOR, [1, 2, 3], [1, 2, 3]),
        (VECTOR, [[1, 2, 3]], [1, 2, 3]),
        (VECTOR, [[1], [2], [3]], [1, 2, 3]),
        (VECTOR, sm.Matrix([1, 2, 3]), [1, 2, 3]),
        (VECTOR, sm.Matrix([[1, 2, 3]]), [1, 2, 3]),
        (PLANE, [1, 2], [1, 2]),
        (IN_A, A.x + 2 * N.y + 3 * A.z, [1, 2, 3]),
        (MATRIX, [[1, 2, 3], [4, 5, 6]], [1, 2, 3, 4, 5, 6]),
        (MATRIX, sm.Matrix([[1, 2, 3], [4, 5, 6]]), [1, 2, 3, 4, 5, 6]),
        (MATRIX, [[[1, 2, 3], [4, 5, 6]]], [1, 2, 3, 4, 5, 6]),
        (MATRIX, [sm.Matrix([[1, 2, 3], [4, 5, 6]])], [1, 2, 3, 4, 5, 6]),
        (
            MATRIX,
            [[[1, 2, 3]], [[4, 5, 6]]],
            [1, 2, 3, 4, 5, 6],
        ),
        (
            MATRIX,
            [sm.Matrix([[1, 2, 3]]), sm.Matrix([4, 5, 6])],
            [1, 2, 3, 4, 5, 6],
        ),
        (SQUARE, sm.diag(1, 2, 3), [1, 0, 0, 0, 2, 0, 0, 0, 3]),
    ],
)
def test_the_numbers_of_an_answer(question, answer, numbers):
    answer = answer if isinstance(answer, dict) else to_plain(answer)
    assert read(question, answer) == Reading([numbers])


WANTED = {
    "expression": "a single expression",
    "vector": "a list of 3 numbers",
    "matrix": "a matrix of size 2 × 3",
    "measurement": "a number and its unit, such as `(3.2, 'N m')`",
    "truth values": "a list of 3 Booleans, `True` or `False`",
    "order": "a list with each of `a`, `b`, `c` once",
    "free text": "a text",
    "choice": "one of `-i`, `1`, `+x`, `none`, `- 2 -`, `B`, in quotation marks",
}
ROWS = "a list of rows, one of which has"


#: Answers of another form, and what the reply calls them.
OTHER_FORMS = [
    (EXPRESSION, sm.eye(2), "a matrix of size 2 × 2"),
    (EXPRESSION, sm.Matrix([[1, 2]]), "a matrix of size 1 × 2"),
    (EXPRESSION, sm.Matrix([1, 2]), "a matrix of size 2 × 1"),
    (EXPRESSION, [1, 2], "a list with 2 entries"),
    (EXPRESSION, [[]], "an empty list"),
    (EXPRESSION, [[1, 2], [3, 4]], "a list of 2 rows with 2 entries each"),
    (EXPRESSION, [[1, 2], 3], "a list with 2 entries"),
    (EXPRESSION, [[1, 2], [3]], "a list with 2 entries"),
    (EXPRESSION, (1, "m"), "a number with a unit, or with a string"),
    (EXPRESSION, "7", "a string: write it without quotation marks"),
    (EXPRESSION, True, "a Boolean"),
    (EXPRESSION, B, "a reference frame"),
    (EXPRESSION, A.x, "a vector"),
    (EXPRESSION, plain(["function", [], True]), "a function"),
    (EXPRESSION, plain(["frames", {}]), "a set of reference frames"),
    (EXPRESSION, plain(["printed", "1"]), "something printed"),
    (EXPRESSION, plain(["raised", "Error"]), "an error"),
    (EXPRESSION, [[1], [2]], "a list of 2 rows with 1 entry each"),
    (VECTOR, 7, "a single expression"),
    (VECTOR, [7], "a list with 1 entry"),
    (VECTOR, "7", "a string: write it without quotation marks"),
    (VECTOR, [[1, 2]], "a list with 2 entries"),
    (
        VECTOR,
        [1, 2, "3"],
        "a list that contains a string; write numbers without quotation marks",
    ),
    (VECTOR, [1, ..., 3], "a list with blanks"),
    (VECTOR, [1, [..., ...], 3], "a list with blanks"),
    (VECTOR, [1, True, 3], "a list with 3 entries, one of which is a Boolean"),
    (VECTOR, sm.Matrix([[1, 2]]), "a matrix of size 1 × 2"),
    (VECTOR, A.x, "a vector"),
    (MATRIX, sm.eye(2), "a matrix of size 2 × 2"),
    (MATRIX, [[1, 2, 3]], "a list of one row with 3 entries"),
    (MATRIX, [[1, 2], [3, 4]], "a list of 2 rows with 2 entries each"),
    (MATRIX, [[1, 2, 3], [4, 5]], f"{ROWS} 2 entries"),
    (MATRIX, [[1, 2, 3], [..., ...]], f"{ROWS} 2 entries"),
    (MATRIX, [[1, 2, 3], [..., ..., ...]], "a list with blanks"),
    (MATRIX, [[1, 2, 3], [...]], "a list with blanks"),
    (
        MATRIX,
        [[1, 2, 3], [4, "5", 6]],
        "a list that contains a string; write numbers without quotation marks",
    ),
    (MATRIX, [[1, 2, 3], 4], "a list with 2 entries, one of which is a single expression"),
    (MATRIX, [[1, 2, 3], "4"], "a list that contains a string"),
    (
        MATRIX,
        [[1, 2, 3], sm.eye(2)],
        "a list with 2 entries, one of which is a matrix of size 2 × 2",
    ),
    (MATRIX, "7", "a string: write it without quotation marks"),
    (MEASUREMENT, 7, "a single expression"),
    (MEASUREMENT, "7 N", "a string"),
    (MEASUREMENT, ("7", "N"), "a string: write it without quotation marks"),
    (MEASUREMENT, [7, 8], "a list with 2 entries"),
    (MEASUREMENT, [7, "N", "m"], "a list with 3 entries"),
    (TRUTHS, True, "a Boolean"),
    (TRUTHS, [True, False], "a list with 2 entries"),
    (TRUTHS, [True, False, 2], "a list with 3 entries, one of which is a single expression"),
    (TRUTHS, [True, False, "yes"], "a list that contains a string"),
    (TRUTHS, [True, False, ...], "a list with blanks"),
    (ORDER, "abc", "a string"),
    (ORDER, ["a", "b"], "a list with 2 entries"),
    (ORDER, ["b", "a", "b"], "one in which `b` appears 2 times"),
    (TEXT, 3, "a single expression"),
    (TEXT, ["a", 3], "a list with 2 entries"),
    (CHOICE, 2 * x, "a single expression"),
    (CHOICE, sm.Rational(1, 2), "a single expression"),
    (CHOICE, 1.5, "a single expression"),
    (CHOICE, plain(SECOND, MINUS, ["Mul", 0, 0]), "a single expression"),
    (CHOICE, plain(STRAY, MINUS, NAME, ["Add", 0, 1]), "a single expression"),
    (CHOICE, plain(STRAY, TWO, NAME, ["Mul", 0, 1]), "a single expression"),
    (CHOICE, plain(STRAY, MINUS, NAME, ["Mul", 0, 1, 1]), "a single expression"),
    (CHOICE, True, "a Boolean"),
    (CHOICE, ["1", 2], "a list with 2 entries"),
]
OPTIONS = "`-i`, `1`, `+x`, `none`, `- 2 -`, `B`"


@pytest.mark.parametrize(
    ("question", "answer", "note", "message"),
    [
        *(
            (question, answer, "shape", f"Give {WANTED[question.kind]}; this is {described}.")
            for question, answer, described in OTHER_FORMS
        ),
        (WORDS, ["1"], "shape", f"a list of 2 words, each one of {OPTIONS}; this is a list with 1"),
        (WORDS, "1", "shape", f"a list of 2 words, each one of {OPTIONS}; this is a string."),
        (WORDS, ["1", ...], "shape", "blanks: `'none'` is a string too."),
        (LOUD, ["yes", ...], "shape", "a list with blanks."),
        (WORDS, ["1", "k"], "shape", f"The answer in entry 2 must be one of {OPTIONS}, not `k`."),
        (WORDS, ["1", sm.nan], "shape", f"Give one of {OPTIONS} in entry 2, in quotation marks; "),
        (CHOICE, 50 * "k", "shape", f"The answer must be one of {OPTIONS}, not `{40 * 'k'}`."),
        (IN_A, [1, 2], "shape", "Give a list of 3 components; this is a list with 2"),
        (
            IN_A,
            B.x,
            "frame",
            "This vector is not connected to the question's frame `A`.",
        ),
        (
            EXPRESSION,
            x,
            "stray symbol",
            "The answer contains `x`, but this question has no symbols.",
        ),
        (
            Question("expression", symbols={"a": (1, 2), "b": (1, 2)}),
            sm.Symbol("x" * 50),
            "stray symbol",
            f"The answer contains `{'x' * 40}`, but this question has the symbols `a`, `b`.",
        ),
        (EXPRESSION, sm.zoo, "undefined", "The answer has no finite value: division by zero."),
        (IN_A, [float("nan")] * 3, "undefined", "The answer has no finite value: it is NaN, which"),
        (
            Question("expression", symbols={"a": (1, 2)}),
            sm.nan,
            "undefined",
            "The answer has no finite value: it is NaN, which is not a number.",
        ),
        (EXPRESSION, sm.Integer(10) ** 61 * sm.E, "too large", "the value is larger than 10^60."),
        (
            EXPRESSION,
            sm.I,
            "not real",
            "The answer has an imaginary part, but the question asks for",
        ),
        (MEASUREMENT, (7, "furlong"), "unknown unit", "We do not know the unit `furlong`."),
        (FUNCTION, 7, "shape", "The question asks for a function. Give its name, without calling"),
        (FUNCTION, returned(["blank"], ["blank"]), "returned nothing", "but returns nothing. End"),
        (
            FUNCTION,
            returned(FIRST, ["blank"]),
            "returned nothing",
            "In call 2 of 2, with `2`, the function re",
        ),
        (FUNCTION, returned(FIRST, ["printed", "1"]), "printed", "The function prints its result"),
        (
            FUNCTION,
            returned(["raised", "E: e"], FIRST),
            "raised an error",
            "In call 1 of 2, with `1`,",
        ),
        (FUNCTION, returned(["raised", "E: e"], FIRST), "raised an error", "raised `E: e`."),
        (
            FUNCTION,
            returned(FIRST),
            "raised an error",
            "The function did not return a result for every call.",
        ),
        (
            FUNCTION,
            returned(FIRST, FIRST, FIRST),
            "raised an error",
            "did not return a result for every call.",
        ),
        (
            FUNCTION,
            returned(FIRST, ["truth", True]),
            "shape",
            "In call 2 of 2, with `2`, the function did not return what the question asks for. "
            "Give a single expression; this is a Boolean.",
        ),
        (
            Question("function", result="expression", calls=([1], [2]), symbols={"w": (1, 2)}),
            returned(FIRST, STRAY),
            "stray symbol",
            "asks for. The answer contains `w`, but this question has no symbols.",
        ),
    ],
)
def test_what_is_said_of_an_answer_that_has_no_value(question, answer, note, message):
    answer = answer if isinstance(answer, dict) else to_plain(answer)
    with pytest.raises(Fault) as raised:
        read(question, answer)
    assert raised.value.note == note and message in raised.value.message


@pytest.mark.parametrize(
    ("question", "answer"),
    [
        (EXPRESSION, plain(["blank"])),
        (VECTOR, plain(["list", [["blank"], ["blank"]]])),
        (VECTOR, plain(["list", [["list", [["blank"]]], ["blank"]]])),
        (TEXT, plain(["text", " "])),
        (FUNCTION, returned(["blank"], ["blank"], worked=False)),
    ],
)
def test_what_is_left_blank_is_no_answer(question, answer):
    with pytest.raises(Blank):
        read(question, answer)


def test_what_a_function_returns_is_read_call_by_call():
    assert read(FUNCTION, returned(FIRST, SECOND)) == Reading([[1], [2]])


def test_what_has_no_value_here_is_left_to_a_person():
    with pytest.raises(Undecidable, match="^The answer contains gamma, which we cannot evaluate"):
        read(EXPRESSION, plain(SECOND, ONE, ["gamma", 0]))


def test_a_value_for_each_point():
    question = Question("vector", salt="a", symbols={"x": (1, 2)}, length=2)
    numbers = read(question, to_plain([x, 1])).numbers
    assert len(numbers) == 5 and all(1 < first < 2 and second == 1 for first, second in numbers)
    assert len({first for first, _ in numbers}) == 5


def test_arguments_are_made_anew_for_each_call():
    for takes, kind in (("lists", list), ("arrays", "ndarray")):
        asked = Question("function", calls=([[1, 2], "zxy", 3],), takes=takes)
        [[first, text, number]] = reading.calls_for(asked)
        assert type(first) is kind or type(first).__name__ == kind
        assert list(first) == [1, 2] and [text, number] == ["zxy", 3]
        assert type(text) is str and type(number) is int and first is not asked.calls[0][0]
    assert reading.calls_for(EXPRESSION) is None


# --- answers in words ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("question", "answer", "meant"),
    [
        *((CHOICE, spelling, "-i") for spelling in ("-i", "- I", "\u2212i", "\uff0di", " '-i' ")),
        (CHOICE, "\u201e\u2011i\u201c", "-i"),
        *((CHOICE, spelling, "1") for spelling in (1, 1.0, "+1", "+ 1", "'1'", ["1"])),
        *((CHOICE, spelling, "+x") for spelling in (x, "x", "+ X", "+x")),
        (CHOICE, plain(STRAY, MINUS, NAME, ["Mul", 0, 1]), "-i"),
        (CHOICE, plain(STRAY, NAME, MINUS, ["Mul", 0, 1]), "-i"),
        (CHOICE, "-  2  -", "- 2 -"),
        (CHOICE, "b", "b"),
        (WORDS, ["1", "None"], "1 | none"),
        (WORDS, [1, x], "1 | +x"),
        (ORDER, ["c", "A", "b"], "c < a < b"),
        (TRUTHS, [True, False, True], "TFT"),
        (TRUTHS, [1, 0, " true "], "TFT"),
        (TRUTHS, ["TRUE", " False", sm.true], "TFT"),
        (TEXT, " So it is. ", "So it is."),
        (TEXT, ["So ", "it is."], "So it is."),
    ],
)  # fmt: skip
def test_the_word_that_is_meant(question, answer, meant):
    answer = answer if isinstance(answer, dict) else to_plain(answer)
    assert read(question, answer) == Reading([], meant)


# --- numbers with tolerances ----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("question", "real", "most"),
    [
        (EXPRESSION, 1, 2 * EXACT),
        (EXPRESSION, 3, 4 * EXACT),
        (Question("expression", tolerance=0.25, relative=0.5), 2, MP.mpf("1.25")),
        (Question("expression", tolerance=0.25), 2, MP.mpf("0.25")),
        (Question("expression", tolerance=1e-15), 1, 2 * EXACT),
    ],
)
def test_what_may_remain_of_an_imaginary_part(question, real, most):
    assert reading._number(question, MP.mpc(real, most * MP.mpf("0.99"))) == real
    with pytest.raises(Fault, match="imaginary"):
        reading._number(question, MP.mpc(real, most * MP.mpf("1.01")))


def test_another_unit_is_farther_than_any_tolerance():
    for tolerance in (None, 1e-9, 10.0):
        question = Question("measurement", scale="1000", tolerance=tolerance)
        [right] = read(question, to_plain((2, "kN m"))).numbers
        [same] = read(question, to_plain((2000, "kg m^2/s^2"))).numbers
        assert right == same and right[0] == 2
        for unit in ("kN", "kN/m", "kN m s", "N m K"):
            [other_unit] = read(question, to_plain((2, unit))).numbers
            assert reading.distance(question, other_unit, right) > 10**5
    assert read(MEASUREMENT, to_plain((2, "kN"))).numbers[0][0] == 2000  # in an exam
    assert kinds.scale_of((5, "km/h")) == {"scale": "0.277777777777778"}


TOLERANT = Question("vector", salt="cells", tolerance=0.25, relative=0.5, length=2)
QUESTIONS = [
    Question("vector", salt="cells", length=2),
    Question("vector", salt="cells", tolerance=0.25, length=2),
    TOLERANT,
]


def test_how_far_two_answers_are_apart():
    assert reading.distance(TOLERANT, [3, 1], [2, 1]) == MP.mpf("0.8")
    assert reading.distance(TOLERANT, [2, 1], [3, 1]) == 1 / MP.mpf("1.75")
    assert reading.distance(TOLERANT, [2, 1], [2, -1]) == MP.mpf(2) / 0.75
    for numbers, right, most in (
        ([3.25, 1], [2, 1], 1),
        ([2, 0.25], [2, 1], 1),
        ([7, 1], [2, 1], 4),
    ):
        assert reading.within(TOLERANT, numbers, right, most)
        assert not reading.within(TOLERANT, numbers, right, most * 0.999)
    assert reading.within(TOLERANT, [3.25, 1], [2, 1])
    assert not reading.within(TOLERANT, [3.26, 1], [2, 1])
    assert reading.tolerances(Question("expression", tolerance=0.1)) == (MP.mpf("0.1"), 0)
    assert reading.tolerances(Question("expression", relative=0.1)) == (EXACT, EXACT)


WHERE = ["1098612289 -1386294362", "2 -2", "1 -1"]
NEARLY = "near 69 -87"


def test_where_the_cells_lie_is_what_it_was():
    """Every sealed file depends on it."""
    answer = Reading([[MP.mpf(2), MP.mpf(-3)]])
    assert [reading.fingerprint(case, answer) for case in QUESTIONS] == WHERE
    assert reading.fingerprint(QUESTIONS[0], answer, near=True) == NEARLY


@pytest.mark.parametrize("near", [False, True])
@pytest.mark.parametrize("question", QUESTIONS)
def test_the_cells_around_an_answer_hold_all_that_is_as_near(question, near):
    chance = random.Random(5)
    for _ in range(40):
        numbers = [MP.mpf(chance.uniform(-4, 4)) for _ in range(2)]
        answer, reach = Reading([numbers]), chance.choice([1, 2.5])
        texts = reading.fingerprints(question, answer, reach, near, most=99)
        assert texts[0] == reading.fingerprint(question, answer, near)
        absolute, relative = (NEAR, NEAR) if near else reading.tolerances(question)
        cells = []
        for order, number in enumerate(numbers):
            # Move so far on a scale in which each step is a tolerance.
            growth = MP.exp(reach * relative) if relative else 0
            moved = []
            for sign in (-1, 1):
                size, outward = abs(number), sign * (1 if number >= 0 else -1)
                if not relative:
                    new = number + sign * reach * absolute
                else:
                    offset = absolute / relative
                    scaled = (size + offset) * (growth if outward > 0 else 1 / growth) - offset
                    if scaled < 0:  # through zero
                        scaled = -offset * (
                            MP.exp(
                                (reach - (MP.log((size + offset) / offset) / relative)) * relative
                            )
                            - 1
                        )
                    new = scaled * (1 if number >= 0 else -1)
                moved.append(new)
            own = []
            for new in (number, *moved):
                changed_text = reading.fingerprint(
                    question, Reading([[*numbers[:order], new, *numbers[order + 1 :]]]), near
                )
                own.append(changed_text.removeprefix("near ").split()[order])
            cells.append(set(own))
        expected = {" ".join(chosen) for chosen in itertools.product(*cells)}
        assert {text.removeprefix("near ") for text in texts} == expected
        assert all(text.startswith("near ") == near for text in texts)


def test_of_many_edges_the_nearest_are_taken():
    question = Question("vector", salt="many", tolerance=0.25, length=9)
    answer = Reading([[MP.mpf(number) / 7 for number in range(9)]])
    edges = reading.edges_near(question, answer.numbers[0], 26)
    assert len(edges) == 18 and edges == sorted(edges)
    nearer, farther = (
        [reading.edges_near(QUESTIONS[1], [MP.mpf(number) / 3], *reach) for number in range(99)]
        for reach in ((), (2,))
    )
    assert nearer != farther and sum(map(len, nearer)) < sum(map(len, farther)) * 0.7
    for edges_of_one in nearer:
        assert all(far < MP.mpf(1) / 3 for far, _, _ in edges_of_one)
    for most in (1, 2, 3):
        reach = (edges[most - 1][0] + edges[most][0]) / 2 * reading._width(question, 9, False)
        nearest = reading.fingerprints(question, answer, reach, most=99)
        assert reading.fingerprints(question, answer, 26, most=most) == nearest
        assert len(nearest) == 2**most
    assert len(reading.fingerprints(question, answer, 26)) <= 2**6
    words = Reading([], "zxy")
    assert (
        reading.fingerprints(question, words) == [reading.fingerprint(question, words)] == ["zxy"]
    )


# --- one value for what can be written in several ways; faults of the form ----------------------


@pytest.mark.parametrize(("tolerance", "limit"), [(None, "2e-9"), (0.25, "2")])
def test_of_two_opposites_the_one_that_begins_above_zero(tolerance, limit):
    question = Question("vector", either_sign=True, tolerance=tolerance)
    limit, half = MP.mpf(limit), MP.mpf("0.5")
    assert kinds.sign_limit(question) == limit
    for numbers, turned in (
        ([-limit - half, 1], True),
        ([limit + half, -1], False),
        ([limit, -3], True),
        ([-limit, 3], False),
        ([limit * 2, -1], False),
        ([0, 0], False),
    ):
        expected = [-number for number in numbers] if turned else numbers
        assert kinds.one_sign(question, numbers) == expected
        assert kinds.one_sign(Question("vector"), numbers) == numbers
        read_twice = Reading([numbers, numbers])
        assert reading.canonical(question, read_twice) == 2 * expected
    assert reading.canonical(EXPRESSION, Reading([[1], [2]])) == [1, 2]


@pytest.mark.parametrize(("tolerance", "slack"), [(None, "1e-9"), (0.125, "0.75")])
def test_the_length_of_a_unit_vector(tolerance, slack):
    question = Question("vector", unit_vector=True, tolerance=tolerance)

    def fault_of(length):
        numbers = [length * 2 / MP.mpf(3), -length / 3, length * 2 / MP.mpf(3)]
        assert reading.fault(Question("vector"), Reading([numbers])) is None
        return reading.fault(question, Reading([[0, 1, 0], numbers]))

    for sign in (1, -1):
        assert fault_of(1 + sign * MP.mpf(slack) * MP.mpf("0.99")) is None
        assert fault_of(1 + sign * MP.mpf(slack) * MP.mpf("1.01")).note == "not unit length"
    assert fault_of(MP.mpf(2)).message.endswith("this one has length 2.")
    assert reading.fault(question, Reading([], "a")) is None
    assert reading.fault(EXPRESSION, Reading([[1]])) is None


@pytest.mark.parametrize(
    ("length", "words"),
    [("1.0437", "1.04"), ("1.0000437", "1.00004"), ("2", "2"), ("1.000000001", "1.000000001")],
)
def test_a_length_with_the_digits_that_show_that_it_is_not_one(length, words):
    assert kinds.length_in_words(MP.mpf(length)) == words
    assert kinds.short(MP.mpf(length)) == str(MP.nstr(MP.mpf(length), 3))


def test_the_transpose():
    square = Question("matrix", shape=(2, 2))
    assert kinds.transposed(square, [1, 2, 3, 4]) == [1, 3, 2, 4]
    assert kinds.transposed(SQUARE, [*range(9)]) == [0, 3, 6, 1, 4, 7, 2, 5, 8]
    assert kinds.transposed(MATRIX, [*range(6)]) is None
    assert KINDS["matrix"].slips["transposed"][1] is kinds.transposed


def test_degrees_are_no_unit():
    assert abs(read(EXPRESSION, to_plain(180 * units.degree)).numbers[0][0] - MP.pi) < 1e-30
