// Shared parts of the moving figures: a sheet to draw on, in the style of orientation_figures.drawing, and
// controls for pointer, touch and keyboard. Each figure is a module with render({ model, el }), anywidget's
// contract; on a page of the book without a kernel, `start` gives it a model of its own.
import { add, degrees, dot, length, multiply, radians, scale, several, simpleDcm, subtract, times, transpose, unit } from './mathematics.js';
import { carriedBy, fragmentOf } from './address.js';
import { LABELS, OUTLINES } from './glyphs.js';
import { Model } from './model.js';
import { turned, Words } from './words_picture.js';

// ---- elements and words --------------------------------------------------------------------------------

const DRAWN = new Set(['svg', 'g', 'path', 'circle']);
const WITH_KEYS = new Set(['button', 'input', 'select', 'textarea']);
// On an element that has the focus, this keeps JupyterLab from taking the keys as its own shortcuts.
const OWN_KEYS = 'data-lm-suppress-shortcuts';
// In text fields JupyterLab cancels Enter nevertheless, so there the events of keys must not propagate.
const TAKES_TEXT = 'textarea, input:is([type=text], [type=number])';

// Create an element with attributes (functions are event listeners) and children; $...$ in a text is mathematics.
export function element(tag, attributes = {}, ...children) {
  const made = DRAWN.has(tag) ? document.createElementNS('http://www.w3.org/2000/svg', tag) : document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === 'function') made.addEventListener(name, value);
    else if (value !== undefined && value !== false) made.setAttribute(name, value === true ? '' : value);
  }
  if (WITH_KEYS.has(tag)) made.setAttribute(OWN_KEYS, 'true');
  if (made.matches(TAKES_TEXT)) made.addEventListener('keydown', (event) => event.stopPropagation());
  made.append(...children.flatMap((child) => (typeof child === 'string' ? words(child) : child)));
  return made;
}

// Set an attribute or a text only if it changed, since writing costs more than comparing.
export function put(target, name, value) {
  if (target.getAttribute(name) !== value) target.setAttribute(name, value);
}

// The same for the text of an element. It keeps its only text node, because a new one would be laid out again.
export function write(target, text) {
  if (!target.firstChild) target.append(text);
  else if (target.firstChild.data !== text) target.firstChild.data = text;
}

export const spoken = (text) => text.replace(/\$([^$]*)\$/g, (_, tex) => tex
  .replace(/\\(hat|mathbf|cdot|left|right)/g, ' ').replace(/\\varphi/g, 'phi').replace(/[\\{}^_]/g, ' ').trim())
  .replace(/\s+/g, ' ');

function glyphs(tex) {
  const label = LABELS[tex];
  if (!label) throw new Error(`no glyphs for ${tex}: add it to LABELS in orientation/moving/glyphs.py`);
  return label.glyphs.map(([outline, x, y, size]) => element('path', {
    d: OUTLINES[outline], transform: `translate(${x} ${y})${size === 1 ? '' : ` scale(${size})`}` }));
}

// Return a formula, typeset in a line of text.
function formula(tex) {
  const parts = glyphs(tex), [left, top, right, bottom] = LABELS[tex].ink;
  return element('svg', { class: 'formula', viewBox: `${left} ${top} ${right - left} ${bottom - top}`, role: 'img',
    'aria-label': spoken(`$${tex}$`),
    // Glyphs are placed from the middle of a small letter, 220 units above the line.
    style: `width:${(right - left) / 1000}em;height:${(bottom - top) / 1000}em;vertical-align:${(220 - bottom) / 1000}em` },
  ...parts);
}

export const words = (text) => text.split('$').map((part, k) => (k % 2 ? formula(part) : part)).filter((part) => part !== '');

// Set the text of an element, with $...$ in it. Formulas stay while only numbers change, because typesetting them again
// would be most of the work of a drag.
const written = new WeakMap();
export function writeWords(target, text) {
  const before = written.get(target) ?? [], parts = text.split('$');
  written.set(target, parts);
  if (parts.length === before.length && parts.every((part, k) => k % 2 === 0 || part === before[k])) {
    parts.forEach((part, k) => { if (part !== before[k]) target.childNodes[k].data = part; });
  } else {
    target.replaceChildren(...parts.map((part, k) => (k % 2 ? formula(part) : document.createTextNode(part))));
  }
}

