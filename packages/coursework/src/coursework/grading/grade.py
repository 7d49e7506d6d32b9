"""Grades a class: from what was handed in to a record of each
student's work, and reports of all records.

A record is written as soon as a student's work on an assignment is graded. Its key follows from
everything that it depends on: the bytes of the notebooks, the questions, the limits, the versions
of the software. A run that finds a record with the right key leaves it alone, so a run that was
killed goes on where it was.
"""

from __future__ import annotations

import base64
import contextlib
import functools
import hashlib
import importlib.util
import itertools
import json
import platform
import sys
import time
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, TextIO

from ..authoring.course import edition_of, find_course, links_of
from ..authoring.source import names_asked, posed
from ..checking.fields import Json, by_name, many, text
from ..checking.identity import plain_identity
from ..checking.plugins import kinds
from .execution.cluster_keys import demand_keys
from .judging import marking
from .judging.cases import Contracts, answered, changed_since, variants_of
from .judging.contract import Asked, Contract
from .judging.journal import FILE as JOURNAL
from .judging.journal import Journal, Standing, appeals_open, with_decisions
from .judging.judge import Judge
from .judging.laboratory import Agree, Laboratory, Policies, settle
from .judging.secret import secret_beside
from .judging.term import FILE as TERM
from .judging.term import IN_TIME, Term, term_of
from .record import Answer, Isolation, Record, Result, Superseded, read_result
from .store import REFUSED, Store, as_text, write
from .submissions import intake
from .submissions.intake import Notebook, Refused
from .submissions.roster import BadRoster, Roster
from .tables import in_a_line, lines
from .versions import software
from .workers import processors, side_by_side

# What runs code takes a while to be loaded, and where nothing is graded it is not needed.
if TYPE_CHECKING:
    from .execution.sandbox import Job, Limits

#: The questions of an assignment, each in all its variants, by name.
Questions = Mapping[str, Sequence[Contract]]
#: Which work was graded, and how it was kept apart, as JSON.
Finished = tuple[int, dict[str, Json]]
Finish = Callable[[int, Sequence[Result]], Finished]

WHOSE = "whose.csv"
#: What moves marks, where it is not work that was handed in anew.
REJUDGED = "the questions or the software changed"
DECIDED = "a person decided"


def always(laboratory: Laboratory) -> bool:
    """Agree to whatever would move, unseen: commands ask a person."""
    return True


MOST_SHOWN = 40  # lines of a table on the screen; the whole of it is in a file


class NothingToGrade(ValueError):
    """There is nothing that could be graded; the message says what was looked for."""


class Work(NamedTuple):
    """What one student, or one group, handed in for one assignment.

    Attributes
    ----------
    student, assignment : str
    notebooks : list of Notebook
        Those that count.
    superseded : list of Notebook
        Those that do not.
    why : list of str
        Why each of these does not.
    numbers : str
        Whose numbers it answers: of a group, those of the member whom it names.
    """

    student: str
    assignment: str
    notebooks: list[Notebook]
    superseded: list[Notebook]
    why: list[str]
    numbers: str


#: A notebook that says that it is of somebody else than whose work it is in.
Foreign = tuple[Work, Notebook]


