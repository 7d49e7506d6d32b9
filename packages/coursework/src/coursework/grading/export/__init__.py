"""Handed on: marks for the systems that others keep."""
