"""Strict, read-only collection of submitted notebooks from a folder or an archive.

We read a folder of notebooks, a folder for each student, nbgrader's
``submitted/student/assignment``, repositories of GitHub Classroom, and the archives (packed or
unpacked) of Canvas, Moodle, Brightspace, Blackboard and Gradescope. Each may contain archives that
students packed. Strangers named and wrote everything here, so we refuse whatever is not an honest
notebook, by name and with a reason, and go on with the rest. We follow no link, unpack nothing on
disk and repair nothing. `coursework.grading.submissions.identity` determines whose each file is.
"""

import base64
import codecs
import contextlib
import datetime
import functools
import hashlib
import io
import json
import os
import re
import stat
import zipfile
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath
from typing import NamedTuple, TypedDict

from ...checking.fields import by_name, many
from ..reading import AsJson
from ..record import Identity, Remembered
from ..store import REFUSED, Store
from .identity import GRADESCOPE_TABLE, RESUBMITTED, Claim, Layout, looks_like
from .pictures import JPEG, PNG, is_picture
from .roster import Roster

#: A function that returns the bytes of a file.
Read = Callable[[], bytes]
#: The time of a file. The greatest is the newest.
When = int | tuple[int, ...]
#: A file's name, its time, and a function that reads it.
Found = tuple[str, When, Read]
#: The files that are not notebooks, each with its claim and its name, by the source of the claim.
Others = dict[str | None, list[tuple[Claim | None, str, Read]]]

# The most bytes of one notebook.
MOST_BYTES = 20 << 20
MOST_CELLS = 1_000
# The most characters in the code cells of one notebook.
MOST_CODE = 1 << 20
MOST_FILES = 200_000
# The most values in the JSON of one notebook. Each takes up to a hundred bytes of memory.
MOST_VALUES = 1_000_000
# The most files beside one notebook, and the most bytes of these together.
MOST_BESIDE, MOST_BYTES_BESIDE = 50, 8 << 20
# The deepest nesting of folders.
DEEPEST = 10
# The most bytes of all files of one archive, unpacked.
MOST_UNPACKED = 4 << 30
TOO_LARGE = "The archive unpacks to more than 4 GB. We did not read this file."

#: Files that systems and browsers leave behind; no student handed them in.
LITTER = (
    ".git",
    "__MACOSX",
    ".DS_Store",
    "Thumbs.db",
    "desktop.ini",
    ".ipynb_checkpoints",
    ".coursework",
    "__pycache__",
)
#: Archives that we do not open: those of other kinds, and those inside a student's archive.
ARCHIVES = (".zip", ".rar", ".7z", ".tar", ".gz", ".tgz", ".bz2", ".xz")
# Files that Brightspace, nbgrader and Gradescope add.
INDEXES = ("index.html", "timestamp.txt", GRADESCOPE_TABLE)
TEXT = re.compile(rb'"(?:[^"\\]|\\.)*+"', re.S)
REPLY = re.compile(r'<div class="coursework-reply"([^>]{0,2000})>')
ABOUT_REPLY = re.compile(r'\bdata-(question|tries|help)="([^"]{1,200})"')
#: The most bytes of pictures that we show from one notebook.
MOST_BYTES_OF_PICTURES = 4 << 20
MARKDOWN = "text/markdown"
CHECK = re.compile(r"""\bcheck\(\s*['"]([^'"\n]{1,200})['"]""")


#: The call by which a notebook names its student, to get that student's numbers.
SAYS = re.compile(
    r"""^[^#\n]*?\b(?:me|student)\(\s*(?P<mark>['"])(?P<who>[^'"\n]{1,200})(?P=mark)\s*,?\s*\)""",
    re.M,
)


def bare(source: str) -> str:
    """Return code without comments and blanks, which changes only when the code itself does."""
    return re.sub(r"\s+", "", re.sub(r"#[^\n]*", "", source))


class CodeCell(TypedDict):
    """A code cell, as it was handed in."""

    source: str
    execution_count: int | None


@dataclass(frozen=True, order=True)
class Refused(AsJson):
    """A submitted file that is not graded, and the reason."""

    file: str
    student: str
    why: str


def refused_of(store: Store) -> list[Refused]:
    """Return all refused files of all submitted folders."""
    known = store.said(REFUSED, by_name(many(Refused.from_json))) or {}
    return [file for place in known.values() for file in place]


class Beside(NamedTuple):
    """A file that was handed in beside a notebook, for its code to read."""

    name: str
    digest: str
    read: Read


