"""Print the answers of one program: ``python answers.py PROGRAM < questions.json``.

Run this in an environment that has the program. Each of the ``orientations`` is an axis and an
angle, from which the program makes the orientation itself, or, for a camera, from what it sees. The
answers go to standard output as JSON: the version, and for each line that was run the form of its
numbers, as in `orientation_workbench.mismatch.table.KINDS`, and the numbers, one orientation after
another. ``made`` are the matrices that the program makes from the card's own ``lines``.
"""

import json
import re
import sys
import tempfile
from importlib import import_module
from importlib.metadata import version
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from pkgutil import resolve_name
from sysconfig import get_paths

import numpy as np

MATRIX, VECTOR = {"kind": "matrix"}, {"kind": "rotation vector"}


def quaternion(order):
    return {"kind": "quaternion", "order": order}


def angles(sequence):
    return {"kind": "Euler angles", "sequence": sequence}


WXYZ, XYZW, XYZ = quaternion("wxyz"), quaternion("xyzw"), angles("xyz")


def axes_of_a_camera(axis, angle):
    """Return the axes x, y and z of a camera after a rotation, as rows, by Rodrigues' formula."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return (np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross).T


def scipy(axis, angle):
    rotation = import_module("scipy.spatial.transform").Rotation.from_rotvec(angle * axis)
    yield "Rotation.from_rotvec(v).as_matrix()", MATRIX, rotation.as_matrix()
    yield "Rotation.from_rotvec(v).as_quat()", XYZW, rotation.as_quat()


def pytransform3d(axis, angle):
    pr = import_module("pytransform3d.rotations")
    yield "pr.matrix_from_axis_angle(a)", MATRIX, pr.matrix_from_axis_angle((*axis, angle))
    yield "pr.quaternion_from_axis_angle(a)", WXYZ, pr.quaternion_from_axis_angle((*axis, angle))


def transforms3d(axis, angle):
    axangles, quaternions = (
        import_module("transforms3d.axangles"),
        import_module("transforms3d.quaternions"),
    )
    yield "axangle2mat(axis, angle)", MATRIX, axangles.axangle2mat(axis, angle)
    yield "axangle2quat(axis, angle)", WXYZ, quaternions.axangle2quat(axis, angle)


def eigen(axis, angle):
    eigenpy = import_module("eigenpy")
    turn = eigenpy.AngleAxis(angle, axis)
    yield "AngleAxis(angle, axis).toRotationMatrix()", MATRIX, turn.toRotationMatrix()
    yield "Quaternion(AngleAxis(angle, axis)).coeffs()", XYZW, eigenpy.Quaternion(turn).coeffs()
    # The first angle is from 0 to pi, whatever that means for the others. The chapter warns of
    # this.
    yield (
        "R.eulerAngles(2, 0, 1)",
        angles("zxy"),
        eigenpy.toEulerAngles(turn.toRotationMatrix(), 2, 0, 1),
    )


def mujoco(axis, angle):
    module = import_module("mujoco")
    numbers = " ".join(map(repr, map(float, (*axis, np.degrees(angle)))))
    world = (
        f"<mujoco><worldbody><body axisangle='{numbers}'><geom "
        "size='0.1'/></body></worldbody></mujoco>"
    )
    data = module.MjData(model := module.MjModel.from_xml_string(world))
    module.mj_forward(model, data)
    yield '<body axisangle="x y z angle"/>, data.xmat', MATRIX, data.xmat[1]
    yield '<body axisangle="x y z angle"/>, data.xquat', WXYZ, data.xquat[1]


def opencv(axis, angle):
    cv2 = import_module("cv2")
    yield "cv2.Rodrigues(v)[0]", MATRIX, cv2.Rodrigues(angle * axis)[0]
    yield "cv2.Rodrigues(m)[0]", VECTOR, cv2.Rodrigues(cv2.Rodrigues(angle * axis)[0])[0]


#: Corners in front of a camera, each at its own depth, along its x (right), y (down) and z
#: (forward).
CORNERS = np.array([(x, y, 5 + x * y + 0.3 * x) for x in (-1, 0.2, 1) for y in (-1, 0.4, 1)])


def solve_pnp(axis, angle):
    cv2 = import_module("cv2")
    rows, place = axes_of_a_camera(axis, angle), np.array([0.3, -0.2, 0.1])
    # Image coordinates by geometry alone: a point to the right of the line of sight is seen on the
    # right.
    seen = CORNERS[:, :2] / CORNERS[:, 2:]
    _, vector, _ = cv2.solvePnP(CORNERS @ rows + place, seen, np.eye(3), None)
    yield "cv2.solvePnP(points, seen, K, None)[1]", VECTOR, vector
    yield (
        "cv2.Rodrigues(cv2.solvePnP(points, seen, K, None)[1])[0]",
        MATRIX,
        cv2.Rodrigues(vector)[0],
    )


def colmap(axis, angle):
    pycolmap = import_module("pycolmap")
    rows, place = axes_of_a_camera(axis, angle), np.array([0.3, -0.2, 0.1])
    pose = pycolmap.Rigid3d(pycolmap.Rotation3d(rows), -rows @ place)
    camera = pycolmap.Camera(
        model="SIMPLE_PINHOLE", width=2, height=2, params=[1, 0, 0], camera_id=1
    )
    seen = camera.img_from_cam(pose * (CORNERS @ rows + place))
    assert np.allclose(seen, CORNERS[:, :2] / CORNERS[:, 2:]), (
        "a different camera from the one expected"
    )
    scene = pycolmap.Reconstruction()
    scene.add_camera_with_trivial_rig(camera)
    scene.add_image_with_trivial_frame(pycolmap.Image(name="a.png", camera_id=1, image_id=1), pose)
    with tempfile.TemporaryDirectory() as folder:
        scene.write_text(folder)
        lines = Path(folder, "images.txt").read_text("utf8").splitlines()
    yield "images.txt", WXYZ, next(line for line in lines if line.endswith("a.png")).split()[1:5]
    yield (
        "image.cam_from_world().rotation.matrix()",
        MATRIX,
        scene.images[1].cam_from_world().rotation.matrix(),
    )


def opengl(axis, angle):
    glm = import_module("pyglm.glm")
    right, up, back = axes_of_a_camera(axis, angle)
    view = glm.lookAt(glm.vec3(0), glm.vec3(*-back), glm.vec3(*up))
    yield "glm.lookAt(eye, center, up), row by row", MATRIX, np.array(glm.mat3(view).to_list()).T


def nerfstudio(axis, angle):
    torch = import_module("torch")
    cameras = import_module("nerfstudio.cameras.cameras")
    to_world = np.c_[axes_of_a_camera(axis, angle).T, np.zeros(3)]
    camera = cameras.Cameras(torch.tensor(to_world)[None], 1.0, 1.0, 1.0, 1.0, 2, 2)
    # Rays through the pixels to the right of, below and at the middle determine right, up and back.
    right, up, middle = (
        camera.generate_rays(0, coords=torch.tensor(place)).directions.numpy()
        for place in ([1.0, 2.0], [0.0, 1.0], [1.0, 1.0])
    )
    rows = [
        np.cross(middle, np.cross(right, middle)),
        np.cross(middle, np.cross(up, middle)),
        -middle,
    ]
    rows = np.array([row / np.linalg.norm(row) for row in rows])
    yield "camera_to_worlds, by the rays of Cameras.generate_rays", MATRIX, rows.T


def kornia(axis, angle):
    torch, conversions = import_module("torch"), import_module("kornia.geometry.conversions")
    vector = torch.tensor(angle * axis)[None]
    yield (
        "axis_angle_to_rotation_matrix(v)",
        MATRIX,
        conversions.axis_angle_to_rotation_matrix(vector)[0].numpy(),
    )
    turned = conversions.axis_angle_to_quaternion(vector)
    yield "axis_angle_to_quaternion(v)", WXYZ, turned[0].numpy()
    yield (
        "euler_from_quaternion(w, x, y, z)",
        XYZ,
        [
            float(angle_in_radians)
            for angle_in_radians in conversions.euler_from_quaternion(*turned[0])
        ],
    )


def blender(axis, angle):
    # This is Blender itself, which includes mathutils.
    import_module("bpy")
    turned = import_module("mathutils").Quaternion(axis.tolist(), float(angle))
    yield "Quaternion(axis, angle)", WXYZ, turned
    yield "Quaternion(axis, angle).to_matrix()", MATRIX, turned.to_matrix()
    yield "Quaternion(axis, angle).to_euler('XYZ')", XYZ, turned.to_euler("XYZ")


def drake(axis, angle):
    module, shapes = import_module("pydrake.math"), import_module("pydrake.common.eigen_geometry")
    turned = module.RotationMatrix(shapes.AngleAxis(angle, axis))
    yield "RotationMatrix(AngleAxis(angle, axis)).matrix()", MATRIX, turned.matrix()
    yield (
        "RotationMatrix(AngleAxis(angle, axis)).ToQuaternion().wxyz()",
        WXYZ,
        turned.ToQuaternion().wxyz(),
    )
    yield "RollPitchYaw(R).vector()", XYZ, module.RollPitchYaw(turned).vector()


def pybullet(axis, angle):
    module = import_module("pybullet")
    turned = module.getQuaternionFromAxisAngle(axis.tolist(), angle)
    yield "getQuaternionFromAxisAngle(axis, angle)", XYZW, turned
    yield "getMatrixFromQuaternion(q)", MATRIX, module.getMatrixFromQuaternion(turned)
    yield "getEulerFromQuaternion(q)", XYZ, module.getEulerFromQuaternion(turned)


def robot_with(origin):
    text = (
        "<robot name='r'><link name='a'/><link name='b'/><joint name='j' type='fixed'><parent "
        "link='a'/>"
        f"<child link='b'/>{origin}</joint></robot>"
    )
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "r.urdf").write_text(text)
        return import_module("yourdfpy").URDF.load(str(Path(folder, "r.urdf")))


def urdf(axis, angle):
    """Read an element whose three angles are made from the matrix.

    The file's reader makes its own matrix from them.
    """
    x, y, z = axes_of_a_camera(axis, angle).T
    angles_of_file = (np.arctan2(z[1], z[2]), np.arcsin(-z[0]), np.arctan2(y[0], x[0]))
    robot = robot_with(f'<origin rpy="{" ".join(map(repr, map(float, angles_of_file)))}"/>')
    yield '<origin rpy="..."/>', XYZ, angles_of_file
    yield "robot.get_transform('b', 'a')", MATRIX, robot.get_transform("b", "a")[:3, :3]


def isaac_mathematics():
    """Return the package's mathematics module, without starting its simulator."""
    if "isaaclab_math" not in sys.modules:
        path = next(Path(get_paths()["purelib"]).glob("**/isaaclab/utils/math.py"))
        specification = spec_from_file_location("isaaclab_math", path)
        module = sys.modules["isaaclab_math"] = module_from_spec(specification)
        specification.loader.exec_module(module)
    return sys.modules["isaaclab_math"]


