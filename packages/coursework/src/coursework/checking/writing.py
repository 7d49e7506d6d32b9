"""Plain answers for people, as TeX of a few operations or as a line of text.

Only the structure of a student's answer gets into TeX, where names consist of letters and digits.
We show anything else as text.
"""

import itertools
import re
import unicodedata
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, TypeVar

from .plain import (
    Node,
    Plain,
    Value,
    by_frame,
    entries_of,
    node_of,
    operands,
    parts_of,
    size_of,
    text_of,
)

Part = TypeVar("Part")

# The most characters of one answer's TeX.
LONGEST = 4_000
GREEK = (
    "alpha beta gamma delta epsilon varepsilon zeta eta theta vartheta iota kappa lambda mu nu xi "
    "pi rho sigma tau upsilon phi varphi chi psi omega Gamma Delta Theta Lambda Xi Pi Sigma Phi "
    "Psi Omega"
).split()
CONSTANTS = {"Pi": r"\pi", "Exp1": "e", "ImaginaryUnit": "i", "GoldenRatio": r"\phi"}
FUNCTIONS = {
    **{
        name: rf"\{name}"
        for name in ("sin", "cos", "tan", "cot", "sec", "csc", "log", "sinh", "cosh", "tanh")
    },
    **{f"a{name}": rf"\arc{name}" for name in ("sin", "cos", "tan")},
    "exp": r"\exp",
    "atan2": r"\mathrm{atan2}",
}


class NoMathematics(ValueError):
    """An error for an answer that is not shown as a formula, because of its kind or its length."""


def answer_as_tex(plain: Plain) -> str:
    """Return a plain answer as TeX, or an empty string if it is shown as text only."""
    try:
        return _value(plain["value"], plain["nodes"])
    except NoMathematics:
        return ""


def _value(value: Value, nodes: Sequence[Node]) -> str:
    kind, writer = value[0], _Writer(nodes)
    if kind == "expression":
        return writer.node(node_of(value), 0)
    if rows := _rows_of(value):
        return _table([[writer.node(entry, 0) for entry in row] for row in rows])
    if kind == "list" and parts_of(value):
        inside = r",\; ".join(_value(part, nodes) for part in parts_of(value))
        return rf"\left({inside}\right)"
    if kind == "frame" and len(by_frame(value)) == 1:
        ((reference, inner),) = by_frame(value).items()
        return rf"{{}}^{{{_name(text_of(value))}}}\mathbf{{C}}^{{{_name(reference)}}} = " + _value(
            inner, nodes
        )
    raise NoMathematics


def _rows_of(value: Value) -> list[list[int]]:
    """Return the rows of a matrix, or a list or nested list of expressions, as nodes."""
    if value[0] == "matrix":
        (rows, columns), entries = size_of(value), entries_of(value)
        return [entries[row * columns : (row + 1) * columns] for row in range(rows)]
    parts = parts_of(value) if value[0] == "list" else []
    if all(part[0] == "expression" for part in parts):
        return [[node_of(part) for part in parts]] if parts else []
    rows_of_parts = [_rows_of(part) if part[0] == "list" else [] for part in parts]
    return (
        [rows[0] for rows in rows_of_parts] if all(len(rows) == 1 for rows in rows_of_parts) else []
    )


def _table(lines: Iterable[Iterable[str]]) -> str:
    inside = r" \\ ".join(" & ".join(line) for line in lines)
    return rf"\begin{{bmatrix}} {inside} \end{{bmatrix}}"


def _name(name: str) -> str:
    base, _, index = name.partition("_")
    if not re.fullmatch(r"[A-Za-z0-9]{1,20}", base) or not re.fullmatch(
        r"[A-Za-z0-9]{0,20}", index
    ):
        raise NoMathematics
    shown = rf"\{base}" if base in GREEK else base if len(base) == 1 else rf"\mathrm{{{base}}}"
    return f"{shown}_{{{index}}}" if index else shown


