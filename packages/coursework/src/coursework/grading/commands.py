"""The commands of instructors, from ``coursework grade`` to ``coursework cluster``."""

from __future__ import annotations

import datetime
import getpass
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..authoring.commands import argument, notebook_name

if TYPE_CHECKING:
    from .judging.journal import Journal
    from .judging.laboratory import Agree, Laboratory
    from .store import Store


def time(text: str) -> datetime.datetime:
    """Read a time that a person typed, by the clocks of this machine if it has no time zone.

    The errors of the command call the value by this function's name.
    """
    return datetime.datetime.fromisoformat(text).astimezone()


OUT = argument(
    "out", metavar="MARKS", help="the folder of marks, as in `coursework grade --out MARKS`"
)
SOLUTIONS = argument(
    "--solutions",
    help="folder of the notebooks with solutions (default: the one in course.toml)",
)
DRY_RUN = argument(
    "--dry-run", action="store_true", help="show what would happen, without changing any mark"
)
GRADER = argument(
    "--grader",
    help="your name for the journal (default: your user name)",
)
YES = argument(
    "--yes", action="store_true", help="accept every change of a mark, up or down, without asking"
)
WORKERS = argument(
    "--workers",
    type=int,
    help="number of notebooks to run at a time (default: one per processor)",
)
#: The help and the arguments of each command.
ARGUMENTS = {
    "grade": (
        "grade a folder or an archive of notebooks",
        [
            argument(
                "submissions",
                help="a folder, a zip file from Canvas, Moodle or Brightspace, or a notebook",
            ),
            argument(
                "--out",
                required=True,
                metavar="MARKS",
                help="folder for the marks, feedback and reports",
            ),
            SOLUTIONS,
            argument(
                "--assignment",
                action="append",
                type=notebook_name,
                default=[],
                metavar="NAME",
                help="grade only this assignment (default: all in term.toml)",
            ),
            argument("--student", help="the student who handed in all the files"),
            DRY_RUN,
            YES,
            WORKERS,
            argument(
                "--scheduler",
                metavar="ADDRESS",
                help="run the notebooks on the Dask cluster at this address, such as tls://host:8786",
            ),
            argument(
                "--keys",
                metavar="FOLDER",
                help="folder of the cluster's keys, from `coursework cluster`",
            ),
            argument(
                "--allow-weak-isolation",
                action="store_true",
                help="run students' code even if this machine cannot isolate it; use this only on "
                "a machine that you can afford to lose",
            ),
            argument(
                "--as-listed",
                action="store_true",
                help="trust the roster or the folder names even if many notebooks carry another "
                "student's ID",
            ),
        ],
    ),
    "regrade": (
        "judge the stored answers again after you have changed a question or a decision",
        [
            OUT,
            SOLUTIONS,
            DRY_RUN,
            YES,
        ],
    ),
    "review": (
        "mark answers on a page that only this machine can open",
        [
            OUT,
            GRADER,
            argument(
                "--hide-names", action="store_true", help="show numbers instead of students' names"
            ),
            argument(
                "--port", type=int, default=0, help="port for the page (default: any free one)"
            ),
            YES,
        ],
    ),
    "sitting": (
        "print a personal question paper for each student, and marking sheets",
        [
            OUT,
            argument("name", metavar="NAME", help="the assignment's name, such as quiz-1"),
            argument(
                "--questions",
                nargs="+",
                type=notebook_name,
                default=[],
                metavar="NOTEBOOK/QUESTION",
                help="the questions (default: those in term.toml)",
            ),
            argument(
                "--roster", metavar="FILE.csv", help="the students, if term.toml has no roster"
            ),
            argument(
                "--paper",
                choices=["a4", "letter"],
                default="a4",
                help="size of the paper (default: %(default)s)",
            ),
            SOLUTIONS,
            YES,
        ],
    ),
    "merge": (
        "import another grader's decisions, or a table of decisions or appeals",
        [
            OUT,
            argument(
                "files",
                nargs="+",
                metavar="FILE",
                help="the journal.jsonl in the other grader's folder of marks, a copy of "
                "undecided.csv with credit filled in, the ticks.csv of a sitting, or a "
                "table of appeals with the columns student, question and words",
            ),
            GRADER,
            DRY_RUN,
            YES,
        ],
    ),
    "term": (
        "write the totals, pages and statistics of a course from MARKS/term.toml",
        [
            argument(
                "new",
                nargs="?",
                choices=["new"],
                help="create term.toml instead, with an explanation of every choice",
            ),
            OUT,
            SOLUTIONS,
            argument("--roster", metavar="FILE.csv", help="roster of the course (only with 'new')"),
        ],
    ),
    "export": (
        "export the marks and the feedback pages",
        [
            OUT,
            argument(
                "--lms",
                metavar="FILE.csv",
                help="the gradebook that you exported from Canvas, Moodle, Brightspace or "
                "Blackboard; term.toml says which column belongs to which assignment",
            ),
            argument(
                "--filled",
                metavar="FILE.csv",
                help="file for the filled-in gradebook (default: FILE-filled.csv)",
            ),
            argument(
                "--as-of",
                metavar="TIME",
                type=time,
                help="export only marks that were decided and due by this time, such as "
                "2026-12-01T12:00 (default: now)",
            ),
            DRY_RUN,
            argument(
                "--overwrite",
                action="append",
                default=[],
                metavar="STUDENT",
                help="override this student's manually entered mark (but not an excused one)",
            ),
            argument(
                "--assignment",
                help="the assignment to export (default: all whose columns in term.toml are in "
                "the gradebook)",
            ),
            argument(
                "--feedback",
                metavar="FILE.zip",
                help="write the feedback pages, named as your LMS expects",
            ),
            argument(
                "--nbgrader", metavar="FILE.csv", help="file for the marks in nbgrader's format"
            ),
        ],
    ),
    "gradescope": (
        "build a Gradescope autograder for one assignment",
        [
            argument("marks", metavar="MARKS", help="a folder with term.toml"),
            argument("--out", required=True, metavar="FILE.zip", help="file for the autograder"),
            SOLUTIONS,
            argument("--assignment", required=True, metavar="NAME", help="the assignment"),
        ],
    ),
    "why": (
        "explain a mark, with its history",
        [
            OUT,
            argument("student", metavar="STUDENT", help="the student's ID"),
            argument("assignment", metavar="ASSIGNMENT", help="the assignment's name"),
        ],
    ),
    "cluster": (
        "start the scheduler of a cluster, or one of its workers",
        [
            argument(
                "--keys",
                required=True,
                metavar="FOLDER",
                help="folder for the keys (new keys are created if it is empty)",
            ),
            argument(
                "--host",
                help="start the scheduler at this address, which the workers must be able to reach",
            ),
            argument(
                "--port",
                type=int,
                default=8786,
                help="the scheduler's port (default: %(default)s)",
            ),
            argument(
                "--worker",
                metavar="ADDRESS",
                help="start a worker for the scheduler at this address, such as tls://host:8786",
            ),
            WORKERS,
        ],
    ),
}


