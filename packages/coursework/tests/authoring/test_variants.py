"""Variants of a question: drawn by rule, sealed one by one, and found without a server."""

import base64
import copy
import csv
import itertools
import json
import re
import shutil
import zipfile
from dataclasses import replace

import nbformat
import pytest
import sympy
from quick_keys import keys_are_quick  # noqa: F401
from trial_course import made_in, write_source

import coursework
from coursework.authoring.author import AuthorError, solution_code
from coursework.authoring.course import find_course
from coursework.authoring.packing import archive
from coursework.authoring.release import LEFT_OPEN, release
from coursework.authoring.source import read_source
from coursework.authoring.variation import Rule, drawn_in, written
from coursework.checking import check as check_module
from coursework.checking import identity, progress, questions, sealing, variants
from coursework.checking.plain import to_plain
from coursework.checking.question import Question, Sealed, Variant
from coursework.checking.reply import Reply
from coursework.grading.grade import grade
from coursework.grading.judging import marking
from coursework.grading.record import Answer, Remembered
from coursework.grading.running import Running
from coursework.grading.store import feedback_of
from coursework.grading.submissions import intake

NAME = "levers/see-saw"
TEXT = (
    "## See-saw\n\nA force of ${{force}}$ N acts ${{arm}}$ m from the hinge. Give its moment as "
    "`moment`, in N m."
)
SOLVED = "### BEGIN SOLUTION\nmoment = lever.force * lever.arm\n### END SOLUTION"
DRAWN = (
    "### BEGIN VARIANTS\n"
    "lever = draw('levers/see-saw', count=6, force=[20, 30, 45, 65], arm=[2, 3, 7])\n"
    "### END VARIANTS"
)
CHECKED = (
    "check('levers/see-saw', moment)\n"
    "### BEGIN HIDDEN TESTS\n"
    "question('levers/see-saw', kind='expression', ladder=['Draw it.'],\n"
    "mistakes={'Force and arm are multiplied, not "
    "added.': lever.force + lever.arm}, solution=f'It is ${lever.force} \\\\cdot {lever.arm}$.')\n"
    "### END HIDDEN TESTS"
)
CELLS = [
    ("markdown", "# Levers"),
    ("code", "from coursework import check, student, variant\nstudent('')"),
    ("code", DRAWN),
    ("markdown", TEXT),
    ("code", SOLVED),
    ("code", CHECKED),
    ("markdown", "## Plain"),
    ("code", "### BEGIN SOLUTION\nplain = 7\n### END SOLUTION"),
    (
        "code",
        "check('levers/plain', plain)\n### BEGIN HIDDEN TESTS\n"
        "question('levers/plain', kind='expression')\n"
        "### END HIDDEN TESTS",
    ),
]


@pytest.fixture(autouse=True)
def nobody_is_kept(monkeypatch, tmp_path):
    """Keep neither who works in a test nor what it read, so that the next test finds none."""
    monkeypatch.setattr(identity, "KEPT", tmp_path / "no" / "such" / "me.txt")
    questions.notebook_questions.cache_clear()
    yield
    coursework.student("")
    questions.notebook_questions.cache_clear()


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


def student_with(number, count=6):
    students = (f"{k}@uni.example" for k in range(999))
    return next(
        student for student in students if variants.variant_of(student, NAME, count) == number
    )


@pytest.mark.sampled(2)
@pytest.mark.parametrize("number", range(6))
def test_each_variant_has_its_own_text_numbers_and_answer(beside, course, number):
    coursework.student(student_with(number) if number else "")
    lever = coursework.variant("levers/see-saw")
    text = f"## See-saw\n\nA force of {lever.force} N acts {lever.arm} m from the hinge. "
    text += "Give its moment as moment, in N m."
    # Students without an ID are told so where they would enter it, and nowhere else.
    assert repr(lever) == text
    assert coursework.check("levers/see-saw", lever.force * lever.arm).outcome == "correct"
    assert "not added" in coursework.check("levers/see-saw", lever.force + lever.arm).messages[0]
    assert coursework.check("levers/plain", 7).outcome == "correct"  # a question without variants


