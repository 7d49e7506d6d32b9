"""Questions of an exam: only the grader, and nothing students have, shows what is right."""

import io
import json

import pytest
import sympy as sm
from grading_class import notebook, put
from trial_course import SETUP, SOLUTION, made_in, write_source

from coursework.authoring import release, selftest
from coursework.checking import check as checks
from coursework.checking import questions
from coursework.grading.grade import grade
from coursework.grading.store import Store

pytestmark = pytest.mark.usefixtures("libraries_are_loaded_once")

HIDDEN = """### BEGIN HIDDEN TESTS
question('trial/about-x', kind='rotation matrix', frames=('A', 'N'), symbols='theta',
         turns=[('x', theta)], worth=2, exam=True, credit={'transposed': 0.5},
         hints={'transposed': ['Which way round?']},
         solution='The axis is shared.')
### END HIDDEN TESTS"""
theta = sm.symbols("theta")
RIGHT = sm.Matrix(
    [[1, 0, 0], [0, sm.cos(theta), sm.sin(theta)], [0, -sm.sin(theta), sm.cos(theta)]]
)


def released(folder, solution=SOLUTION, hidden=HIDDEN):
    folder.mkdir(exist_ok=True)
    write_source(
        folder / "sources",
        ("code", SETUP),
        ("code", solution),
        ("code", f"check('trial/about-x', A_C_N)\n{hidden}"),
    )
    course = made_in(folder)
    release.release(course, run=False)
    return course


@pytest.fixture
def exam(tmp_path, monkeypatch):
    course = released(tmp_path)
    monkeypatch.chdir(course.exercises)
    (course.exercises / "sealed").symlink_to(course.sealed)
    questions.notebook_questions.cache_clear()
    yield course
    questions.notebook_questions.cache_clear()


def test_what_students_receive_would_be_the_same_with_another_answer(tmp_path):
    other = SOLUTION.replace("[0, -working", "[0, 0*working").replace(
        "[0, sm.cos(theta), working]", "[0, 1, 0*theta]"
    )
    assert other != SOLUTION
    plain = HIDDEN.replace("turns=[('x', theta)],", "")
    first, second = (
        (released(tmp_path / name, solution, plain).sealed / "trial.json").read_bytes()
        for name, solution in (("first", SOLUTION), ("second", other))
    )
    assert first == second
    (sealed,) = json.loads(first)["questions"].values()
    assert (
        sealed["exam"]
        and sealed["lockers"] == ""
        and not {"pages", "ladder", "every symbol"} & set(sealed)
    )
    # With a check, the same question has a different file for another answer.
    local = plain.replace("exam=True, ", "")
    assert (
        len(
            {
                (released(tmp_path / f"{n}", solution, local).sealed / "trial.json").read_bytes()
                for n, solution in enumerate((SOLUTION, other))
            }
        )
        == 2
    )


def test_the_check_takes_an_answer_down_and_tells_nothing_of_it(exam):
    replies = [
        checks.check("trial/about-x", answer)
        for answer in (RIGHT, RIGHT.T, RIGHT.subs(theta, 2 * theta))
    ]
    assert {reply.outcome for reply in replies} == {"recorded"}
    # The answer as read is the student's own.
    assert len({str(reply).partition("\nWe read: ")[0] for reply in replies}) == 1
    assert "marked later" in replies[0].messages[0]
    assert checks.check("trial/about-x", 2 * RIGHT).outcome == "invalid"
    assert checks.check("trial/about-x", ...).outcome == "not attempted"
    assert checks.check("trial/about-x", RIGHT).outcome == "recorded"
    assert "Recorded, to be marked later: trial/about-x" in str(checks.progress())
    assert "no hint" in str(checks.hint("trial/about-x"))


def test_the_selftest_is_content_and_finds_nothing_to_guess(exam):
    finding = selftest.try_question(
        release.read_source(exam.sources / "trial.ipynb").questions["trial/about-x"]
    )
    assert finding.faults == [] and finding.possible is None
    assert [note for note, _ in finding.mistakes if note == "transposed"]


def test_the_grader_marks_what_the_check_only_took_down(exam, tmp_path):
    for student, answer in (("right", RIGHT), ("turned", RIGHT.T), ("wrong", sm.eye(3))):
        cells = [
            SETUP,
            f"A_C_N = sm.sympify({str(answer.tolist())!r})",
            "check('trial/about-x', A_C_N)",
        ]
        put(tmp_path / "handed-in", student, notebook(cells), "trial.ipynb")
    grade(tmp_path / "handed-in", tmp_path / "out", solutions=exam.sources, show=io.StringIO())
    marks = {
        record.student: record.marks["trial/about-x"] for record in Store(tmp_path / "out").all()
    }
    assert [(marks[name].outcome, marks[name].points) for name in ("right", "turned", "wrong")] == [
        ("correct", 2),
        ("wrong", 1),
        ("wrong", 0),
    ]


#: A function that searches the frames of all its callers.
LOOKING = """
import sys
seen = []
def twice(x):
    frame = sys._getframe(1)
    while frame:
        seen.append(repr([(name, value, getattr(value, 'job', '')) for name, value in
                          frame.f_locals.items()]))
        frame = frame.f_back
    return 2*x
"""


def test_a_function_finds_in_its_callers_frames_only_what_the_exam_gave_it(tmp_path):
    """Students' sealed file has the check's calls, and the notebook's process no others.

    It receives others only when it can no longer hand in an answer.
    """
    folder = tmp_path / "course"
    folder.mkdir()
    hidden = "### BEGIN HIDDEN TESTS\nquestion('trial/{}', {}, exam=True)\n### END HIDDEN TESTS"
    calls = "kind='function', calls=[[1.25], [-2.75]], result='expression', worth=2"
    text = "kind='free text'"
    solution = "### BEGIN SOLUTION\n{}\n### END SOLUTION"
    write_source(
        folder / "sources",
        ("code", SETUP),
        ("code", solution.format("def twice(x):\n    return 2*x")),
        ("code", f"check('trial/twice', twice)\n{hidden.format('twice', calls)}"),
        ("code", solution.format("what = 'Nothing.'")),
        ("code", f"check('trial/what', what)\n{hidden.format('what', text)}"),
    )
    course = made_in(folder)
    release.release(course, run=False)
    (sealed,) = course.sealed.glob("*.json")
    assert "1.25" in sealed.read_text("utf8") and "-2.75" in sealed.read_text("utf8")
    cells = [SETUP, LOOKING, "check('trial/twice', twice)"]
    numbers = r"sorted(set(re.findall(r'-?\d+\.\d+', ' '.join(seen))))"
    cells.append(f"import re\nwhat = ' '.join({numbers})[:2000]\ncheck('trial/what', what)")
    put(tmp_path / "handed-in", "ada", notebook(cells), "trial.ipynb")
    grade(tmp_path / "handed-in", tmp_path / "out", solutions=course.sources, show=io.StringIO())
    record = Store(tmp_path / "out").read("ada", "trial")
    seen = record.answer("trial/what").plain["value"][1]
    assert record.marks["trial/twice"].outcome == "correct"
    (questions_of,) = (tmp_path / "out" / "questions").glob("trial-*.json")
    (about,) = json.loads(questions_of.read_text("utf8"))["trial/twice"]
    assert "1.25" in seen and about["secret"]["calls"]
    for ((argument,),) in zip(about["secret"]["calls"], strict=True):
        assert str(argument) not in seen
