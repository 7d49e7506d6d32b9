"""The picture of nine numbers that should be a direction cosine matrix."""

import math

from ...vectors import AXES, IDENTITY, add, cross, dot, length, scale, unit

REACH = 1.2
SIZE = 116
SMALL = 1e-9


def off(row):
    """Return whether a row has a length other than 1."""
    return abs(dot(row, row) - 1) > SMALL


def mirrored(rows):
    """Return whether the rows are left-handed."""
    return dot(cross(rows[0], rows[1]), rows[2]) < 0


def picture(sheet, rows, nearest):
    """Draw the rows, and ``nearest``, the nearest triad, or None if several are equally near."""
    sheet.triad("N", IDENTITY, length=REACH)
    if nearest is not None:
        sheet.layer = -1
        for row, measured in zip(nearest, rows):
            sheet.arrow(row, colour="D")
            sheet.line([row, measured], "D", "guide")
    sheet.layer = 0
    for k, row in enumerate(rows):
        sheet.arrow(row, colour="A")
        sheet.label_beyond(unit(row) if length(row) < 1 else row, rf"$\hat{{a}}_{AXES[k]}$", "A")
    sheet.layer = 1
    for row in rows:
        if off(row):
            # The right place of the tip, and the part that is missing or too long.
            sheet.line([row, unit(row)], "B", "thick")
            sheet.ring(unit(row), "B", 5)
    for i, j in [[0, 1], [1, 2], [2, 0]]:
        # The corner between two rows: a square if they are orthogonal.
        u, v = scale(0.2, unit(rows[i])), scale(0.2, unit(rows[j]))
        fails = abs(dot(rows[i], rows[j])) > SMALL
        sheet.line([u, add(u, v), v], "B" if fails else "muted", "thick" if fails else "")
    # The direction of the third row of a right-handed matrix.
    if mirrored(rows):
        sheet.arrow(cross(rows[0], rows[1]), colour="B", label=r"$\hat{a}_x\times\hat{a}_y$")


def drawing(figure, Sheet):
    from ...drawing import view_from

    rows = figure.matrix
    try:
        nearest = figure.nearest.dcm
    # Several matrices are equally near.
    except ValueError:
        nearest = None
    arrows = ", ".join(
        f"a {name} at ({', '.join(f'{entry:.2f}' for entry in row)})"
        for name, row in zip("xyz", rows)
    )
    sheet = Sheet(
        f"Three arrows in the frame N that should be the unit vectors of a triad A: {arrows}. "
        f"{figure.check() or 'They are the rows of a direction cosine matrix'}. "
        + (
            "Dotted arrows show the nearest triad."
            if nearest is not None
            else "Several triads are equally near."
        )
        + (" Small circles mark where arrows of length 1 would end." if any(map(off, rows)) else "")
        + (
            " A further arrow shows a x cross a y, where a z should point."
            if mirrored(rows)
            else ""
        ),
        view=view_from(math.radians(40), math.radians(24)),
        scale=SIZE,
    )
    return sheet.paint(picture, rows, nearest)
