"""The picture of a triad and its mirror image."""

from ...vectors import IDENTITY, scale

REACH = 1.0
SIZE = 76
APART = 1.3
LABELS = (r"$\hat{m}_x$", r"$\hat{m}_y$", r"$\hat{m}_z$")


def picture(sheet, rows, together):
    right, up = sheet.view[0], sheet.view[1]
    far = 0 if together else APART
    sheet.triad("N", IDENTITY, origin=scale(-far, right), length=REACH)
    if not together:
        sheet.line([scale(-1.2, up), scale(1.2, up)], "muted", "guide")
    sheet.triad("E", rows, origin=scale(far, right), labels=LABELS)


def drawing(figure, Sheet):
    rows = [
        f"m {name} at ({', '.join(f'{entry:.2f}' for entry in row)})"
        for name, row in zip("xyz", figure.rows)
    ]
    image = "its mirror image" if figure.image == "mirror" else "a copy of it"
    where = "over" if figure.together else "beside"
    sheet = Sheet(
        f"The right-handed triad of N, and {where} it {image}, with the arrows m x, m y and m z. "
        f"Along N these arrows are {', '.join(rows).replace('-0.00', '0.00')}.",
        scale=SIZE,
    )
    return sheet.paint(picture, figure.rows, figure.together)
