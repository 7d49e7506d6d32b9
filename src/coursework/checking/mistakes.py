"""The typical mistakes: what each does to a right answer, and what the student is told.

When a question is sealed, every mistake that applies to it is carried out on the right answer, and its
result gets a locker of its own. So a student's mistake is recognised by one fingerprint, and nothing of the
right answer is needed where the student works. Mistakes that lead to the same answer are named together.

The messages are no secret; which of them a question knows, and for what answers, is.
"""

import itertools
import math
from typing import NamedTuple

ORDINALS = ("first", "second", "third", "fourth", "fifth", "sixth")


class Mistake(NamedTuple):
    """A note for statistics, what the message needs to know, and the answer that the mistake leads to."""

    note: str
    details: dict
    answer: object


def message(question, note, details):
    """What a student is told of a mistake."""
    return MESSAGES[note](question, **details)


def _name(question):
    target, source = question.get("frames", ("A", "N"))[:2]
    return rf"${{}}^{{{target}}}\mathbf{{C}}^{{{source}}}$", rf"${{}}^{{{source}}}\mathbf{{C}}^{{{target}}}$"


def _transposed(question):
    if question["kind"] == "matrix" or "frames" not in question:
        return "This is the transpose of what is asked for."
    wanted, given = _name(question)
    return f"This is {given}, the transpose of {wanted}: its columns are what should be the rows. Transpose it."


def _turn(number):
    return "the turn" if number is None else f"the {ORDINALS[number]} turn"


MESSAGES = {
    "transposed": _transposed,
    "sign of one turn": lambda question, turn: f"The angle of {_turn(turn)} has the wrong sign.",
    "sign of two turns": lambda question, first, second: (
        f"The angles of {_turn(first)} and of {_turn(second)} have the wrong sign."
    ),
    "sign of every turn": lambda question: "Every angle has the wrong sign: each turn goes the wrong way round.",
    "other order": lambda question: (
        "The factors are multiplied in the other order. The matrix of the first turn stands on the right; in this "
        "order the same turns are about axes fixed in the first frame (space fixed)."
    ),
    "other order, transposed": lambda question: (
        "The factors are multiplied in the other order, and the product is transposed."
    ),
    "angles interchanged": lambda question, first, second: (
        f"The angles of {_turn(first)} and of {_turn(second)} are interchanged."
    ),
    "another sequence": lambda question, sequence: (
        f"These are body fixed turns in the sequence `{sequence}`, which is another one than is asked for."
    ),
    "another axis": lambda question, turn, axis: (
        f"{_turn(turn).capitalize()} is about the ${axis}$ axis here. It should be about another one."
    ),
    "turn missing": lambda question, turn: f"{_turn(turn).capitalize()} is missing.",
    "one factor only": lambda question, turn: f"This is {_turn(turn)} alone; the others are missing.",
    "sine for cosine": lambda question, turn: f"Sine and cosine are interchanged in {_turn(turn)}.",
    "degrees taken for radians": lambda question: (
        "Degrees were given to functions that take radians. Convert them first: `sm.rad(30)` or `np.deg2rad(30)`."
    ),
    "in degrees": lambda question: "The answer is in degrees; angles are in radians here.",
    "in radians": lambda question: "The answer is in radians; degrees are asked for.",
    "sign of a symbol": lambda question, symbol: f"The answer would be right if `{symbol}` had the other sign.",
    "symbols interchanged": lambda question, first, second: f"`{first}` and `{second}` are interchanged.",
    "conjugate": lambda question: (
        "This is the conjugate, which turns the other way: its vector part has the wrong sign."
    ),
    "scalar last": lambda question: (
        "The scalar part stands last here. In this book it stands first: $(q_0, q_i, q_j, q_k)$."
    ),
    "scalar last, conjugate": lambda question: (
        "The scalar part stands last here, and the vector part has the wrong sign."
    ),
    "whole angle": lambda question: (
        "The whole angle is used. A quaternion holds the sine and cosine of *half* the angle."
    ),
    "quarter angle": lambda question: "The angle is halved twice.",
    "opposite": lambda question: "Every sign is wrong: this is the opposite of what is asked for.",
    "reciprocal": lambda question: "This is the reciprocal of what is asked for.",
    "half": lambda question: "This is half of what is asked for.",
    "double": lambda question: "This is twice what is asked for.",
    "supplement": lambda question: "This angle and the one asked for add up to half a turn.",
    "complement": lambda question: "This angle and the one asked for add up to a quarter turn.",
    "not turned": lambda question: (
        "These are the components along the frame that you started from. They are still to be turned."
    ),
    "turned the wrong way": lambda question: (
        "The components were multiplied by the transpose of the matrix that turns them."
    ),
    "angles of another sequence": lambda question, sequence: (
        f"These would be the angles in the sequence `{sequence}`; `{question['sequence']}` is asked for."
    ),
    "angles of the transpose": lambda question: "These are the angles of the transposed matrix.",
    "space fixed angles": lambda question: "These are the angles of space fixed turns; body fixed ones are asked for.",
    "angles in reverse": lambda question: "The three angles are right but in reverse order.",
    "sign of one angle": lambda question, turn: f"The {ORDINALS[turn]} angle has the wrong sign.",
    "sign of every angle": lambda question: "All angles have the wrong sign.",
    "axis reversed": lambda question: "The turn goes the wrong way round: the axis, or the angle, has the wrong sign.",
    "sequence reversed": lambda question: (
        "This sequence is the reverse of the right one: it counts the turns from the last to the first, as one "
        "would for turns about space fixed axes."
    ),
    "cosine for sine": lambda question: "Sine and cosine are interchanged.",
    "authored": lambda question, text: text,
}


