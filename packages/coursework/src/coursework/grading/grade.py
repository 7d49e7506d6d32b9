"""Grade a class: read submissions, match them to students, run and judge them, and report.

A record is written as soon as a student's work on an assignment is graded. Its key depends on
everything that influences it: the bytes of the notebooks, the questions, the limits and the
versions of the software. A run leaves a record with the right key alone, so a run that was killed
continues where it stopped.
"""

from __future__ import annotations

import contextlib
import functools
import sys
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TextIO

from ..authoring.course import links_of
from ..checking.fields import by_name, many
from .assignments import Course, NothingToGrade
from .judging import marking
from .judging.cases import Contracts, answered, changed_since, variants_of
from .judging.contract import Asked
from .judging.journal import Given, Journal, Standing, appeals_open, with_decisions
from .judging.judge import Judge
from .judging.laboratory import PAGE, Agree, Laboratory, settle
from .judging.term import term_of
from .pairing import (
    HandedIn,
    Work,
    demand_a_class,
    demand_own_numbers,
    follow_renamed,
    pair,
    read,
    say,
    say_other_numbers,
)
from .record import Case, Isolation, Record, Result
from .running import Finished, Jobs, Progress, Running, key_of, record_of, run
from .store import REFUSED, Store, as_text, write
from .submissions.intake import Refused
from .submissions.roster import BadRoster
from .tables import in_a_line, number_of

#: The reasons for changing marks other than resubmitted work.
REJUDGED = "the questions or the software have changed"
DECIDED = "a person decided"
# The most names on the screen.
MOST_SHOWN = 40


class Desk:
    """A folder of marks at work: the term, the earlier events, and the questions.

    Parameters
    ----------
    store : Store
    show : file, optional
        Receives messages about progress.
    agree : function
        Receives the changes to marks given before, and returns whether to make them.
    """

    def __init__(self, store: Store, show: TextIO | None, agree: Agree) -> None:
        self.store, self.show, self.agree = store, show or sys.stderr, agree
        self.term, self.contracts = term_of(store.folder), Contracts(store.folder)
        self.journal = Journal(store.folder)
        self.tell(self.journal.said_of_cut())

    @functools.cached_property
    def standing(self) -> Standing:
        return self.journal.standing()

    def ask(
        self, course: Course, assignments: Iterable[str], closing: contextlib.ExitStack
    ) -> None:
        """Read the questions of some assignments."""
        self.course, results = course, self.store.folder
        self.questions = course.questions(sorted(set(assignments)), results)
        self.term.regrading.demand(course.all_questions)
        every = {name: those for asked in self.questions.values() for name, those in asked.items()}
        self.earlier = marking.earlier_variants(every, results)
        self.judge = closing.enter_context(Judge(self.questions, self.contracts, self.store.log))

    def tell(self, *lines: str) -> None:
        for line in filter(None, lines):
            print(line, file=self.show)

    # -- one student's work

    def asked(self, work: Work) -> tuple[dict[str, Asked], dict[str, Case]]:
        """Return a student's questions and cases. A student who was graded before keeps them."""
        return marking.of_student(
            self.questions[work.assignment],
            work.numbers,
            self.store.read(*work.key),
            self.contracts,
            self.earlier,
            lambda text: any(notebook.shows(text) for notebook in work.notebooks),
        )

    def marked(self, record: Record) -> Record:
        """Return a record with the verdicts on its answers, which people's decisions override."""
        questions = self.questions[record.assignment]
        own, cases = marking.of_student(questions, record.student, record, self.contracts)
        for asked in own.values():
            for contract in (asked.contract, asked.before, *asked.second_chances.values()):
                if contract is not None:
                    self.contracts.keep(contract)
        verdicts = self.judge.marks(record)
        marks = {}
        for name, asked in own.items():
            before, case = record.marks.get(name), cases[name]
            taken_out = case.own.variant not in variants_of(questions[name])
            mark = self.term.regrading.applied(
                name, verdicts[name], before and before.judged, case, taken_out
            )
            marks[name] = replace(
                mark,
                title=asked.contract.title,
                # The worth of each line, where the author gave one.
                rubric={
                    line: worth
                    for line, worth in asked.contract.rubric.items()
                    if worth is not None
                },
            )
            judged = replace(case.own, judged=asked.contract.version)
            cases[name] = replace(case, own=judged)
        return with_decisions(replace(record, cases=cases, marks=marks), self.standing)

    # -- everybody's work

    def settle(self, candidates: Iterable[Record], why: str, dry_run: bool = False) -> Laboratory:
        """Give marks; a page shows the changes before a person agrees."""
        from .reporting import reports

        def agree(laboratory: Laboratory) -> bool:
            reports.write_moves(laboratory, self.store.folder)
            return not dry_run and self.agree(laboratory)

        laboratory = settle(self.store, self.journal, candidates, agree, why, dry_run)
        if not laboratory.moves and (self.store.folder / PAGE).exists():
            reports.write_moves(laboratory, self.store.folder)
        return laboratory

    def report(self, course: Course | None = None) -> None:
        """Write tables and pages of the marks, and list what waits for a person."""
        from .reporting import reports

        if course:
            write(self.store.folder / reports.LINKS, as_text(links_of(course.folder)))
        self.tell(*reports.write_all(self.store))
        self.tell(*said_of_people(self.store, self.standing, self.contracts))


