"""A reader presses Run where all is well, where Python is missing, and where it cannot run."""

import re
import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer

import pytest
from places import HTML, PATIENCE
from playwright.sync_api import expect

CHAPTER = "chapters/simple-orientations.html"
EXERCISE = "exercises/simple-orientations.html"
# Words of browsers and of their programs, which mean nothing to a reader.
OF_PROGRAMS = ("Failed to fetch", "NetworkError", "dynamically imported module", "SecurityError")


@pytest.fixture
def page(browser):
    context = browser.new_context(viewport={"width": 1300, "height": 900}, bypass_csp=False)
    yield context.new_page()
    context.close()


def status_text(page, words):
    """Return the text of the status bar once it contains ``words``."""
    bar = page.locator("#live-words")
    expect(bar).to_contain_text(words, timeout=PATIENCE)
    assert not [part for part in OF_PROGRAMS if part in bar.inner_text()]
    return bar.inner_text()


def test_a_book_kept_without_python_says_so_offline(page, site):
    page.goto(site + CHAPTER)
    page.locator("details.take-away summary").click()
    page.locator("button.keep-book").click()
    page.locator(".live-choices button").first.click()
    status_text(page, "is stored in this browser")
    page.context.set_offline(True)
    # The computer has a network, but no way to the server.
    page.add_init_script("Object.defineProperty(navigator, 'onLine', { get: () => true })")
    page.reload()
    page.locator("button.run-cell:visible").first.click()
    assert "network" in status_text(page, "without Python")


def test_a_page_in_a_closed_frame_says_that_the_frame_is_closed(page, site):
    page.goto(f"{site}search.html")
    frame = f'<iframe sandbox="allow-scripts" src="{site}{CHAPTER}" width=900 height=700></iframe>'
    page.set_content(frame)
    inside = page.frame_locator("iframe")
    faults = []
    page.on("pageerror", lambda error: faults.append(str(error)))
    inside.locator("button.theme-switch-button:visible").first.click()
    expect(inside.locator("html")).to_have_attribute("data-mode", re.compile("light|dark"))
    inside.locator("button.search-button__button:visible").first.click()
    expect(inside.locator("dialog[open] input[type=search]")).to_be_focused()
    page.keyboard.press("Escape")
    inside.locator("button.run-cell:visible").first.click()
    expect(inside.locator("#live-words")).to_contain_text("sandbox", timeout=PATIENCE)
    assert faults == []


def test_a_page_saved_with_what_its_scripts_added_has_each_button_once(page, site):
    page.goto(site + CHAPTER)
    expect(page.locator("pre + .copybtn").nth(2)).to_be_attached()
    counts = {name: page.locator(name).count() for name in (".copybtn", ".run-cell", ".live-bar")}
    page.set_content(page.content())
    for name, count in counts.items():
        expect(page.locator(name)).to_have_count(count)


class AsText(SimpleHTTPRequestHandler):
    """A server that sends scripts as text, and forbids browsers to guess their type."""

    extensions_map = {**SimpleHTTPRequestHandler.extensions_map, ".js": "text/plain"}

    def end_headers(self):
        self.send_header("X-Content-Type-Options", "nosniff")
        super().end_headers()

    def log_message(self, *arguments):
        pass


def test_a_server_that_sends_scripts_as_text_is_named_at_once(page):
    with ThreadingHTTPServer(("127.0.0.1", 0), partial(AsText, directory=HTML)) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        page.goto(f"http://127.0.0.1:{server.server_port}/{CHAPTER}")
        expect(page.get_by_role("alert").filter(has_text="JavaScript")).to_be_visible(
            timeout=20_000
        )
        server.shutdown()


def test_contents_of_an_exercise_notebook_list_its_questions(page, site):
    page.goto(site + EXERCISE)
    faults = []
    page.context.on("console", lambda message: faults.append(message.text))
    with page.context.expect_page() as opened:
        page.locator("a.open-notebook").click()
    notebook = opened.value
    notebook.get_by_role("menuitem", name="View").click()
    notebook.get_by_text("Left Sidebar").hover()
    notebook.get_by_text("Show Table of Contents").click()
    expect(notebook.locator(".jp-tocItem").nth(2)).to_be_visible()
    assert not [fault for fault in faults if "is not a function" in fault]
