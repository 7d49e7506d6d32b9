"""Every submission is read strictly, reported when refused, and left unchanged."""

import codecs
import hashlib
import io
import json
import os
import stat
import struct
import tracemalloc
import zipfile

import nbformat
import pytest
from grading_class import handed_in, notebook, put, write_sources

from coursework.grading.assignments import Course, NothingToGrade
from coursework.grading.grade import grade
from coursework.grading.judging.term import Assignment, Term
from coursework.grading.pairing import pair
from coursework.grading.store import Store
from coursework.grading.submissions import intake
from coursework.grading.submissions.roster import BadRoster, Roster

pytestmark = pytest.mark.usefixtures("libraries_are_loaded_once")

GOOD = nbformat.writes(handed_in()).encode()


@pytest.fixture
def folder(tmp_path):
    place = tmp_path / "submissions"
    (place / "neighbour").mkdir(parents=True)
    (place / "neighbour" / "turns.ipynb").write_bytes(GOOD)
    return place


def the_refused(path):
    """Return the reason for each refusal; the neighbour's notebook must be read nevertheless."""
    notebooks, refused = intake.take_in(path, ["turns"])
    assert [notebook.student for notebook in notebooks] == ["neighbour"]
    return {refusal.file: refusal.why for refusal in refused}


def archive(path, *entries):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as box:
        for name, data in (("neighbour/turns.ipynb", GOOD), *entries):
            if isinstance(name, str):
                info = zipfile.ZipInfo()
                # Set the name unchanged, even if it leads elsewhere.
                info.filename, info.compress_type = (name, zipfile.ZIP_DEFLATED)
                name = info
            box.writestr(name, data)
    return path


# ---- whose a notebook is


@pytest.mark.parametrize(
    "name, student, identity, late",
    [
        ("student-017/turns.ipynb", "student-017", {}, False),
        ("student-017/work/turns.ipynb", "student-017", {}, False),
        ("student-017.ipynb", "student-017", {}, False),
        ("student-017_turns.ipynb", "student-017", {}, False),
        # Browsers save unknown types like this.
        ("student-017/turns.ipynb.txt", "student-017", {}, False),
        ("student-017_turns.ipynb.json", "student-017", {}, False),
        ("turns (student-017).ipynb", "student-017", {}, False),
        ("submitted/student-017/turns/turns.ipynb", "student-017", {}, False),
        (
            "seventeenstudent_100017_800017_turns.ipynb",
            "seventeenstudent_100017",
            {"canvas": "100017", "name": "seventeenstudent"},
            False,
        ),
        (
            "seventeenstudent_LATE_100017_800017_turns-1.ipynb",
            "seventeenstudent_100017",
            {"canvas": "100017", "name": "seventeenstudent"},
            True,
        ),
        (
            "Student Seventeen_100017_assignsubmission_file_/turns.ipynb",
            "Student Seventeen 100017",
            {"moodle": "100017", "name": "Student Seventeen"},
            False,
        ),
        (
            "Student Seventeen_100017_assignsubmission_file/turns.ipynb",
            "Student Seventeen 100017",
            {"moodle": "100017", "name": "Student Seventeen"},
            False,
        ),
        (
            "Student Seventeen_100017_assignsubmission_file_turns.ipynb",
            "Student Seventeen 100017",
            {"moodle": "100017", "name": "Student Seventeen"},
            False,
        ),
        (
            "100017-4711 - Student Seventeen - Nov 21, 2026 801 PM/turns.ipynb",
            "Student Seventeen 100017",
            {"brightspace": "100017", "name": "Student Seventeen"},
            False,
        ),
    ],
)
@pytest.mark.parametrize("packed", [False, True])
def test_whose_a_notebook_is(tmp_path, name, student, identity, late, packed):
    if packed:
        path = tmp_path / "submissions.zip"
        with zipfile.ZipFile(path, "w") as box:
            box.writestr(name, GOOD)
            box.writestr("index.html", "<p>")
    else:
        path = tmp_path / "submissions"
        (path / name).parent.mkdir(parents=True)
        (path / name).write_bytes(GOOD)
    (notebook,), refused = intake.take_in(path, ["turns"])
    assert (notebook.student, notebook.identity.called, notebook.late) == (student, identity, late)
    assert notebook.digest == hashlib.sha256(GOOD).hexdigest() and refused == []


def test_two_numbers_in_a_students_own_file_are_not_taken_for_canvas(folder):
    for name in ("homework_1_2_final.ipynb", "turns.ipynb", "more.ipynb"):
        (folder / "neighbour" / name).write_bytes(GOOD)
    assert {notebook.student for notebook in intake.take_in(folder)[0]} == {"neighbour"}


