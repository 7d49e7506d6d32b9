"""Pages with moving figures: how the tests open them, wait for them, and read them."""

import itertools
import re

import numpy as np
import pytest
from test_site import WATCH_SHIFTS

from notebook_pages.page import make_small
from orientation_figures import moving
from orientation_figures.moving import bundle

FIGURES = {
    figure.kind: figure
    for figure in (getattr(moving, name) for name in moving.__all__)
    if issubclass(figure, moving.MovingFigure) and figure.kind
}
KINDS = sorted(FIGURES)
#: What a test sets in each figure: the attribute, its value, and where the figure
#: then shows it, if it has a field.
CHANGES = {
    "belt": ("angle", 0.3, "theta, rotation of the plate in degrees", 17.19),
    "challenge": ("turns", (("z", 0.3),), "Angle of the last turn in degrees", 17.19),
    "cloud": ("large", 0.3, "Error about z in degrees", 17.19),
    "converter": ("quaternion", (1.0, 0.0, 0.0, 0.0), None, None),
    "gate": ("steel", 4, "Steel of the car in microtesla", 4),
    "gimbal": ("angles", (0.3, 0.2, 0.1), "psi in degrees", 17.19),
    "graph": (
        "edges",
        (("A", "N", "z", 0.5), ("B", "N", "z", 0.4), ("C", "B", "x", 0.3)),
        None,
        None,
    ),
    "hands": ("quaternion", (0.6, 0.0, 0.8, 0.0), None, None),
    "motion": ("time", 3.0, "Time in seconds", 3),
    "nine_numbers": ("matrix", ((0, 1, 0), (-1, 0, 0), (0, 0, 1)), "row x, column y", 1),
    "phone": ("angles", (0.3, 0.2, 0.1), "alpha in degrees", 17.19),
    "quaternion": ("angle", 0.3, "theta in degrees", 17.19),
    "simple": ("angle", 0.3, "theta in degrees", 17.19),
    "successive": ("turns", (("z", 0.3),), "Turn 1, to frame A in degrees", 17.19),
    "triad": ("angle", 0.3, "theta in degrees", 17.19),
    "workbench": ("noise", 2.0, "Tolerance in degrees", 2),
}
assert set(CHANGES) == set(KINDS), (
    f"CHANGES says what a test sets in each figure, and not in {set(KINDS) - set(CHANGES)}"
)
THEMES = ("light", "dark")
WIDE, NARROW = {"width": 1300, "height": 900}, {"width": 380, "height": 760}
# What the pages of the book give to a figure: a background, and nothing else of theirs is needed.
PAGE = """<!doctype html><html lang="en" data-theme="{theme}"><head><meta charset="utf-8"><title>A figure</title>
<meta name="viewport" content="width=device-width"><link rel="icon" href="data:,">
<style>{style}
html {{ --pst-color-background: #fff; background: #fff; color: #1d2125; font: 16px/1.6 sans-serif; }}
html[data-theme="dark"] {{ --pst-color-background: #121212; background: #121212; color: #eceff2; }}
body {{ max-width: 714px; margin: 0 auto; padding: 0 16px; }} figure {{ margin: 0; }}
</style>{scripts}</head><body><main><h1>A figure</h1>{figures}
<p id="after">The text goes on.</p></main></body></html>"""
# Pictures are drawn before the next frame; a run that is still being
# computed goes on in those that follow.
SETTLED = """async () => {
  const picture = () => new Promise((done) => requestAnimationFrame(done));
  await picture();
  do await picture(); while (document.querySelector('.live[aria-busy=true]'));
}"""


@pytest.fixture(scope="session")
def front_end(tmp_path_factory):
    """A folder with the scripts of all figures, as the site has them: with short names."""
    folder = tmp_path_factory.mktemp("figures")
    (folder / "shared.js").write_text(bundle.shared_script(), "utf8")
    for kind in (*KINDS, "formula"):
        for name, text in {f"{kind}.js": bundle.script(kind), **bundle.beside(kind)}.items():
            (folder / name).write_text(text, "utf8")
    make_small(folder, sorted(folder.iterdir()), "warning")
    return folder


