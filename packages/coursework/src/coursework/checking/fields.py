"""Read external JSON into typed values, with errors that name the key and the value.

A reader takes a result of `json.loads` and its location, and returns the value or raises
`Misread`. It keeps a number as it is, so that writing it again gives the same bytes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TypeVar, cast

# Values that JSON can represent.
Json = None | bool | int | float | str | list["Json"] | dict[str, "Json"]
Some = TypeVar("Some")
Reader = Callable[[object, str], Some]
LONGEST_SHOWN = 60


class Misread(ValueError):
    """A value is not of the expected kind; the message names the key and the value."""

    def __init__(self, where: str, expected: str, value: object) -> None:
        shown = repr(value)
        if len(shown) > LONGEST_SHOWN:
            shown = f"{shown[:LONGEST_SHOWN]}…"
        super().__init__(f"{where} should be {expected}, not {shown}.")


def text(value: object, where: str) -> str:
    if not isinstance(value, str):
        raise Misread(where, "a string", value)
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
    """Pass on a value whose meaning a plug-in, an author or a student determines."""
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
    """Return a reader of lists."""

    def read(value: object, where: str) -> tuple[Some, ...]:
        if not isinstance(value, (list, tuple)):
            raise Misread(where, "a list", value)
        return tuple([reader(part, where) for part in value])

    return read


def pair(reader: Reader[Some]) -> Reader[tuple[Some, Some]]:
    """Return a reader of lists of two."""

    def read(value: object, where: str) -> tuple[Some, Some]:
        if not isinstance(value, (list, tuple)) or len(value) != 2:
            raise Misread(where, "a list of two", value)
        return reader(value[0], where), reader(value[1], where)

    return read


def by_name(reader: Reader[Some]) -> Reader[dict[str, Some]]:
    """Return a reader of objects with any names."""

    def read(value: object, where: str) -> dict[str, Some]:
        if not isinstance(value, dict):
            raise Misread(where, "an object", value)
        return {
            text(name, where): reader(part, f"{where}: {name!r}") for name, part in value.items()
        }

    return read


class Fields:
    """The fields of an object, each read by the reader of the expected kind.

    >>> about = Fields({"worth": "two"}, "levers/see-saw")
    >>> about.maybe("title", text)
    >>> about.get("worth", number)
    Traceback (most recent call last):
    coursework.checking.fields.Misread: levers/see-saw: 'worth' should be a number, not 'two'.
    """

    def __init__(self, value: object, where: str) -> None:
        self.where = where
        self.found = by_name(anything)(value, where)

    def get(self, name: str, reader: Reader[Some]) -> Some:
        """Return a required field."""
        if name not in self.found:
            raise Misread(self.where, f"an object with {name!r}", ", ".join(self.found))
        return reader(self.found[name], f"{self.where}: {name!r}")

    def maybe(self, name: str, reader: Reader[Some]) -> Some | None:
        """Return a field that may be missing, or empty."""
        value = self.found.get(name)
        return None if value is None else reader(value, f"{self.where}: {name!r}")

    def beside(self, names: Iterable[str]) -> dict[str, Json]:
        """Return all fields except these."""
        return {name: value for name, value in self.found.items() if name not in names}


def written(value: object) -> Json:
    """Return the result of a reader as JSON, with lists for tuples and objects for dataclasses."""
    if hasattr(value, "as_json"):
        return cast(Json, value.as_json())
    if isinstance(value, (tuple, list)):
        return [written(part) for part in value]
    if isinstance(value, Mapping):
        return {name: written(part) for name, part in value.items()}
    return cast(Json, value)
