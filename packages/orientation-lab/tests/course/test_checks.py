"""The check as a student uses it: replies, hints, progress; and the locks that hold the answers."""

import base64
import hashlib
import json
import random
import re
import sys
from dataclasses import replace
from functools import cache, partial

import numpy as np
import pytest
import sympy as sm
from forms_by_chance import random_form
from quick_keys import keys_are_quick  # noqa: F401
from seed import SEED
from sympy.physics import units
from sympy.physics.mechanics import ReferenceFrame, dynamicsymbols

from coursework.authoring.author import AuthorError, question
from coursework.authoring.forms import equivalent_forms, flat
from coursework.checking import plugins, questions, sealing
from coursework.checking.catalogue import message
from coursework.checking.kinds import Fault
from coursework.checking.plain import NotPlain, to_plain
from coursework.checking.question import Question, Sealed
from coursework.checking.questions import NoSuchQuestion
from coursework.checking.reading import read
from orientation import (
    SEQUENCES,
    body_fixed_from_dcm,
    dcm_from_body_fixed,
    dcm_from_quaternion,
    dcm_from_rotation_vector,
    dcm_from_space_fixed,
    multiply_quaternions,
    quaternion_from_axis_angle,
    simple_dcm,
)

# The package gives the function of this name; the module is looked up.
check_module = sys.modules["coursework.checking.check"]
theta, alpha, phi = sm.symbols("theta alpha varphi")
GIMBAL = dcm_from_body_fixed((theta, alpha, phi), "zxy")
TWO = simple_dcm("x", alpha) * simple_dcm("z", theta)
TURNS = [("z", theta), ("x", alpha), ("y", phi)]


def make(name="trial/gimbal", kind="direction cosine matrix", answer=GIMBAL, **about):
    if name == "trial/gimbal" and kind == "direction cosine matrix":
        about = {"frames": ("D", "A"), "symbols": "theta alpha varphi", "turns": TURNS, **about}
    return question(name, kind, answer, **about)


KINDS = {
    "symbols in a matrix": partial(make),
    "numbers in a matrix": partial(
        make,
        "trial/n",
        answer=dcm_from_body_fixed((sm.pi / 3, sm.pi / 5, -sm.pi / 7), "zxy"),
        frames=("D", "A"),
    ),
    "a quaternion": partial(
        make,
        "trial/q",
        "quaternion",
        quaternion_from_axis_angle((1, 0, 0), theta),
        symbols="theta",
        turns=[("x", theta)],
    ),
    "numbers in a quaternion": partial(
        make, "trial/qn", "quaternion", sm.Matrix([sm.sqrt(2) / 2, 0, -sm.sqrt(2) / 2, 0])
    ),
    "a vector": partial(
        make,
        "trial/v",
        "vector",
        TWO * sm.Matrix([1, 2, 0]),
        symbols="theta alpha",
        turned=(TWO, [1, 2, 0]),
    ),
    "another matrix": partial(
        make, "trial/m", "matrix", TWO.diff(theta)[:2, :], symbols="theta alpha", shape=(2, 3)
    ),
    "an expression": partial(
        make, "trial/e", "expression", sm.acos(sm.sin(theta) * sm.cos(alpha)), symbols="theta alpha"
    ),
    "a number": partial(make, "trial/en", "expression", sm.pi / 7, quantity="angle"),
    "Euler angles": partial(make, "trial/a", "Euler angles", [0.3, 0.5, -0.7], sequence="zxz"),
    "axis and angle": partial(
        make,
        "trial/aa",
        "axis and angle",
        [[sm.Rational(2, 3), sm.Rational(1, 3), sm.Rational(2, 3)], sm.pi / 4],
    ),
    "a sequence": partial(make, "trial/s", "sequence", "zxy"),
    "truth values": partial(
        make,
        "trial/t",
        "truth values",
        [True, False, True, True, False, False, True, False],
        length=8,
    ),
    "words": partial(
        make, "trial/w", "words", ["first", "last", "first"], options=["first", "last"], length=3
    ),
    "a function": partial(
        make,
        "trial/f",
        "function",
        dcm_from_quaternion,
        calls=[[[0.6, 0, 0, 0.8]], [[0.5, 0.5, 0.5, 0.5]]],
        result="direction cosine matrix",
        frames=("A", "N"),
    ),
}
TOLERANT = {
    "one number": partial(make, "trial/t1", "expression", sm.pi / 7),
    "a larger tolerance": partial(make, "trial/t2", "vector", [1, -2, 30], tolerance=0.05),
    "relative": partial(
        make, "trial/t3", "vector", [0.002, -2000, 31], tolerance=1e-6, relative=0.01
    ),
    "a matrix": partial(make, "trial/t4", "matrix", sm.Matrix([[1, 2], [3, 4]]) / 7, shape=(2, 2)),
}
#: The same of words that are signs.
SIGNS = {
    "signs": partial(
        make,
        "trial/r",
        "words",
        ["-i", "1", "k"],
        options=["1", "-1", "i", "-i", "k", "-k"],
        length=3,
    ),
    "axes": partial(
        make,
        "trial/up",
        "words",
        ["+x", "-z", "none"],
        options=["+x", "-x", "+z", "-z", "none"],
        length=3,
    ),
}


