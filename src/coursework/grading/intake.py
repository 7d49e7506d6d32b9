"""What was handed in: notebooks found in a folder or an archive, read strictly, and never written to.

Understood are a folder of notebooks, a folder for each student, nbgrader's ``submitted/student/assignment``,
and the archives (packed or unpacked) that Canvas, Moodle and Brightspace hand out. Everything here was named
and written by strangers. What is not an honest notebook is refused by its name, with a reason, and the rest
goes on: no link is followed, nothing is unpacked on disk, nothing is repaired.
"""

import codecs
import contextlib
import hashlib
import json
import os
import re
import stat
import unicodedata
import zipfile
from pathlib import PurePosixPath
from typing import NamedTuple

MOST_BYTES = 20 << 20  # of one notebook
MOST_CELLS = 1_000
MOST_CODE = 1 << 20  # characters in the code cells of one notebook
MOST_FILES = 50_000
DEEPEST = 10  # folders within folders
MOST_UNPACKED = 4 << 30  # bytes of one archive, all files together

#: Files that systems and browsers leave behind: no student handed them in.
LITTER = ("__MACOSX", ".DS_Store", "Thumbs.db", "desktop.ini", ".ipynb_checkpoints", ".coursework", "__pycache__")
CANVAS = re.compile(r"(?P<name>[^_]+)_(?P<late>LATE_)?(?P<user>\d+)_(?P<submission>\d+)_(?P<file>.+)")
MOODLE = re.compile(r"(?P<name>.+)_(?P<user>\d+)_assignsubmission_(?:file|onlinetext)(?:_(?P<file>.*))?")
BRIGHTSPACE = re.compile(
    r"(?P<user>\d+)-(?P<folder>\d+) - (?P<name>.+?) - (?P<when>\w{3,9} \d{1,2}, \d{4} \d{3,4} [AP]M)"
)
RESUBMITTED = re.compile(r"(?P<stem>.+?)-(?P<number>\d{1,3})")
MONTHS = ("jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec")
CHECK = re.compile(r"""\bcheck\(\s*['"]([^'"\n]{1,200})['"]""")


class Refused(NamedTuple):
    """A file that was handed in and is not graded, and why."""

    file: str
    student: str
    why: str


class Notebook(NamedTuple):
    """A notebook that was handed in.

    Attributes
    ----------
    file : str
        Its path in the submissions, as it was named.
    student : str
        Who handed it in, as far as the file's name or folder says.
    identity : dict
        The numbers and names under which a learning management system knows the student.
    digest : str
        SHA-256 of the bytes that were read.
    cells : list of dict
        ``source`` and ``execution_count`` of each code cell.
    named : list of str
        The names in its calls of ``check``, and nbgrader's names of its cells.
    folder : str
        The folder it lies in, which may be named after its assignment.
    order : tuple
        The greater, the newer: what the name declares, then the time of the file.
    """

    file: str
    student: str
    identity: dict
    digest: str
    cells: list
    named: list
    folder: str
    order: tuple
    late: bool


class Unfit(ValueError):
    """A file cannot be graded; the message says why."""


def take_in(path, assignments=()):
    """Read all that was handed in.

    Parameters
    ----------
    path : path
        A folder, a zip archive or one notebook.
    assignments : iterable of str
        Names of assignments, to tell a student's name from an assignment's in the name of a file.

    Returns
    -------
    notebooks : list of Notebook
    refused : list of Refused
    """
    notebooks, refused, files = [], [], []
    with contextlib.ExitStack() as stack:
        for name, when, read in _files(os.fspath(path), refused, stack):
            if len(files) >= MOST_FILES:
                refused.append(
                    Refused(name, "", f"There are more than {MOST_FILES} files; the rest was not looked at.")
                )
                break
            files.append((name, when, read))
        layout = _Layout([name for name, _, _ in files], assignments)
        for name, when, read in files:
            who = layout.who(name)
            if not name.lower().endswith(".ipynb"):
                if not _is_by_the_way(name):
                    refused.append(Refused(name, who.student, "This is no notebook: its name does not end in .ipynb."))
                continue
            try:
                data = read()
                cells, grade_ids = read_notebook(data)
            except Unfit as found:
                refused.append(Refused(name, who.student, str(found)))
                continue
            named = [found for cell in cells for found in CHECK.findall(cell["source"])]
            notebooks.append(
                Notebook(
                    name,
                    who.student,
                    who.identity,
                    hashlib.sha256(data).hexdigest(),
                    cells,
                    [*named, *grade_ids],
                    PurePosixPath(name).parent.name,
                    (who.declared, when),
                    who.late,
                )
            )
    return notebooks, refused


