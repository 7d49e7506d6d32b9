// The search of orientation_workbench.mismatch in JavaScript: what two programs mean differently by the numbers they
// give for the same poses. Readings, relations, costs and words come with the figure from that package's table. Here
// are the reader of text and the loops; tests/test_mismatch_in_the_page.py checks both against the same cases.
import { AXES, axisAngleFromDcm, bodyFixedFromDcm, cross, dcmFromAxisAngle, dcmFromBodyFixed,
  dcmFromQuaternion, decimalPoints, determinant, distance, dot, IDENTITY, length, multiply, nearestDcm, quaternionFromDcm, scale,
  SEQUENCES, several, transpose, unit } from './mathematics.js';

const SINGLE_PRECISION = 2e-6, BY_CHANCE = 1e-3, LOOKED_AT = 300, MANY = 500, MOTION = 3, LOOSER = 6, EXACT = 20, DEARER = 1.15, DEARER_ON_ONE_SIDE = 0.4, DEARER_CROSSED = 1.7, READ_AS = 60, SLACK = 1e-4, NORMALISED = 1e-3;
const COUNT = { matrix: 9, quaternion: 4, 'Euler angles': 3, 'rotation vector': 3, 'axis and angle': 4 };
export const TURNS = 'axes of the turns';
const SAME_AXES = 'x y z', DEGREE = Math.PI / 180;

// ---- reading the pasted text -----------------------------------------------------------------------------

// Cache what is derived from a table, once for each table.
const onceFor = (make) => {
  const made = new WeakMap();
  return (table) => made.get(table) ?? made.set(table, make(table)).get(table);
};

const PLACE_OF_ANGLE = { yaw: 0, heading: 0, psi: 0, pitch: 1, theta: 1, roll: 2, bank: 2, phi: 2 };
// The patterns of orientation_workbench.mismatch.spelling.
const spellingOf = onceFor(({ spelling: said }) => {
  const made = (pattern, flags = 'gim') => new RegExp(pattern, flags);
  const pairs = (entries, flags) => entries.map(([pattern, more]) => [made(pattern, flags), more]);
  return { ...Object.fromEntries(Object.entries(said).filter(([, pattern]) => typeof pattern === 'string').map(([name, pattern]) => [name, made(pattern)])),
    cleaning: pairs(said.cleaning), signs: pairs(said['signs of a sum']), whole: pairs(said['cut out'], 'im'), orders: pairs(said['orders of angles'], 'im'),
    parts: pairs(said['orders of parts'], 'im'), value: made(said['not turns'] + said.value),
    names: [[{ w: 0, x: 1, y: 2, z: 3 }, { order: 'wxyz' }], [PLACE_OF_ANGLE, said['yaw pitch roll']], [{ y: 0, p: 1, r: 2 }, said['yaw pitch roll']],
      [{ x: 0, y: 1, z: 2 }, {}]] };
});
// Check for a match; the pattern is a global one.
const has = (pattern, text) => text.search(pattern) >= 0;
const firstOf = (pattern, text) => text.match(pattern)?.[0].trim();

// Return the poses in a text: their possible kinds, their numbers, half a unit of the last digit. An Error says what
// was read and what is missing.
export function readPoses(given, name, table, kind = null, noise = 0) {
  const { rows, half, declared } = rowsOf(given, name, spellingOf(table));
  const numbers = posesOf(rows, name, kind, half);
  if (numbers.some((pose) => pose.some((value) => !Number.isFinite(value)))) throw new Error(`the ${name} side contains a number that is not finite`);
  const kinds = kindsOf(numbers, kind, half + noise, name);
  return { kinds, numbers, half, declared, large: numbers.flat().some((value) => Math.abs(value) > 2 * Math.PI + 0.01) };
}

function rowsOf(given, name, spelling) {
  const whole = spelling.whole.find(([pattern]) => pattern.test(given)), columns = columnsOf(decimalPoints(given), spelling);
  if (whole) throw new Error(`the ${name} side is ${whole[1]}`);
  if (columns) return columns;
  let text = spelling.cleaning.reduce((cleaned, [pattern, replacement]) => cleaned.replace(pattern, replacement), given);
  const parts = spelling.parts.filter(([pattern]) => pattern.test(text));
  const bare = text.replace(spelling.comment, '');
  if (has(spelling.number, bare)) text = bare;   // if only the comments contain numbers, they are meant
  text = withoutPlaces(decimalPoints(text), spelling);
  const wrong = firstOf(spelling['not a number'], text), arithmetic = firstOf(spelling.arithmetic, text);
  if (wrong) throw new Error(`the ${name} side contains '${wrong}', which is not a number`);
  if (arithmetic) throw new Error(`the ${name} side contains '${arithmetic}': work it out and paste the result`);
  text = sums(text, spelling);
  const found = text.match(spelling.number);
  if (!found) {
    const start = text.trim().replace(/\s+/g, ' ').slice(0, 40);
    throw new Error(start ? `the ${name} side contains no numbers: '${start}'` : `the ${name} side is empty: paste its numbers`);
  }
  const declared = has(spelling.degrees, text) ? { unit: 'degrees' } : has(spelling.radians, text) ? { unit: 'radians' } : {};
  const named = labelled(text, spelling);
  if (named) return { rows: named.rows, half: named.half, declared: { ...declared, ...named.more } };
  const half = halfUnit(found);
  let rows = [...text.matchAll(spelling.innermost)].map(([, group]) => (group.match(spelling.number) ?? []).map(Number)).filter((row) => row.length);
  const inBrackets = [3, 4, 9, 12, 16].includes(rows[0]?.length) && rows.every((row) => row.length === rows[0].length);
  if (!inBrackets || rows.flat().length !== found.length) rows = rowsOfLines(text, spelling);
  const said = rows.every((row) => row.length === 3) && spelling.orders.find(([pattern]) => pattern.test(text));
  const ordered = parts.length === 1 && rows.every((row) => row.length === 4) ? parts[0][1] : {};
  return { rows, half, declared: { ...declared, ...(said ? said[1] : {}), ...ordered } };
}

// Return the fields of a line of a table, split at separators or else at spaces.
function fieldsOf(line, spelling) {
  const bare = line.trim().replace(/^\|+|\|+$/g, ''), parted = has(spelling.parting, bare) ? bare.trim().split(spelling.parting) : bare.trim().split(/\s+/);
  const fields = parted.filter((field, k) => field || k || parted.length > 1).map((field) => field.replace(spelling['around a field'], ''));
  return fields.length && !fields.at(-1) ? fields.slice(0, -1) : fields;
}

// Return the rows of a table with column names, or null without.
function columnsOf(given, spelling) {
  const lines = spelling.cleaning.slice(0, 4).reduce((cleaned, [pattern, replacement]) => cleaned.replace(pattern, replacement), given).split('\n');
  for (const [place, line] of lines.entries()) {
    const names = has(spelling.number, line) ? [] : fieldsOf(line.replace(spelling['around a field'], ''), spelling).map((field) => field.toLowerCase());
    if (names.length < 3) continue;
    const table = lines.slice(place + 1).filter((below) => !has(spelling['no row'], below)).map((below) => fieldsOf(below, spelling));
    const found = table.length && table.every((row) => row.length === names.length) ? namedColumns(names, spelling) : null;
    const kept = found ? table.map((row) => found.which.map((column) => row[column])) : [];
    if (!found || !kept.flat().every((field) => has(spelling['whole number'], field))) continue;
    const said = line.replaceAll('_', ' '), unit = has(spelling.degrees, said) ? { unit: 'degrees' } : has(spelling.radians, said) ? { unit: 'radians' } : {};
    return { rows: kept.map((row) => row.map(Number)), half: halfUnit(kept.flat()), declared: { ...found.more, ...unit } };
  }
  return null;
}

