"""The sealed questions, found by name.

A name is ``'notebook/question'``; the questions of one notebook lie in one file, ``sealed/notebook.json``. The
folder ``sealed`` stands beside the notebook, or in the package of a plug-in.
"""

import difflib
import functools
import hashlib
import json
import re
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from fractions import Fraction
from pathlib import Path

from . import format_3, sealing
from .evaluate import MP
from .kinds import Blank, Fault, Reading, Undecidable, canonical, distance, fault, fingerprint, read, tolerances
from .mistakes import by_short_name, message
from .plugins import kind_of_values, kinds, sealed_folders
from .points import spellings
from .reply import Reply
from .variants import own_variant, siblings_of, without_sibling

#: Of the files with sealed questions. Format 3, which called a mistake by its place in a catalogue, is read, too.
FORMAT = 4
#: In a folder of sealed questions: where in the web those are that it lacks. Only a browser's Python has such a file.
ELSEWHERE = "elsewhere.txt"
#: In a folder of sealed questions: the names that questions had in earlier editions.
MOVED = "moved.json"
#: Letters and digits of a code that opens worked solutions: none that looks like another.
CODE_LETTERS = "23456789ABCDEFGHJKLMNPQRSTUVWXYZ"
#: The outcomes that a locker may hold, by their number in it.
OUTCOMES = ("correct", "mistake")
NOT_IN_THIS_CATALOGUE = (
    "This is a mistake that others have made, too, and this version of coursework has no words for it: install the "
    "package that came with the notebook."
)
#: Faults of the form that no right value makes good.
ALWAYS_WRONG = ("not unit length",)
#: Up to so many tolerances from the right answer, its locker opens, and one is told that it is close.
NEARLY = 3
#: The note of an answer that is right for another variant, here and in the marks, and what is said of it.
OTHER_NUMBERS = "other numbers"
FOR_OTHERS = (
    "This would be right for other numbers than yours: those of another student, or those that everybody sees. Yours "
    "stand in the text of the question, as its cell shows it once it has run."
)
#: As far from it one is told so where the locker has opened all the same: its cell is wider for several numbers.
CLOSE = 30
#: What numbers may be off by that were rounded to two digits after the point.
COARSE = 0.005
#: Denominators up to which a decimal fraction is plainly that fraction: one with few digits, and one with all of them.
SMALL, LARGE = 64, 1000


class NoSuchQuestion(KeyError):
    """There is no question of that name; the message names the nearest one."""

    def __str__(self):
        return self.args[0]


@functools.cache
def notebook_questions(notebook, variant=0):
    """The public parts and the lockers of the questions of a notebook, by full name.

    Those of variant 0 are all questions; those of another are the questions that have it.
    """
    if not re.fullmatch("[a-z0-9-]{1,60}", notebook):
        return {}
    name = f"variants/{notebook}-{variant}.json" if variant else f"{notebook}.json"
    text = next((file.read_text("utf8") for folder in places() if (file := folder / name).is_file()), None)
    if text is None and variant:
        from .elsewhere import fetched

        text = next((fetched(file, name) for folder in places() if (file := folder / ELSEWHERE).is_file()), None)
    if text is None:
        return {}
    data = json.loads(text)
    if data["format"] not in (3, FORMAT):
        from .. import __version__

        raise RuntimeError(
            f"The sealed questions of {notebook} are of format {data['format']}, and this is coursework {__version__}, "
            f"which reads formats 3 and {FORMAT}. Install the package that came with the notebook: "
            "`python -m coursework update exercises.zip` says how."
        )
    if data["format"] == 3:
        return {name: {**about, "format": 3} for name, about in data["questions"].items()}
    return data["questions"]


def places():
    """Where sealed questions may lie: the folder ``sealed`` beside the notebook, and those of plug-ins."""
    beside = Path("sealed")
    return [*([beside] if beside.is_dir() else []), *sealed_folders()]


