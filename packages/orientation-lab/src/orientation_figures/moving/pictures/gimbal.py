"""The picture of a camera gimbal."""

import math

from orientation.direction_cosines import simple_dcm

from ...vectors import AXES, IDENTITY, add, dot, in_degrees, length, multiply, scale

# Radii of the rings of B and C and of the camera, and the ends of the axes.
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


def picture(sheet, gimbal, close=False, lit=None):
    """Draw the gimbal.

    Near gimbal lock (``close``) the first and the third axis are emphasised. ``lit`` is the number
    that the reader touches.
    """
    B, C, D = gimbal["B"], gimbal["C"], gimbal["D"]
    at, axes = gimbal["at"], gimbal["axes"]

    def near(direction):
        return -1 if dot(direction, sheet.view[2]) < 0 else 1

    # The parts are shells about one centre, from the camera outwards. The near half of each covers
    # everything inside it.
    down = scale(-1, axes[0])
    sheet.layer = 6 * near(down)
    sheet.cylinder(scale(1.3, down), scale(1.86, down), 0.13, "A")
    sheet.cylinder(scale(1.13, down), scale(1.3, down), 0.2, "A")
    normals = [B[3 - at[0] - at[1]], C[3 - at[1] - at[2]]]
    for normal, radius, colour, layer in [[normals[0], OUTER, "B", 5], [normals[1], INNER, "C", 3]]:
        for half, side in [["back", -1], ["front", 1]]:
            sheet.layer = layer * side
            sheet.circle(normal, radius=radius, colour=colour, kind="tube", half=half)
    for axis, start, end, colour, layer in [
        [axes[1], INNER, OUTER, "B", 4],
        [axes[2], 0.2, INNER, "C", 2],
    ]:
        for side in [1, -1]:
            arm = scale(side, axis)
            sheet.layer = layer * near(arm)
            # Leave out the arm in front of the lens.
            if colour == "B" or side < 0 or at[2] != 1:
                sheet.line([scale(start, arm), scale(end, arm)], colour, "tube slim")
    # The lens looks along d_y, as in the essay.
    sheet.layer = 0
    sheet.box(D, CAMERA, colour="D")
    sheet.layer = 0.5 * near(D[1])
    sheet.cylinder(scale(CAMERA[1] / 2, D[1]), scale(0.5, D[1]), 0.15, "D")
    if near(D[1]) > 0:
        sheet.layer = 0.6
        sheet.circle(D[1], radius=0.09, origin=scale(0.5, D[1]), colour="D", kind="fill-38")
    # The axes outside the parts that they carry, with their positive senses.
    rests = [IDENTITY[at[1]], B[at[2]], C[at[1]]]
    for k, axis in enumerate(axes):
        same = close and k != 1
        colour = "accent" if same else "ink"
        for arm in [axis, scale(-1, axis)]:
            sheet.layer = 7 * near(arm)
            begin = (INNER if k == 2 else OUTER) + 0.1
            sheet.line([scale(begin, arm), scale(END, arm)], colour, "thick" if same else "guide")
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
    sheet.label_beyond(
        scale(OUTER, add(scale(0.64, B[at[0]]), scale(0.77, B[at[1]]))), "$B$", "B", 20
    )
    sheet.label_beyond(
        scale(INNER, add(scale(-0.71, C[at[1]]), scale(0.71, C[at[2]]))), "$C$", "C", 20
    )
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
        "A camera gimbal: a handgrip A, an outer ring B, an inner ring C and a camera D, each "
        f"turned from the frame before it about a shared axis: {spoken}. "
        f"The axes of psi and phi are {in_degrees(figure.margin)} apart. If they coincide, the "
        "gimbal is locked. "
        "Beside it are the triads of A and D.",
        view=view_from(math.radians(58), math.radians(22)),
        scale=SIZE,
    )
    return sheet.paint(
        picture, device(figure.angles, figure.sequence), figure.margin < math.radians(10)
    )
