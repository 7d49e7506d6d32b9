"""The command ``coursework``, for authors and instructors, and for students' updates."""

import argparse
import atexit
import io
import os
import signal
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib import import_module
from importlib.util import find_spec

from . import __version__

#: The packages with commands that a student's package leaves out.
ROOMS = ("authoring", "grading")
_STUDENTS_USAGE = """%(prog)s [-h] COMMAND ...
For the commands of authors and instructors, such as new and grade, install coursework-tools
as well as coursework-checks."""


@contextmanager
def _output_suits_its_reader() -> Iterator[None]:
    """Let a reader, such as `head`, stop early. Letters that a terminal lacks become `\\u0141`."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")
    try:
        try:
            yield
        finally:
            sys.stdout.flush()
    except BrokenPipeError:
        # Discard what is left, or Python would try to write it again as it exits.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(1)


@_output_suits_its_reader()
def main(arguments: Sequence[str] | None = None) -> None:
    rooms = [
        import_module(f"coursework.{room}.commands")
        for room in ROOMS
        if find_spec(f"coursework.{room}") is not None
    ]
    parser = argparse.ArgumentParser(
        prog="coursework",
        # Every error about a command shows it.
        usage=None if rooms else _STUDENTS_USAGE,
        description="Make, grade and update self-checking exercises.",
        epilog="Run coursework COMMAND --help for the options of a command.",
    )
    parser.add_argument("--version", action="version", version=f"%(prog)s {__version__}")
    # Students' usage contains a sentence, which does not belong in the usage of each command.
    commands = parser.add_subparsers(
        prog="coursework", dest="command", required=True, metavar="COMMAND"
    )
    update = commands.add_parser(
        "update",
        help="update your exercises from a newer archive, and keep all your work",
        description="Update your exercises from a newer archive, and keep all your work.",
    )
    update.add_argument(
        "archive", metavar="ARCHIVE", help="the newer archive, such as exercises.zip"
    )
    update.add_argument(
        "--folder", default=".", help="the folder with your work (default: this folder)"
    )
    for room in rooms:
        for command, (does, arguments_of_command) in room.ARGUMENTS.items():
            parser_of_command = commands.add_parser(
                command, help=does, description=f"{does[0].upper()}{does[1:]}."
            )
            for names, about in arguments_of_command:
                parser_of_command.add_argument(*names, **about)
    options = vars(parser.parse_args(arguments))
    runs = {
        "update": _update,
        **{name: run for room in rooms for name, run in room.COMMANDS.items()},
    }
    command = options.pop("command")
    try:
        runs[command](**options)
    except BrokenPipeError:
        raise
    except KeyboardInterrupt:
        # Pressing Ctrl+C again must not interrupt the end of the processes that grade.
        atexit.register(signal.signal, signal.SIGINT, signal.SIG_IGN)
        # Only grading keeps what it has done.
        again = " Run the same command again to resume." if command == "grade" else ""
        sys.exit(f"\nStopped.{again}")
    except ModuleNotFoundError as error:
        sys.exit(
            f"coursework {command} needs Linux, because it runs students' code in isolation. Run "
            "it in WSL or in a container. You can still run review, merge, term and export here, "
            "and your decisions are in the journal."
            if error.name in ("fcntl", "resource")
            else f"coursework {command} needs {error.name}, which is not installed here. Install "
            "coursework-tools, or in a working copy: python -m pip install --editable '.[tools]'"
        )
    except ValueError as error:
        # A fault of ours in an author's command shows its traceback.
        if type(error) is ValueError and not runs[command].__module__.endswith("grading.commands"):
            raise
        sys.exit(f"coursework {command}: {error}")
    # The reason is enough; a traceback helps nobody here.
    except OSError as error:
        sys.exit(
            f"coursework {command}: {error.strerror or error}"
            + (f": {error.filename}" if error.filename else "")
        )


def _update(archive: str, folder: str) -> None:
    from .checking.update import update

    print(*update(archive, folder), sep="\n")


if __name__ == "__main__":
    main()
