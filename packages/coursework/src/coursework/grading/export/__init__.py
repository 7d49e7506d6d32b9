"""Export of marks to other systems."""
