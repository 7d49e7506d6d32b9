"""Challenges: match a matrix, undo a rotation, find the sequence of a ghost."""

import math

import traitlets

from orientation.axis_angle import axis_angle_from_dcm
from orientation.direction_cosines import check_dcm
from orientation.euler_angles import body_fixed_from_dcm

from .figure import MovingFigure
from .pictures.common import chain
from .state import Turns


class ChallengeFigure(MovingFigure):
    r"""A box with the frame $A$, which the reader rotates about its own axes to a goal.

    In the task 'match' the goal is an orientation shown only by its matrix. In 'undo' the box has
    been rotated, and the goal is where it came from, $N$. In 'ghost' a ghost has made three
    rotations through known angles about unknown axes. The remaining angle shows how close the
    reader is.

    Attributes
    ----------
    task : {'match', 'undo', 'ghost'}
    given : tuple of one to three pairs
        The rotations of the challenge, each an axis 'x', 'y' or 'z' and an angle in radians: those
        to the goal in 'match' and 'ghost', and those to undo in 'undo'.
    turns : tuple of at most 20 pairs
        The reader's own rotations, each about a unit vector of the box (body fixed).
    goal : array_like, shape (3, 3)
        Direction cosine matrix of the goal with respect to N. In 'match' it can be set, which sets
        ``given`` to three rotations that lead there.

    Raises
    ------
    ValueError
        If you set a goal that is not a direction cosine matrix, or the task is not 'match'.

    Examples
    --------
    >>> from orientation_figures.moving import ChallengeFigure
    >>> figure = ChallengeFigure(task='undo', given=[('z', 0.5), ('x', 0.3)], turns=[('x', -0.3)])
    >>> round(figure.remaining, 6)
    0.5

    Use your own matrix as the goal:

    >>> figure = ChallengeFigure(goal=[[0, 1, 0], [0, 0, 1], [1, 0, 0]])
    >>> round(figure.remaining, 6)
    2.094395
    """

    kind = "challenge"
    sheet = (-180, -172, 180, 172)
    room = (610, 888)
    task = traitlets.Enum(("match", "undo", "ghost"), "match").tag(sync=True, state=True)
    given = Turns((("z", math.pi / 2), ("x", math.pi / 3)), most=3).tag(sync=True, state=True)
    turns = Turns((), fewest=0, most=20).tag(sync=True, state=True)

    @property
    def dcm(self):
        r"""${}^A\mathbf{C}^N$ of the box in its current state, shape ``(3, 3)``."""
        return chain((*self.given, *self.turns) if self.task == "undo" else self.turns, "body")[-1]

    @property
    def goal(self):
        """Direction cosine matrix of the goal with respect to N, shape ``(3, 3)``."""
        return chain(() if self.task == "undo" else self.given, "body")[-1]

    @goal.setter
    def goal(self, dcm):
        if self.task != "match":
            raise ValueError(
                f"the goal of the task {self.task!r} follows from `given`; only in the task "
                "'match' can you set it"
            )
        check_dcm(dcm)
        self.given = tuple(zip("zxy", body_fixed_from_dcm(dcm, "zxy")))

    @property
    def remaining(self):
        """Angle of the rotation from the box to its goal, in radians."""
        return float(axis_angle_from_dcm(self.goal @ self.dcm.T)[1])
