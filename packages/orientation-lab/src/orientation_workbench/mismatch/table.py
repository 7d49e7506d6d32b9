"""Every way in which two programs can mean different things by their numbers, in one table.

A *reading* says what the numbers of one side mean, as one choice from each group of its kind. A
*relation* says how the orientation of the second side follows from that of the first:

$$
\\mathbf{M}_2 = \\mathbf{P}\\,\\mathbf{M}_1\\,\\mathbf{Q}
\\quad\\text{or}\\quad
\\mathbf{M}_2 = \\mathbf{P}\\,\\mathbf{M}_1^T\\,\\mathbf{Q},
$$

with signed permutations $\\mathbf{P}$ (axes of the body, which are the rows) and $\\mathbf{Q}$
(axes of the world, the columns). Each departure from what is expected is a *fault*. What both sides
do alike, such as writing the scalar last, is not a fault. A chain costs one for each fault, plus
its ``rarity``, which is 0 for what many programs do and above 1 for what no known program does; the
cheapest chain comes first. Page, command and Python share this table, so that nothing is defined
twice.
"""

import functools
import itertools

import numpy as np

from orientation import PROPER_EULER, SEQUENCES
from orientation.mixups import CONJUGATE, REVERSED, SCALAR_LAST, TRANSPOSE, wrong_sign

from ..programs import PROGRAMS, expected_of
from .spelling import SPELLING

#: The most faults that one chain may have.
MOST_FAULTS = 3

COUNTS = {
    "matrix": 9,
    "quaternion": 4,
    "Euler angles": 3,
    "rotation vector": 3,
    "axis and angle": 4,
}


def choice(value, words, rarity, faults=1):
    return {"value": value, "words": words, "faults": faults, "rarity": rarity}


def _orders():
    known = {"wxyz": 0.0, "xyzw": 0.0, "wzyx": 1.1, "zyxw": 1.1, "xywz": 1.0}
    words = {
        "wxyz": "the scalar part comes first (w, x, y, z)",
        "xyzw": f"{SCALAR_LAST} (x, y, z, w)",
    }
    return [
        choice(
            order,
            words.get(order, f"the four numbers are stored as {', '.join(order)}"),
            known.get(order, 1.2),
        )
        for order in map("".join, itertools.permutations("wxyz"))
    ]


def _sequences():
    common = {"zyx": 0.1, "xyz": 0.15, "zxy": 0.2, "yxz": 0.25, "zxz": 0.3, "zyz": 0.3}
    return [
        choice(
            sequence,
            f"the sequence of rotations is {'-'.join(sequence)}",
            common.get(sequence, 0.6 if sequence in PROPER_EULER else 0.4),
        )
        for sequence in SEQUENCES
    ]


_ORDINAL = ("first", "second", "third")


def _places():
    words = {
        "123": "the angles are printed in the order of the rotations",
        "321": f"{REVERSED}, the last rotation first",
    }
    for places in map("".join, itertools.permutations("123")):
        order = ", ".join(_ORDINAL[int(digit) - 1] for digit in places)
        other = f"the angles are printed in another order: {order} rotation"
        yield choice(places, words.get(places, other), {"123": 0.0, "321": 0.1}.get(places, 0.5))


def _signs():
    for signs in map("".join, itertools.product("+-", repeat=3)):
        negative = [which for which, sign in zip(_ORDINAL, signs) if sign == "-"]
        words = wrong_sign(*negative) if negative else "the signs are as they should be"
        yield choice(signs, words, 0.2, len(negative))


_UNIT = {
    "group": "unit",
    "choices": [
        choice("radians", "the angles are in radians", 0.0),
        choice("degrees", "the angles are in degrees", 0.0),
    ],
}

#: The group of choices that says whether Euler angles are body fixed or space fixed.
TURNS = "axes of the turns"

