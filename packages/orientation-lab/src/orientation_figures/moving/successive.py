"""A chain of simple rotations, frame by frame, with the product of their matrices."""

import math

import traitlets

from orientation.axis_angle import axis_angle_from_dcm

from .figure import MovingFigure
from .pictures.common import chain
from .pictures.successive import COMPARISONS, second_chain
from .state import Numbers, Turns


class SuccessiveFigure(MovingFigure):
    r"""A chain of up to four simple rotations from $N$ to $D$.

    Beside the frames are the matrices of the rotations and their product. With body fixed rotations
    the newest is on the left,

    $$
    {}^D\mathbf{C}^N = {}^D\mathbf{C}^C\,{}^C\mathbf{C}^B\,{}^B\mathbf{C}^A\,{}^A\mathbf{C}^N ,
    $$

    and with rotations about the axes of $N$ it is on the right. A second chain can be drawn beside
    the first, with two neighbouring rotations exchanged or of the other kind; its end is the frame
    $E$.

    Attributes
    ----------
    turns : tuple of pairs
        One to four rotations, each an axis 'x', 'y' or 'z' and an angle in radians, from $-\pi$ to
        $\pi$.
    fixed : {'body', 'space'}
        Whether each rotation is about a unit vector of the frame before it, or about one of $N$.
    compare : str
        The second chain, one of `COMPARISONS`.
    more : bool
        Whether to offer rotations about the axes of $N$ and the other second chains.
    share : float
        The completed share of the chain, from 0 to 1.

    Examples
    --------
    >>> from orientation_figures.moving import SuccessiveFigure
    >>> figure = SuccessiveFigure(turns=[('z', 1.2), ('x', 0.4)], compare='1 and 2 exchanged')
    >>> figure.dcm.shape, round(figure.angle_between, 6)
    ((3, 3), 0.449655)
    """

    kind = "successive"
    sheet = (-180, -142, 180, 222)
    turns = Turns((("z", math.radians(30)), ("x", math.radians(50)), ("y", math.radians(40)))).tag(
        sync=True, state=True
    )
    fixed = traitlets.Enum(("body", "space"), "body").tag(sync=True, state=True)
    compare = traitlets.Enum(COMPARISONS, "nothing").tag(sync=True, state=True)
    share = Numbers(1.0, largest=1.0).tag(sync=True, state=True)
    more = traitlets.Bool(True).tag(sync=True, constant=True)

    @property
    def room(self):
        """Height of the figure in pixels with its controls beside and below it."""
        return (685, 1001) if self.more else (605, 845)

    @traitlets.validate("share")
    def _not_negative(self, proposal):
        if proposal["value"] < 0:
            raise traitlets.TraitError(
                f"share is {proposal['value']!r}: expected a number from 0 to 1"
            )
        return proposal["value"]

    @traitlets.validate("turns", "compare")
    def _has_both_turns(self, proposal):
        turns, compare = (
            proposal["value"] if proposal["trait"].name == name else getattr(self, name)
            for name in ("turns", "compare")
        )
        if 1 <= COMPARISONS.index(compare) <= 3 and len(turns) <= COMPARISONS.index(compare):
            raise traitlets.TraitError(
                f"compare is {compare!r}, but the chain has only {len(turns)} "
                f"turn{'s' * (len(turns) > 1)}"
            )
        return proposal["value"]

    @property
    def dcms(self):
        """Matrices of N and of all further frames with respect to N, shape ``(n + 1, 3, 3)``."""
        # Import it only here, because the figure itself does not need it.
        import numpy as np

        return np.array(chain(self.turns, self.fixed))

    @property
    def dcm(self):
        """Direction cosine matrix of the end of the chain with respect to N, shape ``(3, 3)``."""
        return chain(self.turns, self.fixed)[-1]

    @property
    def other(self):
        """Direction cosine matrix of E with respect to N, or None if there is no second chain."""
        return (
            None
            if self.compare == "nothing"
            else chain(*second_chain(self.turns, self.fixed, self.compare))[-1]
        )

    @property
    def angle_between(self):
        """Angle from the end of the chain to E in radians, or None if there is no second chain."""
        return (
            None if self.other is None else float(axis_angle_from_dcm(self.other @ self.dcm.T)[1])
        )
