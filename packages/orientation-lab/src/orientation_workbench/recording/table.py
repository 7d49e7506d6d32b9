"""Tables of numbers from any form of recording: text, JSON, a folder, a zip, or zips in a folder.

Nothing is repaired. A row that does not fit is left out, counted, and reported by line and column;
if many do not fit, the file is refused in the same words.
"""

from __future__ import annotations

import csv
import gzip
import io
import json
import re
import zipfile
import zlib
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from datetime import datetime
from functools import partial
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array: TypeAlias = NDArray[np.float64]
    #: A file, a folder or several of them, or the content of a file.
    Source: TypeAlias = str | Path | bytes | Sequence[str | Path]

# None stands for spaces.
DELIMITERS = (",", ";", "\t", "|", None)
TEXTS = (".csv", ".txt", ".tsv", ".log", ".json", ".dat", ".gz", ".zip")
EXCEL = "an Excel workbook: save it as CSV (phyphox can export CSV directly)"
#: The first bytes of formats that are not text, and what converts them to text.
ELSEWHERE = {
    b"ULog": "a PX4 log: convert it to tables with ulog2csv, from the package pyulog",
    b"\xa3\x95": "an ArduPilot log: convert it with mavlogdump.py --format csv --types IMU",
    b"#ROSBAG": "a ROS bag: export a topic with rostopic echo -b FILE -p TOPIC",
    b"SQLite format 3": "a ROS 2 bag: play it, and save a topic with ros2 topic echo --csv TOPIC",
    b"\x89MCAP": "a ROS 2 bag: play it, and save a topic with ros2 topic echo --csv TOPIC",
    b"H Product:Blackbox": "a blackbox log: convert it with blackbox_decode",
    b"\xd0\xcf\x11\xe0": EXCEL,
    b"\x89HDF": "an HDF5 file: export its tables as CSV",
    b"MATLAB 5.0": "a MATLAB file: convert it to CSV with writetable or writematrix",
}
MISSING = {"", "nan", "null", "none", "na", "n/a", "-", "--"}
#: A label and its number, as Arduino's plotter takes them.
LABELLED = re.compile(r"(?<![\w.])([A-Za-z_]\w*)\s*[:=]\s*([^\s,;|]+)")
#: The Arduino IDE's time and arrow before a line, perhaps with a first field that is a number.
STAMP = re.compile(r"^(\s*\d+:\d\d:\d\d[.\d]*) -> (?=\s*([-+]?[.\d][-+.e\d]*\s*[,;|\t])?)")
#: The first two numbers of a date that a time follows.
DATE = re.compile(r"(?<!\d)(\d\d?)/(\d\d?)(?=/\d{4} )")
#: The fewest rows of a table.
FEWEST = 8
#: The most kinds of lines in a log. If the first column has more words, they only label its rows.
MOST_KINDS = 200
# The largest fraction of rows that may not fit before a file is refused.
MOST_BROKEN = 0.02


class RecordingError(ValueError):
    """The reason why a file cannot be read as a recording, with line and column if known."""


class BrokenTable(RecordingError):
    """A table with too many rows that do not fit, as opposed to a note beside the data."""


class Table(NamedTuple):
    """Columns of numbers measured together.

    Attributes
    ----------
    name : str
        The name of the file, or of a kind of line in a log.
    columns : list of str
        As the file names them; ``column 1`` and so on if it does not.
    values : array of shape ``(n, m)``
        Missing values are NaN.
    remarks : list of str
        What did not fit, with lines and columns.
    head : str
        The text above the numbers.
    file : str
        Of several files, the one that contains the table.
    """

    name: str
    columns: list[str]
    values: Array
    remarks: list[str]
    head: str = ""
    file: str = ""


def number_of(count: int, noun: str) -> str:
    """Return a number of things in words.

    >>> number_of(1, 'row'), number_of(2, 'row')
    ('1 row', '2 rows')
    """
    return f"{count} {noun}{'' if count == 1 else 's'}"


