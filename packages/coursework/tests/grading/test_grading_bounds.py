"""Judging is bounded for any answer, and a crash at any time loses nothing and repeats nothing."""

import hashlib
import json
import random
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import sympy as sm
from grading_class import write_sources

from coursework.checking.plain import NotPlain, to_plain
from coursework.grading.judging import marking
from coursework.grading.judging.cases import Contracts
from coursework.grading.judging.journal import Decision, Journal
from coursework.grading.judging.judge import Judge
from coursework.grading.record import Answer, Record
from coursework.grading.store import Store

NAME = "turns/sum"
alpha, beta = sm.symbols("alpha beta")


@pytest.fixture(scope="module")
def questions(tmp_path_factory):
    return marking.questions_of(
        write_sources(tmp_path_factory.mktemp("bounds") / "s") / "turns.ipynb", b"secret"
    )


def ordinary(dice, depth=0):
    """Return an expression like a student's, in which numbers may be tiny or huge."""
    if depth > 3 or dice.random() < 0.25:
        size = dice.choice([1, 1, 10, 1e-3, 1e-30, 1e30, 1e-300, 1e300])
        number = sm.Float(dice.uniform(-3, 3) * size)
        power = sm.Float(10) ** dice.choice([-40, -2000, -99999, 40, 5000, 999999])
        return dice.choice(
            [alpha, beta, alpha, beta, sm.Integer(dice.randint(-9, 9)), number, sm.pi, sm.I, power]
        )
    parts = [ordinary(dice, depth + 1) for _ in range(2)]
    unary = [
        sm.sin,
        sm.cos,
        sm.tan,
        sm.exp,
        sm.log,
        sm.sqrt,
        sm.asin,
        sm.atan,
        sm.Abs,
        sm.sinh,
        sm.conjugate,
        sm.arg,
    ]
    way = dice.randrange(6)
    with sm.evaluate(False):
        if way == 0:
            return sm.Add(*parts)
        if way == 1:
            return sm.Mul(*parts)
        if way == 2:
            return sm.Pow(*parts)
        return sm.atan2(*parts) if way == 3 else dice.choice(unary)(parts[0])


def judged(answers, questions, folder):
    """Return a new judge's marks of these answers, each in its own record."""
    said = []
    with Judge({"turns": {NAME: questions[NAME]}}, Contracts(folder), said.append) as judge:
        for number, plain in enumerate(answers):
            record = Record(
                f"{number}",
                "turns",
                answers={NAME: Answer("recorded", plain, source="check", cell=0)},
            )
            yield judge.marks(record)[NAME]
    assert said == []


def test_ordinary_answers_are_judged_in_bounded_time_and_memory(questions, tmp_path):
    dice, answers = random.Random("answers 100"), []
    while len(answers) < 100:
        try:
            answers.append(to_plain(ordinary(dice)))
        except NotPlain:
            pass
    # None takes so much that the judge must be ended, which would be reported.
    outcomes = {mark.outcome for mark in judged(answers, questions, tmp_path)}
    assert (
        outcomes <= {"wrong", "invalid", "undecided", "correct"}
        and {"wrong", "invalid"} <= outcomes
    )


def _tower(dice, what):
    """Return an answer of many nodes, each made to cost much."""
    nodes = [
        ["symbol", "alpha"],
        ["constant", "ImaginaryUnit"],
        ["float", "1e-999999"],
        ["integer", "9999"],
    ]
    nodes += [["float", "1e-300"], ["rational", "1", "3"], ["Add", 1, 2], ["Mul", 2, 1]]
    for _ in range(3_000):
        last = len(nodes) - 1
        nodes.append(
            {
                "powers": ["Pow", last, 3],
                "complex powers": ["Pow", dice.choice([6, 7, last]), 4],
                "logarithms": ["log", dice.choice([6, 7, last])],
                "squares": ["Mul", last, last],
                "tiny": ["Mul", last, 2],
                "angles": ["atan2", dice.choice([2, last]), dice.choice([2, 4])],
                "inverse": [dice.choice(["asin", "acos", "atanh", "acosh"]), dice.choice([6, 7])],
                "mixed": [
                    dice.choice(["sin", "exp", "log", "tan", "acoth", "Abs", "arg"]),
                    dice.choice([2, 6, 7, last]),
                ],
                "remainders": ["Mod", dice.choice([0, 4, last]), 2],
                "sums": ["Add", *(dice.randrange(last) for _ in range(20))],
            }[what]
        )
    return {"value": ["expression", len(nodes) - 1], "nodes": nodes}


HOSTILE = (
    "powers", "complex powers", "logarithms", "squares", "tiny", "angles", "inverse", "mixed",
    "remainders", "sums"
)  # fmt: skip


def test_hostile_answers_leave_every_other_mark(questions, tmp_path):
    dice = random.Random("hostile")
    hostile = [_tower(dice, what) for what in HOSTILE]
    honest = [to_plain(sm.sin(alpha + beta)), to_plain(-sm.sin(alpha + beta))]
    marks = list(
        judged([answer for bad in hostile for answer in (bad, *honest)], questions, tmp_path)
    )
    assert [mark.outcome for mark in marks[1::3]] == ["correct"] * len(hostile)
    assert [mark.note for mark in marks[2::3]] == ["opposite"] * len(hostile)
    assert not any(mark.points for mark in marks[::3])


# --- crashes ------------------------------------------------------------------------------------

