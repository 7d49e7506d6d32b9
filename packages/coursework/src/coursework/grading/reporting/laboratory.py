"""What a regrade would do, before a mark moves: who gains, who loses, and what
cannot be judged from what is stored.

The questions as they are now are tried on all stored cases. What a mended question may do to marks
is for its author to choose, as a policy: nobody loses by it, all who had a faulty variant have its
points, or it counts for nobody.
"""

import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple

from ..record import Case, Mark, Record
from ..store import as_text, write
from ..tables import number, table

FILE, TABLE, PAGE = "policies.json", "regrade.csv", "regrade.html"
#: Instead of the name of a variant: all that the source has no more.
TAKEN_OUT = "taken-out"
#: The note of an answer that is to be run again, since it was not asked
#: for what the question asks for now.
RUN_AGAIN = "not called"


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

    @classmethod
    def of(cls, folder: Path) -> "Policies":
        """Those that were chosen for a folder of results."""
        path = folder / FILE
        kept = json.loads(path.read_text("utf8")) if path.exists() else {}
        return cls(**{name: tuple(questions) for name, questions in kept.items()})

    def keep(self, folder: Path) -> None:
        write(folder / FILE, as_text(asdict(self)))

    def and_also(self, other: "Policies") -> "Policies":
        mine, theirs = asdict(self), asdict(other)
        return Policies(
            **{name: tuple(dict.fromkeys((*mine[name], *theirs[name]))) for name in mine}
        )

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
                    f"There is no question {one.partition('@')[0]!r}; there are "
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
            said = "There was a fault in this question: all who were asked it have its points."
            return replace(
                mark,
                outcome="correct",
                note="full credit",
                messages=(said,),
                points=mark.worth,
                policy="full credit",
            )
        if name in self.never_lower and before is not None and before.points > mark.points:
            return replace(
                mark,
                outcome=before.outcome,
                note=before.note,
                details=before.details,
                messages=before.messages,
                points=before.points,
                group=before.group,
                policy="never lower",
            )
        return mark


class Change(NamedTuple):
    """What a regrade would do to one answer."""

    student: str
    assignment: str
    question: str
    before: float
    after: float
    was: str
    outcome: str
    variant: str

    @property
    def run_again(self) -> bool:
        return self.outcome == f"undecided ({RUN_AGAIN})"


@dataclass
class Laboratory:
    """What a regrade would do to a class: the changes by questions, and
    the points that move ``by_people``.
    """

    changes: list[Change] = field(default_factory=list)
    by_people: list[Any] = field(default_factory=list)

    def add(self, before: Record, after: Record) -> None:
        """Take in a record as it is, and as it would be."""
        for name, mark in after.marks.items():
            old = before.marks.get(name, Mark("not asked"))
            if (old.points, old.outcome) != (mark.points, mark.outcome):
                change = Change(
                    before.student,
                    before.assignment,
                    name,
                    old.points,
                    mark.points,
                    _outcome(old),
                    _outcome(mark),
                    after.cases[name].own.variant,
                )
                self.changes.append(change)

    @property
    def gain(self) -> list[Change]:
        return [one for one in self.changes if one.after > one.before]

    @property
    def lose(self) -> list[Change]:
        return [one for one in self.changes if one.after < one.before and not one.run_again]

    @property
    def again(self) -> list[Change]:
        return [one for one in self.changes if one.run_again]

    def lines(self) -> list[str]:
        """What a person should know before saying yes."""
        said = []
        for what, found in (("gain", self.gain), ("lose", self.lose)):
            if found:
                points = sum(abs(one.after - one.before) for one in found)
                said.append(
                    f"{_students(found)} would {what}, {number(round(points, 4))} points in all: "
                    f"{_about(found)}."
                )
        if self.again:
            said.append(
                f"{_students(self.again)} would wait: what is stored does not tell how to judge "
                f"{_about(self.again)}. "
                "`coursework grade`, as you said it before, runs just these again."
            )
        others = len(self.changes) - len(self.gain) - len(self.lose) - len(self.again)
        if others:
            said.append(f"{others} answers would have another outcome, and the same points.")
        return said

    def write(self, folder: Path) -> None:
        """Write the table and the page."""
        from .templates_of_pages import page  # which takes a while, and is needed here alone

        order = sorted(self.changes)
        write(folder / TABLE, table(Change._fields, order))
        groups: Sequence[tuple[str, list[Change]]] = (
            ("Who would gain", self.gain),
            ("Who would lose", self.lose),
            ("What cannot be judged from what is stored, and is to be run again", self.again),
        )
        write(
            folder / PAGE, page("laboratory.html", groups=groups, changes=order, lines=self.lines())
        )


def _outcome(mark: Mark) -> str:
    return f"{mark.outcome} ({mark.note})" if mark.note else mark.outcome


def _students(found: Sequence[Change]) -> str:
    many = len({one.student for one in found})
    return f"{many} student{'s' if many > 1 else ''}"


def _about(found: Sequence[Change]) -> str:
    return ", ".join(dict.fromkeys(one.question for one in found))
