// The world of the essay as data: for each state, a list of shapes with their places and colours, and a list of labels.
// paint.js shows them on screen and painter.py on paper, and neither knows what they mean.
//
// All places are along the unit vectors of the hand, frame A: a_x to the east, a_y to the north, a_z up. The gimbal is
// z-x-y: the first motor rotates about a_z, the second about b_x, the third about c_y, and the lens looks along d_y. So
// the three angles are longitude, height and roll.
import { AXES, IDENTITY, SEQUENCES, add, axisAngleFromDcm, bodyFixedFromDcm, cross, dcmFromAxisAngle, dcmFromBodyFixed,
  dcmFromQuaternion, dot, length, multiply, quaternionFromDcm, scale, several, simpleDcm, slerp, subtract,
  times, transpose, unit, wrapped } from '../../moving/js/mathematics.js';
import { quaternionAt } from '../../moving/js/belt_picture.js';
import { STOPS } from './stops.js';

const PI = Math.PI;
export const deg = (angle) => angle * PI / 180;
export const SEQUENCE = 'zxy';
export const GROUND = -2.2, RIM = 1.42;   // the height of the ground, and its radius
export const LIGHT = unit([0.55, 0.1, 1]);
// The distance of the eye; what it looks at, and half of what it sees there; the half when it looks closely, at the camera.
export const DISTANCE = 8.5;
const TARGET = [0, 0, -0.42], HALF = 2.46, CLOSE = 1.75;
const REACH = 1.62, LOOKING = 1.2, UNIT = 1.22;
const mix = (a, b, part) => a + (b - a) * part;
const clamp = (value) => Math.min(1, Math.max(0, value));
// Go from 0 to 1 as t goes from one moment to another, smoothly at both ends.
const between = (t, from, to) => {
  const part = clamp((t - from) / (to - from));
  return part * part * (3 - 2 * part);
};

// The direction so many degrees east of north, and so many up.
export function direction(heading, height) {
  const [h, e] = [deg(heading), deg(height)];
  return [Math.sin(h) * Math.cos(e), Math.cos(h) * Math.cos(e), Math.sin(e)];
}

export const STAR = direction(-22, 36);

// Return the directions right, up and towards the eye, along A.
export function viewFrom(azimuth, elevation) {
  const [x, y, z] = multiply(simpleDcm('y', -elevation), simpleDcm('z', azimuth));
  return [y, z, x];
}

// Return where a point is seen: right and up in halves of the picture's smaller side, and how near it is.
export function project({ view, target, half }, point) {
  const [x, y, z] = times(view, subtract(point, target)), near = DISTANCE / (DISTANCE - z) / half;
  return [near * x, near * y, z];
}

export function frames(angles) {
  const [B, c, d] = angles.map((angle, k) => simpleDcm(SEQUENCE[k], angle)), C = multiply(c, B);
  return { A: IDENTITY, B, C, D: multiply(d, C) };
}

// Return the angles of a matrix nearest to the previous ones, out of the two triples that always exist.
export function anglesNear(dcm, before) {
  const [psi, theta, phi] = bodyFixedFromDcm(dcm, SEQUENCE);
  const near = [[psi, theta, phi], [psi + PI, PI - theta, phi + PI]].map((triple) => triple.map(
    (angle, k) => before[k] + wrapped(angle - before[k])));
  const far = (triple) => Math.max(...triple.map((angle, k) => Math.abs(angle - before[k])));
  return far(near[0]) <= far(near[1]) ? near[0] : near[1];
}

// Rotate a vector about an axis; the rows of the matrix are the rotated unit vectors.
export const turned = (axis, angle, vector) => times(transpose(dcmFromAxisAngle(axis, angle)), vector);
// Rotate a frame like an object in the room.
export const turnedFrame = (axis, angle, dcm) => multiply(dcm, dcmFromAxisAngle(axis, angle));

// ---- shapes ----------------------------------------------------------------------------------------------

class Scene {
  constructor() {
    this.items = [];
    this.labels = [];
    this.alpha = 1;
    this.casts = false;   // whether the added shapes throw a shadow on the ground
  }

  add(shape, of, rows, origin, size, colour, alpha = 1) {
    const seen = alpha * this.alpha;
    if (seen > 0.01) this.items.push({ shape, of, rows, origin, size, colour, alpha: seen, casts: this.casts && seen > 0.6 });
  }

  // Add a part of a ring in the plane of u and v.
  arc(u, v, radius, thick, from, to, colour, origin = [0, 0, 0], alpha = 1) {
    this.add('arc', [radius, thick, from, to], [u, v, cross(u, v)], origin, [1, 1, 1], colour, alpha);
  }

  // Add a cylinder, or a cone if `top`, the radius at its end relative to the start, is not 1.
  rod(from, to, radius, colour, { top = 1, alpha = 1 } = {}) {
    const along = subtract(to, from), far = length(along);
    if (far < 1e-6) return;
    const w = scale(1 / far, along), sizes = w.map(Math.abs), other = IDENTITY[sizes.indexOf(Math.min(...sizes))];
    const u = unit(cross(other, w));
    this.add('rod', [top], [u, cross(w, u), w], from, [radius, radius, far], colour, alpha);
  }

  ball(at, radius, colour, alpha = 1) {
    this.add('ball', [], IDENTITY, at, [radius, radius, radius], colour, alpha);
  }

  box(rows, size, colour, at = [0, 0, 0], bevel = 0.05, alpha = 1) {
    this.add('box', [...size, bevel], rows, at, [1, 1, 1], colour, alpha);
  }

  // Add a thread through points.
  tube(points, radius, colour, alpha = 1) {
    if (points.length > 1) this.add('tube', [radius, ...points.flat()], IDENTITY, [0, 0, 0], [1, 1, 1], colour, alpha);
  }

