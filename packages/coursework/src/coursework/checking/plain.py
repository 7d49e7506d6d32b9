"""Answers as plain data, the only data that a check reads or that leaves a student's process.

An answer may be a SymPy expression, a matrix, a reference frame, a vector, a NumPy array, a list or
a string. Here it becomes a table of numbers, names and operations that JSON can represent:

``{'value': value, 'nodes': [node, ...]}``

``value`` is ``['blank']``, ``['text', t]``, ``['truth', b]``, ``['expression', k]``, ``['matrix',
rows, columns, [k, ...]]``, ``['list', [value, ...]]``, ``['frame', name, {other: value, ...}]``
(its direction cosine matrix with respect to each frame it is connected to), ``['frames', {target:
{source: value, ...}, ...}]``, ``['vector', {frame: value, ...}]`` (its components in each frame) or
``['function', [value or ['raised', t] or ['printed', t], ...], b]``, where ``b`` says whether its
body computes anything. Each ``k`` is an index into ``nodes``; a node is ``['integer', digits]``,
``['rational', p, q]``, ``['float', digits]``, ``['symbol', name]``, ``['constant', name]`` or
``[operation, k, ...]``, and refers only to earlier nodes.

A repeated subexpression is written once, so the table is as large as the work that made the answer
and not as the printed tree. Nothing is simplified. Reading such a table, unlike unpickling or
``sympify``, runs no code that a student wrote.
"""

import contextlib
import dis
import functools
import inspect
import io
import json
import math
import numbers
import operator
import re
import sys
import unicodedata
from collections.abc import Callable, Iterable, Iterator, KeysView, Sequence, ValuesView
from types import FrameType, ModuleType
from typing import Protocol, TypeAlias, TypedDict, TypeGuard, cast

import mpmath
import sympy
from mpmath import libmp
from sympy.core.function import AppliedUndef
from sympy.logic.boolalg import BooleanAtom

from .units import BASE

#: Largest number of nodes of one answer, and of parts of a list.
MOST_NODES = 60_000
MOST_PARTS = 400
# Longest string, longest integer (in digits) and deepest list that are read.
LONGEST_TEXT = 2_000
LONGEST_INTEGER = 400
DEEPEST = 6

# The allowed function calls for evaluating one part of an answer (a derivative, an integral): about
# a second. Calls are counted instead of time, so that every machine decides alike, also in a
# browser.
MOST_CALLS = 400_000

VALUES = (
    "blank",
    "text",
    "truth",
    "expression",
    "matrix",
    "list",
    "frame",
    "frames",
    "vector",
    "function",
    "raised",
    "printed",
)


# A step of the computation: a number, a name, or an operation with the indices of its operands.
Node: TypeAlias = list[str | int]
# An answer: the name of its form, and the content of that form.
Value: TypeAlias = list[
    "str | int | list[int] | list[Value] | dict[str, Value] | dict[str, dict[str, Value]]"
]
#: Rows, columns and entries of a matrix, each entry a node.
Entries: TypeAlias = tuple[int, int, list[int]]


class Plain(TypedDict):
    """An answer as plain data."""

    value: Value
    nodes: list[Node]


def operands(node: Node) -> list[int]:
    """Return the operands of an operation, as nodes."""
    return cast(list[int], node[1:])


def parts_of(value: Value) -> list[Value]:
    """Return the parts of a list, or the results of a function."""
    return cast(list[Value], value[1])


def node_of(value: Value) -> int:
    """Return the node of an expression."""
    return cast(int, value[1])


def text_of(value: Value) -> str:
    """Return the content of a string, or the printed or raised text."""
    return cast(str, value[1])


def entries_of(value: Value) -> list[int]:
    """Return the nodes of the entries of a matrix, row by row."""
    return cast(list[int], value[3])


def size_of(value: Value) -> tuple[int, int]:
    """Return the rows and columns of a matrix."""
    return cast(tuple[int, int], tuple(value[1:3]))


