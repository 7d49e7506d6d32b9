"""Where the world's numbers meet this book: two programs that disagree,
and recordings that are to be judged.
"""

__all__ = ["Convention", "Explanation", "assert_convention", "convention_of", "explain"]


def __getattr__(name):
    # The table of mix-ups is read where there is no NumPy; the search needs it.
    if name in ("Explanation", "explain"):
        from .mismatch import explanation

        return getattr(explanation, name)
    if name in __all__:
        from . import kit

        return getattr(kit, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
