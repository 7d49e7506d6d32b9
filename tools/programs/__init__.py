"""What other programs answer, asked anew: ``python -m tools.programs`` prints what changed."""
