"""Types of arguments and results, for readers' editors and type checkers.

SymPy has no types of its own. Its objects are recognised here, as in the functions themselves, by
an attribute that no others have: free symbols. Annotations are not evaluated, so neither SymPy nor
NumPy is loaded just for a name.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from typing import TYPE_CHECKING, Any, Literal, Protocol, TypeAlias, TypeVar

if TYPE_CHECKING:
    import numpy
    import sympy
    from numpy.typing import ArrayLike, NDArray

    #: Results for numbers and for symbols. If the result is one number for each item, it has one of
    #: the last two types: for one item, or for a batch.
    Array: TypeAlias = NDArray[numpy.float64]
    Matrix: TypeAlias = sympy.MutableDenseMatrix
    Scalars: TypeAlias = float | Array
    #: One number or several, in any form that NumPy can turn into an array.
    Numbers: TypeAlias = ArrayLike
    #: The result of a comparison of numbers, of a batch or of symbols.
    Relation: TypeAlias = sympy.core.relational.Relational
    Truth: TypeAlias = bool | NDArray[numpy.bool] | Relation


class Symbolic(Protocol):
    """An object of SymPy: an expression, a matrix."""

    @property
    def free_symbols(self) -> AbstractSet[object]: ...


class Expression(Symbolic, Protocol):
    """The operations that formulas use on a SymPy expression."""

    def __add__(self, other: Expression | float, /) -> Expression: ...
    def __radd__(self, other: float, /) -> Expression: ...
    def __sub__(self, other: Expression | float, /) -> Expression: ...
    def __rsub__(self, other: float, /) -> Expression: ...
    def __mul__(self, other: Expression | float, /) -> Expression: ...
    def __rmul__(self, other: float, /) -> Expression: ...
    def __truediv__(self, other: Expression | float, /) -> Expression: ...
    def __rtruediv__(self, other: float, /) -> Expression: ...
    def __pow__(self, other: int, /) -> Expression: ...
    def __neg__(self) -> Expression: ...
    def __abs__(self) -> Expression: ...
    def __lt__(self, other: float, /) -> Relation: ...
    def __le__(self, other: float, /) -> Relation: ...
    def __gt__(self, other: float, /) -> Relation: ...
    def __ge__(self, other: float, /) -> Relation: ...
    def __float__(self) -> float: ...
    def __complex__(self) -> complex: ...
    def atoms(self, kind: type[object], /) -> set[Expression]: ...
    def evalf(self) -> Expression: ...
    def xreplace(self, rule: Mapping[Expression, Expression], /) -> Expression: ...

    @property
    def free_symbols(self) -> AbstractSet[Expression]: ...
    @property
    # Symbols and functions of time have a name.
    def name(self) -> str: ...


#: The axes of simple rotations, and the twelve sequences of Euler angles.
Axis: TypeAlias = Literal["x", "y", "z"]
AxisSequence: TypeAlias = Literal[
    "zxz", "xyx", "yzy", "zyz", "xzx", "yxy", "xyz", "yzx", "zxy", "xzy", "zyx", "yxz"
]  # fmt: skip
#: A component of one item, and a component of an item or a batch.
Entry: TypeAlias = "float | Expression"
Column: TypeAlias = "Entry | Array"
#: One symbol or several, possibly mixed with numbers.
Symbols: TypeAlias = "Symbolic | Sequence[Symbolic] | Sequence[Sequence[Symbolic]]"
Values: TypeAlias = (
    "Array | Numbers | Symbols | Sequence[Symbolic | float] | Sequence[Sequence[Symbolic | float]]"
)

#: The type that a formula computes with. A type checker reads each formula three times: for a
#: number, for a batch and for symbols. It reads a formula for numbers only twice, because such a
#: formula chooses its branch by their sizes.
Component = TypeVar("Component", float, "Array", Expression)
Number = TypeVar("Number", float, "Array")


class Functions(Protocol[Component]):
    """The functions that a formula may use, for each kind of component."""

    def sin(self, angle: Component, /) -> Component: ...
    def cos(self, angle: Component, /) -> Component: ...
    def norm(self, *components: Component | float) -> Component: ...
    def where(
        self, condition: Truth, yes: Component | float, no: Component | float, /
    ) -> Component: ...


class NumberFunctions(Functions[Number], Protocol[Number]):
    """The functions that only a formula for numbers may use."""

    def atan2(self, sine: Number, cosine: Number, /) -> Number: ...
    def largest(self, *sizes: Number) -> Number: ...
    def pick(
        self, scores: Sequence[Number], rows: Sequence[Sequence[Number]], /
    ) -> Sequence[Number]: ...


# The number of components depends on the shapes of the arguments. No type can express that number.
Components: TypeAlias = Any  # type: ignore[explicit-any]


class Formula(Protocol):
    """``formula(functions, *components)`` returns the components of the result."""

    def __call__(
        self, f: Functions[Component], /, *components: Components
    ) -> Sequence[Component | float]: ...


class NumberFormula(Protocol):
    """The same for numbers."""

    def __call__(
        self, f: NumberFunctions[Number], /, *components: Components
    ) -> Sequence[Number | float]: ...


class Conversion(Protocol):
    """A function that converts one description of an orientation to another."""

    def __call__(self, value: Components, /, *further: Components) -> Components: ...


class Excess(Protocol):
    """``excess(functions, *components)`` is at most `TOLERANCE` for valid input."""

    def __call__(self, f: NumberFunctions[Number], /, *components: Components) -> Number: ...


class Explain(Protocol):
    """``explain(components, where)`` raises the error that says what is wrong."""

    def __call__(self, components: Sequence[float], where: str, /) -> None: ...
