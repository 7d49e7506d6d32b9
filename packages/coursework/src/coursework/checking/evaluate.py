"""Evaluate an answer at given values of its symbols.

Two forms of one expression have the same values, so values are compared instead of forms: nothing
is simplified, which could take a minute or never finish. They are computed with 40 digits, of which
a check compares nine, so that rounding never distinguishes two ways of writing an answer.

This reads only the plain data of `coursework.checking.plain`. It never builds a SymPy object
from them, and its work is bounded for any data.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TypeAlias, cast

import mpmath

MP = mpmath.MPContext()
MP.dps = 40
#: A real or a complex number.
Number: TypeAlias = "mpmath.mpf | mpmath.mpc"
# The value of a node at a point: a number or a Boolean, a case of a Piecewise with its condition,
# or the error of its evaluation.
Result: TypeAlias = "Number | bool | tuple[Result, ...] | Exception"
Node: TypeAlias = Sequence[str | int]
# Smaller imaginary parts are rounding: the rest of exponentials that should cancel.
ROUNDING = MP.mpf(10) ** -25
LARGEST = MP.mpf(10) ** 60
# Numbers below two to this power are not used, because operations on them take memory in proportion
# to the exponent.
SMALLEST = -3_333_333
# If the parts of a complex number differ by this many powers of two, the smaller one counts as
# zero: no digit depends on it, and some functions would write out every place between the two.
APART = 20_000
# The allowed work on one answer at one point, in additions of real numbers; other operations cost
# more. A normal answer of thousands of nodes stays far below; a hostile one would take a minute.
MOST_WORK = 100_000


class Undefined(ArithmeticError):
    """An expression has no finite value at a point, because of a division by zero, say."""


class TooLarge(ArithmeticError):
    """A value exceeds all bounds that an answer can need."""


class NotSupported(ValueError):
    """An expression contains an operation without a value here, so the answer cannot be decided."""


class UnknownSymbol(ValueError):
    """An expression contains a symbol that the question lacks; its name is the argument."""


def values(nodes: Sequence[Node], point: Mapping[str, Number]) -> list[Result]:
    """Return the value of every node: real or complex numbers, Booleans, or the error of each.

    Parameters
    ----------
    nodes : list
        The nodes of a plain answer.
    point : dict
        A number for each symbol, by name.

    An error is kept as the value of its node and is raised by `number`, since the branch of a
    Piecewise that does not apply may be undefined.
    """
    results: list[Result] = []
    work = 0
    for node in nodes:
        try:
            work += _work(node, results)
            if work > MOST_WORK:
                raise TooLarge("it has too many operations")
            results.append(_value(node, results, point))
        except (Undefined, TooLarge, NotSupported, UnknownSymbol) as error:
            results.append(error)
        except ZeroDivisionError:
            results.append(Undefined("division by zero"))
        except (
            ValueError,
            TypeError,
            OverflowError,
            ArithmeticError,
            mpmath.libmp.NoConvergence,
        ) as error:
            results.append(NotSupported(f"{node[0]} ({type(error).__name__})"))
    return results


def number(result: Result) -> Number:
    """Return the number in one of the results of `values`, or raise the error in it."""
    if isinstance(result, Exception):
        raise result
    if isinstance(result, bool):
        raise NotSupported("a Boolean instead of a number")
    return result


def real(result: Result, absolute: Number = ROUNDING, relative: Number = ROUNDING) -> Number:
    """Return the real number in a result.

    Raises ``ValueError`` if its imaginary part exceeds the absolute allowance plus the relative one
    times the real part; by default, only rounding is allowed.
    """
    result = number(result)
    if result in (MP.inf, -MP.inf):
        raise Undefined("it is infinite")
    if isinstance(result, MP.mpc):
        if abs(result.imag) > absolute + relative * abs(result.real):
            raise ValueError("complex")
        return result.real
    return result


# Nodes that contain digits or a name, and no other nodes.
LEAVES = ("symbol", "constant", "integer", "rational", "float")


def _work(node: Node, results: Sequence[Result]) -> int:
    operation, children = node[0], cast(Sequence[int], node[1:])
    if operation in LEAVES:
        return 4
    complex_ones = sum(isinstance(results[child], MP.mpc) for child in children)
    if operation in ("Add", "Mul"):
        return 2 + len(children) + 7 * complex_ones
    return 10 + len(children) + 90 * complex_ones


def _value(node: Node, results: Sequence[Result], point: Mapping[str, Number]) -> Result:
    operation = cast(str, node[0])
    if operation in LEAVES:
        return _leaf(operation, cast(Sequence[str], node[1:]), point)
    arguments = [results[child] for child in cast(Sequence[int], node[1:])]
    if operation == "Piecewise":
        return _first_that_holds(arguments)
    if operation == "ExprCondPair":
        return tuple(arguments)
    for argument in arguments:
        if isinstance(argument, Exception):
            raise argument
    if operation in CONDITIONS:
        if operation not in ("And", "Or", "Not"):
            arguments = [_ordered(argument) for argument in arguments]
        return bool(CONDITIONS[operation](arguments))
    if operation not in FUNCTIONS:
        raise NotSupported(operation)
    return _bounded(FUNCTIONS[operation](*map(number, arguments)))


def _leaf(operation: str, parts: Sequence[str], point: Mapping[str, Number]) -> Result:
    if operation == "rational":
        numerator, denominator = map(int, parts)
        return MP.mpf(numerator) / denominator
    (text,) = parts
    if operation == "symbol":
        if text not in point:
            raise UnknownSymbol(text)
        return point[text]
    if operation == "integer":
        return MP.mpf(int(text))
    if operation == "float":
        return _bounded(MP.mpf(text))
    # These are SymPy's results of 1/0 and of 0/0.
    if text in ("ComplexInfinity", "NaN"):
        raise Undefined("division by zero" if text == "ComplexInfinity" else NOT_A_NUMBER)
    if text not in CONSTANTS:
        raise NotSupported(text)
    return CONSTANTS[text]


def _bounded(result: Number) -> Number:
    if isinstance(result, MP.mpc):
        between = MP.mag(result.real) - MP.mag(result.imag)
        if between > APART:
            result = MP.mpc(result.real)
        elif between < -APART:
            result = MP.mpc(0, result.imag)
    if MP.isnan(result):
        raise Undefined(NOT_A_NUMBER)
    if MP.isinf(result):
        raise Undefined("it is infinite")
    if abs(result) > LARGEST:
        raise TooLarge("the value is larger than 10^60")
    if result and MP.mag(result) < SMALLEST:
        raise NotSupported("a number smaller than 10^-1000000")
    return result


def _first_that_holds(pairs: Iterable[Result]) -> Number:
    for pair in pairs:
        if isinstance(pair, Exception):
            raise pair
        if not isinstance(pair, tuple):
            raise TypeError
        value, condition = pair
        if isinstance(condition, Exception):
            raise condition
        if condition:
            return number(value)
    raise Undefined("no case of the Piecewise applies")


def _ordered(argument: Result) -> Number:
    try:
        return real(argument)
    except ValueError:
        raise NotSupported("a comparison of complex numbers") from None


def _power(base: Number, exponent: Number) -> Number:
    if base == 0:
        if MP.re(exponent) > 0:
            return MP.zero
        if exponent == 0:
            return MP.one
        raise Undefined("division by zero")
    # Check this before evaluation: a power of a power of ten would fill the memory.
    if abs(exponent) > 10_000:
        raise TooLarge("an exponent larger than ten thousand")
    return MP.power(base, exponent)


def _moderate(function: Callable[[Number], Number]) -> Callable[[Number], Number]:
    def bounded(argument: Number) -> Number:
        if abs(argument) > 10**6:
            raise TooLarge("an argument larger than a million")
        return function(argument)

    return bounded


def _real_only(function: Callable[..., Number]) -> Callable[..., Number]:
    return lambda *arguments: function(*map(_ordered, arguments))


NOT_A_NUMBER = "it is NaN, which is not a number"
CONSTANTS = {
    "Pi": +MP.pi,
    "Exp1": +MP.e,
    "ImaginaryUnit": MP.mpc(0, 1),
    "GoldenRatio": +MP.phi,
    "Infinity": +MP.inf,
    "NegativeInfinity": -MP.inf,
    "BooleanTrue": True,
    "BooleanFalse": False,
}

FUNCTIONS: dict[str, Callable[..., Number]] = {
    "Add": lambda *terms: sum(terms, MP.zero),
    "Mul": lambda *factors: MP.fprod(factors),
    "Pow": _power,
    "exp": _moderate(MP.exp),
    "log": lambda argument, base=None: (
        MP.log(argument) if base is None else MP.log(argument) / MP.log(base)
    ),
    "sin": _moderate(MP.sin),
    "cos": _moderate(MP.cos),
    "tan": _moderate(MP.tan),
    "cot": _moderate(MP.cot),
    "sec": _moderate(MP.sec),
    "csc": _moderate(MP.csc),
    "sinc": _moderate(MP.sinc),
    "asin": MP.asin,
    "acos": MP.acos,
    "atan": MP.atan,
    "acot": MP.acot,
    "asec": MP.asec,
    "acsc": MP.acsc,
    "atan2": _real_only(MP.atan2),
    "sinh": _moderate(MP.sinh),
    "cosh": _moderate(MP.cosh),
    "tanh": _moderate(MP.tanh),
    "coth": _moderate(MP.coth),
    "sech": _moderate(MP.sech),
    "csch": _moderate(MP.csch),
    "asinh": MP.asinh,
    "acosh": MP.acosh,
    "atanh": MP.atanh,
    "Abs": abs,
    "sign": _real_only(MP.sign),
    "re": MP.re,
    "im": MP.im,
    "conjugate": MP.conj,
    "arg": MP.arg,
    "Min": _real_only(min),
    "Max": _real_only(max),
    "floor": _real_only(MP.floor),
    "ceiling": _real_only(MP.ceil),
    "Mod": _real_only(lambda argument, modulus: argument - modulus * MP.floor(argument / modulus)),
    "Heaviside": _real_only(
        lambda argument, middle=MP.mpf(1) / 2: {1: MP.one, -1: MP.zero}.get(
            int(MP.sign(argument)), middle
        )
    ),
}

CONDITIONS: dict[str, Callable[[Sequence[Number]], bool]] = {
    "StrictGreaterThan": lambda pair: pair[0] > pair[1],
    "GreaterThan": lambda pair: pair[0] >= pair[1],
    "StrictLessThan": lambda pair: pair[0] < pair[1],
    "LessThan": lambda pair: pair[0] <= pair[1],
    "Equality": lambda pair: abs(pair[0] - pair[1]) < ROUNDING,
    "Unequality": lambda pair: abs(pair[0] - pair[1]) >= ROUNDING,
    "And": all,
    "Or": any,
    "Not": lambda only: not only[0],
}
