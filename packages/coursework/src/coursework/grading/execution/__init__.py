"""Isolated execution of notebooks, which returns their answers as plain data."""
