"""The pictures of a tumbling body: the body itself, and the plots of the growth of the drift."""

import math

from ...vectors import AXES, IDENTITY, add, cross, dot, length, scale, subtract, times, transpose

# Principal moments of inertia about a_x, a_y and a_z in g m^2; only their ratios matter. The
# racket's are those that Brody (1985) measured, rounded; its a_x runs along its handle and a_z out
# of its face. The book's a_x runs along its long edges.
MOMENTS = {"racket": (1.2, 16.0, 17.0), "book": (6.9, 13.3, 19.7)}
SECONDS = 20.0
# Seconds between two points of a curve.
SAMPLE = 0.1
# Smaller values are rounding errors, which depend on the processor, and are drawn here.
ROUNDING = 1e-15
SIZE = 118
# The largest length of an arrow.
LONGEST = 1.25
COLOURS = {"matrix": "A", "quaternion": "D", "angles": "C"}
LEFT = -128
RIGHT = 168
# Top, bottom, value at the bottom and at the top of each part of the plot.
FAULT = (24, 124, -16, 2)
ERROR = (156, 256, -12, 1)
MARGIN = (288, 324, 0, 90)
_LEGEND = 104
# The bodies, along A.
HEAD = [
    [0.45 + 0.47 * math.cos(math.pi * k / 14), 0.36 * math.sin(math.pi * k / 14), 0]
    for k in range(29)
]
STRINGS = [
    *[
        [x, side * 0.36 * math.sqrt(1 - ((x - 0.45) / 0.47) ** 2), 0]
        for x in [0.12, 0.285, 0.45, 0.615, 0.78]
        for side in [-1, 1]
    ],
    *[
        [0.45 + side * 0.47 * math.sqrt(1 - (y / 0.36) ** 2), y, 0]
        for y in [-0.2, 0, 0.2]
        for side in [-1, 1]
    ],
]
THROAT = ((0.065, 0.206, 0), (-0.24, 0, 0), (0.065, -0.206, 0))
HANDLE = ((-0.24, 0, 0), (-0.85, 0, 0))
# The widest section through the middle of a block.
COVER = ((-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1))
LONGEST_EDGE = 1.4


def body_of(moments):
    """Return the name of the body that has these moments of inertia."""
    names = [name for name in ["racket", "book"] if length(subtract(MOMENTS[name], moments)) == 0]
    return names[0] if len(names) else "block"


def edges_of(moments):
    """Return the edges of a uniform block.

    The moment about each axis is proportional to the sum of the squares of the two other edges.
    """
    edges = [math.sqrt(max(sum(moments) / 2 - moment, 0)) for moment in moments]
    return scale(LONGEST_EDGE / max(edges), edges)


def outlines_of(moments):
    if body_of(moments) == "racket":
        return [HEAD, THROAT, HANDLE]
    edges = edges_of(moments)
    thin = edges.index(min(edges))
    return [
        [
            [[0, u, v][(k - thin + 3) % 3] * edge / 2 for k, edge in enumerate(edges)]
            for u, v in COVER
        ]
    ]


def placed(points, dcm):
    """Return components along N of points along A.

    The rows of the matrix are A's unit vectors, orthogonal or not.
    """
    columns = transpose(dcm)
    return [times(columns, point) for point in points]


def picture(sheet, moments, dcm, reference, momentum):
    sheet.triad("N", IDENTITY, origin=sheet.placed(-136, 108), length=0.28)
    sheet.layer = 1
    sheet.arrow(scale(1.4, momentum), colour="accent", label=r"$\mathbf{H}$")
    # A body that has grown beyond the sheet is drawn smaller, with its true size beside it.
    sheet.size = SIZE * min(1, LONGEST / max([length(row) for row in dcm]))
    if body_of(moments) == "racket":
        racket(sheet, dcm)
    else:
        block(sheet, dcm, edges_of(moments))
    for k, row in enumerate(dcm):
        sheet.layer = 1.5 if k == 2 and dot(row, sheet.view[2]) <= 0 else 5
        sheet.arrow(row, colour="A", label=rf"$\hat{{a}}_{AXES[k]}$")
    sheet.layer = 6
    for outline in outlines_of(moments):
        sheet.line(placed(outline, reference), "muted", "guide")


