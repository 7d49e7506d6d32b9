"""The attack on the seals, and whether wrong answers can pass them."""

import json
import random
from dataclasses import replace

import numpy as np
import pytest
import sympy as sm
from forms_by_chance import mutant, random_form, roots_for_cosines
from seed import SEED
from sympy.core.function import AppliedUndef
from sympy.physics.mechanics import dynamicsymbols
from test_release import COURSE

from coursework.authoring import source as sources
from coursework.authoring.attack import At, Family, attack, families, fingerprints_of, really_attack
from coursework.authoring.author import question
from coursework.authoring.forms import flat
from coursework.authoring.selftest import try_question
from coursework.checking.evaluate import MP
from coursework.checking.plain import NotPlain, to_plain
from coursework.checking.question import Question, Variant
from coursework.checking.reading import calls_for, canonical, fingerprint, read
from coursework.grading.judging import marking
from coursework.grading.judging.contract import Asked
from coursework.grading.record import Answer
from orientation import (
    angular_velocity_matrix,
    dcm_from_body_fixed,
    dcm_from_quaternion,
    dcm_from_rotation_vector,
    simple_dcm,
)

FRAMES = {"frames": ("A", "N")}

theta, alpha, phi = sm.symbols("theta alpha varphi")
ABOUT_X = question(
    "trial/x",
    "direction cosine matrix",
    simple_dcm("x", -theta),
    frames=("A", "N"),
    symbols="theta",
    turns=[("x", -theta)],
)
GIMBAL = question(
    "trial/g",
    "direction cosine matrix",
    dcm_from_body_fixed((theta, alpha, phi), "zxy"),
    frames=("D", "A"),
    symbols="theta alpha varphi",
    turns=[("z", theta), ("x", alpha), ("y", phi)],
)
NUMBER = question("trial/n", "expression", sm.pi / 7, tolerance=0.01)
CLAIMS = question("trial/t", "truth values", [True, False, True, True, False, False], length=6)


@pytest.mark.parametrize("one", [ABOUT_X, GIMBAL, NUMBER, CLAIMS], ids=lambda one: one.name)
def test_what_the_author_counts_is_what_a_student_would_spend(one):
    counted = attack(one, budget=3000)
    assert counted.way
    if counted.tries <= 100:
        assert really_attack(one.sealed(), budget=120) == counted


def test_an_answer_that_can_be_guessed_is_found():
    assert try_question(ABOUT_X).attack.tries <= 6


def test_the_angular_velocity_of_successive_turns_is_found_along_both_frames():
    psi, elevation = dynamicsymbols("psi theta")
    psi_dot, up = psi.diff(), elevation.diff()
    along_the_last = [up, psi_dot * sm.sin(elevation), psi_dot * sm.cos(elevation)]
    along_the_first = [up * sm.cos(psi), up * sm.sin(psi), psi_dot]
    for answer in (along_the_last, along_the_first):
        one = question(
            "trial/radar",
            "vector",
            answer,
            frames=("C",),
            symbols="psi theta psi' theta'",
            length=3,
        )
        assert attack(one, budget=3000).way.startswith("the angular velocity of turns")


@pytest.mark.long
def test_the_functions_of_the_course_are_applied_to_the_data_of_a_question():
    """None of these is a turn about an axis through a special angle; each is one
    to three calls with what is given.
    """
    force, field, whole = [0.087, -0.122, 0.985], [-3.1, 21.4, -40.2], [4, -2, 5, 1]
    away = np.cross(force, np.cross(field, force))
    unit = np.array(whole) / np.linalg.norm(whole)
    vectors, quaternion = {"force": force, "field": field}, {"whole": whole, "field": field}
    angles = {"psi": 0.3, "theta": 0.8, "phi": -0.5, "field": field}
    rates = np.linalg.solve(angular_velocity_matrix([0.3, 0.8, -0.5], "zxy"), field)
    turned, sky = (
        dcm_from_rotation_vector(force).tolist(),
        r"It is $-\tfrac{3}{5}\hat{n}_x + \tfrac{4}{5}\hat{n}_z$.",
    )
    tried = {
        "a cross product": ("vector", np.cross(field, force).tolist(), {}, vectors, "", 300),
        "its length": (
            "expression",
            float(np.linalg.norm(np.cross(field, force))),
            {},
            vectors,
            "",
            3000,
        ),
        "a rotation vector": (
            "direction cosine matrix",
            dcm_from_rotation_vector(force),
            FRAMES,
            vectors,
            "",
            3000,
        ),
        "two directions": ("vector", (away / np.linalg.norm(away)).tolist(), {}, vectors, "", 6000),
        "turned": (
            "vector",
            (np.asarray(dcm_from_quaternion(unit)).T @ field).tolist(),
            {},
            quaternion,
            "",
            6000,
        ),
        "of a gimbal": ("vector", rates.tolist(), {}, angles, "The gimbal is z-x-y.", 6000),
        "angles with the axes": (
            "vector",
            np.degrees(np.arccos(unit[:3])).tolist(),
            {},
            {"row": whole},
            "",
            20000,
        ),
        "a matrix and a row": ("matrix", [*turned, field], {"shape": (4, 3)}, vectors, "", 20000),
        "a sum in the text": (
            "direction cosine matrix",
            dcm_from_rotation_vector([-0.6, 0, 0.8]),
            FRAMES,
            {},
            sky,
            3000,
        ),
    }
    for name, (kind, answer, about, data, text, most) in tried.items():
        found = attack(
            question("trial/data", kind, answer, variant=Variant(0, 2, data), **about), text
        )
        assert found.way and found.tries < most, (name, found)