@cache
def of(kind):
    """The question of a kind, which takes a while to make."""
    return (KINDS | SIGNS | TOLERANT)[kind]()


@pytest.fixture
def student(tmp_path, monkeypatch):
    """``student(question, ...)``: a check of these questions in a folder of the student's own."""
    monkeypatch.chdir(tmp_path)

    def prepare(*authored):
        # As a student has it: read back from a file, with nothing of the author's left in it.
        as_json = json.loads(
            json.dumps(
                {
                    authored_question.name: authored_question.sealed().as_json()
                    for authored_question in authored
                }
            )
        )
        sealed = {name: Sealed.from_json(about, name) for name, about in as_json.items()}

        def find(name, student):
            if name not in sealed:
                raise NoSuchQuestion(name)
            return sealed[name]

        monkeypatch.setattr(check_module, "find_question", find)
        return check_module.check

    return prepare


def passes(authored, answer):
    return authored.reply_to(authored.to_plain(answer)).outcome == "correct"


# --- any right form passes ----------------------------------------------------------------------


def try_forms(authored, number):
    """Draw forms of the right answer by this run's lot; there are few
    where algebra has nothing to change.
    """
    chance = random.Random(f"{SEED} {authored.name}")
    if authored.public.kind in ("sequence", "truth values", "words", "function"):
        number = min(number, 20)
    for _ in range(number):
        form = random_form(authored.public, authored.answer, chance)
        assert passes(authored, form), form


@pytest.mark.parametrize("kind", KINDS)
def test_any_form_of_the_right_answer_passes(kind):
    try_forms(of(kind), 30)


@pytest.mark.parametrize("kind", KINDS)
def test_named_forms_pass(kind):
    authored = of(kind)
    for form, answer in equivalent_forms(authored.public, authored.answer):
        assert passes(authored, answer), form


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_euler_angles_pass_if_their_orientation_is_right(sequence):
    authored = make("trial/a", "Euler angles", [0.4, 0.9, -1.1], sequence=sequence)
    psi, middle, last = 0.4, 0.9, -1.1
    proper = sequence[0] == sequence[2]
    twin = [psi - sm.pi, -middle if proper else sm.pi - middle, last + sm.pi]
    for answer in (
        twin,
        [psi + 2 * sm.pi, middle, last],
        body_fixed_from_dcm(dcm_from_body_fixed((psi, middle, last), sequence), sequence),
    ):
        assert passes(authored, answer)


# --- each mistake has its message, and no answer a wrong one -------------------------------------


@cache
def sealed(authored):
    """The question with its locks, which are slow to make on purpose and the same each time."""
    return authored.sealed()


def reply_to(authored, answer):
    try:
        return questions.judge(authored.name, sealed(authored), authored.to_plain(answer))
    except NotPlain as refused:
        return questions.Reply(authored.name, "invalid", "unreadable", [str(refused)])


