"""An instructor describes the term once, in one file; from then on, commands need no flags."""

import json
import os
import stat

import nbformat
import pytest
from course_by_commands import Course, read_table

pytestmark = pytest.mark.usefixtures("libraries_are_loaded_once")
TERM = """
time-zone = "Europe/Paris"
roster = "../roster.csv"
[late]
a-day = 0.1
[assignments.hw1]
due = 2025-10-05T23:59:00
column = "HW 1"
[assignments.hw2]
opens = 2025-10-06T08:00:00
due = 2025-10-12T08:00:00
column = "HW 2"
"""


@pytest.fixture
def course(tmp_path):
    course = Course(tmp_path, hw1={"sum": (5, 4), "arm": (2, 4)}, hw2={"load": (7, 8)})
    (tmp_path / "roster.csv").write_text(
        "student,name,email\n"
        + "".join(
            f"{student},{student.capitalize()} Lee,{student}@uni.example\n" for student in STUDENTS
        )
    )
    course.marks.mkdir()
    write_term(course)
    return course


STUDENTS = ("ada", "ben", "cem", "dan")


def write_term(course, *more, text=TERM):
    (course.marks / "term.toml").write_text("\n".join([text, *more]) + "\n")


def collected(course, student, name, when="2025-10-01 12:00:00", file=None, **answers):
    """Write it as nbgrader collects it, in a folder by student and assignment, with its time."""
    folder = course.handed_in / "submitted" / student / name
    folder.mkdir(parents=True, exist_ok=True)
    nbformat.write(course.answers(name, **answers), folder / (file or f"{name}.ipynb"))
    (folder / "timestamp.txt").write_text(f"{when}.000000 UTC")
    return folder


def book_of(course, *students):
    rows = [
        {"Student": "", "ID": number, "SIS User ID": "", "SIS Login ID": student, "Section": "x",
         "HW 1 (11)": "", "HW 2 (12)": ""}
        for number, student in enumerate(students or STUDENTS, 1)
    ]  # fmt: skip
    return course.write_table("book.csv", rows)


def test_from_a_new_file_to_filled_columns(tmp_path):
    course = Course(tmp_path, hw1={"sum": (5, 4)}, hw2={"load": (7, 8)})
    (tmp_path / "roster.csv").write_text("student\nada\nben\n")
    made = ["term", "new", "marks", "--solutions", "solutions", "--roster", "roster.csv"]
    assert "The roster has 2 students, with IDs such as 'ada'." in course.run(*made)
    assert "already exists" in course.run(*made, fails=True)
    path = course.marks / "term.toml"
    text = path.read_text()
    assert "[assignments.hw1]" in text and 'roster = "../roster.csv"' in text
    # Every suggested line must work as it is.
    for name in ("hw1", "hw2"):
        begun = f"[assignments.{name}]\n"
        text = text.replace(
            begun, f'{begun}due = 2025-10-0{name[-1]}T12:00:00\ncolumn = "HW {name[-1]}"\n'
        )
    path.write_text(text)
    collected(course, "ada", "hw1", "2025-10-01 09:00:00")
    collected(course, "ada", "hw2", load=6)
    course.grade()
    book = book_of(course, "ada", "ben")
    said = course.export(book)
    assert course.column(book, "HW 1 (11)") == {"ada": "4", "ben": "0"}
    assert course.column(book, "HW 2 (12)") == {"ada": "0", "ben": "0"}
    assert "Handed in nothing by the due date: 0 (1):\n  ben" in said


@pytest.mark.parametrize(
    "more, said",
    [
        (
            "[extensions.adda]\nhw1 = 2025-10-09T12:00:00",
            "line 14: extensions name 'adda', but nobody",
        ),
        ("[extensions.ada]\nhw3 = 'excused'", "line 15: unknown key 'hw3' in extensions.ada"),
        ("[late-days]\nmost = 1", "line 14: unknown key 'late-days'"),
        ("[extensions.ada]\ntime = 1.5", "line 15: time = 1.5 .* hw1 has no opening date"),
        ("[groups]\nteam = ['ada', 'zoe']", "groups name 'zoe', but nobody"),
        ("[regrading]\nvoid = ['hw1/sums']", "no question 'hw1/sums'"),
    ],
)
def test_what_is_misspelt_is_refused_with_its_line(course, more, said):
    import re

    collected(course, "ada", "hw1")
    write_term(course, more)
    assert re.search(said, course.grade(fails=True))
    assert not (course.marks / "grades.csv").exists()


