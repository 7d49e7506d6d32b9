"""Whether bytes are a picture from the first to the last of them, and nothing else.

Nothing is decoded here; the parts of the file are walked through, and each says
of itself what it is and how long.
"""

import struct
import zlib

PNG, JPEG = "image/png", "image/jpeg"
PNG_BEGINS = b"\x89PNG\r\n\x1a\n"
#: Pixels of a picture that is shown, at most: a small file may unpack to gigabytes in a browser.
MOST_PIXELS = 40_000_000


def is_picture(kind: str, data: bytes) -> bool:
    """Whether these bytes are a whole picture of a kind, of a size that can be shown."""
    try:
        return {PNG: _is_png, JPEG: _is_jpeg}[kind](data)
    except (KeyError, IndexError, struct.error):
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


#: Parts of a JPEG file that say nothing but their own name.
ALONE = {0x01, *range(0xD0, 0xD8)}
#: Those that say the size: baseline, extended, progressive, and the rarer ones; not
#: tables and arithmetic conditions.
SIZES = {*range(0xC0, 0xD0)} - {0xC4, 0xC8, 0xCC}
END, SCAN = 0xD9, 0xDA


def _is_jpeg(data: bytes) -> bool:
    if not data.startswith(b"\xff\xd8"):
        return False
    place, sized, scanned = 2, False, False
    while True:
        if data[place] != 0xFF:
            return False
        while data[place] == 0xFF:
            place += 1
        part = data[place]
        place += 1
        if part == END:
            return sized and scanned and place == len(data)
        if part in ALONE:
            continue
        (length,) = struct.unpack_from(">H", data, place)
        if part in SIZES:
            high, wide = struct.unpack_from(">HH", data, place + 3)
            sized = 0 < wide * high <= MOST_PIXELS
            if not sized:
                return False
        place += length
        if part == SCAN:
            scanned = True
            # What follows are numbers, in which 0xFF is followed by 0 or by the
            # name of a place to begin anew.
            while not (data[place] == 0xFF and data[place + 1] not in (0x00, *range(0xD0, 0xD8))):
                place += 1
