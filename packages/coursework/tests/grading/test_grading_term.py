"""A whole course: the cost of lateness, dropped marks, students' pages, and a year's results."""

import datetime
import itertools
import json
import random
import re
import zipfile
from dataclasses import replace
from zoneinfo import ZoneInfo

import pytest
from grading_class import give, grade_quietly, handed_in, put, write_sources, write_term
from nbformat import writes

from coursework.__main__ import main
from coursework.grading.grade import bring_in_decisions
from coursework.grading.judging import term
from coursework.grading.judging.journal import Journal
from coursework.grading.record import Answer, Identity, Mark, Record, RunNotebook
from coursework.grading.reporting.course_pages import write_course
from coursework.grading.reporting.statistics import Correlation
from coursework.grading.store import Store
from coursework.grading.submissions import intake

pytestmark = pytest.mark.usefixtures("libraries_are_loaded_once")

UTC = datetime.UTC
AMSTERDAM = ZoneInfo("Europe/Amsterdam")
RULES = """
name = "Autumn 2026"
time-zone = "Europe/Amsterdam"
[late]
grace-minutes = 15
a-day = 0.1
most = 0.5
nothing-after-days = 7
[assignments.turns]
due = 2026-10-05T23:59:00
weight = 3
[assignments.axes]
due = 2026-10-25T02:30:00
"""


@pytest.fixture
def rules(tmp_path):
    def read(text=RULES, roster=None):
        path = tmp_path / "term.toml"
        path.write_text(f"roster = '{roster}'\n{text}" if roster else text, "utf8")
        return term.read_term(path)

    return read


def record(points, worth=6, when="", late=False, assignment="turns", identity=None):
    notebook = RunNotebook(late=late, handed_in=when)
    marks = {f"{assignment}/sum": Mark("correct", points=points, worth=worth)}
    return Record(
        "ann", assignment, identity=Identity(identity or {}), notebooks=(notebook,), marks=marks
    )


def result(
    rules, *records, student="ann", now=datetime.datetime(2026, 12, 1, tzinfo=UTC), worth=None
):
    worth = worth or {"turns": 6, "axes": 2}
    results, total = term.results_of(
        student, {record.assignment: record for record in records}, rules, worth, now
    )
    return {result.assignment: result for result in results}, total


@pytest.mark.parametrize(
    "when, penalty",
    [
        ("2026-10-05T23:00:00", 0),
        ("2026-10-06T00:14:00", 0),  # Within the grace period.
        ("2026-10-06T00:14:01", 0.1),
        ("2026-10-06T23:59:00", 0.1),
        ("2026-10-06T23:59:01", 0.2),
        ("2026-10-12T23:59:00", 0.5),
        ("2026-10-12T23:59:01", 1),
        ("2026-10-05T21:59:00+00:00", 0),  # The same moment, by another clock.
        ("2026-10-05T22:14:01+00:00", 0.1),
        ("", 0),  # Nobody knows.
    ],
)
def test_lateness_costs_what_the_rules_say(rules, when, penalty):
    results, _ = result(rules(), record(6, when=when))
    assert results["turns"].penalty == pytest.approx(penalty) and results["turns"].late == bool(
        penalty
    )
    assert results["turns"].counts == pytest.approx(6 * (1 - penalty))


@pytest.mark.parametrize(
    "due, when, penalty",
    [
        # One day later by the clock, which is 25 hours in autumn and 23 in spring.
        ("2026-10-24T23:59:00", "2026-10-25T23:59:00", 0.1),
        ("2026-10-24T23:59:00", "2026-10-25T22:59:00+00:00", 0.1),
        ("2026-10-24T23:59:00", "2026-10-25T23:00:00+00:00", 0.2),
        ("2027-03-27T23:59:00", "2027-03-28T23:59:00", 0.1),
        ("2027-03-27T23:59:00", "2027-03-28T21:59:00+00:00", 0.1),
        # Ten minutes later, although the clocks have moved an hour forward, is within the grace
        # period.
        ("2027-03-28T01:55:00", "2027-03-28T03:05:00", 0),
        ("2027-03-28T01:55:00", "2027-03-28T01:05:00+00:00", 0),
        # The due date is a time that no clock shows.
        ("2027-03-28T02:30:00", "2027-03-28T03:30:00", 0),
        ("2027-03-28T02:30:00", "2027-03-28T03:50:00", 0.1),
        # On the night of 25 October, half past two comes twice, at 0:30 and 1:30 UTC. A due date
        # is then the later, and a time without a zone the earlier, to favour students.
        ("2026-10-25T02:30:00", "2026-10-25T01:30:00+00:00", 0),
        ("2026-10-25T02:30:00", "2026-10-25T01:45:01+00:00", 0.1),
        ("2026-10-25T02:10:00", "2026-10-25T02:45:00", 0),
        ("2026-10-25T02:10:00", "2026-10-25T02:45:00+02:00", 0),
    ],
)
def test_days_and_hours_are_as_long_as_any_other_when_clocks_are_changed(rules, due, when, penalty):
    results, _ = result(
        rules(RULES.replace("2026-10-25T02:30:00", due)), record(2, 2, when, assignment="axes")
    )
    assert results["axes"].penalty == pytest.approx(penalty) and results["axes"].late == bool(
        penalty
    )


