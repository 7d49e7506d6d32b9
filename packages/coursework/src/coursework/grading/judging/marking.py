"""Marking: from a student's answers, as plain data, to outcomes and points.

Only this package has the right answers. The sandbox returns answers as JSON, which we check again.
No student's code runs in this process, and the same functions reach the same verdict as the
student's own check. We leave an answer that we cannot decide to a person and never count it as
wrong. By default, nothing earns points.
"""

import contextlib
import hashlib
import importlib
import io
import itertools
import json
import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from ...authoring.author import AuthoredQuestion, AuthorError
from ...authoring.source import files_of, names_asked, read_source, texts_of_questions
from ...checking.evaluate import MP
from ...checking.fields import Json, by_name, many
from ...checking.kinds import PARTS, Blank, Fault, Undecidable
from ...checking.plain import NotPlain, Plain, parts_of, read_plain
from ...checking.plugins import packages
from ...checking.question import Locker
from ...checking.questions import OTHER_NUMBERS, compare
from ...checking.reading import canonical, fingerprint, read
from ...checking.reply import HELP, Reply
from ..record import Answer, Case, Mark, Record, Remembered
from ..store import write
from ..versions import software
from ..workers import processors, side_by_side
from . import secret as in_secret
from .cases import (
    Contracts,
    asked_of,
    case_by_rule,
    case_of,
    questions_in,
    variants_of,
)
from .contract import Asked, Contract

#: An exact question leaves an answer undecided that is off by less than this, since the student may
#: have rounded it.
NEARLY = MP.mpf("1.5e-3")
#: We do not try wrong answers with more nodes than this on the other variants. Only the message to
#: the student depends on it, and an answer made to cost time would cost it for each variant.
LONGEST_FOR_SIBLINGS = 1_000
#: The most verdicts that we remember for students who hand in the same answer.
MOST_KEPT = 4096
#: The mark of an answer on which the judging process ended, without what depends on the question.
UNJUDGED = Mark(
    "undecided",
    "too much work",
    messages=(
        "Evaluating this answer exceeds the time or memory limit, so your instructor will decide.",
    ),
)
#: A figure in the text of a question, as `coursework.checking.variants.image` writes it.
PICTURE = re.compile(r'<p><img alt="[^"]*" width="[^"]*" src="[^"]*"></p>')
#: The outcomes of a cell that a limit stopped. An answer missing after that may be lost to the
#: limit.
BY_A_LIMIT = ("timeout", "memory", "disk", "output")
#: In place of an answer that no run of the notebook looked for. A run stores one for each question.
NOT_RUN = Answer("not run")
#: The sandbox's reasons if a limit, not the answer's form, cut short its reading.
CUT_SHORT = ("It exceeded the time limit.", "It exceeded the memory limit.")


# --- the contracts of all questions -------------------------------------------------------------


def questions_of(
    path: str | Path, secret: bytes, edition: str = ""
) -> dict[str, tuple[Contract, ...]]:
    """Return the contracts of a solution notebook's questions in all their variants, by name."""
    # What a solution prints is for its author.
    with contextlib.redirect_stdout(io.StringIO()):
        return _questions_of(path, secret, edition)


def _questions_of(path: str | Path, secret: bytes, edition: str) -> dict[str, tuple[Contract, ...]]:
    source = read_source(path, edition=edition, only=list(names_asked(path)), pictures=True)
    texts = texts_of_questions(source.notebook, source.figures)
    contracts = {
        name: [contract_of(question, secret, texts.get(name, ""))]
        for name, question in source.questions.items()
    }
    for number in range(1, max((rule.count for rule in source.rules.values()), default=1)):
        having = [name for name, rule in source.rules.items() if number < rule.count]
        for name, question in read_source(
            path, number, edition, having, pictures=True
        ).questions.items():
            contracts[name].append(contract_of(question, secret))
    return {name: tuple(variants) for name, variants in contracts.items()}


