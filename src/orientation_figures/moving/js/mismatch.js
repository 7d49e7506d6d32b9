// The search of orientation_workbench.mismatch in the language of the page: what two programs mean differently by the
// numbers that they give for the same poses. Readings, relations, costs and words are that package's one table, which
// comes with the figure; here are the reader of text and the loops, held to the same cases by
// tests/test_mismatch_in_the_page.py.
import { AXES, axisAngleFromDcm, bodyFixedFromDcm, cross, dcmFromAxisAngle, dcmFromBodyFixed, dcmFromQuaternion, determinant,
  dot, length, multiply, nearestDcm, quaternionFromDcm, scale, times, transpose, unit } from './mathematics.js';

const SINGLE_PRECISION = 2e-6, BY_CHANCE = 1e-3, LOOKED_AT = 300, SLACK = 1e-4;
const COUNT = { matrix: 9, quaternion: 4, 'Euler angles': 3, 'rotation vector': 3, 'axis and angle': 4 };
const WIDTHS = [3, 4, 7, 8, 9, 12, 16];
const SAME_AXES = 'x y z', DEGREE = Math.PI / 180;

// ---- what is pasted ------------------------------------------------------------------------------------

const NUMBERS = /(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?=[fFlL]?(?![\w.]))/g;
const KEYS = /["']?([A-Za-z_]\w*)["']?\s*[:=]\s*(?=[-+.\d])/g;
const LEFT_OUT = /["']?\b(position|translation|header|stamp|location|covariance)\b["']?\s*[:=]\s*(\{[^}]*\}|\[[^\]]*\])?/gi;
const DECLARATION = /^[^=\n]*\w\s*(\[\d*\]\s*)+=/gm;
const NO_NUMBER = /(?<![A-Za-z])[-+]?(nan|inf(?:inity)?)(?![A-Za-z])/i;
const PLACE_OF_ANGLE = { yaw: 0, heading: 0, psi: 0, pitch: 1, theta: 1, roll: 2, bank: 2, phi: 2 };

// The poses in a text: what kinds they may be of, their numbers, half a unit of the last digit; an Error tells what
// was read and what is missing.
export function readPoses(given, name, kind = null, noise = 0) {
  const { rows, half, declared } = rowsOf(given, name);
  const numbers = posesOf(rows, name, kind);
  if (numbers.some((pose) => pose.some((value) => !Number.isFinite(value)))) throw new Error(`the ${name} side holds a number that is not finite`);
  const kinds = kindsOf(numbers, kind, half + noise, name);
  return { kinds, numbers, half, declared, large: numbers.flat().some((value) => Math.abs(value) > 2 * Math.PI + 0.01) };
}

function rowsOf(given, name) {
  let text = given.replace(/[\u2212\u2013]/g, '-').replace(/(#|\/\/|%).*/g, '');
  text = withoutPlaces(text.replace(DECLARATION, ' '));
  const wrong = NO_NUMBER.exec(text);
  if (wrong) throw new Error(`the ${name} side holds '${wrong[0].trim()}', which is no number`);
  const found = text.match(NUMBERS);
  if (!found) {
    const start = text.trim().slice(0, 40);
    throw new Error(start ? `the ${name} side holds no numbers: '${start}'` : `the ${name} side is empty: paste its numbers`);
  }
  const declared = /\u00b0|\bdeg(rees)?\b/i.test(text) ? { unit: 'degrees' } : {};
  const half = halfUnit(found), named = labelled(text);
  if (named) return { rows: named.rows, half, declared: { ...declared, ...named.more } };
  const rows = [];
  for (const line of text.split(/[\n;]/)) {
    for (const piece of line.split(/\]\s*,?\s*\[|\)\s*,?\s*\(|\}\s*,?\s*\{/)) {
      const row = piece.match(NUMBERS);
      if (row) rows.push(row.map(Number));
    }
  }
  return { rows, half, declared };
}

function withoutPlaces(text) {
  const kept = [];
  let below = null;
  for (const line of text.split('\n')) {
    const inset = line.length - line.trimStart().length;
    if (below !== null && line.trim() && inset > below) continue;
    const found = [...line.matchAll(LEFT_OUT)][0];
    below = found && !line.slice(found.index + found[0].length).trim() ? inset : null;
    kept.push(line.replace(LEFT_OUT, ' '));
  }
  return kept.join('\n');
}

function labelled(text) {
  const pairs = [];
  for (const match of text.matchAll(KEYS)) {
    const behind = new RegExp(NUMBERS.source, 'y');
    behind.lastIndex = match.index + match[0].length;
    const number = behind.exec(text);
    if (number) pairs.push([match[1].toLowerCase().replace(/^q/, '').replace(/^_+/, ''), Number(number[0])]);
  }
  const hasScalar = pairs.some(([key]) => key === 'w');
  for (const [size, placeOf, more] of [[4, (key) => 'wxyz'.indexOf(key), {}], [3, (key) => PLACE_OF_ANGLE[key] ?? -1, { sequence: 'zyx' }],
    [3, (key) => 'xyz'.indexOf(key), {}]]) {
    const own = pairs.map(([key, value]) => [key.length === 1 || more.sequence ? placeOf(key) : -1, value]).filter(([place]) => place >= 0);
    if (!own.length || own.length % size || (size === 3 && !more.sequence && hasScalar)) continue;
    const rows = [];
    for (let start = 0; start < own.length; start += size) {
      const row = Array(size).fill(null);
      for (const [place, value] of own.slice(start, start + size)) row[place] = value;
      rows.push(row);
    }
    if (!rows.flat().includes(null)) return { rows, more };
  }
  return null;
}

function halfUnit(found) {
  const sizes = found.map((number) => Math.abs(Number(number))), largest = Math.max(...sizes);
  let decimals = 0;
  found.forEach((number, k) => {
    const [mantissa, power] = number.toLowerCase().split('e');
    if (sizes[k] >= 0.1 * largest) decimals = Math.max(decimals, (mantissa.split('.')[1] ?? '').length - Number(power ?? 0));
  });
  return decimals > 0 ? 0.5 * 10 ** -decimals : 0;
}

const blocks = (list, size) => Array.from({ length: list.length / size }, (_, k) => list.slice(k * size, (k + 1) * size));
const rowsOfNine = (numbers) => [0, 3, 6].map((k) => numbers.slice(k, k + 3));
// For each pair of rows how far their product is from that of a matrix with rows of length 1 at right angles.
const gapsOf = (dcm) => dcm.map((row, i) => dcm.map((other, j) => Math.abs(dot(row, other) - (i === j ? 1 : 0))));
const orthogonal = (rows) => blocks(rows, 3).every((dcm) => gapsOf(dcm).flat().every((gap) => gap < 0.1));

function posesOf(rows, name, kind) {
  const width = rows.every((row) => row.length === rows[0].length) ? rows[0].length : 0, flat = rows.flat();
  const free = kind === null || kind === 'matrix';
  if (width === 3 && free && rows.length % 3 === 0 && (kind || orthogonal(rows))) return blocks(flat, 9);
  if (width === 4 && free) {
    if (rows.length % 4 === 0 && rows.every((row, k) => k % 4 < 3 || String(row) === '0,0,0,1')) {
      return blocks(rows, 4).map((matrix) => matrix.slice(0, 3).flatMap((row) => row.slice(0, 3)));
    }
    const turns = rows.map((row) => row.slice(0, 3));
    if (rows.length % 3 === 0 && orthogonal(turns)) return blocks(turns, 3).map((matrix) => matrix.flat());
  }
  if (WIDTHS.includes(width) && !(width < 5 && kind === 'matrix')) return rows.map((row) => onePose(row, name));
  if (WIDTHS.includes(flat.length)) return [onePose(flat, name)];
  for (const size of [9, 16]) if (flat.length % size === 0) return blocks(flat, size).map((row) => onePose(row, name));
  const where = rows.length === 1 ? 'one line' : `${rows.length} lines`;
  throw new Error(`the ${name} side holds ${flat.length} number${flat.length === 1 ? '' : 's'} in ${where}: a pose takes 3 (angles, or a rotation `
    + 'vector), 4 (a quaternion, or an axis and its angle), 9 (a matrix) or 16 (a matrix with a translation)');
}

function onePose(row, name) {
  if ([3, 4, 9].includes(row.length)) return row;
  if (row.length === 16) return [0, 4, 8].flatMap((k) => row.slice(k, k + 3));
  if (row.length === 12) return [0, 4, 8].flatMap((k) => row.slice(k, k + 3));
  for (const part of [row.slice(-4), row.slice(0, 4)]) if (Math.abs(length(part) - 1) < 0.01) return part;
  throw new Error(`the ${name} side holds ${row.length} numbers in a row, as of a place and a quaternion, but no four of them that `
    + `stand together make length 1: the last four make ${short(length(row.slice(-4)), 4)}`);
}

const short = (value, digits = 6) => String(Number(value.toPrecision(digits)));
const isUnit = (vectors, doubt) => vectors.every((vector) => Math.abs(length(vector) - 1) <= 2 * doubt + SLACK);

function kindsOf(numbers, kind, doubt, name) {
  const count = numbers[0].length;
  if (kind !== null && COUNT[kind] !== count) throw new Error(`the ${name} side holds ${count} numbers a pose; a ${kind} takes ${COUNT[kind]}`);
  let kinds = kind === null ? null : [kind];
  if (!kinds) {
    if (count === 9) kinds = ['matrix'];
    else if (count === 3) kinds = ['Euler angles', 'rotation vector'];
    else kinds = isUnit(numbers, doubt) ? ['quaternion'] : ['axis and angle'];
  }
  if (kinds[0] === 'matrix') demandOrthogonal(numbers, doubt, name);
  if (kinds[0] === 'quaternion' && !isUnit(numbers, Math.max(doubt, 0.01))) {
    const worst = numbers.map(length).reduce((one, other) => (Math.abs(other - 1) > Math.abs(one - 1) ? other : one));
    throw new Error(`a quaternion of the ${name} side has length ${short(worst)}, not 1`);
  }
  if (kinds[0] === 'axis and angle' && ![[0, 3], [1, 4]].some(([from, to]) => isUnit(numbers.map((pose) => pose.slice(from, to)), doubt))) {
    throw new Error(`the four numbers of the ${name} side are neither a quaternion (their length is ${short(length(numbers[0]))}, not 1) nor `
      + 'an axis and its angle (neither the first three nor the last three make length 1)');
  }
  return kinds;
}

function demandOrthogonal(numbers, doubt, name) {
  numbers.forEach((pose, which) => {
    const dcm = rowsOfNine(pose), gaps = gapsOf(dcm).flat(), worst = gaps.indexOf(Math.max(...gaps));
    if (gaps[worst] <= 6 * doubt + 2 * SLACK) return;
    const row = Math.floor(worst / 3), other = worst % 3;
    const what = row === other ? `row ${row + 1} has length ${short(length(dcm[row]))}, not 1`
      : `rows ${row + 1} and ${other + 1} have the product ${short(dot(dcm[row], dcm[other]))}, not 0`;
    throw new Error(`matrix ${which + 1} of the ${name} side is no rotation: ${what}`);
  });
}

// ---- what numbers mean ---------------------------------------------------------------------------------

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
    const { axis, angle } = axisAngleFromDcm(dcm), size = angle / radiansOf(choices);
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
  if (kind === 'matrix') return half;
  if (kind === 'quaternion') return 4 * half;
  if (kind === 'axis and angle') return (4 + radiansOf(choices)) * half;
  return 3 * half * radiansOf(choices);
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

export function relationsOf(mirrored, table) {
  const best = new Map(), axes = SIGNED_AXES.map((names) => ({ names, body: axesChoice(names, true, table), world: axesChoice(names, false, table),
    left: determinant(axesMatrix(names)) < 0 }));
  for (const inverse of [false, true]) {
    for (const body of axes) {
      for (const world of axes) {
        if ((body.left !== world.left) !== mirrored) continue;
        const hand = body.names === world.names && body.names.replaceAll('-', '') === SAME_AXES && body.names.split('-').length === 2;
        const faults = (hand ? 1 : body.body.faults + world.world.faults) + inverse, rarity = hand ? 0.1 : body.body.rarity + world.world.rarity;
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
  return [...best.values()].sort((one, other) => one.faults - other.faults || one.rarity - other.rarity || one.inverse - other.inverse);
}

function readingsOf(kind, declared, large, table) {
  const base = { ...table.book, ...(large ? { unit: 'degrees' } : {}), ...declared };
  let partial = [{ kind, choices: {}, faults: 0, rarity: 0, words: [] }];
  for (const { group, choices } of table.kinds[kind]) {
    const longer = [];
    for (const chosen of partial) {
      for (const option of choices) {
        const usual = base[group] === option.value, more = usual || !(group in base) ? 0 : option.faults || 1;
        if (chosen.faults + more > table['most faults']) continue;
        longer.push({ kind, choices: { ...chosen.choices, [group]: option.value }, faults: chosen.faults + more,
          rarity: chosen.rarity + (usual ? 0 : option.rarity), words: usual ? chosen.words : [...chosen.words, option.words] });
      }
    }
    partial = longer;
  }
  return partial;
}

// Readings that mean the same by any numbers: space fixed is body fixed from behind.
function readingKey({ kind, choices }) {
  if (choices['axes of the turns'] !== 'space fixed') return kind + JSON.stringify(choices);
  return kind + JSON.stringify({ ...choices, 'axes of the turns': 'body fixed', sequence: [...choices.sequence].reverse().join(''),
    places: choices.places.replace(/[13]/g, (which) => (which === '1' ? '3' : '1')), signs: [...choices.signs].reverse().join('') });
}

// ---- the search ----------------------------------------------------------------------------------------

const fourthPowers = (dcm) => dcm.flat().reduce((sum, entry) => sum + entry ** 4, 0);
const price = (one, other) => one.faults - other.faults || one.rarity - other.rarity;

function sideOf(poses, declared, table) {
  const cheapest = new Map();
  for (const kind of poses.kinds) {
    const angles = kind === 'Euler angles' || kind === 'rotation vector' ? poses.numbers.flat() : poses.numbers.map((pose) => pose.at(-1));
    const large = kind !== 'quaternion' && angles.some((value) => Math.abs(value) > 2 * Math.PI + 0.01);
    for (const reading of readingsOf(kind, { ...poses.declared, ...declared }, large, table)) {
      const key = readingKey(reading), held = cheapest.get(key);
      if (!held || price(reading, held) < 0) cheapest.set(key, reading);
    }
  }
  return [...cheapest.values()].sort(price).map((reading) => {
    const dcms = poses.numbers.map((numbers) => dcmFromNumbers(reading, numbers));
    return { reading, dcms, flat: dcms.map((dcm) => dcm.flat()), fourth: dcms.map(fourthPowers), doubt: doubtOf(reading, poses.half) };
  });
}

const related = (relation, dcm) => multiply(relation.left, relation.inverse ? transpose(dcm) : dcm, relation.right);

function gapOf(relation, first, second) {
  let gap = 0;
  for (let pose = 0; pose < first.length; pose += 1) {
    const made = related(relation, first[pose]), wanted = second[pose];
    for (let i = 0; i < 3; i += 1) for (let j = 0; j < 3; j += 1) gap = Math.max(gap, Math.abs(made[i][j] - wanted[i][j]));
  }
  return gap;
}

function chainsOf(first, second, noise, table) {
  const mirrored = (determinant(first[0].dcms[0]) > 0) !== (determinant(second[0].dcms[0]) > 0);
  const relations = relationsOf(mirrored, table), within = [0, 1, 2, 3].map((most) => relations.filter(({ faults }) => faults <= most));
  const fits = [];
  let tried = 0;
  for (const one of first) {
    let turned = null;
    for (const other of second) {
      const budget = table['most faults'] - one.reading.faults - other.reading.faults;
      if (budget < 0) continue;
      tried += within[budget].length;
      const tolerance = Math.max(one.doubt + other.doubt, SINGLE_PRECISION) + noise;
      if (one.fourth.some((value, pose) => Math.abs(value - other.fourth[pose]) > 12 * tolerance)) continue;
      turned ??= relations.map((relation) => related(relation, one.dcms[0]).flat());
      const wanted = other.flat[0];
      for (let k = 0; k < within[budget].length; k += 1) {
        let near = true;
        for (let entry = 0; near && entry < 9; entry += 1) near = Math.abs(turned[k][entry] - wanted[entry]) <= tolerance;
        if (!near) continue;
        const relation = relations[k], residual = gapOf(relation, one.dcms, other.dcms);
        if (residual <= tolerance) {
          fits.push({ first: one.reading, second: other.reading, relation, residual,
            faults: one.reading.faults + other.reading.faults + relation.faults,
            rarity: one.reading.rarity + other.reading.rarity + relation.rarity });
        }
      }
    }
  }
  for (const chain of fits) chain.words = wordsOf(chain, table).join('; ');
  const tenths = ({ rarity }) => Math.round(rarity * 1e6);
  fits.sort((a, b) => a.faults - b.faults || tenths(a) - tenths(b) || (a.words < b.words ? -1 : Number(a.words > b.words)));
  return { fits, tried };
}

// A constant turn on the body's side, on the world's, or both: three poses tell one, four tell two.
function mountingsOf(first, second, noise, table) {
  if (first[0].dcms.length < 3 || determinant(first[0].dcms[0]) < 0 || determinant(second[0].dcms[0]) < 0) return [];
  const found = [];
  for (const one of first) {
    for (const other of second) {
      for (const inverse of [false, true]) {
        const faults = one.reading.faults + other.reading.faults + inverse;
        if (faults >= table['most faults']) continue;
        const start = inverse ? one.dcms.map(transpose) : one.dcms, end = other.dcms;
        const tolerance = 3 * (Math.max(one.doubt + other.doubt, SINGLE_PRECISION) + noise);
        for (const [body, world] of constantTurns(start, end)) {
          const relation = { inverse, hand: false, body: SAME_AXES, world: SAME_AXES, 'body turn': body, 'world turn': world,
            left: body ?? axesMatrix(SAME_AXES), right: world ?? axesMatrix(SAME_AXES) };
          const residual = gapOf({ ...relation, inverse: false }, start, end), total = faults + (body !== null) + (world !== null);
          if (residual <= tolerance && total <= table['most faults']) {
            found.push({ first: one.reading, second: other.reading, relation, residual, faults: total,
              rarity: one.reading.rarity + other.reading.rarity });
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
    const { axis, angle } = axisAngleFromDcm(nearestDcm(multiply(dcm, transpose(dcms[0]))).dcm);
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

// ---- which chains say the same, and which pose decides -----------------------------------------------------

// None of them special; those of Python are others.
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

// What a chain predicts that the second side gives where the first gives these numbers, as keys: two chains that share
// one are mathematically the same, for an orientation has two triples of Euler angles, and either may be printed.
function predictionsOf(chains, samples, decimals, table) {
  const dcms = new Map(), factor = 10 ** decimals;
  return chains.map((chain) => {
    if (!dcms.has(chain.first)) dcms.set(chain.first, samples[chain.first.kind].map((numbers) => dcmFromNumbers(chain.first, numbers)));
    const plain = plainReading(chain.second.kind, table);
    const eachSample = dcms.get(chain.first).map((dcm) => [...new Set(numbersFromDcm(chain.second, related(chain.relation, dcm))
      .map((numbers) => dcmFromNumbers(plain, numbers).flat().map((entry) => Math.round(entry * factor) + 0).join()))]);
    return eachSample.reduce((keys, own) => keys.flatMap((key) => own.map((one) => `${key};${one}`)), [`${chain.first.kind};${chain.second.kind}`]);
  });
}

function classesOf(chains, poses, table) {
  const found = [], seen = new Set(), samples = Object.fromEntries(poses.kinds.map((kind) => [kind, samplesOf(kind, poses, table)]));
  predictionsOf(chains, samples, 5, table).forEach((keys, k) => {
    if (keys.some((key) => seen.has(key))) return;
    found.push(chains[k]);
    for (const key of keys) seen.add(key);
  });
  return found;
}

function turnedNumbers(reading, numbers, turns) {
  const hand = determinant(dcmFromNumbers(reading, numbers)) > 0 ? 1 : -1;
  let { dcm } = nearestDcm(dcmFromNumbers(reading, numbers).map((row) => scale(hand, row)));
  for (const [axis, angle] of turns) dcm = multiply(dcmFromAxisAngle(AXES.map((name) => Number(name === axis)), angle * DEGREE), dcm);
  return numbersFromDcm(reading, dcm.map((row) => scale(hand, row)))[0];
}

function furtherPose(all, poses, table) {
  const chains = all.slice(0, LOOKED_AT), readings = [...new Set(chains.map(({ first }) => first))];
  const decides = ([, turns]) => readings.every((reading) => {
    const own = chains.filter(({ first }) => first.kind === reading.kind);
    const keys = predictionsOf(own, { [reading.kind]: [turnedNumbers(reading, poses.numbers.at(-1), turns)] }, 2, table);
    return new Set(keys.flat()).size === keys.flat().length;
  });
  return (table['further poses'].find(decides) ?? table['further poses'].at(-1))[0];
}

// ---- the answer ----------------------------------------------------------------------------------------

export function wordsOf({ first, second, relation }, table) {
  const said = [['first', first], ['second', second]].flatMap(([side, { words }]) => words.map((one) => `in the ${side} numbers ${one}`));
  if (relation.inverse) said.push(`one is ${table.inverse[second.kind]}`);
  for (const whose of ['body', 'world']) {
    if (relation[`${whose} turn`]) said.push(`a constant turn on the ${whose}'s side, as of an instrument that is mounted askew`);
  }
  if (relation.hand) return [...said, `the other hand: ${/-(.)/.exec(relation.body)[1]} is reversed in the world and on the body`];
  return [...said, axesChoice(relation.body, true, table).words, axesChoice(relation.world, false, table).words].filter(Boolean);
}

// As orientation_workbench.explain: { verdict, faults, residual, chains, furtherPose, poses } and the poses as read.
export function explain(first, second, table, { firstDeclared = {}, secondDeclared = {}, noise = 0 } = {}) {
  const given = [[first, 'first', firstDeclared], [second, 'second', secondDeclared]];
  const sides = given.map(([text, name, declared]) => readPoses(text, name, declared.kind ?? null, noise));
  const counts = sides.map(({ numbers }) => numbers.length);
  if (Math.min(...counts) === 1 && Math.max(...counts) === 3) {   // three rows that are no matrix were taken for three triples
    const which = counts.indexOf(3);
    sides[which] = readPoses(given[which][0], given[which][1], 'matrix', noise);
    counts[which] = 1;
  }
  if (counts[0] !== counts[1]) {
    throw new Error(`the first side holds ${counts[0]} poses and the second ${counts[1]}: they must be the same poses, in order`);
  }
  const [one, other] = sides.map((poses, k) => sideOf(poses, given[k][2], table));
  const { fits, tried } = chainsOf(one, other, noise, table);
  let chains = classesOf(fits, sides[0], table);
  if (!chains.length) chains = mountingsOf(one, other, noise, table).slice(0, 1);
  if (!chains.length) return { verdict: 'unrelated', faults: [], residual: null, chains, furtherPose: '', poses: counts[0], sides };
  const [best] = chains, tolerance = Math.max(one[0].doubt + other[0].doubt, SINGLE_PRECISION) + noise;
  const expected = tried * Math.min(1, (1.5 * tolerance) ** 3 / (6 * Math.PI)) ** counts[0];
  const decided = chains.length === 1 && (best.faults === 0 || expected < BY_CHANCE);
  return { verdict: best.faults === 0 ? 'same' : decided ? 'named' : 'undecided', faults: wordsOf(best, table), chains, sides, poses: counts[0],
    residual: 2 * Math.asin(Math.min(1, best.residual / 2)) / DEGREE,
    furtherPose: decided ? '' : furtherPose(chains, sides[0], table) };
}

// The orientations of both sides at one pose, as the simplest chain reads them: what is drawn.
export function drawnDcms(explanation, table, pose) {
  return explanation.sides.map((poses, k) => {
    const chain = explanation.chains[0], reading = chain ? chain[k ? 'second' : 'first'] : plainReading(poses.kinds[0], table);
    return dcmFromNumbers(reading, poses.numbers[pose]);
  });
}

// For each of the words of a chain the page of the book that teaches it: [address, title].
export function taughtBy({ first, second, relation }, table) {
  const links = [];
  for (const { kind, words } of [first, second]) {
    for (const said of words) {
      const own = table.kinds[kind].find(({ choices }) => choices.some((option) => option.words === said));
      links.push(table.taught[own?.group] ?? null);
    }
  }
  if (relation.inverse) links.push(table.taught.inverse);
  for (const whose of ['body', 'world']) if (relation[`${whose} turn`]) links.push(table.taught.turn);
  return [...links, table.taught.axes, table.taught.axes];
}

// ---- the line that mends it: as orientation_workbench.mismatch.mend ----------------------------------------

const rowsInPython = (rows) => `[${rows.map((row) => `[${row.join(', ')}]`).join(', ')}]`;
const inPython = (names) => `np.array(${rowsInPython(axesMatrix(names))})`;
const turnInPython = (dcm) => `np.array(${rowsInPython(dcm.map((row) => row.map((entry) => {
  const rounded = Number(entry.toFixed(6)) + 0;
  return Number.isInteger(rounded) ? `${rounded}.0` : String(rounded);
})))})`;
const ascending = (places) => places.every((place, k) => place === k);
const subscript = (places) => (ascending(places) ? '' : `[[${places.join(', ')}]]`);
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
  const there = matrix.endsWith('.T') && !matrix.includes('@') ? matrix.slice(0, -2) : `(${matrix}).T`;
  if (kind === 'quaternion') return `Rotation.from_matrix(${there}).as_quat()${subscript(indices('xyzw', choices.order))}`;
  if (kind === 'Euler angles') {
    return signed(choices, `Rotation.from_matrix(${there}).as_euler('${letters(choices)}'${inDegrees(choices)})`)
      + subscript([...choices.places].map((which) => Number(which) - 1));
  }
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