class Course:
    """The assignments, and the names of the questions of each.

    Parameters
    ----------
    solutions : path
        The folder of the notebooks with solutions.
    term : Term, optional
        Says of which notebooks each assignment consists; else each notebook is one.
    only : collection of str
        The assignments that are graded now, if not all.
    """

    def __init__(
        self,
        solutions: str | Path | None = None,
        term: Term | None = None,
        only: Collection[str] = (),
    ) -> None:
        folder = self.folder = Path(solutions or find_course().sources)
        self.edition = edition_of(folder)
        self.sources = {path.stem: path for path in sorted(folder.glob("*.ipynb"))}
        if not self.sources:
            raise NothingToGrade(f"There is no notebook with solutions in {folder}.")
        known = {name: about.notebooks for name, about in (term or Term()).assignments.items()}
        known = known or {stem: (stem,) for stem in self.sources}
        unknown = sorted({stem for stems in known.values() for stem in stems} - set(self.sources))
        if unknown:
            raise NothingToGrade(
                f"There is no notebook with solutions {', '.join(map(repr, unknown))} in {folder}; "
                f"there are {', '.join(self.sources)}."
            )
        if strangers := sorted(set(only) - set(known)):
            raise NothingToGrade(
                f"There is no assignment {strangers[0]!r}; there are {', '.join(known)}."
            )
        asked = {stem: names_asked(path) for stem, path in self.sources.items()}
        self.assignments = {name: known[name] for name in known if not only or name in only}
        self.names = {
            assignment: [name for stem in stems for name in asked[stem]]
            for assignment, stems in self.assignments.items()
        }
        graded = {stem for stems in self.assignments.values() for stem in stems}
        #: The questions of what is not graded now.
        self.others: dict[str, list[str]] = {
            name: [question for stem in stems for question in asked[stem]]
            for name, stems in known.items()
            if name not in self.assignments
        }
        used = graded | {stem for stems in known.values() for stem in stems}
        self.others |= {stem: list(asked[stem]) for stem in asked if stem not in used}
        #: How many notebooks are of these.
        self.left_alone: Counter[str] = Counter()

    def assignments_of(self, notebook: Notebook) -> list[str]:
        """The assignments that a notebook answers, by the names in its cells, or else by its own
        name and folder; a notebook of which no other is graded now is counted as left alone.
        """
        all_names = {**self.others, **self.names}
        by_cell = {name.replace("/", "-"): name for names in all_names.values() for name in names}
        named = {by_cell.get(name.removeprefix("check-"), name) for name in notebook.named}
        counts = {assignment: len(named & set(names)) for assignment, names in all_names.items()}
        most = max(counts.values())
        found: list[str] = []
        if most:
            # The one it names most of; and any other of which it names half:
            # some work in a single notebook.
            first = next(name for name in [*self.names, *self.others] if counts[name] == most)
            found = [
                name
                for name, count in counts.items()
                if name == first or 2 * count >= len(all_names[name]) > 0
            ]
        else:
            for place in (notebook.folder, notebook.file.rpartition("/")[2]):
                if not found and (fitting := [name for name in all_names if name in place]):
                    found = [max(fitting, key=len)]
        if not found and len(self.assignments) == 1 and not notebook.of_assignment:
            found = list(self.assignments)
        graded = [name for name in found if name in self.assignments]
        if not graded and (found or notebook.of_assignment):
            self.left_alone[(found or [notebook.of_assignment])[0]] += 1
        return graded

    def questions(self, assignments: Iterable[str], kept: Path) -> dict[str, Questions]:
        """The questions of some assignments, by assignment and name."""
        stems = sorted(
            {stem for assignment in assignments for stem in self.assignments[assignment]}
        )
        secret = secret_beside(self.folder)
        found = marking.load_questions(
            [self.sources[stem] for stem in stems], kept, secret, self.edition
        )
        return {
            assignment: {name: found[name] for name in self.names[assignment]}
            for assignment in assignments
        }

    @property
    def all_questions(self) -> list[str]:
        """The names of all questions, also of what is not graded now."""
        return [name for names in (*self.names.values(), *self.others.values()) for name in names]

    @functools.cached_property
    def blanks(self) -> frozenset[str]:
        """The code cells of all notebooks as students get them."""
        found = set()
        for path in self.sources.values():
            owners = {variable: name for name, variable in names_asked(path).items()}
            for cell in json.loads(path.read_text("utf8"))["cells"]:
                if cell["cell_type"] == "code":
                    found.add(posed("".join(cell["source"]), owners).strip())
        return frozenset(found)

    def answers_something(self, notebook: Notebook) -> bool:
        """Whether a notebook says anything that the exercise did not say."""
        return any(
            source and source not in self.blanks and not intake.SAYS.match(source)
            for source in (cell["source"].strip() for cell in notebook.cells)
        )


def sort_work(
    notebooks: Iterable[Notebook], course: Course, refused: list[Refused], term: Term | None = None
) -> list[Work]:
    """Sort notebooks by student, or group, and assignment; say of each which counts.

    Of several notebooks for one assignment that counts which the term says, and another one only
    for questions that it has not: an assignment may be handed in as several notebooks. What answers
    nothing never counts where another notebook answers something.
    """
    term = term or Term()
    handed_in: dict[tuple[str, str], list[Notebook]] = {}
    for notebook in notebooks:
        left_alone = course.left_alone.total()
        assignments = course.assignments_of(notebook)
        if not assignments and course.left_alone.total() == left_alone:
            refused.append(
                Refused(
                    notebook.file, notebook.student, "No question of any assignment is named in it."
                )
            )
        for assignment in assignments:
            group = term.group_of(notebook.student)
            handed_in.setdefault((group, assignment), []).append(notebook)
    found = []
    for (student, assignment), mine in sorted(handed_in.items(), key=lambda entry: entry[0]):

        def rank(notebook: Notebook) -> tuple[bool, bool]:
            late = term.attempts == IN_TIME and term.is_late(student, assignment, notebook)
            return len(mine) == 1 or course.answers_something(notebook), not late

        ranks = {notebook.file: rank(notebook) for notebook in mine}
        counting: list[Notebook] = []
        superseded: list[Notebook] = []
        why: list[str] = []
        taken: set[str] = set()
        for notebook in sorted(mine, key=lambda one: (ranks[one.file], _by_age(one)), reverse=True):
            names = set(notebook.named) & set(course.names[assignment])
            if counting and (names & taken or not names):
                superseded.append(notebook)
                answers, in_time = ranks[notebook.file]
                best = max(ranks.values())
                reasons = (
                    "it answers nothing" if not answers and best[0] else "",
                    "it came late, and another in time" if not in_time and best[1] else "",
                    "another is newer",
                )
                why.append(next(filter(None, reasons)))
            else:
                counting.append(notebook)
                taken |= names
        members = {plain_identity(name): name for name in (student, *term.members(student))}
        said = [members.get(plain_identity(notebook.says), student) for notebook in counting]
        counting.sort(key=lambda notebook: notebook.file)
        found.append(Work(student, assignment, counting, superseded, why, said[0]))
    return found


def _by_age(notebook: Notebook) -> tuple[tuple[int, ...], tuple[int, ...], str]:
    declared, when = notebook.order
    return declared, when if isinstance(when, tuple) else (when,), notebook.file


