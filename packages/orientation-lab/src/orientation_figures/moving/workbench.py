"""Two programs disagree: the reader pastes the numbers of both, and the figure names the mix-up."""

import json

import traitlets

from orientation_workbench.mismatch.table import COUNTS, SEQUENCES, TURNS, WAYS, whole_table
from orientation_workbench.programs import PROGRAMS

from .figure import MovingFigure
from .state import Numbers

UNKNOWN = "not known"
NOTHING_KNOWN = dict.fromkeys(("program", "kind", "sequence", "order", "way", TURNS), UNKNOWN)
# Typical cases, most with the numbers of a public thread: the numbers of both programs, and the
# known facts about each.
EXAMPLES = {
    "A quaternion with the scalar last, read as scalar first": (
        "0.9205 0.3602 -0.0702 0.1343\n0.7011 -0.2150 0.5873 0.3421",
        "0.3602 -0.0702 0.1343 0.9205\n-0.2150 0.5873 0.3421 0.7011",
    ),
    "One matrix, two quaternions: Eigen and RBDL (rbdl 107)": (
        "Eigen quaternion:\n 0.0505867i + 0.72037j + -0.683741k + -0.104906",
        "RBDL quaternion:\n 0.0505867\n  0.72037\n-0.683741\n 0.104906",
    ),
    "Roll, pitch, yaw: fixed axes or rotated ones (moveit_calibration 132)": (
        "q = [-0.0372638, -0.0326999, 0.773564, 0.631776]",
        "(0.0035234877615449344, -0.09913217272764203, 1.7720752160631836)",
        {"program": "ROS tf2 (C++)"},
        {"program": "ROS tf2 (C++)"},
    ),
    "A lamp and a camera from Blender, in glTF (glTF-Blender-IO 438)": (
        "<Quaternion (w=0.5709, x=0.1691, y=0.2722, z=0.7559)>\n"
        "<Quaternion (w=0.7805, x=0.4835, y=0.2087, z=0.3369)>",
        '"rotation": [0.16907575, 0.75588035, -0.27217138, 0.57094753]\n'
        '"rotation": [0.48353603, 0.33687159, -0.20870360, 0.78048271]',
        {},
        {"program": "glTF"},
    ),
    "Angles in Unity (Quaternion.js 12)": (
        "w = 0.87851f; x = -0.24479f; y = -0.18215f; z = 0.36758f;",
        "(x: 342.77, y: 328.43, z: 50.31)",
    ),
    "A COLMAP camera, read into nerfstudio": (
        "0.9205 0.3602 -0.0702 0.1343\n0.7011 -0.2150 0.5873 0.3421",
        "0.9541 0.1967 0.2260\n-0.2978 0.7044 0.6443\n-0.0325 -0.6820 0.7307\n"
        "0.0758 0.2272 -0.9709\n-0.7324 0.6734 0.1004\n0.6766 0.7035 0.2175",
        {"program": "COLMAP"},
        {"program": "nerfstudio"},
    ),
    "An autopilot in NED and FRD, ROS in ENU and FLU": (
        "0.9541 0.1967 0.2260\n-0.2978 0.7045 0.6442\n-0.0325 -0.6819 0.7307",
        "0.1967 0.9541 -0.2260\n-0.7045 0.2978 0.6442\n0.6819 0.0325 0.7307",
        {"way": "rows"},
        {"way": "rows"},
    ),
    "Level and turned about the vertical only: more than one answer": (
        "0.8776 0.4794 0\n-0.4794 0.8776 0\n0 0 1",
        "0.8776 -0.4794 0\n0.4794 0.8776 0\n0 0 1",
    ),
    "A matrix that is not a rotation (pytorch3d 155)": (
        "tensor([[[ 0.8888,  0.0357, -0.4569],\n         [-0.4552,  0.1834, -0.8713],\n"
        "         [ 0.0528,  0.9824,  0.1793]]], device='cuda:0')",
        "tensor([[[ 0.8888,  0.1516, -0.4325],\n         [-0.4552,  0.1834, -0.8713],\n"
        "         [ 0.0528, -0.9713, -0.2321]]], device='cuda:0')",
    ),
}


def _as_the_page_has_it(data):
    """Return plain data with lists instead of tuples, as they are after a round trip to a page."""
    return json.loads(json.dumps(data))


class Known(traitlets.TraitType):
    """The known facts on one side's numbers: a program, a kind, and for Euler angles a sequence."""

    def validate(self, obj, value):
        if not isinstance(value, dict) or set(value) - set(NOTHING_KNOWN):
            raise traitlets.TraitError(
                f"{self.name} is {value!r}: expected a dictionary with {', '.join(NOTHING_KNOWN)}"
            )
        known = NOTHING_KNOWN | value
        for name, allowed in (
            ("program", PROGRAMS), ("kind", COUNTS), ("sequence", SEQUENCES),
            ("order", ("wxyz", "xyzw")), ("way", WAYS), (TURNS, ("body fixed", "space fixed")),
        ):  # fmt: skip
            if known[name] != UNKNOWN and known[name] not in allowed:
                raise traitlets.TraitError(
                    f"{self.name} has {name} {known[name]!r}; choose from {', '.join(allowed)}"
                )
        return known


class WorkbenchFigure(MovingFigure):
    """The numbers of two programs for the same poses, and how the conventions differ.

    Attributes
    ----------
    first, second : str
        The numbers of each program, as `orientation_workbench.explain` reads them.
    first_is, second_is : dict
        The known facts about each: ``program``, ``kind``, ``sequence``, ``order`` of a quaternion,
        ``axes of the turns``, and ``way``, the direction of the transformation; each
        ``'not known'`` at first.
    noise : float
        Degrees by which the two may differ besides rounding.

    Examples
    --------
    >>> from orientation_figures.moving import WorkbenchFigure
    >>> figure = WorkbenchFigure(first='0 0 0 1', second='1 0 0 0')
    """

    kind = "workbench"
    sheet = (-330, -172, 330, 172)
    room = (1070, 1175)
    first = traitlets.Unicode(
        EXAMPLES["A quaternion with the scalar last, read as scalar first"][0]
    ).tag(sync=True, state=True)
    second = traitlets.Unicode(
        EXAMPLES["A quaternion with the scalar last, read as scalar first"][1]
    ).tag(sync=True, state=True)
    first_is = Known(NOTHING_KNOWN).tag(sync=True, state=True)
    second_is = Known(NOTHING_KNOWN).tag(sync=True, state=True)
    noise = Numbers(0.0, (), 30.0, smallest=0.0).tag(sync=True, state=True)
    table = traitlets.Dict(_as_the_page_has_it(whole_table()), read_only=True).tag(
        sync=True, constant=True
    )
    examples = traitlets.Dict(_as_the_page_has_it(EXAMPLES), read_only=True).tag(
        sync=True, constant=True
    )
