// Written by `python -m orientation_figures.moving.javascript` from moving/pictures/nine_numbers.py.
import { AXES, IDENTITY, add, cross, dot, enumerate, length, scale, unit, zip } from './mathematics.js';
export const REACH = 1.2;
export const SIZE = 116;
export const SMALL = 1e-9;

export function off(row) {
  return Math.abs(dot(row, row) - 1) > SMALL;
}

export function mirrored(rows) {
  return dot(cross(rows[0], rows[1]), rows[2]) < 0;
}

export function picture(sheet, rows, nearest) {
  sheet.triad('N', IDENTITY, { length: REACH });
  if (nearest !== null) {
    sheet.layer = -1;
    for (const [row, measured] of zip(nearest, rows)) {
      sheet.arrow(row, { colour: 'D' });
      sheet.line([row, measured], 'D', 'guide');
    }
  }
  sheet.layer = 0;
  for (const [k, row] of enumerate(rows)) {
    sheet.arrow(row, { colour: 'A' });
    sheet.labelBeyond(length(row) < 1 ? unit(row) : row, `$\\hat{a}_${AXES[k]}$`, 'A');
  }
  sheet.layer = 1;
  for (const row of rows) {
    if (off(row)) {
      sheet.line([row, unit(row)], 'B', 'thick');
      sheet.ring(unit(row), 'B', 5);
    }
  }
  for (const [i, j] of [[0, 1], [1, 2], [2, 0]]) {
    const u = scale(0.2, unit(rows[i])), v = scale(0.2, unit(rows[j]));
    const fails = Math.abs(dot(rows[i], rows[j])) > SMALL;
    sheet.line([u, add(u, v), v], fails ? 'B' : 'muted', fails ? 'thick' : '');
  }
  if (mirrored(rows)) {
    sheet.arrow(cross(rows[0], rows[1]), { colour: 'B', label: '$\\hat{a}_x\\times\\hat{a}_y$' });
  }
}
