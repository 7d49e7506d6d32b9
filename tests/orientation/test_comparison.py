"""Whether two orientations are the same, and that every mix-up is named, and no other."""

import random
import re
import time

import numpy as np
import pytest
import sympy as sm
import sympy.physics.mechanics as me
from orientations import composed, random_dcms, random_unit_vectors

from orientation import (
    SEQUENCES,
    dcm_from_axis_angle,
    dcm_from_quaternion,
    diagnose,
    multiply_quaternions,
    quaternion_from_axis_angle,
    same_orientation,
    simple_dcm,
)
from orientation.random_points import points_for

psi, theta, phi = SYMBOLS = sm.symbols("psi, theta, varphi")
NAMES = ("psi", "theta", "varphi")
NUMBERS = (0.4, -0.7, 1.1)
all_sequences = pytest.mark.parametrize("sequence", SEQUENCES)
some_sequences = pytest.mark.parametrize("sequence", ("zxy", "xzy", "zxz", "yxy"))


# --- the same orientation -------------------------------------------------------------------------


def half_angle_form(angle):
    t = sm.tan(angle / 2)
    return sm.Matrix(
        [
            [(1 - t**2) / (1 + t**2), 2 * t / (1 + t**2), 0],
            [-2 * t / (1 + t**2), (1 - t**2) / (1 + t**2), 0],
            [0, 0, 1],
        ]
    )


def exponential_form(angle):
    plus, minus = sm.exp(sm.I * angle), sm.exp(-sm.I * angle)
    cosine, sine = (plus + minus) / 2, (plus - minus) / (2 * sm.I)
    return sm.Matrix([[cosine, sine, 0], [-sine, cosine, 0], [0, 0, 1]])


def sum_form(matrix):
    return matrix.applyfunc(lambda entry: sm.expand_trig(sm.fu(entry)))


EQUAL = [
    (half_angle_form(theta), simple_dcm("z", theta)),
    (exponential_form(theta), simple_dcm("z", theta)),
    (exponential_form(theta), half_angle_form(theta)),
    (
        simple_dcm("z", psi) * simple_dcm("z", theta) * simple_dcm("z", phi),
        simple_dcm("z", psi + theta + phi),
    ),
    (composed(SYMBOLS, "zxy"), composed(SYMBOLS, "zxy").expand()),
    (lambda: sum_form(composed(SYMBOLS, "zxy")), composed(SYMBOLS, "zxy")),
    (
        composed(SYMBOLS, "zxy").adjugate() / composed(SYMBOLS, "zxy").det(),
        composed(SYMBOLS, "zxy").T,
    ),
    (
        dcm_from_quaternion(
            multiply_quaternions(
                quaternion_from_axis_angle((0, 0, 1), psi),
                quaternion_from_axis_angle((1, 0, 0), theta),
            )
        ),
        composed((psi, theta), "zx"),
    ),
    (dcm_from_axis_angle((1, 1, 1), 2 * sm.pi / 3), sm.Matrix([[0, 1, 0], [0, 0, 1], [1, 0, 0]])),
    (
        simple_dcm("z", sm.acos(sm.Rational(3, 5))),
        np.array([[0.6, 0.8, 0], [-0.8, 0.6, 0], [0, 0, 1]]),
    ),
    (quaternion_from_axis_angle((1, 2, 2), theta), -quaternion_from_axis_angle((2, 4, 4), theta)),
    (
        quaternion_from_axis_angle((1, 2, 2), theta),
        quaternion_from_axis_angle((1, 2, 2), theta + 2 * sm.pi),
    ),
]


