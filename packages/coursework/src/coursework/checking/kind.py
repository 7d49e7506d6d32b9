"""The particular properties of one kind of question."""

from collections.abc import Callable
from typing import Any, NamedTuple


class Kind(NamedTuple):
    """The particular properties of one kind of question; each function receives a `Question`.

    Attributes
    ----------
    entries : function (question, value) -> list of int
        For answers that are numbers: returns the nodes of an answer's entries, in order. Raises a
        fault of the form.
    text : function (question, plain) -> str
        For answers in words: returns the one spelling of what is meant. ``plain`` is the answer as
        plain data. ``word(plain, "One word, in quotation marks")`` from
        `coursework.checking.kinds` returns its string, or raises a fault with these words.
    unique : function (question, numbers) -> list
        Reduces equally right values, such as a quaternion and its negative, to one of them.
    fault : function (question, numbers) -> Fault or None
        Returns the fault in the form of an answer's numbers.
    parts : int
        How many numbers, each off by the tolerance, may make up one number of ``unique``.
    wrong : str
        The message about what is right in a wrong answer.
    begin : str
        Where to begin: the first step of the ladder of hints.
    needs : tuple of str
        Arguments that an author must give.
    arguments : tuple of str
        Arguments that only this kind has; they become public, as ``question.arguments``.
    either_sign : bool
        Whether an answer and its opposite are both right.
    mistakes : function (question, answer, turns, turned) -> iterable of Mistake
        Makes the typical mistakes in the right answer.
    messages : dict
        The messages about mistakes, by their notes: functions of the question and of the mistake's
        details.
    details : dict
        The possible values of these mistakes' details, by name, as tuples, which number the
        mistakes.
    slips : dict
        Common slips that accompany another mistake, by name. Each has its message, and a function
        of the question and an answer's numbers that undoes it, or returns ``None`` where that is
        impossible.
    build : function (turns) -> matrix
        Returns the answer that successive rotations lead to, if an author may give ``turns``.
    forms : function (question, answer) -> list of (str, answer)
        Returns further forms of a right answer, for testing a question.
    picture : function (question, numbers) -> str
        Returns the picture of an answer of numbers, as HTML.
    public : function (answer) -> dict
        Returns what a student's computer must, and may, know about the right answer.
    by_a_person : bool
        Whether a person marks the answers. Then nothing is sealed, and no program decides what is
        right.
    another : function (question, answer) -> answer
        Returns a different answer of the right form, to test a question with. A plug-in's kinds
        with answers in words need it.
    """

    entries: Callable[..., Any] | None = None
    text: Callable[..., Any] | None = None
    unique: Callable[..., Any] | None = None
    fault: Callable[..., Any] | None = None
    parts: int = 1
    wrong: str = "Right kind of answer, wrong value."
    begin: str = ""
    needs: tuple[str, ...] = ()
    arguments: tuple[str, ...] = ()
    either_sign: bool = False
    mistakes: Callable[..., Any] | None = None
    messages: dict[str, Callable[..., str]] = {}
    details: dict[str, Any] = {}
    slips: dict[str, tuple[str, Callable[..., Any]]] = {}
    build: Callable[..., Any] | None = None
    forms: Callable[..., Any] | None = None
    another: Callable[..., Any] | None = None
    picture: Callable[..., str] | None = None
    public: Callable[..., Any] | None = None
    by_a_person: bool = False
