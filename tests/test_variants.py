"""Variants of a question: drawn by rule, sealed one by one, and each student's own found without a server."""

import base64
import collections
import json
import random
import re
import shutil
import zipfile
from pathlib import Path

import nbformat
import pytest
import sympy
from conftest import SEED
from test_release import COURSE, made_in, needs_solutions, write_source

import coursework
from coursework.authoring.author import AuthorError
from coursework.authoring.packing import archive
from coursework.authoring.release import release
from coursework.authoring.selftest import try_question
from coursework.authoring.source import read_source
from coursework.authoring.variation import Rule, drawn_in, written
from coursework.checking import questions, variants
from coursework.checking.plain import to_plain
from coursework.grading import marking

NAME = "levers/see-saw"
TEXT = "## See-saw\n\nA force of ${{force}}$ N acts ${{arm}}$ m from the hinge. Give its moment as `moment`, in N m."
SOLVED = "### BEGIN SOLUTION\nmoment = lever.force * lever.arm\n### END SOLUTION"
DRAWN = (
    "### BEGIN VARIANTS\nlever = draw('levers/see-saw', count=6, force=[20, 30, 45, 65], arm=[2, 3, 7])\n"
    "### END VARIANTS"
)
CHECKED = (
    "check('levers/see-saw', moment)\n### BEGIN HIDDEN TESTS\nquestion('levers/see-saw', kind='expression', "
    "mistakes={'Force and arm are multiplied, not added.': lever.force + lever.arm}, "
    "solution=f'It is ${lever.force} \\\\cdot {lever.arm}$.')\n### END HIDDEN TESTS"
)
CELLS = [
    ("markdown", "# Levers"),
    ("code", "from coursework import check, me, variant\nme('')"),
    ("code", DRAWN),
    ("markdown", TEXT),
    ("code", SOLVED),
    ("code", CHECKED),
    ("markdown", "## Plain"),
    ("code", "### BEGIN SOLUTION\nplain = 7\n### END SOLUTION"),
    (
        "code",
        "check('levers/plain', plain)\n### BEGIN HIDDEN TESTS\nquestion('levers/plain', kind='expression')\n"
        "### END HIDDEN TESTS",
    ),
]


@pytest.fixture(autouse=True)
def nobody_is_kept(monkeypatch, tmp_path):
    """Who works in a test is not written down, and not in the next one."""
    monkeypatch.setattr(variants, "KEPT", tmp_path / "no" / "such" / "me.txt")


@pytest.fixture(scope="module")
def course(tmp_path_factory):
    made = made_in(tmp_path_factory.mktemp("levers"))
    write_source(made.sources, *CELLS, name="levers")
    release(made, run=False)
    return made


@pytest.fixture
def beside(course, monkeypatch, tmp_path):
    """Work in a folder with the sealed questions of the course beside it."""
    (tmp_path / "sealed").symlink_to(course.sealed)
    monkeypatch.chdir(tmp_path)
    questions.notebook_questions.cache_clear()
    yield
    coursework.me("")
    questions.notebook_questions.cache_clear()


def student_with(number):
    return next(
        f"{k}@uni.example" for k in range(999) if variants.variant_of(f"{k}@uni.example", "levers/see-saw", 6) == number
    )


def variant(student):
    return variants.variant_of(student, NAME, 6)


@pytest.mark.parametrize("number", range(6))
def test_each_variant_has_its_own_text_numbers_and_answer(beside, course, number):
    coursework.me(student_with(number) if number else "")
    lever = coursework.variant("levers/see-saw")
    assert repr(lever) == f"## See-saw\n\nA force of {lever.force} N acts {lever.arm} m from the hinge. " + (
        "Give its moment as moment, in N m."
    )
    assert coursework.check("levers/see-saw", lever.force * lever.arm).outcome == "correct"
    assert "not added" in coursework.check("levers/see-saw", lever.force + lever.arm).messages[0]
    assert coursework.check("levers/plain", 7).outcome == "correct"  # a question without variants
    for other in range(6):
        given = read_source(course.sources / "levers.ipynb", other).questions["levers/see-saw"].public["given"]
        right = given["force"] * given["arm"] == lever.force * lever.arm
        outcome = coursework.check("levers/see-saw", given["force"] * given["arm"]).outcome
        assert (outcome == "correct") == right


def test_the_exercise_notebook_shows_the_variant_and_hides_the_rule(course):
    notebook = nbformat.read(course.exercises / "levers.ipynb", as_version=4)
    sources = [cell.source for cell in notebook.cells]
    assert sources[2] == 'lever = variant("levers/see-saw")\nlever' and sources[3].startswith("moment = ...")
    assert "draw" not in "".join(sources) and "{{" not in "".join(sources)