@pytest.mark.parametrize(
    ("answer", "note", "words"),
    [
        (GIMBAL.T, "transposed", "A_C_D, the transpose of D_C_A"),
        (dcm_from_space_fixed((theta, alpha, phi), "zxy"), "other order", "space fixed"),
        (
            simple_dcm("z", theta) * simple_dcm("x", alpha) * simple_dcm("y", phi),
            "other order",
            "right",
        ),
        (GIMBAL.subs(alpha, -alpha), "sign of one turn", "second rotation has the wrong sign"),
        (
            dcm_from_body_fixed((phi, alpha, theta), "zxy"),
            "angles interchanged",
            "first rotation and of the third",
        ),
        (dcm_from_body_fixed((theta, alpha, phi), "zxz"), "another sequence", "zxz"),
        (dcm_from_body_fixed((theta, alpha, phi), "xyz"), "another sequence", "xyz"),
        (
            simple_dcm("y", phi) * simple_dcm("z", theta),
            "turn missing",
            "second rotation is missing",
        ),
        (
            GIMBAL.subs({theta: -theta, alpha: -alpha, phi: -phi}),
            "sign of every turn",
            "wrong sign",
        ),
        (2 * GIMBAL, "not orthogonal", "row should be a unit vector but has length 2 at"),
        (
            GIMBAL + sm.Matrix(3, 3, lambda i, j: sm.Rational(i == j == 2, 10)),
            "not orthogonal",
            "row",
        ),
        (sm.diag(1, -1, 1) * GIMBAL, "left-handed", "determinant is −1"),
        (
            GIMBAL.subs(theta, sm.Symbol("w")),
            "stray symbol",
            "contains w, but this question has the symbols theta, alpha, varphi",
        ),
        (GIMBAL[:2, :], "shape", "a matrix of size 2 × 3"),
        ([list(GIMBAL)], "shape", "one row with 9"),
        (theta, "shape", "a single expression"),
        ("zxy", "shape", "a string"),
        (GIMBAL * sm.I, "not real", "imaginary"),
        (GIMBAL / sm.Add(theta, -theta, evaluate=False), "undefined", "no finite value"),
        (object(), "unreadable", "cannot be read"),
        (ReferenceFrame("E").x + ReferenceFrame("F").y, "unreadable", "not connected"),
        (ReferenceFrame("E"), "frame", "This is the frame E"),
        (ReferenceFrame("E").x, "shape", "a vector"),
        (
            simple_dcm("x", sm.Rational(1, 3)),
            "",
            "question uses theta, alpha, varphi, but your answer contains only numbers",
        ),
        (..., "", "in place of"),
        (None, "", "in place of"),
    ],
)
def test_the_reply_names_what_is_wrong(answer, note, words):
    reply = reply_to(of("symbols in a matrix"), answer)
    assert reply.note == note
    assert words in repr(reply)
    assert reply.outcome != "correct"


