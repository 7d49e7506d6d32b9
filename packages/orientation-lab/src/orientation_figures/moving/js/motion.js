import { add, angularAcceleration, angularVelocityMatrix, AXES, axisAngleFromDcm, bodyFixedFromDcm,
  cross, dcmFromBodyFixed, dcmFromQuaternion, dcmFromRotationVector, dcmRate, degrees, dot,
  gimbalLockMargin, IDENTITY, length, multiply, multiplyQuaternions, nearestDcm,
  quaternionFromAxisAngle, quaternionRate, scale, solve, times, transpose, unit } from './mathematics.js';
import { across, axes, bodyOf, COLOURS, down, ERROR, FAULT, LEFT, MARGIN, MOMENTS, picture, RIGHT,
  ROUNDING, SAMPLE, SECONDS, SIZE } from './motion_picture.js';
import { button, change, choice, element, follow, group, liveText, onceAFrame, open, plain, player,
  put, Sheet, slider, stage, write, writeWords } from './shared.js';

const DESCRIPTIONS = { matrix: 'Matrix', quaternion: 'Quaternion', angles: 'Euler angles' };
const SPIN = 4, FINER = 10, LARGEST = 1e4;

// ---- the integration -----------------------------------------------------------------------------------

// A reference is the angular velocity along A and a quaternion, computed in fine steps. A state is a quaternion, the
// nine entries of a matrix row by row and three Euler angles zxy, driven by the reference's angular velocity.
const angleRates = (angles, omega) => solve(angularVelocityMatrix(angles, 'zxy'), omega);

// Take one Runge-Kutta step, with a function for the slope at each stage.
function rungeKutta(state, step, slopes) {
  const beyond = (far, slope) => state.map((value, k) => value + far * slope[k]);
  const first = slopes[0](state), second = slopes[1](beyond(step / 2, first)), third = slopes[1](beyond(step / 2, second));
  const fourth = slopes[2](beyond(step, third));
  return beyond(step / 6, first.map((a, k) => a + 2 * second[k] + 2 * third[k] + fourth[k]));
}

const fine = (reference, step, moments) => {
  const slope = (at) => [...angularAcceleration(at, moments), ...quaternionRate(at.slice(3, 7), at)];
  const [x, y, z, ...quaternion] = rungeKutta(reference, step, [slope, slope, slope]);
  return [x, y, z, ...unit(quaternion)];
};

const rates = (state, omega) => [...quaternionRate(state.slice(0, 4), omega), ...dcmRate(rowsOf(state.slice(4, 13)), omega).flat(),
  ...angleRates(state.slice(13), omega)];

// Return a fourth-order step's rotation vector (Magnus), from the angular velocity at its two Gauss points.
const GAUSS = [0.5 - Math.sqrt(3) / 6, 0.5 + Math.sqrt(3) / 6];
function turnOf(step, moments, references) {
  const [one, other] = GAUSS.map((point) => {
    const before = Math.floor(FINER * point), slope = (at) => angularAcceleration(at, moments);
    return rungeKutta(references[before].slice(0, 3), step * (point - before / FINER), [slope, slope, slope]);
  });
  return add(scale(step / 2, add(one, other)), scale(Math.sqrt(3) / 12 * step * step, cross(one, other)));
}

// Return the state one step later; the references are those of the finer steps in between.
export function stepped(state, step, method, moments, references) {
  const slopes = [0, FINER / 2, FINER].map((k) => (at) => rates(at, references[k].slice(0, 3)));
  if (method === 'Euler') {
    const slope = slopes[0](state);
    return state.map((value, k) => value + step * slope[k]);
  }
  const later = rungeKutta(state, step, slopes);
  if (method !== 'exponential') return later;
  const turn = turnOf(step, moments, references), angle = length(turn);   // Euler angles have no such step
  return [...multiplyQuaternions(state.slice(0, 4), angle ? quaternionFromAxisAngle(turn, angle) : [1, 0, 0, 0]),
    ...multiply(dcmFromRotationVector(turn), rowsOf(state.slice(4, 13))).flat(), ...later.slice(13)];
}

