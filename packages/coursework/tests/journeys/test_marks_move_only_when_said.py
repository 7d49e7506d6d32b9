"""Instructors' weekly routine: no mark changes before they have seen the change."""

import nbformat
import pytest
from course_by_commands import Course

from coursework.grading.judging.journal import Journal
from coursework.grading.store import Store

pytestmark = pytest.mark.usefixtures("libraries_are_loaded_once")

TOO_SHORT = "no idea, sorry"


@pytest.fixture
def course(tmp_path):
    return Course(tmp_path, hw1={"sum": (5, 4)}, hw2={"load": (7, 8), "why": ("By the arm.", 1)})


def test_a_late_notebook_comes_after_the_source_changed(tmp_path):
    course = Course(tmp_path, hw2={"load": (7, 8)})
    for student in ("ada", "ben", "cem", "dan", "eva"):
        course.hands_in(student, "hw2")
    course.grade()
    before = course.points()
    assert set(before.values()) == {8}
    course.change("hw2", load=(9, 8))
    course.hands_in("fay", "hw2", load=9)
    said = course.grade(fails=True)
    assert "5 students would lose: hw2/load." in said and "'ada', hw2: 8 -> 0" in said
    assert "No existing mark was changed." in said
    assert course.points() == {**before, "fay": 8}
    # A second run says the same, and runs no notebook again.
    assert "6 of them graded before" in course.grade(fails=True)
    # With a yes, the marks change and the log says so.
    course.grade("--yes")
    assert course.points() == {**dict.fromkeys(before, 0), "fay": 8}
    log = (course.marks / "run.log").read_text()
    assert "not changed, nobody agreed: 'ada', hw2: 8 -> 0" in log and "  moved: 'ada'" in log
    # A new name does not hide what the next change would cost.
    course.change("hw2", load=(7, 8))
    (course.handed_in / "fay").rename(course.handed_in / "fay-king")
    assert "'fay' is now 'fay-king': we would move" in course.grade("--dry-run")
    said = course.grade(fails=True)
    assert "'fay' is now 'fay-king': the record of hw2, its marks" in said
    assert "1 student would lose: hw2/load." in said and "'fay-king', hw2: 8 -> 0" in said
    assert course.points()["fay-king"] == 8
    said = course.run("why", "marks", "fay", "hw2", fails=True)
    assert "'fay' is now 'fay-king': the marks are under that name." in said
    assert "was 'fay'" in course.run("why", "marks", "fay-king", "hw2")


def test_the_worth_of_a_question_changes(tmp_path):
    course = Course(tmp_path, hw2={"load": (7, 8), "arm": (2, 8)})
    course.hands_in("ada", "hw2", arm=3)
    course.hands_in("ben", "hw2")
    course.grade()
    course.change("hw2", load=(7, 24))
    for command in (course.regrade, course.grade):
        said = command(fails=True)
        assert (
            "1 student would gain: hw2/load." in said and "'ada', hw2: 8 of 16 -> 24 of 32" in said
        )
        assert "1 student would keep the same fraction of the points." in said
    book = course.canvas_book("HW 2 (7)")
    course.export(book)
    assert course.column(book, "HW 2 (7)") == {"ada": "8", "ben": "16"}
    course.regrade("--yes")
    assert course.points() == {"ada": 24, "ben": 32}
    # Nobody was asked a question that was added or renamed since.
    course.change("hw2", force=(7, 8))
    assert "2 students would become undecided" in course.regrade(fails=True)


@pytest.mark.parametrize(
    "policy, points, says",
    [
        ("never-lower", {"ada": 16, "ben": 8}, ""),
        ("full-credit", {"ada": 16, "ben": 16}, "This question was faulty"),
        ("void", {"ada": 8, "ben": 8}, "This question does not count."),
    ],
)
def test_a_policy_says_what_a_mended_question_may_do(tmp_path, policy, points, says):
    course = Course(tmp_path, hw2={"load": (7, 8), "arm": (2, 8)})
    course.hands_in("ada", "hw2")
    course.hands_in("ben", "hw2", load=3)
    course.grade()
    course.change("hw2", load=(9, 8))
    term = f'time-zone = "UTC"\n[assignments.hw2]\n[regrading]\n{policy} = ["hw2/load"]\n'
    (course.marks / "term.toml").write_text(term)
    course.regrade("--yes")
    assert course.points() == points
    assert says in (course.marks / "feedback" / "ben" / "hw2.html").read_text()
    assert "Marks changed: 0." in course.regrade()
    # A person's decision overrides a policy, but a void question counts for nobody.
    record = Store(course.marks).read("ada", "hw2")
    Journal(course.marks).add(record, "hw2/load", 0.5, who="Ann")
    course.regrade("--yes")
    assert course.points()["ada"] == (8 if policy == "void" else 12)