def find_question(name):
    """Give a question by its full name, in the variant of whoever works here; a sibling by its own name.

    Raises
    ------
    NoSuchQuestion
    """
    if not isinstance(name, str):
        raise NoSuchQuestion(
            "The name of a question is a text and comes first: `check('notebook/question', answer)`. "
            f"This is of type `{type(name).__name__[:40]}`."
        )
    notebook, _, _ = name.partition("/")
    questions = notebook_questions(notebook)
    asked, order = without_sibling(name)
    if asked in questions:
        siblings = siblings_of(asked, questions[asked].get("variants", 1))
        if order > len(siblings):
            there = f"its siblings are {' and '.join(siblings)}" if siblings else "it has no other numbers"
            raise NoSuchQuestion(f"There is no '{name[:80]}': of '{asked}', {there}.")
        return in_variant(asked, own_variant(asked, questions[asked], order))
    found = [file.name for folder in places() for file in folder.iterdir()]
    if not found:
        raise NoSuchQuestion(
            f"There is no question '{name[:80]}', and no other: the folder `sealed` that came with this notebook is "
            "not "
            f"beside it (in {Path.cwd()}), and no package with sealed questions is installed."
        )
    if now := _moved().get(asked):
        raise NoSuchQuestion(f"'{asked}' is called '{now}' in this edition: write that name into `check(...)`.")
    notebooks = sorted(file.removesuffix(".json") for file in found if file.endswith(".json") and file != MOVED)
    if name in notebooks:
        raise NoSuchQuestion(f"'{name}' is a notebook. Its questions are {', '.join(map(repr, questions))}.")
    named = questions or notebook_questions(notebook.lower())
    near = difflib.get_close_matches(name.lower(), [*named, *notebooks], 1, 0.5)
    raise NoSuchQuestion(f"There is no question '{name[:80]}'." + (f" Did you mean '{near[0]}'?" if near else ""))


def _moved():
    """The names that questions have now, by those that they had in earlier editions."""
    files = (folder / MOVED for folder in places())
    return {
        old: new for file in files if file.is_file() for old, new in json.loads(file.read_text("utf8"))["moved"].items()
    }


def own_number(name):
    """The number of the variant in which a question, or a sibling of one, is found here; 0 where there is only one."""
    asked, order = without_sibling(name)
    questions = notebook_questions(name.partition("/")[0])
    return own_variant(asked, questions[asked], order) if asked in questions else 0


def beside(question, first):
    """What of a sealed variant differs from the first one: that is all that is kept of it.

    Its pages are those that the first one has not, and follow upon them.

    >>> beside({'kind': 'vector', 'salt': 'b', 'shown': {'arm': '2'}}, {'kind': 'vector', 'salt': 'a', 'ladder': []})
    {'salt': 'b', 'shown': {'arm': '2'}, 'ladder': None}
    """
    return {name: question.get(name) for name in {**question, **first} if question.get(name) != first.get(name)}


def in_variant(name, number):
    """A sealed question in a variant: the first one, with what :func:`beside` kept of the variant."""
    notebook, _, _ = name.partition("/")
    whole = dict(notebook_questions(notebook)[name])
    if number:
        own = notebook_questions(notebook, number)[name]
        whole |= {**own, "pages": [*whole.get("pages", []), *(own.get("pages") or [])]}
    return {part: about for part, about in whole.items() if about is not None}


def judge(name, question, plain):
    """Compare an answer, as plain data, with what is sealed.

    Returns
    -------
    tuple (Reply, dict)
        The reply, and what the answer opened: hints, the worked solution, hints for another question.
    """
    if question.get("exam"):
        reply = compare(name, question, plain, None)
    else:
        find, for_others = functools.partial(opened, question), functools.partial(is_right_for_others, question, plain)
        reply = compare(name, question, plain, find, for_others)
    return reply, reply.opened


