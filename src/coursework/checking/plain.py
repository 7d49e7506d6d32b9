"""An answer as plain data: what a check reads, and all that ever leaves a student's process.

An answer may be a SymPy expression, a matrix, a reference frame, a vector, a NumPy array, a list or a
text. Here it becomes a table of numbers, names and operations that JSON can hold:

``{'value': value, 'nodes': [node, ...]}``

``value`` is ``['blank']``, ``['text', t]``, ``['truth', b]``, ``['expression', k]``,
``['matrix', rows, columns, [k, ...]]``, ``['list', [value, ...]]``,
``['frame', name, {other: value, ...}]`` (its direction cosine matrix with respect to each frame it is
connected to), ``['vector', {frame: value, ...}]`` (its components in each frame) or
``['function', [value or ['raised', t], ...]]``. Each ``k`` counts into ``nodes``; a node is
``['integer', digits]``, ``['rational', p, q]``, ``['float', digits]``, ``['symbol', name]``,
``['constant', name]`` or ``[operation, k, ...]``, and refers only to nodes before itself.

A subexpression that occurs often is written once, so the table is as large as the work that made the
answer and not as the tree that would be printed. Nothing is simplified. Reading such a table, unlike
unpickling or ``sympify``, runs no code that a student wrote.
"""

import numbers
import re
import sys

import sympy
from mpmath import libmp
from sympy.core.function import AppliedUndef

#: Largest number of nodes of one answer, and of parts of a list.
MOST_NODES = 60_000
MOST_PARTS = 400
#: Longest text, longest integer (in digits) and deepest list that are read.
LONGEST_TEXT = 2_000
LONGEST_INTEGER = 400
DEEPEST = 6

VALUES = ("blank", "text", "truth", "expression", "matrix", "list", "frame", "vector", "function", "raised")


class NotPlain(ValueError):
    """An answer cannot be read; the message says why, in the student's terms."""


def to_plain(answer, calls=None):
    """Give an answer as plain data.

    Parameters
    ----------
    answer : object
        What the student bound to the name. ``...`` and ``None`` are blanks.
    calls : list of lists, optional
        For a question that asks for a function: the arguments of each call, already of the type that
        the function is to be given. The results, and errors, of the calls are the answer.

    Raises
    ------
    NotPlain
        The answer is of a kind that no question asks for, or too large to read.
    """
    try:
        return _to_plain(answer, calls)
    except RecursionError:
        raise NotPlain("The answer is nested too deeply to be read. Simplify it.") from None


def _to_plain(answer, calls):
    writer = _Writer()
    if calls is None or _is_blank(answer):
        value = writer.value(answer, 0)
    elif not callable(answer):
        raise NotPlain("A function is asked for: give its name, without calling it.")
    else:
        value = ["function", [writer.result(answer, arguments) for arguments in calls]]
    return {"value": value, "nodes": writer.nodes}


def _is_blank(answer):
    return answer is None or answer is Ellipsis or answer is NotImplemented


