"""Plain data: written answers verbatim, reading by an independent grammar, and all limits.

Records store what is written, so it must not change.
"""

import copy
import json
import re
from types import SimpleNamespace

import mpmath
import numpy as np
import pytest
import sympy as sm
import sympy.physics.mechanics as me
import sympy.physics.units as units

from coursework.checking import plain
from coursework.checking.evaluate import MP, number, values
from coursework.checking.plain import (
    NotPlain,
    read_plain,
    to_plain,
)

x, y, t = sm.symbols("x y t")
f = sm.Function("f")
N = me.ReferenceFrame("N")
A, B = N.orientnew("A", "Axis", [x, N.z]), me.ReferenceFrame("B")


class Unknown(sm.Function):
    def fdiff(self, place=1):
        raise ValueError("no derivative")


def of_module(module, **members):
    """Return an object of a class from some module, which need not exist."""
    return type("Stranger", (), {"__module__": module, **members})()


def frames(count):
    """Return a stand-in for the book's graph of frames, in which all but the last form a chain."""
    names = [f"F{place}" for place in range(count)]

    def dcm(self, target, source):
        if names[-1] in (target, source):
            raise ValueError("not connected")
        return sm.Matrix([[names.index(target), names.index(source)]])

    edges = [SimpleNamespace(frame=a, reference=b) for a, b in zip(names, [*names[1:], names[0]])]
    return of_module("orientation.frames", _edges=edges, dcm=dcm, reference_frames=None)


def written(answer, calls=None):
    """Return an answer's data on one line, with each part in place of its node's index."""
    data = read_plain(json.loads(json.dumps(to_plain(answer, calls))))
    messages = []
    for operation, *parts in data["nodes"]:
        parts = [messages[part] if type(part) is int else part for part in parts]
        messages.append(f"{operation}({', '.join(parts)})")

    def entered(value):
        match value:
            case ["expression", place]:
                return messages[place]
            case ["matrix", rows, columns, places]:
                return f"{rows}x{columns}: " + " ".join(messages[place] for place in places)
            case [*parts]:
                return [entered(part) for part in parts]
            case dict():
                return {name: entered(part) for name, part in value.items()}
        return value

    return entered(data["value"])


ONE, TWO, X, Y = "integer(1)", "integer(2)", "symbol(x)", "symbol(y)"


def listed(*parts):
    return ["list", list(parts)]