# --- grading ------------------------------------------------------------------------------------


def grade(
    submissions: str | Path,
    out: str | Path,
    *,
    solutions: str | Path | None = None,
    only: Collection[str] = (),
    student: str | None = None,
    dry_run: bool = False,
    workers: int | None = None,
    scheduler: str | None = None,
    keys: str | Path | None = None,
    allow_weak_isolation: bool = False,
    as_listed: bool = False,
    limits: Limits | None = None,
    show: TextIO | None = None,
    agree: Agree = always,
) -> dict[str, int]:
    """Grade what was handed in and write records and reports to the folder ``out``, whose file
    ``term.toml`` says who is in the course and what there is to hand in.

    Parameters
    ----------
    submissions, out : path
    solutions : path, optional
        The folder of the notebooks with solutions, beside which the course's secret is kept.
    only : collection of str
        The assignments to grade, if not all.
    student : str, optional
        The one student who handed all of it in.
    dry_run : bool
        Say whose each file is, and how many would be run; run nothing, and leave every record as it
        is.
    workers : int, optional
        How many notebooks run at a time; as many as there are processors if it is not said.
    scheduler : str, optional
        The address of a Dask cluster.
    keys : path, optional
        The folder of its keys.
    allow_weak_isolation : bool
    as_listed : bool
        Go on although many notebooks say that they are somebody else's.
    limits : Limits, optional
    show : file, optional
        Where it says how far it is.
    agree : function
        Hears which marks that were given would move, and says whether they shall.

    Returns
    -------
    dict
        How many were ``graded`` now, were graded before (``kept``), and were ``refused``; and
        how many marks that were given did not move, since nobody agreed (``held``).

    Raises
    ------
    NothingToGrade, BadTerm, BadRoster, InUse, WeakIsolation
    """
    from .execution.sandbox import Limits
    from .reporting import reports

    workers = processors() if workers is None else workers
    if workers < 1:
        raise ValueError(
            f"At least one notebook is run at a time; the number of workers is {workers}."
        )
    if scheduler and importlib.util.find_spec("distributed") is None:
        raise ValueError(
            "To give notebooks to a cluster, install what speaks to it: python -m pip install "
            "distributed"
        )
    folder_of_keys = Path(keys) if keys else None
    if scheduler:
        demand_keys(scheduler, folder_of_keys)
    store, limits, show = Store(out), limits or Limits(), show or sys.stderr
    term = term_of(store.folder)
    people = term.roster
    if student is not None and people and student not in people.people:
        raise BadRoster(f"There is no student {student!r} in the roster.")
    with contextlib.ExitStack() as closing:
        closing.enter_context(store.locked())
        course = Course(solutions, term, only)
        _demand_submissions(Path(submissions), course)
        try:
            notebooks, refused = intake.take_in(
                submissions, course.assignments, people, student, store.folder
            )
        except intake.Unfit as error:
            raise NothingToGrade(str(error)) from None
        if not notebooks and not refused:
            raise NothingToGrade(
                f"There is nothing in {submissions}: no notebook, and no other file."
            )
        work = sort_work(notebooks, course, refused, term)
        if people:
            term.demand_people(store.folder / TERM, people.people)
        for name, number in sorted(course.left_alone.items()):
            are = ("notebook is", "is") if number == 1 else ("notebooks are", "are")
            print(f"{number} {are[0]} of {name}, and {are[1]} left alone.", file=show)
        _say_whose(work, refused, term, store, show)
        foreign = _say_foreign(work, show)
        _demand_a_class(work, people, student)
        questions = course.questions(
            sorted({one.assignment for one in work}), store.folder / "questions"
        )
        if not as_listed:
            _demand_own_numbers(work, questions, foreign, people)
        journal = Journal(store.folder)
        for line in _put_renamed_aside(store, work, journal, dry_run):
            print(line, file=show)
        if not dry_run:
            _say_cut(journal, show)

        term.policies.demand(course.all_questions)
        standing, contracts, policies = (
            journal.standing(),
            Contracts(store.folder),
            term.policies,
        )

        def before(one: Work) -> Record | None:
            """The record of the same student before, from which it is
            known which variants are whose.
            """
            return store.read(one.student, one.assignment)

        def key(one: Work) -> str:
            own, _ = marking.of_student(
                questions[one.assignment], one.numbers, before(one), contracts
            )
            asked = marking.asked_of_sandbox(marking.with_second_chances(own))
            return key_of(one, asked, limits, allow_weak_isolation)

        waiting: list[Work] = []
        kept: list[Work] = []
        for one in work:
            (kept if _is_done(store, one, key(one)) else waiting).append(one)
        print(
            f"{len(work)} to grade, {len(work) - len(waiting)} of them graded before, "
            f"{len(refused)} files refused.",
            file=show,
        )
        if dry_run:
            return {"graded": 0, "kept": len(kept), "refused": len(refused), "held": 0}
        store.log(
            f"start: {len(waiting)} of {len(work)} to grade, {len(refused)} refused, on "
            f"{platform.node()}"
        )
        jobs = _Jobs(waiting, questions, store, contracts, before)
        judge = closing.enter_context(Judge(questions, contracts, store.log))

        def finish(order: int, results: Sequence[Result]) -> Finished:
            """Judge one student's work, and write what its record would be."""
            one = waiting[order]
            old = before(one)
            of_student, cases = marking.of_student(
                questions[one.assignment], one.numbers, old, contracts
            )
            record = record_of(one, results, key(one), of_student, limits)
            record = replace(
                record,
                cases={name: answered(case, of_student[name]) for name, case in cases.items()},
            )
            store.stage(marked(with_marks_of(old, record), judge, standing, policies))
            return order, record.notebooks[0].isolation.as_json()

        progress = _Progress(len(waiting), show)
        finished = (
            _on_cluster(
                jobs,
                finish,
                workers,
                scheduler,
                folder_of_keys,
                limits,
                allow_weak_isolation,
                store,
            )
            if scheduler
            else _here(jobs, finish, workers, limits, allow_weak_isolation, store)
        )
        for order, isolation in finished:
            store.log(f"graded: {waiting[order].student!r} {waiting[order].assignment}")
            progress.one_more(Isolation.from_json(isolation))
        run_now = {(one.student, one.assignment): None for one in waiting}
        key_of_kept = {(one.student, one.assignment): key(one) for one in kept}

        def candidates() -> Iterator[Record]:
            """All records of these assignments, as they would be now."""
            for student, assignment in run_now:
                staged = store.staged(student, assignment)
                assert staged is not None
                yield staged
            for of, wanted in key_of_kept.items():
                staged, old = store.staged(*of), store.read(*of)
                if staged and staged.key == wanted and (old is None or old.key != wanted):
                    yield marked(with_marks_of(old, staged), judge, standing, policies)
            for record in store.all():
                of = record.student, record.assignment
                if of not in run_now and record.key == key_of_kept.get(of, record.key):
                    if record.assignment in questions:
                        yield marked(record, judge, standing, policies)

        laboratory = settle(store, journal, candidates(), agree, REJUDGED)
        # Of another folder nothing is forgotten.
        all_refused = store.said(REFUSED, by_name(many(Refused.from_json))) or {}
        all_refused[str(Path(submissions).resolve())] = tuple(sorted(refused))
        write(store.folder / REFUSED, as_text(all_refused))
        write(store.folder / reports.LINKS, as_text(links_of(course.folder)))
        reports.write_all(store)
        store.log("end")
    for line in said_of_people(store, standing):
        print(line, file=show)
    _say_other_numbers(store, work, questions, show)
    return {
        "graded": len(waiting),
        "kept": len(work) - len(waiting),
        "refused": len(refused),
        "held": 0 if laboratory.agreed else len(laboratory.moves),
    }


