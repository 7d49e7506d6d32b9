"""Isolated execution of students' notebooks, which returns their answers as plain data.

`run_notebooks` takes jobs and yields results, both plain JSON. Three kinds of process take part:

- this one, which is trusted: it starts warm parents, enforces time limits, reads the records
  strictly (`coursework.grading.execution.records`) and combines the results. It never runs or
  unpickles anything of a student's, and never repeats it on the console;
- a warm parent for each worker (`coursework.grading.execution.warm_parent`), which only forks;
- a child for each notebook, confined (`coursework.grading.execution.isolation`), which runs the
  cells (`coursework.grading.execution.notebook`).

No process here judges anything or has a right answer. Marks are decided elsewhere, from the
results.

A cell that ends or hangs its process costs only itself. Earlier records are kept, and the notebook
runs again without that cell, up to a limit.
"""

from __future__ import annotations

import contextlib
import dataclasses
import fcntl
import json
import math
import os
import random
import secrets
import select
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import IO, NotRequired, TypedDict

from coursework.checking.fields import Json, written
from coursework.grading.execution import isolation, records, scratch, steady
from coursework.grading.execution.isolation import LAYERS, NAMESPACES, Limits, Report, Target
from coursework.grading.execution.records import Record, Step
from coursework.grading.execution.warm_parent import NOT_CONFINED
from coursework.grading.record import MISSING, Answer, Cell, Isolation, Result
from coursework.grading.submissions.intake import CodeCell
from coursework.grading.workers import side_by_side

# Seconds for a warm parent to load its libraries, on a machine that is busy.
WAIT_FOR_START = 120
# Seconds for a killed notebook to be gone.
WAIT_FOR_END = 30
# The folder of the file that the isolation is tested on.
OUTSIDE = "outside"
# Seconds in which records accumulate, since waking up for each takes both processes longer than the
# record itself.
PAUSE = 0.005
DEEPEST_STEPS = 10
# The most names of questions that do not exist to keep from one notebook.
MOST_UNKNOWN = 20
NOT_RUN = Cell("not run")
# How many times a job is tried when its worker dies on it.
ATTEMPTS_OF_A_JOB = 3


class Job(TypedDict):
    """A notebook to be run, as JSON.

    For each question, it has the answer's ``"variable"``, and the ``"calls"`` and ``"secret
    calls"`` of a function, as in `coursework.grading.judging.marking.asked_of_sandbox`. The
    ``files`` beside it are in base64.
    """

    id: str
    cells: list[CodeCell]
    questions: Mapping[str, Mapping[str, Json]]
    seed: NotRequired[int]
    files: NotRequired[Mapping[str, str]]


#: A message from the warm parent: that it is ready, or how a notebook's process ended.
Message = TypedDict(
    "Message", {"ready": Report, "ended": dict[str, int], "scratch full": bool}, total=False
)


class WeakIsolation(RuntimeError):
    """An error because this machine cannot isolate student code well enough.

    The message lists what is missing and how to get it.
    """


class WorkerDied(RuntimeError):
    """An error because the warm parent has ended."""


