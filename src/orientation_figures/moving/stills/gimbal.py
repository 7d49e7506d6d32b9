"""The still of a camera gimbal."""

import math

import numpy as np

from orientation.direction_cosines import AXES, simple_dcm

from ...drawing import ROUND, Drawing, view_from

# Radii of the rings of B and C, the camera, where the axes end: as in js/gimbal.js.
OUTER, INNER, CAMERA, END, SIZE = 1.05, 0.76, (0.62, 0.44, 0.46), 1.42, 98
INSET = (1.4, 1.1)  # the triads of A and D, right and up
VIEW = view_from(np.radians(58), np.radians(22))


def drawing(figure):
    A = np.eye(3)
    turns = [simple_dcm(axis, angle) for axis, angle in zip(figure.sequence, figure.angles)]
    B, C, D = turns[0], turns[1] @ turns[0], turns[2] @ turns[1] @ turns[0]
    first, second, third = (AXES.index(axis) for axis in figure.sequence)
    axes = (A[first], B[second], C[third])
    spoken = ", ".join(
        f"{name} {math.degrees(angle):.0f} degrees about {axis}"
        for name, angle, axis in zip(("psi", "theta", "phi"), figure.angles, figure.sequence)
    )
    drawing = Drawing(
        "A camera gimbal: a handgrip A, an outer ring B, an inner ring C and a camera D, each turned from the "
        f"one before about an axis that both share: {spoken}. The axes of psi and phi are "
        f"{math.degrees(figure.margin):.0f} degrees apart; at 0 the gimbal is locked. Beside it stand the triads "
        "of A and D.",
        VIEW,
        SIZE,
    )
    toward = VIEW[2]

    def ring(normal, radius, colour, near):
        # The half of the circle that is nearer to the reader, or the one that is farther.
        across = np.cross(normal, toward)
        across = across / (np.linalg.norm(across) or 1)
        up = np.cross(across, normal)
        u, v = (
            drawing.on_sheet(radius * across),
            (1 if (up @ toward > 0) == near else -1) * drawing.on_sheet(radius * up),
        )
        points = [u, u + ROUND * v, v + ROUND * u, v, v - ROUND * u, ROUND * v - u, -u]
        for kind in ("tube", "tube core"):
            drawing.path("MCC", points, f"{kind} {colour}")

    marks = []  # (layer, what to draw): shells about one centre, as in js/gimbal.js

    def add(layer, direction, method, *arguments):
        marks.append((layer * (1 if direction @ toward >= 0 else -1), method, arguments))

    down = -axes[0]
    add(6, down, drawing.cylinder, 1.3 * down, 1.86 * down, 0.13, "A")
    add(6, down, drawing.cylinder, 1.13 * down, 1.3 * down, 0.2, "A")
    for normal, radius, colour, layer in (
        (np.cross(A[first], B[second]), OUTER, "B", 5),
        (np.cross(B[second], C[third]), INNER, "C", 3),
    ):
        marks += [(-layer, ring, (normal, radius, colour, False)), (layer, ring, (normal, radius, colour, True))]
    for axis, start, end, colour, layer in ((axes[1], INNER, OUTER, "B", 4), (axes[2], 0.2, INNER, "C", 2)):
        for arm in (axis, -axis):
            if colour == "B" or arm is not axis or third != 1:  # not before the lens
                add(layer, arm, drawing.line, [start * arm, end * arm], colour, "thick")
    marks.append((0, drawing.box, (D, CAMERA, (0, 0, 0), "D")))
    add(0.5, D[1], drawing.cylinder, CAMERA[1] / 2 * D[1], 0.5 * D[1], 0.15, "D")
    if D[1] @ toward > 0:
        marks.append((0.6, drawing.circle, (D[1], 0.09, 0.5 * D[1], "D", "fill-38")))
    for axis, start in zip(axes, (OUTER, OUTER, INNER)):
        for arm in (axis, -axis):
            add(7, arm, drawing.line, [(start + 0.1) * arm, END * arm], "ink", "guide")
    for _, method, arguments in sorted(marks, key=lambda mark: mark[0]):
        method(*arguments)
    rests = (A[second], B[third], C[second])
    for axis, rest, symbol in zip(axes, rests, (r"$\psi$", r"$\theta$", r"$\varphi$")):
        drawing.turn(axis, 4.4, rest, 0.16, origin=0.9 * END * axis)
        tip = drawing.on_sheet(END * axis)
        drawing.label(END * axis, symbol, "ink", 17 * tip / (np.linalg.norm(tip) or 1))
    for letter, point, far in (
        ("A", 1.62 * down, 0),
        ("B", OUTER * (0.64 * B[first] + 0.77 * B[second]), 20),
        ("C", 0.71 * INNER * (C[second] - C[third]), 20),
        ("D", 0.26 * D[2], 14),
    ):
        place = drawing.on_sheet(point)
        drawing.label(point, f"${letter}$", letter, far * place / (np.linalg.norm(place) or 1) if far else (24, 4))
    corner = np.array(INSET) @ VIEW[:2]
    return drawing.triad("A", A, corner, 0.54).triad("D", D, corner, 0.3)
