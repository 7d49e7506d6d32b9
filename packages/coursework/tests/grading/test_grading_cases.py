"""Questions stored beside their answers, so that correcting one costs nobody marks by accident."""

import dataclasses
import io
import re
import shutil
from types import SimpleNamespace

import nbformat
import pytest
import sympy as sm
from grading_class import grade_quietly, notebook, put, write_term

from coursework.__main__ import main
from coursework.authoring.author import AuthorError
from coursework.checking import evaluate
from coursework.checking.plain import read_plain, to_plain
from coursework.checking.question import Question
from coursework.checking.variants import (
    numbers_of_variants,
    siblings_of,
    variant_of,
)
from coursework.grading import review
from coursework.grading.assignments import NothingToGrade
from coursework.grading.execution import isolation
from coursework.grading.grade import regrade
from coursework.grading.judging import judge as judging
from coursework.grading.judging import marking, secret
from coursework.grading.judging.cases import Contracts, case_by_rule, variants_of
from coursework.grading.judging.contract import Asked, Contract
from coursework.grading.judging.journal import CUT, Journal
from coursework.grading.judging.marking import questions_of
from coursework.grading.record import Answer, Identity, Mark, Record, Remembered
from coursework.grading.review import Class
from coursework.grading.store import Store
from coursework.grading.submissions import pictures

pytestmark = pytest.mark.usefixtures("libraries_are_loaded_once")

WEIGHTS = [12, 25, 31, 44, 57, 68, 73, 89]
NAME = "beams/load"
STUDENTS = [f"student-{number:02}" for number in range(14)]


def beams(weights, calls="[[1.5], [-2.0], [0.25]]"):
    """Return a solution notebook with a function and a question with a variant for each weight."""
    return notebook(
        [
            "import sympy as sm\nfrom coursework import check, student, variant\nstudent('')",
            ("markdown", "## The load"),
            f"### BEGIN VARIANTS\nbeam = draw('{NAME}', count={len(weights)}, weight={weights})\n"
            "### END VARIANTS",
            ("markdown", "A beam carries {{weight}} N twice. Give the whole load."),
            "### BEGIN SOLUTION\nload = 2*beam.weight\n### END SOLUTION",
            f"check('{NAME}', load)\n### BEGIN HIDDEN TESTS\n"
            f"question('{NAME}', kind='expression', worth=2, tolerance="
            "0.01)\n### END HIDDEN TESTS",
            ("markdown", "Write a function that gives twice its argument."),
            "### BEGIN SOLUTION\ndef twice(x):\n    return 2*x\n### END SOLUTION",
            "check('beams/twice', twice)\n"
            "### BEGIN HIDDEN TESTS\n"
            f"question('beams/twice', kind='function', calls={calls}, result='expression', "
            "worth=3)\n"
            "### END HIDDEN TESTS",
        ]
    )


def write_beams(folder, *arguments, **more):
    folder.mkdir(exist_ok=True)
    nbformat.write(beams(*arguments, **more), folder / "beams.ipynb")
    (folder / secret.FILE).write_text("5eed" * 16)
    return folder


def answered(load, says="", function="def twice(x):\n    return x + x"):
    return notebook(
        [
            f"from coursework import check, student\nstudent({says!r})",
            f"load = {load}\ncheck('{NAME}', load)",
            function,
            "check('beams/twice', twice)",
        ]
    )


@pytest.fixture(scope="module")
def begun(tmp_path_factory):
    """A class in which all but one student answered right for their own numbers."""
    place = tmp_path_factory.mktemp("cases")
    solutions = write_beams(place / "solutions", WEIGHTS)
    questions = questions_of(solutions / "beams.ipynb", b"any")
    given = [
        contract.question.given["weight"] for contract in variants_of(questions[NAME]).values()
    ]
    own = {student: given[variant_of(student, NAME, 8)] for student in STUDENTS}
    for student in STUDENTS:
        put(place / "in", student, answered(2 * own[student], says=student), "beams.ipynb")
    put(place / "in", "wrong", answered(1), "beams.ipynb")
    grade_quietly(place / "in", place / "out", solutions)
    return SimpleNamespace(place=place, own=own)


@pytest.fixture
def out(begun, tmp_path):
    return Store(shutil.copytree(begun.place / "out", tmp_path / "out"))


def marks_of(store, name):
    return {record.student: record.marks[name] for record in store.all()}


