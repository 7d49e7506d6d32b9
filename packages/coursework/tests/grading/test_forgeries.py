"""The corpus of forgeries: no work counts as another's, and no answer earns more than its worth."""

import io
import re
import shutil
import sys
import zipfile

import nbformat
import pytest
from attacks import answers, corpus, names
from grading_class import give, handed_in, put, write_sources

from coursework.checking.evaluate import MP
from coursework.checking.points import points
from coursework.grading.export import gradebooks
from coursework.grading.grade import grade
from coursework.grading.judging.marking import questions_of
from coursework.grading.record import Identity, Mark, Record
from coursework.grading.store import Store, file_name
from coursework.grading.submissions import intake
from coursework.grading.submissions.roster import Roster

pytestmark = [
    pytest.mark.skipif(
        not sys.platform.startswith("linux"), reason="student code runs on Linux only"
    ),
    pytest.mark.usefixtures("libraries_are_loaded_once"),
]

GOOD = nbformat.writes(handed_in()).encode()


def lay_out(place, attack, in_archive):
    """Put submissions into a folder, or into an archive like a system's."""
    files = {name: GOOD for name in attack.handed_in if ".zip/" not in name} | dict(attack.also)
    within = {}
    for name in attack.handed_in:
        outer, packed, inner = name.partition(".zip/")
        if packed:
            within.setdefault(f"{outer}.zip", []).append(inner)
    files |= {name: names.packed(*inner, data=GOOD) for name, inner in within.items()}
    if not in_archive:
        for name, data in files.items():
            path = place / "class" / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)
        return place / "class"
    with zipfile.ZipFile(place / "class.zip", "w") as box:
        for name, data in files.items():
            box.writestr(name, data)
    return place / "class.zip"


@pytest.mark.parametrize("in_archive", [True, False], ids=["archive", "folder"])
@pytest.mark.parametrize("attack", names.ATTACKS, ids=lambda attack: attack.name)
def test_nothing_is_given_to_anybody_else(tmp_path, attack, in_archive):
    (tmp_path / "roster.csv").write_text(attack.roster, "utf8")
    roster = Roster(tmp_path / "roster.csv") if attack.roster else None
    notebooks, refused = intake.take_in(
        lay_out(tmp_path, attack, in_archive), ["turns", "axes"], roster
    )
    owners = {notebook.file: notebook.student for notebook in notebooks}
    if attack.asked:
        assert owners == {}
        why = {refusal.file: refusal.why for refusal in refused}
        assert all(
            why[name].endswith((intake.CLAIMED_TWICE, intake.NOT_MATCHED))
            for name in attack.handed_in
        ), why
    else:
        leading_out = {name for name in attack.handed_in if "/../" in name}
        assert owners == {
            name: owner for name, owner in attack.handed_in.items() if name not in leading_out
        }
        # A notebook that cannot be matched to anybody is reported, not silently left out.
        nobodys = {name for name in attack.also if name.endswith(".ipynb")}
        assert leading_out | nobodys <= {refusal.file for refusal in refused}


# ---- answers


def cell_of_what_is_known(questions):
    """Return a cell with what students may know: the check's points and a friend's values."""
    places = points(questions["turns/sum"][0].question)
    calls = [call[0] for call in questions["turns/doubled"][0].question.calls]
    with MP.workdps(40):
        values = [MP.nstr(MP.sin(place["alpha"] + place["beta"]), 40) for place in places]
    texts = [{name: MP.nstr(value, 40) for name, value in place.items()} for place in places]
    return (
        f"POINTS = {texts!r}\nVALUES = {values!r}\nCALLS = {calls!r}\n"
        f"TABLE = { {x: 2 * x for x in calls}!r}"
    )


@pytest.fixture(scope="module")
def records(tmp_path_factory):
    """The graded records of a class of forgers and one honest student."""
    place = tmp_path_factory.mktemp("forgers")
    solutions = write_sources(place / "solutions")
    known = cell_of_what_is_known(questions_of(solutions / "turns.ipynb", b"any secret"))
    put(place / "submissions", "right", handed_in())
    for attack in answers.ATTACKS:
        made = handed_in(**{attack.question: attack.code})
        made.cells.insert(1, nbformat.v4.new_code_cell(known, id="known"))
        put(place / "submissions", attack.name, made)
        for name, data in attack.beside.items():
            path = place / "submissions" / attack.name / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)
    grade(
        place / "submissions",
        place / "out",
        solutions=solutions,
        show=io.StringIO(),
    )
    store = Store(place / "out")
    assert not list(place.rglob("forged"))
    return {record.student: record for record in store.all()}


def test_who_does_not_forge_has_all_points(records):
    assert records["right"].points == records["right"].worth == 6
    assert len(records) == len(answers.ATTACKS) + 1


@pytest.mark.parametrize("attack", answers.ATTACKS, ids=lambda attack: attack.name)
def test_an_answer_that_is_not_right_earns_nothing(records, attack):
    marks = records[attack.name].marks
    asked = f"turns/{attack.question.replace('_', '-')}"
    assert (marks[asked].points, marks[asked].outcome in attack.outcome.split(" or ")) == (
        0,
        True,
    ), marks[asked]
    for name, mark in marks.items():
        if name != asked:
            assert mark.points in ((0, mark.worth) if attack.spoils else (mark.worth,)), (
                name,
                mark,
            )


def test_many_of_them_pass_the_check_that_a_student_has(records):
    """These forgeries are real: only secret comparison distinguishes them from right answers."""
    notes = [mark.note for record in records.values() for mark in record.marks.values()]
    assert notes.count("right only where it is checked") >= 12


