import { AXES, axisAngleFromDcm, bodyFixedFromDcm, checkDcm, dcmFromAxisAngle, dcmFromBodyFixed,
  dcmFromQuaternion, dcmFromSpaceFixed, decimalPoints, degrees, determinant, dot, gimbalLockMargin, IDENTITY,
  length, multiply, nearestDcm, quaternionFromDcm, radians, reversed, scale, SEQUENCES,
  several, spaceFixedFromDcm, transpose, unit } from './mathematics.js';
import { picture, SIZE } from './converter_picture.js';
import { canTakeAway, languageChoice, textBox, textOf, textsIn } from './take_away.js';
import { button, change, choice, element, fixed, follow, group, liveText, numberTable, onceAFrame, open, put,
  readout, Sheet, stage, write } from './shared.js';
import { hatted } from './words_picture.js';

const [N, A] = ['n', 'a'].map(hatted);
const OTHER = 'another program', ANGLES = ['body fixed angles', 'space fixed angles'];
const FORMS = { matrix: 9, quaternion: 4, [ANGLES[0]]: 3, [ANGLES[1]]: 3, 'axis times angle': 3 };
// Numbers copied with two or three digits are corrected, and we tell the reader; a larger error is another mistake.
const ROUNDED = 0.02, EXACT = 1e-6;
const NUMBER = /[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?/gi;
const MINUS = /\u2212\s*|\u2013/g, APART = /(\d\.?[ \t]+|[[(,;|&][ \t]*)-[ \t]+(?=[.\d])/g;   // a sign apart from its number

// Arithmetic, which we refuse; the type that NumPy prints; names of a quaternion's parts and of angles; and the two
// sequences in which such names have one meaning.
const ARITHMETIC = /\S*(?:π|√|sqrt|[*/^]|(?<![a-z])pi(?![a-z]))\S*/i, TYPE = /dtype\s*=\s*[\w.']+/g;
const PARTS = /([wxyz])["']?\s*[=:]/gi, NAMED_ANGLES = /roll|pitch|yaw/gi, TAIT_BRYAN = { zyx: 'yaw pitch roll', xyz: 'roll pitch yaw' };

// ---- the meaning of a side ------------------------------------------------------------------------------

// Return a side with the convention of its program instead of what the reader may have chosen.
export function settled(side, programs) {
  const facts = programs[side.program];
  if (!facts) return side;
  const sequences = sequencesOf(side, programs);
  return { ...side, matrix: facts.turned.includes(side.form) ? 'transposed' : 'as here', scalar: facts.scalar || 'first', unit: facts.unit,
    sequence: sequences.includes(side.sequence) ? side.sequence : sequences[0] };
}

export const formsOf = (program, programs) => (programs[program] ? Object.keys(programs[program].lines) : Object.keys(FORMS));

export const sequencesOf = (side, programs) => programs[side.program]?.sequences?.[side.form] ?? SEQUENCES;

// Return the orientation that the numbers in a text describe, and what was corrected; throw if they describe none.
export function read(side, text) {
  let numbers = (decimalPoints(text.replace(TYPE, '')).replace(MINUS, '-').replace(APART, (_, before) => `${before}-`).match(NUMBER) ?? []).map(Number);
  const wanted = FORMS[side.form], arithmetic = text.match(ARITHMETIC)?.[0];
  if (arithmetic) throw new Error(`This contains '${arithmetic}': work it out, and write the result.`);
  const commas = numbers.length > wanted && /\d,\d/.test(text) ? ' Write 0.5 for one half: a comma separates two numbers.' : '';
  const pose = side.form === 'matrix' && [12, 16].includes(numbers.length) ? ' Of a pose, only the three columns of its rotation belong here.' : '';
  if (numbers.length !== wanted) throw new Error(`There ${numbers.length === 1 ? 'is' : 'are'} ${several(numbers.length, 'numbers')} here, but ${side.form} needs ${wanted}.${commas}${pose}`);
  const names = [...text.matchAll(PARTS)].map(([, name]) => name.toLowerCase()), order = side.scalar === 'last' ? 'xyzw' : 'wxyz';
  if (side.form === 'quaternion' && [...names].sort().join('') === 'wxyz') numbers = [...order].map((part) => numbers[names.indexOf(part)]);
  const angles = text.toLowerCase().match(NAMED_ANGLES)?.join(' ');
  if (angles && ANGLES.includes(side.form) && angles !== TAIT_BRYAN[side.sequence]) {
    throw new Error(`The angles are named ${angles.replaceAll(' ', ', ')}. Write them without names, in the order of the sequence ${[...side.sequence].join('-')}.`);
  }
  if (side.unit === 'radians' && side.form !== 'matrix' && side.form !== 'quaternion' && /°|deg/i.test(text)) throw new Error('These are degrees: choose degrees, or write radians.');
  let dcm = null, said = '';
  if (side.form === 'matrix') {
    dcm = [0, 3, 6].map((k) => numbers.slice(k, k + 3));
    const fault = checkDcm(dcm), near = fault ? nearestDcm(dcm) : null;
    if (near && !(near.dcm && near.distance < ROUNDED)) throw new Error(`${fault}.`);
    if (near && near.distance > EXACT) said = `The matrix was rounded: we use the nearest valid one, ${near.distance.toFixed(4)} away.`;
    dcm = near ? near.dcm : dcm;
  } else if (side.form === 'quaternion') {
    const parts = side.scalar === 'last' ? [numbers[3], ...numbers.slice(0, 3)] : numbers, long = length(parts);
    if (Math.abs(long - 1) > ROUNDED) throw new Error(`The quaternion has length ${long.toFixed(4)}, not 1.`);
    if (Math.abs(long - 1) > EXACT) said = `The length was ${long.toFixed(4)}. It has been set to 1.`;
    dcm = dcmFromQuaternion(unit(parts));
  } else {
    const values = side.unit === 'degrees' ? numbers.map(radians) : numbers;
    if (side.unit === 'radians' && ANGLES.includes(side.form) && values.some((value) => Math.abs(value) > 2 * Math.PI)) {
      said = 'An angle is more than a whole turn: are these degrees?';
    }
    if (side.form === 'axis times angle') dcm = length(values) ? dcmFromAxisAngle(unit(values), length(values)) : IDENTITY;
    else dcm = (side.form === ANGLES[0] ? dcmFromBodyFixed : dcmFromSpaceFixed)(values, side.sequence);
  }
  return { dcm: side.matrix === 'transposed' ? transpose(dcm) : dcm, said };
}

// Return the numbers of an orientation, in a flat list, as the side means them.
export function told(side, orientation) {
  const dcm = side.matrix === 'transposed' ? transpose(orientation) : orientation;
  if (side.form === 'matrix') return dcm.flat();
  if (side.form === 'quaternion') {
    const [scalar, ...vector] = quaternionFromDcm(dcm);
    return side.scalar === 'last' ? [...vector, scalar] : [scalar, ...vector];
  }
  let values;
  if (side.form === 'axis times angle') {
    const [axis, angle] = axisAngleFromDcm(dcm);
    values = scale(angle, axis);
  } else values = (side.form === ANGLES[0] ? bodyFixedFromDcm : spaceFixedFromDcm)(dcm, side.sequence);
  return side.unit === 'degrees' ? values.map(degrees) : values;
}

// Express the orientation along the target's axes, if both manuals define the axes of an object or of its world. If
// only one triad is left-handed there is no such orientation, so nothing is exchanged.
export function byAxesOf(source, target, programs, dcm) {
  const sides = [source, target].map(({ program }) => ({ program, ...programs[program] })), [one, other] = sides;
  const [body, world] = [0, 1].map((k) => (one.axes?.[k] && other.axes?.[k] ? multiply(other.axes[k], transpose(one.axes[k])) : IDENTITY));
  if (determinant(body) !== determinant(world)) return { dcm, said: 'The axes of one of the world frames are unknown, so none are exchanged.' };
  return { dcm: multiply(body, dcm, transpose(world)),
    said: body === world ? '' : `x, y, z point ${sides.map((side) => `${side.body.join(', ')} in ${side.program}`).join('; ')}.` };
}

// Twelve digits after the point; with nine, a program that checks the length of a quaternion would refuse it.
const short = (value) => String(Number(value.toFixed(12)) + 0);

// Return the line of code that makes this orientation in the program of a side, or nothing for another program.
export function line(side, numbers, programs) {
  const template = programs[side.program]?.lines[side.form];
  if (!template) return '';
  const texts = numbers.map(short), letters = [...side.sequence], values = { s: side.sequence, S: side.sequence.toUpperCase() };
  if (side.form === 'matrix') {
    const rows = [0, 3, 6].map((k) => texts.slice(k, k + 3));
    Object.assign(values, { m: `[${rows.map((row) => `[${row.join(', ')}]`).join(', ')}]`, t: transpose(rows).flat().join(', ') });
  }
  if (side.form === 'quaternion') (side.scalar === 'last' ? 'xyzw' : 'wxyz').split('').forEach((name, k) => { values[name] = texts[k]; });
  if (side.form === 'axis times angle') AXES.forEach((name, k) => { values[name] = texts[k]; });
  if (ANGLES.includes(side.form)) {
    letters.forEach((letter, k) => Object.assign(values, { ['abc'[k]]: texts[k], ['ABC'[k]]: letter.toUpperCase(),
      ['ijk'[k]]: String(AXES.indexOf(letter)), [`a${letter}`]: texts[k] }));
  }
  return template.replace(/\{(-?)(\w+)\}/g, (_, minus, name) => (minus ? short(-values[name]) : values[name]));
}

// The formulas of the conversion: from the source to the matrix of this book, and from that to the target.
const NAMED = { quaternion: 'quaternion', [ANGLES[0]]: 'body_fixed', [ANGLES[1]]: 'space_fixed', 'axis times angle': 'rotation_vector' };
export const formulasOf = (source, target) => [
  ...(NAMED[source.form] ? [[`dcm_from_${NAMED[source.form]}`, source]] : []),
  ...(NAMED[target.form] ? [[`${NAMED[target.form]}_from_dcm`, target]] : [])];

// The displayed numbers; a matrix has three rows.
export const shown = (numbers) => (numbers.length === 9 ? [0, 3, 6].map((k) => numbers.slice(k, k + 3)) : [numbers])
  .map((row) => row.map(short).join(', ')).join('\n');

// ---- the figure ----------------------------------------------------------------------------------------

export function render({ model, el }) {
  const programs = model.get('programs');
  let fault = '', said = '', text = '';
  const side = (name) => settled(model.get(name), programs);
  const sheet = new Sheet({ bounds: [-180, -172, 180, 172], size: SIZE, changed: () => redraw(),
    name: 'Triads of the frames N and A: the orientation that is converted.' });
  const redraw = onceAFrame(draw);
  const words = liveText();
  const field = element('textarea', { rows: 3, spellcheck: 'false', 'aria-label': 'Numbers to convert',
    input: () => take(field.value) });
  const result = element('output', { class: 'result', 'aria-label': 'Converted numbers' });
  const code = element('output', { class: 'result', 'aria-label': 'Line of code' });
  const copy = button('Copy the line', async () => {
    await navigator.clipboard.writeText(`${code.textContent}\n`);
    words.say('Line copied.');
  });
  const swap = button('Exchange the two sides', () => {
    const [from, to] = [model.get('source'), model.get('target')];
    change(model, { source: to, target: from });
    refill();
  });

  // A change of the source changes the meaning of the text; a change of the target only changes the output.
  function pick(name, values) {
    const chosen = { ...model.get(name), ...values };
    if (!formsOf(chosen.program, programs).includes(chosen.form)) chosen.form = formsOf(chosen.program, programs)[0];
    const before = model.get(name);
    change(model, { [name]: settled(chosen, programs) });
    if (name !== 'source') return;
    // With another kind of numbers the text would make no sense, so we write it again. To read the same numbers in
    // another way is what the reader asks for.
    if (FORMS[chosen.form] !== FORMS[before.form]) refill(); else take(text);
  }

  function refill() {
    text = shown(told(side('source'), dcmFromQuaternion(model.get('quaternion'))));
    field.value = text;
    take(text);
  }

  function take(typed) {
    text = typed;
    try {
      const reading = read(side('source'), typed);
      fault = '';
      said = reading.said;
      change(model, { quaternion: quaternionFromDcm(reading.dcm) });
    } catch (error) {
      fault = error.message;
    }
    put(field, 'aria-invalid', String(Boolean(fault)));
    redraw();
  }

  const box = textBox((text) => words.say(text)), none = 'no language yet';
  let chosen = none;
  const language = languageChoice((value) => { chosen = value; redraw(); }, [none]);

  async function takeAway() {
    const formulas = formulasOf(side('source'), side('target')), now = chosen;
    language.show(now);
    box.element.hidden = now === none;
    if (now === none) return;
    try {
      const texts = await textsIn(now);
      if (now !== chosen) return;
      box.show(formulas.map(([name, how]) => textOf(texts, name, how)).join('\n\n'), formulas.map(([name]) => name).join('_and_'), now);
    } catch (error) { words.say(error.message); }
  }

  const panel = (name, heading) => {
    const lists = {
      program: choice({ name: `${heading}: program`, options: [...Object.keys(programs), OTHER], hidden: true, change: (value) => pick(name, { program: value }) }),
      form: choice({ name: `${heading}: form`, options: Object.keys(FORMS), hidden: true, change: (value) => pick(name, { form: value }) }),
      sequence: choice({ name: `${heading}: sequence`, options: SEQUENCES.map((one) => [one, [...one].join('-')]), hidden: true, change: (value) => pick(name, { sequence: value }) }),
      matrix: choice({ name: `${heading}: way round`, options: [['as here', 'as here (passive)'], ['transposed', 'transposed (active)']], hidden: true, change: (value) => pick(name, { matrix: value }) }),
      scalar: choice({ name: `${heading}: scalar`, options: [['first', 'scalar first'], ['last', 'scalar last']], hidden: true, change: (value) => pick(name, { scalar: value }) }),
      unit: choice({ name: `${heading}: unit`, options: ['radians', 'degrees'], hidden: true, change: (value) => pick(name, { unit: value }) }),
    };
    const box = element('div', { class: 'row-of-controls' }, ...Object.values(lists).map((list) => list.element));
    return { box, show() {
      const now = side(name), known = Boolean(programs[now.program]), forms = formsOf(now.program, programs);
      const needed = { matrix: now.form === 'matrix' || !known, scalar: now.form === 'quaternion',
        unit: !['matrix', 'quaternion'].includes(now.form), sequence: ANGLES.includes(now.form) };
      for (const [key, list] of Object.entries(lists)) {
        list.show(now[key]);
        const select = list.element.querySelector('select');
        // A convention that the program fixes cannot be chosen, and forms that it does not take are not offered.
        if (key === 'form') for (const option of select.options) option.hidden = option.disabled = !forms.includes(option.value);
        if (key === 'sequence') for (const option of select.options) option.hidden = option.disabled = !sequencesOf(now, programs).includes(option.value);
        if (key in needed) {
          list.element.hidden = !needed[key];
          select.disabled = known && key !== 'sequence';
        }
      }
    } };
  };
  const panels = [panel('source', 'From'), panel('target', 'To')];
  const matrix = numberTable({ name: 'Direction cosine matrix of A with respect to N', kind: 'bracket', rows: A, columns: N,
    names: AXES.map((i) => AXES.map((j) => `a ${i} dot n ${j}`)), light: () => {} });
  const quaternion = numberTable({ name: 'Quaternion, scalar first', columns: ['$q_0$', '$q_i$', '$q_j$', '$q_k$'],
    names: [['q 0', 'q i', 'q j', 'q k']], light: () => {} });
  open(el, stage(sheet, words),
    element('div', { class: 'readouts' }, readout(['In this book: direction cosine matrix ${}^A\\mathbf{C}^N$'], matrix.element),
      readout(['Quaternion'], quaternion.element), swap),
    element('div', { class: 'controls converter' },
      group('From', 'side', element('div', { class: 'title' }, 'From'), panels[0].box, field),
      group('To', 'side', element('div', { class: 'title' }, 'To'), panels[1].box, result)),
    group('Line of code', 'controls line', element('div', { class: 'title' }, 'Line of code'), code, copy),
    ...(canTakeAway() ? [group('Formula', 'controls line', element('div', { class: 'title' }, 'The formula itself'),
      language.element, box.element)] : []));

  function draw() {
    const dcm = dcmFromQuaternion(model.get('quaternion')), to = side('target'), exchanged = byAxesOf(side('source'), to, programs, dcm);
    const numbers = told(to, exchanged.dcm);
    for (const panel of panels) panel.show();
    matrix.show(dcm.map((row) => row.map((entry) => fixed(entry))));
    quaternion.show([quaternionFromDcm(dcm).map((entry) => fixed(entry))]);
    write(result, fault ? '\u2013' : shown(numbers));
    const programmed = fault ? '' : line(to, numbers, programs);
    write(code, programmed || '\u2013');
    copy.disabled = !programmed;
    takeAway();
    sheet.draw(() => picture(sheet, dcm));
    words.say(fault || [said, exchanged.said, note(to, numbers, programs)].filter(Boolean).join(' '));
  }

  draw();
  refill();
  const unfollow = follow(model, ['quaternion', 'source', 'target'], redraw);
  return unfollow;
}

// Return what the reader should know about the result.
function note(to, numbers, programs) {
  const angles = to.unit === 'degrees' ? numbers.map(radians) : numbers;
  if (to.form === ANGLES[0] && gimbalLockMargin(angles, to.sequence) < 1e-6
    || to.form === ANGLES[1] && gimbalLockMargin(reversed(angles), reversed(to.sequence).join('')) < 1e-6) {
    return 'This is gimbal lock: the first and the last angle could share this rotation between them in any other way.';
  }
  const version = programs[to.program]?.version;
  const means = { matrix: `the matrix is ${to.matrix}`, quaternion: `the scalar comes ${to.scalar}` }[to.form] ?? `the numbers are in ${to.unit}`;
  return `For ${to.program}${version ? ` (tested: ${version})` : ''} ${means}.`;
}