const rowsOf = (list) => [list.slice(0, 3), list.slice(3, 6), list.slice(6, 9)];

// The matrix of each description; that of a quaternion is orthogonal up to the factor |q|^2.
const MATRICES = { matrix: (state) => rowsOf(state.slice(4, 13)), quaternion: (state) => dcmFromQuaternion(state.slice(0, 4)),
  angles: (state) => dcmFromBodyFixed(state.slice(13), 'zxy') };

export const fault = (matrix) => Math.max(...multiply(matrix, transpose(matrix)).flatMap(
  (row, i) => row.map((entry, j) => Math.abs(entry - (i === j)))));

export function error(matrix, truth) {
  const { dcm } = nearestDcm(multiply(matrix, transpose(truth)));
  return dcm ? axisAngleFromDcm(dcm)[1] : NaN;
}

// A run is computed step by step as far as requested, and keeps its results.
export class Run {
  constructor({ moments, axis, disturbance, method, step, restored }) {
    Object.assign(this, { step, method, restored, moments, axis: AXES.indexOf(axis) });
    const omega = AXES.map((letter) => (letter === axis ? SPIN : disturbance));
    this.momentum = unit(omega.map((entry, k) => entry * this.moments[k]));
    this.states = [[1, 0, 0, 0, ...IDENTITY.flat(), 0, 0, 0]];
    this.references = [[...omega, 1, 0, 0, 0]];
    this.flips = [];   // the steps after which the spin axis has flipped
    this.every = Math.max(1, Math.round(SAMPLE / step));
    this.curves = new Map();   // path data that grow with every sample
    this.margin = 90;
    this.side = 1;
    this.sample();
  }

  get last() { return this.states.length - 1; }

  next() {
    const references = [this.references[this.last]];
    for (let k = 0; k < FINER; k += 1) references.push(fine(references[k], this.step / FINER, this.moments));
    const state = stepped(this.states[this.last], this.step, this.method, this.moments, references);
    if (!state.slice(0, 13).every((entry) => Math.abs(entry) < LARGEST) || !state.every(Number.isFinite)) {
      this.ended = true;
      return;
    }
    if (this.restored) state.splice(0, 13, ...unit(state.slice(0, 4)), ...nearestDcm(MATRICES.matrix(state)).dcm.flat());
    this.states.push(state);
    this.references.push(references[FINER]);
    const side = Math.sign(dot(this.truth(this.last)[this.axis], this.momentum));
    if (side !== this.side) this.flips.push(this.last);
    this.side = side;
    this.sample();
  }

  truth(k) { return dcmFromQuaternion(this.references[k].slice(3)); }

  // Return the reference's margin to gimbal lock, in degrees.
  marginAt(k) { return degrees(gimbalLockMargin(bodyFixedFromDcm(this.truth(k), 'zxy'), 'zxy')); }

  faultAt(k, name) { return fault(MATRICES[name](this.states[k])); }

  errorAt(k, name) { return error(MATRICES[name](this.states[k]), this.truth(k)); }

  sample() {
    const k = this.last;
    this.margin = Math.min(this.margin, this.marginAt(k));
    if (k % this.every) return;
    const log = (value) => Math.log10(Math.max(value, ROUNDING));
    for (const name of Object.keys(DESCRIPTIONS)) {
      this.extend(`fault ${name}`, FAULT, log(this.faultAt(k, name)));
      this.extend(`error ${name}`, ERROR, log(this.errorAt(k, name)));
    }
    this.extend('margin', MARGIN, this.margin);
    this.margin = 90;
  }

  extend(name, part, value) {
    const data = this.curves.get(name) ?? '';
    this.curves.set(name, `${data}${data ? 'L' : 'M'}${across(this.step * this.last).toFixed(1)} ${down(part, value).toFixed(1)}`);
  }
}

