"""Whether bytes are a picture from the first to the last of them, and nothing else: a plot in PNG.

Nothing is decoded here; the parts of the file are walked through, and each says
of itself what it is and how long.
"""

import contextlib
import struct
import zlib

PNG = "image/png"
PNG_BEGINS = b"\x89PNG\r\n\x1a\n"
#: Most pixels in a picture that we show, since a small file may unpack to gigabytes in a browser.
MOST_PIXELS = 40_000_000


def is_picture(data: bytes) -> bool:
    """Whether these bytes are a whole picture in PNG, of a size that can be shown."""
    with contextlib.suppress(IndexError, struct.error):
        return _is_png(data)
    return False


def _is_png(data: bytes) -> bool:
    if not data.startswith(PNG_BEGINS):
        return False
    place = len(PNG_BEGINS)
    names: list[bytes] = []
    while place < len(data):
        length, name = struct.unpack_from(">I4s", data, place)
        body = data[place + 4 : place + 8 + length]
        (check,) = struct.unpack_from(">I", data, place + 8 + length)
        if len(body) != 4 + length or check != zlib.crc32(body):
            return False
        if not names:
            wide, high = struct.unpack_from(">II", body, 4)
            if name != b"IHDR" or length != 13 or not 0 < wide * high <= MOST_PIXELS:
                return False
        names.append(name)
        place += 12 + length
        if name == b"IEND":
            break
    return (
        place == len(data)
        and names[-1:] == [b"IEND"]
        and b"IDAT" in names
        and names.count(b"IHDR") == 1
    )
