"""Whether two texts are the same but for the last digits of their
numbers, and by how much these moved.

No two kinds of processor round alike: the order of a sum differs, and whether a product is rounded
before it is added. What a cell prints may move by that, and by no more.
"""

import re
from typing import NamedTuple

#: The largest change allowed in a printed number, relative to its size, or absolute below 1.
ALLOWED = 1e-13
#: The largest change allowed in the coordinates of a drawing, in its pixels. They are written to
#: one decimal, and the step between two points is wrong by the errors of both.
ALLOWED_IN_DRAWINGS = 0.21

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
#: A number that is not part of a name or a colour.
FREE = re.compile(rf"(?<![\w#])(?<![\w#][.])(?:{NUMBER})(?![\w])")
#: The attributes that place the lines and the letters of a drawing.
PLACING = re.compile(r'(?<= )(d|x|y|x1|x2|y1|y2|cx|cy|r|rx|ry|points|transform)="([^"]*)"')
#: The ID of a part of a drawing, which is a hash of the whole drawing.
PART = re.compile(r"\b(?:g[0-9a-f]{10}|p[0-9a-f]{8})(?=-\d)")
TOKEN = re.compile(rf"[A-Za-z]+|{NUMBER}")


class Move(NamedTuple):
    """A number that moved; of what is no number, ``by`` is infinite."""

    stored: str
    now: str
    by: float
    allowed: float

    @property
    def share(self):
        """Which part of what is allowed it has moved."""
        return self.by / self.allowed if self.allowed else float("inf")

    @property
    def too_far(self):
        return self.share > 1

    def __str__(self):
        if self.by == float("inf"):
            return f"{self.stored!r} became {self.now!r}"
        return f"{self.stored} became {self.now}: {self.by:.1e}, allowed {self.allowed:.0e}"


def moves(stored, now):
    """All numbers that differ between two texts, as a list of :class:`Move`; the largest first.

    >>> for move in moves("off by 0.1 and 2 rad", "off by 0.10000000000001700 and 3 rad"):
    ...     print(move, move.too_far)
    2 became 3: 1.0e+00, allowed 0e+00 True
    0.1 became 0.10000000000001700: 1.7e-14, allowed 1e-13 False
    """
    if stored == now:
        return []
    stored, now = (PART.sub("part", text) for text in (stored, now))
    places = [PLACING.findall(text) for text in (stored, now)]
    found = _numbers(PLACING.sub(r'\1=""', stored), PLACING.sub(r'\1=""', now), FREE, _allowed)
    for (_, one), (_, other) in zip(*places):
        found += _in_a_drawing(one, other)
    return sorted(found, key=lambda move: -move.by)


def _numbers(stored, now, number, allowed):
    if number.sub("0", stored) != number.sub("0", now):
        return [_elsewhere(stored, now)]
    return [
        Move(one, other, abs(float(one) - float(other)), allowed(one, other))
        for one, other in zip(number.findall(stored), number.findall(now))
        if one != other
    ]


def _in_a_drawing(stored, now):
    tokens = [TOKEN.findall(text) for text in (stored, now)]
    letters = [[token for token in part if token[0].isalpha()] for part in tokens]
    if letters[0] != letters[1] or len(tokens[0]) != len(tokens[1]):
        return [_elsewhere(stored, now)]
    return [
        Move(one, other, abs(float(one) - float(other)), ALLOWED_IN_DRAWINGS)
        for one, other in zip(*tokens)
        if one != other and not one[0].isalpha()
    ]


def _allowed(one, other):
    """Counts are exact: what is written as a whole number must be the same."""
    if any(text.lstrip("+-").isdigit() for text in (one, other)):
        return 0.0
    return ALLOWED * max(1.0, abs(float(one)))


def _elsewhere(stored, now):
    """The first place that differs, with a little of what stands around it."""
    start = next(
        (k for k, (a, b) in enumerate(zip(stored, now)) if a != b), min(len(stored), len(now))
    )
    begin = max(0, start - 20)
    return Move(stored[begin : start + 40], now[begin : start + 40], float("inf"), 0.0)


def moves_of_outputs(stored, now):
    """The moves between the outputs of a cell; ``None`` where there
    is more of one than of the other.
    """
    texts = [[_texts(output) for output in outputs] for outputs in (stored, now)]
    if [list(one) for one in texts[0]] != [list(one) for one in texts[1]]:
        return None
    return [
        move for one, other in zip(*texts) for kind in one for move in moves(one[kind], other[kind])
    ]


def _texts(output):
    """What of an output is text, by its kind."""
    data = {
        kind: content
        for kind, content in output.get("data", {}).items()
        if isinstance(content, str)
    }
    return dict(
        sorted((data | ({output["name"]: output["text"]} if "text" in output else {})).items())
    )