def test_blank_copies_count_less_than_finished_work(course):
    """One is as it was handed out, and the other has nothing but a remark."""
    folder = collected(course, "ada", "hw1")
    made = course.answers("hw1", sum=None, arm=None)
    for name, remark in (("hw1-Copy1", ""), ("hw1-Copy2", "# I shall do this tomorrow")):
        made.cells.append(nbformat.v4.new_code_cell(remark, id=name))
        nbformat.write(made, folder / f"{name}.ipynb")
    os.utime(folder / "hw1.ipynb", (1, 1))
    said = course.grade()
    for name in ("hw1-Copy1", "hw1-Copy2"):
        matched = f"{name}.ipynb  (hw1; the name of the folder)"
        assert f"{matched} DOES NOT COUNT: it has no answers" in said
    assert course.points("hw1") == {"ada": 8}
    page = (course.marks / "feedback" / "ada" / "hw1.html").read_text()
    assert "was not counted: it has no answers" in page


def test_what_came_in_time_counts_before_what_came_late(tmp_path):
    """Brightspace gives the time of each attempt."""
    course = Course(tmp_path, hw1={"sum": (5, 4), "arm": (2, 4)})
    (tmp_path / "roster.csv").write_text("student,name\nada,Ada Lee\nben,Ben Lee\n")
    course.marks.mkdir()
    attempts = [
        ("101-7 - Ada Lee - Oct 5, 2025 1000 AM", {}),
        ("101-7 - Ada Lee - Oct 9, 2025 1000 AM", {"arm": 3}),
        ("102-7 - Ben Lee - Oct 5, 2025 1000 AM", {"arm": 3}),
        ("102-7 - Ben Lee - Oct 5, 2025 0100 PM", {}),
    ]
    for folder, answers in attempts:
        course.hands_in(folder, "hw1", **answers)
    for attempts, points in (
        ("newest in time", {"ada": 8, "ben": 8}),
        ("last", {"ada": 4, "ben": 8}),
    ):
        (course.marks / "term.toml").write_text(
            'time-zone = "UTC"\nroster = "../roster.csv"\n'
            f'attempts = "{attempts}"\n[late]\na-day = 0.1\n'
            "[assignments.hw1]\ndue = 2025-10-05T23:59:00\n"
        )
        course.grade("--yes")
        assert course.points() == points
    said = course.run("why", "marks", "ada", "hw1")
    assert "handed in 2025-10-09T10:00:00" in said and "late: 40 % lost" in said
    assert (
        "It was late: due 2025-10-05 23:59 UTC"
        in (course.marks / "feedback" / "ada" / "hw1.html").read_text()
        and '"ada","hw1","4","8","0","late"' in (course.marks / "grades.csv").read_text()
    )


