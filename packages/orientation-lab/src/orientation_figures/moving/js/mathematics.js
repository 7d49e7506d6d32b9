import { PROPER_EULER, TAIT_BRYAN, axisAngleComponents, bodyFixedFromDcm, dcmFromBodyFixed, dcmFromQuaternion,
  quaternionFromDcm } from './formulas.js';

// What complements the formulas of the module in formulas.js: vectors and matrices, and what is not a formula but a
// search or a message. A matrix is three rows.
export { PROPER_EULER, TAIT_BRYAN, angularAcceleration, angularVelocityMatrix, bodyFixedFromDcm, dcmFromAxisAngle,
  dcmFromBodyFixed, dcmFromQuaternion, dcmFromRotationVector, dcmRate, gimbalLockMargin, multiplyQuaternions,
  quaternionFromAxisAngle, quaternionFromDcm, quaternionRate, simpleDcm } from './formulas.js';

export const AXES = ['x', 'y', 'z'];
export const SEQUENCES = [...PROPER_EULER, ...TAIT_BRYAN];
export const IDENTITY = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
const TOLERANCE = 1e-9;
export const several = (count, nouns) => `${count} ${Math.abs(count) === 1 ? nouns.replace(/s$/, '') : nouns}`;

// Vectors and matrices.

// Plain loops, because these run some thousand times for each picture.
export function dot(u, v) {
  let sum = 0;
  for (let k = 0; k < u.length; k += 1) sum += u[k] * v[k];
  return sum;
}

export function add(...vectors) {
  const sum = [...vectors[0]];
  for (let n = 1; n < vectors.length; n += 1) for (let k = 0; k < sum.length; k += 1) sum[k] += vectors[n][k];
  return sum;
}

export const cross = (u, v) => [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
export const scale = (factor, v) => v.map((entry) => factor * entry);
export const subtract = (u, v) => u.map((entry, k) => entry - v[k]);
export const length = (v) => Math.hypot(...v);
// A zero vector stays zero.
export const unit = (v) => scale(1 / (length(v) || 1), v);
export const transpose = (matrix) => matrix[0].map((_, column) => matrix.map((row) => row[column]));
export const multiply = (...matrices) => matrices.reduce((left, right) => {
  const columns = transpose(right);
  return left.map((row) => columns.map((column) => dot(row, column)));
});
// v_A = A_C_N v_N.
export const times = (matrix, v) => matrix.map((row) => dot(row, v));
// Return x such that matrix x = v.
export function solve(matrix, v) {
  const [x, y, z] = transpose(matrix), whole = determinant([x, y, z]);
  return [determinant([v, y, z]), determinant([x, v, z]), determinant([x, y, v])].map((part) => part / whole);
}
export const determinant = ([x, y, z]) => dot(cross(x, y), z);
export const distance = (first, second) => Math.hypot(...first.flatMap((row, k) => subtract(row, second[k])));

export const degrees = (angle) => angle * 180 / Math.PI;
export const radians = (angle) => angle * Math.PI / 180;
// Bring an angle into the range from -pi to pi. Both ends stay as they are, apart from rounding: they are those of a slider.
export const wrapped = (angle) => angle - 2 * Math.PI * Math.sign(angle) * Math.ceil(Math.abs(angle) / (2 * Math.PI) - 0.500001);

// Loops, as in the pictures translated from Python.

export const range = (first, end) => Array.from({ length: end === undefined ? first : end - first },
  (_, k) => (end === undefined ? k : first + k));
export const enumerate = (list) => [...list].map((one, k) => [k, one]);
export const zip = (first, ...others) => [...first].map((one, k) => [one, ...others.map((list) => list[k])]);
export const sum = (numbers) => numbers.reduce((total, number) => total + number, 0);

// Properties of a matrix, and the nearest valid one.

// Format a number like Python's '%.6g', so that messages agree.
export function general(value, digits = 6) {
  if (value === 0) return '0';
  const [mantissa, power] = value.toExponential(digits - 1).split('e');
  const size = Math.abs(power);
  if (power >= -4 && power < digits) return String(Number(value.toPrecision(digits)));
  return `${Number(mantissa)}e${power < 0 ? '-' : '+'}${size < 10 ? '0' : ''}${size}`;
}

// Return the conditions on the rows: { rows: [i, j], value, wanted }.
export function conditions(matrix) {
  return [[0, 0], [1, 1], [2, 2], [0, 1], [1, 2], [2, 0]].map(([i, j]) => {
    const product = dot(matrix[i], matrix[j]);
    return i === j ? { rows: [i, j], value: Math.sqrt(product), wanted: 1, fault: product - 1 }
      : { rows: [i, j], value: product, wanted: 0, fault: product };
  });
}

// Return the message that check_dcm raises, or '' for a valid matrix.
export function checkDcm(matrix) {
  const [x, y, z] = matrix;
  const products = [[0, 0], [0, 1], [0, 2], [1, 1], [1, 2], [2, 2]].map(([i, j]) => [i, j, dot(matrix[i], matrix[j])]);
  const beyond = subtract(cross(x, y), z);
  const excess = Math.max(...[0, 3, 1].map((k) => Math.abs(products[k][2] - (k !== 1))), ...beyond.map(Math.abs));
  if (excess <= TOLERANCE) return '';
  const fault = ([i, j, value]) => Math.abs(value - (i === j));
  const [p, q, product] = products.reduce((worst, next) => (fault(next) > fault(worst) ? next : worst));
  const worst = fault([p, q, product]), turned = determinant(matrix);
  if (worst <= 2 * TOLERANCE && turned < 0) {
    return `dcm is orthogonal but left-handed: its determinant is ${general(turned)}, not +1. One row or column `
      + 'has the wrong sign, or two are swapped';
  }
  const what = p === q ? `row ${AXES[p]} has length ${general(Math.sqrt(product), 12)}, not 1`
    : `rows ${AXES[p]} and ${AXES[q]} have dot product ${general(product)}, not 0`;
  const squares = [0, 3, 5].map((k) => products[k][2]), most = Math.max(...squares);
  // A scale closer to 1 than this cannot be distinguished from rounding.
  const scaled = worst > 1e-5 && most - Math.min(...squares) <= 1e-6 * most
    && [1, 2, 4].every((k) => Math.abs(products[k][2]) <= 1e-6 * most);
  let cause = 'An entry or a sign is wrong, or the rows are not unit vectors of one triad';
  if (matrix.flat().every((entry) => entry === 0)) cause = 'Every entry is zero';
  else if (scaled) {
    cause = `The whole matrix is ${general(Math.sqrt(most), 8)} times an orthogonal one, as if from a quaternion `
      + 'that does not have unit length';
  } else if (worst < 0.1) {
    cause = 'Were its entries rounded or measured? nearest_dcm finds the nearest valid matrix';
  }
  return `dcm is not orthogonal: ${what}. ${cause}`;
}

// Return the eigenvalues of a symmetric matrix, largest first, with their unit vectors (Jacobi rotations).
function eigenvectors(symmetric) {
  const size = symmetric.length, m = symmetric.map((row) => [...row]);
  const vectors = m.map((_, i) => m.map((__, j) => Number(i === j)));
  for (let sweep = 0; sweep < 30; sweep += 1) {
    let turned = false;
    for (let p = 0; p < size; p += 1) {
      for (let q = p + 1; q < size; q += 1) {
        if (Math.abs(m[p][q]) <= 1e-17 * (Math.abs(m[p][p]) + Math.abs(m[q][q]))) continue;
        turned = true;
        const half = (m[q][q] - m[p][p]) / (2 * m[p][q]);
        const tangent = (half < 0 ? -1 : 1) / (Math.abs(half) + Math.hypot(half, 1));
        const cosine = 1 / Math.hypot(tangent, 1), sine = tangent * cosine;
        for (const row of [...m, ...vectors]) {
          [row[p], row[q]] = [cosine * row[p] - sine * row[q], sine * row[p] + cosine * row[q]];
        }
        [m[p], m[q]] = [subtract(scale(cosine, m[p]), scale(sine, m[q])), add(scale(sine, m[p]), scale(cosine, m[q]))];
        m[p][q] = m[q][p] = 0;
      }
    }
    if (!turned) break;
  }
  return transpose(vectors).map((vector, k) => ({ value: m[k][k], vector })).sort((a, b) => b.value - a.value);
}

// The direction cosine matrix C(q) with the smallest distance from the matrix M has the largest sum of products of
// their entries, q^T K q, so q belongs to the largest eigenvalue of K (Davenport's form of Wahba's problem). `dcm` is
// null if several are equally near.
export function nearestDcm(matrix) {
  const [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]] = matrix;
  const [i, j, k] = [yz - zy, zx - xz, xy - yx];
  const [first, second] = eigenvectors([[xx + yy + zz, i, j, k], [i, xx - yy - zz, xy + yx, xz + zx],
    [j, xy + yx, yy - xx - zz, yz + zy], [k, xz + zx, yz + zy, zz - xx - yy]]);
  // Half the sum of the two is the largest singular value; half their difference is the sum of the others.
  if (first.value - second.value <= TOLERANCE * (first.value + second.value)) return { dcm: null, distance: NaN };
  const dcm = dcmFromQuaternion(unit(first.vector));
  return { dcm, distance: distance(dcm, matrix) };
}

