"""Units of measurement as strings, ``'kN m'`` or ``'m/s^2'``: their sizes and base units.

This covers the names of the International System and those that it accepts beside its own (brochure
of the BIPM, 9th edition, tables 1 to 8).
"""

import re
from fractions import Fraction
from typing import Any, NamedTuple

from .evaluate import MP

#: The base units, in the order of the exponents.
BASE = ("m", "kg", "s", "A", "K", "mol", "cd")
PREFIXES = {
    "": 0, "n": -9, "µ": -6, "u": -6, "m": -3, "c": -2, "d": -1, "h": 2, "k": 3, "M": 6, "G": 9,
    "T": 12,
}  # fmt: skip
#: Units with prefixes: the size in base units, and the exponents of m, kg, s, A, K, mol, cd.
WITH_PREFIX = {
    "m": (1, (1,)), "g": (Fraction(1, 1000), (0, 1)), "s": (1, (0, 0, 1)), "A": (1, (0, 0, 0, 1)),
    "K": (1, (0, 0, 0, 0, 1)), "mol": (1, (0, 0, 0, 0, 0, 1)), "cd": (1, (0, 0, 0, 0, 0, 0, 1)),
    "N": (1, (1, 1, -2)), "Pa": (1, (-1, 1, -2)), "J": (1, (2, 1, -2)), "W": (1, (2, 1, -3)),
    "Hz": (1, (0, 0, -1)), "C": (1, (0, 0, 1, 1)), "V": (1, (2, 1, -3, -1)),
    "Ω": (1, (2, 1, -3, -2)), "ohm": (1, (2, 1, -3, -2)), "F": (1, (-2, -1, 4, 2)),
    "T": (1, (0, 1, -2, -1)), "Wb": (1, (2, 1, -2, -1)), "H": (1, (2, 1, -2, -2)),
    "L": (Fraction(1, 1000), (3,)), "l": (Fraction(1, 1000), (3,)), "rad": (1, ()),
    "bar": (100_000, (-1, 1, -2)),
}  # fmt: skip
WITHOUT_PREFIX = {
    "min": (60, (0, 0, 1)), "h": (3600, (0, 0, 1)), "d": (86_400, (0, 0, 1)), "t": (1000, (0, 1)),
    "1": (1, ()), "°": (MP.pi / 180, ()), "deg": (MP.pi / 180, ()), "turn": (2 * MP.pi, ()),
    "%": (Fraction(1, 100), ()),
}  # fmt: skip
RAISED = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
TOKEN = re.compile(
    r"\s*(?:(?P<unit>[^\W\d_]+|°|%|1)(?:(?:\^|\*\*)?\(?(?P<power>-?\d+)\)?)?"
    r"|(?P<over>/)|(?P<times>[*·⋅×])|(?P<open>\()|(?P<close>\)))"
)


class UnknownUnit(ValueError):
    """A string is not a unit; the message quotes the part that is not understood."""


class Unit(NamedTuple):
    """The size of a unit in base units, and their exponents."""

    size: Any
    exponents: tuple[int, ...]


def unit(text: str) -> Unit:
    """Read a unit.

    Raises
    ------
    UnknownUnit

    >>> unit("kN m").exponents, int(unit("kN m").size)
    ((2, 1, -2, 0, 0, 0, 0), 1000)
    >>> unit("J/(kg K)") == unit("m²·s⁻²/K"), unit("N/m/s") == unit("kg s^-3")
    (True, True)
    >>> unit("°C")  # temperatures are in kelvins: a product of units has no other zero
    Traceback (most recent call last):
    coursework.checking.units.UnknownUnit: °C
    """
    size, exponents, place, sign, inside = MP.one, [0] * len(BASE), 0, 1, None
    plain = text.translate(RAISED).replace("\u03bc", "µ").replace("\u2126", "Ω").strip()
    while place < len(plain):
        token = TOKEN.match(plain, place)
        if not token:
            raise UnknownUnit(plain[place:][:20])
        place = token.end()
        if token["unit"] == "°" and plain[place : place + 1] in ("C", "F"):
            # A temperature scale has its own zero, and is not an angle times coulombs.
            raise UnknownUnit(plain[place - 1 : place + 1])
        if token["over"]:
            sign = -1
        elif token["open"]:
            inside = sign
        elif token["close"]:
            sign, inside = 1, None
        elif token["unit"]:
            factor, power = _named(token["unit"]), int(token["power"] or 1) * sign
            if abs(power) > 12:
                raise UnknownUnit(token[0].strip())
            size *= factor.size**power
            for order, exponent in enumerate(factor.exponents):
                exponents[order] += power * exponent
            # Only one unit after a slash is in the denominator, or those in brackets.
            sign = 1 if inside is None else inside
    return Unit(size, tuple(exponents))


def _named(name: str) -> Unit:
    """Return one unit, with its prefix."""
    whole = {**WITH_PREFIX, **WITHOUT_PREFIX}
    if name in whole:
        return _unit(whole[name])
    for prefix, power in PREFIXES.items():
        if name.startswith(prefix) and name[len(prefix) :] in WITH_PREFIX:
            unprefixed = _unit(WITH_PREFIX[name[len(prefix) :]])
            return Unit(unprefixed.size * MP.mpf(10) ** power, unprefixed.exponents)
    raise UnknownUnit(name[:20])


def _unit(about: tuple[Any, tuple[int, ...]]) -> Unit:
    size, exponents = about
    size = MP.mpf(size.numerator) / size.denominator if isinstance(size, Fraction) else MP.mpf(size)
    return Unit(size, exponents)
