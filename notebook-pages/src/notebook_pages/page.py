"""The page around the text: templates, styles, and nothing that it does not use."""

import re
import subprocess
from pathlib import Path

from docutils import nodes

from .finish import pages_of
from .fonts import katex_rules, whole_face_rules
from .paths import NODE, NODE_MODULES, WEBSITE

PURGE = WEBSITE / "purge.mjs"
ESBUILD = NODE_MODULES / "esbuild" / "bin" / "esbuild"

# The style sheets of the theme and of the other extensions, in their order.
# They become one file in one cascade layer, so that every rule of book.css
# goes before theirs without a contest of selectors.
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
# Scripts that some extension would put on every page although no page uses them.
UNUSED_SCRIPTS = ("thebe", "toggle", "design-tabs", "DOCUMENTATION_OPTIONS", "sphinx_highlight")
#: The scripts of the page itself, in their order, which a page fetches as one file; and those that
#: not all pages have.
PAGE_SCRIPTS = (
    "documentation_options.js",
    "doctools.js",
    "progress.js",
    "clipboard.min.js",
    "copybutton.js",
    "scripts/sphinx-book-theme.js",
    "book.js",
    "previews.js",
    "questions.js",
    "lecture.js",
    "scripts/pydata-sphinx-theme.js",
)
SOMETIMES = ("progress", "questions", "lecture")
JOINED = re.compile(r"_static/(page(?:-\w+)*\.js)")
#: How the theme finds out which boxes scroll: by measuring all of them at once, which lays out the
#: whole page, and again for each in turn. book.js watches them instead.
MEASURES = re.compile(r"\.forEach\(e=>\{e\.tabIndex=e\.scrollWidth>e\.clientWidth\|\|[^{}]*\}\)")
VALUE = re.compile(r"--(?:bs|mystnb|pst|sbt)-[\w-]+")
UNUSED_FILES = (
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
    """Take out what sphinx-thebe, always on in Jupyter Book, appends to each page."""
    for node in list(doctree.findall(nodes.raw)):
        if "x-thebe-config" in node.astext() or node.astext().startswith("<script>kernelName"):
            node.parent.remove(node)


DEFINITIONS = re.compile(r"<defs>((?:<path [^>]*/>)+)</defs>")
OUTLINE = re.compile(r'<path ([^>]*?)\bid="([^"]*)" ?([^>]*)/>')
HIDDEN = (
    '<svg class="outlines" width="0" height="0" style="position:absolute" '
    'aria-hidden="true"><defs>{}</defs></svg>'
)


PLACED = re.compile(r'<use transform="translate\(([-.\d]+) ([-.\d]+)\)" href=')
USE = re.compile(r'<use ([^>]*)href="#([^"]*)"([^>]*)/>')
#: A name of a program within the text, and in the line that says how a function is called.
LITERAL = re.compile(r'<code class="([^"]*)"><span class="pre">([^<]*)</span></code>')
NAME = re.compile(
    r'(<(?:span|em) class="(?:sig|n|o|default)[^"]*">)<span class="pre">([^<]*)</span>'
)
STILL = re.compile(r"(<figure\b[^>]*\bdata-stop=[^>]*>)(.*?)(</figure>)", re.DOTALL)


def share_outlines(body):
    """Move the outlines of letters from the drawings of a page into one table at its end, each of
    them once.

    A blank between two words has no outline: it goes, with every place where it stands.
    """
    numbers = {}

    def share(drawing):
        names, blanks = {}, set()

        def take(definitions):
            for before, name, after in OUTLINE.findall(definitions[1]):
                if re.search(r'\bd="[^"]', before + after):
                    names[name] = f"o{numbers.setdefault((before + after).strip(), len(numbers))}"
                else:
                    blanks.add(name)
            return ""

        def place(use):
            before, name, after = use.groups()
            return (
                "" if name in blanks else f'<use {before}href="#{names.get(name, name)}"{after}/>'
            )

        text = DEFINITIONS.sub(take, drawing[0].replace(" />", "/>"))
        return USE.sub(place, PLACED.sub(r'<use x="\1" y="\2" href=', text))

    body = re.sub(r"<svg\b.*?</svg>", share, body, flags=re.DOTALL)
    table = "".join(f'<path id="o{number}" {outline}/>' for outline, number in numbers.items())
    return body + HIDDEN.format(table) if numbers else body


def lighten(body):
    """Say once what a page would repeat.

    Every figure brings the style sheet of all figures and the outlines of its letters, since in a
    notebook it stands alone. There it is a figure to a screen reader, too; here it lies in one that
    has a name, or its drawing has one. Names, brackets, blanks and operators of a program have the
    colour of the text around them, and need no element each; nor does a single word within an
    element. The stills of a page that moves its own figure (``data-stop``) are seen on paper and
    without scripts: where there are scripts, the browser need not read them.
    """
    seen = set()

    def first_only(style):
        known = style[0] in seen
        seen.add(style[0])
        return "" if known else style[0]

    body = re.sub(r"<style>\.orientation-figure[^<]*</style>", first_only, body)
    body = re.sub(r'<figure (?=class="orientation-figure)', '<figure role="none" ', body)
    body = STILL.sub(r"\1<noscript>\2</noscript>\3", body)
    body = NAME.sub(r"\1\2", LITERAL.sub(r'<code class="\1">\2</code>', body))
    return share_outlines(re.sub(r'<span class="(?:n|p|w|nn|o)">([^<]*)</span>', r"\1", body))


def trim_page(app, pagename, templatename, context, doctree):
    def is_used(script):
        name = getattr(script, "filename", None) or ""
        body = getattr(script, "attributes", {}).get("body") or ""
        return not any(word in name or word in body for word in UNUSED_SCRIPTS)

    context["script_files"][:] = filter(is_used, context["script_files"])
    names = [
        str(getattr(script, "filename", None)).removeprefix("_static/")
        for script in context["script_files"]
    ]
    context["script_files"][:] = [
        script for script, name in zip(context["script_files"], names) if name not in PAGE_SCRIPTS
    ]
    joined = "-".join(["page", *(name for name in SOMETIMES if f"{name}.js" in names)])
    app.add_js_file(f"{joined}.js", priority=100)
    for script in context["script_files"]:
        script.attributes.setdefault(
            "defer", "defer"
        )  # no script is awaited before the text is shown
    context["styles"] = [STYLE]
    if "body" in context:
        context["body"] = lighten(context["body"])


def theme_styles(static):
    return [path for name in THEME_STYLES for path in sorted(static.glob(name))]


def make_small(static, files, told):
    """Write files again without blanks and long names, all in one go; ``told`` is the least fault
    that is told of.
    """
    options = [
        "--minify",
        f"--log-level={told}",
        "--allow-overwrite",
        f"--outdir={static}",
        f"--outbase={static}",
    ]
    if files:
        subprocess.run([NODE, ESBUILD, *options, *files], check=True)


def number_values(site, rules):
    """The rules with numbers for the long names of the theme's values, unless something else asks
    for them.
    """
    others = [*pages_of(site), *site.glob("_static/moving/*"), WEBSITE / "print.css"]
    known = {name for path in others for name in VALUE.findall(path.read_text("utf8"))}
    numbers = {
        name: f"--{number}" for number, name in enumerate(sorted({*VALUE.findall(rules)} - known))
    }
    return VALUE.sub(lambda match: numbers.get(match[0], match[0]), rules)


def purged(site, rules, *others):
    """The rules that some page uses, or one of the scripts or style sheets ``others``."""
    sheet = site / "_static" / "purged.css"
    sheet.write_text(rules, "utf8")
    subprocess.run([NODE, PURGE, NODE_MODULES, site, sheet, *others], check=True)
    kept = sheet.read_text("utf8")
    sheet.unlink()
    return kept


def bundle_styles(site):
    """Write the styles of all pages as one file: no icon font, no rule that no page uses, no blank.

    The theme's are one layer. KaTeX's are for the words of light_formulas.py; what is set while one
    reads, of what a cell puts out, has KaTeX's own rules with the styles of the editor.
    """
    static = site / "_static"
    parts = theme_styles(static)
    if (static / "basic.css").exists():  # else Sphinx had nothing to build and copied nothing
        theme = "\n".join(path.read_text("utf8") for path in parts)
        theme = re.sub(
            r'@charset "[^"]*";|/\*.*?\*/|@font-face\{[^}]*\}', "", theme, flags=re.DOTALL
        )
        own = [static / "book.css", WEBSITE / "live" / "js" / "page.css"]
        scripts = [path for name in PAGE_SCRIPTS if (path := static / name).exists()]
        others = [*own, *scripts, *static.glob("moving/*"), *(WEBSITE / "live" / "js").glob("*.js")]
        rules = [
            purged(site, "@layer theme {\n" + theme + "\n}\n", *others),
            purged(site, katex_rules("fonts").replace("span", "i")),
            whole_face_rules("fonts"),
            *(path.read_text("utf8") for path in own),
        ]
        (static / STYLE).write_text(number_values(site, "\n".join(rules)), "utf8")
        parts.append(static / "book.css")
    for path in parts:
        path.unlink()
    make_small(static, [*static.glob("*.css"), *static.glob("moving/*")], "warning")


def join_scripts(site):
    """Write the scripts of the page itself as one file, for each choice of them that some page
    makes.
    """
    static = site / "_static"
    if not (static / "doctools.js").exists():  # Sphinx had nothing to build and copied nothing
        return
    theme = static / PAGE_SCRIPTS[-1]
    text, count = MEASURES.subn(".forEach(watchWidth)", theme.read_text("utf8"))
    if count != 1:
        raise RuntimeError(
            "The theme's script no longer finds the boxes that scroll in the way that page.py "
            "replaces"
        )
    theme.write_text(text, "utf8")
    files = {name for page in pages_of(site) for name in JOINED.findall(page.read_text("utf8"))}
    for file in files:
        left_out = {f"{name}.js" for name in SOMETIMES} - {
            f"{name}.js" for name in file[:-3].split("-")
        }
        parts = [(static / name).read_text("utf8") for name in PAGE_SCRIPTS if name not in left_out]
        (static / file).write_text("\n;".join(parts), "utf8")
    make_small(static, [static / file for file in files], "error")
    for name in PAGE_SCRIPTS:
        (static / name).unlink()


def finish(app, exception):
    if exception or app.builder.format != "html":
        return
    static = Path(app.outdir) / "_static"
    # First what no page uses goes: the words of a script may be names of styles.
    kept = theme_styles(static)
    for pattern in UNUSED_FILES:
        for path in static.glob(pattern):
            if path.is_file() and path not in kept:
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
    app.connect("build-finished", finish, priority=950)
    app.add_js_file("book.js", loading_method="defer")
