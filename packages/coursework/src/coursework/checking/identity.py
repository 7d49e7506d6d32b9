"""Who works in this notebook: said once, kept beside the notebooks, and known
to page, notebook and grader alike.

With it each student of a course gets numbers of their own. Who forgets it works on the first
numbers, which earn nothing there: so the cell that asks for it says so. An edition without a roster
asks nobody, and says nothing of it.
"""

import unicodedata
from contextlib import suppress
from pathlib import Path

#: Where it is kept who works in this folder; the pages of a book keep it under the same name.
KEPT = Path(".coursework", "me.txt")
#: What is said where nobody has said who works here.
FORGOTTEN = (
    "You have the default numbers. For credit, put your ID into student('...') and run this cell "
    "again."
)
#: What stands in place of an ID in notebooks that leave it to the student to give one.
PLACEHOLDER = "your ID"
#: Nothing has been said in this notebook: then what was said beside it counts.
_identity: str | None = None


def student(identity: str = "") -> None:
    """Say who you are, so that you get your own numbers: ``student('ada@uni.example')``.

    Once is enough: it is kept beside your notebooks (in JupyterLite, in the browser), and
    ``student('')`` in another one finds it there, and says so. Without it you get the default
    numbers; who hands in answers to another one's numbers gets no points for them.

    Parameters
    ----------
    identity : str
        As your instructor's roster has it; capitals and spaces around it make no difference.
    """
    global _identity
    _identity, before = plain_identity("" if identity == PLACEHOLDER else identity), _kept()
    if not _identity and before:
        _identity = before
        print(f"You are {before}, as you said before. The numbers below are yours.")
    elif before not in ("", _identity):
        print(
            f"You are {_identity}; until now you were {before}. Your numbers change with that; "
            "what you have solved before stays written down."
        )
    else:
        print(f"You are {_identity}. The numbers below are yours." if _identity else FORGOTTEN)
    with suppress(OSError):  # a folder that cannot be written to: each notebook asks anew
        if _identity:
            KEPT.parent.mkdir(exist_ok=True)
            KEPT.write_text(_identity, "utf8")


def identity() -> str:
    """Who works here, or an empty text: what a student calls asks for it, and hands it on."""
    global _identity
    if _identity is None:
        _identity = _kept()
    return _identity


def _kept() -> str:
    with suppress(OSError, UnicodeError):
        return plain_identity(KEPT.read_text("utf8"))
    return ""


def plain_identity(identity: str) -> str:
    """An identity as it is compared: however its letters are stored, and without
    invisible characters, capitals and spaces around it.

    >>> plain_identity("Zoe\u0308\u200b") == plain_identity(" ZO\u00cb")
    True
    """
    shown = "".join(
        letter
        for letter in unicodedata.normalize("NFKC", str(identity))
        if unicodedata.category(letter) != "Cf"
    )
    return " ".join(shown.split()).casefold()
