"""What public functions take and give, for readers' editors and type checkers."""

from typing import TYPE_CHECKING, Any, TypeAlias

#: What a function gives follows from what it was given: SymPy's objects for symbols, arrays or floats for numbers.
Result: TypeAlias = Any

if TYPE_CHECKING:
    import sympy
    from numpy.typing import ArrayLike

    Expression: TypeAlias = sympy.Basic | sympy.MatrixBase
    #: One number or symbol, or several: SymPy's objects, sequences of them, or what NumPy makes an array of.
    Values: TypeAlias = (
        ArrayLike | Expression | list[Expression] | tuple[Expression | float, ...] | list[list[Expression]]
    )
else:  # neither SymPy nor NumPy is loaded for the sake of a name
    Values: TypeAlias = Any
