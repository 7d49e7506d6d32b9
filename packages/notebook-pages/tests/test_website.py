"""The build refuses a faulty book: tiny books, each with one fault."""

import json
import os
import re
import shutil
import stat
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import nbformat
import pytest
import yaml
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook

from notebook_pages import build as book
from notebook_pages import paths, unchanged
from notebook_pages.paths import NODE, NODE_MODULES, WEBSITE, fingerprint, let_everybody_read
from notebook_pages.serve import Handler

FIGURE = '''
class Figure:
    def __repr__(self):
        return "a figure"
    def _repr_html_(self):
        return """<figure><svg viewBox="0 0 9 9" {}><path d="M0 0h9"/></svg></figure>"""
Figure()'''
# A text of four words is long enough, and one of three is not.
GOOD_FIGURE = FIGURE.format('role="img" aria-label="A line going right"')
PLOT = """
import matplotlib.pyplot as plt
plt.plot([1, 2])
plt.show()"""

GOOD_TEXT = r"""
(chapter-one)=
# A chapter

:::{admonition} Learning objectives
:class: objectives
- Know ${}^A\mathbf{C}^N$.
:::

```{math}
:label: eq-first
{}^A\mathbf{C}^N = \begin{bmatrix} \cos\theta & \sin\theta \\ -\sin\theta & \cos\theta \end{bmatrix}
```

See {eq}`eq-first`, {numref}`fig-line`, {ref}`exercise-one` and {ref}`chapter-one`.

$$ a = b $$ (eq-second)

| a | b |
|---|---|
| $x^2$ | `code` |

1. first
   - nested *point*

> Quoted

```{exercise} Try
:label: exercise-one
:difficulty: 2
:minutes: 15

Do it.
```

```{predict}
:label: predict-one
:answer: B
Which?

$x$
: It is *not* this one.

$y$
: This one.
```

````{recap}
```{question}
:label: question-one
:number: 0.5
:tolerance: 0.01
How much?

0.5
: Half.

anything else
: Think of a half.
```
````
"""


def build(folder, chapters, **changed):
    """Build a book of ``chapters``, cells by file name, with a small book's settings
    but for some that are ``changed``.

    Returns the exit code and the words.
    """
    settings = yaml.safe_load(
        (Path(__file__).with_name("small-book") / "_config.yml").read_text("utf8")
    )
    settings["sphinx"]["config"] |= changed
    (folder / "_config.yml").write_text(json.dumps(settings))
    contents = {
        "format": "jb-book",
        "root": "index",
        "parts": [
            {"caption": "Part", "numbered": True, "chapters": [{"file": name} for name in chapters]}
        ],
    }
    (folder / "_toc.yml").write_text(json.dumps(contents))
    (folder / "index.md").write_text("# Front\n\nWords.\n")
    kernel = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}
    for name, cells in chapters.items():
        nbformat.write(new_notebook(cells=cells, metadata=kernel), folder / f"{name}.ipynb")
    jupyter_book = Path(sys.executable).with_name("jupyter-book")
    done = subprocess.run(
        [jupyter_book, "build", folder, "-q", "-W", "-n", "--keep-going"],
        cwd=folder,
        env=os.environ | {"NO_COLOR": "1", "NOTEBOOK_PAGES_FETCHED": str(paths.FETCHED)},
        capture_output=True,
        text=True,
    )
    return done.returncode, done.stdout + done.stderr


def chapter(text=GOOD_TEXT, code=GOOD_FIGURE, metadata=None):
    figure = {"figure": {"name": "fig-line", "caption": "A *line*, as in {eq}`eq-second`."}}
    cell = new_code_cell(code.strip(), metadata={"mystnb": figure | (metadata or {})})
    return [new_markdown_cell(text), cell]


ALTERNATIVE = "A straight line that rises from one to two."


@pytest.mark.long  # every other test of pages has a good book
def test_good_book(tmp_path):
    plot = chapter(code=PLOT, metadata={"image": {"alt": ALTERNATIVE}})
    code, words = build(tmp_path, {"chapter": chapter(), "plot": own_labels(plot, "plot")})
    assert code == 0, words
    html = (tmp_path / "_build/html/chapter.html").read_text("utf8")
    assert "Figure 1.1" in html and "(1.1)" in html and "Exercise 1.1" in html
    assert ALTERNATIVE in (tmp_path / "_build/html/plot.html").read_text("utf8")
    assert "<span class=katex " in html and "<math" in html
    assert "mathjax@" not in html.lower() and "thebe" not in html.lower()
    markdown = nbformat.read(tmp_path / "_build/html/take-away/chapter.ipynb", as_version=4)
    text = "\n\n".join(cell.source for cell in markdown.cells if cell.cell_type == "markdown")
    for expected in (
        "# 1. A chapter",
        "> **Learning objectives**\n>\n> - Know ${}^A\\mathbf{C}^N$.",
        "\\end{bmatrix} \\tag{1.1}\n$$",
        "See (1.1), Figure 1.1, Exercise 1.1 and A chapter.",
        "$$\na = b \\tag{1.2}\n$$",
        "| a | b |\n| --- | --- |\n| $x^2$ | `code` |",
        "1. first\n\n   - nested *point*",
        "> Quoted",
        "> **Exercise 1.1 (Try)**\n>\n> Difficulty 2 of 3, about 15 minutes\n>\n> Do it.",
        "> **Predict, then see (1)**\n>\n> Which?\n>\n> - **A.** $x$\n> - **B.** $y$",
        "> **Recap**\n>\n> **Question 1.**\n>\n> How much?",
        "## Answers to the predictions and the recap\n\n**Prediction 1.**\n\n"
        "- **A**, not so: It is *not* this one.\n- **B**, right: This one.\n\n"
        "**Question 1.**\n\n- **0.5**, right: Half.",
        "**Figure 1.1.** A *line*, as in (1.2).",
    ):
        assert expected in text, text


