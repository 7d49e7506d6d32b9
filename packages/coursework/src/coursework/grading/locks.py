"""A file that one process at a time has for itself, until it closes it:
on Linux, on macOS and on Windows.
"""

import time
from typing import IO, Any

try:
    import fcntl
except ModuleNotFoundError:  # Windows
    import msvcrt

#: Windows locks bytes, and whoever has not locked them cannot read them: one that no file reaches.
BEYOND = 1 << 40
PAUSE = 0.05  # seconds between two tries, where the system knows no longer wait


def lock(file: IO[Any], wait: bool = True) -> None:
    """Have an open file for oneself until it is closed.

    Raises
    ------
    BlockingIOError
        Another process has it, and ``wait`` is false.
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
