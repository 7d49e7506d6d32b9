"""What stands for an array of numbers where there is no NumPy, as in a browser that has not fetched
it.

It holds one vector or one matrix and does what one does with an orientation by hand: entries, rows,
sums, multiples, products, rounding, and showing, all with NumPy's results. Whatever else it is
asked for, it asks NumPy, so that the error where that is not here names it.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator, Sequence
from types import EllipsisType
from typing import TYPE_CHECKING, Protocol, TypeAlias, overload

if TYPE_CHECKING:
    from numpy.typing import DTypeLike

    from ._types import Array

Nested: TypeAlias = "float | list[Nested]"
Place: TypeAlias = "int | slice[int | None, int | None, int | None] | EllipsisType | None"


class Operation(Protocol):
    """An operator, of numbers or of what NumPy has of them."""

    @overload
    def __call__(self, one: float, other: float, /) -> float: ...
    @overload
    def __call__(self, one: object, other: object, /) -> object: ...


def _leave_out(name: str) -> None:
    # Others ask by such names what kind of thing this is; an array of NumPy has none of them.
    if name.startswith("_") or name in ("filled", "free_symbols"):
        raise AttributeError(name)


class Number(float):
    """An entry: a float that looks and can be asked as NumPy's own do."""

    ndim, shape = 0, ()

    def __repr__(self) -> str:
        return f"np.float64({float(self)!r})"

    __str__ = float.__repr__

    def tolist(self) -> float:
        return float(self)

    def __getattr__(self, name: str) -> object:
        _leave_out(name)
        import numpy

        return getattr(numpy.float64(self), name)


class PlainArray:
    """A vector of numbers (``rows`` is a list of them), or a matrix (a list of lists)."""

    __array_priority__ = 0  # where both meet, NumPy decides
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, rows: list[Nested]) -> None:
        self.rows = rows
        self.shape = _shape(rows)
        self.ndim = len(self.shape)

    @classmethod
    def of(cls, entries: Sequence[float], shape: tuple[int, ...]) -> PlainArray:
        if len(shape) == 1:
            return cls(list(entries))
        width = shape[1]
        return cls(
            [list(entries[start : start + width]) for start in range(0, len(entries), width)]
        )

    def __getattr__(self, name: str) -> object:
        _leave_out(name)
        return getattr(self._array(), name)

    def _array(self) -> Array:
        import numpy

        return numpy.array(self.rows)

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> Array:
        return self._array() if dtype is None else self._array().astype(dtype)

    def tolist(self) -> list[Nested]:
        return [row[:] if isinstance(row, list) else row for row in self.rows]

    @property
    def T(self) -> PlainArray:
        if self.ndim == 1:
            return self
        return PlainArray(
            [[_at(row, place) for row in self.rows] for place in range(self.shape[1])]
        )

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[PlainArray | Number]:
        return iter(map(_wrapped, self.rows))

    def __getitem__(self, place: Place | tuple[Place, ...]) -> object:
        places = [
            part
            for part in (place if isinstance(place, tuple) else (place,))
            if part is not Ellipsis
        ]
        known = [part for part in places if isinstance(part, (int, slice))]
        to_the_last = isinstance(place, tuple) and place[0] is Ellipsis and len(places) < self.ndim
        if to_the_last or not known or len(known) < len(places):
            return self._array()[place]
        rows = _at(self.rows, known[0])
        if len(known) == 2:
            if isinstance(known[0], slice) and isinstance(rows, list):
                rows = [_at(row, known[1]) for row in rows]
            else:
                rows = _at(rows, known[1])
        return _wrapped(rows)

    def _with(self, other: object, work: Operation, swapped: bool) -> object:
        """``work`` on the entries of both; a number, or a row for each row, stands for as many as
        there are.
        """

        def on_numbers(one: float, two: float) -> float:
            return work(two, one) if swapped else work(one, two)

        if isinstance(other, (int, float)):
            return PlainArray(
                [_each(row, lambda entry: on_numbers(entry, other)) for row in self.rows]
            )
        rows = other.rows if isinstance(other, PlainArray) else other
        if not isinstance(rows, (list, tuple)):
            return NotImplemented
        if _shape(rows) == self.shape:
            return PlainArray([_both(row, two, on_numbers) for row, two in zip(self.rows, rows)])
        if self.ndim == 2 and _shape(rows) == self.shape[1:]:
            return PlainArray([_both(row, list(rows), on_numbers) for row in self.rows])
        return work(rows, self._array()) if swapped else work(self._array(), rows)

    def __matmul__(self, other: object) -> object:
        rows = other.rows if isinstance(other, PlainArray) else other
        if not isinstance(rows, (list, tuple)):
            return NotImplemented
        if self.shape[-1] != len(rows):
            return self._array() @ rows
        columns = list(zip(*rows)) if len(_shape(rows)) == 2 else [rows]
        left = (
            [row for row in self.rows if isinstance(row, list)] if self.ndim == 2 else [self.rows]
        )
        product: list[Nested] = [
            [sum(map(operator.mul, row, column)) for column in columns] for row in left
        ]
        if len(_shape(rows)) == 1:
            product = [_at(row, 0) for row in product]
        return _wrapped(product if self.ndim == 2 else product[0])

    def __neg__(self) -> PlainArray:
        return PlainArray([_each(row, operator.neg) for row in self.rows])

    def __abs__(self) -> PlainArray:
        return PlainArray([_each(row, abs) for row in self.rows])

    def round(self, digits: int = 0) -> PlainArray:
        return PlainArray([_each(row, lambda entry: round(entry, digits)) for row in self.rows])

    def max(self) -> Number:
        return Number(max(self.entries()))

    def min(self) -> Number:
        return Number(min(self.entries()))

    def entries(self) -> list[float]:
        return _flat(self.rows)

    def __str__(self) -> str:
        return self._shown(" ", 1)

    def __repr__(self) -> str:
        return f"array({self._shown(', ', 7)})"

    def _shown(self, between: str, indent: int) -> str:
        entries = self.entries()
        sizes = [abs(entry) for entry in entries if entry]
        if sizes and (max(sizes) >= 1e8 or min(sizes) < 1e-4 or max(sizes) / min(sizes) > 1000):
            return str(self._array()) if between == " " else repr(self._array())[6:-1]
        parts = [f"{entry:.8f}".rstrip("0").partition(".") for entry in entries]
        before, after = (
            max(len(whole) for whole, _, _ in parts),
            max(len(rest) for _, _, rest in parts),
        )
        texts = [f"{whole:>{before}}.{rest:<{after}}" for whole, _, rest in parts]
        if self.ndim == 1:
            return f"[{between.join(texts)}]"
        width = self.shape[1]
        lines = [
            f"[{between.join(texts[start : start + width])}]"
            for start in range(0, len(texts), width)
        ]
        return f"[{(between.strip() + chr(10) + ' ' * indent).join(lines)}]"


