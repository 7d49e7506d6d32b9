"""The picture of a plate on a belt."""

import math

from orientation.quaternions import dcm_from_quaternion

from ...vectors import IDENTITY, add, dot, in_degrees, scale

SIZE = 96
LENGTH = 3.0
WIDTH = 0.19
PIECES = 72
WALL = (0.9, 0.06, 0.9)
PLATE = (0.62, 0.09, 0.44)


def full_turns(angle):
    """Return the number of full rotations of the plate if it is 1 or 2, else 0."""
    numbers = [turns for turns in [1, 2] if abs(angle - 2 * math.pi * turns) < 1e-8]
    return numbers[0] if len(numbers) else 0


def quaternion_at(angle, passed, part):
    """Return the unit quaternion of the belt at a share of its length.

    Its first and last sixth stay straight, so that the plate keeps away from the wall.
    """
    share = min(1, max(0, 1.5 * part - 0.25))
    turns = full_turns(angle)
    if turns == 2:
        # Circles through 1 on the sphere of quaternions, from a great circle down to a point.
        tilt, way = passed * math.pi / 2, 2 * math.pi * share
        size = math.cos(tilt)
        return [
            1 - size * size * (1 - math.cos(way)), 0, size * math.sin(way),
            size * math.sin(tilt) * (1 - math.cos(way))
        ]  # fmt: skip
    # Half circles from 1 to -1, from one side to the other.
    tilt, half = passed * math.pi if turns == 1 else 0, angle * share / 2
    return [math.cos(half), 0, math.cos(tilt) * math.sin(half), math.sin(tilt) * math.sin(half)]


def belt(angle, passed):
    """Return the frames along the belt and their places."""
    frames = [
        dcm_from_quaternion(quaternion_at(angle, passed, k / PIECES)) for k in range(PIECES + 1)
    ]
    places = [[0, -LENGTH / 2, 0]]
    for k in range(PIECES):
        places.append(
            add(places[-1], scale(LENGTH / PIECES / 2, add(frames[k][1], frames[k + 1][1])))
        )
    return [frames, places]


def picture(sheet, angle, passed):
    frames, places = belt(angle, passed)
    toward, end = sheet.view[2], frames[-1]
    wall, plate = add(places[0], [0, -0.03, 0]), add(places[-1], scale(0.045, end[1]))
    sheet.layer = dot(wall, toward)
    sheet.box(IDENTITY, WALL, origin=wall, colour="N")
    for k in range(PIECES):
        corners = [
            add(places[k + m], scale(side * WIDTH, frames[k + m][0]))
            for m, side in [[0, -1], [0, 1], [1, 1], [1, -1]]
        ]
        sheet.layer = dot(add(*corners), toward) / 4
        sheet.area(corners, "B" if dot(frames[k][2], toward) > 0 else "D", 38, False)
    sheet.layer = dot(plate, toward)
    sheet.box(end, PLATE, origin=plate, colour="A")
    sheet.triad("A", end, origin=plate, length=0.62, labels=["", "", ""])


def drawing(figure, Sheet):
    q = ", ".join(f"{entry:.2f}" for entry in figure.quaternion_at(1))
    sheet = Sheet(
        "A wall on the left, a plate on the right, and between them a belt with a red side and a "
        "blue side. "
        f"The plate has been turned by {in_degrees(figure.angle)} about the line of "
        f"the belt, and the belt has been passed {100 * figure.passed:.0f} per cent of the way "
        "round it. "
        f"Along the belt the quaternion changes from 1 at the wall to ({q}) at the plate.",
        scale=SIZE,
    )
    return sheet.paint(picture, figure.angle, figure.passed)
