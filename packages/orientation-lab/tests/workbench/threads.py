"""Public threads in which two programs disagreed about an orientation, and what it was.

Each thread has its address, what was wrong in our words, and the convention of each side as the
thread describes it; the numbers of the tests are made from these. Read in November 2026.
"""

FLIP, NED = "x -y -z", "y x -z"


def quaternion(order="wxyz"):
    return {"kind": "quaternion", "order": order}


def angles(sequence, axes="body fixed", unit="radians", places="123", signs="+++"):
    return {"kind": "Euler angles", "sequence": sequence, "axes of the turns": axes, "unit": unit,
            "places": places, "signs": signs}  # fmt: skip


MATRIX, VECTOR = {"kind": "matrix"}, {"kind": "rotation vector", "unit": "radians"}


def thread(where, number, what, first, second, *, inverse=False, body="x y z", world="x y z"):
    return {
        "thread": f"https://github.com/{where}/issues/{number}",
        "what": what,
        "first": first,
        "second": second,
        # fmt: skip
        "inverse": inverse,
        "body": tuple(body.split()),
        "world": tuple(world.split()),
    }


LAST_FOR_FIRST = "the scalar stands last in one and first in the other"
OTHER_WAY = "camera from world in one, world from camera in the other"
SPACE_FOR_BODY = "turns about fixed axes were taken for turns about the body's own"
OTHER_HAND = "a right-handed triad in one, a left-handed one in the other"

