"""The reader's own phone: its sensors as a browser reports them, or else a recording."""

import math

from orientation.euler_angles import dcm_from_body_fixed
from orientation.quaternions import quaternion_from_dcm

from .figure import MovingFigure
from .state import Numbers


class PhoneFigure(MovingFigure):
    r"""A phone $B$, and the ground $N$ with axes to the east, the north and upwards.

    On a phone, at the press of a button, the figure asks for access to its sensors and follows
    them; nothing is sent anywhere. The angles are those that browsers report: body fixed z-x-y,
    from the ground to the phone, whose $\hat{b}_x$ points to the right across the screen,
    $\hat{b}_y$ to its top and $\hat{b}_z$ out of it.

    Attributes
    ----------
    angles : tuple of three floats
        $(\alpha, \beta, \gamma)$ in radians, each from $-\pi$ to $\pi$.

    Examples
    --------
    >>> from orientation_figures.moving import PhoneFigure
    >>> figure = PhoneFigure(angles=(0.1, 0.2, 0.3))
    >>> figure.dcm[1, 2].round(6).item()
    0.198669

    Notes
    -----
    Source: *Device Orientation and Motion*, World Wide Web Consortium.
    """

    kind = "phone"
    sheet = (-180, -172, 180, 172)
    room = (640, 1010)
    angles = Numbers(tuple(map(math.radians, (100, 50, -10))), (3,), math.pi).tag(
        sync=True, state=True
    )

    @property
    def dcm(self):
        r"""${}^B\mathbf{C}^N$, shape ``(3, 3)``."""
        return dcm_from_body_fixed(self.angles, "zxy")

    @property
    def quaternion(self):
        """Unit quaternion of the phone with respect to the ground, scalar first, shape ``(4,)``."""
        return quaternion_from_dcm(self.dcm)
