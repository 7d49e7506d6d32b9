import { AXES, bodyFixedFromDcm, dcmFromAxisAngle, degrees, dot, gimbalLockMargin, IDENTITY, length,
  multiply, quaternionFromAxisAngle, radians, scale, SEQUENCES, simpleDcm, subtract, unit, wrapped } from './mathematics.js';
import { around } from './common_picture.js';
import { KNOB, picture, REACH, SIZE } from './triad_picture.js';
import { button, change, choice, element, fixed, follow, followSphere, followTurn, group, liveText,
  numberField, numberTable, onceAFrame, open, plainDegrees, readout, Sheet, slider, stage } from './shared.js';
import { hatted, turned } from './words_picture.js';

const ANGLES = ['$\\psi$', '$\\theta$', '$\\varphi$'];
const [N, A] = ['n', 'a'].map(hatted);
const number = (value, digits = 3) => fixed(value, digits).trim();
const inDegrees = (angle) => `${number(degrees(angle), 1)}°`;

export function render({ model, el }) {
  let lit = null;   // the number that the reader touches: { kind, i, j }
  let typed = [0, 0, 0];   // the axis as the reader entered it, of any length

  const light = (kind) => (i, j) => {
    lit = i === undefined ? null : { kind, i, j };
    redraw();
  };
  const turnTo = (angle) => change(model, { angle });
  const pointTo = (axis) => change(model, { axis });
  const sheet = new Sheet({ bounds: [-180, -172, 180, 172], size: SIZE, changed: () => redraw(),
    name: 'Triads of the frames N and A from one origin; A is turned about the unit vector e.',
    grab(part, at) {
      const axis = model.get('axis');
      if (part === 'axis') {
        const direction = followSphere(sheet, { vector: scale(KNOB, axis), at });
        return (to) => pointTo(direction(to));
      }
      if (!part) return null;
      const follower = followTurn(sheet, { axis, arm: IDENTITY[part], angle: model.get('angle'), at });
      return (to) => turnTo(wrapped(follower(to)));
    } });
  const redraw = onceAFrame(draw);

  const angle = slider({ symbol: '$\\theta$', name: 'theta', change: turnTo });
  const fields = AXES.map((axis, k) => numberField({ name: `${axis} component of the axis`, change(value) {
    typed[k] = value;
    if (length(typed) > 0) pointTo(unit(typed));
    else text.say('A zero vector has no direction: at least one component of the axis must differ from zero.');
  } }));
  const presets = [...IDENTITY, [1, 1, 1]].map((axis, k) => button(N[k] ?? '(1, 1, 1)', () => pointTo(unit(axis)),
    { 'aria-label': k < 3 ? `axis n ${AXES[k]}` : 'axis 1, 1, 1' }));
  const matrix = numberTable({ name: 'Direction cosine matrix of A with respect to N', kind: 'bracket', rows: A, columns: N,
    names: AXES.map((i) => AXES.map((j) => `a ${i} dot n ${j}`)), light: light('matrix') });
  const euler = numberTable({ name: 'Euler angles', columns: ANGLES, names: [['psi', 'theta', 'phi']], light: light('euler') });
  const axisAngle = numberTable({ name: 'Axis and angle', columns: ['$e_x$', '$e_y$', '$e_z$', '$\\theta$'],
    names: [['e x', 'e y', 'e z', 'theta']], light: light('axis') });
  const quaternion = numberTable({ name: 'Quaternion, scalar first', columns: ['$q_0$', '$q_i$', '$q_j$', '$q_k$'],
    names: [['q 0', 'q i', 'q j', 'q k']], light: light('quaternion') });
  const sequence = choice({ name: 'Sequence of the Euler angles', hidden: true, options: SEQUENCES,
    change: (value) => change(model, { sequence: value }) });
  const text = liveText();
  open(el, stage(sheet, text),
    element('div', { class: 'controls' }, angle.element,
      group('Axis', 'row-of-controls', element('span', { class: 'symbol', 'aria-hidden': 'true' }, '$\\hat{e}$'),
        ...fields.map((field) => field.element), ...presets)),
    element('div', { class: 'readouts' },
      readout(['Direction cosine matrix ${}^A\\mathbf{C}^N$'], matrix.element),
      ...(model.get('more') !== false ? [readout(['Euler angles', sequence.element], euler.element),
        readout(['Axis and angle'], axisAngle.element), readout(['Quaternion'], quaternion.element)] : [])));

  function draw() {
    const now = { axis: model.get('axis'), angle: model.get('angle'), sequence: model.get('sequence') };
    now.dcm = dcmFromAxisAngle(now.axis, now.angle);
    now.euler = bodyFixedFromDcm(now.dcm, now.sequence);
    now.quaternion = quaternionFromAxisAngle(now.axis, now.angle);
    if (length(subtract(unit(typed), now.axis)) > 1e-9) typed = [...now.axis];
    fields.forEach((field, k) => field.show(typed[k]));
    angle.show(now.angle);
    sequence.show(now.sequence);
    matrix.show(now.dcm.map((row) => row.map((entry) => fixed(entry))));
    euler.show([now.euler.map((entry) => `${fixed(degrees(entry), 1)}°`)]);
    axisAngle.show([[...now.axis.map((entry) => fixed(entry)), `${fixed(degrees(now.angle), 1)}°`]]);
    quaternion.show([now.quaternion.map((entry) => fixed(entry))]);
    const meaning = lit && MEANINGS[lit.kind](now, lit.i, lit.j);
    sheet.draw(() => {
      sheet.faded = Boolean(meaning);
      picture(sheet, now.axis, now.angle, now.dcm);
      sheet.faded = false;
      now.dcm.forEach((row, k) => sheet.grip(row, String(k)));
      sheet.grip(scale(KNOB, now.axis), 'axis');
      sheet.layer = 1;
      meaning?.draw(sheet);
    });
    text.say(meaning?.words ?? `$A$ is turned from $N$ through $\\theta$ = ${plainDegrees(now.angle)} about $\\hat{e}$ = `
      + `(${now.axis.map((entry) => number(entry)).join(', ')}). Touch a number to see what it means.`);
  }

  draw();
  return follow(model, ['axis', 'angle', 'sequence'], redraw);
}

