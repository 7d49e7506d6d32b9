"""Count the answers that a question allows, if a script could try them all.

A check that needs no server lets a program try answers, each in about a hundredth of a second. If
an answer is one of a few words, an order, or a few small whole numbers, trying all of them finds
it. We count only those, which understates what a script can do: most answers are formulas, and a
script that knows the subject's formulas finds many of those, too.
"""

import math
from collections.abc import Mapping
from typing import NamedTuple

from ..checking.kinds import Undecidable
from ..checking.plugins import kinds, plugins
from ..checking.reading import canonical, read
from .author import AuthoredQuestion
from .source import CHAPTERS, Source

#: Answers with more possibilities than this are not closed, since trying them takes more than a
#: quarter of an hour.
MOST = 2**16


class Asked(NamedTuple):
    """A question: its points, variants and possible answers, and why it has only one variant.

    `alike` are the author's replies to mistakes that give the same answer.
    """

    worth: float
    variants: int
    possible: int | None
    fixed: str
    alike: list[tuple[str, ...]]


def possible_answers(question: AuthoredQuestion) -> int | None:
    """Return how many answers a question allows at most; ``None`` if they are not closed.

    Answers of whole numbers only count as closed, where each may be anything up to the largest.
    """
    public = question.public
    if public.exam or kinds()[public.kind].by_a_person:
        return None
    options, length = len(public.options), public.length or 0
    of_plugins = {
        kind: count for plugin in plugins() for kind, count in getattr(plugin, "CLOSED", {}).items()
    }
    by_kind = {
        "choice": options,
        "words": options**length,
        "truth values": 2**length,
        "order": math.factorial(options),
        **of_plugins,
    }
    count = by_kind.get(public.kind)
    if public.kind in ("expression", "vector", "matrix") and not public.symbols:
        count = _whole_numbers(question)
    return count if count and count <= MOST else None


def _whole_numbers(question: AuthoredQuestion) -> int | None:
    try:
        entries = [
            float(entry)
            for entry in canonical(question.public, read(question.public, question.plain))
        ]
    except (Undecidable, TypeError):
        return None
    if any(abs(entry - round(entry)) > 1e-9 for entry in entries):
        return None
    return int((2 * max(1, *(abs(round(entry)) for entry in entries)) + 1) ** len(entries))


def asked_in(source: Source) -> dict[str, Asked]:
    """Return what is to be counted of each question of a notebook."""
    return {
        name: Asked(
            question.worth,
            question.public.variants,
            possible_answers(question),
            question.fixed,
            _alike(question),
        )
        for name, question in source.questions.items()
    }


def _alike(question: AuthoredQuestion) -> list[tuple[str, ...]]:
    replies = dict.fromkeys(
        tuple(str(details["text"]) for note, details in answer.notes if note == "authored")
        for entry in question.entries.values()
        for answer in entry.answers
    )
    return [texts for texts in replies if len(texts) > 1]


def counted(asked: Mapping[str, Asked]) -> list[str]:
    """Report the points that a script can find, and those that a copy earns.

    Returns
    -------
    list of str
        A line for each question with a closed answer that is worth more than a point, and for
        mistakes that give the same answer, the points behind closed answers, and the points with
        one answer for everybody, with the reasons.
    """
    exercises = {
        name: question for name, question in asked.items() if name.partition("/")[0] != CHAPTERS
    }
    lines = [
        f"{name}, {question.worth:g} points: it has only {question.possible} possible answers, so "
        "a script can try them all. Ask for several parts in one answer or for a function, or set "
        "exam=True."
        for name, question in asked.items()
        if question.possible and question.worth > 1
    ]
    lines += [
        f"{name}: these mistakes give the same answer, so students who make either get the first "
        f"reply. Write one reply for them, or choose other numbers: {' / '.join(texts)}"
        for name, question in asked.items()
        for texts in question.alike
    ]
    closed = sum(question.worth for question in asked.values() if question.possible)
    points = sum(question.worth for question in asked.values())
    lines.append(
        f"{closed:g} of {points:g} points are for answers that a script can find within {MOST:,} "
        "tries. A script that tries formulas can find more."
    )
    if exercises:
        fixed = {name: question for name, question in exercises.items() if question.variants == 1}
        lines.append(
            f"{sum(question.worth for question in fixed.values()):g} of "
            f"{sum(question.worth for question in exercises.values()):g} points in exercise "
            "notebooks are for questions with one answer for everybody."
        )
        lines += [
            f"  {name} ({question.worth:g}): "
            + (question.fixed or "vary it, or give the reason with `fixed`.")
            for name, question in fixed.items()
        ]
    return lines