// Return the columns that hold an orientation, in order, and what their names declare.
function namedColumns(names, spelling) {
  const bare = names.map((name) => name.replace(spelling['unit of a column'], ''));
  const entries = bare.map((name, column) => [[...name.matchAll(spelling['entry of a matrix'])][0], column]).filter(([found]) => found);
  if (entries.length === 9) return { which: entries.map(([[, row, column], at]) => [row + column, at]).sort((left, right) => left[0] - right[0]).map(([, at]) => at), more: {} };
  for (const own of [bare.map((name) => has(spelling['of a quaternion'], name)), bare.map(() => true)]) {
    const keys = bare.map((name, k) => (own[k] ? name.replace(/^(.*[_.])?q?_*/, '') : ''));
    for (const [place, more] of spelling.names.slice(0, 2)) {
      const each = Array.from({ length: Math.max(...Object.values(place)) + 1 }, (_, at) => keys.flatMap((key, column) => (Object.hasOwn(place, key) && place[key] === at ? [column] : [])));
      if (each.every((columns) => columns.length === 1)) {
        // Keep the order of the columns, so that messages about the numbers match the reader's.
        const order = each.map((_, at) => at).sort((left, right) => each[left][0] - each[right][0]), [name, letters] = more.order ? ['order', 'wxyz'] : ['places', '123'];
        return { which: order.map((at) => each[at][0]), more: { ...more, [name]: order.map((at) => letters[at]).join('') } };
      }
    }
  }
  return null;
}

function rowsOfLines(text, spelling) {
  // Semicolons with one number between them separate columns, as in a spreadsheet's file.
  const columns = text.split(/[\n;]/).every((piece) => (piece.match(spelling.number) ?? []).length < 2);
  return (columns ? text.replaceAll(';', ' ') : text).split(/[\n;]|\]\s*,?\s*\[|\)\s*,?\s*\(|\}\s*,?\s*\{/).map((piece) => (piece.match(spelling.number) ?? []).map(Number)).filter((row) => row.length);
}

// Replace i, j and k by names if quaternions are written as sums.
function sums(text, spelling) {
  if (!has(spelling.sum, text)) return text;
  const joined = spelling.signs.reduce((cleaned, [pattern, replacement]) => cleaned.replace(pattern, replacement), text);
  return joined.replace(spelling['part of a sum'], (_, number, part) => ` ${'xyz'['ijk'.indexOf(part.toLowerCase())]}=${number} `)
    .replace(spelling['scalar of a sum'], ' w=$1 ');
}

function withoutPlaces(text, spelling) {
  const kept = [];
  let below = null;
  for (const line of text.replace(spelling.value, ' ').split('\n')) {
    const inset = line.length - line.trimStart().length;
    if (below !== null && line.trim() && inset > below) continue;
    const match = [...line.matchAll(spelling['not turns'])][0];
    below = match && !line.slice(match.index + match[0].length).trim() ? inset : null;
    kept.push(line.replace(spelling['not turns'], ' '));
  }
  return kept.join('\n');
}

function labelled(text, spelling) {
  const all = [];
  for (const match of text.matchAll(spelling.named)) {
    const behind = new RegExp(spelling.number.source, 'yi');
    behind.lastIndex = match.index + match[0].length;
    const number = behind.exec(text);
    if (number) all.push([match[1].toLowerCase(), number[0]]);
  }
  const parts = all.filter(([key]) => has(spelling['part of a quaternion'], key));
  const pairs = (parts.length ? parts : all).map(([key, number]) => [key.replace(/^(.*[_.])?q?_*/, ''), number]);
  for (const [place, more] of spelling.names) {
    const size = Math.max(...Object.values(place)) + 1, kept = pairs.filter(([key]) => Object.hasOwn(place, key));
    if (!kept.length || kept.length % size || (size === 3 && 'x' in place && pairs.some(([key]) => key === 'w'))) continue;
    const rows = blocks(Array(kept.length).fill(null), size);
    kept.forEach(([key, value], which) => { rows[Math.floor(which / size)][place[key]] = Number(value); });
    if (!rows.flat().includes(null)) return { rows, half: halfUnit(kept.map(([, value]) => value)), more };
  }
  return null;
}

function halfUnit(found) {
  const sizes = found.map((number) => Math.abs(Number(number))), largest = Math.max(...sizes);
  const large = found.filter((_, k) => sizes[k] >= 0.1 * largest).map((number) => number.toLowerCase().split('e'));
  const decimals = Math.max(...large.map(([mantissa, power]) => (mantissa.split('.')[1] ?? '').length - Number(power ?? 0)));
  return decimals > 0 ? 0.5 * 10 ** -decimals : 0;
}

const blocks = (list, size) => Array.from({ length: list.length / size }, (_, k) => list.slice(k * size, (k + 1) * size));
const rowsOfNine = (numbers) => [0, 3, 6].map((k) => numbers.slice(k, k + 3));
// For each pair of rows, return the difference of their product from that of orthonormal rows.
const gapsOf = (dcm) => dcm.map((row, i) => dcm.map((other, j) => Math.abs(dot(row, other) - (i === j ? 1 : 0))));
const orthogonal = (rows) => blocks(rows, 3).every((dcm) => gapsOf(dcm).flat().every((gap) => gap < 0.1));

function posesOf(rows, name, kind, half) {
  const width = rows.every((row) => row.length === rows[0].length) ? rows[0].length : 0, flat = rows.flat(), total = flat.length;
  const free = kind === null || kind === 'matrix', four = kind === null || kind === 'quaternion';
  if (width === 3 && free && rows.length % 3 === 0 && (kind || orthogonal(rows))) return blocks(flat, 9);
  if (width === 4 && free) {
    if (rows.length % 4 === 0 && rows.every((row, k) => k % 4 < 3 || String(row) === '0,0,0,1')) {
      return blocks(rows, 4).map((matrix) => matrix.slice(0, 3).flatMap((row) => row.slice(0, 3)));
    }
    const turns = rows.map((row) => row.slice(0, 3));
    if (rows.length % 3 === 0 && orthogonal(turns)) return blocks(turns, 3).map((matrix) => matrix.flat());
  }
  if ((width === 3 || width === 4) && kind !== 'matrix') return rows;
  const among = width > 4 && four ? quaternionAmong(rows, half) : null;
  if (among !== null) return rows.map((row) => row.slice(among, among + 4));
  if ([9, 12, 16].includes(width)) return rows.map(nineOf);
  for (const size of total > 8 ? [9, 12, 16] : [3, 4]) {
    if (total % size || (size < 5 && total !== size)) continue;
    const poses = blocks(flat, size).map((row) => (size > 4 ? nineOf(row) : row));
    if (size > 4 && (total !== size || width === 6) && !orthogonal(blocks(poses.flat(), 3))) continue;
    return poses;
  }
  const place = total > 4 && total !== 12 && four ? quaternionAmong([flat], half) : null;
  if (place !== null) return [flat.slice(place, place + 4)];
  const where = rows.length === 1 ? 'one line' : `${rows.length} lines`;
  throw new Error(`the ${name} side contains ${several(total, 'numbers')} in ${where}: a pose takes 3 (angles, or a rotation `
    + 'vector), 4 (a quaternion, or an axis and its angle), 9 (a matrix) or 16 (a matrix with a translation); '
    + 'leave out positions, except beside a quaternion (four consecutive numbers of length 1)');
}

// The nine entries of a rotation matrix, even from one that includes a position.
const nineOf = (row) => (row.length === 9 ? row : [0, 4, 8].flatMap((k) => row.slice(k, k + 3)));

// Return where each row has four numbers of length 1: last, first, or at one place only.
function quaternionAmong(rows, half) {
  const width = rows[0].length;
  if ([9, 12, 16].includes(width) && orthogonal(blocks(rows.flatMap(nineOf), 3))) return null;
  const places = Array.from({ length: width - 3 }, (_, k) => k).filter((k) => rows.every((row) => Math.abs(length(row.slice(k, k + 4)) - 1) < 10 * SLACK + 2 * half));
  if (places.includes(width - 4)) return width - 4;
  return places.length === 1 || places[0] === 0 ? places[0] : null;
}

// Format a number like Python: very large and very small numbers have a power of ten with two digits.
function short(value, digits = 6) {
  const rounded = Number(value.toPrecision(digits)), size = Math.abs(rounded);
  return size && (size >= 10 ** digits || size < 1e-4) ? rounded.toExponential().replace(/([-+])(\d)$/, '$10$2') : String(rounded);
}
const isUnit = (vectors, doubt) => vectors.every((vector) => Math.abs(length(vector) - 1) <= 2 * doubt + SLACK);

