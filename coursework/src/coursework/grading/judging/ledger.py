"""What people decided on answers: a ledger that only grows, with who, when and why.

Each line of ``ledger.jsonl`` is one decision on one answer. Of several decisions on the same answer the last one
counts, and none is ever taken out; a decision is taken back by another one that says so. It belongs to the answer
that was looked at: handed in anew, an answer is judged anew.
"""

import csv
import datetime
import fcntl
import getpass
import hashlib
import json
import os
import secrets
from typing import NamedTuple

from ..submissions.identity import decoded
from ..tables import as_written

FILE = "ledger.jsonl"
DECISIONS = "decisions.csv"
KEYS = ("id", "when", "who", "student", "assignment", "question", "answer", "credit", "comment", "rubric", "why")


class Decision(NamedTuple):
    """One person's decision on one answer.

    Attributes
    ----------
    id : str
    when, who : str
    student, assignment, question : str
    answer : str
        The :func:`digest_of_answer` of what was looked at.
    credit : float or None
        From 0 to 1; ``None`` takes earlier decisions back, and the automatic outcome counts again.
    comment : str
        For the student.
    rubric : list of str
    why : str
        For those who grade.
    """

    id: str
    when: str
    who: str
    student: str
    assignment: str
    question: str
    answer: str
    credit: float | None
    comment: str = ""
    rubric: tuple = ()
    why: str = ""


def digest_of_answer(record, question):
    """A short text that follows from an answer, and from nothing else."""
    answer = record["answers"].get(question, {"outcome": "missing"})
    return hashlib.sha256(json.dumps(answer, sort_keys=True).encode()).hexdigest()[:16]


def stable_id(student, assignment, question):
    """What a line of a table is known by, whatever a spreadsheet makes of the names in it."""
    return hashlib.sha256(json.dumps([student, assignment, question]).encode()).hexdigest()[:12]


