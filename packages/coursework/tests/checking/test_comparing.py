"""Replies to answers, verbatim, with lockers that are found without a slow hash."""

import hashlib
import json
import math
from dataclasses import replace

import pytest
import sympy as sm

from coursework.checking import questions, sealing
from coursework.checking.catalogue import by_short_name
from coursework.checking.fields import Misread
from coursework.checking.kinds import Fault
from coursework.checking.mistakes import short_name
from coursework.checking.plain import to_plain
from coursework.checking.plugins import kinds
from coursework.checking.question import KnownAnswer, Locker, Note, Place, Question, Sealed, Variant
from coursework.checking.questions import NoSuchQuestion, compare, find_question, judge
from coursework.checking.reading import canonical, fingerprint, read

x, y = sm.symbols("x y")


def text_of(question, answer, near=False):
    return fingerprint(question, read(question, to_plain(answer)), near)


def numbers_of(question, answer):
    return tuple(map(str, canonical(question, read(question, to_plain(answer)))))


def mistake(words, **more):
    return KnownAnswer("mistake", (Note("authored", {"text": words}),), **more)


CORRECT = KnownAnswer("correct")


def reply_to(question, lockers, answer, for_others=None):
    """Return the outcome, the note and the words of a reply."""
    reply = compare(
        "a/b", question, to_plain(answer), (None if lockers is None else lockers.get), for_others
    )
    assert reply.question == "a/b"
    if reply.outcome in ("correct", "wrong", "recorded") and reply.note != "other numbers":
        text = text_of(question, answer)
        assert reply.answer == hashlib.sha256(text.encode()).hexdigest()[:12]
    return reply.outcome, reply.note, *reply.messages


# ---- exact answers -----------------------------------------------------------------------------

EXACT = Question("vector", salt="s", symbols={"x": (1.0, 2.0)}, every_symbol=True)
RIGHT = [x, sm.sqrt(2) / 3, 5]
SLIP = [x, sm.sqrt(2) / 3, -5]
LOCKERS = {
    text_of(EXACT, RIGHT): Locker((CORRECT,)),
    text_of(EXACT, SLIP): Locker((mistake("A sign."),)),
    text_of(EXACT, [x, 0.4714, 5], near=True): Locker(),
}
DECIMALS = (
    "Your answer has decimal fractions. Write symbols or exact numbers instead, such as "
    "`sm.Rational(1, 2)` and `sm.sqrt(3)`."
)
NEARLY = "This agrees with the right answer to three digits or more."
BLANK = "Put your answer in place of the `...` and run the cells again."
STRAY = "The answer contains `y`, but this question has the symbol `x`."
ALL_WRONG = questions.kind_of_values(EXACT).wrong
NUMBERS_ONLY = "The question uses `x`, but your answer contains only numbers."
FORM = "Otherwise: " + ALL_WRONG[:1].lower() + ALL_WRONG[1:]


@pytest.mark.parametrize(
    ("answer", "expected"),
    [
        (RIGHT, ("correct", "")),
        ([x, float(sm.sqrt(2) / 3), 5], ("correct", "")),
        (SLIP, ("wrong", "authored", "A sign.")),
        ([x, 0.4714, 5], ("wrong", "rounded too far", NEARLY, DECIMALS)),
        ([x, 0.47140452, 5], ("wrong", "rounded too far", NEARLY, DECIMALS)),
        ([x, 0.3, 5], ("wrong", "", f"{DECIMALS} {ALL_WRONG}")),
        ([x, sm.sqrt(2) / 3, 6], ("wrong", "", ALL_WRONG)),
        ([x, sm.Rational(4714, 10000), 5], ("wrong", "", ALL_WRONG)),  # Near, but not rounded.
        ([1, sm.sqrt(2) / 3, 6], ("wrong", "", NUMBERS_ONLY)),
        (["x", 1, 2], ("invalid", "shape")),
        (
            ...,
            ("not attempted", "", BLANK),
        ),
        (
            [y, 1, 2],
            ("invalid", "stray symbol", STRAY),
        ),
        ([sm.gamma(x), 1, 2], ("undecided", "undecidable")),
    ],
)
def test_an_exact_answer(answer, expected):
    reply = reply_to(EXACT, LOCKERS, answer)
    assert reply[: len(expected)] == expected
    if expected[0] == "undecided":
        assert reply[2].endswith(
            "evaluate. Try another form, or ask your instructor to look at it."
        )


