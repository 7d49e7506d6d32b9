"""The journal: everything that happened to marks, in a file that only grows.

Each line of ``journal.jsonl`` is an event that any editor shows: marks that were `Given`, a
`Decision` on one answer, a step of an `Appeal`, the new worth of a line of a rubric (`Worth`), or
marks that were `Exported`. The current marks of a class are those that were given last, and nothing
else changes them (`coursework.grading.judging.laboratory`).

If there are several decisions on the same answer, the last one counts, and none is ever removed.
Graders take back a decision of their own by entering another that says so; the decision before it
then counts again. A decision belongs to the answer that the grader saw and to the question as it
stood then, so a resubmitted answer is judged again. A decision names the one that counted when the
grader looked. If another counts by then, we enter nothing and tell both graders.
"""

import contextlib
import datetime
import getpass
import hashlib
import io
import json
import os
import secrets
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from ...checking.fields import Fields, Json, Misread, one_of, text
from ..locks import lock
from ..reading import AsJson
from ..record import Judged, Mark, Record
from ..store import naming
from ..submissions.roster import cells_in
from ..tables import as_written, in_a_line

FILE = "journal.jsonl"
#: The file for the beginning of a line that was not yet complete when the machine stopped.
CUT = "journal.cut"
# The end of the reason of an event that was copied to another name of its student.
WAS = "was {!r}"
LONGEST_WORDS = 4_000

#: A student, an assignment, a question.
Key = tuple[str, str, str]

#: A line of a table: its number, and its cells by the names of the columns.
Row = tuple[int, dict[str, str]]

#: The states of an appeal, in order; the last two close it.
RAISED, UNDER_REVIEW, ACCEPTED, REJECTED = "raised", "under review", "accepted", "rejected"
OPEN = (RAISED, UNDER_REVIEW)


def now() -> str:
    return datetime.datetime.now(datetime.UTC).isoformat(timespec="microseconds")


@dataclass(frozen=True, kw_only=True)
class Event(AsJson):
    """An event: something that somebody did.

    Attributes
    ----------
    id, when, who : str
    """

    id: str = field(default_factory=lambda: secrets.token_hex(8))
    when: str = field(default_factory=now)
    who: str


@dataclass(frozen=True, kw_only=True)
class OnAnswer(Event):
    """An event that concerns one answer.

    Attributes
    ----------
    student, assignment, question : str
    answer : str
        The `digest_of_answer` of the answer that the person saw.
    contract : str
        The version of the question that the answer was judged by at that time; empty if unknown.
    after : str
        The event that counted when this one was entered; empty if there was none.
    appeal : str
        The first step of the appeal to which this belongs; empty for that step itself, or without
        an appeal.
    """

    student: str
    assignment: str
    question: str
    answer: str
    contract: str = ""
    after: str = ""
    appeal: str = ""

    @property
    def key(self) -> Key:
        return self.student, self.assignment, self.question


@dataclass(frozen=True, kw_only=True)
class Decision(OnAnswer):
    """One person's decision on one answer, which may accept an appeal.

    Attributes
    ----------
    credit : float or None
        From 0 to 1; ``None`` takes back the decision in ``undoes``.
    comment : str
        For the student.
    rubric : tuple of str
        The lines that apply to this answer.
    why : str
        The reason, for those who grade.
    undoes : str
        The same person's decision that this one takes back.
    points : tuple of float or None
        The worth of each line of the rubric, if the points come from the rubric.
    """

    credit: float | None
    comment: str = ""
    rubric: tuple[str, ...] = ()
    why: str = ""
    undoes: str = ""
    points: tuple[float | None, ...] | None = None


@dataclass(frozen=True, kw_only=True)
class Appeal(OnAnswer):
    """A step of an appeal against a mark: raised, under review or rejected.

    A `Decision` accepts an appeal.

    Attributes
    ----------
    state : str
    words : str
        The student's words in the first step; later, the answer to the student.
    """

    state: str
    words: str


@dataclass(frozen=True, kw_only=True)
class Worth(Event):
    """A new worth of a line of a rubric.

    Attributes
    ----------
    question, line : str
    points : float
    source : float or None
        The worth in the source when this was entered. If it changes, the source is the newer one.
    after : str
        The event that was in force before.
    """

    question: str
    line: str
    points: float
    source: float | None = None
    after: str = ""


