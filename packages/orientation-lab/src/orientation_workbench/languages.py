"""Write one of the module's formulas in another language and another convention.

`orientation_workbench.formulas` records what a function of ``orientation`` computes, and this
module writes it down, so that no formula is written twice.
"""

import math
from dataclasses import dataclass, field

from .formulas import CHOICES, FORMULAS, LISTS, SIZES, Value, formula_of, variable

#: The conventions for input and output, this book's own first.
CONVENTIONS = {
    "matrix": ("as here", "transposed"),
    "scalar": ("first", "last"),
    "unit": ("radians", "degrees"),
}

_SHORT = {
    "sin": "sin({})",
    "cos": "cos({})",
    "atan2": "atan2({}, {})",
    "sqrt": "sqrt({})",
    "abs": "abs({})",
}


@dataclass(frozen=True)
class Language:
    """How a language writes a function; each field is filled in with ``format``.

    Attributes
    ----------
    frame : str
        The whole function: its name, arguments, number of results and body.
    single, several : str
        The declaration of an argument that is one number, or several.
    part : str
        A line that assigns a part of the formula.
    chosen : str
        A line that assigns one of two values by a condition.
    result : str
        A line that assigns one entry of the result.
    alone : str
        The line that returns a result of one number.
    frame_alone : str
        The whole function for such a result, if it differs from ``frame``.
    index : str
        An entry of an array.
    start : int
        The first index.
    whole : str
        A whole number.
    functions : dict
        Calls of mathematical functions, by operation.
    """

    frame: str
    single: str
    several: str
    part: str
    chosen: str
    result: str = "    result[{index}] = {value};"
    alone: str = "    return {value};"
    frame_alone: str = ""
    index: str = "{name}[{index}]"
    start: int = 0
    whole: str = "{}.0"
    functions: dict = field(default_factory=lambda: _SHORT)


#: The languages, by their names.
LANGUAGES = {
    "C": Language(
        "#include <math.h>\n\nvoid {function}({arguments}, double result[{count}])\n{{\n{body}\n}}",
        "double {name}", "const double {name}[{count}]", "    const double {part} = {value};",
        "    const double {part} = {condition} ? {yes} : {no};",
        frame_alone="#include <math.h>\n\ndouble {function}({arguments})\n{{\n{body}\n}}",
        functions=_SHORT | {"abs": "fabs({})"},
    ),
    "C++": Language(
        "#include <array>\n#include <cmath>\n\nstd::array<double, {count}> "
        "{function}({arguments})\n{{\n"
        "    std::array<double, {count}> result;\n{body}\n    return result;\n}}",
        "double {name}", "const std::array<double, {count}>& {name}", "    const double {part} = "
            "{value};",
        "    const double {part} = {condition} ? {yes} : {no};",
        frame_alone="#include <array>\n#include <cmath>\n\ndouble {function}({arguments})\n"
            "{{\n{body}\n}}",
        functions={name: f"std::{text}" for name, text in _SHORT.items()},
    ),
    "Rust": Language(
        "fn {function}({arguments}) -> [f64; {count}] {{\n    let mut result = [0.0; {count}];\n"
        "{body}\n    result\n}}",
        "{name}: f64", "{name}: &[f64; {count}]", "    let {part}: f64 = {value};",
        "    let {part}: f64 = if {condition} {{ {yes} }} else {{ {no} }};",
        alone="    {value}", frame_alone="fn {function}({arguments}) -> f64 {{\n{body}\n}}",
        functions={name: f"f64::{text}" for name, text in _SHORT.items()},
    ),
    "Julia": Language(
        "function {function}({arguments})\n"
        "    result = zeros({count})\n"
        "{body}\n"
        "    return result\n"
        "end",
        "{name}", "{name}", "    {part} = {value}", "    {part} = {condition} ? {yes} : {no}",
        result="    result[{index}] = {value}", alone="    return {value}",
        frame_alone="function {function}({arguments})\n{body}\nend", start=1, whole="{}",
        functions=_SHORT | {"atan2": "atan({}, {})"},
    ),
    "Octave": Language(
        "function result = {function}({arguments})\n    result = zeros({count}, 1);\n{body}\nend",
        "{name}", "{name}", "    {part} = {value};", "    if {condition}, {part} = {yes}; else, "
            "{part} = {no}; end",
        result="    result({index}) = {value};", alone="    result = {value};",
        frame_alone="function result = {function}({arguments})\n{body}\nend",
        index="{name}({index})", start=1, whole="{}",
    ),
    "JavaScript": Language(
        "function {function}({arguments}) {{\n    const result = new Array({count});\n{body}\n"
        "    return result;\n}}",
        "{name}", "{name}", "    const {part} = {value};", "    const {part} = {condition} ? "
            "{yes} : {no};",
        frame_alone="function {function}({arguments}) {{\n{body}\n}}", whole="{}",
        functions={name: f"Math.{text}" for name, text in _SHORT.items()},
    ),
    "GLSL": Language(
        "void {function}({arguments}, out float result[{count}])\n{{\n{body}\n}}",
        "in float {name}", "in float {name}[{count}]", "    float {part} = {value};",
        "    float {part} = {condition} ? {yes} : {no};",
        frame_alone="float {function}({arguments})\n{{\n{body}\n}}",
        functions=_SHORT | {"atan2": "atan({}, {})"},
    ),
}  # fmt: skip

