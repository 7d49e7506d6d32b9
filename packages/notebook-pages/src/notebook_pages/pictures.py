"""The preview picture of a page when it is shared: its first figure on white, a PNG of 1200 by 630.

Sites that show a link fetch the picture by its full address, so pages name it only if the book has
one.
"""

import html
import re
from hashlib import sha256
from pathlib import Path
from types import SimpleNamespace

from .paths import REGISTERED, fingerprint, named

FOLDER = "pictures"
# The style sheet of the book's figures, and its colours on a light page by their names.
FIGURES = (
    named(REGISTERED["style"])
    if "style" in REGISTERED
    else SimpleNamespace(STYLE="", LIGHT={"ink": "#000000"})
)
WIDTH, HEIGHT, MARGIN = 1200, 630, 40
# In bytes. Some sites that show previews accept no larger pictures.
LARGEST = 300_000
FIGURE = re.compile(
    r'<svg (?=[^>]*viewBox="([^"]*)")(?=[^>]*role="img")'
    r'(?=[^>]*aria-label="([^"]*)")[^>]*>.*?</svg>',
    re.S,
)
MIX = re.compile(r"color-mix\(in srgb,currentColor (\d+)%,var\(--sheet\)\)")
SHEET = "#ffffff"


def mixed(colour, per_cent):
    """Mix ``per_cent`` of ``colour`` with white."""
    parts = [int(colour[k : k + 2], 16) for k in (1, 3, 5)]
    return "#" + "".join(f"{round(255 + (part - 255) * per_cent / 100):02x}" for part in parts)


def plain_colours(text):
    """Return ``text`` with light-page colours in place of their names and definitions."""
    text = re.sub(r"--[\w-]+:[^;]*;", "", text)
    return re.sub(r"var\(--([\w-]+)[^)]*\)", lambda name: FIGURES.LIGHT.get(name[1], SHEET), text)


def plain_style():
    """Return the style sheet of the figures without variables and mixed colours.

    Programs that draw SVG do not know these.
    """
    rules = []
    for selector, rule in re.findall(
        r"([^{}]+)\{([^{}]*)\}", FIGURES.STYLE.partition("html[data-theme")[0]
    ):
        selector = selector.replace(".orientation-figure", "").strip() or "g"
        if mix := MIX.search(rule):
            for name, colour in FIGURES.LIGHT.items():
                rules.append(
                    f"{selector}.{name}{{{rule.replace(mix[0], mixed(colour, int(mix[1])))}}}"
                )
        else:
            rules.append(
                f"{'g.figure' if selector == 'svg' else selector}{{{plain_colours(rule)}}}"
            )
    return "".join(rules)


def first_figure(body):
    """Return the first figure of a page: its SVG, the shape of its sheet, and its description."""
    match = FIGURE.search(body or "")
    if not match:
        return None
    # Outlines that several figures of a page share may be stored outside the figure.
    shared = "".join(
        re.search(rf'<path [^>]*id="{name}"[^>]*>', body)[0]
        for name in dict.fromkeys(re.findall(r'<use [^>]*href="#([^"]+)"', match[0]))
        if f'id="{name}"' not in match[0]
    )
    figure = match[0].replace(">", f"><defs>{shared}</defs>", 1)
    # Use the inner box where much of the sheet is empty.
    inner = re.search(r'^<svg [^>]*data-box="([^"]*)"', match[0])
    return (
        figure,
        [float(number) for number in (inner or match)[1].split()],
        html.unescape(match[2]),
    )


def drawn(figure, box):
    """Return the PNG of a figure, as large as it fits."""
    import resvg_py

    left, top, width, height = box
    scale = min((WIDTH - 2 * MARGIN) / width, (HEIGHT - 2 * MARGIN) / height)
    across, down = (
        (WIDTH - scale * width) / 2 - scale * left,
        (HEIGHT - scale * height) / 2 - scale * top,
    )
    inner = plain_colours(figure.partition(">")[2].rpartition("</svg>")[0])
    own = re.search(r'^<svg [^>]*style="([^"]*)"', figure)
    svg = (
        '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
        f'width="{WIDTH}" '
        f'height="{HEIGHT}"><rect width="{WIDTH}" height="{HEIGHT}" fill="{SHEET}"/>'
        f'<g class="figure" color="{FIGURES.LIGHT["ink"]}" transform="translate({across:g} '
        f'{down:g}) scale({scale:g})">'
        f'<g style="{own[1] if own else ""}">{inner}</g></g></svg>'
    )
    return bytes(
        resvg_py.svg_to_bytes(svg_string=svg, style_sheet=plain_style(), skip_system_fonts=True)
    )


def write_picture(app, pagename, templatename, context, doctree):
    """Draw the page's picture, and give its address and description to the page's template."""
    address, figure = app.config.html_baseurl, first_figure(context.get("body"))
    if not address or doctree is None or figure is None:
        return
    name = sha256((figure[0] + fingerprint(Path(__file__))).encode()).hexdigest()[:12]
    picture = Path(app.outdir, FOLDER, f"{name}.png")
    if not picture.exists():
        content = drawn(*figure[:2])
        if len(content) > LARGEST:
            return
        picture.parent.mkdir(parents=True, exist_ok=True)
        picture.write_bytes(content)
    context["picture"] = {
        "address": f"{address}{FOLDER}/{name}.png", "words": figure[2], "width": WIDTH,
        "height": HEIGHT,
    }  # fmt: skip


def setup(app):
    app.connect("html-page-context", write_picture)