@dataclass(frozen=True)
class Part(AsJson):
    """The points for one question of a mark."""

    points: float
    worth: float
    outcome: str


@dataclass(frozen=True, kw_only=True)
class Given(Event):
    """The marks that were given for a student's work on an assignment.

    Attributes
    ----------
    student, assignment : str
    why : str
        The reason for the change, or that this is the first mark.
    points, worth : float
    marks : mapping of str to Part
        By question.
    files : mapping of str to str
        The notebooks that counted, with the SHA-256 of each.
    """

    student: str
    assignment: str
    why: str
    points: float
    worth: float
    marks: Mapping[str, Part]
    files: Mapping[str, str]

    @property
    def undecided(self) -> int:
        """The number of answers that wait for a person."""
        return sum(part.outcome == "undecided" for part in self.marks.values())


@dataclass(frozen=True, kw_only=True)
class Exported(Event):
    """Marks that were written to a system's table.

    Attributes
    ----------
    assignment, column, file : str
    marks : mapping of str to str
        The mark written for each student.
    """

    assignment: str
    column: str
    file: str
    marks: Mapping[str, str]


#: The events that people enter, which we merge from another grader's journal.
ByPeople = Decision | Appeal | Worth
KINDS = {kind.__name__.lower(): kind for kind in (Decision, Appeal, Worth, Given, Exported)}


class Collision(ValueError):
    """An error for a decision that was not entered since somebody else decided in the meantime.

    Attributes
    ----------
    decisions : list of Decision
        The decisions that count now.
    """

    def __init__(self, message: str, decisions: Iterable[Decision] = ()) -> None:
        super().__init__(message)
        self.decisions = list(decisions)


def digest_of_answer(record: Record, question: str) -> str:
    """Return a digest of an answer, independent of the cell that contains it."""
    answer = replace(record.answer(question), cell=None, source=None).as_json()
    return hashlib.sha256(json.dumps(answer, sort_keys=True).encode()).hexdigest()[:16]


def _on(record: Record, question: str) -> dict[str, str]:
    """Return the fields that every event on an answer has, by the user of this machine."""
    return {
        "who": getpass.getuser(),
        "student": record.student,
        "assignment": record.assignment,
        "question": question,
        "answer": digest_of_answer(record, question),
        "contract": record.marks[question].version if question in record.marks else "",
    }


def case_id(record: Record, question: str) -> str:
    """Return the ID of an answer in a table, which, unlike a name, no spreadsheet changes.

    A different answer of the same student has a different ID.
    """
    key = [record.student, record.assignment, question, digest_of_answer(record, question)]
    return hashlib.sha256(json.dumps(key).encode()).hexdigest()[:12]


# --- the current state --------------------------------------------------------------------------


@dataclass(frozen=True)
class Appealed:
    """An appeal with all its steps.

    Attributes
    ----------
    steps : tuple of Appeal
        The steps in order; the first one raised it.
    accepted : Decision or None
        The decision that accepts it, unless it was taken back.
    """

    steps: tuple[Appeal, ...]
    accepted: Decision | None = None

    @property
    def id(self) -> str:
        return self.steps[0].id

    @property
    def last(self) -> str:
        """The event that the next step must name."""
        return self.accepted.id if self.accepted else self.steps[-1].id

    @property
    def state(self) -> str:
        return ACCEPTED if self.accepted else self.steps[-1].state

    @property
    def is_open(self) -> bool:
        return self.state in OPEN

    def as_json(self) -> dict[str, str]:
        """Return what we show its student."""
        first, last = self.steps[0], self.steps[-1]
        said = last.words if len(self.steps) > 1 else ""
        answered = self.accepted.comment if self.accepted else said
        return {
            "when": first.when[:10],
            "words": first.words,
            "state": self.state,
            "answer": answered,
        }