@pytest.mark.parametrize("roster", [False, True])
def test_a_notebook_asks_for_an_id_where_the_course_has_a_roster(tmp_path, roster):
    """It says once what forgetting it means; students without a course never see it."""
    made = made_in(tmp_path)._replace(roster=roster)
    write_source(made.sources, *CELLS, name="levers")
    release(made, variants=[])
    text = (made.exercises / "levers.ipynb").read_text("utf8")
    first = next(cell for cell in json.loads(text)["cells"] if cell["cell_type"] == "code")
    assert first["source"][-1] == ("student('')" if roster else LEFT_OPEN)
    assert text.count("default numbers") == roster


@pytest.mark.parametrize(("value", "roster"), [("true", True), ("false", False), ("'yes'", None)])
def test_whether_there_is_a_roster_is_true_or_false(tmp_path, value, roster):
    (tmp_path / "course.toml").write_text(f"roster = {value}\n")
    if roster is None:
        with pytest.raises(AuthorError, match="set roster = true or leave it out; it is 'yes'"):
            find_course(tmp_path)
    else:
        assert find_course(tmp_path).roster is roster


def test_a_classmates_answer_is_told_before_it_costs_anything(recorded, course):
    """Copied, or computed with the default numbers, it is no help, is no try and earns no hint."""
    lever = coursework.variant(NAME)
    for other in (number for number in range(6) if number != 2):
        given = read_source(course.sources / "levers.ipynb", other).questions[NAME].public.given
        reply = coursework.check(NAME, given["force"] * given["arm"])
        assert (reply.outcome, reply.note) == ("wrong", "other numbers")
        assert reply.messages == [questions.FOR_OTHERS] and reply.tries == 0
    assert coursework.check(NAME, 1234567).note == ""
    right = coursework.check(NAME, lever.force * lever.arm)
    assert right.outcome == "correct" and not right.help and not right.sibling
    others = json.loads((course.sealed / "levers.json").read_text("utf8"))["questions"][NAME][
        "others"
    ]
    assert len(base64.b85decode(others[1])) % (8 * sealing.NAME) == 0


EDITIONS = [{0: (20, 2), 1: (30, 3), 2: (45, 7)}, {0: (20, 2), 1: (45, 7), 2: (65, 9)}]
NUMBERS = {"": 0, "ada": 1, "eda": 2, "ida": 1}


@pytest.mark.parametrize("first", ["answer", "slip", *NUMBERS])
def test_in_whatever_order_one_says_who_one_is_nothing_is_lost_and_nothing_said_of_others(
    first, monkeypatch, tmp_path
):
    """Try all orders of answers, editions and IDs (one mistyped, one with the same numbers)."""
    monkeypatch.setattr(progress, "KEPT", tmp_path / "progress.json")

    def question():
        number = NUMBERS[who]
        force, arm = EDITIONS[edition][number]
        return Sealed(
            Question("expression", variant=Variant(number, 3, {"force": force, "arm": arm}))
        )

    def judged(name, sealed, plain, student):
        given = sealed.question.given
        right = plain["nodes"][-1][-1] == str(given["force"] * given["arm"])
        reply = Reply(name, *(("correct",) if right else ("wrong", "added")))
        reply.answer = str(plain)[-12:]
        return reply

    monkeypatch.setattr(check_module, "find_question", lambda name, student: question())
    monkeypatch.setattr(check_module, "judge", judged)
    monkeypatch.setattr(check_module, "identity", lambda: who)
    monkeypatch.setattr(
        check_module,
        "own_numbers",
        lambda name, student: (
            NUMBERS[who],
            variants.names_of_variants([question().question.variant])[0],
        ),
    )
    others = [step for step in ["answer", "slip", "ada", "eda", "ida", "edition"] if step != first]
    for steps in itertools.permutations(others, 3):
        (tmp_path / "progress.json").unlink(missing_ok=True)
        who, edition, right, slips = "", 0, set(), set()
        for step in [first, *steps, "answer", "ada"]:
            numbers = EDITIONS[edition][NUMBERS[who]]
            if step in NUMBERS:
                who = step
            elif step == "edition":
                edition = 1
            elif step == "slip":
                coursework.check(NAME, sum(numbers))
                slips.add(numbers)
            else:
                reply = coursework.check(NAME, numbers[0] * numbers[1])
                right.add(numbers)
                assert reply.outcome == "correct" and reply.tries == 1 + (numbers in slips), steps
            # Read the file again each time, as after a reload.
            own = EDITIONS[edition][NUMBERS[who]]
            kept = progress.Progress.read().entry(NAME)
            assert sum(entry.outcome == "correct" for entry in (kept, *kept.others)) == len(
                right
            ), steps
            said = repr(check_module.progress())
            assert (": 1 right" in said) == (own in right), (steps, step, said)
            assert ("not yet with yours" in said) == bool(right - {own} and own not in right), (
                steps,
                step,
                said,
            )


