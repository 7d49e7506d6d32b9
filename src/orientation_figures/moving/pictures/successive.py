"""The still of a chain of simple turns."""

import math

import numpy as np

from orientation.axis_angle import axis_angle_from_dcm

from ...drawing import Drawing
from ..successive import COMPARISONS, chain, second_chain

REACH, BEFORE, SIZE = 1.25, 0.66, 96  # of the arrows of N, of the frames before the last, pixels
LETTERS = "NABCD"


def drawing(figure):
    count, now = len(figure.turns), _partly(figure.turns, figure.share)
    frames, last = chain(now, figure.fixed), len(now)
    drawing = Drawing(_words(figure, now, frames), scale=SIZE)
    drawing.triad("N", REACH * np.eye(3))
    second = None if figure.compare == "nothing" else second_chain(figure.turns, figure.fixed, figure.compare)
    for k in range(1, last):
        drawing.triad(LETTERS[k], frames[k], length=BEFORE, labels=("", "", ""))
    if last and not second:
        axis = (frames[last - 1] if figure.fixed == "body" else np.eye(3))["xyz".index(now[-1][0])]
        drawing.line([-0.35 * axis, REACH * axis], "accent", "guide")
        _around(drawing, axis, now[-1][1], frames[last - 1])
    if last:
        drawing.triad(LETTERS[last], frames[-1])
    if second:
        turns = _partly(second[0], figure.share)
        other = chain(turns, second[1])
        if last:
            axis, angle = axis_angle_from_dcm(other[-1] @ frames[-1].T)
            if angle > 0.02:
                _around(drawing, axis @ frames[-1], angle, frames[-1])
            drawing.triad("E", other[-1])
        colours = ["N", *["muted"] * (count - 1), "E"]
        _strip(drawing, other, turns, second[1], colours, 195, 22)
    _strip(drawing, frames, now, figure.fixed, LETTERS[: count + 1], 143 if second else 168, 22 if second else 27)
    return drawing


def _words(figure, now, frames):
    about = ["n" if figure.fixed == "space" else letter.lower() for letter in LETTERS]
    steps = "; ".join(
        f"{LETTERS[k + 1]} is turned from {LETTERS[k]} through {math.degrees(angle):.0f} degrees about "
        f"{about[k]} {axis}"
        for k, (axis, angle) in enumerate(now)
    )
    rows = [f"{name} at ({', '.join(f'{entry:.2f}' for entry in row)})" for name, row in zip("xyz", frames[-1])]
    end = LETTERS[len(now)]
    words = (
        f"The triads of the frames {', '.join(LETTERS[: len(now) + 1])} from one origin, and below them each "
        f"frame by itself, in order, with a small box that turns with it. "
    )
    words += f"{steps}. " if steps else "No turn has been made yet. "
    words += f"Along N, the unit vectors of {end} are {', '.join(rows)}."
    if figure.compare != "nothing":
        kind = (
            "with the same turns " + ("space fixed" if figure.fixed == "body" else "body fixed")
            if figure.compare == COMPARISONS[4]
            else f"with turns {figure.compare}"
        )
        words += (
            f" A second chain, {kind}, ends in the frame E; a turn of {math.degrees(figure.angle_between):.1f} "
            f"degrees lies between the two ends."
        )
    return words


def _partly(turns, share):
    """Return the turns made so far; each begins and ends at rest."""
    done = share * len(turns)
    whole = min(math.floor(done + 1e-9), len(turns))
    rest = max(0.0, done - whole)
    turns = list(turns)
    if rest > 1e-9:
        axis, angle = turns[whole]
        return [*turns[:whole], (axis, rest * rest * (3 - 2 * rest) * angle)]
    return turns[:whole]


def _around(drawing, axis, angle, starts):
    for start in starts:
        foot = start @ axis * axis
        if (radius := np.linalg.norm(start - foot)) > 1e-6:
            drawing.turn(axis, angle, start - foot, radius, origin=foot, colour="muted", head=False)


def _strip(drawing, frames, turns, kind, colours, down, radius):
    """Draw the frames side by side in their order, with the unit vector that each turn is about."""
    width, reach = 340 / len(colours), radius / SIZE

    def at(x, y=0):
        return np.array((x, -(down + y), 0)) / SIZE @ drawing.view

    for k, dcm in enumerate(frames):
        x = (k - (len(colours) - 1) / 2) * width
        drawing.box(dcm, (1.1 * reach, 0.8 * reach, 0.28 * reach), at(x), colours[k])
        drawing.triad(colours[k], dcm, at(x), reach, labels=("", "", ""))
        if colours[k] != "muted":
            drawing.label(at(x - radius + 1, -radius + 1), f"${colours[k]}$", colours[k], size=16)
        if k:
            start, end = x - width + radius + 7, x - radius - 3
            short = max(0, (end - start - 26) / 2)
            drawing.arrow(at(end - short, 4), at(start + short, 4), "muted")
            letter, axis = ("N" if kind == "space" else colours[k - 1]), turns[k - 1][0]
            # The frames on the way of the second chain have no names.
            name = axis if letter == "muted" else rf"\hat{{{letter.lower()}}}_{axis}"
            drawing.label(at((start + end) / 2, -8), f"${name}$", size=15)