def with_marks_of(old: Record | None, record: Record) -> Record:
    """A record with the marks that the same answers have: by whose mending nobody is to lose,
    nobody loses who handed the same answer in again.
    """
    same = old.marks.items() if old else ()
    return replace(
        record,
        marks={name: mark for name, mark in same if old and _is_same(old, record, name)},
    )


def _demand_submissions(submissions: Path, course: Course) -> None:
    """Refuse the folder of the course, or of results, where that of
    the students' work is asked for.
    """
    if course.folder.resolve().is_relative_to(submissions.resolve()):
        raise NothingToGrade(
            f"{submissions} holds the notebooks with solutions: name the folder that was handed in."
        )
    if (submissions / "records").is_dir() and (submissions / JOURNAL).is_file():
        raise NothingToGrade(
            f"{submissions} holds results of grading: name the folder that was handed in."
        )


def _say_whose(
    work: Sequence[Work],
    refused: Sequence[Refused],
    term: Term,
    store: Store,
    show: TextIO,
) -> None:
    """Say before anything is run whose each file is, how that is known, and which do not count."""
    roster = term.roster

    def rows() -> Iterator[tuple[str, ...]]:
        for one in work:
            for notebook, why in zip(
                (*one.notebooks, *one.superseded), (*(("",) * len(one.notebooks)), *one.why)
            ):
                about = (notebook.matched, notebook.says, why)
                yield one.student, one.assignment, notebook.file, *about

    write(
        store.folder / WHOSE,
        lines(
            ("student", "assignment", "file", "known by", "says it is of", "does not count"), rows()
        ),
    )
    around = {
        one.file.partition(one.claim.place)[0].strip("/") for each in work for one in each.notebooks
    } - {""}
    if len(around) == 1:
        (folder,) = around
        print(
            f"The folder {in_a_line(folder, 120)!r} encloses everything, and is taken for nobody's "
            "name.",
            file=show,
        )
    for student, assignment, file, matched, _, why in itertools.islice(rows(), MOST_SHOWN):
        whose = f"  {in_a_line(student, 60)} <- {in_a_line(file, 120)}  ({assignment}; {matched})"
        print(whose + (f" DOES NOT COUNT: {why}" if why else ""), file=show)
    more = sum(len(one.notebooks) + len(one.superseded) for one in work) - MOST_SHOWN
    if more > 0:
        print(f"  ... and {more} more: {store.folder / WHOSE}", file=show)
    asked = [one for one in refused if one.why.endswith(("whose are they?", intake.NOT_MATCHED))]
    for one in asked[:MOST_SHOWN]:
        print(f"  ? <- {in_a_line(one.file, 120)}: {in_a_line(one.why, 300)}", file=show)
    if roster:
        present = {member for one in work for member in term.members(one.student)}
        damaged = {one.student for one in refused} & set(roster.people) - present
        missing = sorted(set(roster.people) - present - damaged)
        for names, what in (
            (missing, "handed in nothing"),
            (sorted(damaged), "handed in what cannot be graded"),
        ):
            if names:
                shown = ", ".join(names[:MOST_SHOWN]) + (", ..." if len(names) > MOST_SHOWN else "")
                print(f"Of the roster, {len(names)} {what}: {shown}.", file=show)


