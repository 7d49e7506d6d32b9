"""The built site on other servers: other headers and types, below a path, in a foreign frame."""

import json
import shutil
import subprocess
import threading
import time
import urllib.request
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer

import pytest
from places import BROWSER_REQUIRED, HTML
from playwright.sync_api import expect
from test_live import ENDLESS, QUIET
from test_site import violations

from notebook_pages import finish, install, serve

POLICY_HEADER = "Content-Security-Policy"
SIZE = (
    f"{json.loads((HTML / 'runtime' / 'pyodide-lock.json').read_text('utf8'))['bytes'] / 1e6:.0f} "
    "MB"
)


class Silent(SimpleHTTPRequestHandler):
    """``python -m http.server``, without its log."""

    added = {}

    def end_headers(self):
        for name, value in self.added.items():
            self.send_header(name, value)
        super().end_headers()

    def log_message(self, *arguments):
        pass


class LikeGitHubPages(Silent):
    """The headers of GitHub Pages: files may be cached for ten minutes, and anybody may read them."""

    added = {
        "Access-Control-Allow-Origin": "*",
        "Cache-Control": "max-age=600",
        "Server": "GitHub.com",
    }
    extensions_map = SimpleHTTPRequestHandler.extensions_map | {
        ".js": "application/javascript; charset=utf-8",
        ".wasm": "application/wasm",
    }


@contextmanager
def serving(handler=Silent, folder=HTML):
    book = ThreadingHTTPServer(("127.0.0.1", 0), partial(handler, directory=folder))
    threading.Thread(target=book.serve_forever, daemon=True).start()
    try:
        yield f"http://127.0.0.1:{book.server_port}/"
    finally:
        book.shutdown()
        book.server_close()


@pytest.fixture
def page(browser):
    """A page with the book's policy in force; violations are errors on the console."""
    context = browser.new_context(bypass_csp=False, viewport={"width": 1300, "height": 900})
    opened = context.new_page()
    opened.faults = []
    opened.on(
        "console", lambda message: message.type == "error" and opened.faults.append(message.text)
    )
    opened.on("pageerror", lambda error: opened.faults.append(str(error)))
    yield opened
    context.close()


def run_and_stop(page, address):
    """Run a cell, stop an endless one, and check that the names are still defined.

    So Python is isolated. Nothing is forbidden.
    """
    page.goto(address + QUIET)
    assert page.get_attribute("button.run-page", "data-size") == SIZE
    page.locator("div.cell").nth(2).locator("button.run-cell").click()
    page.wait_for_selector("#live-words:has-text('Cell 3 ran')")
    assert page.evaluate("crossOriginIsolated")
    editor = page.locator("div.cell").nth(3).locator(".cm-content")
    editor.fill(ENDLESS)
    page.keyboard.press("Shift+Enter")
    page.wait_for_selector("div.cell:nth-child(n) .cell_output:has-text('begun')")
    page.click(".live-bar button:has-text('Stop')")
    page.wait_for_selector("#live-words:has-text('Stopped.')")
    assert "is still there" in page.inner_text("#live-words")
    editor.fill("print(kept * 2)")
    page.keyboard.press("Shift+Enter")
    page.wait_for_selector(".cell_output:has-text('keptkept')")
    assert page.locator("[data-size]").count() == 0, "what has come is not to be fetched again"
    assert page.faults == []


@pytest.mark.long
def test_plain_server_below_a_path_and_then_no_network(page, tmp_path):
    """On a server like that of GitHub Pages, a service worker isolates the page.

    It keeps the book on request.
    """
    (tmp_path / "courses").mkdir()
    (tmp_path / "courses" / "book").symlink_to(HTML, target_is_directory=True)
    with serving(LikeGitHubPages, tmp_path) as root:
        address = f"{root}courses/book/"
        run_and_stop(page, address)
        page.click("details.take-away summary")
        page.click("button.keep-book")
        offer = json.loads((HTML / install.LIST).read_text("utf8"))
        bytes_of = {
            part: sum(size for _, size in offer[part].values()) for part in ("book", "python")
        }
        choice = page.locator(".live-choices button").first
        assert choice.inner_text() == f"The pages, {bytes_of['book'] / 1e6:.0f} MB"
        choice.click()
        page.wait_for_selector("#live-words:has-text('is stored in this browser')")
        assert page.faults == []
    # The server is gone.
    for name in ("chapters/euler-angles.html", "", "exercises/index.html?from=elsewhere"):
        page.goto(address + name)
        page.wait_for_selector("html:not(.settling, .in-parts)")
        assert page.locator("h1").first.is_visible()
        assert page.evaluate("getComputedStyle(document.body).fontFamily").startswith('"Source')
    page.goto(f"{address}search.html?q=gimbal")
    page.wait_for_selector("#search-results li a")
    assert (
        page.evaluate(f"fetch('{address}lite/index.html').then(() => 'there', () => 'gone')")
        == "gone"
    )


@pytest.mark.parametrize("colours", ["light", "dark"])
def test_page_of_a_wrong_address_leads_home_from_any_folder(page, tmp_path, colours):
    (tmp_path / "courses").mkdir()
    (tmp_path / "courses" / "book").symlink_to(HTML, target_is_directory=True)
    (tmp_path / "404.html").symlink_to(HTML / "404.html")
    with serving(serve.Handler, tmp_path) as root:
        page.emulate_media(color_scheme=colours)
        page.goto(f"{root}courses/book/chapters/")  # a folder, which has no page of its own
        expect(page.get_by_role("link", name="front page")).to_be_visible()
        page.goto(f"{root}courses/book/chapters/no/such-page.html")
        home = f"{root}courses/book/index.html"
        expect(page.get_by_role("link", name="front page")).to_have_attribute("href", home)
        assert violations(page) == [] and page.get_by_role("main").get_by_role("link").count() == 2
        page.get_by_role("link", name="front page").click()
        page.wait_for_url(home)