class Notebook(NamedTuple):
    """A submitted notebook. Its cells are read on demand, so a large class needs little memory.

    Attributes
    ----------
    file : str
        Its path in the submissions, as it was named.
    student : str
        Who handed it in: by the roster, or as far as the file's name or folder shows.
    identity : Identity
        The IDs and names by which a learning management system knows the student.
    matched : str
        How it was matched to the student.
    digest : str
        SHA-256 of the bytes that were read.
    named : list of str
        The names in its calls of ``check``, and nbgrader's names of its cells.
    folder : str
        The folder it lies in, which may be named after its assignment.
    order : tuple
        What the name declares, then the time of the file. The greatest is the newest.
    late : bool
    claim : Claim
    read : function
        Returns its bytes.
    beside : tuple of Beside
    handed_in : str
        The time in ISO 8601, as the system gives it; without a time zone if the system gives none.
    says : str
        The student whose numbers its questions use, as the notebook says; empty if it does not.
    of_assignment : str
        The folder of an assignment in which nbgrader collected it; empty elsewhere.
    """

    file: str
    student: str
    identity: Identity
    matched: str
    digest: str
    named: list[str]
    folder: str
    order: tuple[tuple[int, ...], When]
    late: bool
    claim: Claim
    read: Read
    beside: tuple[Beside, ...] = ()
    handed_in: str = ""
    says: str = ""
    of_assignment: str = ""

    @property
    def cells(self) -> list[CodeCell]:
        """The code cells.

        Raises
        ------
        Unfit
            It was changed or removed since we first read it.
        """
        return read_notebook(_unchanged(self))[0]

    @property
    def remembered(self) -> dict[str, Remembered]:
        """The tries and help that its outputs remember for each question: see `remembered_in`."""
        return remembered_in(_unchanged(self))

    @property
    def pictures(self) -> dict[str, list[str]]:
        """The pictures in its outputs: see `pictures_in`."""
        return pictures_in(_unchanged(self))

    def shows(self, text: str) -> bool:
        """Check whether one of its outputs shows this text as Markdown."""
        for _, shown in outputs_in(_unchanged(self)):
            with contextlib.suppress(Unfit):
                if text in _source(shown.get(MARKDOWN, "")):
                    return True
        return False

    @property
    def files(self) -> dict[str, bytes]:
        """The bytes of the files beside it, by name."""
        return {file.name: _unchanged(file) for file in self.beside}


def _unchanged(file: Beside | Notebook) -> bytes:
    data = file.read()
    if hashlib.sha256(data).hexdigest() != file.digest:
        raise Unfit("It changed while we were grading the class.")
    return data


class Unfit(ValueError):
    """An error for a file that cannot be graded; the message gives the reason."""


def take_in(
    path: str | os.PathLike[str],
    assignments: Iterable[str] = (),
    roster: Roster | None = None,
    student: str | None = None,
    out: str | Path | None = None,
) -> tuple[list[Notebook], list[Refused]]:
    """Read everything that was handed in.

    Parameters
    ----------
    path : path
        A folder, a zip archive or one notebook.
    assignments : iterable of str
        Names of assignments, to tell a student's name from an assignment's in the name of a file.
    roster : Roster, optional
        The people in the course. We refuse a file that matches nobody or several people, so that a
        person decides whose it is.
    student : str, optional
        The one student who handed in everything.
    out : path, optional
        The folder of results, which is never read as a submission.

    Returns
    -------
    notebooks : list of Notebook
    refused : list of Refused
    """
    candidates: list[Notebook] = []
    refused: list[Refused] = []
    files: list[Found] = []
    repositories: set[str] = set()
    for name, when, read in _files(os.fspath(path), refused, repositories, out):
        if len(files) >= MOST_FILES:
            refused.append(
                Refused(
                    name,
                    "",
                    f"There are more than {MOST_FILES} files. We did not look at the rest.",
                )
            )
            break
        files.append((ADDED.sub("", name), when, read))
    contents = {name: read for name, _, read in files}
    layout = Layout(
        list(contents), assignments, repositories, roster, lambda name: contents[name](), student
    )
    others: Others = {}
    for name, when, read in files:
        if name.lower().endswith(".zip"):
            for inner, data in _inside_archive(name, read, refused):
                _take(candidates, others, refused, layout, ADDED.sub("", inner), when, data, name)
        else:
            _take(candidates, others, refused, layout, name, when, read, name)
    have = {notebook.claim.source for notebook in candidates}
    # Moodle numbers the participants of each assignment anew. A number that matches nobody, beside
    # others that match, belongs to somebody who is not in the roster.
    numbered_anew = roster is not None and not any(
        key[0] == "moodle" and key in roster.index
        for claim in map(layout.claim, contents)
        for key in (claim.keys if claim else ())
    )
    notebooks: list[Notebook] = []
    for submitted in candidates:
        if notebook := _with_student(submitted, roster, student, refused, numbered_anew):
            beside, handed_in = _beside(notebook, others), _when(notebook, others, layout)
            notebooks.append(notebook._replace(beside=beside, handed_in=handed_in))
    notebooks = _without_conflicts(notebooks, roster, refused)
    for source, files_of_source in others.items():
        for claim, name, _ in files_of_source:
            if PurePosixPath(name).name in INDEXES or layout.is_beside_submissions(name):
                continue
            # Blackboard writes a text file about each attempt, which nobody handed in.
            of_system = claim and claim.given_by_system and not claim.file
            if not (of_system or _is_by_the_way(name)) or (claim and source not in have):
                whose = claim.student if claim else ""
                why = (
                    "We do not open this archive. Unpack it into the student's folder."
                    if name.lower().endswith(ARCHIVES)
                    else "Not a notebook: its name does not end in .ipynb."
                )
                can = " The notebook in the same folder can read it." if source in have else ""
                refused.append(Refused(name, whose, why + can))
    return notebooks, [_of_whom(file, layout, roster, numbered_anew) for file in refused]


