"""The typical mistakes with orientations: their effect on a correct answer, and their messages."""

import itertools
import math
from collections.abc import Callable, Iterator
from typing import Any, TypeAlias

import sympy

from coursework.checking.mistakes import Mistake, as_matrix, of_symbols
from coursework.checking.question import Question
from orientation import (
    SEQUENCES,
    body_fixed_from_dcm,
    dcm_from_axis_angle,
    dcm_from_body_fixed,
    multiply_quaternions,
    quaternion_from_axis_angle,
    space_fixed_from_dcm,
)

#: An orientation as an author writes it: a matrix or a list, of SymPy expressions or numbers.
Answer: TypeAlias = Any
#: Successive rotations, each with an axis, as a letter or components, and an angle.
Turns: TypeAlias = list[tuple[Any, Any]]
ORDINALS = ("first", "second", "third", "fourth", "fifth", "sixth")


def _names(question: Question) -> tuple[str, str]:
    target, source = (question.frames or ("A", "N"))[:2]
    return (
        rf"${{}}^{{{target}}}\mathbf{{C}}^{{{source}}}$",
        rf"${{}}^{{{source}}}\mathbf{{C}}^{{{target}}}$",
    )


def _transposed(question: Question) -> str:
    if question.kind == "matrix" or not question.frames:
        return "This is the transpose of the right matrix."
    wanted, given = _names(question)
    return (
        f"This is {given}, the transpose of {wanted}: its columns are what the rows should be. "
        "Transpose it."
    )


def _product(question: Question) -> str:
    quaternions = question.kind_of_values == "quaternion"
    return f"The {'quaternions' if quaternions else 'factors'} are multiplied"


def _other_order(question: Question) -> str:
    if question.kind_of_values == "quaternion":
        return (
            "The quaternions are multiplied in the wrong order. The quaternion of the first "
            "rotation goes on the left, not on the right as with matrices. In your order the axes "
            "are fixed in the first frame (space fixed)."
        )
    return (
        "The factors are multiplied in the wrong order. The matrix of the first rotation goes on "
        "the right. In your order the axes are fixed in the first frame (space fixed)."
    )


def _turn(number: int | None) -> str:
    return "the rotation" if number is None else f"the {ORDINALS[number]} rotation"


