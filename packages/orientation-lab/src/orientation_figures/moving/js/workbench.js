import { dcmFromQuaternion, determinant, IDENTITY, quaternionFromDcm, several, slerp } from './mathematics.js';
import { carriedBy, fragmentOf } from './address.js';
import { drawnDcms, explaining, formulaOf, mendingLine, taughtBy, TURNS } from './mismatch.js';
import { picture, SIZE } from './workbench_picture.js';
import { button, calm, change, choice, element, follow, glide, group, inSlices, liveText, numberField,
  onceAFrame, open, put, readout, Sheet, stage, write } from './shared.js';

const UNKNOWN = 'not known', OFFERED_SEQUENCES = ['zyx', 'xyz', 'zxy', 'yxz', 'xzy', 'yzx', 'zxz', 'zyz', 'xyx', 'xzx', 'yxy', 'yzy'];
const KINDS = [UNKNOWN, 'matrix', 'quaternion', 'Euler angles', 'rotation vector', 'axis and angle'];
// The heading of the answer, by verdict.
const HEADINGS = { same: 'Both give the same.', named: 'They differ, and this is how:', undecided: 'These numbers do not determine the cause.',
  unrelated: 'No explanation was found.' };

const ONE_QUESTION = 'One question decides.';
const LANGUAGES = { 'NumPy and SciPy': mendingLine, 'A formula': formulaOf };
const AS_THE_MANUALS_SAY = { same: 'Both give what their manuals say.', named: 'They differ by more than their manuals say:' };

const PLACE = 'workbench', STATE = ['first', 'second', 'first_is', 'second_is', 'noise'], LONGEST = 5000;

// Take over what an address carries, only as far as a reader could have entered it: anybody may have written it.
export function takenUp(content, programs = []) {
  const state = {}, ways = [UNKNOWN, 'rows', 'columns', 'body in world', 'world in body'];
  for (const side of ['first', 'second']) {
    if (typeof content[side] === 'string' && content[side].length <= LONGEST) state[side] = content[side];
    const { program, kind, sequence, order, way, [TURNS]: turns } = { ...NOTHING_KNOWN, ...content[`${side}_is`] };
    const known = ways.includes(way) && [UNKNOWN, 'body fixed', 'space fixed'].includes(turns) && [UNKNOWN, 'wxyz', 'xyzw'].includes(order) && KINDS.includes(kind) && [UNKNOWN, ...OFFERED_SEQUENCES].includes(sequence) && (program === UNKNOWN || programs.includes(program));
    if (known) state[`${side}_is`] = { program, kind, sequence, order, way, [TURNS]: turns };
  }
  if (content.noise >= 0 && content.noise <= 30) state.noise = content.noise;
  // If only one side's numbers were given, leave the other side empty.
  return 'first' in state && !('second' in state) ? { ...state, second: '' } : state;
}

// A reader's answers are for the current numbers, not for the next ones.
const UNANSWERED = { order: UNKNOWN, way: UNKNOWN, [TURNS]: UNKNOWN };
const NOTHING_KNOWN = { program: UNKNOWN, kind: UNKNOWN, sequence: UNKNOWN, ...UNANSWERED };
const knownOf = (side) => Object.fromEntries(Object.entries(side).filter(([name, value]) => value !== UNKNOWN && name !== 'program'
  && (name !== 'sequence' || side.kind === 'Euler angles' || side.kind === UNKNOWN)));