def isaac_lab(axis, angle):
    torch, module = import_module("torch"), isaac_mathematics()
    turned = module.quat_from_angle_axis(torch.tensor([angle]), torch.tensor(axis)[None])
    yield "quat_from_angle_axis(angle, axis)", WXYZ, turned[0].numpy()
    yield "matrix_from_quat(q)", MATRIX, module.matrix_from_quat(turned)[0].numpy()
    yield (
        "euler_xyz_from_quat(q)",
        XYZ,
        [float(angle_in_radians) for angle_in_radians in module.euler_xyz_from_quat(turned)],
    )


class Factor(np.ndarray):
    """A matrix whose ``*`` is the matrix product, as in Eigen."""

    def __new__(cls, entries):
        return np.asarray(entries).view(cls)

    def __mul__(self, other):
        return Factor(np.asarray(self) @ np.asarray(other))


#: What a program's lines on the card need in Python: each name and where it is, or, without a name,
#: a module all of whose names they need.
NAMES = {
    "OpenCV": (("cv2", "cv2"),),
    "OpenCV solvePnP": (("cv2", "cv2"),),
    "SciPy": (("Rotation", "scipy.spatial.transform:Rotation"),),
    "pytransform3d": (("pr", "pytransform3d.rotations"),),
    "transforms3d": (("", "transforms3d.euler"), ("", "transforms3d.quaternions")),
    "COLMAP": (("pycolmap", "pycolmap"),),
    "OpenGL view": (("glm", "pyglm.glm"),),
    "nerfstudio": (("torch", "torch"),),
    "kornia": (("torch", "torch"), ("", "kornia.geometry.conversions")),
    "Isaac Lab 2": (("torch", "torch"),),
    "Blender": (("bpy", "bpy"), ("", "mathutils")),
    "Drake": (("", "pydrake.math"), ("", "pydrake.common.eigen_geometry")),
    "PyBullet": (("", "pybullet"),),
}