#: The ending that a browser adds to notebooks when it does not know their type.
ADDED = re.compile(r"(?<=\.ipynb)\.(?:txt|json)$", re.IGNORECASE)


def _of_whom(
    refused: Refused, layout: Layout, roster: Roster | None, numbered_anew: bool
) -> Refused:
    """Name a refused file's student by the roster, so that their work does not seem missing."""
    claim = layout.claim(refused.file)
    known = roster.find(claim.keys, claim.place, numbered_anew)[0] if roster and claim else None
    return refused if known is None else replace(refused, student=known)


#: nbgrader's file beside a submission. Its time zone is UTC unless the course changed that.
TIMESTAMP = "timestamp.txt"


def _when(notebook: Notebook, others: Others, layout: Layout) -> str:
    """Return the system's time of a submission, never that of a student's file; empty if none."""
    if notebook.claim.handed_in or not layout.is_nbgraders:
        return notebook.claim.handed_in
    place = PurePosixPath(
        *PurePosixPath(notebook.file).parts[: len(layout.enclosing) + 2], TIMESTAMP
    )
    for _, name, read in others.get(notebook.claim.source, ()):
        if PurePosixPath(name) == place:
            with contextlib.suppress(Unfit, UnicodeDecodeError):
                return as_time(read()[:200].decode("utf8").strip()) or ""
    return ""


#: The formats of times of nbgrader, Moodle in English and spreadsheets, also German ones.
FORMATS = (
    "%Y-%m-%d %H:%M:%S.%f",
    "%A, %d %B %Y, %I:%M %p",
    "%A, %B %d, %Y, %I:%M %p",
    "%A, %d %B %Y, %H:%M",
    "%d.%m.%Y %H:%M",
    "%d.%m.%Y %H:%M:%S",
)


def as_time(text: str) -> str | None:
    """Return a system's time in ISO 8601, or ``None`` if it is not a time.

    >>> as_time("2026-11-21 20:01:00.5 UTC"), as_time("Saturday, 21 November 2026, 8:01 PM")
    ('2026-11-21T20:01:00.500000+00:00', '2026-11-21T20:01:00')
    >>> as_time("21.11.2026 20:01"), as_time("21.11.2026 20:01:30")
    ('2026-11-21T20:01:00', '2026-11-21T20:01:30')
    """
    bare = text.strip()
    zone = next((zone for zone in (" UTC", " GMT") if bare.endswith(zone)), "")
    bare = bare.removesuffix(zone)
    for read in (
        datetime.datetime.fromisoformat,
        *(lambda text, form=form: datetime.datetime.strptime(text, form) for form in FORMATS),
    ):
        with contextlib.suppress(ValueError):
            moment = read(bare)
            return (moment.replace(tzinfo=datetime.UTC) if zone else moment).isoformat()
    return None


