"""Formulas that readers can copy from the page: one script for each language, loaded on demand."""

import base64
import gzip
import itertools
import json
from functools import cache

from orientation_workbench.formulas import CHOICES, FORMULAS
from orientation_workbench.languages import CONVENTIONS, LANGUAGES, formula_in

# The kinds of numbers for which a convention matters to a formula.
MATTERS = {"matrix": {"matrix"}, "scalar": {"quaternion"}, "unit": {"angle", "angles"}}


def texts_in(language):
    """Return all texts of a language: for each formula its choices, and a text for each of them."""
    formulas = {}
    for name, (takes, gives) in FORMULAS.items():
        conventions = [key for key in CONVENTIONS if MATTERS[key] & {*takes.values(), gives}]
        choice_name, choices = CHOICES.get(name, (None, (None,)))
        texts = {}
        for choice, *values in itertools.product(
            choices, *(CONVENTIONS[key] for key in conventions)
        ):
            words = " ".join([*([choice] if choice_name else []), *values])
            texts[words] = formula_in(language, name, choice, **dict(zip(conventions, values)))
        formulas[name] = {
            "keys": [*([choice_name] if choice_name else []), *conventions],
            "texts": texts,
        }
    return formulas


@cache
def scripts():
    """Return the scripts by file name."""
    files = {}
    for language in LANGUAGES:
        packed = gzip.compress(
            json.dumps(texts_in(language), separators=(",", ":")).encode(), mtime=0
        )
        text = base64.b64encode(packed).decode()
        files[f"formulas-{language.lower().replace('++', 'pp')}.js"] = (
            f"(globalThis.orientationFormulas ??= {{}})[{json.dumps(language)}] = '{text}';\n"
        )
    return files