@pytest.mark.parametrize("pair", EQUAL, ids=range(len(EQUAL)))
def test_equal_in_other_forms_quickly_and_without_simplifying(pair, monkeypatch):
    pair = [form() if callable(form) else form for form in pair]

    def refuse(*_, **__):
        raise AssertionError("an algebraic simplification was asked for")

    for name in ("simplify", "trigsimp", "fu", "nsimplify", "factor", "expand"):
        monkeypatch.setattr(sm, name, refuse)
    monkeypatch.setattr(sm.Basic, "simplify", refuse)
    monkeypatch.setattr(sm.Matrix, "simplify", refuse)
    seconds = []
    for _ in range(3):
        start = time.process_time()
        assert same_orientation(*pair) is True and same_orientation(*reversed(pair)) is True
        seconds.append(time.process_time() - start)
    assert min(seconds) < 0.3


DIFFERENT = [
    (simple_dcm("z", theta), simple_dcm("z", -theta)),
    (simple_dcm("z", theta), simple_dcm("y", theta)),
    # These are right for some angles and wrong for others.
    (
        simple_dcm("z", theta).subs(sm.cos(theta), sm.sqrt(1 - sm.sin(theta) ** 2)),
        simple_dcm("z", theta),
    ),
    (
        simple_dcm("z", theta).subs(sm.sin(theta), sm.sqrt(1 - sm.cos(theta) ** 2)),
        simple_dcm("z", theta),
    ),
    (simple_dcm("z", sm.Abs(theta)), simple_dcm("z", theta)),
    (simple_dcm("z", sm.asin(sm.sin(theta))), simple_dcm("z", theta)),
    (simple_dcm("z", sm.acos(sm.cos(theta))), simple_dcm("z", theta)),
    (
        sm.Matrix([sm.sqrt((1 + sm.cos(theta)) / 2), sm.sin(theta / 2), 0, 0]),
        quaternion_from_axis_angle((1, 0, 0), theta),
    ),
    (composed(SYMBOLS, "zxy"), composed((psi, theta, sm.Symbol("phi")), "zxy")),
    (simple_dcm("x", 0.1), simple_dcm("x", 0.1 + 1e-8)),
    (quaternion_from_axis_angle((1, 2, 2), theta), quaternion_from_axis_angle((1, 2, 2), -theta)),
]


@pytest.mark.parametrize("pair", DIFFERENT, ids=range(len(DIFFERENT)))
def test_different(pair):
    assert same_orientation(*pair) is False and same_orientation(*reversed(pair)) is False


@pytest.mark.parametrize("count", (1, 2, 7, 12))
def test_each_of_many_symbols_is_tried_with_both_signs(count):
    symbols = sm.symbols(f"a:{count}")
    for symbol in symbols:
        rest = sum(symbols) - symbol
        assert not same_orientation(
            simple_dcm("x", sm.Abs(symbol) + rest), simple_dcm("x", symbol + rest)
        )


def test_every_symbol_is_tried_well_inside_of_all_four_quadrants_and_beyond_half_a_turn():
    names = [f"a{k}" for k in range(50)]
    points = points_for(names)
    quarters = np.array([[point[name] for name in names] for point in points]) / (np.pi / 2)
    assert (np.sort(np.floor(quarters), axis=0).T == [-3, -1, 0, 2]).all()
    assert ((quarters % 1 > 0.1) & (quarters % 1 < 0.9)).all()
    assert len(set(quarters.flat)) == 200
    assert points == points_for(names)


def test_symbols_are_compared_by_name():
    in_time, positive = me.dynamicsymbols("theta"), sm.Symbol("theta", positive=True)
    for namesake in (in_time, positive, sm.Function("theta")(sm.Symbol("t"))):
        assert same_orientation(simple_dcm("z", theta), simple_dcm("z", namesake))
    assert not same_orientation(simple_dcm("z", theta), simple_dcm("z", sm.Symbol("Theta")))


def test_time_inside_and_outside_a_function():
    turning, omega, t = me.dynamicsymbols("theta"), sm.Symbol("Omega"), me.dynamicsymbols._t
    assert same_orientation(
        simple_dcm("z", turning + omega * t), simple_dcm("z", turning) * simple_dcm("z", omega * t)
    )
    assert not same_orientation(
        simple_dcm("z", turning + omega * t), simple_dcm("z", turning + omega)
    )


