import { add, AXES, degrees, dot, gimbalLockMargin, length, PROPER_EULER, radians, scale, SEQUENCES,
  several, subtract, wrapped } from './mathematics.js';
import { device, INNER, OUTER, picture, SIZE, SYMBOLS } from './gimbal_picture.js';
import { button, change, choice, element, fixed, follow, followTurn, glide, group, liveText, numberTable,
  onceAFrame, open, plain, put, readout, Sheet, slider, stage, write } from './shared.js';
import { hatted, turned } from './words_picture.js';

const BOUNDS = [-180, -185, 200, 185], NAMES = ['psi', 'theta', 'phi'];
const CLOSE = radians(10), LOCKED = radians(0.5);

export function render({ model, el }) {
  let lit = null, stop = () => {};
  const state = () => [model.get('angles'), model.get('sequence')];
  const setAngle = (k, angle) => {
    const angles = [...model.get('angles')];
    angles[k] = wrapped(angle);
    change(model, { angles });
  };
  const sheet = new Sheet({ bounds: BOUNDS, size: SIZE, camera: [58, 36], changed: () => redraw(),
    name: 'A camera gimbal: handgrip A, outer arm B, inner arm C, camera D.',
    grab(part, at) {
      if (!part) return null;
      stop();
      const [angles, order] = state(), gimbal = device(angles, order), k = 'BCD'.indexOf(part);
      const far = (point) => length(subtract(sheet.onSheet(point), at)) - 0.1 * dot(point, sheet.view[2]);
      const held = PLACES[part](gimbal, 360).reduce((best, point) => (far(point) < far(best) ? point : best));
      // The position of the point if this joint were at zero.
      const arm = turned(gimbal.axes[k], -angles[k], held);
      const follower = followTurn(sheet, { axis: gimbal.axes[k], arm, angle: angles[k], at });
      return (to) => setAngle(k, follower(to));
    } });
  const redraw = onceAFrame(draw);
  const move = (target) => {
    stop();
    const from = model.get('angles');
    stop = glide((part) => change(model, { angles: target(part, from).map(wrapped) }));
  };
  const sliders = NAMES.map((name, k) => slider({ symbol: SYMBOLS[k], name, change(angle) {
    stop();
    setAngle(k, angle);
  } }));
  const sequence = choice({ name: 'Sequence', options: SEQUENCES, change(value) {
    stop();
    change(model, { sequence: value });
  } });
  const towards = (goal) => move((part, from) => from.map((angle, k) => angle + part * (goal[k] - angle)));
  const buttons = [
    button('All to zero', () => towards([0, 0, 0])),
    button('To gimbal lock', () => {
      const [[psi, theta, phi], order] = state();
      const nearest = PROPER_EULER.includes(order) ? Math.PI * Math.round(theta / Math.PI)
        : (theta < 0 ? -1 : 1) * Math.PI / 2;
      towards([psi, nearest, phi]);
    }),
    button('Trade $\\psi$ for $\\varphi$', () => {
      const sense = dot(...[0, 2].map((k) => device(...state()).axes[k])) < 0 ? 1 : -1;
      move((part, [psi, theta, phi]) => [psi + part * radians(40), theta, phi + sense * part * radians(40)]);
    })];
  const matrix = numberTable({ name: 'Direction cosine matrix of D with respect to A', kind: 'bracket', rows: hatted('d'),
    columns: hatted('a'), names: AXES.map((i) => AXES.map((j) => `d ${i} dot a ${j}`)),
    light(i, j) {
      lit = i === undefined ? null : [i, j];
      redraw();
    } });
  const bar = element('div', { class: 'bar', role: 'meter', 'aria-label': 'Margin to gimbal lock', 'aria-valuemin': '0', 'aria-valuemax': '90' }, element('span'));
  const margin = element('span', { class: 'value' });
  const text = liveText();
  const more = model.get('more') !== false;
  open(el, stage(sheet, text), element('div', { class: 'controls' }, ...sliders.map((slider) => slider.element),
    group('Move the gimbal', 'row-of-controls', ...(more ? buttons : buttons.slice(0, 1)))),
  element('div', { class: 'readouts' }, ...(more ? [sequence.element] : []),
    readout(['Direction cosine matrix ${}^D\\mathbf{C}^A$'], matrix.element),
    ...(more ? [readout(['Margin to gimbal lock', margin], bar)] : [])));

  function draw() {
    const [angles, order] = state(), gimbal = device(angles, order), apartBy = gimbalLockMargin(angles, order), close = apartBy < CLOSE;
    sliders.forEach((one, k) => {
      one.show(angles[k]);
      one.mark(close && k !== 1 ? 'same' : '');
    });
    sequence.show(order);
    matrix.show(gimbal.D.map((row) => row.map((entry) => fixed(entry))));
    const apart = plain(degrees(apartBy), 1);
    write(margin, `${apart}°`);
    put(bar.firstChild, 'style', `width:${(apart / 0.9).toFixed(1)}%`);
    put(bar, 'aria-valuenow', apart);
    put(bar, 'aria-valuetext', several(apart, 'degrees'));
    sheet.draw(() => {
      picture(sheet, gimbal, close, lit);
      sheet.gripLine(PLACES.B(gimbal, 40), 'B');
      sheet.gripLine(PLACES.C(gimbal, 40), 'C');
      sheet.grip(PLACES.D(gimbal)[0], 'D', 22);
    });
    text.say(lit ? inWords(gimbal.D, ...lit) : more ? situation(gimbal.axes, apartBy, apart) : 'Drag an arm or the camera. Touch a number to see what it measures.');
  }

  draw();
  const unfollow = follow(model, ['angles', 'sequence'], redraw);
  return () => {
    stop();
    unfollow();
  };
}

const inWords = (D, i, j) => `$\\hat{d}_${AXES[i]}$ · $\\hat{a}_${AXES[j]}$ = ${fixed(D[i][j]).trim()}: `
  + 'the cosine of the angle between them.';

function situation(axes, margin, apart) {
  if (margin >= CLOSE) return `The axes of $\\psi$ and $\\varphi$ are ${apart}° apart: three sliders turn the camera in three ways.`;
  if (margin > LOCKED) {
    return `Close to gimbal lock: the axes of $\\psi$ and $\\varphi$ are ${apart}° apart, so these two sliders turn the camera about `
      + 'nearly the same line.';
  }
  return 'Gimbal lock: $\\psi$ and $\\varphi$ turn the camera about the same line, '
    + (dot(axes[0], axes[2]) > 0 ? 'the same way' : 'opposite ways')
    + `. Trade one for the other and the camera stands still. One degree of freedom is lost.`;
}

// Points where the reader can take hold of the arms and the camera.
const points = (u, v, radius, count) => Array.from({ length: count }, (_, k) => add(
  scale(radius * Math.cos(k * Math.PI / (count - 1)), u), scale(radius * Math.sin(k * Math.PI / (count - 1)), v)));
const PLACES = {
  B: ({ axes }, count) => points(axes[1], scale(-1, axes[0]), OUTER, count),
  C: ({ axes }, count) => points(axes[1], scale(-1, axes[2]), INNER, count),
  // A point beside the axis about which the camera rotates.
  D: ({ D, at }) => [scale(0.3, D[at[2] === 0 ? 2 : 0])],
};
