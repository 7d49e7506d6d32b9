"""The only way to change marks: show first who would gain and who would lose, then ask a person.

New marks are given at once. A mark that was given before changes only through `settle`, whatever
the cause: resubmitted work, a corrected question, another worth, a decision, a policy or a newer
version of the software. The author of a corrected question chooses by a policy what it may do to
marks: nobody loses by it, everybody who had a faulty variant gets its points, or it counts for
nobody.
"""

import getpass
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from ..record import Case, Mark, Record
from ..store import Store
from ..tables import in_a_line, number, number_of
from .journal import Given, Journal, Part

PAGE = "regrade.html"
#: Stands in place of a variant's name for all variants that the source no longer has.
TAKEN_OUT = "taken-out"
#: The outcomes of an answer whose notebook must run again, since the question now calls a function
#: differently, or is new or has a new name.
RUN_AGAIN = ("undecided (not called)", "undecided (not run)")
# The most changes on the screen. The table and the page have all of them.
MOST_SHOWN = 40


class BadPolicy(ValueError):
    """An error for a policy about a question that does not exist."""


@dataclass(frozen=True)
class Policies:
    """The policies about what corrected questions may do to marks.

    Attributes
    ----------
    never_lower : tuple of str
        Questions whose correction lowers nobody's mark.
    full_credit : tuple of str
        Questions that give everybody full points; ``"question@variant"`` for one variant.
    void : tuple of str
        Questions that count for nobody.
    """

    never_lower: tuple[str, ...] = ()
    full_credit: tuple[str, ...] = ()
    void: tuple[str, ...] = ()

    def demand(self, names: Iterable[str]) -> None:
        """Reject a policy about a question that is not asked.

        Raises
        ------
        BadPolicy
        """
        there = set(names)
        for name in (*self.never_lower, *self.full_credit, *self.void):
            if name.partition("@")[0] not in there:
                raise BadPolicy(
                    f"There is no question {name.partition('@')[0]!r}. The questions are "
                    f"{', '.join(sorted(there))}."
                )

    def applied(
        self, name: str, mark: Mark, before: Mark | None, case: Case, taken_out: bool
    ) -> Mark:
        """Return a mark after applying the policies.

        Parameters
        ----------
        name : str
        mark : Mark
            The mark that the machine gives now.
        before : Mark or None
            The mark that it gave before.
        case : Case
        taken_out : bool
            Whether the source no longer has the variant of this case.
        """
        if name in self.void:
            said = "This question does not count."
            return replace(mark, points=0, worth=0, messages=(said,), policy="void")
        wanted = {
            name,
            f"{name}@{case.own.variant}",
            *([f"{name}@{TAKEN_OUT}"] if taken_out else []),
        }
        if wanted & set(self.full_credit):
            said = "This question was faulty, so everyone who had it gets full points."
            return replace(
                mark,
                outcome="correct",
                note="full credit",
                messages=(said,),
                points=mark.worth,
                policy="full credit",
            )
        if name in self.never_lower and before is not None and before.worth:
            share = before.points / before.worth
            if share * mark.worth > mark.points:
                return replace(
                    mark,
                    outcome=before.outcome,
                    note=before.note,
                    details=before.details,
                    messages=before.messages,
                    points=round(share * mark.worth, 4),
                    group=before.group,
                    policy="never lower",
                )
        return mark


class Change(NamedTuple):
    """A possible change to one answer's mark."""

    student: str
    assignment: str
    question: str
    before: float
    worth_before: float
    after: float
    worth: float
    was: str
    outcome: str
    variant: str


class Move(NamedTuple):
    """A possible change to the marks of one student's work.

    Attributes
    ----------
    student, assignment : str
    before, worth_before, after, worth : float
        The points, and the points that were possible.
    why : str
    changes : list of Change
    """

    student: str
    assignment: str
    before: float
    worth_before: float
    after: float
    worth: float
    why: str
    changes: list[Change]

    @property
    def gain(self) -> float:
        """The share of the points that the student gains; negative for a loss."""
        before, after = (
            points / worth if worth else 0.0
            for points, worth in ((self.before, self.worth_before), (self.after, self.worth))
        )
        return after - before

    @property
    def run_again(self) -> bool:
        """Whether an answer must be run again, since the stored data are not enough to judge it."""
        return any(change.outcome in RUN_AGAIN for change in self.changes)

    def __str__(self) -> str:
        said = [number(self.before), number(self.after)]
        if self.worth != self.worth_before:
            said[0] += f" of {number(self.worth_before)}"
            said[1] += f" of {number(self.worth)}"
        questions = ", ".join(change.question for change in self.changes)
        return (
            f"{in_a_line(self.student, 60)!r}, {self.assignment}: {' -> '.join(said)}  "
            f"({questions}; {self.why})"
        )


def move_of(given: Given, record: Record, why: str) -> Move | None:
    """Return how a record would change the marks given; ``None`` if it only adds to them.

    An answer that waited for a person had no mark yet.
    """
    changes = []
    for name in dict.fromkeys((*given.marks, *record.marks)):
        old, new = given.marks.get(name), record.marks.get(name)
        if old and old.outcome == "undecided" and new:
            continue
        before = (old.points, old.worth) if old else (0.0, 0.0)
        after = (new.points, new.worth) if new else (0.0, 0.0)
        if before != after or (new and new.outcome == "undecided"):
            outcome = new and (f"{new.outcome} ({new.note})" if new.note else new.outcome)
            variant = record.cases[name].own.variant if name in record.cases else ""
            changes.append(
                Change(
                    given.student,
                    given.assignment,
                    name,
                    *before,
                    *after,
                    old.outcome if old else "not asked",
                    outcome or "not asked",
                    variant,
                )
            )
    if not changes:
        return None
    return Move(
        given.student,
        given.assignment,
        given.points,
        given.worth,
        record.points,
        record.worth,
        why,
        changes,
    )


