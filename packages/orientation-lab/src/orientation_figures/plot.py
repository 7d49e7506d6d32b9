"""Plots that follow the page: Matplotlib's curves, in the colours and typeface of the drawings."""

import hashlib
import io
import re
from html import escape
from xml.etree import ElementTree

from .style import LIGHT, STYLE

SVG = "{http://www.w3.org/2000/svg}"
LINK = "{http://www.w3.org/1999/xlink}href"

SETTINGS = {
    "svg.fonttype": "path",
    "mathtext.fontset": "cm",
    "font.family": "serif",
    "font.serif": ["cmr10"],
    "axes.formatter.use_mathtext": True,
    "axes.unicode_minus": False,
    "font.size": 13,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.linewidth": 0.6,
    "text.color": LIGHT["ink"],
    "axes.labelcolor": LIGHT["ink"],
    "axes.edgecolor": LIGHT["muted"],
    "xtick.color": LIGHT["muted"],
    "ytick.color": LIGHT["muted"],
    "grid.color": LIGHT["muted"],
    "grid.alpha": 0.25,
    "lines.linewidth": 1.9,
    "legend.frameon": False,
    "axes.facecolor": "none",
    "figure.facecolor": "none",
    "savefig.facecolor": "none",
}


# The largest width of a plot in pixels. A wide page shows it larger. On a phone of 380 pixels,
# which leaves 348 for it, its text is 11 pixels high.
SET = 411


class Plot:
    """Matplotlib axes, shown as inline SVG in the colours of the light or the dark page.

    Draw inside ``with Plot(...) as plot:``, where Matplotlib has the book's settings.

    Parameters
    ----------
    alt : str
        The text description: what the curves do. Required.
    width, height : float
        Size in pixels; on a narrow page the plot shrinks as a whole.
    rows : int
        Number of axes above each other, which share their horizontal axis.

    Attributes
    ----------
    axes : matplotlib Axes, or an array of them if there are more rows than one
    colours : dict
        The colour of each frame, of ``'ink'`` and of ``'muted'``, for Matplotlib's ``color``.

    Raises
    ------
    ValueError
        If `alt` has fewer than 40 characters.
    """

    def __init__(self, alt, width=560, height=330, rows=1):
        import matplotlib
        from matplotlib.figure import Figure

        if len(alt.strip()) < 40:
            raise ValueError(
                f"alt has only {len(alt.strip())} characters; a description needs at least 40. "
                "Name the axes and the curves, and say what they show"
            )
        self.alt, self.colours, self.width = alt.strip(), LIGHT, width
        with matplotlib.rc_context(SETTINGS):
            # Typeset it smaller than it is shown, so that its text is still legible when a phone
            # shrinks the whole.
            size = [round(min(0.8, SET / width) * length) / 72 for length in (width, height)]
            self.figure = Figure(figsize=size, layout="constrained")
            self.axes = self.figure.subplots(rows, sharex=True)

    def __enter__(self):
        import matplotlib

        self._settings = matplotlib.rc_context(SETTINGS)
        self._settings.__enter__()
        return self

    def __exit__(self, *error):
        return self._settings.__exit__(*error)

    def _repr_html_(self):
        import matplotlib

        buffer = io.StringIO()
        with matplotlib.rc_context({**SETTINGS, "svg.hashsalt": self.alt}):
            self.figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None})
        # Every ID contains the name of its plot, so that two plots on one page cannot clash.
        name = "p" + hashlib.sha256(self.alt.encode()).hexdigest()[:8]
        root = ElementTree.fromstring(buffer.getvalue())
        _lighten(root, name)
        svg = "".join(ElementTree.tostring(child, "unicode") for child in root)
        svg = svg.replace(' xmlns:ns0="http://www.w3.org/2000/svg"', "").replace("ns0:", "")
        for frame, colour in LIGHT.items():
            svg = svg.replace(colour, f"var(--{frame})")
        svg = (
            f'<svg viewBox="{root.get("viewBox")}" role="img" aria-label="{escape(self.alt)}" '
            f'style="max-width:{self.width}px;stroke:none;stroke-linecap:butt">{svg}</svg>'
        )
        return f'<figure class="orientation-figure"><style>{STYLE}</style>{svg}</figure>'

    def __repr__(self):
        return f"Plot: {self.alt}"


