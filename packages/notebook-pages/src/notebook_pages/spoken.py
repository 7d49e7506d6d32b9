"""A formula in words, from its MathML, for the PDF and for programs without MathML.

The words are those of a person who reads the formula to a colleague. Superscripts on both sides of
a letter name frames and are not powers. A hat is spoken once, with its direction. A raised T after
an expression is its transpose. A cross between two numbers is "times", or "by" in a shape.
"""

import re
import unicodedata

from bs4 import NavigableString

# Characters that are read as something other than their Unicode name.
WORDS = {
    "=": "equals", "+": "plus", "−": "minus", "-": "minus", "±": "plus or minus",
    "∓": "minus or plus", "(": "open bracket", ")": "close bracket", "[": "open square bracket",
    "]": "close square bracket", "{": "open brace", "}": "close brace", ",": ",", ";": ";",
    ":": ":", "/": "over", "⋅": "dot", "→": "goes to", "≈": "is about", "≠": "is not equal to",
    "<": "is less than", ">": "is greater than", "≤": "is at most", "≥": "is at least",
    "∑": "the sum", "∫": "the integral", "⋯": "and so on", "…": "and so on", "?": "question mark",
    "⟺": "if and only if", "⟹": "implies", "∈": "in", "∥": "parallel", "⊥": "perpendicular",
    "∞": "infinity", ".": "", "!": "factorial", "%": "per cent", "ϵ": "epsilon", "ϕ": "phi",
    "∂": "partial", "∘": "degrees", "cos": "cosine", "sin": "sine", "tan": "tangent",
    "cot": "cotangent", "arccos": "arc cosine", "acos": "arc cosine", "arcsin": "arc sine",
    "arctan": "arc tangent", "exp": "exponential", "det": "determinant", "lim": "the limit",
    "log": "logarithm", "ln": "natural logarithm", "diag": "diagonal", "max": "maximum",
    "min": "minimum",
}  # fmt: skip
ACCENTS = {
    "^": "hat",
    "˙": "dot",
    "¨": "double dot",
    "~": "tilde",
    "ˉ": "bar",
    "¯": "bar",
    "→": "arrow",
}
POWERS = {
    "2": "squared",
    "3": "cubed",
    "T": "transpose",
    "∗": "conjugate",
    "*": "conjugate",
    "∘": "degrees",
}
POWERS |= {"−1": "inverse", "′": "prime", "′′": "double prime", "⊤": "transpose"}
# Operators with limits, and the word before the limit if there is only one.
LIMITED = {"∑": "over", "∫": "over", "lim": "as", "min": "over", "max": "over"}
BARS = "∣|∥‖"
SCRIPTS = ("msup", "msub", "msubsup")


def parts(node):
    """Return the elements of ``node``, with rows that only group their elements taken apart."""
    elements = []
    for child in node.children:
        if isinstance(child, NavigableString):
            continue
        alone = (
            child.name in ("mstyle", "semantics") or child.name == "mrow" and len(parts(child)) == 1
        )
        elements += parts(child) if alone else [child]
    return elements


def bare(node):
    """Return the characters of ``node`` without spaces."""
    # These characters are invisible.
    return re.sub("[\u2061-\u2064]", "", "".join(node.get_text().split()))


def is_simple(node):
    """Check whether a listener can tell where ``node`` ends.

    This is so for one letter or number, with its marks or sign, and for a few of them in a row.
    """
    if node.name in ("mrow", "mstyle", "math"):
        inside = parts(node)
        signed = len(inside) == 2 and bare(inside[0]) in ("−", "-", "+")
        plain = all(part.name in ("mi", "mn") for part in inside)
        return (
            signed
            and is_simple(inside[1])
            or plain
            and len(inside) < 4
            or len(inside) == 1
            and is_simple(inside[0])
        )
    if node.name in ("mover", "msub"):
        return all(is_simple(child) for child in parts(node))
    return node.name in ("mi", "mn", "mo", "mtext")


def sign(node):
    """Return the words of a letter, a number, a name or an operator."""
    text = node.get_text().strip()
    if not text:
        return ""
    if text in WORDS:
        words = WORDS[text]
    elif node.name in ("mn", "mtext") or text.isascii():
        words = text
    else:
        words = unicodedata.name(text, text) if len(text) == 1 else text
        words = words.lower().removeprefix("greek ").removeprefix("small letter ")
        words = re.sub(r"^capital letter ", "capital ", words)
    return f"bold {words}" if "bold" in node.get("mathvariant", "") and words else words


def raised(power, after_frame):
    """Return the words of a superscript; ``after_frame``: the letter has one before it, too."""
    text = bare(power)
    frame = re.fullmatch("[A-Z]", text) and (after_frame or text != "T")
    if not frame and text in POWERS:
        return POWERS[text]
    if frame:
        return text
    return f"to the power {say(power)}" + ("" if is_simple(power) else ", end of power,")


def lowered(base, index):
    """Return the words of a subscript; after a hat, it is a direction and is spoken alone."""
    if bare(index) in ("⊥", "∥"):
        return say(index)
    if bare(index) == "×":
        return "cross"
    end = "" if is_simple(index) else ", end of index,"
    return say(index) + end if base.name == "mover" else f"sub {say(index)}{end}"


