// Written by `python -m orientation_figures.moving.javascript` from moving/pictures/challenge.py.
import { IDENTITY } from './mathematics.js';
export const REACH = 1.25;
export const SIZE = 112;
export const BOX = [1.1, 0.8, 0.35];

export function picture(sheet, dcm, ghost = null) {
  if (ghost !== null) {
    sheet.faded = true;
    sheet.box(ghost, BOX, { colour: 'E' });
    sheet.triad('E', ghost, { labels: ['', '', ''] });
    sheet.faded = false;
  }
  sheet.box(dcm, BOX, { colour: 'A' });
  sheet.triad('N', IDENTITY, { length: REACH });
  sheet.triad('A', dcm);
}
