"""A stand-in for NumPy on pages and in notebooks in the browser, until the real one is there.

It provides small arrays in plain Python. It does what the book's cells do with a handful of
orientations, with NumPy's results and NumPy's output format; ``tests/test_plain_numpy.py`` compares
each function with the real one. Everything else (another function, another option, a shape or a
value that calls for a warning, or more work than plain Python can do in a moment) is left to the
real NumPy. The page then fetches it; a notebook does so for a cell that imports it.
"""

import bisect
import collections
import functools
import importlib.machinery
import itertools
import math
import operator
import sys
import traceback
import types

# The most entries that one cell may make, which takes some seconds in a browser.
MOST_WORK = 4_000_000
# The number of entries made since the page last asked.
work = 0
nan = math.nan
# The kinds of entries: Booleans, integers, floats.
KINDS = {"b": bool, "i": int, "f": float}
# Public names, as NumPy has them.
OFFERED = {"pi": math.pi, "e": math.e, "inf": math.inf, "nan": nan, "newaxis": None}


# --- the real one -------------------------------------------------------------------------------


def real():
    """Return the real NumPy or, if it is missing, raise the error that makes the page fetch it."""
    numpy = importlib.import_module("numpy")
    if numpy is STAND_IN:
        raise ModuleNotFoundError(
            "this needs the real NumPy: write `import numpy` in the same cell, and the page "
            "fetches it if it can",
            name="numpy",
        )
    return numpy


def handed_on(value):
    """Return ``value`` in a form that the real NumPy accepts."""
    if isinstance(value, Array):
        return value.__array__()
    if isinstance(value, Scalar):
        return value.__array__()[()]
    # A named tuple takes its parts as separate arguments.
    if isinstance(value, (list, tuple)):
        return getattr(value, "_make", type(value))(map(handed_on, value))
    return value


class UserError(Exception):
    """An error in the reader's own use of an array, with NumPy's message.

    It wraps the error, so that it is not passed on to the real NumPy.
    """


def or_the_real_one(function, find):
    """Return ``function`` with a fallback to the real NumPy's ``find(real, arguments)``."""

    @functools.wraps(function)
    def careful(*arguments, **options):
        try:
            return function(*arguments, **options)
        except UserError as user_error:
            raise user_error.args[0] from None
        except ModuleNotFoundError:
            error = None
        except Exception as failure:
            error = failure
        try:
            arguments = handed_on(arguments)
            instead = find(real(), arguments)
        except ModuleNotFoundError as missing:
            raise missing from error
        return instead(*arguments, **{name: handed_on(value) for name, value in options.items()})

    return careful


def offered(function, within=None, name=None):
    """Offer ``function`` by its name, in the part ``within`` of NumPy if that is given."""
    name = name or function.__name__.rstrip("_")

    def find(numpy, arguments):
        return getattr(getattr(numpy, within) if within else numpy, name)

    careful = or_the_real_one(function, find)
    (PARTS[within].offered if within else OFFERED)[name] = careful
    return careful


def within(part):
    return functools.partial(offered, within=part)


class Part(types.ModuleType):
    """A replacement of ``numpy``, ``numpy.linalg`` or ``numpy.random``.

    Names that it does not offer come from the real one.
    """

    __path__ = ()

    def __init__(self, name, offered):
        super().__init__(name)
        # Code that checks whether NumPy is installed needs this.
        self.__spec__ = importlib.machinery.ModuleSpec(name, None)
        self.offered = offered

    def __getattr__(self, name):
        if name in self.offered:
            return self.offered[name]
        # Python asks any module for these attributes.
        if name.startswith("__") and name != "__version__":
            raise AttributeError(name)
        namesake = real()
        for part in self.__name__.split(".")[1:]:
            namesake = getattr(namesake, part)
        return getattr(namesake, name)


PARTS = {"linalg": Part("numpy.linalg", {}), "random": Part("numpy.random", {})}
STAND_IN = Part("numpy", OFFERED)
OFFERED.update(PARTS)


def stand_in():
    """Install the stand-in, so that ``import numpy`` returns it."""
    sys.modules.update({part.__name__: part for part in (STAND_IN, *PARTS.values())})


def step_aside(names):
    """Replace the stand-in by the real NumPy in the modules that imported it and in ``names``.

    ``names`` are the reader's own.
    """
    if sys.modules.get("numpy") is not STAND_IN:
        return
    for part in (STAND_IN, *PARTS.values()):
        del sys.modules[part.__name__]
    numpy = importlib.import_module("numpy")
    # Leave this module out, because its own names distinguish the real NumPy from the stand-in.
    others = [module for module in sys.modules.values() if isinstance(module, types.ModuleType)]
    for space in (names, *(vars(module) for module in others if module.__name__ != __name__)):
        for name, value in list(space.items()):
            if value is STAND_IN:
                space[name] = numpy
    for name, value in names.items():
        names[name] = handed_on(value)


def load_ipython_extension(shell):
    """Stand in for NumPy in a notebook, until its kernel has fetched the real one for a cell."""

    def look(info):
        if is_fetched():
            shell.events.unregister("pre_run_cell", look)
            names = {
                name: value
                for name, value in shell.user_ns.items()
                if name not in shell.user_ns_hidden
            }
            step_aside(names)
            shell.user_ns.update(names)

    stand_in()
    shell.events.register("pre_run_cell", look)


def is_fetched():
    """Check whether the real NumPy can be imported."""
    try:
        return any(finder.find_spec("numpy", None) for finder in sys.meta_path)
    # A finder raises this, with its own message about where NumPy could come from.
    except ModuleNotFoundError:
        return False


def is_at_fault(error):
    """Check whether an error mentions the stand-in, or comes from SymPy's lookup of NumPy.

    The real NumPy may have another message or raise no error.
    """
    looked_up = isinstance(error, KeyError) and any(
        place.filename.endswith("sympy/utilities/lambdify.py")
        for place in traceback.extract_tb(error.__traceback__)[-1:]
    )
    return looked_up or any(
        f"'{kind.__name__}'" in str(error)
        for kind in (Array, Number, Integer, Truth, Generator, Part)
    )


def begin():
    """Start counting the work of a cell."""
    global work
    work = 0


# --- numbers ------------------------------------------------------------------------------------


class DType:
    """The type of an array's entries."""

    names = {"b": "bool", "i": "int64", "f": "float64"}

    def __init__(self, kind):
        self.kind, self.char, self.name, self.itemsize = (
            kind,
            {"b": "?", "i": "l", "f": "d"}[kind],
            self.names[kind],
            8,
        )

    def __eq__(self, other):
        if isinstance(other, DType):
            return self.kind == other.kind
        return other in (self.name, KINDS[self.kind], SCALARS[self.kind])

    def __hash__(self):
        return hash(self.kind)

    def __str__(self):
        return self.name

    def __repr__(self):
        return f"dtype('{self.name}')"


class Scalar:
    """The methods of NumPy's scalars that Python's own numbers lack."""

    ndim, shape, size = 0, (), 1

    def tolist(self):
        return KINDS[self.kind](self)

    item = tolist

    def __repr__(self):
        return f"np.{self.dtype}({self.tolist()!r})"

    def __str__(self):
        return repr(self.tolist())

    def __array__(self, dtype=None, copy=None):
        return real().asarray(self.tolist(), dtype)

    @property
    def dtype(self):
        return DType(self.kind)

    def round(self, decimals=0):
        return around(self, decimals)

    def __getitem__(self, index):
        return array(self)[index]

    def __getattr__(self, name):
        # Other libraries ask every object for its ``free_symbols``.
        if name not in METHODS:
            raise AttributeError(f"'numpy.{self.dtype}' object has no attribute {name!r}")
        return getattr(real().asarray(self.tolist())[()], name)