// ---- words ---------------------------------------------------------------------------------------------

// Format a number with two digits: '0.0023', '4.1 × 10⁻⁷'.
function power(value) {
  if (!(value >= ROUNDING)) return Number.isNaN(value) ? '–' : '< 10⁻¹⁵';
  if (value >= 0.001 && value < 1000) return String(Number(value.toPrecision(2)));
  const [mantissa, exponent] = value.toExponential(1).split('e');
  return `${mantissa}\u2009×\u200910${[...exponent.replace('+', '')].map((sign) => '⁻⁰¹²³⁴⁵⁶⁷⁸⁹'['-0123456789'.indexOf(sign)]).join('')}`;
}

const often = (count, middle) => [middle ? 'has not flipped yet' : 'does not flip', 'has flipped once', 'has flipped twice'][count] ?? `has flipped ${count} times`;

// Compare the moment of one axis with the two others.
function rank(moments, k) {
  const smaller = moments.filter((moment) => moment < moments[k]).length, larger = moments.filter((moment) => moment > moments[k]).length;
  if (smaller === 1 && larger === 1) return 'middle moment';
  if (smaller + larger < 2) return 'equal to another';
  return `${smaller ? 'largest' : 'smallest'} moment`;
}

const listed = (moments) => `${moments.map((moment) => plain(moment)).join(', ')} g\u202fm²`;

// Say why no body has these moments of inertia, or return ''.
function impossible(moments) {
  const largest = Math.max(...moments), others = moments.reduce((sum, moment) => sum + moment) - largest;
  return largest <= others + 1e-9 ? '' : `No body has the moments of inertia ${listed(moments)}: the largest, ${
    plain(largest)}, is more than the sum of the others, ${plain(others)}.`;
}

// ---- the figure ----------------------------------------------------------------------------------------

const SETTINGS = ['moments', 'axis', 'disturbance', 'method', 'step', 'restored'];

