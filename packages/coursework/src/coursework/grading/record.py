"""The record of one student's work on one assignment, as it is stored: what was
handed in, asked, answered and marked.

JSON calls a field as Python does, with spaces for underscores.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import cast

from ..checking.fields import (
    Fields,
    Json,
    anything,
    by_name,
    many,
    number,
    text,
    truth,
    whole,
    written,
)
from ..checking.plain import Plain

FORMAT = 3


@dataclass(frozen=True)
class Answer:
    """What the sandbox says of an answer.

    Attributes
    ----------
    outcome : str
        ``"recorded"``, ``"unreadable"``, ``"missing"``, or how reading it was stopped.
    plain : Plain or None
    why : str or None
        It is unreadable.
    error : str or None
        With which reading it was stopped.
    source : str or None
        ``"check"`` or ``"variable"``.
    cell : int or None
        The number of the cell that gave it.
    secret : mapping or None
        What a function gave for arguments that no student knows: ``"plain"`` or ``"unreadable"``,
        and the digest of its ``"calls"``.
    more : mapping
        What else is known of how it was stopped.
    """

    outcome: str
    plain: Plain | None = None
    why: str | None = None
    error: str | None = None
    source: str | None = None
    cell: int | None = None
    secret: Mapping[str, Json] | None = None
    more: Mapping[str, Json] = field(default_factory=dict)

    @property
    def is_blank(self) -> bool:
        """Whether what was answered is the blank that the exercise came with."""
        return (
            self.outcome == "recorded"
            and self.plain is not None
            and self.plain["value"] == ["blank"]
        )

    @classmethod
    def from_json(cls, found: object, where: str = "an answer") -> Answer:
        about = Fields(found, where)
        return cls(
            about.get("outcome", text),
            # read_plain looks at it where it is judged.
            cast("Plain | None", about.maybe("plain", anything)),
            about.maybe("why", text),
            about.maybe("error", text),
            about.maybe("from", text),
            about.maybe("cell", whole),
            about.maybe("secret", by_name(anything)),
            about.beside(("outcome", "plain", "why", "error", "from", "cell", "secret")),
        )

    def as_json(self) -> dict[str, Json]:
        """What :meth:`from_json` reads; decisions are bound to a digest of it."""
        found: dict[str, Json] = {"outcome": self.outcome}
        for name, value in (("plain", self.plain), ("why", self.why), ("error", self.error)):
            found |= {} if value is None else {name: written(value)}
        found |= self.more
        found |= {} if self.source is None else {"from": self.source, "cell": self.cell}
        return found | ({} if self.secret is None else {"secret": written(self.secret)})


@dataclass(frozen=True)
class Remembered:
    """What the outputs of a notebook remember of the way to an answer.

    Attributes
    ----------
    tries : int
        How many different answers were tried.
    tried : tuple of str
        A few digits of each that was wrong.
    help : str
        The help that was had before it was right, a key of :data:`coursework.checking.reply.HELP`;
        or nothing.
    """

    tries: int = 0
    tried: tuple[str, ...] = ()
    help: str = ""

    @classmethod
    def from_json(cls, found: object, where: str) -> Remembered:
        about = Fields(found, where)
        return cls(
            about.maybe("tries", whole) or 0,
            about.maybe("tried", many(text)) or (),
            about.maybe("help", text) or "",
        )

    def as_json(self) -> dict[str, Json]:
        return {"tries": self.tries, "tried": written(self.tried), "help": self.help}


@dataclass(frozen=True)
class Place:
    """A variant of a question: its name, and the version of the question in it."""

    variant: str
    contract: str

    @classmethod
    def from_json(cls, found: object, where: str) -> Place:
        about = Fields(found, where)
        return cls(about.get("variant", text), about.get("contract", text))

    def as_json(self) -> dict[str, Json]:
        return {"variant": self.variant, "contract": self.contract}


@dataclass(frozen=True)
class Case:
    """What a student was asked.

    Attributes
    ----------
    question : str
    own : Place
    siblings : mapping of str to Place
        The other variants that may make good for help, by the names of the siblings.
    rule : str
        How the variant was found: ``"number 3 of 8"``, ``"by name, of 8"``, or empty where there is
        only one.
    edition : str
        Of the course: another one draws afresh.
    """

    question: str
    own: Place
    siblings: Mapping[str, Place] = field(default_factory=dict)
    rule: str = ""
    edition: str = ""

    @classmethod
    def from_json(cls, found: object, where: str) -> Case:
        about = Fields(found, where)
        return cls(
            about.get("question", text),
            about.get("own", Place.from_json),
            about.get("siblings", by_name(Place.from_json)),
            about.get("rule", text),
            about.get("edition", text),
        )

    def as_json(self) -> dict[str, Json]:
        return {
            "question": self.question,
            "own": self.own.as_json(),
            "siblings": {name: place.as_json() for name, place in self.siblings.items()},
            "rule": self.rule,
            "edition": self.edition,
        }


@dataclass(frozen=True)
class Judged:
    """What the machine said of an answer, in place of which a person decided."""

    outcome: str
    note: str
    points: float
    messages: tuple[str, ...]

    @classmethod
    def from_json(cls, found: object, where: str) -> Judged:
        about = Fields(found, where)
        return cls(
            about.get("outcome", text),
            about.get("note", text),
            about.get("points", number),
            about.get("messages", many(text)),
        )

    def as_json(self) -> dict[str, Json]:
        return {
            "outcome": self.outcome,
            "note": self.note,
            "points": self.points,
            "messages": written(self.messages),
        }


@dataclass(frozen=True)
class Mark:
    """The mark of an answer.

    Attributes
    ----------
    outcome : str
        ``"correct"``, ``"wrong"``, ``"invalid"``, ``"undecided"``, ``"not attempted"`` or
        ``"decided"``.
    note : str
        The mistake, or the fault of the form, in a few words; empty where there is none.
    details : mapping
        What the message of the mistake needed to know.
    messages : tuple of str
        What the student is told.
    points, worth : float
    group : str
        What identical answers have in common; empty where an answer has no fingerprint.
    version : str
        Of the contract.
    tries : int or None
        How many different answers were tried, as the notebook remembers.
    title : str
        Of the question.
    policy : str or None
        What its author chose for all who were asked a question that was mended.
    rubric : mapping or None
        What its lines are worth, where the author said so.
    before : Judged or None
        What the machine said, where a person decided.
    decided : mapping or None
        Who decided, when, and the decision.
    appeals : tuple of mappings
        As :meth:`coursework.grading.judging.ledger.Appealed.as_json` tells them.
    """

    outcome: str
    note: str = ""
    details: Mapping[str, Json] = field(default_factory=dict)
    messages: tuple[str, ...] = ()
    points: float = 0
    worth: float = 0
    group: str = ""
    version: str = ""
    tries: int | None = None
    title: str = ""
    policy: str | None = None
    rubric: Mapping[str, float] | None = None
    before: Judged | None = None
    decided: Mapping[str, str] | None = None
    appeals: tuple[Mapping[str, str], ...] = ()

    @classmethod
    def from_json(cls, found: object, where: str) -> Mark:
        """Read a mark.

        Raises
        ------
        Misread
        """
        about = Fields(found, where)
        return cls(
            about.get("outcome", text),
            about.get("note", text),
            about.maybe("details", by_name(anything)) or {},
            about.get("messages", many(text)),
            about.get("points", number),
            about.get("worth", number),
            about.maybe("group", text) or "",
            about.maybe("version", text) or "",
            about.maybe("tries", whole),
            about.maybe("title", text) or "",
            about.maybe("policy", text),
            about.maybe("rubric", by_name(number)),
            about.maybe("before", Judged.from_json),
            about.maybe("decided", by_name(text)),
            about.maybe("appeals", many(by_name(text))) or (),
        )

    def as_json(self) -> dict[str, Json]:
        """What :meth:`from_json` reads."""
        found: dict[str, Json] = {
            name: written(value)
            for name, value in vars(self).items()
            if name not in OF_SOME_MARKS or value
        }
        return found | ({"before": self.before.as_json()} if self.before else {})

    @property
    def judged(self) -> Mark:
        """The same as the machine said it, before people did."""
        alone = replace(self, before=None, decided=None, appeals=())
        return replace(alone, **vars(self.before)) if self.before else alone


#: The fields of a mark that are left out where there is nothing to say.
OF_SOME_MARKS = ("policy", "rubric", "before", "decided", "appeals")


@dataclass(frozen=True)
class Cell:
    """How a cell ended, with the error and its line if there was one."""

    outcome: str
    error: str | None = None
    line: int | None = None
    more: Mapping[str, Json] = field(default_factory=dict)

    @classmethod
    def from_json(cls, found: object, where: str) -> Cell:
        about = Fields(found, where)
        return cls(
            about.get("outcome", text),
            about.maybe("error", text),
            about.maybe("line", whole),
            about.beside(("outcome", "error", "line")),
        )

    def as_json(self) -> dict[str, Json]:
        found: dict[str, Json] = {"error": self.error, "line": self.line}
        return {
            "outcome": self.outcome,
            **{name: value for name, value in found.items() if value is not None},
        } | dict(self.more)


@dataclass(frozen=True)
class Isolation:
    """How the code of a notebook was kept apart.

    Attributes
    ----------
    layers : tuple of str
        Those in force.
    weak : bool
    namespaces_by : str or None
        What made the namespaces.
    not_stopped : tuple of str or None
        What student code could have done.
    given_up : str or None
        Why it could not be run.
    """

    layers: tuple[str, ...] = ()
    weak: bool = False
    namespaces_by: str | None = None
    not_stopped: tuple[str, ...] | None = None
    given_up: str | None = None

    @classmethod
    def from_json(cls, found: object, where: str = "isolation") -> Isolation:
        about = Fields(found, where)
        return cls(
            about.maybe("layers", many(text)) or (),
            about.maybe("weak", truth) or False,
            about.maybe("namespaces made by", text),
            about.maybe("not stopped", many(text)),
            about.maybe("given up", text),
        )

    def as_json(self) -> dict[str, Json]:
        found: dict[str, Json] = {
            "layers": written(self.layers),
            "namespaces made by": self.namespaces_by,
            "weak": self.weak,
            "not stopped": written(self.not_stopped),
            "given up": self.given_up,
        }
        return {name: value for name, value in found.items() if value is not None}


@dataclass(frozen=True)
class RunNotebook:
    """A notebook that was handed in, and what came of running it.

    Attributes
    ----------
    file, sha256 : str
    finished : bool
        Whether it came to its end.
    cells : tuple of Cell
    notes, tried : tuple of str
        What its student is told, and what it has no business with.
    beside : tuple of str
        Files that it was run with.
    unknown_questions : tuple of str
        What it checks, and there is not.
    runs, seed : int
    isolation : Isolation
    late : bool
    handed_in : str
    """

    file: str = ""
    sha256: str = ""
    finished: bool = True
    cells: tuple[Cell, ...] = ()
    notes: tuple[str, ...] = ()
    tried: tuple[str, ...] = ()
    beside: tuple[str, ...] = ()
    unknown_questions: tuple[str, ...] = ()
    runs: int = 1
    seed: int = 0
    isolation: Isolation = Isolation()
    late: bool = False
    handed_in: str | None = ""

    @classmethod
    def from_json(cls, found: object, where: str) -> RunNotebook:
        about = Fields(found, where)
        return cls(
            about.get("file", text),
            about.get("sha256", text),
            about.get("finished", truth),
            about.get("cells", many(Cell.from_json)),
            about.maybe("notes", many(text)) or (),
            about.maybe("tried", many(text)) or (),
            about.maybe("beside", many(text)) or (),
            about.maybe("unknown questions", many(text)) or (),
            about.maybe("runs", whole) or 0,
            about.maybe("seed", whole) or 0,
            about.get("isolation", Isolation.from_json),
            about.maybe("late", truth) or False,
            about.maybe("handed in", text),
        )

    def as_json(self) -> dict[str, Json]:
        found = {name.replace("_", " "): written(value) for name, value in vars(self).items()}
        return found | {
            "cells": [cell.as_json() for cell in self.cells],
            "isolation": self.isolation.as_json(),
        }


@dataclass(frozen=True)
class Superseded:
    """A notebook that does not count, since a newer one answers the same questions."""

    file: str
    sha256: str

    @classmethod
    def from_json(cls, found: object, where: str) -> Superseded:
        about = Fields(found, where)
        return cls(about.get("file", text), about.get("sha256", text))


@dataclass(frozen=True)
class Identity:
    """What a student is called, as far as it is known.

    Attributes
    ----------
    called : mapping of str to str
        The number in each system, ``"name"`` and ``"email"``.
    own : tuple of str or None
        The course's own words for the student, where there is a roster.
    """

    called: Mapping[str, str] = field(default_factory=dict)
    own: tuple[str, ...] | None = None

    @classmethod
    def from_json(cls, found: object, where: str) -> Identity:
        about = Fields(found, where)
        return cls(by_name(text)(about.beside(("own",)), where), about.maybe("own", many(text)))

    def as_json(self) -> dict[str, Json]:
        return {**self.called} | ({} if self.own is None else {"own": [*self.own]})


@dataclass(frozen=True)
class Record:
    """A student's work on an assignment.

    Attributes
    ----------
    student, assignment : str
    key : str
        What follows from everything that running the work depends on.
    identity : Identity
    says : tuple of str
        Whose the notebooks say to be.
    reply : str or None
        How the name of a page begins that goes back to the student.
    notebooks : tuple of RunNotebook
    superseded : tuple of Superseded
    software, limits : mapping
        What it was run with.
    finished : bool
        Whether all notebooks came to their end.
    answers : mapping of str to Answer
        By the names of questions and of siblings.
    remembered : mapping of str to Remembered
    marks : mapping of str to Mark
    cases : mapping of str to Case
    """

    student: str
    assignment: str
    key: str = ""
    identity: Identity = Identity()
    says: tuple[str, ...] = ()
    reply: str | None = None
    notebooks: tuple[RunNotebook, ...] = ()
    superseded: tuple[Superseded, ...] = ()
    software: Mapping[str, str] = field(default_factory=dict)
    limits: Mapping[str, Json] = field(default_factory=dict)
    finished: bool = True
    answers: Mapping[str, Answer] = field(default_factory=dict)
    remembered: Mapping[str, Remembered] = field(default_factory=dict)
    marks: Mapping[str, Mark] = field(default_factory=dict)
    cases: Mapping[str, Case] = field(default_factory=dict)

    @property
    def points(self) -> float:
        return round(sum(mark.points for mark in self.marks.values()), 4)

    @property
    def worth(self) -> float:
        return sum(mark.worth for mark in self.marks.values())

    @property
    def undecided(self) -> int:
        """How many answers wait for a person."""
        return sum(mark.outcome == "undecided" for mark in self.marks.values())

    @property
    def late(self) -> bool:
        return any(notebook.late for notebook in self.notebooks)

    def answer(self, question: str) -> Answer:
        return self.answers.get(question, MISSING)

    @classmethod
    def from_json(cls, found: object, where: str) -> Record:
        """Read a record.

        Raises
        ------
        Misread
        """
        about = Fields(found, where)
        if (format := about.get("format", whole)) != FORMAT:
            raise ValueError(
                f"{where} is of format {format}, and this coursework reads format {FORMAT}: "
                "another version made it. Install that one."
            )
        finished = about.maybe("finished", truth)
        return cls(
            about.get("student", text),
            about.get("assignment", text),
            about.maybe("key", text) or "",
            about.maybe("identity", Identity.from_json) or Identity(),
            about.maybe("says", many(text)) or (),
            about.maybe("reply", text),
            about.get("notebooks", many(RunNotebook.from_json)),
            about.maybe("superseded", many(Superseded.from_json)) or (),
            about.maybe("software", by_name(text)) or {},
            about.maybe("limits", by_name(anything)) or {},
            True if finished is None else finished,
            about.get("answers", by_name(Answer.from_json)),
            about.maybe("remembered", by_name(Remembered.from_json)) or {},
            about.maybe("marks", by_name(Mark.from_json)) or {},
            about.maybe("cases", by_name(Case.from_json)) or {},
        )

    def as_json(self) -> dict[str, Json]:
        """What :meth:`from_json` reads, and what its marks come to."""
        found: dict[str, Json] = {
            "format": FORMAT,
            "key": self.key,
            "student": self.student,
            "assignment": self.assignment,
            "identity": self.identity.as_json(),
            "says": written(self.says),
            "reply": self.reply,
            "notebooks": [notebook.as_json() for notebook in self.notebooks],
            "superseded": [{"file": one.file, "sha256": one.sha256} for one in self.superseded],
            "software": written(self.software),
            "limits": written(self.limits),
            "finished": self.finished,
            "answers": {name: answer.as_json() for name, answer in self.answers.items()},
            "remembered": {name: one.as_json() for name, one in self.remembered.items()},
            "marks": {name: mark.as_json() for name, mark in self.marks.items()},
            "cases": {name: case.as_json() for name, case in self.cases.items()},
        }
        return found | {"points": self.points, "worth": self.worth, "undecided": self.undecided}


#: What the sandbox says of a notebook, as JSON: a cluster sends it.
Result = dict[str, Json]


def read_result(result: Result, file: str) -> tuple[RunNotebook, dict[str, Answer]]:
    """Read what the sandbox says of a notebook: what came of running it, and the answers.

    Raises
    ------
    Misread
    """
    ran = RunNotebook.from_json({**result, "file": file, "sha256": ""}, file)
    return ran, Fields(result, file).get("answers", by_name(Answer.from_json))


#: An answer of which the sandbox says nothing.
MISSING = Answer("missing")
