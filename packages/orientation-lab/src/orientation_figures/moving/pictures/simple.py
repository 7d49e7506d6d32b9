"""The picture of a simple orientation."""

from ...vectors import AXES, IDENTITY, add, in_degrees, scale

REACH = 1.25
SIZE = 112
# The vane's corners, along the pointer and up.
VANE = (
    (-0.72, 0.5), (-0.5, 0.36), (0.4, 0.36), (0.4, 0.46), (0.68, 0.3),
    (0.4, 0.14), (0.4, 0.24), (-0.5, 0.24), (-0.72, 0.1), (-0.62, 0.3),
)  # fmt: skip


def picture(sheet, k, angle, dcm):
    """Draw the rotation; ``k`` is the index of the shared unit vector."""
    axis, pointer = IDENTITY[k], dcm[(k + 1) % 3]
    # The vane is upright on the shared unit vector, and seen edge-on when looking down that vector.
    sheet.area([add(scale(along, pointer), scale(up, axis)) for along, up in VANE], "A", 26)
    sheet.triad("N", IDENTITY, length=REACH)
    for m in [(k + 1) % 3, (k + 2) % 3]:
        sheet.arrow(dcm[m], colour="A", label=rf"$\hat{{a}}_{AXES[m]}$")
        sheet.turn(axis, angle, IDENTITY[m], radius=0.5, label=r"$\theta$", colour="accent")
    sheet.arrow(axis, colour="A")


def drawing(figure, Sheet):
    rows = [
        f"a {name} at ({', '.join(f'{entry:.2f}' for entry in row + 0.0)})"
        for name, row in zip("xyz", figure.dcm, strict=True)
    ]
    sheet = Sheet(
        "The triads of the frames N and A, drawn from one origin, and a weather vane fixed to A. "
        f"The frames share {figure.axis}, and A is turned about it through theta, "
        f"{in_degrees(figure.angle)}. "
        f"Along N, {', '.join(rows)}.",
        scale=SIZE,
    )
    return sheet.paint(picture, AXES.index(figure.axis), figure.angle, figure.dcm)