def _take(
    candidates: list[Notebook],
    others: Others,
    refused: list[Refused],
    layout: Layout,
    name: str,
    when: When,
    read: Read,
    outer: str,
) -> None:
    """Read one file; `outer`, its own name or its archive's, determines whose it is."""
    claim = layout.claim(outer)
    if name != outer and claim:
        claim = claim._replace(file=name.removeprefix(f"{outer}/"))
    if not name.lower().endswith(".ipynb"):
        others.setdefault(claim.source if claim else None, []).append((claim, name, read))
        return
    if claim is None:
        if not layout.is_beside_submissions(name):
            why = "Its name does not say whose it is, although the other names do."
            refused.append(Refused(name, "", why))
        return
    try:
        data = read()
        cells, grade_ids = read_notebook(data)
    except Unfit as error:
        refused.append(Refused(name, claim.student, str(error)))
        return
    named = sorted(
        {*(checked for cell in cells for checked in CHECK.findall(cell["source"])), *grade_ids}
    )
    candidates.append(
        Notebook(
            name,
            claim.student,
            Identity(),
            "",
            hashlib.sha256(data).hexdigest(),
            named,
            PurePosixPath(name).parent.name,
            (claim.declared, when),
            claim.late,
            claim,
            read,
            says=_says(cells),
            of_assignment=PurePosixPath(claim.file).parent.name if layout.is_nbgraders else "",
        )
    )


def _says(cells: Iterable[CodeCell]) -> str:
    """Return the student that a notebook names last; empty if it names none."""
    said = [
        match["who"]
        for cell in cells
        for match in SAYS.finditer(cell["source"])
        if match["who"].strip()
    ]
    return said[-1] if said else ""


def _with_student(
    notebook: Notebook,
    roster: Roster | None,
    student: str | None,
    refused: list[Refused],
    numbered_anew: bool,
) -> Notebook | None:
    """Return the notebook with its student, or ``None`` if nobody knows whose it is."""
    known = {
        kind: value
        for kind, value in notebook.claim.keys
        if kind in ("canvas", "moodle", "brightspace", "name")
    }
    if "letters" in dict(notebook.claim.keys):
        known["name"] = dict(notebook.claim.keys)["letters"]
    if student is not None:
        identity = roster.identity(student) if roster else Identity()
        return notebook._replace(student=student, matched="as you said", identity=identity)
    people = notebook.claim.keys, *notebook.claim.others
    if notebook.claim.others and not (roster and roster.are_a_group(people)):
        refused.append(Refused(notebook.file, notebook.claim.student, NO_GROUP))
        return None
    if roster is None:
        identity = Identity(known if notebook.claim.given_by_system else {})
        return notebook._replace(matched="as its name or folder says", identity=identity)
    owner, how = roster.find(notebook.claim.keys, notebook.claim.place, numbered_anew)
    if owner is None:
        refused.append(
            Refused(notebook.file, notebook.claim.student, f"{how} Whose is it? {NOT_MATCHED}")
        )
        return None
    identity = roster.identity(owner)
    return notebook._replace(
        student=owner,
        matched=how,
        identity=Identity(
            {
                **known,
                **identity.called,
                # The assignment's own numbers are those in its table of times.
                **{key: known[key] for key in ("moodle",) if numbered_anew and key in known},
            },
            identity.own,
        ),
    )


NO_GROUP = (
    "Several students handed this in together, but they are not a group in term.toml. Add them "
    "under [groups], such as team-1 = ['ada', 'ben']."
)
CLAIMED_TWICE = "We graded neither. Whose are they? Remove one, or give it its owner's name."
NOT_MATCHED = "In the roster, write the name of its folder or file in a column `handed in as`."


def _without_conflicts(
    notebooks: Sequence[Notebook], roster: Roster | None, refused: list[Refused]
) -> list[Notebook]:
    """Leave out all notebooks of a student whom two submissions claim: one may be a classmate's."""
    claimed: dict[str | tuple[str, str], list[Notebook]] = {}
    for notebook in notebooks:
        for identity in _identities(notebook, roster):
            claimed.setdefault(identity, []).append(notebook)
    unsure: dict[str, set[str]] = {}
    for claims in claimed.values():
        sources = {notebook.claim.source for notebook in claims}
        for notebook in claims if len(sources) > 1 else ():
            unsure.setdefault(notebook.student, set()).update(sources)
    for notebook in notebooks:
        if notebook.student in unsure:
            those = ", ".join(sorted(unsure[notebook.student]))
            why = f"Two submissions claim to be this student's: {those}. {CLAIMED_TWICE}"
            refused.append(Refused(notebook.file, notebook.student, why))
    return [notebook for notebook in notebooks if notebook.student not in unsure]


