import { AXES, IDENTITY, add, multiply, scale, simpleDcm, times, transpose } from './mathematics.js';
import { Sheet, button, change, choice, element, fixed, follow, group, liveText, numberTable, onceAFrame, open, radians,
  readout, slider, stage, write, writeWords } from './shared.js';

const SIZE = 96, REACH = 0.5, ACROSS = 100, DOWN = 100, LEFT = -130;   // as in graph.py
const SHORT = 14, CORNERS = [[-19, 18], [-19, -18], [19, 18], [19, -18]];   // pixels
const LETTERS = 'NABCDE';
const dcmName = (target, source) => `\${}^${target}\\mathbf{C}^${source}$`;

// Where each frame is drawn: its depth in the tree, and its line.
function places(edges) {
  const children = { N: [] }, depth = { N: 0 }, line = {};
  for (const [frame, reference] of edges) {
    children[reference].push(frame);
    children[frame] = [];
    depth[frame] = depth[reference] + 1;
  }
  let used = 0;
  const walk = (frame) => {
    const kept = children[frame];
    kept.forEach(walk);
    line[frame] = kept.length ? (line[kept[0]] + line[kept.at(-1)]) / 2 : used;
    if (!kept.length) used += 1;
  };
  walk('N');
  const across = Math.min(ACROSS, 280 / Math.max(1, ...Object.values(depth))), down = Math.min(DOWN, 190 / used);
  return Object.fromEntries(Object.keys(depth).map((name) => [name, [LEFT + across * depth[name], down * (line[name] - (used - 1) / 2)]]));
}

// The arrows grow shorter where many frames crowd.
const reachOf = (spots) => {
  const all = Object.values(spots);
  const near = all.flatMap((one, k) => all.slice(k + 1).map((other) => Math.hypot(one[0] - other[0], one[1] - other[1])));
  return Math.min(REACH, 0.44 * Math.min(...near) / SIZE);
};

// The frames from target to source: up from both to where they meet.
function pathOf(edges, target, source) {
  const parent = Object.fromEntries(edges.map(([frame, reference]) => [frame, reference]));
  const up = (frame) => (frame ? [frame, ...up(parent[frame])] : []);
  const [from, to] = [up(source), up(target)], meet = to.find((frame) => from.includes(frame));
  return [...to.slice(0, to.indexOf(meet) + 1), ...from.slice(0, from.indexOf(meet)).reverse()];
}

const dcmsOf = (edges) => edges.reduce((known, [frame, reference, axis, angle]) => (
  { ...known, [frame]: multiply(simpleDcm(axis, angle), known[reference]) }), { N: IDENTITY });

