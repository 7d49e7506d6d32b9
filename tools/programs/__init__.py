"""Compare the answers of other programs with the stored ones: ``python -m tools.programs``."""
