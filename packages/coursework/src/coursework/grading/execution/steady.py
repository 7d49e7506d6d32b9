"""Runs a command at the same addresses each time: some of what a
notebook works out depends on them.

The system forgets the wish where a program gains rights, and counts root's as gained wherever root
could have more of them than it has: within bubblewrap. So what is not there is given up first, and
the wish made then. A container may forbid it; then addresses stay as they are.
"""

import ctypes
import os
import struct
import sys

ADDR_NO_RANDOMIZE = 0x0040000
CAPABILITIES_VERSION = 0x20080522
DROP_FROM_BOUNDING_SET = 24


def main(*command: str) -> None:
    library = ctypes.CDLL(None)
    data = ctypes.create_string_buffer(24)
    library.capget(struct.pack("=Ii", CAPABILITIES_VERSION, 0), data)
    _, low, _, _, high, _ = struct.unpack("=6I", data.raw)
    permitted = low | high << 32
    for capability in range(64):
        if not permitted >> capability & 1:
            library.prctl(DROP_FROM_BOUNDING_SET, capability, 0, 0, 0)
    library.personality(ADDR_NO_RANDOMIZE)
    os.execv(command[0], command)


if __name__ == "__main__":
    main(*sys.argv[1:])
