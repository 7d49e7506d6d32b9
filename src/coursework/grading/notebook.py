"""Runs the cells of one notebook in a process that is already confined, and records the answers.

Everything here shares its process with the student's code, which may change any of it. That is
allowed for: all that leaves is a line of JSON for each event, read strictly outside; the worst that a
student can do is hand in another answer of his own.

A line is one of

    {"begin": step}                       step: ["cell", i] or ["answer", question]
    {"end": step, "outcome": o, ...}      for a cell: "done", "error", "timeout", "memory", with "error"
                                          and "line", and "threads": true if it left any running
    {"answer": question, "from": "check" or "variable", "cell": i or null, "plain": data}
    {"answer": question, "from": ..., "cell": ..., "unreadable": text}
    {"done": true}

and is written the moment it is known, so that what comes later cannot lose it.
"""

import json
import os
import random
import re
import signal
import sys
import threading
import types
import warnings

from coursework.checking.plain import NotPlain, to_plain
from coursework.checking.variants import Given

LONGEST_ERROR = 500
# Magics whose body is the student's code; the others are about the notebook and do nothing here.
MAGICS_WITH_CODE = ("time", "capture", "prun")


class OutOfTime(BaseException):
    """Raised in the student's code when its time is up; not an Exception, so that few catch it."""


class Shell:
    """What `get_ipython()` gives: enough of a shell that magics and `!commands` break nothing."""

    def __init__(self, execute):
        self._execute = execute

    def run_line_magic(self, name, line, *rest):
        if name in MAGICS_WITH_CODE:
            self._execute(line)

    def run_cell_magic(self, name, line, cell):
        if name in MAGICS_WITH_CODE:
            self._execute(cell)

    def system(self, command):
        return None

    def getoutput(self, command, *rest, **options):
        return []

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return lambda *arguments, **options: None


class Reply:
    """What `check` gives here. Marks are not decided in this process."""

    def __repr__(self):
        return "The answer is recorded."

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return None  # neither right nor wrong


def nothing(*arguments, **options):
    """Stands for what only shows something."""


def warm_up():
    """Load what is imported on first use, before the children are forked."""
    import IPython.display  # noqa: F401

    transformer().transform_cell("%time x = 1\n")
    import sympy

    to_plain(sympy.Matrix([[sympy.cos(sympy.Symbol("a")), 0.5]]))


def transformer():
    from IPython.core.inputtransformer2 import TransformerManager

    return TransformerManager()


def run(job, records, limits, folder):
    """Run the job that is read from the handle `job`; write records to the handle `records`."""
    with open(job, "rb") as file:
        job = json.load(file)
    random.seed(job["seed"])
    sys.modules["numpy"].random.seed(job["seed"])
    _Notebook(job, records, limits, folder).run()