# The cells of a chapter, and the words of each of its faults: those of its text, then of its code.
FAULTS = {
    "TeX is wrong and a cell fails": (
        chapter(
            GOOD_TEXT.replace("Quoted", r"Bad $\frac{a$ here").replace("a = b", r"a = \nosuch b"),
            "1 / 0",
        ),
        "tex-is-wrong-and-a-cell-fails.ipynb:26 (cell 1): WARNING: bad TeX",
        "Undefined control sequence",
        "ZeroDivisionError",
    ),
    "what it names is not there and a cell warns": (
        chapter(
            GOOD_TEXT + "\n{numref}`fig-nowhere`, {eq}`eq-nowhere`, {ref}`section-nowhere`, "
            "[it](#link-nowhere) and a {term}`thing`.\n",
            "import warnings\nwarnings.warn('old')\n" + GOOD_FIGURE,
        ),
        "fig-nowhere",
        "eq-nowhere",
        "section-nowhere",
        "link-nowhere",
        "thing",
        "stderr",
    ),
    "a question has no replies and a figure says nothing": (
        chapter(GOOD_TEXT.replace("\n: ", "\n"), FIGURE.format("")),
        "must end with its choices",
        "no alternative text",
    ),
    "no choice is right, a number has no other and a figure says too little": (
        chapter(
            GOOD_TEXT.replace(":answer: B", ":answer: C").replace("anything else", "0.7"),
            FIGURE.format('role="img" aria-label="a thin line"'),
        ),
        "the right answer is C",
        "for `anything else`",
        "found 'a thin line'",
    ),
    "a question has no label, an exercise is too hard and a plot says nothing": (
        chapter(
            GOOD_TEXT.replace(":label: predict-one\n", "").replace(
                "difficulty: 2", "difficulty: 4"
            ),
            PLOT,
        ),
        "needs a `:label:`",
        "from 1 to 3",
        "no alternative text",
    ),
}
LABELS = (
    "chapter-one",
    "eq-first",
    "eq-second",
    "exercise-one",
    "fig-line",
    "predict-one",
    "question-one",
)


def file_name(fault):
    return fault.lower().replace(",", "").replace(" ", "-")


def own_labels(cells, name):
    """The same cells with labels that no other chapter has."""
    text = json.dumps(cells)
    for label in LABELS:
        text = text.replace(label, f"{label}-{name}")
    return nbformat.from_dict(json.loads(text))


@pytest.fixture(scope="module")
def faulty_book(tmp_path_factory, take_compiled_wheels):
    """One book with a chapter for each fault: the exit code, and
    the warnings, each with its lines.
    """
    chapters = {
        file_name(fault): own_labels(cells, file_name(fault))
        for fault, (cells, *_) in FAULTS.items()
    }
    folder = tmp_path_factory.mktemp("faulty")
    take_compiled_wheels(folder)
    code, words = build(folder, chapters | {"good": own_labels(chapter(), "good")})
    return code, re.split(
        r"^(?=\S+?\.(?:ipynb|md)\S*(?: \(cell \d+\))?: )", words, flags=re.MULTILINE
    )


@pytest.mark.parametrize("fault", FAULTS)
def test_faulty_book(faulty_book, fault):
    code, warnings = faulty_book
    assert code != 0
    own = [
        warning
        for warning in warnings
        if f"/{file_name(fault)}.ipynb" in warning.partition(": ")[0]
    ]
    assert own, warnings
    assert all("WARNING" in warning or "ERROR" in warning for warning in own), own
    own = [warning.replace("\n", " ") for warning in own]
    for words in FAULTS[fault][1:]:
        assert any(words in warning for warning in own), (words, own)


def test_nothing_is_said_of_a_good_chapter_among_faulty_ones(faulty_book):
    assert [
        warning for warning in faulty_book[1] if "/good.ipynb" in warning.partition(": ")[0]
    ] == []


def test_fingerprint_follows_every_file(tmp_path):
    (tmp_path / "inner").mkdir()
    file = tmp_path / "inner" / "module.py"
    file.write_text("a = 1")
    before = fingerprint(tmp_path)
    assert fingerprint(tmp_path) == before
    file.write_text("a = 2")
    changed = fingerprint(tmp_path)
    assert changed != before
    file.rename(tmp_path / "inner" / "other.py")
    assert fingerprint(tmp_path) not in (before, changed)