class Sandbox(contextlib.AbstractContextManager["Sandbox"]):
    """One warm parent, isolated and tested, that runs one notebook at a time.

    Parameters
    ----------
    limits : Limits, optional
    allow_weak_isolation : bool
        Run student code although it can do some of what it must not. Every result says so.
    without : collection of str
        Layers to leave out, of `coursework.grading.execution.isolation.LAYERS`; the isolation is
        then weak.

    Raises
    ------
    WeakIsolation
        The layers in force do not stop every attempt.
    """

    def __init__(
        self,
        limits: Limits | None = None,
        *,
        allow_weak_isolation: bool = False,
        without: Collection[str] = (),
    ) -> None:
        unknown = set(without) - set(LAYERS)
        if unknown:
            raise ValueError(
                f"unknown layers {sorted(unknown)}: the layers are {', '.join(LAYERS)}"
            )
        if not sys.platform.startswith("linux"):
            raise WeakIsolation(
                "Isolating student code needs Linux. Elsewhere, use WSL or a container."
            )
        self.limits = limits or Limits()
        self.allow_weak_isolation = allow_weak_isolation
        self.without = frozenset(without)
        self.process: subprocess.Popen[bytes] | None = None
        self.control: socket.socket | None = None
        self.errors: IO[bytes] | None = None
        self.base: str | None = None
        self.report: Report
        self.start()

    def __exit__(self, *error: object) -> None:
        self.close()

    # -- the warm parent

    def start(self) -> None:
        """Start the warm parent and test its isolation."""
        try:
            with contextlib.ExitStack() as stack:
                self.report = self.launched(self.target(stack))
        except BaseException:
            self.close()
            raise
        scratch.remove_folder(os.path.join(str(self.base), OUTSIDE))
        lacking = isolation.lacking(self.report)
        if lacking and not self.allow_weak_isolation:
            self.close()
            raise WeakIsolation(
                "This machine cannot isolate student code well enough, so we did not run any:\n"
                + "\n".join(f"- {line}" for line in lacking)
                + "\nTo run it anyway, on a machine that you can afford to lose, add "
                "--allow-weak-isolation. Every result will record this."
            )

    def target(self, stack: contextlib.ExitStack) -> Target:
        """Return targets for testing the isolation: two ports and a local socket of our own."""
        tcp = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_STREAM))
        udp = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        local = stack.enter_context(socket.socket(socket.AF_UNIX, socket.SOCK_STREAM))
        for inet in (tcp, udp):
            inet.bind(("127.0.0.1", 0))
        name = f"coursework-{secrets.token_hex(8)}"
        local.bind("\0" + name)
        for listener in (tcp, local):
            listener.listen(64)
        return {
            "tcp": tcp.getsockname()[1],
            "udp": udp.getsockname()[1],
            "local": name,
        }

    def launched(self, target: Target) -> Report:
        """Start the warm parent, in namespaces where possible, and return its report."""
        bubblewrap, why_not = shutil.which("bwrap"), "bubblewrap is not installed"
        if NAMESPACES in self.without:
            why_not = "switched off"
        elif bubblewrap is not None:
            try:
                readable = isolation.readable_paths()
                return self.launched_by(isolation.bubblewrap_command(bubblewrap, readable), target)
            except WorkerDied as error:
                self.close()
                why_not = str(error)
        return self.launched_by([], target, why_not)

    def launched_by(self, command: Sequence[str], target: Target, why_not: str = "") -> Report:
        """Start the warm parent by `command`; `why_not` is why it is not in namespaces, if so."""
        self.control, other = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        processes = os.open("/proc", os.O_RDONLY | os.O_DIRECTORY)
        self.errors = tempfile.TemporaryFile()
        self.base = tempfile.mkdtemp(prefix="coursework-")
        os.chmod(self.base, 0o755)
        try:
            with other:
                handles = (other.fileno(), processes)
                self.process = subprocess.Popen(
                    [
                        # Start a process first that removes the folder at the end, even if this one
                        # is killed.
                        sys.executable,
                        "-I",
                        "-S",
                        scratch.__file__,
                        self.base,
                        *command,
                        sys.executable,
                        "-I",
                        "-S",
                        steady.__file__,
                        sys.executable,
                        "-s",
                        "-P",
                        "-B",
                        "-X",
                        "utf8",
                        "-c",
                        "from coursework.grading.execution.warm_parent import main; main()",
                        *map(str, handles),
                    ],
                    stdin=subprocess.DEVNULL,
                    stdout=subprocess.DEVNULL,
                    stderr=self.errors,
                    cwd="/",
                    pass_fds=handles,
                    start_new_session=True,
                    env={
                        "LANG": "C.UTF-8",
                        "TZ": "UTC",
                        "PYTHONHASHSEED": "0",
                        "MPLBACKEND": "Agg",
                        "OPENBLAS_NUM_THREADS": "1",
                        "OMP_NUM_THREADS": "1",
                        "MKL_NUM_THREADS": "1",
                    },
                )
        finally:
            os.close(processes)
        start = {
            "without": sorted(self.without),
            # Make the file that is open to everybody only when a process is there that will remove
            # it.
            "target": target | {"files": [file_outside(self.base)]},
            "limits": self.limits.as_json(),
            "base": self.base,
            "why no namespaces": why_not,
            "user": new_user(),
            "threads in use": 0 if os.geteuid() == 0 else threads_of(os.geteuid()),
        }
        self.send({"start": start})
        try:
            message = self.receive(WAIT_FOR_START)
        except WorkerDied:
            self.process.wait(WAIT_FOR_END)
            raise WorkerDied(self.last_error()) from None
        return message["ready"]

    def last_error(self) -> str:
        """Return the last line that the warm parent, never a student, wrote on its error stream."""
        if errors := self.errors:
            errors.seek(0)
            if lines := errors.read().decode(errors="replace").strip().splitlines():
                return lines[-1][:500]
        return "the parent process of the sandbox exited without an error message"

    @property
    def connection(self) -> socket.socket:
        """The connection to the warm parent."""
        if self.control is None:
            raise WorkerDied("the parent process of the sandbox has exited")
        return self.control

    def send(self, message: Mapping[str, object], handles: Sequence[int] = ()) -> None:
        try:
            socket.send_fds(self.connection, [json.dumps(message).encode()], handles)
        except OSError as error:
            raise WorkerDied(str(error)) from None

    def receive(self, seconds: float) -> Message:
        waiting = select.poll()
        waiting.register(self.connection, select.POLLIN)
        if not waiting.poll(seconds * 1000):
            raise WorkerDied(
                f"the parent process of the sandbox did not answer for {seconds} seconds"
            )
        try:
            data = self.connection.recv(1 << 20)
        except OSError as error:
            raise WorkerDied(str(error)) from None
        if not data:
            raise WorkerDied("the parent process of the sandbox has exited")
        message: Message = json.loads(data)
        return message

    def close(self) -> None:
        """End the warm parent, and with it everything that it started."""
        if self.control is not None:
            self.control.close()
        if self.process is not None:
            try:
                self.process.wait(5)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
        if self.errors is not None:
            self.errors.close()
        if self.base is not None:
            # The process that waits for the end removes it, too.
            with contextlib.suppress(FileNotFoundError):
                scratch.remove_folder(self.base)
        self.control = self.process = self.errors = self.base = None

    # -- one notebook

    def run(self, job: Job) -> Result:
        """Run one notebook and return its result, replacing a worker that dies and trying again."""
        for _ in range(ATTEMPTS_OF_A_JOB):
            try:
                if self.control is None:
                    self.start()
                return _Run(self, job).result()
            except WorkerDied:
                self.close()
        raise WorkerDied(
            f"the worker died {ATTEMPTS_OF_A_JOB} times while it ran notebook {job['id']!r}"
        )

    def isolation_in_force(self) -> Isolation:
        """Return the isolation as every result records it."""
        layers, not_stopped = self.report["layers"], self.report["not stopped"]
        in_force = tuple(layer for layer in LAYERS if layers[layer]["in force"])
        return Isolation(in_force, bool(not_stopped), tuple(not_stopped))


