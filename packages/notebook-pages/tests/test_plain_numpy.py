"""What stands in for NumPy on a page: the same answers as the real
one, written the same, or none at all.
"""

import importlib.util
import inspect
import random
import sys
import warnings

import numpy as np
import pytest

from notebook_pages.live.cells import PYTHON

sys.path.append(str(PYTHON))
import plain_numpy  # noqa: E402 (it lies where the page's Python finds it)

STAND_IN = plain_numpy.STAND_IN


@pytest.fixture(autouse=True)
def no_real_one(monkeypatch):
    """The stand-in has nobody to ask: what it cannot do is an error that names NumPy."""

    def none():
        raise ModuleNotFoundError("this needs the real NumPy", name="numpy")

    monkeypatch.setattr(plain_numpy, "real", none)
    plain_numpy.begin()


SAME = """
np.array([1.0, 2, 3])
np.array([[1, 2], [3, 4]]) + 1
np.array([1e-5, 2.0, -3e7])
np.array([1e-20, 1.0])
[int(v[0] > 0), float(v[0] > 0), int(v[0] < 0)]
np.array([0.1, 0.25, -1/3])
np.array([np.nan, 1.0, -np.inf])
np.array([True, False])
np.array([10, -5, 7])
np.array([])
np.array(0.5), np.array(3), str(np.array(0.5))
np.arange(40) * 1.5
np.linspace(0, 1, 7)
np.linspace(0, 1, 5, endpoint=False)
np.arange(0, 1, 0.1)
np.arange(5, 1, -2)
np.eye(3)[[1, 2, 0]]
np.zeros((2, 0)).shape
np.float64(1.5) + 1, 2 / np.float64(3), -np.float64(1), abs(np.float64(-2.5)), np.float64(7) % 3
np.float64(2) ** 0.5
round(np.float64(1.23456), 2), round(np.float64(2.5)), np.float64(2.675).round(2), np.int64(7) / 2
np.int64(7) // 2
np.float64(1.0) > 0, np.float64(1.0) == 1, not np.float64(0.0), np.int64(3) < 2
0.5 * (np.float64(1.0) > 0), np.array([1.0, 2.0]) * np.array([True, False])
f"{np.float64(1.5):.3f} {np.int64(7):3} {np.array([1.5])[0]:+.1e} {np.array([1.5, 2])}"
A[0], A[0, 1], A[:, 1], A[1:, ::-1], A[..., 0], A[None].shape, A[-1], A[A > 2], A[[0, 2]]
A[:, [2, 0]]
A.T @ v, A @ A, v @ v, v @ A, A @ [1, 2, 3], [1, 2, 3] @ A, (S @ A).shape, S @ S.swapaxes(-1, -2)
A.sum(), A.sum(axis=0), A.sum(axis=1), A.mean(), A.mean(axis=-1, keepdims=True)
A.max(axis=1), A.min(), A.std(axis=0)
S.sum(axis=(1, 2)), S.mean(axis=0), S.max(axis=-1).max(axis=-1), np.linalg.norm(S, axis=(1, 2))
np.linalg.norm(A, axis=1)
A.argmax(), A.argmin(axis=0), (A > 0).all(), (A > 0).any(axis=0)
A.ravel(), A.reshape(1, -1)
np.sin(v), np.cos(0.3), np.arctan2(v, 2), np.degrees([1, 2]), np.radians(30), np.sqrt(2)
np.hypot(3, v), np.exp(v)
np.sign([-2.0, 0, 3]), np.abs([-1.5, 2]), np.square(v), np.minimum(v, 1), np.clip(v, -1, 1)
np.rint([0.5, 1.5, -0.2])
np.round([1.005, 2.675, -0.04], 1), np.array([-0.2]).round(), np.sinc(v)
np.isclose(v, v + 5e-3, 0, 1e-2)
np.where(v > 0, v, 0), np.isfinite(v), np.isclose(v, v + 1e-9), np.allclose(v, v + 1e-3)
np.cross(v, [1, 2, 3]), np.cross(A, v), np.trace(A), np.diag([1, 2]), np.diag(A)
np.linalg.det(A).round(12), np.linalg.det(S).round(12)
np.linalg.svd(A, compute_uv=False), np.linalg.svd(A, True, False)
np.linalg.matrix_power(A, 5)
np.stack([v, v], axis=-1), np.concatenate([A, A], axis=1), np.column_stack([v, v])
np.broadcast_to(v, (2, 3))
np.diff(v), np.diff(A, axis=0), np.diff(v, prepend=v[0]), np.cumsum(v)
np.cumsum(A, axis=0)
np.full(2, 3.0), np.ones((2, 2)), np.zeros(2, int), np.empty(0).shape
np.float64(3)[..., None]
v.tolist(), A.shape, A.size, A.ndim, A.dtype, v.astype(int), len(A), list(v), v[0].shape
(v > 0).sum(), (v > 0).mean()
v % 2, v // 1, v ** 2, 2 ** v, v / 3, 1 / v, -v, v == v, v > 1, ~(v > 1), (v > 0) & (v < 1)
(v > 0) | (v < -1)
np.array([[1.23456789e-7, 1], [100, 5]]), np.array([1.5, 100000.25]), np.array([123456789.0, 1.0])
np.array([1e8])
S, S[:, None] - S[None], np.random.default_rng(3).normal(size=(2, 3))
np.random.default_rng(0).uniform(-3, 3, 4)
np.random.default_rng(2**70).normal(size=2)
np.random.default_rng(7).normal(1.0, 2.0)
A.trace(), A.transpose(), S.transpose(2, 0, 1).shape, A.copy()
A.T.reshape(-1), A.T.ravel()
""".strip().splitlines()
NAMES = "v, A, S"


