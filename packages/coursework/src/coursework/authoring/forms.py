"""Equivalent forms of an answer for testing checks, since students rarely write the author's."""

import functools
import itertools
import random
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import Any, TypeAlias

import sympy
from sympy import I, Rational, cos, exp, pi, sin, sqrt, tan
from sympy.core.function import AppliedUndef

from ..checking.mistakes import unknowns_of
from ..checking.plugins import kinds
from ..checking.question import Question
from ..checking.units import BASE, unit

#: An answer as authors and students write it: an expression, matrix, list, string or function.
Answer: TypeAlias = Any
#: A function that puts entries into the shape of an answer.
Put: TypeAlias = Callable[[Iterable[Answer]], Answer]
Change: TypeAlias = Callable[[sympy.Expr], Answer]
#: The name of a form, and an answer in it.
Form: TypeAlias = tuple[str, Answer]

#: Ways of writing the sine and the cosine, each a function of the argument.
SINES = {
    "as a cosine": lambda x: cos(pi / 2 - x, evaluate=False),
    "half angle": lambda x: 2 * sin(x / 2) * cos(x / 2),
    "exponentials": lambda x: (exp(I * x) - exp(-I * x)) / (2 * I),
    "tangent": lambda x: tan(x) * cos(x),
    "half tangent": lambda x: 2 * tan(x / 2) / (1 + tan(x / 2) ** 2),
    "negative argument": lambda x: -sin(-x, evaluate=False),
}
COSINES = {
    "as a sine": lambda x: sin(pi / 2 - x, evaluate=False),
    "half angle": lambda x: cos(x / 2) ** 2 - sin(x / 2) ** 2,
    "exponentials": lambda x: (exp(I * x) + exp(-I * x)) / 2,
    "double angle": lambda x: 1 - 2 * sin(x / 2) ** 2,
    "half tangent": lambda x: (1 - tan(x / 2) ** 2) / (1 + tan(x / 2) ** 2),
    "negative argument": lambda x: cos(-x, evaluate=False),
}


def _rewrite(expression: sympy.Expr, sines: Change, cosines: Change) -> sympy.Expr:
    """Return an expression with each sine and cosine written in another way."""
    if isinstance(expression, sin):
        return sines(_rewrite(expression.args[0], sines, cosines))
    if isinstance(expression, cos):
        return cosines(_rewrite(expression.args[0], sines, cosines))
    if not expression.args or isinstance(expression, (AppliedUndef, sympy.Derivative)):
        return expression
    return expression.func(*(_rewrite(part, sines, cosines) for part in expression.args))


def unknowns(entries: Iterable[Answer]) -> list[sympy.Expr]:
    """Return the symbols and functions of time in some expressions."""
    return sorted(set().union(*map(unknowns_of, map(sympy.sympify, entries))), key=str)


def flat(answer: Answer) -> tuple[list[Answer], Put]:
    """Return a matrix's or nested list's entries, and a function that restores the shape."""
    if isinstance(answer, sympy.MatrixBase):
        return list(answer.flat()), lambda entries: sympy.Matrix(*answer.shape, list(entries))
    if not isinstance(answer, sympy.Basic) and hasattr(answer, "tolist"):
        answer = answer.tolist()
    if isinstance(answer, (list, tuple)):
        parts = [flat(part) for part in answer]
        lengths = [len(entries) for entries, _ in parts]

        def together(entries: Iterable[Answer]) -> Answer:
            waiting = iter(list(entries))
            return [
                put(list(itertools.islice(waiting, length)))
                for (_, put), length in zip(parts, lengths)
            ]

        return [entry for entries, _ in parts for entry in entries], together
    return [sympy.sympify(answer)], lambda entries: list(entries)[0]


def equivalent_forms(public: Question, answer: Answer) -> list[Form]:
    """Return the same answer in several forms, as pairs (name of the form, answer)."""
    kind, more = public.kind, kinds()[public.kind].forms
    forms = _common_forms(public, kind, answer)
    return [*forms, *more(public, answer)] if more else forms


def _quantity(exponents: Iterable[int]) -> sympy.Expr:
    from sympy.physics import units

    return sympy.Mul(*(getattr(units, name) ** power for name, power in zip(BASE, exponents)))


def _common_forms(public: Question, kind: str, answer: Answer) -> list[Form]:
    if kind == "truth values":
        answer = list(answer)
        return [
            ("list", answer),
            ("tuple", tuple(answer)),
            ("SymPy", [sympy.sympify(part) for part in answer]),
            ("copy", list(answer)),
        ]
    if kind == "measurement":
        number, text = answer
        given = unit(text)
        powers = (f"{name}^{power}" for name, power in zip(BASE, given.exponents) if power)
        base = " ".join(powers) or "1"
        forms = _common_forms(replace(public, kind="expression"), "expression", number)
        forms = [(name, (form, text)) for name, form in forms]
        return [
            *forms,
            ("a list", [number, f" {text} "]),
            ("in base units", (sympy.sympify(number) * given.size, base)),
            ("SymPy's quantities", sympy.sympify(number) * given.size * _quantity(given.exponents)),
        ]
    if kind in ("words", "order"):
        return [
            ("list", list(answer)),
            ("tuple", tuple(answer)),
            ("capitals", [part.upper() for part in answer]),
            ("spaces", [f" {part} " for part in answer]),
        ]
    if kind == "function":
        return [
            ("itself", answer),
            ("wrapped", lambda *arguments: answer(*arguments)),
            ("as lists", lambda *arguments: _as_lists(answer(*arguments))),
        ]
    if kinds()[kind].text:
        return [("itself", answer), ("capitals", answer.upper()), ("spaces around", f"  {answer} ")]
    if hasattr(answer, "to_matrix"):
        return [("itself", answer)]
    entries, put = flat(answer)
    return (
        _forms_of_numbers(public, answer, entries, put)
        if not unknowns(entries)
        else _forms_of_symbols(public, answer, entries, put)
    )


