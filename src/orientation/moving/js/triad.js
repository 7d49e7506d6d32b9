import { AXES, IDENTITY, add, bodyFixedFromDcm, cross, dcmFromAxisAngle, dcmFromBodyFixed, dot, length,
  quaternionFromAxisAngle, SEQUENCES, scale, simpleDcm, multiply, subtract, unit } from './mathematics.js';
import { Sheet, button, change, choice, degrees, element, fixed, follow, followSphere, followTurn, group, liveText, numberField,
  numberTable, onceAFrame, open, plain, slider, wrapped } from './shared.js';

const REACH = 1.25;
const ANGLES = ['$\\psi$', '$\\theta$', '$\\varphi$'];

export function render({ model, el }) {
  const state = () => ({ axis: model.get('axis'), angle: model.get('angle'), sequence: model.get('sequence') });
  let lit = null;   // what a touched number means: { kind, i, j }
  let typed = null;

  const sheet = new Sheet({ bounds: [-180, -180, 180, 180], changed: () => redraw(),
    name: 'Triads of the frames N and A from one origin; A is turned about the unit vector e.',
    grab(part, at) {
      const { axis, angle } = state();
      if (part === 'axis') {
        const follower = followSphere(sheet, { vector: scale(REACH, axis), at });
        return (to) => change(model, { axis: follower(to) });
      }
      if (part) {
        const follower = followTurn(sheet, { axis, arm: IDENTITY[part], angle, at });
        return (to) => change(model, { angle: wrapped(follower(to)) });
      }
      return null;
    } });
  const redraw = onceAFrame(draw);
  const light = (kind) => (i, j) => { lit = i === undefined ? null : { kind, i, j }; redraw(); };

  const angle = slider({ symbol: '$\\theta$', name: 'theta', change: (value) => change(model, { angle: value }) });
  const fields = AXES.map((name, k) => numberField({ name: `${name} component of the axis`, change(value) {
    typed[k] = value;
    if (length(typed) > 0) change(model, { axis: unit(typed) });
    else text.say('A zero vector points nowhere: give the axis at least one component that is not zero.');
  } }));
  const presets = [['$\\hat{n}_x$', [1, 0, 0]], ['$\\hat{n}_y$', [0, 1, 0]], ['$\\hat{n}_z$', [0, 0, 1]], ['(1, 1, 1)', [1, 1, 1]]]
    .map(([name, axis]) => button(name, () => { typed = axis.slice(); change(model, { axis: unit(axis) }); fields.forEach((f, k) => f.show(axis[k])); }));

  const matrix = numberTable({ name: 'Direction cosine matrix of A with respect to N', kind: 'bracket', light: light('matrix'),
    names: AXES.map((i) => AXES.map((j) => `a ${i} dot n ${j}`)) });
  const euler = numberTable({ name: 'Euler angles in degrees', names: [['psi', 'theta', 'phi']], light: light('euler') });
  const axisAngle = numberTable({ name: 'Axis and angle', names: [['e x', 'e y', 'e z', 'theta']], light: light('axis') });
  const quaternion = numberTable({ name: 'Quaternion, scalar first', names: [['q 0', 'q i', 'q j', 'q k']], light: light('quaternion') });
  const sequence = choice({ name: 'Sequence', options: SEQUENCES, change: (value) => change(model, { sequence: value }) });
  const text = liveText();

  const title = (words) => element('p', { class: 'title' }, words);
  open(el, sheet.svg,
    element('div', { class: 'controls readouts' },
      title('Direction cosine matrix ${}^A\\mathbf{C}^N$'), matrix.element,
      title('Euler angles'), sequence.element, euler.element,
      title('Axis and angle'), axisAngle.element, title('Quaternion'), quaternion.element),
    element('div', { class: 'controls' }, angle.element,
      group('Axis', 'row-of-controls', element('span', { class: 'symbol' }, '$\\hat{e}$'), ...fields.map((field) => field.element), ...presets)),
    text.element);

  function draw() {
    const { axis, angle: theta, sequence: order } = state(), dcm = dcmFromAxisAngle(axis, theta);
    if (!typed || length(subtract(unit(typed), axis)) > 1e-9) { typed = [...axis]; fields.forEach((field, k) => field.show(axis[k])); }
    angle.show(theta);
    sequence.show(order);
    matrix.show(dcm.map((row) => row.map((entry) => fixed(entry))));
    euler.show([bodyFixedFromDcm(dcm, order).map((entry) => `${fixed(degrees(entry), 1)}°`)]);
    axisAngle.show([[...axis.map((entry) => fixed(entry)), `${fixed(degrees(theta), 1)}°`]]);
    quaternion.show([quaternionFromAxisAngle(axis, theta).map((entry) => fixed(entry))]);
    sheet.draw(() => picture(axis, theta, dcm));
    text.say(`$A$ is turned from $N$ through $\\theta$ = ${plain(degrees(theta))}° about $\\hat{e}$.`);
  }

  function picture(axis, theta, dcm) {
    sheet.line([scale(-1, axis), axis], 'accent', 'guide');
    for (const start of IDENTITY) {
      const foot = scale(dot(start, axis), axis), arm = subtract(start, foot);
      if (length(arm) > 1e-6) sheet.turn(axis, theta, arm, { radius: length(arm), origin: foot, colour: 'muted', head: false });
    }
    sheet.triad('N', IDENTITY, { reach: REACH });
    sheet.arrow(scale(REACH, axis), { colour: 'accent', label: '$\\hat{e}$' });
    sheet.triad('A', dcm);
    dcm.forEach((row, k) => sheet.grip(row, String(k)));
    sheet.grip(scale(REACH, axis), 'axis');
  }

  draw();
  return follow(model, ['axis', 'angle', 'sequence'], redraw);
}
