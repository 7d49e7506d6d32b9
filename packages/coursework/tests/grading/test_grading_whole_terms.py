"""Whole terms with all that happens in them: in the end every mark is that of
somebody who knows the whole story.
"""

import datetime
import functools
import hashlib
import io
import json
import random
import re
import shutil
from types import SimpleNamespace

import nbformat
import pytest
from grading_class import notebook

from coursework.authoring.variation import Rule
from coursework.checking.plain import to_plain
from coursework.grading import grade as grading
from coursework.grading.export import gradebooks
from coursework.grading.grade import grade, regrade
from coursework.grading.judging import secret
from coursework.grading.judging.ledger import REJECTED, Collision, Ledger, with_decisions
from coursework.grading.judging.term import read_rules
from coursework.grading.reporting.course_pages import write_course
from coursework.grading.reporting.laboratory import Policies
from coursework.grading.store import Store

pytestmark = pytest.mark.usefixtures("libraries_are_loaded_once")

WEIGHTS = [12, 25, 31, 44, 57, 68, 73, 89]
ASSIGNMENTS = [f"hw{number}" for number in range(6)]
DUE = {
    name: datetime.datetime(2026, 10, 1, 12) + datetime.timedelta(weeks=number)
    for number, name in enumerate(ASSIGNMENTS)
}
LOAD, TWICE = 2, 3  # what the two questions of each assignment are worth


class Crash(BaseException):
    """The machine went down."""


def source(name, weights, times):
    return notebook(
        [
            "import sympy as sm\nfrom coursework import check, student, variant\nstudent('')",
            f"### BEGIN VARIANTS\nbeam = draw('{name}/load', count={len(weights)}, "
            f"weight={weights})\n### END VARIANTS",
            ("markdown", "A beam carries {{weight}} N twice. Give the whole load."),
            f"### BEGIN SOLUTION\nload = {times}*beam.weight\n### END SOLUTION",
            f"check('{name}/load', load)\n"
            "### BEGIN HIDDEN TESTS\n"
            f"question('{name}/load', kind='expression', worth={LOAD}, tolerance=0.01)\n"
            "### END HIDDEN TESTS",
            "### BEGIN SOLUTION\ndef twice(x):\n    return 2*x\n### END SOLUTION",
            f"check('{name}/twice', twice)\n"
            "### BEGIN HIDDEN TESTS\n"
            f"question('{name}/twice', kind='function', calls=[[1.5], [-2.0]], "
            f"result='expression', worth={TWICE})\n"
            "### END HIDDEN TESTS",
        ]
    )


def write_sources(folder, changed=()):
    """The sources of all assignments; ``changed`` says of some which weights
    there are and how often they count.
    """
    folder.mkdir(exist_ok=True)
    (folder / secret.FILE).write_text("5eed" * 16)
    for name in ASSIGNMENTS:
        weights, times = dict(changed).get(name, (WEIGHTS, 2))
        nbformat.write(source(name, weights, times), folder / f"{name}.ipynb")
    return folder


def own_weight(student, name):
    """The rule, written down a second time; which weight a number has is drawn."""
    digest = hashlib.sha256(f"\n{name}/load\n{student}".encode()).digest()
    return drawn(name)[int.from_bytes(digest[:8], "big") % len(WEIGHTS)]


@functools.cache
def drawn(name):
    rule = Rule(f"{name}/load", len(WEIGHTS), {"weight": WEIGHTS})
    return [rule.parameters(number)["weight"] for number in range(len(WEIGHTS))]