def grade(
    submissions: str,
    out: str,
    solutions: str | None,
    assignment: Sequence[str],
    student: str | None,
    dry_run: bool,
    workers: int | None,
    scheduler: str | None,
    keys: str | None,
    allow_weak_isolation: bool,
    as_listed: bool,
    yes: bool,
) -> None:
    from .execution.sandbox import WeakIsolation, WorkerDied
    from .grade import grade as grade_class
    from .running import Running
    from .workers import processors

    try:
        done = grade_class(
            submissions,
            out,
            solutions=solutions,
            only=assignment,
            student=student,
            as_listed=as_listed,
            dry_run=dry_run,
            running=Running(
                processors() if workers is None else workers, scheduler, keys, allow_weak_isolation
            ),
            agree=_agree(out, yes),
        )
    except (WeakIsolation, WorkerDied) as error:
        sys.exit(f"coursework grade: {error}")
    if not dry_run:
        print(f"The report: {out}/report.html")
    if done["held"]:
        sys.exit(NOT_MOVED)


NOT_MOVED = "No existing mark was changed. To continue, add --yes."


def _agree(out: str, yes: bool) -> Agree:
    """Show which marks would change, and ask for consent, unless it was given with --yes."""

    def agree(laboratory: Laboratory) -> bool:
        from .judging.laboratory import PAGE

        for line in laboratory.lines():
            print(line)
        if not yes:
            print(f"Details: {out}/{PAGE}")
        return yes or (
            sys.stdin.isatty()
            and input("Change these marks? (yes/no): ").strip().casefold() == "yes"
        )

    return agree


