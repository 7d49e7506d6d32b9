// Written by `python -m orientation_figures.moving.javascript` from moving/pictures/simple.py.
import { AXES, IDENTITY, add, scale } from './mathematics.js';
export const REACH = 1.25;
export const SIZE = 112;
export const VANE = [[-0.72, 0.5], [-0.5, 0.36], [0.4, 0.36], [0.4, 0.46], [0.68, 0.3], [0.4, 0.14], [0.4, 0.24], [-0.5, 0.24], [-0.72, 0.1], [-0.62, 0.3]];

export function picture(sheet, k, angle, dcm) {
  const axis = IDENTITY[k], pointer = dcm[(k + 1) % 3];
  sheet.area(VANE.map(([along, up]) => add(scale(along, pointer), scale(up, axis))), 'A', 26);
  sheet.triad('N', IDENTITY, { length: REACH });
  for (const m of [(k + 1) % 3, (k + 2) % 3]) {
    sheet.arrow(dcm[m], { colour: 'A', label: `$\\hat{a}_${AXES[m]}$` });
    sheet.turn(axis, angle, IDENTITY[m], { radius: 0.5, label: '$\\theta$', colour: 'accent' });
  }
  sheet.arrow(axis, { colour: 'A' });
}