#: What the numbers of one side may mean: the groups of each kind and the choices of each group. The
#: choice that a side declares, or else this book's, is not a fault.
KINDS = {
    "matrix": [],
    "quaternion": [{"group": "order", "choices": _orders()}],
    "Euler angles": [
        {"group": "sequence", "choices": _sequences()},
        {
            "group": TURNS,
            "choices": [
                choice(
                    "body fixed",
                    "each rotation is about an axis of the rotated frame (body fixed)",
                    0.0,
                ),
                choice("space fixed", "each rotation is about a fixed axis (space fixed)", 0.0),
            ],
        },
        {"group": "places", "choices": list(_places())},
        {"group": "signs", "choices": list(_signs())},
        _UNIT,
    ],
    "rotation vector": [_UNIT],
    "axis and angle": [
        {
            "group": "place of the angle",
            "choices": [
                choice("last", "the angle comes after the axis", 0.0),
                choice("first", "the angle comes before the axis", 0.0),
            ],
        },
        _UNIT,
    ],
}

#: This book's choice in each group. No sequence is a default, so to determine one is a finding.
BOOK = {
    "order": "wxyz",
    TURNS: "body fixed",
    "places": "123",
    "signs": "+++",
    "unit": "radians",
    "place of the angle": "last",
}

#: Departures that are not a mix-up between two programs if both make them.
SHARED = (
    ("order", "xyzw"),
    (TURNS, "space fixed"),
    ("unit", "degrees"),
    ("place of the angle", "first"),
)

#: The inverse orientation, in terms of the numbers that were pasted.
INVERSE = {
    "matrix": f"one is {TRANSPOSE}",
    "one matrix": "the columns of the matrix are the body's axes, as in SciPy (in this book "
    "its rows are); or the other numbers are the inverse",
    "quaternion": f"one is {CONJUGATE}",
    "Euler angles": "one is the inverse orientation",
    "rotation vector": "one is the rotation in the opposite sense",
    "axis and angle": "one is the rotation in the opposite sense",
}


@functools.cache
def axes_matrix(names):
    """Return the signed permutation whose rows are the named axes.

    ``('y', 'x', '-z')`` is NED in terms of ENU, and ENU in terms of NED.
    """
    return tuple(
        tuple((name[-1] == axis) * (-1 if name.startswith("-") else 1) for axis in "xyz")
        for name in names
    )


def _by_axes(words):
    return {tuple(names.split()): said for names, said in words.items()}


#: Well-known namings of axes: how the second program names what the first calls x, y and z.
BODY_AXES = _by_axes(
    {
        "x -y -z": "y and z of the body reversed (FRD and FLU; OpenCV's camera and OpenGL's)",
        "-x -y z": "x and y of the body reversed (OpenCV's camera and PyTorch3D's)",
        "-x y -z": "x and z of the body reversed",
        "-y -z x": "the body's axes forward, left, up, versus those of a camera, right, "
        "down, forward",
        "z -x -y": "the camera's axes right, down, forward, versus those of a body, "
        "forward, left, up",
        "x z -y": "the body's y up versus z up",
        "x -z y": "the body's z up versus y up",
        "y z x": "the body's axes cyclically shifted by one place",
        "z x y": "the body's axes cyclically shifted by two places",
        "-y x z": "the camera's axes down, right, back (LLFF) versus right, up, back",
    }
)
WORLD_AXES = _by_axes(
    {
        "y x -z": "north, east, down (NED) versus east, north, up (ENU)",
        "x -y -z": "y and z of the world reversed (NED and NWU)",
        "-x -y z": "x and y of the world reversed",
        "-x y -z": "x and z of the world reversed",
        "x z -y": "the world's y up versus z up",
        "x -z y": "the world's z up versus y up",
        "y z x": "the world's axes cyclically shifted by one place",
        "z x y": "the world's axes cyclically shifted by two places",
        "y -x z": "north, west, up (NWU) versus east, north, up (ENU)",
        "-y x z": "east, north, up (ENU) versus north, west, up (NWU)",
    }
)


def signed_axes():
    """Yield all 48 ways of naming three axes, as names and matrix."""
    for letters in itertools.permutations("xyz"):
        for signs in itertools.product(("", "-"), repeat=3):
            names = tuple(sign + letter for sign, letter in zip(signs, letters))
            yield names, axes_matrix(names)


SAME_AXES = ("x", "y", "z")