def is_before(node):
    """Check whether a script is before its letter, which means that its base is empty."""
    return node.name in SCRIPTS and parts(node)[0].name == "mrow" and not bare(parts(node)[0])


def with_scripts(node, after_frame=False):
    base, *scripts = parts(node)
    if bare(base) in LIMITED and node.name != "msup":
        limits = [
            LIMITED[bare(base)] if len(scripts) == 1 else "from",
            *(say(script) for script in scripts[:1]),
        ]
        return " ".join(
            [say(base), *limits, *(f"to {say(script)}" for script in scripts[1:]), "of"]
        )
    words = [", end of magnitude," if bare(base) in BARS else say(base)]
    if node.name in ("msub", "msubsup"):
        words.append(lowered(base, scripts[0]))
    if node.name in ("msup", "msubsup"):
        words.append(raised(scripts[-1], after_frame))
    return " ".join(words)


def table(node):
    rows = [
        [say(cell) for cell in row.find_all("mtd", recursive=False)]
        for row in node.find_all("mtr", recursive=False)
    ]
    width = max(len(row) for row in rows)
    if width == 1:
        return f"column of {len(rows)}: " + "; ".join(row[0] for row in rows) + "; end of column,"
    if len(rows) == 1:
        return f"row of {width}: " + ", ".join(rows[0]) + "; end of row,"
    lines = [f"row {number}: " + ", ".join(row) for number, row in enumerate(rows, 1)]
    return f"{len(rows)} by {width} matrix, " + "; ".join(lines) + "; end of matrix,"


def product(text, before, after):
    """Return the words for × and ⋅ between their neighbours."""
    numbers = [node is not None and bare(node)[:1].isdecimal() for node in (before, after)]
    if text == "×" and all(numbers) and len(bare(before)) == len(bare(after)) == 1:
        # This is the shape of a matrix.
        return "by"
    return "times" if any(numbers) else {"×": "cross", "⋅": "dot"}[text]


def argument(node):
    """Return the only element between brackets, as after the name of a function, or ``None``."""
    inside = parts(node) if node is not None and node.name == "mrow" else []
    is_one = (
        len(inside) == 3
        and bare(inside[0]) == "("
        and bare(inside[2]) == ")"
        and is_simple(inside[1])
    )
    return inside[1] if is_one else None


def is_letter(node):
    """Check whether ``node`` is an upright letter, as in names of several letters."""
    upright = node is not None and node.name == "mi" and node.get("mathvariant") == "normal"
    return upright and re.fullmatch("[A-Za-z]", bare(node)) is not None


def row(nodes):
    words, word, in_bars, after_frame, after_function = [], "", False, False, False
    nodes = [node for node in nodes if bare(node)]
    for place, node in enumerate(nodes):
        before = nodes[place - 1] if place else None
        after = nodes[place + 1] if place + 1 < len(nodes) else None
        text = bare(node)
        if is_letter(node):
            word += text
            if not is_letter(after):
                words.append(WORDS.get(word, word))
                word = ""
        elif text in BARS and node.name in ("mi", "mo"):
            in_bars = not in_bars
            words.append("the magnitude of" if in_bars else ", end of magnitude,")
        elif is_before(node):
            words.append(say(parts(node)[-1]))
        elif node.name in SCRIPTS:
            if text[0] in BARS:
                in_bars = False
            words.append(with_scripts(node, after_frame))
        elif text in ("×", "⋅"):
            words.append(product(text, before, after))
        elif text in ("[", "(") and after is not None and after.name == "mtable":
            # A screen reader announces the beginning and end of a table.
            continue
        elif text in ("]", ")") and before is not None and before.name == "mtable":
            continue
        elif after_function and argument(node) is not None:
            words.append(say(argument(node)))
        else:
            words.append(say(node))
        after_frame = is_before(node)
        after_function = text in WORDS and len(text) > 1
    return " ".join(word for word in words if word)


def say(node):
    """Return the words for ``node``, an element of MathML."""
    if node.name == "mfrac":
        over, under = parts(node)
        if is_simple(over) and is_simple(under):
            return f"{say(over)} over {say(under)}"
        return f"the fraction {say(over)}, over {say(under)}, end of fraction,"
    if node.name == "msqrt":
        inside = parts(node)
        simple = len(inside) == 1 and is_simple(inside[0])
        return f"the root of {row(inside)}" + ("" if simple else ", end of root,")
    if node.name == "mover":
        base, mark = parts(node)
        return f"{say(base)} {ACCENTS.get(bare(mark)) or say(mark)}"
    if node.name == "munder":
        base, label = parts(node)
        if bare(label) == "⏟":
            return say(base)
        if "⏟" in base.get_text():
            return f"{say(base)}, marked {say(label)},"
        return f"{say(base)} {LIMITED.get(bare(base), 'over')} {say(label)} of"
    if node.name in SCRIPTS:
        return with_scripts(node)
    if node.name == "mtable":
        return table(node)
    if node.name == "mspace":
        return ""
    if node.name in ("math", "mrow", "mstyle", "mtd", "mpadded", "mphantom"):
        return row(parts(node))
    return sign(node)


def spoken(math):
    """Return the words for a formula, its ``math`` element, on one line."""
    words = re.sub(r"\s+", " ", say(math))
    words = re.sub(r"(?: ?[,;])*( ?;)", r";", words)
    words = re.sub(r"(?: ?,)+", ",", words)
    return words.strip(" ,;")
