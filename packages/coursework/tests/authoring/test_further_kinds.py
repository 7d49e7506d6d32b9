"""Further kinds: numbers with units, orders, partly right lists, texts for a person, and plots."""

import random

import nbformat
import pytest
import sympy as sm
from quick_keys import keys_are_quick  # noqa: F401
from seed import SEED
from sympy.physics import units
from trial_course import made_in, write_source

from coursework.authoring import author
from coursework.authoring.author import question
from coursework.authoring.closed import possible_answers
from coursework.authoring.release import release
from coursework.authoring.selftest import try_question
from coursework.authoring.source import read_source
from coursework.checking import evaluate, questions
from coursework.checking.plain import NotPlain, to_plain
from coursework.checking.units import BASE, PREFIXES, WITH_PREFIX, UnknownUnit, unit
from coursework.grading.judging import marking
from coursework.grading.judging.contract import Asked
from coursework.grading.record import Answer


def make(kind, answer, **about):
    return author.question("trial/one", kind, answer, **about)


def outcome(question, answer):
    reply = questions.judge(question.name, question.sealed(), to_plain(answer))
    return reply.outcome, reply.note


# --- units ----------------------------------------------------------------------------------------


def test_units_are_those_of_sympy():
    """Compare each unit with SymPy's dimensions and factors, and powers of products."""
    from sympy.physics import units as theirs

    names = {
        "N": "newton", "Pa": "pascal", "J": "joule", "W": "watt", "Hz": "hertz", "C": "coulomb",
        "V": "volt", "F": "farad", "ohm": "ohm", "T": "tesla", "Wb": "weber", "H": "henry",
        "L": "liter", "bar": "bar", "min": "minute", "h": "hour", "d": "day",
    }  # fmt: skip
    base = [
        theirs.meter,
        theirs.kilogram,
        theirs.second,
        theirs.ampere,
        theirs.kelvin,
        theirs.mole,
        theirs.candela,
    ]
    for ours, name in names.items():
        converted = theirs.convert_to(getattr(theirs, name), base)
        exponents = converted.as_powers_dict()
        assert tuple(exponents.get(base_unit, 0) for base_unit in base) == unit(ours).exponents, (
            ours
        )
        size = converted.subs(dict.fromkeys(base, 1))
        assert float(unit(ours).size) == pytest.approx(float(size), rel=1e-14), ours
    for prefix, power in PREFIXES.items():
        for name in WITH_PREFIX:
            if f"{prefix}{name}" not in ("min", "cd", "mol", "h", "d", "T", "Pa", "m"):
                scaled = unit(f"{prefix}{name}")
                assert float(scaled.size / unit(name).size) == pytest.approx(10.0**power), (
                    prefix,
                    name,
                )


MOMENT = {
    "kind": "measurement",
    "answer": (sm.Rational(25, 2), "kN m"),
    "tolerance": 0.01,
    "relative": 0.001,
}


@pytest.mark.sampled(5)
@pytest.mark.parametrize(
    ("answer", "expected"),
    [
        ((12.5, "kN m"), ("correct", "")),
        ((12500, "N*m"), ("correct", "")),
        ([12500, "kg m^2 s^-2"], ("correct", "")),
        ((12.5 + 0.0224, "kN m"), ("correct", "")),  # 0.01 + 0.001 * 12.5
        ((12.5 + 0.0226, "kN m"), ("wrong", "rounded too far")),
        ((12500 - 22.4, "N m"), ("correct", "")),
        ((12500 - 22.6, "N m"), ("wrong", "rounded too far")),
        ((12.5, "N m"), ("wrong", "power of ten")),
        ((-12.5, "kN m"), ("wrong", "opposite")),
        ((12.5, "kN"), ("wrong", "")),
        ((12.5, "kN/m"), ("wrong", "the unit of a load")),
        ((12.5, "kNm"), ("invalid", "unknown unit")),
        (12.5 * units.kilo * units.newton * units.meter, ("correct", "")),
        ((12500, units.newton * units.meter), ("correct", "")),
        (12 * units.kilo * units.joule + 500 * units.newton * units.meter, ("correct", "")),
        (12.5 * units.newton * units.meter, ("wrong", "power of ten")),
        (12.5 * units.kilo * units.newton, ("wrong", "")),
        (12.5, ("invalid", "shape")),
        ("12.5 kN m", ("invalid", "shape")),
        (..., ("not attempted", "")),
    ],
)
def test_a_number_with_its_unit(answer, expected):
    question = make(
        MOMENT["kind"],
        MOMENT["answer"],
        tolerance=0.01,
        relative=0.001,
        mistakes={"!": (12.5, "kN/m")},
    )
    if expected[1] == "the unit of a load":
        expected = ("wrong", "authored")
    assert outcome(question, answer) == expected