def test_a_symbol_that_is_missing_is_named():
    question = Question("expression", symbols={"x": (1, 2), "phi": (1, 2), "z": (1, 2)})
    plain = to_plain(x + sm.Symbol("varphi"))
    wrong = questions.kind_of_values(question).wrong
    assert questions.what_can_be_said(question, plain) == wrong
    asked = Question("expression", symbols=question.symbols, every_symbol=True)
    assert questions.what_can_be_said(asked, plain) == f"{wrong} Your answer contains no `z`."
    holds = questions.what_can_be_said(asked, to_plain(sm.Symbol("z")))
    assert holds == f"{wrong} Your answer contains no `x` and no `phi`."
    only = "The question uses `x`, `phi`, `z`, but your answer contains only numbers."
    assert questions.what_can_be_said(asked, to_plain(3)) == only


def test_degrees_are_told_from_radians():
    turns = Question("vector", salt="s", tolerance=0.001, length=2, quantity="angle")
    known = {text_of(turns, [0.5, -1]): Locker((CORRECT,))}
    known[text_of(turns, [-0.5, -1])] = Locker((mistake("A sign."),))
    degrees = reply_to(turns, known, [math.degrees(0.5), math.degrees(-1)])
    assert degrees[:2] == ("wrong", "in degrees") and "in degrees" in degrees[2]
    both = reply_to(turns, known, [math.degrees(-0.5), math.degrees(-1)])
    assert both[1] == "in degrees, and authored" and both[2].endswith("A sign.")


def test_what_may_be_asked_in_degrees_is_not_told_of_them_falsely():
    """Two degrees equal 0.0349, but a mistake in one unit is none in the other."""
    box = Question("vector", salt="s", tolerance=0.005, length=2)
    known = {text_of(box, [10, 0.2]): Locker((CORRECT,))}
    known[text_of(box, [0.17453, 0.035])] = Locker((mistake("The angle is in radians."),))
    assert reply_to(box, known, [10, 2])[1] == ""
    assert reply_to(box, known, [572.9578, 11.459])[2].endswith(
        "Does the question ask for radians?"
    )


def test_a_reply_holds_what_was_opened():
    known = LOCKERS[text_of(EXACT, SLIP)]
    reply = compare("a/b", EXACT, to_plain(SLIP), LOCKERS.get)
    assert (reply.opened, reply.known, reply.details) == (
        known,
        known.answers[0],
        {"text": "A sign."},
    )
    reply = compare("a/b", EXACT, to_plain(RIGHT), LOCKERS.get)
    assert (reply.opened, reply.known) == (LOCKERS[text_of(EXACT, RIGHT)], None)


def test_what_is_right_for_others_is_said_before_anything_else():
    unknown_answer = [x, sm.sqrt(2) / 3, 7]
    assert reply_to(EXACT, LOCKERS, unknown_answer, lambda: True)[:2] == ("wrong", "other numbers")
    assert reply_to(EXACT, LOCKERS, unknown_answer, lambda: False)[1] == ""
    for answer in (RIGHT, SLIP):
        assert reply_to(EXACT, LOCKERS, answer, lambda: True) == reply_to(EXACT, LOCKERS, answer)


# ---- answers with a tolerance ------------------------------------------------------------------

ROUGH = Question("vector", salt="s", tolerance=0.01, length=2)
CENTRE = [sm.Rational(1, 3), 2]
OFF = "off by more than the 0.01 that is allowed. If you rounded, here or earlier, keep "


