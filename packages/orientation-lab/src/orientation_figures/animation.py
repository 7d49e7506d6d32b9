"""Animated drawings: key frames computed in Python and played by the browser on request."""

import hashlib
import json
import re
from html import escape

import numpy as np

from .drawing import collapsed, pair, path_data
from .style import STYLE
from .vectors import in_degrees

# Without this script the figure is a still. It shows the controls, and lets the slider set the
# browser's animation clock (SMIL) and the button run it.
SCRIPT = """
document.querySelectorAll('[data-moving="%s"]:not([data-ready])').forEach(figure => {
  const svg = figure.querySelector('svg');
  const [button, slider] = figure.querySelectorAll('button, input');
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
  const stop = () => { playing = false; svg.pauseAnimations(); };
  const tick = () => {
    if (!playing || !figure.isConnected) return;
    slider.value = svg.getCurrentTime() / frame;
    if (svg.getCurrentTime() >= last * frame) stop();
    show();
    requestAnimationFrame(tick);
  };
  svg.pauseAnimations();
  svg.querySelectorAll('animate, animateTransform').forEach(part => {
    part.setAttribute('dur', last * frame + 's');
    part.setAttribute('fill', 'freeze');
    part.setAttribute('begin', '0s');
  });
  svg.setCurrentTime(slider.value * frame);
  slider.oninput = () => { stop(); svg.setCurrentTime(slider.value * frame); show(); };
  button.onclick = () => {
    if (playing) { stop(); show(); return; }
    if (slider.value >= last) svg.setCurrentTime(0);
    playing = true;
    svg.unpauseAnimations();
    tick();
  };
  show();
});
"""


def one_after_another(angles, progress):
    """Return the angles when ``progress`` of the rotations are done, one after another.

    Examples
    --------
    >>> from orientation_figures.animation import one_after_another
    >>> one_after_another((0.5, 0.8, -0.2), 1.5)
    [0.5, 0.4, 0.0]
    """
    return [
        float(angle) * min(max(progress - turn, 0), 1) + 0.0 for turn, angle in enumerate(angles)
    ]


class Animation:
    """A drawing that is animated in steps on request, and is a still until then.

    Parameters
    ----------
    draw : callable
        ``draw(progress)`` returns the ``Drawing`` at that moment; ``progress`` runs from 0 to the
        number of steps. All drawings must consist of the same marks in the same order.
    steps : list of (str, float or str)
        The words shown under the picture in each step, and what a screen reader adds: either the
        angle rotated so far (give its last value, in radians) or more words.
    still : float, optional
        The moment shown at first, by default the end. The ``alt`` of its drawing is used.
    frames : int
        Key frames in each step.
    seconds : float
        The duration of each step.

    Raises
    ------
    ValueError
        If two moments consist of different marks.
    """

    def __init__(self, draw, steps, still=None, frames=6, seconds=2.5):
        self.steps = list(steps)
        # Each step starts and ends gently, and then rests for one key frame.
        eased = [(j / frames) ** 2 * (3 - 2 * j / frames) for j in range(1, frames + 1)]
        self.moments = [0] + [
            step + part for step in range(len(self.steps)) for part in [*eased, 1]
        ]
        self.still = len(self.moments) - 1 if still is None else round(still * (frames + 1))
        self.drawings = [draw(moment) for moment in self.moments]
        self.seconds = seconds / frames
        # Bodies keep the shades of the still while they turn.
        shapes = [
            [(re.sub(r"shade-\d+", "shade", kind), shape) for kind, shape, _, _ in drawing.marks]
            for drawing in self.drawings
        ]
        for moment, shape in zip(self.moments, shapes):
            if shape != shapes[0]:
                raise ValueError(
                    f"the drawing at {moment:.2f} has different marks from the one at 0. An "
                    "arrow may point straight at the reader; choose another view"
                )

    def texts(self):
        """Return the number of each key frame's step (from 0) and a screen reader's addition."""
        texts = []
        for moment in self.moments:
            step = max(int(np.ceil(moment)) - 1, 0)
            more = self.steps[step][1]
            if not isinstance(more, str):
                more = f", {in_degrees((moment - step) * more)}"
            texts.append((step, more))
        return texts

    def bounds(self):
        """Return left, top, right and bottom of all moments together, in pixels from the origin."""
        bounds = np.array([drawing.bounds() for drawing in self.drawings])
        return np.concatenate([bounds[:, :2].min(axis=0), bounds[:, 2:].max(axis=0)])

    def _repr_html_(self):
        motions = [_motion(marks) for marks in zip(*(drawing.marks for drawing in self.drawings))]
        svg = self.drawings[self.still].svg(motions, self.bounds(), decimals=1)
        words = [
            f"Step {step} of {len(self.steps)}: {words}"
            for step, (words, _) in enumerate(self.steps, start=1)
        ]
        texts = escape(
            json.dumps([words, self.texts()], separators=(",", ":")), quote=False
        ).replace("'", "&#39;")
        name = hashlib.sha256(svg.encode()).hexdigest()[:10]
        return (
            f'<figure class="orientation-figure" data-moving="{name}" data-texts=\'{texts}\'>'
            f'<style>{STYLE}</style>{svg}<div hidden><button type="button">Play</button> '
            f'<input type="range" min="0" max="{len(self.moments) - 1}" value="{self.still}" '
            'aria-label="Moment of the animation"><output aria-live="polite"></output></div>'
            f"<script>{SCRIPT % (name, f'{self.seconds:g}')}</script></figure>"
        )

    def __repr__(self):
        return f"Animation: {self.drawings[self.still].alt}"


def _motion(marks):
    """Return the content of a mark's element, given the mark at every key frame."""
    if all(collapsed(mark) for mark in marks):
        return ""
    shape = marks[0][1]
    if isinstance(shape, str):
        return _animate(
            'animate attributeName="d"', [path_data(shape, place, 1) for _, _, place, _ in marks]
        )
    places, opacities = (
        [pair(place, 1) for _, _, place, _ in marks],
        [f"{opacity:.2g}" for *_, opacity in marks],
    )
    return _animate(
        'animateTransform attributeName="transform" type="translate"', places
    ) + _animate('animate attributeName="opacity"', opacities)


def _animate(tag, values):
    last = len(values) - 1
    if len(set(values)) == 1:
        return ""
    # A value that equals both of its neighbours adds nothing.
    keys = [
        i
        for i in range(last + 1)
        if i in (0, last) or not values[i - 1] == values[i] == values[i + 1]
    ]
    times = ";".join(f"{i / last:.4g}".removeprefix("0") or "0" for i in keys)
    return (
        f'<{tag} begin="indefinite" keyTimes="{times}" '
        f'values="{";".join(values[i] for i in keys)}"/>'
    )