def run_without_a_sandbox(jobs, finish, *others):
    """What the sandbox would give for these notebooks, whose answers
    are numbers and names of functions.
    """

    def answer(job, name, about):
        code = "\n".join(cell["source"] for cell in job["cells"])
        found = re.search(rf"check\('{name}', (.*)\)", code)
        if found is None:
            return {"outcome": "missing"}
        if not about["calls"]:
            return {
                "outcome": "recorded",
                "plain": to_plain(int(found[1])),
                "from": "check",
                "cell": 0,
            }
        factor = {"twice": 2, "thrice": 3}[found[1]]
        said = {"outcome": "recorded", "from": "check", "cell": 0}
        for key, calls in (("plain", about["calls"]), ("secret", about["secret calls"])):
            plain = to_plain(lambda x: factor * x, calls["arguments"])
            said[key] = plain if key == "plain" else {"plain": plain}
        return said

    for order in range(len(jobs.work)):
        results = [
            {
                "id": job["id"],
                "finished": True,
                "cells": [{"outcome": "done"}] * len(job["cells"]),
                "answers": {
                    name: answer(job, name, about) for name, about in job["questions"].items()
                },
                "unknown questions": [],
                "notes": [],
                "runs": 1,
                "seed": 0,
                "isolation": {"layers": ["none: nothing was run"], "weak": False},
            }
            for job in jobs.of(order)
        ]
        yield finish(order, results)