def test_calls_that_are_mended_take_no_marks(begun, out, tmp_path):
    """Results were once compared by position, so all right functions fell from 3 to 0."""
    fewer = write_beams(tmp_path / "fewer", WEIGHTS, "[[0.25], [1.5]]")
    regrade(out.folder, solutions=fewer)
    marks = marks_of(out, "beams/twice").values()
    # The current calls were all made then, but other calls also change the secret ones.
    assert {(mark.outcome, mark.note) for mark in marks} <= {
        ("correct", ""),
        ("undecided", "not called"),
    }
    others = write_beams(tmp_path / "others", WEIGHTS, "[[7.5], [1.5]]")
    regrade(out.folder, solutions=others)
    assert {(mark.outcome, mark.note) for mark in marks_of(out, "beams/twice").values()} == {
        ("undecided", "not called")
    }
    grade_quietly(begun.place / "in", out.folder, others)
    assert {mark.points for mark in marks_of(out, "beams/twice").values()} == {3}
    assert {mark.points for student, mark in marks_of(out, NAME).items() if student != "wrong"} == {
        2
    }


def test_a_function_is_judged_by_the_calls_that_it_was_given():
    def calling(*calls):
        return Contract("Twice", "twice", 1, Question("function", calls=calls))

    before = calling([1], [2], [3])
    plain = to_plain(lambda x: 2 * x, before.question.calls)
    kind, results, works = marking.in_calls_of(Asked(calling([3], [1]), before), plain)["value"]
    assert [plain["nodes"][result[1]][1] for result in results] == ["6", "2"]
    assert marking.in_calls_of(Asked(calling([3], [9]), before), plain) is None
    assert marking.in_calls_of(Asked(before), plain) is plain


def test_an_answer_is_reviewed_beside_the_question_of_its_own_student(begun, out):
    """The page once showed variant 0's right answer for everybody."""
    graded = Class(out.folder)
    seen = set()
    for cluster in graded.clusters.values():
        if cluster.question == NAME:
            about = graded.contract(cluster)
            given = about.question.given["weight"]
            students = {record.student for record in cluster.members} - {"wrong"}
            assert {begun.own[student] for student in students} <= {given}
            assert about.plain["nodes"][0][1] == str(2 * given)
            seen |= students
        else:
            assert "twice its argument" in graded.contract(cluster).text
    assert seen == set(STUDENTS)


# --- the judge ----------------------------------------------------------------------------------


def test_small_numbers_with_long_exponents_cost_neither_time_nor_memory():
    """A line of SymPy once cost two minutes a node, and 1.7 GB for each 10^9 in an exponent."""
    tiny = sm.Pow(
        sm.Add(sm.Pow(sm.Float("1e-99999"), 9_999, evaluate=False), sm.I, evaluate=False),
        sm.Float("1e-300"),
        evaluate=False,
    )
    read_plain(to_plain(tiny))
    value = evaluate.values(to_plain(tiny)["nodes"], {})[-1]
    assert isinstance(value, (evaluate.NotSupported, evaluate.MP.mpf, evaluate.MP.mpc))
    for text in ("1e-99999999999999999999", "3.5e+99999999999999999999", "1e-2000"):
        # The reason must not be "no answer was found".
        plain = read_plain({"value": ["expression", 0], "nodes": [["float", text]]})
        assert isinstance(
            evaluate.values(plain["nodes"], {})[0],
            (evaluate.NotSupported, evaluate.TooLarge, evaluate.MP.mpf),
        )
    assert evaluate.values([["float", "2.5e-2000"]], {})[0] * evaluate.MP.mpf(
        10
    ) ** 2000 == evaluate.MP.mpf("2.5")
    # A part that affects no digit is left out, and the other one stays.
    nodes = [
        ["float", "1e-9000"],
        ["constant", "ImaginaryUnit"],
        ["Mul", 0, 1],
        ["integer", "2"],
        ["Add", 3, 2],
    ]
    assert evaluate.values(nodes, {})[-1] == 2


class _Hostile:
    """A judge of three answers, one of which takes too much of something."""

    def __init__(self, what):
        self.what = what

    def __call__(self, name, question, *others):
        if name == "second":
            self.what()
        return Mark("correct")


def _too_long():
    while True:
        pass


def _too_much():
    return bytearray(1 << 40)


def _ends():
    import os

    os._exit(3)


