"""Grading a class: every notebook on its own, nothing lost or done twice, the same everywhere."""

import contextlib
import csv
import dataclasses
import hashlib
import io
import itertools
import json
import multiprocessing
import os
import re
import shutil
import signal
import sys
import time
import weakref
import zipfile
from dataclasses import replace
from html.parser import HTMLParser

import nbformat
import pytest
from attacks.names import packed
from grading_class import (
    LIMITS,
    RIGHT,
    SETUP,
    contents,
    give,
    grade_quietly,
    handed_in,
    notebook,
    put,
    write_sources,
    write_term,
)
from sample_class import BROKEN, HOSTILE, make_class

from coursework.__main__ import main
from coursework.checking.reply import plain_text, to_html
from coursework.checking.writing import answer_as_text
from coursework.grading.assignments import NothingToGrade
from coursework.grading.execution.sandbox import (
    WorkerDied,
    given_up,
)
from coursework.grading.export import gradebooks
from coursework.grading.grade import bring_in_decisions, grade, regrade
from coursework.grading.judging.journal import Journal
from coursework.grading.record import Answer
from coursework.grading.reporting import pages
from coursework.grading.reporting.reports import write_all
from coursework.grading.running import Running
from coursework.grading.store import Store, file_name, write
from coursework.grading.submissions import languages
from coursework.grading.submissions.roster import Roster
from coursework.grading.tables import as_cell, as_written, table
from coursework.grading.workers import TaskLost, side_by_side

pytestmark = [
    pytest.mark.skipif(
        not sys.platform.startswith("linux"), reason="student code runs on Linux only"
    ),
    pytest.mark.usefixtures("libraries_are_loaded_once"),
]

SCRIPT = "<script>alert(1)</script>"


def students():
    """Iterate over a class's notebooks by student, each right except for what is given."""
    yield "right", handed_in()
    yield (
        "mistaken",
        handed_in(
            about_x="A_C_N = sm.Matrix([[1, 0, 0], [0, sm.cos(theta), -sm.sin(theta)], [0, "
            "sm.sin(theta), sm.cos(theta)]])",
            sum="sine = -sm.sin(alpha + beta)",
        ),
    )
    yield (
        "blank",
        handed_in(about_x="A_C_N = ...", sum="sine = ...", doubled="def doubled(x):\n    ..."),
    )
    yield "broken", handed_in(sum="sine = (sm.sin(")
    yield "leaves", handed_in(sum="import os\nos._exit(0)")
    yield "endless", handed_in(sum="while True:\n    pass")
    yield (
        "no-checks",
        notebook(
            [SETUP["turns"], *(RIGHT[f"turns/{name}"] for name in ("about-x", "sum", "doubled"))]
        ),
    )
    backwards = notebook([RIGHT["turns/sum"], "check('turns/sum', sine)", SETUP["turns"]])
    for count, cell in zip((2, 3, 1), backwards.cells):
        cell.execution_count = count
    yield "backwards", backwards
    yield "nearly", handed_in(sum="sine = sm.sin(alpha + beta)*1.0004")
    yield "warns", handed_in(sum="import warnings\nwarnings.warn('x')\nsine = sm.sin(alpha + beta)")
    yield (
        "corrects",
        handed_in(
            sum="sine = -sm.sin(alpha + beta)",
            also=[RIGHT["turns/sum"], "check('turns/sum', sine)"],
        ),
    )
    yield "blank-again", handed_in(also=["sine = ...\ncheck('turns/sum', sine)"])
    yield "later", handed_in(sum="sine = ...", also=[RIGHT["turns/sum"]])
    yield "=1+1", handed_in(sum=f"sine = sm.Symbol('{SCRIPT}')")
    yield (
        SCRIPT.replace("/", ""),
        handed_in(
            doubled=f"def doubled(x):\n    raise ValueError('{SCRIPT} "
            f"$\\\\href{{javascript:alert(1)}}{{x}}$ ` `')",
            also=[("markdown", SCRIPT), f"raise KeyError('{SCRIPT}')"],
        ),
    )


@pytest.fixture(scope="module")
def course(tmp_path_factory):
    """The solutions, the submissions, and the results of grading them on two workers."""
    place = tmp_path_factory.mktemp("course")
    solutions, submissions = write_sources(place / "solutions"), place / "submissions"
    for student, made in students():
        put(submissions, student, made)
    put(submissions, "refused", "{")
    put(submissions, SCRIPT.replace("/", ""), "no notebook", "answers.pdf")
    (submissions / "refused" / "link.ipynb").symlink_to(submissions / "right" / "turns.ipynb")
    said = grade_quietly(submissions, place / "out", solutions)
    assert said == {"graded": 15, "kept": 0, "refused": 3, "held": 0}
    return place


@pytest.fixture
def copied(course, tmp_path):
    """A copy of the results, for changes."""
    return shutil.copytree(course / "out", tmp_path / "out")


@pytest.fixture
def prepared(course, tmp_path):
    """A folder for results with the processed questions, whose processing is not tested here."""
    shutil.copytree(course / "out" / "questions", tmp_path / "out" / "questions")
    return tmp_path / "out"


def record(course, student):
    return Store(course / "out").read(student, "turns")


def rows_of(path):
    with open(path, newline="", encoding="utf8") as file:
        return list(csv.DictReader(file))


def outcomes(course, student):
    return [mark.outcome for mark in record(course, student).marks.values()]


# ---- the result of each notebook


@pytest.mark.parametrize(
    "student, expected, points",
    [
        ("right", ["correct"] * 3, 6),
        # The author gives half of two points for the transpose.
        ("mistaken", ["wrong", "wrong", "correct"], 4),
        ("blank", ["not attempted"] * 3, 0),
        ("broken", ["correct", "not attempted", "correct"], 5),
        ("leaves", ["correct", "not attempted", "correct"], 5),
        ("endless", ["correct", "undecided", "correct"], 5),  # It may have been lost to the limit.
        ("no-checks", ["correct"] * 3, 6),
        ("backwards", ["not attempted", "correct", "not attempted"], 1),
        ("nearly", ["correct", "undecided", "correct"], 5),
        ("warns", ["correct"] * 3, 6),
        ("corrects", ["correct"] * 3, 6),
        ("blank-again", ["correct"] * 3, 6),
        ("later", ["correct"] * 3, 6),
        ("=1+1", ["correct", "invalid", "correct"], 5),
        (SCRIPT.replace("/", ""), ["correct", "correct", "invalid"], 3),
    ],
)
def test_marks(course, student, expected, points):
    assert outcomes(course, student) == expected
    graded = record(course, student)
    assert (graded.points, graded.worth) == (points, 6)


