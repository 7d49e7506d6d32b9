"""Start of a command at the same addresses each time, on which some results may depend.

The kernel drops the setting when a program gains rights, and treats root's as gained wherever root
could have more than it has, such as within bubblewrap. So we first give up the missing rights and
then make the setting. A container may forbid it; then the addresses vary.
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
