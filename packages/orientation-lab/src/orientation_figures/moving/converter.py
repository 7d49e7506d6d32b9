"""Convert the numbers of one program to those of another."""

import traitlets

from orientation.euler_angles import SEQUENCES
from orientation.quaternions import dcm_from_quaternion
from orientation_workbench.programs import FORMS, OTHER, PROGRAMS, expected_of

from .figure import MovingFigure
from .state import Numbers

# The menus on each side of the converter. For a program in the table, its own convention comes
# before the last three.
CHOICES = {
    "program": (*PROGRAMS, OTHER),
    "form": FORMS,
    "sequence": SEQUENCES,
    "matrix": ("as here", "transposed"),
    "scalar": ("first", "last"),
    "unit": ("radians", "degrees"),
}
FIRST = {
    "form": "quaternion",
    "sequence": "zyx",
    "matrix": "as here",
    "scalar": "first",
    "unit": "radians",
}
# The camera in its gimbal from the whole chapter: 0.4, 0.7 and -0.3 rad, body fixed z-x-y.
AT_FIRST = (0.9204901330363197, 0.3601778830129209, -0.07022156093803689, 0.13430837632305287)


#: The direction of an axis, along forward, left and up.
_WAYS = {
    "forward": (1, 0, 0),
    "left": (0, 1, 0),
    "up": (0, 0, 1),
    "back": (-1, 0, 0),
    "right": (0, -1, 0),
    "down": (0, 0, -1),
}
_FORM_OF = {"quaternion": "quaternion", "rotation vector": "axis times angle", "matrix": "matrix"}


def _as_the_page_has_it(program):
    """Return the table's facts on a program, with the inverse forms and its axes as numbers."""
    facts, inverse = PROGRAMS[program], expected_of(program)["inverse"]
    axes = [
        [list(_WAYS[way]) for way in facts[whose]] if facts.get(whose) else None
        for whose in ("body", "world")
    ]
    return facts | {"turned": [_FORM_OF[kind] for kind in inverse], "axes": axes}


#: The table of programs for the page.
FOR_THE_PAGE = {program: _as_the_page_has_it(program) for program in PROGRAMS}


class Side(traitlets.TraitType):
    """A program and the form of its numbers, kept as a dictionary with a value for every choice."""

    def validate(self, obj, value):
        if not isinstance(value, dict):
            raise traitlets.TraitError(
                f"{self.name} is {value!r}: expected a dictionary such as {{'program': 'SciPy'}}"
            )
        side = FIRST | {"program": "this book"} | value
        for name, chosen in side.items():
            if name not in CHOICES:
                raise traitlets.TraitError(
                    f"{self.name} has {name!r}; choose from {', '.join(CHOICES)}"
                )
            allowed = CHOICES[name]
            if chosen not in allowed:
                raise traitlets.TraitError(
                    f"{self.name} has {name} {chosen!r}; choose from {', '.join(allowed)}"
                )
        lines = PROGRAMS.get(side["program"], {}).get("lines", FORMS)
        if side["form"] not in lines:
            raise traitlets.TraitError(
                f"{side['program']} does not take {side['form']}; it takes {', '.join(lines)}"
            )
        return side


class ConverterFigure(MovingFigure):
    r"""Numbers of one program, as it means them, and the same orientation in another.

    Attributes
    ----------
    quaternion : tuple of four floats
        The orientation that both sides describe: ${}^A\mathbf{C}^N$ as a quaternion, scalar first.
    source, target : dict
        For each side, ``program``, one of those in ``orientation_workbench.programs``; ``form``;
        ``sequence``; and for another program ``matrix``, ``scalar`` and ``unit``.

    Examples
    --------
    >>> from orientation_figures.moving import ConverterFigure
    >>> figure = ConverterFigure(source={'program': 'SciPy', 'form': 'quaternion'})
    >>> figure.source['sequence']
    'zyx'
    """

    kind = "converter"
    sheet = (-180, -172, 180, 172)
    room = (893, 1232)
    quaternion = Numbers(AT_FIRST, (4,), 1.0).tag(sync=True, state=True)
    source = Side(FIRST | {"program": "SciPy"}).tag(sync=True, state=True)
    target = Side(
        FIRST | {"program": "this book", "form": "body fixed angles", "sequence": "zxy"}
    ).tag(sync=True, state=True)
    programs = traitlets.Dict(FOR_THE_PAGE, read_only=True).tag(sync=True, constant=True)

    @property
    def dcm(self):
        r"""${}^A\mathbf{C}^N$, shape ``(3, 3)``."""
        return dcm_from_quaternion(self.quaternion)
