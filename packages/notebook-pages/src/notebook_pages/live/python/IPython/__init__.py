"""What code in the page finds of IPython: displaying, and nothing of its terminal.

``lib/pretty.py`` beside this file is IPython's own: it writes values as plain text.
"""

version_info = (9, 0)
__version__ = "9.0"


#: The one shell of this run of Python, once the page has started it.
shell = None


def get_ipython():
    return shell