def values(numpy):
    """The arrays that the lines above call v, A and S."""
    v = numpy.array([0.3, -1.25, 2.0])
    A = numpy.array([[2.0, -1, 0.5], [0.25, 3, 1], [-1.5, 0.75, 4]])
    return {"np": numpy, "v": v, "A": A, "S": numpy.stack([A, A.T @ A / 3])}


def described(value):
    return (
        [described(part) for part in value]
        if isinstance(value, (tuple, list))
        else [repr(value), str(value)]
    )


@pytest.mark.parametrize("line", SAME)
def test_same_as_the_real_one(line):
    assert described(eval(line, values(STAND_IN))) == described(eval(line, values(np)))


BEYOND = """
np.fft.fft(v)
np.array(["a"])
np.array([1, 2], dtype=np.float32)
np.array([1j])
np.sqrt(-1.0)
1 / np.array([0.0, 1.0])
np.float64(1) / 0
np.exp(1000.0)
np.arccos(1.5)
np.array([[1.0], [1, 2]])
np.sum(v, dtype=int)
A[[0, 1], [1, 2]]
np.random.default_rng(1).integers(3)
np.random.default_rng()
np.random.normal()
np.linalg.eigh(A)
np.percentile(v, 90)
np.outer(v, v)
v[:1].item()
np.linalg.inv(A)
np.array([True]) + np.array([True])
np.zeros(2000).__repr__()
np.arange(10**7) + 1
A.cumprod()
v @ np.zeros((2000, 2000))
np.linspace(0, 1, 1)
np.array([2**70])
np.array([3]) ** -1
A.mean(axis=0, dtype=float)
np.linalg.norm(v, 0)
np.linalg.norm(A, 1)
np.diff(v, 2)
np.sum(A, 0, float)
np.dot(v, v)
v[0].sum()
A.flatten()
np.around(123.456, -1)
np.linalg.solve(A, v)
np.random.default_rng(1).random()
np.einsum('ij,j->i', A, v)
float(np.array(0.5))
[1, 2][np.array(1)]
""".strip().splitlines()


@pytest.mark.parametrize("line", BEYOND)
def test_what_it_does_not_do_asks_for_the_real_one(line):
    with pytest.raises(ModuleNotFoundError) as raised:
        eval(line, values(STAND_IN))
    assert raised.value.name == "numpy"


POOL = (
    "0 1 -2 3 0.5 -1.25 True None float int [3,4] [0.5,-2.0] [1,2,3] [[1,2],[3,4]] [] v A S v[:2] "
    "A>1 v>0 A[0] A.T (0,1) (2,3) (1,-1) np.array(2.0) np.array([1,2,3])"
).split()
OPTIONS = "axis=0 axis=1 axis=-1 axis=(0,1) keepdims=True dtype=float dtype=int".split()
METHODS_TRIED = (
    "T all() any() argmax() argmin() sum() mean() std() max() min() trace() ravel() flatten() "
    "copy() transpose() squeeze() tolist() item() sum(0) sum(1) max(0) mean(-1) sum(0,float) "
    "std(0,float) max(0,None) reshape(-1) reshape(3,3) transpose(1,0) swapaxes(0,1) round(1) "
    "astype(int) astype(float) dot(v) argmax(0) all(0) any(1) sum(axis=0,keepdims=True)"
).split()


