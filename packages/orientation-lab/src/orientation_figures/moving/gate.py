"""A walk past a car: a filter's heading, for steel of any strength and gates of any size."""

import json
from functools import cache
from pathlib import Path

import traitlets

from .figure import MovingFigure

_FILE = Path(__file__).with_suffix(".json")


@cache
def computed():
    """Return the results of ``python -m tools.gate``: walks for each steel and each gate."""
    return json.loads(_FILE.read_text("utf8"))


class GateFigure(MovingFigure):
    r"""The heading of a phone that its owner carries past a car, as estimated by a filter.

    Attributes
    ----------
    steel : int
        Microtesla that the car adds to the field: an even number from 0 to 12.
    gate : float
        Share of the field measurements of a correctly tuned filter that the gate rejects: 0 (no
        gate), 0.001, 0.01, 0.1, 0.5 or 0.9.

    Examples
    --------
    >>> from orientation_figures.moving import GateFigure
    >>> figure = GateFigure(steel=10)
    >>> figure.of_all_walks['worst'] > 40
    True
    >>> figure.gate = 0.01
    >>> figure.of_all_walks['worst'] < 8
    True
    """

    kind = "gate"
    sheet = (-180, -130, 180, 130)
    room = (345, 470)
    steel = traitlets.Enum(tuple(computed()["steels"]), 10).tag(sync=True, state=True)
    gate = traitlets.Enum(tuple(computed()["rejected"]), 0).tag(sync=True, state=True)
    table = traitlets.Dict().tag(sync=True, constant=True)

    @traitlets.default("table")
    def _default_table(self):
        return computed()

    @property
    def of_all_walks(self):
        """Five curves in degrees by the second, and three numbers on a hundred walks.

        The numbers are the median and the worst final error, and the share of rejected
        measurements.
        """
        row = self.table["rows"][self.table["steels"].index(self.steel)]
        return row[self.table["rejected"].index(self.gate)]
