"""An explorer of the twelve sequences, which multiplies the three simple matrices for any angles.

SymPy does the algebra, so this needs Python: a kernel's, or that of the page.
"""

import re
from keyword import iskeyword

import anywidget
import sympy as sm
import traitlets
from sympy.parsing.sympy_parser import parse_expr
from sympy.printing.mathml import mathml

from orientation.direction_cosines import simple_dcm
from orientation.euler_angles import (
    PROPER_EULER,
    SEQUENCES,
    dcm_from_body_fixed,
    dcm_from_space_fixed,
    layout_of,
    lock_margin_formula,
)
from orientation.numbers_and_symbols import NUMBERS

from ..style import STYLE
from . import bundle
from .state import Sequence

NAMES = ("psi", "theta", "phi")
#: The parts that an angle may contain besides numbers and symbols.
FUNCTIONS = {
    name: getattr(sm, name) for name in ("pi", "sqrt", "sin", "cos", "tan", "asin", "acos", "atan")
}
KINDS_OF_NUMBERS = {name: getattr(sm, name) for name in ("Integer", "Float", "Rational")}
# A larger angle may have been meant in degrees.
TURN = 2 * sm.pi
SPACE = '<mspace width="0.17em"></mspace>'
FIXED = '<mo stretchy="false">{}</mo>'
# The symbol of the matrix, with its frames around it.
SYMBOL = (
    '<mmultiscripts><mi mathvariant="normal" '
    'class="matrix">C</mi><mrow></mrow><mi>A</mi><mprescripts></mprescripts>'
    "<mrow></mrow><mi>D</mi></mmultiscripts>"
)


class SequenceExplorer(anywidget.AnyWidget):
    r"""The direction cosine matrix of any of the twelve sequences, with its factors.

    It shows ${}^D\mathbf{C}^A$ as the product of its three simple matrices and multiplied out, and
    what remains of it at gimbal lock, where only the sum or the difference of two angles counts.
    The reader can change the sequence and the angles.

    Parameters
    ----------
    sequence : str
        One of the twelve sequences.
    angles : three strings, numbers or SymPy expressions
        Radians: symbols, numbers, or expressions such as ``'pi/6'``, kept as they are typed.
    fixed : {'body', 'space'}
        Whether the rotations are about axes of the rotated frame or of the fixed frame.

    Raises
    ------
    ValueError
        If the sequence is not one of the twelve, or an angle cannot be read.

    Examples
    --------
    >>> from orientation_figures.moving import SequenceExplorer
    >>> explorer = SequenceExplorer('zxy', angles=('psi', 'pi/6', 0))
    >>> explorer.dcm[1, 2], explorer.factors[0][0, 1]
    (1/2, sin(psi))
    >>> explorer.sequence = 'zyx'
    >>> explorer.dcm[0, 2]
    -1/2
    """

    _esm = traitlets.Unicode().tag(sync=True)
    _css = traitlets.Unicode().tag(sync=True)
    sequence = Sequence("zxy").tag(sync=True)
    fixed = traitlets.Enum(("body", "space"), "body").tag(sync=True)
    angles = traitlets.List(traitlets.Unicode(), list(NAMES), minlen=3, maxlen=3).tag(sync=True)
    sequences = traitlets.List(SEQUENCES, read_only=True).tag(sync=True)
    result = traitlets.Unicode(read_only=True).tag(sync=True)
    message = traitlets.Unicode(read_only=True).tag(sync=True)

    @traitlets.default("_esm")
    def _default_esm(self):
        return bundle.esm("explorer")

    @traitlets.default("_css")
    def _default_css(self):
        return STYLE + bundle.style()

    def __init__(self, sequence="zxy", angles=NAMES, fixed="body"):
        # Its message is more helpful than that of ``list.index``.
        layout_of(sequence)
        for name, angle in zip(NAMES, angles, strict=True):
            angle_from_text(str(angle), name)
        super().__init__(sequence=sequence, angles=[str(angle) for angle in angles], fixed=fixed)
        self.observe(self._show, ["sequence", "angles", "fixed"])
        self._show()

    @property
    def values(self):
        """The three angles as SymPy expressions."""
        return tuple(angle_from_text(text, name) for name, text in zip(NAMES, self.angles))

    @property
    def factors(self):
        """The matrices of the three simple rotations, in order."""
        return tuple(simple_dcm(axis, angle) for axis, angle in zip(self.sequence, self.values))

    @property
    def dcm(self):
        r"""${}^D\mathbf{C}^A$, a SymPy matrix."""
        return self._dcm(self.values)

    @property
    def matrices(self):
        """All displayed matrices: the factors in the order of multiplication, and their product.

        The last is the product at gimbal lock.
        """
        psi, _, phi = self.values
        factors = self.factors[::-1] if self.fixed == "body" else self.factors
        return [*factors, self.dcm, sm.trigsimp(self._dcm((psi, self._locked, phi)))]

    @property
    def _locked(self):
        return sm.Integer(0) if self.sequence in PROPER_EULER else sm.pi / 2

    @property
    def tex(self):
        """All displayed matrices, as TeX."""
        *factors, product, left = map(_tex, self.matrices)
        lines = [
            r"{}^D\mathbf{C}^A &= " + "".join(factors),
            "&= " + product,
            rf"\left.{{}}^D\mathbf{{C}}^A\right|_{{\theta={_tex(self._locked)}}} &= " + left,
        ]
        return r"\begin{aligned}" + r" \\ ".join(lines) + r"\end{aligned}"

    def _mathml(self):
        """The same as formulas that a browser typesets itself, each of which may begin a line."""
        *factors, product, left = map(_mathml, self.matrices)
        place = f"<mi>θ</mi><mo>=</mo>{_mathml(self._locked)}"
        locked = f"<msub><mrow>{SYMBOL}<mo>|</mo></mrow><mrow>{place}</mrow></msub>"
        lines = [[SYMBOL + "<mo>=</mo>" + factors[0], *factors[1:]], ["<mo>=</mo>" + product]]
        lines.append([locked + "<mo>=</mo>" + left])
        formulas = ("".join(f"<math><mrow>{part}</mrow></math>" for part in line) for line in lines)
        return "".join(f'<div class="line">{formula}</div>' for formula in formulas)

    def lock(self):
        """Return a sentence on where the sequence locks, and how far from there the angles are."""
        proper = self.sequence in PROPER_EULER
        where = "θ = 0 and θ = π" if proper else "θ = π/2 and θ = −π/2"
        axes = "the first and third rotations are about the same line"
        sentence = f"{'-'.join(self.sequence)} locks at {where}: there {axes}."
        theta = self.values[1]
        if not theta.is_number:
            return sentence
        [margin] = lock_margin_formula(self.sequence)(NUMBERS, 0, float(theta), 0)
        return (
            f"{sentence} Here it is {margin:.3g} rad away from that."
            if margin > 1e-12
            else f"{sentence} Here it is locked."
        )

    def _dcm(self, angles):
        build = dcm_from_body_fixed if self.fixed == "body" else dcm_from_space_fixed
        return build(angles, self.sequence)

    def _show(self, change=None):
        try:
            result, message = self._mathml(), [self.lock()]
            message += [
                f"{name} is taken as {text} radians. {text} degrees would be ({text})*pi/180."
                for name, text, angle in zip(NAMES, self.angles, self.values)
                if angle.is_number and abs(angle) > TURN
            ]
        except ValueError as error:
            result, message = "", [f"{error}."]
        with self.hold_sync():
            self.set_trait("result", result)
            self.set_trait("message", " ".join(message))

    def _repr_mimebundle_(self, **kwargs):
        data, metadata = super()._repr_mimebundle_(**kwargs)
        return data | {"text/latex": f"$${self.tex}$$"}, metadata

    def __repr__(self):
        return f"SequenceExplorer: {'-'.join(self.sequence)}, {self.fixed} fixed"