// Format numbers with a typographic minus and a space of equal width for positive ones.
export function fixed(value, digits = 3) {
  const text = Math.abs(value).toFixed(digits);
  return (value < 0 && Number(text) !== 0 ? '\u2212' : '\u2007') + text;
}

// Format degrees for a field, such as '35' or '-12.5', without the rounding error of the conversion; an angle for a text.
export const plain = (value, digits = 2) => String(Number(value.toFixed(digits)) + 0);
export const plainDegrees = (angle, digits = 2) => `${plain(degrees(angle), digits).replace('-', '\u2212')}°`;

// ---- cameras -------------------------------------------------------------------------------------------

// Return V_C_N of an upright camera, like orientation_figures.drawing.view_from.
export function viewFrom(azimuth, elevation) {
  const [x, y, z] = multiply(simpleDcm('y', -elevation), simpleDcm('z', azimuth));
  return [y, z, x];
}

// ---- the sheet -----------------------------------------------------------------------------------------

const pair = ([x, y]) => `${Math.round(10 * x) / 10} ${Math.round(10 * y) / 10}`;

function pathData(commands, points) {
  let data = '', k = 0;
  for (const letter of commands) {
    data += letter;
    for (let left = { M: 1, L: 1, C: 3, Z: 0 }[letter]; left > 0; left -= 1) {
      data += `${pair(points[k])} `;
      k += 1;
    }
  }
  return data;
}

const polygon = (count) => `M${'L'.repeat(count - 1)}Z`;

// A sheet is drawn again for every picture, by `draw(sheet => ...)`, with the methods of orientation_figures.words. It
// keeps its elements and changes only the differences. Marks are sorted by the depth of their middle, along v_z, within
// the `layer` in which they are drawn.
export class Sheet extends Words {
  // bounds: left, top, right, bottom in pixels from the origin; camera: azimuth and elevation in degrees; changed:
  // called when the reader rotates the view; grab(part, at): called when the reader takes hold of a grip, returns a
  // function of the pointer's position, or nothing to rotate the view.
  constructor({ name, bounds: [left, top, right, bottom], size = 120, camera = [32, 24], changed, grab }) {
    super();
    this.size = size;
    this.grab = grab;
    this.home = camera;
    this.layers = ['marks', 'labels', 'grips'].map((kind) => element('g', { class: kind }));
    this.pools = [[], new Map(), new Map()];
    this.svg = element('svg', { viewBox: `${left} ${top} ${right - left} ${bottom - top}`, class: 'sheet',
      style: `max-width:${1.2 * (right - left)}px`, tabindex: '0', [OWN_KEYS]: 'true',
      role: 'application', 'aria-roledescription': 'drawing',
      'aria-label': `${name} The arrow keys turn the view, Home turns it back.`,
      // A finger on a grip must not scroll the page; inside an SVG drawing, touch-action has no effect.
      touchstart: (event) => { if (event.target.dataset.part) event.preventDefault(); },
      pointerdown: (event) => this.hold(event), pointermove: (event) => this.move(event),
      pointerup: (event) => this.release(event), pointercancel: (event) => this.release(event),
      keydown: (event) => this.press(event), dblclick: () => this.look(...this.home) }, ...this.layers);
    this.look(...camera);
    this.changed = changed;
  }

  look(azimuth, elevation) {
    this.camera = [azimuth, Math.max(-90, Math.min(90, elevation))];
    this.view = viewFrom(...this.camera.map(radians));
    this.changed?.();
  }

  press(event) {
    const [azimuth, elevation] = this.camera;
    const turn = { ArrowLeft: [5, 0], ArrowRight: [-5, 0], ArrowUp: [0, 5], ArrowDown: [0, -5] }[event.key];
    if (turn) this.look(azimuth + turn[0], elevation + turn[1]);
    else if (event.key === 'Home') this.look(...this.home);
    else return;
    event.preventDefault();
  }