def by_frame(value: Value) -> dict[str, Value]:
    """Return the matrices of a reference frame, or the components of a vector, by frame."""
    return cast(dict[str, Value], value[-1])


class Array(Protocol):
    """The interface of NumPy's arrays and of their stand-ins."""

    shape: tuple[int, ...]

    def tolist(self) -> object: ...


class CoordinateFrame(Protocol):
    """A reference frame of SymPy, and the frames relative to which it was oriented."""

    name: str
    _dcm_dict: dict["CoordinateFrame", object]


class Edge(Protocol):
    frame: str
    reference: str


class FrameGraph(Protocol):
    """The frames of the book's own graph."""

    _edges: Iterable[Edge]

    def dcm(self, target: str, source: str) -> object: ...


class NotPlain(ValueError):
    """An error for an answer that cannot be read; the message explains why to the student."""


class TooMuchWork(BaseException):
    """Evaluating a part took too many calls.

    This is no Exception, so that SymPy does not catch it.
    """


@contextlib.contextmanager
def limited_work(most: int = MOST_CALLS) -> Iterator[None]:
    """Stop slow work by counting the calls that it makes, without signals or threads.

    Raises
    ------
    TooMuchWork
    """
    left = most

    def count(frame: FrameType, event: str, argument: object) -> None:
        nonlocal left
        left -= 1
        if left < 0:
            raise TooMuchWork

    before = sys.gettrace()
    sys.settrace(count)
    try:
        yield
    finally:
        sys.settrace(before)


def to_plain(
    answer: object, calls: Sequence[Sequence[object]] | None = None, raise_missing: bool = False
) -> Plain:
    """Return an answer as plain data.

    Parameters
    ----------
    answer : object
        The student's value. ``...`` and ``None`` are blanks.
    calls : list of lists, optional
        For a question that asks for a function: the arguments of each call, already of the type
        that the function takes. The results, and errors, of the calls are the answer.
    raise_missing : bool
        Whether to raise the error of a missing package, so that the caller can load the package (a
        page fetches NumPy) and try again; otherwise it counts as the answer's own.

    Raises
    ------
    NotPlain
        The answer is of a kind that no question asks for, or too large to read.
    """
    try:
        return _Writer(raise_missing).plain(answer, calls)
    except NotPlain:
        raise
    except RecursionError:
        raise NotPlain("The answer is nested too deeply to read. Simplify it.") from None
    except Exception as error:
        if raise_missing and isinstance(error, ModuleNotFoundError):
            raise
        raise NotPlain(
            f"An answer of type `{type(answer).__name__[:40]}` could not be read "
            f"({type(error).__name__}). "
            "Give a SymPy expression, a matrix, a list of numbers or a string."
        ) from None


def arguments_of(calls: Sequence[Sequence[object]], takes: str) -> list[list[object]]:
    """Return new arguments of each call to a function, since it may change them.

    With ``takes`` as ``"arrays"``, lists among them become arrays.
    """
    arguments: list[list[object]] = json.loads(json.dumps(calls))
    if takes != "arrays":
        return arguments
    import numpy

    return [
        [numpy.array(part) if isinstance(part, list) else part for part in call]
        for call in arguments
    ]


# The byte code of a function body that is still blank.
IDLE = {
    "RESUME",
    "NOP",
    "CACHE",
    "POP_TOP",
    "LOAD_CONST",
    "LOAD_COMMON_CONSTANT",
    "RETURN_CONST",
    "RETURN_VALUE",
    "COPY_FREE_VARS",
}


def _works_something_out(function: object) -> bool:
    code = getattr(function, "__code__", None)
    return code is None or any(step.opname not in IDLE for step in dis.get_instructions(code))


def _is_blank(answer: object) -> bool:
    return answer is None or answer is Ellipsis or answer is NotImplemented


