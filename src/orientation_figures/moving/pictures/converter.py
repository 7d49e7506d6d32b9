"""The still of the converter: the orientation that both sides describe."""

import numpy as np

from ...drawing import Drawing

REACH, SIZE = 1.25, 112  # as in js/converter.js


def drawing(figure):
    rows = [f"{name} at ({', '.join(f'{entry + 0:.2f}' for entry in row)})" for name, row in zip("xyz", figure.dcm)]
    scalar, *vector = (f"{part + 0:.4f}" for part in figure.quaternion)
    drawing = Drawing(
        "The triad of frame N, and from the same origin the triad of A, in the orientation that is converted: its "
        f"quaternion, scalar first, is ({scalar}, {', '.join(vector)}). Along N, a {', a '.join(rows)}. It is read "
        f"from the {figure.source['form']} of {figure.source['program']} and written as the "
        f"{figure.target['form']} of {figure.target['program']}.",
        scale=SIZE,
    )
    return drawing.triad("N", REACH * np.eye(3)).triad("A", figure.dcm)
