import { add, AXES, checkDcm, conditions, determinant, nearestDcm, scale, subtract } from './mathematics.js';
import { picture, SIZE, SMALL } from './nine_numbers_picture.js';
import { button, change, element, fixed, follow, glide, grid, group, liveText, numberField, onceAFrame, open,
  put, readout, Sheet, stage, write } from './shared.js';
import { hatted } from './words_picture.js';

const A = hatted('a'), N = hatted('n');
const GOOD = [[0.8, 0.6, 0], [-0.48, 0.64, 0.6], [0.36, -0.48, 0.8]];
// Typical matrices: one that is valid to the last digit, and five that are not.
const EXAMPLES = [
  ['Valid', GOOD],
  ['One decimal', [[0.8, 0.6, 0], [-0.5, 0.6, 0.6], [0.4, -0.5, 0.8]]],
  ['Measured', [[0.812, 0.571, 0.104], [-0.566, 0.823, 0.021], [-0.079, -0.094, 0.991]]],   // as in the chapter
  ['Skewed', [[0.98, 0.43, -0.2], [-0.31, 0.8, 0.7], [0.08, -0.4, 0.74]]],
  ['1.2 times', GOOD.map((row) => row.map((entry) => Math.round(1200 * entry) / 1000))],
  ['Left-handed', [...GOOD.slice(0, 2), [-0.36, 0.48, -0.8]]],
];
const PAIRS = [[0, 1], [1, 2], [2, 0]];

export function render({ model, el }) {
  let stop = () => {};
  const setMatrix = (matrix) => change(model, { matrix });
  const copy = () => model.get('matrix').map((row) => [...row]);
  const sheet = new Sheet({ bounds: [-180, -165, 180, 165], size: SIZE, camera: [40, 24], changed: () => redraw(),
    name: 'The rows of the matrix as arrows in the frame N, and the nearest triad of unit vectors.',
    grab(part, at) {
      if (!part) return null;
      stop();
      const row = Number(part), from = copy()[row];
      // The tip moves in a plane parallel to the sheet.
      return (to) => {
        const [right, down] = subtract(to, at), matrix = copy();
        const moved = add(from, scale(right / SIZE, sheet.view[0]), scale(-down / SIZE, sheet.view[1]));
        matrix[row] = moved.map((entry) => Math.round(100 * entry) / 100 + 0);
        setMatrix(matrix);
      };
    } });
  const redraw = onceAFrame(draw);

  const fields = AXES.map((i, row) => AXES.map((j, column) => numberField({
    name: `row ${i}, column ${j}`, step: 0.05, digits: 4, min: -10, max: 10, change(value) {
      stop();
      const matrix = copy();
      matrix[row][column] = value;
      setMatrix(matrix);
    } })));
  const entries = AXES.map(() => AXES.map(() => element('span', { class: 'number' })));
  const facts = [...A.map((row) => `|${row}|`), 'determinant', ...PAIRS.map(([i, j]) => `${A[i]} · ${A[j]}`)];
  const checks = facts.map((fact) => {
    const value = element('span', { class: 'value' }), verdict = element('span', { class: 'verdict' });
    return { value, verdict, line: element('li', {}, element('span', { class: 'fact' }, fact), value, verdict) };
  });
  const take = button('Take the nearest', () => {
    const from = copy(), { dcm } = nearestDcm(from);
    stop();
    const between = (part) => from.map((row, k) => add(scale(1 - part, row), scale(part, dcm[k])));
    stop = glide((part) => setMatrix(part === 1 ? dcm : between(part)));
  });
  const examples = EXAMPLES.map(([name, matrix]) => button(name, () => {
    stop();
    setMatrix(matrix);
  }));
  const apart = element('span', { class: 'value' }), text = liveText();
  open(el, stage(sheet, text), element('div', { class: 'readouts' },
    readout(['Nine numbers'], grid({ name: 'Nine numbers', rows: A, columns: N, kind: 'bracket entries',
      cells: fields.map((row) => row.map((field) => field.element)) })),
    group('Examples', 'row-of-controls', ...examples),
    readout(['Nearest valid matrix, drawn dotted'],
      grid({ name: 'Nearest direction cosine matrix', rows: A, columns: N, kind: 'bracket four', cells: entries }),
      element('div', { class: 'row-of-controls' }, take, apart))),
  element('ul', { class: 'checks', 'aria-label': 'Conditions' }, ...checks.map(({ line }) => line)));

  function draw() {
    const matrix = model.get('matrix'), near = nearestDcm(matrix), turned = determinant(matrix), fault = checkDcm(matrix);
    fields.forEach((row, i) => row.forEach((field, j) => field.show(matrix[i][j])));
    entries.forEach((row, i) => row.forEach((entry, j) => write(entry, near.dcm ? fixed(near.dcm[i][j], 4) : '\u2013')));
    take.disabled = !near.dcm || near.distance < SMALL;
    write(apart, near.dcm ? `Distance ${near.distance.toFixed(4)}` : 'Several are equally near.');
    const results = conditions(matrix).map(({ value, wanted, fault: excess }) => [value, wanted, Math.abs(excess) <= SMALL]);
    results.splice(3, 0, [turned, turned > 0 ? 1 : '+1', Math.abs(turned - 1) <= 2 * SMALL]);
    results.forEach(([value, wanted, holds], k) => {
      write(checks[k].value, fixed(value, 4));
      write(checks[k].verdict, holds ? '\u2713 holds' : `\u2717 not ${wanted}`);
      put(checks[k].line, 'class', holds ? '' : 'fails');
    });
    sheet.draw(() => {
      picture(sheet, matrix, near.dcm);
      matrix.forEach((row, k) => sheet.grip(row, String(k)));
    });
    text.say(fault ? `${fault}.` : 'A direction cosine matrix: rows of length 1, at right angles, right-handed.');
  }

  draw();
  const unfollow = follow(model, ['matrix'], redraw);
  return () => {
    stop();
    unfollow();
  };
}
