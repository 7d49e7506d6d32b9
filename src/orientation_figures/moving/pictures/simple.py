"""The still of a simple orientation."""

import math

import numpy as np

from ...drawing import Drawing

REACH, SIZE = 1.25, 112
# As in js/simple.js: along the pointer and up.
VANE = (
    (-0.72, 0.5), (-0.5, 0.36), (0.4, 0.36), (0.4, 0.46), (0.68, 0.3),
    (0.4, 0.14), (0.4, 0.24), (-0.5, 0.24), (-0.72, 0.1), (-0.62, 0.3),
)  # fmt: skip


def drawing(figure):
    k = "xyz".index(figure.axis)
    rows = [
        f"a {name} at ({', '.join(f'{entry:.2f}' for entry in row + 0.0)})"
        for name, row in zip("xyz", figure.dcm, strict=True)
    ]
    drawing = Drawing(
        f"The triads of the frames N and A from one origin, and a weather vane that belongs to A. The frames share "
        f"{figure.axis}, and A is turned about it through theta, {math.degrees(figure.angle):.0f} degrees. Along N, "
        f"{', '.join(rows)}.",
        scale=SIZE,
    )
    axis, pointer = np.eye(3)[k], figure.dcm[(k + 1) % 3]
    drawing.area([along * pointer + up * axis for along, up in VANE], "A", 26)
    drawing.triad("N", REACH * np.eye(3))
    for m in ((k + 1) % 3, (k + 2) % 3):
        drawing.arrow(figure.dcm[m], colour="A", label=rf"$\hat{{a}}_{'xyz'[m]}$")
        drawing.turn(axis, figure.angle, np.eye(3)[m], 0.5, r"$\theta$", colour="accent")
    return drawing.arrow(axis, colour="A")