def test_how_many_pages_there_are_tells_no_variant_from_another(course, tmp_path):
    made = made_in(tmp_path)
    told = CHECKED.replace(
        "mistakes={", "mistakes={'Where is the arm?': lever.force + (lever.arm > 2), "
    )
    assert told != CHECKED
    write_source(made.sources, *CELLS[:5], ("code", told), name="levers")
    release(made, run=False)
    first, *rest = (
        json.loads(path.read_text("utf8"))["questions"][NAME]
        for path in [
            made.sealed / "levers.json",
            *sorted((made.sealed / "variants").glob("levers-*.json")),
        ]
    )
    assert len(first["pages"]) % 4 == 0 and len({len(question["pages"]) for question in rest}) == 1
    known = [
        read_source(made.sources / "levers.ipynb", number).questions[NAME] for number in range(1, 6)
    ]
    # Otherwise this would prove nothing.
    assert len({len(question.entries) for question in known}) > 1
    # Nobody can identify the empty ones by making them again from the data that students have.
    for question in (first, *rest):
        pages = question["pages"]
        for count in range(1, len(pages)):
            for public in (NAME, question["salt"], first["salt"], "".join(pages[:count])):
                made_anew = sealing.pages_filled_up(pages[:count], len(pages), public)
                assert made_anew[count:] != pages[count:], (count, public)


def test_the_exercise_notebook_shows_the_variant_and_hides_the_rule(course):
    sources = [
        cell.source for cell in nbformat.read(course.exercises / "levers.ipynb", as_version=4).cells
    ]
    assert sources[2] == 'lever = variant("levers/see-saw")\nlever' and sources[3].startswith(
        "moment = ..."
    )
    assert "draw" not in "".join(sources) and "{{" not in "".join(sources)


def test_every_combination_is_drawn_once():
    drawn = [
        json.dumps(Rule("a/b", 12, {"x": range(3), "y": range(4)}).parameters(number))
        for number in range(12)
    ]
    assert len(set(drawn)) == 12 and drawn[0] == '{"x": 0, "y": 0}'


def test_empty_lockers_are_like_the_others_and_come_again(course):
    """A second release gives the same; all that the first one sealed opens as before."""
    known = sorted(course.sealed.rglob("*.json"))
    before = {path: path.read_bytes() for path in known}
    release(course, run=False)
    assert {path: path.read_bytes() for path in known} == before
    about = json.loads((course.sealed / "levers.json").read_text("utf8"))["questions"][NAME]
    data = base64.b85decode(about["lockers"])
    assert len({data[start : start + 16] for start in range(0, len(data), 16)}) == sealing.count_of(
        about["lockers"]
    )