# --- finding the files --------------------------------------------------------------------------


def _files(path, refused, stack):
    """Give the name of each file, its time, and a function that reads it while the stack is open: in a fixed order."""
    if os.path.isdir(path):
        yield from _files_of_folder(path, refused, stack)
    elif zipfile.is_zipfile(path):
        yield from _files_of_archive(path, refused, stack)
    elif path.lower().endswith(".zip"):
        raise Unfit(f"{path} is no zip archive, or a damaged one.")
    elif os.path.exists(path):
        folder, name = os.path.split(os.path.abspath(path))
        handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        stack.callback(os.close, handle)
        yield name, os.stat(path).st_mtime_ns, lambda: _read_file(name, handle)
    else:
        raise Unfit(f"There is nothing at {path}.")


def _files_of_folder(root, refused, stack):
    # By handles of folders: a name that is exchanged for a link meanwhile leads nowhere.
    top = os.open(root, os.O_RDONLY | os.O_DIRECTORY)
    stack.callback(os.close, top)
    for folder, folders, files, handle in os.fwalk(".", dir_fd=top, follow_symlinks=False):
        folders.sort()
        inside = os.path.normpath(folder)
        for name in sorted(files + folders):
            full = name if inside == "." else f"{inside}/{name}"
            if _is_litter(full):
                continue
            try:
                about = os.stat(name, dir_fd=handle, follow_symlinks=False)
            except OSError as error:
                refused.append(Refused(_text(full), "", f"It cannot be read: {error.strerror}."))
                continue
            if stat.S_ISLNK(about.st_mode):
                refused.append(Refused(_text(full), "", "This is a link to another place. It was not followed."))
            elif stat.S_ISREG(about.st_mode):
                yield _text(full), about.st_mtime_ns, lambda full=full: _read_below(top, full)
            elif not stat.S_ISDIR(about.st_mode):
                refused.append(Refused(_text(full), "", "This is no file but a device or a channel."))
        folders[:] = [name for name in folders if not _is_litter(name)]
        if folders and inside.count("/") >= DEEPEST:
            refused.append(Refused(_text(inside), "", "Its folders are nested too deeply to be looked at."))
            folders.clear()


def _text(name):
    """A file's name as text that can be written: bytes that are no UTF-8 are shown as such."""
    return os.fsencode(name).decode("utf8", "backslashreplace")


def _is_litter(name):
    return any(part in LITTER or part.startswith(("._", ".~")) for part in name.split("/"))


def _read_below(top, name):
    """Read a file through its folders one by one, following no link."""
    with contextlib.ExitStack() as stack:
        handle = top
        *folders, last = name.split("/")
        for folder in folders:
            try:
                handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC, dir_fd=handle)
            except OSError as error:
                raise Unfit(f"It cannot be read: {error.strerror}.") from None
            stack.callback(os.close, handle)
        return _read_file(last, handle)


def _read_file(name, folder):
    try:
        # Not waiting, for what has become a channel in which nobody writes.
        handle = os.open(name, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC, dir_fd=folder)
    except OSError as error:
        raise Unfit(f"It cannot be read: {error.strerror}.") from None
    with open(handle, "rb") as file:
        if not stat.S_ISREG(os.fstat(handle).st_mode):
            raise Unfit("This is no file.")
        return _no_more_than(file.read(MOST_BYTES + 1))


def _no_more_than(data):
    if len(data) > MOST_BYTES:
        raise Unfit(f"It is larger than {MOST_BYTES >> 20} MB.")
    return data


