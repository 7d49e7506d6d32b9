"""The workbench: explains why two programs disagree, and examines recordings of sensors."""

from importlib import import_module

__all__ = ["Convention", "Explanation", "assert_convention", "convention_of", "explain"]


def __getattr__(name):
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    # The table of mix-ups must load without NumPy, which the search needs.
    return getattr(
        import_module(
            ".mismatch.explanation" if name in ("Explanation", "explain") else ".kit", __name__
        ),
        name,
    )