def test_a_table_of_decisions_decides_only_what_it_was_written_for(course):
    course.hands_in("ada", "hw2", why="It has no point of its own, as the moments add up.")
    course.hands_in("ben", "hw2", why="By magic.")
    course.grade()
    table = course.table("undecided.csv")
    for line in table:
        line["credit"] = {"ada": "1", "ben": "0"}[line["student"]]
    path = course.write_table("decided.csv", table)
    said = course.run("merge", "marks", path, "--grader", "Ann")
    assert "decided.csv: 2." in said and course.points() == {"ada": 9, "ben": 8}
    course.hands_in("ada", "hw2", why=TOO_SHORT)
    course.grade("--yes")
    assert course.points()["ada"] == 8 and [
        row["student"] for row in course.table("undecided.csv")
    ] == ["ada"]
    said = course.run("merge", "marks", path, "--grader", "Ann")
    assert (
        "line 2, ada: we do not have this answer. Perhaps the student has handed in again" in said
    )
    assert course.points()["ada"] == 8
    # A table without the IDs of answers is not one of decisions.
    unbound = course.write_table(
        "unbound.csv", [{"student": "ada", "question": "hw2/why", "credit": "1"}]
    )
    assert "a table of decisions is a copy of undecided.csv" in course.run(
        "merge", "marks", unbound, fails=True
    )


def test_a_decision_that_was_merged_stays(course, tmp_path):
    """Ann and Ben each fill in a table on copies of the folder; Ben's is the later one."""
    course.hands_in("ada", "hw2", why="As the moments add up.")
    course.grade()
    table = course.table("undecided.csv")
    copy = Course(tmp_path / "ben", **course.assignments)
    copy.hands_in("ada", "hw2", why="As the moments add up.")
    copy.grade()
    for where, who, credit in ((course, "Ann", "1"), (copy, "Ben", "0.5")):
        path = where.write_table("decided.csv", [{**table[0], "credit": credit}])
        where.run("merge", "marks", path, "--grader", who)
    said = course.run("merge", "marks", copy.marks / "journal.jsonl", fails=True)
    assert "Ann gave 1.0, Ben gave 0.5; the later decision counts" in said
    assert "1 student would lose: hw2/why." in said and course.points() == {"ada": 9}
    course.run("merge", "marks", copy.marks / "journal.jsonl", "--yes")
    assert course.points() == {"ada": 8.5}
    for _ in range(2):
        assert "Marks changed: 0." in course.regrade()
    course.grade()
    assert course.points() == {"ada": 8.5}
    # A table that contradicts a colleague's decisions is refused, line by line.
    said = course.run("merge", "marks", course.place / "decided.csv", "--grader", "Ann")
    assert "line 2, ada: Ben already gave 0.5" in said and course.points() == {"ada": 8.5}


def test_one_assignment_takes_in_no_other(course):
    """The layout is nbgrader's: submitted/student/assignment."""
    for student, name in (("ada", "hw1"), ("ada", "hw2"), ("ben", "hw2")):
        path = course.handed_in / "submitted" / student / name / f"{name}.ipynb"
        path.parent.mkdir(parents=True)
        nbformat.write(course.answers(name), path)
    assert "We skip 2 notebooks for hw2." in course.grade("--assignment", "hw1")
    assert course.points() == {"ada": 4} and course.table("refused.csv") == []
    course.grade("--assignment", "hw2")
    assert course.points("hw2") == {"ada": 8, "ben": 8} and course.points("hw1") == {"ada": 4}
    # For assignments that the term lacks, we print the line to add; and we say what makes one
    # newer.
    for place in ("ada/hw1/again.ipynb", "ben/hw2/hw1.ipynb"):
        nbformat.write(course.answers("hw1"), course.handed_in / "submitted" / place)
    (course.marks / "term.toml").write_text('time-zone = "UTC"\n[assignments.hw1]\n')
    said = course.grade("--yes")
    assert "hw2: to grade it, add [assignments.hw2]" in said and "by the times of" in said


def test_a_column_is_filled_with_one_assignment(tmp_path):
    course = Course(tmp_path, hw1={"sum": (5, 4)}, hw2={"load": (7, 8)})
    course.hands_in("ada", "hw1", sum=6)
    course.hands_in("ada", "hw2")
    course.grade()
    book = course.canvas_book("HW 1 (6)", "HW 2 (7)")
    for which in ([], ["--assignment", "hw2"]):
        assert (
            "to the assignment's table. The gradebook has the columns 'HW 1 (6)',"
            in course.export(book, *which, fails=True)
        )
    (course.marks / "term.toml").write_text(
        'time-zone = "UTC"\n[assignments.hw1]\n[assignments.hw2]\ncolumn = "hw 2"\n'
    )
    # The pages must replace neither the gradebook nor its filled copy.
    assert (
        "different files" in course.export(book, "--feedback", book, fails=True)
        and "different files"
        in course.export(book, "--filled", "new.csv", "--feedback", "new.csv", fails=True)
        and "of feedback: to send" in course.export(book, "--feedback", "to send/feedback.zip")
    )
    assert [course.column(book, name)["ada"] for name in ("HW 1 (6)", "HW 2 (7)")] == ["", "8"]
    # Its column has been renamed, and another column is the only one that could be meant.
    said = course.export(course.canvas_book("Essay (9)", name="renamed.csv"), fails=True)
    assert "correct column = 'hw 2' in the assignment's table" in said