def test_every_way_to_hold_a_matrix():
    matrix = composed(SYMBOLS, "zxy")
    for form in (
        matrix.as_immutable(),
        matrix.tolist(),
        tuple(map(tuple, matrix.tolist())),
        np.array(matrix),
    ):
        assert same_orientation(form, matrix) and same_orientation(matrix, form)
        assert diagnose(form, matrix).same
    numbers = composed(NUMBERS, "zxy")
    assert same_orientation(numbers.tolist(), sm.Matrix(numbers))


def test_plain_numbers_of_one_item_need_neither_numpy_nor_sympy(monkeypatch):
    for reading in ("number_array", "symbol_components"):
        monkeypatch.setattr(f"orientation.comparison.{reading}", None)
    dcm, quaternion = composed(NUMBERS, "zxy").tolist(), (0.6, 0, 0.8, 0)
    assert same_orientation(dcm, dcm) and same_orientation(quaternion, list(quaternion))
    assert diagnose(dcm, dcm, NUMBERS, "zxy").same


def test_batches():
    dcms = random_dcms(6, 1).reshape(2, 3, 3, 3)
    assert same_orientation(dcms, dcms.copy()) and not same_orientation(dcms, dcms[::-1])
    assert same_orientation(np.stack(5 * [dcms[0, 0]]), dcms[0, 0])
    assert not same_orientation(dcms, dcms[0, 0])
    assert same_orientation(np.stack(5 * [np.eye(3)]), sm.eye(3))
    assert same_orientation(np.zeros((0, 3, 3)), np.zeros((0, 3, 3)))
    quaternions = np.concatenate([random_unit_vectors(50, 2, size=4), np.eye(4)])
    assert same_orientation(quaternions, quaternions * np.resize([[1], [-1], [-1]], (54, 1)))
    with pytest.raises(ValueError, match=r"cannot compare batches of shapes \(2, 3\) and \(5,\)"):
        same_orientation(dcms, random_dcms(5, 3))


def test_tolerance():
    assert same_orientation(simple_dcm("x", 0.1), simple_dcm("x", 0.1 + 5e-10))
    assert not same_orientation(simple_dcm("x", 0.1), simple_dcm("x", 0.1 + 5e-10), tolerance=1e-10)
    assert same_orientation(simple_dcm("x", theta), simple_dcm("x", theta + 0.01), tolerance=0.011)


def test_no_random_state_of_the_reader_is_touched():
    before = random.getstate(), str(np.random.get_state())
    same_orientation(simple_dcm("x", theta), simple_dcm("x", psi))
    assert before == (random.getstate(), str(np.random.get_state()))


# --- every mix-up is named, and what is named is so -----------------------------------------------

DEGREES, TOO_OFTEN = 180 / np.pi, np.pi / 180


def scaled(angles, factors):
    return tuple(angle * factor for angle, factor in zip(angles, factors))


def rebuilt(cause, angles, sequence):
    """Return the answer that follows from a named cause; it parses every sentence that there is."""

    def place(word):
        return NAMES.index(word) if word in NAMES else ("first", "second", "third").index(word)

    def factors(words, factor):
        chosen = range(3) if words == "the angles" else [place(word) for word in words.split(", ")]
        return [factor if k in chosen else 1 for k in range(3)]

    if cause.startswith("it is the transpose"):
        return composed(angles, sequence).T
    if cause.startswith("the matrices are multiplied in reverse order"):
        return composed(angles[::-1], sequence[::-1])
    if cause == "the angles are in reverse order":
        return composed(angles[::-1], sequence)
    if match := re.fullmatch(r"it is the sequence (...), not (...)", cause):
        assert match[2] == sequence
        return composed(angles, match[1])
    if match := re.fullmatch(
        r"(?:the angle of the )?(\w+)(?: rotation)? has the wrong sign", cause
    ):
        return composed(
            scaled(
                angles,
                factors(match[1], -1)
                if match[1] in NAMES
                else [-1 if k == place(match[1]) else 1 for k in range(3)],
            ),
            sequence,
        )
    if match := re.fullmatch(r"(\w+) and (\w+) are swapped", cause):
        order = [0, 1, 2]
        a, b = place(match[1]), place(match[2])
        order[a], order[b] = b, a
        return composed(tuple(angles[k] for k in order), sequence)
    if match := re.fullmatch(
        r"(.+) (?:was|were) given in degrees where radians are expected", cause
    ):
        return composed(scaled(angles, factors(match[1], DEGREES)), sequence)
    if match := re.fullmatch(
        r"(.+) (?:was|were) converted from degrees to radians once too often", cause
    ):
        return composed(scaled(angles, factors(match[1], TOO_OFTEN)), sequence)
    raise AssertionError(f"nobody knows what this means: {cause}")