def _operation(work: Operation, swapped: bool = False) -> Callable[[PlainArray, object], object]:
    return lambda self, other: self._with(other, work, swapped)


for _name in ("add", "sub", "mul", "truediv", "pow"):
    setattr(PlainArray, f"__{_name}__", _operation(getattr(operator, _name)))
    setattr(PlainArray, f"__r{_name}__", _operation(getattr(operator, _name), swapped=True))
for _name in ("eq", "ne", "lt", "le", "gt", "ge"):
    setattr(PlainArray, f"__{_name}__", _operation(getattr(operator, _name)))


def _shape(rows: Sequence[object]) -> tuple[int, ...]:
    return (len(rows), len(rows[0])) if isinstance(rows[0], (list, tuple)) else (len(rows),)


def _wrapped(rows: Nested) -> PlainArray | Number:
    return PlainArray(rows) if isinstance(rows, list) else Number(rows)


def _at(rows: Nested, place: int | slice[int | None, int | None, int | None]) -> Nested:
    if not isinstance(rows, list):
        raise IndexError("too many indices for array")
    return rows[place]


def _each(rows: Nested, work: Callable[[float], float]) -> Nested:
    return [_each(row, work) for row in rows] if isinstance(rows, list) else work(rows)


def _both(rows: Nested, others: Nested, work: Callable[[float, float], float]) -> Nested:
    if isinstance(rows, list):
        return [_both(row, other, work) for row, other in zip(rows, others)]  # type: ignore[arg-type]  # of one shape
    return work(rows, others)  # type: ignore[arg-type]


def _flat(rows: Nested) -> list[float]:
    return [entry for row in rows for entry in _flat(row)] if isinstance(rows, list) else [rows]
