"""The picture of a chain of simple rotations."""

import math

from orientation.axis_angle import axis_angle_from_dcm

from ...vectors import AXES, IDENTITY, in_degrees, multiply, scale, times, transpose
from .common import around, chain, partly

# The length of the arrows of N.
REACH = 1.25
# The length of the arrows of the frames before the last.
BEFORE = 0.66
SIZE = 96
LETTERS = "NABCD"
COMPARISONS = (
    "nothing",
    "1 and 2 exchanged",
    "2 and 3 exchanged",
    "3 and 4 exchanged",
    "body and space fixed",
)


def second_chain(turns, kind, compare):
    """Return the rotations of the second chain, and their kind."""
    k = COMPARISONS.index(compare)
    if k == 4:
        return [turns, "space" if kind == "body" else "body"]
    return [[*turns[: k - 1], turns[k], turns[k - 1], *turns[k + 1 :]], kind]


def axis_of(frames, turns, kind, k):
    """Return the direction of the axis of a rotation of the chain, along N."""
    return (frames[k] if kind == "body" else IDENTITY)[AXES.index(turns[k][0])]


def picture(sheet, turns, kind, share, compare, lit=False):
    """Draw the chain.

    If the reader touches a number (``lit``), the intermediate frames are faded, as beside a second
    chain.
    """
    now = partly(turns, share)
    frames = chain(now, kind)
    last, end = len(now), frames[-1]
    compared = compare != COMPARISONS[0]
    sheet.triad("N", IDENTITY, length=REACH)
    sheet.faded = lit or compared
    for k in range(1, last):
        sheet.triad(LETTERS[k], frames[k], length=BEFORE, labels=["", "", ""])
    if last and not compared:
        axis = axis_of(frames, now, kind, last - 1)
        sheet.line([scale(-0.35, axis), scale(REACH, axis)], "accent", "guide")
        for row in frames[last - 1]:
            around(sheet, axis, now[last - 1][1], row)
    sheet.faded = False
    if last:
        sheet.triad(LETTERS[last], end)
    letters = list(LETTERS)[: len(turns) + 1]
    if compared:
        other_turns, other_kind = second_chain(turns, kind, compare)
        other_now = partly(other_turns, share)
        other_frames = chain(other_now, other_kind)
        if last:
            between, angle = axis_angle_from_dcm(multiply(other_frames[-1], transpose(end)))
            # The axis between two orientations has the same components in both, so along N it can
            # be found through either.
            if angle > 0.02:
                for row in end:
                    around(sheet, times(transpose(end), between), angle, row)
            sheet.triad("E", other_frames[-1])
        colours = ["N", *["muted" for _ in turns[1:]], "E"]
        strip(sheet, other_frames, other_now, other_kind, colours, 195, 22)
    strip(sheet, frames, now, kind, letters, 143 if compared else 168, 22 if compared else 27)


def strip(sheet, frames, turns, kind, colours, down, radius):
    """Draw the frames side by side in order, with the unit vector of each rotation's axis."""
    width, reach = 340 / len(colours), radius / SIZE

    def at(x, y=0):
        return sheet.placed(x, down + y)

    for k, dcm in enumerate(frames):
        x = (k - (len(colours) - 1) / 2) * width
        sheet.box(dcm, [1.1 * reach, 0.8 * reach, 0.28 * reach], origin=at(x), colour=colours[k])
        sheet.triad(colours[k], dcm, origin=at(x), length=reach, labels=["", "", ""])
        if colours[k] != "muted":
            sheet.label(at(x - radius + 1, -radius + 1), f"${colours[k]}$", colours[k], [0, 0], 16)
        if k:
            start, end = x - width + radius + 7, x - radius - 3
            short = max(0, (end - start - 26) / 2)
            sheet.arrow(at(end - short, 4), start=at(start + short, 4), colour="muted")
            letter, axis = "N" if kind == "space" else colours[k - 1], turns[k - 1][0]
            # The intermediate frames of the second chain have no names.
            name = axis if letter == "muted" else rf"\hat{{{letter.lower()}}}_{axis}"
            sheet.label(at((start + end) / 2, -8), f"${name}$", "ink", [0, 0], 15)


def drawing(figure, Sheet):
    now = partly(figure.turns, figure.share)
    sheet = Sheet(_words(figure, now, chain(now, figure.fixed)), scale=SIZE)
    return sheet.paint(picture, figure.turns, figure.fixed, figure.share, figure.compare)


def _words(figure, now, frames):
    about = ["n" if figure.fixed == "space" else letter.lower() for letter in LETTERS]
    steps = "; ".join(
        f"{LETTERS[k + 1]} is turned from {LETTERS[k]} through {in_degrees(angle)} "
        f"about {about[k]} {axis}"
        for k, (axis, angle) in enumerate(now)
    )
    rows = [
        f"{name} at ({', '.join(f'{entry:.2f}' for entry in row)})"
        for name, row in zip("xyz", frames[-1])
    ]
    end = LETTERS[len(now)]
    words = (
        f"The triads of the frames {', '.join(LETTERS[: len(now) + 1])}, drawn from one origin. "
        "Below them each frame is drawn by itself, in order, with a small box that turns with it. "
    )
    words += f"{steps}. " if steps else "No rotation has been made yet. "
    words += f"Along N, the unit vectors of {end} are {', '.join(rows)}."
    if figure.compare != "nothing":
        kind = (
            "with the same turns " + ("space fixed" if figure.fixed == "body" else "body fixed")
            if figure.compare == COMPARISONS[4]
            else f"with turns {figure.compare}"
        )
        words += (
            f" A second chain, {kind}, ends in the frame E. The two results differ by a "
            f"rotation of {math.degrees(figure.angle_between):.1f} degrees."
        )
    return words
