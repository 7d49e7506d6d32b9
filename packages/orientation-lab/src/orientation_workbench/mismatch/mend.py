"""Write one line that fixes a mix-up, in NumPy with SciPy, and as a formula.

Each line turns ``second``, which the second program gives, into what the first program gives for
the same pose.
"""

import numpy as np

from . import table


def _index(order, wanted):
    return [order.index(part) for part in wanted]


def _array(rows):
    return f"np.array({np.asarray(rows).tolist()})"


def _signs(choices, name):
    signs = [-1 if sign == "-" else 1 for sign in choices["signs"]]
    return name if -1 not in signs else f"({name} * np.array({signs}))"


def _letters(choices):
    space_fixed = choices["axes of the turns"] == "space fixed"
    return choices["sequence"] if space_fixed else choices["sequence"].upper()


def _degrees(choices):
    return ", degrees=True" if choices["unit"] == "degrees" else ""


def _pick(name, places):
    return name if places == sorted(places) else f"{name}[{places}]"


def _read_in_python(reading, name):
    """Return code for the book's matrix, A_C_N, of a program's numbers. SciPy transposes it."""
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
    """Return code that writes a matrix of this book as a program does."""
    kind, choices = reading["kind"], reading["choices"]
    if kind == "matrix":
        return matrix
    # Avoid writing the transpose of a transpose.
    bare = f"({matrix})" if "@" in matrix else matrix
    there = matrix[:-2] if matrix.endswith(".T") and "@" not in matrix else f"{bare}.T"
    if kind == "quaternion":
        return _pick(f"Rotation.from_matrix({there}).as_quat()", _index("xyzw", choices["order"]))
    if kind == "Euler angles":
        angles = f"Rotation.from_matrix({there}).as_euler({_letters(choices)!r}{_degrees(choices)})"
        return _pick(_signs(choices, angles), [int(which) - 1 for which in choices["places"]])
    vector = f"Rotation.from_matrix({there}).as_rotvec({_degrees(choices)[2:]})"
    if kind == "rotation vector":
        return vector
    if choices["place of the angle"] == "first":
        return f"np.concatenate([[np.linalg.norm((v := {vector}))], v / np.linalg.norm(v)])"
    return f"np.concatenate([(v := {vector}) / np.linalg.norm(v), [np.linalg.norm(v)]])"


def _undo_in_python(relation, matrix):
    """Return code for the first side's matrix, given code for the second's."""
    if relation.get("body turn") is not None:
        matrix = f"{_array(np.round(relation['body turn'].T, 6))} @ {matrix}"
    if relation.get("world turn") is not None:
        matrix = f"{matrix} @ {_array(np.round(relation['world turn'].T, 6))}"
    if relation["body"] != table.SAME_AXES:
        matrix = f"{_array(table.axes_matrix(relation['body']))}.T @ {matrix}"
    if relation["world"] != table.SAME_AXES:
        matrix = f"{matrix} @ {_array(table.axes_matrix(relation['world']))}"
    if relation["inverse"]:
        matrix = f"({matrix}).T" if "@" in matrix else f"{matrix}.T"
    return matrix.removesuffix(".T.T")


def python_line(chain):
    """Return one line of Python that computes what the first program gives from ``second``."""
    relation, first, second = chain.relation, chain.first, chain.second
    plain = relation["body"] == relation["world"] == table.SAME_AXES
    plain &= "body turn" not in relation
    if plain and first["kind"] == second["kind"] == "quaternion":
        order = first["choices"]["order"]
        signs = f" * np.array({[1 if part == 'w' else -1 for part in order]})"
        places = _index(second["choices"]["order"], order)
        return _pick("second", places) + signs * relation["inverse"]
    return _write_in_python(first, _undo_in_python(relation, _read_in_python(second, "second")))


def formula(chain):
    """Return a formula for the second program's matrix in terms of the first's."""
    relation, parts = chain.relation, []
    for whose in ("body", "world"):
        rows = relation.get(f"{whose} turn")
        if rows is None and relation[whose] != table.SAME_AXES:
            rows = np.array(table.axes_matrix(relation[whose]))
            rows = rows if whose == "body" else rows.T
        rows = [] if rows is None else np.round(rows, 4) + 0.0
        lines = [f"[{', '.join(f'{entry:.6g}' for entry in row)}]" for row in rows]
        parts.append([f"[{', '.join(lines)}]"] if lines else [])
    return " ".join(["M2 =", *parts[0], "M1^T" if relation["inverse"] else "M1", *parts[1]])