@pytest.mark.parametrize("what", [_too_long, _too_much, _ends])
def test_an_answer_that_stops_the_judge_costs_nobody_else_a_mark(monkeypatch, tmp_path, what):
    question = (Contract("One", "one", 2, Question("expression"), version="v"),)
    names = ("first", "second", "third")
    monkeypatch.setattr(judging, "MOST_SECONDS", 1)
    monkeypatch.setattr(marking, "mark_with_siblings", _Hostile(what))
    record = Record("ann", "turns")
    said = []
    with judging.Judge(
        {"turns": dict.fromkeys(names, question)}, Contracts(tmp_path), said.append
    ) as judge:
        for _ in range(2):
            marks = judge.marks(record)
            assert [marks[name].outcome for name in names] == ["correct", "undecided", "correct"]
            assert marks["second"].note == "too much work" and marks["second"].worth == 2
    assert len(said) == 2 and "'ann' turns second" in said[0]


# --- whose it is --------------------------------------------------------------------------------


def test_a_class_that_says_to_be_of_others_is_not_graded_by_wrong_numbers(begun, tmp_path):
    """With the roster forgotten, a class once fell silently from 16 to 9 of 21 points."""
    for student in STUDENTS[:6]:
        put(
            tmp_path / "in",
            f"folder of {student}",
            answered(2 * begun.own[student], says=student),
            "beams.ipynb",
        )
    solutions = begun.place / "solutions"
    said = io.StringIO()
    with pytest.raises(NothingToGrade, match="Of 6 notebooks .* 6 carry .*roster in term.toml"):
        grade_quietly(tmp_path / "in", tmp_path / "out", solutions, show=said)
    assert (
        "says that it belongs to 'student-00', but we grade it for 'folder of student-00'"
        in said.getvalue()
    )
    assert "student-00" in (tmp_path / "out" / "whose.csv").read_text()
    said = io.StringIO()
    grade_quietly(tmp_path / "in", tmp_path / "out", solutions, show=said, as_listed=True)
    lost = sum(
        mark.note == "other numbers" for mark in marks_of(Store(tmp_path / "out"), NAME).values()
    )
    assert lost < 3 or f"{lost} of 6 answers are right for numbers other" in said.getvalue()
    roster = tmp_path / "roster.csv"
    roster.write_text(
        "student,handed in as\n" + "".join(f"{who},folder of {who}\n" for who in STUDENTS[:6])
    )
    write_term(tmp_path / "out", roster, {"beams": ["beams"]})
    grade_quietly(tmp_path / "in", tmp_path / "out", solutions, agree=lambda changes: True)
    assert {mark.points for mark in marks_of(Store(tmp_path / "out"), NAME).values()} == {2}


# --- decisions ----------------------------------------------------------------------------------

RECORD = Record("ann", "turns")


def test_a_credit_is_a_share_of_the_points(tmp_path):
    with pytest.raises(ValueError, match="from 0 to 1, not 2"):
        Journal(tmp_path).add(RECORD, "turns/sum", 2)


@pytest.mark.parametrize("left", [1, 20, -1])
def test_a_journal_that_ends_within_a_line_is_read_and_goes_on(tmp_path, left):
    journal = Journal(tmp_path)
    journal.add(RECORD, "turns/sum", 0.5, who="Ann", why="für sich")
    journal.add(RECORD, "turns/sum", 1, who="Ben")
    path = tmp_path / "journal.jsonl"
    whole = path.read_bytes()
    second = whole.split(b"\n")[1]
    path.write_bytes(whole[: len(whole) - 1 - len(second)] + second[:left])
    again = Journal(tmp_path)
    assert [decision.who for decision in again.by_people] == [
        "Ann"
    ] and "ends in the middle of a line" in again.said_of_cut()
    again.add(RECORD, "turns/sum", 0, who="Cem")
    assert [decision.who for decision in Journal(tmp_path).by_people] == [
        "Ann",
        "Cem",
    ] and not again.said_of_cut()
    assert (tmp_path / CUT).read_bytes() == second[:left] + b"\n"
    # A line whose end only an editor removed is complete.
    path.write_bytes(whole[:-1])
    assert len(Journal(tmp_path).by_people) == 2 and not Journal(tmp_path).said_of_cut()
    Journal(tmp_path).add(RECORD, "turns/sum", 0, who="Cem")
    assert [decision.who for decision in Journal(tmp_path).by_people] == ["Ann", "Ben", "Cem"]


