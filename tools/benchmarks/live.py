"""Code in the page, from pressing Run to the first result: ``python -m tools.benchmarks.live``.

One chapter of the book as ``make book`` built it, in headless Chromium, from a local server. Cold
is a fresh browser with an empty cache; warm is a new visit in the same browser. The time runs from
the press on the first SymPy cell's Run until its formula is typeset on the page. Beside it stands
the time of the bare runtime in the same browser: Pyodide started in a worker, and SymPy imported.
An assignment shows what each later cell costs beyond its own work: code, message, outcome and page
together. JupyterLite's time runs from opening the notebook of an exercise until its first cell,
which imports SymPy and ``coursework``, has run. What is downloaded is told as well.
"""

import gzip
import statistics
import sys
import tempfile
import threading
import time
import urllib.request
from pathlib import Path

from playwright.sync_api import sync_playwright

from notebook_pages.browser import FLAGS, find
from notebook_pages.serve import server

from .pages import ALONE

PAGE = "chapters/direction-cosine-matrices"
NOTEBOOK = "lite/notebooks/index.html?path=exercises/direction-cosine-matrices.ipynb"
SITE = Path("_build/html")
ROUNDS = 5
CELLS = 30
ARGUMENTS = [*FLAGS, ALONE]

# Milliseconds from the press on a cell's Run until the cell has run and the page is painted.
PRESS = """
(number) => new Promise((resolve) => {
  const root = document.documentElement, start = performance.now();
  const watch = new MutationObserver(() => {
    if (root.classList.contains('live-busy')) return;
    watch.disconnect();
    requestAnimationFrame(() => resolve(performance.now() - start));
  });
  document.querySelectorAll('div.cell button.run-cell')[number].click();
  watch.observe(root, { attributeFilter: ['class'] });
})
"""
# Milliseconds until a worker of its own, with nothing of the book, has imported SymPy.
BARE = """
(runtime) => new Promise((resolve, reject) => {
  const start = performance.now();
  const program = `
    import { loadPyodide } from "${runtime}pyodide/pyodide.js";
    const python = await loadPyodide(
      { lockFileURL: "${runtime}pyodide-lock.json", packages: ["sympy"] });
    python.runPython("import sympy");
    postMessage("imported");`;
  const script = new Blob([program], { type: "text/javascript" });
  const worker = new Worker(URL.createObjectURL(script), { type: "module" });
  worker.onerror = (event) => reject(new Error(event.message));
  worker.onmessage = () => {
    worker.terminate();
    resolve(performance.now() - start);
  };
})
"""
FIRST_SYMPY = """
() => [...document.querySelectorAll('div.cell')].findIndex(
  (cell) => cell.querySelector('pre').textContent.includes('import sympy')
    && cell.querySelector('.cell_output .katex'))
"""
WRITE = """
([number, code]) => {
  const content = document.querySelectorAll('div.cell')[number].querySelector('.cm-content');
  content.focus();
  document.execCommand('selectAll');
  document.execCommand('insertText', false, code);
}
"""


def visit(context, address):
    """Press Run on the first SymPy cell; return the page, the cell's number,
    the seconds and what was asked for.
    """
    page = context.new_page()
    asked = []
    page.on("requestfinished", lambda request: asked.append(request.url))
    page.goto(address)
    page.wait_for_load_state("networkidle")
    before = len(asked)
    number = page.evaluate(FIRST_SYMPY)
    seconds = page.evaluate(PRESS, number) / 1000
    return page, number, seconds, asked[before:]


