"""A question as data: every field is read by its type, and written again."""

import json
from dataclasses import fields

import pytest

from coursework.checking import questions
from coursework.checking.fields import Misread
from coursework.checking.question import (
    KnownAnswer,
    Locker,
    Note,
    Place,
    Question,
    Sealed,
    Variant,
)
from coursework.grading.judging.contract import Contract
from coursework.grading.record import Record

OF_VARIANT = {
    "variant": 3, "variants": 9, "given": {"arm": 2, "names": ["a"]}, "shown": {"arm": "2"},
    "text": "Give {{arm}}.", "picture": "packed", "names": ["v", "w"], "edition": "2027",
}  # fmt: skip
OF_QUESTION = {
    "kind": "function", "salt": "abc", "frames": ["N", "A"], "symbols": {"x": [1, 2.5]},
    "unit": [["a", "b"], ["c"]], "shape": [2, 3], "length": 4, "options": ["up", "down"],
    "tolerance": 0.1, "relative": 0.01, "calls": [[1, "x"], [[2]]], "takes": "arrays",
    "result": "vector", "quantity": "length", "either sign": True, "unit vector": False,
    "every symbol": True, "scale": "1000", "exam": True,
}  # fmt: skip
OF_SEALED = {
    "lockers": "packed", "worth": 2.5, "answer": "moment", "pages": ["p", "q"], "ladder": ["l"],
    "others": ["salt", "names"],
}  # fmt: skip
OWN = {"sequence": "zxy", "further": {"a": [1]}}
WHOLE = OF_QUESTION | OF_VARIANT | OF_SEALED | OWN
VARIANT = Variant(
    3, 9, {"arm": 2, "names": ["a"]}, {"arm": "2"}, "Give {{arm}}.", "packed", ("v", "w"), "2027"
)
QUESTION = Question(
    "function", "abc", ("N", "A"), {"x": (1, 2.5)}, (("a", "b"), ("c",)), (2, 3), 4,
    ("up", "down"), 0.1, 0.01, ([1, "x"], [[2]]), "arrays", "vector", "length", True, False, True,
    "1000", True, VARIANT, OWN,
)  # fmt: skip


def test_every_field_is_read_and_written():
    sealed = Sealed(QUESTION, "packed", 2.5, "moment", ("p", "q"), ("l",), ("salt", "names"))
    assert Sealed.from_json(WHOLE, "here") == sealed and sealed.as_json() == WHOLE
    assert (
        Question.from_json(WHOLE) == QUESTION
        and QUESTION.as_json() == OF_QUESTION | OF_VARIANT | OWN
    )
    about = {field.name.replace("_", " ") for kind in (Question, Sealed) for field in fields(kind)}
    inner = {"question", "variant", "arguments"}
    # A new field must be added here, too.
    assert about - inner == OF_QUESTION.keys() | OF_SEALED.keys()


def test_what_is_empty_is_left_out():
    sealed = Sealed.from_json({"kind": "vector"}, "here")
    assert sealed == Sealed(Question("vector"))
    assert sealed.as_json() == {"kind": "vector", "salt": "", "lockers": "", "worth": 1}
    assert Question.from_json({"kind": "function", "takes": "lists"}).takes == "lists"
    question = Question.from_json({"kind": "vector", "variants": 2})
    assert question == Question("vector", variant=Variant(0, 2))
    empty = {"variant": 0, "variants": 2, "given": {}, "shown": {}, "text": ""}
    assert question.as_json() == {"kind": "vector", "salt": ""} | empty
    assert (question.variants, question.given, Question("vector").variants) == (2, {}, 1)
    assert (QUESTION.variants, QUESTION.given) == (9, VARIANT.given)
    kinds = [Question("function", result="vector"), Question("function"), Question("a", result="b")]
    assert [question.kind_of_values for question in kinds] == ["vector", "function", "a"]


@pytest.mark.parametrize("name", [*OF_QUESTION, *OF_VARIANT, *OF_SEALED])
def test_what_a_field_cannot_be_is_said_with_its_name(name):
    with pytest.raises(Misread, match=f"^here: '{name}' should be .* not <class 'int'>"):
        Sealed.from_json(WHOLE | {name: int}, "here")
    for inner in (("frames", [1]), ("unit", [[1]]), ("calls", [1]), ("shape", [1.5, 2])):
        with pytest.raises(Misread, match=f"^here: '{inner[0]}' should be"):
            Question.from_json(WHOLE | dict([inner]), "here")


def test_a_question_and_what_is_known_of_it_say_where_they_stand():
    with pytest.raises(Misread, match="^a question should be an object with 'kind'"):
        Question.from_json({})
    for reader in (Question, Sealed, KnownAnswer, Locker):
        with pytest.raises(Misread, match="^here should be an object, not 7"):
            reader.from_json(7, "here")


KNOWN = {
    "outcome": "mistake", "notes": [["sign", {"of": "x"}]], "hints": ["Look."], "numbers": ["1.5"],
}  # fmt: skip
LOCKER = {"cases": [KNOWN, {"outcome": "correct", "notes": []}], "after": {"a/b": ["Now this."]}}


