"""Matching of submitted files to students, by the archives of learning systems and the roster.

The name of a file or folder is only a claim. A learning system writes the beginning of the name;
the student chose the rest, which proves nothing. A roster, where there is one, decides alone. If
two submissions claim to be one student's, we grade neither and ask a person.
"""

import datetime
import os
import re
import unicodedata
from collections.abc import Callable, Collection, Iterable
from pathlib import PurePosixPath
from typing import NamedTuple

from .roster import Roster

# In the part that a system writes, its own separators occur only where it puts them: Moodle leaves
# no underscore in a name, and Canvas no number between two underscores.
CANVAS = re.compile(r"(?P<name>.+?)_(?P<late>LATE_)?(?P<user>\d+)_(?P<submission>\d+)_(?P<file>.+)")
CANVAS_ANONYMOUS = re.compile(
    r"(?P<late>LATE_)?anon_(?P<user>[A-Za-z0-9]{5})_(?P<submission>\d+)_(?P<file>.+)"
)
#: The alternative reading of Canvas's names. Only the roster can tell a person's name that ends in
#: a number from a file's name that begins with one.
CANVAS_NUMBERED = re.compile(
    r"(?P<name>.+?_\d+)_(?P<late>LATE_)?(?P<user>\d+)_(?P<submission>\d+)_(?P<file>.+)"
)
GRADESCOPE = re.compile(r"submission_\d+")
#: Gradescope's table of who handed in which submission.
GRADESCOPE_TABLE = "submission_metadata.yml"
MOODLE = re.compile(
    r"(?P<name>[^_]+)_(?P<user>\d+)_assignsubmission_(?:file|onlinetext)(?:_(?P<file>.*))?"
)
BRIGHTSPACE = re.compile(
    r"(?P<user>\d+)-(?P<folder>\d+) - (?P<name>.+?) - (?P<when>\w{3,9} \d{1,2}, \d{4} "
    r"\d{3,4} [AP]M)"
)
BLACKBOARD = re.compile(r"(?P<who>.+?)_attempt_(?P<when>\d{4}(?:-\d\d){5})(?:_(?P<file>.+)|\.txt)")
RESUBMITTED = re.compile(r"(?P<stem>.+?)-(?P<number>\d{1,3})")
MONTHS = ("jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec")
#: The folders of an nbgrader course. Only ``submitted`` holds students' work.
NBGRADER = {"submitted", "source", "release", "autograded", "feedback"}


#: The parts of a path.
Parts = tuple[str, ...]


class Claim(NamedTuple):
    """The claim that a file's path makes about who handed it in.

    Attributes
    ----------
    student : str
        The student's name, for a person to read. Without a roster it is also their name here.
    keys : tuple of (kind, value)
        What to look the student up by in a roster, the most reliable first.
    source : str
        The same for everything that one student handed in, and different for every other student.
    file : str
        The path of the file as its author named it.
    declared : tuple
        The version that the name declares, as numbers; the greatest is the newest.
    late : bool
    given_by_system : bool
        Whether a learning management system wrote the name.
    handed_in : str
        The time by the system's own clock; empty where the system does not give it.
    reply : str
        The beginning, as the system wrote it, of the name of the file we give back to this student.
    place : str
        The name of the outermost folder or file, as it was handed in.
    others : tuple of tuples of (kind, value)
        For a group's submission, the ``keys`` of each of the other members.
    """

    student: str
    keys: tuple[tuple[str, str], ...]
    source: str
    file: str
    declared: tuple[int, ...] = ()
    late: bool = False
    given_by_system: bool = False
    handed_in: str = ""
    reply: str = ""
    place: str = ""
    others: tuple[tuple[tuple[str, str], ...], ...] = ()


