import { add, AXES, dcmFromBodyFixed, dcmFromQuaternion, degrees, dot, IDENTITY, length, nearestDcm,
  quaternionFromAxisAngle, quaternionFromDcm, radians, scale, slerp, subtract, times, unit } from './mathematics.js';
import { angleBetween, BALL, double, KNOB, MIDDLE, onCircle, plotted, RADIUS, SAMPLES, SECONDS,
  SIZE, WAYS, ways } from './quaternion_picture.js';
import { button, change, choice, element, fixed, follow, followSphere, followTurn, glide, group,
  liveText, numberField, numberTable, onceAFrame, open, plain, player, put, readout, Sheet, slider,
  stage } from './shared.js';

const SEQUENCE = 'zxy', FULL = 4 * Math.PI;
const number = (value, digits = 3) => fixed(value, digits).trim();
const inDegrees = (angle) => `${number(degrees(angle), 1)}°`;

export function render({ model, el }) {
  const [both, way] = [doubleView(model), wayView(model)];
  const views = { double: both, way };
  const switches = [['double', '$q$ and $-q$'], ['way', 'From $A$ to $B$']].map(([name, text]) => button(text, () => change(model, { view: name })));
  const across = model.get('more') !== false ? [element('div', { class: 'across' }, group('What is shown', 'row-of-controls', ...switches))] : [];
  const root = open(el, ...across, ...both.parts, ...(model.get('more') !== false ? way.parts : []));
  root.classList.toggle('two-views', model.get('more') !== false);

  function draw() {
    const shown = model.get('view');
    Object.keys(views).forEach((name, k) => {
      put(switches[k], 'aria-pressed', String(name === shown));
      for (const part of views[name].parts) part.hidden = name !== shown;
    });
    views[shown].draw();
  }
  const redraw = onceAFrame(draw);
  both.redraw = way.redraw = redraw;
  draw();
  return follow(model, ['view', 'axis', 'angle', 'first', 'second', 'unit_vector', 'share'], redraw);
}

// ---- q and -q ------------------------------------------------------------------------------------------