@pytest.fixture
def open_figure(browser, front_end):
    """``open_figure(figure, ...)``: a page from disk with that
    figure, or with each of a list of them.

    A name stands for the figure as it is at first. Whatever goes wrong on a page fails the test.
    """
    contexts, faults, count = [], [], itertools.count()

    def open_page(figures, theme="light", viewport=WIDE, **options):
        figures = figures if isinstance(figures, list) else [figures]
        figures = [FIGURES[figure]() if isinstance(figure, str) else figure for figure in figures]
        kinds = ["shared", *dict.fromkeys(figure.kind for figure in figures)]
        file = front_end / f"page-{next(count)}.html"
        scripts = "".join(f'<script defer src="{name}.js"></script>' for name in kinds)
        stills = "".join(figure.still() for figure in figures)
        file.write_text(
            PAGE.format(theme=theme, style=bundle.style(), scripts=scripts, figures=stills), "utf8"
        )
        context = browser.new_context(color_scheme=theme, viewport=viewport, **options)
        contexts.append(context)
        context.add_init_script(WATCH_SHIFTS)
        page = context.new_page()
        own = front_end.as_uri(), "data:"
        page.on(
            "console",
            lambda message: message.type in ("error", "warning") and faults.append(message.text),
        )
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.on("requestfailed", lambda request: faults.append(f"failed: {request.url}"))
        page.on(
            "request", lambda request: request.url.startswith(own) or faults.append(request.url)
        )
        page.goto(file.as_uri())
        if options.get("java_script_enabled", True):
            for k in range(len(figures)):
                page.locator(".moving[data-ready]").nth(k).wait_for()
            settle(page)
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert faults == [], faults


def settle(page):
    """Wait until what was asked has been drawn."""
    page.evaluate(SETTLED)


def numbers(page, name):
    """The numbers of a table on the page, as they are written there; NaN for a dash."""
    settle(page)
    rows = page.locator(f'[aria-label="{name}"] .row:has(.number)')
    texts = rows.evaluate_all(
        "rows => rows.map(row => [...row.querySelectorAll('.number')].map(n => n.textContent))"
    )
    values = [
        [float(re.sub(r"[^\d.-]", "", text.replace("\u2212", "-")) or "nan") for text in row]
        for row in texts
    ]
    return np.array(values).squeeze()


def drawing(page):
    """What is drawn: the path data of all marks."""
    return page.eval_on_selector(
        ".stage:not([hidden]) .marks",
        "marks => [...marks.children].map(mark => mark.getAttribute('d')).filter(Boolean).join()",
    )


def words(page):
    """The text under the drawing, its formulas as they are read aloud."""
    settle(page)
    return page.eval_on_selector(
        ".stage:not([hidden]) .words",
        "all => [...all.childNodes].map(one => one.ariaLabel ?? one.textContent).join('')",
    )


def type_number(page, name, value):
    page.get_by_label(name, exact=True).fill(str(value))
    page.get_by_label(name, exact=True).blur()
    settle(page)


def middle(locator):
    box = locator.bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def drag(page, start, way):
    page.mouse.move(*start)
    page.mouse.down()
    page.mouse.move(start[0] + way[0], start[1] + way[1], steps=5)
    page.mouse.up()


def drag_with_a_finger(page, start, end, steps=8):
    """Touches, as Chromium gets them from a screen."""
    session = page.context.new_cdp_session(page)
    for kind, parts in (
        ("touchStart", [0]),
        ("touchMove", [k / steps for k in range(1, steps + 1)]),
    ):
        for part in parts:
            x, y = (a + part * (b - a) for a, b in zip(start, end))
            session.send(
                "Input.dispatchTouchEvent",
                {"type": kind, "touchPoints": [{"x": float(x), "y": float(y)}]},
            )
    session.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
    session.detach()
    settle(page)
