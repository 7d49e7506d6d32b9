"""Nine numbers that should be a direction cosine matrix: what fails, and the nearest matrix that is one."""
import numpy as np

from ..direction_cosines import nearest_dcm
from ..drawing import Drawing, view_from
from .figure import MovingFigure
from .state import Numbers

REACH, SIZE = 1.25, 104


class NineNumbersFigure(MovingFigure):
    kind = 'nine_numbers'
    sheet = (-180, -165, 180, 165)
    matrix = Numbers(((0.83, 0.57, -0.06), (-0.49, 0.71, 0.62), (0.31, -0.5, 0.74)), (3, 3), 10).tag(sync=True, state=True)

    def drawing(self):
        return Drawing('Nine numbers Nine numbers Nine numbers Nine numbers Nine numbers', view_from(np.radians(40), np.radians(24)), SIZE).triad('N', np.eye(3))
