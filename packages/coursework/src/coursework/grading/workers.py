"""Processes that work side by side: each takes a task, says what came of it, and takes the next.

They are copies of the process that asks, so they know what it knows and only a task and what came
of it are sent, as JSON. However the process that asks ends, they end with it.
"""

import contextlib
import ctypes
import json
import multiprocessing
import os
import signal
import sys
import traceback
import warnings
from collections.abc import Callable, Collection, Iterable, Iterator
from multiprocessing.connection import Connection, wait
from types import FrameType
from typing import Generic, NoReturn, TypeVar

Task = TypeVar("Task")
Done = TypeVar("Done")

PR_SET_PDEATHSIG = 1
WAIT_FOR_END = 30  # seconds for a process to end what it started
ATTEMPTS_OF_A_TASK = 3  # how often a task is given out when a process ends under it


def processors() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class TaskLost(RuntimeError):
    """Several worker processes in a row died on the same task."""


def side_by_side(
    tasks: Iterable[Task],
    number: int,
    prepare: Callable[[contextlib.ExitStack], Callable[[Task], Done]],
    errors: Collection[type[Exception]] = (),
    lost: Callable[[Task], Done] | None = None,
) -> Iterator[Done]:
    """Do tasks in several processes; give what comes of them as it comes.

    Parameters
    ----------
    tasks : iterable
        Of what JSON can hold.
    number : int
        Of processes.
    prepare : function
        Called once in each process, with an `contextlib.ExitStack`: gives the function that
        does a task.
    errors : collection of type
        Exceptions of one text that may come of a task, and are raised here.
    lost : function, optional
        Called here with a task under which process after process ended: gives what comes of it.

    Yields
    ------
    What came of each task, from what JSON can hold.

    Raises
    ------
    TaskLost
    OSError
        The system refused something in one of the processes.
    RuntimeError
        There was another error in one of the processes; the message shows it.
    """
    tasks, kinds = iter(tasks), {kind.__name__: kind for kind in (*errors, OSError)}
    workers: list[_Worker[Task, Done]] = []
    try:
        for _ in range(number):
            workers.append(_Worker(prepare))
        busy = [worker for worker in workers if worker.take_next(tasks)]
        while busy:
            for ready in wait([worker.connection for worker in busy]):
                (worker,) = (one for one in busy if one.connection is ready)
                try:
                    said = json.loads(worker.connection.recv_bytes())
                except (EOFError, OSError):
                    worker.end()
                    again = _Worker(prepare)
                    workers[workers.index(worker)] = busy[busy.index(worker)] = again
                    if worker.attempts < ATTEMPTS_OF_A_TASK:
                        again.take(worker.task, worker.attempts + 1)
                        continue
                    if lost is None:
                        raise TaskLost(
                            "Several worker processes in a row died on the same task: "
                            f"{worker.task!r:.200}"
                        ) from None
                    worker, said = again, {"done": lost(worker.task)}
                if "error" in said:
                    kind, text, trace = said["error"]
                    raise kinds[kind](text) if kind in kinds else RuntimeError(trace)
                if not worker.take_next(tasks):
                    busy.remove(worker)
                yield said["done"]
        for worker in workers:
            worker.let_go()
    finally:
        for worker in workers:
            worker.end()


class _Worker(Generic[Task, Done]):
    """One of the processes, as the one that asks sees it."""

    def __init__(self, prepare: Callable[[contextlib.ExitStack], Callable[[Task], Done]]) -> None:
        self.connection, other = multiprocessing.Pipe()
        self.task: Task
        self.attempts = 0
        asking = os.getpid()
        with warnings.catch_warnings():
            # The copy uses nothing that another thread of this process may hold: it
            # works on its own things only.
            warnings.simplefilter("ignore", DeprecationWarning)
            self.process = multiprocessing.get_context("fork").Process(
                target=_work, args=(other, prepare, asking), daemon=True
            )
            self.process.start()
        other.close()

    def take(self, task: Task, attempts: int = 1) -> None:
        self.task, self.attempts = task, attempts
        with contextlib.suppress(OSError):  # that it has ended is noticed when it does not answer
            self.connection.send_bytes(json.dumps({"task": task}).encode())

    def take_next(self, tasks: Iterable[Task]) -> bool:
        """Take the next task; whether there is one."""
        for task in tasks:
            self.take(task)
            return True
        return False

    def let_go(self) -> None:
        """Have it end by itself, and wait until what it started has ended too."""
        with contextlib.suppress(OSError):
            self.connection.send_bytes(b"{}")
        self.process.join()

    def end(self) -> None:
        """End it now, and what it started."""
        self.process.terminate()
        self.process.join(WAIT_FOR_END)
        self.process.kill()
        self.process.join()
        self.connection.close()


def _work(
    connection: Connection,
    prepare: Callable[[contextlib.ExitStack], Callable[[Task], Done]],
    asking: int,
) -> None:
    if sys.platform.startswith("linux"):
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != asking:
        return  # it ended before it could be said that this one ends with it
    # Ctrl+C is for the one that asks; what is started here is to hear it again.
    signal.signal(signal.SIGINT, lambda number, frame: None)
    signal.signal(signal.SIGTERM, _leave)

    def say(**said: object) -> None:
        connection.send_bytes(json.dumps(said).encode())

    with contextlib.suppress(EOFError, OSError), contextlib.ExitStack() as stack:
        try:
            do = prepare(stack)
            while "task" in (message := json.loads(connection.recv_bytes())):
                say(done=do(message["task"]))
        except (EOFError, BrokenPipeError):
            raise
        except OSError as error:  # a full disk, say
            where = f": {error.filename}" if error.filename else ""
            say(error=["OSError", f"{error.strerror or error}{where}", traceback.format_exc()])
            connection.recv_bytes()
        except Exception as error:
            say(error=[type(error).__name__, str(error), traceback.format_exc()])
            connection.recv_bytes()  # it is ended from there


def _leave(number: int, frame: FrameType | None) -> NoReturn:
    raise SystemExit
