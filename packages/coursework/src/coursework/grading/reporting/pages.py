"""Pages for people: complete in one file, without scripts, and safe whatever a student wrote."""

import base64
import functools
import hashlib
import html
from xml.etree import ElementTree

from ...checking.plain import Plain
from ...checking.reply import to_html
from ...checking.writing import LONGEST, answer_as_tex, readable

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
.scroll { overflow: auto hidden; padding-block: .2em; }
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
#: A page loads no script, picture, font or address, whatever is in it.
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
    """Return text for a page, escaped so that a browser shows it and never interprets it."""
    return html.escape(readable(str(value), most))


def message(said: str) -> str:
    """Return a message as HTML, with ``code``, *emphasis* and $formulas$ as in Markdown."""
    return to_html(readable(said, 4_000), formula)


@functools.lru_cache(2_000)
def formula(source: str, longest: int = 300) -> str:
    """Return TeX as MathML, or unchanged if it cannot be converted."""
    from latex2mathml.converter import convert

    try:
        if len(source) > longest:
            raise ValueError
        mathml = convert(source)
        # A message may contain a student's words, so let only elements of formulas through.
        for element in ElementTree.fromstring(mathml).iter():
            name = element.tag.rpartition("}")[2]
            if name not in MATHEMATICS or not set(element.attrib) <= ATTRIBUTES:
                raise ValueError
        return mathml
    except Exception:
        return f"<code>{text(source)}</code>"


def answer_as_mathematics(plain: Plain | None) -> str:
    """Return the MathML of a plain answer, or an empty string if it is shown as text only."""
    mathml = formula(answer_as_tex(plain), LONGEST) if plain else ""
    return mathml if mathml.startswith("<math") else ""
