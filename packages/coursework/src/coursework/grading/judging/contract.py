"""Contracts: everything that marking needs to know about a question."""

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
    """A secret second comparison of an answer, which no student can know.

    Attributes
    ----------
    salt : str or None
        Determines other points.
    calls : tuple of lists
        Other arguments of a function.
    right : tuple of str
        The numbers of the right answer there.
    partly : mapping
        The numbers of each mistake that earns credit, by its fingerprint.
    """

    salt: str | None = None
    calls: tuple[list[Json], ...] = ()
    right: tuple[str, ...] = ()
    partly: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    def of(self, question: Question) -> Question:
        """Return the question as it is asked there."""
        return (
            replace(question, calls=self.calls)
            if self.salt is None
            else replace(question, salt=self.salt)
        )

    @property
    def digest(self) -> str:
        """A digest of the calls, so that answers to other calls are not compared with these."""
        return hashlib.sha256(json.dumps(self.calls).encode()).hexdigest()[:16]


@dataclass(frozen=True)
class Contract(AsJson):
    """A version of a question, in one of its variants.

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
        The locker of each known answer, by its fingerprint; see `locker`.
    right : tuple of str or None
        The numbers of an exact right answer.
    plain : Plain or None
        The right answer, except that of a function.
    secret : Elsewhere or None
    partial : str or None
        The right answer in words, each part of which earns its share.
    rubric : mapping of float or None
        The criteria for a person who marks, with points where the author gives them.
    text : str
        The text in the source; if the question has variants, only its figures.
    version : str
        A digest of all of this.
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
        """Return the same contract with the version that everything else determines."""
        said = json.dumps(replace(self, version="").as_json(), sort_keys=True)
        return replace(self, version=hashlib.sha256(said.encode()).hexdigest()[:16])

    def locker(self, fingerprint: str) -> Locker | None:
        """Return the locker of a known answer's fingerprint, or ``None``."""
        content = self.known.get(fingerprint)
        return None if content is None else Locker.from_json(content, f"{self.title}: 'known'")

    @property
    def variant(self) -> Variant:
        return self.question.variant or Variant()

    @property
    def judging(self) -> Contract:
        """The part that decides how answers are judged, without the text and the points."""
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
        The contract by which the answer is judged.
    before : Contract or None
        The contract by which it was asked, if that was another.
    siblings : tuple of Contract
        All other variants.
    second_chances : mapping of Contract
        The variants that can make up for help, by the names of the siblings.
    others : tuple of Asked
        The variants that the student would have had by the source at other times, or would have
        now.
    """

    contract: Contract
    before: Contract | None = None
    siblings: tuple[Contract, ...] = ()
    second_chances: Mapping[str, Contract] = field(default_factory=dict)
    others: tuple[Asked, ...] = ()