@contextlib.contextmanager
def at_desk(
    out: str | Path, show: TextIO | None, agree: Agree
) -> Iterator[tuple[Desk, contextlib.ExitStack]]:
    """Open a folder of marks and lock out other runs."""
    store = Store(out)
    with store.locked(), contextlib.ExitStack() as closing:
        yield Desk(store, show, agree), closing


def grade(
    submissions: str | Path,
    out: str | Path,
    *,
    solutions: str | Path | None = None,
    only: Collection[str] = (),
    student: str | None = None,
    as_listed: bool = False,
    dry_run: bool = False,
    running: Running | None = None,
    show: TextIO | None = None,
    agree: Agree = lambda laboratory: True,
) -> dict[str, int]:
    """Grade the submissions and write records and reports to the folder ``out``.

    Its file ``term.toml`` lists the people in the course and the assignments.

    Parameters
    ----------
    submissions, out : path
    solutions : path, optional
        The folder of the notebooks with solutions and of the course's secret.
    only : collection of str
        The assignments to grade, if not all.
    student : str, optional
        The one student who handed in everything.
    as_listed : bool
        Continue although many notebooks carry another student's ID.
    dry_run : bool
        Show whose each file is, and how many would run; run nothing and change no record.
    running : Running, optional
        How notebooks are run.
    show : file, optional
        Receives messages about progress.
    agree : function
        Receives the changes to marks given before, and returns whether to make them.

    Returns
    -------
    dict
        How many were ``graded`` now, were graded before (``kept``) and were ``refused``; and how
        many earlier marks did not change since nobody agreed (``held``).

    Raises
    ------
    NothingToGrade, BadTerm, BadRoster, InUse, WeakIsolation
    """
    running = running or Running()
    running.demand()
    with at_desk(out, show, agree) as (desk, closing):
        course, place = Course(solutions, desk.term, only), Path(submissions)
        handed_in = _read_and_pair(desk, course, place, student)
        foreign = say(
            handed_in,
            desk.term,
            {
                event.student
                for event in desk.journal.events
                # Everybody has a record of a sitting, so it does not show that somebody handed in
                # work.
                if isinstance(event, Given) and event.assignment not in desk.term.sittings
            },
            desk.store.folder,
            desk.show,
        )
        demand_a_class(handed_in.work, desk.term.roster, student)
        desk.ask(course, (work.assignment for work in handed_in.work), closing)
        if not as_listed:
            demand_own_numbers(handed_in.work, desk.questions, foreign, desk.term.roster)
        desk.tell(*follow_renamed(desk.store, handed_in, desk.journal, desk.term, dry_run))
        keys = [(work, key_of(work, desk.asked(work)[0], running)) for work in handed_in.work]
        waiting = [work for work, key in keys if not _is_done(desk.store, work, key)]
        kept, refused = len(keys) - len(waiting), len(handed_in.refused)
        desk.tell(
            f"{len(keys)} to grade, {kept} of them graded before, "
            f"{number_of(refused, 'file')} refused."
        )
        said = {"graded": 0 if dry_run else len(waiting), "kept": kept, "refused": refused}
        if dry_run:
            return {**said, "held": 0}
        _run_and_judge(desk, waiting, running)
        laboratory = desk.settle(_candidates(desk, keys, waiting), REJUDGED)
        _keep_refused(desk.store, place, handed_in.refused)
        desk.report(course)
        say_other_numbers(desk.store, handed_in.work, desk.questions, desk.show)
    return {**said, "held": 0 if laboratory.agreed else len(laboratory.moves)}


def _read_and_pair(desk: Desk, course: Course, place: Path, student: str | None) -> HandedIn:
    people = desk.term.roster
    if student is not None and people and student not in {*people.people, *desk.term.groups}:
        raise BadRoster(f"The roster has no student {student!r}.")
    notebooks, refused = read(place, course, desk.term, student, desk.store.folder)
    return pair(notebooks, refused, course, desk.term, desk.store)


def _is_done(store: Store, work: Work, key: str) -> bool:
    """Check whether the work has a record of notebooks that this machine could run."""
    return any(
        record is not None
        and record.key == key
        and not any(notebook.isolation.given_up is not None for notebook in record.notebooks)
        for record in (store.read(*work.key), store.staged(*work.key))
    )


