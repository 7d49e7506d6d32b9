"""Locks that only an answer opens.

The fingerprint of an answer is stretched by a slow hash into a key. The key gives the name of a locker,
which can be looked up, and it opens what lies inside. Lockers for the right answer and for each mistake look
alike, so the data that a student receives tells neither the answer, nor which mistakes are known.

What can be checked without a server can also be tried without one. The slow hash makes each try cost about
15 ms; an answer with few possibilities stays guessable, and the author's report says which those are.
"""

import base64
import hashlib
import hmac
import json
import zlib

#: Rounds of the slow hash (PBKDF2 with HMAC-SHA-256, RFC 8018).
ROUNDS = 50_000
#: Lockers are filled up to a multiple of this, so that their length tells nothing.
BLOCK = 48


def slow_key(salt, fingerprint):
    """Stretch a fingerprint into a key of 32 bytes."""
    return pbkdf2(fingerprint.encode("utf8"), salt.encode("ascii"), ROUNDS)


def portable_pbkdf2(password, salt, rounds):
    """PBKDF2 with HMAC-SHA-256, one block, for a Python that was built without OpenSSL.

    In a browser's Python the standard library has no ``pbkdf2_hmac``.

    >>> portable_pbkdf2(b'password', b'salt', 2).hex()[:16]
    'ae4d0c95af6b46d3'
    """
    inner, outer = (hashlib.sha256(bytes(byte ^ pad for byte in _block(password))) for pad in (0x36, 0x5C))

    def authenticate(message):
        first, second = inner.copy(), outer.copy()
        first.update(message)
        second.update(first.digest())
        return second.digest()

    current = authenticate(salt + b"\0\0\0\1")
    total = int.from_bytes(current, "big")
    for _ in range(rounds - 1):
        current = authenticate(current)
        total ^= int.from_bytes(current, "big")
    return total.to_bytes(32, "big")


def _block(password):
    return (hashlib.sha256(password).digest() if len(password) > 64 else password).ljust(64, b"\0")


if hasattr(hashlib, "pbkdf2_hmac"):

    def pbkdf2(password, salt, rounds):
        return hashlib.pbkdf2_hmac("sha256", password, salt, rounds)
else:
    pbkdf2 = portable_pbkdf2


def locker(key, purpose="reply"):
    """Name of the locker that a key opens."""
    return _text(_derive(key, f"name of the {purpose}")[:9])


def seal(content, key, purpose="reply", length=0):
    """Lock up JSON content; shorter content is filled up to ``length`` bytes first."""
    data = zlib.compress(json.dumps(content, ensure_ascii=False, sort_keys=True).encode("utf8"), 9)
    data = len(data).to_bytes(4, "big") + data
    data = data.ljust(max(length, -(-len(data) // BLOCK) * BLOCK), b"\0")
    hidden = _mask(data, key, purpose)
    return _text(hidden + _tag(hidden, key, purpose))


def unseal(sealed, key, purpose="reply"):
    """Open what :func:`seal` locked.

    Raises
    ------
    ValueError
        The key is another one, or the data was changed.
    """
    data = base64.b64decode(sealed)
    hidden, tag = data[:-16], data[-16:]
    if not hmac.compare_digest(tag, _tag(hidden, key, purpose)):
        raise ValueError("The sealed data does not fit this key, or was changed.")
    data = _mask(hidden, key, purpose)
    return json.loads(zlib.decompress(data[4 : 4 + int.from_bytes(data[:4], "big")]))


def _derive(key, purpose):
    return hmac.digest(key, purpose.encode("utf8"), "sha256")


def _mask(data, key, purpose):
    stream = hashlib.shake_256(_derive(key, f"mask of the {purpose}")).digest(len(data))
    return bytes(a ^ b for a, b in zip(data, stream))


def _tag(hidden, key, purpose):
    return hmac.digest(_derive(key, f"tag of the {purpose}"), hidden, "sha256")[:16]


def _text(data):
    return base64.b64encode(data).decode("ascii")
