// Written by `python -m orientation_figures.moving.javascript` from moving/pictures/triad.py.
import { around } from './common_picture.js';
import { IDENTITY, scale } from './mathematics.js';
export const REACH = 1.25;
export const KNOB = 1.55;
export const SIZE = 112;

export function picture(sheet, axis, angle, dcm) {
  const knob = scale(KNOB, axis);
  sheet.line([scale(-1, axis), knob], 'accent', 'guide');
  for (const start of IDENTITY) {
    around(sheet, axis, angle, start);
  }
  sheet.triad('N', IDENTITY, { length: REACH });
  sheet.triad('A', dcm);
  sheet.arrow(axis, { colour: 'accent' });
  sheet.dot(knob, 'accent', 5);
  sheet.label(knob, '$\\hat{e}$', 'accent', [15, -9]);
}
