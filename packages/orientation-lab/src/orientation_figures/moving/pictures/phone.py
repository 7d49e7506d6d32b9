"""The picture of a phone above the ground."""

import math

from ...vectors import IDENTITY, add, dot, scale

BODY = (0.62, 1.24, 0.1)
SCREEN = (0.27, 0.54)
REACH = 1.3
SIZE = 112


def picture(sheet, dcm):
    sheet.triad("N", IDENTITY, length=REACH)
    sheet.box(dcm, BODY, colour="B")
    across, along, out = dcm
    if dot(out, sheet.view[2]) > 0:
        front = scale(BODY[2] / 2 + 1e-3, out)
        corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]]
        places = [
            add(front, scale(x * SCREEN[0], across), scale(y * SCREEN[1], along))
            for x, y in corners
        ]
        sheet.area(places, "ink", 8)
    sheet.triad("B", dcm)


def drawing(figure, Sheet):
    alpha, beta, gamma = (f"{math.degrees(angle):.0f}" for angle in figure.angles)
    rows = [
        f"{name} at ({', '.join(f'{entry + 0:.2f}' for entry in row)})"
        for name, row in zip("xyz", figure.dcm)
    ]
    sheet = Sheet(
        "A phone, frame B, and the triad of the ground N: n x east, n y north, n z up. "
        f"The phone is turned by alpha {alpha}, beta {beta} and gamma {gamma} degrees, body fixed "
        "z-x-y. "
        f"Along N, b {', b '.join(rows)}. "
        "b x points to the right across the screen, b y to its top, and b z out of it.",
        scale=SIZE,
    )
    return sheet.paint(picture, figure.dcm)