def test_a_number_with_its_unit_is_tried_as_others_are():
    question = make("measurement", (sm.Rational(3517, 83), "N m"), symbols={})
    finding = try_question(question, against_sealed=False)
    assert finding.faults == [] and len(finding.forms) > 6 and "kg" not in str(question.public)
    x = sm.Symbol("x")
    exact = make("measurement", (3 * x**2, "N m"), symbols={"x": (1, 2)})
    assert try_question(exact, against_sealed=False).faults == []
    assert (
        outcome(exact, (3000 * x**2, "N mm"))[0] == "correct"
        and outcome(exact, (3 * x**2, "N"))[0] == "wrong"
    )


def test_a_symbol_of_the_name_of_a_unit_is_a_symbol():
    m = sm.Symbol("m", positive=True)
    question = make("measurement", (3 * m, "N"), symbols={"m": (1, 2)})
    assert outcome(question, 3 * m * units.newton) == ("correct", "")
    assert outcome(question, 0.003 * m * units.kilo * units.newton) == ("correct", "")
    assert outcome(question, 3 * units.meter * units.newton)[0] == "wrong"


def test_the_unit_of_an_exam_is_not_told():
    """Students receive the same for another unit."""
    sealed, other = (make("measurement", (3, unit), exam=True).sealed() for unit in ("kN m", "mm"))
    assert sealed == other
    reply = questions.judge("trial/one", sealed, to_plain((3, "kN m")))
    assert reply.outcome == "recorded"
    assert questions.judge("trial/one", sealed, to_plain((3, "kNm"))).note == "unknown unit"


# --- orders and lists -----------------------------------------------------------------------------

PLANETS = ["Mercury", "Venus", "Earth", "Mars", "Jupiter"]


def test_an_order():
    question = make("order", PLANETS, options=sorted(PLANETS), partial=True)
    assert try_question(question, against_sealed=False).faults == []
    assert outcome(question, [" " + name.upper() for name in PLANETS]) == ("correct", "")
    assert outcome(question, PLANETS[::-1]) == ("wrong", "turned round")
    assert outcome(question, ["Venus", "Mercury", *PLANETS[2:]]) == ("wrong", "two interchanged")
    assert outcome(question, [PLANETS[0], *PLANETS[:4]]) == ("invalid", "shape")
    assert possible_answers(question) == 120


def share(question, answer):
    about = Asked(marking.contract_of(question, b"any secret"))
    mark = marking.mark("trial/one", about, Answer("recorded", to_plain(answer)))
    return mark.points, mark.messages


def test_an_order_that_is_right_in_part_earns_its_share():
    question = make("order", PLANETS, options=sorted(PLANETS), partial=True, worth=10)
    assert share(question, PLANETS)[0] == 10
    points, said = share(question, ["Venus", "Mercury", *PLANETS[2:]])
    # The score is 0.9, of which one half is chance.
    assert points == 8 and said[-1] == "9 of 10 pairs are in the right order."
    assert share(question, PLANETS[::-1])[0] == 0
    alone = make("order", PLANETS, options=sorted(PLANETS), worth=10)
    assert share(alone, ["Venus", "Mercury", *PLANETS[2:]])[0] == 0


def test_who_guesses_a_list_earns_nothing_on_average():
    chance = random.Random(SEED)
    right = [chance.random() < 0.5 for _ in range(12)]
    truths = make("truth values", right, length=12, partial=True, worth=12)
    # 9 of 12 are right, of which 6 are chance.
    assert share(truths, [not right[0], not right[1], not right[2], *right[3:]])[0] == 6
    words = ["N", "N m", "Pa", "N/m"]
    answer = [chance.choice(words) for _ in range(8)]
    question = marking.contract_of(
        make("words", answer, options=words, length=8, partial=True), b"any secret"
    )
    shares = []
    for _ in range(600):
        text = " | ".join(chance.choice(words) for _ in range(8)).lower()
        _, parts, earned = marking.parts_right(question, text)
        shares.append(earned)
        assert parts == 8
    assert sum(shares) / len(shares) < 0.1  # No share is below 0, so the mean is a little above it.
    with pytest.raises(author.AuthorError, match="can be `partial`"):
        make("expression", 3, partial=True)