def test_a_record_says_what_it_rests_on(course):
    graded = record(course, "endless")
    written = (course / "submissions" / "endless" / "turns.ipynb").read_bytes()
    (notebook,) = graded.notebooks
    assert notebook.sha256 == hashlib.sha256(written).hexdigest()
    assert notebook.isolation.layers and notebook.isolation.weak is False and notebook.seed == 0
    assert [cell.outcome for cell in notebook.cells][3] == "timeout"
    assert graded.limits == dataclasses.asdict(LIMITS)
    assert set(graded.software) >= {"python", "sympy", "numpy", "coursework"}
    assert (
        set(graded.answers)
        == set(graded.marks)
        == {name for name in RIGHT if name.startswith("turns/")}
    )
    assert all(mark.version for mark in graded.marks.values())


def test_out_of_order_is_said(course):
    assert record(course, "backwards").notebooks[0].notes == ("works only out of order",)
    assert "in a different order" in page(course, "backwards")
    assert "works only out of order" in (course / "out" / "report.html").read_text()


def test_submissions_were_only_read(course):
    for student, made in students():
        assert (course / "submissions" / student / "turns.ipynb").read_text() == nbformat.writes(
            made
        )
    assert {
        path.name
        for path in (course / "submissions").rglob("*")
        if path.is_file() or path.is_symlink()
    } == {
        "turns.ipynb",
        "link.ipynb",
        "answers.pdf",
    }


# ---- pages and tables are safe


def page(course, student):
    return (course / "out" / "feedback" / file_name(student) / "turns.html").read_text("utf8")


class Tags(HTMLParser):
    def __init__(self):
        super().__init__()
        self.found, self.attributes, self.links = set(), set(), set()

    def handle_starttag(self, tag, attributes):
        self.found.add(tag)
        self.attributes |= {name for name, _ in attributes if (tag, name) != ("a", "href")}
        self.links |= {value for name, value in attributes if (tag, name) == ("a", "href")}


def test_pages_hold_nothing_that_could_run_or_load(course):
    paths = [*(course / "out").rglob("*.html")]
    assert len(paths) == 16
    for path in paths:
        tags = Tags()
        tags.feed(path.read_text("utf8"))
        assert not tags.found & {
            "script",
            "iframe",
            "img",
            "object",
            "embed",
            "link",
            "base",
            "form",
            "style-src",
        }
        assert not [
            name
            for name in tags.attributes
            if name.startswith("on") or name in ("href", "src", "style", "srcdoc")
        ]
        # Links lead to pages of feedback, whatever a student is called.
        for link in tags.links:
            assert (
                re.fullmatch(r"feedback/[A-Za-z0-9._-]+/[a-z0-9._-]+\.html", link)
                and (path.parent / link).exists()
            )
        assert "default-src 'none'" in path.read_text("utf8")
    student = SCRIPT.replace("/", "")
    assert "&lt;script&gt;alert(1)" in page(course, student)
    assert "&lt;script&gt;" in (course / "out" / "report.html").read_text("utf8")


def test_nothing_in_a_table_is_a_formula(course):
    for path in (course / "out").glob("*.csv"):
        for row in csv.reader(io.StringIO(path.read_text("utf8"))):
            assert not [
                cell for cell in row if cell.startswith(("=", "+", "-", "@", "\t", "\r"))
            ], path
    rows = rows_of(course / "out" / "grades.csv")
    assert {as_written(row["student"]) for row in rows} == {student for student, _ in students()}
    assert {row["student"]: row["points"] for row in rows}["'=1+1"] == "5"
    assert {row["student"]: row["turns/sum: outcome"] for row in rows}["nearly"] == "undecided"


@pytest.mark.parametrize(
    "text",
    [
        "=1+1",
        "+1",
        "-1",
        "@SUM(A1)",
        "\t=1",
        "\r=1",
        "\n=1",
        "\uff1d1",
        "'=1",
        '"=1',
        "a,b",
        "\u202egnp",
    ],
)
def test_cells(text):
    (row,) = list(csv.reader(io.StringIO(table([text], []))))
    assert row == [text] or text in ("\r=1",)
    (_, row) = list(csv.reader(io.StringIO(table(["x"], [[text]]))))
    assert (
        not row[0].startswith(("=", "+", "-", "@", "\t", "\r", "\n", "\uff1d"))
        and "\u202e" not in row[0]
    )
    assert as_cell(3) == "3" and as_cell(-0.5) == "-0.5"


def test_mathematics_in_messages():
    assert "<math" in pages.message(
        "This is ${}^{A}\\mathbf{C}^{N}$ in `code`."
    ) and "<code>code</code>" in pages.message("`code`")
    for hostile in (
        "$\\href{javascript:alert(1)}{x}$",
        "$<img src=x>$",
        "`<b>`",
        "*<b>*",
        "<b>",
        "$" + "{" * 400 + "$",
    ):
        said = pages.message(hostile)
        tags = Tags()
        tags.feed(said)
        assert not tags.found & {"a", "img", "b", "script"} and "href" not in tags.attributes


@pytest.mark.parametrize(
    "said, shown",
    [
        ("*theta is odd", "*theta is odd"),
        ("one ` or one $ is text", "one ` or one $ is text"),
        ("2*a*b <x>", "2*a*b &lt;x&gt;"),
        ("the *whole* `2*a*b`", "the <em>whole</em> <code>2*a*b</code>"),
        ("**", "**"),
        ("", ""),
    ],
)
def test_one_function_makes_a_message_a_page_and_loses_no_sign(said, shown):
    assert to_html(said) == pages.message(said) == shown
    assert plain_text("`2*a*b`, 2*a*b and $2\\pi$") == "2*a*b, 2*a*b and 2 pi"


def test_a_number_is_shown_with_the_digits_that_make_it_nearly_right():
    nearly = {
        "value": ["expression", 2],
        "nodes": [["symbol", "x"], ["float", "1.0000001"], ["Mul", 1, 0]],
    }
    assert "1.0000001" in pages.answer_as_mathematics(nearly) and "1.0000001" in answer_as_text(
        nearly
    )


