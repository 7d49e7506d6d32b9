"""Pages with one figure each, to embed in other people's pages: in a frame, or as an HTML element.

Both show a figure in the state that an address gives (see ``address.py``). The element's name ends
in its version, and it defines no other name in the page. It only creates the frame and sets the
height that the figure requests.
"""

from importlib import import_module

from ..rotations import Gimbal
from ..rotations import style as painted_style
from ..style import STYLE
from . import bundle

FOLDER = "embed"
ELEMENT = "orientation-figure-1"
PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<title>A figure of Orientation of Reference Frames: {kind}</title>
<meta name="viewport" content="width=device-width"><meta name="robots" content="noindex">
<link rel="icon" href="data:,">
<style>html {{ --pst-color-background: #fff; background: #fff; color: #1d2125;
font: 16px/1.6 system-ui, sans-serif; }}
html[data-theme="dark"] {{ --pst-color-background: #121212; background: #121212; color: #eceff2; }}
body {{ margin: 0; padding: 8px; }} figure {{ margin: 0; }}
h1 {{ position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%); }}
.world {{ height: 540px !important; }}
.source {{ margin: 0.4rem 0 0; font-size: 0.8rem; text-align: right; }}
.source a {{ color: inherit; }}
{style}</style><link rel="stylesheet" href="../_static/moving/{sheet}.css">
<script>
{{
  const asked = new URLSearchParams(location.search).get('theme');
  const dark = asked ? asked === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
  document.documentElement.dataset.theme = dark ? 'dark' : 'light';
  const tell = () =>
    parent.postMessage({{ orientationFigure: 1, height: document.body.offsetHeight }}, '*');
  addEventListener('load', () => new ResizeObserver(tell).observe(document.body));
}}
</script>{scripts}</head>
<body><main><h1>A figure of Orientation of Reference Frames: {kind}</h1>{figure}
<p class="source">From
<a href="../index.html" target="_blank" rel="noopener">Orientation of Reference Frames</a></p>
</main></body></html>
"""
SCRIPT = """(() => {
  const name = 'NAME', here = document.currentScript.src;
  if (customElements.get(name)) return;
  customElements.define(name, class extends HTMLElement {
    connectedCallback() {
      if (this.firstChild) return;
      const kind = (this.getAttribute('figure') ?? 'rotations').replace(/[^a-z_]/g, '');
      const asked = this.getAttribute('theme');
      const theme = ['dark', 'light'].includes(asked) ? `?theme=${asked}` : '';
      const frame = document.createElement('iframe');
      const given = this.getAttribute('state') ?? '';
      const state = /^#[a-z0-9=._-]+$/i.test(given) ? given : '';
      frame.src = new URL(`${kind}.html${theme}${state}`, here).href;
      frame.title = this.getAttribute('title') ?? 'A figure that can be moved';
      frame.loading = 'lazy';
      frame.allow = 'accelerometer; gyroscope; magnetometer; clipboard-write';
      frame.style.cssText = 'display: block; width: 100%; height: 600px; border: 0';
      addEventListener('message', ({ source, data }) => {
        if (source !== frame.contentWindow || data?.orientationFigure !== 1) return;
        if (data.height > 0) frame.style.height = `${data.height}px`;
      });
      this.append(frame);
    }
  });
})();
"""


def figures():
    """Return the figures that can be embedded, by their kind."""
    package = import_module(__package__)
    all_figures = (getattr(package, name) for name in package.__all__)
    return {figure.kind: figure for figure in all_figures if getattr(figure, "kind", "")}


def line(site, kind, fragment=""):
    """Return the line of HTML that embeds a figure in a page: a frame.

    ``site`` is the address of the book, and ``fragment`` is a result of
    :func:`orientation_figures.moving.address.fragment_of`.

    >>> print(line('https://example.org/book/', 'gimbal'))  # doctest: +NORMALIZE_WHITESPACE
    <iframe src="https://example.org/book/embed/gimbal.html" title="A figure that can be moved"
    loading="lazy" width="100%" height="600" style="border: 0"></iframe>
    """
    return (
        f'<iframe src="{site.rstrip("/")}/{FOLDER}/{kind}.html{fragment}" title="A figure that can '
        'be moved" loading="lazy" width="100%" height="600" style="border: 0"></iframe>'
    )


def files():
    """Return the files in the folder ``embed`` of the site, texts by name."""
    texts = {f"{ELEMENT}.js": SCRIPT.replace("NAME", ELEMENT)}
    for kind, figure in figures().items():
        scripts = "".join(
            f'<script defer src="../_static/moving/{name}.js"></script>'
            for name in ("shared", kind)
        )
        texts[f"{kind}.html"] = PAGE.format(
            kind=kind, style="", sheet="moving", scripts=scripts, figure=figure().still()
        )
    for kind in bundle.BUILT:
        still = Gimbal("which-way")._repr_html_().replace("<figure ", "<figure data-play ", 1)
        scripts = f'<script defer src="../_static/moving/{kind}.js"></script>'
        style = STYLE + painted_style()
        texts[f"{kind}.html"] = PAGE.format(
            kind=kind, style=style, sheet=kind, scripts=scripts, figure=still
        )
    return texts
