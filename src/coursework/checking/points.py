"""The values at which the symbols of a question are compared.

They follow from the question's own salt, so the author's machine and every student's take the same.
"""

import hashlib

from .evaluate import MP

#: At three points each symbol has had both signs, and no two forms that differ agree by chance.
POINTS = 3
#: Where an angle is sampled if its question says nothing: beyond a quarter turn, so that a root is not
#: taken for the cosine it equals in the first quadrant, and within a half turn, where half-angle forms hold.
ANGLES = (-3.0, 3.0)
#: Letters that SymPy has two of and handwriting one.
TWINS = {"phi": "varphi", "varphi": "phi", "epsilon": "varepsilon", "varepsilon": "epsilon"}


def points(question):
    """Give the points of a question: dictionaries from the names of its symbols to numbers."""
    symbols = question.get("symbols", {})
    if not symbols:
        return [{}]
    found = []
    for number in range(POINTS):
        point = {
            name: _draw(question, number, order, *limits)
            for order, (name, limits) in enumerate(sorted(symbols.items()))
        }
        for group in question.get("unit", ()):
            length = MP.sqrt(sum(point[name] ** 2 for name in group))
            point.update({name: point[name] / length for name in group})
        for name in list(point):
            twin = TWINS.get(name)
            if twin and twin not in point:
                point[twin] = point[name]
        found.append(point)
    return found


def _draw(question, number, order, low, high):
    seed = f"{question['salt']} point {number} of symbol {order}".encode()
    share = int.from_bytes(hashlib.sha256(seed).digest()[:12], "big") / MP.mpf(2) ** 96
    if low < 0 < high and number < 2:
        # The first two points take both signs, so that an even function is never taken for an odd one.
        low, high = (low, low / 20) if (number + order) % 2 else (high / 20, high)
    return MP.mpf(low) + share * (MP.mpf(high) - MP.mpf(low))
