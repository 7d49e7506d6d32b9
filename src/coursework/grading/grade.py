"""Grades a class: from what was handed in to a record of each student's work, and reports of all records.

A record is written as soon as a student's work on an assignment is graded. Its key follows from everything
that it depends on: the bytes of the notebooks, the questions, the limits, the versions of the software. A
run that finds a record with the right key leaves it alone, so a run that was killed goes on where it was.
"""

import contextlib
import csv
import hashlib
import json
import platform
import sys
import time
from pathlib import Path
from typing import NamedTuple

from ..authoring.course import edition_of, find_course
from . import intake, marking
from .store import FORMAT, Store, as_text, write
from .versions import software

DECISIONS, REFUSED, COURSE = "decisions.csv", "refused.json", "course.json"


class NothingToGrade(ValueError):
    """There is nothing that could be graded; the message says what was looked for."""


class Work(NamedTuple):
    """What one student handed in for one assignment: the notebooks that count, and those that do not."""

    student: str
    assignment: str
    notebooks: list
    superseded: list


class Course:
    """The assignments, and the names of the questions of each.

    Parameters
    ----------
    solutions : path
        The folder of the notebooks with solutions.
    assignments : dict, optional
        The notebooks that make up each assignment, where they are not one each.
    """

    def __init__(self, solutions=None, assignments=None):
        folder = Path(solutions or find_course().sources)
        self.edition = edition_of(folder)
        self.sources = {path.stem: path for path in sorted(folder.glob("*.ipynb"))}
        if not self.sources:
            raise NothingToGrade(f"There is no notebook with solutions in {folder}.")
        self.assignments = assignments or {stem: [stem] for stem in self.sources}
        unknown = sorted({stem for stems in self.assignments.values() for stem in stems} - set(self.sources))
        if unknown:
            raise NothingToGrade(
                f"There is no notebook with solutions {', '.join(map(repr, unknown))} in {folder}; "
                f"there are {', '.join(self.sources)}."
            )
        self.names = {
            assignment: [name for stem in stems for name in marking.names_asked(self.sources[stem])]
            for assignment, stems in self.assignments.items()
        }

    def assignments_of(self, notebook):
        """The assignments that a notebook answers, by the names in its cells, or else by its own name."""
        by_cell = {name.replace("/", "-"): name for names in self.names.values() for name in names}
        named = {by_cell.get(name.removeprefix("check-"), name) for name in notebook.named}
        counts = {assignment: len(named & set(names)) for assignment, names in self.names.items()}
        most = max(counts.values())
        if most:
            # The one it names most of; and any other of which it names half: some work in a single notebook.
            first = next(assignment for assignment, count in counts.items() if count == most)
            return [
                assignment
                for assignment, count in counts.items()
                if assignment == first or 2 * count >= len(self.names[assignment]) > 0
            ]
        for place in (notebook.folder, notebook.file.rpartition("/")[2]):
            fitting = [assignment for assignment in self.assignments if assignment in place]
            if fitting:
                return [max(fitting, key=len)]
        return list(self.assignments) if len(self.assignments) == 1 else []

    def questions(self, assignments, kept):
        """The questions of some assignments, by assignment and name."""
        stems = sorted({stem for assignment in assignments for stem in self.assignments[assignment]})
        found = marking.load_questions([self.sources[stem] for stem in stems], kept, self.edition)
        return {assignment: {name: found[name] for name in self.names[assignment]} for assignment in assignments}


