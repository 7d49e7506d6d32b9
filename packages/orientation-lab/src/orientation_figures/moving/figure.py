"""The base of all interactive figures: a widget in Jupyter, a still on paper, and their state."""

import json
from difflib import get_close_matches
from html import escape
from importlib import import_module
from importlib.util import find_spec

import anywidget
import traitlets

from ..style import STYLE
from . import bundle


class MovingFigure(anywidget.AnyWidget):
    """A figure that the reader moves, in Jupyter and on the pages of the book.

    Its attributes and the figure are linked: setting an attribute moves the figure, and moving the
    figure sets the attribute and calls the functions registered by ``observe``. In Jupyter a kernel
    synchronises the two; a page of the book runs the same front end without one, in place of the
    still.

    A figure has a ``kind``, the name of its modules in ``js`` and in ``pictures``, and traits
    tagged ``state=True``. Traits tagged ``constant=True`` are constants that the front end needs.
    ``sheet`` gives left, top, right and bottom of the area of the drawing, in pixels from the
    origin, so that still and figure have the same size. ``room`` is the height of the whole figure
    in pixels, beside and below its controls, which a page reserves so that nothing moves.
    """

    kind = ""
    sheet = (-180, -160, 180, 160)
    room = (0, 0)

    _esm = traitlets.Unicode().tag(sync=True)
    _css = traitlets.Unicode().tag(sync=True)

    @traitlets.default("_esm")
    def _default_esm(self):
        return bundle.esm(self.kind)

    @traitlets.default("_css")
    def _default_css(self):
        return STYLE + bundle.style()

    def __init__(self, **attributes):
        computed = {name: attributes.pop(name) for name in self._settable() & set(attributes)}
        unknown = sorted(set(attributes) - set(self.trait_names()))
        # A widget would silently accept a misspelt name.
        if unknown:
            raise TypeError(self._without(unknown[0]))
        super().__init__(**attributes)
        for name, value in computed.items():
            setattr(self, name, value)

    def __setattr__(self, name, value):
        # The same applies later: a misspelt name would become an attribute that nothing shows.
        if not name.startswith("_") and not hasattr(type(self), name):
            raise AttributeError(self._without(name))
        super().__setattr__(name, value)

    def _without(self, name):
        """Return the message for a name that cannot be set, with the name probably meant."""
        names = sorted({*self.trait_names(state=True), *self._settable()})
        near = "".join(f" (did you mean {close}?)" for close in get_close_matches(name, names, 1))
        return f"{type(self).__name__} has no {name}{near}; you can set {', '.join(names)}"

    @classmethod
    def _settable(cls):
        """Return the names of computed properties that can nevertheless be set, as a matrix can."""
        own = [vars(ancestor) for ancestor in cls.__mro__ if issubclass(ancestor, MovingFigure)]
        return {
            name
            for attributes in own
            for name, value in attributes.items()
            if isinstance(value, property) and value.fset
        }

    def drawing(self):
        """Return the ``Drawing`` that represents the figure where it cannot move."""
        # Import these only here, because a still needs NumPy and Matplotlib, but the figure does
        # not.
        from .sheet import Sheet

        return import_module(f".pictures.{self.kind}", __package__).drawing(self, Sheet)

    def state(self):
        """Return the attributes that the figure shows, by name."""
        return {name: getattr(self, name) for name in sorted(self.trait_names(state=True))}

    def still(self):
        """Return the HTML for pages without a kernel: the still, and the state to start from."""
        svg = svg_on(self.sheet, self.drawing())
        values = {
            name: getattr(self, name) for name in self.trait_names(constant=True)
        } | self.state()
        state = escape(json.dumps(values, separators=(",", ":")), quote=False).replace("'", "&#39;")
        return (
            f'<figure class="orientation-figure moving" data-figure="{self.kind}" '
            f'style="--room-wide:{self.room[0]}px;--room-narrow:{self.room[1]}px" '
            f"data-state='{state}'>"
            f'<style>{STYLE}</style><div class="still">{svg}</div></figure>'
        )

    def _repr_mimebundle_(self, **kwargs):
        data, metadata = super()._repr_mimebundle_(**kwargs)
        return (data | {"text/html": self.still()} if stills_can_be_drawn() else data), metadata

    def __repr__(self):
        if stills_can_be_drawn():
            return f"{type(self).__name__}: {self.drawing().alt}"
        state = ", ".join(f"{name}={value!r}" for name, value in self.state().items())
        return f"{type(self).__name__}({state})"


def stills_can_be_drawn():
    """Check whether NumPy and Matplotlib are available."""
    # Look for them instead of importing them in vain. If they are missing, as in a browser, the
    # front end shows the figure without a still. If they are there, no error of a still must be
    # lost.
    try:
        return all(map(find_spec, ("numpy", "matplotlib")))
    except ModuleNotFoundError:
        # The Python of a page raises this if it could fetch them, but a still does not justify a
        # download.
        return False


def svg_on(sheet, drawing):
    """Return the SVG element of a drawing, as large as the sheet."""
    left, top, right, bottom = sheet
    # The drawing adds a margin of 8 pixels to these bounds.
    return drawing.svg(bounds=(left + 8, top + 8, right - 8, bottom - 8), enlarged=1.2)
