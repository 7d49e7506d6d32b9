"""The picture of the converter: the orientation that both sides describe."""

from ...vectors import IDENTITY

REACH = 1.25
SIZE = 112


def picture(sheet, dcm):
    sheet.triad("N", IDENTITY, length=REACH)
    sheet.triad("A", dcm)


def drawing(figure, Sheet):
    rows = [
        f"{name} at ({', '.join(f'{entry + 0:.2f}' for entry in row)})"
        for name, row in zip("xyz", figure.dcm)
    ]
    scalar, *vector = (f"{part + 0:.4f}" for part in figure.quaternion)
    sheet = Sheet(
        "The triad of frame N, and from the same origin the triad of A in the converted "
        f"orientation, whose quaternion, scalar first, is ({scalar}, {', '.join(vector)}). "
        f"Along N, a {', a '.join(rows)}. "
        f"The orientation is read from the {figure.source['form']} of {figure.source['program']} "
        f"and written as the {figure.target['form']} of {figure.target['program']}.",
        scale=SIZE,
    )
    return sheet.paint(picture, figure.dcm)
