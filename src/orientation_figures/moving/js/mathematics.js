// The formulas of the Python module, for one orientation at a time. A matrix is three rows; the rows of
// A_C_N are A's unit vectors along N. Angles in radians, quaternions scalar first, sequences body fixed.
// tests/test_moving_mathematics.py holds every function against its namesake.

export const AXES = ['x', 'y', 'z'];
export const PROPER_EULER = ['zxz', 'xyx', 'yzy', 'zyz', 'xzx', 'yxy'];
export const TAIT_BRYAN = ['xyz', 'yzx', 'zxy', 'xzy', 'zyx', 'yxz'];
export const SEQUENCES = [...PROPER_EULER, ...TAIT_BRYAN];
export const IDENTITY = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
const TOLERANCE = 1e-9;

// Vectors and matrices.

// Plain loops: these are called some thousand times for each picture.
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
export const determinant = ([x, y, z]) => dot(cross(x, y), z);
export const distance = (first, second) => Math.hypot(...first.flatMap((row, k) => subtract(row, second[k])));

// Direction cosine matrices.

export function simpleDcm(axis, angle) {
  const first = AXES.indexOf(axis), second = (first + 1) % 3, third = (first + 2) % 3;
  const sine = Math.sin(angle), cosine = Math.cos(angle);
  const dcm = [[0, 0, 0], [0, 0, 0], [0, 0, 0]];
  dcm[first][first] = 1;
  dcm[second][second] = dcm[third][third] = cosine;
  dcm[second][third] = sine;
  dcm[third][second] = -sine;
  return dcm;
}

// As Python writes '%.6g', so that messages agree.
export function general(value, digits = 6) {
  if (value === 0) return '0';
  const [mantissa, power] = value.toExponential(digits - 1).split('e');
  const size = Math.abs(power);
  if (power >= -4 && power < digits) return String(Number(value.toPrecision(digits)));
  return `${Number(mantissa)}e${power < 0 ? '-' : '+'}${size < 10 ? '0' : ''}${size}`;
}

// What the rows are and what they should be: { rows: [i, j], value, wanted }.
export function conditions(matrix) {
  return [[0, 0], [1, 1], [2, 2], [0, 1], [1, 2], [2, 0]].map(([i, j]) => {
    const product = dot(matrix[i], matrix[j]);
    return i === j ? { rows: [i, j], value: Math.sqrt(product), wanted: 1, fault: product - 1 }
      : { rows: [i, j], value: product, wanted: 0, fault: product };
  });
}

// Returns what check_dcm raises, or '' for a valid matrix.
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
      + 'has the wrong sign, or two have changed places';
  }
  const what = p === q ? `row ${AXES[p]} has length ${general(Math.sqrt(product), 12)}, not 1`
    : `rows ${AXES[p]} and ${AXES[q]} have dot product ${general(product)}, not 0`;
  const squares = [0, 3, 5].map((k) => products[k][2]), most = Math.max(...squares);
  // A scale closer to 1 than that cannot be told from rounding.
  const scaled = worst > 1e-5 && most - Math.min(...squares) <= 1e-6 * most
    && [1, 2, 4].every((k) => Math.abs(products[k][2]) <= 1e-6 * most);
  let cause = 'An entry or a sign is wrong, or the rows are not unit vectors of one triad';
  if (matrix.flat().every((entry) => entry === 0)) cause = 'Every entry is zero';
  else if (scaled) {
    cause = `The whole matrix is ${general(Math.sqrt(squares[0]), 8)} times an orthogonal one, as from a quaternion `
      + 'that is not of unit length';
  } else if (worst < 0.1) {
    cause = 'Were its entries rounded or measured? nearest_dcm finds the nearest valid matrix';
  }
  return `dcm is not orthogonal: ${what}. ${cause}`;
}

// Eigenvalues, largest first, with their unit vectors, of a symmetric matrix: Jacobi's turns.
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

// The direction cosine matrix C(q) with the smallest distance from the matrix M has the largest sum of
// products of their entries, q^T K q: the largest eigenvalue of K (Davenport's form of Wahba's problem).
// `dcm` is null where several are equally near.
export function nearestDcm(matrix) {
  const [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]] = matrix;
  const [i, j, k] = [yz - zy, zx - xz, xy - yx];
  const [first, second] = eigenvectors([[xx + yy + zz, i, j, k], [i, xx - yy - zz, xy + yx, xz + zx],
    [j, xy + yx, yy - xx - zz, yz + zy], [k, xz + zx, yz + zy, zz - xx - yy]]);
  // Half the sum of the two is the largest singular value, half their difference the sum of the others.
  if (first.value - second.value <= TOLERANCE * (first.value + second.value)) return { dcm: null, distance: NaN };
  const dcm = dcmFromQuaternion(unit(first.vector));
  return { dcm, distance: distance(dcm, matrix) };
}

// Euler angles.

function layout(sequence) {
  const i = AXES.indexOf(sequence[0]), j = AXES.indexOf(sequence[1]);
  return [i, j, 3 - i - j, (j - i + 3) % 3 === 1 ? 1 : -1, sequence[0] === sequence[2]];
}