def test_an_answer_is_printed_in_bounded_length():
    doubling = {
        "value": ["expression", 60],
        "nodes": [["symbol", "x"], *(["Add", order, order] for order in range(60))],
    }
    assert len(answer_as_text(doubling)) < 400
    deep = {
        "value": ["expression", 5_000],
        "nodes": [["symbol", "x"], *(["sin", order] for order in range(5_000))],
    }
    assert len(answer_as_text(deep)) < 400
    import sympy as sm

    from coursework.checking.plain import to_plain

    x, y = sm.symbols("x y")
    for expression in (
        x - y,
        -x / 2,
        (x + y) ** 2,
        sm.sqrt(x) * (y - 1),
        2 ** (x * y),
        x**-y,
        sm.sin(x) / y,
        -(x + y),
        (x**2) ** y,
    ):
        assert sm.simplify(sm.sympify(answer_as_text(to_plain(expression))) - expression) == 0


# ---- the report


def test_the_report_tells_what_was_misunderstood(course):
    text = re.sub(r"<[^>]+>", " ", (course / "out" / "report.html").read_text("utf8"))
    text = " ".join(text.split())
    assert "15 students" in text
    assert "7 % gave the transpose in question 1, about x (1 of 15)" in text
    assert "7 % gave the negative in question 2, sum (1 of 15)" in text
    assert "link, which we did not follow" in text and "not well-formed JSON" in text
    assert "agrees with the right one to about three digits" in text


def test_identical_wrong_answers_are_put_together(tmp_path, course):
    plain = {
        "value": ["expression", 2],
        "nodes": [["integer", "42"], ["symbol", "alpha"], ["Mul", 0, 1]],
    }

    def report(*groups):
        store = Store(tmp_path)
        for number, group in enumerate(groups):
            graded = record(course, "right")
            mark = replace(
                graded.marks["turns/sum"], outcome="wrong", note="", group=group, points=0
            )
            give(
                store,
                replace(
                    graded,
                    student=f"student-{number}",
                    marks={**graded.marks, "turns/sum": mark},
                    answers={**graded.answers, "turns/sum": Answer("recorded", plain)},
                ),
            )
        list(write_all(store))
        return (tmp_path / "report.html").read_text()

    assert "42*alpha" in report("same", "same", "other")
    assert "42*alpha" not in report("one", "other", "third")


def test_reports_hold_one_record_at_a_time(tmp_path, course, monkeypatch):
    made, most = [], 0

    def all_of_them(store):
        nonlocal most
        for number in range(300):
            graded = replace(record(course, "right"), student=f"student-{number}")
            made.append(weakref.ref(graded))
            most = max(most, sum(reference() is not None for reference in made))
            yield graded
            del graded

    monkeypatch.setattr(Store, "all", all_of_them)
    list(write_all(Store(tmp_path)))
    assert most <= 3
    assert (
        "300 students" in (tmp_path / "report.html").read_text()
        and (tmp_path / "grades.csv").read_text().count("\n") == 301
    )


# ---- never lost, never twice


def test_a_table_that_somebody_changed_is_kept_and_said(course, copied):
    shown = io.StringIO()
    (copied / "undecided.csv").write_text("decisions of an evening")
    regrade(copied, solutions=course / "solutions", show=shown)
    (kept,) = copied.glob("undecided-changed-*.csv")
    assert kept.read_text() == "decisions of an evening" and "merge`" in shown.getvalue()


@pytest.mark.parametrize("writes", range(4))
def test_a_killed_run_does_not_take_its_own_table_for_a_persons(tmp_path, monkeypatch, writes):
    def write_some(*arguments, done=itertools.count()):
        if next(done) == writes:
            raise KeyboardInterrupt
        write(*arguments)

    store = Store(tmp_path)
    list(store.write_table("grades.csv", ["yesterday"], ""))
    with monkeypatch.context() as killed, contextlib.suppress(KeyboardInterrupt):
        killed.setattr("coursework.grading.store.write", write_some)
        list(store.write_table("grades.csv", ["today"], ""))
    assert list(store.write_table("grades.csv", ["tomorrow"], "")) == []
    assert [path.read_text() for path in tmp_path.glob("grades*")] == ["tomorrow"]


def test_a_full_disk_is_named(tmp_path):
    with pytest.raises(OSError, match=r"No space left.*marks\.csv"):
        write(
            tmp_path / "marks.csv",
            (str((tmp_path / "/dev/full").write_text(part)) for part in "ab"),
        )
    (tmp_path / "run.log").symlink_to("/dev/full")
    with pytest.raises(OSError, match=r"No space left.*run\.log"):
        Store(tmp_path).log("graded")


def graded_lines(folder):
    return [
        line.split("graded: ")[1]
        for line in (folder / "run.log").read_text().splitlines()
        if "graded: " in line
    ]


def test_changed_code_judges_everybody_again(course, copied, tmp_path, monkeypatch):
    """Classmates are judged by the same code, so any change in the two packages counts."""
    from coursework.grading import versions

    copies = [
        shutil.copytree(
            package, tmp_path / package.name, ignore=shutil.ignore_patterns("__pycache__")
        )
        for package in versions.folders()
    ]
    ours, theirs = copies[0], tmp_path / "turning_course"
    assert versions.digest_of_packages(copies) == versions.digest_of_packages()
    digests = {versions.digest_of_packages()}
    for path in (
        ours / "grading" / "judging" / "marking.py",
        ours / "checking" / "kinds.py",
        ours / "authoring" / "author.py",
        theirs / "__init__.py",
    ):
        path.write_text(path.read_text() + "\n# changed\n")
        digests.add(versions.digest_of_packages(copies))
    assert len(digests) == 5
    path.rename(path.with_name("another.py"))
    assert versions.digest_of_packages(copies) not in digests
    shutil.rmtree(copied / "records" / "endless")  # It takes long and is not tested here.
    few = shutil.copytree(course / "submissions" / "right", tmp_path / "few" / "right").parent
    monkeypatch.setattr(versions, "folders", lambda: copies)
    versions.software.cache_clear()
    try:
        said = grade_quietly(few, copied, course / "solutions")
    finally:
        versions.software.cache_clear()
    assert said == {"graded": 1, "kept": 0, "refused": 0, "held": 0}


