"""Decisions, appeals and changes of a rubric are events, and nothing counts before it was shown."""

import csv
import datetime
import io
import re
import shutil
from dataclasses import replace
from urllib.parse import quote_plus

import nbformat
import pytest
from grading_class import grade_quietly, notebook, put, write_term
from test_review import Served

from coursework.__main__ import main
from coursework.authoring.author import AuthorError
from coursework.authoring.source import read_source
from coursework.grading.export import gradebooks
from coursework.grading.grade import bring_in_decisions, regrade
from coursework.grading.judging import secret
from coursework.grading.judging.journal import (
    REJECTED,
    UNDER_REVIEW,
    Collision,
    Journal,
    Part,
)
from coursework.grading.review import Class
from coursework.grading.store import Store

pytestmark = pytest.mark.usefixtures("libraries_are_loaded_once")

SCRIPT = "<script>alert(1)</script>"
ESSAY, SUM = "essays/why", "essays/sum"
RUBRIC = {"names the couple": 2, "says why": 1, "forgets the point": -1}


def write_essays(folder, rubric=RUBRIC, right="5", text="Why?"):
    folder.mkdir(exist_ok=True)
    (folder / secret.FILE).write_text("5eed" * 16)
    cells = [
        "import sympy as sm\nfrom coursework import check",
        ("markdown", text),
        "### BEGIN SOLUTION\nwhy = 'A couple has the same moment about every point.'\n"
        "### END SOLUTION",
        f"check('{ESSAY}', why)\n"
        "### BEGIN HIDDEN TESTS\n"
        f"question('{ESSAY}', kind='free text', worth=3, rubric={rubric!r})\n"
        "### END HIDDEN TESTS",
        ("markdown", "How much is 2 + 3?"),
        f"### BEGIN SOLUTION\ntotal = sm.Integer({right})\n### END SOLUTION",
        f"check('{SUM}', total)\n### BEGIN HIDDEN TESTS\n"
        f"question('{SUM}', kind='expression', worth=2)\n"
        "### END HIDDEN TESTS",
    ]
    nbformat.write(notebook(cells), folder / "essays.ipynb")
    return folder


def answered(why, total):
    return notebook(
        [
            "from coursework import check",
            f"why = {why!r}\ncheck('{ESSAY}', why)",
            f"total = {total}\ncheck('{SUM}', total)",
        ]
    )


@pytest.fixture(scope="module")
def begun(tmp_path_factory):
    place = tmp_path_factory.mktemp("appeals")
    solutions = write_essays(place / "solutions")
    for student, total in (("ada", 5), ("ben", 6), ("cem", 6)):
        put(place / "in", student, answered(f"Since {student} says so.", total), "essays.ipynb")
    grade_quietly(place / "in", place / "out", solutions)
    return place


@pytest.fixture
def out(begun, tmp_path):
    return Store(shutil.copytree(begun / "out", tmp_path / "out"))


def points_of(store):
    return {record.student: record.points for record in store.all()}


def cluster_of(store, question, student):
    (cluster,) = [
        candidate
        for candidate in Class(store.folder).clusters.values()
        if candidate.question == question
        and student in [record.student for record in candidate.members]
    ]
    return cluster


# --- appeals ------------------------------------------------------------------------------------