def ordinary_lines(count):
    """Lines that people may write: functions of the stand-in, with arguments from a pool."""
    draw = random.Random("ordinary lines")
    functions = [
        f"np.{name}"
        for name, value in plain_numpy.OFFERED.items()
        if inspect.isfunction(value) or name == "linalg"
    ]
    functions = [name for name in functions if name not in ("np.linalg", "np.empty")]
    # The signs of singular vectors differ between processors, with NumPy too.
    offered = set(plain_numpy.PARTS["linalg"].offered) - {"svd"}
    functions += [f"np.linalg.{name}" for name in sorted(offered)]
    operators = ["+", "-", "*", "/", "**", "@", "//", "%", "==", "<", "&", "|"]
    for _ in range(count):
        kind = draw.random()
        if kind < 0.7:
            arguments = draw.choices(POOL, k=draw.choice([1, 1, 2, 2, 2, 3]))
            arguments += draw.sample(OPTIONS, draw.choice([0, 0, 0, 1, 1, 2]))
            names = [part.partition("=")[0] for part in arguments if "=" in part]
            if len(names) == len(set(names)):
                yield f"{draw.choice(functions)}({', '.join(arguments)})"
        elif kind < 0.85:
            yield f"np.array({draw.choice(POOL)}).{draw.choice(METHODS_TRIED)}"
        else:
            first, second = (f"np.array({value})" for value in draw.choices(POOL, k=2))
            yield f"{first} {draw.choice(operators)} {second}"


def plain(value):
    """The kinds and shapes of a value, and its numbers."""
    if isinstance(value, (tuple, list)):
        parts = [plain(part) for part in value]
        return [type(value).__name__, [part[0] for part in parts]], sum(
            (part[1] for part in parts), []
        )
    if hasattr(value, "dtype"):
        array = isinstance(value, (np.ndarray, plain_numpy.Array))
        return [tuple(value.shape), value.dtype.kind, array], np.ravel(value.tolist()).tolist()
    return type(value).__name__, [value]


def test_of_ordinary_lines_none_has_another_answer():
    """Given by place or by name: the same kind, shape and numbers, or the real one is asked."""
    wrong, answered = [], 0
    for line in ordinary_lines(12_000):
        plain_numpy.begin()
        try:
            ours = eval(line, values(STAND_IN))
        except ModuleNotFoundError:
            continue
        except Exception as error:  # noqa: BLE001 (compared with NumPy's)
            ours = error
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            try:
                theirs = eval(line, values(np))
            except Exception as error:  # noqa: BLE001
                theirs = error
        answered += 1
        if isinstance(ours, Exception) or isinstance(theirs, Exception):
            same = isinstance(theirs, type(ours)) and str(ours) == str(theirs)
        else:
            (form, numbers), (their_form, their_numbers) = plain(ours), plain(theirs)
            same = form == their_form and (
                numbers == their_numbers
                or np.allclose(numbers, their_numbers, rtol=1e-12, atol=1e-14, equal_nan=True)
            )
        if not same:
            wrong.append((line, ours, theirs))
    assert not wrong, (len(wrong), answered, wrong[:40])
    assert answered > 3_000


@pytest.mark.parametrize(
    "line", ["v[3]", "A[0, 5]", "A[0, 0, 0]", "v + A[:, :2]", "A @ v[:2]", "bool(v)", "v.nothing"]
)
def test_the_readers_own_mistakes_are_told_in_numpys_words(line):
    with pytest.raises(Exception) as expected:  # noqa: PT011 (each line has its own)
        eval(line, values(np))
    with pytest.raises(type(expected.value)) as raised:
        eval(line, values(STAND_IN))
    assert str(raised.value) == str(expected.value)


CHANGES = """
v[0] = 5
v[1:] = A[0, :2]
A[1] = v
A[:, 2] *= 2
A[A > 1] = 0
v += 1
row = A[1]; row[0] = 9
top = A[:2, :2]; top[...] = 7; A.T[0, 2] = -1
S[:, 0, :] = v
B = A.copy(); B[0] = 0
B = A.reshape(9); B[4] = 100
v[[0, 2]] = [8, 9]
w = v[[0, 2]]; w[0] = 3
k = np.arange(3); k[1] = 7
""".strip().splitlines()