def _say_foreign(work: Sequence[Work], show: TextIO) -> list[Foreign]:
    """Say which notebooks say that they are of somebody else than
    whose they are graded as; give these.
    """
    foreign = [
        (one, notebook)
        for one in work
        for notebook in one.notebooks
        if notebook.says and plain_identity(notebook.says) != plain_identity(one.numbers)
    ]
    for one, notebook in foreign[:MOST_SHOWN]:
        print(
            "  ! "
            f"{in_a_line(notebook.file, 120)} says that it is of {in_a_line(notebook.says, 60)!r}, "
            f"and is graded as that of {in_a_line(one.student, 60)!r}",
            file=show,
        )
    if len(foreign) > MOST_SHOWN:
        print(f"  ... and {len(foreign) - MOST_SHOWN} more.", file=show)
    return foreign


#: Of the notebooks that say whose they are, so many may be wrong before it is the roster that is.
FEW_FOREIGN, SHARE_FOREIGN = 2, 0.2


def _demand_own_numbers(
    work: Sequence[Work],
    questions: Mapping[str, Questions],
    foreign: Sequence[Foreign],
    roster: Roster | None,
) -> None:
    """Numbers follow from who one is: where many say to be somebody else, all
    would be judged by wrong numbers.
    """
    varied = {
        name
        for name, asked in questions.items()
        if any(len(variants) > 1 for variants in asked.values())
    }
    saying = sum(
        bool(notebook.says)
        for one in work
        if one.assignment in varied
        for notebook in one.notebooks
    )
    wrong = [(one, notebook) for one, notebook in foreign if one.assignment in varied]
    if len(wrong) <= max(FEW_FOREIGN, SHARE_FOREIGN * saying):
        return
    (one, notebook), *_ = wrong
    why = (
        "The roster knows them by another word than they wrote: of `student`, `email` and `name` "
        "the first column that it has is the one that their numbers follow from."
        if roster
        else "Name a roster in term.toml in which they are called as they wrote, or name their "
        "folders so."
    )
    raise NothingToGrade(
        f"Of {saying} notebooks that say whose they are, {len(wrong)} say to be of somebody else "
        f"than they are graded as: {notebook.says!r} as {one.student!r}, say. "
        "Each student's numbers follow from that word, so their answers would be judged by other "
        "numbers than they were given. "
        f"{why} If all of it is right as it is listed: --as-listed."
    )


#: From this share of the answers to questions with variants on, right answers
#: to other numbers are no accident.
MANY_OTHER_NUMBERS = 0.1


def _say_other_numbers(
    store: Store, work: Sequence[Work], questions: Mapping[str, Questions], show: TextIO
) -> None:
    """Say it where many answers are right for other numbers than those that their
    authors are believed to have had.
    """
    for assignment, asked in questions.items():
        varied = {name for name, variants in asked.items() if len(variants) > 1}
        given = other = 0
        for one in work:
            record = (
                store.read(one.student, assignment)
                if varied and one.assignment == assignment
                else None
            )
            for name, mark in record.marks.items() if record else ():
                given += name in varied and mark.outcome != "not attempted"
                other += mark.note == "other numbers"
        if other > max(FEW_FOREIGN, MANY_OTHER_NUMBERS * given):
            print(
                f"LOOK AT THIS FIRST: in {assignment}, {other} of {given} answers are right for "
                "other numbers than those of the student whose they are, and earn nothing. "
                "Are the students called here as they have written into their notebooks? "
                "If not, grade again with the right roster in term.toml: nothing is lost.",
                file=show,
            )


def _demand_a_class(work: Sequence[Work], roster: Roster | None, student: str | None) -> None:
    """Everything from one student is a question, not a result: a folder
    around it may have been taken for one.
    """
    students = {one.student for one in work}
    doubtful = [
        notebook
        for one in work
        for notebook in one.superseded
        if not notebook.claim.given_by_system
    ]
    if len(students) == 1 and doubtful and roster is None and student is None:
        (only,) = students
        raise NothingToGrade(
            f"The notebooks would all be of one student, {only!r}, and all but the newest would "
            "not count. "
            f"If that is so, say --student {only!r}; if not, name the folder in which each student "
            "has one of their own, or name a roster in term.toml."
        )


