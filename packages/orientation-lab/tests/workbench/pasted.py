"""What people pasted into public threads: their own numbers, with what they said of them."""


def pasted(where, first, second, verdict, *words, known=({}, {})):
    return {
        "thread": where,
        "first": first,
        "second": second,
        "verdict": verdict,
        "words": words,
        "known": known,
    }


SQUAD = """# Result:
# x=0.0038165694568306208
# y=0.00735193956643343
# z=0.8875043392181396
# w=0.46072492003440857"""

TF = """transforms:
  -
    header:
      seq: 0
      stamp:
        secs: 1574817405
        nsecs: 846164606
      frame_id: "/world"
    child_frame_id: "vicon/cf1/cf1"
    transform:
      translation:
        x: 0.0220311362154
        y: 0.018269594248
        z: 0.015730223606
      rotation:
        x: 0.0172112712763
        y: 0.0116523005586
        z: 0.0338153541435
        w: 0.999211948416
---"""

GLTF = """{
"nodes" : [
        { "mesh" : 0, "name" : "Cube" },
        {
            "name" : "Light",
            "rotation" : [
                0.16907575726509094,
                0.7558803558349609,
                -0.27217137813568115,
                0.570947527885437
            ],
            "translation" : [ 4.076245307922363, 5.903861999511719, -1.0054539442062378 ]
        },
        {
            "name" : "Camera",
            "rotation" : [
                0.483536034822464,
                0.33687159419059753,
                -0.20870360732078552,
                0.7804827094078064
            ],
            "translation" : [ 7.358891487121582, 4.958309173583984, 6.925790786743164 ]
        }
    ]
}"""

BLENDER = """<Quaternion (w=0.5709, x=0.1691, y=0.2722, z=0.7559)>
<Quaternion (w=0.7805, x=0.4835, y=0.2087, z=0.3369)>"""

RBDL = """Rotation matrix:
  -0.972871 -0.0705752  -0.220319
   0.21634  0.0598777   -0.97448
 0.0819664  -0.995708 -0.0429851"""

EIGEN = "Eigen quaternion:\n 0.0505867i + 0.72037j + -0.683741k + -0.104906"

OWN = "RBDL quaternion:\n 0.0505867\n  0.72037\n-0.683741\n 0.104906"

KORNIA = """R_mat = tensor([[[ 0.9965,  0.0377, -0.0749],
              [-0.0399,  0.9988, -0.0278],
              [ 0.0738,  0.0307,  0.9968]]])"""

EXTRINSIC = """[[ 0.66446302 -0.49145005  0.5629971 ]
 [ 0.66446302  0.73329482 -0.14410968]
 [-0.34202014  0.46984631  0.81379768]]"""

BEFORE = """BEFORE tensor([[[ 0.8888,  0.1516, -0.4325],
         [-0.4552,  0.1834, -0.8713],
         [ 0.0528, -0.9713, -0.2321]]], device='cuda:0')"""

AFTER = """AFTER tensor([[[ 0.8888,  0.0357, -0.4569],
         [-0.4552,  0.1834, -0.8713],
         [ 0.0528,  0.9824,  0.1793]]], device='cuda:0',)"""

