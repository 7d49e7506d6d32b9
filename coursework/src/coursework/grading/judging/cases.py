"""What a student was asked, kept beside what the student answered.

A question may be mended in mid-term, a variant of it taken out, a call of a function exchanged. An answer is judged by
what its author saw all the same: a :class:`Case` names the variant by what is given in it, not by its number, and the
contract, the question as it stood then, by its version. Contracts lie in the folder of results, one file each.
"""

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from ...checking.variants import names_of_variants, numbers_of_variants, siblings_of
from ..store import write
from .ledger import Decision, digest_of_answer

#: All that marks need of a question, as :func:`coursework.grading.judging.marking.about` gives it.
Question = dict[str, Any]

#: How a case came to be known: by the rule when the work was graded, or later from a record that did not hold it.
AS_GRADED, FROM_THE_VERSION, BY_THE_RULE = "as graded", "from the version in an older record", "by the rule of today"


@dataclass(frozen=True)
class Place:
    """A variant of a question: its name, and the version of the question in it."""

    variant: str
    contract: str


@dataclass(frozen=True)
class Case:
    """What a student was asked.

    Attributes
    ----------
    question : str
    own : Place
    siblings : mapping of str to Place
        The other variants that may make good for help, by the names of the siblings.
    rule : str
        How the variant was found: ``"number 3 of 8"``, ``"by name, of 8"``, or empty where there is only one.
    edition : str
        Of the course: another one draws afresh.
    known : str
        How this is known.
    """

    question: str
    own: Place
    siblings: Mapping[str, Place] = field(default_factory=dict)
    rule: str = ""
    edition: str = ""
    known: str = AS_GRADED

    def as_json(self) -> dict[str, Any]:
        return asdict(self)

    def answered(self, asked: Question) -> "Case":
        """The same case, once a notebook was run and asked for this: what was mended by then is its contract."""
        siblings = {
            name: Place(place.variant, asked.get("second chances", {}).get(name, {}).get("version", place.contract))
            for name, place in self.siblings.items()
        }
        return replace(self, own=Place(self.own.variant, asked["version"]), siblings=siblings)

    @classmethod
    def from_json(cls, found: Mapping[str, Any]) -> "Case":
        siblings = {name: Place(**place) for name, place in found["siblings"].items()}
        return cls(**{**found, "own": Place(**found["own"]), "siblings": siblings})


def variants_of(question: Question) -> dict[str, Question]:
    """The variants of a question by their names, in the order of their numbers.

    A name follows from what is given in a variant, so it is the same wherever in the order the variant stands, and
    whatever of its solution, hints and worth was mended.
    """
    variants = [question, *question.get("others", [])]
    return dict(zip(names_of_variants(one["public"] for one in variants), variants, strict=True))


def edition_of_question(question: Question) -> str:
    return str(question["public"].get("edition", ""))


def case_by_rule(name: str, question: Question, identity: str, known: str = AS_GRADED) -> Case:
    """The case of a student who is asked this question now."""
    count = 1 + len(question.get("others", []))
    return _case(name, question, numbers_of_variants(identity, name, question["public"], count), known)


def _case(name: str, question: Question, order: Sequence[int], known: str) -> Case:
    """The case of whoever has the variants in this order."""
    variants = variants_of(question)
    names = list(variants)
    places = [Place(names[number], variants[names[number]]["version"]) for number in order]
    # In an exam each has one question.
    siblings = [] if question["public"].get("exam") else siblings_of(name, len(names))
    how = "by name, of" if question["public"].get("names") else f"number {order[0]} of"
    return Case(
        name,
        places[0],
        dict(zip(siblings, places[1:], strict=False)),
        f"{how} {len(names)}" if len(names) > 1 else "",
        edition_of_question(question),
        known,
    )