class _Writer:
    """The writer of one answer, whose memory of written parts keeps shared parts shared."""

    def __init__(self, raise_missing: bool) -> None:
        self.raise_missing = raise_missing
        self.nodes: list[Node] = []
        self.written: dict[sympy.Basic, int] = {}
        self.put_off: set[sympy.Basic] = set()
        self.gave_up = 0

    def plain(self, answer: object, calls: Sequence[Sequence[object]] | None) -> Plain:
        value: Value
        if calls is None or _is_blank(answer):
            value = self.value(answer, 0)
        elif not callable(answer):
            raise NotPlain("The question asks for a function: give its name, without calling it.")
        else:
            value = [
                "function",
                [self.result(answer, arguments) for arguments in calls],
                _works_something_out(answer),
            ]
        return {"value": value, "nodes": self.nodes}

    def value(self, answer: object, depth: int) -> Value:
        if depth > DEEPEST:
            raise NotPlain(f"The answer is nested more than {DEEPEST} deep.")
        if _is_blank(answer):
            return ["blank"]
        if isinstance(answer, bool):
            return ["truth", answer]
        if isinstance(answer, str):
            return ["text", _text(answer)]
        if isinstance(answer, numbers.Number):
            return ["expression", self.number(answer)]
        origin = _module(type(answer)).partition(".")[0]
        if origin == "mpmath" and hasattr(answer, "tolist"):
            return self.of_mpmath(answer)
        if origin != "sympy" and _is_array(answer):
            return self.array(answer, depth)
        if origin == "orientation" and hasattr(answer, "reference_frames"):
            return self.of_frames(cast(FrameGraph, answer), depth)
        if (
            isinstance(answer, dict)
            and len(answer) == 1
            and isinstance(next(iter(answer)), sympy.Basic)
        ):
            # The result of `solve` for one unknown: {theta: pi/4}.
            return self.value(next(iter(answer.values())), depth)
        if isinstance(answer, (Iterator, KeysView, ValuesView, range)):
            kind = type(answer).__name__[:40]
            raise NotPlain(f"This is of type `{kind}`: write `list(...)` around it.")
        if isinstance(answer, (set, frozenset)) and len(answer) > 1:
            raise NotPlain("This is a set, which has no order: write a list, in square brackets.")
        if isinstance(answer, (list, tuple, set, frozenset)):
            return self.parts(list(answer), depth)
        return self.of_sympy(answer, depth)

    def parts(self, answer: Sequence[object], depth: int) -> Value:
        if len(answer) == 2 and _has_unit(answer[1]) and not _has_unit(answer[0]):
            # This is a number with a unit, such as (3.2, newton * meter).
            return self.value(sympy.sympify(answer[0]) * answer[1], depth)
        if len(answer) > MOST_PARTS:
            raise NotPlain(
                f"The answer has {len(answer)} parts, but no question asks for that many."
            )
        return ["list", [self.value(part, depth + 1) for part in answer]]

    def array(self, answer: Array, depth: int) -> Value:
        size = math.prod(answer.shape)
        if size > MOST_PARTS:
            raise NotPlain(f"The array has {size} entries, but no question asks for that many.")
        return self.value(answer.tolist(), depth)

    def of_mpmath(self, answer: mpmath.matrix) -> Value:
        if answer.rows * answer.cols > MOST_PARTS:
            raise NotPlain(
                f"The matrix is {answer.rows} × {answer.cols}, but no question asks for one that "
                "large."
            )
        entries = [self.number(entry) for row in answer.tolist() for entry in row]
        return ["matrix", answer.rows, answer.cols, entries]

    def of_frames(self, answer: FrameGraph, depth: int) -> Value:
        """Return the matrix of every connected pair in the book's own graph of frames."""
        names = sorted({name for edge in answer._edges for name in (edge.frame, edge.reference)})
        if len(names) > 12:
            raise NotPlain(
                "You have given more than 12 frames. Give the matrix that the question asks for."
            )
        matrices: dict[str, dict[str, Value]] = {}
        for target in names:
            for source in names:
                with contextlib.suppress(ValueError):
                    if target != source:
                        matrices.setdefault(_text(target), {})[_text(source)] = self.value(
                            answer.dcm(target, source), depth
                        )
        return ["frames", matrices]

    def of_sympy(self, answer: object, depth: int) -> Value:
        if _module(type(answer)).startswith("scipy.spatial"):
            raise NotPlain(
                "This is a SciPy Rotation, which does not name its frames. Convert it to a "
                "matrix with the module's `dcm_from_scipy_rotation`."
            )
        # Mechanics is slow to import; if the answer has a frame or a vector, it has been imported.
        mechanics = sys.modules.get("sympy.physics.vector")
        if mechanics and isinstance(answer, mechanics.ReferenceFrame):
            return [
                "frame",
                _text(answer.name),
                {
                    _text(neighbour.name): self.value(answer.dcm(neighbour), depth)
                    for neighbour in _connected([answer])
                },
            ]
        if mechanics and isinstance(answer, mechanics.Vector):
            frames = _connected([frame for _, frame in answer.args])
            try:
                return [
                    "vector",
                    {
                        _text(frame.name): self.value(answer.to_matrix(frame), depth)
                        for frame in frames
                    },
                ]
            except ValueError:
                raise NotPlain(
                    "The components of this vector belong to frames that are not connected. "
                    "First orient one of them with respect to another."
                ) from None
        if isinstance(answer, sympy.Quaternion):
            return self.parts([answer.a, answer.b, answer.c, answer.d], depth)
        if isinstance(answer, (sympy.matrices.MatrixExpr, sympy.MatrixBase)):
            return ["matrix", *self.matrix(answer)]
        if isinstance(answer, (sympy.Tuple, sympy.FiniteSet)):
            return self.parts(list(answer), depth)
        if isinstance(answer, sympy.NDimArray):
            return (
                self.parts(answer.tolist(), depth)
                if answer.rank()
                else self.value(answer[()], depth)
            )
        if isinstance(answer, sympy.Eq):
            # `Eq(theta, pi/4)`: use the side beside the symbol that is solved for.
            sides = [
                side for side in answer.args if not isinstance(side, (sympy.Symbol, AppliedUndef))
            ]
            if len(sides) == 1:
                return self.value(sides[0], depth)
            raise NotPlain(
                "An equation is not a value. Give the side of it that the question asks for."
            )
        if isinstance(answer, BooleanAtom):
            return ["truth", bool(answer)]
        if isinstance(answer, sympy.UnevaluatedExpr):
            # Its argument may be a matrix.
            return self.value(answer.args[0], depth)
        if _has_unit(answer):
            number, unit = _number_and_unit(answer, sys.modules["sympy.physics.units"])
            parts: list[Value] = [["expression", self.expression(number)], ["text", unit]]
            return ["list", parts]
        if isinstance(answer, sympy.Expr):
            return ["expression", self.expression(answer)]
        whole = "One entry" if depth else "This"
        raise NotPlain(
            f"{whole} is a dictionary. Give the value in it that the question asks for."
            if isinstance(answer, dict)
            else f"{whole} is a function. Call it, and give what it returns."
            if callable(answer)
            else f"An answer of type `{type(answer).__name__[:40]}` cannot be read. "
            "Give a SymPy expression, a matrix, a list of numbers or a string."
        )

    def result(
        self, function: Callable[[*tuple[object, ...]], object], arguments: Sequence[object]
    ) -> Value:
        if inspect.isgeneratorfunction(function) or inspect.iscoroutinefunction(function):
            raise NotPlain("Define the function with `def`, and let it `return` its result.")
        printed = io.StringIO()
        try:
            with contextlib.redirect_stdout(printed):
                returned = function(*arguments)
            if _is_blank(returned) and printed.getvalue().strip():
                return ["printed", printed.getvalue()[:300]]
            return self.value(returned, 0)
        except NotPlain as error:
            raise NotPlain(f"Look at what your function returns. {error}") from None
        except (Exception, SystemExit) as error:
            if self.raise_missing and isinstance(error, ModuleNotFoundError):
                raise
            return ["raised", _text(f"{type(error).__name__}: {error}"[:300])]

    def node(self, *parts: str | int) -> int:
        if len(self.nodes) >= MOST_NODES:
            raise NotPlain(
                f"The answer has more than {MOST_NODES} different parts, which is too many to "
                "read. Simplify it, or build it in fewer steps."
            )
        self.nodes.append(list(parts))
        return len(self.nodes) - 1

    def matrix(self, answer: sympy.matrices.MatrixExpr | sympy.MatrixBase) -> Entries:
        """Return the rows, columns and entries of a matrix expression, with products evaluated."""
        if not all(sympy.sympify(size).is_Integer for size in answer.shape):
            raise NotPlain("The matrix has no definite size.")
        rows, columns = map(int, answer.shape)
        if rows * columns > MOST_PARTS:
            raise NotPlain(
                f"The matrix is {rows} × {columns}, but no question asks for one that large."
            )
        return rows, columns, [self.expression(entry) for entry in _explicit(answer).flat()]

    def number(self, number: mpmath.mpf | sympy.Number | complex) -> int:
        of_mpmath = _module(type(number)).startswith("mpmath")
        if isinstance(number, numbers.Complex) and not isinstance(number, numbers.Real):
            real, imaginary = self.number(number.real), self.number(number.imag)
            return self.node(
                "Add", real, self.node("Mul", self.node("constant", "ImaginaryUnit"), imaginary)
            )
        if of_mpmath and hasattr(number, "_mpf_"):
            return self.node("float", libmp.to_str(number._mpf_, 40))
        if isinstance(number, numbers.Rational):
            return self.rational(int(number.numerator), int(number.denominator))
        return self.node("float", repr(float(cast(float, number))))

    def rational(self, numerator: int, denominator: int) -> int:
        for part in (numerator, denominator):
            # Compare powers of two: writing a huge integer out can itself take minutes.
            if part.bit_length() > LONGEST_INTEGER * 3:
                raise NotPlain(
                    f"The answer contains an integer of about {int(part.bit_length() * 0.30103)} "
                    "digits. No question needs one."
                )
        if denominator == 1:
            return self.node("integer", str(numerator))
        return self.node("rational", str(numerator), str(denominator))

    def expression(self, root: sympy.Basic) -> int:
        """Write an expression, children first, without recursion: a chain may be very deep."""
        todo = [root]
        while todo:
            part = todo[-1]
            if part in self.written:
                todo.pop()
                continue
            children = self.children(part)
            missing = [child for child in children if child not in self.written]
            if missing:
                todo.extend(missing)
                continue
            self.written[part] = self.operation(part, children)
            todo.pop()
        return self.written[root]

    def worked_out(self, part: sympy.Basic) -> sympy.Basic:
        """Evaluate a part that SymPy has deferred; return it unchanged if that takes too long."""
        if self.gave_up < 2:
            try:
                with limited_work():
                    return part.doit()
            except TooMuchWork:
                self.gave_up += 1
            except Exception:
                # A part that SymPy cannot evaluate has no value here.
                pass
        return part

    def children(self, part: sympy.Basic) -> tuple[sympy.Basic, ...]:
        if isinstance(part, AppliedUndef) or _is_rate(part):
            return ()
        if _is_quantity(part):
            return (self.without_unit(part),)
        if isinstance(part, PUT_OFF) and part not in self.put_off:
            worked_out = self.worked_out(part)
            if type(worked_out) is not type(part) or _is_rate(worked_out):
                return (worked_out,)
            self.put_off.add(part)
        return () if part in self.put_off else tuple(part.args)

    def without_unit(self, unit: sympy.Basic) -> sympy.Expr:
        """Return a unit's value in a matrix of numbers: 1 for a radian, a fraction for a degree."""
        units = sys.modules["sympy.physics.units"]
        if unit == units.radian:
            return sympy.S.One
        if unit == units.degree:
            return sympy.pi / 180
        raise NotPlain(
            f"The answer contains the unit `{unit}`. "
            "Give numbers alone, in the unit that the question names."
        )

    def operation(self, part: sympy.Basic, children: tuple[sympy.Basic, ...]) -> int:
        if isinstance(part, sympy.Rational):
            return self.rational(int(part.p), int(part.q))
        if isinstance(part, sympy.Float):
            return self.node("float", libmp.to_str(part._mpf_, 40))
        if isinstance(part, sympy.Symbol):
            return self.node("symbol", _name_of(part.name))
        if isinstance(part, AppliedUndef):
            return self.node("symbol", _name_of(part.func.__name__))
        if _is_rate(part):
            return self.node(
                "symbol",
                _name_of(part.expr.func.__name__) + "'" * min(int(part.derivative_count), 9),
            )
        if (
            isinstance(part, sympy.UnevaluatedExpr)
            or children
            and (_is_quantity(part) or isinstance(part, PUT_OFF))
        ):
            return self.written[children[0]]
        if not children:
            return self.node("constant", type(part).__name__)
        return self.node(type(part).__name__[:60], *(self.written[child] for child in children))


