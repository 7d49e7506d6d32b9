"""The machines of the practical cases: an aircraft, a wrist, a satellite, a phone and a leg."""

import numpy as np

from orientation.axis_angle import dcm_from_axis_angle
from orientation.direction_cosines import simple_dcm
from orientation.euler_angles import dcm_from_body_fixed

from .drawing import Drawing, hatted, view_from
from .vectors import in_degrees

# The frame north, east, down by rows, along the north, west and up of these drawings.
NORTH_EAST_DOWN = np.diag([1.0, -1.0, -1.0])


def aircraft_drawing(bank=np.radians(30)):
    """Return a drawing of an airliner in a right turn, banked by ``bank`` radians, from ahead."""
    drawing = Drawing(
        "An airliner seen from the front and slightly above, banked to the right by "
        f"{in_degrees(bank)}. "
        "In its frame D, d x points out of the nose, d y along the right wing, which points down "
        "and to the left in the picture, and d z through the floor. "
        "Beside it is the frame N of the ground: x north, y east, z down.",
        view_from(np.radians(-38), np.radians(16)),
        92,
    )
    aircraft = simple_dcm("x", float(bank)) @ NORTH_EAST_DOWN

    def place(*points):
        return np.array(points, dtype=float) @ aircraft

    def surface(*corners):
        drawing.area(place(*corners), "D", 16)

    # From the farthest part to the nearest, for an aircraft that comes towards the reader.
    surface((-1.5, 0, -0.1), (-1.95, -0.62, -0.16), (-2.1, -0.62, -0.16), (-1.95, 0, -0.1))
    surface((-1.5, 0, -0.1), (-1.95, 0.62, -0.16), (-2.1, 0.62, -0.16), (-1.95, 0, -0.1))
    surface((-1.4, 0, -0.14), (-1.95, 0, -0.72), (-2.15, 0, -0.72), (-1.95, 0, -0.14))
    surface((0.35, 0, 0.1), (-0.75, 1.75, -0.04), (-1.0, 1.75, -0.04), (-0.4, 0, 0.1))
    drawing.cylinder(*place((-1.95, 0, -0.05), (-0.1, 0, 0)), 0.19, "D", 30)
    surface((0.35, 0, 0.1), (-0.75, -1.75, -0.04), (-1.0, -1.75, -0.04), (-0.4, 0, 0.1))
    drawing.cylinder(*place((-0.1, 0, 0), (1.0, 0, 0)), 0.19, "D", 30)
    nose = [(1.0 + 0.32 * np.sin(t), 0.19 * np.cos(t), 0) for t in np.linspace(0, np.pi, 9)]
    drawing.area(place(*nose), "D", 26)
    for side in (0.62, -0.62):
        drawing.cylinder(*place((-0.1, side, 0.2), (0.28, side, 0.2)), 0.1, "D")
    drawing.triad("D", aircraft, place((1.25, 0, 0))[0], 0.95)
    drawing.triad("N", NORTH_EAST_DOWN, -2.35 * drawing.view[0] - 0.35 * drawing.view[1], 0.75)
    return drawing


def wrist_drawing(angles=(0.3, 0.9, 0.4)):
    r"""Return a drawing of a robot's wrist, from forearm to gripper.

    Its ``angles`` (radians) are body fixed z-y-z.
    """
    drawing = Drawing(
        "A robot's wrist. "
        "The forearm, frame F, comes from below, and f z points along it. "
        "At its end a first joint turns about f z through psi, a second joint bends the wrist "
        "through theta about a perpendicular axis, and a third turns the gripper about its "
        "long axis through phi. "
        "The gripper, frame G, has two fingers, and g z points out between them. "
        "The three axes meet at one point.",
        view_from(np.radians(-48), np.radians(20)),
        104,
    )
    psi, theta, phi = (float(angle) for angle in angles)
    first = simple_dcm("z", psi)
    second = simple_dcm("y", theta) @ first
    gripper = simple_dcm("z", phi) @ second

    def place(frame, *points):
        return np.array(points, dtype=float) @ frame

    drawing.cylinder(*place(np.eye(3), (0, 0, -2.0), (0, 0, -0.95)), 0.3, "F", 30)
    drawing.line(place(np.eye(3), (0, 0, -0.95), (0, 0, 1.0)), "muted", "guide")
    drawing.cylinder(*place(first, (0, 0, -0.9), (0, 0, -0.55)), 0.26, "B")
    drawing.line(place(first, (0, -0.3, -0.55), (0, -0.3, 0)), "B", "tube")
    drawing.cylinder(*place(first, (0, -0.36, 0), (0, 0.36, 0)), 0.22, "C")
    drawing.line(place(first, (0, 0.3, -0.55), (0, 0.3, 0)), "B", "tube")
    drawing.cylinder(*place(second, (0, 0, 0.25), (0, 0, 0.8)), 0.17, "C")
    drawing.box(gripper, (0.5, 0.22, 0.16), place(gripper, (0, 0, 0.9))[0], "D")
    for side in (-0.2, 0.2):
        drawing.box(gripper, (0.08, 0.18, 0.42), place(gripper, (side, 0, 1.18))[0], "D")
    drawing.turn((0, 0, 1), 2.6, (0.5, -0.9, 0), 0.5, r"$\psi$", (0, 0, -0.75))
    drawing.turn(
        first[1], 2.2, first[0] - first[2], 0.42, r"$\theta$", place(first, (0, 0.5, 0))[0]
    )
    drawing.turn(
        second[2], 2.6, (0.5, -0.9, 0) @ second, 0.42, r"$\varphi$", place(second, (0, 0, 0.62))[0]
    )
    forearm = hatted("f")
    drawing.triad("F", np.eye(3), -1.6 * drawing.view[0] - 1.5 * drawing.view[1], 0.62, forearm)
    hand = hatted("g")
    return drawing.triad("D", gripper, -1.6 * drawing.view[0] + 0.35 * drawing.view[1], 0.62, hand)