MESSAGES: dict[str, Callable[..., str]] = {
    "transposed": _transposed,
    "sign of one turn": lambda question, turn: f"The angle of {_turn(turn)} has the wrong sign.",
    "sign of two turns": lambda question, first, second: (
        f"The angles of {_turn(first)} and of {_turn(second)} have the wrong sign."
    ),
    "sign of every turn": lambda question: (
        "Every angle has the wrong sign: each rotation goes the wrong way round."
    ),
    "other order": _other_order,
    "other order, transposed": lambda question: (
        "The factors are multiplied in the wrong order, and the product is transposed."
    ),
    "other order, sign of one turn": lambda question, turn: (
        f"{_product(question)} in the wrong order, and the angle of {_turn(turn)} has the wrong "
        "sign."
    ),
    "angles interchanged": lambda question, first, second: (
        f"You swapped the angles of {_turn(first)} and of {_turn(second)}."
    ),
    "another sequence": lambda question, sequence: (
        f"These are body fixed rotations in the sequence `{sequence}`, which is not the sequence "
        "of the question."
    ),
    "another axis": lambda question, turn, axis: (
        f"You made {_turn(turn)} about the ${axis}$ axis. It should be about another axis."
    ),
    "turn missing": lambda question, turn: f"{_turn(turn).capitalize()} is missing.",
    "one factor only": lambda question, turn: (
        f"This is {_turn(turn)} alone. The others are missing."
    ),
    "sine for cosine": lambda question, turn: f"You swapped sine and cosine in {_turn(turn)}.",
    "degrees taken for radians": lambda question: (
        "You gave degrees to functions that take radians. Convert them first: `sm.rad(30)` or "
        "`np.deg2rad(30)`."
    ),
    "conjugate": lambda question: (
        "This is the conjugate, which rotates the other way: its vector part has the wrong sign."
    ),
    "scalar last": lambda question: (
        "The scalar part comes last here. In this book it comes first: $(q_0, q_i, q_j, q_k)$."
    ),
    "scalar last, conjugate": lambda question: (
        "The scalar part comes last here, and the vector part has the wrong sign."
    ),
    "whole angle": lambda question: (
        "You used the whole angle. A quaternion holds the sine and cosine of *half* the angle."
    ),
    "quarter angle": lambda question: "You halved the angle twice.",
    "angles of another sequence": lambda question, sequence: (
        f"These are the angles for the sequence `{sequence}`. Give those for "
        f"`{question.arguments['sequence']}`."
    ),
    "angles of the transpose": lambda question: "These are the angles of the transposed matrix.",
    "space fixed angles": lambda question: (
        "These are the angles of space fixed rotations. Give the angles of body fixed rotations."
    ),
    "angles in reverse": lambda question: "The three angles are right but in reverse order.",
    "sign of one angle": lambda question, turn: f"The {ORDINALS[turn]} angle has the wrong sign.",
    "sign of every angle": lambda question: "All angles have the wrong sign.",
    "axis reversed": lambda question: (
        "The rotation goes the wrong way round: the axis, or the angle, has the wrong sign."
    ),
    "sequence reversed": lambda question: (
        "Are these rotations about axes fixed in space, or did you list them from the last to the "
        "first? Each rotation is about an axis of the frame that the previous rotation "
        "reached."
    ),
    "cosine for sine": lambda question: "You swapped sine and cosine.",
    # For an axis and an angle: the axis is neither halved nor doubled.
    "half": lambda question: "The angle is half what it should be; the axis is right.",
    "double": lambda question: "The angle is twice what it should be; the axis is right.",
}


#: The possible details of a mistake: the places that a locker can hold.
DETAILS = {
    "turn": (None, *range(len(ORDINALS))),
    "first": tuple(range(len(ORDINALS))),
    "second": tuple(range(len(ORDINALS))),
    "sequence": (
        "zxz",
        "xyx",
        "yzy",
        "zyz",
        "xzx",
        "yxy",
        "xyz",
        "yzx",
        "zxy",
        "xzy",
        "zyx",
        "yxz",
    ),
    "axis": "xyz",
}

#: What students did, by the note of a mistake or of a fault of form, for the instructor's report.
DEEDS = {
    "sign of one turn": "gave the angle of the {turn} rotation the wrong sign",
    "sign of two turns": "gave the angles of the {first} and the {second} rotation the wrong sign",
    "sign of every turn": "rotated the wrong way round throughout",
    "other order": "multiplied in the other order (space fixed rotations)",
    "other order, transposed": "multiplied in the other order and gave the transpose",
    "other order, sign of one turn": "multiplied in the other order and gave the {turn} rotation "
    "the wrong sign",
    "angles interchanged": "interchanged the angles of the {first} and the {second} rotation",
    "another sequence": "used the sequence {sequence}",
    "another axis": "made the {turn} rotation about {axis}",
    "turn missing": "left the {turn} rotation out",
    "one factor only": "gave the {turn} rotation alone",
    "sine for cosine": "interchanged sine and cosine in the {turn} rotation",
    "degrees taken for radians": "took degrees for radians",
    "conjugate": "gave the conjugate",
    "scalar last": "put the scalar last",
    "scalar last, conjugate": "put the scalar last and gave the conjugate",
    "whole angle": "used the whole angle in place of half of it",
    "quarter angle": "halved the angle twice",
    "angles of another sequence": "gave the angles of the sequence {sequence}",
    "angles of the transpose": "gave the angles of the transposed matrix",
    "space fixed angles": "gave space fixed angles",
    "angles in reverse": "gave the angles in reverse order",
    "sign of one angle": "gave the {turn} angle the wrong sign",
    "sign of every angle": "gave every angle the wrong sign",
    "axis reversed": "rotated the wrong way round",
    "sequence reversed": "gave the sequence in reverse",
    "cosine for sine": "interchanged sine and cosine",
    "impossible sequence": "gave a sequence that is not one of the twelve",
    "zero axis": "gave an axis of length zero",
    "not orthogonal": "gave a matrix that is not orthogonal",
    "left-handed": "gave a left-handed matrix",
}


