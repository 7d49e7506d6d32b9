"""The explorer of sequences, without a browser: what is set in
its controls, and what it then shows.
"""

import re

import pytest
import sympy as sm
from traitlets import TraitError

from notebook_pages.moving import WIDGET
from orientation import (
    PROPER_EULER,
    SEQUENCES,
    dcm_from_body_fixed,
    dcm_from_space_fixed,
    simple_dcm,
)
from orientation_figures.moving import SequenceExplorer
from orientation_figures.moving.explorer import angle_from_text

PSI, THETA, PHI = sm.symbols("psi, theta, varphi")


def shown_matrices(explorer):
    """The entries of every matrix that is shown, as TeX."""
    blocks = re.findall(r"\\begin\{matrix\}(.*?)\\end\{matrix\}", explorer.tex)
    return [[row.split("&") for row in block.split(r"\\")] for block in blocks]


def typed(explorer, place, text):
    """Type an angle, as the front end tells it."""
    explorer.set_state(
        {"angles": [text if k == place else angle for k, angle in enumerate(explorer.angles)]}
    )


def tex_of(matrix):
    return [[sm.latex(entry, fold_func_brackets=True) for entry in row] for row in matrix.tolist()]


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "fixed, build", [("body", dcm_from_body_fixed), ("space", dcm_from_space_fixed)]
)
@pytest.mark.parametrize("sequence", SEQUENCES)
def test_it_shows_the_factors_their_product_and_what_lock_leaves(sequence, fixed, build):
    explorer = SequenceExplorer()
    explorer.sequence, explorer.fixed = sequence, fixed
    turns = [simple_dcm(axis, angle) for axis, angle in zip(sequence, (PSI, THETA, PHI))]
    order = turns[::-1] if fixed == "body" else turns
    dcm = build((PSI, THETA, PHI), sequence)
    somewhere = {PSI: 0.3, THETA: -0.7, PHI: 1.9}
    assert (order[0] * order[1] * order[2] - dcm).subs(somewhere).norm() < 1e-15
    assert explorer.dcm == dcm and list(explorer.factors) == turns
    *factors, product, locked = [
        [[entry.strip() for entry in row] for row in matrix] for matrix in shown_matrices(explorer)
    ]
    assert factors == [tex_of(turn) for turn in order] and product == tex_of(dcm)
    lock = 0 if sequence in PROPER_EULER else sm.pi / 2
    left = sm.trigsimp(dcm.subs(THETA, lock))
    assert locked == tex_of(left)
    # A browser is given as many matrices, each of nine entries.
    assert explorer.result.count("<mtable>") == 5 and explorer.result.count("<mtd>") == 45
    assert "varphi" not in explorer.result
    # Only the sum or the difference of the two other angles is left.
    assert any(
        (left.diff(PSI) + sign * left.diff(PHI)).subs(somewhere).norm() < 1e-15 for sign in (1, -1)
    )
    where = "θ = 0 and θ = π" if sequence in PROPER_EULER else "θ = π/2 and θ = −π/2"
    assert f"{'-'.join(sequence)} locks at {where}" in explorer.message


def test_numbers_and_expressions_can_be_typed():
    explorer = SequenceExplorer("zyx", angles=(0, "pi/6", "alpha"))
    typed(explorer, 0, "0.25")
    alpha = sm.Symbol("alpha")
    assert explorer.values == (sm.Float(0.25), sm.pi / 6, alpha)
    assert explorer.dcm == dcm_from_body_fixed((sm.Float(0.25), sm.pi / 6, alpha), "zyx")
    for shown in (explorer.result, explorer.tex):
        assert "0.2474" in shown and "0.2474039" not in shown
    assert "1.05 rad away" in explorer.message
    typed(explorer, 1, "-pi/2")
    assert "Here it is locked" in explorer.message


@pytest.mark.sampled(4)
@pytest.mark.parametrize("text", [
    "3 0", "", "sin", "x == y", "(1, 2)", "__import__('os')", "psi.diff()", "9**9**9", "lambda: 1",
    "a and b", "1/0", "sqrt(-1)", "tan(pi/2)", "True", "open('x')", "phi(2)",
])  # fmt: skip
def test_what_is_no_angle_is_refused_by_name(text):
    explorer = SequenceExplorer()
    before = explorer.result
    typed(explorer, 1, text)
    assert explorer.result == "" and "theta is" in explorer.message
    assert re.search("expected|one real angle", explorer.message)
    typed(explorer, 1, "theta")
    assert explorer.result == before
    with pytest.raises(ValueError, match="psi is"):
        SequenceExplorer(angles=(text, 0, 0))


@pytest.mark.parametrize("text, angle", [
    ("beta", sm.Symbol("beta")), ("2*zeta - 1", 2 * sm.Symbol("zeta") - 1),
    ("I", sm.Symbol("I")), ("asin(1)", sm.pi / 2), ("-phi/2", -PHI / 2),
])  # fmt: skip
def test_greek_and_other_names_are_symbols(text, angle):
    assert angle_from_text(text) == angle


def test_degrees_are_suspected():
    explorer = SequenceExplorer(angles=(30, "theta", "phi"))
    assert "psi is taken as 30 radians" in explorer.message and "(30)*pi/180" in explorer.message


def test_what_is_typed_is_shown_as_text():
    explorer = SequenceExplorer()
    typed(explorer, 0, "<img src=x>")
    assert "<img" in explorer.message and explorer.result == "", (
        "the message is set as text, the formulas are not there"
    )


def test_bad_arguments():
    with pytest.raises(ValueError, match="two successive rotations"):
        SequenceExplorer("zzx")
    with pytest.raises(ValueError):
        SequenceExplorer(angles=("psi", "theta"))
    explorer = SequenceExplorer()
    for name, wrong in (("sequence", "zzx"), ("fixed", "earth"), ("angles", ["psi", "theta"])):
        with pytest.raises(TraitError):
            setattr(explorer, name, wrong)


def test_where_there_is_no_kernel_the_page_shows_what_it_began_with():
    explorer = SequenceExplorer("zxy")
    data, _ = explorer._repr_mimebundle_()
    assert WIDGET in data and data["text/latex"] == f"$${explorer.tex}$$"
    assert data["text/plain"] == "SequenceExplorer: z-x-y, body fixed"
    assert SequenceExplorer("zxy")._repr_mimebundle_()[0]["text/latex"] == data["text/latex"]