def test_a_group_hands_in_once(course):
    # A mark from before there was a group stays, and no work is merged when it is graded again.
    collected(course, "ben", "hw2", "2025-10-14 12:00:00")
    collected(course, "ada", "hw1", arm=3)
    course.grade()
    write_term(course, "[groups]", 'aa = ["ada", "ben", "dan"]')
    collected(course, "aa", "hw2", load=6)
    collected(course, "cem", "hw1")
    said = course.grade()
    for student, name in (("ada", "hw1"), ("ben", "hw2")):
        assert f"In {name}, members of the group 'aa' keep marks of their own: {student}." in said
    # It was the group's work, and there was no line about the group yet.
    alone = "grade handed-in/submitted/ada/hw1 --out marks --solutions solutions --student aa"
    assert "is now" not in course.run(*alone.split()) + course.grade()
    assert course.points("hw1") == {"ada": 4, "aa": 4, "cem": 8}
    assert course.points("hw2") == {"aa": 0, "ben": 8}
    said = course.run("term", "marks") + course.run("why", "marks", "ben", "hw2")
    assert "ben, hw2: 8 of 8 points." in said and "late: 30 % lost" in said
    course.export(book := book_of(course))
    assert course.column(book, "HW 1 (11)") == {"ada": "4", "ben": "4", "cem": "8", "dan": "4"}
    assert course.column(book, "HW 2 (12)") == {"ada": "0", "ben": "5.6", "cem": "0", "dan": "0"}
    assert [row["hw2: points"] for row in course.table("course/course.csv")][:2] == ["0", "8"]
    # One appeal is for both.
    appeals = [{"student": "aa", "question": "hw1/arm", "words": "Why?"}]
    course.run("merge", "marks", course.write_table("appeals.csv", appeals))
    assert "  ben: hw1/arm\n  dan: hw1/arm" in course.export(book)
    assert "dan (in aa), hw1: 4 of 8 points." in course.run("why", "marks", "dan", "hw1")


def test_more_time_is_for_whom_it_is(course):
    write_term(course)
    for student in ("ada", "ben"):
        collected(course, student, "hw2", "2025-10-14 12:00:00")
    write_term(course, "[extensions.ada]", "hw1 = 'excused'", text=TERM)
    course.grade()
    book = book_of(course)
    course.export(book, "--assignment", "hw2")
    assert course.column(book, "HW 2 (12)") == {"ada": "5.6", "ben": "5.6", "cem": "0", "dan": "0"}
    text = TERM.replace("[assignments.hw1]\n", "[assignments.hw1]\nopens = 2025-10-01T08:00:00\n")
    write_term(course, "[extensions.ada]", "time = 1.5", text=text)
    course.export(book, "--assignment", "hw2")
    assert course.column(book, "HW 2 (12)") == {"ada": "8", "ben": "5.6", "cem": "0", "dan": "0"}


def test_who_handed_in_what_is_damaged_did_not_hand_in_nothing(course):
    collected(course, "ada", "hw1")
    (collected(course, "ben", "hw1") / "hw1.ipynb").write_text("no notebook")
    for folder in ("dan", "Dan"):
        collected(course, folder, "hw1")
    said = course.grade()
    assert "2 handed in files that we did not grade: ben, dan." in said
    assert "? <- submitted/Dan/hw1/hw1.ipynb: Two submissions claim to be this student's" in said
    assert "1 handed in nothing: cem." in said
    # Grading another assignment in another folder forgets none of it.
    other = course.place / "later"
    (other / "cem").mkdir(parents=True)
    nbformat.write(course.answers("hw2"), other / "cem" / "hw2.ipynb")
    course.run("grade", "later", "--out", "marks", "--solutions", "solutions")
    assert {row["student"] for row in course.table("refused.csv")} == {"ben", "dan"}
    book = book_of(course)
    said = course.export(book, "--assignment", "hw1")
    assert "we graded none of their files (2):\n  ben\n  dan" in said
    # The totals leave it open everywhere, too, until a person has looked.
    said = course.run("term", "marks")
    assert "hw1: we did not grade the files of ben, dan." in said
    totals = {
        row["student"]: (row["total in %"], row["hw1: state"])
        for row in course.table("course/course.csv")
    }
    assert totals["ben"] == totals["dan"] == ("", "damaged") and totals["cem"][1] == "missing"
    assert (
        "your file has not been graded, because a person has to look at it first"
        in (course.marks / "course" / "students" / "ben.html").read_text()
    )
    course.run("export", "marks", "--nbgrader", "grades.csv", "--assignment", "hw1")
    rows = read_table(course.place / "grades.csv")
    assert [row["student_id"] for row in rows] == ["ada", "cem"]
    assert course.column(book, "HW 1 (11)") == {"ada": "8", "ben": "", "cem": "0", "dan": ""}