def _explicit(matrix: sympy.matrices.MatrixExpr | sympy.MatrixBase) -> sympy.MatrixBase:
    """Evaluate the products, sums and powers of a matrix expression."""
    if isinstance(matrix, sympy.MatrixBase):
        return matrix
    if isinstance(matrix, (sympy.MatMul, sympy.MatAdd)):
        parts = [_explicit(part) if part.is_Matrix else part for part in matrix.args]
        return functools.reduce(operator.mul if matrix.is_MatMul else operator.add, parts)
    if isinstance(matrix, sympy.Transpose):
        return _explicit(matrix.arg).T
    if isinstance(matrix, sympy.matrices.expressions.matpow.MatPow) and (
        matrix.exp.is_Integer and 0 < abs(matrix.exp) <= 12
    ):
        base, power = _explicit(matrix.base), int(matrix.exp)
        if base.rows > 4 and power < 0:
            raise NotPlain(
                "We do not compute the inverse of a matrix of this size. Call `.doit()` on it "
                "first."
            )
        # SymPy's own inverse of a product of three rotations takes half a minute.
        base = base.adjugate() / base.det() if power < 0 else base
        return functools.reduce(operator.mul, [base] * abs(power))
    try:
        with limited_work():
            return matrix.doit().as_explicit()
    except TooMuchWork:
        raise NotPlain(
            "The matrix takes too long to compute. Call `.doit()` on it first."
        ) from None


