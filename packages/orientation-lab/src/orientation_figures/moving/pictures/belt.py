"""The picture of a plate on a belt."""

from orientation.quaternions import dcm_from_quaternion

from ...vectors import IDENTITY, add, dot, in_degrees, quaternion_at, scale

SIZE = 96
LENGTH = 3.0
WIDTH = 0.19
PIECES = 72
WALL = (0.9, 0.06, 0.9)
PLATE = (0.62, 0.09, 0.44)


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
