"""``from IPython.display import display, HTML, ...`` for code in the page."""

import base64

from . import get_ipython


def display(*values, **ignored):
    """Show each of ``values`` as the value of a cell's last line is shown."""
    for value in values:
        get_ipython().show(value)


def clear_output(wait=False):
    """Remove what the cell has displayed so far."""
    get_ipython().clear()


class _Content:
    def __init__(self, data):
        self.data = data


class HTML(_Content):
    def _repr_html_(self):
        return self.data


class Markdown(_Content):
    def _repr_markdown_(self):
        return self.data


class SVG(_Content):
    def _repr_svg_(self):
        return self.data


class Latex(_Content):
    def _repr_latex_(self):
        return self.data


class Math(_Content):
    def _repr_latex_(self):
        return "$\\displaystyle " + self.data.strip("$") + "$"


class Image(_Content):
    def _repr_png_(self):
        return base64.b64encode(self.data).decode()


class Code(_Content):
    """Code, shown without the colours of IPython, which need a package that the page lacks."""

    def __init__(self, data, language=None):
        import pygments  # noqa: F401 (not part of it: the error names what is missing)