def read_tables(source: Source, name: str | None = None) -> list[Table]:
    """Read all tables of files, of a folder, or of text already in memory.

    Parameters
    ----------
    source : path, list of paths, bytes or str
        A file, a folder, or several of them; or the content of a file, as bytes or as a text of
        more than one line.
    name : str, optional
        The name of content given without one.

    Returns
    -------
    list of Table

    Raises
    ------
    RecordingError
        If nothing in it is a table of numbers, or too much of it does not fit.

    Examples
    --------
    >>> rows = "\\n".join(f"{k / 100},{k},{k * k}" for k in range(9))
    >>> [table] = read_tables("time,x,y\\n" + rows)
    >>> table.columns, table.values.shape
    (['time', 'x', 'y'], (9, 3))

    The Arduino IDE's lines, with its time, and those of its plotter:

    >>> [table] = read_tables("\\n".join(f"14:00:00.{k}00 -> {k},{k * k},{-k}" for k in range(9)))
    >>> table.values[2].tolist()[1:]
    [2.0, 4.0, -2.0]
    >>> lines = [f"14:00:00.{k}00 -> ax:{k} ay:{-k} az: {k * k}.5" for k in range(9)]
    >>> [table] = read_tables("\\n".join(lines))
    >>> table.columns, table.values[2].tolist()[1:]
    (['time', 'ax', 'ay', 'az'], [2.0, -2.0, 4.5])

    Labels with several numbers each name no columns:

    >>> [table] = read_tables("acc: 1 2 3 gyr: 4 5 6\\n" * 9)
    >>> table.values.shape
    (9, 6)

    A day and a month, of which the one that changes at midnight is the day:

    >>> days = [f"{day}/2/2026 0:00:0{k}.5,{k},{k * k}" for day in (1, 2) for k in range(8)]
    >>> [table] = read_tables("\\n".join(days))
    >>> float(table.values[8, 0] - table.values[0, 0])
    86400.0

    One object of JSON to a line, or one list:

    >>> [table] = read_tables("\\n".join(f'{{"t": {k}, "acc": [{k}, 2]}}' for k in range(9)))
    >>> table.columns
    ['t', 'acc[0]', 'acc[1]']
    >>> [table] = read_tables("[1, 2, 3],\\n" * 9)
    >>> table.values.shape
    (9, 3)
    """
    if isinstance(source, str) and "\n" in source:
        return _from_text(source, name or "recording")
    if isinstance(source, bytes):
        return _from_bytes(source, name or "recording")
    paths = [Path(path) for path in ([source] if isinstance(source, (str, Path)) else source)]
    files: dict[Path, None] = {}
    for path in paths:
        if not path.exists():
            raise RecordingError(f"no such file: {path}")
        files |= {
            file: None
            for file in (sorted(path.rglob("*")) if path.is_dir() else [path])
            if file == path or file.is_file() and file.suffix.lower() in TEXTS
        }
    if [*files] == paths and len(paths) == 1:
        return _from_bytes(paths[0].read_bytes(), name or paths[0].name)
    return _from_several(
        ((file.name, file.read_bytes) for file in files), name or ", ".join(map(str, paths))
    )


def _from_bytes(content: bytes, name: str) -> list[Table]:
    try:
        return _unpacked(content, name)
    except (EOFError, RuntimeError, gzip.BadGzipFile, zipfile.BadZipFile, zlib.error) as error:
        raise RecordingError(f"{name} cannot be unpacked: {error}") from None