def named(*names, **options):
    """Return the students by an archive's names, and the refused files with reasons."""
    path = options.pop("path")
    with zipfile.ZipFile(path, "w") as box:
        for name in names:
            box.writestr(name, options.get("data", GOOD))
    notebooks, refused = intake.take_in(path, ["turns", "axes"], options.get("roster"))
    return {notebook.file: notebook.student for notebook in notebooks}, {
        refusal.file: refusal.why for refusal in refused
    }


@pytest.fixture
def box(tmp_path):
    return tmp_path / "class.zip"


#: Names as the systems themselves write them, from a system's source or its downloads.
DOWNLOADED = {
    # Canvas: `get_filename` and `add_upload_submission` in lib/content_zipper.rb of
    # instructure/canvas-lms. The lower-case name to sort by, without punctuation, LATE, the
    # student's ID, and the file's.
    "doejohn_340934_208490284_BobsWork.ipynb": ("doejohn_340934", "", False),
    "doejane_LATE_334244_394803489_MyAssignment-1.ipynb": ("doejane_334244", "", True),
    "m\xfcllerj\xf6rg_101_5_01_turns.ipynb": ("m\xfcllerj\xf6rg_101", "", False),
    "doejane_marie_102_6_turns.ipynb": ("doejane_marie_102", "", False),
    "anon_aB3dE_501_turns.ipynb": ("anonymous_aB3dE", "", False),
    "LATE_anon_xY4zF_502_turns.ipynb": ("anonymous_xY4zF", "", True),
    # Moodle: `download_submissions` in mod/assign/locallib.php of moodle/moodle, in folders and
    # flat, with groups, and with hidden names in several languages.
    "THIRD STUDENT NAME_10019166_assignsubmission_file_/JURNAL1.ipynb": (
        "THIRD STUDENT NAME 10019166", "", False),
    "Vorname Nachname_1327627_assignsubmission_file_/turns.ipynb": (
        "Vorname Nachname 1327627", "", False),
    "Double-Name Student_657693_assignsubmission_file_turns.ipynb": (
        "Double-Name Student 657693", "", False),
    "Default group-Jane Doe_77_assignsubmission_file_/turns.ipynb": (
        "Default group-Jane Doe 77", "", False),
    "Participant_1234_assignsubmission_file_/turns.ipynb": ("Participant 1234", "", False),
    "Teilnehmerin_1235_assignsubmission_file_/turns.ipynb": ("Teilnehmerin 1235", "", False),
    # Brightspace: downloads that several graders' own tools describe, with or without the enclosing
    # folder.
    "152711-351765 - Some Student - May 18, 2025 1224 PM/turns.ipynb": (
        "Some Student 152711", "2025-05-18T12:24:00", False),
    "39786-640693 - Another Student - Oct 10, 2025 1022 AM/turns.ipynb": (
        "Another Student 39786", "2025-10-10T10:22:00", False),
    # Blackboard: README of kwurst/bb-file-cleanup and others. An assignment's name may contain
    # spaces and punctuation.
    "Project 3  Reverse Engineering_abc0124_attempt_2015-04-23-17-56-20_abc0124-P3.ipynb": (
        "abc0124", "2015-04-23T17:56:20", False),
    "Project 3  Reverse Engineering_abc0123_attempt_2015-02-12-21-30-34_Assignment_1.ipynb": (
        "abc0123", "2015-02-12T21:30:34", False),
    # Gradescope: the archive of all submissions, with the table of who handed in which.
    "assignment_9100_export/submission_41/turns.ipynb": (
        "100", "2026-11-21T20:01:00.500000+00:00", False),
    "assignment_9100_export/submission_42/turns.ipynb": ("bob@uni.example", "", False),
}  # fmt: skip
GRADESCOPE = """---
submission_41:
  :submitters:
  - :name: Solo Student
    :sid: '100'
    :email: solo@uni.example
  :created_at: 2026-11-21 20:01:00.500000000 Z
  :score: 0.0
submission_42:
  :submitters:
  - :name: Bob
    :email: bob@uni.example
submission_43:
  :submitters:
  - :name: Pair One
    :sid: '200'
  - :name: Pair Two
    :sid: '201'
"""