  // Return the position of the pointer, in pixels of the sheet.
  pointer(event) {
    const place = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.toSheet);
    return [place.x, place.y];
  }

  hold(event) {
    if (this.held || event.button > 0) return;
    this.toSheet = this.svg.getScreenCTM().inverse();
    const at = this.pointer(event), [azimuth, elevation] = this.camera;
    const turn = (to) => this.look(azimuth - 0.5 * (to[0] - at[0]), elevation + 0.5 * (to[1] - at[1]));
    this.held = { pointer: event.pointerId, move: this.grab?.(event.target.dataset.part, at) ?? turn };
    this.svg.setPointerCapture(event.pointerId);
    put(this.svg, 'data-held', '');
  }

  move(event) {
    if (this.held?.pointer === event.pointerId) this.held.move(this.pointer(event));
  }

  release(event) {
    if (this.held?.pointer !== event.pointerId) return;
    this.held = null;
    this.svg.removeAttribute('data-held');
  }

  draw(picture) {
    this.marks = [];
    this.layer = 0;
    this.faded = false;
    this.used = [new Set(), new Set()];
    picture(this);
    this.finish();
  }

  // Every mark keeps its element from one picture to the next, because marks are drawn in the same order; if
  // their depths are reordered, so are the elements.
  finish() {
    const [pool, labels, grips] = this.pools, [layer] = this.layers;
    this.marks.forEach((mark, k) => {
      pool[k] ??= element('path');
      put(pool[k], 'class', mark.kind);
      put(pool[k], 'd', mark.data);
      mark.path = pool[k];
    });
    pool.slice(this.marks.length).forEach((path) => path.remove());
    let next = null;
    for (const { path } of this.marks.sort((a, b) => a.depth - b.depth).reverse()) {
      if (path.nextSibling !== next || !path.parentNode) layer.insertBefore(path, next);
      next = path;
    }
    for (const [k, known] of [labels, grips].entries()) {
      for (const [name, made] of known) put(made, 'visibility', this.used[k].has(name) ? 'visible' : 'hidden');
    }
  }

  onSheet(point) {
    return [this.size * dot(this.view[0], point), -this.size * dot(this.view[1], point)];
  }

  // `points` are on the sheet, `depth` along v_z. A path that has shrunk to a point is invisible.
  path(commands, points, kind, depth = 0) {
    const [x, y] = points[0];
    if (points.some(([u, v]) => Math.abs(u - x) > 1e-6 || Math.abs(v - y) > 1e-6)) {
      this.marks.push({ kind: kind + (this.faded ? ' faded' : ''), data: pathData(commands, points),
        depth: 1000 * this.layer + depth });
    }
    return this;
  }

  // Return the point of N that is seen at a place of the sheet.
  placed(right, down) {
    return times(transpose(this.view), [right / this.size, -down / this.size, 0]);
  }

  // A fading label is either visible or not, because a transparent one would be illegible.
  text(text, place, colour, size = 20, opacity = 1) {
    if (opacity <= 0.4) return this;
    const tex = text.replaceAll('$', ''), [, labels] = this.pools;
    let name = tex;
    while (this.used[0].has(name)) name += '\'';   // the same text may be in two places
    this.used[0].add(name);
    if (!labels.has(name)) labels.set(name, this.layers[1].appendChild(element('g', {}, ...glyphs(tex))));
    const made = labels.get(name);
    put(made, 'class', `text ${colour}${this.faded ? ' faded' : ''}`);
    put(made, 'transform', `translate(${pair(place)}) scale(${size / 1000})`);
    return this;
  }

  // Add a grip for the reader; `part` is passed to grab(part, at).
  grip(point, part, radius = 18) {
    const [x, y] = this.onSheet(point), made = this.gripElement(part, 'circle');
    put(made, 'r', String(radius));
    put(made, 'cx', x.toFixed(1));
    put(made, 'cy', y.toFixed(1));
  }

  // Add a grip along a closed line.
  gripLine(points, part) {
    put(this.gripElement(part, 'path'), 'd', pathData(polygon(points.length), points.map((p) => this.onSheet(p))));
  }

  gripElement(part, tag) {
    const [, , grips] = this.pools;
    this.used[1].add(part);
    if (!grips.has(part)) grips.set(part, this.layers[2].appendChild(element(tag, { class: 'grip', 'data-part': part })));
    return grips.get(part);
  }
}

