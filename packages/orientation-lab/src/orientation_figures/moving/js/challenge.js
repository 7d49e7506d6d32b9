import { AXES, axisAngleFromDcm, degrees, IDENTITY, multiply, radians, transpose, wrapped } from './mathematics.js';
import { picture, SIZE } from './challenge_picture.js';
import { chain, partly } from './common_picture.js';
import { button, change, choice, element, fixed, follow, followTurn, group, liveText, numberTable, onceAFrame,
  open, plain, plainDegrees, player, put, readout, Sheet, slider, stage, write } from './shared.js';
import { hatted } from './words_picture.js';

const MOST = 20, CLOSE = radians(2), SECONDS = 6;
const [N, A] = ['n', 'a'].map(hatted);
const any = (list) => list[Math.floor(Math.random() * list.length)];

// Make a new challenge: axes of which no two neighbours are equal, and angles that suit the task.
function another(task) {
  const axes = [];
  while (axes.length < 3) axes.push(any(AXES.filter((axis) => axis !== axes.at(-1))));
  const angles = task === 'ghost' ? [[60, 70, 80], [40, 50], [20, 30]].map(any)
    : axes.map(() => any(task === 'match' ? [-90, -60, -30, 30, 60, 90] : [-120, -90, -60, 60, 90, 120]));
  return axes.map((axis, k) => [axis, radians(angles[k])]);
}

export function render({ model, el }) {
  let shown = false, share = 1;
  const state = () => ({ task: model.get('task'), given: model.get('given'), turns: model.get('turns') });
  const start = () => (state().task === 'undo' ? chain(state().given).at(-1) : IDENTITY);
  const setLast = (angle) => change(model, { turns: [...state().turns.slice(0, -1), [state().turns.at(-1)[0], angle]] });

  const sheet = new Sheet({ bounds: [-180, -172, 180, 172], size: SIZE, changed: () => redraw(),
    name: 'A box with the triad of the frame A, and the triad of N.',
    grab(part, at) {
      const { task, turns } = state();
      if (!part || task === 'ghost' || !turns.length) return null;
      const frames = chain(turns, 'body', start()), before = frames.at(-2), [axis, angle] = turns.at(-1);
      const follower = followTurn(sheet, { axis: before[AXES.indexOf(axis)], arm: before[part], angle, at });
      return (to) => setLast(wrapped(follower(to)));
    } });
  const redraw = onceAFrame(draw);

  const begin = (task, given) => {
    shown = false;
    share = 1;
    change(model, { task, given, turns: [] });
    redraw();
  };
  const task = choice({ name: 'Challenge', options: [['match', 'match a matrix'], ['undo', 'undo three turns'], ['ghost', 'find the ghost’s axes']],
    change: (value) => begin(value, another(value)) });
  const next = button('New challenge', () => begin(state().task, another(state().task)));
  const turns = AXES.map((axis, k) => button(`about ${A[k]}`, () => {
    const { task: now, given, turns: made } = state();
    change(model, { turns: [...made, [axis, now === 'ghost' ? given[made.length][1] : radians(30)]] });
  }, { 'aria-label': `turn the box about a ${axis}` }));
  const last = slider({ symbol: '', name: 'Angle of the last turn', change: setLast, more: () => '' });
  const back = button('Take back', () => change(model, { turns: state().turns.slice(0, -1) }));
  const show = button('Show the goal', () => {
    shown = !shown;
    redraw();
  });
  const ghost = player({ name: 'Time of the ghost', seconds: SECONDS, show: (time) => { share = time / SECONDS; redraw(); } });
  const matrix = (name, what) => numberTable({ name, kind: 'bracket', rows: ['', '', ''], columns: N,
    names: AXES.map((i) => AXES.map((j) => `${what} row ${i}, column ${j}`)), light: () => {} });
  const wanted = matrix('Matrix of the goal', 'goal,'), current = matrix('Matrix of the box', 'box,');
  const rest = element('span', { class: 'value' });
  const bar = element('div', { class: 'bar', role: 'meter', 'aria-label': 'Remaining rotation', 'aria-valuemin': '0', 'aria-valuemax': '180' }, element('span', {}));
  const text = liveText();
  open(el, stage(sheet, text),
    element('div', { class: 'controls' }, element('div', { class: 'row-of-controls' }, task.element, next),
      group('Turn the box', 'row-of-controls', element('span', {}, 'Turn'), ...turns, back, show), last.element, ghost.element),
    element('div', { class: 'readouts' }, readout(['The goal'], wanted.element), readout(['The box, ${}^A\\mathbf{C}^N$'], current.element),
      readout(['Remaining rotation', rest], bar)));

  function draw() {
    const { task: now, given, turns: made } = state();
    const goal = now === 'undo' ? IDENTITY : chain(given).at(-1), frames = chain(made, 'body', start()), dcm = frames.at(-1);
    const [, angle] = axisAngleFromDcm(multiply(goal, transpose(dcm)));
    task.show(now);
    const full = made.length >= (now === 'ghost' ? given.length : MOST);
    for (const button of turns) button.disabled = full;
    back.disabled = !made.length;
    show.hidden = now !== 'match';
    put(show, 'aria-pressed', String(shown));
    last.element.hidden = now === 'ghost';
    last.element.style.visibility = made.length ? '' : 'hidden';
    ghost.element.hidden = now !== 'ghost';
    last.show(made.at(-1)?.[1] ?? 0);
    ghost.at(share * SECONDS);
    wanted.show(goal.map((row) => row.map((entry) => fixed(entry))));
    current.show(dcm.map((row) => row.map((entry) => fixed(entry))));
    write(rest, plainDegrees(angle, 1));
    put(bar.firstChild, 'style', `width:${(degrees(angle) / 1.8).toFixed(1)}%`);
    put(bar, 'aria-valuenow', plain(degrees(angle), 1));
    sheet.draw(() => {
      const goes = now === 'ghost' ? chain(partly(given, share)).at(-1) : shown ? goal : null;
      picture(sheet, dcm, goes);
      if (now === 'ghost' || !made.length) return;
      dcm.forEach((row, k) => { if (AXES[k] !== made.at(-1)[0]) sheet.grip(row, String(k)); });
    });
    text.say(sentence(now, given, made, angle));
  }

  draw();
  return follow(model, ['task', 'given', 'turns'], redraw);
}

const told = (turns) => turns.map(([axis, angle]) => `${plainDegrees(angle, 1)} about ${A[AXES.indexOf(axis)]}`).join(', then ');

function sentence(task, given, made, angle) {
  const count = `${made.length} turn${made.length === 1 ? '' : 's'}`;
  if (made.length && angle < CLOSE) {
    return task === 'ghost' ? `Found: ${made.map(([axis]) => axis).join('-')}. No other sequence with these angles ends here.`
      : `Solved in ${count}: ${told(made)}.`;
  }
  if (task === 'match') return `Turn the box about its own arrows until its matrix is that of the goal. ${made.length ? `Now: ${told(made)}.` : 'Read the rows of the goal first: where does each arrow have to point?'}`;
  if (task === 'undo') return `The box was turned from $N$ through ${told(given)}. Turn it back. ${made.length ? `${count} so far: ${told(made)}.` : ''}`;
  const angles = given.map(([, one]) => plainDegrees(one, 1)).join(', then ');
  return `The ghost turned through ${angles}, each time about one of its own arrows. Press Play, watch, and make the same turns. ${
    made.length === given.length ? 'Not yet: undo a turn, and look again.' : ''}`;
}
