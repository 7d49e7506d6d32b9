"""Whole terms, drawn at random from all ordinary acts, by commands alone.

The oracle knows the story and not the software. Every mark must be the expected one, and none may
change before the output has said who would gain and who would lose.
"""

import contextlib
import csv
import datetime
import functools
import hashlib
import io
import random
from types import SimpleNamespace

import nbformat
import pytest
from course_by_commands import read_table, write_table
from trial_course import notebook
from without_a_sandbox import run_without_a_sandbox

from coursework.__main__ import main
from coursework.authoring.variation import Rule
from coursework.grading import review as reviewing
from coursework.grading import running
from coursework.grading.judging import secret
from coursework.grading.judging.journal import FILE, Given, Journal
from coursework.grading.store import Store

WEIGHTS = [12, 25, 31, 44]
NAMES = ["hw0", "hw1"]
STUDENTS = ["ada", "ben", "cem", "dan", "eva", "fay"]
TEAM, MEMBERS = "team", ("eva", "fay")
WORKERS = ["ada", "ben", "cem", "dan", TEAM]
DUE = {
    name: datetime.datetime(2025, 10, 6, 12) + datetime.timedelta(weeks=number)
    for number, name in enumerate(NAMES)
}
OUT_OF = 10
QUESTIONS = ("load", "twice", "why")


class Crash(BaseException):
    """The machine crashed."""


def source(name, asked):
    return notebook([
        "import sympy as sm\nfrom coursework import check, student, variant\nstudent('')",
        f"### BEGIN VARIANTS\nbeam = draw('{name}/load', count={len(asked.weights)}, "
        f"weight={asked.weights})\n### END VARIANTS",
        ("markdown", "A beam carries {{weight}} N twice. Give the whole load."),
        f"### BEGIN SOLUTION\nload = {asked.times}*beam.weight\n### END SOLUTION",
        f"check('{name}/load', load)\n### BEGIN HIDDEN TESTS\nquestion('{name}/load', "
        f"kind='expression', worth={asked.worth}, tolerance=0.01)\n### END HIDDEN TESTS",
        "### BEGIN SOLUTION\ndef twice(x):\n    return 2*x\n### END SOLUTION",
        f"check('{name}/twice', twice)\n### BEGIN HIDDEN TESTS\nquestion('{name}/twice', "
        "kind='function', calls=[[1.5], [-2.0]], result='expression', worth=3)\n"
        "### END HIDDEN TESTS",
        "### BEGIN SOLUTION\nwhy = 'By the arm.'\n### END SOLUTION",
        f"check('{name}/why', why)\n### BEGIN HIDDEN TESTS\n"
        f"question('{name}/why', kind='free text', worth=2)\n### END HIDDEN TESTS",
    ])  # fmt: skip


@functools.cache
def own_weight(worker, name):
    """The rule, written independently; which weight a number has is drawn."""
    digest = hashlib.sha256(f"\n{name}/load\n{worker}".encode()).digest()
    rule = Rule(f"{name}/load", len(WEIGHTS), {"weight": WEIGHTS})
    return rule.parameters(int.from_bytes(digest[:8], "big") % len(WEIGHTS))["weight"]


