// Written by `python -m orientation_figures.moving.javascript` from moving/pictures/converter.py.
import { IDENTITY } from './mathematics.js';
export const REACH = 1.25;
export const SIZE = 112;

export function picture(sheet, dcm) {
  sheet.triad('N', IDENTITY, { length: REACH });
  sheet.triad('A', dcm);
}
