"""The question that each student was asked, stored beside the student's answer.

An author may correct a question in mid-term, remove a variant or replace a function call. An answer
is nevertheless judged by what its author saw. A `Case` therefore identifies a variant by its
content, not by its number, and the contract, the question as it stood then, by its version. The
folder of results holds each contract in a file of its own.
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

    def keep(self, contract: Contract) -> None:
        """Store a question, readable by this user only since it contains the right answers."""
        path = self._path(contract.version)
        if not path.exists():
            write(path, json.dumps(contract.as_json(), ensure_ascii=False), private=True)

    def of(self, version: str) -> Contract | None:
        """Return the question of a version, or ``None`` if it was not stored."""
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
    """Return the case of a notebook just run for this question, with its current contract."""
    versions = {name: contract.version for name, contract in asked.second_chances.items()}
    siblings = {
        name: Place(place.variant, versions.get(name, place.contract))
        for name, place in case.siblings.items()
    }
    return replace(case, own=Place(case.own.variant, asked.contract.version), siblings=siblings)


def variants_of(variants: Sequence[Contract]) -> dict[str, Contract]:
    """Return the variants of a question by their names, in the order of their numbers.

    A name depends only on a variant's content, so it stays the same when variants are reordered, or
    when their solution, hints or worth are corrected.
    """
    return dict(
        zip(names_of_variants(variant.variant for variant in variants), variants, strict=True)
    )


def case_by_rule(name: str, variants: Sequence[Contract], identity: str) -> Case:
    """Return the case of a student who is asked this question now."""
    order = numbers_of_variants(identity, name, variants[0].variant, len(variants))
    names, first = list(variants_of(variants)), variants[0]
    places = [Place(names[number], variants[number].version) for number in order]
    # In an exam, each student has one question without siblings.
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
    """Return the processed questions of a notebook, each in all its variants, by name.

    Raises
    ------
    Misread
    """
    return by_name(many(Contract.from_json))(json.loads(path.read_text("utf8")), str(path))


def judged_alike(contract: Contract | None, other: Contract | None) -> bool:
    """Check whether two contracts judge answers in the same way.

    If either was not stored, we assume so.
    """
    return (
        contract is None
        or other is None
        or contract.version == other.version
        or contract.judging == other.judging
    )


def changed_since(decided: Decision | None, record: Record, contracts: Contracts) -> str:
    """Return what changed since a person decided: ``"answer"``, ``"question"`` or nothing.

    A decision does not count for a changed answer. For a changed question it counts until somebody
    decides again, and both versions are shown.
    """
    if decided is None or decided.question not in record.marks:
        return ""
    if decided.answer != digest_of_answer(record, decided.question):
        return "answer"
    then = contracts.of(decided.contract)
    now = contracts.of(record.marks[decided.question].version)
    return "" if judged_alike(then, now) else "question"


def case_of(
    name: str,
    editions: Sequence[Sequence[Contract]],
    identity: str,
    contracts: Contracts,
    shows: Callable[[str], bool],
) -> Case:
    """Choose the case of a student never graded, although the source has had other variants.

    This is the variant that the notebook shows, or else today's.

    Parameters
    ----------
    name : str
    editions : sequence
        Today's variants, and those of earlier times.
    identity : str
    contracts : Contracts
        Stores this student's variants, which the source may no longer have.
    shows : function
        Returns whether the notebook shows a text.
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
    """Return the question of a case as it is judged now.

    It is the corrected variant if the source still has it, or else the stored one.
    """
    by_their_names = variants_of(variants)

    def at(place: Place) -> Contract:
        version = place.judged or place.contract
        contract = by_their_names.get(place.variant) or (contracts and contracts.of(version))
        if not contract:
            raise ValueError(
                f"{name}: one of its variants was removed and no copy of it was kept (contract "
                f"{version} is missing). Put the variant back into the source, and judge again."
            )
        return contract

    own = at(case.own)
    before = (
        contracts.of(case.own.contract) if contracts and own.version != case.own.contract else None
    )
    others = [Asked(at(place)) for place in case.others if place.variant != case.own.variant]
    if not case.siblings and len(variants) == 1:
        return Asked(own, before, others=tuple(others))
    siblings = [
        sibling for variant, sibling in by_their_names.items() if variant != case.own.variant
    ]
    return Asked(
        own,
        before,
        tuple(siblings),
        {sibling: at(place) for sibling, place in case.siblings.items()},
        tuple(others),
    )
