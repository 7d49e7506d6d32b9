"""Submissions: what students handed in, and who they are."""
