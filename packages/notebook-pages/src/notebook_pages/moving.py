"""Moving figures: put their scripts on the pages that show them, without any script of widgets.

A cell that ends in a moving figure of the book displays a still, with the state of the figure, and
a widget for Jupyter. The page shows the still. One script for each kind of figure, which book.js
requests after the first view, makes it interactive.
"""

import shutil
from functools import cache
from hashlib import sha256
from pathlib import Path
from tempfile import TemporaryDirectory

from docutils import nodes

from .page import take_later
from .paths import REGISTERED, esbuild, named

WIDGET = "application/vnd.jupyter.widget-view+json"
# On a narrow screen the drawing of a figure stays in view, under the bar at the top of the page.
PAGE_STYLE = """
.cell_output .output:has(> .moving) { overflow: visible; }
.moving .stage { top: 3.5rem; }
"""


def prefer_stills(app, config):
    """Prefer the other forms of an output to a widget, which needs a kernel."""
    config.nb_mime_priority_overrides = [*config.nb_mime_priority_overrides, ("*", WIDGET, None)]


def drop_widget_state(app, doctree):
    """Remove the widgets' state, and the scripts that MyST-NB would load from other servers."""
    scripts = app.env.nb_metadata.get(app.env.docname, {}).get("js_files", {})
    for key in [key for key in scripts if key.startswith("ipywidgets_")]:
        del scripts[key]


def kinds_on(doctree):
    """Return the kinds of moving figures on a page, in order."""
    from bs4 import BeautifulSoup

    kinds = {}
    for node in doctree.findall(nodes.raw):
        if "data-figure=" in node.astext():
            figures = BeautifulSoup(node.astext(), "html.parser").select("[data-figure]")
            kinds |= dict.fromkeys(figure["data-figure"] for figure in figures)
    return list(kinds)


def scripts_and_styles(kinds):
    """Return the scripts and styles of a page with these kinds of figures, texts by name.

    Returns also the files that its figures fetch later.
    """
    bundle = named(REGISTERED["figures"])
    texts, later = {}, {}
    if own := [kind for kind in kinds if kind not in bundle.BUILT]:
        texts |= {"shared.js": bundle.shared_script(), "moving.css": bundle.style() + PAGE_STYLE}
        texts |= {f"{kind}.js": bundle.script(kind) for kind in own}
        later |= {name: text for kind in own for name, text in bundle.beside(kind).items()}
    for kind in set(kinds) & set(bundle.BUILT):
        script = built(kind)
        # The name contains a hash, so that an older page never loads a newer script.
        name = f"{kind}-{sha256(script.encode()).hexdigest()[:8]}.js"
        later[name] = script
        texts |= {
            f"{kind}.js": bundle.LOADER.replace("FILE", name),
            f"{kind}.css": bundle.built_style(kind),
        }
    return texts, later


def figures_as_written(app):
    """Return the folder with the moving figures' scripts and styles before they are minified.

    The minified ones are made from these each time, because minifying twice changes a script.
    """
    return Path(app.doctreedir) / "moving"


def add_scripts(app, pagename, templatename, context, doctree):
    kinds = kinds_on(doctree) if doctree is not None else []
    if not kinds:
        return
    texts, later = scripts_and_styles(kinds)
    folder = figures_as_written(app)
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in (texts | later).items():
        (folder / name).write_text(text, "utf8")
    address = context["pathto"]("_static/moving", 1)
    context["figure_scripts"] = [f"{address}/{name}" for name in texts if name.endswith(".js")]
    context["styles"] = [
        *context["styles"],
        *(f"moving/{name}" for name in texts if name.endswith(".css")),
    ]


def bring(app, exception):
    """Put the scripts and styles of figures into the site.

    The shared script adds the styles that only an interactive figure needs.
    """
    written = figures_as_written(app)
    if exception or app.builder.format != "html" or not written.is_dir():
        return
    target = Path(app.outdir) / "_static" / "moving"
    shutil.copytree(written, target, dirs_exist_ok=True)
    # A loader contains the name of the script that it fetches, so delete those of earlier builds.
    loaders = "".join(
        path.read_text("utf8")
        for kind in named(REGISTERED["figures"]).BUILT
        for path in written.glob(f"{kind}.js")
    )
    for folder in (written, target):
        for path in folder.glob("*-" + 8 * "[0-9a-f]" + ".js"):
            if path.name not in loaders:
                path.unlink()
    if (styles := target / "moving.css").is_file():
        shared = target / "shared.js"
        later = take_later(Path(app.outdir), styles)
        shared.write_text(later + shared.read_text("utf8"), "utf8")


@cache
def built(kind):
    """Bundle the script of a figure with all that it imports, including npm packages."""
    with TemporaryDirectory() as folder:
        script = named(REGISTERED["figures"]).with_all_modules(kind, Path(folder))
        return esbuild("--bundle", "--minify", "--format=iife", "--log-level=warning", script)


def setup(app):
    app.connect("config-inited", prefer_stills)
    app.connect("doctree-read", drop_widget_state)
    # Run this after page.py has set the styles.
    app.connect("html-page-context", add_scripts, priority=960)
    # Run this before page.py minifies the scripts.
    app.connect("build-finished", bring, priority=910)