@dataclass(frozen=True)
class Standing:
    """The result of all events up to a time.

    Attributes
    ----------
    decisions : dict
        The decision that counts for each answer, by student, assignment and question.
    appeals : dict
        The appeals about each answer, in the order in which they were raised.
    worths : dict
        The worth of lines of rubrics that somebody changed on the page, by question and line.
    given : dict
        The marks that were given last, by student and assignment.
    """

    decisions: Mapping[Key, Decision] = field(default_factory=dict)
    appeals: Mapping[Key, Sequence[Appealed]] = field(default_factory=dict)
    worths: Mapping[tuple[str, str], Worth] = field(default_factory=dict)
    given: Mapping[tuple[str, str], Given] = field(default_factory=dict)

    def decision(self, record: Record, question: str) -> Decision | None:
        """Return the decision that counts, unless it concerns an answer that was replaced since."""
        decision = self.decisions.get((record.student, record.assignment, question))
        is_on_this = decision and decision.answer == digest_of_answer(record, question)
        return decision if is_on_this else None

    def worth(self, question: str, line: str, source: float | None) -> float | None:
        """Return the worth of a rubric's line, from the page or the source, whichever is newer."""
        on_page = self.worths.get((question, line))
        return on_page.points if on_page is not None and on_page.source == source else source

    def points(self, decision: Decision, mark: Mark) -> float:
        """Return the points of a decision: a share of all, or those of the rubric's lines now."""
        worth = float(mark.worth)
        if decision.points is None:
            return round(worth * (decision.credit or 0), 4)
        points = 0.0
        for line, then in zip(decision.rubric, decision.points, strict=True):
            now = self.worth(decision.question, line, mark.rubric.get(line))
            # A removed line keeps its last worth.
            points += (then if now is None else now) or 0
        return round(min(worth, max(0.0, points)), 4)


def with_decisions(record: Record, standing: Standing) -> Record:
    """Return a record with people's decisions in place of automatic ones; nothing is judged."""
    marks = {}
    for name, mark in record.marks.items():
        judged = standing_mark = mark.judged
        decided = standing.decision(record, name)
        if decided is not None:
            standing_mark = replace(
                judged,
                outcome="decided",
                points=standing.points(decided, judged),
                messages=tuple(text for text in (*decided.rubric, decided.comment) if text),
                before=Judged(judged.outcome, judged.note, judged.points, judged.messages),
                decided={"who": decided.who, "when": decided.when, "id": decided.id},
            )
        appeals = standing.appeals.get((record.student, record.assignment, name), ())
        marks[name] = replace(standing_mark, appeals=tuple(appeal.as_json() for appeal in appeals))
    return replace(record, marks=marks)


def appeals_open(record: Record) -> list[str]:
    """Return the questions of a record with an open appeal."""
    return [
        name
        for name, mark in record.marks.items()
        if any(appeal["state"] in OPEN for appeal in mark.appeals)
    ]