def test_variants_are_different_fair_and_of_the_students_own(course):
    numbers = collections.Counter(variants.variant_of(f"student-{k}", "a/b", 16) for k in range(4000))
    assert set(numbers) == set(range(16)) and min(numbers.values()) > 180
    same = [
        variants.variant_of(f"student-{k}", "a/b", 16) == variants.variant_of(f"student-{k}", "a/c", 16)
        for k in range(2000)
    ]
    assert 60 < sum(same) < 200  # one in 16: what one question gives tells nothing of the next
    drawn = [json.dumps(Rule("a/b", 12, {"x": range(3), "y": range(4)}).parameters(number)) for number in range(12)]
    assert len(set(drawn)) == 12 and drawn[0] == '{"x": 0, "y": 0}'


def of_the_book():
    """The questions of the book that have variants, by name."""
    return {
        name: about
        for path in sorted(COURSE.sealed.glob("*.json"))
        for name, about in json.loads(path.read_text("utf8"))["questions"].items()
        if "variants" in about
    }


def test_the_book_has_variants_that_stay_small():
    counts = [about["variants"] for about in of_the_book().values()]
    assert len(counts) >= 60 and sum(count >= 16 for count in counts) >= 20
    assert sum("picture" in about for about in of_the_book().values()) >= 4
    files = list(COURSE.sealed.rglob("*.json"))
    assert sum(path.stat().st_size for path in files) < 1_500_000
    for path in (COURSE.sealed / "variants").glob("*.json"):
        assert path.stat().st_size < 20_000, path  # all that a student's own variant needs beside the first
        first = json.loads((COURSE.sealed / f"{path.stem.rpartition('-')[0]}.json").read_text("utf8"))["questions"]
        for name, about in json.loads(path.read_text("utf8"))["questions"].items():
            assert about["salt"] != first[name]["salt"] and "kind" not in about and "text" not in about


@needs_solutions
def test_a_variant_of_the_book_is_opened_by_its_own_answer_and_by_no_other():
    chance = random.Random(SEED)
    name = chance.choice(sorted(of_the_book()))
    count = of_the_book()[name]["variants"]
    path = COURSE.sources / f"{name.partition('/')[0]}.ipynb"
    numbers = [0, *chance.sample(range(1, count), 2)]
    asked = {number: read_source(path, number).questions[name] for number in numbers}
    for number, question in asked.items():
        assert try_question(question, budget=0).faults == [], (name, number)
        student = next(f"s{k}" for k in range(999) if variants.variant_of(f"s{k}", name, count) == number)
        coursework.me(student)
        assert "{{" not in repr(coursework.variant(name))
        for other, theirs in asked.items():
            outcome = questions.judge(name, questions.find_question(name), theirs.plain)[0].outcome
            assert (outcome == "correct") == (number == other), (name, number, other)
    coursework.me("")


def test_the_grader_finds_the_same_variant_from_the_roster():
    for spelling in ("ada@uni.example", " Ada@Uni.example", "ADA@UNI.EXAMPLE\n"):
        assert variants.variant_of(spelling, "levers/see-saw", 16) == variants.variant_of(
            "ada@uni.example", "levers/see-saw", 16
        )


def test_answers_to_another_students_numbers_earn_nothing_and_are_flagged(course, tmp_path):
    found = marking.load_questions([course.sources / "levers.ipynb"], tmp_path, b"any secret")
    assert len(found[NAME]["others"]) == 5 and "others" not in found["levers/plain"]
    for number in (0, 4):
        student = student_with(number) if number else next(f"{k}" for k in range(99) if not variant(f"{k}"))
        own = marking.of_student(found, student)
        for other in range(6):
            given = read_source(course.sources / "levers.ipynb", other).questions[NAME].public["given"]
            plain = to_plain(given["force"] * given["arm"])
            mark = marking.mark(NAME, own[NAME], {"outcome": "recorded", "plain": plain})
            expected = ("correct", "", 1) if other == number else ("wrong", "other numbers", 0)
            assert (mark["outcome"], mark["note"], mark["points"]) == expected
        plain = {"outcome": "recorded", "plain": to_plain(7)}
        assert marking.mark("levers/plain", own["levers/plain"], plain)["points"] == 1
        assert marking.asked_of_sandbox(own)[NAME]["given"] == own[NAME]["public"]["given"]


