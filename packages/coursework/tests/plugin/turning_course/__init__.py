"""A plug-in for the tests, like that of a course about rotations, with one kind of question."""

from coursework.checking.kinds import TRANSPOSED, Fault, row_entries, slack, word
from coursework.checking.mistakes import Mistake
from coursework.checking.plugins import Kind


def rotation_matrix(turns):
    """Return the matrix of successive rotations, whose rows are the new coordinate axes."""
    import sympy

    result = sympy.eye(3)
    for axis, angle in turns:
        other, last = (("xyz".index(axis) + number) % 3 for number in (1, 2))
        turn = sympy.eye(3)
        turn[other, other] = turn[last, last] = sympy.cos(angle)
        turn[other, last], turn[last, other] = sympy.sin(angle), -sympy.sin(angle)
        result = turn * result
    return result


def mistakes(question, answer, turns, turned):
    """Iterate over the typical mistakes in the right answer."""
    yield Mistake("transposed", {}, answer.T)
    if turns and len(turns) == 1:
        ((axis, angle),) = turns
        yield Mistake(
            "sine and cosine exchanged", {"axis": axis}, rotation_matrix([(axis, 90 - angle)])
        )


def fault(question, numbers):
    """Return the fault of a matrix whose rows are not perpendicular unit vectors."""
    rows = [numbers[0:3], numbers[3:6], numbers[6:9]]
    products = [
        sum(a * b for a, b in zip(rows[i], rows[j])) - (i == j)
        for i in range(3)
        for j in range(i, 3)
    ]
    if max(map(abs, products)) > slack(question):
        return Fault(
            "not orthogonal",
            "This is no rotation matrix: its rows are no perpendicular unit vectors.",
        )
    return None


def another(question, answer):
    return rotation_matrix([("x", 1)]) * answer


KINDS = {
    "sense": Kind(text=lambda question, plain: word(plain, "A word, in quotation marks").lower()),
    "rotation matrix": Kind(
        begin="Draw both triads for a small angle and read off one row.",
        entries=lambda question, value: row_entries(value, 3, 3, "A matrix of size 3 × 3"),
        fault=fault,
        wrong="This is a rotation matrix, but not the right one.",
        needs=("frames",),
        mistakes=mistakes,
        messages={
            "sine and cosine exchanged": lambda question, axis: (
                f"Sine and cosine are interchanged in the turn about {axis}."
            )
        },
        details={"axis": "xyz"},
        slips=TRANSPOSED,
        build=rotation_matrix,
        another=another,
    ),
}
DEEDS = {"sine and cosine exchanged": "interchanged sine and cosine in the turn about {axis}"}
