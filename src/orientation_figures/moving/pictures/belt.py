"""The still of a plate on a belt."""

import math

import numpy as np

from orientation.quaternions import dcm_from_quaternion

from ...drawing import Drawing

# As in js/belt.js.
SIZE, LENGTH, WIDTH, PIECES, WALL, PLATE = 96, 3.0, 0.19, 72, (0.9, 0.06, 0.9), (0.62, 0.09, 0.44)


def belt(figure):
    """Return the frames along the belt, shape ``(n + 1, 3, 3)``, and their places, shape ``(n + 1, 3)``."""
    frames = dcm_from_quaternion([figure.quaternion_at(share) for share in np.linspace(0, 1, PIECES + 1)])
    steps = (frames[1:, 1] + frames[:-1, 1]) / 2 * LENGTH / PIECES
    return frames, np.array((0, -LENGTH / 2, 0)) + np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])


def drawing(figure):
    q = ", ".join(f"{entry:.2f}" for entry in figure.quaternion_at(1))
    frames, places = belt(figure)
    drawing = Drawing(
        f"A wall on the left, a plate on the right, and between them a belt with one side red and one blue. The plate "
        f"has been turned by {math.degrees(figure.angle):.0f} degrees about the line of the belt, and the belt has "
        f"been passed round it by {100 * figure.passed:.0f} per cent. Along the belt the quaternion goes from 1 at the "
        f"wall to ({q}) at the plate.",
        scale=SIZE,
    )
    toward, pieces = drawing.view[2], []
    for k in range(PIECES):
        edges = [places[k + m] + side * WIDTH * frames[k + m, 0] for m, side in ((0, -1), (0, 1), (1, 1), (1, -1))]
        front = frames[k, 2] @ toward > 0
        pieces.append((np.mean(edges, axis=0) @ toward, edges, "B" if front else "D"))
    wall, plate = (0, -LENGTH / 2 - 0.03, 0), places[-1] + 0.045 * frames[-1, 1]
    drawing.box(np.eye(3), WALL, wall, "N")
    before = [piece for piece in pieces if piece[0] < plate @ toward]
    for _, edges, colour in sorted(before, key=lambda piece: piece[0]):
        drawing.area(edges, colour, 38, edge=False)
    drawing.box(frames[-1], PLATE, plate, "A").triad("A", frames[-1], plate, 0.62, labels=("", "", ""))
    for _, edges, colour in sorted((p for p in pieces if p[0] >= plate @ toward), key=lambda piece: piece[0]):
        drawing.area(edges, colour, 38, edge=False)
    return drawing
