"""What people decided on answers: a ledger that only grows, with who, when and why.

Each line of ``ledger.jsonl`` is one decision on one answer. Of several decisions on the same answer the last one
counts, and none is ever taken out; who takes an own decision back enters another one that says so, and what stood
before it counts again. It belongs to the answer that was looked at: handed in anew, an answer is judged anew. Who
decides names what was decided when they looked: if it is another by then, nothing is entered, and both are told.
"""

import contextlib
import csv
import datetime
import getpass
import hashlib
import json
import os
import secrets
from typing import NamedTuple

from ..locks import lock
from ..submissions.identity import decoded
from ..tables import as_written

FILE = "ledger.jsonl"
#: Where the beginning of a line is kept that was being written when the machine stopped.
CUT = "ledger.cut"
DECISIONS = "decisions.csv"
KEYS = ("id", "when", "who", "student", "assignment", "question", "answer", "credit", "comment", "rubric", "why")
#: What later versions added: lines without it are read as before.
LATER = ("undoes", "after")


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
        From 0 to 1; ``None`` takes the decision ``undoes`` back, or all earlier ones where that is empty.
    comment : str
        For the student.
    rubric : list of str
    why : str
        For those who grade.
    undoes : str
        The decision of the same person that is taken back.
    after : str
        The decision that counted when this one was made; empty where there was none.
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
    undoes: str = ""
    after: str = ""


class Collision(ValueError):
    """Somebody else decided in the meantime: nothing was entered.

    Attributes
    ----------
    decisions : list of Decision
        What counts now.
    """

    def __init__(self, message, decisions=()):
        super().__init__(message)
        self.decisions = list(decisions)


def digest_of_answer(record, question):
    """A short text that follows from an answer, and from nothing else."""
    answer = record["answers"].get(question, {"outcome": "missing"})
    return hashlib.sha256(json.dumps(answer, sort_keys=True).encode()).hexdigest()[:16]


def stable_id(student, assignment, question):
    """What a line of a table is known by, whatever a spreadsheet makes of the names in it."""
    return hashlib.sha256(json.dumps([student, assignment, question]).encode()).hexdigest()[:12]


