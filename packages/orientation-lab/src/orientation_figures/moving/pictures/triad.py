"""The picture of a triad rotated in a frame about an axis."""

from ...vectors import IDENTITY, in_degrees, scale
from .common import around

# The length of the arrows of N.
REACH = 1.25
# The end of the line of the axis, clear of the labels of A.
KNOB = 1.55
SIZE = 112


def picture(sheet, axis, angle, dcm):
    knob = scale(KNOB, axis)
    sheet.line([scale(-1, axis), knob], "accent", "guide")
    for start in IDENTITY:
        around(sheet, axis, angle, start)
    sheet.triad("N", IDENTITY, length=REACH)
    sheet.triad("A", dcm)
    sheet.arrow(axis, colour="accent")
    sheet.dot(knob, "accent", 5)
    sheet.label(knob, r"$\hat{e}$", "accent", [15, -9])


def drawing(figure, Sheet):
    rows = [
        f"{name} at ({', '.join(f'{entry:.2f}' for entry in row)})"
        for name, row in zip("xyz", figure.dcm)
    ]
    sheet = Sheet(
        "The triad of frame N, and from the same origin the triad of A, turned from N through "
        f"theta, {in_degrees(figure.angle)}, about the unit vector e, which has the "
        f"components ({', '.join(f'{entry:.2f}' for entry in figure.axis)}) in both frames. "
        f"Along N, a {', a '.join(rows)}. "
        "Thin arcs show the path of each tip about e.",
        scale=SIZE,
    )
    return sheet.paint(picture, figure.axis, figure.angle, figure.dcm)