def test_names_that_are_to_be_hidden_are_hidden_in_what_students_wrote(begun, out):
    graded = Class(out.folder)
    for record in graded.records:
        if record.student != "wrong":
            cells = "\n".join(graded.store.work(record.notebooks[0].sha256))
            assert record.student in cells
            shown = graded.without_names(cells)
            assert (
                record.student not in shown
                and f"student('{graded.aliases[record.student]}')" in shown
            )
    assert graded.without_names("student('Nobody Known')") == "student('somebody')"
    assert not re.search(
        "student-0",
        graded.without_names("asked Student-03, student-030 and STUDENT-04").replace(
            "student-030", ""
        ),
    )
    assert graded.without_names(None) is None
    identity = Identity({"name": "Mark O'Neill", "email": "m.oneill@uni.example"})
    graded.records[0] = dataclasses.replace(graded.records[0], identity=identity)
    graded._know_names()
    alias = graded.aliases[graded.records[0].student]
    assert (
        graded.without_names("Mark, m.oneill and Neill mark")
        == f"{alias}, {alias} and {alias} mark"
    )


def test_what_holds_right_answers_is_read_by_nobody_else(out):
    for folder in ("questions", "contracts"):
        for path in (out.folder / folder).rglob("*.json"):
            assert path.stat().st_mode & 0o077 == 0, path


# --- siblings -----------------------------------------------------------------------------------


def test_a_friends_answer_under_the_names_of_siblings_earns_no_more_than_chance(begun):
    """One of eight has the same numbers; with two siblings it was once three, or three of four."""
    questions = questions_of(begun.place / "solutions" / "beams.ipynb", b"any")
    earned, asked = 0, {NAME: questions[NAME]}
    friends = Answer("recorded", to_plain(2 * WEIGHTS[3]))
    for number in range(8):
        student = next(f"{k}" for k in range(999) if variant_of(f"{k}", NAME, 8) == number)
        own, _ = marking.of_student(asked, student)
        answers = dict.fromkeys([NAME, *siblings_of(NAME, 8)], friends)
        for had in ("", "solution"):
            remembered = {NAME: Remembered(1, help=had)} if had else {}
            mark = marking.mark_with_siblings(NAME, own[NAME], answers, remembered)
            earned += mark.points > 0
    assert earned == 2  # of 16


# --- submissions --------------------------------------------------------------------------------


def _png(size=(2, 2)):
    from matplotlib.figure import Figure

    data = io.BytesIO()
    Figure(figsize=size, dpi=10).savefig(data, format="png")
    return data.getvalue()


def _jpeg():
    from PIL import Image

    data = io.BytesIO()
    Image.new("RGB", (24, 16), "teal").save(data, "jpeg", progressive=True)
    return data.getvalue()


@pytest.mark.parametrize("kind, made", [(pictures.PNG, _png), (pictures.JPEG, _jpeg)])
def test_what_is_shown_as_a_picture_is_one(kind, made):
    data = made()
    assert pictures.is_picture(kind, data)
    other = pictures.JPEG if kind == pictures.PNG else pictures.PNG
    for wrong in (data[:8] + b"<script>", b"", data[:3], b"\xff" * 50):
        assert not pictures.is_picture(kind, wrong)
    assert not pictures.is_picture(other, data) and not pictures.is_picture("image/svg+xml", data)


def test_a_picture_that_would_fill_the_memory_is_none():
    import struct
    import zlib

    def part(name, body):
        return (
            struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))
        )

    def png(wide):
        header = struct.pack(">IIBBBBB", wide, 60_000, 8, 2, 0, 0, 0)
        return (
            b"\x89PNG\r\n\x1a\n"
            + part(b"IHDR", header)
            + part(b"IDAT", zlib.compress(b""))
            + part(b"IEND", b"")
        )

    assert pictures.is_picture(pictures.PNG, png(600)) and not pictures.is_picture(
        pictures.PNG, png(60_000)
    )


@pytest.mark.parametrize(
    "submissions, out, said",
    [
        ("damaged.zip", "out", "not a zip archive, or it is damaged"),
        ("nothing", "out", "is empty: it contains no files"),
        ("class", "a-file", "File exists"),
    ],
)
def test_what_cannot_be_read_or_written_is_named(tmp_path, submissions, out, said):
    (tmp_path / "damaged.zip").write_bytes(b"PK\5\6" + b"\0" * 16)
    (tmp_path / "nothing").mkdir()
    (tmp_path / "a-file").touch()
    put(tmp_path / "class", "ann", answered(1), "beams.ipynb")
    solutions = write_beams(tmp_path / "solutions", WEIGHTS)
    with pytest.raises(SystemExit, match=said):
        main(
            [
                "grade",
                str(tmp_path / submissions),
                "--out",
                str(tmp_path / out),
                "--solutions",
                str(solutions),
            ]
        )


