"""The belt trick: one full rotation leaves a twist in the belt, two leave none."""

import math

from orientation.quaternions import dcm_from_quaternion

from .figure import MovingFigure
from .pictures.belt import quaternion_at
from .state import Numbers

FULL = 4 * math.pi


class BeltFigure(MovingFigure):
    r"""A plate that hangs on a wall by a belt, and rotates about the belt's own line.

    Along the belt the orientation goes from that of the wall to that of the plate, as a curve of
    quaternions from 1 to $q$. After one full rotation it ends at $-1$, after two at 1. Then the
    belt can be passed round the plate while the plate is held. After two full rotations this
    removes the twist; after one it only reverses it.

    Attributes
    ----------
    angle : float
        The plate's angle of rotation, in radians from 0 to $4\pi$.
    passed : float
        How far the belt has been passed round the plate, from 0 to 1. It counts only after one or
        two full rotations.

    Examples
    --------
    >>> from math import pi
    >>> from orientation_figures.moving import BeltFigure
    >>> BeltFigure(angle=4*pi, passed=1).quaternion_at(0.3)
    (1.0, 0.0, 0.0, 0.0)
    """

    kind = "belt"
    sheet = (-180, -125, 180, 130)
    room = (500, 620)
    angle = Numbers(2 * math.pi, largest=FULL, smallest=0).tag(sync=True, state=True)
    passed = Numbers(0.0, largest=1.0, smallest=0).tag(sync=True, state=True)

    @property
    def dcm(self):
        """Direction cosine matrix of the plate with respect to the wall, shape ``(3, 3)``."""
        return dcm_from_quaternion(self.quaternion_at(1))

    def quaternion_at(self, share):
        """Return the unit quaternion of the belt at a share of its length, four floats.

        The belt lies along y.
        """
        return tuple(
            round(entry, 15) + 0.0 for entry in quaternion_at(self.angle, self.passed, share)
        )