class Contracts:
    """The questions as they stood when answers were judged by them.

    Parameters
    ----------
    folder : path
        The folder of results.
    """

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder, "contracts")
        self.questions = Path(folder, "questions")
        self._older: dict[str, tuple[Question, Case]] | None = None
        self._known: dict[str, Question] = {}
        self._kept: set[str] = set()

    def keep(self, question: Question) -> None:
        """Keep a question; it holds right answers, so that nobody else on this machine may read it."""
        path = self._path(question["version"])
        if question["version"] not in self._kept and not path.exists():
            bare = {name: value for name, value in question.items() if name not in NOT_KEPT}
            write(path, json.dumps(bare, ensure_ascii=False), private=True)
        self._kept.add(question["version"])

    def of(self, version: str) -> Question | None:
        """The question of a version, or ``None`` if nobody kept it."""
        if version not in self._known:
            path = self._path(version)
            if path.exists():
                self._known[version] = json.loads(path.read_text("utf8"))
            elif version in self.older:
                self._known[version] = self.older[version][0]
        return self._known.get(version)

    @property
    def older(self) -> dict[str, tuple[Question, Case]]:
        """What was worked out before there were contracts, by version: each edition of a notebook lies here still."""
        if self._older is None:
            self._older = {}
            for name in sorted(os.listdir(self.questions)) if self.questions.is_dir() else ():
                if name.endswith(".json"):
                    for asked, question in json.loads((self.questions / name).read_text("utf8")).items():
                        variants = (question, *question.get("others", []))
                        for number, one in enumerate(variants):
                            order = [(number + further) % len(variants) for further in range(len(variants))]
                            self._older[one["version"]] = one, _case(asked, question, order, FROM_THE_VERSION)
        return self._older

    def _path(self, version: str) -> Path:
        return self.folder / f"{version}.json"


#: What of a question may change and an answer is judged by the same all the same.
SAID_OF_IT = ("version", "title", "text", "guessable", "secret", "rubric")


def judged_alike(one: Question | None, other: Question | None) -> bool:
    """Whether answers are judged by two questions alike: a word of the text may be another, or what a line is worth.

    Of a question that nobody kept nothing is known, and so nothing is said against it.
    """
    if one is None or other is None or one["version"] == other["version"]:
        return True

    def judging(question: Question) -> dict[str, Any]:
        public = {name: value for name, value in question["public"].items() if name not in ("text", "shown", "picture")}
        bare = {name: value for name, value in question.items() if name not in (*SAID_OF_IT, *NOT_KEPT)}
        return {**bare, "public": public, "rubric": list(question.get("rubric") or ())}

    return judging(one) == judging(other)


def changed_since(decided: Decision | None, record: Mapping[str, Any], contracts: Contracts) -> str:
    """What is another thing than when a person decided: ``"answer"``, ``"question"`` or nothing.

    On another answer a decision does not count; on one that is judged otherwise by now it does, until somebody decides
    again, and both are shown.
    """
    if decided is None or decided.question not in record["marks"]:
        return ""
    if decided.answer != digest_of_answer(record, decided.question):
        return "answer"
    now = record["marks"][decided.question]["version"]
    return "" if judged_alike(contracts.of(decided.contract), contracts.of(now)) else "question"


#: What belongs to the question of today, and not to one variant of it as it stood.
NOT_KEPT = ("others", "siblings", "second chances", "contract", "newer")


def case_of(record: Mapping[str, Any], name: str, question: Question, contracts: Contracts) -> Case | None:
    """The case of an answer that was graded; ``None`` if the question was not asked then.

    A record that was made before there were cases says by which version an answer was judged: that is one variant.
    """
    if "cases" in record:
        kept = record["cases"].get(name)
        return Case.from_json(kept) if kept else None
    mark = record.get("marks", {}).get(name)
    if mark is None:
        return None
    if mark["version"] in contracts.older:
        return contracts.older[mark["version"]][1]
    return case_by_rule(name, question, record["student"], BY_THE_RULE)


def asked_of(name: str, question: Question, case: Case, contracts: Contracts | None) -> Question:
    """The question of a case as it is judged now: mended if its variant is still there, or else as it stood.

    Beside what :func:`coursework.grading.judging.marking.about` gives there are ``"siblings"``, all other variants;
    ``"second chances"``, those that count in its place, by their names; and ``"contract"``, the question as it stood
    when it was answered, where that is another.
    """
    variants = variants_of(question)

    def at(place: Place) -> Question:
        found = variants.get(place.variant) or (contracts and contracts.of(place.contract))
        if not found:
            raise ValueError(
                f"{name}: a variant of it was taken out, and what it was is kept nowhere: there is no contract "
                f"{place.contract}. Put the variant back into the source, and judge again."
            )
        return found

    own = dict(at(case.own))
    before = contracts.of(case.own.contract) if contracts and own["version"] != case.own.contract else None
    if before is not None:
        own["contract"] = before
    if case.siblings or len(variants) > 1:
        own["siblings"] = [one for variant, one in variants.items() if variant != case.own.variant]
        own["second chances"] = {sibling: at(place) for sibling, place in case.siblings.items()}
    return own
