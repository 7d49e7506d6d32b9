"""The ID of the student who works in this notebook, stored once beside the notebooks.

Page, notebook and grader share it. With it, each student of a course gets individual numbers. A
student who forgets it gets the default numbers, which earn nothing there, so the cell that asks for
it says so. An edition without a roster does not ask for it.
"""

import unicodedata
from contextlib import suppress
from pathlib import Path

# The file with the ID for this folder; the pages of a book use the same name for it.
KEPT = Path(".coursework", "me.txt")
# The message if nobody has given an ID.
FORGOTTEN = (
    "You have the default numbers. For credit, put your ID in student('...') and run this cell "
    "again."
)
# The placeholder for an ID in notebooks that leave it to the student.
PLACEHOLDER = "your ID"
# If no ID has been given in this notebook, the stored one applies.
_identity: str | None = None


def student(identity: str = "", *others: str) -> None:
    """Say who you are, so that you get your own numbers: ``student('ada@uni.example')``.

    Once is enough: your ID is stored beside your notebooks (in JupyterLite, in the browser), and
    ``student('')`` in another one finds it there and says so. Without it you get the default
    numbers; answers to somebody else's numbers earn no points.

    Parameters
    ----------
    identity : str
        As in your instructor's roster; capitals and surrounding spaces make no difference.

    Raises
    ------
    TypeError
        If more than one ID is given.
    """
    global _identity
    if others:
        raise TypeError(
            f"`student` takes one ID, as in your instructor's roster: {identity!r} or "
            f"{' or '.join(map(repr, others))}."
        )
    _identity, before = plain_identity("" if identity == PLACEHOLDER else identity), _kept()
    if not _identity and before:
        _identity = before
        print(f"You are still {before.removesuffix('.')}. The numbers below are yours.")
    elif before not in ("", _identity):
        print(
            f"You are {_identity} now, and were {before} before, so your numbers have changed. We "
            "keep the record of what you solved before."
        )
    else:
        print(
            f"You are {_identity.removesuffix('.')}. The numbers below are yours."
            if _identity
            else FORGOTTEN
        )
    # In a read-only folder, each notebook asks again.
    with suppress(OSError):
        if _identity:
            KEPT.parent.mkdir(exist_ok=True)
            KEPT.write_text(_identity, "utf8")


def identity() -> str:
    """Return the student's ID, or an empty string; functions for students pass it on."""
    global _identity
    if _identity is None:
        _identity = _kept()
    return _identity


def _kept() -> str:
    with suppress(OSError, UnicodeError):
        return plain_identity(KEPT.read_text("utf8"))
    return ""


def plain_identity(identity: str) -> str:
    """Return an ID in the form in which IDs are compared.

    Unicode forms, invisible characters, capitals and surrounding spaces make no difference.

    >>> plain_identity("Zoe\u0308\u200b") == plain_identity(" ZO\u00cb")
    True
    """
    letters = unicodedata.normalize("NFKC", str(identity))
    shown = "".join(letter for letter in letters if unicodedata.category(letter) != "Cf")
    return " ".join(shown.split()).casefold()
