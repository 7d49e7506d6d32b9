"""The quaternion and its double, and three ways from one orientation to another."""

import math

import traitlets

from orientation.axis_angle import quaternion_from_axis_angle
from orientation.direction_cosines import nearest_dcm
from orientation.euler_angles import dcm_from_body_fixed
from orientation.quaternions import (
    dcm_from_quaternion,
    interpolate_quaternions,
    quaternion_from_dcm,
)

from .figure import MovingFigure
from .pictures.quaternion import SECONDS, angle_between
from .state import Direction, Numbers

FULL = 4 * math.pi
STEP = 1e-4


class QuaternionFigure(MovingFigure):
    r"""Half angles and their uses, in two views.

    In the view 'double' a frame $A$ rotates in $N$ about an axis, and beside it $q =
    \cos\frac{\theta}{2} + \sin\frac{\theta}{2}\,\hat{e}$ goes round a circle at half the speed.
    After one full rotation it has become $-q$, and after two it is back.

    In the view 'way' three frames go from the orientation of $A$ to that of $B$ in four seconds:
    $C$ by interpolating quaternions (slerp), $D$ by interpolating Euler angles z-x-y, $E$ by the
    direction cosine matrix nearest to the interpolated matrix entries.

    Attributes
    ----------
    view : {'double', 'way'}
    more : bool
        Whether to show $-q$ beside $q$, and to offer both views.
    axis : tuple of three floats
        Direction of $\hat{e}$, normalised.
    angle : float
        $\theta$ in radians, from 0 to $4\pi$.
    first, second : tuples of three floats
        Body fixed angles ``(psi, theta, phi)`` of $A$ and $B$ in $N$ for the sequence 'zxy', in
        radians, each from $-\pi$ to $\pi$.
    unit_vector : {'x', 'y', 'z'}
        The unit vector whose tip is followed.
    share : float
        The completed share of the way, from 0 to 1.

    Examples
    --------
    >>> from orientation_figures.moving import QuaternionFigure
    >>> figure = QuaternionFigure(axis=(0, 0, 1), angle=6.283185307179586)
    >>> figure.quaternion.round(6).tolist()
    [-1.0, 0.0, 0.0, 0.0]
    """

    kind = "quaternion"
    view = traitlets.Enum(("double", "way"), "double").tag(sync=True, state=True)
    axis = Direction((-1, 2, 4)).tag(sync=True, state=True)
    angle = Numbers(math.radians(60), largest=FULL).tag(sync=True, state=True)
    first = Numbers(tuple(map(math.radians, (-70, -30, 70))), (3,), largest=math.pi).tag(
        sync=True, state=True
    )
    second = Numbers(tuple(map(math.radians, (90, 80, -120))), (3,), largest=math.pi).tag(
        sync=True, state=True
    )
    unit_vector = traitlets.Enum(("x", "y", "z"), "y").tag(sync=True, state=True)
    share = Numbers(0.3, largest=1.0).tag(sync=True, state=True)
    more = traitlets.Bool(True).tag(sync=True, constant=True)

    @traitlets.validate("angle", "share")
    def _not_negative(self, proposal):
        name, value = proposal["trait"].name, proposal["value"]
        if value < 0:
            raise traitlets.TraitError(
                f"{name} is {value:.6g}: it must be from 0 to {'1' if name == 'share' else '4 pi'}"
            )
        return value

    @property
    def sheet(self):
        """Left, top, right and bottom of the drawing, in pixels from its origin."""
        return (-118, -142, 242, 222) if self.view == "double" else (-180, -142, 180, 222)

    @property
    def room(self):
        """Height of the figure in pixels with its controls beside and below it."""
        if not self.more:
            return (570, 650)
        return (614, 842) if self.view == "double" else (691, 888)

    @property
    def quaternion(self):
        """The unit quaternion of half the angle, scalar first, shape ``(4,)``."""
        return quaternion_from_axis_angle(self.axis, self.angle)

    @property
    def dcm(self):
        r"""${}^A\mathbf{C}^N$ of the view 'double', shape ``(3, 3)``."""
        return dcm_from_quaternion(self.quaternion)

    def ways(self, share):
        r"""Return the matrices of $C$, $D$ and $E$ in $N$ part of the way.

        None stands for a way that does not exist: slerp between orientations half a turn apart, or
        blended entries to which several matrices are equally near.
        """
        first, second = self.ends
        angles = [(1 - share) * start + share * end for start, end in zip(self.first, self.second)]
        return (
            _or_none(
                lambda: dcm_from_quaternion(
                    interpolate_quaternions(
                        quaternion_from_dcm(first), quaternion_from_dcm(second), share
                    )
                )
            ),
            dcm_from_body_fixed(angles, "zxy"),
            _or_none(lambda: nearest_dcm(self.blend(share)).dcm),
        )

    def blend(self, share):
        """Return the matrix with interpolated entries of the two ends; its rows are too short."""
        first, second = self.ends
        return (1 - share) * first + share * second

    def speeds(self, share):
        """Return the three angular speeds at a share of the way, in radians per second.

        The whole way takes four seconds.
        """
        early, late = max(0, share - STEP), min(1, share + STEP)
        return tuple(
            angle_between(before, after) / (SECONDS * (late - early))
            for before, after in zip(self.ways(early), self.ways(late))
        )

    @property
    def ends(self):
        """The matrices of A and B, shape ``(2, 3, 3)``."""
        return dcm_from_body_fixed((self.first, self.second), "zxy")


def _or_none(compute):
    try:
        return compute()
    except ValueError:
        return None
