"""What is read from outside: what is wrong is said with its key and value,
and what is right is written again.
"""

import json

import pytest

from coursework.checking import questions
from coursework.checking.fields import Misread
from coursework.checking.question import Locker, Question, Sealed
from coursework.grading.judging.contract import Contract
from coursework.grading.record import Record

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
