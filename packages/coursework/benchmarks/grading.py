"""Compare the speed of grading by coursework and by nbgrader.

Run it with ``python packages/coursework/benchmarks/grading.py``. We grade the whole sample class,
with its mistakes, broken cells and attacks, with ``coursework grade``, from an empty folder to the
report. nbgrader grades only the first honest notebooks, one after another, since it cannot do
otherwise. Processor times count all processes, and hardly depend on the load of the machine; times
by the clock do.
"""

import argparse
import contextlib
import io
import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from sample_class import make_class

from coursework.grading.assignments import Course
from coursework.grading.grade import grade
from coursework.grading.judging.term import Assignment, Term
from coursework.grading.running import Running

NOTEBOOKS = ("reference-frames", "unit-quaternions")
ASSIGNMENT = "homework"
CONFIGURATION = """c = get_config()
c.CourseDirectory.root = {root!r}
c.ExecutePreprocessor.kernel_name = 'python3'
c.Exchange.enabled = False
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--students", type=int, default=200, help="students in the sample class")
    parser.add_argument("--sample", type=int, default=8, help="number of notebooks for nbgrader")
    parser.add_argument("--workers", type=int, default=2, help="notebooks to run at a time")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as place:
        place = Path(place)
        submissions = make_class(place, options.students, 1, NOTEBOOKS)
        about = json.loads((place / "expected.json").read_text())
        questions = len(next(iter(about.values()))["questions"])
        good = [
            student
            for student in about
            if not any(did.startswith(("hostile", "refused")) for did in about[student]["did"])
        ]
        honest = _only(good, submissions, place / "honest")
        of_questions(place)
        ours = of_grading(honest, place, options.workers)
        sample = [
            next((honest / student).glob("*.ipynb"))
            for student in good
            if not about[student]["did"]
        ][: options.sample]
        rows = (
            (
                "coursework grade: all, with the attacks",
                *of_grading(submissions, place, options.workers),
            ),
            ("coursework grade: the honest ones", *ours),
            ("nbgrader autograde", *of_nbgrader(sample, place)),
        )
        print(
            f"{options.students} notebooks of {questions} questions, {options.workers} workers.\n"
        )
        print(
            "| what | notebooks | by the clock | each | processor time each | times ours, by the "
            "clock | times ours, processor |"
        )
        print("|---|---|---|---|---|---|---|")
        own = ours[1] / ours[0], ours[2] / ours[0]
        for what, count, clock, processor in rows:
            print(
                f"| {what} | {count} | {clock:.1f} s | {1000 * clock / count:.0f} ms | "
                f"{1000 * processor / count:.0f} ms | {clock / count / own[0]:.2g} | "
                f"{processor / count / own[1]:.2g} |"
            )


def _only(students, submissions, place):
    """A copy of the submissions of some students."""
    for student in students:
        shutil.copytree(submissions / student, place / student)
    return place


@contextlib.contextmanager
def measured():
    """The seconds by the clock and of processor time, of this
    process and all that it waited for.
    """

    def used():
        return sum(
            usage.ru_utime + usage.ru_stime
            for usage in map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
        )

    seconds, clock, processor = [], time.perf_counter(), used()
    yield seconds
    seconds += [time.perf_counter() - clock, used() - processor]


def of_questions(place):
    """Work out the questions, which :func:`of_grading` is given."""
    about = Assignment(notebooks=tuple(NOTEBOOKS))
    Course(term=Term(assignments={ASSIGNMENT: about})).questions([ASSIGNMENT], place)


def of_grading(submissions, place, workers):
    out = Path(tempfile.mkdtemp(dir=place))
    shutil.copytree(place / "questions", out / "questions")
    (out / "term.toml").write_text(
        f'time-zone = "UTC"\n[assignments.{ASSIGNMENT}]\nnotebooks = {list(NOTEBOOKS)}\n'
    )
    with measured() as seconds:
        done = grade(
            submissions,
            out,
            running=Running(workers=workers),
            show=io.StringIO(),
        )
    return done["graded"], *seconds


def of_nbgrader(paths, place):
    """Return how many notebooks nbgrader's own commands graded, and the seconds of that."""
    course = place / "course"
    name = paths[0].name
    for path in paths:
        folder = course / "submitted" / path.parent.name / ASSIGNMENT
        folder.mkdir(parents=True)
        shutil.copy(path, folder / name)
    (course / "source" / ASSIGNMENT).mkdir(parents=True)
    shutil.copy(paths[0], course / "source" / ASSIGNMENT / name)
    (course / "nbgrader_config.py").write_text(CONFIGURATION.format(root=str(course)))
    environment = {
        **os.environ,
        "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
        "JUPYTER_CONFIG_DIR": str(course),
        "PYTHONWARNINGS": "ignore",
    }

    def run(*command):
        done = subprocess.run(
            [sys.executable, "-m", "nbgrader", *command],
            cwd=course,
            env=environment,
            capture_output=True,
            text=True,
        )
        if done.returncode:
            sys.exit(done.stderr[-3000:])

    run("generate_assignment", ASSIGNMENT, "--force")
    with measured() as seconds:
        run("autograde", ASSIGNMENT)
    return len(paths), *seconds


if __name__ == "__main__":
    main()
