"""The still of a challenge."""

import math

import numpy as np

from ...drawing import Drawing

REACH, SIZE, BOX = 1.25, 112, (1.1, 0.8, 0.35)  # as in js/challenge.js
TASKS = {
    "match": "The box is to be turned until its matrix is a given one; where that is, is not shown.",
    "undo": "The box has been turned, and is to be turned back to where its triad lies on that of N.",
    "ghost": "A second box, E, shows where three turns of a ghost have led; the axes of its turns are to be found.",
}


def drawing(figure):
    rows = [f"{name} at ({', '.join(f'{entry + 0.0:.2f}' for entry in row)})" for name, row in zip("xyz", figure.dcm)]
    drawing = Drawing(
        f"A box with the triad of A, and from the same origin the triad of N. {TASKS[figure.task]} Along N, the unit "
        f"vectors of A are {', '.join(rows).replace('-0.00', '0.00')}. A turn of "
        f"{math.degrees(figure.remaining):.0f} degrees remains.",
        scale=SIZE,
    )
    if figure.task == "ghost":
        drawing.box(figure.goal, BOX, colour="E").triad("E", figure.goal, labels=("", "", ""))
    drawing.box(figure.dcm, BOX, colour="A")
    return drawing.triad("N", REACH * np.eye(3)).triad("A", figure.dcm)