WRITTEN = [
    (7, "integer(7)"),
    (np.int64(-7), "integer(-7)"),
    (sm.Rational(-22, 7), "rational(-22, 7)"),
    (sm.Rational(-22, 7) * x, "Mul(rational(-22, 7), symbol(x))"),
    (0.1, "float(0.1)"),
    (np.float32(0.5), "float(0.5)"),
    (sm.Float(0.1), "float(0.1)"),
    (sm.Float("0.25", 30) * x, "Mul(float(0.25), symbol(x))"),
    (mpmath.mpf(1) / 3, "float(0.3333333333333333148296162562473909929395)"),
    (sm.Float(1 / 3) * x, "Mul(float(0.3333333333333333148296162562473909929395), symbol(x))"),
    (sm.pi, "constant(Pi)"),
    (sm.I, "constant(ImaginaryUnit)"),
    (sm.oo, "float(inf)"),
    *(
        (number, "Add(float(1.0), Mul(constant(ImaginaryUnit), float(-2.0)))")
        for number in (1 - 2j, np.complex64(1 - 2j), np.complex128(1 - 2j), mpmath.mpc(1, -2))
    ),
    (sm.UnevaluatedExpr(x), X),
    (sm.UnevaluatedExpr(sm.ImmutableMatrix([[1, x]])), f"1x2: {ONE} {X}"),
    (sm.UnevaluatedExpr(3 * units.meter), listed("integer(3)", ["text", "m^1"])),
    (type("L" * 70, (sm.Function,), {})(x), f"{'L' * 60}({X})"),
    # An atom with parts is not a number: the second coordinate is not 1, and a[1] is not a.
    (sm.IndexedBase(x)[1], f"Indexed(IndexedBase({X}), {ONE})"),
    (sm.MatMul(sm.Integer(2), sm.Integer(2), sm.Identity(1)), "1x1: integer(4)"),
    (sm.Symbol("x", real=True), X),
    (f(t), "symbol(f)"),
    (f(t).diff(t), "symbol(f')"),
    (sm.Derivative(f(t) + sm.pi / 2, t), "symbol(f')"),
    (f(t).diff(t, 12), "symbol(f''''''''')"),
    (sm.Function("θ")(t).diff(t, 2), "symbol(theta'')"),
    (sm.Derivative(x**2, x), "Mul(integer(2), symbol(x))"),
    (sm.Subs(x**2, x, 3), "integer(9)"),
    (sm.Integral(f(t), t), "constant(Integral)"),
    (sm.Derivative(Unknown(x), x), "constant(Derivative)"),
    (sm.sin(sm.Integral(f(t), t)), "sin(constant(Integral))"),
    (True, ["truth", True]),
    (sm.true, ["truth", True]),
    (sm.false, ["truth", False]),
    (np.str_("zxz"), ["text", "zxz"]),
    *((blank, ["blank"]) for blank in (..., None, NotImplemented)),
    ([1, x], listed(ONE, X)),
    ((1, "a"), listed(ONE, ["text", "a"])),
    ({2}, listed(TWO)),
    (sm.Tuple(1, x), listed(ONE, X)),
    (sm.FiniteSet(1, x), listed(ONE, X)),
    (sm.Quaternion(1, x, 2, y), listed(ONE, X, TWO, Y)),
    (sm.Array([[1, x]]), listed(listed(ONE, X))),
    (sm.Array(x), X),
    (np.array([[1, 2]]), listed(listed(ONE, TWO))),
    (np.array(2), TWO),
    ([], listed()),
    ({x: 2}, TWO),
    (sm.Eq(x, 2), TWO),
    (sm.Eq(2 * x, f(t)), "Mul(integer(2), symbol(x))"),
    (sm.Matrix([[1, x, 2]]), "1x3: integer(1) symbol(x) integer(2)"),
    (sm.ImmutableMatrix([1, x]), "2x1: integer(1) symbol(x)"),
    (sm.zeros(2, 0), "2x0: "),
    (sm.zeros(0, 2), "0x2: "),
    (mpmath.matrix([[1, 2]]), "1x2: float(1.0) float(2.0)"),
    (sm.MatMul(sm.Integer(2), sm.Identity(1)), "1x1: integer(2)"),
    ((3, units.newton), listed("integer(3)", ["text", "m^1 kg^1 s^-2"])),
    ([x, units.mole / units.second], listed(X, ["text", "s^-1 mol^1"])),
    (5 * units.kilo * units.gram, listed("integer(5)", ["text", "kg^1"])),
    (x * units.percent, listed("Mul(rational(1, 100), symbol(x))", ["text", "1"])),
    (180 * units.degree, listed("constant(Pi)", ["text", "1"])),
    (2 * units.radian * units.ampere, listed(TWO, ["text", "A^1"])),
    (units.meter - 3 * units.kilo * units.meter, listed("integer(-2999)", ["text", "m^1"])),
    (sm.sqrt(units.joule / units.kilogram), listed(ONE, ["text", "m^1 s^-1"])),
    (units.meter * x + units.meter * (2 - x), listed(TWO, ["text", "m^1"])),
    (
        [units.kelvin, units.candela],
        listed(listed(ONE, ["text", "K^1"]), listed(ONE, ["text", "cd^1"])),
    ),
    ([2, x * units.meter, 1], listed(TWO, listed(X, ["text", "m^1"]), ONE)),
    (sm.Matrix([2 * units.radian, 180 * units.degree]), "2x1: Mul(integer(2), integer(1)) " + (
        "Mul(integer(180), Mul(rational(1, 180), constant(Pi)))"
    )),
    (B, ["frame", "B", {"B": "3x3: " + " ".join((3 * [ONE, *3 * ["integer(0)"]])[:9])}]),
    (frames(3), ["frames", {"F0": {"F1": f"1x2: integer(0) {ONE}"},
                            "F1": {"F0": f"1x2: {ONE} integer(0)"}}]),
]  # fmt: skip


@pytest.mark.parametrize(("answer", "expected"), WRITTEN, ids=range(len(WRITTEN)))
def test_what_is_written_stays_what_it_is(answer, expected):
    assert written(answer) == expected


def test_a_vector_is_written_in_each_frame():
    kind, parts = written(2 * A.x + 3 * N.z)
    cosine, sine = f"cos({X})", f"sin({X})"
    assert kind == "vector" and sorted(parts) == ["A", "N"]
    assert parts["A"] == f"3x1: {TWO} integer(0) integer(3)"
    assert parts["N"] == f"3x1: Mul({TWO}, {cosine}) Mul({TWO}, {sine}) integer(3)"
    assert sorted(written(A)[2]) == ["A", "N"] and written(A)[1] == "A"


