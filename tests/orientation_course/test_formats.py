"""What somebody holds already is read for ever: sealed files of an earlier
edition, and what they say to an answer.
"""

import itertools
import json
import shutil
from dataclasses import replace
from pathlib import Path

import pytest
import sympy as sm
from test_release import HIDDEN, SETUP, SOLUTION, write_source

import coursework
import orientation_course
from coursework.authoring.author import AuthoredQuestion, AuthorError
from coursework.authoring.course import find_course
from coursework.authoring.release import release
from coursework.checking import catalogue, format_3, mistakes, plugins, questions, sealing
from coursework.checking.catalogue import by_short_name
from coursework.checking.mistakes import short_name
from coursework.checking.plain import to_plain
from coursework.checking.question import Question
from coursework.checking.questions import NOT_IN_THIS_CATALOGUE, judge, notebook_questions

SECOND = Path(__file__).parent / "editions" / "second"
#: Answers to sealed questions of the second edition, as plain data, with the outcome, the note and
#: the details of the reply that they got then; for a variant its number follows the name of the
#: question.
ANSWERS = json.loads((SECOND / "answers.json").read_text("utf8"))


@pytest.fixture
def beside(tmp_path, monkeypatch):
    """A folder of a student with sealed questions of the second edition beside the notebooks."""
    shutil.copytree(SECOND / "sealed", tmp_path / "sealed")
    monkeypatch.chdir(tmp_path)
    questions.notebook_questions.cache_clear()
    yield tmp_path / "sealed"
    questions.notebook_questions.cache_clear()


@pytest.fixture
def catalogue_in_another_order(monkeypatch):
    """What a contributor may do: mistakes above others, and a new
    generic message before all of them.
    """

    def turned_round(messages):
        return {
            "entered above all others": lambda question: "New.",
            **dict(reversed(messages.items())),
        }

    changed = {
        name: kind._replace(messages=turned_round(kind.messages) if kind.messages else {})
        for name, kind in plugins.kinds().items()
    }
    messages = turned_round(mistakes.MESSAGES)
    monkeypatch.setattr(catalogue, "MESSAGES", messages)
    monkeypatch.setattr(catalogue, "kinds", lambda: changed)
    catalogue._by_short_name.cache_clear()
    yield
    catalogue._by_short_name.cache_clear()


def replies_of_then():
    for name, rows in ANSWERS.items():
        question, _, number = name.partition(" ")
        for plain, *expected in rows:
            sealed = notebook_questions(question.partition("/")[0], int(number or 0))[question]
            reply = judge(question, sealed, plain)
            yield name, [reply.outcome, reply.note, reply.details or {}], expected


def test_a_sealed_file_of_the_second_edition_says_what_it_said(beside, catalogue_in_another_order):
    found = list(replies_of_then())
    assert [(name, said) for name, said, expected in found if said != expected] == []
    notes = {expected[1] for _, _, expected in found}
    assert {
        "scalar last",
        "another axis",
        "factor",
        "power of ten",
        "symbols interchanged",
        "authored",
    } <= notes


def test_every_mistake_of_then_still_has_its_words():
    for kind in plugins.kinds():
        if kind != "function":
            question = Question(kind, symbols={"alpha": (-3, 3), "beta": (-3, 3)})
            words = {**mistakes.MESSAGES, **plugins.kinds()[kind].messages}
            known = format_3.numbered(question)
            assert {note for note, _ in known} <= set(words)
            assert all(by_short_name(question)[short_name(*one)] == one for one in known)


def docking(tmp_path):
    """A question whose typical mistake is sealed in a file of today, and that mistake."""
    question = AuthoredQuestion(
        "moored/docking",
        Question("quaternion", frames=("B", "A")),
        sm.Matrix([1, 3, 5, 1]) / 6,
        variable="B_q_A",
    )
    sealed = {"format": questions.FORMAT, "questions": {question.name: question.sealed().as_json()}}
    (tmp_path / "sealed").mkdir(exist_ok=True)
    (tmp_path / "sealed" / "moored.json").write_text(json.dumps(sealed), "utf8")
    return question


def test_a_new_mistake_changes_nothing_of_what_is_sealed(tmp_path, monkeypatch, request):
    question = docking(tmp_path)
    monkeypatch.chdir(tmp_path)
    questions.notebook_questions.cache_clear()
    request.getfixturevalue("catalogue_in_another_order")
    told = {}
    for mistake in question.mistakes:
        reply = judge(
            question.name, questions.find_question(question.name, ""), to_plain(mistake.answer)
        )
        told[mistake.note] = reply.note
    assert told["scalar last"] == "scalar last" and told["conjugate"] == "conjugate"
    assert len(set(told.values())) > 2