def test_what_was_decided_goes_with_a_student_whom_a_roster_calls_something_else(
    course, copied, tmp_path
):
    """A roster follows folder names; two handed in the same, and each keeps the right decision."""
    few, same, shown = tmp_path / "few", handed_in(sum="sine = sm.cos(alpha)"), io.StringIO()
    for name in ("b", "c"):
        put(few, name, same)
    grade_quietly(few, copied, course / "solutions")
    for name, credit in (("b", 0.5), ("c", 1)):
        Journal(copied).add(
            Store(copied).read(name, "turns"), "turns/sum", credit, who="Ann", why="appeal"
        )
    roster = tmp_path / "roster.csv"
    roster.write_text("student,name\nanother,c\nsomebody,b\n")
    write_term(copied, roster)
    grade_quietly(few, copied, course / "solutions", show=shown)
    points = {row["student"]: row["points"] for row in rows_of(copied / "grades.csv")}
    assert "b" not in points and (points["somebody"], points["another"]) == ("5.5", "6")
    assert (copied / "put-aside" / "b" / "turns.json").exists()
    assert (
        "'b' is now 'somebody'" in shown.getvalue()
        and "and all decisions and appeals are now under the new name" in shown.getvalue()
    )
    handed_on = {decision.student: decision for decision in Journal(copied).by_people}
    assert (handed_on["somebody"].who, handed_on["somebody"].why) == ("Ann", "appeal; was 'b'")
    assert handed_on["somebody"].when == handed_on["b"].when
    # Somebody who left the roster has not become the other student who handed in the same.
    roster.write_text("student,name\nthird,c\n")
    grade_quietly(few, copied, course / "solutions", show=shown)
    assert (
        "'another' is now 'third'" in shown.getvalue()
        and "'somebody' is now" not in shown.getvalue()
    )
    (copied / "term.toml").unlink()
    # If folders are renamed, too, nobody knows which is which, and where other students are missing
    # this may be late work that somebody copied.
    for name in ("b", "c"):
        (few / name).rename(few / f"{name}{name}")
    grade_quietly(few, copied, course / "solutions", show=shown)
    assert "'bb' and 'cc' handed in the very notebook of 'somebody'" in shown.getvalue()
    assert Store(copied).read("somebody", "turns").points == 5.5
    for place in copied.glob("records/*"):
        if place.name not in ("somebody", "third"):
            shutil.rmtree(place)
    grade_quietly(few, copied, course / "solutions", show=shown)
    assert (
        "'somebody' is now 'bb' or 'cc'" in shown.getvalue()
        and "no longer count" in shown.getvalue()
    )
    assert Store(copied).read("bb", "turns").points == 5


def test_a_journal_of_other_answers_is_said(course, copied, capsys, tmp_path):
    mistaken = Store(copied).read("mistaken", "turns")
    (tmp_path / "other").mkdir()
    other = Journal(tmp_path / "other")
    other.add(mistaken, "turns/sum", 1)
    other.add(replace(mistaken, student="stranger"), "turns/sum", 1)
    other.add(replace(mistaken, answers={}), "turns/about-x", 1)
    main(["merge", str(copied), str(other.path), "--yes"])
    said = capsys.readouterr().out
    assert (
        ": 3 decisions" in said
        and "We ignored 2 of them, about answers missing from this folder (stranger, mistaken)"
        in said
    )


@pytest.mark.parametrize("workers", [0, -1])
def test_without_workers_nothing_is_graded_and_it_is_said(course, tmp_path, workers):
    with pytest.raises(
        ValueError, match=f"The number of workers must be at least one, not {workers}"
    ):
        grade(
            course / "submissions",
            tmp_path,
            solutions=course / "solutions",
            running=Running(workers=workers),
        )


def test_feedback_leads_to_the_chapter_and_to_a_solution_that_is_released(course, copied, tmp_path):
    solutions = shutil.copytree(course / "solutions", tmp_path / "course" / "solutions")
    said = tmp_path / "course" / "course.toml"
    page, marks = copied / "feedback" / "right" / "turns.html", record(course, "right").marks
    said.write_text('chapter = "https://book.example/{notebook}.html"\n')
    regrade(copied, solutions=solutions)
    assert page.read_text("utf8").count(
        '<a href="https://book.example/turns.html">the chapter</a>'
    ) == len(marks)
    assert "worked solution" not in page.read_text("utf8")
    said.write_text(
        said.read_text() + 'solution = "https://book.example/solved#{notebook}-{question}"\n'
    )
    regrade(copied, solutions=solutions)
    assert (
        '<a href="https://book.example/solved#turns-about-x">the worked solution</a>'
        in page.read_text("utf8")
    )
    said.unlink()
    regrade(copied, solutions=solutions)
    assert "Read on" not in page.read_text("utf8")
    for address in (
        "javascript:alert('{notebook}')",
        "https://book.example/all",
        "https://book.example/{student}",
    ):
        said.write_text(f'chapter = "{address}"')
        with pytest.raises(ValueError, match="must be an address with {notebook}"):
            regrade(copied, solutions=solutions)


def test_feedback_gives_no_outputs_of_calls_away(course):
    """A function's results would help a friend, and those of the secret calls everybody later."""
    answer = record(course, "right").answers["turns/doubled"]
    assert answer.plain["value"][0] == answer.secret["plain"]["value"][0] == "function"
    said = page(course, "right")
    numbers = [
        node[1] for plain in (answer.plain, answer.secret["plain"]) for node in plain["nodes"]
    ]
    assert len(numbers) == 5 and not [number for number in numbers if number[:6] in said]
    assert "in place of" not in page(course, "blank") and "Nothing was answered." in page(
        course, "blank"
    )


class Stub:
    """A stand-in for a sandbox, in which every notebook is blank or dies."""

    def __init__(self, *arguments, **options):
        pass

    def __enter__(self):
        return self

    def __exit__(self, *error):
        pass

    def run(self, job):
        code = job["cells"][-1]["source"]
        if code == "sandbox":
            raise WorkerDied("again and again")
        if code == "process":
            os._exit(1)
        if code == "grader":
            os.kill(os.getppid(), signal.SIGKILL)
            time.sleep(60)  # It ends with the grader.
        blank = {
            "outcome": "recorded",
            "plain": {"nodes": [], "value": ["blank"]},
            "from": "check",
            "cell": 0,
        }
        isolation = {"layers": [], "weak": False, "not stopped": []}
        return {**given_up(job, ""), "finished": True, "notes": [], "isolation": isolation,
                "answers": dict.fromkeys(job["questions"], blank)}  # fmt: skip