@pytest.mark.parametrize("around", ["", "Programming Exam 1/"])
def test_names_as_the_systems_write_them(tmp_path, around):
    systems = ("_attempt_", "assignsubmission", " - ", "export/")
    groups = {}
    for name, known in DOWNLOADED.items():
        groups.setdefault(next((sign for sign in systems if sign in name), "canvas"), {})[name] = (
            known
        )
    assert len(groups) == 5
    for sign, names in groups.items():
        box = tmp_path / f"{len(sign)}.zip"
        with zipfile.ZipFile(box, "w") as opened:
            for name in names:
                opened.writestr((around if sign != "export/" else "") + name, GOOD)
            if sign == "export/":
                opened.writestr("assignment_9100_export/submission_metadata.yml", GRADESCOPE)
                opened.writestr("assignment_9100_export/submission_43/turns.ipynb", GOOD)
                opened.writestr(
                    "assignment_9100_export/submission_41/submission_metadata.yml", GRADESCOPE[::-1]
                )
        notebooks, refused = intake.take_in(box, ["turns"])
        taken = {
            notebook.file.removeprefix(around): (
                notebook.student,
                notebook.claim.handed_in,
                notebook.late,
            )
            for notebook in notebooks
        }
        assert taken == names
        # A group's submission needs a person, and so does a table that only resembles the system's.
        unknown = {refusal.file for refusal in refused}
        assert unknown == (
            {"assignment_9100_export/submission_43/turns.ipynb"} if sign == "export/" else set()
        )


def test_a_folder_around_everything_is_no_student(box):
    students, _ = named("homework/jane/turns.ipynb", "homework/bob/turns.ipynb", path=box)
    assert sorted(students.values()) == ["bob", "jane"]
    students, _ = named("all/jane_1_2_turns.ipynb", "all/bob_3_4_turns.ipynb", path=box)
    assert sorted(students.values()) == ["bob_3", "jane_1"]
    students, _ = named(
        "course/submitted/jane/turns/a.ipynb", "course/source/turns/a.ipynb", path=box
    )
    assert list(students.values()) == ["jane"]


def test_what_a_system_adds_is_no_refusal(box):
    """Blackboard adds a text to each attempt; nbgrader keeps other files beside the submissions."""
    blackboard = [
        f"HW_{who}_attempt_2026-11-20-10-11-12{end}"
        for who in ("ann", "bob")
        for end in ("_a.ipynb", ".txt")
    ]
    text_only = "HW_eve_attempt_2026-11-20-10-11-13.txt"
    students, refused = named(
        *blackboard, text_only, "HW_bob_attempt_2026-11-20-10-11-12_notes.txt", path=box
    )
    assert sorted(students.values()) == ["ann", "bob"]
    # Students who handed in only a text are reported, and so is a student's own text.
    assert sorted(refused) == ["HW_bob_attempt_2026-11-20-10-11-12_notes.txt", text_only]
    folders = [f"{place}/turns/turns.ipynb" for place in ("source", "release")]
    folders += [
        f"{place}/ann/turns/turns.{end}"
        for place in ("autograded", "feedback")
        for end in ("ipynb", "html")
    ]
    students, refused = named(
        "submitted/ann/turns/turns.ipynb", "submitted/ann/turns/answer.pdf", *folders, path=box
    )
    assert list(students.values()) == ["ann"] and list(refused) == [
        "submitted/ann/turns/answer.pdf"
    ]
    assert "notebook in the same folder can read it" in refused["submitted/ann/turns/answer.pdf"]
    around = [f"course/{name}" for name in ("submitted/ann/turns/turns.ipynb", *folders)]
    assert named(*around, path=box)[1] == {}


def test_what_lies_beside_a_notebook_has_the_name_that_its_author_gave_it(box, tmp_path):
    """Canvas numbers resubmitted files; a single student's files in Gradescope are in no folder."""
    files = (
        "doejane_101_5_turns-2.ipynb",
        "doejane_101_6_half-2.py",
        "doejane_101_7_data-1.npy",
        "leebob_2_8_a.ipynb",
    )
    files += (
        "leebob_2_9_part-1.py",
        "leebob_2_10_part.py",
        "leebob_2_11_x-3.csv",
        "leebob_2_12_x-10.csv",
    )
    with zipfile.ZipFile(box, "w") as opened:
        for name in files:
            opened.writestr(name, GOOD if name.endswith("ipynb") else name.encode())
    notebooks, refused = intake.take_in(box, ["turns"])
    jane, bob = (
        notebook.files for notebook in sorted(notebooks, key=lambda notebook: notebook.student)
    )
    assert jane["half.py"] == jane["half-2.py"] == b"doejane_101_6_half-2.py" and "data.npy" in jane
    assert (
        bob["part.py"].endswith(b"part.py") and bob["x.csv"].endswith(b"x-10.csv") and refused == []
    )
    for name in ("turns.ipynb", "helper.py", "data/numbers.csv"):
        (tmp_path / "flat" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "flat" / name).write_bytes(GOOD if name.endswith("ipynb") else b"1")
    (notebook,), refused = intake.take_in(tmp_path / "flat", ["turns"], student="ann")
    assert set(notebook.files) == {"helper.py", "data/numbers.csv"} and refused == []


