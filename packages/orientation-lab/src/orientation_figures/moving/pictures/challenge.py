"""The picture of a challenge."""

from ...vectors import IDENTITY, in_degrees

REACH = 1.25
SIZE = 112
BOX = (1.1, 0.8, 0.35)


def picture(sheet, dcm, ghost=None):
    """Draw the box, and a ghost that shows the goal or the way there."""
    if ghost is not None:
        sheet.faded = True
        sheet.box(ghost, BOX, colour="E")
        sheet.triad("E", ghost, labels=["", "", ""])
        sheet.faded = False
    sheet.box(dcm, BOX, colour="A")
    sheet.triad("N", IDENTITY, length=REACH)
    sheet.triad("A", dcm)


_TASKS = {
    "match": "Turn the box until it has a given matrix. The goal is not shown.",
    "undo": "The box has been turned. Turn it back until its triad coincides with that of N.",
    "ghost": "A second box, E, shows where a ghost's three rotations end. Find their axes.",
}


def drawing(figure, Sheet):
    rows = [
        f"{name} at ({', '.join(f'{entry + 0.0:.2f}' for entry in row)})"
        for name, row in zip("xyz", figure.dcm)
    ]
    sheet = Sheet(
        "A box with the triad of A, and from the same origin the triad of N. "
        f"{_TASKS[figure.task]} Along N, the unit vectors of A are "
        f"{', '.join(rows).replace('-0.00', '0.00')}. "
        f"A rotation of {in_degrees(figure.remaining)} remains.",
        scale=SIZE,
    )
    return sheet.paint(picture, figure.dcm, figure.goal if figure.task == "ghost" else None)
