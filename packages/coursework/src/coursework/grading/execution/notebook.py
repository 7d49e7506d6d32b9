"""Execution of one notebook's cells in a confined process, with records of its answers.

Everything here shares its process with the student's code, which may change any of it. That is why
only lines of JSON, one for each event, leave the process, and they are read strictly outside. The
worst that students can do is hand in another answer of their own.

A line is one of

    {"begin": step}                       step: ["cell", i] or ["answer", question]
    {"end": step, "outcome": o, ...}      for a cell: "done", "error", "timeout", "memory", with
                                          "error" and "line", and "threads": true if it left any
                                          running
    {"answer": question, "from": "check" or "variable", "cell": i or null, "plain": data}
    {"answer": question, "from": ..., "cell": ..., "unreadable": text}
    {"done": true}
    {"secret": question, "plain": data} or {"secret": question, "unreadable": text}

and is written as soon as it is known, so that nothing later can lose it. Only after "done" do the
arguments of the secret calls arrive. Code that knows them then can no longer hand in an answer that
depends on them.
"""

from __future__ import annotations

import ast
import base64
import contextlib
import gc
import inspect
import json
import os
import random
import re
import resource
import select
import signal
import sys
import threading
import time
import types
import warnings
from collections.abc import Callable
from typing import TYPE_CHECKING, NotRequired, TypedDict

from coursework.checking.plain import NotPlain, arguments_of, to_plain
from coursework.checking.variants import Given
from coursework.grading.execution.event_loop import PipeEventLoop
from coursework.grading.execution.isolation import Limits

if TYPE_CHECKING:
    from IPython.core.inputtransformer2 import TransformerManager

    from coursework.checking.fields import Json
    from coursework.grading.execution.records import Record, Step

LONGEST_ERROR = 500
# Seconds; a notebook that swallowed its records gets no secret calls.
WAIT_FOR_SECRET = 30
# Magics whose body is the student's code; the others concern the notebook and do nothing here.
MAGICS_WITH_CODE = ("time", "capture", "prun")


# The modules of this package, which the notebook must not find.
OURS: list[str] = []
AWAIT = ast.PyCF_ALLOW_TOP_LEVEL_AWAIT
# A line pasted with its prompt may pass for an annotation.
PROMPT = "In ["
# Seconds of wall time between two checks whether a step waits.
TICK = 0.5
#: A step that uses less than this fraction of a tick is waiting.
WAITING = 0.02
#: The arguments of each call to a function, and whether lists in them become arrays.
Calls = TypedDict("Calls", {"arguments": list[list[object]], "as": str})


class Job(TypedDict):
    """A notebook, as this process receives it."""

    cells: list[str]
    numbers: list[int | None]
    order: list[int]
    skip: list[Step]
    variables: dict[str, str]
    calls: dict[str, Calls]
    given: NotRequired[dict[str, dict[str, Json]]]
    files: dict[str, str]
    seed: int


class OutOfTime(BaseException):
    """Raised in code that is out of time; not an Exception, so that few handlers catch it."""


class Shell:
    """The result of `get_ipython()`, a shell in which magics and `!commands` break nothing."""

    def __init__(self, execute: Callable[[str], None]) -> None:
        self._execute = execute

    def run_line_magic(self, name: str, line: str, *rest: object) -> None:
        if name in MAGICS_WITH_CODE:
            self._execute(line)

    def run_cell_magic(self, name: str, line: str, cell: str) -> None:
        if name in MAGICS_WITH_CODE:
            self._execute(cell)
        elif name in ("writefile", "file") and line.strip():
            *options, path = line.split()
            with open(
                path.strip("'\""),
                "a" if options in (["-a"], ["--append"]) else "w",
                encoding="utf8",
            ) as file:
                file.write(cell)

    def getoutput(self, command: str, *rest: object, **options: object) -> list[str]:
        return []

    def __getattr__(self, name: str) -> object:
        if name.startswith("__"):
            raise AttributeError(name)
        return nothing


class Reply:
    """The result of `check` in this process, which decides no marks."""

    def __repr__(self) -> str:
        return "The answer is recorded."

    def __getattr__(self, name: str) -> None:
        if name.startswith("__"):
            raise AttributeError(name)
        # It is neither right nor wrong.
        return None


