"""What this book's authors run: to begin a chapter or a question, to check
chapters, to compare with other machines.
"""