def rough(*answers):
    """Return one locker for answers whose numbers are in the same cell."""
    known = [
        KnownAnswer(known_answer.outcome, known_answer.notes, numbers=numbers_of(ROUGH, at))
        for known_answer, at in answers
    ]
    return type("Any", (dict,), {"get": lambda self, text: Locker(tuple(known))})()


@pytest.mark.parametrize(
    ("answer", "expected"),
    [
        ([0.333, 2], ("correct", "")),
        ([0.3433, 2], ("correct", "")),
        ([0.3434, 2], ("wrong", "rounded too far")),
        ([0.3333, 2.29], ("wrong", "rounded too far")),
        ([0.3333, 2.32], ("wrong", "")),
        ([0.36, 2], ("wrong", "authored", "Near.")),
    ],
)
def test_an_answer_is_the_nearest_that_is_known(answer, expected):
    lockers = rough((CORRECT, CENTRE), (mistake("Near."), [sm.Rational(36, 100), 2]))
    reply = reply_to(ROUGH, lockers, answer)
    assert reply[: len(expected)] == expected
    if expected[1] == "rounded too far":
        assert reply[2].startswith(f"This is close, but {OFF}")
    only = reply_to(ROUGH, rough((mistake("Near."), CENTRE)), [0.3434, 2])
    assert only[:2] == ("wrong", "") and reply_to(ROUGH, {}, [0.3434, 2]) == only


def test_numbers_with_fewer_places_than_count_may_be_rounded():
    vector = Question("vector", salt="s", tolerance=0.004, relative=0.001, length=2)
    exacting = replace(vector, tolerance=5e-13, relative=0)
    enough = (-110.33, 4.33, 7.0, 0.5, 0.333, 0.25, 1e-5)
    for question, entry, places, allowed in (
        (vector, 0.33, "2 decimal places", "0.004"), (vector, 1.3, "1 decimal place", "0.005"),
        (vector, 10.3, "1 decimal place", "0.01"), (vector, 0.2, "1 decimal place", "0.004"),
        (exacting, 2.78188565, "8 decimal places", "5e-13"),
    ):  # fmt: skip
        assert reply_to(question, {}, [entry, 1])[2] == (
            f"If you rounded, keep all digits until the end: `{entry}` has {places}, but an "
            f"answer may be off by at most {allowed}. {FORM}"
        )
    assert {reply_to(vector, {}, [entry, sm.Rational(1, 3)])[2] for entry in enough} == {ALL_WRONG}
    # Nobody has rounded the components of an exact vector, or one of two numbers.
    assert {
        reply_to(vector, {}, exact)[2] for exact in ([0.6, -0.8], [3.6, 4.8], [1.2, -1.0478969291])
    } == {ALL_WRONG}


def test_numbers_that_nearly_fit_together_may_be_rounded():
    unit = Question("vector", salt="s", tolerance=1e-6, unit_vector=True)
    right, coarse, wrong = (
        reply_to(unit, {}, answer) for answer in [[sm.sqrt(3) / 3] * 3, [0.577] * 3, [0.5] * 3]
    )
    assert right[1] == "" and coarse[:2] == wrong[:2] == ("invalid", "not unit length")
    assert coarse[2].startswith("The numbers nearly fit together. If you rounded, ")
    assert "0.999" in coarse[3]
    assert len(wrong) == 3 and wrong[2].endswith("this one has length 0.866.")
    exact = Question("vector", salt="s", unit_vector=True)
    assert reply_to(exact, {}, [0.577] * 3)[1:3] == ("not unit length", DECIMALS)
    assert reply_to(exact, {}, [sm.Rational(1, 2)] * 3)[1:] == wrong[1:]
    # A known mistake comes first, and so does an answer that only its length excludes.
    for known, outcome in ((mistake("Known."), "wrong"), (CORRECT, "invalid")):
        locker = {text_of(exact, [1, 1, 0]): Locker((known,))}
        assert reply_to(exact, locker, [1, 1, 0])[0] == outcome


