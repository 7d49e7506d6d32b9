"""Explain what two programs mean differently by the numbers they give for the same poses."""

import itertools
import math
from typing import NamedTuple

import numpy as np

from orientation import dcm_from_axis_angle, nearest_dcm, random_orientations

from ..programs import expected_of, program_named
from . import search, table
from .meaning import dcms_from_numbers, numbers_from_dcms
from .mounting import mountings
from .table import TURNS
from .text import SLACK, read_poses

#: The most chains, and the most readings of the first side, for which we look for a pose that
#: distinguishes the chains; above that we ask for a pose of three rotations.
LOOKED_AT, READ_AS = 300, 60


class Name(NamedTuple):
    """A description of a mix-up: its condition, its faults, and what to declare if it holds."""

    condition: str
    faults: tuple[str, ...]
    declare: tuple


class Explanation(NamedTuple):
    """What `explain` found.

    ``verdict`` is ``'same'``, ``'named'``, ``'undecided'`` or ``'unrelated'``. ``chains`` holds one
    chain for each reading of the numbers that is left, simplest first, and ``faults`` the words of
    the first. ``further_pose`` says which pose would decide between them, and is empty if nothing
    is open. ``residual`` is the residual of the first chain, in degrees. ``mirrored`` names the
    side, ``'first'`` or ``'second'``, whose matrix alone has the determinant -1, and is empty if
    there is none. ``names`` are descriptions of the same relation that only a reader can choose
    between, by answering ``question``.
    """

    verdict: str
    faults: tuple[str, ...]
    residual: float | None
    chains: tuple
    further_pose: str
    poses: int
    mirrored: str
    names: tuple = ()
    question: str = ""
    remarks: tuple[str, ...] = ()

    @property
    def has_line(self) -> bool:
        """Whether one line of code turns the second side's numbers into the first's."""
        known = self.verdict == "named" or bool(self.names)
        return known and "inside" not in self.chains[0].relation

    def __str__(self) -> str:
        return "\n".join(sentences(self))


