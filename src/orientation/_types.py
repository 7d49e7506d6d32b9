"""What public functions take and give, for readers' editors and type checkers."""

from typing import TYPE_CHECKING, Any, TypeAlias

#: Where it follows from the values, and not from their types, what comes out: one number, or an array of them.
Result: TypeAlias = Any

if TYPE_CHECKING:
    import numpy
    import sympy
    from numpy.typing import ArrayLike, NDArray

    Expression: TypeAlias = sympy.Basic | sympy.MatrixBase
    #: Numbers, one or several: whatever NumPy makes an array of.
    Numbers: TypeAlias = ArrayLike
    #: SymPy's objects, one or several, with numbers among them.
    Symbols: TypeAlias = Expression | list[Expression] | tuple[Expression | float, ...] | list[list[Expression]]
    Values: TypeAlias = Numbers | Symbols
    #: What a function gives for numbers, and what for symbols.
    Array: TypeAlias = NDArray[numpy.float64]
    Matrix: TypeAlias = sympy.MutableDenseMatrix
else:  # neither SymPy nor NumPy is loaded for the sake of a name
    Numbers = Symbols = Values = Array = Matrix = Any