def test_answers_to_another_students_numbers_earn_nothing_and_are_flagged(course, tmp_path):
    contracts = marking.load_questions([course.sources / "levers.ipynb"], tmp_path, b"any secret")
    assert len(contracts[NAME]) == 6 and len(contracts["levers/plain"]) == 1
    for number in (0, 4):
        own, _ = marking.of_student(contracts, student_with(number))
        for other in range(6):
            given = read_source(course.sources / "levers.ipynb", other).questions[NAME].public.given
            plain = to_plain(given["force"] * given["arm"])
            mark = marking.mark(NAME, own[NAME], Answer("recorded", plain))
            expected = ("correct", "", 1) if other == number else ("wrong", "other numbers", 0)
            assert (mark.outcome, mark.note, mark.points) == expected
        plain = Answer("recorded", to_plain(7))
        assert marking.mark("levers/plain", own["levers/plain"], plain).points == 1
        assert (
            marking.asked_of_sandbox(marking.with_second_chances(own))[NAME]["given"]
            == own[NAME].contract.question.given
        )


def test_a_known_mistake_is_named_also_where_it_is_right_for_other_numbers(tmp_path):
    """It once counted as a copy, so a mistake with partial credit earned nothing."""
    changed = {
        DRAWN: DRAWN.replace("count=6, force=[20, 30, 45, 65]", "count=2, force=[20]").replace(
            "arm=[2, 3, 7]", "arm=[2, 4]"
        ),
        CHECKED: CHECKED.replace("ladder=", "credit={'double': 0.5}, ladder="),
    }
    path = write_source(
        tmp_path, *((kind, changed.get(text, text)) for kind, text in CELLS), name="levers"
    )
    first, second = marking.load_questions([path], tmp_path, b"any secret")[NAME]
    marks = [
        marking.mark(NAME, marking.Asked(own, siblings=(other,)), Answer("recorded", to_plain(80)))
        for own, other in ((first, second), (second, first))
    ]
    assert {(mark.outcome, mark.note, mark.points) for mark in marks} == {
        ("wrong", "double", 0.5),
        ("correct", "", 1),
    }


# --- siblings: other numbers after help ----------------------------------------------------------


@pytest.fixture
def recorded(beside, monkeypatch, tmp_path):
    monkeypatch.setattr(progress, "KEPT", tmp_path / ".coursework" / "progress.json")
    coursework.student(student_with(2))


def test_who_had_a_mistake_named_is_offered_a_sibling_with_other_numbers(recorded):
    lever = coursework.variant(NAME)
    assert coursework.check(NAME, lever.force + lever.arm).outcome == "wrong"
    right = coursework.check(NAME, lever.force * lever.arm)
    assert right.outcome == "correct" and right.help == "mistake"
    assert "we named your mistake" in right.messages[0] and f"variant('{NAME}/sibling')" in repr(
        right
    )
    assert (
        right.sibling == f"{NAME}/sibling"
        and f'data-sibling="{NAME}/sibling"' in right._repr_html_()
    )
    twin = coursework.variant(f"{NAME}/sibling")
    assert (twin.force, twin.arm) != (lever.force, lever.arm)
    # With a mistake in the first sibling, too, there is one more, and no third.
    coursework.check(f"{NAME}/sibling", twin.force + twin.arm)
    assert f"check('{NAME}/sibling-2'" in repr(
        coursework.check(f"{NAME}/sibling", twin.force * twin.arm)
    )
    last = coursework.variant(f"{NAME}/sibling-2")
    alone = coursework.check(f"{NAME}/sibling-2", last.force * last.arm)
    assert alone.outcome == "correct" and not alone.help
    assert "a sibling earns" not in repr(
        coursework.progress()
    ) and "You have tried 1 question: 1 right" in repr(coursework.progress())
    with pytest.raises(
        questions.NoSuchQuestion,
        match="the siblings of 'levers/see-saw' are levers/see-saw/sibling and",
    ):
        coursework.check(f"{NAME}/sibling-3", 1)
    with pytest.raises(questions.NoSuchQuestion, match="has only one set of numbers"):
        coursework.variant("levers/plain/sibling")


@pytest.mark.parametrize("way", ["hint", "solution"])
def test_hints_and_the_worked_solution_are_help(recorded, course, way):
    lever = coursework.variant(NAME)
    if way == "hint":
        for wrong in (11, 12, 13):
            coursework.check(NAME, wrong)
    else:
        code = solution_code(nbformat.read(course.sources / "levers.ipynb", as_version=4))
        assert f"{NAME}/sibling" in repr(coursework.worked_solution(NAME, code))
    assert coursework.check(NAME, lever.force * lever.arm).help == way


