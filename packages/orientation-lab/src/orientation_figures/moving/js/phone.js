import { AXES, bodyFixedFromDcm, dcmFromBodyFixed, dcmFromQuaternion, degrees, dot, length,
  quaternionFromDcm, radians, scale, slerp, transpose, wrapped } from './mathematics.js';
import { picture, SIZE } from './phone_picture.js';
import { button, change, element, fixed, follow, group, liveText, numberTable, onceAFrame, open,
  plainDegrees, player, readout, Sheet, slider, stage } from './shared.js';
import { hatted } from './words_picture.js';

const GRAVITY = 9.80665, RECORD_SECONDS = 10, PATIENCE = 3000;
const [N, B] = ['n', 'b'].map(hatted);
const ANGLES = ['alpha', 'beta', 'gamma'];
const COLUMNS = ['time_s', 'alpha_deg', 'beta_deg', 'gamma_deg', 'force_x', 'force_y', 'force_z', 'rate_x', 'rate_y', 'rate_z'];

// Sixteen seconds of an x-IMU that was carried about, at eight samples a second: its angles z-x-y in degrees. They are
// derived from the recording that comes with the book, and a test compares the two.
const RECORDED = (
  '-150,-2,1 -150,-3,-1 -149,-3,0 -149,-3,0 -149,-3,0 -149,-3,0 -149,-3,0 -148,-3,0 -148,-3,0 -148,-3,0 ' +
  '-148,-3,0 -149,-2,0 -148,-2,0 -148,-2,0 -148,-2,0 -148,-2,0 -148,-2,0 -148,-2,0 -148,-2,0 -149,-2,0 ' +
  '-149,-2,0 -149,-3,0 -150,-5,-1 -152,-5,-2 -154,-4,-3 -155,-4,-4 -156,-4,-4 -158,-3,-5 -159,-3,-6 -159,-3,-6 ' +
  '-158,-3,-6 -157,-3,-6 -154,1,-3 -149,3,-6 -144,10,-12 -142,10,-12 -141,10,-11 -140,11,-8 -140,10,-9 ' +
  '-139,9,-10 -127,12,-8 -113,19,-7 -91,26,-9 -55,26,-17 -15,29,-9 8,30,1 16,32,19 22,41,39 25,45,50 7,16,62 ' +
  '-14,-11,61 -34,-28,48 -41,-29,50 -31,-20,59 -20,-5,61 -5,12,60 3,20,61 5,23,62 4,19,61 7,18,64 9,11,71 ' +
  '0,3,78 -11,-7,74 -1,-1,91 -4,-2,97 -3,-1,97 -3,1,89 2,5,80 -6,5,93 -12,5,93 -1,7,76 -1,7,71 -4,9,72 ' +
  '-11,12,78 -19,12,81 -19,13,78 -19,14,75 -24,21,70 -24,24,69 -18,24,65 -14,22,64 -14,21,64 -15,19,65 ' +
  '-12,17,67 -7,16,71 -7,16,74 -11,16,75 -10,14,76 -9,14,75 -11,14,74 -14,16,72 -16,20,70 -14,23,69 -10,23,66 ' +
  '-7,23,65 -5,24,65 -5,26,66 -6,29,67 -5,28,67 -4,28,68 -4,26,68 -3,25,68 -3,24,68 -3,24,69 -2,24,70 -3,23,71 ' +
  '-4,23,72 -4,23,72 -5,23,72 -5,23,72 -6,23,72 -6,23,72 -7,23,72 -7,23,72 -7,23,72 -6,23,72 -6,23,71 -6,23,72 ' +
  '-7,23,72 -7,23,72 -6,23,72 -7,23,73 -7,23,73 -7,23,73 -6,24,71 -6,24,70 -6,25,70 -5,26,70'
).split(' ').map((triple) => triple.split(',').map((angle) => radians(Number(angle))));
const RECORDED_RATE = 8;

// ---- the events of phones, made consistent ----------------------------------------------------------------

// Reads the events of a phone. All phones agree on the angles: degrees, body fixed z-x-y from the ground to the phone.
// They differ in where alpha is zero, and in the sign of the acceleration.
export class Sensors {
  constructor() {
    this.north = null;   // what to add to alpha so that it counts from north; unknown at first
    this.sign = null;   // +1 if the acceleration at rest points up, -1 if it points down
    this.angles = null;
    this.force = null;
    this.rate = null;
  }

