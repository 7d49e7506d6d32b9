"""``python -m notebook_pages.whole_book``: the whole book as a PDF, as an EPUB and as a zip.

All are made from the built site and put into it, and the front page links to them. Each is made
again only when its sources have changed; `make book` removes those that are outdated.
"""

import json
import os
import re
import sys
import time
from hashlib import sha256
from pathlib import Path

import yaml

from . import install, offline, unchanged
from .paths import (
    BUILD,
    HTML,
    REGISTERED,
    WEBSITE,
    YAML,
    fingerprint,
    let_everybody_read,
    pages,
)

NAME = REGISTERED.get("name", "book")
FOLDER = HTML / "take-away"
PDF, EPUB, ZIP = (FOLDER / f"{NAME}.{ending}" for ending in ("pdf", "epub", "zip"))
# The file with a fingerprint of their sources.
STAMPS = BUILD / "whole-book.json"
FRONT = "index.html"
# The place for the links on the front page: a comment, and the text up to the second comment.
PLACE = re.compile(r"<!-- whole-book -->(?:.*?<!-- /whole-book -->)?", re.DOTALL)
LINK = '<a href="take-away/{name}">{title}<small>{note}, {size:.1f} MB</small></a>'


def with_offer(front, links):
    """Return ``front`` with ``links`` in their place or, without links, as the build wrote it."""
    words = (
        '<p class="whole-book"><span>The whole book, to take with you:</span>{}</p><!-- '
        "/whole-book -->"
    )
    front, count = PLACE.subn(
        "<!-- whole-book -->" + (words.format("".join(links)) if links else ""), front
    )
    if links and count != 1:
        raise RuntimeError(
            "the front page needs one place for the whole book, `<!-- whole-book -->`; "
            f"it has {count}"
        )
    return front


def site_files():
    """Return the files of the site, contents by path.

    The PDF, the EPUB, the zip and the links to them are left out.
    """
    files = {
        str(path.relative_to(HTML)): path.read_bytes()
        for path in sorted(HTML.rglob("*"))
        if path.is_file() and path not in (PDF, EPUB, ZIP, HTML / install.LIST)
    }
    files[FRONT] = with_offer(files[FRONT].decode(), []).encode()
    return files


def digest(files, *programs):
    """Return a hash of ``files``, contents by path, and of the programs that process them."""
    contents = [f"{path} {sha256(content).hexdigest()}" for path, content in sorted(files.items())]
    return sha256("\n".join([*contents, fingerprint(*programs)]).encode()).hexdigest()


def stamps():
    """Return a digest of the present sources of each."""
    files = site_files()
    kinds = tuple(f"{page}.html" for page in pages())
    printed = {
        path: text
        for path, text in files.items()
        if path in kinds or path.endswith((".css", ".woff2"))
    }
    programs = ("pdf.py", "spoken.py", "print.css", "browser.py")
    digests = {PDF.name: digest(printed, *(WEBSITE / name for name in programs))}
    texts = {path: text for path, text in files.items() if path in kinds}
    digests[EPUB.name] = digest(
        texts, *(WEBSITE / name for name in ("epub.py", "epub.css", "pdf.py", "spoken.py"))
    )
    for path in (PDF, EPUB):
        if path.exists():
            files[path.name] = path.read_bytes()
    return digests | {ZIP.name: digest(files, WEBSITE / "offline.py", offline.SERVER)}


def link_to_pdf():
    import pikepdf

    with pikepdf.open(PDF) as pdf:
        note = f"{len(pdf.pages)} pages"
    return LINK.format(name=PDF.name, title="PDF", note=note, size=PDF.stat().st_size / 1e6)


def link_to_epub():
    return LINK.format(
        name=EPUB.name, title="EPUB", note="for e-readers", size=EPUB.stat().st_size / 1e6
    )


def link_to_zip():
    return LINK.format(
        name=ZIP.name, title="Offline pages", note="a zip", size=ZIP.stat().st_size / 1e6
    )


def write_front_page():
    """Link to the existing downloads on the front page."""
    links = [
        link()
        for path, link in ((PDF, link_to_pdf), (EPUB, link_to_epub), (ZIP, link_to_zip))
        if path.exists()
    ]
    before = (HTML / FRONT).read_text("utf8")
    after = with_offer(before, links)
    if after != before:
        new = BUILD / FRONT
        new.write_text(after, "utf8")
        # Replace the file at once, so that nobody gets half a page.
        os.replace(new, HTML / FRONT)


def withdraw_outdated():
    """Remove outdated downloads from the site, and the links to them."""
    made_from = json.loads(STAMPS.read_text("utf8")) if STAMPS.exists() else {}
    for path in (PDF, EPUB, ZIP):
        if path.exists() and made_from.get(path.name) != stamps()[path.name]:
            path.unlink()
    write_front_page()


def note_stamps():
    current = stamps()
    STAMPS.write_text(
        json.dumps({path.name: current[path.name] for path in (PDF, EPUB, ZIP) if path.exists()}),
        "utf8",
    )


def make_pdf(settings):
    from . import pdf

    PDF.write_bytes(
        pdf.make(HTML, BUILD / "print" / "book.html", settings["title"], settings["author"])
    )


def make_epub(settings):
    from . import epub

    EPUB.write_bytes(epub.make(HTML, settings["title"], settings["author"]))


def make_zip(settings):
    files = site_files()
    for path in (PDF, EPUB):
        files[f"take-away/{path.name}"] = path.read_bytes()
    files[FRONT] = with_offer(files[FRONT].decode(), [link_to_pdf(), link_to_epub()]).encode()
    ZIP.write_bytes(offline.pack(files, NAME, settings["title"]))


def main():
    if not (HTML / FRONT).is_file():
        sys.exit("There is no built book yet. Run `make book` first.")
    made_from = unchanged.of_sources()
    settings = yaml.load(Path("_config.yml").read_text("utf8"), YAML)
    withdraw_outdated()
    for path, make in ((PDF, make_pdf), (EPUB, make_epub), (ZIP, make_zip)):
        if not path.exists():
            start = time.monotonic()
            print(f"Making {path.name} ...", flush=True)
            make(settings)
            note_stamps()
            print(
                f"Made in {time.monotonic() - start:.0f} s: {path}, "
                f"{path.stat().st_size / 1e6:.1f} MB"
            )
    write_front_page()
    install.write_list(HTML)
    let_everybody_read(HTML)
    unchanged.note(made_from)


if __name__ == "__main__":
    main()
