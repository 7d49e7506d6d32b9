// The figure of the essay in the page: it stays while the text scrolls past and moves it, and the reader may take hold
// of it at any moment. What is shown follows the goal smoothly, a little later.
import { carriedBy, fragmentOf } from '../../moving/js/address.js';
import { AXES, add, dot, length, quaternionFromDcm, scale, several, times, transpose, unit, wrapped } from '../../moving/js/mathematics.js';
import { calm, element, put, words, write } from '../../moving/js/shared.js';
import { LABELS } from '../../moving/js/glyphs.js';
import { fullTurns } from '../../moving/js/belt_picture.js';
import { Sensors } from '../../moving/js/phone.js';
import { AT_READER, COURSE, CROOKED, EYES, FROM, GENERIC, LASTS, REST, STAR, TO, anglesNear, apart, axisOf, dcmOf, deg, frames, lookOf, motion, pairsOf, placed,
  project, sceneOf, turnOf, turned, turnedAlong, turnedFrame, WHOLE_WAYS } from './scene.js';
import { Painter } from './paint.js';
import { STOPS } from './stops.js';

const PLACE = 'rotations';
// Those that begin a part of the scene; essay.css puts a gap before each.
const PARAGRAPHS = ':scope > p + p:not(:has(+ .cell))';
const DEGREES = 180 / Math.PI, PI = Math.PI;
const say = (angle) => several(Math.round(angle * DEGREES), 'degrees');
// What the reader can set: its name, minimum, maximum, step, units per unit of the state, and the sign of the unit.
const DIALS = {
  psi: ['first motor', -180, 180, 1, DEGREES, '°', 0], theta: ['second motor', -180, 180, 1, DEGREES, '°', 1], phi: ['third motor', -180, 180, 1, DEGREES, '°', 2],
  away: ['carry the camera across', 0, 100, 1, 100, '%'], part: ['share of the way', 0, 100, 1, 100, '%'],
  together: ['both mirrors together', 0, 52, 1, 52, '°'], apart: ['mirrors apart', 0, 90, 1, 90, '°'], joined: ['swing the pairs together', 0, 100, 1, 100, '%'],
  whole: ['rotation of the camera', 0, 720, 1, DEGREES, '°'], turn: ['rotation of the camera', 0, 720, 1, DEGREES, '°'],
  passed: ['pass the cable round', 0, 200, 1, 100, '%'], time: ['time', 0, LASTS, 0.1, 1, ' s'],
};
const SCALARS = ['ride', 'away', 'part', 'whole', 'turn', 'passed', 'together', 'apart', 'laid', 'pairs', 'joined', 'time', 'own', 'faded'];
const FADES = ['machine', 'camera', 'A', 'D', 'ground'];
const SWING = [0.5, 0.4, 1.1];   // along A, in radians a second
const stopOf = (id) => STOPS.find((candidate) => candidate.id === id);
const fadesOf = (stop) => ({ ground: 1, ...stop });

class World {
  constructor(figure, sections) {
    this.figure = figure;
    this.sections = sections;
    this.state = { ...REST, angles: [...AT_READER], eye: [...REST.eye] };
    this.goal = { t: 0, angles: [...AT_READER], eye: [...REST.eye] };
    for (const name of SCALARS) this.goal[name] = 0;
    this.shown = Object.fromEntries(FADES.map((name) => [name, fadesOf(STOPS[0])[name]]));
    this.set = new Set();   // what the reader has set in this stop
    this.carry = null;   // the camera's way from its previous pose to that of this stop
    this.began = new Set();
    this.build();
    this.painter = new Painter(this.canvas);
    this.recolour();
    new ResizeObserver(() => this.resize()).observe(this.stage);
    this.resize();
    this.listen();
    if (sections.length) this.follow(); else this.enter(STOPS[0].id);
    this.takeUp();
  }

  // ---- building it -----------------------------------------------------------------------------------------

  build() {
    this.canvas = element('canvas', { tabindex: '0', role: 'application', 'aria-roledescription': 'camera gimbal',
      'aria-label': 'A camera gimbal. The arrow keys turn the camera, comma and full stop roll it. With Shift the arrow keys turn '
        + 'the view, and Home gives the camera back to the text.', 'data-lm-suppress-shortcuts': 'true' });
    this.names = element('div', { class: 'names', 'aria-hidden': 'true' });
    this.seen = element('p', { class: 'look', 'aria-hidden': 'true' });
    this.heard = element('p', { class: 'unseen', role: 'status' });
    this.numbers = element('div', { class: 'nine', hidden: true });
    this.dials = element('div', { class: 'dials' });
    const pressed = element('button', { type: 'button', 'aria-pressed': 'false', click: () => {
      this.numbers.hidden = !this.numbers.hidden;
      put(pressed, 'aria-pressed', String(!this.numbers.hidden));
      this.wake();
    } }, 'Numbers');
    const link = element('button', { type: 'button', click: () => this.copyAddress() }, 'Copy the address');
    this.phone = element('button', { type: 'button', hidden: true, click: () => this.askPhone() }, 'Turn it with this phone');
    if ('DeviceOrientationEvent' in window && matchMedia('(pointer: coarse)').matches) this.phone.hidden = false;
    this.stage = element('div', { class: 'scene' }, this.canvas, this.names, this.numbers);
    this.figure.append(element('div', { class: 'world-live' }, this.stage, this.seen, this.heard, this.dials,
      element('div', { class: 'tools' }, pressed, link, this.phone)));
  }