@pytest.mark.parametrize(
    ("kind", "answer", "note"),
    [
        ("a quaternion", [sm.cos(theta / 2), -sm.sin(theta / 2), 0, 0], "conjugate"),
        ("a quaternion", [sm.sin(theta / 2), 0, 0, sm.cos(theta / 2)], "scalar last"),
        ("a quaternion", [sm.cos(theta), sm.sin(theta), 0, 0], "whole angle"),
        ("a quaternion", [sm.sin(theta / 2), sm.cos(theta / 2), 0, 0], "cosine for sine"),
        ("a quaternion", [1, theta, 0, 0], "not unit length"),
        ("a vector", TWO.T * sm.Matrix([1, 2, 0]), "turned the wrong way"),
        ("a vector", [1, 2, 0], "not turned"),
        ("Euler angles", [-0.3, 0.5, -0.7], "sign of one angle"),
        ("Euler angles", [17.18873, 28.64789, -40.10705], "in degrees"),
        ("Euler angles", [20.0, 30.0, 40.0], "degrees"),
        ("a number", 25.7142857, "in degrees"),
        ("a number", -sm.pi / 7, "opposite"),
        ("a sequence", "yxz", "sequence reversed"),
        ("a sequence", "zzx", "impossible sequence"),
        ("a sequence", "abc", "shape"),
        ("axis and angle", ([2, 1, -2], sm.pi / 4), "not unit length"),
        ("axis and angle", ([2, 1, -2], sm.pi / 8), "not unit length"),
        (
            "axis and angle",
            ([sm.Rational(-2, 3), sm.Rational(-1, 3), sm.Rational(-2, 3)], sm.pi / 4),
            "axis reversed",
        ),
        ("a function", lambda q: dcm_from_quaternion(q).T, "transposed"),
        ("a function", lambda q: 1 / 0, "raised an error"),
        ("a function", dcm_from_quaternion([1, 0, 0, 0]), "unreadable"),
        ("truth values", [True] * 7, "shape"),
        ("words", ["first", "last", "middle"], "shape"),
    ],
)
def test_other_kinds_name_what_is_wrong(kind, answer, note):
    reply = reply_to(of(kind), answer)
    assert reply.note == note, reply
    assert reply.messages and reply.outcome in ("wrong", "invalid")


@pytest.mark.parametrize(
    ("kind", "answer"),
    [
        ("signs", ["-i", 1, "k"]),
        ("signs", ["\u2212i", 1.0, sm.Symbol("k")]),
        ("signs", [-sm.Symbol("i"), sm.Integer(1), "+k"]),
        ("signs", ["- i", "+ 1", " K "]),
        ("axes", ["x", "- z", "None"]),
        ("axes", ["\u201cx\u201d", "\uff0d\uff5a", "'none'"]),  # out of a text program
        ("a sequence", "\uff3a\u2013\uff38\u2013\uff39"),
        ("a sequence", "3-1-2"),
        ("a number", 180 * units.degree / 7),
        (
            "Euler angles",
            [degrees * units.degree for degrees in (17.18873, 28.64789, -40.10705)],
        ),
        ("truth values", ["True", "False", "true", True, 0, sm.false, np.True_, "False"]),
        ("a number", sm.pi / 7 + 0 * sm.Symbol("x")),
        ("a vector", TWO * sm.Matrix([1, 2, 0]) * units.radian),
    ],
)
def test_words_and_truth_values_pass_as_beginners_write_them(kind, answer):
    assert passes(of(kind), answer)


def test_a_frame_is_not_said_to_be_connected_with_itself():
    A, B = ReferenceFrame("A"), ReferenceFrame("B")
    B.orient_axis(A, A.z, theta)
    [message] = of("symbols in a matrix").reply_to(to_plain(B)).messages
    assert "This is the frame `B`, connected to `A`." in message
    [message] = of("symbols in a matrix").reply_to(to_plain(ReferenceFrame("C"))).messages
    assert "connected to no other." in message


@pytest.mark.parametrize(("digits", "rounded"), [(2, True), (1, False)])
def test_numbers_that_nearly_fit_together_were_rounded(digits, rounded):
    """Of a matrix and of an axis: the remark on rounding comes before the fault of
    geometry, and only where it may.
    """
    matrix = sm.Matrix([[8, 1, 4], [-4, 4, 7], [-1, -8, 4]]) / 9
    axis = [sm.Rational(2, 7), sm.Rational(3, 7), sm.Rational(6, 7)]
    for kind, answer, digits_given in (
        ("direction cosine matrix", matrix, np.array(matrix, dtype=float).round(digits)),
        (
            "axis and angle",
            [axis, sm.pi / 4],
            ([round(float(part), digits) for part in axis], 0.79),
        ),
    ):
        authored = make(
            "trial/round", kind, answer, **({"frames": ("S", "B")} if kind[0] == "d" else {})
        )
        reply = authored.reply_to(to_plain(digits_given))
        assert reply.outcome == "invalid"
        assert ("If you rounded" in reply.messages[0]) == rounded, reply.messages


