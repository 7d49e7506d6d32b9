"""The particular properties of one kind of question."""

from collections.abc import Callable
from typing import Any, NamedTuple


class Kind(NamedTuple):
    """What is particular to one kind of question; each function is given a `Question`.

    Attributes
    ----------
    entries : function (question, value) -> list of int
        For answers that are numbers: the nodes of an answer's entries, in order. Raises a fault of
        the form.
    text : function (question, plain) -> str
        For answers in words: the one way of writing what is meant.
    unique : function (question, numbers) -> list
        Turns the many right ways of stating an answer into one: a quaternion and its negative, say.
    fault : function (question, numbers) -> Fault or None
        What is wrong with the form of the numbers of an answer.
    parts : int
        How many numbers, each off by the tolerance, may make up one number of ``unique``.
    wrong : str
        What a wrong answer has right.
    begin : str
        Where to begin: the first step of the ladder of hints.
    needs : tuple of str
        Arguments that an author must give.
    arguments : tuple of str
        Arguments that only this kind has; they become public, as ``question.arguments``.
    either_sign : bool
        Whether an answer and its opposite are both right.
    mistakes : function (question, answer, turns, turned) -> iterable of Mistake
        The typical mistakes, carried out on the right answer.
    messages : dict
        What a student is told of a mistake, by its note: functions of the question and of the
        mistake's details.
    details : dict
        What the details of these mistakes may be, by name: tuples of values, so that a mistake has
        a number.
    slips : dict
        Common slips that go with another mistake, by name: what is said of each, and a function of
        the question and the numbers of an answer that undoes it, or gives ``None`` where it makes
        no sense.
    build : function (turns) -> matrix
        The answer that successive turns lead to, where ``turns`` may be given.
    forms : function (question, answer) -> list of (str, answer)
        Further ways of writing a right answer, to try a question with.
    picture : function (question, numbers) -> str
        The picture of an answer of numbers, as HTML.
    public : function (answer) -> dict
        What of the right answer a student's computer must know, and may.
    by_a_person : bool
        Whether a person reads the answers; then nothing is sealed, and no program says what is
        right.
    another : function (question, answer) -> answer
        An answer of the right form that is another one.
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
