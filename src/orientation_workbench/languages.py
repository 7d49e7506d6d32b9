"""Take a formula away: the module's own, in another language and in another convention.

Each conversion is written once, in ``orientation``, as a formula that takes components and a namespace of functions.
Here the namespace records: what comes out is the formula itself, which SymPy's printers write in other languages. No
formula stands here a second time.
"""

import math
from unittest import mock

import numpy as np
import sympy as sm
from sympy.logic.boolalg import BooleanFunction
from sympy.printing.codeprinter import CodePrinter
from sympy.printing.rust import RustCodePrinter

import orientation

#: What each function takes and gives: the names of its arguments with what they are, and of its result.
FORMULAS = {
    "dcm_from_body_fixed": ({"angles": "angles"}, "matrix"),
    "dcm_from_space_fixed": ({"angles": "angles"}, "matrix"),
    "body_fixed_from_dcm": ({"dcm": "matrix"}, "angles"),
    "space_fixed_from_dcm": ({"dcm": "matrix"}, "angles"),
    "dcm_from_quaternion": ({"quaternion": "quaternion"}, "matrix"),
    "quaternion_from_dcm": ({"dcm": "matrix"}, "quaternion"),
    "dcm_from_rotation_vector": ({"vector": "angles"}, "matrix"),
    "rotation_vector_from_dcm": ({"dcm": "matrix"}, "angles"),
    "multiply_quaternions": ({"first": "quaternion", "second": "quaternion"}, "quaternion"),
    "quaternion_rate": ({"quaternion": "quaternion", "angular_velocity": "vector"}, "quaternion"),
}
SIZES = {"angles": 3, "vector": 3, "quaternion": 4, "matrix": 9}
NEED_A_SEQUENCE = ("dcm_from_body_fixed", "dcm_from_space_fixed", "body_fixed_from_dcm", "space_fixed_from_dcm")


class _Recorder:
    """The namespace that a formula is given: it records.

    Each result of ``atan2`` becomes a part of its own: SymPy would turn the sine of such an angle into a quotient,
    which has no value where the angle is undecided, at gimbal lock. So does each choice, which would be written anew
    wherever it is used.
    """

    sin, cos, largest = sm.sin, sm.cos, sm.Max

    def __init__(self):
        self.parts = []

    def _part(self, value):
        part = sm.Symbol(f"step{len(self.parts)}", real=True)
        self.parts.append((part, value))
        return part

    def atan2(self, sine, cosine):
        return self._part(sm.atan2(sine, cosine))

    def norm(self, *components):
        return sm.sqrt(sum(entry**2 for entry in components))

    def where(self, condition, yes, no):
        return self._part(sm.Piecewise((yes, condition), (no, True)))

    def pick(self, scores, rows):
        """The row whose score is the largest, entry by entry."""
        scores = [self._part(score) for score in scores]
        best = [sm.And(*(score >= other for other in scores if other is not score)) for score in scores]
        return [self._part(sm.Piecewise(*zip(entries[:-1], best[:-1]), (entries[-1], True))) for entries in zip(*rows)]


def recorded(function, *arguments):
    """What a function of ``orientation`` computes: parts, each a symbol and its expression, and the results."""
    recorder = _Recorder()

    def record(formula, shape, *given, guard=None, symbols=True):
        components = [entry for _, value, _ in given for entry in sm.flatten([value])]
        return np.array([sm.sympify(entry) for entry in formula(recorder, *components)], object).reshape(shape)

    # The function looks its helper up among the names of its module: there it finds this one, and goes on.
    with mock.patch.dict(function.__globals__, evaluate=record):
        results = function(*arguments)
    return recorder.parts, list(results.ravel())


def _in_convention(kind, components, convention):
    """Components of this book as another convention orders them."""
    if kind == "matrix" and convention.get("matrix") == "transposed":
        return [components[3 * column + row] for row in range(3) for column in range(3)]
    if kind == "quaternion" and convention.get("scalar") == "last":
        return [*components[1:], components[0]]
    return components


