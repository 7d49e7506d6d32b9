"""The scripts of the page, bundled by esbuild: a small one for every page, and what it loads."""

import shutil
import tempfile
from pathlib import Path

from ..fonts import FOLDER as FONTS_FOLDER
from ..fonts import __file__ as FONTS_PROGRAM
from ..fonts import katex_rules
from ..paths import REGISTERED, WEBSITE, esbuild, fingerprint, named
from .cells import PRETTY, PYTHON, write_python
from .runtime import FOLDER, HERE

JS = HERE / "js"
# The script that a moving figure and its widget share. The figures of the build and of the page's
# Python use the same one.
MODEL = named(REGISTERED["figures"]).FOLDER / "js" / "model.js" if "figures" in REGISTERED else None


def folder_name():
    """Return the folder of the scripts, which distinguishes versions: the file names do not."""
    ours = [JS, MODEL, PYTHON, Path(FONTS_PROGRAM), Path(__file__)]
    sources = filter(None, [*ours, PRETTY, WEBSITE / "package-lock.json"])
    return f"{FOLDER}/scripts-{fingerprint(*sources)}"


def put_together(*arguments):
    esbuild("--minify", "--log-level=warning", "--legal-comments=none", *arguments)


def write(site):
    """Write the scripts into the folder ``site``."""
    target = site / folder_name()
    for outdated in (site / FOLDER).glob("scripts-*"):
        if outdated != target:
            shutil.rmtree(outdated)
    # live.css is written last, so it shows that this folder is complete. The name of the folder is
    # a hash of the sources.
    if not (target / "live.css").exists():
        write_loaded(target)
    static = site / "_static"
    static.mkdir(exist_ok=True)
    put_together(JS / "page.js", f"--outfile={static / 'live.js'}")
    put_together(
        JS / "progress.js",
        "--bundle",
        "--global-name=progress",
        f"--outfile={static / 'progress.js'}",
    )
    # A service worker may control only the pages below it.
    put_together(JS / "service-worker.js", "--bundle", f"--outfile={site / 'service-worker.js'}")


def write_loaded(target):
    """Write the files that a page loads when its reader starts Python."""
    target.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        workshop = Path(folder)
        shutil.copytree(JS, workshop / "js")
        if MODEL:
            shutil.copy(MODEL, workshop / "js")
        else:
            (workshop / "js" / "model.js").write_text("export class Model {}\n", "utf8")
        write_python(workshop / "python")
        put_together(
            *(
                workshop / "js" / name
                for name in ("live.js", "worker.js", "take-away.js", "notebook.js", "keep.js")
            ),
            "--bundle",
            "--format=esm",
            "--loader:.py=text",
            f"--outdir={target}",
        )
    # KaTeX typesets the output of Python in the page. Its rules form a layer below those of the
    # page.
    rules = f"@layer katex {{{katex_rules(f'../../{FONTS_FOLDER.as_posix()}')}}}\n"
    (target / "live.css").write_text((JS / "live.css").read_text("utf8") + rules, "utf8")
