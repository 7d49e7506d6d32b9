"""The record beside a notebook: a student's progress with each question, and with whose numbers.

It never contains an answer or a hint, only where hints can be read again. The file may contain
anything, since it belongs to the student: invalid records are ignored, and fields that a newer
version has added to an entry are kept. The pages of a book store the same entries (``store.js`` of
their scripts), and see from them, without Python, what was solved with other numbers.
"""

from __future__ import annotations

import json
import os
import random
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path

from .fields import (
    Fields,
    Json,
    Misread,
    Reader,
    Some,
    anything,
    by_name,
    many,
    number,
    text,
    whole,
    written,
)
from .question import Place

# The file is beside the notebook, and nowhere else.
KEPT = Path(".coursework", "progress.json")
# The field of an entry for the records with other numbers.
OTHERS = "other variants"


@dataclass(frozen=True)
class Entry:
    """The record of a question with one set of numbers.

    Attributes
    ----------
    outcome, note : str
        The result of the last check, except that a right answer stays right; empty before the
        first.
    answers : tuple of str
        The different wrong answers, hashed.
    help : str
        The help that the student had before the right answer, a key of
        `coursework.checking.reply.HELP`.
    page : Place or None
        The place of the hints about the last mistake.
    mistake, mistake_at : str, float
        A mistake worth another look, and when it was made, in seconds.
    after : tuple of (str, Place)
        The questions that have opened hints for this one, with the places of these hints.
    variant : int
    numbers : str
        The name of these numbers, independent of the variant's number; empty if a question has no
        others.
    whose : str or None
        The ID of the student whose numbers they were, empty for the default ones; ``None`` if
        everybody has the same.
    others : tuple of Entry
        The records with other numbers.
    more : mapping
        Other fields of the entry.
    """

    outcome: str = ""
    note: str = ""
    answers: tuple[str, ...] = ()
    help: str = ""
    page: Place | None = None
    mistake: str = ""
    mistake_at: float = 0
    after: tuple[tuple[str, Place], ...] = ()
    variant: int = 0
    numbers: str = ""
    whose: str | None = None
    others: tuple[Entry, ...] = ()
    more: Mapping[str, Json] = field(default_factory=dict)

    @classmethod
    def from_json(cls, content: object) -> Entry:
        """Read an entry; an invalid field counts as missing."""
        try:
            about = Fields(content, "An entry")
        except Misread:
            return cls()

        def maybe(name: str, reader: Reader[Some]) -> Some | None:
            with suppress(Misread):
                return about.maybe(name, reader)
            return None

        return cls(
            maybe("outcome", text) or "",
            maybe("note", text) or "",
            maybe("answers", many(text)) or (),
            maybe("help", text) or "",
            maybe("page", Place.from_json),
            maybe("mistake", text) or "",
            maybe("mistake at", number) or 0,
            maybe("after", many(_opened)) or (),
            maybe("variant", whole) or 0,
            maybe("numbers", text) or "",
            maybe("whose", text),
            tuple(map(cls.from_json, (maybe(OTHERS, by_name(anything)) or {}).values())),
            about.beside(FIELDS),
        )

    def as_json(self) -> dict[str, Json]:
        """Return the JSON that `from_json` reads, without empty fields."""
        fields_as_json: dict[str, Json] = dict(self.more)
        for name, value in vars(self).items():
            if (
                name
                in (
                    "outcome",
                    "note",
                    "answers",
                    "help",
                    "mistake",
                    "mistake_at",
                    "variant",
                    "numbers",
                )
                and value
            ):
                fields_as_json[name.replace("_", " ")] = written(value)
        if self.page:
            fields_as_json["page"] = [self.page.page, self.page.key]
        if self.after:
            fields_as_json["after"] = [[name, place.page, place.key] for name, place in self.after]
        fields_as_json |= {} if self.whose is None else {"whose": self.whose}
        return fields_as_json | ({OTHERS: _by_variant(self.others)} if self.others else {})

    def has(self, variant: int, numbers: str) -> bool:
        """Check whether it has these numbers; an unnamed entry knows only its variant's number."""
        return self.numbers == numbers if self.numbers and numbers else self.variant == variant

    def with_numbers(self, variant: int, numbers: str) -> Entry:
        """Return the record with these numbers, which keeps the records with others."""
        if self == Entry(after=self.after) or self.has(variant, numbers):
            return replace(self, variant=variant, numbers=numbers)
        known = [replace(self, others=()), *self.others]
        own = next(
            (variant_entry for variant_entry in self.others if variant_entry.has(variant, numbers)),
            Entry(),
        )
        others = tuple(variant_entry for variant_entry in known if variant_entry is not own)
        after = tuple(dict.fromkeys((*own.after, *self.after)))
        return replace(own, variant=variant, numbers=numbers, after=after, others=others)


FIELDS = {name.replace("_", " ") for name in Entry.__dataclass_fields__} - {"others", "more"} | {
    OTHERS
}


def _opened(content: object, where: str) -> tuple[str, Place]:
    name, *place = many(anything)(content, where) or [None]
    return text(name, where), Place.from_json(place, where)


def _by_variant(entries: Iterable[Entry]) -> dict[str, Json]:
    """Return entries by the number of their variant.

    If two editions have different numbers under the same one, the name includes these numbers.
    """
    by_name: dict[str, Json] = {}
    for variant_entry in entries:
        name = str(variant_entry.variant)
        by_name[f"{name} {variant_entry.numbers}" if name in by_name else name] = (
            variant_entry.as_json()
        )
    return by_name


class Progress:
    """The content of the file when it was read; changes are written at once.

    >>> progress = Progress({"levers/arm": {"outcome": "correct"}, "levers/see-saw": 3})
    >>> progress.entry("levers/arm").outcome, progress.entry("levers/see-saw") == Entry()
    ('correct', True)
    """

    def __init__(self, entries: Mapping[str, Json]) -> None:
        self.entries = dict(entries)

    @classmethod
    def read(cls) -> Progress:
        with suppress(OSError, ValueError):
            return cls(by_name(anything)(json.loads(KEPT.read_text("utf8")), str(KEPT)))
        return cls({})

    def entry(self, name: str) -> Entry:
        return Entry.from_json(self.entries.get(name))

    def put(self, entries: Mapping[str, Entry]) -> None:
        """Write some entries; in a read-only folder, only the record is lost."""
        self.entries |= {name: entry.as_json() for name, entry in entries.items()}
        with suppress(OSError):
            KEPT.parent.mkdir(exist_ok=True)
            draft = KEPT.with_name(f"progress-{os.getpid()}-{random.random()}.json")
            draft.write_text(json.dumps(self.entries, indent=1, sort_keys=True), "utf8")
            draft.replace(KEPT)