def test_of_decimal_fractions_some_are_plainly_exact_and_some_plainly_rounded():
    texts = {
        "0.5": (True, False), "0.333": (False, True), "-0.333": (False, True),
        "0.8660254037844386": (True, False), "0.3333333333333333": (True, False),
        "0.015625": (True, False), "0.0078125": (False, True), "0.001": (False, True),
        "0.0010010010010010010": (True, False), "0.0009990009990009990": (False, False),
        "12345.333333333334": (True, False), "0.50000000000015": (False, False),
        "0.1234567891234": (False, False), "0.12345678": (False, True), "1e10": (True, False),
        # The square is so large that hardly any of its decimals are known.
        "12345.0000000005": (True, False), "123456.79": (False, True),
    }  # fmt: skip
    precision = {text: questions._precision({"nodes": [["float", text]]}) for text in texts}
    assert precision == texts
    several = {"nodes": [["float", "0.333"], ["symbol", "x"], ["float", "0.1234567891234"]]}
    assert questions._precision(several) == (False, True)
    assert questions._precision({"nodes": [["integer", "3"]]}) == (True, False)


def test_which_faults_of_the_form_no_right_value_makes_good(monkeypatch):
    def fault(question, numbers):
        return Fault(question.quantity, "A fault.")

    monkeypatch.setitem(kinds(), "odd", kinds()["vector"]._replace(fault=fault))
    for note, known, decimals in (
        ("stray symbol", False, False), ("odd", False, True), ("not unit length", True, True),
    ):  # fmt: skip
        question = Question("odd", salt="s", quantity=note)
        lockers = {text_of(question, [1, 2, 0.5]): Locker((CORRECT,))}
        expected = ("invalid", note, *([DECIMALS] if decimals else []), "A fault.")
        assert reply_to(question, {}, [1, 2, 0.5]) == expected
        reply = reply_to(question, lockers, [1, 2, 0.5])
        assert reply == (expected if known else ("correct", ""))


# ---- slips, exams, people ----------------------------------------------------------------------


def test_a_mistake_is_found_beside_a_slip():
    matrix = Question("matrix", salt="s", shape=(2, 2))
    right, mistaken = sm.Matrix([[1, 2], [3, 4]]), sm.Matrix([[1, 5], [3, 4]])
    lockers = {
        text_of(matrix, right): Locker((CORRECT,)),
        text_of(matrix, mistaken): Locker((mistake("Known."),)),
        text_of(matrix, mistaken + right): Locker(
            (KnownAnswer("mistake", (Note("transposed", {}),)),)
        ),
    }
    said_of_slip = questions.kind_of_values(matrix).slips["transposed"][0]
    assert reply_to(matrix, lockers, mistaken.T) == (
        "wrong",
        "transposed, and authored",
        f"Two mistakes at once: {said_of_slip} Known.",
    )
    twice = reply_to(matrix, lockers, (mistaken + right).T)
    assert twice[:2] == ("wrong", "rounded too far") and "more than allowed" in twice[2]
    assert (
        reply_to(matrix, lockers, right.T)[1] == ""
    )  # The transpose of the right answer is no mistake.
    assert reply_to(matrix, lockers, 0.3333 * mistaken.T)[1] == ""
    reply = compare("a/b", matrix, to_plain(mistaken.T), lockers.get)
    assert reply.details == {"text": "Known."}
    rough = Question("matrix", salt="s", shape=(2, 2), tolerance=0.01)
    at = [[1, 5], [sm.Rational(1, 3), 4]]
    near = KnownAnswer(
        "mistake", (Note("authored", {"text": "Known."}),), (), numbers_of(rough, at)
    )
    cells = {text_of(rough, at): Locker((near,))}
    assert reply_to(rough, cells, [[1, 0.333], [5, 4]])[1] == "transposed, and authored"
    # A rounded answer is no known mistake to the digit.
    for entry, note in ((0.333, ""), (0.5, "transposed, and authored")):
        answer = sm.Matrix([[1, 3], [entry, 4]])
        lockers[text_of(matrix, answer.T)] = Locker((mistake("Known."),))
        assert reply_to(matrix, lockers, answer)[1] == note
    wide = Question("matrix", salt="s", shape=(1, 2))
    assert reply_to(wide, {}, [[1, 2]])[:2] == ("wrong", "")


