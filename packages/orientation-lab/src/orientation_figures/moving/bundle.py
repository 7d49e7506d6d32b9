"""Combine the modules of a figure: one for Jupyter, classic scripts for pages without a kernel.

Pages opened from a disk cannot import modules, and anywidget needs one module for each figure. Both
are made from the same files.
"""

import re
import shutil
from functools import cache
from pathlib import Path

from ..style import STYLE
from .javascript import translated

FOLDER = Path(__file__).parent
SHARED = (
    "formulas", "mathematics", "words_picture", "common_picture", "glyphs", "model", "address",
    "shared",
)  # fmt: skip
# The files of the pictures, by the names of their modules in JavaScript. ``words`` has the methods
# of a sheet.
DESCRIBED = {
    f"{path.stem}_picture": path
    for path in (FOLDER.parent / "words.py", *sorted((FOLDER / "pictures").glob("[!_]*.py")))
}
# Modules that only one figure needs, to be loaded before its own.
OWN = {"workbench": ("mismatch",), "converter": ("take_away",), "formula": ("take_away",)}
OWN |= {
    path.stem: (*OWN.get(path.stem, ()), picture)
    for picture, path in DESCRIBED.items()
    if picture not in SHARED
}
# Figures that use npm packages. This script is the source of what their page loads when they come
# into view, and each has its own style sheet.
BUILT = {"rotations": "world.js"}
# This loads that script when the reader begins: with a movement of the pointer, a touch, a key or
# scrolling, while the figure is in sight. Until then its still is shown, which takes no time to
# draw. A figure begins at once if it plays by itself, if it is under the pointer, or if the page
# opens at an address or further down. A finger or pointer that is already on the figure takes hold
# of it (world.js). The browser fetches the stills where they are shown: on paper, without scripts,
# and where figure and text do not fit beside each other (as in essay.css). Before printing, the
# page asks for all of them.
LOADER = """(() => {
const source = new URL('FILE', document.currentScript.src).href;
const ACTS = 'pointermove pointerdown touchstart scroll keydown focusin hashchange'.split(' ');
addEventListener('beforeprint', () => {
  for (const still of document.querySelectorAll('[data-stop] > img')) still.loading = 'eager';
});
const load = () => {
  for (const act of ACTS) removeEventListener(act, load, true);
  document.head.append(Object.assign(document.createElement('script'), { src: source }));
};
const begin = () => {
  const seen = new IntersectionObserver((entries) => {
    const figure = entries.find((entry) => entry.isIntersecting)?.target;
    if (!figure) return;
    seen.disconnect();
    const begun = location.hash || scrollY || figure.matches(':hover');
    if (begun || 'play' in figure.dataset) return load();
    const early = { rel: 'prefetch', href: source };
    document.head.append(Object.assign(document.createElement('link'), early));
    for (const act of ACTS) addEventListener(act, load, { capture: true, passive: true });
  });
  for (const figure of document.querySelectorAll('.world')) {
    seen.observe(figure);
    for (const [act, held] of [['pointerdown', true], ['pointerup'], ['pointercancel']]) {
      figure.addEventListener(act, (event) => { figure.pressed = held && event; });
    }
  }
};
if (document.readyState === 'loading') addEventListener('DOMContentLoaded', begin); else begin();
})();
"""
IMPORT = re.compile(r"^(?:import|export) \{([^}]*)\} from .*;\n", re.MULTILINE)
IMPORT_FROM = re.compile(r"^import \{([^}]*)\} from '\./(\w+)\.js';\n", re.MULTILINE)
EXPORT = re.compile(r"^export (?=(?:async function|function\*?|class|const) (\w+))", re.MULTILINE)
COMMENT = re.compile(r"^\s*//.*\n|^ +| {2,}// .*$", re.MULTILINE)


@cache
def source(name):
    """Return the text of a module without comments and indentation, which only add size."""
    if name in DESCRIBED:
        text = translated(DESCRIBED[name])
    else:
        text = (FOLDER / "js" / f"{name}.js").read_text("utf8")
    return COMMENT.sub("", text)


def body(name):
    """Return a module's text without imports and exports, for a scope where the names are known."""
    return EXPORT.sub("", IMPORT.sub("", source(name)))


def whole(name):
    """Return the body of a figure's module, after those of the modules that only it needs."""
    return "".join(map(body, (*OWN.get(name, ()), name)))


def esm(name):
    """Return the figure ``name`` as one module without imports, as anywidget requires."""
    # The figure has its own scope, so that it may reuse a name of the shared modules.
    figure = f"const render = (() => {{\n{whole(name)}return render;\n}})();\n"
    return "".join(map(body, SHARED)) + figure + "export default { render };\n"


def shared_script():
    """Return the classic script that every page with figures loads first."""
    names = [name for module in SHARED for name in EXPORT.findall(source(module))]
    return (
        f"const orientation = (() => {{\n{''.join(map(body, SHARED))}return {{ {', '.join(names)} "
        f"}};\n}})();\n"
    )


def script(name):
    """Return the classic script that activates the figures of one kind."""
    own = OWN.get(name, ())
    texts = [IMPORT_FROM.findall(source(module)) for module in (*own, name)]
    imported = {
        name.strip(): 0
        for text in texts
        for names, module in text
        if module not in own
        for name in names.split(",")
    }
    names = ", ".join(filter(None, imported))
    return (
        f"(() => {{\nconst {{ {names} }} = orientation;\n"
        f"{whole(name)}orientation.start('{name}', render);\n}})();\n"
    )


def beside(name):
    """Return the files that a figure of this kind loads on demand, by name."""
    if "take_away" not in OWN.get(name, ()):
        return {}
    # This needs NumPy, unlike the figures in a page.
    from .take_away import scripts

    return {"drawing.css": STYLE} | scripts()


def style():
    """Return the style sheet of the controls; that of the drawings comes with each still."""
    return (FOLDER / "moving.css").read_text("utf8")


def with_all_modules(kind, folder):
    """Write the modules for a figure of ``BUILT`` into a folder; return the file to bundle."""
    for package in ("moving", kind):
        shutil.copytree(FOLDER.parent / package / "js", folder / package / "js")
    for name in DESCRIBED:
        (folder / "moving" / "js" / f"{name}.js").write_text(source(name), "utf8")
    return folder / kind / "js" / BUILT[kind]


def built_style(kind):
    """Return the style sheet of a figure of ``BUILT``."""
    return (FOLDER.parent / kind / "essay.css").read_text("utf8")