def axes_choice(names, body):
    """Return the cost and wording if one side names its axes so."""
    if names == SAME_AXES:
        return choice(names, "", 0.0, 0)
    known = (BODY_AXES if body else WORLD_AXES).get(names)
    whose = "body" if body else "world"
    if known:
        return choice(names, known, 0.1)
    reversed_ones = [name[-1] for name in names if name.startswith("-")]
    if tuple(name[-1] for name in names) == SAME_AXES:
        those = " and ".join(reversed_ones) if len(reversed_ones) < 3 else "all axes"
        return choice(names, f"{those} of the {whose} reversed", 0.3)
    # The handedness of the axes says nothing about how likely a program is: nobody picks either by
    # accident.
    return choice(
        names, f"the {whose}'s axes x, y, z are called {', '.join(names)} by the other program", 0.6
    )


def relations(mirrored=False):
    """Return all relations of two orientations by signed axes, cheapest first.

    Each is in its cheapest description.

    With ``mirrored``, return those in which exactly one side has a left-handed triad, so that the
    determinants differ.
    """
    best = {}
    all_axes = [
        (names, axes_choice(names, True), axes_choice(names, False)) for names, _ in signed_axes()
    ]
    hand = {names: left_handed(names) for names, *_ in all_axes}
    for inverse in (False, True):
        for body, of_body, of_world in all_axes:
            for world, *others in all_axes:
                if (hand[body] != hand[world]) != mirrored:
                    continue
                both_reversed = body == world and _reverses_one(body)
                if both_reversed:
                    faults, rarity = 1, 0.1
                else:
                    # The rows of an inverse are the world's axes, so describe them as the world's.
                    two = (of_world, others[0]) if inverse else (of_body, others[1])
                    faults = sum(axes["faults"] for axes in two)
                    rarity = sum(axes["rarity"] for axes in two)
                faults += inverse
                if faults > MOST_FAULTS:
                    continue
                key = (inverse, *_canonical(body, world))
                entry = (faults, rarity, inverse, body, world, both_reversed)
                if key not in best or entry[:2] < best[key][:2]:
                    best[key] = entry
    return [
        {"faults": f, "rarity": r, "inverse": inverse, "body": body, "world": world, "hand": both}
        for f, r, inverse, body, world, both in sorted(
            best.values(), key=lambda entry: (entry[:2], entry[2:5])
        )
    ]


def left_handed(names):
    """Check whether axes named so form a left-handed triad."""
    return bool(np.linalg.det(axes_matrix(names)) < 0)


def _reverses_one(names):
    return (
        tuple(name[-1] for name in names) == SAME_AXES
        and sum(name.startswith("-") for name in names) == 1
    )


def _canonical(body, world):
    """Return one representative of a pair of axes and its negative, which act alike."""
    if body[0].startswith("-"):
        return tuple(map(_opposite, body)), tuple(map(_opposite, world))
    return body, world


def _opposite(name):
    return name[1:] if name.startswith("-") else f"-{name}"


#: Directions and their opposites.
OPPOSITES = {
    "forward": "back",
    "left": "right",
    "up": "down",
    "back": "forward",
    "right": "left",
    "down": "up",
}


def _axes_of(second, first):
    """Return one side's axes in terms of the other's: ``('x', '-y', '-z')`` for FRD and FLU."""
    if not (first and second):
        return SAME_AXES
    return tuple(
        "xyz"[first.index(way)] if way in first else "-" + "xyz"[first.index(OPPOSITES[way])]
        for way in second
    )


def expected_relation(first, second, kinds):
    """Return the relation that two programs' manuals predict: inverse, and both sides' axes.

    Parameters
    ----------
    first, second : dict or None
        As `orientation_workbench.programs.expected_of` returns them; unless both are given, no
        difference is expected.
    kinds : tuple of two str
        The kind of each side's numbers.
    """
    if not (first and second):
        return False, SAME_AXES, SAME_AXES
    axes = _axes_of(second["body"], first["body"]), _axes_of(second["world"], first["world"])
    turned = [kind in side["inverse"] for kind, side in zip(kinds, (first, second))]
    # The second program's matrix is the transpose of the intended one, so world and body change
    # places.
    return turned[0] != turned[1], *(axes[::-1] if turned[1] else axes)


def beyond(relation, expected):
    """Return ``relation`` applied on top of the expected one, with its own words."""
    inverse, body, world = expected
    if relation["inverse"]:
        body, world = world, body
    return relation | {
        "inverse": relation["inverse"] != inverse,
        "body": _after(relation["body"], body),
        "world": _after(relation["world"], world),
        "said": relation,
    }