class Story:
    """What happened, and the marks that must result."""

    def __init__(self, place, number, monkeypatch, questions):
        self.place, self.dice, self.monkeypatch = (
            place,
            random.Random(f"term {number}"),
            monkeypatch,
        )
        self.asked = {name: SimpleNamespace(times=2, worth=5, weights=WEIGHTS) for name in NAMES}
        self.attempts = {}  # By worker and assignment.
        self.last_asked = {}  # The question as it stood when the worker was last judged.
        self.decided = {}  # By worker, assignment and question: the answer, and the credit.
        self.said = {}  # The latest automatic mark, and the answer it was for.
        self.given, self.graded = {}, {}  # The marks, and the attempts that they belong to.
        self.policies = {"never-lower": set(), "full-credit": set(), "void": set()}
        self.which = self.dice.choice(["newest in time", "newest in time", "last"])
        self.full = {}  # The question when it was last graded with all variants.
        self.extended, self.cells, self.by_hand = {}, {}, set()
        self.tables, self.events = [], []
        self.heard = []  # All commands, and their output.
        (place / "solutions").mkdir()
        (place / "solutions" / secret.FILE).write_text("5eed" * 16)
        (place / "marks").mkdir()
        (place / "marks" / "questions").symlink_to(questions)
        for name in NAMES:
            (place / "handed-in" / name).mkdir(parents=True)
            self.write_source(name)
        self.write_term()
        lines = [f"{student},{student.capitalize()} Lee" for student in STUDENTS]
        (place / "roster.csv").write_text("student,name\n" + "\n".join(lines) + "\n")
        columns = [f"{name} Points Grade <Numeric MaxPoints:{OUT_OF}>" for name in NAMES]
        header = ["OrgDefinedId", "Username", "Last Name", "First Name", *columns]
        rows = [
            [f"#{student}", f"#{student}", "Lee", student.capitalize(), *[""] * len(NAMES), "#"]
            for student in STUDENTS
        ]
        with open(place / "book.csv", "w", newline="") as file:
            csv.writer(file).writerows([[*header, "End-of-Line Indicator"], *rows])

    # -- writing files

    def write_source(self, name):
        nbformat.write(source(name, self.asked[name]), self.place / "solutions" / f"{name}.ipynb")

    def write_term(self):
        lines = ['time-zone = "UTC"', 'roster = "../roster.csv"', f'attempts = "{self.which}"']
        lines += ["[late]", "a-day = 0.1"]
        lines += ["most = 0.5", "nothing-after-days = 10"]
        for name in NAMES:
            lines += [f"[assignments.{name}]", f"due = {DUE[name].isoformat()}"]
            lines.append(f'column = "{name} Points Grade"')
        lines += ["[groups]", f"{TEAM} = {list(MEMBERS)}", "[regrading]"]
        for policy, names in self.policies.items():
            gone = "@taken-out" if policy == "full-credit" else ""
            lines.append(f"{policy} = {[f'{name}/load{gone}' for name in sorted(names)]}")
        for student in STUDENTS:
            those = {name: until for (who, name), until in self.extended.items() if who == student}
            if those:
                lines.append(f"[extensions.{student}]")
                for name, until in those.items():
                    moment = '"excused"'
                    if until != "excused":
                        moment = (DUE[name] + datetime.timedelta(hours=until)).isoformat()
                    lines.append(f"{name} = {moment}")
        (self.place / "marks" / "term.toml").write_text("\n".join(lines) + "\n")

    def write_attempt(self, worker, name, attempt):
        """Write it as Brightspace hands it out, in a folder for each attempt, with its time."""
        who = self.dice.choice(MEMBERS) if worker == TEAM else worker
        when = f"{attempt.when:%b} {attempt.when.day}, {attempt.when:%Y} {attempt.when:%I%M %p}"
        folder = self.place / "handed-in" / name
        number = 100 + STUDENTS.index(who)
        attempt.path = folder / f"{number}-7 - {who.capitalize()} Lee - {when}" / f"{name}.ipynb"
        attempt.path.parent.mkdir(exist_ok=True)
        self.write_notebook(worker, name, attempt)
        if attempt.has_copy:
            copy = notebook(
                f"check('{name}/{variable}', {variable})" for variable in ("load", "why")
            )
            nbformat.write(copy, attempt.path.with_name(f"{name}-Copy1.ipynb"))

    @staticmethod
    def write_notebook(worker, name, attempt):
        cells = ["from coursework import check, student\nstudent('')"]
        for question in QUESTIONS:
            answer = getattr(attempt, question)
            shown = "..." if answer is None else repr(answer) if question == "why" else answer
            cells.append(f"check('{name}/{question}', {shown})")
        made = notebook([*attempt.comments, *cells])
        if attempt.is_blank:
            made = notebook(
                f"check('{name}/{variable}', {variable})" for variable in ("load", "why")
            )
        # Show the text of the archive that the student has.
        text = f"A beam carries {own_weight(worker, name)} N twice. Give the whole load."
        made.cells[-1].outputs = [nbformat.v4.new_output("display_data", {"text/markdown": text})]
        nbformat.write(made, attempt.path)

    # -- commands

    def run(self, *words, crash=None):
        """Run a command; marks may change only with a yes, after the output has said so.

        With `crash`, the machine crashes after so many steps, and the command is run again.
        """
        before, said = self.parts(), io.StringIO()
        for left in ([crash] if crash else []) + [None]:
            with self.monkeypatch.context() as patched, contextlib.suppress(Crash):
                patched.setattr("sys.stdin", io.StringIO())
                steps = [left]
                for kind, step in ((Store, "stage"), (Store, "promote"), (Journal, "append")):
                    patched.setattr(kind, step, or_crash(steps, getattr(kind, step)))
                with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
                    try:
                        main([*map(str, words)])
                    except SystemExit as ended:
                        print(ended.code, file=said)
        after, text = self.parts(), said.getvalue()
        self.heard.append((words, text))
        assert "Traceback" not in text, text
        for key, (points, worth, outcome) in before.items():
            if outcome != "undecided" and after[key][:2] != (points, worth):
                worker, name, question = key
                assert "--yes" in words and any(
                    line.startswith(f"  '{worker}', {name}: ") and f"{name}/{question}" in line
                    for line in text.splitlines()
                ), (key, before[key], after[key], words, text)
        return text

    def parts(self):
        """Return all marks as they were given, by question."""
        if not (self.place / "marks" / FILE).exists():
            return {}
        marks = {}
        for event in Journal(self.place / "marks").events:
            if isinstance(event, Given):
                for question, part in event.marks.items():
                    own = question.partition("/")[2]
                    marks[event.student, event.assignment, own] = (
                        part.points,
                        part.worth,
                        part.outcome,
                    )
        return marks

    # -- the expected result

    def counting(self, worker, name):
        """Return the attempt that counts."""

        def rank(attempt):
            in_time = self.which == "last" or self.hours_late(worker, name, attempt) <= 0
            return (not attempt.is_blank, in_time, attempt.when)

        return max(self.attempts[worker, name], key=rank)

    def lost(self, worker, name, attempt):
        late = self.hours_late(worker, name, attempt)
        return 0 if late <= 0 else 1 if late > 240 else min(0.5, 0.1 * -(-late // 24))

    def hours_late(self, worker, name, attempt):
        more = [
            self.extended.get((member, name), 0)
            for member in (MEMBERS if worker == TEAM else (worker,))
        ]
        extra = max([hours for hours in more if hours != "excused"], default=0)
        return (attempt.when - DUE[name]) / datetime.timedelta(hours=1) - extra

    def machine(self, worker, name, answers):
        """Return the automatic marks by the current questions: points, worth, and what waits."""
        asked, key = self.asked[name], (worker, name)
        weight, times, worth = own_weight(*key), asked.times, asked.worth
        # Students whose variant is gone are judged as before.
        if weight not in asked.weights:
            times, worth = self.last_asked.get(key) or self.full[name]
        load = worth * (answers["load"] == times * weight)
        before = self.said.get((*key, "load"))
        if name in self.policies["void"]:
            load = worth = 0
        elif weight not in asked.weights and name in self.policies["full-credit"]:
            load = worth
        elif name in self.policies["never-lower"] and before and before[0] == answers["load"]:
            load = max(load, before[1] / before[2] * worth if before[2] else 0)
        return {
            "load": (load, worth, False),
            "twice": (3 * (answers["twice"] == "twice"), 3, False),
            "why": (0, 2, answers["why"] is not None),
        }

    def with_decisions(self, worker, name, answers, machine):
        marks = {}
        for question, (points, worth, waits) in machine.items():
            by_hand = self.decided.get((worker, name, question))
            if by_hand and by_hand.answer == answers[question]:
                points, waits = by_hand.credit * worth, False
            marks[question] = (points, worth, waits)
        return marks

    def settle(self, key, attempt, yes):
        """Give marks; earlier ones change only with a yes."""
        answers, machine, old = attempt.answers, attempt.machine, self.given.get(key)
        new = self.with_decisions(*key, answers, machine)
        moves = old and any(
            not old[question][2] and (old[question][:2] != new[question][:2] or new[question][2])
            for question in QUESTIONS
        )
        if moves and not yes:
            return
        asked = self.asked[key[1]]
        if own_weight(*key) in asked.weights:
            self.last_asked[key] = (asked.times, asked.worth)
        elif old is None:
            self.last_asked[key] = self.full[key[1]]
        self.given[key], self.graded[key] = new, attempt
        for question, (points, worth, _) in machine.items():
            self.said[(*key, question)] = (answers[question], points, worth)

    def grade(self, name, yes, crash=None):
        words = ["grade", self.place / "handed-in" / name, "--out", self.place / "marks"]
        words += ["--solutions", self.place / "solutions", *yes]
        self.run(*words, crash=crash)
        self.saw(name)
        for worker in WORKERS:
            if (worker, name) in self.attempts:
                attempt = self.snapshot(worker, name, self.counting(worker, name))
                self.settle((worker, name), attempt, yes)

    def saw(self, name):
        """Record that the class was graded by the question as it is now."""
        asked = self.asked[name]
        if asked.weights == WEIGHTS:
            self.full[name] = asked.times, asked.worth

    def snapshot(self, worker, name, attempt):
        """Return an attempt as it is judged now."""
        answers = {question: getattr(attempt, question) for question in QUESTIONS}
        return SimpleNamespace(
            answers=answers, when=attempt.when, machine=self.machine(worker, name, answers)
        )

    def regrade(self, yes, crash=None):
        words = [self.place / "marks", "--solutions", self.place / "solutions", *yes]
        self.run("regrade", *words, crash=crash)
        for name in {name for _, name in self.graded}:
            self.saw(name)
        for key, attempt in list(self.graded.items()):
            machine = self.machine(*key, attempt.answers)
            self.settle(key, SimpleNamespace(**vars(attempt) | {"machine": machine}), yes)

    def merge(self, file, who, yes, crash=None):
        words = ["merge", self.place / "marks", file, "--grader", who, *yes]
        text = self.run(*words, crash=crash)
        self.bring_in(yes)
        return text

    def bring_in(self, yes):
        for key, attempt in list(self.graded.items()):
            self.settle(key, attempt, yes)

    def check(self):
        """Check that every mark given is the one that the story requires."""
        expected = {
            (*key, question): pytest.approx((points, worth))
            for key, marks in self.given.items()
            for question, (points, worth, _) in marks.items()
        }
        there = self.parts()
        assert {key: part[:2] for key, part in there.items()} == expected, self.heard[-1]
        waits = {key for key, part in there.items() if part[2] == "undecided"}
        assert waits == {
            (*key, question)
            for key, marks in self.given.items()
            for question in QUESTIONS
            if marks[question][2]
        }
        records = {
            (record.student, record.assignment, name.partition("/")[2]): (mark.points, mark.worth)
            for record in Store(self.place / "marks").all()
            for name, mark in record.marks.items()
        }
        assert records == expected

    # -- acts

    def somebody(self, keys):
        return self.dice.choice(sorted(keys))

    def act_hand_in(self, crash, yes):
        key = worker, name = self.dice.choice(WORKERS), self.dice.choice(NAMES)
        if self.asked[name].weights != WEIGHTS and not (key in self.given or name in self.full):
            # Nobody can know any more which archive they had.
            return
        hours, number = self.dice.choice([-30, -2, 5, 30, 300]), len(self.attempts.get(key, ()))
        weight, load = own_weight(*key), self.dice.choice([2, 2, 3, 7])
        attempt = SimpleNamespace(
            load=self.dice.choice([load * weight, load * weight, None]),
            twice=self.dice.choice(["twice", "thrice", None]),
            why=self.dice.choice(["By the arm.", f"So says {worker}, {number}.", None]),
            when=DUE[name] + datetime.timedelta(hours=hours, minutes=number),
            is_blank=self.dice.random() < 0.15,
            has_copy=self.dice.random() < 0.15,
            comments=[],
        )
        if attempt.is_blank:
            attempt.load = attempt.twice = attempt.why = None
        self.attempts.setdefault(key, []).append(attempt)
        self.write_attempt(worker, name, attempt)

    def act_grade(self, crash, yes):
        name = self.dice.choice(NAMES)
        if any(key[1] == name for key in self.attempts):
            self.grade(name, yes, crash)

    def act_regrade(self, crash, yes):
        if self.given:
            self.regrade(yes, crash)

    def act_mend(self, crash, yes):
        name = self.dice.choice(NAMES)
        asked = self.asked[name]
        what = self.dice.choice(["times", "worth", "weights"])
        waits = any(key[1] == name and key not in self.given for key in self.attempts)
        if what == "weights" and (name in self.full or not waits):
            asked.weights = WEIGHTS[1:] if asked.weights == WEIGHTS else WEIGHTS
        elif what in ("times", "weights"):
            asked.times = 5 - asked.times
        else:
            asked.worth = 13 - asked.worth
        self.write_source(name)

    def act_choose(self, crash, yes):
        """Choose a policy, an extension, or an excuse."""
        name = self.dice.choice(NAMES)
        if self.dice.random() < 0.5:
            if not any(name in names for names in self.policies.values()):
                self.policies[self.dice.choice(sorted(self.policies))].add(name)
        else:
            self.extended[self.dice.choice(STUDENTS), name] = self.dice.choice(["excused", 48])
        self.write_term()

    def act_comment(self, crash, yes):
        """Add a cell with a comment, and nothing else, to a submitted notebook."""
        if self.attempts:
            key = self.somebody(self.attempts)
            attempt = self.counting(*key)
            attempt.comments.append("# what I thought")
            if not attempt.is_blank:
                self.write_notebook(*key, attempt)

    def act_table(self, crash, yes):
        """A tutor fills in the table of what waits, either the current one or an older one."""
        path = self.place / "marks" / "undecided.csv"
        if path.exists() and (not self.tables or self.dice.random() < 0.7):
            rows = [
                row | {"credit": str(self.dice.choice([0, 0.5, 1]))}
                for row in read_table(path)
                if row["question"].endswith("/why")
            ]
            answers = [
                self.graded[row["student"], row["question"][:3]].answers["why"] for row in rows
            ]
            if rows:
                self.tables.append((self.dice.choice(["Ann", "Ben"]), rows, answers))
        if not self.tables:
            return
        who, rows, answers = self.dice.choice(self.tables)
        file = write_table(self.place / "decided.csv", rows)
        for row, answer in zip(rows, answers, strict=True):
            key = row["student"], row["question"][:3], "why"
            there = self.decided.get(key)
            if self.graded[key[:2]].answers["why"] != answer:
                # It was handed in again, and nobody has read that.
                continue
            if there is None or there.answer != answer or there.who == who:
                self.decided[key] = SimpleNamespace(
                    answer=answer, credit=float(row["credit"]), who=who
                )
        self.merge(file, who, yes, crash)

    def act_tutor(self, crash, yes):
        """Another tutor decides on any answers in a separate folder, which is merged."""
        if not self.given:
            return
        folder = self.place / f"tutor-{len(self.events)}"
        folder.mkdir()
        self.events.append(folder)
        for key in self.dice.sample(sorted(self.given), min(2, len(self.given))):
            question, credit = self.dice.choice(QUESTIONS), self.dice.choice([0, 0.25, 1])
            record = Store(self.place / "marks").read(*key)
            Journal(folder).add(record, f"{key[1]}/{question}", credit, who="Cem")
            self.decided[(*key, question)] = SimpleNamespace(
                answer=self.graded[key].answers[question], credit=credit, who="Cem"
            )
        self.merge(folder / FILE, "Ann", yes, crash)

    def act_appeal(self, crash, yes):
        """A student appeals, and a tutor gives all of the points."""
        if not self.given:
            return
        key = self.somebody(self.given)
        question = self.dice.choice(QUESTIONS)
        name, file = f"{key[1]}/{question}", self.place / "appeals.csv"
        file.write_text(f"student,question,words\n{key[0]},{name},Look again.\n")
        self.merge(file, "Ann", yes, crash)
        journal = Journal(self.place / "marks")
        appeals = journal.standing().appeals.get((*key, name), ())
        if self.dice.random() < 0.7 and appeals and appeals[-1].is_open:
            record = Store(self.place / "marks").read(*key)
            there = journal.standing().decisions.get((*key, name))
            decision = journal.decision(
                record,
                name,
                1,
                who="Ben",
                appeal=appeals[-1].id,
                after=there.id if there else "",
            )
            journal.append([decision], collisions=True)
            self.decided[(*key, question)] = SimpleNamespace(
                answer=self.graded[key].answers[question], credit=1, who="Ben"
            )

    def act_page(self, crash, yes):
        """A tutor decides on the page, and stops it."""
        if not self.given:
            return
        key = self.somebody(self.given)
        question, credit = self.dice.choice(QUESTIONS), self.dice.choice([0, 0.5, 1])
        name = f"{key[1]}/{question}"

        def serve(out, grader, **more):
            journal, record = Journal(self.place / "marks"), Store(out).read(*key)
            there = journal.standing().decisions.get((*key, name))
            decision = journal.decision(
                record, name, credit, who=grader, after=(there.id if there else "")
            )
            journal.append([decision], collisions=True)
            raise KeyboardInterrupt

        self.monkeypatch.setattr(reviewing, "review", serve)
        answer = self.graded[key].answers[question]
        self.decided[(*key, question)] = SimpleNamespace(answer=answer, credit=credit, who="Ann")
        self.run("review", self.place / "marks", "--grader", "Ann", *yes, crash=crash)
        self.bring_in(yes)

    def act_export(self, crash, yes):
        """Fill the gradebook, after somebody changed a mark in it by hand."""
        if not self.given:
            return
        rows = list(csv.reader((self.place / "book.csv").read_text().splitlines()))
        graded = {name for _, name in self.given}
        if self.dice.random() < 0.2:
            number, name = self.dice.randrange(len(STUDENTS)), self.dice.choice(NAMES)
            rows[1 + number][4 + NAMES.index(name)] = "0.37"
            self.cells[STUDENTS[number], name] = "0.37"
            self.by_hand.add((STUDENTS[number], name))
            with open(self.place / "book.csv", "w", newline="") as file:
                csv.writer(file).writerows(rows)
        book = self.place / "book.csv"
        self.run("export", self.place / "marks", *["--lms", book, "--filled", book], crash=crash)
        for student in STUDENTS:
            for name in graded:
                cell = student, name
                value = self.column(student, name)
                if value is not None and cell not in self.by_hand:
                    self.cells[cell] = value
        rows = list(csv.reader(book.read_text().splitlines()))
        for student, row in zip(STUDENTS, rows[1:], strict=True):
            for name, there in zip(NAMES, row[4:], strict=False):
                expected = self.cells.get((student, name), "")
                assert there == expected or float(there) == pytest.approx(expected, abs=0.011), (
                    student, name, there, expected
                )  # fmt: skip

    def column(self, student, name):
        """Return what is written for a student; ``None`` if a decision is pending."""
        key = (TEAM if student in MEMBERS else student), name
        if self.extended.get((student, name)) == "excused":
            return None
        if key not in self.given:
            return 0
        marks = self.given[key].values()
        if any(waits for _, _, waits in marks):
            return None
        lost = self.lost(*key, self.graded[key])
        points, worth = (sum(mark[place] for mark in marks) for place in (0, 1))
        return points * (1 - lost) * OUT_OF / worth


def or_crash(steps, do):
    """Do something, unless the machine crashes first."""

    def step(*arguments, **more):
        if steps[0] is not None:
            steps[0] -= 1
            if steps[0] < 0:
                raise Crash
        return do(*arguments, **more)

    return step


ACTS = ["hand_in"] * 8 + ["grade"] * 5 + ["regrade"] * 2 + ["mend"] * 2 + ["export"] * 3
ACTS += ["choose", "comment", "table", "table", "tutor", "appeal", "page"]


@pytest.fixture(scope="module")
def questions(tmp_path_factory):
    """The processed questions, shared by all terms."""
    return tmp_path_factory.mktemp("questions")


# All of fifty drawn terms passed; these five cover every policy about attempts.
@pytest.mark.parametrize("number", range(5))
def test_every_mark_is_that_of_the_story_and_no_move_is_unsaid(
    number, tmp_path, monkeypatch, questions
):
    monkeypatch.setattr(running, "here", run_without_a_sandbox)
    story = Story(tmp_path, number, monkeypatch, questions)
    for _ in range(30):
        act = story.dice.choice(ACTS)
        yes = ["--yes"] if story.dice.random() < 0.6 else []
        crash = story.dice.randrange(1, 8) if story.dice.random() < 0.2 else None
        getattr(story, f"act_{act}")(crash, yes)
        story.check()
    for name in NAMES:
        if any(key[1] == name for key in story.attempts):
            story.grade(name, ["--yes"])
    if story.given:
        story.regrade(["--yes"])
        story.check()
        story.act_export(None, [])