def test_an_appeal_goes_from_step_to_step_and_only_a_decision_accepts_it(out):
    record, journal = out.read("ben", "essays"), Journal(out.folder)
    key = "ben", "essays", SUM

    def state():
        return Journal(out.folder).standing().appeals[key][-1]

    journal.appeal(record, SUM, "But it is right.", who="Ann")
    assert state().state == "raised" and state().is_open
    with pytest.raises(Collision, match="open already"):
        journal.appeal(record, SUM, "Again.", who="Ann")
    first = state()
    journal.appeal(record, SUM, "", state=UNDER_REVIEW, of=first, after=first.last, who="Ben")
    # It refers to the state before.
    with pytest.raises(Collision, match="has changed this appeal"):
        journal.appeal(record, SUM, "No.", state=REJECTED, of=first, after=first.last, who="Ann")
    with pytest.raises(ValueError, match="the reason for rejecting the appeal"):
        journal.appeal(record, SUM, " ", state=REJECTED, of=first, after=state().last, who="Ann")
    journal.appeal(
        record, SUM, "6 is not 5.", state=REJECTED, of=first, after=state().last, who="Ann"
    )
    assert state().state == "rejected" and not state().is_open
    late = journal.decision(record, SUM, 1, who="Ben", appeal=first.id)
    with pytest.raises(Collision, match="has settled this appeal"):
        journal.append([late], collisions=True)
    journal.appeal(record, SUM, "", state=UNDER_REVIEW, of=first, after=state().last, who="Ben")
    journal.append([late], collisions=True)
    assert state().state == "accepted" and Journal(out.folder).standing().decisions[key].credit == 1
    # Undoing restores the mark, and the appeal waits again.
    journal.take_back([record], SUM, "Ben")
    assert state().state == "under review" and key not in Journal(out.folder).standing().decisions
    # Once it is closed, another may be raised.
    journal.appeal(record, SUM, "No!", state=REJECTED, of=first, after=state().last, who="Ann")
    journal.appeal(record, SUM, "I ask once more.", who="Ann")
    assert [appeal.state for appeal in Journal(out.folder).standing().appeals[key]] == [
        "rejected",
        "raised",
    ]


def form(**fields):
    return "&".join(f"{name}={quote_plus(str(value))}" for name, value in fields.items())


def test_an_accepted_appeal_changes_mark_page_and_gradebook(begun, out, capsys):
    """After an appeal, 17 once stayed where 18 was due."""
    book = out.folder / "book.csv"
    book.write_text("Student,ID,SIS User ID,SIS Login ID,Section,Essays (7)\n" + "".join(
        f'"{name}",{number},,{name},x,\n' for number, name in enumerate(("ada", "ben", "cem"), 1)
    ))  # fmt: skip
    for name in ("ada", "ben", "cem"):
        Journal(out.folder).add(out.read(name, "essays"), ESSAY, 1, who="Ann")
    bring_in_decisions(out.folder)
    command = ["export", str(out.folder), "--lms", str(book), "--filled", str(book)]
    main(command)
    cluster = cluster_of(out, SUM, "ben")
    place = [record.student for record in cluster.members].index("ben")
    with Served(out.folder, grader="Ann") as served:
        raised = form(form="appeal", state="raised", only=place, words=f"I am right {SCRIPT}")
        assert served.decide(cluster.id, raised).status == 303
        assert served.decide(cluster.id, raised).status == 409  # Nothing is entered twice.
        long = form(form="appeal", state="raised", only=place, words="x" * 4_001)
        assert served.decide(cluster.id, long).status == 409  # Nothing is cut off.
        _, text = served.ask(f"/{served.secret}/?show=appeals")
        assert (
            re.findall(r"answer/([0-9a-f]{16})", text) == [cluster.id] and "1 answer waits" in text
        )
        capsys.readouterr()
        main(command)
        assert (
            "Filled in, but may change because of an open appeal (1):\n  ben: essays/sum"
            in capsys.readouterr().out
        )
        _, page = served.ask(f"/{served.secret}/answer/{cluster.id}")
        assert (
            "ben appeals: raised" in page and SCRIPT not in page and "&lt;script&gt;alert" in page
        )
        (of,) = re.findall(r'name="of" value="(\w+)"', page)
        step = re.search(r'name="step" value="(\w+)"', page)[1]
        taken_up = form(form="appeal", state="under review", of=of, step=step, only=place, words="")
        assert served.decide(cluster.id, taken_up).status == 303
        assert served.decide(cluster.id, taken_up).status == 409  # Somebody else was faster.
        by_itself = form(form="appeal", state="accepted", of=of, step=step, only=place)
        assert served.decide(cluster.id, by_itself).status == 400
        accepts = form(credit=2, only=place, accepts="yes", comment="You are.")
        assert served.decide(cluster.id, accepts).status == 303
    main(["regrade", str(out.folder), "--solutions", str(begun / "solutions"), "--yes"])
    assert points_of(out) == {"ada": 5, "ben": 5, "cem": 3}
    page = (out.folder / "feedback" / "ben" / "essays.html").read_text()
    assert (
        "<strong>accepted</strong>" in page
        and "You are." in page
        and "I am right" in page
        and SCRIPT not in page
    )
    capsys.readouterr()
    main(command)
    said = capsys.readouterr().out
    assert "ben: 3 -> 5" in said and "An appeal" not in said
    marks = {
        row["SIS Login ID"]: row["Essays (7)"]
        for row in csv.DictReader(book.read_text().splitlines())
    }
    assert marks == {"ada": "5", "ben": "5", "cem": "3"}


