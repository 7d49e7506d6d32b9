"""Tests of questions before release: right forms pass, mistakes are named, and nothing leaks.

The result is a page for the author, with what each question recognises, how many answers it allows
if they are few, and its faults, if any.
"""

import base64
import contextlib
import io
import json
import random
import re
import zipfile
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import sympy
from markupsafe import Markup

from ..checking.catalogue import message
from ..checking.kinds import Fault, Undecidable, number_of
from ..checking.mistakes import GENERAL
from ..checking.plain import NotPlain
from ..checking.plugins import kinds
from ..checking.questions import judge, notebook_questions
from ..checking.reply import Reply
from .author import AuthoredQuestion, AuthorError
from .closed import possible_answers
from .course import Course
from .forms import another_answer, equivalent_forms
from .pages import ENVIRONMENT
from .source import (
    CHAPTERS,
    HIDDEN,
    SOLUTION,
    Source,
    blank,
    notebooks_in,
    processes_for,
    read_source,
)

#: The most equivalent forms in which to test a right answer.
FORMS = 6


class Finding(NamedTuple):
    """The results for one question; ``faults`` is empty if it is ready for students."""

    name: str
    kind: str
    forms: list[str]
    # The note and the message.
    mistakes: list[tuple[str, str]]
    unmoved: list[str]
    possible: int | None
    worth: float
    faults: list[str]


#: Descriptions of what no student may receive, by its text without spaces.
Secrets = Mapping[str, str]
#: The description of a secret, and where it was found.
Leak = tuple[str, str]


def try_question(question: AuthoredQuestion, against_sealed: bool = True) -> Finding:
    """Try right and wrong answers to one question, as students will.

    Parameters
    ----------
    question : AuthoredQuestion
    against_sealed : bool
        Whether to test its released file, too.

    Answers are compared before the slow hash locks them up. That the locks contain the same is
    tested here for the right answer. For the others it follows from the release, which locks
    nothing else.
    """
    faults = list(question.slips)
    if kinds()[question.public.kind].by_a_person:
        return _try_text(question)
    forms = equivalent_forms(question.public, question.answer)
    for form, answer in forms:
        reply = _judge(question, answer)
        if reply.outcome != "correct":
            faults.append(
                f'The right answer in the form "{form}" gets "{reply.outcome}": {reply.messages}'
            )
    words = kinds()[question.public.kind].text or question.public.kind == "function"
    if len(forms) < FORMS and not words and not hasattr(question.answer, "to_matrix"):
        faults.append(f"We tried the right answer in only {number_of(len(forms), 'form')}.")
    there = against_sealed and question.name in notebook_questions(question.name.partition("/")[0])
    sealed = (
        notebook_questions(question.name.partition("/")[0], question.number)[question.name]
        if there
        else None
    )
    expected = "recorded" if question.public.exam else "correct"
    if sealed and judge(question.name, sealed, question.plain).outcome != expected:
        faults.append(
            "The right answer does not open the sealed question. Run `coursework release` again."
        )
    named, unmoved = _try_mistakes(question, faults)
    blank = _judge(question, ...)
    if blank.outcome != "not attempted":
        faults.append(f'The untouched blank gets "{blank.outcome}".')
    others = (
        question.to_plain(another_answer(question.public, question.answer, random.Random(seed)))
        for seed in range(9)
    )
    other = next(
        (plain for plain in others if question.fingerprint_of(plain) not in question.entries), None
    )
    reply = Reply(question.name, "wrong") if other is None else question.reply_to(other)
    if reply.outcome == "correct" or reply.outcome == "wrong" and reply.note:
        faults.append(f'Another answer gets "{reply.outcome}", {reply.note!r}.')
    return Finding(
        question.name,
        question.public.kind,
        [form for form, _ in forms],
        named,
        unmoved,
        possible_answers(question),
        question.worth,
        faults,
    )


def _try_text(question: AuthoredQuestion) -> Finding:
    """Test a question that a person marks: blanks are no answer, and every text waits."""
    outcomes = [_judge(question, answer).outcome for answer in (..., "", question.answer)]
    right = outcomes == ["not attempted", "not attempted", "undecided"]
    faults = [] if right else [f"Its answers get {outcomes}."]
    if not question.rubric:
        faults.append("Graders need a `rubric`: say what to look for.")
    return Finding(question.name, question.public.kind, [], [], [], None, question.worth, faults)


def _judge(question: AuthoredQuestion, answer: object) -> Reply:
    try:
        return question.reply_to(question.to_plain(answer))
    except NotPlain as error:
        return Reply(question.name, "invalid", "unreadable", [str(error)])