  // Add a band between two lines of points, visible from both sides.
  ribbon(left, right, colour, alpha = 1) {
    this.add('ribbon', left.flatMap((point, k) => [...point, ...right[k]]), IDENTITY, [0, 0, 0], [1, 1, 1], colour, alpha);
  }

  dashes(from, to, radius, colour, count = 9, alpha = 1) {
    const along = subtract(to, from);
    for (let k = 0; k < count; k += 1) {
      this.rod(add(from, scale(k / count, along)), add(from, scale((k + 0.55) / count, along)), radius, colour, { alpha });
    }
  }

  arrow(from, to, colour, { thick = 0.028, alpha = 1, label = '', head = 1 } = {}) {
    const along = subtract(to, from), far = length(along);
    if (far < 0.02) return;
    const tip = Math.min(0.24 * head, 0.8 * far), neck = subtract(to, scale(tip / far, along));
    this.rod(from, neck, thick, colour, { alpha });
    this.rod(neck, to, 2.9 * thick * head, colour, { top: 0, alpha });
    if (label) this.label(add(to, scale(0.04 / far, along)), label, colour, from, alpha);
  }

  // Add a label beyond a point as seen from another.
  label(at, text, colour, from = [0, 0, 0], alpha = 1) {
    if (alpha * this.alpha > 0.3) this.labels.push({ at, text, colour, from });
  }

  // Add the path of a vector that rotates about an axis, with an arrow's head.
  sweep(axis, angle, start, colour, { thick = 0.018, origin = [0, 0, 0], head = true, alpha = 1 } = {}) {
    if (Math.abs(angle) < 0.03) return;
    const count = Math.max(3, Math.ceil(Math.abs(angle) / 0.1));
    const at = (part) => add(origin, turned(axis, angle * part, start));
    const tip = head ? Math.min(0.5, 0.15 / (Math.abs(angle) * length(start) + 1e-9)) : 0;
    this.tube(Array.from({ length: count + 1 }, (_, k) => at((1 - tip) * k / count)), thick, colour, alpha);
    if (head) this.rod(at(1 - tip), at(1), 2.8 * thick, colour, { top: 0, alpha });
  }

  circle(axis, start, colour, options) { this.sweep(axis, 2 * PI, start, colour, { head: false, ...options }); }

  triad(letter, rows, { reach = REACH, origin = [0, 0, 0], alpha = 1, thick = 0.028, labels = true } = {}) {
    rows.forEach((row, k) => this.arrow(origin, add(origin, scale(reach, row)), letter,
      { alpha, thick, label: labels ? `\\hat{${letter.toLowerCase()}}_${AXES[k]}` : '' }));
  }

  // ---- the machine -----------------------------------------------------------------------------------------

  camera(rows, { at = [0, 0, 0], size = 1, alpha = 1, lamp = true, colour = 'D' } = {}) {
    const [x, y, z] = rows, to = (i, j, k) => add(at, scale(size * i, x), scale(size * j, y), scale(size * k, z));
    this.box(rows, [0.64 * size, 0.4 * size, 0.46 * size], colour, at, 0.06 * size, alpha);
    this.box(rows, [0.25 * size, 0.26 * size, 0.13 * size], colour, to(-0.02, 0, 0.27), 0.04 * size, alpha);
    this.rod(to(0, 0.19, 0), to(0, 0.36, 0), 0.2 * size, 'graphite', { alpha });
    this.rod(to(0, 0.36, 0), to(0, 0.53, 0), 0.16 * size, 'graphite', { alpha });
    this.rod(to(0, 0.53, 0), to(0, 0.55, 0), 0.165 * size, 'metal', { alpha });
    this.rod(to(0, 0.551, 0), to(0, 0.556, 0), 0.125 * size, 'glass', { alpha });
    if (lamp) {
      this.ball(to(0.04, 0.56, 0.045), 0.028 * size, 'paper', alpha);
      this.ball(to(0.23, 0.2, 0.14), 0.035 * size, 'lamp', alpha);
      this.rod(to(0.2, 0, 0.22), to(0.2, 0, 0.265), 0.05 * size, 'metal', { alpha });
    }
  }

  machine({ B, C, D }, alpha, cameraAlpha, casts) {
    this.casts = casts;
    const up = [0, 0, 1], at = (row, far) => scale(far, row);
    const part = { alpha };
    this.rod(at(up, -2.1), at(up, -1.36), 0.15, 'graphite', part);
    this.ball(at(up, -2.1), 0.15, 'graphite', alpha);
    for (const z of [-1.52, -1.66, -1.8, -1.94]) this.arc(IDENTITY[0], IDENTITY[1], 0.153, 0.018, 0, 2 * PI, 'A', [0, 0, z], alpha);
    this.rod(at(up, -1.38), at(up, -1.14), 0.23, 'A', part);
    this.rod(at(up, -1.14), at(up, -1.1), 0.19, 'metal', part);
    // The outer arm, which the first motor rotates.
    this.arc(B[0], B[2], 1.05, 0.07, PI, 2 * PI, 'B', [0, 0, 0], alpha);
    this.rod(at(B[2], -1.1), at(B[2], -1.0), 0.13, 'B', part);
    for (const side of [1, -1]) {
      this.rod(at(B[0], 0.93 * side), at(B[0], 1.17 * side), 0.14, 'B', part);
      this.rod(at(B[0], 1.17 * side), at(B[0], 1.2 * side), 0.1, 'metal', part);
      this.rod(at(B[0], 0.74 * side), at(B[0], 0.94 * side), 0.05, 'metal', part);
    }
    // The inner arm, which the second motor rotates.
    this.arc(C[0], C[1], 0.77, 0.06, PI, 2 * PI, 'C', [0, 0, 0], alpha);
    for (const side of [1, -1]) this.ball(at(C[0], 0.77 * side), 0.085, 'C', alpha);
    this.rod(at(C[1], -0.9), at(C[1], -0.66), 0.14, 'C', part);
    this.rod(at(C[1], -0.66), at(C[1], -0.18), 0.05, 'metal', part);
    this.camera(D, { alpha: cameraAlpha });
    this.casts = false;
  }