def salt_of_all(name):
    """The salt that all variants of a question have in common: for what is right in one of them."""
    return hashlib.sha256(f"{name}, all variants".encode()).hexdigest()[:16]


def is_right_for_others(question, plain):
    """Whether a wrong answer is right in some other variant of the question, as a classmate's pasted one is."""
    if "others" not in question:
        return False
    salt, names = question["others"]
    common = {**question, "salt": salt}
    try:
        text = fingerprint(common, read(common, plain))
    except (Blank, Fault, Undecidable):
        return False
    return sealing.is_among(names, sealing.slow_key(salt, text))


def code_text(code):
    """What is hashed of a code that opens worked solutions, however it is typed."""
    return "code " + "".join(letter for letter in code.upper() if letter in CODE_LETTERS)


def rung_key(question, number):
    """The key of a step of the ladder of hints: no secret, it only keeps the step from being read in passing."""
    seed = f"step {number} for {question['kind']}"
    return hashlib.sha256(seed.encode()).digest()[: sealing.PAGE_KEY]


def opened(question, text):
    """What the locker of a fingerprint holds, or ``None``."""
    key = sealing.slow_key(question["salt"], text)
    found = sealing.open_locker(question["lockers"], key)
    if found is None:
        return None
    outcome, page, inside = found
    if page is not None:
        return {**open_page(question, page, inside), "page": [page, inside.hex()]}
    if question.get("format") == 3:
        notes = format_3.mistakes_in(inside, question)
    else:
        known, unknown = by_short_name(question), ["authored", {"text": NOT_IN_THIS_CATALOGUE}]
        notes = [known.get(name, unknown) for name in sealing.mistakes_in(inside)]
    return {"cases": [{"outcome": OUTCOMES[outcome], "notes": notes}]}


def open_page(question, page, key):
    """What stands on a page; ``key`` as bytes or as the digits that another page holds."""
    return sealing.unseal(question["pages"][page], bytes.fromhex(key) if isinstance(key, str) else key)


def solution_on(question, content):
    """The worked solution that a page holds, as HTML.

    That of a variant is what differs from words that all variants have in common, on a page of their own.
    """
    solution = content["solution"]
    if isinstance(solution, str):
        return solution
    *place, short = solution
    return sealing.lengthen(short, open_page(question, *place)["words"])


def compare(name, question, plain, find, for_others=lambda: False):
    """Compare an answer, as plain data, with what is known of a question. Gives the reply.

    Parameters
    ----------
    name : str
    question : dict
        The public part of the question.
    plain : dict
    find : function or None
        ``None`` where there is nothing to compare with, as in an exam: then only the form of the answer is looked at.
        It gives what is known of a fingerprint, or ``None``: a dictionary whose ``"cases"`` are each an outcome with
        its notes and, where answers have a tolerance, the numbers that it is meant for.
    for_others : function, optional
        It says of an answer that is not known whether it is right for other numbers.
    """
    try:
        reading = read(question, plain)
        if kinds()[question["kind"]].by_a_person:
            words = len(reading.text.split())
            said = f"A person will read this text of {words} {'word' if words == 1 else 'words'} and decide."
            return Reply(name, "undecided", "for a person", [said])
        text = fingerprint(question, reading)
        if find is None:
            reply = _taken_down(name, question, reading)
        else:
            reply = _compare(name, question, plain, reading, text, find, for_others)
        reply.answer = hashlib.sha256(text.encode()).hexdigest()[:12]
        return reply
    except Blank:
        return Reply(name, "not attempted", "", ["Put your answer in place of the `...` and run the cells again."])
    except Fault as found:
        return Reply(name, "invalid", found.note, [found.message])
    except Undecidable as found:
        return Reply(
            name, "undecided", "undecidable", [f"{found} Try another form, or ask your instructor to look at it."]
        )


def _taken_down(name, question, reading):
    found = fault(question, reading)
    if found:
        return Reply(name, "invalid", found.note, [found.message])
    return Reply(
        name,
        "recorded",
        "",
        [
            "Your answer can be read, and has the form that is asked for. It is marked later: nothing that you have "
            "tells whether it is right."
        ],
    )