  recolour() {
    this.painter.recolour(getComputedStyle(this.figure));
    this.wake();
  }

  resize() {
    const { clientWidth, clientHeight } = this.stage, { wide, high } = this.painter;
    // An observer also calls when it begins to observe, which would draw the first picture twice.
    if (!clientWidth || !clientHeight || (clientWidth === wide && clientHeight === high)) return;
    this.half = Math.min(clientWidth, clientHeight) / 2;
    this.painter.resize(clientWidth, clientHeight);
    if (this.picture) this.draw();   // a new size empties the canvas
    this.wake();
  }

  listen() {
    const { canvas } = this;
    canvas.addEventListener('pointerdown', (event) => this.hold(event));
    canvas.addEventListener('pointermove', (event) => this.move(event));
    for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, (event) => this.release(event));
    // A finger on the machine takes hold of it; beside it, the page scrolls.
    canvas.addEventListener('touchstart', (event) => { if (this.partAt(this.at(event.touches[0]))) event.preventDefault(); }, { passive: false });
    canvas.addEventListener('keydown', (event) => this.press(event));
    canvas.addEventListener('dblclick', () => this.giveBack());
    canvas.addEventListener('webglcontextlost', (event) => event.preventDefault());
    canvas.addEventListener('webglcontextrestored', () => location.reload());
    addEventListener('scroll', () => this.follow(), { passive: true });
    addEventListener('resize', () => this.follow());
    addEventListener('hashchange', () => this.takeUp());
    new MutationObserver(() => this.recolour()).observe(document.documentElement, { attributeFilter: ['data-theme'] });
  }

  // ---- the text moves it -----------------------------------------------------------------------------------

  // Where a stop is, and where a link brings it. Reading begins at the line in the middle of the visible part of the text.
  place({ place }) {
    const { top, bottom } = place.getBoundingClientRect();
    const begins = Math.min(parseFloat(getComputedStyle(place).scrollMarginTop), top + scrollY), line = (begins + innerHeight) / 2;   // the first is higher up
    return { top, bottom, begins, line, isRead: top <= line };
  }

  // How many pixels are left to scroll until each mark of a stop: its place, the beginning of each paragraph and the end.
  course(section) {
    const { top, bottom, begins, line } = this.place(section), marks = [top - begins];
    const tops = [...section.place.querySelectorAll(PARAGRAPHS)].map((paragraph) => paragraph.getBoundingClientRect().top);
    for (const y of [...tops, bottom]) marks.push(Math.max(marks.at(-1) + 1, y - line));
    return { marks, count: marks.length - 1 };
  }

  // Find which stop is being read, and how much of it.
  follow() {
    if (!this.sections.length) return;
    const now = this.sections.findLast((section) => this.place(section).isRead) ?? this.sections[0];
    const { marks, count } = this.course(now), k = marks.findLastIndex((mark) => mark <= 0);
    const read = k < 0 ? 0 : k < count ? k - marks[k] / (marks[k + 1] - marks[k]) : count;
    this.enter(now.id);
    // Without motion, a paragraph's scene shows its outcome, but only when the reader has read on.
    this.goal.t = (calm() ? (read > 0.25 ? Math.ceil(read) : 0) : read) / count;
    if ((this.state.free || this.state.thrown || this.set.size) && Math.abs(this.goal.t - this.heldAt) > 0.22 && !this.held) this.takeBack();
    this.wake();
  }

  enter(id) {
    if (this.state.stop === id && this.began.has(id)) return;
    const stop = stopOf(id), before = dcmOf(this.state), { free } = this.state, first = !this.began.size;
    this.began = new Set([id]);
    this.state.stop = id;
    this.state.t = 0;
    this.state.free = false;
    this.state.thrown = null;
    this.state.track = [];
    this.set.clear();
    this.heldAt = null;
    for (const name of SCALARS) if (!['ride'].includes(name)) this.state[name] = 0;
    // The one rotation leads home from the pose that the reader left; from a pose nearly at home it would show nothing.
    const angles = anglesNear(before, this.state.angles);
    this.state.angles = angles;
    // The last stop keeps a pose of the reader's.
    if (id === 'your-turn') this.state.start = free ? angles : GENERIC;
    else this.state.start = free && axisOf(angles)[1] > 0.6 ? angles : CROOKED;
    if (!first && stop.by === 'camera') this.carry = { from: quaternionFromDcm(before), since: null };
    this.goal.eye = [...EYES[id] ?? REST.eye];
    this.showDials(stop);
    if (!first) this.tell(`${stop.before}`);
    this.passed = false;
  }

  // Set the goals that the text gives now.
  wanted() {
    const { state, goal } = this, course = COURSE[state.stop](state.t, state.start);
    if (course.angles && !state.free) goal.angles = course.angles;
    for (const name of SCALARS) if (!this.set.has(name)) goal[name] = course[name] ?? 0;
    // The cable is passed round a camera that stands still.
    if (!this.set.has('passed') && Math.abs(state.turn - goal.turn) > 1e-6) goal.passed = 0;
    state.lit = this.set.has('lit') ? state.lit : course.lit ?? 0;
    goal.own = state.free ? 1 : 0;
    if (state.free) goal.part = 0;
  }

  takeBack() {
    const before = this.shownDcm();
    this.state.free = false;
    this.state.thrown = null;
    this.set.clear();
    this.state.track = [];
    if (stopOf(this.state.stop).by === 'camera') this.carry = { from: quaternionFromDcm(before), since: null };
    this.wake();
  }

  giveBack() {
    this.goal.eye = [...EYES[this.state.stop] ?? REST.eye];
    this.takeBack();
  }

  lookFrom(azimuth, elevation) { this.goal.eye = [azimuth, Math.max(-20, Math.min(85, elevation)), this.goal.eye[2]]; }

  shownDcm() { return this.picture ? this.picture.frames.D : dcmOf(this.state); }

  // ---- one picture after another ---------------------------------------------------------------------------

  wake() {
    this.frame ||= requestAnimationFrame((now) => this.tick(now));
  }

  tick(now) {
    this.frame = 0;
    const { state, goal } = this;
    const passed = Math.min(0.1, this.before ? (now - this.before) / 1000 : 0.016);
    const rate = (seconds) => (calm() ? 1 : 1 - Math.exp(-passed / seconds));
    let still = true;
    const towards = (from, to, seconds, near) => {
      if (Math.abs(to - from) < near) return to;
      still = false;
      return from + (to - from) * rate(seconds);
    };
    state.t = towards(state.t, goal.t, 0.3, 1e-3);
    this.wanted();
    // Go to an angle given by the text by the short way, and to one of the reader's as it was moved.
    state.angles = state.angles.map((angle, k) => {
      const to = state.free ? goal.angles[k] : angle + wrapped(goal.angles[k] - angle);
      return towards(angle, to, state.free ? 0.035 : 0.22, 5e-4);
    });
    state.eye = state.eye.map((angle, k) => towards(angle, goal.eye[k], 0.12, 0.02));
    for (const name of SCALARS) state[name] = towards(state[name], goal[name], this.set.has(name) ? 0.05 : name === 'ride' ? 0.4 : 0.15, 1e-4);
    const fades = fadesOf(stopOf(state.stop));
    for (const name of FADES) this.shown[name] = towards(this.shown[name], fades[name], 0.3, 2e-3);
    state.shown = this.shown;
    if (this.carry) {
      this.carry.since ??= now;
      const part = calm() ? 1 : Math.min(1, (now - this.carry.since) / 900);
      state.carry = part < 1 ? { from: this.carry.from, part: part * part * (3 - 2 * part) } : null;
      if (part >= 1) this.carry = null;
      still = false;
    } else state.carry = null;
    this.picture = sceneOf(state);
    const { D } = this.picture.frames;
    if (state.stop === 'between-poses' && state.free && apart(D, state.track.at(-1)) > deg(0.5)) state.track = [...state.track, D].slice(-400);
    this.pace(now, still);   // before the drawing, because it may empty the canvas
    this.draw();
    this.before = still ? 0 : now;
    if (!still) this.wake();
  }

  draw() {
    this.painter.paint(this.picture);
    const dials = pairsOf(this.state) > 0.5 ? ['joined'] : stopOf(this.state.stop).dials;
    if (dials[0] !== this.open[0]?.name) this.showDials({ ...stopOf(this.state.stop), dials });
    this.drawNames();
    write(this.seen, this.words());
    if (!this.numbers.hidden) this.drawNumbers();
    this.showValues();
    if (!this.passed && this.state.t > 0.9) {
      this.passed = true;
      this.tell(stopOf(this.state.stop).after);
    }
    this.figure.dataset.state = this.state.stop;
  }

  // If the processor draws the graphics, fewer pixels are better than fewer pictures.
  pace(now, still) {
    if (still || !this.before) { this.slow = 0; return; }
    // A slow picture counts for up to three.
    const took = now - this.before;
    this.slow = took > 55 ? (this.slow ?? 0) + Math.min(3, took / 55) : 0;
    if (this.slow > 6 && this.painter.renderer.dpr > 0.6) {
      this.slow = 0;
      this.painter.resize(this.painter.wide, this.painter.high, Math.max(0.6, this.painter.renderer.dpr * 0.7));
    }
  }

  drawNames() {
    const { labels } = this.picture;
    this.written ??= new Map();
    const used = new Set(), boxes = [];
    for (const label of labels) {
      let name = `${label.text} ${label.colour}`;
      while (used.has(name)) name += '+';
      used.add(name);
      if (!this.written.has(name)) {
        const span = element('span', { class: `name ${label.colour}` });
        span.append(...(LABELS[label.text] && label.colour !== 'muted' ? words(`$${label.text}$`) : [label.text]));
        this.names.append(span);
        this.written.set(name, { span, size: [span.offsetWidth, span.offsetHeight] });
      }
      boxes.push(this.written.get(name));
    }
    for (const [name, { span }] of this.written) span.hidden = !used.has(name);
    const { clientWidth: wide, clientHeight: high } = this.stage;
    placed(this.picture, this.half, boxes.map(({ size }) => size), [wide, high]).forEach(([x, y], k) => {
      const [w, h] = boxes[k].size;
      boxes[k].span.style.transform = `translate(${(wide / 2 + x - w / 2).toFixed(1)}px, ${(high / 2 + y - h / 2).toFixed(1)}px)`;
    });
  }

  drawNumbers() {
    const { D } = this.picture.frames, q = this.quaternion(D);
    const number = (value) => (value < -5e-4 ? '\u2212' : '\u2007') + Math.abs(value).toFixed(3);
    if (!this.cells) {
      this.cells = Array.from({ length: 13 }, () => element('span', {}));
      const row = (head, from, to) => element('div', {}, element('b', {}, head), ...(from < 9 ? [element('span', {})] : []), ...this.cells.slice(from, to));
      const heads = AXES.map((axis) => element('span', {}, `$\\hat{a}_${axis}$`));
      this.numbers.append(element('div', {}, element('b', {}), element('span', {}), ...heads), ...AXES.map((axis, k) => row(`$\\hat{d}_${axis}$`, 3 * k, 3 * k + 3)), row('$q$', 9, 13));
    }
    // The quaternion is shown from the stop on that explains it.
    const early = STOPS.indexOf(stopOf(this.state.stop)) < STOPS.indexOf(stopOf('four-numbers'));
    this.cells[9].parentElement.hidden = early;
    this.numbers.classList.toggle('nine-only', early);
    D.flat().concat(q).forEach((value, k) => {
      write(this.cells[k], number(value));
      this.cells[k].classList.toggle('lit', this.state.stop === 'nine-shadows' && Math.floor(k / 3) === this.state.lit && k < 9);
    });
  }

  // Return the quaternion that continues the last one: the nearer of q and -q.
  quaternion(dcm) {
    let q = quaternionFromDcm(dcm);
    if (this.state.stop === 'four-numbers' && !this.state.free) {
      const half = this.state.whole / 2;
      if (dot(q, [Math.cos(half), 0, 0, 0]) < 0) q = scale(-1, q);
    } else if (this.q && dot(q, this.q) < 0) q = scale(-1, q);
    if (this.state.stop === 'not-home') q = [Math.cos(this.state.turn / 2), 0, Math.sin(this.state.turn / 2), 0];
    this.q = q;
    return q;
  }

  // ---- words -----------------------------------------------------------------------------------------------

  words() {
    const { state } = this, { A, D } = this.picture.frames, look = `The camera looks ${lookOf(D)}.`;
    const home = apart(A, D), [, turn] = turnOf(state), gap = Math.round(90 * state.apart);
    const more = {
      'one-motor': () => `First motor at ${say(state.angles[0])}: the two shadows are ${Math.cos(state.angles[0]).toFixed(2)} and ${Math.sin(state.angles[0]).toFixed(2)} long.`,
      'nine-shadows': () => `The shadows of the camera's ${'xyz'[state.lit]} arrow are ${D[state.lit].map((entry) => entry.toFixed(2)).join(', ')}.`,
      'looking-back': () => `${state.ride > 0.5 ? 'You ride with the camera' : 'You stand beside the hand'}. ${look}`,
      'three-are-enough': () => this.beside(D),
      'same-numbers': () => look.replace('The', 'The blue'),
      lock: () => {
        const margin = Math.abs(Math.abs(wrapped(state.angles[1])) - PI / 2);
        return margin < deg(1) ? `Locked: the first and the third motor turn about one line.${state.t > 0.52 ? ' No motor can follow the star.' : ''}`
          : `${look} The axes of the first and the third motor are ${say(margin < PI / 2 ? margin : PI - margin)} apart.`;
      },
      'one-turn': () => (home < deg(0.5) ? `${look} It is home.` : `${look} From here, one rotation of ${say(home)} leads home.`),
      'two-mirrors': () => `The mirrors are ${gap} degrees apart, and the arrow has turned ${2 * gap} degrees.`,
      'four-numbers': () => (pairsOf(state) > 0.5 ? 'Two rotations are four mirrors. Swung until 2 and 3 coincide, they are two.'
        : `Turned ${say(turn)}: the arrows of the mirrors are ${say(turn / 2)} apart.`),
      'not-home': () => this.cable(),
      'between-poses': () => this.way(D),
      'it-moves': () => (state.free ? look : `After ${state.time.toFixed(1)} seconds the ghost is ${say(apart(D, motion(state.time, state.thrown).told))} off.`),
    }[state.stop];
    const held = this.phoneWords ?? (more ? more() : look);
    return held.replaceAll('-0.00', '0.00').replace(/-(?=\d)/g, '\u2212');
  }

  beside(D) {
    const aside = Math.acos(Math.max(-1, Math.min(1, dot(D[1], STAR)))), look = `The camera looks ${lookOf(D)}.`;
    if (aside > deg(4)) return `${look} The star is ${say(aside)} away from where it looks.`;
    return lookOf(D).endsWith('level') ? 'It is on the star, and level. Three motors were enough.' : `On the star. Now level it: ${lookOf(D).split(', ')[2]}.`;
  }

  cable() {
    const { turn, passed } = this.state, once = fullTurns(turn) === 1, times = Math.round(passed);
    if (!fullTurns(turn)) {
      return (turn < 1e-8 ? 'The camera is as it was, and the cable is flat.' : `The camera has turned ${say(turn)}, and the cable has followed.`)
        + (passed > 0.02 ? ' You can pass it round after a whole turn.' : '');
    }
    if (Math.abs(passed - times) > 0.01) return 'The camera stands still while the cable is passed round it.';
    if (!times) return `After ${once ? 'one turn' : 'two turns'} the camera is as it was. The cable is not: it is twisted by ${once ? 'one turn' : 'two turns'}.`;
    if (times === 2) return once ? 'Passed round twice: the first twist is back. It will not go away.' : 'Passed round twice: two turns again, the other way.';
    return once ? 'Passed round: the twist is still there, the other way.' : 'Passed round: the cable is flat. Two turns are none.';
  }

  way(D) {
    const needed = this.needed ??= ['one', 'angles'].map((kind) => turnedAlong(WHOLE_WAYS.map((both) => both[kind])));
    const { track, free, part } = this.state;
    if (!free && !part) return `The camera is in pose 0. Pose 1 is ${say(needed[0])} away.`;
    if (!free) return `The single rotation takes ${say(needed[0])}. The red path, in angles, turns the camera through ${say(needed[1])} in all.`;
    const left = apart(D, frames(TO).D), taken = turnedAlong(track);
    if (left > deg(15)) return `Your path so far: ${say(taken)}. Pose 1 is ${say(left)} away, its roll included.`;
    return `Your path: ${say(taken + left)}. The single rotation: ${say(needed[0])}. In angles: ${say(needed[1])}.`;
  }

  // Announce a text when it has stayed the same for a while.
  tell(text) {
    clearTimeout(this.wait);
    this.wait = setTimeout(() => { this.heard.textContent = text; }, 500);
  }

  // ---- the reader takes hold of it ---------------------------------------------------------------------------

  at(event) {
    const box = this.canvas.getBoundingClientRect();
    return [event.clientX - box.left - box.width / 2, box.top + box.height / 2 - event.clientY];
  }

  onScreen(point) { return project(this.picture, point).slice(0, 2).map((entry) => entry * this.half); }

  // Return what is under the pointer: an arm with its point, or the camera.
  partAt(at) {
    if (!this.picture || this.state.stop === 'two-mirrors') return null;
    const { B, C } = this.picture.frames, stop = stopOf(this.state.stop), found = [];
    const far = (point) => Math.hypot(...this.onScreen(point).map((entry, k) => entry - at[k]));
    if (Math.hypot(at[0], at[1] - this.onScreen([0, 0, 0])[1]) < 0.3 * this.half) found.push({ part: 'D', near: 0.1 });
    // An arrow of the camera turns it, too.
    const reached = (row) => [0.6, 0.9, 1.2, 1.5].some((reach) => far(scale(reach, row)) < 16);
    if (stop.D > 0.5 && this.picture.frames.D.some(reached)) found.push({ part: 'D', near: 0.1 });
    if (stop.machine > 0.5 || stop.id === 'one-motor') {
      for (const [part, u, v, radius] of [['B', B[0], B[2], 1.05], ['C', C[0], C[1], 0.77]]) {
        for (let k = 0; k <= 24; k += 1) {
          const a = PI + PI * k / 24, point = add(scale(radius * Math.cos(a), u), scale(radius * Math.sin(a), v));
          if (far(point) < 20) found.push({ part, point, near: dot(this.picture.view[2], point) - 0.01 * far(point) });
        }
      }
    }
    return found.sort((a, b) => b.near - a.near)[0] ?? null;
  }

  seize() {
    const { state, goal } = this;
    this.heldAt = goal.t;
    this.phoneWords = null;
    if (state.free) return;
    let dcm = this.shownDcm();
    if (state.stop === 'between-poses') {
      dcm = frames(FROM).D;
      state.track = [dcm];
    }
    goal.angles = anglesNear(dcm, state.angles);
    state.angles = [...goal.angles];
    this.carry = null;
    state.thrown = null;
    state.free = true;
  }

  hold(event) {
    if (this.held || event.button > 0) return;
    const at = this.at(event), found = this.partAt(at);
    if (!found && event.pointerType === 'touch') return;
    this.held = { pointer: event.pointerId, at, ...found };
    this.swing = [];
    if (found && this.state.stop !== 'not-home') this.seize();
    this.canvas.setPointerCapture(event.pointerId);
    put(this.canvas, 'data-held', '');
  }

  move(event) {
    const at = this.at(event);
    if (!this.held) {
      if (event.pointerType === 'mouse') put(this.canvas, 'data-over', String(Boolean(this.partAt(at))));
      return;
    }
    if (this.held.pointer !== event.pointerId) return;
    const moved = [at[0] - this.held.at[0], at[1] - this.held.at[1]];
    this.held.at = at;
    const { goal, state } = this, { part } = this.held;
    if (!part) {
      this.lookFrom(goal.eye[0] - 0.4 * moved[0], goal.eye[1] - 0.4 * moved[1]);
    } else if (state.stop === 'not-home') {
      this.dial('turn', Math.max(0, Math.min(4 * PI, goal.turn + moved[0] / 60)));
    } else if (part === 'D') {
      this.turnBy(moved, event.timeStamp);
    } else {
      const k = part === 'B' ? 0 : 1, axis = k ? this.picture.frames.B[0] : [0, 0, 1];
      this.along(k, axis, moved);
    }
    this.wake();
  }

  // Rotate like a ball under the hand: the front follows the pointer.
  turnBy([right, up], when) {
    const { goal, state } = this, turn = Math.hypot(right, up) / (0.75 * this.half);
    if (!turn) return;
    const axis = times(transpose(this.picture.view), [-up, right, 0]);
    const before = frames(goal.angles).D, dcm = turnedFrame(axis, turn, before);
    goal.angles = anglesNear(dcm, goal.angles);
    this.swing = [...this.swing.slice(-20), { at: when, by: scale(turn, unit(axis)) }];
  }

  // Move an arm as far along its circle as the pointer moves.
  along(k, axis, moved) {
    const point = this.held.point, small = 0.02, ahead = turned(axis, small, point);
    const [from, to] = [this.onScreen(point), this.onScreen(ahead)];
    const way = [(to[0] - from[0]) / small, (to[1] - from[1]) / small], size = way[0] ** 2 + way[1] ** 2 + (0.25 * this.half) ** 2;
    const angle = Math.max(-0.3, Math.min(0.3, (moved[0] * way[0] + moved[1] * way[1]) / size));
    this.goal.angles = this.goal.angles.map((one, i) => (i === k ? one + angle : one));
    this.held.point = turned(axis, angle, point);
  }

  release(event) {
    if (this.held?.pointer !== event.pointerId) return;
    const { part } = this.held;
    this.held = null;
    this.canvas.removeAttribute('data-held');
    if (!part) return;
    const { goal } = this, round = Math.round(goal.turn / (2 * PI)) * 2 * PI;
    if (Math.abs(goal.turn - round) < deg(12)) goal.turn = round;   // no hand stops exactly after a whole turn
    if (part === 'D' && this.state.stop === 'it-moves') {
      // Throw it at the speed of the last tenth of a second.
      const lately = this.swing.filter(({ at }) => event.timeStamp - at < 100).map(({ by }) => by), last = this.swing.at(-1);
      const rate = lately.length ? scale(10, add(...lately)) : [0, 0, 0];
      if (last) this.throwIt(length(rate) > 0.4 ? rate : scale(0.4, unit(last.by)));
    }
    this.letGo();
  }

  // After a throw the camera keeps rotating at that rate, along A.
  throwIt(rate) {
    const { state } = this, dcm = frames(state.angles).D, fast = length(rate);
    if (fast < 0.2) return;
    state.thrown = { dcm, rate: times(dcm, scale(Math.min(1, 2.5 / fast), rate)) };
    state.free = false;
    state.time = 0;
    this.run('time', LASTS, 1000 * LASTS);
  }

  // Continue when the reader lets go, by hand or by key.
  letGo() {
    const { state, goal } = this;
    this.wake();
    if (state.stop === 'one-turn' && state.free) {
      state.start = goal.angles;
      state.angles = [...goal.angles];
      state.free = false;
      state.part = 0;
      this.run('part', 1, 3000);
    }
    requestAnimationFrame(() => { if (this.picture) this.tell(this.words()); });
  }

  // Run a value to its end by itself.
  run(name, to, lasts) {
    this.set.add(name);
    const begin = performance.now(), running = this.running = {};
    const tick = () => {
      if (this.held || !this.set.has(name) || this.running !== running) return;
      const part = calm() ? 1 : Math.min(1, (performance.now() - begin) / lasts);
      this.goal[name] = to * part;
      this.wake();
      if (part < 1) requestAnimationFrame(tick);
    };
    tick();
  }

  press(event) {
    const step = deg(event.altKey ? 1 : 5), { goal } = this;
    const turn = { ArrowLeft: [0, step], ArrowRight: [0, -step], ArrowUp: [1, step], ArrowDown: [1, -step], ',': [2, -step], '.': [2, step] }[event.key];
    if (event.key === 'Home') this.giveBack();
    else if (turn && event.shiftKey && event.key.startsWith('Arrow')) {
      this.lookFrom(...[0, 1].map((k) => goal.eye[k] + (k === turn[0] ? 6 * Math.sign(turn[1]) : 0)));
    } else if (turn && this.state.stop === 'not-home') this.dial('turn', Math.max(0, Math.min(4 * PI, goal.turn + 3 * turn[1])));
    else if (turn) {
      this.seize();
      goal.angles = goal.angles.map((angle, k) => (k === turn[0] ? angle + turn[1] : angle));
      this.letGo();
    } else return;
    event.preventDefault();
    this.wake();
  }

  // ---- dials -------------------------------------------------------------------------------------------------

  showDials(stop) {
    this.open = stop.dials.map((name) => {
      const [title, min, max, step, factor, sign, motor] = DIALS[name];
      const field = element('input', { type: 'range', min, max, step, 'aria-label': title, input: () => {
        const value = Number(field.value) / factor;
        if (motor >= 0) this.motor(motor, value); else this.dial(name, value);
        this.wake();
      }, change: () => this.letGo() });
      const value = element('output', {});
      return { name, field, value, factor, sign, motor, title, row: element('label', { class: `dial${motor >= 0 ? ` motor-${motor}` : ''}` }, element('span', {}, title), field, value) };
    });
    this.dials.replaceChildren(...this.open.map(({ row }) => row));
    const light = (k) => { this.state.lit = k; this.set.add('lit'); this.heldAt = this.goal.t; };
    const buttons = { 'it-moves': [['Set it swinging', () => { this.seize(); this.throwIt(SWING); }]],
      'nine-shadows': AXES.map((axis, k) => [`Shadows of $\\hat{d}_${axis}$`, () => light(k)]) }[stop.id];
    if (buttons) this.dials.append(element('div', { class: 'tools' }, ...buttons.map(([name, act]) => element('button', { type: 'button', click: () => {
      act();
      this.letGo();
    } }, name))));
  }

  showValues() {
    for (const { name, field, value, factor, sign, motor, title } of this.open) {
      const now = motor >= 0 ? wrapped(this.picture.angles[motor]) : this.state[name];
      const shown = String(Number((now * factor).toFixed(factor === 1 ? 1 : 0)) + 0);
      if (document.activeElement !== field || !this.set.has(name)) field.value = shown;
      write(value, `${shown}${sign}`.replace('-', '\u2212'));
      put(field, 'aria-valuetext', `${title}: ${several(shown, { '°': 'degrees', '%': 'per cent', ' s': 'seconds' }[sign])}`);
    }
  }

  motor(k, value) {
    this.seize();
    this.goal.angles = this.goal.angles.map((angle, i) => (i === k ? angle + wrapped(value - angle) : angle));
  }

  dial(name, value) {
    if (stopOf(this.state.stop).by === 'camera' && this.state.free) this.takeBack();
    this.running = null;
    this.set.add(name);
    this.heldAt = this.goal.t;
    this.goal[name] = value;
  }

  // ---- addresses ---------------------------------------------------------------------------------------------

  content() {
    const { state, goal } = this, round = (value) => Math.round(value * 1e4) / 1e4;
    const set = Object.fromEntries([...this.set].filter((name) => SCALARS.includes(name)).map((name) => [name, round(goal[name])]));
    const pose = state.free ? goal.angles : state.thrown && anglesNear(state.thrown.dcm, state.angles);
    return { stop: state.stop, t: round(goal.t), eye: goal.eye.slice(0, 2).map(round), ...(pose && { angles: pose.map(round) }),
      ...(state.thrown && { rate: state.thrown.rate.map(round) }), ...set };
  }

  async copyAddress() {
    const address = location.href.split('#')[0] + fragmentOf(PLACE, this.content());
    try {
      await navigator.clipboard.writeText(address);
      this.tell('The address is copied. Anyone who opens it sees the gimbal as it is now.');
      write(this.seen, 'The address is copied. Anyone who opens it sees the gimbal as it is now.');
    } catch {
      history.replaceState(null, '', address);   // then the address is in the address bar
    }
  }

  // Anybody may have written an address, so take over only what a reader could have entered.
  takeUp() {
    let carried = null;
    try {
      carried = carriedBy(location.hash);
    } catch (error) {
      this.tell(error.message);
      write(this.seen, error.message);
      return;
    }
    if (carried?.place !== PLACE) return;
    const { stop, t, eye, angles, rate, ...rest } = carried.content, known = stopOf(stop);
    if (!known) return;
    const numbers = (list, count, most) => Array.isArray(list) && list.length === count && list.every((number) => Number.isFinite(number) && Math.abs(number) <= most);
    const share = t >= 0 && t <= 1 ? t : 0, section = this.sections.find((candidate) => candidate.id === stop);
    if (section) {
      const { marks, count } = this.course(section), k = Math.min(count - 1, Math.floor(share * count));
      scrollTo({ top: scrollY + marks[k] + (share * count - k) * (marks[k + 1] - marks[k]), behavior: 'instant' });
      this.follow();
    } else {
      this.enter(stop);
      this.goal.t = share;
    }
    this.state.t = this.goal.t;
    if (numbers(eye, 2, 360)) this.lookFrom(...eye);
    if (numbers(angles, 3, 100)) {
      this.seize();
      this.goal.angles = angles;
      if (stop === 'it-moves' && numbers(rate, 3, 2.5)) {
        this.state.thrown = { dcm: frames(angles).D, rate };
        this.state.free = false;
      }
    }
    for (const name of SCALARS) {
      const dial = DIALS[name];
      if (dial && Number.isFinite(rest[name]) && rest[name] >= 0 && rest[name] * dial[4] <= dial[2] + 1e-6) {
        this.set.add(name);
        this.goal[name] = rest[name];
      }
    }
    this.heldAt = this.goal.t;
    this.wake();
  }

  // ---- the reader's own phone --------------------------------------------------------------------------------

  async askPhone() {
    const kind = window.DeviceOrientationEvent, report = (text) => { this.phoneWords = text; this.wake(); };
    if (kind?.requestPermission && await kind.requestPermission().catch(() => 'denied') !== 'granted') {
      return report('Access to the sensors was refused. You can still turn the gimbal with your finger.');
    }
    const sensors = new Sensors(), name = 'ondeviceorientationabsolute' in window ? 'deviceorientationabsolute' : 'deviceorientation';
    let first = null;
    addEventListener(name, (event) => {
      if (!this.canvas.isConnected || !sensors.orientation(event) || this.held) return;
      this.seize();
      // As in the standard, and in this gimbal: z-x-y from the ground to the phone, whose top edge is the lens.
      this.goal.angles = anglesNear(frames(sensors.angles).D, this.goal.angles);
      const q = this.quaternion(frames(sensors.angles).D), margin = Math.abs(Math.abs(sensors.angles[1]) - PI / 2);
      first ??= q;
      const along = dot(first, q);
      report(`The camera looks where the top of your phone points: ${lookOf(frames(sensors.angles).D)}.`
        + (margin < deg(8) ? ' You hold it upright: this is gimbal lock.' : along < -0.985 ? ' Once round: you are back, and q is now \u2212q.' : ''));
    });
    report('Waiting for the sensors of this device ...');
    setTimeout(() => first || report('No sensor responds here. You can still turn the gimbal with your finger.'), 3000);
  }
}

for (const figure of document.querySelectorAll('.world:not([data-ready], [data-stills])')) {
  const sections = [...document.querySelectorAll('[data-stop]')].map((still) => ({ id: still.dataset.stop, place: still.closest('section') ?? still, still }));
  try {
    figure.world = new World(figure, sections);
    figure.dataset.ready = '';
    // If the reader took hold of it while this script was loading, it is held from the first picture on.
    requestAnimationFrame(() => figure.pressed && figure.world.hold(figure.pressed));
  } catch (error) {
    if (error.message !== 'WebGL') throw error;
    // Without WebGL the stills are shown in turn in place of the figure.
    figure.dataset.stills = '';
    const still = figure.querySelector('.still');
    const show = () => {
      const line = 0.55 * innerHeight, now = sections.filter(({ place }) => place.getBoundingClientRect().top <= line).at(-1) ?? sections[0];
      const drawing = now?.still.querySelector('img, svg');
      if (drawing && still.dataset.shown !== now.id) {
        still.replaceChildren(drawing.cloneNode(true));
        still.dataset.shown = now.id;
      }
    };
    addEventListener('scroll', show, { passive: true });
    show();
  }
}