# --- texts that a person reads --------------------------------------------------------------------

ESSAY = "Two turns about different axes do not commute: " * 3
RUBRIC = ["says that order matters", "gives an example"]


def test_a_text_goes_to_a_person_and_nothing_of_it_is_sealed(tmp_path):
    question = make("free text", ESSAY, rubric=RUBRIC, worth=4)
    assert try_question(question).faults == []
    sealed = question.sealed()
    assert sealed.lockers == "" and "commute" not in str(sealed)
    reply = questions.judge("trial/one", sealed, to_plain("They do not."))
    assert (reply.outcome, reply.note) == (
        "undecided",
        "for a person",
    ) and "3 words" in reply.messages[0]
    assert outcome(question, "  ")[0] == outcome(question, ...)[0] == "not attempted"
    assert outcome(question, 3) == ("invalid", "shape")
    about = Asked(marking.contract_of(question, b"any secret"))
    for text, expected in (
        ("They do not.", "undecided"),
        ("", "not attempted"),
        (ESSAY, "undecided"),
    ):
        mark = marking.mark("trial/one", about, Answer("recorded", to_plain(text)))
        assert (mark.outcome, mark.points) == (expected, 0)
    assert try_question(make("free text", ESSAY)).faults == [
        "Graders need a `rubric`: say what to look for."
    ]
    with pytest.raises(author.AuthorError, match="a person marks it"):
        make("expression", 3, rubric=RUBRIC)
    with pytest.raises(NotPlain, match="long"):
        to_plain("x" * 5000)


# --- a plot as a figure ---------------------------------------------------------------------------


def test_a_plot_of_matplotlib_is_a_figure_of_a_question(tmp_path):
    course = made_in(tmp_path)
    plot = (
        "import matplotlib.pyplot as plt\nfigure, axes = plt.subplots(figsize=(3, 2))\n"
        "axes.plot([0, 1], [0, 2])\n"
        "plt.close(figure)\ndrawing(figure, 'A line that rises by 2')"
    )
    drawn = (
        "### BEGIN VARIANTS\nimport matplotlib.pyplot as plt\n\n\ndef plot(drawn):\n"
        "    figure, axes = plt.subplots()\n"
        "    axes.plot([0, 1], [0, drawn['slope']])\n    plt.close(figure)\n"
        "    return drawing(figure, 'A line that rises')\n\n\n"
        "line = draw('trial/line', count=3, slope=[2, 3, 5], picture=plot)\n### END VARIANTS"
    )
    checked = (
        "check('trial/line', rise)\n### BEGIN HIDDEN TESTS\n"
        "question('trial/line', kind='expression')\n"
        "### END HIDDEN TESTS"
    )
    write_source(
        course.sources,
        ("markdown", "# Trial"),
        ("code", "from coursework import check, student, variant\nstudent('')"),
        ("code", plot, "figure"),
        ("code", drawn),
        ("markdown", "{{picture}}\n\nHow steep is it?"),
        ("code", "### BEGIN SOLUTION\nrise = line.slope\n### END SOLUTION"),
        ("code", checked),
        name="trial",
    )
    release(course, run=False)
    cells = nbformat.read(course.exercises / "trial.ipynb", as_version=4).cells
    (shown,) = (cell.source for cell in cells if "A line that rises by 2" in cell.source)
    assert shown.startswith('<p><img alt="A line that rises by 2"') and "plt" not in "".join(
        cell.source for cell in cells
    )
    first, again = (
        read_source(course.sources / "trial.ipynb", 1).questions["trial/line"] for _ in range(2)
    )
    assert (
        first.public.variant.picture == again.public.variant.picture
        and first.public.salt == again.public.salt
    )


# --- nearly right, and how units are written ------------------------------------------------------


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
    assert str(read_unit.exponents) == str(whole)  # They must be whole numbers.
    assert abs(read_unit.size / evaluate.MP.mpf(size) - 1) < evaluate.MP.mpf(10) ** -38