def test_in_an_exam_only_the_form_is_looked_at():
    unit = Question("vector", salt="s", unit_vector=True)
    assert reply_to(unit, None, [1, 0, 0])[:2] == ("recorded", "")
    assert "nothing in your files shows whether it is right" in reply_to(unit, None, [1, 0, 0])[2]
    assert reply_to(unit, None, [1, 1, 0])[:2] == ("invalid", "not unit length")
    sealed = Sealed(Question("vector", salt="s", exam=True))
    reply = judge("a/b", sealed, to_plain([1, 1, 0]))
    assert (reply.question, reply.outcome) == ("a/b", "recorded")
    form = judge("a/b", Sealed(replace(sealed.question, unit_vector=True)), to_plain([1, 1, 0]))
    assert (form.question, form.outcome, form.note) == ("a/b", "invalid", "not unit length")
    assert form.messages == list(reply_to(unit, {}, [1, 1, 0])[2:])


def test_words_and_what_a_person_reads():
    choice = Question("choice", salt="s", options=("up", "down"))
    lockers = {"up": Locker((CORRECT,))}
    assert reply_to(choice, lockers, "UP") == ("correct", "")
    wrong = questions.kind_of_values(choice).wrong
    assert reply_to(choice, lockers, "down") == ("wrong", "", wrong)
    number = Question("choice", salt="s", options=("1", "2"))
    assert reply_to(number, {}, 2.0) == ("wrong", "", wrong)
    text = Question("free text")
    for answer, words in (("One", "1 word"), ("One  two", "2 words")):
        reply = compare("a/b", text, to_plain(answer), {}.get)
        assert (reply.question, reply.answer) == ("a/b", "")
        assert (reply.outcome, reply.note) == ("undecided", "for a person")
        assert reply.messages == [f"A person will mark this answer ({words})."]


# ---- sealed files -------------------------------------------------------------------------------


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    """Use one round of the slow hash."""
    monkeypatch.setattr(sealing, "ROUNDS", 1)


def locked(question, answer, outcome, *notes, **more):
    key = sealing.slow_key(question.salt, text_of(question, answer))
    return sealing.locker(key, outcome, [short_name(*note) for note in notes], **more)


def test_lockers_and_pages_of_a_question_are_opened():
    page_key = bytes(range(8))
    locker_data = {
        "cases": [CORRECT.as_json()],
        "solution": [1, "00" * 8, sealing.shorten("Two.", "One.")],
    }
    pages = (
        sealing.seal(locker_data, page_key),
        sealing.seal({"words": "One."}, bytes(8)),
        sealing.seal({"solution": "Three."}, bytes(8)),
    )
    opposite = next(note for note in by_short_name(EXACT).values() if not note.details)
    lockers = sealing.pack([
        locked(EXACT, RIGHT, 0, page=0, page_key=page_key), locked(EXACT, SLIP, 1, opposite),
        locked(EXACT, [x, 0, 0], 0),
    ])  # fmt: skip
    sealed = Sealed(EXACT, lockers, pages=pages)
    locker = questions.opened(sealed, text_of(EXACT, RIGHT))
    assert locker.place == Place(0, page_key.hex()) and locker.answers == (CORRECT,)
    assert questions.solution_on(sealed, locker.solution) == "Two."
    assert questions.solution_on(sealed, Place(2, "00" * 8)) == "Three."
    assert questions.solution_on(sealed, "Four.") == "Four."
    empty = Sealed(EXACT, pages=(sealing.seal({}, bytes(8)),))
    assert questions.solution_on(empty, Place(0, "00" * 8)) == ""
    known = Locker((KnownAnswer("mistake", (opposite,)),))
    assert questions.opened(sealed, text_of(EXACT, SLIP)) == known
    assert questions.opened(sealed, text_of(EXACT, [x, 0, 0])) == Locker((CORRECT,))
    assert questions.opened(sealed, text_of(EXACT, [0, x, 0])) is None
    for content in ({"cases": 7}, []):
        damaged = Sealed(EXACT, lockers, pages=(sealing.seal(content, page_key),))
        with pytest.raises(Misread, match="^Page 0"):
            questions.opened(damaged, text_of(EXACT, RIGHT))
    for short, words in (("s", "^A page should be .*'words'"), ("", "^A page: 'solution' should")):
        page = Sealed(EXACT, pages=(sealing.seal({"solution": 7}, bytes(8)),))
        with pytest.raises(Misread, match=words):
            questions.solution_on(page, Place(0, "00" * 8, short))
    strange = sealing.locker(sealing.slow_key("s", text_of(EXACT, SLIP)), 1, [b"\1\2\3\4"])
    reply = judge("a/b", Sealed(EXACT, sealing.pack([strange])), to_plain(SLIP))
    assert reply.messages == [questions.NOT_IN_THIS_CATALOGUE] and reply.note == "authored"


