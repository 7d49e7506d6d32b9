"""Line drawings of reference frames.

A `Drawing` is a sheet seen by a camera. The camera is one more reference frame $V$, with
$\\hat{v}_x$ to the right, $\\hat{v}_y$ up and $\\hat{v}_z$ towards the reader; points are given by
their components along $N$ and reach the sheet through ${}^V\\mathbf{C}^N$, without perspective.
In a notebook the drawing shows itself as inline SVG: it scales with the page, follows the light or
dark theme, and carries the text that stands for it (`alt`) for readers who do not see it.
"""
import hashlib
from functools import lru_cache
from html import escape

import numpy as np

from .axis_angle import dcm_from_axis_angle
from .direction_cosines import simple_dcm

# Each colour is kept at 4.5 : 1 or more on its page: LIGHT on white, DARK on #121212.
LIGHT = {'N': '#3a3f45', 'A': '#946200', 'B': '#b3261e', 'C': '#1a7431', 'D': '#1f5fbf',
         'E': '#7b3fa0', 'F': '#a0306e', 'Z': '#5a6300', 'ink': '#1d2125', 'muted': '#646b73', 'accent': '#00696f'}
DARK = {'N': '#d0d4da', 'A': '#f2c14e', 'B': '#ff8a80', 'C': '#6fdc8c', 'D': '#8ab4ff',
        'E': '#cfa3f0', 'F': '#f39ac7', 'Z': '#c3d35b', 'ink': '#eceff2', 'muted': '#a2a9b1', 'accent': '#5fd3da'}

# Without colour, frames differ in the stroke of their arrows (width, dashes) and in the shape of the
# head, given by points (along, across) behind the tip.
STROKES = {'N': (1.7, ''), 'A': (3.4, ''), 'B': (2.6, '9 4.5'), 'C': (2.6, '11 4.5 0.1 4.5'),
           'D': (3.2, '0.1 5.2'), 'E': (2, '16 4'), 'F': (4.6, ''), 'Z': (2, '5 4'),
           'ink': (2.4, ''), 'muted': (1.7, ''), 'accent': (2.4, '')}
BARB = ((0, 0), (-13, 4.6), (-7.5, 0), (-13, -4.6))
TRIANGLE = ((0, 0), (-14, 5.6), (-14, 0), (-14, -5.6))
DIAMOND = ((0, 0), (-8, 5.4), (-16, 0), (-8, -5.4))
HEADS = {'N': BARB, 'C': DIAMOND, 'ink': BARB, 'muted': BARB, 'accent': BARB}

VARIABLES = ''.join(f'--{name}:var(--frame-{name.lower()},%({name})s);' for name in LIGHT)
STYLE = (
    f'.orientation-figure{{{VARIABLES % LIGHT}'
    '--paper:var(--pst-color-background,var(--jp-layout-color0,#fff));margin:1rem auto;text-align:center}'
    'html[data-theme="dark"] .orientation-figure,body[data-jp-theme-light="false"] .orientation-figure'
    f'{{{VARIABLES % DARK}}}'
    '.orientation-figure svg{width:100%%;height:auto;fill:none;stroke:currentColor;stroke-width:1.5;'
    'stroke-linecap:round;stroke-linejoin:round}'
    '.orientation-figure .head,.orientation-figure .text{fill:currentColor;stroke:none}'
    '.orientation-figure .text{stroke:var(--paper);stroke-width:200;paint-order:stroke}'
    '.orientation-figure .guide{stroke-width:1.3;stroke-dasharray:4 4}'
    '.orientation-figure .faint{stroke-width:1;stroke-opacity:.45}'
    '.orientation-figure .thick{stroke-width:3}'
    '.orientation-figure .bare{stroke-width:.4}'
    '.orientation-figure .paper{fill:var(--paper)}.orientation-figure [class*=fill]{stroke-linecap:butt}'
    '.orientation-figure .tube{stroke-width:13}.orientation-figure .tube.core{stroke-width:9.5;'
    'stroke:color-mix(in srgb,currentColor 22%%,var(--paper))}'
    '.orientation-figure .controls input{width:55%%;vertical-align:middle}'
    '.orientation-figure .controls output{display:block;min-height:3em}'
    + ''.join(f'.orientation-figure .fill-{part}{{fill:color-mix(in srgb,currentColor {part}%%,var(--paper))}}'
              for part in (8, 16, 26, 38))
    + ''.join(f'.orientation-figure .{name}{{color:var(--{name})}}' for name in LIGHT)
    + ''.join(f'.orientation-figure .axis.{name}{{stroke-width:{width};stroke-dasharray:{dashes or "none"}}}'
              for name, (width, dashes) in STROKES.items())).replace('%%', '%')