def _bring_in_decisions(out: str, yes: bool) -> None:
    """Apply the decisions in the journal to the marks."""
    from .grade import bring_in_decisions

    try:
        _say_moved(bring_in_decisions(out, agree=_agree(out, yes)))
    except ValueError as error:
        sys.exit(
            f"Your decisions are saved, but we could not apply them yet: {error} Solve "
            f"this problem, and then run `coursework regrade {out}`."
        )


def _say_moved(laboratory: Laboratory) -> None:
    if not laboratory.agreed:
        sys.exit(NOT_MOVED)
    print(*laboratory.first_decided(), f"Marks changed: {len(laboratory.moves)}.", sep="\n")


def regrade(
    out: str,
    solutions: str | None,
    dry_run: bool,
    yes: bool,
) -> None:
    from .grade import regrade as regrade_class

    laboratory = regrade_class(out, solutions=solutions, dry_run=dry_run, agree=_agree(out, yes))
    if dry_run:
        print(
            *[*laboratory.lines(), *laboratory.first_decided()],
            f"Marks that would change: {len(laboratory.moves)}.",
            sep="\n",
        )
    else:
        _say_moved(laboratory)


def review(out: str, grader: str | None, hide_names: bool, port: int, yes: bool) -> None:
    from .review import review as serve

    def say(address: str) -> None:
        print(f"Open this address and keep it private: {address}\nStop with Ctrl+C.", flush=True)

    try:
        serve(out, grader or getpass.getuser(), hide_names=hide_names, port=port, say=say)
    except KeyboardInterrupt:
        print("\nApplying the decisions to the marks and pages.")
        _bring_in_decisions(out, yes)


def sitting(
    out: str,
    name: str,
    questions: Sequence[str],
    roster: str | None,
    paper: str,
    solutions: str | None,
    yes: bool,
) -> None:
    from .sitting import sitting as prepare

    made = prepare(
        out,
        name,
        questions,
        paper=paper,
        roster=roster,
        solutions=solutions,
        agree=_agree(out, yes),
    )
    for what, path in zip(("For students", "For markers", "The table of ticks"), made):
        print(f"{what}: {path}")


def merge(out: str, files: Sequence[str], grader: str | None, dry_run: bool, yes: bool) -> None:
    from .judging.journal import Journal
    from .store import Store

    missing = [path for path in files if not Path(path).is_file()]
    if missing:
        sys.exit(
            f"coursework merge: {missing[0]} "
            + (
                "is a folder. Give the file journal.jsonl in it."
                if Path(missing[0]).is_dir()
                else "does not exist. A grader who has made no decisions has no journal; in that "
                "case, leave this file out."
            )
        )
    journal, store = Journal(Path(out), dry_run), Store(out)
    for path in files:
        if path.endswith(".jsonl"):
            _merge_journal(journal, store, path, dry_run)
        else:
            entered, unused = journal.take_in_table(Path(path), store.all(), grader)
            print(
                "Dry run: lines to import" if dry_run else "Lines imported",
                f"from {path}: {entered}.",
            )
            for line in unused:
                print(f"  not used: {line}")
    if not dry_run:
        _bring_in_decisions(out, yes)


def _merge_journal(journal: Journal, store: Store, path: str, dry_run: bool) -> None:
    from .judging.journal import Decision, digest_of_answer
    from .tables import in_a_line, number_of

    new, differing = journal.merge(Path(path))
    decisions = [entry for entry in new if isinstance(entry, Decision)]
    others = (
        f", and {len(new) - len(decisions)} on appeals and rubrics"
        if len(new) > len(decisions)
        else ""
    )
    print(
        f"New in {path}{' (dry run: not imported)' if dry_run else ''}: "
        f"{number_of(len(decisions), 'decision')}{others}."
    )
    foreign = [
        decision
        for decision in decisions
        if (record := store.read(decision.student, decision.assignment)) is None
        or digest_of_answer(record, decision.question) != decision.answer
    ]
    if foreign:
        whose = ", ".join(dict.fromkeys(in_a_line(decision.student, 60) for decision in foreign))
        print(
            f"  We ignored {len(foreign)} of them, about answers missing from this folder "
            f"({whose})."
        )
    for first, second in differing:
        print(
            f"  {second.student!r}, {second.question}: {first.who} gave {first.credit}, "
            f"{second.who} gave {second.credit}; the later decision counts."
        )