SENTENCES = {
    "transpose": "it is the transpose, which is the inverse orientation",
    "order": "the matrices are multiplied in reverse order, which gives space fixed rotations",
    "reverse": "the angles are in reverse order",
    **{f"sign of {name}": f"{name} has the wrong sign" for name in NAMES},
    "psi for theta": "psi and theta are swapped",
    "theta for varphi": "theta and varphi are swapped",
    "degrees": "psi, theta, varphi were given in degrees where radians are expected",
    "degrees of theta": "theta was given in degrees where radians are expected",
    "too often": "psi, theta, varphi were converted from degrees to radians once too often",
    "too often varphi": "varphi was converted from degrees to radians once too often",
}


def numerical(matrix, angles):
    return np.array(matrix.subs(dict(zip(SYMBOLS, angles))), dtype=float)


def demand_truth(diagnosis, answer, angles, sequence):
    """Check that every named cause makes the given answer."""
    assert not diagnosis.same and len(set(diagnosis.causes)) == len(diagnosis.causes)
    for cause in diagnosis.causes:
        np.testing.assert_allclose(
            rebuilt(cause, angles, sequence), answer, atol=1e-8, err_msg=cause
        )
    same = "mathematically the same" in str(diagnosis)
    assert same == (len(diagnosis.causes) > 1)
    assert all(cause in str(diagnosis) for cause in diagnosis.causes)


@some_sequences
@pytest.mark.parametrize("mixup", SENTENCES)
def test_symbolic_mixups_are_named(sequence, mixup):
    if sequence not in ("zxy", "yxy") and mixup in (
        "psi for theta",
        "degrees of theta",
        "too often",
        "sign of psi",
    ):
        return  # these do not depend on the axes
    sentence = SENTENCES[mixup]
    answer = rebuilt(sentence, SYMBOLS, sequence)
    diagnosis = diagnose(answer, composed(SYMBOLS, sequence))
    assert sentence in diagnosis.causes
    demand_truth(diagnosis, numerical(answer, NUMBERS), NUMBERS, sequence)


@some_sequences
def test_symbolic_wrong_sequence_is_named(sequence):
    others = [alternative for alternative in SEQUENCES if alternative != sequence]
    expected = composed(SYMBOLS, sequence)
    for wrong_sequence in others if sequence in ("zxy", "zxz") else others[::4]:
        diagnosis = diagnose(composed(SYMBOLS, wrong_sequence), expected)
        assert f"it is the sequence {wrong_sequence}, not {sequence}" in diagnosis.causes
        demand_truth(diagnosis, composed(NUMBERS, wrong_sequence), NUMBERS, sequence)


@all_sequences
def test_numerical_mixups_are_named(sequence):
    expected = composed(NUMBERS, sequence)
    sentences = [SENTENCES[key] for key in ("transpose", "order", "reverse")]
    sentences += [
        f"the angle of the {which} rotation has the wrong sign"
        for which in ("first", "second", "third")
    ]
    sentences += [
        f"it is the sequence {alternative}, not {sequence}"
        for alternative in SEQUENCES
        if alternative != sequence
    ]
    sentences += [
        "the angles were given in degrees where radians are expected",
        "the angles were converted from degrees to radians once too often",
    ]
    for sentence in sentences:
        answer = rebuilt(sentence, NUMBERS, sequence)
        for angles in (NUMBERS, list(NUMBERS), np.array(NUMBERS), sm.Matrix(NUMBERS)):
            diagnosis = diagnose(answer, expected, angles, sequence)
            assert sentence in diagnosis.causes
            demand_truth(diagnosis, answer, NUMBERS, sequence)
    assert diagnose(expected, expected, NUMBERS, sequence).same
    assert diagnose(expected.T, expected).causes == (SENTENCES["transpose"],)