def _in_brackets(text: str) -> str:
    """Return text in brackets, which grow if the text is tall; in a table, others would, too."""
    return rf"\left({text}\right)" if r"\frac" in text or "^" in text else f"({text})"


class _Writer:
    def __init__(self, nodes: Sequence[Node]) -> None:
        self.nodes = nodes
        self.left = LONGEST

    def node(self, order: int, around: int, depth: int = 0) -> str:
        """Return one node; `around` is the outer precedence: 0 none, 1 sum, 2 product, 3 power."""
        self.left -= 1
        if self.left <= 0 or depth > 30:
            raise NoMathematics
        operation = str(self.nodes[order][0])
        text, children = str(self.nodes[order][-1]), operands(self.nodes[order])

        def inner(child: int, binding: int = 0) -> str:
            return self.node(child, binding, depth + 1)

        def bracketed(text: str, binding: int) -> str:
            return _in_brackets(text) if around > binding else text

        if operation == "symbol":
            dots = len(text) - len(text.rstrip("'"))
            return _name(text.rstrip("'")) + "'" * dots
        if operation == "constant":
            if text not in CONSTANTS:
                raise NoMathematics
            return CONSTANTS[text]
        if operation == "integer":
            return bracketed(text, 1 if text.startswith("-") else 9)
        if operation == "rational":
            above = str(self.nodes[order][1])
            sign = "-" if above.startswith("-") else ""
            return bracketed(rf"{sign}\frac{{{above.lstrip('-')}}}{{{text}}}", 1 if sign else 2)
        if operation == "float":
            match = re.fullmatch(r"(-?[\d.]+)(?:e([-+]?\d+))?", f"{float(text):.10g}")
            if not match:
                raise NoMathematics
            power = rf" \cdot 10^{{{int(match[2])}}}" if match[2] else ""
            return bracketed(match[1] + power, 1 if power or match[1].startswith("-") else 9)
        if operation == "Add":
            terms = " + ".join(inner(child, 1) for child in children)
            return bracketed(terms.replace("+ -", "- "), 0)
        if operation == "Mul":
            return self.product(children, around, depth)
        if operation == "Pow":
            base, exponent = children
            if self.nodes[exponent] == ["rational", "1", "2"]:
                return rf"\sqrt{{{inner(base)}}}"
            if self.nodes[exponent] == ["integer", "-1"]:
                return bracketed(rf"\frac{{1}}{{{inner(base)}}}", 2)
            return bracketed(rf"{{{inner(base, 3)}}}^{{{inner(exponent)}}}", 2)
        if operation == "Abs":
            return rf"\left|{inner(children[0])}\right|"
        if operation in FUNCTIONS and children:
            return FUNCTIONS[operation] + _in_brackets(", ".join(map(inner, children)))
        raise NoMathematics

    def product(self, factors: Sequence[int], around: int, depth: int) -> str:
        above, below = list[str](), list[str]()
        sign = ""
        for factor in factors:
            node, children = self.nodes[factor], operands(self.nodes[factor])
            if node == ["integer", "-1"] and not above:
                sign = "-"
            elif node[0] == "Pow" and self.nodes[children[1]] == ["integer", "-1"]:
                below.append(self.node(children[0], 2 if len(factors) > 2 else 0, depth + 1))
            else:
                above.append(self.node(factor, 2, depth + 1))
        top = r" \, ".join(above) or "1"
        text = sign + (rf"\frac{{{top}}}{{{' , '.join(below)}}}" if below else top)
        if len(below) > 1:
            raise NoMathematics
        return _in_brackets(text) if around > (1 if sign else 2) else text


# --- text ---------------------------------------------------------------------------------------

OPERATORS = {"Add": (" + ", 1), "Mul": ("*", 2), "Pow": ("**", 3)}
NAMES = {"Pi": "pi", "Exp1": "E", "ImaginaryUnit": "I", "Abs": "abs"}


