"""The book's questions: variants that are small, alike from outside, and opened by their own answer
alone; what another system and the grader make of them; and those to ask aloud.
"""

import collections
import json
import random
import re

import pytest
from seed import SEED
from test_bank import judged_as_here
from test_release import COURSE, needs_solutions

import coursework
from coursework.authoring.release import CHAPTERS
from coursework.authoring.selftest import try_question
from coursework.authoring.source import read_source
from coursework.checking import questions, sealing, variants


def of_the_book():
    """The questions of the book that have variants, by name."""
    return {
        name: about
        for path in sorted(COURSE.sealed.glob("*.json"))
        for name, about in json.loads(path.read_text("utf8"))["questions"].items()
        if "variants" in about
    }


def test_how_many_lockers_there_are_tells_nothing_of_the_answer():
    """Of a question's variants all but one have as many as each other; without
    variants it is a multiple of eight.
    """
    counts = collections.defaultdict(list)
    for path in COURSE.sealed.rglob("*.json"):
        for name, about in json.loads(path.read_text("utf8"))["questions"].items():
            if about.get("lockers"):
                counts[name].append(sealing.count_of(about["lockers"]))
    assert len(counts) > 150
    for name, numbers_of_lockers in counts.items():
        if len(numbers_of_lockers) > 2:
            assert len(set(sorted(numbers_of_lockers)[:-1])) == 1, name
        else:
            assert max(numbers_of_lockers) % 8 == 0 and len(set(numbers_of_lockers)) == 1, name


def test_how_many_pages_there_are_tells_nothing_of_the_answer():
    """It told the variants of 18 questions apart; now all but the
    first have as many of their own.
    """
    counts = collections.defaultdict(set)
    for path in (COURSE.sealed / "variants").glob("*.json"):
        for name, about in json.loads(path.read_text("utf8"))["questions"].items():
            counts[name].add(len(about.get("pages") or []))
    assert len(counts) > 60 and all(len(numbers) == 1 for numbers in counts.values())


def test_the_book_has_variants_that_stay_small():
    counts = [about["variants"] for about in of_the_book().values()]
    assert len(counts) >= 60 and sum(count >= 16 for count in counts) >= 27
    assert sum("picture" in about for about in of_the_book().values()) >= 4
    files = list(COURSE.sealed.rglob("*.json"))
    # Every question of the exercise notebooks varies, functions too, of which each variant holds
    # the results of all typical mistakes.
    assert sum(path.stat().st_size for path in files) < 2_850_000
    for path in (COURSE.sealed / "variants").glob("*.json"):
        # All that a student's own variant needs beside the first, with up to three figures.
        assert path.stat().st_size < 36_000, path
        first = json.loads(
            (COURSE.sealed / f"{path.stem.rpartition('-')[0]}.json").read_text("utf8")
        )["questions"]
        for name, about in json.loads(path.read_text("utf8"))["questions"].items():
            assert (
                about["salt"] != first[name]["salt"] and "kind" not in about and "text" not in about
            )


@needs_solutions
def test_a_variant_of_the_book_is_opened_by_its_own_answer_and_by_no_other(tmp_path, monkeypatch):
    # The ID is stored in the folder in which one works, where it would change all numbers.
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("coursework.checking.identity._identity", None)
    chance = random.Random(SEED)
    name = chance.choice(sorted(of_the_book()))
    count = of_the_book()[name]["variants"]
    path = COURSE.sources / f"{name.partition('/')[0]}.ipynb"
    numbers = [0, *chance.sample(range(1, count), 2)]
    asked = {number: read_source(path, number, only=[name]).questions[name] for number in numbers}
    for number, question in asked.items():
        assert try_question(question).faults == [], (name, number)
        student = next(
            f"s{k}" for k in range(999) if variants.variant_of(f"s{k}", name, count) == number
        )
        coursework.student(student)
        assert "{{" not in repr(coursework.variant(name))
        for other_number, theirs in asked.items():
            # Their function is called as this variant calls it, as grading would call a copy.
            outcome = questions.judge(
                name, questions.find_question(name, student), question.to_plain(theirs.answer)
            ).outcome
            assert (outcome == "correct") == (number == other_number), (name, number, other_number)


# --- for another system ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("format", "question"),
    [("moodle", "simple-orientations/crank"), ("qti", "euler-angles/which-sequence")],
)
def test_the_books_variants_are_judged_elsewhere_as_they_are_here(format, question, tmp_path):
    assert judged_as_here(COURSE, format, [question], tmp_path) == []


# --- for the grader -------------------------------------------------------------------------------


NAMES = [path.stem for path in sorted(COURSE.sources.glob("*.ipynb")) if path.stem != "chapters"]


# One variant of one notebook; with --every-case all of all.
@pytest.mark.parametrize(
    ("name", "last"),
    [
        ("simple-orientations", 1),
        *(pytest.param(name, None, marks=pytest.mark.further) for name in NAMES),
    ],
)
def test_what_is_marked_does_not_depend_on_the_cells_that_were_left_out(name, last):
    path = COURSE.sources / f"{name}.ipynb"
    rules = read_source(path).rules
    for number in range(1, max((rule.count for rule in rules.values()), default=1))[:last]:
        having = [question for question, rule in rules.items() if number < rule.count]
        whole, part = (
            read_source(path, number).questions,
            read_source(path, number, only=having).questions,
        )
        assert list(whole) == list(part)
        for full, partial in zip(whole.values(), part.values(), strict=True):
            without_pictures = [
                {**question.public.as_json(), "picture": None} for question in (full, partial)
            ]
            assert without_pictures[0] == without_pictures[1]
            assert (full.plain, full.entries, full.near, full.credit) == (
                partial.plain,
                partial.entries,
                partial.near,
                partial.credit,
            )


# --- to ask aloud ---------------------------------------------------------------------------------


def _parts(text, heading):
    """What stands under each heading of this level, by the heading."""
    parts = re.split(rf"^{heading} (.*)$", text, flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


@needs_solutions
def test_each_notebook_has_three_questions_with_a_good_answer_and_three_wrong_ones():
    notebooks = _parts((COURSE.sources / "spoken-questions.md").read_text("utf8"), "##")
    assert set(notebooks) == {path.stem for path in COURSE.sources.glob("*.ipynb")} - {CHAPTERS}
    for name, text in notebooks.items():
        questions = _parts(text, "###")
        assert len(questions) == 3, name
        for title, question in questions.items():
            assert question.count("\n**A good answer**: ") == 1, (name, title)
            assert len(re.findall(r"^- \*\*.+?\*\*", question, re.MULTILINE)) == 3, (name, title)
