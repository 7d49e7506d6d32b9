"""A student hands in several times, or by an archive whose variants the source has no more."""

import hashlib

import nbformat
import pytest
from course_by_commands import Course, notebook

pytestmark = pytest.mark.usefixtures("libraries_are_loaded_once")
TERM = """
time-zone = "UTC"
roster = "../roster.csv"
attempts = "best"
[late]
a-day = 0.2
[assignments.hw1]
due = 2025-10-05T23:59:00
"""


@pytest.fixture
def course(tmp_path):
    course = Course(tmp_path, hw1={"sum": (5, 4), "arm": (2, 4), "why": ("By the arm.", 2)})
    (tmp_path / "roster.csv").write_text("student,name\nada,Ada Lee\nben,Ben Lee\n")
    course.marks.mkdir()
    (course.marks / "term.toml").write_text(TERM)
    return course


EARLY, LATER, LATE = (
    f"101-7 - Ada Lee - Oct {day}, 2025 1000 AM" for day in (1, 5, 6)
)  # Brightspace's names


def test_the_best_attempt_counts_and_everybody_is_told(course):
    course.hands_in(EARLY, "hw1", why=None)
    course.grade()
    assert course.points() == {"ada": 8}
    # First a worse attempt, then a late but correct one, worth 8 of 10.
    course.hands_in(LATER, "hw1", arm=3, why=None)
    said = course.grade()
    assert "DOES NOT COUNT: unless it is the best of 2 attempts" in said
    assert course.points() == {"ada": 8}
    said = course.run("why", "ada", "hw1")
    assert f"  counts: {EARLY}/hw1.ipynb" in said
    assert (
        f"does not count: {LATER}/hw1.ipynb, since it comes to 4 points, and another to 8" in said
    )
    page = (course.marks / "feedback" / "ada" / "hw1.html").read_text()
    assert "was not counted: it comes to 4 points, and another to 8" in page
    assert "handed in more than once" in (course.marks / "report.html").read_text()
    # Nothing is run a second time.
    assert "2 of them graded before" in course.grade()


def test_another_attempt_may_be_the_best_once_a_question_was_mended(course):
    course.hands_in(EARLY, "hw1", why=None)
    course.hands_in(LATER, "hw1", arm=3, why=None)
    course.grade()
    course.change("hw1", sum=(6, 4), arm=(3, 4))
    said = course.regrade(fails=True)
    assert "'ada', hw1: 8 -> 4  (hw1/sum; another attempt is now the best)" in said
    assert course.points() == {"ada": 8}
    course.regrade("--yes")
    assert course.points() == {"ada": 4}
    assert f"  counts: {LATER}/hw1.ipynb" in course.run("why", "ada", "hw1")
    assert "Marks changed: 0." in course.regrade()
    assert "2 of them graded before" in course.grade()


def test_an_attempt_that_may_yet_be_the_best_is_judged_by_a_person(course):
    course.hands_in(EARLY, "hw1", arm=3, why="The sum of the moments.")
    course.hands_in(LATER, "hw1", why=None, sum=4)
    course.grade()
    (line,) = course.table("undecided.csv")
    assert line["question"] == "hw1/why" and course.points() == {"ada": 4}
    path = course.write_table("decided.csv", [{**line, "credit": "1"}])
    course.run("merge", "marks", path, "--grader", "Ann")
    assert course.points() == {"ada": 6}


def test_lateness_is_part_of_what_an_attempt_comes_to(course):
    course.hands_in(EARLY, "hw1", arm=3, why=None)
    course.hands_in(LATE, "hw1", why=None)
    course.grade()
    # 8 points less a fifth are more than 4.
    assert course.points() == {"ada": 8}
    said = course.run("why", "ada", "hw1")
    assert "late: 20 % lost" in said and "it comes to 4 points, and another to 6.4" in said


def test_the_page_of_moves_is_there_when_it_is_named(course):
    course.hands_in(EARLY, "hw1", why=None)
    course.grade()
    course.change("hw1", sum=(6, 4))
    (line,) = [
        line for line in course.grade(fails=True).splitlines() if line.startswith("Details: ")
    ]
    page = (course.place / line.removeprefix("Details: ")).read_text()
    assert "Who would lose" in page and "ada" in page


# --- variants -------------------------------------------------------------------------------------

WEIGHTS = [12, 25, 31, 44]


def write_beam(course, weights):
    cells = [
        "from coursework import check, student, variant\nstudent('')",
        f"### BEGIN VARIANTS\nbeam = draw('hw1/load', count={len(weights)}, weight={weights})\n"
        "### END VARIANTS",
        "#!A beam carries {{weight}} N twice. Give the whole load.",
        "### BEGIN SOLUTION\nload = 2*beam.weight\n### END SOLUTION",
        "check('hw1/load', load)\n### BEGIN HIDDEN TESTS\nquestion('hw1/load', kind='expression', "
        "worth=4)\n### END HIDDEN TESTS",
    ]
    nbformat.write(notebook(*cells), course.solutions / "hw1.ipynb")


def number_of(student, count):
    """The rule, written down a second time."""
    digest = hashlib.sha256(f"\nhw1/load\n{student}".encode()).digest()
    return int.from_bytes(digest[:8], "big") % count


def weights_in_order(weights):
    from coursework.authoring.variation import Rule

    rule = Rule("hw1/load", len(weights), {"weight": weights})
    return [rule.parameters(number)["weight"] for number in range(len(weights))]


def hands_in_beam(course, student, weight, shows):
    made = notebook("from coursework import check, student, variant\nstudent('')", "beam", "")
    made.cells[2].source = f"load = {2 * weight}\ncheck('hw1/load', load)"
    if shows:
        text = f"A beam carries {weight} N twice. Give the whole load."
        made.cells[1].outputs = [
            nbformat.v4.new_output("display_data", {"text/markdown": text, "text/plain": text})
        ]
    path = course.handed_in / student / "hw1.ipynb"
    path.parent.mkdir()
    nbformat.write(made, path)


def test_a_variant_is_taken_out_before_a_late_notebook_comes(tmp_path):
    course = Course(tmp_path, hw1={"load": (1, 4)})
    write_beam(course, WEIGHTS)
    before, after = weights_in_order(WEIGHTS), weights_in_order(WEIGHTS[1:])
    had_it = [name for name in map("s{}".format, range(60)) if before[number_of(name, 4)] == 12]
    first, shown, cleared, new = had_it[:4]
    hands_in_beam(course, first, 12, True)
    course.grade()
    write_beam(course, WEIGHTS[1:])
    hands_in_beam(course, shown, 12, True)
    hands_in_beam(course, cleared, 12, False)
    hands_in_beam(course, new, after[number_of(new, 3)], True)
    course.grade()
    assert course.points() == {first: 4, shown: 4, cleared: 0, new: 4}
    # What the notebook shows rules; where it shows nothing, a person decides.
    (waits,) = course.table("undecided.csv")
    assert (
        waits["student"] == cleared and "Which edition did this student have?" in waits["message"]
    )
    said = course.run("why", shown, "hw1")
    assert "of 4, as the source was before): correct" in said
    assert "of 3): correct" in course.run("why", new, "hw1")
    for _ in range(2):
        assert "Marks changed: 0." in course.regrade()
