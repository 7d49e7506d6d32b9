import { AXES, degrees, IDENTITY, radians, scale, simpleDcm, wrapped } from './mathematics.js';
import { picture, REACH, SIZE } from './simple_picture.js';
import { button, change, choice, element, fixed, follow, followTurn, group, liveText, numberTable, onceAFrame,
  open, plain, plainDegrees, readout, Sheet, slider, stage } from './shared.js';
import { hatted } from './words_picture.js';

const FLAT = 84;
const [N, A] = ['n', 'a'].map(hatted);
const STEP = radians(5);
const number = (value) => fixed(value).trim();

// One rotation about a unit vector that two frames share: in space, down that vector, and as a matrix.
export function render({ model, el }) {
  let lit = null;   // the number that the reader touches: [row, column]
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
  // This view is fixed, so the arrow keys rotate the frame instead.
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
    // The next two letters in the cycle x, y, z, x point to the right and up.
    flat.view = [IDENTITY[(k + 1) % 3], IDENTITY[(k + 2) % 3], IDENTITY[k]];
    angle.show(theta);
    axis.show(AXES[k]);
    matrix.show(now.dcm.map((row) => row.map((entry) => fixed(entry))));
    for (const sheet of [space, flat]) sheet.draw(() => drawn(sheet, now, lit));
    text.say(lit ? meaning(now, ...lit) : `$A$ is turned from $N$ through $\\theta$ = ${plainDegrees(theta)} about ${N[k]} = ${A[k]}.`
      + ' Touch a number to see the shadow that it measures.');
  }

  draw();
  return follow(model, ['axis', 'angle'], redraw);
}

function drawn(sheet, { k, theta, dcm }, lit) {
  const [i, j] = lit ?? [];
  sheet.faded = Boolean(lit);
  picture(sheet, k, theta, dcm);
  for (const m of [(k + 1) % 3, (k + 2) % 3]) sheet.grip(dcm[m], String(m));
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
