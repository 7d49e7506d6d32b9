"""The pictures of the book: drawings, plots, animations and interactive figures.

This package draws what `orientation` computes; ``orientation`` does not import it.
"""
