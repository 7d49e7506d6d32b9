"""A simple orientation: one rotation about a unit vector that two frames share."""

import math

import traitlets

from orientation.direction_cosines import simple_dcm

from .figure import MovingFigure
from .state import Numbers


class SimpleFigure(MovingFigure):
    r"""A frame $A$, rotated in $N$ about $x$, $y$ or $z$.

    Three views move together: the triads in space, the same seen down the shared unit vector, and
    ${}^A\mathbf{C}^N$. Touching a number highlights the projection that it measures.

    Attributes
    ----------
    axis : str
        ``'x'``, ``'y'`` or ``'z'``: the unit vector that the frames share.
    angle : float
        Radians, from $-\pi$ to $\pi$.

    Examples
    --------
    >>> from orientation_figures.moving import SimpleFigure
    >>> figure = SimpleFigure(axis='z', angle=0.3)
    >>> figure.angle = 0.5
    >>> figure.dcm[0, 1].round(6).item()
    0.479426
    """

    kind = "simple"
    sheet = (-180, -172, 180, 172)
    room = (570, 926)
    axis = traitlets.Enum(("x", "y", "z"), "z").tag(sync=True, state=True)
    angle = Numbers(math.radians(35), largest=math.pi).tag(sync=True, state=True)

    @property
    def dcm(self):
        r"""${}^A\mathbf{C}^N$, shape ``(3, 3)``."""
        return simple_dcm(self.axis, self.angle)
