"""Secret points and calls, so that marks do not depend only on what students can see.

The check that a student has compares answers at points that follow from the question. Whoever reads
them can hand in a parabola through them, or a table of what a friend's function returned. So we
compare an answer that earns points once more, at points and calls derived from the instructor's
secret. Right answers agree there in all their forms, since we compute them with 40 digits and the
threshold is far above any rounding error.
"""

import copy
import hmac
import math
import os
import random
import secrets
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from ...authoring.author import AuthoredQuestion
from ...checking.evaluate import MP
from ...checking.kinds import Blank, Fault, Undecidable
from ...checking.plain import NotPlain, Plain, to_plain
from ...checking.plugins import kinds
from ...checking.question import Question
from ...checking.reading import calls_for, canonical, read, tolerances
from ..tables import reason_of
from .contract import Elsewhere

FILE = ".grading-secret"
CALLS = 3
#: The relative difference above which two answers differ. No rounding error reaches it, and no
#: guess comes so close.
APART = MP.mpf("1e-6")
#: The number of tolerances by which an answer may be off here that was within one where the student
#: looked.
SLACK = 4
ATTEMPTS = 60


def secret_beside(folder: str | Path) -> bytes:
    """Return the secret of a course, from the file beside its solutions; create it if missing.

    Raises
    ------
    ValueError
        The file can be neither read nor created.
    """
    path = Path(folder) / FILE
    try:
        try:
            handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        except FileExistsError:
            return bytes.fromhex(path.read_text("ascii").strip())
        with open(handle, "w") as file:
            file.write(secrets.token_hex(32) + "\n")
        return bytes.fromhex(path.read_text("ascii").strip())
    except (OSError, ValueError) as error:
        raise ValueError(
            f"We cannot read or create {path} ({reason_of(error)}). This "
            "file holds the secret of the course, from which grading derives some of its test "
            "inputs. It belongs beside the solutions."
        ) from None


def secret_of(question: AuthoredQuestion, secret: bytes) -> Elsewhere | None:
    """Derive the secret comparison of a question; ``None`` if there is nothing to compare.

    Parameters
    ----------
    question : coursework.authoring.author.AuthoredQuestion
    secret : bytes

    Returns
    -------
    Elsewhere or None
    """
    public = question.public
    is_function = public.kind == "function"
    if not is_function and (kinds()[public.kind].text or not public.symbols):
        # A word or a number is the same everywhere.
        return None
    known = None
    for attempt in range(ATTEMPTS):
        seed = hmac.digest(secret, f"{question.name} {attempt}".encode(), "sha256").hex()
        if is_function:
            elsewhere = _of_function(question, seed)
        else:
            elsewhere = _of_expression(question, seed)
        if elsewhere is not None and (
            not is_function or any(call not in public.calls for call in elsewhere.calls)
        ):
            return elsewhere
        # Prefer calls that no check makes. If the arguments are a few words, there may be none.
        known = known or elsewhere
    return known


def _of_expression(question: AuthoredQuestion, seed: str) -> Elsewhere | None:
    salt = seed[:16]
    elsewhere = replace(question.public, salt=salt)
    try:
        right = numbers_of(elsewhere, question.plain)
    except (Blank, Fault, Undecidable):
        return None
    partly = {}
    for text, entry in question.entries.items():
        if any(question.credit.get(note) for note, _ in entry.notes):
            try:
                partly[text] = numbers_of(elsewhere, entry.plain)
            except (Blank, Fault, Undecidable):
                return None
    return Elsewhere(salt, right=right, partly=partly)


def _of_function(question: AuthoredQuestion, seed: str) -> Elsewhere | None:
    public, dice = question.public, random.Random(seed)
    columns = _columns(public.calls)
    calls = [[_another(values, dice) for values in columns] for _ in range(CALLS)]
    near = [_moved(call, dice) for call in calls]
    try:
        right, moved = (
            numbers_of(elsewhere, to_plain(question.answer, calls_for(elsewhere)))
            for some in (calls, near)
            for elsewhere in [replace(public, calls=tuple(some))]
        )
    except (Blank, Fault, Undecidable, NotPlain):
        return None
    # Avoid places where the right answer itself jumps, since two right functions may differ there.
    return Elsewhere(calls=tuple(calls), right=right) if agree(public, right, moved) else None