// Follow the pointer with a point that can only move on a circle: returns a function from the position of the
// pointer to the angle, in whole degrees, that brings the rotated `arm` nearest to it.
export function followTurn(sheet, { axis, arm, angle, at, origin = [0, 0, 0] }) {
  const shift = subtract(sheet.onSheet(add(origin, turned(axis, angle, arm))), at);
  const places = Array.from({ length: 360 }, (_, k) => sheet.onSheet(add(origin, turned(axis, radians(k), arm))));
  const spread = Math.max(...places.map((place) => length(subtract(place, places[0]))));
  const begin = Math.round(degrees(angle));
  // A circle too small to follow is rotated like a knob.
  if (spread < 40) return (to) => radians(begin + Math.round(0.7 * (to[0] - at[0])));
  let now = begin;
  return (to) => {
    const wanted = add(to, shift);
    let best = Infinity, found = now;
    for (let step = -60; step <= 60; step += 1) {
      // Where the circle is seen edge-on, two angles are equally near; choose the one closer to the last.
      const far = length(subtract(places[(((now + step) % 360) + 360) % 360], wanted)) + 0.02 * Math.abs(step);
      if (far < best) [best, found] = [far, now + step];
    }
    now = found;
    return radians(now);
  };
}

// Follow the pointer with the tip of a vector of constant length: returns a function from the position of the
// pointer to its direction. Beyond the edge of the sphere the tip goes round to the other side. Close to a
// unit vector of N it snaps to it.
export function followSphere(sheet, { vector, at }) {
  const radius = length(vector) * sheet.size, shift = subtract(sheet.onSheet(vector), at);
  const side = dot(sheet.view[2], vector) < 0 ? -1 : 1, back = transpose(sheet.view);
  return (to) => {
    const [x, y] = add(to, shift), out = Math.hypot(x, y) || 1, inside = Math.min(out, Math.max(0, 2 * radius - out));
    const depth = (out > radius ? -side : side) * Math.sqrt(Math.max(0, radius * radius - inside * inside));
    const direction = unit(times(back, [x * inside / out, -y * inside / out, depth]));
    const near = direction.findIndex((entry) => Math.abs(entry) > 0.9985);
    return near < 0 ? direction : direction.map((entry, k) => (k === near ? Math.sign(entry) : 0));
  };
}

// ---- controls ------------------------------------------------------------------------------------------

export const button = (text, click, attributes = {}) => element('button', { type: 'button', click, ...attributes }, text);

// A group of controls with a name for readers who cannot see that they belong together.
export const group = (name, kind, ...children) => element('div', { role: 'group', 'aria-label': name, class: kind }, ...children);

// A number field. `show` does not change what the reader is typing.
export function numberField({ name, step = 0.1, min = -Infinity, max = Infinity, change, digits = 3 }) {
  const field = element('input', { type: 'number', 'aria-label': name, step, inputmode: 'decimal',
    input() {
      const value = field.valueAsNumber, valid = value >= min && value <= max;
      put(field, 'aria-invalid', String(!valid));
      if (valid) change(value);
    },
    // Many browsers silently omit a decimal comma, and the minus sign of the book's own numbers.
    beforeinput(event) {
      if (!/[,\u2212\u2013]/.test(event.data)) return;
      event.preventDefault();
      document.execCommand('insertText', false, event.data.replace(',', '.').replace(/[\u2212\u2013]/, '-'));
    },
    // Outside the range, wrap an angle into one turn, and move any other number to the nearest end.
    change() {
      const value = field.valueAsNumber, whole = max - min === 360;
      if (value >= min && value <= max) return;
      field.value = Number.isNaN(value) ? field.dataset.value : plain(whole ? value - 360 * Math.round(value / 360) : Math.min(Math.max(value, min), max), digits);
      field.dispatchEvent(new Event('input'));
    },
    blur: () => { field.value = field.dataset.value; } });
  return { element: field, show(value) {
    field.dataset.value = plain(value, digits);
    if (document.activeElement !== field && field.value !== field.dataset.value) field.value = field.dataset.value;
  } };
}