// What each number means, in words, and what to highlight in the drawing.
const MEANINGS = {
  matrix({ dcm }, i, j) {
    const value = dcm[i][j], between = Math.acos(Math.max(-1, Math.min(1, value)));
    return {
      words: `Row ${AXES[i]}, column ${AXES[j]}: ${A[i]} · ${N[j]} = cos ${inDegrees(between)} = ${number(value)}. `
        + `It is the shadow of ${A[i]} on the line of ${N[j]}${value < -0.0005 ? ', which falls on the far side' : ''}.`,
      draw(sheet) {
        sheet.arrow(scale(REACH, IDENTITY[j]), { colour: 'N', label: N[j] });
        sheet.arrow(dcm[i], { colour: 'A', label: A[i] });
        sheet.shadow(dcm[i], IDENTITY[j]);
        sheet.arc(IDENTITY[j], dcm[i], { radius: 0.36, head: false });
      },
    };
  },

  euler({ euler, sequence, dcm }, _, k) {
    const turns = [...sequence].map((axis, n) => simpleDcm(axis, euler[n]));
    const before = turns.slice(0, k).reduce((frame, turn) => multiply(turn, frame), IDENTITY);
    const after = multiply(turns[k], before), axis = before[AXES.indexOf(sequence[k])];
    const margin = gimbalLockMargin(euler, sequence);
    const about = [`${N[AXES.indexOf(sequence[0])]}`, `the ${sequence[1]} unit vector, as the first rotation left it`,
      `${A[AXES.indexOf(sequence[2])]}, where the first two rotations put it`][k];
    return {
      words: `${ANGLES[k]} = ${inDegrees(euler[k])}: the ${['first', 'second', 'third'][k]} rotation, about ${about}.`
        + (margin < radians(1) ? ' Here this sequence is at gimbal lock: the first and the third rotation have the same axis.' : ''),
      draw(sheet) {
        const frame = (rows, letter) => (letter ? sheet.triad(letter, rows, { length: letter === 'N' ? REACH : 1 })
          : rows.forEach((row) => sheet.arrow(row, { colour: 'muted' })));
        frame(before, k === 0 ? 'N' : '');
        frame(after, k === 2 ? 'A' : '');
        sheet.line([scale(-1, axis), scale(REACH, axis)], 'accent', 'guide');
        sheet.arrow(axis, { colour: 'accent' });
        before.forEach((row) => around(sheet, axis, euler[k], scale(0.8, row), { head: true, colour: 'accent', kind: 'thick' }));
        const clear = before.find((row) => Math.abs(dot(row, axis)) < 0.5);
        sheet.turn(axis, euler[k], clear, { radius: 0.8, label: ANGLES[k], colour: 'accent', kind: 'thick' });
      },
    };
  },

  axis({ axis, angle }, _, k) {
    if (k === 3) {
      return { words: `$\\theta$ = ${inDegrees(angle)}: the angle of the one rotation about $\\hat{e}$ that brings $N$ to $A$.`,
        draw: (sheet) => angleAbout(sheet, axis, angle, '$\\theta$') };
    }
    return {
      words: `$e_${AXES[k]}$ = ${number(axis[k])}: the shadow of $\\hat{e}$ on the line of ${N[k]}. On the line of ${A[k]} it is `
        + 'equally long, because the rotation leaves its own axis where it is.',
      draw(sheet) {
        sheet.arrow(scale(REACH, IDENTITY[k]), { colour: 'N', label: N[k] });
        sheet.arrow(axis, { colour: 'accent' });
        sheet.shadow(axis, IDENTITY[k]);
      },
    };
  },

  quaternion({ axis, angle, quaternion }, _, k) {
    const half = angle / 2, sine = Math.sin(half);
    if (k === 0) {
      return {
        words: `$q_0$ = cos($\\theta/2$) = cos ${inDegrees(half)} = ${number(quaternion[0])}: the cosine of half the angle.`,
        draw(sheet) {
          angleAbout(sheet, axis, angle, '$\\theta$', { colour: 'muted' });
          angleAbout(sheet, axis, half, '$\\theta/2$', { radius: 0.65, kind: 'thick' });
        },
      };
    }
    return {
      words: `$q_${'0ijk'[k]}$ = sin($\\theta/2$) $e_${AXES[k - 1]}$ = ${number(sine)} · ${number(axis[k - 1])} = `
        + `${number(quaternion[k])}: the shadow of sin($\\theta/2$) $\\hat{e}$ on the line of ${N[k - 1]}.`,
      draw(sheet) {
        sheet.arrow(scale(REACH, IDENTITY[k - 1]), { colour: 'N', label: N[k - 1] });
        angleAbout(sheet, axis, half, '$\\theta/2$', { radius: 0.65, kind: 'thick' });
        sheet.arrow(scale(sine, axis), { colour: 'accent' });
        sheet.shadow(scale(sine, axis), IDENTITY[k - 1]);
      },
    };
  },
};

// Draw an angle about the axis, from the unit vector of N that moves most to where it goes.
function angleAbout(sheet, axis, angle, label, { radius = 0.95, colour = 'accent', kind = '' } = {}) {
  const far = axis.map(Math.abs), k = far.indexOf(Math.min(...far));
  const arm = scale(radius + 0.1, unit(subtract(IDENTITY[k], scale(dot(IDENTITY[k], axis), axis))));
  sheet.arrow(axis, { colour: 'accent' });
  for (const side of [arm, turned(axis, angle, arm)]) sheet.line([[0, 0, 0], side], colour, 'guide');
  sheet.turn(axis, angle, arm, { radius, label, colour, kind });
}
