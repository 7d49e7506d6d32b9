"""What an author uses: questions from notebooks with solutions,
their release and their selftest.
"""
