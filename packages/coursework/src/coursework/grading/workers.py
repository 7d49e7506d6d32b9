"""Parallel worker processes, each of which takes a task, returns its result and takes the next.

They are forks of this process and share its data, so only tasks and results are sent, as JSON. They
end with this process, however it ends.
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
# Seconds for a process to end what it started.
WAIT_FOR_END = 30
# How many times a task is tried if a process dies on it.
ATTEMPTS_OF_A_TASK = 3


def processors() -> int:
    """Return the number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def ends_with(parent: int) -> bool:
    """Have the system end this process with its parent; return False if that has ended already."""
    if sys.platform.startswith("linux"):
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    return os.getppid() == parent


class TaskLost(RuntimeError):
    """An error because several worker processes in a row died on the same task."""


def side_by_side(
    tasks: Iterable[Task],
    number: int,
    prepare: Callable[[contextlib.ExitStack], Callable[[Task], Done]],
    errors: Collection[type[Exception]] = (),
    lost: Callable[[Task], Done] | None = None,
) -> Iterator[Done]:
    """Do tasks in several processes, and yield their results as they come.

    Parameters
    ----------
    tasks : iterable
        The tasks, as JSON data.
    number : int
        The number of processes.
    prepare : function
        Called once in each process with a `contextlib.ExitStack`; returns the function that does a
        task.
    errors : collection of type
        Exceptions with one string argument that a task may raise, and that are raised here.
    lost : function, optional
        Called here with a task on which process after process died; returns its result.

    Yields
    ------
    The result of each task, from JSON data.

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
                (worker,) = (worker for worker in busy if worker.connection is ready)
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
    """One of the processes, as its parent sees it."""

    def __init__(self, prepare: Callable[[contextlib.ExitStack], Callable[[Task], Done]]) -> None:
        self.connection, other = multiprocessing.Pipe()
        self.task: Task
        self.attempts = 0
        asking = os.getpid()
        with warnings.catch_warnings():
            # The copy uses only objects of its own, so no other thread of this process holds its
            # locks.
            warnings.simplefilter("ignore", DeprecationWarning)
            self.process = multiprocessing.get_context("fork").Process(
                target=_work, args=(other, prepare, asking), daemon=True
            )
            self.process.start()
        other.close()

    def take(self, task: Task, attempts: int = 1) -> None:
        self.task, self.attempts = task, attempts
        # A dead process is noticed when it does not answer.
        with contextlib.suppress(OSError):
            self.connection.send_bytes(json.dumps({"task": task}).encode())

    def take_next(self, tasks: Iterable[Task]) -> bool:
        """Take the next task, and return whether there is one."""
        for task in tasks:
            self.take(task)
            return True
        return False

    def let_go(self) -> None:
        """Let the process end by itself, and wait until what it started has ended too."""
        with contextlib.suppress(OSError):
            self.connection.send_bytes(b"{}")
        self.process.join()

    def end(self) -> None:
        """End the process now, with what it started."""
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
    if not ends_with(asking):
        return
    # Ctrl+C is for the parent. A handler, unlike SIG_IGN, is not inherited by programs started
    # here.
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
        # For example, a full disk.
        except OSError as error:
            where = f": {error.filename}" if error.filename else ""
            say(error=["OSError", f"{error.strerror or error}{where}", traceback.format_exc()])
            connection.recv_bytes()
        except Exception as error:
            say(error=[type(error).__name__, str(error), traceback.format_exc()])
            # The parent ends this process.
            connection.recv_bytes()


def _leave(number: int, frame: FrameType | None) -> NoReturn:
    raise SystemExit
