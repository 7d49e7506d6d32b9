"""Pages for people: complete in one file, without a script, and safe whatever a student wrote."""

import base64
import functools
import hashlib
import html
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, TypeVar
from xml.etree import ElementTree

from ...checking.plain import Plain
from ...checking.reply import to_html
from ..tables import readable

Part = TypeVar("Part")

STYLE = """
:root { color-scheme: light dark; --paper: #fdfcfa; --panel: #f5f3ee; --rule: #dcd8cf; --ink: #22262b; --soft: #565c64;
  --right: #1a7431; --wrong: #b3261e; --open: #1f5fbf; --form: #946200; --none: #8a8f96; }
@media (prefers-color-scheme: dark) { :root { --paper: #15181d; --panel: #1e2229; --rule: #363c46; --ink: #e1e4e8;
  --soft: #a4abb5; --right: #6fcf87; --wrong: #ff8a7a; --open: #84b4ff; --form: #f0b429; --none: #7b828c; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink); font: 17px/1.55 Georgia, "Times New Roman", serif; }
main { max-width: 52rem; margin: 0 auto; padding: 2rem 1.1rem 4rem; }
h1 { font-size: 1.75rem; line-height: 1.2; margin: 0 0 .2em; font-weight: 600; }
h2 { font-size: 1.25rem; margin: 2.4rem 0 .6rem; font-weight: 600; }
h3 { font-size: 1.05rem; margin: 1.9rem 0 .5rem; font-weight: 600; } .head .title { margin: 0; font-size: 1.05rem; }
p { margin: .5em 0; }
a { color: var(--open); }
.soft, figcaption, th, .key { color: var(--soft); font-family: "Segoe UI", system-ui, sans-serif; font-size: .88rem; }
.big { font-size: 2rem; line-height: 1.2; margin: .6rem 0 0; }
section.question { border: 1px solid var(--rule); border-left: .35rem solid var(--none); border-radius: 4px; padding: .8rem 1rem;
  margin: .9rem 0; background: var(--panel); break-inside: avoid; }
.head { display: flex; flex-wrap: wrap; gap: .2rem 1rem; justify-content: space-between; align-items: baseline; }
.verdict { font-family: "Segoe UI", system-ui, sans-serif; font-size: .92rem; font-weight: 600; }
.correct { border-left-color: var(--right) !important; } .correct .verdict { color: var(--right); }
.wrong { border-left-color: var(--wrong) !important; } .wrong .verdict { color: var(--wrong); }
.invalid { border-left-color: var(--form) !important; } .invalid .verdict { color: var(--form); }
.undecided, .decided { border-left-color: var(--open) !important; } .undecided .verdict, .decided .verdict { color: var(--open); }
code, pre { font-family: ui-monospace, "SF Mono", Menlo, Consolas, "DejaVu Sans Mono", monospace; font-size: .84em; overflow-wrap: anywhere; }
pre { white-space: pre-wrap; margin: .3rem 0 0; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-size: .94rem; }
th, td { text-align: left; vertical-align: top; padding: .35rem .8rem .35rem 0; border-bottom: 1px solid var(--rule); }
td.number, th.number { text-align: right; white-space: nowrap; font-variant-numeric: tabular-nums; }
ul { padding-left: 1.1rem; } li { margin: .3em 0; }
svg { display: block; max-width: 100%; height: auto; }
svg text { fill: var(--soft); font: 12px "Segoe UI", system-ui, sans-serif; }
svg .axis { stroke: var(--rule); } svg .bar { fill: var(--open); }
svg .of-correct { fill: var(--right); } svg .of-wrong { fill: var(--wrong); } svg .of-invalid { fill: var(--form); }
svg .of-undecided { fill: var(--open); } svg .of-none { fill: var(--rule); } svg .edge { stroke: var(--paper); stroke-width: 1.5; }
.appeal { border-left: .2rem solid var(--open); padding-left: .7rem; } .prose { white-space: pre-wrap; overflow-wrap: anywhere; }
figure { margin: .6rem 0; } .scroll table { min-width: 32rem; }
.key span { margin-right: 1.1rem; white-space: nowrap; } .key svg { display: inline-block; vertical-align: -1px; margin-right: .35rem; }
@media print { body { background: #fff; font-size: 11pt; } main { max-width: none; padding: 0; }
  section.question { background: none; } h2 { break-after: avoid; } tr { break-inside: avoid; } }
"""
#: No script, no picture, no font, no address: a page loads nothing, whatever is in it.
POLICY = (
    "default-src 'none'; style-src 'sha256-"
    + base64.b64encode(hashlib.sha256(STYLE.encode()).digest()).decode()
    + "'; base-uri 'none'; form-action 'none'"
)

MATHEMATICS = {
    "math",
    "mrow",
    "mi",
    "mo",
    "mn",
    "msup",
    "msub",
    "msubsup",
    "mfrac",
    "msqrt",
    "mroot",
    "mtext",
    "mspace",
    "mover",
    "munder",
    "munderover",
    "mtable",
    "mtr",
    "mtd",
    "mstyle",
    "mpadded",
    "menclose",
}
ATTRIBUTES = {
    "display",
    "mathvariant",
    "stretchy",
    "fence",
    "form",
    "separator",
    "accent",
    "minsize",
    "maxsize",
    "lspace",
    "rspace",
    "width",
    "columnalign",
    "rowspacing",
    "columnspacing",
    "displaystyle",
    "scriptlevel",
    "linethickness",
}