def _compare(name, question, plain, reading, text, find, for_others):
    content = find(text)
    case = _case_of(question, reading, content)
    found = fault(question, reading) if case is None or case["outcome"] == "correct" else None
    if found and (case is None or found.note in ALWAYS_WRONG):
        # What comes of rounding is not called a fault of geometry.
        said = "" if found.note == "stray symbol" else _decimals(question, plain, reading) or _coarse(question, reading)
        return Reply(name, "invalid", found.note, [said, found.message] if said else [found.message])
    if case is None:
        reply = _not_known(name, question, plain, reading, find, content, for_others)
        slip, _, mistake = reply.note.partition(", and ")
        # What is right once a slip is undone twice is the right answer itself, but for the last digits.
        return _close(name, question) if mistake and slip == mistake else reply
    if case["outcome"] == "correct":
        return Reply(name, "correct", opened=content)
    reply = Reply(name, "wrong", case["notes"][0][0], _messages(question, case), opened=case)
    reply.opened = {**case, "page": content.get("page")}
    reply.details = case["notes"][0][1]
    return reply


def _close(name, question):
    """The reply to an answer that rounding has made wrong, or seems to have."""
    allowed = "" if question.get("tolerance") is None else f" the {question['tolerance']:g} that is"
    said = (
        f"This is close, but off by more than{allowed} allowed. Was it rounded too far, here or on the way? "
        "Keep all digits until the end."
    )
    return Reply(name, "wrong", "rounded too far", [said])


def _messages(question, case):
    """What is said of a mistake: of several that lead to one answer the first, since each of them is true of it."""
    note, details = case["notes"][0]
    return [message(question, note, details)]


def _case_of(question, reading, content):
    """Which of the cases in a locker an answer is: the nearest, if that is near enough; or ``None``."""
    if content is None:
        return None
    nearest, least = None, None
    for case in content["cases"]:
        far = _far(question, reading, case)
        if least is None or far < least:
            nearest, least = case, far
    return nearest if least <= 1 else None


def _far(question, reading, case):
    if not case.get("numbers"):
        return 0
    return distance(question, canonical(question, reading), [MP.mpf(number) for number in case["numbers"]])


def _not_known(name, question, plain, reading, find, content, for_others):
    """The reply to an answer that is neither right nor a mistake of the catalogue."""
    if content is not None and any(
        case["outcome"] == "correct" and _far(question, reading, case) <= CLOSE for case in content["cases"]
    ):
        return _close(name, question)
    decimals = _decimals(question, plain, reading)
    # Each look costs a slow hash: what is exact was not rounded, and what was rounded is no known mistake to the digit.
    precise, rounded = _precision(plain) if decimals else (True, False)
    near = [fingerprint(question, reading, near=True)] if decimals and not precise else []
    others = [] if rounded else list(other_readings(question, reading))
    texts = near + [fingerprint(question, turned) for _, _, turned in others]
    right_for_others, *found = _each([for_others, *(functools.partial(find, one) for one in texts)])
    if right_for_others:
        return Reply(name, "wrong", OTHER_NUMBERS, [FOR_OTHERS])
    if near and found.pop(0) is not None:
        return Reply(
            name,
            "wrong",
            "rounded too far",
            [
                "This agrees with the exact answer to about three digits, but the question asks for an exact answer.",
                decimals,
            ],
        )
    for (slip, why, turned), content in zip(others, found):
        case = _case_of(question, turned, content)
        if case and case["outcome"] != "correct":
            said = _messages(question, case)[0]
            reply = Reply(name, "wrong", f"{slip}, and {case['notes'][0][0]}", [f"Two things at once: {why} {said}"])
            reply.details = case["notes"][0][1]
            return reply
    # Whoever has rounded right work hears of that first, and not that the value is wrong.
    few = "" if decimals else _few_digits(question, plain)
    right = what_can_be_said(question, plain)
    said = [decimals, few, f"If not: {right[:1].lower()}{right[1:]}" if few and right else right]
    return Reply(name, "wrong", "", [" ".join(filter(None, said))])


