"""The site as one zip file, for reading from a disk without a network.

Its bytes depend only on its content: the files are in order and have one date.
"""

import io
import re
import zipfile

from .paths import LICENCES_SAID, WEBSITE, moment_of_sources

SERVER = WEBSITE / "serve.py"
# A page from a disk preloads nothing, and browsers complain about the hints.
AHEAD = re.compile(rb'\s*<link rel="preload"[^>]*>')
README = """{title}
{line}

This is the whole book, for reading without a network.

Unpack the zip, then open index.html in a browser. Everything that you read
works from there: the pages, the mathematics, the moving figures, the search
and the downloads.

Code that runs in the page, or in a notebook in the browser, is the one
exception: browsers load Python only from a server. If Python is on your
computer, start one in this folder with

    python serve.py

and open the address that it prints. It answers only your computer, and
needs no network either. (Cells that use NumPy or Matplotlib may fetch these
two from the network the first time, and say so.)

{licences}
"""


def pack(files, name, title):
    """Return the zip of ``files``, contents by path, in a folder called ``name``."""
    readme = README.format(title=title, line="=" * len(title), licences=LICENCES_SAID)
    files = {
        path: AHEAD.sub(b"", content) if path.endswith(".html") else content
        for path, content in files.items()
    }
    files = {"README.txt": readme.encode(), "serve.py": SERVER.read_bytes(), **files}
    date = moment_of_sources().timetuple()[:6]
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in sorted(files):
            entry = zipfile.ZipInfo(f"{name}/{path}", date)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.create_system, entry.external_attr = 3, 0o644 << 16
            archive.writestr(entry, files[path])
    return packed.getvalue()