def test_codes_and_keys_stay_what_they_are():
    assert questions.code_text(" ab-cd 01 ilo9\n") == "code ABCDL9"
    assert questions.rung_key(EXACT, 2) == hashlib.sha256(b"step 2 for vector").digest()[:8]
    assert questions.salt_of_all("a/b") == hashlib.sha256(b"a/b, all variants").hexdigest()[:16]


# ---- the files, and the names in them ----------------------------------------------------------


def varied(number, answer):
    """Return one of a question's three variants, which recognise each other's right answers."""
    salt = questions.salt_of_all("levers/arm")
    question = Question(
        "expression", f"s{number}",
        variant=Variant(number, 3, {"arm": number}, {"arm": str(number)}, "An arm of {{arm}}."),
    )  # fmt: skip
    common = Question("expression", salt)
    keys = [sealing.slow_key(salt, text_of(common, right)) for right in (70, 71, 72)]
    names = sealing.pack_names(map(sealing.name_of, keys), 4)
    first = number == 0
    return Sealed(
        question, sealing.pack([locked(question, answer, 0)]), answer="arm",
        pages=("p0", "p1") if first else ("p2",), ladder=("l",) if first else (),
        others=(salt, names),
    ).as_json()  # fmt: skip


@pytest.fixture
def folder(tmp_path, monkeypatch):
    sealed = tmp_path / "sealed"
    (sealed / "variants").mkdir(parents=True)
    plain = Sealed(EXACT, sealing.pack([locked(EXACT, RIGHT, 0)])).as_json()
    first, *others = (varied(number, 70 + number) for number in range(3))

    def write(name, about, format=4):
        (sealed / name).write_text(json.dumps({"format": format, "questions": about}))

    write("levers.json", {"levers/arm": first, "levers/plain": plain})
    for number, variant_data in enumerate(others, 1):
        write(
            f"variants/levers-{number}.json", {"levers/arm": questions.beside(variant_data, first)}
        )
    write("later.json", {}, 5)
    write("third.json", {"third/a": plain})
    (sealed / "notes.txt").write_text("")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(questions, "sealed_folders", list)
    questions.notebook_questions.cache_clear()
    yield sealed
    questions.notebook_questions.cache_clear()


def student_with(number):
    return next(
        student_name
        for student_name in (f"s{k}" for k in range(99))
        if questions.own_numbers("levers/arm", student_name)[0] == number
    )