def _after(names, others):
    """Return the axes after renaming them twice, first by ``others`` and then by ``names``."""
    renamed = dict(zip("xyz", others))
    return tuple(
        _opposite(renamed[name[-1]]) if name.startswith("-") else renamed[name] for name in names
    )


def words_of(relation, kinds, swapped=False):
    """Return the faults of a relation, each as a phrase.

    ``swapped`` says that the second side's numbers are the inverse of what is meant. Then the rows
    of its matrix are the world's axes, and body and world change places.
    """
    kind = "one matrix" if kinds.count("matrix") == 1 else kinds[1]
    said = [INVERSE[kind]] if relation.get("said", relation)["inverse"] else []
    if inside := relation.get("inside"):
        return [_words_inside(*inside), *said]
    relation = relation.get("said", relation)
    said += [
        f"a constant rotation on the {whose}'s side, as if an instrument were mounted askew"
        for whose in ("body", "world")
        if relation.get(f"{whose} turn") is not None
    ]
    if relation["hand"]:
        axis = next(name[-1] for name in relation["body"] if name.startswith("-"))
        return [*said, f"opposite handedness: {axis} is reversed in the world and on the body"]
    body, world = (relation["body"], relation["world"])[:: -1 if swapped else 1]
    # Reversing all signs of both does the same: prefer known axes, then right-handed ones.
    body, world = min(
        ((body, world), (tuple(map(_opposite, body)), tuple(map(_opposite, world)))), key=_strange
    )
    named = axes_choice(body, True), axes_choice(world, False)
    return said + [option["words"] for option in named if option["words"]]


def _strange(axes):
    options = axes_choice(axes[0], True), axes_choice(axes[1], False)
    cost = sum(option["faults"] + option["rarity"] for option in options)
    return round(cost, 6), left_handed(axes[0])


def _words_inside(what, read, built, places):
    if what == "quaternion":
        return (
            f"an intermediate quaternion was stored as {', '.join(read)} and read as "
            f"{', '.join(built)}, or vice versa"
        )
    put = f"{'-'.join(built)} (body fixed), taking them in the order {', '.join(places)}"
    put = {
        "123": f"{'-'.join(built)} (body fixed)",
        "321": f"{'-'.join(built[::-1])} (space fixed)",
    }.get(places, put)
    return (
        f"intermediate angles were computed as {'-'.join(read)} (body fixed) and combined as {put}"
    )


#: Whether the numbers of a side are the inverse of this book's, by the words of the options. For a
#: matrix, the words say whether its rows or columns are the body's axes.
WAYS = {"rows": False, "columns": True, "body in world": False, "world in body": True}


def second_is_inverse(relation, kinds, ways):
    """Return all possible answers to whether the second side's numbers are inverted, as a tuple.

    Parameters
    ----------
    relation : dict
    kinds : tuple of two str
    ways : tuple of two (bool or None)
        Whether each side gives the inverse, if known. If nothing is known of a quaternion or of
        angles, they are taken to be those of the body in the world.
    """
    likely = [None if kind == "matrix" else False for kind in kinds]
    one, other = (usual if way is None else way for way, usual in zip(ways, likely, strict=True))
    inverse = relation["inverse"]
    if one is None and other is None:
        return (inverse, not inverse)
    if one is None or other is None or one ^ other == inverse:
        return (one ^ inverse if other is None else other,)
    if None in ways and ways != (None, None):
        return (ways[0] ^ inverse if ways[1] is None else ways[1],)
    return (not other, other)