def _unpacked(content: bytes, name: str) -> list[Table]:
    if content[:2] == b"\x1f\x8b":
        return _from_bytes(gzip.decompress(content), name)
    if content[:4] == b"PK\x03\x04":
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            names = archive.namelist()
            if "xl/workbook.xml" in names:
                raise RecordingError(f"{name} is {EXCEL}")
            return _from_several(
                [
                    (file, partial(archive.read, file))
                    for file in names
                    if Path(file).suffix.lower() in TEXTS
                ],
                name,
            )
    if not content.strip():
        raise RecordingError(f"{name} is empty")
    for begins, words in ELSEWHERE.items():
        if content.startswith(begins):
            raise RecordingError(f"{name} is {words}")
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        text = content.decode("utf-16")
    elif b"\0" in content[:4096]:
        raise RecordingError(
            f"{name} is not a text file: byte {content.index(0) + 1} is zero. "
            "Many loggers use their own format: first export the file as CSV with the "
            "manufacturer's program."
        )
    else:
        try:
            text = content.decode("utf-8-sig")
        except UnicodeDecodeError:
            text = content.decode("latin-1")
    return _from_text(text, name)


def _from_several(files: Iterable[tuple[str, Callable[[], bytes]]], name: str) -> list[Table]:
    """Return all tables of pairs of a name and a function that reads the content."""
    tables: list[Table] = []
    broken: list[str] = []
    reasons: list[str] = []
    for file, read in files:
        try:
            tables += (
                table._replace(file=f"{file}/{table.file}" if table.file else file)
                for table in _from_bytes(
                    read(), file if Path(file).suffix in (".gz", ".zip") else Path(file).stem
                )
            )
        except BrokenTable as error:
            broken.append(str(error))
        except OSError as error:
            # Others may move a file in the meantime, or hold it open.
            broken.append(f"left out {file}: {error.strerror or error}")
        except RecordingError as error:
            # The measurements often come with settings and notes.
            reasons.append(str(error))
    if not tables:
        raise RecordingError("; ".join([f"{name} contains no table of numbers", *broken, *reasons]))
    tables[0].remarks.extend(broken)
    return tables


def _from_text(text: str, name: str) -> list[Table]:
    if text.lstrip()[:1] in "[{":
        return _from_json(text, name)
    # A date such as 1/2/2026 may have the day or the month first. The day is the number that is
    # above 12, or that changes more often.
    days, months = ({date[place] for date in DATE.findall(text)} for place in (0, 1))
    if len(days) > len(months) or any(int(day) > 12 for day in days):
        text = DATE.sub(r"\2/\1", text)
    lines = text.splitlines()
    names, rows = _labels(lines, text)
    if names:
        return [_table(rows, name, False, None, names)]
    if sum(line.startswith("---") for line in lines) > 8:
        raise RecordingError(
            f"{name} contains ROS messages: save them as a table with rostopic echo -p or ros2 "
            "topic echo --csv"
        )
    delimiter = max(DELIMITERS, key=lambda delimiter: _numbers_per_line(lines, delimiter))
    rows = [
        _split(line, delimiter)
        for line in (_stamped(lines, delimiter) if delimiter and " -> " in text else lines)
    ]
    comma = 10 < sum(
        # Between commas, "1,234" may be a thousand and more.
        _is_comma(field) and not (delimiter == "," and re.search(r",\d{3}$", field))
        for row in rows[:400]
        for field in row
    )
    first = Counter(row[0] for row in rows if len(row) > 3 and _number(row[0], comma) is None)
    # A time of the day in a form that we cannot read does not name a kind of line.
    kinds = [
        kind for kind, count in first.items() if count >= FEWEST and not re.search(r"\d:\d", kind)
    ]
    if 1 < len(kinds) <= MOST_KINDS:
        return _from_log(rows, kinds, name, comma)
    return [_table(rows, name, comma)]


def _stamped(lines: list[str], delimiter: str) -> list[str]:
    """Put the delimiter in place of the Arduino IDE's arrows, if all lines then agree."""
    parted = [STAMP.sub(rf"\1{delimiter}", line) for line in lines]
    usual = Counter(line.count(delimiter) for line in parted).most_common(1)[0][0]
    numbers = sum(bool((stamp := STAMP.match(line)) and stamp[2]) for line in lines)
    # A line without an arrow is a title, or has the columns' names.
    return (
        parted
        if numbers > len(lines) / 2
        and all(STAMP.match(line) or line.count(delimiter) in (0, usual) for line in lines)
        else lines
    )