#: A process with everything loaded. For each line that it reads it forks a copy, which is killed
#: after a time or runs to its end, and it returns the copy's output and duration.
PROGRAM = """
import io, json, os, select, signal, sys, time, traceback, warnings
sys.path.insert(0, {tests!r})
from without_a_sandbox import run_without_a_sandbox
from coursework.__main__ import main
from coursework.grading import grade as grading, running
from coursework.grading.judging.journal import Journal
from coursework.grading.store import Store
from pathlib import Path

warnings.simplefilter("ignore")
running.here = run_without_a_sandbox

def do(place, what):
    store, silent = Store(place / "out"), io.StringIO()
    if what == "grade":
        submitted = place / "handed-in" / "hw0"
        grading.grade(submitted, place / "out", solutions=place / "solutions", show=silent)
    elif what == "regrade":
        grading.regrade(place / "out", solutions=place / "mended", show=silent)
    elif what == "bring in":
        grading.bring_in_decisions(place / "out", show=silent)
    elif what == "export":
        table = str(place / "book.csv")
        main(["export", str(place / "out"), "--lms", table, "--assignment", "hw0"])
    else:
        journal = Journal(store.folder)
        for record in store.all():
            for name in record.marks:
                print("id", journal.add(record, name, 0.5, who="Ann").id, flush=True)
                key = record.student, record.assignment, name
                if not journal.standing().appeals.get(key):
                    print("id", journal.appeal(record, name, "Again.", who="Ann").id, flush=True)

for line in sys.stdin:
    place, what, killed_after = json.loads(line)
    hears, says = os.pipe()
    begun = time.monotonic()
    child = os.fork()
    if not child:
        os.dup2(says, 1)
        try:
            do(Path(place), what)
            print("ended", flush=True)
        except BaseException:
            traceback.print_exc(file=sys.stdout)
            sys.stdout.flush()
        os._exit(0)
    os.close(says)
    said, killed = b"", False
    while True:
        left = None
        if killed_after is not None and not killed:
            left = max(0, begun + killed_after - time.monotonic())
        if not select.select([hears], [], [], left)[0]:
            os.kill(child, signal.SIGKILL)
            killed = True
            continue
        piece = os.read(hears, 1 << 16)
        if not piece:
            break
        said += piece
    os.close(hears)
    os.waitpid(child, 0)
    print(json.dumps([said.decode(), time.monotonic() - begun]), flush=True)
"""


@pytest.fixture(scope="module")
def run():
    """Run a command in a copy of a process; return its output, partial if killed, and its time."""
    program = PROGRAM.format(tests=str(Path(__file__).parent))
    with subprocess.Popen(
        [sys.executable, "-c", program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:

        def run(place, what, killed_after=None):
            process.stdin.write(json.dumps([str(place), what, killed_after]) + "\n")
            process.stdin.flush()
            said, lasted = json.loads(process.stdout.readline())
            assert "Traceback" not in said, said
            assert killed_after is not None or said.splitlines()[-1] == "ended"
            return [
                line.split()[1]
                for line in said.splitlines()
                if line.startswith("id ") and len(line) > 18
            ], lasted

        yield run
        process.stdin.close()


def _contents(folder):
    return {
        # Refused files are listed under the submitted folder.
        str(path.relative_to(folder)): hashlib.sha256(
            path.read_bytes().replace(str(folder.parent.resolve()).encode(), b"")
        ).hexdigest()
        for path in folder.rglob("*")
        if path.is_file()
        # The page of changes is that of the last run; the journal has the earlier ones.
        and path.name not in ("run.log", "lock", "journal.jsonl", "regrade.html")
        and not path.name.startswith(".half-")
    }


@pytest.fixture
def whole(tmp_path):
    """A class and its sources before anything is graded."""
    from test_terms_as_stories import WEIGHTS, Story

    questions = tmp_path / "questions"
    questions.mkdir()
    story = Story(tmp_path, "killed", None, questions)
    while len(story.attempts) < 6:
        story.act_hand_in(None, [])
    (tmp_path / "solutions").rename(tmp_path / "before")
    story.asked["hw0"].weights, story.asked["hw0"].times = WEIGHTS[1:], 3
    (tmp_path / "solutions").mkdir()
    for name in story.asked:
        story.write_source(name)
    (tmp_path / "solutions").rename(tmp_path / "mended")
    (tmp_path / "before").rename(tmp_path / "solutions")
    shutil.copy(tmp_path / "solutions" / ".grading-secret", tmp_path / "mended")
    (tmp_path / "marks" / "questions").unlink()
    (tmp_path / "marks").rename(tmp_path / "out")
    return tmp_path


@pytest.mark.long
def test_whenever_it_is_killed_the_same_comes_of_it(whole, tmp_path_factory, run, kills=6):
    """Five commands are each killed several times at random moments, then allowed to finish."""
    dice = random.Random("killed 0")
    other = Path(shutil.copytree(whole, tmp_path_factory.mktemp("other") / "course"))
    for what in ("grade", "regrade", "review", "bring in", "export"):
        expected, lasted = run(whole, what)
        said = [line for _ in range(kills) for line in run(other, what, dice.uniform(0, lasted))[0]]
        if what != "review":
            run(other, what)
            assert _contents(other / "out") == _contents(whole / "out"), what
            continue
        # Whatever somebody was told is there, once; a line cut off does not stop anything.
        kept = [event.id for event in Journal(other / "out").events]
        assert len(kept) == len(set(kept)) and set(said) <= set(kept)
        whole_ledger = Journal(whole / "out")
        assert [event.id for event in whole_ledger.by_people] == expected
        decided = [event for event in whole_ledger.by_people if isinstance(event, Decision)]
        assert len(decided) == sum(len(record.marks) for record in Store(whole / "out").all())
        shutil.copy(whole / "out" / "journal.jsonl", other / "out" / "journal.jsonl")
        (other / "out" / "journal.cut").unlink(missing_ok=True)
    assert (other / "book-filled.csv").read_bytes() == (whole / "book-filled.csv").read_bytes()