def test_a_mistake_that_this_version_has_no_words_for_is_still_one(tmp_path, monkeypatch):
    question = docking(tmp_path)
    text = question.fingerprint_of(to_plain([0.6, 0, 0.8, 0]))
    sealed = question.sealed()
    key = sealing.slow_key(sealed.question.salt, text)
    name = short_name("told by a later edition", {})
    lockers = sealing.pack([sealing.locker(key, questions.OUTCOMES.index("mistake"), [name])])
    sealed = replace(sealed, lockers=lockers)
    reply = judge(question.name, sealed, to_plain([0.6, 0, 0.8, 0]))
    assert reply.outcome == "wrong" and reply.messages == [NOT_IN_THIS_CATALOGUE]


@pytest.mark.parametrize("number", [2, 5, 40])
def test_a_format_that_is_not_known_is_refused_in_words(beside, number):
    file = beside / "chapters.json"
    file.write_text(json.dumps({**json.loads(file.read_text("utf8")), "format": number}), "utf8")
    with pytest.raises(
        RuntimeError, match=f"of chapters are of format {number}.*reads formats 3 and 4.*update"
    ):
        questions.find_question("chapters/about-x", "")


def test_a_question_that_has_another_name_says_so(beside):
    about = {
        "format": questions.FORMAT,
        "moved": {"chapters/around-x": "chapters/about-x"},
        "questions": {},
    }
    (beside / questions.MOVED).write_text(json.dumps(about), "utf8")
    with pytest.raises(
        questions.NoSuchQuestion, match="'chapters/around-x' is called 'chapters/about-x'"
    ):
        questions.find_question("chapters/around-x", "")
    with pytest.raises(questions.NoSuchQuestion, match="Did you mean"):
        questions.find_question("chapters/abut-x", "")


def test_a_release_tells_the_names_that_questions_had(tmp_path):
    cells = [
        ("code", SETUP),
        ("code", SOLUTION),
        ("code", f"check('trial/about-x', A_C_N)\n{HIDDEN}"),
    ]
    write_source(tmp_path / "sources", *cells)
    (tmp_path / "course.toml").write_text(
        'sources = "sources"\n[moved]\n"trial/x" = "trial/about-x"\n'
    )
    for _ in range(2):  # what was made is no stranger's file
        release(find_course(tmp_path), run=False)
    kept = json.loads((tmp_path / "exercises" / "sealed" / questions.MOVED).read_text("utf8"))
    assert kept["moved"] == {"trial/x": "trial/about-x"}
    (tmp_path / "course.toml").write_text("[moved]\none = 2\n")
    with pytest.raises(AuthorError, match="old and new names"):
        find_course(tmp_path)


def test_a_record_of_the_second_edition_is_read(tmp_path, monkeypatch):
    """Also where it names hints that stand elsewhere by now."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / ".coursework").mkdir()
    shutil.copy(SECOND / "progress.json", tmp_path / ".coursework")
    record = json.loads((SECOND / "progress.json").read_text("utf8"))
    right = [name for name, entry in record.items() if entry["outcome"] == "correct"]
    said = coursework.progress().messages[0]
    assert said == f"{len(right)} of the {len(record)} questions that you have tried are right."
    for name in record:
        assert coursework.hint(name).outcome == "hints"


def test_two_mistakes_never_have_one_short_name(monkeypatch):
    for kind in plugins.kinds():
        if kind != "function":
            by_short_name(Question(kind, symbols={f"q_{number}": (-1, 1) for number in range(9)}))
    catalogue._by_short_name.cache_clear()
    numbers = itertools.cycle([b"same"])
    monkeypatch.setattr(catalogue, "short_name", lambda note, details: next(numbers))
    with pytest.raises(RuntimeError, match="one short name"):
        by_short_name(Question("expression"))
    catalogue._by_short_name.cache_clear()


def test_the_table_of_a_course_is_its_own(monkeypatch):
    assert set(orientation_course.FORMAT_3) == set(orientation_course.KINDS)
    # A course that has not frozen the order of its mistakes.
    monkeypatch.setattr(plugins, "plugins", lambda: [])
    assert plugins.catalogue_of_format_3("order") == [
        ("turned round", {}),
        ("two interchanged", {}),
    ]
