"""What an address of the book carries behind its ``#``, in one format with a version.

As a rule that is the name of a place on the page. Where there is more to say, ``=1.`` follows and
then plain data: how a figure stands, or what two programs gave. The number is the version of this
format: an address that somebody has kept is read for ever, and one of a newer format is refused in
words. What stands behind ``#`` is sent to no server. ``js/address.js`` is the same in the language
of the page, where it is ``orientation.fragmentOf`` and ``orientation.carriedBy``.
"""

import base64
import json
import re
from collections.abc import Mapping
from typing import TypeAlias

VERSION = 1
#: Plain data of the kind that JSON can hold.
Plain: TypeAlias = "None | bool | float | str | list[Plain] | dict[str, Plain]"
#: In characters. Some programs cut longer addresses when they pass them on.
LARGEST = 6000
FRAGMENT = re.compile(r"#?([a-z0-9-]+)=([0-9]+)\.(.*)", re.DOTALL)


class BadAddress(ValueError):
    """An address carries too much, or is not whole, or of a newer
    format; the message says which.
    """


def fragment_of(place: str, content: Mapping[str, Plain]) -> str:
    """The fragment of an address that carries plain data to a place on a page.

    Parameters
    ----------
    place : str
        The name of the place: the label of a figure, say.
    content : dict
        Plain data, as JSON has it.

    Returns
    -------
    str
        Begins with ``#``; holds letters, digits and ``# - . = _`` alone, so that no program changes
        it.

    Raises
    ------
    BadAddress
        There is too much of it.

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
            "This is too much for an address, which some programs would cut. Send it as a file."
        )
    return f"#{place}={VERSION}.{data.rstrip('=')}"


def carried_by(fragment: str) -> tuple[str, dict[str, Plain]] | None:
    """The place and the data that a fragment carries, or ``None``
    where it is a plain name of a place.

    The data may come from anybody: whoever takes it up accepts what a reader
    could have entered, and nothing else.

    Raises
    ------
    BadAddress
        It is not whole, or of a newer format.
    """
    found = FRAGMENT.fullmatch(fragment)
    if found is None:
        return None
    place, version, text = found.groups()
    if int(version) > VERSION:
        raise BadAddress(
            f"This address is of format {version}, and this edition of the book reads {VERSION}."
        )
    try:
        data = base64.b64decode(text + "=" * (-len(text) % 4), altchars="-_", validate=True)
        content: Plain = json.loads(data.decode("utf8"))
    except ValueError:
        content = None
    if len(text) > LARGEST or not isinstance(content, dict):
        raise BadAddress(
            "This address is not whole: a part of it got lost. Copy it again, to its last letter."
        )
    return place, content