# Expressions that SymPy may have deferred and that ``.doit()`` evaluates.
PUT_OFF = (
    sympy.Derivative,
    sympy.Integral,
    sympy.Subs,
    sympy.Sum,
    sympy.Product,
    sympy.Limit,
    sympy.Trace,
    sympy.Determinant,
)


def _name_of(symbol: str) -> str:
    """Return the name of a symbol in ASCII: ``theta`` for ``θ``, ``theta_1`` for ``θ_1``."""
    return _text("".join(map(_spelled, unicodedata.normalize("NFKC", symbol))))


def _spelled(letter: str) -> str:
    words = unicodedata.name(letter, "").lower().split()
    if words[:1] == ["greek"] and words[2:3] == ["letter"]:
        # Unicode spells this letter differently from everybody else.
        word = words[-1].replace("lamda", "lambda")
        return word.capitalize() if words[1] == "capital" else word
    return letter


def _text(text: str) -> str:
    # A subclass, such as NumPy's, is not a string in JSON.
    text = str(text)
    if len(text) > LONGEST_TEXT:
        raise NotPlain(f"This string of {len(text)} characters is too long for an answer.")
    return text


def _module(kind: type) -> str:
    # A function of time, theta(t), has a type that SymPy creates on the spot and that belongs to no
    # module.
    return str(kind.__module__)


