"""What a student was asked, kept beside what the student answered.

A question may be mended in mid-term, a variant of it taken out, a call of a function exchanged. An
answer is judged by what its author saw all the same: a `Case` names the variant by what is
given in it, not by its number, and the contract, the question as it stood then, by its version.
Contracts lie in the folder of results, one file each.
"""

import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from ...checking.fields import by_name, many
from ...checking.variants import names_of_variants, numbers_of_variants, siblings_of, text_of
from ..record import Case, Place, Record
from ..store import write
from .contract import Asked, Contract
from .journal import Decision, digest_of_answer


class Contracts:
    """The questions as they stood when answers were judged by them.

    Parameters
    ----------
    folder : path
        The folder of results.
    """

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder, "contracts")
        self._known: dict[str, Contract] = {}
        self._kept: set[str] = set()

    def keep(self, contract: Contract) -> None:
        """Keep a question; it holds right answers, so that nobody
        else on this machine may read it.
        """
        path = self._path(contract.version)
        if contract.version not in self._kept and not path.exists():
            write(path, json.dumps(contract.as_json(), ensure_ascii=False), private=True)
        self._kept.add(contract.version)

    def of(self, version: str) -> Contract | None:
        """The question of a version, or ``None`` if nobody kept it."""
        if version not in self._known:
            path = self._path(version)
            if path.exists():
                self._known[version] = Contract.from_json(
                    json.loads(path.read_text("utf8")), str(path)
                )
        return self._known.get(version)

    def _path(self, version: str) -> Path:
        return self.folder / f"{version}.json"


def answered(case: Case, asked: Asked) -> Case:
    """The same case, once a notebook was run and asked for this: what
    was mended by then is its contract.
    """
    versions = {name: contract.version for name, contract in asked.second_chances.items()}
    siblings = {
        name: Place(place.variant, versions.get(name, place.contract))
        for name, place in case.siblings.items()
    }
    return replace(case, own=Place(case.own.variant, asked.contract.version), siblings=siblings)


def variants_of(variants: Sequence[Contract]) -> dict[str, Contract]:
    """The variants of a question by their names, in the order of their numbers.

    A name follows from what is given in a variant, so it is the same wherever in the order the
    variant stands, and whatever of its solution, hints and worth was mended.
    """
    return dict(zip(names_of_variants(one.variant for one in variants), variants, strict=True))


def case_by_rule(name: str, variants: Sequence[Contract], identity: str) -> Case:
    """The case of a student who is asked this question now."""
    order = numbers_of_variants(identity, name, variants[0].variant, len(variants))
    names, first = list(variants_of(variants)), variants[0]
    places = [Place(names[number], variants[number].version) for number in order]
    # In an exam each has one question.
    siblings = [] if first.question.exam else siblings_of(name, len(names))
    how = "by name, of" if first.variant.names else f"number {order[0]} of"
    return Case(
        name,
        places[0],
        dict(zip(siblings, places[1:], strict=False)),
        f"{how} {len(names)}" if len(names) > 1 else "",
        first.variant.edition,
    )


def questions_in(path: Path) -> dict[str, tuple[Contract, ...]]:
    """The questions of a notebook as they were worked out, each in all its variants, by name.

    Raises
    ------
    Misread
    """
    return by_name(many(Contract.from_json))(json.loads(path.read_text("utf8")), str(path))


def judged_alike(one: Contract | None, other: Contract | None) -> bool:
    """Whether answers are judged by two contracts alike.

    Of a question that nobody kept nothing is known, and so nothing is said against it.
    """
    return (
        one is None or other is None or one.version == other.version or one.judging == other.judging
    )


def changed_since(decided: Decision | None, record: Record, contracts: Contracts) -> str:
    """What is another thing than when a person decided: ``"answer"``, ``"question"`` or nothing.

    On another answer a decision does not count; on one that is judged otherwise by now it does,
    until somebody decides again, and both are shown.
    """
    if decided is None or decided.question not in record.marks:
        return ""
    if decided.answer != digest_of_answer(record, decided.question):
        return "answer"
    now = record.marks[decided.question].version
    return "" if judged_alike(contracts.of(decided.contract), contracts.of(now)) else "question"


def case_of(
    name: str,
    editions: Sequence[Sequence[Contract]],
    identity: str,
    contracts: Contracts,
    shows: Callable[[str], bool],
) -> Case:
    """The case of a student whose work was never graded, where the source had other variants at
    other times: the variant that the notebook shows, or else that of today.

    Parameters
    ----------
    name : str
    editions : sequence
        The variants of today, and those of other times.
    identity : str
    contracts : Contracts
        Keeps what is the student's and not in the source any more.
    shows : function
        Whether the notebook shows a text.
    """
    cases: dict[str, Case] = {}
    texts: dict[str, str] = {}
    for number, variants in enumerate(editions):
        case = case_by_rule(name, variants, identity)
        own = variants_of(variants)
        if case.own.variant in cases or (
            cases and case.edition != next(iter(cases.values())).edition
        ):
            continue
        rule = f"{case.rule}, as the source was before" if number else case.rule
        cases[case.own.variant] = replace(case, rule=rule)
        texts[case.own.variant] = text_of(own[case.own.variant].variant)
        for place in (case.own, *case.siblings.values()):
            contracts.keep(own[place.variant])
    shown = [variant for variant, text in texts.items() if text and shows(text)]
    variant = shown[0] if len(shown) == 1 else next(iter(cases))
    others = tuple(case.own for other, case in cases.items() if other != variant)
    return replace(cases[variant], others=others)


def asked_of(
    name: str, variants: Sequence[Contract], case: Case, contracts: Contracts | None
) -> Asked:
    """The question of a case as it is judged now: mended if its variant is
    still there, or else as it stood.
    """
    by_their_names = variants_of(variants)

    def at(place: Place) -> Contract:
        version = place.judged or place.contract
        found = by_their_names.get(place.variant) or (contracts and contracts.of(version))
        if not found:
            raise ValueError(
                f"{name}: one of its variants was removed and no copy of it was kept (contract "
                f"{version} is missing). Put the variant back into the source, and judge again."
            )
        return found

    own = at(case.own)
    before = (
        contracts.of(case.own.contract) if contracts and own.version != case.own.contract else None
    )
    others = [Asked(at(place)) for place in case.others if place.variant != case.own.variant]
    if not case.siblings and len(variants) == 1:
        return Asked(own, before, others=tuple(others))
    siblings = [one for variant, one in by_their_names.items() if variant != case.own.variant]
    return Asked(
        own,
        before,
        tuple(siblings),
        {sibling: at(place) for sibling, place in case.siblings.items()},
        tuple(others),
    )