def racket(sheet, dcm):
    sheet.layer = 2 if dot(dcm[0], sheet.view[2]) > 0 else 4
    sheet.line(placed(THROAT, dcm), "A", "thick")
    sheet.line(placed(HANDLE, dcm), "A", "tube")
    sheet.layer = 3
    sheet.area(placed(HEAD[:-1], dcm), "A", 8 if dot(dcm[2], sheet.view[2]) > 0 else 38, False)
    sheet.layer = 3.1
    sheet.path(
        "MLMLMLMLMLMLMLML", [sheet.on_sheet(point) for point in placed(STRINGS, dcm)], "faint A"
    )
    sheet.layer = 3.2
    sheet.line(placed(HEAD, dcm), "A", "thick")


def block(sheet, dcm, edges):
    half = [scale(edges[k] / 2, row) for k, row in enumerate(dcm)]
    sheet.layer = 3
    for k, fill in enumerate([26, 26, 8]):
        u, v = half[(k + 1) % 3], half[(k + 2) % 3]
        for side in [-1, 1]:
            # Use cross products of the edges, because the faces of a skewed box are not normal to
            # the rows.
            if side * dot(cross(u, v), sheet.view[2]) > 0:
                corners = [add(u, v), subtract(v, u), scale(-1, add(u, v)), subtract(u, v)]
                faces = [add(scale(side, half[k]), corner) for corner in corners]
                sheet.area(faces, "A", 38 if k == 2 and side < 0 else fill)


def across(time):
    return LEFT + (RIGHT - LEFT) * time / SECONDS


def down(part, value):
    top, bottom, least, most = part
    return bottom - (bottom - top) * (max(least, min(most, value)) - least) / (most - least)


def axes(sheet):
    """Draw the axes of the plots, without their curves."""
    origin = [0, 0, 0]
    for part, title, marks in [
        [
            FAULT,
            r"$\mathrm{departure\ from\ orthogonality}$",
            [[-15, "$10^{-15}$"], [-10, "$10^{-10}$"], [-5, "$10^{-5}$"], [0, "$1$"]],
        ],
        [ERROR, r"$\mathrm{error\ (rad)}$", [[-10, "$10^{-10}$"], [-5, "$10^{-5}$"], [0, "$1$"]]],
        [MARGIN, r"$\mathrm{margin\ to\ gimbal\ lock\ (degrees)}$", [[0, "$0$"], [90, "$90$"]]],
    ]:
        top, bottom = part[:2]
        sheet.label(origin, title, "ink", [(LEFT + RIGHT) / 2, top - 13], 16)
        for second in [0, 5, 10, 15, 20]:
            sheet.path("ML", [[across(second), top], [across(second), bottom]], "faint muted")
        for value, words in marks:
            sheet.path("ML", [[LEFT, down(part, value)], [RIGHT, down(part, value)]], "faint muted")
            sheet.label(origin, words, "muted", [LEFT - 26, down(part, value)], 14)
    for second in [0, 5, 10, 15, 20]:
        sheet.label(origin, f"${second}$", "muted", [across(second), MARGIN[1] + 13], 14)
    sheet.label(origin, r"$t\ \mathrm{(s)}$", "ink", [across(17.5), MARGIN[1] + 15], 16)


_DESCRIPTIONS = {
    "matrix": "direction cosine matrix",
    "quaternion": "quaternion",
    "angles": "Euler angles",
}
_METHODS = {"Euler": "Euler", "Runge-Kutta": "Runge-Kutta", "exponential": "exponential (Magnus)"}


