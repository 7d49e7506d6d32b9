"""Every question of the book, tried as students will try it."""

import re

import pytest
from test_release import CELLS, COURSE, made_in, needs_solutions, write_source

from coursework.__main__ import main
from coursework.authoring import release
from coursework.authoring.attack import BUDGET
from coursework.authoring.author import AuthorError
from coursework.authoring.packing import archive as pack
from coursework.authoring.selftest import _try_notebook, leaks, released_texts, selftest, try_question, write_page

SOURCES = {path.stem: path for path in sorted(COURSE.sources.glob("*.ipynb"))}


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", SOURCES)
def test_every_question_passes_and_names_its_mistakes(name):
    source = release.read_source(SOURCES[name])
    # How hard each is to guess takes long to find, and is tried elsewhere.
    findings = [try_question(question, budget=0) for question in source.questions.values()]
    assert [fault for finding in findings for fault in finding.faults] == []
    assert "<h1>" in write_page(findings, [])
    if name != release.CHAPTERS:
        assert len(findings) >= 4
        assert leaks([source], released_texts(COURSE.exercises, COURSE.sealed, "none")) == []


@needs_solutions
@pytest.mark.long
@pytest.mark.parametrize("name", SOURCES)
def test_no_variant_at_all_is_guessed_sooner_than_its_author_declared(name, monkeypatch):
    """The self-test attacks three variants of each question."""
    monkeypatch.setattr("coursework.authoring.selftest.ATTACKED", 99)
    findings, _ = _try_notebook(SOURCES[name], COURSE, BUDGET)
    assert [f"{finding.name}: {fault}" for finding in findings for fault in finding.faults] == []


@needs_solutions
@pytest.mark.long
def test_nothing_leaks_into_the_archive(tmp_path):
    archive = pack(COURSE, tmp_path / "exercises.zip")
    sources = [release.read_source(path) for path in SOURCES.values()]
    assert leaks(sources, released_texts(COURSE.exercises, COURSE.sealed, archive)) == []


def test_nothing_to_try_is_not_a_pass(tmp_path):
    with pytest.raises(SystemExit, match="no notebook with solutions in .*empty"):
        main(["selftest", "--sources", str(tmp_path / "empty"), "--page", str(tmp_path / "page.html")])
    write_source(tmp_path / "text", ("markdown", "# Nothing is asked here"))
    with pytest.raises(SystemExit, match="ask no question"):
        main(["selftest", "--sources", str(tmp_path / "text"), "--page", str(tmp_path / "page.html")])
    assert not (tmp_path / "page.html").exists()


def test_a_question_with_a_fault_is_found(tmp_path):
    cells = [
        (kind, text.replace("worth=2,", "worth=2, mistakes={'A wrong remark.': A_C_N},"), *tags)
        for kind, text, *tags in CELLS
    ]
    write_source(tmp_path, *cells)
    faults = selftest(made_in(tmp_path, sources=tmp_path), tmp_path / "page.html", budget=50)
    assert any("gives the right answer" in fault for fault in faults)
    assert "gives the right answer" in (tmp_path / "page.html").read_text("utf8")


def test_a_variant_that_is_guessed_sooner_than_the_first_is_found(tmp_path):
    made = made_in(tmp_path)
    write_source(
        made.sources,
        ("markdown", "# Levers"),
        ("code", "from coursework import check, me, variant\nme('')"),
        (
            "code",
            "### BEGIN VARIANTS\nlever = draw('levers/arm', count=3, arm=[0.7391234, 1, 2])\n### END VARIANTS",
        ),
        ("markdown", "How long is the arm?"),
        ("code", "### BEGIN SOLUTION\narm = lever.arm\n### END SOLUTION"),
        (
            "code",
            "check('levers/arm', arm)\n### BEGIN HIDDEN TESTS\nquestion('levers/arm', kind='expression')\n"
            "### END HIDDEN TESTS",
        ),
        name="levers",
    )
    release.release(made, run=False)
    faults = selftest(made, None, budget=100)
    assert len(faults) == 1 and "levers/arm: One of its variants can be guessed: found after" in faults[0]
    (made.sources / "guessable.json").write_text('{"levers/arm": 1}')
    assert selftest(made, None, budget=100) == []


def test_what_can_be_guessed_carries_one_point_at_most(tmp_path):
    made = made_in(tmp_path)
    write_source(made.sources, *CELLS)
    release.release(made, run=False)
    (made.sources / "guessable.json").write_text('{"trial/about-x": 20}')
    heavy = "trial/about-x.*guessable.json says that it can be guessed, after 20 tries, and it is worth 2 points; 1 is"
    with pytest.raises(AuthorError, match=heavy.replace(".*", ", in trial.ipynb: ")):
        release.release(made, run=False)
    assert [fault for fault in selftest(made, None, budget=10) if re.search(heavy, fault)]
    write_source(made.sources, *((kind, text.replace("worth=2", "worth=1"), *tags) for kind, text, *tags in CELLS))
    release.release(made, run=False)
    assert not any("points" in fault for fault in selftest(made, None, budget=10))