PASTED = [
    pasted(
        "moble/quaternion 118",
        "x=0.46072492003440857\ny=0.0038165694568306208\nz=0.00735193956643343\n"
        "w=0.8875043392181396",
        SQUAD,
        "named",
        "scalar part comes last",
    ),
    pasted(
        "moble/quaternion 118 (comment)",
        "[quaternion(0.460724920034409, 0.00381656945683062, 0.00735193956643343, "
        "0.88750433921814)]",
        SQUAD,
        "same",
    ),
    pasted("rbdl/rbdl 107 Eigen", RBDL, EIGEN, "named", "columns of the matrix"),
    pasted("rbdl/rbdl 107 RBDL", RBDL, OWN, "named", "scalar part comes last"),
    pasted("rbdl/rbdl 107 both", EIGEN, OWN, "named", "scalar part comes last", "the conjugate"),
    pasted(
        "moveit/moveit_calibration 132 sxyz",
        "q=[-0.0372638, -0.0326999, 0.773564, 0.631776]",
        "(-0.09784475354668137, 0.016334569880032665, 1.7711006453446172)",
        "undecided",
        "scalar part comes last",
    ),
    pasted(
        "moveit/moveit_calibration 132 rxyz",
        "(-0.09784475354668137, 0.016334569880032665, 1.7711006453446172)",
        "(0.0035234877615449344, -0.09913217272764203, 1.7720752160631836)",
        "named",
        "space fixed",
        known=(
            {"kind": "Euler angles", "sequence": "xyz"},
            {"kind": "Euler angles", "sequence": "xyz"},
        ),
    ),
    pasted(
        "KieranWynn/pyquaternion 21",
        "[ -0.4285714,  0.2857143,  0.8571429;\n   0.8571429,  0.4285714,  0.2857143;\n"
        "  -0.2857143,  0.8571429, -0.4285714 ]",
        "w[ 0.3780]\nx [ 0.3780]\ny [ 0.7559]\nz [ 0.3780]",
        "undecided",
        "columns of the matrix",
    ),
    pasted(
        "nv-tlabs/ASE 73",
        "[[-0.87, -0.50, 0.00], [0.00, 0.00, 1.00], [-0.50, 0.87, 0.00]]",
        "[0.18, 0.68, 0.68, -0.18]",
        "undecided",
    ),
    pasted(
        "scipy/scipy 17097",
        "[0.41193454 0.19208823 0.41193454 0.78976071]",
        "[ 0.41193454  0.19208823  0.41193454 -0.78976071]",
        "undecided",
        "the conjugate",
    ),
    pasted(
        "kornia/kornia 950",
        "R_quat == tensor([[ 0.0146, -0.0372, -0.0194,  0.9990]])",
        "ans =\n    0.9990    0.0146   -0.0372   -0.0194",
        "named",
        "scalar part comes last",
    ),
    pasted(
        "kornia/kornia 950 matrix",
        KORNIA,
        "ans =\n    0.9990    0.0146   -0.0372   -0.0194",
        "named",
        "columns of the matrix",
    ),
    pasted("scipy/scipy 17464", EXTRINSIC, "[30, 20, 45] degrees", "undecided", "space fixed"),
    pasted("facebookresearch/pytorch3d 155", AFTER, BEFORE, "unrelated"),
    pasted(
        "whoenig/crazyflie_ros 160",
        TF,
        "0.999211948416 0.0172112712763 0.0116523005586 0.0338153541435",
        "same",
    ),
    pasted("KhronosGroup/glTF-Blender-IO 438", GLTF, BLENDER, "named", "y up"),
    pasted(
        "rawify/Quaternion.js 12",
        "var w = 0.87851f;\nvar x = -0.24479f;\nvar y = -0.18215f;\nvar z = 0.36758f;",
        "x (roll): -34.724241397722885, y (pitch): -8.052555186105621, z (yaw): 47.93138878621218",
        "same",
    ),
    pasted(
        "rawify/Quaternion.js 12 Unity",
        "var w = 0.87851f;\nvar x = -0.24479f;\nvar y = -0.18215f;\nvar z = 0.36758f;",
        "(x: 342.77, y: 328.43, z: 50.31)",
        "named",
        "order",
    ),
    pasted(
        "sofa-framework/sofa 1209",
        "> -0.173648 0.984808 -1.16901e-07 -6.62978e-07",
        "[ 0.1736482, 0.9848078, 0, 0 ]",
        "undecided",
    ),
    pasted(
        "Mayitzin/ahrs 106",
        "Quaternion([ 0.5  0.5 -0.5 -0.5])",
        "[[ 0.  0. -1.] [-1.  0.  0.] [ 0.  1.  0.]]",
        "undecided",
    ),
    pasted(
        "SETI/rms-cspyce 130",
        "expected = np.array(\n    [\n        [6.12323400e-17, 0.00000000e00, -1.00000000e00],\n"
        "        [0.00000000e00, 1.00000000e00, -0.00000000e00],\n"
        "        [1.00000000e00, 0.00000000e00, 6.12323400e-17],\n"
        "    ]\n)",
        "[[ 6.123234e-17  0.000000e+00  1.000000e+00]\n"
        " [ 0.000000e+00  1.000000e+00  0.000000e+00]\n"
        " [-1.000000e+00 -0.000000e+00  6.123234e-17]]",
        "undecided",
        "the transpose",
    ),
    pasted(
        "g-truc/glm 448",
        "{x=0.707106769 y=-0.000000000 z=0.000000000 w=0.707106769}",
        "{x=-0.707106769 y=-0.000000000 z=0.000000000 w=0.707106769}",
        "undecided",
        "the conjugate",
    ),
    pasted(
        "j96w/DenseFusion 78",
        "quaternion_matrix([0.99810947, 0.06146124, 0, 0])",
        "[[ 1.          0.          0.          0.        ]\n"
        " [ 0.          0.99244503 -0.12269009  0.        ]\n"
        " [ 0.          0.12269009  0.99244503  0.        ]\n"
        " [ 0.          0.          0.          1.        ]]",
        "undecided",
        "columns of the matrix",
    ),
]
