"""The drawing methods of pictures: arrows, triads, rotations, circles, bodies.

They draw lines and areas as paths on a sheet with the attributes ``view``, ``size``, ``on_sheet``,
``path`` and ``text``. ``orientation_figures.moving.javascript`` translates them for the
sheets of the page. Hidden parts shrink to nothing instead of being left out, so that an
``Animation`` finds the same marks at every moment.
"""

import math

from .vectors import AXES, IDENTITY, add, cross, dot, length, scale, subtract, unit

# Heads of arrows, by points (along, across) from the tip. Without colour, frames differ in these
# heads and in their strokes.
BARB = ((0, 0), (-13, 4.6), (-7.5, 0), (-13, -4.6))
TRIANGLE = ((0, 0), (-14, 5.6), (-14, 0), (-14, -5.6))
DIAMOND = ((0, 0), (-8, 5.4), (-16, 0), (-8, -5.4))
HEADS = {
    "A": TRIANGLE,
    "B": TRIANGLE,
    "C": DIAMOND,
    "D": TRIANGLE,
    "E": TRIANGLE,
    "F": DIAMOND,
    "Z": TRIANGLE,
}
# Where the light comes from: right, up and towards the reader.
LIGHT = (-0.45, 0.75, 0.485)
# A cubic whose inner points are this far along the tangents is a quarter of a circle.
ROUND = 0.5523
# The largest angle of an arc, in radians, for one cubic.
STEEP = 1.6


def hatted(letter):
    """Return the symbols of three unit vectors, as labels."""
    return [rf"$\hat{{{letter}}}_{axis}$" for axis in AXES]


def turned(axis, angle, vector):
    """Return a vector rotated about ``axis`` through ``angle``."""
    normal = unit(axis)
    along, beside = scale(dot(normal, vector), normal), cross(normal, vector)
    rest = subtract(vector, along)
    return add(along, scale(math.cos(angle), rest), scale(math.sin(angle), beside))


def layers(kind):
    """Return the styles of a line, drawn one above the other; a tube has a core that gleams."""
    return [kind, f"{kind} core", f"{kind} gleam"] if kind.startswith("tube") else [kind]


def half_round(u, v):
    """Return the points of half an ellipse from ``u`` by ``v`` to the other side."""
    return [
        u,
        add(u, scale(ROUND, v)),
        add(scale(ROUND, u), v),
        v,
        subtract(v, scale(ROUND, u)),
        subtract(scale(ROUND, v), u),
        scale(-1, u),
    ]