# --- what each mistake does to an answer --------------------------------------------------------


def mistakes(question, answer, turns=(), turned=None):
    """Give every mistake of the catalogue that applies to an answer, as :class:`Mistake`.

    Parameters
    ----------
    question : dict
        The public part of the question.
    answer : SymPy object, nested list or number
        The right answer, as its author wrote it.
    turns : list of tuples (axis, angle)
        The successive turns, each about an axis of the frame that the turns before it have reached, of which
        the answer is the direction cosine matrix or the quaternion.
    turned : tuple (matrix, components)
        For components that a matrix turned: the matrix and what it was applied to.
    """
    find = CATALOGUE.get(question["kind"])
    return list(find(question, answer, list(turns), turned)) if find else []


def _sympy_matrix(answer):
    import sympy

    if hasattr(answer, "dcm"):
        raise TypeError(
            "A reference frame is the right answer here: bind its direction cosine matrix instead, so "
            "that mistakes can be made of it. A student may still answer with the frame."
        )
    return sympy.Matrix(answer)


def _substitutions(answer):
    """Mistakes that change a symbol for its negative, or two symbols for each other."""
    free = sorted(_unknowns(answer), key=str)
    for symbol in free:
        yield "sign of a symbol", {"symbol": _plain_name(symbol)}, {symbol: -symbol}
    for first, second in itertools.combinations(free, 2):
        yield (
            "symbols interchanged",
            {"first": _plain_name(first), "second": _plain_name(second)},
            {first: second, second: first},
        )


def _unknowns(answer):
    from sympy.core.function import AppliedUndef

    functions = answer.atoms(AppliedUndef)
    times = {argument for function in functions for argument in function.args}
    return functions | (answer.free_symbols - times)


def _plain_name(symbol):
    return getattr(symbol, "name", None) or symbol.func.__name__


def _replace(answer, changes):
    return answer.xreplace(changes)


def _generic(question, answer):
    for note, details, changes in _substitutions(answer):
        yield Mistake(note, details, _replace(answer, changes))


def product_of(turns, kind="direction cosine matrix"):
    """The direction cosine matrix, or the quaternion, of successive turns."""
    import sympy

    from orientation import dcm_from_axis_angle, multiply_quaternions, quaternion_from_axis_angle

    if kind == "quaternion":
        result = sympy.Matrix([1, 0, 0, 0])
        for axis, angle in turns:
            result = multiply_quaternions(result, quaternion_from_axis_angle(_components(axis), sympy.sympify(angle)))
        return result
    result = sympy.eye(3)
    for axis, angle in turns:
        result = dcm_from_axis_angle(_components(axis), sympy.sympify(angle)) * result
    return result


def _components(axis):
    import sympy

    if isinstance(axis, str):
        sign = -1 if axis.startswith("-") else 1
        return [sympy.Integer(sign * (letter == axis[-1])) for letter in "xyz"]
    return [sympy.sympify(part) for part in axis]


def _of_turns(kind, turns):
    """Mistakes in building an orientation from successive turns."""
    import sympy

    from orientation import SEQUENCES

    def build(changed):
        return product_of(changed, kind)

    def changed(*numbers):
        return [(axis, -angle if order in numbers else angle) for order, (axis, angle) in enumerate(turns)]

    count = len(turns)

    def named(turn):
        # A single turn is not called the first of its kind.
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
            yield Mistake("sign of two turns", {"first": first, "second": second}, build(changed(first, second)))
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
        if kind != "quaternion":
            yield Mistake("sine for cosine", {"turn": named(turn)}, build(other))
    if turns and not any(sympy.sympify(angle).free_symbols for _, angle in turns):
        yield Mistake(
            "degrees taken for radians", {}, build([(axis, sympy.deg(angle).evalf(20)) for axis, angle in turns])
        )


def _of_dcm(question, answer, turns, turned):
    answer = _sympy_matrix(answer)
    yield Mistake("transposed", {}, answer.T)
    yield from _of_turns("direction cosine matrix", turns)
    if len(turns) > 1:
        yield Mistake("other order, transposed", {}, product_of(turns[::-1]).T)
    if not turns:
        yield from _generic(question, answer)


