"""The catalogue: every mistake that a question knows, by its short name, with its message."""

import functools
import inspect
import itertools
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from .fields import Json
from .mistakes import FACTORS, MESSAGES, NUMBERS, Mistake, short_name
from .plugins import kind_of_values, kinds
from .question import Note, Question


def message(question: Question, note: str, details: Mapping[str, Json]) -> str:
    """Return the message to a student about a mistake."""
    return (kind_of_values(question).messages.get(note) or MESSAGES[note])(question, **details)


def message_of_all(question: Question, notes: Sequence[Note]) -> str:
    """Return the message about a wrong answer to which each of these mistakes leads.

    The author's words suit the question better than those of the catalogue. Otherwise the answer
    does not show which mistake it was, and there may be more than the two that a locker holds.
    """
    authored = [note for note in notes if note.note == "authored"]
    texts = [message(question, note, details) for note, details in authored or notes]
    several = "More than one mistake leads to this answer. For example: " if len(texts) > 1 else ""
    return several + " Or: ".join(texts)


def by_short_name(question: Question) -> dict[bytes, Note]:
    """Return every mistake with a message for a question, with its details, by its short name.

    It is the same for all questions of a kind, so it reveals nothing.

    Raises
    ------
    RuntimeError
        Two mistakes have the same short name: one of them needs another note.
    """
    return _by_short_name(question.kind_of_values, tuple(sorted(question.symbols)))


@functools.lru_cache(64)
def _by_short_name(name: str, symbols: tuple[str, ...]) -> dict[bytes, Note]:
    kind = kinds()[name]
    details: dict[str, Iterable[Any]] = {
        "symbol": symbols,
        "first": symbols,
        "second": symbols,
        "factor": tuple(FACTORS),
        "number": range(len(NUMBERS)),
    }
    by_name: dict[bytes, Note] = {}
    for messages, own in ((MESSAGES, {}), (kind.messages, kind.details)):
        for note, words in messages.items():
            needed = list(inspect.signature(words).parameters)[1:]
            if note != "authored":
                for values in itertools.product(
                    *((own or details).get(name, ()) for name in needed)
                ):
                    known = Note(note, dict(zip(needed, values, strict=True)))
                    if by_name.setdefault(short_name(*known), known) != known:
                        raise RuntimeError(
                            f"{known} and {by_name[short_name(*known)]} have the same short "
                            "name. Rename a note."
                        )
    return by_name


def mistakes(
    question: Question,
    answer: object,
    turns: Iterable[tuple[Any, Any]] = (),
    turned: tuple[Any, Any] | None = None,
) -> list[Mistake]:
    """Return every mistake of the catalogue that applies to an answer, as `Mistake`.

    Parameters
    ----------
    question : Question
    answer : SymPy object, nested list or number
        The right answer, as its author wrote it.
    turns : list of tuples (axis, angle)
        The successive rotations, each about an axis of the frame that the earlier ones have
        reached; the answer is their direction cosine matrix or quaternion.
    turned : tuple (matrix, components)
        For components that a matrix rotated: the matrix and the components before it.
    """
    find = kinds()[question.kind].mistakes
    return list(find(question, answer, list(turns), turned)) if find else []
