"""A triad rotated in a frame about an axis, with every description of its orientation beside it."""

import math

import traitlets

from orientation.axis_angle import (
    axis_angle_from_dcm,
    dcm_from_axis_angle,
    quaternion_from_axis_angle,
)
from orientation.direction_cosines import check_dcm
from orientation.euler_angles import body_fixed_from_dcm
from orientation.quaternions import dcm_from_quaternion

from .figure import MovingFigure
from .state import Direction, Numbers, Sequence


class TriadFigure(MovingFigure):
    r"""A triad $A$, rotated in $N$ through an angle about an axis.

    Beside the drawing are ${}^A\mathbf{C}^N$, Euler angles, axis and angle, and the quaternion of
    the same orientation. Touching a number highlights its meaning.

    Attributes
    ----------
    axis : tuple of three floats
        Direction of the axis, the same along $N$ and $A$. Any vector but zero may be given; it is
        kept at unit length.
    angle : float
        Radians, from $-\pi$ to $\pi$.
    sequence : str
        The sequence of the Euler angles, one of the twelve.
    more : bool
        Whether to show the descriptions other than the matrix.
    dcm, quaternion
        The same orientation in other descriptions; setting one sets ``axis`` and ``angle``.

    Raises
    ------
    ValueError
        If you set a matrix that is not a direction cosine matrix, or a quaternion not of unit
        length.

    Examples
    --------
    >>> from orientation_figures.moving import TriadFigure
    >>> figure = TriadFigure(axis=(0, 0, 2), angle=0.3, sequence='zxy')
    >>> figure.angle = 0.5
    >>> figure.axis, figure.dcm[0, 1].round(6).item()
    ((0.0, 0.0, 1.0), 0.479426)

    Set your own matrix:

    >>> figure.dcm = [[0, 1, 0], [0, 0, 1], [1, 0, 0]]
    >>> round(figure.angle, 6)
    2.094395
    """

    kind = "triad"
    sheet = (-180, -172, 180, 172)
    axis = Direction((1, 2, 2)).tag(sync=True, state=True)
    angle = Numbers(math.radians(50), largest=math.pi).tag(sync=True, state=True)
    sequence = Sequence("zxy").tag(sync=True, state=True)
    more = traitlets.Bool(True).tag(sync=True, constant=True)

    @property
    def room(self):
        """Height of the figure in pixels with its controls beside and below it."""
        return (512, 884) if self.more else (512, 655)

    @property
    def dcm(self):
        r"""${}^A\mathbf{C}^N$, shape ``(3, 3)``."""
        return dcm_from_axis_angle(self.axis, self.angle)

    @dcm.setter
    def dcm(self, dcm):
        check_dcm(dcm)
        axis, angle = axis_angle_from_dcm(dcm)
        with self.hold_sync():
            self.axis, self.angle = axis, angle

    @property
    def quaternion(self):
        """Unit quaternion of half the angle, scalar first, shape ``(4,)``."""
        return quaternion_from_axis_angle(self.axis, self.angle)

    @quaternion.setter
    def quaternion(self, quaternion):
        self.dcm = dcm_from_quaternion(quaternion)

    @property
    def angles(self):
        """Body fixed angles ``(psi, theta, phi)`` for ``sequence``, in radians."""
        return body_fixed_from_dcm(self.dcm, self.sequence)