// Euler angles.

export const reversed = (list) => [...list].reverse();

export const dcmFromSpaceFixed = (angles, sequence) => dcmFromBodyFixed(
  reversed(angles), reversed(sequence).join(''));

export const spaceFixedFromDcm = (dcm, sequence) => reversed(bodyFixedFromDcm(dcm, reversed(sequence).join('')));

// Axis and angle.

export function axisAngleFromQuaternion(quaternion) {
  const [x, y, z, angle] = axisAngleComponents(quaternion);
  return [[x, y, z], angle];
}

export const axisAngleFromDcm = (dcm) => axisAngleFromQuaternion(quaternionFromDcm(dcm));

// Quaternions.

// Interpolate along the great arc between two unit quaternions at constant speed. For the short way, reverse the sign
// of one if their dot product is negative. Between opposite ones the arc is not unique.
export function slerp(from, to, part) {
  const angle = 2 * Math.atan2(length(subtract(to, from)), length(add(to, from)));
  if (angle < 1e-9) return unit(add(scale(1 - part, from), scale(part, to)));
  return unit(add(scale(Math.sin((1 - part) * angle), from), scale(Math.sin(part * angle), to)));
}

// Replace decimal commas by points, as `_decimal_points` of mismatch/text.py does.
export function decimalPoints(text) {
  const numbers = text.match(/\d+(?:,\d+)+/g) ?? [];
  const pair = /^(?=.*\d,\d)[^A-Za-z\d]*\d[\d,]*\s[\s,]*[-+]?\d[\d,]*[^A-Za-z\d]*$/;
  const separated = numbers.some((number) => number.split(',').length > 2) || text.split('\n').some((line) => pair.test(line));
  if (/\d\.|\.\d/.test(text) || numbers.length < 2 || separated) return text;
  return text.replace(/(?<=\d),(?=\d)/g, '.');
}