class Ledger:
    """The decisions on a class.

    Parameters
    ----------
    folder : path
        The folder of results.
    """

    def __init__(self, folder):
        self.path = folder / FILE
        self.decisions = []
        self.read()

    def read(self):
        """Read what was written, also by others, since the last time."""
        self.decisions = list(decisions_in(self.path)) if self.path.exists() else []

    def current(self):
        """The decision that counts for each answer, by student, assignment and question."""
        # By time and not by line: ledgers of several graders may have been put together.
        found = {}
        for one in sorted(self.decisions, key=lambda one: (one.when, one.id)):
            found[one.student, one.assignment, one.question] = one
        return {key: one for key, one in found.items() if one.credit is not None}

    def of(self, student, assignment):
        """The decisions that count on one student's answers."""
        return [one for one in self.current().values() if (one.student, one.assignment) == (student, assignment)]

    def hand_on(self, decisions, student):
        """Enter decisions once more, for another name of the same student: who decided, and when, stays."""
        self.append(
            one._replace(
                id=secrets.token_hex(8), student=student, why=f"{one.why}; was {one.student!r}".removeprefix("; ")
            )
            for one in decisions
        )

    def add(self, record, question, credit, *, who=None, comment="", rubric=(), why=""):
        """Decide on an answer of a record."""
        if credit is not None and not 0 <= credit <= 1:
            raise ValueError(f"A credit is a number from 0 to 1, and this is {credit}.")
        one = Decision(
            secrets.token_hex(8),
            datetime.datetime.now(datetime.UTC).isoformat(timespec="microseconds"),
            who or getpass.getuser(),
            record["student"],
            record["assignment"],
            question,
            digest_of_answer(record, question),
            credit,
            comment,
            tuple(rubric),
            why,
        )
        self.append([one])
        return one

    def append(self, decisions):
        """Write decisions at the end; what stands before is never touched."""
        decisions = list(decisions)
        with open(self.path, "ab") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            file.write(b"".join(json.dumps(one._asdict(), ensure_ascii=False).encode() + b"\n" for one in decisions))
            file.flush()
            os.fsync(file.fileno())
        self.decisions += decisions

    def merge(self, path):
        """Take in the decisions of another grader's ledger; give how many are new, and those that differ.

        Returns
        -------
        number : int
        differing : list of (Decision, Decision)
            Where both decided on one answer and not the same: the later one counts.
        """
        known = {one.id for one in self.decisions}
        before = self.current()
        new = [one for one in decisions_in(path) if one.id not in known]
        differing = [
            (before[key], one)
            for one in new
            if (key := (one.student, one.assignment, one.question)) in before
            and (before[key].credit, before[key].answer) != (one.credit, one.answer)
            and before[key].who != one.who
        ]
        if new:
            self.append(new)
        return len(new), differing

    def take_in_table(self, path, records):
        """Enter the decisions of a table that a person filled in; say what became of every line.

        Parameters
        ----------
        path : path
            A table with the columns ``credit`` and ``id``, or ``student`` and ``question``.
        records : iterable of dict

        Returns
        -------
        list of str
            The lines that fit no answer.

        Raises
        ------
        ValueError
            A line cannot be read; nothing is entered then.
        """
        if not path.exists():
            return []
        by_id, by_names = {}, {}
        for record in records:
            for question in record["marks"]:
                by_id[stable_id(record["student"], record["assignment"], question)] = record, question
                by_names.setdefault((record["student"], question), []).append((record, question))
        unused, wanted, current = [], [], self.current()
        for number, row in _rows(path):
            credit = _credit(row.get("credit", ""), f"{path}, line {number}")
            if credit is None:
                continue
            names = as_written(row.get("student", "")), row.get("question", "")
            fitting = [by_id[row["id"]]] if row.get("id") in by_id else by_names.get(names, [])
            if len(fitting) != 1:
                unused.append(f"line {number}: there is no answer of {names[0]!r} to {names[1]!r}")
                continue
            record, question = fitting[0]
            known = current.get((record["student"], record["assignment"], question))
            comment = row.get("comment", "")
            same = known and (known.credit, known.comment, known.answer) == (
                credit,
                comment,
                digest_of_answer(record, question),
            )
            if not same:
                wanted.append((record, question, credit, comment))
        for record, question, credit, comment in wanted:
            self.add(record, question, credit, comment=comment, why=f"from {path.name}")
        return unused


def decisions_in(path):
    """The decisions of a ledger.

    Raises
    ------
    ValueError
        A line is none; the message says which.
    """
    with open(path, encoding="utf8") as file:
        for number, line in enumerate(file, 1):
            try:
                found = json.loads(line)
                credit = found["credit"]
                if set(found) != set(KEYS) or not (credit is None or 0 <= credit <= 1):
                    raise ValueError
                yield Decision(**{**found, "rubric": tuple(found["rubric"])})
            except (ValueError, TypeError, KeyError):
                raise ValueError(f"{path}, line {number}: this is no decision: {line[:80]!r}.") from None


def _rows(path):
    text = decoded(path.read_bytes())
    first = text.split("\n", 1)[0]
    reader = csv.reader(text.splitlines(keepends=True), delimiter=max(",;\t", key=first.count))
    header = [name.strip().casefold() for name in next(reader, [])]
    if "credit" not in header or not ("id" in header or {"student", "question"} <= set(header)):
        raise ValueError(
            f"{path}: a table of decisions has the columns credit and id, or credit, student and question; "
            f"this one has {', '.join(header) or 'none'}."
        )
    for cells in reader:
        yield reader.line_num, dict(zip(header, (cell.strip() for cell in cells), strict=False))


def _credit(text, where):
    if not text:
        return None
    try:
        share = float(text.replace(",", ".") if "." not in text else text)
        if not 0 <= share <= 1:
            raise ValueError
        return share
    except ValueError:
        raise ValueError(f"{where}: credit is a number from 0 to 1, and this is {text!r}.") from None
