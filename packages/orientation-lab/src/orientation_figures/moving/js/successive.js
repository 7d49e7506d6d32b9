import { add, AXES, axisAngleFromDcm, degrees, IDENTITY, multiply, simpleDcm, transpose, wrapped } from './mathematics.js';
import { chain, partly } from './common_picture.js';
import { axisOf, COMPARISONS, LETTERS, picture, secondChain, SIZE } from './successive_picture.js';
import { button, change, choice, element, fixed, follow, followTurn, group, liveText, numberTable,
  onceAFrame, open, player, put, readout, Sheet, slider, stage, write, writeWords } from './shared.js';

const SECONDS = 6;
const [NOTHING, ...PAIRS] = COMPARISONS, OTHER = PAIRS.pop();
const hat = (letter, axis) => `$\\hat{${letter.toLowerCase()}}_${axis}$`;
const dcmName = (target, source) => `\${}^${target}\\mathbf{C}^${source}$`;
const angleText = (angle, digits = 1) => `${fixed(degrees(angle), digits).trim()}°`;

export function render({ model, el }) {
  let lit = null;
  const state = () => ({ turns: model.get('turns'), kind: model.get('fixed'), compare: model.get('compare'), share: model.get('share') });
  const setTurn = (k, turn) => change(model, { turns: state().turns.map((old, n) => (n === k ? turn : old)) });

  const sheet = new Sheet({ bounds: [-180, -142, 180, 222], size: SIZE, changed: () => redraw(),
    name: 'The frames of the chain from one origin, and below them each frame by itself in order.',
    grab(part, at) {
      if (!part) return null;
      const { turns, kind, share } = state(), now = partly(turns, share), k = now.length - 1, [axis, angle] = turns[k];
      const frames = chain(now, kind);
      const follower = followTurn(sheet, { axis: axisOf(frames, now, kind, k), arm: frames[k][part], angle, at });
      return (to) => setTurn(k, [axis, wrapped(follower(to))]);
    } });
  const redraw = onceAFrame(draw);

  const rows = LETTERS.slice(1).split('').map((letter, k) => {
    const axis = choice({ name: `Axis of turn ${k + 1}`, hidden: true, options: AXES,
      change: (value) => setTurn(k, [value, state().turns[k][1]]) });
    const angle = slider({ symbol: `$${letter}$`, name: `Turn ${k + 1}, to frame ${letter}`, more: () => '',
      change: (value) => setTurn(k, [state().turns[k][0], value]) });
    angle.element.firstChild.classList.add(letter);
    const exchange = k === 3 ? [] : [button('⇅', () => {
      const turns = [...state().turns];
      [turns[k], turns[k + 1]] = [turns[k + 1], turns[k]];
      change(model, { turns, compare: PAIRS[k] });
    }, { class: 'exchange', 'aria-label': `Swap rotations ${k + 1} and ${k + 2}` })];
    return { axis, angle, exchange, element: group(`Turn ${k + 1}`, 'turn-of-chain', axis.element, angle.element, ...exchange) };
  });
  const more = button('Add a turn', () => {
    const { turns } = state(), axis = AXES[(AXES.indexOf(turns.at(-1)[0]) + 1) % 3];
    change(model, { turns: [...turns, [axis, Math.PI / 6]], share: 1 });
  });
  const fewer = button('Remove the last', () => {
    const turns = state().turns.slice(0, -1), { compare } = state();
    change(model, { turns, share: 1, compare: PAIRS.indexOf(compare) < turns.length - 1 ? compare : NOTHING });
  });
  const about = choice({ name: 'Turns about', options: [['body', 'the frame’s axes (body fixed)'], ['space', 'N’s axes (space fixed)']],
    change: (value) => change(model, { fixed: value }) });
  const compare = choice({ name: 'Compare with', options: [NOTHING, ...PAIRS.map((pair) => [pair, `turns ${pair}`]), [OTHER, '']],
    change: (value) => change(model, { compare: value }) });
  const options = [...compare.element.querySelectorAll('option')];
  const clock = player({ name: 'Time in the chain', seconds: SECONDS, show: (time) => change(model, { share: time / SECONDS }) });

  const factors = LETTERS.slice(1).split('').map(factor);
  const product = element('div', { class: 'factors', role: 'group', 'aria-label': 'The product, factor by factor' }, ...factors.map((one) => one.element));
  const title = element('span', {});
  const result = numberTable({ name: 'Direction cosine matrix of the end', kind: 'bracket', rows: ['', '', ''], columns: AXES.map((axis) => hat('n', axis)),
    names: AXES.map((i) => AXES.map((j) => `row ${i}, column n ${j}`)),
    light(i, j) {
      lit = i === undefined ? null : [i, j];
      redraw();
    } });
  const text = liveText();
  open(el, stage(sheet, text),
    element('div', { class: 'controls chain' }, clock.element,
      ...(model.get('more') !== false ? [element('div', { class: 'row-of-controls' }, about.element, compare.element)] : []), ...rows.map((row) => row.element),
      element('div', { class: 'row-of-controls' }, more, fewer)),
    element('div', { class: 'readouts' },
      readout([title], product), readout(['Multiplied out'], result.element)));
  const heads = [...result.element.querySelectorAll('.head-of-row')].slice(-3);

  function draw() {
    const { turns, kind, share, compare: comparison } = state(), now = partly(turns, share);
    const dcm = chain(now, kind).at(-1), end = LETTERS[now.length];
    const other = comparison === NOTHING ? null : secondChain(turns, kind, comparison);
    const otherDcm = other && chain(partly(other[0], share), other[1]).at(-1);
    about.show(kind);
    compare.show(comparison);
    PAIRS.forEach((_, k) => { options[k + 1].hidden = options[k + 1].disabled = k > turns.length - 2; });
    write(options.at(-1), kind === 'body' ? 'the same turns, space fixed' : 'the same turns, body fixed');
    rows.forEach((row, k) => {
      row.element.hidden = k >= turns.length;
      if (k >= turns.length) return;
      row.axis.show(turns[k][0]);
      row.angle.show(turns[k][1]);
      for (const exchange of row.exchange) exchange.style.visibility = k < turns.length - 1 ? '' : 'hidden';
    });
    more.disabled = turns.length === 4;
    fewer.disabled = turns.length === 1;
    clock.at(share * SECONDS);
    factors.forEach((one, k) => one.show(now[k] ?? turns[k], k < now.length, kind, turns.length));
    writeWords(title, `${dcmName(end, 'N')} as a product, newest turn on the ${kind === 'body' ? 'left' : 'right'}`);
    heads.forEach((head, k) => writeWords(head, hat(end, AXES[k])));
    result.show(dcm.map((row) => row.map((entry) => fixed(entry))));
    sheet.draw(() => {
      picture(sheet, turns, kind, share, comparison, Boolean(lit));
      sheet.layer = 1;
      if (lit) sheet.shadow(dcm[lit[0]], IDENTITY[lit[1]]);
      if (now.length) dcm.forEach((row, k) => { if (AXES[k] !== now.at(-1)[0]) sheet.grip(row, String(k)); });
    });
    text.say(sentence(end, kind, dcm, comparison, otherDcm, lit, model.get('more') !== false));
  }

  draw();
  return follow(model, ['turns', 'fixed', 'compare', 'share'], redraw);
}

