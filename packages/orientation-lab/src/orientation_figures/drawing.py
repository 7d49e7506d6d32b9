r"""Line drawings of reference frames.

A `Drawing` is a sheet seen by a camera. The camera is one more reference frame $V$, with
$\hat{v}_x$ to the right, $\hat{v}_y$ up and $\hat{v}_z$ towards the reader; points are given by
their components along $N$ and reach the sheet through ${}^V\mathbf{C}^N$, without perspective. In a
notebook the drawing shows itself as inline SVG, which scales with the page, follows the light or
dark theme, and carries a text description for readers who cannot see it.
"""

import hashlib
import json
from functools import cache
from html import escape
from pathlib import Path

import numpy as np

from orientation.direction_cosines import simple_dcm

from .style import EITHER, STYLE, style_of_picture
from .vectors import unit
from .words import Words, hatted  # noqa: F401  # those who draw took it from here before

# The typeset labels of the book's drawings, which ``python -m tools.labels`` writes.
LABELS = Path(__file__).with_name("labels.json")


def looking_down(axis):
    r"""Return the view ${}^V\mathbf{C}^N$ with ``axis`` of $N$ towards the reader.

    The next axis in the order x, y, z, x points to the right and the one after it points up, so a
    positive angle about ``axis`` is seen counterclockwise.

    Parameters
    ----------
    axis : {'x', 'y', 'z'}

    Returns
    -------
    array of shape ``(3, 3)``

    Examples
    --------
    >>> from orientation_figures.drawing import looking_down
    >>> looking_down('y')
    array([[0., 0., 1.],
           [1., 0., 0.],
           [0., 1., 0.]])
    """
    toward = "xyz".index(axis)
    return np.eye(3)[[(toward + 1) % 3, (toward + 2) % 3, toward]]


def view_from(azimuth, elevation):
    r"""Return the view ${}^V\mathbf{C}^N$ of an upright camera that looks at the origin.

    Parameters
    ----------
    azimuth : float
        The direction of the camera, in radians about $\hat{n}_z$, from $\hat{n}_x$.
    elevation : float
        Radians above the plane of $\hat{n}_x$ and $\hat{n}_y$.

    Returns
    -------
    array of shape ``(3, 3)``

    Examples
    --------
    >>> from orientation_figures.drawing import view_from
    >>> view_from(0.0, 0.0)[2]
    array([1., 0., 0.])
    """
    # A frame with this orientation has its x unit vector towards the camera, y to the right and z
    # up.
    return (simple_dcm("y", -float(elevation)) @ simple_dcm("z", float(azimuth)))[[1, 2, 0]]


IN_SPACE = view_from(np.radians(32), np.radians(24))