def sort_work(notebooks, course, refused):
    """Sort notebooks by student and assignment; say of each which counts.

    Of several notebooks for one assignment the newest counts, and older ones only for questions that no newer
    one has: an assignment may be handed in as several notebooks.
    """
    handed_in = {}
    for notebook in notebooks:
        assignments = course.assignments_of(notebook)
        if not assignments:
            refused.append(
                intake.Refused(notebook.file, notebook.student, "No question of any assignment is named in it.")
            )
        for assignment in assignments:
            handed_in.setdefault((notebook.student, assignment), []).append(notebook)
    found = []
    for (student, assignment), mine in sorted(handed_in.items(), key=lambda entry: entry[0]):
        counting, superseded, taken = [], [], set()
        for notebook in sorted(mine, key=_by_age, reverse=True):
            names = set(notebook.named) & set(course.names[assignment])
            if counting and (names & taken or not names):
                superseded.append(notebook)
            else:
                counting.append(notebook)
                taken |= names
        found.append(Work(student, assignment, sorted(counting, key=lambda notebook: notebook.file), superseded))
    return found


def _by_age(notebook):
    declared, when = notebook.order
    return declared, when if isinstance(when, tuple) else (when,), notebook.file


# --- grading ------------------------------------------------------------------------------------


def grade(
    submissions,
    out,
    *,
    solutions=None,
    assignments=None,
    workers=2,
    scheduler=None,
    allow_weak_isolation=False,
    limits=None,
    show=None,
):
    """Grade what was handed in and write records and reports to the folder ``out``.

    Returns
    -------
    dict
        How many were ``graded`` now, were graded before (``kept``), and were ``refused``.

    Raises
    ------
    NothingToGrade, InUse, WeakIsolation
    """
    from . import reports
    from .sandbox import Limits

    store, limits, show = Store(out), limits or Limits(), show or sys.stderr
    with store.locked():
        course = Course(solutions, assignments)
        try:
            notebooks, refused = intake.take_in(submissions, course.assignments)
        except intake.Unfit as error:
            raise NothingToGrade(str(error)) from None
        work = sort_work(notebooks, course, refused)
        questions = course.questions(sorted({one.assignment for one in work}), store.folder / "questions")
        decisions = read_decisions(store.folder / DECISIONS)
        write(store.folder / COURSE, as_text(course.assignments))
        keys = {
            (one.student, one.assignment): key_of(one, questions[one.assignment], limits, allow_weak_isolation)
            for one in work
        }
        waiting = [one for one in work if not _is_done(store, one, keys)]
        print(
            f"{len(work)} to grade, {len(work) - len(waiting)} of them graded before, {len(refused)} files refused.",
            file=show,
        )
        store.log(f"start: {len(waiting)} of {len(work)} to grade, {len(refused)} refused, on {platform.node()}")
        jobs = _Jobs(waiting, questions)
        if scheduler:
            from .cluster import run_on_cluster

            results = run_on_cluster(jobs, scheduler, limits, allow_weak_isolation=allow_weak_isolation)
        else:
            results = run_here(jobs, workers, limits, allow_weak_isolation)
        progress = _Progress(len(waiting), show)
        for one, found in jobs.whole(results):
            record = record_of(one, found, keys[one.student, one.assignment], limits)
            record = marked(record, questions[one.assignment], decisions)
            store.save(record)
            store.log(f"graded: {one.student!r} {one.assignment}")
            progress.one_more(record)
        write(store.folder / REFUSED, as_text(sorted(refused)))
        reports.write_all(store)
        store.log("end")
    return {"graded": len(waiting), "kept": len(work) - len(waiting), "refused": len(refused)}


def _is_done(store, one, keys):
    record = store.read(one.student, one.assignment)
    return record is not None and record["key"] == keys[one.student, one.assignment]


def key_of(work, questions, limits, weak):
    """What a record depends on, as one short text."""
    depends = [
        FORMAT,
        [notebook.digest for notebook in work.notebooks],
        [notebook.digest for notebook in work.superseded],
        {name: question["version"] for name, question in questions.items()},
        vars(limits),
        weak,
        software(),
    ]
    return hashlib.sha256(json.dumps(depends, sort_keys=True).encode()).hexdigest()


