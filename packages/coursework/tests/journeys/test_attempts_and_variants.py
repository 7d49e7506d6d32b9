"""Marks after a source changes: the page of changes, and variants that were removed."""

import hashlib

import nbformat
import pytest
from course_by_commands import Course
from trial_course import notebook

pytestmark = pytest.mark.usefixtures("libraries_are_loaded_once")
TERM = """
time-zone = "UTC"
roster = "../roster.csv"
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


def test_the_page_of_moves_is_there_when_it_is_named(course):
    course.hands_in("ada", "hw1", why=None)
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
        ("markdown", "A beam carries {{weight}} N twice. Give the whole load."),
        "### BEGIN SOLUTION\nload = 2*beam.weight\n### END SOLUTION",
        "check('hw1/load', load)\n### BEGIN HIDDEN TESTS\nquestion('hw1/load', kind='expression', "
        "worth=4)\n### END HIDDEN TESTS",
    ]
    nbformat.write(notebook(cells), course.solutions / "hw1.ipynb")


def number_of(student, count):
    """The rule, written independently."""
    digest = hashlib.sha256(f"\nhw1/load\n{student}".encode()).digest()
    return int.from_bytes(digest[:8], "big") % count


def weights_in_order(weights):
    from coursework.authoring.variation import Rule

    rule = Rule("hw1/load", len(weights), {"weight": weights})
    return [rule.parameters(number)["weight"] for number in range(len(weights))]


def hands_in_beam(course, student, weight, shows):
    made = notebook(["from coursework import check, student, variant\nstudent('')", "beam", ""])
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
    # The variant that the notebook shows counts; if it shows none, a person decides.
    (waits,) = course.table("undecided.csv")
    assert (
        waits["student"] == cleared and "Which edition did this student have?" in waits["message"]
    )
    said = course.run("why", "marks", shown, "hw1")
    assert "of 4, as the source was before): correct" in said
    assert "of 3): correct" in course.run("why", "marks", new, "hw1")
    for _ in range(2):
        assert "Marks changed: 0." in course.regrade()