class Layout:
    """The layout of the submissions, deduced from the names of all files.

    All files have the same layout, so that no student can choose another by naming a file or
    folder.

    Parameters
    ----------
    names : list of str
        The paths of all files.
    assignments, repositories : iterable of str
    roster : Roster, optional
    read : function, optional
        Returns the bytes of a file in `names`, for systems that list the owners in a table.
    student : str, optional
        The one student who handed in everything.
    """

    def __init__(
        self,
        names: Collection[str],
        assignments: Iterable[str] = (),
        repositories: Iterable[str] = (),
        roster: Roster | None = None,
        read: Callable[[str], bytes] | None = None,
        student: str | None = None,
    ) -> None:
        self.student = student
        self.assignments = sorted(assignments, key=len, reverse=True)
        self.roster = roster
        self.enclosing: Parts = ()
        notebooks = [
            PurePosixPath(name).parts for name in names if name.lower().endswith((".ipynb", ".zip"))
        ]
        self._strip(notebooks)
        notebooks = [parts[len(self.enclosing) :] for parts in notebooks if self._is_inside(parts)]
        tops = [parts[0] for parts in notebooks]
        self.kind = next(
            (
                kind
                for kind, fits in SYSTEMS
                if 2 * sum(fits(parts) for parts in notebooks) > len(notebooks)
            ),
            "own",
        )
        self.prefix = ""
        table = "/".join([*self.enclosing, GRADESCOPE_TABLE])
        if self.kind == "gradescope" and read is not None and table in names:
            self.submitters = _submitters(read(table))
        elif self.kind == "gradescope":
            self.kind = "own"
        if self.kind == "blackboard":
            # The assignment's name comes first and is the same in all names.
            self.prefix = _shared(
                {match["who"] for top in tops if (match := BLACKBOARD.fullmatch(top))}, "_"
            )
        elif self.kind == "own" and 2 * len(set(tops) & self._inside(repositories)) > len(
            set(tops)
        ):
            # Most folders must be repositories, so that one inside a student's folder changes no
            # names.
            self.prefix = _shared(set(tops), "-")
            self.kind = "github"

    def _strip(self, notebooks: list[Parts]) -> None:
        """Skip a folder that encloses everything, and nbgrader's folders."""
        first = {parts[0] for parts in notebooks if len(parts) > 1}
        if (
            len(first) == 1
            and all(len(parts) > 1 for parts in notebooks)
            and first != {"submitted"}
        ):
            (enclosing,) = first
            inner = [parts[1:] for parts in notebooks]
            inside = {parts[0] for parts in inner}
            known = self.roster is not None and self.roster.find(_own(enclosing))[0] is not None
            # A folder whose name a system wrote for one person does not enclose other people's
            # work, whatever it contains.
            known = known or any(fits((enclosing, "")) for _, fits in SYSTEMS)
            if not known and (
                inside <= NBGRADER
                or any(2 * sum(map(fits, inner)) > len(inner) for _, fits in SYSTEMS)
                or (
                    len(inside) > 1
                    and all(len(parts) > 1 for parts in inner)
                    and not inside <= set(self.assignments)
                )
            ):
                self.enclosing = (enclosing,)
                notebooks, first = inner, inside
        if "submitted" in first and first <= NBGRADER:
            self.enclosing += ("submitted",)
        #: Whether nbgrader collected the submissions. It keeps the time of each in a file.
        self.is_nbgraders = self.enclosing[-1:] == ("submitted",)

    def _inside(self, folders: Iterable[str]) -> set[str]:
        """Return the names of those folders that lie beside the students' own."""
        all_parts = [PurePosixPath(folder).parts for folder in folders]
        return {parts[-1] for parts in all_parts if parts and parts[:-1] == self.enclosing}

    def _is_inside(self, parts: Parts) -> bool:
        return len(parts) > len(self.enclosing) and parts[: len(self.enclosing)] == self.enclosing

    def claim(self, name: str) -> Claim | None:
        """Return the claim of a file, or ``None`` for a file outside the submissions."""
        parts = PurePosixPath(name).parts
        if not self._is_inside(parts):
            return None
        parts = parts[len(self.enclosing) :]
        read, pattern = getattr(self, f"_{self.kind}"), PATTERNS.get(self.kind)
        match = pattern.fullmatch(parts[0]) if pattern else None
        claim: Claim | None = (match and read(parts, match)) if pattern else read(parts)
        if claim and self.student is not None and self.kind == "own":
            claim = claim._replace(source=f"all of {self.student}", file="/".join(parts))
        return claim and claim._replace(place=parts[0])

    def is_beside_submissions(self, name: str) -> bool:
        """Check whether a file is in one of nbgrader's folders beside ``submitted``."""
        parts = PurePosixPath(name).parts
        return (
            self.is_nbgraders
            and len(parts) > 1
            and not self._is_inside(parts)
            and parts[len(self.enclosing) - 1] in NBGRADER
        )

    # -- one method for each system: a name that does not fit claims nothing. If all names of a
    # system have one pattern, its method also receives the match.

    def _canvas(self, parts: Parts) -> Claim | None:
        kind, match = self._read_as_canvas(parts[0])
        if not match:
            return None
        again = RESUBMITTED.fullmatch(PurePosixPath(match["file"]).stem)
        number = int(again["number"]) if again else 0
        name = "anonymous" if kind == "canvas anonymous" else _clean(match["name"])
        keys = ((kind, match["user"]),) + ((("letters", name),) if kind == "canvas" else ())
        return Claim(
            f"{name}_{match['user']}",
            keys,
            f"{kind} {match['user']}" + (f" {name}" if kind == "canvas" else ""),
            _inside(parts, match["file"]),
            (number,),
            bool(match["late"]),
            True,
            reply=_before_the_file(match),
        )

    def _read_as_canvas(self, name: str) -> tuple[str, re.Match[str] | None]:
        """Read a name that Canvas wrote; ``None`` if it is ambiguous even by the roster."""
        anonymous = CANVAS_ANONYMOUS.fullmatch(name)
        if anonymous:
            return "canvas anonymous", anonymous
        readings = [
            match for match in (CANVAS.fullmatch(name), CANVAS_NUMBERED.fullmatch(name)) if match
        ]
        roster = self.roster
        people = [
            roster.find((("canvas", match["user"]),))[0] if roster else None for match in readings
        ]
        if roster and len(readings) == 2 and people[1] is not None:
            readings = [
                match
                for match, student in zip(readings, people, strict=True)
                if student is not None
                and roster.find((("letters", _clean(match["name"])),))[0] == student
            ]
            return ("canvas", readings[0]) if len(readings) == 1 else ("canvas", None)
        return "canvas", readings[0] if readings else None

    def _gradescope(self, parts: Parts) -> Claim | None:
        known = self.submitters.get(parts[0])
        if known is None:
            return None
        people, when = known
        # The ID or address comes from the course, but people can change their names.
        keys, *others = (
            (*(("gradescope", own) for own in numbers), ("name", name)) for name, numbers in people
        )
        return Claim(
            _clean(keys[0][1]),
            keys,
            f"gradescope {parts[0]}",
            _inside(parts),
            given_by_system=True,
            handed_in=when,
            reply=f"{parts[0]}/",
            others=tuple(others),
        )

    def _moodle(self, parts: Parts, match: re.Match[str]) -> Claim:
        name, user = _clean(match["name"]), match["user"]
        return Claim(
            f"{name} {user}",
            (("moodle", user), ("name", name)),
            f"moodle {user} {name}",
            _inside(parts, match["file"]),
            given_by_system=True,
            reply=_before_the_file(match) if match["file"] else f"{parts[0]}/",
        )

    def _brightspace(self, parts: Parts, match: re.Match[str]) -> Claim:
        name, user = _clean(match["name"]), match["user"]
        keys = (("brightspace", user), ("name", name))
        when = _when(match["when"])
        return Claim(
            f"{name} {user}",
            keys,
            f"brightspace {user}",
            _inside(parts),
            when,
            given_by_system=True,
            handed_in=_as_time(when),
            reply=f"{parts[0]}/",
        )

    def _blackboard(self, parts: Parts, match: re.Match[str]) -> Claim:
        user = self._blackboard_user(match["who"])
        when = tuple(map(int, match["when"].split("-")))
        return Claim(
            _clean(user),
            (("own", user),),
            f"blackboard {user}",
            _inside(parts, match["file"]),
            when,
            given_by_system=True,
            handed_in=_as_time(when),
            reply=_before_the_file(match) if match["file"] else f"{PurePosixPath(parts[0]).stem}_",
        )

    def _blackboard_user(self, who: str) -> str:
        """Return the user name, which follows the assignment's name; both may contain underscores.

        If several people of the roster fit, return what matches none of them, so that a person is
        asked.
        """
        if self.roster:
            words = who.split("_")
            ends = ["_".join(words[number:]) for number in range(1, len(words))]
            known = [end for end in ends if self.roster.find((("own", end),))[0] is not None]
            if known:
                return known[0] if len(known) == 1 else who
        # For a single submission we cannot know where the name begins.
        return who.removeprefix(self.prefix)

    def _github(self, parts: Parts) -> Claim | None:
        user = parts[0].removeprefix(self.prefix)
        # Anybody can choose a GitHub name, so match it only with the column `github` of the roster.
        return Claim(
            _clean(user),
            (("github", user),),
            f"repository {parts[0]}",
            _inside(parts),
            reply=f"{parts[0]}/",
        )

    def _own(self, parts: Parts) -> Claim | None:
        if len(parts) > 1:
            return Claim(
                _clean(parts[0]),
                _own(parts[0]),
                f"folder {parts[0]}",
                _inside(parts),
                reply=f"{parts[0]}/",
            )
        stem = PurePosixPath(parts[0]).stem
        for assignment in self.assignments:
            named = re.compile(re.escape(assignment), re.I)
            rest = named.sub("", stem).strip(" _-.()")
            if named.search(stem) and rest:
                # The same name written differently is a separate claim.
                source = f"files {named.sub('*', stem)}"
                return Claim(_clean(rest), _own(rest), source, parts[0], reply=f"{stem}-")
        return Claim(_clean(stem), _own(stem), f"file {stem}", parts[0], reply=f"{stem}-")