def test_an_answer_to_other_numbers_is_told(folder):
    student = student_with(1)
    sealed = find_question("levers/arm", student)

    def reply(answer, who=student, sealed=sealed):
        judged = judge("levers/arm", sealed, to_plain(answer), who)
        assert judged.question == "levers/arm"
        return judged.outcome, judged.note, *judged.messages

    others = ("wrong", "other numbers", questions.FOR_OTHERS)
    assert reply(71) == ("correct", "") and reply(70) == reply(72) == others
    nobody = judge("levers/arm", sealed, to_plain(70))
    assert reply(73)[1] == reply(70, "")[1] == nobody.note == ""
    first = find_question("levers/arm", "")
    assert reply(72, sealed=first) == others
    for answer in (..., "a text", sm.gamma(x), x):
        assert not questions.is_right_for_others(sealed, to_plain(answer))
    assert not questions.is_right_for_others(Sealed(EXACT), to_plain(RIGHT))


LONG = "levers/" + "a" * 90


@pytest.mark.parametrize(
    ("name", "words"),
    [
        (7, "first, as a string: .* Yours is of type `int`"),
        (type("T" * 50, (), {})(), f"of type `{'T' * 40}`"),
        ("levers/arm/sibling-3", "-3' .* the siblings of 'levers/arm' are levers/arm/sibling and "),
        ("levers/plain/sibling", "does not exist: 'levers/plain' has only one set of numbers"),
        ("levers", "^'levers' is a notebook. Its questions are 'levers/arm', 'levers/plain'"),
        ("levers/plan", r"^There is no question 'levers/plan'\. Did you mean 'levers/plain'\?$"),
        ("Levers/Arm", r"Did you mean 'levers/arm'\?"),
        ("lever/arm", r"^There is no question 'lever/arm'. Did you mean 'levers/arm'\?"),
        ("third/zzzzzzzz", r"Did you mean 'third/a'\?"),
        ("zzzzzzzz", r"^There is no question 'zzzzzzzz'\. A name begins with that of its notebook"),
        ("../levers/arm", "There is no question"),
        (LONG, f"^There is no question '{LONG[:80]}'"),
    ],
)  # fmt: skip
def test_a_name_that_is_none_is_explained(folder, name, words):
    with pytest.raises(NoSuchQuestion, match=words) as error:
        find_question(name, "")
    assert str(error.value) == error.value.args[0]


def test_files_that_are_not_there_or_too_new_are_explained(folder, tmp_path, monkeypatch):
    for name in ("later/a", "later"):
        with pytest.raises(RuntimeError, match="of later have format 5, .* which reads format 4"):
            find_question(name, "")
    (folder / "bad.json").write_text('{"format": "4", "questions": {}}')
    with pytest.raises(RuntimeError, match="^The sealed questions of bad: 'format' should be"):
        find_question("bad/a", "")
    monkeypatch.chdir(folder)
    with pytest.raises(NoSuchQuestion, match="^We cannot find .* or any other question: ") as error:
        find_question(LONG, "")
    assert f"(in {folder})" in str(error.value) and f"'{LONG[:80]}'" in str(error.value)
    assert questions.places() == []
    monkeypatch.setattr(questions, "sealed_folders", lambda: [folder])
    assert questions.places() == [folder]
    assert find_question("third/a", "").question.kind == EXACT.kind


def test_files_that_are_elsewhere_are_fetched(folder, monkeypatch):
    from coursework.checking import elsewhere

    text = (folder / "levers.json").read_text()
    asked = []
    monkeypatch.setattr(
        elsewhere, "fetched", lambda place, name: asked.append((place, name)) or text
    )
    student = student_with(1)
    (folder / "variants" / "levers-1.json").unlink()
    questions.notebook_questions.cache_clear()
    with pytest.raises(KeyError):
        find_question("levers/nothing", student)
    assert asked == [] and questions.notebook_questions("levers", 9) == {}
    (folder / questions.ELSEWHERE).write_text("https://example.org/")
    questions.notebook_questions.cache_clear()
    assert questions.notebook_questions("no-such") == {} and asked == []
    assert find_question("levers/arm", student).question.given == {"arm": 0}
    assert [(str(place), name) for place, name in asked] == [
        ("sealed/elsewhere.txt", "variants/levers-1.json")
    ]
