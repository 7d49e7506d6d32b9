"""The folder of results: every file whole or not there at all, and one run at a time.

``records/student/assignment.json`` is written the moment a student's work is graded and holds all
that came of it; every other file is made from the records and can be made again.
"""

import contextlib
import hashlib
import json
import os
import re
import secrets
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from ..checking.fields import Json, Reader, Some, by_name, many, text
from .locks import lock
from .record import Record

REFUSED = "refused.json"


class InUse(ValueError):
    """Another run works on the same folder."""


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
        """Keep other runs away; what a run that was killed left half done is removed."""
        # Marks and answers are for nobody else who works on this machine.
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
        """Leave the lock to the process that has it: when that one
        ends, nobody is kept away any more.
        """
        self.lock.close()

    def place(self, student: str, assignment: str) -> Path:
        return self.records / file_name(student) / f"{file_name(assignment)}.json"

    def read(self, student: str, assignment: str) -> Record | None:
        """A student's record, or ``None``."""
        try:
            return record_in(self.place(student, assignment))
        except FileNotFoundError:
            return None

    # What is not given yet waits in a folder of its own, so that a run that was killed, or to which
    # nobody said yes, has not run notebooks for nothing.

    def _staged(self, student: str, assignment: str) -> Path:
        return self.folder / "waiting" / self.place(student, assignment).relative_to(self.records)

    def stage(self, record: Record) -> None:
        """Keep a record of which nobody knows yet whether it shall count."""
        write(self._staged(record.student, record.assignment), _as_json(record))

    def staged(self, student: str, assignment: str) -> Record | None:
        """The record that waits, or ``None``."""
        path = self._staged(student, assignment)
        return record_in(path) if path.exists() else None

    def unstage(self, student: str, assignment: str) -> None:
        self._staged(student, assignment).unlink(missing_ok=True)

    def promote(self, student: str, assignment: str) -> None:
        """Let the record that waits count."""
        place = self.place(student, assignment)
        place.parent.mkdir(parents=True, exist_ok=True)
        os.replace(self._staged(student, assignment), place)

    def keep_work(self, digest: str, sources: list[str]) -> None:
        """Keep the code of a notebook, for people to look at beside its answers."""
        self._keep_beside(f"{digest}.json", sources)

    def keep_pictures(self, digest: str, pictures: Mapping[str, list[str]]) -> None:
        """Keep the pictures of a notebook, by the numbers of their cells, for people to judge."""
        if pictures:
            self._keep_beside(f"{digest}.pictures.json", pictures)

    def pictures(self, digest: str) -> dict[int, tuple[str, ...]]:
        """The pictures of a notebook, by the number of the cell that drew them."""
        kept = self.said(f"work/{digest}.pictures.json", by_name(many(text))) or {}
        return {int(number): shown for number, shown in kept.items()}

    def work(self, digest: str) -> tuple[str, ...]:
        """The code cells of a notebook, or nothing if they were not kept."""
        return self.said(f"work/{digest}.json", many(text)) or ()

    def _keep_beside(self, name: str, value: object) -> None:
        """Keep for people what nothing that is graded depends on; what is there already stays."""
        place = self.folder / "work" / name
        if not place.exists():
            write(place, json.dumps(value, ensure_ascii=False), lasting=False)

    def said(self, name: str, reader: Reader[Some]) -> Some | None:
        """What a file of the folder holds, or ``None`` if it is not there.

        Raises
        ------
        Misread
        """
        path = self.folder / name
        return reader(json.loads(path.read_text("utf8")), str(path)) if path.exists() else None

    def put_aside(self, student: str, assignment: str) -> Path:
        """Move a record, and the page made of it, to where it
        counts no more; give its new place.
        """
        place = self.place(student, assignment)
        aside = self.folder / "put-aside" / place.relative_to(self.records)
        aside.parent.mkdir(parents=True, exist_ok=True)
        os.replace(place, aside)
        page = self.folder / "feedback" / file_name(student) / f"{file_name(assignment)}.html"
        page.unlink(missing_ok=True)
        return aside

    def all(self) -> Iterator[Record]:
        """All records, by student and assignment, one at a time."""
        # Keep only folder names, not whole paths, because a class may have a hundred thousand.
        for folder in sorted(os.listdir(self.records) if self.records.is_dir() else ()):
            for path in sorted((self.records / folder).glob("*.json"), key=lambda path: path.name):
                record = record_in(path)
                # Not what lies where it would not be written: a copy, or
                # what another version called so.
                if path == self.place(record.student, record.assignment):
                    yield record

    def log(self, line: str) -> None:
        """Write a line of what happened, with its time; nothing that is graded depends on it."""
        import datetime

        now = datetime.datetime.now().isoformat(" ", "milliseconds")
        with open(self.folder / "run.log", "a", encoding="utf8") as file:
            file.write(f"{now}  {line}\n")


