"""The commands of instructors: ``coursework grade``, ``regrade``, ``export`` and ``sample-class``."""

import sys


def add_commands(commands):
    """Add these commands to those of ``coursework``."""
    grade = commands.add_parser("grade", help="grade a folder or an archive of notebooks")
    grade.add_argument("submissions", help="a folder, a zip of Canvas, Moodle or Brightspace, or a notebook")
    grade.add_argument("--out", required=True, help="folder for marks, feedback and reports")
    grade.add_argument("--solutions", help="folder of the notebooks with solutions")
    grade.add_argument(
        "--assignment",
        action="append",
        default=[],
        metavar="NAME[=NOTEBOOK,...]",
        help="grade this assignment only; with = the notebooks of the exercises that make it up",
    )
    grade.add_argument("--workers", type=int, default=2, help="how many notebooks are run at a time (2)")
    grade.add_argument(
        "--scheduler", metavar="ADDRESS", help="run on this Dask cluster instead, such as tcp://host:8786"
    )
    grade.add_argument(
        "--allow-weak-isolation",
        action="store_true",
        help="run student code although this machine cannot keep it apart; only on a machine you can lose",
    )
    regrade = commands.add_parser(
        "regrade", help="judge the stored answers again, after a question or a decision changed"
    )
    regrade.add_argument("out", metavar="DIR")
    regrade.add_argument("--solutions", help="folder of the notebooks with solutions")
    export = commands.add_parser("export", help="hand the marks on")
    export.add_argument("out", metavar="DIR")
    export.add_argument(
        "--lms", metavar="FILE.csv", help="the gradebook that you exported from Canvas, Moodle or Brightspace"
    )
    export.add_argument(
        "--filled", metavar="FILE.csv", help="where the filled gradebook goes; FILE-filled.csv if not said"
    )
    export.add_argument("--column", help="the column to fill, by its name or the beginning of it")
    export.add_argument("--assignment", help="the assignment whose points are handed on, if there are several")
    export.add_argument("--nbgrader", metavar="FILE.csv", help="write nbgrader's table")
    export.add_argument(
        "--gradescope", metavar="results.json", help="write the results of a Gradescope autograder, for one student"
    )
    export.add_argument("--student", help="the student for --gradescope, if there are several")
    sample = commands.add_parser("sample-class", help="make a class to try grading on")
    sample.add_argument("--out", required=True, help="folder for the class")
    sample.add_argument("--students", type=int, default=200)
    sample.add_argument("--seed", type=int, default=1)
    sample.add_argument(
        "--notebooks", default="", help="the exercises to hand in, separated by commas; they become one notebook"
    )
    sample.add_argument("--solutions", help="folder of the notebooks with solutions")
    sample.add_argument(
        "--layout", default="folders", choices=("folders", "canvas", "moodle", "brightspace", "nbgrader")
    )


def grade(assignment, **options):
    from .grade import NothingToGrade
    from .grade import grade as grade_class
    from .sandbox import WeakIsolation
    from .store import InUse

    named = {name: (notebooks or name).split(",") for name, _, notebooks in (one.partition("=") for one in assignment)}
    try:
        grade_class(assignments=named or None, **options)
    except (NothingToGrade, InUse, WeakIsolation, ValueError) as error:
        sys.exit(f"coursework grade: {error}")
    except KeyboardInterrupt:
        sys.exit("\nStopped. The same command goes on from here.")
    print(f"The report: {options['out']}/report.html")


def regrade(out, solutions):
    from .grade import NothingToGrade
    from .grade import regrade as regrade_class
    from .store import InUse
    from .tables import number

    try:
        moved = regrade_class(out, solutions=solutions)
    except (NothingToGrade, InUse, ValueError) as error:
        sys.exit(f"coursework regrade: {error}")
    for one in moved:
        print(
            f"{one.student!r}, {one.assignment}: {number(one.before)} -> {number(one.after)}  "
            f"({', '.join(one.questions)})"
        )
    print(f"{len(moved)} moved.")


def export(out, lms, filled, column, assignment, nbgrader, gradescope, student):
    from . import gradebooks
    from .store import Store

    if not (lms or nbgrader or gradescope):
        sys.exit("coursework export: name what to write: --lms, --nbgrader or --gradescope.")
    try:
        marks = gradebooks.Marks(Store(out), assignment)
        if lms:
            said = gradebooks.fill(lms, marks, column, filled)
            print(*said, sep="\n")
        if nbgrader:
            gradebooks.write_nbgrader(nbgrader, marks)
        if gradescope:
            gradebooks.write_gradescope(gradescope, marks, student)
    except gradebooks.CannotExport as error:
        sys.exit(f"coursework export: {error}")


def sample_class(out, students, seed, notebooks, solutions, layout):
    from .sample_class import make_class

    made = make_class(out, students, seed, [name for name in notebooks.split(",") if name], solutions, layout)
    print(f"{students} students in {made}")


COMMANDS = {"grade": grade, "regrade": regrade, "export": export, "sample-class": sample_class}