def term(
    new: str | None,
    out: str,
    solutions: str | None,
    roster: str | None,
) -> None:
    from .judging.term import FILE, new_term, read_term
    from .reporting.course_pages import FOLDER, write_course
    from .store import Store

    if new:
        from ..authoring.course import find_course

        print(new_term(out, Path(solutions or find_course().sources), roster))
        return
    if roster:
        sys.exit(
            "coursework term: --roster works only with 'term new'. Later, change it in term.toml."
        )
    print(
        *write_course(Store(out), read_term(Path(out, FILE))),
        f"The course: {out}/{FOLDER}/course.csv, and statistics.html beside it",
        sep="\n",
    )


def export(
    out: str,
    lms: str | None,
    filled: str | None,
    as_of: datetime.datetime | None,
    dry_run: bool,
    overwrite: Sequence[str],
    assignment: str | None,
    feedback: str | None,
    nbgrader: str | None,
) -> None:
    from .export import gradebooks
    from .store import Store

    if not (lms or feedback or nbgrader):
        sys.exit("coursework export: choose --lms, --feedback or --nbgrader.")
    store, book = Store(out), lms or ""
    target = str(gradebooks.place_of_filled(lms, filled)) if lms else ""
    files = [
        *{Path(file).resolve() for file in (lms, target) if file},
        *(Path(file).resolve() for file in (feedback, nbgrader) if file),
    ]
    if len(set(files)) < len(files):
        sys.exit(
            "coursework export: give --feedback and --nbgrader different files, which are neither "
            "the gradebook nor its filled copy."
        )
    for name, column in gradebooks.columns(lms, store, assignment) if lms else ():
        marks = gradebooks.Marks(store, name, as_of=as_of)
        print(*gradebooks.fill(book, marks, column, target, overwrite, dry_run), sep="\n")
        # Fill the next column in the file that has this one.
        book = book if dry_run else target
    if dry_run:
        return
    marks = gradebooks.Marks(store, assignment, as_of=as_of)
    if feedback:
        print(gradebooks.write_feedback(feedback, marks, store))
    if nbgrader:
        print(gradebooks.write_nbgrader(nbgrader, marks))


def why(out: str, student: str, assignment: str) -> None:
    from .reporting.life import life_of
    from .store import Store

    print(*life_of(Store(out), student, assignment), sep="\n")


def gradescope(marks: str, out: str, solutions: str | None, assignment: str) -> None:
    from .export.gradescope import write_autograder

    stems = write_autograder(out, marks, assignment, solutions=solutions)
    print(
        f"{out} grades {', '.join(stems)}. It contains the solutions and your secret. Upload it, "
        "but share it with nobody."
    )


def cluster(
    keys: str, host: str | None, port: int, worker: str | None, workers: int | None
) -> None:
    import os
    import socket
    from importlib.util import find_spec

    from .execution import cluster_keys
    from .workers import processors

    folder = Path(keys).absolute()
    if find_spec("distributed") is None:
        sys.exit(
            "coursework cluster: to use a cluster, first install Dask: python -m pip install "
            "distributed"
        )
    if worker:
        command = cluster_keys.worker(folder, worker, workers or processors())
    else:
        if not host:
            sys.exit(
                "coursework cluster: give the address at which workers can reach this machine, "
                "such as --host 192.0.2.7."
            )
        # If the address is not this machine's, or the port is taken, say so in a line. Dask would
        # in thirty, below commands for the workers that cannot work.
        socket.create_server(
            (host, port), family=socket.AF_INET6 if ":" in host else socket.AF_INET
        ).close()
        made = cluster_keys.make_keys(folder)
        command = cluster_keys.scheduler(folder, host, port)
        address = f"tls://{host}:{port}"
        print(
            f"{'New keys are' if made else 'The keys are'} in {folder}: anyone who has them "
            "can run code on this cluster.\n"
            f"On each worker machine, with a copy of that folder:\n"
            f"  coursework cluster --keys {folder.name} --worker {address}\n"
            f"Then, on the machine with the notebooks:\n"
            f"  coursework grade ... --scheduler {address} --keys {folder.name}\n"
            "Stop it with Ctrl+C.",
            flush=True,
        )
    os.execv(command[0], command)


COMMANDS: dict[str, Callable[..., None]] = {
    "grade": grade,
    "regrade": regrade,
    "review": review,
    "sitting": sitting,
    "merge": merge,
    "term": term,
    "export": export,
    "gradescope": gradescope,
    "why": why,
    "cluster": cluster,
}
