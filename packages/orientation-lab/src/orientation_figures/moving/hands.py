"""A triad and its mirror image, which no rotation can align."""

import traitlets

from orientation.quaternions import dcm_from_quaternion

from .figure import MovingFigure
from .state import Direction


class HandsFigure(MovingFigure):
    r"""A right-handed triad $N$, and its mirror image or a copy, which the reader rotates.

    The angles between arrows of the same name are shown. A copy can be brought onto $N$. Of the
    mirror image only two arrows can fit, and then the third points the wrong way.

    Attributes
    ----------
    image : {'mirror', 'copy'}
    quaternion : tuple of four floats
        The rotation of the image, scalar first. Any four numbers but zeros may be given; they are
        kept at unit length.
    together : bool
        Whether the image is drawn over $N$, or beside it.

    Examples
    --------
    >>> from orientation_figures.moving import HandsFigure
    >>> figure = HandsFigure(image='mirror')
    >>> figure.rows[1]
    (0.0, -1.0, 0.0)
    """

    kind = "hands"
    sheet = (-190, -120, 190, 120)
    room = (553, 606)
    image = traitlets.Enum(("mirror", "copy"), "mirror").tag(sync=True, state=True)
    quaternion = Direction((1, 0, 0, 0), size=4).tag(sync=True, state=True)
    together = traitlets.Bool(False).tag(sync=True, state=True)

    @property
    def dcm(self):
        r"""${}^A\mathbf{C}^N$ of a frame after the same rotation, shape ``(3, 3)``."""
        return dcm_from_quaternion(self.quaternion)

    @property
    def rows(self):
        """The unit vectors of the image along N, three tuples."""
        first, second, third = (tuple(float(entry) + 0.0 for entry in row) for row in self.dcm)
        return (
            first,
            tuple(0.0 - entry for entry in second) if self.image == "mirror" else second,
            third,
        )
