"""The command ``coursework``: what authors and instructors run,
and how students get newer exercises.
"""

import argparse
import sys
from collections.abc import Sequence
from importlib import import_module
from importlib.util import find_spec

#: Rooms with commands that a student's package does not hold.
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
        else "Authors and instructors install the package from its repository, which has more "
        "commands."
    )
    parser = argparse.ArgumentParser(
        prog="coursework",
        description="Exercises that check themselves: make them, grade them, renew them.",
        epilog=missing or "coursework COMMAND --help says what a command takes.",
    )
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    update = commands.add_parser(
        "update", help="unpack a newer archive beside your work, which stays as it is"
    )
    update.add_argument(
        "archive", metavar="ARCHIVE", help="the newer archive, such as exercises.zip"
    )
    update.add_argument("--folder", default=".", help="where your work is (default: here)")
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
    except OSError as error:  # what the system refused, and not where in the code that happened
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
