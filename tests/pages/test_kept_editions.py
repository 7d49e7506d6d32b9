"""The book that a browser keeps is always one whole edition, whatever the network does."""

import shutil
import time

import pytest
from engines import ENGINES, PATIENCE, Chromium
from small_book import (
    IS_CONTROLLED,
    KEEP,
    NEWEST,
    PAGES,
    RESTS,
    SHOWN,
    TOLD,
    listed,
    network,
    scripts_of,
    write_edition,
)

KINDS = [
    "Chromium",
    pytest.param("Firefox", marks=pytest.mark.long),
    pytest.param("WebKit", marks=pytest.mark.long),
]


@pytest.fixture(scope="module", params=KINDS)
def engine(request):
    made = (
        Chromium(request.getfixturevalue("browser"))
        if request.param == "Chromium"
        else ENGINES[request.param]()
    )
    yield made
    made.close()


@pytest.fixture(scope="module")
def parts(tmp_path_factory):
    """The files that all editions share, made once."""
    folder = tmp_path_factory.mktemp("parts")
    write_edition(folder, 0)
    for path in folder.rglob("*.html"):
        path.unlink()
    shutil.rmtree(folder / "runtime" / "wheels")
    return folder


@pytest.fixture
def editions(tmp_path, parts):
    """Return a function from the number of an edition to its folder."""

    def folder(number):
        place = tmp_path / str(number)
        if not place.exists():
            write_edition(place, number, parts)
        return place

    return folder


def keep(engine, address, folder, choice="The pages"):
    engine.go(f"{address}index.html")
    words = engine.run(KEEP, scripts_of(folder), choice)
    engine.wait(IS_CONTROLLED)
    return words


def shown(engine, address):
    """Return the edition that the pages show; fail if they are of different editions."""
    editions_shown = {}
    for name in PAGES:
        engine.go(f"{address}{name}.html")
        parts = engine.run(SHOWN)
        assert len(set(parts)) == 1, f"{name} shows the parts of several editions: {parts}"
        editions_shown[name] = int(parts[0])
    assert editions_shown.pop("appendix/three") == 0
    assert len(set(editions_shown.values())) == 1, f"pages of several editions: {editions_shown}"
    return set(editions_shown.values()).pop()


def renew(engine, address, folder):
    """Open a page until the newest edition is that of ``folder``.

    While one check of the network is running, no other begins.
    """
    newest, end = listed(folder)["edition"], time.monotonic() + PATIENCE
    while engine.run(NEWEST) != newest:
        assert time.monotonic() < end, f"the edition of {folder} does not become the newest"
        engine.go(f"{address}index.html")
        engine.wait(RESTS)


def test_renewal_that_breaks_off_anywhere_leaves_the_edition_before_it(engine, editions):
    """Cut the network after every fourth request in turn: the next edition is whole."""
    with network(editions(1)) as (net, address):
        assert "is stored" in keep(engine, address, editions(1))
        newest, cut, whole = 1, 0, False
        while not whole:
            net.folder, net.left, net.refused = str(editions(newest + 1)), cut, 0
            net.broken = ("cut", "half", "busy")[cut % 3]
            engine.go(f"{address}chapters/one.html")
            engine.wait(RESTS)
            whole = not net.refused  # so many requests were enough
            net.left = 0
            assert shown(engine, address) == newest + whole, f"cut after {cut} requests"
            net.left = None
            renew(engine, address, editions(newest + 1))
            newest, cut = newest + 1, cut + 4
            net.left = 0
            assert shown(engine, address) == newest, f"after a cut after {cut - 4} requests"
        assert cut > 6, "the list, three pages, a style and a script are fetched one by one"


def test_open_tab_is_told_what_has_changed_and_still_has_its_own_edition(engine, editions):
    with network(editions(1)) as (net, address):
        keep(engine, address, editions(1))
        engine.go(f"{address}chapters/two.html")
        (mine,) = (editions(1) / "runtime" / "wheels").iterdir()
        net.folder = str(editions(2))
        # Another tab opens a page; the response to a frame is a navigation, too.
        engine.run(
            """() => new Promise((come) => {
              const frame = Object.assign(document.createElement("iframe"), { src: "/index.html", onload: come });
              navigator.serviceWorker.addEventListener("message", ({ data }) => (window.told = data.edition));
              document.body.append(frame);
            })"""
        )
        assert engine.wait("() => window.told") == listed(editions(2))["edition"]
        words = engine.run(TOLD, scripts_of(editions(1)))
        assert "“chapters/two”" in words and "What stays" not in words
        net.left = 0
        asked = (
            f"() => import('/{mine.relative_to(editions(1))}/lasting.js').then((module) => "
            "module.default)"
        )
        assert engine.run(asked) == 1
        assert shown(engine, address) == 2


def test_kept_pages_leave_neighbours_alone_open_on_bad_networks_and_can_be_forgotten(
    engine, editions
):
    with network(editions(1)) as (net, address):
        keep(engine, address, editions(1))
        neighbour = editions(1) / "other-course" / "page.html"
        neighbour.parent.mkdir()
        neighbour.write_text("<!DOCTYPE html><title>Another course</title>")
        header = "async (path) => (await fetch(path)).headers.get('Cross-Origin-Embedder-Policy')"
        assert engine.run(header, "/chapters/one.html") == "require-corp"
        assert engine.run(header, "/other-course/page.html") is None
        engine.go(f"{address}other-course/page.html")
        assert engine.run("() => window.crossOriginIsolated") is False
        for broken in ("busy", "hangs"):
            net.left, net.broken = 0, broken
            assert shown(engine, address) == 1
        net.left = None
        net.held.set()
        engine.go(f"{address}index.html")
        assert "no longer stored" in engine.run(KEEP, scripts_of(editions(1)), "Forget")
        assert engine.run("() => caches.has('book /')") is False
