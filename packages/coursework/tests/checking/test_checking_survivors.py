"""Changes of the checking that no other test had noticed: each is noticed here."""

import pytest
import sympy as sm

from coursework.authoring.author import question
from coursework.checking import evaluate
from coursework.checking.plain import to_plain
from coursework.checking.units import BASE, UnknownUnit, unit

# ---- about three digits ------------------------------------------------------------------------


@pytest.mark.parametrize("count", [1, 2, 4, 9])
def test_what_agrees_to_three_digits_is_told_so_and_nothing_else(count):
    right = [sm.log(prime) for prime in (2, 3, 5, 7, 11, 13, 17, 19, 23)[:count]]
    logarithms = question("trial/logarithms", "vector", right, length=count, symbols={"x": None})

    def reply(share):
        return logarithms.reply_to(to_plain([float(entry) * (1 + share) for entry in right])).note

    assert {reply(share) for share in (1e-3, -1e-3, 5e-4, -3e-4)} == {"rounded too far"}
    assert "rounded too far" not in {reply(share) for share in (0.1 * count, -0.1 * count)}
    # If the cells were as narrow as the tolerance, there would be hundreds.
    assert len(logarithms.near) <= 4


# ---- work and powers ---------------------------------------------------------------------------


def test_nothing_to_the_power_of_nothing_is_one():
    nodes = [["integer", "0"], ["Pow", 0, 0], ["float", "0.0"], ["Pow", 2, 0], ["Pow", 0, 2]]
    assert [evaluate.values(nodes, {})[place] for place in (1, 3, 4)] == [1, 1, 1]
    assert sm.Integer(0) ** 0 == 1


@pytest.mark.parametrize(("operation", "count"), [("sin", 1_500), ("Add", 12_000), ("Mul", 12_000)])
def test_complex_numbers_are_dearer(operation, count):
    """Many times the time of real ones: what is enough for real
    numbers is too much for complex ones.
    """

    def last(first):
        return evaluate.values([first, *([operation, 0] for _ in range(count))], {})[-1]

    assert not isinstance(last(["rational", "1", "2"]), Exception)
    assert isinstance(last(["constant", "ImaginaryUnit"]), evaluate.TooLarge)


# ---- units ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "same"),
    [("\u03bcm", "\u00b5m"), ("um", "\u00b5m"), ("\u2126", "\u03a9"), ("k\u2126 A", "kV")],
)
def test_signs_that_look_alike_are_one_unit(text, same):
    assert unit(text) == unit(same)


@pytest.mark.parametrize(
    ("text", "quoted"),
    [
        ("\u00b0C", "\u00b0C"),
        ("2 \u00b0F", "2 \u00b0F"),
        ("J/\u00b0F", "\u00b0F"),
        ("m & s", " & s"),
        ("furlong", "furlong"),
        ("Nm", "Nm"),
        ("3 N", "3 N"),
        ("N + m", " + m"),
        ("kg m^99", "m^99"),
        ("m& 45678901234567890123", "& 456789012345678901"),
        ("m abcdefghijklmnopqrstuvwxyz", "abcdefghijklmnopqrst"),
        ("m^13", "m^13"),
        ("s m^-13", "m^-13"),
        ("kh", "kh"),
        ("xm", "xm"),
        ("\u00b0C m", "\u00b0C"),
    ],
)
def test_what_is_no_unit_is_quoted(text, quoted):
    with pytest.raises(UnknownUnit) as error:
        unit(text)
    assert str(error.value) == quoted


def test_an_angle_times_a_unit_is_no_temperature():
    assert unit("\u00b0 C").exponents == unit("C").exponents
    assert len(unit("rad").exponents) == len(BASE)


@pytest.mark.parametrize(
    ("text", "size", "exponents"),
    [
        ("kN m", "1000", (2, 1, -2)),
        ("N/mm^2", "1e6", (-1, 1, -2)),
        ("kg·m²/s²", "1", (2, 1, -2)),
        ("L/min", str(sm.Rational(1, 60_000).n(45)), (3, 0, -1)),
        ("", "1", ()),
        ("1", "1", ()),
        ("m^12/s^-12", "1", (12, 0, 12)),
        ("kg**2 m\u207b\u00b2", "1", (-2, 2)),
        ("mg", "1e-6", (0, 1)),
        ("mm2*h", "0.0036", (2, 0, 1)),
        ("cm^(3)/min", str(sm.Rational(1, 60_000_000).n(45)), (3, 0, -1)),
        ("N/m s", "1", (0, 1, -1)),
        ("m/s/s", "1", (1, 0, -2)),
        ("J/(kg K) m", "1", (3, 0, -2, 0, -1)),
        ("m/(s A)/(kg K)", "1", (1, -1, -1, -1, -1)),
        ("(m s)/A", "1", (1, 0, 1, -1)),
        ("%/cd mol", "0.01", (0, 0, 0, 0, 0, 1, -1)),
        ("\u00b0", str((sm.pi / 180).n(45)), ()),
        ("turn", str((2 * sm.pi).n(45)), ()),
    ],
)
def test_a_unit_is_read_as_its_size_and_its_exponents(text, size, exponents):
    read_unit = unit(text)
    whole = (*exponents, *[0] * (len(BASE) - len(exponents)))
    assert str(read_unit.exponents) == str(whole)  # whole numbers, as is said of them
    assert abs(read_unit.size / evaluate.MP.mpf(size) - 1) < evaluate.MP.mpf(10) ** -38