function kindsOf(numbers, kind, doubt, name) {
  const count = numbers[0].length;
  if (kind !== null && COUNT[kind] !== count) throw new Error(`the ${name} side contains ${count} numbers per pose; a ${kind} takes ${COUNT[kind]}`);
  const four = count === 4 && isUnit(numbers, doubt + NORMALISED / 2) ? ['quaternion'] : ['axis and angle'];
  const kinds = kind !== null ? [kind] : { 9: ['matrix'], 3: ['Euler angles', 'rotation vector'] }[count] ?? four;
  if (kinds[0] === 'matrix') demandOrthogonal(numbers, doubt, name);
  if (kinds[0] === 'quaternion' && !isUnit(numbers, Math.max(doubt, 0.01))) {
    const worst = numbers.map(length).reduce((worst, size) => (Math.abs(size - 1) > Math.abs(worst - 1) ? size : worst));
    throw new Error(`a quaternion on the ${name} side has length ${short(worst)}, not 1`);
  }
  if (kinds[0] === 'axis and angle' && ![[0, 3], [1, 4]].some(([from, to]) => isUnit(numbers.map((pose) => pose.slice(from, to)), doubt))) {
    throw new Error(`the four numbers on the ${name} side are neither a quaternion (their length is ${short(length(numbers[0]))}, not 1) nor `
      + 'an axis and its angle (neither the first three nor the last three have length 1)');
  }
  return kinds;
}

function demandOrthogonal(numbers, doubt, name) {
  numbers.forEach((pose, which) => {
    const dcm = rowsOfNine(pose), gaps = gapsOf(dcm).flat(), worst = gaps.indexOf(Math.max(...gaps));
    if (gaps[worst] <= 6 * doubt + 2 * SLACK) return;
    const row = Math.floor(worst / 3), other = worst % 3;
    const what = row === other ? `row ${row + 1} has length ${short(length(dcm[row]))}, not 1`
      : `the dot product of rows ${row + 1} and ${other + 1} is ${short(dot(dcm[row], dcm[other]))}, not 0`;
    throw new Error(`matrix ${which + 1} on the ${name} side is not a rotation: ${what}`);
  });
}

// ---- the meaning of numbers ------------------------------------------------------------------------------

const radiansOf = (choices) => (choices.unit === 'degrees' ? DEGREE : 1);
const turnOf = (vector) => (length(vector) ? dcmFromAxisAngle(unit(vector), length(vector)) : rowsOfNine([1, 0, 0, 0, 1, 0, 0, 0, 1]));
const backwards = (list, from) => (from ? [...list].reverse() : list);

function dcmFromNumbers({ kind, choices }, numbers) {
  if (kind === 'matrix') return rowsOfNine(numbers);
  if (kind === 'quaternion') return dcmFromQuaternion(unit([...'wxyz'].map((part) => numbers[choices.order.indexOf(part)])));
  if (kind === 'rotation vector') return turnOf(scale(radiansOf(choices), numbers));
  if (kind === 'axis and angle') {
    const last = choices['place of the angle'] === 'last';
    return dcmFromAxisAngle(unit(last ? numbers.slice(0, 3) : numbers.slice(1)), numbers[last ? 3 : 0] * radiansOf(choices));
  }
  const turns = ['1', '2', '3'].map((which, k) => numbers[choices.places.indexOf(which)] * (choices.signs[k] === '-' ? -1 : 1) * radiansOf(choices));
  const space = choices['axes of the turns'] === 'space fixed';
  return dcmFromBodyFixed(backwards(turns, space), backwards([...choices.sequence], space).join(''));
}

function numbersFromDcm({ kind, choices }, dcm) {
  if (kind === 'matrix') return [dcm.flat()];
  if (kind === 'quaternion') {
    const parts = quaternionFromDcm(dcm);
    return [[...choices.order].map((part) => parts['wxyz'.indexOf(part)])];
  }
  if (kind === 'rotation vector' || kind === 'axis and angle') {
    const [axis, angle] = axisAngleFromDcm(dcm), size = angle / radiansOf(choices);
    if (kind === 'rotation vector') return [scale(size, axis)];
    return [choices['place of the angle'] === 'last' ? [...axis, size] : [size, ...axis]];
  }
  const space = choices['axes of the turns'] === 'space fixed', sequence = backwards([...choices.sequence], space).join('');
  const [first, middle, last] = bodyFixedFromDcm(dcm, sequence);
  const other = sequence[0] === sequence[2] ? -middle : Math.PI - middle;
  return [[first, middle, last], [first + Math.PI, other, last + Math.PI]].map((triple) => {
    const turns = backwards(triple, space).map((angle, k) => {
      const signed = (choices.signs[k] === '-' ? -angle : angle) + Math.PI;
      return signed - 2 * Math.PI * Math.floor(signed / (2 * Math.PI)) - Math.PI;
    });
    return [...choices.places].map((which) => turns[Number(which) - 1] / radiansOf(choices));
  });
}

function doubtOf({ kind, choices }, half) {
  const size = radiansOf(choices);
  return half * ({ matrix: 1, quaternion: 4, 'axis and angle': 4 + size }[kind] ?? 3 * size);
}

// ---- the table -----------------------------------------------------------------------------------------

const axesMatrix = (names) => names.split(' ').map((name) => AXES.map((axis) => (name.at(-1) === axis ? (name.length > 1 ? -1 : 1) : 0)));
const SIGNED_AXES = ['x y z', 'x z y', 'y x z', 'y z x', 'z x y', 'z y x'].flatMap((letters) => [0, 1, 2, 3, 4, 5, 6, 7].map((bits) =>
  letters.split(' ').map((letter, k) => ((bits >> (2 - k)) & 1 ? '-' : '') + letter).join(' ')));
const opposite = (names) => names.split(' ').map((name) => (name.length > 1 ? name[1] : `-${name}`)).join(' ');

function axesChoice(names, body, table) {
  if (names === SAME_AXES) return { words: '', rarity: 0, faults: 0 };
  const known = table[body ? 'body axes' : 'world axes'].find(([listed]) => listed.join(' ') === names), whose = body ? 'body' : 'world';
  if (known) return { words: known[1], rarity: 0.1, faults: 1 };
  const parts = names.split(' '), reversed = parts.filter((name) => name.length > 1).map((name) => name[1]);
  if (names.replaceAll('-', '') === SAME_AXES) {
    return { words: `${reversed.length < 3 ? reversed.join(' and ') : 'all axes'} of the ${whose} reversed`, rarity: 0.3, faults: 1 };
  }
  return { words: `the ${whose}'s axes x, y, z are called ${parts.join(', ')} by the other program`, rarity: 0.6, faults: 1 };
}

// Return the difference that two programs' manuals predict, like expected_relation in Python.
function expectedRelation(programs, kinds, table) {
  if (!programs[0] || !programs[1]) return { inverse: false, body: SAME_AXES, world: SAME_AXES };
  const axes = ['body', 'world'].map((what) => {
    const [one, other] = programs.map((program) => program[what]);
    if (!one || !other) return SAME_AXES;
    return other.map((way) => (one.includes(way) ? AXES[one.indexOf(way)] : `-${AXES[one.indexOf(table.opposites[way])]}`)).join(' ');
  });
  const turned = programs.map((program, k) => program.inverse.includes(kinds[k]));
  if (turned[1]) axes.reverse();
  return { inverse: turned[0] !== turned[1], body: axes[0], world: axes[1] };
}

// Return the axes after renaming them twice, first by others and then by names.
const after = (names, others) => names.split(' ').map((name) => {
  const other = others.split(' ')['xyz'.indexOf(name.at(-1))];
  return name.length > 1 ? opposite(other) : other;
}).join(' ');

// Return the relation applied on top of the expected one, with its own words.
function beyond(relation, expected) {
  const [body, world] = relation.inverse ? [expected.world, expected.body] : [expected.body, expected.world];
  const names = { body: after(relation.body, body), world: after(relation.world, world) };
  return { ...relation, ...names, inverse: relation.inverse !== expected.inverse, left: axesMatrix(names.body),
    right: transpose(axesMatrix(names.world)), said: relation };
}

