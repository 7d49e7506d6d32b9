"""A notebook with solutions: what its author wrote between nbgrader's marks, and its results.

``### BEGIN SOLUTION`` and ``### BEGIN HIDDEN TESTS`` mark what students do not get.
"""

from __future__ import annotations

import ast
import base64
import contextlib
import functools
import hashlib
import html
import io
import itertools
import json
import mimetypes
import multiprocessing
import os
import re
import sys
import textwrap
import urllib.parse
from collections.abc import Callable, Collection, Iterable, Mapping, Sized
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple
from unittest import mock

import coursework
from coursework.checking.plugins import folders_of, packages
from coursework.checking.question import Variant
from coursework.checking.variants import Given, image, names_of_variants, packed, shown

from . import author
from .course import gives_by_name
from .packing import VERSION
from .variation import COUNT, VARIANTS, Pool, Rule, drawn_in, written

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from nbformat import NotebookNode

#: The source of the questions inside the chapters, for which only a sealed file is made.
CHAPTERS = "chapters"
#: The subpackages whose code determines a question's seals.
ROOMS = ("authoring", "checking")
#: The most decimal places of a number that students see; more come from rounding errors.
MOST_PLACES = 10
#: Rounded values of pi, which are right to some digits only, so an answer would be, too.
PI_ROUNDED = re.compile(r"(?<![\w.])3\.14(?:1(?:5(?:9\d{0,9})?|6)?)?(?![\w.])")
#: A picture in Markdown, whose file is beside the notebook or attached to the cell.
# An author who wants a picture of a certain width writes HTML.
HTML_PICTURE = re.compile(
    r"""(?P<before><img\b[^>]*?\bsrc=(?P<quote>["']))(?!https?:|data:)(?P<name>.+?)(?=(?P=quote))"""
)
PICTURE = re.compile(r"!\[(?P<alt>[^\]]*)\]\((?!https?:|data:)(?P<name>[^)\s]+)[^)]*\)")
#: The most characters of a parameter that counts as a word; a longer one is part of the text.
LONGEST_WORD = 40
SOLUTION = re.compile(
    r"^[ \t]*### BEGIN SOLUTION[ \t]*\n(.*?)^[ \t]*### END SOLUTION[ \t]*\n?", re.M | re.S
)
HIDDEN = re.compile(
    r"^[ \t]*### BEGIN HIDDEN TESTS[ \t]*\n.*?^[ \t]*### END HIDDEN TESTS[ \t]*\n?", re.M | re.S
)
#: The names in marks, and a pattern for every line that was meant as a mark.
MARKED = ("SOLUTION", "HIDDEN TESTS", "VARIANTS")
#: A line that only Jupyter understands: a magic, a command for the shell, or a request for help.
OF_JUPYTER = re.compile(r"[%!?]|.*\?$|.*=\s*[%!]")
MARK = re.compile(r"[ \t]*#+[ \t]*(BEGIN|END)[ \t]+((?:SOLUTION|HIDDEN|VARIANT).*)", re.I)


class Drawing(NamedTuple):
    """A Matplotlib plot as the figure of a question: ``drawing(figure, alt)`` in a source.

    Attributes
    ----------
    figure : matplotlib.figure.Figure
    alt : str
        A description for readers who cannot see it.
    """

    figure: Figure
    alt: str

    def picture(self) -> str:
        """Return the plot as SVG, always the same, with letters as outlines that need no font."""
        import matplotlib

        text = io.StringIO()
        with matplotlib.rc_context({"svg.hashsalt": "coursework", "svg.fonttype": "path"}):
            self.figure.savefig(
                text, format="svg", bbox_inches="tight", metadata={"Date": None, "Creator": None}
            )
        return re.sub(r"^.*?(?=<svg)", "", text.getvalue(), flags=re.S)


