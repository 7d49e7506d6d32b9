"""Figures that move: their scripts on the pages that hold them, and nothing of widgets' own.

A cell that ends in a moving figure of the book puts out a still, with the state of the figure, and
a widget for Jupyter. The page shows the still, and one script for each kind of figure, which
book.js asks for when the first view stands, brings it to life.
"""

import shutil
from functools import cache
from hashlib import sha256
from pathlib import Path

from docutils import nodes

from .page import take_later
from .paths import NODE_MODULES, REGISTERED, esbuild, fingerprint, named
from .used import files_used

WIDGET = "application/vnd.jupyter.widget-view+json"
EMBEDDED = "embed"  # the folder of the site that holds a page for each figure alone
# On a narrow screen the drawing of a figure stays in view, under the bar at the top of the page.
PAGE_STYLE = """
.cell_output .output:has(> .moving) { overflow: visible; }
.moving .stage { top: 3.5rem; }
"""


def prefer_stills(app, config):
    """A widget needs a kernel: pages show the other forms of such an output."""
    config.nb_mime_priority_overrides = [*config.nb_mime_priority_overrides, ("*", WIDGET, None)]


def drop_widget_state(app, doctree):
    """Take out the widgets' state and the scripts that MyST-NB would load for it from elsewhere."""
    scripts = app.env.nb_metadata.get(app.env.docname, {}).get("js_files", {})
    for key in [key for key in scripts if key.startswith("ipywidgets_")]:
        del scripts[key]


def kinds_on(doctree):
    """The kinds of moving figures on a page, in their order."""
    from bs4 import BeautifulSoup

    found = {}
    for node in doctree.findall(nodes.raw):
        if "data-figure=" in node.astext():
            figures = BeautifulSoup(node.astext(), "html.parser").select("[data-figure]")
            found |= dict.fromkeys(figure["data-figure"] for figure in figures)
    return list(found)


def scripts_and_styles(kinds):
    """What a page with these kinds of figures loads, texts by their names;
    and what its figures fetch later.
    """
    bundle = named(REGISTERED["figures"])
    texts, later = {}, {}
    if own := [kind for kind in kinds if kind not in bundle.BUILT]:
        texts |= {"shared.js": bundle.shared_script(), "moving.css": bundle.style() + PAGE_STYLE}
        texts |= {f"{kind}.js": bundle.script(kind) for kind in own}
        later |= {name: text for kind in own for name, text in bundle.beside(kind).items()}
    for kind in set(kinds) & set(bundle.BUILT):
        script = built(bundle.BUILT[kind])
        # An older page never loads a newer script.
        name = f"{kind}-{sha256(script.encode()).hexdigest()[:8]}.js"
        later[name] = script
        texts |= {
            f"{kind}.js": bundle.LOADER.replace("FILE", name),
            f"{kind}.css": bundle.built_style(kind),
        }
    return texts, later


def figures_as_written(app):
    """Where the scripts and styles of moving figures lie as they were
    written, by this build or before.

    Small ones are made of these each time: made small twice, a script is another one.
    """
    return Path(app.doctreedir) / "moving"


def write(folder, texts):
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in texts.items():
        (folder / name).write_text(text, "utf8")


def add_scripts(app, pagename, templatename, context, doctree):
    kinds = kinds_on(doctree) if doctree is not None else []
    if not kinds:
        return
    texts, later = scripts_and_styles(kinds)
    write(figures_as_written(app), texts | later)
    address = context["pathto"]("_static/moving", 1)
    context["figure_scripts"] = [f"{address}/{name}" for name in texts if name.endswith(".js")]
    context["styles"] = [
        *context["styles"],
        *(f"moving/{name}" for name in texts if name.endswith(".css")),
    ]


def write_embedded(app, exception):
    """A page for each figure alone, which others put into theirs; anew only if
    what they are made from has changed.
    """
    if exception or app.builder.format != "html" or "embedding" not in REGISTERED:
        return
    site = Path(app.outdir)
    sources = [
        *files_used(f"import {REGISTERED['embedding']}"),
        NODE_MODULES / ".package-lock.json",
        Path(__file__),
    ]
    made_from, stamp = fingerprint(*sources), site.with_name("embedded-from")
    if stamp.is_file() and stamp.read_text() == made_from and (site / EMBEDDED).is_dir():
        return
    embedding = named(REGISTERED["embedding"])
    texts, later = scripts_and_styles([*embedding.figures(), *named(REGISTERED["figures"]).BUILT])
    write(figures_as_written(app), texts | later)
    write(site / EMBEDDED, embedding.files())
    stamp.write_text(made_from)


def bring(app, exception):
    """Put scripts and styles of figures into the site; the shared script brings those styles that
    only a living figure needs.
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
def built(script):
    """The text of a script with all that it imports, those of npm's packages among it."""
    return esbuild("--bundle", "--minify", "--format=iife", "--log-level=warning", script)


def setup(app):
    app.connect("config-inited", prefer_stills)
    app.connect("doctree-read", drop_widget_state)
    app.connect("html-page-context", add_scripts, priority=960)  # after page.py has set the styles
    # before page.py makes the scripts small
    app.connect("build-finished", write_embedded, priority=900)
    app.connect("build-finished", bring, priority=910)
