import { add, degrees, radians, scale } from './mathematics.js';
import { belt, fullTurns, picture, quaternionAt, SIZE } from './belt_picture.js';
import { button, change, element, fixed, follow, glide, group, liveText, numberTable, onceAFrame,
  open, plain, readout, Sheet, slider, stage } from './shared.js';

const FULL = 4 * Math.PI;

// A plate on a belt: one full rotation leaves a twist in the belt, two leave none.
export function render({ model, el }) {
  let stop = () => {};
  const turnTo = (angle) => {
    stop();
    change(model, { angle: Math.min(FULL, Math.max(0, angle)), passed: 0 });
  };
  const sheet = new Sheet({ bounds: [-180, -125, 180, 130], size: SIZE, changed: () => redraw(),
    name: 'A belt from a wall to a plate.',
    grab(part, at) {
      if (!part) return null;
      const angle = model.get('angle');
      return (to) => turnTo(radians(Math.round(degrees(angle) + 1.5 * (to[1] - at[1]))));
    } });
  const redraw = onceAFrame(draw);
  const angle = slider({ symbol: '$\\theta$', name: 'theta, rotation of the plate', min: 0, max: 720, change: turnTo, more: () => '' });
  const passed = slider({ symbol: '', name: 'Belt passed round the plate', unit: 'per cent', sign: '%', factor: 0.01, min: 0, max: 100, more: () => '',
    change: (value) => { stop(); change(model, { passed: value }); } });
  const presets = [['No turn', 0], ['One full turn', 1], ['Two full turns', 2]].map(([name, turns]) => button(name, () => {
    stop();
    const from = model.get('angle'), to = 2 * Math.PI * turns;
    change(model, { passed: 0 });
    stop = glide((part) => change(model, { angle: part === 1 ? to : from + part * (to - from) }), 1.6);
  }));
  const round = button('Pass the belt round the plate', () => {
    stop();
    const from = model.get('passed') > 0.99 ? 0 : model.get('passed');
    stop = glide((part) => change(model, { passed: from + part * (1 - from) }), 4);
  });
  const parts = ['$q_0$', '$q_i$', '$q_j$', '$q_k$'];
  const table = numberTable({ name: 'Quaternions', kind: 'belt', rows: ['wall', 'middle', 'plate'], columns: parts,
    names: ['wall', 'middle of the belt', 'plate'].map((where) => ['q 0', 'q i', 'q j', 'q k'].map((part) => `${where}, ${part}`)), light: () => {} });
  const text = liveText();
  open(el, stage(sheet, text),
    element('div', { class: 'controls' }, angle.element, group('Turn the plate', 'row-of-controls', ...presets), 
      element('div', { class: 'row-of-controls' }, round), passed.element),
    element('div', { class: 'readouts' }, readout(['The quaternion along the belt'], table.element)));

  function draw() {
    const theta = model.get('angle'), part = model.get('passed'), turns = fullTurns(theta);
    angle.show(theta);
    passed.show(part);
    round.disabled = !turns;
    passed.element.style.visibility = turns ? '' : 'hidden';
    table.show([0, 0.5, 1].map((share) => quaternionAt(theta, part, share).map((entry) => fixed(entry))));
    const [frames, places] = belt(theta, part), plate = add(places.at(-1), scale(0.045, frames.at(-1)[1]));
    sheet.draw(() => {
      picture(sheet, theta, part);
      sheet.grip(plate, 'plate', 40);
    });
    text.say(sentence(theta, part, turns));
  }

  draw();
  return follow(model, ['angle', 'passed'], redraw);
}

function sentence(theta, passed, turns) {
  const by = `The plate has been turned by ${plain(degrees(theta), 0)}°.`;
  if (!turns) return `${by} The belt is twisted just as far. Go on to one full turn, or to two.`;
  if (turns === 1) {
    return `${by} The plate is as it was at first, but the belt is twisted, and $q$ has become −1. ${passed > 0.995
      ? 'Passed round the plate, the belt is twisted the other way: the twist has not disappeared.' : 'Now hold the plate and pass the belt round it.'}`;
  }
  return passed > 0.995 ? `${by} Passed round the plate while it was held, the belt is flat: two full turns can be undone, but one cannot.`
    : `${by} The belt has twice the twist, and $q$ is 1 again. Hold the plate and pass the belt round it.`;
}