// A tree of frames that the reader extends, and the matrix between any two of them.
export function render({ model, el }) {
  let chosen = null;
  const edges = () => model.get('edges');
  const now = () => (edges().some(([frame]) => frame === chosen) ? chosen : edges().at(-1)[0]);
  const turnTo = (values) => change(model, { edges: edges().map((edge) => (edge[0] === now() ? edge.map((old, k) => values[k] ?? old) : edge)) });
  const sheet = new Sheet({ bounds: [-180, -130, 180, 130], size: SIZE, changed: () => redraw(), name: 'A tree of frames.' });
  const redraw = onceAFrame(draw);

  const angle = slider({ symbol: '', name: 'Angle of the frame', change: (value) => turnTo({ 3: value }), more: () => '' });
  const frame = choice({ name: 'Turn', options: LETTERS.slice(1).split(''), change: (value) => { chosen = value; redraw(); } });
  const reference = element('span', {});
  const axis = choice({ name: 'about', options: AXES, change: (value) => turnTo({ 2: value }) });
  const adders = LETTERS.split('').map((letter) => button(letter, () => {
    chosen = LETTERS.slice(1).split('').find((one) => !edges().some(([made]) => made === one));
    change(model, { edges: [...edges(), [chosen, letter, 'y', radians(30)]] });
  }, { 'aria-label': `add a frame turned in ${letter}` }));
  const fewer = button('Remove the last', () => {
    const [gone] = edges().at(-1), end = (name) => (model.get(name) === gone ? 'N' : model.get(name));
    change(model, { target: end('target'), source: end('source') });
    change(model, { edges: edges().slice(0, -1) });
  });
  const target = choice({ name: 'Matrix of', options: LETTERS.split(''), change: (value) => change(model, { target: value }) });
  const source = choice({ name: 'with respect to', options: LETTERS.split(''), change: (value) => change(model, { source: value }) });
  const title = element('span', {});
  const result = numberTable({ name: 'Direction cosine matrix over the path', kind: 'bracket', rows: ['', '', ''], columns: AXES,
    names: AXES.map((i) => AXES.map((j) => `row ${i}, column ${j}`)), light: () => {} });
  const text = liveText();
  open(el, stage(sheet, text),
    element('div', { class: 'controls' }, group('Add a frame', 'row-of-controls', element('span', {}, 'Add a frame, turned in'), ...adders, fewer),
      group('Turn a frame', 'row-of-controls', frame.element, reference, axis.element), angle.element),
    element('div', { class: 'readouts' }, group('Ends of the path', 'row-of-controls', target.element, source.element), readout([title], result.element)));

  function draw() {
    const all = edges(), names = ['N', ...all.map(([name]) => name)], dcms = dcmsOf(all), one = now();
    const [to, from] = [model.get('target'), model.get('source')], path = pathOf(all, to, from);
    const [, under, about, turn] = all.find(([name]) => name === one);
    for (const list of [frame, target, source]) {
      for (const option of list.element.querySelectorAll('option')) option.hidden = option.disabled = !names.includes(option.value);
    }
    frame.show(one);
    write(reference, `in ${under}`);
    axis.show(about);
    angle.show(turn);
    target.show(to);
    source.show(from);
    adders.forEach((add, k) => {
      add.hidden = !names.includes(LETTERS[k]);
      add.disabled = names.length === LETTERS.length;
    });
    fewer.disabled = all.length === 1;
    writeWords(title, dcmName(to, from));
    result.show(multiply(dcms[to], transpose(dcms[from])).map((row) => row.map((entry) => fixed(entry))));
    const made = all.filter(([name, parent]) => path.includes(name) && path.includes(parent));
    sheet.draw(() => {
      const back = transpose(sheet.view), spots = places(all), at = ([x, y]) => times(back, [x / SIZE, -y / SIZE, 0]);
      for (const edge of all) sheet.line([at(spots[edge[1]]), at(spots[edge[0]])], ...(made.includes(edge) ? ['accent', 'thick'] : ['muted', 'guide']));
      sheet.layer = 1;
      const reach = reachOf(spots);
      for (const name of names) {
        const place = at(spots[name]);
        sheet.triad(name, dcms[name], { origin: place, length: reach, labels: [] });
        const tips = dcms[name].map((row) => sheet.onSheet(scale(reach, row)));
        // An arrow that points at the reader or away has no room for its letter.
        dcms[name].forEach((row, k) => {
          if (Math.hypot(...tips[k]) > SHORT) sheet.label(add(place, scale(reach + 0.1, row)), `$${AXES[k]}$`, name, [0, 0], 14);
        });
        const free = (corner) => Math.min(...tips.map((tip) => Math.hypot(tip[0] - corner[0], tip[1] - corner[1])));
        sheet.label(place, `$${name}$`, name, CORNERS.reduce((best, corner) => (free(corner) > free(best) + 1e-6 ? corner : best)));
      }
    });
    text.say(sentence(to, from, path, made));
  }

  draw();
  return follow(model, ['edges', 'target', 'source'], redraw);
}

// Factors that are walked against the way they were made are transposes.
function sentence(to, from, path, made) {
  if (to === from) return 'A frame in itself: the identity. Choose two different frames.';
  const factors = path.slice(1).map((name, k) => dcmName(path[k], name)).join(' ');
  const back = made.filter(([name, parent]) => path.indexOf(name) > path.indexOf(parent)).map(([name, parent]) => dcmName(parent, name));
  return `${dcmName(to, from)} = ${factors}, over the path from $${from}$ to $${to}$. ${
    back.length ? `Walked backwards, and so transposed: ${back.join(' and ')}.` : 'Nothing is walked backwards.'}`;
}