@pytest.mark.parametrize("victim", ["sandbox", "process"])
def test_what_dies_under_a_notebook_costs_only_that_one(
    course, prepared, tmp_path, monkeypatch, victim
):
    for number in range(9):
        put(
            tmp_path / "few",
            f"student-{number}",
            handed_in(also=[victim if number == 4 else "pass"]),
        )
    monkeypatch.setattr("coursework.grading.execution.sandbox.Sandbox", Stub)
    options = {
        "solutions": course / "solutions",
        "running": Running(limits=LIMITS, workers=2),
        "show": io.StringIO(),
    }
    assert grade(tmp_path / "few", prepared, **options)["graded"] == 9
    for graded in Store(prepared).all():
        expected = "undecided" if graded.student == "student-4" else "not attempted"
        assert {mark.outcome for mark in graded.marks.values()} == {expected}
        assert (graded.notebooks[0].isolation.given_up is not None) == (expected == "undecided")
    assert len(graded_lines(prepared)) == len(set(graded_lines(prepared))) == 9
    # A machine failure leaves no final record, so only that notebook is retried.
    assert grade(tmp_path / "few", prepared, **options)["graded"] == 1


def test_a_run_that_is_killed_goes_on_where_it_was(course, prepared, tmp_path, monkeypatch):
    few, solutions = tmp_path / "few", course / "solutions"
    for number in range(6):
        put(few, f"student-{number}", handed_in(also=["grader" if number == 4 else "pass"]))
    with monkeypatch.context() as patched:
        # Every notebook is blank to the run that ends, so a second run of any would show.
        patched.setattr("coursework.grading.execution.sandbox.Sandbox", Stub)
        options = {"solutions": solutions, "running": Running(limits=LIMITS, workers=1)}
        run = multiprocessing.get_context("fork").Process(
            target=grade, args=(few, prepared), kwargs=options | {"show": io.StringIO()}
        )
        run.start()
        run.join()
    done = len(list((prepared / "waiting").glob("*/*.json")))
    assert run.exitcode == -signal.SIGKILL and not list((prepared / "records").glob("*/*.json"))
    (prepared / "waiting" / "student-0" / ".half-written").write_text("{")
    said = grade_quietly(few, prepared, solutions)
    assert 3 <= done < 5 and said == {"graded": 6 - done, "kept": done, "refused": 0, "held": 0}
    assert [graded.points for graded in Store(prepared).all()] == [0] * done + [6] * (6 - done)
    lines = graded_lines(prepared)
    # The last may have been recorded but not yet logged when the run was killed.
    assert len(set(lines)) == len(lines) and len(lines) in (5, 6)
    assert not list(prepared.rglob(".half-*"))


def test_no_process_is_left_and_errors_are_told():
    def prepare(stack):
        def do(task):
            if task == "wrong":
                raise KeyError("some fault")
            if task == "named":
                raise WorkerDied("named")
            return [task, os.getpid()]

        return do

    done = list(side_by_side(range(20), 3, prepare))
    assert (
        sorted(task for task, _ in done) == list(range(20))
        and len({process for _, process in done}) <= 3
    )
    with pytest.raises(RuntimeError, match="KeyError: 'some fault'"):
        list(side_by_side(["right", "wrong"], 2, prepare))
    with pytest.raises(WorkerDied, match="named"):
        list(side_by_side(["right", "named"], 1, prepare, [WorkerDied]))
    with pytest.raises(TaskLost, match="'lost'"):
        list(side_by_side(["lost"], 1, lambda stack: lambda task: os._exit(1)))
    stopped = side_by_side(range(20), 2, prepare)
    next(stopped)
    stopped.close()
    assert multiprocessing.active_children() == []


# ---- the same wherever it is run


def test_it_fails_closed(course, prepared, monkeypatch):
    from coursework.grading.execution import isolation

    monkeypatch.setattr(
        isolation, "lacking", lambda report: ["namespaces: switched off for this test"]
    )
    with pytest.raises(SystemExit, match="switched off for this test"):
        main(
            [
                "grade",
                str(course / "submissions"),
                "--out",
                str(prepared),
                "--solutions",
                str(course / "solutions"),
                "--workers",
                "1",
            ]
        )
    assert not list((prepared / "records").glob("*/*"))


# ---- judged again


@pytest.mark.parametrize(
    "table, points, unused",
    [
        ("id,version,credit,comment\n{id},{version},0.5,Rounded.\n", 5.5, []),
        ("ID;Version;Credit\r\n{id};{version};0,5\r\n", 5.5, []),
        ("\ufeffid\tversion\tcredit\n{id}\t{version}\t4 of 4\n", 6, []),
        (
            "id,version,student,credit\nabc,{version},n\u200cerly,1\n",
            5,
            [
                "line 2, n\u200cerly: we do not have this answer. "
                "Perhaps the student has handed in again"
            ],
        ),
    ],
)
def test_tables_of_decisions_are_read_as_spreadsheets_leave_them(
    copied, tmp_path, table, points, unused
):
    lost, row = rows_of(copied / "undecided.csv")
    assert (lost["student"], lost["why"]) == ("endless", "lost to a limit")
    assert (row["student"], row["question"], row["credit"]) == ("nearly", "turns/sum", "")
    # Without the sign, a spreadsheet would turn a digest with no letter but an e into 2.38954E+11.
    assert row["id"][0] == row["version"][0] == "#"
    path, store, journal = tmp_path / "decided.csv", Store(copied), Journal(copied)
    path.write_text(table.format(**row), "utf8")
    assert journal.take_in_table(path, store.all(), "Ann") == (not unused, unused)
    assert journal.take_in_table(path, store.all(), "Ann") == (0, unused)  # Only once.
    bring_in_decisions(copied)
    assert store.read("nearly", "turns").points == points
    left = [row["student"] for row in rows_of(copied / "undecided.csv")]
    assert left == (["endless", "nearly"] if unused else ["endless"])
    path.write_text(table.format(**row).replace("0.5", "much").replace("0,5", "much"))
    if "much" in path.read_text():
        with pytest.raises(ValueError, match="line 2: 'much' is neither a credit"):
            journal.take_in_table(path, store.all())


# ---- handed on


@pytest.fixture(scope="module")
def marks(course):
    return gradebooks.Marks(Store(course / "out"))


def fill(tmp_path, marks, text, **options):
    """Fill a gradebook, and return the messages and the lines of the filled one."""
    (tmp_path / "book.csv").write_text(text, "utf8")
    said = gradebooks.fill(tmp_path / "book.csv", marks, **options)
    return "\n".join(said), (tmp_path / "book-filled.csv").read_text("utf8").splitlines()


CANVAS = (
    'Student,ID,SIS User ID,SIS Login ID,Section,Turns (77),"Final, all"\r\n'
    "    Points Possible,,,,,12,(read only)\r\n"
    '"Right, Student",1,S1,right,"A ""quoted"" section",,\r\n'
    '"Nobody, Student",2,S2,nobody,,3,\r\n'
    "Nearly,3,S3,nearly,,,\r\n"
    '"Two\r\nlines",4,S4,mistaken,x,"",9'
)