# --- what each mistake does to an answer --------------------------------------------------------


def dcm_of(turns: Turns) -> Answer:
    """Return the direction cosine matrix of successive rotations."""
    result = sympy.eye(3)
    for axis, angle in turns:
        result = dcm_from_axis_angle(_components(axis), sympy.sympify(angle)) * result
    return result


def quaternion_of(turns: Turns) -> Answer:
    """Return the quaternion of successive rotations."""
    result = sympy.Matrix([1, 0, 0, 0])
    for axis, angle in turns:
        result = multiply_quaternions(
            result, quaternion_from_axis_angle(_components(axis), sympy.sympify(angle))
        )
    return result


def _components(axis: Any) -> list[Any]:
    if isinstance(axis, str):
        sign = -1 if axis.startswith("-") else 1
        return [sympy.Integer(sign * (letter == axis[-1])) for letter in "xyz"]
    return [sympy.sympify(part) for part in axis]


def _of_turns(build: Callable[[Turns], Answer], turns: Turns) -> Iterator[Mistake]:
    """Yield mistakes in building an orientation from successive rotations."""

    def changed(*numbers: int) -> Turns:
        return [
            (axis, -angle if order in numbers else angle)
            for order, (axis, angle) in enumerate(turns)
        ]

    count = len(turns)

    def named(turn: int) -> int | None:
        # A single rotation is not called the first.
        return turn if count > 1 else None

    for turn in range(count):
        yield Mistake("sign of one turn", {"turn": named(turn)}, build(changed(turn)))
    if count > 1:
        yield Mistake("other order", {}, build(turns[::-1]))
        yield Mistake("sign of every turn", {}, build(changed(*range(count))))
        for turn in range(count):
            yield Mistake("turn missing", {"turn": turn}, build(turns[:turn] + turns[turn + 1 :]))
    for first, second in itertools.combinations(range(count), 2):
        if count > 2:
            yield Mistake(
                "sign of two turns",
                {"first": first, "second": second},
                build(changed(first, second)),
            )
            for turn in range(count):
                if turn not in (first, second):
                    yield Mistake("one factor only", {"turn": turn}, build([turns[turn]]))
        swapped = list(turns)
        swapped[first] = (turns[first][0], turns[second][1])
        swapped[second] = (turns[second][0], turns[first][1])
        yield Mistake("angles interchanged", {"first": first, "second": second}, build(swapped))
    letters = [axis for axis, _ in turns]
    plain = all(isinstance(axis, str) and len(axis) == 1 for axis in letters)
    if plain and count == 3:
        for sequence in SEQUENCES:
            if sequence != "".join(letters):
                yield Mistake(
                    "another sequence",
                    {"sequence": sequence},
                    build([(axis, angle) for axis, (_, angle) in zip(sequence, turns)]),
                )
    for turn in range(count):
        if plain:
            for axis in "xyz":
                if axis != letters[turn]:
                    other = list(turns)
                    other[turn] = (axis, turns[turn][1])
                    yield Mistake("another axis", {"turn": named(turn), "axis": axis}, build(other))
        other = list(turns)
        other[turn] = (turns[turn][0], sympy.pi / 2 - turns[turn][1])
        if build is not quaternion_of:
            yield Mistake("sine for cosine", {"turn": named(turn)}, build(other))
    # This is simpler than the equivalent transpose with all other signs.
    for turn in range(count) if count > 1 else ():
        yield Mistake("other order, sign of one turn", {"turn": turn}, build(changed(turn)[::-1]))
    if turns and not any(sympy.sympify(angle).free_symbols for _, angle in turns):
        yield Mistake(
            "degrees taken for radians",
            {},
            build([(axis, sympy.deg(angle).evalf(20)) for axis, angle in turns]),
        )