export function render({ model, el }) {
  const table = model.get('table'), examples = model.get('examples'), programs = Object.keys(table.programs);
  let found = null, fault = '', searches = 0, drawn = false, shown = [IDENTITY, IDENTITY], stop = () => {};
  const sheet = new Sheet({ bounds: [-330, -172, 330, 172], size: SIZE, changed: () => redraw(),
    name: 'The frames of both programs, each beside the frame N.' });
  const redraw = onceAFrame(draw);
  const words = liveText();
  const answered = (...declare) => Object.fromEntries(['first_is', 'second_is'].map((name, k) => [name, { ...model.get(name), ...declare[k] }]));
  const sides = ['first', 'second'].map((side, k) => {
    const field = element('textarea', { rows: 5, spellcheck: 'false', 'aria-label': `What the ${side} program gives`,
      input: () => change(model, { [side]: field.value, ...answered(UNANSWERED, UNANSWERED) }),
      // By default a browser opens a dropped file in place of the page.
      async drop(event) {
        const [file] = event.dataTransfer.files;
        if (!file) return;
        event.preventDefault();
        field.value = await file.text();
        field.dispatchEvent(new Event('input'));
      } });
    const read = element('p', { class: 'read' });
    const is = (name) => model.get(`${side}_is`)[name];
    const set = (values) => change(model, { [`${side}_is`]: { ...model.get(`${side}_is`), ...values } });
    const kind = choice({ name: `The ${side} numbers are`, options: [[UNKNOWN, 'numbers of any kind'], ...KINDS.slice(1).map((one) => [one, one])], hidden: true, change: (value) => set({ kind: value }) });
    const sequence = choice({ name: `Sequence of the ${side} angles`, options: [[UNKNOWN, 'any sequence'], ...OFFERED_SEQUENCES.map((one) => [one, [...one].join('-')])],
      hidden: true, change: (value) => set({ sequence: value }) });
    const program = choice({ name: `The ${side} program`, options: [[UNKNOWN, 'any program'], ...programs.map((one) => [one, one])], hidden: true,
      change: (value) => set({ program: value }) });
    const title = ['The first program gives', 'The second program gives'][k];
    return { field, read, box: group(title, 'side', element('div', { class: 'row-of-controls known' }, element('div', { class: 'title' }, title), program.element),
      field, read, element('div', { class: 'row-of-controls' }, kind.element, sequence.element)), show() {
      program.show(is('program'));
      if (document.activeElement !== field && field.value !== model.get(side)) field.value = model.get(side);
      kind.show(is('kind'));
      sequence.show(is('sequence'));
      sequence.element.hidden = is('kind') !== 'Euler angles' && is('kind') !== UNKNOWN;
    } };
  });
  const example = choice({ name: 'An example', options: [['', 'Cases from public threads'], ...Object.keys(examples).map((name) => [name, name])], hidden: true,
    change: (name) => {
      if (!name) return;
      const [first, second, ...known] = examples[name], [firstIs, secondIs] = [0, 1].map((k) => ({ ...NOTHING_KNOWN, ...known[k] }));
      for (const side of sides) side.field.blur();
      change(model, { first, second, noise: 0, first_is: firstIs, second_is: secondIs });
    } });
  const noise = numberField({ name: 'Tolerance in degrees', step: 0.5, min: 0, max: 30, change: (value) => change(model, { noise: value }) });
  const verdict = element('div', { class: 'controls answer' });
  const code = element('output', { class: 'result', 'aria-label': 'The line that fixes it' });
  const language = choice({ name: 'Language of the line', options: Object.keys(LANGUAGES).map((name) => [name, name]), hidden: true, change: () => mended() });
  const mend = group('The line that fixes it', 'controls line', element('div', { class: 'row-of-controls' }, element('div', { class: 'title' }, 'The line that fixes it'),
    language.element, button('Copy the line', async () => {
      await navigator.clipboard.writeText(`${code.textContent}\n`);
      words.say('Line copied.');
    })), code);
  const post = button('Copy the address of this case', async () => {
    try {
      const content = Object.fromEntries(STATE.map((name) => [name, model.get(name)]));
      await navigator.clipboard.writeText(location.href.split('#')[0] + fragmentOf(PLACE, content));
      words.say('The address is copied. Anyone who opens it sees these numbers. They are not sent to any server.');
    } catch (error) {
      words.say(error.message);
    }
  });
  open(el, stage(sheet, words), element('div', { class: 'across' },
    readout(['Left: the orientation that the first program means, ${}^A\\mathbf{C}^N$. Right: the second, ${}^B\\mathbf{C}^N$'])),
  element('div', { class: 'controls case' }, example.element),
  element('div', { class: 'controls converter' }, sides[0].box, sides[1].box), verdict, mend,
  element('div', { class: 'controls' }, element('div', { class: 'row-of-controls case' },
    element('label', { class: 'differ' }, 'They may differ by ', noise.element, ' degrees'), post)));

  // Rotate the drawing from its current to the new orientations of the last pose.
  function glideTo(dcms) {
    stop();
    const proper = dcms.every((dcm) => determinant(dcm) > 0) && shown.every((dcm) => determinant(dcm) > 0);
    if (calm() || !proper || !drawn) {
      drawn = true;
      shown = dcms;
      redraw();
      return;
    }
    const from = shown.map(quaternionFromDcm), to = dcms.map(quaternionFromDcm);
    stop = glide((part) => {
      shown = from.map((start, k) => dcmFromQuaternion(slerp(start, to[k], part)));
      redraw();
    });
  }

  // If the numbers change in the meantime, a new search begins, and the old result is dropped.
  async function judge() {
    const search = (searches += 1);
    for (const side of sides) side.show();
    if (model.get('first') || model.get('second')) unreadable = '';
    noise.show?.(model.get('noise'));
    put(verdict, 'aria-busy', 'true');
    let explained = null, wrong = '';
    try {
      explained = await inSlices(explaining(model.get('first'), model.get('second'), table, { firstDeclared: knownOf(model.get('first_is')),
        secondDeclared: knownOf(model.get('second_is')), firstProgram: model.get('first_is').program,
        secondProgram: model.get('second_is').program, noise: model.get('noise') * Math.PI / 180 }), () => search === searches);
    } catch (error) {
      wrong = unreadable || error.message;
    }
    if (search !== searches) return;
    [found, fault] = [explained, wrong];
    put(verdict, 'aria-busy', 'false');
    sides.forEach((side, k) => {
      put(side.field, 'aria-invalid', String(fault.includes(`the ${['first', 'second'][k]} side`)));
      write(side.read, found ? wasRead(found, k, table) : '');
    });
    put(verdict, 'data-verdict', found?.verdict ?? '');
    const said = found ? answer(found, table, (declare) => change(model, answered(...declare))) : [element('p', { class: 'heading' }, 'Not readable yet'), element('p', {}, `${capital(fault)}.`)];
    verdict.replaceChildren(...said);
    mended();
    // While a question is open, do not show one of its answers under the drawing.
    const told = found?.question ? [ONE_QUESTION, found.question] : found ? [headingOf(found), ...found.faults.map((one) => `${capital(one)}.`)] : [`${capital(fault)}.`];
    words.say(told.join(' '));
    if (found) glideTo(drawnDcms(found, table, found.poses - 1));
  }

  // Even if both do as their manuals say, there may be something to convert.
  function mended() {
    const line = (found && !found.chains[0]?.relation.inside && (found.verdict === 'named' || found.names?.length)) || (found?.verdict === 'same' && found.asTheirManualsSay)
      ? LANGUAGES[language.element.querySelector('select').value](found.chains[0]) : '';
    mend.hidden = !line;
    write(code, line);
  }

  function draw() {
    sheet.draw(() => picture(sheet, shown));
  }

  // Take over an address when the page opens with it, or when it is pasted into an open page.
  function takeUp() {
    try {
      const carried = carriedBy(globalThis.location?.hash ?? '');
      if (carried?.place === PLACE) change(model, takenUp(carried.content, programs));
    } catch (error) {
      words.say(error.message);
      return error.message.replace(/\.$/, '');
    }
    return '';
  }

  // A page that was opened with an unreadable address says so, and shows no other numbers.
  let unreadable = takeUp();
  if (unreadable) change(model, { first: '', second: '' });
  judge();
  draw();
  globalThis.addEventListener?.('hashchange', takeUp);
  const unfollow = follow(model, STATE, onceAFrame(judge));
  return () => {
    searches += 1;
    globalThis.removeEventListener?.('hashchange', takeUp);
    unfollow();
  };
}