def test_what_calls_give_is_written_with_what_they_print_and_raise():
    def odd(number):
        if number == 1:
            print(" said " * 100)
        elif number == 2:
            raise SystemExit("stopped" * 100)
        elif number > 3:
            print("more" * (number - 4))
            return [number]

    printed, raised = (" said " * 100)[:300], f"SystemExit: {'stopped' * 100}"[:300]
    results = [["printed", printed], ["raised", raised], ["blank"], listed("integer(4)")]
    results.append(listed("integer(5)"))
    assert written(odd, [[1], [2], [3], [4], [5]]) == ["function", results, True]

    def still_blank(number): ...

    assert written(still_blank, [[1]]) == ["function", [["blank"]], False]
    assert written(abs, [[-1]]) == ["function", [ONE], True]
    assert written(..., [[1]]) == ["blank"]


def test_a_package_that_is_missing_is_told_to_whoever_can_bring_it():
    def needs(*_):
        raise ModuleNotFoundError("No module named 'numpy'", name="numpy")

    array = of_module("numpy", tolist=needs, shape=(1,))
    for answer, calls in ((needs, [[1]]), (array, None)):
        with pytest.raises(ModuleNotFoundError, match="numpy"):
            to_plain(answer, calls, raise_missing=True)
    with pytest.raises(NotPlain, match=r"type `Stranger` .*\(ModuleNotFoundError\)"):
        to_plain(array)
    assert written(needs, [[1]])[1] == [["raised", "ModuleNotFoundError: No module named 'numpy'"]]


GREEK = (
    "alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi omicron pi rho sigma "
    "tau upsilon phi chi psi omega"
).split()


def test_greek_letters_are_spelled_and_all_others_stay():
    for small, name in zip("αβγδεζηθικλμνξοπρστυφχψω", GREEK):
        assert written(sm.Symbol(small)) == f"symbol({name})"
        assert written(sm.Symbol(f"{small.upper()}_1")) == f"symbol({name.capitalize()}_1)"
    # Cyrillic, a Greek character that is no letter, a letter without a name, and another form of
    # one.
    for letter, same in {"д": "д", "\u0375": "\u0375", "\ue000": "\ue000", "ℓ²": "l2"}.items():
        assert written(sm.Symbol(letter)) == f"symbol({same})"


# ---- matrices whose products are computed here -------------------------------------------------


def entries(matrix):
    data = read_plain(to_plain(matrix))
    kind, rows, columns, places = data["value"]
    results = values(data["nodes"], {})
    return MP.matrix([
        [number(results[places[row * columns + column]]) for column in range(columns)]
        for row in range(rows)
    ]), data["nodes"]  # fmt: skip


def numbers(rows, columns, seed):
    return sm.ImmutableMatrix(
        rows, columns, np.random.default_rng(seed).integers(-9, 10, rows * columns).tolist()
    )


@pytest.mark.parametrize("size", [1, 2, 3, 4])
def test_products_and_inverses_of_matrices_are_those_of_sympy(size):
    square, second, wide = (
        numbers(size, size, 1),
        numbers(size, size, 2),
        numbers(size, size + 1, 3),
    )
    tall = numbers(size + 1, 2, 4)
    for form in (
        sm.MatMul(square, wide, tall),
        sm.MatMul(sm.Integer(3), wide, tall),
        sm.MatMul(wide, sm.Integer(3), tall),
        sm.MatAdd(wide, numbers(size, size + 1, 5)),
        sm.Transpose(wide),
        sm.MatPow(square, 3),
        sm.MatPow(square, 0),
        sm.MatPow(square, 12),
        sm.MatPow(square, 13),
        sm.MatMul(second, sm.Inverse(square)),
        sm.MatPow(square, -2),
        sm.MatMul(sm.Transpose(sm.MatMul(square, wide)), sm.Inverse(second)),
    ):
        computed, nodes = entries(form)
        right = form.doit().as_explicit()
        assert (computed.rows, computed.cols) == right.shape
        assert all(
            abs(a - MP.mpf(b.p) / b.q) < MP.mpf(10) ** -20 * max(1, abs(a))
            for a, b in zip(computed, right.flat())
        )
    assert entries(sm.MatPow(square, 1))[0] == entries(square)[0]


