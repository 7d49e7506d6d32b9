"""A lock on a file for one process at a time, until it closes it, on Linux, macOS and Windows."""

import time
from typing import IO, Any

try:
    import fcntl
except ModuleNotFoundError:  # Windows
    import msvcrt

#: Windows locks bytes and denies others reading them, so lock one beyond the end of any file.
BEYOND = 1 << 40
# Seconds between two attempts; Windows has no longer wait.
PAUSE = 0.05


def lock(file: IO[Any], wait: bool = True) -> None:
    """Lock an open file until it is closed.

    Raises
    ------
    BlockingIOError
        Another process has locked it, and ``wait`` is false.
    """
    if "fcntl" in globals():
        fcntl.flock(file, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
        return
    while True:
        place = file.tell()
        file.seek(BEYOND)
        try:
            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined]
            return
        except OSError as error:
            if not wait:
                raise BlockingIOError(*error.args) from None
            time.sleep(PAUSE)
        finally:
            file.seek(place)
