"""The still of a simple orientation."""

import math

import numpy as np

from ...drawing import Drawing

REACH, SIZE = 1.25, 112


def drawing(figure):
    k = "xyz".index(figure.axis)
    rows = [
        f"a {name} at ({', '.join(f'{entry:.2f}' for entry in row + 0.0)})"
        for name, row in zip("xyz", figure.dcm, strict=True)
    ]
    drawing = Drawing(
        f"The triads of the frames N and A from one origin. They share {figure.axis}, and A is turned about it "
        f"through theta, {math.degrees(figure.angle):.0f} degrees. Along N, {', '.join(rows)}.",
        scale=SIZE,
    )
    axis = np.eye(3)[k]
    drawing.triad("N", REACH * np.eye(3))
    for m in ((k + 1) % 3, (k + 2) % 3):
        drawing.arrow(figure.dcm[m], colour="A", label=rf"$\hat{{a}}_{'xyz'[m]}$")
        drawing.turn(axis, figure.angle, np.eye(3)[m], 0.5, r"$\theta$", colour="accent")
    return drawing.arrow(axis, colour="A")