# ---- limits ------------------------------------------------------------------------------------


def nested(depth):
    return [nested(depth - 1)] if depth else 1


def neighbours(count):
    """Return a frame with so many connected ones, including itself."""
    first = me.ReferenceFrame("R0")
    for place in range(1, count):
        me.ReferenceFrame(f"R{place}").orient_explicit(first, sm.eye(3))
    return first


def wide_sum(count):
    return sm.Add(*sm.symbols(f"s:{count}"), evaluate=False)


BORDERS = {
    "deep": (nested, 6, "nested more than 6 deep"),
    "parts": (lambda count: [1] * count, 400, "has 401 parts"),
    "array": (np.zeros, 400, "array has 401 entries"),
    "matrix": (lambda count: sm.zeros(count, 1), 400, "matrix is 401 × 1"),
    "form": (lambda count: sm.ZeroMatrix(1, count), 400, "matrix is 1 × 401"),
    "of mpmath": (lambda count: mpmath.matrix(1, count), 400, "matrix is 1 × 401"),
    "frames": (frames, 12, "more than 12 frames"),
    "neighbours": (neighbours, 30, "This frame is connected to more than 30 others"),
    "inverse": (lambda size: sm.Inverse(numbers(size, size, 1)), 4, "inverse of a matrix of this"),
    "text": ("a".__mul__, 2000, "string of 2001 characters"),
    "name": (lambda count: sm.Symbol("a" * count), 2000, "string of 2001 characters"),
    "integer": (lambda bits: 2 ** (bits - 1), 1200, "integer of about 361 digits"),
    "denominator": (lambda bits: sm.Rational(1, 2 ** (bits - 1)), 1200, "integer of about 361 dig"),
    "nodes": (wide_sum, 59_999, "more than 60000 different parts"),
}


@pytest.mark.parametrize(("make", "most", "words"), BORDERS.values(), ids=BORDERS)
def test_up_to_its_border_an_answer_is_read(make, most, words):
    read_plain(to_plain(make(most)))
    with pytest.raises(NotPlain, match=words):
        to_plain(make(most + 1))


def test_what_waits_to_be_written_is_no_part_of_the_answer():
    letters, tangle = sm.symbols("a:250"), x
    for _ in range(250):
        tangle = sm.Add(*letters, sm.sin(tangle), evaluate=False)
    data = read_plain(to_plain(tangle))
    assert len(data["nodes"]) == 250 + 1 + 2 * 250


class Nothing:
    """An object whose type has a name longer than anybody would read."""


class Odd(Nothing):
    shape = ()

    def tolist(self):
        return 1 / 0


class Quaint(sm.Basic):
    pass


Nothing.__name__, Odd.__name__, Quaint.__name__ = "Nothing" * 10, "Odd" * 15, "Quaint" * 9

REFUSED = [
    (Nothing(), None, f"type `{('Nothing' * 10)[:40]}` cannot be read. Give a SymPy expression"),
    (3, [[1]], "asks for a function"),
    (lambda angle: abs, [[1]], "Look at what your function returns. This is a function."),
    (lambda angle: (yield angle), [[1]], "Define the function with `def`, and let it `return`"),
    ({x: 1, y: 2}, None, "This is a dictionary. Give the value in it"),
    ({"a": 1}, None, "This is a dictionary. Give the value in it"),
    ([{}, {}], None, "One entry is a dictionary"),
    ({1, 2}, None, "a set, which has no order: write a list, in square brackets"),
    (range(3), None, "This is of type `range`: write `list"),
    (map(abs, [1]), None, r"write `list\(...\)` around it"),
    ({1: 2, 3: 4}.values(), None, r"write `list\(...\)` around it"),
    ({1: 2, 3: 4}.keys(), None, r"write `list\(...\)` around it"),
    (lambda: 3, None, "This is a function. Call it, and give what it returns"),
    (of_module("scipy.spatial.transform"), None, "SciPy Rotation"),
    (N.x + B.x, None, "not connected"),
    (sm.Eq(x + 1, 2), None, "equation is not a value"),
    (sm.Eq(x, y), None, "equation is not a value"),
    (10**10**6, None, "integer of about 1000000 digits"),
    (sm.Symbol("p") & sm.Symbol("q"), None, "type `And` cannot be read"),
    (x > 1, None, "type `StrictGreaterThan` cannot be read"),
    (Quaint(), None, f"type `{('Quaint' * 9)[:40]}` cannot be read"),
    (of_module("torch", shape=(1,)), None, "type `Stranger` cannot be read"),
    (of_module("orientation.frames"), None, "type `Stranger` cannot be read"),
    (of_module("torch", tolist=list), None, "type `Stranger` cannot be read"),
    (3 * units.bit, None, "`bit` is not in SI units"),
    (units.meter + units.second, None, "different units"),
    (sm.sqrt(units.meter), None, "not a product of integer powers"),
    (sm.sin(units.meter), None, "not a product of integer powers"),
    (sm.MatrixSymbol("M", t, 2), None, "no definite size"),
    (sm.Matrix([units.meter, 1]), None, "the unit `meter`"),
    (Odd(), None, f"type `{('Odd' * 15)[:40]}` could not be read .*ZeroDivisionError"),
]


