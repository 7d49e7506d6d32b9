"""Locks that only an answer opens.

A slow hash stretches the fingerprint of an answer to a key. The key gives the name of a locker and
opens its content: the short names of mistakes in the catalogue, or the key of a page with more
content. All lockers have one size, whether they contain the right answer, a mistake or the cell
beside one, so a student's data reveal neither the answer nor the known mistakes.

The key of a page depends on the slow hash, too, so nothing in a file can be tried faster.

Whatever can be checked without a server can also be tried without one. The slow hash makes each try
cost about 12 ms; an answer with few possibilities remains guessable, and the author's report lists
such answers.
"""

import base64
import hashlib
import hmac
import json
import zlib
from collections.abc import Iterable
from typing import Any

#: Rounds of the slow hash (PBKDF2 with HMAC-SHA-256, RFC 8018).
ROUNDS = 40_000
# Pages are padded to a multiple of this, so that their length reveals little.
BLOCK = 48
# The sizes in bytes of the name of a locker, of its content, of its tag, of the key of a page and
# of its tag.
NAME, INSIDE, TAG, PAGE_KEY, PAGE_TAG = 4, 10, 2, 8, 8
LOCKER = NAME + INSIDE + TAG
#: Bytes of the short name of a mistake.
MISTAKE = 4
# The page's number in a locker without a page.
NO_PAGE = 0xFF


def slow_key(salt: str, fingerprint: str) -> bytes:
    """Stretch a fingerprint into a key of 32 bytes."""
    return pbkdf2(fingerprint.encode("utf8"), salt.encode("ascii"), ROUNDS)


def portable_pbkdf2(password: bytes, salt: bytes, rounds: int) -> bytes:
    """Compute one block of PBKDF2 with HMAC-SHA-256, for a Python built without OpenSSL.

    In a browser's Python the standard library has no ``pbkdf2_hmac``.

    >>> portable_pbkdf2(b'password', b'salt', 2).hex()[:16]
    'ae4d0c95af6b46d3'
    """
    inner, outer = (
        hashlib.sha256(bytes(byte ^ pad for byte in _block(password))).copy for pad in (0x36, 0x5C)
    )
    as_number = int.from_bytes
    current, total = salt + b"\0\0\0\1", 0
    # Calls of our own functions are slow in a browser's Python, so avoid them in the loop.
    for _ in range(rounds):
        first, second = inner(), outer()
        first.update(current)
        second.update(first.digest())
        current = second.digest()
        total ^= as_number(current)
    return total.to_bytes(32)


def _block(password: bytes) -> bytes:
    return (hashlib.sha256(password).digest() if len(password) > 64 else password).ljust(64, b"\0")


if hasattr(hashlib, "pbkdf2_hmac"):

    def pbkdf2(password: bytes, salt: bytes, rounds: int) -> bytes:
        return hashlib.pbkdf2_hmac("sha256", password, salt, rounds)
else:
    pbkdf2 = portable_pbkdf2


# --- lockers: 16 bytes each, 20 characters in the file ------------------------------------------


def locker(
    key: bytes,
    outcome: int,
    mistakes: Iterable[bytes] = (),
    page: int = NO_PAGE,
    page_key: bytes = b"",
) -> bytes:
    """Make a locker: an outcome, and up to two short names of mistakes or a page with its key."""
    inside = bytes([outcome, page]) + (
        b"".join(mistakes).ljust(PAGE_KEY, b"\0") if page == NO_PAGE else page_key
    )
    hidden = _mask(inside, key, "locker")
    return _name(key) + hidden + _tag(hidden, key, "locker")[:TAG]


def pack(lockers: Iterable[bytes]) -> str:
    """Return the text of some lockers, in an order that reveals nothing."""
    return _text(b"".join(sorted(lockers)))


def pages_filled_up(pages: Iterable[str], count: int, secret: str) -> list[str]:
    """Pad sealed pages with empty ones to ``count`` in all.

    Each is as long as some other page and cannot be opened; only the secret distinguishes them.

    >>> pages = pages_filled_up([seal("a", bytes(8)), seal("b" * 99, bytes(8))], 4, "a secret")
    >>> [len(page) for page in pages]
    [70, 70, 70, 70]
    """
    pages = list(pages)
    lengths = [len(base64.b85decode(page)) for page in pages] or [BLOCK + PAGE_TAG]
    for order in range(count - len(pages)):
        drawn = hashlib.shake_256(f"{secret} page {order}".encode()).digest(4 + max(lengths))
        pages.append(_text(drawn[4:][: lengths[int.from_bytes(drawn[:4]) % len(lengths)]]))
    return pages


def count_of(lockers: str) -> int:
    """Return the number of lockers in their text."""
    return len(base64.b85decode(lockers)) // LOCKER


def filled_up(lockers: str, count: int, secret: str) -> str:
    """Pad lockers with empty ones to ``count`` in all; only the secret distinguishes them.

    >>> few = pack([locker(bytes(32), 0)])
    >>> many = filled_up(few, 8, "a secret")
    >>> count_of(many), open_locker(many, bytes(32)) == open_locker(few, bytes(32))
    (8, True)
    """
    data = base64.b85decode(lockers)
    full = [data[start : start + LOCKER] for start in range(0, len(data), LOCKER)]
    empty = [
        hashlib.shake_256(f"{secret} {order}".encode()).digest(LOCKER)
        for order in range(count - len(full))
    ]
    return pack(full + empty)