def _as_time(numbers: tuple[int, ...]) -> str:
    """Return a date and time in ISO 8601 without a time zone; empty if they are invalid."""
    year, month, day, *clock = numbers
    hour, minute, second, *_ = (*clock, 0, 0, 0)
    try:
        return datetime.datetime(year, month, day, hour, minute, second).isoformat()
    except ValueError:
        return ""


def _before_the_file(match: re.Match[str]) -> str:
    """Return the part of a name that the system wrote, before the student's name of the file."""
    return match.string[: match.start("file")]


def _inside(parts: Parts, first: str | None = None) -> str:
    """Return the path below the system's part; `first` is the student's part of the first name."""
    return "/".join(([first] if first else []) + list(parts[1:]))


def _fits(pattern: re.Pattern[str], in_file: bool = True) -> Callable[[Parts], bool]:
    def fits(parts: Parts) -> bool:
        return bool(pattern.fullmatch(parts[0])) and (in_file or len(parts) > 1)

    return fits


PATTERNS = {"moodle": MOODLE, "brightspace": BRIGHTSPACE, "blackboard": BLACKBOARD}
SYSTEMS: tuple[tuple[str, Callable[[Parts], bool]], ...] = (
    # Canvas hands out only files. A folder with two numbers in its name may be a student's own.
    (
        "canvas",
        lambda parts: (
            len(parts) == 1
            and bool(CANVAS.fullmatch(parts[0]) or CANVAS_ANONYMOUS.fullmatch(parts[0]))
        ),
    ),
    ("moodle", _fits(MOODLE)),
    ("brightspace", _fits(BRIGHTSPACE, in_file=False)),
    ("blackboard", _fits(BLACKBOARD)),
    ("gradescope", _fits(GRADESCOPE, in_file=False)),
)


