"""The one line that mends a mix-up: in NumPy with SciPy, and as a formula.

Each line makes of ``second``, what the second program gives, what the first program gives for the
same pose.
"""

import numpy as np

from . import table


def _index(order, wanted):
    return [order.index(part) for part in wanted]


def _is_identity(names):
    return names == table.SAME_AXES


def _python_matrix(names):
    return "np.array(" + str([list(row) for row in table.axes_matrix(names)]) + ")"


def _turn(matrix):
    return "np.array(" + str(np.round(matrix, 6).tolist()) + ")"


def _signs(choices, name):
    if choices["signs"] == "+++":
        return name
    return f"({name} * np.array({[-1 if sign == '-' else 1 for sign in choices['signs']]}))"


def _letters(choices):
    return (
        choices["sequence"]
        if choices["axes of the turns"] == "space fixed"
        else choices["sequence"].upper()
    )


def _degrees(choices):
    return ", degrees=True" if choices["unit"] == "degrees" else ""


def _pick(name, places):
    return name if places == sorted(places) else f"{name}[{places}]"


def _read_in_python(reading, name):
    """Code for the matrix of this book, A_C_N, of what a program
    gives. SciPy's is its transpose.
    """
    kind, choices = reading["kind"], reading["choices"]
    if kind == "matrix":
        return name
    if kind == "quaternion":
        return f"Rotation.from_quat({_pick(name, _index(choices['order'], 'xyzw'))}).as_matrix().T"
    if kind == "Euler angles":
        angles = _signs(choices, _pick(name, [choices["places"].index(which) for which in "123"]))
        return (
            f"Rotation.from_euler({_letters(choices)!r}, {angles}{_degrees(choices)}).as_matrix().T"
        )
    if kind == "rotation vector":
        return f"Rotation.from_rotvec({name}{_degrees(choices)}).as_matrix().T"
    last = choices["place of the angle"] == "last"
    vector = f"{name}[3] * {name}[:3]" if last else f"{name}[0] * {name}[1:]"
    return f"Rotation.from_rotvec({vector}{_degrees(choices)}).as_matrix().T"


def _write_in_python(reading, matrix):
    """Code that writes a matrix of this book as a program does."""
    kind, choices = reading["kind"], reading["choices"]
    if kind == "matrix":
        return matrix
    # The transpose of a transpose is not written.
    bare = f"({matrix})" if "@" in matrix else matrix
    there = matrix[:-2] if matrix.endswith(".T") and "@" not in matrix else f"{bare}.T"
    if kind == "quaternion":
        return f"Rotation.from_matrix({there}).as_quat()" + _subscript(
            _index("xyzw", choices["order"])
        )
    if kind == "Euler angles":
        angles = f"Rotation.from_matrix({there}).as_euler({_letters(choices)!r}{_degrees(choices)})"
        return _signs(choices, angles) + _subscript([int(which) - 1 for which in choices["places"]])
    if kind == "rotation vector":
        return f"Rotation.from_matrix({there}).as_rotvec({_degrees(choices)[2:]})"
    vector = f"(v := Rotation.from_matrix({there}).as_rotvec({_degrees(choices)[2:]}))"
    size = "np.linalg.norm(v)"
    parts = [f"{vector} / {size}", f"[{size}]"]
    if choices["place of the angle"] == "first":
        parts = [f"[np.linalg.norm({vector})]", f"v / {size}"]
    return f"np.concatenate([{', '.join(parts)}])"


def _subscript(places):
    return "" if places == sorted(places) else f"[{places}]"


def _undo_in_python(relation, matrix):
    """Code for the first side's matrix, from code for the second's."""
    for whose in ("body", "world"):
        turn = relation.get(f"{whose} turn")
        if turn is not None:
            matrix = (
                f"{_turn(turn.T)} @ {matrix}" if whose == "body" else f"{matrix} @ {_turn(turn.T)}"
            )
    if not _is_identity(relation["body"]):
        matrix = f"{_python_matrix(relation['body'])}.T @ {matrix}"
    if not _is_identity(relation["world"]):
        matrix = f"{matrix} @ {_python_matrix(relation['world'])}"
    if relation["inverse"]:
        matrix = f"({matrix}).T" if "@" in matrix else f"{matrix}.T"
    return matrix.removesuffix(".T.T")


def python_line(chain):
    """One line of Python that gives what the first program gives, from ``second``."""
    relation, first, second = chain.relation, chain.first, chain.second
    plain = (
        _is_identity(relation["body"])
        and _is_identity(relation["world"])
        and "body turn" not in relation
    )
    if plain and first["kind"] == second["kind"] == "quaternion":
        places = _index(second["choices"]["order"], first["choices"]["order"])
        line = _pick("second", places)
        if relation["inverse"]:
            line += (
                f" * np.array({[1 if part == 'w' else -1 for part in first['choices']['order']]})"
            )
        return line
    return _write_in_python(first, _undo_in_python(relation, _read_in_python(second, "second")))


def formula(chain):
    """How the second program's matrix follows from the first's, with the
    signed permutations written out.
    """
    relation, parts = chain.relation, []
    for whose in ("body", "world"):
        rows = relation.get(f"{whose} turn")
        if rows is None and not _is_identity(relation[whose]):
            rows = np.array(table.axes_matrix(relation[whose]))
            rows = rows if whose == "body" else rows.T
        parts.append([] if rows is None else [_rows(rows)])
    return " ".join(["M2 =", *parts[0], "M1^T" if relation["inverse"] else "M1", *parts[1]])


def _rows(matrix):
    return (
        "["
        + ", ".join(
            "[" + ", ".join(f"{entry + 0:.6g}" for entry in row) + "]"
            for row in np.round(matrix, 4)
        )
        + "]"
    )
