"""Slips in a hurry, such as a wrong folder, a full disk or half a download, are explained."""

import errno
import os

import pytest
from grading_class import grade_quietly, handed_in, put, write_sources
from test_review import Served, first_of

from coursework.__main__ import main
from coursework.grading.assignments import NothingToGrade
from coursework.grading.judging import journal as judging
from coursework.grading.judging.journal import Journal
from coursework.grading.store import Store
from coursework.grading.submissions.roster import Roster

pytestmark = pytest.mark.usefixtures("libraries_are_loaded_once")


@pytest.fixture
def course(tmp_path):
    (tmp_path / "course").mkdir()
    write_sources(tmp_path / "course" / "solutions")
    for student in ("ada", "ben"):
        put(tmp_path / "in", student, handed_in(sum="sine = 1.0001*sm.sin(alpha + beta)"))
    return tmp_path


def graded(course, submissions, out):
    return grade_quietly(submissions, out, course / "course" / "solutions")


def test_results_are_nobody_s_work(course):
    """They were among the submissions, and the second run once refused each of their files."""
    assert graded(course, course / "in", course / "in" / "marks")["refused"] == 0
    assert graded(course, course / "in", course / "in" / "marks") == {
        "graded": 0,
        "kept": 2,
        "refused": 0,
        "held": 0,
    }
    for submissions, out, words in (
        ("in", "in", "Choose a different folder for the results"),
        ("in/marks", "out", "contains grading results"),
        ("course", "out", "contains the notebooks with solutions"),
    ):
        with pytest.raises(NothingToGrade, match=words):
            graded(course, course / submissions, course / out)


def full(*arguments, **options):
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def test_a_full_disk_is_said_in_a_sentence_and_the_next_run_goes_on(course, monkeypatch, capsys):
    command = ["grade", str(course / "in"), "--out", str(course / "out"), "--solutions",
               str(course / "course" / "solutions"), "--workers", "1"]  # fmt: skip
    with monkeypatch.context() as patched:
        patched.setattr(Store, "stage", full)
        with pytest.raises(SystemExit, match="coursework grade: No space left on device") as caught:
            main(command)
    assert "Traceback" not in str(caught.value) + capsys.readouterr().err
    with Store(course / "out").locked(), pytest.raises(SystemExit, match="Wait until it has fin"):
        main(command)
    main(command)
    assert {record.points for record in Store(course / "out").all()} == {5}


def test_a_decision_that_a_full_disk_refused_is_not_lost_unsaid(course, monkeypatch):
    graded(course, course / "in", course / "out")
    with Served(course / "out", grader="Ann") as served:
        cluster, seen = first_of(served), served.seen(first_of(served))
        with monkeypatch.context() as patched:
            patched.setattr(judging.os, "fsync", full)
            assert served.decide(cluster, "credit=1&comment=Kept", seen).status == 507
        assert Journal(course / "out").by_people == []
        assert served.decide(cluster, "credit=1", seen).status == 303
    assert Journal(course / "out").by_people


@pytest.mark.parametrize(
    "text, encoding, people",
    [
        # Some characters end a line in Python but in no spreadsheet.
        ("student,name\neve,Eve\u2028ada,Eve\nben,Ben\x85,Ben\n", "utf8", {"eve", "ben"}),
        # Spreadsheets on Windows write these signs in an encoding of their own.
        ("name\nZoë O’Neil\n", "cp1252", {"Zoë O’Neil"}),
    ],
)
def test_the_signs_in_a_name_stay_part_of_it(tmp_path, text, encoding, people):
    (tmp_path / "roster.csv").write_text(text, encoding)
    assert set(Roster(tmp_path / "roster.csv").people) == people
