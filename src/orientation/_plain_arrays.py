"""What stands for an array of numbers where there is no NumPy, as in a browser that has not fetched it.

It holds one vector or one matrix and does what one does with an orientation by hand: entries, rows, sums,
multiples, products, rounding, and showing, all with NumPy's results. Whatever else it is asked for, it asks
NumPy, so that the error where that is not here names it.
"""

import operator


def _leave_out(name):
    # Others ask by such names what kind of thing this is; an array of NumPy has none of them.
    if name.startswith("_") or name in ("filled", "free_symbols"):
        raise AttributeError(name)


class Number(float):
    """An entry: a float that looks and can be asked as NumPy's own do."""

    ndim, shape = 0, ()

    def __repr__(self):
        return f"np.float64({float(self)!r})"

    __str__ = float.__repr__

    def tolist(self):
        return float(self)

    def __getattr__(self, name):
        _leave_out(name)
        import numpy

        return getattr(numpy.float64(self), name)


class PlainArray:
    """A vector of numbers (``rows`` is a list of them), or a matrix (a list of lists)."""

    __array_priority__ = 0  # where both meet, NumPy decides
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, rows):
        self.rows = rows
        self.shape = (len(rows), len(rows[0])) if isinstance(rows[0], list) else (len(rows),)
        self.ndim = len(self.shape)

    @classmethod
    def of(cls, entries, shape):
        if len(shape) == 1:
            return cls(list(entries))
        width = shape[1]
        return cls([list(entries[start : start + width]) for start in range(0, len(entries), width)])

    def __getattr__(self, name):
        _leave_out(name)
        return getattr(self._array(), name)

    def _array(self):
        import numpy

        return numpy.array(self.rows)

    def __array__(self, dtype=None, copy=None):
        return self._array() if dtype is None else self._array().astype(dtype)

    def tolist(self):
        return [row[:] if isinstance(row, list) else row for row in self.rows]

    @property
    def T(self):
        return PlainArray([list(column) for column in zip(*self.rows)]) if self.ndim == 2 else self

    def __len__(self):
        return len(self.rows)

    def __iter__(self):
        return iter(map(_wrapped, self.rows))

    def __getitem__(self, place):
        places = [part for part in (place if isinstance(place, tuple) else (place,)) if part is not Ellipsis]
        if (isinstance(place, tuple) and place[0] is Ellipsis and len(places) < self.ndim) or not all(
            isinstance(part, (int, slice)) for part in places
        ):
            return self._array()[place]
        rows = self.rows[places[0]]
        if len(places) == 2:
            rows = [row[places[1]] for row in rows] if isinstance(places[0], slice) else rows[places[1]]
        return _wrapped(rows)

    def _with(self, other, work):
        """``work`` on the entries of both; a number, or a row for each row, stands for as many as there are."""
        if isinstance(other, (int, float)):
            return _mapped(self.rows, lambda entry: work(entry, other))
        other = other.tolist() if isinstance(other, PlainArray) else other
        if not isinstance(other, (list, tuple)):
            return NotImplemented
        if self.ndim == 1 and _shape(other) == self.shape:
            return PlainArray([work(one, two) for one, two in zip(self.rows, other)])
        if self.ndim == 2 and _shape(other) in (self.shape, self.shape[1:]):
            others = other if len(_shape(other)) == 2 else [other] * len(self.rows)
            return PlainArray([[work(a, b) for a, b in zip(row, two)] for row, two in zip(self.rows, others)])
        return work(self._array(), other)

    def __matmul__(self, other):
        rows = other.rows if isinstance(other, PlainArray) else other
        if not isinstance(rows, (list, tuple)) or self.shape[-1] != len(rows):
            return NotImplemented if not isinstance(rows, (list, tuple)) else self._array() @ rows
        right = list(zip(*rows)) if len(_shape(rows)) == 2 else [rows]
        left = self.rows if self.ndim == 2 else [self.rows]
        product = [[sum(map(operator.mul, row, column)) for column in right] for row in left]
        if len(_shape(rows)) == 1:
            product = [row[0] for row in product]
        return _wrapped(product if self.ndim == 2 else product[0])

    def __neg__(self):
        return _mapped(self.rows, operator.neg)

    def __abs__(self):
        return _mapped(self.rows, abs)

    def round(self, digits=0):
        return _mapped(self.rows, lambda entry: round(entry, digits))

    def max(self):
        return Number(max(self.entries()))

    def min(self):
        return Number(min(self.entries()))

    def entries(self):
        """All of them, row by row."""
        return [entry for row in self.rows for entry in row] if self.ndim == 2 else self.rows

    def __str__(self):
        return self._shown(" ", 1)

    def __repr__(self):
        return f"array({self._shown(', ', 7)})"

    def _shown(self, between, indent):
        entries = self.entries()
        sizes = [abs(entry) for entry in entries if entry]
        if sizes and (max(sizes) >= 1e8 or min(sizes) < 1e-4 or max(sizes) / min(sizes) > 1000):
            return str(self._array()) if between == " " else repr(self._array())[6:-1]
        parts = [f"{entry:.8f}".rstrip("0").partition(".") for entry in entries]
        before, after = max(len(whole) for whole, _, _ in parts), max(len(rest) for _, _, rest in parts)
        texts = [f"{whole:>{before}}.{rest:<{after}}" for whole, _, rest in parts]
        if self.ndim == 1:
            return f"[{between.join(texts)}]"
        width = self.shape[1]
        lines = [f"[{between.join(texts[start : start + width])}]" for start in range(0, len(texts), width)]
        return f"[{(between.strip() + chr(10) + ' ' * indent).join(lines)}]"


def _operation(work, swapped=False):
    if swapped:
        return lambda self, other: self._with(other, lambda one, two: work(two, one))
    return lambda self, other: self._with(other, work)


for _name in ("add", "sub", "mul", "truediv", "pow"):
    setattr(PlainArray, f"__{_name}__", _operation(getattr(operator, _name)))
    setattr(PlainArray, f"__r{_name}__", _operation(getattr(operator, _name), swapped=True))
for _name in ("eq", "ne", "lt", "le", "gt", "ge"):
    setattr(PlainArray, f"__{_name}__", _operation(getattr(operator, _name)))


def _shape(rows):
    return (len(rows), len(rows[0])) if isinstance(rows[0], (list, tuple)) else (len(rows),)


def _wrapped(rows):
    return PlainArray(rows) if isinstance(rows, list) else Number(rows)


def _mapped(rows, work):
    return PlainArray([[work(entry) for entry in row] if isinstance(row, list) else work(row) for row in rows])