  // Read an event of kind deviceorientation or deviceorientationabsolute.
  orientation(event) {
    if (event.alpha === null || event.beta === null || event.gamma === null) return false;
    const [alpha, beta, gamma] = [event.alpha, event.beta, event.gamma].map(radians);
    if (event.absolute) this.north = 0;
    // On iOS alpha starts anywhere, but there is a compass: clockwise from north, for a phone that lies flat.
    const heading = event.webkitCompassHeading;
    if (this.north === null && heading >= 0 && Math.abs(event.beta) < 25 && Math.abs(event.gamma) < 25) {
      this.north = wrapped(-radians(heading) - alpha);
    }
    this.angles = [wrapped(alpha + (this.north ?? 0)), wrapped(beta), gamma];
    return true;
  }

  // Read an event of kind devicemotion. An accelerometer at rest measures an upward push, but one maker's phones report
  // the opposite; the angles say where up is, so we determine the sign. Returns whether there were any values, because
  // browsers without a sensor send an empty event.
  motion(event) {
    const felt = event.accelerationIncludingGravity, turning = event.rotationRate;
    const feels = felt && felt.x !== null, turns = turning && turning.alpha !== null;
    if (feels) {
      const force = [felt.x, felt.y, felt.z];
      if (this.sign === null && this.angles && Math.abs(length(force) / GRAVITY - 1) < 0.1) {
        const up = transpose(dcmFromBodyFixed(this.angles, 'zxy'))[2];
        const along = dot(up, force) / length(force);
        if (Math.abs(along) > 0.8) this.sign = Math.sign(along);
      }
      this.force = this.sign === null ? null : scale(this.sign, force);
    }
    // By the standard, and in every browser, alpha is about x here, beta about y and gamma about z.
    if (turns) this.rate = [turning.alpha, turning.beta, turning.gamma].map(radians);
    return Boolean(feels || turns);
  }
}

export const csv = (rows) => [COLUMNS.join(','), ...rows.map((row) => row.map(
  (value) => (Number.isFinite(value) ? String(Number(value.toFixed(5))) : '')).join(','))].join('\n') + '\n';

// Return the orientation of the recording at a time, as angles.
export function recorded(time) {
  const place = Math.min(time * RECORDED_RATE, RECORDED.length - 1), k = Math.min(Math.floor(place), RECORDED.length - 2);
  const [from, to] = [RECORDED[k], RECORDED[k + 1]].map((angles) => quaternionFromDcm(dcmFromBodyFixed(angles, 'zxy')));
  return bodyFixedFromDcm(dcmFromQuaternion(slerp(from, to, place - k)), 'zxy');
}

// ---- the figure ----------------------------------------------------------------------------------------

