"""Tables for spreadsheets, in which nothing that a student wrote becomes a formula."""

import csv
import io
import itertools
import unicodedata
from collections.abc import Iterable, Iterator

from ..checking.kinds import number_of as number_of
from ..checking.writing import readable

STARTS_A_FORMULA = ("=", "+", "-", "@", "\t", "\r")


def as_cell(value: object) -> str:
    """Return a value as the text of a cell, marking text that a spreadsheet would evaluate.

    >>> as_cell('=1+1'), as_cell('\\uff1d1'), as_cell(2.0), as_cell('one\\ntwo')
    ("'=1+1", "'\\uff1d1", '2', 'one two')
    """
    if isinstance(value, (int, float)):
        return number(value)
    text = in_a_line(str(value), 2_000)
    # Include the wide forms of these characters, which some spreadsheets treat alike.
    starts = unicodedata.normalize("NFKC", text[:1])
    return (
        f"'{text}"
        if starts.startswith(STARTS_A_FORMULA) or str(value).startswith(STARTS_A_FORMULA)
        else text
    )


def as_written(cell: str) -> str:
    """Return the text that `as_cell` marked."""
    plain = cell.removeprefix("'")
    return (
        plain
        if plain != cell and unicodedata.normalize("NFKC", plain[:1]).startswith(STARTS_A_FORMULA)
        else cell
    )


def number(value: float) -> str:
    """Return points without trailing zeros."""
    return f"{value:.4f}".rstrip("0").rstrip(".") if value != int(value) else str(int(value))


def table(header: Iterable[str], rows: Iterable[Iterable[object]]) -> str:
    """Return a table as CSV, with all strings quoted."""
    return "".join(lines(header, rows))


def lines(header: Iterable[str], rows: Iterable[Iterable[object]]) -> Iterator[str]:
    """Iterate over the lines of a table as CSV, so that it need not fit in memory."""
    file = io.StringIO()
    writer = csv.writer(file, quoting=csv.QUOTE_ALL, lineterminator="\r\n")
    for row in itertools.chain([header], ([as_cell(value) for value in row] for row in rows)):
        writer.writerow(row)
        yield file.getvalue()
        file.seek(0)
        file.truncate()


def reason_of(error: Exception) -> str:
    """Return the system's reason for an error without the path, or else all of the error's text."""
    return error.strerror if isinstance(error, OSError) and error.strerror else str(error)


def in_a_line(text: str, most: int) -> str:
    """Return strangers' text for part of a line, so that it cannot begin a line that seems ours."""
    return " ".join(readable(text, most).split())