def looking_down(axis):
    """Return the view ${}^V\\mathbf{C}^N$ with `axis` ('x', 'y' or 'z') of $N$ towards the reader.

    The next axis in the order x, y, z, x points to the right and the one after it points up, so a
    positive angle about `axis` is seen counterclockwise.

    >>> looking_down('y')
    array([[0., 0., 1.],
           [1., 0., 0.],
           [0., 1., 0.]])
    """
    toward = 'xyz'.index(axis)
    return np.eye(3)[[(toward + 1) % 3, (toward + 2) % 3, toward]]


def view_from(azimuth, elevation):
    """Return the view ${}^V\\mathbf{C}^N$ of a camera that stands at `azimuth` (radians about $\\hat{n}_z$
    from $\\hat{n}_x$) and `elevation` (radians above the plane of $\\hat{n}_x$ and $\\hat{n}_y$).

    >>> view_from(0.0, 0.0)[2]
    array([1., 0., 0.])
    """
    camera = np.asarray(simple_dcm('y', -float(elevation)) @ simple_dcm('z', float(azimuth)))
    return camera[[1, 2, 0]]


IN_SPACE = view_from(np.radians(32), np.radians(24))


class Drawing:
    """A sheet on which frames, vectors and angles are drawn.

    Parameters
    ----------
    alt : str
        The text that stands for the picture: it says what the picture shows. Required.
    view : array_like, shape (3, 3)
        ${}^V\\mathbf{C}^N$, for instance from `looking_down` or `view_from`.
    scale : float
        Pixels for one unit of length.

    The sheet is cut to what is drawn. Every drawing method returns the drawing, so that calls can be
    chained. `colour` is the letter of a frame, `'ink'`, `'muted'` or `'accent'`. Texts between dollar
    signs are set as mathematics.

    Raises
    ------
    ValueError
        If `alt` has fewer than 40 characters, or `view` is not a (3, 3) matrix.
    """

    def __init__(self, alt, view=IN_SPACE, scale=120):
        if len(alt.strip()) < 40:
            raise ValueError(f'alt has {len(alt.strip())} characters; a text that can stand for the '
                             'picture needs at least 40: name the arrows, the angles and what they show')
        self.view = np.asarray(view, dtype=float)
        if self.view.shape != (3, 3):
            raise ValueError(f'view has shape {self.view.shape}; it must be a (3, 3) direction cosine matrix')
        self.alt, self.scale, self.marks = alt.strip(), scale, []

    def on_sheet(self, points):
        """Return where `points`, shape (..., 3), stand on the sheet: pixels right and down from the origin, shape (..., 2)."""
        seen = np.asarray(points, dtype=float) @ self.view.T
        return self.scale * seen[..., :2] * (1, -1)

    def path(self, commands, points, kind, opacity=1):
        """Add an SVG path of `kind` (its classes): one letter of `commands` per step, `points` on the sheet."""
        self.marks.append((kind, commands, np.asarray(points, dtype=float).reshape(-1, 2), float(opacity)))
        return self

    # Lines, areas and words.

    def line(self, points, colour='ink', kind=''):
        """Draw a line through `points`, shape (n, 3); `kind` is '', 'guide' (dashed), 'faint', 'thick' or 'tube'."""
        sheet = self.on_sheet(points)
        for layer in ((kind, 'tube core') if kind == 'tube' else (kind,)):
            self.path('M' + 'L' * (len(sheet) - 1), sheet, f'{layer} {colour}')
        return self

    def area(self, points, colour='ink', fill=16, edge=True):
        """Fill the polygon with corners `points`, shape (n, 3); `fill` is 0 (paper), 8, 16, 26 or 38 per cent."""
        sheet = self.on_sheet(points)
        kind = (f'fill-{fill} ' if fill else 'paper ') + ('' if edge else 'bare ')
        return self.path('M' + 'L' * (len(sheet) - 1) + 'Z', sheet, kind + colour)

    def dot(self, point, colour='ink', radius=4):
        """Draw a dot, `radius` pixels large, at a point."""
        return self.path(*_ellipse(self.on_sheet(point), (radius, 0), (0, radius)), f'head {colour}')

    def label(self, point, text, colour='ink', shift=(0, 0), size=20, opacity=1):
        """Write `text` centred on a point, moved by `shift` pixels to the right and down."""
        self.marks.append((f'text {colour}', (text, size), self.on_sheet(point) + shift, float(opacity)))
        return self

    def note(self, text, colour='ink', size=18):
        """Write a line of `text` under all that has been drawn so far."""
        left, _, right, bottom = self.bounds()
        self.marks.append((f'text {colour}', (text, size), np.array(((left + right) / 2, bottom + 1.4 * size)), 1.0))
        return self

    # Arrows and frames.

    def arrow(self, end, start=(0, 0, 0), colour='ink', label='', shift=None, kind='axis', bow=0):
        """Draw an arrow from `start` to `end` in the style of its frame, with a label beyond its tip.

        An arrow that points straight at the reader is a circle with a dot, one that points straight
        away a circle with a cross. `shift` moves the label (pixels from the tip). An arrow with a
        `bow` curves to its left by so many pixels, and carries its label at its middle.
        """
        start, end = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
        (tail, tip), depth = self.on_sheet([start, end]), self.view[2] @ (end - start)
        along, length = _direction(tip - tail)
        if length < 0.05 * self.scale * np.linalg.norm(end - start):
            self.path(*_ellipse(tip, (9, 0), (0, 9)), f'paper {colour}')
            if depth > 0:
                self.path(*_ellipse(tip, (3, 0), (0, 3)), f'head {colour}')
            else:
                self.path('MLML', tip + 6.4 * np.array([(-1, -1), (1, 1), (-1, 1), (1, -1)]), colour)
            outward = np.array((15, 15))
        elif bow:
            left = np.array((along[1], -along[0]))
            first, second = (tail + (tip - tail) * part + 4 / 3 * bow * left for part in (0.25, 0.75))
            turned = _direction(tip - second)[0]
            self.path('MC', [tail, first, second, tip - 9 * turned], f'{kind} {colour}')
            self._head(tip, turned, 1, colour)
            outward, tip = np.sign(bow) * 15 * left, (tail + tip) / 2 + bow * left
        else:
            size = min(1, 0.5 * length / 14)
            self.path('ML', [tail, tip - 10 * size * along], f'{kind} {colour}')
            self._head(tip, along, size, colour)
            outward = 17 * along
        if label:
            self.marks.append((f'text {colour}', (label, 20), tip + (outward if shift is None else shift), 1.0))
        return self

    def _head(self, tip, along, size, colour):
        corners = size * np.array(HEADS.get(colour, TRIANGLE)) @ np.array([along, (-along[1], along[0])])
        self.path('MLLLZ', tip + corners, f'head {colour}')

    def triad(self, letter, dcm, origin=(0, 0, 0), length=1.0, labels=None, shifts=(None, None, None)):
        """Draw the unit vectors of the frame `letter`.

        `dcm` is the direction cosine matrix of that frame with respect to $N$, shape (3, 3): its rows
        are the frame's unit vectors. `labels` are three strings, by default the hatted symbols; an
        empty string leaves that arrow without a label, and None leaves that arrow out. `shifts` are
        three places for the labels, in pixels from the tips.
        """
        if labels is None:
            labels = [rf'$\hat{{{letter.lower()}}}_{axis}$' for axis in 'xyz']
        for row, label, shift in zip(np.asarray(dcm, dtype=float), labels, shifts, strict=True):
            if label is not None:
                self.arrow(origin + length * row, origin, letter, label, shift)
        return self

    def node(self, point, letter):
        """Draw a circle that stands for the frame `letter`, as in a diagram of how frames are connected."""
        place = self.on_sheet(point)
        self.path(*_ellipse(place, (19, 0), (0, 19)), f'fill-8 axis {letter}')
        return self.label(point, f'${letter}$', letter)

    # Angles.

    def turn(self, axis, angle, start, radius=0.5, label='', origin=(0, 0, 0), colour='ink', shift=(0, 0), kind='',
             head=True):
        """Draw the arc that the tip of `start` sweeps when it is turned through `angle` (radians) about `axis`."""
        origin, pieces = np.asarray(origin, dtype=float), 4
        unit = radius * np.asarray(start, dtype=float) / np.linalg.norm(start)

        def turned(part, vector=unit):
            # Row k of A_C_N is A's k-th unit vector, so its transpose turns vectors through the angle.
            return np.asarray(dcm_from_axis_angle(_direction(axis)[0], part * float(angle))).T @ vector

        swept = abs(angle) * radius * self.scale
        size = min(0.8, 0.5 * swept / 14) if head else 0
        last = 1 - (9 * size / swept if swept else 0)
        reach = 4 / 3 * np.tan(last * angle / pieces / 4)
        normal = _direction(axis)[0]
        points = [unit]
        for k in range(pieces):
            near, far = turned(last * k / pieces), turned(last * (k + 1) / pieces)
            points += [near + reach * np.cross(normal, near), far - reach * np.cross(normal, far), far]
        self.path('M' + 'C' * pieces, self.on_sheet(origin + points), f'{kind} {colour}')
        if head:
            tip, before = self.on_sheet(origin + [turned(1), turned(last)])
            self._head(tip, _direction(tip - before)[0], size, colour)
        if label:
            middle, centre = self.on_sheet([origin + turned(0.5), origin])
            place = middle + 15 * _direction(middle - centre)[0] + shift
            self.marks.append((f'text {colour}', (label, 20), place, min(1.0, abs(float(angle)) / 0.2)))
        return self

    def arc(self, start, end, radius=0.5, label='', origin=(0, 0, 0), colour='ink', shift=(0, 0), kind='', head=True):
        """Draw the angle from the direction `start` to the direction `end`, the short way round."""
        axis, sine = _direction(np.cross(start, end))
        return self.turn(axis, np.arctan2(sine, np.dot(start, end)), start, radius, label, origin, colour, shift, kind, head)

    def right_angle(self, first, second, origin=(0, 0, 0), size=0.12, colour='muted'):
        """Mark the right angle between two directions at `origin`."""
        first, second = (size * _direction(np.asarray(v, dtype=float))[0] for v in (first, second))
        return self.line(np.asarray(origin) + [first, first + second, second], colour)

    def circle(self, normal, radius=1.0, origin=(0, 0, 0), colour='muted', kind='guide'):
        """Draw the circle about `normal`."""
        return self._round(*_across(normal, radius), np.asarray(origin, dtype=float), f'{kind} {colour}')

    def _round(self, first, second, origin, kind):
        place, u, v = self.on_sheet([origin, origin + first, origin + second])
        return self.path(*_ellipse(place, u - place, v - place), kind)

    # Solid bodies. Draw what lies farther from the reader first. Faces turned away shrink to nothing
    # instead of being left out, so that an `Animation` finds the same marks at every moment.

    def box(self, dcm, size, origin=(0, 0, 0), colour='ink'):
        """Draw a box with edges `size` along the rows of `dcm`, its middle at `origin`."""
        half = np.asarray(dcm, dtype=float) * np.reshape(size, (3, 1)) / 2
        for i in range(3):
            u, v = half[(i + 1) % 3], half[(i + 2) % 3]
            for outward in (half[i], -half[i]):
                seen = outward @ self.view[2] > 0
                self.area(np.asarray(origin) + outward + seen * np.array([u + v, v - u, -u - v, u - v]), colour, (26, 16, 8)[i])
        return self

    def cylinder(self, start, end, radius, colour='ink', fill=26):
        """Draw a cylinder between the middles of its two round ends."""
        axis = _direction(np.subtract(end, start))[0]
        ends, facing, radius = self.on_sheet([start, end]), axis @ self.view[2], radius * self.scale
        along = _direction(ends[1] - ends[0])[0] if abs(facing) < 0.9999 else np.array((1.0, 0.0))
        bulge, side = radius * abs(facing) * along, radius * np.array((-along[1], along[0]))
        body = [end + part for end, out, across in ((ends[1], bulge, side), (ends[0], -bulge, -side))
                for part in (across, across + 0.5523 * out, 0.5523 * across + out, out,
                             out - 0.5523 * across, 0.5523 * out - across, -across)]
        self.path('MCCLCCZ', body, f'fill-{fill} {colour}')
        for end, seen in zip(ends, (facing < 0, facing > 0)):
            self.path(*_ellipse(end, seen * bulge, seen * side), f'fill-8 {colour}')
        return self

    # SVG.

    def _repr_html_(self):
        return f'<figure class="orientation-figure"><style>{STYLE}</style>{self.svg()}</figure>'

    def __repr__(self):
        return f'Drawing: {self.alt}'

    def bounds(self):
        """Return left, top, right and bottom of what has been drawn, in pixels from the origin."""
        corners = []
        for kind, shape, place, _ in self.marks:
            ink = np.zeros((2, 2)) if isinstance(shape, str) else shape[1] / 1000 * typeset(shape[0])[1]
            corners += [np.min(np.atleast_2d(place), axis=0) + ink[0], np.max(np.atleast_2d(place), axis=0) + ink[1]]
        return np.concatenate([np.min(corners, axis=0), np.max(corners, axis=0)])

    def svg(self, motions=None, bounds=None, decimals=2):
        """Return the SVG element.

        `Animation` gives what goes inside each mark as `motions`, and the `bounds` of all moments.
        """
        left, top, right, bottom = np.rint((self.bounds() if bounds is None else bounds) + (-8.01, -8.01, 8.01, 8.01)).astype(int)
        outlines = {}
        marks = ''.join(_element(mark, motion, outlines, decimals)
                        for mark, motion in zip(self.marks, motions or [''] * len(self.marks), strict=True)
                        if motion or not collapsed(mark))
        glyphs = ''.join(f'<path id="@{number}" d="{outline}"/>' for outline, number in outlines.items())
        # Ids are made from the content: two figures on one page cannot clash, and no run differs from the last.
        name = 'g' + hashlib.sha256((self.alt + glyphs + marks).encode()).hexdigest()[:10]
        inside = (f'<defs>{glyphs}</defs>' if glyphs else '') + marks
        return (f'<svg viewBox="{left} {top} {right - left} {bottom - top}" role="img" aria-label="{escape(self.alt)}" '
                f'style="max-width:{right - left}px">{inside.replace("@", name + "-")}</svg>')


