import { AXES, IDENTITY, add, dot, gimbalLockMargin, length, multiply, PROPER_EULER, SEQUENCES, scale,
  simpleDcm, subtract } from './mathematics.js';
import { Sheet, button, change, choice, degrees, element, fixed, follow, followTurn, glide, group, hats, liveText,
  numberTable, onceAFrame, open, plain, put, radians, readout, slider, stage, turned, wrapped, write } from './shared.js';

// Radii of the rings of B and C, half the camera, where the axes end; as in gimbal.py.
const OUTER = 1.05, INNER = 0.76, CAMERA = [0.62, 0.44, 0.46], END = 1.42, SIZE = 98;
const BOUNDS = [-180, -185, 200, 185], INSET = [1.4, 1.1];   // the triads of A and D, right and up
const SYMBOLS = ['$\\psi$', '$\\theta$', '$\\varphi$'], NAMES = ['psi', 'theta', 'phi'];
const CLOSE = radians(10), LOCKED = radians(0.5);

// Everything that follows from the state: frames as rows along A, the three axes, the margin.
function device(angles, sequence) {
  const turns = angles.map((angle, k) => simpleDcm(sequence[k], angle));
  const A = IDENTITY, B = turns[0], C = multiply(turns[1], B), D = multiply(turns[2], C);
  const at = [...sequence].map((axis) => AXES.indexOf(axis));
  return { A, B, C, D, at, axes: [A[at[0]], B[at[1]], C[at[2]]], margin: gimbalLockMargin(angles, sequence),
    normals: [B[3 - at[0] - at[1]], C[3 - at[1] - at[2]]] };
}

