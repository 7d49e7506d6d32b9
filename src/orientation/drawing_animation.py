"""Drawings that move: key frames computed with the module, played by the browser, never unasked."""
import hashlib
import json
from html import escape

import numpy as np

from .drawing import STYLE, collapsed, pair, path_data

# Without this script the figure is a still. It shows the controls, and lets the browser's own animation
# clock (SMIL) be set by the slider or run by the button.
SCRIPT = '''
document.querySelectorAll('[data-moving="%s"]:not([data-ready])').forEach(figure => {
  const svg = figure.querySelector('svg'), [button, slider] = figure.querySelectorAll('button, input');
  const said = figure.querySelector('output'), [steps, texts] = JSON.parse(figure.dataset.texts);
  const frame = %s, last = texts.length - 1;
  let playing = false;
  figure.dataset.ready = '';
  figure.querySelector('div').hidden = false;
  const show = () => {
    const [step, more] = texts[slider.value];
    slider.setAttribute('aria-valuetext', steps[step] + more);
    if (said.textContent !== steps[step]) said.textContent = steps[step];
    button.textContent = playing ? 'Pause' : 'Play';
  };
  const tick = () => {
    if (!playing || !figure.isConnected) return;
    slider.value = svg.getCurrentTime() / frame;
    if (svg.getCurrentTime() >= last * frame) { playing = false; svg.pauseAnimations(); }
    show();
    requestAnimationFrame(tick);
  };
  svg.pauseAnimations();
  svg.querySelectorAll('animate, animateTransform').forEach(part => {
    for (const [name, value] of [['dur', last * frame + 's'], ['fill', 'freeze'], ['begin', '0s']]) part.setAttribute(name, value);
  });
  svg.setCurrentTime(slider.value * frame);
  slider.oninput = () => { playing = false; svg.pauseAnimations(); svg.setCurrentTime(slider.value * frame); show(); };
  button.onclick = () => {
    playing = !playing;
    if (playing && slider.value >= last) svg.setCurrentTime(0);
    if (playing) { svg.unpauseAnimations(); tick(); } else { svg.pauseAnimations(); show(); }
  };
  show();
});
'''


def one_after_another(angles, progress):
    """Return `angles` as they are when `progress` of the turns are done, each turn after the one before.

    >>> one_after_another((0.5, 0.8, -0.2), 1.5)
    [0.5, 0.4, 0.0]
    """
    return [angle * min(max(progress - turn, 0), 1) + 0.0 for turn, angle in enumerate(angles)]


class Animation:
    """A drawing that moves in steps.

    Parameters
    ----------
    draw : callable
        `draw(progress)` returns the `Drawing` at that moment; `progress` runs from 0 to the number of
        steps. All drawings must consist of the same marks in the same order.
    steps : sequence of (str, float or str)
        What happens in each step: the words shown under the picture, and what a screen reader adds to
        them, either the angle turned so far (the last value is given, in radians) or more words.
    still : float, optional
        The moment shown until the reader asks for motion, by default the end. Its `alt` is used.
    frames : int
        Key frames in each step.
    seconds : float
        How long a step lasts.

    Raises
    ------
    ValueError
        If two moments consist of different marks.
    """

    def __init__(self, draw, steps, still=None, frames=6, seconds=2.5):
        self.steps = list(steps)
        eased = [(j / frames) ** 2 * (3 - 2 * j / frames) for j in range(1, frames + 1)]
        self.moments = [0] + [step + part for step in range(len(steps)) for part in [*eased, 1]]
        self.still = len(self.moments) - 1 if still is None else round(still * (frames + 1))
        self.drawings = [draw(moment) for moment in self.moments]
        self.seconds = seconds / frames
        shapes = [[(kind, shape) for kind, shape, _, _ in drawing.marks] for drawing in self.drawings]
        for moment, shape in zip(self.moments, shapes):
            if shape != shapes[0]:
                raise ValueError(f'the drawing at {moment:.2f} does not consist of the same marks as the one at 0; an arrow '
                                 'may point straight at the reader there: choose another view')

    def texts(self):
        """Return, for each key frame, the number of its step (from 0) and what a screen reader adds to its words."""
        texts = []
        for moment in self.moments:
            step = max(int(np.ceil(moment)) - 1, 0)
            more = self.steps[step][1]
            texts.append((step, more if isinstance(more, str) else f', {np.degrees((moment - step) * more):.0f} degrees'))
        return texts

    def motions(self):
        """Return what goes inside each mark: its values at the key frames, where they differ."""
        return [_motion([drawing.marks[index] for drawing in self.drawings]) for index in range(len(self.drawings[0].marks))]

    def bounds(self):
        """Return left, top, right and bottom of all moments together."""
        bounds = np.array([drawing.bounds() for drawing in self.drawings])
        return np.concatenate([bounds[:, :2].min(axis=0), bounds[:, 2:].max(axis=0)])

    def _repr_html_(self):
        svg = self.drawings[self.still].svg(self.motions(), self.bounds(), decimals=1)
        words = [f'Step {step} of {len(self.steps)}: {words}' for step, (words, _) in enumerate(self.steps, start=1)]
        texts = json.dumps([words, self.texts()], separators=(',', ':'))
        name = hashlib.sha256(svg.encode()).hexdigest()[:10]
        return (f'<figure class="orientation-figure" data-moving="{name}" data-texts=\'{escape(texts, quote=False).replace(chr(39), chr(8217))}\'>'
                f'<style>{STYLE}</style>{svg}<div class="controls" hidden><button type="button">Play</button> '
                f'<input type="range" min="0" max="{len(self.moments) - 1}" step="1" value="{self.still}" '
                'aria-label="Moment of the animation"><br><output aria-live="polite"></output></div>'
                f'<script>{SCRIPT % (name, f"{self.seconds:g}")}</script></figure>')

    def __repr__(self):
        return f'Animation: {self.drawings[self.still].alt}'


def _motion(marks):
    if all(collapsed(mark) for mark in marks):
        return ''
    shape = marks[0][1]
    if isinstance(shape, str):
        return _animate('animate attributeName="d"', [path_data(shape, place, 1) for _, _, place, _ in marks])
    return (_animate('animateTransform attributeName="transform" type="translate"', [pair(place, 1) for _, _, place, _ in marks])
            + _animate('animate attributeName="opacity"', [f'{opacity:.2g}' for _, _, _, opacity in marks]))


def _animate(tag, values):
    last = len(values) - 1
    # A value equal to both its neighbours says nothing new.
    keys = [i for i in range(last + 1) if i in (0, last) or not values[i - 1] == values[i] == values[i + 1]]
    if len(set(values)) == 1:
        return ''
    times = ';'.join(f'{i / last:.4g}'.removeprefix('0') or '0' for i in keys)
    return f'<{tag} begin="indefinite" keyTimes="{times}" values="{";".join(values[i] for i in keys)}"/>'