def test_a_mark_tells_its_life(course):
    collected(course, "ada", "hw2", load=6)
    course.grade()
    course.change("hw2", load=(6, 8))
    course.regrade("--yes")
    course.export(book_of(course), "--assignment", "hw2")
    said = course.run("why", "marks", "ada", "hw2")
    lines = said.splitlines()
    assert lines[0] == "ada, hw2: 8 of 8 points." and len(lines) <= 10
    assert (
        "0 of 8 points: graded" in said and "8 of 8 points: the questions or the software" in said
    )
    assert "8 written to 'HW 2 (12)' of " in said
    assert "'eve' has no marks for 'hw2'" in course.run("why", "marks", "eve", "hw2", fails=True)


def test_a_blind_worksheet_of_moodle_is_a_roster_and_is_filled(tmp_path):
    """With names hidden, it contains only the IDs of participants."""
    course = Course(tmp_path, hw1={"sum": (5, 4)})
    rows = [
        {"Identifier": f"Participant {number}", "Status": "Submitted", "Grade": "",
         "Maximum Grade": "4.00", "Grade can be changed": "Yes"}
        for number in (17, 23, 31)
    ]  # fmt: skip
    book = course.write_table("worksheet.csv", rows)
    course.run("term", "new", "marks", "--solutions", "solutions", "--roster", "worksheet.csv")
    course.hands_in("Participant_17_assignsubmission_file_", "hw1")
    course.hands_in("Participant_31_assignsubmission_file_", "hw1", sum=6)
    said = course.grade()
    assert (
        "Participant 17 <- Participant_17" in said and "handed in nothing: Participant 23" in said
    )
    assert course.points() == {"Participant 17": 4, "Participant 31": 0}
    said = course.export(book)
    assert "2 marks filled in" in said
    assert list(course.column(book, "Grade").values()) == ["4", "", "0"]


def test_blackboards_own_gradebook_is_filled_without_a_word(tmp_path):
    """It is UTF-16 with tabs, in quotation marks, and an attempt has the user's name."""
    course = Course(tmp_path, hw1={"sum": (5, 4)}, hw2={"load": (7, 8)})
    header = [
        "Last Name", "First Name", "Username", "Student ID", "Last Access", "Availability",
        "Weighted Total [Total Pts: 0 Percentage] |1", "Total [Total Pts: 20 Score] |2",
        "Homework 1 [Total Pts: 10 Score] |311", "Homework 2 [Total Pts: 10 Score] |312",
    ]  # fmt: skip
    people = [["Lee", "Ada", "alee", "1001"], ["Moe", "Ben", "bmoe", "1002"]]
    lines = [header, *([*person, "", "Yes", "", "", "", ""] for person in people)]
    text = "\r\n".join("\t".join(f'"{cell}"' for cell in line) for line in lines) + "\r\n"
    book = tmp_path / "gc.xls"
    book.write_bytes(text.encode("utf-16"))
    course.run("term", "new", "marks", "--solutions", "solutions", "--roster", "gc.xls")
    for user, answer in (("alee", 5), ("bmoe", 6)):
        name = f"Homework 1_{user}_attempt_2025-10-01-10-00-00_hw1.ipynb"
        nbformat.write(course.answers("hw1", sum=answer), course.handed_in / name)
    course.grade()
    assert course.points() == {"1001": 4, "1002": 0}
    # Two columns could be meant. The term's file decides, and nothing else is needed.
    said = course.export(book, fails=True)
    assert (
        "'Homework 1 [Total Pts: 10 Score] |311', 'Homework 2" in said and "column = '...'" in said
    )
    term = course.marks / "term.toml"
    begun = "[assignments.hw1]\n"
    term.write_text(term.read_text().replace(begun, f'{begun}column = "Homework 1"\n'))
    said = course.export(book)
    assert "Blackboard: column 'Homework 1" in said and "2 marks filled in" in said
    data = book.read_bytes()
    filled = [line.split("\t") for line in data.decode("utf-16").split("\r\n")]
    assert [line[8] for line in filled[1:3]] == ['"10"', '"0"'] and data[:2] == b"\xff\xfe"


