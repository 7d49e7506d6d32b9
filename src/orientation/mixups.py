"""The names of mix-ups, for `orientation.diagnose` and comparisons of programs."""

TRANSPOSE = "the transpose, which is the inverse orientation"
CONJUGATE = "the conjugate, which is the inverse orientation"
SCALAR_LAST = "the scalar part comes last"
REVERSED = "the angles are in reverse order"


def wrong_sign(*turns: str) -> str:
    """Return the name of the mix-up in which the angles of some rotations have the wrong sign.

    Examples
    --------
    >>> from orientation.mixups import wrong_sign
    >>> wrong_sign('first', 'third')
    'the angles of the first and the third rotation have the wrong sign'
    """
    if len(turns) == 1:
        return f"the angle of the {turns[0]} rotation has the wrong sign"
    return f"the angles of the {' and the '.join(turns)} rotation have the wrong sign"