def test_who_one_is_is_said_once_in_a_folder(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(variants, "KEPT", Path(".coursework", "me.txt"))
    try:
        coursework.me("")
        assert not list(tmp_path.iterdir()) and variants._identity == ""
        coursework.me(" Ada@Uni.example")
        coursework.me("")
        assert variants._identity == "ada@uni.example" and "those of ada@uni.example" in capsys.readouterr().out
        coursework.me("ben")  # another one says it anew
        coursework.me("")
        assert variants._identity == "ben"
        (tmp_path / ".coursework" / "me.txt").write_bytes(b"\xff\xfe")
        coursework.me("")
        assert variants._identity == ""
        monkeypatch.chdir(tmp_path / ".coursework")
        (tmp_path / ".coursework" / ".coursework").write_text("a file where the folder would be")
        coursework.me("ada")
        assert variants._identity == "ada"
    finally:
        monkeypatch.chdir(tmp_path.parent)
        monkeypatch.setattr(variants, "_identity", "")


def test_an_edition_draws_afresh():
    rule = Rule("a/b", 4, {"x": range(1000), "y": lambda chance: chance.randint(0, 10**6)})
    first, exam = ([rule.parameters(number, edition) for number in range(4)] for edition in ("", "exam"))
    assert not [one for one in first if one in exam]
    assert first == [rule.parameters(number) for number in range(4)]


def test_salts_differ_so_that_a_guess_serves_one_variant(course):
    salts = [
        read_source(course.sources / "levers.ipynb", k).questions["levers/see-saw"].public["salt"] for k in range(6)
    ]
    assert len(set(salts)) == 6


def test_the_archive_brings_all_variants_and_a_smaller_count_takes_them_away(course, tmp_path):
    with zipfile.ZipFile(archive(course)) as box:
        names = {name for name in box.namelist() if "/variants/" in name}
    assert names == {f"exercises/sealed/variants/levers-{k}.json" for k in range(1, 6)}
    shutil.copytree(course.root, tmp_path / "again")
    again = made_in(tmp_path / "again")
    (again.sealed / "variants" / "levers-extra-5.json").write_text("of another notebook")
    write_source(
        again.sources, *((kind, text.replace("count=6", "count=3")) for kind, text, *_ in CELLS), name="levers"
    )
    release(again, run=False)
    assert sorted(path.name for path in (again.sealed / "variants").iterdir()) == [
        "levers-1.json",
        "levers-2.json",
        "levers-extra-5.json",
    ]


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("count=6", "count=13", "there are 12 different variants; 13 are wanted"),
        ("lever = draw", "draw", "stands one `name = draw"),
    ],
)
def test_an_author_is_told(tmp_path, old, new, says):
    path = write_source(tmp_path, *((kind, text.replace(old, new)) for kind, text, *_ in CELLS), name="levers")
    with pytest.raises(AuthorError, match=says):
        read_source(path, 12)


def test_a_variant_with_a_fault_is_named_with_its_numbers(tmp_path):
    """Of 2 N at 2 m the sum is the product: one variant in which a mistake gives the right answer."""
    made = made_in(tmp_path)
    drawn = DRAWN.replace("20, 30, 45, 65", "3, 2").replace("2, 3, 7", "3, 2").replace("count=6", "count=4")
    write_source(made.sources, *((kind, drawn if text == DRAWN else text) for kind, text, *_ in CELLS), name="levers")
    with pytest.raises(AuthorError, match=r"levers/see-saw, variant \d, {'force': 2, 'arm': 2}: This authored mistake"):
        release(made, run=False)


PICTURED = [
    ("markdown", "# Levers"),
    ("code", "from coursework import check, me, variant\nme('')"),
    (
        "code",
        "### BEGIN VARIANTS\nclass Drawn:\n    def __init__(self, force):\n"
        "        self.alt = f'A beam & {force} arrows'\n"
        "    def picture(self):\n        return f'<svg width=\"9\">{self.alt}</svg>'\n\n\n"
        "lever = draw('levers/see-saw', count=3, force=[2, 5, 6], "
        "picture=lambda drawn: Drawn(drawn['force']))\n### END VARIANTS",
    ),
    ("markdown", "{{picture}}\n\nHow many arrows?"),
    ("code", "### BEGIN SOLUTION\nmoment = lever.force\n### END SOLUTION"),
    (
        "code",
        "check('levers/see-saw', moment)\n### BEGIN HIDDEN TESTS\nquestion('levers/see-saw', kind='expression')\n"
        "### END HIDDEN TESTS",
    ),
]


def test_a_picture_differs_from_variant_to_variant(tmp_path, monkeypatch):
    made = made_in(tmp_path)
    write_source(made.sources, *PICTURED, name="levers")
    release(made, run=False)
    monkeypatch.chdir(made.root)
    questions.notebook_questions.cache_clear()
    seen = set()
    try:
        for number in range(3):
            student = next(f"s{k}" for k in range(99) if variants.variant_of(f"s{k}", "levers/see-saw", 3) == number)
            coursework.me(student)
            lever = coursework.variant("levers/see-saw")
            data = re.search(
                r'<p><img alt="A beam &amp; (\d) arrows" width="9" src="data:[^,]+,(.*?)"></p>', lever._repr_markdown_()
            )
            assert f"{data[1]} arrows</svg>" in base64.b64decode(data[2]).decode() and data[1] == str(lever.force)
            assert repr(lever) == f"A beam & {lever.force} arrows\n\nHow many arrows?"
            assert coursework.check("levers/see-saw", lever.force).outcome == "correct"
            seen.add(lever.force)
    finally:
        coursework.me("")
        questions.notebook_questions.cache_clear()
    assert seen == {2, 5, 6}


def test_parameters_are_shown_in_a_text():
    x = sympy.Symbol("x")
    assert variants.shown("{{a}} and ${{b}}$, {{c}}; {{d}}", written({"a": "up", "b": x**2 / 3, "c": [1, 2]})) == (
        r"up and $\frac{x^{2}}{3}$, 1, 2; {{d}}"
    )
    assert drawn_in("x = 1") is None and drawn_in(DRAWN) == ("lever", "levers/see-saw")