@pytest.mark.parametrize(("answer", "calls", "words"), REFUSED, ids=range(len(REFUSED)))
def test_what_is_refused_says_why(answer, calls, words):
    with pytest.raises(NotPlain, match=words):
        to_plain(answer, calls)


def test_what_a_function_returns_is_as_deep_as_an_answer():
    assert to_plain(nested, [[6]])["value"][1][0] == to_plain(nested(6))["value"]
    with pytest.raises(NotPlain, match="nested more than 6 deep"):
        to_plain(nested, [[7]])


def test_what_takes_too_long_is_left_or_refused(monkeypatch):
    begun = []
    limited = plain.limited_work
    monkeypatch.setattr(plain, "limited_work", lambda: begun.append(1) or limited(3))
    assert written([sm.Integral(x, (x, 0, bound)) for bound in (1, 2, 3)]) == listed(
        *["constant(Integral)"] * 3
    )
    assert len(begun) == 2  # Then it is not tried again.
    with pytest.raises(NotPlain, match="matrix takes too long"):
        to_plain(sm.MatPow(numbers(2, 2, 1), 13))
    with pytest.raises(NotPlain, match="unit takes too long"):
        to_plain(3 * units.meter)


def test_a_list_that_holds_itself_is_refused():
    endless = {x: None}
    endless[x] = endless
    with pytest.raises(NotPlain, match="nested too deeply"):
        to_plain(endless)


# ---- reading, by an independent grammar --------------------------------------------------------


def is_node(node, place):
    match node:
        case ["integer", str(digits)]:
            return bool(re.fullmatch("-?[0-9]{1,410}", digits))
        case ["rational", str(p), str(q)]:
            whole = all(re.fullmatch("-?[0-9]{1,410}", part) for part in (p, q))
            return whole and int(q) > 0
        case ["float", str(digits)]:
            return bool(re.fullmatch(r"-?\d{1,60}(\.\d+)?|inf", digits))
        case ["symbol" | "constant", str(name)]:
            return len(name) <= 2000
        case ["integer" | "rational" | "float" | "symbol" | "constant", *_]:
            return False
        case [str(operation), *parts]:
            named = re.fullmatch("[A-Za-z0-9_]{1,60}", operation) and len(parts) < 60_000
            return bool(named) and all(is_place(part, place) for part in parts)
    return False


def is_place(part, below):
    return type(part) is int and 0 <= part < below


def is_value(value, depth, nodes):
    inner = []
    match value:
        case ["blank"] | ["truth", bool()]:
            right = True
        case ["text" | "raised" | "printed", str(text)]:
            right = len(text) <= 2000
        case ["expression", place]:
            right = is_place(place, nodes)
        case ["matrix", int(rows), int(columns), list(places)]:
            right = bool not in (type(rows), type(columns)) and min(rows, columns) >= 0
            right &= max(rows, columns, len(places)) <= 400 and len(places) == rows * columns
            right &= all(is_place(place, nodes) for place in places)
        case ["frame", str(name), dict(others)]:
            right, inner = len(name) <= 2000 and are_names(others, 30), others.values()
        case ["vector", dict(others)]:
            right, inner = are_names(others, 30), others.values()
        case ["frames", dict(targets)]:
            right = are_names(targets, 12) and all(
                isinstance(sources, dict) and are_names(sources, 12) for sources in targets.values()
            )
            inner = right and [
                component for sources in targets.values() for component in sources.values()
            ]
        case ["list", list(inner)] | ["function", list(inner), bool()]:
            right = len(inner) <= 400
        case _:
            right = False
    return (
        right and depth <= 8 and all(is_value(component, depth + 1, nodes) for component in inner)
    )


