"""Metadata of the pages for search engines, for shared links, for programs, and for corrections.

The title and the author are in ``_config.yml``. So are, once the book has them, its address
(``html.baseurl``) and its repository (``repository.url``, ``repository.branch``), which
BOOK_ADDRESS and BOOK_REPOSITORY replace in a workflow that publishes. The edition, its date and its
DOI are in ``CITATION.cff``, from which the directive ``cite-this-book`` writes the citation.
"""

import html
import os
import re
from pathlib import Path
from urllib.parse import quote, urlencode, urlsplit

from docutils import nodes
from sphinx.util.docutils import SphinxDirective

from .execution import STORED
from .paths import LICENCES, edition

# In characters; no site shows a longer description.
LONGEST = 200
SHORTEST = 50
# Elements beside the text.
ASIDE = (nodes.Admonition, nodes.figure, nodes.list_item, nodes.table)


def take_addresses(app, config):
    """Let the environment set the address at which the book is published."""
    if address := os.environ.get("BOOK_ADDRESS"):
        config.html_baseurl = address
    if config.html_baseurl and not config.html_baseurl.endswith("/"):
        config.html_baseurl += "/"
    if repository := os.environ.get("BOOK_REPOSITORY"):
        config.html_theme_options["repository_url"] = repository.rstrip("/")
    config.book_edition = dict(
        edition(Path(app.srcdir))._asdict(), words=edition(Path(app.srcdir)).words
    )


def description(doctree):
    """Return the first paragraph of a page without a displayed formula, cut to length."""
    for paragraph in doctree.findall(nodes.paragraph):
        inside = paragraph.parent
        while inside is not None and not isinstance(inside, ASIDE):
            inside = inside.parent
        words = " ".join(paragraph.astext().replace(r"^\circ", "°").split())
        # Remove the names of sources.
        words = re.sub(r" ?\[[^]]*\b\d{4}\w?\]", "", words)
        formula = any(
            set(node.astext().replace(r"^\circ", "")) & set(r"\{^_")
            for node in paragraph.findall(nodes.math)
        )
        if inside is None and not formula and len(words) >= SHORTEST and not words.endswith(":"):
            return shortened(words)
    return ""


def shortened(words):
    """Shorten ``words`` to at most LONGEST characters, at the end of a sentence or a word."""
    if len(words) <= LONGEST:
        return words
    sentences = words[: LONGEST + 1].rpartition(". ")[0]
    return (
        f"{sentences}."
        if len(sentences) >= SHORTEST
        else f"{words[: LONGEST - 4].rpartition(' ')[0]} ..."
    )


def plain_title(context):
    return html.unescape(re.sub(r"<[^>]+>", "", context.get("title") or "")).strip()


def write_head(app, pagename, templatename, context, doctree):
    """Give the page's template its description, and the addresses for corrections."""
    book = app.config.html_title
    # Both the theme and docutils add a tag for the size of the screen.
    context["metatags"] = re.sub(
        r'<meta[^>]*name="viewport"[^>]*>\s*', "", context.get("metatags") or ""
    )
    title = plain_title(context)
    words = description(doctree) if doctree is not None else ""
    if words and pagename.startswith(STORED):
        # Such pages begin alike.
        words = shortened(f"{title}. {words}")
    context["description"] = words or f"{title}: a page of {book}."
    context["shared_title"] = book if pagename == app.config.root_doc else f"{title} – {book}"
    context["shared_kind"] = "book" if pagename == app.config.root_doc else "article"
    context["edition"] = app.config.book_edition
    context["licences"] = LICENCES
    repository = (
        context.get("theme_repository_url")
        or app.config.html_theme_options.get("repository_url")
        or ""
    )
    context["repository"] = repository
    if repository and doctree is not None:
        source = os.path.relpath(app.env.doc2path(pagename), app.srcdir)
        branch = app.config.html_theme_options.get("repository_branch") or "main"
        which = app.config.book_edition["words"]
        body = f"Page: {title} ({pagename})\nSection: \n{which}\n\nWhat is wrong:\n"
        context["report_mistake"] = (
            f"{repository}/issues/new?{urlencode({'title': f'{title}: ', 'body': body})}"
        )
        context["suggest_change"] = f"{repository}/edit/{branch}/{quote(source)}"


def in_order(env):
    """Return the pages in the order of the table of contents."""
    ordered, waiting = [], [env.config.root_doc]
    while waiting:
        page = waiting.pop(0)
        if page not in ordered:
            ordered.append(page)
            waiting = [*env.toctree_includes.get(page, []), *waiting]
    return [*ordered, *sorted(env.found_docs - set(ordered))]


