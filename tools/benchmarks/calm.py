"""How calmly each chapter can be read: ``python -m tools.benchmarks.calm [--pages]``.

Prose is what stands in a chapter's text outside of its boxes. Its runs end at whatever interrupts a
reader: a cell of code or a prediction. Headings, formulas and figures belong to the run; exercises
and recap come after it and are counted apart. With ``--pages`` the controls in the article of each
built page are counted too, once the page has come alive.
"""

import re
import statistics
import sys
from pathlib import Path

import nbformat
import yaml

BOOK = Path(__file__).resolve().parents[2]
# A box that asks or sets apart: from its fence to the same fence.
BOX = re.compile(r"^(`{3,}|:{3,})\{(\w[\w-]*)\}.*?^\1$", re.MULTILINE | re.DOTALL)
FORMULA = re.compile(r"\$\$.*?\$\$(?: \([\w-]+\))?|\$[^$]+\$", re.DOTALL)
COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)  # a step of the lecture, which no page shows
ASKS = {"predict": "predictions", "exercise": "exercises", "recap": "recaps"}


def chapters():
    parts = yaml.safe_load((BOOK / "_toc.yml").read_text("utf8"))["parts"]
    return [
        page["file"]
        for part in parts
        for page in part["chapters"]
        if page["file"].startswith("chapters/")
    ]


def words(text):
    """Words as they are read: each formula is one."""
    text = re.sub(
        r"^(\([\w-]+\)=|#+ .*|\|.*)$", " ", FORMULA.sub(" formula ", text), flags=re.MULTILINE
    )
    return len(re.findall(r"[A-Za-zÀ-ž][\w’'-]*", text))


def measure(path):
    """Runs of prose, and how much of each kind interrupts them."""
    runs, run = [], 0
    counts = dict.fromkeys((*ASKS.values(), "questions", "figures", "cells"), 0)

    def interrupt():
        nonlocal run
        if run:
            runs.append(run)
        run = 0

    reading = True  # up to the exercises: those are meant to be worked at
    for cell in nbformat.read(BOOK / f"{path}.ipynb", as_version=4).cells:
        if cell.cell_type == "code":
            figure = "hide-input" in cell.metadata.get("tags", [])
            counts["figures" if figure else "cells"] += 1
            if not figure and reading:
                interrupt()
            continue
        place = 0
        source = COMMENT.sub("", cell.source)
        text, exercises, _ = source.partition("## Exercises\n") if reading else ("", "", "")
        for box in BOX.finditer(source):
            counts["questions"] += box[0].count("```{question}")
            if box[2] in ASKS:
                counts[ASKS[box[2]]] += 1
            if box.start() < len(text):
                run += words(text[place : box.start()]) + (0 if box[2] in ASKS else words(box[0]))
                place = box.end()
                if box[2] in ASKS:
                    interrupt()
        run += words(text[place:])
        reading = reading and not exercises
    interrupt()
    return runs, counts


def controls(pages):
    """Controls that can be seen in the article of each built page."""
    from notebook_pages.browser import open_browser

    found = {}
    with open_browser() as browser:
        page = browser.new_page(viewport={"width": 1300, "height": 900})
        for name in pages:
            page.goto((BOOK / "_build" / "html" / f"{name}.html").as_uri())
            page.wait_for_timeout(1500)
            found[name] = page.evaluate(
                "() => [...document.querySelectorAll('.bd-article :is(button, input, select, "
                "summary, [role=slider])')]"
                ".filter((one) => one.checkVisibility({ opacityProperty: true, visibilityProperty: "
                "true })).length"
            )
    return found


def main():
    names = chapters()
    seen = controls(names) if "--pages" in sys.argv else {}
    total = {}
    print(
        "chapter                      words   run  cells figures predict. exercises recap  controls"
    )
    everything = []
    for name in names:
        runs, counts = measure(name)
        everything += runs
        row = [
            sum(runs),
            statistics.median(runs),
            *(counts[kind] for kind in ("cells", "figures", "predictions")),
        ]
        row += [counts["exercises"], counts["questions"], seen.get(name, 0)]
        total = {k: total.get(k, 0) + value for k, value in enumerate(row)}
        print(f"{name[9:]:27}", "".join(f"{value:8.0f}" for value in row))
    total[1] = statistics.median(everything)
    print(f"{'all':27}", "".join(f"{value:8.0f}" for value in total.values()))


if __name__ == "__main__":
    main()