class Source(NamedTuple):
    """A notebook with solutions, after its cells were run."""

    name: str
    notebook: NotebookNode
    questions: dict[str, author.AuthoredQuestion]
    figures: dict[int, Drawing]
    rules: dict[str, Rule]
    asks_who: bool


def notebooks_in(folder: str | Path, only: Collection[str] = ()) -> list[Path]:
    """Return the notebooks with solutions in a folder, or the ones given by name.

    Raises
    ------
    AuthorError
        There are none, or a name does not exist.
    """
    notebooks = sorted(Path(folder).glob("*.ipynb"))
    if not notebooks:
        raise author.AuthorError(
            f"There is no notebook with solutions in {folder}. If you keep the solutions in a "
            "private repository, fetch them first. Without them you can neither release nor "
            "grade."
        )
    unknown = sorted(set(only) - {path.stem for path in notebooks})
    if unknown:
        raise author.AuthorError(
            f"{folder} has no {unknown[0]}.ipynb; choose from "
            f"{', '.join(path.stem for path in notebooks)}."
        )
    return [path for path in notebooks if not only or path.stem in only]


def processes_for(paths: Collection[Path]) -> ProcessPoolExecutor:
    """Return a pool of processes to share the notebooks.

    On Linux they are forked, as was Python's default before 3.14, so they have this process's
    plug-ins and settings.
    """
    context = multiprocessing.get_context("fork" if sys.platform == "linux" else None)
    return ProcessPoolExecutor(min(len(paths), os.cpu_count() or 1), context)


@functools.cache
def digest_of_code() -> str:
    """Return a digest of the code that reads and seals questions, ours and that of plug-ins."""
    digest = hashlib.sha256()
    for folder in [
        *(Path(coursework.__file__).parent / room for room in ROOMS),
        *map(Path, folders_of(packages())),
    ]:
        for path in sorted(folder.rglob("*.py")):
            # A new version number alone is no reason to test everything again.
            digest.update(path.name.encode() + VERSION.sub("", path.read_text("utf8")).encode())
    return digest.hexdigest()


def names_asked(path: str | Path) -> dict[str, str]:
    """Return the names of a source's questions, and the variable of each, without running it."""
    return checked_in(
        "".join(cell["source"]) for cell in cells_of(path) if cell["cell_type"] == "code"
    )


def cells_of(path: str | Path) -> list[dict[str, Any]]:
    """Return the cells of a notebook with solutions, as they are in its file.

    Raises
    ------
    AuthorError
        It is not a notebook, for example after a merge with conflicts, or a cell is not Python.
    """
    # Avoid nbformat, which takes a second to import, since this runs at each start.
    try:
        cells: list[dict[str, Any]] = list(json.loads(Path(path).read_text("utf8"))["cells"])
    except (ValueError, LookupError, TypeError) as error:
        raise author.AuthorError(
            f"{path} is not a notebook that we can read ({error}). Restore it, or delete it."
        ) from None
    for number, cell in enumerate(cells):
        try:
            ast.parse("".join(cell["source"]) if cell["cell_type"] == "code" else "")
        except SyntaxError as error:
            line = (error.text or "").strip()
            raise author.AuthorError(
                f"{Path(path).name}, cell {number}, line {error.lineno}: `{line}` is not Python"
                + (
                    ". It works only in Jupyter, but students can answer on other pages, too. "
                    "Delete it, or write it in Python."
                    if OF_JUPYTER.match(line)
                    else f" ({error.msg})."
                )
            ) from None
    return cells


def files_of(path: Path) -> dict[str, bytes]:
    """Return a source and the files below its folder that its cells name or may import, by name."""
    # In the JSON of a notebook, a backslash may precede a quotation mark.
    strings = re.findall(r"['\"]([^'\"\\\n]{1,200})\\?(?=['\"])", path.read_text("utf8"))
    return {
        name: place.read_bytes()
        for name in dict.fromkeys(
            [path.name, *sorted([*strings, *(module.name for module in path.parent.glob("*.py"))])]
        )
        if not name.startswith(("/", "../")) and (place := path.parent / name).is_file()
    }


