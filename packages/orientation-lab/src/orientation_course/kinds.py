"""The kinds of questions on orientation: how to read an answer, and when two answers are equal.

A quaternion and its negative, or the many Euler angles of one orientation, are first converted to
something unique.
"""

import unicodedata
from collections.abc import Sequence
from functools import partial
from typing import cast

from coursework.checking.evaluate import MP
from coursework.checking.kinds import (
    FUNCTIONS,
    TRANSPOSED,
    Fault,
    Number,
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
from coursework.checking.plain import Plain, Value, by_frame, parts_of, text_of
from coursework.checking.plugins import Kind
from coursework.checking.question import Question
from orientation.axis_angle import axis_angle_formula
from orientation.euler_angles import body_fixed_formula
from orientation.quaternions import dcm_from_quaternion

from . import forms, mistakes


def _dcm(question: Question, value: Value) -> list[int]:
    # A matrix returned by a function has no frames of its own.
    target, source = question.frames or ("", "")
    if value[0] == "frames":
        frames = cast("dict[str, dict[str, Value]]", value[1])
        if source not in frames.get(target, {}):
            raise Fault(
                "frame",
                f"These are the frames {listed(frames)}. Give the orientation of `{target}` with "
                f"respect to `{source}`: no path connects two frames with these names.",
            )
        value = frames[target][source]
    if value[0] == "frame":
        name, others = text_of(value), by_frame(value)
        if target != name or source not in others:
            connected = [other for other in others if other != name]
            raise Fault(
                "frame",
                f"This is the frame `{name}`, connected to {listed(connected) or 'no other'}. "
                f"Give the orientation of `{target}` with respect to `{source}`.",
            )
        value = others[source]
    rows = parts_of(value) if value[0] == "list" else []
    if rows and all(row[0] == "vector" for row in rows):
        # The rows as unit vectors: take their components along the source frame.
        if not all(source in by_frame(row) for row in rows):
            raise Fault(
                "frame",
                f"These vectors are not connected to the frame `{source}` of the question.",
            )
        value = ["list", [by_frame(row)[source] for row in rows]]
    return row_entries(value, 3, 3, "A matrix of size 3 × 3")


def _axis_and_angle(question: Question, value: Value) -> list[int]:
    wanted = "An axis with three components and an angle, `(axis, angle)`"
    if value[0] != "list" or len(parts_of(value)) != 2:
        raise shape_fault(wanted, value)
    first, second = parts_of(value)
    if first[0] == "expression":
        first, second = second, first
    if first[0] == "vector":
        first = next(iter(by_frame(first).values()), ["list", []])
    return [*components(first, 3, wanted), leaf(second, wanted)]


def _sequence(question: Question, plain: Plain) -> str:
    given = word(plain, "A sequence of three axes, such as `'xyz'`").lower()
    # Full-width letters are letters, and many books number the axes.
    text = "".join(letter for letter in unicodedata.normalize("NFKC", given) if letter.isalnum())
    text = text.translate(str.maketrans("123", "xyz"))
    if len(text) != 3 or set(text) - set("xyz"):
        raise Fault(
            "shape",
            "A sequence consists of three letters x, y or z, such as `'xyz'`. This is "
            f"`{text[:20]}`.",
        )
    if text[0] == text[1] or text[1] == text[2]:
        raise Fault(
            "impossible sequence",
            f"`{text}` rotates about one axis twice in a row, which is a single rotation. It is "
            "not one of the 12 sequences.",
        )
    return text


def _of_angles(question: Question, numbers: Sequence[Number]) -> Sequence[Number]:
    return body_fixed_formula(str(question.arguments["sequence"]))(FUNCTIONS, *numbers)


def _of_axis_and_angle(question: Question, numbers: Sequence[Number]) -> Sequence[Number]:
    if not any(numbers[:3]):
        raise Fault("zero axis", "The axis is zero, and a zero vector has no direction.")
    return axis_angle_formula(FUNCTIONS, *numbers)


def _dcm_fault(question: Question, numbers: Sequence[Number]) -> Fault | None:
    rows = [numbers[0:3], numbers[3:6], numbers[6:9]]
    worst = max(
        ((abs(MP.fdot(rows[i], rows[j]) - (i == j)), i, j) for i in range(3) for j in range(i, 3)),
        key=lambda deviation: deviation[0],
    )
    size, i, j = worst
    where = " at the values tried" if question.symbols else ""
    if size > slack(question):
        names = ("first", "second", "third")
        if i == j:
            length = MP.sqrt(MP.fdot(rows[i], rows[i]))
            said = (
                f"the {names[i]} row should be a unit vector but has length "
                f"{length_in_words(length)}{where}"
            )
        else:
            said = (
                f"the {names[i]} and the {names[j]} row should be perpendicular, but their dot "
                f"product is {short(MP.fdot(rows[i], rows[j]))}{where}"
            )
        return Fault("not orthogonal", f"This is not a direction cosine matrix: {said}.")
    if MP.det(MP.matrix(rows)) < 0:
        return Fault(
            "left-handed",
            "The rows are perpendicular unit vectors, but their determinant is −1: they make a "
            "left-handed triad. Did you reverse one row, or one sign too many?",
        )
    return None


def _quaternion_fault(question: Question, numbers: Sequence[Number]) -> Fault | None:
    length = FUNCTIONS.norm(*numbers)
    if abs(length - 1) > slack(question):
        where = " at the values tried" if question.symbols else ""
        return Fault(
            "not unit length",
            "The quaternion of an orientation has length 1. Yours has length "
            f"{length_in_words(length)}{where}.",
        )
    return None


def _angles_fault(question: Question, numbers: Sequence[Number]) -> Fault | None:
    largest = max(numbers, key=abs)
    if abs(largest) > 2 * MP.pi + MP.mpf("0.01"):
        return Fault(
            "degrees",
            f"One of the angles is {short(largest)}, which is more than a full turn of $2\\pi$ "
            "rad. Is it in degrees? Give angles in radians.",
        )
    return None


def _axis_fault(question: Question, numbers: Sequence[Number]) -> Fault | None:
    length = FUNCTIONS.norm(*numbers[:3])
    if abs(length - 1) > slack(question) / 3 and question.arguments.get("unit axis", True):
        return Fault(
            "not unit length",
            f"The axis should be a unit vector. Yours has length {length_in_words(length)}.",
        )
    return _angles_fault(question, numbers[3:])


def _triads(question: Question, entries: Sequence[Number]) -> str:
    """Return the triad of an orientation in that of the source frame, as HTML."""
    # Drawing needs NumPy, so import it only for a picture.
    from orientation_figures.drawing import Drawing
    from orientation_figures.vectors import IDENTITY
    from orientation_figures.words import hatted

    rows = [[float(entry) for entry in entries[start : start + 3]] for start in (0, 3, 6)]
    target, source = question.frames or ("A", "N")
    drawing = Drawing(
        f"The triad of {target}, as we read your answer, drawn in the triad of {source}.", scale=70
    )
    # The longer triad shows where the two coincide.
    drawing.triad("N", IDENTITY, length=1.7, labels=hatted(source.lower()))
    drawing.triad("A", rows, labels=hatted(target.lower()))
    return str(drawing._repr_html_())


#: What all these kinds share: the messages of one catalogue.
_kind = partial(Kind, messages=mistakes.MESSAGES, details=mistakes.DETAILS)
KINDS = {
    "direction cosine matrix": _kind(
        entries=_dcm,
        picture=_triads,
        fault=_dcm_fault,
        wrong="This is a direction cosine matrix, but not the right one.",
        needs=("frames",),
        mistakes=mistakes.of_dcm,
        slips=TRANSPOSED,
        build=mistakes.dcm_of,
        forms=forms.of_dcm,
        another=forms.another_dcm,
    ),
    "quaternion": _kind(
        entries=lambda question, value: components(
            value, 4, "A list of four numbers, the scalar first"
        ),
        picture=lambda question, numbers: _triads(
            question, dcm_from_quaternion([float(number) for number in numbers]).ravel().tolist()
        ),
        unique=one_sign,
        fault=_quaternion_fault,
        wrong="This is a quaternion of unit length, but not the right one.",
        either_sign=True,
        mistakes=mistakes.of_quaternion,
        slips={
            "conjugate": (
                "it is the conjugate, and it has another mistake.",
                lambda question, numbers: [numbers[0], *(-number for number in numbers[1:])],
            )
        },
        build=mistakes.quaternion_of,
        another=forms.another_quaternion,
    ),
    "Euler angles": _kind(
        entries=lambda question, value: components(value, 3, "A list of three angles"),
        picture=lambda question, numbers: _triads(question, _of_angles(question, numbers)),
        unique=_of_angles,
        fault=_angles_fault,
        # Each entry of the matrix depends on all three angles, and so on all their errors.
        parts=3,
        wrong="These angles give a different orientation.",
        needs=("sequence",),
        arguments=("sequence",),
        mistakes=mistakes.of_angles,
    ),
    "axis and angle": _kind(
        entries=_axis_and_angle,
        picture=lambda question, numbers: _triads(question, _of_axis_and_angle(question, numbers)),
        unique=_of_axis_and_angle,
        fault=_axis_fault,
        parts=3,
        wrong="This axis and angle give a different orientation.",
        mistakes=mistakes.of_axis_and_angle,
    ),
    "sequence": _kind(
        text=_sequence,
        mistakes=mistakes.of_sequence,
        forms=forms.of_sequence,
        another=forms.another_sequence,
    ),
}
