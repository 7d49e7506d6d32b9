"""Where the world's numbers meet this book: two programs that disagree,
and recordings that are to be judged.
"""

from importlib import import_module

__all__ = ["Convention", "Explanation", "assert_convention", "convention_of", "explain"]


def __getattr__(name):
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    # The table of mix-ups is read where there is no NumPy; the search needs it.
    module = ".mismatch.explanation" if name in ("Explanation", "explain") else ".kit"
    return getattr(import_module(module, __name__), name)