# This page is shown at any address, so its links must not be relative. If no address is set, the
# script looks for the book.
NOT_FOUND = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8" />
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>No such page - {title}</title><meta name="robots" content="noindex">
<style>:root {{ color-scheme: light dark }}
body {{ max-width: 34rem; margin: 15vh auto; padding: 0 1rem; font: 1.1rem/1.6 Georgia, serif;
  background: #fdfcfa; color: #1f2328 }}
a {{ color: #0a58ca }}
@media (prefers-color-scheme: dark) {{
  body {{ background: #16191d; color: #dfe2e6 }} a {{ color: #8ab8ff }}
}}</style>
</head><body><main><h1>There is no such page</h1>
<p>It may have been moved, or the address may be incomplete. Everything in <i>{title}</i> is one
step from its <a href="{front}index.html">front page</a>, and can be
<a href="{front}search.html">searched</a>.</p></main>
<script>
(async () => {{
  // The book begins at the deepest folder of this address in which it says what it is.
  for (let folder = new URL("./", location.href); ; folder = new URL("../", folder)) {{
    const answer = await fetch(new URL("manifest.webmanifest", folder)).catch(() => null);
    const found = answer?.ok && await answer.json();
    if (found?.name === document.querySelector("i").textContent) {{
      for (const link of document.links)
        link.href = new URL(link.getAttribute("href").split("/").at(-1), folder);
      break;
    }}
    if (folder.pathname === "/") break;
  }}
}})().catch(() => {{}});
</script></body></html>
"""


def write_files(app, exception):
    """Write the files that servers and crawlers look for beside the pages."""
    if exception or app.builder.format != "html":
        return
    site, address = Path(app.outdir), app.config.html_baseurl or ""
    # GitHub Pages would otherwise leave out folders whose names begin with an underscore.
    (site / ".nojekyll").touch()
    # This page is shown at any address, so only the path from the server's root works in its links.
    front = urlsplit(address).path or "/"
    (site / "404.html").write_text(
        NOT_FOUND.format(title=html.escape(app.config.html_title), front=front), "utf8"
    )
    robots = "User-agent: *\nAllow: /\n"
    sitemap = site / "sitemap.xml"
    sitemap.unlink(missing_ok=True)
    # A sitemap needs complete addresses.
    if address:
        robots += f"Sitemap: {address}sitemap.xml\n"
        pages = "".join(
            f"<url><loc>{html.escape(address + quote(page))}.html</loc></url>\n"
            for page in in_order(app.env)
        )
        sitemap.write_text(
            f'<?xml version="1.0" encoding="utf-8"?>\n'
            f'<urlset xmlns="http://www.sitemaps.org/schemas/sitemap/0.9">\n{pages}</urlset>\n',
            "utf8",
        )
    (site / "robots.txt").write_text(robots, "utf8")


class CiteThisBook(SphinxDirective):
    """Write how to cite the book, in words and as BibTeX."""

    def run(self):
        config, which = self.config, edition(Path(self.env.srcdir))
        self.env.note_dependency(str(Path(self.env.srcdir, "CITATION.cff")))
        address = f"https://doi.org/{which.doi}" if which.doi else config.html_baseurl or ""
        words = [
            nodes.Text(f"{config.author}, "),
            nodes.emphasis("", config.html_title),
            nodes.Text(f". {which.words}."),
        ]
        if address:
            words += [
                nodes.Text(" "),
                nodes.reference("", address, refuri=address),
                nodes.Text("."),
            ]
        fields = {
            "title": config.html_title, "author": f"{{{config.author}}}", "edition": which.name,
            "year": which.date[:4], "date": which.date, "doi": which.doi,
            "url": config.html_baseurl,
        }  # fmt: skip
        key = re.sub(r"[^a-z]+", "-", config.html_title.lower())
        lines = [f"  {name} = {{{value}}}," for name, value in fields.items() if value]
        code = nodes.literal_block(
            "", "\n".join([f"@book{{{key},", *lines, "}"]), language="bibtex"
        )
        return [nodes.paragraph("", "", *words), code]


def setup(app):
    app.add_directive("cite-this-book", CiteThisBook)
    app.add_config_value("book_edition", {}, "html", dict)
    app.connect("config-inited", take_addresses)
    app.connect("html-page-context", write_head)
    app.connect("build-finished", write_files)
