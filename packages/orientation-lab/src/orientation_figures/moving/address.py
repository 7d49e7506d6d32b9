"""The data after the ``#`` in an address of the book, in one format with a version.

It is usually the name of a place on the page. More data follow after ``=1.``: the state of a
figure, or the numbers of two programs. The number is the version of this format. An address that
somebody has kept remains readable, and one of a newer format is refused with a message. The part
after ``#`` is not sent to any server. ``js/address.js`` writes and reads them on the
page, as ``orientation.fragmentOf`` and ``orientation.carriedBy``.
"""

import base64
import json
from collections.abc import Mapping
from typing import TypeAlias

VERSION = 1
# Plain data that JSON can represent.
Plain: TypeAlias = "None | bool | float | str | list[Plain] | dict[str, Plain]"
# In characters. Some programs truncate longer addresses when they pass them on.
LARGEST = 6000


class BadAddress(ValueError):
    """An address would carry too much."""


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
    """
    text = json.dumps(content, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    data = base64.urlsafe_b64encode(text.encode("utf8")).decode("ascii")
    if len(data) > LARGEST:
        raise BadAddress(
            "This is too long for an address, which some programs would cut off. Send it as a file."
        )
    return f"#{place}={VERSION}.{data.rstrip('=')}"