def expressions(name, sequence=None, **convention):
    """The arguments of a formula, each a list of symbols, the parts that it needs, and the expressions of its result.

    Parameters are those of :func:`formula_in`.
    """
    if name not in FORMULAS:
        raise ValueError(f"{name!r} is no formula to take away; there are {', '.join(FORMULAS)}")
    for what, allowed in CONVENTIONS.items():
        if convention.get(what, allowed[0]) not in allowed:
            raise ValueError(f"{what} is {convention[what]!r}; there is {', '.join(allowed)}")
    if (sequence is not None) != (name in NEED_A_SEQUENCE):
        needs = "needs a sequence, such as 'zxy'" if sequence is None else "takes no sequence"
        raise ValueError(f"{name} {needs}")
    takes, gives = FORMULAS[name]
    degree = sm.Float(math.pi / 180, 17) if convention.get("unit") == "degrees" else 1
    symbols, values = {}, []
    for argument, kind in takes.items():
        names = [sm.Symbol(f"{argument}_{k}", real=True) for k in range(SIZES[kind])]
        symbols[argument] = _in_convention(kind, names, convention)
        scaled = [degree * entry for entry in names] if kind == "angles" else names
        values.append([scaled[k : k + 3] for k in (0, 3, 6)] if kind == "matrix" else scaled)
    parts, results = recorded(getattr(orientation, name), *values, *([sequence] if sequence else []))
    if gives == "angles":
        results = [entry / degree for entry in results]
    return symbols, parts, _in_convention(gives, results, convention)


CONVENTIONS = {
    "matrix": ("as here", "transposed"),
    "scalar": ("first", "last"),
    "unit": ("radians", "degrees"),
}


class _RustPrinter(RustCodePrinter):
    """SymPy's own (1.14) multiplies a sum without its brackets: 0.5 (x - 1) y becomes 0.5 x - 1 y."""

    _print_Mul = CodePrinter._print_Mul


#: For each language: its printer, how an entry of an argument is written (from 0 or from 1), a line that holds a part,
#: a line that gives a result, and the frame around them.
LANGUAGES = {
    "C": (sm.ccode, "{name}[{index}]", 0, "    const double {part} = {value};", "    result[{index}] = {value};",
          "#include <math.h>\n\nvoid {function}({arguments}, double result[{count}])\n{{\n{body}\n}}",
          "const double {name}[{count}]"),
    "C++": (sm.cxxcode, "{name}[{index}]", 0, "    const double {part} = {value};", "    result[{index}] = {value};",
            "#include <array>\n#include <cmath>\n\nstd::array<double, {count}> {function}({arguments})\n{{\n"
            "    std::array<double, {count}> result;\n{body}\n    return result;\n}}",
            "const std::array<double, {count}>& {name}"),
    "Rust": (_RustPrinter().doprint, "{name}[{index}]", 0, "    let {part}: {rust} = {value};",
             "    result[{index}] = {value};",
             "fn {function}({arguments}) -> [f64; {count}] {{\n    let mut result = [0.0; {count}];\n{body}\n"
             "    result\n}}",
             "{name}: &[f64; {count}]"),
    "Julia": (sm.julia_code, "{name}[{index}]", 1, "    {part} = {value}", "    result[{index}] = {value}",
              "function {function}({arguments})\n    result = zeros({count})\n{body}\n    return result\nend",
              "{name}"),
    "Octave": (sm.octave_code, "{name}({index})", 1, "    {part} = {value};", "    result({index}) = {value};",
               "function result = {function}({arguments})\n    result = zeros({count}, 1);\n{body}\nend", "{name}"),
    "JavaScript": (sm.jscode, "{name}[{index}]", 0, "    const {part} = {value};", "    result[{index}] = {value};",
                   "function {function}({arguments}) {{\n    const result = new Array({count});\n{body}\n"
                   "    return result;\n}}",
                   "{name}"),
    "GLSL": (sm.glsl_code, "{name}[{index}]", 0, "    {kind} {part} = {value};", "    result[{index}] = {value};",
             "void {function}({arguments}, out float result[{count}])\n{{\n{body}\n}}", "in float {name}[{count}]"),
}  # fmt: skip