def test_a_mark_is_that_of_the_day_it_is_asked_for(out):
    record, journal = out.read("ben", "essays"), Journal(out.folder)
    day = datetime.datetime(2026, 1, 1, tzinfo=datetime.UTC)
    given = [
        replace(event, when=f"2026-01-0{number}T00:00:00.000000+00:00")
        for number, event in enumerate(journal.events, 1)
    ]
    journal.path.unlink()
    (ben,) = [event for event in given if event.student == "ben"]
    appeal = journal.appeal(record, SUM, "Right!", who="Ann")
    journal.path.unlink()
    months = [f"2026-0{month}-01T00:00:00.000000+00:00" for month in (2, 3)]
    decided = journal.decision(record, SUM, 1, who="Ann", appeal=appeal.id)
    parts = {**ben.marks, SUM: Part(2, 2, "decided")}
    events = [
        *given,
        replace(appeal, when=months[0]),
        replace(decided, when=months[1]),
        replace(ben, id="later", when=months[1], points=2, marks=parts),
    ]
    Journal(out.folder).append(events)
    with pytest.raises(gradebooks.CannotExport, match="no marks .* as of 20"):
        gradebooks.Marks(out, as_of=day - datetime.timedelta(days=1))
    for month, is_open in ((1, False), (2, True), (3, False)):
        day = datetime.datetime(2026, month, 15, tzinfo=datetime.UTC)
        marks = gradebooks.Marks(out, as_of=day)
        assert marks.appeals("ben") == ([SUM] if is_open else [])
        assert marks.points("ben") == 2 * (month == 3)


def test_a_table_of_appeals_is_taken_in_once(begun, out, capsys):
    path = out.folder.parent / "appeals.csv"
    path.write_text(
        "student,question,words\n" + f'ben,{SUM},"=1+1 {SCRIPT}"\nnobody,{SUM},Why?\ncem,{SUM},\n'
    )
    for entered in (1, 0):
        main(["merge", str(out.folder), str(path)])
        said = capsys.readouterr()
        assert (
            f"imported from {path}: {entered}." in said.out
            and "line 3: there is no answer of" in said.out
        )
    assert "1 appeal is open (ben)" in said.err
    (appeals,) = Journal(out.folder).standing().appeals.values()
    assert [(len(appeal.steps), appeal.steps[0].words) for appeal in appeals] == [
        (1, f"=1+1 {SCRIPT}")
    ]
    for path in out.folder.rglob("*.csv"):
        cells = [cell for row in csv.reader(path.read_text().splitlines()) for cell in row]
        assert not any(cell.startswith("=") for cell in cells)
    assert not any(SCRIPT in path.read_text() for path in out.folder.rglob("*.html"))


def test_appeals_go_with_a_student_whom_a_roster_calls_something_else(begun, out, tmp_path):
    record, journal = out.read("ben", "essays"), Journal(out.folder)
    decision = journal.decision(
        record, SUM, 1, who="Ann", appeal=journal.appeal(record, SUM, "Right!", who="Ann").id
    )
    journal.append([decision], collisions=True)
    journal.append(
        [journal.decision(record, SUM, 0.5, who="Ben", after=decision.id)], collisions=True
    )
    (tmp_path / "roster.csv").write_text("student,name\nada,ada\nbenjamin,ben\ncem,cem\n")
    write_term(out, tmp_path / "roster.csv", {"essays": ["essays"]})
    grade_quietly(begun / "in", out.folder, begun / "solutions")
    mark = out.read("benjamin", "essays").marks[SUM]
    assert (mark.points, [appeal["state"] for appeal in mark.appeals]) == (1, ["accepted"])
    again = Journal(out.folder)
    again.take_back([out.read("benjamin", "essays")], SUM, "Ben")
    assert again.standing().decisions["benjamin", "essays", SUM].credit == 1


