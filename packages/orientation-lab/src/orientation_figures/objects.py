"""Objects that the book draws more than once: plane figures, an eye, a book."""

import numpy as np

from orientation.direction_cosines import simple_dcm

from .animation import Animation, one_after_another
from .drawing import Drawing, looking_down


def draw_eye(drawing, point, size=40, colour="ink"):
    """Draw an eye, ``size`` pixels wide, that looks to the right."""

    def place(points):
        return drawing.on_sheet(point) + size * np.array(points)

    drawing.path(
        "MQQ", place([(-0.5, 0), (0, -0.62), (0.5, 0.05), (0, 0.45), (-0.5, 0)]), f"paper {colour}"
    )
    for x, y, outward in ((-0.3, -0.22, -0.12), (-0.05, -0.31, -0.02), (0.2, -0.24, 0.1)):
        drawing.path("ML", place([(x, y), (x + outward, y - 0.15)]), colour)
    return drawing.dot(point, "muted", 0.19 * size).dot(point, colour, 0.09 * size)


def draw_book(drawing, dcm, origin=(0, 0, 0), colour="A", size=(0.8, 1.1, 0.22)):
    """Draw a closed book; the rows of ``dcm`` point across, up, and out of the cover."""
    rows, (width, height, depth) = np.asarray(dcm, dtype=float), size
    drawing.box(rows, size, origin, colour)
    if rows[2] @ drawing.view[2] > 0:
        for y, half in ((0.28, 0.28), (0.14, 0.2)):
            ends = np.array(
                [(-half * width, y * height, depth / 2), (half * width, y * height, depth / 2)]
            )
            drawing.line(origin + ends @ rows, colour, "thick")
    return drawing


def plane_drawing(axis, angle, first="N", second="A", name="theta", components=False, scale=185):
    """Return a drawing of two frames that share an axis, seen down that axis.

    Parameters
    ----------
    axis : {'x', 'y', 'z', '-x', '-y', '-z'}
        The direction about which the angle is positive; it points at the reader.
    angle : float
        Radians.
    first, second : str
        Letters of the two frames; the second is rotated from the first.
    name : str
        The Greek letter of the angle, such as 'theta'; 'phi' is typeset as in the text.
    components : bool
        Whether to drop the tips onto the arrows of the first frame, and to mark their feet.

    Returns
    -------
    Drawing
    """
    shared, away = axis[-1], axis.startswith("-")
    view, turn = looking_down(shared), simple_dcm(shared, -float(angle) if away else float(angle))
    if away:
        view = view[[1, 0, 2]] * [[1], [1], [-1]]
    right, up = ("xyz"[np.argmax(row)] for row in view[:2])
    old, new = first.lower(), second.lower()
    alt = (
        f"Looking down the {axis} axis that the frames {first} and {second} share. {old} "
        f"{shared} and {new} {shared} point "
        + (
            "away from the reader, drawn as a circle with a cross. "
            if away
            else "at the reader, drawn as a circle with a dot. "
        )
        + f"{old} {right} points to the right and {old} {up} up. "
        f"{new} {right} is turned counterclockwise from {old} {right} through {name}, and {new} "
        f"{up} from {old} {up} through the same angle."
    )
    if components:
        alt += (
            f" The shadows of {new} {right} on the arrows of {first} are cosine {name} along {old} "
            f"{right} and sine {name} along {old} {up}. Those of {new} {up} are minus sine {name} "
            f"along {old} {right} and cosine {name} along {old} {up}."
        )
    drawing = Drawing(alt, view, scale)
    symbol = r"\varphi" if name == "phi" else "\\" + name
    # Row k of the second frame's matrix is its k-th unit vector.
    (x, y), (tip, top) = view[:2], view[:2] @ turn
    if components:
        for end in (tip, top):
            drawing.line([end @ x * x, end, end @ y * y], "muted", "guide")
        drawing.line([(0, 0, 0), top @ x * x], "muted")
        for end, along, words, shift in (
            (tip, x, r"\cos", (-6, 18)),
            (tip, y, r"\sin", (32, 16)),
            (top, y, r"\cos", (36, 3)),
            (top, x, r"-\sin", (-4, 18)),
        ):
            foot = end @ along * along
            drawing.dot(foot, "muted", 3).label(foot, f"${words}{symbol}$", "muted", shift, 18)
    for letter, dcm in ((first, np.eye(3)), (second, turn)):
        drawing.triad(
            letter,
            dcm,
            labels=[
                None if axis_of_label == shared else rf"$\hat{{{letter.lower()}}}_{axis_of_label}$"
                for axis_of_label in "xyz"
            ],
        )
    drawing.arc(x, tip, 0.44, f"${symbol}$").arc(y, top, 0.44, f"${symbol}$")
    return drawing.arrow(
        np.eye(3)["xyz".index(shared)],
        colour=second,
        shift=(-40, 32),
        label=rf"$\hat{{{old}}}_{shared} = \hat{{{new}}}_{shared}$",
    )


TURNING_FRAMES_ALT = (
    "Four frames, each drawn at its own place: A gold with solid arrows, B red with dashed "
    "arrows, C green with dash-dotted arrows, D blue with dotted arrows. At first they are "
    "aligned, x towards the reader and to the left, y to the right, z up. First B, C and D turn "
    "together through 50 degrees, while their z arrows do not move. Then C and D turn "
    "together through 45 degrees, while their x arrows do not move. Last, D turns alone "
    "through 40 degrees, while its z arrow, no longer upright, does not move. Seen from the "
    "tip of the arrow that does not move, each rotation is counterclockwise. The still picture "
    "shows the end. With each frame a thin grey triad shows the frame before it in the order A, B, "
    "C, D, and curved arrows lead from the grey arrows to the turned arrows."
)


def turning_frames_animation():
    """Return the animation of four frames rotated in succession, for the exercise on Euler angles.

    The rotations are stored here, so that the page of the exercise does not reveal its answer.

    Returns
    -------
    Animation
    """
    angles, sequence = np.radians((50, 45, 40)), "zxz"

    def draw(progress):
        drawing = Drawing(TURNING_FRAMES_ALT, scale=92)
        dcm = np.eye(3)
        for number, letter in enumerate("ABCD"):
            place = 2.75 * (number % 2) * drawing.view[0] - 2.45 * (number // 2) * drawing.view[1]
            if number:
                axis, angle = sequence[number - 1], one_after_another(angles, progress)[number - 1]
                before, dcm = dcm, simple_dcm(axis, angle) @ dcm
                for row, name in zip(before, "xyz"):
                    drawing.line([place, place + row], "muted")
                    if name != axis:
                        drawing.turn(
                            before["xyz".index(axis)], angle, row, 0.8, origin=place, colour="muted"
                        )
            drawing.triad(letter, dcm, place)
        return drawing

    return Animation(
        draw,
        [
            ("B, C and D turn together", "; the z arrows of B, C and D stay where they are"),
            ("C and D turn together", "; the x arrows of C and D stay where they are"),
            ("D turns alone", "; the z arrow of D stays where it is"),
        ],
    )
