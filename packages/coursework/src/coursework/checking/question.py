"""A question as a student's computer knows it, its sealed part, and how both are read and written.

JSON names a field as Python does, with spaces for underscores: ``either_sign`` is ``"either
sign"``. Empty fields are left out. `coursework.checking.questions` reads the files of sealed
questions.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from .fields import (
    Fields,
    Json,
    Misread,
    a_list,
    anything,
    by_name,
    many,
    number,
    one_of,
    pair,
    text,
    truth,
    whole,
    written,
)

# The format of the files with sealed questions.
FORMAT = 4
# The outcomes of a known answer, by their numbers in a locker.
OUTCOMES = ("correct", "mistake")


@dataclass(frozen=True)
class Variant:
    """The particular data of one variant of a question.

    Attributes
    ----------
    number, count : int
        The variant's number, and the number of variants.
    given : mapping
        Its numbers and names, by the names of the parameters.
    shown : mapping of str
        The same as its text shows them.
    text : str
        The text of the question, with placeholders such as ``{{force}}``.
    picture : str or None
        The picture, as `coursework.checking.variants.packed` returns it.
    names : tuple of str
        The names of all variants, if students get variants by name.
    edition : str
        The edition of the course, which determines the draws.
    """

    number: int = 0
    count: int = 1
    given: Mapping[str, Json] = field(default_factory=dict)
    shown: Mapping[str, str] = field(default_factory=dict)
    text: str = ""
    picture: str | None = None
    names: tuple[str, ...] = ()
    edition: str = ""

    @classmethod
    def of(cls, about: Fields) -> Variant | None:
        """Return the variant in a question's fields, or ``None`` if there is only one."""
        count = about.maybe("variants", whole)
        if count is None:
            return None
        return cls(
            about.maybe("variant", whole) or 0,
            count,
            about.maybe("given", by_name(anything)) or {},
            about.maybe("shown", by_name(text)) or {},
            about.maybe("text", text) or "",
            about.maybe("picture", text),
            about.maybe("names", many(text)) or (),
            about.maybe("edition", text) or "",
        )

    def as_json(self) -> dict[str, Json]:
        more = {"picture": self.picture, "names": written(self.names), "edition": self.edition}
        return {
            "variant": self.number,
            "variants": self.count,
            "given": written(self.given),
            "shown": written(self.shown),
            "text": self.text,
            **{name: value for name, value in more.items() if value},
        }


OF_VARIANTS = ("variant", "variants", "given", "shown", "text", "picture", "names", "edition")


