"""The seed from which all tests draw, so that every run has the same verdict."""

SEED = "every day"


def spread(cases, number):
    """Return so many of the cases, spread evenly from the first to the last.

    >>> spread("abcdefghij", 3), spread("abcdefghij", 1), spread("ab", 5)
    (['b', 'f', 'i'], ['f'], ['a', 'b'])
    """
    number = min(number, len(cases))
    return [cases[len(cases) * (2 * k + 1) // (2 * number)] for k in range(number)]
