"""The paper on which a picture is drawn, with the methods of the ``Sheet`` of ``js/shared.js``."""

import numpy as np

from ..drawing import Drawing


class Sheet(Drawing):
    """A drawing in layers: higher layers are above, and so are later marks in a layer.

    In the page, ``faded`` marks are dimmed while the reader touches a number; paper has no such
    state.
    """

    def __init__(self, alt, **attributes):
        super().__init__(alt, **attributes)
        self.layer, self.faded, self._layers = 0, False, []

    def paint(self, picture, *state):
        """Draw a picture of a state, and return the sheet."""
        picture(self, *state)
        order = sorted(range(len(self.marks)), key=self._layers.__getitem__)
        self.marks = [self.marks[k] for k in order]
        return self

    def path(self, *arguments):
        self._layers.append(self.layer)
        return super().path(*arguments)

    def text(self, *arguments):
        self._layers.append(self.layer)
        return super().text(*arguments)

    def line(self, points, colour="ink", kind=""):
        # The style sheet of a page draws slim tubes, but that of a still has none.
        return super().line(points, colour, "thick" if kind == "tube slim" else kind)

    def placed(self, right, down):
        """Return the point of N that is seen at a place of the sheet."""
        return list(np.array((right, -down, 0)) / self.scale @ self.view)