def names_of(program):
    """Return the names that a program's lines on the card need in Python."""
    names = {"np": np}
    for name, place in NAMES.get(program, ()):
        imported = resolve_name(place)
        names |= {name: imported} if name else vars(imported)
    if program == "Isaac Lab 2":
        names |= vars(isaac_mathematics())
    if program == "Eigen (C++)":
        module, units = import_module("eigenpy"), np.eye(3)
        names["Vector3d"] = type(
            "", (), {f"Unit{name}": lambda k=k: units[k] for k, name in enumerate("XYZ")}
        )
        names["AngleAxisd"] = lambda angle, axis: Factor(
            module.AngleAxis(angle, axis).toRotationMatrix()
        )
        names["Quaterniond"] = lambda *parts: module.Quaternion(*parts).toRotationMatrix()
    return names


def matrix_by(program, line, names):
    """Return the matrix that the program makes from a line of the card, row by row."""
    if program == "MuJoCo model":
        module = import_module("mujoco")
        compiler, body = re.fullmatch(r"(<compiler [^>]*>)? ?(<body [^>]*)/>", line).groups()
        world = f"<worldbody>{body}><geom size='0.1'/></body></worldbody>"
        data = module.MjData(
            model := module.MjModel.from_xml_string(f"<mujoco>{compiler or ''}{world}</mujoco>")
        )
        module.mj_forward(model, data)
        return data.xmat[1]
    if program == "URDF":
        return robot_with(line).get_transform("b", "a")[:3, :3]
    # This is the form in images.txt.
    if program == "COLMAP" and "(" not in line:
        w, x, y, z = map(float, line.split())
        return names["pycolmap"].Rotation3d(np.array([x, y, z, w])).matrix()
    if program == "nerfstudio":
        line = line.partition(" = ")[2]
    made = eval(line.removeprefix("rvec = ").replace("::", "."), names)
    if program == "OpenCV solvePnP" and made.shape == (3,):
        made = names["cv2"].Rodrigues(made)[0]
    if program == "OpenGL view":
        return np.array(made.to_list()).T
    if program == "kornia" and isinstance(made, tuple):
        made = names["quaternion_to_rotation_matrix"](names["torch"].stack(made)[None])
    if program == "Isaac Lab 2" and made.shape[-1] == 4:
        made = names["matrix_from_quat"](made[None] if made.ndim == 1 else made)
    if program == "PyBullet" and len(made) == 4:
        made = names["getMatrixFromQuaternion"](made)
    for name in ("as_matrix", "to_matrix", "ToRotationMatrix", "matrix", "numpy"):
        made = (
            getattr(made, name)()
            if callable(getattr(made, name, None)) and not isinstance(made, np.ndarray)
            else made
        )
    return made


