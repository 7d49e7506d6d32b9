"""A tumbling racket, with its orientation integrated as a matrix, a quaternion and Euler angles."""

import traitlets

from .figure import MovingFigure, svg_on
from .pictures import motion as pictures
from .pictures.motion import COLOURS, MOMENTS, SECONDS, body_of
from .state import Numbers

# Left, top, right and bottom.
PLOT = (-180, 0, 180, 356)


class Between(Numbers):
    """A number from ``least`` to ``most``."""

    def __init__(self, default, least, most, unit):
        super().__init__(default)
        self.least, self.most, self.unit = least, most, unit

    def validate(self, obj, value):
        number = super().validate(obj, value)
        if not self.least <= number <= self.most:
            raise traitlets.TraitError(
                f"{self.name} is {value!r}; it must be from {self.least:g} to {self.most:g} "
                f"{self.unit}"
            )
        return number


class Moments(Numbers):
    """Three principal moments of inertia that a body can have, in g m^2."""

    def validate(self, obj, value):
        moments = super().validate(obj, value)
        if not all(0.1 <= moment <= 20 for moment in moments):
            raise traitlets.TraitError(
                f"{self.name} is {value!r}; each must be from 0.1 to 20 g m^2"
            )
        largest = max(moments)
        others = sum(moments) - largest
        if largest > others + 1e-9:
            raise traitlets.TraitError(
                f"{self.name} is {value!r}: no body has such moments of inertia, because the "
                f"largest, {largest:g}, is more than the sum of the others, {others:g}"
            )
        return moments


class MotionFigure(MovingFigure):
    r"""A freely tumbling body, integrated in three descriptions with or without restoring steps.

    The body spins at 4 rad/s about one of its principal axes, slightly disturbed. Its orientation
    is integrated as a direction cosine matrix, as a quaternion and as Euler angles in the sequence
    $z$-$x$-$y$. All three use the same angular velocity, computed in steps ten times finer, so that
    they differ only by their own errors. One of them is drawn, with the reference dashed, which is
    a quaternion integrated in the finer steps. Plots show how the drift grows.

    Attributes
    ----------
    moments : tuple of three floats
        The principal moments of inertia about $\hat{a}_x$, $\hat{a}_y$ and $\hat{a}_z$, from 0.1 to
        20 g m², none larger than the sum of the others. A racket is drawn for its own moments,
        otherwise the uniform block that has them.
    axis : str
        The principal axis of the spin, 'x', 'y' or 'z'.
    disturbance : float
        Angular velocity about the two other axes at the start, 0 to 0.5 rad/s.
    method : str
        'Euler', 'Runge-Kutta' (of fourth order) or 'exponential', which rotates matrix and
        quaternion by the rotation vector of each step (Magnus, of fourth order). Euler angles have
        no such step, and use Runge-Kutta.
    step : float
        From 0.005 to 0.1 seconds.
    restored : bool
        Whether each step ends by replacing the matrix by the nearest orthogonal one, and dividing
        the quaternion by its length.
    description : str
        The description that is drawn: 'matrix', 'quaternion' or 'angles'.
    time : float
        From 0 to 20 seconds. The figure computes up to this time, and further as it plays.

    Examples
    --------
    >>> from orientation_figures.moving import MotionFigure
    >>> figure = MotionFigure(method='Runge-Kutta', step=0.02, time=3)
    >>> figure.flips
    0
    >>> figure.time = 4
    >>> figure.flips
    1
    """

    kind = "motion"
    sheet = (-180, -150, 180, 150)
    room = (704, 1319)
    moments = Moments(MOMENTS["racket"], (3,)).tag(sync=True, state=True)
    axis = traitlets.Enum(tuple("xyz"), "y").tag(sync=True, state=True)
    disturbance = Between(0.01, 0, 0.5, "rad/s").tag(sync=True, state=True)
    method = traitlets.Enum(("Euler", "Runge-Kutta", "exponential"), "Euler").tag(
        sync=True, state=True
    )
    step = Between(0.01, 0.005, 0.1, "seconds").tag(sync=True, state=True)
    restored = traitlets.Bool(False).tag(sync=True, state=True)
    description = traitlets.Enum(tuple(COLOURS), "matrix").tag(sync=True, state=True)
    time = Between(6.0, 0, SECONDS, "seconds").tag(sync=True, state=True)

    def run(self):
        """Return the results from 0 to ``time``, as a dict of arrays with one row for each step.

        ``'time'``; ``'angular_velocity'`` along A; ``'matrix'``, ``'quaternion'``, ``'angles'`` as
        integrated from it; and ``'reference'``, the unit quaternion of the fine integration. A run
        ends early if its numbers exceed ten thousand.
        """
        # Import it only here, because it needs NumPy.
        from . import tumbling

        count = int(self.time / self.step + 1e-9)
        return tumbling.run(
            self.moments, self.axis, self.disturbance, self.method, self.step, self.restored, count
        )

    @property
    def dcm(self):
        """The matrix of the drawn description at ``time``, orthogonal or not, shape ``(3, 3)``."""
        from . import tumbling

        return tumbling.matrices(self.run(), self.description, slice(-1, None))[0]

    @property
    def body(self):
        """The drawn body: 'racket', 'book' or, for other moments of inertia, 'block'."""
        return body_of(self.moments)

    @property
    def flips(self):
        """How often the spin axis has flipped with respect to the angular momentum."""
        from . import tumbling

        return tumbling.flips(self.run(), self.moments, self.axis)

    def still(self):
        plot = svg_on(PLOT, self.plot())
        end = "</div></figure>"
        return super().still().removesuffix(end) + plot + end

    def plot(self):
        """Return the ``Drawing`` of the growth of the drift up to ``time``."""
        from .sheet import Sheet

        return pictures.plot(self, Sheet)