@pytest.mark.parametrize("place", ["all", "lone/turns.ipynb", "lone"])
def test_everything_from_one_student_is_a_question(tmp_path, course, place):
    for name in ("a", "b", "c"):
        put(tmp_path / "all", "homework", handed_in(), f"{name}.ipynb")
    # A lone notebook was once graded as the work of a student of the same name.
    put(tmp_path, "lone", handed_in(), "turns.ipynb")
    put(tmp_path, "lone", handed_in(), "axes.ipynb")
    with pytest.raises(NothingToGrade, match="belong to one student, 'homework'|^turns would be"):
        grade(
            tmp_path / place, tmp_path / "out", solutions=tmp_path / "solutions", show=io.StringIO()
        )
    assert not (tmp_path / "out" / "lock").exists()


def test_github_classroom(tmp_path):
    for user in ("jane-doe", "bob"):
        put(tmp_path, f"homework-1-{user}", handed_in())
        (tmp_path / f"homework-1-{user}" / ".git" / "objects").mkdir(parents=True)
        (tmp_path / f"homework-1-{user}" / ".git" / "objects" / "00ab").write_bytes(b"x")
        (tmp_path / f"homework-1-{user}" / "README.md").write_text("read me")
    notebooks, refused = intake.take_in(tmp_path, ["turns"])
    assert (
        sorted(notebook.student for notebook in notebooks) == ["bob", "jane-doe"] and refused == []
    )


def test_anonymous_exports_and_archives_within(box):
    students, refused = named(
        "anon_aB3dE_501_turns.ipynb", "LATE_anon_LATE1_502_turns.ipynb", path=box
    )
    assert sorted(students.values()) == ["anonymous_LATE1", "anonymous_aB3dE"]
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as inner:
        for name, content in (
            ("bob_202_502_turns.ipynb", GOOD),
            ("../../bob/turns.ipynb", GOOD),
            ("data.csv", b"1,2"),
            # PowerShell 5 separates folders in this way.
            ("exercises\\data.csv", b"3,4"),
        ):
            inner.writestr(name, content)
    with zipfile.ZipFile(box, "w") as outer:
        for name, content in (
            ("jane_101_501_work.zip", data.getvalue()),
            ("bob_202_503_turns.ipynb", GOOD),
            ("eve_303_504_bad.zip", b"PK nothing"),
            ("max_404_505_work.rar", b"Rar!"),
        ):
            outer.writestr(name, content)
    notebooks, refused = intake.take_in(box, ["turns"])
    whose = {notebook.file: notebook for notebook in notebooks}
    packed = whose["jane_101_501_work.zip/bob_202_502_turns.ipynb"]
    assert packed.student == "jane_101" and packed.cells
    assert packed.files == {"data.csv": b"1,2", "exercises/data.csv": b"3,4"}
    assert whose["bob_202_503_turns.ipynb"].student == "bob_202"
    why = {refusal.file: refusal.why for refusal in refused}
    assert "leads out" in why["jane_101_501_work.zip/../../bob/turns.ipynb"]
    assert "cannot read" in why["eve_303_504_bad.zip"]
    assert "do not open this archive. Unpack it" in why["max_404_505_work.rar"]


CANVAS_BOOK = """Student,ID,SIS User ID,SIS Login ID,Section,Turns (4711)
    Points Possible,,,,,6
"Doe, Jane",101,S1,jdoe,Section 1,
"Smith, Bob",202,S2,bsmith,Section 1,
"Smith, Bob",203,S3,bsmith2,Section 1,
"""


@pytest.mark.parametrize(
    "name, student, how",
    [
        ("doejane_101_5_turns.ipynb", "jdoe", "Canvas's number"),
        ("smithbob_203_5_turns.ipynb", "bsmith2", "Canvas's number"),
        ("doejane_999_5_turns.ipynb", None, "matches. Whose"),  # Canvas knows the number.
        ("jdoe/turns.ipynb", "jdoe", "the name of the folder"),
        ("JDoe/turns.ipynb", "jdoe", "the name of the folder"),
        ("Jane Doe/turns.ipynb", "jdoe", "the full name"),
        ("Doe, Jane/turns.ipynb", "jdoe", "the letters of the name"),
        ("doe_jane/turns.ipynb", "jdoe", "the letters of the name"),
        ("TURNS Jane Doe.ipynb", "jdoe", "the full name"),
        ("Smith Bob/turns.ipynb", None, "Several students in the roster match: bsmith, bsmith2"),
        ("Bob Smith/turns.ipynb", None, "Several students in the roster match: bsmith, bsmith2"),
        ("S2/turns.ipynb", "bsmith", "the name of the folder"),
        ("stranger/turns.ipynb", None, "Nobody"),
        ("00S2/turns.ipynb", None, "It has 's2': a spreadsheet may have removed zeros"),
        ("jd\u200boe/turns.ipynb", "jdoe", "the name of the folder"),
        ("jd\u043ee/turns.ipynb", None, "Nobody"),  # It has a Cyrillic o.
        ("Jane Doe_77_assignsubmission_file_/turns.ipynb", "jdoe", "the full name"),
    ],
)
def test_the_roster_alone_says_whose_a_notebook_is(box, tmp_path, name, student, how):
    (tmp_path / "book.csv").write_text(CANVAS_BOOK)
    students, refused = named(name, path=box, roster=Roster(tmp_path / "book.csv"))
    notebooks, _ = intake.take_in(box, ["turns"], Roster(tmp_path / "book.csv"))
    assert students == ({name: student} if student else {})
    assert how in (notebooks[0].matched if student else refused[name])
    if student:
        assert notebooks[0].identity.called["canvas"] in ("101", "202", "203")


