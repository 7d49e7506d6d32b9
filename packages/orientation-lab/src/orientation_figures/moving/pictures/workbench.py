"""The picture of the workbench: the last pose of each side, as its numbers are interpreted."""

from ...vectors import IDENTITY, scale

REACH = 1.25
# In pixels.
APART = 165
SIZE = 100


def picture(sheet, dcms):
    """Draw the matrices of A and B, or None where the numbers cannot be read."""
    for k, letter in enumerate(["A", "B"]):
        origin = scale((2 * k - 1) * APART / SIZE, sheet.view[0])
        sheet.triad("N", IDENTITY, origin=origin, length=REACH)
        if dcms[k] is not None:
            sheet.triad(letter, dcms[k], origin=origin)


def drawing(figure, Sheet):
    import numpy as np

    from orientation_workbench import explain
    from orientation_workbench.mismatch.meaning import dcms_from_numbers
    from orientation_workbench.mismatch.text import read_poses

    known = [
        {name: value for name, value in side.items() if value != "not known"}
        for side in (figure.first_is, figure.second_is)
    ]
    programs = [side.pop("program", None) for side in known]
    explanation = explain(
        figure.first,
        figure.second,
        first_declared=known[0],
        second_declared=known[1],
        first_program=programs[0],
        second_program=programs[1],
        noise=np.radians(figure.noise),
    )
    findings = " ".join(str(explanation).splitlines())
    sheet = Sheet(
        "Two pairs of triads side by side. Each has the triad of the frame N and, from the same "
        "origin, another: on the left the triad of A from the first program's numbers, on the "
        "right the triad of B from the second's. "
        f"{findings}",
        scale=SIZE,
    )
    dcms = [None, None]
    for side, text in enumerate((figure.first, figure.second) if explanation.chains else ()):
        numbers = read_poses(text, ("first", "second")[side], known[side].get("kind")).numbers
        dcms[side] = dcms_from_numbers(explanation.chains[0][side], numbers[-1:])[0]
    return sheet.paint(picture, dcms)
