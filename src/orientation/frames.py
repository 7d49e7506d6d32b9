"""A graph of named frames that cannot go stale."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from .axis_angle import dcm_from_axis_angle
from .comparison import same_orientation
from .direction_cosines import check_dcm, simple_dcm
from .euler_angles import dcm_from_body_fixed, dcm_from_space_fixed
from .numbers_and_symbols import is_symbolic, number_array, symbol_components
from .quaternions import dcm_from_quaternion
from .rotation_vector import dcm_from_rotation_vector
from .scipy_border import dcm_from_scipy_rotation

if TYPE_CHECKING:
    import sympy
    from scipy.spatial.transform import Rotation
    from sympy.physics.mechanics import ReferenceFrame

    from ._types import Array, Axis, AxisSequence, Matrix, Symbolic, Values


#: One angle, or those of a batch.
Angle: TypeAlias = "float | Array | sympy.Expr"


class _AxisTurn(NamedTuple):
    """One factor of a product: a simple rotation."""

    axis: str
    angle: Angle

    def dcm(self) -> Array | Matrix:
        return simple_dcm(self.axis, self.angle)  # type: ignore[call-overload, no-any-return]

    def is_symbolic(self) -> bool:
        return is_symbolic(self.angle)

    def batch(self) -> tuple[int, ...]:
        """The shape of the batch of this rotation, () for a single one."""
        return getattr(self.angle, "shape", ())

    def back(self) -> _AxisTurn:
        return self._replace(angle=-self.angle)

    def subs(self, values: Mapping[Symbolic, object]) -> _AxisTurn:
        import sympy

        return self._replace(angle=sympy.sympify(self.angle).subs(values))

    def described(self) -> str:
        return rf"{self.axis},\ {_latex(self.angle)}"


class _MatrixTurn(NamedTuple):
    """One factor of a product: a matrix, with the words that describe it."""

    matrix: Array | Matrix
    words: str

    def dcm(self) -> Array | Matrix:
        # Return a copy, so that changes to the result do not change the frames.
        return self.matrix.copy()

    def is_symbolic(self) -> bool:
        return is_symbolic(self.matrix)

    def batch(self) -> tuple[int, ...]:
        """The shape of the batch of this rotation, () for a single one."""
        return self.matrix.shape[:-2]

    def back(self) -> _MatrixTurn:
        transposed = self.matrix.T if self.is_symbolic() else self.matrix.swapaxes(-1, -2)
        return _MatrixTurn(transposed, self.words + r",\ \text{back}")

    def subs(self, values: Mapping[Symbolic, object]) -> _MatrixTurn:
        import sympy

        return self._replace(matrix=sympy.Matrix(self.matrix).subs(values))

    def described(self) -> str:
        return self.words


_Turn: TypeAlias = _AxisTurn | _MatrixTurn


class _Edge(NamedTuple):
    frame: str
    reference: str
    turns: tuple[_Turn, ...]

    def back(self) -> _Edge:
        return _Edge(
            self.reference, self.frame, tuple(turn.back() for turn in reversed(self.turns))
        )


class Frames:
    r"""Named frames and the orientations between them.

    A ``Frames`` never changes. Every ``orient_...`` method returns a new one with one more
    orientation, so running a notebook cell again gives the same answer again. Two frames are
    connected by one path at most; a second one, which could contradict the first, is an error.

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
        # The edges at each frame, directed away from it, so that a path is quick to find.
        self._leaving: dict[str, tuple[_Edge, ...]] = {}

    @property
    def names(self) -> tuple[str, ...]:
        """The names of all frames, in the order of their definition."""
        return tuple(self._leaving)

    def orient_axis(self, frame: str, reference: str, axis: Axis | Values, angle: Values) -> Frames:
        r"""Return frames with ``frame`` rotated in ``reference`` about one axis through ``angle``.

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
        (own_angle,) = _own(angle, (), "angle", symbolic)
        if isinstance(axis, str):
            # Refuse invalid input before storing it.
            _AxisTurn(axis, own_angle).dcm()
            return self._with(frame, reference, _AxisTurn(axis, own_angle))
        own_axis = _own(axis, (3,), "axis", symbolic)
        words = rf"\text{{axis }}({', '.join(map(_latex, own_axis))}),\ {_latex(own_angle)}"
        return self._with(frame, reference, _MatrixTurn(dcm_from_axis_angle(axis, angle), words))

    def orient_body_fixed(
        self, frame: str, reference: str, angles: Values, sequence: AxisSequence
    ) -> Frames:
        """Return frames with ``frame`` rotated in ``reference`` by three body fixed rotations.

        Parameters are those of `orientation.dcm_from_body_fixed`.
        """
        # Refuse invalid input before storing it.
        dcm_from_body_fixed(angles, sequence)
        own = _own(angles, (3,), "angles", is_symbolic(angles))
        return self._with(
            frame, reference, *(_AxisTurn(axis, angle) for axis, angle in zip(sequence, own))
        )

    def orient_dcm(self, frame: str, reference: str, dcm: Values) -> Frames:
        r"""Return frames with ``dcm`` as the matrix of ``frame`` with respect to ``reference``.

        With ``('A', 'N', A_C_N)`` the matrix is ${}^A\mathbf{C}^N$; it is checked first.
        """
        check_dcm(dcm)
        own: Array | Matrix
        if is_symbolic(dcm):
            import sympy

            own = sympy.Matrix(3, 3, symbol_components(dcm, (3, 3), "dcm"))
        else:
            own = number_array(dcm, (3, 3), "dcm") + 0.0
        return self._with(frame, reference, _MatrixTurn(own, r"\text{matrix}"))

    def orient_quaternion(self, frame: str, reference: str, quaternion: Values) -> Frames:
        """Return frames with ``frame`` rotated in ``reference`` by a unit quaternion.

        Its scalar part comes first.
        """
        return self._with(
            frame, reference, _MatrixTurn(dcm_from_quaternion(quaternion), r"\text{quaternion}")
        )

    def orient_space_fixed(
        self, frame: str, reference: str, angles: Values, sequence: AxisSequence
    ) -> Frames:
        """Return frames with ``frame`` rotated in ``reference`` about fixed axes.

        Parameters are those of `orientation.dcm_from_space_fixed`.
        """
        # Refuse invalid input before storing it.
        dcm_from_space_fixed(angles, sequence)
        own = _own(angles, (3,), "angles", is_symbolic(angles))
        # Rotations about fixed axes are body fixed rotations in reverse order.
        return self._with(frame, reference, *map(_AxisTurn, sequence[::-1], own[::-1]))

    def orient_rotation_vector(self, frame: str, reference: str, vector: Values) -> Frames:
        """Return frames with ``frame`` rotated in ``reference`` by a rotation vector in radians."""
        return self._with(
            frame,
            reference,
            _MatrixTurn(dcm_from_rotation_vector(vector), r"\text{rotation vector}"),
        )

    def orient_scipy_rotation(self, frame: str, reference: str, rotation: Rotation) -> Frames:
        """Return frames with ``frame`` rotated in ``reference`` by a SciPy ``Rotation``.

        It converts components along ``frame`` to components along ``reference``, as for
        `orientation.dcm_from_scipy_rotation`.
        """
        return self._with(
            frame,
            reference,
            _MatrixTurn(dcm_from_scipy_rotation(rotation), r"\text{SciPy rotation}"),
        )

    def without(self, frame: str, reference: str) -> Frames:
        """Return frames without the orientation that connects these two, to give another one.

        Raises
        ------
        ValueError
            If no single orientation connects them.
        """
        edges = self._edges_between(frame, reference)
        if len(edges) != 1:
            raise ValueError(
                f"no orientation connects {frame} and {reference} directly; the path is "
                f"{self.path(frame, reference)}"
            )
        left = (edge for edge in self._edges if {edge.frame, edge.reference} != {frame, reference})
        return functools.reduce(Frames._and, left, Frames())

    def subs(self, values: Mapping[Symbolic, object]) -> Frames:
        """Return frames with values in place of symbols, as SymPy's ``subs`` does."""
        substituted = (
            edge._replace(
                turns=tuple(
                    turn.subs(values) if turn.is_symbolic() else turn for turn in edge.turns
                )
            )
            for edge in self._edges
        )
        return functools.reduce(Frames._and, substituted, Frames())

    def _and(self, edge: _Edge) -> Frames:
        """Return frames with one more edge, between two frames that no path connects."""
        new = Frames()
        new._edges = (*self._edges, edge)
        new._leaving = dict(self._leaving)
        for step in (edge, edge.back()):
            new._leaving[step.reference] = (*new._leaving.get(step.reference, ()), step)
        return new

    def _with(self, frame: str, reference: str, *turns: _Turn) -> Frames:
        for name in (frame, reference):
            if not isinstance(name, str) or not name.strip():
                raise ValueError(f"the name of a frame must be a string such as 'A', not {name!r}")
        if frame == reference:
            raise ValueError(f"{frame} cannot be oriented with respect to itself")
        edge = _Edge(frame, reference, turns)
        edges = self._walk(frame, reference)
        if edges is None:
            return self._and(edge)
        if len(edges) == 1 and _same(edge.turns, edges[0].turns):
            return self
        raise ValueError(
            f"{frame} and {reference} are already connected, by {self.path(frame, reference)}: a "
            "second path could contradict the first. "
            "To change an orientation, build the frames again"
        )

    def _walk(self, target: str, source: str) -> tuple[_Edge, ...] | None:
        """Return the edges from the source to the target, each in that direction, or None."""
        reached: dict[str, tuple[_Edge, ...]] = {source: ()}
        waiting = [source]
        for name in waiting:
            for step in self._leaving.get(name, ()):
                if step.frame not in reached:
                    reached[step.frame] = (*reached[name], step)
                    waiting.append(step.frame)
        return reached.get(target)

    def _edges_between(self, target: str, source: str) -> tuple[_Edge, ...]:
        for name in (target, source):
            if name not in self._leaving:
                known = (
                    f"it has {', '.join(sorted(self.names))}" if self.names else "it is still empty"
                )
                raise ValueError(f"no frame named {name!r} in this Frames(): {known}")
        edges = self._walk(target, source)
        if edges is None:
            raise ValueError(
                f"no path of orientations connects {target} and {source}. First orient one of them "
                "with respect to the other, or to a frame connected to it"
            )
        return edges

    def path(self, target: str, source: str) -> str:
        """Return the frames from ``target`` to ``source`` as text, in the order of the matrices."""
        return " - ".join(
            [*(edge.frame for edge in reversed(self._edges_between(target, source))), source]
        )

    def dcm(self, target: str, source: str) -> Array | Matrix:
        r"""Direction cosine matrix of ``target`` with respect to ``source``, over their path.

        ``frames.dcm('D', 'A')`` is ${}^D\mathbf{C}^A$, as ``D.dcm(A)`` is in SymPy. Successive
        rotations about one axis are combined before anything is multiplied.

        Raises
        ------
        ValueError
            If a name is unknown, no path connects the two, or the path holds batches of different
            shapes, or a batch and symbols.
        """
        turns = [turn for edge in self._edges_between(target, source) for turn in edge.turns]
        return _product(turns or [_AxisTurn("x", self._zero())])

    def express(self, vector: Values, target: str, source: str) -> Array | Matrix:
        r"""Components of a vector along ``target``, from those along ``source``.

        $$
        [\mathbf{v}]_A = {}^A\mathbf{C}^N\,[\mathbf{v}]_N
        $$

        Parameters
        ----------
        vector : SymPy expressions, or array of shape ``(3,)`` or ``(..., 3)``
        target, source : str

        Returns
        -------
        SymPy column of three, or array of shape ``(..., 3)``

        Raises
        ------
        ValueError
            As `Frames.dcm`.
        """
        dcm = self.dcm(target, source)
        if is_symbolic(vector) or is_symbolic(dcm):
            import sympy

            return sympy.Matrix(dcm) * sympy.Matrix(symbol_components(vector, (3,), "vector"))
        components: Array = (dcm @ number_array(vector, (3,), "vector")[..., None])[..., 0]
        return components

    def __eq__(self, other: object) -> bool:
        """Check whether the same pairs of frames are connected by the same orientations."""
        if not isinstance(other, Frames):
            return NotImplemented
        pairs, others = (
            {frozenset((edge.frame, edge.reference)) for edge in frames._edges}
            for frames in (self, other)
        )
        return pairs == others and all(
            _same(edge.turns, other._edges_between(edge.frame, edge.reference)[0].turns)
            for edge in self._edges
        )

    # Frames are equal if their numbers agree up to rounding, and no hash agrees with that.
    __hash__ = None  # type: ignore[assignment]

    def _zero(self) -> Angle:
        """Return the angle of a frame relative to itself, of the kind that these frames contain."""
        if not any(turn.is_symbolic() for edge in self._edges for turn in edge.turns):
            return 0.0
        import sympy

        return sympy.Integer(0)  # type: ignore[no-any-return]

    def equation(self, target: str, source: str) -> Equation:
        r"""Return the matrix as the product over the path, each factor with its rotations."""
        edges = self._edges_between(target, source)
        factors = [
            rf"\underbrace{{{_symbol(edge.frame, edge.reference)}}}_{{{_description(edge)}}}"
            for edge in reversed(edges)
        ]
        return Equation(f"{_symbol(target, source)} = " + r"\; ".join(factors or [r"\mathbf{I}"]))

    def reference_frames(self) -> dict[str, ReferenceFrame]:
        """Return a dictionary of new SymPy ``ReferenceFrame`` objects, oriented like these."""
        import sympy.physics.mechanics as me

        names = list(
            dict.fromkeys(name for edge in self._edges for name in (edge.reference, edge.frame))
        )
        frames = {name: me.ReferenceFrame(name) for name in names}
        done: set[str] = set()
        for root in names:
            if root in done:
                continue
            for target in names:
                # SymPy forgets a frame's earlier orientations when the frame is oriented again, so
                # orient each frame once, starting from the root.
                for edge in self._walk(target, root) or ():
                    if edge.frame not in done:
                        _orient(frames[edge.frame], frames[edge.reference], edge)
                        done.add(edge.frame)
        return frames

    def __repr__(self) -> str:
        return f"Frames({', '.join(f'{edge.frame} in {edge.reference}' for edge in self._edges)})"