def read_source(
    path: str | Path,
    variant: int = 0,
    edition: str = "",
    only: Collection[str] | None = None,
    pictures: bool | None = None,
) -> Source:
    """Run a notebook with solutions and return its questions.

    Parameters
    ----------
    path : path
    variant : int
        0 gives all questions in their first variant; another number gives those that have that
        variant.
    edition : str
        The edition of the course, which determines the draws.
    only : collection of str, optional
        The questions to return.
    pictures : bool, optional
        Whether to draw the pictures of variants; by default, if all questions are wanted.

    Raises
    ------
    AuthorError
        A question has no check, a check has no question, or a cell fails.
    """
    import nbformat

    path = Path(path)
    # The error of nbformat would not name the file.
    cells_of(path)
    notebook = nbformat.read(path, as_version=4)
    for number, cell in enumerate(notebook.cells):
        # Windows editors may write this.
        cell.source = cell.source.replace("\r\n", "\n")
        if cell.cell_type == "code":
            _demand_marks(cell.source, f"{path.name}, cell {number}")
        elif cell.cell_type == "markdown":
            cell.source = _with_pictures(cell, path.parent, f"{path.name}, cell {number}")
    recorder = _Recorder(path, notebook, variant, edition, only, pictures)
    figures = _figures_of_run(path, notebook, recorder)
    variables = checked_names(notebook)
    _demand_matched(path, recorder, variables)
    for name, question in recorder.questions.items():
        question.variable = variables[name]
    if only is None and not variant:
        _demand_hidden(path.name, notebook, variables)
        _demand_pi(path.name, notebook)
        _demand_shown(path.name, notebook, recorder)
    return Source(
        path.stem, notebook, recorder.questions, figures, recorder.rules, bool(recorder.identities)
    )


def _with_pictures(cell: NotebookNode, folder: Path, where: str) -> str:
    """Return a cell's text with all pictures in it: those beside the notebook, and pasted ones.

    Students get no other files, and pages do not show what is pasted.
    """
    pasted = cell.pop("attachments", {})

    def address(match: re.Match[str]) -> str:
        name = match["name"]
        kind, path = mimetypes.guess_type(name)[0], folder / urllib.parse.unquote(name)
        data = pasted.get(name.removeprefix("attachment:"), {}).get(kind)
        if not data and not path.is_file():
            raise author.AuthorError(
                f"{where}: there is no picture {path}. In Markdown, write %20 for a space in its "
                "name."
            )
        return f"data:{kind};base64,{data or base64.b64encode(path.read_bytes()).decode('ascii')}"

    return PICTURE.sub(
        lambda match: f'<img alt="{html.escape(match["alt"])}" src="{address(match)}">',
        HTML_PICTURE.sub(lambda match: f"{match['before']}{address(match)}", cell.source),
    )


