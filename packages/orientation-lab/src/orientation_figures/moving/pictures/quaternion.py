"""The pictures of the quaternion and its double, and of three ways between orientations."""

import math

from orientation.axis_angle import axis_angle_from_dcm

from ...vectors import (
    AXES,
    IDENTITY,
    degrees,
    dot,
    in_degrees,
    length,
    multiply,
    scale,
    subtract,
    transpose,
    unit,
)

SIZE = 96  # of the first picture, and of the second:
BALL = 104
KNOB = 1.32
# The circle beside the triads, in pixels.
MIDDLE = (142, 130)
RADIUS = 70
SECONDS = 4
SAMPLES = 60
WAYS = ("C", "D", "E")
# The plot below the ways.
LEFT = -120
RIGHT = 150
TOP = 144
BOTTOM = 196
TOPS = (30, 60, 90, 120, 180, 360, 720)


def double(sheet, axis, angle, dcm, more):
    """Draw a frame that rotates in N, and beside it the circle of half the angle.

    The circle shows q, and also -q if ``more`` is true.
    """
    knob, sizes = scale(KNOB, axis), [abs(entry) for entry in axis]
    far = IDENTITY[sizes.index(min(sizes))]
    arm = subtract(far, scale(dot(far, axis), axis))
    sheet.line([scale(-0.6, axis), knob], "accent", "guide")
    sheet.triad("N", IDENTITY, length=1.25)
    sheet.triad("A", dcm)
    sheet.arrow(axis, colour="accent")
    sheet.dot(knob, "accent", 5)
    sheet.label(knob, r"$\hat{e}$", "accent", [17, 2])
    # The angle of the second rotation is drawn outside the first.
    rest = angle - 2 * math.pi
    second = rest > 1e-9
    if second:
        sheet.turn(axis, 2 * math.pi, arm, radius=0.5, colour="accent", head=False)
    if angle > 0:
        turn, radius = rest if second else angle, 0.6 if second else 0.5
        sheet.turn(axis, turn, arm, radius=radius, label=r"$\theta$", colour="accent", kind="thick")
    half = angle / 2
    sheet.layer = 1
    for way in [0, math.pi / 2]:
        sheet.line(
            [on_circle(sheet, -RADIUS - 12, way), on_circle(sheet, RADIUS + 12, way)],
            "muted",
            "faint",
        )
    sheet.line(round_to(sheet, RADIUS, 2 * math.pi), "muted")
    sheet.label(on_circle(sheet, RADIUS + 12, 0), "$q_0$", "ink", [3, 13], 16)
    sheet.label(on_circle(sheet, RADIUS + 12, math.pi / 2), r"$\hat{e}$", "accent", [12, 2], 16)
    sheet.layer = 2
    if half > 1e-9:
        sheet.line(round_to(sheet, RADIUS, half), "accent", "thick")
        sheet.line(round_to(sheet, 22, half), "accent")
        sheet.label(on_circle(sheet, 40, half / 2), r"$\theta/2$", "accent", [0, 0], 16)
    middle = on_circle(sheet, 0, 0)
    sheet.arrow(on_circle(sheet, RADIUS, half), start=middle, colour="accent", label="$q$")
    if more:
        sheet.arrow(on_circle(sheet, -RADIUS, half), start=middle, colour="muted", label="$-q$")


def on_circle(sheet, radius, angle):
    return sheet.placed(MIDDLE[0] + radius * math.cos(angle), MIDDLE[1] - radius * math.sin(angle))


def round_to(sheet, radius, angle):
    return [on_circle(sheet, radius, k / 48 * angle) for k in range(49)]


def angle_between(before, after):
    """Return the angle between two orientations, or NaN if one of them is missing."""
    return (
        math.nan
        if before is None or after is None
        else axis_angle_from_dcm(multiply(after, transpose(before)))[1]
    )


def ways(sheet, ends, tracks, speeds, now, raw, k, share):
    """Draw the tip of the ``k``-th unit vector on its three ways, without those that are None.

    ``tracks`` are the orientations at even times and ``speeds`` those between them; ``now`` are the
    three orientations, and ``raw`` is the row of the blended entries.
    """
    hats = [rf"$\hat{{{letter}}}_{AXES[k]}$" for letter in list("abcde")]
    sheet.circle(sheet.view[2], colour="muted", kind="faint")
    sheet.circle([0, 0, 1], half="front", colour="muted", kind="faint")
    sheet.circle([0, 0, 1], half="back", colour="muted", kind="guide faint")
    sheet.line([ends[0][k], ends[1][k]], "E", "guide")
    for n, track in enumerate(tracks[:2]):
        if track[0] is not None:
            sheet.line([dcm[k] for dcm in track], WAYS[n], "axis")
    # E goes the same way round as C, at another pace: dots a fifth of a second apart.
    for n, dcm in enumerate(tracks[2]):
        if dcm is not None and n % 3 == 0:
            sheet.dot(dcm[k], "E", 3)
    sheet.arrow(ends[0][k], colour="A", label=hats[0])
    sheet.arrow(ends[1][k], colour="B", label=hats[1])
    sheet.layer = 1
    if length(subtract(raw, unit(raw))) > 1e-6:
        sheet.line([[0, 0, 0], raw], "E")
    sheet.dot(raw, "E", 4)
    moving = 1e-9 < share and share < 1 - 1e-9
    for n, dcm in enumerate(now):
        if dcm is not None and moving:
            sheet.arrow(dcm[k], colour=WAYS[n], label=hats[n + 2])
        elif dcm is not None:
            sheet.dot(dcm[k], WAYS[n], 5)
    plot(sheet, speeds, share)


