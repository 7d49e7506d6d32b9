"""The roster of a course, read from the instructor's table or a system's exported gradebook."""

import csv
import io
import re
import unicodedata
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePosixPath
from typing import TypeVar

from ..record import Identity
from .languages import IN_ALL, in_english

Key = TypeVar("Key")

#: The names of the columns in rosters and exported gradebooks, by what they contain. Moodle's table
#: of participants is in the language of its user.
COLUMNS = {
    "own": (
        "sid", "student", "student id", "student_id", "username", "user name", "login",
        "sis login id", "sis user id", "integration id", "id number", "orgdefinedid", "identifier",
        "matrikelnummer", *IN_ALL["id number"], *IN_ALL["username"],
    ),
    "name": ("name", "full name", "student name"),
    "email": ("email", "email address", "e-mail", "e-mail address", *IN_ALL["email address"]),
    "canvas": ("canvas", "canvas id"),
    "canvas anonymous": ("canvas anonymous",),
    "moodle": ("moodle", "moodle id"),
    "brightspace": ("brightspace", "brightspace id"),
    "github": ("github", "github_username", "github username"),
    "handed in as": ("handed in as",),
}  # fmt: skip
FIRST = ("first name", "first_name", "firstname", "vorname", "prénom", "nombre", "voornaam")
LAST = (
    "last name", "last_name", "lastname", "surname", "nachname", "nom de famille", "apellido(s)",
    "achternaam",
)  # fmt: skip
WORDS = {
    "own": "the name of the folder",
    "name": "the full name",
    "email": "the address",
    "letters": "the letters of the name",
    "canvas": "Canvas's number",
    "canvas anonymous": "Canvas's anonymous name",
    "moodle": "Moodle's number",
    "gradescope": "the number or address in Gradescope",
    "brightspace": "Brightspace's number",
    "github": "the GitHub name",
    "handed in as": "the column `handed in as`",
}


class BadRoster(ValueError):
    """An error for a roster that cannot be used; the message gives the reason and the line."""


@dataclass(frozen=True)
class Person:
    """A person in the course.

    Attributes
    ----------
    called : mapping of tuples of str
        The person's names and IDs in the roster, by a key of `WORDS`.
    row : mapping of str
        The whole row of the roster, by the lower-case names of the columns.
    local_part : str
        The part of the address before the at sign, if the domain is the most frequent one; or
        empty.
    """

    called: Mapping[str, tuple[str, ...]]
    row: Mapping[str, str] = field(default_factory=dict)
    local_part: str = ""

    @property
    def student(self) -> str | None:
        """The person's name here, which also determines their variants, or ``None``."""
        return next(
            (value for kind in ("own", "email", "name") for value in self.called.get(kind, ())),
            None,
        )

    def spellings(self) -> Iterator[tuple[str, str]]:
        """Iterate over everything that identifies the person, each as a kind and a value."""
        for kind, values in self.called.items():
            for value in values:
                yield kind, value
                if kind == "name":
                    yield from (("letters", value), ("letters", turned(value)))
                if kind == "email":
                    yield "own", value
                if kind in ("own", "email"):
                    yield "gradescope", value
        if self.local_part:
            yield "own", self.local_part