def test_what_is_missing_counts_once_it_is_due(rules):
    half = record(3)
    assert result(rules(), half, now=datetime.datetime(2026, 10, 25, 1, 0, tzinfo=UTC))[1] == 0.5
    results, total = result(rules(), half)
    assert results["axes"].state == "missing" and total == pytest.approx(0.5 * 3 / 4)
    # Exercises that are worth nothing do not count, although they were graded.
    assert result(rules(), half, record(0, 0, assignment="axes"))[1] == 0.5
    # An assignment that was never graded counts for nobody.
    assert result(rules(), half, worth={"turns": 6})[0]["axes"].state == "not due"


@pytest.mark.parametrize(
    "text, when",
    [
        (RULES, ""),
        # There is nothing to compare the time with.
        (RULES.replace("due = 2026-10-05T23:59:00\n", ""), "2026-10-05T12:00:00"),
    ],
)
def test_a_systems_word_alone_costs_nothing_and_is_said(rules, text, when):
    results, _ = result(rules(text), record(6, when=when, late=True))
    assert results["turns"].late and results["turns"].penalty == 0


def test_a_sitting_limits_what_homework_counts_in_the_course(rules):
    results, _ = result(
        rules(RULES + '[assignments.quiz]\nquestions = ["turns/sum"]\nhomework-cap = 0.25\n'),
        record(6),
        replace(
            record(3, assignment="quiz"), marks={"turns/sum": Mark("decided", points=3, worth=6)}
        ),
    )
    assert results["turns"].counts == 4.5


def test_what_is_dropped_is_best_for_the_student(rules):
    dice = random.Random(7)
    for _ in range(200):
        names = [f"a{number}" for number in range(dice.randint(2, 6))]
        first = dice.randint(1, len(names))
        parts = [part for part in (names[:first], names[first:]) if part]
        drops = [(dice.randint(0, len(part) - 1), part) for part in parts]
        weights = {name: dice.choice([1, 1, 2, 5, 0.5]) for name in names}
        text = 'time-zone = "UTC"\n' + "".join(
            f"[[drop]]\nlowest = {n}\nof = {json.dumps(of)}\n" for n, of in drops
        )
        text += "".join(
            f"[assignments.{name}]\nweight = {weight}\n" for name, weight in weights.items()
        )
        shares = {name: dice.choice([0, 0.25, 0.5, 0.5, 0.9, 1]) for name in names}
        records = [record(share * 8, 8, assignment=name) for name, share in shares.items()]
        results, total = result(rules(text), *records, worth=dict.fromkeys(names, 8))
        best = max(
            sum(weights[name] * shares[name] for name in kept) / sum(weights[name] for name in kept)
            for out in itertools.product(*(itertools.combinations(of, n) for n, of in drops))
            for kept in [set(names) - set(itertools.chain(*out))]
        )
        assert total == pytest.approx(best)
        assert sum(result.state == "dropped" for result in results.values()) == sum(
            n for n, _ in drops
        )


