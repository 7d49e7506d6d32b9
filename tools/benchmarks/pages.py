"""Weight of a page, and time until its mathematics is shown: ``python -m tools.benchmarks.pages``.

One chapter of the book as ``make book`` built it, against the same notebook built the stock
Jupyter Book way: default settings, mathematics set in the reader's browser by MathJax 3. Stock
pages fetch MathJax from somebody else's server; here it comes from npm and is served with all the
rest, which favours the stock page: no distant server, no second connection. Whatever else a page
asks of other servers is refused and counted.

Both pages are opened in turn, each time in a fresh browser with an empty cache. The weight is that
of all responses after gzip. Mathematics counts as shown when every formula is set, its typefaces
are there, and the browser has painted two frames since.
"""

import gzip
import os
import shutil
import statistics
import subprocess
import sys
import threading
from pathlib import Path

import yaml
from playwright.sync_api import sync_playwright

from notebook_pages.browser import FLAGS, find
from notebook_pages.serve import server

PAGE = "chapters/euler-angles"
OURS, SCRATCH = Path("_build/html"), Path("_build/benchmark")
MATHJAX = "mathjax@3.2.2"
ROUNDS = 7
SLOWED = (1, 4)  # how many times as slow a processor the browser is to pretend
# The browser finds nobody but this machine.
ALONE = "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1"

CLOCK = """
document.addEventListener('DOMContentLoaded', async () => {
  if (document.querySelector('script[src*="mathjax"]')) {
    while (!window.MathJax?.startup?.promise) await new Promise(requestAnimationFrame);
    await MathJax.startup.promise;
  }
  await document.fonts.ready;
  await new Promise(requestAnimationFrame);
  await new Promise(requestAnimationFrame);
  window.mathematicsShown = performance.now();
});
"""
FORMULAS = "() => document.querySelectorAll('.katex, mjx-container').length"


def stock_book():
    """Build the chapter with nothing but what a new Jupyter Book
    has, and return the site's folder.
    """
    if SCRATCH.exists():
        shutil.rmtree(SCRATCH)
    source = SCRATCH / "source"
    (source / PAGE).parent.mkdir(parents=True)
    shutil.copy(f"{PAGE}.ipynb", source / f"{PAGE}.ipynb")
    shutil.copy("appendix/references.bib", source)
    (source / "index.md").write_text("# Orientation of Reference Frames\n", "utf8")
    contents = {"format": "jb-book", "root": "index", "chapters": [{"file": PAGE}]}
    (source / "_toc.yml").write_text(yaml.safe_dump(contents), "utf8")
    settings = {
        "title": "Orientation of Reference Frames",
        "execute": {"execute_notebooks": "off"},
        "bibtex_bibfiles": ["references.bib"],
        "sphinx": {
            "extra_extensions": ["sphinx_exercise"],
            "config": {"mathjax_path": "mathjax/es5/tex-mml-chtml.js"},
        },
    }
    (source / "_config.yml").write_text(yaml.safe_dump(settings), "utf8")
    programs = Path(sys.executable).parent
    environment = os.environ | {"PATH": f"{programs}{os.pathsep}{os.environ['PATH']}"}
    subprocess.run(
        [
            programs / "npm",
            "install",
            "--silent",
            "--ignore-scripts",
            "--no-audit",
            "--no-fund",
            "--prefix",
            SCRATCH,
            MATHJAX,
        ],
        check=True,
        env=environment,
    )
    subprocess.run(
        [programs / "jupyter-book", "build", source, "-q"],
        check=True,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    site = source / "_build" / "html"
    shutil.copytree(SCRATCH / "node_modules" / "mathjax", site / "_static" / "mathjax")
    return site


def visit(playwright, executable, address, slowed=1):
    """Open a page in a fresh browser, and return it when its
    mathematics is shown, with its responses.
    """
    browser = playwright.chromium.launch(executable_path=executable, args=[*FLAGS, ALONE])
    page = browser.new_context(viewport={"width": 1300, "height": 900}).new_page()
    page.add_init_script(CLOCK)
    page.context.new_cdp_session(page).send("Emulation.setCPUThrottlingRate", {"rate": slowed})
    requests = {"finished": [], "refused": []}
    page.on("requestfinished", lambda request: requests["finished"].append(request))
    page.on("requestfailed", lambda request: requests["refused"].append(request))
    page.goto(address)
    page.wait_for_function("window.mathematicsShown", timeout=120_000)
    return browser, page, requests


def weigh(*visited):
    browser, page, requests = visit(*visited)
    page.wait_for_load_state("networkidle")
    bodies = [
        request.response().body()
        for request in requests["finished"]
        if not request.url.startswith("data:")
    ]
    result = {
        "formulas": page.evaluate(FORMULAS),
        "requests": len(bodies),
        "refused": len(requests["refused"]),
        "kilobytes": sum(len(gzip.compress(body, 6)) for body in bodies) / 1000,
    }
    browser.close()
    return result


def seconds(*visited):
    browser, page, _ = visit(*visited)
    shown = page.evaluate("window.mathematicsShown") / 1000
    browser.close()
    return shown


def main():
    executable = find()
    if executable is None:
        sys.exit("There is no Chromium on this machine to open the pages with.")
    if not (OURS / f"{PAGE}.html").is_file():
        sys.exit("The book is not built: run `make book` first.")
    sites = {"this book": OURS, "stock Jupyter Book": stock_book()}
    addresses = {}
    for name, folder in sites.items():
        book = server(folder=folder)
        threading.Thread(target=book.serve_forever, daemon=True).start()
        addresses[name] = f"http://127.0.0.1:{book.server_port}/{PAGE}.html"
    with sync_playwright() as playwright:
        weights = {
            name: weigh(playwright, executable, address) for name, address in addresses.items()
        }
        times = {(name, slowed): [] for name in sites for slowed in SLOWED}
        for _ in range(ROUNDS):
            for slowed in SLOWED:
                for name, address in addresses.items():
                    times[name, slowed].append(seconds(playwright, executable, address, slowed))
    report(weights, {key: statistics.median(values) for key, values in times.items()})


def report(weights, shown):
    ours, stock = weights
    print(
        f"{PAGE}: {weights[ours]['formulas']} formulas in {ours}, {weights[stock]['formulas']} in "
        f"{stock}.\n"
    )
    print(f"| what | {ours} | {stock} | ratio |")
    print("|---|---|---|---|")
    for key, words in (
        ("kilobytes", "weight, kB after gzip"),
        ("requests", "requests"),
        ("refused", "requests to others"),
    ):
        row = [weights[name][key] for name in weights]
        ratio = f"{row[1] / row[0]:.3g} x" if row[0] else ""
        print(f"| {words} | {row[0]:.0f} | {row[1]:.0f} | {ratio} |")
    for slowed in SLOWED:
        row = [shown[name, slowed] for name in weights]
        where = "full speed" if slowed == 1 else f"processor {slowed} times as slow"
        print(
            f"| mathematics shown, {where} | {row[0]:.2f} s | {row[1]:.2f} s | "
            f"{row[1] / row[0]:.3g} x |"
        )


if __name__ == "__main__":
    main()