class _Run:
    """All runs of one notebook, and their results."""

    def __init__(self, sandbox: Sandbox, job: Job) -> None:
        self.sandbox = sandbox
        self.limits = sandbox.limits
        self.job = job
        self.questions = job["questions"]
        self.deadline = time.monotonic() + self.limits.notebook_wall_seconds
        self.number_of_runs = 0
        self.damaged = 0
        self.unknown: dict[str, bool] = {}
        self.notes: list[str] = []
        if not isinstance(job["id"], str) or not all(
            isinstance(cell["source"], str) for cell in job["cells"]
        ):
            raise TypeError("the id of a job and the sources of its cells must be strings")

    def result(self) -> Result:
        number = len(self.job["cells"])
        cells, answers, finished = self.in_order(list(range(number)))
        if any(has_not(answers, question) for question in self.questions) and any(
            (cell.error or "").startswith("NameError") for cell in cells.values()
        ):
            self.try_order_of_execution(answers)
        if self.damaged:
            self.notes.append("wrote into the records")
        return {
            "id": self.job["id"],
            "finished": finished,
            "cells": [cells.get(index, NOT_RUN).as_json() for index in range(number)],
            "answers": {
                question: answers.get(question, MISSING).as_json() for question in self.questions
            },
            "unknown questions": written(list(self.unknown)[:MOST_UNKNOWN]),
            "notes": [*self.notes],
            "runs": self.number_of_runs,
            "seed": self.job.get("seed", 0),
            "isolation": self.sandbox.isolation_in_force().as_json(),
        }

    def try_order_of_execution(self, answers: dict[str, Answer]) -> None:
        """Fill in the answers that only the order in which the cells once ran gives."""
        cells = self.job["cells"]
        moments: list[int] = []
        last = 0
        # Keep a cell that never ran with the one above it.
        for cell in cells:
            count = cell.get("execution_count")
            last = count if type(count) is int and count > 0 else last
            moments.append(last)
        order = sorted(range(len(cells)), key=lambda index: moments[index])
        if order == list(range(len(cells))):
            return
        _, others, _ = self.in_order(order)
        gained = [q for q in self.questions if has_not(answers, q) and not has_not(others, q)]
        for question in gained:
            answers[question] = others[question]
        if gained:
            self.notes.append("works only out of order")

    def in_order(self, order: list[int]) -> tuple[dict[int, Cell], dict[str, Answer], bool]:
        """Run in one order, leaving out cells that end the process, until it reaches the end."""
        cells: dict[int, Cell] = {}
        answers: dict[str, Answer] = {}
        skip: list[Step] = []
        finished = False
        for number in range(self.limits.runs):
            once = _Once(self, order, skip)
            self.number_of_runs += 1
            once.watch()
            self.damaged += once.records.damaged
            cells |= {
                index: cell for index, cell in once.cells.items() if ["cell", index] not in skip
            }
            self.unknown |= once.unknown
            for question, answer in once.answers.items():
                if answer.plain is not None or answers.get(question, MISSING).outcome != "recorded":
                    answers[question] = answer
            if once.finished:
                finished = True
                break
            culprit = next(
                (step for step in reversed(once.blamed or once.steps) if step not in skip), None
            )
            if number and once.left_threads:
                # It happened twice, in different cells, so blame the threads that an earlier cell
                # left.
                skip, culprit = [], ["cell", once.left_threads[0]]
            if culprit is None:
                break
            _, which = culprit
            if isinstance(which, int):
                cells[which] = Cell(*once.ending)
            elif which in self.questions and answers.get(which, MISSING).outcome != "recorded":
                outcome, error = once.ending
                answers[which] = Answer(outcome, error=error)
            self.deadline += once.kept_waiting
            if time.monotonic() >= self.deadline:
                break
            skip = [*skip, culprit]
        return cells, answers, finished


