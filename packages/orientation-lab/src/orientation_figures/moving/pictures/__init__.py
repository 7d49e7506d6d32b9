"""The pictures of the interactive figures, one module for each kind.

Python draws them on paper, and they are translated for the page.
"""