@dataclass(frozen=True)
class Question:
    """The part of a question that a student's computer knows.

    Attributes
    ----------
    kind : str
        A key of `coursework.checking.plugins.kinds`.
    salt : str
        Determines the points and the edges of the cells, and is hashed with fingerprints.
    frames : tuple of str
        The target and the source; for a vector, the frame of its components.
    symbols : mapping of str to (float, float)
        The symbols of the answer, each with the range of its values.
    unit : tuple of tuples of str
        Groups of symbols that make a unit vector or a unit quaternion.
    shape : (int, int) or None
    length : int or None
    options : tuple of str
    tolerance, relative : float or None
        The allowed error of an answer, absolute and as a share of it; without a tolerance, it is
        exact.
    calls : tuple of lists
        The arguments of each call of a function.
    takes : str or None
        ``"lists"`` or ``"arrays"``.
    result : str or None
        The kind of a function's results.
    quantity : str or None
    either_sign, unit_vector : bool or None
    every_symbol : bool or None
        Whether the right answer contains each of the symbols.
    scale : str or None
        The size of a measurement's unit.
    exam : bool or None
        Whether nothing is sealed.
    variant : Variant or None
    arguments : mapping
        The arguments that only this kind of question has, by their names in its plug-in.
    """

    kind: str
    salt: str = ""
    frames: tuple[str, ...] = ()
    symbols: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    unit: tuple[tuple[str, ...], ...] = ()
    shape: tuple[int, int] | None = None
    length: int | None = None
    options: tuple[str, ...] = ()
    tolerance: float | None = None
    relative: float | None = None
    calls: tuple[list[Json], ...] = ()
    takes: str | None = None
    result: str | None = None
    quantity: str | None = None
    either_sign: bool | None = None
    unit_vector: bool | None = None
    every_symbol: bool | None = None
    scale: str | None = None
    exam: bool | None = None
    variant: Variant | None = None
    arguments: Mapping[str, Json] = field(default_factory=dict)

    @property
    def kind_of_values(self) -> str:
        """The kind of the compared values; for a function, that of its results."""
        return self.result if self.kind == "function" and self.result else self.kind

    @property
    def variants(self) -> int:
        """The number of variants."""
        return self.variant.count if self.variant else 1

    @property
    def given(self) -> Mapping[str, Json]:
        """The numbers and names of this variant."""
        return self.variant.given if self.variant else {}

    @classmethod
    def from_json(cls, content: object, where: str = "a question") -> Question:
        """Read a question; its sealed part may be beside it.

        Raises
        ------
        Misread
        """
        about = Fields(content, where)
        return cls(
            about.get("kind", text),
            about.maybe("salt", text) or "",
            about.maybe("frames", many(text)) or (),
            about.maybe("symbols", by_name(pair(number))) or {},
            about.maybe("unit", many(many(text))) or (),
            about.maybe("shape", pair(whole)),
            about.maybe("length", whole),
            about.maybe("options", many(text)) or (),
            about.maybe("tolerance", number),
            about.maybe("relative", number),
            about.maybe("calls", many(a_list)) or (),
            about.maybe("takes", one_of("lists", "arrays")),
            about.maybe("result", text),
            about.maybe("quantity", text),
            about.maybe("either sign", truth),
            about.maybe("unit vector", truth),
            about.maybe("every symbol", truth),
            about.maybe("scale", text),
            about.maybe("exam", truth),
            Variant.of(about),
            about.beside(NOT_OF_THE_KIND),
        )

    def as_json(self) -> dict[str, Json]:
        """Return the JSON that `from_json` reads."""
        fields_as_json: dict[str, Json] = {}
        for name, value in vars(self).items():
            if name == "variant":
                fields_as_json |= self.variant.as_json() if self.variant else {}
            elif name == "arguments":
                fields_as_json |= self.arguments
            elif value not in (None, (), {}):
                fields_as_json[name.replace("_", " ")] = written(value)
        return fields_as_json


class Place(NamedTuple):
    """The place of sealed content: a page's number, its key, and what to insert into its text."""

    page: int
    key: str
    short: str = ""

    @classmethod
    def from_json(cls, content: object, where: str) -> Place:
        if not isinstance(content, (list, tuple)) or len(content) not in (2, 3):
            raise Misread(where, "a page with its key", content)
        return cls(whole(content[0], where), *(text(part, where) for part in content[1:]))


class Note(NamedTuple):
    """The note of a mistake, and the details for its message."""

    note: str
    details: dict[str, Json]

    @classmethod
    def from_json(cls, content: object, where: str) -> Note:
        note, details = pair(anything)(content, where)
        return cls(text(note, where), by_name(anything)(details, where))