  ground(alpha) {
    this.rod([0, 0, GROUND - 0.05], [0, 0, GROUND], RIM, 'ground', { alpha });
    for (let k = 0; k < 16; k += 1) {
      const [x, y] = direction(k * 22.5, 0), long = k % 4 ? 0.09 : 0.2;
      this.rod([(RIM - 0.04) * x, (RIM - 0.04) * y, GROUND], [(RIM - 0.04 - long) * x, (RIM - 0.04 - long) * y, GROUND + 0.004], k % 4 ? 0.012 : 0.02, 'muted', { alpha });
    }
    for (const [k, letter] of ['N', 'E', 'S', 'W'].entries()) {
      this.label((add(scale(RIM - 0.42, direction(90 * k, 0)), [0, 0, GROUND])), letter, 'muted', [0, 0, GROUND], alpha);
    }
  }

  star(at, size = 0.11) {
    this.ball(at, size * 0.62, 'star');
    for (const axis of [[1, 1, 0], [1, -1, 0], [0, 1, 1], [0, 1, -1], [1, 0, 1], [1, 0, -1]].map(unit)) {
      for (const side of [1, -1]) this.rod(at, add(at, scale(side * size * 1.7, axis)), size * 0.33, 'star', { top: 0 });
    }
  }
}

// ---- the stops: what each shows besides the machine --------------------------------------------------------

const ZERO = [0, 0, 0], [, , UP] = IDENTITY;
const poses = (...list) => list.map((pose) => pose.map(deg));

// Pass through a list of poses, one after another, as t goes from 0 to 1.
function through(list, t, marks = list.map((_, k) => k / (list.length - 1))) {
  let k = 0;
  while (k < list.length - 2 && t > marks[k + 1]) k += 1;
  const part = between(t, marks[k], marks[k + 1]);
  return list[k].map((angle, i) => mix(angle, list[k + 1][i], part));
}

export const AT_READER = poses([-38, 18, 0])[0];
export const GENERIC = poses([28, 24, -22])[0];
export const CROOKED = poses([84, 32, -58])[0];
export const FROM = poses([-80, 60, -30])[0], TO = poses([100, 65, 40])[0];   // of stop 14
const SWING = deg(90), TILT = deg(70), FOUR = unit([0.48, 0.39, 0.79]);   // of stop 6, and the line of stop 12
const POSE = deg(108);   // of stop 12, in which the text leaves the camera twice, one turn apart
// At the star, and from there to the second triple of its angles, one motor after the other.
const TOWARDS_STAR = poses([0, 0, -30], [22, 0, -30], [22, 36, -30], [22, 36, 0], [22, 36, 0], [202, 36, 0], [202, 144, 0], [202, 144, 180]);
export const CABLE = { wall: 2.05, start: 0.5 };
export const axisOf = (start) => axisAngleFromDcm(frames(start).D);

// The position of the eye where it differs from the usual one.
// Its azimuth and height, and how close it is, from 0 to 1.
export const EYES = { 'one-motor': [52, 17, 0.5], 'nine-shadows': [52, 17, 0.5], 'looking-back': [52, 38, 0], lock: [52, 40, 0], 'one-turn': [52, 17, 0.5],
  'two-mirrors': [25, 40, 0.6], 'four-numbers': [79, 34, 0.6], 'not-home': [8, 24, 0.6], 'between-poses': [64, 50, 0.7], 'it-moves': [52, 17, 0.8] };

// The course of the angles and the rest at a moment of a stop; start: the pose in which the stop was entered. Each
// paragraph of the stop's text has an equal share of the time from 0 to 1, so that the figure shows what it says.
export const COURSE = {
  'which-way': (t) => ({ angles: through([AT_READER, AT_READER, poses([-110, 8, 0])[0]], t, [0, 0.34, 0.5]) }),
  'two-triads': (t) => ({ angles: GENERIC, away: between(t, 0.68, 0.95) }),
  'one-motor': (t) => ({ angles: through(poses([0, 0, 0], [40, 0, 0], [40, 0, 0], [120, 0, 0], [120, 0, 0], [40, 0, 0]), t, [0.01, 0.14, 0.34, 0.55, 0.68, 0.85]) }),
  'nine-shadows': (t) => ({ angles: GENERIC, lit: Math.max(0, Math.ceil(3 * t) - 1) }),
  'looking-back': (t) => ({ angles: through(poses([0, 0, 0], [55, 0, 0], [0, 0, 0], [0, 0, 0], [55, 0, 0]), t, [0.01, 0.14, 0.28, 0.38, 0.58]), ride: t > 0.34 ? 1 : 0, faded: t > 0.67 ? 1 : 0 }),
  'two-motors': (t) => ({ angles: [SWING * between(t, 0.01, 0.1), TILT * between(t, 0.12, 0.22), 0] }),
  'three-are-enough': (t) => ({ angles: through(TOWARDS_STAR, t, [0.34, 0.38, 0.42, 0.46, 0.67, 0.72, 0.77, 0.82]) }),
  'same-numbers': (t) => ({ angles: poses([35, 50, 65])[0].map((angle, k) => angle * between(t, 0.34 + 0.05 * k, 0.39 + 0.05 * k)) }),
  lock: (t) => ({ angles: through(poses([0, 20, 0], [0, 90, 0], [0, 90, 0], [-50, 90, 50]), t, [0.01, 0.12, 0.26, 0.42]) }),
  'one-turn': (t, start) => ({ part: between(t, 0.04, 0.3), start }),
  'two-mirrors': (t) => ({ angles: ZERO, together: 0.55 - 0.35 * between(t, 0.27, 0.36) + 0.8 * between(t, 0.53, 0.66), apart: (35 + 30 * between(t, 0.38, 0.48)) / 90 }),
  'four-numbers': (t) => ({ whole: POSE * (0.5 + 0.5 * between(t, 0.01, 0.12)) + 2 * PI * between(t, 0.52, 0.68), laid: between(t, 0.26, 0.32),
    pairs: t > 0.75 ? 1 : 0, faded: (t > 0.25 && t < 0.5) || t > 0.75 ? 1 : 0, joined: between(t, 0.79, 0.91) }),
  'not-home': (t) => ({ angles: ZERO, turn: 2 * PI * (between(t, 0.01, 0.12) + between(t, 0.6, 0.66)),
    passed: t < 0.6 ? between(t, 0.4, 0.45) + between(t, 0.53, 0.59) : between(t, 0.68, 0.75) }),
  'between-poses': (t) => ({ part: between(t, 0.36, 0.95) }),
  'it-moves': (t) => ({ time: LASTS * clamp(t) }),
  'your-turn': (t, start) => ({ angles: start }),
};

