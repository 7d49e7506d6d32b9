"""The manual for authors: its examples are questions that pass, and the replies that it prints are the real ones."""

import re
from pathlib import Path

import pytest
from test_release import write_source

from coursework.authoring.selftest import _judge, try_question
from coursework.authoring.source import read_source

MANUAL = (Path(__file__).parent.parent / "docs" / "coursework.md").read_text("utf8")
BLOCK = re.compile(r"<!-- (example|reply|the rest of it)(?:: (.*?))? -->\n```(?:python|text)\n(.*?)```", re.S)
SETUP = "import sympy as sm\nfrom coursework import check, variant\nx, y, F_x, F_y = sm.symbols('x, y, F_x, F_y')"
TEXT = re.search(r"```text\n(A child .*?)```", MANUAL, re.S)[1]


def examples():
    """Each example with its cells, and the replies that follow it."""
    found = []
    for kind, about, text in BLOCK.findall(MANUAL):
        if kind == "example":
            found.append((about, [text], []))
        elif kind == "reply":
            found[-1][2].append((about, text.rstrip("\n")))
        else:
            found[-1][1].extend([TEXT, text])
    return found


@pytest.mark.parametrize("about, cells, replies", [pytest.param(*one, id=one[0]) for one in examples()])
def test_an_example_is_a_question_that_passes(tmp_path, about, cells, replies):
    sources = [("code", SETUP), *(("markdown" if text is TEXT else "code", text) for text in cells)]
    path = write_source(tmp_path, *sources, name="manual")
    (question,) = read_source(path).questions.values()
    assert try_question(question, budget=0, against_sealed=False).faults == []
    names = {}
    exec(SETUP, names)
    for wrong, said in replies:
        assert repr(_judge(question, eval(wrong, names))) == said


def test_the_manual_has_examples_of_most_kinds_and_names_all():
    assert len(examples()) >= 5 and sum(len(replies) for *_, replies in examples()) >= 4
    from coursework.checking.kinds import KINDS

    for kind in KINDS:
        assert f"`{kind}`" in MANUAL
