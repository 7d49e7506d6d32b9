// Written by `python -m orientation_figures.moving.javascript` from moving/pictures/hands.py.
import { IDENTITY, scale } from './mathematics.js';
export const REACH = 1;
export const SIZE = 76;
export const APART = 1.3;
export const LABELS = ['$\\hat{m}_x$', '$\\hat{m}_y$', '$\\hat{m}_z$'];

export function picture(sheet, rows, together) {
  const right = sheet.view[0], up = sheet.view[1];
  const far = together ? 0 : APART;
  sheet.triad('N', IDENTITY, { origin: scale(-far, right), length: REACH });
  if (!together) {
    sheet.line([scale(-1.2, up), scale(1.2, up)], 'muted', 'guide');
  }
  sheet.triad('E', rows, { origin: scale(far, right), labels: LABELS });
}
