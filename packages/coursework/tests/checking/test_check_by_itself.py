"""A check's records, replies and offers for any verdict; the tests provide the judging."""

import sys
from dataclasses import replace
from types import SimpleNamespace

import pytest

from coursework.checking.check import DAY, NotCorrect
from coursework.checking.progress import Entry, Progress
from coursework.checking.question import KnownAnswer, Locker, Place, Question, Sealed, Variant
from coursework.checking.questions import OTHER_NUMBERS, code_text
from coursework.checking.reply import Reply

# The package exports the function under this name, so look up the module.
check_module = sys.modules["coursework.checking.check"]
check, hint = check_module.check, check_module.hint
ARM, SAW, WORDS = "levers/arm", "levers/see-saw", "texts/words"
EARNS = "Each new answer earns you a hint."


class Desk:
    """Questions with their pages, and the verdict on each answer by its text."""

    def __init__(self, patch):
        self.student, self.now, self.numbers = "ann", 10**9, {}
        self.questions = {
            ARM: Sealed(Question("expression"), worth=2, ladder=("one", "two", "three")),
            SAW: Sealed(Question("expression", variant=Variant(count=16)), worth=3),
            WORDS: Sealed(Question("free text"), worth=4),
        }
        for order in ("", "-2"):
            self.questions[f"{SAW}/sibling{order}"] = self.questions[SAW]
        self.pages = {}
        self.judged = {
            "right": ("correct", "", {}),
            "wrong": ("wrong", "", {}),
            "rounded": ("wrong", "rounded too far", {}),
            "others": ("wrong", OTHER_NUMBERS, {}),
            "half": ("wrong", "half", {}),
            "blank": ("not attempted", "", {}),
            "text": ("recorded", "taken", {}),
            "form": ("invalid", "shape", {}),
        }
        for name in (
            "identity", "find_question", "judge", "own_numbers", "notebook_questions", "open_page",
            "opened", "unseal", "rung_key", "solution_on", "time",
        ):  # fmt: skip
            patch.setattr(check_module, name, getattr(self, name))

    @property
    def time(self):
        return SimpleNamespace(time=lambda: self.now)

    def identity(self):
        return self.student

    def find_question(self, name, student):
        assert student == self.student
        if name not in self.questions:
            raise LookupError(name)
        return self.questions[name]

    def judge(self, name, sealed, plain, student):
        assert sealed is self.questions[name] and student == self.student
        text = plain["value"][1] if plain["value"][0] == "text" else "blank"
        outcome, note, more = self.judged.get(text.split()[0])
        reply = Reply(name, outcome, note, ["Said."], **more)
        reply.answer = f"{text}-digits" if outcome == "wrong" else ""
        return reply

    def own_numbers(self, name, student):
        assert student == self.student
        return self.numbers.get(name, (0, ""))

    def notebook_questions(self, notebook):
        if notebook == "gone":
            raise RuntimeError
        chosen = self.questions.items()
        return {
            name: selected
            for name, selected in chosen
            if name.startswith(f"{notebook}/") and "sibling" not in name
        }

    def open_page(self, sealed, place):
        assert sealed in self.questions.values() and isinstance(place, Place)
        return self.pages[place]

    def opened(self, sealed, fingerprint):
        assert sealed in self.questions.values()
        places = {code_text("ABCD"): Locker(solution="By hand"), code_text("EFGH"): Locker()}
        return places.get(fingerprint)

    def unseal(self, step, key):
        return f"Step {step} of {key}."

    def rung_key(self, question, number):
        return f"{question.kind} {number}"

    def solution_on(self, sealed, solution):
        assert sealed in self.questions.values()
        return f"<p>{solution}</p>"


