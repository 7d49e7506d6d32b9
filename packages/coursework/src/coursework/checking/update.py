"""Update a student's exercises from a newer archive, without touching the student's work.

An archive contains a manifest of the released files, by name, each with a digest. So unchanged
files are recognised and replaced by newer ones.
"""

import hashlib
import json
import re
import sys
import zipfile
import zlib
from collections.abc import Iterable, Mapping
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path, PureWindowsPath

from .fields import Fields, by_name, many, text, whole

#: The file of a package: its name and its version.
WHEEL = re.compile(r"(?P<name>[A-Za-z0-9_.]+)-(?P<version>[^-]+)-[^-]+-[^-]+-[^-]+\.whl")
#: The number that a browser adds to the name of a second download: (1) or -1.
NUMBERED = re.compile(r" ?\(\d+\)$|[- ]\d+$")
REQUIREMENTS = "requirements.txt"
# The folder of the sealed questions, which students do not change, so newer ones replace older
# ones.
SEALED = "sealed/"


MANIFEST = "manifest.json"
# The format of manifests.
FORMAT = 1


class ArchiveRefused(ValueError):
    """The archive is invalid or older than the folder, or the folder needs a newer coursework."""


def manifest(files: Mapping[str, bytes], course: str) -> str:
    """Return the manifest of a course's files by name, as text.

    >>> json.loads(manifest({"README.txt": b"Answer in place of the dots."}, "Statics"))
    {'course': 'Statics', 'files': {'README.txt': '57c8e4f1c8ae41625a63c305e9a221a4'}, 'format': 1}
    """
    digests = {name: digest_of(name, data) for name, data in files.items()}
    return _as_text(course=course, files=digests)


def _as_text(**about: object) -> str:
    return json.dumps({"format": FORMAT, **about}, indent=0, sort_keys=True) + "\n"


def _digest_of_all(digests: Mapping[str, str]) -> str:
    """Return a digest of an archive, from those of its files."""
    return hashlib.sha256(json.dumps(sorted(digests.items())).encode()).hexdigest()[:32]


def digest_of(name: str, data: bytes) -> str:
    """Return a digest of a file; of a notebook, of its cells' sources, which a run leaves."""
    if name.endswith(".ipynb"):
        try:
            cells = json.loads(data)["cells"]
            data = json.dumps(
                [[cell["cell_type"], "".join(cell["source"])] for cell in cells]
            ).encode()
        except (ValueError, KeyError, TypeError):
            # It is not a notebook, so use its bytes.
            pass
    return hashlib.sha256(data).hexdigest()[:32]


def update(archive_file: str | Path, folder: str | Path = ".") -> list[str]:
    """Unpack a newer archive of exercises beside a student's work.

    Files unchanged since their release are replaced. Changed files are left as they are, and new
    versions of them are put beside them under a new name. The package replaces the older one.

    Parameters
    ----------
    archive_file, folder : path

    Returns
    -------
    list of str
        A line for each file, and at the end how to install the package, if another one is
        installed.

    Raises
    ------
    ArchiveRefused
        Nothing was changed.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise ArchiveRefused(f"There is no folder {folder} in {Path.cwd()}.")
    files = _files_in(archive_file)
    course = Fields(json.loads(files.pop(MANIFEST, "{}")), MANIFEST).maybe("course", text)
    before, archives, own = _handed_out(folder)
    if own and course and own != course:
        raise ArchiveRefused(
            f"{archive_file} belongs to the course {course!r}, and this folder to {own!r}. Give "
            "each course a folder of its own. We changed nothing."
        )
    now = {name: digest_of(name, data) for name, data in files.items()}
    older = {name: _older(folder, name) for name in files if WHEEL.fullmatch(name)}
    digest = _digest_of_all(now)
    if digest in archives[:-1]:
        raise ArchiveRefused(
            f"You have already updated this folder from {archive_file}, and from a newer "
            "archive since. Does the newest archive have a different name? We changed "
            "nothing."
        )
    if digest not in archives:
        archives.append(digest)
    to_install = [str(folder / name) for name in older if not _is_installed(name)]
    report = (
        []
        if any(older.values()) or any((folder / name).exists() for name in files)
        else [
            f"There were no exercises in {folder.resolve()}. If your work is in another folder, "
            "run this command there."
        ]
    )
    for name, data in files.items():
        place = folder / name
        if place.exists() and place.read_bytes() == data:
            report.append(f"the same    {name}")
        elif name.startswith(SEALED):
            report.append(f"{'replaced' if place.exists() else 'added':<12}{name}")
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_bytes(data)
        elif name in older:
            place.write_bytes(data)
            for path in older[name]:
                path.unlink()
            replaced = ", ".join(path.name for path in older[name])
            report.append(f"replaced    {replaced}" if replaced else f"added       {name}")
        elif not place.exists():
            place.write_bytes(data)
            report.append(f"added       {name}")
        elif before.get(name) == digest_of(name, place.read_bytes()):
            place.write_bytes(data)
            report.append(f"replaced    {name}, which you had not changed")
        elif name == REQUIREMENTS:
            place.write_text(_with_new_packages(place.read_text("utf8"), older), "utf8")
            report.append(f"changed     {name}")
        elif before.get(name) == now[name]:
            report.append(f"kept yours  {name}, since the archive has no newer one")
        else:
            beside = _put_beside(place, data, before)
            now[beside] = now[name]
            report.append(f"kept yours  {name}, and put the new version in {beside}")
    (folder / MANIFEST).write_text(
        _as_text(course=course, files={**before, **now}, archives=archives), "utf8"
    )
    if to_install:
        command = [
            "python" if sys.platform == "win32" else sys.executable,
            "-m",
            "pip",
            "install",
            *to_install,
        ]
        line = " ".join(f'"{word}"' if " " in word else word for word in command)
        report.append(f"Now run this:\n\n    {line}\n")
    return report


def _files_in(archive_file: str | Path) -> dict[str, bytes]:
    """Return the files of an archive of exercises, by their places in a student's folder."""
    once_more = "We changed nothing. Download it again."
    if not (place := Path(archive_file)).is_file():
        raise ArchiveRefused(
            f"{place} {'is a folder' if place.is_dir() else 'does not exist'} (the current folder "
            f"is {Path.cwd()}). Put the downloaded archive there, or give its path."
        )
    others = [
        file
        for file in place.parent.glob(f"*{place.suffix}")
        if NUMBERED.sub("", file.stem) == NUMBERED.sub("", place.stem)
    ]
    newest = max(others, key=lambda file: file.stat().st_mtime)
    if newest.stat().st_mtime > place.stat().st_mtime:
        raise ArchiveRefused(
            f'There is a newer archive beside {place}: "{newest.name}". We changed nothing. '
            "Give that name, in quotation marks, or delete the archive that you do not want."
        )
    try:
        with zipfile.ZipFile(archive_file) as box:
            # A Mac's own archives contain a hidden file beside each.
            entries = [
                entry
                for entry in sorted(box.namelist())
                if not entry.endswith(("/", "\\"))
                and not PureWindowsPath(entry).name.startswith(".")
            ]
            files = {_place(entry): box.read(entry) for entry in entries}
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError):
        raise ArchiveRefused(
            f"{archive_file} is not a complete zip archive. Was the download interrupted, or did "
            f"you save a web page instead? {once_more}"
        ) from None
    if not any(name.endswith(".ipynb") for name in files):
        raise ArchiveRefused(
            f"{archive_file} contains no notebook. Is it the archive of the exercises? {once_more}"
        )
    return files