function doubleView(model) {
  const self = { redraw() {} }, more = model.get('more') !== false;
  let lit = null, typed = [0, 0, 0], stop = () => {};
  const turnTo = (angle) => {
    stop();
    change(model, { angle: Math.min(FULL, Math.max(0, angle)) });
  };
  const pointTo = (axis) => change(model, { axis });
  const sheet = new Sheet({ bounds: [-118, -142, 242, 222], size: SIZE, changed: () => self.redraw(),
    name: `A frame A that turns in N about the unit vector e, and beside it the circle of half the angle with q${more ? ' and minus q' : ''}.`,
    grab(part, at) {
      const axis = model.get('axis'), angle = model.get('angle');
      if (part === 'axis') {
        const direction = followSphere(sheet, { vector: scale(KNOB, axis), at });
        return (to) => pointTo(direction(to));
      }
      if (part === 'q' || part === '-q') {
        let now = angle, before = bearing(at);
        return (to) => {
          const next = bearing(to), step = next - before;
          before = next;
          now += 2 * (step - 2 * Math.PI * Math.round(step / (2 * Math.PI)));
          turnTo(radians(Math.round(degrees(now))));
        };
      }
      if (!part) return null;
      const follower = followTurn(sheet, { axis, arm: IDENTITY[part], angle, at });
      return (to) => turnTo(follower(to));
    } });
  const bearing = (at) => Math.atan2(MIDDLE[1] - at[1], at[0] - MIDDLE[0]);

  const angle = slider({ symbol: '$\\theta$', name: 'theta', min: 0, max: 720, change: turnTo });
  const once = button('Turn once round', () => {
    const now = model.get('angle'), from = now > FULL / 2 + 1e-9 ? 0 : now;
    stop();
    stop = glide((part) => change(model, { angle: Math.min(FULL, from + part * 2 * Math.PI) }), 3);
  });
  const back = button('Back to 0°', () => turnTo(0));
  const fields = AXES.map((axis, k) => numberField({ name: `${axis} component of the axis`, change(value) {
    typed[k] = value;
    if (length(typed) > 0) pointTo(unit(typed));
    else text.say('A zero vector has no direction: at least one component of the axis must differ from zero.');
  } }));
  const presets = IDENTITY.map((axis, k) => button(`$\\hat{n}_${AXES[k]}$`, () => pointTo(axis), { 'aria-label': `axis n ${AXES[k]}` }));
  const light = (i, j) => {
    lit = i === undefined ? null : [i, j];
    self.redraw();
  };
  const quaternions = numberTable({ name: more ? 'q and minus q, scalar first' : 'q, scalar first', rows: ['$q$', '$-q$'].slice(0, more ? 2 : 1), columns: ['$q_0$', '$q_i$', '$q_j$', '$q_k$'],
    names: ['q', 'minus q'].slice(0, more ? 2 : 1).map((name) => ['0', 'i', 'j', 'k'].map((part) => `${name}, component ${part}`)), light });
  const matrix = numberTable({ name: 'Direction cosine matrix of A with respect to N', kind: 'bracket',
    rows: AXES.map((axis) => `$\\hat{a}_${axis}$`), columns: AXES.map((axis) => `$\\hat{n}_${axis}$`),
    names: AXES.map((i) => AXES.map((j) => `a ${i} dot n ${j}`)), light: () => {} });
  const text = liveText();
  self.parts = [stage(sheet, text),
    element('div', { class: 'controls' }, angle.element, element('div', { class: 'row-of-controls' }, once, back),
      group('Axis', 'row-of-controls', element('span', { class: 'symbol', 'aria-hidden': 'true' }, '$\\hat{e}$'),
        ...fields.map((field) => field.element), ...presets)),
    element('div', { class: 'readouts' }, readout([more ? 'Two quaternions of one orientation' : 'The quaternion of the rotation'], quaternions.element),
      ...(more ? [readout(['${}^A\\mathbf{C}^N$, from either of them'], matrix.element)] : []))];

  self.draw = () => {
    const axis = model.get('axis'), theta = model.get('angle'), q = quaternionFromAxisAngle(axis, theta), dcm = dcmFromQuaternion(q);
    if (length(subtract(unit(typed), axis)) > 1e-9) typed = [...axis];
    fields.forEach((field, k) => field.show(typed[k]));
    angle.show(theta);
    quaternions.show([q, scale(-1, q)].slice(0, more ? 2 : 1).map((quaternion) => quaternion.map((entry) => fixed(entry))));
    matrix.show(dcm.map((row) => row.map((entry) => fixed(entry))));
    sheet.draw(() => {
      double(sheet, axis, theta, dcm, more);
      const half = theta / 2, [q, opposite] = [RADIUS, -RADIUS].map((radius) => onCircle(sheet, radius, half));
      if (lit) {
        const tip = lit[0] ? opposite : q, [x, y] = sheet.onSheet(tip);
        const foot = lit[1] ? sheet.placed(MIDDLE[0], y) : sheet.placed(x, MIDDLE[1]);
        sheet.line([tip, foot], 'ink', 'guide');
        sheet.line([onCircle(sheet, 0, 0), foot], 'ink', 'shadow');
      }
      sheet.grip(scale(KNOB, axis), 'axis');
      dcm.forEach((row, n) => sheet.grip(row, String(n)));
      sheet.grip(q, 'q');
      if (more) sheet.grip(opposite, '-q');
    });
    text.say(lit ? componentText(q, axis, theta, lit) : doubleText(theta, more));
  };
  return self;
}

function doubleText(theta, more) {
  const turns = theta / (2 * Math.PI), whole = Math.round(turns);
  const half = `$\\theta$ = ${plain(degrees(theta), 1)}°, half of it ${plain(degrees(theta / 2))}°.`;
  if (Math.abs(turns - whole) > 1e-9 && !more) return half;
  if (Math.abs(turns - whole) > 1e-9) return `${half} $q$ and $-q$ are opposite points of the circle, and one and the same orientation.`;
  return [`${half} $A$ is where $N$ is, and $q$ is 1.`,
    `${half} After one full turn $A$ is back, but $q$ has come only half round: it is −1.`,
    `${half} After two full turns $q$ is back at 1 as well.`][whole];
}

