"""The page around the text: templates, styles and scripts, without any that it does not use."""

import json
import re
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor
from hashlib import sha256
from pathlib import Path

from docutils import nodes

from .finish import pages_of
from .fonts import katex_rules, whole_face_rules
from .lighten import lighten, move_stills_out
from .paths import NODE, NODE_MODULES, WEBSITE, esbuild

PURGE = WEBSITE / "purge.mjs"

# The style sheets of the theme and of the other extensions, in order. They become one file in one
# cascade layer, so that every rule of book.css takes precedence whatever its selector.
THEME_STYLES = (
    "basic.css",
    "styles/pydata-sphinx-theme.css",
    "styles/sphinx-book-theme.css",
    "pygments.css",
    "copybutton.css",
    "mystnb.*.css",
    "exercise.css",
)
STYLE = "style.css"
# Scripts that some extension would add to every page although no page uses them. Sphinx's doctools
# reacted to the key "/" while a reader was typing in a cell.
UNUSED_SCRIPTS = (
    "thebe", "toggle", "design-tabs", "DOCUMENTATION_OPTIONS", "sphinx_highlight", "doctools",
)  # fmt: skip
# The scripts of every page, in order, which a page fetches as one file, and those that only some
# pages have.
PAGE_SCRIPTS = (
    "documentation_options.js",
    "progress.js",
    "clipboard.min.js",
    "copybutton.js",
    "scripts/sphinx-book-theme.js",
    "book.js",
    "previews.js",
    "questions.js",
    "scripts/pydata-sphinx-theme.js",
)
SOMETIMES = ("progress", "questions")
JOINED = re.compile(r"_static/(page(?:-\w+)*\.js)")
# The theme measures all boxes at once to find those that scroll, which lays out the whole page, and
# then each one in turn again. book.js observes them instead.
MEASURES = re.compile(r"\.forEach\(e=>\{e\.tabIndex=e\.scrollWidth>e\.clientWidth\|\|[^{}]*\}\)")
VALUE = re.compile(r"--(?:bs|mystnb|pst|sbt)-[\w-]+")
UNUSED_FILES = (
    "doctools.js",
    "searchtools.js",
    "language_data.js",
    "sphinx_highlight.js",
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
    "play-solid.svg",
    "copy-button.svg",
    "minus.png",
    "plus.png",
    "copybutton_funcs.js",
    "webpack-macros.html",
    "sbt-webpack-macros.html",
    "styles/*.css",
    "check-solid.svg",
)


def add_own_files(app, config):
    config.html_math_renderer = "katex"
    config.templates_path.insert(0, str(WEBSITE / "templates"))
    config.html_static_path.append(str(WEBSITE / "static"))
    config.html_copy_source = False
    config.html_context["default_mode"] = "auto"


def drop_thebe(app, doctree, docname):
    """Remove what sphinx-thebe, always active in Jupyter Book, appends to each page."""
    for node in list(doctree.findall(nodes.raw)):
        if "x-thebe-config" in node.astext() or node.astext().startswith("<script>kernelName"):
            node.parent.remove(node)


def trim_page(app, pagename, templatename, context, doctree):
    scripts = context["script_files"]
    names = [str(getattr(script, "filename", None)).removeprefix("_static/") for script in scripts]

    def is_used(script, name):
        body = getattr(script, "attributes", {}).get("body") or ""
        unused = any(word in name or word in body for word in UNUSED_SCRIPTS)
        return not unused and name not in PAGE_SCRIPTS

    scripts[:] = [script for script, name in zip(scripts, names) if is_used(script, name)]
    joined = "-".join(["page", *(name for name in SOMETIMES if f"{name}.js" in names)])
    app.add_js_file(f"{joined}.js", priority=100)
    for script in context["script_files"]:
        # Show the text without waiting for a script.
        script.attributes.setdefault("defer", "defer")
    # The table of progress is on one page only.
    context["styles"] = [STYLE, "my-progress.css"] if "my-progress.js" in names else [STYLE]
    if "body" in context:
        context["body"] = lighten(
            move_stills_out(context["body"], Path(app.outdir), context["pathto"])
        )