// A slider with its symbol, a field for the same number, and further forms of it. `factor` is one displayed
// unit in the units of the model.
export function slider({ symbol, name, unit: unitName = 'degrees', sign = '°', factor = Math.PI / 180, min = -180, max = 180,
  step = 1, digits = 2, change, more = (value) => `${fixed(value)} rad` }) {
  const range = element('input', { type: 'range', min, max, step, 'aria-label': name, input: () => change(factor * range.value) });
  const field = numberField({ name: `${name} in ${unitName}`, step, min, max, digits, change: (value) => change(factor * value) });
  const rest = element('span', { class: 'more', 'aria-hidden': 'true' });
  return {
    element: element('div', { class: 'slider' }, element('span', { class: 'symbol', 'aria-hidden': 'true' }, symbol), range,
      element('span', { class: 'field' }, field.element, sign), rest),
    show(value) {
      const shown = plain(value / factor, digits);
      if (range.value !== shown) range.value = shown;
      put(range, 'aria-valuetext', `${name}, ${several(shown, unitName)}`);
      field.show(value / factor);
      write(rest, more(value));
    },
    mark: (kind) => put(range.parentNode, 'class', `slider ${kind}`),
  };
}

// A list to choose from; options are [value, text] or just values.
export function choice({ name, options, change, hidden = false }) {
  const list = element('select', { 'aria-label': name, change: () => change(list.value) },
    ...options.map((option) => element('option', { value: [option].flat()[0] }, [option].flat().at(-1))));
  return { element: element('label', { class: 'choice' }, element('span', { 'aria-hidden': 'true', hidden }, name), list),
    show: (value) => { list.value = value; } };
}

// Rows of cells with their row and column headings; `kind` 'bracket' sets them as a matrix.
export function grid({ name, rows, columns, cells, kind = '' }) {
  const head = (text, side) => element('span', { class: `head-of-${side}`, 'aria-hidden': 'true' }, text);
  return group(name, `numbers ${kind}`,
    ...(columns ? [element('div', { class: 'row' }, ...(rows ? [head('', 'row')] : []),
      ...columns.map((text) => head(text, 'column')))] : []),
    ...cells.map((row, i) => element('div', { class: 'row' }, ...(rows ? [head(rows[i], 'row')] : []), ...row)));
}

// Numbers that explain themselves: a single stop of the Tab key, arrow keys inside. `names` are the spoken
// names, row by row; `rows` and `columns` are the headings; `light(row, column)` is called when a number is
// touched or focused, and `light()` afterwards.
export function numberTable({ name, names, rows, columns, light, kind = '' }) {
  const at = (i, j) => {
    const cell = element('button', { type: 'button', class: 'number', tabindex: i + j ? -1 : 0, 'data-at': `${i},${j}`,
      pointerenter: (event) => { if (event.pointerType === 'mouse') light(i, j); },
      pointerleave: (event) => { if (event.pointerType === 'mouse') relight(); },
      focus() {
        cells.flat().forEach((another) => { another.tabIndex = another === cell ? 0 : -1; });
        light(i, j);
      },
      blur: () => light(),
      click: () => cell.focus() });   // not every browser focuses a button that is touched
    return cell;
  };
  const cells = names.map((row, i) => row.map((_, j) => at(i, j)));
  const relight = () => {
    const focused = cells.flat().find((cell) => cell.matches(':focus'));
    light(...(focused ? focused.dataset.at.split(',').map(Number) : []));
  };
  const box = grid({ name, rows, columns, cells, kind });
  box.addEventListener('keydown', (event) => {
    const step = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0] }[event.key];
    if (event.key === 'Escape') event.target.blur();
    if (!step) return;
    const [i, j] = event.target.dataset.at.split(',').map(Number);
    cells[i + step[0]]?.[j + step[1]]?.focus();
    event.preventDefault();
  });
  return { element: box, show: (values) => values.forEach((row, i) => row.forEach((value, j) => {
    const cell = cells[i][j];
    write(cell, value);
    put(cell, 'aria-label', `${names[i][j]}: ${value}`);
  })) };
}

