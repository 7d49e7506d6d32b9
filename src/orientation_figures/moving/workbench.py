"""Two programs disagree: what both gave is pasted, and the mix-up is named."""

import json

import traitlets

from orientation_workbench.mismatch.table import COUNTS, SEQUENCES, whole_table
from orientation_workbench.programs import PROGRAMS

from .figure import MovingFigure
from .state import Numbers

UNKNOWN = "not known"
NOTHING_KNOWN = {"program": UNKNOWN, "kind": UNKNOWN, "sequence": UNKNOWN}
#: Cases as they are met, each with what both programs gave: two poses of a camera in its gimbal.
EXAMPLES = {
    "A quaternion, scalar last for scalar first": (
        "0.9205 0.3602 -0.0702 0.1343\n0.7011 -0.2150 0.5873 0.3421",
        "0.3602 -0.0702 0.1343 0.9205\n-0.2150 0.5873 0.3421 0.7011",
    ),
    "A camera's matrix, world to camera for camera to world": (
        "0.9541 0.1967 0.2260\n-0.2978 0.7307 0.6144\n-0.0443 -0.6535 0.7559",
        "0.9541 -0.2978 -0.0443\n0.1967 0.7307 -0.6535\n0.2260 0.6144 0.7559",
    ),
    "An autopilot in NED and FRD, ROS in ENU and FLU": (
        "0.9541 0.1967 0.2260\n-0.2978 0.7307 0.6144\n-0.0443 -0.6535 0.7559",
        "0.1967 0.9541 -0.2260\n-0.7307 0.2978 0.6144\n0.6535 0.0443 0.7559",
    ),
    "Level and turned about the vertical only: more than one answer": (
        "0.8776 0.4794 0\n-0.4794 0.8776 0\n0 0 1",
        "0.8776 -0.4794 0\n0.4794 0.8776 0\n0 0 1",
    ),
}


def _as_the_page_has_it(data):
    """Plain data with lists in the place of tuples, so that it is the same after its way to a page and back."""
    return json.loads(json.dumps(data))


class Known(traitlets.TraitType):
    """What is known of one side's numbers: a dictionary with a program, a kind, and for Euler angles a sequence."""

    def validate(self, obj, value):
        if not isinstance(value, dict) or set(value) - set(NOTHING_KNOWN):
            raise traitlets.TraitError(
                f"{self.name} is {value!r}: a dictionary with 'program', 'kind' and 'sequence' was expected"
            )
        known = NOTHING_KNOWN | value
        for name, allowed in (("program", PROGRAMS), ("kind", COUNTS), ("sequence", SEQUENCES)):
            if known[name] != UNKNOWN and known[name] not in allowed:
                raise traitlets.TraitError(f"{self.name} has {name} {known[name]!r}; there is {', '.join(allowed)}")
        return known


class WorkbenchFigure(MovingFigure):
    """What two programs give for the same poses, and what they mean differently by it.

    Attributes
    ----------
    first, second : str
        What each program gave, as :func:`orientation_workbench.explain` reads it.
    first_is, second_is : dict
        What is known of each: ``program``, ``kind`` and ``sequence``, each ``'not known'`` at first.
    noise : float
        Degrees by which the two may differ besides rounding.

    Examples
    --------
    >>> from orientation_figures.moving import WorkbenchFigure
    >>> figure = WorkbenchFigure(first='0 0 0 1', second='1 0 0 0')
    """

    kind = "workbench"
    sheet = (-330, -172, 330, 172)
    room = (800, 1010)
    first = traitlets.Unicode(EXAMPLES["A quaternion, scalar last for scalar first"][0]).tag(sync=True, state=True)
    second = traitlets.Unicode(EXAMPLES["A quaternion, scalar last for scalar first"][1]).tag(sync=True, state=True)
    first_is = Known(NOTHING_KNOWN).tag(sync=True, state=True)
    second_is = Known(NOTHING_KNOWN).tag(sync=True, state=True)
    noise = Numbers(0.0, (), 30.0, smallest=0.0).tag(sync=True, state=True)
    table = traitlets.Dict(_as_the_page_has_it(whole_table()), read_only=True).tag(sync=True, told=True)
    examples = traitlets.Dict(_as_the_page_has_it(EXAMPLES), read_only=True).tag(sync=True, told=True)
