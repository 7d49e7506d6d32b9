"""Previews of the targets of links (equations, figures, terms, sources) for ``static/previews.js``.

A target on the same page is shown from there. For each page that others link to in this way, the
build writes one script with those targets, which is fetched when the first of them is requested. It
is a script because a page opened from a disk may fetch nothing else. The pages themselves do not
grow.
"""

import json
import posixpath
import re
from collections import defaultdict
from pathlib import Path

from .finish import pages_of

FOLDER = Path("_static", "previews")
LINK = re.compile(
    r'<a class="reference internal" href="([\w./-]+)\.html#((?:equation-|fig|term-|id\d)[^"]*)"'
)
OUTLINES = re.compile(r'href="#(o\d+)"')


def element_at(text, name):
    """Return the element with the ID ``name`` and all that it contains, or None."""
    begin = re.search(rf'<(\w+)\b[^>]*?\sid="{re.escape(name)}"[^>]*>', text)
    if not begin:
        return None
    depth = 0
    for tag in re.compile(rf"<(/?){begin[1]}\b[^>]*>").finditer(text, begin.start()):
        depth += -1 if tag[1] else 1
        if depth == 0:
            return text[begin.start() : tag.end()]
    raise ValueError(f"the element {name} has no end tag")


def plain(shown):
    """Return the HTML without links and IDs."""
    shown = re.sub(
        r'<a class="headerlink".*?</a>|<span class="label">.*?</span>(?=\s*<p)',
        "",
        shown,
        flags=re.DOTALL,
    )
    return re.sub(r'</?a\b[^>]*>|\sid="[^"]*"', "", shown)


def figure(page, outline):
    """Return a figure for other pages: its caption, and its drawing with its style and outlines.

    In its own page, the drawing shares the style and the outlines of letters with others.
    """
    drawing = re.search(r"<svg\b.*?</svg>", outline, re.DOTALL)
    caption = re.search(r"<figcaption>.*</figcaption>", outline, re.DOTALL)
    style = re.search(r"<style>\.orientation-figure.*?</style>", page, re.DOTALL)
    if not (drawing and caption and style):
        return None
    names = dict.fromkeys(OUTLINES.findall(drawing[0]))
    paths = "".join(
        outline[0] for name in names if (outline := re.search(rf'<path id="{name}"[^>]*/>', page))
    )
    outlines = (
        f'<svg width="0" height="0" style="position:absolute"><defs>{paths}</defs></svg>'
        if paths
        else ""
    )
    shown = (
        f'{style[0]}{outlines}<div class="orientation-figure">{drawing[0]}</div>{plain(caption[0])}'
    )
    return re.sub(r'((?:id="|href="#))(?=o\d+")', r"\1preview-", shown)


def preview(page, name):
    """Return the HTML of the place ``name`` of a page, without its links and IDs.

    Returns None if it is none of the kinds that have previews.
    """
    if name.startswith("term-"):
        begin = page.find(f'<dt id="{name}"')
        shown = (
            f'<dl class="glossary">{page[begin : page.index("</dd>", begin)]}</dd></dl>'
            if begin >= 0
            else None
        )
    elif (shown := element_at(page, name)) and shown.startswith("<figure"):
        return figure(page, shown)
    if not shown or (name.startswith("id") and 'class="citation"' not in shown):
        return None
    return plain(shown)


def write(site):
    texts = {
        path.relative_to(site).with_suffix("").as_posix(): path.read_text("utf8")
        for path in pages_of(site)
    }
    linked = defaultdict(set)
    for page, text in texts.items():
        for path, name in LINK.findall(text):
            linked[posixpath.normpath(posixpath.join(posixpath.dirname(page), path))].add(name)
    folder = site / FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    for outdated in folder.iterdir():
        outdated.unlink()
    for page in sorted(linked.keys() & texts.keys()):
        shown_by_name = {name: preview(texts[page], name) for name in sorted(linked[page])}
        if shown_by_name := {name: shown for name, shown in shown_by_name.items() if shown}:
            data = json.dumps(shown_by_name, ensure_ascii=False, separators=(",", ":"))
            text = f"(self.previews ??= {{}})[{json.dumps(page)}]={data};"
            (folder / f"{page.replace('/', '-')}.js").write_text(text, "utf8")


def finish(app, exception):
    if not exception and app.builder.format == "html":
        write(Path(app.outdir))


def setup(app):
    app.add_js_file("previews.js", loading_method="defer")
    # Run after all pages are written and before their files are listed.
    app.connect("build-finished", finish, priority=965)