def test_each_worksheet_of_moodle_is_of_one_assignment(tmp_path):
    """It numbers the participants anew, calls its column Grade, and may hold a mark by hand."""
    course = Course(tmp_path, hw1={"sum": (5, 4)}, hw2={"load": (7, 4)})
    for name, first, there, after in (("hw1", 17, "", ["0", "0"]), ("hw2", 40, "0", ["0", "4"])):
        rows = [
            {"Identifier": f"Participant {first}", "Full name": "Ada Lee", "Grade": there},
            {"Identifier": f"Participant {first + 1}", "Full name": "Ben Moe", "Grade": ""},
        ]
        more = {"Maximum Grade": "4.00", "Grade can be changed": "Yes"}
        book = course.write_table(f"{name}.csv", [row | more for row in rows])
        if name == "hw1":
            course.run("term", "new", "marks", "--solutions", "solutions", "--roster", book)
        for number, row in enumerate(rows, first):
            folder = f"{name}/{row['Full name']}_{number}_assignsubmission_file_"
            course.hands_in(folder, name, sum=6)
        course.run("grade", f"handed-in/{name}", "--out", "marks", "--solutions", "solutions")
        said = course.export(book, "--assignment", name)
        assert list(course.column(book, "Grade").values()) == after, said
    assert "Ada Lee: 0, and graded 4" in said


def test_a_cell_that_is_added_leaves_a_decision_where_it_is(course):
    course.hands_in("ada", "hw2", why="As the moments add up.")
    course.grade()
    path = course.write_table("decided.csv", [{**course.table("undecided.csv")[0], "credit": "1"}])
    course.run("merge", "marks", path)
    assert course.points() == {"ada": 9}
    handed_in = course.handed_in / "ada" / "hw2.ipynb"
    made = nbformat.read(handed_in, 4)
    made.cells.insert(0, nbformat.v4.new_code_cell("# what I thought", id="more"))
    nbformat.write(made, handed_in)
    course.grade()
    assert course.points() == {"ada": 9}


def test_a_line_of_the_journal_that_was_edited_is_noticed(course):
    course.hands_in("ada", "hw1")
    course.grade()
    path = course.marks / "journal.jsonl"
    whole = path.read_text()
    path.write_text(whole.replace('"points": 4', '"points": 3'))
    assert "journal.jsonl, line 1: this is not what coursework wrote" in course.regrade(fails=True)
    # A torn last line is reported, and all complete lines count.
    path.write_text(whole + whole[:40])
    said = course.regrade()
    assert "ends in the middle of a line" in said and "Marks changed: 0." in said


def test_a_record_that_was_deleted_costs_nobody_a_mark(tmp_path):
    """The journal knows that a mark was given, so nothing is exported without its record."""
    course = Course(tmp_path, hw2={"load": (7, 8)})
    course.hands_in("ada", "hw2")
    course.hands_in("ben", "hw2")
    course.grade()
    book = course.canvas_book("HW 2 (7)")
    (course.marks / "records" / "ada" / "hw2.json").unlink()
    said = course.export(book, fails=True)
    assert "ada's record for hw2 is missing from" in said and "Grade again first" in said
    assert "its record is gone: grade again" in course.run("why", "marks", "ada", "hw2", fails=True)
    course.grade()
    course.export(book)
    assert course.column(book, "HW 2 (7)") == {"ada": "8", "ben": "8"}
    # The gradebook knows a student whose only file was refused by another name, too.
    (course.handed_in / "dan").mkdir()
    (course.handed_in / "dan" / "hw2.ipynb").write_bytes(b"")
    course.grade()
    rows = course.table("../book.csv")
    rows.append(
        {**rows[0], "Student": "Doe, Dan", "ID": "4", "SIS Login ID": "dan", "HW 2 (7)": ""}
    )
    book = course.write_table("book.csv", rows)
    assert "we graded none of their files (1):\n  Doe, Dan" in course.export(book)


def test_who_was_graded_before_is_not_missing_in_a_late_folder(tmp_path):
    course = Course(tmp_path, hw2={"load": (7, 8)})
    (tmp_path / "roster.csv").write_text("student\nada\nben\ncem\n")
    course.run("term", "new", "marks", "--solutions", "solutions", "--roster", "roster.csv")
    course.hands_in("ada", "hw2")
    assert "2 handed in nothing: ben, cem." in course.grade()
    (course.handed_in / "ada").rename(tmp_path / "first")
    course.hands_in("ben", "hw2")
    assert "1 handed in nothing: cem." in course.grade()