class Roster:
    """The people in the course. Where there is a roster, it alone decides who somebody is.

    Parameters
    ----------
    path : path
        A table of comma-separated values, or the gradebook that Canvas, Moodle or Brightspace
        exports, with columns of `COLUMNS`. The column ``handed in as`` contains names of folders or
        files, separated by semicolons, that cannot be matched otherwise.
    groups : mapping, optional
        The members of each group. What matches several members of one group is the group's.

    Attributes
    ----------
    people : dict of str to Person
        The people, by their names here.
    """

    def __init__(self, path: str | Path, groups: Mapping[str, Iterable[str]] | None = None) -> None:
        self.group_of = {
            member: group for group, members in (groups or {}).items() for member in members
        }
        self.path = Path(path)
        self.people: dict[str, Person] = {}
        for line, row in _rows(self.path):
            person = Person(_called(row), row)
            if person.student is None:
                # This is Canvas's row of possible points.
                continue
            if person.student in self.people:
                raise BadRoster(f"{path}, line {line}: {person.student!r} is listed twice.")
            self.people[person.student] = person
        if not self.people:
            raise BadRoster(
                f"{path} lists no students. A roster is a table (.csv) with a column `student`, "
                "`name` or `email`, or a gradebook from Canvas, Moodle or Brightspace."
            )
        addresses = {
            name: person.called["email"][0]
            for name, person in self.people.items()
            if person.called.get("email")
        }
        for name, own in local_parts(addresses).items():
            self.people[name] = replace(self.people[name], local_part=own)
        self.index: dict[tuple[str, str], set[str]] = {}
        for name, person in self.people.items():
            for kind, value in person.spellings():
                self.index.setdefault((kind, _same(kind, value)), set()).add(name)
        self.kinds = {kind for kind, _ in self.index}
        for group in groups or ():
            self.index.setdefault(("own", _same("own", group)), set()).add(group)

    def find(
        self, keys: Iterable[tuple[str, str]], place: str = "", numbered_anew: bool = False
    ) -> tuple[str | None, str]:
        """Return the student that a claim's keys mean and how they match, or ``None`` and why not.

        ``place`` is the name of the folder or file, which the roster may list under ``handed in
        as``. With ``numbered_anew``, Moodle's numbers are not those in the roster.
        """
        keys = (
            *(("handed in as", name) for name in (place, PurePosixPath(place).stem) if name),
            *keys,
        )
        surest = ""
        for kind, value in keys:
            if surest not in ("", kind):
                # The roster has the system's IDs, so a name must not overrule one that matches
                # nobody.
                break
            students = self.index.get((kind, _same(kind, value)), set())
            if len(students) == 1:
                return next(iter(students)), WORDS[kind]
            if len({self.group_of.get(name, name) for name in students}) == 1:
                return self.group_of[min(students)], WORDS[kind]
            if students:
                return None, (
                    f"Several students in the roster match: {', '.join(sorted(students))}. If they "
                    "work together, list them under [groups] in term.toml."
                )
            if kind in self.kinds and (
                kind in ("canvas", "canvas anonymous", "gradescope")
                or (kind == "moodle" and not numbered_anew)
            ):
                surest = kind
            if kind == "github" and kind not in self.kinds:
                return None, (
                    "The roster has no column `github`, and a GitHub name alone proves nothing, "
                    "since anybody can choose one."
                )
        claimed = {
            (kind, same.lstrip("0")): same
            for kind, same in ((kind, _same(kind, value)) for kind, value in keys)
        }
        near = [
            value
            for kind, value in sorted(self.index)
            if claimed.get((kind, value.lstrip("0")), value) != value
        ]
        return None, "Nobody in the roster matches." + (
            f" It has {near[0]!r}: a spreadsheet may have removed zeros in front of the IDs."
            if near
            else ""
        )

    def are_a_group(self, people: Iterable[Iterable[tuple[str, str]]]) -> bool:
        """Check whether all people that these keys mean work in one group."""
        names = [self.find(keys)[0] or "" for keys in people]
        groups = {self.group_of.get(name, name) for name in names}
        return len(groups) == 1 and groups <= set(self.group_of.values())

    def identity(self, student: str) -> Identity:
        """Return the student's identity, as a record stores it."""
        if student not in self.people:
            # This is a group.
            return Identity({}, (student,))
        person = self.people[student]
        called = {
            kind: person.called[kind][0]
            for kind in ("canvas", "moodle", "brightspace", "name", "email")
            if person.called.get(kind)
        }
        return Identity(
            called,
            (*person.called.get("own", ()), *((person.local_part,) if person.local_part else ())),
        )


def cells_in(path: Path) -> tuple[list[str], list[tuple[int, list[str]]]]:
    """Return a table's column names in lower case, and the number and cells of each line."""
    data = path.read_bytes()
    encoding, mark = encoding_of(path, data)
    text = data[len(mark) :].decode(encoding, "replace")
    # Split lines only where CSV does. Students choose their names, and with a rarer line separator
    # in them they could begin a line of their own.
    reader = csv.reader(
        io.StringIO(text, newline=""),
        delimiter=max(",;\t", key=text.split("\n", 1)[0].count),
        strict=True,
    )
    rows: list[tuple[int, list[str]]] = []
    try:
        for cells in reader:
            rows.append((reader.line_num, list(map(str.strip, cells))))
    except csv.Error as error:
        line = rows[-1][0] + 1 if rows else 1
        raise BadRoster(
            f"{path}, line {line}: we cannot read this line ({error}). Perhaps a quotation mark "
            "opens a cell there and nothing closes it."
        ) from None
    return [name.casefold() for name in (rows.pop(0)[1] if rows else [])], rows