def answer_as_text(plain: Plain | None, most: int = 300) -> str:
    """Return a plain answer as one line like the code that makes it, cut off if it is long."""
    text = _Printer(plain["nodes"], most).value(plain["value"]) if plain else ""
    return text if len(text) <= most else f"{text[:most]}…"


class _Printer:
    """A printer that stops near the limit, since expanding all shared nodes could fill a disk."""

    def __init__(self, nodes: Sequence[Any], most: int) -> None:
        self.nodes = nodes
        self.left = self.most = most

    def parts(
        self, parts: Iterable[Part], write: Callable[[Part], str], between: str = ", "
    ) -> str:
        return between.join(map(write, itertools.islice(parts, self.most)))

    def value(self, value: Sequence[Any]) -> str:
        kind, *rest = value
        if kind in ("truth", "text"):
            return repr(readable(rest[0]) if kind == "text" else rest[0])
        if kind in ("printed", "raised"):
            return f"{kind} {readable(rest[0])}"
        if kind == "expression":
            return self.node(rest[0], 0, 0)
        if kind == "matrix":
            return f"[{self.parts(_rows_of(list(value)), self.row)}]"
        if kind == "list":
            return f"[{self.parts(rest[0], self.value)}]"
        if kind == "function":
            begin = "" if rest[0] and rest[0][0][0] in ("printed", "raised") else "returned "
            return begin + self.parts(rest[0], self.value, "; ")
        if kind == "frames":
            frames = sorted(rest[0])
            return self.parts(frames, lambda name: f"{readable(name)} {self.named(rest[0][name])}")
        if kind == "frame":
            return f"frame {readable(rest[0])}: {self.named(rest[1])}"
        return f"vector: {self.named(rest[0])}" if rest else "..."

    def row(self, row: Sequence[int]) -> str:
        return f"[{self.parts(row, lambda entry: self.node(entry, 0, 0))}]"

    def named(self, values: Mapping[str, Any]) -> str:
        return self.parts(
            sorted(values), lambda name: f"in {readable(name)}: {self.value(values[name])}", "; "
        )

    def node(self, order: int, depth: int, around: int) -> str:
        self.left -= 1
        if self.left < 0 or depth > 40:
            return "…"
        operation, *rest = self.nodes[order]
        if operation == "symbol":
            return readable(rest[0])
        if operation == "constant":
            return NAMES.get(rest[0], readable(rest[0]))
        if operation in ("integer", "rational", "float"):
            digits = "/".join(rest)
            size = abs(float(digits)) if operation == "float" else None
            if size is not None and (size == 0 or 1e-300 < size < 1e300):
                # These are enough digits to recognise a number.
                digits = f"{float(digits):.10g}"
            tight = around > 1 and ("/" in digits or digits.startswith("-"))
            return f"({digits})" if tight else digits

        def inner(children: Sequence[int], binding: int = 0, between: str = ", ") -> str:
            return self.parts(children, lambda child: self.node(child, depth + 1, binding), between)

        if operation == "Pow" and self.nodes[rest[1]] == ["rational", "1", "2"]:
            return f"sqrt({inner(rest[:1])})"
        if operation == "Mul" and len(rest) > 1 and self.nodes[rest[0]] == ["integer", "-1"]:
            text, binding = f"-{inner(rest[1:], 2, '*')}", 1
        elif operation in OPERATORS:
            sign, binding = OPERATORS[operation]
            text = inner(rest, binding + (operation == "Pow"), sign).replace("+ -", "- ")
        else:
            return f"{operation}({inner(rest)})"
        return f"({text})" if around > binding else text


def readable(text: str, most: int = 2_000) -> str:
    """Return text without characters that are invisible or reverse the writing direction."""
    if len(text) <= most and text.isascii() and text.isprintable():
        return text
    shown = "".join(
        sign
        if sign in "\n\t" or unicodedata.category(sign) not in ("Cc", "Cf", "Cs", "Co", "Cn")
        else "\N{REPLACEMENT CHARACTER}"
        for sign in text[:most]
    )
    return shown + ("…" if len(text) > most else "")
