"""The limits of evaluation, and the messages beyond them."""

import pytest
import sympy as sm

from coursework.checking import evaluate
from coursework.checking.evaluate import MP, NotSupported, TooLarge, Undefined, UnknownSymbol

ZERO, ONE, I = ["integer", "0"], ["integer", "1"], ["constant", "ImaginaryUnit"]
INFINITY = ["constant", "Infinity"]
MILLION = ["integer", "1000000"]
LARGEST = ["integer", "1" + 60 * "0"]


def value(*nodes, **point):
    """Return the number of the last of these nodes; operations refer to earlier ones by index."""
    return evaluate.number(evaluate.values(nodes, point)[-1])


def power(text, exponent):
    return [["float", text], ["float", exponent], ["Pow", 0, 1]]


BEYOND = "the value is larger than 10^60"
BELOW = "a number smaller than 10^-1000000"
REFUSED = [
    (Undefined, "division by zero", [ZERO, ["cot", 0]]),
    (Undefined, "division by zero", [ZERO, ["integer", "-1"], ["Pow", 0, 1]]),
    (Undefined, "division by zero", [ZERO, I, ["Pow", 0, 1]]),
    (Undefined, "division by zero", [["constant", "ComplexInfinity"]]),
    (Undefined, "it is NaN, which is not a number", [["constant", "NaN"]]),
    (Undefined, "it is infinite", [ONE, INFINITY, ["Add", 0, 1]]),
    (
        Undefined,
        "it is NaN, which is not a number",
        [INFINITY, ["constant", "NegativeInfinity"], ["Add", 0, 1]],
    ),
    (
        Undefined,
        "no case of the Piecewise applies",
        [ONE, ["constant", "BooleanFalse"], ["ExprCondPair", 0, 1], ["Piecewise", 2]],
    ),
    (TooLarge, BEYOND, [LARGEST, ["Add", 0, 0]]),
    (TooLarge, BEYOND, [["float", "1e61"]]),
    (TooLarge, BEYOND, [["float", f"1e{10**39}"]]),
    (TooLarge, BEYOND, power("1e60", "10000")),
    (TooLarge, "an exponent larger than ten thousand", power("1", "10001")),
    (TooLarge, "an argument larger than a million", [["integer", "1000001"], ["tanh", 0]]),
    (TooLarge, "it has too many operations", [ONE, *[["sin", 0]] * 10_000]),
    (NotSupported, "a Boolean instead of a number", [["constant", "BooleanTrue"]]),
    (NotSupported, "Piecewise (TypeError)", [ONE, ["Piecewise", 0]]),
    (NotSupported, "gamma", [ONE, ["gamma", 0]]),
    (NotSupported, "EulerGamma", [["constant", "EulerGamma"]]),
    (NotSupported, "a comparison of complex numbers", [I, ZERO, ["StrictGreaterThan", 0, 1]]),
    (NotSupported, "a comparison of complex numbers", [I, ["sign", 0]]),
    (NotSupported, BELOW, [["float", "-1e-1010000"]]),
    (NotSupported, BELOW, [["float", f"1e-{10**39}"]]),
    (UnknownSymbol, "omega", [["symbol", "omega"]]),
]


@pytest.mark.parametrize(("error", "message", "nodes"), REFUSED)
def test_what_has_no_value_is_told(error, message, nodes):
    with pytest.raises(error) as raised:
        value(*nodes, theta=MP.one)
    assert str(raised.value) == message


