"""How soon and how smoothly the essay's gimbal can be dragged.

``python -m tools.benchmarks.essay [page ...]``

The book must be built. The pages with the gimbal, the essay and the front page, are opened as on
a telephone, by a browser that pretends to have a much slower processor, from a server that
compresses. The table gives, in seconds since the page was asked for, its largest paint, when the
gimbal was there, and when the first drag had moved it; by how much the page shifted; and what a
dragged picture costs the page's script: its event and its frame, the median and the slowest
twentieth, by the clock and, beside it, in the main thread's own processor time, which does not
count what else this machine does. Where the processor draws the graphics, as in headless
browsers, pictures come only as fast as it draws them; that is given as pictures a second, and
has nothing to do with the script.
"""

import os
import platform
import statistics
import sys

from playwright.sync_api import sync_playwright

from notebook_pages.browser import FLAGS, find

from .first_view import Compressing, serve

PAGES = ("rotations", "index")
SLOWED, ROUNDS, PICTURES = (1, 4, 6), 3, 40
PHONE = {
    "viewport": {"width": 380, "height": 780},
    "device_scale_factor": 2,
    "is_mobile": True,
    "has_touch": True,
}
WATCH = """
window.seen = { shift: 0, paint: 0, ready: 0 };
const watch = (type, take) =>
  new PerformanceObserver((list) => list.getEntries().forEach(take)).observe(
    { type, buffered: true });
watch('largest-contentful-paint', (one) => { seen.paint = one.startTime; });
watch('layout-shift', (one) => { if (!one.hadRecentInput) seen.shift += one.value; });
new MutationObserver((_, observer) => {
  if (!document.querySelector('.world[data-ready]')) return;
  observer.disconnect();
  seen.ready = performance.now();
}).observe(document, { subtree: true, childList: true, attributeFilter: ['data-ready'] });
"""
# Drag the camera to and fro, with one move for each picture.
DRAG = """async (pictures) => {
  const { world } = document.querySelector('.world'), { canvas } = world;
  const box = canvas.getBoundingClientRect();
  const [right, up] = world.onScreen([0, 0, 0]);
  const x = box.left + box.width / 2 + right, y = box.top + box.height / 2 - up;
  const send = (type, across) => canvas.dispatchEvent(new PointerEvent(type,
    { pointerId: 1, clientX: x + across, clientY: y, pointerType: 'mouse', bubbles: true }));
  canvas.setPointerCapture = () => {};   // which knows no pointer that nobody has
  const next = () => new Promise((done) => requestAnimationFrame(done));
  const before = JSON.stringify(world.picture.frames.D);
  send('pointerdown', 0);
  let first = 0;
  const spent = [], begin = performance.now();
  for (let k = 1; k <= pictures; k += 1) {
    const from = performance.now();
    send('pointermove', 40 * Math.sin(k / 6));
    const handled = performance.now() - from;
    world.script = 0;
    await next();
    spent.push(handled + world.script);
    if (!first && JSON.stringify(world.picture.frames.D) !== before) first = performance.now();
  }
  const rate = 1000 * pictures / (performance.now() - begin);
  send('pointerup', 0);
  return { first: first / 1000, spent, rate };
}"""


def script_seconds(session):
    """Processor time that the main thread has spent in scripts so far."""
    metrics = session.send("Performance.getMetrics")["metrics"]
    return next(metric["value"] for metric in metrics if metric["name"] == "ScriptDuration")


def measure(browser, address, slowed):
    """Measure one visit."""
    context = browser.new_context(**PHONE)
    page = context.new_page()
    page.add_init_script(WATCH)
    session = context.new_cdp_session(page)
    session.send("Performance.enable", {"timeDomain": "threadTicks"})
    session.send("Emulation.setCPUThrottlingRate", {"rate": slowed})
    page.goto(address)
    page.locator(".world").hover()
    page.locator(".world[data-ready]").wait_for(timeout=120_000)
    page.wait_for_function("document.querySelector('.world').world.picture")
    first = page.evaluate(DRAG, 3)["first"]
    begin = script_seconds(session)
    dragged = page.evaluate(DRAG, PICTURES)
    own = 1000 * (script_seconds(session) - begin) / PICTURES
    seen = page.evaluate("seen")
    context.close()
    return {
        "largest paint (s)": seen["paint"] / 1000,
        "gimbal (s)": seen["ready"] / 1000,
        "first drag (s)": first,
        "shift": seen["shift"],
        "a picture's script (ms)": statistics.median(dragged["spent"]),
        "95 %": statistics.quantiles(dragged["spent"], n=20)[-1],
        "processor (ms)": own,
        "pictures a second": dragged["rate"],
    }


def main():
    book = serve(Compressing)
    print(f"{platform.machine()}, medians of {ROUNDS} visits.")
    head = None
    with sync_playwright() as playwright:
        for page in sys.argv[1:] or PAGES:
            for slowed in SLOWED:
                visits = []
                for _ in range(ROUNDS):
                    browser = playwright.chromium.launch(executable_path=find(), args=list(FLAGS))
                    visits.append(measure(browser, f"{book}/{page}.html", slowed))
                    browser.close()
                if head is None:
                    head = list(visits[0])
                    print(
                        f"| page | slowed | {' | '.join(head)} | load |\n"
                        f"{'|---' * (len(head) + 3)}|"
                    )
                row = [f"{statistics.median(visit[name] for visit in visits):.3g}" for name in head]
                print(
                    f"| {page} | {slowed} | {' | '.join(row)} | {os.getloadavg()[0]:.1f} |",
                    flush=True,
                )


if __name__ == "__main__":
    main()