export function render({ model, el }) {
  let lit = null, stop = () => {};
  const state = () => [model.get('angles'), model.get('sequence')];
  const setAngle = (k, angle) => {
    const angles = [...model.get('angles')];
    angles[k] = wrapped(angle);
    change(model, { angles });
  };
  const sheet = new Sheet({ bounds: BOUNDS, size: SIZE, camera: [58, 22], changed: () => redraw(),
    name: 'A camera gimbal: handgrip A, outer ring B, inner ring C, camera D.',
    grab(part, at) {
      if (!part) return null;
      stop();
      const [angles, order] = state(), gimbal = device(angles, order), k = 'BCD'.indexOf(part);
      const far = (point) => length(subtract(sheet.onSheet(point), at)) - 0.1 * dot(point, sheet.view[2]);
      const held = PLACES[part](gimbal, 360).reduce((best, point) => (far(point) < far(best) ? point : best));
      // Where that would be if this joint were at zero.
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
  const matrix = numberTable({ name: 'Direction cosine matrix of D with respect to A', kind: 'bracket', rows: hats('d'),
    columns: hats('a'), names: AXES.map((i) => AXES.map((j) => `d ${i} dot a ${j}`)),
    light(i, j) {
      lit = i === undefined ? null : [i, j];
      redraw();
    } });
  const bar = element('div', { class: 'bar', role: 'meter', 'aria-label': 'Margin to gimbal lock', 'aria-valuemin': '0',
    'aria-valuemax': '90' }, element('span'));
  const margin = element('span', { class: 'value' });
  const text = liveText();
  const more = model.get('more') !== false;
  open(el, stage(sheet, text), element('div', { class: 'readouts' }, ...(more ? [sequence.element] : []),
    element('div', { class: 'controls' }, ...sliders.map((one) => one.element),
      group('Move the gimbal', 'row-of-controls', ...(more ? buttons : buttons.slice(0, 1)))),
    readout(['Direction cosine matrix ${}^D\\mathbf{C}^A$'], matrix.element),
    ...(more ? [readout(['Margin to gimbal lock', margin], bar)] : [])));

  function draw() {
    const [angles, order] = state(), gimbal = device(angles, order), close = gimbal.margin < CLOSE;
    sliders.forEach((one, k) => {
      one.show(angles[k]);
      one.mark(close && k !== 1 ? 'same' : '');
    });
    sequence.show(order);
    matrix.show(gimbal.D.map((row) => row.map((entry) => fixed(entry))));
    const apart = plain(degrees(gimbal.margin), 1);
    write(margin, `${apart}°`);
    put(bar.firstChild, 'style', `width:${(apart / 0.9).toFixed(1)}%`);
    put(bar, 'aria-valuenow', apart);
    put(bar, 'aria-valuetext', `${apart} degrees`);
    sheet.draw(() => picture(sheet, gimbal, close, lit));
    text.say(lit ? inWords(gimbal.D, ...lit) : more ? situation(gimbal, apart) : 'Drag a ring or the camera. Touch a number to see what it measures.');
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

function situation({ axes, margin }, apart) {
  if (margin >= CLOSE) {
    return `The axes of $\\psi$ and $\\varphi$ are ${apart}° apart: three sliders turn the camera in three ways.`;
  }
  if (margin > LOCKED) {
    return `Close to gimbal lock: the axes of $\\psi$ and $\\varphi$ are ${apart}° apart, so these two sliders turn the camera about `
      + 'nearly the same line.';
  }
  return 'Gimbal lock: $\\psi$ and $\\varphi$ turn the camera about the same line, '
    + (dot(axes[0], axes[2]) > 0 ? 'the same way' : 'opposite ways')
    + `. Trade one for the other and the camera stands still. One way of turning is lost.`;
}

// Points at which the rings and the camera can be held.
const circle = (u, v, radius, count) => Array.from({ length: count }, (_, k) => add(
  scale(radius * Math.cos(2 * k * Math.PI / count), u), scale(radius * Math.sin(2 * k * Math.PI / count), v)));
const PLACES = {
  B: ({ B, at }, count) => circle(B[at[0]], B[at[1]], OUTER, count),
  C: ({ C, at }, count) => circle(C[at[1]], C[at[2]], INNER, count),
  // Beside the axis that the camera turns about.
  D: ({ D, at }) => [scale(0.3, D[at[2] === 0 ? 2 : 0])],
};

function picture(sheet, gimbal, close, lit) {
  const { A, B, C, D, at, axes, normals } = gimbal;
  const near = (direction) => (dot(direction, sheet.view[2]) < 0 ? -1 : 1);
  const pin = (axis, from, to, colour, layer) => {
    sheet.layer = layer * near(axis);
    sheet.line([scale(from, axis), scale(to, axis)], colour, 'tube slim');
  };
  const ring = (normal, radius, colour, layer) => {
    for (const [half, side] of [['back', -1], ['front', 1]]) {
      sheet.layer = layer * side;
      sheet.circle(normal, { radius, colour, kind: 'tube', half });
    }
  };
  const down = scale(-1, axes[0]);
  sheet.layer = 6 * near(down);
  sheet.cylinder(scale(1.3, down), scale(1.86, down), 0.13, 'A');
  sheet.cylinder(scale(1.13, down), scale(1.3, down), 0.2, 'A');
  ring(normals[0], OUTER, 'B', 5);
  ring(normals[1], INNER, 'C', 3);
  for (const side of [1, -1]) {
    pin(scale(side, axes[1]), INNER, OUTER, 'B', 4);
    // Not before the lens.
    if (side < 0 || at[2] !== 1) pin(scale(side, axes[2]), 0.2, INNER, 'C', 2);
  }
  // The lens looks along d_y, as in the essay.
  sheet.layer = 0;
  sheet.box(D, CAMERA, 'D');
  sheet.layer = 0.5 * near(D[1]);
  sheet.cylinder(scale(CAMERA[1] / 2, D[1]), scale(0.5, D[1]), 0.15, 'D');
  if (near(D[1]) > 0) {
    sheet.layer = 0.6;
    sheet.circle(D[1], { radius: 0.09, origin: scale(0.5, D[1]), colour: 'D', kind: 'fill-38' });
  }

  // The axes, outside of what they carry.
  const before = [A, B, C];
  axes.forEach((axis, k) => {
    const same = close && k !== 1, colour = same ? 'accent' : 'ink', rest = before[k][at[k === 2 ? 1 : k + 1]];
    for (const side of [1, -1]) {
      sheet.layer = 7 * near(scale(side, axis));
      const begin = (k === 2 ? INNER : OUTER) + 0.1;
      sheet.line([scale(side * begin, axis), scale(side * END, axis)], colour, same ? 'thick' : 'guide');
    }
    // At lock the names of the two axes stand side by side, also where the axes point opposite ways.
    const end = scale(same && dot(axis, axes[0]) < 0 ? -END : END, axis);
    sheet.layer = 7 * near(end);
    sheet.turn(axis, 4.4, rest, { radius: 0.16, origin: scale(0.9, end), colour });   // which way is positive
    const place = sheet.onSheet(end), out = Math.hypot(...place);
    const outward = out > 20 ? scale(17 / out, place) : [16, -16];
    sheet.label(end, SYMBOLS[k], colour, same && k === 2 ? add(outward, [22, 0]) : outward);
  });
  sheet.layer = 8;
  if (close) sheet.line([scale(-END, axes[0]), scale(END, axes[0])], 'accent', 'guide');

  sheet.label(scale(1.62, down), '$A$', 'A', [24, 4]);
  sheet.labelBeyond(scale(OUTER, add(scale(0.64, B[at[0]]), scale(0.77, B[at[1]]))), '$B$', 'B', 20);
  sheet.labelBeyond(scale(INNER, add(scale(0.71, C[at[1]]), scale(-0.71, C[at[2]]))), '$C$', 'C', 20);
  sheet.labelBeyond(scale(0.26, D[2]), '$D$', 'D', 14);

  // The triads of A and D, which the matrix compares.
  const corner = add(scale(INSET[0], sheet.view[0]), scale(INSET[1], sheet.view[1]));
  for (const [letter, rows, index, reach] of [['A', A, 1, 0.54], ['D', D, 0, 0.3]]) {
    rows.forEach((row, k) => {
      sheet.faded = lit !== null && lit[index] !== k;
      sheet.arrow(add(corner, scale(reach, row)), { start: corner, colour: letter, size: 17,
        label: `$\\hat{${letter.toLowerCase()}}_${AXES[k]}$` });
    });
  }
  sheet.faded = false;
  sheet.gripLine(PLACES.B(gimbal, 40), 'B');
  sheet.gripLine(PLACES.C(gimbal, 40), 'C');
  sheet.grip(PLACES.D(gimbal)[0], 'D', 22);
}