class Number(Scalar, float):
    kind = "f"

    def __round__(self, digits=None):
        return round(float(self)) if digits is None else around(self, digits)

    __hash__ = float.__hash__


class Integer(Scalar, int):
    kind = "i"

    __hash__ = int.__hash__


class Truth(Scalar):
    """``numpy.True_`` or ``numpy.False_``."""

    kind = "b"

    def __init__(self, value):
        self.value = bool(value)

    def __bool__(self):
        return self.value

    def __repr__(self):
        return f"np.{self.value}_"

    def __format__(self, form):
        return format(str(self), form)

    def __hash__(self):
        return hash(self.value)

    def __int__(self):
        return int(self.value)

    def __float__(self):
        return float(self.value)


SCALARS = {"f": Number, "i": Integer, "b": Truth}
OFFERED.update({"float64": Number, "int64": Integer, "bool_": Truth, "generic": Scalar})


# The attributes of the real array. Some exist here, and the rest need the real NumPy.
METHODS = set(
    """
    T all any argmax argmin argpartition argsort astype base byteswap choose clip compress conj
    conjugate copy ctypes cumprod cumsum data device diagonal dot dtype dump dumps fill flags flat
    flatten getfield imag item itemsize mT max mean min nbytes ndim nonzero partition prod put ravel
    real repeat reshape resize round searchsorted setfield setflags shape size sort squeeze std
    strides sum swapaxes take to_device tobytes tofile tolist trace transpose var view
    """.split()
)


def kind_of(dtype):
    for kind, python in KINDS.items():
        if (
            dtype is python
            or dtype is SCALARS[kind]
            or (isinstance(dtype, (DType, str)) and DType(kind) == dtype)
        ):
            return kind
    raise TypeError(dtype)


def scalar(kind, value):
    return SCALARS[kind](value)


# --- arrays -------------------------------------------------------------------------------------