export function render({ model, el }) {
  const sensors = new Sensors();
  let alive = false, rows = [], began = null, recording = false, file = '';
  const sheet = new Sheet({ bounds: [-180, -172, 180, 172], size: SIZE, changed: () => redraw(),
    name: 'A phone, frame B, above the triad of the ground N.' });
  const redraw = onceAFrame(draw);
  const show = (angles) => change(model, { angles: angles.map(wrapped) });
  const sliders = ANGLES.map((name, k) => slider({ symbol: ['$\\alpha$', '$\\beta$', '$\\gamma$'][k], name,
    change: (value) => show(model.get('angles').map((angle, i) => (i === k ? value : angle))) }));
  const film = player({ name: 'time of the recording', seconds: (RECORDED.length - 1) / RECORDED_RATE, step: 1 / RECORDED_RATE,
    show: (time) => { if (!alive) show(recorded(time)); } });
  const use = button('Use the sensors of this phone', ask);
  const record = button(`Record ${RECORD_SECONDS} seconds`, () => { rows = []; began = null; recording = true; say(); }, { disabled: '' });
  const save = element('a', { class: 'button', download: 'phone.csv' }, 'Download phone.csv');   // shown once it has a link
  const copy = button('Copy for a cell', async () => {
    await navigator.clipboard.writeText(`phone = '''${file}'''\n`);
    text.say('Copied. Paste it into a cell, and phone will contain the text of the file.');
  }, { hidden: '' });
  const light = () => {};   // the headings explain these numbers
  const matrix = numberTable({ name: 'Direction cosine matrix of the phone with respect to the ground', kind: 'bracket', rows: B, columns: N,
    names: AXES.map((i) => AXES.map((j) => `b ${i} dot n ${j}`)), light });
  const quaternion = numberTable({ name: 'Quaternion, scalar first', columns: ['$q_0$', '$q_i$', '$q_j$', '$q_k$'],
    names: [['q 0', 'q i', 'q j', 'q k']], light });
  const felt = numberTable({ name: 'Specific force along the axes of the phone, in metres per second squared', columns: B,
    names: [['force b x', 'force b y', 'force b z']], light });
  const turning = numberTable({ name: 'Angular velocity along the axes of the phone, in degrees per second', columns: B,
    names: [['rate b x', 'rate b y', 'rate b z']], light });
  const text = liveText();
  // Once there is something to say about the sensors, it replaces the description of the sliders.
  let reported = false;
  const report = (words) => { reported = true; text.say(words); };
  open(el, stage(sheet, text),
    element('div', { class: 'controls' }, group('Sensors', 'row-of-controls', use, record, copy),
      ...sliders.map((slider) => slider.element), film.element),
    element('div', { class: 'readouts' },
      readout(['Direction cosine matrix ${}^B\\mathbf{C}^N$'], matrix.element),
      readout(['Quaternion'], quaternion.element), readout(['Specific force (m/s²)'], felt.element),
      readout(['Angular velocity (°/s)'], turning.element)));

  // One maker's phones require permission, asked for in a click; others begin to report at once.
  async function ask() {
    for (const kind of [window.DeviceOrientationEvent, window.DeviceMotionEvent]) {
      if (!kind?.requestPermission) continue;
      const answer = await kind.requestPermission().catch(() => 'denied');
      if (answer !== 'granted') {
        report('Access to the sensors was refused. Reload the page to be asked again. Meanwhile, play the recording.');
        return;
      }
    }
    listen();
    report('Waiting for the sensors ...');
    setTimeout(() => {
      if (alive) return;
      report(window.isSecureContext ? 'No sensor responds on this device: play the recording instead, or open this page on a phone.'
        : 'Browsers let only pages with a secure connection use the sensors: play the recording instead.');
    }, PATIENCE);
  }

  function listen() {
    // If the browser has an event with angles from north, ignore the other one, which starts anywhere.
    window.addEventListener('ondeviceorientationabsolute' in window ? 'deviceorientationabsolute' : 'deviceorientation', turned);
    window.addEventListener('devicemotion', moved);
  }

  function stop() {
    for (const name of ['deviceorientationabsolute', 'deviceorientation']) window.removeEventListener(name, turned);
    window.removeEventListener('devicemotion', moved);
  }

  function turned(event) {
    if (!sheet.svg.isConnected) { stop(); return; }
    if (!sensors.orientation(event)) return;
    if (!alive) {
      alive = true;
      film.pause();
      record.disabled = false;
      for (const slider of sliders) slider.element.querySelectorAll('input').forEach((input) => { input.disabled = true; });
      say();
    }
    show(sensors.angles);
  }

  function moved(event) {
    if (!sensors.motion(event)) return;
    if (alive) redraw();
    if (!recording || !alive) return;
    began ??= event.timeStamp;
    const time = (event.timeStamp - began) / 1000;
    rows.push([time, ...sensors.angles.map(degrees), ...sensors.force ?? [NaN, NaN, NaN], ...sensors.rate ?? [NaN, NaN, NaN]]);
    if (time < RECORD_SECONDS) return;
    recording = false;
    file = csv(rows);
    URL.revokeObjectURL(save.href);
    save.href = URL.createObjectURL(new Blob([file], { type: 'text/csv' }));
    copy.before(save);
    copy.hidden = false;
    say();
  }

  function say() {
    if (recording) { report(`Recording for ${RECORD_SECONDS} seconds: turn the phone.`); return; }
    if (file) { report(`${rows.length} samples are stored on this page, and nowhere else.`); return; }
    if (alive) {
      report(sensors.north === null ? 'The figure follows your phone. There is no compass, so $\\hat{n}_y$ is the direction it first pointed in.'
        : 'The figure follows your phone. $\\hat{n}_y$ is magnetic north.');
    }
  }

  function draw() {
    const angles = model.get('angles'), dcm = dcmFromBodyFixed(angles, 'zxy');
    sliders.forEach((one, k) => one.show(angles[k]));
    matrix.show(dcm.map((row) => row.map((entry) => fixed(entry))));
    quaternion.show([quaternionFromDcm(dcm).map((entry) => fixed(entry))]);
    felt.show([(sensors.force ?? scale(GRAVITY, transpose(dcm)[2])).map((entry) => fixed(entry, 2))]);
    turning.show([(sensors.rate ?? [0, 0, 0]).map((entry) => fixed(degrees(entry), 1))]);
    sheet.draw(() => picture(sheet, dcm));
    if (!reported) {
      text.say(`Body fixed z-x-y: $\\alpha$ = ${plainDegrees(angles[0], 0)}, $\\beta$ = ${plainDegrees(angles[1], 0)}, `
        + `$\\gamma$ = ${plainDegrees(angles[2], 0)}. The specific force and the angular velocity are those of a phone at rest.`);
    }
  }

  draw();
  film.at(0);
  const quiet = follow(model, ['angles'], redraw);
  return () => { stop(); quiet(); };
}