# ---- names on the way out


def marks_of(folder, **identities):
    """Return the marks of a class known by folders alone, or by a system's or roster's names."""
    store = Store(folder)
    for student, about in identities.items():
        called = {kind: value for kind, value in about.items() if kind != "own"}
        identity = Identity(called, tuple(about["own"]) if "own" in about else None)
        give(
            store,
            Record(
                student, "t", identity=identity, marks={"t/q": Mark("correct", points=6, worth=6)}
            ),
        )
    return gradebooks.Marks(store)


OF_CANVAS = "Student,ID,SIS User ID,SIS Login ID,Section,T (7)\nBob,2,,bob,,\nEve,3,,eve,,\n"
OF_MOODLE = (
    "Identifier,Full name,Email address,Grade\nParticipant 2,Bob,bob@uni.example,\n"
    "Participant 3,Eve,robert@mail.example,\nParticipant 4,Ann,ann@uni.example,\n"
)


@pytest.mark.parametrize(
    "book, students, filled",
    [
        # Being first is no better claim.
        (OF_CANVAS, {"Bob": {}, "bob": {}, "eve": {}}, ["eve"]),
        (OF_CANVAS, {"eve": {"own": ["eve"]}, "other": {"own": ["EVE"]}}, []),
        (OF_CANVAS, {"b\u043eb": {}}, []),
        (OF_CANVAS, {"2": {}}, []),  # A name is not Canvas's ID.
        # The system's ID is more reliable than a name.
        (OF_CANVAS, {"bob": {"canvas": "9", "own": ["bob"]}}, []),
        (OF_MOODLE, {"robert": {}, "bob": {}}, ["bob"]),  # Eve has this address elsewhere.
        (OF_MOODLE, {"bob@mail.example": {"email": "bob@mail.example", "own": []}}, []),
        (OF_MOODLE, {"x": {"email": "ann@uni.example", "own": []}, "ann": {}}, []),
    ],
)
def test_a_line_of_a_gradebook_is_filled_for_nobody_else(tmp_path, book, students, filled):
    (tmp_path / "book.csv").write_text(book, "utf8")
    said = gradebooks.fill(tmp_path / "book.csv", marks_of(tmp_path, **students))
    after = (tmp_path / "book-filled.csv").read_text("utf8").splitlines()[1:]
    changed = [
        line.lower() for line, old in zip(after, book.splitlines()[1:], strict=True) if line != old
    ]
    assert len(changed) == len(filled) and all(
        name in line for name, line in zip(filled, changed, strict=True)
    )
    assert all(
        any(f"  {student}" in line for line in said)
        for student in students
        if student not in filled
    )


def test_records_of_two_lie_in_two_places_on_every_system():
    names = [
        "con",
        "CON",
        "nul.txt",
        "aux",
        "com1",
        "lpt9.ipynb",
        "prn",
        "bob",
        "Bob",
        "bob.",
        "bob ",
        "b\u043eb",
        "a",
        "A",
        "../a",
        "/a",
        "a/b",
        "a b",
        "a-b",
        "..",
        ".",
        "",
        "-",
        "é",
        "e",
        "a\0",
        "a" * 100,
        "a" * 101,
        "con.",
    ]
    places = [file_name(name) for name in names]
    assert len({place.casefold() for place in places}) == len(names)
    for place in places:
        assert place.partition(".")[0] not in ("con", "nul", "aux", "com1", "lpt9", "prn")
        assert re.fullmatch(r"[a-z0-9_][a-z0-9._-]*", place) and place.rstrip(". ") == place
    # The digest is long enough that nobody finds a second name for another's record.
    assert len(file_name("Bob Smith").rpartition("-")[2]) * 4 >= 80


def test_a_copy_of_a_record_counts_for_nobody(tmp_path):
    store = Store(tmp_path)
    give(store, Record("bob", "turns"))
    (tmp_path / "records" / "eve").mkdir()
    shutil.copy(store.place("bob", "turns"), tmp_path / "records" / "eve" / "turns.json")
    assert [record.student for record in store.all()] == ["bob"]


def test_a_name_begins_no_line_of_its_own(tmp_path):
    solutions = write_sources(tmp_path / "solutions")
    put(tmp_path / "class", "eve", handed_in(), "x.ipynb\n  bob <- turns.ipynb")
    put(tmp_path / "class", "eve", handed_in(), "x\r\x1b[1A  bob <- turns.ipynb")
    put(tmp_path / "class", "bob\n  eve <- bob", handed_in())
    shown = io.StringIO()
    grade(tmp_path / "class", tmp_path / "out", solutions=solutions, dry_run=True, show=shown)
    lines = shown.getvalue().splitlines()
    assert not any(line.startswith("  bob <-") for line in lines) and "\x1b" not in shown.getvalue()
    assert sum("(turns; " in line for line in lines) == 3


def test_at_least_so_many_kinds_have_been_tried():
    """Count the corpus by kind: by names, by answers, and by deceiving a comparison."""
    by_names, by_answers, by_deceit = (
        names.ATTACKS,
        answers.ATTACKS,
        [attack for attack in corpus.ATTACKS if attack.forges],
    )
    for kinds in (by_names, by_answers, by_deceit, corpus.ATTACKS):
        assert len({attack.name for attack in kinds}) == len(kinds)
    assert (
        len(by_names) >= 45,
        len(by_answers) >= 40,
        len(by_deceit) >= 6,
        len(corpus.ATTACKS) >= 80,
    ) == (True,) * 4