def test_the_grader_counts_a_sibling_that_was_solved_without_help(course, tmp_path):
    contracts = marking.load_questions([course.sources / "levers.ipynb"], tmp_path, b"any secret")
    own, _ = marking.of_student(contracts, student_with(5))
    chances = own[NAME].second_chances
    assert [contract.variant.number for contract in chances.values()] == [0, 1]
    right = {
        name: Answer("recorded", to_plain(given["force"] * given["arm"]))
        for name, contract in {NAME: own[NAME].contract, **chances}.items()
        for given in [contract.question.given]
    }
    first, second = chances
    missing = Answer("missing")

    def marked(answers, **helped):
        remembered = {
            {"own": NAME, "first": first}[which]: Remembered(3, help=had)
            for which, had in helped.items()
        }
        return marking.mark_with_siblings(NAME, own[NAME], answers, remembered)

    # Help has no price unless an author sets one.
    mark = marked({NAME: right[NAME]}, own="mistake")
    assert (mark.points, mark.note, mark.messages) == (1, "with help", ())
    own[NAME] = replace(own[NAME], contract=replace(own[NAME].contract, credit={"help": 0.8}))
    for answers, helped, points, note in (
        ({NAME: right[NAME]}, {}, 1, ""),
        ({NAME: right[NAME]}, {"own": ""}, 1, ""),
        ({NAME: right[NAME]}, {"own": "mistake"}, 0.8, "with help"),
        ({NAME: right[NAME], first: right[first]}, {"own": "hint"}, 1, "by a sibling"),
        ({NAME: right[NAME], first: right[NAME]}, {"own": "hint"}, 0.8, "with help"),
        (
            {NAME: right[NAME], first: right[first]},
            {"own": "hint", "first": "mistake"},
            0.8,
            "with help",
        ),
        (right, {"own": "hint", "first": "mistake"}, 1, "by a sibling"),
        ({NAME: missing, first: right[first]}, {"own": "solution"}, 0, "by a sibling alone"),
        ({NAME: right[NAME], first: right[first]}, {"own": "solution"}, 1, "by a sibling"),
        ({NAME: missing}, {"own": "solution"}, 0, "missing"),
        # This is the answer of somebody whose own numbers are those of this student's third
        # sibling.
        (
            {NAME: right[NAME], f"{NAME}/sibling-3": right[second]},
            {"own": "hint"},
            0.8,
            "with help",
        ),
    ):
        mark = marked(answers, **helped)
        assert (mark.points, mark.note) == (points, note), (answers, helped)
    assert marked(right, own="mistake").tries == 3 and marked(right).tries is None
    asked = marking.asked_of_sandbox(marking.with_second_chances(own, {first}))
    assert (
        set(asked) == {NAME, "levers/plain", first}
        and asked[first]["given"] == chances[first].question.given
    )


def test_a_notebook_remembers_tries_and_help(recorded):
    lever = coursework.variant(NAME)
    shown = [
        coursework.check(NAME, lever.force + lever.arm),
        coursework.check(NAME, lever.force * lever.arm),
    ]
    cells = [
        nbformat.v4.new_code_cell(
            "check", outputs=[nbformat.v4.new_output("display_data", {"text/html": text})]
        )
        for text in [reply._repr_html_() for reply in shown]
        + ['<div class="coursework-reply" data-question="a" data-tries="x">']
    ]
    data = nbformat.writes(nbformat.v4.new_notebook(cells=cells)).encode()
    remembered = intake.remembered_in(data)
    assert remembered == {NAME: Remembered(2, "mistake")}
    assert (
        intake.remembered_in(b"{}") == {} and intake.remembered_in(b'\xff coursework-reply "') == {}
    )