def has_not(answers: Mapping[str, Answer], question: str) -> bool:
    """Check whether a question has no answer yet; a blank is not an answer."""
    answer = answers.get(question, MISSING)
    return answer.outcome != "recorded" or answer.is_blank


class _Once:
    """One child, from its start to its end."""

    def __init__(self, run: _Run, order: list[int], skip: list[Step]) -> None:
        self.sandbox = run.sandbox
        self.limits = run.limits
        self.notebook_deadline = run.deadline
        job = run.job
        self.job = json.dumps(
            {
                "cells": [cell["source"] for cell in job["cells"]],
                "numbers": [cell.get("execution_count") for cell in job["cells"]],
                "order": order,
                "skip": skip,
                "seed": job.get("seed", 0),
                "files": job.get("files", {}),
                "variables": {
                    q: about["variable"]
                    for q, about in job["questions"].items()
                    if about.get("variable")
                },
                "calls": {
                    q: about["calls"] for q, about in job["questions"].items() if about.get("calls")
                },
                "given": {
                    q: about["given"] for q, about in job["questions"].items() if about.get("given")
                },
            }
        ).encode()
        self.secret_calls = {
            q: about["secret calls"]
            for q, about in job["questions"].items()
            if about.get("secret calls")
        }
        self.records = records.Records(len(job["cells"]))
        self.process: int | None = None
        # Seconds in which the child could have run but the machine was busy.
        self.kept_waiting = 0.0
        # Steps that have begun and not ended, outermost first.
        self.steps: list[Step] = []
        self.begun: list[float] = []
        self.deadlines: list[float] = []
        self.cells: dict[int, Cell] = {}
        self.questions = job["questions"]
        self.answers: dict[str, Answer] = {}
        self.unknown: dict[str, bool] = {}
        self.left_threads: list[int] = []
        self.finished = False
        self.done_by = math.inf
        self.killed_for: str | None = None
        # The steps that were under way when it was killed.
        self.blamed: list[Step] = []
        # The outcome, and the error.
        self.ending = "", ""

    def watch(self) -> None:
        """Start the child, read its records and enforce its time limits until all of it is gone."""
        with contextlib.ExitStack() as stack:
            # The child's input and output. We write the secret calls when it has nothing more to
            # hand in.
            ends = [os.memfd_create("job"), *os.pipe(), *os.pipe()]
            handles: list[IO[bytes]] = [
                stack.enter_context(open(end, mode, 0))
                for end, mode in zip(ends, ("rb+", "rb", "wb", "rb", "wb"), strict=True)
            ]
            job, reading, writing, secret, self.secret = handles
            # A notebook that reads it too early finds it empty.
            os.set_blocking(secret.fileno(), False)
            job.write(self.job)
            job.seek(0)
            self.sandbox.send(
                {"run": self.limits.as_json()},
                [job.fileno(), writing.fileno(), secret.fileno()],
            )
            writing.close()
            secret.close()
            ended = self.follow(reading.fileno())
        self.conclude(ended)

    def tell_the_secret(self) -> None:
        """Send the secret calls without waiting, dropping what does not fit into the pipe."""
        data = json.dumps(self.secret_calls).encode() if self.secret_calls else b""
        with contextlib.suppress(OSError):
            os.set_blocking(self.secret.fileno(), False)
            if len(data) > fcntl.fcntl(self.secret, fcntl.F_GETPIPE_SZ):
                fcntl.fcntl(self.secret, fcntl.F_SETPIPE_SZ, 1 << 20)
            self.secret.write(data)
        self.secret.close()

    def follow(self, reading: int) -> Message:
        control = self.sandbox.connection
        waiting = select.poll()
        waiting.register(control, select.POLLIN)
        last_moment = math.inf
        # ``None`` if there is nothing more to read.
        look_again: float | None = 0.0
        while True:
            now = time.monotonic()
            if self.killed_for is None:
                deadline, reason = self.next_deadline()
                if now >= deadline and self.give_back():
                    continue
                if now >= deadline or self.records.too_many:
                    self.killed_for = "output" if self.records.too_many else reason
                    self.blamed = list(self.steps)
                    self.sandbox.send({"kill": True})
                    last_moment = deadline = now + WAIT_FOR_END
            else:
                deadline = last_moment
                if now >= deadline:
                    raise WorkerDied("a notebook's process did not end when we killed it")
            if look_again is not None and now >= look_again:
                waiting.register(reading, select.POLLIN)
            until = (
                deadline if look_again is None or now >= look_again else min(deadline, look_again)
            )
            for handle, _ in waiting.poll(max(1, (until - now) * 1000)):
                if handle == reading:
                    waiting.unregister(reading)
                    look_again = time.monotonic() + PAUSE if self.take(reading) else None
                elif handle == control.fileno():
                    ended = self.sandbox.receive(0)
                    # Read its last output; nobody is left to write more.
                    while self.take(reading):
                        pass
                    return ended

    def take(self, reading: int) -> bool:
        """Read what the child has written; return False when no more will come."""
        data = os.read(reading, 1 << 18)
        if not self.records.too_many:
            for record in self.records.feed(data):
                self.note(record)
        return bool(data)

    def give_back(self) -> bool:
        """Extend all deadlines by the time in which the machine was busy; return False if none."""
        if self.process is None:
            warm_parent = self.sandbox.process
            self.process = running_below(warm_parent.pid if warm_parent else None)
        waited = kept_waiting(self.process) - self.kept_waiting
        if waited < 0.01:
            return False
        self.kept_waiting += waited
        self.notebook_deadline += waited
        self.deadlines = [deadline + waited for deadline in self.deadlines]
        if self.finished:
            self.done_by += waited
        return True

    def next_deadline(self) -> tuple[float, str]:
        if self.finished and self.steps:
            return self.deadlines[-1], "done"
        # It only has to exit now.
        if self.finished:
            return self.done_by, "done"
        if self.deadlines and self.deadlines[-1] < self.notebook_deadline:
            return self.deadlines[-1], "timeout"
        return self.notebook_deadline, "timeout"

    def note(self, record: Record) -> None:
        now = time.monotonic()
        if self.finished:
            self.done_by = now + self.limits.grace_seconds
            if "secret" in record and record["secret"] in self.secret_calls:
                answer = self.answers.get(record["secret"], MISSING)
                if answer.plain is not None:
                    said = (
                        {"plain": written(record["plain"])}
                        if "plain" in record
                        else {"unreadable": record["unreadable"]}
                    )
                    self.answers[record["secret"]] = dataclasses.replace(answer, secret=said)
            if (
                not ("begin" in record or "end" in record)
                or (record.get("begin") or record["end"])[0] != "answer"
            ):
                # It knows the secret calls now, so ignore records about anything else.
                return
        if "begin" in record:
            step = record["begin"]
            wall = (
                self.limits.cell_wall_seconds
                if step[0] == "cell"
                else self.limits.answer_wall_seconds
            )
            if len(self.steps) < DEEPEST_STEPS:
                self.steps.append(step)
                self.begun.append(now)
                self.deadlines.append(now + wall + self.limits.grace_seconds)
        elif "end" in record:
            if self.steps and self.steps[-1] == record["end"]:
                self.steps.pop()
                self.deadlines.pop()
                begun = self.begun.pop()
                # Reading an answer does not count as the cell's time.
                if self.deadlines:
                    self.deadlines[-1] += now - begun
            _, which = record["end"]
            if isinstance(which, int):
                self.cells[which] = Cell(record["outcome"], record.get("error"), record.get("line"))
                if "threads" in record:
                    self.left_threads.append(which)
        elif "answer" in record:
            question = record["answer"]
            if question not in self.questions:
                if len(self.unknown) < MOST_UNKNOWN:
                    self.unknown[question] = True
                return
            answer = Answer(
                "recorded" if "plain" in record else "unreadable",
                record.get("plain"),
                record.get("unreadable"),
                source=record["from"],
                cell=record["cell"],
            )
            if not has_not({question: answer}, question) or has_not(self.answers, question):
                self.answers[question] = answer
        elif "done" in record and not self.finished:
            self.finished = True
            self.done_by = now + self.limits.grace_seconds
            self.steps, self.begun, self.deadlines = [], [], []
            self.tell_the_secret()

    def conclude(self, ended: Message) -> None:
        """Determine how the child ended."""
        how = ended["ended"]
        if how.get("code") == NOT_CONFINED and not self.records.received:
            raise WeakIsolation(
                "We could not isolate a notebook's process, so we did not run it: "
                + self.sandbox.last_error()
            )
        if self.finished:
            return
        outcome, error = "exited", f"The process ended with exit code {how.get('code')}."
        if ended["scratch full"]:
            outcome, error = "disk", "It filled its scratch folder."
        elif self.killed_for == "output":
            outcome, error = "output", "It wrote more than a submission may contain."
        elif self.killed_for == "timeout" or how.get("signal") == signal.SIGXCPU:
            outcome, error = "timeout", "It exceeded the time limit."
        elif "signal" in how:
            name = signal.Signals(how["signal"]).name
            outcome, error = "killed", f"The process was killed by {name}."
        self.ending = outcome, error