def explain(
    first,
    second,
    *,
    first_declared: dict | None = None,
    second_declared: dict | None = None,
    first_program: str | None = None,
    second_program: str | None = None,
    noise: float = 0.0,
) -> Explanation:
    """Name the mix-up between two programs from the numbers that they give for the same poses.

    Parameters
    ----------
    first, second : str, or array of shape ``(count,)``, ``(3, 3)`` or ``(poses, ...)``
        What each program gives. In text, anything smaller than the last digit counts as rounding.
        Arrays are taken to be exact to single precision.
    first_declared, second_declared : dict, optional
        What is known about a program, such as ``{'kind': 'Euler angles', 'sequence': 'zyx'}``: the
        groups and choices of `orientation_workbench.mismatch.table.KINDS`.
    first_program, second_program : str, optional
        Names from `orientation_workbench.programs.PROGRAMS`, or parts of them. What a program's
        manual says about its numbers is then not a mix-up; nor is, if both are named, a difference
        between their manuals.
    noise : float
        Radians by which the two may differ besides rounding.

    Returns
    -------
    Explanation

    Raises
    ------
    ValueError
        If numbers cannot be read as orientations, the two sides hold different numbers of poses, or
        a program is unknown.

    Examples
    --------
    >>> from orientation_workbench import explain
    >>> explain('0.7304 0.3604 0.2402 0.5284', '0.3604 0.2402 0.5284 0.7304').faults
    ('in the second numbers the scalar part comes last (x, y, z, w)',)
    """
    sides, programs = [], []
    for name, given, declared, program in (
        ("first", first, first_declared, first_program),
        ("second", second, second_declared, second_program),
    ):
        declared = declared or {}
        poses = read_poses(given, name, declared.get("kind"), noise)
        manual = expected_of(program_named(program)) if program else None
        if manual and "kind" not in declared and len(poses.kinds) == 2:
            poses = poses._replace(kinds=(manual["three numbers"],))
        programs.append(manual)
        # The text overrides the manual, and the reader overrides both.
        sides.append((poses, (manual["declared"] if manual else {}) | poses.declared | declared))
    counts = [len(poses.numbers) for poses, _ in sides]
    # Three rows that are not a matrix were read as three triples of angles.
    if sorted(counts) == [1, 3]:
        side = counts.index(3)
        sides[side] = (
            read_poses((first, second)[side], ("first", "second")[side], "matrix", noise),
            sides[side][1],
        )
        counts[side] = 1
    if counts[0] != counts[1]:
        raise ValueError(
            f"the first side has {counts[0]} pose{'s' * (counts[0] != 1)} and the second "
            f"{counts[1]}: give the same poses on both sides, in the same order"
        )
    one, other = (
        search.side(poses.kinds, poses.numbers, poses.half, declared, noise)
        for poses, declared in sides
    )
    kinds = [poses.kinds[0] for poses, _ in sides]
    ways = tuple(
        table.WAYS.get(declared.get("way"), kind in manual["inverse"] if manual else None)
        for (_, declared), kind, manual in zip(sides, kinds, programs, strict=True)
    )
    expected = table.expected_relation(*programs, kinds)
    special = any(_is_special(poses) for poses, _ in sides)
    chains, tried = search.chains(one, other, noise, expected, special)
    together = _classes(chains, sides) or [[chain] for chain in mountings(one, other, noise)[:1]]
    classes = _exact_first([members[0] for members in together])
    readings = list({id(chain.first): chain.first for chain in chains}.values())
    hands = [np.linalg.det(side.dcms[0, 0]) > 0 for side in (one, other)]
    mirrored = "" if hands[0] == hands[1] else ("first", "second")[hands.index(False)]
    if not classes:
        return Explanation("unrelated", (), None, (), "", counts[0], mirrored)
    best = classes[0]
    chance = _chance(best, one, tried)
    # For a special pose, some sequence nearly always gives the same numbers.
    exact = noise == 0 or chance < search.BY_CHANCE
    if best.faults == 0 and exact and not (special and best.words(ways)):
        verdict = "same"
    elif len(classes) > 1 or special or chance >= search.BY_CHANCE:
        verdict = "undecided"
    else:
        verdict = "named"
    names = ()
    if verdict == "named":
        alike = search.with_orders(best, one, other, noise, expected) + together[0]
        known = [declared.get("order") for _, declared in sides]
        names = _names(best, [chain for chain in alike if _usual_order(chain, known)], ways)
        verdict = "undecided" if names else "named"
    open_still = verdict == "undecided" or (verdict == "same" and len(classes) > 1)
    further = _further_pose(classes, readings, sides) if open_still and not names else ""
    residual = math.degrees(2 * math.asin(min(1.0, best.residual / 2)))
    return Explanation(
        verdict, tuple(best.words(ways)), residual, tuple(classes), further, counts[0], mirrored,
        names, _question(names, best), _normalised(sides)
    )  # fmt: skip


def _normalised(sides):
    """Return a remark for each side whose quaternions are not quite of length 1."""
    remarks = []
    for name, (poses, _) in zip(("first", "second"), sides, strict=True):
        lengths = np.linalg.norm(poses.numbers, axis=1)
        worst = float(lengths[np.argmax(np.abs(lengths - 1))])
        if poses.kinds == ("quaternion",) and abs(worst - 1) > SLACK + 2 * poses.half:
            remarks.append(
                f"A quaternion on the {name} side has length {worst:.6g}, not 1. We normalised it."
            )
    return tuple(remarks)


#: A reading goes behind those that fit exactly if its residual is more than this many times the
#: best one's, and above a thousandth.
EXACT = 20


def _exact_first(chains):
    limit = max(1e-3, EXACT * min((chain.residual for chain in chains), default=0.0))
    return sorted(chains, key=lambda chain: chain.residual > limit)


def _chance(best, first, tried):
    """Estimate how many chains of so few faults would fit as well by chance.

    This supposes that the second side's poses are unrelated, but move as far as the first side's.
    """
    dcms = first.dcms[next(k for k, reading in enumerate(first.readings) if reading is best.first)]
    gap = max(best.residual, search.SINGLE_PRECISION, min(first.doubts))
    moved = [max(search.motion(dcm[None]), 1e-9) for dcm in dcms]
    share = math.prod(
        min(1.0, (1.5 * gap) ** 3 / 6 / (angle - math.sin(angle) or 1e-27)) for angle in moved
    )
    return tried[: best.faults + 1].sum() * share


def _is_special(poses):
    """Check whether all poses share a property that leaves several readings open.

    That is an angle or component that is zero, or two that are equal, as in rotations about one
    axis, half turns and quarter turns.
    """
    sizes, near = np.abs(poses.numbers), 2 * poses.half + search.SINGLE_PRECISION
    pairs = itertools.combinations(range(sizes.shape[1]), 2)
    pairs = ((1, 3), (2, 6), (5, 7)) if sizes.shape[1] == 9 else pairs
    return bool((sizes <= near).all(axis=0).any()) or any(
        (np.abs(sizes[:, i] - sizes[:, j]) <= near).all() for i, j in pairs
    )


