"""What this book's exercises bring to coursework: kinds of questions about
orientation, and the sealed questions.
"""

from .kinds import KINDS
from .mistakes import DEEDS

#: What the notebooks import.
PACKAGES = ("orientation", "orientation_figures", "orientation_recordings")

#: What the public functions of the module are told in words, by the name of the argument.
WORDS = {
    "sequence": "zxy zyx xyz zxz zyz xzy yxz yzx xyx xzx yxy yzy".split(),
    "axis": ["x", "y", "z"],
}
#: How many numbers an answer of each kind is compared by.
SIZES = {"direction cosine matrix": 9, "quaternion": 4, "Euler angles": 9, "axis and angle": 9}

__all__ = ["DEEDS", "KINDS", "PACKAGES", "SIZES", "WORDS"]
