"""The data after the ``#`` in an address of the book, in one format with a version.

It is usually the name of a place on the page. More data follow after ``=1.``: the state of a
figure, or the numbers of two programs. The number is the version of this format. An address that
somebody has kept remains readable, and one of a newer format is refused with a message. The part
after ``#`` is not sent to any server. ``js/address.js`` is the counterpart for the page, where it
is ``orientation.fragmentOf`` and ``orientation.carriedBy``.
"""

import base64
import json
import re
from collections.abc import Mapping
from typing import TypeAlias

VERSION = 1
# Plain data that JSON can represent.
Plain: TypeAlias = "None | bool | float | str | list[Plain] | dict[str, Plain]"
# In characters. Some programs truncate longer addresses when they pass them on.
LARGEST = 6000
FRAGMENT = re.compile(r"#?([a-z0-9-]+)=([0-9]+)\.(.*)", re.DOTALL)


class BadAddress(ValueError):
    """An address carries too much, is incomplete, or has a newer format; the message says which."""


def fragment_of(place: str, content: Mapping[str, Plain]) -> str:
    """Return the fragment of an address that carries plain data to a place on a page.

    Parameters
    ----------
    place : str
        The name of the place: the label of a figure, say.
    content : dict
        Plain data that JSON can represent.

    Returns
    -------
    str
        Begins with ``#`` and contains only letters, digits and ``# - . = _``, so that no program
        changes it.

    Raises
    ------
    BadAddress
        There are too many data.

    Examples
    --------
    >>> fragment_of('fig-gimbal', {'angles': [0.5, 0, 0]})
    '#fig-gimbal=1.eyJhbmdsZXMiOlswLjUsMCwwXX0'
    >>> carried_by(_)
    ('fig-gimbal', {'angles': [0.5, 0, 0]})
    """
    text = json.dumps(content, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    data = base64.urlsafe_b64encode(text.encode("utf8")).decode("ascii")
    if len(data) > LARGEST:
        raise BadAddress(
            "This is too long for an address, which some programs would cut off. Send it as a file."
        )
    return f"#{place}={VERSION}.{data.rstrip('=')}"


def carried_by(fragment: str) -> tuple[str, dict[str, Plain]] | None:
    """Return the place and the data in a fragment, or ``None`` if it is only the name of a place.

    The data may come from anyone, so callers must accept only what a reader could have entered.

    Raises
    ------
    BadAddress
        The fragment is incomplete or has a newer format.
    """
    match = FRAGMENT.fullmatch(fragment)
    if match is None:
        return None
    place, version, text = match.groups()
    if int(version) > VERSION:
        raise BadAddress(
            f"This address has format {version}, but this edition of the book reads only format "
            f"{VERSION}."
        )
    try:
        data = base64.b64decode(text + "=" * (-len(text) % 4), altchars="-_", validate=True)
        content: Plain = json.loads(data.decode("utf8"))
    except ValueError:
        content = None
    if len(text) > LARGEST or not isinstance(content, dict):
        raise BadAddress("This address is incomplete. Copy it again, to its last character.")
    return place, content