def numbers_of(public: Question, plain: Plain) -> tuple[str, ...]:
    """Return the numbers of an answer, as strings with 30 digits.

    Raises
    ------
    Blank, Fault, Undecidable
    """
    return tuple(MP.nstr(number, 30) for number in canonical(public, read(public, plain)))


def agree(public: Question, numbers: Sequence[str], others: Sequence[str]) -> bool:
    """Check whether two lists of numbers agree except for rounding."""
    if len(numbers) != len(others):
        return False
    absolute, relative = tolerances(public)
    pairs = [(MP.mpf(number), MP.mpf(other)) for number, other in zip(numbers, others, strict=True)]
    return all(
        abs(number - other)
        <= max(SLACK * (absolute + relative * abs(other)), APART * max(1, abs(other)))
        for number, other in pairs
    )


# --- arguments like those that an author chose --------------------------------------------------


def _columns(calls: Iterable[list[Any]]) -> list[list[Any]]:
    """Return the values of each argument in the calls."""
    return [list(values) for values in zip(*calls, strict=True)]


def _another(values: list[Any], dice: random.Random) -> Any:
    """Return another value of the kind, length and range of the given ones."""
    if (
        all(isinstance(value, list) for value in values)
        and len({len(value) for value in values}) == 1
    ):
        return _another_list(values, dice)
    if all(isinstance(value, list) for value in values) and any(values):
        # The lists differ in length, so take the length of one, and draw each part from the parts
        # of the same form in all lists.
        parts = [part for value in values for part in value]
        chosen = dice.choice([value for value in values if value])
        return [
            _another([other for other in parts if _form(other) == _form(part)], dice)
            for part in chosen
        ]
    numbers = all(
        isinstance(value, (int, float)) and not isinstance(value, bool) for value in values
    )
    if not numbers or min(values) == max(values):
        return copy.deepcopy(dice.choice(values))
    if all(isinstance(value, int) for value in values):
        return dice.randint(min(values), max(values))
    return dice.uniform(min(values), max(values))


def _form(value: Any) -> Any:
    """Return how a value is built, from lists, numbers and strings."""
    if isinstance(value, list):
        return [_form(part) for part in value]
    return (
        "number"
        if isinstance(value, (int, float)) and not isinstance(value, bool)
        else type(value).__name__
    )


def _another_list(values: list[list[Any]], dice: random.Random) -> list[Any]:
    length = len(values[0])
    if length == 3 and all(map(_is_rotation, values)):
        return _rotation(dice)
    if length in (2, 3, 4) and all(map(_is_unit, values)):
        vector = _unit(length, dice)
        # A question may ask for quaternions whose scalar is not negative.
        return [abs(vector[0]), *vector[1:]] if all(value[0] >= 0 for value in values) else vector
    vector = [_another([value[place] for value in values], dice) for place in range(length)]
    if length > 1 and all(map(_increases, values)) and _increases(sorted(vector)):
        return sorted(vector)
    return vector


def _moved(value: Any, dice: random.Random) -> Any:
    """Return the same value except for the last digits."""
    if isinstance(value, list):
        return [_moved(part, dice) for part in value]
    return value * (1 + 1e-9 * dice.uniform(-1, 1)) if isinstance(value, float) else value


def _is_vector(value: Any) -> bool:
    return isinstance(value, list) and all(
        isinstance(part, (int, float)) and not isinstance(part, bool) for part in value
    )


def _is_unit(value: Any) -> bool:
    return _is_vector(value) and abs(math.hypot(*value) - 1) < 1e-9


def _is_rotation(rows: Any) -> bool:
    if not all(isinstance(row, list) and len(row) == 3 and _is_unit(row) for row in rows):
        return False
    (a, b, c), (d, e, f), (g, h, i) = rows
    mixed = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    # Of three unit vectors, only a right-handed orthonormal triad reaches 1.
    return bool(abs(mixed - 1) < 1e-9)


def _increases(value: Any) -> bool:
    return _is_vector(value) and all(
        first < second for first, second in zip(value, value[1:], strict=False)
    )


def _unit(length: int, dice: random.Random) -> list[float]:
    vector = [dice.gauss(0, 1) for _ in range(length)]
    size = math.hypot(*vector)
    return [part / size for part in vector]


def _rotation(dice: random.Random) -> list[list[float]]:
    w, x, y, z = _unit(4, dice)
    return [
        [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
        [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
        [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
    ]