# --- descriptions between which only the reader can choose ----------------------------------------

#: A description is left out if it costs this much more than the simplest. The second limit holds if
#: only one of the two descriptions has both sides read in the same order.
DEARER, DEARER_ON_ONE_SIDE = 1.15, 0.4
#: The first limit if both sides are quaternions, in different orders.
DEARER_CROSSED = 1.7
_ORDERS = {"wxyz": "first", "xyzw": "last"}


def _names(best, others, ways):
    """Return descriptions of one relation that differ in a way only a reader can decide.

    They differ in axes, in sequences, or in which side's angles are space fixed; there are none if
    all agree.
    """
    names, seen = [], set()
    near = [
        chain
        for chain in others
        if _dearness(chain) - _dearness(best) <= _limit(chain, best) + 1e-6
        and _of_angles(chain)[0] == _of_angles(best)[0]
    ]
    for chain in [best, *near]:
        swaps = table.second_is_inverse(chain.relation, chain.kinds, ways)
        for which, second_inverse in enumerate(swaps):
            faults = tuple(chain.words(ways, which))
            upright = chain.relation.get("said", chain.relation) | {"inverse": False}
            axes = tuple(table.words_of(upright, chain.kinds, second_inverse))
            meant = axes, _of_angles(chain)
            if meant in seen:
                continue
            seen.add(meant)
            inverses = second_inverse ^ chain.relation["inverse"], second_inverse
            names.append(_name(chain, inverses, faults, len(swaps) > 1, best))
    return tuple(names) if len(names) > 1 else ()


def _usual_order(chain, known):
    """Check that the scalar parts are in their declared place, or else first or last."""
    orders = [reading["choices"].get("order") for reading in (chain.first, chain.second)]
    return all(
        order is None or order == declared or (declared is None and order in _ORDERS)
        for order, declared in zip(orders, known, strict=True)
    )


def _both(chain, group):
    """Return both sides' choices in a group if they differ."""
    chosen = [reading["choices"].get(group) for reading in (chain.first, chain.second)]
    return tuple(chosen) if None not in chosen and chosen[0] != chosen[1] else ()


def _of_angles(chain):
    """Return the group and the choices that only a reader can decide for two triples of angles.

    The choice is between their sequences unless one is declared, because the numbers stay the same
    if the axes of both sides are renamed alike; otherwise it is which of them is space fixed. Both
    are empty if there is nothing to choose.
    """
    declared = chain.first["codes"][-1] or chain.second["codes"][-1]
    for group in (TURNS,) if declared else ("sequence", TURNS):
        if choices := _both(chain, group):
            return group, choices
    return "", ()


def _limit(chain, best):
    # Whether both sides store a quaternion in the same order, or neither has one.
    shared, of_best = (
        each.first["choices"].get("order") == each.second["choices"].get("order")
        for each in (chain, best)
    )
    crossed = not of_best and set(best.kinds) == {"quaternion"}
    return (DEARER_CROSSED if crossed else DEARER) if shared == of_best else DEARER_ON_ONE_SIDE


def _dearness(chain):
    """Return a chain's cost, ignoring the direction of a matrix if the other side has none."""
    free = chain.relation["inverse"] and (chain.kinds.count("matrix") == 1)
    return chain.cost - free


def _name(chain, inverses, faults, by_way, best):
    """Return a description with its condition, and with what the reader can declare for it."""
    orders = [reading["choices"].get("order") for reading in (chain.first, chain.second)]
    declare, conditions = tuple({"order": order} if order else {} for order in orders), []
    if any(orders):
        where = " and ".join(
            f"{_ORDERS.get(order, order)} in the {side}"
            for side, order in zip(("first", "second"), orders, strict=True) if order
        )  # fmt: skip
        where = f"{_ORDERS[orders[0]]} in both" if orders[0] == orders[1] else where
        conditions.append(f"the scalar part comes {where}")
    if by_way:
        for side, inverse, kind in zip(declare, inverses, chain.kinds, strict=True):
            words = ("rows", "columns") if kind == "matrix" else ("body in world", "world in body")
            side["way"] = words[inverse]
        conditions.append(
            f"the body's axes are the {'columns' if inverses[0] else 'rows'} of the first matrix"
            if "matrix" in chain.kinds
            else f"the {'first' if inverses[0] else 'second'} side gives the world as seen from "
            "the body"
        )
    group, choices = _of_angles(chain)
    for side, chosen in zip(declare, choices):
        side[group] = chosen
    if group == TURNS:
        conditions.append(f"the first side's angles are {choices[0]} and the second's {choices[1]}")
    elif group:
        first, second = ("-".join(letters) for letters in choices)
        conditions.append(f"the first side's sequence is {first}")
        faults = (f"the second side's sequence is {second}",)
    return Name(" and ".join(conditions), faults, declare)