def star_cameras_drawing(apart=np.radians(102)):
    """Return a drawing of a satellite with two star cameras at an angle of ``apart`` (radians)."""
    drawing = Drawing(
        "A satellite with two wings of solar cells and two star cameras on its body. "
        "Each camera is a short tube with a cone of view in front of it. "
        "The camera S looks along s z to the upper right, with s x and s y across its view. The "
        "camera T looks along t z to the upper left. "
        "Small dots are stars.",
        view_from(np.radians(-90), np.radians(14)),
        88,
    )
    for side in (-1, 1):
        panel = np.array(
            [
                (side * x, 0.25, y)
                for x, y in ((0.75, -0.28), (2.1, -0.28), (2.1, 0.28), (0.75, 0.28))
            ]
        )
        drawing.area(panel, "muted", 16)
        for x in (1.2, 1.65):
            drawing.line([(side * x, 0.25, -0.28), (side * x, 0.25, 0.28)], "muted", "faint")
        drawing.line([(side * 0.45, 0.2, 0), (side * 0.75, 0.25, 0)], "muted", "thick")
    drawing.box(np.eye(3), (0.9, 0.7, 0.8), colour="ink")
    random = np.random.default_rng(4)
    for side, letter, colour in ((1, "s", "A"), (-1, "t", "B")):
        along = np.array([side * np.sin(apart / 2), 0, np.cos(apart / 2)])
        mount = np.array([side * 0.4, 0, 0.4])
        across = np.array([0.0, -1.0, 0.0])
        third = np.cross(along, across)
        for edge in (-1, 1):
            drawing.line(
                [mount + 0.25 * along, mount + 2.1 * along + edge * 0.5 * third], colour, "guide"
            )
        drawing.circle(along, 0.5, mount + 2.1 * along, colour, "guide")
        for depth, y in zip(random.uniform(1.5, 2.2, 7), random.uniform(-0.2, 0.2, 7), strict=True):
            drawing.dot(mount + depth * (along + y * third), "ink", 2.5)
        drawing.cylinder(mount, mount + 0.4 * along, 0.15, colour)
        rows = np.array([across, third, along]) @ dcm_from_axis_angle(along, side * 0.9)
        drawing.triad(colour, rows, mount + 0.42 * along, 0.85, hatted(letter))
    return drawing


def phone_drawing(angles=(0.85, 0.6, 0.1), dip=np.radians(65)):
    """Return a drawing of a phone with the measurements of its two sensors.

    The phone is rotated by ``angles`` (radians, z-x-y).
    """
    drawing = Drawing(
        "A tilted phone above the ground. "
        "In its frame P, p x points to the right across the screen, p y towards its top edge, and "
        "p z out of the screen. "
        "An arrow straight up from the middle of the phone shows what the accelerometer measures. "
        f"Another, the magnetic field, points north, {in_degrees(dip)} below "
        "the horizontal. "
        "Up crossed with the field is horizontal and points west. "
        "Beside the phone is the frame E: x north, y west, z up.",
        view_from(np.radians(-60), np.radians(22)),
        118,
    )
    phone = dcm_from_body_fixed(angles, "zxy")
    field = np.array([np.cos(dip), 0, -np.sin(dip)])
    drawing.arrow(1.25 * field, colour="accent", label="field")
    drawing.box(phone, (0.72, 1.4, 0.09), colour="B")
    screen = [
        (x, y, 0.045) @ phone for x, y in ((-0.3, -0.58), (0.3, -0.58), (0.3, 0.58), (-0.3, 0.58))
    ]
    drawing.area(screen, "B", 8)
    drawing.triad("B", phone, length=0.95, labels=hatted("p"))
    drawing.arrow((0, 0, 1.3), colour="accent", label="up")
    drawing.arrow((0, 1.0, 0), colour="accent", label=r"up $\times$ field")
    drawing.line([(0, 0, 0), (np.cos(dip), 0, 0)], "muted", "guide")
    return drawing.triad("E", np.eye(3), -1.9 * drawing.view[0] - 0.55 * drawing.view[1], 0.6)


