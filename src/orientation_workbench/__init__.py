"""Where the world's numbers meet this book: two programs that disagree, and recordings that are to be judged."""

from .mismatch.explanation import Explanation, explain

__all__ = ["Explanation", "explain"]
