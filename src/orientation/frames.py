"""A graph of named frames that cannot go stale."""

from typing import NamedTuple

from ._types import Result, Values
from .axis_angle import dcm_from_axis_angle
from .comparison import same_orientation
from .direction_cosines import check_dcm, simple_dcm
from .euler_angles import dcm_from_body_fixed
from .numbers_and_symbols import is_symbolic, number_array, symbol_components
from .quaternions import dcm_from_quaternion


class _Turn(NamedTuple):
    """One factor of a product: a simple turn, or a matrix with the words that describe it."""

    axis: str | None
    angle: object
    matrix: object
    words: str

    def dcm(self):
        # A copy: what a reader does with the result must not change the frames.
        return simple_dcm(self.axis, self.angle) if self.axis else self.matrix.copy()

    def is_symbolic(self):
        return is_symbolic(self.angle) or is_symbolic(self.matrix)

    def batch(self):
        """Shape of the batch that this turn is, () for a single one."""
        if self.is_symbolic():
            return ()
        return getattr(self.angle, "shape", ()) if self.axis else self.matrix.shape[:-2]

    def back(self):
        if self.axis:
            return self._replace(angle=-self.angle)
        return self._replace(matrix=_transposed(self.matrix), words=self.words + r",\ \text{back}")


class _Edge(NamedTuple):
    frame: str
    reference: str
    turns: tuple

    def back(self):
        return _Edge(self.reference, self.frame, tuple(turn.back() for turn in reversed(self.turns)))