def _lighten(root, name):
    """Remove the invisible parts of Matplotlib's drawing, which would be most of its size.

    Numbers keep a tenth of a pixel along curves and a hundredth elsewhere. Unused IDs, groups
    without a meaning, invisible frames and the document's own style are removed. The remaining IDs
    begin with `name`.
    """
    # Matplotlib's style applies to every element of a page, and would remove the round ends of
    # lines from all drawings.
    for child in list(root):
        if child.tag == f"{SVG}metadata" or child.find(f"{SVG}style") is not None:
            root.remove(child)
    text = ElementTree.tostring(root, "unicode")
    used = dict.fromkeys(re.findall(r'(?:href="#|url\(#)([^")]+)', text))
    short = {old: f"{name}-{number}" for number, old in enumerate(used)}
    for element in root.iter():
        element.text = element.tail = None
        old = element.attrib.pop("id", None)
        if old in short:
            element.set("id", short[old])
        # The prefix has no meaning in a page.
        if LINK in element.attrib:
            element.set("href", "#" + short[element.attrib.pop(LINK)[1:]])
        for key, value in element.attrib.items():
            if key == "d":
                value = _short_path(value)
            elif key in ("x", "y", "width", "height", "transform"):
                # Keep all digits of scales and rotations.
                value = re.sub(r"^-?[\d.]+$|translate\([^)]*\)", _shorter, value)
            elif key == "style":
                value = re.sub(r"([:;]) ", r"\1", value)
            elif key == "clip-path":
                value = f"url(#{short[value[5:-1]]})"
            element.set(key, value)
    _drop_shells(root)


def _drop_shells(element):
    """Remove paths that draw nothing, and replace groups without attributes by their children."""
    for child in list(element):
        _drop_shells(child)
        place = list(element).index(child)
        invisible = (
            child.tag == f"{SVG}path"
            and child.get("style") == "fill:none"
            and "id" not in child.attrib
        )
        if invisible or child.tag == f"{SVG}g" and not (child.attrib and len(child)):
            element[place : place + 1] = [] if invisible else list(child)


def _short(number, digits):
    """Return the number with at most ``digits`` decimals, without redundant zeros."""
    text = f"{number:.{digits}f}"
    text = text.rstrip("0").rstrip(".")
    return re.sub(r"^(-?)0\.", r"\1.", text) if text not in ("-0", "-") else "0"


def _shorter(numbers):
    """Return the text of a match with each of its numbers rounded to a hundredth."""
    return re.sub(r"-?\d+\.\d+", lambda number: _short(float(number[0]), 2), numbers[0])


def _short_path(path):
    """Return the path in relative steps, whose rounding errors do not accumulate."""
    tokens = re.findall(r"[A-Za-z]|-?[\d.]+(?:e-?\d+)?", path)
    digits = 1 if len(tokens) > 150 else 2
    here, start, place, letter, steps = [0.0, 0.0], [0.0, 0.0], 0, "", []
    while place < len(tokens):
        if tokens[place].isalpha():
            letter, place = tokens[place], place + 1
        if letter == "z":
            steps, here = [*steps, ("z", [])], list(start)
            continue
        # Matplotlib writes only absolute coordinates.
        size = {"M": 2, "L": 2, "Q": 4, "C": 6}[letter]
        step = [
            round(float(token) - here[k % 2], digits)
            for k, token in enumerate(tokens[place : place + size])
        ]
        place += size
        here = [here[0] + step[-2], here[1] + step[-1]]
        if letter == "M":
            start = list(here)
        if (
            letter == "L"
            and steps
            and steps[-1][0] == "L"
            and any(_along(step, steps[-1][1], k) for k in (0, 1))
        ):
            step = [sum(both) for both in zip(step, steps.pop()[1])]
        steps.append((letter, step))
    text = ""
    for (letter, step), (before, _) in zip(steps, [("", []), *steps], strict=False):
        # A repeated letter can be left out, and a minus sign separates two numbers as well as a
        # space.
        written = "" if letter == before != "M" else letter.lower() if text else letter
        numbers = " ".join(_short(value, digits) for value in step).replace(" -", "-")
        text += written + (" " if not written and not numbers.startswith("-") else "") + numbers
    return text


def _along(step, before, axis):
    """Check whether two steps along one axis have the same direction, and so can be merged."""
    return step[1 - axis] == before[1 - axis] == 0 and step[axis] * before[axis] >= 0