class Words:
    """The methods that draw on a sheet; each returns the sheet, so that they can be chained."""

    def depth_of(self, points):
        """Return how near the middle of ``points`` is to the reader."""
        return dot(self.view[2], add(*points)) / len(points)

    def shade(self, normal):
        """Return the per cent of shade on a surface, in steps of ten."""
        lit = dot(LIGHT, [dot(row, unit(normal)) for row in self.view])
        return 10 * math.floor(5 - 4.5 * lit)

    # Lines, areas and labels.

    def line(self, points, colour="ink", kind=""):
        """Draw a line; ``kind`` is '', 'guide' (dashed), 'faint', 'thick' or 'tube'."""
        places, depth = [self.on_sheet(point) for point in points], self.depth_of(points)
        for k, layer in enumerate(layers(kind)):
            self.path(f"M{'L' * (len(points) - 1)}", places, f"{layer} {colour}", depth + 1e-6 * k)
        return self

    def area(self, points, colour="ink", fill=16, edge=True):
        """Fill a polygon by its corners; ``fill`` is 8, 16, 26 or 38 per cent of the colour."""
        places = [self.on_sheet(point) for point in points]
        kind = f"fill-{fill} {'' if edge else 'bare '}{colour}"
        return self.path(f"M{'L' * (len(points) - 1)}Z", places, kind, self.depth_of(points))

    def ellipse(self, middle, u, v, kind, depth=0):
        """Draw an ellipse on the sheet, with the conjugate half diameters ``u`` and ``v``."""
        points = [*half_round(u, v), *half_round(scale(-1, u), scale(-1, v))[1:]]
        return self.path("MCCCCZ", [add(middle, point) for point in points], kind, depth)

    def dot(self, point, colour="ink", radius=4):
        """Draw a dot with a radius in pixels."""
        depth = self.depth_of([point])
        return self.ellipse(self.on_sheet(point), [radius, 0], [0, radius], f"head {colour}", depth)

    def dots(self, points, colour="ink"):
        """Draw many dots as one path: a line without length has only its round ends."""
        pairs = [self.on_sheet(point) for point in points for end in (0, 1)]
        return self.path("ML" * len(points), pairs, f"thick {colour}", self.depth_of(points))

    def ring(self, point, colour="ink", radius=5):
        """Draw a small circle with a radius in pixels."""
        depth = self.depth_of([point]) + 1e-6
        place = self.on_sheet(point)
        return self.ellipse(place, [radius, 0], [0, radius], f"paper {colour}", depth)

    def label(self, point, text, colour="ink", shift=(0, 0), size=20):
        """Write ``text`` centred on a point."""
        return self.text(text, add(self.on_sheet(point), shift), colour, size)

    def label_beyond(self, point, text, colour="ink", pixels=17):
        """Write a label beyond a point as seen from the origin."""
        return self.label(point, text, colour, scale(pixels, unit(self.on_sheet(point))))

    def shadow(self, vector, direction, colour="accent"):
        """Draw the projection of one vector onto another, with a dropped line and a right angle."""
        along = unit(direction)
        foot = scale(dot(vector, along), along)
        down = subtract(foot, vector)
        self.line([[0, 0, 0], foot], colour, "shadow")
        if length(down) > 0.02:
            self.line([vector, foot], colour, "guide")
            if length(foot) > 0.1:
                self.right_angle(scale(-1, foot), scale(-1, down), origin=foot, size=0.07)
        return self

    # Arrows and frames.

    def arrow(self, end, start=(0, 0, 0), colour="ink", label="", shift=None, size=20, kind=""):
        """Draw an arrow from ``start`` to ``end``.

        The label is ``shift`` from the tip or beyond it.

        An arrow that points straight at the reader is a circle with a dot, one that points straight
        away a circle with a cross.
        """
        reach, depth = subtract(end, start), self.depth_of([start, end])
        tail, tip = self.on_sheet(start), self.on_sheet(end)
        across = subtract(tip, tail)
        pixels, along = length(across), unit(across)
        outward = scale(17, along)
        if pixels < 0.05 * self.size * length(reach):
            self.ellipse(tip, [9, 0], [0, 9], f"paper {colour}", depth)
            if dot(self.view[2], reach) > 0:
                self.ellipse(tip, [3, 0], [0, 3], f"head {colour}", depth + 1e-6)
            else:
                strokes = [[-6.4, -6.4], [6.4, 6.4], [-6.4, 6.4], [6.4, -6.4]]
                self.path("MLML", [add(tip, point) for point in strokes], colour, depth + 1e-6)
            outward = [15, 15]
        else:
            part = min(1, pixels / 28)
            line = [tail, subtract(tip, scale(10 * part, along))]
            self.path("ML", line, f"axis {colour} {kind}", depth)
            self.head(tip, along, part, colour, depth + 1e-6)
        if label:
            self.text(label, add(tip, outward if shift is None else shift), colour, size)
        return self

    def head(self, tip, along, size, colour, depth=0):
        """Draw the head of an arrow on the sheet."""
        right, down = along
        corners = [
            add(tip, scale(size, [x * right - y * down, x * down + y * right]))
            for x, y in HEADS.get(colour, BARB)
        ]
        return self.path("MLLLZ", corners, f"head {colour}", depth)

    def triad(
        self, letter, dcm, origin=(0, 0, 0), length=1.0, labels=None, shifts=(None, None, None)
    ):
        """Draw the unit vectors of the frame ``letter``.

        ``dcm``, shape ``(3, 3)``, is the direction cosine matrix of that frame with respect to N:
        its rows are the frame's unit vectors. ``labels`` are three strings, by default the hatted
        symbols; an empty string leaves that arrow without a label, and None leaves that arrow out.
        """
        texts = hatted(letter.lower()) if labels is None else labels
        for row, label, shift in zip(dcm, texts, shifts, strict=True):
            if label is not None:
                end = add(origin, scale(length, row))
                self.arrow(end, start=origin, colour=letter, label=label, shift=shift)
        return self

    # Angles and circles.

    def turn(
        self,
        axis,
        angle,
        start,
        radius=0.5,
        label="",
        origin=(0, 0, 0),
        colour="ink",
        shift=(0, 0),
        kind="",
        head=True,
    ):
        """Draw the arc of ``start`` rotated through ``angle`` (radians) about ``axis``."""
        normal, arm = unit(axis), scale(radius, unit(start))
        swept, pieces = abs(angle) * radius * self.size, max(4, math.ceil(abs(angle) / STEEP))
        size = min(0.8, swept / 28) if head else 0
        last = 1 - (9 * size / swept if swept else 0)
        reach = 4 / 3 * math.tan(last * angle / pieces / 4)

        def at(part):
            return turned(normal, part * angle, arm)

        def place(point):
            return self.on_sheet(add(origin, point))

        points = [place(arm)]
        for k in range(pieces):
            near, far = at(last * k / pieces), at(last * (k + 1) / pieces)
            points.append(place(add(near, scale(reach, cross(normal, near)))))
            points.append(place(subtract(far, scale(reach, cross(normal, far)))))
            points.append(place(far))
        middle, tip = place(at(0.5)), place(at(1))
        depth = self.depth_of([add(origin, at(0.5))])
        for k, layer in enumerate(layers(kind)):
            self.path(f"M{'C' * pieces}", points, f"{layer} {colour}", depth + 1e-6 * k)
        if head:
            self.head(tip, unit(subtract(tip, place(at(last)))), size, colour, depth + 1e-6)
        if label:
            outward = scale(15, unit(subtract(middle, self.on_sheet(origin))))
            # Fade the arc where there is no angle.
            shown = min(1, abs(angle) / 0.2)
            self.text(label, add(middle, outward, shift), colour, 20, shown)
        return self

    def arc(
        self,
        start,
        end,
        radius=0.5,
        label="",
        origin=(0, 0, 0),
        colour="ink",
        shift=(0, 0),
        kind="",
        head=True,
    ):
        """Draw the angle from the direction ``start`` to ``end``, the short way round."""
        axis = cross(start, end)
        return self.turn(
            axis,
            math.atan2(length(axis), dot(start, end)),
            start,
            radius=radius,
            label=label,
            origin=origin,
            colour=colour,
            shift=shift,
            kind=kind,
            head=head,
        )

    def right_angle(self, first, second, origin=(0, 0, 0), size=0.12, colour="muted"):
        """Mark the right angle between two directions at ``origin``."""
        u, v = scale(size, unit(first)), scale(size, unit(second))
        return self.line([add(origin, point) for point in [u, add(u, v), v]], colour)

    def circle(self, normal, radius=1.0, origin=(0, 0, 0), colour="muted", kind="guide", half=""):
        """Draw the circle about ``normal``.

        ``half`` selects the half nearer to the reader ('front') or farther ('back'); ``kind`` is as
        in ``line`` except for a tube, or 'fill-8', 'fill-16', ...
        """
        axis = unit(normal)
        sizes = [abs(entry) for entry in axis]
        level, farthest_axis = cross(axis, self.view[2]), IDENTITY[sizes.index(min(sizes))]
        across = scale(
            radius, unit(level if half and length(level) > 1e-6 else cross(axis, farthest_axis))
        )
        u, v = self.on_sheet(across), self.on_sheet(cross(axis, across))
        middle, depth, look = self.on_sheet(origin), self.depth_of([origin]), f"{kind} {colour}"
        if not half:
            return self.ellipse(middle, u, v, look, depth)
        points = half_round(u, scale(-1, v) if half == "front" else v)
        return self.path("MCC", [add(middle, point) for point in points], look, depth)

    # Solid bodies. On paper, draw what lies farther from the reader first.

    def box(self, dcm, size, origin=(0, 0, 0), colour="ink"):
        """Draw a box centred at ``origin``, with edges ``size`` along the rows of ``dcm``."""
        half = [scale(size[k] / 2, row) for k, row in enumerate(dcm)]
        for i in range(3):
            u, v = half[(i + 1) % 3], half[(i + 2) % 3]
            corners = [add(u, v), subtract(v, u), scale(-1, add(u, v)), subtract(u, v)]
            for outward in [half[i], scale(-1, half[i])]:
                seen = 1 if dot(outward, self.view[2]) > 0 else 0
                face = [add(origin, outward, scale(seen, corner)) for corner in corners]
                places, shade = [self.on_sheet(point) for point in face], self.shade(outward)
                self.path("MLLLZ", places, f"shade-{shade} {colour}", self.depth_of(face))
        return self

    def cylinder(self, start, end, radius, colour="ink", shade=50):
        """Draw a cylinder between the middles of its two round ends.

        ``shade``, in per cent, is that of most of its side.
        """
        facing, depth = dot(unit(subtract(end, start)), self.view[2]), self.depth_of([start, end])
        near, far, pixels = self.on_sheet(start), self.on_sheet(end), radius * self.size
        along = unit(subtract(far, near)) if abs(facing) < 0.9999 else [1, 0]
        bulge, side = scale(pixels * abs(facing), along), scale(pixels, [-along[1], along[0]])
        front = [add(far, point) for point in half_round(side, bulge)]
        back = [add(near, point) for point in half_round(scale(-1, side), scale(-1, bulge))]
        self.path("MCCLCCZ", [*front, *back], f"shade-{shade} {colour}", depth)
        # A bright stripe where the side faces the light, and a dark one along the other edge.
        across = dot(LIGHT, [-along[1], -along[0], 0])
        toward = dot(
            LIGHT, [-facing * along[0], facing * along[1], math.sqrt(1 - min(1, facing**2))]
        )
        middle, edge = math.atan2(across, toward), 1.57 if across < 0 else -1.57
        bright, dark = max(-1.1, min(1.1, middle)), max(-1.57, min(1.57, middle + 0.85 * edge))
        for first, last, part in [
            [bright - 0.2, bright + 0.2, max(0, shade - 40)],
            [dark, edge, shade + 20],
        ]:
            corners = [
                add(place, scale(math.sin(at), side), scale(-facing * pixels * math.cos(at), along))
                for place, at in [[near, first], [near, last], [far, last], [far, first]]
            ]
            self.path("MLLLZ", corners, f"shade-{part} bare {colour}", depth + 5e-7)
        for place, out in [[near, subtract(start, end)], [far, subtract(end, start)]]:
            shown = 1 if dot(out, self.view[2]) > 0 else 0
            u, v = scale(shown, bulge), scale(shown, side)
            self.ellipse(place, u, v, f"shade-{self.shade(out)} {colour}", depth + 1e-6)
        return self