@some_sequences
def test_nothing_is_named_for_other_answers(sequence):
    numbers, symbols = composed(NUMBERS, sequence), composed(SYMBOLS, sequence)
    for answer in random_dcms(20, 4):
        assert diagnose(answer, numbers, NUMBERS, sequence) == (False, ())
    for answer in (
        random_dcms(1, 5)[0],
        composed((psi, 2 * theta, phi), sequence),
        composed((psi + 0.1, theta, phi), sequence),
        composed(sm.symbols("a, b, c"), sequence),
        composed((theta, phi, psi), sequence[::-1]).T,
    ):
        diagnosis = diagnose(answer, symbols)
        assert diagnosis == (False, ())
        assert str(diagnosis) == "Not the same orientation, and it is none of the usual mix-ups."


@all_sequences
def test_two_mixups_at_once_are_not_taken_for_one(sequence):
    expected = composed(NUMBERS, sequence)
    first, second, third = NUMBERS
    for angles in ((-first, -second, third), (first, -third, second), (-third, second, first)):
        for wrong_sequence in (sequence, sequence[::-1], "xyz"):
            for answer in (composed(angles, wrong_sequence), composed(angles, wrong_sequence).T):
                diagnosis = diagnose(answer, expected, NUMBERS, sequence)
                if not diagnosis.same:
                    demand_truth(diagnosis, answer, NUMBERS, sequence)


def test_mixups_that_are_mathematically_the_same_are_all_named():
    diagnosis = diagnose(simple_dcm("z", theta).T, simple_dcm("z", theta))
    assert diagnosis.causes == (SENTENCES["transpose"], "theta has the wrong sign")
    assert str(diagnosis).endswith(
        f"mathematically the same here: {SENTENCES['transpose']}; or theta has the wrong sign."
    )
    diagnosis = diagnose(composed((phi, theta, psi), "zxz"), composed(SYMBOLS, "zxz"))
    assert diagnosis.causes == (
        "psi and varphi are swapped",
        SENTENCES["order"],
        "the angles are in reverse order",
    )


def test_chain_of_two_turns():
    expected = simple_dcm("x", psi) * simple_dcm("z", theta)
    assert diagnose(simple_dcm("z", theta) * simple_dcm("x", psi), expected).causes == (
        SENTENCES["order"],
    )
    assert diagnose(expected.T, expected).causes == (SENTENCES["transpose"],)
    assert diagnose(expected.subs(psi, -psi), expected).causes == ("psi has the wrong sign",)


def test_expected_matrix_of_a_signed_and_reordered_sequence_is_recognised():
    expected = composed((theta, -psi, phi), "yzx")
    assert diagnose(composed((phi, -psi, theta), "xzy"), expected).causes == (SENTENCES["order"],)
    assert diagnose(composed((theta, -psi, phi), "yzy"), expected).causes == (
        "it is the sequence yzy, not yzx",
    )


def test_given_angles_may_be_symbols():
    causes = diagnose(composed((phi, 0, psi), "zxy"), composed((psi, 0, phi), "zxy")).causes
    assert causes == ("psi and varphi are swapped",)
    for angles in ((psi, 0, phi), sm.Matrix([psi, 0, phi])):
        assert diagnose(
            composed((phi, 0, psi), "zxy"), composed((psi, 0, phi), "zxy"), angles, "zxy"
        ).causes == (*causes, "the angles are in reverse order")