class _Recorder:
    """A recorder of everything that the cells of a source draw, check and ask while they run.

    Parameters
    ----------
    notebook : NotebookNode
    path, variant, edition, only, pictures
        As for `read_source`.
    """

    def __init__(
        self,
        path: Path,
        notebook: NotebookNode,
        variant: int,
        edition: str,
        only: Collection[str] | None,
        pictures: bool | None,
    ) -> None:
        self.path, self.variant, self.edition, self.only = path, variant, edition, only
        self.with_pictures = only is None if pictures is None else pictures
        self.by_name = gives_by_name(path.parent)
        self.texts = _texts_of_variants(notebook)
        self.answers: dict[str, object] = {}
        self.questions: dict[str, author.AuthoredQuestion] = {}
        self.rules: dict[str, Rule] = {}
        self.given: dict[str, dict[str, Any]] = {}
        self.identities: list[str] = []

    def draw(
        self,
        name: str,
        count: int = COUNT,
        where: Callable[..., object] | None = None,
        picture: Callable[..., Drawing] | None = None,
        **pools: Pool,
    ) -> Given:
        """Draw the parameters of this variant; a question with fewer variants has its first.

        Raises
        ------
        AuthorError
            The call is at the wrong place, or an argument has the wrong form.
        """
        checks = {
            "call `draw` between `### BEGIN VARIANTS` and `### END VARIANTS`, in a cell above the "
            "text of the question": name in self.texts,
            f"`count` must be a whole number, at least 1, not {count!r}": isinstance(count, int)
            and count >= 1,
            **{
                f"give {what} a list of values, or a function such as `lambda chance: "
                f"chance.randint(1, 6)`, not {pool!r}": callable(pool)
                or (isinstance(pool, Sized) and not isinstance(pool, str) and len(pool) > 0)
                for what, pool in pools.items()
            },
        }
        if not all(checks.values()):
            raise author.AuthorError(
                f"{name}: {next(fix for fix, held in checks.items() if not held)}."
            )
        rule = Rule(name, count, pools, where, picture).without_what_is_ruled_out()
        given = rule.parameters(self.variant if self.variant < rule.count else 0, self.edition)
        self.rules[name], self.given[name] = rule, given
        return Given(shown(self.texts[name], written(given)), given)

    def ask(self, name: str, **about: Any) -> None:
        """Record a question, if it is wanted and has this variant."""
        if name not in self.answers:
            raise author.AuthorError(
                f"{name}: call `question` below its check"
                + (f"; checked so far: {', '.join(self.answers)}." if self.answers else ".")
            )
        if name in self.questions:
            raise author.AuthorError(f"{name}: two questions have this name.")
        if name.partition("/")[0] != self.path.stem:
            raise author.AuthorError(
                f"{name}: name each question of this notebook '{self.path.stem}/...'."
            )
        if self.only is not None and name not in self.only:
            return
        if "kind" not in about:
            raise author.AuthorError(f"{name}: give its kind, for example kind='expression'.")
        if name in self.rules and about.get("fixed"):
            raise author.AuthorError(f"{name}: you draw variants for it, so leave out `fixed`.")
        if self.variant < (self.rules[name].count if name in self.rules else 1):
            own = self._own_variant(name) if name in self.rules else None
            self.questions[name] = author.question(
                name, about.pop("kind"), self.answers[name], variant=own, **about
            )

    def _own_variant(self, name: str) -> Variant:
        rule, text, given = self.rules[name], self.texts[name], self.given[name]
        own = variant_drawn(given, text, self.variant, rule.count, self.edition)
        _demand_few_digits(name, own.shown)
        if self.by_name:
            drawn = (rule.parameters(number, self.edition) for number in range(rule.count))
            names = names_of_variants(variant_drawn(parameters, text) for parameters in drawn)
            own = replace(own, names=tuple(names))
        if rule.picture and self.with_pictures:
            drawing = rule.picture(given)
            own = replace(own, picture=packed(drawing.picture(), drawing.alt))
        return own


def _figures_of_run(path: Path, notebook: NotebookNode, recorder: _Recorder) -> dict[int, Drawing]:
    """Run the cells with the recorder's functions; return the figures by the numbers of cells."""
    namespace = {
        "__name__": "__main__",
        "question": recorder.ask,
        "draw": recorder.draw,
        "drawing": Drawing,
    }
    figures: dict[int, Drawing] = {}
    with contextlib.ExitStack() as replaced:
        for name, record in (
            ("check", recorder.answers.__setitem__),
            ("student", lambda identity="": recorder.identities.append(identity)),
        ):
            replaced.enter_context(mock.patch.object(coursework, name, record))
        # As in Jupyter, cells find the data and the modules beside their notebook.
        replaced.enter_context(contextlib.chdir(path.parent))
        replaced.enter_context(mock.patch.object(sys, "path", ["", *sys.path]))
        for number, cell in enumerate(notebook.cells):
            if cell.cell_type != "code":
                continue
            try:
                value = _run(cell.source, namespace, f"{path.name}, cell {number}")
            except author.AuthorError:
                raise
            except Exception as error:
                raise author.AuthorError(
                    f"{path.name}, cell {number}: {type(error).__name__}: {error}"
                ) from error
            if "figure" in cell.metadata.get("tags", []):
                figures[number] = value
    return figures


