"""All that marks need of a question: its contract, and what belongs
to it where one student is asked it.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import cast

from ...checking.fields import (
    Fields,
    Json,
    a_list,
    anything,
    by_name,
    many,
    number,
    text,
    written,
)
from ...checking.plain import Plain
from ...checking.question import Locker, Question, Variant


@dataclass(frozen=True)
class Elsewhere:
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

    @classmethod
    def from_json(cls, found: object, where: str) -> Elsewhere:
        about = Fields(found, where)
        return cls(
            about.maybe("salt", text),
            about.maybe("calls", many(a_list)) or (),
            about.get("right", many(text)),
            about.maybe("partly", by_name(many(text))) or {},
        )

    def as_json(self) -> dict[str, Json]:
        place: dict[str, Json] = (
            {"calls": written(self.calls)} if self.salt is None else {"salt": self.salt}
        )
        return place | {"right": written(self.right), "partly": written(self.partly)}

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


def _rubric(found: object, where: str) -> tuple[str, ...] | dict[str, float]:
    return by_name(number)(found, where) if isinstance(found, dict) else many(text)(found, where)


@dataclass(frozen=True)
class Contract:
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
        The locker of each known answer, by its fingerprint: :meth:`locker` reads it.
    right : tuple of str or None
        The numbers of an exact right answer.
    plain : Plain or None
        The right answer, but for a function.
    secret : Elsewhere or None
    partial : str or None
        The right answer in words, whose parts earn their share.
    rubric : tuple of str, or mapping of float
        What a person looks for, with points where its author says so.
    text : str
        In the source; beside that of a variant, its figures.
    version : str
        What follows from all this.
    """

    title: str
    variable: str | None
    worth: float
    question: Question
    credit: Mapping[str, float] = field(default_factory=dict)
    known: Mapping[str, Json] = field(default_factory=dict)
    right: tuple[str, ...] | None = None
    plain: Plain | None = None
    secret: Elsewhere | None = None
    partial: str | None = None
    rubric: tuple[str, ...] | Mapping[str, float] = ()
    text: str = ""
    version: str = ""

    @classmethod
    def from_json(cls, found: object, where: str) -> Contract:
        """Read a contract.

        Raises
        ------
        Misread
        """
        about = Fields(found, where)
        return cls(
            about.get("title", text),
            about.maybe("variable", text),
            about.get("worth", number),
            about.get("public", Question.from_json),
            about.maybe("credit", by_name(number)) or {},
            about.maybe("known", by_name(anything)) or {},
            about.maybe("right", many(text)),
            cast("Plain | None", about.maybe("plain", by_name(a_list))),
            about.maybe("secret", Elsewhere.from_json),
            about.maybe("partial", text),
            about.maybe("rubric", _rubric) or (),
            about.maybe("text", text) or "",
            about.maybe("version", text) or "",
        )

    def as_json(self) -> dict[str, Json]:
        """What :meth:`from_json` reads."""
        return {
            "title": self.title,
            "variable": self.variable,
            "worth": self.worth,
            "credit": written(self.credit),
            "public": self.question.as_json(),
            "known": written(self.known),
            "right": written(self.right),
            "plain": written(self.plain),
            "secret": self.secret.as_json() if self.secret else None,
            "partial": self.partial,
            "rubric": written(self.rubric),
            "text": self.text,
            "version": self.version,
        }

    def with_version(self) -> Contract:
        """The same with the version that follows from everything else."""
        said = {name: value for name, value in self.as_json().items() if name != "version"}
        return replace(
            self, version=hashlib.sha256(json.dumps(said, sort_keys=True).encode()).hexdigest()[:16]
        )

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
            rubric=tuple(self.rubric),
            question=replace(self.question, variant=variant),
        )


def variants_from_json(found: object, where: str) -> tuple[Contract, ...]:
    """Read a question in all its variants, in the order of their numbers."""
    others = Fields(found, where).maybe("others", many(Contract.from_json)) or ()
    return (Contract.from_json(found, where), *others)


def variants_as_json(variants: tuple[Contract, ...]) -> dict[str, Json]:
    """What :func:`variants_from_json` reads."""
    first, *others = (one.as_json() for one in variants)
    return {**first, "others": list(others)} if others else first


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