def test_a_namespace_of_one_user_is_named_as_the_cause(monkeypatch):
    """The message was once "Errno 22"."""
    monkeypatch.setattr("os.geteuid", lambda: 0)
    assert isolation.user_for_students(4242, "0 0 4294967295\n") == 4242
    assert isolation.user_for_students(4242, "0 1000 1\n65534 100000 1\n") == isolation.OUTSIDER
    with pytest.raises(RuntimeError, match="Root is the only user here"):
        isolation.user_for_students(4242, "         0       1000          1\n")


# --- variants by their names --------------------------------------------------------------------


def test_a_course_that_gives_variants_by_name_says_so_to_students_and_graders(tmp_path):
    sources = write_beams(tmp_path / "solutions", WEIGHTS)
    (tmp_path / "course.toml").write_text('title = "Beams"\nvariants = "by name"\n')
    question = questions_of(sources / "beams.ipynb", b"any")[NAME]
    names = list(question[0].variant.names)
    assert list(variants_of(question)) == names and len(names) == 8
    for student in STUDENTS:
        order = numbers_of_variants(student, NAME, question[0].variant, 8)
        case = case_by_rule(NAME, question, student)
        assert case.own.variant == names[order[0]] and case.rule == "by name, of 8"
        assert [place.variant for place in case.siblings.values()] == [names[k] for k in order[1:3]]
    left = write_beams(tmp_path / "solutions", WEIGHTS[1:])
    fewer = questions_of(left / "beams.ipynb", b"any")[NAME]
    gone = (set(names) - set(fewer[0].variant.names)).pop()
    for student in STUDENTS:
        before, after = case_by_rule(NAME, question, student), case_by_rule(NAME, fewer, student)
        assert before.own.variant in (gone, after.own.variant)
    (tmp_path / "course.toml").write_text('title = "Beams"\nvariants = "by chance"\n')
    with pytest.raises(AuthorError, match="by name"):
        questions_of(sources / "beams.ipynb", b"any")


# --- the regrade laboratory ---------------------------------------------------------------------


def mended(folder, exchanged, weights=WEIGHTS, **more):
    write_beams(folder, weights, **more)
    path = folder / "beams.ipynb"
    text = path.read_text()
    assert exchanged[0] in text
    path.write_text(text.replace(*exchanged))
    return folder


def test_only_what_cannot_be_judged_is_run_again(begun, out, tmp_path):
    """A corrected solution judges stored answers; a corrected call runs for those asked it."""
    solutions = mended(tmp_path / "mended", ("2*beam.weight", "7*beam.weight"))
    assert grade_quietly(begun.place / "in", out.folder, solutions)["graded"] == 0
    assert {mark.points for mark in marks_of(out, NAME).values()} == {0}
    calls = mended(tmp_path / "calls", ("2*x", "x + x"), calls="[[7.5], [1.5]]")
    laboratory = regrade(out.folder, solutions=calls, dry_run=True)
    assert {move.student for move in laboratory.again} == {
        *STUDENTS,
        "wrong",
    } and "To judge just these, run" in "\n".join(laboratory.lines())
    few = shutil.copytree(begun.place / "in" / STUDENTS[0], tmp_path / "few" / STUDENTS[0]).parent
    assert grade_quietly(few, out.folder, calls)["graded"] == 1
    assert out.read(STUDENTS[0], "beams").marks["beams/twice"].points == 3


def test_the_figure_of_a_question_is_seen_in_the_review(tmp_path):
    """The students' notebook has it as a picture, beside variants, too."""
    made = beams(WEIGHTS)
    figure = (
        "from types import SimpleNamespace as S\nS(alt='A beam', picture=lambda: '<svg "
        'width="9"></svg>\')'
    )
    made.cells.insert(2, nbformat.v4.new_code_cell(figure, metadata={"tags": ["figure"]}))
    made.cells.insert(7, nbformat.v4.new_code_cell(figure, metadata={"tags": ["figure"]}))
    nbformat.write(made, tmp_path / "beams.ipynb")
    questions = questions_of(tmp_path / "beams.ipynb", b"any")
    asked = [review._as_asked(questions[name][0]) for name in (NAME, "beams/twice")]
    assert all('<img alt="A beam"' in text for text in asked)
    assert "A beam carries 12 N" in asked[0] or "N twice" in asked[0]
