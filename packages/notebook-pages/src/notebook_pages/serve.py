"""Show the built book on a local address: ``python -m notebook_pages.serve [port]``.

In the offline book: ``python serve.py [port]``. It needs only Python's standard library.
"""

import sys
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

HERE = Path(__file__).resolve().parent
# The offline book contains a copy of this file, with the pages beside it.
BOOK = HERE if (HERE / "index.html").is_file() else Path("_build/html")


class Handler(SimpleHTTPRequestHandler):
    # Browsers run a module only if it is served as JavaScript, and the system's own table of types
    # may not know .mjs or .wasm.
    extensions_map = SimpleHTTPRequestHandler.extensions_map | {
        ".js": "text/javascript",
        ".mjs": "text/javascript",
        ".wasm": "application/wasm",
        ".whl": "application/octet-stream",
        ".ipynb": "application/x-ipynb+json",
        ".svg": "image/svg+xml",
    }

    # Only an isolated page may share memory with its Python, which can then be interrupted without
    # losing its variables. On servers that do not send these headers, the page does without.
    isolated = True

    def end_headers(self):
        # JupyterLite's kernel hangs in an isolated page when it writes a file or shows an error.
        if self.isolated and not self.path.startswith("/lite/"):
            self.send_header("Cross-Origin-Opener-Policy", "same-origin")
            self.send_header("Cross-Origin-Embedder-Policy", "require-corp")
            # Frames without an origin need this header.
            self.send_header("Cross-Origin-Resource-Policy", "cross-origin")
        super().end_headers()

    def send_error(self, code, *arguments, **more):
        """Send the book's own page for an address that does not exist."""
        page = Path(self.directory, "404.html")
        if code == 404 and page.is_file():
            self.error_message_format = page.read_text("utf8").replace("%", "%%")
        super().send_error(code, *arguments, **more)

    def list_directory(self, path):
        """Send the same page for a folder without a page of its own, as other hosts do."""
        self.send_error(404)

    def log_message(self, *arguments):
        """Log nothing."""


def server(folder=BOOK, port=0, handler=Handler):
    """Return a server of ``folder``; port 0 selects any free port."""
    return ThreadingHTTPServer(("127.0.0.1", port), partial(handler, directory=folder))


def main():
    port = int(sys.argv[1]) if len(sys.argv) > 1 else 0
    try:
        book = server(port=port)
    except OSError:
        # The port is in use, so take any other.
        book = server()
    print(f"The book is at http://127.0.0.1:{book.server_port}/ (stop with Ctrl+C)", flush=True)
    try:
        book.serve_forever()
    except KeyboardInterrupt:
        print()


if __name__ == "__main__":
    main()