export function* relationsOf(mirrored, table) {
  const best = new Map(), axes = SIGNED_AXES.map((names) => ({ names, body: axesChoice(names, true, table), world: axesChoice(names, false, table),
    left: determinant(axesMatrix(names)) < 0 }));
  for (const inverse of [false, true]) {
    for (const body of axes) {
      yield;
      for (const world of axes) {
        if ((body.left !== world.left) !== mirrored) continue;
        const hand = body.names === world.names && body.names.replaceAll('-', '') === SAME_AXES && body.names.split('-').length === 2;
        // The rows of an inverse are the world's axes, so describe them as the world's.
        const [one, other] = inverse ? [body.world, world.body] : [body.body, world.world];
        const faults = (hand ? 1 : one.faults + other.faults) + inverse, rarity = hand ? 0.1 : one.rarity + other.rarity;
        if (faults > table['most faults']) continue;
        const turned = body.names.startsWith('-');
        const key = [inverse, turned ? opposite(body.names) : body.names, turned ? opposite(world.names) : world.names].join();
        const held = best.get(key);
        if (!held || faults < held.faults || (faults === held.faults && rarity < held.rarity)) {
          best.set(key, { faults, rarity, inverse, body: body.names, world: world.names, hand,
            left: axesMatrix(body.names), right: transpose(axesMatrix(world.names)) });
        }
      }
    }
  }
  return [...best.values()].sort((left, right) => left.faults - right.faults || left.rarity - right.rarity || left.inverse - right.inverse);
}

const isShared = (group, value, table) => table.shared.some(([own, one]) => own === group && one === value);

// Return faults, rarity and words of both sides' readings; what both do alike is not a fault.
function ofBoth(first, second) {
  const alike = first.shared.filter((words) => second.shared.includes(words));
  const units = unitChanges(first, second) ? [`the first numbers are in ${first.unit}, the second in ${second.unit}`] : [];
  return { faults: first.faults + second.faults - 2 * alike.length + units.length + sequenceChanges(first, second), rarity: first.rarity + second.rarity + 0.1 * alike.length,
    words: [['first', first], ['second', second]].flatMap(([side, { words }]) => words.filter((word) => !alike.includes(word))
      .map((word) => `in the ${side} numbers ${word}`)).concat(units) };
}

function readingsOf(kind, declared, large, table) {
  const base = { ...table.book, ...(large ? { unit: 'degrees' } : {}), ...declared };
  let partial = [{ kind, choices: {}, faults: 0, rarity: 0, words: [], shared: [] }];
  for (const { group, choices } of table.kinds[kind]) {
    const longer = [];
    for (const chosen of partial) {
      for (const option of choices) {
        const usual = base[group] === option.value, more = usual || !(group in base) ? 0 : option.faults || 1;
        if (chosen.faults + more > table['most faults']) continue;
        longer.push({ kind, choices: { ...chosen.choices, [group]: option.value }, faults: chosen.faults + more,
          rarity: chosen.rarity + (usual ? 0 : option.rarity), words: usual ? chosen.words : [...chosen.words, option.words],
          shared: more && isShared(group, option.value, table) ? [...chosen.shared, option.words] : chosen.shared });
      }
    }
    partial = longer;
  }
  for (const reading of partial) {
    const { unit: inUnit, sequence: letters = '' } = reading.choices, canonical = backwards([...letters], reading.choices['axes of the turns'] === 'space fixed').join('');
    Object.assign(reading, { unit: inUnit === base.unit ? inUnit : '', letters, canonical, known: { unit: 'unit' in declared, sequence: 'sequence' in declared } });
  }
  return partial;
}

// Whether the unit, or the sequence, changes between two readings unless both are declared.
const unitChanges = (first, second) => Boolean(first.unit && second.unit && first.unit !== second.unit && !(first.known.unit && second.known.unit));
const sequenceChanges = (one, other) => Boolean(one.letters && other.letters && one.letters !== other.letters && one.canonical !== other.canonical
  && !(one.known.sequence && other.known.sequence));

// Return a key shared by equivalent readings: space fixed is body fixed in reverse order.
function readingKey({ kind, choices }) {
  if (choices['axes of the turns'] !== 'space fixed') return kind + JSON.stringify(choices);
  return kind + JSON.stringify({ ...choices, 'axes of the turns': 'body fixed', sequence: [...choices.sequence].reverse().join(''),
    places: choices.places.replace(/[13]/g, (which) => (which === '1' ? '3' : '1')), signs: [...choices.signs].reverse().join('') });
}

// ---- the search ----------------------------------------------------------------------------------------

const fourthPowers = (dcm) => dcm.flat().reduce((sum, entry) => sum + entry ** 4, 0);
const costOf = ({ faults, rarity }) => Math.round((faults + rarity) * 1e6), price = (first, second) => costOf(first) - costOf(second);

function sideOf(poses, declared, table, noise) {
  const cheapest = new Map();
  for (const kind of poses.kinds) {
    // Of an axis and its angle, in either order, only the angle can be large.
    const large = kind !== 'quaternion' && poses.numbers.flat().some((value) => Math.abs(value) > 2 * Math.PI + 0.01);
    for (const reading of readingsOf(kind, declared, large, table)) {
      const key = readingKey(reading), held = cheapest.get(key);
      if (!held || price(reading, held) < 0) cheapest.set(key, reading);
    }
  }
  const side = [...cheapest.values()].sort(price).map((reading) => {
    const dcms = poses.numbers.map((numbers) => dcmFromNumbers(reading, numbers));
    return { reading, dcms, flat: dcms.map((dcm) => dcm.flat()), fourth: dcms.map(fourthPowers), doubt: doubtOf(reading, poses.half), moves: motionOf(dcms) };
  });
  if (!noise) return side;
  // Small angles read as degrees hardly move, and within the noise anything fits them.
  const some = side.filter(({ moves, doubt }) => moves >= MOTION * (doubt + noise));
  // Refuse the input if this would exclude a reading that is not a fault, or one that both sides may share.
  if (!side.some((one) => !some.includes(one) && (one.reading.faults === 0 || (one.reading.kind === 'quaternion' && one.reading.shared.length)))) return some;
  throw new Error(`the tolerance is ${short(noise / DEGREE, 3)} degrees, but the numbers describe a rotation of only ${short(Math.min(...side.map(({ moves }) => moves)) / DEGREE, 3)} degrees, too small to judge. Give larger rotations, or a smaller tolerance`);
}

// Return the largest angle of rotation in some poses, in radians, whatever their handedness.
function motionOf(dcms) {
  const hand = Math.sign(determinant(dcms[0])), across = Math.max(...dcms.map((dcm) => distance(dcm.map((row) => scale(hand, row)), IDENTITY)));
  return 2 * Math.asin(Math.min(1, across / Math.sqrt(8)));
}

const related = (relation, given) => relatedBy(relation, relation.inside ? afterInside(relation.inside, given) : given);
const relatedBy = (relation, dcm) => multiply(relation.left, relation.inverse ? transpose(dcm) : dcm, relation.right);

function gapOf(relation, first, second) {
  let gap = 0;
  for (let pose = 0; pose < first.length; pose += 1) {
    const made = related(relation, first[pose]), wanted = second[pose];
    for (let i = 0; i < 3; i += 1) for (let j = 0; j < 3; j += 1) gap = Math.max(gap, Math.abs(made[i][j] - wanted[i][j]));
  }
  return gap;
}

// The relations of two sides relative to the expected one, and those of each number of faults. They are cached, because
// there are thousands.
const KEPT = onceFor(() => new Map());
function* expectedRelations(mirrored, expected, table) {
  const aside = determinant(axesMatrix(expected.body)) !== determinant(axesMatrix(expected.world));
  const kept = KEPT(table), key = JSON.stringify([mirrored, expected]);
  if (!kept.has(key)) {
    const relations = (yield* relationsOf(mirrored !== aside, table)).map((relation) => beyond(relation, expected));
    kept.set(key, { relations, exactly: [0, 1, 2, 3].map((count) => relations.filter(({ faults }) => faults === count)) });
  }
  return kept.get(key);
}
const isMirrored = (first, second) => (determinant(first[0].dcms[0]) > 0) !== (determinant(second[0].dcms[0]) > 0);