class Frames:
    r"""Named frames and the orientations between them.

    A ``Frames`` never changes: every ``orient_...`` method returns a new one with one orientation
    more, so running a notebook cell again gives the same answer again. Two frames are connected by one
    path at most; a second one, which could contradict the first, is an error.

    Examples
    --------
    >>> import sympy as sm
    >>> from orientation import Frames
    >>> psi, theta, phi = sm.symbols('psi, theta, varphi')
    >>> gimbal = (Frames()
    ...     .orient_axis('B', 'A', 'z', psi)
    ...     .orient_axis('C', 'B', 'x', theta)
    ...     .orient_axis('D', 'C', 'y', phi))
    >>> gimbal.dcm('C', 'A')
    Matrix([
    [            cos(psi),             sin(psi),          0],
    [-sin(psi)*cos(theta),  cos(psi)*cos(theta), sin(theta)],
    [ sin(psi)*sin(theta), -sin(theta)*cos(psi), cos(theta)]])
    >>> print(gimbal.path('D', 'A'))
    D - C - B - A
    """

    def __init__(self) -> None:
        self._edges: tuple[_Edge, ...] = ()

    def orient_axis(self, frame: str, reference: str, axis: str | Values, angle: Values) -> "Frames":
        r"""Return frames with ``frame`` turned in ``reference`` about one axis through ``angle``.

        Parameters
        ----------
        frame, reference : str
            Names, such as ``'A'`` and ``'N'``.
        axis : {'x', 'y', 'z'} or three components
            The unit vector that both frames share, or the direction of another axis.
        angle : SymPy expression, float or array of shape ``(...)``
            Radians.

        Raises
        ------
        ValueError
            If the two frames are connected already and not by this same orientation.
        """
        symbolic = is_symbolic((axis, angle))
        angle = _own(angle, (), "angle", symbolic)
        if isinstance(axis, str):
            simple_dcm(axis, angle)  # refuses what is not valid, before it is stored
            return self._with(frame, reference, _Turn(axis, angle, None, ""))
        axis = _own(axis, (3,), "axis", symbolic)
        words = rf"\text{{axis }}({', '.join(map(_latex, axis))}),\ {_latex(angle)}"
        return self._with(frame, reference, _Turn(None, None, dcm_from_axis_angle(axis, angle), words))

    def orient_body_fixed(self, frame: str, reference: str, angles: Values, sequence: str) -> "Frames":
        """Return frames with ``frame`` turned in ``reference`` by three body fixed turns.

        Parameters are those of :func:`orientation.dcm_from_body_fixed`.
        """
        dcm_from_body_fixed(angles, sequence)  # refuses what is not valid, before it is stored
        angles = _own(angles, (3,), "angles", is_symbolic(angles))
        if not is_symbolic(angles):
            angles = [angles[..., k] for k in range(3)]
        return self._with(frame, reference, *(_Turn(axis, angle, None, "") for axis, angle in zip(sequence, angles)))

    def orient_dcm(self, frame: str, reference: str, dcm: Values) -> "Frames":
        r"""Return frames with ``dcm`` as the matrix of ``frame`` with respect to ``reference``.

        With ``('A', 'N', A_C_N)`` the matrix is :math:`{}^A\mathbf{C}^N`; it is checked first.
        """
        check_dcm(dcm)
        symbolic = is_symbolic(dcm)
        dcm = _own(dcm, (3, 3), "dcm", symbolic)
        if symbolic:
            import sympy

            dcm = sympy.Matrix(3, 3, dcm)
        return self._with(frame, reference, _Turn(None, None, dcm, r"\text{matrix}"))

    def orient_quaternion(self, frame: str, reference: str, quaternion: Values) -> "Frames":
        """Return frames with ``frame`` turned in ``reference`` by a unit quaternion, scalar first."""
        return self._with(frame, reference, _Turn(None, None, dcm_from_quaternion(quaternion), r"\text{quaternion}"))

    def _with(self, frame, reference, *turns):
        for name in (frame, reference):
            if not isinstance(name, str) or not name.isidentifier():
                raise ValueError(f"a frame is named by a string such as 'A', not {name!r}")
        if frame == reference:
            raise ValueError(f"{frame} cannot be oriented with respect to itself")
        edge = _Edge(frame, reference, turns)
        edges = self._walk(frame, reference)
        if edges is None:
            new = Frames()
            new._edges = (*self._edges, edge)
            return new
        if len(edges) == 1 and _same(edge.turns, edges[0].turns):
            return self
        raise ValueError(
            f"{frame} and {reference} are already connected, by {self.path(frame, reference)}: a second "
            f"path could contradict the first. To change an orientation, build the frames anew"
        )

    def _walk(self, target, source):
        """Edges from the source to the target, each turned the way it is walked; None if there are none."""
        reached = {source: ()}
        waiting = [source]
        for name in waiting:
            for edge in self._edges:
                step = edge if edge.reference == name else edge.back() if edge.frame == name else None
                if step and step.frame not in reached:
                    reached[step.frame] = (*reached[name], step)
                    waiting.append(step.frame)
        return reached.get(target)

    def _edges_between(self, target, source):
        known = {name for edge in self._edges for name in (edge.frame, edge.reference)}
        for name in (target, source):
            if name not in known:
                raise ValueError(f"there is no frame {name!r} here; there are {', '.join(sorted(known)) or 'none'}")
        edges = self._walk(target, source)
        if edges is None:
            raise ValueError(f"no path of orientations connects {target} and {source}")
        return edges

    def path(self, target: str, source: str) -> str:
        """Return the frames from ``target`` to ``source`` as text, in the order of the matrices."""
        return " - ".join([*(edge.frame for edge in reversed(self._edges_between(target, source))), source])

    def dcm(self, target: str, source: str) -> Result:
        r"""Direction cosine matrix of ``target`` with respect to ``source``, over the path between them.

        ``frames.dcm('D', 'A')`` is :math:`{}^D\mathbf{C}^A`, as ``D.dcm(A)`` is in SymPy. Successive
        turns about one axis are joined to one turn before anything is multiplied.

        Raises
        ------
        ValueError
            If a name is unknown, no path connects the two, or the path holds batches of different
            shapes, or a batch and symbols.
        """
        turns = [turn for edge in self._edges_between(target, source) for turn in edge.turns]
        return _product(turns or [_Turn("x", self._zero(), None, "")])

    def _zero(self):
        """The angle of a frame in itself: of the kind that these frames hold."""
        symbols = [turn for edge in self._edges for turn in edge.turns if turn.is_symbolic()]
        if not symbols:
            return 0.0
        import sympy

        return sympy.Integer(0)

    def equation(self, target: str, source: str) -> "Equation":
        r"""Return :math:`{}^D\mathbf{C}^A` as the product over the path, each factor with its turns."""
        edges = self._edges_between(target, source)
        factors = [
            rf"\underbrace{{{_symbol(edge.frame, edge.reference)}}}_{{{_description(edge)}}}"
            for edge in reversed(edges)
        ]
        return Equation(f"{_symbol(target, source)} = " + r"\; ".join(factors or [r"\mathbf{I}"]))

    def reference_frames(self) -> Result:
        """Return a dictionary of new SymPy ``ReferenceFrame`` objects, oriented like these frames."""
        import sympy.physics.mechanics as me

        names = list(dict.fromkeys(name for edge in self._edges for name in (edge.reference, edge.frame)))
        frames = {name: me.ReferenceFrame(name) for name in names}
        done = set()
        for root in names:
            if root in done:
                continue
            for target in names:
                # SymPy forgets a frame's earlier orientations when it is oriented again, so each
                # frame is oriented once, on the way out from the root.
                for edge in self._walk(target, root) or ():
                    if edge.frame not in done:
                        _orient(frames[edge.frame], frames[edge.reference], edge)
                        done.add(edge.frame)
            done.add(root)
        return frames

    def __repr__(self) -> str:
        return f"Frames({', '.join(f'{edge.frame} in {edge.reference}' for edge in self._edges)})"