def theme_styles(static):
    return [path for name in THEME_STYLES for path in sorted(static.glob(name))]


def make_small(static, files, log_level):
    """Minify files in place, in one process, and report messages from ``log_level`` up."""
    if files:
        esbuild(
            "--minify",
            f"--log-level={log_level}",
            "--allow-overwrite",
            f"--outdir={static}",
            f"--outbase={static}",
            *files,
        )


def number_values(site, rules):
    """Number the theme's variables, whose names are long, unless something else uses them."""
    others = [*pages_of(site), *site.glob("_static/moving/*"), WEBSITE / "print.css"]
    known = {name for path in others for name in VALUE.findall(path.read_text("utf8"))}
    numbers = {
        name: f"--{number}" for number, name in enumerate(sorted({*VALUE.findall(rules)} - known))
    }
    return VALUE.sub(lambda match: numbers.get(match[0], match[0]), rules)


def names_of(site):
    """Return the file in which purge.mjs stores the names that the pages of a site contain."""
    return site.with_name("names-in-pages.json")


def find_names(app, exception):
    if not exception and app.builder.format == "html":
        site = Path(app.outdir)
        subprocess.run([NODE, PURGE, NODE_MODULES, names_of(site), "--of", site], check=True)


def sorted_out(site, name, rules, *others):
    """Return what purge.mjs keeps of a style sheet.

    If the first of ``others`` is ``--later``, return also what it moves into another one. The
    result is cached under ``name``, because the pages nearly always contain the same names as in
    the last build.
    """
    inputs = [
        PURGE,
        NODE_MODULES / ".package-lock.json",
        names_of(site),
        *(path for path in others if isinstance(path, Path)),
    ]
    inputs_as_text = "\0".join(
        [rules, *map(str, others), *(path.read_text("utf8") for path in inputs)]
    )
    key, cache_file = (
        sha256(inputs_as_text.encode()).hexdigest(),
        site.with_name(f"purged-{name}.json"),
    )
    if cache_file.exists() and (before := json.loads(cache_file.read_text("utf8")))["key"] == key:
        return before["parts"]
    with tempfile.TemporaryDirectory() as folder:
        sheet, later = Path(folder, "sheet.css"), Path(folder, "later.css")
        sheet.write_text(rules, "utf8")
        others = ["--later", later] if others[:1] == ("--later",) else others
        subprocess.run([NODE, PURGE, NODE_MODULES, names_of(site), sheet, *others], check=True)
        parts = [path.read_text("utf8") for path in (sheet, later) if path.exists()]
    cache_file.write_text(json.dumps({"key": key, "parts": parts}), "utf8")
    return parts


def as_script(styles):
    """Return a style sheet as the beginning of a script that adds it, and delete its file."""
    make_small(styles.parent, [styles], "warning")
    rules = json.dumps(styles.read_text("utf8").strip())
    styles.unlink()
    return (
        "document.head.append("
        f"Object.assign(document.createElement('style'), {{textContent: {rules}}}));\n"
    )


def take_later(site, styles):
    """Keep in a style sheet only what pages need for the first view, which waits for it.

    Return the rest, which is used only after scripts have run, as the beginning of a script.
    """
    later = styles.with_suffix(".later.css")
    parts = sorted_out(site, styles.stem, styles.read_text("utf8"), "--later")
    for path, rules in zip((styles, later), parts, strict=True):
        path.write_text(rules, "utf8")
    make_small(styles.parent, [styles], "warning")
    return as_script(later)


def in_ems(text):
    """Return styles or scripts of the theme with the widths of windows in ems instead of pixels.

    A reader who uses larger letters has room for fewer columns.
    """
    return re.sub(
        r"(?<=-width:) ?([\d.]+)px(?=\))", lambda width: f"{float(width[1]) / 16}em", text
    )


