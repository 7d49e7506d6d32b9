"""Exercises that check themselves and hold no answers, and the tools that make and grade them.

A student needs ``from coursework import check`` and no more.
"""

from .checking.check import check, hint, progress, worked_solution
from .checking.variants import me, variant

__version__ = "1.2.0"

__all__ = ["check", "hint", "me", "progress", "variant", "worked_solution"]
