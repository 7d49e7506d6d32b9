"""What the class says of each question: how hard it is, whether it tells
students apart, and what was mixed up.

One record after another is taken in, and what is kept grows with the number of different answers,
not with the class. The counts of a year hold nobody's name and nobody's answer; they can be kept,
and the next year stands beside them.
"""

import math
from collections import Counter, defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, field

from ...checking.fields import Json
from ...checking.plain import Plain
from ..judging.journal import digest_of_answer
from ..record import Mark, Record
from .reports import deed

FEWEST = 10  # students, below which a correlation says nothing
#: What fewer did is put together with the others, so that a count points at nobody.
HIDDEN_BELOW = 3
MOST_NAMES = 40  # of those who gave one answer
FORMAT = 1


class Correlation:
    """Pearson's correlation of pairs that come one after another."""

    def __init__(self) -> None:
        self.number = 0
        self.x = self.y = self.xx = self.yy = self.xy = 0.0

    def add(self, x: float, y: float) -> None:
        self.number += 1
        self.x += x
        self.y += y
        self.xx += x * x
        self.yy += y * y
        self.xy += x * y

    @property
    def value(self) -> float | None:
        """``None`` for too few pairs, or where one of the two does not vary."""
        spread = (self.number * self.xx - self.x**2) * (self.number * self.yy - self.y**2)
        if self.number < FEWEST or spread <= 1e-9 * self.number**4:
            return None
        return max(-1.0, min(1.0, (self.number * self.xy - self.x * self.y) / math.sqrt(spread)))

    @property
    def interval(self) -> tuple[float, float] | None:
        """The 95 % interval by Fisher's transformation, or ``None``."""
        value = self.value
        if value is None:
            return None
        middle, half = (
            math.atanh(max(-0.999999, min(0.999999, value))),
            1.96 / math.sqrt(self.number - 3),
        )
        return math.tanh(middle - half), math.tanh(middle + half)


@dataclass
class Same:
    """Equal answers: an example, how many there are, and the first who gave one."""

    plain: Plain | None
    number: int = 0
    who: list[str] = field(default_factory=list)


class Question:
    """What is known of one question.

    Attributes
    ----------
    outcomes : Counter
    earned : float
        The sum of the shares of credit, without answers that wait for a person.
    discrimination : Correlation
        Of the share earned here with the share earned in the rest of the assignment.
    notes : Counter
        What was mixed up, in words.
    answers : dict of Same
        By the outcome, what was mixed up, and what equal answers have in common.
    """

    def __init__(self, assignment: str, mark: Mark) -> None:
        self.assignment, self.title, self.worth = assignment, mark.title, mark.worth
        self.outcomes: Counter[str] = Counter()
        self.notes: Counter[str] = Counter()
        self.earned, self.decided = 0.0, 0
        self.discrimination = Correlation()
        self.answers: dict[tuple[str, str, str], Same] = {}
        self.versions: set[str] = set()

    @property
    def number(self) -> int:
        return sum(self.outcomes.values())

    @property
    def difficulty(self) -> float | None:
        """The mean share of the credit; ``None`` as long as all wait."""
        return self.earned / self.decided if self.decided else None


class Statistics:
    """The statistics of a class, from its records."""

    def __init__(self) -> None:
        self.questions: dict[tuple[str, str], Question] = {}
        self.students: defaultdict[str, int] = defaultdict(int)

    def add(self, record: Record) -> None:
        marks = record.marks
        self.students[record.assignment] += 1
        earned = sum(mark.points for mark in marks.values())
        worth = sum(mark.worth for mark in marks.values())
        for name, mark in marks.items():
            key = record.assignment, name
            if key not in self.questions:
                self.questions[key] = Question(record.assignment, mark)
            question = self.questions[key]
            question.outcomes[mark.outcome] += 1
            question.versions.add(mark.version)
            did = deed(mark) if mark.note and mark.outcome in ("wrong", "invalid") else ""
            if did:
                question.notes[did] += 1
            answer = (mark.outcome, did, mark.group or digest_of_answer(record, name))
            same = question.answers.setdefault(answer, Same(record.answer(name).plain))
            same.number += 1
            if len(same.who) < MOST_NAMES:
                same.who.append(record.student)
            if mark.outcome == "undecided":
                continue
            share = mark.points / mark.worth if mark.worth else 0
            question.decided += 1
            question.earned += share
            if worth > mark.worth:
                question.discrimination.add(share, (earned - mark.points) / (worth - mark.worth))

    def counts(self, name: str) -> dict[str, Json]:
        """What can be kept for other years: numbers only, and none of so
        few that it points at somebody.
        """
        return {
            "format": FORMAT,
            "name": name,
            "questions": {
                question: {
                    "assignment": assignment,
                    "version": min(found.versions) if len(found.versions) == 1 else "",
                    "students": found.number,
                    "share": None if found.difficulty is None else round(found.difficulty, 4),
                    "discrimination": None
                    if found.discrimination.value is None
                    else round(found.discrimination.value, 4),
                    "mix-ups": _without_few(found.notes),
                }
                for (assignment, question), found in sorted(self.questions.items())
                if found.number >= HIDDEN_BELOW
            },
        }


def _without_few(notes: Mapping[str, int]) -> dict[str, Json]:
    kept: dict[str, Json] = {
        what: count for what, count in sorted(notes.items()) if count >= HIDDEN_BELOW
    }
    others = sum(notes.values()) - sum(notes[what] for what in kept)
    return {**kept, "others": others} if others >= HIDDEN_BELOW else kept
