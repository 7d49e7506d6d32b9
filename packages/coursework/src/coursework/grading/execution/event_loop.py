"""An event loop for cells that await something, where no socket may be opened.

The loops of the standard library wake up through a pair of sockets; this one uses a pipe.
"""

import asyncio
import os
from collections.abc import Callable


class _End:
    """One end of a pipe, with the few methods of a socket that a loop uses."""

    def __init__(self, handle: int) -> None:
        self.handle = handle
        os.set_blocking(handle, False)

    def fileno(self) -> int:
        return self.handle

    def recv(self, size: int) -> bytes:
        return os.read(self.handle, size)

    def send(self, data: bytes) -> int:
        return os.write(self.handle, data)

    def close(self) -> None:
        os.close(self.handle)


class PipeEventLoop(asyncio.SelectorEventLoop):
    """A loop without sockets of its own.

    >>> from concurrent.futures import ThreadPoolExecutor
    >>> loop = PipeEventLoop()
    >>> with ThreadPoolExecutor(1) as own:  # a thread in which no other loop runs
    ...     own.submit(loop.run_until_complete, asyncio.sleep(0, 'done')).result()
    'done'
    >>> loop.close()
    """

    # Private members of the loop, which have no public names.
    _internal_fds: int
    _add_reader: Callable[[int, Callable[[], None]], None]
    _read_from_self: Callable[[], None]

    def _make_self_pipe(self) -> None:
        self._ssock, self._csock = map(_End, os.pipe())
        self._internal_fds += 1
        self._add_reader(self._ssock.fileno(), self._read_from_self)