function* chainsOf(first, second, noise, table, expected, special) {
  const mirrored = isMirrored(first, second), { exactly } = yield* expectedRelations(mirrored, expected, table);
  const fits = [], tried = [0, 0, 0, 0], pairs = [[], [], [], []], most = table['most faults'];
  yield;
  for (const one of first) {
    yield;
    one.turned = [];   // filled on demand, since readings with few faults come first
    for (const other of second) {
      // This runs up to a million times, so compute only what decides.
      let faults = one.reading.faults + other.reading.faults;
      if (one.reading.shared.length && other.reading.shared.length) for (const words of one.reading.shared) if (other.reading.shared.includes(words)) faults -= 2;
      faults += unitChanges(one.reading, other.reading) + sequenceChanges(one.reading, other.reading);
      if (faults > most) continue;
      for (let more = 0; more <= most - faults; more += 1) tried[faults + more] += exactly[more].length;
      const tolerance = Math.max(one.doubt + other.doubt, SINGLE_PRECISION) + noise;
      let alike = true;
      for (let pose = 0; alike && pose < one.fourth.length; pose += 1) alike = Math.abs(one.fourth[pose] - other.fourth[pose]) <= 12 * tolerance;
      if (alike) pairs[faults].push([one, other, tolerance]);
    }
  }
  // Angles have a thousand readings, so we drop those with two faults more than the simplest.
  const angles = Math.max(first.length, second.length) > 24;
  let lowest = most;
  for (let level = 0; level <= most && (!angles || (level <= lowest + 1 && fits.length <= MANY)); level += 1) {
    for (const [inReadings, those] of pairs.slice(0, level + 1).entries()) {
      for (const [one, other, tolerance] of those) {
        yield;
        const wanted = other.flat[0], turned = (one.turned[level - inReadings] ??= []);
        exactly[level - inReadings].forEach((relation, k) => {
          const made = (turned[k] ??= related(relation, one.dcms[0]).flat());
          for (let entry = 0; entry < 9; entry += 1) if (!(Math.abs(made[entry] - wanted[entry]) <= tolerance)) return;
          const residual = gapOf(relation, one.dcms, other.dcms);
          if (residual <= tolerance) {
            fits.push({ first: one.reading, second: other.reading, relation, residual, faults: level, rarity: ofBoth(one.reading, other.reading).rarity + relation.rarity });
          }
        });
      }
    }
    if (fits.length) lowest = Math.min(lowest, level);
  }
  if (!mirrored && !(special && fits.length)) yield* insideOf(first, second, noise, table, fits, tried, fits.length ? lowest : most);
  for (const chain of fits) {
    chain.words = wordsOf(chain, table).join('; ');
    yield;
  }
  fits.sort((a, b) => price(a, b) || (a.words < b.words ? -1 : Number(a.words > b.words)));
  return { fits, tried };
}

// ---- internal causes: exchanged angles or quaternions, as in orientation_workbench.mismatch.search ----------

const PERMUTED = ['123', '132', '213', '231', '312', '321'], MISREAD = ['xyzw', 'zwxy'];
const INNER = [...SEQUENCES.flatMap((read) => SEQUENCES.flatMap((built) => PERMUTED.map((places) => ({ inside: ['angles', read, built, places],
  rarity: (['123', '321'].includes(places) ? 0.2 : 0.4) - 0.1 * (built === [...read].reverse().join('') && places === '321')
    + 0.4 * (read[0] === read[2] || built[0] === built[2]) })))), ...MISREAD.map((order) => ({ inside: ['quaternion', 'wxyz', order, ''], rarity: 0.1 }))];

// The same matrix is tried with hundreds of causes.
const nearest = onceFor((given) => nearestDcm(given).dcm), anglesOf = onceFor(() => ({}));

function afterInside([what, read, built, places], given) {
  const dcm = nearest(given);
  if (what === 'quaternion') {
    const parts = quaternionFromDcm(dcm);
    return dcmFromQuaternion(indices(read, built).map((k) => parts[k]));
  }
  const angles = (anglesOf(given)[read] ??= bodyFixedFromDcm(dcm, read));
  return dcmFromBodyFixed([...places].map((place) => angles[place - 1]), built);
}

// The relations that are not mere renamings of axes, and the known ones that are.
const DISTINCT = new WeakMap();
function* distinctOf(table) {
  if (DISTINCT.has(table)) return DISTINCT.get(table);
  const key = (dcm) => dcm.flat().map((entry) => Math.round(entry * 1e6) + 0).join(), [dcm] = SAMPLES;
  const plain = { inverse: false, body: SAME_AXES, world: SAME_AXES };
  const renamed = new Set(), distinct = [];
  for (const relation of (yield* expectedRelations(false, plain, table)).relations) {
    renamed.add(key(related(relation, dcm)));
    yield;
  }
  for (const cause of INNER) {
    const { inside, inside: [what, read, built, places] } = cause, made = key(afterInside(inside, dcm));
    if (made !== key(dcm) && (what === 'quaternion' || (places === '321' && built === [...read].reverse().join('')) || !renamed.has(made))) distinct.push(cause);
    yield;
  }
  DISTINCT.set(table, distinct);
  return distinct;
}

function* insideOf(first, second, noise, table, fits, tried, most) {
  const plain = { body: SAME_AXES, world: SAME_AXES, hand: false, left: IDENTITY, right: IDENTITY };
  for (const one of first.filter(({ reading }) => ['matrix', 'quaternion'].includes(reading.kind))) {
    const others = second.filter(({ reading }) => ['matrix', 'quaternion'].includes(reading.kind)
      && ofBoth(one.reading, reading).faults <= 1 && one.reading.rarity + reading.rarity === 0);
    const causes = others.length ? yield* distinctOf(table) : [], made = [];
    for (const { inside } of causes) {
      made.push(one.dcms.map((dcm) => afterInside(inside, dcm)));
      yield;
    }
    for (const other of others) {
      const both = ofBoth(one.reading, other.reading), tolerance = LOOSER * (Math.max(one.doubt + other.doubt, SINGLE_PRECISION) + noise);
      for (const inverse of [false, true]) {
        tried[both.faults + 1 + inverse] += INNER.length;
        yield;
        made.forEach((dcms, k) => {
          const relation = { ...plain, inverse };
          const residual = gapOf({ ...relation }, dcms, other.dcms);
          if (residual > tolerance || both.faults + 1 + inverse > most || gapOf(relation, dcms, one.dcms) <= tolerance) return;
          const { inside, rarity } = causes[k];
          // If one side gives a quaternion, the fault is in reading that side rather than inside.
          if (inside[0] === 'quaternion' && !(one.reading.kind === 'matrix' && other.reading.kind === 'matrix')) return;
          fits.push({ first: one.reading, second: other.reading, relation: { ...relation, inside }, residual, faults: both.faults + 1 + inverse, rarity: both.rarity + rarity });
        });
      }
    }
  }
}

// Yield the cheapest chain for each order, scalar first or last, of the best one's quaternions.
function* withOrders(best, first, second, noise, table, expected) {
  const { relations } = yield* expectedRelations(isMirrored(first, second), expected, table), cheapest = [];
  const usual = (side, reading) => side.filter((one) => one.reading === reading || (reading.kind === 'quaternion' && one.reading.choices.order in ORDERS));
  for (const one of usual(first, best.first)) for (const other of usual(second, best.second)) {
    yield;
    const tolerance = Math.max(one.doubt + other.doubt, SINGLE_PRECISION) + noise, both = ofBoth(one.reading, other.reading);
    cheapest.push(...relations.map((relation) => ({ first: one.reading, second: other.reading, relation, residual: gapOf(relation, one.dcms, other.dcms),
      faults: both.faults + relation.faults, rarity: both.rarity + relation.rarity })).filter(({ residual }) => residual <= tolerance).sort(price).slice(0, 1));
  }
  return cheapest;
}

// Find a constant rotation on the body's side, the world's, or both: three poses determine one, four determine two.
function mountingsOf(first, second, noise, table) {
  if (first[0].dcms.length < 3 || determinant(first[0].dcms[0]) < 0 || determinant(second[0].dcms[0]) < 0) return [];
  const found = [];
  for (const one of first) {
    for (const other of second) {
      const both = ofBoth(one.reading, other.reading);
      for (const inverse of [false, true]) {
        const faults = both.faults + inverse;
        if (faults >= table['most faults']) continue;
        const start = inverse ? one.dcms.map(transpose) : one.dcms, end = other.dcms;
        const tolerance = 3 * (Math.max(one.doubt + other.doubt, SINGLE_PRECISION) + noise);
        for (const [body, world] of constantTurns(start, end)) {
          const relation = { inverse, hand: false, body: SAME_AXES, world: SAME_AXES, 'body turn': body, 'world turn': world,
            left: body ?? axesMatrix(SAME_AXES), right: world ?? axesMatrix(SAME_AXES) };
          const residual = gapOf({ ...relation, inverse: false }, start, end), total = faults + (body !== null) + (world !== null);
          if (residual <= tolerance && total <= table['most faults']) {
            found.push({ first: one.reading, second: other.reading, relation, residual, faults: total, rarity: both.rarity });
            break;
          }
        }
      }
    }
  }
  return found.sort(price);
}