class Journal:
    """The events of a class.

    Parameters
    ----------
    folder : path
        The folder of results.
    dry_run : bool
        Write nothing; new events exist in this object only.
    """

    def __init__(self, folder: Path, dry_run: bool = False) -> None:
        self.path, self.dry_run = folder / FILE, dry_run
        self.events: list[Event] = []
        self.read()

    def read(self) -> None:
        """Read all events, including those that others have written since."""
        self.events = list(events_in(self.path)) if self.path.exists() else []

    @property
    def by_people(self) -> list[ByPeople]:
        """The events that people entered."""
        return [event for event in self.events if isinstance(event, ByPeople)]

    def said_of_cut(self) -> str:
        """Return a warning if the last line was not written completely, or an empty string."""
        last = self.path.read_bytes().rpartition(b"\n")[2] if self.path.exists() else b""
        if not last or not _is_cut(last):
            return ""
        return (
            f"{self.path} ends in the middle of a line, because the machine stopped while saving "
            "a decision. That decision does not count. When the next one is saved, the fragment "
            f"moves to {CUT}."
        )

    # -- reading the state

    def standing(self, until: datetime.datetime | None = None) -> Standing:
        """Return the state now, or at a given time."""
        events = [
            event
            for event in self.events
            if until is None or datetime.datetime.fromisoformat(event.when) <= until
        ]
        made = _in_order(event for event in events if isinstance(event, ByPeople))
        decisions = {key: several[-1] for key, several in _not_taken_back(made).items()}
        worths = {(event.question, event.line): event for event in made if isinstance(event, Worth)}
        undone = {event.undoes for event in made if isinstance(event, Decision) and event.undoes}
        accepted = {
            event.appeal: event
            for event in made
            if isinstance(event, Decision) and event.id not in undone
        }
        steps: dict[str, list[Appeal]] = {}
        for event in made:
            if isinstance(event, Appeal):
                steps.setdefault(event.appeal or event.id, []).append(event)
        appeals: dict[Key, list[Appealed]] = {}
        for first, several in steps.items():
            # If somebody rejected the appeal, or took it up again, after it was accepted, that
            # counts.
            by = accepted.get(first)
            if by is not None and any(step.after == by.id for step in several):
                by = None
            appeals.setdefault(several[0].key, []).append(Appealed(tuple(several), by))
        given = {
            (event.student, event.assignment): event for event in events if isinstance(event, Given)
        }
        return Standing(decisions, appeals, worths, given)

    # -- entering events

    def hand_on(self, student: str, assignment: str, name: str) -> None:
        """Copy all events to another name of the same student, with their authors and times."""
        old = [
            event
            for event in self.events
            if isinstance(event, Decision | Appeal | Given)
            and (event.student, event.assignment) == (student, assignment)
        ]
        ids = {event.id: secrets.token_hex(8) for event in old}
        copies: list[Event] = []
        for event in old:
            same: dict[str, Any] = {
                field: ids.get(getattr(event, field), getattr(event, field))
                for field in ("id", "after", "appeal", "undoes")
                if hasattr(event, field)
            }
            if isinstance(event, Decision | Given):
                same["why"] = f"{event.why}; {WAS.format(student)}".removeprefix("; ")
            copies.append(replace(event, student=name, **same))
        self.append(copies)

    def add(self, record: Record, question: str, credit: float | None, **more: Any) -> Decision:
        """Decide on an answer of a record."""
        decision = self.decision(record, question, credit, **more)
        self.append([decision])
        return decision

    def decision(
        self, record: Record, question: str, credit: float | None, **more: Any
    ) -> Decision:
        """Make a decision on an answer without entering it; ``more`` are its other fields."""
        if credit is not None and not 0 <= credit <= 1:
            raise ValueError(f"A credit must be a number from 0 to 1, not {credit}.")
        for name in ("rubric", "points"):
            if more.get(name) is not None:
                more[name] = tuple(more[name])
        return Decision(**_on(record, question) | more, credit=credit)

    def appeal(
        self,
        record: Record,
        question: str,
        words: str,
        *,
        state: str = RAISED,
        of: Appealed | None = None,
        **more: Any,
    ) -> Appeal:
        """Raise an appeal, or take the next step ``of`` one, ``after`` the step that somebody saw.

        Raises
        ------
        ValueError
            The words are missing or too long, or the state is not possible.
        Collision
            Somebody else took a step in the meantime.
        """
        words = words.strip()
        if len(words) > LONGEST_WORDS:
            raise ValueError(
                f"This text is longer than {LONGEST_WORDS} characters. Please shorten it, "
                "since we do not cut anything off."
            )
        if state not in (RAISED, UNDER_REVIEW, REJECTED) or (state == RAISED) != (of is None):
            raise ValueError(f"An appeal can be raised, under review or rejected, not {state!r}.")
        if not words and state != UNDER_REVIEW:
            raise ValueError(
                "The student's words are missing."
                if state == RAISED
                else "Give the reason for rejecting the appeal."
            )
        appeal = Appeal(
            **_on(record, question) | more,
            state=state,
            words=words,
            appeal=of.id if of else "",
        )
        self.append([appeal], collisions=True)
        return appeal

    @staticmethod
    def worths(
        question: str,
        changes: Mapping[str, tuple[float, str]],
        source: Mapping[str, float],
        who: str,
    ) -> list[Worth]:
        """Return new worths for lines of a rubric, without entering them.

        Parameters
        ----------
        question : str
        changes : mapping
            By line: the points, and the event that was in force when the person looked, or an empty
            string.
        source : mapping
            The worth of each line in the source.
        """
        return [
            Worth(
                who=who,
                question=question,
                line=line,
                points=points,
                source=source.get(line),
                after=after,
            )
            for line, (points, after) in changes.items()
        ]

    def take_back(self, records: Iterable[Record], question: str, who: str, why: str = "") -> None:
        """Take back a person's last decision on each of these answers; the one before counts again.

        Raises
        ------
        Collision
            None of the decisions that count is this person's.
        """
        with self._alone() as file:
            standing = _not_taken_back(_in_order(self.by_people))
            mine = [
                (record, standing.get((record.student, record.assignment, question), []))
                for record in records
            ]
            own = [
                (record, [decision for decision in several if decision.who == who])
                for record, several in mine
            ]
            if not any(several for _, several in own):
                others = [several[-1] for _, several in mine if several]
                raise Collision("You have no decision to take back.", others)
            self._write(
                file,
                [
                    self.decision(record, question, None, who=who, why=why, undoes=several[-1].id)
                    for record, several in own
                    if several
                ],
            )

    def append(self, events: Iterable[Event], collisions: bool = False) -> None:
        """Append events to the file, all or none.

        Raises
        ------
        Collision
            With ``collisions``, if the event that counts is not the one that a new event comes
            ``after``.
        """
        events = list(events)
        if self.dry_run:
            self.events += events
            return
        with self._alone() as file:
            if collisions:
                self._demand_seen(events)
            self._write(file, events)

    def _demand_seen(self, events: Sequence[Event]) -> None:
        standing = self.standing()
        decided = [event for event in events if isinstance(event, Decision)]
        others = [
            standing.decisions[decision.key]
            for decision in decided
            if decision.key in standing.decisions
            and standing.decisions[decision.key].id != decision.after
        ]
        if others or any(
            decision.after and decision.key not in standing.decisions for decision in decided
        ):
            raise Collision("Somebody else has decided in the meantime.", others)
        appeals = {appeal.id: appeal for several in standing.appeals.values() for appeal in several}
        for event in events:
            if isinstance(event, Decision) and event.appeal and not appeals[event.appeal].is_open:
                raise Collision("Someone else has settled this appeal in the meantime.")
            if (
                isinstance(event, Appeal)
                and event.appeal
                and appeals[event.appeal].last != event.after
            ):
                raise Collision("Someone else has changed this appeal in the meantime.")
            if (
                isinstance(event, Appeal)
                and not event.appeal
                and any(x.is_open for x in standing.appeals.get(event.key, ()))
            ):
                raise Collision("An appeal against this mark is open already.")
            if isinstance(event, Worth):
                before = standing.worths.get((event.question, event.line))
                if (before.id if before else "") != event.after:
                    raise Collision(
                        f"Somebody else has changed the points of “{event.line}” in the meantime."
                    )

    @contextlib.contextmanager
    def _alone(self) -> Iterator[io.FileIO]:
        """Lock out other writers, and read what they have written."""
        # Use no buffer, so that closing the file does not write again what a full disk refused.
        with naming(self.path), open(self.path, "ab+", buffering=0) as file:
            lock(file)
            file.seek(0)
            whole = file.read()
            cut = whole[whole.rfind(b"\n") + 1 :]
            if cut and not _is_cut(cut):
                # An editor removed the line break at the end.
                file.write(b"\n")
            elif cut:
                # The machine stopped while this line was being written, so nobody was told that it
                # counts.
                with open(self.path.with_name(CUT), "ab") as aside:
                    aside.write(cut + b"\n")
                    aside.flush()
                    os.fsync(aside.fileno())
                file.truncate(len(whole) - len(cut))
            self.read()
            yield file

    def _write(self, file: io.FileIO, events: Sequence[Event]) -> None:
        lines = memoryview(b"".join(_line(event) for event in events))
        whole = file.seek(0, os.SEEK_END)
        try:
            while lines:
                lines = lines[file.write(lines) :]
            os.fsync(file.fileno())
        except OSError:
            # Whoever is told that it was not written must not find parts of it.
            file.truncate(whole)
            raise
        self.events += events

    def merge(self, path: Path) -> tuple[list[ByPeople], list[tuple[Decision, Decision]]]:
        """Merge the events that people entered in another grader's journal.

        Returns
        -------
        new : list
        differing : list of (Decision, Decision)
            Different decisions of two people on one answer; the later one counts.
        """
        known = {event.id for event in self.events}
        before = self.standing().decisions
        theirs = [event for event in events_in(path) if isinstance(event, ByPeople)]
        new = [event for event in theirs if event.id not in known]
        differing = [
            (before[event.key], event)
            for event in new
            if isinstance(event, Decision)
            and event.key in before
            and (before[event.key].credit, before[event.key].answer) != (event.credit, event.answer)
            and before[event.key].who != event.who
        ]
        if new:
            self.append(new)
        return new, differing

    def take_in_table(
        self, path: Path, records: Iterable[Record], who: str | None = None
    ) -> tuple[int, list[str]]:
        """Enter the decisions or appeals of a table that a person filled in.

        Parameters
        ----------
        path : path
            A copy of ``undecided.csv``, with the column ``credit`` filled in, or the table of a
            sitting, with the column ``tick``. Each row belongs to the answer that it was written
            for. Or a table of appeals, with the columns ``student``, ``question`` and ``words``.
        records : iterable of Record

        Returns
        -------
        int
            The number of rows that were entered.
        list of str
            The rows that were not, and why.

        Raises
        ------
        ValueError
            The table cannot be read; nothing is entered.
        """
        header, rows = _table(path)
        who = who or getpass.getuser()
        if {"id", "version", "credit"} <= header:
            return self._take_in_decisions(path, rows, records, who)
        if {"student", "question", "words"} <= header:
            return self._take_in_appeals(rows, records, who)
        raise ValueError(
            f"{path}: a table of decisions is a copy of undecided.csv that keeps its "
            "columns id and version and has credit filled in; a table of appeals has the columns "
            f"student, question and words. This table has "
            f"{in_a_line(', '.join(sorted(header)), 300) or 'none'}."
        )

    def _take_in_decisions(
        self, path: Path, rows: Sequence[Row], records: Iterable[Record], who: str
    ) -> tuple[int, list[str]]:
        cases = {
            case_id(record, name): (record, name) for record in records for name in record.marks
        }
        standing = self.standing().decisions
        wanted: list[Decision] = []
        unused: list[str] = []
        for number, row in rows:
            # The cell of a box contains its share of the points, then its words.
            share, _, words = row.get(row.get("tick", "").casefold() or "-", "").partition(": ")
            credit = _credit(
                row["credit"] or share or row.get("tick", ""), f"{path}, line {number}"
            )
            if credit is None:
                continue
            where = f"line {number}, {as_written(row.get('student', '')) or row['id']}"
            if row["id"].lstrip("#") not in cases:
                unused.append(
                    f"{where}: we do not have this answer. Perhaps the student has handed in again"
                )
                continue
            record, question = cases[row["id"].lstrip("#")]
            there = standing.get((record.student, record.assignment, question))
            if there and there.answer == digest_of_answer(record, question):
                if there.who != who:
                    unused.append(f"{where}: {there.who} already gave {there.credit}")
                    continue
                if (there.credit, there.comment, there.rubric) == (
                    credit,
                    row.get("comment", ""),
                    (words,) if words else there.rubric,
                ):
                    continue
            wanted.append(
                self.decision(
                    record,
                    question,
                    credit,
                    who=who,
                    comment=row.get("comment", ""),
                    rubric=[words] if words else [],
                    why=f"from {path.name}",
                    contract=row["version"].lstrip("#"),
                )
            )
        if wanted:
            self.append(wanted)
        return len(wanted), unused

    def _take_in_appeals(
        self, rows: Sequence[Row], records: Iterable[Record], who: str
    ) -> tuple[int, list[str]]:
        by_names: dict[tuple[str, str], list[Record]] = {}
        for record in records:
            for question in record.marks:
                by_names.setdefault((record.student, question), []).append(record)
        raised = {(*event.key, event.words) for event in self.events if isinstance(event, Appeal)}
        unused, entered = [], 0
        for number, row in rows:
            words = as_written(row["words"]).strip()
            student, question = as_written(row["student"]), row["question"]
            fitting = by_names.get((student, question), [])
            if words and len(fitting) != 1:
                unused.append(f"line {number}: there is no answer of {student!r} to {question!r}")
            elif words and (student, fitting[0].assignment, question, words) not in raised:
                try:
                    self.appeal(fitting[0], question, words, who=who)
                    entered += 1
                except ValueError as error:
                    unused.append(f"line {number}: {error}")
        return entered, unused


