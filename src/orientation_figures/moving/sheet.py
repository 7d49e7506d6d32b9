"""The sheet of paper on which a picture is painted: the same words as the ``Sheet`` of
``js/shared.js``.
"""

import numpy as np

from ..drawing import ROUND, Drawing, ellipse


class Sheet(Drawing):
    """A drawing in layers: what has the higher one lies above, within a layer what comes later.

    In the page ``faded`` marks step back behind a number that is touched; on paper nothing is
    touched.
    """

    def __init__(self, alt, **attributes):
        super().__init__(alt, **attributes)
        self.layer, self.faded, self._layers = 0, False, []

    @property
    def size(self):
        """Pixels for one unit of length."""
        return self.scale

    @size.setter
    def size(self, pixels):
        self.scale = pixels

    def paint(self, picture, *state):
        """Paint what a picture describes, and return the sheet."""
        picture(self, *state)
        order = sorted(range(len(self.marks)), key=self._layers.__getitem__)
        self.marks = [self.marks[k] for k in order]
        return self

    def path(self, commands, points, kind):
        self._layers.append(self.layer)
        return super().path(commands, points, kind)

    def _write(self, *arguments, **more):
        self._layers.append(self.layer)
        return super()._write(*arguments, **more)

    def line(self, points, colour="ink", kind=""):
        # The style sheet of a page makes slim tubes; that which goes with a still knows none.
        return super().line(points, colour, "thick" if kind == "tube slim" else kind)

    def circle(
        self, normal, *, half="", radius=1.0, origin=(0, 0, 0), colour="muted", kind="guide"
    ):
        """Draw a circle, or the half of it that is nearer to the reader ('front') or farther
        ('back').
        """
        if not half:
            return super().circle(normal, radius, origin, colour, kind)
        across = np.cross(normal, self.view[2])
        across = across / (np.linalg.norm(across) or 1)
        up = np.cross(across, normal)
        way = 1 if (up @ self.view[2] > 0) == (half == "front") else -1
        u, v = self.on_sheet(radius * across), way * self.on_sheet(radius * up)
        points = [u, u + ROUND * v, v + ROUND * u, v, v - ROUND * u, ROUND * v - u, -u]
        for layer in (kind, f"{kind} core") if kind == "tube" else (kind,):
            self.path("MCC", self.on_sheet(origin) + points, f"{layer} {colour}")
        return self

    def ring(self, point, colour="ink", radius=5):
        """Draw a small circle with a radius in pixels."""
        return self.path(
            *ellipse(self.on_sheet(point), (radius, 0), (0, radius)), f"paper {colour}"
        )

    def label_beyond(self, point, text, colour="ink", pixels=17):
        """Write a label beyond a point as seen from the origin."""
        place = self.on_sheet(point)
        return self.label(point, text, colour, pixels * place / (np.linalg.norm(place) or 1))

    def placed(self, right, down):
        """The point of N that is seen at a place of the sheet."""
        return list(np.array((right, -down, 0)) / self.scale @ self.view)