@pytest.mark.parametrize(
    "before, after, says",
    [
        ("time-zone", "timezone", "unknown key 'timezone'"),
        ("Europe/Amsterdam", "Europe/Nowhere", "line 3: there is no time zone 'Europe/Nowhere'"),
        ("grace-minutes = 15", "grace = 15", "unknown key 'grace' in late"),
        ("a-day = 0.1", "a-day = 10", "late.a-day must be a number from 0 to 1, not 10"),
        ("due = 2026-10-05T23:59:00", "due = 2026-10-05", "a date with a time.*2026-10-05"),
        ("due = 2026-10-05T23:59:00", "due = '5 October'", "a date with a time"),
        ("due = 2026-10-05T23:59:00", "due = 2026-10-05 23:59", "a date as 2026-10-05T23:59:00"),
        ("weight = 3", "wieght = 3", "unknown key 'wieght' in assignments.turns"),
        (
            "[late]",
            "[extensions.ann]\ntruns = 'excused'\n[late]",
            "unknown key 'truns' in ext",
        ),
        ("[late]", "[[drop]]\nof = ['turns']\n[late]", "a whole number below 1"),
        ("[late]", "[[drop]]\n[[drop]]\n[late]", "in two .*rules"),
        (
            "[late]",
            "[[drop]]\nof = 'turns'\n[late]",
            "drop.of must be a list, not 'turns'",
        ),
        ("[late]", "[drop]\nof = ['turns']\n[late]", "drop must be a list of tables"),
        (
            "weight = 3",
            "times = 3",
            "assignments.turns.times must be a string, not 3",
        ),
        ('"Europe/Amsterdam"', "Europe", "line 3"),
        ("[assignments.turns]", "[assignments.Week 1]", "name with a space in quotation marks"),
        ('"Europe/Amsterdam"', r'"C:\Users"', "Write / in paths, not a backslash"),
        # Windows' editor may put a byte order mark first.
        ('\nname = "Autumn 2026"', "\ufeffnaem = 'Autumn'", "line 1: unknown key 'naem'"),
    ],
)
def test_a_rule_that_is_misspelt_is_said(rules, before, after, says):
    assert before in RULES
    with pytest.raises(term.BadTerm, match=says):
        rules(RULES.replace(before, after, 1))


def test_times_of_a_systems_table(rules, tmp_path):
    (tmp_path / "worksheet.csv").write_text(
        "Identifier,Full name,Email address,Last modified (submission)\n"
        'Participant 101,Ann Lee,ann@example.org,"Tuesday, 6 October 2026, 8:01 PM"\n'
        "Participant 102,Bob Lee,bob@example.org,-\n"
    )
    text = RULES.replace("weight = 3", 'weight = 3\ntimes = "worksheet.csv"')
    for identity in ({"name": "Ann Lee"}, {"email": "ann@example.org"}):
        results, _ = result(rules(text), record(6, identity=identity))
        assert results["turns"].handed_in == datetime.datetime(2026, 10, 6, 20, 1, tzinfo=AMSTERDAM)
        assert results["turns"].penalty == pytest.approx(0.1)
    assert (
        result(rules(text), record(6, identity={"name": "Bob Lee"}))[0]["turns"].handed_in is None
    )
    for table, why in (
        ("username,timestamp\nann,yesterday\n", "'ann': 'yesterday' is not a time.* to English"),
        # We guess neither the day nor the month.
        ("username,timestamp\nann,1/2/2026 10:00\n", "'1/2/2026 10:00' is not a time"),
        ("username,when\nann,yesterday\n", "no column gives the time"),
    ):
        (tmp_path / "worksheet.csv").write_text(table)
        with pytest.raises(term.BadTerm, match=why):
            rules(text)


GOOD = writes(handed_in()).encode()


def test_times_are_those_of_the_system_and_no_students(tmp_path):
    def times(*files):
        path = tmp_path / "class.zip"
        with zipfile.ZipFile(path, "w") as box:
            for name, data in files:
                box.writestr(name, data)
        return {
            notebook.student: notebook.handed_in for notebook in intake.take_in(path, ["turns"])[0]
        }

    stamp = b"2026-10-05 20:01:00.250000 UTC\n"
    assert times(
        ("submitted/ann/turns/turns.ipynb", GOOD),
        ("submitted/ann/turns/timestamp.txt", stamp),
        # A deeper file is the student's own; another is unreadable.
        ("submitted/bob/turns/more/turns.ipynb", GOOD),
        ("submitted/bob/turns/more/timestamp.txt", stamp),
        ("submitted/carl/turns/turns.ipynb", GOOD),
        ("submitted/carl/turns/timestamp.txt", b"\xff\xfe long ago"),
    ) == {"ann": "2026-10-05T20:01:00.250000+00:00", "bob": "", "carl": ""}
    assert times(
        ("ann/turns.ipynb", GOOD), ("ann/timestamp.txt", stamp), ("bob/turns.ipynb", GOOD)
    ) == {
        "ann": "",
        "bob": "",
    }
    name = "101-9 - {} - Nov 21, 2026 801 PM/turns.ipynb"
    assert times(
        (name.format("Ann"), GOOD),
        (name.format("X - Nov 1, 2026 801 AM").replace("101", "102"), GOOD),
    ) == {
        "Ann 101": "2026-11-21T20:01:00",
        "X - Nov 1, 2026 801 AM 102": "2026-11-21T20:01:00",
    }
    assert times(("HW_ann_attempt_2026-11-21-20-01-00_turns.ipynb", GOOD)) == {
        "HW_ann": "2026-11-21T20:01:00"
    }
    assert times(("HW_ann_attempt_2026-13-41-20-01-00_turns.ipynb", GOOD)) == {"HW_ann": ""}


