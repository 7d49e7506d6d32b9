"""Judged: verdicts and points, and what people and the rules of a course make of them."""