def test_no_turn_at_all_is_not_called_twice_half_a_turn():
    axis = [sm.Rational(2, 3), sm.Rational(1, 3), sm.Rational(2, 3)]
    for half_turn in (sm.pi, np.pi, -3 * sm.pi):
        authored = make("trial/half", "axis and angle", [axis, half_turn])
        assert (
            authored.reply_to(to_plain((axis, 0))).note == ""
            and authored.reply_to(to_plain((axis, sm.pi / 2))).note == "half"
        )
    reply = of("axis and angle").reply_to(to_plain((axis, sm.pi / 2)))
    assert reply.note == "double" and reply.messages[0].startswith("The angle is twice")


@pytest.mark.parametrize("kind", ["numbers in a matrix", "numbers in a quaternion"])
@pytest.mark.parametrize("off", [4, 6, 8])
def test_what_is_close_is_not_said_to_be_a_slip_undone_twice(kind, off):
    """The transpose of what is nearly right is in the cell of the mistake
    "transposed"; but that is no mistake here.
    """
    authored = of(kind)
    turned = np.array(
        dcm_from_body_fixed((np.pi / 3, np.pi / 5, -np.pi / 7), "zxy")
        if "matrix" in kind
        else [0.5**0.5, 0, -(0.5**0.5), 0]
    )
    notes = set()
    for chance in range(15):
        small = np.random.default_rng(chance).normal(size=3)
        small *= off * 0.0005 / np.abs(small).max()
        if "matrix" in kind:
            answer = turned @ dcm_from_rotation_vector(small)
        else:
            answer = multiply_quaternions(turned, [np.sqrt(1 - small @ small), *small])
        notes.add(authored.reply_to(to_plain(answer)).note)
    assert "rounded too far" in notes and notes <= {"rounded too far", ""}, notes


@pytest.mark.sampled(4)
@pytest.mark.parametrize("sequence", SEQUENCES)
def test_every_mistake_of_the_catalogue_is_named_in_all_twelve_sequences(sequence):
    authored = make(
        "trial/g",
        answer=dcm_from_body_fixed((theta, alpha, phi), sequence),
        frames=("D", "A"),
        symbols="theta alpha varphi",
        turns=[*zip(sequence, (theta, alpha, phi))],
    )
    for mistake in authored.mistakes:
        text = authored.fingerprint_of(authored.to_plain(mistake.answer))
        assert (mistake.note, mistake.details) in authored.entries[text].notes or passes(
            authored, mistake.answer
        )


def test_no_mistake_is_named_for_an_answer_that_does_not_have_it():
    authored, chance = of("symbols in a matrix"), random.Random(4)
    for _ in range(100):
        axes = "".join(chance.choice("xyz") for _ in range(3))
        angles = [
            chance.choice([-1, 1]) * chance.choice([theta, alpha, phi, theta / 2, alpha + phi])
            for _ in range(3)
        ]
        answer = sm.eye(3)
        for axis, angle in zip(axes, angles):
            answer = simple_dcm(axis, angle) * answer
        entry = authored.entries.get(authored.fingerprint_of(authored.to_plain(answer)))
        if entry and entry.outcome == "mistake":
            notes = [
                mistake
                for mistake in authored.mistakes
                if (mistake.note, mistake.details) in entry.notes
            ]
            assert notes and all(
                (mistake.answer - answer).subs({theta: 0.3, alpha: 1.1, phi: -0.7}).norm() < 1e-12
                for mistake in notes
            )


