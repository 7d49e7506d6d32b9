"""What a course brings of its own: kinds of questions, and its sealed questions.

A plug-in is a module that an installed distribution names in its entry points:

.. code-block:: toml

    [project.entry-points."coursework.plugins"]
    orientation = "orientation_course"

Its folder ``sealed``, if it has one, holds sealed questions. These names in it are read, each if it is there:

``KINDS``
    A :class:`Kind` for each further kind of question, by its name.
``DEEDS``
    What the class did, for the instructor's report, by the note of a mistake: ``"conjugate": "gave the conjugate"``.
``PACKAGES``
    Names of the packages that the course's notebooks import, so that grading has them at hand.
``FORMAT_3``
    Of a course that handed out sealed files of format 3 and has kinds of its own: by the name of the kind, the
    notes of its mistakes of that time in their order, each with what its details could be. Without it, the order
    of today counts.
"""

import functools
import importlib.util
import inspect
from collections.abc import Callable, Iterable, Mapping, Sequence
from importlib import metadata, resources
from importlib.resources.abc import Traversable
from types import ModuleType
from typing import Any, NamedTuple

from .question import Question

GROUP = "coursework.plugins"


class Kind(NamedTuple):
    """What is particular to one kind of question; each function is given a :class:`Question`.

    Attributes
    ----------
    entries : function (question, value) -> list of int
        For answers that are numbers: the nodes of an answer's entries, in order. Raises a fault of the form.
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
        What a student is told of a mistake, by its note: functions of the question and of the mistake's details.
    details : dict
        What the details of these mistakes may be, by name: tuples of values, so that a mistake has a number.
    slips : dict
        Common slips that go with another mistake, by name: what is said of each, and a function of the question and
        the numbers of an answer that undoes it, or gives ``None`` where it makes no sense.
    build : function (turns) -> matrix
        The answer that successive turns lead to, where ``turns`` may be given.
    forms : function (question, answer) -> list of (str, answer)
        Further ways of writing a right answer, to try a question with.
    public : function (answer) -> dict
        What of the right answer a student's computer must know, and may.
    by_a_person : bool
        Whether a person reads the answers; then nothing is sealed, and no program says what is right.
    another : function (question, answer) -> answer
        An answer of the right form that is another one.
    """

    entries: Callable[..., Any] | None = None
    text: Callable[..., Any] | None = None
    unique: Callable[..., Any] | None = None
    fault: Callable[..., Any] | None = None
    parts: int = 1
    wrong: str = "The form is right; the value is not."
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
    public: Callable[..., Any] | None = None
    by_a_person: bool = False


@functools.cache
def plugins() -> list[ModuleType]:
    """The plug-ins of all installed distributions.

    Raises
    ------
    RuntimeError
        One of them cannot be imported; the message says which.
    """
    found = []
    for entry in sorted(metadata.entry_points(group=GROUP)):
        try:
            found.append(entry.load())
        except Exception as error:
            brought = f", which {entry.dist.name} {entry.dist.version} brings for coursework," if entry.dist else ""
            raise RuntimeError(
                f"The plug-in {entry.name!r} ({entry.value}){brought} cannot be loaded: {type(error).__name__}: {error}"
            ) from error
    return found


@functools.cache
def kinds() -> dict[str, Kind]:
    """All kinds of questions, by name."""
    from .kinds import KINDS

    found = dict(KINDS)
    for plugin in plugins():
        for name, kind in getattr(plugin, "KINDS", {}).items():
            if name in found:
                raise RuntimeError(f"{plugin.__name__} brings a kind of question {name!r}; there is one already.")
            found[name] = kind
    return found


def catalogue_of_format_3(kind: str) -> Sequence[tuple[str, Mapping[str, Any]]]:
    """The mistakes that a plug-in's kind had in sealed files of format 3, in their order, with their details."""
    for plugin in plugins():
        if kind in getattr(plugin, "FORMAT_3", {}):
            frozen: Sequence[tuple[str, Mapping[str, Any]]] = plugin.FORMAT_3[kind]
            return frozen
    messages, details = kinds()[kind].messages, kinds()[kind].details
    return [
        (note, {name: details.get(name, ()) for name in list(inspect.signature(words).parameters)[1:]})
        for note, words in messages.items()
    ]


def kind_of_values(question: Question) -> Kind:
    """The kind of what is compared: for a function, of its results."""
    return kinds()[question.kind_of_values]


def packages() -> list[str]:
    """Names of the packages that the notebooks of the installed courses import, and of the plug-ins."""
    found = []
    for plugin in plugins():
        found += [plugin.__name__.partition(".")[0], *getattr(plugin, "PACKAGES", ())]
    return list(dict.fromkeys(found))


def folders_of(names: Iterable[str]) -> list[str]:
    """The folders of those packages that are installed."""
    specs = [importlib.util.find_spec(name) for name in names]
    return [folder for spec in specs if spec for folder in spec.submodule_search_locations or ()]


def sealed_folders() -> list[Traversable]:
    """The folders of sealed questions that plug-ins bring."""
    folders = [resources.files(plugin) / "sealed" for plugin in plugins()]
    return [folder for folder in folders if folder.is_dir()]