def _submitters(data: bytes) -> dict[str, tuple[list[tuple[str, list[str]]], str]]:
    """Return the people (names, IDs, addresses) and the time of each Gradescope submission."""
    import yaml

    try:
        listed = yaml.safe_load(data)
    except (yaml.YAMLError, ValueError):
        return {}
    by_folder = {}
    for folder, about in listed.items() if isinstance(listed, dict) else ():
        submitters = about.get(":submitters") if isinstance(about, dict) else None
        people = []
        for person in submitters if isinstance(submitters, list) else ():
            called = person if isinstance(person, dict) else {}
            name, *own = (str(called.get(f":{key}") or "") for key in ("name", "sid", "email"))
            people.append((name, list(filter(None, own))))
        when = about.get(":created_at") if people else None
        time = when.isoformat() if isinstance(when, datetime.datetime) else ""
        if people and all(name or own for name, own in people):
            by_folder[str(folder)] = people, time
    return by_folder


def _own(name: str) -> tuple[tuple[str, str], ...]:
    # The last name may come first, and signs may separate the parts.
    return ("own", name), ("name", name), ("letters", name)


def _shared(names: set[str], end: str) -> str:
    """Return the beginning that all names share, up to `end`; empty if there is only one name."""
    if len(names) < 2:
        return ""
    shared = os.path.commonprefix(sorted(names))
    return shared[: shared.rfind(end) + 1]