def leg_drawing(bend=np.radians(35)):
    """Return a drawing of a leg with four markers each on thigh and shank.

    The knee is bent by ``bend`` radians.
    """
    drawing = Drawing(
        "A leg seen from its right side, the knee bent. "
        "The thigh and the shank each carry a plate with four reflective markers. "
        "The thigh's frame A and the shank's frame B are drawn beside the knee: x forwards, y up "
        "along the bone, z to the right, towards the reader. "
        "The angle between the two is theta.",
        view_from(np.radians(-74), np.radians(10)),
        98,
    )
    # Along the picture: x forwards, z up. The thigh's frame is x forwards, y up, z to the right.
    level = np.array([[1.0, 0, 0], [0, 0, 1.0], [0, -1.0, 0]])
    thigh = simple_dcm("z", 0.3 * float(bend)) @ level
    shank = simple_dcm("z", -float(bend)) @ thigh

    def place(frame, *points):
        return np.array(points, dtype=float) @ frame

    def cluster(frame, height, letter):
        plate = [
            (-0.16, height - 0.2, 0.22),
            (0.16, height - 0.2, 0.22),
            (0.16, height + 0.2, 0.22),
        ]
        plate.append((-0.16, height + 0.2, 0.22))
        drawing.area(place(frame, *plate), letter, 26)
        for x, y, z in plate:
            drawing.dot(place(frame, (x, y, z + 0.08))[0], "ink", 6)

    drawing.cylinder(*place(thigh, (0, 1.55, 0), (0, 0.12, 0)), 0.24, "A", 20)
    foot = place(
        shank,
        (-0.2, -1.72, 0),
        (0.62, -1.72, 0),
        (0.6, -1.6, 0),
        (0.14, -1.42, 0),
        (-0.2, -1.45, 0),
    )
    drawing.area(foot, "B", 8)
    drawing.cylinder(*place(shank, (0, -0.12, 0), (0, -1.5, 0)), 0.19, "B", 20)
    drawing.cylinder(*place(thigh, (0, 0, -0.2), (0, 0, 0.2)), 0.21, "muted", 30)
    cluster(thigh, 0.85, "A")
    cluster(shank, -0.8, "B")
    beside = np.array([1.15, 0, 0.1])
    drawing.triad("A", thigh, beside + [0, 0, 0.55], 0.6)
    drawing.triad("B", shank, beside - [0, 0, 0.65], 0.6)
    drawing.line(place(thigh, (0, 0, 0.2), (0, -0.9, 0.2)), "muted", "guide")
    below = -thigh[1]
    return drawing.turn(-thigh[2], bend, below, 0.75, r"$\theta$", place(thigh, (0, 0, 0.2))[0])


def earth_drawing(longitude=np.radians(68), latitude=np.radians(38)):
    """Return a drawing of the Earth with its own frame and the two ground frames at one place."""
    drawing = Drawing(
        "The Earth as a sphere with its equator and one meridian. "
        "From its centre e z points to the north pole, e x to where the Greenwich meridian "
        "meets the equator, and e y to the equator 90 degrees further east. "
        f"At a place {in_degrees(longitude)} east and {in_degrees(latitude)} "
        "north there are two triads on the ground. "
        "G: g x east, g y north, g z straight up. "
        "N: n x north, n y east, n z down, into the Earth. "
        "The angle lambda runs along the equator from e x to the meridian of the place, and phi "
        "from there along the meridian to the place.",
        view_from(np.radians(48), np.radians(22)),
        150,
    )
    ground = dcm_from_body_fixed((longitude + np.pi / 2, np.pi / 2 - latitude, 0), "zxz")
    aviation = ground[[1, 0, 2]] * [[1], [1], [-1]]
    up = ground[2]
    meridian = np.array([np.cos(longitude), np.sin(longitude), 0])
    drawing.circle(drawing.view[2], 1.0, kind="fill-8")
    drawing.circle((0, 0, 1), 1.0)
    drawing.circle(np.cross((0, 0, 1), meridian), 1.0)
    drawing.triad("E", np.eye(3), length=1.3)
    drawing.line([(0, 0, 0), meridian], "muted", "guide")
    drawing.line([(0, 0, 0), up], "muted", "guide")
    drawing.turn((0, 0, 1), longitude, (1, 0, 0), 0.55, r"$\lambda$")
    drawing.turn(np.cross(meridian, (0, 0, 1)), latitude, meridian, 0.4, r"$\phi$")
    drawing.triad("C", ground, up, 0.55, hatted("g"))
    return drawing.triad(
        "N", aviation, up + 0.02 * ground[0], 0.42, shifts=[(16, 6), (4, 18), None]
    )
