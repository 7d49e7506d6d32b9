"""The command ``coursework``: what authors and instructors run."""

import argparse
import sys

from .grading import commands as grading


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="coursework", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    release = commands.add_parser(
        "release", help="make the exercises, the sealed questions and the archive for students"
    )
    release.add_argument("--sources", help="folder of the notebooks with solutions")
    release.add_argument("--exercises", help="where the exercise notebooks go")
    release.add_argument("--sealed", help="where the sealed questions go")
    release.add_argument("--no-archive", action="store_true", help="leave the archive for students out")
    selftest = commands.add_parser("selftest", help="try every question as students will, and look for leaks")
    selftest.add_argument("--sources", help="folder of the notebooks with solutions")
    selftest.add_argument("--page", default="_build/selftest.html", help="where the page for the author goes")
    update = commands.add_parser("update", help="unpack a newer archive beside your work, which stays as it is")
    update.add_argument("archive")
    update.add_argument("--folder", default=".")
    grading.add_commands(commands)
    options = vars(parser.parse_args(arguments))
    return COMMANDS[options.pop("command")](**options)


def _release(no_archive, **folders):
    from .authoring import release
    from .authoring.author import AuthorError

    try:
        given = {name: folder for name, folder in folders.items() if folder}
        # The notebooks are run with the questions of this package: sealed elsewhere, they are not there.
        names = release.release(**given, run="sealed" not in given)
    except AuthorError as error:
        sys.exit(f"coursework release: {error}")
    print(f"{len(names)} notebooks released.")
    if not no_archive:
        print(f"For students: {release.archive()}")


def _selftest(page, sources):
    from .authoring.selftest import selftest

    faults = selftest(**({"sources": sources} if sources else {}), page=page)
    print(f"The page: {page}")
    if faults:
        sys.exit("\n".join(faults))
    print("Every question passed.")


def _update(archive, folder):
    from .authoring.release import update

    print(*update(archive, folder), sep="\n")


COMMANDS = {"release": _release, "selftest": _selftest, "update": _update, **grading.COMMANDS}

if __name__ == "__main__":
    main()