// Text under the figure. It changes at once on screen, and is read aloud once it has stayed the same for a while.
export function liveText() {
  const seen = element('p', { class: 'words', 'aria-hidden': 'true' }), heard = element('p', { class: 'unseen', role: 'status' });
  let now = null, wait = 0;
  return { element: element('div', {}, seen, heard), say(text) {
    if (text === now) return;
    now = text;
    writeWords(seen, text);
    clearTimeout(wait);
    wait = setTimeout(() => { heard.textContent = spoken(text); }, 600);
  } };
}

export const calm = () => matchMedia('(prefers-reduced-motion: reduce)').matches;

// Call `draw` once before the next picture, however often it is requested.
export function onceAFrame(draw) {
  let asked = 0;
  return () => { asked ||= requestAnimationFrame(() => { asked = 0; draw(); }); };
}

// Return the value of a generator, run in slices of a few milliseconds to keep the page responsive, while it is wanted.
export async function inSlices(steps, isWanted) {
  for (;;) {
    await new Promise((resume) => { setTimeout(resume); });
    if (!isWanted()) return undefined;
    const until = performance.now() + 5;
    let step = steps.next();
    while (!step.done && performance.now() < until) step = steps.next();
    if (step.done) return step.value;
  }
}

// A button and a slider for an animation from 0 to `seconds`. It starts only on request; for readers who
// prefer less motion it proceeds in steps of half a second.
export function player({ name, seconds, step = 0.05, show }) {
  let now = 0, before = null, frame = 0;
  const time = slider({ symbol: '$t$', name, unit: 'seconds', sign: 's', factor: 1, min: 0, max: seconds, step, more: () => '',
    change: (value) => { pause(); set(value); } });
  const press = button('Play', () => (frame ? pause() : play()));
  // Set the position in the state.
  function at(value) {
    now = value;
    time.show(value);
  }
  function set(value) {
    at(value);
    show(value);
  }
  function pause() {
    cancelAnimationFrame(frame);
    frame = 0;
    write(press, 'Play');
  }
  function tick(moment) {
    // The time of a picture may be before the click that requested it, so compare only pictures.
    before ??= moment;
    const passed = Math.min((moment - before) / 1000, 1);
    if (!press.isConnected) { pause(); return; }
    if (!calm() || passed >= 0.5) {
      before = moment;
      set(Math.min(now + passed, seconds));
    }
    if (now >= seconds) pause(); else frame = requestAnimationFrame(tick);
  }
  function play() {
    if (now >= seconds) set(0);
    before = null;
    write(press, 'Pause');
    frame = requestAnimationFrame(tick);
  }
  return { element: group(name, 'player', press, time.element), at, set, pause };
}

// Move a number from 0 to 1 in `seconds`, or jump to the end for readers who prefer less motion.
export function glide(show, seconds = 0.7) {
  let frame = 0, begin;
  const tick = (moment) => {
    begin ??= moment;
    const part = Math.min((moment - begin) / 1000 / seconds, 1);
    show(part * part * (3 - 2 * part));
    if (part < 1) frame = requestAnimationFrame(tick);
  };
  if (calm()) show(1); else frame = requestAnimationFrame(tick);
  return () => cancelAnimationFrame(frame);
}

// A result with its title.
export const readout = (title, ...parts) => element('div', { class: 'readout' }, element('div', { class: 'title' },
  ...title.map((part) => (typeof part === 'string' ? element('span', {}, part) : part))), ...parts);

// The drawing with the text under it; on a narrow screen it stays in view while the controls scroll.
export const stage = (sheet, text) => element('div', { class: 'stage' }, sheet.svg, text.element);

// ---- opening and closing ---------------------------------------------------------------------------------

// Return the element that a figure fills: beside the still on a page of the book, or else a new figure.
export function open(el, ...children) {
  const live = element('div', { class: 'live' }, ...children);
  if (!el.closest('.moving')) el.append(element('div', { class: 'orientation-figure moving' }, live));
  else el.append(live);
  return live;
}

