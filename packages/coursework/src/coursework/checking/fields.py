"""JSON from outside, read into what has types: whatever is wrong
is said with its key and its value.

A reader takes what :func:`json.loads` gave, and where it stood, and gives the value or raises
:class:`Misread`. It keeps a number as it is, so that what is written again is the same to the byte.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeVar, cast

#: What JSON can hold.
Json = None | bool | int | float | str | list["Json"] | dict[str, "Json"]
Some = TypeVar("Some")
Reader = Callable[[object, str], Some]
LONGEST_SHOWN = 60


class Misread(ValueError):
    """What was read is not what it should be; the message says which key, and what its value is."""

    def __init__(self, where: str, wanted: str, value: object) -> None:
        shown = repr(value)
        if len(shown) > LONGEST_SHOWN:
            shown = f"{shown[:LONGEST_SHOWN]}…"
        super().__init__(f"{where} should be {wanted}, and is {shown}.")


def text(value: object, where: str) -> str:
    if not isinstance(value, str):
        raise Misread(where, "a text", value)
    return value


def number(value: object, where: str) -> float:
    if not isinstance(value, (int, float)) or isinstance(value, bool):
        raise Misread(where, "a number", value)
    return value


def whole(value: object, where: str) -> int:
    if not isinstance(value, int) or isinstance(value, bool):
        raise Misread(where, "a whole number", value)
    return value


def truth(value: object, where: str) -> bool:
    if not isinstance(value, bool):
        raise Misread(where, "true or false", value)
    return value


def anything(value: object, where: str) -> Json:
    """What a plug-in, an author or a student decides on: it is handed on as it is."""
    return cast(Json, value)


def a_list(value: object, where: str) -> list[Json]:
    return list(many(anything)(value, where))


def one_of(*choices: str) -> Reader[str]:
    def read(value: object, where: str) -> str:
        if value not in choices:
            raise Misread(where, f"one of {', '.join(map(repr, choices))}", value)
        return text(value, where)

    return read


def many(reader: Reader[Some]) -> Reader[tuple[Some, ...]]:
    """A reader of lists."""

    def read(value: object, where: str) -> tuple[Some, ...]:
        if not isinstance(value, (list, tuple)):
            raise Misread(where, "a list", value)
        return tuple([reader(part, where) for part in value])

    return read


def pair(reader: Reader[Some]) -> Reader[tuple[Some, Some]]:
    """A reader of lists of two."""

    def read(value: object, where: str) -> tuple[Some, Some]:
        if not isinstance(value, (list, tuple)) or len(value) != 2:
            raise Misread(where, "a list of two", value)
        return reader(value[0], where), reader(value[1], where)

    return read


def by_name(reader: Reader[Some]) -> Reader[dict[str, Some]]:
    """A reader of objects, whose names may be any."""

    def read(value: object, where: str) -> dict[str, Some]:
        if not isinstance(value, dict):
            raise Misread(where, "an object", value)
        return {
            text(name, where): reader(part, f"{where}: {name!r}") for name, part in value.items()
        }

    return read


class Fields:
    """The fields of an object, each read by what should stand there.

    >>> about = Fields({"worth": "two"}, "levers/see-saw")
    >>> about.maybe("title", text)
    >>> about.get("worth", number)
    Traceback (most recent call last):
    coursework.checking.fields.Misread: levers/see-saw: 'worth' should be a number, and is 'two'.
    """

    def __init__(self, found: object, where: str) -> None:
        self.where = where
        self.found = by_name(anything)(found, where)

    def get(self, name: str, reader: Reader[Some]) -> Some:
        """A field that has to be there."""
        if name not in self.found:
            raise Misread(self.where, f"an object with {name!r}", ", ".join(self.found))
        return reader(self.found[name], f"{self.where}: {name!r}")

    def maybe(self, name: str, reader: Reader[Some]) -> Some | None:
        """A field that may be missing, or empty."""
        value = self.found.get(name)
        return None if value is None else reader(value, f"{self.where}: {name!r}")

    def beside(self, names: Iterable[str]) -> dict[str, Json]:
        """All other fields than these."""
        return {name: value for name, value in self.found.items() if name not in names}


def written(value: object) -> Json:
    """What a reader gave, as JSON: for a tuple a list."""
    if isinstance(value, (tuple, list)):
        return [written(part) for part in value]
    return (
        {name: written(part) for name, part in value.items()}
        if isinstance(value, dict)
        else cast(Json, value)
    )
