"""The folder of results, in which every file is complete, and which one run uses at a time.

``records/student/assignment.json`` is written as soon as a student's work is graded, and contains
the whole result. Every other file is made from the records and can be made again.
"""

import contextlib
import hashlib
import json
import os
import re
import secrets
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from ..checking.fields import Json, Reader, Some, by_name, many, text
from .locks import lock
from .record import Record

REFUSED = "refused.json"
# The digests of the tables as they were written.
TABLES = "work/tables.json"


class InUse(ValueError):
    """An error because another run uses the same folder."""


class Store:
    """The results of a class.

    Parameters
    ----------
    folder : path
    """

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)
        self.records = self.folder / "records"

    @contextlib.contextmanager
    def locked(self) -> Iterator[None]:
        """Lock out other runs, and remove half-written files of a run that was killed."""
        # Nobody else on this machine may read marks and answers.
        new = not self.folder.exists()
        self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        with open(self.folder / "lock", "w") as self.lock:
            try:
                lock(self.lock, wait=False)
            except BlockingIOError:
                raise InUse(
                    f"Another run is using {self.folder}. Wait until it has finished, and then run "
                    "the command again."
                ) from None
            for path in self.folder.rglob(".half-*"):
                path.unlink()
            try:
                yield
            finally:
                # A run that was refused leaves nothing behind.
                if not self.records.exists():
                    (self.folder / "lock").unlink()
                if new and not any(self.folder.iterdir()):
                    self.folder.rmdir()

    def in_copy_of_process(self) -> None:
        """Release this copy of the lock, so that only the process that took it holds it."""
        self.lock.close()

    def place(self, student: str, assignment: str) -> Path:
        return self.records / file_name(student) / f"{file_name(assignment)}.json"

    def read(self, student: str, assignment: str) -> Record | None:
        """Return a student's record, or ``None``."""
        try:
            return record_in(self.place(student, assignment))
        except FileNotFoundError:
            return None

    def owner(self, student: str, assignment: str, group: str) -> str:
        """Return whose record counts for a student: one of their own, or else their group's."""
        return student if self.place(student, assignment).exists() else group

    # Records that are not given yet wait in a folder of their own, so that a run that was killed,
    # or that nobody agreed to, has not run notebooks in vain.

    def _staged(self, student: str, assignment: str) -> Path:
        return self.folder / "waiting" / self.place(student, assignment).relative_to(self.records)

    def stage(self, record: Record) -> None:
        """Store a record that may not count."""
        write(self._staged(record.student, record.assignment), _as_json(record))

    def staged(self, student: str, assignment: str) -> Record | None:
        """Return the waiting record, or ``None``."""
        path = self._staged(student, assignment)
        return record_in(path) if path.exists() else None

    def unstage(self, student: str, assignment: str) -> None:
        self._staged(student, assignment).unlink(missing_ok=True)

    def promote(self, student: str, assignment: str) -> None:
        """Let the waiting record count."""
        place = self.place(student, assignment)
        place.parent.mkdir(parents=True, exist_ok=True)
        os.replace(self._staged(student, assignment), place)

    def keep_work(self, digest: str, sources: list[str]) -> None:
        """Store the code of a notebook, for people to see beside its answers."""
        self._keep_beside(f"{digest}.json", sources)

    def keep_pictures(self, digest: str, pictures: Mapping[str, list[str]]) -> None:
        """Store the pictures of a notebook, by the numbers of their cells, for people to judge."""
        if pictures:
            self._keep_beside(f"{digest}.pictures.json", pictures)

    def pictures(self, digest: str) -> dict[int, tuple[str, ...]]:
        """Return the pictures of a notebook, by the number of the cell that drew them."""
        kept = self.said(f"work/{digest}.pictures.json", by_name(many(text))) or {}
        return {int(number): shown for number, shown in kept.items()}

    def work(self, digest: str) -> tuple[str, ...]:
        """Return the code cells of a notebook; empty if they were not stored."""
        return self.said(f"work/{digest}.json", many(text)) or ()

    def _keep_beside(self, name: str, value: object) -> None:
        """Store data for people that no grade depends on, unless they are there already."""
        place = self.folder / "work" / name
        if not place.exists():
            write(place, json.dumps(value, ensure_ascii=False), lasting=False)

    def said(self, name: str, reader: Reader[Some]) -> Some | None:
        """Return the contents of a file in the folder, or ``None`` if it does not exist.

        Raises
        ------
        Misread
        """
        path = self.folder / name
        return reader(json.loads(path.read_text("utf8")), str(path)) if path.exists() else None

    def write_table(self, name: str, rows: Iterable[str], advice: str) -> Iterator[str]:
        """Write a table. If a person has changed it since, keep that one, and say so.

        ``advice`` is how the person's changes can become marks.
        """
        path, table = self.folder / name, "".join(rows).encode("utf8", "backslashreplace")
        written = self.said(TABLES, by_name(text)) or {}
        there = hashlib.sha256(path.read_bytes()).hexdigest() if path.exists() else ""
        if there and there not in written.get(name, there).split():
            kept = path.with_stem(f"{path.stem}-changed-{there[:8]}")
            os.replace(path, kept)
            yield f"Somebody had changed {name}, so we kept that table as {kept}. {advice}"
            there = ""
        # Note both before one replaces the other, because we may be killed in between.
        digest = hashlib.sha256(table).hexdigest()
        write(self.folder / TABLES, json.dumps({**written, name: f"{digest} {there}"}))
        write(path, table)
        write(self.folder / TABLES, json.dumps({**written, name: digest}))

    def put_aside(self, student: str, assignment: str) -> Path:
        """Set a record aside, where it no longer counts; delete its page; return its new place."""
        place = self.place(student, assignment)
        aside = self.folder / "put-aside" / place.relative_to(self.records)
        aside.parent.mkdir(parents=True, exist_ok=True)
        os.replace(place, aside)
        (self.folder / feedback_of(student, assignment)).unlink(missing_ok=True)
        return aside

    def rename(self, student: str, assignment: str, name: str) -> None:
        """Let a record count for another name, until the work has been graded under that name."""
        record = record_in(self.put_aside(student, assignment))
        # The new name may have other variants of the questions.
        self.stage(replace(record, student=name, key="", cases={}))
        self.promote(name, assignment)

    def all(self) -> Iterator[Record]:
        """Iterate over all records, by student and assignment, one at a time."""
        # Keep only folder names, not whole paths, because a class may have a hundred thousand.
        for folder in sorted(os.listdir(self.records) if self.records.is_dir() else ()):
            for path in sorted((self.records / folder).glob("*.json"), key=lambda path: path.name):
                record = record_in(path)
                # Skip a copy, or a file that another version named differently.
                if path == self.place(record.student, record.assignment):
                    yield record

    def log(self, line: str) -> None:
        """Write a line with the time to the log, which no grade depends on."""
        import datetime

        now = datetime.datetime.now().isoformat(" ", "milliseconds")
        path = self.folder / "run.log"
        with naming(path), open(path, "a", encoding="utf8") as file:
            file.write(f"{now}  {line}\n")


