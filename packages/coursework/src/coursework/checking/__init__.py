"""What a student imports: the check, the sealed questions and the replies."""