// The camera in stop 15: its rate changes all the time, or is that of a free body once the reader has thrown it. It
// also has the orientation by a gyroscope that is off by 1.5 degrees a second about each axis, integrated step by step.
const STEP = 0.05, OFF = scale(deg(1.5), [1, 1, 1]), INERTIA = [1.1, 0.8, 1.25];
export const LASTS = 24;   // seconds
export const rateAt = (time) => [0.5 * Math.sin(0.9 * time), 0.35 * Math.cos(0.6 * time), 0.4 * Math.sin(0.45 * time + 1)];
// Euler's equations: the change of a free body's rate, along its principal axes.
const freely = (rate) => INERTIA.map((own, i) => {
  const [j, k] = [(i + 1) % 3, (i + 2) % 3];
  return (INERTIA[j] - INERTIA[k]) * rate[j] * rate[k] / own;
});

// The frames after each step. `thrown`: the orientation in which the camera was let go, and its rate along its own
// axes, as an instrument in it measures it.
class Run {
  constructor({ dcm, rate } = { dcm: IDENTITY }) {
    this.rate = rate;
    this.D = [dcm];
    this.told = [dcm];
  }

  // Return the rate in the middle of the next step.
  next() {
    if (!this.rate) return rateAt((this.D.length - 0.5) * STEP);
    const middle = add(this.rate, scale(STEP / 2, freely(this.rate)));
    this.rate = add(this.rate, scale(STEP, freely(middle)));
    return middle;
  }

  upTo(count) {
    while (this.D.length <= count) {
      const rate = this.next(), step = (dcm, w) => multiply(dcmFromAxisAngle(w, length(w) * STEP), dcm);
      this.D.push(step(this.D.at(-1), rate));
      this.told.push(step(this.told.at(-1), add(rate, OFF)));
    }
  }
}

const runs = new WeakMap(), ITSELF = {};
export function motion(time, thrown) {
  const key = thrown ?? ITSELF, count = Math.floor(time / STEP);
  if (!runs.has(key)) runs.set(key, new Run(thrown ?? undefined));
  const run = runs.get(key);
  run.upTo(count + 1);
  const part = time / STEP - count;
  const at = (frames) => {
    const [from, to] = [frames[count], frames[count + 1]].map(quaternionFromDcm);
    return dcmFromQuaternion(slerp(from, dot(from, to) < 0 ? scale(-1, to) : to, part));
  };
  return { D: at(run.D), told: at(run.told) };
}

// Return the two ways of stop 14 at a share of the way, as matrices.
export function ways(part) {
  const [from, to] = [FROM, TO].map((angles) => quaternionFromDcm(frames(angles).D));
  return { one: dcmFromQuaternion(slerp(from, dot(from, to) < 0 ? scale(-1, to) : to, part)),
    angles: frames(FROM.map((angle, k) => mix(angle, TO[k], part))).D };
}

// Both whole ways in small steps.
export const WHOLE_WAYS = Array.from({ length: 73 }, (_, k) => ways(k / 72));

// Return the total angle of a way, in radians: the sum of its small rotations.
export const turnedAlong = (list) => list.slice(1).reduce((sum, dcm, k) => sum + apart(list[k], dcm), 0);
export const apart = (first, second) => axisAngleFromDcm(multiply(second, transpose(first)))[1];

