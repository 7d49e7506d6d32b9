"""Let readers keep the book in their browser or install it as an app, after stating its size.

``manifest.webmanifest`` and two icons make the site installable. ``offline.json`` lists the files
to keep (the pages, and Python), each with a hash and its size. The rest is done by live/js/keep.js,
editions.js and service-worker.js.
"""

import json
import re
from hashlib import sha256
from pathlib import Path

from .live.runtime import FOLDER, LOCK

LIST = "offline.json"
WORKER = "service-worker.js"
MANIFEST = "manifest.webmanifest"
SIZES = (192, 512)
KEPT = {".html", ".js", ".css", ".woff2", ".svg", ".png", ".webmanifest", ".ipynb", ".py"}


def write_manifest(site, title):
    icons = [
        {"src": "_static/favicon.svg", "sizes": "any", "type": "image/svg+xml"},
        *(
            {"src": f"_static/icon-{size}.png", "sizes": f"{size}x{size}", "type": "image/png"}
            for size in SIZES
        ),
    ]
    manifest = {
        "name": title, "short_name": title.split()[0], "start_url": "./index.html", "scope": "./",
        "id": "./", "display": "minimal-ui", "background_color": "#fdfcfa",
        "theme_color": "#fdfcfa", "icons": icons,
    }  # fmt: skip
    (site / MANIFEST).write_text(json.dumps(manifest, indent=1), "utf8")


def write_list(site):
    """Write the list of files that a reader may keep, in two parts: ``book`` and ``python``."""
    packages = json.loads((site / FOLDER / LOCK).read_text("utf8"))["packages"].values()
    wheels = [
        site / FOLDER / package["file_name"]
        for package in packages
        if "://" not in package["file_name"]
    ]
    sealed = (site / FOLDER).glob("sealed-*/*/*.json")
    python = [
        *(site / FOLDER).glob(f"lock-*/{LOCK}"),
        *(site / FOLDER).glob("pyodide-*/*"),
        *wheels,
        *sealed,
    ]
    pages = [
        path
        for path in site.rglob("*")
        if path.suffix in KEPT
        and path.relative_to(site).parts[0] != "lite"
        and path not in python
        and path.name not in (WORKER, "404.html")
    ]

    def listed(paths):
        contents = {str(path.relative_to(site)): path.read_bytes() for path in sorted(paths)}
        return {
            name: [sha256(content).hexdigest()[:16], len(content)]
            for name, content in contents.items()
        }

    parts = {"book": listed(pages), "python": listed(python)}
    edition = "book-" + sha256(json.dumps(parts).encode()).hexdigest()[:12]
    (site / LIST).write_text(json.dumps({"edition": edition, **parts}), "utf8")
    # The service worker of a book at the root of an address also receives requests for other pages
    # there, so list what belongs to the book. The build writes the script again each time.
    ours = sorted({path.name for path in site.iterdir()} - {"lite", WORKER})
    script = re.sub(r"^self\.bookHolds=[^;\n]*;\n", "", (site / WORKER).read_text("utf8"))
    (site / WORKER).write_text(f"self.bookHolds={json.dumps(ours)};\n{script}", "utf8")


def add_to_head(app, pagename, templatename, context, doctree):
    context["manifest"] = context["pathto"](MANIFEST, 1)
    context["touch_icon"] = context["pathto"](f"_static/icon-{SIZES[0]}.png", 1)
    if address := app.config.html_baseurl:
        context["shared_icon"] = f"{address}_static/icon-{SIZES[-1]}.png"


def finish(app, exception):
    if (
        not exception
        and app.builder.format == "html"
        and (Path(app.outdir) / "_static" / "favicon.svg").exists()
    ):
        write_manifest(Path(app.outdir), app.config.html_title)


def setup(app):
    app.connect("html-page-context", add_to_head)
    # Run after page.py, which removes unused files.
    app.connect("build-finished", finish, priority=960)
