"""All that marks need of a question: its contract, and what belongs
to it where one student is asked it.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from ...checking.fields import Json
from ...checking.plain import Plain
from ...checking.question import Locker, Question, Variant
from ..reading import AsJson


@dataclass(frozen=True)
class Elsewhere(AsJson):
    """Where an answer is compared once more, which no student can know.

    Attributes
    ----------
    salt : str or None
        From which other points follow.
    calls : tuple of lists
        Other arguments of a function.
    right : tuple of str
        The numbers of the right answer there.
    partly : mapping
        Those of each mistake that earns something, by its fingerprint.
    """

    salt: str | None = None
    calls: tuple[list[Json], ...] = ()
    right: tuple[str, ...] = ()
    partly: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    def of(self, question: Question) -> Question:
        """A question as it is asked there."""
        return (
            replace(question, calls=self.calls)
            if self.salt is None
            else replace(question, salt=self.salt)
        )

    @property
    def digest(self) -> str:
        """A short text that follows from the calls: answers to other
        calls are not compared with these.
        """
        return hashlib.sha256(json.dumps(self.calls).encode()).hexdigest()[:16]


@dataclass(frozen=True)
class Contract(AsJson):
    """A question as it stands, in one of its variants.

    Attributes
    ----------
    title : str
    variable : str or None
        The name of the answer.
    worth : float
    credit : mapping of float
        The share of the points that a mistake earns, by its note.
    question : Question
    known : mapping
        The locker of each known answer, by its fingerprint: `locker` reads it.
    right : tuple of str or None
        The numbers of an exact right answer.
    plain : Plain or None
        The right answer, but for a function.
    secret : Elsewhere or None
    partial : str or None
        The right answer in words, whose parts earn their share.
    rubric : mapping of float or None
        What a person looks for, with points where its author says so.
    text : str
        In the source; beside that of a variant, its figures.
    version : str
        What follows from all this.
    """

    title: str
    variable: str | None
    worth: float
    question: Question = field(metadata={"key": "public"})
    credit: Mapping[str, float] = field(default_factory=dict)
    known: Mapping[str, Json] = field(default_factory=dict)
    right: tuple[str, ...] | None = None
    plain: Plain | None = None
    secret: Elsewhere | None = None
    partial: str | None = None
    rubric: Mapping[str, float | None] = field(default_factory=dict)
    text: str = ""
    version: str = ""

    def with_version(self) -> Contract:
        """The same with the version that follows from everything else."""
        said = json.dumps(replace(self, version="").as_json(), sort_keys=True)
        return replace(self, version=hashlib.sha256(said.encode()).hexdigest()[:16])

    def locker(self, fingerprint: str) -> Locker | None:
        """What is known of a fingerprint."""
        found = self.known.get(fingerprint)
        return None if found is None else Locker.from_json(found, f"{self.title}: 'known'")

    @property
    def variant(self) -> Variant:
        return self.question.variant or Variant()

    @property
    def judging(self) -> Contract:
        """What of it decides on answers: a word of the text may be
        another, or what a line is worth.
        """
        variant = self.question.variant and replace(
            self.question.variant, text="", shown={}, picture=None
        )
        return replace(
            self,
            version="",
            title="",
            text="",
            secret=None,
            rubric=dict.fromkeys(self.rubric),
            question=replace(self.question, variant=variant),
        )


@dataclass(frozen=True)
class Asked:
    """A question as one student is asked it.

    Attributes
    ----------
    contract : Contract
        By which the answer is judged.
    before : Contract or None
        By which it was asked, where that is another.
    siblings : tuple of Contract
        All other variants.
    second_chances : mapping of Contract
        The variants that may make good for help, by the names of the siblings.
    others : tuple of Asked
        The variants that the student would have by the source as it stands, or stood, at other
        times.
    """

    contract: Contract
    before: Contract | None = None
    siblings: tuple[Contract, ...] = ()
    second_chances: Mapping[str, Contract] = field(default_factory=dict)
    others: tuple[Asked, ...] = ()
