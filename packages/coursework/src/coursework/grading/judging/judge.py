"""The judge, in its own process: an answer that takes too long, or too much memory, harms no other.

Answers are plain data, and evaluating them is bounded (`coursework.checking.evaluate`). This is for
the cases that nobody thought of. If the process ends while judging an answer, we report that answer
as undecided, and a new process continues with the next.
"""

import json
import math
import os
import resource
import signal
import traceback
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import replace
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from typing import Any, NoReturn

from ..record import Mark, Record
from ..workers import ends_with
from . import marking
from .cases import Contracts
from .contract import Contract

#: Seconds of processor time for one question of one student. An honest answer takes milliseconds.
MOST_SECONDS = 10
#: Bytes that the process may take in addition to what it begins with.
MOST_MEMORY = 1 << 30
#: Seconds without the beginning of a message, on a machine however busy, after which we end the
#: process. The rest of a message follows at once, since the judge sends only complete ones.
LONGEST_SILENCE = 60 * MOST_SECONDS


class Judge(AbstractContextManager["Judge"]):
    """A judge of records. Its process starts when there is something to judge.

    Parameters
    ----------
    questions : mapping
        The questions of each assignment, by its name.
    contracts : Contracts
    log : function
        Receives a line about each answer that could not be judged.
    """

    def __init__(
        self,
        questions: Mapping[str, Mapping[str, Sequence[Contract]]],
        contracts: Contracts,
        log: Callable[[str], None],
    ) -> None:
        self.questions, self.contracts, self.log = questions, contracts, log
        self.process: tuple[int, Connection] | None = None
        self.of = os.getpid()

    def __exit__(self, *error: object) -> None:
        self.end()

    def marks(self, record: Record) -> dict[str, Mark]:
        """Return the marks of a record, by the names of its questions.

        Raises
        ------
        ValueError
            A question's variant was removed, and no copy of it is stored.
        """
        if self.of != os.getpid():
            # A forked copy of this process needs a judge of its own.
            self.process, self.of = None, os.getpid()
        marks: dict[str, Mark] = {}
        while True:
            _, judge = self.process = self.process or self._begin()
            begun = ""
            try:
                _say(judge, {"record": record.as_json(), "without": list(marks)})
                while "end" not in (said := _hear(judge, LONGEST_SILENCE)):
                    if "error" in said:
                        raise ValueError(said["error"])
                    if "fault" in said:
                        raise RuntimeError(said["fault"])
                    if "mark" in said:
                        marks[begun] = Mark.from_json(said["mark"], begun)
                    else:
                        begun = said["begin"]
                return marks
            except (EOFError, OSError):
                self.end()
                if not begun or begun in marks:
                    raise RuntimeError(
                        "The judging process ended while no answer was being judged."
                    ) from None
                marks[begun] = self._stopped(record, begun)

    def _stopped(self, record: Record, name: str) -> Mark:
        self.log(
            f"not judged, because it takes too long: {record.student!r} {record.assignment} {name}"
        )
        own, _ = marking.of_student(
            {name: self.questions[record.assignment][name]}, record.student, record, self.contracts
        )
        contract = own[name].contract
        return replace(marking.UNJUDGED, worth=contract.worth, version=contract.version)

    # -- the process

    def _begin(self) -> tuple[int, Connection]:
        (judge, other), asking = Pipe(), os.getpid()
        with warnings.catch_warnings():
            # The copy uses nothing that another thread of this process may hold.
            warnings.simplefilter("ignore", DeprecationWarning)
            number = os.fork()
        if not number:
            self._judge(other, asking)
        other.close()
        return number, judge

    def end(self) -> None:
        """End the process, if there is one and this process started it."""
        if self.process is not None and self.of == os.getpid():
            number, judge = self.process
            judge.close()
            os.kill(number, signal.SIGKILL)
            os.waitpid(number, 0)
        self.process = None

    def _judge(self, asks: Connection, asking: int) -> NoReturn:
        """Answer requests until the process is ended; this runs in the judge's process."""
        try:
            if ends_with(asking):
                signal.signal(signal.SIGINT, signal.SIG_IGN)
                signal.signal(signal.SIGTERM, signal.SIG_DFL)
                # Close everything inherited, since another process may wait for it to be closed.
                os.closerange(3, asks.fileno())
                os.closerange(asks.fileno() + 1, os.sysconf("SC_OPEN_MAX"))
                _limit_memory()
                while True:
                    asked = _hear(asks)
                    record = Record.from_json(asked["record"], "a record")
                    for said in self._marks(record, asked["without"]):
                        _say(asks, said)
        except (EOFError, OSError):
            pass
        finally:
            os._exit(0)

    def _marks(self, record: Record, without: list[str]) -> Iterator[dict[str, Any]]:
        try:
            own, _ = marking.of_student(
                self.questions[record.assignment], record.student, record, self.contracts
            )
            limited = marking.was_limited(record)
            for name, question in own.items():
                if name not in without:
                    yield {"begin": name}
                    _limit_time()
                    mark = marking.mark_with_siblings(
                        name, question, record.answers, record.remembered, record.finished, limited
                    )
                    yield {"mark": mark.as_json()}
            yield {"end": True}
        except ValueError as error:
            yield {"error": str(error)}
        except MemoryError:
            os._exit(1)
        except Exception:
            yield {"fault": traceback.format_exc()}


def _limit_memory() -> None:
    if os.path.exists("/proc/self/statm"):
        with open("/proc/self/statm") as file:
            begun = int(file.read().split()[0]) * resource.getpagesize()
        resource.setrlimit(
            resource.RLIMIT_AS, (begun + MOST_MEMORY, resource.getrlimit(resource.RLIMIT_AS)[1])
        )


def _limit_time() -> None:
    used = resource.getrusage(resource.RUSAGE_SELF)
    until = math.ceil(used.ru_utime + used.ru_stime) + MOST_SECONDS
    resource.setrlimit(resource.RLIMIT_CPU, (until, resource.getrlimit(resource.RLIMIT_CPU)[1]))


def _say(other: Connection, message: dict[str, Any]) -> None:
    other.send_bytes(json.dumps(message).encode())


def _hear(other: Connection, seconds: float | None = None) -> dict[str, Any]:
    if not other.poll(seconds):
        raise EOFError
    message: dict[str, Any] = json.loads(other.recv_bytes())
    return message
