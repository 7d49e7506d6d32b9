"""The picture of a camera gimbal."""

import math

from orientation.direction_cosines import simple_dcm

from ...vectors import (
    AXES,
    IDENTITY,
    add,
    cross,
    dot,
    in_degrees,
    length,
    multiply,
    scale,
    unit,
)

# Radii of the arms B and C and of the camera, and the ends of the axes.
OUTER = 1.05
INNER = 0.76
CAMERA = (0.62, 0.44, 0.46)
END = 1.42
SIZE = 98
# The position of the triads of A and D, right and up.
INSET = (1.4, 1.1)
SYMBOLS = (r"$\psi$", r"$\theta$", r"$\varphi$")


def device(angles, sequence):
    """Return the frames as rows along A, the indices of the sequence's axes, and these axes."""
    B, b, c = [simple_dcm(axis, angle) for axis, angle in zip(sequence, angles)]
    C = multiply(b, B)
    D = multiply(c, C)
    at = [AXES.index(axis) for axis in list(sequence)]
    return {"B": B, "C": C, "D": D, "at": at, "axes": [IDENTITY[at[0]], B[at[1]], C[at[2]]]}


def half_ring(sheet, start, middle, radius, letter, layer):
    """Draw half a ring from the direction ``start`` by ``middle`` to the other side.

    It is divided where it passes from the near half of its shell to the far one.
    """
    normal = cross(start, middle)
    # Seen face on, the whole ring is equally near, and is divided at its middle.
    level = unit(add(cross(normal, sheet.view[2]), scale(1e-9, middle)))
    edge = scale(-1 if dot(level, middle) < 0 else 1, level)
    first = math.atan2(dot(cross(start, edge), normal), dot(start, edge))
    for begin, angle in [[start, first], [edge, math.pi - first]]:
        halfway = add(
            scale(math.cos(angle / 2), begin), scale(math.sin(angle / 2), cross(normal, begin))
        )
        sheet.layer = -layer if dot(halfway, sheet.view[2]) < 0 else layer
        sheet.turn(normal, angle, begin, radius=radius, colour=letter, kind="tube", head=False)


def picture(sheet, gimbal, close=False, lit=None):
    """Draw the gimbal.

    Near gimbal lock (``close``) the first and the third axis are emphasised. ``lit`` is the number
    that the reader touches.
    """
    B, C, D, at, axes = gimbal["B"], gimbal["C"], gimbal["D"], gimbal["at"], gimbal["axes"]

    def near(direction):
        return -1 if dot(direction, sheet.view[2]) < 0 else 1

    # The parts are shells about one centre, from the camera outwards. The near half of each covers
    # everything inside it.
    down = scale(-1, axes[0])
    sheet.layer = 6 * near(down)
    sheet.cylinder(scale(1.3, down), scale(1.86, down), 0.13, "A")
    sheet.cylinder(scale(1.13, down), scale(1.3, down), 0.2, "A")
    # As in the essay: a yoke on the grip, and an arm from the yoke's ends round the camera's back.
    half_ring(sheet, axes[1], down, OUTER, "B", 5)
    half_ring(sheet, axes[1], scale(-1, axes[2]), INNER, "C", 3)
    # Their motors, with the shafts that turn what comes next.
    for axis, sides, radius, inner, letter, layer in [
        [axes[1], [1, -1], OUTER, INNER, "B", 4],
        [axes[2], [-1], INNER, 0.2, "C", 2],
    ]:
        for out in [scale(side, axis) for side in sides]:
            sheet.layer = layer * near(out)
            sheet.line([scale(inner, out), scale(radius - 0.1, out)], letter, "tube slim")
            sheet.layer = (layer + 1.5) * near(out)
            sheet.cylinder(scale(radius - 0.12, out), scale(radius + 0.12, out), 0.14, letter)
    # The lens looks along d_y, as in the essay.
    sheet.layer = 0
    sheet.box(D, CAMERA, colour="D")
    sheet.layer = 0.5 * near(D[1])
    sheet.cylinder(scale(CAMERA[1] / 2, D[1]), scale(0.5, D[1]), 0.15, "D")
    sheet.layer = 0.6 * near(D[1])
    sheet.circle(D[1], radius=0.09, origin=scale(0.5, D[1]), colour="D", kind="fill-38")
    # The axes outside the parts that they carry, with their positive senses.
    rests = [IDENTITY[at[1]], B[at[2]], C[at[1]]]
    for k, axis in enumerate(axes):
        same = close and k != 1
        colour = "accent" if same else "ink"
        for arm in [axis, scale(-1, axis)]:
            sheet.layer = 7 * near(arm)
            sheet.line(
                [scale((OUTER if k == 1 else INNER) + 0.1, arm), scale(END, arm)],
                colour,
                "thick" if same else "guide",
            )
        # At lock the names of the two axes are side by side, even if the axes point opposite ways.
        end = scale(-END if same and dot(axis, axes[0]) < 0 else END, axis)
        sheet.layer = 7 * near(end)
        sheet.turn(axis, 4.4, rests[k], radius=0.16, origin=scale(0.9, end), colour=colour)
        place = sheet.on_sheet(end)
        out = length(place)
        outward = scale(17 / out, place) if out > 20 else [16, -16]
        sheet.layer = 8
        sheet.label(end, SYMBOLS[k], colour, add(outward, [22, 0]) if same and k == 2 else outward)
    if close:
        sheet.line([scale(-END, axes[0]), scale(END, axes[0])], "accent", "guide")
    sheet.label(scale(1.62, down), "$A$", "A", [24, 4])
    sheet.label(add(scale(-0.9, axes[0]), scale(0.9, axes[1])), "$B$", "B")
    # C stands inside its arm, on the side that the camera does not hide.
    sheet.label(add(scale(0.4 * near(axes[1]), axes[1]), scale(-0.4, axes[2])), "$C$", "C")
    sheet.label_beyond(scale(0.26, D[2]), "$D$", "D", 14)
    # The triads of A and D, which the matrix compares.
    corner = add(scale(INSET[0], sheet.view[0]), scale(INSET[1], sheet.view[1]))
    for letter, rows, index, reach in [["A", IDENTITY, 1, 0.54], ["D", D, 0, 0.3]]:
        for k, row in enumerate(rows):
            sheet.faded = lit is not None and lit[index] != k
            label = rf"$\hat{{{letter.lower()}}}_{AXES[k]}$"
            sheet.arrow(
                add(corner, scale(reach, row)), start=corner, colour=letter, label=label, size=17
            )
    sheet.faded = False


def drawing(figure, Sheet):
    from ...drawing import view_from

    spoken = ", ".join(
        f"{name} {in_degrees(angle)} about {axis}"
        for name, angle, axis in zip(("psi", "theta", "phi"), figure.angles, figure.sequence)
    )
    sheet = Sheet(
        "A camera gimbal: a handgrip A, an outer arm B, an inner arm C and a camera D, each "
        f"turned from the frame before it about a shared axis: {spoken}. "
        f"The axes of psi and phi are {in_degrees(figure.margin)} apart. If they coincide, the "
        "gimbal is locked. "
        "Beside it are the triads of A and D.",
        view=view_from(math.radians(58), math.radians(36)),
        scale=SIZE,
    )
    return sheet.paint(
        picture, device(figure.angles, figure.sequence), figure.margin < math.radians(10)
    )