class Equation:
    """Typeset mathematics in a notebook; the TeX itself in a terminal."""

    def __init__(self, tex: str) -> None:
        self.tex = tex

    def _repr_latex_(self) -> str:
        return rf"$\displaystyle {self.tex}$"

    def __repr__(self) -> str:
        return self.tex


def _orient(frame: ReferenceFrame, reference: ReferenceFrame, edge: _Edge) -> None:
    shapes = [turn.batch() for turn in edge.turns if turn.batch()]
    if shapes:
        raise ValueError(
            f"{edge.frame} in {edge.reference} is a batch of shape {shapes[0]}, but a "
            "ReferenceFrame holds one orientation"
        )
    turn, *others = edge.turns
    if not others and isinstance(turn, _AxisTurn):
        frame.orient_axis(reference, getattr(reference, turn.axis), turn.angle)
        return
    import sympy

    frame.orient_dcm(reference, sympy.Matrix(_product(edge.turns)))


def _own(value: Values, item: tuple[int, ...], name: str, symbolic: bool) -> Sequence[Angle]:
    """Return the frames' own copy of the given components.

    They are SymPy expressions, or the columns of a float array.
    """
    if symbolic:
        return symbol_components(value, item, name)
    array = number_array(value, item, name) + 0.0
    return [array[..., k] for k in range(*item)] if item else [array]