def _demand_matched(path: Path, recorder: _Recorder, variables: Mapping[str, str]) -> None:
    """Reject checks without a question, and answers of the same name."""
    unasked = sorted(set(recorder.answers) - set(recorder.questions))
    if unasked and not recorder.variant and recorder.only is None:
        raise author.AuthorError(
            f"{path.name}: these checks have no question: {', '.join(unasked)}."
        )
    names = list(variables.values())
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise author.AuthorError(
            f"{path.name}: two answers have the same name, {', '.join(twice)}. Give each its own."
        )


def _demand_marks(text: str, where: str) -> None:
    """Reject a misspelt mark, which would leave a solution in the students' notebook."""
    open_one = ""
    for line in text.splitlines():
        match = MARK.fullmatch(line)
        if not match:
            continue
        what, marked = match[1], match[2].rstrip()
        if line.strip() != f"### {what} {marked}" or what != what.upper() or marked not in MARKED:
            known = ", ".join(f"`### {what.upper()} {name}`" for name in MARKED)
            raise author.AuthorError(
                f"{where}: `{line.strip()}` is not a marker; the markers are {known}."
            )
        if what == "BEGIN" and open_one:
            raise author.AuthorError(
                f"{where}: `### BEGIN {open_one}` has no `### END {open_one}`."
            )
        if what == "END" and marked != open_one:
            raise author.AuthorError(
                f"{where}: `### END {marked}` has no `### BEGIN {marked}` before it."
            )
        open_one = marked if what == "BEGIN" else ""
    if open_one:
        raise author.AuthorError(f"{where}: `### BEGIN {open_one}` has no `### END {open_one}`.")


def _demand_pi(file: str, notebook: NotebookNode) -> None:
    """Reject a rounded pi, by which an answer with all digits would be wrong."""
    for number, cell in enumerate(notebook.cells):
        for region in SOLUTION.findall(cell.source) if cell.cell_type == "code" else ():
            match = PI_ROUNDED.search(re.sub(r"#.*", "", region))
            if match:
                raise author.AuthorError(
                    f"{file}, cell {number}: the solution uses {match[0]} for pi, so a student "
                    "who uses all the digits would be marked wrong. Write `sm.pi` or `math.pi`."
                )


def _demand_few_digits(name: str, shown: Mapping[str, str]) -> None:
    """Reject texts that would show numbers such as 0.30000000000000004."""
    for parameter, text in shown.items():
        match = re.search(rf"\d*\.\d{{{MOST_PLACES + 1},}}", text)
        if match:
            raise author.AuthorError(
                f"{name}: its text would show {match[0]} for {parameter}. Round it where you draw "
                "it: round(value, 3)."
            )


def _demand_hidden(file: str, notebook: NotebookNode, variables: Mapping[str, str]) -> None:
    """Reject an answer or a question outside the marks, which students would get."""
    owners = {variable: name for name, variable in variables.items()}
    cells = [
        (number, cell.source)
        for number, cell in enumerate(notebook.cells)
        if cell.cell_type == "code"
    ]
    solved_here = {name for _, text in cells for name in answered_in(text, owners)}
    for variable, name in owners.items():
        if variable not in solved_here:
            raise author.AuthorError(
                f"{name}: no solution in {file} sets `{variable}`, so students would see the "
                "answer, or would have no blank to fill in. "
                f"Write `{variable} = ...` between `### BEGIN SOLUTION` and `### END SOLUTION`."
            )
    for number, text in cells:
        for node in ast.walk(ast.parse(posed(text, owners))):
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "question":
                raise author.AuthorError(
                    f"{file}, cell {number}: call `question` between `### BEGIN HIDDEN TESTS` "
                    "and `### END HIDDEN TESTS`, or students would see it."
                )


