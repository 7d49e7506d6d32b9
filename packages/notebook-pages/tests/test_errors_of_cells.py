"""What an error in a cell shows: the cell's own lines, and of the packages that
it calls nothing but what they say.
"""

import sys
import traceback

import numpy as np
import pytest

from notebook_pages.live.cells import PYTHON

sys.path.append(str(PYTHON))
import session  # noqa: E402 (it lies where the page's Python finds it)


def shown(code):
    with pytest.raises(Exception) as caught:
        exec(compile(code, "cell 7", "exec"), {"np": np})
    report = traceback.TracebackException.from_exception(caught.value, compact=True)
    session.shorten(report)
    return "".join(report.format())


def test_lines_of_packages_are_left_out():
    text = shown("one = 1\nnp.linalg.inv(np.zeros((2, 2)))")
    assert text.count("File") == 1 and 'File "cell 7", line 2' in text
    assert text.splitlines()[-1].endswith("Singular matrix")


def test_lines_of_the_cell_itself_are_all_there():
    text = shown("def half(x):\n    return np.linalg.inv(x)\n\n\nhalf(np.zeros((2, 2)))")
    assert text.count("File") == 2 and "line 5" in text and "line 2, in half" in text
