"""The commands of authors: ``coursework release`` and ``coursework selftest``."""

import sys


def add_commands(commands):
    """Add these commands to those of ``coursework``."""
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


def release(no_archive, **folders):
    from . import packing
    from .author import AuthorError
    from .release import release as make

    try:
        given = {name: folder for name, folder in folders.items() if folder}
        # The notebooks are run with the questions of this package: sealed elsewhere, they are not there.
        names = make(**given, run="sealed" not in given)
    except AuthorError as error:
        sys.exit(f"coursework release: {error}")
    print(f"{len(names)} notebooks released.")
    if not no_archive:
        print(f"For students: {packing.archive()}")


def selftest(page, sources):
    from .author import AuthorError
    from .selftest import selftest as try_all

    try:
        faults = try_all(**({"sources": sources} if sources else {}), page=page)
    except AuthorError as error:
        sys.exit(f"coursework selftest: {error}")
    print(f"The page: {page}")
    if faults:
        sys.exit("\n".join(faults))
    print("Every question passed.")


COMMANDS = {"release": release, "selftest": selftest}