def collapsed(mark):
    """Return whether a mark is a path that has shrunk to one point, as the far sides of bodies do."""
    return isinstance(mark[1], str) and np.ptp(mark[2], axis=0).max() < 1e-6


def _element(mark, motion, outlines, decimals):
    kind, shape, place, opacity = mark
    if isinstance(shape, str):
        return f'<path class="{kind.strip()}" d="{path_data(shape, place, decimals)}"' + (f'>{motion}</path>' if motion else '/>')
    text, size = shape
    glyphs, _ = typeset(text)
    uses = ''
    for outline, corner, glyph_size in glyphs:
        number = outlines.setdefault(outline, len(outlines))
        x, y = size / 1000 * corner
        uses += (f'<use href="#@{number}" transform="translate({_number(x, 2)} {_number(y, 2)}) '
                 f'scale({_number(size * glyph_size / 1000, 5)})"/>')
    fade = f' opacity="{_number(opacity, 2)}"' if opacity < 1 else ''
    return f'<g class="{kind}"{fade} transform="translate({pair(place, 2)})">{motion}{uses}</g>'


@lru_cache(maxsize=None)
def typeset(text):
    """Set `text` in Computer Modern, 1000 units to the em, x right and y down from the start of the line.

    Returns a list of (outline as path data, corner, size) and corners.
    """
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import text_to_path

    placed, shapes, rules = text_to_path.get_glyphs_mathtext(FontProperties(family='cmr10', math_fontfamily='cm'), text)
    unit = 1000 / text_to_path.FONT_SCALE
    found = [(shapes[name], (x, y), size) for name, x, y, size in placed]
    found += [(rule, (0, 0), 1) for rule in rules]
    glyphs, ink = [], []
    for (vertices, codes), corner, size in found:
        if len(codes):
            flipped = np.array(vertices, dtype=float) * (unit, -unit)
            place = np.array(corner, dtype=float) * (unit, -unit)
            drawn = flipped[np.asarray(codes) != 79]
            ink += [place + size * drawn.min(axis=0), place + size * drawn.max(axis=0)]
            glyphs.append((_outline(flipped, codes), place, size))
    if not ink:
        raise ValueError(f'the text {text!r} has nothing to draw')
    corners = np.array([np.min(ink, axis=0), np.max(ink, axis=0)])
    middle = np.array((corners[:, 0].mean(), -220))
    return [(outline, place - middle, size) for outline, place, size in glyphs], corners - middle