def _question(names, best):
    order, way, turns, sequence = (
        len({name.declare[0].get(what) for name in names}) > 1
        for what in ("order", "way", TURNS, "sequence")
    )
    asked = {
        "Which did one program pass to the other, angles or a quaternion?": any(
            "intermediate" in name.faults[0] for name in names
        ),
        "Does the scalar part of the quaternions come first or last?": order,
        "Are the body's axes the rows or the columns of the first matrix?": way
        and "matrix" in best.kinds,
        "Which side gives the inverse, the world as seen from the body?": way
        and "matrix" not in best.kinds,
        "Which side's rotations are about axes of the body (body fixed), and which side's about "
        "axes that stay fixed (space fixed)?": turns,
        "Which sequence of rotations does the first program use? The numbers stay the same if the "
        "axes of both programs are renamed in the same way.": sequence,
    }
    return " ".join(question for question, still_open in asked.items() if still_open)


# --- equivalent chains ----------------------------------------------------------------------------


def _classes(chains, sides):
    """Group chains that are equivalent for all numbers, simplest first."""
    classes, owner = [], {}
    samples = {
        kind: _samples(kind, sides[0][0]) for kind in {chain.first["kind"] for chain in chains}
    }
    for chain, keys in zip(chains, _predictions(chains, samples, 5)):
        members = next((owner[key] for key in keys if key in owner), None)
        if members is None:
            classes.append(members := [])
        members.append(chain)
        owner |= dict.fromkeys(keys - owner.keys(), members)
    return classes


def _predictions(chains, samples, decimals):
    """Return, as sets of keys, what each chain predicts for the second side from these numbers.

    Two chains that share a key are mathematically the same, if the numbers are not special. A chain
    may have two keys, because an orientation has two triples of Euler angles and a program may
    print either. Predictions are always written in one plain reading, whichever reading the chain
    has, so that the keys are comparable.
    """
    dcms, members = {}, {}
    for which, chain in enumerate(chains):
        if (reading := id(chain.first)) not in dcms:
            dcms[reading] = dcms_from_numbers(chain.first, samples[chain.first["kind"]])
        members.setdefault(id(chain.second), []).append(which)
    keys = [None] * len(chains)
    for those in members.values():
        second = chains[those[0]].second
        predicted = np.concatenate(
            [_related(chains[which].relation, dcms[id(chains[which].first)]) for which in those]
        )
        plain = _plain_reading(second["kind"])
        rounded = [
            (
                np.round(dcms_from_numbers(plain, numbers).reshape(len(those), -1, 9), decimals)
                + 0.0
            ).tolist()
            for numbers in numbers_from_dcms(second, predicted)
        ]
        for place, which in enumerate(those):
            each_sample = zip(
                *([tuple(entries) for entries in written[place]] for written in rounded)
            )
            kinds = (chains[which].first["kind"], second["kind"])
            keys[which] = {(kinds, *combined) for combined in itertools.product(*each_sample)}
    return keys


def _related(relation, dcms):
    """Return the second side's orientations, given the first side's."""
    if inside := relation.get("inside"):
        dcms = search.after_inside(inside, dcms)
    left, right = (
        np.array(table.axes_matrix(relation["body"])),
        np.transpose(table.axes_matrix(relation["world"])),
    )
    return left @ (np.swapaxes(dcms, -1, -2) if relation["inverse"] else dcms) @ right


def _plain_reading(kind):
    groups = {group["group"] for group in table.KINDS[kind]}
    choices = table.BOOK | {"sequence": "zyx"}
    return {"kind": kind, "choices": {name: choices[name] for name in groups}}


