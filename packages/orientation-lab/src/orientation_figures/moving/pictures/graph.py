"""The picture of a graph of frames."""

from ...vectors import AXES, add, in_degrees, length, scale, subtract

SIZE = 96
REACH = 0.5
ACROSS = 100
DOWN = 100
LEFT = -130
SHORT = 14
CORNERS = ((-19, 18), (-19, -18), (19, 18), (19, -18))


def places(edges):
    """Return where each frame is drawn, in pixels to the right and down.

    The rows are the depths in the tree, and every leaf has a column.
    """
    children, depth, line, leaves = {"N": []}, {"N": 0}, {}, []
    names = ["N", *[edge[0] for edge in edges]]
    for edge in edges:
        frame, reference = edge[:2]
        children[reference].append(frame)
        children[frame] = []
        depth[frame] = depth[reference] + 1

    def walk(frame):
        for child in children[frame]:
            walk(child)
        if len(children[frame]):
            line[frame] = (line[children[frame][0]] + line[children[frame][-1]]) / 2
        else:
            line[frame] = len(leaves)
            leaves.append(frame)

    walk("N")
    across = min(ACROSS, 280 / max([1, *[depth[name] for name in names]]))
    down = min(DOWN, 190 / len(leaves))
    return {
        name: [LEFT + across * depth[name], down * (line[name] - (len(leaves) - 1) / 2)]
        for name in names
    }


def picture(sheet, edges, dcms, path):
    """Draw the frames with their matrices along N; the marked ``path`` is a list of frames."""
    spots = places(edges)
    names = ["N", *[edge[0] for edge in edges]]
    for edge in edges:
        frame, reference = edge[:2]
        on = frame in path and reference in path
        ends = [sheet.placed(*spots[reference]), sheet.placed(*spots[frame])]
        sheet.line(ends, "accent" if on else "muted", "thick" if on else "guide")
    sheet.layer = 1
    # Shorten the arrows where many frames crowd.
    near = [
        length(subtract(spots[name], spots[later]))
        for k, name in enumerate(names)
        for later in names[k + 1 :]
    ]
    reach = min(REACH, 0.44 * min(near) / SIZE)
    for name in names:
        place = sheet.placed(*spots[name])
        sheet.triad(name, dcms[name], origin=place, length=reach, labels=["", "", ""])
        tips = [sheet.on_sheet(scale(reach, row)) for row in dcms[name]]
        for k, row in enumerate(dcms[name]):
            # An arrow that points at the reader or away has no room for its letter.
            if length(tips[k]) > SHORT:
                sheet.label(add(place, scale(reach + 0.1, row)), f"${AXES[k]}$", name, [0, 0], 14)
        best, most = CORNERS[0], 0
        for corner in CORNERS:
            free = min([length(subtract(tip, corner)) for tip in tips])
            if free > most + 1e-6:
                best = corner
                most = free
        sheet.label(place, f"${name}$", name, best)


def drawing(figure, Sheet):
    words = "; ".join(
        f"{frame} is turned in {reference} through {in_degrees(angle)} about {axis}"
        for frame, reference, axis, angle in figure.edges
    )
    sheet = Sheet(
        "A tree of frames, each drawn as a small triad. "
        f"{words}. "
        f"The path from {figure.source} to {figure.target} is marked: {figure.path}.",
        scale=SIZE,
    )
    frames = figure.frames
    dcms = {name: frames.dcm(name, "N") for name in ("N", *(edge[0] for edge in figure.edges))}
    return sheet.paint(picture, figure.edges, dcms, figure.path.split(" - "))
