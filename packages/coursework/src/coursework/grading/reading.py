"""Conversion of dataclasses to JSON and back, or from tables that people write.

The readers and the writer are derived from the fields, so no hand-written reader can mix up two of
them. JSON uses a field's name in Python, with spaces for underscores, and leaves out fields that
have their default.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import MISSING, Field, fields, is_dataclass
from types import NoneType
from typing import Any, Self, get_args, get_origin, get_type_hints

from ..checking.fields import (
    Fields,
    Json,
    Reader,
    anything,
    by_name,
    many,
    number,
    text,
    truth,
    whole,
    written,
)

PLAIN: dict[object, Reader[Any]] = {str: text, float: number, int: whole, bool: truth}


class AsJson:
    """A dataclass that is stored as JSON."""

    @classmethod
    def from_json(cls, value: object, where: str = "") -> Self:
        """Read what `as_json` wrote, ignoring unknown fields.

        Raises
        ------
        Misread
        """
        about, known = Fields(value, where or cls.__name__.lower()), {}
        for field, reader in _readers(cls):  # type: ignore[arg-type]
            name = _key(field)
            optional = field.default is not MISSING or field.default_factory is not MISSING
            if name in about.found or not optional:
                known[field.name] = about.get(name, reader)
        return cls(**known)

    def as_json(self) -> dict[str, Json]:
        """Return the data that `from_json` reads."""
        return {
            _key(field): written(getattr(self, field.name))
            for field, _ in _readers(type(self))  # type: ignore[arg-type]
            if getattr(self, field.name) != _default(field)
        }


def _key(field: Field[Any]) -> str:
    return str(field.metadata.get("key") or field.name.replace("_", " "))


def _default(field: Field[Any]) -> object:
    return field.default if field.default_factory is MISSING else field.default_factory()


@functools.cache
def _readers(kind: type) -> list[tuple[Field[Any], Reader[Any]]]:
    types = get_type_hints(kind)
    return [(field, _reader(types[field.name])) for field in fields(kind)]


def _reader(kind: Any) -> Reader[Any]:
    """Return the reader of values of a type; plain data is read as it is."""
    origin, arguments = get_origin(kind), get_args(kind)
    if kind in PLAIN:
        return PLAIN[kind]
    if is_dataclass(kind):
        return kind.from_json  # type: ignore[no-any-return, union-attr]
    if origin is tuple and arguments[-1] is Ellipsis:
        return many(_reader(arguments[0]))
    if origin is Mapping:
        return by_name(_reader(arguments[1]))
    if NoneType in arguments and len(arguments) == 2:
        inner = _reader(next(argument for argument in arguments if argument is not NoneType))
        return lambda value, where: None if value is None else inner(value, where)
    return anything


def from_table(file: Any, kind: Any, where: str, value: object, most: float = math.inf) -> Any:
    """Read the value at a place of a file that people write, by its type.

    A dataclass is a table, whose keys are the names of its fields with hyphens. The file reads
    single values with ``leaf(kind, where, value, most)``, checks JSON types with ``of(kind, what,
    where, value)`` and returns the error for an unknown key with ``unknown(where, name, known)``.
    """
    origin, arguments = get_origin(kind), get_args(kind)
    if is_dataclass(kind):
        types, said = get_type_hints(kind), {}
        known = {field.name.replace("_", "-"): field for field in fields(kind)}
        for name, part in file.of(dict, "a table", where, value).items():
            if name not in known:
                raise file.unknown(where, name, known)
            field, place = known[name], f"{where}.{name}".strip(".")
            most = field.metadata.get("most", math.inf)
            said[field.name] = from_table(file, types[field.name], place, part, most)
        return kind(**said)  # type: ignore[operator]
    if origin is Mapping:
        return {
            name: from_table(file, arguments[1], f"{where}.{name}", part)
            for name, part in file.of(dict, "a table", where, value).items()
        }
    if origin is tuple:
        what = "a list of tables" if is_dataclass(arguments[0]) else "a list"
        parts = file.of(list, what, where, value)
        return tuple(from_table(file, arguments[0], where, part) for part in parts)
    if NoneType in arguments and len(arguments) == 2:
        return from_table(file, arguments[0], where, value, most)
    return file.leaf(kind, where, value, most)