class _Writer:
    """Writes one answer; the memory of what was written already is what keeps shared parts shared."""

    def __init__(self):
        self.nodes = []
        self.written = {}

    def value(self, answer, depth):
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
        if _module(type(answer)).partition(".")[0] == "numpy":
            return self.numpy(answer, depth)
        if isinstance(answer, (list, tuple, set, frozenset)):
            return self.parts(_in_order(answer), depth)
        return self.sympy(answer, depth)

    def parts(self, answer, depth):
        if len(answer) > MOST_PARTS:
            raise NotPlain(f"The answer has {len(answer)} parts; no question asks for that many.")
        return ["list", [self.value(part, depth + 1) for part in answer]]

    def numpy(self, answer, depth):
        size = getattr(answer, "size", 1)
        if size > MOST_PARTS:
            raise NotPlain(f"The array has {size} entries; no question asks for that many.")
        return self.value(answer.tolist(), depth)

    def sympy(self, answer, depth):
        if _module(type(answer)).startswith("scipy.spatial"):
            raise NotPlain(
                "This is a SciPy Rotation, which holds no matrix of two named frames. "
                "Turn it into one: `dcm_from_scipy_rotation` of the module does that."
            )
        if not any(_module(base).partition(".")[0] == "sympy" for base in type(answer).__mro__):
            raise NotPlain(
                f"An answer of type `{type(answer).__name__[:40]}` cannot be read. "
                "Give a SymPy expression, a matrix, a list of numbers or a text."
            )
        # Mechanics is slow to import; whoever has a frame or a vector has imported it.
        mechanics = sys.modules.get("sympy.physics.vector")
        if mechanics and isinstance(answer, mechanics.ReferenceFrame):
            return [
                "frame",
                _text(answer.name),
                {_text(other.name): self.value(answer.dcm(other), depth + 1) for other in _connected([answer])},
            ]
        if mechanics and isinstance(answer, mechanics.Vector):
            frames = _connected([frame for _, frame in answer.args])
            try:
                return [
                    "vector",
                    {_text(frame.name): self.value(answer.to_matrix(frame), depth + 1) for frame in frames},
                ]
            except ValueError:
                raise NotPlain(
                    "The parts of this vector belong to frames that are not connected: orient one of "
                    "them with respect to another first."
                ) from None
        if isinstance(answer, sympy.Quaternion):
            return self.parts([answer.a, answer.b, answer.c, answer.d], depth)
        if isinstance(answer, sympy.matrices.MatrixExpr) and not isinstance(answer, sympy.MatrixBase):
            if not all(sympy.sympify(size).is_Integer for size in answer.shape):
                raise NotPlain("The matrix has no definite size.")
            answer = answer.doit().as_explicit()
        if isinstance(answer, sympy.MatrixBase):
            rows, columns = answer.shape
            if rows * columns > MOST_PARTS:
                raise NotPlain(f"The matrix is {rows} × {columns}; no question asks for one that large.")
            return ["matrix", rows, columns, [self.expression(entry) for entry in answer.flat()]]
        if isinstance(answer, sympy.Tuple):
            return self.parts(list(answer), depth)
        if answer in (sympy.true, sympy.false):
            return ["truth", bool(answer)]
        if isinstance(answer, sympy.Expr):
            return ["expression", self.expression(answer)]
        raise NotPlain(f"An answer of type `{type(answer).__name__[:40]}` cannot be read.")

    def result(self, function, arguments):
        try:
            return self.value(function(*arguments), 0)
        except NotPlain:
            raise
        except Exception as error:
            return ["raised", _text(f"{type(error).__name__}: {error}"[:300])]

    def node(self, *parts):
        if len(self.nodes) >= MOST_NODES:
            raise NotPlain(
                f"The answer is made of more than {MOST_NODES} different parts, so it is not "
                "read. Simplify it, or build it in fewer steps."
            )
        self.nodes.append(list(parts))
        return len(self.nodes) - 1

    def number(self, number):
        if isinstance(number, complex):
            real, imaginary = (self.number(part) for part in (number.real, number.imag))
            unit = self.node("constant", "ImaginaryUnit")
            return self.node("Add", real, self.node("Mul", unit, imaginary))
        if isinstance(number, numbers.Rational):
            return self.rational(int(number.numerator), int(number.denominator))
        return self.node("float", repr(float(number)))

    def rational(self, numerator, denominator):
        for part in (numerator, denominator):
            # Compared as powers of two: writing a huge integer out can itself take minutes.
            if part.bit_length() > LONGEST_INTEGER * 3:
                raise NotPlain(
                    f"The answer holds an integer of about {int(part.bit_length() * 0.30103)} "
                    "digits. No question needs one."
                )
        if denominator == 1:
            return self.node("integer", str(numerator))
        return self.node("rational", str(numerator), str(denominator))

    def expression(self, root):
        """Write an expression, children first, without recursion: a chain may be very deep."""
        todo = [root]
        while todo:
            part = todo[-1]
            if part in self.written:
                todo.pop()
                continue
            if len(todo) > MOST_NODES:
                self.node()  # says that it is too large
            children = self.children(part)
            missing = [child for child in children if child not in self.written]
            if missing:
                todo.extend(missing)
                continue
            self.written[part] = self.operation(part, children)
            todo.pop()
        return self.written[root]

    def children(self, part):
        if isinstance(part, (sympy.Number, sympy.NumberSymbol, sympy.Symbol, AppliedUndef)) or part is sympy.I:
            return ()
        if isinstance(part, sympy.Derivative) and isinstance(part.expr, AppliedUndef):
            return ()
        if isinstance(part, sympy.Derivative):
            return (part.doit(),)
        return part.args

    def operation(self, part, children):
        if isinstance(part, sympy.Rational):
            return self.rational(int(part.p), int(part.q))
        if isinstance(part, sympy.Float):
            return self.node("float", libmp.to_str(part._mpf_, 40))
        if isinstance(part, sympy.Symbol):
            return self.node("symbol", _text(part.name))
        if isinstance(part, AppliedUndef):
            return self.node("symbol", _text(part.func.__name__))
        if isinstance(part, sympy.Derivative):
            if isinstance(part.expr, AppliedUndef):
                return self.node("symbol", _text(part.expr.func.__name__) + "'" * min(int(part.derivative_count), 9))
            return self.written[children[0]]
        if isinstance(part, (sympy.UnevaluatedExpr,)):
            return self.written[children[0]]
        if not children:
            return self.node("constant", type(part).__name__[:60])
        return self.node(type(part).__name__[:60], *(self.written[child] for child in children))