def are_names(names, most):
    return len(names) <= most and all(len(name) <= 2000 for name in names)


def is_plain(data):
    match data:
        case {"value": value, "nodes": list(nodes), **more} if not more:
            return all(map(is_node, nodes, range(len(nodes)))) and is_value(value, 0, len(nodes))
    return False


def many(most):
    return {f"N{place}": ["blank"] for place in range(most)}


SAMPLES = [
    ["blank"],
    ["text", "zxz"],
    ["truth", True],
    ["expression", 0],
    ["matrix", 2, 1, [0, 0]],
    ["list", [["expression", 0], ["list", []]]],
    ["frame", "N", {"A": ["matrix", 1, 1, [0]]}],
    ["frames", {"N": {"A": ["expression", 0]}}],
    ["vector", {"A": ["expression", 0]}],
    ["function", [["raised", "E"], ["printed", "p"]], False],
]
INSTEAD = [
    None, True, -1, 0, 1, 2, 4, 5, 401, 2.5, "", "x", "1", "0", "-1", "inf", "a" * 60, "a" * 61,
    "a" * 2000, "a" * 2001, "9" * 410, "9" * 411, "blank", "text", "list", "frame", "matrix",
    "integer", "rational", "float", "Add.", [], {}, [[]], ["blank"], [["blank"]] * 400,
    [["blank"]] * 401, [0] * 400, many(12), many(13), many(30), many(31), {"a" * 2001: ["blank"]},
    {"a" * 2000: {}}, {"N": many(12)}, {"N": many(13)}, {f"N{n}": {} for n in range(12)},
    {f"N{n}": {} for n in range(13)}, ["truth", 1], ["float", "2"],
]  # fmt: skip


def changed(data):
    """Iterate over the data with one part at a time replaced, removed or duplicated."""
    paths = [()]
    for path in paths:
        part = data
        for key in path:
            part = part[key]
        keys = part if isinstance(part, dict) else range(len(part)) if type(part) is list else ()
        paths += [(*path, key) for key in keys]
    for *way, key in paths[1:]:
        for instead in [*INSTEAD, "out", "doubled"]:
            whole = part = copy.deepcopy(data)
            for step in way:
                part = part[step]
            if instead == "out":
                del part[key]
            elif instead == "doubled" and isinstance(part, list):
                part.insert(key, part[key])
            else:
                part[key] = instead
            yield whole


def is_read(data):
    try:
        assert read_plain(data) is data
    except NotPlain as refused:
        assert str(refused) == "The data of this answer is damaged."
        return False
    return True


@pytest.mark.parametrize("value", SAMPLES, ids=[value[0] for value in SAMPLES])
def test_what_is_read_is_what_the_grammar_says(value):
    data = {"value": value, "nodes": NODES[:1]}
    assert is_read(data) and is_plain(data)
    for candidate in changed(data):
        assert is_read(candidate) == is_plain(candidate), candidate


NODES = [["integer", "1"], ["rational", "1", "2"], ["float", "2.5"], ["symbol", "x"], ["Add", 0, 3]]


def test_nodes_are_read_as_the_grammar_says():
    for candidate in changed({"value": ["expression", 4], "nodes": NODES}):
        assert is_read(candidate) == is_plain(candidate), candidate
    assert not any(map(is_read, (None, [], "value nodes", {"value": ["blank"]}, {"nodes": []})))
    assert not is_read({"value": ["blank"], "nodes": [], "more": 1})


def test_borders_of_what_is_read():
    for depth in (8, 9):
        for inner in (
            lambda value: ["list", [value]],
            lambda value: ["frame", "N", {"A": value}],
            lambda value: ["frames", {"N": {"A": value}}],
        ):
            value = ["blank"]
            for _ in range(depth):
                value = inner(value)
            assert is_read({"value": value, "nodes": []}) == (depth == 8)
    for rows, columns in ((400, 1), (401, 1), (20, 20), (0, 400), (0, 401), (401, 0), (20, 21)):
        data = {"value": ["matrix", rows, columns, [0] * (rows * columns)], "nodes": NODES}
        assert is_read(data) == is_plain(data)
    for count in (60_000, 60_001):
        assert is_read({"value": ["blank"], "nodes": NODES[:1] * count}) == (count == 60_000)
        data = {"value": ["blank"], "nodes": [NODES[0], ["Add", *[0] * (count - 1)]]}
        assert is_read(data) == (count == 60_000)