const headingOf = ({ verdict, asTheirManualsSay }) => (asTheirManualsSay && AS_THE_MANUALS_SAY[verdict]) || HEADINGS[verdict];
const capital = (text) => text[0].toUpperCase() + text.slice(1);

// Where the book teaches it, and questions for practice.
const linked = ([[section, title], ...questions]) => [element('a', { href: section }, title),
  ...questions.flatMap(([question, itsTitle], k) => [k ? ' and ' : `, and ${questions.length > 1 ? 'questions' : 'a question'}: `,
    element('a', { href: question }, itsTitle)]), '.'];

// Say how the numbers of one side were read.
function wasRead(found, k, table) {
  const { kinds, numbers } = found.sides[k], reading = found.chains[0]?.[k ? 'second' : 'first'], choices = reading?.choices ?? {};
  const how = reading ? table.kinds[reading.kind].map(({ group }) => told(group, choices[group])).filter(Boolean).join(', ') : '';
  return [`Read as ${several(numbers.length, 'poses')}: ${reading?.kind ?? kinds.join(' or ')}${how && `, ${how}`}.`,
    ...(found.remarks ?? []).filter((remark) => remark.includes(`the ${['first', 'second'][k]} side`))].join(' ');
}

const told = (group, value) => ({ order: () => [...value].join(' '), sequence: () => [...value].join('-'), places: () => (value === '123' ? '' : `printed ${[...value].join(', ')}`),
  signs: () => (value === '+++' ? '' : `signs ${[...value].join(' ')}`), 'place of the angle': () => `angle ${value}` }[group] ?? (() => value))();