@pytest.mark.parametrize(
    "before, student, written",
    [
        ("\ufeff" + CANVAS, "right", '"A ""quoted"" section",12,'),
        (CANVAS, "mistaken", 'x,"8",9'),
        (
            'Identifier;"Full name";"ID number";Grade;"Maximum Grade";"Grade can be changed"\n'
            '"Participant 9";"A; B";right;;6,00;Yes\n'
            '"Participant 8";C;mistaken;-;6,00;No\n'
            '"Participant 7";D;broken;"";6,00;Yes\n',
            "right",
            "right;6;6,00",
        ),
        (
            "OrgDefinedId\tUsername\tLast Name\tFirst Name\tTurns Points Grade <Numeric "
            "MaxPoints:3>\tEnd-of-Line Indicator\r\n"
            "#1\t#right\tR\tS\t\t#\r\n"
            "#2\t#broken\tB\tS\t1\t#\r\n",
            "broken",
            "#broken\tB\tS\t2.5\t#",
        ),
    ],
    ids=["canvas with mark", "canvas", "moodle", "brightspace"],
)
def test_a_gradebook_is_filled_and_nothing_else_of_it_changes(
    marks, tmp_path, before, student, written
):
    path = tmp_path / "book.csv"
    path.write_bytes(before.encode())
    said = gradebooks.fill(
        path, marks, overwrite={"mistaken", "broken"} & set(re.findall(r"\w+", before))
    )
    after = (tmp_path / "book-filled.csv").read_bytes().decode()
    assert written in after and path.read_bytes() == before.encode()
    book, filled = map(gradebooks.Gradebook, (path, tmp_path / "book-filled.csv"))
    place = gradebooks._column(book, gradebooks._system(book), None)
    for (old, old_end), (new, new_end) in zip(book.lines, filled.lines, strict=True):
        assert (
            old[:place] == new[:place]
            and old[place + 1 :] == new[place + 1 :]
            and old_end == new_end
        )
    assert after.startswith("\ufeff") == before.startswith("\ufeff")
    text = "\n".join(said)
    assert "blank" in text.partition("not in the gradebook")[2]
    if "nobody" in before:
        assert "Nobody, Student" in text and "2,S2,nobody,,3," in after
        assert (
            "nearly" in text.partition("until you decide")[2]
            and "Nearly,3,S3,nearly,,,\r\n" in after
        )
    if "Moodle" in text:
        assert (
            "C;mistaken;-;6,00;No" in after and "mistaken" in text.partition("allows no change")[2]
        )


def test_what_stands_in_a_gradebook_stays_unless_told(marks, tmp_path):
    """Canvas's EX excuses a student, and a manually entered mark is not lost silently."""
    text = (
        "Student,ID,SIS User ID,SIS Login ID,Section,Turns (77)\nA,1,,right,,EX\n"
        "B,2,,mistaken,,5.00\n"
        "C,3,,blank,,0.00\nD,4,,warns,,\n"
    )
    said, after = fill(tmp_path, marks, text)
    assert [line.rpartition(",")[2] for line in after[1:]] == ["EX", "5.00", "0", "6"]
    assert (
        "right: EX, and graded 6" in said
        and "mistaken: 5.00, and graded 4" in said
        and "blank:" not in said
    )
    said, again = fill(tmp_path, marks, text, overwrite=["mistaken", "right"], dry_run=True)
    assert "We wrote nothing" in said and again == after
    said, after = fill(tmp_path, marks, text, overwrite=["mistaken", "right"])
    # An excuse is never overwritten. A manually entered mark is, for the students named.
    assert [line.rpartition(",")[2] for line in after[1:]] == ["EX", "4", "0", "6"]
    assert "mistaken: 5.00 -> 4" in said.partition("overridden as you asked")[2]
    with pytest.raises(gradebooks.CannotExport, match="'nobody', who is not in"):
        fill(tmp_path, marks, text, overwrite=["nobody"])


@pytest.mark.parametrize("language", languages.LANGUAGES)
def test_a_worksheet_of_moodle_in_another_language_is_filled(marks, tmp_path, language):
    # Spreadsheets make apostrophes plain.
    words = [word.partition("|")[0].replace("’", "'") for word in languages.LANGUAGES[language]]
    identifier, name, number, email, _, grade, most, may, no = words
    said, lines = fill(
        tmp_path,
        marks,
        f"{identifier},{name},{number},{email},{grade},{most},{may or 'x'}\n"
        f'A1,Right,right,r@x.example,,"3,00",+\nA2,Mistaken,mistaken,m@x.example,,"3,00",{no}\n'
        'A3,Broken,broken,b@x.example,,"3,00",+\n',
    )
    assert (
        f"Moodle: column {grade!r}" in said
        and 'x.example,3,"3,00"' in lines[1]
        and '"2,5","3,00"' in lines[3]
    )
    closed = "mistaken" in said.partition("allows no change")[2]
    assert ('x.example,,"3,00"' in lines[2] and closed) == bool(may)
    (tmp_path / "people.csv").write_text(f"{number},{email},Nachname,Prénom\n7,r@x,Lee,Ada\n")
    assert Roster(tmp_path / "people.csv").people["7"].called == {
        "own": ("7",),
        "email": ("r@x",),
        "name": ("Ada Lee",),
    }
    roster = Roster(tmp_path / "book.csv")
    assert (
        roster.find((("moodle", "1"),))[0] == roster.find((("own", "r@x.example"),))[0] == "right"
    )


def test_columns_of_a_language_that_is_not_known_can_be_named(marks, tmp_path):
    text = "Tunniste,Koko nimi,Numero,Arvosana,Paras\nOsallistuja9,A,right,,6\nbroken,B,,,6\n"
    with pytest.raises(
        gradebooks.CannotExport, match=r"German, .*\[gradebook\], and below it identifier = "
    ) as caught:
        fill(tmp_path, marks, text)
    assert "This file has the columns Tunniste, Koko nimi" in str(caught.value)
    names = {
        "identifier": "Tunniste",
        "full name": "Koko nimi",
        "id number": "Numero",
        "grade": "Arvosana",
    }
    marks = gradebooks.Marks(marks.store, term=replace(marks.term, gradebook=names))
    assert fill(tmp_path, marks, text)[1][1:] == ["Osallistuja9,A,right,6,6", "broken,B,,5,6"]
    with pytest.raises(gradebooks.CannotExport, match="no column 'Note'"):
        marks.term = replace(marks.term, gradebook={"grade": "Note"})
        fill(tmp_path, marks, text)