def _is_array(answer: object) -> TypeGuard[Array]:
    """Check whether this behaves like an array of NumPy or of its stand-in."""
    return callable(getattr(answer, "tolist", None)) and isinstance(
        getattr(answer, "shape", None), tuple
    )


def _is_quantity(part: object) -> bool:
    # The module is slow to import; if there is a quantity, it has been imported.
    units = sys.modules.get("sympy.physics.units")
    return units is not None and isinstance(part, units.Quantity)


def _is_rate(part: sympy.Basic) -> TypeGuard[sympy.Derivative]:
    """Check whether this is the derivative of a function of time, which has a name of its own."""
    return isinstance(part, sympy.Derivative) and isinstance(part.expr, AppliedUndef)


def _has_unit(part: object) -> bool:
    if not isinstance(part, sympy.Expr):
        return False
    # Visit each shared part once: SymPy's own `has` traverses the printed tree.
    seen: set[int] = set()
    waiting = [part]
    while waiting:
        inner = waiting.pop()
        if _is_quantity(inner):
            return True
        if id(inner) not in seen:
            seen.add(id(inner))
            waiting += inner.args
    return False


def _number_and_unit(answer: sympy.Expr, units: ModuleType) -> tuple[sympy.Expr, str]:
    """Write an expression with quantities of `sympy.physics.units` in base units.

    The result is a number and the text of the unit.
    """
    base = {getattr(units, name): sympy.Dummy(name, positive=True) for name in BASE}
    pure = {
        units.radian: sympy.S.One,
        units.degree: sympy.pi / 180,
        units.percent: sympy.Rational(1, 100),
    }
    try:
        with limited_work():
            plain = answer.xreplace(
                {prefix: prefix.scale_factor for prefix in answer.atoms(units.prefixes.Prefix)}
            )
            for quantity in sorted(answer.atoms(units.Quantity), key=str):
                size = pure.get(quantity)
                if size is None:
                    size = units.convert_to(quantity, list(base)).xreplace(base)
                if size.has(units.Quantity):
                    raise NotPlain(f"`{quantity}` is not in SI units.")
                plain = plain.xreplace({quantity: size})
            terms_of: dict[sympy.Expr, list[sympy.Expr]] = {}
            for term in sympy.Add.make_args(sympy.expand_mul(plain)):
                number, rest = term.as_independent(*base.values())
                terms_of.setdefault(rest, []).append(number)
    except TooMuchWork:
        raise NotPlain(
            "The unit takes too long to compute. Give a pair: `(number, 'N m')`."
        ) from None
    if len(terms_of) > 1:
        raise NotPlain("The terms of this sum have different units.")
    [(rest, terms)] = terms_of.items()
    powers = rest.as_powers_dict() if rest != 1 else {}
    if not all(part in base.values() and power.is_Integer for part, power in powers.items()):
        raise NotPlain("The unit of this answer is not a product of integer powers of base units.")
    unit = " ".join(
        f"{symbol.name}^{powers[symbol]}" for symbol in base.values() if symbol in powers
    )
    return sympy.Add(*terms), unit or "1"