def readings(kind, declared, degrees_likely=False):
    """Return all readings of one kind with at most three faults.

    Each has its choices, faults, rarity and words.

    Parameters
    ----------
    kind : str
        A key of `KINDS`.
    declared : dict
        The known choices of the program, by group; the others are as in `BOOK`.
    degrees_likely : bool
        Whether a number exceeds a whole turn in radians, so that degrees are expected.
    """
    base = BOOK | ({"unit": "degrees"} if degrees_likely else {}) | declared
    names = [group["group"] for group in KINDS[kind]]
    plausible = []
    for options in itertools.product(*(group["choices"] for group in KINDS[kind])):
        chosen = dict(zip(names, options))
        choices = {name: option["value"] for name, option in chosen.items()}
        other = {name: option for name, option in chosen.items()
                 if base.get(name) != option["value"]}  # fmt: skip
        # A choice that nothing declares is a finding, not a fault.
        wrong = [name for name in other if name in base]
        faults = sum(other[name]["faults"] or 1 for name in wrong)
        if faults <= MOST_FAULTS:
            plausible.append({
                "kind": kind, "choices": choices, "faults": faults,
                "rarity": sum((option["rarity"] for option in other.values()), 0.0),
                "words": [option["words"] for option in other.values()],
                "shared": sum(1 << SHARED.index((name, choices[name])) for name in wrong
                              if (name, choices[name]) in SHARED),
                "codes": _codes(choices, base, declared),
            })  # fmt: skip
    return plausible


def _codes(choices, base, declared):
    """Return numbers for unit and sequence, which must not change silently between the sides.

    They are the unit (0 if there is none, or if it is a fault already) and whether it is declared;
    the letters of the sequence, its letters as a body fixed one, and whether it is declared.
    """
    unit, letters = choices.get("unit"), choices.get("sequence")
    usual = unit == base.get("unit")
    space_fixed = choices.get(TURNS) == "space fixed"
    return (
        ("radians", "degrees").index(unit) + 1 if unit and usual else 0,
        int("unit" in declared),
        SEQUENCES.index(letters) + 1 if letters else 0,
        SEQUENCES.index(letters[::-1] if space_fixed else letters) + 1 if letters else 0,
        int("sequence" in declared),
    )


def changed(codes, others):
    """Count how many of unit and sequence differ between two readings unless both are declared."""
    one, other = (np.moveaxis(np.asarray(each), -1, 0) for each in (codes, others))
    units = (one[0] * other[0] > 0) & (one[0] != other[0]) & (one[1] * other[1] == 0)
    letters = (one[2] * other[2] > 0) & (one[2] != other[2]) & (one[3] != other[3])
    return 1 * units + (letters & (one[4] * other[4] == 0))


def of_both(first, second):
    """Return the faults, rarity and words of two readings; what both do alike is no fault."""
    alike = first["shared"] & second["shared"]
    faults = first["faults"] + second["faults"] - 2 * alike.bit_count()
    faults += int(changed(first["codes"], second["codes"]))
    common = [
        option["words"] for bit, (group, value) in enumerate(SHARED) if alike >> bit & 1
        for option in _choices(group) if option["value"] == value
    ]  # fmt: skip
    words = [
        f"in the {side} numbers {said}"
        for side, reading in (("first", first), ("second", second))
        for said in reading["words"]
        if said not in common
    ]
    (unit, known, *_), (other, too, *_) = first["codes"], second["codes"]
    if unit * other and unit != other and not known * too:
        said = ["radians", "degrees"][:: other - unit]
        words.append(f"the first numbers are in {said[0]}, the second in {said[1]}")
    return faults, first["rarity"] + second["rarity"] + 0.1 * alike.bit_count(), words


def _choices(group):
    return next(
        choice["choices"]
        for groups in KINDS.values()
        for choice in groups
        if choice["group"] == group
    )


#: The last line of a list of descriptions.
NONE_OF_THESE = (
    "None of these? Then these poses hide some other fault: paste more poses, rotated about all "
    "axes."
)
#: Rotations that a reader can make with an object in the hand: the words for each, and the
#: rotations about the body's own axes.
FURTHER_POSES = (
    ("rotate it by about 40 degrees about its x axis", (("x", 40),)),
    ("rotate it by about 30 degrees about its y axis", (("y", 30),)),
    ("rotate it by about 50 degrees about its z axis", (("z", 50),)),
    (
        "rotate it by about 40 degrees about its x axis, then by about 25 about its own y axis",
        (("x", 40), ("y", 25)),
    ),
    (
        "rotate it by about 50 degrees about its z axis, then by about 30 about its own y axis, "
        "then by about 20 about its own x axis",
        (("z", 50), ("y", 30), ("x", 20)),
    ),
)