def file_outside(base: str) -> str:
    """Make a file that everybody may change, for testing the isolation."""
    outside = Path(base, OUTSIDE)
    outside.mkdir()
    file = outside / "file"
    file.write_text("a file outside")
    file.chmod(0o666)
    outside.chmod(0o777)
    return str(file)


def given_up(job: Job, why: str) -> Result:
    """Return the result of a notebook that could not be run, which a person must look at."""
    return {
        "id": job["id"],
        "finished": False,
        "cells": [NOT_RUN.as_json() for _ in job["cells"]],
        "answers": {name: MISSING.as_json() for name in job["questions"]},
        "unknown questions": [],
        "notes": ["could not be run"],
        "runs": 0,
        "seed": job.get("seed", 0),
        "isolation": Isolation(given_up=why).as_json(),
    }


def new_user() -> int:
    """Return a user ID that nobody else has, so that a limit counts only its own threads."""
    return 1_900_000_000 + random.SystemRandom().randrange(10**8)


def running_below(process: int | None) -> int | None:
    """Return the ID of a process's last descendant, the notebook's; ``None`` if hidden."""
    with contextlib.suppress(OSError, ValueError, IndexError):
        while children := Path(f"/proc/{process}/task/{process}/children").read_text().split():
            process = int(children[-1])
        return process
    return None


