"""Draw a scene of the essay on paper: flat faces, the farthest first.

A scene is the result of ``js/scene.js`` for a state: shapes with their places and colours. The page
renders it with light and gloss; here every face has one of a few tones of its colour, so that it is
legible in light, in dark and on paper.
"""

from html import escape

import numpy as np

from ..drawing import typeset

TONES = 6
# Parts that are no thicker than this are drawn as lines.
THIN = 0.032
# Fainter parts are drawn as lines, too, because nobody can see faces in them.
FAINT = 0.5
# An edge with a smaller bevel looks sharp on paper.
FINEST_BEVEL = 0.045
TURN = 2 * np.pi
# A smaller difference is rounding, which differs between processors, so everything this close to
# edge-on is drawn alike.
SMALL = 1e-9
# The resolution of corners, in fractions of a pixel.
FINE = 2


def _net(rows, columns, at):
    """Return the quadrilaterals of a net of points, of shape ``(rows * columns, 4, 3)``."""
    grid = at(
        *np.meshgrid(np.linspace(0, 1, rows + 1), np.linspace(0, 1, columns + 1), indexing="ij")
    )
    corners = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
    return np.stack(corners, axis=2).reshape(-1, 4, 3)


def _arc(radius, thick, start, end):
    def at(i, j):
        a, b = start + (end - start) * i, -TURN * j
        far = radius + thick * np.cos(b)
        return np.stack((far * np.cos(a), far * np.sin(a), thick * np.sin(b)), axis=-1)

    return list(_net(int(np.ceil((end - start) / 0.3)), 6, at))


def _rod(top, sides=9):
    def at(i, j):
        a, far = -TURN * j, 1 + (top - 1) * i
        return np.stack((far * np.cos(a), far * np.sin(a), i), axis=-1)

    angles = np.linspace(0, TURN, sides, endpoint=False)
    ring = np.stack((np.cos(angles), np.sin(angles), np.zeros(sides)), axis=-1)
    caps = [ring[::-1]] + ([ring * (top, top, 1) + (0, 0, 1)] if top else [])
    return [*_net(1, sides, at), *caps]


def _ball():
    def at(i, j):
        a, b = np.pi * i, TURN * j
        return np.stack((np.sin(a) * np.cos(b), np.sin(a) * np.sin(b), np.cos(a)), axis=-1)

    return list(_net(4, 7, at))


def _box(x, y, z, bevel):
    half = np.array((x, y, z)) / 2
    if bevel < FINEST_BEVEL:
        bevel = 0
    faces = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side in (-1, 1):
            face = np.zeros((4, 3))
            face[:, axis] = side * half[axis]
            face[:, u] = np.array((-1, 1, 1, -1)) * (half[u] - bevel)
            face[:, v] = side * np.array((-1, -1, 1, 1)) * (half[v] - bevel)
            faces.append(face)
            # The edges along this axis.
            for sign in (-1, 1) if bevel else ():
                edge = np.zeros((4, 3))
                edge[:, axis] = np.array((-1, 1, 1, -1)) * (half[axis] - bevel)
                edge[:, u] = side * (half[u] - np.array((0, 0, bevel, bevel)))
                edge[:, v] = sign * (half[v] - np.array((bevel, bevel, 0, 0)))
                faces.append(_outwards(edge))
    for signs in np.ndindex(2, 2, 2) if bevel else ():
        corner = (2 * np.array(signs) - 1) * (half - bevel * (1 - np.eye(3)))
        faces.append(_outwards(corner))
    return faces


def _outwards(face):
    normal = np.cross(face[1] - face[0], face[2] - face[0])
    return face if normal @ face.mean(axis=0) > 0 else face[::-1]


def _ribbon(*flat):
    edges = np.reshape(flat, (-1, 2, 3))
    return list(np.stack((edges[:-1, 0], edges[1:, 0], edges[1:, 1], edges[:-1, 1]), axis=1))


SHAPES = {"arc": _arc, "rod": _rod, "ball": _ball, "box": _box, "ribbon": _ribbon}


