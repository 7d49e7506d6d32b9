"""Formulas in words, as a PDF says them to a screen reader."""

import pytest
from bs4 import BeautifulSoup

from notebook_pages.mathematics import to_html
from notebook_pages.spoken import spoken

SAID = {
    r"{}^A\mathbf{C}^N": "A bold C N",
    r"{}^T\mathbf{C}^B": "T bold C B",
    r"({}^A\mathbf{C}^N)^T": "open bracket A bold C N close bracket transpose",
    r"\mathbf{C}^T": "bold C transpose",
    r"{}^B\mathbf{C}^T = {}^B\mathbf{C}^N\,{}^N\mathbf{C}^T": "B bold C T equals B bold C N N bold "
    "C T",
    r"\mathbf{P}^{-1}": "bold P inverse",
    r"{}^A\boldsymbol{\omega}^N": "A bold omega N",
    r"\hat{n}_x\cdot\hat{a}_y": "n hat x dot a hat y",
    r"\hat{n}_x\times\hat{n}_y = \hat{n}_z": "n hat x cross n hat y equals n hat z",
    r"3\times3": "3 by 3",
    r"2\cdot10^{-8}": "2 times 10 to the power minus 8",
    r"\frac{1}{2}": "1 over 2",
    r"\frac{\sqrt{3}}{2}": "the fraction the root of 3, over 2, end of fraction",
    r"\sqrt{1 + c}": "the root of 1 plus c, end of root",
    r"\cos\left(\theta\right)": "cosine theta",
    r"\cos(\alpha + \theta)": "cosine open bracket alpha plus theta close bracket",
    r"-90^\circ": "minus 90 degrees",
    r"q_0^2 + q_{xy}": "q sub 0 squared plus q sub x y",
    r"q^*": "q conjugate",
    r"\dot{q}_0": "q dot 0",
    r"|\mathbf{v}|^2": "the magnitude of bold v, end of magnitude, squared",
    r"\mathrm{trace}\,\mathbf{C}": "trace bold C",
    r"[\boldsymbol{\omega}]_\times": "open square bracket bold omega close square bracket cross",
    r"\mathbf{v}_\perp''": "bold v perpendicular double prime",
    r"\sum_k w_k": "the sum over k of w sub k",
    r"\int_{0}^{t} f\,dt": "the integral from 0 to t of f d t",
    r"\lim_{h\to 0} h": "the limit as h goes to 0 of h",
    r"\begin{bmatrix} 1 & 2 \\ 3 & 4 \end{bmatrix}": "2 by 2 matrix, row 1: 1, 2; row 2: 3, 4; "
    "end of matrix",
    r"\begin{bmatrix} x \\ y \end{bmatrix} .": "column of 2: x; y; end of column",
    r"\underbrace{{}^A\mathbf{C}^N}_{z,\ \theta}": "A bold C N, marked z, theta",
    r"a \approx b \nabla c": "a is about b nabla c",
}


def words(tex):
    return spoken(BeautifulSoup(to_html(tex, False), "lxml").select_one("math"))


@pytest.mark.parametrize("tex", SAID)
def test_a_formula_is_said_as_one_reads_it_aloud(tex):
    assert words(tex) == SAID[tex]


def test_what_differs_is_said_differently():
    """Among what the book has to keep apart, no two sound alike."""
    different = [
        r"\mathbf{C}^T",
        r"\mathbf{C}",
        r"\mathbf{C}^{-1}",
        "C",
        r"{}^A\mathbf{C}^N",
        r"{}^N\mathbf{C}^A",
        "-C",
        "C_x",
    ]
    different += [
        r"\hat{n}_x",
        "n_x",
        r"\dot{n}_x",
        r"\frac{a}{b + c}",
        r"\frac{a}{b} + c",
        r"\sqrt{a + b}",
        r"\sqrt{a} + b",
    ]
    different += [
        r"a^{b + c}",
        "a^b + c",
        r"a\cdot b",
        r"a\times b",
        "a b",
        "a + b",
        "a - b",
        "q^*",
        "q",
    ]
    assert len({words(tex) for tex in different}) == len(different)
