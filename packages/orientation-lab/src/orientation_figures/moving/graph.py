"""A graph of frames that the reader extends, and the matrix between any two of them."""

import math

import traitlets

from orientation.frames import Frames

from .figure import MovingFigure
from .state import Turns

LETTERS = "NABCDE"


class Edges(traitlets.TraitType):
    """One to five orientations: a new frame, its reference, an axis and an angle in radians."""

    def validate(self, obj, value):
        whole = isinstance(value, (list, tuple)) and 1 <= len(value) < len(LETTERS)
        if not whole or not all(
            isinstance(edge, (list, tuple)) and len(edge) == 4 for edge in value
        ):
            raise traitlets.TraitError(
                f"edges is {value!r}: expected one to five, each with a frame, its reference "
                "frame, an axis and an angle in radians, such as (('A', 'N', 'z', 0.7), "
                "('B', 'A', 'x', 0.5))"
            )
        known = ["N"]
        for frame, reference, *_ in value:
            if reference not in known:
                raise traitlets.TraitError(
                    f"edges orients {frame} in {reference}, but there is no frame {reference}; "
                    f"the frames are {known}"
                )
            if frame in known or frame not in LETTERS:
                raise traitlets.TraitError(
                    f"edges defines the frame {frame!r}: expected a new one, from "
                    f"{', '.join(LETTERS[1:])}"
                )
            known.append(frame)
        turns = Turns((), most=5)
        turns.name = self.name
        turns = turns.validate(obj, [(axis, angle) for _, _, axis, angle in value])
        return tuple(
            (frame, reference, *turn) for (frame, reference, *_), turn in zip(value, turns)
        )


class GraphFigure(MovingFigure):
    r"""A tree of frames, each rotated from another about a unit vector that both share.

    The reader adds frames, rotates them, and selects a matrix between any two. It is the product
    over the path from one to the other, with some factors transposed.

    Attributes
    ----------
    edges : tuple of one to five tuples
        ``(frame, reference, axis, angle)``: a new frame, an existing one, 'x', 'y' or 'z', and an
        angle in radians, from $-\pi$ to $\pi$. The first frame is ``'N'``.
    target, source : str
        The two frames whose matrix is shown.

    Examples
    --------
    >>> from orientation_figures.moving import GraphFigure
    >>> edges = [('A', 'N', 'z', 0.3), ('B', 'N', 'z', 0.5)]
    >>> figure = GraphFigure(edges=edges, target='B', source='A')
    >>> figure.path, figure.dcm[0, 1].round(6).item()
    ('B - N - A', 0.198669)
    """

    kind = "graph"
    sheet = (-180, -130, 180, 130)
    room = (513, 640)
    edges = Edges(
        (
            ("A", "N", "z", math.radians(35)),
            ("B", "N", "z", math.radians(-40)),
            ("C", "B", "x", math.radians(60)),
        )
    ).tag(sync=True, state=True)
    target = traitlets.Enum(tuple(LETTERS), "C").tag(sync=True, state=True)
    source = traitlets.Enum(tuple(LETTERS), "A").tag(sync=True, state=True)

    @traitlets.validate("edges", "target", "source")
    def _ends_are_there(self, proposal):
        now = {name: getattr(self, name) for name in ("edges", "target", "source")}
        now[proposal["trait"].name] = proposal["value"]
        known = ["N", *(edge[0] for edge in now["edges"])]
        for name in ("target", "source"):
            if now[name] not in known:
                raise traitlets.TraitError(
                    f"{name} is {now[name]}, but the frames are {', '.join(known)}"
                )
        return proposal["value"]

    @property
    def frames(self):
        """The graph as `orientation.Frames`."""
        frames = Frames()
        for edge in self.edges:
            frames = frames.orient_axis(*edge)
        return frames

    @property
    def dcm(self):
        """Direction cosine matrix of ``target`` with respect to ``source``, shape ``(3, 3)``."""
        return self.frames.dcm(self.target, self.source)

    @property
    def path(self):
        """The frames from ``target`` to ``source``, as a string."""
        return self.frames.path(self.target, self.source)
