"""A bench for any recording of an instrument that turns.

`examine` takes a file as it came, finds out what is in it, in which units, axes and conventions,
how wrong its instruments are, and whether a filter that uses them tells the truth about itself.
Each answer is a `examined.Verdict` with its evidence; ``print`` shows them all.
"""

from .bench import examine
from .examined import Examined, Verdict
from .table import RecordingError

__all__ = ["Examined", "RecordingError", "Verdict", "examine"]
