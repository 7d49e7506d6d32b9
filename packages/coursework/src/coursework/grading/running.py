"""Run notebooks on this machine or on a cluster, and make records of the results."""

from __future__ import annotations

import base64
import contextlib
import hashlib
import importlib.util
import json
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from ..checking.fields import Json, text
from ..checking.plugins import kinds
from .execution.cluster_keys import demand_keys
from .judging import marking
from .judging.contract import Asked
from .pairing import Work
from .record import Answer, Isolation, Record, Remembered, Result, Superseded, read_result
from .store import Store
from .submissions import intake
from .versions import software
from .workers import processors, side_by_side

# Import the execution modules lazily: they load slowly, and only grading needs them.
if TYPE_CHECKING:
    from .execution.isolation import Limits
    from .execution.sandbox import Job

#: The order of the work that was graded, and its isolation as JSON.
Finished = tuple[int, dict[str, Json]]
Finish = Callable[[int, Sequence[Result]], Finished]
#: A function that returns the questions of the student whose work it is.
AskedOf = Callable[[Work], dict[str, Asked]]


def _limits() -> Limits:
    from .execution.isolation import Limits

    return Limits()


@dataclass(frozen=True)
class Running:
    """How notebooks are run.

    Attributes
    ----------
    workers : int
        The number of notebooks to run at a time.
    scheduler : str or None
        The address of a Dask cluster.
    keys : path or None
        The folder of its keys.
    allow_weak_isolation : bool
    limits : Limits
    """

    workers: int = field(default_factory=processors)
    scheduler: str | None = None
    keys: str | Path | None = None
    allow_weak_isolation: bool = False
    limits: Limits = field(default_factory=_limits)

    def demand(self) -> None:
        """Reject impossible settings before anything is read.

        Raises
        ------
        ValueError
        """
        if self.workers < 1:
            raise ValueError(f"The number of workers must be at least one, not {self.workers}.")
        if self.scheduler and importlib.util.find_spec("distributed") is None:
            raise ValueError(
                "To use a cluster, first install Dask: python -m pip install distributed"
            )
        if self.scheduler:
            demand_keys(self.scheduler, Path(self.keys) if self.keys else None)


class Jobs:
    """The jobs of the sandbox, one for each notebook, and the work that each belongs to."""

    def __init__(self, work: Sequence[Work], asked_of: AskedOf, store: Store) -> None:
        self.work, self.asked_of, self.store = work, asked_of, store

    def __len__(self) -> int:
        return sum(len(work.notebooks) for work in self.work)

    def __iter__(self) -> Iterator[Job]:
        for order in range(len(self.work)):
            yield from self.of(order)

    def of(self, order: int) -> Iterator[Job]:
        """Iterate over the jobs of one student's work."""
        work = self.work[order]
        named = {name for notebook in work.notebooks for name in notebook.named}
        own = self.asked_of(work)
        asked = marking.asked_of_sandbox(marking.with_second_chances(own, named))
        for_a_person = any(
            kinds()[asked.contract.question.kind].by_a_person for asked in own.values()
        )
        for part, notebook in enumerate(work.notebooks):
            cells = notebook.cells
            self.store.keep_work(notebook.digest, [cell["source"] for cell in cells])
            if for_a_person:
                self.store.keep_pictures(notebook.digest, notebook.pictures)
            files = {name: base64.b64encode(data).decode() for name, data in notebook.files.items()}
            job: Job = {"id": f"{order} {part}", "cells": cells, "questions": asked, "seed": 0}
            yield {**job, "files": files} if files else job

    def given_up(self, order: int, why: str) -> list[Result]:
        """Return results for work that could not be run."""
        from .execution.sandbox import given_up

        return [given_up(job, why) for job in self.of(order)]

    def whole(self, results: Iterable[Result]) -> Iterator[tuple[int, list[Result]]]:
        """Iterate over each work's order and the results of its notebooks once all are there."""
        by_work: dict[int, dict[int, Result]] = {}
        for result in results:
            order, part = map(int, text(result["id"], "'id'").split())
            parts = by_work.setdefault(order, {})
            parts[part] = result
            if len(parts) == len(self.work[order].notebooks):
                yield order, [by_work[order][part] for part in range(len(parts))]
                del by_work[order]


MARKING_ENDED = "The process that ran and judged it died repeatedly."


def run(jobs: Jobs, finish: Finish, running: Running) -> Iterator[Finished]:
    """Run all jobs, and finish each work once its notebooks have run."""
    return on_cluster(jobs, finish, running) if running.scheduler else here(jobs, finish, running)


def here(jobs: Jobs, finish: Finish, running: Running) -> Iterator[Finished]:
    """Run and judge on this machine, in processes that each have a sandbox."""
    from .execution.sandbox import Sandbox, WeakIsolation, WorkerDied, given_up

    def prepare(stack: contextlib.ExitStack) -> Callable[[int], Finished]:
        jobs.store.in_copy_of_process()
        sandbox = stack.enter_context(
            Sandbox(running.limits, allow_weak_isolation=running.allow_weak_isolation)
        )

        def run_one(job: Job) -> Result:
            try:
                return sandbox.run(job)
            except WorkerDied as error:
                # Give up only the notebook on which the sandbox dies again and again.
                return given_up(job, str(error))

        return lambda order: finish(order, [run_one(job) for job in jobs.of(order)])

    number = len(jobs.work)
    yield from side_by_side(
        range(number),
        min(running.workers, number),
        prepare,
        (WeakIsolation, WorkerDied, intake.Unfit),
        lambda order: finish(order, jobs.given_up(order, MARKING_ENDED)),
    )