function constantTurns(start, end) {
  const turns = [[multiply(end[0], transpose(start[0])), null], [null, multiply(transpose(start[0]), end[0])]];
  if (start.length < 4) return turns;
  const moved = [start, end].map((dcms) => dcms.slice(1).map((dcm) => {
    const [axis, angle] = axisAngleFromDcm(nearestDcm(multiply(dcm, transpose(dcms[0]))).dcm);
    return scale(angle, axis);
  }));
  const most = (values) => values.indexOf(Math.max(...values));
  const largest = most(moved[0].map(length)), apart = moved[0].map((vector) => length(cross(vector, moved[0][largest]))), second = most(apart);
  if (apart[second] < 1e-3 || length(cross(moved[1][largest], moved[1][second])) < 1e-6) return turns;
  const triad = ([one, other]) => {
    const normal = unit(cross(one, other));
    return [unit(one), normal, cross(unit(one), normal)];
  };
  const [before, after] = moved.map((vectors) => triad([vectors[largest], vectors[second]]));
  const body = multiply(transpose(after), before);
  return [...turns, [body, multiply(transpose(multiply(body, start[0])), end[0])]];
}

// ---- equivalent chains, and the pose that decides ----------------------------------------------------------

// Two generic orientations, other than those in Python.
const SAMPLES = [[0.47, -0.63, 0.29, 0.55], [-0.21, 0.38, 0.74, -0.51]].map((parts) => dcmFromQuaternion(unit(parts)));

function plainReading(kind, table) {
  const choices = { ...table.book, sequence: 'zyx' };
  return { kind, choices: Object.fromEntries(table.kinds[kind].map(({ group }) => [group, choices[group]])) };
}

function samplesOf(kind, poses, table) {
  const plain = plainReading(kind, table), hand = kind === 'matrix' && determinant(rowsOfNine(poses.numbers[0])) < 0 ? -1 : 1;
  if (poses.large && plain.choices.unit) plain.choices.unit = 'degrees';
  return SAMPLES.map((dcm) => numbersFromDcm(plain, dcm.map((row) => scale(hand, row)))[0]);
}

// Return, as keys, what a chain predicts for the second side from these numbers. Two chains that share a key are
// mathematically the same: an orientation has two triples of Euler angles, and a program may print either.
function predictionsOf(chains, samples, decimals, table) {
  const dcms = new Map(), factor = 10 ** decimals;
  return chains.map((chain) => {
    if (!dcms.has(chain.first)) dcms.set(chain.first, samples[chain.first.kind].map((numbers) => dcmFromNumbers(chain.first, numbers)));
    const plain = plainReading(chain.second.kind, table);
    const eachSample = dcms.get(chain.first).map((dcm) => [...new Set(numbersFromDcm(chain.second, related(chain.relation, dcm))
      .map((numbers) => dcmFromNumbers(plain, numbers).flat().map((entry) => Math.round(entry * factor) + 0).join()))]);
    return eachSample.reduce((keys, own) => keys.flatMap((key) => own.map((sample) => `${key};${sample}`)), [`${chain.first.kind};${chain.second.kind}`]);
  });
}

// Group chains that are equivalent for all numbers.
function classesOf(chains, poses, table) {
  const classes = [], owner = new Map(), samples = Object.fromEntries(poses.kinds.map((kind) => [kind, samplesOf(kind, poses, table)]));
  predictionsOf(chains, samples, 5, table).forEach((keys, k) => {
    let members = owner.get(keys.find((key) => owner.has(key)));
    if (!members) classes.push(members = []);
    members.push(chains[k]);
    for (const key of keys) if (!owner.has(key)) owner.set(key, members);
  });
  return classes;
}

function turnedNumbers(reading, numbers, turns) {
  const hand = determinant(dcmFromNumbers(reading, numbers)) > 0 ? 1 : -1;
  let { dcm } = nearestDcm(dcmFromNumbers(reading, numbers).map((row) => scale(hand, row)));
  for (const [axis, angle] of turns) dcm = multiply(dcmFromAxisAngle(AXES.map((name) => Number(name === axis)), angle * DEGREE), dcm);
  return numbersFromDcm(reading, dcm.map((row) => scale(hand, row)))[0];
}

function* furtherPose(chains, readings, poses, special, table) {
  const further = table['further poses'], last = further.at(-1)[0];
  // Starting from a special pose, a rotation or two leave zeros in one side's numbers.
  if (special || chains.length > LOOKED_AT || readings.length > READ_AS || chains.length === 1) return last;
  for (const [words, turns] of further) {
    let decides = true;
    for (const reading of readings) {
      yield;
      const own = chains.filter(({ first }) => first.kind === reading.kind);
      const keys = predictionsOf(own, { [reading.kind]: [turnedNumbers(reading, poses.numbers.at(-1), turns)] }, 2, table).flat();
      if (!(decides = new Set(keys).size === keys.length)) break;
    }
    if (decides) return words;
  }
  return last;
}

// ---- the answer ----------------------------------------------------------------------------------------

// Return the faults; if the second side gives the inverse of what is meant (swapped), body and world change places.
function relationWords({ first, second, relation: whole }, swapped, table, inverse = (whole.said ?? whole).inverse) {
  const relation = whole.said ?? whole, said = inverse ? [table.inverse[(first.kind === 'matrix') === (second.kind === 'matrix') ? second.kind : 'one matrix']] : [];
  if (whole.inside) return [insideWords(whole.inside), ...said];
  for (const whose of ['body', 'world']) {
    if (relation[`${whose} turn`]) said.push(`a constant rotation on the ${whose}'s side, as if an instrument were mounted askew`);
  }
  if (relation.hand) return [...said, `opposite handedness: ${/-(.)/.exec(relation.body)[1]} is reversed in the world and on the body`];
  return [...said, ...namedAxes(relation, swapped, table).map(({ words }) => words).filter(Boolean)];
}

// Reversing all signs of both does the same: prefer known axes, then right-handed ones.
function namedAxes(relation, swapped, table) {
  const axes = swapped ? [relation.world, relation.body] : [relation.body, relation.world];
  const options = [axes, axes.map(opposite)].map((pair) => ({ named: pair.map((names, k) => axesChoice(names, k === 0, table)), left: determinant(axesMatrix(pair[0])) < 0 }));
  const [one, other] = options.map(({ named, left }) => [costOf({ faults: named[0].faults + named[1].faults, rarity: named[0].rarity + named[1].rarity }), left]);
  return options[Number(other[0] < one[0] || (other[0] === one[0] && one[1] && !other[1]))].named;
}

function insideWords([what, read, built, places]) {
  if (what === 'quaternion') return `an intermediate quaternion was stored as ${[...read].join(', ')} and read as ${[...built].join(', ')}, or vice versa`;
  const put = places === '321' ? `${[...built].reverse().join('-')} (space fixed)` : `${[...built].join('-')} (body fixed)${places === '123' ? '' : `, taking them in the order ${[...places].join(', ')}`}`;
  return `intermediate angles were computed as ${[...read].join('-')} (body fixed) and combined as ${put}`;
}

// Return all possible answers to whether the second side's numbers are inverted.
function secondIsInverse({ first, second, relation: { inverse } }, ways) {
  const [one, other] = [first, second].map(({ kind }, k) => ways[k] ?? (kind === 'matrix' ? null : false));
  if (one === null && other === null) return [inverse, !inverse];
  if (one === null || other === null || (one !== other) === inverse) return [other === null ? one !== inverse : other];
  if (ways.includes(null) && ways.some((way) => way !== null)) return [ways[1] === null ? ways[0] !== inverse : ways[1]];
  return [!other, other];
}

export const wordsOf = (chain, table, ways = [null, null], which = 0) => [...ofBoth(chain.first, chain.second).words,
  ...relationWords(chain, secondIsInverse(chain, ways)[which], table)];

const ORDERS = { wxyz: 'first', xyzw: 'last' };
const limitOf = (chain, best) => {
  if (orderShared(chain) !== orderShared(best)) return DEARER_ON_ONE_SIDE;
  return !orderShared(best) && best.first.kind === 'quaternion' && best.second.kind === 'quaternion' ? DEARER_CROSSED : DEARER;
};
const orderShared = ({ first, second }) => first.choices.order === second.choices.order;
const dearness = (chain) => costOf(chain) / 1e6 - (chain.relation.inverse && (chain.first.kind === 'matrix') !== (chain.second.kind === 'matrix'));

