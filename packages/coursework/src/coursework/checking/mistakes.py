"""The typical mistakes: their effect on a right answer, and their messages to the student.

When a question is sealed, we make every mistake that applies to it in the right answer, and each
result gets its own locker. A student's mistake is thus recognised by its fingerprint, and the
student's computer needs nothing of the right answer. Mistakes that lead to the same answer are
named together.

The messages are no secret; which of them a question knows, and for which answers, is.
"""

import hashlib
import itertools
import json
from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple

import sympy
from sympy.core.function import AppliedUndef

from .fields import Json
from .question import Question
from .sealing import MISTAKE

# Factors that are forgotten or inserted twice, by their names in lockers, with their words.
FACTORS = {
    "2": ("2", "twice"),
    "one half": ("1/2", "half"),
    "3": ("3", "three times"),
    "one third": ("1/3", "a third of"),
    "4": ("4", "four times"),
    "one quarter": ("1/4", "a quarter of"),
}
NUMBERS = (
    "zero one two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen "
    "sixteen seventeen eighteen nineteen twenty"
).split()
# General mistakes, which are left out if a more specific one leads to the same answer.
GENERAL = ("one wrong", "factor", "half", "double", "opposite")


class Mistake(NamedTuple):
    """A note for statistics, the details for the message, and the answer after the mistake."""

    note: str
    details: dict[str, Json]
    answer: object


def _only_the_transpose(question: Question) -> str:
    return "This is the transpose of what the question asks for."


MESSAGES: dict[str, Callable[..., str]] = {
    "transposed": _only_the_transpose,
    "in degrees": lambda question: "Your answer is in degrees. Give angles in radians.",
    "in radians": lambda question: "Your answer is in radians. Give it in degrees.",
    "sign of a symbol": lambda question, symbol: (
        f"The answer would be right if `{symbol}` had the other sign."
    ),
    "symbols interchanged": lambda question, first, second: (
        f"You swapped `{first}` and `{second}`."
    ),
    "opposite": lambda question: (
        "Every sign is wrong: this is the negative of what the question asks for."
    ),
    "reciprocal": lambda question: "This is the reciprocal of what the question asks for.",
    "factor": lambda question, factor: (
        f"This is {FACTORS[factor][1]} what the question asks for. Only this factor is wrong."
    ),
    "one wrong": lambda question, number: (
        f"One of the {NUMBERS[number]} is wrong. The others are right."
    ),
    "half": lambda question: "This is half of what the question asks for.",
    "double": lambda question: "This is twice what the question asks for.",
    "supplement": lambda question: (
        "You gave the supplementary angle: yours and the right one add up to half a turn."
    ),
    "complement": lambda question: (
        "You gave the complementary angle: yours and the right one add up to a quarter turn."
    ),
    "not turned": lambda question: (
        "These are the components along the frame in which you know the vector. Convert them to "
        "the other frame."
    ),
    "turned the wrong way": lambda question: (
        "You multiplied the components by the transpose of the right matrix."
    ),
    "authored": lambda question, text: text,
}
# Prefixes that are lost or misread, as powers of ten.
POWERS = (3, -3, 6, -6, 2, -2)
OF_MEASUREMENTS = {
    "power of ten": lambda question, power: (
        f"This is $10^{{{power}}}$ times what the question asks for. Did you lose a prefix, as in "
        "kN or mm?"
    ),
}
OF_ORDERS = {
    "turned round": lambda question: "This order is reversed: you put the last one first.",
    "two interchanged": lambda question: "You swapped two neighbours. The others are in order.",
}


def short_name(note: str, details: Mapping[str, Json]) -> bytes:
    """Return the name of a mistake in a locker, which depends only on its note and details.

    So sealed files remain valid when the catalogue grows.

    >>> short_name("sign of a symbol", {"symbol": "beta"}).hex()
    '72eac791'
    """
    text = json.dumps([note, details], ensure_ascii=False, sort_keys=True)
    return hashlib.sha256(text.encode("utf8")).digest()[:MISTAKE]


# --- the effect of each mistake on an answer ----------------------------------------------------


def as_matrix(answer: Any) -> Any:
    if hasattr(answer, "dcm"):
        raise TypeError(
            "The right answer is a reference frame. Assign its direction cosine matrix instead, "
            "so that we can derive mistakes from it. A student may still answer with the frame."
        )
    return sympy.Matrix(answer)