class Equation:
    """Typeset mathematics in a notebook; the TeX itself in a terminal."""

    def __init__(self, tex: str) -> None:
        self.tex = tex

    def _repr_latex_(self):
        return rf"$\displaystyle {self.tex}$"

    def __repr__(self) -> str:
        return self.tex


def _orient(frame, reference, edge):
    shapes = [turn.batch() for turn in edge.turns if turn.batch()]
    if shapes:
        raise ValueError(
            f"{edge.frame} in {edge.reference} is a batch of shape {shapes[0]}; a ReferenceFrame holds one orientation"
        )
    if len(edge.turns) == 1 and edge.turns[0].axis:
        (turn,) = edge.turns
        frame.orient_axis(reference, getattr(reference, turn.axis), turn.angle)
        return
    import sympy

    frame.orient_dcm(reference, sympy.Matrix(_product(edge.turns)))


def _own(value, item, name, symbolic):
    """The frames' own copy of what they were given: SymPy expressions or a float array."""
    if symbolic:
        components = symbol_components(value, item, name)
        return components if item else components[0]
    return number_array(value, item, name) + 0.0


def _same(turns, others):
    first, second = _product(turns), _product(others)
    return first.shape == second.shape and same_orientation(first, second)


def _transposed(matrix):
    return matrix.T if is_symbolic(matrix) else matrix.swapaxes(-1, -2)


def _product(turns):
    shapes = dict.fromkeys(turn.batch() for turn in turns if turn.batch())
    if shapes and any(turn.is_symbolic() for turn in turns):
        raise ValueError(
            "this path holds symbols and a batch of numbers: put numbers in for the symbols "
            "first, or one item for the batch"
        )
    if len(shapes) > 1:
        import numpy

        try:
            numpy.broadcast_shapes(*shapes)
        except ValueError:
            raise ValueError(
                f"the batches along this path do not fit each other: their shapes are {' and '.join(map(str, shapes))}"
            ) from None
    joined = []
    for turn in turns:
        if joined and turn.axis and turn.axis == joined[-1].axis:
            turn = turn._replace(angle=joined.pop().angle + turn.angle)
        joined.append(turn)
    matrices = [turn.dcm() for turn in joined]
    if any(map(is_symbolic, matrices)):
        import sympy

        matrices = [sympy.Matrix(matrix) for matrix in matrices]
    result = matrices[0]
    for matrix in matrices[1:]:
        result = matrix @ result
    return result


def _latex(value):
    if is_symbolic(value):
        import sympy

        return sympy.latex(value)
    return f"{value:.6g}" if not getattr(value, "ndim", 0) else r"\text{batch}"


def _symbol(target, source):
    target, source = (name.replace("_", r"\_") for name in (target, source))
    return rf"{{}}^{{{target}}}\mathbf{{C}}^{{{source}}}"


def _description(edge):
    return r";\ ".join(rf"{turn.axis},\ {_latex(turn.angle)}" if turn.axis else turn.words for turn in edge.turns)