// Return both sides' choices in a group if they differ.
const bothOf = ({ first, second }, group) => {
  const chosen = [first, second].map(({ choices }) => choices[group]);
  return chosen.every(Boolean) && chosen[0] !== chosen[1] ? chosen : [];
};
// Return the group and both choices that only a reader can decide for two triples of Euler angles, or nothing.
const ofAngles = (chain, known) => {
  const group = (known.some(({ sequence }) => sequence) ? [TURNS] : ['sequence', TURNS]).find((name) => bothOf(chain, name).length);
  return [group, group ? bothOf(chain, group) : []];
};

// Return descriptions of one relation that differ in axes or rotations, if any, and the question that decides.
function namesOf(best, others, known, ways, table) {
  const names = [], seen = new Set(), [group] = ofAngles(best, known);
  const usual = others.filter((chain) => [chain.first, chain.second].every(({ choices: { order } }, k) => !order || (known[k].order ? order === known[k].order : order in ORDERS))
    && dearness(chain) <= dearness(best) + limitOf(chain, best) + 1e-6 && ofAngles(chain, known)[0] === group);
  for (const chain of [best, ...usual]) {
    const swaps = secondIsInverse(chain, ways);
    swaps.forEach((swapped, which) => {
      const [, chosen] = ofAngles(chain, known), meant = [...relationWords(chain, swapped, table, false), ...chosen].join('; ');
      if (seen.has(meant)) return;
      seen.add(meant);
      const inverses = [swapped !== chain.relation.inverse, swapped], declare = [{}, {}], conditions = [];
      const orders = [chain.first, chain.second].map(({ choices }) => choices.order);
      orders.forEach((order, k) => { if (order) declare[k].order = order; });
      if (orders.some(Boolean)) {
        const each = orders.map((order, k) => order && `${ORDERS[order] ?? order} in the ${['first', 'second'][k]}`).filter(Boolean).join(' and ');
        conditions.push(`the scalar part comes ${orders[0] === orders[1] ? `${ORDERS[orders[0]]} in both` : each}`);
      }
      const matrix = [chain.first.kind, chain.second.kind].includes('matrix');
      if (swaps.length > 1) {
        [chain.first, chain.second].forEach(({ kind }, k) => { declare[k].way = (kind === 'matrix' ? ['rows', 'columns'] : ['body in world', 'world in body'])[Number(inverses[k])]; });
        conditions.push(matrix ? `the body's axes are the ${inverses[0] ? 'columns' : 'rows'} of the first matrix`
          : `the ${inverses[0] ? 'first' : 'second'} side gives the world as seen from the body`);
      }
      chosen.forEach((value, k) => { declare[k][group] = value; });
      const [one, other] = chosen.map((value) => (group === TURNS ? value : [...value].join('-')));
      if (group === TURNS) conditions.push(`the first side's angles are ${one} and the second's ${other}`);
      else if (group) conditions.push(`the first side's sequence is ${one}`);
      names.push({ condition: conditions.join(' and '), declare,
        faults: group === 'sequence' ? [`the second side's sequence is ${other}`] : wordsOf(chain, table, ways, which) });
    });
  }
  if (names.length < 2) return { names: [], question: '' };
  const differ = (what) => new Set(names.map(({ declare }) => declare[0][what])).size > 1, asked = [];
  if (names.some(({ faults }) => faults[0].includes('intermediate'))) asked.push('Which did one program pass to the other, angles or a quaternion?');
  if (differ('order')) asked.push('Does the scalar part of the quaternions come first or last?');
  if (differ('way')) {
    asked.push([best.first.kind, best.second.kind].includes('matrix') ? 'Are the body\'s axes the rows or the columns of the first matrix?'
      : 'Which side gives the inverse, the world as seen from the body?');
  }
  if (differ(TURNS)) asked.push('Which side\'s rotations are about axes of the body (body fixed), and which side\'s about axes that stay fixed (space fixed)?');
  if (differ('sequence')) asked.push('Which sequence of rotations does the first program use? The numbers stay the same if the axes of both programs are renamed in the same way.');
  return { names, question: asked.join(' ') };
}

// Estimate how many chains of so few faults would fit unrelated poses by chance.
function chanceOf(best, first, tried) {
  const { dcms } = first.find(({ reading }) => reading === best.first), gap = Math.max(best.residual, SINGLE_PRECISION, Math.min(...first.map(({ doubt }) => doubt)));
  return dcms.reduce((share, dcm) => {
    const angle = Math.max(motionOf([dcm]), 1e-9);
    return share * Math.min(1, (1.5 * gap) ** 3 / 6 / (angle - Math.sin(angle) || 1e-27));
  }, tried.slice(0, best.faults + 1).reduce((sum, count) => sum + count, 0));
}

// Check whether all poses share a property that leaves several readings open: an angle or a component that is zero, or
// two that are equal.
function isSpecial({ numbers, half }) {
  const near = 2 * half + SINGLE_PRECISION, count = numbers[0].length, sizes = numbers.map((pose) => pose.map(Math.abs));
  if (sizes[0].some((_, k) => sizes.every((pose) => pose[k] <= near))) return true;
  const pairs = count === 9 ? [[1, 3], [2, 6], [5, 7]] : sizes[0].flatMap((_, i) => sizes[0].slice(i + 1).map((__, k) => [i, i + 1 + k]));
  return pairs.some(([i, j]) => sizes.every((pose) => Math.abs(pose[i] - pose[j]) <= near));
}

export function explain(...given) {
  const steps = explaining(...given);
  let step = steps.next();
  while (!step.done) step = steps.next();
  return step.value;
}

// Yield in steps of a few milliseconds, and return what orientation_workbench.explain does, with the poses as read.
export function* explaining(first, second, table, { firstDeclared = {}, secondDeclared = {}, firstProgram = '', secondProgram = '', noise = 0 } = {}) {
  const given = [[first, 'first', firstDeclared], [second, 'second', secondDeclared]];
  const programs = [firstProgram, secondProgram].map((program) => table.programs[program]), asTheirManualsSay = programs.every(Boolean);
  const sides = given.map(([text, name, declared], k) => {
    const poses = readPoses(text, name, table, declared.kind ?? null, noise);
    return programs[k] && !declared.kind && poses.kinds.length === 2 ? { ...poses, kinds: [programs[k]['three numbers']] } : poses;
  });
  yield;
  const counts = sides.map(({ numbers }) => numbers.length);
  if (Math.min(...counts) === 1 && Math.max(...counts) === 3) {   // three rows that are not a matrix were read as triples
    const which = counts.indexOf(3);
    sides[which] = readPoses(given[which][0], given[which][1], table, 'matrix', noise);
    counts[which] = 1;
  }
  if (counts[0] !== counts[1]) {
    throw new Error(`the first side has ${several(counts[0], 'poses')} and the second ${counts[1]}: give the same poses on both sides, in the same order`);
  }
  // The text overrides the manual, and the reader overrides both.
  const declared = sides.map((poses, k) => ({ ...programs[k]?.declared, ...poses.declared, ...given[k][2] }));
  const [one, other] = sides.map((poses, k) => sideOf(poses, declared[k], table, noise));
  yield;
  const kinds = sides.map((side) => side.kinds[0]), expected = expectedRelation(programs, kinds, table);
  const ways = kinds.map((kind, k) => table.ways[given[k][2].way] ?? (programs[k] ? programs[k].inverse.includes(kind) : null));
  const special = sides.some(isSpecial), { fits, tried } = yield* chainsOf(one, other, noise, table, expected, special);
  yield;
  let together = classesOf(fits, sides[0], table);
  yield;
  if (!together.length) together = mountingsOf(one, other, noise, table).slice(0, 1).map((chain) => [chain]);
  const limit = Math.max(1e-3, EXACT * Math.min(...together.map(([{ residual }]) => residual)));
  const chains = [false, true].flatMap((far) => together.map(([chain]) => chain).filter(({ residual }) => (residual > limit) === far));
  const hands = [one, other].map((side) => determinant(side[0].dcms[0]) > 0);
  const mirrored = hands[0] === hands[1] ? '' : ['first', 'second'][hands.indexOf(false)];
  if (!chains.length) return { verdict: 'unrelated', mirrored, asTheirManualsSay, faults: [], residual: null, chains, furtherPose: '', poses: counts[0], sides };
  yield;
  const [best] = chains, chance = chanceOf(best, one, tried);
  let verdict = chains.length > 1 || special || chance >= BY_CHANCE ? 'undecided' : 'named', asked = { names: [], question: '' };
  // For a special pose, some sequence nearly always gives the same numbers.
  if (best.faults === 0 && (noise === 0 || chance < BY_CHANCE) && !(special && wordsOf(best, table, ways).length)) verdict = 'same';
  if (verdict === 'named') asked = namesOf(best, [...yield* withOrders(best, one, other, noise, table, expected), ...together[0]], declared, ways, table);
  if (asked.names.length) verdict = 'undecided';
  yield;
  const remarks = sides.flatMap(({ kinds: [kind], numbers, half }, k) => {
    const worst = numbers.map(length).reduce((held, size) => (Math.abs(size - 1) > Math.abs(held - 1) ? size : held), 1);
    return kind === 'quaternion' && Math.abs(worst - 1) > SLACK + 2 * half ? [`A quaternion on the ${['first', 'second'][k]} side has length ${short(worst)}, not 1. We normalised it.`] : [];
  });
  return { ...asked, remarks, asTheirManualsSay, mirrored, verdict, ways, faults: wordsOf(best, table, ways), chains, sides, poses: counts[0],
    residual: 2 * Math.asin(Math.min(1, best.residual / 2)) / DEGREE,
    furtherPose: !(verdict === 'undecided' || (verdict === 'same' && chains.length > 1)) || asked.names.length ? '' : yield* furtherPose(chains, [...new Set(fits.map((chain) => chain.first))], sides[0], special, table) };
}