def _labels(lines: list[str], text: str) -> tuple[tuple[str, ...], list[list[str]]]:
    """Return names and rows of lines such as ``ax:0.1 ay:0.2``; another line is a single field.

    There are no names if more lines differ than a table may lose.
    """
    labelled = [
        _labelled(line) if ":" in line or "=" in line else ((), [line.strip()]) for line in lines
    ]
    there = [own for own, row in labelled if any(row)]
    names, count = Counter(there or [()]).most_common(1)[0]
    # With a space before each number, further lines may be another table of a log.
    some = 0 if re.search(r"[:=][ \t]+[-+.\d]", text) else MOST_BROKEN * len(there)
    return (
        names if len(there) - count <= max(2, some) else (),
        [row if own == names else [line.strip()] for (own, row), line in zip(labelled, lines)],
    )


def _labelled(line: str) -> tuple[tuple[str, ...], list[str]]:
    """Return the labels and numbers of a line, if there is nothing else but a time before them."""
    before, *parts = LABELLED.split(line)
    time = before.rstrip(" \t,;|").removesuffix("->").strip()
    names = ("column 1" if "time" in parts[::3] else "time",) * bool(time) + (*parts[::3],)
    fields = [time] * bool(time) + parts[1::3]
    return (
        (names, fields)
        if len(parts) > 8
        and len({*names}) == len(names)
        and not "".join(parts[2::3]).strip(" \t,;|")
        and all(_number(field) is not None for field in fields)
        else ((), [line.strip()])
    )


def _split(line: str, delimiter: str | None) -> list[str]:
    if delimiter is None:
        return line.split()
    fields = next(csv.reader([line], delimiter=delimiter)) if '"' in line else line.split(delimiter)
    return [field.strip() for field in fields]


def _is_comma(field: str) -> bool:
    return re.fullmatch(r"[-+]?\d+,\d+([eE][-+]?\d+)?", field) is not None


def _number(field: str, comma: bool = False) -> float | None:
    """Return the number in a field, NaN for a missing one, None for anything else."""
    with suppress(ValueError):
        return float(field.replace(",", ".") if comma else field)
    if ":" not in field:
        return float("nan") if field.lower() in MISSING else None
    # A date, which has the day first and points, or the month first and strokes, with a time, or a
    # time alone. The hour may have one digit, and half a day after it.
    field = re.sub(
        r"^(.* )?(\d\d?)(:[\d:.]+) ?([ap])\.?m\.?$",
        lambda at: f"{at[1] or ''}{int(at[2]) % 12 + 12 * (at[4] == 'p')}{at[3]}",
        field.lower(),
    ).upper()
    field = re.sub(r"(?<!\d)(\d[:/])", r"0\1", field)
    for text in (
        re.sub(r"^(\d\d)/(\d\d)/(\d{4})", r"\3-\1-\2", field).replace("/", "-"),
        re.sub(r"^(\d\d)\.(\d\d)\.(\d{4})", r"\3-\2-\1", field),
        f"2000-01-01T{field}",
    ):
        with suppress(ValueError):
            return datetime.fromisoformat(text).timestamp()
    return None