@pytest.mark.parametrize("line", CHANGES)
def test_views_share_their_entries_and_copies_do_not(line):
    ours, theirs = values(STAND_IN), values(np)
    exec(line, ours)
    exec(line, theirs)
    for name in theirs:
        if name not in ("np", "__builtins__"):
            assert repr(ours[name]) == repr(theirs[name]), name


def test_normal_numbers_are_numpys_own():
    ours, theirs = STAND_IN.random.default_rng(42), np.random.default_rng(42)
    # Some from the tail, some from every layer.
    drawn = [ours.normal(scale=0.5) for _ in range(30_000)]
    assert drawn == [float(value) for value in theirs.normal(scale=0.5, size=30_000)]
    assert max(map(abs, drawn)) / 0.5 > 3.66, "none from the tail"


def test_the_real_generator_goes_on_where_the_stand_in_stopped(monkeypatch):
    """Its numbers do not repeat, and what the stand-in could draw comes from it, too."""
    monkeypatch.setattr(plain_numpy, "real", lambda: np)
    drawn = []
    for generator in (STAND_IN.random.default_rng(42), np.random.default_rng(42)):
        drawn.append([generator.normal(), *generator.random(2), generator.normal()])
        drawn[-1] += [*generator.integers(9, size=3), generator.uniform()]
    assert drawn[0] == drawn[1]


def test_sums_are_added_up_in_numpys_order():
    drawn = np.random.default_rng(5).normal(size=1000)
    ours = STAND_IN.array(drawn.tolist())
    for count in (3, 8, 17, 127, 129, 300, 1000):
        assert ours[:count].sum() == drawn[:count].sum()
        assert ours[:count].std() == drawn[:count].std()
    assert ours.reshape(10, 100).sum(axis=0).tolist() == drawn.reshape(10, 100).sum(axis=0).tolist()
    assert ours.reshape(10, 100).sum(axis=1).tolist() == drawn.reshape(10, 100).sum(axis=1).tolist()


@pytest.mark.parametrize("seed", range(5))
def test_arrays_of_any_size_are_written_as_numpy_writes_them(seed):
    draw = random.Random(seed)
    for _ in range(60):
        shape = [draw.randint(1, 6) for _ in range(draw.randint(1, 3))]
        scale = 10.0 ** draw.randint(-9, 9)
        spread = draw.choice([0, 0, 3])
        numbers = (np.random.default_rng(draw.randint(0, 10**6)).normal(size=shape)) * scale
        numbers = numbers * 10.0 ** (spread * np.random.default_rng(1).normal(size=shape))
        numbers = numbers.round(draw.choice([2, 4, 30]))
        ours = STAND_IN.array(numbers.tolist())
        assert (repr(ours), str(ours)) == (repr(numbers), str(numbers))


def test_factors_multiply_to_the_matrix():
    for seed in range(20):
        matrix = np.random.default_rng(seed).normal(size=(4, 3, 3))
        ours = STAND_IN.array(matrix.tolist())
        left, sizes, right = STAND_IN.linalg.svd(ours)
        assert np.allclose(
            np.array((left * sizes[..., None, :] @ right).tolist()), matrix, atol=1e-14
        )
        assert np.allclose(np.array((left @ left.swapaxes(-1, -2)).tolist()), np.eye(3), atol=1e-14)
        assert np.allclose(sizes.tolist(), np.linalg.svd(matrix)[1], atol=1e-14)
    flat = STAND_IN.linalg.svd(STAND_IN.array([[1.0, 2, 3], [2, 4, 6], [0, 0, 0]]))
    assert np.allclose((flat[0] @ flat[0].T).tolist(), np.eye(3), atol=1e-14)


def test_who_looks_for_numpy_finds_what_stands_in(monkeypatch):
    """As a moving figure does, which then asks for Matplotlib too: without a word
    it would be an error of Python's.
    """
    for part in (STAND_IN, *plain_numpy.PARTS.values()):
        monkeypatch.setitem(sys.modules, part.__name__, part)
        assert importlib.util.find_spec(part.__name__).name == part.__name__
