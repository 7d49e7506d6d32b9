"""The stored record of one student's work on one assignment.

It contains what was handed in, asked, answered and marked.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from ..checking.fields import Fields, Json, by_name
from ..checking.plain import Plain
from .reading import AsJson


@dataclass(frozen=True)
class Answer(AsJson):
    """The sandbox's result for an answer.

    Attributes
    ----------
    outcome : str
        ``"recorded"``, ``"unreadable"``, ``"missing"``, ``"on paper"``, or how reading it was
        stopped.
    plain : Plain or None
    why : str or None
        Why it is unreadable; or whose paper it is on.
    error : str or None
        The error that stopped reading it.
    source : str or None
        ``"check"`` or ``"variable"``.
    cell : int or None
        The number of the cell that gave it.
    secret : mapping or None
        What a function returned for arguments that no student knows: ``"plain"`` or
        ``"unreadable"``, and the digest of its ``"calls"``.
    """

    outcome: str
    plain: Plain | None = None
    why: str | None = None
    error: str | None = None
    source: str | None = field(default=None, metadata={"key": "from"})
    cell: int | None = None
    secret: Mapping[str, Json] | None = None

    @property
    def is_blank(self) -> bool:
        """Whether the answer is still the blank that the exercise came with."""
        return (
            self.outcome == "recorded"
            and self.plain is not None
            and self.plain["value"] == ["blank"]
        )


@dataclass(frozen=True)
class Remembered(AsJson):
    """The attempts at a question that a notebook's outputs remember.

    Attributes
    ----------
    tries : int
        The number of different answers that the student tried.
    help : str
        The help that the student had before the right answer, a key of
        `coursework.checking.reply.HELP`; or empty.
    """

    tries: int = 0
    help: str = ""


@dataclass(frozen=True)
class Place(AsJson):
    """A variant of a question, with the versions of the question that ran and last judged it."""

    variant: str
    contract: str
    judged: str = ""


@dataclass(frozen=True)
class Case(AsJson):
    """The question that a student was asked.

    Attributes
    ----------
    question : str
    own : Place
    siblings : mapping of str to Place
        The other variants that can make up for help, by the names of the siblings.
    rule : str
        How the variant was chosen: ``"number 3 of 8"``, ``"by name, of 8"``, or empty if there is
        only one.
    edition : str
        The edition of the course; another edition draws the variants anew.
    others : tuple of Place
        The variants that the student would have had by the source at other times.
    """

    question: str
    own: Place
    siblings: Mapping[str, Place] = field(default_factory=dict)
    rule: str = ""
    edition: str = ""
    others: tuple[Place, ...] = ()


@dataclass(frozen=True)
class Judged(AsJson):
    """The automatic mark that a person's decision replaced."""

    outcome: str
    note: str
    points: float
    messages: tuple[str, ...]


@dataclass(frozen=True)
class Mark(AsJson):
    """The mark of an answer.

    Attributes
    ----------
    outcome : str
        ``"correct"``, ``"wrong"``, ``"invalid"``, ``"undecided"``, ``"not attempted"`` or
        ``"decided"``.
    note : str
        The mistake, or what is wrong with the form, in a few words; empty if there is none.
    details : mapping
        The data for the message about the mistake.
    messages : tuple of str
        The messages to the student.
    points, worth : float
    group : str
        The same for identical answers; empty if an answer has no fingerprint.
    version : str
        The version of the contract.
    tries : int or None
        The number of different answers that the student tried, as the notebook remembers.
    title : str
        The title of the question.
    policy : str or None
        The author's policy for everybody who was asked a question that was corrected.
    rubric : mapping
        The worth of its lines, where the author gave one.
    before : Judged or None
        The automatic mark, if a person decided.
    decided : mapping or None
        Who decided, when, and the decision.
    appeals : tuple of mappings
        The appeals, as `coursework.grading.judging.journal.Appealed.as_json` returns them.
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
    rubric: Mapping[str, float] = field(default_factory=dict)
    before: Judged | None = None
    decided: Mapping[str, str] | None = None
    appeals: tuple[Mapping[str, str], ...] = ()

    @property
    def judged(self) -> Mark:
        """The automatic mark, without people's decisions."""
        alone = replace(self, before=None, decided=None, appeals=())
        return replace(alone, **vars(self.before)) if self.before else alone


@dataclass(frozen=True)
class Cell(AsJson):
    """How a cell ended, with the error and its line if there was one."""

    outcome: str
    error: str | None = None
    line: int | None = None


@dataclass(frozen=True)
class Isolation(AsJson):
    """How the code of a notebook was isolated.

    Attributes
    ----------
    layers : tuple of str
        The layers in force.
    weak : bool
    not_stopped : tuple of str or None
        What student code could have done.
    given_up : str or None
        Why it could not be run.
    """

    layers: tuple[str, ...] = ()
    weak: bool = False
    not_stopped: tuple[str, ...] | None = None
    given_up: str | None = None


@dataclass(frozen=True)
class RunNotebook(AsJson):
    """A submitted notebook, with the results of running it.

    Attributes
    ----------
    file, sha256 : str
    finished : bool
        Whether it ran to its end.
    cells : tuple of Cell
    notes : tuple of str
        Notes for its student.
    beside : tuple of str
        The files that it was run with.
    unknown_questions : tuple of str
        Names in its checks that are not questions.
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
    beside: tuple[str, ...] = ()
    unknown_questions: tuple[str, ...] = ()
    runs: int = 1
    seed: int = 0
    isolation: Isolation = Isolation()
    late: bool = False
    handed_in: str | None = ""


@dataclass(frozen=True)
class Superseded(AsJson):
    """A notebook that does not count, since another answers the same questions.

    Attributes
    ----------
    file, sha256 : str
    why : str
    """

    file: str
    sha256: str
    why: str = ""


@dataclass(frozen=True)
class Identity(AsJson):
    """The known names and IDs of a student.

    Attributes
    ----------
    called : mapping of str to str
        The ID in each system, ``"name"`` and ``"email"``.
    own : tuple of str or None
        The course's own IDs of the student, if there is a roster.
    """

    called: Mapping[str, str] = field(default_factory=dict)
    own: tuple[str, ...] | None = None


@dataclass(frozen=True)
class Record(AsJson):
    """A student's work on an assignment.

    Attributes
    ----------
    student, assignment : str
    key : str
        A digest of everything that running the work depends on.
    identity : Identity
    says : tuple of str
        The students that the notebooks name as their own.
    reply : str or None
        The beginning of the name of the page for the student.
    notebooks : tuple of RunNotebook
    superseded : tuple of Superseded
    software, limits : mapping
        The software and the limits that it was run with.
    finished : bool
        Whether all notebooks ran to their end.
    answers : mapping of str to Answer
        The answers, by the names of questions and siblings.
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
        """The number of answers that wait for a person."""
        return sum(mark.outcome == "undecided" for mark in self.marks.values())

    @property
    def late(self) -> bool:
        return any(notebook.late for notebook in self.notebooks)

    def answer(self, question: str) -> Answer:
        return self.answers.get(question, MISSING)


#: The sandbox's result for a notebook, as JSON, so that a cluster can send it.
Result = dict[str, Json]


def read_result(result: Result, file: str) -> tuple[RunNotebook, dict[str, Answer]]:
    """Read the sandbox's result for a notebook: how it ran, and its answers.

    Raises
    ------
    Misread
    """
    ran = RunNotebook.from_json({**result, "file": file, "sha256": ""}, file)
    return ran, Fields(result, file).get("answers", by_name(Answer.from_json))


#: An answer for which the sandbox has no result.
MISSING = Answer("missing")