def _samples(kind, poses):
    """Return numbers of one kind for two generic orientations."""
    dcms, plain = random_orientations(2, np.random.default_rng(20)), _plain_reading(kind)
    if kind == "matrix" and np.linalg.det(poses.numbers[0].reshape(3, 3)) < 0:
        dcms = -dcms
    if poses.large and "unit" in plain["choices"]:
        plain["choices"]["unit"] = "degrees"
    return numbers_from_dcms(plain, dcms)[0]


# --- the pose that decides ------------------------------------------------------------------------


def _further_pose(chains, readings, sides):
    """Describe a pose, starting from the last one, at which the remaining chains would disagree.

    Whichever chain is true, the object is rotated as described, but what the first program then
    gives depends on how its numbers are read. So the pose must decide under every reading of the
    first side that fits, including those that are equivalent to another.
    """
    # Starting from a special pose, a rotation or two leave zeros in one side's numbers.
    special = any(_is_special(poses) for poses, _ in sides)
    if special or len(chains) > LOOKED_AT or len(readings) > READ_AS or len(chains) == 1:
        return table.FURTHER_POSES[-1][0]
    for words, turns in table.FURTHER_POSES:
        if all(
            _tells_apart(chains, _turned(reading, sides[0][0].numbers[-1:], turns))
            for reading in readings
        ):
            return words
    return table.FURTHER_POSES[-1][0]


def _turned(reading, numbers, turns):
    """Return what the first program gives, by one reading, after rotations about body axes."""
    dcm = dcms_from_numbers(reading, numbers)[0]
    hand = 1.0 if np.linalg.det(dcm) > 0 else -1.0
    dcm = nearest_dcm(hand * dcm).dcm
    for axis, angle in turns:
        dcm = (
            dcm_from_axis_angle([float(axis == name) for name in "xyz"], math.radians(angle)) @ dcm
        )
    return {reading["kind"]: numbers_from_dcms(reading, hand * dcm[None])[0]}


def _tells_apart(chains, samples):
    keys = _predictions([chain for chain in chains if chain.first["kind"] in samples], samples, 2)
    return len(set().union(*keys)) == sum(map(len, keys))


# --- in words -------------------------------------------------------------------------------------


def sentences(explanation):
    """Yield the answer for a reader, one sentence at a time."""
    several = f"these {explanation.poses} poses" if explanation.poses > 1 else "this pose"
    left = len(explanation.chains)
    more = f"{left - 1} other reading{'s' * (left != 2)}"
    if explanation.verdict == "unrelated":
        yield (
            f"No explanation was found: no combination of up to {table.MOST_FAULTS} mix-ups fits "
            f"{several}."
        )
        if explanation.poses < 3:
            yield (
                "It takes at least three poses to show whether an instrument is mounted askew: "
                "paste more poses."
            )
        if explanation.mirrored:
            yield (
                f"The {explanation.mirrored} side's matrix has determinant -1: it is a mirror "
                "image, not a rotation."
            )
        return
    yield from explanation.remarks
    if explanation.names:
        yield (
            f"The numbers fit {len(explanation.names)} descriptions, and only you can say which is "
            f"yours. {explanation.question}"
        )
        for name in explanation.names:
            yield f"- {_condition(name)}{'; '.join(name.faults)}."
        yield f"- {table.NONE_OF_THESE}"
    elif explanation.verdict == "same":
        yield "Both sides give the same orientation" + (f" in {several}." if left > 1 else ".")
    elif explanation.verdict == "named":
        yield "The two sides differ by " + _count(explanation.faults) + ":"
    else:
        yield (
            f"These numbers do not determine the cause. The simplest explanation of {several} is "
            + _count(explanation.faults)
            + ":"
        )
    for fault in () if explanation.names else explanation.faults:
        yield f"- {fault}"
    if explanation.residual > 1e-3:
        yield f"The remaining difference is {explanation.residual:.2g} degrees."
    if explanation.further_pose:
        if left > 1:
            yield f"{more[0].upper()}{more[1:]} fit{'s' * (left == 2)} as well."
        yield f"To decide, {explanation.further_pose}, and paste that pose as well."


def _condition(name):
    """Return the condition, with the options that declare it to the command."""
    words = [
        f"--{side}-is " + (f'"{value}"' if " " in value else value)
        for side, declared in zip(("first", "second"), name.declare, strict=True)
        for value in declared.values()
    ]
    return f"If {name.condition} ({' '.join(words)}): " if words else ""


def _count(faults):
    return "one mix-up" if len(faults) == 1 else f"{len(faults)} mix-ups"
