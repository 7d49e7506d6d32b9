"""An author's own course becomes a site with one command, and its pages check answers."""

import os
import re
import subprocess
import sys
import threading
import zipfile

import nbformat
import pytest
from test_live import ELSEWHERE

from coursework.authoring import publish
from coursework.authoring.author import AuthorError
from coursework.authoring.course import find_course
from notebook_pages import course as pages
from notebook_pages.serve import server

PAGE = "exercises/first-steps"


def run(folder, *arguments):
    done = subprocess.run(
        [sys.executable, "-m", "coursework", *arguments],
        cwd=folder, env=os.environ | {"NO_COLOR": "1"}, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]


pytestmark = pytest.mark.long  # this builds a whole site


@pytest.fixture(scope="module")
def course(tmp_path_factory):
    folder = tmp_path_factory.mktemp("courses")
    run(folder, "new", "my-statics")
    run(folder / "my-statics", "publish")
    return folder / "my-statics"


def test_the_site_holds_all_tells_nothing_and_checks_answers(course, browser):
    site = course / "build" / "site"
    front, page = ((site / f"{name}.html").read_text("utf8") for name in ("index", PAGE))
    assert "My statics" in front and 'href="exercises/first-steps.html"' in front
    assert "<h1>" in page and not re.search(r'<(script|link)[^>]+(src|href)="https?:', page)
    with zipfile.ZipFile(site / "take-away" / "exercises.zip") as box:
        assert "exercises/first-steps.ipynb" in box.namelist()
    assert len(list((site / "take-away").glob("*.whl"))) == 2
    solved = nbformat.read(course / "solutions" / "first-steps.ipynb", as_version=4)
    answers = [
        cell.source.splitlines()[1] for cell in solved.cells if "BEGIN SOLUTION" in cell.source
    ]
    leaks = [
        path
        for path in site.rglob("*.html")
        for answer in answers
        if answer in path.read_text("utf8")
    ]
    assert answers and leaks == []
    # The author decides on the licence of a course, and this one has none.
    assert "CC BY" not in front + page and "orientation" not in (front + page).lower()

    served = server(folder=course / "build" / "site")
    threading.Thread(target=served.serve_forever, daemon=True).start()
    context = browser.new_context(viewport={"width": 1300, "height": 900})
    context.set_default_timeout(60_000)
    elsewhere = []
    context.route(ELSEWHERE, lambda route: (elsewhere.append(route.request.url), route.abort()))
    page = context.new_page()
    try:
        page.goto(f"http://127.0.0.1:{served.server_port}/{PAGE}.html")
        page.wait_for_selector("button.run-cell", state="attached")
        cells = page.locator("div.cell")
        for answer, words in (
            ("area = b * h", "triangle is half of it"),
            ("area = h * b / 2", "Correct"),
        ):
            cells.nth(1).locator("button.run-cell").click() if not cells.nth(1).locator(
                ".cm-content"
            ).count() else None
            page.wait_for_selector(".cm-content", state="attached")
            cells.nth(1).locator(".cm-content").focus()
            page.keyboard.press("Control+a")
            page.keyboard.insert_text(answer)
            cells.nth(2).locator("button.run-cell").click()
            page.wait_for_function(
                "words => document.querySelectorAll('div.cell')[2].innerText.includes(words)",
                arg=words,
            )
        assert elsewhere == []
    finally:
        context.close()
        served.shutdown()
        served.server_close()


def test_what_cannot_be_published_is_said(course, tmp_path, monkeypatch):
    course_found = find_course(course)
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(AuthorError, match="is not a site"):
        publish.publish(course_found, tmp_path)
    assert (tmp_path / "mine.txt").read_text() == "mine"
    with pytest.raises(AuthorError, match="coursework release"):
        publish.publish(course_found._replace(exercises=tmp_path), tmp_path / "site")
    monkeypatch.setattr(publish.metadata, "entry_points", lambda **selection: [])
    with pytest.raises(AuthorError, match="notebook-pages"):
        publish.publish(course_found, tmp_path / "site")
    monkeypatch.setenv("NOTEBOOK_PAGES_FETCHED", str(tmp_path))
    with pytest.raises(RuntimeError, match="notebook_pages.set_up"):
        pages.publish({"format": 1}, tmp_path / "book", tmp_path / "site")
    with pytest.raises(ValueError, match="format 2"):
        pages.publish({"format": 2}, tmp_path / "book", tmp_path / "site")