def of_dcm(question: Question, answer: Answer, turns: Turns, turned: Answer) -> Iterator[Mistake]:
    answer = as_matrix(answer)
    yield Mistake("transposed", {}, answer.T)
    yield from _of_turns(dcm_of, turns)
    if len(turns) > 1:
        yield Mistake("other order, transposed", {}, dcm_of(turns[::-1]).T)
    if not turns:
        yield from of_symbols(question, answer)


def of_quaternion(
    question: Question, answer: Answer, turns: Turns, turned: Answer
) -> Iterator[Mistake]:
    answer = as_matrix(answer)
    scalar, i, j, k = answer
    yield Mistake("conjugate", {}, sympy.Matrix([scalar, -i, -j, -k]))
    yield Mistake("scalar last", {}, sympy.Matrix([i, j, k, scalar]))
    yield Mistake("scalar last, conjugate", {}, sympy.Matrix([-i, -j, -k, scalar]))
    if len(turns) == 1:
        axis, angle = turns[0]
        yield Mistake("whole angle", {}, quaternion_of([(axis, 2 * angle)]))
        yield Mistake("quarter angle", {}, quaternion_of([(axis, sympy.sympify(angle) / 2)]))
        cosine, sine = scalar, sympy.sin(sympy.sympify(angle) / 2)
        direction = sympy.Matrix(_components(axis))
        direction = direction / sympy.sqrt(direction.dot(direction))
        yield Mistake("cosine for sine", {}, sympy.Matrix([sine, *(cosine * direction)]))
    yield from _of_turns(quaternion_of, turns)
    if not turns:
        yield from of_symbols(question, answer)


def of_angles(
    question: Question, answer: Answer, turns: Turns, turned: Answer
) -> Iterator[Mistake]:
    asked: Any = question.arguments["sequence"]
    angles: Answer = [float(angle) for angle in answer]
    dcm = dcm_from_body_fixed(angles, asked)
    for turn in range(3):
        yield Mistake(
            "sign of one angle",
            {"turn": turn},
            [-angle if order == turn else angle for order, angle in enumerate(angles)],
        )
    yield Mistake("sign of every angle", {}, [-angle for angle in angles])
    yield Mistake("angles in reverse", {}, angles[::-1])
    yield Mistake(
        "angles of the transpose",
        {},
        list(body_fixed_from_dcm(dcm.T, asked)),
    )
    yield Mistake("in degrees", {}, [math.degrees(angle) for angle in angles])
    yield Mistake("space fixed angles", {}, list(space_fixed_from_dcm(dcm, asked)))
    for sequence in SEQUENCES:
        if sequence != asked:
            yield Mistake(
                "angles of another sequence",
                {"sequence": sequence},
                list(body_fixed_from_dcm(dcm, sequence)),
            )


def of_axis_and_angle(
    question: Question, answer: Answer, turns: Turns, turned: Answer
) -> Iterator[Mistake]:
    axis, angle = answer
    axis = list(axis)
    angle = sympy.sympify(angle)
    yield Mistake("axis reversed", {}, [axis, -angle])
    yield Mistake("in degrees", {}, [axis, angle * 180 / sympy.pi])
    yield Mistake("half", {}, [axis, angle / 2])
    left = sympy.cos(angle) + 1
    # Twice half a turn is no rotation at all, which nobody gives as a doubled angle.
    if not left.is_number or left > 1e-9:
        yield Mistake("double", {}, [axis, 2 * angle])


def of_sequence(
    question: Question, answer: Answer, turns: Turns, turned: Answer
) -> Iterator[Mistake]:
    if answer != answer[::-1]:
        yield Mistake("sequence reversed", {}, answer[::-1])
