"""The still of a triad and its mirror image."""

import numpy as np

from ...drawing import Drawing, hatted

REACH, SIZE, APART = 1.0, 76, 1.3  # as in js/hands.js


def drawing(figure):
    rows = [f"m {name} at ({', '.join(f'{entry:.2f}' for entry in row)})" for name, row in zip("xyz", figure.rows)]
    image = "its mirror image" if figure.image == "mirror" else "a copy of it"
    where = "over" if figure.together else "beside"
    drawing = Drawing(
        f"The right-handed triad of N, and {where} it {image}, with the arrows m x, m y and m z. "
        f"Along N they are {', '.join(rows).replace('-0.00', '0.00')}.",
        scale=SIZE,
    )
    right = drawing.view[0]
    left, place = (0 * right, 0 * right) if figure.together else (-APART * right, APART * right)
    drawing.triad("N", REACH * np.eye(3), left)
    if not figure.together:
        up = drawing.view[1]
        drawing.line([-1.2 * up, 1.2 * up], "muted", "guide")
    labels = hatted("m")
    return drawing.triad("E", np.array(figure.rows), place, labels=labels)