const SHOWS = {
  'two-triads'(scene, s, { D }) {
    if (s.away < 0.02) return;
    const to = add(scale(-1.5 * s.away, s.right), scale(0.76 * s.away, [0, 0, 1]));
    scene.triad('D', D, { reach: 0.95, origin: to, alpha: s.away, thick: 0.022 });
    scene.camera(D, { at: to, size: 0.55, alpha: 0.25 * s.away });
  },
  'one-motor'(scene, s, { D }) {
    scene.circle(UP, [REACH, 0, 0], 'muted', { thick: 0.011 });
    scene.sweep(UP, wrapped(s.angles[0]), [0.62, 0, 0], 'accent');
    shadows(scene, D[0], [0, 1]);
  },
  'nine-shadows'(scene, s, { D }) { shadows(scene, D[s.lit], [0, 1, 2]); },
  'looking-back'(scene, s, { D }) {
    // One arrow's shadow on another is as long as the other's on the one.
    if (s.faded > 0.5) for (const [from, onto] of [[D[1], IDENTITY[1]], [IDENTITY[1], D[1]]]) shadow(scene, from, onto, LOOKING);
  },
  'two-motors'(scene, s) {
    // The ghost tilts when the text swings the camera, and swings when it tilts. Held, both have the same angles (`own`).
    const [psi, theta] = [[0, 1, SWING / TILT], [1, 0, TILT / SWING]].map(([k, j, share]) => mix(share * s.angles[j], s.angles[k], s.own));
    const other = dcmFromBodyFixed([theta, psi, 0], 'xzy'), at = add(scale(-1.34, s.right), [0, 0, 0.92]);
    scene.camera(other, { at, size: 0.62, alpha: 0.42 });
    scene.triad('D', other, { origin: at, reach: 0.85, alpha: 0.55, thick: 0.018 });
  },
  'three-are-enough'(scene, s, { D }) {
    // The line from the star down to the height of the horizon shows where it is.
    const star = scale(1.95, STAR), below = [star[0], star[1], 0];
    scene.star(star);
    scene.dashes(star, below, 0.008, 'muted', 10);
    scene.ball(below, 0.03, 'muted');
    const [psi, theta] = s.angles, flat = [-Math.sin(psi), Math.cos(psi), 0];
    scene.circle(UP, [1.38, 0, 0], 'muted', { thick: 0.009 });
    scene.sweep(UP, psi % (2 * PI), [0, 1.38, 0], 'B', { thick: 0.022 });
    scene.sweep([Math.cos(psi), Math.sin(psi), 0], theta, scale(1.38, flat), 'C', { thick: 0.022 });
    scene.arrow(scale(0.6, D[1]), scale(1.62, D[1]), 'D');
    scene.arrow(scale(0.3, D[2]), scale(1.0, D[2]), 'D');
  },
  'same-numbers'(scene, s) {
    const [right, up] = s.view;
    SEQUENCES.forEach((sequence, k) => {
      const at = add(TARGET, scale(1.1 * (k % 4 - 1.5) - 0.2, right), scale(1.45 * (1 - Math.floor(k / 4)) + 0.12, up));
      const rows = dcmFromBodyFixed(s.angles, sequence), own = sequence === SEQUENCE;
      scene.camera(rows, { at, size: 0.68, colour: own ? 'D' : 'metal' });
      scene.arrow(add(at, scale(0.36, rows[1])), add(at, scale(0.72, rows[1])), own ? 'D' : 'accent', { thick: 0.022, head: 0.7 });
      scene.labels.push({ at: add(at, scale(-0.62, up)), text: [...sequence].join('-'), colour: own ? 'D' : 'muted', from: add(at, scale(-0.62, up)), still: true });
    });
  },
  lock(scene, s, { A, B, C }) {
    const margin = Math.abs(wrapped(s.angles[1])) - PI / 2, close = Math.abs(margin) < deg(12);
    for (const [axis, text, near] of [[A[2], '\\psi', 1.62], [C[1], '\\varphi', 1.5]]) {
      scene.dashes(scale(-1.25, axis), scale(near, axis), 0.017, close ? 'accent' : 'muted', 12);
      // At lock the two names are on either side of the shared line.
      const at = scale(close ? 1.35 : near, axis), beside = scale(text === '\\psi' ? 1 : -1, s.right);
      scene.label(at, text, close ? 'accent' : 'ink', close ? add(at, beside) : ZERO);
    }
    scene.dashes(scale(-1.7, B[0]), scale(1.7, B[0]), 0.017, 'muted', 14);
    scene.label(scale(1.7, B[0]), '\\theta', 'ink');
    // The star passes from overhead along the line that the camera cannot follow: towards b_x, as the text leaves it.
    const gone = deg(38) * between(s.t, 0.52, 0.7);
    if (s.t > 0.5) {
      const at = (angle) => add(scale(1.85 * Math.cos(angle), [0, 0, 1]), scale(1.85 * Math.sin(angle), direction(140, 0)));
      scene.star(at(gone), 0.1);
      scene.tube(Array.from({ length: 12 }, (_, k) => at(gone * k / 11)), 0.011, 'star');
    }
  },
  'one-turn'(scene, s, { D }) {
    // In the reader's hand the line is that of the present pose.
    const [start, part] = s.free ? [s.angles, 0] : [s.start, s.part], [axis, angle] = axisOf(start);
    if (angle < 0.05) return;
    scene.dashes(scale(-2.0, axis), scale(2.0, axis), 0.022, 'accent', 13);
    scene.label(scale(2.0, axis), '\\hat{e}', 'accent');
    for (const row of frames(start).D) {   // the circle of each arrow's tip, and the completed part
      const foot = scale(dot(row, axis) * 1.3, axis), arm = subtract(scale(1.3, row), foot);
      if (length(arm) < 0.08) continue;
      scene.circle(axis, arm, 'muted', { thick: 0.008, origin: foot, alpha: 0.8 });
      scene.sweep(axis, -angle * part, arm, 'accent', { origin: foot, thick: 0.02 });
    }
    scene.triad('D', D, { reach: 1.3 });
  },
  'two-mirrors'(scene, s) {
    const axis = unit([0.1, -0.2, 1]), u = unit(cross([-1, 0, 0.2], axis)), v = cross(axis, u);
    const way = (angle) => add(scale(Math.cos(angle), u), scale(Math.sin(angle), v));
    const first = deg(20) - s.together * deg(52), gap = deg(90) * s.apart, second = first + gap;
    for (const [angle, name] of [[first, '\\hat{u}_1'], [second, '\\hat{u}_2']]) {
      mirror(scene, axis, way(angle));
      scene.rod(ZERO, scale(1.45, way(angle)), 0.008, 'accent');
      scene.label(scale(1.5, way(angle)), name, 'accent');
    }
    scene.dashes(scale(-1.6, axis), scale(1.6, axis), 0.02, 'accent', 10);
    scene.label(scale(1.62, axis), '\\hat{e}', 'accent');
    const r = add(scale(1.5, way(deg(-32))), scale(0.35, axis));
    const reflected = (vector, angle) => subtract(vector, scale(2 * dot(vector, normal(angle)), normal(angle)));
    const normal = (angle) => way(angle + PI / 2);
    const once = reflected(r, first), twice = reflected(once, second);
    scene.arrow(ZERO, r, 'A', { thick: 0.035 });
    scene.label(r, '\\mathbf{v}', 'A');
    scene.arrow(ZERO, once, 'metal', { thick: 0.03 });
    scene.label(once, '\\mathbf{v}\'', 'ink');
    scene.arrow(ZERO, twice, 'D', { thick: 0.035 });
    scene.label(twice, '\\mathbf{v}\'\'', 'D');
    scene.sweep(axis, gap, scale(0.62, way(first)), 'ink', { thick: 0.02, head: false });
    scene.label(scale(0.66, way((first + second) / 2)), '\\theta/2', 'ink');
    // From v to v'', each seven tenths of the way to its tip.
    const middle = scale(0.245, axis);
    scene.label(add(scale(1.1, way(deg(-32) + gap)), middle), '\\theta', 'accent');
    scene.sweep(axis, 2 * gap, scale(1.05, way(deg(-32))), 'accent', { thick: 0.022, origin: middle });
  },
  'four-numbers'(scene, s) {
    const [axis, angle] = turnOf(s), pairs = pairsOf(s);
    scene.alpha = pairs;
    if (pairs) fourMirrors(scene, s.joined);
    scene.alpha = 1 - pairs;
    const aside = Math.abs(axis[2]) > 0.99 ? [1, 0, 0] : [0, 0, 1], first = unit(cross(aside, axis)), second = turned(axis, angle / 2, first);
    const [cosine, sine] = [Math.cos(angle / 2), Math.sin(angle / 2)], foot = scale(UNIT * cosine, first);
    for (const way of [first, second]) mirror(scene, axis, way, 0.16);
    scene.dashes(scale(-0.6, axis), scale(1.7, axis), 0.014, 'accent', 10);
    scene.label(scale(1.7, axis), '\\hat{e}', 'accent');
    scene.sweep(axis, angle % (2 * PI), scale(0.3, first), 'D', { origin: scale(1.4, axis), thick: 0.022 });
    scene.label(add(scale(1.4, axis), scale(0.35, turned(axis, angle % (2 * PI) / 2, first))), '\\theta', 'D', scale(1.4, axis));
    scene.arrow(ZERO, scale(UNIT, first), 'ink', { thick: 0.018, label: '\\hat{u}_1' });
    scene.arrow(ZERO, scale(UNIT, second), 'ink', { thick: 0.018, label: '\\hat{u}_2' });
    // The shadow of the second on the first is the cosine. The rest is the sine, which is also laid along the line.
    scene.rod(ZERO, foot, 0.045, 'ink');
    scene.rod(foot, scale(UNIT, second), 0.03, 'accent');
    if (Math.abs(cosine) > 0.3) scene.label(add(scale(0.95, foot), scale(-0.03, cross(axis, first))), '\\cos(\\theta/2)', 'ink', scale(0.95, foot));
    if (Math.abs(sine) > 0.3) scene.label(scale(0.6, add(foot, scale(UNIT, second))), '\\sin(\\theta/2)', 'accent');
    const laid = UNIT * sine * s.laid;
    if (Math.abs(laid) > 0.05) scene.arrow(ZERO, scale(laid, axis), 'accent', { thick: 0.06 });
    scene.alpha *= s.laid;
    scene.triad('A', IDENTITY, { reach: UNIT, thick: 0.016 });
    for (const k of [0, 1, 2]) shadow(scene, axis, IDENTITY[k], laid, 0.03);
    scene.alpha = 1;
  },
  'not-home'(scene, s) {
    const count = 64, left = [], right = [];
    for (let k = -1; k <= count; k += 1) {
      const part = k / count, far = k < 0 ? 0.2 : mix(CABLE.start, CABLE.wall, part);   // it begins at the camera's back
      // In the belt figure the wall is at rest and the plate rotates, so the loop is read from its end.
      const rows = dcmFromQuaternion(quaternionAt(s.turn, s.passed, 1 - part));
      const place = (across) => times(transpose(rows), [across, -far, 0]);
      left.push(place(-0.11));
      right.push(place(0.11));
    }
    const middle = left.map((point, k) => scale(0.5, add(point, right[k])));
    scene.ribbon(left, middle, 'A');
    scene.ribbon(middle, right, 'B');
    scene.tube(left, 0.014, 'A');
    scene.tube(right, 0.014, 'B');
    scene.box(IDENTITY, [0.9, 0.08, 0.9], 'metal', [0, -CABLE.wall - 0.05, 0], 0.03);
    scene.triad('D', s.D, { reach: 0.95, thick: 0.02, labels: false });
  },
  'between-poses'(scene, s, { D }) {
    const [from, to] = [FROM, TO].map((angles) => frames(angles).D), { one, angles } = ways(s.part);
    const line = (kind) => WHOLE_WAYS.map((both) => scale(1.5, both[kind][1]));
    // The two ways are what the reader is asked for first, so they are not drawn before that.
    if (s.free ? apart(D, to) < deg(15) : s.part) {
      scene.tube(line('one'), 0.02, 'accent');
      scene.tube(line('angles'), 0.016, 'B');
      const [axis] = axisAngleFromDcm(multiply(transpose(from), to));
      scene.dashes(scale(-1.7, axis), scale(1.7, axis), 0.014, 'accent', 12);
    }
    for (const [rows, letter] of [[from, '0'], [to, '1']]) {
      flag(scene, rows, 'ink', 0.06);
      scene.label(scale(1.62, rows[1]), letter, 'ink');
      scene.camera(rows, { alpha: s.part && !s.free ? 0.05 : 0.16, lamp: false });
    }
    if (!s.free && s.part) flag(scene, angles, 'B', 0.07), scene.camera(angles, { alpha: 0.3, colour: 'B', lamp: false });
    flag(scene, D, 'accent', 0.085);
    if (s.track.length > 1) scene.tube(s.track.map((rows) => scale(1.54, rows[1])), 0.024, 'D');
  },
  'it-moves'(scene, s, { D }) {
    const { told } = motion(s.time, s.thrown);
    if (!s.free) {
      scene.camera(told, { alpha: 0.34, colour: 'B', lamp: false });
      scene.triad('B', told, { reach: 1.25, alpha: 0.7, thick: 0.018, labels: false });
      const since = Math.max(0, s.time - 6), at = (kind) => Array.from({ length: 40 }, (_, k) => scale(1.5, motion(mix(since, s.time, k / 39), s.thrown)[kind][1]));
      if (s.time > 0.2) {
        scene.tube(at('D'), 0.016, 'D');
        scene.tube(at('told'), 0.013, 'B');
      }
    }
    scene.triad('D', D, { reach: 1.5, labels: false });
  },
};

