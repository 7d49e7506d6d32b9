"""A bench for recordings of any instrument that rotates.

`examine` takes a file as it is and finds out what it contains, with which units, axes and
conventions, how large the errors of its instruments are, and whether a filter that uses them is
right about its own accuracy. Each answer is an `examined.Verdict` with its evidence; ``print``
shows them all.
"""

from .bench import examine
from .examined import Examined, Verdict
from .table import RecordingError

__all__ = ["Examined", "RecordingError", "Verdict", "examine"]