class _Jobs:
    """The jobs of the sandbox, one for each notebook, and which work each belongs to."""

    def __init__(self, work, questions):
        self.work = work
        self.questions = questions

    def __iter__(self):
        for order, one in enumerate(self.work):
            asked = marking.asked_of_sandbox(marking.of_student(self.questions[one.assignment], one.student))
            for part, notebook in enumerate(one.notebooks):
                yield {"id": f"{order} {part}", "cells": notebook.cells, "questions": asked, "seed": 0}

    def whole(self, results):
        """Give each work with the results of its notebooks, once it has them all."""
        found = {}
        for result in results:
            order, part = map(int, result["id"].split())
            parts = found.setdefault(order, {})
            parts[part] = result
            one = self.work[order]
            if len(parts) == len(one.notebooks):
                yield one, [found[order][part] for part in range(len(parts))]
                del found[order]


def run_here(jobs, workers, limits, allow_weak_isolation):
    """Run jobs on this machine. A notebook under which the sandbox dies again and again is given up, alone."""
    from .sandbox import WorkerDied, given_up, run_notebooks

    waiting = {job["id"]: job for job in jobs}
    options = {"limits": limits, "allow_weak_isolation": allow_weak_isolation}
    while waiting:
        try:
            for result in run_notebooks(list(waiting.values()), min(workers, len(waiting)), **options):
                del waiting[result["id"]]
                yield result
        except WorkerDied:
            # One of the first that are not done: each of them gets a sandbox of its own.
            for job in list(waiting.values())[: 2 * workers]:
                del waiting[job["id"]]
                try:
                    yield from run_notebooks([job], 1, **options)
                except WorkerDied as error:
                    yield given_up(job, str(error))


def record_of(work, results, key, limits):
    """The record of a student's work, before it is judged."""
    notebooks = []
    for notebook, result in zip(work.notebooks, results):
        notebooks.append(
            {
                "file": notebook.file,
                "sha256": notebook.digest,
                "finished": result["finished"],
                "cells": result["cells"],
                "notes": result["notes"],
                "unknown questions": result["unknown questions"],
                "runs": result["runs"],
                "seed": result["seed"],
                "isolation": result["isolation"],
                "late": notebook.late,
            }
        )
    answers, finished = {}, all(result["finished"] for result in results)
    for name in results[0]["answers"]:
        given = [result["answers"][name] for result in results]
        # Of several notebooks the one that says something; they have no question in common.
        answers[name] = min(given, key=_says_little)
    return {
        "format": FORMAT,
        "key": key,
        "student": work.student,
        "assignment": work.assignment,
        "identity": work.notebooks[0].identity,
        "notebooks": notebooks,
        "superseded": [{"file": notebook.file, "sha256": notebook.digest} for notebook in work.superseded],
        "software": software(),
        "limits": vars(limits),
        "finished": finished,
        "answers": answers,
    }


def _says_little(answer):
    blank = answer["outcome"] == "recorded" and answer["plain"]["value"] == ["blank"]
    return (
        ("recorded", "unreadable").index(answer["outcome"]) + 3 * blank
        if answer["outcome"] in ("recorded", "unreadable")
        else 2 + 2 * (answer["outcome"] == "missing")
    )


def marked(record, questions, decisions=None):
    """A record with the verdicts on its answers."""
    marks = {}
    for name, question in marking.of_student(questions, record["student"]).items():
        found = marking.mark(name, question, record["answers"].get(name, {"outcome": "missing"}), record["finished"])
        decided = (decisions or {}).get((record["student"], name))
        if decided is not None and found["outcome"] == "undecided":
            share, comment = decided
            found |= {
                "outcome": "decided",
                "points": round(question["worth"] * share, 4),
                "messages": [comment] if comment else [],
            }
        marks[name] = {**found, "title": question["title"]}
    return {
        **record,
        "marks": marks,
        "points": round(sum(mark["points"] for mark in marks.values()), 4),
        "worth": sum(mark["worth"] for mark in marks.values()),
        "undecided": sum(mark["outcome"] == "undecided" for mark in marks.values()),
    }


