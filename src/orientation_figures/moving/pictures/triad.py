"""The still of a triad turned in a frame about an axis."""

import math

import numpy as np

from ...drawing import Drawing

REACH, KNOB = 1.25, 1.55  # of the arrows of N and of the line of the axis: labels keep clear of those of A
SIZE = 112


def drawing(figure):
    rows = [f"{name} at ({', '.join(f'{entry:.2f}' for entry in row)})" for name, row in zip("xyz", figure.dcm)]
    axis = np.array(figure.axis)
    drawing = Drawing(
        f"The triad of frame N, and from the same origin the triad of A: turned from N through theta, "
        f"{math.degrees(figure.angle):.0f} degrees, about the unit vector e, which has the components "
        f"({', '.join(f'{entry:.2f}' for entry in axis)}) in both frames. Along N, a "
        f"{', a '.join(rows)}. Thin arcs show the way of each tip, all about e.",
        scale=SIZE,
    )
    drawing.line([-axis, KNOB * axis], "accent", "guide")
    for start in np.eye(3):
        foot = start @ axis * axis
        if (radius := np.linalg.norm(start - foot)) > 1e-6:
            drawing.turn(axis, figure.angle, start - foot, radius, origin=foot, colour="muted", head=False)
    drawing.triad("N", REACH * np.eye(3)).triad("A", figure.dcm)
    drawing.arrow(axis, colour="accent").dot(KNOB * axis, "accent", 5)
    return drawing.label(KNOB * axis, r"$\hat{e}$", "accent", (15, -9))
