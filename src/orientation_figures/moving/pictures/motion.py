"""The stills of a body that tumbles: the body itself, and the plots of how the drift grows."""

import numpy as np

from orientation.euler_angles import body_fixed_from_dcm, gimbal_lock_margin
from orientation.quaternions import dcm_from_quaternion

from ...drawing import Drawing
from ..motion import DESCRIPTIONS, SECONDS
from ..tumbling import error_of, fault_of, matrices, momentum

METHODS = {"Euler": "Euler", "Runge-Kutta": "Runge-Kutta", "exponential": "exponential (Magnus)"}
SAMPLE = 0.1  # seconds between two points of a curve
ROUNDING = 1e-15  # what is below it is the rounding of one processor, and is drawn here
SIZE, REACH = 118, 1.25  # pixels to the unit, and how long an arrow may be drawn
COLOURS = {"matrix": "A", "quaternion": "D", "angles": "C"}
LEFT, RIGHT = -128, 168
# Top, bottom, value at the bottom and at the top, and the marked values, of each part of the plot.
FAULT, ERROR, MARGIN = (24, 124, -16, 2), (156, 256, -12, 1), (288, 324, 0, 90)
LEGEND = 104


def drawing(figure):
    dcm, run = figure.dcm, figure.run()
    fault, error = (curve[-1] for curve in (fault_of(dcm[None]), error_of(dcm[None], run["reference"][-1:])))
    lengths = ", ".join(f"{length:.2f}" for length in np.linalg.norm(dcm, axis=1))
    restored = "restored after every step" if figure.restored else "not restored"
    middle = sorted(figure.moments)[1] == figure.moments["xyz".index(figure.axis)]
    times = {0: "has not flipped yet" if middle else "does not flip", 1: "has flipped once"}.get(
        figure.flips, f"has flipped {figure.flips} times"
    )
    drawing = Drawing(
        f"A {figure.body} that spins freely about its {figure.axis} axis, with the moments of inertia "
        f"{', '.join(f'{moment:g}' for moment in figure.moments)} g m^2 about x, y and z, drawn with its triad A as "
        "its "
        f"{DESCRIPTIONS[figure.description]} says after {run['time'][-1]:.1f} seconds, {restored}, with the "
        f"{METHODS[figure.method]} method in steps of {1000 * figure.step:g} milliseconds. It {times}. "
        f"The unit vectors of A, which should be 1 long, are {lengths} long; the matrix is not orthogonal by "
        f"{_words(fault)}, and the orientation is wrong by {_words(error)} radians. Dashed: the reference, "
        f"computed with steps ten times finer; the angular velocity of those steps is given to every description. "
        f"The arrow H is the angular momentum, which keeps its direction. In the corner stands the triad of N.",
        scale=SIZE,
    )
    corner = np.array((-136, -108, 0)) / SIZE @ drawing.view
    drawing.triad("N", np.eye(3), corner, 0.28)
    drawing.arrow(1.4 * momentum(run, figure.moments), colour="accent", label=r"$\mathbf{H}$")
    # A body that has grown out of the sheet is drawn smaller, and with it what it really is.
    drawing.scale = SIZE * min(1, REACH / np.linalg.norm(dcm, axis=1).max())
    toward = dcm @ drawing.view[2] > 0

    def arrow(k):
        drawing.arrow(dcm[k], colour="A", label=rf"$\hat{{a}}_{'xyz'[k]}$")

    if not toward[2]:
        arrow(2)
    if figure.body == "racket":
        _draw_racket(drawing, dcm)
    else:
        _draw_block(drawing, dcm, _edges(figure.moments))
    for k in range(3 if toward[2] else 2):
        arrow(k)
    for points in RACKET if figure.body == "racket" else [_cut(_edges(figure.moments))]:
        drawing.line(points @ dcm_from_quaternion(run["reference"][-1]), "muted", "guide")
    return drawing