class Array:
    """An array: a list of entries, which views share, the places in it, the shape and the kind."""

    # In an operation with an array of the real NumPy, the real one decides.
    __array_priority__ = -1
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, entries, shape, kind, places=None):
        global work
        self.entries, self.shape, self.kind = entries, tuple(shape), kind
        self.places = range(len(entries)) if places is None else places
        work += len(self.places) + 20
        if work > MOST_WORK:
            real()

    # What it is.

    ndim = property(lambda self: len(self.shape))
    size = property(lambda self: len(self.places))
    dtype = property(lambda self: DType(self.kind))

    @property
    def values(self):
        """The entries in order, as a list that must not be changed."""
        places, entries = self.places, self.entries
        if isinstance(places, range) and places.step == 1:
            return entries if len(places) == len(entries) else entries[places.start : places.stop]
        return [entries[place] for place in places]

    def view(self, shape, places):
        return Array(self.entries, shape, self.kind, places)

    def __array__(self, dtype=None, copy=None):
        return real().array(self.values, dtype or self.dtype.name).reshape(self.shape)

    def __getattr__(self, name):
        if name not in METHODS:
            raise AttributeError(f"'numpy.ndarray' object has no attribute {name!r}")
        return getattr(self.__array__(), name)

    def __reduce__(self):
        raise TypeError("an array that belongs to the page cannot be copied in this way")

    def tolist(self):
        return nested(self.values, self.shape)

    def __len__(self):
        if not self.shape:
            raise TypeError("len() of unsized object")
        return self.shape[0]

    def __iter__(self):
        return iter([self[position] for position in range(len(self))])

    def __bool__(self):
        if self.size != 1:
            raise UserError(ValueError("The truth value of an array with more than one element is "
                "ambiguous. "
                                  "Use a.any() or a.all()"))  # fmt: skip
        return bool(self.values[0])

    # Shapes.

    def reshape(self, *shape):
        shape = shape_of(shape, -1)
        if -1 in shape:
            rest = math.prod(length for length in shape if length != -1)
            shape = tuple(self.size // rest if length == -1 else length for length in shape)
        if math.prod(shape) != self.size:
            raise UserError(
                ValueError(f"cannot reshape array of size {self.size} into shape {written(shape)}")
            )
        alike = isinstance(self.places, range)
        return self.view(shape, self.places) if alike else Array(self.values, shape, self.kind)

    def ravel(self):
        return self.reshape(-1)

    flat = property(lambda self: iter([scalar(self.kind, value) for value in self.values]))

    def transpose(self, *order):
        order = shape_of(order, -self.ndim) if order else tuple(range(self.ndim))[::-1]
        order = [position + self.ndim if position < 0 else position for position in order]
        if sorted(order) != list(range(self.ndim)):
            raise ValueError(order)
        steps = steps_of(self.shape)
        shape = [self.shape[position] for position in order]
        indices = places_of(shape, [steps[position] for position in order])
        return self.view(shape, [self.places[place] for place in indices])

    T = property(lambda self: self.transpose() if self.ndim > 1 else self)

    def swapaxes(self, axis1, axis2):
        order = list(range(self.ndim))
        order[axis1], order[axis2] = order[axis2], order[axis1]
        return self.transpose(order)

    def copy(self):
        return Array(list(self.values), self.shape, self.kind)

    def astype(self, dtype, *, copy=True):
        return as_array(self, dtype).copy() if copy else as_array(self, dtype)

    # Parts.

    def select(self, index):
        """Return the shape of the part at ``index``, its places, and whether it is a view."""
        if type(index) is int and self.shape:
            length = self.shape[0]
            if not -length <= index < length:
                raise UserError(
                    IndexError(f"index {index} is out of bounds for axis 0 with size {length}")
                )
            rest = len(self.places) // length
            index %= length
            return self.shape[1:], self.places[index * rest : (index + 1) * rest], True
        if type(index) is slice and self.ndim == 1:
            places = self.places[index]
            return (len(places),), places, True
        index = index if isinstance(index, tuple) else (index,)
        simple = (int, slice, type(None), type(Ellipsis))
        index = [
            part
            if isinstance(part, simple) and not isinstance(part, (bool, Truth))
            else as_array(part)
            for part in index
        ]
        index = [
            part.values[0]
            if isinstance(part, Array) and part.shape == () and part.kind == "i"
            else part
            for part in index
        ]
        axes = sum(part.ndim if isinstance(part, Array) and part.kind == "b" else part is not None
                   for part in index if part is not Ellipsis)  # fmt: skip
        if axes > self.ndim:
            raise UserError(
                IndexError(
                    f"too many indices for array: array is {self.ndim}-dimensional, "
                    f"but {axes} were indexed"
                )
            )
        if Ellipsis not in [part for part in index if not isinstance(part, Array)]:
            index.append(Ellipsis)
        lists = [position for position, part in enumerate(index) if isinstance(part, Array)]
        singles = [position for position, part in enumerate(index) if isinstance(part, int)]
        if len(lists) > 1 or (lists and any(abs(position - lists[0]) > 1 for position in singles)):
            raise NotImplementedError("lists of places along two axes")
        shape, indices, axis, steps = [], [0], 0, steps_of(self.shape)
        for part in index:
            if part is None:
                shape.append(1)
            elif part is Ellipsis:
                skipped = range(axis, axis + self.ndim - axes)
                shape += [self.shape[k] for k in skipped]
                indices = [
                    place + more
                    for place in indices
                    for more in places_of(
                        self.shape[axis : skipped.stop], steps[axis : skipped.stop]
                    )
                ]
                axis = skipped.stop
            elif isinstance(part, int):
                length = self.shape[axis]
                if not -length <= part < length:
                    raise UserError(
                        IndexError(
                            f"index {part} is out of bounds for axis {axis} with size {length}"
                        )
                    )
                indices = [place + part % length * steps[axis] for place in indices]
                axis += 1
            elif isinstance(part, slice):
                positions = range(*part.indices(self.shape[axis]))
                shape.append(len(positions))
                indices = [place + k * steps[axis] for place in indices for k in positions]
                axis += 1
            elif part.kind == "b":
                if part.shape != self.shape[axis : axis + part.ndim] or not part.ndim:
                    raise IndexError(part.shape)
                end, step = axis + part.ndim, steps[axis + part.ndim - 1]
                positions = [k * step for k, chosen in enumerate(part.values) if chosen]
                shape.append(len(positions))
                indices = [place + more for place in indices for more in positions]
                axis = end
            else:
                length = self.shape[axis]
                if part.kind != "i" and part.size:
                    raise IndexError("arrays used as indices must be of integer (or boolean) type")
                for k in part.values:
                    if not -length <= k < length:
                        raise UserError(
                            IndexError(
                                f"index {k} is out of bounds for axis {axis} with size {length}"
                            )
                        )
                shape += part.shape
                indices = [
                    place + k % length * steps[axis] for place in indices for k in part.values
                ]
                axis += 1
        return tuple(shape), [self.places[place] for place in indices], not lists

    def __getitem__(self, index):
        shape, places, view = self.select(index)
        if not shape and view:
            return scalar(self.kind, self.entries[places[0]])
        return (
            self.view(shape, places)
            if view
            else Array([self.entries[place] for place in places], shape, self.kind)
        )

    def __setitem__(self, index, value):
        shape, places, _ = self.select(index)
        value = as_array(value)
        while value.ndim > len(shape) and value.shape[0] == 1:
            value = value[0]
        if (
            KINDS[value.kind] is float
            and self.kind != "f"
            or value.kind == "i"
            and self.kind == "b"
        ):
            raise TypeError("another kind of number")
        convert = KINDS[self.kind]
        for place, entry in zip(places, list(spread(value, shape))):
            self.entries[place] = convert(entry)

    # Arithmetic; the rest of the operators follow below.

    def __matmul__(self, other):
        return product(self, other) if can_join(other) else NotImplemented

    def __rmatmul__(self, other):
        return product(other, self) if can_join(other) else NotImplemented

    def round(self, decimals=0):
        return around(self, decimals)

    def trace(self):
        return trace(self)

    def __str__(self):
        return written_array(self, " ", "")

    def __repr__(self):
        if not self.size and (self.shape != (0,) or self.kind != "f"):
            raise NotImplementedError("empty")
        ending = ")" if self.size else ", dtype=float64)"
        return f"array({written_array(self, ', ', 'array(')}{ending}"

    def __format__(self, form):
        if form:
            raise UserError(
                TypeError("unsupported format string passed to numpy.ndarray.__format__")
            )
        return str(self)


OFFERED["ndarray"] = Array


def nested(values, shape):
    if not shape:
        return values[0]
    if len(shape) == 1:
        return list(values)
    step = math.prod(shape[1:])
    return [nested(values[k * step : (k + 1) * step], shape[1:]) for k in range(shape[0])]


def shape_of(shape, least=0):
    shape = shape[0] if len(shape) == 1 and not isinstance(shape[0], int) else shape
    shape = [length.tolist() if isinstance(length, Integer) else length for length in shape]
    if any(type(length) is not int or length < least for length in shape):
        raise TypeError("lengths")
    return tuple(shape)


def written(shape):
    return f"({','.join(map(str, shape))}{',' if len(shape) == 1 else ''})"


def steps_of(shape):
    steps = [1]
    for length in reversed(shape[1:]):
        steps.insert(0, steps[0] * length)
    return steps[: len(shape)]


def places_of(shape, steps):
    places = [0]
    for length, step in zip(shape, steps):
        offsets = range(0, length * step, step) if step else [0] * length
        places = [place + more for place in places for more in offsets]
    return places


def spread(value, shape):
    """Return the entries of an array, repeated to fill a larger shape."""
    if value.shape == shape:
        return value.values
    steps = [step if length > 1 else 0 for length, step in zip(value.shape, steps_of(value.shape))]
    new = len(shape) - value.ndim
    if new < 0 or any(length not in (1, there) for length, there in zip(value.shape, shape[new:])):
        raise UserError(
            ValueError(
                f"could not broadcast input array from shape {written(value.shape)} into shape "
                f"{written(shape)}"
            )
        )
    if value.size == 1:
        return value.values * math.prod(shape)
    values = value.values
    return [values[place] for place in places_of(shape, [0] * new + steps)]


def common_shape(*shapes):
    if len(set(shapes)) == 1:
        return shapes[0]
    longest = max(map(len, shapes))
    padded = [(1,) * (longest - len(shape)) + tuple(shape) for shape in shapes]
    together = []
    for lengths in zip(*padded):
        lengths_above_one = set(lengths) - {1}
        if len(lengths_above_one) > 1:
            written_shapes = " ".join(map(written, shapes))
            raise UserError(
                ValueError(
                    f"operands could not be broadcast together with shapes {written_shapes} "
                )
            )
        together.append(lengths_above_one.pop() if lengths_above_one else 1)
    return tuple(together)


def can_join(value):
    return isinstance(value, (Array, Scalar, int, float, list, tuple))


def as_array(value, dtype=None):
    """Return ``value`` as an array; an array of the right kind is returned unchanged."""
    if isinstance(value, Array):
        array = value
    elif isinstance(value, (bool, Truth)):
        array = Array([bool(value)], (), "b")
    elif isinstance(value, int):
        array = Array([in_range(int(value))], (), "i")
    elif isinstance(value, float):
        array = Array([float(value)], (), "f")
    elif isinstance(value, str) and dtype is float:
        array = Array([float(value)], (), "f")
    elif isinstance(value, (list, tuple, range)):
        value = list(value)
        if value and all(type(entry) is float for entry in value):
            array = Array(value, (len(value),), "f")
        else:
            parts = [as_array(entry, dtype) for entry in value]
            shapes = {part.shape for part in parts}
            if len(shapes) > 1:
                raise ValueError("ragged")
            kind = max([part.kind for part in parts], key="bif".index, default="f")
            array = Array([KINDS[kind](entry) for part in parts for entry in part.values],
                          (len(parts), *(shapes.pop() if shapes else ())), kind)  # fmt: skip
    elif hasattr(value, "tolist") and hasattr(value, "rows"):  # a matrix of SymPy
        if dtype is None:
            raise TypeError(type(value))
        array = as_array(value.tolist(), dtype)
    elif hasattr(value, "shape") and not type(value).__module__.startswith("numpy"):
        # This is an array of orientation's own.
        array = as_array(value.tolist(), dtype)
    elif dtype is not None and kind_of(dtype) == "f" and hasattr(value, "is_number"):
        # This is a number of SymPy.
        array = Array([float(value)], (), "f")
    else:
        raise TypeError(type(value))
    if dtype is None or array.kind == (kind := kind_of(dtype)):
        return array
    if kind == "i" and not all(map(math.isfinite, array.values)):
        raise ValueError("not finite")
    return Array([KINDS[kind](entry) for entry in array.values], array.shape, kind)


def in_range(value):
    if not -(2**63) <= value < 2**63:
        raise OverflowError(value)
    return value


def result(values, shape, kind):
    return Array(values, shape, kind) if shape else scalar(kind, values[0])


# --- entry by entry -----------------------------------------------------------------------------


def entry_by_entry(function, *arguments, kind=None, quiet=False):
    """Apply ``function`` to the entries.

    If finite numbers give an infinite result or nan, the real NumPy takes over, which warns.
    """
    arrays = [as_array(argument) for argument in arguments]
    kind = kind or max([array.kind for array in arrays], key="bif".index)
    if len(arrays) == 1:
        shape, values = arrays[0].shape, list(map(function, arrays[0].values))
    else:
        shape = common_shape(*[array.shape for array in arrays])
        values = list(map(function, *[spread(array, shape) for array in arrays]))
    if kind == "i":
        list(map(in_range, values))
    elif kind == "f" and not quiet and not all_finite(values):
        if all(all_finite(array.values) for array in arrays):
            raise ArithmeticError("infinite")
    return result(values, shape, kind)


def all_finite(values):
    return (total := sum(values)) - total == 0 or all(map(math.isfinite, values))


def arithmetic(name, function, kind=None):
    """Define an operator for arrays and numbers, in both directions, and NumPy's function."""

    def there(self, other):
        return joined(self, other) if can_join(other) else NotImplemented

    def back(self, other):
        return joined(other, self) if can_join(other) else NotImplemented

    def joined(left, right):
        entries = entry_by_entry(function, left, right, kind=kind)
        if kind is None and entries.dtype.kind == "b":
            raise TypeError("truth values, with which NumPy does not count")
        return entries

    for owner in (Array, Number, Integer, Truth):
        setattr(owner, f"__{name}__", there)
        if kind != "b":
            setattr(owner, f"__r{name}__", back)


def raised(base, exponent):
    if exponent == 2:
        return base * base
    if exponent == 0.5 and isinstance(exponent, float):
        return math.sqrt(base)
    power = base**exponent
    if (
        isinstance(base, int)
        and isinstance(exponent, int)
        and exponent < 0
        or isinstance(power, complex)
    ):
        raise ValueError("needs another kind of number")
    return power


def rest(value, divisor):
    if isinstance(value, float) or isinstance(divisor, float):
        return value % divisor
    return operator.mod(value, divisor)


for _name, _function, _kind in (
    ("add", operator.add, None), ("sub", operator.sub, None), ("mul", operator.mul, None),
    ("truediv", operator.truediv, "f"), ("pow", raised, None), ("mod", rest, None),
    ("floordiv", operator.floordiv, None),
    ("eq", operator.eq, "b"), ("ne", operator.ne, "b"), ("lt", operator.lt, "b"),
    ("le", operator.le, "b"), ("gt", operator.gt, "b"), ("ge", operator.ge, "b"),
):  # fmt: skip
    arithmetic(_name, _function, _kind)


def of_booleans(function):
    def there(self, other):
        if (
            isinstance(other, (bool, Truth, Array))
            and (not isinstance(other, Array) or other.kind == "b")
            and self.kind == "b"
        ):
            return entry_by_entry(
                lambda left, right: function(bool(left), bool(right)), self, other, kind="b"
            )
        raise TypeError("not truth values")

    return there


for _owner in (Array, Truth):
    _owner.__and__ = _owner.__rand__ = of_booleans(operator.and_)
    _owner.__or__ = _owner.__ror__ = of_booleans(operator.or_)
    _owner.__xor__ = of_booleans(operator.xor)
    _owner.__invert__ = lambda self: entry_by_entry(operator.not_, self | False, kind="b")
Truth.__hash__ = lambda self: hash(self.value)
for _owner in (Array, Number, Integer):
    _owner.__neg__ = lambda self: no_truth_values(operator.neg, self)
    _owner.__abs__ = lambda self: no_truth_values(abs, self)
    _owner.__pos__ = lambda self: self


def no_truth_values(function, value):
    if as_array(value).kind == "b":
        raise TypeError("not for truth values")
    return entry_by_entry(function, value)


def in_place(name):
    def change(self, other):
        changed = getattr(self, f"__{name}__")(other)
        if changed is NotImplemented:
            return changed
        if changed.shape != self.shape or changed.kind != self.kind:
            raise TypeError("another shape or kind")
        self[...] = changed
        return self

    return change


for _name in ("add", "sub", "mul", "truediv", "pow", "mod"):
    setattr(Array, f"__i{_name}__", in_place(_name))


def converted(name):
    return lambda self: getattr(self.__array__(), name)()


for _name in ("__float__", "__int__", "__index__"):
    setattr(Array, _name, converted(_name))


OF_TWO = {
    "arctan2", "hypot", "true_divide", "divide", "add", "subtract", "multiply", "power", "mod",
    "minimum", "maximum",
}  # fmt: skip


def of_numbers(name, function, kind="f"):
    """Offer a function of numbers, entry by entry."""

    def applied(*arguments, out=None):
        if len(arguments) != 1 + (name in OF_TWO):
            raise TypeError("other arguments")
        arrays = list(map(as_array, arguments))
        if kind != "b" and any(array.kind == "b" for array in arrays):
            raise TypeError("truth values")
        if name in ("floor", "ceil") and arrays[0].kind != "f":
            raise TypeError("whole numbers stay whole")
        entries = entry_by_entry(function, *arrays, kind=kind)
        if out is None:
            return entries
        out[...] = entries
        return out

    applied.__name__ = name
    offered(applied)


def nearest_whole(value):
    return math.copysign(round(value), value) if math.isfinite(value) else value


def larger(x, y):
    return x if x >= y or x != x else y


def smaller(x, y):
    return x if x <= y or x != x else y


def sign_of(value):
    return float((value > 0) - (value < 0)) if value == value else value


PER_DEGREE, PER_RADIAN = math.pi / 180, 180 / math.pi
for _name, _function in {
    "sin": math.sin, "cos": math.cos, "tan": math.tan, "arcsin": math.asin, "arccos": math.acos,
    "arctan": math.atan, "arctan2": math.atan2, "exp": math.exp, "log": math.log,
    "log10": math.log10, "log2": math.log2, "log1p": math.log1p, "sqrt": math.sqrt,
    "hypot": math.hypot, "radians": lambda value: value * PER_DEGREE,
    "degrees": lambda value: value * PER_RADIAN, "sinh": math.sinh, "cosh": math.cosh,
    "tanh": math.tanh, "rint": nearest_whole,
    "sinc": lambda value: math.sin(math.pi * value) / (math.pi * value) if value else 1.0,
    "true_divide": operator.truediv, "divide": operator.truediv,
    "floor": lambda value: float(math.floor(value)), "ceil": lambda value: float(math.ceil(value)),
}.items():  # fmt: skip
    of_numbers(_name, _function)
for _name, _function in {
    "add": operator.add, "subtract": operator.sub, "multiply": operator.mul, "power": raised,
    "mod": rest, "minimum": smaller, "maximum": larger, "negative": operator.neg,
    "square": lambda value: value * value,
}.items():  # fmt: skip
    of_numbers(_name, _function, None)
for _name, _function in {
    "isfinite": math.isfinite, "isnan": math.isnan, "isinf": math.isinf,
    "logical_not": operator.not_,
}.items():  # fmt: skip
    of_numbers(_name, _function, "b")
OFFERED.update({"deg2rad": OFFERED["radians"], "rad2deg": OFFERED["degrees"]})


@offered
def abs_(value):
    return no_truth_values(abs, value)


OFFERED["absolute"] = abs_


@offered
def sign(value):
    value = as_array(value)
    if value.kind == "b":
        raise TypeError("truth values")
    return entry_by_entry(
        sign_of if value.kind == "f" else lambda entry: (entry > 0) - (entry < 0), value
    )


@offered
def around(a, decimals=0):
    value, (decimals,) = as_array(a), shape_of((operator.index(decimals),))
    if value.kind != "f":
        raise TypeError("not floats")
    scale = 10.0**decimals
    return entry_by_entry(lambda entry: nearest_whole(entry * scale) / scale, value)


OFFERED["round"] = around


@offered
def clip(a, a_min, a_max):
    raised = a if a_min is None else OFFERED["maximum"](a, a_min)
    return raised if a_max is None else OFFERED["minimum"](raised, a_max)


@offered
def where(condition, x, y, /):
    kind = max(as_array(x).kind, as_array(y).kind, key="bif".index)
    convert = KINDS[kind]
    return entry_by_entry(
        lambda c, yes, no: convert(yes if c else no), condition, x, y, kind=kind, quiet=True
    )


@offered
def putmask(a, /, mask, values):
    if not isinstance(a, Array) or as_array(values).size not in (1, a.size):
        raise NotImplementedError("repeated values")
    a[...] = where(as_array(mask).reshape(a.shape), values, a)


@offered
def isclose(a, b, rtol=1e-5, atol=1e-8):
    rtol, atol = float(rtol), float(atol)

    def close(x, y):
        return (
            abs(x - y) <= atol + rtol * abs(y) if math.isfinite(x) and math.isfinite(y) else x == y
        )

    return entry_by_entry(close, a, b, kind="b")


@offered
def allclose(a, b, rtol=1e-5, atol=1e-8):
    return all(as_array(isclose(a, b, rtol, atol)).values)


# --- arrays made --------------------------------------------------------------------------------


@offered
def array(object, dtype=None):
    return as_array(object, dtype).copy()


@offered
def asarray(a, dtype=None):
    return as_array(a, dtype)


@offered
def full(shape, fill_value, dtype=None):
    value = as_array(fill_value, dtype)
    if value.shape:
        raise ValueError("one value")
    return Array(value.values * math.prod(shape := shape_of((shape,))), shape, value.kind)


@offered
def zeros(shape, dtype=float):
    return full(shape, 0, float if dtype is None else dtype)


@offered
def ones(shape, dtype=float):
    return full(shape, 1, float if dtype is None else dtype)


@offered
def empty(shape, dtype=float):
    return zeros(shape, dtype)


@offered
def eye(N, *, dtype=float):
    (N,) = shape_of((N,))
    convert = KINDS[kind_of(dtype)]
    return Array(
        [convert(row == column) for row in range(N) for column in range(N)],
        (N, N),
        kind_of(dtype),
    )


@offered
def arange(start, stop=None, step=1, /):
    start, stop = (0, start) if stop is None else (start, stop)
    if all(isinstance(value, int) for value in (start, stop, step)):
        values = list(range(int(start), int(stop), int(step)))
        return Array(values, (len(values),), "i")
    count = max(0, math.ceil((stop - start) / step))
    delta = float(start + step) - start
    return Array([float(start + k * delta) for k in range(count)], (count,), "f")


@offered
def linspace(start, stop, num=50, endpoint=True):
    start, stop, parts = float(start), float(stop), num - 1 if endpoint else num
    step = (stop - start) / parts
    if num < 2 or not step:
        raise ValueError("too few")
    values = [k * step + start for k in range(num)]
    if endpoint:
        values[-1] = stop
    return Array(values, (num,), "f")


@offered
def loadtxt(fname, *, delimiter, skiprows=0):
    lines = list(fname)[skiprows:]
    return as_array([list(map(float, line.split(delimiter))) for line in lines if line.strip()])


@offered
def broadcast_to(array, shape):
    value = as_array(array)
    shape = shape_of((shape,))
    return Array(list(in_other_words(spread, value, shape)), shape, value.kind)


def in_other_words(function, *arguments):
    """Return the result of ``function``; raise errors in the reader's use with NumPy's message."""
    try:
        return function(*arguments)
    except UserError as user_error:
        raise user_error.args[0] from None


@offered
def broadcast_shapes(*args):
    return in_other_words(common_shape, *[shape_of((shape,)) for shape in args])


@offered
def concatenate(arrays, /, axis=0):
    arrays = [as_array(array) for array in arrays]
    axis = range(arrays[0].ndim)[axis]
    kind = max([array.kind for array in arrays], key="bif".index)
    if len({array.shape[:axis] + array.shape[axis + 1 :] for array in arrays}) > 1:
        raise ValueError("shapes")
    shape = list(arrays[0].shape)
    shape[axis] = sum(array.shape[axis] for array in arrays)
    chunks = [(array.values, math.prod(array.shape[axis:])) for array in arrays]
    values = [
        KINDS[kind](entry)
        for k in range(math.prod(shape[:axis]))
        # fmt: skip
        for values, length in chunks
        for entry in values[k * length : (k + 1) * length]
    ]
    return Array(values, shape, kind)


@offered
def stack(arrays, axis=0):
    arrays = [as_array(array) for array in arrays]
    axis = range(arrays[0].ndim + 1)[axis]
    return concatenate(
        [array.reshape(*array.shape[:axis], 1, *array.shape[axis:]) for array in arrays], axis
    )


@offered
def column_stack(tup):
    return concatenate(
        [array.reshape(-1, 1) if array.ndim < 2 else array for array in map(as_array, tup)], 1
    )


@offered
def diag(v):
    value = as_array(v)
    if value.ndim == 1:
        matrix = zeros((value.size, value.size), value.dtype)
        for k, entry in enumerate(value.values):
            matrix[k, k] = entry
        return matrix
    if value.ndim != 2:
        raise NotImplementedError("stacks")
    return Array(
        [value[k, k].tolist() for k in range(min(value.shape))], (min(value.shape),), value.kind
    )


# --- along an axis ------------------------------------------------------------------------------


def pairwise(values):
    """Return the sum of floats in the order in which NumPy adds them up."""
    count = len(values)
    if count < 8:
        total = 0.0 if count == 0 else values[0]
        for value in values[1:]:
            total += value
        return total
    if count <= 128:
        r = list(values[:8])
        for start in range(8, count - count % 8, 8):
            r = [subtotal + value for subtotal, value in zip(r, values[start : start + 8])]
        total = ((r[0] + r[1]) + (r[2] + r[3])) + ((r[4] + r[5]) + (r[6] + r[7]))
        for value in values[count - count % 8 :]:
            total += value
        return total
    half = count // 2
    half -= half % 8
    return pairwise(values[:half]) + pairwise(values[half:])


def in_turn(values):
    total = values[0]
    for value in values[1:]:
        total += value
    return total


def along(value, axis, function, kind=None, keepdims=False, across=None):
    """Apply ``function`` to the lists of entries along one axis, several, or all (None).

    For an axis that is not the last, NumPy adds up in another order, so ``across`` is applied.
    """
    value = as_array(value)
    kind = kind or value.kind
    if axis is None:
        axes = range(value.ndim)
    elif type(axis) in (int, tuple) and value.ndim:
        axes = [axis] if type(axis) is int else axis
    else:
        raise TypeError("other axes")
    axes = sorted(operator.index(k) + (value.ndim if k < 0 else 0) for k in axes)
    if any(k not in range(value.ndim) for k in axes) or len(set(axes)) < len(axes):
        raise ValueError("axes")
    axes_kept = [k for k in range(value.ndim) if k not in axes]
    if axes_kept and axes and axes[-1] < axes_kept[-1] and across:
        if len(axes) > 1:
            raise NotImplementedError("several axes that are not the last")
        function = across
    count = math.prod(value.shape[k] for k in axes)
    entries = (value.transpose(*axes_kept, *axes) if axes_kept and axes else value).values
    shape = tuple(value.shape[k] for k in axes_kept)
    values = (
        [
            function(entries[start : start + count])
            for start in range(0, count * math.prod(shape), count)
        ]
        if count
        else []
    )
    if not count:
        raise ValueError("nothing along the axis")
    if keepdims:
        shape = tuple(1 if k in axes else length for k, length in enumerate(value.shape))
    return result(values, shape, kind)


def reduction(name, function, kind=None, across=None):
    """Offer a reduction as a function and as a method."""

    def applied(a, axis=None, *, keepdims=False):
        return along(a, axis, function, kind, keepdims, across)

    applied.__name__ = name
    offered(applied)
    setattr(Array, name, applied)


def largest(values):
    maximum = max(values)
    return maximum if all_finite(values) or not any(map(math.isnan, values)) else nan


def smallest(values):
    minimum = min(values)
    return minimum if all_finite(values) or not any(map(math.isnan, values)) else nan


def without_truth(value):
    if isinstance(value, bool):
        raise TypeError("truth values")
    return value


reduction("max", largest)
reduction("min", smallest)
reduction("all", all, "b")
reduction("any", any, "b")
reduction("ptp", lambda values: without_truth(largest(values)) - smallest(values))
reduction("count_nonzero", lambda values: sum(map(bool, values)), "i")
OFFERED.update({"amax": OFFERED["max"], "amin": OFFERED["min"]})


def place_of(choose):
    def place_in(values):
        if not all_finite(values):
            raise ValueError("not finite")
        return values.index(choose(values))

    return place_in


def place(name, choose):
    def applied(a, axis=None):
        if isinstance(axis, tuple):
            raise TypeError("several axes")
        return along(a, axis, place_of(choose), "i")

    applied.__name__ = name
    offered(applied)
    setattr(Array, name, applied)


place("argmax", max)
place("argmin", min)


def sum_(a, axis=None, *, keepdims=False):
    value = as_array(a)
    if value.kind != "f":
        return along(value, axis, sum, "i", keepdims)
    if axis is None and not isinstance(value.places, range) and value.ndim > 1:
        raise NotImplementedError("NumPy adds the entries of such a view in another order")
    return along(value, axis, pairwise, "f", keepdims, in_turn)


def mean(a, axis=None, *, keepdims=False):
    value = as_array(a, float)
    total = sum_(value, axis, keepdims=keepdims)
    return total / (value.size // max(as_array(total).size, 1))


def std(a, axis=None):
    value = as_array(a, float)
    return OFFERED["sqrt"](mean((value - mean(value, axis, keepdims=True)) ** 2, axis))


for _function in (sum_, mean, std):
    setattr(Array, _function.__name__.rstrip("_"), _function)
    offered(_function)


@offered
def cumsum(a, axis=None):
    value = as_array(a)
    if axis is None:
        value, axis = value.ravel(), 0
    last = value.swapaxes(axis, -1)
    length = last.shape[-1]
    rows = [last.values[start : start + length] for start in range(0, last.size, length)]
    sums = Array(
        [entry for row in rows for entry in itertools.accumulate(row)],
        last.shape,
        "i" if value.kind == "b" else value.kind,
    )
    return sums.swapaxes(axis, -1)


def between(value, axis):
    """Return all but the first along an axis, and all but the last."""
    front = (slice(None),) * range(value.ndim)[axis]
    return value[(*front, slice(1, None))], value[(*front, slice(None, -1))]


@offered
def diff(a, n=1, axis=-1, prepend=None):
    value = as_array(a)
    if value.kind == "b" or n != 1:
        raise NotImplementedError("truth values, or differences of differences")
    if prepend is not None:
        if value.ndim != 1 or as_array(prepend).ndim > 1:
            raise NotImplementedError("prepend")
        value = concatenate([as_array(prepend).reshape(-1), value])
    after, before = between(value, axis)
    return after - before


@offered
def unravel_index(indices, shape):
    place = operator.index(indices)
    if not 0 <= place < math.prod(shape):
        raise IndexError(place)
    return tuple(
        Integer(place // step % length) for step, length in zip(steps_of(tuple(shape)), shape)
    )


@offered
def searchsorted(a, v, side="left"):
    find = {"left": bisect.bisect_left, "right": bisect.bisect_right}[side]
    ordered = as_array(a)
    if ordered.ndim != 1:
        raise ValueError("one axis")
    values = ordered.values
    return entry_by_entry(lambda entry: find(values, entry), v, kind="i")


# --- products, and matrices ---------------------------------------------------------------------


def spend(count):
    global work
    work += count
    if work > MOST_WORK:
        real()


def product(first, second):
    """Return ``first @ second``, rows times columns."""
    first, second = as_array(first), as_array(second)
    if not first.shape or not second.shape:
        raise ValueError("NumPy says in its own words which of the two")
    left = first.reshape(1, -1) if first.ndim == 1 else first
    right = second.reshape(-1, 1) if second.ndim == 1 else second
    if left.shape[-1] != right.shape[-2]:
        sizes = f"size {right.shape[-2]} is different from {left.shape[-1]}"
        raise UserError(
            ValueError(
                "matmul: Input operand 1 has a mismatch in its core dimension 0, with gufunc "
                "signature (n?,k),(k,m?)->(n?,m?) "
                f"({sizes})"
            )
        )
    kind = max(first.kind, second.kind, key="bif".index)
    if kind == "b":
        raise TypeError("truth values")
    batch = common_shape(left.shape[:-2], right.shape[:-2])
    (n, k), m = left.shape[-2:], right.shape[-1]
    spend(math.prod(batch) * n * k * m // 4)
    lefts = spread(left, (*batch, n, k))
    rights = spread(right.swapaxes(-1, -2), (*batch, m, k))
    values = []
    for b in range(math.prod(batch)):
        rows = [lefts[start : start + k] for start in range(b * n * k, (b + 1) * n * k, k)]
        columns = [rights[start : start + k] for start in range(b * m * k, (b + 1) * m * k, k)]
        values += [
            in_turn(list(map(operator.mul, row, column))) for row in rows for column in columns
        ]
    shape = batch + ((n,) if first.ndim > 1 else ()) + ((m,) if second.ndim > 1 else ())
    return result(values, shape, kind)


@offered
def cross(a, b):
    left, right = as_array(a), as_array(b)
    if left.shape[-1] != 3 or right.shape[-1] != 3:
        raise ValueError("three components")
    (r, s, t), (x, y, z) = ([value[..., k] for k in range(3)] for value in (left, right))
    return stack([s * z - t * y, t * x - r * z, r * y - s * x], -1)


@offered
def trace(a):
    value = as_array(a)
    if value.ndim < 2:
        raise ValueError("a matrix")
    return sum_(diag(value))


def matrices(value):
    """Return the square matrices of a stack, as lists of rows, and the shape of the stack."""
    value = as_array(value, float)
    if value.ndim < 2 or value.shape[-1] != value.shape[-2] or not all_finite(value.values):
        raise ValueError("square matrices")
    n = value.shape[-1]
    spend(value.size * n * 12)
    return nested(value.values, (value.size // (n * n), n, n)), value.shape[:-2], n


def inner(x, y):
    return sum(map(operator.mul, x, y))


def determinant(rows):
    """Return the determinant by Gaussian elimination with row exchanges."""
    rows, product_of_pivots = [row[:] for row in rows], 1.0
    for k in range(len(rows)):
        best = max(range(k, len(rows)), key=lambda i: abs(rows[i][k]))
        if best != k:
            rows[k], rows[best] = rows[best], rows[k]
            product_of_pivots = -product_of_pivots
        pivot = rows[k][k]
        product_of_pivots *= pivot
        for i in range(k + 1, len(rows)):
            factor = rows[i][k] / pivot if pivot else 0.0
            rows[i] = [a - factor * b for a, b in zip(rows[i], rows[k])]
    return product_of_pivots


@within("linalg")
def det(a):
    stack_of, batch, _ = matrices(a)
    # Its digits next to zero differ between processors, with NumPy too.
    return result(list(map(determinant, stack_of)), batch, "f")


SVDResult = collections.namedtuple("SVDResult", "U S Vh")


def singular(rows):
    """Decompose by rotating columns (Hestenes).

    Returns the columns of the left factor, the singular values, and the rows of the right factor.
    """
    n = len(rows)
    columns, right = [list(column) for column in zip(*rows)], eye(n).tolist()
    for _ in range(60):
        turned = False
        for p in range(n):
            for q in range(p + 1, n):
                alpha, beta = inner(columns[p], columns[p]), inner(columns[q], columns[q])
                gamma = inner(columns[p], columns[q])
                if abs(gamma) <= 1e-17 * math.sqrt(alpha * beta):
                    continue
                turned = True
                zeta = (beta - alpha) / (2 * gamma)
                t = math.copysign(1, zeta) / (abs(zeta) + math.hypot(zeta, 1))
                c = 1 / math.hypot(t, 1)
                s = c * t
                for pair in (columns, right):
                    pair[p], pair[q] = (
                        [c * x - s * y for x, y in zip(pair[p], pair[q])],
                        # fmt: skip
                        [s * x + c * y for x, y in zip(pair[p], pair[q])],
                    )
        if not turned:
            break
    sizes = [math.hypot(*column) for column in columns]
    order = sorted(range(n), key=lambda k: -sizes[k])
    return [columns[k] for k in order], [sizes[k] for k in order], [right[k] for k in order]


def orthonormal(columns, sizes):
    """Scale orthogonal columns to unit length.

    A column that has shrunk to zero is replaced by another that is orthogonal to the rest.
    """
    units = []
    for column, size in zip(columns, sizes):
        if size <= 1e-14 * sizes[0] or not size:
            rests = []
            for unit in eye(len(columns)).tolist():
                for _ in range(2):
                    for previous in units:
                        share = inner(unit, previous)
                        unit = [a - share * b for a, b in zip(unit, previous)]
                rests.append(unit)
            column = max(rests, key=lambda rest: inner(rest, rest))
            size = math.hypot(*column)
        units.append([entry / size for entry in column])
    return units


@within("linalg")
def svd(a, full_matrices=True, compute_uv=True):
    stack_of, batch, n = matrices(a)
    spend(len(stack_of) * n**3 * 90)
    lefts, sizes, rights = [], [], []
    for rows in stack_of:
        columns, own, right = singular(rows)
        if compute_uv:
            columns = orthonormal(columns, own)
            # No rule determines the signs of the vectors, and they differ between processors with
            # NumPy, too. The product of the factors is the matrix.
            lefts += [entry for row in zip(*columns) for entry in row]
            rights += [entry for row in right for entry in row]
        sizes += own
    sizes = Array(sizes, (*batch, n), "f")
    if not compute_uv:
        return sizes
    left, right = (Array(entries, (*batch, n, n), "f") for entries in (lefts, rights))
    return SVDResult(left, sizes, right)


@within("linalg")
def norm(x, *, axis=None, keepdims=False):
    value = as_array(x, float)
    if axis is None and value.ndim < 3 or isinstance(axis, tuple) and len(axis) > 2:
        value, axis = (value.ravel(), None) if not keepdims else (value, axis)
    return OFFERED["sqrt"](sum_(value * value, axis, keepdims=keepdims))


@within("linalg")
def matrix_power(a, n):
    power, matrix, exponent = None, as_array(a), operator.index(n)
    if exponent < 1 or matrix.ndim < 2 or matrix.shape[-1] != matrix.shape[-2]:
        raise ValueError("positive powers of square matrices")
    if exponent == 3:
        return product(product(matrix, matrix), matrix)
    while exponent:
        exponent, odd = divmod(exponent, 2)
        power = (matrix if power is None else product(power, matrix)) if odd else power
        matrix = product(matrix, matrix) if exponent else matrix
    return power


class Quiet:
    """A context without effect: nothing here warns, and the real NumPy does whatever would."""

    def __init__(self, **settings):
        pass

    def __enter__(self):
        return self

    def __exit__(self, *error):
        return None


OFFERED["errstate"] = Quiet


# --- random numbers: PCG64, seeded and shaped as NumPy does it (O'Neill 2014; Marsaglia and Tsang 2

WORD, LONG, HUGE = 2**32 - 1, 2**64 - 1, 2**128 - 1


def seeded(seed):
    """Return the state and the increment of PCG64 for an integer, as NumPy's SeedSequence does."""
    words = []
    while seed or not words:
        words.append(seed & WORD)
        seed >>= 32
    constant = 0x43B0D7E5

    def hashed(value):
        nonlocal constant
        value ^= constant
        constant = constant * 0x931E8875 & WORD
        value = value * constant & WORD
        return value ^ value >> 16

    def mixed(x, y):
        difference = (0xCA01F9DD * x - 0x4973F715 * y) & WORD
        return difference ^ difference >> 16

    pool = [hashed(words[k] if k < len(words) else 0) for k in range(4)]
    for source, target in itertools.product(range(4), range(4)):
        if source != target:
            pool[target] = mixed(pool[target], hashed(pool[source]))
    for word, target in itertools.product(words[4:], range(4)):
        pool[target] = mixed(pool[target], hashed(word))
    constant, parts = 0x8B51F9DD, []
    for k in range(8):
        value = pool[k % 4] ^ constant
        constant = constant * 0x58F38DED & WORD
        value = value * constant & WORD
        parts.append(value ^ value >> 16)
    first, second, third, fourth = (parts[k] | parts[k + 1] << 32 for k in range(0, 8, 2))
    return first << 64 | second, third << 64 | fourth


# NumPy's table of widths was computed with rounding. This is its largest error, in units in the
# last place.
ROUNDED = """
    -9 -130 -40 -33 -28 -26 -26 -22 -22 -11 -10 -9 -8 -8 -8 -8 -8 -9 -8 -8 -9 -9 -9 -10 -9 -8 -8 -7
    -8 -8 -8 -7 -8 -8 -7 -7 -8 -8 -6 -6 -6 -5 -5 -6 -5 -6 -5 -5 -5 -5 -6 -6 -3 -4 -4 -4 -4 -4 -4 -4
    -3 -4 -3 -3 -3 -3 -4 -3 -4 -3 -3 -4 -3 -2 -2 -3 -3 -3 -4 -3 -3 -3 -3 -3 -3 -3 -2 -2 -2 -2 -2 -1
    -1 -1 -1 -1 -2 -2 -1 -2 -2 -2 -2 -2 -1 -2 -2 -2 -2 -2 -3 -3 -3 -2 -2 -2 -1 -1 -2 -2 -2 -2 -1 -1
    -1 -1 -1 -2 -2 -2 -1 -1 -2 -2 -2 -2 -2 -2 -2 -2 -3 -4 -4 -4 -3 -3 -3 -3 -2 -2 -2 -1 -1 -1 -1 -1
    0 0 0 0 0 -1 -1 0 -1 0 -1 -1 -1 0 0 0 1 2 3 3 3 2 2 1 0 0 0 0 0 0 0 0 -1 0 0 0 0 0 0 -1 -1 -1 -1
    -1 -2 -1 -2 -2 -2 -2 -2 -2 -1 -1 -1 -1 -1 0 -1 -1 -1 0 0 0 -1 -1 0 0 0 0 0 0 -1 0 0 -1 0 -1 -1
    -1 -1 -1 -1 -1 -1 0 1 0 1 1 1 1 1 1 0 0 0 1 1 0
""".split()


@functools.cache
def ziggurat():
    """Return the 256 layers of equal area under the bell curve.

    The results are their bounds as integers, their widths and their heights.
    """
    import mpmath

    with mpmath.workdps(60):
        start = mpmath.mpf("3.6541528853610087963519472518")
        height = lambda x: mpmath.exp(-x * x / 2)  # noqa: E731
        area = start * height(start) + mpmath.sqrt(mpmath.pi / 2) * mpmath.erfc(
            start / mpmath.sqrt(2)
        )
        edges = [start]
        for _ in range(254):
            edges.append(mpmath.sqrt(-2 * mpmath.log(area / edges[-1] + height(edges[-1]))))
        # From the widest layer, which represents the tail, to the narrowest.
        edges = [area / height(start), *edges]
        scale = mpmath.mpf(2) ** 52
        widths = [edges[0], *reversed(edges[1:])]
        bounds = [edges[1] / edges[0], 0, *(widths[k - 1] / widths[k] for k in range(2, 256))]
        widths = [float(width / scale) for width in widths]
        heights = [1.0, *(float(height(width * scale)) for width in widths[1:])]
        bounds = [int(bound * scale) for bound in bounds]
    return (
        bounds,
        [width + int(more) * math.ulp(width) for width, more in zip(widths, ROUNDED)],
        heights,
    )


class Generator:
    """``numpy.random.default_rng``, for uniform and normal numbers."""

    def __init__(self, seed):
        start, increment = seeded(seed)
        self.increment = (increment << 1 | 1) & HUGE
        self.state = self.increment
        self.state = (self.state + start) & HUGE
        self.step()
        self.successor = None

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(self.as_real(), name)

    def as_real(self):
        """Return the real generator that goes on from this state; from then on it draws alone."""
        if self.successor is None:
            bits = real().random.PCG64(0)
            inner = {"state": self.state, "inc": self.increment}
            bits.state = {"bit_generator": "PCG64", "state": inner, "has_uint32": 0, "uinteger": 0}
            self.successor = real().random.Generator(bits)
        return self.successor

    def step(self):
        self.state = (self.state * 0x2360ED051FC65DA44385DF649FCCF645 + self.increment) & HUGE

    def bits(self):
        state = self.state = (
            self.state * 0x2360ED051FC65DA44385DF649FCCF645 + self.increment
        ) & HUGE
        value, turn = (state >> 64 ^ state) & LONG, state >> 122
        return (value >> turn | value << (64 - turn)) & LONG

    def share(self):
        return (self.bits() >> 11) * 2.0**-53

    def bell(self):
        bounds, widths, heights = ziggurat()
        while True:
            bits = self.bits()
            layer, sign, whole = bits & 0xFF, bits >> 8 & 1, bits >> 9 & (2**52 - 1)
            value = -whole * widths[layer] if sign else whole * widths[layer]
            if whole < bounds[layer]:
                return value
            if layer == 0:
                edge = 3.6541528853610088
                while True:
                    beyond = -math.log1p(-self.share()) * 0.27366123732975828
                    if -2 * math.log1p(-self.share()) > beyond * beyond:
                        return -(edge + beyond) if whole >> 8 & 1 else edge + beyond
            elif (heights[layer - 1] - heights[layer]) * self.share() + heights[layer] < math.exp(
                -0.5 * value * value
            ):
                return value

    def drawn(self, draw, size):
        if self.successor is not None:
            raise NotImplementedError(
                "NumPy's own generator has continued from this one, which can no longer be used"
            )
        if size is None:
            return draw()
        shape = shape_of((size,))
        spend(4 * math.prod(shape))
        return Array([draw() for _ in range(math.prod(shape))], shape, "f")

    def uniform(self, low=0.0, high=1.0, size=None):
        low, width = float(low), float(high) - float(low)
        return self.drawn(lambda: low + width * self.share(), size)

    def normal(self, loc=0.0, scale=1.0, size=None):
        loc, scale = float(loc), float(scale)
        if scale < 0:
            raise ValueError("scale")
        return self.drawn(lambda: loc + scale * self.bell(), size)


def _from_here_on(name):
    """Return a generator's method, with a fallback to a real one that goes on from its state."""

    def find(numpy, arguments):
        return lambda self, *rest, **options: getattr(self.as_real(), name)(*rest, **options)

    return or_the_real_one(vars(Generator)[name], find)


for _name in ("uniform", "normal"):
    setattr(Generator, _name, _from_here_on(_name))


@within("random")
def default_rng(seed):
    if isinstance(seed, Generator):
        return seed
    if not isinstance(seed, int) or isinstance(seed, bool) or seed < 0:
        raise TypeError("not a whole number")
    return Generator(int(seed))


# --- writing ------------------------------------------------------------------------------------


def places_after(value, form):
    return len(format(value, form).partition("e")[0].rstrip("0").partition(".")[2])


def writer(values, kind):
    """Return the function that formats the entries to one width, with NumPy's default settings."""
    if kind == "b":
        return lambda value: f"{value!s:>5}"
    if kind == "i":
        width = max((len(str(value)) for value in values), default=0)
        return lambda value: f"{value:>{width}}"
    finite = [value for value in values if math.isfinite(value)]
    sizes = [abs(value) for value in finite if value]
    exponents = bool(sizes) and (
        max(sizes) >= 1e8 or min(sizes) < 1e-4 or max(sizes) / min(sizes) > 1000
    )
    form = "e" if exponents else "f"
    digits = max(
        (min(places_after(value, f".8{form}"), shortest(value, form)) for value in finite),
        default=0,
    )

    def written_entry(value):
        if not math.isfinite(value):
            return str(value)
        text = format(value, f".{digits}{form}")
        if digits:
            head, _, tail = text.partition("e")
            if form == "f":
                whole, _, rest = head.partition(".")
                return f"{whole}.{rest.rstrip('0'):<{digits}}"
            return text
        return text.replace("e", ".e") if exponents else f"{text}."

    width = max((len(written_entry(value)) for value in values), default=0)
    return lambda value: f"{written_entry(value):>{width}}"


def shortest(value, form):
    """Return the number of decimals in the shortest representation of a float."""
    import decimal

    digits, exponent = decimal.Decimal(repr(value)).as_tuple()[1:]
    if form == "e":
        return len("".join(map(str, digits)).rstrip("0") or "0") - 1
    return max(-exponent, 0)


def written_array(value, between, prefix):
    """Format an array as NumPy does, in lines of at most 75 characters."""
    if value.size > 1000:
        raise NotImplementedError("NumPy leaves out the middle")
    write = writer(value.values, value.kind)
    if not value.shape:
        text = write(value.values[0])
        return text if value.kind != "f" or between == ", " else str(value.values[0])
    room = 75 - len(")" if prefix else "")

    def lines(part, hanging, depth):
        if part.ndim == 1:
            text, line = "", hanging
            entries = [write(entry) for entry in part.values]
            for k, entry in enumerate(entries):
                last = k == len(entries) - 1
                if len(line) + len(entry) > room - depth and len(line) > len(hanging):
                    text += line.rstrip() + "\n"
                    line = hanging
                line += entry + ("" if last else between)
            return f"[{(text + line)[len(hanging) :]}]"
        joint = between.rstrip() + "\n" * (part.ndim - 1) + hanging
        return f"[{joint.join(lines(own, hanging + ' ', depth + 1) for own in part)}]"

    return lines(value, " " * (len(prefix) + 1), 1)


# The real array or number can answer whatever these methods cannot.
_OWN = {
    "__init__",
    "__getattr__",
    "__array__",
    "__reduce__",
    "__hash__",
    "view",
    "select",
    "__repr__",
    "__str__",
}
for _owner in (Array, Number, Integer, Truth):
    for _name, _method in list(vars(_owner).items()):
        if callable(_method) and (
            _name not in _OWN or _owner is Array and _name in ("__repr__", "__str__")
        ):

            def _find(numpy, arguments, name=_name):
                return lambda self, *rest, **options: getattr(self, name)(*rest, **options)

            setattr(_owner, _name, or_the_real_one(_method, _find))