def bundle_styles(site):
    """Write the styles of all pages as one minified file, without icon fonts and unused rules.

    The theme's are one layer. KaTeX's are for the output of light_formulas.py. Formulas that are
    set in the browser, in the results of cells, have KaTeX's own rules with the styles of the
    editor.
    """
    static = site / "_static"
    parts = theme_styles(static)
    # If this file is missing, Sphinx had nothing to build and copied nothing.
    if (static / "basic.css").exists():
        theme = "\n".join(path.read_text("utf8") for path in parts)
        theme = re.sub(
            r'@charset "[^"]*";|/\*.*?\*/|@font-face\{[^}]*\}', "", theme, flags=re.DOTALL
        )
        theme = in_ems(theme)
        own = [static / "book.css", WEBSITE / "live" / "js" / "page.css"]
        scripts = [path for name in PAGE_SCRIPTS if (path := static / name).exists()]
        others = [*own, *scripts, *static.glob("moving/*"), *(WEBSITE / "live" / "js").glob("*.js")]
        sheets = (
            ("theme", "@layer theme {\n" + theme + "\n}\n", *others),
            (
                "katex",
                katex_rules("fonts").replace("span", "i"),
            ),
        )
        # Threads suffice, because each waits for its own process.
        with ThreadPoolExecutor() as pool:
            purged_sheets = pool.map(lambda sheet: sorted_out(site, *sheet)[0], sheets)
        rules = [
            *purged_sheets,
            whole_face_rules("fonts"),
            *(path.read_text("utf8") for path in own),
        ]
        (static / STYLE).write_text(number_values(site, "\n".join(rules)), "utf8")
        parts.append(static / "book.css")
    for path in parts:
        path.unlink()
    make_small(static, [*static.glob("*.css"), *static.glob("moving/*")], "warning")


def join_scripts(site):
    """Write the scripts of every page as one file, for each choice of them that some page makes.

    Each script begins with the styles that only it needs.
    """
    static = site / "_static"
    # If this file is missing, Sphinx had nothing to build and copied nothing.
    if not (static / PAGE_SCRIPTS[0]).exists():
        return
    theme = static / PAGE_SCRIPTS[-1]
    text, count = MEASURES.subn(".forEach(watchWidth)", theme.read_text("utf8"))
    if count != 1:
        raise RuntimeError(
            "The theme's script no longer finds the scrolling boxes with the code "
            "that page.py replaces"
        )
    # The theme lays out the page at once. In a task of its own it does not hold up a reader who
    # touches the page meanwhile.
    theme.write_text(f"setTimeout(() => {{\n{text}\n}})", "utf8")
    begin = take_later(site, static / STYLE)
    files = {name for page in pages_of(site) for name in JOINED.findall(page.read_text("utf8"))}
    for file in files:
        left_out = {f"{name}.js" for name in SOMETIMES} - {
            f"{name}.js" for name in file[:-3].split("-")
        }
        parts = [(static / name).read_text("utf8") for name in PAGE_SCRIPTS if name not in left_out]
        (static / file).write_text(in_ems(begin + "\n;".join(parts)), "utf8")
    lecture = static / "lecture.js"
    lecture.write_text(as_script(static / "lecture.css") + lecture.read_text("utf8"), "utf8")
    make_small(static, [lecture, *(static / file for file in files)], "error")
    for name in PAGE_SCRIPTS:
        (static / name).unlink()


def finish(app, exception):
    if exception or app.builder.format != "html":
        return
    static = Path(app.outdir) / "_static"
    # Remove unused styles first: the words of a script may look like names of styles.
    styles_in_use = theme_styles(static)
    for pattern in UNUSED_FILES:
        for path in static.glob(pattern):
            if path.is_file() and path not in styles_in_use:
                path.unlink()
    bundle_styles(Path(app.outdir))
    join_scripts(Path(app.outdir))
    for folder in sorted(static.rglob("*"), reverse=True):
        if folder.is_dir() and not any(folder.iterdir()):
            folder.rmdir()


def setup(app):
    app.connect("config-inited", add_own_files)
    app.connect("doctree-resolved", drop_thebe, priority=950)
    app.connect("html-page-context", trim_page, priority=950)
    # Run before moving.py asks for the names.
    app.connect("build-finished", find_names, priority=905)
    app.connect("build-finished", finish, priority=950)
    app.add_js_file("book.js", loading_method="defer")