class Drawing(Words):
    r"""A sheet on which frames, vectors and angles are drawn.

    The sheet is cut to what is drawn. Every drawing method returns the drawing, so that calls can
    be chained. Points are given by their three components along $N$, lengths in the same unit.
    ``colour`` is the letter of a frame, ``'ink'``, ``'muted'`` or ``'accent'``. Texts between
    dollar signs are set as mathematics; ``shift`` moves a text by pixels to the right and down.

    Parameters
    ----------
    alt : str
        The text description: what the picture shows. Required.
    view : array of shape ``(3, 3)``
        ${}^V\mathbf{C}^N$, for instance from `looking_down` or `view_from`.
    scale : float
        Pixels for one unit of length.

    Raises
    ------
    ValueError
        If ``alt`` has fewer than 40 characters, or ``view`` is not a (3, 3) matrix.

    Examples
    --------
    >>> import numpy as np
    >>> from orientation import simple_dcm
    >>> from orientation_figures.drawing import Drawing, looking_down
    >>> drawing = Drawing('n x points right and n y up; a x and a y are turned counterclockwise '
    ...                   'from them through 0.5 radians.', view=looking_down('z'))
    >>> drawing.triad('N', np.eye(3)).triad('A', simple_dcm('z', 0.5)).alt[:17]
    'n x points right '
    """

    def __init__(self, alt, view=IN_SPACE, scale=120):
        if len(alt.strip()) < 40:
            raise ValueError(
                f"alt has only {len(alt.strip())} characters; a description needs at least 40. "
                "Name the arrows and the angles, and say what they show"
            )
        self.view = np.asarray(view, dtype=float)
        if self.view.shape != (3, 3):
            raise ValueError(
                f"view has shape {self.view.shape}; it must be a (3, 3) direction cosine matrix"
            )
        self.alt, self.scale, self.marks = alt.strip(), scale, []

    def on_sheet(self, points):
        """Return the places of points of shape ``(..., 3)``, in pixels right and down."""
        return self.scale * (np.asarray(points, dtype=float) @ self.view.T)[..., :2] * (1, -1)

    @property
    def size(self):
        """Pixels for one unit of length, under the name that the shared drawing methods use."""
        return self.scale

    @size.setter
    def size(self, pixels):
        self.scale = pixels

    def path(self, commands, points, kind, depth=0):
        """Add an SVG path with one letter of ``commands`` per step.

        ``points`` are on the sheet, and ``kind`` is the classes of the path. On paper, later marks
        are drawn above earlier ones, whatever their ``depth``.
        """
        self.marks.append(
            (kind.strip(), commands, np.asarray(points, dtype=float).reshape(-1, 2), 1.0)
        )
        return self

    def text(self, text, place, colour, size=20, opacity=1.0):
        """Write ``text`` centred at a place of the sheet."""
        self.marks.append((f"text {colour}", (text, size), np.asarray(place, dtype=float), opacity))
        return self

    def note(self, text, colour="ink", size=18):
        """Write a line of ``text`` under everything drawn so far."""
        left, _, right, bottom = self.bounds()
        return self.text(text, ((left + right) / 2, bottom + 1.4 * size), colour, size)

    def arrow(
        self,
        end,
        start=(0, 0, 0),
        colour="ink",
        label="",
        shift=None,
        bow=0,
        size=20,
        kind="",
    ):
        """Draw an arrow from ``start`` to ``end``.

        The label is ``shift`` from the tip or beyond it.

        An arrow that points straight at the reader is a circle with a dot, one that points straight
        away a circle with a cross. An arrow with a ``bow`` curves to its left by so many pixels,
        and its label is at its middle.
        """
        if not bow:
            return super().arrow(end, start, colour, label, shift, size, kind)
        tail, tip = self.on_sheet([start, end])
        along = np.array(unit(tip - tail))
        left = np.array((along[1], -along[0]))
        first, second = (tail + part * (tip - tail) + 4 / 3 * bow * left for part in (0.25, 0.75))
        along = np.array(unit(tip - second))
        self.path("MC", [tail, first, second, tip - 9 * along], f"axis {colour}")
        self.head(tip, along, 1, colour)
        middle, outward = (tail + tip) / 2 + bow * left, np.sign(bow) * 15 * left
        place = middle + (outward if shift is None else shift)
        return self.text(label, place, colour, size) if label else self

    def node(self, point, letter):
        """Draw a circle for the frame ``letter`` in a diagram of connected frames."""
        self.ellipse(self.on_sheet(point), (19, 0), (0, 19), f"fill-8 axis {letter}")
        return self.label(point, f"${letter}$", letter)

    # SVG.

    def _repr_html_(self):
        return f'<figure class="orientation-figure"><style>{STYLE}</style>{self.svg()}</figure>'

    def __repr__(self):
        return f"Drawing: {self.alt}"

    def bounds(self):
        """Return left, top, right and bottom of everything drawn, in pixels from the origin."""
        corners = []
        for _, shape, place, _ in self.marks:
            ink = (
                np.zeros((2, 2))
                if isinstance(shape, str)
                else shape[1] / 1000 * typeset(shape[0])[1]
            )
            corners += [
                np.min(np.asarray(place).reshape(-1, 2), axis=0) + ink[0],
                np.max(np.asarray(place).reshape(-1, 2), axis=0) + ink[1],
            ]
        return np.concatenate([np.min(corners, axis=0), np.max(corners, axis=0)])

    def svg(self, motions=None, bounds=None, decimals=2, enlarged=1):
        """Return the SVG element, which a page may show up to ``enlarged`` times as large.

        An ``Animation`` gives the content of each mark's element, and its own bounds.
        """
        bounds = self.bounds() if bounds is None else bounds
        left, top, right, bottom = np.rint(np.add(bounds, (-8.01, -8.01, 8.01, 8.01))).astype(int)
        outlines = {}
        marks = "".join(
            _element(mark, motion, outlines, decimals)
            for mark, motion in zip(self.marks, motions or [""] * len(self.marks), strict=True)
            if motion or not collapsed(mark)
        )
        glyphs = "".join(
            f'<path id="@{number}" d="{outline}"/>' for outline, number in outlines.items()
        )
        # The IDs depend on the content, so two figures on one page cannot clash, and every run
        # gives the same ones.
        name = "g" + hashlib.sha256((self.alt + glyphs + marks).encode()).hexdigest()[:10]
        inside = (f"<defs>{glyphs}</defs>" if glyphs else "") + marks
        return (
            f'<svg viewBox="{left} {top} {right - left} {bottom - top}" '
            f'style="max-width:{enlarged * (right - left):.0f}px" role="img" '
            f'aria-label="{escape(self.alt)}">{inside.replace("@", name + "-")}</svg>'
        )

    def picture(self):
        """Return the drawing as a stand-alone SVG file, without the style of a page.

        Its background is transparent, and it is legible on light and dark pages.
        """
        head, _, inside = self.svg().partition(">")
        view = head.partition('viewBox="')[2].partition('"')[0]
        classes = {name for kind, *_ in self.marks for name in ("text", *kind.split())}
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{view}" '
            f'width="{view.split()[2]}" height="{view.split()[3]}" color="{EITHER["ink"]}" '
            'fill="none" stroke="currentColor" stroke-width="1.5" stroke-linecap="round" '
            f'stroke-linejoin="round"><style>{style_of_picture(classes)}</style>{inside}'
        )


