"""The judge, in its own process: an answer that takes too long, or too much memory, harms no other.

Answers are plain data, and evaluating them is bounded (`coursework.checking.evaluate`). This is for
the cases that nobody thought of. If the process ends while judging an answer, we report that answer
as undecided, and a new process continues with the next.
"""

import ctypes
import json
import math
import os
import resource
import select
import signal
import struct
import sys
import time
import traceback
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import TracebackType
from typing import Any, NoReturn, Self

from ..record import Mark, Record
from . import marking
from .cases import Contracts
from .contract import Contract

#: Seconds of processor time for one question of one student. An honest answer takes milliseconds.
MOST_SECONDS = 10
#: Bytes that the process may take in addition to what it begins with.
MOST_MEMORY = 1 << 30
#: Seconds without a message, on a machine however busy, after which we end the process.
LONGEST_SILENCE = 60 * MOST_SECONDS
PR_SET_PDEATHSIG = 1


class Judge:
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
        self.process: tuple[int, int, int] | None = None
        self.of = os.getpid()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
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
            self.process, self.of = (None, os.getpid())
        found: dict[str, Mark] = {}
        while True:
            if self.process is None:
                self.process = self._begin()
            begun = ""
            try:
                self._say({"record": record.as_json(), "without": list(found)})
                while "end" not in (said := self._hear()):
                    if "error" in said:
                        raise ValueError(said["error"])
                    if "fault" in said:
                        raise RuntimeError(said["fault"])
                    if "mark" in said:
                        found[begun] = Mark.from_json(said["mark"], begun)
                    else:
                        begun = said["begin"]
                return found
            except (EOFError, OSError):
                self.end()
                if not begun or begun in found:
                    raise RuntimeError(
                        "The judging process ended while no answer was being judged."
                    ) from None
                found[begun] = self._stopped(record, begun)

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

    def _begin(self) -> tuple[int, int, int]:
        hears, asks = os.pipe()
        heard, says = os.pipe()
        asking = os.getpid()
        with warnings.catch_warnings():
            # The copy uses nothing that another thread of this process may hold.
            warnings.simplefilter("ignore", DeprecationWarning)
            number = os.fork()
        if not number:
            self._judge(hears, says, asking)
        os.close(hears)
        os.close(says)
        return number, asks, heard

    def end(self) -> None:
        """End the process, if there is one and this process started it."""
        if self.process is not None and self.of == os.getpid():
            number, asks, heard = self.process
            os.close(asks)
            os.close(heard)
            os.kill(number, signal.SIGKILL)
            os.waitpid(number, 0)
        self.process = None

    def _say(self, message: dict[str, Any]) -> None:
        assert self.process is not None
        _write(self.process[1], message)

    def _hear(self) -> dict[str, Any]:
        assert self.process is not None
        return _read(self.process[2], time.monotonic() + LONGEST_SILENCE)

    def _judge(self, hears: int, says: int, asking: int) -> NoReturn:
        """Answer requests until the process is ended; this runs in the judge's process."""
        try:
            if sys.platform.startswith("linux"):
                ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
            if os.getppid() == asking:
                signal.signal(signal.SIGINT, signal.SIG_IGN)
                signal.signal(signal.SIGTERM, signal.SIG_DFL)
                first, second = sorted((hears, says))
                # Close everything inherited, since another process may wait for it to be closed.
                for low, high in (
                    (3, first),
                    (first + 1, second),
                    (second + 1, os.sysconf("SC_OPEN_MAX")),
                ):
                    os.closerange(low, high)
                _limit_memory()
                while True:
                    asked = _read(hears)
                    for said in self._marks(
                        Record.from_json(asked["record"], "a record"), asked["without"]
                    ):
                        _write(says, said)
        except (EOFError, OSError):
            pass
        finally:
            os._exit(0)

    def _marks(self, record: Record, without: list[str]) -> Any:
        try:
            own, _ = marking.of_student(
                self.questions[record.assignment], record.student, record, self.contracts
            )
            limited = marking.was_limited(record)
            for name, question in own.items():
                if name not in without:
                    yield {"begin": name}
                    _limit_time()
                    found = marking.mark_with_siblings(
                        name, question, record.answers, record.remembered, record.finished, limited
                    )
                    yield {"mark": found.as_json()}
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


def _write(handle: int, message: dict[str, Any]) -> None:
    data = json.dumps(message).encode()
    data = struct.pack(">Q", len(data)) + data
    while data:
        data = data[os.write(handle, data) :]


def _read(handle: int, until: float = math.inf) -> dict[str, Any]:
    (length,) = struct.unpack(">Q", _exactly(handle, 8, until))
    found: dict[str, Any] = json.loads(_exactly(handle, length, until))
    return found


def _exactly(handle: int, number: int, until: float) -> bytes:
    found = bytearray()
    while len(found) < number:
        if (
            until < math.inf
            and not select.select([handle], [], [], max(0.0, until - time.monotonic()))[0]
        ):
            raise EOFError
        piece = os.read(handle, min(number - len(found), 1 << 20))
        if not piece:
            raise EOFError
        found += piece
    return bytes(found)
