"""What a drag of each moving figure costs, and what all of them
weigh: ``python -m tools.benchmarks.moving``.

Each figure stands alone on a page opened from disk. Its first slider is moved once for each
picture, as a drag moves it. Scripts, style, layout and painting for one picture are counted, in the
processor time of the page's main thread, which does not count what else this machine does, and for
a processor four times as slow as this one. A picture that takes longer than 16 ms comes late.

The weight is that of the scripts that a page loads, after gzip.
"""

import gzip
import platform
import statistics
import sys
import tempfile
from pathlib import Path

from playwright.sync_api import sync_playwright

from notebook_pages.browser import FLAGS, find
from notebook_pages.page import make_small
from orientation_figures import moving
from orientation_figures.moving import bundle

#: What has no slider is not dragged so.
FIGURES = [
    figure
    for figure in (getattr(moving, name) for name in moving.__all__)
    if getattr(figure, "kind", "") not in ("", "converter", "workbench")
]
SLOWED, FRAME, HEAVIEST = 4, 16, 80_000  # times, milliseconds, bytes
PICTURES, ROUNDS = 120, 5
PAGE = """<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{kind}</title>
<style>body {{ width: 714px; margin: auto; font: 16px/1.6 sans-serif; }} figure {{ margin: 0; }}
{style}</style></head>
<body>{still}<script>{shared}</script><script>{script}</script></body></html>"""
DRAG = """async (pictures) => {
  const range = document.querySelector('.live input[type=range], .live input');
  const [low, high] = range.type === 'range' ? [Number(range.min), Number(range.max)] : [0, 1];
  for (let k = 0; k < pictures; k += 1) {
    await new Promise((done) => requestAnimationFrame(done));
    range.value = String(low + (high - low) * (k + 0.5) / pictures);
    range.dispatchEvent(new Event('input', { bubbles: true }));
  }
  await new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
}"""


def busy(session):
    """Milliseconds of processor time that the main thread has used so far."""
    metrics = session.send("Performance.getMetrics")["metrics"]
    return 1000 * next(metric["value"] for metric in metrics if metric["name"] == "TaskDuration")


def weight(text, folder):
    """Bytes of a script as the site has it."""
    file = Path(folder, "script.js")
    file.write_text(text, "utf8")
    make_small(file.parent, [file], "warning")
    return len(gzip.compress(file.read_bytes(), 6))


def milliseconds(browser, figure, folder):
    """Milliseconds that the main thread needs for one picture: the median of some drags."""
    page_file = Path(folder) / f"{figure.kind}.html"
    page_file.write_text(
        PAGE.format(
            kind=figure.kind,
            style=bundle.style(),
            still=figure().still(),
            shared=bundle.shared_script(),
            script=bundle.script(figure.kind),
        ),
        "utf8",
    )
    page = browser.new_context(viewport={"width": 1000, "height": 900}).new_page()
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable", {"timeDomain": "threadTicks"})
    page.goto(page_file.as_uri())
    page.wait_for_selector(".moving[data-ready]")
    page.evaluate(DRAG, PICTURES)  # the first pictures also compile the scripts
    spent = []
    for _ in range(ROUNDS):
        begin = busy(session)
        page.evaluate(DRAG, PICTURES)
        spent.append((busy(session) - begin) / PICTURES)
    page.context.close()
    return statistics.median(spent)


def main():
    executable = find()
    if executable is None:
        sys.exit("There is no Chromium on this machine to open the figures with.")
    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as folder:
        browser = playwright.chromium.launch(executable_path=executable, args=list(FLAGS))
        print(
            f"Chromium {browser.version}, {platform.machine()}; a processor {SLOWED} times as "
            f"slow; a picture has {FRAME} ms.\n"
        )
        print("| figure | main thread, ms for each picture of a drag | kB after gzip |")
        print("|---|---|---|")
        weights = [weight(bundle.shared_script(), folder)]
        for figure in FIGURES:
            weights.append(weight(bundle.script(figure.kind), folder))
            spent = SLOWED * milliseconds(browser, figure, folder)
            print(f"| {figure.kind} | {spent:.1f} | {weights[-1] / 1000:.1f} |", flush=True)
        browser.close()
    print(f"| what they share | | {weights[0] / 1000:.1f} |")
    print(
        f"| all of our own JavaScript | | {sum(weights) / 1000:.1f}, of {HEAVIEST // 1000} at most "
        "|"
    )


if __name__ == "__main__":
    main()
