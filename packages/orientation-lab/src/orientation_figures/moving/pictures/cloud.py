"""The picture of a cloud of orientations: the tips of two of their unit vectors on a sphere."""

import math

from orientation.direction_cosines import simple_dcm
from orientation.rotation_vector import dcm_from_rotation_vector

from ...vectors import IDENTITY, add, in_degrees, multiply, scale

COUNT = 200
SIZE = 112
#: Irrational steps spread numbers evenly between 0 and 1.
STEPS = (0.6180339887498949, 0.7548776662466927, 0.5698402909980532)
ESTIMATE = multiply(simple_dcm("x", 0.5), multiply(simple_dcm("y", -0.5), simple_dcm("z", 0.9)))


def between(k, step):
    return (k * step + 0.5 / COUNT) % 1


def normals(k):
    """Return three standard normal numbers, the same in every language (Box and Muller)."""
    first = math.sqrt(-2 * math.log((k + 0.5) / COUNT))
    second = math.sqrt(-2 * math.log(1 - between(k, STEPS[1])))
    turn = 2 * math.pi * between(k, STEPS[0])
    return [
        first * math.cos(turn),
        first * math.sin(turn),
        second * math.cos(2 * math.pi * between(k, STEPS[2])),
    ]


def orientations(large, small, body):
    """Return direction cosine matrices with errors about z of the ground, or of the body."""
    errors = [
        dcm_from_rotation_vector([small * x, small * y, large * z])
        for x, y, z in [normals(k) for k in range(COUNT)]
    ]
    return [multiply(error, ESTIMATE) if body else multiply(ESTIMATE, error) for error in errors]


def tips_mean(dcms, row):
    total = [0, 0, 0]
    for dcm in dcms:
        total = add(total, dcm[row])
    return scale(1 / COUNT, total)


def picture(sheet, large, small, body):
    dcms = orientations(large, small, body)
    sheet.circle(sheet.view[2], colour="muted", kind="faint")
    sheet.circle([0, 0, 1], half="front", colour="muted", kind="faint")
    sheet.circle([0, 0, 1], half="back", colour="muted", kind="guide faint")
    sheet.triad("N", IDENTITY, length=1.25)
    for row, colour in ((0, "B"), (2, "D")):
        sheet.dots([dcm[row] for dcm in dcms], colour)
    sheet.layer = 1
    sheet.arrow(ESTIMATE[0], colour="B", label=r"$\hat{b}_x$")
    sheet.arrow(ESTIMATE[2], colour="D", label=r"$\hat{b}_z$")


def drawing(figure, Sheet):
    frame = "z of the body" if figure.side == "body" else "z of the ground, up"
    sheet = Sheet(
        f"A sphere with the tips of the unit vectors b x and b z of {COUNT} orientations. Their "
        f"errors are {in_degrees(figure.large)} about {frame}, and "
        f"{in_degrees(figure.small)} about each axis perpendicular to it (standard "
        "deviations). The tips lie along arcs about this axis and form curved clouds. The mean of "
        f"the vectors b x has length {figure.mean_length:.2f}, inside the sphere. The arrows "
        "b x and b z show the estimate, and the triad N the ground.",
        scale=SIZE,
    )
    return sheet.paint(picture, figure.large, figure.small, figure.side == "body")