def _place(entry: str) -> str:
    """Return where an entry of the archive goes: sealed questions into their own folder.

    Some programs on Windows write backslashes between folders.
    """
    path = PureWindowsPath(entry)
    if path.parent.name == "variants":
        return f"{SEALED}variants/{path.name}"
    return f"{SEALED}{path.name}" if path.parent.name == "sealed" else path.name


def _package_in(file: str) -> tuple[str, str]:
    """Return the package and its version, from the name of its wheel."""
    name, number, *_ = file.split("-")
    return name, number


def _is_installed(file: str) -> bool:
    name, number = _package_in(file)
    try:
        return version(name) == number
    except PackageNotFoundError:
        return False


def _order(number: str) -> tuple[list[int], bool, int]:
    """Return a key that sorts versions: numbers, with ``.dev`` before the version itself.

    >>> _order("1.9") < _order("1.10.dev7") < _order("1.10")
    True
    """
    release, in_development, moment = number.partition(".dev")
    parts = [int(part) for part in re.findall(r"\d+", release)]
    return parts, not in_development, int(moment or 0)


def _older(folder: Path, name: str) -> list[Path]:
    """Return the files of ``folder`` with another version of the package in the file ``name``."""
    package, new = _package_in(name)
    outdated = []
    for path in sorted(folder.glob("*.whl")):
        if (
            WHEEL.fullmatch(path.name)
            and _package_in(path.name)[0] == package
            and path.name != name
        ):
            present = _package_in(path.name)[1]
            if _order(present) > _order(new):
                raise ArchiveRefused(
                    f"The archive is older than this folder: it has version {new} of the package, "
                    f"but the folder has {present}. We changed nothing."
                )
            outdated.append(path)
    return outdated


def _with_new_packages(text: str, wheels: Iterable[str]) -> str:
    """Return requirements with the new files; other lines are the student's and stay."""
    for name in wheels:
        package = re.escape(_package_in(name)[0])
        text, count = re.subn(rf"^(\./)?{package}-[^-]+-\S+\.whl", f"./{name}", text, flags=re.M)
        if not count:
            text = f"./{name}\n{text}"
    return text


def _put_beside(place: Path, data: bytes, before: Mapping[str, str]) -> str:
    """Write a new file beside the one that a student has changed, and return its name."""
    number = 1
    while (beside := place.with_name(f"{place.stem}-new-{number}{place.suffix}")).exists():
        there = beside.read_bytes()
        if there == data or before.get(beside.name) == digest_of(beside.name, there):
            break
        number += 1
    beside.write_bytes(data)
    return beside.name


def _handed_out(folder: Path) -> tuple[dict[str, str], list[str], str | None]:
    """Return the files released into a folder with their digests, the archives in order, and the
    course.

    Nothing is known if the release was before manifests.
    """
    try:
        about = Fields(json.loads((folder / MANIFEST).read_text("utf8")), MANIFEST)
        format, files = about.get("format", whole), about.get("files", by_name(text))
        # An unpacked archive lists its files and names no archive.
        archives = about.maybe("archives", many(text)) or (_digest_of_all(files),)
    except (OSError, ValueError):
        # Files of unknown origin count as the student's.
        return {}, [], None
    if format != FORMAT:
        raise ArchiveRefused(
            f"{MANIFEST} in this folder has format {format}, but the installed coursework reads "
            f"{FORMAT}. Install the package in this folder and try again. We changed nothing."
        )
    return files, list(archives), about.maybe("course", text)