def test_list_of_what_is_kept_is_the_site():
    offer = json.loads((HTML / install.LIST).read_text("utf8"))
    for files in (offer["book"], offer["python"]):
        for name, (print_, size) in files.items():
            assert (HTML / name).stat().st_size == size
            assert finish.sha256((HTML / name).read_bytes()).hexdigest().startswith(print_)
    pages = {str(path.relative_to(HTML)) for path in finish.pages_of(HTML)} - {"404.html"}
    assert pages <= set(offer["book"]) and not [
        name for name in offer["book"] if name.startswith("lite/")
    ]
    lock = json.loads((HTML / "runtime" / "pyodide-lock.json").read_text("utf8"))
    assert sum(size for _, size in offer["python"].values()) >= lock["bytes"]


def test_manifest_makes_the_site_installable():
    manifest = json.loads((HTML / install.MANIFEST).read_text("utf8"))
    from PIL import Image

    for icon in manifest["icons"]:
        if icon["type"] == "image/png":
            with Image.open(HTML / icon["src"]) as picture:
                assert f"{picture.width}x{picture.height}" == icon["sizes"]
                assert len(picture.getcolors(100_000)) > 3, "the three axes are there"
        assert (HTML / icon["src"]).is_file()


def test_every_page_names_a_strict_policy_and_versions():
    pages = finish.pages_of(HTML)
    for path in pages:
        text = path.read_text("utf8")
        assert text.count(POLICY_HEADER) == 1
        rules = dict(
            rule.split(" ", 1)
            for rule in text.partition(f'{POLICY_HEADER}" content="')[2]
            .partition('"')[0]
            .split("; ")
        )
        assert (
            "unsafe-inline" not in rules["script-src"]
            and "'unsafe-eval'" not in rules["script-src"]
        )
        assert rules["object-src"] == "'none'"
        assert POLICY_HEADER not in text[max(text.find("<script"), 0) :] or "<script" not in text
        for match in finish.VERSIONED.finditer(text):
            assert "?v=" in match[0], f"{path}: {match[0]} has no version"


# --- in a frame of a foreign page -----------------------------------------------------------------


@pytest.mark.long
def test_in_a_foreign_frame(page, tmp_path):
    """Code runs in the page of a course on another host, though the frame is not isolated."""
    with serving() as address:
        # Use another site than that of the surrounding page.
        frame_of = address.replace("127.0.0.1", "localhost") + QUIET
        (tmp_path / "course.html").write_text(
            f'<link rel=icon href=data:,><iframe src="{frame_of}" width=1000 height=800></iframe>'
        )
        with serving(folder=tmp_path) as around:
            page.goto(f"{around}course.html")
            frame = page.frame_locator("iframe")
            frame.locator("div.cell").nth(2).locator("button.run-cell").click()
            frame.locator("#live-words:has-text('Cell 3 ran')").wait_for()
            frame.locator("details.take-away summary").click()
            frame.locator("button.keep-book").click()
            frame.locator("#live-words:has-text('its own tab')").wait_for()
            assert page.faults == []


# --- nginx ----------------------------------------------------------------------------------------

NGINX = """
pid {folder}/nginx.pid; error_log {folder}/error.log; daemon off; worker_processes 1;
events {{ worker_connections 64; }}
http {{
  include /etc/nginx/mime.types; default_type application/octet-stream; access_log off; gzip on;
  client_body_temp_path {folder}/a; proxy_temp_path {folder}/b; fastcgi_temp_path {folder}/c;
  uwsgi_temp_path {folder}/d; scgi_temp_path {folder}/e;
  server {{ listen 127.0.0.1:{port}; root {site};
    {added} }}
}}
"""


@contextmanager
def nginx(folder, added=""):
    """Start Debian's nginx with its own table of types, which lacks ``.mjs``."""
    program = shutil.which("nginx") or shutil.which("/usr/sbin/nginx")
    if program is None:
        reason = "nginx is not on this machine (on Debian: sudo apt install nginx-light)"
        pytest.fail(reason) if BROWSER_REQUIRED else pytest.skip(reason)
    with serving() as free_address:  # a port that was free a moment ago
        port = free_address.split(":")[-1].strip("/")
    settings = folder / "nginx.conf"
    settings.write_text(NGINX.format(folder=folder, port=port, site=HTML, added=added))
    process = subprocess.Popen([program, "-c", settings, "-p", folder, "-e", folder / "error.log"])
    try:
        address = f"http://127.0.0.1:{port}/"
        for _ in range(600):
            try:
                urllib.request.urlopen(f"{address}index.html").close()
                break
            except OSError:
                assert process.poll() is None, (folder / "error.log").read_text()
                time.sleep(0.05)
        yield address
    finally:
        process.terminate()
        process.wait()


@pytest.mark.long
def test_policy_as_a_header_lets_python_run(page, tmp_path):
    """Unlike a policy in the page, a header also applies to threads; Python must start under it."""
    text = (HTML / QUIET).read_text("utf8")
    rules = text.partition(f'{POLICY_HEADER}" content="')[2].partition('"')[0]
    added = f'add_header {POLICY_HEADER} "{rules}";'
    with nginx(tmp_path, added) as address:
        run_and_stop(page, address)
