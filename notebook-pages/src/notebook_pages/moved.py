"""What had another address in an earlier edition: whoever kept
that address gets to where it is now.

``moved`` in ``_config.yml`` names each page that is gone, and each place
on a page, with what took its place:

.. code-block:: yaml

    moved:
      chapters/old-name: chapters/new-name
      chapters/one#figure-old: chapters/two#figure-new

A page that is gone leaves one behind that leads on. A place that is gone is found where the new one
stands or, if that is on another page, in a last paragraph that says where it is.
"""

import html
import posixpath
import re
from pathlib import Path

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.errors import SphinxError

REDIRECT = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8" />
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title><meta name="robots" content="noindex"><link rel="canonical" href="{address}">
<meta http-equiv="refresh" content="1; url={address}">
<script>location.replace("{address}"{and_place})</script>
</head><body><p>This page has moved: <a href="{address}">{title}</a></p></body></html>
"""
NOTE = '<p class="moved" id="{old}">What stood here has moved: <a href="{address}">{title}</a></p>'


def parted(place: str) -> tuple[str, str]:
    page, _, name = place.partition("#")
    return page, name


def address_of(place: str, seen_from: str) -> str:
    """The address of a place, relative to the page it is ``seen_from``."""
    page, name = parted(place)
    return posixpath.relpath(f"{page}.html", posixpath.dirname(seen_from) or ".") + (
        f"#{name}" if name else ""
    )


def title_of(app: Sphinx, place: str) -> str:
    return html.escape(app.env.titles[parted(place)[0]].astext())


def keep_places(
    app: Sphinx,
    pagename: str,
    templatename: str,
    context: dict[str, str],
    doctree: nodes.document | None,
) -> None:
    """Let the old names of places on a page lead on."""
    for old, new in app.config.moved.items():
        page, name = parted(old)
        if page == pagename and name and doctree is not None and parted(new)[0] in app.env.titles:
            there = re.compile(rf'<[a-z0-9]+\b[^>]*\bid="{re.escape(parted(new)[1])}"')
            if parted(new)[0] == page and there.search(context["body"]):
                context["body"] = there.sub(
                    rf'<span id="{name}"></span>\g<0>', context["body"], count=1
                )
            else:
                context["body"] += NOTE.format(
                    old=name, address=address_of(new, page), title=title_of(app, new)
                )


def lead_on(app: Sphinx, exception: Exception | None) -> None:
    """Write the pages that lead on, and refuse what leads nowhere."""
    if exception or app.builder.format != "html":
        return
    site = Path(app.outdir)
    for old, new in app.config.moved.items():
        page, name = parted(new)
        file = site / f"{page}.html"
        if not file.is_file() or name and f'id="{name}"' not in file.read_text("utf8"):
            raise SphinxError(
                f"moved, in _config.yml: {old} leads to {new}, and the book has no such place."
            )
        gone, place = parted(old)
        if bool(place) != (gone in app.env.found_docs):
            raise SphinxError(
                f"moved, in _config.yml: {old} is no page that is gone, nor a place on one that is "
                "there."
            )
        if not place:
            target = site / f"{gone}.html"
            target.parent.mkdir(parents=True, exist_ok=True)
            and_place = "" if name else " + location.hash"
            about = {
                "address": address_of(new, gone),
                "title": title_of(app, new),
                "and_place": and_place,
            }
            target.write_text(REDIRECT.format(**about), "utf8")


def setup(app: Sphinx) -> None:
    app.add_config_value("moved", {}, "env", dict)
    app.connect("html-page-context", keep_places)
    app.connect("build-finished", lead_on, priority=900)  # before the pages get their policies
