"""The part of IPython that code in the page can use: display, and nothing of its terminal.

``lib/pretty.py`` beside this file is IPython's own, which writes values as plain text.
"""

version_info = (9, 0)
__version__ = "9.0"


# The only shell of this Python process, once the page has started it.
shell = None


def get_ipython():
    return shell