def _files_of_archive(path, refused, stack):
    archive = stack.enter_context(zipfile.ZipFile(path))
    entries = sorted(archive.infolist(), key=lambda entry: entry.filename)
    times = {}
    for entry in entries:
        times[entry.filename] = times.get(entry.filename, 0) + 1
    unpacked = 0
    for entry in entries:
        name = entry.filename
        shown = name.encode("utf8", "backslashreplace").decode("utf8")
        if entry.is_dir() or _is_litter(name):
            continue
        why = _why_not_unpacked(entry, name)
        if times[name] > 1:
            why = "The archive holds this name more than once."
        unpacked += min(entry.file_size, MOST_BYTES)
        if not why and unpacked > MOST_UNPACKED:
            why = f"The archive unpacks to more than {MOST_UNPACKED >> 30} GB; this was not read any more."
        if why:
            refused.append(Refused(shown, "", why))
        else:
            yield shown, entry.date_time, lambda entry=entry: _read_entry(archive, entry)


def _why_not_unpacked(entry, name):
    parts = name.replace("\\", "/").split("/")
    if name.startswith(("/", "\\")) or ".." in parts or re.match(r"[A-Za-z]:", name) or "\\" in name:
        return "Its name leads out of the archive."
    if stat.S_ISLNK(entry.external_attr >> 16):
        return "This is a link to another place. It was not followed."
    if entry.flag_bits & 1:
        return "It is locked with a password."
    if entry.file_size > MOST_BYTES:
        return f"It is larger than {MOST_BYTES >> 20} MB."
    return ""


def _read_entry(archive, entry):
    try:
        with archive.open(entry) as file:
            # The size that is declared may be a lie.
            return _no_more_than(file.read(MOST_BYTES + 1))
    except (zipfile.BadZipFile, NotImplementedError, RuntimeError, EOFError, OSError, ValueError, MemoryError) as error:
        raise Unfit(f"It cannot be unpacked: {str(error)[:100]}") from None
    except Exception as error:
        if type(error).__module__ in ("zlib", "lzma", "_lzma", "bz2"):
            raise Unfit(f"It cannot be unpacked: {str(error)[:100]}") from None
        raise


# --- who handed it in ---------------------------------------------------------------------------


class _Who(NamedTuple):
    student: str
    identity: dict
    declared: tuple
    late: bool


class _Layout:
    """Tells from the names of all files whose each is."""

    def __init__(self, names, assignments):
        self.assignments = sorted(assignments, key=len, reverse=True)
        notebooks = [PurePosixPath(name) for name in names if name.lower().endswith(".ipynb")]
        # Canvas marks files and not folders; a name with two numbers in it may be a student's own.
        self.canvas = 2 * sum(bool(CANVAS.fullmatch(path.name)) for path in notebooks) > len(notebooks)

    def who(self, name):
        path = PurePosixPath(name)
        for part in path.parts[:-1]:
            found = MOODLE.fullmatch(part)
            if found:
                return self._moodle(found)
            found = BRIGHTSPACE.fullmatch(part)
            if found:
                identity = {"brightspace": found["user"], "name": _clean(found["name"])}
                return _Who(f"{identity['name']} {found['user']}", identity, _when(found["when"]), False)
        found = MOODLE.fullmatch(path.name)
        if found:
            return self._moodle(found)
        found = CANVAS.fullmatch(path.name) if self.canvas else None
        if found:
            again = RESUBMITTED.fullmatch(PurePosixPath(found["file"]).stem)
            number = int(again["number"]) if again else 0
            identity = {"canvas": found["user"], "name": _clean(found["name"])}
            return _Who(f"{identity['name']}_{found['user']}", identity, (number,), bool(found["late"]))
        parts = list(path.parts)
        if "submitted" in parts[:-1]:
            parts = parts[parts.index("submitted") + 1 :]
        student = _clean(parts[0]) if len(parts) > 1 else self._without_assignment(path.stem)
        return _Who(student, {}, (), False)

    @staticmethod
    def _moodle(found):
        identity = {"moodle": found["user"], "name": _clean(found["name"])}
        return _Who(f"{identity['name']} {found['user']}", identity, (), False)

    def _without_assignment(self, stem):
        for assignment in self.assignments:
            if assignment in stem and stem != assignment:
                rest = stem.replace(assignment, "").strip(" _-.()")
                if rest:
                    return _clean(rest)
        return _clean(stem)