def angle_from_text(text, name="angle"):
    """Return the SymPy expression in a text; only arithmetic and the usual functions are allowed.

    Raises
    ------
    ValueError
        If it cannot be read, or is not one real angle.

    Examples
    --------
    >>> from orientation_figures.moving.explorer import angle_from_text
    >>> angle_from_text('alpha + pi/6'), angle_from_text('phi')
    (alpha + pi/6, varphi)
    """
    symbols = {
        word: sm.Symbol("varphi" if word == "phi" else word)
        for word in re.findall(r"[A-Za-z]\w*", text)
    }
    allowed = (
        re.fullmatch(r"[\w\s+\-*/().]+", text, re.ASCII)
        and not any(map(iskeyword, symbols))
        and not re.search(r"__|\*\s*\*|\.\s*[A-Za-z_]", text)
    )
    try:
        if not allowed:
            raise SyntaxError
        angle = parse_expr(
            text,
            {**symbols, **FUNCTIONS},
            global_dict={"__builtins__": {}, "Symbol": sm.Symbol, **KINDS_OF_NUMBERS},
        )
    except (SyntaxError, TypeError, AttributeError, NameError, ValueError, RecursionError):
        raise ValueError(
            f"{name} is {text!r}: expected a symbol, a number of radians or an expression such "
            "as pi/6"
        ) from None
    if (
        not isinstance(angle, sm.Expr)
        or angle.is_number
        and not (angle.is_real and angle.is_finite)
    ):
        raise ValueError(f"{name} is {text!r}: expected one real angle")
    return angle


def _tex(value):
    return sm.latex(_rounded(value), fold_func_brackets=True)


def _mathml(value):
    """Return MathML without the brackets around a single symbol, as ``fold_func_brackets`` does."""
    text = mathml(_rounded(value), printer="presentation").replace("<mi>varphi</mi>", "<mi>φ</mi>")
    text = text.replace("<mn>-", "<mn>−")
    text = re.sub(r"<mrow><mo>\(</mo>(<m[in]>[^<]+</m[in]>)<mo>\)</mo></mrow>", rf"{SPACE}\1", text)
    for sign, element in (
        ("&InvisibleTimes;", SPACE),
        ("-", "<mo>−</mo>"),
        *((bracket, FIXED.format(bracket)) for bracket in "()"),
    ):
        text = text.replace(f"<mo>{sign}</mo>", element)
    return text


def _rounded(value):
    """Return ``value`` with four digits for each decimal number."""
    return value.xreplace({number: sm.Float(number, 4) for number in value.atoms(sm.Float)})