// One simple matrix of the product with its frames, axis and angle.
function factor(letter, k) {
  const head = element('div', { class: 'factor-name' }), foot = element('div', { class: 'factor-turn' });
  const cells = Array.from({ length: 9 }, () => element('span', {}));
  const box = element('div', { class: `factor ${letter}`, role: 'img' }, head, element('div', { class: 'small-matrix' }, ...cells), foot);
  return { element: box, show(turn, made, kind, count) {
    box.hidden = !turn;
    if (!turn) return;
    put(box, 'data-made', String(made));
    const [axis, angle] = turn, body = kind === 'body', entries = simpleDcm(axis, angle).flat();
    // Body fixed rotations are to the left of those before, space fixed ones to the right.
    box.style.order = body ? count - k : k;
    writeWords(head, body ? dcmName(letter, LETTERS[k]) : `$\\mathbf{C}_${axis}$`);
    writeWords(foot, `${hat(body ? LETTERS[k] : 'N', axis)} ${angleText(angle)}`);
    cells.forEach((cell, n) => {
      const entry = entries[n], whole = Math.round(entry);
      write(cell, Math.abs(entry - whole) < 1e-12 ? String(whole).replace('-', '\u2212') : fixed(entry, 2).trim());
    });
    put(box, 'aria-label', `Turn ${k + 1}: ${angleText(angle)} about ${body ? LETTERS[k].toLowerCase() : 'n'} ${axis}`);
  } };
}

function sentence(end, kind, dcm, compare, otherDcm, lit, more) {
  if (lit) {
    const [i, j] = lit;
    return `Row ${AXES[i]}, column ${AXES[j]}: ${hat(end, AXES[i])} · ${hat('n', AXES[j])} = ${fixed(dcm[i][j]).trim()}, the shadow of `
      + `${hat(end, AXES[i])} on the line of ${hat('n', AXES[j])}.`;
  }
  const [axis, angle] = axisAngleFromDcm(dcm);
  if (!otherDcm) {
    return (kind === 'body' ? `Each turn is about an axis of the frame before it${more ? ' (body fixed)' : ''}. `
      : 'Each turn is about an axis of $N$ (space fixed). ')
      + (angle < 1e-9 ? end === 'N' ? 'No rotation has been made yet: press Play.' : `Together the rotations so far bring $${end}$ to where $N$ is.` : `From $N$ to $${end}$ they are one rotation of ${angleText(angle)} about (${
        axis.map((entry) => fixed(entry, 2).trim()).join(', ')}).`);
  }
  const apart = axisAngleFromDcm(multiply(otherDcm, transpose(dcm)))[1];
  const what = compare === OTHER ? `The same turns, ${kind === 'body' ? 'space' : 'body'} fixed, lead` : `With turns ${compare}, the chain leads`;
  return apart < 1e-7 ? `${what} to the same orientation: here $E$ is where $${end}$ is.`
    : `${what} to $E$ instead of $${end}$. The two differ by a rotation of ${angleText(apart)}.`;
}