def _in_order(events: Iterable[ByPeople]) -> list[ByPeople]:
    """Sort the events of several graders by time, but none before the event that it names.

    Clocks may be wrong. A grader who saw another decision decided later, whatever the times say.
    """
    events = list(events)
    by_id = {event.id: event for event in events}
    places: dict[str, tuple[str, int]] = {}

    def place(event: ByPeople) -> tuple[str, int]:
        chain = [event]
        while (
            chain[-1].id not in places
            and (before := by_id.get(chain[-1].after))
            and before not in chain
        ):
            chain.append(before)
        for each in reversed(chain):
            if each.id not in places:
                when, order = places.get(each.after, ("", 0))
                places[each.id] = (when, order + 1) if when >= each.when else (each.when, 0)
        return places[event.id]

    return sorted(events, key=lambda event: (*place(event), event.id))


def _not_taken_back(made: Sequence[ByPeople]) -> dict[Key, list[Decision]]:
    """Return the decisions on each answer that nobody took back, the newest last."""
    decisions = [event for event in made if isinstance(event, Decision)]
    undone = {decision.undoes for decision in decisions}
    standing: dict[Key, list[Decision]] = {}
    for decision in decisions:
        if decision.credit is not None and decision.id not in undone:
            standing.setdefault(decision.key, []).append(decision)
    return standing