def _as_json(record: Record) -> str:
    """A record as it is stored, with what its marks come to."""
    sums: dict[str, Json] = {"points": record.points, "worth": record.worth}
    return as_text(record.as_json() | sums | {"undecided": record.undecided})


def record_in(path: Path) -> Record:
    """The record that a file holds.

    Raises
    ------
    Misread
    """
    return Record.from_json(json.loads(path.read_text("utf8")), str(path))


def as_text(value: Mapping[str, object] | Iterable[object]) -> str:
    """JSON with a line for each entry of the outermost list or
    object: short, and still to be read.
    """
    if isinstance(value, Mapping):
        lines = [
            f"{json.dumps(name, ensure_ascii=False)}: {json.dumps(inner, ensure_ascii=False)}"
            for name, inner in value.items()
        ]
        return "{\n" + ",\n".join(lines) + "\n}\n"
    return "[\n" + ",\n".join(json.dumps(inner, ensure_ascii=False) for inner in value) + "\n]\n"


#: What Windows keeps for itself, whatever follows a dot: folders of it
#: are what containers there write to.
RESERVED = re.compile(r"(con|prn|aux|nul|com[0-9]|lpt[0-9])(\..*)?")


def file_name(name: str) -> str:
    """A name for a file that a student's name cannot lead astray;
    different names stay different.
    """
    plain = re.sub(r"[^A-Za-z0-9._-]+", "-", name).strip(".-")[:60]
    # The letter's case counts too: some file systems do not tell a from A. And what looks like a
    # name with a digest gets one as well, or somebody could call himself what another is called
    # here. It is as long as it is because a name of the same digest could be searched for.
    if RESERVED.fullmatch(plain.lower()):
        plain = ""
    if plain and plain == name == name.lower() and not re.search(r"-[0-9a-f]{20}$", name):
        return plain
    digest = hashlib.sha256(name.encode("utf8", "surrogatepass")).hexdigest()
    return f"{plain.lower() or 'student'}-{digest[:20]}"


def write(
    path: str | Path,
    text: str | bytes | Iterable[str | bytes],
    lasting: bool = True,
    private: bool = False,
) -> None:
    """Write a file so that it is there whole or not at all; if it is to
    last, also if the machine goes down.

    ``text`` is text, bytes or pieces of text that come one after another. What is ``private`` holds
    right answers or marks: nobody else who works on this machine may read it.
    """
    path = Path(path)
    path.parent.mkdir(mode=0o700 if private else 0o777, parents=True, exist_ok=True)
    half = path.with_name(f".half-{secrets.token_hex(8)}")
    with open(
        os.open(
            half,
            os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0),
            0o600 if private else 0o666,
        ),
        "wb",
    ) as file:
        for piece in (text,) if isinstance(text, (str, bytes)) else text:
            file.write(
                piece.encode("utf8", "backslashreplace") if isinstance(piece, str) else piece
            )
        if lasting:
            file.flush()
            os.fsync(file.fileno())
    os.replace(half, path)
    if lasting and hasattr(os, "O_DIRECTORY"):  # Windows cannot open a directory
        folder = os.open(path.parent, os.O_RDONLY | os.O_DIRECTORY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)
