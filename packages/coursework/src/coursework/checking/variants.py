"""A question in several variants: each student gets one, by the student's ID, with no server.

The variants of a question differ in their numbers, axes or names, and are sealed one by one. A hash
of the student's ID, the question and the edition of the course chooses the variant, so the same
student gets the same one in every notebook, on every machine and in the grader. Without an ID it is
variant 0.

The variants that come next are its siblings: a student who had help with a question earns the rest
of its points with one of them. A sibling has a name, ``'levers/see-saw/sibling'``, under which it
is shown, checked and graded.
"""

import base64
import hashlib
import html
import json
import re
import zlib
from collections.abc import Iterable, Mapping

from .fields import Json, pair, text
from .identity import plain_identity
from .question import Question, Variant

# The number of siblings of a question that count. If all variants did, so would somebody else's
# answer.
SIBLINGS = 2
SIBLING = re.compile(r"(?P<question>.+)/sibling(?:-(?P<order>[2-9]))?")


def variant_of(student: str, name: str, count: int, edition: str = "") -> int:
    """Return the number of a student's variant of a question, below ``count``.

    >>> [variant_of(ada, 'levers/see-saw', 16) for ada in ('Ada@Uni.example ', 'ada@uni.example')]
    [11, 11]
    >>> variant_of('', 'levers/see-saw', 16)
    0
    """
    student = plain_identity(student)
    if not student or count < 2:
        return 0
    # JSON and the like could be read in two ways only if a part contained a line break, which names
    # and editions do not.
    digest = hashlib.sha256(f"{edition}\n{name}\n{student}".encode()).digest()
    return int.from_bytes(digest[:8]) % count


def names_of_variants(variants: Iterable[Variant]) -> list[str]:
    """Return the names of variants, which depend only on what is given and shown in each.

    Parameters
    ----------
    variants : iterable of Variant
        All variants of a question, in order.

    >>> short, long = Variant(given={"arm": 2}), Variant(given={"arm": 3})
    >>> names_of_variants([short, long]) == names_of_variants([long, short])[::-1]
    True
    """
    names: list[str] = []
    for variant in variants:
        content = json.dumps({**variant.shown, **variant.given}, sort_keys=True)
        name = hashlib.sha256(content.encode()).hexdigest()[:12]
        # Two variants have the same content.
        while name in names:
            name += "+"
        names.append(name)
    return names


def numbers_of_variants(student: str, name: str, variant: Variant, count: int) -> list[int]:
    """Return the numbers of all variants in a student's order: first the student's own.

    A course that names its variants assigns them by these names (rendezvous hashing). Each student
    has an order of all possible names, so removing a variant affects only those who had it, who get
    the next one. Without names, the number depends on the count of variants, and the others follow
    in turn.

    Parameters
    ----------
    student : str
        The student's ID; without one, the variants keep their order.
    name : str
    variant : Variant
        One of them.
    A variant of the question.
    """
    edition, names = variant.edition, variant.names
    student = plain_identity(student)
    if not names or not student:
        first = variant_of(student, name, count, edition)
        return [(first + order) % count for order in range(count)]

    def rank(number: int) -> bytes:
        return hashlib.sha256(f"{edition}\n{name}\n{student}\n{names[number]}".encode()).digest()

    return sorted(range(count), key=rank)


def own_variant(student: str, name: str, question: Question, order: int = 0) -> int:
    """Return the number of a student's variant, or of one of its siblings."""
    variant = question.variant or Variant()
    return numbers_of_variants(student, name, variant, variant.count)[order % variant.count]


def siblings_of(name: str, count: int) -> list[str]:
    """Return the names of the siblings of a question with ``count`` variants, in order.

    >>> siblings_of('levers/see-saw', 16)
    ['levers/see-saw/sibling', 'levers/see-saw/sibling-2']
    """
    return [
        f"{name}/sibling" + (f"-{order}" if order > 1 else "")
        for order in range(1, min(SIBLINGS + 1, count))
    ]


def without_sibling(name: str) -> tuple[str, int]:
    """Return the question of a name, and the number of its sibling: 0 is the student's own variant.

    >>> without_sibling('levers/see-saw/sibling-2'), without_sibling('levers/see-saw')
    (('levers/see-saw', 2), ('levers/see-saw', 0))
    """
    match = SIBLING.fullmatch(name)
    return (match["question"], int(match["order"] or 1)) if match else (name, 0)


def shown(text: str, written: Mapping[str, str]) -> str:
    """Return the text of a question with its given values inserted.

    >>> shown("A force of {{force}} N", {"force": "20"})
    'A force of 20 N'
    """
    for name, value in written.items():
        text = text.replace(f"{{{{{name}}}}}", value)
    return text


def image(picture: str, alt: str) -> str:
    """Return an SVG picture as Markdown, with its text description."""
    (width,) = re.findall(r'width="(\S+)"', picture)[:1]
    data = base64.b64encode(picture.encode("utf8")).decode("ascii")
    # Use HTML, because careful Markdown readers refuse this kind of address in an image of their
    # own.
    return (
        f'<p><img alt="{html.escape(alt)}" width="{width}" '
        f'src="data:image/svg+xml;base64,{data}"></p>'
    )


def packed(picture: str, alt: str) -> str:
    """Return a picture as short text: pictures are most of the differences between variants."""
    return base64.b85encode(zlib.compress(json.dumps([picture, alt]).encode("utf8"), 9)).decode(
        "ascii"
    )


def text_of(variant: Variant) -> str:
    """Return the whole text of a question that has variants, with its picture.

    >>> picture = packed('<svg width="9">', "Up")
    >>> given = {"arm": "2"}
    >>> print(text_of(Variant(text="{{picture}} Give {{arm}}.", shown=given, picture=picture)))
    <p><img alt="Up" width="9" src="data:image/svg+xml;base64,PHN2ZyB3aWR0aD0iOSI+"></p> Give 2.
    """
    written = dict(variant.shown)
    if variant.picture:
        picture, alt = pair(text)(
            json.loads(zlib.decompress(base64.b85decode(variant.picture))), "A picture"
        )
        written["picture"] = image(picture, alt)
    return shown(variant.text, written)


class Given:
    """The given data of a question: its text, and its numbers and names by name.

    >>> given = Given("A force of $20$ N.", {"force": 20})
    >>> given.force, given["force"]
    (20, 20)
    """

    def __init__(self, text: str, parameters: Mapping[str, Json]) -> None:
        self._text, self._parameters = text, dict(parameters)

    def __getitem__(self, name: str) -> Json:
        return self._parameters[name]

    def __getattr__(self, name: str) -> Json:
        if name.startswith("_"):
            raise AttributeError(name)
        if name not in self._parameters:
            names = ", ".join(f"`{name}`" for name in self._parameters) or "no numbers of its own"
            raise AttributeError(f"This question gives {names}, but not `{name}`.")
        return self._parameters[name]

    def __repr__(self) -> str:
        text = re.sub(
            r'<p><img alt="([^"]*)"[^>]*></p>', lambda match: html.unescape(match[1]), self._text
        )
        # An asterisk between spaces, or in code, is a product; the others set words in italics.
        return re.sub(r"`([^`]*)`|\$|\*(?!\s)|(?<!\s)\*", lambda mark: mark[1] or "", text)

    def _repr_markdown_(self) -> str:
        return self._text
