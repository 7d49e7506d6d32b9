"""Answers as plain data, with values compared with SymPy, and hostile answers that explode."""

import json
import random
import subprocess
import sys

import pytest
import sympy as sm

from coursework.checking.evaluate import FUNCTIONS, MP, number, values
from coursework.checking.plain import NotPlain, read_plain, to_plain

x, y = sm.symbols("x y")
POINT = {"x": MP.mpf("0.37"), "y": MP.mpf("-0.81"), "x'": MP.mpf("2.5")}


def value_of(expression, point=POINT):
    plain = read_plain(json.loads(json.dumps(to_plain(expression))))
    assert plain["value"][0] == "expression"
    return number(values(plain["nodes"], point)[plain["value"][1]])


EXPRESSIONS = [
    x + y,
    x * y / 3,
    x**y,
    x**-2,
    sm.sqrt(x),
    sm.exp(x * y),
    sm.exp(sm.I * x),
    sm.log(x),
    sm.log(x, 10),
    sm.sin(x),
    sm.cos(x),
    sm.tan(x),
    sm.cot(x),
    sm.sec(x),
    sm.csc(x),
    sm.sinc(x),
    sm.asin(y),
    sm.acos(y),
    sm.atan(y),
    sm.acot(y),
    sm.asec(3 + x),
    sm.acsc(3 + x),
    sm.atan2(y, x),
    sm.atan2(-y, -x),
    sm.sinh(x),
    sm.cosh(x),
    sm.tanh(x),
    sm.coth(x),
    sm.sech(x),
    sm.csch(x),
    sm.asinh(x),
    sm.acosh(2 + x),
    sm.atanh(x),
    sm.Abs(y),
    sm.sign(y),
    sm.re(x + sm.I * y),
    sm.im(x + sm.I * y),
    sm.conjugate(x + sm.I * y),
    sm.arg(x + sm.I * y),
    sm.Min(x, y),
    sm.Max(x, y),
    sm.floor(10 * y),
    sm.ceiling(10 * y),
    sm.Mod(7 * y, 2),
    sm.Heaviside(y),
    sm.Heaviside(x),
    sm.pi,
    sm.E,
    sm.GoldenRatio,
    sm.Rational(22, 7),
    sm.Float("0.1", 30),
    sm.Piecewise((x, x > 1), (y, y < 0), (3, True)),
    sm.Piecewise((1 / (x - x), x > 1), (y, True)),
    sm.UnevaluatedExpr(x + 1),
    sm.Add(x, -x, evaluate=False),
]


@pytest.mark.parametrize("expression", EXPRESSIONS, ids=str)
def test_the_value_is_what_sympy_gives(expression):
    expected = sm.N(expression.subs({x: sm.Rational(37, 100), y: sm.Rational(-81, 100)}).doit(), 30)
    parts = [MP.mpf(str(sm.N(part, 30))) for part in expected.as_real_imag()]
    assert abs(value_of(expression) - MP.mpc(*parts)) < MP.mpf(10) ** -25


def test_every_function_was_compared():
    written = {node[0] for expression in EXPRESSIONS for node in to_plain(expression)["nodes"]}
    assert set(FUNCTIONS) - written - {"Add", "Mul"} == set()


def test_a_shared_part_is_written_once():
    import sympy.physics.units  # noqa: F401  from then on, units are looked for in every answer

    expression = x
    for _ in range(60):
        expression = sm.sin(expression) * sm.cos(expression, evaluate=False)
    assert len(to_plain(expression)["nodes"]) < 200


TOWER = sm.Pow(10, sm.Pow(10, 10, evaluate=False), evaluate=False)


@pytest.mark.parametrize(
    "expression",
    [
        TOWER,
        sm.Pow(TOWER, TOWER, evaluate=False),
        sm.exp(sm.exp(sm.exp(100 * x))),
        sm.Pow(x, -TOWER, evaluate=False),
        sm.sin(10**40 * x),
        sm.cosh(1000 * x),
        sm.Integer(10) ** 300 * x,
        sm.Integral(sm.sin(x**x), (x, 0, 1)),
        sm.gamma(x),
    ],
    ids=range(9),
)
def test_values_beyond_bounds_are_refused(expression):
    plain = to_plain(expression)
    assert isinstance(values(plain["nodes"], POINT)[plain["value"][1]], Exception)


def test_random_data_is_refused_or_read_without_any_other_error():
    chance = random.Random(3)
    pieces = [
        None,
        True,
        1,
        -1,
        2.5,
        "x",
        "integer",
        "Add",
        [],
        {},
        ["blank"],
        ["expression", 0],
        ["symbol", "x"],
        ["Piecewise", 0],
        ["ExprCondPair", 0, 1],
        ["And", 0],
        ["Not", 0],
        ["log", 0],
        ["Pow", 0, 0],
        ["Heaviside", 0],
    ]
    for _ in range(3000):
        data = {
            "value": chance.choice(pieces),
            "nodes": [chance.choice(pieces) for _ in range(chance.randint(0, 6))],
        }
        try:
            plain = read_plain(data)
        except NotPlain:
            continue
        values(plain["nodes"], POINT)


def test_a_student_needs_no_numpy():
    code = (
        "import sys; sys.modules['numpy'] = None\n"
        "import sympy\nfrom coursework import check\nfrom coursework.checking.plain import "
        "to_plain\n"
        "to_plain(sympy.eye(3) * sympy.Symbol('x'))"
    )
    subprocess.run([sys.executable, "-W", "error", "-c", code], check=True)
