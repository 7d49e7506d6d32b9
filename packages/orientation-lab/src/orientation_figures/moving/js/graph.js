import { AXES, IDENTITY, multiply, radians, simpleDcm, transpose } from './mathematics.js';
import { picture, SIZE } from './graph_picture.js';
import { button, change, choice, element, fixed, follow, group, liveText, numberTable, onceAFrame,
  open, readout, Sheet, slider, stage, write, writeWords } from './shared.js';

const LETTERS = 'NABCDE';
const dcmName = (target, source) => `\${}^${target}\\mathbf{C}^${source}$`;

// Return the frames from target to source: up from both to their common ancestor.
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
    chosen = LETTERS.slice(1).split('').find((letter) => !edges().some(([made]) => made === letter));
    change(model, { edges: [...edges(), [chosen, letter, 'y', radians(30)]] });
  }, { 'aria-label': `add a frame with reference frame ${letter}` }));
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
    sheet.draw(() => picture(sheet, all, dcms, path));
    text.say(sentence(to, from, path, made));
  }

  draw();
  return follow(model, ['edges', 'target', 'source'], redraw);
}

// Factors against the direction in which the frames were defined are transposes.
function sentence(to, from, path, made) {
  if (to === from) return 'A frame relative to itself: the identity. Choose two different frames.';
  const factors = path.slice(1).map((name, k) => dcmName(path[k], name)).join(' ');
  const back = made.filter(([name, parent]) => path.indexOf(name) > path.indexOf(parent)).map(([name, parent]) => dcmName(parent, name));
  return `${dcmName(to, from)} = ${factors}, over the path from $${from}$ to $${to}$. ${
    back.length ? `These steps go backwards, so their matrices are transposed: ${back.join(' and ')}.` : 'No step goes backwards.'}`;
}
