"""Handed in: what was handed in, and by whom."""