def nothing(*arguments: object, **options: object) -> None:
    """Do nothing, in place of functions that only show something."""


def warm_up() -> None:
    """Load what is imported on first use, before the children are forked."""
    import IPython.display  # noqa: F401

    transformer().transform_cell("%time x = 1\n")
    import sympy

    to_plain(sympy.Matrix([[sympy.cos(sympy.Symbol("a")), 0.5]]))
    # Collect the modules before forking. A child that read all names itself would copy every memory
    # page that contains one.
    OURS[:] = [name for name in sys.modules if name.partition(".")[0] == "coursework"]


def transformer() -> TransformerManager:
    from IPython.core.inputtransformer2 import TransformerManager

    return TransformerManager()


def run(job: int, records: int, secret: int, limits: Limits, folder: str) -> None:
    """Run the job read from the handle `job`; write records to the handle `records`.

    The secret calls are read from the handle `secret` at the end.
    """
    with open(job, "rb") as file:
        given: Job = json.load(file)
    random.seed(given["seed"])
    # The process is short-lived, so reference cycles are seldom worth collecting.
    gc.set_threshold(20_000, 20, 50)
    sys.modules["numpy"].random.seed(given["seed"])
    _Notebook(given, records, secret, limits, folder).run()


class _Notebook:
    def __init__(self, job: Job, records: int, secret: int, limits: Limits, folder: str) -> None:
        self.job = job
        self.records = records
        self.secret = secret
        self.functions: dict[str, tuple[object, dict[str, object]]] = {}
        self.number: int | None = None
        self.loop: PipeEventLoop | None = None
        self.limits = limits
        self.folder = folder
        self.encode = json.JSONEncoder(check_circular=False, allow_nan=False).encode
        self.write = os.write
        self.writing = False
        self.cell: int | None = None
        self.answered: set[str] = set()
        self.wall_left = 0.0
        self.looked: tuple[float, float, int] = (0, 0, 0)
        self.skipped = {tuple(step) for step in job["skip"]}
        self.recursion_limit = sys.getrecursionlimit()
        self.module = types.ModuleType("__main__")
        self.names = self.module.__dict__
        self.transformer = transformer()

    def run(self) -> None:
        self.prepare()
        for index in self.job["order"]:
            if ("cell", index) not in self.skipped:
                self.cell = index
                # Number cells as Jupyter did in their last run; a cell that never ran follows the
                # one before.
                self.number = self.job["numbers"][index] or (self.number or 0) + 1
                if isinstance(self.names.get("In"), dict):
                    self.names["In"][self.number] = self.job["cells"][index]
                self.step(
                    ["cell", index],
                    lambda: self.execute(self.job["cells"][index]),
                    self.limits.cell_seconds,
                    self.limits.cell_wall_seconds,
                )
        self.cell = None
        for question, variable in self.job["variables"].items():
            if question not in self.answered and variable in self.names:
                self.record(question, self.names[variable], "variable")
        self.emit({"done": True})
        self.call_secretly()

    def call_secretly(self) -> None:
        """Call the functions that are answers with arguments that nobody could prepare them for."""
        if not self.functions or not select.select([self.secret], [], [], WAIT_FOR_SECRET)[0]:
            return
        os.set_blocking(self.secret, True)
        with open(self.secret, "rb") as file:
            calls = json.loads(file.read() or b"{}")
        for question, about in calls.items():
            if question not in self.functions or ("answer", question) in self.skipped:
                continue
            function, names = self.functions[question]
            # Restore the names as they were when it was checked, since a later cell may have reused
            # them.
            self.names.clear()
            self.names.update(names)
            record: Record = {"secret": question}

            def read(
                function: object = function, about: Calls = about, record: Record = record
            ) -> None:
                try:
                    record["plain"] = to_plain(
                        function, arguments_of(about["arguments"], about["as"])
                    )
                except NotPlain as error:
                    record["unreadable"] = str(error)[:LONGEST_ERROR]

            end = self.step(
                ["answer", question],
                read,
                self.limits.answer_seconds,
                self.limits.answer_wall_seconds,
            )
            if end["outcome"] != "done":
                record = {"secret": question, "unreadable": end["error"]}
            self.emit(record)

    def prepare(self) -> None:
        sys.modules["__main__"] = self.module
        shell = Shell(self.execute)
        self.names.update(get_ipython=lambda: shell, display=nothing, In={}, Out={})
        for name in OURS:
            sys.modules.pop(name, None)
        package = types.ModuleType("coursework")
        vars(package).update(
            dict.fromkeys(("hint", "progress", "student", "worked_solution"), nothing),
            check=self.check,
            variant=lambda question: Given("", self.job.get("given", {}).get(question, {})),
        )
        sys.modules["coursework"] = package
        for name, data in self.job["files"].items():
            path = os.path.normpath(os.path.join(self.folder, name))
            if path.startswith(f"{self.folder}/"):
                os.makedirs(os.path.dirname(path), exist_ok=True)
                with open(path, "wb") as file:
                    file.write(base64.b64decode(data))
        sys.argv = ["notebook"]
        sys.path.insert(0, self.folder)
        warnings.resetwarnings()
        warnings.simplefilter("ignore")

    def execute(self, source: str) -> None:
        """Run a cell's source, whose last line's value becomes ``_`` and ``Out[number]``."""
        name = f"<cell {self.cell}>"
        tree = self.parsed(source, name)
        last = tree.body[-1] if tree.body else None
        if isinstance(last, ast.Expr):
            tree.body.pop()
        self.evaluate(compile(tree, name, "exec", AWAIT, dont_inherit=True))
        # A last line that ends in a semicolon is not shown here either, and is a value
        # nevertheless.
        if isinstance(last, ast.Expr):
            value = self.evaluate(
                compile(ast.Expression(last.value), name, "eval", AWAIT, dont_inherit=True)
            )
            if value is not None:
                self.keep(value)

    def parsed(self, source: str, name: str) -> ast.Module:
        """Parse a cell. Source that is valid Python has no magics, so do not search it."""
        if PROMPT not in source:
            with contextlib.suppress(SyntaxError, ValueError):
                return ast.parse(source, name)
        return ast.parse(self.transformer.transform_cell(source), name)

    def evaluate(self, code: types.CodeType) -> object:
        """Run code, including whatever it awaits."""
        value = eval(code, self.names)
        if code.co_flags & inspect.CO_COROUTINE:
            if self.loop is None:
                self.loop = PipeEventLoop()
            return self.loop.run_until_complete(value)
        return value

    def keep(self, value: object) -> None:
        names = self.names
        names["___"], names["__"], names["_"] = names.get("__", ""), names.get("_", ""), value
        if isinstance(names.get("Out"), dict) and self.number is not None:
            names["Out"][self.number] = names[f"_{self.number}"] = value

    def check(
        self, question: object, answer: object = None, *rest: object, **options: object
    ) -> Reply:
        """Record the answer and reveal nothing, in place of `coursework.checking.check`."""
        self.record(str(question)[:200], answer, "check")
        return Reply()

    def record(self, question: str, answer: object, source: str) -> None:
        if ("answer", question) in self.skipped:
            return
        record: Record = {"answer": question, "from": source, "cell": self.cell}

        def read() -> None:
            try:
                record["plain"] = to_plain(answer, self.calls(question))
            except NotPlain as error:
                record["unreadable"] = str(error)[:LONGEST_ERROR]
            self.emit(record)

        end = self.step(
            ["answer", question], read, self.limits.answer_seconds, self.limits.answer_wall_seconds
        )
        if end["outcome"] != "done":
            record.pop("plain", None)
            record["unreadable"] = end["error"]
            self.emit(record)
        elif "plain" in record and record["plain"]["value"] != ["blank"]:
            self.answered.add(question)
            if record["plain"]["value"][0] == "function":
                self.functions[question] = answer, dict(self.names)

    def calls(self, question: str) -> list[list[object]] | None:
        calls = self.job["calls"].get(question)
        return None if calls is None else arguments_of(calls["arguments"], calls["as"])

    # -- one step: a cell, or reading an answer

    def step(
        self, step: Step, action: Callable[[], object], processor: float, wall: float
    ) -> Record:
        """Do one thing within its time. Steps may be nested, such as a check within a cell."""
        self.emit({"begin": step})
        outer = self.time_left()
        end: Record = {"end": step, "outcome": "done"}
        try:
            try:
                self.start_timers(processor, wall)
                action()
            finally:
                sys.setrecursionlimit(self.recursion_limit)
                self.stop_timers()
        except OutOfTime:
            end |= {"outcome": "timeout", "error": "It exceeded the time limit."}
        except MemoryError:
            end |= {"outcome": "memory", "error": "It exceeded the memory limit."}
        except BaseException as error:
            end["outcome"] = "error"
            end |= self.described(error)
        if step[0] == "cell" and threading.active_count() > 1:
            end["threads"] = True
        self.emit(end)
        if outer[0]:
            self.start_timers(*outer)
        return end

    def start_timers(self, processor: float, wall: float) -> None:
        # Set the handlers each time, since an earlier cell may have ignored or blocked the signals.
        for number in (signal.SIGPROF, signal.SIGALRM):
            signal.signal(number, self.time_is_up)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, (signal.SIGPROF, signal.SIGALRM))
        self.wall_left, self.looked = wall, self.moment()
        signal.setitimer(signal.ITIMER_PROF, processor)
        signal.setitimer(signal.ITIMER_REAL, min(wall, TICK), TICK)

    @staticmethod
    def moment() -> tuple[float, float, int]:
        """Return the wall time, the processor time, and how often this process gave it away."""
        return (
            time.monotonic(),
            time.process_time(),
            resource.getrusage(resource.RUSAGE_SELF).ru_nvcsw,
        )

    def time_left(self) -> tuple[float, float]:
        """Stop both timers, and return what is left of the processor time and the wall time."""
        signal.setitimer(signal.ITIMER_REAL, 0)
        return signal.setitimer(signal.ITIMER_PROF, 0)[0], self.wall_left

    @staticmethod
    def stop_timers() -> None:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.setitimer(signal.ITIMER_REAL, 0)

    def time_is_up(self, number: int, frame: types.FrameType | None) -> None:
        # Half a record would be worse than being late.
        if self.writing:
            signal.setitimer(signal.ITIMER_REAL, 0.02, TICK)
            self.wall_left = self.wall_left if number == signal.SIGALRM else 0
            return
        if number == signal.SIGALRM:
            now = self.moment()
            elapsed, used, gave_way = (
                moment - before for moment, before in zip(now, self.looked, strict=True)
            )
            self.looked = now
            # On a busy machine, charge a process that computes only for the processor time that it
            # got. Only one that gave the processor away by itself has waited. It wakes at each
            # tick, unless the machine is late.
            waited = gave_way and used < WAITING * elapsed
            self.wall_left -= min(elapsed, TICK) if waited else used
            if self.wall_left > 0:
                return
        raise OutOfTime

    def emit(self, record: Record) -> None:
        # Each record gets a line of its own even after other bytes that a student may have written.
        data = b"\n" + self.encode(record).encode() + b"\n"
        self.writing = True
        try:
            while data:
                data = data[self.write(self.records, data) :]
        finally:
            self.writing = False

    def described(self, error: BaseException) -> Record:
        """Describe an error by its type, message and the line of the cell. May run student code."""
        try:
            self.start_timers(0.2, 0.4)
            try:
                # The feedback gives the cell and the line, while Python's own message counts cells
                # from 0.
                words = error.msg if isinstance(error, SyntaxError) else str(error)
                text = f"{type(error).__name__}: {words}" if words else type(error).__name__
                line, trace = None, error.__traceback__
                while trace is not None:
                    if trace.tb_frame.f_code.co_filename == f"<cell {self.cell}>":
                        line = trace.tb_lineno
                    trace = trace.tb_next
                if isinstance(error, SyntaxError) and isinstance(error.lineno, int):
                    line = error.lineno
            finally:
                self.stop_timers()
        except BaseException:
            return {"error": "An error with an unreadable message."}
        # Keep the text the same on every run, without addresses and the name of this folder.
        text = re.sub(r"0x[0-9a-fA-F]{6,}", "0x...", text[: 4 * LONGEST_ERROR])
        text = text.replace(self.folder, "scratch")[:LONGEST_ERROR]
        described: Record = {"error": text}
        if line is not None:
            described["line"] = line
        return described