function componentText(q, axis, theta, [i, j]) {
  const sign = i ? '−' : '', value = number(i ? -q[j] : q[j]), half = inDegrees(theta / 2);
  return j === 0 ? `${sign}$q_0$ = ${sign}cos $\\theta/2$ = ${sign}cos ${half} = ${value}: how far the point lies to the right.`
    : `${sign}$q_${'0ijk'[j]}$ = ${sign}sin $\\theta/2$ · $e_${AXES[j - 1]}$ = ${value}: how far up the point lies, sin ${half} = `
      + `${number(Math.sin(theta / 2))}, times the component of $\\hat{e}$.`;
}

// ---- from one orientation to another -------------------------------------------------------------------

// Return the three ways as functions of the share of the way; null where a way does not exist.
function waysBetween(first, second) {
  const [from, to] = [first, second].map((angles) => dcmFromBodyFixed(angles, SEQUENCE));
  const [q, p] = [from, to].map(quaternionFromDcm), product = dot(q, p), near = scale(product < 0 ? -1 : 1, p);
  const raw = (share) => from.map((row, k) => add(scale(1 - share, row), scale(share, to[k])));
  return { from, to, raw, dcms: [
    // Orientations half a turn apart have two equally short ways.
    (share) => (Math.abs(product) > 1e-12 ? dcmFromQuaternion(slerp(q, near, share)) : null),
    (share) => dcmFromBodyFixed(add(scale(1 - share, first), scale(share, second)), SEQUENCE),
    (share) => nearestDcm(raw(share)).dcm] };
}

// Return the speed in radians per second, from orientations a little before and after.
function speedAt(way, share) {
  const before = way(Math.max(0, share - 1e-4)), after = way(Math.min(1, share + 1e-4));
  const passed = SECONDS * (Math.min(1, share + 1e-4) - Math.max(0, share - 1e-4));
  return angleBetween(before, after) / passed;
}

function wayView(model) {
  const self = { redraw() {} };
  const sheet = new Sheet({ bounds: [-180, -142, 180, 222], size: BALL, changed: () => self.redraw(),
    name: 'The sphere that the tip of a unit vector moves on, its three paths from A to B, and below it their speeds.' });
  let edited = 'second', kept = {};
  const ends = choice({ name: 'Set the angles z-x-y of', options: [['first', 'A, the start'], ['second', 'B, the end']], change(value) {
    edited = value;
    self.redraw();
  } });
  const angles = ['psi', 'theta', 'phi'].map((name, k) => slider({ symbol: `$\\${name === 'phi' ? 'varphi' : name}$`, name,
    change: (value) => change(model, { [edited]: model.get(edited).map((old, n) => (n === k ? value : old)) }) }));
  const tip = choice({ name: 'Follow the unit vector', options: AXES, change: (value) => change(model, { unit_vector: value }) });
  const way = player({ name: 'Time along the way', seconds: SECONDS, show: (time) => change(model, { share: time / SECONDS }) });
  const table = numberTable({ name: 'The three ways', kind: 'ways', rows: ['$C$ slerp', '$D$ Euler angles', '$E$ matrix entries'],
    columns: ['turned', 'speed'], names: ['C, slerp', 'D, Euler angles', 'E, matrix entries'].map((name) => ['turned from A by', 'speed'].map(
      (what) => `${name}, ${what}`)), light: () => {} });
  const lengths = numberTable({ name: 'Lengths of the rows of the blended matrix', columns: AXES.map((axis) => `row ${axis}`),
    names: [AXES.map((axis) => `length of row ${axis}`)], light: () => {} });
  const text = liveText();
  self.parts = [stage(sheet, text),
    element('div', { class: 'controls' }, way.element, element('div', { class: 'row-of-controls' }, tip.element, ends.element),
      ...angles.map((angle) => angle.element)),
    element('div', { class: 'readouts' }, readout(['Now'], table.element),
      readout(['Row lengths of the blended entries'], lengths.element))];
  [...table.element.querySelectorAll('.head-of-row')].slice(1).forEach((head, k) => head.classList.add(WAYS[k]));

  self.draw = () => {
    const share = model.get('share'), first = model.get('first'), second = model.get('second'), k = AXES.indexOf(model.get('unit_vector'));
    const key = JSON.stringify([first, second]);
    if (kept.key !== key) kept = { key, ...sampled(waysBetween(first, second)) };
    ends.show(edited);
    angles.forEach((angle, n) => angle.show(model.get(edited)[n]));
    tip.show(AXES[k]);
    way.at(share * SECONDS);
    const now = kept.dcms.map((at) => at(share)), speeds = kept.dcms.map((at) => speedAt(at, share)), raw = kept.raw(share);
    table.show(now.map((dcm, n) => (dcm ? [`${fixed(degrees(angleBetween(kept.from, dcm)), 1)}°`,
      Number.isNaN(speeds[n]) ? '–' : `${fixed(degrees(speeds[n]), 1)} °/s`] : ['–', '–'])));
    const sizes = raw.map(length);
    lengths.show([sizes.map((size) => fixed(size))]);
    sheet.draw(() => ways(sheet, [kept.from, kept.to], kept.tracks, kept.speeds, now, raw[k], k, share));
    text.say(wayText(kept, now, sizes));
  };
  return self;
}

