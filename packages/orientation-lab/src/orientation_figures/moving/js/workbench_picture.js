// Written by `python -m orientation_figures.moving.javascript` from moving/pictures/workbench.py.
import { IDENTITY, enumerate, scale } from './mathematics.js';
export const REACH = 1.25;
export const APART = 165;
export const SIZE = 100;

export function picture(sheet, dcms) {
  for (const [k, letter] of enumerate(['A', 'B'])) {
    const origin = scale((2 * k - 1) * APART / SIZE, sheet.view[0]);
    sheet.triad('N', IDENTITY, { origin, length: REACH });
    if (dcms[k] !== null) {
      sheet.triad(letter, dcms[k], { origin });
    }
  }
}
