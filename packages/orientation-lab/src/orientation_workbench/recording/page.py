"""A recording judged on a page: the report, to look at and to save."""

from __future__ import annotations

import base64
from html import escape
from pathlib import Path

from .bench import examine
from .examined import Examined, as_text
from .report import CONVENTIONS, as_csv, as_fragment, as_html
from .table import RecordingError

#: The folder where the pages put dropped files.
DROPPED = "dropped"
#: The most samples of a corrected recording on a page; beyond that, use the command.
LONGEST = 30_000


class Judged:
    """A report that a notebook shows as a table with plots and links to save the results.

    Attributes
    ----------
    examined : Examined or None
    words : str
        The message shown if there is no report.
    convention : str
        The convention of the orientation in the corrected recording.
    """

    def __init__(
        self, examined: Examined | None = None, words: str = "", convention: str = "wxyz"
    ) -> None:
        self.examined, self.words, self.convention = examined, words, convention

    def __repr__(self) -> str:
        return self.words if self.examined is None else as_text(self.examined)

    def _repr_html_(self) -> str:
        if self.examined is None:
            return f"<p>{escape(self.words)}</p>"
        fragment = as_fragment(self.examined)
        links = _link(
            "report.html",
            "text/html",
            as_html(self.examined, fragment),
            "Save this report as one page",
        )
        if len(self.examined.time) <= LONGEST:
            links += " · " + _link(
                "corrected.csv",
                "text/csv",
                as_csv(self.examined, self.convention),
                f"Save the corrected recording ({self.convention})",
            )
        return f"<p>{links}</p>{fragment}"


def _link(name: str, kind: str, text: str, words: str) -> str:
    content = base64.b64encode(text.encode()).decode()
    return f'<a download="{name}" href="data:{kind};base64,{content}">{words}</a>'


def judged(
    source: str | Path = DROPPED,
    rate: float | None = None,
    convention: str = "wxyz",
    columns: str = "",
) -> Judged:
    """Examine dropped files, or the reader's own.

    Parameters
    ----------
    source : path
        A file, or a folder with the files of one recording.
    rate : float, optional
        Samples per second, if the file only counts its samples.
    convention : str
        The convention of the orientation in the corrected recording: ``wxyz``, ``xyzw`` or
        ``yaw-pitch-roll``.
    columns : str
        The meaning of the columns, if the file does not give it, such as
        ``'time=1 gyroscope=2-4:rad/s accelerometer=5-7'``.

    Returns
    -------
    Judged
        With a report, or a message saying why there is none.

    Examples
    --------
    >>> judged('no such place')
    no recording yet
    """
    if convention not in CONVENTIONS:
        raise ValueError(f"unknown convention {convention!r}: choose {', '.join(CONVENTIONS)}")
    import matplotlib  # noqa: F401 - a page that does not hold it is asked for it here, not in the middle of the work

    path = Path(source)
    files = [path] if path.is_file() else sorted(path.iterdir()) if path.is_dir() else []
    if not files:
        return Judged(words="no recording yet")
    name = ", ".join(file.name for file in files)
    try:
        return Judged(
            examine(files if len(files) > 1 else files[0], name, rate, columns), "", convention
        )
    except RecordingError as error:
        return Judged(words=f"{name} cannot be judged: {error}")