def plot(figure):
    """Return the ``Drawing`` of how the drift has grown up to ``time``."""
    run, every = figure.run(), max(1, round(SAMPLE / figure.step))
    times, reference = run["time"][::every], run["reference"][::every]
    curves = {name: matrices(run, name, slice(None, None, every)) for name in DESCRIPTIONS}
    faults = {name: fault_of(curve) for name, curve in curves.items()}
    errors = {name: error_of(curve, reference) for name, curve in curves.items()}
    angles = body_fixed_from_dcm(dcm_from_quaternion(run["reference"]), "zxy")
    margins = np.degrees(gimbal_lock_margin(angles, "zxy"))
    margin = np.array([margins[max(0, k - every + 1) : k + 1].min() for k in range(0, len(margins), every)])
    last = "; ".join(
        f"{title}, not orthogonal by {_words(faults[name][-1])}, error {_words(errors[name][-1])} radians"
        for name, title in DESCRIPTIONS.items()
    )
    drawing = Drawing(
        f"Three plots over the {SECONDS:.0f} seconds of the run, which has come to {times[-1]:.1f} seconds. Above, "
        "on a "
        f"logarithmic scale, by how much each description is not orthogonal; in the middle, its error against the "
        f"reference; below, the margin of the Euler angles to gimbal lock, at the least {margin.min():.0f} degrees. "
        f"At the last: {last}."
    )
    for part, title, marks in (
        (FAULT, r"$\mathrm{not\ orthogonal\ by}$", {-15: "10^{-15}", -10: "10^{-10}", -5: "10^{-5}", 0: "1"}),
        (ERROR, r"$\mathrm{error\ (rad)}$", {-10: "10^{-10}", -5: "10^{-5}", 0: "1"}),
        (MARGIN, r"$\mathrm{margin\ to\ gimbal\ lock\ (degrees)}$", {0: "0", 90: "90"}),
    ):
        top, bottom, *_ = part
        drawing.label((0, 0, 0), title, "ink", ((LEFT + RIGHT) / 2, top - 13), 16)
        for second in range(0, int(SECONDS) + 1, 5):
            drawing.path("ML", [(_across(second), top), (_across(second), bottom)], "faint muted")
        for value, words in marks.items():
            drawing.path("ML", [(LEFT, _down(part, value)), (RIGHT, _down(part, value))], "faint muted")
            drawing.label((0, 0, 0), f"${words}$", "muted", (LEFT - 26, _down(part, value)), 14)
    for second in range(0, int(SECONDS) + 1, 5):
        drawing.label((0, 0, 0), f"${second}$", "muted", (_across(second), MARGIN[1] + 13), 14)
    drawing.label((0, 0, 0), r"$t\ \mathrm{(s)}$", "ink", (_across(17.5), MARGIN[1] + 15), 16)
    for part, values in ((FAULT, faults), (ERROR, errors)):
        for name, colour in COLOURS.items():
            _curve(drawing, times, np.log10(np.maximum(values[name], ROUNDING)), part, f"axis {colour}")
    _curve(drawing, times, margin, MARGIN, "ink")
    # What the figure says in its table, where curves only pass through on their way up.
    for name, words, place, middle in (
        ("matrix", "matrix", -120, -73),
        ("quaternion", "quaternion", -40, 19),
        ("angles", r"Euler\ angles", 64, 127),
    ):
        colour = COLOURS[name]
        drawing.path("ML", [(place, LEGEND), (place + 22, LEGEND)], f"axis {colour}")
        drawing.label((0, 0, 0), rf"$\mathrm{{{words}}}$", colour, (middle, LEGEND), 14)
    return drawing


def _words(value):
    if value >= 1e-3 or value < ROUNDING:
        return f"{value:.2g}" if value >= 1e-3 else "less than 10 to the -15"
    mantissa, exponent = f"{value:.1e}".split("e")
    return f"{mantissa} times 10 to the {int(exponent)}"


def _across(time):
    return LEFT + (RIGHT - LEFT) * time / SECONDS


def _down(part, value):
    top, bottom, least, most = part
    return bottom - (bottom - top) * (np.clip(value, least, most) - least) / (most - least)


def _curve(drawing, times, values, part, kind):
    drawing.path("M" + "L" * (len(times) - 1), np.stack([_across(times), _down(part, values)], axis=-1), kind)


# The bodies, along A.


def _ring(middle, along, across, count=28):
    turn = 2 * np.pi * np.arange(count + 1) / count
    return np.stack([middle + along * np.cos(turn), across * np.sin(turn), 0 * turn], axis=-1)


HEAD = _ring(0.45, 0.47, 0.36)
STRINGS = np.array(
    [
        (x, side * 0.36 * np.sqrt(1 - ((x - 0.45) / 0.47) ** 2), 0)
        for x in (0.12, 0.285, 0.45, 0.615, 0.78)
        for side in (-1, 1)
    ]
    + [(0.45 + side * 0.47 * np.sqrt(1 - (y / 0.36) ** 2), y, 0) for y in (-0.2, 0, 0.2) for side in (-1, 1)]
)
THROAT = np.array([(0.065, 0.206, 0), (-0.24, 0, 0), (0.065, -0.206, 0)])
HANDLE = np.array([(-0.24, 0, 0), (-0.85, 0, 0)])
RACKET = HEAD, THROAT, HANDLE
COVER = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1)])
LONGEST_EDGE = 1.4


def _edges(moments):
    """Return the edges of a uniform block: about each axis the moment is that of the two other edges squared."""
    edges = np.sqrt(np.maximum(sum(moments) / 2 - np.array(moments), 0))
    return LONGEST_EDGE * edges / edges.max()


def _cut(edges):
    """Return the outline of the widest cut through the middle of a block."""
    thin = np.argmin(edges)
    return np.roll(np.insert(COVER, 0, 0, axis=1), thin, axis=1) * edges / 2


def _draw_racket(drawing, dcm):
    front = dcm[2] @ drawing.view[2] > 0

    def handle():
        drawing.line(THROAT @ dcm, "A", "thick").line(HANDLE @ dcm, "A", "tube")

    if dcm[0] @ drawing.view[2] > 0:
        handle()
    drawing.area(HEAD[:-1] @ dcm, "A", 8 if front else 38, edge=False)
    drawing.path("ML" * (len(STRINGS) // 2), drawing.on_sheet(STRINGS @ dcm), "faint A")
    drawing.line(HEAD @ dcm, "A", "thick")
    if not dcm[0] @ drawing.view[2] > 0:
        handle()


def _draw_block(drawing, dcm, edges):
    # Cross products of the edges: the faces of a skewed box do not look along the rows.
    half = dcm * edges[:, None] / 2
    for k, fill in enumerate((26, 26, 8)):
        u, v = half[(k + 1) % 3], half[(k + 2) % 3]
        for side in (-1, 1):
            if side * np.cross(u, v) @ drawing.view[2] > 0:
                corners = side * half[k] + np.array([u + v, v - u, -u - v, u - v])
                drawing.area(corners, "A", 38 if k == 2 and side < 0 else fill)
