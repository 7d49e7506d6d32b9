"""Answers made up by chance: the right one in forms that nobody
thinks of, and such as are nearly right.
"""

import random
from collections.abc import Callable, Sequence
from dataclasses import replace

import sympy
from sympy import I, Rational, cos, exp, pi, sin, sqrt, tan
from sympy.core.function import AppliedUndef

from coursework.authoring.forms import (
    COSINES,
    SINES,
    Answer,
    Form,
    equivalent_forms,
    flat,
    unknowns,
)
from coursework.checking.plugins import kinds
from coursework.checking.question import Question


def random_form(public: Question, answer: Answer, chance: random.Random) -> Answer:
    """Give the same answer in a form made up by chance, as one who
    simplifies nothing might write it.
    """
    kind = public.kind
    if kind == "measurement":
        return (random_form(replace(public, kind="expression"), answer[0], chance), answer[1])
    if kinds()[kind].text or kind == "function":
        return chance.choice(equivalent_forms(public, answer))[1]
    entries, put = flat(answer)
    free = unknowns(entries)
    if not free:
        tolerance = public.tolerance
        if tolerance is not None and chance.random() < 0.6:
            result = put(
                [float(entry) + chance.uniform(-0.9, 0.9) * tolerance for entry in entries]
            )
        else:
            result = put([_shuffled_number(sympy.sympify(entry), chance) for entry in entries])
    else:
        result = put([_shuffled(sympy.sympify(entry), chance, free) for entry in entries])
        changes = {
            symbol: chance.choice(
                [
                    symbol,
                    sympy.Symbol(str(symbol), real=True),
                    sympy.Function(str(symbol))(sympy.Symbol("t")),
                ]
            )
            for symbol in free
            if isinstance(symbol, sympy.Symbol)
        }
        again, put = flat(result)
        result = put([sympy.sympify(entry).xreplace(changes) for entry in again])
    if isinstance(result, sympy.MatrixBase):
        result = chance.choice(
            [lambda m: m, sympy.ImmutableMatrix, lambda m: m.tolist() if m.cols > 1 else list(m)]
        )(result)
    return result


def _shuffled(
    expression: sympy.Expr, chance: random.Random, free: Sequence[sympy.Expr]
) -> sympy.Expr:
    if isinstance(expression, (sin, cos)) and chance.random() < 0.5:
        table = SINES if isinstance(expression, sin) else COSINES
        return table[chance.choice(sorted(table))](expression.args[0])
    if not expression.args or isinstance(expression, (AppliedUndef, sympy.Derivative)):
        return expression
    result = expression.func(*(_shuffled(part, chance, free) for part in expression.args))
    luck = chance.random()
    if luck < 0.1:
        symbol = chance.choice(free)
        return sympy.Mul(
            result, sympy.Add(sin(symbol) ** 2, cos(symbol) ** 2, evaluate=False), evaluate=False
        )
    if luck < 0.2:
        extra = chance.choice(free) + chance.randint(1, 5)
        return sympy.Add(result, extra, -extra, evaluate=False)
    if luck < 0.3:
        return sympy.expand(result)
    if luck < 0.35:
        return sympy.Mul(2, result / 2, evaluate=False)
    return result


def _shuffled_number(number: sympy.Expr, chance: random.Random) -> sympy.Expr:
    forms: list[Callable[[], sympy.Expr]] = [
        lambda: number,
        lambda: number.evalf(30),
        lambda: sympy.Add(number, pi, -pi, evaluate=False),
        lambda: sympy.Mul(number, sqrt(3), 1 / sqrt(3), evaluate=False),
        lambda: sympy.Mul(number, exp(I * pi / 7), exp(-I * pi / 7), evaluate=False),
    ]
    return chance.choice(forms)()


def roots_for_cosines(answer: Answer) -> list[Form]:
    """Answers in which one function of one symbol is a root that
    agrees with it in some quadrants only.

    Pairs of a name and an answer: ``sqrt(1 - sin(x)**2)`` for ``cos(x)``, for every
    symbol and function that occurs.
    """
    entries, put = flat(answer)
    entries = [sympy.sympify(entry) for entry in entries]
    forms = []
    for function, cofunction in ((cos, sin), (sin, cos)):
        for part in sorted(set().union(*(entry.atoms(function) for entry in entries)), key=str):
            root = sqrt(1 - cofunction(part.args[0]) ** 2)
            forms.append(
                (f"{root} for {part}", put([entry.xreplace({part: root}) for entry in entries]))
            )
    return forms


def mutant(answer: Answer, chance: random.Random) -> Answer:
    """The answer with one small thing changed by chance; it may still be
    right, and whoever asks must look.
    """
    entries, put = flat(answer)
    entries = [sympy.sympify(entry) for entry in entries]
    place = chance.randrange(len(entries))
    entries[place] = _mutated(entries[place], chance)
    return put(entries)


def _mutated(expression: sympy.Expr, chance: random.Random) -> sympy.Expr:
    parts = [
        part for part in sympy.preorder_traversal(expression) if not isinstance(part, AppliedUndef)
    ]
    part = chance.choice(parts)
    changes = [lambda: -part, lambda: 2 * part, lambda: part / 2, lambda: part + Rational(1, 1000)]
    if isinstance(part, (sin, cos)):
        changes += [lambda: (cos if isinstance(part, sin) else sin)(part.args[0])] * 3
        changes += [
            lambda: part.func(2 * part.args[0]),
            lambda: tan(part.args[0]),
            lambda: sympy.Abs(part),
        ]
        changes += [
            lambda: sqrt(1 - (cos if isinstance(part, sin) else sin)(part.args[0]) ** 2)
        ] * 3
    if isinstance(part, (sympy.Add, sympy.Mul)) and len(part.args) > 1:
        changes += [
            lambda: part.func(*part.args[1:]),
            lambda: part.func(-part.args[0], *part.args[1:]),
        ] * 2
    if isinstance(part, sympy.Symbol):
        changes += [
            lambda: sympy.Abs(part),
            lambda: chance.choice(sorted(expression.free_symbols, key=str)),
        ] * 2
    if not expression.has(part):
        return expression
    try:
        return expression.xreplace({part: chance.choice(changes)()})
    except (TypeError, ValueError, ZeroDivisionError):
        return expression
