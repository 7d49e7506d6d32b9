"""What this book's exercises bring to coursework: kinds of questions about
orientation, and the sealed questions.
"""

from .kinds import KINDS
from .mistakes import DEEDS

#: What the notebooks import.
PACKAGES = ("orientation", "orientation_figures", "orientation_recordings")

#: How many answers a question of a kind allows, where they are few.
CLOSED = {"sequence": 12}

__all__ = ["CLOSED", "DEEDS", "KINDS", "PACKAGES"]
