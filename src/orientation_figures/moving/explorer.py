"""An explorer for Jupyter: choose a sequence, type angles, and read what the three turns multiply out to.

The algebra is done by SymPy, so that this needs a kernel.
"""

import re
from keyword import iskeyword

import ipywidgets as widgets
import sympy as sm
from sympy.parsing.sympy_parser import parse_expr

from orientation._numbers_and_symbols import NUMBERS
from orientation.direction_cosines import simple_dcm
from orientation.euler_angles import (
    PROPER_EULER,
    SEQUENCES,
    dcm_from_body_fixed,
    dcm_from_space_fixed,
    layout_of,
    lock_margin_formula,
)

NAMES = ("psi", "theta", "phi")
#: What an angle may be made of besides numbers and symbols.
FUNCTIONS = {name: getattr(sm, name) for name in ("pi", "sqrt", "sin", "cos", "tan", "asin", "acos", "atan")}
KINDS_OF_NUMBERS = {name: getattr(sm, name) for name in ("Integer", "Float", "Rational")}
TURN = 2 * sm.pi  # beyond it, degrees may have been meant


class SequenceExplorer(widgets.VBox):
    r"""The direction cosine matrix of any of the twelve sequences, with its factors, as the reader changes them.

    Shows :math:`{}^D\mathbf{C}^A` as the product of its three simple matrices and multiplied out, and what
    is left of it at gimbal lock, where only the sum or the difference of two angles counts.

    Parameters
    ----------
    sequence : str
        One of the twelve sequences.
    angles : three strings, numbers or SymPy expressions
        Radians: symbols, numbers, or expressions such as ``'pi/6'``.
    fixed : {'body', 'space'}
        Whether the turns are about axes of the turned frame or of the frame that stays.

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
    """

    def __init__(self, sequence="zxy", angles=NAMES, fixed="body"):
        layout_of(sequence)  # its message says more than that of the list
        for name, angle in zip(NAMES, angles, strict=True):
            angle_from_text(str(angle), name)
        label = {"description_width": "5rem"}
        self.sequence = widgets.Dropdown(
            options=[("-".join(one), one) for one in SEQUENCES], value=sequence, description="Sequence", style=label
        )
        self.fixed = widgets.Dropdown(
            options=[("body fixed", "body"), ("space fixed", "space")],
            value=fixed,
            description="Turns are",
            style=label,
        )
        self.angles = tuple(
            widgets.Text(value=str(angle), description=name, style=label, placeholder="a symbol or radians")
            for name, angle in zip(NAMES, angles)
        )
        self.message, self.result = widgets.HTML(), widgets.HTMLMath()
        super().__init__(
            [widgets.HBox([self.sequence, self.fixed]), widgets.HBox(self.angles), self.message, self.result]
        )
        for control in (self.sequence, self.fixed, *self.angles):
            control.observe(self._show, "value")
        self._show()

    @property
    def values(self):
        """The three angles as SymPy expressions."""
        return tuple(angle_from_text(field.value, name) for name, field in zip(NAMES, self.angles))

    @property
    def factors(self):
        """The matrices of the three simple turns, in the order in which they are made."""
        return tuple(simple_dcm(axis, angle) for axis, angle in zip(self.sequence.value, self.values))

    @property
    def dcm(self):
        r""":math:`{}^D\mathbf{C}^A`, a SymPy matrix."""
        return self._dcm(self.values)

    @property
    def tex(self):
        """All that is shown, as TeX."""
        psi, _, phi = self.values
        lock = sm.Integer(0) if self.sequence.value in PROPER_EULER else sm.pi / 2
        order = reversed(self.factors) if self.fixed.value == "body" else self.factors
        lines = [
            r"{}^D\mathbf{C}^A &= " + "".join(map(_tex, order)),
            "&= " + _tex(self.dcm),
            rf"\left.{{}}^D\mathbf{{C}}^A\right|_{{\theta={_tex(lock)}}} &= "
            + _tex(sm.trigsimp(self._dcm((psi, lock, phi)))),
        ]
        return r"\begin{aligned}" + r" \\ ".join(lines) + r"\end{aligned}"

    def lock(self):
        """Return a sentence that says where the sequence locks, and how far from there it stands."""
        proper = self.sequence.value in PROPER_EULER
        where = "θ = 0 and θ = π" if proper else "θ = π/2 and θ = −π/2"
        axes = "the first and the third turn are about one line"
        said = f"{'-'.join(self.sequence.value)} locks at {where}: there {axes}."
        theta = self.values[1]
        if not theta.is_number:
            return said
        [margin] = lock_margin_formula(self.sequence.value)(NUMBERS, 0, float(theta), 0)
        return f"{said} Here it is {margin:.3g} rad away from that." if margin > 1e-12 else f"{said} Here it is locked."

    def _dcm(self, angles):
        build = dcm_from_body_fixed if self.fixed.value == "body" else dcm_from_space_fixed
        return build(angles, self.sequence.value)

    def _show(self, change=None):
        try:
            tex, said = f"$${self.tex}$$", [self.lock()]
            said += [
                f"{name} is taken as {field.value} radians. {field.value} degrees would be ({field.value})*pi/180."
                for name, field, angle in zip(NAMES, self.angles, self.values)
                if angle.is_number and abs(angle) > TURN
            ]
        except ValueError as error:
            tex, said = "", [f"{error}."]
        self.result.value = tex
        self.message.value = f'<p role="status">{"<br>".join(map(_escaped, said))}</p>'

    def _repr_mimebundle_(self, **kwargs):
        data = super()._repr_mimebundle_(**kwargs)
        return data | {"text/latex": self.result.value, "text/plain": repr(self)}

    def __repr__(self):
        return f"SequenceExplorer: {'-'.join(self.sequence.value)}, {self.fixed.value} fixed"


def angle_from_text(text, name="angle"):
    """Return the SymPy expression that was typed; nothing but arithmetic and the usual functions is read.

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
    symbols = {word: sm.Symbol("varphi" if word == "phi" else word) for word in re.findall(r"[A-Za-z]\w*", text)}
    allowed = (
        re.fullmatch(r"[\w\s+\-*/().]+", text, re.ASCII)
        and not any(map(iskeyword, symbols))
        and not re.search(r"__|\*\s*\*|\.\s*[A-Za-z_]", text)
    )
    try:
        if not allowed:
            raise SyntaxError
        angle = parse_expr(
            text, {**symbols, **FUNCTIONS}, global_dict={"__builtins__": {}, "Symbol": sm.Symbol, **KINDS_OF_NUMBERS}
        )
    except (SyntaxError, TypeError, AttributeError, NameError, ValueError, RecursionError):
        raise ValueError(
            f"{name} is {text!r}: a symbol, a number of radians or an expression such as pi/6 was expected"
        ) from None
    if not isinstance(angle, sm.Expr) or angle.is_number and not (angle.is_real and angle.is_finite):
        raise ValueError(f"{name} is {text!r}: one real angle was expected")
    return angle


def _tex(value):
    """Return TeX with four digits for each decimal number."""
    return sm.latex(
        value.xreplace({number: sm.Float(number, 4) for number in value.atoms(sm.Float)}), fold_func_brackets=True
    )


def _escaped(text):
    return text.replace("&", "&amp;").replace("<", "&lt;")