def _outline(vertices, codes):
    """Return a glyph's path data with whole numbers relative to the last point, which is short."""
    data, last, k = '', np.zeros(2, dtype=int), 0
    while k < len(codes):
        letter, count = {1: ('m', 1), 2: ('l', 1), 3: ('q', 2), 4: ('c', 3), 79: ('z', 1)}[int(codes[k])]
        data += letter
        if letter == 'm':
            beginning = np.rint(vertices[k]).astype(int)
        if letter == 'z':
            last = beginning
        else:
            steps = np.rint(vertices[k:k + count]).astype(int)
            data += ''.join(f'{number:+d}' for number in (steps - last).ravel()).replace('+', ' ').strip()
            last = steps[-1]
        k += count
    return data


def _number(value, decimals):
    # The small shift keeps exact halves, which could be rounded either way, away from the rounding.
    return f'{round(float(value) + 3.1e-6, decimals) + 0.0:g}'


def pair(point, decimals, separator=' '):
    return separator.join(_number(value, decimals) for value in point)


def path_data(commands, points, decimals=2):
    """Return SVG path data: each command takes its own number of `points`."""
    data, k = '', 0
    for letter in commands:
        count = {'M': 1, 'L': 1, 'Q': 2, 'C': 3, 'Z': 0}[letter]
        data += letter + ' '.join(pair(point, decimals) for point in points[k:k + count])
        k += count
    return data


def _direction(vector):
    """Return the unit vector and the length; a zero vector stays zero."""
    vector = np.asarray(vector, dtype=float)
    length = np.linalg.norm(vector)
    return (vector / length if length > 1e-9 else 0 * vector), length


def _across(normal, radius):
    """Return two vectors of length `radius` at right angles to `normal` and to each other."""
    normal = _direction(normal)[0]
    first = _direction(np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))]))[0]
    return radius * first, radius * np.cross(normal, first)


def _ellipse(middle, u, v):
    """Return the commands and points of the ellipse with conjugate half diameters `u` and `v`."""
    middle, u, v, k = np.asarray(middle), np.asarray(u), np.asarray(v), 0.5523
    return 'MCCCCZ', middle + [u, u + k * v, v + k * u, v, v - k * u, k * v - u, -u,
                               -u - k * v, -v - k * u, -v, k * u - v, u - k * v, u]
