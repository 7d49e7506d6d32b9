"""Nine numbers that should be a direction cosine matrix: what fails, and the nearest matrix that is one."""
import numpy as np

from ..direction_cosines import check_dcm, nearest_dcm
from ..drawing import Drawing, view_from
from .figure import MovingFigure
from .state import Numbers

REACH, SIZE = 1.2, 116   # as in js/nine_numbers.js
VIEW = view_from(np.radians(40), np.radians(24))


class NineNumbersFigure(MovingFigure):
    r"""Nine numbers, seen as three row vectors, against the nearest direction cosine matrix.

    The reader edits the numbers or drags the arrows. The figure says which of the conditions fails, rows of
    unit length, right angles, right-handed, in the words of :func:`orientation.check_dcm`.

    Attributes
    ----------
    matrix : three tuples of three floats
        Any numbers from -10 to 10; that they are no direction cosine matrix is what the figure is about.

    Examples
    --------
    >>> from orientation.moving import NineNumbersFigure
    >>> figure = NineNumbersFigure(matrix=[[0.8, 0.6, 0], [-0.6, 0.8, 0], [0, 0, 1.01]])
    >>> figure.check()
    'dcm is not orthogonal: row z has length 1.01, not 1. Were its entries rounded or measured? nearest_dcm finds the nearest valid matrix'
    >>> figure.nearest.distance.round(6).item()
    0.01
    """

    kind = 'nine_numbers'
    sheet = (-180, -165, 180, 165)
    room = (524, 941)
    matrix = Numbers(((0.98, 0.43, -0.2), (-0.31, 0.8, 0.7), (0.08, -0.4, 0.74)), (3, 3), 10).tag(sync=True, state=True)

    @property
    def nearest(self):
        """The nearest direction cosine matrix and its distance, as ``nearest_dcm`` returns them."""
        return nearest_dcm(self.matrix)

    def check(self):
        """Return what ``check_dcm`` says of the matrix, or nothing if it is valid."""
        try:
            check_dcm(self.matrix)
        except ValueError as error:
            return str(error)
        return ''

    def drawing(self):
        rows = np.array(self.matrix)
        try:
            nearest = self.nearest.dcm
        except ValueError:   # several are equally near
            nearest = np.empty((0, 3))
        said = ', '.join(f'a {name} at ({", ".join(f"{entry:.2f}" for entry in row)})' for name, row in zip('xyz', rows))
        drawing = Drawing(
            f'In the frame N three arrows that should be the unit vectors of a triad A: {said}. '
            f'{self.check() or "They are a direction cosine matrix"}. '
            + ('Dotted arrows show the nearest triad.' if len(nearest) else 'Several triads are equally near.'), VIEW, SIZE)
        drawing.triad('N', REACH * np.eye(3))
        for row, measured in zip(nearest, rows):
            drawing.arrow(row, colour='D').line([row, measured], 'D', 'guide')
        lengths = np.linalg.norm(rows, axis=1)
        for name, row, length in zip('xyz', rows, lengths):
            tip = drawing.on_sheet(row)
            outward = tip / (np.linalg.norm(tip) or 1)
            beyond = drawing.on_sheet(row / length) if 0 < length < 1 else tip
            drawing.arrow(row, colour='A', label=rf'$\hat{{a}}_{name}$', shift=beyond - tip + 17 * outward)
        for i, j in ((0, 1), (1, 2), (2, 0)):
            u, v = 0.2 * rows[i] / (lengths[i] or 1), 0.2 * rows[j] / (lengths[j] or 1)
            fails = abs(rows[i] @ rows[j]) > 1e-9
            drawing.line([u, u + v, v], 'B' if fails else 'muted', 'thick' if fails else '')
        return drawing