// A mirror through the line of the axis, and through a direction at right angles to it.
function mirror(scene, axis, way, alpha = 0.34) {
  const corner = (side, high) => add(scale(1.45 * side, way), scale(1.25 * high, axis));
  scene.ribbon([corner(-1, -1), corner(1, -1)], [corner(-1, 1), corner(1, 1)], 'glass', alpha);
  const frame = [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1), corner(-1, -1)];
  frame.slice(1).forEach((end, k) => scene.rod(frame[k], end, 0.014, 'metal', { alpha: Math.min(1, 3 * alpha) }));
}

// Two pairs of mirrors, each about its own line. Swung together, the last of the first pair and the first of the second
// lie in the plane of both lines.
function fourMirrors(scene, joined) {
  const lines = [FOUR, unit([-0.6, 0.3, 0.75])], common = unit(cross(...lines)), swing = 1 - joined;
  const mirrors = [[0, -45 * swing - 35], [0, -45 * swing], [1, 80 * swing], [1, 25 + 80 * swing]].map(([pair, angle]) => (
    { line: lines[pair], way: turned(lines[pair], deg(angle), unit(cross(common, lines[pair]))) }));
  mirrors.forEach(({ line, way }, k) => {
    // The two that coincide are seen as one before they fade.
    const middle = k === 1 || k === 2, alpha = middle ? 1 - between(joined, 0.7, 1) : 1, colour = k < 2 ? 'accent' : 'ink';
    const around = (side) => Array.from({ length: 17 }, (_, j) => (
      add(scale(1.3 * Math.cos(PI * j / 16), line), scale(1.3 * side * Math.sin(PI * j / 16), way))));
    scene.ribbon(around(1), around(-1), 'glass', 0.2 * alpha);
    scene.circle(cross(line, way), scale(1.3, line), colour, { thick: 0.014, alpha });
    scene.label(turned(cross(line, way), deg(middle ? 50 : 75), scale(1.34, line)), String(k + 1), colour, ZERO, alpha);
  });
  lines.forEach((line, k) => scene.dashes(scale(-1.6, line), scale(1.6, line), 0.016, k ? 'ink' : 'accent', 13, swing));
  const left = unit(cross(...[0, 3].map((k) => cross(mirrors[k].line, mirrors[k].way))));
  scene.dashes(scale(-1.8, left), scale(1.8, left), 0.02, 'accent', 13, joined);
}