export function render({ model, el }) {
  const alone = `description-${Math.random()}`;   // the buttons of one figure exclude only each other
  let run, made = '', refused = null;   // moments that the reader has set but no body has

  const sheet = new Sheet({ bounds: [-180, -150, 180, 150], size: SIZE, changed: () => redraw(),
    name: 'The tumbling body with its triad A, drawn from the computed numbers. Dashed: the reference. H: the angular momentum.' });
  const plot = new Sheet({ name: '', bounds: [-180, 0, 180, 356], grab(part, at) {
    const scrub = (to) => {
      clock.pause();
      clock.set(Math.max(0, Math.min(SECONDS, SECONDS * (to[0] - LEFT) / (RIGHT - LEFT))));
    };
    scrub(at);
    return scrub;
  } });
  // The plot needs no keys of its own, because the time slider does with keys what dragging does here.
  plot.svg.removeAttribute('tabindex');
  plot.svg.removeAttribute('aria-roledescription');
  put(plot.svg, 'role', 'img');
  put(plot.svg, 'class', 'sheet plot');
  put(plot.svg, 'aria-label', 'Plots over time of how far each description departs from orthogonality, of its error relative to the reference, '
    + 'both on logarithmic scales, and of the margin to gimbal lock. The table gives the values at the chosen time.');
  const redraw = onceAFrame(draw);

  const clock = player({ name: 'Time', seconds: SECONDS, show: (time) => change(model, { time }) });
  const reset = button('Reset', () => { clock.pause(); made = ''; clock.set(0); redraw(); });
  const setMoments = (moments) => {
    refused = impossible(moments) ? moments : null;
    if (!refused) change(model, { moments });
    redraw();
  };
  const moments = AXES.map((name, k) => slider({ symbol: `$I_${name}$`, name: `Moment of inertia about ${name}`, unit: 'gram square metres',
    sign: ' g\u202fm²', factor: 1, min: 0.1, max: 20, step: 0.1, more: () => '',
    change: (value) => setMoments((refused ?? model.get('moments')).map((old, n) => (n === k ? value : old))) }));
  const bodies = group('Moments of inertia', 'row-of-controls', element('span', { 'aria-hidden': 'true' }, 'Moments of inertia of'),
    ...[['racket', 'a racket'], ['book', 'a book']].map(([name, title]) => button(title, () => setMoments(MOMENTS[name]))));
  const axis = choice({ name: 'Spin about', options: AXES.map((name) => [name, '']), change: (value) => change(model, { axis: value }) });
  const ranks = axis.element.querySelectorAll('option');
  const method = choice({ name: 'Method', options: ['Euler', ['Runge-Kutta', 'Runge–Kutta, fourth order'],
    ['exponential', 'Exponential, fourth order']],
    change: (value) => change(model, { method: value }) });
  const step = slider({ symbol: '', name: 'Step', unit: 'milliseconds', sign: ' ms', factor: 0.001, min: 5, max: 100, step: 5, more: () => '',
    change: (value) => change(model, { step: value }) });
  const disturbance = slider({ symbol: '', name: 'Disturbance', unit: 'radians per second', sign: ' rad/s', factor: 1, min: 0, max: 0.5, step: 0.01,
    more: () => '', change: (value) => change(model, { disturbance: value }) });
  const restored = element('input', { type: 'checkbox', change: () => change(model, { restored: restored.checked }) });
  const named = (name, control) => element('div', { class: 'named' }, element('span', { 'aria-hidden': 'true' }, name), control.element);
  const rows = Object.entries(DESCRIPTIONS).map(([name, title]) => {
    const pick = element('input', { type: 'radio', name: alone, value: name,
      change: () => change(model, { description: name }) });
    const [faulty, wrong] = [element('td'), element('td')];
    return { name, pick, faulty, wrong, element: element('tr', {}, element('th', { scope: 'row' }, element('label', {}, pick,
      element('svg', { class: 'swatch', viewBox: '0 0 34 10', 'aria-hidden': 'true' }, element('path', { class: `axis ${COLOURS[name]}`, d: 'M2 5H32' })),
      element('span', {}, title))), faulty, wrong) };
  });
  const heads = ['Drawn', 'departure from orthogonality', 'error (rad)'].map((text) => element('th', { scope: 'col' }, text));
  const aside = element('p', { class: 'aside' }), text = liveText();

  // The clock is beside the drawing, so that it stays in view with it on a phone.
  const left = stage(sheet, text);
  left.append(element('div', { class: 'clock' }, clock.element, reset));
  const figure = open(el, left,
    element('div', { class: 'readouts' }, plot.svg,
      element('table', { class: 'runs' }, element('thead', {}, element('tr', {}, ...heads)), element('tbody', {}, ...rows.map((row) => row.element))), aside),
    element('div', { class: 'controls pairs' },
      element('label', { class: 'choice' }, restored, element('span', {}, 'Restore after every step')),
      method.element, named('Step', step), named('Disturbance', disturbance), bodies, axis.element,
      element('div', { class: 'moments' }, ...moments.map((moment) => moment.element))));

  function draw() {
    const settings = Object.fromEntries(SETTINGS.map((name) => [name, model.get(name)])), time = model.get('time');
    const name = model.get('description');
    if (made !== JSON.stringify(settings)) {
      run = new Run(settings);
      made = JSON.stringify(settings);
    }
    const wanted = Math.floor(time / run.step + 1e-9), until = performance.now() + 5;
    while (run.last < wanted && !run.ended && performance.now() < until) run.next();
    if (run.ended && time > run.step * run.last) {
      clock.pause();
      clock.set(run.step * run.last);
      return;
    }
    // The rest is computed in the next frames, and drawn as it grows.
    put(figure, 'aria-busy', String(run.last < wanted));
    if (run.last < wanted) redraw();
    else figure.removeAttribute('data-waking');
    const k = Math.min(wanted, run.last);

    clock.at(time);
    const body = bodyOf(settings.moments), shown = refused ?? settings.moments;
    moments.forEach((moment, k) => {
      moment.show(shown[k]);
      moment.mark(refused ? 'refused' : '');
    });
    AXES.forEach((about, k) => write(ranks[k], `${about} (${rank(settings.moments, k)})`));
    writeWords(aside, `Dashed: the reference, computed with steps ten times finer. Every description uses its angular velocity. The arrow $\\mathbf{H}$, the angular momentum of the ${body}, keeps its direction.`);
    axis.show(settings.axis);
    method.show(settings.method);
    step.show(settings.step);
    disturbance.show(settings.disturbance);
    restored.checked = settings.restored;
    const values = Object.fromEntries(rows.map((row) => {
      const value = [run.faultAt(k, row.name), run.errorAt(k, row.name)];
      row.pick.checked = row.name === name;
      [row.faulty, row.wrong].forEach((cell, i) => write(cell, power(value[i])));
      return [row.name, value];
    }));
    const matrix = MATRICES[name](run.states[k]);
    sheet.size = SIZE;
    sheet.draw(() => picture(sheet, settings.moments, matrix, run.truth(k), run.momentum));
    plot.draw(() => curves(name, k));
    text.say(refused ? `${impossible(refused)} Still drawn: ${listed(settings.moments)}.` : told(name, k, settings, values[name], matrix));
  }

  function told(name, k, { moments: inertia, axis: about, restored: valid, method: how }, [faulty, wrong], matrix) {
    const what = bodyOf(inertia), middle = rank(inertia, AXES.indexOf(about)).startsWith('middle');
    const now = (run.step * k).toFixed(1), count = run.flips.filter((flip) => flip <= k).length;
    const begin = `After ${now} s the ${what} ${often(count, middle)}. `;
    if (run.ended && k === run.last) {
      return `${begin}The run ends here, because the computed numbers have exceeded ten thousand. ${how === 'Euler' ? 'Euler’s' : 'This'} method needs smaller steps.`;
    }
    if (name === 'angles') {
      return `${begin}The Euler angles always give a valid orientation. It is wrong by ${power(wrong)} rad, and ${Math.round(run.marginAt(k))}° from gimbal lock.`;
    }
    const title = name === 'matrix' ? 'The matrix' : 'The matrix of the quaternion';
    if (valid) return `${begin}${title} is restored after every step and stays orthogonal, but the orientation is wrong by ${power(wrong)} rad.`;
    const lengths = matrix.map(length), worst = lengths.map((far) => Math.abs(Math.log(far))), far = worst.indexOf(Math.max(...worst));
    const seen = worst[far] > 0.02 ? `: its unit vector $\\hat{a}_${AXES[far]}$ is ${lengths[far].toPrecision(3)} long` : '';
    return `${begin}${title}, not restored, departs from orthogonality by ${power(faulty)}${seen}. The orientation is wrong by ${power(wrong)} rad.`;
  }

  function curves(drawn, k) {
    axes(plot);
    const now = across(run.step * k);
    for (const [top, bottom] of [FAULT, ERROR, MARGIN]) plot.path('ML', [[now, top], [now, bottom]], 'accent');
    for (const [name, data] of run.curves) {
      const colour = COLOURS[name.split(' ')[1]];
      plot.marks.push({ kind: colour ? `axis ${colour}` : 'ink', data, depth: 1 });
    }
    for (const [part, value] of [[FAULT, run.faultAt(k, drawn)], [ERROR, run.errorAt(k, drawn)]]) {
      const place = [now, down(part, Math.log10(Math.max(value, ROUNDING)))];
      plot.ellipse(place, [4.5, 0], [0, 4.5], `head ${COLOURS[drawn]}`, 2);
    }
  }

  put(figure, 'data-waking', '');   // until the first run is computed
  draw();
  const stops = [follow(model, [...SETTINGS, 'description', 'time'], redraw), follow(model, ['moments'], () => { refused = null; })];
  return () => stops.forEach((stop) => stop());
}