@pytest.mark.parametrize(
    ("nodes", "expected"),
    [
        ([LARGEST, ["Add", 0]], MP.mpf(10) ** 60),
        ([MILLION, ["tanh", 0]], 1),
        ([MILLION, ["sin", 0]], MP.sin(10**6)),
        ([["integer", "-1000000"], ["exp", 0], ["log", 1]], -(10**6)),
        ([ZERO, ["sinc", 0]], 1),
        ([ZERO, ["sign", 0]], 0),
        ([ZERO, ["Heaviside", 0]], MP.mpf("0.5")),
        ([ZERO, ONE, ["Heaviside", 0, 1]], 1),
        (power("1", "10000"), 1),
        (power("0", "0.25"), 0),
        ([["float", "1E3"]], 1000),
        ([["float", "25e-1"]], MP.mpf("2.5")),
        ([["float", "1e-999999"], ["log", 0]], -999999 * MP.log(10)),
        ([["float", f"0e{10**39}"]], 0),
        # If two parts are far apart, the smaller one counts as zero.
        ([["float", "1e-9000"], I, ["Mul", 0, 1], ONE, ["Add", 2, 3]], 1),
        ([["float", "1e-9000"], I, ["Add", 0, 1]], MP.mpc(0, 1)),
    ],
)
def test_what_is_at_the_border_still_has_a_value(nodes, expected):
    assert abs(value(*nodes) - expected) <= MP.mpf(10) ** -35 * abs(expected)


def test_parts_that_are_less_far_apart_are_both_kept():
    between = MP.ldexp(1, -evaluate.APART)
    for number in (MP.mpc(1, between), MP.mpc(between, 1), MP.mpc(0, 0)):
        assert evaluate._bounded(number) == number
    smallest = MP.ldexp(1, evaluate.SMALLEST - 1)
    assert evaluate._bounded(smallest) == smallest


@pytest.mark.parametrize("first", [True, False])
@pytest.mark.parametrize("second", [True, False])
def test_conditions_are_joined_as_python_joins_them(first, second):
    truths = [["constant", f"Boolean{truth}"] for truth in (first, second)]
    joined = evaluate.values([*truths, ["And", 0, 1], ["Or", 0, 1], ["Not", 0]], {})
    assert joined[2:] == [first and second, first or second, not first]


def test_what_remains_of_a_part_that_cancels_is_measured_by_the_other_one():
    border = evaluate.ROUNDING
    assert evaluate.real(MP.mpc(0, border)) == 0
    assert evaluate.real(MP.mpc(10**10, 10**9 * border)) == 10**10
    for number in (MP.mpc(0, 1.5 * border), MP.mpc(2, MP.mpf("0.5"))):
        with pytest.raises(ValueError, match="^complex$"):
            evaluate.real(number)
    for infinite in (MP.inf, -MP.inf):
        with pytest.raises(Undefined, match="^it is infinite$"):
            evaluate.real(infinite)


def test_no_function_is_given_what_it_is_not_made_for():
    """Make the functions anew, since the module made its own when it was imported."""
    cosine = evaluate._moderate(MP.cos)
    assert cosine(MP.mpf(10**6)) == MP.cos(10**6)
    with pytest.raises(TooLarge, match="^an argument larger than a million$"):
        cosine(MP.mpf(-(10**6)) - 1)
    larger = evaluate._real_only(max)
    assert larger(MP.one, MP.mpc(2, 0)) == 2
    with pytest.raises(NotSupported):
        larger(MP.one, MP.mpc(2, 1))


def test_nothing_to_the_power_of_nothing_is_one():
    nodes = [["integer", "0"], ["Pow", 0, 0], ["float", "0.0"], ["Pow", 2, 0], ["Pow", 0, 2]]
    assert [evaluate.values(nodes, {})[place] for place in (1, 3, 4)] == [1, 1, 1]
    assert sm.Integer(0) ** 0 == 1


@pytest.mark.parametrize(("operation", "count"), [("sin", 1_500), ("Add", 12_000), ("Mul", 12_000)])
def test_complex_numbers_are_dearer(operation, count):
    """They take much longer than real ones, so what is allowed for these is too much for them."""

    def last(first):
        return evaluate.values([first, *([operation, 0] for _ in range(count))], {})[-1]

    assert not isinstance(last(["rational", "1", "2"]), Exception)
    assert isinstance(last(["constant", "ImaginaryUnit"]), evaluate.TooLarge)