def _same(turns: Sequence[_Turn], others: Sequence[_Turn]) -> bool:
    first, second = _product(turns), _product(others)
    return first.shape == second.shape and same_orientation(first, second)


def _product(turns: Sequence[_Turn]) -> Array | Matrix:
    shapes = dict.fromkeys(turn.batch() for turn in turns if turn.batch())
    if shapes and any(turn.is_symbolic() for turn in turns):
        raise ValueError(
            "this path has both symbols and a batch of numbers. First substitute numbers for the "
            "symbols, or choose one item of the batch"
        )
    if shapes:
        import numpy

        try:
            numpy.broadcast_shapes(*shapes)
        except ValueError:
            raise ValueError(
                "the batches along this path have incompatible shapes: "
                f"{' and '.join(map(str, shapes))}"
            ) from None
    joined: list[_Turn] = []
    for turn in turns:
        before = joined[-1] if joined else None
        if (
            isinstance(turn, _AxisTurn)
            and isinstance(before, _AxisTurn)
            and turn.axis == before.axis
        ):
            joined[-1] = _AxisTurn(turn.axis, before.angle + turn.angle)
        else:
            joined.append(turn)
    matrices = [turn.dcm() for turn in joined]
    if any(map(is_symbolic, matrices)):
        import sympy

        matrices = [sympy.Matrix(matrix) for matrix in matrices]
    result = matrices[0]
    for matrix in matrices[1:]:
        result = matrix @ result
    return result


def _latex(value: Angle) -> str:
    if is_symbolic(value):
        import sympy

        return str(sympy.latex(value))
    return f"{value:.6g}" if not getattr(value, "ndim", 0) else r"\text{batch}"


def _symbol(target: str, source: str) -> str:
    target, source = (
        name.replace("_", r"\_") if name.isidentifier() else rf"\text{{{name}}}"
        for name in (target, source)
    )
    return rf"{{}}^{{{target}}}\mathbf{{C}}^{{{source}}}"


def _description(edge: _Edge) -> str:
    return r";\ ".join(turn.described() for turn in edge.turns)
