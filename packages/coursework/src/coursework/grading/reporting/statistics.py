"""Statistics of each question: difficulty, discrimination between students, and mistakes.

They are collected from one record after another, keeping one example of equal answers.
"""

import math
import statistics
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple, Self

from ...checking.plain import Plain
from ..judging.journal import digest_of_answer
from ..record import Mark, Record
from .reports import deed

# The fewest students for which a correlation is meaningful.
FEWEST = 10
# The most names of students who gave the same answer.
MOST_NAMES = 40


class Correlation(NamedTuple):
    """Pearson's correlation coefficient, with its 95 % interval by Fisher's transformation."""

    value: float
    low: float
    high: float

    @classmethod
    def of(cls, pairs: Sequence[tuple[float, float]]) -> Self | None:
        """Compute it from pairs; ``None`` for too few, or if one of the two does not vary."""
        columns = list(zip(*pairs, strict=True))
        if len(pairs) < FEWEST or min(len(set(column)) for column in columns) == 1:
            return None
        value = statistics.correlation(*columns)
        middle = math.atanh(max(-0.999999, min(0.999999, value)))
        half = 1.96 / math.sqrt(len(pairs) - 3)
        return cls(value, math.tanh(middle - half), math.tanh(middle + half))


@dataclass
class Same:
    """Equal answers: an example, their number, and the first students who gave one."""

    plain: Plain | None
    number: int = 0
    who: list[str] = field(default_factory=list)


class Question:
    """The statistics of one question.

    Attributes
    ----------
    outcomes : Counter
    earned : float
        The sum of the shares of credit, without answers that wait for a person.
    shares : list
        For each student, the share earned here and that earned in the rest of the assignment.
    notes : Counter
        The mistakes, in words.
    answers : dict of Same
        Equal answers, by outcome, mistake and what they have in common.
    """

    def __init__(self, assignment: str, mark: Mark) -> None:
        self.assignment, self.title, self.worth = assignment, mark.title, mark.worth
        self.outcomes: Counter[str] = Counter()
        self.notes: Counter[str] = Counter()
        self.earned, self.decided = 0.0, 0
        self.shares: list[tuple[float, float]] = []
        self.answers: dict[tuple[str, str, str], Same] = {}

    @property
    def number(self) -> int:
        return sum(self.outcomes.values())

    @property
    def discrimination(self) -> Correlation | None:
        return Correlation.of(self.shares)

    @property
    def difficulty(self) -> float | None:
        """The mean share of the credit; ``None`` as long as all answers wait for a person."""
        return self.earned / self.decided if self.decided else None


class Statistics:
    """The statistics of a class, from its records."""

    def __init__(self) -> None:
        self.questions: dict[tuple[str, str], Question] = {}

    def add(self, record: Record) -> None:
        marks = record.marks
        earned = sum(mark.points for mark in marks.values())
        worth = sum(mark.worth for mark in marks.values())
        for name, mark in marks.items():
            key = record.assignment, name
            if key not in self.questions:
                self.questions[key] = Question(record.assignment, mark)
            question = self.questions[key]
            question.outcomes[mark.outcome] += 1
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
                rest = (earned - mark.points) / (worth - mark.worth)
                question.shares.append((round(share, 9), round(rest, 9)))