def _identities(notebook: Notebook, roster: Roster | None) -> tuple[str | tuple[str, str], ...]:
    """Return the identities that a notebook claims; none if the person who grades has named it."""
    if notebook.matched == "as you said":
        return ()
    # Without a roster, names that look the same or differ only in capitals are the same claim. A
    # roster tells such names apart.
    name = looks_like(notebook.student) if roster is None else notebook.student
    return name, *_numbers(notebook.claim)


def _numbers(claim: Claim) -> list[tuple[str, str]]:
    """Return the system's own ID of a student, which it never gives to two people."""
    return [
        key
        for key in claim.keys
        if claim.given_by_system and key[0] in ("canvas", "moodle", "brightspace")
    ]


def _beside(notebook: Notebook, others: Others) -> tuple[Beside, ...]:
    """Return the files in the notebook's folder or below, by the names that its code would use."""
    files: list[Beside] = []
    folder, total = PurePosixPath(notebook.claim.file).parent, 0
    for claim, _, read in others.get(notebook.claim.source, ()):
        name = PurePosixPath(claim.file if claim else "")
        if not name.is_relative_to(folder) or name == folder:
            continue
        try:
            data = read()
        except Unfit:
            continue
        total += len(data)
        if len(files) >= MOST_BESIDE or total > MOST_BYTES_BESIDE:
            break
        files.append(Beside(str(name.relative_to(folder)), hashlib.sha256(data).hexdigest(), read))
    if notebook.claim.source.startswith("canvas "):
        files += _as_named_before(files)
    return tuple(sorted(files))


def _as_named_before(files: Sequence[Beside]) -> list[Beside]:
    """List files that Canvas renamed on resubmission by their old names, which the code uses."""
    numbered: dict[str, list[tuple[int, Beside]]] = {}
    names = {file.name for file in files}
    for file in files:
        path = PurePosixPath(file.name)
        again = RESUBMITTED.fullmatch(path.stem)
        if again and (bare := str(path.with_name(again["stem"] + path.suffix))) not in names:
            numbered.setdefault(bare, []).append((int(again["number"]), file))
    return [
        max(several, key=lambda entry: entry[0])[1]._replace(name=bare)
        for bare, several in numbered.items()
    ]


# --- finding the files --------------------------------------------------------------------------


class _Folder:
    """A folder, held open for as long as anybody may read from it."""

    def __init__(self, path: str) -> None:
        self.handle = os.open(path, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)

    def __del__(self) -> None:
        os.close(self.handle)


def _files(
    path: str, refused: list[Refused], repositories: set[str], out: str | Path | None = None
) -> Iterator[Found]:
    """Iterate in a fixed order over the name of each file, its time and a function that reads it.

    Add the names of folders that are Git repositories to ``repositories``.
    """
    if os.path.isdir(path):
        yield from _files_of_folder(path, refused, repositories, out)
    elif zipfile.is_zipfile(path):
        yield from _files_of_archive(path, refused, repositories)
    elif path.lower().endswith(".zip") and os.path.exists(path):
        raise Unfit(f"{path} is not a zip archive, or it is damaged.")
    elif os.path.exists(path):
        folder, name = os.path.split(os.path.abspath(path))
        held = _Folder(folder)
        yield name, os.stat(path).st_mtime_ns, lambda: _read_file(name, held.handle)
    else:
        raise Unfit(f"{path} does not exist.")


def _files_of_folder(
    root: str, refused: list[Refused], repositories: set[str], out: str | Path | None = None
) -> Iterator[Found]:
    results = os.stat(out) if out and os.path.isdir(out) else None
    if results and os.path.samestat(results, os.stat(root)):
        raise Unfit(f"{root} contains the submissions. Choose a different folder for the results.")
    # Open by handles of folders, so that a folder exchanged for a link meanwhile leads nowhere.
    top = _Folder(root)
    for folder, folders, files, handle in os.fwalk(".", dir_fd=top.handle, follow_symlinks=False):
        folders.sort()
        inside = os.path.normpath(folder)
        if ".git" in folders:
            repositories.add(_text(inside))
        for name in sorted(files + folders):
            full = name if inside == "." else f"{inside}/{name}"
            if _is_litter(full):
                continue
            try:
                about = os.stat(name, dir_fd=handle, follow_symlinks=False)
            except OSError as error:
                refused.append(Refused(_text(full), "", f"We cannot read it: {error.strerror}."))
                continue
            if stat.S_ISLNK(about.st_mode):
                refused.append(Refused(_text(full), "", "This is a link, which we did not follow."))
            elif stat.S_ISREG(about.st_mode):
                yield _text(full), about.st_mtime_ns, functools.partial(_read_below, top, full)
            elif results and os.path.samestat(results, about):
                folders.remove(name)
            elif not stat.S_ISDIR(about.st_mode):
                refused.append(Refused(_text(full), "", "This is a device or a pipe, not a file."))
        folders[:] = [name for name in folders if not _is_litter(name)]
        if folders and inside.count("/") >= DEEPEST:
            refused.append(Refused(_text(inside), "", "Its folders are nested too deeply."))
            folders.clear()