def _demand_shown(file: str, notebook: NotebookNode, recorder: _Recorder) -> None:
    """Reject variants without a question, and draws that do not match what students see."""
    codes = [cell.source for cell in notebook.cells if cell.cell_type == "code"]
    code = "\n".join(VARIANTS.sub("", HIDDEN.sub("", SOLUTION.sub("", text))) for text in codes)
    for name, rule in recorder.rules.items():
        if name not in recorder.questions:
            raise author.AuthorError(
                f"{name}: {file} draws variants for it, but asks no such question; it asks "
                f"{', '.join(recorder.questions)}."
            )
        given = recorder.given[name]
        braces = dict.fromkeys(re.findall(r"\{\{(\w+)\}\}", recorder.texts[name]))
        unknown = [parameter for parameter in braces if parameter not in (*given, "picture")]
        unshown = [parameter for parameter in given if parameter not in braces]
        # Nested braces may be TeX, but if a parameter is shown nowhere, they are a typo.
        if unknown and unshown:
            raise author.AuthorError(
                f"{name}: its text shows {{{{{unknown[0]}}}}}, which you have not drawn; you have "
                f"drawn {', '.join(given)}."
            )
        unseen = [parameter for parameter in unshown if not re.search(rf"\b{parameter}\b", code)]
        # With `where`, related parameters may show its value.
        if unseen and not rule.picture and not rule.where:
            raise author.AuthorError(
                f"{name}: you draw {unseen[0]}, but students would not see it. Show it in the "
                f"text as {{{{{unseen[0]}}}}}, in one of their cells, or in a picture."
            )


def _texts_of_variants(notebook: NotebookNode) -> dict[str, str]:
    """Return the text of each question with variants, with placeholders for its parameters.

    It is the Markdown below the cell that draws them.
    """
    texts: dict[str, str] = {}
    for cell, after in itertools.pairwise([*notebook.cells, None]):
        drawn = drawn_in(cell.source) if cell.cell_type == "code" else None
        if drawn:
            if after is None or after.cell_type != "markdown":
                raise author.AuthorError(
                    f"{drawn[1]}: put the text of the question right after its variants."
                )
            texts[drawn[1]] = after.source
    return texts


def variant_drawn(
    drawn: Mapping[str, Any], text: str, number: int = 0, count: int = 1, edition: str = ""
) -> Variant:
    """Return the drawn values of a variant that students see or get."""
    return Variant(
        number,
        count,
        given={key: value for key, value in drawn.items() if _is_given(value)},
        shown={key: shown for key, shown in written(drawn).items() if f"{{{{{key}}}}}" in text},
        text=text,
        edition=edition,
    )


def texts_of_questions(
    notebook: NotebookNode, figures: Mapping[int, Drawing] | None = None
) -> dict[str, str]:
    """Return the text of each question: the Markdown between the check before it and its own.

    ``figures`` are the drawings by the numbers of their cells, which students get as pictures.
    """
    texts: dict[str, str] = {}
    above: list[str] = []
    figures = figures or {}
    for number, cell in enumerate(notebook.cells):
        if number in figures:
            above.append(image(figures[number].picture(), figures[number].alt))
        elif cell.cell_type == "markdown":
            above.append(cell.source)
        elif cell.cell_type == "code":
            checked = checked_in([cell.source])
            # The notebook's title, with its introduction to all questions, is no part of the first.
            texts |= dict.fromkeys(
                checked, "\n\n".join(above[len(above) > 1 and above[0].startswith("# ") :])
            )
            above = [] if checked else above
    return texts