def drawing(figure, Sheet):
    import numpy as np

    from orientation.quaternions import dcm_from_quaternion

    from ..tumbling import error_of, fault_of, momentum

    dcm, run = figure.dcm, figure.run()
    fault, error = (
        curve[-1] for curve in (fault_of(dcm[None]), error_of(dcm[None], run["reference"][-1:]))
    )
    lengths = ", ".join(f"{length:.2f}" for length in np.linalg.norm(dcm, axis=1))
    restored = "restored after every step" if figure.restored else "not restored"
    middle = sorted(figure.moments)[1] == figure.moments["xyz".index(figure.axis)]
    times = {0: "has not flipped yet" if middle else "does not flip", 1: "has flipped once"}.get(
        figure.flips, f"has flipped {figure.flips} times"
    )
    sheet = Sheet(
        f"A {figure.body} that spins freely about its {figure.axis} axis, with moments of "
        f"inertia {', '.join(f'{moment:g}' for moment in figure.moments)} g m^2 about x, y and z, "
        f"and its triad A after {run['time'][-1]:.1f} seconds, computed with the "
        f"{_DESCRIPTIONS[figure.description]} by the {_METHODS[figure.method]} method in steps of "
        f"{1000 * figure.step:g} milliseconds, {restored}. It {times}. The unit vectors of A, "
        f"which should have length 1, have lengths {lengths}. The matrix departs from "
        f"orthogonality by {_words(fault)}, and the orientation is wrong by {_words(error)} "
        "radians. The dashed reference was computed with steps ten times finer, and every "
        "description uses the angular velocity of those steps. The arrow H is the angular "
        "momentum, which keeps its direction. The triad of N is in the corner.",
        scale=SIZE,
    )
    reference = dcm_from_quaternion(run["reference"][-1])
    return sheet.paint(picture, figure.moments, dcm, reference, momentum(run, figure.moments))


def plot(figure, Sheet):
    """Return the ``Drawing`` of the growth of the drift up to ``time``."""
    import numpy as np

    from orientation.euler_angles import body_fixed_from_dcm, gimbal_lock_margin
    from orientation.quaternions import dcm_from_quaternion

    from ..tumbling import error_of, fault_of, matrices

    def curve(part, values, kind):
        points = [[across(time), down(part, value)] for time, value in zip(times, values)]
        sheet.path("M" + "L" * (len(points) - 1), points, kind)

    run, every = figure.run(), max(1, round(SAMPLE / figure.step))
    times, reference = run["time"][::every], run["reference"][::every]
    curves = {name: matrices(run, name, slice(None, None, every)) for name in _DESCRIPTIONS}
    faults = {name: fault_of(curve) for name, curve in curves.items()}
    errors = {name: error_of(curve, reference) for name, curve in curves.items()}
    angles = body_fixed_from_dcm(dcm_from_quaternion(run["reference"]), "zxy")
    margins = np.degrees(gimbal_lock_margin(angles, "zxy"))
    margin = np.array(
        [margins[max(0, k - every + 1) : k + 1].min() for k in range(0, len(margins), every)]
    )
    last = "; ".join(
        f"{title}, departure from orthogonality {_words(faults[name][-1])}, error "
        f"{_words(errors[name][-1])} radians"
        for name, title in _DESCRIPTIONS.items()
    )
    sheet = Sheet(
        f"Three plots over the {SECONDS:.0f} seconds of the run, which has reached "
        f"{times[-1]:.1f} seconds. "
        "The top plot shows, on a logarithmic scale, how far each description departs from "
        "orthogonality. The middle plot shows its error relative to the reference. The bottom "
        "plot shows how far the Euler angles are from gimbal lock: never less than "
        f"{margin.min():.0f} degrees. "
        f"At the end: {last}."
    )
    sheet.paint(axes)
    for part, values in ((FAULT, faults), (ERROR, errors)):
        for name, colour in COLOURS.items():
            curve(part, np.log10(np.maximum(values[name], ROUNDING)), f"axis {colour}")
    curve(MARGIN, margin, "ink")
    # The values in the figure's table, at points that the curves only pass on their way up.
    for name, words, place, middle in (
        ("matrix", "matrix", -120, -73),
        ("quaternion", "quaternion", -40, 19),
        ("angles", r"Euler\ angles", 64, 127),
    ):
        colour = COLOURS[name]
        sheet.path("ML", [(place, _LEGEND), (place + 22, _LEGEND)], f"axis {colour}")
        sheet.label((0, 0, 0), rf"$\mathrm{{{words}}}$", colour, (middle, _LEGEND), 14)
    return sheet


def _words(value):
    if value >= 1e-3 or value < ROUNDING:
        return f"{value:.2g}" if value >= 1e-3 else "less than 10 to the -15"
    mantissa, exponent = f"{value:.1e}".split("e")
    return f"{mantissa} times 10 to the {int(exponent)}"
