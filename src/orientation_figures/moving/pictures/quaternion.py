"""The stills of the quaternion and its double, and of three ways from one orientation to another."""

import math

import numpy as np

from orientation.euler_angles import dcm_from_body_fixed

from ...drawing import Drawing
from ..quaternion import SECONDS, angle_between

# As in js/quaternion.js: pixels, places on the sheet.
SIZE, KNOB, MIDDLE, RADIUS, BALL, SAMPLES = 96, 1.32, (142, 130), 70, 104, 60
LEFT, RIGHT, TOP, BOTTOM = -120, 150, 144, 196
TOPS = (30, 60, 90, 120, 180, 360, 720)


def drawing(figure):
    return _double(figure) if figure.view == "double" else _way(figure)


def _double(figure):
    axis, half = np.array(figure.axis), figure.angle / 2
    q = ", ".join(f"{entry:.3f}" for entry in figure.quaternion)
    drawing = Drawing(
        f"The triad of N, and from the same origin the triad of A, turned from N through theta, "
        f"{math.degrees(figure.angle):.0f} degrees, about the unit vector e with the components "
        f"({', '.join(f'{entry:.2f}' for entry in axis)}). Beside it a circle of radius 1 with the scalar part of a "
        f"quaternion to the right and its part along e upwards. The point q stands at half the angle, "
        f"{math.degrees(half):.0f} degrees{', and minus q opposite to it' if figure.more else ''}. q is ({q}), scalar "
        f"first{'; minus q is the same orientation' if figure.more else ''}.",
        scale=SIZE,
    )
    drawing.line([-0.6 * axis, KNOB * axis], "accent", "guide")
    drawing.triad("N", 1.25 * np.eye(3)).triad("A", figure.dcm).arrow(axis, colour="accent")
    drawing.dot(KNOB * axis, "accent", 5).label(KNOB * axis, r"$\hat{e}$", "accent", (17, 2))
    start = np.eye(3)[np.argmin(np.abs(axis))]
    start = start - start @ axis * axis
    rest = figure.angle - 2 * math.pi
    if rest > 1e-9:
        for part in (0, math.pi):
            drawing.turn(axis, math.pi, start if part == 0 else -start, 0.5, colour="accent", head=False)
    if figure.angle > 0:
        drawing.turn(
            axis,
            rest if rest > 1e-9 else figure.angle,
            start,
            0.6 if rest > 1e-9 else 0.5,
            r"$\theta$",
            colour="accent",
            kind="thick",
        )

    def at(radius, angle):
        return _placed(drawing, MIDDLE[0] + radius * math.cos(angle), MIDDLE[1] - radius * math.sin(angle))

    def round_to(radius, angle):
        return [at(radius, part * angle) for part in np.linspace(0, 1, 49)]

    for angle in (0, math.pi / 2):
        drawing.line([at(-RADIUS - 12, angle), at(RADIUS + 12, angle)], "muted", "faint")
    drawing.line(round_to(RADIUS, 2 * math.pi), "muted")
    drawing.label(at(RADIUS + 12, 0), "$q_0$", shift=(3, 13), size=16)
    drawing.label(at(RADIUS + 12, math.pi / 2), r"$\hat{e}$", "accent", (12, 2), 16)
    if half > 1e-9:
        drawing.line(round_to(RADIUS, half), "accent", "thick").line(round_to(22, half), "accent")
        drawing.label(at(40, half / 2), r"$\theta/2$", "accent", size=16)
    drawing.arrow(at(RADIUS, half), at(0, 0), "accent", "$q$")
    if not figure.more:
        return drawing
    return drawing.arrow(at(-RADIUS, half), at(0, 0), "muted", "$-q$")