THREADS = [
    thread("isaac-sim/IsaacLab", 4437, LAST_FOR_FIRST, quaternion(), quaternion("xyzw")),
    thread("isaac-sim/IsaacLab", 5754, LAST_FOR_FIRST, quaternion("xyzw"), quaternion()),
    thread("iory/scikit-robot", 800, LAST_FOR_FIRST, quaternion(), quaternion("xyzw")),
    thread("NVIDIA/IsaacTeleop", 699, "put in order twice", quaternion(), quaternion("yzwx")),
    thread(
        "bulletphysics/bullet3",
        4184,
        "the manual says x, y, w, z",
        quaternion("xyzw"),
        quaternion("xywz"),
    ),
    thread("facebookresearch/fairmotion", 90, LAST_FOR_FIRST, quaternion("xyzw"), quaternion()),
    thread(
        "gyrovorbis/sh4zam", 6, "the terms came in another order", quaternion(), quaternion("xyzw")
    ),
    thread("Zuzu-Typ/PyGLM", 77, LAST_FOR_FIRST, quaternion("xyzw"), quaternion()),
    thread(
        "AnalyticalGraphicsInc/czml-writer", 86, LAST_FOR_FIRST, quaternion("xyzw"), quaternion()
    ),
    thread("facebookresearch/QuaterNet", 6, LAST_FOR_FIRST, quaternion(), quaternion("xyzw")),
    thread("raysect/source", 280, LAST_FOR_FIRST, quaternion(), quaternion("xyzw")),
    thread("isri-aist/RoboManipBaselines", 11, LAST_FOR_FIRST, quaternion("xyzw"), quaternion()),
    thread(
        "JOML-CI/JOML",
        48,
        "each part was given to its neighbour",
        quaternion("xyzw"),
        quaternion("wxyz"),
    ),
    thread(
        "dimforge/nalgebra",
        327,
        "the conjugate",
        quaternion("xyzw"),
        quaternion("xyzw"),
        inverse=True,
    ),
    thread("facebookresearch/VideoPose3D", 59, OTHER_WAY, quaternion(), quaternion(), inverse=True),
    thread("mnslarcher/camera-models", 1, OTHER_WAY, MATRIX, MATRIX, inverse=True),
    thread("ashawkey/torch-ngp", 58, "transposed once too often", MATRIX, MATRIX, inverse=True),
    thread("borglab/gtsfm", 119, OTHER_WAY, MATRIX, MATRIX, inverse=True),
    thread("facebookresearch/habitat-lab", 887, OTHER_WAY, MATRIX, MATRIX, inverse=True),
    thread(
        "hysts/pytorch_mpiigaze",
        65,
        "row vectors in one, columns in the other",
        MATRIX,
        MATRIX,
        inverse=True,
    ),
    thread(
        "guaMass/3DGS_PoseRender",
        1,
        "transposed before it was inverted",
        MATRIX,
        MATRIX,
        inverse=True,
    ),
    thread(
        "gkjohnson/coordinate-frame-converter", 2, "rows for columns", MATRIX, MATRIX, inverse=True
    ),
    thread("opencv/opencv", 27625, "poses of the hand inverted", MATRIX, VECTOR, inverse=True),
    thread(
        "Hao-Yuan-He/HandEyeCalibration-using-OpenCV",
        1,
        "poses inverted",
        MATRIX,
        MATRIX,
        inverse=True,
    ),
    thread("zju3dv/EasyMocap", 55, OTHER_WAY, VECTOR, VECTOR, inverse=True),
    thread(
        "mavlink/mavros",
        216,
        "ENU and FLU against NED and FRD",
        MATRIX,
        MATRIX,
        body=FLIP,
        world=NED,
    ),
    thread("mavlink/mavros", 525, "only the body's side converted", MATRIX, MATRIX, body=FLIP),
    thread(
        "mavlink/mavros",
        751,
        "ROS's angles against those of aviation, in degrees",
        angles("xyz", "space fixed"),
        angles("zyx", unit="degrees"),
        body=FLIP,
        world=NED,
    ),
    thread(
        "mavlink/mavros",
        1586,
        "ENU and FLU against NED and FRD, scalar last",
        quaternion(),
        quaternion("xyzw"),
        body=FLIP,
        world=NED,
    ),
    thread(
        "DISCOWER/px4-mpc",
        33,
        "the world's side not converted",
        quaternion(),
        quaternion(),
        world=NED,
    ),
    thread(
        "PX4/px4_ros_com", 194, "from PX4 to ROS", quaternion(), quaternion(), body=FLIP, world=NED
    ),
    thread(
        "rosflight/rosflight_firmware",
        73,
        "NWU for NED on both sides",
        MATRIX,
        MATRIX,
        body=FLIP,
        world=FLIP,
    ),
    thread(
        "dawonn/vectornav",
        146,
        "right, forward, up for forward, left, up",
        quaternion("xyzw"),
        quaternion("xyzw"),
        body="y -x z",
    ),
    thread(
        "FroboLab/frobomind",
        15,
        "NED to ENU, the sensor's own frame alike",
        quaternion("xyzw"),
        quaternion("xyzw"),
        body=NED,
        world=NED,
    ),
    thread(
        "Unity-Technologies/ROS-TCP-Connector",
        163,
        "north for east: a quarter turn of the world",
        quaternion("xyzw"),
        quaternion("xyzw"),
        world="y -x z",
    ),
    thread(
        "fdcl-gwu/uav_simulator", 7, "north taken for Gazebo's east", MATRIX, MATRIX, world="y -x z"
    ),
    thread(
        "darylclimb/cvml_project",
        12,
        "a body's axes for a camera's",
        MATRIX,
        MATRIX,
        body="-y -z x",
    ),
    thread(
        "bmild/nerf",
        8,
        "OpenCV's pose for OpenGL's, the other way round",
        MATRIX,
        MATRIX,
        inverse=True,
        world=FLIP,
    ),
    thread(
        "nerfstudio-project/nerfstudio",
        1286,
        "so, and the world's axes exchanged",
        MATRIX,
        MATRIX,
        inverse=True,
        body="x z -y",
        world=FLIP,
    ),
    thread(
        "bmild/nerf", 125, "LLFF's down, right, back", MATRIX, MATRIX, inverse=True, world="-y x z"
    ),
    thread(
        "NVlabs/instant-ngp",
        72,
        "OpenCV against the program's own axes",
        MATRIX,
        MATRIX,
        inverse=True,
        body="y z x",
        world=FLIP,
    ),
    thread(
        "facebookresearch/pytorch3d",
        522,
        "rows for columns, x left and y up",
        MATRIX,
        MATRIX,
        inverse=True,
        world="-x -y z",
    ),
    thread(
        "kornia/kornia",
        3941,
        "layout of quaternions not said",
        quaternion(),
        quaternion("xyzw"),
        inverse=True,
    ),
    thread(
        "kornia/kornia",
        4315,
        "layout and hand not said",
        quaternion("xyzw"),
        quaternion(),
        body="x y -z",
        world="x y -z",
    ),
    thread("rerun-io/rerun", 7684, OTHER_HAND, MATRIX, MATRIX, body="x y -z", world="x y -z"),
    thread(
        "KhronosGroup/UnityGLTF",
        289,
        OTHER_HAND,
        quaternion("xyzw"),
        quaternion("xyzw"),
        body="-x y z",
        world="-x y z",
    ),
    thread(
        "Siccity/GLTFUtility",
        59,
        OTHER_HAND,
        quaternion("xyzw"),
        quaternion("xyzw"),
        body="x y -z",
        world="x y -z",
    ),
    thread(
        "WorldWideTelescope/wwt-windows-client",
        169,
        OTHER_HAND,
        MATRIX,
        MATRIX,
        body="x -y z",
        world="x -y z",
    ),
    thread("TheAliceProject/alice3", 48, OTHER_HAND, MATRIX, MATRIX, body="-x y z", world="-x y z"),
    thread(
        "BabylonJS/Exporters",
        91,
        OTHER_HAND,
        quaternion("xyzw"),
        quaternion("xyzw"),
        body="x y -z",
        world="x y -z",
    ),
    thread(
        "guillaumeblanc/ozz-animation",
        28,
        OTHER_HAND,
        MATRIX,
        MATRIX,
        body="x y -z",
        world="x y -z",
    ),
    thread("ufbx/ufbx", 202, "the other hand, by x", MATRIX, MATRIX, body="-x y z", world="-x y z"),
    thread("scipy/scipy", 10959, SPACE_FOR_BODY, angles("zyx"), angles("zyx", "space fixed")),
    thread("scipy/scipy", 11778, SPACE_FOR_BODY, MATRIX, angles("xyz", "space fixed")),
    thread("scipy/scipy", 15080, SPACE_FOR_BODY, MATRIX, angles("zxy", "space fixed", "degrees")),
    thread("scipy/scipy", 16275, SPACE_FOR_BODY, angles("zxz"), angles("zxz", "space fixed")),
    thread("scipy/scipy", 17464, SPACE_FOR_BODY, MATRIX, angles("xyz", "space fixed", "degrees")),
    thread(
        "scipy/scipy",
        12742,
        "the angles came in the other order",
        angles("zyx"),
        angles("zyx", places="321"),
    ),
    thread("recp/cglm", 36, SPACE_FOR_BODY, angles("xyz"), angles("xyz", "space fixed")),
    thread(
        "mathnet/mathnet-spatial", 180, SPACE_FOR_BODY, angles("zyx"), angles("zyx", "space fixed")
    ),
    thread(
        "chai3d/chai3d",
        8,
        "the flag for fixed axes was not heard",
        angles("xyz", unit="degrees"),
        angles("xyz", "space fixed", "degrees"),
    ),
    thread(
        "operasoftware/devopera",
        647,
        "z-x-y multiplied from behind",
        angles("zxy", unit="degrees"),
        angles("zxy", "space fixed", "degrees"),
    ),
    thread(
        "facebookresearch/fairmotion",
        59,
        "the order of BVH's channels, and fixed axes",
        angles("zyx", unit="degrees"),
        angles("xyz", "space fixed", "degrees", places="321"),
    ),
    thread(
        "assimp/assimp",
        2187,
        "the order of BVH's channels lost",
        angles("zxy", unit="degrees"),
        angles("zxy", unit="degrees", places="213"),
    ),
    thread(
        "RigidBodyDynamics/RigidBodyDynamics.jl", 429, "another sequence", MATRIX, angles("xyz")
    ),
    thread(
        "robotology/icub-models",
        231,
        "about fixed axes, printed in degrees",
        MATRIX,
        angles("xyz", "space fixed", "degrees"),
    ),
    thread(
        "dlaidig/vqf",
        1,
        "an instrument's axes and signs",
        quaternion(),
        quaternion(),
        body="y -x z",
    ),
    thread(
        "gyroflow/gyroflow",
        38,
        "an instrument's axes and signs",
        quaternion(),
        quaternion(),
        body="-y z -x",
    ),
]
