"""The site as one zip file, for reading from a disk without a network.

Its bytes depend only on its content: the files are in order and have one date.
"""

import io
import re

from .packing import write_zip
from .paths import LICENCES_SAID, WEBSITE

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
    packed = io.BytesIO()
    write_zip(packed, {f"{name}/{path}": content for path, content in files.items()})
    return packed.getvalue()