@pytest.mark.parametrize(
    ("change", "digits", "note"),
    [
        (lambda right: right, 3, "not orthogonal"),
        (lambda right: right.T, 15, "transposed"),
        (lambda right: simple_dcm("z", theta).T, 15, "transposed, and turn missing"),
        (lambda right: simple_dcm("y", sm.pi / 3) * right, 15, ""),
        (lambda right: simple_dcm("y", sm.pi / 3) * right, 4, "not orthogonal"),
    ],
)
def test_decimals_cost_no_more_than_two_slow_hashes(change, digits, note, monkeypatch):
    turns = [("x", sm.pi / 4), ("z", theta)]
    right = simple_dcm("z", theta) * simple_dcm("x", sm.pi / 4)
    authored = make("trial/decimals", answer=right, frames=("B", "N"), symbols="theta", turns=turns)
    hidden, hashed = sealed(authored), []
    monkeypatch.setattr(
        sealing,
        "slow_key",
        lambda *known, slow=sealing.slow_key: hashed.append(known) or slow(*known),
    )
    reply = questions.judge(authored.name, hidden, authored.to_plain(change(right).evalf(digits)))
    assert reply.note == note and ("decimal fractions" in repr(reply) or digits == 15)
    assert len(hashed) <= 2


@pytest.mark.parametrize("kind", TOLERANT)
def test_the_tolerance_is_exact_on_both_sides(kind):
    """An answer within `tolerance + relative * |right|` passes, one just beyond
    does not: whatever cell it is in.
    """
    authored = of(kind)
    entries, put = flat(authored.answer)
    absolute, relative = authored.public.tolerance, authored.public.relative or 0
    sealed, chance = authored.sealed(), random.Random(2)
    for place in range(len(entries)):
        for share, right in ((-0.9999, True), (0.9999, True), (-1.0001, False), (1.0001, False)):
            answer = [float(entry) for entry in entries]
            answer = [
                x + chance.uniform(-1, 1) * 0.99 * (absolute + relative * abs(x)) for x in answer
            ]
            exact = float(entries[place])
            answer[place] = exact + share * (absolute + relative * abs(exact))
            reply = questions.judge(authored.name, sealed, authored.to_plain(put(answer)))
            assert (reply.outcome == "correct") == right, (place, share)
            if not right:
                assert reply.note == "rounded too far" and "close" in repr(reply)


def test_the_other_sign_of_a_quaternion_passes_unless_it_is_asked_for():
    free = of("numbers in a quaternion")
    assert passes(free, -free.answer)
    signed = make("trial/qs", "quaternion", free.answer, either_sign=False)
    assert not passes(signed, -free.answer)


# --- the check itself ---------------------------------------------------------------------------


def test_no_hint_that_is_not_yet_earned_stands_in_clear_on_the_disk(student, tmp_path):
    authored = make(
        hints={"transposed": ["Look at the rows."]},
        ladder=["Begin with one turn."],
        solution="By hand.",
    )
    check = student(authored)
    check("trial/gimbal", GIMBAL.T)
    text = json.dumps(authored.sealed("CODE").as_json()) + "".join(
        path.read_text() for path in tmp_path.rglob("*") if path.is_file()
    )
    assert not any(words in text for words in ("Look at", "Begin with", "By hand"))


# --- the locks ----------------------------------------------------------------------------------


@pytest.mark.sampled(5)
@pytest.mark.parametrize("kind", KINDS)
def test_no_page_can_be_tried_without_the_slow_hash(kind):
    """What a page says can often be known beforehand: so its key must
    cost as much as that of a locker.
    """
    authored = of(kind)
    sealed, text = authored.sealed(), authored.fingerprint_of(authored.plain)
    secrets = [hashlib.sha256(text.encode()).digest(), text.encode()[:64], b""]
    for content, _ in authored.pages.contents.values():
        known = json.dumps(content, ensure_ascii=False, sort_keys=True).encode()
        for secret in secrets:
            key = hashlib.blake2b(known, key=secret, digest_size=sealing.PAGE_KEY).digest()
            for page in sealed.pages:
                with pytest.raises(ValueError):
                    sealing.unseal(page, key)


@pytest.mark.sampled(4)
@pytest.mark.parametrize("kind", KINDS)
def test_nothing_tells_the_locker_of_the_right_answer_from_the_others(kind):
    authored = of(kind)
    sealed = authored.sealed()
    data = base64.b85decode(sealed.lockers)
    lockers = [
        data[start : start + sealing.LOCKER] for start in range(0, len(data), sealing.LOCKER)
    ]
    assert lockers == sorted(lockers) and len(lockers) == len(authored.entries) + len(authored.near)
    assert len(sealed.lockers) == 20 * len(lockers)
    assert authored.sealed() == sealed
    assert questions.judge(authored.name, sealed, authored.plain).outcome == "correct"