@pytest.mark.usefixtures("libraries_are_loaded_once")
def test_from_the_students_notebook_to_the_report(recorded, course, tmp_path):
    """Three hand in: one right at once, one with help, and one with help and then a sibling."""
    solved = nbformat.read(course.exercises / "levers.ipynb", as_version=4)
    answer, check_cell = (
        next(c for c in solved.cells if word in c.source) for word in ("moment =", "check('lev")
    )
    answer.source = "moment = lever.force * lever.arm"
    students = {"ada": student_with(1), "ben": student_with(3), "eve": student_with(4)}
    for name, student in students.items():
        notebook = copy.deepcopy(solved)
        if name != "ada":
            coursework.student(student)
            given = coursework.variant(NAME)
            progress.KEPT.unlink(missing_ok=True)
            coursework.check(NAME, given.force + given.arm)
            reply = coursework.check(NAME, given.force * given.arm)
            cell = next(c for c in notebook.cells if c.source == check_cell.source)
            cell.outputs = [
                nbformat.v4.new_output(
                    "execute_result", {"text/html": reply._repr_html_()}, execution_count=1
                )
            ]
        if name == "eve":
            twin = (
                f"twin = variant('{NAME}/sibling')\ncheck('{NAME}/sibling', twin.force * twin.arm)"
            )
            notebook.cells.append(nbformat.v4.new_code_cell(twin))
        place = tmp_path / "handed-in" / student
        place.mkdir(parents=True)
        nbformat.write(notebook, place / "levers.ipynb")
    done = grade(
        tmp_path / "handed-in",
        tmp_path / "marks",
        solutions=course.sources,
        running=Running(workers=1),
    )
    assert done["graded"] == 3
    text = (tmp_path / "marks" / "grades.csv").read_text("utf8")
    rows = {row["student"]: row for row in csv.DictReader(text.splitlines())}
    assert [float(rows[student][NAME]) for student in students.values()] == [1, 1, 1]
    report = (tmp_path / "marks" / "report.html").read_text("utf8")
    assert "Tries" in report and "2 (2 at most, 2 known)" in report
    page = (tmp_path / "marks" / feedback_of(students["ben"], "levers")).read_text("utf8")
    assert "2 different answers, according to your notebook" in page


def test_an_edition_draws_afresh():
    rule = Rule("a/b", 4, {"x": range(1000), "y": lambda chance: chance.randint(0, 10**6)})
    first, exam = (
        [rule.parameters(number, edition) for number in range(4)] for edition in ("", "exam")
    )
    assert not [drawn for drawn in first if drawn in exam]
    assert first == [rule.parameters(number) for number in range(4)]


def test_salts_differ_so_that_a_guess_serves_one_variant(course):
    salts = [
        read_source(course.sources / "levers.ipynb", k).questions["levers/see-saw"].public.salt
        for k in range(6)
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
        again.sources,
        *((kind, text.replace("count=6", "count=3")) for kind, text, *_ in CELLS),
        name="levers",
    )
    release(again, run=False)
    assert sorted(path.name for path in (again.sealed / "variants").iterdir()) == [
        "levers-1.json",
        "levers-2.json",
        "levers-extra-5.json",
    ]


def test_variants_kept_from_another_machine_are_made_anew(tmp_path, monkeypatch):
    """Their pages continue those of the first variant, which differed on another machine."""
    made = made_in(tmp_path)
    solved = SOLVED.replace("moment =", "import os\nmoment = float(os.environ['MOVED_BY']) +")
    write_source(
        made.sources,
        *((kind, solved if text == SOLVED else text) for kind, text in CELLS),
        name="levers",
    )
    monkeypatch.chdir(tmp_path)
    for moved in (0, 1e-4):
        monkeypatch.setenv("MOVED_BY", str(moved))
        release(made, run=False)
        questions.notebook_questions.cache_clear()
        for number in range(6):
            coursework.student(student_with(number) if number else "")
            lever = coursework.variant(NAME)
            right = coursework.check(NAME, lever.force * lever.arm + moved)
            assert right.outcome == "correct"
            assert "not added" in coursework.check(NAME, lever.force + lever.arm).messages[0]


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("count=6", "count=13", "gave only 12 different variants, not 13"),
        ("lever = draw", "draw", "exactly one `name = draw"),
    ],
)
def test_an_author_is_told(tmp_path, old, new, says):
    path = write_source(
        tmp_path, *((kind, text.replace(old, new)) for kind, text, *_ in CELLS), name="levers"
    )
    with pytest.raises(AuthorError, match=says):
        read_source(path, 12)


