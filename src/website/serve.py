"""``python -m website.serve [port]``: show the built book on a local address."""

import sys
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer


class Handler(SimpleHTTPRequestHandler):
    # Browsers run a module only if it is served as JavaScript, and the
    # system's own table of types may not know .mjs or .wasm.
    extensions_map = SimpleHTTPRequestHandler.extensions_map | {
        ".js": "text/javascript",
        ".mjs": "text/javascript",
        ".wasm": "application/wasm",
        ".whl": "application/octet-stream",
        ".ipynb": "application/x-ipynb+json",
        ".svg": "image/svg+xml",
    }

    def log_message(self, *arguments):
        """Say nothing about each request."""


def server(folder="_build/html", port=0):
    """A server of ``folder``; port 0 takes any that is free."""
    return ThreadingHTTPServer(("127.0.0.1", port), partial(Handler, directory=folder))


def main():
    port = int(sys.argv[1]) if len(sys.argv) > 1 else 0
    try:
        book = server(port=port)
    except OSError:
        book = server()  # the port is taken
    print(f"The book is at http://127.0.0.1:{book.server_port}/ (stop with Ctrl+C)", flush=True)
    try:
        book.serve_forever()
    except KeyboardInterrupt:
        print()


if __name__ == "__main__":
    main()
