"""What each program's numbers mean: the table of the converter, the printed card and the workbench.

A program has a ``matrix`` (``'as here'``, or ``'transposed'`` if it gives the transpose of this
book's ${}^A\\mathbf{C}^N$), a ``scalar`` (``'first'`` or ``'last'``) and a ``unit`` of its angles.
Its ``lines`` are the forms that it takes, each with a line of code. In a line, ``{w} {x} {y} {z}``
are the components of a quaternion or a vector, ``{a} {b} {c}`` three angles in the order of the
rotations and ``{ax} {ay} {az}`` the same by axis; ``{s}`` is the sequence, ``{S}`` the same in
capitals, ``{A} {B} {C}`` its letters, ``{i} {j} {k}`` their numbers from 0; ``{m}`` is a matrix row
by row, and ``{t}`` its nine numbers column by column; ``{-a}`` is ``{a}`` with the opposite sign.
``sequences`` lists the sequences of a program that does not have all twelve. ``version`` is the one
that ``python -m tools.programs`` ran; it is empty if the table follows the manual alone, which is
at ``manual`` and was read in November 2026.

More keys say how two programs may differ, each left out if the manual does not mention it:
``angles`` are the program's choices for three numbers, as in
`orientation_workbench.mismatch.table.KINDS`; ``three numbers`` says that they are a rotation
vector; ``printed`` is the order in which it prints a quaternion, if it takes it in another;
``inverse`` lists forms, besides the matrix, that mean the inverse of this book's; ``body`` and
``world`` are the directions of x, y and z of an object and of its world. There, as in ROS, east
counts as forward and north as left.
"""

from difflib import get_close_matches

FLU, FRD, RDF = (
    ["forward", "left", "up"],
    ["forward", "right", "down"],
    ["right", "down", "forward"],
)
RUB, LUF = ["right", "up", "back"], ["left", "up", "forward"]
ROLL_PITCH_YAW = {"sequence": "xyz", "axes of the turns": "space fixed", "unit": "radians"}

FORMS = ("matrix", "quaternion", "body fixed angles", "space fixed angles", "axis times angle")
TAIT_BRYAN = ["xyz", "yzx", "zxy", "xzy", "zyx", "yxz"]
OTHER = "another program"

