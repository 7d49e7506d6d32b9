"""A triad turned in a frame about an axis, with every description of its orientation beside it."""
import math

import numpy as np

from ..axis_angle import dcm_from_axis_angle, quaternion_from_axis_angle
from ..drawing import Drawing
from ..euler_angles import body_fixed_from_dcm
from .figure import MovingFigure
from .state import Direction, Numbers, Sequence

REACH, KNOB = 1.25, 1.55   # of the arrows of N and of the line of the axis: labels keep clear of those of A
SIZE = 112


class TriadFigure(MovingFigure):
    r"""A triad :math:`A`, turned in :math:`N` through an angle about an axis.

    Beside the drawing stand :math:`{}^A\mathbf{C}^N`, Euler angles, axis and angle, and the quaternion of
    the same orientation. A number that is touched lights up what it means.

    Attributes
    ----------
    axis : tuple of three floats
        Direction of the axis, the same along :math:`N` and :math:`A`. Any vector but zero may be given; it
        is kept at unit length.
    angle : float
        Radians, from :math:`-\pi` to :math:`\pi`.
    sequence : str
        Which of the twelve sequences the Euler angles belong to.

    Examples
    --------
    >>> from orientation.moving import TriadFigure
    >>> figure = TriadFigure(axis=(0, 0, 2), angle=0.3, sequence='zxy')
    >>> figure.angle = 0.5
    >>> figure.axis, figure.dcm[0, 1].round(6).item()
    ((0.0, 0.0, 1.0), 0.479426)
    """

    kind = 'triad'
    sheet = (-180, -172, 180, 172)
    room = (512, 884)
    axis = Direction((1, 2, 2)).tag(sync=True, state=True)
    angle = Numbers(math.radians(50), largest=math.pi).tag(sync=True, state=True)
    sequence = Sequence('zxy').tag(sync=True, state=True)

    @property
    def dcm(self):
        r""":math:`{}^A\mathbf{C}^N`, shape ``(3, 3)``."""
        return dcm_from_axis_angle(self.axis, self.angle)

    @property
    def quaternion(self):
        """Unit quaternion of half the angle, scalar first, shape ``(4,)``."""
        return quaternion_from_axis_angle(self.axis, self.angle)

    @property
    def angles(self):
        """Body fixed angles ``(psi, theta, phi)`` for ``sequence``, in radians."""
        return body_fixed_from_dcm(self.dcm, self.sequence)

    def drawing(self):
        rows = [f'{name} at ({", ".join(f"{entry:.2f}" for entry in row)})' for name, row in zip('xyz', self.dcm)]
        axis = np.array(self.axis)
        drawing = Drawing(
            f'The triad of frame N, and from the same origin the triad of A: turned from N through theta, '
            f'{math.degrees(self.angle):.0f} degrees, about the unit vector e, which has the components '
            f'({", ".join(f"{entry:.2f}" for entry in axis)}) in both frames. Along N, a '
            f'{", a ".join(rows)}. Thin arcs show the way of each tip, all about e.', scale=SIZE)
        drawing.line([-axis, KNOB * axis], 'accent', 'guide')
        for start in np.eye(3):
            foot = start @ axis * axis
            if (radius := np.linalg.norm(start - foot)) > 1e-6:
                drawing.turn(axis, self.angle, start - foot, radius, origin=foot, colour='muted', head=False)
        drawing.triad('N', REACH * np.eye(3)).triad('A', self.dcm)
        drawing.arrow(axis, colour='accent').dot(KNOB * axis, 'accent', 5)
        return drawing.label(KNOB * axis, r'$\hat{e}$', 'accent', (15, -9))
