"""The records beside a notebook, as written and read, entry by entry."""

import json
from dataclasses import replace

import pytest

from coursework.checking import identity
from coursework.checking.fields import Misread
from coursework.checking.progress import KEPT, Entry, Progress
from coursework.checking.question import Place

OTHER = {"outcome": "correct", "variant": 1, "numbers": "other", "whose": ""}
WHOLE = {
    "outcome": "wrong",
    "note": "opposite",
    "answers": ["a", "b"],
    "help": "hint",
    "page": [1, "key"],
    "mistake": "opposite",
    "mistake at": 12.5,
    "after": [["levers/other", 2, "its key"]],
    "variant": 3,
    "numbers": "three",
    "whose": "ann",
    "other variants": {"1": OTHER},
    "colour": "red",
}
ENTRY = Entry(
    "wrong",
    "opposite",
    ("a", "b"),
    "hint",
    Place(1, "key"),
    "opposite",
    12.5,
    (("levers/other", Place(2, "its key")),),
    3,
    "three",
    "ann",
    (Entry("correct", variant=1, numbers="other", whose=""),),
    {"colour": "red"},
)


# --- entries ------------------------------------------------------------------------------------


def test_an_entry_is_written_as_it_was_read():
    assert Entry.from_json(WHOLE) == ENTRY and ENTRY.as_json() == WHOLE
    assert Entry.from_json({}) == Entry() and Entry().as_json() == {}
    assert [type(part) for part in Entry.from_json({}).__dict__.values()] == [
        type(part) for part in Entry().__dict__.values()
    ]


@pytest.mark.parametrize("name", sorted(set(WHOLE) - {"colour"}))
@pytest.mark.parametrize("damaged", [True, {"1": 2}, [[]]])
def test_a_field_that_is_not_what_it_should_be_is_as_if_it_were_not_there(name, damaged):
    without = {key: value for key, value in WHOLE.items() if key != name}
    if name == "other variants" and damaged == {"1": 2}:  # An invalid entry counts as empty.
        without[name] = {"1": {}}
    assert Entry.from_json({**WHOLE, name: damaged}) == Entry.from_json(without)
    assert Entry.from_json(damaged if damaged is True else [damaged]) == Entry()


def test_two_sets_of_numbers_of_one_place_are_both_kept():
    first, second = (Entry("wrong", variant=1, numbers=name) for name in ("old", "new"))
    written = Entry(others=(first, second)).as_json()["other variants"]
    assert written == {"1": first.as_json(), "1 new": second.as_json()}
    assert Entry.from_json({"other variants": written}).others == (first, second)


def test_an_entry_is_of_numbers_by_their_name_and_without_one_by_their_place():
    assert Entry(variant=1, numbers="a").has(2, "a") and not Entry(variant=1, numbers="a").has(
        1, "b"
    )
    for nameless, asked in ((Entry(variant=1), "b"), (Entry(variant=1, numbers="a"), "")):
        assert nameless.has(1, asked) and not nameless.has(2, asked)


def test_what_is_known_with_other_numbers_stays_beside_it():
    place, later = Place(1, "key"), Place(2, "key")
    fresh = Entry(after=(("a", place),)).with_numbers(1, "one")
    assert fresh == Entry(variant=1, numbers="one", after=(("a", place),))
    first = Entry("wrong", variant=1, after=(("a", place),)).with_numbers(1, "one")
    assert (first.outcome, first.numbers, first.others) == ("wrong", "one", ())
    second = first.with_numbers(2, "two")
    assert second == Entry(variant=2, numbers="two", after=first.after, others=(first,))
    worked = Entry("correct", variant=2, numbers="two", after=(("b", later),), others=second.others)
    third = worked.with_numbers(3, "three")
    entry = Entry("correct", variant=2, numbers="two", after=(("b", later),))
    assert third.others == (entry, first) and third.after == worked.after
    again = third.with_numbers(1, "one")
    assert (again.outcome, again.variant) == ("wrong", 1)
    assert again.after == (("a", place), ("b", later))
    assert [entry.numbers for entry in again.others] == ["three", "two"]


