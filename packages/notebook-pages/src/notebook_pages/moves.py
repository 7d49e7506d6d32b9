"""Compare two texts up to the last digits of their numbers, and measure how much these changed.

Different processors round differently: the order of a sum differs, and some round a product before
adding it. The output of a cell may move by that much, and by no more.
"""

import re
from typing import NamedTuple

# The largest change allowed in a printed number, relative to its size, or absolute below 1.
ALLOWED = 1e-13
# The largest change allowed in the coordinates of a drawing, in its pixels. They are written to one
# decimal, and the step between two points has the errors of both.
ALLOWED_IN_DRAWINGS = 0.21

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
# A number that is not part of a name or a colour.
FREE = re.compile(rf"(?<![\w#])(?<![\w#][.])(?:{NUMBER})(?![\w])")
# The attributes that place the lines and the letters of a drawing.
PLACING = re.compile(r'(?<= )(d|x|y|x1|x2|y1|y2|cx|cy|r|rx|ry|points|transform)="([^"]*)"')
#: The ID of a part of a drawing, which is a hash of the whole drawing.
PART = re.compile(r"\b(?:g[0-9a-f]{10}|p[0-9a-f]{8})(?=-\d)")
TOKEN = re.compile(rf"[A-Za-z]+|{NUMBER}")


class Move(NamedTuple):
    """A number that changed; ``by`` is infinite for a difference that is not a number."""

    stored: str
    now: str
    by: float
    allowed: float

    @property
    def share(self):
        """Return the ratio of the move to the allowed one."""
        return self.by / self.allowed if self.allowed else float("inf")

    @property
    def too_far(self):
        return self.share > 1

    def __str__(self):
        if self.by == float("inf"):
            return f"{self.stored!r} became {self.now!r}"
        return f"{self.stored} became {self.now}: {self.by:.1e}, allowed {self.allowed:.0e}"


def moves(stored, now):
    """Return all numbers that differ between two texts as `Move`, the largest first.

    >>> for move in moves("off by 0.1 and 2 rad", "off by 0.10000000000001700 and 3 rad"):
    ...     print(move, move.too_far)
    2 became 3: 1.0e+00, allowed 0e+00 True
    0.1 became 0.10000000000001700: 1.7e-14, allowed 1e-13 False
    """
    if stored == now:
        return []
    stored, now = (PART.sub("part", text) for text in (stored, now))
    places = [PLACING.findall(text) for text in (stored, now)]
    differences = _numbers(
        PLACING.sub(r'\1=""', stored), PLACING.sub(r'\1=""', now), FREE, _allowed
    )
    for (_, stored_places), (_, current_places) in zip(*places):
        differences += _in_a_drawing(stored_places, current_places)
    return sorted(differences, key=lambda move: -move.by)


def _numbers(stored, now, number, allowed):
    if number.sub("0", stored) != number.sub("0", now):
        return [_elsewhere(stored, now)]
    return [
        Move(before, after, abs(float(before) - float(after)), allowed(before, after))
        for before, after in zip(number.findall(stored), number.findall(now))
        if before != after
    ]


def _in_a_drawing(stored, now):
    tokens = [TOKEN.findall(text) for text in (stored, now)]
    letters = [[token for token in part if token[0].isalpha()] for part in tokens]
    if letters[0] != letters[1] or len(tokens[0]) != len(tokens[1]):
        return [_elsewhere(stored, now)]
    return [
        Move(before, after, abs(float(before) - float(after)), ALLOWED_IN_DRAWINGS)
        for before, after in zip(*tokens)
        if before != after and not before[0].isalpha()
    ]


def _allowed(before, after):
    """Return the allowed move; counts are exact, so numbers written as integers must not move."""
    if any(text.lstrip("+-").isdigit() for text in (before, after)):
        return 0.0
    return ALLOWED * max(1.0, abs(float(before)))


def _elsewhere(stored, now):
    """Return the first difference, with a little of the text around it."""
    start = next(
        (k for k, (a, b) in enumerate(zip(stored, now)) if a != b), min(len(stored), len(now))
    )
    begin = max(0, start - 20)
    return Move(stored[begin : start + 40], now[begin : start + 40], float("inf"), 0.0)


def moves_of_outputs(stored, now):
    """Return the moves between the outputs of a cell, or ``None`` if their kinds differ."""
    texts = [[_texts(output) for output in outputs] for outputs in (stored, now)]
    if [list(kinds) for kinds in texts[0]] != [list(kinds) for kinds in texts[1]]:
        return None
    return [
        move
        for before, after in zip(*texts)
        for kind in before
        for move in moves(before[kind], after[kind])
    ]


def _texts(output):
    """Return the texts of an output, by their kind."""
    data = {
        kind: content
        for kind, content in output.get("data", {}).items()
        if isinstance(content, str)
    }
    return dict(
        sorted((data | ({output["name"]: output["text"]} if "text" in output else {})).items())
    )
