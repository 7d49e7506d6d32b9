"""The still of nine numbers that should be a direction cosine matrix."""

import numpy as np

from ...drawing import Drawing, view_from

REACH, SIZE = 1.2, 116  # as in js/nine_numbers.js
VIEW = view_from(np.radians(40), np.radians(24))


def drawing(figure):
    rows = np.array(figure.matrix)
    try:
        nearest = figure.nearest.dcm
    except ValueError:  # several are equally near
        nearest = np.empty((0, 3))
    said = ", ".join(f"a {name} at ({', '.join(f'{entry:.2f}' for entry in row)})" for name, row in zip("xyz", rows))
    drawing = Drawing(
        f"In the frame N three arrows that should be the unit vectors of a triad A: {said}. "
        f"{figure.check() or 'They are a direction cosine matrix'}. "
        + ("Dotted arrows show the nearest triad." if len(nearest) else "Several triads are equally near."),
        VIEW,
        SIZE,
    )
    drawing.triad("N", REACH * np.eye(3))
    for row, measured in zip(nearest, rows):
        drawing.arrow(row, colour="D").line([row, measured], "D", "guide")
    lengths = np.linalg.norm(rows, axis=1)
    for name, row, length in zip("xyz", rows, lengths):
        tip = drawing.on_sheet(row)
        outward = tip / (np.linalg.norm(tip) or 1)
        beyond = drawing.on_sheet(row / length) if 0 < length < 1 else tip
        drawing.arrow(row, colour="A", label=rf"$\hat{{a}}_{name}$", shift=beyond - tip + 17 * outward)
    for i, j in ((0, 1), (1, 2), (2, 0)):
        u, v = 0.2 * rows[i] / (lengths[i] or 1), 0.2 * rows[j] / (lengths[j] or 1)
        fails = abs(rows[i] @ rows[j]) > 1e-9
        drawing.line([u, u + v, v], "B" if fails else "muted", "thick" if fails else "")
    return drawing
