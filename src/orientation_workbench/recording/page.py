"""A recording judged where a reader drops it: the report, to be looked at and to be kept."""

import base64
from html import escape
from pathlib import Path

from .bench import examine
from .report import as_fragment, as_html, as_text
from .table import RecordingError

#: Where the pages put what is dropped.
DROPPED = "dropped"


class Judged:
    """A report that a notebook shows as a table with plots, and a link under which it can be saved.

    Attributes
    ----------
    examined : Examined or None
    words : str
        What there is to say instead of a report.
    """

    def __init__(self, examined=None, words=""):
        self.examined, self.words = examined, words

    def __repr__(self):
        return self.words if self.examined is None else as_text(self.examined)

    def _repr_html_(self):
        if self.examined is None:
            return f"<p>{escape(self.words)}</p>"
        fragment = as_fragment(self.examined)
        page = base64.b64encode(as_html(self.examined, fragment).encode()).decode()
        link = f'<a download="report.html" href="data:text/html;base64,{page}">Save this report as one page</a>'
        return f"<p>{link}</p>{fragment}"


def judged(source=DROPPED, rate=None):
    """Put what was dropped, or a file of one's own, on the bench.

    Parameters
    ----------
    source : path
        A file, or a folder with files of one recording.
    rate : float, optional
        Samples per second, where the file only counts them.

    Returns
    -------
    Judged
        With a report, or with the word why there is none.

    Examples
    --------
    >>> judged('no such place')
    no recording yet
    """
    import matplotlib  # noqa: F401 - a page that does not hold it is asked for it here, not in the middle of the work

    path = Path(source)
    files = [path] if path.is_file() else sorted(path.iterdir()) if path.is_dir() else []
    if not files:
        return Judged(words="no recording yet")
    name = ", ".join(one.name for one in files)
    try:
        return Judged(examine(files if len(files) > 1 else files[0], name, rate))
    except RecordingError as error:
        return Judged(words=f"{name} cannot be judged: {error}")