def test_given_angles_of_which_one_is_zero():
    expected = composed((0.3, 0, 0.5), "zxy")
    assert (
        "the angle of the first rotation has the wrong sign"
        in diagnose(composed((-0.3, 0, 0.5), "zxy"), expected, (0.3, 0, 0.5), "zxy").causes
    )


# --- answers that are no orientation --------------------------------------------------------------


def test_faults_of_matrices_are_told_alone():
    for expected in (composed(NUMBERS, "zxy"), composed(SYMBOLS, "zxy")):
        mirror = (
            expected * sm.diag(1, 1, -1)
            if isinstance(expected, sm.MatrixBase)
            else expected * [1, 1, -1]
        )
        (cause,) = diagnose(mirror, expected).causes
        assert cause.startswith("it is orthogonal but left-handed: its determinant is -1")
        (cause,) = diagnose(2 * expected, expected).causes
        assert "row x has length 2, not 1" in cause and "2 times an orthogonal one" in cause
    (cause,) = diagnose(composed(NUMBERS, "zxy").round(3), composed(NUMBERS, "zxy")).causes
    assert re.match(
        r"it is not orthogonal: .*(length|dot product) .*Were its entries rounded", cause
    )
    wrong_sign = composed(SYMBOLS, "zxy")
    wrong_sign[0, 1] *= -1
    (cause,) = diagnose(wrong_sign, composed(SYMBOLS, "zxy")).causes
    assert cause.startswith("it is not orthogonal: row")
    (cause,) = diagnose(sm.I * composed(SYMBOLS, "zxy"), composed(SYMBOLS, "zxy")).causes
    assert cause.startswith("it is not real")


def test_symbols_that_obey_a_condition_are_not_said_to_be_at_fault():
    quaternion = sm.Matrix(sm.symbols("q_0, q_i, q_j, q_k"))
    dcm = dcm_from_quaternion(quaternion)
    assert SENTENCES["transpose"] in diagnose(dcm.T, dcm).causes
    last = sm.Matrix([*quaternion[1:], quaternion[0]])
    assert diagnose(last, quaternion).causes == (
        "the scalar part comes last; in this book it comes first",
    )
    assert diagnose(2 * quaternion, quaternion) == (False, ())


# --- quaternions ----------------------------------------------------------------------------------

LAST = "the scalar part comes last; in this book it comes first"
CONJUGATE = "it is the conjugate, which is the inverse orientation"
NOT_HALVED = "the angle was not halved: a quaternion holds the cosine and sine of half the angle"


def quaternion_mixups(turn):
    """Return wrong answers about the quaternion ``turn(angle)``, without the package's product."""

    def parts(quaternion):
        return list(quaternion)

    a, b, c, d = parts(turn(1))
    return {
        LAST: [b, c, d, a],
        CONJUGATE: [a, -b, -c, -d],
        "it is the conjugate, and the scalar part comes last; in this book it comes first": [
            -b,
            -c,
            -d,
            a,
        ],
        NOT_HALVED: parts(turn(2)),
    }


@pytest.mark.parametrize("sign", [1, -1])
def test_quaternion_mixups_are_named(sign):
    for axis in ((1, 2, 3), (3, -1, 2)):
        for angle in (0.7, -2.0, theta, theta + psi):

            def turn(times):
                return quaternion_from_axis_angle(axis, times * angle)

            for cause, answer in quaternion_mixups(turn).items():
                answer = [sign * entry for entry in answer]
                causes = diagnose(answer, turn(1)).causes
                assert cause in causes
                assert set(causes) - {cause} <= (
                    {"theta has the wrong sign"} if angle == theta else set()
                )


def test_nothing_is_named_for_other_quaternions():
    expected = quaternion_from_axis_angle((1, 2, 3), 0.7)
    for answer in random_unit_vectors(50, 6, size=4):
        assert diagnose(answer, expected) == (False, ())
    assert diagnose(
        quaternion_from_axis_angle((1, 2, 3), psi), quaternion_from_axis_angle((1, 2, 3), theta)
    ) == (
        False,
        (),
    )


