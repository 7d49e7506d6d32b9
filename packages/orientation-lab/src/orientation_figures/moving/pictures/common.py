"""Functions that several pictures share."""

import math

from orientation.direction_cosines import simple_dcm

from ...vectors import dot, length, multiply, scale, subtract


def around(sheet, axis, angle, start, *, colour="muted", head=False, kind=""):
    """Return the path of the tip of ``start`` as it rotates about the axis."""
    foot = scale(dot(start, axis), axis)
    arm = subtract(start, foot)
    if length(arm) > 1e-6:
        sheet.turn(
            axis, angle, arm, radius=length(arm), origin=foot, colour=colour, head=head, kind=kind
        )


def chain(turns, kind="body", start=simple_dcm("z", 0.0)):
    """Return the matrices of the first frame and of all further ones relative to N."""
    frames = [start]
    for axis, angle in turns:
        turn = simple_dcm(axis, angle)
        # A rotation about the frame's own unit vector multiplies from the left, one about N's from
        # the right.
        frames.append(multiply(turn, frames[-1]) if kind == "body" else multiply(frames[-1], turn))
    return frames


def partly(turns, share):
    """Return the rotations of a chain after a share of them; each begins and ends at rest."""
    done = share * len(turns)
    whole = min(math.floor(done + 1e-9), len(turns))
    rest = max(0, done - whole)
    if rest > 1e-9:
        axis, angle = turns[whole]
        return [*turns[:whole], [axis, rest * rest * (3 - 2 * rest) * angle]]
    return turns[:whole]