@pytest.mark.parametrize(
    "text, name, student",
    [
        ("\ufeffIdentifier;Full name;Email address\nParticipant 77;Jane Doe;jd@x.org\n",
         "Jane Doe_77_assignsubmission_file_/turns.ipynb", "jd@x.org"),
        # Moodle numbers the participants of the next assignment anew.
        ("Identifier,Full name\nParticipant 77,Jane Doe\n",
         "Jane Doe_99_assignsubmission_file_/turns.ipynb", "Jane Doe"),
        ("OrgDefinedId,Username,Last Name,First Name\n#100,#jdoe,Doe,Jane\n",
         "5-6 - Jane Doe - Nov 21, 2026 801 PM/turns.ipynb", "jdoe"),
        ("id,first_name,last_name,email\njdoe,Jane,Doe,jd@x.org\n",
         "submitted/jdoe/turns/turns.ipynb", "jdoe"),
        ("identifier,github_username\nJane Doe,jane-d\n", "turns-jane-d/turns.ipynb", None),
        ("student,handed in as\njdoe,that one; another\n", "another/turns.ipynb", "jdoe"),
        ("student\tcanvas\njdoe\t101\n", "x_101_2_turns.ipynb", "jdoe"),
    ],
)  # fmt: skip
def test_rosters_of_many_systems_are_read(box, tmp_path, text, name, student):
    (tmp_path / "roster.csv").write_text(text, "utf8")
    # Beside a number in the roster, a namesake's work with another number is nobody's.
    students, _ = named(
        *{name, name.replace("_77_", "_98_")}, path=box, roster=Roster(tmp_path / "roster.csv")
    )
    assert students == ({name: student} if student else {})


@pytest.mark.parametrize(
    "text, why",
    [
        ("student\na\na\n", "line 3: 'a' is listed twice"),
        ("x,y\n1,2\n", "lists no students"),
        ("PK\x03\x04...", "roster.csv is a spreadsheet's own file.* save it as CSV"),
        ("\xd0\xcf\x11\xe0...", "roster.csv is a spreadsheet's own file, such as .xlsx, .xls"),
        ('student,name\n1,"Ann\n2,Bob\n', "line 2: we cannot read this line"),
    ],
)
def test_a_roster_that_cannot_be_used_is_said(tmp_path, text, why):
    (tmp_path / "roster.csv").write_text(text, "latin-1")
    with pytest.raises(BadRoster, match=why):
        Roster(tmp_path / "roster.csv")
    with pytest.raises(BadRoster, match="cannot read the table"):
        Roster(tmp_path / "none.csv")


def test_a_notebook_that_would_fill_the_memory_is_refused(folder):
    (folder / "stranger").mkdir()
    (folder / "stranger" / "turns.ipynb").write_bytes(b"[" + b"[]," * 3_000_000 + b"[]]")
    assert "parts" in the_refused(folder)["stranger/turns.ipynb"]
    # A long output is one string.
    made = handed_in(also=[("markdown", "1, [2], {3}\n" * 400_000)])
    (folder / "neighbour" / "turns.ipynb").write_text(nbformat.writes(made))
    assert len(intake.take_in(folder)[0]) == 1


def test_a_notebook_that_is_changed_meanwhile_is_not_taken(folder):
    (notebook,), _ = intake.take_in(folder)
    assert notebook.cells == intake.read_notebook(GOOD)[0]
    (folder / "neighbour" / "turns.ipynb").write_bytes(GOOD + b" ")
    with pytest.raises(intake.Unfit, match="changed"):
        _ = notebook.cells


# ---- refusals


