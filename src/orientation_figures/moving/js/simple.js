import { AXES, IDENTITY, add, scale, simpleDcm } from './mathematics.js';
import { Sheet, button, change, choice, degrees, element, fixed, follow, followTurn, group, hats, liveText, numberTable,
  onceAFrame, open, plain, radians, readout, slider, stage, wrapped } from './shared.js';

const REACH = 1.25, SIZE = 112, FLAT = 84;   // REACH and SIZE as in simple.py
const [N, A] = ['n', 'a'].map(hats);
const STEP = radians(5);
const VANE = [[-0.72, 0.5], [-0.5, 0.36], [0.4, 0.36], [0.4, 0.46], [0.68, 0.3], [0.4, 0.14], [0.4, 0.24], [-0.5, 0.24], [-0.72, 0.1], [-0.62, 0.3]];
const number = (value) => fixed(value).trim();

// One turn about a unit vector that two frames share: in space, down that vector, and as a matrix.
export function render({ model, el }) {
  let lit = null;   // the number that is touched: [row, column]
  const light = (i, j) => {
    lit = i === undefined ? null : [i, j];
    redraw();
  };
  const shared = () => AXES.indexOf(model.get('axis'));
  const turnTo = (angle) => change(model, { angle: wrapped(angle) });
  const grab = (sheet) => (part, at) => {
    if (!part) return null;
    const follower = followTurn(sheet, { axis: IDENTITY[shared()], arm: IDENTITY[part], angle: model.get('angle'), at });
    return (to) => turnTo(follower(to));
  };
  const space = new Sheet({ bounds: [-180, -172, 180, 172], size: SIZE, changed: () => redraw(),
    name: 'Triads of the frames N and A, which share one unit vector, in space.', grab: (part, at) => grab(space)(part, at) });
  const flat = new Sheet({ bounds: [-135, -128, 135, 128], size: FLAT,
    name: 'The same, looking down the shared unit vector.', grab: (part, at) => grab(flat)(part, at) ?? (() => {}) });
  // This view stays: the arrow keys turn the frame instead.
  flat.svg.setAttribute('aria-label', 'The same, looking down the shared unit vector. The arrow keys turn A.');
  flat.look = () => {};
  flat.press = (event) => {
    const step = { ArrowLeft: STEP, ArrowUp: STEP, ArrowRight: -STEP, ArrowDown: -STEP }[event.key];
    if (!step) return;
    turnTo(model.get('angle') + step);
    event.preventDefault();
  };
  const redraw = onceAFrame(draw);

  const angle = slider({ symbol: '$\\theta$', name: 'theta', change: turnTo });
  const axis = choice({ name: 'Shared unit vector', options: [...AXES], change: (value) => change(model, { axis: value }) });
  const presets = [30, 90, 180].map((value) => button(`${value}°`, () => turnTo(radians(value)), { 'aria-label': `turn to ${value} degrees` }));
  const matrix = numberTable({ name: 'Direction cosine matrix of A with respect to N', kind: 'bracket', rows: A, columns: N,
    names: AXES.map((i) => AXES.map((j) => `a ${i} dot n ${j}`)), light });
  const text = liveText();
  open(el, stage(space, text),
    element('div', { class: 'controls' }, angle.element, group('Turn', 'row-of-controls', axis.element, ...presets)),
    element('div', { class: 'readouts' }, readout(['Direction cosine matrix ${}^A\\mathbf{C}^N$'], matrix.element), flat.svg));

  function draw() {
    const k = shared(), theta = model.get('angle');
    const now = { k, theta, dcm: simpleDcm(AXES[k], theta) };
    // The next two letters on the way round x, y, z, x: to the right and up.
    flat.view = [IDENTITY[(k + 1) % 3], IDENTITY[(k + 2) % 3], IDENTITY[k]];
    angle.show(theta);
    axis.show(AXES[k]);
    matrix.show(now.dcm.map((row) => row.map((entry) => fixed(entry))));
    for (const sheet of [space, flat]) sheet.draw(() => picture(sheet, now, lit));
    text.say(lit ? meaning(now, ...lit) : `$A$ is turned from $N$ through $\\theta$ = ${plain(degrees(theta))}° about ${N[k]} = ${A[k]}.`
      + ' Touch a number to see the shadow that it measures.');
  }

  draw();
  return follow(model, ['axis', 'angle'], redraw);
}

function picture(sheet, { k, theta, dcm }, lit) {
  const axis = IDENTITY[k], [i, j] = lit ?? [], pointer = dcm[(k + 1) % 3];
  sheet.faded = Boolean(lit);
  // The vane, upright on the shared unit vector; looking down that, it is seen edge on.
  sheet.area(VANE.map(([along, up]) => add(scale(along, pointer), scale(up, axis))), 'A', 26);
  sheet.triad('N', IDENTITY, { length: REACH });
  dcm.forEach((row, m) => { if (m !== k) sheet.arrow(row, { colour: 'A', label: A[m] }); });
  sheet.arrow(axis, { colour: 'A' });
  for (const m of [(k + 1) % 3, (k + 2) % 3]) {
    sheet.turn(axis, theta, IDENTITY[m], { radius: 0.5, label: '$\\theta$', colour: 'accent' });
    sheet.grip(dcm[m], String(m));
  }
  if (lit) {
    sheet.faded = false;
    sheet.layer = 1;
    sheet.arrow(scale(REACH, IDENTITY[j]), { colour: 'N', label: N[j] });
    sheet.arrow(dcm[i], { colour: 'A', label: A[i] });
    sheet.shadow(dcm[i], IDENTITY[j]);
  }
}

function meaning({ dcm }, i, j) {
  const value = dcm[i][j], between = degrees(Math.acos(Math.max(-1, Math.min(1, value))));
  return `Row ${AXES[i]}, column ${AXES[j]}: the shadow of ${A[i]} on the line of ${N[j]} is ${number(value)}, the cosine of the `
    + `${plain(between, 1)}° between them${value < -0.0005 ? ', and it falls on the far side' : ''}.`;
}