def kept_waiting(process: int | None) -> float:
    """Return the seconds in which a process could have run but others did; 0 if unknown."""
    try:
        return int(Path(f"/proc/{process}/schedstat").read_text().split()[1]) / 1e9
    except (OSError, ValueError, IndexError):
        return 0.0


def threads_of(user: int) -> int:
    """Return the number of threads of `user` on this machine, which count towards a limit."""
    total = 0
    for status in Path("/proc").glob("[0-9]*/status"):
        with contextlib.suppress(OSError, ValueError, KeyError):
            fields = dict(line.split(":", 1) for line in status.read_text().splitlines())
            if int(fields["Uid"].split()[0]) == user:
                total += int(fields["Threads"])
    return total


def run_notebooks(
    jobs: Iterable[Job],
    workers: int = 2,
    limits: Limits | None = None,
    *,
    allow_weak_isolation: bool = False,
    without: Collection[str] = (),
) -> Iterator[Result]:
    """Run notebooks on several workers, each a process of its own, and yield the results.

    Parameters
    ----------
    jobs : iterable of dict
        Each plain JSON::

            {"id": text,
             "cells": [{"source": text, "execution_count": number or None}, ...],  # code cells
             "questions": {name: {"variable": text or None,
                                  "calls": {"arguments": [[...], ...], "as": "lists" or "arrays"} or
                                  None, "secret calls": the same, optional}},
             "files": {name: base64 text},  # optional, beside it
             "seed": number}                # optional, 0
    workers : int
        The number of notebooks to run at a time; each worker is a warm parent of its own.
    limits, allow_weak_isolation, without
        As for `Sandbox`.

    Yields
    ------
    dict
        One result for each job, as it is ready. It names its job by `id` and depends neither on the
        others nor on the number of workers.

    Raises
    ------
    WeakIsolation
        Before any student code is run.
    """

    def prepare(stack: contextlib.ExitStack) -> Callable[[Job], Result]:
        return stack.enter_context(
            Sandbox(limits, allow_weak_isolation=allow_weak_isolation, without=without)
        ).run

    yield from side_by_side(jobs, workers, prepare, (WeakIsolation, WorkerDied))