def _text(name: str) -> str:
    """Return a file's name as printable text, in which bytes that are not UTF-8 are escaped."""
    return os.fsencode(name).decode("utf8", "backslashreplace")


def _is_litter(name: str) -> bool:
    return any(part in LITTER or part.startswith(("._", ".~")) for part in name.split("/"))


def _read_below(top: _Folder, name: str) -> bytes:
    """Open a file's folders one by one, following no link, and read it."""
    with contextlib.ExitStack() as stack:
        handle = top.handle
        *folders, last = name.split("/")
        for folder in folders:
            try:
                handle = os.open(
                    folder,
                    os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC,
                    dir_fd=handle,
                )
            except OSError as error:
                raise Unfit(f"We cannot read it: {error.strerror}.") from None
            stack.callback(os.close, handle)
        return _read_file(last, handle)


def _read_file(name: str, folder: int) -> bytes:
    try:
        # Do not block if the file was replaced by a named pipe that nobody writes to.
        handle = os.open(
            name, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC, dir_fd=folder
        )
    except OSError as error:
        raise Unfit(f"We cannot read it: {error.strerror}.") from None
    with open(handle, "rb") as file:
        if not stat.S_ISREG(os.fstat(handle).st_mode):
            raise Unfit("This is not a regular file.")
        return _no_more_than(file.read(MOST_BYTES + 1))


def _no_more_than(data: bytes) -> bytes:
    if len(data) > MOST_BYTES:
        raise Unfit(f"It is larger than {MOST_BYTES >> 20} MB.")
    return data


def _files_of_archive(path: str, refused: list[Refused], repositories: set[str]) -> Iterator[Found]:
    path = os.path.abspath(path)
    # Another archive may have replaced the one at this path.
    _archive.cache_clear()
    try:
        entries = _entries(_archive(path, os.getpid()))
    except (zipfile.BadZipFile, NotImplementedError, ValueError) as error:
        raise Unfit(f"{path} is not a zip archive, or it is damaged ({error}).") from None
    repositories.update(
        entry.filename.partition("/.git/")[0] for entry in entries if "/.git/" in entry.filename
    )
    unpacked = 0
    for shown, entry in _readable(entries, refused):
        unpacked += entry.file_size
        if unpacked > MOST_UNPACKED:
            refused.append(Refused(shown, "", TOO_LARGE))
        else:
            yield shown, entry.date_time, functools.partial(_read_of_class, path, entry)


@functools.lru_cache(1)
def _archive(path: str, process: int) -> zipfile.ZipFile:
    """Open an archive for this process; two sharing a handle would move each other's position."""
    return zipfile.ZipFile(path)


def _read_of_class(path: str, entry: zipfile.ZipInfo) -> bytes:
    return _read_entry(_archive(path, os.getpid()), entry)


def _entries(archive: zipfile.ZipFile) -> list[zipfile.ZipInfo]:
    """Return the entries of an archive, sorted by name.

    Each name can be encoded and has slashes between folders, although PowerShell 5 and other
    Windows programs write backslashes.
    """
    for entry in archive.infolist():
        name = entry.filename.replace("\\", "/")
        entry.filename = name.encode("utf8", "backslashreplace").decode("utf8")
    return sorted(archive.infolist(), key=lambda entry: entry.filename)


def _readable(
    entries: list[zipfile.ZipInfo], refused: list[Refused], folder: str = ""
) -> Iterator[tuple[str, zipfile.ZipInfo]]:
    """Iterate over the readable files of an archive, with the names under which we report them."""
    names = Counter(entry.filename for entry in entries)
    for entry in entries:
        if entry.is_dir() or _is_litter(entry.filename):
            continue
        shown, why = folder + entry.filename, _why_not_unpacked(entry)
        if names[entry.filename] > 1:
            why = "The archive contains this name more than once."
        if why:
            refused.append(Refused(shown, "", why))
        else:
            yield shown, entry


