"""The kinds of questions that are about orientation: how an answer is
read, and what makes two answers one.

A quaternion and its negative, or the many Euler angles of one orientation, are first turned into
something that there is one of.
"""

import unicodedata

from coursework.checking.evaluate import MP
from coursework.checking.kinds import (
    FUNCTIONS,
    TRANSPOSED,
    Fault,
    components,
    leaf,
    length_in_words,
    listed,
    one_sign,
    row_entries,
    shape_fault,
    short,
    slack,
    word,
)
from coursework.checking.plugins import Kind
from orientation.axis_angle import axis_angle_formula
from orientation.euler_angles import body_fixed_formula

from . import forms, mistakes


def _dcm(question, value):
    if value[0] == "frames":
        target, source = question.frames
        if target not in value[1] or source not in value[1][target]:
            raise Fault(
                "frame",
                f"These are the frames {listed(value[1])}; the question asks for the orientation "
                f"of `{target}` with respect to `{source}`, and there is no path between two of "
                "these names.",
            )
        value = value[1][target][source]
    if value[0] == "frame":
        target, source = question.frames
        name, others = value[1], value[2]
        if target != name or source not in others:
            connected = [other for other in others if other != name]
            raise Fault(
                "frame",
                f"This is the frame `{name}`, connected with {listed(connected) or 'no other'}; "
                f"the question asks for the orientation of `{target}` with respect to `{source}`.",
            )
        value = others[source]
    if value[0] == "list" and value[1] and all(row[0] == "vector" for row in value[1]):
        # Its rows as the unit vectors themselves: their components are along the source frame.
        source = question.frames[1]
        if not all(source in row[1] for row in value[1]):
            raise Fault(
                "frame",
                f"These vectors are not connected with the frame `{source}` that the question "
                "names.",
            )
        value = ["list", [row[1][source] for row in value[1]]]
    return row_entries(value, 3, 3, "A matrix of 3 × 3")


def _quaternion(question, value):
    return components(value, 4, "A list of four numbers, the scalar first")


def _angles(question, value):
    return components(value, 3, "A list of three angles")


def _axis_and_angle(question, value):
    wanted = "An axis with three components and an angle, `(axis, angle)`"
    if value[0] != "list" or len(value[1]) != 2:
        raise shape_fault(wanted, value)
    first, second = value[1]
    if first[0] == "expression":
        first, second = second, first
    if first[0] == "vector":
        first = next(iter(first[1].values()), ["list", []])
    return [*components(first, 3, wanted), leaf(second, wanted)]


def _sequence(question, plain):
    given = word(plain, "A sequence of three axes, such as `'xyz'`").lower()
    # Wide letters are letters; and in many a book the axes are numbers.
    text = "".join(letter for letter in unicodedata.normalize("NFKC", given) if letter.isalnum())
    text = text.translate(str.maketrans("123", "xyz"))
    if len(text) != 3 or set(text) - set("xyz"):
        raise Fault(
            "shape",
            "A sequence is three of the letters x, y and z, such as `'xyz'`; this is "
            f"`{text[:20]}`.",
        )
    if text[0] == text[1] or text[1] == text[2]:
        raise Fault(
            "impossible sequence",
            f"`{text}` has two turns in a row about one axis, which are one turn: it is none of "
            "the 12 sets.",
        )
    return text


def _of_angles(question, numbers):
    return body_fixed_formula(question.arguments["sequence"])(FUNCTIONS, *numbers)


def _of_axis_and_angle(question, numbers):
    if not any(numbers[:3]):
        raise Fault("zero axis", "The axis is zero, and a zero vector points nowhere.")
    return axis_angle_formula(FUNCTIONS, *numbers)


def _dcm_fault(question, numbers):
    rows = [numbers[0:3], numbers[3:6], numbers[6:9]]
    worst = max(
        ((abs(_dot(rows[i], rows[j]) - (i == j)), i, j) for i in range(3) for j in range(i, 3)),
        key=lambda found: found[0],
    )
    size, i, j = worst
    where = " at the values tried" if question.symbols else ""
    if size > slack(question):
        names = ("first", "second", "third")
        if i == j:
            length = MP.sqrt(_dot(rows[i], rows[i]))
            said = (
                f"the {names[i]} row should be a unit vector and has length "
                f"{length_in_words(length)}{where}"
            )
        else:
            said = (
                f"the {names[i]} and the {names[j]} row should be perpendicular, and their dot "
                f"product is {short(_dot(rows[i], rows[j]))}{where}"
            )
        return Fault("not orthogonal", f"This is no direction cosine matrix: {said}.")
    if _determinant(rows) < 0:
        return Fault(
            "left-handed",
            "The rows are perpendicular unit vectors, but their determinant is −1: they make a "
            "left-handed triad. "
            "Has one row, or one sign too many, been turned round?",
        )
    return None