# --- lines ---------------------------------------------------------------------------------------


def events_in(path: Path) -> Iterator[Event]:
    """Iterate over the events of a journal, without a last line that was not written completely.

    Raises
    ------
    ValueError
        A line is not an event, or was changed; the message gives the line.
    """
    with open(path, encoding="utf8", errors="replace") as file:
        for number, line in enumerate(file, 1):
            try:
                yield _event(line)
            except ValueError as error:
                if not line.endswith("\n"):
                    return
                why = f" ({error})" if isinstance(error, Misread) else ""
                raise ValueError(
                    f"{path}, line {number}: this is not what coursework wrote: "
                    f"{line[:80]!r}{why}. Somebody has edited the file. Restore the line, or "
                    "move it to another file and decide on that answer again."
                ) from None


def _is_cut(line: bytes) -> bool:
    """Check whether a last line without a line break is an incomplete event."""
    try:
        _event(line.decode("utf8", "replace"))
    except ValueError:
        return True
    return False


def _line(event: Event) -> bytes:
    said = {"event": type(event).__name__.lower(), **event.as_json()}
    text = json.dumps(said | {"sum": _sum(said)}, ensure_ascii=False)
    return text.encode("utf8", "backslashreplace") + b"\n"


def _sum(said: Mapping[str, Json]) -> str:
    """Return a checksum, which shows whether a line was changed by hand."""
    return hashlib.sha256(json.dumps(said, sort_keys=True).encode()).hexdigest()[:12]


def _event(line: str) -> Event:
    """Return the event that a line contains.

    Raises
    ------
    ValueError
        It does not contain one; the message gives the reason.
    """
    about = Fields(json.loads(line), "the line")
    if about.get("sum", text) != _sum(about.beside(["sum"])):
        raise ValueError("it was changed")
    return KINDS[about.get("event", one_of(*KINDS))].from_json(about.found, about.where)


def _table(path: Path) -> tuple[set[str], list[Row]]:
    header, lines = cells_in(path)
    empty = dict.fromkeys(header, "")
    return set(header), [(number, empty | dict(zip(header, cells))) for number, cells in lines]


def _credit(text: str, where: str) -> float | None:
    if not text:
        return None
    # Points, such as "3 of 4", become a share. A spreadsheet would make a date of "3/4".
    with contextlib.suppress(ValueError, ZeroDivisionError):
        points, _, worth = text.replace(",", ".").replace(" of ", "/").partition("/")
        if 0 <= (share := float(points) / float(worth or 1)) <= 1:
            return share
    raise ValueError(
        f"{where}: {text!r} is neither a credit from 0 to 1, nor points such as '3 of 4', nor the "
        "letter of a box to tick."
    )