_COMPARISONS = ("<", ">", ">=", "==")
# How tightly an operation binds its operands: sums, signs, products, anything without brackets.
_SUM, _SIGN, _PRODUCT, _ONE = range(4)
#: How an operation is written, how tightly it binds, and how tightly each operand must bind.
_INFIX = {
    "+": ("{} + {}", _SUM, _SUM, _PRODUCT),
    "-": ("{} - {}", _SUM, _SUM, _PRODUCT),
    "*": ("{} * {}", _PRODUCT, _PRODUCT, _ONE),
    "/": ("{} / {}", _PRODUCT, _PRODUCT, _ONE),
    "negative": ("-{}", _SIGN, _PRODUCT),
    **{sign: (f"{{}} {sign} {{}}", _SUM, _SUM, _SUM) for sign in _COMPARISONS},
}


def written(language: Language, results: list, names: dict) -> tuple[list[str], list[str]]:
    """Return the lines of the shared parts, each written once, and the results themselves.

    Any value that is used twice, and each choice, becomes a part. ``names`` says how each variable
    is written.
    """
    uses, lines, texts = {}, [], {}

    def count(value):
        if isinstance(value, Value):
            uses[value] = uses.get(value, 0) + 1
            if uses[value] == 1 and value.operation != "variable":
                for part in value.parts:
                    count(part)

    for result in results:
        count(result)

    def write(value, least=_SUM):
        text, strength = known(value) if isinstance(value, Value) else number(value)
        return text if strength >= least else f"({text})"

    def number(value):
        return (
            language.whole.format(value) if isinstance(value, int) else repr(float(value)),
            _SIGN if value < 0 else _ONE,
        )

    def known(value):
        if value in texts:
            return texts[value]
        text, strength = expression(value.operation, *value.parts)
        choice = value.operation == "where"
        if choice or uses[value] > 1 and value.operation not in ("variable", "and", *_COMPARISONS):
            yes, no = map(write, value.parts[1:]) if choice else ("", "")
            lines.append(
                (language.chosen if choice else language.part).format(
                    part=f"part{len(lines)}", condition=text, value=text, yes=yes, no=no
                )
            )
            text, strength = f"part{len(lines) - 1}", _ONE
        texts[value] = text, strength
        return texts[value]

    def expression(operation, *parts):
        if operation == "variable":
            return names[parts[0]], _ONE
        if operation in _INFIX:
            pattern, strength, *least = _INFIX[operation]
            return pattern.format(*map(write, parts, least)), strength
        if operation in ("and", "where"):
            # For a choice, write only the condition: the alternatives have a line of their own.
            return " && ".join(map(write, parts[: 1 if operation == "where" else None])), _SUM
        return language.functions[operation].format(*map(write, parts)), _ONE

    results = [write(result) for result in results]
    return lines, results


def _in_convention(kind, components, convention):
    """Return components of this book in the order of another convention."""
    if kind == "matrix" and convention.get("matrix") == "transposed":
        return [components[3 * column + row] for row in range(3) for column in range(3)]
    if kind == "quaternion" and convention.get("scalar") == "last":
        return [*components[1:], components[0]]
    return components


def formula_in(
    language: str,
    name: str,
    choice: str | None = None,
    **convention: str,
) -> str:
    """Return a formula of the module as a function in another language.

    Parameters
    ----------
    language : str
        One of `LANGUAGES`.
    name : str
        One of `orientation_workbench.formulas.FORMULAS`, a public function of ``orientation``.
    choice : str, optional
        The sequence of Euler angles, or the axis, if the function takes one.
    **convention
        ``matrix='transposed'``, ``scalar='last'`` or ``unit='degrees'`` for the input and output;
        the default is the book's own convention.

    Returns
    -------
    str
        The text of one function. Matrices are nine numbers, row by row.

    Raises
    ------
    ValueError
        If there is no such language, formula, sequence, axis or convention.

    Examples
    --------
    >>> from orientation_workbench.languages import formula_in
    >>> print(formula_in('Rust', 'gimbal_lock_margin', 'zxy'))
    fn gimbal_lock_margin_zxy(angles: &[f64; 3]) -> f64 {
        f64::atan2(f64::abs(f64::cos(angles[1])), f64::abs(f64::sin(angles[1])))
    }
    """
    _demand(language, name, choice, convention)
    how = LANGUAGES[language]
    takes, gives = FORMULAS[name]
    degree = math.pi / 180 if convention.get("unit") == "degrees" else 1
    names, components, declarations = {}, [], []
    for argument, kind in takes.items():
        count = SIZES[kind]
        texts = [how.index.format(name=argument, index=k + how.start) for k in range(count)]
        texts = texts if kind in LISTS else [argument]
        names |= {text: text for text in texts}
        order = _in_convention(kind, range(count), convention)
        entries = [variable(texts[order.index(k)]) for k in range(count)]
        components.append(
            [degree * entry for entry in entries] if kind in ("angle", "angles") else entries
        )
        declarations.append(
            (how.several if kind in LISTS else how.single).format(name=argument, count=count)
        )
    results = formula_of(name, components, choice)
    if gives in ("angle", "angles"):
        results = [entry / degree for entry in results]
    results = _in_convention(gives, results, convention)
    lines, values = written(how, results, names)
    alone = len(values) == 1
    for k, value in enumerate(values):
        lines.append((how.alone if alone else how.result).format(index=k + how.start, value=value))
    function = f"{name}_{choice}" if choice else name
    return (how.frame_alone if alone else how.frame).format(
        function=function,
        arguments=", ".join(declarations),
        count=len(values),
        body="\n".join(lines),
    )


def _demand(language, name, choice, convention):
    what, allowed = CHOICES.get(name, ("sequence", ("none",)))
    for noun, value, known in (
        ("language", language, LANGUAGES),
        ("formula", name, FORMULAS),
        (f"{what} of {name}", choice or "none", allowed),
        *(("convention", which, CONVENTIONS) for which in convention),
        *((which, value, CONVENTIONS.get(which, ())) for which, value in convention.items()),
    ):
        if value not in known:
            raise ValueError(f"{value!r} is not a {noun}: choose from {', '.join(known)}")