def open_locker(lockers: str, key: bytes) -> tuple[int, int | None, bytes] | None:
    """Open the locker of a key; return its outcome, page and the page's key, or ``None``.

    A page describes the mistakes itself. Without a page, the second item is ``None``, and the third
    contains the mistakes for `mistakes_in`.

    Raises
    ------
    ValueError
        The data was changed.
    """
    data, name = base64.b85decode(lockers), _name(key)
    for start in range(0, len(data), LOCKER):
        if data[start : start + NAME] == name:
            hidden, tag = (
                data[start + NAME : start + NAME + INSIDE],
                data[start + NAME + INSIDE : start + LOCKER],
            )
            if not hmac.compare_digest(tag, _tag(hidden, key, "locker")[:TAG]):
                raise ValueError("The sealed data has been changed.")
            inside = _mask(hidden, key, "locker")
            return inside[0], None if inside[1] == NO_PAGE else inside[1], inside[2:]
    return None


def mistakes_in(inside: bytes) -> list[bytes]:
    """Return the short names of the mistakes in a locker without a page.

    >>> mistakes_in(b"abcd" + bytes(4)), mistakes_in(bytes(8))
    ([b'abcd'], [])
    """
    names = [inside[start : start + MISTAKE] for start in range(0, len(inside), MISTAKE)]
    return [name for name in names if any(name)]


# --- right answers of other variants: only names, which lead to nothing -------------------------


def name_of(key: bytes) -> bytes:
    """Return the name by which an answer is recognised as right for some variant of a question."""
    return _derive(key, "right for some numbers")[:NAME]


def pack_names(names: Iterable[bytes], together: int) -> str:
    """Return the text of names in an uninformative order, padded to a multiple of ``together``.

    >>> packed = pack_names([name_of(bytes(32))], 8)
    >>> len(base64.b85decode(packed)) // NAME
    8
    >>> is_among(packed, bytes(32)), is_among(packed, b"1" * 32)
    (True, False)
    """
    names = sorted(set(names))
    seed = b"".join(names)
    empty = [
        hashlib.shake_256(seed + bytes([order])).digest(NAME)
        for order in range(-len(names) % together)
    ]
    return _text(b"".join(sorted([*names, *empty])))


def is_among(packed: str, key: bytes) -> bool:
    """Check whether the name that belongs to a key is among the packed ones."""
    data, name = base64.b85decode(packed), name_of(key)
    return any(data[start : start + NAME] == name for start in range(0, len(data), NAME))


def _name(key: bytes) -> bytes:
    return _derive(key, "name of the locker")[:NAME]


# --- pages --------------------------------------------------------------------------------------


def seal(content: object, key: bytes) -> str:
    """Lock up JSON content as a page."""
    data = zlib.compress(json.dumps(content, ensure_ascii=False, sort_keys=True).encode("utf8"), 9)
    data = len(data).to_bytes(4) + data
    data = data.ljust(-(-len(data) // BLOCK) * BLOCK, b"\0")
    hidden = _mask(data, key, "page")
    return _text(hidden + _tag(hidden, key, "page")[:PAGE_TAG])


def unseal(sealed: str, key: bytes) -> Any:
    """Open what `seal` locked.

    Raises
    ------
    ValueError
        The key is wrong, or the data was changed.
    """
    data = base64.b85decode(sealed)
    hidden, tag = data[:-PAGE_TAG], data[-PAGE_TAG:]
    if not hmac.compare_digest(tag, _tag(hidden, key, "page")[:PAGE_TAG]):
        raise ValueError("The sealed data does not match this key, or has been changed.")
    # The first four bytes are the length, and what follows the data is padding.
    return json.loads(zlib.decompress(_mask(hidden, key, "page")[4:]))


def shorten(text: str, words: str) -> str:
    """Return a text as its differences from words that its reader has, too.

    >>> words = "It is twice the force times the arm."
    >>> lengthen(shorten("It is twice the force times the arm, 12 N m.", words), words)
    'It is twice the force times the arm, 12 N m.'
    """
    packer = zlib.compressobj(9, zlib.DEFLATED, -15, zdict=words.encode("utf8"))
    return _text(packer.compress(text.encode("utf8")) + packer.flush())


def lengthen(short: str, words: str) -> str:
    """Return the text that `shorten` shortened."""
    unpacker = zlib.decompressobj(-15, zdict=words.encode("utf8"))
    return unpacker.decompress(base64.b85decode(short)).decode("utf8")


def _derive(key: bytes, purpose: str) -> bytes:
    return hmac.digest(key, purpose.encode("utf8"), "sha256")


def _mask(data: bytes, key: bytes, purpose: str) -> bytes:
    stream = hashlib.shake_256(_derive(key, f"mask of the {purpose}")).digest(len(data))
    return bytes(a ^ b for a, b in zip(data, stream))


def _tag(hidden: bytes, key: bytes, purpose: str) -> bytes:
    return hmac.digest(_derive(key, f"tag of the {purpose}"), hidden, "sha256")


def _text(data: bytes) -> str:
    return base64.b85encode(data).decode("ascii")