// Return the answer for the reader; every fault links to where the book teaches it.
function answer(found, table, declare) {
  const best = found.chains[0], parts = [element('p', { class: 'heading' }, headingOf(found))];
  if (found.verdict === 'unrelated') {
    const poses = found.poses === 1 ? 'this pose' : `these ${found.poses} poses`;
    const more = found.poses < 3 ? ' It takes at least three poses to show whether an instrument is mounted askew: paste more poses.' : '';
    return [...parts, element('p', {}, `No combination of up to ${table['most faults']} mix-ups fits ${poses}.${more}${
      found.mirrored && ` The ${found.mirrored} side's matrix has determinant −1: it is a mirror image, not a rotation.`}`)];
  }
  if (found.names.length) {
    const told = ({ condition, faults, declare: known }) => [`${condition ? `If ${condition}: ` : ''}${faults.join('; ')}. `,
      ...(Object.keys(known[0]).length + Object.keys(known[1]).length ? [button('That is so', () => declare(known))] : [])];
    return [element('p', { class: 'heading' }, ONE_QUESTION), element('p', {}, found.question), element('ul', {}, ...found.names.map((name) => element('li', {}, ...told(name))),
      element('li', {}, table.none))];
  }
  if (found.verdict === 'undecided') parts.push(element('p', {}, 'The simplest explanation is:'));
  if (found.faults.length) {
    const links = taughtBy(best, table, found.ways);
    parts.push(element('ul', {}, ...found.faults.map((fault, k) => element('li', {}, `${capital(fault)}. `,
      ...(links[k] ? linked(links[k]) : [])))));
  }
  if (found.residual > 1e-3) parts.push(element('p', {}, `The remaining difference is ${Number(found.residual.toPrecision(2))} degrees.`));
  if (found.furtherPose) {
    parts.push(element('p', { class: 'further' }, `To decide, ${found.furtherPose}, and paste that pose as well, on a line of its own.`));
  }
  const others = found.chains.slice(1);
  if (others.length) {
    const first = others.slice(0, 60).map((chain) => element('li', {}, chain.words || 'both mean the same'));
    const rest = others.length > 60 ? [element('li', {}, `and ${several(others.length - 60, 'more readings')}`)] : [];
    parts.push(element('details', {}, element('summary', {}, `${several(others.length, 'other readings')} ${others.length === 1 ? 'fits' : 'fit'} as well`),
      element('ul', {}, ...first, ...rest)));
  }
  return parts;
}