def _is_by_the_way(name):
    """Whether a file is none that a student handed in for marks: an index, a picture beside a notebook."""
    path = PurePosixPath(name)
    return path.name in ("index.html", "timestamp.txt") or path.suffix.lower() in (
        ".csv",
        ".png",
        ".jpg",
        ".jpeg",
        ".svg",
        ".md",
        ".json",
    )


def _clean(name):
    """A name in one spelling, of a length that is one."""
    return " ".join(unicodedata.normalize("NFC", name).split())[:120] or "without a name"


def _when(text):
    """Brightspace's ``Nov 21, 2026 801 PM`` as numbers; the words are the same in every language setting."""
    month, day, year, clock, half = text.replace(",", "").split()
    number = MONTHS.index(month[:3].lower()) + 1 if month[:3].lower() in MONTHS else 0
    hour = int(clock[:-2]) % 12 + (12 if half == "PM" else 0)
    return int(year), number, int(day), hour, int(clock[-2:])


# --- reading a notebook -------------------------------------------------------------------------


def read_notebook(data):
    """Give the code cells of a notebook, and nbgrader's names in its metadata.

    Raises
    ------
    Unfit
        These bytes are no notebook; the message says what is the matter.
    """
    notebook = _json(data)
    if not isinstance(notebook, dict) or not ("cells" in notebook or "worksheets" in notebook):
        raise Unfit("This is no notebook: it has no cells.")
    version = notebook.get("nbformat", 4)
    if version not in (3, 4):
        raise Unfit(f"It is a notebook of version {str(version)[:20]}; versions 3 and 4 can be read.")
    if version == 3:
        sheets = notebook.get("worksheets", [])
        cells = (
            [cell for sheet in sheets if isinstance(sheet, dict) for cell in _list(sheet.get("cells"))]
            if isinstance(sheets, list)
            else []
        )
    else:
        cells = _list(notebook.get("cells"))
    if len(cells) > MOST_CELLS:
        raise Unfit(f"It has {len(cells)} cells; at most {MOST_CELLS} are read.")
    code, grade_ids = [], []
    for cell in cells:
        if not isinstance(cell, dict):
            raise Unfit("This is no notebook: one of its cells is none.")
        metadata = cell.get("metadata")
        about = metadata.get("nbgrader") if isinstance(metadata, dict) else None
        if isinstance(about, dict) and isinstance(about.get("grade_id"), str):
            grade_ids.append(about["grade_id"][:200])
        if cell.get("cell_type") == "code":
            count = cell.get("prompt_number" if version == 3 else "execution_count")
            code.append(
                {
                    "source": _source(cell.get("input" if version == 3 else "source", "")),
                    "execution_count": count if type(count) is int and 0 < count < 10**9 else None,
                }
            )
    if sum(len(cell["source"]) for cell in code) > MOST_CODE:
        raise Unfit(f"Its code is longer than {MOST_CODE} characters.")
    return code, grade_ids


def _list(value):
    if not isinstance(value, list):
        raise Unfit("This is no notebook: its cells are no list.")
    return value


def _source(source):
    if isinstance(source, list) and all(isinstance(line, str) for line in source):
        source = "".join(source)
    if not isinstance(source, str):
        raise Unfit("This is no notebook: the text of one of its cells is none.")
    try:
        source.encode("utf8")
    except UnicodeEncodeError:
        raise Unfit("One of its cells holds half of a character.") from None
    return source


def _json(data):
    if not data.strip():
        raise Unfit("The file is empty.")
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        raise Unfit("It is written in UTF-16; notebooks are written in UTF-8.")
    try:
        return json.loads(data.decode("utf-8-sig"), object_pairs_hook=_no_key_twice)
    except Unfit:
        raise
    except UnicodeDecodeError:
        raise Unfit("It is not written in UTF-8, as notebooks are.") from None
    except RecursionError:
        raise Unfit("It is nested too deeply.") from None
    except ValueError as error:
        where = f" (line {error.lineno})" if isinstance(error, json.JSONDecodeError) else ""
        raise Unfit(f"This is no notebook: it is not well-formed JSON{where}.") from None


def _no_key_twice(pairs):
    found = dict(pairs)
    if len(found) < len(pairs):
        raise Unfit("One of its entries has the same name twice, so it can be read in two ways.")
    return found