#: In languages that want to be told: what a number is called, and what is true or false.
TYPES = {"kind": ("float", "bool"), "rust": ("f64", "bool")}


def formula_in(
    language: str, name: str, sequence: str | None = None, *, derivative: bool = False, **convention: str
) -> str:
    """A formula of the module as a function in another language.

    Parameters
    ----------
    language : str
        One of :data:`LANGUAGES`.
    name : str
        One of :data:`FORMULAS`, a public function of ``orientation``.
    sequence : str, optional
        The sequence of Euler angles, where the function takes one.
    derivative : bool
        Give the derivatives of the results by the numbers of the first argument, result by result.
    **convention
        ``matrix='transposed'``, ``scalar='last'``, ``unit='degrees'`` where the numbers are to come and go so; the
        book's own convention is the default.

    Returns
    -------
    str
        The text of one function. Matrices are nine numbers, row by row.

    Raises
    ------
    ValueError
        If there is no such language, formula, sequence or convention.

    Examples
    --------
    >>> from orientation_workbench.languages import formula_in
    >>> print(formula_in('JavaScript', 'multiply_quaternions').splitlines()[0])
    function multiply_quaternions(first, second) {
    """
    if language not in LANGUAGES:
        raise ValueError(f"{language!r} is none of the languages {', '.join(LANGUAGES)}")
    printer, indexed, start, part_line, result_line, frame, argument = LANGUAGES[language]
    symbols, parts, results = expressions(name, sequence, **convention)
    if derivative:
        for part, value in reversed(parts):
            results = [entry.subs(part, value) for entry in results]
        by = next(iter(symbols.values()))
        parts, results = [], [sm.diff(entry, one) for entry in results for one in by]
    parts, results = _shared(parts, results, {one for entries in symbols.values() for one in entries})
    written = {
        entry: sm.Symbol(indexed.format(name=argument_name, index=k + start), real=True)
        for argument_name, entries in symbols.items()
        for k, entry in enumerate(entries)
    }

    def write(value):
        return printer(_with_floats(value.xreplace(written)))

    lines = [
        part_line.format(
            part=part,
            value=write(value),
            **{
                name: types[isinstance(value, (sm.core.relational.Relational, BooleanFunction))]
                for name, types in TYPES.items()
            },
        )
        for part, value in parts
    ]
    lines += [result_line.format(index=k + start, value=write(value)) for k, value in enumerate(results)]
    arguments = ", ".join(argument.format(name=one, count=len(entries)) for one, entries in symbols.items())
    function = "_".join([name, *([sequence] if sequence else []), *(["derivative"] if derivative else [])])
    return frame.format(function=function, arguments=arguments, count=len(results), body="\n".join(lines))


def _shared(parts, results, known):
    """The same with what occurs twice computed once, each part after those that it needs."""
    names, values = [part for part, _ in parts], [value for _, value in parts]
    common, values = sm.cse([*values, *results], symbols=sm.numbered_symbols("part"), optimizations="basic")
    waiting, ordered, known = [*common, *zip(names, values)], [], set(known)
    while waiting:
        ready = next(entry for entry in waiting if entry[1].free_symbols <= known)
        waiting.remove(ready)
        ordered.append(ready)
        known.add(ready[0])
    return ordered, values[len(names) :]


def _with_floats(value):
    """The same with ``1.0`` for ``1``, but in exponents and signs: Rust and GLSL do not add the one to the other."""
    if value.is_Integer:
        return sm.Float(value)
    if not value.args or value.is_Rational:
        return value
    if value.is_Pow:
        return sm.Pow(_with_floats(value.base), value.exp)
    arguments = [one if value.is_Mul and one == -1 else _with_floats(one) for one in value.args]
    return value.func(*arguments)