def _rows(path: Path) -> Iterator[tuple[int, dict[str, str]]]:
    try:
        header, lines = cells_in(path)
    except OSError as error:
        raise BadRoster(f"We cannot read the table {path}: {error.strerror}.") from None
    repeated = [name for name, times in Counter(header).items() if times > 1 and name]
    if repeated:
        raise BadRoster(f"{path}: two columns are called {repeated[0]!r}.")
    english, _ = in_english(header)
    header = [english.get(name, name).replace("’", "'") for name in header]
    for number, cells in lines:
        yield number, dict(zip(header, cells))


def encoding_of(path: Path, data: bytes) -> tuple[str, bytes]:
    """Return the encoding of a table from a spreadsheet or a system, and its byte order mark."""
    if data.startswith((b"PK\x03\x04", b"\xd0\xcf\x11\xe0")):
        raise BadRoster(
            f"{path} is a spreadsheet's own file, such as .xlsx, .xls or .ods. Open it in the "
            "spreadsheet, save it as CSV, and use that file."
        )
    for mark, encoding in (
        (b"\xef\xbb\xbf", "utf-8"),
        (b"\xff\xfe", "utf-16-le"),
        (b"\xfe\xff", "utf-16-be"),
    ):
        if data.startswith(mark):
            return encoding, mark
    try:
        data.decode("utf-8")
        return "utf-8", b""
    except UnicodeDecodeError:
        # This is what spreadsheets on Windows write. It lacks a few bytes.
        return "cp1252", b""


def _called(line: Mapping[str, str]) -> dict[str, tuple[str, ...]]:
    """Return the names and IDs that a row of a roster gives a student, by kind."""
    row = dict(line)
    of_canvas = "section" in row or "sis login id" in row or "sis user id" in row
    if "id" in row and ("student" in row or "lastname" in row) and of_canvas:
        # This is Canvas's gradebook, with the name in one column or in two.
        row["name"], row["canvas"] = row.pop("student", ""), row.pop("id")
        if not row["canvas"]:
            return {}
        if "," in row["name"]:
            row["name"] = turned(row["name"])
    elif "identifier" in row and ("full name" in row or "grade" in row):
        # This is Moodle's worksheet. In blind marking it has nothing but "Participant 17".
        row["moodle"] = re.sub(r"\D", "", row["identifier"])
        if any(row.get(name) for name in ("full name", *COLUMNS["email"], "id number", "username")):
            del row["identifier"]
    elif "id" in row:
        # This is nbgrader's list.
        row.setdefault("student id", row.pop("id"))
    known = {
        kind: [value for name in dict.fromkeys(names) if (value := row.get(name, "").lstrip("#"))]
        for kind, names in COLUMNS.items()
    }
    first, last = (
        next((row[name] for name in names if row.get(name)), "") for names in (FIRST, LAST)
    )
    if first or last:
        known["name"].append(f"{first} {last}".strip())
    known["handed in as"] = [
        part.strip() for value in known["handed in as"] for part in value.split(";")
    ]
    return {kind: tuple(values) for kind, values in known.items() if values}


def local_parts(addresses: Mapping[Key, str]) -> dict[Key, str]:
    """Return the local parts of the addresses in the most frequent domain.

    Anybody can choose an address elsewhere, with a local part that is somebody else's here.

    >>> local_parts({1: 'ann@uni.example', 2: 'bob@uni.example', 3: 'ann@mail.example'})
    {1: 'ann', 2: 'bob'}
    """
    parts = {
        key: address.partition("@")[::2] for key, address in addresses.items() if "@" in address
    }
    places = Counter(place.casefold() for _, place in parts.values()).most_common(1)
    return {key: own for key, (own, place) in parts.items() if place.casefold() == places[0][0]}


def turned(name: str) -> str:
    """Turn ``Last, First`` round; without a comma, move the last word to the front."""
    last, comma, first = name.partition(",")
    if comma:
        return f"{first.strip()} {last.strip()}"
    *before, last = name.split() or [""]
    return " ".join([last, *before])


def _same(kind: str, value: str) -> str:
    """Return one spelling of a value that people write in several ways."""
    value = unicodedata.normalize("NFKC", value).casefold()
    value = "".join(sign for sign in value if unicodedata.category(sign) != "Cf")
    if kind == "letters":
        return "".join(sign for sign in unicodedata.normalize("NFKD", value) if sign.isalnum())
    return " ".join(value.split())
