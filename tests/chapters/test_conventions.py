"""The stored answers of other libraries on the convention card.

``python -m tools.programs`` asks them again.
"""

import ast
import json

import numpy as np
from places import REPOSITORY

from orientation import dcm_from_body_fixed


def stored():
    """The table of the card: library, line of code, answer."""
    notebook = json.loads((REPOSITORY / "chapters" / "convention-card.ipynb").read_text("utf8"))
    source = next(
        "".join(cell["source"])
        for cell in notebook["cells"]
        if "ASKED = [" in "".join(cell["source"])
    )
    assigned = next(node for node in ast.parse(source).body if isinstance(node, ast.Assign))
    return ast.literal_eval(assigned.value)


def test_the_stored_answers_are_of_the_orientation_that_the_card_is_about():
    D_C_A = dcm_from_body_fixed((0.4, 0.7, -0.3), "zxy")
    for _, _, answer in stored():
        if len(answer) == 3:
            assert np.allclose(np.transpose(answer), D_C_A, atol=6e-5)
        else:
            assert sorted(np.round(answer, 4)) == [0, 0, 0.2588, 0.9659]