class _Notebook:
    def __init__(self, job, records, limits, folder):
        self.job = job
        self.records = records
        self.limits = limits
        self.folder = folder
        self.encode = json.JSONEncoder(check_circular=False, allow_nan=False).encode
        self.write = os.write
        self.writing = False
        self.cell = None
        self.answered = set()
        self.skipped = {tuple(step) for step in job["skip"]}
        self.recursion_limit = sys.getrecursionlimit()
        self.module = types.ModuleType("__main__")
        self.names = self.module.__dict__
        self.transformer = transformer()

    def run(self):
        self.prepare()
        for index in self.job["order"]:
            if ("cell", index) not in self.skipped:
                self.cell = index
                self.step(["cell", index], lambda: self.execute(self.job["cells"][index]), self.limits["cell"])
        self.cell = None
        for question, variable in self.job["variables"].items():
            if question not in self.answered and variable in self.names:
                self.record(question, self.names[variable], "variable")
        self.emit({"done": True})

    def prepare(self):
        sys.modules["__main__"] = self.module
        shell = Shell(self.execute)
        self.names.update(get_ipython=lambda: shell, display=nothing, In=[], Out={})
        for name in [name for name in sys.modules if name.partition(".")[0] == "coursework"]:
            del sys.modules[name]
        package = types.ModuleType("coursework")
        package.check = self.check
        package.hint = package.progress = package.me = package.worked_solution = nothing
        package.variant = lambda question: Given("", self.job.get("given", {}).get(question, {}))
        sys.modules["coursework"] = package
        sys.argv = ["notebook"]
        sys.path.insert(0, self.folder)
        warnings.resetwarnings()
        warnings.simplefilter("ignore")

    def execute(self, source):
        """Run source as a notebook's cell is run."""
        code = compile(self.transformer.transform_cell(source), f"<cell {self.cell}>", "exec", dont_inherit=True)
        exec(code, self.names)

    def check(self, question, answer=None, *rest, **options):
        """Stands for `coursework.checking.check` here: records the answer and tells nothing."""
        self.record(str(question)[:200], answer, "check")
        return Reply()

    def record(self, question, answer, source):
        if ("answer", question) in self.skipped:
            return
        found = {"answer": question, "from": source, "cell": self.cell}

        def read():
            try:
                found["plain"] = to_plain(answer, self.calls(question))
            except NotPlain as error:
                found["unreadable"] = str(error)[:LONGEST_ERROR]
            self.emit(found)

        end = self.step(["answer", question], read, self.limits["answer"])
        if end["outcome"] != "done":
            found.pop("plain", None)
            self.emit(found | {"unreadable": end["error"]})
        elif "plain" in found and found["plain"]["value"] != ["blank"]:
            self.answered.add(question)

    def calls(self, question):
        calls = self.job["calls"].get(question)
        if calls is None:
            return None
        arguments = json.loads(json.dumps(calls["arguments"]))  # the function may change what it is given
        if calls["as"] == "arrays":
            import numpy

            arguments = [[numpy.array(a) if isinstance(a, list) else a for a in call] for call in arguments]
        return arguments

    # -- one step: a cell, or the reading of an answer

    def step(self, step, action, seconds):
        """Do one thing within its time. Steps may be nested: a check within a cell."""
        self.emit({"begin": step})
        outer = signal.setitimer(signal.ITIMER_PROF, 0), signal.setitimer(signal.ITIMER_REAL, 0)
        end = {"end": step, "outcome": "done"}
        try:
            try:
                self.start_timers(seconds["processor"], seconds["wall"])
                action()
            finally:
                sys.setrecursionlimit(self.recursion_limit)
                self.stop_timers()
        except OutOfTime:
            end |= {"outcome": "timeout", "error": "It took longer than it may."}
        except MemoryError:
            end |= {"outcome": "memory", "error": "It took more memory than it may."}
        except BaseException as error:
            end |= {"outcome": "error", **self.described(error)}
        if step[0] == "cell" and threading.active_count() > 1:
            end["threads"] = True
        self.emit(end)
        if outer[0][0] or outer[1][0]:
            self.start_timers(outer[0][0], outer[1][0])
        return end

    def start_timers(self, processor, wall):
        # Afresh each time: an earlier cell may have ignored or blocked them.
        for number in (signal.SIGPROF, signal.SIGALRM):
            signal.signal(number, self.time_is_up)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, (signal.SIGPROF, signal.SIGALRM))
        signal.setitimer(signal.ITIMER_PROF, processor)
        signal.setitimer(signal.ITIMER_REAL, wall)

    @staticmethod
    def stop_timers():
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.setitimer(signal.ITIMER_REAL, 0)

    def time_is_up(self, number, frame):
        if self.writing:  # half a record would be worse than being late
            signal.setitimer(signal.ITIMER_REAL, 0.02)
            return
        raise OutOfTime

    def emit(self, record):
        # Each record has a line of its own even after other bytes that a student may have written.
        data = b"\n" + self.encode(record).encode() + b"\n"
        self.writing = True
        try:
            while data:
                data = data[self.write(self.records, data) :]
        finally:
            self.writing = False

    def described(self, error):
        """An error as text: its type, its message, and the line of the cell. May run student code."""
        try:
            self.start_timers(0.2, 0.4)
            try:
                text = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
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
            return {"error": "An error whose message cannot be read."}
        # The same text on every run: no addresses, no name of this folder.
        text = re.sub(r"0x[0-9a-fA-F]{6,}", "0x...", text[: 4 * LONGEST_ERROR])
        text = text.replace(self.folder, "scratch")[:LONGEST_ERROR]
        return {"error": text} | ({"line": line} if line is not None else {})