def of_student(
    questions: Mapping[str, Sequence[Contract]],
    identity: str,
    record: Record | None = None,
    contracts: Contracts | None = None,
    earlier: Mapping[str, Sequence[Sequence[Contract]]] | None = None,
    shows: Callable[[str], bool] = lambda text: False,
) -> tuple[dict[str, Asked], dict[str, Case]]:
    """Return the questions of a student, each in the student's own variant, and the case of each.

    Parameters
    ----------
    questions : dict
        The questions, as `load_questions` returns them.
    identity : str
        The student in the roster; the name that the notebook gives does not count.
    record : dict, optional
        The student's earlier record. The student keeps the variant in it, whatever happened to the
        others.
    contracts : Contracts, optional
        The questions as they stood then.
    earlier : mapping, optional
        The earlier variants, as `earlier_variants` returns them.
    shows : function, optional
        Returns whether the student's notebook shows a text.

    Returns
    -------
    questions : dict of str to Asked
    cases : dict of str to Case
    """
    own: dict[str, Asked] = {}
    cases: dict[str, Case] = {}
    for name, variants in questions.items():
        today = case_by_rule(name, variants, identity)
        case = record.cases.get(name) if record and contracts else None
        if case is None or case.edition != today.edition:
            case, before = today, (earlier or {}).get(name)
            if before and contracts:
                case = case_of(name, [variants, *before], identity, contracts, shows)
        others = [place for place in case.others if place.variant != today.own.variant]
        by_others = replace(case, others=(*others, today.own))
        own[name], cases[name] = asked_of(name, variants, by_others, contracts), case
    return own, cases


def with_second_chances(
    questions: Mapping[str, Asked], named: Collection[str] | None = None
) -> dict[str, Contract]:
    """Return a student's questions and their siblings: those that are ``named``, or all."""
    chances = {
        sibling: contract
        for asked in questions.values()
        for sibling, contract in asked.second_chances.items()
        if named is None or sibling in named
    }
    return {name: asked.contract for name, asked in questions.items()} | chances


def contract_of(question: AuthoredQuestion, secret: bytes, text: str = "") -> Contract:
    """Return the contract of a question, with its version.

    ``text`` is the question's text in the source. A question with variants has texts of its own, so
    we take only the figures from it.
    """
    near = {text: Locker().as_json() for text in question.near}
    known = near | {
        text: Locker(tuple(entry.answers)).as_json() for text, entry in question.entries.items()
    }
    contract = Contract(
        title=question.title,
        variable=question.variable,
        worth=question.worth,
        question=question.public,
        credit=question.credit,
        known=known,
        right=_canonical_of(question),
        plain=question.plain if question.public.kind != "function" else None,
        secret=in_secret.secret_of(question, secret),
        partial=read(question.public, question.plain).text if question.partial else None,
        rubric=dict(question.rubric)
        if isinstance(question.rubric, dict)
        else dict.fromkeys(question.rubric),
        text="\n\n".join(PICTURE.findall(text)) if question.public.variant else text,
    )
    # Convert it to JSON and back, which turns an author's tuples into lists.
    return Contract.from_json(
        json.loads(json.dumps(contract.as_json())), question.name
    ).with_version()


def _canonical_of(question: AuthoredQuestion) -> tuple[str, ...] | None:
    reading = read(question.public, question.plain)
    if reading.text is not None or question.public.tolerance is not None:
        return None
    return tuple(MP.nstr(number, 30) for number in canonical(question.public, reading))


