"""What the moving figures show, one module for each kind: painted on paper as it
stands, and in the page translated.
"""
