"""The one door for marks: what would move is said first, who gains
and who loses, and a person agrees.

A mark is new, or it was given before. New marks are given at once. One that was given moves only
through `settle`, whatever would move it: work that was handed in again, a question that was
mended, another worth, a decision, a policy, a newer version of the software. What a mended question
may do to marks is for its author to choose, as a policy: nobody loses by it, all who had a faulty
variant have its points, or it counts for nobody.
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
#: Instead of the name of a variant: all that the source has no more.
TAKEN_OUT = "taken-out"
#: The note of an answer that is to be run again, since it was not asked
#: for what the question asks for now.
RUN_AGAIN = "not called"
MOST_SHOWN = 40  # moves on the screen; all are in the table and on the page


class BadPolicy(ValueError):
    """A policy is for a question that there is not."""


@dataclass(frozen=True)
class Policies:
    """What mended questions may do to marks.

    Attributes
    ----------
    never_lower : tuple of str
        Questions by whose mending nobody loses.
    full_credit : tuple of str
        Questions whose points everybody has; ``"question@variant"`` for one variant of it.
    void : tuple of str
        Questions that count for nobody.
    """

    never_lower: tuple[str, ...] = ()
    full_credit: tuple[str, ...] = ()
    void: tuple[str, ...] = ()

    def demand(self, names: Iterable[str]) -> None:
        """Refuse a policy for a question that is not asked.

        Raises
        ------
        BadPolicy
        """
        there = set(names)
        for one in (*self.never_lower, *self.full_credit, *self.void):
            if one.partition("@")[0] not in there:
                raise BadPolicy(
                    f"There is no question {one.partition('@')[0]!r}. The questions are "
                    f"{', '.join(sorted(there))}."
                )

    def applied(
        self, name: str, mark: Mark, before: Mark | None, case: Case, taken_out: bool
    ) -> Mark:
        """A mark as the policies have it.

        Parameters
        ----------
        name : str
        mark : Mark
            What the machine says now.
        before : Mark or None
            What it said before.
        case : Case
        taken_out : bool
            Whether the source has the variant of this case no more.
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
    """What would become of one answer whose mark was given."""

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
    """What would become of the marks of one student's work.

    Attributes
    ----------
    student, assignment : str
    before, worth_before, after, worth : float
        The points, and of how many.
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
        """The share of the points that is won; below 0, that is lost."""
        if self.worth == self.worth_before:
            return self.after - self.before
        before, after = (
            points / worth if worth else 0.0
            for points, worth in ((self.before, self.worth_before), (self.after, self.worth))
        )
        return after - before

    @property
    def run_again(self) -> bool:
        """Whether something waits to be run, since what is stored does not tell."""
        return any(change.outcome == f"undecided ({RUN_AGAIN})" for change in self.changes)

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
    """What a record would move of the marks that were given; ``None`` where it only adds to them.

    What waited for a person was not given yet.
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
    key, points = (given.student, given.assignment), (given.points, given.worth)
    return Move(*key, *points, record.points, record.worth, why, changes)


@dataclass
class Laboratory:
    """All that would move, whether a person has agreed, and what was only added to marks."""

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
        """Those whose share of the points stays the same."""
        others = (*self.gain, *self.lose, *self.again)
        return [move for move in self.moves if move not in others]

    def lines(self) -> list[str]:
        """What a person should know before saying yes."""
        said = []
        for what, moves in (("gain", self.gain), ("lose", self.lose)):
            if moves:
                said.append(f"{_students(moves)} would {what}: {_about(moves)}.")
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
        """What waited for a person, and was decided: that moves no mark that was given."""
        indented = [f"  {line}" for line in self.added]
        return indented and [f"Decided for the first time ({len(self.added)}):", *indented]


#: Says whether what a laboratory shows shall come to pass.
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
        As they would be; one at a time is held in memory.
    agree : function
        Hears what would move, and says whether it shall. Asked only where something would.
    why : str
        What moves a mark, where it is not work that was handed in again.
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
            points = f"{number(before.points)} -> {number(given.points)}"
            laboratory.added.append(
                f"{in_a_line(record.student, 60)!r}, {record.assignment}: {points}  ({given.why})"
            )
        store.stage(record)
        pending[key] = None if same else given
    laboratory.agreed = not laboratory.moves or agree(laboratory)
    for key, was_run_again in moving.items():
        if not laboratory.agreed:
            del pending[key]
            # What was run is not run once more when somebody agrees later.
            if not was_run_again:
                store.unstage(*key)
    if dry_run:
        for key in pending:
            store.unstage(*key)
        return laboratory
    # First what was given, then where it is shown: of a crash in between,
    # the next run knows what was agreed.
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
