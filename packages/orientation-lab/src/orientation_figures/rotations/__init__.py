"""The stills of the essay *Rotations*, which show each of its stops where nothing can move.

The page of the essay has one figure, which stays while the text scrolls past. Its scenes are made
by ``js/scene.js``, which the page runs. ``scenes.json`` contains one scene of each stop, written by
``python -m tools.rotations``, and `orientation_figures.rotations.painter` draws it.
"""

import json
from functools import cache
from pathlib import Path

from ..style import LIGHT, STYLE

FOLDER = Path(__file__).parent
# The paper's tones for the parts of the figure that the script colours in the page.
_OWN = {
    "graphite": "#474e57", "metal": "#a3abb4", "glass": "#5f86b8", "paper": "#ffffff",
    "lamp": "#d93025",
    "star": "#e0a100", "ground": "#e9ecf0", "shade": "#cfd5dc",
}  # fmt: skip
_DARK = {
    "graphite": "#66707c",
    "metal": "#939ca6",
    "glass": "#8db4ea",
    "star": "#ffd75e",
    "ground": "#24292f",
    "shade": "#15181c",
}
# The share of black or white in each tone in per cent, darkest first; the fourth is the colour
# itself.
_TONES = ((45, "#000"), (28, "#000"), (13, "#000"), (0, "#fff"), (14, "#fff"), (30, "#fff"))


@cache
def scenes():
    """Return the stored data: the camera, and the ``stills`` of all stops in order."""
    return json.loads((FOLDER / "scenes.json").read_text("utf8"))


def style():
    """Return the style sheet of the stills."""
    own = ".orientation-figure.painted"

    def colours(table):
        return "".join(f"--{name}:{colour};" for name, colour in table.items())

    tones = "".join(
        f"{own} .tone-{k}{{fill:{fill};stroke:none}}"
        for k, (part, mixed_with) in enumerate(_TONES)
        for fill in [
            f"color-mix(in srgb,currentColor,{mixed_with} {part}%)" if part else "currentColor"
        ]
    )
    names = "".join(f"{own} .{name}{{color:var(--{name})}}" for name in _OWN)
    flat = f"{own} :is(.ground,.shade,.muted,.star,.paper){{fill:currentColor}}"
    dark = f'html[data-theme="dark"] {own}{{{colours(_DARK)}}}'
    return f"{own}{{{colours(_OWN)}}}{own} .paper{{fill:#fff}}{names}{tones}{flat}{dark}"


def _light(name):
    """Return the colour of a class of the stills, such as ``B tone-3``, on a light page."""
    colour, _, tone = name.partition(" tone-")
    part, mixed_with = _TONES[int(tone)]
    if colour in ("ground", "shade", "muted", "star", "paper"):
        part = 0
    known = (LIGHT | _OWN)[colour]
    towards = 0 if mixed_with == "#000" else 255
    mixed = (
        round(int(known[k : k + 2], 16) * (1 - part / 100) + towards * part / 100)
        for k in (1, 3, 5)
    )
    return "#" + "".join(f"{value:02x}" for value in mixed)


class Stop:
    """One stop of the essay, as a notebook, a page without scripts and paper show it."""

    def __init__(self, name):
        known = [still["id"] for still in scenes()["stills"]]
        if name not in known:
            raise ValueError(
                f"{name!r} is not a stop of the essay; the stops are {', '.join(known)}"
            )
        self.name = name
        self.still = scenes()["stills"][known.index(name)]

    def svg(self, colours=None):
        """Return the SVG element, with ``colours`` as in `painter.picture`."""
        from .painter import picture

        return picture(self.still, scenes(), colours)

    def _repr_html_(self):
        return (
            '<figure class="orientation-figure painted" '
            f'data-stop="{self.name}"><style>{STYLE}{style()}</style>'
            f"{self.svg()}</figure>"
        )

    def __repr__(self):
        from .painter import words

        return f"Stop({self.name!r}): {words(self.still)}"


class Gimbal(Stop):
    """The gimbal itself, which stays and moves on the page of the essay.

    Elsewhere it is shown at one stop.
    """

    def _repr_html_(self):
        return (
            f'<figure class="orientation-figure painted world" '
            f'data-figure="rotations">'
            f'<style>{STYLE}{style()}</style><div class="still">{self.svg(_light)}</div>'
            '<p class="stands">Here the camera stands still. On the book’s page you can '
            "take hold of it.</p></figure>"
        )