def load_questions(
    paths: Iterable[str | Path], results: str | Path, secret: bytes, edition: str = ""
) -> dict[str, tuple[Contract, ...]]:
    """Load the questions of several notebooks with solutions, by name.

    We store the processed questions in the folder of results, under a name that depends on the
    bytes of the notebook, those of the files beside it, and the versions of the software.
    """
    places: dict[Path, Path] = {}
    ours = hashlib.sha256(json.dumps(software()).encode() + secret).digest()
    for path in map(Path, paths):
        sources = b"".join(files_of(path).values())
        depends = hashlib.sha256(ours + edition.encode() + sources).hexdigest()[:16]
        places[path] = Path(results) / "questions" / f"{path.stem}-{depends}.json"

    def work_out(path: Path) -> None:
        questions = questions_of(path, secret, edition)
        as_json = {
            name: [contract.as_json() for contract in variants]
            for name, variants in questions.items()
        }
        write(places[path], json.dumps(as_json, ensure_ascii=False), private=True)

    missing = [path for path, place in places.items() if not place.exists()]
    if len(missing) == 1:
        work_out(missing[0])
    else:
        for module in ("nbformat", "sympy.physics.mechanics", *packages()) if missing else ():
            # Import these once, not in each process.
            importlib.import_module(module)
        number = min(len(missing), processors())
        list(
            side_by_side(
                map(str, missing),
                number,
                lambda stack: lambda path: work_out(Path(path)),
                [AuthorError],
            )
        )
    return {
        name: variants
        for place in places.values()
        for name, variants in questions_in(place).items()
    }


#: The file with all sets of variants by which this class was graded, for each question.
VARIANTS = "variants.json"


def earlier_variants(
    questions: Mapping[str, Sequence[Contract]], results: Path
) -> dict[str, list[Sequence[Contract]]]:
    """Return earlier sets of variants that differ from today's, newest first; store today's."""
    path = results / VARIANTS
    lists: dict[str, tuple[tuple[Contract, ...], ...]] = {}
    if path.exists():
        read_lists = by_name(many(many(Contract.from_json)))
        lists = read_lists(json.loads(path.read_text("utf8")), str(path))
    earlier: dict[str, list[Sequence[Contract]]] = {}
    before = dict(lists)
    for name, variants in questions.items():
        names = list(variants_of(variants))
        others = [those for those in lists.get(name, ()) if list(variants_of(those)) != names]
        if others or len(names) > 1:
            # Keep the latest contracts of the same set of variants.
            lists[name] = (*others, tuple(variants))
            earlier[name] = list[Sequence[Contract]](others[::-1])
    if lists != before:
        as_json = {
            name: [[contract.as_json() for contract in those] for those in several]
            for name, several in lists.items()
        }
        write(path, json.dumps(as_json, ensure_ascii=False), private=True)
    return earlier


def asked_of_sandbox(questions: Mapping[str, Contract]) -> dict[str, dict[str, Json]]:
    """Return what the sandbox needs for each question: an answer's name and a function's calls.

    A notebook receives the secret calls only when it has handed in everything else.
    """
    variables = [contract.variable for contract in questions.values()]

    def calls(contract: Contract, arguments: tuple[list[Json], ...]) -> Json:
        is_called = contract.question.kind == "function" and arguments
        return {"arguments": list(arguments), "as": contract.question.takes} if is_called else None

    return {
        name: {
            # In two notebooks that were joined, two questions may use the same name for their
            # answers. Then only the checks tell them apart.
            "variable": contract.variable if variables.count(contract.variable) == 1 else None,
            "calls": calls(contract, contract.question.calls),
            "secret calls": calls(contract, contract.secret.calls if contract.secret else ()),
        }
        # Add the numbers of the student's own variant, which the notebook may use by name.
        | ({"given": dict(contract.variant.given)} if contract.variant.given else {})
        for name, contract in questions.items()
    }


def was_limited(record: Record) -> bool:
    """Check whether a limit stopped one of the cells of a record."""
    return any(
        cell.outcome in BY_A_LIMIT or "SIGKILL" in (cell.error or "")
        for notebook in record.notebooks
        for cell in notebook.cells
    )


# --- one answer ---------------------------------------------------------------------------------