def _numbers_per_line(lines: Sequence[str], delimiter: str | None) -> float:
    """Return the median count of numbers in the middle lines, split by this delimiter."""
    middle = [line for line in lines[len(lines) // 4 :] if line.strip()][:200]
    counts = [
        sum(
            _number(field) is not None or _is_comma(field)
            for field in _split(line, delimiter)
            if field
        )
        for line in middle
    ]
    return float(np.median(counts)) if counts else 0


def _table(
    rows: Sequence[Sequence[str]],
    name: str,
    comma: bool,
    numbers: Iterable[int] | None = None,
    columns: Sequence[str] | None = None,
) -> Table:
    """Make a table of rows of fields; ``numbers`` are their line numbers, if lines are missing."""
    numbers = range(1, len(rows) + 1) if numbers is None else numbers
    there = [(line, row) for line, row in zip(numbers, rows, strict=True) if any(row)]
    widths = Counter(len(row) for _, row in there)
    if not widths:
        raise RecordingError(f"{name} is empty")
    width = widths.most_common(1)[0][0]
    full = [(line, row) for line, row in there if len(row) == width]
    sample = full[len(full) // 4 :][:300] or full
    numeric = [
        k
        for k in range(width)
        if sum(_number(row[k], comma) is not None for _, row in sample) > 0.8 * len(sample)
        and any(
            _number(row[k], comma) is not None and row[k].lower() not in MISSING for _, row in full
        )
    ]
    if len(numeric) < 3 or len(full) < FEWEST:
        line, row = (sample or there)[0]
        raise RecordingError(
            f"{name} is not a table of numbers: it has {number_of(len(full), 'row')} of the same "
            f"format, with {number_of(len(numeric), 'numeric column')}, but a recording needs at "
            "least eight rows and three columns. "
            f"Line {line} begins: {' '.join(row)[:60]!r}"
        )

    def values(row: Sequence[str]) -> list[float | None]:
        # Nearly every row consists of plain numbers.
        with suppress(ValueError):
            return [float(row[k]) for k in numeric]
        return [_number(row[k], comma) for k in numeric]

    begin = next(
        k
        for k, (_, row) in enumerate(there)
        if len(row) == width and all(value is not None for value in values(row))
    )
    if columns is None or len(columns) != width:
        columns = _names([row for _, row in there[:begin]], width)
    kept: list[list[float | None]] = []
    broken: list[str] = []
    for line, row in there[begin:]:
        if len(row) != width:
            broken.append(
                f"line {line} has {number_of(len(row), 'column')} where the others have {width}"
            )
        elif None in (entries := values(row)):
            column = numeric[entries.index(None)]
            broken.append(
                f"line {line}, column {column + 1} ({columns[column]}): {row[column][:30]!r} is "
                "not a number"
            )
        elif inf in entries or -inf in entries:
            broken.append(f"line {line} contains an infinite number")
        else:
            kept.append(entries)
    told = "; ".join(broken[:3]) + (f"; and {len(broken) - 3} more" if len(broken) > 3 else "")
    if len(broken) > max(2, MOST_BROKEN * (len(kept) + len(broken))):
        raise BrokenTable(
            f"{name}: {len(broken)} of {len(kept) + len(broken)} rows cannot be read: {told}"
        )
    remarks = [
        *([f"left out {number_of(len(broken), 'row')}: {told}"] if broken else []),
        *(
            f"left out column {k + 1} ({columns[k]}): {sample[0][1][k][:30]!r} is a time of a form "
            "that we cannot read"
            for k in range(width)
            if k not in numeric and re.search(r"(?<![\w:])\d?\d:\d\d(?!\d)", sample[0][1][k])
        ),
    ]
    table = np.array(kept, dtype=float)
    for column, k in zip(table.T, numeric):
        # A time of the day begins anew at midnight.
        if re.match(r"\d\d?:\d\d", sample[0][1][k]):
            column[1:] += 86_400 * np.cumsum(np.diff(column) < -43_200)
    return Table(
        name,
        [columns[k] for k in numeric],
        table,
        remarks,
        "\n".join(",".join(row) for _, row in there[:begin]),
    )


def _names(head: Sequence[Sequence[str]], width: int) -> list[str]:
    """Return the column names from the lines above the numbers, with any units below."""
    bare = [[re.sub(r"^[#%/\s\"']+|[\"']+$", "", field) for field in row] for row in head]
    # Drop a lone comment sign at the start of the line.
    bare = [row[1:] if len(row) == width + 1 and not row[0] else row for row in bare]
    bare = [
        row
        for row in bare
        if width - 1 <= len(row) <= width + 1 and any(re.search("[A-Za-z]", field) for field in row)
    ]
    if not bare:
        return [f"column {k + 1}" for k in range(width)]
    # Above the numbers there may be lines of kinds and units, which repeat themselves; names do
    # not.
    most = max(range(len(bare)), key=lambda k: (len(set(bare[k])), k))
    names = bare[most]
    if most < len(bare) - 1 and len(bare[-1]) == len(names):
        names = [
            f"{name} [{unit.strip('()[]')}]" if unit else name
            for name, unit in zip(names, bare[-1], strict=True)
        ]
    return [
        name or f"column {k}" for k, name in enumerate([*names, *[""] * width][:width], start=1)
    ]


def _from_log(
    rows: Sequence[list[str]], kinds: Sequence[str], name: str, comma: bool
) -> list[Table]:
    """Make a table of each kind of line that begins with its name, as in drones and phones."""
    # In ArduPilot, a line FMT has type, length, name, formats, and the names of the columns. In
    # Android, the names of the columns are in a comment.
    heads = {row[3]: row[5:] for row in rows if len(row) > 5 and row[0] == "FMT"}
    heads |= {row[0].lstrip("# "): row[1:] for row in rows if row and row[0].startswith("#")}
    tables = []
    lines_of: dict[str, list[tuple[int, list[str]]]] = {}
    for number, row in enumerate(rows, 1):
        lines_of.setdefault(row[0] if row else "", []).append((number, row[1:]))
    for kind in kinds:
        lines, columns = lines_of[kind], heads.get(kind)
        # Of several instruments of a kind, which column I distinguishes, only the first counts.
        if columns and "I" in columns:
            which = columns.index("I")
            lines = [(number, row) for number, row in lines if row[which : which + 1] == ["0"]]
        # Other kinds of lines hold no measurements.
        with suppress(RecordingError):
            numbers = [number for number, _ in lines]
            tables.append(_table([row for _, row in lines], kind, comma, numbers, columns))
    if not tables:
        raise RecordingError(
            f"{name} looks like a log, but no kind of line in it forms a table of numbers"
        )
    return tables


def _from_json(text: str, name: str) -> list[Table]:
    # Loggers also write one object or list to a line, without a list around them.
    lines = re.sub(
        r"(?<=\}),?(?=[^\S\n]*\n\s*\{)|(?<=\]),?(?=[^\S\n]*\n\s*\[)", ",", text.rstrip(", \t\r\n")
    )
    try:
        content = json.loads(f"[{lines}]")
    except json.JSONDecodeError as error:
        raise RecordingError(
            f"{name} begins like JSON but is not: line {error.lineno}, column "
            f"{error.colno - (error.lineno == 1)}: {error.msg}"
        ) from None
    if len(content) > 1 and not any(
        isinstance(row, dict) or {dict, list} & {*map(type, row)} for row in content
    ):
        return [_table([[*map(str, row)] for row in content], name, False)]
    [content] = content if len(content) == 1 else [content]
    kinds: dict[str, list[dict[str, object]]] = {}
    for key, entries in (content if isinstance(content, dict) else {name: content}).items():
        for entry in entries if isinstance(entries, list) else []:
            if isinstance(entry, dict):
                kinds.setdefault(str(entry.get("sensor", key)), []).append(_flat(entry))
    tables = []
    for kind, entries in kinds.items():
        columns = list(dict.fromkeys(key for entry in entries for key in entry))
        rows = [[str(entry.get(column, "")) for column in columns] for entry in entries]
        with suppress(RecordingError):
            tables.append(_table(rows, kind, False, None, columns))
    if not tables:
        raise RecordingError(f"{name} is JSON, but contains no list of measurements")
    return tables


def _flat(entry: Mapping[str, object], before: str = "") -> dict[str, object]:
    flat: dict[str, object] = {}
    for key, value in entry.items():
        if isinstance(value, dict):
            flat |= _flat(value, f"{before}{key}.")
        elif isinstance(value, (list, tuple)):
            flat |= {f"{before}{key}[{k}]": item for k, item in enumerate(value)}
        elif key != "sensor":
            flat[before + key] = value
    return flat