@dataclass(frozen=True)
class KnownAnswer:
    """A known answer of a question: the right one, or one that a mistake leads to.

    Attributes
    ----------
    outcome : str
        One of `OUTCOMES`.
    notes : tuple of Note
        The mistakes that lead to it.
    hints : tuple of str
    numbers : tuple of str
        Its numbers, if a tolerance or a neighbour requires them.
    """

    outcome: str
    notes: tuple[Note, ...] = ()
    hints: tuple[str, ...] = ()
    numbers: tuple[str, ...] = ()

    @classmethod
    def from_json(cls, content: object, where: str) -> KnownAnswer:
        about = Fields(content, where)
        return cls(
            about.get("outcome", one_of(*OUTCOMES)),
            about.maybe("notes", many(Note.from_json)) or (),
            about.maybe("hints", many(text)) or (),
            about.maybe("numbers", many(text)) or (),
        )

    def as_json(self) -> dict[str, Json]:
        fields_as_json = {"outcome": self.outcome, "notes": written(self.notes)}
        fields_as_json |= {"hints": written(self.hints)} if self.hints else {}
        return fields_as_json | ({"numbers": written(self.numbers)} if self.numbers else {})


@dataclass(frozen=True)
class Locker:
    """The content that a fingerprint opens.

    Attributes
    ----------
    answers : tuple of KnownAnswer
        The answers with this fingerprint; empty if it is that of nearly right answers.
    after : mapping of tuples of str
        Hints for other questions, by the names of these.
    solution : Place, str or None
        The worked solution, or its place.
    place : Place or None
        The place of all this.
    """

    answers: tuple[KnownAnswer, ...] = ()
    after: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    solution: Place | str | None = None
    place: Place | None = None

    @classmethod
    def from_json(cls, content: object, where: str, place: Place | None = None) -> Locker:
        about = Fields(content, where)
        return cls(
            about.maybe("cases", many(KnownAnswer.from_json)) or (),
            about.maybe("after", by_name(many(text))) or {},
            about.maybe("solution", _solution),
            place,
        )

    def as_json(self) -> dict[str, Json]:
        """Return the known answers.

        `coursework.authoring.author` seals the solution and its place.
        """
        cases: dict[str, Json] = {"cases": [answer.as_json() for answer in self.answers]}
        return cases | ({"after": written(self.after)} if self.after else {})


def _solution(content: object, where: str) -> Place | str:
    return content if isinstance(content, str) else Place.from_json(content, where)


@dataclass(frozen=True)
class Sealed:
    """A question with its sealed part, as students receive it.

    Attributes
    ----------
    question : Question
    answer : str
        The name of the answer.
    worth : float
    lockers : str
        The lockers, as `coursework.checking.sealing.pack` packs them.
    pages, ladder : tuple of str
        The pages and the general hints, as `coursework.checking.sealing.seal` seals them.
    others : (str, str) or None
        In the first variant: the salt that all variants share, and the names by which an answer is
        recognised as right in one of them, as `coursework.checking.sealing.pack_names` packs them.
    """

    question: Question
    lockers: str = ""
    worth: float = 1
    answer: str = ""
    pages: tuple[str, ...] = ()
    ladder: tuple[str, ...] = ()
    others: tuple[str, str] | None = None

    @classmethod
    def from_json(cls, content: object, where: str) -> Sealed:
        """Read a question of a file of sealed questions.

        Raises
        ------
        Misread
        """
        about = Fields(content, where)
        worth = about.maybe("worth", number)
        return cls(
            Question.from_json(content, where),
            about.maybe("lockers", text) or "",
            1 if worth is None else worth,
            about.maybe("answer", text) or "",
            about.maybe("pages", many(text)) or (),
            about.maybe("ladder", many(text)) or (),
            about.maybe("others", pair(text)),
        )

    def as_json(self) -> dict[str, Json]:
        """Return the JSON that `from_json` reads."""
        more = {"answer": self.answer, "pages": written(self.pages), "ladder": written(self.ladder)}
        more["others"] = written(self.others)
        sealed: dict[str, Json] = {"lockers": self.lockers, "worth": self.worth}
        return (
            self.question.as_json()
            | sealed
            | {name: value for name, value in more.items() if value}
        )


# The fields of a sealed question that are not arguments of its kind alone.
NOT_OF_THE_KIND = frozenset(
    name.replace("_", " ") for record in (Question, Sealed) for name in record.__dataclass_fields__
).union(OF_VARIANTS)