def mark(
    name: str, question: Asked, answer: Answer, finished: bool = True, limited: bool = False
) -> Mark:
    """Judge an answer that the sandbox returned.

    Parameters
    ----------
    name : str
    question : Asked
    answer : Answer
    finished : bool
        Whether the notebook ran to its end; if not, that may be why an answer is missing.
    limited : bool
        Whether a limit stopped a cell, which may also be why an answer is missing.

    Returns
    -------
    Mark
    """
    # Many students hand in the same answer. The mark depends only on these values.
    known = (
        name,
        question.contract.version,
        (question.before or question.contract).version,
        len(question.siblings),
        len(question.others),
        json.dumps(answer.as_json()),
        finished,
        limited,
    )
    if known not in _marked:
        if len(_marked) >= MOST_KEPT:
            _marked.clear()
        _marked[known] = _mark(name, question, answer, finished, limited)
    return _marked[known]


_marked: dict[tuple[object, ...], Mark] = {}


def _mark(name: str, question: Asked, answer: Answer, finished: bool, limited: bool) -> Mark:
    contract = question.contract
    reply, text = judge(name, question, answer, finished, limited)
    short = (
        reply.outcome == "wrong"
        and answer.plain is not None
        and len(answer.plain["nodes"]) <= LONGEST_FOR_SIBLINGS
    )
    if short and any(_is_right(name, other, answer) for other in question.others):
        said = (
            "This is right for the numbers of another edition of this question. Which edition "
            "did this student have?"
        )
        reply = _undecided(name, "numbers of another edition", said)
    # Variants share answers. What is a known mistake for these numbers may be right for others, so
    # here the student's own check names the mistake.
    elif (
        short
        and reply.known is None
        and any(_is_right(name, Asked(sibling), answer) for sibling in question.siblings)
    ):
        said = "This is right for numbers other than yours."
        reply = Reply(name, "wrong", OTHER_NUMBERS, [said])
    share: float = 1 if reply.outcome == "correct" else 0
    if reply.outcome == "wrong" and reply.note:
        share = contract.credit.get(reply.note, 0)
    if reply.outcome == "wrong" and contract.partial and reply.note != OTHER_NUMBERS:
        right, parts, beyond_chance = parts_right(contract, text)
        share = max(share, beyond_chance)
        pairs = "pairs are in the right order" if contract.question.kind == "order" else "are right"
        reply.messages.append(f"{right} of {parts} {pairs}.")
    return Mark(
        reply.outcome,
        reply.note,
        reply.details,
        tuple(reply.messages),
        round(contract.worth * share, 4),
        contract.worth,
        hashlib.sha256(text.encode()).hexdigest()[:16] if text else "",
        contract.version,
    )


def _is_right(name: str, question: Asked, answer: Answer) -> bool:
    """Check whether an answer is right for a question; its fingerprint rules most out quickly."""
    with contextlib.suppress(
        ArithmeticError, ValueError, LookupError, TypeError, Blank, Fault, Undecidable
    ):
        asked = question.contract.question
        return (
            answer.plain is not None
            and fingerprint(asked, read(asked, answer.plain)) in question.contract.known
            and judge(name, question, answer)[0].outcome == "correct"
        )
    return False


def parts_right(contract: Contract, text: str) -> tuple[int, int, float]:
    """Return how many parts of an answer in words are right, of how many, and the share they earn.

    The parts of an order are its pairs: which of the two comes first. From the share we subtract
    what a guess gets right on average, 1/m for m words to choose from, so that guessing earns
    nothing.
    """
    kind, right = contract.question.kind, contract.partial or ""
    if kind == "order":
        given = text.split(PARTS["order"])
        places = {part: place for place, part in enumerate(right.split(PARTS["order"]))}
        good = [
            places[first] < places[second] for first, second in itertools.combinations(given, 2)
        ]
        chance = 1 / 2
    else:
        between = PARTS[kind]
        given, wanted = (
            (answer.split(between) if between else list(answer)) for answer in (text, right)
        )
        good = [entry == other for entry, other in zip(given, wanted, strict=True)]
        chance = 1 / len(contract.question.options or "TF")
    return sum(good), len(good), max(0, (sum(good) / len(good) - chance) / (1 - chance))