def open_notebook(context, site):
    """Open a notebook in JupyterLite and run its first cell; return
    the seconds and what was asked for.
    """
    page = context.new_page()
    asked = []
    context.on(
        "response",
        lambda response: (
            response.status == 200
            and not response.from_service_worker
            and asked.append(response.url)
        ),
    )
    start = time.monotonic()
    page.goto(f"{site}{NOTEBOOK}")
    page.locator(".jp-CodeCell").first.click()
    page.keyboard.press("Shift+Enter")
    page.wait_for_function(
        r"document.querySelector('.jp-CodeCell .jp-InputPrompt')?.innerText.match(/\d/)",
        timeout=120_000,
    )
    seconds = time.monotonic() - start
    page.close()
    return seconds, asked


def bare(context, site):
    """Seconds until SymPy is imported without the book around it."""
    page = context.new_page()
    page.goto(f"{site}search.html")
    seconds = page.evaluate(BARE, f"{site}runtime/") / 1000
    page.close()
    return seconds


def cell_overhead(page, number):
    """Median milliseconds of a cell that does nothing but give a name a value."""
    page.evaluate(WRITE, [number, "a = 1"])
    page.evaluate(PRESS, number)
    return statistics.median(page.evaluate(PRESS, number) for _ in range(CELLS))


def weight(urls):
    """Megabytes after gzip of what was asked for."""
    bodies = [
        urllib.request.urlopen(url).read() for url in dict.fromkeys(urls) if url.startswith("http")
    ]
    return sum(len(gzip.compress(body, 6)) for body in bodies) / 1e6


def main():
    executable = find()
    if executable is None:
        sys.exit("There is no Chromium on this machine to open the pages with.")
    if not (SITE / f"{PAGE}.html").is_file():
        sys.exit("The book is not built: run `make book` first.")
    book = server(folder=SITE)
    threading.Thread(target=book.serve_forever, daemon=True).start()
    site = f"http://127.0.0.1:{book.server_port}/"
    address = f"{site}{PAGE}.html"
    cold, warm, overheads, bare_cold, bare_warm, lite_cold, lite_warm = ([] for _ in range(7))
    with sync_playwright() as playwright:
        for _ in range(ROUNDS):
            with tempfile.TemporaryDirectory() as profile:
                context = playwright.chromium.launch_persistent_context(
                    profile, executable_path=executable, args=ARGUMENTS
                )
                bare_cold.append(bare(context, site))
                bare_warm.append(bare(context, site))
                context.close()
            with tempfile.TemporaryDirectory() as profile:
                context = playwright.chromium.launch_persistent_context(
                    profile, executable_path=executable, args=ARGUMENTS
                )
                page, number, seconds, asked = visit(context, address)
                cold.append(seconds)
                overheads.append(cell_overhead(page, number))
                page.evaluate("localStorage.clear()")
                page.close()
                page, _, seconds, _ = visit(context, address)
                warm.append(seconds)
                context.close()
            with tempfile.TemporaryDirectory() as profile:
                context = playwright.chromium.launch_persistent_context(
                    profile, executable_path=executable, args=ARGUMENTS
                )
                seconds, lite_asked = open_notebook(context, site)
                lite_cold.append(seconds)
                lite_warm.append(open_notebook(context, site)[0])
                context.close()
    print("| what | median | of", ROUNDS, "|")
    print("|---|---|---|")
    for what, values, unit in (
        ("first SymPy result, cold", cold, "s"),
        ("bare runtime and SymPy, cold", bare_cold, "s"),
        ("first SymPy result, warm", warm, "s"),
        ("bare runtime and SymPy, warm", bare_warm, "s"),
        ("each later cell, beyond its own work", overheads, "ms"),
        ("JupyterLite until a cell has run, cold", lite_cold, "s"),
        ("JupyterLite until a cell has run, warm", lite_warm, "s"),
    ):
        every = ", ".join(f"{value:.2f}" for value in sorted(values))
        print(f"| {what} | {statistics.median(values):.2f} {unit} | {every} |")
    for what, urls in (("download", asked), ("JupyterLite's download", lite_asked)):
        print(f"| {what}, MB after gzip | {weight(urls):.1f} | {len(set(urls))} files |")


if __name__ == "__main__":
    main()