def _as_json(record: Record) -> str:
    """Return a record as it is stored, with the sums of its marks."""
    sums: dict[str, Json] = {"points": record.points, "worth": record.worth}
    return as_text(record.as_json() | sums | {"undecided": record.undecided})


def record_in(path: Path) -> Record:
    """Read the record in a file.

    Raises
    ------
    Misread
    """
    return Record.from_json(json.loads(path.read_text("utf8")), str(path))


def as_text(value: Mapping[str, object] | Iterable[object]) -> str:
    """Return readable JSON with a line for each entry of the outermost list or object."""
    if isinstance(value, Mapping):
        lines = [
            f"{json.dumps(name, ensure_ascii=False)}: {json.dumps(inner, ensure_ascii=False)}"
            for name, inner in value.items()
        ]
        return "{\n" + ",\n".join(lines) + "\n}\n"
    return "[\n" + ",\n".join(json.dumps(inner, ensure_ascii=False) for inner in value) + "\n]\n"


#: Names that Windows reserves for devices, with any extension.
RESERVED = re.compile(r"(con|prn|aux|nul|com[0-9]|lpt[0-9])(\..*)?")


def file_name(name: str) -> str:
    """Return a safe file name for a student's name; different names stay different."""
    plain = re.sub(r"[^A-Za-z0-9._-]+", "-", name).strip(".-")[:60]
    # Upper case counts, too, since some file systems do not distinguish a from A. A name that looks
    # as if it had a digest gets one as well, or students could name themselves like somebody else's
    # file. The digest is long enough that nobody can search for a name with the same one.
    if RESERVED.fullmatch(plain.lower()):
        plain = ""
    if plain and plain == name == name.lower() and not re.search(r"-[0-9a-f]{20}$", name):
        return plain
    digest = hashlib.sha256(name.encode("utf8", "surrogatepass")).hexdigest()
    return f"{plain.lower() or 'student'}-{digest[:20]}"


def feedback_of(student: str, assignment: str) -> str:
    """Return the path of a student's page of feedback in the folder of results."""
    return f"feedback/{file_name(student)}/{file_name(assignment)}.html"


@contextlib.contextmanager
def naming(path: Path) -> Iterator[None]:
    """Name a file in the system's errors, which do not say which disk is full."""
    try:
        yield
    except OSError as error:
        error.filename = error.filename or str(path)
        raise


def write(
    path: str | Path,
    text: str | bytes | Iterable[str | bytes],
    lasting: bool = True,
    private: bool = False,
) -> None:
    """Write a file so that it is complete or missing; a lasting one even if the machine crashes.

    ``text`` is a string, bytes, or an iterable of such pieces. ``private`` files contain right
    answers or marks, and nobody else on this machine may read them.
    """
    path = Path(path)
    if path.is_dir():
        # The error at the end would name the half file, and leave it there with the marks.
        raise ValueError(f"{path} is a folder. Give the name of a file.")
    path.parent.mkdir(mode=0o700 if private else 0o777, parents=True, exist_ok=True)
    half = path.with_name(f".half-{secrets.token_hex(8)}")
    handle = os.open(
        half,
        os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0),
        0o600 if private else 0o666,
    )
    with naming(path), open(handle, "wb") as file:
        for piece in (text,) if isinstance(text, (str, bytes)) else text:
            file.write(
                piece.encode("utf8", "backslashreplace") if isinstance(piece, str) else piece
            )
        file.flush()
        if lasting:
            os.fsync(file.fileno())
    os.replace(half, path)
    # Windows cannot open a directory.
    if lasting and hasattr(os, "O_DIRECTORY"):
        folder = os.open(path.parent, os.O_RDONLY | os.O_DIRECTORY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)
