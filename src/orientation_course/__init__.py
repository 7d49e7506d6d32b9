"""What this book's exercises bring to coursework: kinds of questions about orientation, and the sealed questions."""

from .kinds import KINDS
from .mistakes import DEEDS

#: What the notebooks import.
PACKAGES = ("orientation", "orientation_figures", "orientation_recordings")

__all__ = ["DEEDS", "KINDS", "PACKAGES"]