def test_a_quaternion_is_not_read_as_entries_of_a_matrix():
    """These could be the first entries of rotations about y, and the answer's those about z."""
    c, s = sm.cos(psi + theta), sm.sin(psi + theta)
    (cause,) = diagnose((c, -s, 0, s), (c, 0, s, 0)).causes
    assert cause.startswith("it has length")


# --- what cannot be compared ----------------------------------------------------------------------


DCM, STACK = composed(NUMBERS, "zxy"), random_dcms(3, 7)


@pytest.mark.parametrize("function, name", [(same_orientation, "first"), (diagnose, "given")])
@pytest.mark.parametrize(
    "pair, error, words",
    [
        (
            (DCM, (1, 0, 0, 0)),
            ValueError,
            "is a direction cosine matrix and .* is a quaternion; convert one",
        ),
        ((DCM, (1, 2, 3)), ValueError, "must be a direction cosine matrix, of shape"),
        ((theta, DCM), ValueError, "must be a direction cosine matrix"),
        ((DCM * np.nan, DCM), ValueError, r"^NAME\[0, 0\] is nan"),
        ((random_dcms(2, 1) * np.nan, DCM), ValueError, r"^NAME\[0, 0, 0\] is nan"),
        ((composed(SYMBOLS, "zxy") * sm.nan, DCM), ValueError, "^NAME holds nan"),
        ((DCM, "zxy"), TypeError, "must hold real numbers"),
    ],
)
def test_what_cannot_be_compared_is_told(function, name, pair, error, words):
    with pytest.raises(error, match=words.replace("NAME", name)):
        function(*pair)


@pytest.mark.parametrize(
    "arguments, error, words",
    [
        ((STACK, STACK), ValueError, "one answer at a time"),
        ((STACK, DCM), ValueError, "one answer at a time"),
        ((DCM, STACK), ValueError, "one answer at a time"),
        ((DCM.T, DCM, (1, 2), "zxy"), ValueError, r"^angles has shape \(2,\)"),
        ((DCM.T, DCM, np.zeros((2, 3)), "zxy"), ValueError, r"^angles has shape \(2, 3\)"),
        ((DCM.T, DCM, (1, np.nan, 2), "zxy"), ValueError, r"^angles\[1\] is nan"),
        ((DCM.T, DCM, (psi, sm.nan, 1), "zxy"), ValueError, "^angles holds nan"),
        ((DCM.T, DCM, "zxy", "zxy"), TypeError, "^angles must hold real numbers"),
        ((DCM.T, DCM, NUMBERS), ValueError, "give both angles and sequence"),
        ((DCM.T, DCM, None, "zxy"), ValueError, "give both angles and sequence"),
        ((DCM.T, DCM, NUMBERS, "zzx"), ValueError, "'zzx' is not a sequence"),
        (
            (DCM.T, DCM, NUMBERS, "yxz"),
            ValueError,
            "`expected` is not the body fixed yxz orientation of these angles",
        ),
    ],
)
def test_what_cannot_be_diagnosed_is_told(arguments, error, words):
    with pytest.raises(error, match=words):
        diagnose(*arguments)


def test_a_tolerance_holds_for_everything_that_is_asked():
    """With four digits from a file, rounding is no mix-up, and angles need to fit only so far."""
    right, wrong = composed(NUMBERS, "zxy"), composed(NUMBERS[::-1], "yxz")
    right, wrong = (np.round(np.array(dcm, dtype=float), 4) for dcm in (right, wrong))
    diagnosis = diagnose(wrong, right, angles=NUMBERS, sequence="zxy", tolerance=2e-3)
    assert (
        diagnosis.causes
        == diagnose(composed(NUMBERS[::-1], "yxz"), composed(NUMBERS, "zxy"), NUMBERS, "zxy").causes
    )
    assert diagnose(np.round(random_dcms(1, seed=4)[0], 4), right, tolerance=2e-3).causes == ()
    assert diagnose(right * 1.1, right, tolerance=2e-3).causes[0].startswith("it")
