"""Put the modules of a figure together: one text for Jupyter, classic scripts for pages without a kernel.

Pages opened from disk cannot import modules, and anywidget wants one module for each figure. Both come
from the same files; ``glyphs.js`` is made here, so that labels look like those of ``orientation.drawing``.
"""
import json
import re
from functools import cache
from pathlib import Path

from ..drawing import typeset

FOLDER = Path(__file__).parent
SHARED = ('mathematics', 'glyphs', 'shared')
IMPORT = re.compile(r'^import \{([^}]*)\} from .*;\n', re.MULTILINE)
EXPORT = re.compile(r'^export (?=(?:async function|function|class|const) (\w+))', re.MULTILINE)
COMMENT = re.compile(r'^\s*//.*\n|^ +', re.MULTILINE)

#: Every text that a figure sets as mathematics.
LABELS = (*(rf'\hat{{{frame}}}_{axis}' for frame in 'nabcd' for axis in 'xyz'), r'\hat{e}', *'NABCDtxyz',
          r'\psi', r'\theta', r'\theta/2', r'\varphi', 'q_0', 'q_i', 'q_j', 'q_k', 'e_x', 'e_y', 'e_z', 'I_x', 'I_y', 'I_z',
          r'{}^A\mathbf{C}^N', r'{}^D\mathbf{C}^A', r'\hat{a}_x\times\hat{a}_y',
          *(rf'\hat{{e}}_{axis}' for axis in 'xyz'), 'E', 'q', '-q', '0', r'4\,\mathrm{s}',
          *(rf'{top}^\circ/\mathrm{{s}}' for top in (30, 60, 90, 120, 180, 360, 720)), *(rf'\mathbf{{C}}_{axis}' for axis in 'xyz'),
          *(rf'{{}}^{frames[0]}\mathbf{{C}}^{frames[1]}' for frames in ('NN', 'BN', 'CN', 'DN', 'BA', 'CB', 'DC')),
          # The axes of the plots of motion.
          r'\mathbf{H}', r'\mathrm{not\ orthogonal\ by}', r'\mathrm{error\ (rad)}', r'\mathrm{margin\ to\ gimbal\ lock\ (degrees)}',
          r't\ \mathrm{(s)}', '10^{-15}', '10^{-10}', '10^{-5}', '0', '1', '5', '10', '15', '20', '90')


@cache
def glyphs():
    """Return the module of outlines and of where they stand in each label, 1000 units to the em."""
    outlines, labels = {}, {}
    for text in LABELS:
        placed, ink = typeset(f'${text}$')
        labels[text] = {'ink': [round(float(edge)) for edge in ink.ravel()],
                        'glyphs': [[outlines.setdefault(outline, len(outlines)), round(float(x)), round(float(y)),
                                    round(float(size), 3)] for outline, (x, y), size in placed]}
    return (f'export const OUTLINES = {json.dumps(list(outlines), separators=(",", ":"))};\n'
            f'export const LABELS = {json.dumps(labels, separators=(",", ":"))};\n')


@cache
def source(name):
    """Return the text of a module without comments and indentation, which only weigh."""
    return glyphs() if name == 'glyphs' else COMMENT.sub('', (FOLDER / 'js' / f'{name}.js').read_text('utf8'))


def body(name):
    """Return a module's text without imports and exports, for a scope where the names are known."""
    return EXPORT.sub('', IMPORT.sub('', source(name)))


def esm(name):
    """Return the figure ``name`` as one module that imports nothing, as anywidget takes it."""
    # The figure has a scope of its own, where it may use a name that the shared modules have.
    figure = f'const render = (() => {{\n{body(name)}return render;\n}})();\n'
    return ''.join(map(body, SHARED)) + figure + 'export default { render };\n'


def shared_script():
    """Return the classic script that every page with figures loads first."""
    names = [name for module in SHARED for name in EXPORT.findall(source(module))]
    return f"const orientation = (() => {{\n{''.join(map(body, SHARED))}return {{ {', '.join(names)} }};\n}})();\n"


def script(name):
    """Return the classic script that brings the figures of one kind to life."""
    names = ', '.join(group.strip().rstrip(',') for group in IMPORT.findall(source(name)))
    return f"(() => {{\nconst {{ {names} }} = orientation;\n{body(name)}orientation.start('{name}', render);\n}})();\n"


def style():
    """Return the style sheet of the controls; that of the drawings comes with each still."""
    return (FOLDER / 'moving.css').read_text('utf8')