// How visible the four mirrors are, which take the place of two that have been turned as the text left them.
export const pairsOf = (s) => (s.free || Math.abs(s.whole - POSE - 2 * PI) > 0.01 ? 0 : s.pairs);

// The line and the angle of stop 12: those of the text, or of the pose in the reader's hand.
export const turnOf = (s) => (s.free ? axisOf(s.angles) : [FOUR, s.whole]);

// Mark where a camera looks, with a mast for the camera's upright.
function flag(scene, rows, colour, size) {
  const at = scale(1.5, rows[1]);
  scene.ball(at, size, colour);
  scene.rod(at, add(at, scale(0.34, rows[2])), 0.02, colour);
}

// Show the components of an arrow of length 1 along the hand's arrows: its projections, which are dot products.
function shadows(scene, row, along) {
  const tip = scale(REACH, row);
  scene.arrow(ZERO, tip, 'D', { thick: 0.045 });
  for (const k of along) shadow(scene, row, IDENTITY[k], REACH);
}

function shadow(scene, from, onto, reach, thick = 0.055) {
  const along = dot(from, onto), foot = scale(reach * along, onto);
  if (Math.abs(along) > 0.02) scene.rod(ZERO, foot, thick, 'accent');
  scene.dashes(scale(reach, from), foot, 0.012, 'accent', 11);
  scene.ball(foot, thick, 'accent');
}

// Return the orientation of the camera at a moment, since the angles do not determine everything.
export function dcmOf(s) {
  const dcm = moved(s);
  if (!s.carry) return dcm;
  const to = quaternionFromDcm(dcm);
  return dcmFromQuaternion(slerp(s.carry.from, dot(s.carry.from, to) < 0 ? scale(-1, to) : to, s.carry.part));
}

function moved(s) {
  if (s.stop === 'one-turn' && !s.free) {
    const [axis, angle] = axisOf(s.start);
    return turnedFrame(axis, -angle * s.part, frames(s.start).D);
  }
  if (s.stop === 'four-numbers' && !s.free) return dcmFromAxisAngle(FOUR, s.whole);
  if (s.stop === 'not-home') return simpleDcm('y', s.turn);
  if (s.stop === 'between-poses' && !s.free) return ways(s.part).one;
  if (s.stop === 'it-moves' && !s.free) return motion(s.time, s.thrown).D;
  return frames(s.angles).D;
}

