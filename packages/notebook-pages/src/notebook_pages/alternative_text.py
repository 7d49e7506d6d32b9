"""Check that every picture has a text description; the build warns if one is missing.

The check covers the pictures of the text and those that cells display, after Sphinx has chosen
which form of an output the page shows.
"""

from bs4 import BeautifulSoup
from docutils import nodes
from sphinx.util import logging

from .paths import where

FEWEST_WORDS = 4

logger = logging.getLogger(__name__)


def says_something(text):
    return len((text or "").split()) >= FEWEST_WORDS


def spoken_text(tag, page):
    """Return the text that a screen reader speaks for ``tag``, or ``None`` if it skips it."""
    if any(element.get("aria-hidden") == "true" for element in [tag, *tag.parents]):
        return None
    if tag.name == "img":
        return tag.get("aria-label") or tag.get("alt") or ""
    if tag.name == "svg" and tag.get("role") != "img":
        # Without the role, screen readers spell out the labels inside it.
        return ""
    if tag.get("aria-labelledby"):
        named = page.find(id=tag["aria-labelledby"])
        return named.get_text() if named else ""
    title = tag.find("title", recursive=False)
    return tag.get("aria-label") or (title.get_text() if title else "")


def check(app, doctree, docname):
    for node in doctree.findall():
        if isinstance(node, nodes.image):
            texts = [node.get("alt")]
        elif isinstance(node, nodes.raw) and "html" in node.get("format", "").split():
            soup = BeautifulSoup(node.astext(), "html.parser")
            pictures = soup.find_all(["img", "svg", "canvas", "video"])
            outer = [tag for tag in pictures if not tag.find_parent("svg")]
            texts = [text for tag in outer if (text := spoken_text(tag, soup)) is not None]
        else:
            continue
        for text in texts:
            if not says_something(text):
                logger.warning(
                    "a figure has no alternative text (found %r); describe in words what it shows",
                    text or "",
                    location=where(node) or docname,
                    type="website",
                    subtype="alternative_text",
                )


def setup(app):
    app.connect("doctree-resolved", check, priority=900)
