"""A mistake is sealed under its own name: what is added to the catalogue changes no reply."""

import json

import pytest
import sympy as sm

from coursework.authoring.author import AuthoredQuestion
from coursework.checking import catalogue, mistakes, plugins, questions
from coursework.checking.catalogue import by_short_name
from coursework.checking.plain import to_plain
from coursework.checking.question import Question
from coursework.checking.questions import judge


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
    replies = {}
    for mistake in question.mistakes:
        reply = judge(
            question.name, questions.find_question(question.name, ""), to_plain(mistake.answer)
        )
        replies[mistake.note] = reply.note
    assert replies["scalar last"] == "scalar last" and replies["conjugate"] == "conjugate"
    assert len(set(replies.values())) > 2


def test_two_mistakes_never_have_one_short_name():
    for kind in plugins.kinds():
        if kind != "function":
            by_short_name(Question(kind, symbols={f"q_{number}": (-1, 1) for number in range(9)}))
