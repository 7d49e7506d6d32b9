"""Tables that a spreadsheet opens, in which nothing that a student wrote is a formula."""

import csv
import io
import itertools
import unicodedata
from collections.abc import Iterable, Iterator

from ..checking.kinds import number_of as number_of
from ..checking.writing import readable

STARTS_A_FORMULA = ("=", "+", "-", "@", "\t", "\r")


def as_cell(value: object) -> str:
    """A value as the text of a cell: text that a spreadsheet would work out is marked as text.

    >>> as_cell('=1+1'), as_cell('\\uff1d1'), as_cell(2.0), as_cell('one\\ntwo')
    ("'=1+1", "'\\uff1d1", '2', 'one two')
    """
    if isinstance(value, (int, float)):
        return number(value)
    text = in_a_line(str(value), 2_000)
    # Also what looks the same to some spreadsheets: the wide forms of these signs.
    starts = unicodedata.normalize("NFKC", text[:1])
    return (
        f"'{text}"
        if starts.startswith(STARTS_A_FORMULA) or str(value).startswith(STARTS_A_FORMULA)
        else text
    )


def as_written(cell: str) -> str:
    """The text that `as_cell` marked."""
    plain = cell.removeprefix("'")
    return (
        plain
        if plain != cell and unicodedata.normalize("NFKC", plain[:1]).startswith(STARTS_A_FORMULA)
        else cell
    )


def number(value: float) -> str:
    """Points without needless zeros."""
    return f"{value:.4f}".rstrip("0").rstrip(".") if value != int(value) else str(int(value))


def table(header: Iterable[str], rows: Iterable[Iterable[object]]) -> str:
    """A table as CSV, every text in quotation marks."""
    return "".join(lines(header, rows))


def lines(header: Iterable[str], rows: Iterable[Iterable[object]]) -> Iterator[str]:
    """The lines of a table as CSV, one after another, for a table that no memory need hold."""
    file = io.StringIO()
    writer = csv.writer(file, quoting=csv.QUOTE_ALL, lineterminator="\r\n")
    for row in itertools.chain([header], ([as_cell(value) for value in row] for row in rows)):
        writer.writerow(row)
        yield file.getvalue()
        file.seek(0)
        file.truncate()


def in_a_line(text: str, most: int) -> str:
    """Text of strangers as part of one line: it cannot begin
    another, which would seem to be ours.
    """
    return " ".join(readable(text, most).split())
