import { picture } from './gate_picture.js';
import { change, choice, element, follow, liveText, onceAFrame, open, plain, Sheet, slider, stage } from './shared.js';

const percent = (share) => `${plain(100 * share, 1)}\u00a0%`;

// A walk past a car: the reader changes the steel and the gate, and sees the effect on the heading.
export function render({ model, el }) {
  const { steels, rejected, rows } = model.get('table');
  const setSteel = (value) => {
    change(model, { steel: Math.max(0, Math.min(12, 2 * Math.round(value / 2))) });
    redraw();
  };
  const sheet = new Sheet({ name: '', bounds: [-180, -130, 180, 130], grab(part, at) {
    const first = model.get('steel');
    return (to) => setSteel(first + (to[0] - at[0]) / 15);
  } });
  sheet.svg.setAttribute('aria-label', 'The heading error over time, in degrees, for five walks past a car. '
    + 'The arrow keys change the steel.');
  // A plot has only one view, so the keys and a finger change the steel instead.
  sheet.look = () => {};
  sheet.press = (event) => {
    const step = { ArrowLeft: -2, ArrowDown: -2, ArrowRight: 2, ArrowUp: 2 }[event.key];
    if (!step) return;
    setSteel(model.get('steel') + step);
    event.preventDefault();
  };
  const redraw = onceAFrame(draw);
  const steel = slider({ symbol: '', name: 'Steel of the car', unit: 'microtesla', sign: ' µT', factor: 1, min: 0, max: 12, step: 2,
    more: () => '', change: setSteel });
  const gate = choice({ name: 'Share of good measurements that the gate rejects', options: rejected.map((share) => [share, share ? percent(share) : 'none: no gate']),
    change: (value) => change(model, { gate: Number(value) }) });
  const text = liveText();
  open(el, stage(sheet, text), element('div', { class: 'controls' },
    element('div', { class: 'named' }, element('span', { 'aria-hidden': 'true' }, 'Steel'), steel.element), gate.element));

  function draw() {
    const walks = rows[steels.indexOf(model.get('steel'))][rejected.indexOf(model.get('gate'))];
    steel.show(model.get('steel'));
    gate.show(String(model.get('gate')));
    sheet.draw(() => picture(sheet, walks.curves));
    text.say(`Of a hundred walks, half end within ${plain(walks.middle, 1)}° of the true heading, and the worst is ${plain(walks.worst, 1)}° off. `
      + `The filter rejected ${percent(walks.rejected)} of all field measurements. Five of the walks are drawn.`);
  }

  draw();
  return follow(model, ['steel', 'gate'], redraw);
}
