"""Whether wrong answers can pass the seals, and whether right ones always do."""

import json
import random
from dataclasses import replace

import pytest
import sympy as sm
from forms_by_chance import mutant, random_form, roots_for_cosines
from seed import SEED
from sympy.core.function import AppliedUndef
from sympy.physics.mechanics import dynamicsymbols
from test_release import COURSE

from coursework.authoring import source as sources
from coursework.authoring.author import question
from coursework.authoring.forms import flat
from coursework.checking.evaluate import MP
from coursework.checking.plain import NotPlain, to_plain
from coursework.checking.question import Question
from coursework.checking.reading import calls_for
from coursework.grading.judging import marking
from coursework.grading.judging.contract import Asked
from coursework.grading.record import Answer

NAMES = sorted(path.stem for path in COURSE.sources.glob("*.ipynb"))


def with_formulas(names):
    for name in names:
        for authored in sources.read_source(COURSE.sources / f"{name}.ipynb").questions.values():
            if authored.public.symbols and not hasattr(authored.answer, "to_matrix"):
                yield authored


def differs(authored, answer):
    """Whether an answer is another one somewhere in its domain: by
    SymPy's numbers, at points of its own.
    """
    first, second = (
        [in_symbols(sm.sympify(entry)) for entry in flat(form)[0]]
        for form in (authored.answer, answer)
    )
    chance = random.Random(authored.name)
    limits = authored.public.symbols
    for _ in range(25):
        point = {
            sm.Symbol(name): sm.Float(chance.uniform(*limit), 30) for name, limit in limits.items()
        }
        point |= {
            symbol: point[sm.Symbol(symbol.name)]
            for symbol in unknown(first)
            if symbol not in point
        }
        for group in authored.public.unit:
            length = sm.sqrt(sum(point[sm.Symbol(name)] ** 2 for name in group))
            point |= {sm.Symbol(name): point[sm.Symbol(name)] / length for name in group}
        values = [
            [sm.N(entry.xreplace(point), 25) for entry in entries] for entries in (first, second)
        ]
        signs = (1, -1) if authored.public.either_sign else (1,)
        if not any(all(abs(a - s * b) < 1e-8 for a, b in zip(*values, strict=True)) for s in signs):
            return True
    return False


def in_symbols(entry):
    """An expression with its functions of time, and their derivatives, as
    the symbols that stand for them.
    """
    rates = {rate: sm.Symbol(f"{rate.expr.func.__name__}'") for rate in entry.atoms(sm.Derivative)}
    entry = entry.xreplace(rates)
    return entry.xreplace(
        {part: sm.Symbol(part.func.__name__) for part in entry.atoms(AppliedUndef)}
    )


def unknown(entries):
    return {symbol for entry in entries for symbol in entry.free_symbols}


def accepted(authored, answer):
    try:
        return authored.reply_to(authored.to_plain(answer)).outcome == "correct"
    except NotPlain:
        return False


def test_functions_of_time_are_told_apart():
    x, dx = dynamicsymbols("x"), dynamicsymbols("x", 1)
    rates_question = question(
        "trial/rates", "expression", x * dx, symbols={"x": (-2, 2), "x'": (-2, 2)}
    )
    assert (
        differs(rates_question, x * dx / 2)
        and differs(rates_question, x * x)
        and not differs(rates_question, (x + x) * dx / 2)
    )


def try_roots(names):
    tried = 0
    for authored in with_formulas(names):
        for name, wrong in roots_for_cosines(authored.answer):
            if accepted(authored, wrong):
                assert not differs(authored, wrong), f"{authored.name} takes {name}"
            tried += 1
    return tried


@pytest.mark.long
def test_no_root_passes_for_a_cosine_in_any_question():
    """The two agree where the cosine is positive, and all points once lay there."""
    assert try_roots(NAMES) >= 150


def try_mutants(names, each):
    tried, passed = 0, []
    for authored in with_formulas(names):
        chance = random.Random(f"{SEED} {authored.name}")
        for _ in range(each):
            wrong = mutant(authored.answer, chance)
            tried += 1
            if accepted(authored, wrong) and differs(authored, wrong):
                passed.append((authored.name, wrong))
    assert not passed
    return tried


def test_no_mutant_of_an_answer_passes():
    assert try_mutants(["simple-orientations", "axis-and-angle"], 12) >= 24


@pytest.mark.long
def test_no_mutant_of_any_answer_passes():
    assert try_mutants(NAMES, 30) >= 1900


def try_forms(names, number):
    """Check right answers in many forms, and mark them at the points of a
    secret too; gives how many were tried.
    """
    tried, secretly = 0, 0
    for name in names:
        for authored in sources.read_source(COURSE.sources / f"{name}.ipynb").questions.values():
            chance = random.Random(f"{SEED} {authored.name}")
            known = marking.contract_of(authored, f"a secret of {SEED}".encode())
            secretly += known.secret is not None
            for _ in range(number if not hasattr(authored.answer, "to_matrix") else 1):
                form = random_form(authored.public, authored.answer, chance)
                plain = authored.to_plain(form)
                reply = authored.reply_to(plain)
                assert reply.outcome == "correct", (authored.name, form, reply)
                recorded = Answer("recorded", json.loads(json.dumps(plain)))
                if known.secret and known.secret.calls:
                    calls = calls_for(known.secret.of(authored.public))
                    recorded = replace(
                        recorded,
                        secret={"plain": to_plain(form, calls), "calls": known.secret.digest},
                    )
                verdict = marking.mark(authored.name, Asked(known), recorded)
                assert verdict.points == authored.worth, (authored.name, form, verdict)
                tried += 1
    assert secretly
    return tried


def test_forms_of_right_answers_pass_and_lose_nothing_by_the_secret():
    assert try_forms(["axis-and-angle"], 4) >= 20


@pytest.mark.long
def test_every_form_of_every_right_answer_passes():
    assert try_forms(NAMES, 15) >= 2000


@pytest.mark.parametrize("salt", range(12))
def test_every_angle_is_tried_in_all_four_quadrants(salt):
    from coursework.checking.points import points

    names = "alpha beta gamma psi".split()
    sampled = points(Question("expression", f"{salt}", symbols={name: [-3, 3] for name in names}))
    signs = []
    for name in names:
        quadrants = {(MP.sin(point[name]) > 0, MP.cos(point[name]) > 0) for point in sampled}
        assert len(quadrants) == 4
        for function in (MP.sin, MP.cos):
            column = tuple(function(point[name]) > 0 for point in sampled)
            signs.append(tuple(sign == column[0] for sign in column))
    # So the root of a product of two squares does not pass for the product either.
    assert len(set(signs)) == len(signs)
