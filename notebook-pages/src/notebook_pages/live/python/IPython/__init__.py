"""What code in the page finds of IPython: displaying, and nothing of its terminal.

``lib/pretty.py`` beside this file is IPython's own: it writes values as plain text.
"""

version_info = (9, 0)
__version__ = "9.0"


def get_ipython():
    import session

    return session.shell