def _each(looks):
    """What comes of each look. The slow hash lets other threads run: all looks are taken at once."""
    if len(looks) > 1:
        with suppress(RuntimeError), ThreadPoolExecutor(len(looks)) as threads:  # a browser's Python has no threads
            return [found.result() for found in [threads.submit(look) for look in looks]]
    return [look() for look in looks]


def other_readings(question, reading):
    """The answer with one common slip undone, by what is said of the slip: it may be a known mistake then."""
    if reading.text is None:
        for name, (said, undo) in kind_of_values(question).slips.items():
            numbers = [undo(question, numbers) for numbers in reading.numbers]
            if None not in numbers:
                yield name, said, Reading(numbers)


def _decimals(question, plain, reading):
    exact = question.get("tolerance") is None and reading.text is None
    if not exact or not any(node[0] == "float" for node in plain["nodes"]):
        return ""
    exact_forms = "`sm.Rational(1, 2)` and `sm.sqrt(3)`"
    return f"It holds decimal fractions, but the question asks for an exact answer: write {exact_forms}."


def _few_digits(question, plain):
    """What is said of numbers that are given to fewer places than the answer may be off by: they may be rounded.

    It follows from what the student wrote and from the tolerance alone, so it tells nothing of the right answer.
    """
    if question.get("tolerance") is None:
        return ""
    absolute, relative = (float(part) for part in tolerances(question))
    for node in plain["nodes"]:
        if node[0] == "float" and "e" not in node[1]:
            places = len(node[1].partition(".")[2].rstrip("0"))
            allowed = absolute + relative * abs(float(node[1]))
            if 0.5 * 10.0**-places > allowed and Fraction(node[1]).denominator > 4:
                count = f"{places} place{'' if places == 1 else 's'}"
                return (
                    f"Was this rounded? `{float(node[1]):g}` has {count} after the point, and an answer may be off by "
                    f"{allowed:.1g} at most: if so, keep all digits until the end."
                )
    return ""


def _coarse(question, reading):
    """What is said of numbers that do not fit together, and would if fewer of their digits counted."""
    if question.get("tolerance") is None or fault({**question, "tolerance": COARSE}, reading):
        return ""
    return "The numbers nearly fit together. Were they rounded too far? Keep all digits until the end."


def _precision(plain):
    """Of the decimal fractions of an answer: whether each is plainly exact, and whether one of them is plainly rounded.

    >>> numbers = lambda *texts: {"nodes": [["float", text] for text in texts]}
    >>> _precision(numbers("0.5", "0.8660254037844386")), _precision(numbers("0.5", "0.866"))
    ((True, False), (False, True))
    """
    precise, rounded = True, False
    for node in plain["nodes"]:
        if node[0] == "float":
            size = abs(float(node[1]))
            short = float(f"{size:.8g}") == size
            most = SMALL if short else LARGE
            numbers = [size] if short else [size, size * size]  # a root of a fraction has all of its digits
            if not any(abs(one - Fraction(one).limit_denominator(most)) <= 1e-13 * max(1, one) for one in numbers):
                precise, rounded = False, rounded or short
    return precise, rounded


def what_can_be_said(question, plain):
    """What a wrong answer has right, so that its author does not look for the fault there."""
    said = kind_of_values(question).wrong
    named = {node[1] for node in plain["nodes"] if node[0] == "symbol"}
    missing = [symbol for symbol in question.get("symbols", {}) if not {symbol, *spellings(symbol)} & named]
    if question.get("every symbol") and named and missing:
        said += f" It holds no {' and no '.join(f'`{symbol}`' for symbol in missing)}."
    return said