class Term:
    """A term that is drawn by lot, and what each mark must come to."""

    def __init__(self, place, dice, students):
        self.place, self.dice = place, dice
        self.students = [f"student-{number:03}" for number in range(students)]
        self.work = {}  # by student and assignment: the load, the function, when it was handed in
        self.weights, self.times = (
            dict.fromkeys(ASSIGNMENTS, WEIGHTS),
            dict.fromkeys(ASSIGNMENTS, 2),
        )
        self.full_credit, self.never_lower, self.void = set(), set(), set()
        self.decided, self.extended = {}, {}
        self.points_before = {}

    def happens(self, share):
        return self.dice.random() < share

    def draw(self):
        """Who hands in what and when, and what their rights are."""
        for student in self.students:
            for name in ASSIGNMENTS:
                if self.happens(0.9):
                    late = (
                        self.dice.choice([-30, -1, 0, 5, 30, 100, 400]) if self.happens(0.4) else -5
                    )
                    self.work[student, name] = SimpleNamespace(
                        load=self.dice.choice(
                            [2 * own_weight(student, name)] * 5
                            + [
                                3 * own_weight(student, name),
                                1,
                                None,
                                2 * self.dice.choice(WEIGHTS),
                            ]
                        ),
                        function=self.dice.choice(["twice", "twice", "thrice", None]),
                        when=DUE[name] + datetime.timedelta(hours=late),
                    )
                if self.happens(0.08):
                    self.extended[student, name] = self.dice.choice(["excused", 48])

    # -- as it is written down for the grader

    def write(self):
        submitted = self.place / "class" / "submitted"
        shutil.rmtree(submitted, ignore_errors=True)
        # Who goes by two names.
        odd = {student: f"{student} (2)" for student in self.students if self.happens(0.2)}
        for (student, name), work in self.work.items():
            folder = submitted / odd.get(student, student) / name
            folder.mkdir(parents=True)
            cells = [
                f"check('{name}/{question}', {answer})"
                for question, answer in (("load", work.load), ("twice", work.function))
                if answer is not None
            ]
            made = notebook(
                [
                    "from coursework import check, student\nstudent('')",
                    *cells,
                    f"'{name}/load'; check",
                ]
            )
            nbformat.write(made, folder / f"{name}.ipynb")
            (folder / "timestamp.txt").write_text(f"{work.when.isoformat(' ')}.000000 UTC")
        table = [f"{student},{odd.get(student, '')}" for student in self.students]
        (self.place / "roster.csv").write_text("student,handed in as\n" + "\n".join(table) + "\n")
        rules = [
            'time-zone = "UTC"',
            "[late]",
            "a-day = 0.1",
            "most = 0.5",
            "nothing-after-days = 10",
        ]
        for name in ASSIGNMENTS:
            rules += [f"[assignments.{name}]", f"due = {DUE[name].isoformat()}"]
        for student in sorted({student for student, _ in self.extended}):
            rules.append(f"[extensions.{student}]")
            for (one, name), until in self.extended.items():
                if one == student:
                    more = (
                        until if until == "excused" else DUE[name] + datetime.timedelta(hours=until)
                    )
                    rules.append(
                        f'{name} = "excused"'
                        if until == "excused"
                        else f"{name} = {more.isoformat()}"
                    )
        (self.place / "term.toml").write_text("\n".join(rules) + "\n")

    # -- what must come of it

    def machine(self, student, name, question):
        work = self.work[student, name]
        if question == "twice":
            return TWICE if work.function == "twice" else 0
        weight = own_weight(student, name)
        taken_out = weight not in self.weights[name]
        times = 2 if taken_out else self.times[name]  # who had what is gone is judged as it stood
        if name in self.void:
            return 0
        if taken_out and name in self.full_credit:
            return LOAD
        points = LOAD if work.load == times * weight else 0
        first = LOAD if work.load == 2 * weight else 0
        return max(points, first) if name in self.never_lower else points

    def worth(self, name):
        return TWICE + (0 if name in self.void else LOAD)

    def points(self, student, name):
        total = 0
        for question, worth in (("load", 0 if name in self.void else LOAD), ("twice", TWICE)):
            credit = self.decided.get((student, name, question))
            total += self.machine(student, name, question) if credit is None else credit * worth
        return total

    def share_lost(self, student, name):
        until = self.extended.get((student, name), 0)
        late = (self.work[student, name].when - DUE[name]) / datetime.timedelta(days=1) - until / 24
        if late <= 0:
            return 0
        return 1 if late > 10 else min(0.5, 0.1 * -(-late // 1))

    def mark(self, student, name):
        """What the system must hold in the end: points, or nothing."""
        if (student, name) not in self.work or self.extended.get((student, name)) == "excused":
            return ""
        return round(self.points(student, name) * (1 - self.share_lost(student, name)), 2)

    def total(self, student):
        shares = []
        for name in ASSIGNMENTS:
            if self.extended.get((student, name)) == "excused":
                continue
            there = (student, name) in self.work
            shares.append(
                self.points(student, name) * (1 - self.share_lost(student, name)) / self.worth(name)
                if there
                else 0
            )
        return round(100 * sum(shares) / len(shares), 2) if shares else None


def with_crashes(dice, monkeypatch, do):
    """Do something during which the machine goes down now and then, as
    often as it takes to come to its end.
    """
    whole = Store.save
    for attempt in range(4):
        left = dice.randrange(1, 60) if attempt < 3 else None

        def save(store, record, left=[left]):  # noqa: B006
            if left[0] is not None:
                left[0] -= 1
                if left[0] < 0:
                    raise Crash
            whole(store, record)

        with monkeypatch.context() as patched:
            patched.setattr(Store, "save", save)
            try:
                return do()
            except Crash:
                pass
    raise AssertionError("the last attempt has no crash")


STORIES = (
    "stays", "collides", "again", "taken back", "both, and the second taken back", "appeal waits",
    "appeal rejected", "appeal accepted", "appeal accepted, and taken back",
)  # fmt: skip


def appeal_by_hand(ann, ben, record, name, decided, story):
    """The student appeals against what Ann decided, and Ben settles it; Ann comes too late."""
    raised = ann.appeal(record, name, "Look again.", who="Ann")
    if story == "appeal waits":
        return
    ben.read()
    (found,) = ben.standing().appeals[raised.key]
    if story == "appeal rejected":
        ben.appeal(record, name, "I did.", state=REJECTED, of=found, after=found.last, who="Ben")
    else:
        ben.append(
            [
                ben.decision(
                    record,
                    name,
                    1,
                    who="Ben",
                    after=decided.id,
                    appeal=found.id,
                    comment="So it is.",
                )
            ],
            collisions=True,
        )
    with pytest.raises(Collision):
        ann.appeal(record, name, "No.", state=REJECTED, of=found, after=found.last, who="Ann")
    if story == "appeal accepted, and taken back":
        ben.take_back([record], name, "Ben")


def judge_by_hand(term, store, dice):
    """Two people decide: on appeals, one upon the other's
    decision, and some take their own back.
    """
    ann, ben = Ledger(store.folder), Ledger(store.folder)
    records = list(store.all())
    for record in dice.sample(records, min(len(records), 2 + len(records) // 10)):
        question = dice.choice(["load", "twice"])
        name, key = f"{record.assignment}/{question}", (record.student, record.assignment, question)
        if key in term.decided:
            continue
        first, second = dice.choice([0, 0.25, 0.5, 1]), dice.choice([0, 0.5, 1])
        one = ann.decision(record, name, first, who="Ann")
        ann.append([one], collisions=True)
        term.decided[key] = first
        story = dice.choice(STORIES)
        if story.startswith("appeal"):
            appeal_by_hand(ann, ben, record, name, one, story)
            if story == "appeal accepted":
                term.decided[key] = 1
        if story == "collides":
            with pytest.raises(Collision):
                ben.append([ben.decision(record, name, second, who="Ben")], collisions=True)
        if story in ("again", "both, and the second taken back"):
            ben.read()
            ben.append(
                [ben.decision(record, name, second, who="Ben", after=one.id)], collisions=True
            )
            term.decided[key] = second
        if story == "both, and the second taken back":
            ben.take_back([record], name, "Ben")
            term.decided[key] = first
        if story == "taken back":
            ann.take_back([record], name, "Ann")
            del term.decided[key]


def go_through(term, monkeypatch, cache):
    """The term, command after command; gives the results."""
    dice, place, out = term.dice, term.place, term.place / "out"
    monkeypatch.setattr(grading, "_here", run_without_a_sandbox)
    term.draw()
    term.write()
    solutions = write_sources(place / "solutions")
    if cache.exists():
        shutil.copytree(cache, out / "questions")
    options = {"solutions": solutions, "roster": place / "roster.csv", "show": io.StringIO()}
    with_crashes(dice, monkeypatch, lambda: grade(place / "class", out, **options))
    judge_by_hand(term, Store(out), dice)
    # Some questions are mended: another right answer, or a variant less; with a policy or without.
    changed = {}
    for name in dice.sample(ASSIGNMENTS, 3):
        weights = (
            [weight for weight in WEIGHTS if weight != dice.choice(WEIGHTS)]
            if term.happens(0.6)
            else WEIGHTS
        )
        times = dice.choice([2, 3])
        changed[name] = term.weights[name], term.times[name] = weights, times
        chosen = dice.choice(["", "never_lower", "full_credit", "void"])
        if chosen:
            getattr(term, chosen).add(name)
    write_sources(solutions, changed)
    policies = Policies(
        never_lower=tuple(f"{name}/load" for name in sorted(term.never_lower)),
        full_credit=tuple(f"{name}/load@taken-out" for name in sorted(term.full_credit)),
        void=tuple(f"{name}/load" for name in sorted(term.void)),
    )
    before = [record.points for record in Store(out).all()]
    regrade(out, solutions=solutions, policies=policies, dry_run=True)
    assert [record.points for record in Store(out).all()] == before
    with_crashes(
        dice,
        monkeypatch,
        lambda: regrade(out, solutions=solutions, policies=policies, show=options["show"]),
    )
    # Some hand in again, and all is graded once more.
    for (student, name), work in dice.sample(sorted(term.work.items(), key=lambda one: one[0]), 3):
        if work.function != "twice":
            # It belonged to the answer that was looked at.
            term.decided.pop((student, name, "twice"), None)
        work.function = "twice"
    rewrite(term)
    with_crashes(dice, monkeypatch, lambda: grade(place / "class", out, **options))
    judge_by_hand(term, Store(out), dice)
    cache.parent.mkdir(exist_ok=True)
    shutil.copytree(out / "questions", cache, dirs_exist_ok=True)
    return Store(out)


def rewrite(term):
    """Write the notebooks anew, in the folders that they lie in."""
    for path in (term.place / "class" / "submitted").glob("*/*/*.ipynb"):
        student, name = path.parts[-3].removesuffix(" (2)"), path.parts[-2]
        made, work = nbformat.read(path, as_version=4), term.work[student, name]
        if work.function == "twice":
            made.cells = [cell for cell in made.cells if f"{name}/twice" not in cell.source]
            made.cells.append(
                nbformat.v4.new_code_cell(f"check('{name}/twice', twice)", id="again")
            )
            nbformat.write(made, path)


def final_marks(term, store):
    """What the system holds in the end, having been filled twice: by
    then, and after the last decisions.
    """
    rules, found = read_rules(term.place / "term.toml"), {}
    for name in ASSIGNMENTS:
        book = term.place / f"{name}.csv"
        lines = [
            f'"{student}",{number},,{student},x,' for number, student in enumerate(term.students, 1)
        ]
        book.write_text(
            f"Student,ID,SIS User ID,SIS Login ID,Section,{name} (7)\n" + "\n".join(lines) + "\n"
        )
        filled = term.place / f"{name}-filled.csv"
        for _ in range(2):
            gradebooks.fill(book, gradebooks.Marks(store, name, rules), filled=filled)
            book.write_bytes(filled.read_bytes())
        for line in filled.read_text().splitlines()[1:]:
            cells = line.split(",")
            found[cells[3], name] = float(cells[5]) if cells[5] else ""
    return found


def decide_what_waits(store):
    """What no program could decide is decided in the end; nothing of it was right."""
    ledger = Ledger(store.folder)
    standing = ledger.standing()
    for record in store.all():
        for name, mark in with_decisions(record, standing).marks.items():
            if mark.outcome == "undecided":
                assert mark.note == "numbers of another edition", mark
                ledger.add(record, name, 0, who="Ann")


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("terms") / "questions"


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    "number",
    [
        *range(2),
        *(pytest.param(number, marks=pytest.mark.long) for number in range(2, 49)),
        pytest.param(200, marks=pytest.mark.long),
    ],
)
def test_in_the_end_every_mark_is_right(number, tmp_path, monkeypatch, cache):
    term = Term(tmp_path, random.Random(f"term {number}"), 200 if number == 200 else 15)
    store = go_through(term, monkeypatch, cache)
    decide_what_waits(store)
    found = final_marks(term, store)
    wrong = {
        key: (mark, term.mark(*key))
        for key, mark in found.items()
        if mark != pytest.approx(term.mark(*key), abs=0.006)
    }
    assert not wrong
    write_course(
        store,
        read_rules(tmp_path / "term.toml"),
        now=datetime.datetime(2027, 1, 1, tzinfo=datetime.UTC),
    )
    rows = (store.folder / "course" / "course.csv").read_text().splitlines()[1:]
    totals = {row.split(",")[0].strip('"'): row.split(",")[1].strip('"') for row in rows}
    for student in term.students:
        total = term.total(student)
        assert total is None or float(totals[student]) == pytest.approx(total, abs=0.011), student


def test_the_oracle_is_no_copy(tmp_path):
    """It would notice: with one point less in the story, or one day more, other marks are due."""
    term = Term(tmp_path, random.Random("one"), 3)
    student, name = "student-000", "hw0"
    term.work[student, name] = SimpleNamespace(
        load=2 * own_weight(student, name), function="twice", when=DUE[name]
    )
    assert term.mark(student, name) == 5
    term.work[student, name].when += datetime.timedelta(hours=25)
    assert term.mark(student, name) == 4
    term.times[name] = 3
    assert term.mark(student, name) == pytest.approx(2.4)
    assert json.dumps(term.weights)