def test_a_gradebook_of_canvas_with_names_in_two_columns_and_other_numbers(marks, tmp_path):
    """Its columns are always in English, while its numbers follow the language."""
    text = (
        "\ufeffLastName;FirstName;ID;SIS Login ID;Section;Turns (7)\n"
        "    Points Possible;;;;;12,00\n"
        "A;Right;1;right;x;\nB;Broken;2;broken;x;\nC;Excused;3;mistaken;x;N/A\n"
    )
    said, lines = fill(tmp_path, marks, text)
    assert lines[2:] == [
        "A;Right;1;right;x;12",
        "B;Broken;2;broken;x;10",
        "C;Excused;3;mistaken;x;N/A",
    ]
    assert "mistaken: N/A, and graded 8" in said
    # A spreadsheet may have dropped the decimals, or separated the thousands.
    for saved, written in (
        (text.replace("12,00", "3,00"), ";2,5"),
        (text.replace("12,00", "3"), ";2,5"),
        (text.replace("12,00", "1.000,00"), ";833,33"),
        (text.replace(";", ",").replace("12,00", '"1,000.00"'), ",833.33"),
    ):
        assert fill(tmp_path, marks, saved)[1][3].endswith(written)
    roster = Roster(tmp_path / "book.csv")
    assert roster.find((("canvas", "2"),)) == ("broken", "Canvas's number")
    assert roster.find((("name", "Right A"),))[0] == "right"


@pytest.mark.parametrize(
    "data",
    [
        CANVAS.encode("utf-16"),
        CANVAS.replace("Nobody", "N\xf3body’s").encode("cp1252") + b"\x81",
        CANVAS.encode(),
        b"\xef\xbb\xbf" + CANVAS.encode(),
    ],
)
def test_a_gradebook_that_is_not_changed_is_the_same_bytes(tmp_path, data):
    (tmp_path / "book.csv").write_bytes(data)
    assert bytes(gradebooks.Gradebook(tmp_path / "book.csv")) == data


def test_two_of_one_name_are_not_filled_in(marks, tmp_path):
    text = (
        'Student,ID,SIS User ID,SIS Login ID,Section,Turns (77)\n"A",1,,right,,\n"B",2,,right,,\n'
    )
    said, lines = fill(tmp_path, marks, text)
    assert "right" in said.partition("ambiguous")[2] and lines == text.splitlines()


@pytest.mark.parametrize(
    "header, message",
    [
        ("Name,Points\nA,1\n", "not a gradebook from Moodle"),
        (
            "Student,ID,SIS User ID,SIS Login ID,Section,Turns (1),Axes (2)\nA,1,,,,,\n",
            "'Turns (1)', 'Axes (2)'",
        ),
        ("Student,ID\n", "book.csv has no students"),
    ],
)
def test_a_gradebook_that_cannot_be_filled_is_said(marks, tmp_path, header, message):
    with pytest.raises(gradebooks.CannotExport) as error:
        fill(tmp_path, marks, header)
    assert message in str(error.value)


# ---- from a system's download to what it accepts

#: Names of a notebook that a student may have chosen, which each system keeps at the end of its
#: own.
CHOSEN = ("turns.ipynb", "my_2_turns_linked.ipynb", "work.zip")


def download(system, students):
    """Return a system's download: the archive's files by name, and the gradebook."""
    files, lines = {}, []
    for number, (student, data) in enumerate(students, 101):
        chosen = CHOSEN[number % 3]
        data = packed("homework/turns.ipynb", data=data) if chosen.endswith("zip") else data
        name = f"Ann {student.title()}"
        if system == "canvas":
            late = "LATE_" if number % 2 else ""
            files[f"{student}ann_{late}{number}_{number + 5000}_{chosen}"] = data
            lines.append(f'"{student.title()}, Ann",{number},{student},Section 1,,')
        elif system == "moodle":
            files[f"{name}_{number}_assignsubmission_file/{chosen}"] = data
            lines.append(
                f'"Participant {number}","{name}",{student}@uni.example,Submitted,,6.00,Yes'
            )
        else:
            files[f"{number}-4711 - {name} - Nov 21, 2026 801 PM/{chosen}"] = data
            lines.append(f"#{student},{name.split()[1]},Ann,,#")
    header = {
        "canvas": "Student,ID,SIS Login ID,Section,Homework (17),Final Score\n"
        "    Points Possible,,,,6,(read only)",
        "moodle": 'Identifier,"Full name","Email address",Status,Grade,"Maximum grade","Grade can '
        'be changed"',
        "brightspace": "OrgDefinedId,Last Name,First Name,Homework Points Grade <Numeric "
        "MaxPoints:6>,"
        "End-of-Line Indicator",
    }[system]
    return files, "\n".join([header, *lines, ""])


def canvas_takes(name, uploads):
    """Return a file's student, like Canvas's ``infer_comment_context_from_filename``."""
    parts = name.rpartition("/")[2].split("_")
    numbers = [part for part in parts if re.fullmatch("[0-9]+", part)][:2]
    return (
        None
        if len(numbers) < 2 or parts[-1].startswith("link") or name.startswith("._")
        else uploads.get(tuple(map(int, numbers)))
    )


def moodle_takes(name, participants):
    """Return a file's student, like Moodle's ``is_valid_filename_for_import``."""
    if name.rpartition("/")[2].startswith((".", "~")):
        return None
    for part in name.split("/"):
        parts = part.split("_", 4)
        if len(parts) >= 4 and parts[1].isdigit() and int(parts[1]) in participants:
            return (
                participants[int(parts[1])] if parts[2:4] == ["assignsubmission", "file"] else None
            )
    return None


