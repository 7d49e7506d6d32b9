"""What the numbers of each program mean: one table, from which the converter and the printed card are made.

A program has a ``matrix`` (``'as here'``, or ``'transposed'`` where it gives the transpose of this book's
:math:`{}^A\\mathbf{C}^N`), a ``scalar`` (``'first'`` or ``'last'``) and a ``unit`` of its angles. Its ``lines`` are
the forms that it takes, each with the line of code for it. In a line, ``{w} {x} {y} {z}`` are the parts of a
quaternion or of a vector, ``{a} {b} {c}`` three angles in the order of the turns and ``{ax} {ay} {az}`` the same by
their axes; ``{s}`` is the sequence, ``{S}`` the same in capitals, ``{A} {B} {C}`` its letters, ``{i} {j} {k}`` their
numbers from 0; ``{m}`` a matrix, row by row. ``sequences`` names the only ones where there are not all twelve.
``version`` is the one that was run, and empty where the table follows the manual alone, which is at ``manual``.
"""

FORMS = ("matrix", "quaternion", "body fixed angles", "space fixed angles", "axis times angle")
TAIT_BRYAN = ["xyz", "yzx", "zxy", "xzy", "zyx", "yxz"]
OTHER = "another program"

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
            "body fixed angles": "pr.matrix_from_euler(({a}, {b}, {c}), {i}, {j}, {k}, extrinsic=False)",
            "space fixed angles": "pr.matrix_from_euler(({a}, {b}, {c}), {i}, {j}, {k}, extrinsic=True)",
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
        "lines": {
            "quaternion": "Quaterniond({w}, {x}, {y}, {z})",
            "body fixed angles": "AngleAxisd({a}, Vector3d::Unit{A}()) * AngleAxisd({b}, Vector3d::Unit{B}())"
            " * AngleAxisd({c}, Vector3d::Unit{C}())",
            "space fixed angles": "AngleAxisd({c}, Vector3d::Unit{C}()) * AngleAxisd({b}, Vector3d::Unit{B}())"
            " * AngleAxisd({a}, Vector3d::Unit{A}())",
        },
    },
    "MuJoCo model": {
        "version": "4.0.0",
        "manual": "https://mujoco.readthedocs.io/en/stable/modeling.html#frame-orientations",
        "matrix": "transposed",
        "scalar": "first",
        "unit": "degrees",
        "lines": {
            "quaternion": '<body quat="{w} {x} {y} {z}"/>',
            "body fixed angles": '<compiler eulerseq="{s}"/> <body euler="{a} {b} {c}"/>',
            "space fixed angles": '<compiler eulerseq="{S}"/> <body euler="{a} {b} {c}"/>',
        },
    },
    "OpenCV": {
        "version": "5.0.0",
        "manual": "https://docs.opencv.org/4.x/d9/d0c/group__calib3d.html",
        "matrix": "transposed",
        "scalar": "",
        "unit": "radians",
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
        "lines": {
            "quaternion": "quat2rotm([{w} {x} {y} {z}])",
            "body fixed angles": "eul2rotm([{a} {b} {c}], '{S}')",
        },
    },
    "Blender": {
        "version": "",
        "manual": "https://docs.blender.org/api/current/mathutils.html#mathutils.Euler",
        "matrix": "transposed",
        "scalar": "first",
        "unit": "radians",
        "sequences": {"space fixed angles": TAIT_BRYAN},
        "lines": {
            "matrix": "Matrix({m})",
            "quaternion": "Quaternion(({w}, {x}, {y}, {z}))",
            "space fixed angles": "Euler(({ax}, {ay}, {az}), '{S}')",
        },
    },
}