@pytest.fixture
def desk(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("NBGRADER_EXECUTION", raising=False)
    return Desk(monkeypatch)


def entry_of(name=ARM):
    return Progress.read().entry(name)


# --- the record ---------------------------------------------------------------------------------


def test_what_is_right_is_remembered_and_stays_right(desk):
    desk.judged["right"] = ("correct", "", {"opened": Locker(solution="By hand")})
    reply = check(ARM, "right")
    assert (reply.messages, reply.solution) == (["Said."], "<p>By hand</p>")
    assert (reply.tries, reply.help, reply.sibling) == (1, "", "") and entry_of() == Entry(
        "correct"
    )
    again = check(ARM, "half")
    assert (again.tries, again.solution) == (2, "")
    assert entry_of() == Entry(
        "correct", "half", ("half-digits",), mistake="half", mistake_at=desk.now
    )
    assert check(ARM, "right").tries == 2 and entry_of().note == ""


def test_without_a_solution_none_is_shown(desk):
    desk.judged["right"] = ("correct", "", {"opened": Locker()})
    assert check(ARM, "right").solution == ""
    desk.judged["wrong"] = ("wrong", "", {"opened": Locker(solution="By hand")})
    assert check(ARM, "wrong").solution == ""


def test_each_different_answer_counts_once_and_earns_a_hint(desk):
    steps = [
        f"Hint: Step {step} of expression {k}." for k, step in enumerate(("one", "two", "three"))
    ]
    assert check(ARM, "wrong 1").messages == ["Said.", EARNS]
    assert check(ARM, "wrong 1").messages == ["Said.", EARNS] and entry_of().help == ""
    assert check(ARM, "wrong 2").messages == ["Said.", *steps[:1]] and entry_of().help == "hint"
    assert check(ARM, "wrong 3").messages == ["Said.", *steps[:2]]
    assert check(ARM, "wrong 4").messages == check(ARM, "wrong 5").messages == ["Said.", *steps]
    last = check(ARM, "wrong 1")
    assert last.tries == 5
    assert entry_of().answers == tuple(f"wrong {number}-digits" for number in range(1, 6))
    assert entry_of().mistake == "another value" and check(ARM, "right").help == "hint"
    # A question without hints announces none.
    assert check(SAW, "wrong").messages == check(SAW, "half").messages == ["Said."]


def test_of_many_answers_some_are_remembered(desk, monkeypatch):
    monkeypatch.setattr(check_module, "MOST_ANSWERS", 3)
    for number in range(5):
        reply = check(ARM, f"wrong {number}")
    assert reply.tries == 3


@pytest.mark.parametrize(
    ("answer", "expected"),
    [
        ("blank", Entry()),
        ("others", Entry("wrong", OTHER_NUMBERS)),
        ("form", Entry("invalid", "shape")),
        ("text", Entry("recorded", "taken")),
        ("rounded", Entry("wrong", "rounded too far", ("rounded-digits",))),
        ("wrong", Entry("wrong", "", ("wrong-digits",), mistake="another value")),
        ("half", Entry("wrong", "half", ("half-digits",), "mistake", mistake="half")),
    ],
)
def test_what_is_remembered_of_each_outcome(desk, answer, expected):
    reply = check(ARM, answer)
    entry = entry_of()
    assert entry.mistake_at == (desk.now if entry.answers else 0)
    assert entry.mistake == (expected.mistake or entry.note)[: 99 * len(entry.answers)]
    assert (entry.outcome, entry.note, entry.answers, entry.help) == (
        expected.outcome, expected.note, expected.answers, expected.help,
    )  # fmt: skip
    assert reply.messages == ["Said.", EARNS][: 1 + len(entry.answers)]
    assert reply.tries == len(entry.answers)


def test_an_answer_that_cannot_be_read_is_told_so(desk):
    reply = check(ARM, object())
    assert (reply.question, reply.outcome, reply.note) == (ARM, "invalid", "unreadable")
    assert "cannot be read" in reply.messages[0] and entry_of().outcome == "invalid"


def test_a_function_is_called_as_its_question_says(desk):
    desk.questions[ARM] = Sealed(Question("function", calls=([2], [3]), result="expression"))
    seen = []
    check(ARM, lambda number: seen.append(number) or ...)
    assert seen[:2] == [2, 3]
    with pytest.raises(ModuleNotFoundError):
        check(ARM, lambda number: __import__("no_such_module"))
    with pytest.raises(LookupError):
        check("levers/none", 3)


def test_where_errors_count_what_is_not_right_is_one(desk, monkeypatch):
    monkeypatch.setenv("NBGRADER_EXECUTION", "1")
    for answer in ("right", "text"):
        check(ARM, answer)
    for answer in ("half", "form", "blank"):
        with pytest.raises(NotCorrect, match=f"{ARM}\nSaid"):
            check(ARM, answer)


def test_a_mistake_is_worth_another_look_until_it_is_right_some_days_later(desk):
    check(ARM, "half")
    for days, mistake in ((2.9, "half"), (3, "half"), (3.1, "")):
        desk.now = 10**9 + days * DAY
        check(ARM, "right")
        assert entry_of().mistake == mistake, days
    assert entry_of().mistake_at == 10**9


def test_a_right_answer_opens_hints_for_later_questions(desk):
    place, later_place = Place(1, "k"), Place(2, "l")
    after = {SAW: ("Think of it.",), WORDS: ("And of that.",)}
    for at, answer in ((None, "right"), (place, "wrong"), (place, "right"), (later_place, "right")):
        desk.judged[answer] = (
            ("correct" if answer == "right" else "wrong"),
            "",
            {"opened": Locker(after=after, place=at)},
        )
        check(ARM, answer)
        if at is None or answer == "wrong":
            assert entry_of(SAW) == Entry()
        elif at == place:
            assert entry_of(SAW) == Entry(after=((ARM, place),)) == entry_of(WORDS)
    assert entry_of(SAW).after == ((ARM, place), (ARM, later_place))
    check(ARM, "right")
    assert len(entry_of(SAW).after) == 2
    desk.judged["right"] = ("correct", "", {"opened": Locker(after={ARM: ("Own.",)}, place=place)})
    check(ARM, "right")
    assert entry_of() == Entry("correct", "", entry_of().answers, mistake="another value",
                           mistake_at=desk.now, after=((ARM, place),))  # fmt: skip
    desk.judged["right"] = (
        "correct",
        "",
        {"opened": Locker(after={WORDS: ("Own.",)}, place=place)},
    )
    check(WORDS, "right")
    assert entry_of(WORDS) == Entry(
        "correct", after=((ARM, place), (ARM, later_place), (WORDS, place))
    )
    desk.pages = {
        place: {"cases": [], "after": {SAW: ["Think of it."], ARM: ["Own."]}},
        later_place: {"after": {ARM: ["No."]}},
    }
    assert hint(SAW).messages == ["Hint: Think of it."]
    desk.pages[later_place] = {"after": {SAW: ["Again."]}}
    assert hint(SAW).messages == ["Hint: Think of it.", "Hint: Again."]
    for damaged in (
        {**desk.pages, place: 3},
        {later_place: desk.pages[later_place]},
    ):  # From an earlier release.
        desk.pages = damaged
        assert hint(SAW).messages == ["Hint: Again."]


def test_the_hints_of_the_last_mistake_come_first(desk):
    place, known = Place(1, "k"), KnownAnswer("mistake", hints=("Twice?",))
    desk.pages = {
        place: {"cases": [{"outcome": "mistake"}, {"outcome": "mistake", "hints": ["Twice?"]}]}
    }
    desk.judged["half"] = ("wrong", "half", {"opened": Locker(place=place), "known": known})
    check(ARM, "half 1")
    assert entry_of().page == place
    assert check(ARM, "half 2").messages == ["Said.", "Hint: Twice?"]
    assert check(ARM, "half 3").messages[-1] == "Hint: Step one of expression 0."
    desk.pages = {place: {"cases": [{"outcome": "mistake"}]}}
    assert hint(ARM).messages[0] == "Hint 1: Step one of expression 0."
    desk.pages = {}  # From an earlier release.
    assert hint(ARM).messages[0] == "Hint 1: Step one of expression 0."
    for more in ({"known": known}, {"opened": Locker(place=place), "known": KnownAnswer("mistake")},
                 {"opened": Locker(place=place)}):  # fmt: skip
        desk.judged["half"] = ("wrong", "half", more)
        check(ARM, "half 1")
        assert entry_of().page is None


# --- help ---------------------------------------------------------------------------------------

MORE = (
    "You can earn {} more. Pass what you have to `check`, even if you are not sure of it. "
    "Each different answer counts, but running the same one again does not."
)


def test_hints_that_are_earned_can_be_read_again(desk):
    reply = hint(ARM)
    assert (reply.question, reply.outcome, reply.note) == (ARM, "hints", "")
    assert reply.messages == ["There is no hint yet.", MORE.format(3)] and entry_of() == Entry()
    for number in range(3):
        check(ARM, f"wrong {number}")
    assert hint(ARM).messages == [
        "Hint 1: Step one of expression 0.",
        "Hint 2: Step two of expression 1.",
        MORE.format(1),
    ]
    for number in range(3, 9):
        check(ARM, f"wrong {number}")
    assert [line[:6] for line in hint(ARM).messages] == ["Hint 1", "Hint 2", "Hint 3"]
    assert hint(SAW).messages == ["There is no hint yet."] and entry_of(SAW) == Entry()


@pytest.mark.parametrize(
    ("outcome", "before", "after"),
    [
        ("wrong", "", "hint"),
        ("wrong", "mistake", "hint"),
        ("wrong", "hint", "hint"),
        ("wrong", "solution", "solution"),
        ("wrong", "?", "hint"),
        ("correct", "", ""),
    ],
)
def test_reading_a_hint_is_help_until_the_answer_is_right_or_there_was_more(
    desk, outcome, before, after
):
    entry = Entry(outcome, help=before, answers=("a", "b"))
    Progress.read().put({ARM: entry})
    hint(ARM)
    assert entry_of() == replace(entry, help=after)


GIVES_UP = "Read it, close it, and write it out for yourself."


def test_a_code_opens_the_worked_solution(desk):
    for code in ("abc", "efgh"):
        reply = check_module.worked_solution(ARM, code)
        assert (reply.question, reply.outcome, reply.note) == (ARM, "hints", "")
        assert (
            reply.messages[0].startswith("This code does not open a solution.")
            and not reply.solution
        )
    assert entry_of() == Entry()
    reply = check_module.worked_solution(ARM, "ab cd")
    assert (reply.question, reply.outcome, reply.note) == (ARM, "hints", "")
    assert reply.messages == [GIVES_UP] and reply.solution == "<p>By hand</p>"
    assert entry_of() == Entry(help="solution")
    check(ARM, "half")
    assert entry_of().help == "solution"


# --- progress -----------------------------------------------------------------------------------


def put(**entries):
    names = {"arm": ARM, "saw": SAW, "words": WORDS, "sibling": f"{SAW}/sibling", "gone": "gone/a"}
    Progress.read().put({names[name]: entry for name, entry in entries.items()})


def test_the_progress_of_who_has_begun_nothing(desk):
    reply = check_module.progress()
    assert (reply.question, reply.outcome, reply.note) == ("progress", "hints", "")
    assert reply.messages == ["You have not checked anything in this folder yet."]
    put(sibling=Entry("correct"), words=Entry(after=((ARM, Place(1, "k")),)))
    assert check_module.progress().messages == ["You have not checked anything in this folder yet."]


def test_the_progress_with_one_question(desk):
    put(arm=Entry("wrong"))
    reply = check_module.progress()
    assert reply.outcome == "hints" and reply.messages == [
        "You have tried 1 question: 0 right.",
        f"*levers*: 0 of 2 right, 0 of 5 points. Still open: `{ARM}`, `{SAW}`.",
    ]
    put(arm=Entry("correct"))
    reply = check_module.progress()
    assert (reply.question, reply.outcome, reply.note) == ("progress", "correct", "")
    assert reply.messages == [
        "You have tried 1 question: 1 right.",
        f"*levers*: 1 of 2 right, 2 of 5 points. Still open: `{SAW}`.",
    ]


def test_the_progress_with_several_questions(desk):
    put(saw=Entry("correct", help="hint"), words=Entry("recorded"), gone=Entry("wrong"))
    lines = check_module.progress().messages
    assert lines == [
        "You have tried 3 questions: 1 right.",
        "*gone*: 0 of 1 right, 0 of 1 point. Still open: `gone/a`.",
        f"*levers*: 1 of 2 right, 3 of 5 points. Still open: `{ARM}`.",
        f"*texts*: 0 of 1 right, 0 of 4 points. Recorded, to be marked later: `{WORDS}`.",
    ]
    put(gone=Entry("correct", help="hint"), arm=Entry("correct", help="hint"))
    lines = check_module.progress().messages
    assert lines[0] == "You have tried 4 questions: 3 right."
    assert lines[2] == "*levers*: 2 of 2 right, 5 of 5 points."
    put(saw=Entry("wrong"))
    lines = check_module.progress().messages
    assert lines[2] == f"*levers*: 1 of 2 right, 2 of 5 points. Still open: `{SAW}`."
    put(arm=Entry("invalid"))
    desk.questions["levers/a"] = desk.questions[ARM]
    still = "Still open: `levers/arm`, `levers/see-saw`, `levers/a`."
    assert check_module.progress().messages[2].endswith(still)


def test_a_mistake_of_some_days_ago_is_worth_another_look(desk):
    def looked(**about):
        put(arm=Entry("correct", **about))
        return check_module.progress().messages[2:]

    assert looked(mistake="half", mistake_at=desk.now - 2.9 * DAY) == []
    assert looked(mistake="half") == looked(mistake_at=desk.now - 5 * DAY) == []
    assert looked(mistake="half", mistake_at=desk.now - 3.5 * DAY) == [
        f"Look again at these, where you made a mistake: `{ARM}` (3 days ago: half)."
    ]
    put(saw=Entry("wrong", mistake="double", mistake_at=desk.now - 4 * DAY))
    [line] = check_module.progress().messages[2:]
    assert line.endswith(f"`{ARM}` (3 days ago: half), `{SAW}` (4 days ago: double).")
