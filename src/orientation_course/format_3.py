"""The order that mistakes have in sealed files of format 3, as the second
edition made them. It is never changed.
"""

TURNS = (0, 1, 2, 3, 4, 5)
SEQUENCES = ("zxz", "xyx", "yzy", "zyz", "xzx", "yxy", "xyz", "yzx", "zxy", "xzy", "zyx", "yxz")
CATALOGUE = (
    ("transposed", {}),
    ("sign of one turn", {"turn": (None, *TURNS)}),
    ("sign of two turns", {"first": TURNS, "second": TURNS}),
    ("sign of every turn", {}),
    ("other order", {}),
    ("other order, transposed", {}),
    ("angles interchanged", {"first": TURNS, "second": TURNS}),
    ("another sequence", {"sequence": SEQUENCES}),
    ("another axis", {"turn": (None, *TURNS), "axis": tuple("xyz")}),
    ("turn missing", {"turn": (None, *TURNS)}),
    ("one factor only", {"turn": (None, *TURNS)}),
    ("sine for cosine", {"turn": (None, *TURNS)}),
    ("degrees taken for radians", {}),
    ("conjugate", {}),
    ("scalar last", {}),
    ("scalar last, conjugate", {}),
    ("whole angle", {}),
    ("quarter angle", {}),
    ("angles of another sequence", {"sequence": SEQUENCES}),
    ("angles of the transpose", {}),
    ("space fixed angles", {}),
    ("angles in reverse", {}),
    ("sign of one angle", {"turn": (None, *TURNS)}),
    ("sign of every angle", {}),
    ("axis reversed", {}),
    ("sequence reversed", {}),
    ("cosine for sine", {}),
    ("half", {}),
    ("double", {}),
)
FORMAT_3 = dict.fromkeys(
    ("direction cosine matrix", "quaternion", "Euler angles", "axis and angle", "sequence"),
    CATALOGUE,
)
