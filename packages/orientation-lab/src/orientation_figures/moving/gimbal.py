"""A camera gimbal with its three joints, for any of the twelve sequences, gimbal lock included."""

import math

import traitlets

from orientation.direction_cosines import check_dcm
from orientation.euler_angles import body_fixed_from_dcm, dcm_from_body_fixed, lock_margin_formula
from orientation.numbers_and_symbols import NUMBERS

from .figure import MovingFigure
from .state import Numbers, Sequence


class GimbalFigure(MovingFigure):
    r"""A camera gimbal: handgrip $A$, two arms $B$ and $C$, camera $D$.

    Each joint rotates what it carries about one axis, in the order of the sequence, so that the
    angles are body fixed Euler angles. Near gimbal lock the figure says which two sliders rotate
    about the same line.

    Attributes
    ----------
    angles : tuple of three floats
        $(\psi, \theta, \varphi)$ in radians, each from $-\pi$ to $\pi$.
    sequence : str
        One of the twelve sequences.
    more : bool
        Whether to show gimbal lock and the choice of the sequence.
    dcm : array_like, shape (3, 3)
        The matrix of the camera; setting it sets the angles for the current sequence.

    Raises
    ------
    ValueError
        If you set a matrix that is not a direction cosine matrix.

    Examples
    --------
    >>> from orientation_figures.moving import GimbalFigure
    >>> figure = GimbalFigure(angles=(0.1, 0.2, 0.3), sequence='zxy')
    >>> round(figure.margin, 6), figure.dcm[1, 2].round(6).item()
    (1.370796, 0.198669)
    """

    kind = "gimbal"
    sheet = (-180, -185, 200, 185)
    angles = Numbers(tuple(map(math.radians, (15, -25, -30))), (3,), math.pi).tag(
        sync=True, state=True
    )
    sequence = Sequence("zxy").tag(sync=True, state=True)
    more = traitlets.Bool(True).tag(sync=True, constant=True)

    @property
    def room(self):
        """Height of the figure in pixels with its controls beside and below it."""
        return (655, 772) if self.more else (655, 690)

    @property
    def dcm(self):
        r"""${}^D\mathbf{C}^A$, shape ``(3, 3)``."""
        return dcm_from_body_fixed(self.angles, self.sequence)

    @dcm.setter
    def dcm(self, dcm):
        check_dcm(dcm)
        self.angles = body_fixed_from_dcm(dcm, self.sequence)

    @property
    def margin(self):
        """Distance of the gimbal from lock, in radians."""
        return lock_margin_formula(self.sequence)(NUMBERS, *self.angles)[0]
