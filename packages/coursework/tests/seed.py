"""What tests draw by lot they draw from this: the same every day, and
another lot where it is set, as at night.
"""

import os

SEED = os.environ.setdefault("BOOK_TEST_SEED", "every day")


def spread(cases, number):
    """So many of the cases, spread evenly from the first to the last.

    >>> spread("abcdefghij", 3), spread("abcdefghij", 1), spread("ab", 5)
    (['b', 'f', 'i'], ['f'], ['a', 'b'])
    """
    number = min(number, len(cases))
    return [cases[len(cases) * (2 * k + 1) // (2 * number)] for k in range(number)]