def _clean(name: str) -> str:
    """Return a name in one spelling and of a sensible length."""
    return " ".join(unicodedata.normalize("NFC", name).split())[:120] or "without a name"


#: Lower-case Cyrillic and Greek letters that look like Latin ones and that a keyboard can type,
#: from the table of confusables in Unicode Technical Standard 39.
LOOK_ALIKES = str.maketrans(
    dict(
        zip(
            "\u0430\u0432\u0435\u043d\u043a\u043c\u043e\u0440\u0441\u0442\u0443\u0445",
            "abehkmopctyx",
            strict=True,
        )
    )
    | dict(zip("\u0456\u0458\u0455\u0501\u04bb\u051b\u051d\u04cf", "ijsdhqwl", strict=True))
    | dict(
        zip(
            "\u03b1\u03b2\u03b5\u03b6\u03b7\u03b9\u03ba\u03bc\u03bd\u03bf\u03c1\u03c4\u03c5\u03c7",
            "abezhikmnoptyx",
            strict=True,
        )
    )
    | {"\u0131": "i"}
)


#: Invisible characters that are neither control nor format characters: joiners, fillers, variation
#: selectors and the empty Braille pattern.
UNSEEN = frozenset(
    map(
        chr,
        (
            0x034F,
            0x115F,
            0x1160,
            0x17B4,
            0x17B5,
            *range(0x180B, 0x1810),
            0x2800,
            *range(0xFE00, 0xFE10),
        ),
    )
) | frozenset(map(chr, range(0xE0100, 0xE01F0)))


def looks_like(name: str) -> str:
    """Reduce a name to what it looks like, so that look-alikes compare equal.

    Wide letters become narrow, capitals small, and letters of other scripts the Latin ones that
    they resemble. Invisible characters go, and so do dots and spaces at either end, which may get
    lost.
    """
    plain = unicodedata.normalize("NFKC", unicodedata.normalize("NFKC", name).casefold())
    seen = "".join(
        sign
        for sign in plain
        if unicodedata.category(sign) not in ("Cf", "Cc") and sign not in UNSEEN
    )
    return seen.translate(LOOK_ALIKES).strip(" .")


def _when(text: str) -> tuple[int, ...]:
    """Return the numbers of Brightspace's ``Nov 21, 2026 801 PM``, English in all languages."""
    month, day, year, clock, half = text.replace(",", "").split()
    number = MONTHS.index(month[:3].lower()) + 1 if month[:3].lower() in MONTHS else 0
    hour = int(clock[:-2]) % 12 + (12 if half == "PM" else 0)
    return int(year), number, int(day), hour, int(clock[-2:])