def with_decisions(record, decisions):
    """A record with what people decided on its answers, in place of what the machine said; nothing is judged."""
    marks = {}
    for name, mark in record["marks"].items():
        found = {key: value for key, value in mark.items() if key not in ("before", "decided")}
        found |= mark.get("before", {})
        decided = decisions.get((record["student"], record["assignment"], name))
        if decided is not None and decided.answer == digest_of_answer(record, name):
            found |= {
                "outcome": "decided",
                "points": round(found["worth"] * decided.credit, 4),
                "messages": [said for said in (*decided.rubric, decided.comment) if said],
                "before": {key: found[key] for key in ("outcome", "note", "points", "messages")},
                "decided": {"who": decided.who, "when": decided.when, "id": decided.id},
            }
        marks[name] = found
    return {
        **record,
        "marks": marks,
        "points": round(sum(mark["points"] for mark in marks.values()), 4),
        "worth": sum(mark["worth"] for mark in marks.values()),
        "undecided": sum(mark["outcome"] == "undecided" for mark in marks.values()),
    }


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

    def said_of_cut(self):
        """What a person should know if the last line was not written to its end; or nothing."""
        last = self.path.read_bytes().rpartition(b"\n")[2] if self.path.exists() else b""
        if not last or not _is_cut(last):
            return ""
        return (
            f"{self.path} ends within a line: the machine stopped while a decision was written, which does not count. "
            f"With the next decision its beginning is moved to {CUT}."
        )

    def standing(self, until=None):
        """The decisions on each answer that nobody took back, the last one last, by student, assignment, question.

        With a time, those that stood then.
        """
        made = [one for one in self.decisions if until is None or datetime.datetime.fromisoformat(one.when) <= until]
        # By time and not by line: ledgers of several graders may have been put together.
        undone = {one.undoes for one in made if one.undoes}
        found = {}
        for one in sorted(made, key=lambda one: (one.when, one.id)):
            key = one.student, one.assignment, one.question
            if one.credit is not None and one.id not in undone:
                found.setdefault(key, []).append(one)
            elif one.credit is None and not one.undoes:
                found.pop(key, None)
        return found

    def current(self, until=None):
        """The decision that counts for each answer, or counted at a time, by student, assignment and question."""
        return {key: several[-1] for key, several in self.standing(until).items() if several}

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
        one = self.decision(record, question, credit, who=who, comment=comment, rubric=rubric, why=why)
        self.append([one])
        return one

    def decision(self, record, question, credit, *, who=None, comment="", rubric=(), why="", undoes="", after=""):
        """A decision on an answer of a record, which is not entered yet."""
        if credit is not None and not 0 <= credit <= 1:
            raise ValueError(f"A credit is a number from 0 to 1, and this is {credit}.")
        return Decision(
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
            undoes,
            after,
        )

    def take_back(self, records, question, who, why=""):
        """Take back the last decision of a person on each of these answers; what stood before it counts again.

        Raises
        ------
        Collision
            None of the decisions that stand is this person's.
        """
        with self._alone() as file:
            standing = self.standing()
            mine = [
                (record, [one for one in standing.get((record["student"], record["assignment"], question), ())])
                for record in records
            ]
            own = [(record, [one for one in several if one.who == who]) for record, several in mine]
            if not any(several for _, several in own):
                others = [several[-1] for _, several in mine if several]
                raise Collision("There is no decision of yours to take back.", others)
            self._write(
                file,
                [
                    self.decision(record, question, None, who=who, why=why, undoes=several[-1].id)
                    for record, several in own
                    if several
                ],
            )

    def append(self, decisions, collisions=False):
        """Write decisions at the end, all or none; what stands before is never touched.

        Raises
        ------
        Collision
            With ``collisions``, if what counts is another decision than the one that each says to come ``after``.
        """
        decisions = list(decisions)
        with self._alone() as file:
            if collisions:
                current = self.current()
                keys = [(one.student, one.assignment, one.question) for one in decisions]
                others = [
                    current[key]
                    for key, one in zip(keys, decisions, strict=True)
                    if key in current and current[key].id != one.after
                ]
                gone = any(one.after and key not in current for key, one in zip(keys, decisions, strict=True))
                if others or gone:
                    raise Collision("Somebody else decided in the meantime.", others)
            self._write(file, decisions)

    @contextlib.contextmanager
    def _alone(self):
        """Keep other writers away, and know what they have written."""
        with open(self.path, "ab+") as file:
            lock(file)
            file.seek(0)
            whole = file.read()
            cut = whole[whole.rfind(b"\n") + 1 :]
            if cut and not _is_cut(cut):
                file.write(b"\n")  # an editor took it away
            elif cut:
                # A line that was being written when the machine stopped: nobody was told that it counts.
                with open(self.path.with_name(CUT), "ab") as aside:
                    aside.write(cut + b"\n")
                    aside.flush()
                    os.fsync(aside.fileno())
                file.truncate(len(whole) - len(cut))
            self.read()
            yield file

    def _write(self, file, decisions):
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
        unused, wanted = [], []
        # What was entered from this table, and changed since, is not entered again.
        why = f"from {path.name}"
        entered = {(one.student, one.assignment, one.question): one for one in self.decisions if one.why == why}
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
            known = entered.get((record["student"], record["assignment"], question))
            comment = row.get("comment", "")
            same = known and (known.credit, known.comment, known.answer) == (
                credit,
                comment,
                digest_of_answer(record, question),
            )
            if not same:
                wanted.append((record, question, credit, comment))
        for record, question, credit, comment in wanted:
            self.add(record, question, credit, comment=comment, why=why)
        return unused


def decisions_in(path):
    """The decisions of a ledger, but for a last line that was not written to its end: nobody was told that it counts.

    Raises
    ------
    ValueError
        A line is none; the message says which.
    """
    with open(path, encoding="utf8", errors="replace") as file:
        for number, line in enumerate(file, 1):
            try:
                yield _decision(line)
            except (ValueError, TypeError, KeyError):
                if not line.endswith("\n"):
                    return
                raise ValueError(
                    f"{path}, line {number}: this is no decision: {line[:80]!r}. Somebody changed the file: move "
                    "the line into a file of its own, and look at that answer again."
                ) from None


def _is_cut(line):
    """Whether a last line, without the end of a line, is no whole decision."""
    try:
        _decision(line.decode("utf8", "replace"))
    except (ValueError, TypeError, KeyError):
        return True
    return False


def _decision(line):
    """What a line says; raises ``ValueError``, ``TypeError`` or ``KeyError`` if it is no decision."""
    found = json.loads(line)
    credit = found["credit"]
    if not set(KEYS) <= set(found) <= {*KEYS, *LATER} or not (credit is None or 0 <= credit <= 1):
        raise ValueError
    return Decision(**{**found, "rubric": tuple(found["rubric"])})


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
