// Written by `python -m orientation_figures.moving.javascript` from moving/pictures/phone.py.
import { IDENTITY, add, dot, scale } from './mathematics.js';
export const BODY = [0.62, 1.24, 0.1];
export const SCREEN = [0.27, 0.54];
export const REACH = 1.3;
export const SIZE = 112;

export function picture(sheet, dcm) {
  sheet.triad('N', IDENTITY, { length: REACH });
  sheet.box(dcm, BODY, { colour: 'B' });
  const [across, along, out] = dcm;
  if (dot(out, sheet.view[2]) > 0) {
    const front = scale(BODY[2] / 2 + 0.001, out);
    const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]];
    const places = corners.map(([x, y]) => add(front, scale(x * SCREEN[0], across), scale(y * SCREEN[1], along)));
    sheet.area(places, 'ink', 8);
  }
  sheet.triad('B', dcm);
}