def _as_lists(result: Answer) -> Answer:
    entries, put = flat(list(result) if getattr(result, "shape", ())[1:] == (1,) else result)
    return put(entries)


def _forms_of_symbols(
    public: Question, answer: Answer, entries: Sequence[Answer], put: Put
) -> list[Form]:
    forms = [("itself", answer)]

    def add(name: str, change: Change) -> None:
        forms.append((name, put([change(sympy.sympify(entry)) for entry in entries])))

    add("expanded", sympy.expand)
    for name in ("half angle", "exponentials", "half tangent", "negative argument"):
        add(name, functools.partial(_rewrite, sines=SINES[name], cosines=COSINES[name]))
    add(
        "one added as squares",
        lambda entry: (
            entry
            * sympy.Add(
                sin(unknowns(entries)[0]) ** 2, cos(unknowns(entries)[0]) ** 2, evaluate=False
            )
        ),
    )
    plain = [symbol for symbol in unknowns(entries) if isinstance(symbol, sympy.Symbol)]
    time = sympy.Symbol("t")
    add(
        "other assumptions",
        lambda entry: entry.xreplace(
            {symbol: sympy.Symbol(symbol.name, real=True) for symbol in plain}
        ),
    )
    add(
        "functions of time",
        lambda entry: entry.xreplace(
            {symbol: sympy.Function(symbol.name)(time) for symbol in plain}
        ),
    )
    if isinstance(answer, sympy.MatrixBase):
        forms += [
            ("nested list", answer.tolist() if answer.cols > 1 else list(answer)),
            ("immutable", sympy.ImmutableMatrix(answer)),
            ("product", sympy.MatMul(sympy.ImmutableMatrix(answer), sympy.Identity(answer.cols))),
        ]
    if public.either_sign:
        add("other sign", lambda entry: -entry)
    return forms


def _forms_of_numbers(
    public: Question, answer: Answer, entries: Sequence[Answer], put: Put
) -> list[Form]:
    def each(change: Change) -> Answer:
        return put([change(sympy.sympify(entry)) for entry in entries])

    forms = [
        ("itself", answer),
        ("15 digits", each(lambda entry: entry.evalf(15))),
        ("floats", each(lambda entry: float(entry))),
        ("20 digits", each(lambda entry: entry.evalf(20))),
        ("sum of two", each(lambda entry: sympy.Add(entry / 3, 2 * entry / 3, evaluate=False))),
        ("by a root", each(lambda entry: sympy.Mul(entry / 2, sqrt(2), sqrt(2), evaluate=False))),
    ]
    digits = _digits(public)
    if digits is not None:
        forms.append((f"{digits} decimals", each(lambda entry: round(float(entry), digits))))
    if isinstance(answer, sympy.MatrixBase):
        forms += [
            ("nested list", answer.tolist() if answer.cols > 1 else list(answer)),
            ("immutable", sympy.ImmutableMatrix(answer)),
        ]
    if public.either_sign:
        forms.append(("other sign", each(lambda entry: -entry)))
    return forms


def _digits(public: Question) -> int | None:
    """Return how many decimals are enough for the tolerance of a question."""
    tolerance = public.tolerance
    if tolerance is None:
        return None
    return next(digits for digits in itertools.count() if 0.5 * 10**-digits <= tolerance)


def another_answer(public: Question, answer: Answer, chance: random.Random | None = None) -> Answer:
    """Return an answer of the right form that is neither right nor a mistake of the catalogue."""
    chance = chance or random.Random(1)
    kind = public.kind
    if kind == "function":
        return lambda *arguments: another_answer(
            replace(public, kind=public.kind_of_values), answer(*arguments), random.Random(1)
        )
    if another := kinds()[kind].another:
        return another(public, answer)
    if kind == "choice":
        return next(option for option in public.options if option.lower() != answer.lower())
    if kind == "truth values":
        changed = chance.randrange(len(answer))
        return [part != (order == changed) for order, part in enumerate(answer)]
    if kind == "order":
        return chance.sample(list(answer), len(answer))
    if kind == "measurement":
        return (another_answer(replace(public, kind="expression"), answer[0]), answer[1])
    if kind == "words":
        return [another_answer(replace(public, kind="choice"), part) for part in answer]
    if hasattr(answer, "to_matrix"):
        return answer * Rational(17, 13)
    entries, put = flat(answer)
    return put(
        [entry * Rational(17, 13) + Rational(11, 37) for entry in map(sympy.sympify, entries)]
    )
