"""What mix-ups of conventions are called, for :func:`~orientation.diagnose` and for what compares
programs.
"""

TRANSPOSE = "the transpose, the orientation the other way round"
CONJUGATE = "the conjugate, the orientation the other way round"
SCALAR_LAST = "the scalar part stands last"
REVERSED = "the angles are in reverse order"


def wrong_sign(*turns: str) -> str:
    """What it is called that the angles of some turns, as ``'first'``, have the other sign.

    Examples
    --------
    >>> from orientation.mixups import wrong_sign
    >>> wrong_sign('first', 'third')
    'the angles of the first and the third turn have the wrong sign'
    """
    if len(turns) == 1:
        return f"the angle of the {turns[0]} turn has the wrong sign"
    return f"the angles of the {' and the '.join(turns)} turn have the wrong sign"