def _of_matrix(question, answer, turns, turned):
    answer = _sympy_matrix(answer)
    if answer.rows == answer.cols:
        yield Mistake("transposed", {}, answer.T)
    yield Mistake("opposite", {}, -answer)
    yield from _generic(question, answer)


def _of_quaternion(question, answer, turns, turned):
    import sympy

    answer = _sympy_matrix(answer)
    scalar, i, j, k = answer
    yield Mistake("conjugate", {}, sympy.Matrix([scalar, -i, -j, -k]))
    yield Mistake("scalar last", {}, sympy.Matrix([i, j, k, scalar]))
    yield Mistake("scalar last, conjugate", {}, sympy.Matrix([-i, -j, -k, scalar]))
    if len(turns) == 1:
        axis, angle = turns[0]
        yield Mistake("whole angle", {}, product_of([(axis, 2 * angle)], "quaternion"))
        yield Mistake("quarter angle", {}, product_of([(axis, sympy.sympify(angle) / 2)], "quaternion"))
        cosine, sine = scalar, sympy.sin(sympy.sympify(angle) / 2)
        direction = sympy.Matrix(_components(axis))
        direction = direction / sympy.sqrt(direction.dot(direction))
        yield Mistake("cosine for sine", {}, sympy.Matrix([sine, *(cosine * direction)]))
    yield from _of_turns("quaternion", turns)
    if not turns:
        yield from _generic(question, answer)


def _of_vector(question, answer, turns, turned):
    import sympy

    if hasattr(answer, "to_matrix"):
        return  # a SymPy vector: its author has written its components in `turned`, or names mistakes
    answer = _sympy_matrix(answer)
    yield Mistake("opposite", {}, -answer)
    if turned:
        matrix, components = (sympy.Matrix(part) for part in turned)
        yield Mistake("turned the wrong way", {}, matrix.T * components)
        yield Mistake("not turned", {}, components)
    yield from _generic(question, answer)


def _of_expression(question, answer, turns, turned):
    import sympy

    answer = sympy.sympify(answer)
    yield Mistake("opposite", {}, -answer)
    if question.get("quantity") == "angle":
        yield Mistake("in degrees", {}, answer * 180 / sympy.pi)
        yield Mistake("supplement", {}, sympy.pi - answer)
        yield Mistake("complement", {}, sympy.pi / 2 - answer)
    elif question.get("quantity") == "angle in degrees":
        yield Mistake("in radians", {}, answer * sympy.pi / 180)
        yield Mistake("supplement", {}, 180 - answer)
        yield Mistake("complement", {}, 90 - answer)
    elif answer != 0:
        yield Mistake("reciprocal", {}, 1 / answer)
    yield Mistake("half", {}, answer / 2)
    yield Mistake("double", {}, 2 * answer)
    yield from _generic(question, answer)


def _of_angles(question, answer, turns, turned):
    from orientation import SEQUENCES, body_fixed_from_dcm, dcm_from_body_fixed, space_fixed_from_dcm

    angles = [float(angle) for angle in answer]
    dcm = dcm_from_body_fixed(angles, question["sequence"])
    for turn in range(3):
        yield Mistake(
            "sign of one angle",
            {"turn": turn},
            [-angle if order == turn else angle for order, angle in enumerate(angles)],
        )
    yield Mistake("sign of every angle", {}, [-angle for angle in angles])
    yield Mistake("angles in reverse", {}, angles[::-1])
    yield Mistake("angles of the transpose", {}, list(body_fixed_from_dcm(dcm.T, question["sequence"])))
    yield Mistake("in degrees", {}, [math.degrees(angle) for angle in angles])
    yield Mistake("space fixed angles", {}, list(space_fixed_from_dcm(dcm, question["sequence"])))
    for sequence in SEQUENCES:
        if sequence != question["sequence"]:
            yield Mistake(
                "angles of another sequence", {"sequence": sequence}, list(body_fixed_from_dcm(dcm, sequence))
            )


def _of_axis_and_angle(question, answer, turns, turned):
    axis, angle = answer
    axis = list(axis)
    import sympy

    angle = sympy.sympify(angle)
    yield Mistake("axis reversed", {}, [axis, -angle])
    yield Mistake("in degrees", {}, [axis, angle * 180 / sympy.pi])
    yield Mistake("half", {}, [axis, angle / 2])
    yield Mistake("double", {}, [axis, 2 * angle])


def _of_sequence(question, answer, turns, turned):
    if answer != answer[::-1]:
        yield Mistake("sequence reversed", {}, answer[::-1])


CATALOGUE = {
    "direction cosine matrix": _of_dcm,
    "matrix": _of_matrix,
    "quaternion": _of_quaternion,
    "vector": _of_vector,
    "expression": _of_expression,
    "Euler angles": _of_angles,
    "axis and angle": _of_axis_and_angle,
    "sequence": _of_sequence,
}