def test_numbers_are_known_by_their_name_where_both_have_one():
    named, nameless = Entry("wrong", variant=1, numbers="one"), Entry("wrong", variant=1)
    assert named.with_numbers(1, "two").others == (named,)
    three = Entry("correct", variant=3, numbers="three")
    for known, variant, expected in ((named, 1, False), (named, 2, False), (nameless, 1, True)):
        asked = replace(three, others=(known,)).with_numbers(variant, "other")
        assert asked.outcome == ("wrong" if expected else "")
        assert asked.others == ((three,) if expected else (three, known))


# --- the file -----------------------------------------------------------------------------------


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    yield tmp_path
    monkeypatch.setattr(identity, "_identity", "")


@pytest.mark.parametrize("content", [None, b"[]", b"{", b"\xff", b'{"levers/one": 3}'])
def test_what_is_no_record_is_none(folder, content):
    if content is not None:
        KEPT.parent.mkdir()
        KEPT.write_bytes(content)
    assert Progress.read().entry("levers/one") == Entry()


def test_what_is_put_is_there_again_and_nothing_else_is(folder):
    for folder_is_there in (False, True):
        Progress.read().put({"b/größe": ENTRY, "a/one": Entry("correct")})
        Progress.read().put({"b/größe": Entry("correct", "ö")})
        assert Progress.read().entry("b/größe") == Entry("correct", "ö")
        assert Progress.read().entry("a/one") == Entry("correct")
        assert [path.name for path in KEPT.parent.iterdir()] == ["progress.json"]
        assert KEPT.parent.is_dir() or not folder_is_there
    text = KEPT.read_text("utf8")
    assert list(json.loads(text)) == ["a/one", "b/größe"] and text.startswith('{\n "a/one": {\n  "')


def test_a_folder_that_cannot_be_written_to_costs_the_record_only(folder):
    KEPT.parent.write_text("no folder")
    progress = Progress({})
    progress.put({"a/one": ENTRY})
    assert progress.entry("a/one") == ENTRY and Progress.read().entries == {}


# --- the student's ID ---------------------------------------------------------------------------


def test_who_works_here_is_said_once(folder, capsys):
    for nobody in ("", "your ID"):
        identity.student(nobody)
        assert capsys.readouterr().out == identity.FORGOTTEN + "\n"
    with pytest.raises(TypeError, match="takes one ID, .*: 'ann' or 'ben'"):
        identity.student("ann", "ben")
    identity.student("  Ann   Ä.\t")
    assert identity.identity() == "ann ä." == identity.KEPT.read_text("utf8")
    assert capsys.readouterr().out == "You are ann ä. The numbers below are yours.\n"
    monkey = identity._identity
    identity.student()
    assert identity.identity() == monkey
    assert capsys.readouterr().out.startswith("You are still ann ä. The numbers below are yours.\n")
    # The same name in other characters changes nothing, while another name causes a message.
    identity.student("Ann A\u0308\u200b.")
    assert "before" not in capsys.readouterr().out and identity.identity() == monkey
    identity.student("Anne Ä")
    assert "You are anne ä now, and were ann ä. before, " in capsys.readouterr().out
    # Another notebook in the folder that does not ask uses the same numbers.
    identity._identity = None
    assert identity.identity() == "anne ä"


def test_an_identity_that_cannot_be_kept_or_read_is_said_anew(folder):
    identity.student("")
    assert identity.identity() == ""
    KEPT.parent.mkdir()
    for damaged in (b"\xff", b" "):
        identity.KEPT.write_bytes(damaged)
        identity.student("")
        assert identity.identity() == ""
    identity.KEPT.unlink()
    identity.KEPT.mkdir()
    identity.student("Ann")
    assert identity.identity() == "ann"


def test_a_long_value_is_shown_in_part():
    for length, shown in ((58, repr("a" * 58)), (59, "'" + "a" * 59 + "…")):
        assert str(Misread("here", "short", "a" * length)).endswith(f"not {shown}.")