#: What each program's numbers mean, by the program's name: ``matrix`` (``'as here'`` or
#: ``'transposed'``), the place of the ``scalar`` part of its quaternions, the ``unit`` of its
#: angles, the ``lines`` of code for each form, the ``version`` that was run and the ``manual``. The
#: module's docstring explains every entry.
PROGRAMS = {
    "this book": {
        "version": "",
        "manual": "",
        "matrix": "as here",
        "scalar": "first",
        "unit": "radians",
        "lines": {
            "matrix": "np.array({m})",
            "quaternion": "dcm_from_quaternion(({w}, {x}, {y}, {z}))",
            "body fixed angles": "dcm_from_body_fixed(({a}, {b}, {c}), '{s}')",
            "space fixed angles": "dcm_from_space_fixed(({a}, {b}, {c}), '{s}')",
            "axis times angle": "dcm_from_rotation_vector(({x}, {y}, {z}))",
        },
    },
    "SymPy mechanics": {
        "version": "1.14.0",
        "manual": "https://docs.sympy.org/latest/modules/physics/vector/api/classes.html",
        "matrix": "as here",
        "scalar": "first",
        "unit": "radians",
        "lines": {
            "matrix": "A.orient_dcm(N, sm.Matrix({m}))",
            "quaternion": "A.orient_quaternion(N, ({w}, {x}, {y}, {z}))",
            "body fixed angles": "A.orient_body_fixed(N, ({a}, {b}, {c}), '{s}')",
            "space fixed angles": "A.orient_space_fixed(N, ({a}, {b}, {c}), '{s}')",
        },
    },
    "SciPy": {
        "version": "1.17.1",
        "manual": "https://docs.scipy.org/doc/scipy/reference/generated/scipy.spatial.transform.Rotation.html",
        "matrix": "transposed",
        "scalar": "last",
        "unit": "radians",
        "lines": {
            "matrix": "Rotation.from_matrix({m})",
            "quaternion": "Rotation.from_quat(({x}, {y}, {z}, {w}))",
            "body fixed angles": "Rotation.from_euler('{S}', ({a}, {b}, {c}))",
            "space fixed angles": "Rotation.from_euler('{s}', ({a}, {b}, {c}))",
            "axis times angle": "Rotation.from_rotvec(({x}, {y}, {z}))",
        },
    },
    "pytransform3d": {
        "version": "3.17.0",
        "manual": "https://dfki-ric.github.io/pytransform3d/",
        "matrix": "transposed",
        "scalar": "first",
        "unit": "radians",
        "lines": {
            "matrix": "np.array({m})",
            "quaternion": "pr.matrix_from_quaternion(({w}, {x}, {y}, {z}))",
            "body fixed angles": "pr.matrix_from_euler(({a}, {b}, {c}), {i}, {j}, {k}, "
            "extrinsic=False)",
            "space fixed angles": "pr.matrix_from_euler(({a}, {b}, {c}), {i}, {j}, {k}, "
            "extrinsic=True)",
            "axis times angle": "pr.matrix_from_compact_axis_angle(({x}, {y}, {z}))",
        },
    },
    "transforms3d": {
        "version": "0.4.2",
        "manual": "https://matthew-brett.github.io/transforms3d/",
        "matrix": "transposed",
        "scalar": "first",
        "unit": "radians",
        "lines": {
            "matrix": "np.array({m})",
            "quaternion": "quat2mat(({w}, {x}, {y}, {z}))",
            "body fixed angles": "euler2mat({a}, {b}, {c}, 'r{s}')",
            "space fixed angles": "euler2mat({a}, {b}, {c}, 's{s}')",
        },
    },
    "Eigen (C++)": {
        "version": "eigenpy 3.13.0",
        "manual": "https://eigen.tuxfamily.org/dox/group__TutorialGeometry.html",
        "matrix": "transposed",
        "scalar": "first",
        "unit": "radians",
        "printed": "xyzw",
        "lines": {
            "quaternion": "Quaterniond({w}, {x}, {y}, {z})",
            "body fixed angles": "AngleAxisd({a}, Vector3d::Unit{A}()) * AngleAxisd({b}, "
            "Vector3d::Unit{B}()) * AngleAxisd({c}, Vector3d::Unit{C}())",
            "space fixed angles": "AngleAxisd({c}, Vector3d::Unit{C}()) * AngleAxisd({b}, "
            "Vector3d::Unit{B}()) * AngleAxisd({a}, Vector3d::Unit{A}())",
        },
    },
    "MuJoCo model": {
        "version": "4.0.0",
        "manual": "https://mujoco.readthedocs.io/en/stable/modeling.html#frame-orientations",
        "matrix": "transposed",
        "scalar": "first",
        "unit": "degrees",
        "angles": {"sequence": "xyz", "axes of the turns": "body fixed"},
        "lines": {
            "quaternion": '<body quat="{w} {x} {y} {z}"/>',
            "body fixed angles": '<compiler eulerseq="{s}"/> <body euler="{a} {b} {c}"/>',
            "space fixed angles": '<compiler eulerseq="{S}"/> <body euler="{a} {b} {c}"/>',
        },
    },
    "OpenCV": {
        "version": "5.0.0.93",
        "manual": "https://docs.opencv.org/4.x/d9/d0c/group__calib3d.html",
        "matrix": "transposed",
        "scalar": "",
        "unit": "radians",
        "three numbers": "rotation vector",
        "lines": {
            "matrix": "np.array({m})",
            "axis times angle": "cv2.Rodrigues(np.array([{x}, {y}, {z}], float))[0]",
        },
    },
    "ROS tf2 (C++)": {
        "version": "",
        "manual": "https://docs.ros2.org/foxy/api/tf2/classtf2_1_1Matrix3x3.html",
        "matrix": "transposed",
        "scalar": "last",
        "unit": "radians",
        "sequences": {"space fixed angles": ["xyz"]},
        "angles": ROLL_PITCH_YAW,
        "body": FLU,
        "world": FLU,
        "lines": {
            "quaternion": "tf2::Quaternion({x}, {y}, {z}, {w})",
            "space fixed angles": "q.setRPY({a}, {b}, {c});",
        },
    },
    "MATLAB Aerospace": {
        "version": "",
        "manual": "https://www.mathworks.com/help/aerotbx/ug/angle2dcm.html",
        "matrix": "as here",
        "scalar": "first",
        "unit": "radians",
        "angles": {"sequence": "zyx", "axes of the turns": "body fixed"},
        "lines": {
            "quaternion": "quat2dcm([{w} {x} {y} {z}])",
            "body fixed angles": "angle2dcm({a}, {b}, {c}, '{S}')",
        },
    },
    "MATLAB Robotics": {
        "version": "",
        "manual": "https://www.mathworks.com/help/robotics/ref/eul2rotm.html",
        "matrix": "transposed",
        "scalar": "first",
        "unit": "radians",
        "angles": {"sequence": "zyx", "axes of the turns": "body fixed"},
        "lines": {
            "quaternion": "quat2rotm([{w} {x} {y} {z}])",
            "body fixed angles": "eul2rotm([{a} {b} {c}], '{S}')",
        },
    },
    "Blender": {
        "version": "5.0.1",
        "manual": "https://docs.blender.org/api/current/mathutils.html#mathutils.Euler",
        "matrix": "transposed",
        "scalar": "first",
        "unit": "radians",
        "sequences": {"space fixed angles": TAIT_BRYAN},
        "angles": {"sequence": "xyz", "axes of the turns": "space fixed"},
        "body": ["left", "back", "up"],
        "world": ["left", "back", "up"],
        "lines": {
            "matrix": "Matrix({m})",
            "quaternion": "Quaternion(({w}, {x}, {y}, {z}))",
            "space fixed angles": "Euler(({ax}, {ay}, {az}), '{S}')",
        },
    },
    "OpenCV solvePnP": {
        "version": "5.0.0.93",
        "manual": "https://docs.opencv.org/4.x/d5/d1f/calib3d_solvePnP.html",
        "matrix": "as here",
        "scalar": "",
        "unit": "radians",
        "three numbers": "rotation vector",
        "inverse": ["rotation vector"],
        "body": RDF,
        "lines": {
            "matrix": "np.array({m})",
            "axis times angle": "rvec = np.array([{x}, {y}, {z}], float)",
        },
    },
    "COLMAP": {
        "version": "pycolmap 4.2.1",
        "manual": "https://colmap.github.io/format.html",
        "matrix": "as here",
        "scalar": "first",
        "unit": "radians",
        "inverse": ["quaternion"],
        "body": RDF,
        "lines": {
            "matrix": "pycolmap.Rotation3d(np.array({m}))",
            "quaternion": "{w} {x} {y} {z}",
        },
    },
    "OpenGL view": {
        "version": "PyGLM 2.8.3",
        "manual": "https://registry.khronos.org/OpenGL-Refpages/gl2.1/xhtml/gluLookAt.xml",
        "matrix": "as here",
        "scalar": "",
        "unit": "radians",
        "body": RUB,
        "lines": {
            "matrix": "glm::mat3({t})",
        },
    },
    "nerfstudio": {
        "version": "1.1.5",
        "manual": "https://docs.nerf.studio/quickstart/data_conventions.html",
        "matrix": "transposed",
        "scalar": "",
        "unit": "radians",
        "body": RUB,
        "lines": {
            "matrix": "camera_to_worlds[:, :3] = torch.tensor({m})",
        },
    },
    "PyTorch3D": {
        "version": "",
        "manual": "https://pytorch3d.org/docs/cameras",
        "matrix": "transposed",
        "scalar": "first",
        "unit": "radians",
        "body": LUF,
        "lines": {
            "matrix": "PerspectiveCameras(R=torch.tensor([{m}]))",
            "quaternion": "quaternion_to_matrix(torch.tensor([{w}, {x}, {y}, {z}]).double())",
            "body fixed angles": "euler_angles_to_matrix(torch.tensor([{a}, {b}, {c}]).double(), "
            "'{S}')",
            "axis times angle": "axis_angle_to_matrix(torch.tensor([{x}, {y}, {z}]).double())",
        },
    },
    "kornia": {
        "version": "0.9.0",
        "manual": "https://kornia.readthedocs.io/en/latest/geometry.conversions.html",
        "matrix": "transposed",
        "scalar": "first",
        "unit": "radians",
        "sequences": {"space fixed angles": ["xyz"]},
        "angles": ROLL_PITCH_YAW,
        "lines": {
            "matrix": "torch.tensor([{m}])",
            "quaternion": "quaternion_to_rotation_matrix(torch.tensor([[{w}, {x}, {y}, "
            "{z}]]).double())",
            "space fixed angles": "quaternion_from_euler(*torch.tensor([{a}, {b}, {c}]).double())",
            "axis times angle": "axis_angle_to_rotation_matrix(torch.tensor([[{x}, {y}, "
            "{z}]]).double())",
        },
    },
    "three.js": {
        "version": "0.187.0",
        "manual": "https://threejs.org/docs/pages/Euler.html",
        "matrix": "transposed",
        "scalar": "last",
        "unit": "radians",
        "angles": {"sequence": "xyz", "axes of the turns": "body fixed"},
        "body": LUF,
        "world": LUF,
        "sequences": {"body fixed angles": TAIT_BRYAN},
        "lines": {
            "matrix": "new Matrix3().fromArray([{t}])",
            "quaternion": "new Quaternion({x}, {y}, {z}, {w})",
            "body fixed angles": "new Euler({ax}, {ay}, {az}, '{S}')",
        },
    },
    "glTF": {
        "version": "three.js 0.187.0",
        "manual": "https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html",
        "matrix": "transposed",
        "scalar": "last",
        "unit": "radians",
        "body": LUF,
        "world": LUF,
        "lines": {
            "quaternion": '"rotation": [{x}, {y}, {z}, {w}]',
        },
    },
    "Unity": {
        "version": "",
        "manual": "https://docs.unity3d.com/ScriptReference/Quaternion.Euler.html",
        "matrix": "transposed",
        "scalar": "last",
        "unit": "degrees",
        "angles": {"sequence": "zxy", "axes of the turns": "space fixed", "places": "231"},
        "body": ["right", "up", "forward"],
        "world": ["right", "up", "forward"],
        "sequences": {"space fixed angles": ["zxy"]},
        "lines": {
            "quaternion": "new Quaternion({x}f, {y}f, {z}f, {w}f)",
            "space fixed angles": "Quaternion.Euler({ax}f, {ay}f, {az}f)",
        },
    },
    "Unreal": {
        "version": "",
        "manual": "https://dev.epicgames.com/documentation/en-us/unreal-engine/API/Runtime/Core/Math/TRotator",
        "matrix": "transposed",
        "scalar": "last",
        "unit": "degrees",
        "angles": {
            "sequence": "zyx",
            "axes of the turns": "body fixed",
            "places": "213",
            "signs": "+--",
        },
        "body": ["forward", "right", "up"],
        "world": ["forward", "right", "up"],
        "sequences": {"body fixed angles": ["zyx"]},
        "lines": {
            "quaternion": "FQuat({x}, {y}, {z}, {w})",
            "body fixed angles": "FRotator({-b}, {a}, {-c})",
        },
    },
    "PX4": {
        "version": "",
        "manual": "https://docs.px4.io/main/en/msg_docs/VehicleAttitude.html",
        "matrix": "transposed",
        "scalar": "first",
        "unit": "radians",
        "angles": {"sequence": "zyx", "axes of the turns": "body fixed", "places": "321"},
        "body": FRD,
        "world": ["left", "forward", "down"],
        "sequences": {"body fixed angles": ["zyx"]},
        "lines": {
            "quaternion": "matrix::Quatf({w}f, {x}f, {y}f, {z}f)",
            "body fixed angles": "matrix::Eulerf({c}f, {b}f, {a}f)",
        },
    },
    "Isaac Lab 2": {
        "version": "2.3.2.post1",
        "manual": "https://isaac-sim.github.io/IsaacLab/main/source/migration/migrating_from_isaacgymenvs.html",
        "matrix": "transposed",
        "scalar": "first",
        "unit": "radians",
        "body": FLU,
        "world": FLU,
        "sequences": {"space fixed angles": ["xyz"]},
        "angles": ROLL_PITCH_YAW,
        "lines": {
            "quaternion": "matrix_from_quat(torch.tensor([{w}, {x}, {y}, {z}]))",
            "space fixed angles": "quat_from_euler_xyz(*torch.tensor([{a}, {b}, {c}]))",
        },
    },
    "Isaac Lab 3": {
        "version": "",
        "manual": "https://docs.nvidia.com/isaaclab/isaac-lab/migrating-to-3-0",
        "matrix": "transposed",
        "scalar": "last",
        "unit": "radians",
        "body": FLU,
        "world": FLU,
        "sequences": {"space fixed angles": ["xyz"]},
        "angles": ROLL_PITCH_YAW,
        "lines": {
            "quaternion": "matrix_from_quat(torch.tensor([{x}, {y}, {z}, {w}]))",
            "space fixed angles": "quat_from_euler_xyz(*torch.tensor([{a}, {b}, {c}]))",
        },
    },
    "Drake": {
        "version": "1.51.1",
        "manual": "https://drake.mit.edu/doxygen_cxx/classdrake_1_1math_1_1_roll_pitch_yaw.html",
        "matrix": "transposed",
        "scalar": "first",
        "unit": "radians",
        "angles": ROLL_PITCH_YAW,
        "sequences": {"space fixed angles": ["xyz"]},
        "lines": {
            "matrix": "RotationMatrix(np.array({m}))",
            "quaternion": "RotationMatrix(Quaternion({w}, {x}, {y}, {z}))",
            "space fixed angles": "RollPitchYaw({a}, {b}, {c})",
        },
    },
    "PyBullet": {
        "version": "3.2.7",
        "manual": "https://github.com/bulletphysics/bullet3/issues/4407",
        "matrix": "transposed",
        "scalar": "last",
        "unit": "radians",
        "angles": ROLL_PITCH_YAW,
        "sequences": {"space fixed angles": ["xyz"]},
        "lines": {
            "quaternion": "getMatrixFromQuaternion(({x}, {y}, {z}, {w}))",
            "space fixed angles": "getQuaternionFromEuler(({a}, {b}, {c}))",
        },
    },
    "URDF": {
        "version": "yourdfpy 0.0.60",
        "manual": "https://wiki.ros.org/urdf/XML/joint",
        "matrix": "transposed",
        "scalar": "",
        "unit": "radians",
        "angles": ROLL_PITCH_YAW,
        "body": FLU,
        "world": FLU,
        "sequences": {"space fixed angles": ["xyz"]},
        "lines": {
            "space fixed angles": '<origin rpy="{a} {b} {c}"/>',
        },
    },
    "BVH": {
        "version": "three.js 0.187.0",
        "manual": "https://research.cs.wisc.edu/graphics/Courses/cs-838-1999/Jeff/BVH.html",
        "matrix": "transposed",
        "scalar": "",
        "unit": "degrees",
        "angles": {"axes of the turns": "body fixed"},
        "lines": {
            "body fixed angles": "CHANNELS 3 {A}rotation {B}rotation {C}rotation: {a} {b} {c}",
        },
    },
}