def text(value: object, most: int = 400) -> str:
    """Text for a page: whatever it holds is shown and never obeyed."""
    return html.escape(readable(str(value), most))


def message(said: str) -> str:
    """A message, with ``code``, *emphasis* and $mathematics$ marked as in Markdown, as HTML."""
    return to_html(readable(said, 4_000), formula)


@functools.lru_cache(2_000)
def formula(source: str, longest: int = 300) -> str:
    """TeX as MathML, or as it is where it cannot be turned into that."""
    from latex2mathml.converter import convert

    try:
        if len(source) > longest:
            raise ValueError
        found = convert(source)
        # A student's words may have come into a message: only what
        # draws mathematics is let through.
        for element in ElementTree.fromstring(found).iter():
            name = element.tag.rpartition("}")[2]
            if name not in MATHEMATICS or not set(element.attrib) <= ATTRIBUTES:
                raise ValueError
        return found
    except Exception:
        return f"<code>{text(source)}</code>"


# --- an answer in readable form -----------------------------------------------------------------

OPERATORS = {"Add": (" + ", 1), "Mul": ("*", 2), "Pow": ("**", 3)}
NAMES = {"Pi": "pi", "Exp1": "E", "ImaginaryUnit": "I", "Abs": "abs"}


def answer_as_text(plain: Plain | None, most: int = 300) -> str:
    """A plain answer as one line like the code that makes it, cut short where it is long."""
    return _Printer(plain["nodes"], most).value(plain["value"]) if plain else ""


class _Printer:
    """Writes no more than asked for: what is shared in the nodes would
    fill a disk if it were written out.
    """

    def __init__(self, nodes: Sequence[Any], most: int) -> None:
        self.nodes = nodes
        self.left = most
        self.is_cut = False

    def put(self, piece: str) -> str:
        if self.left <= 0:
            return self.cut()
        self.left -= len(piece)
        return piece if self.left >= 0 else piece[: self.left] + self.cut()

    def cut(self) -> str:
        """The sign that something is missing: once."""
        first, self.is_cut = not self.is_cut, True
        return "…" if first else ""

    def parts(
        self, parts: Iterable[Part], write: Callable[[Part], str], between: str = ", "
    ) -> str:
        written: list[str] = []
        for part in parts:
            if self.left <= 0:
                written.append(self.cut())
                break
            written.append((self.put(between) if written else "") + write(part))
        return "".join(written)

    def value(self, value: Sequence[Any]) -> str:
        kind, *rest = value
        if kind == "blank":
            return self.put("...")
        if kind == "text":
            return self.put(repr(readable(rest[0])))
        if kind == "truth":
            return self.put(str(rest[0]))
        if kind == "printed":
            return self.put(f"printed {readable(rest[0])}")
        if kind == "frames":
            return self.parts(
                sorted(rest[0]),
                lambda name: self.put(f"{readable(name)} ") + self.named(rest[0][name]),
            )
        if kind == "raised":
            return self.put(f"raised {readable(rest[0])}")
        if kind == "expression":
            return self.node(rest[0], 0, 0)
        if kind == "matrix":
            rows, columns, entries = rest
            lines = [entries[row * columns : (row + 1) * columns] for row in range(rows)]
            return (
                "["
                + self.parts(
                    lines,
                    lambda line: "[" + self.parts(line, lambda entry: self.node(entry, 0, 0)) + "]",
                )
                + "]"
            )
        if kind == "list":
            return "[" + self.parts(rest[0], self.value) + "]"
        if kind == "function":
            return self.put("returned ") + self.parts(rest[0], self.value, "; ")
        if kind == "frame":
            return self.put(f"frame {readable(rest[0])}: ") + self.named(rest[1])
        return self.put("vector: ") + self.named(rest[0])

    def named(self, values: Mapping[str, Any]) -> str:
        return self.parts(
            sorted(values),
            lambda name: self.put(f"in {readable(name)}: ") + self.value(values[name]),
            "; ",
        )

    def node(self, order: int, depth: int, around: int) -> str:
        if self.left <= 0 or depth > 40:
            return self.cut() if self.left <= 0 else self.put("…")
        operation, *rest = self.nodes[order]
        if operation == "symbol":
            return self.put(readable(rest[0]))
        if operation == "constant":
            return self.put(NAMES.get(rest[0], readable(rest[0])))
        if operation in ("integer", "rational", "float"):
            digits = "/".join(rest)
            if operation == "float" and 1e-300 < abs(float(digits)) < 1e300:
                digits = f"{float(digits):.10g}"  # enough to recognise a number by
            tight = around > 1 and ("/" in digits or digits.startswith("-"))
            return self.put(f"({digits})" if tight else digits)
        if operation == "Pow" and self.nodes[rest[1]] == ["rational", "1", "2"]:
            return self.put("sqrt(") + self.node(rest[0], depth + 1, 0) + self.put(")")
        if operation == "Mul" and len(rest) > 1 and self.nodes[rest[0]] == ["integer", "-1"]:
            inner = self.put("-") + self.parts(
                rest[1:], lambda child: self.node(child, depth + 1, 2), "*"
            )
            return f"({inner})" if around > 1 else inner
        if operation in OPERATORS:
            sign, binding = OPERATORS[operation]
            inner = self.parts(
                rest,
                lambda child: self.node(child, depth + 1, binding + (operation == "Pow")),
                sign,
            )
            inner = inner.replace("+ -", "- ")
            return f"({inner})" if around > binding else inner
        return (
            self.put(f"{operation}(")
            + self.parts(rest, lambda child: self.node(child, depth + 1, 0))
            + self.put(")")
        )
