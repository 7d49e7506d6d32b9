"""A newer archive of exercises beside a student's work, which stays as it is."""

import re
import sys
import zipfile
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

#: The file of a package: its name and its version.
WHEEL = re.compile(r"(?P<name>[A-Za-z0-9_.]+)-(?P<version>[^-]+)-[^-]+-[^-]+-[^-]+\.whl")
REQUIREMENTS = "requirements.txt"
#: The folder of the sealed questions: no student changes them, so a newer one takes the place of the older one.
SEALED = "sealed/"


class OlderArchive(ValueError):
    """The archive holds an older package than the folder; the message names both."""


def update(archive_file, folder="."):
    """Unpack a newer archive of exercises beside a student's work.

    Notebooks that differ from those of the archive are left as they are, and the new ones are put beside them
    under a new name. The package takes the place of the older one.

    Parameters
    ----------
    archive_file, folder : path

    Returns
    -------
    list of str
        A line for each file, and at the end how to install the package, if another one is installed.

    Raises
    ------
    OlderArchive
        Nothing was changed.
    """
    folder = Path(folder)
    with zipfile.ZipFile(archive_file) as box:
        entries = [entry for entry in sorted(box.namelist()) if not entry.endswith("/")]
        files = {_place(entry): box.read(entry) for entry in entries}
    older = {name: _older(folder, name) for name in files if WHEEL.fullmatch(name)}
    to_install = [str(folder / name) for name in older if not _is_installed(name)]
    said = []
    for name, data in files.items():
        place = folder / name
        if place.exists() and place.read_bytes() == data:
            said.append(f"the same    {name}")
        elif name.startswith(SEALED):
            said.append(f"{'replaced' if place.exists() else 'added':<12}{name}")
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_bytes(data)
        elif name in older:
            place.write_bytes(data)
            for path in older[name]:
                path.unlink()
            said.append(
                f"{'replaced' if older[name] else 'added':<12}{', '.join(path.name for path in older[name]) or name}"
            )
        elif not place.exists():
            place.write_bytes(data)
            said.append(f"added       {name}")
        elif name == REQUIREMENTS:
            place.write_text(_with_new_packages(place.read_text("utf8"), older, data.decode()), "utf8")
            said.append(f"changed     {name}")
        else:
            said.append(_put_beside(place, data))
    if to_install:
        command = ["python" if sys.platform == "win32" else sys.executable, "-m", "pip", "install", *to_install]
        line = " ".join(f'"{word}"' if " " in word else word for word in command)
        said.append(f"Now run this:\n\n    {line}\n")
    return said


def _place(entry):
    """Where an entry of the archive goes: sealed questions into a folder of their own, other files into the folder."""
    path = Path(entry)
    if path.parent.name == "variants":
        return f"{SEALED}variants/{path.name}"
    return f"{SEALED}{path.name}" if path.parent.name == "sealed" else path.name


def _is_installed(name):
    wheel = WHEEL.fullmatch(name)
    try:
        return version(wheel["name"]) == wheel["version"]
    except PackageNotFoundError:
        return False


def _order(number):
    """Versions in their order: those of our packages are numbers, and ``post`` with a number."""
    return [int(part) for part in re.findall(r"\d+", number)]


def _older(folder, name):
    """The files of ``folder`` that hold another version of the package in the file ``name``."""
    new = WHEEL.fullmatch(name)
    found = []
    for path in sorted(folder.glob("*.whl")):
        present = WHEEL.fullmatch(path.name)
        if present and present["name"] == new["name"] and path.name != name:
            if _order(present["version"]) > _order(new["version"]):
                raise OlderArchive(
                    f"The archive is older than this folder: it has version {new['version']} of the package, "
                    f"and here is {present['version']}. Nothing was changed."
                )
            found.append(path)
    return found


def _with_new_packages(text, wheels, new):
    """A list of requirements that names the new files as ``new`` does; other lines are the student's and stay."""
    for name in wheels:
        package = re.escape(WHEEL.fullmatch(name)["name"])
        line = next((line for line in new.splitlines() if line.startswith(f"./{name}")), f"./{name}")
        text, count = re.subn(rf"^(\./)?{package}-[^-]+-\S+\.whl.*$", line, text, flags=re.M)
        if not count:
            text = f"{line}\n{text}"
    return text


def _put_beside(place, data):
    number = 1
    while (beside := place.with_name(f"{place.stem}-new-{number}{place.suffix}")).exists():
        if beside.read_bytes() == data:
            break
        number += 1
    beside.write_bytes(data)
    return f"kept yours  {place.name}; the new one is {beside.name}"
