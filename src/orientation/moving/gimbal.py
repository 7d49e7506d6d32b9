"""A camera gimbal with its three joints, for any of the twelve sequences, gimbal lock included."""
import math

import numpy as np

from ..direction_cosines import simple_dcm
from ..drawing import Drawing, view_from
from ..euler_angles import dcm_from_body_fixed, gimbal_lock_margin
from .figure import MovingFigure
from .state import Numbers, Sequence


class GimbalFigure(MovingFigure):
    kind = 'gimbal'
    sheet = (-180, -185, 200, 185)
    angles = Numbers(np.radians((-12, 30, 40)), (3,), math.pi).tag(sync=True, state=True)
    sequence = Sequence('zxy').tag(sync=True, state=True)

    def drawing(self):
        return Drawing('A camera gimbal a b c d e f g h i j k l m n o p q r s t.', view_from(np.radians(58), np.radians(22)), 98).triad('N', np.eye(3))
