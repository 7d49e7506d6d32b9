"""The picture that stands for a page where it is passed on: its first figure,
on white, as a PNG of 1200 by 630.

Whoever shows a link fetches the picture by its whole address: pages
name it only where the book has one.
"""

import html
import re
from hashlib import sha256
from pathlib import Path
from types import SimpleNamespace

from .paths import REGISTERED, fingerprint, named

FOLDER = "pictures"
#: The style sheet of the book's figures, and its colours on a light page by their names.
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
    """So many per cent of ``colour`` on white."""
    parts = [int(colour[k : k + 2], 16) for k in (1, 3, 5)]
    return "#" + "".join(f"{round(255 + (part - 255) * per_cent / 100):02x}" for part in parts)


def plain_colours(text):
    """``text`` with the colours of the light page where it names them, and
    none of those where it defines them.
    """
    text = re.sub(r"--[\w-]+:[^;]*;", "", text)
    return re.sub(r"var\(--([\w-]+)[^)]*\)", lambda name: FIGURES.LIGHT.get(name[1], SHEET), text)


def plain_style():
    """The style sheet of the figures without variables and mixtures, which
    programs that draw SVG do not know.
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
    """The first figure of a page: its SVG, the shape of its sheet, and what it
    says to those who do not see it.
    """
    found = FIGURE.search(body or "")
    if not found:
        return None
    # Outlines that several figures of a page share may be stored outside the figure.
    shared = "".join(
        re.search(rf'<path [^>]*id="{name}"[^>]*>', body)[0]
        for name in dict.fromkeys(re.findall(r'<use [^>]*href="#([^"]+)"', found[0]))
        if f'id="{name}"' not in found[0]
    )
    figure = found[0].replace(">", f"><defs>{shared}</defs>", 1)
    # Where much of the sheet is empty.
    inner = re.search(r'^<svg [^>]*data-box="([^"]*)"', found[0])
    return (
        figure,
        [float(number) for number in (inner or found)[1].split()],
        html.unescape(found[2]),
    )


def drawn(figure, box):
    """The PNG of a figure, as large as it fits."""
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
    """Draw the page's picture, and tell its template where it is and what it shows."""
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