# --- later changes ------------------------------------------------------------------------------


def test_a_decision_on_what_has_changed_since_is_shown_as_such(begun, out, tmp_path, capsys):
    Journal(out.folder).add(out.read("ben", "essays"), SUM, 1, who="Ann")
    Journal(out.folder).add(out.read("cem", "essays"), SUM, 0.5, who="Ann")
    regrade(out.folder, solutions=begun / "solutions", show=io.StringIO())
    # Rewording the text does not make another question.
    reworded = write_essays(tmp_path / "reworded", text="Why is that so?")
    said = io.StringIO()
    regrade(out.folder, solutions=reworded, show=said)
    assert "changed since" not in said.getvalue()
    # A resubmitted answer is judged again, and the decision on the earlier one is not forgotten.
    put(tmp_path / "in", "ben", answered("Since.", 7), "essays.ipynb")
    grade_quietly(tmp_path / "in", out.folder, begun / "solutions", show=said)
    assert out.read("ben", "essays").points == 0
    assert (
        "1 decision is about an answer or a question that has changed since (ben)"
        in said.getvalue()
    )
    # For a corrected question, the decision counts, and somebody should look.
    mended, said = write_essays(tmp_path / "mended", right="6"), io.StringIO()
    regrade(out.folder, solutions=mended, show=said)
    assert (
        points_of(out)["cem"] == 1
        and "2 decisions are about answers or questions that have" in said.getvalue()
    )
    with Served(out.folder, grader="Ann") as served:
        _, text = served.ask(f"/{served.secret}/?show=earlier")
        clusters = set(re.findall(r"answer/([0-9a-f]{16})", text))
        assert len(clusters) == 2
        pages = "".join(
            served.ask(f"/{served.secret}/answer/{answer}?show=earlier")[1] for answer in clusters
        )
        assert (
            "The question has changed since Ann decided" in pages
            and "to an earlier answer" in pages
        )
        cluster = cluster_of(out, SUM, "cem")
        assert served.decide(cluster.id, "credit=2").status == 303
        _, text = served.ask(f"/{served.secret}/?show=earlier")
        assert set(re.findall(r"answer/([0-9a-f]{16})", text)) == clusters - {cluster.id}


# --- the rubric ---------------------------------------------------------------------------------


def decide_by_rubric(served, store, student, *lines, **more):
    cluster = cluster_of(store, ESSAY, student)
    body = "&".join(["credit=rubric", *(form(rubric=line) for line in lines), form(**more)])
    return served.decide(cluster.id, body)