def _put_renamed_aside(
    store: Store, work: Sequence[Work], journal: Journal, dry_run: bool = False
) -> Iterator[str]:
    """Move the record of a student away whose very notebooks are now
    another's: the folder was renamed.

    What people decided on the answers is entered for the new name too.
    """
    present = {(one.student, one.assignment) for one in work}
    known = set()
    absent: list[tuple[str, str, set[tuple[str, str]]]] = []
    for record in store.all():
        known.add((record.student, record.assignment))
        if (record.student, record.assignment) not in present:
            files = {(notebook.file, notebook.sha256) for notebook in record.notebooks}
            absent.append((record.student, record.assignment, files))
    owners: dict[tuple[str, frozenset[str]], list[Work]] = {}
    for one in work if absent else ():
        if (one.student, one.assignment) not in known:
            digests = frozenset(notebook.digest for notebook in one.notebooks)
            owners.setdefault((one.assignment, digests), []).append(one)
    for student, assignment, files in absent:
        fitting = owners.get((assignment, frozenset(digest for _, digest in files)), [])
        # Of equal notebooks, those that lie where they lay: then a roster has
        # given the student another name.
        there = [
            one
            for one in fitting
            if files == {(notebook.file, notebook.digest) for notebook in one.notebooks}
        ]
        names = [one.student for one in there or fitting]
        if names:
            said = f"{student!r} is now {' or '.join(map(repr, names))}: "
            if dry_run:
                yield f"{said}the record of {assignment} would be moved."
                continue
            place = store.put_aside(student, assignment)
            said += f"the record of {assignment} was moved to {place}."
            decisions = journal.of(student, assignment)
            if decisions and len(names) == 1:
                journal.hand_on(student, assignment, names[0])
                said += f" So were {len(decisions)} of the decisions, to the new name."
            elif decisions:
                said += f" Whose are the {len(decisions)} decisions? They count for nobody now."
            yield said


def _say_cut(journal: Journal, show: TextIO) -> None:
    if said := journal.said_of_cut():
        print(said, file=show)


def said_of_people(store: Store, standing: Standing) -> Iterator[str]:
    """What waits for people beside undecided answers: appeals, and
    decisions on what has changed since.
    """
    appeals: list[str] = []
    changed: list[str] = []
    contracts = Contracts(store.folder)
    for record in store.all():
        appeals += [record.student] * len(appeals_open(record))
        for name in record.marks:
            decided = standing.decisions.get((record.student, record.assignment, name))
            if changed_since(decided, record, contracts):
                changed.append(record.student)
    for names, what, shown in (
        (appeals, ("appeal is open", "appeals are open"), "with an open appeal"),
        (
            changed,
            (
                "decision is on an answer or a question that has",
                "decisions are on answers or questions that have",
            ),
            "decided, and changed since",
        ),
    ):
        if names:
            since = " changed since" if names is changed else ""
            whose = ", ".join(
                in_a_line(name, 60) for name in list(dict.fromkeys(names))[:MOST_SHOWN]
            )
            yield (
                f"{len(names)} {what[len(names) > 1]}{since} ({whose}): `coursework review` shows "
                f"them as {shown!r}."
            )


def _is_done(store: Store, one: Work, key: str) -> bool:
    key_of_work = one.student, one.assignment
    # A notebook that this machine could not run is tried again.
    return any(
        record is not None
        and record.key == key
        and not any(notebook.isolation.given_up is not None for notebook in record.notebooks)
        for record in (store.read(*key_of_work), store.staged(*key_of_work))
    )


def _is_same(record: Record, other: Record, name: str) -> bool:
    """Whether two records hold the same answer, in whatever cell."""
    return record.answer(name).plain == other.answer(name).plain


def key_of(work: Work, asked: Mapping[str, Json], limits: Limits, weak: bool) -> str:
    """What of a record depends on running the work, as one short text;
    it is judged again without that.

    ``asked`` is what the sandbox is told of the questions: with a call that was
    mended just those are run again.
    """
    depends = [
        [
            [
                notebook.digest,
                notebook.handed_in,
                [[one.name, one.digest] for one in notebook.beside],
            ]
            for notebook in work.notebooks
        ],
        [notebook.digest for notebook in work.superseded],
        reply_of(work),
        asked,
        vars(limits),
        weak,
        software(),
    ]
    return hashlib.sha256(json.dumps(depends, sort_keys=True).encode()).hexdigest()


def reply_of(work: Work) -> str:
    """How the name of a page begins that goes back to the student: what the
    system wrote of the newest notebook.
    """
    return max((*work.notebooks, *work.superseded), key=_by_age).claim.reply