def test_a_variant_is_taken_out_and_the_others_need_not_be_counted(tmp_path):
    """When the count was that of all combinations, excluding one left too few."""
    made = made_in(tmp_path)
    where = "count=12, where=lambda drawn: drawn != {'force': 30, 'arm': 3}"
    cells = [(kind, text.replace("count=6", where)) for kind, text, *_ in CELLS]
    write_source(made.sources, *cells, name="levers")
    release(made, run=False)
    sealed = json.loads((made.sealed / "levers.json").read_text("utf8"))["questions"]
    assert sealed["levers/see-saw"]["variants"] == 11


def test_a_variant_with_a_fault_is_named_with_its_numbers(tmp_path):
    """For 2 N at 2 m, the sum is the product, so a mistake gives that variant's answer."""
    made = made_in(tmp_path)
    drawn = (
        DRAWN.replace("20, 30, 45, 65", "3, 2")
        .replace("2, 3, 7", "3, 2")
        .replace("count=6", "count=4")
    )
    write_source(
        made.sources,
        *((kind, drawn if text == DRAWN else text) for kind, text, *_ in CELLS),
        name="levers",
    )
    with pytest.raises(
        AuthorError,
        match=r"levers/see-saw, variant \d, {'force': 2, 'arm': 2}: This authored mistake",
    ):
        release(made, run=False)


PICTURED = [
    ("markdown", "# Levers"),
    ("code", "from coursework import check, student, variant\nstudent('')"),
    (
        "code",
        "### BEGIN VARIANTS\n"
        "class Drawn:\n"
        "    def __init__(self, force):\n"
        "        self.alt = f'A beam & {force} arrows'\n"
        "    def picture(self):\n"
        "        return f'<svg width=\"9\">{self.alt}</svg>'\n"
        "\n"
        "\n"
        "lever = draw('levers/see-saw', count=3, force=[2, 5, 6], picture=lambda drawn: "
        "Drawn(drawn['force']))\n"
        "### END VARIANTS",
    ),
    ("markdown", "{{picture}}\n\nHow many arrows?"),
    ("code", "### BEGIN SOLUTION\nmoment = lever.force\n### END SOLUTION"),
    (
        "code",
        "check('levers/see-saw', moment)\n### BEGIN HIDDEN TESTS\n"
        "question('levers/see-saw', kind='expression')\n"
        "### END HIDDEN TESTS",
    ),
]


def test_a_picture_differs_from_variant_to_variant(tmp_path, monkeypatch):
    made = made_in(tmp_path)
    write_source(made.sources, *PICTURED, name="levers")
    release(made, run=False)
    monkeypatch.chdir(made.root)
    seen = set()
    for number in range(3):
        coursework.student(student_with(number, 3))
        lever = coursework.variant(NAME)
        shown, data = re.fullmatch(
            r'<p><img alt="A beam &amp; (\d) arrows" width="9" src="data:[^,]+,(.*?)"></p>'
            r"\s+How many arrows\?",
            lever._repr_markdown_(),
        ).groups()
        assert shown == str(lever.force)
        assert f"{lever.force} arrows</svg>" in base64.b64decode(data).decode()
        assert repr(lever) == f"A beam & {lever.force} arrows\n\nHow many arrows?"
        assert coursework.check(NAME, lever.force).outcome == "correct"
        seen.add(lever.force)
    assert seen == {2, 5, 6}


def test_parameters_are_shown_in_a_text():
    x = sympy.Symbol("x")
    assert variants.shown(
        "{{a}} and ${{b}}$, {{c}}; {{d}}", written({"a": "up", "b": x**2 / 3, "c": [1, 2]})
    ) == (r"up and $\frac{x^{2}}{3}$, 1, 2; {{d}}")
    assert drawn_in("x = 1") is None and drawn_in(DRAWN) == ("lever", "levers/see-saw")