// Return the orientations to draw, those of both sides at one pose by the simplest chain.
export function drawnDcms(explanation, table, pose) {
  return explanation.sides.map((poses, k) => {
    const chain = explanation.chains[0], reading = chain ? chain[k ? 'second' : 'first'] : plainReading(poses.kinds[0], table);
    return dcmFromNumbers(reading, poses.numbers[pose]);
  });
}

// For each fault of a chain, return the section that teaches it and the questions on it, each as [address, title].
export function taughtBy(chain, table, ways) {
  const { first, second, relation: whole } = chain;
  const links = [], relation = whole.said ?? whole;
  for (const { kind, words, shared } of [first, second]) {
    const other = kind === first.kind && words === first.words ? second : first;
    for (const said of words.filter((one) => !(shared.includes(one) && other.shared.includes(one)))) {
      const own = table.kinds[kind].find(({ choices }) => choices.some((option) => option.words === said));
      links.push(table.taught[own?.group] ?? null);
    }
  }
  if (whole.inside) links.push(table.taught[whole.inside[0] === 'angles' ? 'axes of the turns' : 'order']);
  if (relation.inverse) links.push(table.taught[`inverse ${second.kind}`]);
  for (const whose of ['body', 'world']) if (relation[`${whose} turn`]) links.push(table.taught.turn);
  if (relation.hand) return [...links, table.taught.hand];
  return [...links, ...namedAxes(relation, secondIsInverse(chain, ways)[0], table).map(({ words }, k) => words && table.taught[k ? 'world' : 'body']).filter(Boolean)];
}

// ---- the line that fixes it, as in orientation_workbench.mismatch.mend -------------------------------------

const rowsInPython = (rows) => `[${rows.map((row) => `[${row.join(', ')}]`).join(', ')}]`;
const inPython = (names) => `np.array(${rowsInPython(axesMatrix(names))})`;
const turnInPython = (dcm) => `np.array(${rowsInPython(dcm.map((row) => row.map((entry) => {
  const rounded = Number(entry.toFixed(6)) + 0;
  return Number.isInteger(rounded) ? `${rounded}.0` : String(rounded);
})))})`;
const sorted = (places) => places.every((place, k) => k === 0 || places[k - 1] <= place);
const pick = (name, places) => (sorted(places) ? name : `${name}[[${places.join(', ')}]]`);
const signed = (choices, name) => (choices.signs === '+++' ? name : `(${name} * np.array([${[...choices.signs].map((sign) => `${sign}1`.replace('+', '')).join(', ')}]))`);
const letters = (choices) => (choices['axes of the turns'] === 'space fixed' ? choices.sequence : choices.sequence.toUpperCase());
const inDegrees = (choices) => (choices.unit === 'degrees' ? ', degrees=True' : '');
const indices = (order, wanted) => [...wanted].map((part) => order.indexOf(part));

function readInPython({ kind, choices }, name) {
  if (kind === 'matrix') return name;
  if (kind === 'quaternion') return `Rotation.from_quat(${pick(name, indices(choices.order, 'xyzw'))}).as_matrix().T`;
  if (kind === 'Euler angles') {
    return `Rotation.from_euler('${letters(choices)}', ${signed(choices, pick(name, indices(choices.places, '123')))}${inDegrees(choices)}).as_matrix().T`;
  }
  if (kind === 'rotation vector') return `Rotation.from_rotvec(${name}${inDegrees(choices)}).as_matrix().T`;
  const vector = choices['place of the angle'] === 'last' ? `${name}[3] * ${name}[:3]` : `${name}[0] * ${name}[1:]`;
  return `Rotation.from_rotvec(${vector}${inDegrees(choices)}).as_matrix().T`;
}

function writeInPython({ kind, choices }, matrix) {
  if (kind === 'matrix') return matrix;
  const there = matrix.endsWith('.T') && !matrix.includes('@') ? matrix.slice(0, -2) : matrix.includes('@') ? `(${matrix}).T` : `${matrix}.T`;
  if (kind === 'quaternion') return pick(`Rotation.from_matrix(${there}).as_quat()`, indices('xyzw', choices.order));
  if (kind === 'Euler angles') return pick(signed(choices, `Rotation.from_matrix(${there}).as_euler('${letters(choices)}'${inDegrees(choices)})`), [...choices.places].map((which) => which - 1));
  const whole = `Rotation.from_matrix(${there}).as_rotvec(${inDegrees(choices).slice(2)})`;
  if (kind === 'rotation vector') return whole;
  return choices['place of the angle'] === 'first' ? `np.concatenate([[np.linalg.norm((v := ${whole}))], v / np.linalg.norm(v)])`
    : `np.concatenate([(v := ${whole}) / np.linalg.norm(v), [np.linalg.norm(v)]])`;
}

export function mendingLine({ first, second, relation }) {
  const plain = relation.body === SAME_AXES && relation.world === SAME_AXES && !('body turn' in relation);
  if (plain && first.kind === 'quaternion' && second.kind === 'quaternion') {
    const line = pick('second', indices(second.choices.order, first.choices.order));
    return relation.inverse ? `${line} * np.array([${[...first.choices.order].map((part) => (part === 'w' ? 1 : -1)).join(', ')}])` : line;
  }
  let matrix = readInPython(second, 'second');
  if (relation['body turn']) matrix = `${turnInPython(transpose(relation['body turn']))} @ ${matrix}`;
  if (relation['world turn']) matrix = `${matrix} @ ${turnInPython(transpose(relation['world turn']))}`;
  if (relation.body !== SAME_AXES) matrix = `${inPython(relation.body)}.T @ ${matrix}`;
  if (relation.world !== SAME_AXES) matrix = `${matrix} @ ${inPython(relation.world)}`;
  if (relation.inverse) matrix = matrix.includes('@') ? `(${matrix}).T` : `${matrix}.T`;
  return writeInPython(first, matrix.replace(/\.T\.T$/, ''));
}

// ---- the same as a formula -----------------------------------------------------------

const written = (rows) => `[${rows.map((row) => `[${row.map((entry) => String(Number(entry.toFixed(4)) + 0)).join(', ')}]`).join(', ')}]`;

// Return a formula for the second program's matrix in terms of the first's.
export function formulaOf({ relation }) {
  const left = relation['body turn'] ?? (relation.body === SAME_AXES ? null : axesMatrix(relation.body));
  const right = relation['world turn'] ?? (relation.world === SAME_AXES ? null : transpose(axesMatrix(relation.world)));
  return ['M2 =', left && written(left), relation.inverse ? 'M1^T' : 'M1', right && written(right)].filter(Boolean).join(' ');
}
