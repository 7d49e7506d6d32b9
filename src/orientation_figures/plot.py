"""Plots that follow the page: Matplotlib's curves, in the colours and typeface of the drawings."""

import hashlib
import io
import re
from html import escape

from .style import LIGHT, STYLE

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
    "lines.linewidth": 2.2,
    "legend.frameon": False,
    "axes.facecolor": "none",
    "figure.facecolor": "none",
    "savefig.facecolor": "none",
}


class Plot:
    """One or more Matplotlib axes, shown as inline SVG in the colours of the light or the dark page.

    Draw inside ``with Plot(...) as plot:``, where Matplotlib has the book's settings.

    Parameters
    ----------
    alt : str
        The text that stands for the picture: it says what the curves do. Required.
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
                f"alt has {len(alt.strip())} characters; a text that can stand for the "
                "picture needs at least 40: name the axes, the curves and what they show"
            )
        self.alt, self.colours, self.width = alt.strip(), LIGHT, width
        with matplotlib.rc_context(SETTINGS):
            # A pixel of the page is a point of Matplotlib's, so that sizes in text agree.
            self.figure = Figure(figsize=(width / 72, height / 72), layout="constrained")
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
        svg = buffer.getvalue().replace("xlink:href", "href")  # in a page the prefix has no meaning
        svg = re.sub(r"<metadata>.*?</metadata>", "", svg[svg.index("<svg") :], flags=re.DOTALL)
        # Matplotlib's style is for every element of a page: it would take the round ends of lines from all drawings.
        svg = re.sub(r" <defs>\s*<style[^>]*>[^<]*</style>\s*</defs>\n", "", svg)
        for name, colour in LIGHT.items():
            svg = svg.replace(colour, f"var(--{name})")
        # Every id carries a name of its own: two plots on one page cannot clash.
        name = "p" + hashlib.sha256(self.alt.encode()).hexdigest()[:8]
        svg = re.sub(r'(id="|href="#|url\(#)', rf"\g<1>{name}-", svg)
        svg = re.sub(
            r'<svg .*?viewBox="([^"]*)"[^>]*>',
            rf'<svg viewBox="\1" role="img" aria-label="{escape(self.alt)}" '
            rf'style="max-width:{self.width}px;stroke:none;stroke-linecap:butt">',
            svg,
            count=1,
            flags=re.DOTALL,
        )
        return f'<figure class="orientation-figure"><style>{STYLE}</style>{svg}</figure>'

    def __repr__(self):
        return f"Plot: {self.alt}"