def mark_with_siblings(
    name: str,
    question: Asked,
    answers: Mapping[str, Answer],
    remembered: Mapping[str, Remembered],
    finished: bool = True,
    limited: bool = False,
) -> Mark:
    """Return the mark of a question, allowing for help that the student had and siblings solved.

    Parameters
    ----------
    answers : mapping
        The answers of the record, by the names of questions and siblings.
    remembered : mapping
        What the record remembers.
    """
    known = remembered.get(name)
    own_mark = mark(name, question, answers.get(name, NOT_RUN), finished, limited)
    had = ""
    if known:
        own_mark, had = replace(own_mark, tries=known.tries), known.help
    for sibling, other in question.second_chances.items():
        helped = sibling in remembered and remembered[sibling].help
        if sibling in answers and not helped and (had or own_mark.outcome != "correct"):
            if judge(sibling, Asked(other), answers[sibling])[0].outcome == "correct":
                return _by_a_sibling(question.contract, own_mark, sibling)
    if own_mark.outcome == "correct" and had and (question.siblings or question.second_chances):
        share = question.contract.credit.get("help", 1)
        said = (
            f"Right, with help: {HELP.get(had, 'we showed it')}. Solve a sibling without help to "
            "earn the rest."
        )
        points = round(question.contract.worth * share, 4)
        return replace(
            own_mark, note="with help", points=points, messages=(said,) if share < 1 else ()
        )
    return own_mark


def _by_a_sibling(contract: Contract, mark_of_sibling: Mark, sibling: str) -> Mark:
    """Return the mark of a question after its student solved a sibling without help.

    It restores the points that help cost. If the question itself was not answered correctly, we
    cannot know whose numbers were solved, and each sibling would give a friend's answer one more
    chance, so a person decides.
    """
    if mark_of_sibling.outcome == "correct":
        said = f"You solved `{sibling}` without help, so it counts for this question."
        return replace(
            mark_of_sibling, note="by a sibling", points=contract.worth, messages=(said,)
        )
    said = (
        f"You solved `{sibling}` without help, but not the question itself, so your instructor "
        "will decide."
    )
    return replace(
        mark_of_sibling,
        outcome="undecided",
        note="by a sibling alone",
        points=0,
        messages=(*mark_of_sibling.messages, said),
    )


def judge(
    name: str, question: Asked, answer: Answer, finished: bool = True, limited: bool = False
) -> tuple[Reply, str]:
    """Return the `coursework.checking.reply.Reply` to an answer, and its fingerprint if any."""
    state, contract = answer.outcome, question.contract
    if state == "missing":
        if not finished:
            return _undecided(
                name,
                "not reached",
                "The notebook stopped before it reached this answer.",
            ), ""
        if limited:
            return _undecided(
                name,
                "lost to a limit",
                "A time or memory limit stopped a cell, and this answer is missing.",
            ), ""
        named = f" under the name `{contract.variable}`" if contract.variable else ""
        return Reply(name, "not attempted", "missing", [f"No answer was found{named}."]), ""
    if answer == NOT_RUN:
        return _undecided(
            name,
            "not run",
            "The notebook was graded before it was asked this question, or before the question got "
            "this name. Grade again to run it.",
        ), ""
    if state == "on paper":
        return _undecided(name, "on paper", "A person marks this sheet."), ""
    if state == "unreadable" and answer.why not in CUT_SHORT:
        return Reply(name, "invalid", "unreadable", [answer.why or ""]), ""
    if state != "recorded":
        return _undecided(
            name,
            "interrupted while reading",
            f"We had to stop reading this answer. {answer.why or answer.error or ''}".strip(),
        ), ""
    looked_up: list[str] = []

    def look_up(text: str) -> Locker | None:
        # A later look-up is another reading of the same answer.
        if not looked_up:
            looked_up.append(text)
        return contract.locker(text)

    try:
        plain = in_calls_of(question, read_plain(answer.plain))
        if plain is None:
            return _undecided(
                name,
                "not called",
                "We have not called the function with this question's current arguments. Grade "
                "again to run it.",
            ), ""
        reply = compare(name, contract.question, plain, look_up)
        rounded = reply.outcome == "wrong" and reply.note in ("", "rounded too far")
        if rounded and _nearly_right(contract, plain):
            reply = _undecided(
                name,
                "nearly right",
                "The value agrees with the right one to about three digits. The student may have "
                "rounded, although the question asks for an exact answer.",
            )
        if reply.outcome == "not attempted":
            # The work is handed in, so "yet" would be wrong.
            reply.messages = ["Nothing was answered."]
        if reply.outcome == "correct" or (reply.note and contract.credit.get(reply.note)):
            reply = _in_secret(name, contract, answer, plain, reply, looked_up[-1])
    except NotPlain as error:
        reply = Reply(name, "invalid", "unreadable", [str(error)])
    except MemoryError:
        # The judging process is at its limit, which must not affect other answers.
        raise
    # A fault of ours must not cost a student a mark.
    except Exception as error:
        reply = _undecided(
            name, "not worked out", f"We could not evaluate this answer ({type(error).__name__})."
        )
    return reply, "".join(looked_up)