def test_a_line_whose_worth_changes_scores_anew_what_used_it(begun, out, tmp_path):
    solutions, names, says, forgets = begun / "solutions", *RUBRIC
    with Served(out.folder, grader="Ann") as served:
        assert decide_by_rubric(served, out, "ada", names, says).status == 303
        assert decide_by_rubric(served, out, "ben", names, forgets).status == 303
        assert (
            decide_by_rubric(served, out, "cem", says, new="is polite", new_points="0.5").status
            == 303
        )
        regrade(out.folder, solutions=solutions, show=io.StringIO())
        assert points_of(out) == {"ada": 5, "ben": 1, "cem": 1.5}
        # Whoever changes it on the page says which value they saw.
        cluster = cluster_of(out, ESSAY, "ada")
        _, page = served.ask(f"/{served.secret}/answer/{cluster.id}")
        worths = page.partition('value="worths"')[2].partition("</form>")[0]
        lines = re.findall(r'name="line" value="([^"]*)"', worths)
        steps = re.findall(r'name="step" value="([^"]*)"', worths)
        shown = re.findall(r'name="points"[^>]*value="([^"]*)"', worths)
        assert dict(zip(lines, shown, strict=True)) == {
            names: "2",
            says: "1",
            forgets: "-1",
            "is polite": "0.5",
        }
        shown[lines.index(says)], shown[lines.index("is polite")] = "0.5", "1"
        fields = zip(lines, shown, steps, strict=True)
        body = "&".join(
            [
                "form=worths",
                *(form(line=line, points=points, step=step) for line, points, step in fields),
            ]
        )
        assert served.decide(cluster.id, body).status == 303
        body = body.replace("points=0.5", "points=0.75")
        assert served.decide(cluster.id, body).status == 409  # Ann saw the earlier value.
        assert (
            served.decide(cluster.id, form(form="worths", line=says, points=9, step="-")).status
            == 409
        )
        assert (
            served.decide(
                cluster.id, form(form="worths", line="no line", points=1, step="-")
            ).status
            == 400
        )
    regrade(out.folder, solutions=solutions, show=io.StringIO())
    assert points_of(out) == {"ada": 4.5, "ben": 1, "cem": 1.5}
    # The source's latest value is newer than the page's; nobody has more than all points, or less
    # than zero.
    mended = write_essays(tmp_path / "mended", {names: 3, says: 0.25, forgets: -3})
    changes = [
        change
        for move in regrade(out.folder, solutions=mended, dry_run=True).moves
        for change in move.changes
    ]
    assert {change.student: (change.before, change.after) for change in changes} == {
        "ada": (2.5, 3), "ben": (1, 0), "cem": (1.5, 1.25)
    }  # fmt: skip
    regrade(out.folder, solutions=mended, show=io.StringIO())
    assert points_of(out) == {"ada": 5, "ben": 0, "cem": 1.25}
    # Points that somebody entered by hand stay.
    Journal(out.folder).add(out.read("ada", "essays"), ESSAY, 1 / 3, who="Ben", rubric=[names])
    regrade(out.folder, solutions=solutions, show=io.StringIO())
    assert points_of(out)["ada"] == 3


def test_a_rubric_by_which_nobody_could_have_all_is_refused(tmp_path):
    for rubric in ({"a": 2}, {"a": 4, "b": -1}, {"a": "3"}):
        with pytest.raises(AuthorError, match="rubric"):
            read_source(write_essays(tmp_path / "s", rubric) / "essays.ipynb")


# --- the file -----------------------------------------------------------------------------------


def test_who_saw_another_decision_decided_later_whatever_the_clock_says(out):
    record, journal = out.read("ben", "essays"), Journal(out.folder)
    first = journal.decision(record, SUM, 0.5, who="Ann")
    other = replace(
        journal.decision(record, SUM, 1, who="Ben", after=first.id),
        when="2020-01-01T00:00:00.000000+00:00",
    )
    third = replace(journal.decision(record, SUM, 0, who="Cem", after=other.id), when=first.when)
    for events, credit in (
        ([first, other], 1),
        ([first, other, third], 0),
        ([third, other, first], 0),
    ):
        journal.path.unlink(missing_ok=True)
        Journal(out.folder).append(events)
        assert Journal(out.folder).standing().decisions["ben", "essays", SUM].credit == credit


def test_a_dry_run_writes_nothing(begun, out, capsys, tmp_path):
    other = Journal(tmp_path)
    other.add(out.read("ben", "essays"), SUM, 1, who="Ben")
    Journal(out.folder).add(out.read("cem", "essays"), SUM, 0.5, who="Ann")
    appeals = tmp_path / "appeals.csv"
    appeals.write_text(f"student,question,words\nben,{SUM},Right!\n")
    put(tmp_path / "in", "dan", answered("So.", 5), "essays.ipynb")
    made = (regrade_page := "regrade.html"), "whose.csv", "lock"

    def contents():
        return {
            path: path.read_bytes()
            for path in out.folder.rglob("*")
            if path.is_file() and path.name not in made
        }

    before, solutions = contents(), ["--solutions", str(begun / "solutions")]
    main(["merge", str(out.folder), str(other.path), str(appeals), "--dry-run"])
    main(["regrade", str(out.folder), *solutions, "--dry-run"])
    main(["grade", str(tmp_path / "in"), "--out", str(out.folder), *solutions, "--dry-run"])
    said = capsys.readouterr()
    assert "(dry run: not imported): 1 decision." in said.out
    assert "'cem', essays: 0 -> 1" in said.out and "1 to grade, 0 of them graded before" in said.err
    assert contents() == before and (out.folder / regrade_page).exists()
