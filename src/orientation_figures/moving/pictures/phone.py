"""The still of a phone above the ground."""

import math

import numpy as np

from ...drawing import Drawing

BODY = (0.62, 1.24, 0.1)  # as in js/phone.js
SCREEN = (0.27, 0.54)
REACH, SIZE = 1.3, 112


def drawing(figure):
    alpha, beta, gamma = (f"{math.degrees(angle):.0f}" for angle in figure.angles)
    rows = [f"{name} at ({', '.join(f'{entry + 0:.2f}' for entry in row)})" for name, row in zip("xyz", figure.dcm)]
    drawing = Drawing(
        "A phone, frame B, and the triad of the ground N: n x east, n y north, n z up. The phone is turned by "
        f"alpha {alpha}, beta {beta} and gamma {gamma} degrees, body fixed z-x-y. Along N, b {', b '.join(rows)}. "
        "b x points to the right across the screen, b y to its top, b z out of it.",
        scale=SIZE,
    )
    drawing.triad("N", REACH * np.eye(3))
    drawing.box(figure.dcm, BODY, (0, 0, 0), "B")
    across, along, out = figure.dcm
    if out @ drawing.view[2] > 0:
        corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
        front = BODY[2] / 2 * out
        drawing.area([front + x * SCREEN[0] * across + y * SCREEN[1] * along for x, y in corners], "ink", 8)
    return drawing.triad("B", figure.dcm)
