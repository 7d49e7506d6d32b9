"""Rules that draw the parameters of a question's variants, and the parameters in its text.

In a source, a cell above the text of a question defines what may vary, and the text shows a
parameter as ``{{force}}``:

.. code-block:: python

    ### BEGIN VARIANTS
    lever = draw('levers/see-saw', force=[20, 30, 45], arm=[0.2, 0.4, 0.5])
    ### END VARIANTS

In place of both, students get ``lever = variant('levers/see-saw')``, which shows the text of their
own variant.
"""

import ast
import hashlib
import itertools
import math
import random
import re
import textwrap
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from .author import AuthorError

VARIANTS = re.compile(
    r"^[ \t]*### BEGIN VARIANTS\n(.*?)^[ \t]*### END VARIANTS[ \t]*\n?", re.M | re.S
)
#: The default number of variants of a question.
COUNT = 16
#: The most attempts to draw a variant that is new and fits.
MOST_ATTEMPTS = 400
#: The most combinations to try when counting those that fit.
MOST_LISTED = 10_000


#: The source of a parameter: a list to choose from, or a function of a random generator.
Pool = Iterable[Any] | Callable[[random.Random], Any]


@dataclass(frozen=True)
class Rule:
    """The rule for a question's variants.

    Attributes
    ----------
    count : int
        The number of variants.
    pools : dict
        For each parameter, a list to choose from, or a function of a ``random.Random`` that returns
        a value.
    where : function, optional
        Accepts or rejects a dictionary of parameters.
    picture : function, optional
        Returns the drawing of a variant from the dictionary of its parameters; the text shows it as
        ``{{picture}}``.
    """

    name: str
    count: int
    pools: Mapping[str, Pool]
    where: Callable[..., object] | None = None
    picture: Callable[..., Any] | None = None

    def without_what_is_ruled_out(self) -> "Rule":
        """Return the rule with as many variants as ``where`` leaves, if the lists alone are enough.

        An author who excludes a variant thus need not count the others.
        """
        lists = [list(pool) for pool in self.pools.values() if not callable(pool)]
        total = math.prod(map(len, lists))
        if not self.where or len(lists) < len(self.pools) or not self.count <= total <= MOST_LISTED:
            return self
        choices = (dict(zip(self.pools, values)) for values in itertools.product(*lists))
        left = sum(bool(self.where(choice)) for choice in choices)
        return replace(self, count=min(self.count, left)) if left else self

    def parameters(self, number: int, edition: str = "") -> dict[str, Any]:
        """Return a variant's parameters. Variant 0 of the first edition has the first of each list.

        Raises
        ------
        AuthorError
            There are fewer different variants than the rule's number.
        """
        variants: list[dict[str, Any]] = []
        for order in range(number + 1):
            for attempt in range(MOST_ATTEMPTS):
                drawn = self._draw(
                    f"{edition}\n{self.name}\n{order}\n{attempt}",
                    first=not (edition or order or attempt),
                )
                if drawn not in variants and (self.where is None or self.where(drawn)):
                    variants.append(drawn)
                    break
            else:
                raise AuthorError(
                    f"{self.name}: {MOST_ATTEMPTS} attempts gave only {order} different "
                    f"variants, not {self.count}. Give longer lists, or a smaller "
                    "count."
                )
        return variants[number]

    def _draw(self, seed: str, first: bool) -> dict[str, Any]:
        chance = random.Random(int.from_bytes(hashlib.sha256(seed.encode()).digest()))
        drawn = {}
        for name, pool in self.pools.items():
            if callable(pool):
                drawn[name] = pool(chance)
            else:
                choices = list(pool)
                drawn[name] = choices[0 if first else int(chance.random() * len(choices))]
        return drawn


def written(parameters: Mapping[str, object]) -> dict[str, str]:
    """Return parameters as the text of a question shows them."""
    return {name: _written(value) for name, value in parameters.items()}


def _written(value: object) -> str:
    if hasattr(value, "free_symbols"):
        import sympy

        return str(sympy.latex(value))
    if isinstance(value, (list, tuple)):
        return ", ".join(map(_written, value))
    return str(value)


def drawn_in(text: str) -> tuple[str, str] | None:
    """Return the variable and the question of a cell that draws variants, or ``None``.

    Raises
    ------
    AuthorError
        The cell is not one assignment of a call of ``draw``.
    """
    region = VARIANTS.search(text)
    if region is None:
        return None
    body = ast.parse(textwrap.dedent(region[1])).body
    calls = [
        (target.id, str(name.value))
        for statement in body
        if isinstance(statement, ast.Assign)
        and isinstance(statement.value, ast.Call)
        and getattr(statement.value.func, "id", "") == "draw"
        for target, name in zip(statement.targets, statement.value.args)
        if isinstance(target, ast.Name) and isinstance(name, ast.Constant)
    ]
    if len(calls) != 1:
        raise AuthorError(
            "Put exactly one `name = draw(...)` between the VARIANTS markers; this cell has "
            f"{len(calls)}:\n{region[1]}"
        )
    return calls[0]
