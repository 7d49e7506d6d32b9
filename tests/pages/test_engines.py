"""Live cells in Firefox and WebKit: their results are those that the book prints."""

import pytest
from engines import ENGINES
from test_live import PAGES, PLAYABLE, QUIET, RESULTS, all_shown, kinds
from test_servers import SIZE
from test_site import stand_as_katex_sets_them

from notebook_pages.execution import STORED
from notebook_pages.lighten import in_short

RUN_ALL = "() => document.querySelector('button.run-page').click()"
IS_DONE = (
    "() => !document.querySelector('div.cell.running, div.cell.waiting, html.live-busy') && "
    "/ran\\.|already there|could not|rror/.test(document.querySelector('#live-words')?.textContent "
    "?? "
    "'') && document.querySelector('#live-words').textContent"
)


@pytest.fixture(scope="module", params=ENGINES)
def engine(request):
    made = ENGINES[request.param]()
    yield made
    made.close()


def compare(engine, site, name):
    """Run the page, and compare each cell that needs no download with the printed result.

    Returns the number of cells.
    """
    engine.go(site + name)
    engine.run("() => { localStorage.clear(); sessionStorage.clear(); }")
    before = all_shown(engine.run(RESULTS))
    engine.run(RUN_ALL)
    words = engine.wait(IS_DONE)
    assert "ran." in words or "already there" in words, words
    engine.wait(PLAYABLE)
    after = list(map(in_short, engine.run(RESULTS)))
    compared = 0
    for number, kind in enumerate(kinds(name), start=1):
        if not kind["needs"]:
            assert after[number - 1] == before[number - 1], f"{name}, cell {number}"
            compared += 1
    return compared


# As in Chromium (test_live.py).
CHAPTERS = [name for name in PAGES if not name.startswith(STORED)]


@pytest.mark.long
@pytest.mark.sampled(2)  # one in each engine
@pytest.mark.parametrize("name", CHAPTERS)
def test_results_equal_the_stored_ones(engine, site, name):
    compare(engine, site, name)


@pytest.mark.long
def test_stop_keeps_the_names(engine, site):
    """In a page that the server isolates, Python can be interrupted, and its variables remain."""
    engine.go(site + QUIET)
    assert compare(engine, site, QUIET) > 3
    assert engine.run("() => crossOriginIsolated")
    write = """(code) => {
      const cell = document.querySelectorAll('div.cell')[2];
      const content = cell.querySelector('.cm-content');
      const editor = content.cmTile?.view ?? content.cmView.view;
      editor.dispatch({ changes: { from: 0, to: editor.state.doc.length, insert: code } });
      cell.querySelector('button.run-cell').click();
    }"""
    below = "() => document.querySelectorAll('div.cell')[2].querySelector('.cell_output').innerText"
    engine.run(write, "kept = 'kept'\nprint('begun')\nwhile True:\n    pass")
    engine.wait(f"() => ({below})().includes('begun')")
    engine.run(
        "() => [...document.querySelectorAll('.live-bar button')].find((b) => b.textContent === "
        "'Stop').click()"
    )
    engine.wait(f"() => ({below})().includes('still there')")
    engine.run(write, "print(kept * 2)")
    engine.wait(f"() => ({below})().includes('keptkept')")


def test_page_opens_and_is_read(engine, site):
    """Check one page each day: its formulas, its typefaces, and its buttons."""
    engine.go(site + "index.html")
    # WebKit rounds the heights of lines to pixels, and moves their content.
    stand_as_katex_sets_them(engine.run, within=2)
    # Otherwise, after a download of Python, its size is not shown.
    engine.run("() => localStorage.clear()")
    engine.go(site + QUIET)
    engine.wait("() => !document.documentElement.matches('.settling, .in-parts')")
    seen = engine.run("""() => ({
      formulas: document.querySelectorAll('.katex math').length,
      font: document.fonts.check('1em KaTeX_Main') && document.fonts.check('1em "Source Serif 4"'),
      sideways: document.documentElement.scrollWidth - document.documentElement.clientWidth,
      buttons: document.querySelectorAll('button.run-cell').length,
      size: document.querySelector('button.run-page').dataset.size,
    })""")
    assert (
        seen["formulas"] > 20
        and seen["font"]
        and seen["sideways"] <= 0
        and seen["buttons"] == len(kinds(QUIET))
    )
    assert seen["size"] == SIZE
