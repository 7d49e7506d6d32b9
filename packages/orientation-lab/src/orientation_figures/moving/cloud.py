"""A cloud of orientations: errors that are Gaussian as rotation vectors."""

import math

import traitlets

from .figure import MovingFigure
from .state import Numbers


class CloudFigure(MovingFigure):
    r"""Orientations about an estimate, with Gaussian errors along the ground or along the body.

    The tips of $\hat{b}_x$ and $\hat{b}_z$ of each are drawn. The axis with the large errors is
    fixed to the ground or to the body.

    Attributes
    ----------
    large : float
        Standard deviation about z in radians, up to a third of a turn.
    small : float
        Standard deviation about x and about y in radians.
    side : str
        The frame in which the errors have these deviations, 'ground' or 'body'.

    Examples
    --------
    >>> from orientation_figures.moving import CloudFigure
    >>> figure = CloudFigure(large=1.0)
    >>> figure.mean_length < 0.8
    True
    """

    kind = "cloud"
    sheet = (-180, -160, 180, 160)
    room = (445, 530)
    large = Numbers(math.radians(30), largest=math.radians(120), smallest=0).tag(
        sync=True, state=True
    )
    small = Numbers(math.radians(3), largest=math.radians(120), smallest=0).tag(
        sync=True, state=True
    )
    side = traitlets.Enum(("ground", "body"), "ground").tag(sync=True, state=True)

    @property
    def mean_length(self):
        """Length of the mean of the tips of b_x: 1 if they coincide."""
        from ..vectors import length
        from .pictures.cloud import orientations, tips_mean

        return length(tips_mean(orientations(self.large, self.small, self.side == "body"), 0))