def plotted(speeds):
    """Return the top of the scale, the pieces of each way's curve below it, and a clipped maximum.

    The last is the fastest speed if it is cut off. Speeds are in radians per second, and all
    results are in degrees.
    """
    fast = degrees(max([0, *[speed for track in speeds for speed in track if speed >= 0]]))
    tops = [top for top in TOPS if top >= fast]
    highest, pieces = tops[0] if len(tops) else TOPS[-1], []
    for track in speeds:
        runs = [[]]
        for n, speed in enumerate(track):
            if degrees(speed) <= highest:
                runs[-1].append([(n + 0.5) / SAMPLES, degrees(speed)])
            elif len(runs[-1]):
                runs.append([])
        pieces.append([run for run in runs if len(run) > 1])
    return [highest, pieces, fast if fast > highest else 0]


def plot(sheet, speeds, share):
    highest, pieces, beyond = plotted(speeds)

    def at(part, speed):
        return sheet.placed(LEFT + part * (RIGHT - LEFT), BOTTOM - speed / highest * (BOTTOM - TOP))

    sheet.line([at(0, 0), at(1, 0)], "muted")
    sheet.line([at(0, 0), at(0, highest)], "muted")
    sheet.line([at(0, highest), at(1, highest)], "muted", "faint")
    sheet.label(at(0, highest), rf"${highest}^\circ/\mathrm{{s}}$", "ink", [-30, 0], 14)
    sheet.label(at(0, 0), "$0$", "ink", [-11, 0], 14)
    sheet.label(at(1, 0), rf"${SECONDS}\,\mathrm{{s}}$", "ink", [0, 14], 14)
    if beyond:
        sheet.label(at(0.5, highest), r"$\mathrm{cut\ off}$", "ink", [0, -9], 14)
    sheet.line([at(share, 0), at(share, highest)], "ink", "guide")
    for letter, runs in zip(WAYS, pieces):
        for run in runs:
            sheet.line([at(part, speed) for part, speed in run], letter, "axis")


def drawing(figure, Sheet):
    return _double(figure, Sheet) if figure.view == "double" else _ways(figure, Sheet)


def _double(figure, Sheet):
    q = ", ".join(f"{entry:.3f}" for entry in figure.quaternion)
    sheet = Sheet(
        "The triad of N, and from the same origin the triad of A, turned from N through theta, "
        f"{in_degrees(figure.angle)}, about the unit vector e with the components "
        f"({', '.join(f'{entry:.2f}' for entry in figure.axis)}). "
        "Beside it is a circle of radius 1, with the scalar part of a quaternion to the right and "
        "its part along e upwards. "
        f"The point q is at half the angle, {in_degrees(figure.angle / 2)}"
        f"{', and minus q is opposite' if figure.more else ''}. "
        f"q is ({q}), scalar first{'. Minus q is the same orientation' if figure.more else ''}.",
        scale=SIZE,
    )
    return sheet.paint(double, figure.axis, figure.angle, figure.dcm, figure.more)


def _ways(figure, Sheet):
    ends, k = figure.ends, AXES.index(figure.unit_vector)
    tracks = list(zip(*(figure.ways(n / SAMPLES) for n in range(SAMPLES + 1))))
    speeds = [
        [angle_between(*pair) * SAMPLES / SECONDS for pair in zip(track, track[1:])]
        for track in tracks
    ]
    raw = figure.blend(figure.share)
    now = [
        f"{math.degrees(speed):.0f}" if math.isfinite(speed) else "not defined"
        for speed in figure.speeds(figure.share)
    ]
    highest, _, beyond = plotted(speeds)
    cut = (
        f", cut off at {highest} degrees per second (the highest is {beyond:.0f})" if beyond else ""
    )
    sheet = Sheet(
        f"A sphere with three paths of the tip of a unit vector {figure.unit_vector} "
        f"from A to B, which are {in_degrees(angle_between(*ends))} apart. "
        "C moves by slerp, about one axis at constant speed. D moves by interpolated Euler "
        "angles z-x-y. E moves by interpolated matrix entries, each time restored to the nearest "
        "valid matrix, on the same path as C but at a different speed. "
        "A straight dashed line inside the sphere shows the blended entries before they are "
        "repaired. "
        f"After {figure.share * SECONDS:.1f} of {SECONDS} seconds, as shown, the speeds of C, D "
        f"and E are {now[0]}, {now[1]} and {now[2]} degrees per second, and the blended rows have "
        f"lengths {', '.join(f'{size:.2f}' for size in map(length, raw))}. "
        f"Below are the three speeds over time{cut}.",
        scale=BALL,
    )
    return sheet.paint(
        ways, ends, tracks, speeds, figure.ways(figure.share), raw[k], k, figure.share
    )
