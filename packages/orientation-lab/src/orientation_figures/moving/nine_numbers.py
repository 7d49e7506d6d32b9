"""Nine numbers that should be a direction cosine matrix, and the nearest valid matrix."""

from orientation.direction_cosines import check_dcm, nearest_dcm

from .figure import MovingFigure
from .state import Numbers


class NineNumbersFigure(MovingFigure):
    r"""Nine numbers, seen as three row vectors, against the nearest direction cosine matrix.

    The reader edits the numbers or drags the arrows. The figure says which of the conditions fails
    (unit rows, right angles, right-handed), in the words of `orientation.check_dcm`.

    Attributes
    ----------
    matrix : three tuples of three floats
        Any numbers from -10 to 10; they need not form a direction cosine matrix.

    Examples
    --------
    >>> from orientation_figures.moving import NineNumbersFigure
    >>> figure = NineNumbersFigure(matrix=[[0.8, 0.6, 0], [-0.6, 0.8, 0], [0, 0, 1.01]])
    >>> print(figure.check().partition('? ')[0])
    dcm is not orthogonal: row z has length 1.01, not 1. Were its entries rounded or measured
    >>> figure.nearest.distance.round(6).item()
    0.01
    """

    kind = "nine_numbers"
    sheet = (-180, -165, 180, 165)
    room = (524, 941)
    matrix = Numbers(((0.98, 0.43, -0.2), (-0.31, 0.8, 0.7), (0.08, -0.4, 0.74)), (3, 3), 10).tag(
        sync=True, state=True
    )

    @property
    def nearest(self):
        """The nearest direction cosine matrix and its distance, as ``nearest_dcm`` returns them."""
        return nearest_dcm(self.matrix)

    def check(self):
        """Return the message of ``check_dcm`` on the matrix, or nothing if it is valid."""
        try:
            check_dcm(self.matrix)
        except ValueError as error:
            return str(error)
        return ""