def test_turns_are_composed_of_which_one_begins_at_a_quarter_turn():
    """As where an angle is counted from the horizon, and the frame begins upright."""
    about = {"frames": ("T", "N"), "symbols": "alpha theta"}
    answer = simple_dcm("z", -alpha) * simple_dcm("y", theta - sm.pi / 2)
    found = attack(
        question("trial/shifted", "direction cosine matrix", answer, **about), budget=4000
    )
    assert "from a quarter turn on" in found.way


@pytest.mark.long
def test_a_function_of_turns_is_attacked_by_some_of_them():
    """A question whose answer is a loop over the turns has candidates, and
    is found where one turn is enough.
    """

    def first(turns):
        (_, angle), *_ = turns
        return [np.cos(angle / 2), 0, 0, np.sin(angle / 2)]

    calls = [[[["z", 0.3], ["x", 0.5]]], [[["z", -1.1]]], [[["z", 2.0], ["y", 1], ["x", 3]]]]
    about = {"result": "quaternion", "calls": calls, "tolerance": 1e-9}
    found = attack(question("trial/first", "function", first, **about), budget=2000)
    assert found.way.startswith("some of the turns") and found.tries < 100
    found = attack(
        question("trial/none", "function", lambda turns: [0.6, 0, 0.48, 0.64], **about), budget=2000
    )
    assert not found.way and found.tries > 30


def test_a_list_of_pairs_of_numbers_is_not_taken_for_turns():
    """The attack once stopped with an error at a function that is given points of a plane."""
    calls = [[[[0.3, 0.5], [1.0, 2.0]]], [[[-1.1, 0.2]]]]
    about = {"result": "quaternion", "calls": calls, "tolerance": 1e-9}
    found = attack(
        question("trial/plane", "function", lambda points: [0.6, 0, 0.48, 0.64], **about),
        budget=100,
    )
    assert not found.way


def test_the_reply_to_a_mistake_shortens_the_attack():
    """Turned through the wrong sign, the reply says so: no other choice need be tried."""
    assert "by the reply" in attack(GIMBAL).way
    assert attack(GIMBAL).tries < 3 * 6 * 27 * 8 / 2


def test_fingerprints_in_double_precision_are_those_of_the_check():
    chance = random.Random(SEED)
    for one in (GIMBAL, NUMBER, ABOUT_X):
        for _ in range(20):
            form = (
                random_form(one.public, one.answer, chance)
                if one is not NUMBER
                else chance.uniform(-3, 3)
            )
            reading = read(one.public, to_plain(form))
            numbers = np.array([[float(number) for number in canonical(one.public, reading)]])
            assert fingerprints_of(one.public, numbers) == [fingerprint(one.public, reading)]


def test_the_candidates_hold_the_answers_of_those_who_know_the_subject():
    ways = {family.name for family in families(GIMBAL.public)}
    assert "turns about the axes through the symbols" in ways
    assert isinstance(next(families(GIMBAL.public)), Family)
    at = At(GIMBAL.public, "Turn it by 25 degrees, then by 0.5 rad.")
    assert at.given == [0.5, 25.0]


# --- wrong answers ------------------------------------------------------------------------------

NAMES = sorted(path.stem for path in COURSE.sources.glob("*.ipynb"))


def with_formulas(names):
    for name in names:
        for one in sources.read_source(COURSE.sources / f"{name}.ipynb").questions.values():
            if one.public.symbols and not hasattr(one.answer, "to_matrix"):
                yield one