def test_only_hints_that_fit_every_question_of_a_kind_come_by_themselves():
    """A vector may be a list of angles, and a matrix of a photograph has no first turn."""
    about = {"solution": "It is 7. And this is a long way of saying so, longer than the rest."}
    assert make("trial/said", "expression", 7, **about).ladder == []
    begin = plugins.kinds()["function"].begin
    asked = make("trial/f", "function", lambda x: [x], calls=[[1.0]], result="vector", length=1)
    assert begin and asked.ladder == [begin]


def test_what_a_question_may_tell_is_no_more_than_what_its_author_wrote():
    """Nothing public but the seed of the points follows from the answer: no bit
    of a number, no order of lockers.
    """
    for authored in map(of, KINDS):
        assert set(authored.sealed().as_json()) <= {
            "kind", "frames", "symbols", "unit", "shape", "length", "sequence", "options",
            "tolerance", "relative", "calls", "takes", "result", "quantity", "either sign",
            "unit vector", "every symbol", "salt", "lockers", "pages", "ladder", "worth", "answer",
        }  # fmt: skip
        assert authored.public.salt in [
            hashlib.sha256(f"{authored.name} {attempt}".encode()).hexdigest()[:16]
            for attempt in range(50)
        ]


def test_the_order_in_which_symbols_are_listed_does_not_matter():
    sealed = make().sealed()
    for order in (sorted, lambda names: sorted(names, reverse=True)):
        symbols = {name: sealed.question.symbols[name] for name in order(sealed.question.symbols)}
        again = replace(sealed, question=replace(sealed.question, symbols=symbols))
        assert questions.judge("trial/gimbal", again, to_plain(GIMBAL)).outcome == "correct"


def test_the_values_of_an_answer_do_not_stand_in_what_is_sealed():
    text = json.dumps(of("numbers in a matrix").sealed().as_json())
    for entry in of("numbers in a matrix").answer:
        assert str(entry) not in text and f"{float(entry):.4f}" not in text


# --- what an author may get wrong ---------------------------------------------------------------


@pytest.mark.parametrize(
    ("about", "words"),
    [
        ({"kind": "riddle"}, "there is no kind .riddle."),
        ({"frames": None}, "needs 'frames'"),
        ({"symbols": "theta"}, "cannot be read"),
        ({"turns": TURNS[::-1]}, "is not the right answer"),
        ({"answer": ...}, "cannot be read"),
    ],
)
def test_a_question_that_is_not_well_posed_is_refused(about, words):
    with pytest.raises(AuthorError, match=words):
        make(**{"kind": "direction cosine matrix", **about})


def test_products_of_quaternions_in_the_other_order_are_named():
    turns = [("x", theta), ("y", alpha)]
    first, second = (
        quaternion_from_axis_angle(axis, angle)
        for axis, angle in (((1, 0, 0), theta), ((0, 1, 0), alpha))
    )
    authored = make(
        "trial/qq",
        "quaternion",
        multiply_quaternions(first, second),
        symbols="theta alpha",
        turns=turns,
    )
    reply = reply_to(authored, multiply_quaternions(second, first))
    assert reply.note == "other order"
    # The rule for matrices is another one, and this answer already follows it.
    assert "quaternion" in reply.messages[0] and "matrix" not in reply.messages[0]


