"""A plain answer as mathematics on a page: TeX of a few operations, turned into MathML.

What a student wrote comes in by its structure only: names are letters and digits, and whatever else
is in an answer is not written here, but shown as text.
"""

import re
from collections.abc import Iterable, Sequence

from ...checking.plain import (
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
from .pages import formula

LONGEST = 4_000  # of the TeX of one answer
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
    """An answer is not of a kind that is shown as mathematics, or too long."""


def answer_as_mathematics(plain: Plain | None) -> str:
    """The MathML of a plain answer, or an empty text where it is shown as text only."""
    if not plain:
        return ""
    try:
        found = formula(_value(plain["value"], plain["nodes"]), LONGEST)
    except NoMathematics:
        return ""
    return found if found.startswith("<math") else ""


def _value(value: Value, nodes: Sequence[Node]) -> str:
    kind, writer = value[0], _Writer(nodes)
    if kind == "expression":
        return writer.node(node_of(value), 0)
    if kind == "matrix":
        (rows, columns), entries = size_of(value), entries_of(value)
        if not entries:
            raise NoMathematics
        lines = [entries[row * columns : (row + 1) * columns] for row in range(rows)]
        return _table([[writer.node(entry, 0) for entry in line] for line in lines])
    if kind == "list" and _are_expressions(parts_of(value)):
        return _table([[writer.node(node_of(part), 0) for part in parts_of(value)]])
    if kind == "list" and parts_of(value):
        rows_of = [parts_of(part) if part[0] == "list" else [] for part in parts_of(value)]
        if all(map(_are_expressions, rows_of)):
            return _table([[writer.node(node_of(inner), 0) for inner in row] for row in rows_of])
    if kind == "frame" and len(by_frame(value)) == 1:
        ((other, inner),) = by_frame(value).items()
        return rf"{{}}^{{{_name(text_of(value))}}}\mathbf{{C}}^{{{_name(other)}}} = " + _value(
            inner, nodes
        )
    raise NoMathematics


def _are_expressions(values: Sequence[Value]) -> bool:
    """Whether there are some, and each is an expression."""
    return bool(values) and all(value[0] == "expression" for value in values)


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
    """Brackets that grow with what is in them, where it is high: in a table
    others would grow with its line.
    """
    return rf"\left({text}\right)" if r"\frac" in text or "^" in text else f"({text})"


class _Writer:
    def __init__(self, nodes: Sequence[Node]) -> None:
        self.nodes = nodes
        self.left = LONGEST

    def node(self, order: int, around: int, depth: int = 0) -> str:
        """One node; `around` is how tightly what stands round it binds: 0 nothing,
        1 a sum, 2 a product, 3 a power.
        """
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
            found = re.fullmatch(r"(-?[\d.]+)(?:e([-+]?\d+))?", f"{float(text):.10g}")
            if not found:
                raise NoMathematics
            power = rf" \cdot 10^{{{int(found[2])}}}" if found[2] else ""
            return bracketed(found[1] + power, 1 if power or found[1].startswith("-") else 9)
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