export const dcmFromBodyFixed = ([psi, theta, phi], sequence) => multiply(
  simpleDcm(sequence[2], phi), simpleDcm(sequence[1], theta), simpleDcm(sequence[0], psi));

export const reversed = (list) => [...list].reverse();

export const dcmFromSpaceFixed = (angles, sequence) => dcmFromBodyFixed(
  reversed(angles), reversed(sequence).join(''));

export function bodyFixedFromDcm(c, sequence) {
  const [i, j, k, sign, proper] = layout(sequence);
  // Adding zero turns -0 into 0: atan2(0, -0) would be pi.
  const psi = proper ? Math.atan2(sign * c[i][j] + 0, 0 - sign * c[i][k]) : Math.atan2(0 - c[k][j], c[k][k] + 0);
  const sine = Math.sin(psi), cosine = Math.cos(psi);
  const jj = c[j][j] * cosine + c[j][k] * sine;
  const [theta, phi] = proper
    // The sine has the sign of the order, and the size alone keeps the middle angle in [0, pi].
    ? [sign * Math.atan2(Math.abs(c[i][j] * sine - c[i][k] * cosine), c[i][i]),
      Math.atan2(-c[k][j] * cosine - c[k][k] * sine, jj)]
    : [Math.atan2(c[k][i], c[k][k] * cosine - c[k][j] * sine),
      Math.atan2(c[i][j] * cosine + c[i][k] * sine, jj)];
  return [sign * psi + 0, sign * theta + 0, sign * phi + 0];
}

export const spaceFixedFromDcm = (dcm, sequence) => reversed(bodyFixedFromDcm(dcm, reversed(sequence).join('')));

export function gimbalLockMargin([, theta], sequence) {
  const along = Math.abs(Math.cos(theta)), across = Math.abs(Math.sin(theta));
  return sequence[0] === sequence[2] ? Math.atan2(across, along) : Math.atan2(along, across);
}

// Axis and angle.

export function dcmFromAxisAngle(axis, angle) {
  const [x, y, z] = unit(axis), cosine = Math.cos(angle), sine = Math.sin(angle), rest = 1 - cosine;
  return [[cosine + rest * x * x, rest * x * y + sine * z, rest * x * z - sine * y],
    [rest * x * y - sine * z, cosine + rest * y * y, rest * y * z + sine * x],
    [rest * x * z + sine * y, rest * y * z - sine * x, cosine + rest * z * z]];
}

export const quaternionFromAxisAngle = (axis, angle) => [
  Math.cos(angle / 2), ...scale(Math.sin(angle / 2), unit(axis))];

export function axisAngleFromQuaternion([scalar, ...vector]) {
  const size = length(vector);
  const axis = size === 0 ? [1, 0, 0] : scale((scalar < 0 ? -1 : 1) / size, vector);
  return { axis, angle: 2 * Math.atan2(size, Math.abs(scalar)) };
}

export const axisAngleFromDcm = (dcm) => axisAngleFromQuaternion(quaternionFromDcm(dcm));

// Quaternions.

export function dcmFromQuaternion([s, x, y, z]) {
  const [ss, xx, yy, zz] = [s * s, x * x, y * y, z * z];
  return [[ss + xx - yy - zz, 2 * (x * y + s * z), 2 * (x * z - s * y)],
    [2 * (x * y - s * z), ss - xx + yy - zz, 2 * (y * z + s * x)],
    [2 * (x * z + s * y), 2 * (y * z - s * x), ss - xx - yy + zz]];
}

export function quaternionFromDcm([[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]]) {
  // Each row is the quaternion times four of its own components; the longest loses no digits.
  const scores = [1 + xx + yy + zz, 1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz];
  const [si, sj, sk, ij, ik, jk] = [yz - zy, zx - xz, xy - yx, xy + yx, xz + zx, yz + zy];
  const rows = [[scores[0], si, sj, sk], [si, scores[1], ij, ik], [sj, ij, scores[2], jk], [sk, ik, jk, scores[3]]];
  const row = rows[scores.indexOf(Math.max(...scores))];
  return row.map((entry) => (row[0] < 0 ? -1 : 1) / length(row) * entry + 0);
}

// The product turns by the first, then by the second.
export function multiplyQuaternions([a, b, c, d], [e, g, h, k]) {
  return [a * e - b * g - c * h - d * k, a * g + b * e + c * k - d * h,
    a * h - b * k + c * e + d * g, a * k + b * h - c * g + d * e];
}

export const conjugate = ([s, x, y, z]) => [s, -x, -y, -z];

// Along the great arc from one unit quaternion to another at constant speed. For the short way turn the
// sign of one where their dot product is negative. Opposite ones have no one arc between them.
export function slerp(from, to, part) {
  const angle = 2 * Math.atan2(length(subtract(to, from)), length(add(to, from)));
  if (angle < 1e-9) return unit(add(scale(1 - part, from), scale(part, to)));
  return unit(add(scale(Math.sin((1 - part) * angle), from), scale(Math.sin(part * angle), to)));
}
