"""Who works in this notebook: said once, kept beside the notebooks, and known
to page, notebook and grader alike.

With it each student gets numbers of their own. Who forgets it works on those that everybody sees,
and would learn from the grader that they earn nothing: so it is said beside every such question,
and in each reply to one.
"""

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
    _identity = plain_identity(identity)
    try:
        if _identity:
            KEPT.parent.mkdir(exist_ok=True)
            KEPT.write_text(_identity, "utf8")
        elif KEPT.is_file():
            _identity = plain_identity(KEPT.read_text("utf8"))
            if _identity:
                print(f"The numbers below are those of {_identity}, as you have said before.")
    except (OSError, UnicodeError):
        pass  # a folder that cannot be written to: then it is said anew in each notebook
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
    """An identity as it is compared: without spaces around it and without capitals."""
    return " ".join(str(identity).split()).casefold()


def forgotten(student: str, question: Question) -> str:
    """What is said beside a question with other numbers for each student,
    while nobody has said who works here.
    """
    return FORGOTTEN if question.variants > 1 and not student else ""