def _is_given(value: object) -> bool:
    """Check whether a cell may need a parameter: numbers, words or lists, not sentences."""
    return (
        (isinstance(value, str) and len(value) <= LONGEST_WORD)
        or _is_plain(value)
        and not isinstance(value, str)
    )


def _is_plain(value: object) -> bool:
    return (
        isinstance(value, (int, float, str))
        or isinstance(value, (list, tuple))
        and all(map(_is_plain, value))
    )


def _run(source: str, namespace: dict[str, Any], where: str) -> Any:
    """Run a cell and return the value of its last line, as a notebook shows it."""
    tree = ast.parse(source, where)
    last = tree.body[-1] if tree.body else None
    if isinstance(last, ast.Expr):
        tree.body.pop()
    exec(compile(tree, where, "exec"), namespace)
    if isinstance(last, ast.Expr):
        return eval(compile(ast.Expression(last.value), where, "eval"), namespace)
    return None


def checked_names(notebook: NotebookNode) -> dict[str, str]:
    """Return the variable of each question's answer, from the calls of ``check``."""
    return checked_in(cell.source for cell in notebook.cells if cell.cell_type == "code")


def checked_in(codes: Iterable[str]) -> dict[str, str]:
    """Return the variables of the answers in some code, by question."""
    variables: dict[str, str] = {}
    for node in (node for code in codes if "check" in code for node in ast.walk(ast.parse(code))):
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "check":
            name, answer = node.args
            if not isinstance(name, ast.Constant) or not isinstance(answer, ast.Name):
                raise author.AuthorError(
                    f"{ast.unparse(node)}: call check with a string and a plain variable name."
                )
            variables[str(name.value)] = answer.id
    return variables


def bound(region: str, owners: Mapping[str, str]) -> list[str]:
    """Return the answers that a solution assigns, in order."""
    names = []
    for node in ast.parse(textwrap.dedent(region)).body:
        if isinstance(node, ast.FunctionDef):
            names.append(node.name)
        elif isinstance(node, ast.Assign):
            names += [target.id for target in node.targets if isinstance(target, ast.Name)]
    return [name for name in names if name in owners]


def answered_in(text: str, owners: Mapping[str, str]) -> list[str]:
    """Return the answers that the solutions in a cell assign, in order."""
    return [name for region in SOLUTION.findall(text) for name in bound(region, owners)]


def solved(text: str) -> str:
    """Return a cell with its solution, without the marks around it and without hidden tests."""
    return HIDDEN.sub("", SOLUTION.sub(lambda region: region[1], in_variants(text))).rstrip()


def posed(text: str, owners: Mapping[str, str]) -> str:
    """Return a cell as students get it, with blanks and without hidden tests."""
    return HIDDEN.sub(
        "", SOLUTION.sub(lambda region: blank(region[1], owners), in_variants(text))
    ).rstrip()


def in_variants(text: str) -> str:
    """Return a cell that draws variants as students get it, where it shows their variant."""
    drawn = drawn_in(text)
    return (
        text
        if drawn is None
        else VARIANTS.sub("", text) + f'{drawn[0]} = variant("{drawn[1]}")\n{drawn[0]}'
    )


def blank(region: str, owners: Mapping[str, str]) -> str:
    """Return the blank that replaces a solution."""
    functions = {
        node.name: node
        for node in ast.parse(textwrap.dedent(region)).body
        if isinstance(node, ast.FunctionDef)
    }
    lines = []
    for name in dict.fromkeys(bound(region, owners)):
        if name not in functions:
            lines.append(f"{name} = ...  # your answer\n")
            continue
        function = functions[name]
        lines.append(f"def {name}({ast.unparse(function.args)}):\n")
        if ast.get_docstring(function):
            lines.append(f'    """{ast.get_docstring(function)}"""\n')
        lines.append("    ...  # your code\n")
    return "".join(lines)
