"""Who works in this notebook: said once, kept beside the notebooks, and known
to page, notebook and grader alike.

With it each student gets numbers of their own. Who forgets it works on those that everybody sees,
and would learn from the grader that they earn nothing: so it is said beside every such question,
and in each reply to one.
"""

import unicodedata
from contextlib import suppress
from pathlib import Path

from .progress import Progress
from .question import Question

#: Where it is kept who works in this folder; the pages of a book keep it under the same name.
KEPT = Path(".coursework", "me.txt")
#: What is said where nobody has said who works here.
FORGOTTEN = (
    "These are the numbers that everybody sees. "
    "In a course they earn no points: there, first say who you are, by `student('...')` in the "
    "first cell of code, and run it."
)
_identity = ""


def student(identity: str = "") -> None:
    """Say who you are, so that you get your own numbers: ``student('ada@uni.example')``.

    Once is enough: it is kept beside your notebooks (in JupyterLite, in the browser), and
    ``student('')`` in another one finds it there, and says so. Without it you get the numbers that
    everybody sees; who hands in answers to another one's numbers gets no points for them.

    Parameters
    ----------
    identity : str
        As your instructor's roster has it; capitals and spaces around it make no difference.
    """
    global _identity
    _identity, before = plain_identity(identity), ""
    with suppress(OSError, UnicodeError):
        before = plain_identity(KEPT.read_text("utf8"))
    if not _identity and before:
        _identity = before
        print(f"The numbers below are those of {_identity}, as you have said before.")
    elif before not in ("", _identity):
        print(f"You are {_identity}; until now you were {before}. Your numbers change with that.")
    with suppress(OSError):  # a folder that cannot be written to: each notebook asks anew
        if _identity:
            KEPT.parent.mkdir(exist_ok=True)
            KEPT.write_text(_identity, "utf8")
    for whose, names in (Progress.read().right_for_others(_identity) if _identity else {}).items():
        print(
            f"With {f'the numbers of {whose}' if whose else 'the numbers that everybody sees'} you "
            f"have solved {', '.join(names)}. "
            f"That stays written down; for the numbers of {_identity}, run the cells again."
        )


def identity() -> str:
    """Who works here, or an empty text: what a student calls asks for it, and hands it on."""
    return _identity


def plain_identity(identity: str) -> str:
    """An identity as it is compared: however its letters are stored, and without
    invisible characters, capitals and spaces around it.

    >>> plain_identity("Zoe\u0308\u200b") == plain_identity(" ZO\u00cb")
    True
    """
    letters = unicodedata.normalize("NFKC", str(identity))
    shown = "".join(letter for letter in letters if unicodedata.category(letter) != "Cf")
    return " ".join(shown.split()).casefold()


def forgotten(student: str, question: Question) -> str:
    """What is said beside a question with other numbers for each student,
    while nobody has said who works here.
    """
    return FORGOTTEN if question.variants > 1 and not student else ""