class _Jobs:
    """The jobs of the sandbox, one for each notebook, and which work each belongs to."""

    def __init__(
        self,
        work: Sequence[Work],
        questions: Mapping[str, Questions],
        store: Store,
        contracts: Contracts,
        before: Callable[[Work], Record | None],
    ) -> None:
        self.work = work
        self.questions = questions
        self.store = store
        self.contracts = contracts
        self.before = before

    def __len__(self) -> int:
        return sum(len(one.notebooks) for one in self.work)

    def __iter__(self) -> Iterator[Job]:
        for order in range(len(self.work)):
            yield from self.of(order)

    def of(self, order: int) -> Iterator[Job]:
        """The jobs of one student's work."""
        one = self.work[order]
        named = {name for notebook in one.notebooks for name in notebook.named}
        own, _ = marking.of_student(
            self.questions[one.assignment], one.numbers, self.before(one), self.contracts
        )
        asked = marking.asked_of_sandbox(marking.with_second_chances(own, named))
        for_a_person = any(
            kinds()[asked.contract.question.kind].by_a_person for asked in own.values()
        )
        for part, notebook in enumerate(one.notebooks):
            cells = notebook.cells
            self.store.keep_work(notebook.digest, [cell["source"] for cell in cells])
            if for_a_person:
                self.store.keep_pictures(notebook.digest, notebook.pictures)
            files = {name: base64.b64encode(data).decode() for name, data in notebook.files.items()}
            job: Job = {"id": f"{order} {part}", "cells": cells, "questions": asked, "seed": 0}
            yield {**job, "files": files} if files else job

    def given_up(self, order: int, why: str) -> list[Result]:
        """The results of work that could not be run."""
        from .execution.sandbox import given_up

        return [given_up(job, why) for job in self.of(order)]

    def whole(self, results: Iterable[Result]) -> Iterator[tuple[int, list[Result]]]:
        """Give the order of each work with the results of its notebooks, once it has them all."""
        found: dict[int, dict[int, Result]] = {}
        for result in results:
            order, part = map(int, text(result["id"], "'id'").split())
            parts = found.setdefault(order, {})
            parts[part] = result
            if len(parts) == len(self.work[order].notebooks):
                yield order, [found[order][part] for part in range(len(parts))]
                del found[order]


MARKING_ENDED = "The process that ran and judged it ended again and again."


def _here(
    jobs: _Jobs,
    finish: Finish,
    workers: int,
    limits: Limits,
    allow_weak_isolation: bool,
    store: Store,
) -> Iterator[Finished]:
    """Run and judge on this machine: each process has a sandbox, and does
    one student's work after another.
    """
    from .execution.sandbox import Sandbox, WeakIsolation, WorkerDied, copies_are_apart, given_up

    first = None

    def prepare(stack: contextlib.ExitStack) -> Callable[[int], Finished]:
        store.in_copy_of_process()
        sandbox = stack.enter_context(
            Sandbox(limits, allow_weak_isolation=allow_weak_isolation, like=first)
        )

        def run(job: Job) -> Result:
            try:
                return sandbox.run(job)
            except WorkerDied as error:
                # It costs only the notebook under which the sandbox dies again and again.
                return given_up(job, str(error))

        return lambda order: finish(order, [run(job) for job in jobs.of(order)])

    number = len(jobs.work)
    with contextlib.ExitStack() as stack:
        if number and copies_are_apart():
            first = stack.enter_context(Sandbox(limits, allow_weak_isolation=allow_weak_isolation))
        yield from side_by_side(
            range(number),
            min(workers, number),
            prepare,
            (WeakIsolation, WorkerDied, intake.Unfit),
            lambda order: finish(order, jobs.given_up(order, MARKING_ENDED)),
        )


def _on_cluster(
    jobs: _Jobs,
    finish: Finish,
    workers: int,
    scheduler: str,
    keys: Path | None,
    limits: Limits,
    allow_weak_isolation: bool,
    store: Store,
) -> Iterator[Finished]:
    """Run on a cluster and judge here: right answers do not leave this machine."""
    from .execution.cluster import run_on_cluster

    def prepare(stack: contextlib.ExitStack) -> Callable[[tuple[int, list[Result]]], Finished]:
        store.in_copy_of_process()
        return lambda task: finish(*task)

    def results() -> Iterator[tuple[int, list[Result]]]:
        # Not before the processes are there, which are to have no part in the connection.
        if jobs.work:
            yield from jobs.whole(
                run_on_cluster(
                    jobs, scheduler, limits, keys=keys, allow_weak_isolation=allow_weak_isolation
                )
            )

    def lost(task: tuple[int, list[Result]]) -> Finished:
        return finish(task[0], jobs.given_up(task[0], MARKING_ENDED))

    return side_by_side(results(), min(workers, len(jobs.work)), prepare, lost=lost)


def record_of(
    work: Work, results: Sequence[Result], key: str, questions: Mapping[str, Asked], limits: Limits
) -> Record:
    """The record of a student's work, before it is judged."""
    ran, given = zip(
        *(
            read_result(result, one.file)
            for result, one in zip(results, work.notebooks, strict=True)
        )
    )
    known = marking.with_second_chances(questions)
    answers = {}
    for name in given[0]:
        # Of several notebooks the one that says something; they have no question in common.
        answer = min((one[name] for one in given), key=_says_little)
        if answer.secret is not None and (secret := known[name].secret):
            answer = replace(answer, secret={**answer.secret, "calls": secret.digest})
        answers[name] = answer
    return Record(
        work.student,
        work.assignment,
        key,
        work.notebooks[0].identity,
        tuple(sorted({notebook.says for notebook in work.notebooks if notebook.says})),
        reply_of(work),
        tuple(
            replace(
                run,
                file=notebook.file,
                sha256=notebook.digest,
                beside=tuple(one.name for one in notebook.beside),
                late=notebook.late,
                handed_in=notebook.handed_in,
            )
            for run, notebook in zip(ran, work.notebooks)
        ),
        tuple(
            Superseded(notebook.file, notebook.digest, why)
            for notebook, why in zip(work.superseded, work.why, strict=True)
        ),
        software(),
        vars(limits),
        all(one.finished for one in ran),
        answers,
        {name: about for notebook in work.notebooks for name, about in notebook.remembered.items()},
    )