// Return what is drawn of the ways: orientations at even times and the speeds between them.
function sampled(between) {
  const tracks = between.dcms.map((at) => Array.from({ length: SAMPLES + 1 }, (_, k) => at(k / SAMPLES)));
  const speeds = tracks.map((track) => track.slice(1).map((dcm, k) => angleBetween(track[k], dcm) * SAMPLES / SECONDS));
  return { ...between, tracks, speeds, angle: angleBetween(between.from, between.to), range: slowestAndFastest(between.dcms[1]) };
}

// Return the smallest and the largest speed on a way for the table, even between the even times.
function slowestAndFastest(way) {
  const speeds = Array.from({ length: SAMPLES + 1 }, (_, k) => speedAt(way, k / SAMPLES));
  return [Math.min, Math.max].map((best) => {
    const k = speeds.indexOf(best(...speeds));
    let early = Math.max(0, k - 1) / SAMPLES, late = Math.min(SAMPLES, k + 1) / SAMPLES;
    for (let step = 0; step < 24; step += 1) {   // ternary search: drop the third beyond the worse of two speeds
      const [one, other] = [early + (late - early) / 3, late - (late - early) / 3];
      if (best(speedAt(way, one), speedAt(way, other)) === speedAt(way, one)) late = other;
      else early = one;
    }
    return best(speeds[k], speedAt(way, (early + late) / 2));
  });
}

function wayText({ angle, speeds, range }, [slerped, , repaired], sizes) {
  if (!slerped) return '$A$ and $B$ are half a turn apart: both ways round are equally long, and slerp has no shorter one to take.';
  if (!repaired) return 'The blended entries are equally near to several orientations: no matrix is the nearest.';
  const [slow, fast] = range.map(degrees), short = Math.min(...sizes);
  const [, , beyond] = plotted(speeds);
  const way = speeds[1].reduce((sum, speed) => sum + speed, 0) * SECONDS / SAMPLES;
  return `Slerp turns through ${inDegrees(angle)} at ${number(degrees(angle) / SECONDS, 1)} °/s. Euler angles turn through ${inDegrees(way)} in all, `
    + `at ${number(slow, 1)} to ${number(fast, 1)} °/s. ${short < 0.9995 ? `The blended rows are too short now, the shortest ${number(short)}.` : ''}${
    beyond ? ` The plot is cut off: the fastest speed is ${number(Math.max(beyond, fast), 0)} °/s.` : ''}`;
}
