"""The pictures of the book, beside its mathematics: drawings, plots, animations
and figures that the reader moves.

This package draws with what :mod:`orientation` computes; ``orientation`` knows nothing of it.
"""