def _way(figure):
    first, second = dcm_from_body_fixed((figure.first, figure.second), "zxy")
    k = "xyz".index(figure.unit_vector)
    shares = np.linspace(0, 1, SAMPLES + 1)
    tracks = list(zip(*map(figure.ways, shares)))
    speeds = [[angle_between(*pair) * SAMPLES / SECONDS for pair in zip(track, track[1:])] for track in tracks]
    lengths = np.linalg.norm(figure.blend(figure.share), axis=1)
    now = [
        f"{speed:.0f}" if math.isfinite(speed) else "not defined" for speed in np.degrees(figure.speeds(figure.share))
    ]
    highest, _, beyond = plotted(speeds)
    cut = f", cut off at {highest} degrees per second; the fastest is {beyond:.0f}" if beyond else ""
    drawing = Drawing(
        f"A sphere with three ways of the tip of a unit vector {figure.unit_vector} from the orientation of A to "
        "that of "
        f"B, a turn of {math.degrees(angle_between(first, second)):.0f} degrees: of C by slerp, an even turn about "
        "one axis; "
        "of D by interpolated Euler angles z-x-y; of E, the same way as C but at another pace, by the matrix "
        "nearest to interpolated entries. A "
        f"straight dashed line inside the sphere shows where the blended entries lead before they are repaired. "
        f"Shown after {figure.share * SECONDS:.1f} of {SECONDS} seconds, when the speeds of C, D and E are "
        f"{now[0]}, {now[1]} and {now[2]} "
        f"degrees per second, and the blended rows have the lengths "
        f"{', '.join(f'{length:.2f}' for length in lengths)}. Below, the three speeds over time{cut}.",
        scale=BALL,
    )
    drawing.circle(drawing.view[2], kind="faint").circle((0, 0, 1), kind="faint")
    drawing.line([first[k], second[k]], "E", "guide")
    for letter, track in zip("CD", tracks):
        if track[0] is not None:
            drawing.line([dcm[k] for dcm in track], letter, "axis")
    # E goes the same way round as C, at another pace: dots a fifth of a second apart.
    for dcm in tracks[2][::3]:
        if dcm is not None:
            drawing.dot(dcm[k], "E", 3)
    letters = {letter: rf"$\hat{{{letter.lower()}}}_{figure.unit_vector}$" for letter in "ABCDE"}
    drawing.arrow(first[k], colour="A", label=letters["A"]).arrow(second[k], colour="B", label=letters["B"])
    raw = figure.blend(figure.share)[k]
    drawing.line([(0, 0, 0), raw], "E").dot(raw, "E", 4)
    for letter, dcm in zip("CDE", figure.ways(figure.share)):
        if dcm is not None and 1e-9 < figure.share < 1 - 1e-9:
            drawing.arrow(dcm[k], colour=letter, label=letters[letter])
        elif dcm is not None:
            drawing.dot(dcm[k], letter, 5)
    return _plot(figure, drawing, speeds)


def plotted(speeds):
    """Return the top of the scale, the pieces of each way's curve below it, and the fastest speed if it is cut off.

    Speeds come in radians per second, and all else is in degrees.
    """
    degrees = np.degrees(np.array(speeds, dtype=float))
    fast = np.max(degrees, initial=0, where=np.isfinite(degrees))
    highest = next((top for top in TOPS if top >= fast), TOPS[-1])
    pieces = []
    for track in degrees:
        runs = [[]]
        for n, speed in enumerate(track):
            if speed <= highest:
                runs[-1].append(((n + 0.5) / SAMPLES, speed))
            elif runs[-1]:
                runs.append([])
        pieces.append([run for run in runs if len(run) > 1])
    return highest, pieces, fast if fast > highest else 0


def _plot(figure, drawing, speeds):
    highest, pieces, beyond = plotted(speeds)

    def at(part, speed):
        return _placed(drawing, LEFT + part * (RIGHT - LEFT), BOTTOM - speed / highest * (BOTTOM - TOP))

    drawing.line([at(0, 0), at(1, 0)], "muted").line([at(0, 0), at(0, highest)], "muted")
    drawing.line([at(0, highest), at(1, highest)], "muted", "faint")
    drawing.label(at(0, highest), rf"${highest}^\circ/\mathrm{{s}}$", shift=(-30, 0), size=14)
    drawing.label(at(0, 0), "$0$", shift=(-11, 0), size=14)
    drawing.label(at(1, 0), rf"${SECONDS}\,\mathrm{{s}}$", shift=(0, 14), size=14)
    if beyond:
        drawing.label(at(0.5, highest), r"$\mathrm{cut\ off}$", shift=(0, -9), size=14)
    drawing.line([at(figure.share, 0), at(figure.share, highest)], "ink", "guide")
    for letter, runs in zip("CDE", pieces):
        for run in runs:
            drawing.line([at(*point) for point in run], letter, "axis")
    return drawing


def _placed(drawing, right, down):
    """Return a point of N that is seen at a place of the sheet."""
    return np.array((right, -down, 0)) / drawing.scale @ drawing.view