def _connected(frames: Iterable[CoordinateFrame]) -> list[CoordinateFrame]:
    """Return all frames connected to the given ones, from SymPy's record of neighbours."""
    connected = list(dict.fromkeys(frames))
    for frame in connected:
        connected.extend(neighbour for neighbour in frame._dcm_dict if neighbour not in connected)
        if len(connected) > 30:
            raise NotPlain("This frame is connected to more than 30 others.")
    return connected


_DIGITS = re.compile(rf"-?[0-9]{{1,{LONGEST_INTEGER + 10}}}")
_FLOAT = re.compile(
    r"[-+]?([0-9]{1,60}\.?[0-9]{0,60}|\.[0-9]{1,60})(e[-+]?[0-9]{1,40})?|[-+]?inf|[-+]?nan", re.I
)
_NAME = re.compile(r"\w{1,60}", re.ASCII)


def read_plain(data: object) -> Plain:
    """Check data from a student's process, and return them.

    Raises
    ------
    NotPlain
        The data are not a result of `to_plain`.
    """
    if not isinstance(data, dict) or set(data) != {"value", "nodes"}:
        raise NotPlain(DAMAGED)
    nodes = data["nodes"]
    _demand(isinstance(nodes, list) and len(nodes) <= MOST_NODES)
    for position, node in enumerate(nodes):
        _check_node(node, position)
    _check_value(data["value"], 0, len(nodes))
    return cast(Plain, data)