def _run_and_judge(desk: Desk, waiting: Sequence[Work], running: Running) -> None:
    """Run and judge the waiting work. Each record is written at once but does not count yet."""
    store, progress = desk.store, Progress(len(waiting), desk.show)
    # Read people's decisions once, not in each process.
    _ = desk.standing

    def finish(order: int, results: Sequence[Result]) -> Finished:
        work = waiting[order]
        own, cases = desk.asked(work)
        record = record_of(work, results, own, running)
        record = replace(
            record, cases={name: answered(case, own[name]) for name, case in cases.items()}
        )
        store.stage(desk.marked(with_marks_of(store.read(*work.key), record)))
        return order, record.notebooks[0].isolation.as_json()

    jobs = Jobs(waiting, lambda work: desk.asked(work)[0], store)
    for order, isolation in run(jobs, finish, running):
        store.log(f"graded: {waiting[order].student!r} {waiting[order].assignment}")
        progress.one_more(Isolation.from_json(isolation))


def _candidates(
    desk: Desk, keys: Sequence[tuple[Work, str]], waiting: Sequence[Work]
) -> Iterator[Record]:
    """Iterate over all records of these assignments, as they would be now."""
    store, run_now = desk.store, {work.key for work in waiting}
    for work, key in keys:
        old, staged = store.read(*work.key), store.staged(*work.key)
        if work.key in run_now and staged:
            yield staged
        elif old and old.key == key:
            yield desk.marked(old)
        elif staged and staged.key == key:
            yield desk.marked(with_marks_of(old, staged))
    here = {work.key for work, _ in keys}
    for record in store.all():
        if (record.student, record.assignment) not in here and record.assignment in desk.questions:
            yield desk.marked(record)


def _keep_refused(store: Store, place: Path, refused: Iterable[Refused]) -> None:
    """Write down the refused files, keeping those of other folders."""
    everywhere = store.said(REFUSED, by_name(many(Refused.from_json))) or {}
    everywhere[str(place.resolve())] = tuple(sorted(refused))
    write(
        store.folder / REFUSED,
        as_text({name: [file.as_json() for file in those] for name, those in everywhere.items()}),
    )


def with_marks_of(old: Record | None, record: Record) -> Record:
    """Return a record with the marks of the same answers before.

    A never-lower policy thus also covers students who handed in the same answer again.
    """
    same = old.marks.items() if old else ()
    return replace(
        record,
        # The cell of an answer does not matter.
        marks={
            name: mark
            for name, mark in same
            if old and old.answer(name).plain == record.answer(name).plain
        },
    )


def said_of_people(store: Store, standing: Standing, contracts: Contracts) -> Iterator[str]:
    """Iterate over what waits for people apart from undecided answers.

    These are appeals, and decisions about something that has changed since.
    """
    appeals: list[str] = []
    changed: list[str] = []
    for record in store.all():
        appeals += [record.student] * len(appeals_open(record))
        for name in record.marks:
            decided = standing.decisions.get((record.student, record.assignment, name))
            if changed_since(decided, record, contracts):
                changed.append(record.student)
    for names, one, several, shown in (
        (appeals, "appeal is open", "appeals are open", "with an open appeal"),
        (
            changed,
            "decision is about an answer or a question that has changed since",
            "decisions are about answers or questions that have changed since",
            "decided, and changed since",
        ),
    ):
        if names:
            whose = ", ".join(
                in_a_line(name, 60) for name in list(dict.fromkeys(names))[:MOST_SHOWN]
            )
            yield (
                f"{len(names)} {several if len(names) > 1 else one} ({whose}): "
                f"`coursework review` shows them as {shown!r}."
            )


# --- grading again ------------------------------------------------------------------------------


def regrade(
    out: str | Path,
    *,
    solutions: str | Path | None = None,
    dry_run: bool = False,
    show: TextIO | None = None,
    agree: Agree = lambda laboratory: True,
) -> Laboratory:
    """Judge the stored answers again, by the current questions and people's decisions.

    Parameters
    ----------
    out : path
    solutions : path, optional
    dry_run : bool
        Write the possible changes to a page and a table, and nothing else.
    agree : function
        Receives the changes to marks, and returns whether to make them.

    Nothing is run. The records have no answers to a question that was added since, for which you
    need to grade again.
    """
    with at_desk(out, show, agree) as (desk, closing):
        names = sorted({record.assignment for record in desk.store.all()})
        if not names:
            raise NothingToGrade(f"There are no records in {desk.store.folder}.")
        course = Course(solutions, desk.term, names)
        desk.ask(course, names, closing)
        laboratory = desk.settle(map(desk.marked, desk.store.all()), REJUDGED, dry_run)
        if not dry_run and laboratory.agreed:
            desk.report(course)
    return laboratory


def bring_in_decisions(
    out: str | Path, *, show: TextIO | None = None, agree: Agree = lambda laboratory: True
) -> Laboratory:
    """Apply people's decisions to marks and pages, without judging anything."""
    with at_desk(out, show, agree) as (desk, _):
        laboratory = desk.settle(
            (with_decisions(record, desk.standing) for record in desk.store.all()), DECIDED
        )
        desk.report()
    return laboratory
