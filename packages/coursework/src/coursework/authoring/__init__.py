"""Tools for authors: questions from notebooks with solutions, their release and their self-test."""
