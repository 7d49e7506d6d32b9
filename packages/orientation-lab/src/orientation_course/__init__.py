"""What this book adds to coursework: kinds of questions, and the sealed questions."""

from .kinds import KINDS
from .mistakes import DEEDS

#: The packages that the notebooks import.
PACKAGES = ("orientation", "orientation_figures", "orientation_recordings")

#: Number of possible answers for each kind of question that has only a few.
CLOSED = {"sequence": 12}

__all__ = ["CLOSED", "DEEDS", "KINDS", "PACKAGES"]