def test_modules_are_served_as_javascript():
    assert Handler.extensions_map[".mjs"] == "text/javascript"


def test_formulas_are_set_by_one_process_which_is_missed_when_it_ends():
    from notebook_pages import mathematics

    katex = mathematics.KaTeX()
    assert "<math" in katex(r"\hat{a}_x", False, "1.15")["html"]
    assert "Undefined control sequence" in katex(r"\nonsense", True, "1.15")["fault"]
    assert 'class="katex-display"' in katex(r"\frac{1}{2}\text{ä}", True, "1.6")["html"]
    katex.process.kill()
    katex.process.wait()
    with pytest.raises(RuntimeError, match=r"KaTeX ended with code -9 .* at the formula \\theta"):
        katex(r"\theta", False, "1.15")
    katex.close()


@pytest.mark.long
def test_python_for_browsers_finds_itself_in_any_folder(tmp_path):
    """Left to itself it reads the trace of an error, and takes brackets for the place of a line."""
    folder = tmp_path / "book (2)"
    shutil.copytree(NODE_MODULES / "pyodide", folder / "pyodide")
    (folder / "program.py").write_text(
        "import sys; open('/wheels/made', 'w').write(sys.platform)", "utf8"
    )
    command = [
        NODE,
        WEBSITE / "live" / "compile.mjs",
        folder / "pyodide" / "pyodide.mjs",
        folder / "program.py",
        folder,
    ]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert (folder / "made").read_text() == "emscripten"


def test_whoever_builds_it_a_server_can_read_the_site(tmp_path):
    mask = os.umask(0o077)
    try:
        (tmp_path / "html" / "chapters").mkdir(parents=True)
        (tmp_path / "html" / "chapters" / "one.html").write_text("one", "utf8")
    finally:
        os.umask(mask)
    let_everybody_read(tmp_path / "html")
    for path in (tmp_path / "html", *(tmp_path / "html").rglob("*")):
        assert stat.S_IMODE(path.stat().st_mode) == (0o755 if path.is_dir() else 0o644)


def test_what_has_not_changed_is_not_built_again(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(unchanged, "REPOSITORY", tmp_path)
    for name in (
        "chapters/one.md",
        "src/orientation/a.py",
        ".venv/ready-book",
        "_build/html/one.html",
        "tests/test_a.py",
    ):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("one", "utf8")

    def is_unchanged():
        return unchanged.is_unchanged(unchanged.of_sources())

    def note():
        unchanged.note(unchanged.of_sources())

    assert not is_unchanged()
    note()
    assert is_unchanged()
    for name in (
        "tests/test_a.py",
        "_build/jupyter_cache/one",
        ".git/index",
        "src/orientation/__pycache__/a.pyc",
    ):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("another", "utf8")
        assert is_unchanged(), name
    for name in (
        "chapters/one.md",
        "chapters/two.md",
        "src/orientation/a.py",
        ".venv/ready-book",
        "references.bib",
    ):
        (tmp_path / name).write_text("another", "utf8")
        assert not is_unchanged(), name
        note()
    (tmp_path / "_build" / "html" / "one.html").unlink()
    assert not is_unchanged(), "a page has gone"
    note()
    begun = unchanged.of_sources()
    (tmp_path / "references.bib").write_text("saved while the pages are made", "utf8")
    unchanged.note(begun)
    assert not is_unchanged(), "the pages do not hold it yet"
    note()
    monkeypatch.setenv("BOOK_EXAM", "1")
    assert not is_unchanged(), "another edition is asked for"


def test_a_build_with_nothing_to_do_starts_nothing(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(unchanged, "REPOSITORY", tmp_path)
    monkeypatch.setattr(book, "what_prevents_building", lambda: None)
    (tmp_path / "_build").mkdir()
    unchanged.note(unchanged.of_sources())
    monkeypatch.setattr(book, "make_pages", None)  # whatever it would build fails
    book.main()
    assert "Nothing has changed" in capsys.readouterr().out
    # Nor does it load what only a build needs: that takes longer than to look.
    subprocess.run(
        [
            sys.executable,
            "-c",
            "import sys, notebook_pages.build; sys.exit('sphinx' in sys.modules)",
        ],
        check=True,
    )


@pytest.mark.parametrize("end", [SystemExit(1), RuntimeError("There was an error in building")])
def test_of_a_faulty_build_nothing_is_left(tmp_path, monkeypatch, end):
    def build(*arguments, **settings):
        raise end

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(unchanged, "REPOSITORY", tmp_path)
    monkeypatch.setattr(book, "what_prevents_building", lambda: None)
    monkeypatch.setitem(sys.modules, "jupyter_book.cli.main", SimpleNamespace(main=build))
    (tmp_path / "_build" / "html").mkdir(parents=True)
    with pytest.raises(SystemExit, match="could not be built"):
        book.main()
    assert not (tmp_path / "_build" / "html").exists()