def program_named(words):
    """Return the one program with these words in its name, from the start of a word, in any case.

    Raises
    ------
    ValueError
        If no program or several programs match.
    """
    given = words.casefold()
    exact = [program for program in PROGRAMS if program.casefold() == given]
    matches = exact or [program for program in PROGRAMS if f" {given}" in f" {program.casefold()}"]
    if len(matches) != 1:
        near = get_close_matches(given, " ".join(PROGRAMS).casefold().split(), 1, 0.7)
        raise ValueError(
            f"{words!r} matches several programs: {', '.join(matches)}"
            if matches
            else f"unknown program {words!r}"
            + "".join(f" (did you mean {word}?)" for word in near)
            + f": {', '.join(PROGRAMS)}"
        )
    return matches[0]


def expected_of(program):
    """Return what a program's numbers mean by its manual, in the words of the table of mix-ups."""
    facts = PROGRAMS[program]
    order = facts.get("printed") or {"first": "wxyz", "last": "xyzw", "": None}[facts["scalar"]]
    return {
        "declared": {"unit": facts["unit"]}
        | ({"order": order} if order else {})
        | facts.get("angles", {}),
        "inverse": [
            *(["matrix"] if facts["matrix"] == "transposed" else []),
            *facts.get("inverse", ()),
        ],
        "three numbers": facts.get("three numbers", "Euler angles"),
        "body": facts.get("body"),
        "world": facts.get("world"),
        "manual": facts["manual"],
    }