def in_calls_of(question: Asked, plain: Plain) -> Plain | None:
    """Order a function's results by a question's current calls; ``None`` if one is missing.

    The record has the results of the contract's calls, one after another.
    """
    calls = question.contract.question.calls
    called = (question.before or question.contract).question.calls
    value = plain["value"]
    if value[0] != "function" or calls == called:
        return plain
    results = parts_of(value)
    if (
        not calls
        or not called
        or len(results) != len(called)
        or any(call not in called for call in calls)
    ):
        return None
    return {
        "value": ["function", [results[called.index(call)] for call in calls], value[2]],
        "nodes": plain["nodes"],
    }


def _in_secret(
    name: str, contract: Contract, answer: Answer, plain: Plain, reply: Reply, text: str
) -> Reply:
    """Return the reply, once the answer also agrees at the points that students cannot know."""
    place = contract.secret
    if place is None:
        return reply
    right = place.right if reply.outcome == "correct" else place.partly.get(text)
    if right is None:
        # For a mistaken function, the results elsewhere are unknown.
        return reply
    if place.calls:
        said = answer.secret or {}
        if "unreadable" in said and said["unreadable"] not in CUT_SHORT:
            return _elsewhere_wrong(name)
        if "plain" not in said or said.get("calls") != place.digest:
            return _undecided(
                name,
                "not called",
                "We could not call the function with arguments other than those of the check.",
            )
        plain = read_plain(said["plain"])
    try:
        numbers = in_secret.numbers_of(place.of(contract.question), plain)
    except (Blank, Fault):
        return _elsewhere_wrong(name)
    except Undecidable as error:
        return _undecided(name, "undecidable", str(error))
    return reply if in_secret.agree(contract.question, numbers, right) else _elsewhere_wrong(name)


def _elsewhere_wrong(name: str) -> Reply:
    return Reply(
        name,
        "wrong",
        "right only where it is checked",
        ["This agrees with the right answer only where the check tests it."],
    )


def _undecided(name: str, note: str, message: str) -> Reply:
    return Reply(name, "undecided", note, [message])


def _nearly_right(contract: Contract, plain: Plain) -> bool:
    if contract.right is None:
        return False
    try:
        numbers = canonical(contract.question, read(contract.question, plain))
    except (Blank, Fault, Undecidable):
        return False
    right = [MP.mpf(number) for number in contract.right]
    return len(numbers) == len(right) and all(
        abs(number - other) <= NEARLY * max(1, abs(other))
        for number, other in zip(numbers, right, strict=True)
    )