// Read the state whenever it changes; returns the function that anywidget calls when a figure closes.
export function follow(model, names, changed) {
  const events = names.map((name) => `change:${name}`);
  events.forEach((event) => model.on(event, changed));
  return () => events.forEach((event) => model.off(event, changed));
}

export function change(model, values) {
  for (const [name, value] of Object.entries(values)) model.set(name, value);
  model.save_changes();
}

// Check whether foreign data have the structure of known data: numbers for numbers, and as many of them.
function alike(value, known) {
  if (typeof known === 'number') return Number.isFinite(value) && Math.abs(value) < 1e6;
  if (Array.isArray(known)) {
    const numbers = typeof known[0] === 'number';
    return Array.isArray(value) && value.length <= 64 && (!numbers || value.length === known.length) && value.every((entry) => alike(entry, known[0]));
  }
  if (known === null || value === null || typeof value !== typeof known) return false;
  if (typeof known === 'object') return Object.keys(value).every((key) => key in known && alike(value[key], known[key]));
  return typeof known === 'boolean' || value.length <= 200;
}

// Return the state of a figure from the address of its page, by its label or kind; if it is alone, by any name.
function carriedTo(figure, name, state) {
  const label = figure.parentElement?.closest('figure[id], div[id]')?.id;
  try {
    const carried = carriedBy(location.hash);
    if (!carried || (label && ![name, label].includes(carried.place))) return {};
    return Object.fromEntries(Object.entries(carried.content).filter(([key, value]) => key in state && alike(value, state[key])));
  } catch (error) {
    // An address that cannot be read opens the figure that it names in its initial state, and says so.
    if (!label || [name, label].some((place) => location.hash.startsWith(`#${place}=`))) figure.before(element('p', { role: 'alert' }, error.message));
    return {};
  }
}

// Once a figure has been moved, show the link at the end of its caption, which leads to the figure in its present state
// and copies that address.
function offerAddress(figure, first) {
  const whole = figure.parentElement?.closest('figure[id]'), link = whole?.querySelector('figcaption a.headerlink');
  if (!link) return;
  const mark = link.textContent;
  const renew = () => {
    const moved = Object.keys(first).filter((name) => JSON.stringify(figure.model.get(name)) !== JSON.stringify(first[name]));
    link.toggleAttribute('data-moved', moved.length > 0);
    if (!moved.length) return;
    put(link, 'title', 'Copy the address of the figure as it stands');
    put(link, 'aria-label', link.title);
    try {
      put(link, 'href', fragmentOf(whole.id, Object.fromEntries(moved.map((name) => [name, figure.model.get(name)]))));
    } catch { /* too much for an address: the link leads to the figure */ }
  };
  for (const type of ['pointerup', 'keyup', 'change', 'click']) figure.addEventListener(type, renew);
  for (const type of ['pointerenter', 'focus']) link.addEventListener(type, renew);
  link.addEventListener('click', async () => {
    renew();   // where copying is not allowed, the address is in the bar
    if (!link.matches('[data-moved]') || !await navigator.clipboard?.writeText(link.href).then(() => true, () => false)) return;
    link.textContent = 'copied';
    setTimeout(() => { link.textContent = mark; }, 2000);
  });
  renew();
}

export function start(name, render) {
  for (const figure of document.querySelectorAll(`.moving[data-figure="${name}"]:not([data-ready])`)) {
    const state = JSON.parse(figure.dataset.state), carried = carriedTo(figure, name, state);
    const begin = (values) => {
      figure.model = new Model(values);
      render({ model: figure.model, el: figure });
    };
    try {
      begin({ ...state, ...carried });
    } catch (error) {
      // A state that no reader could have set is not shown.
      if (!Object.keys(carried).length) throw error;
      figure.querySelector('.live')?.remove();
      begin(state);
    }
    offerAddress(figure, state);
    if (Object.keys(carried).length) figure.scrollIntoView({ block: 'nearest' });
    figure.dataset.ready = '';
  }
}