def _says_little(answer: Answer) -> int:
    if answer.outcome in ("recorded", "unreadable"):
        return 3 if answer.is_blank else ("recorded", "unreadable").index(answer.outcome)
    return 4 if answer.outcome == "missing" else 2


def marked(
    record: Record, judge: Judge, standing: Standing | None = None, policies: Policies | None = None
) -> Record:
    """A record with the verdicts on its answers; what a person
    decided on an answer stands above them.
    """
    questions = judge.questions[record.assignment]
    own, cases = marking.of_student(
        judge.questions[record.assignment], record.student, record, judge.contracts
    )
    for asked in own.values():
        for one in (asked.contract, asked.before, *asked.second_chances.values()):
            if one is not None:
                judge.contracts.keep(one)
    found = judge.marks(record)
    marks = {}
    for name, asked in own.items():
        before = record.marks.get(name)
        taken_out = cases[name].own.variant not in variants_of(questions[name])
        mark = (policies or Policies()).applied(
            name, found[name], before and before.judged, cases[name], taken_out
        )
        # What the lines of a rubric are worth, where its author said so.
        rubric = asked.contract.rubric if isinstance(asked.contract.rubric, dict) else None
        marks[name] = replace(mark, title=asked.contract.title, rubric=rubric)
        judged = replace(cases[name].own, judged=asked.contract.version)
        cases[name] = replace(cases[name], own=judged)
    return with_decisions(replace(record, cases=cases, marks=marks), standing or Standing())


class _Progress:
    """How far it is and how long it will take, on one line that is written over."""

    def __init__(self, total: int, show: TextIO) -> None:
        self.total, self.show, self.done = total, show, 0
        self.start = self.last = time.monotonic()
        self.told = False

    def one_more(self, isolation: Isolation) -> None:
        self.done += 1
        if not self.told:
            self.told = True
            kind = "WEAK isolation" if isolation.weak else "Isolation"
            print(f"{kind}: {', '.join(isolation.layers) or 'none'}.", file=self.show)
            for line in isolation.not_stopped or ():
                print(f"  not stopped: {line}", file=self.show)
        now = time.monotonic()
        on_screen = self.show.isatty()
        if self.done == 1:
            # What comes before the first is the start of the sandboxes,
            # which takes no longer for more.
            self.first = self.last = now
        if self.done == self.total or now - self.last > (0.2 if on_screen else 10):
            self.last = now
            left = (now - self.first) / max(1, self.done - 1) * (self.total - self.done)
            said = f"{self.done} of {self.total} graded, " + (
                f"{_span(left)} left" if self.done < self.total else f"in {_span(now - self.start)}"
            )
            end = "\n" if not on_screen or self.done == self.total else ""
            print(f"\r\x1b[K{said}" if on_screen else said, end=end, file=self.show, flush=True)


def _span(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 90 else f"{seconds / 60:.0f} min"


# --- grading again ------------------------------------------------------------------------------


def regrade(
    out: str | Path,
    *,
    solutions: str | Path | None = None,
    dry_run: bool = False,
    show: TextIO | None = None,
    agree: Agree = always,
) -> Laboratory:
    """Judge the stored answers again, by the questions and people's decisions as they are now.

    Parameters
    ----------
    out : path
    solutions : path, optional
    dry_run : bool
        Write what would move into a page and a table, and nothing else.
    agree : function
        Hears which marks would move, and says whether they shall.

    Nothing is run. A question that was added since has no answers in
    the records; grade again for that.
    """
    from .reporting import reports

    store = Store(out)
    with contextlib.ExitStack() as closing:
        closing.enter_context(store.locked())
        names = sorted({record.assignment for record in store.all()})
        if not names:
            raise NothingToGrade(f"There are no records in {store.folder}.")
        term = term_of(store.folder)
        course = Course(solutions, term, names)
        questions = course.questions(names, store.folder / "questions")
        policies = term.policies
        policies.demand(course.all_questions)
        journal = Journal(store.folder)
        _say_cut(journal, show or sys.stderr)
        standing = journal.standing()
        judge = closing.enter_context(Judge(questions, Contracts(store.folder), store.log))
        candidates = (marked(record, judge, standing, policies) for record in store.all())
        laboratory = settle(store, journal, candidates, agree, REJUDGED, dry_run)
        reports.write_moves(laboratory, store.folder)
        if dry_run or not laboratory.agreed:
            return laboratory
        for line in said_of_people(store, standing):
            print(line, file=show or sys.stderr)
        write(store.folder / reports.LINKS, as_text(links_of(course.folder)))
        reports.write_all(store)
    return laboratory


def bring_in_decisions(
    out: str | Path, *, show: TextIO | None = None, agree: Agree = always
) -> Laboratory:
    """Bring what people decided into marks and pages; nothing is judged anew."""
    from .reporting import reports

    store = Store(out)
    with store.locked():
        journal = Journal(store.folder)
        _say_cut(journal, show or sys.stderr)
        standing = journal.standing()
        candidates = (with_decisions(record, standing) for record in store.all())
        laboratory = settle(store, journal, candidates, agree, DECIDED)
        reports.write_moves(laboratory, store.folder)
        for line in said_of_people(store, standing):
            print(line, file=show or sys.stderr)
        reports.write_all(store)
    return laboratory
