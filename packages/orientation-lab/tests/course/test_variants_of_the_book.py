"""The book's variants: small, alike from outside, and each opened by its own answer alone."""

import collections
import json
import random

from seed import SEED
from test_release import COURSE, needs_solutions

import coursework
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
def test_a_variant_of_the_book_is_opened_by_its_own_answer_and_by_no_other():
    chance = random.Random(SEED)
    name = chance.choice(sorted(of_the_book()))
    count = of_the_book()[name]["variants"]
    path = COURSE.sources / f"{name.partition('/')[0]}.ipynb"
    numbers = [0, *chance.sample(range(1, count), 2)]
    asked = {number: read_source(path, number).questions[name] for number in numbers}
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
    coursework.student("")
