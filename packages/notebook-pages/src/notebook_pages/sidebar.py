"""The sidebars: the contents of the book in folding parts, and the contents of the page.

The part of this page is open, or else the first. The contents of the page include names of
functions.
"""

from bs4 import BeautifulSoup

UNUSED = ("reference", "internal", "toctree-l1")


def fold(soup):
    """Make each caption and its list one fold, and do not repeat the caption in the titles.

    Of *Exercises: Gimbal lock*, in the part *Exercises*, the sidebar shows *Gimbal lock*.
    """
    captions = soup.select("p.caption")
    current = [
        caption for caption in captions if caption.find_next_sibling("ul").select(".current")
    ]
    for caption in captions:
        pages, beginning = caption.find_next_sibling("ul"), f"{caption.get_text(strip=True)}: "
        for link in pages.select("a"):
            if link.get_text().startswith(beginning):
                words = link.get_text().removeprefix(beginning)
                link.string = words[0].upper() + words[1:]
        part, summary = soup.new_tag("details"), soup.new_tag("summary")
        if caption in (current or captions)[:1]:
            part["open"] = ""
        caption.insert_before(part)
        summary.append(caption.extract())
        part.extend([summary, pages.extract()])
    # Attributes of the sidebar that no rule uses are repeated some fifty times on each page.
    for entry in soup.select("li, a.internal"):
        entry["class"] = [name for name in entry["class"] if name not in UNUSED]
        if not entry["class"]:
            del entry["class"]
    return soup


def divide_names(soup):
    """Allow a line break after the underscores of a name that is too long for the line."""
    for name in soup.select("code .pre") if soup else ():
        name.replace_with(BeautifulSoup(str(name).replace("_", "_<wbr>"), "html.parser"))
    return soup


def fold_contents(app, pagename, templatename, context, doctree):
    if generate := context.get("generate_toctree_html"):
        context["generate_toctree_html"] = lambda *arguments, **named: fold(
            BeautifulSoup(str(generate(*arguments, **named)), "html.parser")
        )
    if list_sections := context.get("generate_toc_html"):
        context["generate_toc_html"] = lambda: divide_names(list_sections())


def setup(app):
    # Run after the theme has put its function there.
    app.connect("html-page-context", fold_contents, priority=960)