_CARD = "chapters/convention-card.html"
_FOUR_QUESTIONS = (f"{_CARD}#four-questions", "The convention card")
_THE_WAY_BACK = ("chapters/simple-orientations.html#the-way-back", "The way back")
_A_KNEE = ("exercises/cases-from-practice.html#a-knee-from-two-boxes", "A knee, from two boxes")
_A_SHAFT = (
    "exercises/unit-quaternions.html#a-shaft-turning-clockwise",
    "A shaft turning clockwise",
)

#: Where the book teaches what was mixed up, by the group of a reading or the part of a relation:
#: the section, and checked questions that have this very fault among their mistakes. An inverse is
#: listed by the kind of numbers pasted.
TAUGHT = {
    "order": (_FOUR_QUESTIONS, ("exercises/convention-card.html#two-messages", "Two messages")),
    "sequence": (
        ("chapters/euler-angles.html#the-twelve-sequences", "The twelve sequences"),
        (
            "exercises/back-from-a-matrix.html#three-machines-one-set-of-angles",
            "Three machines, one set of angles",
        ),
    ),
    "axes of the turns": (
        ("chapters/euler-angles.html#body-fixed", "Body fixed"),
        ("exercises/convention-card.html#angles-from-scipy", "Angles from SciPy"),
    ),
    "places": (
        ("chapters/successive-orientations.html#order-matters", "Order matters"),
        ("exercises/convention-card.html#eight-lines-of-code", "Eight lines of code"),
    ),
    "signs": (
        (
            "chapters/simple-orientations.html#who-has-turned-you-or-the-vector",
            "Who has turned, you or the vector?",
        ),
        _A_KNEE,
    ),
    "unit": (
        _FOUR_QUESTIONS,
        (
            "exercises/cases-from-practice.html#which-way-is-the-phone-pointing",
            "Which way is the phone pointing?",
        ),
    ),
    "place of the angle": (
        ("chapters/axis-and-angle.html#a-direction-that-stays", "Axis and angle"),
        ("exercises/axis-and-angle.html#a-folding-bicycle", "A folding bicycle"),
    ),
    "inverse matrix": (
        _THE_WAY_BACK,
        ("exercises/orientation-with-sympy.html#two-makers-tables", "Two makers' tables"),
    ),
    "inverse quaternion": (
        _FOUR_QUESTIONS,
        (
            "exercises/orientation-from-sensors.html#three-instruments-three-conventions",
            "Three instruments, three conventions",
        ),
        ("exercises/convention-card.html#an-old-spacecraft", "An old spacecraft"),
    ),
    "inverse Euler angles": (_THE_WAY_BACK, _A_KNEE),
    "inverse rotation vector": (_THE_WAY_BACK, _A_SHAFT),
    "inverse axis and angle": (_THE_WAY_BACK, _A_SHAFT),
    "body": (
        (f"{_CARD}#frames-of-the-earth-and-of-machines", "Frames of the Earth and of machines"),
        (
            "exercises/direction-cosine-matrices.html#a-phone-at-the-windscreen",
            "A phone at the windscreen",
        ),
    ),
    "world": (
        (f"{_CARD}#frames-of-the-earth-and-of-machines", "Frames of the Earth and of machines"),
        (
            "exercises/reference-frames.html#where-is-north-a-phone-finds-out",
            "Where is north? A phone finds out",
        ),
    ),
    "hand": (
        (
            "chapters/reference-frames.html#can-numbers-tell-left-from-right",
            "Can numbers tell left from right?",
        ),
        ("exercises/convention-card.html#a-game-engine", "A game engine"),
    ),
    "turn": ((f"{_CARD}#exercises", "Hand and eye"), _A_KNEE),
}


def whole_table():
    """Return the table as plain data, for the page."""
    return {
        "format": 1,
        "most faults": MOST_FAULTS,
        "kinds": KINDS,
        "book": BOOK,
        "shared": SHARED,
        "opposites": OPPOSITES,
        "programs": {program: expected_of(program) for program in PROGRAMS},
        "spelling": SPELLING,
        "inverse": INVERSE,
        "ways": WAYS,
        "taught": TAUGHT,
        "further poses": [
            [words, [list(turn) for turn in turns]] for words, turns in FURTHER_POSES
        ],
        "none": NONE_OF_THESE,
        "body axes": [[list(names), words] for names, words in BODY_AXES.items()],
        "world axes": [[list(names), words] for names, words in WORLD_AXES.items()],
    }