def differs(one, answer):
    """Whether an answer is another one somewhere in its domain: by
    SymPy's numbers, at points of its own.
    """
    first, second = (
        [in_symbols(sm.sympify(entry)) for entry in flat(form)[0]] for form in (one.answer, answer)
    )
    chance = random.Random(one.name)
    limits = one.public.symbols
    for _ in range(25):
        point = {
            sm.Symbol(name): sm.Float(chance.uniform(*limit), 30) for name, limit in limits.items()
        }
        point |= {
            symbol: point[sm.Symbol(symbol.name)]
            for symbol in unknown(first)
            if symbol not in point
        }
        for group in one.public.unit:
            length = sm.sqrt(sum(point[sm.Symbol(name)] ** 2 for name in group))
            point |= {sm.Symbol(name): point[sm.Symbol(name)] / length for name in group}
        values = [
            [sm.N(entry.xreplace(point), 25) for entry in entries] for entries in (first, second)
        ]
        signs = (1, -1) if one.public.either_sign else (1,)
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


def accepted(one, answer):
    try:
        return one.reply_to(one.to_plain(answer)).outcome == "correct"
    except NotPlain:
        return False


def test_functions_of_time_are_told_apart():
    x, dx = dynamicsymbols("x"), dynamicsymbols("x", 1)
    one = question("trial/rates", "expression", x * dx, symbols={"x": (-2, 2), "x'": (-2, 2)})
    assert differs(one, x * dx / 2) and differs(one, x * x) and not differs(one, (x + x) * dx / 2)


def try_roots(names):
    tried = 0
    for one in with_formulas(names):
        for name, wrong in roots_for_cosines(one.answer):
            if accepted(one, wrong):
                assert not differs(one, wrong), f"{one.name} takes {name}"
            tried += 1
    return tried


@pytest.mark.long
def test_no_root_passes_for_a_cosine():
    """Found in the first edition: these agree where the cosine is
    positive, and the points were there only.
    """
    assert try_roots(["cases-from-practice", "orientation-in-motion"]) >= 10


@pytest.mark.long
def test_no_root_passes_for_a_cosine_in_any_question():
    assert try_roots(NAMES) >= 150


def try_mutants(names, each):
    tried, passed = 0, []
    for one in with_formulas(names):
        chance = random.Random(f"{SEED} {one.name}")
        for _ in range(each):
            wrong = mutant(one.answer, chance)
            tried += 1
            if accepted(one, wrong) and differs(one, wrong):
                passed.append((one.name, wrong))
    assert not passed, f"BOOK_TEST_SEED={SEED}"
    return tried


def test_no_mutant_of_an_answer_passes():
    assert try_mutants(["simple-orientations", "axis-and-angle"], 12) >= 24


@pytest.mark.long
def test_no_mutant_of_any_answer_passes():
    assert try_mutants(NAMES, 102) >= 6600


def try_forms(names, number):
    """Check right answers in many forms, and mark them at the points of a
    secret too; gives how many were tried.
    """
    tried, secretly = 0, 0
    for name in names:
        for one in sources.read_source(COURSE.sources / f"{name}.ipynb").questions.values():
            chance = random.Random(f"{SEED} {one.name}")
            known = marking.contract_of(one, f"a secret of {SEED}".encode())
            secretly += known.secret is not None
            for _ in range(number if not hasattr(one.answer, "to_matrix") else 1):
                form = random_form(one.public, one.answer, chance)
                plain = one.to_plain(form)
                reply = one.reply_to(plain)
                assert reply.outcome == "correct", (one.name, form, reply, f"BOOK_TEST_SEED={SEED}")
                said = Answer("recorded", json.loads(json.dumps(plain)))
                if known.secret and known.secret.calls:
                    calls = calls_for(known.secret.of(one.public))
                    said = replace(
                        said, secret={"plain": to_plain(form, calls), "calls": known.secret.digest}
                    )
                found = marking.mark(one.name, Asked(known), said)
                assert found.points == one.worth, (one.name, form, found, f"BOOK_TEST_SEED={SEED}")
                tried += 1
    assert secretly
    return tried


def test_forms_of_right_answers_pass_and_lose_nothing_by_the_secret():
    assert try_forms(["axis-and-angle"], 4) >= 20


@pytest.mark.long
def test_every_form_of_every_right_answer_passes():
    assert try_forms(NAMES, 45) >= 6000


@pytest.mark.parametrize("salt", range(12))
def test_every_angle_is_tried_in_all_four_quadrants(salt):
    from coursework.checking.points import points

    names = "alpha beta gamma psi".split()
    found = points(Question("expression", f"{salt}", symbols={name: [-3, 3] for name in names}))
    signs = []
    for name in names:
        quadrants = {(MP.sin(point[name]) > 0, MP.cos(point[name]) > 0) for point in found}
        assert len(quadrants) == 4
        for function in (MP.sin, MP.cos):
            column = tuple(function(point[name]) > 0 for point in found)
            signs.append(tuple(sign == column[0] for sign in column))
    # So the root of a product of two squares does not pass for the product either.
    assert len(set(signs)) == len(signs)
