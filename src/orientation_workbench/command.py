"""The command ``orientation``: what this package does, for files."""

import argparse
import sys

from .recording.command import add_recording


def main(arguments=None):
    """Run the command.

    Parameters
    ----------
    arguments : list of str, optional
        As after the command's name; those of the process where none are given.

    Returns
    -------
    int
        0, or 1 where something is wrong: with the file that was asked about, or with the question.
    """
    parser = argparse.ArgumentParser(prog="orientation", description="Find out which conventions numbers are in.")
    subcommands = parser.add_subparsers(dest="subcommand", required=True, metavar="SUBCOMMAND")
    add_recording(subcommands)
    asked = parser.parse_args(arguments)
    return asked.run(asked)


if __name__ == "__main__":
    sys.exit(main())