def _text(text):
    text = str(text)
    if len(text) > LONGEST_TEXT:
        raise NotPlain(f"A text of {len(text)} characters is longer than any answer.")
    return text


def _module(kind):
    # A function of time, theta(t), is of a type that SymPy made on the spot and that belongs to no module.
    return kind.__module__ or ""


def _in_order(parts):
    return list(parts) if isinstance(parts, (list, tuple)) else sorted(parts, key=str)


def _connected(frames):
    """All frames that are connected with those given, found through SymPy's own record of neighbours."""
    found = list(dict.fromkeys(frames))
    for frame in found:
        found.extend(other for other in frame._dcm_dict if other not in found)
        if len(found) > 30:
            raise NotPlain("More than 30 frames are connected with this one.")
    return found


_DIGITS = re.compile(rf"-?[0-9]{{1,{LONGEST_INTEGER + 10}}}")
_FLOAT = re.compile(r"[-+]?([0-9]{1,60}\.?[0-9]{0,60}|\.[0-9]{1,60})(e[-+]?[0-9]{1,6})?|[-+]?inf|[-+]?nan", re.I)
_NAME = re.compile(r"\w{1,60}", re.ASCII)


def read_plain(data):
    """Check data that came out of a student's process, and give it back.

    Raises
    ------
    NotPlain
        The data is not what :func:`to_plain` makes.
    """

    def demand(condition):
        if not condition:
            raise NotPlain("The data of this answer is damaged.")

    demand(isinstance(data, dict) and set(data) == {"value", "nodes"} and isinstance(data["nodes"], list))
    nodes = data["nodes"]
    demand(len(nodes) <= MOST_NODES)
    for position, node in enumerate(nodes):
        demand(isinstance(node, list) and node and isinstance(node[0], str) and len(node) <= MOST_NODES)
        operation, rest = node[0], node[1:]
        if operation in ("integer", "rational"):
            demand(len(rest) == (1 if operation == "integer" else 2))
            demand(all(isinstance(digits, str) and _DIGITS.fullmatch(digits) for digits in rest))
            demand(operation == "integer" or int(rest[1]) > 0)
        elif operation == "float":
            demand(len(rest) == 1 and isinstance(rest[0], str) and _FLOAT.fullmatch(rest[0]))
        elif operation in ("symbol", "constant"):
            demand(len(rest) == 1 and isinstance(rest[0], str) and len(rest[0]) <= LONGEST_TEXT)
        else:
            demand(_NAME.fullmatch(operation))
            demand(all(type(child) is int and 0 <= child < position for child in rest))

    def count(number):
        demand(type(number) is int and 0 <= number < len(nodes))

    def value(part, depth):
        demand(depth <= DEEPEST + 2 and isinstance(part, list) and part and part[0] in VALUES)
        kind, rest = part[0], part[1:]
        demand(len(rest) == {"blank": 0, "matrix": 3, "frame": 2}.get(kind, 1))
        if kind in ("text", "raised"):
            demand(isinstance(rest[0], str) and len(rest[0]) <= LONGEST_TEXT)
        elif kind == "truth":
            demand(isinstance(rest[0], bool))
        elif kind == "expression":
            count(rest[0])
        elif kind == "matrix":
            rows, columns, entries = rest
            demand(type(rows) is int and type(columns) is int and isinstance(entries, list))
            demand(0 <= rows <= MOST_PARTS and 0 <= columns <= MOST_PARTS and len(entries) == rows * columns)
            demand(len(entries) <= MOST_PARTS)
            for entry in entries:
                count(entry)
        elif kind in ("list", "function"):
            demand(isinstance(rest[0], list) and len(rest[0]) <= MOST_PARTS)
            for inner in rest[0]:
                value(inner, depth + 1)
        elif kind in ("frame", "vector"):
            demand(isinstance(rest[-1], dict) and len(rest[-1]) <= 30)
            demand(all(isinstance(name, str) and len(name) <= LONGEST_TEXT for name in rest[-1]))
            demand(kind == "vector" or isinstance(rest[0], str) and len(rest[0]) <= LONGEST_TEXT)
            for inner in rest[-1].values():
                value(inner, depth + 1)

    value(data["value"], 0)
    return data
