"""The command ``orientation``, with ``explain FIRST SECOND`` and ``recording FILE``."""

import argparse
import json
import math
import re
import signal
import sys
from contextlib import suppress
from difflib import get_close_matches
from importlib import import_module
from pathlib import Path

from orientation import __version__

from .mismatch import mend
from .mismatch.explanation import explain, sentences
from .mismatch.table import COUNTS, KINDS, WAYS
from .programs import PROGRAMS

#: The exit codes of ``orientation explain``.
EXIT_CODES = {"same": 0, "named": 1, "undecided": 2, "unrelated": 2}
BAD_INPUT = 3


#: Matches an argument that is the name of a file rather than numbers.
_NAME_OF_A_FILE = re.compile(r"\S*[^\W\d]\S*\.[a-zA-Z]\w{0,4}")


class _Parser(argparse.ArgumentParser):
    """An argument parser that exits with BAD_INPUT for a wrong argument, since 2 is an answer."""

    def error(self, message):
        self.print_usage(sys.stderr)
        self.exit(BAD_INPUT, f"{self.prog}: {message}\n")


def main(arguments=None):
    if arguments is None:
        # A terminal may lack letters such as µ.
        sys.stdout.reconfigure(errors="backslashreplace")
    if arguments is None and hasattr(signal, "SIGPIPE"):
        # A program that reads the output, such as `head`, may stop early.
        signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    parser = _Parser(
        prog="orientation",
        description="Find out which conventions two programs, or a recording, use.",
        epilog="Run orientation COMMAND --help for the options of a command.",
    )
    parser.add_argument("--version", action="version", version=f"%(prog)s {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    _add_explain(commands)
    _add_recording(commands)
    given = sys.argv[1:] if arguments is None else arguments
    # A word that begins with a minus sign and a digit is a number, not an option.
    chosen = parser.parse_args(
        [f" {word}" if re.match(r"-[.\d]", word) else word for word in given]
    )
    sys.exit(chosen.run(chosen))


def _add_explain(commands):
    parser = commands.add_parser(
        "explain",
        help="name the mix-up between two programs that disagree",
        description="Name the mix-up between two programs from their numbers for the same poses.",
        epilog="Exit codes: 0 if both agree, 1 if a mix-up is named, 2 if no mix-up fits or the "
        "numbers do not determine the cause, 3 if the input cannot be read.",
    )
    parser.add_argument(
        "first",
        help="a file, - for standard input, or the numbers themselves, one pose per line",
    )
    parser.add_argument("second", help="the same poses, from the other program")
    parser.add_argument(
        "--json", action="store_true", help="print the answer as JSON, with a format number"
    )
    parser.add_argument(
        "--all", action="store_true", help="also print every other explanation that fits"
    )
    parser.add_argument(
        "--noise",
        type=float,
        default=0.0,
        metavar="DEGREES",
        help="tolerance in degrees (default: 0)",
    )
    for side, programs, known in (
        (
            "first",
            f"one of: {', '.join(PROGRAMS)}",
            f"a kind ({', '.join(COUNTS)}) or a convention such as 'zyx', 'space fixed', "
            "'degrees', 'xyzw'; may be repeated",
        ),
        ("second", "see --first", "see --first-is"),
    ):
        parser.add_argument(
            f"--{side}", dest=f"{side}_program", metavar="PROGRAM",
            help=f"the program that gave the {side} numbers: {programs}",
        )  # fmt: skip
        parser.add_argument(
            f"--{side}-is", action="append", default=[], metavar="WHAT",
            help=f"one thing you know about the {side} numbers: {known}",
        )  # fmt: skip
    parser.set_defaults(run=_explain)


def _add_recording(commands):
    parser = commands.add_parser(
        "recording",
        help="identify the columns, units and axes of an IMU recording",
        description="Identify the columns of a recording and their units, axes, signs and errors, "
        "and the convention of any orientation in it. Then run a filter, and test whether its "
        "errors are as small as the filter claims.",
        epilog="Exit codes: 0 if the file was examined, even if faults were found; 3 if it "
        "cannot be read.",
    )
    parser.add_argument(
        "files",
        nargs="+",
        metavar="FILE",
        help="a table of numbers, - for standard input, or a zip file or folder of tables; the "
        "times in several files must come from the same clock",
    )
    parser.add_argument("--rate", type=float, help="samples per second, if the file has no times")
    parser.add_argument(
        "--json", action="store_true", help="print each answer and its evidence as JSON"
    )
    parser.add_argument(
        "--columns",
        default="",
        metavar="WHAT",
        help="meaning of the columns (counted from 1), if the file does not give it, such as "
        "'time=1 gyroscope=2-4:rad/s accelerometer=5-7'",
    )
    parser.add_argument(
        "--html",
        type=Path,
        metavar="REPORT",
        help="write the report, with plots, as a single HTML page",
    )
    parser.add_argument(
        "--csv",
        type=Path,
        metavar="FILE",
        help="write the corrected recording, with an orientation for each sample",
    )
    parser.add_argument(
        "--convention",
        default="wxyz",
        choices=("wxyz", "xyzw", "yaw-pitch-roll"),
        help="form of the orientation in --csv (default: wxyz)",
    )
    parser.add_argument(
        "--quick", action="store_true", help="skip the filter, which is the slowest step"
    )
    # Explaining does not need the bench, so only this command loads it.
    parser.set_defaults(
        run=lambda chosen: import_module(".recording.command", __package__).run(chosen)
    )


def _given(argument):
    if argument == "-":
        return sys.stdin.read()
    # An argument that is not a file, or is too long to be a file's name, is the numbers themselves.
    with suppress(OSError, ValueError):
        content = Path(argument).read_bytes()
        # Windows PowerShell writes UTF-16. Letters that are not UTF-8 do not change the numbers.
        return content.decode("utf-16" if content[:2] == b"\xff\xfe" else "utf-8", "replace")
    if _NAME_OF_A_FILE.fullmatch(argument):
        raise ValueError(f"no such file: {argument}")
    return argument.replace("\\n", "\n")


def _declared(words):
    """Return the conventions that the words declare; each word declares one."""
    groups = (
        {
            choice["value"]: group["group"]
            for groups in KINDS.values()
            for group in groups
            for choice in group["choices"]
        }
        | dict.fromkeys(WAYS, "way")
        | dict.fromkeys(COUNTS, "kind")
    )
    for word in words:
        if word not in groups:
            near = [
                value
                for value in groups
                if get_close_matches(word.casefold(), [value, *value.casefold().split()], 1, 0.7)
            ]
            raise ValueError(
                f"{word!r} is unknown"
                + "".join(f" (did you mean {value!r}?)" for value in near[:1])
                + f": give a kind of description ({', '.join(COUNTS)}), a "
                f"convention such as 'zyx' or 'degrees', or a direction ({', '.join(WAYS)})"
            )
    return {groups[word]: word for word in words}


def _explain(chosen):
    try:
        if not chosen.noise >= 0:
            raise ValueError(f"--noise is {chosen.noise:g}: it must be at least 0 degrees")
        texts = [_given(chosen.first), _given(chosen.second)]
        declared = [_declared(words) for words in (chosen.first_is, chosen.second_is)]
        explanation = explain(
            *texts,
            first_declared=declared[0],
            second_declared=declared[1],
            first_program=chosen.first_program,
            second_program=chosen.second_program,
            noise=math.radians(chosen.noise),
        )
    except (ValueError, UnicodeDecodeError) as error:
        if chosen.json:
            print(
                json.dumps({"format": 1, "verdict": "bad input", "message": str(error)}, indent=2)
            )
        else:
            print(f"orientation: {error}", file=sys.stderr)
        return BAD_INPUT
    if chosen.json:
        print(json.dumps(as_data(explanation), indent=2))
    else:
        for sentence in sentences(explanation):
            print(sentence)
        if explanation.has_line:
            print("Fix it with this line (NumPy and SciPy; `second` is one pose):")
            print(f"    {mend.python_line(explanation.chains[0])}")
            print(f"The matrices satisfy {mend.formula(explanation.chains[0])}.")
        if chosen.all:
            for chain in explanation.chains[1:]:
                print("or: " + "; ".join(chain.words() or ["both mean the same"]))
    return EXIT_CODES[explanation.verdict]


def as_data(explanation):
    """Return an explanation as plain data in format 1, which ``--json`` prints."""
    mended = explanation.chains[0] if explanation.has_line else None
    return {
        "format": 1,
        "verdict": explanation.verdict,
        "poses": explanation.poses,
        "faults": list(explanation.faults),
        # Anything below a millionth of a degree is rounding error.
        "residual in degrees": None
        if explanation.residual is None
        else round(explanation.residual, 6),
        "readings left": len(explanation.chains),
        "others": [chain.words() for chain in explanation.chains[1:]],
        "further pose": explanation.further_pose,
        "question": explanation.question,
        "descriptions": [name._asdict() for name in explanation.names],
        "mended by": mend.python_line(mended) if mended else "",
        "formula": mend.formula(mended) if mended else "",
    }