class Paper:
    """The square sheet on which a scene is drawn, ``size`` pixels wide.

    ``still`` says what the eye sees, by ``view``, ``target`` and ``half``, and ``world`` what all
    stills share: ``distance``, ``ground`` and ``light`` of ``scenes.json``.
    """

    def __init__(self, still, world):
        self.view, self.world, self.half = np.array(still["view"]), world, world["size"] / 2
        self.target, self.light = np.array(still["target"]), np.array(world["light"])
        self.scale = self.half / still["half"]
        self.eye = self.target + world["distance"] * self.view[2]

    def place(self, points):
        """Return the places of points in pixels right and down from the middle, and their depth."""
        x, y, z = np.moveaxis((np.asarray(points) - self.target) @ self.view.T, -1, 0)
        near = self.world["distance"] / (self.world["distance"] - z) * self.scale
        return np.stack((near * x, -near * y), axis=-1), z

    def faces(self, item):
        """Iterate over the visible faces of a shape: depth, class and pixels of each."""
        shape, of, rows, origin, size, colour, alpha, _ = item
        thick = {"rod": size[0], "arc": of[1] if shape == "arc" else 0}.get(shape, 1)
        if shape == "tube" or thick < THIN or (shape in ("rod", "arc") and alpha < FAINT):
            yield from self.thread(item)
            return
        # On the largest shape the corners of the usual number of sides would show.
        local = _rod(*of, sides=40) if colour == "ground" else SHAPES[shape](*of)
        both = shape == "ribbon"
        for face in local:
            points = np.array(origin) + (face * size) @ np.array(rows)
            normal = np.cross(points[1] - points[0], points[2] - points[0])
            if np.linalg.norm(normal) < 1e-12 and len(points) == 4:
                normal = np.cross(points[2] - points[0], points[3] - points[0])
            far = np.linalg.norm(normal)
            if far < 1e-12:
                continue
            normal = normal / far
            facing = normal @ (self.eye - points.mean(axis=0))
            if facing <= SMALL and not both:
                continue
            normal = normal if facing > 0 else -normal
            light = 0.36 + 0.13 * (1 + normal[2]) + 0.56 * max(0.0, normal @ self.light)
            tone = int(np.clip(np.floor((light - 0.36) / 0.82 * TONES + SMALL), 0, TONES - 1))
            pixels, depth = self.place(points)
            # A large flat part is sorted by its farthest point, since the ground is behind
            # everything that is on it.
            yield (
                (-50 if colour == "ground" else depth.mean()),
                f"{colour} tone-{tone}",
                pixels,
                alpha,
            )

    def thread(self, item):
        """Draw a thin shape as a band that faces the camera.

        It consists of a few pieces, since other shapes may lie between them.
        """
        shape, of, rows, origin, size, colour, alpha, _ = item
        if shape == "tube":
            points, radii = np.reshape(of[1:], (-1, 3)), np.full(len(of) // 3, of[0])
        elif shape == "arc":
            angles = np.linspace(of[2], of[3], 17)
            points = np.array(origin) + of[0] * np.stack(
                (np.cos(angles), np.sin(angles)), axis=-1
            ) @ np.array(rows[:2])
            radii = np.full(17, of[1])
        else:
            points = np.array((origin, np.array(origin) + size[2] * np.array(rows[2])))
            radii = np.array((size[0], size[0] * of[0]))
        pixels, depth = self.place(points)
        along = np.gradient(pixels, axis=0)
        across = (
            np.stack((-along[:, 1], along[:, 0]), axis=-1)
            / np.maximum(np.linalg.norm(along, axis=1), 1e-9)[:, None]
        )
        across *= (radii * self.scale)[:, None]
        for k in range(0, len(points) - 1, 3):
            piece = slice(k, k + 4)
            band = np.concatenate(
                (pixels[piece] + across[piece], (pixels[piece] - across[piece])[::-1])
            )
            yield depth[piece].mean(), f"{colour} tone-3", band, alpha

    def shadow(self, item):
        """Iterate over the outlines of the shadows of a shape's faces on the ground."""
        shape, of, rows, origin, size, *_ = item
        if shape == "ball" or min(size[:2]) < 0.06 or (shape == "arc" and of[1] < THIN):
            # It is too small for anyone to miss.
            return
        for face in SHAPES[shape](*of):
            points = np.array(origin) + (face * size) @ np.array(rows)
            if np.cross(points[1] - points[0], points[2] - points[0]) @ self.light <= SMALL:
                continue
            fallen = points - np.outer(
                (points[:, 2] - self.world["ground"]) / self.light[2], self.light
            )
            if (np.hypot(fallen[:, 0], fallen[:, 1]) < self.world["rim"] + SMALL).all():
                yield -40, "shade tone-3", self.place(fallen)[0], 1


def picture(still, world, colours=None):
    """Return the SVG element of one stop, with its text description.

    ``colours`` gives the colour of a class, for programs that do not know the style sheet of a
    page.
    """
    paper = Paper(still, world)
    faces = [face for item in still["items"] for face in paper.faces(item)]
    faces += [face for item in still["items"] if item[7] for face in paper.shadow(item)]
    faces.sort(key=lambda face: round(face[0], 9))
    marks, kind, data = [], None, []

    def end():
        if data:
            name, alpha = kind
            faint = f' opacity="{alpha:.2g}"' if alpha < 0.97 else ""
            if colours:
                faint += f' fill="{colours(name)}" stroke="none"'
            marks.append(f'<path class="{name}"{faint} d="{"".join(data)}"/>')
        data.clear()

    for _, name, pixels, alpha in faces:
        if (name, alpha) != kind or alpha < 0.97:
            end()
            kind = (name, alpha)
        whole = np.rint(np.round(FINE * pixels, 6)).astype(int)
        if np.ptp(whole, axis=0).min() > 0 or len(whole) == 4:
            data.append("M" + _pairs(whole[:1]) + "l" + _pairs(np.diff(whole, axis=0)) + "z")
    end()
    outlines = {}
    for text, tex, colour, (x, y), _ in still["labels"]:
        placed, _ink = typeset(
            f"${text}$" if tex else "$\\mathrm{" + text.replace("-", "\u2010") + "}$"
        )
        size = FINE * (0.02 if tex else 0.016)
        glyphs = "".join(
            f'<use transform="translate({at[0]:.0f} '
            f'{at[1]:.0f}){"" if by == 1 else f" scale({by:.3g})"}" '
            f'href="#{still["id"]}-{outlines.setdefault(outline, len(outlines))}"/>'
            for outline, at, by in placed
        )
        place = f"translate({FINE * x:g} {FINE * y:g}) scale({size:g})"
        marks.append(f'<g class="text {colour}" transform="{place}">{glyphs}</g>')
    letters = "".join(
        f'<path id="{still["id"]}-{k}" d="{outline}"/>' for outline, k in outlines.items()
    )
    marks.insert(0, f"<defs>{letters}</defs>" if letters else "")
    half, inner = FINE * paper.half, ""
    # A picture that is cut out of the sheet has the bounds of what is drawn.
    if colours:
        corners = FINE * np.concatenate([face[2] for face in faces])
        left, top, right, bottom = *np.floor(corners.min(axis=0)), *np.ceil(corners.max(axis=0))
        inner = f' data-box="{left:.0f} {top:.0f} {right - left:.0f} {bottom - top:.0f}"'
    return (
        f'<svg viewBox="{-half:g} {-half:g} {2 * half:g} {2 * half:g}" '
        f'style="max-width:{world["size"]}px" role="img"{inner} '
        f'aria-label="{escape(words(still))}">{"".join(marks)}</svg>'
    )


def words(still):
    """Return a stop's text description: the parts of the figure, then what becomes of them."""
    return (
        still["before"]
        if still["before"] == still["after"]
        else f"{still['before']} Then: {still['after']}"
    )


def _pairs(points):
    """Return numbers as short as a path may have them; a minus sign separates two of them, too."""
    return " ".join(map(str, points.ravel())).replace(" -", "-")
