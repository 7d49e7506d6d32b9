"""The record of one student's work on one assignment, as it is stored: what was
handed in, asked, answered and marked.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from ..checking.fields import Fields, Json, by_name
from ..checking.plain import Plain
from .reading import AsJson


@dataclass(frozen=True)
class Answer(AsJson):
    """What the sandbox says of an answer.

    Attributes
    ----------
    outcome : str
        ``"recorded"``, ``"unreadable"``, ``"missing"``, ``"on paper"``, or how reading it was
        stopped.
    plain : Plain or None
    why : str or None
        It is unreadable; or whose paper it is on.
    error : str or None
        With which reading it was stopped.
    source : str or None
        ``"check"`` or ``"variable"``.
    cell : int or None
        The number of the cell that gave it.
    secret : mapping or None
        What a function gave for arguments that no student knows: ``"plain"`` or ``"unreadable"``,
        and the digest of its ``"calls"``.
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
        """Whether what was answered is the blank that the exercise came with."""
        return (
            self.outcome == "recorded"
            and self.plain is not None
            and self.plain["value"] == ["blank"]
        )


@dataclass(frozen=True)
class Remembered(AsJson):
    """What the outputs of a notebook remember of the way to an answer.

    Attributes
    ----------
    tries : int
        How many different answers were tried.
    tried : tuple of str
        A few digits of each that was wrong.
    help : str
        The help that was had before it was right, a key of `coursework.checking.reply.HELP`;
        or nothing.
    """

    tries: int = 0
    tried: tuple[str, ...] = ()
    help: str = ""


@dataclass(frozen=True)
class Place(AsJson):
    """A variant of a question: its name, the version of the question in it that was run, and the
    one by which it was judged last.
    """

    variant: str
    contract: str
    judged: str = ""


@dataclass(frozen=True)
class Case(AsJson):
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
    others : tuple of Place
        The variants that the student would have had by the source as it stood at other times.
    """

    question: str
    own: Place
    siblings: Mapping[str, Place] = field(default_factory=dict)
    rule: str = ""
    edition: str = ""
    others: tuple[Place, ...] = ()


@dataclass(frozen=True)
class Judged(AsJson):
    """What the machine said of an answer, in place of which a person decided."""

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
    rubric : mapping
        What its lines are worth, where the author said so.
    before : Judged or None
        What the machine said, where a person decided.
    decided : mapping or None
        Who decided, when, and the decision.
    appeals : tuple of mappings
        As `coursework.grading.judging.journal.Appealed.as_json` tells them.
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
        """The same as the machine said it, before people did."""
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
    """How the code of a notebook was kept apart.

    Attributes
    ----------
    layers : tuple of str
        Those in force.
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
    """A notebook that was handed in, and what came of running it.

    Attributes
    ----------
    file, sha256 : str
    finished : bool
        Whether it came to its end.
    cells : tuple of Cell
    notes : tuple of str
        What its student is told.
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
    beside: tuple[str, ...] = ()
    unknown_questions: tuple[str, ...] = ()
    runs: int = 1
    seed: int = 0
    isolation: Isolation = Isolation()
    late: bool = False
    handed_in: str | None = ""


@dataclass(frozen=True)
class Superseded(AsJson):
    """A notebook that does not count, since another one answers the same questions.

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


@dataclass(frozen=True)
class Record(AsJson):
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