# --- statistics ---------------------------------------------------------------------------------


def test_a_correlation_needs_enough_students_who_differ():
    dice = random.Random(5)
    pairs = [(x, x + dice.gauss(0, 1)) for x in (dice.random() for _ in range(40))]
    correlation = Correlation.of(pairs)
    # Fisher's interval: atanh(value) ± 1.96/sqrt(37).
    assert (correlation.low, correlation.value, correlation.high) == pytest.approx(
        (-0.1099, 0.2087, 0.4885), abs=1e-4
    )
    assert Correlation.of(pairs[:9]) is None
    assert Correlation.of([(1, y) for _, y in pairs]) is None


# --- the pages ----------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    """A small graded class, whose notebooks nbgrader collected."""
    folder = tmp_path_factory.mktemp("course")
    submitted = folder / "course" / "submitted"
    answers = {
        "ann": {},
        "bob": {"sum": "sine = sm.sin(alpha)"},
        "carl": {"sum": "sine = sm.sin(alpha)"},
    }
    for student, given in answers.items():
        put(submitted / student, "turns", handed_in(**given))
        (submitted / student / "turns" / "timestamp.txt").write_text(
            "2026-10-06 20:01:00.000000 UTC"
        )
    put(
        submitted / "ann",
        "axes",
        handed_in("axes", also=["assert '<script>alert(1)</script>'"]),
        "axes.ipynb",
    )
    (folder / "roster.csv").write_text("student\nann\nbob\ncarl\ndora\n")
    write_term(folder / "out", folder / "roster.csv")
    grade_quietly(folder / "course", folder / "out", write_sources(folder / "solutions"))
    return folder / "out"


def test_a_course_comes_to_a_page_for_each_student_and_a_table(out, rules):
    now = datetime.datetime(2026, 12, 1, tzinfo=UTC)
    said = write_course(Store(out), rules(roster=out.parent / "roster.csv"), now=now)
    assert said == [
        "axes: 1 notebook came in at an unknown time, so lateness cost them nothing. Give a "
        "table of times from your system: "
        'times = "worksheet.csv" in [assignments.axes].'
    ]
    rows = (out / "course" / "course.csv").read_text().splitlines()
    assert [row.split(",")[:2] for row in rows[1:]] == [
        ['"ann"', '"92.5"'],  # (3 0.9 + 1)/4
        ['"bob"', '"56.25"'],  # 3 0.9 5/6 / 4
        ['"carl"', '"56.25"'],
        ['"dora"', '"0"'],
    ]
    page = (out / "course" / "students" / "bob.html").read_text()
    assert "10 % less" in page and "nothing was handed in" in page and "56.2 %" in page
    assert all(
        (out / "course" / "students" / link).exists()
        for link in re.findall(r'href="([^"]+)"', page)
    )
    # Changes by hand are kept, and a message says where.
    (out / "course" / "course.csv").write_text("changed")
    said = write_course(Store(out), rules(roster=out.parent / "roster.csv"), now=now)
    assert [
        (kept.read_text(), str(kept) in said[-1]) for kept in out.glob("course/*-changed-*")
    ] == [("changed", True)]
    # Marks stay in the table when a student leaves the roster, and a message says so.
    (out.parent / "later.csv").write_text("student\nann\nbob\ndora\n")
    said = write_course(Store(out), rules(roster=out.parent / "later.csv"), now=now)
    assert (
        "carl has marks but is not in the roster." in said[0]
        and "records/carl to" in said[0]
        and ((out / "course" / "course.csv").read_text().splitlines() == rows)
    )


def test_every_number_leads_to_the_answers_behind_it(out, rules):
    write_course(Store(out), rules())
    numbers = (out / "course" / "statistics.html").read_text()
    # One of three earned the points of the sum.
    assert numbers.count('href="') >= 10 and "33 %" in numbers
    for link in re.findall(r'href="([^"]+)"', numbers):
        place, _, anchor = link.partition("#")
        page = out / "course" / place
        content = page.read_text()
        assert not anchor or f'id="{anchor}"' in content, link
        assert all(
            (page.parent / inner).exists() for inner in re.findall(r'href="([^"#]+)"', content)
        )
    assert "<math" in "".join(
        path.read_text() for path in (out / "course" / "answers").glob("*turns-sum*.html")
    )