def on_cluster(jobs: Jobs, finish: Finish, running: Running) -> Iterator[Finished]:
    """Run on a cluster, but judge here, so that right answers do not leave this machine."""
    from .execution.cluster import run_on_cluster

    def prepare(stack: contextlib.ExitStack) -> Callable[[tuple[int, list[Result]]], Finished]:
        jobs.store.in_copy_of_process()
        return lambda task: finish(*task)

    def results() -> Iterator[tuple[int, list[Result]]]:
        # Connect only after forking the processes, which must not share the connection.
        if jobs.work:
            yield from jobs.whole(
                run_on_cluster(
                    jobs,
                    running.scheduler or "",
                    running.limits,
                    keys=Path(running.keys) if running.keys else None,
                    allow_weak_isolation=running.allow_weak_isolation,
                )
            )

    def lost(task: tuple[int, list[Result]]) -> Finished:
        return finish(task[0], jobs.given_up(task[0], MARKING_ENDED))

    return side_by_side(results(), min(running.workers, len(jobs.work)), prepare, lost=lost)


def key_of(work: Work, own: Mapping[str, Asked], running: Running) -> str:
    """Return a digest of everything that running the work depends on.

    It includes what the sandbox receives about the questions, so a corrected call runs just the
    work concerned again. Without a change of it, work is only judged again.
    """
    depends = [
        [
            [
                notebook.digest,
                notebook.handed_in,
                [[file.name, file.digest] for file in notebook.beside],
            ]
            for notebook in work.notebooks
        ],
        [notebook.digest for notebook in work.superseded],
        work.reply,
        marking.asked_of_sandbox(marking.with_second_chances(own)),
        vars(running.limits),
        running.allow_weak_isolation,
        software(),
    ]
    return hashlib.sha256(json.dumps(depends, sort_keys=True).encode()).hexdigest()


def record_of(
    work: Work, results: Sequence[Result], own: Mapping[str, Asked], running: Running
) -> Record:
    """Return the record of a student's work before it is judged."""
    ran, given = zip(
        *(
            read_result(result, notebook.file)
            for result, notebook in zip(results, work.notebooks, strict=True)
        )
    )
    known = marking.with_second_chances(own)
    answers = {}
    for name in given[0]:
        # The notebooks have no question in common, so take the one that has an answer.
        answer = min((of_notebook[name] for of_notebook in given), key=_says_little)
        if answer.secret is not None and (secret := known[name].secret):
            answer = replace(answer, secret={**answer.secret, "calls": secret.digest})
        answers[name] = answer
    remembered: dict[str, Remembered] = {}
    for notebook in work.notebooks:
        remembered |= notebook.remembered
    return Record(
        student=work.student,
        assignment=work.assignment,
        key=key_of(work, own, running),
        identity=work.notebooks[0].identity,
        says=tuple(sorted({notebook.says for notebook in work.notebooks if notebook.says})),
        reply=work.reply,
        notebooks=tuple(
            replace(
                run,
                file=notebook.file,
                sha256=notebook.digest,
                beside=tuple(file.name for file in notebook.beside),
                late=notebook.late,
                handed_in=notebook.handed_in,
            )
            for run, notebook in zip(ran, work.notebooks)
        ),
        superseded=tuple(
            Superseded(notebook.file, notebook.digest, why)
            for notebook, why in zip(work.superseded, work.why, strict=True)
        ),
        software=software(),
        limits=vars(running.limits),
        finished=all(result.finished for result in ran),
        answers=answers,
        remembered=remembered,
    )


def _says_little(answer: Answer) -> int:
    if answer.outcome in ("recorded", "unreadable"):
        return 3 if answer.is_blank else ("recorded", "unreadable").index(answer.outcome)
    return 4 if answer.outcome == "missing" else 2


class Progress:
    """A line that shows progress and the time left, and overwrites itself."""

    def __init__(self, total: int, show: TextIO) -> None:
        self.total, self.show, self.done = total, show, 0
        self.start = self.last = time.monotonic()
        self.told = False

    def one_more(self, isolation: Isolation) -> None:
        self.done += 1
        if not self.told:
            self.told = True
            print(
                "WEAK isolation:" if isolation.weak else "Isolation:",
                f"{', '.join(isolation.layers) or 'none'}.",
                file=self.show,
            )
            for line in isolation.not_stopped or ():
                print(f"  not stopped: {line}", file=self.show)
        now = time.monotonic()
        on_screen = self.show.isatty()
        if self.done == 1:
            # The time before the first is that of starting the sandboxes, which does not grow with
            # the number of notebooks.
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