def half(data):
    return data[: len(data) // 2]


def with_cells(cells, **others):
    return json.dumps(
        {"cells": cells, "nbformat": 4, "nbformat_minor": 5, "metadata": {}, **others}
    ).encode()


CODE = {"cell_type": "code", "source": "", "metadata": {}, "outputs": [], "execution_count": None}


@pytest.mark.parametrize(
    "data, why",
    [
        (b"", "empty"),
        (b" \n", "empty"),
        (half(GOOD), "not well-formed JSON"),
        (b"PK\x03\x04 another format", "not well-formed JSON"),
        (b"\n<!DOCTYPE html><title>Log in</title>", "a web page"),
        (b'{"cells": [\n<<<<<<< HEAD\n', "a merge conflict"),
        (b"[]", "no cells"),
        (b'{"nbformat": 4}', "no cells"),
        (b'{"cells": {}, "nbformat": 4}', "not a list"),
        (with_cells([1]), "one of its cells is malformed"),
        (with_cells([CODE | {"source": 3}]), "source of one of its cells"),
        (with_cells([CODE | {"source": [["a"]]}]), "source of one of its cells"),
        (with_cells([CODE | {"source": "\ud800"}]), "an incomplete character"),
        (with_cells([], nbformat=2), "version 2"),
        (with_cells([], nbformat=5), "version 5"),
        (with_cells([], nbformat=[4]), "version"),
        (GOOD.replace(b"{", b'{"cells": [], ', 1), "key appears twice"),
        (GOOD.decode().encode("utf-16"), "UTF-16"),
        (with_cells([CODE | {"source": "é"}]).replace(rb"\u00e9", "é".encode("latin-1")), "UTF-8"),
        (b'{"cells": ' + b"[" * 100_000 + b"]" * 100_000 + b"}", "nested too deeply"),
        (with_cells([]).replace(b"[]", b"[" + b"9" * 10_000 + b"]"), "not well-formed"),
        (with_cells([CODE] * (intake.MOST_CELLS + 1)), "1001 cells"),
        (with_cells([CODE | {"source": "#" * (intake.MOST_CODE + 1)}]), "code is longer"),
        (b" " * (intake.MOST_BYTES + 1), "larger than 20 MB"),
        (
            with_cells([]).replace(b"[]", b"[" + b"0," * intake.MOST_VALUES + b"0]"),
            "has more than",
        ),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_what_is_no_notebook_is_refused_by_name(folder, data, why):
    (folder / "stranger").mkdir()
    (folder / "stranger" / "turns.ipynb").write_bytes(data)
    refused = the_refused(folder)
    assert list(refused) == ["stranger/turns.ipynb"] and why in refused["stranger/turns.ipynb"]


def test_other_files_are_refused_by_name_and_litter_is_not_mentioned(folder):
    for name in (
        "answers.pdf",
        "answers.zip",
        "turns.ipynb.exe",
        "figure.png",
        ".DS_Store",
        "._turns.ipynb",
    ):
        (folder / "neighbour" / name).write_bytes(b"x")
    checkpoints = folder / "neighbour" / ".ipynb_checkpoints"
    checkpoints.mkdir()
    (checkpoints / "turns-checkpoint.ipynb").write_bytes(GOOD)
    assert sorted(the_refused(folder)) == [
        "neighbour/answers.pdf",
        "neighbour/answers.zip",
        "neighbour/turns.ipynb.exe",
    ]


def test_links_and_channels_are_refused_and_not_followed(folder, tmp_path):
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "turns.ipynb").write_bytes(GOOD)
    mine = folder / "stranger"
    mine.mkdir()
    (mine / "file.ipynb").symlink_to(elsewhere / "turns.ipynb")
    (mine / "folder").symlink_to(elsewhere)
    (folder / "student").symlink_to(elsewhere)
    os.mkfifo(mine / "channel.ipynb")
    assert {name: why.split(".")[0] for name, why in the_refused(folder).items()} == {
        "stranger/channel.ipynb": "This is a device or a pipe, not a file",
        **dict.fromkeys(
            ("stranger/file.ipynb", "stranger/folder", "student"),
            "This is a link, which we did not follow",
        ),
    }


def test_a_file_that_is_exchanged_for_a_link_meanwhile_is_not_read(folder, tmp_path, monkeypatch):
    (tmp_path / "secret.ipynb").write_bytes(GOOD)
    (folder / "stranger").mkdir()
    changing = folder / "stranger" / "turns.ipynb"
    changing.write_bytes(GOOD)
    honest = intake.Layout

    def exchange(*arguments):
        changing.unlink()
        changing.symlink_to(tmp_path / "secret.ipynb")
        return honest(*arguments)

    monkeypatch.setattr(intake, "Layout", exchange)
    assert "cannot read" in the_refused(folder)["stranger/turns.ipynb"]


def test_folders_nested_without_end_are_left_alone(folder):
    deep = folder / "stranger" / "/".join("d" * (intake.DEEPEST + 3))
    deep.mkdir(parents=True)
    (deep / "turns.ipynb").write_bytes(GOOD)
    assert list(the_refused(folder).values()) == ["Its folders are nested too deeply."]


def test_names_that_are_no_text_are_shown(folder):
    (folder / "stranger").mkdir()
    with open(os.fsencode(folder / "stranger") + b"/\xff.ipynb", "wb") as file:
        file.write(b"")
    assert the_refused(folder) == {"stranger/\\xff.ipynb": "The file is empty."}


# ---- archives


@pytest.mark.parametrize(
    "name",
    [
        "../turns.ipynb",
        "a/../../turns.ipynb",
        "/turns.ipynb",
        "..\\turns.ipynb",
        "\\turns.ipynb",
        "C:turns.ipynb",
        "a/..\\b.ipynb",
    ],
)
def test_paths_that_lead_out_of_an_archive_are_refused(tmp_path, name):
    refused = the_refused(archive(tmp_path / "class.zip", (name, GOOD)))
    assert refused == {name.replace("\\", "/"): "Its path leads out of the archive."}
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["class.zip"]


def test_a_link_in_an_archive_is_refused(tmp_path):
    link = zipfile.ZipInfo("stranger/turns.ipynb")
    link.external_attr = (stat.S_IFLNK | 0o777) << 16
    assert (
        "link"
        in the_refused(archive(tmp_path / "class.zip", (link, "/etc/passwd")))[
            "stranger/turns.ipynb"
        ]
    )


@pytest.mark.filterwarnings("ignore:Duplicate name")
def test_a_name_that_is_there_twice_is_refused(tmp_path):
    twice = ("stranger/turns.ipynb", GOOD)
    refused = the_refused(archive(tmp_path / "class.zip", twice, twice))
    assert set(refused.values()) == {"The archive contains this name more than once."}


def test_an_archive_that_unpacks_to_far_more_is_refused(tmp_path):
    path = archive(
        tmp_path / "class.zip", (("stranger/turns.ipynb", b" " * (intake.MOST_BYTES + 1)))
    )
    assert path.stat().st_size < 100_000
    assert "larger than 20 MB" in the_refused(path)["stranger/turns.ipynb"]


def test_an_archive_that_lies_about_sizes_is_refused(tmp_path):
    path = archive(tmp_path / "class.zip", ("stranger/turns.ipynb", b" " * 3_000_000))
    data = path.read_bytes()
    assert data.count(struct.pack("<I", 3_000_000)) == 2
    path.write_bytes(data.replace(struct.pack("<I", 3_000_000), struct.pack("<I", 1_000)))
    assert "cannot unpack" in the_refused(path)["stranger/turns.ipynb"]


def test_damaged_and_locked_entries_are_refused(tmp_path):
    path = archive(tmp_path / "class.zip", ("stranger/turns.ipynb", os.urandom(2_000)))
    data = bytearray(path.read_bytes())
    data[data.index(b"stranger/turns.ipynb") + 500] ^= 0xFF
    path.write_bytes(data)
    assert "cannot unpack" in the_refused(path)["stranger/turns.ipynb"]
    path = archive(tmp_path / "locked.zip", ("stranger/turns.ipynb", GOOD))
    data = bytearray(path.read_bytes())
    data[data.index(b"PK\x01\x02", data.index(b"PK\x01\x02") + 1) + 8] |= 1
    path.write_bytes(data)
    assert "password" in the_refused(path)["stranger/turns.ipynb"]


def test_all_of_an_archive_together_is_bounded(tmp_path, monkeypatch):
    monkeypatch.setattr(intake, "MOST_UNPACKED", len(GOOD) + 10)
    refused = the_refused(archive(tmp_path / "class.zip", ("stranger/turns.ipynb", GOOD)))
    assert "We did not read this file" in refused["stranger/turns.ipynb"]


def test_what_is_no_archive_is_said(tmp_path):
    (tmp_path / "class.zip").write_bytes(b"no archive")
    with pytest.raises(intake.Unfit, match="not a zip archive"):
        intake.take_in(tmp_path / "class.zip")
    with pytest.raises(intake.Unfit, match="does not exist"):
        intake.take_in(tmp_path / "class")


# ---- encodings and sizes


def test_a_mark_of_byte_order_is_read():
    cells, _ = intake.read_notebook(codecs.BOM_UTF8 + GOOD)
    assert cells == intake.read_notebook(GOOD)[0]


def test_of_a_large_archive_little_is_held(box):
    """Only names and positions of files grow with the class; those of 100,000 fit any machine."""
    number, data = 1_000, nbformat.writes(notebook(["check('turns/sum', 1)"]))
    with zipfile.ZipFile(box, "w") as opened:
        for order in range(number):
            opened.writestr(f"student-{order:06}/turns.ipynb", data)
    intake.take_in(box, ["turns"])  # Fill the caches once.
    for _ in range(3):  # Other threads, from earlier tests, can only add to it.
        tracemalloc.start()
        try:
            notebooks, refused = intake.take_in(box, ["turns"])
            held, most = tracemalloc.get_traced_memory()
        finally:
            tracemalloc.stop()
        assert len(notebooks) == number and refused == []
        if held / number < 3_000 and most / number < 4_000:
            break
    else:
        pytest.fail(f"{held / number:.0f} and at most {most / number:.0f} bytes each")
    assert notebooks[-1].cells[0]["source"] == "check('turns/sum', 1)"


# ---- which notebook counts


@pytest.fixture
def course(tmp_path):
    return Course(write_sources(tmp_path / "solutions"))


def sorted_work(folder, course):
    notebooks, _ = intake.take_in(folder, course.assignments)
    work, refused, _ = pair(notebooks, [], course, Term(), Store(folder))
    return {
        (entry.student, entry.assignment): (
            [notebook.file for notebook in entry.notebooks],
            [notebook.file for notebook in entry.superseded],
        )
        for entry in work
    }, refused


def test_the_newest_of_several_counts(folder, course):
    older = folder / "neighbour" / "a turns.ipynb"
    older.write_bytes(GOOD)
    os.utime(older, (1, 1))
    work, _ = sorted_work(folder, course)
    assert work == {
        ("neighbour", "turns"): (["neighbour/turns.ipynb"], ["neighbour/a turns.ipynb"])
    }


def test_a_number_that_canvas_put_there_says_which_is_newer(tmp_path, course):
    path = tmp_path / "class.zip"
    with zipfile.ZipFile(path, "w") as box:
        for name in ("turns-2", "turns", "turns-10"):
            box.writestr(f"student_7_8_{name}.ipynb", GOOD)
    work, _ = sorted_work(path, course)
    assert work["student_7", "turns"][0] == ["student_7_8_turns-10.ipynb"]


def test_an_assignment_in_several_notebooks_is_one(folder, tmp_path, course):
    (folder / "neighbour" / "axes.ipynb").write_bytes(nbformat.writes(handed_in("axes")).encode())
    both = Course(
        tmp_path / "solutions", Term(assignments={"homework": Assignment(("turns", "axes"))})
    )
    assert sorted_work(folder, both)[0] == {
        ("neighbour", "homework"): (["neighbour/axes.ipynb", "neighbour/turns.ipynb"], [])
    }
    assert sorted(sorted_work(folder, course)[0]) == [("neighbour", "axes"), ("neighbour", "turns")]


@pytest.mark.parametrize(
    "name, cells, expected",
    [
        ("any.ipynb", ["check('turns/sum', 1)"], "turns"),
        (
            "any.ipynb",
            ['check( "axes/angle" ,\n 1)', "check('turns/sum', 1)", "check('axes/length', 1)"],
            "axes",
        ),
        ("turns final.ipynb", ["A_C_N = 1"], "turns"),
        ("any.ipynb", ["A_C_N = 1"], None),
        ("any.ipynb", ["check('turns/nothing', 1)"], None),
    ],
)
def test_which_assignment_a_notebook_is(folder, course, name, cells, expected):
    (folder / "stranger").mkdir()
    (folder / "stranger" / name).write_text(nbformat.writes(notebook(cells)))
    work, refused = sorted_work(folder, course)
    assert [assignment for student, assignment in work if student == "stranger"] == (
        [expected] if expected else []
    )
    assert [refusal.file for refusal in refused] == ([] if expected else [f"stranger/{name}"])


def test_nbgraders_names_tell_the_assignment_where_the_checks_are_gone(folder, course):
    made = notebook(["A_C_N = 1"])
    made.cells[0].metadata["nbgrader"] = {"grade_id": "axes-angle", "schema_version": 3}
    (folder / "stranger").mkdir()
    (folder / "stranger" / "any.ipynb").write_text(nbformat.writes(made))
    assert ("stranger", "axes") in sorted_work(folder, course)[0]


def test_the_names_of_questions_are_found_without_running_a_solution(tmp_path):
    solutions = write_sources(
        tmp_path / "solutions", [("import sympy as sm", "import sympy as sm\nraise SystemExit")]
    )
    assert Course(solutions).names == {
        "turns": ["turns/about-x", "turns/sum", "turns/doubled"],
        "axes": ["axes/angle", "axes/length"],
    }
