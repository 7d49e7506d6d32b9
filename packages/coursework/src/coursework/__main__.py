"""The command ``coursework``, for authors and instructors, and for students who update their
exercises.
"""

import argparse
import sys
from collections.abc import Sequence
from importlib import import_module
from importlib.util import find_spec

#: The packages with commands that a student's package leaves out.
ROOMS = ("authoring", "grading")


def main(arguments: Sequence[str] | None = None) -> None:
    rooms = [
        import_module(f"coursework.{room}.commands")
        for room in ROOMS
        if find_spec(f"coursework.{room}") is not None
    ]
    missing = (
        ""
        if rooms
        else "Authors and instructors: install coursework from its repository for more commands."
    )
    parser = argparse.ArgumentParser(
        prog="coursework",
        description="Make, grade and update exercises that check themselves.",
        epilog=missing or "Run coursework COMMAND --help for the options of a command.",
    )
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    update = commands.add_parser(
        "update", help="update your exercises from a newer archive, and keep all your work"
    )
    update.add_argument(
        "archive", metavar="ARCHIVE", help="the newer archive, such as exercises.zip"
    )
    update.add_argument(
        "--folder", default=".", help="the folder with your work (default: this folder)"
    )
    for room in rooms:
        room.add_commands(commands)
    options = vars(parser.parse_args(arguments))
    runs = {
        "update": _update,
        **{name: run for room in rooms for name, run in room.COMMANDS.items()},
    }
    command = options.pop("command")
    try:
        runs[command](**options)
    except OSError as error:  # The reason is enough; a traceback helps nobody here.
        where = f": {error.filename}" if error.filename else ""
        sys.exit(f"coursework {command}: {error.strerror or error}{where}")


def _update(archive: str, folder: str) -> None:
    from .checking.update import ArchiveRefused, update

    try:
        print(*update(archive, folder), sep="\n")
    except ArchiveRefused as error:
        sys.exit(f"coursework update: {error}")


if __name__ == "__main__":
    main()
