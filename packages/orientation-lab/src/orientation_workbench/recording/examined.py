"""The bench's findings, and their text form."""

from __future__ import annotations

from textwrap import wrap
from typing import TYPE_CHECKING, NamedTuple, TypedDict

if TYPE_CHECKING:
    from .judged import Judgement
    from .motion import Reading, Stretch
    from .table import Array

#: The status lights.
GREEN, YELLOW, RED, UNKNOWN = "as it should be", "look", "wrong", "cannot tell"
# The width of a line of the text report.
WIDTH = 76
LIGHTS = {"as it should be": "ok  ", "look": "LOOK", "wrong": "RED ", "cannot tell": "?   "}
#: The findings as numbers, which correct a recording of the same instrument.
Facts = TypedDict(
    "Facts",
    {
        "unit of the gyroscope": float,
        "axes of the gyroscope": "Array",
        "scale of the gyroscope": float,
        "bias of the gyroscope": "Array",
        "multiplied": "float | Array",
        "Allan deviation": "tuple[Array, Array]",
        "angle random walk": "Array",
        "gravity": float,
        "offset of the accelerometer": "Array",
        "scales of the accelerometer": "Array",
        "axes of the magnetometer": "Array",
        "offset of the magnetometer": "Array",
        "shape of the magnetometer": "Array",
        "strength of the field": float,
        "convention of the quaternion": "Reading",
        "convention of the angles": "Reading",
    },
    total=False,
)


class Verdict(NamedTuple):
    """An answer of the bench.

    Attributes
    ----------
    about : str
    light : str
        ``as it should be``, ``look``, ``wrong`` or ``cannot tell``.
    words : str
        The answer.
    evidence : dict
        The numbers behind the answer, by name.
    advice : str
        What to do, or what would make an answer possible.
    """

    about: str
    light: str
    words: str
    evidence: dict[str, object]
    advice: str = ""


class Examined(NamedTuple):
    """An examined recording.

    Attributes
    ----------
    name : str
    verdicts : list of Verdict
    time : array of shape ``(n,)``
    rates, forces, field : arrays of shape ``(n, 3)`` or None
        Corrected values along the axes of the accelerometer, in radians per second, multiples of
        gravity, and multiples of the field's own length.
    orientation : tuple or None
        Times, and the file's orientations as ``B_C_N``.
    judgements : list of Judgement
    still : list of Stretch
    facts : Facts
    """

    name: str
    verdicts: list[Verdict]
    time: Array
    rates: Array | None
    forces: Array | None
    field: Array | None
    orientation: tuple[Array, Array] | None
    judgements: list[Judgement]
    still: list[Stretch]
    facts: Facts

    def light(self, about: str) -> str:
        """Return the light of one verdict, or ``cannot tell``."""
        return next((verdict.light for verdict in self.verdicts if verdict.about == about), UNKNOWN)

    def __str__(self) -> str:
        return as_text(self)


def as_text(examined: Examined) -> str:
    """Return the report as plain text: a sentence for each verdict, and what to do."""
    rows = [
        row
        for verdict in examined.verdicts
        for row in (
            f"{LIGHTS[verdict.light]} {verdict.about}: {verdict.words}",
            f"  -> {verdict.advice}" if verdict.advice else "",
        )
    ]
    lines = [
        line
        for row in rows
        for line in wrap(row, WIDTH, subsequent_indent=" " * 5, break_long_words=False)
    ]
    return "\n".join([examined.name, *lines])


def as_data(examined: Examined) -> dict[str, object]:
    """Return the report as plain data in format 1, which ``--json`` prints."""
    return {
        "format": 1,
        "recording": examined.name,
        "verdicts": [verdict._asdict() for verdict in examined.verdicts],
    }