@dataclass
class Laboratory:
    """All possible changes, whether a person has agreed to them, and what only adds to marks."""

    moves: list[Move] = field(default_factory=list)
    added: list[str] = field(default_factory=list)
    agreed: bool = False

    @property
    def gain(self) -> list[Move]:
        return [move for move in self.moves if move.gain > 0]

    @property
    def lose(self) -> list[Move]:
        return [move for move in self.moves if move.gain < 0 and not move.run_again]

    @property
    def again(self) -> list[Move]:
        return [move for move in self.moves if move.run_again]

    @property
    def even(self) -> list[Move]:
        """The changes that leave the share of the points the same."""
        others = (*self.gain, *self.lose, *self.again)
        return [move for move in self.moves if move not in others]

    def lines(self) -> list[str]:
        """Return what a person should know before agreeing."""
        said = [
            f"{_students(moves)} would {what}: {_about(moves)}."
            for what, moves in (("gain", self.gain), ("lose", self.lose))
            if moves
        ]
        if self.again:
            said.append(
                f"{_students(self.again)} would become undecided, because the stored answers are "
                f"not enough to judge {_about(self.again)}. To judge just these, run the same "
                "`coursework grade` command again."
            )
        if self.even:
            said.append(f"{_students(self.even)} would keep the same fraction of the points.")
        said += [f"  {move}" for move in self.moves[:MOST_SHOWN]]
        if len(self.moves) > MOST_SHOWN:
            said.append(f"  ... and {len(self.moves) - MOST_SHOWN} more.")
        return said

    def first_decided(self) -> list[str]:
        """Return the answers that a person decided for the first time. No mark changes."""
        indented = [f"  {line}" for line in self.added]
        return indented and [f"Decided for the first time ({len(self.added)}):", *indented]


#: A function that returns whether to make the changes that a laboratory shows.
Agree = Callable[[Laboratory], bool]


def settle(
    store: Store,
    journal: Journal,
    candidates: Iterable[Record],
    agree: Agree,
    why: str,
    dry_run: bool = False,
) -> Laboratory:
    """Give marks: new ones at once, and others once a person has agreed.

    Parameters
    ----------
    store : Store
    journal : Journal
    candidates : iterable of Record
        The records as they would become; only one at a time is held in memory.
    agree : function
        Receives the possible changes and returns whether to make them. Called only if there are
        any.
    why : str
        The reason for a change that is not due to resubmitted work.
    dry_run : bool
        Give nothing.
    """
    standing, laboratory, who = journal.standing(), Laboratory(), getpass.getuser()
    pending: dict[tuple[str, str], Given | None] = {}
    moving: dict[tuple[str, str], bool] = {}
    for record in candidates:
        key = record.student, record.assignment
        before, old = standing.given.get(key), store.read(*key)
        given = _given(record, before, why, who)
        same = before is not None and before.marks == given.marks and before.files == given.files
        if same and old == record:
            store.unstage(*key)
            continue
        if before and (move := move_of(before, record, given.why)):
            laboratory.moves.append(move)
            moving[key] = old is not None and old.key != record.key
        elif before and before.points != given.points:
            laboratory.added.append(
                f"{in_a_line(record.student, 60)!r}, {record.assignment}: "
                f"{number(before.points)} -> {number(given.points)}  ({given.why})"
            )
        store.stage(record)
        pending[key] = None if same else given
    laboratory.agreed = not laboratory.moves or agree(laboratory)
    for key, was_run_again in moving.items():
        if not laboratory.agreed:
            del pending[key]
            # Keep a record that was run, so that it need not run again if somebody agrees later.
            if not was_run_again:
                store.unstage(*key)
    if dry_run:
        for key in pending:
            store.unstage(*key)
        return laboratory
    # Enter the marks in the journal before showing them, so that after a crash in between the next
    # run knows that they were agreed to.
    journal.append(given for given in pending.values() if given)
    for key in pending:
        store.promote(*key)
    for move in laboratory.moves:
        store.log(f"{'moved' if laboratory.agreed else 'not changed, nobody agreed'}: {move}")
    return laboratory


def _given(record: Record, before: Given | None, why: str, who: str) -> Given:
    marks = {
        name: Part(mark.points, mark.worth, mark.outcome) for name, mark in record.marks.items()
    }
    files = {notebook.file: notebook.sha256 for notebook in record.notebooks}
    if before is None:
        why = "graded"
    elif sorted(before.files.values()) != sorted(files.values()):
        why = "handed in again"
    else:
        moved = [
            record.marks[name] for name, part in marks.items() if before.marks.get(name) != part
        ]
        reasons = (
            f"{mark.decided['who']} decided" if mark.decided else mark.policy or why
            for mark in moved
        )
        why = ", ".join(dict.fromkeys(reasons)) or why
    return Given(
        who=who,
        student=record.student,
        assignment=record.assignment,
        why=why,
        points=record.points,
        worth=record.worth,
        marks=marks,
        files=files,
    )


def _students(moves: Sequence[Move]) -> str:
    return number_of(len({move.student for move in moves}), "student")


def _about(moves: Sequence[Move]) -> str:
    return ", ".join(dict.fromkeys(change.question for move in moves for change in move.changes))