class _Progress:
    """How far it is and how long it will take, on one line that is written over."""

    def __init__(self, total, show):
        self.total, self.show, self.done = total, show, 0
        self.start = self.last = time.monotonic()
        self.told = False

    def one_more(self, record):
        self.done += 1
        if not self.told:
            self.told = True
            for notebook in record["notebooks"][:1]:
                isolation = notebook["isolation"]
                kind = "WEAK isolation" if isolation["weak"] else "Isolation"
                print(f"{kind}: {', '.join(isolation['layers']) or 'none'}.", file=self.show)
                for line in isolation.get("not stopped", ()):
                    print(f"  not stopped: {line}", file=self.show)
        now = time.monotonic()
        on_screen = self.show.isatty()
        if self.done == 1:
            # What comes before the first is the start of the sandboxes, which takes no longer for more.
            self.first = self.last = now
        if self.done == self.total or now - self.last > (0.2 if on_screen else 10):
            self.last = now
            left = (now - self.first) / max(1, self.done - 1) * (self.total - self.done)
            said = f"{self.done} of {self.total} graded, " + (
                f"{_span(left)} left" if self.done < self.total else f"in {_span(now - self.start)}"
            )
            end = "\n" if not on_screen or self.done == self.total else ""
            print(f"\r\x1b[K{said}" if on_screen else said, end=end, file=self.show, flush=True)


def _span(seconds):
    return f"{seconds:.0f} s" if seconds < 90 else f"{seconds / 60:.0f} min"


# --- grading again ------------------------------------------------------------------------------


class Moved(NamedTuple):
    """A student whose points changed."""

    student: str
    assignment: str
    before: float
    after: float
    questions: list


def regrade(out, *, solutions=None):
    """Judge the stored answers again, by the questions and a person's decisions as they are now.

    Returns
    -------
    list of Moved

    Nothing is run. A question that was added since has no answers in the records; grade again for that.
    """
    from . import reports

    store = Store(out)
    with store.locked():
        names = sorted({record["assignment"] for record in store.all()})
        if not names:
            raise NothingToGrade(f"There are no records in {store.folder}.")
        course = Course(solutions, json.loads((store.folder / COURSE).read_text("utf8")))
        questions = course.questions(names, store.folder / "questions")
        decisions = read_decisions(store.folder / DECISIONS)
        moved = []
        for record in store.all():
            again = marked(record, questions[record["assignment"]], decisions)
            if again == record:
                continue
            store.save(again)
            changed = [
                name
                for name in again["marks"]
                if (again["marks"][name]["points"], again["marks"][name]["outcome"])
                != (record["marks"].get(name, {}).get("points"), record["marks"].get(name, {}).get("outcome"))
            ]
            if changed:
                moved.append(Moved(record["student"], record["assignment"], record["points"], again["points"], changed))
        store.log(f"graded again: {len(moved)} moved")
        reports.write_all(store)
    return moved


def read_decisions(path):
    """What a person decided: the credit from 0 to 1, and a comment, by student and question.

    Raises
    ------
    ValueError
        A line cannot be read; the message says which.
    """
    from .tables import as_written

    found = {}
    with contextlib.suppress(FileNotFoundError), open(path, encoding="utf-8-sig", newline="") as file:
        for number, row in enumerate(csv.DictReader(file), 2):
            credit = (row.get("credit") or "").strip()
            if not credit:
                continue
            try:
                share = float(credit)
                if not 0 <= share <= 1:
                    raise ValueError
            except ValueError:
                raise ValueError(
                    f"{path}, line {number}: credit is a number from 0 to 1, and this is {credit!r}."
                ) from None
            found[as_written(row["student"]), row["question"]] = share, (row.get("comment") or "").strip()
    return found