def _quaternion_fault(question, numbers):
    length = FUNCTIONS.norm(*numbers)
    if abs(length - 1) > slack(question):
        where = " at the values tried" if question.symbols else ""
        return Fault(
            "not unit length",
            "The quaternion of an orientation has length 1; this one has length "
            f"{length_in_words(length)}{where}.",
        )
    return None


def _angles_fault(question, numbers):
    largest = max(numbers, key=abs)
    if abs(largest) > 2 * MP.pi + MP.mpf("0.01"):
        return Fault(
            "degrees",
            f"One of the angles is {short(largest)}, which is more than a full turn of $2\\pi$ "
            "rad. "
            "Is it in degrees? "
            "Angles are in radians here.",
        )
    return None


def _axis_fault(question, numbers):
    length = FUNCTIONS.norm(*numbers[:3])
    if abs(length - 1) > slack(question) / 3 and question.arguments.get("unit axis", True):
        return Fault(
            "not unit length",
            f"The axis should be a unit vector; this one has length {length_in_words(length)}.",
        )
    return _angles_fault(question, numbers[3:])


def _conjugate(question, numbers):
    scalar, *rest = numbers
    return [scalar, *(-number for number in rest)]


def _dot(first, second):
    return sum(a * b for a, b in zip(first, second))


def _determinant(rows):
    (a, b, c), (d, e, f), (g, h, i) = rows
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


#: Where to begin with each kind of question.
BEGIN = {
    "direction cosine matrix": "Write down what one row is: the components of one unit vector of "
    "the first frame along those of the second. "
    "Draw the two triads for a small angle and read off one row.",
    "quaternion": "What is the axis, as a unit vector, and what is the angle? Half of it goes into "
    "sine and cosine.",
    "Euler angles": "Which turn comes first, and about which axis? "
    "Compare the matrix of the three turns with the one that is given, and begin "
    "with its simplest entry.",
    "axis and angle": "Which vector does the turn leave as it is? "
    "It is the axis; the trace gives the angle.",
    "sequence": "Which axis do the first two frames share? And which one the next two?",
}
KINDS = {
    "direction cosine matrix": Kind(
        begin=BEGIN["direction cosine matrix"],
        entries=_dcm,
        fault=_dcm_fault,
        wrong="This is a direction cosine matrix, but not the right one.",
        needs=("frames",),
        mistakes=mistakes.of_dcm,
        messages=mistakes.MESSAGES,
        details=mistakes.DETAILS,
        slips=TRANSPOSED,
        build=mistakes.dcm_of,
        forms=forms.of_dcm,
        another=forms.another_dcm,
    ),
    "quaternion": Kind(
        begin=BEGIN["quaternion"],
        entries=_quaternion,
        unique=one_sign,
        fault=_quaternion_fault,
        wrong="This is a quaternion of unit length, but not the right one.",
        either_sign=True,
        mistakes=mistakes.of_quaternion,
        messages=mistakes.MESSAGES,
        details=mistakes.DETAILS,
        slips={
            "conjugate": ("it is the conjugate, and its conjugate has another mistake.", _conjugate)
        },
        build=mistakes.quaternion_of,
        another=forms.another_quaternion,
    ),
    "Euler angles": Kind(
        begin=BEGIN["Euler angles"],
        entries=_angles,
        unique=_of_angles,
        fault=_angles_fault,
        # An entry of the matrix is built of three angles, and off by what all three are.
        parts=3,
        wrong="These angles give a different orientation.",
        needs=("sequence",),
        arguments=("sequence",),
        mistakes=mistakes.of_angles,
        messages=mistakes.MESSAGES,
        details=mistakes.DETAILS,
    ),
    "axis and angle": Kind(
        begin=BEGIN["axis and angle"],
        entries=_axis_and_angle,
        unique=_of_axis_and_angle,
        fault=_axis_fault,
        parts=3,
        wrong="This axis and angle give a different orientation.",
        mistakes=mistakes.of_axis_and_angle,
        messages=mistakes.MESSAGES,
        details=mistakes.DETAILS,
    ),
    "sequence": Kind(
        begin=BEGIN["sequence"],
        text=_sequence,
        mistakes=mistakes.of_sequence,
        messages=mistakes.MESSAGES,
        details=mistakes.DETAILS,
        forms=forms.of_sequence,
        another=forms.another_sequence,
    ),
}