def test_gradescopes_own_lists_are_understood(tmp_path):
    course = Course(tmp_path, hw1={"sum": (5, 4)})
    (tmp_path / "roster.csv").write_text(
        "Name,SID,Email\nAda Lee,1001,ada@uni.example\nBen Lee,,ben@uni.example\nCem Oz,3003,\n"
        "Dan Ek,4004,\n"
    )
    course.marks.mkdir()
    term = 'time-zone = "UTC"\nroster = "../roster.csv"\n[assignments.hw1]\n'
    (course.marks / "term.toml").write_text(term)
    listed = []
    ada, ben = ("Ada Lee", "1001", "ada@uni.example"), ("Ben Lee", "2002", "ben@uni.example")
    cem, dan = ("Cem Oz", "3003", ""), ("Dan Ek", "4004", "")
    for number, people in enumerate([[ada], [ben], [cem, dan]]):
        course.hands_in(f"submission_{number}", "hw1")
        listed.append(f"submission_{number}:\n  :submitters:\n")
        for name, sid, email in people:
            listed.append(f"  - :name: {name}\n    :sid: '{sid}'\n    :email: {email}\n")
        listed.append("  :created_at: 2025-10-01 12:00:00.0 Z\n")
    (course.handed_in / "submission_metadata.yml").write_text("".join(listed))
    # Work that two students handed in together is refused until the term lists them as a group.
    assert "? <- submission_2/hw1.ipynb: Several students handed this in" in course.grade()
    assert course.points() == {"1001": 4, "ben@uni.example": 4}
    (course.marks / "term.toml").write_text(f'{term}[groups]\nteam = ["3003", "4004"]\n')
    course.grade()
    assert course.points() == {"1001": 4, "ben@uni.example": 4, "team": 4}
    assert "4004 (in team), hw1: 4 of 4 points." in course.run("why", "marks", "4004", "hw1")
    course.run("export", "marks", "--nbgrader", "grades.csv")
    (table,) = (tmp_path / "grades.csv").read_text().split("\n\n")
    assert [line.split(",")[3] for line in table.splitlines()[1:]] == [
        '"1001"', '"3003"', '"4004"', '"ben@uni.example"'
    ]  # fmt: skip
    assert stat.S_IMODE((tmp_path / "grades.csv").stat().st_mode) == 0o600


def test_who_has_no_mark_is_told_why(course):
    collected(course, "ada", "hw1")
    (collected(course, "ben", "hw1") / "hw1.ipynb").write_text("no notebook")
    write_term(course, "[extensions.dan]", "hw1 = 'excused'")
    course.grade()
    said = course.run("why", "marks", "ben", "hw1")
    assert "ben, hw1: nothing has been graded." in said
    assert (
        "not graded: submitted/ben/hw1/hw1.ipynb: Not a notebook" in said
        and "no mark is exported" in said
    )
    assert "CEST; it is exported as 0" in course.run("why", "marks", "cem", "hw1")
    assert "CEST; excused" in course.run("why", "marks", "dan", "hw1")
    assert "Not filled in, because excused in term.toml (1):\n  dan" in course.export(
        book_of(course), "--assignment", "hw1"
    )
    # A misspelt name is refused wherever the term is read.
    write_term(course, "[extensions.den]", "hw1 = 'excused'")
    assert "line 14: extensions name 'den'" in course.regrade(fails=True)
    # A class may have neither a term nor a roster.
    (course.marks / "term.toml").unlink()
    assert "ben/hw1/hw1.ipynb: Not a notebook" in course.run("why", "marks", "ben", "hw1")


def test_nobody_else_on_the_machine_reads_marks(tmp_path):
    course = Course(tmp_path, hw1={"sum": (5, 4)})
    course.hands_in("ada", "hw1")
    course.grade()
    assert stat.S_IMODE(course.marks.stat().st_mode) == 0o700
    course.run(*"gradescope marks --out auto.zip --solutions solutions --assignment hw1".split())
    assert stat.S_IMODE((tmp_path / "auto.zip").stat().st_mode) == 0o600
    assert json.loads((course.marks / "refused.json").read_text())
