"""Where the world's numbers meet this book: two programs that disagree, and recordings that are to be judged."""

__all__ = ["Explanation", "explain"]


def __getattr__(name):
    # The table of mix-ups is read where there is no NumPy; the search needs it.
    if name in __all__:
        from .mismatch import explanation

        return getattr(explanation, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