def _why_not_unpacked(entry: zipfile.ZipInfo) -> str:
    name = entry.filename
    if name.startswith("/") or ".." in name.split("/") or re.match(r"[A-Za-z]:", name):
        return "Its path leads out of the archive."
    if stat.S_ISLNK(entry.external_attr >> 16):
        return "This is a link, which we did not follow."
    if entry.flag_bits & 1:
        return "It is encrypted with a password."
    if entry.file_size > MOST_BYTES:
        return f"It is larger than {MOST_BYTES >> 20} MB."
    return ""


def _read_entry(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> bytes:
    try:
        with archive.open(entry) as file:
            # The declared size may be false.
            return _no_more_than(file.read(MOST_BYTES + 1))
    # Each way of packing has errors of its own.
    except Exception as error:
        raise Unfit(f"We cannot unpack it: {str(error)[:100]}") from None


def _inside_archive(name: str, read: Read, refused: list[Refused]) -> Iterator[tuple[str, Read]]:
    """Iterate over the files of a student's archive: their names, and functions that read them."""
    try:
        data = read()
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            entries = _entries(archive)
    except (Unfit, zipfile.BadZipFile, OSError, ValueError, NotImplementedError) as error:
        refused.append(Refused(name, "", f"We cannot read this archive: {str(error)[:100]}"))
        return
    if len(entries) > MOST_BESIDE or sum(entry.file_size for entry in entries) > MOST_BYTES:
        refused.append(Refused(name, "", "This archive is too large for a student's work."))
        return
    for inner, entry in _readable(entries, refused, f"{name}/"):
        yield inner, functools.partial(_read_packed, read, entry)


def _read_packed(read: Read, entry: zipfile.ZipInfo) -> bytes:
    with zipfile.ZipFile(io.BytesIO(read())) as archive:
        return _read_entry(archive, entry)


def _is_by_the_way(name: str) -> bool:
    """Check whether a file needs no mention, like data and pictures beside a notebook."""
    path = PurePosixPath(name)
    return path.suffix.lower() in (
        ".csv",
        ".tsv",
        ".npy",
        ".npz",
        ".mat",
        ".xlsx",
        ".png",
        ".jpg",
        ".jpeg",
        ".svg",
        ".md",
        ".json",
        ".py",
        ".yml",
        ".yaml",
        ".toml",
    ) or path.name in (".gitignore", ".gitattributes", "LICENSE", "requirements.txt")


# --- reading a notebook -------------------------------------------------------------------------


def read_notebook(data: bytes) -> tuple[list[CodeCell], list[str]]:
    """Return the code cells of a notebook, and nbgrader's names in its metadata.

    Raises
    ------
    Unfit
        These bytes are not a notebook; the message gives the reason.
    """
    notebook = _json(data)
    if (version := notebook.get("nbformat", 4)) != 4:
        raise Unfit(
            f"This notebook has format version {str(version)[:20]}, but we can read only version "
            "4. Open it in Jupyter and save it again."
        )
    cells = _list(notebook.get("cells"))
    if len(cells) > MOST_CELLS:
        raise Unfit(f"It has {len(cells)} cells, but we read at most {MOST_CELLS}.")
    code: list[CodeCell] = []
    grade_ids: list[str] = []
    for cell in cells:
        if not isinstance(cell, dict):
            raise Unfit("Not a valid notebook: one of its cells is malformed.")
        metadata = cell.get("metadata")
        about = metadata.get("nbgrader") if isinstance(metadata, dict) else None
        if isinstance(about, dict) and isinstance(about.get("grade_id"), str):
            grade_ids.append(about["grade_id"][:200])
        if cell.get("cell_type") == "code":
            count = cell.get("execution_count")
            code.append(
                {
                    "source": _source(cell.get("source", "")),
                    "execution_count": count if type(count) is int and 0 < count < 10**9 else None,
                }
            )
    if sum(len(cell["source"]) for cell in code) > MOST_CODE:
        raise Unfit(f"Its code is longer than {MOST_CODE} characters.")
    return code, grade_ids


def remembered_in(data: bytes) -> dict[str, Remembered]:
    """Read what the replies shown in a notebook remember, by question.

    Students can change it, and we do not notice if they delete it.
    """
    remembered: dict[str, Remembered] = {}
    if b"coursework-reply" not in data:
        return remembered
    # The quotes are escaped inside JSON strings.
    text = data.decode("utf8", "replace").replace('\\"', '"')
    for reply in REPLY.findall(text):
        about = dict(ABOUT_REPLY.findall(reply))
        if (
            not {"question", "tries"} <= set(about)
            or not about["tries"].isdecimal()
            or len(remembered) >= MOST_CELLS
        ):
            continue
        earlier = remembered.get(about["question"], Remembered())
        remembered[about["question"]] = Remembered(
            max(earlier.tries, int(about["tries"][:6])),
            about.get("help", earlier.help),
        )
    return remembered


def pictures_in(data: bytes) -> dict[str, list[str]]:
    """Return the pictures under each code cell in base64, by the cell's number.

    Students can change them, and only people look at them. What is not a complete picture is left
    out.
    """
    pictures: dict[str, list[str]] = {}
    left = MOST_BYTES_OF_PICTURES
    for number, shown in outputs_in(data):
        for kind in (PNG, JPEG):
            with contextlib.suppress(ValueError):
                picture = "".join(_source(shown.get(kind, "")).split())
                if picture and len(picture) <= left:
                    if is_picture(kind, base64.b64decode(picture, validate=True)):
                        pictures.setdefault(str(number), []).append(f"{kind};base64,{picture}")
                        left -= len(picture)
    return pictures


def outputs_in(data: bytes) -> Iterator[tuple[int, dict[str, object]]]:
    """Iterate over the outputs of the code cells, by MIME type, with the number of each cell."""
    cells = [cell for cell in _list(_json(data).get("cells", [])) if isinstance(cell, dict)]
    code = [cell for cell in cells if cell.get("cell_type") == "code"]
    for number, cell in enumerate(code):
        outputs = cell.get("outputs")
        for output in outputs if isinstance(outputs, list) else ():
            shown = output.get("data") if isinstance(output, dict) else None
            if isinstance(shown, dict):
                yield number, shown


def _list(value: object) -> list[object]:
    if not isinstance(value, list):
        raise Unfit("Not a valid notebook: its cells are not a list.")
    return value


def _source(source: object) -> str:
    if isinstance(source, list) and all(isinstance(line, str) for line in source):
        source = "".join(source)
    if not isinstance(source, str):
        raise Unfit("Not a valid notebook: the source of one of its cells is malformed.")
    try:
        source.encode("utf8")
    except UnicodeEncodeError:
        raise Unfit("One of its cells contains an incomplete character.") from None
    return source


def _json(data: bytes) -> dict[str, object]:
    if not data.strip():
        raise Unfit("The file is empty.")
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        raise Unfit("It is encoded in UTF-16, but notebooks must be in UTF-8.")
    if sum(map(data.count, (b",", b"[", b"{"))) > MOST_VALUES:
        # Remove strings first, since signs in them, such as in a long output, are not values.
        without_texts = TEXT.sub(b"", data)
        if sum(map(without_texts.count, (b",", b"[", b"{"))) > MOST_VALUES:
            raise Unfit(f"It has more than {MOST_VALUES} parts, too many for a notebook.")
    try:
        notebook = json.loads(data.decode("utf-8-sig"), object_pairs_hook=_no_key_twice)
    except Unfit:
        raise
    except UnicodeDecodeError:
        raise Unfit("It is not encoded in UTF-8, as notebooks must be.") from None
    except RecursionError:
        raise Unfit("It is nested too deeply.") from None
    except ValueError as error:
        where = f" (line {error.lineno})" if isinstance(error, json.JSONDecodeError) else ""
        is_page = data.lstrip().startswith(b"<")
        raise Unfit(
            f"Not a notebook: it is not well-formed JSON{where}."
            + (" It is a web page, perhaps one that asks to log in." if is_page else "")
            + (" It contains the marks of a merge conflict." if b"\n<<<<<<< " in data else "")
        ) from None
    if not isinstance(notebook, dict) or not {"cells", "worksheets"} & set(notebook):
        raise Unfit("Not a notebook: it has no cells.")
    return notebook


def _no_key_twice(pairs: list[tuple[str, object]]) -> dict[str, object]:
    mapping = dict(pairs)
    if len(mapping) < len(pairs):
        raise Unfit("A key appears twice in one of its entries, so its meaning is ambiguous.")
    return mapping
