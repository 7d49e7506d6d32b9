"""How much of a hall's screen a lecture uses: ``python -m tools.benchmarks.lecture [chapter ...]``.

The book must be built. Each lecture is gone through at 1280 by 720. The table says how many steps
it has, in how many of them a drawing is seen, what share of the screen the largest drawing of such
a step fills (the box round what is drawn, without the empty margin of its sheet), in how many a
drawing stands without a word beside it, and how many are higher than the screen.
"""

import statistics
import sys

from notebook_pages.browser import open_browser

from .calm import BOOK, chapters

WIDTH, HEIGHT = 1280, 720
STEPS = """() => {
  const press = (key) => document.body.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
  press("Home");
  const MARKS = "path, line, circle, ellipse, rect, polygon, polyline, use, text";
  const all = (where, what) => [...where.querySelectorAll(what)];
  const visible = { opacityProperty: true, visibilityProperty: true };
  const seen = (one) => one.checkVisibility(visible) && one.getBoundingClientRect().width;
  const share = (drawing) => {
    const marks = drawing.localName === "img" ? [drawing] : all(drawing, MARKS);
    const boxes = marks.filter((mark) => !mark.closest("defs, clipPath") && seen(mark)).map((mark) => mark.getBoundingClientRect());
    const span = (low, high, most) =>
      Math.min(most, Math.max(...boxes.map((box) => box[high]))) - Math.max(0, Math.min(...boxes.map((box) => box[low])));
    return boxes.length ? (span("left", "right", innerWidth) * span("top", "bottom", innerHeight)) / innerWidth / innerHeight : 0;
  };
  const count = Number(/of (\\d+)/.exec(document.querySelector(".lecture-bar").textContent)[1]);
  const steps = [];
  for (let step = 0; step < count; step += 1) {
    const drawings = all(document, ".bd-article figure :is(svg[viewBox]:not(.formula), img)").filter(seen);
    const words = all(document, ".bd-article :is(p, li):not(figure *, .lecture-bar)").filter((one) => seen(one) && one.textContent.trim());
    const high = [document.scrollingElement, document.querySelector(".bd-article")].some((one) =>
      one.scrollHeight > innerHeight + 1 && getComputedStyle(one).overflowY !== "hidden");
    steps.push([Math.max(0, ...drawings.map(share)), words.length, high]);
    press("PageDown");
  }
  return steps;
}"""  # noqa: E501


def main():
    names = [f"chapters/{name}" for name in sys.argv[1:]] or chapters()
    print(
        "chapter                      steps  drawn  share: least median most (%)  without words  "
        "too high"
    )
    everything = []
    with open_browser() as browser:
        page = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT})
        for name in names:
            page.goto((BOOK / "_build" / "html" / f"{name}.html").as_uri())
            page.wait_for_timeout(1500)
            page.keyboard.press("l")
            page.wait_for_selector("html.lecture")
            steps = page.evaluate(STEPS)
            everything += steps
            print_line(name[9:], steps)
    print_line("all", everything)


def print_line(name, steps):
    drawn = [step for step in steps if step[0]]
    shares = [100 * step[0] for step in drawn] or [0]
    row = f"{min(shares):12.0f}{statistics.median(shares):7.0f}{max(shares):5.0f}"
    silent = sum(not words for _, words, _ in drawn)
    cut = sum(bool(high) for *_, high in steps)
    print(f"{name:27}{len(steps):7}{len(drawn):7}{row}{silent:18}{cut:10}")


if __name__ == "__main__":
    main()
