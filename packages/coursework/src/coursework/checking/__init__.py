"""The student's imports: the check, the sealed questions and the replies."""
