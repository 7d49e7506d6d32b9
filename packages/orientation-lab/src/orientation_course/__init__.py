"""What this book's exercises bring to coursework: kinds of questions about
orientation, and the sealed questions.
"""

from .kinds import KINDS
from .mistakes import DEEDS

#: What the notebooks import.
PACKAGES = ("orientation", "orientation_figures", "orientation_recordings")

#: Number of possible answers for each kind of question that has only a few.
CLOSED = {"sequence": 12}

__all__ = ["CLOSED", "DEEDS", "KINDS", "PACKAGES"]
