"""How programs print numbers: patterns that both Python and JavaScript understand.

Every pattern ignores case, ``^`` and ``$`` match at each line, and letters and digits are those of
ASCII. In a replacement ``$1`` is the first group.
"""

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?"
#: What the names yaw, pitch and roll mean: rotations about z, y and x.
YAW_PITCH_ROLL = {"sequence": "zyx", "axes of the turns": "body fixed", "places": "123"}

_MINUTES = (
    "degrees, minutes and seconds. Write each angle as one number: 12\u00b030'15\" is 12.504167 "
    "degrees, which is 12 + 30/60 + 15/3600"
)

#: Each pattern by name, or a list of pairs of a pattern and its meaning or replacement.
SPELLING = {
    # A number that is not part of a name, perhaps followed by a unit or the suffix of a type.
    "number": rf"(?<![\w.]){NUMBER}(?=(?:[fld]|deg(?:rees)?|rad(?:ians)?)?(?![\w.]))",
    # A name and the number that follows it.
    "named": r"""["']?([a-z_][\w.]*)["')\]]*\s*[:=]?\s*[\[(]?\s*(?=[-+.]?[.\d])""",
    "comment": r"(#|//|%).*",
    # Positions, velocities and covariances, whose value follows their name or is indented below it.
    "not turns": (
        r"""["']?\b\w*(?:position|translation|header|stamp|location|covariance|velocity|acceleration|scale|twist|linear"""
        r"""|angular|tvec)\w*["']?\s*[:=]\s*"""
    ),
    "value": r"""(?:\{[^}]*\}|\[[^\]]*\]|[\w.]*\([^)]*\)|"[^"\n]*")""",
    "degrees": r"\u00b0|\bdeg(?:rees)?\b|\d(?:deg)",
    "radians": r"\brad(?:ians?)?\b",
    # Names of the three angles that appear apart from their numbers, and the order they imply.
    "orders of angles": (
        (r"\brpy\b|\broll\W{1,3}pitch\W{1,3}yaw\b", YAW_PITCH_ROLL | {"places": "321"}),
        (r"\bypr\b|\byaw\W{1,3}pitch\W{1,3}roll\b", YAW_PITCH_ROLL),
    ),
    # The same for the four components of a quaternion.
    "orders of parts": (
        (r"\bq?_?w\W{1,3}q?_?x\W{1,3}q?_?y\W{1,3}q?_?z\b|\bwxyz\b", {"order": "wxyz"}),
        (r"\bq?_?x\W{1,3}q?_?y\W{1,3}q?_?z\W{1,3}q?_?w\b|\bxyzw\b", {"order": "xyzw"}),
    ),
    # A line that names the columns of a table: what separates the names, the characters around one,
    # the names that belong to a quaternion rather than a position, and the entries of a matrix.
    "parting": r"\s*[,;|\t]\s*",
    "around a field": r"^[\s\[\](){}<>\"'#/%|]+|[\s\[\](){}<>\"'\u00b0]+$",
    "unit of a column": r"[_ ]?[\[(][^\])]*[\])]?$|[_ ](?:deg(?:rees)?|rad(?:ians)?)$",
    "of a quaternion": r"q|rot|ori|att",
    # The names of a quaternion's components in a table that also has a position's.
    "part of a quaternion": r"(?:^|[_.])q_?[wxyz]$",
    "entry of a matrix": r"^[a-z]*_?(\d)_?(\d)$",
    "no row": r"^[\s|:=+-]*$|^\s*(?:#|//|%)",
    # The innermost pair of nested brackets.
    "innermost": r"[\[({]([^\[\](){}]*)[\])}]",
    "not a number": r"(?<![a-z])[-+]?(nan|inf(?:inity)?)(?![a-z])",
    # Expressions that must be evaluated first. A date such as 12/05/2026 is not a fraction.
    "arithmetic": r"\b(?:m_|np\.|math\.)?pi\b|\bsqrt\s*\(|\u221a|\u03c0"
    r"|(?<![\w/.])\d*\.?\d+\s*/\s*\d*\.?\d+(?![\w/])",
    # A quaternion as a sum of its components.
    "sum": r"\d\s*[*.]?\s*i\b[^a-z]*\d\s*[*.]?\s*j\b[^a-z]*\d\s*[*.]?\s*k\b",
    "signs of a sum": ((r"\+\s*-\s*(?=[.\d])", "-"), (r"([-+])\s+(?=[.\d])", "$1")),
    "part of a sum": rf"({NUMBER})\s*[*.]?\s*([ijk])\b",
    "scalar of a sum": rf"(?<![\w.=+-])({NUMBER})(?![\w.])",
    # Whole files whose numbers mean nothing without the rest: tell the reader what to cut out.
    "cut out": (
        (
            r"(?:^|[\s;,|])#(?:[a-z/0]+[!?]|n/a|nv)",
            "a table in which a cell holds an error, such as #N/A or #VALUE!. Leave out that row "
            "on both sides",
        ),
        (
            r"^\s*HIERARCHY\b[\s\S]*^\s*MOTION\b",
            "a whole BVH file. From a line below MOTION, paste only the three angles of one joint, "
            "and give their sequence, from the joint's CHANNELS line",
        ),
        (
            r"\d\s*(?:[\u00b0\u00ba\u02da]|d(?:eg(?:rees)?)?\b)\s*[0-5]?\d(?:[.,]\d+)?\s*"
            r"(?:['\u2032\u2019]|min)"
            r"|\dd[0-5]?\dm"
            r"|(?:\b\d{1,3}:[0-5]?\d:[0-5]?\d(?:\.\d+)?[\s,;]+){2}",
            f"in {_MINUTES}",
        ),
        # The same without the signs: numbers that are too large for a matrix.
        (
            r"^(?=.*\b(?:[2-9]|\d\d+)\b)"
            r"(?:[ \t]*-?\d{1,3}[ \t]+[0-5]?\d[ \t]+[0-5]?\d(?:\.\d+)?\b[,;]?){3}[ \t]*$",
            f"not a matrix; it looks like three angles in {_MINUTES}",
        ),
    ),
    # Patterns and replacements, applied in this order; the first four also before reading tables.
    "cleaning": (
        ("[\u00a0\u2000-\u200b\u202f\u3000]", " "),
        # A document may put a space between a sign and its number.
        ("\u2212[ \t]*|[\u2013\ufe63\uff0d]", "-"),
        # Column headings of PX4, where the scalar part is the first of four.
        (r"^(timestamp,.*?\b)q\[0\],q\[1\],q\[2\],q\[3\]", "$1q_w,q_x,q_y,q_z"),
        (r"(?<=[a-z])\[(\d)\](?=,|$)", "_$1"),
        # A line of COLMAP's images.txt, and the image points below it.
        (
            rf"^\d+((?:[ \t]+{NUMBER}){{4}})(?:[ \t]+{NUMBER}){{3}}[ \t]+\d+[ \t]+\S+\.[a-z]\S*$"
            r"(?:\n[-+.\d \t]*$)?",
            "(w, x, y, z) $1",
        ),
        # A frame of transforms.json has a number called rotation before its matrix.
        (rf'"rotation"\s*:\s*{NUMBER}\s*,(?=\s*")', " "),
        # The poses of KUKA's robots, in braces, and of Fanuc's, with units: a position in
        # millimetres, then three angles. With less than that, A turns about x on machine tools, and
        # W is the scalar part of a quaternion.
        (
            r"(?<=\{)\s*(?:\w+\s*:)?\s*X~,\s*Y~,\s*Z~,\s*A(~),\s*B(~),\s*C(~)(?=[,}])".replace(
                "~", rf"\s*{NUMBER}\s*"
            ),
            " yaw $1 pitch $2 roll $3 degrees ",
        ),
        (
            r"\bX~(?:mm)?!Y~(?:mm)?!Z~(?:mm)?!W(~)deg!P(~)deg!R(~)deg\b".replace(
                "~", rf"[\s=:]*{NUMBER}\s*"
            ).replace("!", r"[\s,]*"),
            " roll $1 pitch $2 yaw $3 degrees ",
        ),
        (r"(\d)d([-+]\d)", "$1e$2"),
        # The report of ROS's tf2_echo gives each orientation several times.
        (r"(in quaternion[^\[]*\[[^\]]*\])[\s\S]*?(?=at time|(?![\s\S]))", "$1\n"),
        (r"^.*\bat time.*$", " "),
        # The position in a URDF element is not part of the rotation.
        (r'\bxyz\s*=\s*"[^"]*"(?=[^>]*\b(?:rpy|quat|wxyz)\b)', " "),
        (r'(\b(?:rpy|quat|wxyz)\s*=\s*"[^"]*"[^>]*)\bxyz\s*=\s*"[^"]*"', "$1"),
        # Strings in quotation marks, such as names of files and devices, and the index of an entry
        # before its value.
        (r'(?<![\w"])"(?=[^"\n]*[a-z_/])(?![^"\n]*\d\.\d)[^"\n]*"(?!\s*[:=])', " "),
        (r"(?<![\w'])'[\w:/.,-]*[a-z][\w:/.,-]*'(?!\s*[:=])", " "),
        (r"\b(?:size|shape|dims?)\b\W{0,3}[\[(][\d\s,]*[\])]", " "),
        (r"(?<![.\d])\d+ ?[x\u00d7] ?\d+\b(?!\.)", " "),
        (r"\bwith indices.*$", " "),
        # The number of a row, before the row.
        (r"^\s*(?:row\s*)?\d{1,3}\s*[:)]\s+(?=[-+.\d\[(])", " "),
        # The numbers that R prints beside rows, above columns and before a vector.
        (r"\[(?:\d+,|,\d+)\]|^\s*\[\d+\](?=\s+[-.\d])", " "),
        # The length before a list, the factor of MATLAB's console, and Godot's columns with their
        # origin.
        (r"\barray\s*\(\d+\)|\(\d+\)\s*(?=\[)", " "),
        (r"^\s*1\.0e\+?0+\s*\*\s*$", " "),
        (r"\bo\s*:\s*\([^)]*\)", " "),
        (r"\b[xyz]\s*:\s*(?=\([^)]*,)", " "),
        # The first three numbers of an SDF pose are a position.
        (rf"(<pose[^>]*>)\s*(?:{NUMBER}\s+){{3}}(?=(?:{NUMBER}\s+){{2}}{NUMBER}\s*<)", "$1 rpy "),
        # The index before an equals sign, as in R[2] or in MATLAB's R(:,:,2). Other numbers in
        # brackets before an equals sign or a colon are a pose.
        (
            r"\b([a-z_]\w*)(?:\s*[\[(]\s*(?:\d*\s*(?:,\s*\d+\s*)?|:\s*,\s*:\s*(?:,\s*\d+\s*)+)[\])])+"
            r"\s*(?==(?!=)|:)",
            "$1 ",
        ),
        (
            r"""["']?\b(?:det(?:erminant|\(\w+\))?|norm|trace|seq|secs?|nsecs?|nanosecs?|id|index|rows"""
            r"""|cols|width|height|step|fps|mesh|camera|node|time|timestamp"""
            r"""|fl_[xy]|camera_angle_[xy]|\w*error)["']?\s*[:=]\s*[-+]?\d[\d.]*(?:e[-+]?\d+)?(?![\w.])""",
            " ",
        ),
        # Elsewhere than at the beginning of a line, where it is the dash of a list, a hyphen before
        # a space is a sign.
        (r"(\d\.?[ \t]+|[\[(,;|&][ \t]*)-[ \t]+(?=[.\d])", "$1-"),
        # Timestamps, and the dashes of a list.
        (r"(?<![\w.])\d{8,}(?:\.\d+)?(?![\w.])", " "),
        (r"^(\s*)-\s+(?=[-+.]?\d)", "$1"),
    ),
    "yaw pitch roll": YAW_PITCH_ROLL,
    "whole number": rf"^{NUMBER}$",
}
