"""Self-checking exercises that contain no answers, and the tools that make and grade them.

Students need only ``from coursework import check``.
"""

from .checking.check import check, hint, progress, worked_solution
from .checking.identity import student
from .checking.questions import variant

__version__ = "1.0.0"

__all__ = ["check", "hint", "progress", "student", "variant", "worked_solution"]