def collapsed(mark):
    """Check whether a mark is a path of a single point, as the far sides of bodies are."""
    return isinstance(mark[1], str) and np.ptp(mark[2], axis=0).max() < 1e-6


def _element(mark, motion, outlines, decimals):
    kind, shape, place, opacity = mark
    if isinstance(shape, str):
        start = f'<path class="{kind}" d="{path_data(shape, place, decimals)}"'
        return start + (f">{motion}</path>" if motion else "/>")
    text, size = shape
    uses = ""
    for outline, corner, glyph_size in typeset(text)[0]:
        number = outlines.setdefault(outline, len(outlines))
        uses += (
            f'<use href="#@{number}" transform="translate({pair(size / 1000 * corner, 2)}) '
            f'scale({_number(size * glyph_size / 1000, 5)})"/>'
        )
    fade = f' opacity="{_number(opacity, 2)}"' if opacity < 1 else ""
    return f'<g class="{kind}"{fade} transform="translate({pair(place, 2)})">{motion}{uses}</g>'


@cache
def typeset(text):
    """Typeset ``text`` in Computer Modern, 1000 units to the em.

    The origin is the middle of a small letter, with axes right and down. Returns a list of (outline
    as path data, place, size), and the two corners of the ink. Without Matplotlib, as on a page
    that has not fetched it, only the labels of the book's own drawings are available.
    """
    try:
        from matplotlib.font_manager import FontProperties
        from matplotlib.textpath import text_to_path
    except ModuleNotFoundError:
        if text not in _kept_labels():
            raise
        return _kept_labels()[text]
    font = FontProperties(family="cmr10", math_fontfamily="cm")
    placed, shapes, rules = text_to_path.get_glyphs_mathtext(font, text)
    pieces = [(*shapes[name], (x, y), size) for name, x, y, size in placed] + [
        (*rule, (0, 0), 1) for rule in rules
    ]
    unit = 1000 / text_to_path.FONT_SCALE * np.array((1, -1))
    glyphs, ink = [], []
    for vertices, codes, corner, size in pieces:
        if len(codes):
            vertices, codes, corner = unit * vertices, np.asarray(codes), unit * corner
            glyphs.append((_outline(vertices, codes), corner, size))
            ink.append(corner + size * vertices[codes != 79])
    if not ink:
        raise ValueError(f"the text {text!r} contains no visible characters")
    ink = np.concatenate(ink)
    corners = np.array([ink.min(axis=0), ink.max(axis=0)])
    middle = np.array((corners[:, 0].mean(), -220))
    return [(outline, corner - middle, size) for outline, corner, size in glyphs], corners - middle


@cache
def _kept_labels():
    stored = json.loads(LABELS.read_text("utf8"))
    return {
        text: (
            [(stored["outlines"][k], np.array((x, y)), size) for k, x, y, size in glyphs],
            np.array(ink),
        )
        for text, (glyphs, ink) in stored["labels"].items()
    }


def labels_to_keep(texts):
    """Return the content of ``labels.json``.

    It consists of the outlines of glyphs and, for each text, their places and its ink.
    """
    outlines, labels = {}, {}
    for text in sorted(texts):
        placed, ink = typeset(text)
        glyphs = [
            [outlines.setdefault(outline, len(outlines)), *map(float, corner), float(size)]
            for outline, corner, size in placed
        ]
        labels[text] = [glyphs, ink.tolist()]
    return {"outlines": list(outlines), "labels": labels}


def _outline(vertices, codes):
    """Return a glyph's path data in integers relative to the previous point, which is short."""
    data, k = "", 0
    last = beginning = np.zeros(2, dtype=int)
    while k < len(codes):
        letter, count = {1: ("m", 1), 2: ("l", 1), 3: ("q", 2), 4: ("c", 3), 79: ("z", 1)}[
            int(codes[k])
        ]
        data += letter
        if letter == "z":
            last = beginning
        else:
            corners = np.rint(vertices[k : k + count]).astype(int)
            data += (
                "".join(f"{number:+d}" for number in (corners - last).ravel())
                .replace("+", " ")
                .strip()
            )
            last = corners[-1]
            if letter == "m":
                beginning = last
        k += count
    return data


def _number(value, decimals):
    # The small shift keeps exact halves, which could be rounded either way, away from the rounding.
    return f"{round(float(value) + 3.1e-6, decimals) + 0.0:g}"


def pair(point, decimals):
    return " ".join(_number(value, decimals) for value in point)


def path_data(commands, points, decimals=2):
    """Return SVG path data: each command takes its own number of ``points``."""
    data, k = "", 0
    for letter in commands:
        count = {"M": 1, "L": 1, "C": 3, "Q": 2, "Z": 0}[letter]
        data += letter + " ".join(pair(point, decimals) for point in points[k : k + count])
        k += count
    return data
