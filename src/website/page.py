"""The page around the text: templates, styles, and nothing that it does not use."""

from pathlib import Path

from .paths import WEBSITE

# What the theme and the other extensions would put on every page although no
# page uses it. Icons come from book.css; hidden cells are <details> elements.
UNUSED_ON_PAGES = ("thebe", "togglebutton", "design-tabs", "sphinx_highlight", "sphinx-design")
UNUSED_FILES = (
    "**/*.map",
    "**/fontawesome*",
    "**/bootstrap*",
    "vendor/**/*",
    "locales/**/*",
    "images/**/*",
    "sphinx-thebe*",
    "togglebutton*",
    "design-tabs*",
    "sphinx-design*",
    "check-solid.svg",
    "webpack-macros.html",
    "sbt-webpack-macros.html",
)


def add_own_files(app, config):
    config.html_math_renderer = "katex"
    config.templates_path.insert(0, str(WEBSITE / "templates"))
    config.html_static_path.append(str(WEBSITE / "static"))
    config.html_copy_source = False


def is_used(asset):
    name = getattr(asset, "filename", None) or ""
    body = getattr(asset, "attributes", {}).get("body") or ""
    return not any(word in name or word in body for word in UNUSED_ON_PAGES)


def trim_page(app, pagename, templatename, context, doctree):
    for kind in ("script_files", "css_files"):
        context[kind][:] = [asset for asset in context[kind] if is_used(asset)]


def trim_files(app, exception):
    if exception or app.builder.format != "html":
        return
    static = Path(app.outdir) / "_static"
    for pattern in UNUSED_FILES:
        for path in static.glob(pattern):
            if path.is_file():
                path.unlink()
    for folder in sorted(static.rglob("*"), reverse=True):
        if folder.is_dir() and not any(folder.iterdir()):
            folder.rmdir()


def setup(app):
    app.connect("config-inited", add_own_files)
    app.connect("html-page-context", trim_page, priority=950)
    app.connect("build-finished", trim_files, priority=950)
    app.add_css_file("book.css", priority=900)
    app.add_js_file("book.js", loading_method="defer")