DAMAGED = "The data of this answer is damaged."


def _demand(condition: object) -> None:
    if not condition:
        raise NotPlain(DAMAGED)


def _check_node(node: object, position: int) -> None:
    if not isinstance(node, list) or not node or not isinstance(node[0], str):
        raise NotPlain(DAMAGED)
    _demand(len(node) <= MOST_NODES)
    operation, rest = node[0], node[1:]
    if operation in ("integer", "rational"):
        _demand(len(rest) == (1 if operation == "integer" else 2))
        _demand(all(isinstance(digits, str) and _DIGITS.fullmatch(digits) for digits in rest))
        _demand(operation == "integer" or int(rest[1]) > 0)
    elif operation == "float":
        _demand(len(rest) == 1 and isinstance(rest[0], str) and _FLOAT.fullmatch(rest[0]))
    elif operation in ("symbol", "constant"):
        _demand(len(rest) == 1 and _is_text(rest[0]))
    else:
        _demand(_NAME.fullmatch(operation))
        _demand(all(_is_before(position, child) for child in rest))


def _is_text(text: object) -> bool:
    return isinstance(text, str) and len(text) <= LONGEST_TEXT


def _is_before(position: int, node: object) -> bool:
    # A Boolean would count as a number, too.
    return type(node) is int and 0 <= node < position


def _check_value(value: object, depth: int, nodes: int) -> None:
    if not isinstance(value, list) or not value or value[0] not in VALUES:
        raise NotPlain(DAMAGED)
    _demand(depth <= DEEPEST + 2)
    kind, rest = value[0], value[1:]
    _demand(len(rest) == {"blank": 0, "matrix": 3, "frame": 2, "function": 2}.get(kind, 1))
    if kind in ("text", "raised", "printed"):
        _demand(_is_text(rest[0]))
    elif kind == "truth":
        _demand(isinstance(rest[0], bool))
    elif kind == "expression":
        _demand(_is_before(nodes, rest[0]))
    elif kind == "matrix":
        rows, columns, entries = rest
        _demand(type(rows) is int and type(columns) is int and isinstance(entries, list))
        _demand(0 <= rows <= MOST_PARTS and 0 <= columns <= MOST_PARTS)
        _demand(len(entries) == rows * columns <= MOST_PARTS)
        _demand(all(_is_before(nodes, entry) for entry in entries))
    elif kind == "frames":
        _demand(isinstance(rest[0], dict) and len(rest[0]) <= 12)
        _demand(all(map(_is_text, rest[0])))
        for others in rest[0].values():
            _demand(isinstance(others, dict) and len(others) <= 12 and all(map(_is_text, others)))
            for inner in others.values():
                _check_value(inner, depth + 1, nodes)
    elif kind in ("list", "function"):
        _demand(kind == "list" or isinstance(rest[1], bool))
        _demand(isinstance(rest[0], list) and len(rest[0]) <= MOST_PARTS)
        for inner in rest[0]:
            _check_value(inner, depth + 1, nodes)
    elif kind in ("frame", "vector"):
        _demand(isinstance(rest[-1], dict) and len(rest[-1]) <= 30)
        _demand(all(map(_is_text, rest[-1])))
        _demand(kind == "vector" or _is_text(rest[0]))
        for inner in rest[-1].values():
            _check_value(inner, depth + 1, nodes)
