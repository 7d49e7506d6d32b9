"""Strict reading of a notebook's records, which are bytes that a student may have written.

We count and drop everything that does not have exactly the form of a record, and repair nothing.
"""

import json
from typing import NoReturn, TypedDict, TypeGuard

from coursework.checking.plain import NotPlain, Plain, read_plain

LONGEST_LINE = 4 << 20
# The most bytes of all records of one run.
MOST_BYTES = 16 << 20
MOST_RECORDS = 20_000
LONGEST_NAME = 200
LONGEST_TEXT = 1000
OUTCOMES = ("done", "error", "timeout", "memory")


#: A step that began or ended: ``["cell", number]`` or ``["answer", name]``.
Step = list[str | int]
#: `Records.well_formed` checks which of these a record has.
Record = TypedDict(
    "Record",
    {
        "done": bool,
        "begin": Step,
        "end": Step,
        "outcome": str,
        "error": str,
        "line": int,
        "threads": bool,
        "answer": str,
        "secret": str,
        "plain": Plain,
        "unreadable": str,
        "from": str,
        "cell": int | None,
    },
    total=False,
)


class Records:
    """A parser that takes bytes as they come and returns the complete, well-formed records."""

    def __init__(self, number_of_cells: int) -> None:
        self.number_of_cells = number_of_cells
        self.unfinished = bytearray()
        self.received = 0
        self.lines = 0
        self.damaged = 0

    @property
    def too_many(self) -> bool:
        """Whether more came than any honest notebook sends."""
        return (
            self.received > MOST_BYTES
            or self.lines > MOST_RECORDS
            or len(self.unfinished) > LONGEST_LINE
        )

    def feed(self, data: bytes) -> list[Record]:
        self.received += len(data)
        self.unfinished += data
        if self.too_many or b"\n" not in data:
            return []
        *lines, rest = self.unfinished.split(b"\n")
        self.unfinished = rest
        whole = [bytes(line) for line in lines if line]
        self.lines += len(whole)
        records = [self.record(line) for line in whole]
        self.damaged += records.count(None)
        return [record for record in records if record is not None]

    def record(self, line: bytes) -> Record | None:
        """Return one line as a record, or ``None``."""
        try:
            record = json.loads(line.decode("utf-8"), parse_constant=_refuse)
            if b"\\u" in line:
                # Incomplete surrogate pairs fail here.
                json.dumps(record, ensure_ascii=False).encode("utf-8")
            return record if isinstance(record, dict) and self.well_formed(record) else None
        except (ValueError, RecursionError, NotPlain):
            return None

    def well_formed(self, record: dict[str, object]) -> TypeGuard[Record]:
        keys = set(record)
        if keys == {"done"}:
            return record["done"] is True
        if keys == {"begin"}:
            return self.is_step(record["begin"])
        if keys in ({"secret", "plain"}, {"secret", "unreadable"}):
            if "plain" in keys:
                read_plain(record["plain"])
            return is_text(record["secret"], LONGEST_NAME) and is_text(
                record.get("unreadable", ""), LONGEST_TEXT
            )
        if "end" in keys:
            return (
                keys <= {"end", "outcome", "error", "line", "threads"}
                and self.is_step(record["end"])
                and record.get("outcome") in OUTCOMES
                and is_text(record.get("error", ""), LONGEST_TEXT)
                and is_count(record.get("line", 1), 1, 10**6)
                and record.get("threads", True) is True
            )
        if keys in ({"answer", "from", "cell", "plain"}, {"answer", "from", "cell", "unreadable"}):
            if "plain" in keys:
                read_plain(record["plain"])
            return (
                is_text(record["answer"], LONGEST_NAME)
                and record["from"] in ("check", "variable")
                and self.is_cell(record["cell"])
                and is_text(record.get("unreadable", ""), LONGEST_TEXT)
            )
        return False

    def is_cell(self, cell: object) -> bool:
        return cell is None or is_count(cell, 0, self.number_of_cells)

    def is_step(self, step: object) -> bool:
        if not isinstance(step, list) or len(step) != 2:
            return False
        if step[0] == "cell":
            return is_count(step[1], 0, self.number_of_cells)
        return step[0] == "answer" and is_text(step[1], LONGEST_NAME)


def is_text(value: object, longest: int) -> bool:
    return isinstance(value, str) and len(value) <= longest


def is_count(value: object, first: int, end: int) -> bool:
    return type(value) is int and first <= value < end


def _refuse(constant: str) -> NoReturn:
    raise ValueError(f"{constant} is not JSON")