def _try_mistakes(
    question: AuthoredQuestion, faults: list[str]
) -> tuple[list[tuple[str, str]], list[str]]:
    named: list[tuple[str, str]] = []
    unmoved: list[str] = []
    for mistake in question.mistakes:
        said = message(question.public, mistake.note, mistake.details)
        try:
            plain = question.to_plain(mistake.answer)
            reply = question.reply_to(plain)
            if reply.outcome == "correct":
                unmoved.append(mistake.note)
                continue
            entry = question.entries[question.fingerprint_of(plain)]
        except (Fault, Undecidable, NotPlain) as refused:
            named.append((mistake.note, f"(refused for its form) {refused}"))
            continue
        except KeyError:
            faults.append(
                f'The mistake "{mistake.note}" gets "{reply.outcome}", and is not recognised: '
                f"{reply.messages}"
            )
            continue
        known = [note for answer in entry.answers for note in answer.notes]
        covered = mistake.note in GENERAL and known
        if reply.outcome != "wrong" or not covered and (mistake.note, mistake.details) not in known:
            faults.append(
                f'The mistake "{mistake.note}" gets "{reply.outcome}", {reply.note!r}, instead '
                "of its own message."
            )
        elif not reply.messages:
            faults.append(f'The mistake "{mistake.note}" has no message.')
        named.append((mistake.note, said))
    return named, unmoved


# --- secrets that nothing students receive may contain ------------------------------------------


def secrets_of(source: Source) -> Secrets:
    """Return the secrets of a notebook with solutions, each with a description."""
    texts: list[tuple[str, str]] = []
    for cell in source.notebook.cells:
        if cell.cell_type == "code":
            for region in SOLUTION.findall(cell.source):
                texts += [("a line of a solution", line) for line in region.splitlines()]
            for region in HIDDEN.findall(cell.source):
                texts += [("a line of a hidden test", line) for line in region.splitlines()]
    for name, question in source.questions.items():
        for line in question.solution.splitlines():
            texts.append((f"the worked solution of {name}", line))
        for step in [
            step for steps in [*question.hints.values(), *question.after.values()] for step in steps
        ]:
            texts.append((f"a hint of {name}", step))
        if kinds()[question.public.kind].entries:
            texts += [(f"the answer of {name}", text) for text in _writings(question.answer)]
    given = {
        _dense(line)
        for cell in source.notebook.cells
        for line in HIDDEN.sub("", SOLUTION.sub("", cell.source)).splitlines()
    }
    # Blanks are public, too: the signature of a function and its docstring.
    owners = {question.variable or "": name for name, question in source.questions.items()}
    given |= {
        _dense(line)
        for cell in source.notebook.cells
        for region in SOLUTION.findall(cell.source)
        for line in blank(region, owners).splitlines()
    }
    # The arguments for testing a function are public, since its check must call it.
    given |= {
        _dense(json.dumps(question.public.calls or "")) for question in source.questions.values()
    }
    secrets: dict[str, str] = {}
    for what, text in texts:
        dense = _dense(text)
        # Skip short lines, which occur anywhere, imports and marks, which reveal nothing, and what
        # the author reveals elsewhere.
        if (
            len(dense) >= 14
            and not _tells_nothing(text)
            and not any(dense.strip(",") in line for line in given)
        ):
            secrets.setdefault(dense, what)
    return secrets


def told_openly(question: AuthoredQuestion, secrets: Secrets) -> list[str]:
    """Return the faults of a question's ladder, whose steps anybody can read with a little code.

    Parameters
    ----------
    question : AuthoredQuestion
    secrets : dict
        The result of `secrets_of`.
    """
    openly = "A step of its ladder, which anybody can open with a few lines of code,"
    faults: list[str] = []
    for step in question.ladder:
        faults += [
            f"{openly} contains {what}: {step}" for what, _ in found_in({"": _dense(step)}, secrets)
        ]
        for code in re.findall(r"`([^`]+)`", step):
            if _judge_code(question, code) == "correct":
                faults.append(f"{openly} gives the right answer: {step}")
    return [f"{fault} Seal it instead, in `hints` or in `after`." for fault in faults]


def _judge_code(question: AuthoredQuestion, code: str) -> str:
    """Return the outcome of code as the answer to a question; empty if it gives none."""
    symbols = {name.rstrip("'"): sympy.Symbol(name.rstrip("'")) for name in question.public.symbols}
    # If it fails in any way, it is not an answer.
    with contextlib.suppress(Exception):
        return _judge(
            question, eval(code.partition("=")[2] or code, {**vars(sympy), "sm": sympy, **symbols})
        ).outcome
    return ""


def _tells_nothing(line: str) -> bool:
    """Check for an import, a mark, or the head of a function, class or simple loop."""
    loop = r"for \w+ in (\w+|range\(\d+\)):$"
    head = rf"\s*(import |from \w[\w.]* import |def |### |class |{loop})"
    return re.match(head, line) is not None


