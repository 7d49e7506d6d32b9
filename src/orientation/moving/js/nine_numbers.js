import { AXES, IDENTITY, add, checkDcm, conditions, determinant, general, length, nearestDcm, scale, subtract,
  transpose } from './mathematics.js';
import { Sheet, button, change, element, fixed, follow, glide, group, hats, liveText, numberField, onceAFrame, open, put, readout,
  stage } from './shared.js';

const REACH = 1.25, SIZE = 104;   // as in nine_numbers.py
const A = hats('a'), N = hats('n');
// What readers meet: a good matrix, the same with two decimals, and the four ways to go wrong.
const EXAMPLES = [
  ['Good', [[0.8, 0.6, 0], [-0.48, 0.64, 0.6], [0.36, -0.48, 0.8]]],
  ['Rounded', [[0.9, 0.4, 0.1], [-0.4, 0.8, 0.4], [0.1, -0.4, 0.9]]],
  ['Measured', [[0.83, 0.57, -0.06], [-0.49, 0.71, 0.62], [0.31, -0.5, 0.74]]],
  ['Scaled', [[0.96, 0.72, 0], [-0.576, 0.768, 0.72], [0.432, -0.576, 0.96]]],
  ['Left-handed', [[0.8, 0.6, 0], [-0.48, 0.64, 0.6], [-0.36, 0.48, -0.8]]],
];

export function render({ model, el }) {
  let stop = () => {};
  const put_ = (matrix) => change(model, { matrix });
  const sheet = new Sheet({ bounds: [-180, -165, 180, 165], size: SIZE, camera: [40, 24], changed: () => redraw(),
    name: 'The rows of the matrix as arrows in the frame N, and the nearest triad of unit vectors.',
    grab(part, at) {
      if (!part) return null;
      stop();
      const row = Number(part), from = model.get('matrix')[row], back = transpose(sheet.view);
      // The tip moves in a plane parallel to the sheet.
      return (to) => {
        const [right, down] = subtract(to, at).map((pixels) => pixels / SIZE);
        const moved = add(from, scale(right, transpose(back)[0]), scale(-down, transpose(back)[1]));
        const matrix = model.get('matrix').map((entries) => [...entries]);
        matrix[row] = moved.map((entry) => Math.round(100 * entry) / 100 + 0);
        put_(matrix);
      };
    } });
  const redraw = onceAFrame(draw);

  const fields = AXES.map((i, row) => AXES.map((j, column) => numberField({ name: `row ${i}, column ${j}`, step: 0.05, digits: 4, min: -10, max: 10,
    change(value) {
      stop();
      const matrix = model.get('matrix').map((entries) => [...entries]);
      matrix[row][column] = value;
      put_(matrix);
    } })));
  const head = (text) => element('span', { class: 'head-of-numbers', 'aria-hidden': 'true' }, text);
  const grid = (name, rows) => group(name, 'numbers bracket', element('div', { class: 'row' }, head(''), ...N.map(head)),
    ...rows.map((row, k) => element('div', { class: 'row' }, head(A[k]), ...row)));
  const entries = AXES.map(() => AXES.map(() => element('span', { class: 'number' })));
  const facts = [...AXES.map((_, k) => `length of ${A[k]}`), ...[[0, 1], [1, 2], [2, 0]].map(([i, j]) => `${A[i]} · ${A[j]}`), 'right-handed'];
  const checks = facts.map((fact) => ({ value: element('td'), verdict: element('td'), fact }));
  const nearest = button('Take the nearest', () => {
    const from = model.get('matrix'), { dcm } = nearestDcm(from);
    stop();
    stop = glide((part) => put_(part === 1 ? dcm : from.map((row, k) => add(scale(1 - part, row), scale(part, dcm[k])))));
  });
  const text = liveText();
  const apart = element('span', { class: 'value' });
  open(el, stage(sheet, text), element('div', { class: 'readouts' },
    readout(['Nine numbers'], grid('Nine numbers', fields.map((row) => row.map((field) => field.element)))),
    group('Examples', 'row-of-controls', ...EXAMPLES.map(([name, matrix]) => button(name, () => { stop(); put_(matrix); }))),
    readout(['Nearest direction cosine matrix', nearest], grid('Nearest direction cosine matrix', entries), apart)),
  element('table', { class: 'checks across' }, element('tbody', {}, ...checks.map(({ fact, value, verdict }) => element('tr', {},
    element('th', { scope: 'row' }, fact), value, verdict)))));

  function draw() {
    const matrix = model.get('matrix'), near = nearestDcm(matrix), turned = determinant(matrix);
    fields.forEach((row, i) => row.forEach((field, j) => field.show(matrix[i][j])));
    entries.forEach((row, i) => row.forEach((entry, j) => { entry.textContent = near.dcm ? fixed(near.dcm[i][j], 4) : '?'; }));
    nearest.disabled = !near.dcm || near.distance < 1e-9;
    apart.textContent = near.dcm ? `Distance from the nine numbers: ${near.distance.toFixed(4)}` : 'Several are equally near.';
    const all = conditions(matrix).map(({ value, wanted, fault }) => ({ value: fixed(value, 4), good: Math.abs(fault) <= 1e-9, wanted }));
    all.push({ value: `det ${fixed(turned, 4)}`, good: turned > 0, wanted: '+' });
    checks.forEach(({ value, verdict }, k) => {
      value.textContent = all[k].value;
      verdict.textContent = all[k].good ? '✓' : `✗ not ${all[k].wanted}`;
      put(verdict, 'class', all[k].good ? 'good' : 'bad');
    });
    sheet.draw(() => picture(sheet, matrix, near.dcm));
    const fault = checkDcm(matrix);
    text.say(fault ? `check_dcm says: ${fault}.` : 'check_dcm has nothing to say: a direction cosine matrix.');
  }

  draw();
  const unfollow = follow(model, ['matrix'], redraw);
  return () => {
    stop();
    unfollow();
  };
}

function picture(sheet, matrix, dcm) {
  sheet.triad('N', IDENTITY, { reach: REACH });
}
