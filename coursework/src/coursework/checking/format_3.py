"""Sealed files of format 3, as they were made until November 2026:
read for ever, and never made again.

A locker held the place of a mistake in the catalogue of that time. That order is kept here, and for
the kinds of a plug-in in its ``FORMAT_3``; what is added to the catalogue is not added here.
"""

import itertools
from collections.abc import Mapping
from typing import Any

from .plugins import catalogue_of_format_3
from .question import Note, Question

#: Stands for the symbols of a question, in alphabetical order.
SYMBOLS = "the symbols of the question"
FACTORS = ("2", "one half", "3", "one third", "4", "one quarter")
#: Each note, and what its details could be.
CATALOGUE: tuple[tuple[str, Mapping[str, Any]], ...] = (
    ("transposed", {}),
    ("in degrees", {}),
    ("in radians", {}),
    ("sign of a symbol", {"symbol": SYMBOLS}),
    ("symbols interchanged", {"first": SYMBOLS, "second": SYMBOLS}),
    ("opposite", {}),
    ("reciprocal", {}),
    ("factor", {"factor": FACTORS}),
    ("one wrong", {"number": tuple(range(21))}),
    ("half", {}),
    ("double", {}),
    ("supplement", {}),
    ("complement", {}),
    ("not turned", {}),
    ("turned the wrong way", {}),
)
#: What followed for some kinds that no course owns.
OF_KINDS: Mapping[str, tuple[tuple[str, Mapping[str, Any]], ...]] = {
    "measurement": (("power of ten", {"power": (3, -3, 6, -6, 2, -2)}),),
    "order": (("turned round", {}), ("two interchanged", {})),
}
NONE = 0xFFFF


def mistakes_in(inside: bytes, question: Question) -> list[Note]:
    """The mistakes, each with its details, whose places stand in a locker without a page."""
    places = [int.from_bytes(inside[start : start + 2]) for start in (0, 2)]
    known = numbered(question)
    return [known[place] for place in places if place != NONE]


def numbered(question: Question) -> list[Note]:
    """Every mistake of the catalogue of that time for a question,
    with its details, in its order.
    """
    kind = question.kind_of_values
    symbols = sorted(question.symbols)
    found = []
    for note, details in (*CATALOGUE, *(OF_KINDS.get(kind) or catalogue_of_format_3(kind))):
        choices = (symbols if values == SYMBOLS else values for values in details.values())
        found += [Note(note, dict(zip(details, chosen))) for chosen in itertools.product(*choices)]
    return found