def test_what_a_locker_holds_is_read_and_written():
    answers = (
        KnownAnswer("mistake", (Note("sign", {"of": "x"}),), ("Look.",), ("1.5",)),
        KnownAnswer("correct"),
    )
    locker = Locker.from_json(LOCKER, "here", Place(1, "ab"))
    assert locker == Locker(answers, {"a/b": ("Now this.",)}, None, Place(1, "ab"))
    assert locker.as_json() == LOCKER and Locker.from_json({}, "here") == Locker()
    assert Locker().as_json() == {"cases": []}
    for solution, read in (
        ("text", "text"),
        ([2, "cd"], Place(2, "cd")),
        ((2, "c", "s"), Place(2, "c", "s")),
    ):
        assert Locker.from_json({"solution": solution}, "here").solution == read


@pytest.mark.parametrize(
    ("about", "message"),
    [
        ({"cases": [{"notes": []}]}, "here: 'cases' should be an object with 'outcome'"),
        ({"cases": [KNOWN | {"outcome": "wrong"}]}, "here: 'cases': 'outcome' should be one of"),
        ({"cases": [KNOWN | {"notes": [["a"]]}]}, "here: 'cases': 'notes' should be a list of two"),
        ({"cases": [KNOWN | {"notes": [[1, {}]]}]}, "here: 'cases': 'notes' should be a string"),
        ({"cases": [KNOWN | {"notes": [["a", 1]]}]}, "here: 'cases': 'notes' should be an object"),
        ({"cases": [KNOWN | {"hints": [1]}]}, "here: 'cases': 'hints' should be a string"),
        ({"cases": [KNOWN | {"numbers": [1]}]}, "here: 'cases': 'numbers' should be a string"),
        ({"after": {"a/b": 1}}, "here: 'after': 'a/b' should be a list"),
        ({"solution": 1}, "here: 'solution' should be a page with its key, not 1"),
        ({"solution": [1]}, "here: 'solution' should be a page with its key, not [1]"),
        ({"solution": [1, "a", "b", "c"]}, "here: 'solution' should be a page with its key"),
        ({"solution": ["1", "a"]}, "here: 'solution' should be a whole number"),
        ({"solution": [1, 2]}, "here: 'solution' should be a string, not 2"),
    ],
)
def test_what_a_locker_cannot_hold_is_said(about, message):
    with pytest.raises(Misread) as error:
        Locker.from_json(about, "here")
    assert str(error.value).startswith(message)


# --- errors in their places -----------------------------------------------------------------------


LEVER = {
    "kind": "expression", "salt": "b", "symbols": {"F": [1, 5]}, "answer": "moment", "worth": 2,
    "lockers": "", "variant": 1, "variants": 2, "given": {"arm": 2}, "shown": {"arm": "2"},
    "text": "{{arm}}", "sequence": "zxy",
}  # fmt: skip
MARK = {"outcome": "wrong", "note": "", "messages": [], "points": 0, "worth": 2}
RECORD = {
    "format": 3,
    "student": "ann",
    "assignment": "levers",
    "notebooks": [],
    "answers": {},
    "marks": {"levers/one": MARK},
}


@pytest.mark.parametrize(
    "reader, content, change, message",
    [
        (Question.from_json, LEVER, {"kind": None}, "'kind'"),
        (
            Question.from_json,
            LEVER,
            {"tolerance": "small"},
            "'tolerance' should be a number, not 'small'",
        ),
        (
            Question.from_json,
            LEVER,
            {"symbols": {"F": [1, 2, 3]}},
            "'symbols': 'F' should be a list of two",
        ),
        (Sealed.from_json, LEVER, {"worth": True}, "'worth' should be a number, not True"),
        (
            Locker.from_json,
            {},
            {"cases": [{"outcome": "right"}]},
            "'outcome' should be one of 'correct', 'mistake'",
        ),
        (
            Contract.from_json,
            {"title": "One", "variable": "force", "public": LEVER},
            {"worth": "2"},
            "'worth' should be a number",
        ),
        (Record.from_json, RECORD, {"student": 7}, "'student' should be a string, not 7"),
        (
            Record.from_json,
            RECORD,
            {"marks": {"levers/one": {**MARK, "points": "0"}}},
            "'points' should be a number",
        ),
    ],
)
def test_what_is_wrong_is_said_with_its_key_and_its_value(reader, content, change, message):
    with pytest.raises(Misread) as error:
        reader({**content, **change}, "here")
    assert message in str(error.value) and str(error.value).startswith("here")


@pytest.mark.parametrize(
    "change, share, message",
    [
        ({"worth": "two"}, 1, "levers/one: 'worth' should be a number.*Unpack the exercises"),
        ({}, 0.5, "for levers is incomplete. Unpack the exercises"),
        (
            {"kind": "lever"},
            1,
            "'levers/one' is of an unknown kind, 'lever'. Install the package that",
        ),
        ({"kind": "function", "result": "lever"}, 1, "is of an unknown kind, 'lever'. Install"),
    ],
)
def test_a_student_whose_sealed_file_cannot_be_used_is_told_what_to_do(
    change, share, message, tmp_path, monkeypatch
):
    (tmp_path / "sealed").mkdir()
    content = json.dumps(
        {"format": questions.FORMAT, "questions": {"levers/one": {**LEVER, **change}}}
    )
    (tmp_path / "sealed" / "levers.json").write_text(content[: int(share * len(content))])
    monkeypatch.chdir(tmp_path)
    questions.notebook_questions.cache_clear()
    with pytest.raises(RuntimeError, match=message):
        questions.find_question("levers/one", "")
    questions.notebook_questions.cache_clear()
