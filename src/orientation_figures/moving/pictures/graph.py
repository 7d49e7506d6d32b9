"""The still of a graph of frames."""

import math
from itertools import combinations

import numpy as np

from ...drawing import Drawing

SIZE, REACH = 96, 0.5  # as in js/graph.js
ACROSS, DOWN, LEFT = 100, 100, -130
SHORT, CORNERS = 14, ((-19, 18), (-19, -18), (19, 18), (19, -18))


def places(edges):
    """Return where each frame is drawn, pixels to the right and down: its depth in the tree, and its line."""
    children, depth = {"N": []}, {"N": 0}
    for frame, reference, *_ in edges:
        children[reference].append(frame)
        children[frame], depth[frame] = [], depth[reference] + 1
    line, used = {}, 0

    def walk(frame):
        nonlocal used
        for child in children[frame]:
            walk(child)
        if children[frame]:
            line[frame] = (line[children[frame][0]] + line[children[frame][-1]]) / 2
        else:
            line[frame], used = used, used + 1

    walk("N")
    across = min(ACROSS, 280 / max(max(depth.values()), 1))
    down = min(DOWN, 190 / used)
    return {name: (LEFT + across * depth[name], down * (line[name] - (used - 1) / 2)) for name in depth}


def drawing(figure):
    words = "; ".join(
        f"{frame} is turned in {reference} about {axis} by {math.degrees(angle):.0f} degrees"
        for frame, reference, axis, angle in figure.edges
    )
    drawing = Drawing(
        f"A tree of frames, each drawn as a small triad. {words}. The path from {figure.source} to {figure.target} is "
        f"marked: {figure.path}.",
        scale=SIZE,
    )
    spots, frames, path = places(figure.edges), figure.frames, figure.path.split(" - ")
    at = {name: np.array((x, -y, 0)) / SIZE @ drawing.view for name, (x, y) in spots.items()}
    for frame, reference, *_ in figure.edges:
        on = {frame, reference} <= set(path)
        drawing.line([at[reference], at[frame]], "accent" if on else "muted", "thick" if on else "guide")
    near = [math.dist(one, other) for one, other in combinations(spots.values(), 2)]
    reach = min(REACH, 0.44 * min(near) / SIZE)
    for name, place in at.items():
        colour, dcm = name if name in "NABCD" else "E", frames.dcm(name, "N")
        drawing.triad(colour, dcm, place, reach, labels=("", "", ""))
        tips = drawing.on_sheet(reach * dcm)
        for axis, row, tip in zip("xyz", dcm, tips):
            if math.hypot(*tip) > SHORT:  # an arrow that points at the reader or away has no room for its letter
                drawing.label(place + (reach + 0.1) * row, f"${axis}$", colour, size=14)
        corner = max(CORNERS, key=lambda corner: round(min(math.dist(tip, corner) for tip in tips), 6))
        drawing.label(place, f"${name}$", colour, corner, 20)
    return drawing
