"""The formulas that readers take away from the page: one script for each
language, loaded when it is asked for.
"""

import base64
import gzip
import itertools
import json
from functools import cache

from orientation_workbench.formulas import CHOICES, FORMULAS
from orientation_workbench.languages import CONVENTIONS, LANGUAGES, formula_in

#: The kinds of numbers for which a convention matters to a formula.
MATTERS = {"matrix": {"matrix"}, "scalar": {"quaternion"}, "unit": {"angle", "angles"}}


def texts_in(language):
    """All texts of a language: for each formula the names of what is
    chosen, and a text for each choice.
    """
    found = {}
    for name, (takes, gives) in FORMULAS.items():
        conventions = [key for key in CONVENTIONS if MATTERS[key] & {*takes.values(), gives}]
        what, choices = CHOICES.get(name, (None, (None,)))
        texts = {}
        for choice, *values in itertools.product(
            choices, *(CONVENTIONS[key] for key in conventions)
        ):
            words = " ".join([*([choice] if what else []), *values])
            texts[words] = formula_in(language, name, choice, **dict(zip(conventions, values)))
        found[name] = {"keys": [*([what] if what else []), *conventions], "texts": texts}
    return found


@cache
def scripts():
    """The scripts by the names of their files."""
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