@pytest.mark.sampled(1)
@pytest.mark.parametrize("system", ["canvas", "moodle", "brightspace"])
@pytest.mark.parametrize("around", ["", "Homework 1_2/"])
def test_from_a_systems_download_to_what_it_takes_back_in_three_commands(
    course, tmp_path, capsys, system, around
):
    solutions = str(course / "solutions")
    students = {
        "right": handed_in(),
        "mistaken": handed_in(sum="sine = -sm.sin(alpha + beta)"),
        "blank": handed_in(sum="sine = ..."),
        "nearly": handed_in(sum="sine = sm.sin(alpha + beta)*1.0004"),
    }
    files, gradebook = download(
        system, [(name, nbformat.writes(made).encode()) for name, made in students.items()]
    )
    with zipfile.ZipFile(tmp_path / "submissions.zip", "w") as archive:
        for name, data in files.items():
            archive.writestr(around + name, data)
    (tmp_path / "gradebook.csv").write_text(gradebook)
    out, feedback = str(tmp_path / "out"), tmp_path / "feedback.zip"
    shutil.copytree(course / "out" / "questions", tmp_path / "out" / "questions")
    write_term(tmp_path / "out", tmp_path / "gradebook.csv", {"turns": ["turns"]})
    main(
        [
            "grade",
            str(tmp_path / "submissions.zip"),
            "--out",
            out,
        ]
        + ["--solutions", solutions]
    )
    (waiting,) = rows_of(tmp_path / "out" / "undecided.csv")
    Journal(tmp_path / "out").add(Store(out).read(waiting["student"], "turns"), "turns/sum", 0.5)
    main(["regrade", out, "--solutions", solutions])
    for _ in range(2):
        main(["export", out, "--lms", str(tmp_path / "gradebook.csv"), "--feedback", str(feedback)])
        data = feedback.read_bytes()
    assert "4 marks filled in" in capsys.readouterr().out
    filled = (tmp_path / "gradebook-filled.csv").read_text()
    points = {"right": "6", "mistaken": "5", "blank": "5", "nearly": "5.5"}
    for student, earned in points.items():
        (line,) = (line for line in filled.splitlines() if student in line.lower())
        assert earned in line.split(","), line
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        pages_of = {name: archive.read(name).decode() for name in archive.namelist()}
    assert len(pages_of) == 4
    numbered = dict(zip(range(101, 105), students))
    for name, page in pages_of.items():
        if system == "canvas":
            student = canvas_takes(
                name, {(number, number + 5000): who for number, who in numbered.items()}
            )
        elif system == "moodle":
            student = moodle_takes(name, numbered)
        else:
            # Brightspace needs the folder as it was handed out, at the top.
            assert name.count("/") == 1 and any(
                file.startswith(name.partition("/")[0] + "/") for file in files
            )
            student = numbered[int(name.partition("-")[0])]
        assert f"{points[student]} of 6 points" in page, name
    shutil.rmtree(tmp_path / "out" / "feedback")
    with pytest.raises(SystemExit, match="no feedback for"):
        main(["export", out, "--feedback", str(feedback)])
    assert feedback.read_bytes() == data and not list(tmp_path.glob(".half*"))


def test_for_nbgrader_and_gradescope(course, tmp_path, capsys):
    out = str(course / "out")
    main(["export", out, "--nbgrader", str(tmp_path / "grades.csv")])
    rows = {row["student_id"]: row for row in rows_of(tmp_path / "grades.csv")}
    assert list(rows["right"]) == list(gradebooks.NBGRADER)
    mistaken = rows["mistaken"]
    assert [mistaken[name] for name in ("assignment", "score", "max_score")] == ["turns", "4", "6"]
    gradebooks.write_gradescope(tmp_path / "results.json", gradebooks.Marks(Store(out)), "mistaken")
    results = json.loads((tmp_path / "results.json").read_text())
    assert results["score"] == 4 and [test["score"] for test in results["tests"]] == [1, 0, 3]
    assert (
        results["tests"][0]["max_score"] == 2 and "the transpose" in results["tests"][0]["output"]
    )
    with pytest.raises(SystemExit, match="choose --lms"):
        main(["export", out])


# ---- the sample class, and the commands


def test_the_sample_class_gets_what_was_put_into_it(tmp_path, capsys, course, monkeypatch):
    # One of its cells never ends, and the usual limits allow that for twenty seconds.
    monkeypatch.setattr("coursework.grading.execution.isolation.Limits", lambda: LIMITS)
    solutions = str(course / "solutions")
    for name in ("class", "again"):
        make_class(tmp_path / name, 88, 3, ["turns", "axes"], solutions)
    assert contents(tmp_path / "again") == contents(tmp_path / "class")
    expected = json.loads((tmp_path / "class" / "expected.json").read_text())
    assert {about["did"] for about in expected.values()} >= {*HOSTILE, *BROKEN}
    for student in [student for student, about in expected.items() if not about["did"]][20:]:
        shutil.rmtree(tmp_path / "class" / "submissions" / student)
        del expected[student]
    write_term(tmp_path / "out", assignments={"homework": ["turns", "axes"]})
    main(
        [
            "grade",
            str(tmp_path / "class" / "submissions"),
            "--out",
            str(tmp_path / "out"),
            "--solutions",
            solutions,
        ]
    )
    said = capsys.readouterr()
    assert "report.html" in said.out and "Isolation: " in said.err
    store, compared = Store(tmp_path / "out"), 0
    for student, about in expected.items():
        graded = store.read(student, "homework")
        refused = about["did"] in BROKEN
        assert (graded is None) == refused, about["did"]
        for name, (outcome, note) in ({} if refused else about["questions"]).items():
            mark = graded.marks[name]
            if about["did"] in HOSTILE:
                # It may have spoilt its own answers, but gained nothing.
                assert not mark.points or outcome != "not attempted"
            else:
                assert mark.outcome == outcome and (not note or mark.note == note), (
                    student,
                    about["did"],
                    name,
                )
                compared += 1
    assert compared >= 100
    main(["regrade", str(tmp_path / "out"), "--solutions", solutions])
    assert "Marks changed: 0." in capsys.readouterr().out
    main(["export", str(tmp_path / "out"), "--lms", str(tmp_path / "class" / "gradebook.csv")])
    said = capsys.readouterr().out
    assert "student-089" in said or "089, Student" in said


def test_what_is_missing_is_said(course, copied, tmp_path):
    # A renamed assignment in the term is another assignment.
    write_term(copied, assignments={"other": ["turns"]})
    with pytest.raises(NothingToGrade, match="no assignment 'turns'; choose from other"):
        regrade(copied, solutions=course / "solutions")
    with pytest.raises(NothingToGrade, match="no notebook with solutions in"):
        grade(course / "submissions", tmp_path / "out", solutions=tmp_path, show=io.StringIO())
    for assignments, sitting, words in (
        ({"x": ["turn"]}, "", "no notebook with solutions named 'turn'"),
        (
            None,
            '[assignments.x]\nquestions = ["turns/tan"]',
            "no question 'turns/tan'; choose from",
        ),
    ):
        write_term(tmp_path / "out", assignments=assignments, text=sitting)
        with pytest.raises(NothingToGrade, match=words):
            grade(
                course / "submissions",
                tmp_path / "out",
                solutions=course / "solutions",
                show=io.StringIO(),
            )
