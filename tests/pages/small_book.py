"""A small book in many editions, and a server whose network breaks on request.

They are for tests of what a browser keeps.
"""

import json
import os
import shutil
import threading
from contextlib import contextmanager
from hashlib import sha256
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer

from notebook_pages import install
from notebook_pages.live import scripts

PAGES = ("index", "chapters/one", "chapters/two", "appendix/three")
PAGE = """<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>{name}</title>
<link rel="stylesheet" href="{up}_static/book.css?v={css}">
<script src="{up}_static/book.js?v={js}" defer></script></head>
<body><article><section id="{name}"><h1>{name}</h1><p id="edition">{edition}</p></section>
<section id="same"><h2>What stays</h2><p>The same in all editions.</p></section></article></body></html>"""
# The text, style and script of a page. A page of two editions shows two numbers.
SHOWN = """() => [document.querySelector("#edition")?.textContent, window.edition,
  getComputedStyle(document.documentElement).getPropertyValue("--edition").trim()].map(String)"""
TOOLS = """const said = [], tools = { progress() {}, say: (text) => said.push(text), ask(text, actions) {
  said.push(text); tools.actions = actions; } };"""
KEEP = f"""async (scripts, choice) => {{ {TOOLS}
  await (await import(scripts + "keep.js")).keep(tools);
  // Some browsers ask the reader whether to keep what a site stores, and this reader does not answer; some never ask.
  const unanswered = {{ value: () => new Promise(() => {{}}) }};
  if (navigator.storage) Object.defineProperty(navigator.storage, "persist", unanswered);
  const name = Object.keys(tools.actions).find((text) => text.startsWith(choice));
  await tools.actions[name]();
  await navigator.serviceWorker.ready;
  return said.at(-1);
}}"""
TOLD = f"""async (scripts) => {{ {TOOLS}
  await (await import(scripts + "keep.js")).tellOfRenewal(tools);
  return said.at(-1);
}}"""
RESTS = "async () => !(await navigator.locks.query()).held.length"
NEWEST = (
    "async () => (await (await (await caches.open('book /')).match('/kept.json'))?.json())?.edition"
)
IS_CONTROLLED = "() => Boolean(navigator.serviceWorker.controller)"


def sample(folder, with_scripts):
    """Write the parts that all editions share: our own scripts, as the book's pages have them."""
    if with_scripts is None:
        scripts.write(folder)
        (folder / "runtime" / "pyodide-lock.json").write_text('{"packages": {}}')
    else:
        shutil.copytree(with_scripts, folder, dirs_exist_ok=True)


def write_edition(folder, number, with_scripts=None):
    """Write edition ``number`` into ``folder``.

    ``appendix/three`` and two files of its folder never change.
    """
    sample(folder, with_scripts)
    files = {
        "_static/book.css": f":root {{ --edition: {number} }}",
        "_static/book.js": f"window.edition = {number};",
        "_static/fixed.css": ":root { --edition: 0 }",
        "_static/fixed.js": "window.edition = 0;",
        f"runtime/wheels/{sha256(str(number).encode()).hexdigest()[:12]}/lasting.js": (
            f"export default {number};"
        ),
    }
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    version = {name: sha256(text.encode()).hexdigest()[:8] for name, text in files.items()}
    for name in PAGES:
        kind, shown = ("fixed", 0) if name == "appendix/three" else ("book", number)
        up = "../" * name.count("/")
        text = PAGE.format(
            name=name,
            up=up,
            edition=shown,
            css=version[f"_static/{kind}.css"],
            js=version[f"_static/{kind}.js"],
        ).replace("/book.", f"/{kind}.")
        (folder / f"{name}.html").parent.mkdir(exist_ok=True)
        (folder / f"{name}.html").write_text(text)
    install.write_list(folder)
    for path in folder.rglob("*"):  # servers distinguish editions by the time
        os.utime(path, (1_000_000_000 + number, 1_000_000_000 + number))


class Network(SimpleHTTPRequestHandler):
    """A server of ``folder`` that, after ``left`` requests, fails as ``broken`` says."""

    folder, left, broken = None, None, "cut"
    refused, held = 0, threading.Event()

    def __init__(self, *arguments):
        super().__init__(*arguments, directory=type(self).folder)

    def do_GET(self):
        network = type(self)
        if network.left is not None and network.left <= 0:
            network.refused += "offline.json" in self.path or "?kept=" in self.path
            if network.broken == "hangs":
                network.held.wait(120)
            elif network.broken == "busy":
                self.send_error(503)
            elif network.broken == "half":  # breaks off within the answer
                self.send_response(200)
                self.send_header("Content-Length", "100000")
                self.end_headers()
                self.wfile.write(b"<p")
            self.close_connection = True
            return
        if network.left is not None and "service-worker.js" not in self.path:
            network.left -= 1
        super().do_GET()

    def log_message(self, *arguments):
        pass


@contextmanager
def network(folder):
    """Yield a server's handler class, which a test configures, and its address."""
    handler = type("Here", (Network,), {"folder": str(folder), "held": threading.Event()})
    server = ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield handler, f"http://127.0.0.1:{server.server_port}/"
    finally:
        handler.held.set()
        server.shutdown()
        server.server_close()


def scripts_of(folder):
    """Return the path of the folder with our scripts."""
    (scripts,) = (folder / "runtime").glob("scripts-*")
    return f"/{scripts.relative_to(folder)}/"


def listed(folder):
    return json.loads((folder / install.LIST).read_text("utf8"))