@pytest.mark.parametrize("kind", ["direction cosine matrix", "quaternion"])
@pytest.mark.parametrize("count", [2, 3, 4])
def test_the_other_order_and_one_sign_are_told_as_what_they_are(kind, count):
    """And not as the transpose with all the other signs, which is
    the same and which nobody has done.
    """
    turns = [("z", theta), ("x", alpha), ("y", phi), ("z", theta / 3)][:count]
    build = plugins.kinds()[kind].build
    authored = make(
        "trial/os",
        kind,
        build(turns),
        frames=("D", "A"),
        symbols=" ".join(["theta", "alpha", "varphi"][:count]),
        turns=turns,
    )
    for place in range(count):
        slipped = [
            (axis, -angle if order == place else angle) for order, (axis, angle) in enumerate(turns)
        ]
        reply = reply_to(authored, build(slipped[::-1]))
        assert (reply.note, reply.details) == ("other order, sign of one turn", {"turn": place})
        assert "wrong order, and the angle of" in reply.messages[0] and len(reply.messages) == 1


def test_messages_speak_of_what_was_asked_for():
    """Quaternions, angles and sequences are no factors of a product
    of matrices, and have no columns.
    """
    turns = [("x", theta), ("y", alpha)]
    product = make(
        "trial/qq",
        "quaternion",
        plugins.kinds()["quaternion"].build(turns),
        symbols="theta alpha",
        turns=turns,
    )
    tried = [
        product,
        *(kind for kind in map(of, KINDS) if kind.public.kind in ("quaternion", "axis and angle")),
    ]
    for authored in tried:
        for mistake in authored.mistakes:
            if mistake.note != "authored":
                assert "matrix" not in message(
                    authored.public, mistake.note, mistake.details
                ).replace("with matrices", "")


def test_one_answer_gets_one_diagnosis():
    """Where two mistakes lead to one answer, both are true of it;
    being told two things helps nobody.
    """
    authored = of("symbols in a matrix")
    for entry in authored.entries.values():
        if entry.outcome == "mistake":
            assert len(authored.reply_to(entry.plain).messages) == 1


def test_a_sequence_is_not_given_away():
    authored = make("trial/seq", "sequence", "yxz")
    reply = reply_to(authored, "zxy")
    assert reply.note == "sequence reversed" and "reverse" not in reply.messages[0]


def test_what_sympy_has_put_off_and_what_mechanics_makes_is_read():
    k, time = sm.Symbol("k"), dynamicsymbols._t
    authored = make("trial/late", "expression", 3 * sm.sin(phi), symbols="varphi")
    for answer in (
        sm.Sum(sm.sin(phi), (k, 1, 3)),
        sm.Limit(3 * sm.sin(phi) * sm.sin(k) / k, k, 0),
        sm.Trace(sm.diag(sm.sin(phi), 2 * sm.sin(phi))),
        sm.Determinant(sm.diag(3, sm.sin(phi))),
        3 * sm.sin(dynamicsymbols("phi")),
    ):
        assert passes(authored, answer), answer
    rate = make(
        "trial/rate", "expression", 2 * dynamicsymbols("varphi").diff(time), symbols="varphi'"
    )
    assert passes(rate, 2 * dynamicsymbols("phi").diff(time))
    assert passes(rate, 2 * sm.Symbol("phidot"))
    frames = [ReferenceFrame(name) for name in ("N", "A")]
    frames[1].orient_axis(frames[0], frames[0].z, theta)
    rows = make("trial/rows", answer=frames[1].dcm(frames[0]), frames=("A", "N"), symbols="theta")
    assert passes(rows, [frames[1].x, frames[1].y, frames[1].z])
    assert reply_to(rows, [ReferenceFrame("Q").x] * 3).note == "frame"


@pytest.mark.parametrize("kind", sorted(plugins.kinds()))
def test_what_is_wanted_is_said_in_a_whole_sentence(kind):
    asked = Question(
        kind, frames=("B", "A"), length=3, options=("x", "y"), arguments={"sequence": "xyz"}
    )
    for answer in ("no such text", [1, "two"], {1, 2}, 3, sm.eye(2)):
        try:
            read(asked, to_plain(answer))
        except Fault as form_fault:
            assert not re.search(r"[,;:.] ?[,;:.]", form_fault.message), form_fault.message
        except (NotPlain, KeyError):
            pass  # it says so elsewhere; an answer in words that is none of the options