export function viewOf(s) {
  const fixed = viewFrom(deg(s.eye[0]), deg(s.eye[1]));
  if (s.ride < 0.001) return fixed;
  // The eye moves with the camera, which is at home when the view changes, so the picture does not jump.
  const riding = multiply(fixed, frames(s.angles).D);
  const [from, to] = [fixed, riding].map(quaternionFromDcm);
  return dcmFromQuaternion(slerp(from, dot(from, to) < 0 ? scale(-1, to) : to, s.ride));
}

// The other entries of a state, besides those that a stop changes.
export const REST = { stop: 'which-way', t: 0, angles: AT_READER, eye: [52, 17, 0], ride: 0, away: 0, lit: 0, part: 0, whole: 0, turn: 0,
  passed: 0, together: 0, apart: 0, laid: 0, pairs: 0, joined: 0, time: 0, own: 0, faded: 0, start: GENERIC, free: false, thrown: null, track: [] };

// Return everything that is seen in a state: { items, labels, view, frames }.
export function sceneOf(state) {
  const s = { ...REST, ...state }, stop = STOPS.find((candidate) => candidate.id === s.stop), scene = new Scene();
  const D = dcmOf(s), angles = stop.by === 'camera' && (s.carry || !s.free) ? anglesNear(D, s.angles) : s.angles;
  const all = { ...frames(angles), D };
  s.view = viewOf(s);
  s.right = s.view[0];
  s.target = scale(1 - s.eye[2], TARGET);
  s.half = mix(HALF, CLOSE, s.eye[2]);
  s.D = D;
  const shown = { ground: stop.ground ?? 1, machine: stop.machine, camera: stop.camera, A: stop.A, D: stop.D, ...state.shown };
  scene.ground(shown.ground);
  scene.machine(all, mix(shown.machine, Math.min(shown.machine, 0.09), s.faded), mix(shown.camera, 0.15, s.faded), shown.ground > 0.5);
  if (shown.A > 0.02) scene.triad('A', IDENTITY, { alpha: shown.A, thick: 0.024 });   // hidden by an arrow of the camera that lies on it
  if (shown.D > 0.02) scene.triad('D', D, { alpha: shown.D, reach: stop.id === 'looking-back' ? LOOKING : REACH });
  SHOWS[s.stop]?.(scene, s, all);
  return { items: scene.items, labels: scene.labels, view: s.view, target: s.target, half: s.half, frames: all, angles };
}

// ---- words -------------------------------------------------------------------------------------------------

const WINDS = ['north', 'north-east', 'east', 'south-east', 'south', 'south-west', 'west', 'north-west'];

// Describe in words which way a camera looks.
export function lookOf(dcm) {
  const [x, y, z] = dcm, height = Math.round(Math.asin(Math.max(-1, Math.min(1, y[2]))) * 180 / PI);
  if (Math.abs(height) >= 88) return `straight ${height > 0 ? 'up' : 'down'}`;
  const heading = (Math.atan2(y[0], y[1]) * 180 / PI + 360) % 360;
  const wind = WINDS[Math.round(heading / 45) % 8];
  const high = height === 0 ? 'towards the horizon' : `${several(Math.abs(height), 'degrees')} ${height > 0 ? 'up' : 'down'}`;
  // The roll: the angle from the upright direction across the line of sight to the camera's own z.
  const level = unit(cross(y, [0, 0, 1])), upright = cross(level, y);
  const roll = Math.round(Math.atan2(dot(z, level), dot(z, upright)) * 180 / PI);
  const rolled = roll === 0 ? 'level' : Math.abs(roll) > 178 ? 'upside down' : `rolled ${Math.abs(roll)} degrees to the ${roll > 0 ? 'right' : 'left'}`;
  return `${wind}, ${high}, ${rolled}`;
}

// ---- labels ------------------------------------------------------------------------------------------------

// Place the labels, in pixels right and down from the middle, each beyond its point and without overlaps. `sizes` gives
// width and height of each.
export function placed(picture, half, sizes, [wide, high]) {
  const boxes = picture.labels.map((label, k) => {
    const [x, y] = project(picture, label.at).map((v) => v * half), [u, v] = project(picture, label.from).map((w) => w * half);
    const out = Math.hypot(x - u, y - v), [w, h] = sizes[k], far = label.still ? 0 : 6 + 0.5 * Math.hypot(w, h) * 0.8;
    const way = out > 3 ? [(x - u) / out, (y - v) / out] : [0.7, 0.7];
    return { x: x + far * way[0], y: -(y + far * way[1]), w, h, fixed: label.still };
  });
  for (let round = 0; round < 24; round += 1) {
    let moved = false;
    boxes.forEach((a, i) => boxes.slice(0, i).forEach((b) => {
      const over = (a.w + b.w) / 2 + 2 - Math.abs(a.x - b.x), under = (a.h + b.h) / 2 + 1 - Math.abs(a.y - b.y);
      if (over <= 0 || under <= 0) return;
      moved = true;
      const side = over < under ? 'x' : 'y', push = (Math.min(over, under) / 2 + 0.5) * (a[side] < b[side] ? -1 : 1);
      if (!a.fixed) a[side] += b.fixed ? 2 * push : push;
      if (!b.fixed) b[side] -= a.fixed ? 2 * push : push;
    }));
    if (!moved) break;
  }
  for (const box of boxes) {
    box.x = Math.max(-wide / 2 + box.w / 2 + 2, Math.min(wide / 2 - box.w / 2 - 2, box.x));
    box.y = Math.max(-high / 2 + box.h / 2 + 2, Math.min(high / 2 - box.h / 2 - 2, box.y));
  }
  return boxes.map(({ x, y }) => [x, y]);
}