def test_names_and_answers_stay_text(rules, tmp_path):
    name = '<img src=x onerror="alert(1)">'
    store = Store(tmp_path / "out")
    mark = Mark("wrong", worth=1, version="1", title=name)
    script = {"value": ["text", "</code><script>alert(2)</script>"], "nodes": []}
    give(
        store,
        replace(
            record(0, 1),
            student=name,
            marks={"turns/sum": mark},
            answers={"turns/sum": Answer("recorded", script)},
        ),
    )
    write_course(store, rules())
    pages = [path.read_text() for path in (tmp_path / "out" / "course").rglob("*.html")]
    assert all("default-src 'none'" in page for page in pages)
    assert "&lt;img" in "".join(pages) and not re.search("<img|<script", "".join(pages))


# --- the system's gradebook ---------------------------------------------------------------------

BOOK = (
    "Student,ID,SIS User ID,SIS Login ID,Section,Turns (77)\nA,1,,ann,,\nB,2,,bob,,\nC,3,,carl,,\n"
)


@pytest.fixture
def late(tmp_path):
    """The results of three students, one of them two days late and another excused."""
    store = Store(tmp_path / "out")
    for student, when, marked in (
        ("ann", "2026-10-07T12:00:00", False), ("bob", "2026-10-05T12:00:00", False),
        ("carl", "", False)
    ):  # fmt: skip
        graded = record(6, when=when, late=marked)
        mark = Mark("correct", points=6, worth=6, version="v", title="the sum")
        give(store, replace(graded, student=student, marks={"turns/sum": mark}))
    (store.folder / "term.toml").write_text(RULES + "[extensions.bob]\nturns = 'excused'\n")
    (tmp_path / "book.csv").write_text(BOOK)
    return store


def filled(store, *more):
    arguments = ["export", str(store.folder), "--lms", str(store.folder.parent / "book.csv"), *more]
    assert main(arguments) in (None, 0)
    lines = (store.folder.parent / "book-filled.csv").read_text().splitlines()[1:]
    return [line.rpartition(",")[2] for line in lines]


def test_the_rules_of_the_term_reach_the_system(late, tmp_path, capsys):
    """The term once gave 68.57 % and "excused", while the gradebook was filled with 18 and 21."""
    rules = late.folder / "term.toml"
    text = rules.read_text()
    rules.unlink()
    assert filled(late) == ["6", "6", "6"]  # There are no rules yet.
    rules.write_text(text)
    assert filled(late) == ["4.8", "", "6"]
    said = capsys.readouterr().out
    assert (
        "Not filled in, because excused in term.toml" in said
        and "1 notebook came in at an unknown time" in said
    )
    main(["export", str(late.folder), "--nbgrader", str(tmp_path / "n.csv")])
    assert '"6","1.2","4.8"' in (tmp_path / "n.csv").read_text()


def test_a_decision_is_handed_on_once_it_is_in_the_marks(late, tmp_path, capsys):
    (late.folder / "term.toml").unlink()
    Journal(late.folder).add(late.read("ann", "turns"), "turns/sum", 0.5, who="Ann")
    assert filled(late)[0] == "6" and "are not in the marks yet" in capsys.readouterr().out
    with pytest.raises(SystemExit, match="Decisions about 1 record are not in the pages yet"):
        main(["export", str(late.folder), "--feedback", str(tmp_path / "pages.zip")])
    bring_in_decisions(late.folder)
    assert filled(late)[0] == "3"


def test_what_a_system_marks_as_late_costs_what_the_rules_say(late, capsys):
    """Canvas marks a file as late without a time, which once cost nothing."""
    give(late, replace(late.read("carl", "turns"), notebooks=(RunNotebook(late=True),)))
    rules = late.folder / "term.toml"
    for command in (filled, lambda late: main(["term", str(late.folder)])):
        with pytest.raises(SystemExit, match="1 submission of .* as late.*marked = 0.1"):
            command(late)
    rules.write_text(rules.read_text().replace("a-day = 0.1", "a-day = 0.1\nmarked = 0.25"))
    assert filled(late) == ["4.8", "", "4.5"] and "unknown time" not in capsys.readouterr().out


def test_marks_are_handed_on_as_of_a_date(late):
    path = late.folder / "journal.jsonl"
    (ann,) = [event for event in Journal(late.folder).events if event.student == "ann"]
    path.unlink()
    days = (("2026-10-01", 6), ("2026-10-20", 3), ("2026-12-20", 5))
    Journal(late.folder).append(
        replace(ann, id=day, when=f"{day}T12:00:00.000000+00:00", points=points)
        for day, points in days
    )
    (late.folder / "term.toml").unlink()
    for day, points in (("2026-10-19", "6"), ("2026-10-21", "3"), ("2026-12-24", "5")):
        assert filled(late, "--as-of", day)[0] == points
