"""The still of the workbench: the last pose of each side, as its numbers are read."""

import numpy as np

from orientation_workbench import explain
from orientation_workbench.mismatch.meaning import dcms_from_numbers
from orientation_workbench.mismatch.text import read_poses

from ...drawing import Drawing

REACH, APART, SIZE = 1.25, 165, 100  # as in js/workbench.js


def drawing(figure):
    known = [
        {name: value for name, value in side.items() if value != "not known"}
        for side in (figure.first_is, figure.second_is)
    ]
    programs = [side.pop("program", None) for side in known]
    found = explain(
        figure.first,
        figure.second,
        first_declared=known[0],
        second_declared=known[1],
        first_program=programs[0],
        second_program=programs[1],
        noise=np.radians(figure.noise),
    )
    said = " ".join(str(found).splitlines())
    drawing = Drawing(
        "Two pairs of triads side by side, each the triad of the frame N and from the same origin another: on the left "
        f"that of A, as the first program's numbers are read, on the right that of B, as the second's. {said}",
        scale=SIZE,
    )
    for side, (text, letter) in enumerate(((figure.first, "A"), (figure.second, "B"))):
        numbers = read_poses(text, ("first", "second")[side], known[side].get("kind")).numbers
        reading = found.chains[0][side] if found.chains else None
        origin = (2 * side - 1) * APART / SIZE * drawing.view[0]
        drawing.triad("N", REACH * np.eye(3), origin=origin)
        if reading:
            drawing.triad(letter, dcms_from_numbers(reading, numbers[-1:])[0], origin=origin)
    return drawing