def of_symbols(question: Question, answer: Any) -> Iterator[Mistake]:
    """Iterate over a symbol's sign error, and two symbols interchanged."""
    free = sorted(unknowns_of(answer), key=str)
    for symbol in free:
        changed = answer.xreplace({symbol: -symbol})
        yield Mistake("sign of a symbol", {"symbol": symbol.name}, changed)
    for first, second in itertools.combinations(free, 2):
        changed = answer.xreplace({first: second, second: first})
        yield Mistake("symbols interchanged", {"first": first.name, "second": second.name}, changed)


def unknowns_of(answer: Any) -> set[Any]:
    """Return the symbols and functions of time in an expression or a matrix."""
    functions = set(answer.atoms(AppliedUndef))
    times = {argument for function in functions for argument in function.args}
    return functions | (set(answer.free_symbols) - times)


def of_matrix(question: Question, answer: Any, turns: Any, turned: Any) -> Iterator[Mistake]:
    answer = as_matrix(answer)
    if answer.rows == answer.cols:
        yield Mistake("transposed", {}, answer.T)
    yield Mistake("opposite", {}, -answer)
    yield from of_factors(answer)
    yield from of_symbols(question, answer)


def of_parts(question: Question, answer: Any, turns: Any, turned: Any) -> Iterator[Mistake]:
    """Iterate over lists of words or Booleans with one wrong part."""
    answer = list(answer)
    if not 3 <= len(answer) < len(NUMBERS):
        return
    for place, right in enumerate(answer):
        for option in question.options or [True, False]:
            if option != right:
                yield Mistake(
                    "one wrong",
                    {"number": len(answer)},
                    answer[:place] + [option] + answer[place + 1 :],
                )


def of_order(question: Question, answer: Any, turns: Any, turned: Any) -> Iterator[Mistake]:
    """Iterate over the reversed order, and two neighbours interchanged."""
    answer = list(answer)
    yield Mistake("turned round", {}, answer[::-1])
    if len(answer) > 3:
        for place in range(len(answer) - 1):
            first, second = answer[place : place + 2]
            yield Mistake(
                "two interchanged", {}, [*answer[:place], second, first, *answer[place + 2 :]]
            )


def of_measurement(question: Question, answer: Any, turns: Any, turned: Any) -> Iterator[Mistake]:
    """Iterate over mistakes in a number, with the unit unchanged, and a lost prefix."""
    number, unit = answer
    for mistake in of_expression(question, number, turns, turned):
        if mistake.note != "reciprocal":
            yield mistake._replace(answer=(mistake.answer, unit))
    for power in POWERS:
        yield Mistake(
            "power of ten",
            {"power": power},
            (sympy.sympify(number) * sympy.Integer(10) ** power, unit),
        )


def of_factors(answer: Any) -> Iterator[Mistake]:
    """Iterate over the answer times a small factor."""
    for name, (factor, _) in FACTORS.items():
        yield Mistake("factor", {"factor": name}, sympy.Rational(factor) * answer)


def of_vector(question: Question, answer: Any, turns: Any, turned: Any) -> Iterator[Mistake]:
    if hasattr(answer, "to_matrix"):
        # The author of a SymPy vector has written its components in `turned`, or names mistakes.
        return
    answer = as_matrix(answer)
    yield Mistake("opposite", {}, -answer)
    if turned:
        matrix, components = (sympy.Matrix(part) for part in turned)
        yield Mistake("turned the wrong way", {}, matrix.T * components)
        yield Mistake("not turned", {}, components)
    if not question.unit_vector:
        yield from of_factors(answer)
    yield from of_symbols(question, answer)


def of_expression(question: Question, answer: Any, turns: Any, turned: Any) -> Iterator[Mistake]:
    answer = sympy.sympify(answer)
    yield Mistake("opposite", {}, -answer)
    if question.quantity == "angle":
        yield Mistake("in degrees", {}, answer * 180 / sympy.pi)
        yield Mistake("supplement", {}, sympy.pi - answer)
        yield Mistake("complement", {}, sympy.pi / 2 - answer)
    elif question.quantity == "angle in degrees":
        yield Mistake("in radians", {}, answer * sympy.pi / 180)
        yield Mistake("supplement", {}, 180 - answer)
        yield Mistake("complement", {}, 90 - answer)
    elif answer != 0:
        yield Mistake("reciprocal", {}, 1 / answer)
    yield Mistake("half", {}, answer / 2)
    yield Mistake("double", {}, 2 * answer)
    if question.quantity is None:
        yield from of_factors(answer)
    yield from of_symbols(question, answer)