def _writings(answer: object) -> list[str]:
    if isinstance(answer, tuple) and isinstance(answer[-1], str):
        # Drop the unit of a number.
        answer = answer[0]
    try:
        expression = (
            sympy.Matrix(answer) if isinstance(answer, (list, tuple)) else sympy.sympify(answer)
        )
    except (TypeError, ValueError, sympy.SympifyError):
        return []
    if not hasattr(expression, "free_symbols"):
        return []
    writings = [str(expression), sympy.srepr(expression), sympy.latex(expression)]
    if hasattr(expression, "tolist"):
        writings.append(str(expression.tolist()))
    return writings


def _dense(text: str) -> str:
    return re.sub(r"\s+", "", text).lower()


def released_texts(
    exercises: str | Path, sealed: str | Path, archive: str | Path
) -> dict[str, str]:
    """Return all text that students receive, by place, including packed files and pictures."""
    files = {
        str(path): path.read_bytes()
        for folder, pattern in ((exercises, "*.ipynb"), (sealed, "*.json"))
        for path in sorted(Path(folder).rglob(pattern))
    }
    if Path(archive).exists():
        files[str(archive)] = Path(archive).read_bytes()
    texts: dict[str, str] = {}
    while files:
        name, data = files.popitem()
        if name.endswith((".zip", ".whl")):
            with zipfile.ZipFile(io.BytesIO(data)) as box:
                files.update({f"{name}!{inner}": box.read(inner) for inner in box.namelist()})
            continue
        text = data.decode("utf8", "replace")
        if name.endswith((".ipynb", ".json")):
            text += "\n".join(_strings(json.loads(text)))
        for picture in re.findall(r"base64,([A-Za-z0-9+/=]{40,})", text):
            text += base64.b64decode(picture).decode("utf8", "replace")
        texts[name] = _dense(text)
    return texts


def _strings(data: object) -> Iterator[str]:
    """Iterate over all strings in JSON data, decoded."""
    if isinstance(data, str):
        yield data
    elif isinstance(data, dict):
        for key, value in data.items():
            yield key
            yield from _strings(value)
    elif isinstance(data, list):
        # A notebook may store a text as a list of its lines.
        if all(isinstance(part, str) for part in data):
            yield "".join(data)
        else:
            for part in data:
                yield from _strings(part)


def found_in(texts: Mapping[str, str], secrets: Secrets) -> list[Leak]:
    """Return each secret that a text contains, with its description and the place."""
    return [
        (what, place)
        for secret, what in secrets.items()
        for place, text in texts.items()
        if secret in text
    ]


# --- the page -----------------------------------------------------------------------------------


def selftest(
    course: Course,
    page: str | Path | None = None,
    only: Collection[str] = (),
) -> list[str]:
    """Test all questions of a course, or of some notebooks, look for leaks, and write the page.

    Returns
    -------
    list of str
        All faults; empty if students can get the exercises.

    Raises
    ------
    AuthorError
        There is nothing to test, or a notebook cannot be read.
    """
    paths = notebooks_in(course.sources, only)
    with processes_for(paths) as pool:
        tried = list(pool.map(_try_notebook, paths, [course] * len(paths)))
    findings = [finding for of_notebook, _ in tried for finding in of_notebook]
    if not findings:
        raise AuthorError(f"The notebooks in {course.sources} have no questions.")
    texts = released_texts(course.exercises, course.sealed, course.archive)
    leaked = [leak for _, secrets in tried for leak in found_in(texts, secrets)]
    if page:
        Path(page).parent.mkdir(parents=True, exist_ok=True)
        Path(page).write_text(write_page(findings, leaked), "utf8")
    return [f"{finding.name}: {fault}" for finding in findings for fault in finding.faults] + [
        f"{what} is in {place}" for what, place in leaked
    ]


def _try_notebook(path: Path, course: Course) -> tuple[list[Finding], Secrets]:
    """Test the questions of a notebook, and return the findings and the notebook's secrets."""
    source = read_source(path, edition=course.edition)
    secrets = secrets_of(source)
    findings: list[Finding] = []
    for question in source.questions.values():
        finding = try_question(question)
        findings.append(finding._replace(faults=[*finding.faults, *told_openly(question, secrets)]))
    return findings, {} if source.name == CHAPTERS else secrets


def write_page(
    findings: Sequence[Finding],
    leaked: Sequence[Leak] | None = None,
    questions: Sequence[tuple[AuthoredQuestion, Markup]] = (),
    variants: Sequence[tuple[AuthoredQuestion, Markup]] = (),
) -> str:
    """Return the page, with the texts of ``questions`` and of all ``variants`` of one, if given."""
    return ENVIRONMENT.get_template("selftest.html").render(
        findings=findings, leaked=leaked, questions=questions, variants=variants
    )