# The package of each program on PyPI, by its name in the table of programs, its further
# requirements, and the function that asks it.
PROGRAMS = {
    "SciPy": ("scipy", (), scipy),
    "pytransform3d": ("pytransform3d", (), pytransform3d),
    "transforms3d": ("transforms3d", (), transforms3d),
    "Eigen (C++)": ("eigenpy", (), eigen),
    "MuJoCo model": ("mujoco", (), mujoco),
    "OpenCV": ("opencv-python-headless", (), opencv),
    "OpenCV solvePnP": ("opencv-python-headless", (), solve_pnp),
    "COLMAP": ("pycolmap", (), colmap),
    "OpenGL view": ("PyGLM", (), opengl),
    "nerfstudio": (
        "nerfstudio",
        ("torch", "jaxtyping", "rich", "typeguard", "tyro", "viser"),
        nerfstudio,
    ),
    "kornia": ("kornia", (), kornia),
    "Blender": ("bpy", (), blender),
    "Drake": ("drake", (), drake),
    "PyBullet": ("pybullet", (), pybullet),
    "URDF": ("yourdfpy", (), urdf),
    "Isaac Lab 2": ("isaaclab", ("torch",), isaac_lab),
}


def main():
    program, questions = sys.argv[1], json.load(sys.stdin)
    (package, _, ask), asked, names = PROGRAMS[program], {}, names_of(program)
    made = [
        np.array(matrix_by(program, line, names), float).ravel().tolist()
        for line in questions["lines"]
    ]
    for axis, angle in questions["orientations"]:
        for line, form, numbers in ask(np.array(axis, float), float(angle)):
            entry = asked.setdefault(line, {"asked": line, "form": form, "numbers": []})
            entry["numbers"].append(
                [float(number) for number in np.ravel(np.array(numbers, float))]
            )
    print(
        json.dumps(
            {
                "package": package,
                "version": version(package),
                "answers": list(asked.values()),
                "made": made,
            }
        )
    )


if __name__ == "__main__":
    main()
